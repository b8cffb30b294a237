//! The vocabulary: every item with its clauses and fields, once. The text reader, the TOML reader and writer, and all messages use it.

use super::quantities;

/// An item of the language, or a setting.
#[derive(Debug, PartialEq, Eq)]
pub struct ItemWord {
    /// The keyword.
    pub word: &'static str,
    /// Whether a name follows.
    pub named: bool,
    /// Whether the name may be repeated: `leg[i in 0..3]`.
    pub repeats: bool,
    /// The word that may stand before the keyword; in TOML a key that is `true` or `false`.
    pub mark: Option<&'static str>,
    /// What stands outside the braces, in order: the sign or word before each value.
    pub clauses: &'static [Clause],
    /// The fields between the braces; `None`: no braces.
    pub fields: Option<&'static [&'static str]>,
    /// How it is written.
    pub form: &'static str,
}

/// A value outside the braces of an item.
#[derive(Debug, PartialEq, Eq)]
pub struct Clause {
    /// The sign or word before the value.
    pub sign: &'static str,
    /// Its key in TOML.
    pub key: &'static str,
    /// Whether it must be there.
    pub needed: bool,
}

const fn needs(sign: &'static str, key: &'static str) -> Clause {
    Clause {
        sign,
        key,
        needed: true,
    }
}

const fn may(sign: &'static str, key: &'static str) -> Clause {
    Clause {
        sign,
        key,
        needed: false,
    }
}

/// The key of the clause that holds the path of a file, a string.
pub const FILE: &str = "file";

const VALUE: &[Clause] = &[needs(":", "value")];

const fn setting(word: &'static str, form: &'static str) -> ItemWord {
    ItemWord {
        word,
        named: false,
        repeats: false,
        mark: None,
        clauses: VALUE,
        fields: None,
        form,
    }
}

const fn item(
    word: &'static str,
    clauses: &'static [Clause],
    fields: Option<&'static [&'static str]>,
    form: &'static str,
) -> ItemWord {
    ItemWord {
        word,
        named: true,
        repeats: false,
        mark: None,
        clauses,
        fields,
        form,
    }
}

const fn repeated(item: ItemWord) -> ItemWord {
    ItemWord {
        repeats: true,
        ..item
    }
}

const fn marked(mark: &'static str, item: ItemWord) -> ItemWord {
    ItemWord {
        mark: Some(mark),
        ..item
    }
}

const ENDS: &[Clause] = &[needs("from", "from"), needs("to", "to")];
const LINE_FIELDS: Option<&[&str]> =
    Some(&["free_length", "stiffness", "force", "damping", "at_start"]);
const SPRING_FIELDS: Option<&[&str]> = Some(&["free_length", "stiffness", "damping", "at_start"]);

/// A frame on a body or in the world; the only item inside another.
pub const FRAME: ItemWord = repeated(item(
    "frame",
    &[needs("at", "at"), may("rotated", "rotated")],
    None,
    "frame NAME at [x, y, z] m rotated rpy(a, b, c)",
));

/// The start of a body or a point, and of a joint coordinate, whose value follows a colon.
pub const START: ItemWord = ItemWord {
    word: "start",
    named: false,
    repeats: false,
    mark: None,
    clauses: &[
        may(":", "value"),
        may("at", "at"),
        may("rotated", "rotated"),
        may("velocity", "velocity"),
        may("angular_velocity", "angular_velocity"),
    ],
    fields: None,
    form: "start at [x, y, z] m rotated rpy(a, b, c) velocity [x, y, z] m/s angular_velocity [x, y, z] rad/s",
};

