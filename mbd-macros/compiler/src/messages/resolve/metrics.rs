//! Messages about metrics.

use mbd_scene::metrics::{COLUMNS_OF_RESULTS, Take};

use super::items::known_or_near;
use crate::lexeme::Region;
use crate::messages::similar::did_you_mean;
use crate::messages::{LexemeMessage, article};
use crate::syntax::foreign;

pub fn metric_take(at: Region, word: &str) -> LexemeMessage {
    let words = Take::ALL.map(Take::keyword);
    let near = match foreign::translated(foreign::FOREIGN_TAKES, word) {
        Some(ours) => format!("; here it is called `{ours}`"),
        None => did_you_mean(word, words),
    };
    LexemeMessage::new(
        at,
        format!(
            "a metric begins with what is taken of its quantity, such as `max rope.tension`; `{word}` is none of {}{near}",
            words.join(", ")
        ),
    )
}

pub fn metric_is_a_column(at: Region, name: &str) -> LexemeMessage {
    let all = COLUMNS_OF_RESULTS.join(", ");
    LexemeMessage::new(
        at,
        format!(
            "no metric can be named `{name}`: tables of results have columns {all}; name it after what it is, such as `{name}_tension`"
        ),
    )
}

/// `second`: the word of another metric in what one takes.
pub fn metric_of_two(at: Region, take: Take, second: Take) -> LexemeMessage {
    let (take, second) = (take.keyword(), second.keyword());
    let text = match (take, second) {
        ("time_of", "max" | "min") => {
            let (what, passage) = match second {
                "max" => ("largest", "falls"),
                _ => ("smallest", "rises"),
            };
            format!(
                "`time_of` is that of an event: a quantity is {what} where its rate passes zero, `event turned = bob.velocity.z {passage} 0 m/s;` and `time_of turned`"
            )
        }
        _ => format!(
            "a metric takes one thing of a run: declare `metric NAME = {second} …;` beside it, and compute with the numbers of both after the run"
        ),
    };
    LexemeMessage::new(at, text)
}

pub fn metric_of_nothing(at: Region, take: Take) -> LexemeMessage {
    let (word, what) = (take.keyword(), of(take));
    LexemeMessage::new(
        at,
        format!("`{word}` is of {what}: write `{word} {}`", example(take)),
    )
}

fn of(take: Take) -> &'static str {
    match take {
        Take::TimeOf => "an event",
        _ => "a quantity",
    }
}

fn example(take: Take) -> &'static str {
    match take {
        Take::TimeOf => "landed",
        _ => "rope.tension",
    }
}

pub fn metric_needs(at: Region, take: Take, field: &str) -> LexemeMessage {
    let (word, example) = match field {
        "level" => ("level", "5 kN"),
        _ => ("event", "opened"),
    };
    let take = take.keyword();
    LexemeMessage::new(
        at,
        format!(
            "`{take}` needs the {word} in braces: `{take} rope.tension {{ {field}: {example} }}`"
        ),
    )
}

pub fn metric_needs_no(at: Region, take: Take, field: &str) -> LexemeMessage {
    let take = take.keyword();
    LexemeMessage::new(
        at,
        format!("`{take}` has no use for `{field}`: leave it out"),
    )
}

pub fn metric_window(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "`from` must be before `to`")
}

pub fn metric_number(at: Region, field: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{field}` of a metric must be a finite number, made of numbers and consts"),
    )
}

pub fn no_event(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("no event named `{word}`{}", known_or_near(word, known)),
    )
}

pub fn not_an_event(at: Region, word: &str, kind: &str) -> LexemeMessage {
    let article = article(kind);
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is {article} {kind}, and no event: declare `event {word}_happens = … rises …;`"
        ),
    )
}
