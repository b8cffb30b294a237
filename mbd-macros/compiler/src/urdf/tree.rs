//! The tree of a robot: its root, and links that joints of type `fixed` make one body.

use nalgebra::{Matrix3, Vector3};

use super::robot::{Inertial, Robot, UrdfJointKind, UrdfOrigin};
use crate::check::moments_of_a_part;
use crate::messages::{LexemeMessage, urdf as say};

/// Links without freedom among each other.
#[derive(Debug)]
pub struct RigidGroup {
    /// Its links, the one that a joint carries first.
    pub members: Vec<GroupMember>,
    /// The joint that carries it; `None` for the group of the root.
    pub joint: Option<usize>,
}

/// A link of a group.
#[derive(Clone, Copy, Debug)]
pub struct GroupMember {
    /// The link.
    pub link: usize,
    /// Its frame in that of the first link of the group.
    pub placed: PlacedFrame,
}

/// A place with axes, in those of the first link of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacedFrame {
    /// As the file says.
    Given(UrdfOrigin),
    /// Behind several origins.
    Composed {
        /// Where it is [m].
        position: Vector3<f64>,
        /// Its axes.
        rotation: Matrix3<f64>,
    },
}

impl PlacedFrame {
    /// The frame of the group itself.
    const HERE: PlacedFrame = PlacedFrame::Given(UrdfOrigin {
        xyz: [0.0; 3],
        rpy: [0.0; 3],
    });

    /// What `origin` says in this frame.
    pub fn then(self, origin: UrdfOrigin) -> PlacedFrame {
        match self {
            PlacedFrame::HERE => PlacedFrame::Given(origin),
            before if origin == UrdfOrigin::default() => before,
            before => PlacedFrame::Composed {
                position: before.position() + before.rotation() * origin.position(),
                rotation: before.rotation() * origin.rotation(),
            },
        }
    }

    /// Where it is [m].
    pub fn position(self) -> Vector3<f64> {
        match self {
            PlacedFrame::Given(origin) => origin.position(),
            PlacedFrame::Composed { position, .. } => position,
        }
    }

    /// Its axes.
    pub fn rotation(self) -> Matrix3<f64> {
        match self {
            PlacedFrame::Given(origin) => origin.rotation(),
            PlacedFrame::Composed { rotation, .. } => rotation,
        }
    }
}

/// Mass, centre of mass and inertia of a body.
#[derive(Clone, Debug)]
pub struct MassProperties {
    /// [kg]
    pub mass: f64,
    /// In the frame of the group [m].
    pub center: Vector3<f64>,
    /// About the centre of mass, in the axes of the group [kg·m²].
    pub inertia: Matrix3<f64>,
}

impl MassProperties {
    /// Of links without mass.
    pub fn none() -> Self {
        MassProperties {
            mass: 0.0,
            center: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        }
    }
}

/// Finds the root. A robot that is no tree is told: links carried twice, several roots, circles.
pub fn mistakes(robot: &mut Robot) -> Vec<LexemeMessage> {
    let mut reports = Vec::new();
    let mut carried: Vec<Option<usize>> = vec![None; robot.links.len()];
    for (index, joint) in robot.joints.iter().enumerate() {
        let name = &robot.links[joint.child].name;
        match carried[joint.child] {
            Some(first) => {
                let first = &robot.joints[first];
                reports.push(say::carried_twice(joint.at, name, &joint.name, first));
            }
            None => carried[joint.child] = Some(index),
        }
    }
    if !reports.is_empty() {
        return reports;
    }
    let loose = |link: &usize| carried[*link].is_none();
    let roots: Vec<usize> = (0..robot.links.len()).filter(loose).collect();
    robot.root = roots.first().copied().unwrap_or(0);
    if roots.len() > 1 {
        let names: Vec<&str> = roots
            .iter()
            .map(|&l| robot.links[l].name.as_str())
            .collect();
        return vec![say::several_roots(robot.links[roots[1]].at, &names)];
    }
    let reached: usize = groups(robot).iter().map(|group| group.members.len()).sum();
    if roots.is_empty() || reached < robot.links.len() {
        let mut seen = vec![false; robot.links.len()];
        for member in groups(robot).iter().flat_map(|group| &group.members) {
            seen[member.link] = !roots.is_empty();
        }
        let lost = seen.iter().position(|seen| !seen).unwrap_or(0);
        let joint = carried[lost].map(|joint| &robot.joints[joint]);
        return joint
            .map(|joint| say::circle(joint.at, &robot.links[lost].name))
            .into_iter()
            .collect();
    }
    Vec::new()
}

