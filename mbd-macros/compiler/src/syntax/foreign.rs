//! Words that other tools use for what is written otherwise here, and the answers to them.

/// Words of other tools, and ours.
pub type Dictionary = &'static [(&'static str, &'static str)];

/// Our word for a word of another tool.
pub fn translated(dictionary: Dictionary, word: &str) -> Option<&'static str> {
    let word = word.to_lowercase();
    dictionary
        .iter()
        .find(|(theirs, _)| *theirs == word)
        .map(|(_, ours)| *ours)
}

/// Items of other tools.
pub const FOREIGN_ITEMS: Dictionary = &[
    ("link", "body"),
    ("rigid_body", "body"),
    ("rigidbody", "body"),
    ("segment", "body"),
    ("node", "point"),
    ("junction", "point"),
    ("particle", "point"),
    ("cable", "line"),
    ("rope", "line"),
    ("tether", "line"),
    ("tendon", "line"),
    ("string", "line"),
    ("force", "load"),
    ("torque", "load"),
    ("wrench", "load"),
    ("sensor", "output"),
    ("measure", "output"),
    ("constant", "const"),
    ("define", "let"),
    ("var", "let"),
    ("variable", "let"),
    ("parameter", "param"),
    ("marker", "frame"),
    ("site", "frame"),
    ("ground", "world"),
    ("mate", "joint"),
    ("part", "body"),
    ("bodies", "body"),
    ("points", "point"),
    ("joints", "joint"),
    ("lines", "line"),
    ("springs", "spring"),
    ("outputs", "output"),
    ("constants", "const"),
    ("consts", "const"),
    ("parameters", "param"),
    ("params", "param"),
    ("inputs", "input"),
    ("states", "state"),
    ("tables", "table"),
    ("loads", "load"),
    ("forces", "load"),
    ("events", "event"),
    ("metrics", "metric"),
    ("cables", "line"),
    ("spring_damper", "spring"),
    ("springdamper", "spring"),
    ("strut", "spring"),
];

/// Items that people expect, and how what they mean is said here, or that it cannot be said yet.
pub const EXPECTED_ITEMS: Dictionary = &[
    ("integral", INTEGRAL),
    ("integrator", INTEGRAL),
    ("ode", INTEGRAL),
    ("der", INTEGRAL),
    ("constraint", HELD),
    ("constrain", HELD),
    ("equation", HELD),
    ("contact", CONTACT),
    ("collision", CONTACT),
    ("pulley", LED_OVER),
    ("include", ONE_TEXT),
    ("import", ONE_TEXT),
    ("csv", NO_FILE_OF_TABLE),
    ("use", NO_PARTS),
    ("mod", NO_PARTS),
    ("module", NO_PARTS),
    ("submodel", NO_PARTS),
    ("component", NO_PARTS),
    ("for", REPETITION),
    ("repeat", REPETITION),
    ("if", NO_CONDITION),
    ("fn", NO_FUNCTIONS),
    ("function", NO_FUNCTIONS),
    ("def", NO_FUNCTIONS),
    (
        "motor",
        "a motor is a field of its joint: `{ axis: y, motor: 2 rad/s * time }`",
    ),
    ("actuator", EFFORT),
    ("controller", EFFORT),
    ("every", SAMPLED),
    ("sample", SAMPLED),
    ("sampled", SAMPLED),
    ("period", SAMPLED),
    (
        "mass",
        "a mass is a field of its body or point: `point bob { mass: 1 kg }`",
    ),
    (
        "damper",
        "damping is a field of its line or spring, `spring strut from a to b { damping: 3 N*s/m }`, or of its joint, `{ axis: y, damping: 0.1 N*m*s }`",
    ),
    (
        "frame",
        "a frame stands between the braces of what it is fixed to: `world { frame hook at [0, 0, 1] m }`, `body link { …, frame tip at [0, 0, 1] m }`",
    ),
    (
        "name",
        "the name of a scene is that of its model: `model Name { … }`, in TOML `model = \"Name\"`",
    ),
    ("run", THE_RUN),
    ("simulation", THE_RUN),
    ("simulate", THE_RUN),
    ("initial", A_START),
    ("init", A_START),
    ("start", A_START),
    (
        "friction",
        "friction is a field of its joint: `{ axis: y, friction: 0.1 N*m, friction_rate: 0.01 rad/s }`",
    ),
    (
        "limit",
        "limits are a field of their joint: `{ axis: y, stops: [-90, 90] deg, stop_stiffness: 1 kN*m/rad }`",
    ),
];

