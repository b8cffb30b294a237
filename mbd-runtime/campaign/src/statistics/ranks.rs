//! Spearman's rank correlation: how surely one number rises with another, whatever the shape of the curve.

/// The correlation of the ranks of two lists of equal length, −1 … 1; ties share their mean rank. `None` with fewer than three pairs or where one
/// of them does not vary.
#[must_use]
pub fn spearman(a: &[f64], b: &[f64]) -> Option<f64> {
    let pairs = a.iter().zip(b).filter(|(a, b)| !a.is_nan() && !b.is_nan());
    let (a, b): (Vec<f64>, Vec<f64>) = pairs.map(|(a, b)| (*a, *b)).unzip();
    if a.len() < 3 {
        return None;
    }
    of_ranks(&ranks(&a), &ranks(&b))
}

/// The same of every two of some lists, by their places, the first before the second; rows in which one of them has no number do not count.
#[must_use]
pub fn spearman_of_all(lists: &[Vec<f64>]) -> Vec<([usize; 2], f64)> {
    let rows = lists.iter().map(Vec::len).min().unwrap_or(0);
    let whole = |row: &usize| lists.iter().all(|list| !list[*row].is_nan());
    let rows: Vec<usize> = (0..rows).filter(whole).collect();
    let of = |list: &Vec<f64>| ranks(&rows.iter().map(|row| list[*row]).collect::<Vec<_>>());
    let all: Vec<Vec<f64>> = lists.iter().map(of).collect();
    let pairs = (0..all.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    let told = pairs.filter_map(|[a, b]| Some(([a, b], of_ranks(&all[a], &all[b])?)));
    told.collect()
}

/// The correlation of ranks; `None` where some do not vary.
fn of_ranks(a: &[f64], b: &[f64]) -> Option<f64> {
    let middle = 0.5 * (a.len() as f64 + 1.0);
    let sum = |x: &[f64], y: &[f64]| -> f64 {
        x.iter()
            .zip(y)
            .map(|(x, y)| (x - middle) * (y - middle))
            .sum()
    };
    let size = (sum(a, a) * sum(b, b)).sqrt();
    (size > 0.0).then(|| (sum(a, b) / size).clamp(-1.0, 1.0))
}

/// The rank of every number, from 1; equal ones share the mean of theirs.
fn ranks(list: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..list.len()).collect();
    order.sort_by(|i, j| list[*i].total_cmp(&list[*j]));
    let mut ranks = vec![0.0; list.len()];
    let mut before = 0;
    for tied in order.chunk_by(|i, j| list[*i] == list[*j]) {
        let mean = before as f64 + 0.5 * (tied.len() as f64 + 1.0);
        tied.iter().for_each(|it| ranks[*it] = mean);
        before += tied.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_rises_is_fully_correlated_and_what_falls_is_so_against_it() {
        let x: Vec<f64> = (0..50).map(|k| f64::from(k * k % 97)).collect();
        let rises: Vec<f64> = x.iter().map(|x| x.exp().ln_1p()).collect();
        let falls: Vec<f64> = x.iter().map(|x| -x.powi(3)).collect();
        assert!((spearman(&x, &rises).expect("it varies") - 1.0).abs() < 1e-12);
        assert!((spearman(&x, &falls).expect("it varies") + 1.0).abs() < 1e-12);
    }

    #[test]
    fn every_two_lists_have_their_correlation_in_whole_rows() {
        let a = vec![1.0, 2.0, 3.0, 4.0, f64::NAN];
        let b = vec![1.0, 4.0, 9.0, 16.0, 0.0];
        let c = vec![4.0, 3.0, 2.0, 1.0, 9.0];
        let found = spearman_of_all(&[a, b, c]);
        assert_eq!(found, [([0, 1], 1.0), ([0, 2], -1.0), ([1, 2], -1.0)]);
    }

    /// Without ties 1 − 6 Σ d² / (n (n² − 1)): ranks 1 2 3 4 5 against 2 1 4 3 5.
    #[test]
    fn a_small_example_is_that_of_the_formula() {
        let r = spearman(&[1.0, 2.0, 3.0, 4.0, 5.0], &[2.0, 1.0, 4.0, 3.0, 5.0]);
        assert!((r.expect("it varies") - (1.0 - 6.0 * 4.0 / 120.0)).abs() < 1e-12);
        // Ties share ranks: 1.5 1.5 3 against 1 2 3.
        let r = spearman(&[7.0, 7.0, 9.0], &[1.0, 2.0, 3.0]);
        assert!((r.expect("it varies") - 0.75_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_vary_drives_nothing() {
        assert_eq!(
            spearman(&[1.0; 9], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]),
            None
        );
        assert_eq!(spearman(&[1.0, f64::NAN, 2.0], &[1.0, 2.0, 3.0]), None);
    }
}
