//! Messages about joints: their kind, their ends, and their fields.

use mbd_scene::joints::{Coordinate, Field, MOTOR, Measured, START, START_RATE};
use mbd_scene::{Dimension, JointLaw};

use crate::lexeme::Region;
use crate::messages::LexemeMessage;
use crate::messages::similar::{all_nearest, did_you_mean};
use crate::messages::syntax::{ended, joint_kind};
use crate::syntax::{foreign, quantities};
use crate::units::{self, described};

pub fn joint_law(at: Region, word: &str) -> LexemeMessage {
    let known = JointLaw::KEYWORDS;
    let answer = if let Some(ours) = joint_kind(word) {
        format!("; here it is called `{ours}`")
    } else if let Some(answer) = foreign::translated(foreign::EXPECTED_JOINTS, word) {
        format!("; {answer}")
    } else {
        format!(
            "{} joints: {}",
            ended(nearest_kind(foreign::bare_joint(word))),
            known.join(", ")
        )
    };
    LexemeMessage::new(at, format!("unknown joint `{word}`{answer}"))
}

/// The kind that was probably meant, by our word for it or by that of another tool.
fn nearest_kind(word: &str) -> String {
    let own = did_you_mean(word, JointLaw::KEYWORDS.iter().copied());
    if !own.is_empty() {
        return own;
    }
    let theirs = foreign::FOREIGN_JOINTS.iter().map(|(theirs, _)| *theirs);
    let near = all_nearest(word, theirs).into_iter();
    let mut ours: Vec<&str> = near
        .filter_map(|theirs| foreign::translated(foreign::FOREIGN_JOINTS, theirs))
        .collect();
    ours.dedup();
    match ours[..] {
        [ours] => format!("; did you mean `{ours}`?"),
        _ => String::new(),
    }
}

pub fn joint_on_massless(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a joint cannot end at the massless point `{name}`: its lines alone place it. give it a `mass`"
        ),
    )
}

pub fn joint_without_axes(
    at: Region,
    keyword: &str,
    end: &str,
    name: &str,
    fitting: &[&str],
) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a `{keyword}` joint needs axes at its `{end}` end, and the point `{name}` has none. joints that can have a point there: {}",
            fitting.join(", ")
        ),
    )
}

pub fn no_coordinates(at: Region, name: &str, keyword: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` is a `{keyword}` joint, which has no coordinate to measure, only `force` and `torque`; ask its bodies, such as `BODY.omega_body`, or `angle(BODY.x, OTHER.x)`"
        ),
    )
}

pub fn no_motor(at: Region, name: &str, coordinate: &Coordinate) -> LexemeMessage {
    let along = coordinate.name;
    LexemeMessage::new(
        at,
        format!(
            "joint `{name}` has no motor along `{along}`: give it `motor:`, its course as a function of `time`"
        ),
    )
}

pub fn motor_as_cause(at: Region, name: &str, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}.{word}` answers to everything that acts, so nothing that acts can depend on it; it can stand in an `output` or an `event`"
        ),
    )
}

pub fn massless_acceleration(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` has no mass: it stands where its lines balance and has no acceleration of its own; give it a `mass`, or ask for its `velocity`"
        ),
    )
}

pub fn energy_of_what(at: Region) -> LexemeMessage {
    let known = quantities::ENERGY_QUANTITIES.join(", ");
    LexemeMessage::new(
        at,
        format!("which energy: `energy.total`? there are: {known}"),
    )
}

pub fn energy_as_cause(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`energy.{word}` is of the whole scene, with what its forces store, so nothing that acts can depend on it; it can stand in an `output` or an `event`"
        ),
    )
}

pub fn energy_of_field(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`energy.{word}` has no value under `gravity: field`, whose potential nobody gives; `energy.kinetic` has one"
        ),
    )
}

pub fn angle_in_space(at: Region, body: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{body}.angle` is a number of planar scenes; in space `{body}.orientation` is the axis times the angle, and joints measure their own angles, `pin.angle`"
        ),
    )
}

pub fn free_from_point(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a `free` joint begins at the world or at a body, not at a point, which has no axes: `from world`",
    )
}

pub fn free_to_world(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a `free` joint ends at a body, such as `to body.com`")
}

pub fn joint_to_itself(at: Region, name: &str, owner: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("both ends of joint `{name}` are on {owner}: it joins nothing"),
    )
}

pub fn axis_in_capitals(at: Region, meant: &str) -> LexemeMessage {
    let text = format!("an axis is a small letter; did you mean `{meant}`?");
    LexemeMessage::new(at, text)
}

