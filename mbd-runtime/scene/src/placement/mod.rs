//! A state from joint coordinates: bodies are placed along a spanning tree of the joints, and loops are closed by the coordinates that nobody gave.
//!
//! ```text
//! o2 = o1 + R1 s,   R2 = R1 R12                           frame 2 of a joint at its coordinates q: s, R12 its motion           (1)
//! v2 = v1 + ω1 × R1 s + R1 (H u)_v,   ω2 = ω1 + R1 (H u)_ω                                                                     (2)
//! Φ(q given, y) = 0,   Φ_v v + Φ_t = 0                    y and its rates: the coordinates of the tree that are not given      (3)
//! ```
//!
//! Couplings close loops. The tree takes the joints with given coordinates first, then the others in the order of declaration, those marked `loop` last. y starts at zero;
//! (3) is solved by damped least squares (Levenberg and Marquardt), its rates, which are linear, by least squares.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::evaluate::{Scratch, driven_coordinates, evaluate};
use crate::laws::body::{BodyMotion, attitude_of};
use crate::laws::ground::ground;
use crate::laws::numbers::Numbers;
use crate::laws::{branch, row_units};
use crate::{
    AngularVelocity, Arguments, FrameMotion, Layout, Part, Place, PointSlots, Quantity, Relative,
    Scene, Twist,
};

mod about;
mod at_zero;
mod couplings;

/// Iterations that close the loops.
const ITERATIONS: usize = 100;
/// Starts of y that are tried: zero, then others, ever further away [rad, or parts of a metre].
const REACHES: [f64; 8] = [0.0, 0.1, 0.3, 0.3, 1.0, 1.0, 2.0, 3.0];
/// A loop is closed when its rows are below this [m or 1].
const CLOSED: f64 = 1e-11;
/// Rates contradict each other where they leave the rows more than this part of what one of them asks for; less is what their digits leave.
const CONTRADICTION: f64 = 1e-3;
/// Freedoms of a body that floats.
pub(crate) const FREE: usize = 6;
/// The step of the differences that linearise (3).
const DIFFERENCE: f64 = 1e-6;

/// A joint coordinate at the start, and its rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointStart {
    /// The joint, by index.
    pub joint: usize,
    /// The coordinate, by number.
    pub coordinate: usize,
    /// Its value [m or rad]; `None`: as the others decide.
    pub value: Option<f64>,
    /// Its rate [m/s or rad/s]; `None`: as the others decide, zero where they do not.
    pub rate: Option<f64>,
    /// Whether the value gives way where loops do not close with it: the nearest that they close with is taken.
    pub about: bool,
}

/// What placing bodies by joint coordinates decided beyond what it was told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlacementReport {
    /// The coordinates that are said to be about a value, in the order they were given.
    pub about: Vec<AboutStart>,
    /// Coordinates of loops that nothing said decides, joint and number: what is taken is near zero, or near what was taken before.
    pub undecided: Vec<(usize, usize)>,
}

impl PlacementReport {
    /// Coordinates that are about a value by their names, with what was said and what was taken [m or rad].
    #[must_use]
    pub fn told_about(&self, scene: &Scene) -> Vec<(String, f64, f64)> {
        let told = self.about.iter().map(|start| {
            let name = scene.coordinate_name(start.joint, start.coordinate);
            (name, start.said, start.taken)
        });
        told.collect()
    }

    /// The coordinates that nothing decides, by their names.
    #[must_use]
    pub fn told_undecided(&self, scene: &Scene) -> Vec<String> {
        let all = self.undecided.iter();
        all.map(|&(joint, coordinate)| scene.coordinate_name(joint, coordinate))
            .collect()
    }
}

/// Where a coordinate starts that was said to be about a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AboutStart {
    /// The joint, by index.
    pub joint: usize,
    /// The coordinate, by number.
    pub coordinate: usize,
    /// The value that was said [m or rad].
    pub said: f64,
    /// The value that it has [m or rad].
    pub taken: f64,
}

