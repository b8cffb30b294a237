//! Line drawings of a mechanism: bodies, lines, joints and paths in one plane, equal scales on both axes.

use super::axis::{PlotAxis, RangeChoice, Scale};
use super::look::Look;
use super::plot::{
    LegendEntry, Plot, RIGHT, SAMPLE, WIDTH, draw_grid, label, left_margin, with_exponent,
};
use super::svg::Svg;
use super::trace::Panel;

/// A place in the plane of the drawing: right and up.
type PagePoint = [f64; 2];

/// One part of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub enum DrawingPart {
    /// A rigid body: the convex hull of these places; a line for two, a square mark for one.
    Body(Vec<PagePoint>),
    /// A solid: the convex hull of these places, and the rims of what is flat and looks at the reader.
    Solid {
        /// Places whose convex hull is filled.
        silhouette: Vec<PagePoint>,
        /// Closed lines on it.
        rims: Vec<Vec<PagePoint>>,
    },
    /// A line between two places, slack or taut.
    Line([PagePoint; 2], bool),
    /// The way between the two places of a joint that slides.
    Rail([PagePoint; 2]),
    /// A joint between two bodies.
    Joint(PagePoint),
    /// A joint, or the end of a line, fixed in the world.
    Pivot(PagePoint),
    /// A point, with or without mass.
    Point(PagePoint),
}

impl DrawingPart {
    fn places(&self) -> &[PagePoint] {
        match self {
            DrawingPart::Body(places)
            | DrawingPart::Solid {
                silhouette: places, ..
            } => places,
            DrawingPart::Line(ends, _) | DrawingPart::Rail(ends) => ends,
            DrawingPart::Joint(at) | DrawingPart::Pivot(at) | DrawingPart::Point(at) => {
                std::slice::from_ref(at)
            }
        }
    }

    /// The same kind of shape in the legend, and what it stands for.
    fn explained(&self) -> (DrawingPart, &'static str) {
        let middle = 0.5 * SAMPLE[1];
        let ends = [[0.0, middle], [SAMPLE[0], middle]];
        let at = [0.5 * SAMPLE[0], middle];
        match self {
            DrawingPart::Body(places) if places.len() == 1 => (DrawingPart::Body(vec![at]), "body"),
            DrawingPart::Body(_) | DrawingPart::Solid { .. } => {
                (DrawingPart::Body(ends.to_vec()), "body")
            }
            DrawingPart::Line(_, true) => (DrawingPart::Line(ends, true), "slack line"),
            DrawingPart::Line(_, false) => (DrawingPart::Line(ends, false), "line"),
            DrawingPart::Rail(_) => (DrawingPart::Rail(ends), "between the places of a joint"),
            DrawingPart::Joint(_) => (DrawingPart::Joint(at), "joint or knot"),
            DrawingPart::Pivot(_) => (DrawingPart::Pivot([at[0], 4.0]), "held by the world"),
            DrawingPart::Point(_) => (DrawingPart::Point(at), "point with mass"),
        }
    }

    /// Later ones lie on top.
    fn layer(&self) -> usize {
        match self {
            DrawingPart::Body(_) | DrawingPart::Solid { .. } => 0,
            DrawingPart::Line(..) | DrawingPart::Rail(_) => 1,
            DrawingPart::Pivot(_) => 2,
            DrawingPart::Joint(_) | DrawingPart::Point(_) => 3,
        }
    }
}

/// A mechanism at one or more instants, later ones darker, and the paths of named points.
///
/// ```
/// use mbd_report::{Drawing, DrawingPart};
/// let svg = Drawing::new("Pendulum", ["x", "z"])
///     .instant([DrawingPart::Body(vec![[0.0, 0.0], [0.3, -0.4]]), DrawingPart::Pivot([0.0, 0.0])])
///     .svg();
/// assert!(svg.starts_with("<svg"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    title: String,
    caption: String,
    labels: [String; 2],
    instants: Vec<Vec<DrawingPart>>,
    paths: Vec<(String, Vec<PagePoint>)>,
}

