//! Messages about items: their names, fields, and what they hold.

use mbd_scene::Dimension;
use mbd_scene::solids::Solid;

use crate::check::WrongInertia;
use crate::lexeme::Region;
use crate::messages::similar::did_you_mean;
use crate::messages::syntax::ended;
use crate::messages::{LexemeMessage, article};
use crate::syntax::{foreign, words};
use crate::units::{self, described, si_text};

pub fn twice(at: Region, word: &str, first: Region) -> LexemeMessage {
    LexemeMessage::new(at, format!("the name `{word}` is used twice in this model"))
        .also(first, "first used here")
}

pub fn rust_as_name(at: Region, word: &str) -> LexemeMessage {
    let another = word.trim_matches('_').trim_start_matches("r#");
    let another = match another {
        "" => "another".to_owned(),
        stem if stem != word && words::reserved(stem).is_none() => format!("`{stem}`"),
        stem => format!("another, such as `{stem}_1`"),
    };
    LexemeMessage::new(
        at,
        format!(
            "`{word}` cannot be a name: names become fields and functions of Rust; choose {another}"
        ),
    )
}

pub fn reversed_repetition(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this repetition ends below its start: write the smaller number first",
    )
}

pub fn index_twice(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{word}` is already the index of the repetition around this one; choose another"),
    )
}

pub fn too_many(at: Region, most: usize, found: usize) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a model may hold at most {most} repeated things, frames counted; with these it would hold {found}"
        ),
    )
}

pub fn circular(at: Region, kind: &str, name: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("{kind} `{name}` depends on itself"))
}

pub fn vector_param(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a param is one number, this is a vector: write a param for each component that varies, and a `let` such as `let wind = [wind_x, wind_y, 0.0];`",
    )
}

/// What to write where a const names a param.
pub const LET_OF_PARAMS: &str = "write `let` instead of `const`: a `let` may use params";

/// What a `let` depends on, as it follows "not": of its name at a place where it cannot stand.
pub fn let_of(name: &str, on: &str) -> String {
    format!("the let `{name}`, which depends on `{on}`")
}

pub fn let_as_cause(at: Region, name: &str, on: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the let `{name}` depends on `{on}`, which answers to everything that acts, so nothing that acts can depend on it; it can stand in an `output` or an `event`"
        ),
    )
}

pub fn deep_let(at: Region, name: &str, most: usize) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "let `{name}` rests on too many others, one inside the other (at most {most} operations deep): name fewer of them in a row"
        ),
    )
}

pub fn let_in_si(at: Region, si: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a `let` holds its value in SI: write `in {si}`, or leave `in` out"),
    )
}

pub fn empty_range(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("the range of `{name}` is empty: its end is below its start"),
    )
}

pub fn default_outside(at: Region, name: &str, range: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("the default of `{name}` lies outside its own range"),
    )
    .also(range, "its range")
}

pub fn state_without_rate(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "state `{name}` has no rate: write how fast it changes, such as `{{ rate: (u - {name}) / (20 ms) }}`; a number that stays is a `const` or a `param`"
        ),
    )
}

pub fn state_of_three(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a state is one number: declare one a component, `state {name}_x: … = …`, or several at once, `state {name}[i in 0..3]: … = …`"
        ),
    )
}

pub fn state_without_unit(at: Region, name: &str, own: Dimension) -> LexemeMessage {
    let unit = si_text(own);
    LexemeMessage::new(
        at,
        format!(
            "with this rate `{name}` is {}: give its start the unit, `state {name} = 0 {unit} {{ … }}`",
            described(own)
        ),
    )
}

pub fn input_type(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected the kind of the input: a quantity or a unit of SI, such as `speed`, `N*m` or `[speed; 3]`",
    )
}

pub fn input_in_one_text(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "in TOML the default of an input is a key of its own: `{ kind = \"speed\", value = \"[8, 0, 0] m/s\" }`",
    )
}

pub fn unknown_input_type(at: Region, word: &str) -> LexemeMessage {
    let known = units::quantities();
    if word == "table" {
        return LexemeMessage::new(
            at,
            "an input is one number or three; values over time are a table, `table wind = { 0 s: 0 m/s, 10 s: 8 m/s };`, used as `wind(time)`",
        );
    }
    LexemeMessage::new(
        at,
        format!(
            "unknown quantity `{word}`{} write a unit, or one of: {}",
            ended(did_you_mean(word, known.iter().copied())),
            known.join(", ")
        ),
    )
}

pub fn input_in_si(at: Region, dimension: Dimension) -> LexemeMessage {
    let unit = si_text(dimension);
    let unit = if unit == "1" { "rad".to_string() } else { unit };
    LexemeMessage::new(
        at,
        format!("the unit behind this name is one of SI: write `{unit}`"),
    )
}

