//! The rate node: its velocity w minimises the convex rate problem of its taut, damped lines.
//!
//! ```text
//! Φ(w) = Σ_taut (C/2) ([K s/C + u·(v − w)]₊)² − W·w           T = C [K s/C + u·(v − w)]₊
//! on the active set A:    D w = Σ_A (K s + C u·v) u + W,       D = Σ_A C u uᵀ
//! ```
//!
//! u points from the node to the anchor, v is the anchor's velocity, world axes. All velocities are taken relative to the mean v̄ of the
//! node's anchors, which costs no digits when everything falls together. Rules (R1–R6):
//! 1. The active set starts from the last one; lines with T < 0 leave, taut lines with a positive bracket enter.
//! 2. D of full rank (λ_min > 1e-6 λ_max, in single precision 1.2e-4 λ_max): one Cholesky.
//! 3. Rank missing and nothing pulls: w = v̄ + D⁺ (…): no force hangs on the missing directions.
//! 4. Rank missing and something pulls: the missing directions are algebraic, w_⊥ = (Σ (T/d) v_⊥ + Ẇ_⊥) / Σ (T/d), the rate of the balance across
//!    the lines, and the node belongs on the line or in the plane through the carrying anchors ([`RateNode::projected`]), for as long as these are in one: four anchors may be for an instant. Where they are
//!    too few for that a load W completes it: two lines carry W in the plane through both anchors along W, one line right in front of its anchor, and
//!    the node is put there at the lengths that its lines have. Ẇ is that of [`Scene::tells_load_rate`](mbd_scene::Scene::tells_load_rate), zero of other
//!    loads: what these leave beside that place is an error of the step.
//! 5. Independent lines without force that pull the node into such a line or plane, with a velocity that grows without bound: it is put there
//!    ([`RateNode::crossing`]). Lines that are still taut there carry from then on; those that are not go slack until their anchors have drawn them straight.
//!    Where modes are held, no step of an explicit method passes that instant: one that would is a part of the way there ([`RateNode::straight_in`]).
//! 6. No active set is consistent because lines are as good as in one line or plane but not there yet: the balance of the limit
//!    (`RateNode::limit`).
//!
//! Rule 6. A time ε later the node has moved by ε w and its anchors by ε v, and every line has rotated: Σ T (u + ε u̇) + W = 0 with
//! u̇ = (1 − u uᵀ)(v − w)/d. With the elastic tensions K s in the small term,
//!
//! ```text
//! (D + ε G) w = Σ_A (K s + C u·v) u + W + ε N Ẇ + ε Σ_taut (K s/d) N (1 − u uᵀ) N v,       G = Σ_taut (K s/d) N (1 − u uᵀ) N
//! ```
//!
//! with N the projection on the missing directions. It is the minimum of a strictly convex function, so there is one w and one set of forces. Where
//! no line damps, w is that of rule 4, with the elastic tensions as weights, and it pulls the node into the line or plane within a few ε, 1e-4 of
//! the shortest C/K. The forces leave ε G (w − V) open, across that plane only: at most 0.53 % of the sum of the pulls in 20,000 random
//! problems, 26 of which came here (`tests/tests/lines/nodes/models.rs`). Derivatives are those of rule 4. A direction that lines damp with less
//! than 1e-6 of the largest damping counts as missing, so that w stays below 1e3 times what the lines allow one by one. Between rules 2 and 4
//! w is not continuous there: the velocity of the singular approach ends, and the tensions begin.
//!
//! Rejected: a dashpot on the node. It makes D regular and the forces wrong.

use mbd_scene::laws::rate::{Dashpots, mean};
use mbd_scene::laws::{LineNumbers, line as law};
use mbd_scene::{Float, elements, symmetric};
use nalgebra::{Matrix3, Vector3};

use super::balance::{Balance, BalanceEvaluation, triple};
use super::eigen::eigen;
use super::solver::{Outcome, Solver, Tolerance};