/// Every item and setting of a model.
pub const ITEMS: &[ItemWord] = &[
    setting("coordinates", "coordinates: absolute;"),
    setting("angular_velocity", "angular_velocity: body;"),
    setting("planar", "planar: xz;"),
    setting("origin", "origin: follows NAME;"),
    setting("units", "units: si;"),
    setting("gravity", "gravity: [0.0, 0.0, -9.81] m/s^2;"),
    setting("emit", "emit: [derivative, outputs];"),
    ItemWord {
        word: "urdf",
        named: false,
        repeats: false,
        mark: None,
        clauses: &[needs(":", FILE)],
        fields: Some(&["base", "inertias", "angle", "slide"]),
        form: "urdf: \"robot.urdf\" { base: free }",
    },
    item(
        "extend",
        &[],
        Some(&["frame", "start"]),
        "extend NAME { fields of the body or joint NAME of the URDF }",
    ),
    ItemWord {
        word: "verify",
        named: false,
        repeats: false,
        mark: None,
        clauses: &[],
        fields: None,
        form: "verify;",
    },
    item("const", &[needs("=", "value")], None, "const NAME = 2.1 m;"),
    item(
        "param",
        &[needs("=", "value"), may("in", "in")],
        None,
        "param NAME = 761 kg in 600 kg ..= 900 kg;",
    ),
    repeated(item(
        "input",
        &[needs(":", "kind"), may("=", "value")],
        None,
        "input NAME: force = 0 N;",
    )),
    repeated(item(
        "state",
        &[may(":", "kind"), needs("=", "start")],
        Some(&["rate"]),
        "state NAME = 0 A { rate: expression }",
    )),
    marked(
        "smooth",
        item(
            "table",
            &[needs("=", "value")],
            None,
            "table NAME = { 0 km: 0.0145 kg/m^3, 10 km: 0.006 kg/m^3 };",
        ),
    ),
    repeated(item(
        "let",
        &[needs("=", "value"), may("in", "in")],
        None,
        "let NAME = expression;",
    )),
    ItemWord {
        word: "world",
        named: false,
        repeats: false,
        mark: None,
        clauses: &[],
        fields: Some(&["frame"]),
        form: "world { frame NAME at [x, y, z] m }",
    },
    repeated(item(
        "body",
        &[],
        Some(&[
            "mass",
            "density",
            "center_of_mass",
            "inertia",
            "shape",
            "frame",
            "start",
        ]),
        "body NAME { mass: 2.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }",
    )),
    repeated(item(
        "point",
        &[],
        Some(&["mass", "equilibrium", "start"]),
        "point NAME;",
    )),
    marked(
        "loop",
        repeated(item(
            "joint",
            &[needs(":", "kind"), needs("from", "from"), needs("to", "to")],
            // The joint's own law says which: see `resolve/joints.rs`.
            Some(&[]),
            "joint NAME: hinge from world to body.frame { axis: y }",
        )),
    ),
    repeated(item(
        "line",
        ENDS,
        LINE_FIELDS,
        "line NAME from body.frame to point { free_length: 1.0 m, stiffness: 1.0 kN/m }",
    )),
    repeated(item(
        "spring",
        ENDS,
        SPRING_FIELDS,
        "spring NAME from body.frame to body.frame { free_length: 1.0 m, stiffness: 1.0 kN/m }",
    )),
    repeated(item(
        "load",
        &[
            needs("on", "on"),
            may("at", "at"),
            may(":", "kind"),
            may("=", "value"),
            may("in", "in"),
        ],
        None,
        "load NAME on body at frame = expression;",
    )),
    repeated(item(
        "output",
        &[needs("=", "value"), may("in", "in")],
        None,
        "output NAME = expression;",
    )),
    repeated(item(
        "metric",
        &[needs("=", "value"), may("in", "in")],
        Some(&["level", "at", "from", "to"]),
        "metric NAME = max expression;",
    )),
    repeated(item(
        "event",
        &[
            needs("=", "value"),
            may("crosses", "crosses"),
            may("rises", "rises"),
            may("falls", "falls"),
        ],
        Some(&[
            "set", "detach", "attach", "lock", "free", "then", "map", "acts",
        ]),
        "event NAME = expression crosses value;",
    )),
];

/// Everything that may stand between the braces of a model.
pub fn top_level() -> impl Iterator<Item = &'static ItemWord> {
    ITEMS.iter()
}

/// The item of this keyword at the top (`inside` false) or inside a body or the world.
pub fn find(word: &str, inside: bool) -> Option<&'static ItemWord> {
    if inside {
        [&FRAME, &START].into_iter().find(|item| item.word == word)
    } else {
        ITEMS.iter().find(|item| item.word == word)
    }
}

/// The item that this word may mark.
pub fn marked_by(word: &str) -> Option<&'static ItemWord> {
    ITEMS.iter().find(|item| item.mark == Some(word))
}

