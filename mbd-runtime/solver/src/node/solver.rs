//! The solver of equilibrium points: warm Newton, then stiffness homotopy, then slope search; never a force from an unsolved balance.
//!
//! ```text
//! balanced     |g| ≤ rel (ΣT + |W|) + abs Σ K (d + |p|₁)            relative, plus the rounding of the lengths
//! direction    (H + r 1) δ = −g,  r = 4.5 ε tr H, × 100 until every pivot is positive; by cofactors for one node with
//!              λ_min > 1e-5 λ_max
//! search       ψ(t) = g(p + t δ)·δ rises with t; accept |ψ(t)| ≤ |ψ(0)|/10, for more than one node also −9/10 |ψ(0)| ≤ ψ(t) ≤ 0
//! strategy 1       Newton from the given start, at most 12 steps; for more than one node up to 100, from the 13th on by slope search
//! strategy 2       from the stiffness-weighted mean of the anchors through K_max (K/K_max)^a, a = 1/8 … 1
//! strategy 3       slope search to a cap of 300, of 5000 for more than one node
//! ```
//!
//! Strategy 3 descends a convex function with Lipschitz gradient and compact level sets, so it converges from everywhere; the slope and not
//! the energy decides the step, because the energy cannot resolve the last digits. Plain Newton alone cycles (`tests/node_counterexamples.rs`).
//! A network begins far from its balance in some nodes and near it in most: a search from where Newton came to needs a third of the steps of a
//! homotopy, which gives all that up; and a step along which every slope falls lowers the energy, whatever is left of the slope.

use mbd_scene::Float;
use mbd_scene::laws::line;

use super::balance::{Balance, BalanceEvaluation, inner, norm};
use super::error::{NodeError, UNEVEN, Uneven};
use super::factor::BlockCholesky;
use super::scene::ENDLESS;
use super::warm::{Standing, Targets, direction_of_one, shift};

/// When a balance counts as solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance<T> {
    /// Residual over ΣT + |W|.
    pub relative: T,
    /// Residual over Σ K (d + |p|₁): the rounding floor of the lengths.
    pub absolute: T,
}

impl<T: Float> Tolerance<T> {
    /// For a problem of its own: 1e-10 and 1e-14, not below a few roundings of `T`.
    #[must_use]
    pub fn alone() -> Self {
        Tolerance::floored(1e-10, 1e-14)
    }

    /// Inside an integration step: 1e-12 and 1e-15, not below a few roundings of `T`.
    #[must_use]
    pub fn inside_step() -> Self {
        Tolerance::floored(1e-12, 1e-15)
    }

    /// What warm Newton is judged by with it.
    pub(crate) fn warm(self) -> Targets<T> {
        Limits::warm(self, 1).targets()
    }

    fn floored(relative: f64, absolute: f64) -> Self {
        let rounding = T::EPSILON.to_f64();
        Tolerance {
            relative: T::from_f64(relative.max(64.0 * rounding)),
            absolute: T::from_f64(absolute.max(4.0 * rounding)),
        }
    }
}

/// The strategy that found the balance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Strategy {
    /// Newton from the given start.
    #[default]
    Warm,
    /// Stiffness homotopy.
    Homotopy,
    /// Slope search.
    Search,
}

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome<T> {
    /// The lines balance and at least one pulls, or a load acts.
    Taut {
        /// Newton steps in all strategies.
        iterations: usize,
        /// |g| at the end [N].
        residual: T,
        /// The strategy that found it.
        strategy: Strategy,
    },
    /// Nothing pulls: zero force, zero stiffness; the node is one of many.
    Slack {
        /// Newton steps in all strategies.
        iterations: usize,
    },
    /// No balance was found: no force may be taken from it.
    NotConverged {
        /// The smallest |g| seen [N].
        residual: T,
        /// Newton steps in all strategies.
        iterations: usize,
    },
}

impl<T: Float> Outcome<T> {
    /// The error of a solve that found no balance, at the first `node` of its network, with the lines that are `uneven`.
    ///
    /// # Errors
    /// [`NodeError::NotConverged`].
    pub fn check(
        &self,
        node: Option<usize>,
        uneven: impl FnOnce() -> Option<Uneven>,
    ) -> Result<(), NodeError> {
        match *self {
            Outcome::NotConverged {
                residual,
                iterations,
            } => Err(NodeError::NotConverged {
                node: node.unwrap_or_default(),
                residual_n: residual.to_f64(),
                iterations,
                uneven: uneven(),
            }),
            Outcome::Taut { .. } | Outcome::Slack { .. } => Ok(()),
        }
    }

