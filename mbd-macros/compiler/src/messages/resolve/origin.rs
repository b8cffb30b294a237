//! Messages about the origin of positions.

use crate::lexeme::Region;
use crate::messages::{LexemeMessage, article};

pub fn origin_of_the_world(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "the world does not move: leave `origin` out, or name a body or a point with mass that goes far",
    )
}

pub fn origin_follows_a_whole(at: Region, owner: &str, extra: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the origin follows a body or a point as a whole, not its `{extra}`: write `follows {owner}`"
        ),
    )
}

pub fn origin_without_mass(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` has no mass and no velocity of its own: let the origin follow a body or a point with mass near it"
        ),
    )
}

pub fn origin_of(at: Region, name: &str, kind: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` is {} {kind}; the origin follows a body or a point with mass",
            article(kind)
        ),
    )
}

pub fn origin_tied(at: Region, joint: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the origin follows what goes far from the world, and the joint `{joint}` holds it there: follow something else, or let an event detach `{joint}`"
        ),
    )
}
