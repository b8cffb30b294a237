//! Messages of reading TOML: what the document does not say in the way a scene is written.

use super::LexemeMessage;
use crate::lexeme::Region;
use crate::syntax::words::ItemWord;

pub fn parse(at: Region, error: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("this is no TOML: {}", error.trim()))
}

pub fn bare_index(at: Region, name: &str, index: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a name with an index stands in quotes as a key of TOML: `\"{name}[{index}]\"`"),
    )
}

pub fn boolean(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("`{word}` is `true` or `false`"))
}

pub fn string(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "write this as a string in the language of `model!`, such as `\"2.0 kg\"`",
    )
}

pub fn table(at: Region, item: &ItemWord) -> LexemeMessage {
    let head = if item.named {
        format!("[{}.NAME]", item.word)
    } else {
        format!("[{}]", item.word)
    };
    LexemeMessage::new(
        at,
        format!(
            "write this as a table `{head}` with the keys {}",
            keys(item)
        ),
    )
}

pub fn missing(at: Region, item: &ItemWord, key: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "this {} has no `{key}`; its keys: {}",
            item.word,
            keys(item)
        ),
    )
}

fn keys(item: &ItemWord) -> String {
    let keys: Vec<&str> = item
        .clauses
        .iter()
        .map(|clause| clause.key)
        .chain(item.fields.unwrap_or(&[]).iter().copied())
        .collect();
    keys.join(", ")
}

pub fn no_model(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "the scene has no name: add `model = \"Name\"` at its top",
    )
}