/// The bodies of a robot, each after the one it hangs on: whatever the order of the file, all that follows is the same.
pub fn groups(robot: &Robot) -> Vec<RigidGroup> {
    let mut on: Vec<Vec<usize>> = vec![Vec::new(); robot.links.len()];
    for (index, joint) in robot.joints.iter().enumerate() {
        on[joint.parent].push(index);
    }
    let mut open = vec![(robot.root, None)];
    let mut reached = vec![false; robot.links.len()];
    let mut groups = Vec::new();
    while let Some((first, joint)) = open.pop() {
        let mut members = vec![GroupMember {
            link: first,
            placed: PlacedFrame::HERE,
        }];
        reached[first] = true;
        let mut carried = Vec::new();
        let mut next = 0;
        while let Some(&member) = members.get(next) {
            next += 1;
            for &index in &on[member.link] {
                let joint = &robot.joints[index];
                if std::mem::replace(&mut reached[joint.child], true) {
                    continue;
                }
                match joint.kind {
                    UrdfJointKind::Fixed => members.push(GroupMember {
                        link: joint.child,
                        placed: member.placed.then(joint.origin),
                    }),
                    _ => carried.push((joint.child, Some(index))),
                }
            }
        }
        open.extend(carried.into_iter().rev());
        groups.push(RigidGroup { members, joint });
    }
    groups
}

/// The inertia of a link in its own axes: R I Rᵀ.
fn rotated(inertial: &Inertial, rotation: Matrix3<f64>) -> Matrix3<f64> {
    match rotation == Matrix3::identity() {
        true => inertial.inertia,
        false => {
            let rotated = rotation * inertial.inertia * rotation.transpose();
            (rotated + rotated.transpose()) * 0.5
        }
    }
}

/// The mass of a group as one body, moments by Steiner; `None` if it has none.
pub fn lump(robot: &Robot, group: &RigidGroup) -> Option<MassProperties> {
    let parts = group.members.iter().filter_map(|member| {
        let inertial = robot.links[member.link].inertial.as_ref()?;
        let placed = member.placed.then(inertial.origin);
        let massless = inertial.mass == 0.0 && inertial.inertia == Matrix3::zeros();
        (!massless).then(|| MassProperties {
            mass: inertial.mass,
            center: placed.position(),
            inertia: rotated(inertial, placed.rotation()),
        })
    });
    let parts: Vec<MassProperties> = parts.collect();
    if let [only] = &parts[..] {
        return Some(only.clone());
    }
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    if mass == 0.0 {
        return None;
    }
    let moment: Vector3<f64> = parts.iter().map(|part| part.center * part.mass).sum();
    let center = moment / mass;
    let inertia = parts.iter().map(|part| {
        let arm = part.center - center;
        let steiner = Matrix3::identity() * arm.norm_squared() - arm * arm.transpose();
        part.inertia + steiner * part.mass
    });
    Some(MassProperties {
        mass,
        center,
        inertia: inertia.sum(),
    })
}

/// The links that move and whose inertia no rigid body has: a principal moment is negative, or exceeds the sum of the other two.
pub fn impossible(robot: &Robot, groups: &[RigidGroup], free: bool) -> Vec<LexemeMessage> {
    let moving = groups.iter().skip(usize::from(!free));
    let links = moving.flat_map(|group| &group.members);
    let links = links.map(|member| &robot.links[member.link]);
    let wrong = links.filter_map(|link| {
        let inertial = link.inertial.as_ref()?;
        let why = moments_of_a_part(&inertial.inertia).err()?;
        Some(say::impossible_inertia(inertial.at, &link.name, why))
    });
    wrong.collect()
}
