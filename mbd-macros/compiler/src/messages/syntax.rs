//! Messages of reading: what cannot be lexed or parsed.

use super::{LexemeMessage, article};
use mbd_scene::{JointLaw, Unit};

use super::resolve;
use super::similar::{self, did_you_mean};
use crate::lexeme::{Bracket, LexemeIndex, Region};
use crate::syntax::foreign;
use crate::syntax::words::{self, ItemWord};

pub fn attribute(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "attributes have no meaning here; only doc comments (`/// …`) are taken over",
    )
}

pub fn hash_comment(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a comment begins with `//`")
}

pub fn too_deep(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "brackets nest too deeply here: give a part of it a name with `const`, or use fewer brackets",
    )
}

pub fn one_text(at: Region, word: &str) -> Option<LexemeMessage> {
    let answer = foreign::translated(foreign::EXPECTED_ITEMS, word)?;
    Some(LexemeMessage::new(at, answer))
}

/// `table gas = "gas.csv"`
pub fn table_of_a_file(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, foreign::NO_FILE_OF_TABLE)
}

pub fn string(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "strings have no meaning here: write names, numbers and units without quotes",
    )
}

#[cfg(feature = "format")]
pub fn would_change(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this declaration cannot be formatted without changing what it says, which is a mistake of the formatter; it stays as it is",
    )
}

#[cfg(feature = "format")]
pub fn template(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this declaration has a `$` in it, so that it is a template of `macro_rules!`; it stays as it is",
    )
}

pub fn open_comment(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "this comment is never closed: add `*/`")
}

pub fn open_bracket(
    bracket: Bracket,
    at: Region,
    before: Option<(&str, LexemeIndex)>,
) -> LexemeMessage {
    let (open, close) = bracket.signs();
    let report = LexemeMessage::new(at, format!("this `{open}` is never closed: add `{close}`"));
    match before {
        Some((next, here)) => report.also(here.into(), format!("probably before this `{next}`")),
        None => report,
    }
}

pub fn stray_bracket(
    sign: char,
    at: Region,
    waiting: Option<(Bracket, LexemeIndex)>,
) -> LexemeMessage {
    match waiting {
        Some((bracket, open)) => {
            let (begin, end) = bracket.signs();
            LexemeMessage::new(at, format!("expected `{end}` before this `{sign}`"))
                .also(open.into(), format!("to close this `{begin}`"))
        }
        None => LexemeMessage::new(at, format!("this `{sign}` closes nothing: remove it")),
    }
}

pub fn foreign_sign(sign: char, at: Region) -> LexemeMessage {
    let hint = match sign {
        '²' => ": write `^2`",
        '³' => ": write `^3`",
        '·' | '×' | '⋅' | '∙' | '•' => ": write `*`",
        '÷' => ": write `/`",
        '≤' => ": write `<=`",
        '≥' => ": write `>=`",
        '√' => ": write `sqrt(a)`",
        '−' => ": write `-`",
        '°' => ": write `deg`",
        _ => "",
    };
    LexemeMessage::new(at, format!("`{sign}` has no meaning here{hint}"))
}

pub fn expected(at: Region, what: &str, found: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("expected {what}, found `{found}`"))
}

/// `ours`: the word before a value that is meant.
pub fn misspelt_word(at: Region, what: &str, found: &str, ours: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("expected {what}, found `{found}`; did you mean `{ours}`?"),
    )
}

/// A unit behind what is computed, or behind a name.
pub fn unit_behind_value(at: Region, unit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a unit stands behind a number; what is computed or has a name has its own: leave `{unit}` out, or write `* 1 {unit}` for so many of it"
        ),
    )
}

