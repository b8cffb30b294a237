//! Line plots: what is drawn, and where each part of the drawing goes.

use super::axis::{Axis, HUGE, Range, Scale};
use super::frame::{
    LINE, RIGHT, SMALL, TEXT, TITLE, WIDTH, draw_axes, label, left_margin, legend_rows, open,
    title_rows, write_under,
};
use super::look::Look;
use super::svg::{Anchor, Svg, wrap};
use super::trace::{Panel, Trace};

/// One curve: pairs of x and y in drawing order, of equal length (a longer one is cut).
#[derive(Clone, Debug)]
pub struct Series<'a> {
    name: String,
    x: &'a [f64],
    y: &'a [f64],
    look: Option<Look>,
}

impl<'a> Series<'a> {
    /// A curve with its name in the legend.
    #[must_use]
    pub fn new(name: impl Into<String>, x: &'a [f64], y: &'a [f64]) -> Self {
        Series {
            name: name.into(),
            x,
            y,
            look: None,
        }
    }

    /// Chooses the look; otherwise the figure hands them out in the order of [`Look::ALL`].
    #[must_use]
    pub fn look(mut self, look: Look) -> Self {
        self.look = Some(look);
        self
    }

    fn samples(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.x.iter().copied().zip(self.y.iter().copied())
    }
}

/// A line plot.
///
/// Numbers that are not finite (and numbers ≤ 0 on a logarithmic axis) make a gap, and a note under the plot says how many.
///
/// ```
/// use models::report::{Figure, Series};
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
    levels: Vec<(String, f64)>,
}

const HEIGHT: f64 = 320.0;

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
        self.draw(true)
    }

    /// The figure without caption and style sheet, to stand inside an HTML page that has both.
    pub(super) fn inline(&self) -> String {
        self.draw(false)
    }

    fn draw(&self, alone: bool) -> String {
        let x = Axis::new(self.range(0), self.scales[0], 8);
        let y = Axis::new(self.range(1), self.scales[1], 6);
        let title = title_rows(&self.title);
        let names = self.series.iter().map(|series| series.name.as_str());
        let legend = legend_rows(names, left_margin(&y));
        let top = 8.0 + 1.3 * TITLE * title.len() as f64 + LINE * legend.len() as f64 + 12.0;
        let left = left_margin(&y);
        let panel = Panel {
            at: [left, top],
            size: [WIDTH - RIGHT - left, HEIGHT],
            x: &x,
            y: &y,
        };
        let traces: Vec<Trace> = self
            .series
            .iter()
            .map(|series| panel.trace(series.samples()))
            .collect();
        let under = self.words_under(&traces, alone);
        let bottom = top + HEIGHT + 48.0;
        let height = bottom + LINE * under.len() as f64;
        let mut svg = open(height, left, &self.title, &self.caption, alone);
        self.draw_legend(
            &mut svg,
            &legend,
            top - 12.0 - LINE * legend.len() as f64,
            &traces,
        );
        draw_axes(&mut svg, &panel, &self.labels);
        self.draw_curves(&mut svg, &panel, &traces);
        write_under(&mut svg, &under, left, bottom);
        svg.close()
    }

    /// The range of one axis: the window, or the data inside the other axis's window.
    fn range(&self, axis: usize) -> Range {
        if let Some((low, high)) = self.windows[axis]
            && low.is_finite()
            && high.is_finite()
        {
            return Range::Fixed(low, high);
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
        for (x, y) in self.series.iter().flat_map(Series::samples) {
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
            (Some((low, high)), 0, Scale::Linear) => Range::JointForces(low, high),
            (Some((low, high)), ..) => Range::Around(low, high),
            (None, _, Scale::Linear) => Range::Fixed(0.0, 1.0),
            (None, _, Scale::Log) => Range::Fixed(0.1, 10.0),
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

    fn draw_legend(&self, svg: &mut Svg, rows: &[Vec<(usize, f64)>], top: f64, traces: &[Trace]) {
        let marked: Vec<bool> = traces.iter().map(|trace| !trace.marks.is_empty()).collect();
        for (row, entries) in rows.iter().enumerate() {
            let middle = top + LINE * (row as f64 + 0.5);
            for &(index, left) in entries {
                let class = format!("mbd-series {}", self.look(index).class());
                svg.line(&class, [left, middle], [left + 36.0, middle]);
                if marked[index] {
                    self.draw_mark(svg, index, [left + 18.0, middle]);
                }
                let name = &self.series[index].name;
                let at = [left + 43.0, middle + 0.35 * TEXT];
                svg.text("", at, TEXT, Anchor::Start, false, name);
            }
        }
    }

    fn draw_curves(&self, svg: &mut Svg, panel: &Panel, traces: &[Trace]) {
        let ([left, top], [width, height]) = (panel.at, panel.size);
        // A curve that just touches an edge is not cut in half there.
        let spill = if self.windows[1].is_some() { 0.0 } else { 2.0 };
        svg.clip([left, top - spill], [width, height + 2.0 * spill]);
        for (index, trace) in traces.iter().enumerate() {
            svg.path(
                &format!("mbd-series {}", self.look(index).class()),
                &trace.path,
            );
        }
        for (name, value) in &self.levels {
            if let Some(place) = panel.y.place(*value)
                && (0.0..=1.0).contains(&place)
            {
                let down = top + (1.0 - place) * height;
                svg.line("mbd-level", [left, down], [left + width, down]);
                // Above the line, unless it would be cut there.
                let lift = if place > 0.94 { SMALL + 3.0 } else { -4.0 };
                let at = [left + 6.0, down + lift];
                svg.text(" mbd-halo", at, SMALL, Anchor::Start, false, name);
            }
        }
        svg.unclip();
        if traces.iter().all(|trace| trace.path.is_empty()) {
            let middle = [left + 0.5 * width, top + 0.5 * height];
            svg.text(
                "",
                middle,
                TEXT,
                Anchor::Middle,
                false,
                "nothing to draw here",
            );
        }
        svg.rect("mbd-frame", panel.at, panel.size);
        for (index, trace) in traces.iter().enumerate() {
            for &mark in &trace.marks {
                self.draw_mark(svg, index, mark);
            }
        }
    }

    fn draw_mark(&self, svg: &mut Svg, index: usize, [x, y]: [f64; 2]) {
        let class = format!("{}-mark", self.look(index).class());
        let r = 3.6;
        let corners: &[[f64; 2]] = match index % 4 {
            0 => &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
            1 => &[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]],
            2 => &[[0.0, -1.3], [1.1, 0.0], [0.0, 1.3], [-1.1, 0.0]],
            _ => &[[0.0, 1.2], [1.1, -0.8], [-1.1, -0.8]],
        };
        let mut data = String::new();
        for (k, [dx, dy]) in corners.iter().enumerate() {
            let word = if k == 0 { "M" } else { " " };
            let [px, py] = [x + r * dx, y + r * dy].map(super::number::pixel);
            data += &format!("{word}{px} {py}");
        }
        svg.path(&class, &format!("{data}Z"));
    }

    /// Notes on what could not be drawn, then the caption.
    fn words_under(&self, traces: &[Trace], with_caption: bool) -> Vec<String> {
        let mut lines = Vec::new();
        for (series, trace) in self.series.iter().zip(traces) {
            let mut note = |text: String| {
                let text = format!("{}: {text}", series.name);
                lines.extend(wrap(&text, SMALL, WIDTH - 2.0 * RIGHT - 40.0));
            };
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
        if with_caption {
            lines.extend(wrap(&self.caption, SMALL, WIDTH - 2.0 * RIGHT - 40.0));
        }
        lines
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
