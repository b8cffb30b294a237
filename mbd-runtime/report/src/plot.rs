//! A picture with axes, put together: title, legend, panel, axis labels, words under it. Once as a file of its own, of fixed size; once as a
//! part of a page, where the panel is as wide as there is room and text keeps its size.

use super::axis::{PlotAxis, superscript};
use super::look::style_sheet;
use super::svg::{Svg, TextAnchor, escape, plain, text_width, words, wrap};
use super::trace::Panel;

/// Width of a picture that is a file [px].
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
/// Room below the panel for tick labels and the name of the axis [px].
const BELOW: f64 = 48.0;
/// Width and height of the sample beside a name in the legend [px].
pub(super) const SAMPLE: [f64; 2] = [36.0, 12.0];

/// An entry of a legend: a sample, drawn into [`SAMPLE`], and its name.
pub(super) struct LegendEntry {
    /// Markup of the sample.
    pub sample: String,
    /// What it stands for.
    pub name: String,
}

/// A picture with axes.
pub(super) struct Plot<'a> {
    /// Above it.
    pub title: &'a str,
    /// Under it, when it is a file; on a page the page writes it.
    pub caption: &'a str,
    /// Names of both axes, powers of ten included.
    pub labels: [String; 2],
    /// What is drawn.
    pub legend: Vec<LegendEntry>,
    /// Markup inside the panel.
    pub content: String,
    /// Room for the labels left of the panel [px].
    pub left: f64,
    /// Size of the panel in a file; on a page its height, and the most it is wide if one scale holds on both axes [px].
    pub size: [f64; 2],
    /// Whether a metre is as long across as upwards.
    pub equal: bool,
    /// What could not be drawn.
    pub notes: Vec<String>,
}

impl Plot<'_> {
    /// A file of its own.
    pub fn file(&self) -> String {
        let [width, height] = self.size;
        let titles = wrap(&plain(self.title), TITLE, WIDTH - 2.0 * RIGHT);
        let legend = self.legend_rows();
        let head = 8.0 + 1.3 * TITLE * titles.len() as f64;
        let top = head + LINE * legend.len() as f64 + 12.0;
        let bottom = top + height + BELOW;
        let under = self.notes.iter().map(String::as_str).chain([self.caption]);
        let under: Vec<String> = under
            .flat_map(|text| wrap(&plain(text), SMALL, WIDTH - 2.0 * RIGHT - 40.0))
            .collect();
        let size = [WIDTH, bottom + LINE * under.len() as f64];
        let mut svg = Svg::open(size, self.title, self.caption, &style_sheet());
        for (row, words) in titles.iter().enumerate() {
            let down = 8.0 + 1.3 * TITLE * (row as f64 + 0.8);
            svg.text(
                "",
                [self.left, down],
                TITLE,
                TextAnchor::Start,
                false,
                words,
            );
        }
        for (row, entries) in legend.iter().enumerate() {
            let middle = head + LINE * (row as f64 + 0.5);
            for &(entry, left) in entries {
                svg.inside([left, middle - 0.5 * SAMPLE[1]], SAMPLE, &entry.sample);
                let at = [left + SAMPLE[0] + 7.0, middle + 0.35 * TEXT];
                svg.text("", at, TEXT, TextAnchor::Start, false, &entry.name);
            }
        }
        svg.inside([self.left, top], self.size, &self.content);
        let [x, y] = &self.labels;
        let below = [self.left + 0.5 * width, top + height + 36.0];
        svg.text("", below, TEXT, TextAnchor::Middle, false, x);
        let beside = [16.0, top + 0.5 * height];
        svg.text("", beside, TEXT, TextAnchor::Middle, true, y);
        for (row, words) in under.iter().enumerate() {
            let down = bottom + LINE * (row as f64 + 0.4);
            svg.text(
                "",
                [self.left, down],
                SMALL,
                TextAnchor::Start,
                false,
                words,
            );
        }
        svg.close()
    }

    /// A part of a page. `number`: the figure whose numbers the page holds, if it does.
    pub fn part(&self, number: Option<usize>) -> String {
        let [width, height] = self.size;
        let data = number.map_or_else(String::new, |k| format!(" data-plot=\"{k}\""));
        let mut html = format!(
            "<figure class=\"plot\"{data}>\n<h3>{}</h3>\n",
            words(self.title)
        );
        if !self.legend.is_empty() {
            let [w, h] = SAMPLE;
            html += "<ul class=\"legend\">";
            for LegendEntry { sample, name } in &self.legend {
                html += &format!(
                    "<li><svg width=\"{w}\" height=\"{h}\" aria-hidden=\"true\">{sample}</svg>{}</li>",
                    escape(name)
                );
            }
            html += "</ul>\n";
        }
        let shape = match self.equal {
            true => format!("max-width:{width:.0}px;aspect-ratio:{width:.0}/{height:.0}"),
            false => format!("height:{height:.0}px"),
        };
        // The name of the axis across stands under the middle of the panel.
        let under = match self.equal {
            true => format!(
                " style=\"margin-left:{:.0}px;max-width:{width:.0}px\"",
                self.left - 20.0
            ),
            false => String::new(),
        };
        let [x, y] = self.labels.each_ref().map(|label| escape(label));
        html += &format!(
            "<div class=\"up\">{y}</div>\n<div class=\"panel\" style=\"margin-left:{:.0}px;{shape}\">\
             <svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"{}\">\n{}</svg></div>\n<div class=\"across\"{under}>{x}</div>\n",
            self.left - 20.0,
            escape(&plain(self.title)),
            self.content
        );
        for note in &self.notes {
            html += &format!("<p class=\"note\">{}</p>\n", words(note));
        }
        if !self.caption.is_empty() {
            html += &format!("<figcaption>{}</figcaption>\n", words(self.caption));
        }
        html + "</figure>\n"
    }

    /// The entries of each row of the legend of a file, with their left ends [px].
    fn legend_rows(&self) -> Vec<Vec<(&LegendEntry, f64)>> {
        let mut rows: Vec<Vec<(&LegendEntry, f64)>> = Vec::new();
        let mut free = WIDTH;
        for entry in &self.legend {
            let width = SAMPLE[0] + 8.0 + text_width(&entry.name, TEXT) + 18.0;
            if free + width > WIDTH - RIGHT + 18.0 {
                rows.push(Vec::new());
                free = self.left;
            }
            if let Some(row) = rows.last_mut() {
                row.push((entry, free));
            }
            free += width;
        }
        rows
    }
}