pub fn unknown_field(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    let ours =
        foreign::translated(foreign::FOREIGN_FIELDS, word).filter(|ours| known.contains(ours));
    if let Some(answer) = foreign::translated(foreign::EXPECTED_FIELDS, word) {
        return LexemeMessage::new(at, format!("unknown field `{word}`; {answer}"));
    }
    let suggestion = match ours {
        Some(ours) => format!("; here it is called `{ours}`."),
        None => ended(did_you_mean(word, known.iter().copied())),
    };
    let list = match known {
        [] => "there are no fields here".to_string(),
        // Those of an event.
        [.., "acts"] if suggestion == "." => format!(
            "fields here: {}; a param or a state gets another value by `set: {word} = …`",
            known.join(", ")
        ),
        known => format!("fields here: {}", known.join(", ")),
    };
    LexemeMessage::new(at, format!("unknown field `{word}`{suggestion} {list}"))
}

pub fn sign(
    at: Region,
    owner: &str,
    field: &str,
    found: f64,
    dimension: Dimension,
    positive: bool,
) -> LexemeMessage {
    let wanted = if positive {
        "positive"
    } else {
        "zero or positive"
    };
    LexemeMessage::new(
        at,
        format!(
            "`{field}` of `{owner}` must be {wanted}, this is {found} {}",
            si_text(dimension)
        ),
    )
}

pub fn no_mass(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "body `{name}` has no mass. add `mass: 1.0 kg`; for a massless junction of lines use `point {name};`"
        ),
    )
}

pub fn no_inertia(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "body `{name}` has no inertia. add `inertia: diag(1.0, 1.0, 1.0) kg*m^2`, or `shape: box [0.2, 0.3, 0.4] m`, from which it follows; for a mass without rotation use `point {name} {{ mass: 1.0 kg }}`"
        ),
    )
}

pub fn no_field(at: Region, kind: &str, name: &str, field: &str, unit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("{kind} `{name}` has no {field}. add `{field}: 1.0 {unit}`"),
    )
}

pub fn length_and_rate(at: Region, name: &str, found: usize) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`free_length` of `{name}` takes two quantities in its brackets, the free length and its rate; these are {found}"
        ),
    )
}

pub fn wound_line_at_node(at: Region, name: &str, point: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the free length of `{name}` changes during a run, which a line that ends at the massless point `{point}` cannot do; give the point a `mass`, or wind a line that ends at bodies and the world"
        ),
    )
}

pub fn wound_by_itself(at: Region, name: &str, through: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` is damped, so that its tension depends on the rate of its free length, and that on its tension, through the state `{through}`; leave out its `damping`, or let a state of its own follow the tension: `state felt = 0 N {{ rate: ({name}.tension - felt) / (10 ms) }}`"
        ),
    )
}

pub fn force_and_stiffness(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("line `{name}` has a `force`, a table, and a `stiffness`: give one of them"),
    )
}

pub fn inertia_of_shape(at: Region, shape: &str) -> Option<LexemeMessage> {
    let ours = foreign::translated(foreign::FOREIGN_SHAPES, shape).unwrap_or(shape);
    let solid = Solid::ALL.iter().find(|solid| solid.keyword() == ours)?;
    let text = format!(
        "an inertia is given by its numbers; leave it out, and it follows from `shape: {}` and the mass",
        solid_form(*solid)
    );
    Some(LexemeMessage::new(at, text))
}

/// A shape as it is written.
fn solid_form(solid: Solid) -> String {
    let word = solid.keyword();
    match solid {
        Solid::Box => format!("{word} [0.2, 0.3, 0.4] m"),
        _ => {
            let sizes = solid.sizes().iter();
            let sizes: Vec<String> = sizes.map(|size| format!("{size}: 0.1 m")).collect();
            format!("{word} {{ {} }}", sizes.join(", "))
        }
    }
}

pub fn shape_form(at: Region, found: Option<&str>) -> LexemeMessage {
    let known = || Solid::ALL.iter().map(|solid| solid.keyword());
    let list: Vec<&str> = known().collect();
    let list = format!(
        "shapes here: {}, as in `shape: {}`, several in brackets",
        list.join(", "),
        solid_form(Solid::Box)
    );
    let Some(found) = found else {
        return LexemeMessage::new(at, format!("expected a shape. {list}"));
    };
    if found == "mesh" {
        return LexemeMessage::new(at, foreign::NO_MESH.to_string());
    }
    let suggestion = match foreign::translated(foreign::FOREIGN_SHAPES, found) {
        Some(ours) => format!("; here it is called `{ours}`."),
        None => ended(did_you_mean(found, known())),
    };
    LexemeMessage::new(at, format!("unknown shape `{found}`{suggestion} {list}"))
}

pub fn shape_sizes(at: Region, solid: Solid) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a {} is written `{}`", solid.keyword(), solid_form(solid)),
    )
}

pub fn missing_size(at: Region, solid: Solid, word: &str) -> LexemeMessage {
    let word = format!("the {} has no `{word}`", solid.keyword());
    LexemeMessage::new(at, format!("{word}: write `{}`", solid_form(solid)))
}

pub fn tube_without_wall(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the tube of `{name}` has no wall: its `inner` radius must be smaller than its `radius`"
        ),
    )
}

pub fn no_edge(at: Region, name: &str, axis: &str, found: f64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("the box of `{name}` is {found} m along {axis}: its edges must be positive"),
    )
}

pub fn mass_and_density(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("body `{name}` has a `mass` and a `density`: give one of them"),
    )
}

pub fn density_alone(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the `density` of `{name}` has nothing to fill: give a `mass`; or give a `shape` and no `inertia`, and mass and inertia follow from both"
        ),
    )
}

pub fn center_of_shapes(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the centre of mass of `{name}` follows from its shapes, as its inertia does: leave out `center_of_mass`, or give `inertia`"
        ),
    )
}

pub fn range_of_sign(
    at: Region,
    (owner, field): (&str, &str),
    param: &str,
    low: f64,
    dimension: Dimension,
) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{field}` of `{owner}` cannot be negative, and the range of `{param}` goes down to {low} {}: begin it above zero",
            si_text(dimension)
        ),
    )
}

