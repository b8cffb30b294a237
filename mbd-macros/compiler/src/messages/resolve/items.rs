//! Messages about items: their names, fields, and what they hold.

use mbd_scene::Dimension;

use crate::lexeme::Region;
use crate::messages::LexemeMessage;
use crate::messages::similar::did_you_mean;
use crate::messages::syntax::{ended, unknown_unit};
use crate::syntax::{foreign, words};
use crate::units::{self, described, si_text};

pub fn twice(at: Region, word: &str, first: Region) -> LexemeMessage {
    LexemeMessage::new(at, format!("the name `{word}` is used twice in this model"))
        .also(first, "first used here")
}

pub fn rust_as_name(at: Region, word: &str) -> LexemeMessage {
    let another = word.trim_matches('_').trim_start_matches("r#");
    if word.strip_suffix('_') == Some(another) && words::is_keyword(another) {
        // The language has the name that is meant.
        let text = format!(
            "`{word}` cannot be a name: it is what the name `{another}` becomes in Rust, where `{another}` is a keyword; write `{another}`"
        );
        return LexemeMessage::new(at, text);
    }
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
    let unit = match units::find(name) {
        Some(_) => format!(
            "; where the unit is meant, write it in brackets, `3 (1/{name})`, or give the {kind} another name, such as `{name}_1`"
        ),
        None => String::new(),
    };
    LexemeMessage::new(at, format!("{kind} `{name}` depends on itself{unit}"))
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
            "state `{name}` has no rate: write how fast it changes, such as `{{ rate: (u - {name}) / (20 ms) }}`; a number that stays is a `const` or a `param`, and one that events alone `set` has `{{ rate: 0 }}`"
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

pub fn input_count(at: Region, name: &str, kind: &str, count: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "an input is one number or a vector of three; {count} of them are a repetition: `input {name}[i in 0..{count}]: {kind};`"
        ),
    )
}

pub fn input_of_no_kind(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "what `{name}` measures is open: give its kind, `input {name}: force;`, a value, `input {name} = 6 V;`, or both, `input {name}: force = 2 N;`; in TOML `kind` and `value`"
        ),
    )
}

/// An input whose value is a bare number stands where something with a unit is wanted.
pub fn input_without_unit(at: Region, input: (&str, bool), wanted: Dimension) -> LexemeMessage {
    let ((name, vector), unit) = (input, si_text(wanted));
    let value = if vector { "[0, 0, 0]" } else { "0" };
    LexemeMessage::new(
        at,
        format!(
            "`{name}` is a pure number, since its value has no unit; here it is {}: give it the unit, `input {name} = {value} {unit};`",
            described(wanted)
        ),
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
    if units::is_answered(word) {
        return unknown_unit(at, word);
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

/// What is near a name, or all there is.
pub(super) fn known_or_near(word: &str, known: &[&str]) -> String {
    let near = did_you_mean(word, known.iter().copied());
    match (near.is_empty(), known.is_empty()) {
        (false, _) => near,
        (true, true) => "; there is none".to_owned(),
        (true, false) => format!("; there are: {}", known.join(", ")),
    }
}

/// A number with six digits, without zeros at its end.
pub(super) fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let digits = 5 - value.abs().log10().floor().clamp(-300.0, 300.0) as i32;
    let scale = 10f64.powi(digits);
    let rounded = (value * scale).round() / scale;
    rounded.to_string()
}
