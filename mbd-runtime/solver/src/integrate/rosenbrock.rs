//! Rosenbrock methods: implicit in the Jacobian alone, so that a step is a fixed number of linear solves.
//!
//! ```text
//! (1/(hγ) − A) U_i = f(t + α_i h, x + Σ_j a_ij U_j) + Σ_j c_ij/h U_j + h γ_i ∂f/∂t            A = ∂f/∂x at the start       (1)
//! x⁺ = x + Σ_j m_j U_j,   m = a_S + e_S,   x⁺ − x̂ = U_S                                     stiffly accurate              (2)
//! x(t + θh) = x + Σ_j θ (m_j + (1 − θ)(d_1j + θ (d_2j + θ d_3j))) U_j                                                        (3)
//! ```
//!
//! (1) is the form without products by A. That of the theory, k_i = h f(x + Σ α_ij k_j) + h A Σ β'_ij k_j, has Γ⁻¹ = diag(1/γ) − c, α = a Γ,
//! b = m Γ. [`RosenbrockTableau::checked`] goes back to it and tests the conditions of [`trees`](super::trees) with β = α + Γ, in a `const fn`.
//!
//! The order asks for the exact A of f as the stages evaluate it, off unit quaternions too, where equations of motion say nothing that is worth
//! differentiating. So f is that of the unit quaternions, q̇ apart, which is linear in q: A gets the projection 1 − q qᵀ behind it.
//!
//! Source: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.7.

use mbd_scene::{Float, Real};

use super::Rates;
use super::shifted::{Attached, Shifted};
use super::stiffness_test::fastest;
use super::trees::{Weights, same, weighted};
use crate::error::StepError;

/// A stiffly accurate Rosenbrock method with S stages and an interpolant of degree D + 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RosenbrockTableau<const S: usize, const D: usize> {
    /// γ.
    pub gamma: f64,
    /// a_ij, j < i.
    pub a: [[f64; S]; S],
    /// c_ij, j < i.
    pub c: [[f64; S]; S],
    /// α_i.
    pub times: [f64; S],
    /// γ_i.
    pub by_time: [f64; S],
    /// d_1, d_2, ….
    pub dense: [[f64; S]; D],
    /// Order of the step.
    pub order: usize,
    /// Order of the embedded step.
    pub embedded: usize,
    /// Order of the interpolant: its error at a fixed θ is O(h^(dense_order + 1)).
    pub dense_order: usize,
}

impl<const S: usize, const D: usize> RosenbrockTableau<S, D> {
    /// The same tableau, after checking that stages use earlier ones, that their sums are α_i and γ_i, that step and embedded step are stages of the
    /// method, and that these and the interpolant have the orders they claim. A violation stops the build.
    pub(crate) const fn checked(self) -> Self {
        let mut inverse = [[0.0; S]; S];
        let mut i = 0;
        while i < S {
            let mut j = 0;
            while j < S {
                if j >= i {
                    assert!(
                        self.a[i][j] == 0.0 && self.c[i][j] == 0.0,
                        "a stage uses earlier stages only"
                    );
                }
                inverse[i][j] = -self.c[i][j];
                j += 1;
            }
            inverse[i][i] = 1.0 / self.gamma;
            i += 1;
        }
        let gamma = inverted(&inverse);
        let alpha = product(&self.a, &gamma);
        let mut beta = alpha;
        let mut i = 0;
        while i < S {
            let (sum, size) = weighted(&alpha[i], &[1.0; S]);
            assert!(same(sum, self.times[i], size), "a row does not sum to α_i");
            let (sum, size) = weighted(&gamma[i], &[1.0; S]);
            assert!(
                same(sum, self.by_time[i], size),
                "a row does not sum to γ_i"
            );
            let mut j = 0;
            while j < S {
                beta[i][j] += gamma[i][j];
                j += 1;
            }
            i += 1;
        }
        let weights = Weights::new(&alpha, &beta);
        let rows = product(&[self.end(), self.a[S - 1]], &gamma);
        let mut j = 0;
        while j < S {
            assert!(
                same(rows[0][j], beta[S - 1][j], beta[S - 1][j].abs())
                    && same(rows[1][j], beta[S - 2][j], beta[S - 2][j].abs()),
                "the step and its embedded step are the last stages"
            );
            j += 1;
        }
        assert!(
            weights.step(&rows[0], self.order),
            "the step misses an order condition"
        );
        assert!(
            weights.step(&rows[1], self.embedded),
            "the embedded step misses an order condition"
        );
        // θ (m + (1 − θ)(d_1 + θ (d_2 + …))) by powers of θ; trees never look beyond the seventh.
        assert!(D < POWERS, "an interpolant of a low degree");
        let mut powers = [[0.0; POWERS]; S];
        let dense = product(&self.dense, &gamma);
        let mut j = 0;
        while j < S {
            powers[j][0] = rows[0][j];
            let mut p = 0;
            while p < D {
                powers[j][p] += dense[p][j];
                powers[j][p + 1] -= dense[p][j];
                p += 1;
            }
            j += 1;
        }
        assert!(
            weights.inside(&powers, self.dense_order),
            "the interpolant misses an order condition"
        );
        self
    }