/// λ_min over λ_max below which a direction of D is missing, and the least number of roundings that this is: velocities of nearly straight lines are rounded by
/// so much more than their components.
const RANK: f64 = 1e-6;
const FEWEST: f64 = 1e3;
/// Roundings of the largest term of a pull below which a force is none.
pub(super) const ROUNDING: f64 = 1e4;
const MOST_CHANGES: usize = 30;
/// The vanishing dashpot over the largest damping: it only tells the active set.
const DASHPOT: f64 = 1e-8;
/// The same below which lines without force are nearly straight (rule 5), over [`RANK`]: before a stage of the next step finds the direction missing.
const NEARLY: f64 = 10.0;
/// The same of lines that carry once they are straight: what they are longer by before is a force there.
const LAST: f64 = 2.0;
/// ε of rule 6 over the shortest C/K.
const AHEAD: f64 = 1e-4;
/// How far a step may leave a node beside the place where its lines carry its load (rule 4), over the length of the shortest of them.
const BESIDE: f64 = 0.1;

/// One line of a rate node at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leg<T: Float> {
    /// The anchor [m].
    pub anchor: Vector3<T>,
    /// Its velocity [m/s].
    pub velocity: Vector3<T>,
    /// K, C, L0.
    pub numbers: LineNumbers<T>,
    /// Longer than its free length.
    pub taut: bool,
    /// In the active set.
    pub active: bool,
    /// In the active set as it was carried in.
    carried: bool,
    /// Bracket K s + C ṡ of a taut line [N]; the tension if it is active.
    pub pull: T,
    /// Stretch s [m].
    pub stretch: T,
    pub(crate) direction: Vector3<T>,
    pub(crate) length: T,
    /// u·(v − v̄) [m/s].
    opening: T,
    /// K s + C u·(v − v̄) [N].
    push: T,
}

/// How the last solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RateOutcome {
    /// D has full rank: the velocity is unique.
    #[default]
    Full,
    /// Directions are missing and nothing pulls: rule 3.
    Idle,
    /// Directions are missing and something pulls: rule 4.
    Algebraic,
}

/// Where a node is put that its lines pull into their line or plane without force (rule 5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing<T: Float> {
    /// On the line or plane through the anchors [m].
    pub place: Vector3<T>,
    /// How many directions the lines span there.
    pub rank: usize,
    /// Whether they are all longer than their free lengths there: they carry from then on.
    pub taut: bool,
}

impl<T: Float> Crossing<T> {
    /// Whether a line is longer than its free length there.
    #[must_use]
    pub fn keeps_taut(&self, leg: &Leg<T>) -> bool {
        let arm = leg.anchor - self.place;
        law::geometry(&arm, leg.numbers.free_length).stretch > T::zero()
    }
}

/// A rate node with room for its lines.
#[derive(Clone, Debug)]
pub struct RateNode<T: Float> {
    legs: Vec<Leg<T>>,
    position: Vector3<T>,
    load: Vector3<T>,
    /// Ẇ [N/s].
    load_rate: Vector3<T>,
    mean: Vector3<T>,
    /// w − v̄.
    slip: Vector3<T>,
    spread: RateOutcome,
    /// Directions the active lines span.
    rank: usize,
    /// The rank of an algebraic set is held while the set stays as it was carried in.
    held: usize,
    /// For the problem with a dashpot.
    solver: Solver<T>,
}

impl<T: Float> Leg<T> {
    /// K s + C ṡ where the node moves with `slip` relative to v̄ [N].
    fn pull_at(&self, slip: &Vector3<T>) -> T {
        let rate = self.opening - self.direction.dot(slip);
        law::Element::linear(self.numbers).pull(self.stretch, rate)
    }

    /// C u uᵀ.
    fn dashpot(&self) -> Matrix3<T> {
        let c = self.numbers.damping;
        (self.direction * self.direction.transpose()).map(|x| c * x)
    }