pub fn inertia_form(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected an inertia such as `diag(1.0, 1.0, 2.0) kg*m^2`, or `full { xx: 1.0, yy: 1.0, zz: 2.0, xy: 0.1 } kg*m^2 (matrix elements)`",
    )
}

pub fn missing_element(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("the inertia has no element `{word}`"))
}

pub fn products_sign(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "say how products are meant: `(matrix elements)`, xy = -∫ x y dm, or `(products of inertia)`, xy = +∫ x y dm",
    )
}

pub fn impossible_inertia(at: Region, owner: &str, wrong: WrongInertia) -> LexemeMessage {
    let text = match wrong {
        WrongInertia::NotPositive(_) => format!(
            "the inertia of `{owner}` must be positive about every axis: {}",
            no_body(wrong)
        ),
        WrongInertia::Triangle(..) => format!(
            "{}. check the unit, and that it is about the centre of mass",
            no_body(wrong)
        ),
    };
    LexemeMessage::new(at, text)
}

/// Why principal moments are those of no rigid body.
pub fn no_body(wrong: WrongInertia) -> String {
    match wrong {
        WrongInertia::NotPositive(smallest) => format!(
            "its smallest principal moment is {} kg*m^2",
            short(smallest)
        ),
        WrongInertia::Triangle(largest, others) => format!(
            "no rigid body has these principal moments: the largest ({}) exceeds the sum of the other two ({})",
            short(largest),
            short(others)
        ),
    }
}

/// A number with six digits, without zeros at its end.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let digits = 5 - value.abs().log10().floor().clamp(-300.0, 300.0) as i32;
    let scale = 10f64.powi(digits);
    let rounded = (value * scale).round() / scale;
    rounded.to_string()
}

pub fn rotation_form(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected a rotation: `about(axis, angle)`, `rpy(roll, pitch, yaw)` about fixed axes, `euler_zyx(yaw, pitch, roll)` about moving axes, or `matrix(row, row, row)`",
    )
}

pub fn no_rotation(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this matrix is no rotation: its rows must be perpendicular unit vectors in right-handed order",
    )
}

pub fn unknown_word(at: Region, what: &str, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "unknown {what} `{word}`{} known: {}",
            ended(did_you_mean(word, known.iter().copied())),
            known.join(", ")
        ),
    )
}

pub fn unknown_gravity(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    let report = unknown_word(at, "gravity", word, known);
    let text = report.text;
    LexemeMessage::new(
        at,
        format!(
            "{text}; where it is uniform it is a vector, such as `[0, 0, -9.81] m/s^2` where z points up"
        ),
    )
}

pub fn mass_and_equilibrium(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "point `{name}` has a mass and an equilibrium: a point with mass moves by Newton's law, so remove one"
        ),
    )
}

pub fn load_twice(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a load has a value after `=`, or is `: external`, not both",
    )
}

pub fn load_without_value(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this load has no value: write `= expression`, or `: external`",
    )
}

pub fn load_kind(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected `external`; a load that is an expression is written with `=`",
    )
}

/// `in body` behind a load on a body of this name.
pub fn load_axes(at: Region, body: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a load is given in the axes of the world, and `in` takes its unit; along the axes of a body it is written with them: `fx * {body}.x + fy * {body}.y + fz * {body}.z`"
        ),
    )
}

