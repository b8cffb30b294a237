//! Whole lists of numbers, folded in lanes: a sum or a comparison need not wait for the one before.

use mbd_scene::Float;

/// How many numbers are folded beside each other.
const LANES: usize = 4;

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

/// Σ w (b − a)² and Σ w a² over three lists.
pub(crate) fn weighted_squares<T: Float>(weights: &[T], a: &[T], b: &[T]) -> [T; 2] {
    let zero = T::zero();
    let (mut differences, mut sizes) = ([zero; LANES], [zero; LANES]);
    let lists = weights
        .chunks(LANES)
        .zip(a.chunks(LANES))
        .zip(b.chunks(LANES));
    let mut add = |lane: usize, w: T, a: T, b: T| {
        differences[lane] += w * (b - a) * (b - a);
        sizes[lane] += w * a * a;
    };
    for ((w, a), b) in lists {
        if let ([p, q, r, s], [i, j, k, l], [t, u, v, x]) = (w, a, b) {
            add(0, *p, *i, *t);
            add(1, *q, *j, *u);
            add(2, *r, *k, *v);
            add(3, *s, *l, *x);
        } else {
            for (lane, ((w, a), b)) in w.iter().zip(a).zip(b).enumerate() {
                add(lane, *w, *a, *b);
            }
        }
    }
    let total = |[a, b, c, d]: [T; LANES]| (a + b) + (c + d);
    [total(differences), total(sizes)]
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
    fn sums_take_every_entry_once() {
        for count in 0..40 {
            let a: Vec<f64> = (0..count).map(f64::from).collect();
            let weights: Vec<f64> = a.iter().map(|x| x + 1.0).collect();
            let b = vec![1.0; a.len() + 3];
            let [differences, sizes] = weighted_squares(&weights, &a, &b);
            assert_eq!(sizes, a.iter().map(|x| (x + 1.0) * x * x).sum::<f64>());
            let want = a.iter().map(|x| (x + 1.0) * (1.0 - x) * (1.0 - x));
            assert_eq!(differences, want.sum::<f64>());
        }
    }
}
