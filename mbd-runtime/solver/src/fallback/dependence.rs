//! Which rows repeat others: elimination of the dense Jacobian row by row, in the order of declaration. Only where a run has failed.

use mbd_scene::Float;
use mbd_scene::orthogonal::{dot, subtract, take_out};

use super::limits::INVOLVED;

/// What depends on what.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Dependence {
    /// Number of independent rows.
    pub rank: usize,
    /// Rows that take part in a dependence, in order.
    pub rows: Vec<usize>,
    /// The largest Σ c Φ over the dependences Σ c Φ_v = 0, |c| ≤ 1: zero unless the rows contradict each other.
    pub contradiction: f64,
}

/// A direction of the rows so far, and the rows it is made of.
struct RowDirection {
    unit: Vec<f64>,
    made: Vec<f64>,
}

/// The dependences of the rows of a dense Jacobian with `columns` columns, whose values are `values`; rows are independent from a part of
/// `new_from` on.
pub(crate) fn dependent<T: Float>(
    jacobian: &[f64],
    columns: usize,
    values: &[T],
    new_from: f64,
) -> Dependence {
    let mut directions: Vec<RowDirection> = Vec::new();
    let mut found = Dependence::default();
    let mut involved = vec![false; values.len()];
    for (index, row) in jacobian.chunks_exact(columns.max(1)).enumerate() {
        let mut rest = row.to_vec();
        let mut made = vec![0.0; values.len()];
        if let Some(own) = made.get_mut(index) {
            *own = 1.0;
        }
        let whole = dot(&rest, &rest).sqrt();
        let units = directions.iter().map(|known| (0, &known.unit[..]));
        take_out(&mut rest, units, |known, along| {
            subtract(&mut made, along, &directions[known].made);
        });
        let new = dot(&rest, &rest).sqrt();
        if new > new_from * whole {
            let scale = |list: Vec<f64>| list.into_iter().map(|x| x / new).collect();
            directions.push(RowDirection {
                unit: scale(rest),
                made: scale(made),
            });
            continue;
        }
        let largest = made.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        for (flag, c) in involved.iter_mut().zip(&made) {
            *flag |= c.abs() > INVOLVED * largest;
        }
        let left = made.iter().zip(values).map(|(c, value)| c * value.to_f64());
        let left = left.sum::<f64>().abs() / largest;
        found.contradiction = found.contradiction.max(left);
    }
    found.rank = directions.len();
    let rows = involved.iter().enumerate();
    found.rows = rows
        .filter(|(_, flag)| **flag)
        .map(|(row, _)| row)
        .collect();
    found
}

#[cfg(test)]
mod tests {
    use super::dependent;
    use crate::fallback::NEW;

    #[test]
    fn a_sum_of_two_rows_is_found_with_its_parts_and_its_contradiction() {
        let jacobian = [
            1.0, 0.0, 2.0, 0.0, //
            0.0, 0.0, 0.0, 1.0, //
            0.0, 3.0, 1.0, 0.0, //
            1.0, 3.0, 3.0, 0.0,
        ];
        let found = dependent(&jacobian, 4, &[0.1, 0.0, 0.2, 0.3], NEW);
        assert_eq!((found.rank, found.rows), (3, vec![0, 2, 3]));
        assert!(found.contradiction < 1e-15);
        let found = dependent(&jacobian, 4, &[0.1, 0.0, 0.2, 0.7], NEW);
        assert!((found.contradiction - 0.4).abs() < 1e-12);
    }
}
