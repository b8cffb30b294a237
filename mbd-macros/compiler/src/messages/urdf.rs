//! Messages of URDF: what a file does not say in the way a robot is described, and what a declaration asks of one in vain.

use super::Report;
use super::resolve::no_body;
use super::similar::did_you_mean;
use super::syntax::ended;
use crate::check::WrongInertia;
use crate::lexeme::{At, Region};
use crate::urdf::Joint;

pub fn no_xml(at: At, error: &roxmltree::Error) -> Report {
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

pub fn too_large(at: At, bytes: usize) -> Report {
    told(at, format!("{bytes} bytes are no robot"))
}

pub fn too_many(at: At, found: usize, most: usize) -> Report {
    told(
        at,
        format!("{found} links are more than {most}, which no model holds"),
    )
}

pub fn too_many_attributes(at: At, found: usize, most: usize) -> Report {
    told(
        at,
        format!("{found} attributes are more than {most}, which no element of a robot has"),
    )
}

pub fn no_robot(at: At, found: &str) -> Report {
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

pub fn no_links(at: At) -> Report {
    told(at, "this robot has no `<link>`")
}

pub fn xacro(at: At, found: &str) -> Report {
    told(
        at,
        format!(
            "`<xacro:{found}>` is for xacro: expand the file first, `xacro robot.xacro > robot.urdf`"
        ),
    )
}

pub fn unknown_element(at: At, found: &str, inside: &str, meant: &str) -> Report {
    told(
        at,
        format!("`<{inside}>` has no `<{found}>`; did you mean `<{meant}>`?"),
    )
}

pub fn second_element(at: At, name: &str, inside: &str) -> Report {
    told(
        at,
        format!("a second `<{name}>` in `<{inside}>`: one is enough"),
    )
}

pub fn unknown_attribute(at: At, found: &str, element: &str, known: &[&str]) -> Report {
    told(
        at,
        format!(
            "`<{element}>` has no attribute `{found}`{} its attributes: {}",
            ended(did_you_mean(found, known.iter().copied())),
            known.join(", ")
        ),
    )
}

pub fn no_attribute(at: At, element: &str, name: &str) -> Report {
    told(at, format!("this `<{element}>` has no attribute `{name}`"))
}

pub fn no_element(at: At, element: &str, name: &str) -> Report {
    told(at, format!("this `<{element}>` has no `<{name}>`"))
}

pub fn no_numbers(at: At, (element, name): (&str, &str), text: &str, count: usize) -> Report {
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

pub fn twice(at: At, kind: &str, name: &str, first: At) -> Report {
    told(at, format!("two {kind}s are called \"{}\"", cut(name)))
        .also(first.into(), "the first one is here")
}

pub fn joint_type(at: At, joint: &str, found: &str, known: &[&str]) -> Report {
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
    at: At,
    (element, attribute): (&str, &str),
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Report {
    told(
        at,
        format!(
            "`<{element}>` names a {attribute} \"{}\" that the file does not have{}",
            cut(name),
            did_you_mean(name, known)
        ),
    )
}

pub fn zero_axis(at: At, joint: &str) -> Report {
    told(
        at,
        format!(
            "the axis of joint \"{}\" is zero: three numbers give its direction",
            cut(joint)
        ),
    )
}

pub fn negative_mass(at: At, link: &str, found: f64) -> Report {
    told(
        at,
        format!(
            "the mass of link \"{}\" is {found} kg: no mass is negative",
            cut(link)
        ),
    )
}

pub fn negative(at: At, joint: &str, name: &str, found: f64) -> Report {
    told(
        at,
        format!(
            "the {name} of joint \"{}\" is {found}: it would drive the joint, and may not be negative",
            cut(joint)
        ),
    )
}

pub fn impossible_inertia(at: At, link: &str, wrong: WrongInertia) -> Report {
    let instead = match wrong {
        // Nothing can be computed with a body that has a negative moment.
        WrongInertia::NotPositive(_) => {
            "; if it is fixed to others and their sum is positive, `urdf: \"…\" { inertias: unchecked }` takes it as it stands"
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

pub fn no_mass(at: At, link: &str) -> Report {
    told(
        at,
        format!(
            "link \"{}\" moves and has no mass, so that its acceleration is not determined: give it an `<inertial>`, or make its joint `fixed`",
            cut(link)
        ),
    )
}

pub fn carried_twice(at: At, link: &str, joint: &str, first: &Joint) -> Report {
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

pub fn several_roots(at: At, names: &[&str]) -> Report {
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

pub fn circle(at: At, link: &str) -> Report {
    told(
        at,
        format!(
            "the joints go round in a circle at link \"{}\": a URDF is a tree; declare the joint that closes a loop beside it",
            cut(link)
        ),
    )
}

pub fn mimics_itself(at: At, joint: &str) -> Report {
    told(at, format!("joint \"{}\" mimics itself", cut(joint)))
}

pub fn mimics_none(at: At, joint: &str, other: &str) -> Report {
    told(
        at,
        format!(
            "joint \"{}\" cannot mimic \"{}\": both must turn or slide along one axis",
            cut(joint),
            cut(other)
        ),
    )
}

pub fn nothing_moves(at: At) -> Report {
    told(
        at,
        "nothing of this robot moves while its base is fixed to the world: declare `urdf: \"…\" { base: free }`",
    )
}

pub fn choice(at: Region, words: [&str; 2]) -> Report {
    let [a, b] = words;
    Report::new(at, format!("this is `{a}` or `{b}`"))
}

pub fn block(at: Region) -> Report {
    Report::new(
        at,
        "expected fields of joints between braces, such as `{ damping: 0.1 N*m*s }`",
    )
}

pub fn no_path(at: Region) -> Report {
    Report::new(
        at,
        "expected the path of a URDF in quotes, such as `urdf: \"robots/arm.urdf\";`",
    )
}

pub fn unreadable(at: Region, path: &str, why: &str) -> Report {
    Report::new(
        at,
        format!(
            "cannot read {path}: {why}. a path is relative to the folder of the scene file, in `model!` to that of Cargo.toml"
        ),
    )
}

pub fn nothing_to_extend(at: Region) -> Report {
    Report::new(
        at,
        "`extend` adds to what a `urdf` declares, and this declaration has none: write the fields where the thing is declared",
    )
}

pub fn no_such_item<'a>(
    at: Region,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Report {
    Report::new(
        at,
        format!(
            "the URDF declares nothing that is called `{name}`{}",
            did_you_mean(name, known)
        ),
    )
}

fn told(at: At, text: impl Into<String>) -> Report {
    Report::new(at.into(), text)
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