    /// The largest term of its pull where the node moves with `slip` relative to v̄ [N].
    fn scale(&self, slip: &Vector3<T>) -> T {
        self.push.abs() + self.numbers.damping * self.direction.dot(slip).abs()
    }

    fn pulls(&self, rounding: T) -> bool {
        self.active && self.pull > rounding && self.length > T::zero()
    }

    fn wants_change(&self, rounding: T) -> bool {
        if self.active {
            self.pull < -rounding
        } else {
            self.taut && self.pull > rounding
        }
    }
}

impl<T: Float> RateNode<T> {
    /// Room for `lines` lines.
    #[must_use]
    pub fn new(lines: usize) -> Self {
        RateNode {
            legs: vec![Leg::default(); lines],
            position: Vector3::zeros(),
            load: Vector3::zeros(),
            load_rate: Vector3::zeros(),
            mean: Vector3::zeros(),
            slip: Vector3::zeros(),
            spread: RateOutcome::Full,
            rank: 3,
            held: 3,
            solver: Solver::new(1, 0, &[(0, 0)]),
        }
    }

    /// The lines as of the last solve.
    #[must_use]
    pub fn legs(&self) -> &[Leg<T>] {
        &self.legs
    }

    /// Sets one line: anchor [m], its velocity [m/s], constants. An index beyond the lines is ignored.
    pub fn set_leg(
        &mut self,
        index: usize,
        anchor: Vector3<T>,
        velocity: Vector3<T>,
        numbers: LineNumbers<T>,
    ) {
        if let Some(leg) = self.legs.get_mut(index) {
            leg.anchor = anchor;
            leg.velocity = velocity;
            leg.numbers = numbers;
        }
    }

    /// Sets which lines are taut and which of them are active; both are kept until they are set or decided again.
    pub fn set_mode(&mut self, index: usize, taut: bool, active: bool) {
        if let Some(leg) = self.legs.get_mut(index) {
            leg.taut = taut;
            leg.active = taut && active;
            leg.carried = leg.active;
        }
    }

    /// Holds the rank of an algebraic set (rule 4) through a step: stage values leave the line or plane of the anchors by the error of a stage,
    /// and must not be taken for independent lines there. 3: nothing is held.
    pub fn hold_rank(&mut self, rank: usize) {
        self.held = rank;
    }

    /// The rank to hold from here on: that of an algebraic set whose node is on the line or plane of its anchors, 3 otherwise. Anchors that were in one
    /// plane for an instant only, as those of four lines may be, span space again where the node is then.
    #[must_use]
    pub fn rank(&self) -> usize {
        if self.spread == RateOutcome::Algebraic && spanned(&self.damping()).1 <= self.rank {
            self.rank
        } else {
            3
        }
    }

    /// Places the node: geometry and stretch of every line, from its position [m], the load on it [N] and the rate of that [N/s].
    pub fn place(&mut self, position: Vector3<T>, load: [Vector3<T>; 2]) {
        self.position = position;
        [self.load, self.load_rate] = load;
        self.mean = mean(self.legs.iter().map(|leg| leg.velocity));
        for leg in &mut self.legs {
            let geometry = law::geometry(&(leg.anchor - position), leg.numbers.free_length);
            leg.length = geometry.length;
            leg.direction = geometry.direction;
            leg.stretch = geometry.stretch;
            leg.opening = leg.direction.dot(&(leg.velocity - self.mean));
            leg.push = leg.pull_at(&Vector3::zeros());
        }
    }

    /// Until the node is placed again, makes a line shorter by what lengths are known to [m], so that a pull below that is none behind an event; or longer,
    /// if it was taut there and begins to pull.
    pub(crate) fn look_behind(&mut self, index: usize, begins: bool, within: T) {
        if let Some(leg) = self.legs.get_mut(index) {
            let rises = begins && leg.stretch > within;
            leg.stretch += if rises { within } else { -within };
            leg.push = leg.pull_at(&Vector3::zeros());
        }
    }