/// `force [N]`, or the name alone.
pub(super) fn label(name: &str, unit: &str) -> String {
    if unit.is_empty() {
        name.to_string()
    } else {
        format!("{name} [{unit}]")
    }
}

/// Room for the tick labels of the vertical axis [px].
pub(super) fn left_margin(y: &PlotAxis) -> f64 {
    let widest = y
        .ticks
        .iter()
        .map(|tick| text_width(&tick.label, TEXT))
        .fold(20.0, f64::max);
    34.0 + widest
}

/// Grid and tick labels of a panel. Every second label across gives way where a page is narrow.
pub(super) fn draw_grid(svg: &mut Svg, panel: &Panel) {
    let class = |label: &str| {
        if label.is_empty() {
            "mbd-minor"
        } else {
            "mbd-grid"
        }
    };
    svg.group("mbd-x");
    for tick in &panel.x.ticks {
        svg.upright(class(&tick.label), tick.place);
    }
    let labelled = panel.x.ticks.iter().filter(|tick| !tick.label.is_empty());
    for (index, tick) in labelled.enumerate() {
        let every = if index % 2 == 1 { " mbd-second" } else { "" };
        let at = [tick.place, 0.0];
        svg.beside(
            every,
            (at, [0.0, 16.0]),
            TEXT,
            TextAnchor::Middle,
            &tick.label,
        );
    }
    svg.ungroup();
    svg.group("mbd-y");
    for tick in &panel.y.ticks {
        svg.level(class(&tick.label), tick.place);
        if !tick.label.is_empty() {
            let shift = [-6.0, 0.35 * TEXT];
            let at = ([0.0, tick.place], shift);
            svg.beside("", at, TEXT, TextAnchor::End, &tick.label);
        }
    }
    svg.ungroup();
}

/// `force [N]` with the power of ten that the tick labels leave out: `force [10³ N]`.
pub(super) fn with_exponent(label: &str, exponent: i32) -> String {
    if exponent == 0 {
        return label.to_string();
    }
    let power = format!("10{}", superscript(exponent));
    match label.split_once('[') {
        Some((name, unit)) => format!("{name}[{power} {unit}"),
        None => format!("{label} [{power}]"),
    }
}