    /// m.
    const fn end(&self) -> [f64; S] {
        let mut end = self.a[S - 1];
        end[S - 1] = 1.0;
        end
    }
}

/// A step on ẏ = −y that is small, and not so small that its error is one of rounding.
const SMALL: f64 = 0.1;
/// The most powers of θ in an interpolant.
const POWERS: usize = 5;
/// The most stages of a method.
const MOST_STAGES: usize = 8;

/// The inverse of a lower triangular matrix.
const fn inverted<const S: usize>(lower: &[[f64; S]; S]) -> [[f64; S]; S] {
    let mut found = [[0.0; S]; S];
    let mut j = 0;
    while j < S {
        let mut i = j;
        while i < S {
            let mut sum = if i == j { 1.0 } else { 0.0 };
            let mut k = j;
            while k < i {
                sum -= lower[i][k] * found[k][j];
                k += 1;
            }
            found[i][j] = sum / lower[i][i];
            i += 1;
        }
        j += 1;
    }
    found
}

/// The product of matrices.
const fn product<const R: usize, const S: usize>(
    left: &[[f64; S]; R],
    right: &[[f64; S]; S],
) -> [[f64; S]; R] {
    let mut found = [[0.0; S]; R];
    let mut i = 0;
    while i < R {
        let mut j = 0;
        while j < S {
            let mut k = 0;
            while k < S {
                found[i][j] += left[i][k] * right[k][j];
                k += 1;
            }
            j += 1;
        }
        i += 1;
    }
    found
}

/// Whether derivatives are known at the start of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Known {
    /// They are not.
    No,
    /// They were found beside those of other runs, and are counted.
    Elsewhere,
    /// They are.
    Yes,
}

/// What a step that was made elsewhere counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StiffCount {
    /// Derivatives that were not known yet.
    pub jacobian: bool,
    /// A factor.
    pub factor: bool,
    /// Rates.
    pub rates: usize,
}

/// A method with the storage of its stages.
#[derive(Clone, Debug)]
pub(crate) struct Rosenbrock<T> {
    length: usize,
    gamma: f64,
    /// Per stage α_i, γ_i, a_ij and c_ij.
    rows: Vec<([f64; 2], [Vec<T>; 2])>,
    /// m, then d_1, d_2, …, of which the interpolant is made.
    inside: Vec<Vec<T>>,
    /// Order of the error estimate plus one.
    pub exponent: f64,
    matrix: Shifted<T>,
    by_state: Vec<T>,
    by_time: Vec<T>,
    /// Whether the derivatives are those at the start of the step.
    known: Known,
    /// The shift of the last factor that was made of them, wherever.
    factored: Option<T>,
    /// U_i, one after the other.
    stages: Vec<T>,
    /// Σ m_j U_j, then Σ d_1j U_j, …, one after the other.
    sums: Vec<T>,
    /// The size of the step that they are of [s]; no number where they are of none from the accepted state.
    made: f64,
    first: Vec<T>,
    last: Vec<T>,
    trial: Vec<T>,
    room: Vec<T>,
    next: Vec<T>,
}

impl<T: Real> Rosenbrock<T> {
    /// Storage for states of a given length, the first of whose numbers are attached to others, and of whose last nothing depends on `behind`.
    pub(crate) fn new<const S: usize, const D: usize>(
        tableau: &RosenbrockTableau<S, D>,
        length: usize,
        attached: Vec<Attached>,
        behind: usize,
    ) -> Self {
        const { assert!(S <= MOST_STAGES, "a stage has a weight") };
        let list = |row: &[f64]| -> Vec<T> { row.iter().map(|x| T::from_f64(*x)).collect() };
        let row = |i: usize| {
            let times = [tableau.times[i], tableau.by_time[i]];
            (times, [list(&tableau.a[i][..i]), list(&tableau.c[i][..i])])
        };
        let inside = std::iter::once(list(&tableau.end()));
        let room = || vec![T::zero(); length];
        Rosenbrock {
            length,
            gamma: tableau.gamma,
            rows: (0..S).map(row).collect(),
            inside: inside
                .chain(tableau.dense.iter().map(|row| list(row)))
                .collect(),
            exponent: (tableau.embedded + 1) as f64,
            matrix: Shifted::new(length, attached, behind),
            by_state: vec![T::zero(); length * length],
            by_time: room(),
            known: Known::No,
            factored: None,
            stages: vec![T::zero(); S * length],
            sums: vec![T::zero(); (D + 1) * length],
            made: f64::NAN,
            first: room(),
            last: room(),
            trial: room(),
            room: room(),
            next: room(),
        }
    }

