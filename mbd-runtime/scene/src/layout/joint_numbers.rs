//! What the numbers are that the joints of a tree have in the state.

use crate::layout::{Layout, Link};
use crate::{JointLaw, Scene};

/// Elements of an attitude.
const ATTITUDE: [&str; 4] = ["qw", "qx", "qy", "qz"];
/// Its speeds: the angular velocity in frame 2.
const SPIN: [&str; 3] = ["omega_x", "omega_y", "omega_z"];

impl Layout {
    /// The joint of the tree, the name and the SI unit of a number of the state; `None` where it is none of a joint.
    #[must_use]
    pub fn joint_number<'s>(
        &self,
        scene: &'s Scene,
        index: usize,
    ) -> Option<(usize, &'s str, &'static str)> {
        self.joint_links().find_map(|(joint, link)| {
            let law = &scene.joints.get(joint)?.law;
            let (name, unit) = match index.checked_sub(self.nq) {
                None => coordinate(law, link, index.checked_sub(link.slots.q)?)?,
                Some(speed) => rate(law, link, speed.checked_sub(link.slots.v)?)?,
            };
            Some((joint, name, unit))
        })
    }
}

fn coordinate(law: &JointLaw, link: &Link, number: usize) -> Option<(&'static str, &'static str)> {
    if let Some(own) = law.attitude().filter(|attitude| attitude.contains(&number)) {
        return Some((ATTITUDE[number - own.start], ""));
    }
    let found = law
        .coordinate(number)
        .filter(|_| number < link.coordinates)?;
    Some((found.name, found.unit()))
}

fn rate(law: &JointLaw, link: &Link, number: usize) -> Option<(&'static str, &'static str)> {
    if number >= link.speeds {
        return None;
    }
    if law.attitude().is_some() && number + 3 >= link.speeds {
        return Some((SPIN[number + 3 - link.speeds], "rad/s"));
    }
    let found = law.coordinate(number)?;
    Some((found.rate, if found.is_angle() { "rad/s" } else { "m/s" }))
}
