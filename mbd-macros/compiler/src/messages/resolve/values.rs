//! Messages about values: shapes, dimensions, functions.

use mbd_scene::{Dimension, plain};

use crate::lexeme::Region;
use crate::messages::similar::{did_you_mean, slips};
use crate::messages::syntax::ended;
use crate::messages::{LexemeMessage, article};
use crate::syntax::foreign;
use crate::syntax::quantities::{BODY_QUANTITIES, LINE_QUANTITIES};
use crate::syntax::words::FUNCTIONS;
use crate::units::{self, described, si_text};

pub fn not_finite(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this gives no finite number: look for a division by zero, or a root, a logarithm or an arc of what has none",
    )
}

pub fn three_components(at: Region, found: usize) -> LexemeMessage {
    let decimals = match found {
        4.. => "; the sign before decimals is a point",
        2 => "; of what lies in a plane the third one is `0`",
        _ => "",
    };
    LexemeMessage::new(
        at,
        format!("a vector has 3 components, found {found}{decimals}"),
    )
}

/// `axis`: what is said of an axis of a body or a frame.
pub fn scalar_wanted(at: Region, what: &str, axis: Option<&str>) -> LexemeMessage {
    let remedy = axis.unwrap_or("take a component of it, such as `.x`, or its size, `norm(…)`");
    LexemeMessage::new(
        at,
        format!("{what} must be one number, this is a vector: {remedy}"),
    )
}

/// The letter behind a point is its place, behind a body or a frame its axis.
pub fn axis_and_place(owner: &str, letter: &str) -> String {
    format!(
        "`{owner}.{letter}` is its {letter} axis; its place along {letter} is `{owner}.position.{letter}`"
    )
}

/// A note, no mistake: an output may show an axis. `axis`: what is said of it.
pub fn output_of_an_axis(output: &str, axis: &str) -> String {
    format!("output `{output}` has three numbers: {axis}")
}

pub fn vector_wanted(at: Region, what: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("{what} must be a vector such as `[0.0, 0.0, 1.0]`, this is one number"),
    )
}

pub fn mixed_components(at: Region, first: Dimension, this: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the components of a vector must be alike: the first is {}, this is {}",
            described(first),
            described(this)
        ),
    )
}

/// `text`: the bare number among the components of a vector that are in another unit.
pub fn bare_component(at: Region, text: &str, others: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the components of a vector must be alike: beside {} write `{text} {}`",
            described(others),
            si_text(others)
        ),
    )
}

/// `behind`: the dimension of the unit behind the bracket, `own`: that of what stands in it.
pub fn unit_twice(
    at: Region,
    unit: &str,
    behind: Dimension,
    own: Option<Dimension>,
) -> LexemeMessage {
    let own = own.map_or_else(String::new, |own| match own == behind {
        true => " and is no pure number".to_owned(),
        false => format!(": it is {}", described(own)),
    });
    LexemeMessage::new(
        at,
        format!(
            "this does not fit the `{unit}` behind the bracket{own}; give each component its own unit, and none behind"
        ),
    )
}

pub fn no_components(at: Region, axis: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("this is one number and has no component `{axis}`"),
    )
}

pub fn unknown_component(at: Region, axis: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a vector has the components x, y and z, no `{axis}`"),
    )
}

pub fn two_vectors(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "`*` does not multiply two vectors: write `dot(a, b)` or `cross(a, b)`",
    )
}

pub fn divide_by_vector(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "`/` does not divide by a vector; by its length: `norm(a)`",
    )
}

/// `axis`: what is said of the vector, if it is an axis of a body or a frame.
pub fn number_and_vector(at: Region, axis: Option<&str>) -> LexemeMessage {
    let axis = axis.map_or_else(String::new, |axis| format!(": {axis}"));
    LexemeMessage::new(
        at,
        format!("a number and a vector cannot be added or compared{axis}"),
    )
}

pub fn unlike(at: Region, first: Dimension, second: Dimension, bare: bool) -> LexemeMessage {
    let hint = if bare && (first == units::NONE || second == units::NONE) {
        "; the number needs a unit"
    } else {
        ""
    };
    LexemeMessage::new(
        at,
        format!(
            "only like quantities can be added or compared: the first is {}, the second {}{hint}",
            described(first),
            described(second)
        ),
    )
}

pub fn dimension_range(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "no quantity of mechanics has the dimension this would have",
    )
}

pub fn power_of_vector(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "`^` does not take a vector: write `dot(a, a)`")
}

pub fn whole_exponent(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "an exponent is a number between -20 and 20, whole or with a half, such as `a^1.5`; another power of a pure number is `exp(n * ln(a))`",
    )
}

