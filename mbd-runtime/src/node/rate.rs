//! The rate node: its velocity w minimises the convex rate problem of its taut, damped lines.
//!
//! ```text
//! Φ(w) = Σ_taut (C/2) ([K s/C + u·(v − w)]₊)² − W·w           T = C [K s/C + u·(v − w)]₊
//! on the active set A:    D w = Σ_A (K s + C u·v) u + W,       D = Σ_A C u uᵀ
//! ```
//!
//! u points from the node to the anchor, v is the anchor's velocity, world axes. All velocities are taken relative to the mean v̄ of the
//! node's anchors, which costs no digits when everything falls together. Rules (R1–R5):
//! 1. The active set starts from the last one; lines with T < 0 leave, taut lines with a positive bracket enter.
//! 2. D of full rank (λ_min > 1e-6 λ_max): one Cholesky.
//! 3. Rank missing and nothing pulls: w = v̄ + D⁺ (…): no force hangs on the missing directions.
//! 4. Rank missing and something pulls: the missing directions are algebraic, w_⊥ = Σ (T/d) v_⊥ / Σ (T/d), and the node belongs on the line or in
//!    the plane through the carrying anchors ([`RateNode::projected`]).
//! 5. Independent taut lines without force that pull the node into such a line or plane: it is put there ([`RateNode::crossing`]).
//!
//! Rejected: a dashpot on the node. It makes D regular and the forces wrong.

use mbd_scene::Float;
use mbd_scene::laws::LineNumbers;
use nalgebra::{Matrix3, Vector3};

use super::eigen::eigen;
use mbd_scene::laws::line as law;

