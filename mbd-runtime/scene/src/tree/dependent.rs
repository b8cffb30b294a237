//! Speeds that motors and couplings of the tree fix: they leave the system together with their rows.
//!
//! ```text
//! f_d u̇_d + Σ f_s u̇_s = γ      u̇_d = γ/f_d + Σ c_s u̇_s,   c_s = −f_s/f_d                                      (1)
//! u̇ = û + G w                   û: (1) with w = 0;   w: accelerations of the independent speeds                (2)
//! Gᵀ M G w − Gᵀ Φᵀ λ = Gᵀ (τ − h − M û),   Φ G w = γ − Φ û          Φ, λ: the rows that are left               (3)
//! f_d λ_d = (M u̇ + h − τ − Φᵀ λ)_d − Σ f λ of later rows of (1)                                                (4)
//! ```
//!
//! f are constant, so that (3) is the system of the independent speeds, as small as if the others had never been there; what a motor pushes with
//! is found by (4) where it is asked for. The dependent speed of a row is none that an earlier row names, so that substitution from the last row to
//! the first is G. Source: Featherstone, Rigid Body Dynamics Algorithms, §3.2 (implicit and explicit constraints), §9.2 (hybrid dynamics).

use crate::elimination::sparse_dot;
use crate::laws::evaluation::Evaluation;
use crate::vocabulary::MOST_COUPLED;
use crate::{Dependent, Elimination, Layout, Real};

/// Scratch of one scene. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub(super) struct DependentSpeeds<S> {
    /// û of (2), n_v numbers.
    pub rates: Vec<S>,
    /// What is known of each.
    known: Vec<DependentSpeed<S>>,
    /// Their rows of M as they were before (3), n_v numbers each.
    mass: Vec<S>,
    /// Their columns of all rows likewise, n_c numbers each.
    columns: Vec<S>,
    /// n_c.
    rows: usize,
}

/// What is known of one dependent speed.
#[derive(Clone, Copy, Debug)]
struct DependentSpeed<S> {
    /// 1/f_d.
    inverse: S,
    /// c_s, in the order of the sources.
    leads: [S; MOST_COUPLED - 1],
    /// Its element of τ − h − M û; then what is left of (4).
    left: S,
}

/// The sources of a dependent speed, each with its c.
fn led<'a, S: Real>(
    dependent: &'a Dependent,
    known: &DependentSpeed<S>,
) -> impl Iterator<Item = (usize, S)> + use<'a, S> {
    let speeds = dependent.sources.iter().map(|&(speed, _)| speed);
    speeds.zip(known.leads)
}

impl<S: Real> DependentSpeeds<S> {
    pub fn new(layout: &Layout) -> Self {
        let count = layout.elimination.dependents.len();
        let nothing = DependentSpeed {
            inverse: S::zero(),
            leads: [S::zero(); MOST_COUPLED - 1],
            left: S::zero(),
        };
        DependentSpeeds {
            rates: vec![S::zero(); layout.nv],
            known: vec![nothing; count],
            mass: vec![S::zero(); count * layout.nv],
            columns: vec![S::zero(); count * layout.nc],
            rows: layout.nc,
        }
    }

