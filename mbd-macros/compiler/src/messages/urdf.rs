//! Messages of URDF: what a file does not say in the way a robot is described, and what a declaration asks of one in vain.

use super::LexemeMessage;
use super::resolve::no_body;
use super::similar::did_you_mean;
use super::syntax::ended;
use crate::check::WrongInertia;
use crate::lexeme::{LexemeIndex, Region};
use crate::urdf::UrdfJoint;

pub fn no_xml(at: LexemeIndex, error: &roxmltree::Error) -> LexemeMessage {
    if matches!(error, roxmltree::Error::DtdDetected) {
        return told(
            at,
            "a URDF declares no entities and has no DTD: write what they stand for",
        );
    }
    let error = error.to_string();
    // The place stands in front of the message.
    let text = error.split(" at ").next().unwrap_or(&error);
    told(at, format!("this is no XML: {text}"))
}

pub fn too_large(at: LexemeIndex, bytes: usize) -> LexemeMessage {
    told(at, format!("{bytes} bytes are no robot"))
}

pub fn too_many(at: LexemeIndex, found: usize, most: usize) -> LexemeMessage {
    told(
        at,
        format!("{found} links are more than {most}, which no model holds"),
    )
}

pub fn too_many_attributes(at: LexemeIndex, found: usize, most: usize) -> LexemeMessage {
    told(
        at,
        format!("{found} attributes are more than {most}, which no element of a robot has"),
    )
}

pub fn no_robot(at: LexemeIndex, found: &str) -> LexemeMessage {
    let what = match found {
        "sdf" => "this is SDF",
        "mujoco" => "this is MJCF",
        "COLLADA" => "this is a mesh",
        _ => "this is no URDF",
    };
    told(
        at,
        format!("{what}: a URDF begins with `<robot name=\"…\">`, not with `<{found}>`"),
    )
}

pub fn no_links(at: LexemeIndex) -> LexemeMessage {
    told(at, "this robot has no `<link>`")
}

pub fn xacro(at: LexemeIndex, found: &str) -> LexemeMessage {
    told(
        at,
        format!(
            "`<xacro:{found}>` is for xacro: expand the file first, `xacro robot.xacro > robot.urdf`"
        ),
    )
}

pub fn unknown_element(at: LexemeIndex, found: &str, inside: &str, meant: &str) -> LexemeMessage {
    told(
        at,
        format!("`<{inside}>` has no `<{found}>`; did you mean `<{meant}>`?"),
    )
}

pub fn second_element(at: LexemeIndex, name: &str, inside: &str) -> LexemeMessage {
    told(
        at,
        format!("a second `<{name}>` in `<{inside}>`: one is enough"),
    )
}

pub fn unknown_attribute(
    at: LexemeIndex,
    found: &str,
    element: &str,
    known: &[&str],
) -> LexemeMessage {
    told(
        at,
        format!(
            "`<{element}>` has no attribute `{found}`{} its attributes: {}",
            ended(did_you_mean(found, known.iter().copied())),
            known.join(", ")
        ),
    )
}

pub fn no_attribute(at: LexemeIndex, element: &str, name: &str) -> LexemeMessage {
    told(at, format!("this `<{element}>` has no attribute `{name}`"))
}

pub fn no_element(at: LexemeIndex, element: &str, name: &str) -> LexemeMessage {
    told(at, format!("this `<{element}>` has no `<{name}>`"))
}

pub fn no_numbers(
    at: LexemeIndex,
    (element, name): (&str, &str),
    text: &str,
    count: usize,
) -> LexemeMessage {
    let wanted = match count {
        1 => "one finite number".to_owned(),
        _ => format!("{count} finite numbers apart by blanks"),
    };
    told(
        at,
        format!(
            "`{name}` of `<{element}>` is {wanted}, not \"{}\"",
            cut(text)
        ),
    )
}

/// An angle of `rpy` that would be more than two turns [rad].
pub fn in_degrees(at: LexemeIndex, angle: f64) -> LexemeMessage {
    let meant = angle.to_radians();
    told(
        at,
        format!(
            "`rpy` of `<origin>` is in radians, and {angle} of them are more than two turns: {angle} degrees are {meant}"
        ),
    )
}

pub fn twice(at: LexemeIndex, kind: &str, name: &str, first: LexemeIndex) -> LexemeMessage {
    told(at, format!("two {kind}s are called \"{}\"", cut(name)))
        .also(first.into(), "the first one is here")
}

pub fn joint_type(at: LexemeIndex, joint: &str, found: &str, known: &[&str]) -> LexemeMessage {
    told(
        at,
        format!(
            "joint \"{}\": there is no type `{}`{} types: {}",
            cut(joint),
            cut(found),
            ended(did_you_mean(found, known.iter().copied())),
            known.join(", ")
        ),
    )
}

pub fn no_such<'a>(
    at: LexemeIndex,
    (element, attribute): (&str, &str),
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> LexemeMessage {
    told(
        at,
        format!(
            "`<{element}>` names a {attribute} \"{}\" that the file does not have{}",
            cut(name),
            did_you_mean(name, known)
        ),
    )
}