/// The panel is no higher and no lower than this [px].
const HEIGHTS: [f64; 2] = [150.0, 540.0];
/// The panel is no narrower than this [px].
const NARROWEST: f64 = 230.0;
/// Half the size of the mark of a body that is one place [px].
const MARK: f64 = 6.0;

impl Drawing {
    /// An empty drawing; its axes measure metres.
    #[must_use]
    pub fn new(title: impl Into<String>, axes: [&str; 2]) -> Self {
        Drawing {
            title: title.into(),
            labels: axes.map(|name| label(name, "m")),
            ..Drawing::default()
        }
    }

    /// Adds the mechanism at one instant.
    #[must_use]
    pub fn instant(mut self, shapes: impl IntoIterator<Item = DrawingPart>) -> Self {
        self.instants.push(shapes.into_iter().collect());
        self
    }

    /// Adds the path of a point, with its name in the legend.
    #[must_use]
    pub fn path(mut self, name: impl Into<String>, places: Vec<PagePoint>) -> Self {
        self.paths.push((name.into(), places));
        self
    }

    /// The same with a label before its title.
    #[must_use]
    pub(super) fn labelled(mut self, label: &str) -> Self {
        self.title = format!("{label}: {}", self.title);
        self
    }

    /// The text under the drawing.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// The caption.
    #[must_use]
    pub fn caption_text(&self) -> &str {
        &self.caption
    }

    /// The drawing as a file of its own, title and caption included.
    #[must_use]
    pub fn svg(&self) -> String {
        self.drawn(|plot| plot.file())
    }

    /// The drawing as a part of a page.
    pub(super) fn part(&self) -> String {
        self.drawn(|plot| plot.part(None))
    }

