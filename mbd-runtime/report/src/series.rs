//! What a figure draws: curves, or dots.

use super::look::Look;
use super::trace::{Panel, Trace};

/// One curve: pairs of x and y in drawing order, of equal length (a longer one is cut).
#[derive(Clone, Debug)]
pub struct Series<'a> {
    pub(super) name: String,
    pub(super) x: &'a [f64],
    pub(super) y: &'a [f64],
    pub(super) look: Option<Look>,
    pub(super) period: Option<f64>,
    pub(super) dots: bool,
    pub(super) marked: bool,
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
            period: None,
            dots: false,
            marked: true,
        }
    }

    /// Values this far apart are the same, as 360° and 0° are: no line is drawn where the curve jumps by more than half of it.
    #[must_use]
    pub fn periodic(mut self, period: f64) -> Self {
        self.period = Some(period);
        self
    }

    /// Draws a dot at each pair, and no line.
    #[must_use]
    pub fn dots(mut self) -> Self {
        self.dots = true;
        self
    }

    /// Draws no marks at the pairs, however few they are: those of a contour are none of its data.
    #[must_use]
    pub fn unmarked(mut self) -> Self {
        self.marked = false;
        self
    }

    /// Chooses the look; otherwise the figure hands them out in the order of [`Look::ALL`].
    #[must_use]
    pub fn look(mut self, look: Look) -> Self {
        self.look = Some(look);
        self
    }

    /// The curve, or the dots, as they are drawn.
    pub(super) fn trace(&self, panel: &Panel<'_>) -> Trace {
        match self.dots {
            true => panel.dots(self.samples()),
            false => {
                let mut trace = panel.trace(self.samples(), self.period);
                if !self.marked && !trace.path.is_empty() {
                    trace.marks.clear();
                }
                trace
            }
        }
    }

    pub(super) fn samples(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.x.iter().copied().zip(self.y.iter().copied())
    }
}
