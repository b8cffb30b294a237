//! A robot as items of a declaration.

use std::fmt::Write;

use mbd_scene::Axis;
use mbd_scene::solids::Solid;
use nalgebra::{Matrix3, Vector3};

use super::names::RobotNames;
use super::robot::{Robot, UrdfJoint, UrdfJointKind, UrdfLimit};
use super::tree::{MassProperties, PlacedFrame, RigidGroup, lump};
use crate::check::moments_of_a_body;
use crate::lexeme::LexemeIndex;
use crate::messages::{LexemeMessage, urdf as say};
use crate::resolve::letter;

/// The rate over which friction is smoothed, which a URDF does not say: of angles and of slides.
const FRICTION_RATE: [(UrdfJointKind, &str); 2] = [
    (UrdfJointKind::Hinge, "0.01 rad/s"),
    (UrdfJointKind::Prismatic, "0.001 m/s"),
];

/// The text of an item, and the element it comes from.
pub type Fragment = (LexemeIndex, String);

/// Writes the items of a robot.
pub struct UrdfWriter<'r> {
    /// The robot.
    pub robot: &'r Robot,
    /// Its bodies.
    pub groups: &'r [RigidGroup],
    /// What everything is called.
    pub names: &'r RobotNames,
    /// Whether the root is a body that flies.
    pub free: bool,
    /// Whether inertias that no rigid body has are let through.
    pub unchecked: bool,
}

