//! Metrics of a run that came to several models: each part of it is measured by itself, and the parts are added up.

use super::sum::Sum;
use crate::metric::{MetricReader, MissingMetric};

/// What was measured in a part of a run that came to several models.
#[derive(Clone, Debug)]
pub(crate) struct MeasuredRun {
    /// Which model, by index.
    pub(super) model: usize,
    /// When the part ended [s].
    pub(super) end: f64,
    pub(super) sums: Vec<(MetricReader, Sum)>,
}

/// The same metrics with the same values, to the bit.
impl PartialEq for MeasuredRun {
    fn eq(&self, other: &Self) -> bool {
        let values = |part: &Self| -> Vec<(MetricReader, Option<u64>)> {
            let told = part.sums.iter().map(|(reader, sum)| {
                let value = sum.value(reader.take).ok();
                (reader.clone(), value.map(f64::to_bits))
            });
            told.collect()
        };
        self.model == other.model
            && self.end.to_bits() == other.end.to_bits()
            && values(self) == values(other)
    }
}

impl MeasuredRun {
    /// The value of a metric over those parts whose models `counts`, what it may be off by, and when the last of them ended.
    pub(crate) fn of_all(
        parts: &[MeasuredRun],
        reader: &MetricReader,
        counts: &dyn Fn(usize) -> bool,
    ) -> (Result<[f64; 2], MissingMetric>, Option<f64>) {
        let mut own = parts.iter().filter(|part| counts(part.model)).peekable();
        if own.peek().is_none() {
            return (Err(MissingMetric::NotReached), None);
        }
        let measured = own.filter_map(|part| {
            let found = part.sums.iter().find(|(known, _)| known == reader);
            found.map(|(_, sum)| (*sum, part.end))
        });
        let whole = measured.reduce(|(mut whole, _), (sum, end)| {
            whole.add_part(reader, &sum);
            (whole, end)
        });
        match whole {
            None => (Err(MissingMetric::NotRecorded), None),
            Some((sum, end)) => {
                let value = sum.value(reader.take);
                (value.map(|value| [value, sum.open(reader.take)]), Some(end))
            }
        }
    }
}