pub fn load_on_world(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a load on the world moves nothing: name a body or a point",
    )
}

pub fn load_on_joint(at: Region, joint: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a load acts on a body or a point, and `{joint}` is a joint; what acts along its coordinate is its field `force`, such as `{{ axis: y, force: 3 N*m }}`"
        ),
    )
}

pub fn load_on_frame(at: Region, body: &str, frame: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("write `on {body} at {frame}`"))
}

pub fn load_at(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected the name of a frame of the body, such as `at com`",
    )
}

pub fn load_at_point(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a load on a point needs no `at`: remove it")
}

pub fn load_is_scalar(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a load must be a vector, this is one number: multiply it by a direction, such as `body.z`",
    )
}

pub fn load_dimension(at: Region, found: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a load is a force (N) or a couple (N*m), this is {}",
            described(found)
        ),
    )
}

pub fn couple_on_point(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{name}` is a point and takes no couple (N*m): it does not rotate"),
    )
}

pub fn load_on_node(at: Region, node: &str, culprit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a load on the massless point `{node}` cannot depend on `{culprit}`: the place of a node follows from the balance of its forces. give the point a mass, or use the motion of a body"
        ),
    )
}

pub fn event_without_value(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this event has no crossing: write `crosses`, `rises` or `falls` and a value",
    )
}

pub fn name_wanted(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a name stands here, or several in brackets: `[a, b]`")
}

pub fn setting_wanted(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "what is set is written `name = value`, several in brackets: `[a = 1 m, b = 2 kg]`",
    )
}

pub fn event_names_twice(at: Region, name: &str, first: Region) -> LexemeMessage {
    LexemeMessage::new(at, format!("this event names `{name}` twice"))
        .also(first, "first named here")
}

pub fn no_line_of_event(at: Region, action: &str, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no line, spring or joint named `{word}` to {action}{}",
            known_or_near(word, known)
        ),
    )
}

pub fn not_a_line_of_event(at: Region, action: &str, word: &str, kind: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is {} {kind}; lines, springs and joints are what an event can {action}",
            article(kind)
        ),
    )
}

pub fn holds_nothing(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("the joint `{name}` holds nothing that could be detached"),
    )
}

pub fn stopped_joint_detached(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the joint `{name}` has stops and cannot be detached: give the stops to a joint that stays, or leave them out"
        ),
    )
}

pub fn coupled_joint_detached(at: Region, name: &str, other: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{other}` couples coordinates of the joint `{name}`, which then cannot be detached: detach `{other}`, or couple others"
        ),
    )
}

pub fn nothing_to_set(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no param or state named `{word}` to set{}",
            known_or_near(word, known)
        ),
    )
}

/// What is near a name, or all there is.
pub(super) fn known_or_near(word: &str, known: &[&str]) -> String {
    let near = did_you_mean(word, known.iter().copied());
    match (near.is_empty(), known.is_empty()) {
        (false, _) => near,
        (true, true) => "; there is none".to_owned(),
        (true, false) => format!("; there are: {}", known.join(", ")),
    }
}

pub fn cannot_be_set(at: Region, word: &str, kind: &str) -> LexemeMessage {
    let why = match kind {
        "const" => format!("a const is folded into the code: declare it `param {word} = …`"),
        "event" => "an event is told by itself".to_owned(),
        "input" => "inputs are given by the program that runs the model".to_owned(),
        "let" => "a let says what follows from other numbers: set one of these".to_owned(),
        _ => "what moves is moved by forces".to_owned(),
    };
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is {} {kind}, and events set params and states; {why}",
            article(kind)
        ),
    )
}

pub fn moving_set(at: Region, path: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{path}` cannot be set: events set params and states alone; what moves is moved by forces, and its speed jumps where `attach` or `lock` takes hold"
        ),
    )
}

pub fn set_to_no_number(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("`{name}` is set to what is no finite number"))
}

pub fn set_outside(at: Region, name: &str, found: f64, [low, high]: [f64; 2]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` is set to {}, outside its range {} ..= {} (SI units)",
            short(found),
            short(low),
            short(high)
        ),
    )
}

pub fn event_twice(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "an event has one of `crosses`, `rises` and `falls`")
}

pub fn no_gravity(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "no gravity is declared: write `gravity: [0.0, 0.0, -9.81] m/s^2;`, or `gravity: none;` if there is none",
    )
}

pub fn gravity_of_one(at: Region, number: &str, unit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("gravity has a direction: write `[0, 0, -{number}] {unit}` where z points up"),
    )
}

pub fn gravity_field(at: Region, field: &str, wanted: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "this gravity has no `{field}`: add it, {}",
            described(wanted)
        ),
    )
}

pub fn no_direction(at: Region, length: f64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`axis` must be a unit vector, this one has the length {}",
            short(length)
        ),
    )
}