impl Scene {
    /// The joint coordinate of a name, `pin.angle`, or of that of its rate, `pin.angle_rate`: joint, number, whether it is the rate.
    #[must_use]
    pub fn joint_coordinate(&self, name: &str) -> Option<(usize, usize, bool)> {
        let (owner, word) = name.rsplit_once('.')?;
        let joint = self.joints.iter().position(|joint| joint.name == owner)?;
        let mut measured = self.joints.get(joint)?.law.measured().enumerate();
        let (number, found) =
            measured.find(|(_, found)| found.name == word || found.rate == word)?;
        Some((joint, number, found.rate == word))
    }

    /// The name of a joint coordinate, `pin.angle`; empty of none.
    #[must_use]
    pub fn coordinate_name(&self, joint: usize, coordinate: usize) -> String {
        let found = self.coordinate(joint, coordinate);
        found.map_or_else(String::new, |(joint, it)| {
            format!("{}.{}", joint.name, it.name)
        })
    }

    /// The names of all joint coordinates, each followed by that of its rate.
    #[must_use]
    pub fn joint_coordinates(&self) -> Vec<String> {
        let joints = self.joints.iter();
        let names = joints.flat_map(|joint| {
            let words = joint
                .law
                .measured()
                .flat_map(|found| [found.name, found.rate]);
            words.map(move |word| format!("{}.{word}", joint.name))
        });
        names.collect()
    }
}

impl PlacementError {
    /// The joint and what is wrong with its start, as it follows its name.
    #[must_use]
    pub fn describe(&self, scene: &Scene) -> (String, String) {
        let (joint, why) = match *self {
            PlacementError::Decided { joint } => (
                joint,
                "is placed already, by other joint coordinates or by the bodies it joins: leave out one of them, or say `about` before the start that may give way".to_owned(),
            ),
            PlacementError::Rates { joint } => (
                joint,
                "comes apart: the rates that its loop starts with contradict each other; leave out one of them".to_owned(),
            ),
            PlacementError::Open { joint, gap, unit } => (
                joint,
                format!("stays open by {gap:.1e} {unit}: the starts that are given, and the lengths of its loop, let nothing close it; leave out a start there, say `about` before one that may give way, or change a length"),
            ),
        };
        let name = scene.joints.get(joint).map(|joint| joint.name.clone());
        (name.unwrap_or_default(), why)
    }
}

/// What is said of a coordinate or a rate at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StartNumber {
    /// It is this [SI].
    Exact(f64),
    /// It is this [SI] where loops close with it, and the nearest that they close with where not.
    About(f64),
}

impl StartNumber {
    /// The number that is said [SI].
    #[must_use]
    pub const fn number(self) -> f64 {
        match self {
            StartNumber::Exact(number) | StartNumber::About(number) => number,
        }
    }
}

impl From<f64> for StartNumber {
    fn from(number: f64) -> Self {
        StartNumber::Exact(number)
    }
}

impl JointStart {
    /// Values and rates by their names, brought together. The first name that is none is an error; a rate is what it is said to be about.
    ///
    /// # Errors
    /// That name.
    pub fn by_name<'a>(
        scene: &Scene,
        given: impl IntoIterator<Item = (&'a str, StartNumber)>,
    ) -> Result<Vec<Self>, &'a str> {
        let mut starts: Vec<JointStart> = Vec::new();
        for (name, said) in given {
            let (joint, coordinate, is_rate) = scene.joint_coordinate(name).ok_or(name)?;
            let same = |known: &JointStart| (known.joint, known.coordinate) == (joint, coordinate);
            let index = starts.iter().position(same).unwrap_or_else(|| {
                starts.push(JointStart {
                    joint,
                    coordinate,
                    value: None,
                    rate: None,
                    about: false,
                });
                starts.len() - 1
            });
            let start = &mut starts[index];
            if is_rate {
                start.rate = Some(said.number());
            } else {
                start.value = Some(said.number());
                start.about = matches!(said, StartNumber::About(_));
            }
        }
        Ok(starts)
    }
}

/// Why bodies cannot be placed by joint coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacementError {
    /// Where this joint's ends are is decided already, by other coordinates that are given, or by the bodies themselves.
    Decided {
        /// The joint, by index.
        joint: usize,
    },
    /// The rates that are given contradict each other: no rates of the other joints keep the loops closed.
    Rates {
        /// The joint that would come apart fastest, by index.
        joint: usize,
    },
    /// No coordinates of the other joints close the loops.
    Open {
        /// The joint that is open most, by index.
        joint: usize,
        /// By how much, in `unit`.
        gap: f64,
        /// `m`, or `rad` of axes that are not where they belong.
        unit: &'static str,
    },
}

