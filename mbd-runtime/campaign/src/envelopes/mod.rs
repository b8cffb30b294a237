//! Envelopes: columns of all cases at the same instants, and what they say there: smallest, percentiles, largest.
//!
//! Histories of cases have their rows at these instants, and no others. A case that failed, or that ended before an instant, has no value there.

mod block;
mod told;

use mbd_runtime::scene::twelve_digits;
use mbd_runtime::{Content, Name, Trajectory};
use serde::{Deserialize, Serialize};

use crate::columns;
use crate::dispersion::WrittenEnvelopes;
use crate::results::CaseRow;
use crate::run::names::{column_name, wrong};
use crate::run::number::positive;
use crate::run::{CampaignMistakes, RunPlan};

pub use block::{CaseBlock, path};
pub use told::{Envelope, LINES, table, told};

/// The instants of a run where the file says nothing.
const INSTANTS: f64 = 100.0;
/// The most numbers that are kept of a case: 800 kB.
const NUMBERS: usize = 100_000;

/// The columns whose envelopes are told, and the instants k · `every`, k = 0 … `count` − 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Envelopes {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Their units.
    pub units: Vec<String>,
    /// The distance of the instants [s].
    pub every: f64,
    /// How many instants there are.
    pub count: usize,
}

impl Envelopes {
    /// As they are written, for a run as planned that comes to these models; `content` comes to hold the columns.
    ///
    /// # Errors
    /// The settings that cannot be used.
    pub(crate) fn new(
        written: &WrittenEnvelopes,
        (models, plan): (&columns::Models<'_>, &RunPlan),
        content: &mut Content,
    ) -> Result<Self, CampaignMistakes> {
        if written.columns.is_empty() {
            let text = "names no column: columns = [\"riser.tension\"]";
            return Err(wrong("envelopes.columns", text).into());
        }
        let mut mistakes = CampaignMistakes::default();
        let named = written.columns.iter().map(|column| column_name(column));
        let named: Vec<String> = named.collect();
        for (at, column) in written.columns.iter().enumerate() {
            let held = match named[..at].contains(&named[at]) {
                true => Err(wrong(
                    "envelopes.columns",
                    format!("`{column}` stands here twice"),
                )),
                false => columns::include(content, column, ("envelopes.columns", models)),
            };
            mistakes.note(held);
        }
        let every = match &written.every {
            Some(value) => mistakes.note(positive("envelopes.every", value, "s")),
            None => Some(plan.until / INSTANTS),
        };
        let every = mistakes.unless(every)?;
        // The end is an instant, whatever rounding makes of the quotient.
        let last = (plan.until / every * (1.0 + 1e-12)).floor();
        let numbers = (last + 1.0) * written.columns.len() as f64;
        if numbers > NUMBERS as f64 {
            let text = format!(
                "{} columns every {every} s are {numbers:.0} numbers of each case; at most {NUMBERS} are kept: write a longer distance",
                written.columns.len()
            );
            return Err(wrong("envelopes.every", text).into());
        }
        let known = columns::names(models, *content);
        let unit = |column: &String| {
            let found = known.iter().find(|it| it.name == *column);
            found.map_or(String::new(), |Name { unit, .. }| unit.clone())
        };
        Ok(Envelopes {
            units: named.iter().map(unit).collect(),
            columns: named,
            every,
            count: last as usize + 1,
        })
    }

    /// The instants [s].
    pub fn instants(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.count).map(|k| k as f64 * self.every)
    }

    /// What to say of instants that lie behind the end of all of these cases.
    #[must_use]
    pub fn beyond(&self, rows: &[CaseRow]) -> Option<String> {
        let ends = rows.iter().filter(|row| row.reached_end());
        let last = twelve_digits(ends.map(|row| row.time).reduce(f64::max)?);
        let mut instants = self.instants().map(twelve_digits);
        let first = instants.find(|instant| *instant > last);
        let empty = first.map(|first| {
            format!(
                "envelopes hold no case from {first} s on: the last of the runs ends at {last} s"
            )
        });
        let alone = (self.count == 1 && last > 0.0).then(|| {
            format!(
                "envelopes have no instant but the start: they are taken every {} s, and the last of the runs ends at {last} s; write a shorter `every` under [envelopes]",
                twelve_digits(self.every)
            )
        });
        alone.or(empty)
    }

    /// How many numbers there are of a case.
    #[must_use]
    pub fn numbers(&self) -> usize {
        self.columns.len() * self.count
    }

    /// The columns of a history at the instants, one column after the other; NaN beyond its ends.
    #[must_use]
    pub fn read(&self, history: &Trajectory) -> Vec<f64> {
        let mut numbers = Vec::with_capacity(self.numbers());
        for column in &self.columns {
            let values = history.column(column).unwrap_or(&[]);
            numbers.extend(
                self.instants()
                    .map(|at| value_at(history.times(), values, at)),
            );
        }
        numbers
    }

    /// A sentence on each of the columns that is a declared output and no finite number at an instant of a history.
    pub fn not_finite<'h>(&'h self, history: &'h Trajectory) -> impl Iterator<Item = String> + 'h {
        let all = history.not_finite().into_iter();
        let own = all.filter(|column| self.columns.iter().any(|own| own == column.name));
        own.map(|column| {
            format!(
                "`{}` is no finite number at {} of the instants of its envelope, from {} s on",
                column.name,
                column.rows,
                twelve_digits(column.time)
            )
        })
    }
}

/// The value of a column in the row at an instant, of several the last; NaN where there is none.
fn value_at(times: &[f64], values: &[f64], at: f64) -> f64 {
    // Instants are multiples of a distance, the last row is where the run ended.
    let near = 1e-12 * at.abs();
    let before = times
        .partition_point(|time| *time <= at + near)
        .checked_sub(1);
    let row = before.and_then(|k| Some((*times.get(k)?, *values.get(k)?)));
    row.filter(|(time, _)| *time >= at - near)
        .map_or(f64::NAN, |(_, value)| value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_the_value_of_the_last_row_at_an_instant_and_none_elsewhere() {
        let (times, values) = ([0.0, 1.0, 1.0, 3.0], [0.0, 2.0, 5.0, 6.0]);
        let at = |t: f64| value_at(&times, &values, t);
        // Where one part of a run follows another there are two rows.
        assert_eq!([0.0, 1.0, 3.0].map(at), [0.0, 5.0, 6.0]);
        assert!([-0.1, 0.5, 3.1].map(at).iter().all(|x| x.is_nan()));
        // 30 · 0.1 is a rounding error beyond 3.
        assert_eq!(at(30.0 * 0.1), 6.0);
        assert!(value_at(&[], &[], 0.0).is_nan());
    }
}