/// λ_min over λ_max below which a direction of D is missing.
const RANK: f64 = 1e-6;
const MOST_CHANGES: usize = 30;
/// The vanishing dashpot over the largest damping: it only tells the active set.
const DASHPOT: f64 = 1e-8;
const MOST_STEPS: usize = 60;

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
    /// In the active set as it was carried in.
    carried: bool,
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
    /// Directions the active lines span.
    rank: usize,
    /// The rank of an algebraic set is held while the set stays as it was carried in.
    held: usize,
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
            carried: false,
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
            rank: 3,
            held: 3,
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

    /// The rank to hold from here on: that of an algebraic set, 3 otherwise.
    #[must_use]
    pub fn rank(&self) -> usize {
        if self.spread == Spread::Algebraic {
            self.rank
        } else {
            3
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
            leg.push = law::Element::linear(leg.numbers).pull(leg.stretch, relative);
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
        let held = self.held < 3 && self.legs.iter().all(|leg| leg.active == leg.carried);
        if held && self.solve_spanned(&eigen(&d), &right, self.held) {
            return;
        }
        (self.spread, self.rank) = (Spread::Full, 3);
        if certainly_full(&d)
            && let Some(slip) = cholesky(&d, &right)
        {
            self.slip = slip;
            self.find_pulls();
            return;
        }
        let directions = eigen(&d);
        let limit = (directions[0].0 * T::from_f64(RANK)).max(T::zero());
        let rank = directions.iter().filter(|(value, _)| *value > limit);
        let rank = rank.count();
        self.solve_spanned(&directions, &right, rank);
    }

    /// Solves in the first `rank` directions; the others follow rule 3 or, if something pulls (`true`), rule 4.
    fn solve_spanned(
        &mut self,
        directions: &[(T, Vector3<T>); 3],
        right: &Vector3<T>,
        rank: usize,
    ) -> bool {
        self.slip = Vector3::zeros();
        for (value, vector) in directions.iter().take(rank) {
            let along = vector.dot(right) / *value;
            self.slip += vector.map(|x| along * x);
        }
        self.find_pulls();
        if rank == 3 {
            return false;
        }
        self.rank = rank;
        self.spread = Spread::Idle;
        let (weight, weighted) = self.carrying();
        if weight <= T::zero() {
            return false;
        }
        self.spread = Spread::Algebraic;
        for (_, vector) in directions.iter().skip(rank) {
            let along = vector.dot(&weighted) / weight;
            self.slip += vector.map(|x| along * x);
        }
        self.find_pulls();
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
        let settled = self.project_end();
        self.solve_frozen();
        let tolerated = self.scale() * T::from_f64(1e2 * DASHPOT).max(T::EPSILON.sqrt());
        settled && !self.legs.iter().any(|leg| leg.wants_change(tolerated))
    }

    /// The active set of the rate problem with a vanishing dashpot, Φ(w) + (ε/2)|w − v̄|²: strictly convex, so Newton with slope search finds
    /// its one minimum, and the lines that pull there are those of the limit ε → 0. Only the set is taken, never its forces.
    fn project_end(&mut self) -> bool {
        let zero = T::zero();
        let mut largest = zero;
        for leg in &self.legs {
            largest = largest.max(leg.numbers.damping);
        }
        let dashpot = T::from_f64(DASHPOT).max(T::EPSILON * T::from_f64(1e3)) * largest;
        let mut slip = Vector3::zeros();
        for _ in 0..MOST_STEPS {
            let (gradient, stiffness, scale) = self.dashed(&slip, dashpot);
            if gradient.dot(&gradient) <= scale * scale * T::EPSILON * T::EPSILON {
                break;
            }
            let Some(step) = cholesky(&stiffness, &-gradient) else {
                return false;
            };
            let start = gradient.dot(&step).abs();
            let (mut t, mut low, mut high) = (T::one(), zero, None);
            for _ in 0..MOST_STEPS {
                let slope = self
                    .dashed(&(slip + step.map(|x| t * x)), dashpot)
                    .0
                    .dot(&step);
                if slope.abs() <= T::from_f64(0.1) * start {
                    break;
                }
                if slope < zero {
                    low = t;
                } else {
                    high = Some(t);
                }
                t = high.map_or(t + t, |high| (low + high) * T::from_f64(0.5));
            }
            slip += step.map(|x| t * x);
        }
        self.slip = slip;
        self.find_pulls();
        for leg in &mut self.legs {
            leg.active = leg.taut && leg.pull > zero;
        }
        let (gradient, _, scale) = self.dashed(&slip, dashpot);
        let bound = scale * T::EPSILON * T::from_f64(1e4);
        gradient.dot(&gradient) <= bound * bound
    }

    /// Gradient, stiffness and scale of forces of the problem with a dashpot.
    fn dashed(&self, slip: &Vector3<T>, dashpot: T) -> (Vector3<T>, Matrix3<T>, T) {
        let mut gradient = slip.map(|x| dashpot * x) - self.load;
        let mut stiffness = Matrix3::from_diagonal_element(dashpot);
        let mut scale = T::zero();
        for leg in self.legs.iter().filter(|leg| leg.taut) {
            let c = leg.numbers.damping;
            let along = c * leg.direction.dot(slip);
            let pull = leg.push - along;
            scale = scale.max(leg.push.abs() + along.abs());
            if pull > T::zero() {
                gradient -= leg.direction.map(|u| pull * u);
                stiffness += (leg.direction * leg.direction.transpose()).map(|x| c * x);
            }
        }
        (gradient, stiffness, scale)
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
        self.scale() * T::EPSILON * T::from_f64(1e4)
    }

    /// The largest term of a pull [N].
    fn scale(&self) -> T {
        let mut scale = T::zero();
        for leg in self.legs.iter().filter(|leg| leg.taut) {
            let along = leg.direction.dot(&self.slip).abs();
            scale = scale.max(leg.push.abs() + leg.numbers.damping * along);
        }
        scale
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
        self.legs.iter().filter(move |leg| leg.pulls(rounding))
    }

    /// Where the node belongs by rule 4: its orthogonal projection on the line or the plane through the carrying anchors; `None` elsewhere.
    #[must_use]
    pub fn projected(&self) -> Option<Vector3<T>> {
        if self.spread != Spread::Algebraic {
            return None;
        }
        let rounding = self.rounding();
        let offset = self.to_hull(self.rank, |leg| leg.pulls(rounding));
        Some(self.position + offset)
    }

    /// Rule 5, the singular approach: independent taut lines without force whose node reaches the line or plane through their anchors within
    /// half a step `span` [s], still taut there. Its velocity grows without bound on the way, so it is put there, where the lines carry.
    /// The place [m], and the rank to hold from then on.
    #[must_use]
    pub fn crossing(&self, span: T) -> Option<(Vector3<T>, usize)> {
        let rounding = self.rounding();
        let idle = !self.legs.iter().any(|leg| leg.pulls(rounding));
        if !idle || span <= T::zero() || self.load != Vector3::zeros() {
            return None;
        }
        let mut d = Matrix3::zeros();
        for leg in self.legs.iter().filter(|leg| leg.active) {
            let c = leg.numbers.damping;
            d += (leg.direction * leg.direction.transpose()).map(|x| c * x);
        }
        let directions = eigen(&d);
        let limit = (directions[0].0 * T::from_f64(RANK)).max(T::zero());
        let rank = directions
            .iter()
            .filter(|(value, _)| *value > limit)
            .count();
        let weakest = rank.checked_sub(1).filter(|weakest| *weakest > 0)?;
        let offset = self.to_hull(weakest, |leg| leg.active);
        let there = self.position + offset;
        let stays_taut = |leg: &Leg<T>| {
            let geometry = law::geometry(&(leg.anchor - there), leg.numbers.free_length);
            geometry.stretch > T::zero()
        };
        if !self.legs.iter().filter(|leg| leg.active).all(stays_taut) {
            return None;
        }
        let speed = directions[weakest].1.dot(&self.slip) * span;
        let half = T::from_f64(0.25) * offset.dot(&offset);
        (speed * speed > half).then_some((there, weakest))
    }

    /// From the node to its projection on the line (`rank` 1) or plane (2) that fits the anchors of the chosen lines best.
    fn to_hull(&self, rank: usize, chosen: impl Fn(&Leg<T>) -> bool) -> Vector3<T> {
        let (mut count, mut center) = (T::zero(), Vector3::zeros());
        for leg in self.legs.iter().filter(|leg| chosen(leg)) {
            count += T::one();
            center += leg.anchor - self.position;
        }
        let center = center.map(|x| x / count.max(T::one()));
        let mut scatter = Matrix3::zeros();
        for leg in self.legs.iter().filter(|leg| chosen(leg)) {
            let arm = leg.anchor - self.position - center;
            scatter += arm * arm.transpose();
        }
        let mut offset = Vector3::zeros();
        for (_, axis) in eigen(&scatter).iter().skip(rank) {
            let out = axis.dot(&center);
            offset += axis.map(|x| out * x);
        }
        offset
    }

    /// Whether a load acts that the lines cannot balance: directions are missing and W does not vanish.
    #[must_use]
    pub fn unbalanced(&self) -> bool {
        self.spread != Spread::Full && self.load != Vector3::zeros()
    }
}

