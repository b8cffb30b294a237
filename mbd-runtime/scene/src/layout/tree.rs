//! The spanning tree of relative coordinates: which joint carries each body, and where its coordinates are in the state.
//!
//! ```text
//! fewest speeds:  every body is carried by the joint of least freedom that ties it to what is placed        (1)
//! ```
//!
//! (1) is a spanning forest of least weight, freedoms as weights, the world as one node: joints enter by their freedoms, those of
//! equal freedoms in the order of declaration, and one that closes a loop stays a set of rows (Kruskal, 1956). Before all others those of bodies that may
//! be without mass enter: such a body at an end of the tree, where a loop is cut, would carry nothing that gives its joint an inertia. A joint enters only if all its
//! coordinates can be measured, both its ends are on bodies or on the world, it is not marked `loop`, and no event detaches it. A body that no such joint ties to the world
//! floats: it owns position, attitude and velocity as in absolute coordinates.

use std::ops::Range;

use nalgebra::Matrix3;

use crate::layout::{Layout, Slots};
use crate::{Detachable, Joint, Part, Place, Scene};

/// How the axes of a link lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkAxes {
    /// The axes of the link where its angle and `shift` add up to zero, in those of the link that carries it.
    pub fixed: Matrix3<f64>,
    /// Which coordinate of the joint is its angle.
    pub angle: usize,
    /// What is added to it [rad].
    pub shift: f64,
    /// The axes of the link in the frame of its joint on it.
    pub own: Matrix3<f64>,
}

/// The parts of the inertia of a link that go to the link which carries it, in the axes of the link at its origin: nothing tells them apart there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Grouped {
    /// A mass at the origin.
    pub(crate) mass: bool,
    /// A first moment along each axis.
    pub(crate) moment: [bool; 3],
    /// All moments of inertia.
    pub(crate) inertia: bool,
    /// Equal moments of inertia about the two axes across this one.
    pub(crate) across: Option<usize>,
}

/// A body and what carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The body.
    pub body: usize,
    /// The joint that carries it; `None`: it floats.
    pub joint: Option<usize>,
    /// Whether it is the parent of that joint: the joint is walked from its child.
    pub reversed: bool,
    /// The link of the body that carries it; `None`: the world.
    pub inboard: Option<usize>,
    /// Its coordinates and speeds.
    pub slots: Slots,
    /// Number of its coordinates.
    pub coordinates: usize,
    /// Number of its speeds.
    pub speeds: usize,
    /// Number of those of its speeds that are angular: the last ones.
    pub turns: usize,
    /// Its axes, where they are not those that the declaration gives the frame of its joint.
    pub axes: Option<LinkAxes>,
    /// Whether it turns about one axis of the world alone, known before any angle: its motion stays in planes across that.
    pub parallel: bool,
    /// What of its inertia goes to the link that carries it.
    pub grouped: Grouped,
}

impl Link {
    /// The places of its joint: on what carries it, and on itself.
    #[must_use]
    pub fn ends(&self, joint: &Joint) -> [Place; 2] {
        match self.reversed {
            false => [joint.parent, joint.child],
            true => [joint.child, joint.parent],
        }
    }

    /// Where in q the quaternion of its joint is, if it has one: the last of its coordinates, which are one more than its speeds.
    #[must_use]
    pub fn attitude(&self) -> Option<Range<usize>> {
        let end = self.slots.q + self.coordinates;
        (self.joint.is_some() && self.coordinates > self.speeds).then(|| end - 4..end)
    }
}

/// The tree: every body once, after the body that carries it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tree {
    /// The links, what carries before what it carries.
    pub links: Vec<Link>,
    /// The link of each body.
    pub of_body: Vec<usize>,
    /// The link whose coordinates are those of a joint; `None` for one that is no joint of the tree.
    pub of_joint: Vec<Option<usize>>,
}