pub fn pure_number_wanted(at: Region, function: &str, found: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{function}` takes a pure number or an angle, this is {}",
            described(found)
        ),
    )
}

pub fn angle_wanted(at: Region, found: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`polar` takes radius, angle, height; this is {}",
            described(found)
        ),
    )
}

/// `tables`: those of the model, which are called as functions are.
pub fn unknown_function(at: Region, word: &str, tables: &[&str]) -> LexemeMessage {
    let why = if let Some(ours) = foreign::translated(foreign::FOREIGN_FUNCTIONS, word) {
        match ours {
            "^" => "; write `a^n`".to_owned(),
            ours => format!("; here it is called `{ours}`"),
        }
    } else if let Some(answer) = foreign::translated(foreign::EXPECTED_FUNCTIONS, word) {
        // Its neighbours in spelling are other functions: none of them is proposed.
        format!("; {answer}")
    } else if is_quantity(word) {
        format!("; a quantity stands behind what has it: `bob.{word}` instead of `{word}(bob)`")
    } else {
        // Of another function of a few letters every letter may be meant.
        let functions = FUNCTIONS.iter().copied();
        let slips = slips(word, functions.clone()).into_iter();
        let near = did_you_mean(word, slips.chain(tables.iter().copied()));
        let known: Vec<&str> = functions.chain(tables.iter().copied()).collect();
        format!("{} functions here: {}", ended(near), known.join(", "))
    };
    LexemeMessage::new(at, format!("unknown function `{word}`{why}"))
}

/// Whether bodies, points, lines or joints have a quantity of this name.
fn is_quantity(word: &str) -> bool {
    let mut lists = [BODY_QUANTITIES, LINE_QUANTITIES].into_iter();
    lists.any(|list| list.contains(&word))
}

/// `number`: what stands before the unit; `place`: where in the unit the name begins; `kind`, `declared`: what else is called so.
pub fn unit_or_name(
    at: Region,
    (number, unit): (&str, &str),
    place: usize,
    word: &str,
    (kind, declared): (&str, Option<Region>),
) -> LexemeMessage {
    let (before, behind) = unit.split_at(place);
    let sign = if before.ends_with('/') { '/' } else { '*' };
    let before = before.trim_end_matches(['*', '/']);
    let behind = behind.replace('*', " * ").replace('/', " / ");
    let article = article(kind);
    let report = LexemeMessage::new(
        at,
        format!(
            "`{unit}` behind a number is read as a unit, and `{word}` is also {article} {kind} of this model: give the {kind} another name, \
             such as `{word}_1`, or write `({number} {before}) {sign} {behind}` for the {kind} and `{number} ({unit})` for the unit"
        ),
    );
    match declared {
        Some(declared) => report.also(declared, format!("the {kind} `{word}`")),
        None => report,
    }
}

/// `number`: what stands above the line, `word`: the unit below it that is a thing of the model, too.
pub fn unit_or_thing(at: Region, number: &str, word: &str, kind: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is a {kind} of this model: write `{number} (1/{word})` for the unit, or give the {kind} another name, such as `{word}_1`"
        ),
    )
}

/// `word`: what stands behind the default of a param.
pub fn range_words(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the range of a param stands behind `in`: write `in 0.5 kg ..= 3 kg` instead of `{word} …`"
        ),
    )
}

pub fn comparison_alone(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, foreign::COMPARISON)
}

pub fn condition_wanted(at: Region) -> LexemeMessage {
    let text = "`if` takes a comparison first: `if(a < b, this, that)` with `<`, `<=`, `>` or `>=`";
    LexemeMessage::new(at, text.to_owned())
}

/// `turns`: what counts them, as it is written.
pub fn turns_for_radians(at: Region, turns: &str, what: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{turns}` counts turns (`Hz`), and {what} takes radians: write `2 * pi * {turns}`, or give it in `rad/s` or `rpm`"
        ),
    )
}

/// `what`: where the angle stands.
pub fn angle_without_unit(at: Region, angle: f64, literal: bool, what: &str) -> LexemeMessage {
    let said = match literal {
        true => format!(
            "{angle} has no unit and would be more than a full turn in radians, which {what} takes: write `{angle} deg`, or `{angle} rad` if that is meant"
        ),
        false => format!(
            "this is made of numbers without a unit and comes to {angle}, more than a full turn in radians, which {what} takes: write a unit where the number stands, `{angle} deg`, or `{angle} rad` if that is meant"
        ),
    };
    LexemeMessage::new(at, said)
}

