//! The rate node: its velocity w minimises the convex rate problem of its taut, damped lines.
//!
//! ```text
//! Φ(w) = Σ_taut (C/2) ([K s/C + u·(v − w)]₊)² − W·w           T = C [K s/C + u·(v − w)]₊
//! on the active set A:    D w = Σ_A (K s + C u·v) u + W,       D = Σ_A C u uᵀ
//! ```
//!
//! u points from the node to the anchor, v is the anchor's velocity, world axes. All velocities are taken relative to the mean v̄ of the
//! node's anchors, which costs no digits when everything falls together. Rules (R1–R4):
//! 1. The active set starts from the last one; lines with T < 0 leave, taut lines with a positive bracket enter.
//! 2. D of full rank (λ_min > 1e-6 λ_max): one Cholesky.
//! 3. Rank missing and nothing pulls: w = v̄ + D⁺ (…): no force hangs on the missing directions.
//! 4. Rank missing and something pulls: the missing directions are algebraic, w_⊥ = Σ (T/d) v_⊥ / Σ (T/d), and the node belongs on the line or in
//!    the plane through the carrying anchors ([`RateNode::projected`]).
//!
//! Rejected: a dashpot on the node. It makes D regular and the forces wrong.

use mbd_scene::Float;
use mbd_scene::laws::LineNumbers;
use nalgebra::{Matrix3, Vector3};

use super::balance::{Balance, Evaluation};
use super::eigen::eigen;
use super::solver::{Outcome, Solver, Tolerance};
use mbd_scene::laws::line as law;

/// λ_min over λ_max below which a direction of D is missing.
const RANK: f64 = 1e-6;
const MOST_CHANGES: usize = 30;

/// One line of a rate node at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// Bracket K s + C ṡ of a taut line [N]; the tension if it is active.
    pub pull: T,
    /// Stretch s [m].
    pub stretch: T,
    direction: Vector3<T>,
    length: T,
    /// K s + C u·(v − v̄) [N].
    push: T,
}

/// How the last solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spread {
    /// D has full rank: the velocity is unique.
    #[default]
    Full,
    /// Directions are missing and nothing pulls: rule 3.
    Idle,
    /// Directions are missing and something pulls: rule 4.
    Algebraic,
}

/// A rate node with room for its lines.
#[derive(Clone, Debug)]
pub struct RateNode<T: Float> {
    legs: Vec<Leg<T>>,
    position: Vector3<T>,
    load: Vector3<T>,
    mean: Vector3<T>,
    /// w − v̄.
    slip: Vector3<T>,
    spread: Spread,
    solver: Solver<T>,
}

impl<T: Float> Leg<T> {
    fn idle() -> Self {
        Leg {
            anchor: Vector3::zeros(),
            velocity: Vector3::zeros(),
            numbers: LineNumbers {
                stiffness: T::one(),
                damping: T::one(),
                free_length: T::one(),
            },
            taut: false,
            active: false,
            pull: T::zero(),
            stretch: T::zero(),
            direction: Vector3::zeros(),
            length: T::zero(),
            push: T::zero(),
        }
    }
}

impl<T: Float> RateNode<T> {
    /// Room for `lines` lines.
    #[must_use]
    pub fn new(lines: usize) -> Self {
        RateNode {
            legs: vec![Leg::idle(); lines],
            position: Vector3::zeros(),
            load: Vector3::zeros(),
            mean: Vector3::zeros(),
            slip: Vector3::zeros(),
            spread: Spread::Full,
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
        }
    }