pub fn axis_wanted(at: Region, field: &str, example: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "expected a direction: `{field}: {example}`, one of x, y, z, -x, -y, -z, or a vector such as `[0.6, 0.0, 0.8]`"
        ),
    )
}

pub fn zero_axis(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this axis has no direction: its components are finite and not all zero",
    )
}

pub fn one_axis(at: Region, keyword: &str, found: usize, example: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a `{keyword}` joint takes 1 axis, found {found}. write `{example}`"),
    )
}

pub fn two_axes(at: Region, keyword: &str, found: usize, example: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a `{keyword}` joint takes 2 axes, found {found}. write `{example}`: the first fixed in the parent, the second in the child"
        ),
    )
}

pub fn not_perpendicular(at: Region, keyword: &str, degrees: f64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the two axes of a `{keyword}` joint are perpendicular, these enclose {degrees:.4} degrees"
        ),
    )
}

pub fn no_number(
    at: Region,
    keyword: &str,
    name: &str,
    (field, unit): (&str, &str),
) -> LexemeMessage {
    let example = match unit {
        "rad" => "90 deg".to_string(),
        "" => "3.0".to_string(),
        unit => format!("1.0 {unit}"),
    };
    LexemeMessage::new(
        at,
        format!("{keyword} joint `{name}` has no {field}. add `{{ {field}: {example} }}`"),
    )
}

pub fn no_joint_to_couple(at: Region, keyword: &str, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no joint named `{word}`{} a `{keyword}` couples coordinates of joints, such as `from motor.angle`",
            ended(did_you_mean(word, known.iter().copied()))
        ),
    )
}

pub fn coordinate_wanted(at: Region, keyword: &str, word: &str, kind: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a `{keyword}` couples coordinates of joints, such as `from motor.angle`; `{word}` is a {kind}"
        ),
    )
}

pub fn nothing_to_couple(at: Region, name: &str, keyword: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` is a `{keyword}` joint, which has no coordinate to couple; take a joint that has one, such as `hinge` or `prismatic`"
        ),
    )
}

pub fn coordinate_not_rate(at: Region, keyword: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a `{keyword}` couples coordinates themselves, such as `from motor.angle`: their rates and forces follow"
        ),
    )
}

pub fn couples_itself(at: Region, keyword: &str, coordinate: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a `{keyword}` couples two coordinates, and both ends of this one are `{coordinate}`"
        ),
    )
}

pub fn no_common_measure(at: Region, keyword: &str, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "{keyword} `{name}` couples two angles, each known up to a full turn: its ratio must be a fraction of whole numbers up to 1000, such as `43.0 / 20.0`, that is no `param` but may be a `const`; or measure one of them by a `screw`, whose angle counts turns"
        ),
    )
}

pub fn no_single_coordinate(
    at: Region,
    keyword: &str,
    field: &str,
    couples: bool,
) -> LexemeMessage {
    let instead = if [START.name, START_RATE.name].contains(&field) {
        return LexemeMessage::new(
            at,
            format!(
                "a `{keyword}` joint has no single coordinate that could start somewhere; write in the body where it starts: `start at [0.0, 0.0, 1.0] m rotated rpy(0.0, 30 deg, 0.0)`"
            ),
        );
    } else if couples {
        "give it to one of the joints that it couples"
    } else if field == MOTOR.name {
        "take a joint that has one, such as `hinge` or `prismatic`, or let a frame of the `world` move"
    } else {
        "put a `load` or a `spring` between the two bodies"
    };
    LexemeMessage::new(
        at,
        format!(
            "a `{keyword}` joint has no single coordinate for `{field}` to act along; {instead}"
        ),
    )
}

pub fn which_coordinate(
    at: Region,
    keyword: &str,
    field: &str,
    coordinates: &[Coordinate],
) -> LexemeMessage {
    let list: Vec<String> = coordinates
        .iter()
        .map(|c| format!("{} ({})", c.name, Measured::Value.unit(c)))
        .collect();
    let first = coordinates.first().map_or("", |c| c.name);
    LexemeMessage::new(
        at,
        format!(
            "a `{keyword}` joint has coordinates of different units: {}. say which one `{field}` belongs to, such as `{first}: {{ {field}: … }}`",
            list.join(", ")
        ),
    )
}

pub fn coordinate_block(at: Region, coordinate: &Coordinate) -> LexemeMessage {
    let name = coordinate.name;
    let unit = Measured::Damping.unit(coordinate);
    LexemeMessage::new(
        at,
        format!(
            "`{name}` is a coordinate: give it fields in braces, such as `{name}: {{ damping: 1.0 {unit} }}`"
        ),
    )
}

pub fn start_of_motor(at: Region, name: &str, field: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` has a motor, whose course says where it is from the start: leave `{field}` out; a motor behind a `filter` has one"
        ),
    )
}

