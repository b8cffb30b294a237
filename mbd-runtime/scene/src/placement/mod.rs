//! A state from joint coordinates: bodies are placed along a spanning tree of the joints, and loops are closed by the coordinates that nobody gave.
//!
//! ```text
//! o2 = o1 + R1 s,   R2 = R1 R12                           frame 2 of a joint at its coordinates q: s, R12 its motion           (1)
//! v2 = v1 + ω1 × R1 s + R1 (H u)_v,   ω2 = ω1 + R1 (H u)_ω                                                                     (2)
//! Φ(q given, y) = 0,   Φ_v v + Φ_t = 0                    y and its rates: the coordinates of the tree that are not given      (3)
//! ```
//!
//! Couplings close loops. The tree takes the joints with given coordinates first, then the others in the order of declaration, those marked `loop` last. y starts at zero;
//! of it what lies in a loop is searched for, the rest stays there. (3) is solved by damped least squares (Levenberg and Marquardt), its rates, which are linear, by least squares.

use nalgebra::DVector;

use crate::evaluate::{Scratch, driven_coordinates, evaluate};
use crate::laws::ground::ground;
use crate::laws::numbers::Numbers;
use crate::laws::row_units;
use crate::{Arguments, FrameMotion, Joint, Layout, Part, Place, Quantity, Scene, StartFrom};
use tree::{PlacingJoint, tree};

mod about;
mod at_zero;
mod close;
mod couplings;
mod decided;
mod given;
mod loops;
mod mechanisms;
mod plane_turns;
mod reach;
mod report;
mod tree;
mod walk;

pub(crate) use couplings::followers;
pub use given::{JointStart, StartNumber};
pub(crate) use mechanisms::touched;
pub(crate) use plane_turns::by_bodies;
pub use reach::{BeyondReach, beyond_reach};
pub use report::{AboutStart, PlacementError, PlacementReport};

/// A loop is closed when its rows are below this, lengths as parts of [`Placement::length`].
const CLOSED: f64 = 1e-11;
/// What rounding leaves of a place, in parts of how far it is from the origin.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Freedoms of a body that floats.
pub(crate) const FREE: usize = 6;

struct Placement<'a> {
    scene: &'a Scene,
    layout: &'a Layout,
    numbers: Numbers<f64>,
    ground: Vec<Option<FrameMotion<f64>>>,
    from: StartFrom<'a>,
    links: Vec<PlacingJoint>,
    /// Parts that stay where the state has them.
    fixed: &'a [Part],
    /// Coordinates and speeds of every joint.
    q: Vec<Vec<f64>>,
    u: Vec<Vec<f64>>,
    scratch: Scratch<f64>,
    /// The size of the mechanism: the longest arm of a joint [m].
    size: f64,
    /// What rows that are lengths are measured by [m]: `size`, or more where places so far from the origin are known no better.
    length: f64,
    /// Which rows are lengths.
    lengths: Vec<bool>,
}

/// Writes the bodies and points that joints place into a state, for the joint coordinates that are given; those of motors are what their
/// courses say. `fixed` stay where the state has them. With nothing given coordinates are zero, or where loops close from there; what hangs on a
/// loop that does not close stays where the state has it.
///
/// # Errors
/// A coordinate that is decided otherwise; loops that the other coordinates cannot close.
pub fn place(
    scene: &Scene,
    layout: &Layout,
    from: StartFrom<'_>,
    given: &[JointStart],
    fixed: &[Part],
    state: &mut [f64],
) -> Result<PlacementReport, PlacementError> {
    place_near(scene, layout, from, (given, &[]), fixed, state)
}

/// The same, where y of (3) is searched from some coordinates on instead of zero; those that it is not at in the end are told with what is about a value.
///
/// # Errors
/// As [`place`].
pub(crate) fn place_near(
    scene: &Scene,
    layout: &Layout,
    from: StartFrom<'_>,
    (given, near): (&[JointStart], &[JointStart]),
    fixed: &[Part],
    state: &mut [f64],
) -> Result<PlacementReport, PlacementError> {
    if state.len() != layout.nx() {
        return Ok(PlacementReport::default());
    }
    let (links, decided) = tree(scene, layout, given, fixed);
    if links.is_empty() && given.is_empty() {
        return Ok(PlacementReport::default());
    }
    let mut placement = Placement::new((scene, layout), from, links, fixed);
    placement.set(near);
    let mut all = given.to_vec();
    for driven in placement.driven(state) {
        all.retain(|it| (it.joint, it.coordinate) != (driven.joint, driven.coordinate));
        all.push(driven);
    }
    placement.set(&all);
    placement.follow_couplings(&[all.as_slice(), near].concat());
    placement.measure(state);
    let mut report = if given.is_empty() {
        placement.rest(&all, state)
    } else {
        let solved = placement.solve(&all, state);
        placement.confirm(&decided, given, state)?;
        solved?
    };
    report.about.extend(placement.gave_way(near, state));
    Ok(report)
}

/// Writes where bodies start that fly from a frame of the world: there both frames of their joint `free` coincide and move together. What other joints
/// or a declared start say of such a body is written behind this.
pub(crate) fn place_flying(scene: &Scene, layout: &Layout, from: StartFrom<'_>, state: &mut [f64]) {
    let links = (scene.joints.iter().enumerate()).filter_map(|(joint, declared)| {
        let to = flies_from_world(declared)?;
        Some(PlacingJoint {
            joint,
            to,
            to_parent: false,
        })
    });
    let links: Vec<PlacingJoint> = links.collect();
    if !links.is_empty() && state.len() == layout.nx() {
        Placement::new((scene, layout), from, links, &[]).walk(state);
    }
}