    /// Places the node: geometry and stretch of every line, from its position [m] and the load on it [N].
    pub fn place(&mut self, position: Vector3<T>, load: Vector3<T>) {
        self.position = position;
        self.load = load;
        let mut sum = Vector3::zeros();
        let mut count = T::zero();
        for leg in &self.legs {
            sum += leg.velocity;
            count += T::one();
        }
        self.mean = sum.map(|x| x / count.max(T::one()));
        for leg in &mut self.legs {
            let geometry = law::geometry(&(leg.anchor - position), leg.numbers.free_length);
            leg.length = geometry.length;
            leg.direction = geometry.direction;
            leg.stretch = geometry.stretch;
            let relative = leg.direction.dot(&(leg.velocity - self.mean));
            leg.push = leg.numbers.stiffness * leg.stretch + leg.numbers.damping * relative;
        }
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
    pub fn spread(&self) -> Spread {
        self.spread
    }

    /// Solves on the present active set (rules 2–4).
    pub fn solve_frozen(&mut self) {
        let mut d = Matrix3::zeros();
        let mut right = self.load;
        for leg in self.legs.iter().filter(|leg| leg.active) {
            let c = leg.numbers.damping;
            d += (leg.direction * leg.direction.transpose()).map(|x| c * x);
            right += leg.direction.map(|x| leg.push * x);
        }
        self.spread = Spread::Full;
        if let Some(slip) = cholesky(&d, &right) {
            self.slip = slip;
            self.find_pulls();
            return;
        }
        let directions = eigen(&d);
        let limit = directions[0].0 * T::from_f64(RANK);
        let spans = |value: T| value > limit && value > T::zero();
        self.slip = Vector3::zeros();
        for (value, vector) in directions.iter().filter(|(value, _)| spans(*value)) {
            let along = vector.dot(&right) / *value;
            self.slip += vector.map(|x| along * x);
        }
        self.find_pulls();
        if directions.iter().all(|(value, _)| spans(*value)) {
            return;
        }
        self.spread = Spread::Idle;
        let (weight, weighted) = self.carrying();
        if weight > T::zero() {
            self.spread = Spread::Algebraic;
            for (_, vector) in directions.iter().filter(|(value, _)| !spans(*value)) {
                let along = vector.dot(&weighted) / weight;
                self.slip += vector.map(|x| along * x);
            }
            self.find_pulls();
        }
    }

    /// Decides the active set among the taut lines (rule 1) and solves on it. `false`: the convex search behind it did not converge.
    #[must_use]
    pub fn decide(&mut self) -> bool {
        for _ in 0..MOST_CHANGES {
            self.solve_frozen();
            if !self.change() {
                return true;
            }
        }
        let mut slip = [T::zero(); 3];
        let mut problem = RateProblem {
            legs: &self.legs,
            load: [self.load.x, self.load.y, self.load.z],
        };
        let outcome =
            self.solver
                .search(&mut problem, &[], &[], &mut slip, Tolerance::inside_step());
        self.slip = Vector3::from(slip);
        self.find_pulls();
        let zero = T::zero();
        for leg in &mut self.legs {
            leg.active = leg.taut && leg.pull > zero;
        }
        self.solve_frozen();
        !matches!(outcome, Outcome::NotConverged { .. })
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

    fn find_pulls(&mut self) {
        for leg in &mut self.legs {
            leg.pull = leg.push - leg.numbers.damping * leg.direction.dot(&self.slip);
        }
    }

    /// Forces below this are rounding [N].
    fn rounding(&self) -> T {
        let mut scale = T::zero();
        for leg in self.legs.iter().filter(|leg| leg.taut) {
            let along = leg.direction.dot(&self.slip).abs();
            scale = scale.max(leg.push.abs() + leg.numbers.damping * along);
        }
        scale * T::EPSILON * T::from_f64(1e4)
    }

    /// Σ T/d and Σ (T/d)(v − v̄) over the lines that pull; zero if the sum of their forces is rounding.
    fn carrying(&self) -> (T, Vector3<T>) {
        let rounding = self.rounding();
        let (mut weight, mut weighted) = (T::zero(), Vector3::zeros());
        for leg in self.pulling(rounding) {
            let w = leg.pull / leg.length;
            weight += w;
            weighted += (leg.velocity - self.mean).map(|x| w * x);
        }
        (weight, weighted)
    }

    fn pulling(&self, rounding: T) -> impl Iterator<Item = &Leg<T>> {
        self.legs
            .iter()
            .filter(move |leg| leg.active && leg.pull > rounding && leg.length > T::zero())
    }

    /// Where the node belongs by rule 4: its orthogonal projection on the line or the plane through the carrying anchors; `None` elsewhere.
    #[must_use]
    pub fn projected(&self) -> Option<Vector3<T>> {
        if self.spread != Spread::Algebraic {
            return None;
        }
        let rounding = self.rounding();
        let (mut count, mut center) = (T::zero(), Vector3::zeros());
        let mut d = Matrix3::zeros();
        for leg in self.pulling(rounding) {
            count += T::one();
            center += leg.anchor - self.position;
            d += leg.direction * leg.direction.transpose();
        }
        let center = center.map(|x| x / count);
        let mut scatter = Matrix3::zeros();
        for leg in self.pulling(rounding) {
            let arm = leg.anchor - self.position - center;
            scatter += arm * arm.transpose();
        }
        let carried = eigen(&d);
        let limit = carried[0].0 * T::from_f64(RANK);
        let mut offset = Vector3::zeros();
        for (axis, (value, _)) in eigen(&scatter).iter().zip(carried) {
            if value <= limit {
                let out = axis.1.dot(&center);
                offset += axis.1.map(|x| out * x);
            }
        }
        Some(self.position + offset)
    }

    /// Whether a load acts that the lines cannot balance: directions are missing and W does not vanish.
    #[must_use]
    pub fn unbalanced(&self) -> bool {
        self.spread != Spread::Full && self.load != Vector3::zeros()
    }
}

impl<T: Float> Leg<T> {
    fn wants_change(&self, rounding: T) -> bool {
        if self.active {
            self.pull < -rounding
        } else {
            self.taut && self.pull > rounding
        }
    }
}

/// Solves D x = r by Cholesky if D certainly has full rank: det D > 1e-5 (tr D)³ bounds λ_min/λ_max from below by 1e-5.
fn cholesky<T: Float>(d: &Matrix3<T>, right: &Vector3<T>) -> Option<Vector3<T>> {
    let trace = d[(0, 0)] + d[(1, 1)] + d[(2, 2)];
    let (a, b, c) = (d[(1, 0)], d[(2, 0)], d[(2, 1)]);
    let l00 = d[(0, 0)].sqrt();
    let (l10, l20) = (a / l00, b / l00);
    let p1 = d[(1, 1)] - l10 * l10;
    let l11 = p1.sqrt();
    let l21 = (c - l20 * l10) / l11;
    let p2 = d[(2, 2)] - l20 * l20 - l21 * l21;
    let certain = d[(0, 0)] * p1 * p2 > T::from_f64(1e-5) * trace * trace * trace;
    if !certain || p1 <= T::zero() || p2 <= T::zero() {
        return None;
    }
    let y0 = right.x / l00;
    let y1 = (right.y - l10 * y0) / l11;
    let z = (right.z - l20 * y0 - l21 * y1) / p2;
    let y = (y1 - l21 * z) / l11;
    let x = (y0 - l10 * y - l20 * z) / l00;
    Some(Vector3::new(x, y, z))
}

/// The rate problem as a balance, for the slope search: the unknown is w − v̄.
struct RateProblem<'a, T: Float> {
    legs: &'a [Leg<T>],
    load: [T; 3],
}

impl<T: Float> Balance<T> for RateProblem<'_, T> {
    fn nodes(&self) -> usize {
        1
    }