pub fn start_of_coordinate(at: Region, name: &str, unit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("the start of `{name}` is one number: write `start: 0.5 {unit}`"),
    )
}

pub fn rate_about(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`about` is said of the place where `{name}` starts; of rates the smallest that fit the others are taken: leave `start_rate` out, or write its number alone"
        ),
    )
}

pub fn command_about(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`start` is where the filter of the motor of `{name}` begins, which holds to the digit: leave `about` out"
        ),
    )
}

pub fn start_of_part(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` starts at a place: write `start at [0.0, 0.0, 1.0] m`, with `velocity [1.0, 0.0, 0.0] m/s` behind it if it moves"
        ),
    )
}

pub fn start_of_node(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "point `{name}` has no mass and starts where its lines balance: leave `start` out, or give it a `mass`"
        ),
    )
}

pub fn point_has_no_axes(at: Region, name: &str, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("point `{name}` has no axes that could be rotated: leave `{word}` out"),
    )
}

pub fn start_beside(at: Region, name: &str, plane: &str, what: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{name}` moves in the plane {plane}: its {what} at the start leaves it"),
    )
}

pub fn needs_field(at: Region, name: &str, field: &str, example: &str) -> LexemeMessage {
    let needed = example.split(':').next().unwrap_or_default();
    LexemeMessage::new(
        at,
        format!("`{field}` of `{name}` has no meaning without `{needed}`. add `{example}`"),
    )
}

/// A motor that follows what does not say its rates.
pub fn motor_without_rates(at: Region, name: &str, text: &str, units: [&str; 2]) -> LexemeMessage {
    let [rate, acceleration] = units;
    LexemeMessage::new(
        at,
        format!(
            "the motor of `{name}` needs the rate [{rate}] and the acceleration [{acceleration}] of what it follows: give them beside it, `motor: [{text}, rate, acceleration]`, or let it follow through a filter, `motor: {text}, filter: 20 ms`"
        ),
    )
}

pub fn motor_of_three(at: Region, name: &str, found: usize) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the motor of `{name}` takes three quantities in its brackets, the coordinate, its rate and its acceleration; these are {found}"
        ),
    )
}

pub fn filter_and_rates(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the motor of `{name}` has its rate and its acceleration given, a filter makes them itself: leave out `filter`, or write the first of the three alone"
        ),
    )
}

pub fn along_unit(
    at: Region,
    name: &str,
    field: &str,
    unit: &str,
    found: Result<Dimension, &str>,
) -> LexemeMessage {
    let text = match found {
        Ok(found) => {
            let rate = field == "motor" && [units::RATE, units::SPEED].contains(&found);
            let course = match rate {
                true => {
                    "; a coordinate that goes at a constant rate is where that takes it: the rate times `time`"
                }
                false => "",
            };
            format!(
                "`{field}` of `{name}` must be in {unit}, this is {}{course}",
                described(found)
            )
        }
        Err(bare) => format!(
            "`{field}` of `{name}` needs a unit: write it as `{bare} {unit}`, or put `units: si;` at the top of the model"
        ),
    };
    LexemeMessage::new(at, text)
}

pub fn along_rule(at: Region, name: &str, field: &Field, unit: &str, found: f64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{}` of `{name}` must be {}, this is {}",
            field.name,
            field.rule.words(),
            measured(found, unit)
        ),
    )
}

/// A number in words; angles in degrees, without the last digits, which the way to radians and back has spoilt.
fn measured(found: f64, unit: &str) -> String {
    match unit {
        "rad" => format!("{} deg", (found.to_degrees() * 1e9).round() / 1e9),
        "" => format!("{found}"),
        unit => format!("{found} {unit}"),
    }
}

pub fn two_stops(at: Region, unit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "expected a low and a high stop, such as `stops: [-1.0, 1.0] {unit}`; one of them may be left open: `stops: [none, 1.0 {unit}]`"
        ),
    )
}

pub fn stops_in_order(
    at: Region,
    name: &str,
    places: [Option<f64>; 2],
    unit: &str,
) -> LexemeMessage {
    let [low, high] = places.map(|place| measured(place.unwrap_or(f64::NAN), unit));
    LexemeMessage::new(
        at,
        format!("the low stop of `{name}` lies below the high one, these are {low} and {high}"),
    )
}