/// Whether a word begins an item that has a name and stands outside the braces of every other.
pub fn is_outside(word: &str) -> bool {
    find(word, false).is_some_and(|item| item.named)
}

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
    ("constraint", "joint"),
    ("ground", "world"),
];

/// Items that people expect, and how what they mean is said here, or that it cannot be said yet.
pub const EXPECTED_ITEMS: Dictionary = &[
    ("integral", INTEGRAL),
    ("integrator", INTEGRAL),
    ("ode", INTEGRAL),
    ("der", INTEGRAL),
    ("contact", CONTACT),
    ("collision", CONTACT),
    ("pulley", LED_OVER),
    ("include", ONE_TEXT),
    ("import", ONE_TEXT),
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

const CONTACT: &str = "contact cannot be declared yet; a soft one is a load, such as `load push on body at foot = max(0, -body.foot.position.z) * [0, 0, 100] kN/m`";
/// A line over a pulley.
pub const LED_OVER: &str =
    "a line runs straight from its `from` to its `to`; it cannot be led over a pulley yet";
const A_START: &str = "a start is written with what starts: `joint pin: hinge from world to link.top { axis: y, start: 30 deg }`, `body link { …, start at [0.0, 0.0, 1.0] m }`";
const ONE_TEXT: &str = "a declaration is one text and takes in no other; copy what is shared";
const NO_PARTS: &str = "a declaration has no parts to use again; what is alike is repeated by an index, `body leg[i in 0..3] { … }`";
const REPETITION: &str =
    "what is repeated has an index behind its name, `body leg[i in 0..3] { … }`";
const NO_CONDITION: &str =
    "an item is always there; a value that depends on a condition is `if(a < b, this, that)`";
const NO_FUNCTIONS: &str = "no functions can be declared; a quantity is named by `let`, and a function given by numbers is a `table`";
const INTEGRAL: &str =
    "an integral is a `state` with its rate: `state missed = 0 rad*s { rate: pin.angle }`";
const EFFORT: &str = "what acts along a joint is its field `force`, such as `{ axis: y, force: -2 N*m * hip.angle }`";

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
    ("weight", "mass"),
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
];

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