/// The body of a place; `None` for the world.
fn on(place: Place) -> Option<usize> {
    match place {
        Place::Body(body, _) => Some(body),
        _ => None,
    }
}

/// Whether a joint may carry a body.
fn may_carry(scene: &Scene, joint: usize) -> bool {
    let Some(declared) = scene.joints.get(joint) else {
        return false;
    };
    let law = &declared.law;
    let attitude = law.attitude().unwrap_or_default();
    let measured = (0..law.coordinates())
        .all(|index| attitude.contains(&index) || law.coordinate(index).is_some());
    let places = [declared.parent, declared.child];
    let ends = places.map(on);
    measured
        && !declared.cut
        && !scene.is_detachable(Detachable::Joint(joint))
        && law.couples().is_empty()
        && law.freedoms() < 6
        && ends[0] != ends[1]
        && !places.iter().any(|place| matches!(place, Place::Point(_)))
}

/// Whether a body may be without mass: it is taken as it stands, and its mass is no positive number.
fn may_lack_mass(scene: &Scene, body: usize) -> bool {
    let mass = scene.bodies.get(body).map(|body| &body.mass);
    let is_positive = mass
        .and_then(|mass| scene.constant(mass))
        .is_some_and(|mass| mass > 0.0);
    scene.is_carried(body) && !is_positive
}

/// Of the joints those that move nothing out of the plane of a planar scene: without attitude, all their coordinates change something there. Those on
/// frames of the world that turn are rows: angles of the bodies count turns, which such a frame does not tell.
fn moves_in_plane(scene: &Scene) -> Vec<bool> {
    if scene.planar.is_none() {
        return vec![true; scene.joints.len()];
    }
    let still = Layout::unchanged(scene);
    let turns = |place: Place| match place {
        Place::World(frame) => scene
            .world_frames
            .get(frame)
            .is_some_and(|frame| frame.turns(scene)),
        Place::Body(..) | Place::Point(_) => false,
    };
    let joints = scene.joints.iter().enumerate();
    joints
        .map(|(index, joint)| {
            joint.law.attitude().is_none()
                && !still.iter().any(|&(of, _)| of == index)
                && ![joint.parent, joint.child].into_iter().any(turns)
        })
        .collect()
}

impl Tree {
    /// The tree of a scene; no coordinates yet.
    pub(crate) fn span(scene: &Scene) -> Self {
        let in_plane = moves_in_plane(scene);
        let mut candidates: Vec<usize> = (0..scene.joints.len())
            .filter(|&joint| in_plane[joint] && may_carry(scene, joint))
            .collect();
        candidates.sort_by_key(|&joint| {
            let declared = &scene.joints[joint];
            let ends = [declared.parent, declared.child].map(on);
            let carried = ends
                .into_iter()
                .flatten()
                .any(|body| may_lack_mass(scene, body));
            (!carried, declared.law.freedoms())
        });
        // What hangs together: bodies, and behind them the world.
        let world = scene.bodies.len();
        let mut group: Vec<usize> = (0..=world).collect();
        let mut carrying: Vec<usize> = Vec::new();
        for joint in candidates {
            let declared = &scene.joints[joint];
            let [a, b] =
                [declared.parent, declared.child].map(|place| group[on(place).unwrap_or(world)]);
            if a != b {
                group
                    .iter_mut()
                    .filter(|own| **own == a)
                    .for_each(|own| *own = b);
                carrying.push(joint);
            }
        }
        carrying.sort_unstable();
        let mut tree = Tree {
            links: Vec::new(),
            of_body: vec![0; scene.bodies.len()],
            of_joint: vec![None; scene.joints.len()],
        };
        let mut placed = vec![false; scene.bodies.len()];
        tree.walk(scene, &carrying, None, &mut placed);
        for body in 0..scene.bodies.len() {
            if !placed[body] {
                placed[body] = true;
                let link = tree.add(body, None, false, None);
                tree.walk(scene, &carrying, Some((body, link)), &mut placed);
            }
        }
        tree
    }