    /// Places the node where it is: every line is as long as the state has it.
    pub(crate) fn place_again(&mut self) {
        self.place(self.position, [self.load, self.load_rate]);
    }

    /// Every line with positive stretch is taut, every other slack.
    pub fn taut_by_stretch(&mut self) {
        for leg in &mut self.legs {
            leg.taut = leg.stretch > T::zero();
            leg.active &= leg.taut;
        }
    }

    /// The velocity w of the node [m/s].
    #[must_use]
    pub fn velocity(&self) -> Vector3<T> {
        self.mean + self.slip
    }

    /// The rank of the last solve.
    #[must_use]
    pub fn spread(&self) -> RateOutcome {
        self.spread
    }

    /// Solves on the present active set (rules 2–4).
    pub fn solve_frozen(&mut self) {
        let mut balance = Dashpots::under(self.load);
        for leg in self.legs.iter().filter(|leg| leg.active) {
            balance.add(&leg.direction, leg.numbers.damping, leg.push);
        }
        let (d, right) = (symmetric(balance.damping), balance.force);
        let held = self.held < 3 && self.legs.iter().all(|leg| leg.active == leg.carried);
        if held && self.solve_spanned(&eigen(&d), &right, self.held) {
            return;
        }
        (self.spread, self.rank) = (RateOutcome::Full, 3);
        let slip = balance.solve();
        if slip.margin > T::zero() && slip.velocity.iter().all(|x| x.is_finite()) {
            self.move_with(slip.velocity);
            return;
        }
        let (directions, rank) = spanned(&d);
        self.solve_spanned(&directions, &right, rank);
    }

    /// D = Σ C u uᵀ over the active lines.
    fn damping(&self) -> Matrix3<T> {
        let active = self.legs.iter().filter(|leg| leg.active);
        active.fold(Matrix3::zeros(), |sum, leg| sum + leg.dashpot())
    }

    /// Solves in the first `rank` directions; the others follow rule 3 or, if something pulls (`true`), rule 4.
    fn solve_spanned(
        &mut self,
        directions: &[(T, Vector3<T>); 3],
        right: &Vector3<T>,
        rank: usize,
    ) -> bool {
        self.move_with(inverse(&directions[..rank], right));
        if rank == 3 {
            return false;
        }
        self.rank = rank;
        self.spread = RateOutcome::Idle;
        let (weight, weighted) = self.carrying();
        if weight <= T::zero() {
            return false;
        }
        self.spread = RateOutcome::Algebraic;
        let free = projection(&directions[rank..], &weighted);
        self.move_with(self.slip + free.map(|x| x / weight));
        true
    }

    /// Decides the active set among the taut lines (rule 1) and solves on it. `false`: it could not be decided.
    #[must_use]
    pub fn decide(&mut self) -> bool {
        for _ in 0..MOST_CHANGES {
            self.solve_frozen();
            if !self.change() {
                return true;
            }
        }
        let settled = self.minimise(Matrix3::zeros(), self.load);
        self.solve_frozen();
        let tolerated = self.scale() * T::from_f64(1e2 * DASHPOT).max(T::EPSILON.sqrt());
        let consistent = settled && !self.legs.iter().any(|leg| leg.wants_change(tolerated));
        consistent || self.limit()
    }