/// The body that a joint says flies from a frame of the world.
pub(crate) fn flies_from_world(joint: &Joint) -> Option<Part> {
    match (joint.parent, joint.child) {
        (Place::World(_), Place::Body(body, _)) if joint.law.freedoms() == FREE => {
            Some(Part::Body(body))
        }
        _ => None,
    }
}

impl<'a> Placement<'a> {
    /// All coordinates at zero, nothing moves.
    fn new(
        (scene, layout): (&'a Scene, &'a Layout),
        from: StartFrom<'a>,
        links: Vec<PlacingJoint>,
        fixed: &'a [Part],
    ) -> Self {
        let numbers = Numbers::new(scene, from.params);
        let mut frames = Vec::new();
        ground(scene, &numbers, from.time, &mut frames);
        let zero = |joint: &Joint| {
            let mut q = vec![0.0; joint.law.coordinates()];
            if let Some(attitude) = joint.law.attitude() {
                q[attitude.start] = 1.0;
            }
            q
        };
        let speeds = |joint: &Joint| vec![0.0; joint.law.freedoms()];
        Placement {
            scene,
            layout,
            ground: frames,
            from,
            links,
            fixed,
            q: scene.joints.iter().map(zero).collect(),
            u: scene.joints.iter().map(speeds).collect(),
            scratch: Scratch::new(layout),
            numbers,
            size: 1.0,
            length: 1.0,
            lengths: Vec::new(),
        }
    }
}

impl Placement<'_> {
    fn here(&self, state: &[f64]) -> Arguments<f64> {
        Arguments::before_a_run(self.scene, self.layout, self.from, state)
    }

    /// Coordinates and rates as they are said.
    fn set(&mut self, said: &[JointStart]) {
        for start in said {
            let lists = [&mut self.q, &mut self.u];
            for (list, number) in lists.into_iter().zip([start.value, start.rate]) {
                let slot = list.get_mut(start.joint);
                let slot = slot.and_then(|list| list.get_mut(start.coordinate));
                if let (Some(slot), Some(number)) = (slot, number) {
                    *slot = number;
                }
            }
        }
    }

    /// What motors follow is what the state and the defaults of the inputs say, as in the rows of (3).
    fn driven(&mut self, state: &[f64]) -> Vec<JointStart> {
        let here = self.here(state);
        let (numbers, scratch) = (&self.numbers, &mut self.scratch);
        driven_coordinates(self.scene, self.layout, numbers, &here.at(), scratch)
    }

    /// Rows of all joints at these coordinates and speeds; nothing that a node decides.
    fn rows(&mut self, what: Quantity, state: &mut [f64]) -> DVector<f64> {
        self.walk(state);
        let mut out = vec![0.0; self.layout.len(what)];
        let place = self.here(state);
        evaluate(
            what,
            self.scene,
            self.layout,
            &self.numbers,
            &place.at(),
            &mut self.scratch,
            &mut out,
        );
        if matches!(what, Quantity::Constraint | Quantity::ConstraintRate) {
            let rows = out.iter_mut().zip(&self.lengths);
            let lengths = rows.filter(|(_, is_length)| **is_length);
            lengths.for_each(|(row, _)| *row /= self.length);
        }
        DVector::from_vec(out)
    }

    /// Finds what lengths are measured by: mechanisms of any size, and anywhere, close alike.
    fn measure(&mut self, state: &mut [f64]) {
        let arm = self.numbers.longest_arm(self.scene);
        self.walk(state);
        let layout = self.layout;
        let moves = layout.directions.translations().len();
        let bodies = layout.own_bodies().map(|(_, slots)| slots);
        let places = bodies.filter_map(|slots| state.get(slots.q..slots.q + moves));
        let far = places.map(|place| place.iter().map(|x| x * x).sum::<f64>().sqrt());
        let world = self.numbers.world_frames.iter();
        let world = world.map(|frame| frame.position.norm());
        let far = far.chain(world).filter(|far| far.is_finite());
        let far = far.fold(0.0, f64::max);
        let known = [arm, far].into_iter().find(|size| *size > 0.0);
        self.size = known.filter(|size| size.is_finite()).unwrap_or(1.0);
        self.length = self.size.max(ROUNDING / CLOSED * far);
        let here = self.here(state);
        let units = |joint| row_units(self.scene, layout, &self.numbers, &here.at(), joint);
        let mut lengths = vec![false; layout.len(Quantity::Constraint)];
        for (joint, slots) in layout.joints.iter().enumerate() {
            let own = lengths.iter_mut().skip(slots.row);
            for (row, unit) in own.zip(units(joint)) {
                *row = unit == "m";
            }
        }
        self.lengths = lengths;
    }

    /// What a coordinate is measured by: 1 rad of an angle or an attitude, else the size of the mechanism.
    fn scale(&self, joint: usize, coordinate: usize) -> f64 {
        let found = self.scene.coordinate(joint, coordinate);
        match found.is_some_and(|(_, coordinate)| !coordinate.is_angle()) {
            true => self.size,
            false => 1.0,
        }
    }

    /// Attitudes are unit quaternions.
    fn normalise(&mut self) {
        for joint in 0..self.scene.joints.len() {
            self.normalise_joint(joint);
        }
    }

    /// The attitude of one joint, if it has one, is a unit quaternion.
    fn normalise_joint(&mut self, joint: usize) {
        if let Some(attitude) = self.scene.joints[joint].law.attitude() {
            let attitude = &mut self.q[joint][attitude];
            let length = attitude.iter().map(|x| x * x).sum::<f64>().sqrt();
            attitude.iter_mut().for_each(|x| *x /= length);
        }
    }
}