/// An attitude by an angle of more than a full turn [rad].
pub fn attitude_has_no_turns(at: Region, angle: f64) -> LexemeMessage {
    let [said, same] = [angle, angle % std::f64::consts::TAU].map(|it| plain(it.to_degrees(), 6));
    LexemeMessage::new(
        at,
        format!(
            "an attitude has no turns: {said} deg is {same} deg here; turns are those of a joint, which starts with them by `start: {said} deg`"
        ),
    )
}

pub fn degrees_in_degrees(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a factor of 180/pi makes degrees of radians, and `in deg` does so once more: leave out the factor",
    )
}

pub fn knots_without_unit(at: Region, table: &str, last: f64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "this is an angle, and the arguments of `{table}` go to {last} without a unit, more than a full turn in radians: write `{last} deg` in the table, or `{last} rad` if that is meant"
        ),
    )
}

pub fn state_in_turns(at: Region, turns: &str, state: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{turns}` counts turns (`Hz`), and the state `{state}` is in radians: write `2 * pi * {turns}`, or give it in `rad/s` or `rpm`"
        ),
    )
}

pub fn radians_beside_turns(at: Region, turns: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{turns}` counts turns (`Hz`), and what it is added to or compared with is in radians: write `2 * pi * {turns}`, or give it in `rad/s` or `rpm`"
        ),
    )
}

pub fn turns_wanted(at: Region, what: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "{what} counts turns (`Hz`), and this is in radians: divide it by a turn, `/ (360 deg)`"
        ),
    )
}

pub fn radians_in_turns(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "`Hz` counts turns, and this is an angular rate: write `in rpm` or `in rad/s`, or divide by a turn, `/ (360 deg)` or `/ (2 * pi)`, before `in Hz`",
    )
}

pub fn ends_exchanged(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "the lower end of `clamp(a, low, high)` is above the upper one: exchange them",
    )
}

pub fn argument_count(at: Region, function: &str, wanted: usize, found: usize) -> LexemeMessage {
    let plural = if wanted == 1 { "" } else { "s" };
    LexemeMessage::new(
        at,
        format!("`{function}` takes {wanted} argument{plural}, found {found}"),
    )
}

pub fn needs_unit(at: Region, field: &str, wanted: Dimension, text: &str) -> LexemeMessage {
    let unit = si_text(wanted);
    let kind = units::name(wanted).map_or(unit.clone(), |name| format!("{name} ({unit})"));
    LexemeMessage::new(
        at,
        format!(
            "`{field}` needs a unit: {kind}. write it as `{text} {unit}`, or put `units: si;` at the top of the model"
        ),
    )
}

pub fn unit_of_output(at: Region, text: &str, unit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{text}` has no unit, and the output beside it is told in {unit}: write `{text} {unit}`"
        ),
    )
}

pub fn length_per_angle(at: Region, field: &str, written: &str) -> LexemeMessage {
    let length = written.split('/').next().unwrap_or_default().trim();
    let remedy = match written.contains('/') {
        true => format!("write `{field}: {length}`"),
        false => "leave out the angle where it is declared".to_string(),
    };
    let what = match field {
        "pitch" => "the length of a full turn",
        _ => "a length",
    };
    LexemeMessage::new(
        at,
        format!("`{field}` is {what}, and this is one per angle: {remedy}"),
    )
}

pub fn wrong_range(at: Region, param: &str, wanted: Dimension, found: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the range of `{param}` must be {}, as its value is; this is {}",
            described(wanted),
            described(found)
        ),
    )
}

/// `unit`: what stands behind `in`.
pub fn cannot_be_told_in(at: Region, unit: &str, found: Dimension) -> LexemeMessage {
    let (what, remedy) = match found {
        units::NONE => (
            "a pure number or an angle".to_owned(),
            "write `in deg` or `in rad` for an angle, nothing for a number".to_owned(),
        ),
        units::RATE => (
            "a rate (1/s)".to_owned(),
            "write `in rad/s` or `in rpm` for an angular rate, else `in 1/s`".to_owned(),
        ),
        found => (
            described(found),
            format!("write `in {}` or another unit of it", si_text(found)),
        ),
    };
    LexemeMessage::new(
        at,
        format!("what stands before `in` is {what}, which cannot be told in `{unit}`: {remedy}"),
    )
}

pub fn wrong_dimension(
    at: Region,
    field: &str,
    wanted: Dimension,
    found: Dimension,
) -> LexemeMessage {
    let wanted = if wanted == units::NONE {
        "a pure number or an angle".to_string()
    } else {
        format!("in {}", si_text(wanted))
    };
    LexemeMessage::new(
        at,
        format!("`{field}` must be {wanted}, this is {}", described(found)),
    )
}