    /// The dependent speeds, the first of them first.
    fn each<'a>(
        &'a mut self,
        plan: &'a Elimination,
    ) -> impl DoubleEndedIterator<Item = (&'a Dependent, &'a mut DependentSpeed<S>)> {
        plan.dependents.iter().zip(&mut self.known)
    }

    /// Reads the factors of (1).
    pub fn read(&mut self, evaluation: &Evaluation<'_, S>) {
        let couplings = &evaluation.numbers.couplings;
        for (dependent, known) in self.each(&evaluation.layout.elimination) {
            let coupling = couplings.get(dependent.joint).and_then(Option::as_ref);
            let factor = |number| coupling.map_or(S::one(), |own| own.factor(number));
            known.inverse = S::one() / factor(dependent.number);
            for (lead, &(_, number)) in known.leads.iter_mut().zip(&dependent.sources) {
                *lead = -(factor(number) * known.inverse);
            }
        }
    }

    /// û of (2), for the γ of each row.
    pub fn prescribe(&mut self, plan: &Elimination, bias: &dyn Fn(usize) -> S) {
        let DependentSpeeds { rates, known, .. } = self;
        rates.fill(S::zero());
        for (dependent, known) in plan.dependents.iter().zip(known) {
            let own = bias(dependent.row) * known.inverse;
            let led = led(dependent, known);
            rates[dependent.speed] = led.fold(own, |sum, (speed, lead)| sum + lead * rates[speed]);
        }
    }

    /// Makes M and the rows those of the independent speeds, by (3).
    pub fn substitute(&mut self, plan: &Elimination, mass: &mut [S], lines: &mut [S]) {
        let (n, rows) = (self.rates.len(), self.rows);
        for (index, dependent) in plan.dependents.iter().enumerate() {
            let d = dependent.speed;
            self.mass[index * n..(index + 1) * n].copy_from_slice(&mass[d * n..(d + 1) * n]);
            let own = &mut self.columns[index * rows..(index + 1) * rows];
            for (slot, line) in own.iter_mut().zip(lines.chunks(n.max(1))) {
                *slot = line[d];
            }
        }
        for (dependent, known) in self.each(plan).rev() {
            let d = dependent.speed;
            for (s, lead) in led(dependent, known) {
                for row in mass.chunks_mut(n.max(1)).chain(lines.chunks_mut(n.max(1))) {
                    row[s] += lead * row[d];
                }
                for column in 0..n {
                    mass[s * n + column] += lead * mass[d * n + column];
                }
            }
        }
    }

    /// Makes right-hand sides those of the independent speeds.
    pub fn substitute_forces(&mut self, plan: &Elimination, forces: &mut [S]) {
        for (dependent, known) in self.each(plan) {
            known.left = forces[dependent.speed];
        }
        for (dependent, known) in self.each(plan).rev() {
            let own = forces[dependent.speed];
            for (speed, lead) in led(dependent, known) {
                forces[speed] += lead * own;
            }
        }
    }

    /// Takes M û off forces.
    pub fn take_inertia_off(&self, plan: &Elimination, forces: &mut [S]) {
        let n = self.rates.len();
        for (dependent, mass) in plan.dependents.iter().zip(self.mass.chunks(n.max(1))) {
            let rate = self.rates[dependent.speed];
            for (slot, &mass) in forces.iter_mut().zip(mass) {
                *slot -= mass * rate;
            }
        }
    }

    /// Φ û of a row that is left.
    pub fn along(&self, plan: &Elimination, row: usize) -> S {
        let columns = self.columns.chunks(self.rows.max(1));
        let terms = plan.dependents.iter().zip(columns);
        terms.fold(S::zero(), |sum, (dependent, column)| {
            sum + column[row] * self.rates[dependent.speed]
        })
    }

    /// Takes note of λ of a row that is left, for (4).
    pub fn note(&mut self, row: usize, multiplier: S) {
        let columns = self.columns.chunks(self.rows.max(1));
        for (known, column) in self.known.iter_mut().zip(columns) {
            known.left += column[row] * multiplier;
        }
    }

    /// u̇ from w, by (2), and λ of the rows that left, by (4).
    pub fn follow(&mut self, plan: &Elimination, rates: &mut [S], each: &mut dyn FnMut(usize, S)) {
        for (dependent, known) in self.each(plan) {
            let led = led(dependent, known);
            rates[dependent.speed] =
                led.fold(S::zero(), |sum, (speed, lead)| sum + lead * rates[speed]);
        }
        let n = self.rates.len();
        for (known, mass) in self.known.iter_mut().zip(self.mass.chunks(n.max(1))) {
            let moved = sparse_dot(mass, rates);
            known.left = moved - known.left;
        }
        for index in (0..self.known.len()).rev() {
            let (dependent, known) = (&plan.dependents[index], self.known[index]);
            each(dependent.row, known.left * known.inverse);
            // An earlier row names none of them, a source may be the dependent speed of one.
            for (speed, lead) in led(dependent, &known) {
                let earlier = plan.dependents[..index].iter().zip(&mut self.known);
                for (_, other) in earlier.filter(|(own, _)| own.speed == speed) {
                    other.left += lead * known.left;
                }
            }
        }
        for (rate, own) in rates.iter_mut().zip(&self.rates) {
            *rate += *own;
        }
    }

    /// The numbers that solutions by a factor need, in order.
    pub fn each_factored(&mut self, each: &mut dyn FnMut(&mut S)) {
        for known in &mut self.known {
            each(&mut known.inverse);
            known.leads.iter_mut().for_each(&mut *each);
        }
        self.mass.iter_mut().chain(&mut self.columns).for_each(each);
    }

    /// How many there are.
    pub fn factored_len(layout: &Layout) -> usize {
        layout.elimination.dependents.len() * (MOST_COUPLED + layout.nv + layout.nc)
    }
}