impl UrdfWriter<'_> {
    /// All items: the frames of the world, bodies, joints; or what a moving body lacks.
    pub fn items(&self) -> Result<Vec<Fragment>, Vec<LexemeMessage>> {
        let (mut items, mut wrong) = (Vec::new(), Vec::new());
        for (index, group) in self.groups.iter().enumerate() {
            if index == 0 && !self.free {
                items.push(self.world(group));
                continue;
            }
            match self.body(group) {
                Ok(body) => items.push(body),
                Err(report) => wrong.push(report),
            }
        }
        if self.free {
            let root = self.robot.root;
            let text = format!(
                "joint {}: free from world to {}.origin;",
                self.names.base, self.names.links[root]
            );
            items.push((self.robot.links[root].at, text));
        }
        let carrying = self.groups.iter().filter_map(|group| group.joint);
        items.extend(carrying.map(|index| self.joint(index, &self.robot.joints[index])));
        for (index, joint) in self.robot.joints.iter().enumerate() {
            match self.gear(index, joint) {
                Ok(gear) => items.extend(gear),
                Err(report) => wrong.push(report),
            }
        }
        if wrong.is_empty() {
            Ok(items)
        } else {
            Err(wrong)
        }
    }

    /// The frames of the links at rest, and of the joints on them.
    fn world(&self, group: &RigidGroup) -> Fragment {
        let frames = self.frames(group, 0);
        let at = self.robot.links[self.robot.root].at;
        (at, format!("world {{ {} }}", frames.join(", ")))
    }

    fn body(&self, group: &RigidGroup) -> Result<Fragment, LexemeMessage> {
        let link = &self.robot.links[group.members[0].link];
        let name = &self.names.links[group.members[0].link];
        let lump = match lump(self.robot, group) {
            Some(lump) => lump,
            None if self.unchecked => MassProperties::none(),
            None => return Err(say::no_mass(link.at, &link.name)),
        };
        let fixed: Vec<String> = (group.members.iter().skip(1))
            .map(|member| format!("`{}`", self.robot.links[member.link].name))
            .collect();
        let mut text = format!("/// Link `{}`", link.name);
        if !fixed.is_empty() {
            let _ = write!(text, " with {} fixed to it", fixed.join(", "));
        }
        let mut fields = vec![
            format!("mass: {:?} kg", lump.mass),
            format!("center_of_mass: {} m", vector(lump.center)),
            format!("inertia: {}", inertia(&lump.inertia, self.unchecked)),
            "frame origin at [0.0, 0.0, 0.0] m".to_owned(),
        ];
        fields.extend(self.frames(group, 1));
        fields.extend(self.shapes(group));
        let _ = write!(text, ".\nbody {name} {{ {} }}", fields.join(", "));
        Ok((link.at, text))
    }

    /// The frames of a group: of its links from the `first`, and of the joints on them.
    fn frames(&self, group: &RigidGroup, first: usize) -> Vec<String> {
        let links = group.members.iter().skip(first);
        let mut frames: Vec<String> = links
            .map(|member| frame(&self.names.links[member.link], member.placed))
            .collect();
        for (joint, name) in self.robot.joints.iter().zip(&self.names.joints) {
            let on = |member: &&super::tree::GroupMember| member.link == joint.parent;
            if let (Some(member), false) = (
                group.members.iter().find(on),
                joint.kind == UrdfJointKind::Fixed,
            ) {
                frames.push(frame(name, member.placed.then(joint.origin)));
            }
        }
        frames
    }

    /// The shapes of the links of a group.
    fn shapes(&self, group: &RigidGroup) -> Option<String> {
        let shapes = group.members.iter().flat_map(|member| {
            let shapes = self.robot.links[member.link].shapes.iter();
            shapes.map(|shape| {
                let (word, sizes) = (shape.solid.keyword(), &shape.sizes);
                let sizes = match shape.solid {
                    Solid::Box => format!("{sizes:?} m"),
                    solid => {
                        let named = solid.sizes().iter().zip(sizes);
                        let named = named.map(|(name, size)| format!("{name}: {size:?} m"));
                        format!("{{ {} }}", named.collect::<Vec<_>>().join(", "))
                    }
                };
                format!("{word} {sizes}{}", place(member.placed.then(shape.origin)))
            })
        });
        let shapes: Vec<String> = shapes.collect();
        (!shapes.is_empty()).then(|| format!("shape: [{}]", shapes.join(", ")))
    }

    /// Where a link's joints are: the body it belongs to.
    fn owner(&self, link: usize) -> &str {
        let holds = |group: &&RigidGroup| group.members.iter().any(|member| member.link == link);
        let group = self
            .groups
            .iter()
            .position(|group| holds(&group))
            .unwrap_or(0);
        match (group, self.free) {
            (0, false) => "world",
            _ => &self.names.links[self.groups[group].members[0].link],
        }
    }

    fn joint(&self, index: usize, joint: &UrdfJoint) -> Fragment {
        let name = &self.names.joints[index];
        let mut text = doc(joint);
        let _ = write!(
            text,
            "joint {name}: {} from {}.{name} to {}.origin",
            joint.kind.keyword(),
            self.owner(joint.parent),
            self.owner(joint.child),
        );
        let mut fields = Vec::new();
        if !matches!(joint.kind, UrdfJointKind::Free | UrdfJointKind::Spherical) {
            fields.push(format!("axis: {}", letter(Axis(joint.axis))));
        }
        let [damping, friction] = joint.dynamics;
        if let Some((_, unit, effort)) = joint.kind.coordinate() {
            if let Some([low, high]) = joint.limit.range.filter(|_| joint.is_limited()) {
                fields.push(format!("stops: [{low:?}, {high:?}] {unit}"));
            }
            if damping > 0.0 {
                fields.push(format!("damping: {damping:?} {effort}*s/{unit}"));
            }
            if friction > 0.0 {
                fields.push(format!("friction: {friction:?} {effort}"));
                let rate = FRICTION_RATE.iter().find(|(kind, _)| *kind == joint.kind);
                fields.extend(rate.map(|(_, rate)| format!("friction_rate: {rate}")));
            }
        }
        match fields.is_empty() {
            true => text.push(';'),
            false => {
                let _ = write!(text, " {{ {} }}", fields.join(", "));
            }
        }
        (joint.at, text)
    }

    /// The gear of a joint that mimics another.
    fn gear(&self, index: usize, joint: &UrdfJoint) -> Result<Option<Fragment>, LexemeMessage> {
        let Some(mimic) = joint.mimic else {
            return Ok(None);
        };
        let other = &self.robot.joints[mimic.joint];
        let (Some((to, unit, _)), Some((from, other_unit, _))) =
            (joint.kind.coordinate(), other.kind.coordinate())
        else {
            return Err(say::mimics_none(mimic.at, &joint.name, &other.name));
        };
        let names = &self.names;
        // What a slide goes by for a radian is a length.
        let ratio_unit = match (unit, other_unit) {
            ("m", "rad") => "m".to_owned(),
            (unit, other) => format!("{unit}/{other}"),
        };
        let text = format!(
            "joint {}: gear from {}.{from} to {}.{to} {{ ratio: {:?} {ratio_unit}, offset: {:?} {unit} }}",
            names.mimics[index],
            names.joints[mimic.joint],
            names.joints[index],
            mimic.multiplier,
            mimic.offset,
        );
        Ok(Some((mimic.at, text)))
    }
}