    /// Newton steps in all strategies.
    #[must_use]
    pub fn iterations(&self) -> usize {
        match self {
            Outcome::Taut { iterations, .. }
            | Outcome::Slack { iterations }
            | Outcome::NotConverged { iterations, .. } => *iterations,
        }
    }
}

/// The fallback chain of a network, with room for one pattern of coupled nodes. Holds no memory of earlier solves.
#[derive(Clone, Debug)]
pub struct Solver<T> {
    descent: Descent<T>,
    stiffness: Vec<T>,
    eighth: Vec<T>,
    zero: Vec<T>,
}

/// Newton's method with its scratch; `p` is the current point.
#[derive(Clone, Debug)]
struct Descent<T> {
    factor: BlockCholesky<T, 3>,
    here: BalanceEvaluation<T>,
    there: BalanceEvaluation<T>,
    p: Vec<T>,
    best: Vec<T>,
    delta: Vec<T>,
    trial: Vec<T>,
    taken: usize,
    smallest: T,
}

/// How one descent ended.
enum DescentEnd<T> {
    Balanced(T),
    Slack,
    Stopped,
}

/// The limits of one descent.
#[derive(Clone, Copy)]
struct Limits<T> {
    balanced: Tolerance<T>,
    /// ΣT below this part of the floor is slack.
    slack: T,
    /// Plain Newton steps before the search begins.
    plain: usize,
    cap: usize,
}

pub(crate) const WARM_STEPS: usize = 12;
/// With the steps by search that follow where there is more than one node.
const NETWORK_WARM_CAP: usize = 100;
const HOMOTOPY_STAGES: usize = 8;
const HOMOTOPY_PLAIN: usize = 15;
const HOMOTOPY_CAP: usize = 40;
const SEARCH_CAP: usize = 300;
/// Stiff lines in series with soft ones make a valley along which the search of a network creeps.
const NETWORK_SEARCH_CAP: usize = 5000;
const SEARCH_EVALUATIONS: usize = 40;

impl<T: Float> Solver<T> {
    /// A solver for `nodes` nodes and `lines` lines; `blocks` are the structural non-zero blocks of H (row ≥ column, local indices).
    #[must_use]
    pub fn new(nodes: usize, lines: usize, blocks: &[(usize, usize)]) -> Self {
        let list = |n: usize| vec![T::zero(); n];
        Solver {
            descent: Descent {
                factor: BlockCholesky::new(nodes, blocks),
                here: BalanceEvaluation::new(nodes, blocks.len()),
                there: BalanceEvaluation::new(nodes, blocks.len()),
                p: list(3 * nodes),
                best: list(3 * nodes),
                delta: list(3 * nodes),
                trial: list(3 * nodes),
                taken: 0,
                smallest: T::zero(),
            },
            stiffness: list(lines),
            eighth: list(lines),
            zero: list(lines),
        }
    }

    /// The evaluation at the last point of the last solve.
    #[must_use]
    pub fn evaluation(&self) -> &BalanceEvaluation<T> {
        &self.descent.here
    }

    /// Room for an evaluation that is to be that of the last solve.
    pub(super) fn evaluation_mut(&mut self) -> &mut BalanceEvaluation<T> {
        &mut self.descent.here
    }

    /// Solves g(p) = 0 from `p` with stiffness `k` > 0 [N/m] and free length `l` ≥ 0 [m]; `p` holds the balance if one was found and is
    /// unchanged otherwise. At most 12 + 8·40 + 300 Newton steps, with 100 for the 12 and 5000 for the 300 where there is more than one node.
    pub fn solve<B: Balance<T>>(
        &mut self,
        balance: &mut B,
        k: &[T],
        l: &[T],
        p: &mut [T],
        tolerance: Tolerance<T>,
    ) -> Outcome<T> {
        self.descent.begin(p);
        let (strategy, verdict) = self.escalate(balance, k, l, tolerance);
        self.descent.end(strategy, verdict, p)
    }

    /// Slope search alone, from `p`: strategy 3 as a solver of its own, to compare the strategies.
    pub fn search<B: Balance<T>>(
        &mut self,
        balance: &mut B,
        k: &[T],
        l: &[T],
        p: &mut [T],
        tolerance: Tolerance<T>,
    ) -> Outcome<T> {
        self.descent.begin(p);
        let limits = Limits::search(tolerance, balance.nodes());
        let verdict = self.descent.newton(balance, k, l, limits);
        self.descent.end(Strategy::Search, verdict, p)
    }