const THE_RUN: &str = "how long and by which method a model runs is no part of its declaration: it stands in `[run]` of a scene file, behind the last `}` of a `.mbd`, with `until = \"3 s\"` on a line of its own, or behind `mbd run`, `--until \"3 s\"`";
const HELD: &str = "what holds bodies is a joint of some kind, `joint pin: hinge from world to link.top { axis: y }`, and what holds two coordinates to each other a gear, `joint teeth: gear from pin.angle to way.slide { ratio: 40 mm }`; a coordinate that follows a course has a `motor`, and no other equation can be declared";
const CONTACT: &str = "contact cannot be declared yet; a soft one is a load, such as `load push on body at foot = max(0, -body.foot.position.z) * [0, 0, 100] kN/m`";
/// A line over a pulley.
pub const LED_OVER: &str =
    "a line runs straight from its `from` to its `to`; it cannot be led over a pulley yet";
const A_START: &str = "a start is written with what starts: `joint pin: hinge from world to link.top { axis: y, start: 30 deg }`, `body link { …, start at [0.0, 0.0, 1.0] m }`";
const ONE_TEXT: &str = "a declaration is one text and takes in no other; copy what is shared";
const SPEED_OF_START: &str = "speeds are part of a start, without a comma before them: `start at [0.0, 0.0, 1.0] m velocity [1.0, 0.0, 0.0] m/s`; a coordinate of a joint has its `start_rate`";
/// A table whose entries stand in another file.
pub const NO_FILE_OF_TABLE: &str = "the entries of a table stand in its declaration, `table gas = { 0 s: 0 N, 1 s: 5 N };`: no file of numbers is read";
const NO_PARTS: &str = "a declaration has no parts to use again; what is alike is repeated by an index, `body leg[i in 0..3] { … }`";
const REPETITION: &str =
    "what is repeated has an index behind its name, `body leg[i in 0..3] { … }`";
const NO_CONDITION: &str =
    "an item is always there; a value that depends on a condition is `if(a < b, this, that)`";
const NO_FUNCTIONS: &str = "no functions can be declared; a quantity is named by `let`, and a function given by numbers is a `table`";
const INTEGRAL: &str =
    "an integral is a `state` with its rate: `state missed = 0 rad*s { rate: pin.angle }`";
const SAMPLED: &str = "a controller that acts at samples is given to the run in Rust, `simulation.control_every(0.01, …)`; how often a run writes rows is `every` in `[run]` of a scene file";
const EFFORT: &str = "what acts along a joint is its field `force`, such as `{ axis: y, force: -2 N*m * hip.angle }`";

/// What is taken of a quantity over a run, in other words.
pub const FOREIGN_TAKES: Dictionary = &[
    ("maximum", "max"),
    ("peak", "max"),
    ("highest", "max"),
    ("largest", "max"),
    ("minimum", "min"),
    ("lowest", "min"),
    ("smallest", "min"),
    ("last", "final"),
    ("end", "final"),
    ("average", "mean"),
    ("avg", "mean"),
    ("sum", "integral"),
    ("at", "value"),
    ("when", "time_of"),
    ("duration_above", "time_above"),
];

/// Words by which people say that a value passes another, and ours.
pub const PASSAGES: Dictionary = &[
    ("reaches", ANY_PASSAGE),
    ("passes", ANY_PASSAGE),
    ("hits", ANY_PASSAGE),
    ("equals", ANY_PASSAGE),
    ("becomes", ANY_PASSAGE),
    ("cross", ANY_PASSAGE),
    ("crossing", ANY_PASSAGE),
    ("exceeds", "`rises`"),
    ("above", "`rises`"),
    ("over", "`rises`"),
    ("rise", "`rises`"),
    ("rising", "`rises`"),
    ("below", "`falls`"),
    ("under", "`falls`"),
    ("drops", "`falls`"),
    ("fall", "`falls`"),
    ("falling", "`falls`"),
];
const ANY_PASSAGE: &str = "`rises`, `falls` or `crosses`";

/// Keys that people write in TOML for those of an item.
#[cfg(feature = "toml")]
pub const FOREIGN_KEYS: Dictionary = &[
    ("default", "value"),
    ("initial", "start"),
    ("expression", "value"),
    ("expr", "value"),
    ("formula", "value"),
    ("equals", "value"),
    ("force", "value"),
    ("torque", "value"),
    ("couple", "value"),
    ("when", "value"),
    ("condition", "value"),
    ("quantity", "kind"),
    ("type", "kind"),
    ("unit", "in"),
    ("units", "in"),
    ("range", "in"),
    ("min", "in"),
    ("max", "in"),
    ("limits", "in"),
    ("parent", "from"),
    ("child", "to"),
    ("body", "on"),
    ("frame", "at"),
];