pub fn no_number(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{word}` cannot stand here: {}", foreign::NOT_FINITE),
    )
}

/// `.5`: a number begins with a digit.
pub fn leading_point(at: Region, digits: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a number begins with a digit: write `0.{digits}` instead of `.{digits}`"),
    )
}

pub fn expected_at_end(at: Region, what: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("expected {what} after this"))
}

pub fn no_model(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected a model: write `pub model Name { … }`, or `pub model Name<T> { … }` for more than f64",
    )
}

pub fn after_model(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "one call declares one model: nothing may follow its `}`",
    )
}

pub fn marks_another(at: Region, mark: &str, marked: &ItemWord) -> LexemeMessage {
    let what = match marked.word {
        "joint" => "a joint that closes a loop: `loop joint NAME: …`",
        _ => "a table without kinks: `smooth table NAME = …`",
    };
    LexemeMessage::new(at, format!("`{mark}` marks {what}"))
}

pub fn unknown_item(at: Region, word: &str) -> LexemeMessage {
    let known: Vec<&str> = words::top_level().map(|item| item.word).collect();
    let why = if let Some(ours) = foreign::translated(foreign::FOREIGN_ITEMS, word) {
        format!("; here it is called `{ours}`")
    } else if let Some(answer) = foreign::translated(foreign::EXPECTED_ITEMS, word) {
        format!("; {answer}")
    } else if let Some(kind) = joint_kind(word) {
        let form = joint_form(kind);
        format!("; `{kind}` is a kind of joint, `{form}`")
    } else if let Some(answer) = foreign::translated(foreign::EXPECTED_JOINTS, word) {
        format!("; {answer}")
    } else if similar::nearest(word, known.iter().copied().chain([THE_RUN])) == Some(THE_RUN) {
        let answer = foreign::translated(foreign::EXPECTED_ITEMS, THE_RUN).unwrap_or_default();
        format!("; did you mean `{THE_RUN}`? {answer}")
    } else {
        let near = did_you_mean(word, known.iter().copied());
        format!("{} items here: {}", ended(near), known.join(", "))
    };
    LexemeMessage::new(at, format!("unknown item `{word}`{why}"))
}

/// `L = 0.8 m;`: what is named without saying what it is.
pub fn number_without_item(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "what has a name says what it is: `const {word} = …` for a number, `param {word} = …` for one that changes from run to run, `let {word} = …` for an expression"
        ),
    )
}

/// `word`: the beginning of what is shown, where the name is wanted.
pub fn shown_without_name(at: Region, item: &ItemWord, word: &str) -> LexemeMessage {
    let (kind, article) = (item.word, article(item.word));
    LexemeMessage::new(
        at,
        format!("{article} `{kind}` has a name of its own: write `{kind} NAME = {word}.…`"),
    )
}

/// The settings of a run, which are no item.
const THE_RUN: &str = "run";

/// The joint that a word means, in the language or in that of another tool.
pub fn joint_kind(word: &str) -> Option<&'static str> {
    let kind = |word: &str| {
        let own = JointLaw::KEYWORDS.iter().find(|known| **known == word);
        own.copied()
            .or_else(|| foreign::translated(foreign::FOREIGN_JOINTS, word))
    };
    kind(word).or_else(|| kind(foreign::bare_joint(word)))
}

/// How a joint of this kind is written.
fn joint_form(kind: &str) -> String {
    match kind {
        "gear" => "joint NAME: gear from motor.angle to wheel.angle { ratio: 2.0 }".to_owned(),
        kind => format!("joint NAME: {kind} from world to body.frame"),
    }
}

pub fn led_over(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, foreign::LED_OVER)
}

pub fn conditional_end(at: Region, item: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "an end of a `{item}` is one place, under no condition: declare the one that differs by itself, and repeat the others, as in `{item} NAME[i in 1..4]`"
        ),
    )
}

pub fn closed_before(at: Region, next: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{next}` does not stand between braces: close the item before it by `}}`"),
    )
}

/// A suggestion with a full stop when there is none.
pub fn ended(suggestion: String) -> String {
    if suggestion.is_empty() {
        ".".to_string()
    } else {
        suggestion
    }
}

pub fn no_name(at: Region, item: &ItemWord) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "{} `{}` needs a name: `{}`",
            article(item.word),
            item.word,
            item.form
        ),
    )
}

/// Of `line[i in 0..2] sling`.
pub fn index_before_name(at: Region, item: &ItemWord, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the index of {} `{}` stands behind its name: `{} {name}[i in 0..3]`",
            article(item.word),
            item.word,
            item.word
        ),
    )
}