    /// A at the start of a step, to be written; the rest of it is [`Rosenbrock::take_slopes`].
    pub(crate) fn slopes_mut(&mut self) -> &mut [T] {
        &mut self.by_state
    }

    /// Takes up A of rates that say nothing of time, as it was written.
    pub(crate) fn take_slopes(&mut self, state: &[T]) {
        self.matrix.along_units(state, &mut self.by_state);
        self.matrix.forget();
    }

    /// The stages of a step by (1), and the state at its end by (2): the time `from` and the step `over` are in a scalar of their own, which `number` makes one
    /// of the state; `rates` is told when a stage is and how long after the start of the step, and writes the rates at its state.
    ///
    /// # Errors
    /// The first of `rates`.
    pub(crate) fn stages<C: Real, E>(
        &mut self,
        [from, over]: [C; 2],
        number: impl Fn(C) -> T,
        state: &[T],
        mut rates: impl FnMut([C; 2], &[T], &mut [T]) -> Result<(), E>,
    ) -> Result<(), E> {
        let rate = number(C::one() / over);
        for (i, ([c, d], [a, terms])) in self.rows.iter().enumerate() {
            let (done, rest) = self.stages.split_at_mut(i * self.length);
            let (stage, _) = rest.split_at_mut(self.length);
            if i == 0 {
                stage.copy_from_slice(&self.first);
            } else {
                self.trial.copy_from_slice(state);
                add(a, done, &mut self.trial);
                let span = C::from_f64(*c) * over;
                self.matrix.shorten(&mut self.trial);
                rates([from + span, span], &self.trial, stage)?;
                self.matrix.lengthen(stage);
            }
            let mut weights = [T::zero(); MOST_STAGES];
            for (weight, term) in weights.iter_mut().zip(terms) {
                *weight = *term * rate;
            }
            add(&weights[..i], done, stage);
            let weight = number(C::from_f64(*d) * over);
            for (sum, slope) in stage.iter_mut().zip(&self.by_time) {
                *sum += weight * *slope;
            }
            self.matrix.solve(&self.by_state, stage);
        }
        self.sums.fill(T::zero());
        let sums = self.sums.chunks_exact_mut(self.length.max(1));
        for (weights, sum) in self.inside.iter().zip(sums) {
            add(weights, &self.stages, sum);
        }
        let moved = state.iter().zip(&self.sums);
        for (next, (x, change)) in self.next.iter_mut().zip(moved) {
            *next = *x + *change;
        }
        Ok(())
    }

    /// 1/(hγ) of a step.
    fn shift<C: Real>(&self, step: C) -> C {
        C::one() / (C::from_f64(self.gamma) * step)
    }

    /// Factors the matrix of a step of size h, unless that is done.
    pub(crate) fn factor<C: Real>(&mut self, step: C, number: impl Fn(C) -> T) -> T {
        let shift = number(self.shift(step));
        self.matrix.factor(shift, &self.by_state);
        shift
    }

    /// The state at the end of the last attempt.
    pub(crate) fn next(&self) -> &[T] {
        &self.next
    }

    /// The same to be put back on its manifold, and the rates there, which are to be written.
    pub(crate) fn end_mut(&mut self) -> [&mut [T]; 2] {
        [&mut self.next, &mut self.last]
    }

    /// The rates at the start of the step, to be changed.
    pub(crate) fn first_mut(&mut self) -> &mut [T] {
        &mut self.first
    }

    /// The rates at the start of the step.
    pub(crate) fn first(&self) -> &[T] {
        &self.first
    }

    /// U_S, Σ m_j U_j and the like, rates and state at the end of the last attempt.
    pub(crate) fn attempted(&self) -> [&[T]; 4] {
        [self.error(), &self.sums, &self.last, &self.next]
    }