pub fn zero_axis(at: LexemeIndex, joint: &str) -> LexemeMessage {
    told(
        at,
        format!(
            "the axis of joint \"{}\" is zero: three numbers give its direction",
            cut(joint)
        ),
    )
}

pub fn negative_mass(at: LexemeIndex, link: &str, found: f64) -> LexemeMessage {
    told(
        at,
        format!(
            "the mass of link \"{}\" is {found} kg: no mass is negative",
            cut(link)
        ),
    )
}

pub fn negative(at: LexemeIndex, joint: &str, name: &str, found: f64) -> LexemeMessage {
    told(
        at,
        format!(
            "the {name} of joint \"{}\" is {found}: it would drive the joint, and may not be negative",
            cut(joint)
        ),
    )
}

pub fn impossible_inertia(at: LexemeIndex, link: &str, wrong: WrongInertia) -> LexemeMessage {
    let instead = match wrong {
        // In absolute coordinates nothing can be computed with a body that has such a moment.
        WrongInertia::NotPositive(_) => {
            "; if it is fixed to others and their sum is positive, or with `coordinates: relative;`, `urdf: \"…\" { inertias: unchecked }` takes it as it stands"
        }
        WrongInertia::Triangle(..) => {
            "; to compute with it as it stands, declare `urdf: \"…\" { inertias: unchecked }`"
        }
    };
    told(
        at,
        format!(
            "the inertia of link \"{}\": {}. check its unit, and that it is about the centre of mass{instead}",
            cut(link),
            no_body(wrong)
        ),
    )
}

pub fn no_mass(at: LexemeIndex, link: &str) -> LexemeMessage {
    told(
        at,
        format!(
            "link \"{}\" moves and has no mass, so that its acceleration is not determined: give it an `<inertial>`, make its joint `fixed`, or, where it carries links that have mass, declare `coordinates: relative; urdf: \"…\" {{ inertias: unchecked }}`",
            cut(link)
        ),
    )
}

pub fn carried_twice(at: LexemeIndex, link: &str, joint: &str, first: &UrdfJoint) -> LexemeMessage {
    told(
        at,
        format!(
            "joint \"{}\" carries link \"{}\", which joint \"{}\" carries already: a URDF is a tree; declare the joint that closes a loop beside it",
            cut(joint),
            cut(link),
            cut(&first.name)
        ),
    )
    .also(first.at.into(), "the first one is here")
}

pub fn several_roots(at: LexemeIndex, names: &[&str]) -> LexemeMessage {
    let listed: Vec<String> = names
        .iter()
        .take(5)
        .map(|name| format!("\"{}\"", cut(name)))
        .collect();
    told(
        at,
        format!(
            "no joint carries the links {}: one of them can be the base, the others need a joint",
            listed.join(", ")
        ),
    )
}

pub fn circle(at: LexemeIndex, link: &str) -> LexemeMessage {
    told(
        at,
        format!(
            "the joints go round in a circle at link \"{}\": a URDF is a tree; declare the joint that closes a loop beside it",
            cut(link)
        ),
    )
}

pub fn mimics_itself(at: LexemeIndex, joint: &str) -> LexemeMessage {
    told(at, format!("joint \"{}\" mimics itself", cut(joint)))
}

pub fn mimics_none(at: LexemeIndex, joint: &str, other: &str) -> LexemeMessage {
    told(
        at,
        format!(
            "joint \"{}\" cannot mimic \"{}\": both must turn or slide along one axis",
            cut(joint),
            cut(other)
        ),
    )
}

pub fn nothing_moves(at: LexemeIndex) -> LexemeMessage {
    told(
        at,
        "nothing of this robot moves while its base is fixed to the world: declare `urdf: \"…\" { base: free }`",
    )
}

pub fn choice(at: Region, words: [&str; 2]) -> LexemeMessage {
    let [a, b] = words;
    LexemeMessage::new(at, format!("this is `{a}` or `{b}`"))
}

pub fn block(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected fields of joints between braces, such as `{ damping: 0.1 N*m*s }`",
    )
}

pub fn no_path(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected the path of a URDF in quotes, such as `urdf: \"robots/arm.urdf\";`",
    )
}

pub fn unreadable(at: Region, path: &str, why: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "cannot read {path}: {why}. a path is relative to the folder of the scene file, in `model!` to that of Cargo.toml"
        ),
    )
}

pub fn nothing_to_extend(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "`extend` adds to what a `urdf` declares, and this declaration has none: write the fields where the thing is declared",
    )
}

pub fn no_such_item<'a>(
    at: Region,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the URDF declares nothing that is called `{name}`{}",
            did_you_mean(name, known)
        ),
    )
}

fn told(at: LexemeIndex, text: impl Into<String>) -> LexemeMessage {
    LexemeMessage::new(at.into(), text)
}

/// The start of a text that someone else wrote, on one line.
fn cut(text: &str) -> String {
    const MOST: usize = 60;
    let plain = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let mut cut: String = plain.take(MOST).collect();
    if text.chars().nth(MOST).is_some() {
        cut.push('…');
    }
    cut
}