/// Functions of other tools.
pub const FOREIGN_FUNCTIONS: Dictionary = &[
    ("mag", "norm"),
    ("magnitude", "norm"),
    ("length", "norm"),
    ("pow", "^"),
    ("fabs", "abs"),
    ("inner", "dot"),
    ("log", "ln"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("arctan2", "atan2"),
    ("sgn", "sign"),
    ("signum", "sign"),
    ("saturate", "clamp"),
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
    ("asinh", "write `ln(a + sqrt(a^2 + 1))`"),
    ("acosh", "write `ln(a + sqrt(a^2 - 1))`"),
    ("atanh", "write `0.5 * ln((1 + a) / (1 - a))`"),
    ("sec", "write `1 / cos(a)`"),
    ("csc", "write `1 / sin(a)`"),
    ("cot", "write `1 / tan(a)`"),
    ("sinc", "write `sin(a) / a` where `a` is not zero"),
    ("sind", DEGREES),
    ("cosd", DEGREES),
    ("tand", DEGREES),
    ("sqr", "write `a^2`"),
    ("square", "write `a^2`"),
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

const RATES: &str =
    "rates are quantities: `body.velocity`, `joint.angle_rate`, `line.stretch_rate`";
const DEGREES: &str = "an angle carries its unit: `sin(30 deg)`";
const REMAINDER: &str = "write `a - b * floor(a / b)`";
const NO_CHANCE: &str = "a model has no chance in it: what is random comes by an `input`";
const TABLE_CALL: &str = "a table is called by its own name, `lift(x)`";

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
    ("floating", "free"),
    ("freejoint", "free"),
    ("six_dof", "free"),
];

/// The functions of an expression.
pub const FUNCTIONS: &[&str] = &[
    "norm",
    "dot",
    "cross",
    "min",
    "max",
    "abs",
    "exp",
    "sqrt",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "ln",
    "log10",
    "sign",
    "floor",
    "clamp",
    "smoothstep",
    "if",
    "angle",
    "polar",
];

/// The quantities that `emit` knows.
pub const EMITTED: &[&str] = &[
    "anchor_states",
    "equilibrium",
    "derivative",
    "balance",
    "guards",
    "outputs",
    "energy",
    "momentum",
    "mass_matrix",
    "bias_force",
    "forces",
    "inverse_dynamics",
    "gravity_force",
    "centre_of_mass",
    "centre_of_mass_jacobian",
    "frame_jacobian",
    "lines",
    "constraint",
    "constraint_jacobian",
    "constraint_rate",
    "constraint_bias",
    "multipliers",
    "reactions",
    "projection_step",
    "node_by_anchor",
    "condensed_stiffness",
    "partial",
];

/// Functions whose words are also names of things: they are functions only in front of a bracket.
const FREE_FUNCTIONS: &[&str] = &["floor", "sign", "clamp", "ln", "tan"];

/// Words of the language besides item keywords, functions and units.
const OTHER_RESERVED: &[&str] = &[
    "model",
    "frame",
    "from",
    "to",
    "on",
    "at",
    "in",
    "rotated",
    "crosses",
    "rises",
    "falls",
    "external",
    "time",
    "com",
    "diag",
    "full",
    "rpy",
    "euler_zyx",
    "matrix",
    "none",
    "loop",
];

/// Keywords of Rust that the language writes itself, or that name things of every module.
const OWN_KEYWORDS: &[&str] = &[
    "as", "const", "crate", "else", "false", "if", "in", "let", "loop", "mod", "pub", "self",
    "Self", "super", "true", "_",
];

/// The others: names here, with an underscore behind them where they become fields and functions of Rust.
const KEYWORDS: &[&str] = &[
    "abstract", "async", "await", "become", "box", "break", "continue", "do", "dyn", "enum",
    "extern", "final", "fn", "for", "gen", "impl", "macro", "match", "move", "mut", "override",
    "priv", "ref", "return", "static", "struct", "trait", "try", "type", "typeof", "unsafe",
    "unsized", "use", "virtual", "where", "while", "yield",
];

/// Whether a word is a keyword of Rust.
pub fn is_keyword(word: &str) -> bool {
    KEYWORDS.contains(&word) || OWN_KEYWORDS.contains(&word)
}

/// Whether a word is what a keyword becomes in Rust, or no name there at all.
fn is_unfit(word: &str) -> bool {
    let stem = word.strip_suffix('_').unwrap_or("");
    OWN_KEYWORDS.contains(&word)
        || KEYWORDS.contains(&stem)
        || word.starts_with("__")
        || word.starts_with("r#")
}

/// Why a word cannot be a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reserved {
    /// It has a meaning in the language.
    Language,
    /// Rust has it already, and it cannot be changed: `self`, what begins with two underscores.
    Rust,
}

/// Whether and why a word cannot be the name of an item.
pub fn reserved(word: &str) -> Option<Reserved> {
    let language = ITEMS.iter().any(|item| item.word == word)
        || FUNCTIONS.contains(&word) && !FREE_FUNCTIONS.contains(&word)
        || OTHER_RESERVED.contains(&word);
    if is_unfit(word) {
        Some(Reserved::Rust)
    } else if language {
        Some(Reserved::Language)
    } else {
        None
    }
}

/// Whether a word cannot be the name of a frame: it is a quantity of bodies, or a keyword.
pub fn reserved_frame(word: &str) -> bool {
    quantities::BODY_QUANTITIES.contains(&word)
        || ["com", "on", "at", "in", "from", "to", "rotated"].contains(&word)
        || is_unfit(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_described() {
        let text = include_str!("../../../LANGUAGE.md");
        let described: Vec<&str> = text
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .collect();
        let fields = ITEMS.iter().filter_map(|item| item.fields).flatten();
        let mut all: Vec<&str> = fields.copied().collect();
        all.extend(ITEMS.iter().map(|item| item.word));
        all.extend([FRAME.word, START.word]);
        all.extend([mbd_scene::joints::START_RATE.name]);
        for list in [
            FUNCTIONS,
            quantities::BODY_QUANTITIES,
            quantities::LINE_QUANTITIES,
        ] {
            all.extend(list);
        }
        all.extend(mbd_scene::joints::NUMBERS.iter().map(|field| field.name));
        all.retain(|word| !described.contains(word));
        assert!(all.is_empty(), "not described in LANGUAGE.md: {all:?}");
    }
}