    /// The balance of the limit, rule 6. `false`: no line is stretched, or the minimum was not found.
    fn limit(&mut self) -> bool {
        let taut = self.legs.iter().filter(|leg| leg.taut);
        let relaxation = |leg: &Leg<T>| leg.numbers.damping / leg.numbers.stiffness;
        let Some(shortest) = taut.clone().map(relaxation).reduce(|a, b| a.min(b)) else {
            return false;
        };
        let ahead = shortest * T::from_f64(AHEAD);
        let (directions, rank) = spanned(&self.damping());
        let mut missing = Matrix3::zeros();
        for (_, n) in directions.iter().skip(rank.min(2)) {
            missing += n * n.transpose();
        }
        let (mut transverse, mut force) = (Matrix3::zeros(), self.load);
        force += (missing * self.load_rate).map(|x| ahead * x);
        for leg in taut.filter(|leg| leg.length > T::zero()) {
            let weight = ahead * leg.numbers.stiffness * leg.stretch.max(T::zero()) / leg.length;
            let u = missing * leg.direction;
            let across = (missing - u * u.transpose()).map(|x| weight * x);
            transverse += across;
            force += across * (leg.velocity - self.mean);
        }
        let found = self.minimise(transverse, force);
        let (_, rank) = spanned(&self.damping());
        let pulls = self.carrying().0 > T::zero();
        self.rank = rank;
        self.spread = match pulls {
            true => RateOutcome::Algebraic,
            false => RateOutcome::Idle,
        };
        found
    }

    /// Moves the node to the minimum of Φ(w) + ½ wᵀ B w − f·w, where `transverse` is B and `force` f, with a vanishing dashpot beside: strictly
    /// convex, so Newton with slope search finds its one minimum. The lines that pull there become the active set. `false`: not found.
    fn minimise(&mut self, transverse: Matrix3<T>, force: Vector3<T>) -> bool {
        let damping = self.legs.iter().map(|leg| leg.numbers.damping);
        let largest = damping.fold(T::zero(), |most, c| most.max(c));
        let dashpot = T::from_f64(DASHPOT).max(T::EPSILON * T::from_f64(1e3)) * largest;
        let mut problem = Dashed {
            legs: &self.legs,
            force: force.as_slice(),
            beside: transverse + Matrix3::from_diagonal_element(dashpot),
        };
        let tolerance = Tolerance {
            relative: T::zero(),
            absolute: T::EPSILON * T::from_f64(1e2),
        };
        let mut slip = Vector3::zeros();
        let place = slip.as_mut_slice();
        let outcome = self.solver.search(&mut problem, &[], &[], place, tolerance);
        self.move_with(slip);
        for leg in &mut self.legs {
            leg.active = leg.taut && leg.pull > T::zero();
        }
        matches!(outcome, Outcome::Taut { .. })
    }

    /// Whether the present active set is wrong by more than rounding.
    #[must_use]
    pub fn inconsistent(&self) -> bool {
        let rounding = self.rounding();
        self.legs.iter().any(|leg| leg.wants_change(rounding))
    }

    /// Lines that push leave the active set, taut lines that would pull enter it. `false`: nothing changed.
    fn change(&mut self) -> bool {
        let rounding = self.rounding();
        let mut changed = false;
        for leg in &mut self.legs {
            if leg.wants_change(rounding) {
                leg.active = !leg.active;
                changed = true;
            }
        }
        changed
    }

    /// Moves the node with `slip` relative to v̄ and finds the pulls.
    fn move_with(&mut self, slip: Vector3<T>) {
        self.slip = slip;
        for leg in &mut self.legs {
            leg.pull = leg.pull_at(&slip);
        }
    }

    /// Forces below this are rounding [N].
    fn rounding(&self) -> T {
        self.scale() * T::EPSILON * T::from_f64(ROUNDING)
    }

    /// The largest term of a pull [N].
    fn scale(&self) -> T {
        let taut = self.legs.iter().filter(|leg| leg.taut);
        taut.fold(T::zero(), |most, leg| most.max(leg.scale(&self.slip)))
    }

    /// Σ T/d over the lines that pull and Σ (T/d)(v − v̄) + Ẇ, by which the node moves where they do not span space.
    fn carrying(&self) -> (T, Vector3<T>) {
        let rounding = self.rounding();
        let (mut weight, mut weighted) = (T::zero(), self.load_rate);
        for leg in self.legs.iter().filter(|leg| leg.pulls(rounding)) {
            let w = leg.pull / leg.length;
            weight += w;
            weighted += (leg.velocity - self.mean).map(|x| w * x);
        }
        (weight, weighted)
    }