pub fn reserved_name(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{word}` is a word of the language and cannot be a name here; choose another"),
    )
}

pub fn long_name(at: Region, word: &str, most: usize) -> LexemeMessage {
    let begins: String = word.chars().take(20).collect();
    LexemeMessage::new(
        at,
        format!(
            "the name `{begins}…` has {} bytes: files and columns are called by it, and a name has at most {most}",
            word.len()
        ),
    )
}

pub fn form(at: Region, item: &ItemWord, found: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{found}` does not fit here; the form is `{}`", item.form),
    )
}

/// `spring NAME on JOINT.COORDINATE`: what acts along a coordinate, where two places are wanted.
pub fn along_a_coordinate(
    at: Region,
    item: &ItemWord,
    joint: &str,
    coordinate: Option<&str>,
) -> LexemeMessage {
    let fields = "stiffness: …, rest: …, damping: …";
    let several = coordinate.map_or_else(String::new, |coordinate| {
        format!(" (of several coordinates `{coordinate}: {{ {fields} }}`)")
    });
    LexemeMessage::new(
        at,
        format!(
            "a `{}` joins two places, `from … to …`; what acts along a coordinate of `{joint}` are fields of that joint: `{{ {fields} }}`{several}",
            item.word
        ),
    )
}

/// An index behind the name of an item that is there once.
pub fn not_repeated(at: Region, item: &ItemWord, name: &str) -> LexemeMessage {
    let word = item.word;
    LexemeMessage::new(
        at,
        format!(
            "{} `{word}` has no index: write `{word} {name}`, which all may use, or one for each, `{word} {name}_0`; the form is `{}`",
            article(word),
            item.form
        ),
    )
}

pub fn missing_clause(at: Region, item: &ItemWord, clause: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{clause}` is missing here; the form is `{}`", item.form),
    )
}

/// `sign`: what stands between the two values instead of a word; `conditions`: there are several of them.
pub fn event_compares(at: Region, sign: &str, conditions: bool) -> LexemeMessage {
    let text = match sign {
        _ if conditions => resolve::BOTH_AT_ONCE.to_owned(),
        "<" => "write `falls` instead of `<` for the passage to below it".to_owned(),
        ">" => "write `rises` instead of `>` for the passage to above it".to_owned(),
        sign => format!(
            "write `rises`, `falls` or `crosses` instead of `{sign}`, as in `time rises 3 s`"
        ),
    };
    LexemeMessage::new(
        at,
        format!("an event is where a value passes another: {text}"),
    )
}

/// `word`: what stands for the passage, `ours`: the words here that may be meant.
pub fn event_passage(at: Region, word: &str, ours: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("an event is where a value passes another: write {ours} instead of `{word}`"),
    )
}

/// `falls below 0 N`
pub fn word_behind_passage(at: Region, sign: &str, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the value stands right behind `{sign}`: write `{sign} 0 m` instead of `{sign} {word} 0 m`"
        ),
    )
}

pub fn event_in_one_text(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "in TOML `{word}` is a key of its own: `{{ value = \"bob.position.z\", {word} = \"1 m\" }}`"
        ),
    )
}

pub fn event_at_time(at: Region, time: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("an event is where a value passes another: write `time rises {time}`"),
    )
}

