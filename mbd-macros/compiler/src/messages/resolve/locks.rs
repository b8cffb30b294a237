//! Messages about coordinates that events lock and free.

use super::items::known_or_near;
use crate::lexeme::Region;
use crate::messages::{LexemeMessage, article};

pub fn no_joint_to(at: Region, action: &str, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no joint named `{word}` to {action}{}",
            known_or_near(word, known)
        ),
    )
}

pub fn not_a_joint_to(at: Region, action: &str, word: &str, kind: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is {} {kind}; joints and their coordinates are what an event can {action}",
            article(kind)
        ),
    )
}

pub fn nothing_to_lock(at: Region, name: &str, keyword: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the joint `{name}` is of the kind `{keyword}` and has no coordinate that could be locked: attach a joint that holds more, such as `rigid` with `at_start: detached`"
        ),
    )
}

pub fn no_coordinate_to(at: Region, joint: &str, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the joint `{joint}` has no coordinate `{word}`{}",
            known_or_near(word, known)
        ),
    )
}

pub fn rate_of_locked(at: Region, joint: &str, coordinate: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{joint}.{coordinate}` is locked at the start, and what is locked has no rate: leave `start_rate` out, or `at_start: locked`"
        ),
    )
}

pub fn driven_coordinate_locked(at: Region, joint: &str, coordinate: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a motor drives `{joint}.{coordinate}`, which cannot be locked besides: let the motor follow a `state` or a param that the event sets"
        ),
    )
}

pub fn detachable_joint_locked(at: Region, joint: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the joint `{joint}` may be detached and has no coordinate then: lock coordinates of a joint that stays"
        ),
    )
}

pub fn freed_never_locked(at: Region, coordinate: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no event locks `{coordinate}`, so that nothing is there to be freed: write `lock: {coordinate}` in an event before, or `at_start: locked` among the fields of the joint"
        ),
    )
}

pub fn asked_never_locked(at: Region, coordinate: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no event locks `{coordinate}`, so that there is no lock to ask: write `lock: {coordinate}` in an event"
        ),
    )
}

/// `pin.lock.torque`: a lock is asked for by its coordinate. `asked`: what stands behind `lock`.
pub fn lock_of_a_joint(at: Region, joint: &str, coordinate: &str, asked: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{joint}` has no quantity `lock`: a lock is of a coordinate, write `{joint}.{coordinate}.lock.{asked}`"
        ),
    )
}