    /// Moves the node with a velocity [m/s].
    pub(crate) fn set_velocity(&mut self, velocity: Vector3<T>) {
        self.move_with(velocity - self.mean);
    }

    /// The part of each line in the motion that its lines do not span: T/d by rule 4, or equal parts where nothing pulls; their sum is 1.
    pub(crate) fn weights(&self) -> impl Iterator<Item = T> + '_ {
        let (total, _) = self.carrying();
        let rounding = self.rounding();
        let equal = T::one() / T::from_f64(self.legs.len().max(1) as f64);
        let weight = move |leg: &Leg<T>| match (total > T::zero(), leg.pulls(rounding)) {
            (true, true) => leg.pull / leg.length / total,
            (true, false) => T::zero(),
            (false, _) => equal,
        };
        self.legs.iter().map(weight)
    }

    /// Σ T/d over the lines that pull [N/m]: what the parts by rule 4 are taken of; zero where nothing pulls.
    pub(crate) fn total_weight(&self) -> T {
        self.carrying().0
    }

    /// Where the node belongs by rule 4: its orthogonal projection on the line or the plane through the carrying anchors; `None` elsewhere, and where
    /// fewer anchors carry than a line or a plane goes through and no load completes it: what one line pulls is rounding then, as nothing holds
    /// against it.
    #[must_use]
    pub fn projected(&self) -> Option<Vector3<T>> {
        if self.spread != RateOutcome::Algebraic {
            return None;
        }
        let rounding = self.rounding();
        let offset = match self.carrying_count() > self.rank {
            true => self.to_hull(self.rank, |leg| leg.pulls(rounding)),
            false => self.beside_load()?,
        };
        Some(self.position + offset)
    }

    /// How many lines pull.
    fn carrying_count(&self) -> usize {
        let rounding = self.rounding();
        self.legs.iter().filter(|leg| leg.pulls(rounding)).count()
    }

    /// Whether the load of the node completes the line or plane that it is on: one anchor less carries than go through that.
    pub(crate) fn is_carried_with_load(&self) -> bool {
        self.spread == RateOutcome::Algebraic
            && self.load != Vector3::zeros()
            && self.carrying_count() == self.rank
    }

    /// From the node to where its one or two carrying lines, of the lengths that they have, carry its load: on their sphere or circle as far as the load
    /// draws it. `None` where the load completes nothing.
    fn beside_load(&self) -> Option<Vector3<T>> {
        if !self.is_carried_with_load() {
            return None;
        }
        let rounding = self.rounding();
        let legs = self.legs.iter().filter(|leg| leg.pulls(rounding));
        let mut arms = legs.map(|leg| leg.anchor - self.position);
        let first = arms.next()?;
        let axis = arms.next().map(|second| second - first);
        let across = |vector: Vector3<T>| match axis {
            Some(axis) => {
                let part = axis.dot(&vector) / axis.dot(&axis);
                vector - axis.map(|x| part * x)
            }
            None => vector,
        };
        let (center, load) = (across(first), across(self.load));
        let ratio = (center.dot(&center) / load.dot(&load)).sqrt();
        ratio.is_finite().then(|| center + load.map(|w| ratio * w))
    }

    /// Rule 5, the singular approach: independent lines without force whose node reaches the line or plane through their anchors, with a velocity that grows
    /// without bound on the way. Where they are all still taut there they carry from then on, and it is put there within half a step `span` [s] of it. Where
    /// the lines are as long as they are without force, the anchors draw them straight, and they are slack until then: the bodies do not feel where the
    /// node is, as nothing pulls, and it is put there before D loses a direction inside a step.
    #[must_use]
    pub fn crossing(&self, span: T) -> Option<Crossing<T>> {
        if span <= T::zero() {
            return None;
        }
        let (crossing, offset, directions) = self.nearest_crossing()?;
        let weakest = directions[crossing.rank];
        let active = self.legs.iter().filter(|leg| leg.active);
        let hull = mean(active.map(|leg| leg.velocity - self.mean));
        let nears = offset.dot(&(self.slip - hull)) > T::zero();
        let speed = weakest.1.dot(&self.slip) * span;
        let within = crossing.taut && speed * speed > T::from_f64(0.25) * offset.dot(&offset);
        let nearly = least_rank::<T>() * T::from_f64(if crossing.taut { LAST } else { NEARLY });
        let reached = within || nears && weakest.0 < nearly * directions[0].0;
        reached.then_some(crossing)
    }

    /// The line or plane through the anchors of independent lines without force, from the node to there, and the directions of D.
    fn nearest_crossing(&self) -> Option<(Crossing<T>, Vector3<T>, EigenPairs<T>)> {
        if self.load != Vector3::zeros() {
            return None;
        }
        let rounding = self.rounding();
        let active = || self.legs.iter().filter(|leg| leg.active);
        let count = active().count();
        // Where nearly straight lines pull as independent ones, of which there are no more than three, it is rounding.
        let pulled = active().any(|leg| leg.pulls(rounding));
        if pulled && count > 3 {
            return None;
        }
        let (directions, rank) = spanned(&self.damping());
        if pulled && count > rank {
            return None;
        }
        let weakest = rank.checked_sub(1).filter(|weakest| *weakest > 0)?;
        let offset = self.to_hull(weakest, |leg| leg.active);
        let mut crossing = Crossing {
            place: self.position + offset,
            rank: weakest,
            taut: true,
        };
        crossing.taut = active().all(|leg| crossing.keeps_taut(leg));
        Some((crossing, offset, directions))
    }

    /// In how much time the anchors of independent lines without force are in one line or plane with the node (rule 5), as it and they move now [s]: its distance is
    /// the root of what falls evenly. `None` where it is not drawn there.
    #[must_use]
    pub fn straight_in(&self) -> Option<T> {
        let (crossing, offset, _) = self.nearest_crossing()?;
        let active = || self.legs.iter().filter(|leg| leg.active);
        let center = mean(active().map(|leg| leg.anchor - crossing.place));
        let drift = mean(active().map(|leg| leg.velocity - self.mean));
        let (mut scatter, mut turning) = (Matrix3::zeros(), Matrix3::zeros());
        for leg in active() {
            let arm = leg.anchor - crossing.place - center;
            scatter += arm * arm.transpose();
            turning += (leg.velocity - self.mean - drift) * arm.transpose();
        }
        // The line or plane turns with its anchors.
        let along = inverse(&eigen(&scatter)[..crossing.rank], &-center);
        let hull = drift + turning * along;
        let closing = offset.dot(&(self.slip - hull));
        let time = offset.dot(&offset) / (closing + closing);
        (closing > T::zero() && time.is_finite()).then_some(time)
    }

    /// From the node to its projection on the line (`rank` 1) or plane (2) that fits the anchors of the chosen lines best.
    fn to_hull(&self, rank: usize, chosen: impl Fn(&Leg<T>) -> bool) -> Vector3<T> {
        let legs = self.legs.iter().filter(|leg| chosen(leg));
        let arms = legs.map(|leg| leg.anchor - self.position);
        let center = mean(arms.clone());
        let scatter = arms.fold(Matrix3::zeros(), |sum, arm| {
            sum + (arm - center) * (arm - center).transpose()
        });
        projection(&eigen(&scatter)[rank..], &center)
    }

    /// Whether a load acts that the lines cannot balance: W has a part in the missing directions, and the node is not where it has none.
    #[must_use]
    pub fn unbalanced(&self) -> bool {
        if self.spread == RateOutcome::Full || self.load == Vector3::zeros() {
            return false;
        }
        if let Some(offset) = self.beside_load() {
            let rounding = self.rounding();
            let carrying = self.legs.iter().filter(|leg| leg.pulls(rounding));
            let lengths = carrying.map(|leg| leg.length);
            let shortest = lengths.reduce(|a, b| a.min(b)).unwrap_or_default();
            let most = T::from_f64(BESIDE) * shortest;
            return offset.dot(&offset) > most * most;
        }
        let directions = eigen(&self.damping());
        let missing = projection(&directions[self.rank.min(3)..], &self.load);
        missing.dot(&missing) > T::EPSILON * self.load.dot(&self.load)
    }
}