/// A joint walked from the part that is placed to the one it places.
#[derive(Clone, Copy)]
struct PlacingJoint {
    joint: usize,
    to: Part,
    to_parent: bool,
}

/// Position, axes, velocity and angular velocity of a part or a frame, world axes.
#[derive(Clone, Copy)]
struct MovingFrame {
    position: Vector3<f64>,
    axes: Matrix3<f64>,
    velocity: Vector3<f64>,
    omega: Vector3<f64>,
}

/// What stays open most.
#[derive(Clone, Copy)]
struct OpenRow {
    size: f64,
    joint: usize,
    unit: &'static str,
}

impl Default for OpenRow {
    fn default() -> Self {
        OpenRow {
            size: f64::INFINITY,
            joint: 0,
            unit: "m",
        }
    }
}

impl OpenRow {
    fn error(self) -> PlacementError {
        PlacementError::Open {
            joint: self.joint,
            gap: self.size,
            unit: self.unit,
        }
    }
}

struct Placement<'a> {
    scene: &'a Scene,
    layout: &'a Layout,
    numbers: Numbers<f64>,
    ground: Vec<Option<FrameMotion<f64>>>,
    time: f64,
    links: Vec<PlacingJoint>,
    /// Coordinates and speeds of every joint.
    q: Vec<Vec<f64>>,
    u: Vec<Vec<f64>>,
    scratch: Scratch<f64>,
}

/// Writes the bodies and points that joints place into a state, for the joint coordinates that are given; those of motors are what their
/// courses say. `fixed` stay where the state has them. With nothing given coordinates are zero, and what hangs on a loop that is open there stays
/// where the state has it.
///
/// # Errors
/// A coordinate that is decided otherwise; loops that the other coordinates cannot close.
pub fn place(
    scene: &Scene,
    layout: &Layout,
    from: (&[f64], f64),
    given: &[JointStart],
    fixed: &[Part],
    state: &mut [f64],
) -> Result<PlacementReport, PlacementError> {
    place_near(scene, layout, from, (given, &[]), fixed, state)
}

/// The same, where y of (3) is searched from some coordinates on instead of zero.
///
/// # Errors
/// As [`place`].
pub(crate) fn place_near(
    scene: &Scene,
    layout: &Layout,
    (params, time): (&[f64], f64),
    (given, near): (&[JointStart], &[JointStart]),
    fixed: &[Part],
    state: &mut [f64],
) -> Result<PlacementReport, PlacementError> {
    if state.len() != layout.nx() {
        return Ok(PlacementReport::default());
    }
    let links = tree(scene, layout, given, fixed)?;
    if links.is_empty() && given.is_empty() {
        return Ok(PlacementReport::default());
    }
    let numbers = Numbers::new(scene, params);
    let mut frames = Vec::new();
    ground(scene, &numbers, time, &mut frames);
    let zero = |joint: &crate::Joint| {
        let mut q = vec![0.0; joint.law.coordinates()];
        if let Some(attitude) = joint.law.attitude() {
            q[attitude.start] = 1.0;
        }
        q
    };
    let mut placement = Placement {
        scene,
        layout,
        ground: frames,
        time,
        links,
        q: scene.joints.iter().map(zero).collect(),
        u: scene
            .joints
            .iter()
            .map(|joint| vec![0.0; joint.law.freedoms()])
            .collect(),
        scratch: Scratch::new(layout),
        numbers,
    };
    for start in near {
        let list = placement.q.get_mut(start.joint);
        let slot = list.and_then(|list| list.get_mut(start.coordinate));
        if let (Some(slot), Some(value)) = (slot, start.value) {
            *slot = value;
        }
    }
    let mut all = given.to_vec();
    for driven in placement.driven(state) {
        all.retain(|it| (it.joint, it.coordinate) != (driven.joint, driven.coordinate));
        all.push(driven);
    }
    match given.is_empty() {
        true => {
            placement.rest(&all, state);
            Ok(PlacementReport::default())
        }
        false => placement.solve(&all, state),
    }
}