    /// After a solve that found no balance: the softest and the stiffest line taut at the best point seen, by their places in `k`, where they
    /// are further apart than [`UNEVEN`].
    pub fn uneven<B: Balance<T>>(&self, balance: &B, k: &[T], l: &[T]) -> Option<Uneven> {
        let mut pair: Option<[(usize, T); 2]> = None;
        for (index, (&k, &l)) in k.iter().zip(l).enumerate() {
            let [from, to] = balance.places(index, &self.descent.p);
            if line::geometry(&(to - from), l).stretch <= T::zero() {
                continue;
            }
            let [soft, stiff] = pair.get_or_insert([(index, k); 2]);
            if k < soft.1 {
                *soft = (index, k);
            }
            if k > stiff.1 {
                *stiff = (index, k);
            }
        }
        let [(softest, soft), (stiffest, stiff)] = pair?;
        let ratio = (stiff / soft).to_f64();
        (ratio > UNEVEN).then_some(Uneven {
            softest,
            stiffest,
            ratio,
        })
    }

    fn escalate<B: Balance<T>>(
        &mut self,
        balance: &mut B,
        k: &[T],
        l: &[T],
        tolerance: Tolerance<T>,
    ) -> (Strategy, DescentEnd<T>) {
        let limits = Limits::warm(tolerance, balance.nodes());
        let warm = self.descent.newton(balance, k, l, limits);
        if !matches!(warm, DescentEnd::Stopped) {
            return (Strategy::Warm, warm);
        }
        let homotopy = self.homotopy(balance, k, l, tolerance);
        if !matches!(homotopy, DescentEnd::Stopped) {
            return (Strategy::Homotopy, homotopy);
        }
        let limits = Limits::search(tolerance, balance.nodes());
        let search = self.descent.newton(balance, k, l, limits);
        (Strategy::Search, search)
    }

    /// Strategy 2: equal stiffnesses first, where the problem is well conditioned, then step by step the true ones.
    fn homotopy<B: Balance<T>>(
        &mut self,
        balance: &mut B,
        k: &[T],
        l: &[T],
        tolerance: Tolerance<T>,
    ) -> DescentEnd<T> {
        let largest = largest(k);
        self.descent.go_to_centroid(balance, k, &self.zero);
        for (eighth, &k) in self.eighth.iter_mut().zip(k) {
            *eighth = (k / largest).sqrt().sqrt().sqrt();
        }
        for stiffness in &mut self.stiffness {
            *stiffness = largest;
        }
        for stage in 1..=HOMOTOPY_STAGES {
            let last = stage == HOMOTOPY_STAGES;
            for (stiffness, &factor) in self.stiffness.iter_mut().zip(&self.eighth) {
                *stiffness *= factor;
            }
            let stiffness = if last { k } else { &self.stiffness };
            let limits = Limits::homotopy(tolerance, last);
            let verdict = self.descent.newton(balance, stiffness, l, limits);
            if last || matches!(verdict, DescentEnd::Slack) {
                return verdict;
            }
        }
        DescentEnd::Stopped
    }
}

impl<T: Float> Limits<T> {
    /// So many plain steps of so many in all.
    fn steps(balanced: Tolerance<T>, plain: usize, cap: usize) -> Self {
        Limits {
            balanced,
            slack: balanced.absolute,
            plain,
            cap,
        }
    }

    /// What a descent is judged by.
    fn targets(&self) -> Targets<T> {
        Targets {
            relative: self.balanced.relative,
            absolute: self.balanced.absolute,
            slack: self.slack,
        }
    }

    /// Newton from the given start; a search follows where there is more than one node.
    fn warm(balanced: Tolerance<T>, nodes: usize) -> Self {
        let cap = match nodes {
            0 | 1 => WARM_STEPS,
            _ => NETWORK_WARM_CAP,
        };
        Limits::steps(balanced, WARM_STEPS, cap)
    }

    fn search(balanced: Tolerance<T>, nodes: usize) -> Self {
        let cap = match nodes {
            0 | 1 => SEARCH_CAP,
            _ => NETWORK_SEARCH_CAP,
        };
        Limits::steps(balanced, 0, cap)
    }