/// The rate problem with damping of the node itself: p is the slip w − v̄ [m/s], its gradient and stiffness are those of Φ.
struct Dashed<'a, T: Float> {
    legs: &'a [Leg<T>],
    force: &'a [T],
    beside: Matrix3<T>,
}

impl<T: Float> Balance<T> for Dashed<'_, T> {
    fn nodes(&self) -> usize {
        1
    }

    fn load(&self) -> &[T] {
        self.force
    }

    fn evaluate(&mut self, p: &[T], _k: &[T], _l: &[T], out: &mut BalanceEvaluation<T>) {
        let slip = triple(p, 0);
        let mut gradient = self.beside * slip - triple(self.force, 0);
        let mut stiffness = self.beside;
        let mut scale = T::zero();
        for leg in self.legs.iter().filter(|leg| leg.taut) {
            let pull = leg.pull_at(&slip);
            scale = scale.max(leg.scale(&slip));
            if pull > T::zero() {
                gradient -= leg.direction.map(|u| pull * u);
                stiffness += leg.dashpot();
            }
        }
        // The dashpot always carries: nothing here is slack.
        let sums = [scale, scale, T::one()];
        let values = gradient.as_slice().iter().copied();
        let values = values.chain(elements(&stiffness)).chain(sums);
        for (to, value) in out.values_mut().iter_mut().zip(values) {
            *to = value;
        }
    }

    fn places(&self, _line: usize, _p: &[T]) -> [Vector3<T>; 2] {
        [Vector3::zeros(); 2]
    }
}