    /// Everything that the world, or a body with its link, carries; depth first, joints in the order of declaration.
    fn walk(
        &mut self,
        scene: &Scene,
        carrying: &[usize],
        from: Option<(usize, usize)>,
        placed: &mut [bool],
    ) {
        let mut open = vec![from];
        while let Some(from) = open.pop() {
            let near = from.map(|(body, _)| body);
            let mut next = Vec::new();
            for &joint in carrying {
                let declared = &scene.joints[joint];
                let [parent, child] = [declared.parent, declared.child].map(on);
                for (inboard, outboard, reversed) in [(parent, child, false), (child, parent, true)]
                {
                    let Some(body) = outboard.filter(|&body| inboard == near && !placed[body])
                    else {
                        continue;
                    };
                    placed[body] = true;
                    let link = self.add(body, Some(joint), reversed, from.map(|(_, link)| link));
                    next.push(Some((body, link)));
                }
            }
            open.extend(next.into_iter().rev());
        }
    }

    fn add(
        &mut self,
        body: usize,
        joint: Option<usize>,
        reversed: bool,
        inboard: Option<usize>,
    ) -> usize {
        let link = self.links.len();
        self.links.push(Link {
            body,
            joint,
            reversed,
            inboard,
            slots: Slots { q: 0, v: 0 },
            coordinates: 0,
            speeds: 0,
            turns: 0,
            axes: None,
            parallel: false,
            grouped: Grouped::default(),
        });
        self.of_body[body] = link;
        if let Some(joint) = joint {
            self.of_joint[joint] = Some(link);
        }
        link
    }

    /// Which joints the tree is made of, in words, which it leaves to rows, and which bodies float.
    #[must_use]
    pub fn sentence(&self, scene: &Scene) -> String {
        const SHOWN: usize = 12;
        let list = |what: &str, names: Vec<&str>| match names.len() {
            0 => None,
            count if count > SHOWN => {
                let more = count - SHOWN;
                Some(format!(
                    "{what} {} and {more} more",
                    names[..SHOWN].join(", ")
                ))
            }
            _ => Some(format!("{what} {}", names.join(", "))),
        };
        let joints = |carrying: bool| {
            let all = scene.joints.iter().zip(&self.of_joint);
            let these = all.filter(|(joint, link)| {
                link.is_some() == carrying && (carrying || joint.law.freedoms() < 6)
            });
            these.map(|(joint, _)| joint.name.as_str()).collect()
        };
        let floating = self.links.iter().filter(|link| link.joint.is_none());
        let floating = floating.filter_map(|link| Some(scene.bodies.get(link.body)?.name.as_str()));
        let parts = [
            list("of the joints", joints(true)),
            list("of the floating", floating.collect()),
            list("rows of", joints(false)),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        format!("relative coordinates {}", parts.join("; "))
    }

    /// The link that a joint carries.
    #[must_use]
    pub fn carried(&self, joint: usize) -> Option<&Link> {
        self.links.get((*self.of_joint.get(joint)?)?)
    }

    /// The links that a body moves with, itself first, up to the world.
    pub fn path(&self, link: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(link), |&link| self.links.get(link)?.inboard)
    }

    /// The links of the two ends of a joint; `None` for the world and for points.
    #[must_use]
    pub fn links_of(&self, ends: &[Option<Part>]) -> [Option<usize>; 2] {
        [0, 1].map(|end| match ends.get(end).copied().flatten() {
            Some(Part::Body(body)) => self.of_body.get(body).copied(),
            _ => None,
        })
    }

    /// The first link that carries both of two, or is one of them: what it does, it does to both. `None` where there is none.
    #[must_use]
    pub fn meeting(&self, [a, b]: [Option<usize>; 2]) -> Option<usize> {
        let (a, b) = (a?, b?);
        self.path(a)
            .find(|link| self.path(b).any(|other| other == *link))
    }
}
