//! Robots from URDF: links become bodies, joints joints, in the same items that a declaration has.
//!
//! [`read`] reads XML into a [`robot`](robot), [`tree`] finds its root and makes one body of links that are fixed to each other, [`names`] finds names
//! that the language takes, [`write`] says it all in the text of a declaration. That text is lexed with the places of the XML and goes
//! the way of every other: one grammar, one resolver, one set of checks. [`take`] is for a declaration that names a file by
//! `urdf: "…";`, [`read_urdf`] for a file on its own.

mod names;
mod options;
mod read;
mod robot;
mod take;
mod tree;
mod write;

use crate::lexeme::{LexemeIndex, Lexer, LineStarts, Region, piece};
use crate::messages::{Messages, urdf as say};
use crate::reading::{Reading, finish};
use crate::syntax::{ModelSyntax, Word};

use names::RobotNames;
use robot::Robot;
use write::UrdfWriter;

pub use robot::UrdfJoint;
pub use take::{nothing_to_extend, take};

/// Reads a robot from the text of a URDF: its base at rest in the world, or declared by its joints, gravity 9.81 m/s² against z.
#[must_use]
pub fn read_urdf(text: &str) -> Reading {
    let mut lexer = Lexer::of_text();
    let mut messages = Messages::default();
    let mut taken = translate(text, &mut lexer, TakingIn::default(), &mut messages);
    let read = messages.is_empty();
    taken
        .notes
        .push(gravity(&mut lexer, Region::START.first, &mut messages));
    let mut model = ModelSyntax {
        name: Some(Word {
            text: taken.model,
            at: Region::START.first,
        }),
        taken: Some(Region::START.first),
        ..ModelSyntax::default()
    };
    model.items = take::items(&lexer.lexemes, &mut messages);
    take::without_stops(&mut model.items);
    let mut reading = finish(&model, &lexer.places, messages, read);
    reading.notes.extend(taken.notes);
    reading
}

/// How a robot is taken in.
#[derive(Clone, Copy, Debug, Default)]
struct TakingIn {
    /// Whether its root flies.
    free: bool,
    /// Whether inertias are let through that no rigid body has.
    unchecked: bool,
    /// Whether what is said of that could not be read: what would be wrong with the robot by it is not told.
    unread: bool,
}

/// What a URDF became.
#[derive(Debug, Default)]
struct Translated {
    /// The name of the robot as that of a model.
    model: String,
    /// Choices that were made.
    notes: Vec<String>,
}

/// Reads a URDF and adds the lexemes of its items, each at its element.
fn translate(text: &str, lexer: &mut Lexer, how: TakingIn, messages: &mut Messages) -> Translated {
    let free = how.free;
    let unchecked = how.unchecked || how.unread;
    let Some(robot) = read::read(text, lexer, messages) else {
        return Translated::default();
    };
    let groups = tree::groups(&robot);
    if !unchecked {
        tree::impossible(&robot, &groups, free)
            .into_iter()
            .for_each(|report| messages.push(report));
    }
    let names = RobotNames::of(&robot, &groups);
    let writer = UrdfWriter {
        robot: &robot,
        groups: &groups,
        names: &names,
        free,
        unchecked,
    };
    let first = robot.links[robot.root].at;
    match writer.items() {
        Ok(_) if groups.len() == 1 && !free => {
            if !how.unread {
                messages.push(say::nothing_moves(first));
            }
        }
        Ok(items) => items
            .into_iter()
            .for_each(|(at, text)| add(lexer, at, &text, messages)),
        Err(reports) => reports.into_iter().for_each(|report| messages.push(report)),
    }
    Translated {
        model: names::model(&robot.name),
        notes: notes(&robot, &names, free),
    }
}

/// Adds the lexemes of an item, all at one place.
fn add(lexer: &mut Lexer, at: LexemeIndex, text: &str, messages: &mut Messages) {
    let position = lexer.places.position(at);
    lexer.place(position);
    piece(lexer, &LineStarts::new(text), text, None, messages);
}

/// Adds gravity where a declaration says none: z points up in a URDF. Returns the note of that choice.
fn gravity(lexer: &mut Lexer, at: LexemeIndex, messages: &mut Messages) -> String {
    add(lexer, at, "gravity: [0.0, 0.0, -9.81] m/s^2;", messages);
    "no gravity is declared: with a URDF it is 9.81 m/s^2 against z".to_owned()
}

fn notes(robot: &Robot, names: &RobotNames, free: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if !robot.unread.is_empty() {
        let listed = robot
            .unread
            .iter()
            .map(|(name, count)| format!("{count} {name}"));
        let listed = listed.collect::<Vec<_>>().join(", ");
        notes.push(format!(
            "of the URDF, meshes and all else that does not say how it moves are left out: {listed}"
        ));
    }
    let root = robot.links.get(robot.root);
    if !free && root.is_some_and(|link| !link.shapes.is_empty()) {
        notes.push(
            "shapes of links at rest are left out: bodies have shapes, the world has none"
                .to_owned(),
        );
    }
    if !names.changed.is_empty() {
        let changed = names.changed.join(", ");
        notes.push(format!("names of the URDF that differ here: {changed}"));
    }
    if robot.joints.iter().any(|joint| joint.dynamics[1] > 0.0) {
        notes.push(
            "the URDF says friction and not its rate: it is smoothed over 0.01 rad/s and 0.001 m/s, unless `friction_rate` is given"
                .to_owned(),
        );
    }
    if robot.joints.iter().any(robot::UrdfJoint::is_limited) {
        notes.push(
            "limits of the URDF are no law: a joint has stops there where `stop_stiffness` is given"
                .to_owned(),
        );
    }
    let joints = robot.joints.iter();
    let empty: Vec<String> = joints
        .filter_map(|joint| {
            let [low, high] = joint.limit.range.filter(|_| !joint.is_limited())?;
            Some(format!("\"{}\" ({low} to {high})", joint.name))
        })
        .collect();
    if !empty.is_empty() {
        notes.push(format!(
            "limits that leave no range are left out, and never stops: joint {}",
            empty.join(", ")
        ));
    }
    notes
}