    /// The estimate of the error of the last attempt.
    fn error(&self) -> &[T] {
        let last = self.stages.len() - self.length;
        self.stages.get(last..).unwrap_or_default()
    }

    /// Takes the last attempt where a mask says so.
    pub(crate) fn accept_where(&mut self, mask: T::Mask, state: &mut [T]) {
        let lists = [(state, &self.next), (&mut self.first[..], &self.last)];
        for (own, end) in lists {
            for (x, end) in own.iter_mut().zip(end) {
                *x = T::select(mask, *end, *x);
            }
        }
    }
}

impl<T: Float> Rosenbrock<T> {
    /// The same method over another scalar, with room of its own.
    pub(crate) fn over<S: Real>(&self) -> Rosenbrock<S> {
        let number = |x: &T| S::from_f64(x.to_f64());
        let list = |list: &Vec<T>| -> Vec<S> { list.iter().map(number).collect() };
        let room = |list: &Vec<T>| vec![S::zero(); list.len()];
        let row = |(times, [a, c]): &([f64; 2], [Vec<T>; 2])| (*times, [list(a), list(c)]);
        Rosenbrock {
            length: self.length,
            gamma: self.gamma,
            rows: self.rows.iter().map(row).collect(),
            inside: self.inside.iter().map(list).collect(),
            exponent: self.exponent,
            matrix: self.matrix.over(),
            by_state: room(&self.by_state),
            by_time: room(&self.by_time),
            known: Known::No,
            factored: None,
            stages: room(&self.stages),
            sums: room(&self.sums),
            made: f64::NAN,
            first: room(&self.first),
            last: room(&self.last),
            trial: room(&self.trial),
            room: room(&self.room),
            next: room(&self.next),
        }
    }

    /// Takes over an attempt of a size that was made elsewhere from the derivatives at the accepted state: `fill` writes what
    /// [`Rosenbrock::attempted`] is there. What it counts, as if it had been made here.
    pub(crate) fn receive(&mut self, step: f64, fill: impl FnOnce([&mut [T]; 4])) -> StiffCount {
        let jacobian = self.known == Known::No;
        if jacobian {
            (self.known, self.factored) = (Known::Elsewhere, None);
        }
        let shift = Some(T::from_f64(self.shift(step)));
        let factor = self.factored != shift;
        (self.factored, self.made) = (shift, step);
        let last = self.stages.len() - self.length;
        let error = self.stages.get_mut(last..).unwrap_or_default();
        fill([error, &mut self.sums, &mut self.last, &mut self.next]);
        StiffCount {
            jacobian,
            factor,
            rates: self.rows.len(),
        }
    }

    /// The rates at the start of a step, `span` after the last accepted one. Needed once, and again after anything jumped.
    pub(crate) fn begin(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        span: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        (self.known, self.made) = (Known::No, f64::NAN);
        system.rates(time, span, state, &mut self.first)
    }

    /// Takes up the rates at the start of a step from another method.
    pub(crate) fn take_over(&mut self, first: &[T]) {
        self.known = Known::No;
        self.first.copy_from_slice(first);
    }

    /// A at the start of a step, where the rates were evaluated last; nothing to do where it is known.
    pub(crate) fn differentiate(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        let out = (&mut self.by_state[..], &mut self.by_time[..]);
        match self.known {
            Known::Yes => return Ok(()),
            Known::Elsewhere => system.differentiate_again(time, state, out)?,
            Known::No => {
                self.factored = None;
                system.differentiate(time, state, out.0, out.1)?;
            }
        }
        self.take_slopes(state);
        self.known = Known::Yes;
        Ok(())
    }

    /// Tries a step from `state` by (1) and (2); the result is [`Rosenbrock::next`], and `state` is untouched.
    pub(crate) fn attempt(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        system.enter();
        self.made = f64::NAN;
        self.differentiate(system, time, state)?;
        let shift = Some(self.factor(step, T::from_f64));
        if self.factored != shift {
            self.factored = shift;
            system.factored();
        }
        self.stages(
            [time, step],
            T::from_f64,
            state,
            |[time, span], trial, stage| system.rates(time, span, trial, stage),
        )?;
        self.made = step;
        system.project_end(time + step, &mut self.next)?;
        system.rates(time + step, step, &self.next, &mut self.last)
    }