impl<T: Float> Leg<T> {
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

/// Solves D x = r by Cholesky; `None` if a pivot is not positive.
fn cholesky<T: Float>(d: &Matrix3<T>, right: &Vector3<T>) -> Option<Vector3<T>> {
    let l00 = d[(0, 0)].sqrt();
    let (l10, l20) = (d[(1, 0)] / l00, d[(2, 0)] / l00);
    let p1 = d[(1, 1)] - l10 * l10;
    let l11 = p1.sqrt();
    let l21 = (d[(2, 1)] - l20 * l10) / l11;
    let p2 = d[(2, 2)] - l20 * l20 - l21 * l21;
    if d[(0, 0)] <= T::zero() || p1 <= T::zero() || p2 <= T::zero() {
        return None;
    }
    let y0 = right.x / l00;
    let y1 = (right.y - l10 * y0) / l11;
    let z = (right.z - l20 * y0 - l21 * y1) / p2;
    let y = (y1 - l21 * z) / l11;
    let x = (y0 - l10 * y - l20 * z) / l00;
    Some(Vector3::new(x, y, z))
}

/// det D > 1e-5 (tr D)³: bounds λ_min/λ_max from below by 1e-5, without eigenvalues.
fn certainly_full<T: Float>(d: &Matrix3<T>) -> bool {
    let minor = |a: usize, b: usize| d[(1, a)] * d[(2, b)] - d[(1, b)] * d[(2, a)];
    let determinant = d[(0, 0)] * minor(1, 2) - d[(0, 1)] * minor(0, 2) + d[(0, 2)] * minor(0, 1);
    let trace = d[(0, 0)] + d[(1, 1)] + d[(2, 2)];
    determinant > T::from_f64(1e-5) * trace * trace * trace
}