/// The spanning tree, in the order in which it is walked.
fn tree(
    scene: &Scene,
    layout: &Layout,
    given: &[JointStart],
    fixed: &[Part],
) -> Result<Vec<PlacingJoint>, PlacementError> {
    // What holds exactly goes first, what may give way next: what is left over closes the loops.
    let rank = |joint: usize| {
        let own = given.iter().filter(|start| start.joint == joint);
        let gives_way = |start: &JointStart| start.about && start.rate.is_none();
        own.map(|start| u8::from(gives_way(start)))
            .min()
            .unwrap_or(2)
    };
    // What flies from another body starts where that is.
    let flies = |joint: usize| {
        let from_body = matches!(scene.joints[joint].parent, Place::Body(..));
        from_body && scene.joints[joint].law.freedoms() == FREE
    };
    let mut order: Vec<usize> = (0..layout.joints.len())
        .filter(|&joint| {
            let holds = layout.starts_joined(joint);
            (holds && scene.joints[joint].law.couples().is_empty()) || flies(joint)
        })
        .collect();
    order.sort_by_key(|&joint| (flies(joint), rank(joint), scene.joints[joint].cut));
    // What hangs together; the world and everything fixed are one.
    let mut together: Vec<Vec<Option<Part>>> = vec![vec![None]];
    together[0].extend(fixed.iter().copied().map(Some));
    let mut edges = Vec::new();
    for joint in order {
        let [Some(&parent), Some(&child)] = [0, 1].map(|k| layout.joints[joint].ends.get(k)) else {
            continue;
        };
        let ends = [parent, child];
        let [a, b] = ends.map(|end| {
            let found = together.iter().position(|set| set.contains(&end));
            found.unwrap_or_else(|| {
                together.push(vec![end]);
                together.len() - 1
            })
        });
        if a == b {
            if rank(joint) == 0 {
                return Err(PlacementError::Decided { joint });
            }
            continue;
        }
        let moved = together.remove(a.max(b));
        together[a.min(b)].extend(moved);
        edges.push((joint, ends));
    }
    let mut placed: Vec<Option<Part>> = vec![None];
    placed.extend(fixed.iter().copied().map(Some));
    let mut links = Vec::new();
    while !edges.is_empty() {
        let next = edges
            .iter()
            .position(|(_, ends)| ends.iter().any(|end| placed.contains(end)));
        let Some(next) = next else {
            // Nothing ties these to the world: the first of them stays where it is.
            let (_, ends) = edges[0];
            placed.push(ends[0]);
            continue;
        };
        let (joint, [parent, child]) = edges.remove(next);
        let to_parent = placed.contains(&child);
        let to = if to_parent { parent } else { child };
        if let Some(to) = to {
            links.push(PlacingJoint {
                joint,
                to,
                to_parent,
            });
            placed.push(Some(to));
        }
    }
    Ok(links)
}