/// Eigenvalue and unit vector.
type EigenPair<T> = (T, Vector3<T>);
/// Of a symmetric matrix, the largest eigenvalue first.
type EigenPairs<T> = [EigenPair<T>; 3];

/// λ_min over λ_max below which a direction is missing in a precision.
fn least_rank<T: Float>() -> T {
    T::from_f64(RANK).max(T::EPSILON * T::from_f64(FEWEST))
}

/// The directions of D, and how many of them its lines span.
pub(crate) fn spanned<T: Float>(d: &Matrix3<T>) -> (EigenPairs<T>, usize) {
    let directions = eigen(d);
    let limit = (directions[0].0 * least_rank::<T>()).max(T::zero());
    let spanned = directions.iter().filter(|(value, _)| *value > limit);
    (directions, spanned.count())
}

/// D⁺ b in these directions.
pub(crate) fn inverse<T: Float>(directions: &[EigenPair<T>], right: &Vector3<T>) -> Vector3<T> {
    let part = |(value, vector): &EigenPair<T>| {
        let along = vector.dot(right) / *value;
        vector.map(|x| along * x)
    };
    directions
        .iter()
        .map(part)
        .fold(Vector3::zeros(), |a, b| a + b)
}

/// The part of a vector in these directions.
pub(crate) fn projection<T: Float>(directions: &[EigenPair<T>], vector: &Vector3<T>) -> Vector3<T> {
    let part = |(_, direction): &EigenPair<T>| {
        let along = direction.dot(vector);
        direction.map(|x| along * x)
    };
    directions
        .iter()
        .map(part)
        .fold(Vector3::zeros(), |a, b| a + b)
}
