//! Several right-hand sides for one factor: the columns of a matrix, row by row.

/// Solves for every column behind a factor by itself.
///
/// `rows` = [factor | B], where B and the solutions in `out` are n × k for n unknowns, row by row. `solve` takes [factor | b] and writes n numbers. What
/// does not fit leaves `out` untouched.
pub fn each_column<S: Copy>(
    unknowns: usize,
    (rows, out): (&[S], &mut [S]),
    room: &mut Vec<S>,
    mut solve: impl FnMut(&[S], &mut [S]),
) {
    let columns = out.len() / unknowns.max(1);
    if out.len() != unknowns * columns {
        return;
    }
    if columns <= 1 {
        return solve(rows, out);
    }
    let Some(factor) = rows.len().checked_sub(out.len()) else {
        return;
    };
    let (factor, right) = rows.split_at(factor);
    room.clear();
    room.extend_from_slice(factor);
    room.extend_from_slice(&right[..unknowns]);
    room.extend_from_slice(&out[..unknowns]);
    let (given, found) = room.split_at_mut(factor.len() + unknowns);
    for column in 0..columns {
        let right = right.iter().skip(column).step_by(columns);
        for (slot, &x) in given[factor.len()..].iter_mut().zip(right) {
            *slot = x;
        }
        solve(given, found);
        for (slot, &x) in out.iter_mut().skip(column).step_by(columns).zip(&*found) {
            *slot = x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::each_column;

    #[test]
    fn columns_are_solved_one_by_one() {
        // x = factor · b, for the unknowns of each column.
        let solve = |rows: &[f64], out: &mut [f64]| {
            let (factor, right) = rows.split_at(1);
            for (x, b) in out.iter_mut().zip(right) {
                *x = factor[0] * b;
            }
        };
        let rows = [2.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let mut out = [0.0; 6];
        each_column(2, (&rows, &mut out), &mut Vec::new(), solve);
        assert_eq!(out, [2.0, 4.0, 6.0, 8.0, 10.0, 12.0]);
        // One column.
        let mut out = [0.0; 2];
        each_column(2, (&rows[..3], &mut out), &mut Vec::new(), solve);
        assert_eq!(out, [2.0, 4.0]);
        // Lists that do not fit.
        let mut out = [0.0; 5];
        each_column(2, (&rows, &mut out), &mut Vec::new(), solve);
        assert_eq!(out, [0.0; 5]);
    }
}
