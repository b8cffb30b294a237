//! Envelopes over time.

use mbd_report::{Figure, Look, Series};

use crate::envelopes::Envelope;
use crate::table::counted;

/// The bands: the first of its lines below and the one above, with what lies between.
const BANDS: [([usize; 2], &str); 3] = [
    ([0, 6], "smallest to largest"),
    ([1, 5], "1 % to 99 %"),
    ([2, 4], "5 % to 95 %"),
];
/// The median among its lines.
const MEDIAN: usize = 3;

/// The figure of an envelope.
pub fn figure(envelope: &Envelope) -> Figure<'_> {
    let ends = |rows: &[u64]| (rows.first().copied(), rows.last().copied());
    let (first, last) = ends(&envelope.cases);
    let (first, last) = (first.unwrap_or(0), last.unwrap_or(0));
    let cases = match first == last {
        true => counted(first, "case"),
        false => format!("{} at the start, {last} at the end", counted(first, "case")),
    };
    let mut figure = Figure::new(format!("{} over time", envelope.name))
        .x("time", "s")
        .y(&envelope.name, &envelope.unit)
        .caption(format!(
            "Smallest, largest and percentiles of {cases}, at each instant by themselves: no single case need run along a line. Cases that failed are \
             left out, others where they have ended."
        ));
    for (shade, ([low, high], name)) in BANDS.into_iter().enumerate() {
        let ends = [low, high].map(|line| envelope.lines[line].as_slice());
        figure = figure.band(name, &envelope.times, ends, shade);
    }
    figure
        .series(
            Series::new("median", &envelope.times, &envelope.lines[MEDIAN]).look(Look::ShortDash),
        )
        .series(Series::new("nominal case", &envelope.times, &envelope.nominal).look(Look::Thin))
}
