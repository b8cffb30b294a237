//! Whole lists of numbers, folded in lanes: a sum or a comparison need not wait for the one before.

use mbd_scene::{Float, Real};

/// How many numbers are folded beside each other.
const LANES: usize = 4;
/// The same where nothing is compared.
const WIDE: usize = 8;

/// The largest size; infinite where a number is not finite.
#[inline]
pub(crate) fn largest<T: Float>(list: &[T]) -> f64 {
    largest_size(list).to_f64()
}

/// The same in the scalar itself, which may be several numbers beside each other.
#[inline]
pub(crate) fn largest_size<S: Real>(list: &[S]) -> S {
    match list.len() {
        0..WIDE => largest_of_few(list),
        _ => largest_of_many(list),
    }
}

/// The same one by one.
#[inline]
fn largest_of_few<S: Real>(list: &[S]) -> S {
    let zero = S::zero();
    // 0 x is zero for a finite number and NaN for others.
    let (most, faults) = list.iter().fold((zero, zero), |(most, faults), x| {
        (most.max(x.abs()), faults + zero * *x)
    });
    finite_or_infinite(most, faults)
}

/// The same in lanes.
fn largest_of_many<S: Real>(list: &[S]) -> S {
    let zero = S::zero();
    let (mut most, mut faults) = ([zero; LANES], [zero; LANES]);
    let chunks = list.chunks_exact(LANES);
    let rest = chunks.remainder();
    for chunk in chunks {
        for lane in 0..LANES {
            most[lane] = most[lane].max(chunk[lane].abs());
            faults[lane] += zero * chunk[lane];
        }
    }
    for (lane, x) in rest.iter().enumerate() {
        most[lane] = most[lane].max(x.abs());
        faults[lane] += zero * *x;
    }
    let [a, b, c, d] = most;
    let [e, f, g, h] = faults;
    finite_or_infinite(a.max(b).max(c.max(d)), (e + f) + (g + h))
}

/// A size, infinite where faults are not zero.
#[inline(always)]
fn finite_or_infinite<S: Real>(size: S, faults: S) -> S {
    let none = S::zero().le(faults);
    S::select(none, size, S::from_f64(f64::INFINITY))
}

/// Whether every number is finite.
#[inline]
pub(crate) fn all_finite<T: Float>(list: &[T]) -> bool {
    let one_by_one = || list.iter().all(|x| x.is_finite());
    let (stretches, rest) = list.as_chunks::<WIDE>();
    let Some(last) = list.last_chunk::<WIDE>() else {
        // Whoever has just written them wrote one by one.
        return one_by_one();
    };
    let mut sums = [T::zero(); WIDE];
    let mut look = |own: &[T; WIDE]| {
        for (sum, x) in sums.iter_mut().zip(own) {
            *sum += *x;
        }
    };
    stretches.iter().for_each(&mut look);
    if !rest.is_empty() {
        look(last);
    }
    // No sum that has met a number which is not finite is, and almost every other is.
    total(sums).is_finite() || one_by_one()
}

/// Copies a list in pairs: numbers that have just been written, one by one or in pairs, are slow to be read many at once.
#[inline]
pub(crate) fn copy<T: Real>(from: &[T], to: &mut [T]) {
    let ((pairs, rest), (from, last)) = (to.as_chunks_mut::<2>(), from.as_chunks());
    pairs
        .iter_mut()
        .zip(from)
        .for_each(|(to, from)| *to = *from);
    rest.iter_mut().zip(last).for_each(|(to, from)| *to = *from);
}

/// How many lists a combination takes.
pub(crate) const MOST_TERMS: usize = 16;

/// Σ w k over lists of one length that follow each other, the stages of a step: those weights that are not zero, each with the number of its list.
#[derive(Clone, Debug)]
pub(crate) struct Combination<T> {
    terms: Vec<(T, usize)>,
}

impl<T: Real> Combination<T> {
    /// That of these weights, at most [`MOST_TERMS`] of them.
    pub(crate) fn new(weights: &[T]) -> Self {
        let numbered = weights.iter().enumerate().take(MOST_TERMS);
        let weighted = numbered.filter(|(_, weight)| **weight != T::zero());
        Combination {
            terms: weighted.map(|(list, weight)| (*weight, list)).collect(),
        }
    }

    /// The same over another scalar.
    pub(crate) fn map<S>(&self, number: impl Fn(&T) -> S) -> Combination<S> {
        let terms = self.terms.iter();
        Combination {
            terms: terms
                .map(|(weight, list)| (number(weight), *list))
                .collect(),
        }
    }

