//! From samples to a path: clipped, with gaps, decimated without losing an oscillation.
//!
//! Of all samples that fall into one pixel column the first, the lowest, the highest and the last are drawn, so a ripple of 212 Hz in a
//! picture of 70 s stays the band that it is, and the file stays small.

use std::collections::BTreeSet;

use super::axis::PlotAxis;
use super::number::pixel;

/// The rectangle of a plot and its axes.
pub(super) struct Panel<'a> {
    /// Width and height [px].
    pub size: [f64; 2],
    /// The horizontal axis.
    pub x: &'a PlotAxis,
    /// The vertical axis.
    pub y: &'a PlotAxis,
}

/// A drawn series.
#[derive(Debug, Default)]
pub(super) struct Trace {
    /// Data of the SVG path.
    pub path: String,
    /// The places of all samples [px], if there are few enough to mark each.
    pub marks: Vec<[f64; 2]>,
    /// Samples that cannot be drawn: not finite, or not positive on a logarithmic axis.
    pub missing: usize,
    /// Samples inside the plot.
    pub inside: usize,
    /// Samples above or below the plot, inside its horizontal window.
    pub beyond: usize,
}

/// Series with at most this many samples get a mark at each.
const MARKED: usize = 40;

/// Lines to samples far outside end here [px]; renderers keep few digits.
const FAR: f64 = 1e5;

impl Panel<'_> {
    /// The place of a sample [px].
    pub fn place(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        let (x, y) = (self.x.place(x)?, self.y.place(y)?);
        let right = x * self.size[0];
        let down = (1.0 - y) * self.size[1];
        Some([right.clamp(-FAR, FAR), down.clamp(-FAR, FAR)])
    }

    /// −1 left of the plot, 0 inside, 1 right of it (or above and below, on axis 1); a rounding error outside still counts as inside.
    fn side(&self, place: [f64; 2], axis: usize) -> i32 {
        let offset = place[axis];
        i32::from(offset > self.size[axis] + 1e-6) - i32::from(offset < -1e-6)
    }

    /// Draws a dot at each sample, of those in the same pixel one.
    pub fn dots(&self, samples: impl Iterator<Item = (f64, f64)>) -> Trace {
        let mut trace = Trace::default();
        let mut pixels = BTreeSet::new();
        for (x, y) in samples {
            let Some(place) = self.place(x, y) else {
                trace.missing += 1;
                continue;
            };
            let is_inside = self.side(place, 0) == 0 && self.side(place, 1) == 0;
            trace.inside += usize::from(is_inside);
            trace.beyond += usize::from(!is_inside);
            // Rounded as it is drawn.
            if is_inside && pixels.insert(place.map(|x| x.round() as i64)) {
                let [x, y] = place.map(|x| pixel(x.round()));
                trace.path += &format!("M{x} {y}h0");
            }
        }
        trace
    }

    /// Draws samples into a path. Where `period` is given, values that far apart are the same, and the line breaks where they jump by more than
    /// half of it.
    pub fn trace(&self, samples: impl Iterator<Item = (f64, f64)>, period: Option<f64>) -> Trace {
        let mut trace = Trace::default();
        let mut pen = Pen::default();
        let mut previous: Option<[f64; 2]> = None;
        let mut few = true;
        let mut before = f64::NAN;
        for (x, y) in samples {
            let place = self.place(x, y);
            if period.is_some_and(|period| (y - before).abs() > 0.5 * period) {
                pen.up();
                previous = None;
            }
            before = y;
            match (previous, place) {
                (_, None) => {
                    trace.missing += 1;
                    pen.up();
                }
                (None, Some(here)) => {
                    if self.side(here, 0) == 0 {
                        pen.move_to(here);
                    }
                }
                (Some(last), Some(here)) => {
                    let (from, to) = (self.side(last, 0), self.side(here, 0));
                    if from != 0 && from == to {
                        pen.up();
                    } else {
                        if !pen.down {
                            pen.move_to(last);
                        }
                        pen.line_to(here);
                    }
                }
            }
            if let Some(here) = place
                && self.side(here, 0) == 0
            {
                let inside = self.side(here, 1) == 0;
                trace.inside += usize::from(inside);
                trace.beyond += usize::from(!inside);
                few &= trace.inside + trace.beyond <= MARKED;
                if few && inside {
                    trace.marks.push(here);
                }
            }
            previous = place;
        }
        pen.up();
        if !few {
            trace.marks.clear();
        }
        trace.path = pen.text;
        trace
    }
}

/// The pen holds back what falls into one pixel column.
#[derive(Default)]
struct Pen {
    text: String,
    down: bool,
    drawn: Option<[String; 2]>,
    column: Option<PixelColumn>,
}

/// The samples of one pixel column that are worth drawing, with the order in which the extremes came.
struct PixelColumn {
    index: f64,
    count: usize,
    low: (usize, [f64; 2]),
    high: (usize, [f64; 2]),
    last: [f64; 2],
}

impl Pen {
    fn move_to(&mut self, place: [f64; 2]) {
        self.up();
        let [x, y] = place.map(pixel);
        self.text += &format!("M{x} {y}");
        // A dot, if nothing follows: a line of length zero has round ends.
        self.drawn = None;
        self.down = true;
        self.column = Some(PixelColumn::new(place));
    }

    fn line_to(&mut self, place: [f64; 2]) {
        match &mut self.column {
            Some(column) if column.index == place[0].floor() => column.add(place),
            _ => {
                self.flush();
                self.column = Some(PixelColumn::new(place));
            }
        }
    }