    /// Ends the last attempt, which started at `state`, after a part of it already: on its interpolant, whose error is that of a step of the method but for a
    /// factor, and costs no factor of a matrix. `false`: there is no attempt that goes so far.
    pub(crate) fn end_early(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<bool, StepError> {
        let goes_so_far = step <= self.made;
        if goes_so_far {
            system.enter();
            let mut next = std::mem::take(&mut self.next);
            self.interpolate(1.0, step, state, &mut next);
            self.next = next;
            system.project_end(time + step, &mut self.next)?;
            system.rates(time + step, step, &self.next, &mut self.last)?;
        }
        Ok(goes_so_far)
    }

    /// Takes the last attempt.
    pub(crate) fn accept(&mut self, state: &mut [T]) {
        state.copy_from_slice(&self.next);
        std::mem::swap(&mut self.first, &mut self.last);
        self.known = Known::No;
    }

    /// The estimate of the error of the last attempt, and the state at its end.
    pub(crate) fn estimate(&self) -> (&[T], &[T]) {
        (self.error(), &self.next)
    }

    /// The state at `theta` (0 … 1) of a step of a size, with which the last attempt, which started at `state`, begins or ends, by (3).
    pub(crate) fn interpolate(&self, theta: f64, step: f64, state: &[T], out: &mut [T]) {
        let theta = theta * (step / self.made);
        let (t, left) = (T::from_f64(theta), T::from_f64(1.0 - theta));
        out.copy_from_slice(state);
        let mut weights = [T::zero(); POWERS];
        let mut weight = t;
        for (number, to) in weights.iter_mut().take(self.inside.len()).enumerate() {
            *to = weight;
            weight *= if number == 0 { left } else { t };
        }
        add(&weights, &self.sums, out);
    }

    /// The largest rate of the system at the start of the last attempt, as powers of its Jacobian show it. |x|² = Σ weight x².
    pub(crate) fn fastest(&mut self, weights: &[T]) -> f64 {
        fastest(&self.by_state, weights, &mut self.trial, &mut self.room)
    }

    /// The estimate of the error of a step of size h on ẏ = −λ y, y = 1, z = hλ.
    pub(crate) fn error_of_decay(&self, z: f64) -> f64 {
        let mut stages = [0.0; MOST_STAGES];
        let mut error = 0.0;
        for (i, (_, [a, c])) in self.rows.iter().enumerate() {
            let (mut y, mut sum) = (1.0, 0.0);
            for (stage, (a, c)) in stages.iter().zip(a.iter().zip(c)) {
                y += a.to_f64() * stage;
                sum += c.to_f64() * stage;
            }
            error = (sum - z * y) / (1.0 / self.gamma + z);
            stages[i] = error;
        }
        error.abs()
    }

    /// The same of a small step, over the power of z that is [`Rosenbrock::exponent`].
    pub(crate) fn error_constant(&self) -> f64 {
        self.error_of_decay(SMALL) / SMALL.powf(self.exponent)
    }

    /// A x, A at the start of the step.
    pub(crate) fn slope_along(&mut self, x: &[T]) -> &[T] {
        let rows = self.by_state.chunks_exact(self.length.max(1));
        for (to, row) in self.room.iter_mut().zip(rows) {
            *to = row
                .iter()
                .zip(x)
                .fold(T::zero(), |sum, (a, x)| sum + *a * *x);
        }
        &self.room
    }

    /// When a stage of a step is, in parts of it.
    pub(crate) fn stage_time(&self, stage: usize) -> Option<f64> {
        self.rows.get(stage).map(|([time, _], _)| *time)
    }
}

/// out += Σ w_i U_i, stages one after the other.
fn add<T: Real>(weights: &[T], stages: &[T], out: &mut [T]) {
    // Sixteen registers are more than there are.
    let done = match size_of::<T>() <= size_of::<f64>() {
        true => add_by::<16, T>(weights, stages, out, 0),
        false => 0,
    };
    let done = add_by::<4, T>(weights, stages, out, done);
    add_by::<1, T>(weights, stages, out, done);
}

/// The same from a number on, N numbers at a time, whose sums stay in registers; how far it came.
fn add_by<const N: usize, T: Real>(
    weights: &[T],
    stages: &[T],
    out: &mut [T],
    from: usize,
) -> usize {
    let length = out.len();
    let (blocks, rest) = out.split_at_mut(from).1.as_chunks_mut::<N>();
    for (number, block) in blocks.iter_mut().enumerate() {
        let mut sum = *block;
        for (weight, stage) in weights.iter().zip(stages.chunks_exact(length.max(1))) {
            let own = stage.get(from + N * number..);
            if let Some(x) = own.and_then(<[T]>::first_chunk::<N>) {
                for (sum, x) in sum.iter_mut().zip(x) {
                    *sum += *weight * *x;
                }
            }
        }
        *block = sum;
    }
    length - rest.len()
}