    /// out = state + h Σ w k, every number in the order of the lists, in one pass over the state.
    #[inline(always)]
    pub(crate) fn add(&self, state: &[T], h: T, stages: &[T], out: &mut [T]) {
        let length = state.len();
        let term = |&(weight, list): &(T, usize)| {
            let own = stages.get(list * length..);
            (h * weight, own.unwrap_or_default())
        };
        // A loop that knows how many terms there are needs no list of them.
        match self.terms.as_slice() {
            [] => add(state, [], out),
            [a] => add(state, [a].map(term), out),
            [a, b] => add(state, [a, b].map(term), out),
            [a, b, c] => add(state, [a, b, c].map(term), out),
            [a, b, c, d] => add(state, [a, b, c, d].map(term), out),
            more => {
                let mut list: [(T, &[T]); MOST_TERMS] = [(T::zero(), &[]); MOST_TERMS];
                for (slot, of) in list.iter_mut().zip(more) {
                    let (factor, own) = term(of);
                    *slot = (factor, own.get(..length).unwrap_or_default());
                }
                add_all(state, list.get(..more.len()).unwrap_or_default(), out);
            }
        }
    }
}

/// The same for weights that are known just now.
pub(crate) fn combine<T: Real>(state: &[T], h: T, weights: &[T], stages: &[T], out: &mut [T]) {
    let mut list: [(T, &[T]); MOST_TERMS] = [(T::zero(), &[]); MOST_TERMS];
    let stages = stages.chunks_exact(state.len().max(1));
    let weighted = weights.iter().zip(stages);
    let terms = weighted
        .filter(|(weight, _)| **weight != T::zero())
        .map(|(weight, stage)| (h * *weight, stage));
    let filled = list.iter_mut().zip(terms);
    let count = filled.map(|(slot, term)| *slot = term).count();
    add_all(state, list.get(..count).unwrap_or_default(), out);
}

/// The same of lists whose length the compiler knows, for weights that it knows: the numbers are those of [`Combination::add`].
#[inline(always)]
pub(crate) fn combined<T: Real, const N: usize, const K: usize>(
    state: &[T; N],
    h: T,
    weights: &[f64],
    lists: [&[T; N]; K],
) -> [T; N] {
    let mut out = *state;
    for (&weight, list) in weights.iter().zip(lists) {
        if weight != 0.0 {
            let factor = h * T::from_f64(weight);
            for (out, x) in out.iter_mut().zip(list) {
                *out = factor.fmadd(*x, *out);
            }
        }
    }
    out
}

/// out = state + Σ factor × list, every number in the order of the terms; no list is shorter than `out`.
#[inline(always)]
fn add<T: Real, const K: usize>(state: &[T], terms: [(T, &[T]); K], out: &mut [T]) {
    let shortest = terms.iter().map(|(_, list)| list.len());
    if shortest.fold(state.len(), usize::min) < out.len() {
        return;
    }
    // Cut to one length, so that a place in one of them is a place in all.
    let state = &state[..out.len()];
    let terms = terms.map(|(factor, list)| (factor, &list[..out.len()]));
    add_all(state, &terms, out);
}

/// The same for a number of terms that is not known to the compiler, of lists that are as long as `out`.
#[inline(always)]
fn add_all<T: Real>(state: &[T], terms: &[(T, &[T])], out: &mut [T]) {
    if out.len() < WIDE {
        // One by one: whoever has just written them wrote one by one.
        for (index, (out, x)) in out.iter_mut().zip(state).enumerate() {
            let parts = terms
                .iter()
                .filter_map(|(factor, list)| Some((*factor, *list.get(index)?)));
            *out = parts.fold(*x, |sum, (factor, number)| factor.fmadd(number, sum));
        }
        return;
    }
    let (stretches, rest) = out.as_chunks_mut::<WIDE>();
    let is_whole = rest.is_empty();
    for (index, out) in stretches.iter_mut().enumerate() {
        add_stretch(state, terms, out, |list| list.as_chunks().0.get(index));
    }
    // The last stretch begins inside the one before.
    if let (false, Some(out)) = (is_whole, out.last_chunk_mut()) {
        add_stretch(state, terms, out, |list| list.last_chunk());
    }
}