/// Fields of other tools.
pub const FOREIGN_FIELDS: Dictionary = &[
    ("unit", "in"),
    ("units", "in"),
    ("length", "free_length"),
    ("l0", "free_length"),
    ("rest_length", "free_length"),
    ("natural_length", "free_length"),
    ("springlength", "free_length"),
    ("k", "stiffness"),
    ("c", "damping"),
    ("damper", "damping"),
    ("com", "center_of_mass"),
    ("cg", "center_of_mass"),
    ("cog", "center_of_mass"),
    ("moi", "inertia"),
    ("moment_of_inertia", "inertia"),
    ("initial", "start"),
    ("phi0", "start"),
    ("theta0", "start"),
    ("q0", "start"),
    ("x0", "start"),
    ("start_angle", "start"),
    ("start_position", "start"),
    ("start_velocity", "start_rate"),
    ("start_speed", "start_rate"),
    ("initial_velocity", "start_rate"),
    ("qd0", "start_rate"),
    ("omega0", "start_rate"),
    ("weight", "mass"),
    ("m", "mass"),
    ("about", "axis"),
    ("der", "rate"),
    ("derivative", "rate"),
    ("site", "frame"),
    ("marker", "frame"),
    ("lead", "pitch"),
    ("distance", "length"),
    ("direction", "axis"),
    ("normal", "axis"),
    ("limit", "stops"),
    ("limits", "stops"),
    ("range", "stops"),
    ("torque", "force"),
    ("effort", "force"),
    ("springref", "rest"),
    ("offset", "rest"),
    ("frictionloss", "friction"),
    ("coulomb", "friction"),
    ("stop", "then"),
    ("once", "acts"),
    ("cut", "detach"),
    ("release", "detach"),
    ("jettison", "detach"),
    ("connect", "attach"),
    ("unlock", "free"),
    ("freeze", "lock"),
];

/// Fields that people expect, and how what they mean is said here.
pub const EXPECTED_FIELDS: Dictionary = &[
    ("geometry", SHAPE),
    ("visual", SHAPE),
    ("collision", SHAPE),
    ("mesh", NO_MESH),
    ("position", A_START),
    ("velocity", SPEED_OF_START),
    ("angular_velocity", SPEED_OF_START),
    ("motor_speed", SPEED_OF_MOTOR),
    ("motor_velocity", SPEED_OF_MOTOR),
    ("preload", PRELOAD),
    ("pretension", PRELOAD),
];

const SPEED_OF_MOTOR: &str = "a motor prescribes the coordinate: `motor: 2 rad/s * time` turns at one speed; a speed that changes is the rate of a state, `state aim = 0 rad { rate: speed }`, followed by `motor: aim, filter: 20 ms`";
const PRELOAD: &str = "a spring that pulls with F from the start on is at rest F over its stiffness away from there: say `free_length` of a line or a spring, `rest` of a coordinate of a joint";

const SHAPE: &str = "what a body looks like is its `shape: box [0.2, 0.3, 0.4] m`";
/// What is said of meshes.
pub const NO_MESH: &str =
    "meshes are not read: put together a `shape` of `box`, `cylinder`, `tube`, `sphere`, `capsule`";

/// Shapes of other tools.
pub const FOREIGN_SHAPES: Dictionary = &[
    ("cube", "box"),
    ("cuboid", "box"),
    ("brick", "box"),
    ("ball", "sphere"),
    ("rod", "cylinder"),
    ("disc", "cylinder"),
    ("disk", "cylinder"),
    ("pipe", "tube"),
    ("ring", "tube"),
    ("pill", "capsule"),
];

/// What stands where a value must be known before a run and is not, and what to write instead.
pub const NOT_CHANGING: Dictionary = &[
    (
        "mass",
        "a mass that changes in a run cannot be declared yet",
    ),
    (
        "stiffness",
        "a line that does not pull in proportion takes a table of its force over its stretch, `force: NAME`",
    ),
];

/// What to write instead of a spring or damper of a joint whose number changes in a run.
pub const NOT_PROPORTIONAL: &str = "what follows the motion in another way is the field `force`, such as `force: -2 N*m * hip.angle^3`";