pub fn clause_behind_braces(at: Region, spec: &ItemWord, sign: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{sign}` stands before the braces: `{} … {sign} … {{ … }}`",
            spec.word
        ),
    )
}

pub fn repeated_clause(at: Region, clause: &str, first: Region) -> LexemeMessage {
    let once = match clause {
        "world" => ": all frames of the world stand in one `world { … }`",
        "set" => ": several stand in brackets, `set: [a = 1 m, b = 2 m]`",
        "detach" | "attach" | "lock" | "free" | "shape" => ": several stand in brackets, `[a, b]`",
        _ => "",
    };
    LexemeMessage::new(at, format!("`{clause}` is given twice{once}"))
        .also(first, "first given here")
}

pub fn empty_value(at: Region, clause: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("expected a value after `{clause}`"))
}

pub fn decimal_comma(at: Region, before: &str, behind: &str, unit: Option<&Unit>) -> LexemeMessage {
    let unit = unit.map_or_else(String::new, |unit| format!(" {}", unit.text));
    LexemeMessage::new(
        at,
        format!("the sign before decimals is a point: write `{before}.{behind}{unit}`"),
    )
}

/// `numbers`: with commas between them, outside brackets.
pub fn list_without_brackets(at: Region, numbers: &[String], unit: Option<&Unit>) -> LexemeMessage {
    let unit = unit.map_or_else(String::new, |unit| format!(" {}", unit.text));
    let numbers = numbers.join(", ");
    LexemeMessage::new(
        at,
        format!("several numbers stand in brackets: write `[{numbers}]{unit}`"),
    )
}

pub fn field_alone(at: Region, field: &str) -> LexemeMessage {
    let text = match foreign::translated(foreign::FOREIGN_FIELDS, field) {
        Some(ours) => format!("`{field}` alone says nothing: write `{ours}: {field}`"),
        None => format!("expected `:` and a value after `{field}`"),
    };
    LexemeMessage::new(at, text)
}

pub fn equals_for_colon(at: Region, field: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a value stands behind a colon: `{field}: …` instead of `{field} = …`"),
    )
}

pub fn no_colon(at: Region, field: &str, value: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a value stands behind a colon: `{field}: {value}`"),
    )
}

/// `word`: what stands where an item inside another one begins, `ours`: the one that is meant.
pub fn misspelt_inner(at: Region, word: &str, ours: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("unknown field `{word}`; did you mean `{ours}`?"),
    )
}

/// `inner`: the word behind the colon that has a colon, too.
pub fn two_colons(at: Region, field: &str, inner: &str) -> LexemeMessage {
    let text = match field {
        "set" | "map" => format!("what is set is written with `=`: `{field}: {inner} = …`"),
        _ => format!("expected a value after `{field}:`, found the field `{inner}`"),
    };
    LexemeMessage::new(at, text)
}

pub fn kind_and_name(at: Region, field: &str, name: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("the name alone stands here: `{field}: {name}`"))
}

pub fn missing_separator(at: Region, sign: char) -> LexemeMessage {
    LexemeMessage::new(at, format!("expected `{sign}` after this"))
}

pub fn wrong_separator(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "between braces fields are separated by `,`")
}

pub fn no_fields(at: Region, item: &ItemWord) -> LexemeMessage {
    let driven = match item.word {
        "input" => {
            "; what it follows is given to the run: held, as a function of time, or at samples, `control_every(0.01, …)`"
        }
        _ => "",
    };
    LexemeMessage::new(
        at,
        format!(
            "{} `{}` has no fields; the form is `{}`{driven}",
            article(item.word),
            item.word,
            item.form
        ),
    )
}

pub fn range(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected a repetition such as `[i in 0..3]`, or an index such as `[0]`",
    )
}

pub fn no_index_name(at: Region, name: &str, found: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "expected the name of an index before `in`, found `{found}`: write a word, such as `{name}[i in 0..3]`"
        ),
    )
}

pub fn value_range(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected a range such as `600 kg ..= 900 kg`, both ends included",
    )
}

pub fn half_open_range(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a range includes both its ends: write `..=`")
}

pub fn unknown_unit(at: Region, word: &str) -> LexemeMessage {
    let known = crate::units::known();
    let text = match crate::units::foreign(word) {
        Some(ours) => format!("unknown unit `{word}`; here it is called `{ours}`"),
        None if let Some(instead) = crate::units::instead(word) => {
            format!("unknown unit `{word}`; write {instead}")
        }
        None if let Some(product) = crate::units::run_together(word) => {
            let what = match product.contains('*') {
                true => "product of units",
                false => "power of a unit",
            };
            format!("unknown unit `{word}`; a {what} is written `{product}`")
        }
        None if let Some(unit) = crate::units::of_quantity(word) => {
            let unit = match unit.text.as_str() {
                "" => "1",
                text => text,
            };
            format!(
                "unknown unit `{word}`: it names a quantity, in `{unit}`; as the kind of an input or a state it stands alone, `{word}`, and of three numbers in brackets, `[{word}; 3]`"
            )
        }
        None => format!(
            "unknown unit `{word}`{} known: {}, combined with * / ^ ( )",
            ended(unit_meant(word)),
            known.join(" ")
        ),
    };
    LexemeMessage::new(at, text)
}

/// The unit that differs in capitals only, or those that a word may be a slip of.
fn unit_meant(word: &str) -> String {
    let near = match crate::units::same_but_for_case(word) {
        Some(only) => vec![only],
        None => crate::units::near(word),
    };
    match near.as_slice() {
        [] => String::new(),
        near => format!("; did you mean `{}`?", near.join("` or `")),
    }
}

pub fn two_branches(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "`if` has two values: write `if a < b { this } else { that }`, or `if(a < b, this, that)`",
    )
}

pub fn equality(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "quantities are compared by `<`, `<=`, `>` or `>=`: that two of them are equal is seldom true to the last digit",
    )
}

pub fn round_vector(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a vector stands in square brackets: `[x, y, z]`")
}

pub fn bars(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "the length of a vector is `norm(v)`, the size of a number `abs(a)`",
    )
}

pub fn two_stars(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a power is written `a^2`")
}

/// `path.word(…)`
pub fn function_behind(at: Region, path: &str, word: &str) -> LexemeMessage {
    let known = foreign::translated(foreign::FOREIGN_FUNCTIONS, word).unwrap_or(word);
    let text = if ["powi", "powf", "pow"].contains(&word) {
        format!("a power is written `{path}^2`")
    } else if let Some(answer) = foreign::translated(foreign::EXPECTED_FUNCTIONS, word) {
        format!("there is no function `{word}`; {answer}")
    } else if words::FUNCTIONS.contains(&known) {
        format!("a function stands in front: write `{known}({path})`")
    } else {
        format!(
            "there is no function `{word}`, and functions stand in front, as in `norm({path})`: {}",
            words::FUNCTIONS.join(", ")
        )
    };
    LexemeMessage::new(at, text)
}

/// `a += b`
pub fn assigned_sum(at: Region, name: &str, sign: char) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("there is no `{sign}=`: write `{name} = {name} {sign} …`"),
    )
}

/// `50 %`
pub fn per_cent(at: Region, number: &str) -> LexemeMessage {
    let share = number.parse::<f64>().map_or_else(
        |_| String::new(),
        |percent| format!(": write `{}`", percent / 100.0),
    );
    LexemeMessage::new(
        at,
        format!(
            "`%` is the remainder, `a % b`; so many per cent are a number without a unit{share}"
        ),
    )
}

pub fn one_index(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a repetition has one index: count through all with it, such as `[i in 0..8]`",
    )
}

pub fn unit_product(at: Region, first: &str, second: &str) -> LexemeMessage {
    let text =
        format!("`{first}.{second}` is no unit; a product of units is written `{first}*{second}`");
    LexemeMessage::new(at, text)
}

/// `take`: the word of a metric at the beginning of another value.
pub fn taken_of_a_run(at: Region, take: &str) -> LexemeMessage {
    let text = format!(
        "what is taken of a quantity over a run is a metric: write `metric NAME = {take} …` instead"
    );
    LexemeMessage::new(at, text)
}

pub fn point_behind_unit(at: Region, unit: &str) -> LexemeMessage {
    let text = format!("no point stands behind a unit: write `{unit}`");
    LexemeMessage::new(at, text)
}

/// `units`: as they follow one another, without signs between them.
pub fn unit_behind_unit(at: Region, units: &[String]) -> LexemeMessage {
    let product = units.join("*");
    let text = match units {
        [over, under] if over.contains('/') => format!(
            "a sign stands between units: write `{over}*{under}`, or `{over}/{under}` if both are below the line"
        ),
        _ => format!("units are multiplied by `*`: write `{product}`"),
    };
    LexemeMessage::new(at, text)
}

pub fn power_of_a_power(at: Region, unit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("the power of a power: write the unit with one exponent, `{unit}^4`"),
    )
}

pub fn unit_exponent(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected an exponent between -9 and 9, whole or with a half, such as `m^2`, `s^-1` or `Pa^0.5`",
    )
}

pub fn unit_range(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "no quantity of mechanics has such a unit: its exponents are too large",
    )
}

pub fn unit_expected(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "expected a unit such as `N` or `kg*m^2`")
}

pub fn tiny_number(at: Region, text: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{text}` is too small for a number: it would be zero"),
    )
}

pub fn huge_number(at: Region, text: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("`{text}` is too large for a number"))
}

pub fn deep_expression(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this expression nests too deeply; give a part of it a name, or group its terms",
    )
}
