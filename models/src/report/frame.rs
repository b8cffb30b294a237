//! What stands around a plot: axes with their ticks and labels, the legend's rows, the left margin.

use super::axis::{Axis, superscript};
use super::look::style_sheet;
use super::svg::{Anchor, Svg, text_width, wrap};
use super::trace::Panel;

/// Width of every picture [px].
pub(super) const WIDTH: f64 = 760.0;
/// Margin at the right [px].
pub(super) const RIGHT: f64 = 22.0;
/// Size of the title [px].
pub(super) const TITLE: f64 = 15.0;
/// Size of labels [px].
pub(super) const TEXT: f64 = 12.5;
/// Size of captions and notes [px].
pub(super) const SMALL: f64 = 11.5;
/// Distance of lines of text [px].
pub(super) const LINE: f64 = 17.0;

/// `force [N]`, or the name alone.
pub(super) fn label(name: &str, unit: &str) -> String {
    if unit.is_empty() {
        name.to_string()
    } else {
        format!("{name} [{unit}]")
    }
}

/// Room for the tick labels of the vertical axis [px].
pub(super) fn left_margin(y: &Axis) -> f64 {
    let widest = y
        .ticks
        .iter()
        .map(|tick| text_width(&tick.label, TEXT))
        .fold(20.0, f64::max);
    34.0 + widest
}

/// The entries of each row of a legend: index, and left end [px].
pub(super) fn legend_rows<'n>(
    names: impl Iterator<Item = &'n str>,
    left: f64,
) -> Vec<Vec<(usize, f64)>> {
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    let mut free = WIDTH;
    for (index, name) in names.enumerate() {
        let width = 44.0 + text_width(name, TEXT) + 18.0;
        if free + width > WIDTH - RIGHT + 18.0 {
            rows.push(Vec::new());
            free = left;
        }
        if let Some(row) = rows.last_mut() {
            row.push((index, free));
        }
        free += width;
    }
    rows
}

/// A picture with its title; its style sheet, too, where it stands alone.
pub(super) fn open(height: f64, left: f64, title: &str, caption: &str, alone: bool) -> Svg {
    let style = alone.then(style_sheet);
    let mut svg = Svg::open([WIDTH, height], title, caption, style.as_deref());
    for (row, words) in title_rows(title).iter().enumerate() {
        let down = 8.0 + 1.3 * TITLE * (row as f64 + 0.8);
        svg.text("", [left, down], TITLE, Anchor::Start, false, words);
    }
    svg
}

/// The rows of a title.
pub(super) fn title_rows(title: &str) -> Vec<String> {
    wrap(title, TITLE, WIDTH - 2.0 * RIGHT)
}

/// Rows of words below `bottom`.
pub(super) fn write_under(svg: &mut Svg, under: &[String], left: f64, bottom: f64) {
    for (row, words) in under.iter().enumerate() {
        let down = bottom + LINE * (row as f64 + 0.4);
        svg.text("", [left, down], SMALL, Anchor::Start, false, words);
    }
}

/// Grid, tick labels and axis labels of a panel.
pub(super) fn draw_axes(svg: &mut Svg, panel: &Panel, labels: &[String; 2]) {
    let ([left, top], [width, height]) = (panel.at, panel.size);
    let class = |label: &str| {
        if label.is_empty() {
            "mbd-minor"
        } else {
            "mbd-grid"
        }
    };
    for tick in &panel.x.ticks {
        let right = left + tick.place * width;
        svg.line(class(&tick.label), [right, top], [right, top + height]);
        let at = [right, top + height + 16.0];
        if !tick.label.is_empty() {
            svg.text("", at, TEXT, Anchor::Middle, false, &tick.label);
        }
    }
    for tick in &panel.y.ticks {
        let down = top + (1.0 - tick.place) * height;
        svg.line(class(&tick.label), [left, down], [left + width, down]);
        let at = [left - 6.0, down + 0.35 * TEXT];
        if !tick.label.is_empty() {
            svg.text("", at, TEXT, Anchor::End, false, &tick.label);
        }
    }
    let [x, y] = [(0, panel.x), (1, panel.y)]
        .map(|(axis, scale)| with_exponent(&labels[axis], scale.exponent));
    let below = [left + 0.5 * width, top + height + 36.0];
    svg.text("", below, TEXT, Anchor::Middle, false, &x);
    let beside = [16.0, top + 0.5 * height];
    svg.text("", beside, TEXT, Anchor::Middle, true, &y);
}

/// `force [N]` with the power of ten that the tick labels leave out: `force [10³ N]`.
fn with_exponent(label: &str, exponent: i32) -> String {
    if exponent == 0 {
        return label.to_string();
    }
    let power = format!("10{}", superscript(exponent));
    match label.split_once('[') {
        Some((name, unit)) => format!("{name}[{power} {unit}"),
        None => format!("{label} [{power}]"),
    }
}