/// What to write instead of a free length that follows the motion of what winds it.
pub const WOUND_BY_MOTION: &str = "what answers to the motion is a `state` with a `rate`: what a drum pays out is `state paid_out = 5 m { rate: -0.2 m * drum.angle_rate }`, and the joint of the drum feels the rope by `force: -0.2 m * rope.tension`";

/// Functions of other tools.
pub const FOREIGN_FUNCTIONS: Dictionary = &[
    ("mag", "norm"),
    ("magnitude", "norm"),
    ("length", "norm"),
    ("pow", "^"),
    ("fabs", "abs"),
    ("inner", "dot"),
    ("log", "ln"),
    ("tang", "tan"),
    ("tangent", "tan"),
    ("tg", "tan"),
    ("sine", "sin"),
    ("cosine", "cos"),
    ("sh", "sinh"),
    ("ch", "cosh"),
    ("th", "tanh"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("arctan2", "atan2"),
    ("sgn", "sign"),
    ("signum", "sign"),
    ("saturate", "clamp"),
    ("sat", "clamp"),
    ("limit", "clamp"),
    ("clip", "clamp"),
    ("where", "if"),
    ("select", "if"),
    ("fmin", "min"),
    ("fmax", "max"),
];

/// Functions of other tools that the language does not have, and how what they give is written.
pub const EXPECTED_FUNCTIONS: Dictionary = &[
    ("delay", "nothing of the past is kept"),
    ("der", RATES),
    ("derivative", RATES),
    ("diff", RATES),
    ("d", RATES),
    ("ddt", RATES),
    ("rotate", TURNED),
    ("rotated", TURNED),
    ("transform", TURNED),
    ("to_world", TURNED),
    ("to_body", TURNED),
    (
        "distance",
        "write `norm(a.position - b.position)`; between the ends of a line or a spring it is its `length`",
    ),
    ("dist", "write `norm(a.position - b.position)`"),
    (
        "lerp",
        "write `a + (b - a) * t`; what goes through several numbers is a `table`",
    ),
    ("mix", "write `a + (b - a) * t`"),
    ("asinh", AREA_SINE),
    ("arsinh", AREA_SINE),
    ("arcsinh", AREA_SINE),
    ("acosh", AREA_COSINE),
    ("arcosh", AREA_COSINE),
    ("arccosh", AREA_COSINE),
    ("atanh", AREA_TANGENT),
    ("artanh", AREA_TANGENT),
    ("arctanh", AREA_TANGENT),
    ("sec", "write `1 / cos(a)`"),
    ("csc", "write `1 / sin(a)`"),
    ("cosec", "write `1 / sin(a)`"),
    ("cot", "write `1 / tan(a)`"),
    ("ctg", "write `1 / tan(a)`"),
    ("acot", "write `atan2(1, a)`"),
    ("coth", "write `cosh(a) / sinh(a)`"),
    ("sech", "write `1 / cosh(a)`"),
    ("csch", "write `1 / sinh(a)`"),
    ("log1p", "write `ln(1 + a)`"),
    ("ln1p", "write `ln(1 + a)`"),
    ("expm1", "write `exp(a) - 1`"),
    ("abs2", "write `a^2`, of a vector `dot(a, a)`"),
    (
        "det",
        "there are no matrices in expressions; that of three vectors is `dot(a, cross(b, c))`",
    ),
    ("inv", NO_MATRICES),
    ("transpose", NO_MATRICES),
    ("rot", TURNED),
    ("asind", IN_DEGREES),
    ("acosd", IN_DEGREES),
    ("atand", IN_DEGREES),
    ("sinc", "write `sin(a) / a` where `a` is not zero"),
    ("sind", "an angle carries its unit: `sin(30 deg)`"),
    ("cosd", "an angle carries its unit: `cos(30 deg)`"),
    ("tand", "an angle carries its unit: `tan(30 deg)`"),
    ("sqr", "write `a^2`"),
    ("square", "write `a^2`"),
    ("step", STEP),
    ("heaviside", STEP),
    (
        "pulse",
        "write `if time < t0 { 0 } else if time < t1 { a } else { 0 }`",
    ),
    ("deg", IN_DEGREES),
    ("degrees", IN_DEGREES),
    ("rad2deg", IN_DEGREES),
    ("to_degrees", IN_DEGREES),
    ("radians", FROM_DEGREES),
    ("rad", FROM_DEGREES),
    ("deg2rad", FROM_DEGREES),
    ("to_radians", FROM_DEGREES),
    ("cbrt", "write `exp(ln(a) / 3)`"),
    ("hypot", "write `sqrt(a^2 + b^2)`, or `norm` of a vector"),
    ("exp2", "write `exp(a * ln(2))`"),
    ("log2", "write `ln(a) / ln(2)`"),
    ("ceil", "write `-floor(-a)`"),
    ("round", "write `floor(a + 0.5)`"),
    ("trunc", "write `sign(a) * floor(abs(a))`"),
    ("mod", REMAINDER),
    ("fmod", REMAINDER),
    ("rem", REMAINDER),
    ("rand", NO_CHANCE),
    ("random", NO_CHANCE),
    ("noise", NO_CHANCE),
    ("interp", TABLE_CALL),
    ("lookup", TABLE_CALL),
    ("table", TABLE_CALL),
];

/// A vector that turns with a body, and the components of one along it.
pub const TURNED: &str = "the axes of a body or a frame are `rod.x`, `rod.y` and `rod.z`, in world axes: a vector along them is `a * rod.x + b * rod.y + c * rod.z`, and the components of a vector `v` along them are `[dot(v, rod.x), dot(v, rod.y), dot(v, rod.z)]`";
const AREA_SINE: &str = "write `ln(a + sqrt(a^2 + 1))`";
const AREA_COSINE: &str = "write `ln(a + sqrt(a^2 - 1))`";
const AREA_TANGENT: &str = "write `0.5 * ln((1 + a) / (1 - a))`";
const NO_MATRICES: &str = "there are no matrices in expressions";
const STEP: &str = "write `if(time < t0, 0, a)`";
const IN_DEGREES: &str = "an output is told in degrees by `in deg` behind its value";
const FROM_DEGREES: &str = "an angle carries its unit: `30 deg`";
/// A comparison where a value stands.
pub const COMPARISON: &str = "a comparison is no value: it stands in `if(a < b, this, that)`";
const RATES: &str =
    "rates are quantities: `body.velocity`, `joint.angle_rate`, `line.stretch_rate`";
const REMAINDER: &str = "write `a % b`, which lies between zero and `b`";
const NO_CHANCE: &str = "a model has no chance in it: what is random comes by an `input`";
const TABLE_CALL: &str = "a table is called by its own name, `lift(x)`";

/// Operators of other languages, and how what they mean is written.
pub const OPERATORS: Dictionary = &[
    (
        "?",
        "`?` and `:` are written as a function: `if(a < b, this, that)`",
    ),
    ("&&", BOTH),
    ("and", BOTH),
    ("||", EITHER),
    ("or", EITHER),
    ("not", NO_WORD_NOT),
    ("!", NO_NOT),
    ("<", COMPARISON),
    (">", COMPARISON),
    ("==", COMPARISON),
    ("as", "a unit stands behind `in`, such as `in deg`"),
    ("every", REPEATED),
];

const BOTH: &str =
    "that both hold is `&&` between comparisons, in `if(a < b && c < d, this, that)`";
const EITHER: &str =
    "that one of them holds is `||` between comparisons, in `if(a < b || c < d, this, that)`";
/// What is said of `not` before a condition.
pub const NO_WORD_NOT: &str = "there is no `not`: swap the two values of the `if`";
const NO_NOT: &str = "there is no `!`: swap the two values of the `if`";
const REPEATED: &str = "what happens again and again moves its own instant: `state next = 10 ms { rate: 0 }` and `event tick = time rises next { set: next = next + 10 ms }`";

/// Names that people use without declaring them.
pub const FOREIGN_NAMES: Dictionary = &[
    ("t", "the time is called `time`"),
    ("now", "the time is called `time`"),
    ("g", NO_G),
    ("e", "its powers are `exp(a)`"),
    ("π", "it is written `pi`"),
    (
        "dt",
        "the step is no quantity, and rates are: `body.velocity`, `joint.angle_rate`, `line.stretch_rate`",
    ),
    ("gravity", NO_G),
    ("g0", NO_G),
    ("kinetic_energy", ENERGY),
    ("potential_energy", ENERGY),
    ("total_energy", ENERGY),
    ("nan", NOT_FINITE),
    ("inf", NOT_FINITE),
    ("infinity", NOT_FINITE),
];

/// Whether a word means what is no number, in other languages.
pub fn is_not_finite(word: &str) -> bool {
    translated(FOREIGN_NAMES, word) == Some(NOT_FINITE)
}

/// What is said of what is no number.
pub const NOT_FINITE: &str =
    "it is no number; write a finite one, or a `param` with a default, which every run may change";
const NO_G: &str = "gravity has no name in expressions: declare `const g = 9.81 m/s^2;`";
/// What is said of the energy of one thing.
pub const ENERGY: &str =
    "the energies of the whole scene are `energy.kinetic`, `energy.potential` and `energy.total`";

/// Words for what is at rest.
pub const FOREIGN_WORLD: &[&str] = &[
    "ground",
    "earth",
    "base",
    "fixed",
    "inertial",
    "origin",
    "environment",
    "root",
];

/// Quantities of other tools.
pub const FOREIGN_QUANTITIES: Dictionary = &[
    ("force", "tension"),
    ("elongation", "stretch"),
    ("extension", "stretch"),
    ("pos", "position"),
    ("vel", "velocity"),
    ("rate", "stretch_rate"),
    ("omega", "omega_body"),
    ("angular_velocity", "omega_body"),
    ("cog", "com"),
    ("cg", "com"),
    ("theta", "angle"),
    ("rotation", "angle"),
    ("displacement", "slide"),
    ("translation", "slide"),
    ("angular_rate", "angle_rate"),
    ("accel", "acceleration"),
    ("alpha", "angular_acceleration"),
    ("omega_dot", "angular_acceleration"),
    ("reaction", "force"),
    ("reaction_force", "force"),
    ("reaction_torque", "torque"),
    ("moment", "torque"),
];

/// Joints of other tools.
pub const FOREIGN_JOINTS: Dictionary = &[
    ("revolute", "hinge"),
    ("pin", "hinge"),
    ("continuous", "hinge"),
    ("ball", "spherical"),
    ("ball_joint", "spherical"),
    ("ball_and_socket", "spherical"),
    ("socket", "spherical"),
    ("weld", "rigid"),
    ("fixed", "rigid"),
    ("lock", "rigid"),
    ("slider", "prismatic"),
    ("slide", "prismatic"),
    ("translational", "prismatic"),
    ("cardan", "universal"),
    ("hooke", "universal"),
    ("u_joint", "universal"),
    ("helical", "screw"),
    ("helix", "screw"),
    ("thread", "screw"),
    ("rod", "distance"),
    ("massless_rod", "distance"),
    ("plane", "planar"),
    ("inline", "point_on_line"),
    ("point_line", "point_on_line"),
    ("inplane", "point_on_plane"),
    ("point_plane", "point_on_plane"),
    ("angle", "constant_angle"),
    ("cv", "constant_velocity"),
    ("cv_joint", "constant_velocity"),
    ("homokinetic", "constant_velocity"),
    ("rzeppa", "constant_velocity"),
    ("rack", "gear"),
    ("rack_and_pinion", "gear"),
    ("mimic", "gear"),
    ("transmission", "gear"),
    ("coupler", "gear"),
    ("belt", "gear"),
    ("chain", "gear"),
    ("worm", "gear"),
    ("pinion", "gear"),
    ("bearing", "hinge"),
    ("axle", "hinge"),
    ("rail", "prismatic"),
    ("cylinder", "cylindrical"),
    ("slot", "point_on_line"),
    ("floating", "free"),
    ("freejoint", "free"),
    ("six_dof", "free"),
];

/// Joints that people expect, and how what they mean is said here.
pub const EXPECTED_JOINTS: Dictionary = &[
    ("rolling", ROLLING),
    ("roll", ROLLING),
    ("rolls", ROLLING),
    ("wheel", ROLLING),
    ("no_slip", ROLLING),
    ("pulley", LED_OVER),
    ("contact", CONTACT),
];

const ROLLING: &str = "what rolls along a line is held to its way by a gear, whose ratio is the radius: `joint way: prismatic from world to carriage.com { axis: x }`, `joint axle: hinge from carriage.com to wheel.com { axis: y }`, `joint rolling: gear from axle.angle to way.slide { ratio: 0.3 m }`; what rolls in any direction cannot be declared";

/// How another tool calls joints, in front of their kind or behind it.
const IS_A_JOINT: &str = "joint";

/// A word of another tool without what says that it is a joint: `universal` of `universal_joint`.
pub fn bare_joint(word: &str) -> &str {
    let behind = word.strip_suffix(IS_A_JOINT);
    let before = || word.strip_prefix(IS_A_JOINT);
    let bare = behind.or_else(before).unwrap_or(word).trim_matches('_');
    if bare.is_empty() { word } else { bare }
}
