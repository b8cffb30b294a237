//! Whole lists of numbers, folded in lanes: a sum or a comparison need not wait for the one before.

use mbd_scene::{Float, Real};

/// How many numbers are folded beside each other.
const LANES: usize = 4;
/// The same where nothing is compared.
const WIDE: usize = 8;

/// The largest size; infinite where a number is not finite.
pub(crate) fn largest<T: Float>(list: &[T]) -> f64 {
    let zero = T::zero();
    // 0 x is zero for a finite number and NaN for others.
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
    match (e + f) + (g + h) == zero {
        true => a.max(b).max(c.max(d)).to_f64(),
        false => f64::INFINITY,
    }
}

/// Where stretches of `N` numbers begin that cover a list of a length, the last two of them overlapping; none in a shorter list.
#[inline]
fn stretches<const N: usize>(length: usize) -> impl Iterator<Item = usize> {
    let last = length.checked_sub(N);
    let count = last.map_or(0, |last| last.div_ceil(N) + 1);
    (0..count).map(move |index| (N * index).min(last.unwrap_or_default()))
}

/// Whether every number is finite.
#[inline]
pub(crate) fn all_finite<T: Float>(list: &[T]) -> bool {
    let zero = T::zero();
    if list.len() < WIDE {
        // One by one: whoever has just written them wrote one by one.
        return list.iter().all(|x| x.is_finite());
    }
    let mut faults = [zero; WIDE];
    for start in stretches::<WIDE>(list.len()) {
        if let Some(own) = own::<T, WIDE>(list, start) {
            for (fault, x) in faults.iter_mut().zip(own) {
                *fault += zero * *x;
            }
        }
    }
    total(faults) == zero
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
    #[inline]
    pub(crate) fn add(&self, state: &[T], h: T, stages: &[T], out: &mut [T]) {
        let length = state.len();
        let term = |&(weight, list): &(T, usize)| {
            let own = stages.get(list * length..(list + 1) * length);
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
                    *slot = term(of);
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

/// out = state + Σ factor × list, every number in the order of the terms.
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

/// The same for a number of terms that is not known to the compiler.
#[inline(always)]
fn add_all<T: Real>(state: &[T], terms: &[(T, &[T])], out: &mut [T]) {
    match out.len() {
        WIDE.. => add_stretches::<T, WIDE>(state, terms, out),
        // One by one: whoever has just written them wrote one by one.
        _ => {
            for (index, (out, x)) in out.iter_mut().zip(state).enumerate() {
                let parts = terms
                    .iter()
                    .filter_map(|(factor, list)| Some(*factor * *list.get(index)?));
                *out = parts.fold(*x, |sum, part| sum + part);
            }
        }
    }
}

/// The same over lists of at least `N` numbers, `N` at a time.
#[inline(always)]
fn add_stretches<T: Real, const N: usize>(state: &[T], terms: &[(T, &[T])], out: &mut [T]) {
    for start in stretches::<N>(out.len()) {
        let (Some(out), Some(state)) = (own_mut(out, start), own::<T, N>(state, start)) else {
            continue;
        };
        let mut sums = *state;
        for (factor, list) in terms {
            if let Some(numbers) = own::<T, N>(list, start) {
                for (sum, number) in sums.iter_mut().zip(numbers) {
                    *sum += *factor * *number;
                }
            }
        }
        *out = sums;
    }
}

/// The stretch of a list that begins at a place.
#[inline]
fn own<T, const N: usize>(list: &[T], start: usize) -> Option<&[T; N]> {
    list.get(start..)?.first_chunk()
}

#[inline]
fn own_mut<T, const N: usize>(list: &mut [T], start: usize) -> Option<&mut [T; N]> {
    list.get_mut(start..)?.first_chunk_mut()
}

/// The sum of the lanes.
fn total<T: Real>([a, b, c, d, e, f, g, h]: [T; WIDE]) -> T {
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Σ w (b − a)² and Σ w a² over three lists.
pub(crate) fn weighted_squares<T: Float>(weights: &[T], a: &[T], b: &[T]) -> [T; 2] {
    let [differences, sizes, _] = weighted_differences(weights, a, b, b);
    [differences, sizes]
}

/// Σ w (b − a)², Σ w a² and Σ w (c − b)² over four lists.
#[inline]
pub(crate) fn weighted_differences<T: Real>(weights: &[T], a: &[T], b: &[T], c: &[T]) -> [T; 3] {
    let lists = [weights, a, b, c];
    let common = lists
        .iter()
        .fold(usize::MAX, |least, list| least.min(list.len()));
    let [weights, a, b, c] = lists.map(|list| list[..common].as_chunks::<WIDE>());
    let terms = |w: T, a: T, b: T, c: T| {
        let (before, after) = (b - a, c - b);
        [w * before * before, w * a * a, w * after * after]
    };
    let mut sums = [[T::zero(); WIDE]; 3];
    // One half of the lanes after the other: their sums stay in registers.
    for half in [0, WIDE / 2] {
        let mut own = [[T::zero(); WIDE / 2]; 3];
        for (((w, a), b), c) in weights.0.iter().zip(a.0).zip(b.0).zip(c.0) {
            #[allow(clippy::needless_range_loop, reason = "one place of seven lists")]
            for lane in 0..WIDE / 2 {
                let at = half + lane;
                let [before, size, after] = terms(w[at], a[at], b[at], c[at]);
                own[0][lane] += before;
                own[1][lane] += size;
                own[2][lane] += after;
            }
        }
        for (sums, own) in sums.iter_mut().zip(own) {
            sums[half..half + WIDE / 2].copy_from_slice(&own);
        }
    }
    let mut totals = sums.map(total);
    for (((w, a), b), c) in weights.1.iter().zip(a.1).zip(b.1).zip(c.1) {
        for (total, term) in totals.iter_mut().zip(terms(*w, *a, *b, *c)) {
            *total += term;
        }
    }
    totals
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
            let mut list: Vec<f64> = (0..length).map(|i| -1e306 * f64::from(i)).collect();
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
    fn sums_take_every_entry_once() {
        for count in 0..40 {
            let a: Vec<f64> = (0..count).map(f64::from).collect();
            let weights: Vec<f64> = a.iter().map(|x| x + 1.0).collect();
            let b = vec![1.0; a.len() + 3];
            let [differences, sizes] = weighted_squares(&weights, &a, &b);
            assert_eq!(sizes, a.iter().map(|x| (x + 1.0) * x * x).sum::<f64>());
            let want = a.iter().map(|x| (x + 1.0) * (1.0 - x) * (1.0 - x));
            assert_eq!(differences, want.sum::<f64>());
            let c: Vec<f64> = a.iter().map(|x| 3.0 - x).collect();
            let [_, _, after] = weighted_differences(&weights, &a, &b, &c);
            let want = a.iter().map(|x| (x + 1.0) * (2.0 - x) * (2.0 - x));
            assert_eq!(after, want.sum::<f64>());
        }
    }
}