impl Placement<'_> {
    fn solve(
        &mut self,
        given: &[JointStart],
        state: &mut [f64],
    ) -> Result<PlacementReport, PlacementError> {
        let find = |joint: usize, coordinate: usize| {
            let mut starts = given.iter();
            starts.find(|start| (start.joint, start.coordinate) == (joint, coordinate))
        };
        let (mut unknowns, mut yielding) = (Vec::new(), Vec::new());
        let (mut said_rates, mut rates) = (Vec::new(), Vec::new());
        for link in &self.links {
            let joint = link.joint;
            // What flies closes no loop.
            if self.scene.joints[joint].law.freedoms() == FREE {
                continue;
            }
            for (k, q) in self.q[joint].iter_mut().enumerate() {
                let start = find(joint, k);
                match start.and_then(|start| start.value) {
                    Some(value) => *q = value,
                    None => unknowns.push((joint, k)),
                }
                if start.is_some_and(|start| start.about && start.value.is_some()) {
                    yielding.push((joint, k));
                }
            }
            for (k, u) in self.u[joint].iter_mut().enumerate() {
                match find(joint, k).and_then(|start| start.rate) {
                    Some(rate) => {
                        *u = rate;
                        said_rates.push((joint, k));
                    }
                    None => rates.push((joint, k)),
                }
            }
        }
        let wishes = about::wishes(given);
        let said = self.q.clone();
        let closed = self.close(&unknowns, state);
        if wishes.is_empty() {
            closed?;
        } else if closed != Ok(true) || !self.grants(&wishes, state) {
            self.q = said;
            let all: Vec<(usize, usize)> = unknowns.iter().chain(&yielding).copied().collect();
            self.close_near(&all, &wishes, state)?;
        }
        self.close_rates([&said_rates, &rates], state)?;
        let assembly = PlacementReport {
            about: self.granted(&wishes, state),
            undecided: self.undecided(&unknowns, state),
        };
        self.walk(state);
        Ok(assembly)
    }

    /// Whether every joint is on the branch it means: rows have more roots than that.
    fn is_on_branch(&self, state: &mut [f64]) -> bool {
        self.walk(state);
        let place = self.here(state);
        let at = place.at();
        let mut held = (0..self.layout.joints.len()).filter(|&j| self.layout.starts_joined(j));
        held.all(|joint| {
            let signs = branch(self.scene, self.layout, &self.numbers, &at, joint);
            signs.iter().all(|sign| *sign > 0.0)
        })
    }

    /// Whether the loops close on the branches that joints mean half a turn of one angle from here; where none does, nothing is changed.
    fn turns_back(&mut self, unknowns: &[(usize, usize)], state: &mut [f64]) -> bool {
        let here = self.q.clone();
        for &(joint, k) in unknowns {
            let mut measured = self.scene.joints[joint].law.measured();
            if !measured
                .nth(k)
                .is_some_and(|coordinate| coordinate.is_angle())
            {
                continue;
            }
            self.q[joint][k] += std::f64::consts::PI;
            let gap = self.descend(unknowns, state);
            if gap.size <= CLOSED && self.is_on_branch(state) {
                return true;
            }
            self.q.clone_from(&here);
        }
        false
    }

    /// Moves coordinates away from where they are, each attempt further; the first leaves them.
    fn scatter(&mut self, unknowns: &[(usize, usize)], attempt: usize) {
        let reach = REACHES.get(attempt).copied().unwrap_or_default();
        for (number, &(joint, k)) in unknowns.iter().enumerate() {
            // Any numbers do that are unlike: no coordinate at the same place twice.
            let turn = 2.4 * (number + 7 * attempt) as f64;
            self.q[joint][k] += reach * turn.sin();
        }
        self.normalise();
    }

    /// Solves (3) for the coordinates; whether every joint is on the branch it means. Where it closes only with joints reversed, which a start refuses
    /// by name, that is what stays.
    fn close(
        &mut self,
        unknowns: &[(usize, usize)],
        state: &mut [f64],
    ) -> Result<bool, PlacementError> {
        let start = self.q.clone();
        let mut best = OpenRow::default();
        let mut other_branch = None;
        for attempt in 0..REACHES.len() {
            self.q.clone_from(&start);
            self.scatter(unknowns, attempt);
            let gap = self.descend(unknowns, state);
            if gap.size <= CLOSED {
                if self.is_on_branch(state) || self.turns_back(unknowns, state) {
                    return Ok(true);
                }
                other_branch.get_or_insert_with(|| self.q.clone());
            } else if gap.size < best.size {
                best = gap;
            }
        }
        match other_branch {
            Some(q) => self.q = q,
            None => return Err(best.error()),
        }
        Ok(false)
    }

    /// Damped least squares from here; what stays open most.
    fn descend(&mut self, unknowns: &[(usize, usize)], state: &mut [f64]) -> OpenRow {
        let mut gaps = self.rows(Quantity::Constraint, state);
        let mut damping = 1e-3;
        for _ in 0..ITERATIONS {
            if gaps.amax() <= CLOSED || unknowns.is_empty() {
                break;
            }
            let slopes = self.slopes(unknowns, state, &|it, state| {
                it.rows(Quantity::Constraint, state)
            });
            let normal = slopes.transpose() * &slopes;
            let right = slopes.transpose() * &gaps;
            let scale = normal.diagonal().max();
            let damped = normal
                + DMatrix::from_diagonal_element(unknowns.len(), unknowns.len(), damping * scale);
            let Some(step) = damped.cholesky().map(|factor| factor.solve(&right)) else {
                break;
            };
            let before = self.q.clone();
            for (&(joint, k), step) in unknowns.iter().zip(step.iter()) {
                self.q[joint][k] -= step;
            }
            self.normalise();
            let tried = self.rows(Quantity::Constraint, state);
            if tried.norm() < gaps.norm() {
                gaps = tried;
                damping = (damping * 0.1).max(1e-14);
            } else {
                self.q = before;
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        let size = gaps.amax();
        if size <= CLOSED {
            return OpenRow {
                size,
                joint: 0,
                unit: "m",
            };
        }
        let worst = gaps.iamax();
        let joint = self.joint_of(worst);
        let size = if size.is_finite() {
            size
        } else {
            f64::INFINITY
        };
        let unit = self.unit_of(joint, worst, state);
        OpenRow { size, joint, unit }
    }

    /// The unit of a row of a joint.
    fn unit_of(&self, joint: usize, row: usize, state: &[f64]) -> &'static str {
        let place = self.here(state);
        let units = row_units(self.scene, self.layout, &self.numbers, &place.at(), joint);
        let first = self.layout.joints.get(joint).map_or(0, |slots| slots.row);
        units.get(row.saturating_sub(first)).copied().unwrap_or("m")
    }

    /// Solves (3) for the rates: the smallest that do. Rates that are `said` and contradict each other by more than their digits are told.
    fn close_rates(
        &mut self,
        [said, rates]: [&[(usize, usize)]; 2],
        state: &mut [f64],
    ) -> Result<(), PlacementError> {
        let mut gaps = self.rows(Quantity::ConstraintRate, state);
        if gaps.amax() <= CLOSED {
            return Ok(());
        }
        if !rates.is_empty() {
            let mut slopes = DMatrix::zeros(gaps.len(), rates.len());
            for (column, &(joint, k)) in rates.iter().enumerate() {
                self.u[joint][k] = 1.0;
                slopes.set_column(
                    column,
                    &(self.rows(Quantity::ConstraintRate, state) - &gaps),
                );
                self.u[joint][k] = 0.0;
            }
            if let Ok(found) = slopes.svd(true, true).solve(&gaps, 1e-9) {
                for (&(joint, k), rate) in rates.iter().zip(found.iter()) {
                    self.u[joint][k] = -rate;
                }
            }
            gaps = self.rows(Quantity::ConstraintRate, state);
        }
        // What each of them alone asks of the rows: the size that a contradiction is measured by.
        let mut size: f64 = 0.0;
        for &(joint, k) in said {
            let rate = std::mem::take(&mut self.u[joint][k]);
            let without = self.rows(Quantity::ConstraintRate, state);
            self.u[joint][k] = rate;
            size = size.max((&gaps - without).amax());
        }
        match !said.is_empty() && gaps.amax() > CONTRADICTION * size {
            true => Err(PlacementError::Rates {
                joint: self.joint_of(gaps.iamax()),
            }),
            false => Ok(()),
        }
    }

    /// The joint of a row.
    fn joint_of(&self, row: usize) -> usize {
        let mut rows = self.layout.joints.iter();
        let joint = rows.position(|slots| (slots.row..slots.row + slots.len).contains(&row));
        joint.unwrap_or(0)
    }

    fn here(&self, state: &[f64]) -> Arguments<f64> {
        Arguments::before_a_run(self.scene, self.layout, self.time, state)
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
        DVector::from_vec(out)
    }

    /// Attitudes are unit quaternions.
    fn normalise(&mut self) {
        for (joint, q) in self.scene.joints.iter().zip(&mut self.q) {
            if let Some(attitude) = joint.law.attitude() {
                let attitude = &mut q[attitude];
                let length = attitude.iter().map(|x| x * x).sum::<f64>().sqrt();
                attitude.iter_mut().for_each(|x| *x /= length);
            }
        }
    }

    /// Places every part of the tree by (1) and (2).
    fn walk(&self, state: &mut [f64]) {
        for link in &self.links {
            let Some(moving) = self.placed(link, state) else {
                continue;
            };
            let directions = self.layout.directions;
            let slots = self.layout.own_slots(link.to);
            let Some(slots) = slots else { continue };
            let v = self.layout.nq + slots.v;
            directions.write_linear(state, slots.q, &moving.position);
            directions.write_linear(state, v, &moving.velocity);
            if let Part::Body(_) = link.to {
                let attitude = attitude_of(&moving.axes, directions);
                let at = slots.q + directions.translations().len();
                for (slot, value) in state.iter_mut().skip(at).zip(attitude) {
                    *slot = value;
                }
                let omega = match self.scene.angular_velocity {
                    AngularVelocity::Body => moving.axes.transpose() * moving.omega,
                    AngularVelocity::World => moving.omega,
                };
                directions.write_angular(state, v, &omega);
            }
        }
    }

    /// Where a link puts the part it places.
    fn placed(&self, link: &PlacingJoint, state: &[f64]) -> Option<MovingFrame> {
        let joint = self.scene.joints.get(link.joint)?;
        let at = Relative {
            q: &self.q[link.joint],
            u: &self.u[link.joint],
            numbers: self.numbers.joints.get(link.joint)?,
        };
        let pose = joint.law.motion(&at);
        let mut columns = vec![Twist::zero(); joint.law.freedoms()];
        joint.law.subspace(&at, &mut columns);
        let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
        for (column, u) in columns.iter().zip(at.u) {
            linear += column.linear * *u;
            angular += column.angular * *u;
        }
        let (near, far) = match link.to_parent {
            true => (joint.child, joint.parent),
            false => (joint.parent, joint.child),
        };
        let from = self.frame(near, state)?;
        let frame = if link.to_parent {
            let axes = from.axes * pose.rotation.transpose();
            let omega = from.omega - axes * angular;
            let arm = axes * pose.position;
            MovingFrame {
                position: from.position - arm,
                axes,
                velocity: from.velocity - omega.cross(&arm) - axes * linear,
                omega,
            }
        } else {
            let arm = from.axes * pose.position;
            MovingFrame {
                position: from.position + arm,
                axes: from.axes * pose.rotation,
                velocity: from.velocity + from.omega.cross(&arm) + from.axes * linear,
                omega: from.omega + from.axes * angular,
            }
        };
        let (point, own) = self.place_of(far)?;
        let axes = match link.to {
            Part::Body(_) => frame.axes * own.transpose(),
            _ => Matrix3::identity(),
        };
        let arm = axes * point;
        Some(MovingFrame {
            position: frame.position - arm,
            axes,
            velocity: frame.velocity - frame.omega.cross(&arm),
            omega: frame.omega,
        })
    }

    /// A place of a joint on what it sits on: position and axes.
    fn place_of(&self, place: Place) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        let frame = match place {
            Place::World(frame) => self.numbers.world_frames.get(frame)?,
            Place::Body(body, frame) => self.numbers.bodies.get(body)?.frames.get(frame)?,
            Place::Point(_) => return Some((Vector3::zeros(), Matrix3::identity())),
        };
        Some((
            frame.position,
            frame.rotation.unwrap_or_else(Matrix3::identity),
        ))
    }

    /// A place of a joint in the world, as the state has it.
    fn frame(&self, place: Place, state: &[f64]) -> Option<MovingFrame> {
        let (layout, directions) = (self.layout, self.layout.directions);
        match place {
            Place::World(frame) => Some(match self.ground.get(frame).copied().flatten() {
                Some(motion) => MovingFrame {
                    position: motion.position,
                    axes: motion.rotation.unwrap_or_else(Matrix3::identity),
                    velocity: motion.velocity,
                    omega: motion.omega,
                },
                None => {
                    let (position, axes) = self.place_of(place)?;
                    let still = Vector3::zeros();
                    MovingFrame {
                        position,
                        axes,
                        velocity: still,
                        omega: still,
                    }
                }
            }),
            Place::Body(body, _) => {
                let slots = layout.own_slots(Part::Body(body))?;
                let components = self.scene.angular_velocity;
                let motion = BodyMotion::read(state, slots, layout.nq, directions, components);
                let (point, axes) = self.place_of(place)?;
                Some(MovingFrame {
                    position: motion.position + motion.arm(&point),
                    axes: motion.rotation * axes,
                    velocity: motion.velocity_of(&point),
                    omega: motion.omega_world,
                })
            }
            Place::Point(point) => match layout.points.get(point)? {
                PointSlots::Mass(slots) => Some(MovingFrame {
                    position: directions.linear(state, slots.q),
                    axes: Matrix3::identity(),
                    velocity: directions.linear(state, layout.nq + slots.v),
                    omega: Vector3::zeros(),
                }),
                PointSlots::Node(_) => None,
            },
        }
    }
}
