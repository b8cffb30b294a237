//! Line plots: what is drawn, and where each part of the drawing goes.

use super::axis::{HUGE, PlotAxis, RangeChoice, Scale};
use super::band::Band;
use super::drawing::{axis, fitted};
use super::live::{PlotNumbers, SeriesNumbers};
use super::look::Look;
use super::packing::PackedArray;
use super::plot::{
    LegendEntry, Plot, RIGHT, SAMPLE, SMALL, TEXT, WIDTH, draw_grid, label, left_margin,
    with_exponent,
};
use super::series::Series;
use super::svg::{Svg, TextAnchor};
use super::thin::curve_rows;
use super::trace::{Panel, Trace};

/// A line plot.
///
/// Numbers that are not finite (and numbers ≤ 0 on a logarithmic axis) make a gap, and a note under the plot says how many.
///
/// ```
/// use mbd_report::{Figure, Series};
/// let (t, f) = ([0.0, 1.0, 2.0], [0.0, 37.6, 30.6]);
/// let svg = Figure::new("Riser force").x("time", "s").y("force", "N").series(Series::new("node", &t, &f)).svg();
/// assert!(svg.starts_with("<svg"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Figure<'a> {
    title: String,
    caption: String,
    labels: [String; 2],
    scales: [Scale; 2],
    windows: [Option<(f64, f64)>; 2],
    series: Vec<Series<'a>>,
    bands: Vec<Band<'a>>,
    levels: Vec<(String, f64)>,
    equal: bool,
}

const HEIGHT: f64 = 320.0;
/// The numbers of a figure inside a page take at most about this much [bytes], and a curve is that of so many rows.
const CURVE_BYTES: usize = 160_000;
const MOST: usize = 6000;