/// The same over one stretch of the lists.
#[inline(always)]
fn add_stretch<'a, T: Real>(
    state: &'a [T],
    terms: &[(T, &'a [T])],
    out: &mut [T; WIDE],
    own: impl Fn(&'a [T]) -> Option<&'a [T; WIDE]>,
) {
    let Some(mut sums) = own(state).copied() else {
        return;
    };
    for (factor, list) in terms {
        for (sum, number) in sums.iter_mut().zip(own(list).into_iter().flatten()) {
            *sum = factor.fmadd(*number, *sum);
        }
    }
    *out = sums;
}

/// The sum of the lanes.
fn total<T: Real>([a, b, c, d, e, f, g, h]: [T; WIDE]) -> T {
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Σ w a² over two lists.
#[inline]
pub(crate) fn weighted_size<T: Real>(weights: &[T], a: &[T]) -> T {
    weighted([weights, a], |[w, a]| w * a * a)
}

/// Σ w (b − a)² over three lists.
#[inline]
pub(crate) fn weighted_change<T: Real>(weights: &[T], a: &[T], b: &[T]) -> T {
    weighted([weights, a, b], |[w, a, b]| {
        let change = b - a;
        w * change * change
    })
}

/// The sum of terms over the places of some lists.
#[inline(always)]
fn weighted<T: Real, const N: usize>(lists: [&[T]; N], term: impl Fn([T; N]) -> T) -> T {
    let lengths = lists.iter().map(|list| list.len());
    let common = lengths.min().unwrap_or_default();
    let lists = lists.map(|list| list[..common].as_chunks::<LANES>());
    let mut sums = [T::zero(); LANES];
    for index in 0..common / LANES {
        let own = lists.map(|(stretches, _)| &stretches[index]);
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += term(own.map(|numbers| numbers[lane]));
        }
    }
    let [a, b, c, d] = sums;
    let rest = 0..common % LANES;
    let rest = rest.map(|index| term(lists.map(|(_, rest)| rest[index])));
    rest.fold((a + c) + (b + d), |sum, term| sum + term)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_is_that_of_all_places_and_shows_what_is_not_finite() {
        for length in 0..40 {
            let mut list: Vec<f64> = (0..length).map(|i| -0.5 * f64::from(i)).collect();
            assert_eq!(largest(&list), 0.5 * f64::from((length - 1).max(0)));
            for index in 0..list.len() {
                for fault in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let kept = std::mem::replace(&mut list[index], fault);
                    assert_eq!(largest(&list), f64::INFINITY);
                    list[index] = kept;
                }
            }
        }
        assert_eq!(largest(&[3.0_f32, -7.0]), 7.0);
    }

    #[test]
    fn a_list_is_finite_where_all_its_numbers_are() {
        for length in 0..40 {
            // The sum of some of them is not.
            let mut list: Vec<f64> = (0..length).map(|i| -1e307 * f64::from(i % 18)).collect();
            assert!(all_finite(&list));
            for index in 0..list.len() {
                for fault in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let kept = std::mem::replace(&mut list[index], fault);
                    assert!(!all_finite(&list));
                    list[index] = kept;
                }
            }
        }
    }

    #[test]
    fn a_copy_has_every_number() {
        for length in 0..12 {
            let list: Vec<f64> = (0..length).map(f64::from).collect();
            let mut copied = vec![f64::NAN; list.len()];
            copy(&list, &mut copied);
            assert_eq!(copied, list);
        }
    }

    #[test]
    fn a_combination_takes_every_stage_at_every_place() {
        for length in 0..40 {
            let state: Vec<f64> = (0..length).map(f64::from).collect();
            let stages: Vec<f64> = (0..3 * length).map(|i| f64::from(i) + 0.5).collect();
            let weights = [2.0, 0.0, -1.0, 5.0];
            let mut out = vec![f64::NAN; state.len()];
            combine(&state, 0.5, &weights, &stages, &mut out);
            for (i, out) in out.iter().enumerate() {
                let [a, c] = [0, 2].map(|stage| stages[stage * state.len() + i]);
                assert_eq!(*out, state[i] + a - 0.5 * c);
            }
        }
    }

    #[test]
    fn a_combination_of_known_length_is_the_same_to_the_bit() {
        let state = [0.1, 0.7, -1.3];
        let lists = [[1.1, -0.2, 3.3], [0.3, 0.9, -7.7], [4.1, 1e-3, 0.6]];
        let weights = [1.0 / 3.0, 0.0, 1.0 / 6.0];
        let mut out = [0.0; 3];
        Combination::new(&weights).add(&state, 0.01, lists.as_flattened(), &mut out);
        let [a, b, c] = &lists;
        assert_eq!(out, combined(&state, 0.01, &weights, [a, b, c]));
    }

    #[test]
    fn sums_take_every_entry_once() {
        for count in 0..40 {
            let a: Vec<f64> = (0..count).map(f64::from).collect();
            let weights: Vec<f64> = a.iter().map(|x| x + 1.0).collect();
            let b = vec![1.0; a.len() + 3];
            assert_eq!(
                weighted_size(&weights, &a),
                a.iter().map(|x| (x + 1.0) * x * x).sum::<f64>()
            );
            let want = a.iter().map(|x| (x + 1.0) * (1.0 - x) * (1.0 - x));
            assert_eq!(weighted_change(&weights, &a, &b), want.sum::<f64>());
        }
    }
}
