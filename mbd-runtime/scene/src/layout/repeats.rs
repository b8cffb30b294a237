//! Rows that repeat others: what was found, and the sentences that tell it.

use serde::{Deserialize, Serialize};

use crate::{Detachable, RowSet, Scene};

/// A joint some of whose rows repeat those of others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Repeat {
    /// The joint, by index.
    pub joint: usize,
    /// Number of its rows.
    pub rows: usize,
    /// Those that stay.
    pub kept: RowSet,
    /// The joints whose rows the others repeat, by index.
    pub of: Vec<usize>,
}

/// A motor that drives a coordinate which joints, or other motors, hold already.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HeldMotor {
    /// Its joint, by index.
    pub joint: usize,
    /// The coordinate, by number.
    pub coordinate: usize,
    /// The joints that hold it, by index.
    pub of: Vec<usize>,
}

/// A joint of whose reaction not all is determined by the motion.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ambiguous {
    /// The joint, by index.
    pub joint: usize,
    /// Which components are one choice of many: three of the force, three of the torque, world axes.
    pub components: [bool; 6],
}

impl Ambiguous {
    /// Adds components of the reaction of a joint to a list.
    pub(crate) fn add(all: &mut Vec<Ambiguous>, joint: usize, components: [bool; 6]) {
        match all.iter_mut().find(|of| of.joint == joint) {
            Some(of) => {
                (of.components.iter_mut().zip(components)).for_each(|(own, more)| *own |= more)
            }
            None => all.push(Ambiguous { joint, components }),
        }
    }

    /// Its components as they are asked for behind the name of a joint: `force.y`, `torque.x`.
    #[must_use]
    pub fn named(&self) -> Vec<&'static str> {
        const NAMES: [&str; 6] = [
            "force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z",
        ];
        let named = NAMES.into_iter().zip(self.components);
        named
            .filter_map(|(name, of_many)| of_many.then_some(name))
            .collect()
    }

    /// Takes all three components of a vector for ambiguous where one is.
    pub(crate) fn widen(&mut self) {
        for vector in self.components.chunks_mut(3) {
            vector.fill(vector.contains(&true));
        }
    }
}

/// What repeats what in a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Redundancy {
    /// The joints that lose rows, in order of declaration.
    pub repeats: Vec<Repeat>,
    /// The motors on loops that have nothing to drive. Only by parameters at their defaults.
    pub held: Vec<HeldMotor>,
    /// The joints whose reactions are not unique, in order of declaration.
    pub ambiguous: Vec<Ambiguous>,
    /// Independent loops of the joints, the world being one of the parts.
    pub loops: usize,
    /// Whether every loop was closed at some state. Where not, nothing is known of its rows, and all are kept.
    pub closed: bool,
}

impl Redundancy {
    /// Whether the reaction of a joint is determined by the motion: no self-stress changes any component of it.
    #[must_use]
    pub fn is_unique(&self, joint: usize) -> bool {
        !self.ambiguous_components(joint).contains(&true)
    }

    /// Which components of the reaction of a joint are one choice of many: three of the force, three of the torque, world axes.
    #[must_use]
    pub fn ambiguous_components(&self, joint: usize) -> [bool; 6] {
        let found = self.ambiguous.iter().find(|of| of.joint == joint);
        found.map_or([false; 6], |of| of.components)
    }

    /// Number of rows that are left out.
    #[must_use]
    pub fn lost(&self) -> usize {
        let lost = |repeat: &Repeat| repeat.rows - repeat.kept.within(repeat.rows).len();
        self.repeats.iter().map(lost).sum()
    }

    /// The first motor that never drives anything, by index of its joint, and what holds its coordinate: "`spin` cannot drive its `angle`: `a`, `b`
    /// hold it". A motor drives where one of these is detached or freed, as the wheel of a Geneva drive is locked while its pin is out.
    #[must_use]
    pub fn idle_motor(&self, scene: &Scene) -> Option<(usize, String)> {
        let lasting = |joint: &usize| !scene.is_detachable(Detachable::Joint(*joint));
        let mut idle = self.held.iter().filter(|held| held.of.iter().all(lasting));
        idle.find_map(|held| {
            let (joint, coordinate) = scene.coordinate(held.joint, held.coordinate)?;
            let verb = if held.of.len() == 1 { "holds" } else { "hold" };
            let (driven, holding) = (&coordinate.name, named(scene, &held.of));
            let sentence = format!(
                "`{}` cannot drive its `{driven}`: {holding} {verb} it",
                joint.name
            );
            Some((held.joint, sentence))
        })
    }

    /// The first lock that never holds anything, by index among the joints, and what holds its coordinate: "`a`, `b` hold `crank.angle` already".
    /// Where a lock repeats what may be freed or detached, too, it holds once that is gone.
    #[must_use]
    pub fn idle_lock(&self, scene: &Scene) -> Option<(usize, String)> {
        let lasting = |joint: &usize| !scene.is_detachable(Detachable::Joint(*joint));
        self.repeats.iter().find_map(|repeat| {
            let coordinate = scene.locked(Detachable::Joint(repeat.joint))?;
            let idle = repeat.kept.within(repeat.rows).is_empty() && repeat.of.iter().all(lasting);
            let verb = if repeat.of.len() == 1 {
                "holds"
            } else {
                "hold"
            };
            let sentence = format!("{} {verb} `{coordinate}` already", named(scene, &repeat.of));
            idle.then_some((repeat.joint, sentence))
        })
    }

    /// One sentence for every joint that loses rows: "`close` repeats rows of `a`, `b`, `c`: 3 of 5".
    #[must_use]
    pub fn sentences(&self, scene: &Scene) -> Vec<String> {
        let sentence = |repeat: &Repeat| {
            let lost = repeat.rows - repeat.kept.within(repeat.rows).len();
            format!(
                "{} repeats rows of {}: {lost} of {}",
                named(scene, &[repeat.joint]),
                named(scene, &repeat.of),
                repeat.rows
            )
        };
        self.repeats.iter().map(sentence).collect()
    }
}

/// `a`, `b`, the lock of `c.angle`.
fn named(scene: &Scene, joints: &[usize]) -> String {
    let name = |joint: &usize| match scene.locked(Detachable::Joint(*joint)) {
        Some(coordinate) => format!("the lock of `{coordinate}`"),
        None => {
            let joint = scene.joints.get(*joint);
            format!("`{}`", joint.map_or("?", |joint| &joint.name))
        }
    };
    let names: Vec<String> = joints.iter().map(name).collect();
    names.join(", ")
}
