//! Names of a URDF as names of a declaration.

use std::collections::BTreeSet;

use super::robot::{Robot, UrdfJointKind};
use super::tree::RigidGroup;
use crate::syntax::words;

/// The names of everything that a robot declares.
#[derive(Debug, Default)]
pub struct RobotNames {
    /// Per link its body, or the frame that it is on another; of the links at rest their frames of the world.
    pub links: Vec<String>,
    /// Per joint; that of a `fixed` one is empty.
    pub joints: Vec<String>,
    /// Per joint the gear that makes it follow another.
    pub mimics: Vec<String>,
    /// The joint of a free base.
    pub base: String,
    /// What is called otherwise than in the file: `link "a b" is a_b`.
    pub changed: Vec<String>,
}

impl RobotNames {
    /// Names that the language takes and that differ from each other.
    pub fn of(robot: &Robot, groups: &[RigidGroup]) -> RobotNames {
        let mut names = RobotNames {
            links: vec![String::new(); robot.links.len()],
            ..RobotNames::default()
        };
        let mut taken = BTreeSet::new();
        // Bodies first: they are named most.
        for group in groups {
            let first = group.members[0].link;
            names.links[first] = names.fresh("link", &robot.links[first].name, &mut taken);
        }
        for joint in &robot.joints {
            let name = match joint.kind {
                UrdfJointKind::Fixed => String::new(),
                _ => names.fresh("joint", &joint.name, &mut taken),
            };
            let mimic = match joint.mimic {
                Some(_) => unused(&format!("{name}_mimic"), "gear", &mut taken),
                None => String::new(),
            };
            names.joints.push(name);
            names.mimics.push(mimic);
        }
        for group in groups {
            // Frames of one body: those of its joints, and of links that are fixed to it.
            let mut frames: BTreeSet<String> = ["origin", "com"].map(str::to_owned).into();
            let on = |joint: &&super::robot::UrdfJoint| {
                let parent = |member: &super::tree::GroupMember| member.link == joint.parent;
                group.members.iter().any(parent)
            };
            let joints = robot.joints.iter().zip(&names.joints);
            frames.extend(
                joints
                    .filter(|(joint, _)| on(joint))
                    .map(|(_, name)| name.clone()),
            );
            for member in group.members.iter().skip(1) {
                let fixed = &robot.links[member.link].name;
                names.links[member.link] = names.fresh("link", fixed, &mut frames);
            }
        }
        names.base = unused("base", "joint", &mut taken);
        names
    }

    fn fresh(&mut self, kind: &str, name: &str, taken: &mut BTreeSet<String>) -> String {
        let chosen = unused(name, kind, taken);
        if chosen != name {
            self.changed
                .push(format!("{kind} \"{name}\" is `{chosen}`"));
        }
        chosen
    }
}

/// A word that is not taken yet: the name itself, else with what it names behind it, else with a number.
fn unused(name: &str, kind: &str, taken: &mut BTreeSet<String>) -> String {
    let plain = word(name);
    let fits = |word: &String| {
        let free = words::reserved(word).is_none() && !words::reserved_frame(word);
        free && !taken.contains(word)
    };
    let mut candidates = std::iter::once(plain.clone())
        .chain(std::iter::once(format!("{plain}_{kind}")))
        .chain((2..).map(|number| format!("{plain}_{kind}_{number}")));
    let chosen = candidates.find(fits).unwrap_or(plain);
    taken.insert(chosen.clone());
    chosen
}

/// Letters, digits and underscores, no digit first.
fn word(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let word: String = name.chars().map(plain).collect();
    let word = match word.trim_start_matches('_') {
        "" => "unnamed",
        rest if word.starts_with("__") => rest,
        _ => &word,
    };
    match word.starts_with(|c: char| c.is_ascii_digit()) {
        true => format!("n{word}"),
        false => word.to_owned(),
    }
}

/// The name of a robot as the name of a model: `so_arm 100` → `SoArm100`.
pub fn model(name: &str) -> String {
    let mut model = String::new();
    for part in name.split(|c: char| !c.is_ascii_alphanumeric()) {
        let mut letters = part.chars();
        model.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        model.extend(letters);
    }
    match model.starts_with(|c: char| c.is_ascii_alphabetic()) && words::reserved(&model).is_none()
    {
        true => model,
        false => format!("Robot{model}"),
    }
}