    fn drawn(&self, finish: impl FnOnce(&Plot<'_>) -> String) -> String {
        let bounds = self.bounds();
        // The margin depends on the labels, which depend on the range: the first guess of the range is close enough for it.
        let left = left_margin(&axis(bounds[1], 300.0));
        let (ranges, size) = fitted(bounds, WIDTH - RIGHT - left);
        let (x, y) = (axis(ranges[0], size[0]), axis(ranges[1], size[1]));
        let panel = Panel { size, x: &x, y: &y };
        let mut svg = Svg::content();
        draw_grid(&mut svg, &panel);
        self.draw_inside(&mut svg, &panel);
        svg.border("mbd-frame");
        finish(&Plot {
            title: &self.title,
            caption: &self.caption,
            labels: [
                with_exponent(&self.labels[0], x.exponent),
                with_exponent(&self.labels[1], y.exponent),
            ],
            legend: self.legend(),
            content: svg.markup(),
            left,
            size,
            equal: true,
            notes: Vec::new(),
        })
    }

    /// Lowest and highest place of everything along both axes; a square metre for nothing.
    fn bounds(&self) -> [[f64; 2]; 2] {
        let shapes = self.instants.iter().flatten().flat_map(DrawingPart::places);
        let places = shapes.chain(self.paths.iter().flat_map(|(_, places)| places));
        let mut bounds: Option<[[f64; 2]; 2]> = None;
        for place in places.filter(|place| place.iter().all(|x| x.is_finite())) {
            let bounds = bounds.get_or_insert_with(|| place.map(|x| [x, x]));
            for (ends, x) in bounds.iter_mut().zip(place) {
                *ends = [ends[0].min(*x), ends[1].max(*x)];
            }
        }
        bounds.unwrap_or([[-0.5, 0.5]; 2])
    }

    /// Each kind of shape once, then the paths.
    fn legend(&self) -> Vec<LegendEntry> {
        let mut legend: Vec<LegendEntry> = Vec::new();
        for shape in self.instants.iter().flatten() {
            let (sample, name) = shape.explained();
            if !shape.places().is_empty() && legend.iter().all(|entry| entry.name != name) {
                let mut svg = Svg::content();
                draw_shape(&mut svg, &sample, &|place| Some(*place));
                legend.push(LegendEntry {
                    sample: svg.markup(),
                    name: name.to_string(),
                });
            }
        }
        let middle = 0.5 * SAMPLE[1];
        legend.extend(self.paths.iter().enumerate().map(|(index, (name, _))| {
            let mut svg = Svg::content();
            svg.line(&path_class(index), [0.0, middle], [SAMPLE[0], middle]);
            LegendEntry {
                sample: svg.markup(),
                name: format!("path of {name}"),
            }
        }));
        legend
    }

    fn draw_inside(&self, svg: &mut Svg, panel: &Panel) {
        svg.stretch(panel.size, 0.0);
        let last = self.instants.len().saturating_sub(1);
        for (index, shapes) in self.instants.iter().enumerate() {
            let share = if last == 0 {
                1.0
            } else {
                index as f64 / last as f64
            };
            svg.fade(0.25 + 0.75 * share * share);
            let mut ordered: Vec<&DrawingPart> = shapes.iter().collect();
            ordered.sort_by_key(|shape| shape.layer());
            for shape in ordered {
                draw_shape(svg, shape, &|place| panel.place(place[0], place[1]));
            }
            svg.unfade();
        }
        for (index, (_, places)) in self.paths.iter().enumerate() {
            let trace = panel.trace(places.iter().map(|&[x, y]| (x, y)), None);
            svg.path(&path_class(index), &trace.path);
        }
        svg.unstretch();
    }
}

/// The look of a path: not the wide pale band, which would hide the bodies.
fn path_class(index: usize) -> String {
    format!("mbd-series {}", Look::of(index % 7 + 1).class())
}

/// An axis that is so long [px].
pub(super) fn axis([low, high]: [f64; 2], length: f64) -> PlotAxis {
    let count = (length / 52.0).round().clamp(5.0, 9.0) as usize;
    PlotAxis::new(RangeChoice::Fixed(low, high), Scale::Linear, count)
}

/// Ranges with a margin and the size of the panel, one scale for both axes, for a panel at most `widest` wide.
pub(super) fn fitted(bounds: [[f64; 2]; 2], widest: f64) -> ([[f64; 2]; 2], [f64; 2]) {
    let most = bounds
        .iter()
        .map(|[low, high]| high - low)
        .fold(1e-9, f64::max);
    // A margin around everything; what has no extent of its own gets some room.
    let spans = bounds.map(|[low, high]| (high - low).max(0.2 * most) + 0.12 * most);
    let [lowest, highest] = HEIGHTS;
    let height = (widest * spans[1] / spans[0]).clamp(lowest, highest);
    let width = (height * spans[0] / spans[1]).clamp(NARROWEST, widest);
    let size = [width, height];
    let metres_a_pixel = (spans[0] / width).max(spans[1] / height);
    let range = |k: usize| {
        let [low, high] = bounds[k];
        let half = 0.5 * metres_a_pixel * size[k];
        [0.5 * (low + high) - half, 0.5 * (low + high) + half]
    };
    ([range(0), range(1)], size)
}

fn draw_shape(svg: &mut Svg, shape: &DrawingPart, at: &impl Fn(&PagePoint) -> Option<PagePoint>) {
    match shape {
        DrawingPart::Body(places) => draw_hull(svg, "mbd-body", places, at),
        DrawingPart::Solid { silhouette, rims } => {
            draw_hull(svg, "mbd-solid", silhouette, at);
            for rim in rims {
                let rim = hull(rim.iter().filter_map(at).collect());
                if rim.len() > 2 {
                    svg.polygon("mbd-rim", &rim);
                }
            }
        }
        DrawingPart::Line([from, to], slack) => {
            if let (Some(from), Some(to)) = (at(from), at(to)) {
                let class = if *slack { "mbd-slack" } else { "mbd-rope" };
                svg.line(class, from, to);
            }
        }
        DrawingPart::Rail([from, to]) => {
            if let (Some(from), Some(to)) = (at(from), at(to)) {
                svg.line("mbd-rail", from, to);
            }
        }
        DrawingPart::Joint(place) => {
            if let Some(place) = at(place) {
                svg.circle("mbd-joint", place, 3.6);
            }
        }
        DrawingPart::Pivot(place) => {
            if let Some([x, y]) = at(place) {
                let foot = [[x, y], [x - 8.0, y + 13.0], [x + 8.0, y + 13.0]];
                svg.polygon("mbd-pivot", &foot);
                svg.circle("mbd-joint", [x, y], 3.6);
            }
        }
        DrawingPart::Point(place) => {
            if let Some(place) = at(place) {
                svg.circle("mbd-dot", place, 3.2);
            }
        }
    }
}

/// The convex hull of places: a line for two, a square mark for one.
fn draw_hull(
    svg: &mut Svg,
    class: &str,
    places: &[PagePoint],
    at: &impl Fn(&PagePoint) -> Option<PagePoint>,
) {
    match hull(places.iter().filter_map(at).collect()).as_slice() {
        [] => {}
        [[x, y]] => {
            let corner = [x - MARK, y - MARK];
            svg.rect(class, corner, [2.0 * MARK, 2.0 * MARK]);
        }
        corners => svg.polygon(class, corners),
    }
}

/// Twice the area of a triangle below which its middle place is on the line between the others: rounding decides of no corner [px²].
const FLAT: f64 = 1e-6;

/// The corners of the convex hull, in order (Andrew's monotone chain); places closer than half a pixel are one.
fn hull(mut places: Vec<PagePoint>) -> Vec<PagePoint> {
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    places.dedup_by(|a, b| (a[0] - b[0]).abs() < 0.5 && (a[1] - b[1]).abs() < 0.5);
    if places.len() < 3 {
        return places;
    }
    let half = |places: &mut dyn Iterator<Item = PagePoint>| {
        let mut chain: Vec<PagePoint> = Vec::new();
        for place in places {
            while let [.., a, b] = chain[..] {
                let turn = (b[0] - a[0]) * (place[1] - a[1]) - (b[1] - a[1]) * (place[0] - a[0]);
                if turn > FLAT {
                    break;
                }
                chain.pop();
            }
            chain.push(place);
        }
        chain.pop();
        chain
    };
    let mut corners = half(&mut places.iter().copied());
    corners.extend(half(&mut places.iter().rev().copied()));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_metre_is_as_long_across_as_upwards() {
        for bounds in [
            [[0.0, 1.0], [0.0, 0.2]],
            [[-3.0, 2.0], [0.0, 40.0]],
            [[0.0, 0.0], [0.0, 0.0]],
            [[5.0, 5.0], [-1.0, 1.0]],
        ] {
            let (ranges, size) = fitted(bounds, 680.0);
            let scale = |k: usize| (ranges[k][1] - ranges[k][0]) / size[k];
            assert!((scale(0) / scale(1) - 1.0).abs() < 1e-12, "{bounds:?}");
            for k in 0..2 {
                assert!(ranges[k][0] < bounds[k][0] && bounds[k][1] < ranges[k][1]);
            }
            assert!(size[0] <= 680.0 && size[1] <= HEIGHTS[1]);
        }
    }

    #[test]
    fn a_body_is_the_hull_of_its_places() {
        let square = vec![
            [0.0, 0.0],
            [10.0, 10.0],
            [5.0, 5.0],
            [10.0, 0.0],
            [0.0, 10.0],
            [0.1, 0.1],
        ];
        assert_eq!(hull(square).len(), 4);
        assert_eq!(
            hull(vec![[0.0, 0.0], [5.0, 5.0], [9.0, 9.0]]),
            [[0.0, 0.0], [9.0, 9.0]]
        );
        assert_eq!(hull(vec![[1.0, 1.0], [1.2, 1.1]]).len(), 1);
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        let svg = Drawing::new("none", ["x", "z"])
            .instant([
                DrawingPart::Body(vec![[f64::NAN, 0.0], [1.0, 0.0], [2.0, 1.0]]),
                DrawingPart::Body(Vec::new()),
                DrawingPart::Joint([f64::INFINITY, 0.0]),
            ])
            .path("gap", vec![[0.0, 0.0], [f64::NAN, 1.0], [2.0, 2.0]])
            .svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert!(Drawing::new("", ["x", "y"]).svg().starts_with("<svg"));
    }
}