impl UrdfJoint {
    /// Whether its limits are a range.
    pub fn is_limited(&self) -> bool {
        self.limit.range.is_some_and(|[low, high]| low < high)
    }
}

/// What the file says of a joint that is no law of its motion.
fn doc(joint: &UrdfJoint) -> String {
    let Some((_, unit, effort)) = joint.kind.coordinate() else {
        return String::new();
    };
    let UrdfLimit {
        range,
        effort: largest,
        velocity,
    } = joint.limit;
    let said: Vec<String> = [
        range.map(|[low, high]| format!("range {low:?} to {high:?} {unit}")),
        largest.map(|largest| format!("effort up to {largest:?} {effort}")),
        velocity.map(|velocity| format!("rate up to {velocity:?} {unit}/s")),
    ]
    .into_iter()
    .flatten()
    .collect();
    match said.is_empty() {
        true => String::new(),
        false => format!("/// By the URDF: {}.\n", said.join(", ")),
    }
}

fn vector(of: Vector3<f64>) -> String {
    let [x, y, z] = <[f64; 3]>::from(of).map(|component| component + 0.0);
    format!("[{x:?}, {y:?}, {z:?}]")
}

fn inertia(of: &Matrix3<f64>, unchecked: bool) -> String {
    let [xx, yy, zz] = [of.m11, of.m22, of.m33];
    let products = [of.m12, of.m13, of.m23];
    let mut text = match products == [0.0; 3] {
        true => format!("diag({xx:?}, {yy:?}, {zz:?}) kg*m^2"),
        false => {
            let [xy, xz, yz] = products;
            format!(
                "full {{ xx: {xx:?}, yy: {yy:?}, zz: {zz:?}, xy: {xy:?}, xz: {xz:?}, yz: {yz:?} }} kg*m^2 (matrix elements)"
            )
        }
    };
    if unchecked && moments_of_a_body(of).is_err() {
        text.push_str(" (unchecked)");
    }
    text
}

fn frame(name: &str, placed: PlacedFrame) -> String {
    format!("frame {name}{}", place(placed))
}

/// Where something is, and its axes.
fn place(placed: PlacedFrame) -> String {
    let at = vector(placed.position());
    let rotated = match placed {
        PlacedFrame::Given(origin) if origin.rpy == [0.0; 3] => String::new(),
        PlacedFrame::Given(origin) => {
            let [roll, pitch, yaw] = origin.rpy;
            format!(" rotated rpy({roll:?} rad, {pitch:?} rad, {yaw:?} rad)")
        }
        PlacedFrame::Composed { rotation, .. } if rotation == Matrix3::identity() => String::new(),
        PlacedFrame::Composed { rotation, .. } => {
            let rows = [0, 1, 2].map(|row| vector(rotation.row(row).transpose()));
            format!(" rotated matrix({})", rows.join(", "))
        }
    };
    format!(" at {at} m{rotated}")
}