    fn lines(&self) -> usize {
        0
    }

    fn load(&self) -> &[T] {
        &self.load
    }

    fn evaluate(&mut self, p: &[T], _k: &[T], _l: &[T], out: &mut Evaluation<T>) {
        let &[x, y, z] = p else { return };
        let slip = Vector3::new(x, y, z);
        let mut gradient = -Vector3::from(self.load);
        let mut h = Matrix3::zeros();
        let mut sums = [T::zero(); 3];
        for leg in self.legs.iter().filter(|leg| leg.taut) {
            let c = leg.numbers.damping;
            let along = c * leg.direction.dot(&slip);
            let pull = leg.push - along;
            if pull < T::zero() {
                continue;
            }
            gradient -= leg.direction.map(|u| pull * u);
            h += (leg.direction * leg.direction.transpose()).map(|x| c * x);
            sums[0] += pull;
            sums[1] += leg.push.abs() + along.abs();
            if pull > T::zero() {
                sums[2] += T::one();
            }
        }
        let values = [
            gradient.x,
            gradient.y,
            gradient.z,
            h[(0, 0)],
            h[(0, 1)],
            h[(0, 2)],
            h[(1, 1)],
            h[(1, 2)],
            h[(2, 2)],
            sums[0],
            sums[1],
            sums[2],
        ];
        for (target, value) in out.values_mut().iter_mut().zip(values) {
            *target = value;
        }
    }

    fn smallest_slack(&self, _p: &[T], _l: &[T]) -> T {
        T::one()
    }
}
