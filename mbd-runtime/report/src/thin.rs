//! Fewer rows that tell the same: long histories are thinned so that their extremes stay.

/// Rows of a curve worth keeping, at most about `most`: of each of so many equal spans of time the first, the lowest, the highest, the last,
/// and the first that is not a number.
pub(super) fn curve_rows(times: &[f64], values: &[f64], most: usize) -> Vec<usize> {
    let rows = times.len().min(values.len());
    if rows <= most {
        return (0..rows).collect();
    }
    let mut kept = Vec::new();
    for span in spans(&times[..rows], most / 4) {
        let mut extreme = [span.start; 2];
        let mut missing = None;
        for row in span.clone() {
            let value = values[row];
            if value.is_nan() {
                missing = missing.or(Some(row));
            }
            if value < values[extreme[0]] || values[extreme[0]].is_nan() {
                extreme[0] = row;
            }
            if value > values[extreme[1]] || values[extreme[1]].is_nan() {
                extreme[1] = row;
            }
        }
        let mut here = vec![span.start, extreme[0], extreme[1], span.end - 1];
        here.extend(missing);
        here.sort_unstable();
        here.dedup();
        kept.extend(here);
    }
    kept
}

/// Rows of a motion worth keeping, at most about `most`: of each of so many equal spans of time the first, and the one that is farthest from the
/// straight way between the ends of the span. The last row of all is kept.
pub(super) fn motion_rows(times: &[f64], signals: &[&[f64]], most: usize) -> Vec<usize> {
    if times.len() <= most {
        return (0..times.len()).collect();
    }
    let ranges: Vec<f64> = signals.iter().map(|signal| range(signal)).collect();
    let mut kept = Vec::new();
    for span in spans(times, most / 2) {
        let (first, last) = (span.start, span.end - 1);
        kept.push(first);
        let length = times[last] - times[first];
        let off = |row: usize| {
            let share = match length > 0.0 {
                true => (times[row] - times[first]) / length,
                false => 0.0,
            };
            let each = signals.iter().zip(&ranges).map(|(signal, range)| {
                let straight = signal[first] + share * (signal[last] - signal[first]);
                (signal[row] - straight).abs() / range
            });
            each.fold(0.0, f64::max)
        };
        let farthest = (first + 1..last)
            .map(|row| (row, off(row)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        kept.extend(farthest.map(|(row, _)| row));
    }
    if kept.last() != Some(&(times.len() - 1)) {
        kept.push(times.len() - 1);
    }
    kept
}

/// Rising rows parted into at most `count` spans of equal time; none is empty.
fn spans(times: &[f64], count: usize) -> Vec<std::ops::Range<usize>> {
    let (Some(&start), Some(&end)) = (times.first(), times.last()) else {
        return Vec::new();
    };
    let count = count.max(1);
    let mut spans = Vec::new();
    let mut from = 0;
    for k in 1..=count {
        let until = start + (end - start) * k as f64 / count as f64;
        let to = match k == count {
            true => times.len(),
            false => times.partition_point(|time| *time < until),
        };
        if to > from {
            spans.push(from..to);
            from = to;
        }
    }
    spans
}

fn range(signal: &[f64]) -> f64 {
    let ends = signal
        .iter()
        .filter(|x| x.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(*x), high.max(*x)]
        });
    (ends[1] - ends[0]).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_curve_keeps_its_extremes_and_its_gaps() {
        let times: Vec<f64> = (0..100_000).map(|k| f64::from(k) * 1e-3).collect();
        let mut values: Vec<f64> = times.iter().map(|t| (40.0 * t).sin()).collect();
        values[31_415] = 7.0;
        values[27_182] = -5.0;
        values[50_000] = f64::NAN;
        let rows = curve_rows(&times, &values, 2000);
        assert!(rows.len() <= 2100, "{}", rows.len());
        assert!(rows.is_sorted_by(|a, b| a < b));
        for row in [0, 27_182, 31_415, 50_000, 99_999] {
            assert!(rows.contains(&row), "{row}");
        }
    }

    #[test]
    fn a_thinned_motion_keeps_where_it_turns_and_where_it_ends() {
        // A ball that bounces once a second, in ten minutes of rows.
        let times: Vec<f64> = (0..60_000).map(|k| f64::from(k) * 0.01).collect();
        let heights: Vec<f64> = times.iter().map(|t| (t % 1.0) * (1.0 - t % 1.0)).collect();
        let rows = motion_rows(&times, &[&heights], 3000);
        assert!(rows.len() <= 3001 && rows.len() > 2000, "{}", rows.len());
        assert_eq!(rows.last(), Some(&59_999));
        // Linear between the rows that are kept, the bounce is nowhere lost by more than a tenth of its height.
        let mut worst = 0.0_f64;
        for pair in rows.windows(2) {
            for row in pair[0]..pair[1] {
                let share = (row - pair[0]) as f64 / (pair[1] - pair[0]) as f64;
                let straight = heights[pair[0]] + share * (heights[pair[1]] - heights[pair[0]]);
                worst = worst.max((heights[row] - straight).abs());
            }
        }
        assert!(worst < 0.025, "{worst}");
    }

    #[test]
    fn short_histories_stay_whole_and_instants_are_no_spans() {
        assert_eq!(curve_rows(&[0.0, 1.0], &[1.0, 2.0], 10), [0, 1]);
        assert_eq!(curve_rows(&[], &[], 10), Vec::<usize>::new());
        assert_eq!(motion_rows(&[0.0], &[&[1.0]], 10), [0]);
        // Nothing but one instant, over and over.
        let rows = motion_rows(&[2.0; 100], &[&[1.0; 100]], 10);
        assert_eq!((rows.first(), rows.last()), (Some(&0), Some(&99)));
    }
}