    fn up(&mut self) {
        self.flush();
        self.down = false;
    }

    fn flush(&mut self) {
        let Some(column) = self.column.take() else {
            return;
        };
        for place in column.worth_drawing() {
            let place = place.map(pixel);
            if self.drawn.as_ref() != Some(&place) {
                self.text += &format!(" {} {}", place[0], place[1]);
                self.drawn = Some(place);
            }
        }
    }
}

impl PixelColumn {
    fn new(place: [f64; 2]) -> PixelColumn {
        PixelColumn {
            index: place[0].floor(),
            count: 1,
            low: (0, place),
            high: (0, place),
            last: place,
        }
    }

    fn add(&mut self, place: [f64; 2]) {
        if place[1] > self.low.1[1] {
            self.low = (self.count, place);
        }
        if place[1] < self.high.1[1] {
            self.high = (self.count, place);
        }
        self.last = place;
        self.count += 1;
    }

    fn worth_drawing(&self) -> [[f64; 2]; 3] {
        let (first, second) = if self.low.0 <= self.high.0 {
            (self.low.1, self.high.1)
        } else {
            (self.high.1, self.low.1)
        };
        [first, second, self.last]
    }
}

#[cfg(test)]
mod tests {
    use super::super::axis::{RangeChoice, Scale};
    use super::*;

    /// On a panel of 100 × 100 pixels, x from 0 to 10, y from 0 to 1.
    fn on_panel(draw: impl FnOnce(&Panel<'_>) -> Trace) -> Trace {
        let x = PlotAxis::new(RangeChoice::Fixed(0.0, 10.0), Scale::Linear, 5);
        let y = PlotAxis::new(RangeChoice::Fixed(0.0, 1.0), Scale::Linear, 5);
        draw(&Panel {
            size: [100.0, 100.0],
            x: &x,
            y: &y,
        })
    }

    fn draw(samples: &[(f64, f64)]) -> Trace {
        on_panel(|panel| panel.trace(samples.iter().copied(), None))
    }

    fn heights(trace: &Trace) -> Vec<f64> {
        let numbers: Vec<f64> = trace
            .path
            .replace('M', " ")
            .split_whitespace()
            .map(|n| n.parse().unwrap())
            .collect();
        numbers.iter().skip(1).step_by(2).copied().collect()
    }

    #[test]
    fn a_fast_oscillation_keeps_its_full_height_in_every_column() {
        let samples: Vec<(f64, f64)> = (0..100_000)
            .map(|k| {
                let t = f64::from(k) * 1e-4;
                (t, 0.5 + 0.4 * (t * 1332.0).sin())
            })
            .collect();
        let trace = draw(&samples);
        let heights = heights(&trace);
        assert!(heights.len() < 450, "{}", heights.len());
        assert!(heights.iter().any(|&y| y < 10.3) && heights.iter().any(|&y| y > 89.7));
    }

    #[test]
    fn one_high_sample_among_thousands_is_drawn() {
        let samples: Vec<(f64, f64)> = (0..10_000)
            .map(|k| (f64::from(k) * 1e-3, f64::from(u8::from(k == 4321))))
            .collect();
        assert!(heights(&draw(&samples)).contains(&0.0));
    }

    #[test]
    fn a_dot_is_drawn_once_a_pixel_and_every_sample_is_counted() {
        let samples = [
            (1.0, 0.5),
            (1.01, 0.501),
            (5.0, 0.2),
            (20.0, 0.5),
            (f64::NAN, 0.1),
        ];
        let trace = on_panel(|panel| panel.dots(samples.into_iter()));
        assert_eq!(trace.path, "M10 50h0M50 80h0");
        assert_eq!((trace.inside, trace.beyond, trace.missing), (3, 1, 1));
    }

    #[test]
    fn a_sample_that_is_not_finite_breaks_the_line() {
        let trace = draw(&[
            (1.0, 0.1),
            (2.0, 0.2),
            (3.0, f64::NAN),
            (4.0, 0.4),
            (5.0, 0.5),
        ]);
        assert_eq!(trace.path.matches('M').count(), 2);
        assert_eq!((trace.missing, trace.inside), (1, 4));
    }

    #[test]
    fn an_angle_that_wraps_has_no_line_across_the_plot() {
        let samples = [(1.0, 0.7), (2.0, 0.95), (3.0, 0.05), (4.0, 0.3)];
        let trace = on_panel(|panel| panel.trace(samples.into_iter(), Some(1.0)));
        assert_eq!(trace.path, "M10 30 10 30 20 5M30 95 30 95 40 70");
        assert_eq!((trace.missing, trace.inside), (0, 4));
    }

    #[test]
    fn a_line_enters_and_leaves_the_window() {
        let trace = draw(&[
            (-2.0, 0.5),
            (-1.0, 0.5),
            (1.0, 0.5),
            (11.0, 0.5),
            (12.0, 0.5),
        ]);
        assert_eq!(trace.path, "M-10 50 -10 50 10 50 110 50");
        assert_eq!(trace.inside, 1);
        let across = draw(&[(-1.0, 0.0), (11.0, 1.0)]);
        assert_eq!(across.path, "M-10 100 -10 100 110 0");
    }

    #[test]
    fn a_diverged_sample_is_drawn_far_away_and_counted() {
        let trace = draw(&[(1.0, 0.5), (2.0, 1e250), (3.0, f64::INFINITY)]);
        assert_eq!((trace.beyond, trace.missing), (1, 1));
        assert!(trace.path.contains("-100000"));
    }
}