    fn homotopy(target: Tolerance<T>, last: bool) -> Self {
        let loose = Tolerance {
            relative: T::from_f64(1e-4),
            absolute: T::from_f64(1e-10).max(target.absolute),
        };
        Limits {
            balanced: if last { target } else { loose },
            ..Limits::steps(target, HOMOTOPY_PLAIN, HOMOTOPY_CAP)
        }
    }
}

impl<T: Float> Descent<T> {
    fn begin(&mut self, p: &[T]) {
        self.p.copy_from_slice(p);
        self.taken = 0;
        self.smallest = T::from_f64(f64::MAX);
    }

    /// The outcome of a solve; `p` follows if a balance was found.
    fn end(&self, strategy: Strategy, verdict: DescentEnd<T>, p: &mut [T]) -> Outcome<T> {
        let iterations = self.taken;
        match verdict {
            DescentEnd::Stopped => Outcome::NotConverged {
                residual: self.smallest,
                iterations,
            },
            DescentEnd::Slack => {
                p.copy_from_slice(&self.p);
                Outcome::Slack { iterations }
            }
            DescentEnd::Balanced(residual) => {
                p.copy_from_slice(&self.p);
                Outcome::Taut {
                    iterations,
                    residual,
                    strategy,
                }
            }
        }
    }

    /// `plain` Newton steps, then steps by search from the point with the smallest residual, `cap` in all.
    fn newton<B: Balance<T>>(
        &mut self,
        balance: &mut B,
        k: &[T],
        l: &[T],
        limits: Limits<T>,
    ) -> DescentEnd<T> {
        let load = norm(balance.load());
        let mut smallest = None;
        let mut searching = limits.plain == 0;
        for step in 0..=limits.cap {
            balance.evaluate(&self.p, k, l, &mut self.here);
            let residual = match self.judge(load, limits) {
                Ok(residual) => residual,
                Err(verdict) => return verdict,
            };
            if residual.is_finite() && smallest.is_none_or(|least| residual < least) {
                smallest = Some(residual);
                self.best.copy_from_slice(&self.p);
            }
            if step == limits.cap || smallest.is_none() {
                break;
            }
            if !searching && (step >= limits.plain || !residual.is_finite()) {
                searching = true;
                self.p.copy_from_slice(&self.best);
                balance.evaluate(&self.p, k, l, &mut self.here);
            }
            let Some(must_search) = self.direction(balance, l) else {
                break;
            };
            self.taken += 1;
            let t = if searching || must_search {
                self.search(balance, k, l)
            } else {
                T::one()
            };
            for (p, &delta) in self.p.iter_mut().zip(&self.delta) {
                *p += t * delta;
            }
        }
        if let Some(smallest) = smallest {
            self.smallest = self.smallest.min(smallest);
            self.p.copy_from_slice(&self.best);
        }
        DescentEnd::Stopped
    }

    /// Moves to the point where the lines with free length zero balance without load: the mean of the anchors weighted by stiffness.
    fn go_to_centroid<B: Balance<T>>(&mut self, balance: &mut B, k: &[T], zero: &[T]) {
        balance.evaluate(&self.p, k, zero, &mut self.here);
        let here = &self.here;
        let mut trace = T::zero();
        for (index, &(row, column)) in self.factor.pattern().iter().enumerate() {
            if row == column {
                trace += here.block(index)[0][0];
            }
        }
        for ((delta, &g), &w) in self
            .delta
            .iter_mut()
            .zip(here.gradient())
            .zip(balance.load())
        {
            *delta = -(g + w);
        }
        if trace > T::zero() && self.factor.factor(T::EPSILON * trace, |k| here.block(k)) {
            self.factor.solve(&mut self.delta);
            for (p, &delta) in self.p.iter_mut().zip(&self.delta) {
                *p += delta;
            }
        }
    }

    /// The residual |g|, or the end of the descent.
    fn judge(&self, load: T, limits: Limits<T>) -> Result<T, DescentEnd<T>> {
        let residual = norm(self.here.gradient());
        let standing = limits.targets().judge(&self.here.pulls(), residual, load);
        match standing {
            Standing { slack: true, .. } => Err(DescentEnd::Slack),
            Standing { balanced: true, .. } => Err(DescentEnd::Balanced(residual)),
            _ => Ok(residual),
        }
    }