impl<'a> Figure<'a> {
    /// An empty figure.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Figure {
            title: title.into(),
            ..Figure::default()
        }
    }

    /// Names the horizontal axis; the unit may be empty.
    #[must_use]
    pub fn x(mut self, name: &str, unit: &str) -> Self {
        self.labels[0] = label(name, unit);
        self
    }

    /// Names the vertical axis; the unit may be empty.
    #[must_use]
    pub fn y(mut self, name: &str, unit: &str) -> Self {
        self.labels[1] = label(name, unit);
        self
    }

    /// Makes the horizontal axis logarithmic; it spans whole decades.
    #[must_use]
    pub fn log_x(mut self) -> Self {
        self.scales[0] = Scale::Log;
        self
    }

    /// Makes the vertical axis logarithmic; it spans whole decades.
    #[must_use]
    pub fn log_y(mut self) -> Self {
        self.scales[1] = Scale::Log;
        self
    }

    /// Shows x from `low` to `high` only; the vertical axis follows what is inside.
    #[must_use]
    pub fn window(mut self, low: f64, high: f64) -> Self {
        self.windows[0] = Some((low, high));
        self
    }

    /// Shows y from `low` to `high` only; a note says when a curve leaves it.
    #[must_use]
    pub fn y_window(mut self, low: f64, high: f64) -> Self {
        self.windows[1] = Some((low, high));
        self
    }

    /// Adds a curve; later ones lie on top.
    #[must_use]
    pub fn series(mut self, series: Series<'a>) -> Self {
        self.series.push(series);
        self
    }

    /// Adds the area between two curves over the same x, under all curves; later ones lie on top, `shade` from 0, the lightest, to 2.
    #[must_use]
    pub fn band(
        mut self,
        name: impl Into<String>,
        x: &'a [f64],
        [low, high]: [&'a [f64]; 2],
        shade: usize,
    ) -> Self {
        self.bands.push(Band {
            name: name.into(),
            x,
            ends: [low, high],
            shade,
        });
        self
    }

    /// Draws both axes to one scale: a metre is as long across as upwards. Windows and logarithmic axes have no say then.
    #[must_use]
    pub fn equal(mut self) -> Self {
        self.equal = true;
        self
    }

    /// Adds a thin horizontal line with a name, for a weight or a limit.
    #[must_use]
    pub fn level(mut self, name: impl Into<String>, value: f64) -> Self {
        self.levels.push((name.into(), value));
        self
    }

    /// The text under the figure.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// The title.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The caption.
    #[must_use]
    pub fn caption_text(&self) -> &str {
        &self.caption
    }

    /// The figure as a file of its own, title and caption included.
    #[must_use]
    pub fn svg(&self) -> String {
        self.drawn(|plot| plot.file())
    }

    /// The figure as a part of a page; `number` tells the page's numbers of this figure.
    pub(super) fn part(&self, number: Option<usize>) -> String {
        self.drawn(|plot| plot.part(number))
    }

    /// Its numbers, thinned, for a page that has a player; `None` of a figure that is not over time.
    pub(super) fn numbers(&self) -> Option<PlotNumbers> {
        let still = !self.bands.is_empty() || self.series.iter().any(|series| series.dots);
        if self.labels[0] != label("time", "s") || self.scales[0] != Scale::Linear || still {
            return None;
        }
        let most = (CURVE_BYTES / 8 / self.series.len().max(1)).min(MOST);
        let series = self.series.iter().map(|series| {
            let rows = curve_rows(series.x, series.y, most);
            let base = series.y.iter().copied().find(|y| y.is_finite());
            let base = base.unwrap_or(0.0);
            SeriesNumbers {
                t: PackedArray::floats(rows.iter().map(|row| series.x[*row])),
                base,
                v: PackedArray::floats(rows.iter().map(|row| series.y[*row] - base)),
                wrap: series.period,
            }
        });
        let [low, high] = PlotAxis::new(self.range(0), self.scales[0], 8).ends();
        Some(PlotNumbers {
            x: [low, high],
            log: self.scales[1] == Scale::Log,
            series: series.collect(),
        })
    }

    fn drawn(&self, finish: impl FnOnce(&Plot<'_>) -> String) -> String {
        let ([x, y], left, size) = match self.equal {
            true => self.equal_axes(),
            false => self.own_axes(),
        };
        let panel = Panel { size, x: &x, y: &y };
        let traces = self.series.iter().map(|series| series.trace(&panel));
        let traces: Vec<Trace> = traces.collect();
        let mut svg = Svg::content();
        draw_grid(&mut svg, &panel);
        self.draw_curves(&mut svg, &panel, &traces);
        finish(&Plot {
            title: &self.title,
            caption: &self.caption,
            labels: [
                with_exponent(&self.labels[0], x.exponent),
                with_exponent(&self.labels[1], y.exponent),
            ],
            legend: self.legend(&traces),
            content: svg.markup(),
            left,
            size: panel.size,
            equal: self.equal,
            notes: self.notes(&traces),
        })
    }

    /// Axes that follow their own numbers, the room left of the panel, and its size [px].
    fn own_axes(&self) -> ([PlotAxis; 2], f64, [f64; 2]) {
        let x = PlotAxis::new(self.range(0), self.scales[0], 8);
        let y = PlotAxis::new(self.range(1), self.scales[1], 6);
        let left = left_margin(&y);
        ([x, y], left, [WIDTH - RIGHT - left, HEIGHT])
    }

    /// The same with one scale on both axes.
    fn equal_axes(&self) -> ([PlotAxis; 2], f64, [f64; 2]) {
        let mut bounds: Option<[[f64; 2]; 2]> = None;
        let drawable = |(x, y): &(f64, f64)| x.abs() <= HUGE && y.abs() <= HUGE;
        for (x, y) in self.samples().filter(drawable) {
            let [across, up] = bounds.get_or_insert([[x; 2], [y; 2]]);
            *across = [across[0].min(x), across[1].max(x)];
            *up = [up[0].min(y), up[1].max(y)];
        }
        let bounds = bounds.unwrap_or([[-0.5, 0.5]; 2]);
        // The margin depends on the labels, which depend on the range: the first guess of the range is close enough for it.
        let left = left_margin(&axis(bounds[1], HEIGHT));
        let ([across, up], size) = fitted(bounds, WIDTH - RIGHT - left);
        ([axis(across, size[0]), axis(up, size[1])], left, size)
    }

    /// All places that are drawn.
    fn samples(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let curves = self.series.iter().flat_map(Series::samples);
        curves.chain(self.bands.iter().flat_map(Band::samples))
    }

    /// The range of one axis: the window, or the data inside the other axis's window.
    fn range(&self, axis: usize) -> RangeChoice {
        if let Some((low, high)) = self.windows[axis]
            && low.is_finite()
            && high.is_finite()
        {
            return RangeChoice::Fixed(low, high);
        }
        let drawable = |v: f64, axis: usize| {
            v.abs() <= HUGE && (v > 0.0 || self.scales[axis] == Scale::Linear)
        };
        let seen = |other: f64| {
            axis == 0 || self.windows[0].is_none_or(|(a, b)| (a.min(b)..=a.max(b)).contains(&other))
        };
        let mut ends: Option<(f64, f64)> = None;
        let mut include = |value: f64| {
            let (low, high) = ends.unwrap_or((value, value));
            ends = Some((low.min(value), high.max(value)));
        };
        for (x, y) in self.samples() {
            let (value, other) = if axis == 0 { (x, y) } else { (y, x) };
            if drawable(value, axis) && drawable(other, 1 - axis) && seen(other) {
                include(value);
            }
        }
        if axis == 1 {
            for &(_, level) in self.levels.iter().filter(|level| drawable(level.1, 1)) {
                include(level);
            }
        }
        match (ends, axis, self.scales[axis]) {
            (Some((low, high)), 0, Scale::Linear) => RangeChoice::JointForces(low, high),
            (Some((low, high)), ..) => RangeChoice::Around(low, high),
            (None, _, Scale::Linear) => RangeChoice::Fixed(0.0, 1.0),
            (None, _, Scale::Log) => RangeChoice::Fixed(0.1, 10.0),
        }
    }

    fn look(&self, index: usize) -> Look {
        self.series
            .get(index)
            .and_then(|series| series.look)
            .unwrap_or_else(|| match self.series.len() {
                1 => Look::Thin,
                _ => Look::of(index),
            })
    }

    fn legend(&self, traces: &[Trace]) -> Vec<LegendEntry> {
        let middle = 0.5 * SAMPLE[1];
        let entry = |(index, (series, trace)): (usize, (&Series<'_>, &Trace))| {
            let mut sample = Svg::content();
            let class = self.class(index);
            match series.dots {
                true => sample.path(&class, &format!("M{} {middle}h0", 0.5 * SAMPLE[0])),
                false => sample.line(&class, [0.0, middle], [SAMPLE[0], middle]),
            }
            if !trace.marks.is_empty() {
                sample.mark([0.5, 0.5], &self.mark_class(index), mark(index));
            }
            LegendEntry {
                sample: sample.markup(),
                name: series.name.clone(),
            }
        };
        let bands = self.bands.iter().map(|band| LegendEntry {
            sample: band.sample(),
            name: band.name.clone(),
        });
        let all = self.series.iter().zip(traces).enumerate();
        bands.chain(all.map(entry)).collect()
    }

    /// The style classes of a series.
    fn class(&self, index: usize) -> String {
        let dots = self.series.get(index).is_some_and(|series| series.dots);
        let dots = if dots { " mbd-dots" } else { "" };
        format!("mbd-series {}{dots}", self.look(index).class())
    }

    fn draw_curves(&self, svg: &mut Svg, panel: &Panel, traces: &[Trace]) {
        // A curve that just touches an edge is not cut in half there.
        let spill = if self.windows[1].is_some() { 0.0 } else { 2.0 };
        svg.stretch(panel.size, spill);
        for band in &self.bands {
            svg.path(&band.class(), &band.path(panel));
        }
        for (index, trace) in traces.iter().enumerate() {
            svg.path(&self.class(index), &trace.path);
        }
        svg.unstretch();
        for (name, value) in &self.levels {
            if let Some(place) = panel.y.place(*value)
                && (0.0..=1.0).contains(&place)
            {
                svg.level("mbd-level", place);
                // Above the line, unless it would be cut there.
                let lift = if place > 0.94 { SMALL + 3.0 } else { -4.0 };
                let at = ([0.0, place], [6.0, lift]);
                svg.beside(" mbd-halo", at, SMALL, TextAnchor::Start, name);
            }
        }
        if self.bands.is_empty() && traces.iter().all(|trace| trace.path.is_empty()) {
            let middle = ([0.5, 0.5], [0.0, 0.0]);
            svg.beside("", middle, TEXT, TextAnchor::Middle, "nothing to draw here");
        }
        svg.border("mbd-frame");
        let [width, height] = panel.size;
        svg.group("mbd-marks");
        for (index, trace) in traces.iter().enumerate() {
            for &[x, y] in &trace.marks {
                let at = [x / width, 1.0 - y / height];
                svg.mark(at, &self.mark_class(index), mark(index));
            }
        }
        svg.ungroup();
    }

    fn mark_class(&self, index: usize) -> String {
        format!("{}-mark", self.look(index).class())
    }

    /// What could not be drawn.
    fn notes(&self, traces: &[Trace]) -> Vec<String> {
        let mut notes = Vec::new();
        for (series, trace) in self.series.iter().zip(traces) {
            let mut note = |text: String| notes.push(format!("{}: {text}", series.name));
            if series.samples().next().is_none() {
                note("no samples".to_string());
            }
            if trace.missing > 0 {
                note(format!("{} cannot be drawn", samples(trace.missing)));
            }
            if trace.beyond > 0 {
                note(format!(
                    "{} above or below this plot",
                    samples(trace.beyond)
                ));
            }
        }
        notes
    }
}

/// The polygon of the mark of a series: square, triangle, diamond, triangle on its point.
fn mark(index: usize) -> &'static str {
    match index % 4 {
        0 => "M-3.2 -3.2 3.2 -3.2 3.2 3.2 -3.2 3.2Z",
        1 => "M0 -4.3 4 2.9 -4 2.9Z",
        2 => "M0 -4.7 4 0 0 4.7 -4 0Z",
        _ => "M0 4.3 4 -2.9 -4 -2.9Z",
    }
}

fn samples(count: usize) -> String {
    match count {
        1 => "1 sample".to_string(),
        count => format!("{count} samples"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minute_of_ripple_makes_a_small_picture_twice_the_same() {
        let t: Vec<f64> = (0..700_000).map(|k| f64::from(k) * 1e-4).collect();
        let f: Vec<f64> = t
            .iter()
            .map(|t| 2810.0 * (t / 19.0).tanh() + 30.0 * (t * 1332.0).sin())
            .collect();
        let draw = || {
            Figure::new("Riser force")
                .x("time", "s")
                .y("force", "N")
                .series(Series::new("mass", &t, &f))
                .series(Series::new("node", &t, &f))
                .svg()
        };
        let svg = draw();
        assert!(svg.len() < 300_000, "{}", svg.len());
        assert_eq!(svg, draw());
    }

    #[test]
    fn what_cannot_be_drawn_is_said_under_the_picture() {
        let (t, f) = ([0.0, 1.0, 2.0, 3.0], [1.0, f64::NAN, 1e9, 2.0]);
        let svg = Figure::new("f")
            .y_window(0.0, 5.0)
            .series(Series::new("broken", &t, &f))
            .series(Series::new("none", &[], &[]))
            .svg();
        assert!(svg.contains("broken: 1 sample cannot be drawn"));
        assert!(svg.contains("broken: 1 sample above or below this plot"));
        assert!(svg.contains("none: no samples"));
    }

    #[test]
    fn a_figure_without_anything_is_still_a_figure() {
        for figure in [
            Figure::new(""),
            Figure::new("x").log_x().log_y(),
            Figure::new("x").window(1.0, 1.0).y_window(f64::NAN, 0.0),
            Figure::new("x").series(Series::new("s", &[f64::NAN], &[f64::INFINITY])),
        ] {
            let svg = figure.svg();
            assert!(svg.contains("nothing to draw here") && !svg.contains("NaN"));
        }
    }

    #[test]
    fn the_vertical_axis_follows_what_the_window_shows() {
        let (t, f) = ([0.0, 1.0, 2.0, 70.0], [0.0, 37.6, 30.6, 2810.0]);
        let figure = Figure::new("f").series(Series::new("node", &t, &f));
        assert!(figure.svg().contains(">3000<"));
        let start = figure.window(0.0, 2.0).svg();
        assert!(!start.contains(">3000<") && start.contains(">40<"));
    }
}
