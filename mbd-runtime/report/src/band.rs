//! Bands: the area between two curves.

use super::number::pixel;
use super::plot::SAMPLE;
use super::svg::Svg;
use super::trace::Panel;

/// The area between two curves over the same x, in one of three shades.
#[derive(Clone, Debug)]
pub(super) struct Band<'a> {
    pub name: String,
    pub x: &'a [f64],
    /// The curve below, and the one above.
    pub ends: [&'a [f64]; 2],
    /// From 0, the lightest, to 2.
    pub shade: usize,
}

impl Band<'_> {
    /// The name of the style class in the SVG.
    pub fn class(&self) -> String {
        format!("mbd-shade{}", self.shade.min(2))
    }

    /// All places of both curves.
    pub fn samples(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let along = |end: usize| self.x.iter().copied().zip(self.ends[end].iter().copied());
        along(0).chain(along(1))
    }

    /// Data of the SVG path: a polygon for each stretch in which both curves are numbers.
    pub fn path(&self, panel: &Panel<'_>) -> String {
        let [low, high] = self.ends;
        let rows = self.x.iter().zip(low.iter().zip(high));
        let ends =
            rows.map(|(x, (low, high))| Some([panel.place(*x, *low)?, panel.place(*x, *high)?]));
        let ends: Vec<Option<[[f64; 2]; 2]>> = ends.collect();
        let stretches = ends
            .split(Option::is_none)
            .filter(|stretch| !stretch.is_empty());
        let polygon = |stretch: &[Option<[[f64; 2]; 2]>]| {
            let below = stretch.iter().flatten().map(|ends| ends[0]);
            let above = stretch.iter().rev().flatten().map(|ends| ends[1]);
            let places = below.chain(above).map(|place| place.map(pixel).join(" "));
            format!("M{}Z", places.collect::<Vec<_>>().join(" "))
        };
        stretches.map(polygon).collect()
    }

    /// Its sample in a legend.
    pub fn sample(&self) -> String {
        let mut sample = Svg::content();
        sample.rect(&self.class(), [0.0, 0.0], SAMPLE);
        sample.markup()
    }
}