    /// The Newton direction δ of one node where H is certainly regular, as it is at almost every step.
    fn direction_of_one(&mut self) -> bool {
        let found = self.here.of_one();
        let Some((delta, true)) = found.map(|here| direction_of_one(&here, T::EPSILON)) else {
            return false;
        };
        self.delta.copy_from_slice(delta.as_slice());
        true
    }

    /// The Newton direction δ. `Some(true)`: a loaded node without a taut line moves along its load, and the step must be searched.
    fn direction<B: Balance<T>>(&mut self, balance: &B, l: &[T]) -> Option<bool> {
        if self.direction_of_one() {
            return Some(false);
        }
        let (nodes, here) = (balance.nodes(), &self.here);
        let diagonal = |node: usize| {
            let block = here.block(node);
            block[0][0] + block[1][1] + block[2][2]
        };
        let mut trace = T::zero();
        for node in 0..nodes {
            trace += diagonal(node);
        }
        for (delta, &g) in self.delta.iter_mut().zip(here.gradient()) {
            *delta = -g;
        }
        if !trace.is_finite() {
            return None;
        }
        if trace > T::zero() {
            let mut shift = shift(trace, T::EPSILON);
            while !self.factor.factor(shift, |k| here.block(k)) {
                shift *= T::from_f64(100.0);
                if shift > trace * T::from_f64(1e3) {
                    return None;
                }
            }
            self.factor.solve(&mut self.delta);
        }
        let mut must_search = false;
        for node in 0..nodes {
            if diagonal(node) > T::zero() {
                continue;
            }
            let load = balance.load().get(3 * node..3 * node + 3).unwrap_or(&[]);
            let size = norm(load);
            let reach = if size > T::zero() {
                must_search = true;
                reach(balance, &self.p, l) / size
            } else {
                T::zero()
            };
            for (delta, &w) in self.delta[3 * node..].iter_mut().zip(load) {
                *delta = w * reach;
            }
        }
        norm(&self.delta).is_finite().then_some(must_search)
    }

    /// A step length t at which the slope g(p + t δ)·δ has fallen to a tenth; of several nodes, to nine tenths where it has not changed its sign.
    fn search<B: Balance<T>>(&mut self, balance: &mut B, k: &[T], l: &[T]) -> T {
        let start = inner(self.here.gradient(), &self.delta).abs();
        let (mut t, mut low, mut high) = (T::one(), T::zero(), None);
        let (tenth, half, four) = (T::from_f64(0.1), T::from_f64(0.5), T::from_f64(4.0));
        let left = match balance.nodes() {
            0 | 1 => tenth,
            _ => T::from_f64(0.9),
        };
        for _ in 0..SEARCH_EVALUATIONS {
            for ((x, &p), &delta) in self.trial.iter_mut().zip(&self.p).zip(&self.delta) {
                *x = p + t * delta;
            }
            balance.evaluate(&self.trial, k, l, &mut self.there);
            let slope = inner(self.there.gradient(), &self.delta);
            if slope <= tenth * start && slope >= -left * start {
                break;
            }
            if slope < T::zero() {
                low = t;
            } else {
                high = Some(t);
            }
            let next = t - slope / self.curvature();
            t = match high {
                None if next > low && next <= four * t => next,
                None => four * t,
                Some(high) if next > low && next < high => next,
                Some(high) => half * (low + high),
            };
        }
        t
    }

    /// δᵀ H δ at the trial point.
    fn curvature(&self) -> T {
        let mut sum = T::zero();
        for (k, &(row, column)) in self.factor.pattern().iter().enumerate() {
            let (a, b) = (&self.delta[3 * row..], &self.delta[3 * column..]);
            let mut term = T::zero();
            for (values, &x) in self.there.block(k).iter().zip(a) {
                term += x * inner(values, b);
            }
            sum += if row == column { term } else { term + term };
        }
        sum
    }
}

/// How far a node without a taut line is sent along its load [m].
fn reach<T: Float, B: Balance<T>>(balance: &B, p: &[T], l: &[T]) -> T {
    balance
        .smallest_slack(p, l)
        .max(T::from_f64(1e-3) * longest(l))
}

fn largest<T: Float>(list: &[T]) -> T {
    list.iter().fold(T::zero(), |most, &x| most.max(x))
}

/// The longest free length of a line that is there.
fn longest<T: Float>(list: &[T]) -> T {
    let there = list.iter().filter(|l| **l < T::from_f64(ENDLESS));
    there.fold(T::zero(), |most, &l| most.max(l))
}
