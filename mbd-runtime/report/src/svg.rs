//! A small writer of SVG: elements, escaped text, nothing else.

use mbd_runtime::scene::turns_direction;

use super::number::pixel;

/// Where a text is anchored.
#[derive(Clone, Copy, Debug)]
pub(super) enum TextAnchor {
    Start,
    Middle,
    End,
}

/// An SVG document being written.
pub(super) struct Svg {
    text: String,
}

/// Text made safe for XML and HTML: markup characters become entities; characters that XML forbids, and those that make a reader see other text
/// than there is (overrides of the direction of writing), become `�`.
pub(super) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\t' | '\n' | '\r' => safe.push(' '),
            c => safe.push(visible(c)),
        }
    }
    safe
}

/// The character, or `�` for one that is forbidden in XML or turns the direction of writing.
pub(super) fn visible(character: char) -> char {
    let forbidden = character.is_control() || matches!(character, '\u{fffe}' | '\u{ffff}');
    match turns_direction(character) || forbidden {
        true => '\u{fffd}',
        false => character,
    }
}

/// [`escape`] of prose, in which `` `names` `` stand in backticks: they become code.
pub(super) fn words(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    let mut html = String::new();
    for (index, part) in parts.iter().enumerate() {
        let part = escape(part);
        match (index % 2 == 1, index + 1 == parts.len()) {
            // The last backtick has no partner.
            (true, true) => html += &format!("`{part}"),
            (true, false) => html += &format!("<code>{part}</code>"),
            (false, _) => html += &part,
        }
    }
    html
}

/// A link to a file beside the page; whatever `to` says, it leads to no other place.
pub(super) fn link(text: &str, to: &str) -> String {
    let path: Vec<&str> = to.split('/').filter(|part| !part.is_empty()).collect();
    let path = escape(&path.join("/"));
    format!("<a href=\"./{path}\">{}</a>", words(text))
}

/// Prose without the backticks around names, where there is no type for code.
pub(super) fn plain(text: &str) -> String {
    text.replace('`', "")
}

/// A rough width of a text in pixels at a font size, for margins and wrapping: a little generous.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.58 * size * text.chars().count() as f64
}

/// Breaks a text into lines that fit a width; a single longer word gets a line of its own.
pub(super) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line)
                if text_width(line, size) + text_width(word, size) + 0.58 * size <= width =>
            {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

impl Svg {
    /// Opens a drawing of this size [px] with a title and a description for readers who do not see it.
    pub fn open(size: [f64; 2], title: &str, description: &str, style: &str) -> Self {
        let [width, height] = size.map(pixel);
        let mut svg = Svg {
            text: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n"
            ),
        };
        svg.text += &format!("<title>{}</title>\n", escape(&plain(title)));
        if !description.is_empty() {
            svg.text += &format!("<desc>{}</desc>\n", escape(&plain(description)));
        }
        svg.text += &format!("<style>{style}</style>\n");
        svg.rect("mbd-ground", [0.0, 0.0], size);
        svg
    }

    /// Elements to stand in a drawing that is opened elsewhere.
    pub fn content() -> Self {
        Svg {
            text: String::new(),
        }
    }

    /// The elements of [`Svg::content`].
    pub fn markup(self) -> String {
        self.text
    }

    /// Puts elements into a rectangle; what they draw beyond it is seen, too.
    pub fn inside(&mut self, at: [f64; 2], size: [f64; 2], content: &str) {
        let ([x, y], [w, h]) = (at.map(pixel), size.map(pixel));
        self.text += &format!(
            "<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" overflow=\"visible\">\n{content}</svg>\n"
        );
    }

    /// Everything until [`Svg::unstretch`] is drawn in a rectangle of `size`, stretched to the whole drawing and cut at its edges but for `spill`
    /// above and below [px].
    pub fn stretch(&mut self, [width, height]: [f64; 2], spill: f64) {
        let share = 100.0 * spill / height;
        self.text += &format!(
            "<svg class=\"mbd-curves\" y=\"-{share:.3}%\" width=\"100%\" height=\"{:.3}%\" viewBox=\"0 -{} {} {}\" preserveAspectRatio=\"none\" overflow=\"hidden\">\n",
            100.0 + 2.0 * share,
            pixel(spill),
            pixel(width),
            pixel(height + 2.0 * spill)
        );
    }

    /// Ends [`Svg::stretch`].
    pub fn unstretch(&mut self) {
        self.text += "</svg>\n";
    }

    /// Opens a group.
    pub fn group(&mut self, class: &str) {
        self.text += &format!("<g class=\"{class}\">\n");
    }

    /// Ends [`Svg::group`].
    pub fn ungroup(&mut self) {
        self.text += "</g>\n";
    }

    /// A line across the whole drawing, at a share of its height from below.
    pub fn level(&mut self, class: &str, up: f64) {
        let y = share(1.0 - up);
        self.text +=
            &format!("<line class=\"{class}\" x1=\"0\" y1=\"{y}\" x2=\"100%\" y2=\"{y}\"/>\n");
    }

    /// A line over the whole height of the drawing, at a share of its width.
    pub fn upright(&mut self, class: &str, right: f64) {
        let x = share(right);
        self.text +=
            &format!("<line class=\"{class}\" x1=\"{x}\" y1=\"0\" x2=\"{x}\" y2=\"100%\"/>\n");
    }

    /// A line of text at shares of width and height (from below), shifted right and down [px].
    pub fn beside(
        &mut self,
        class: &str,
        (at, shift): ([f64; 2], [f64; 2]),
        size: f64,
        anchor: TextAnchor,
        words: &str,
    ) {
        let [x, y] = [share(at[0]), share(1.0 - at[1])];
        let [dx, dy] = shift.map(pixel);
        self.text += &format!(
            "<text class=\"mbd-text{class}\" x=\"{x}\" y=\"{y}\" dx=\"{dx}\" dy=\"{dy}\" font-size=\"{}\"{}>{}</text>\n",
            pixel(size),
            anchored(anchor),
            escape(words)
        );
    }

    /// A small picture of fixed size around shares of width and height (from below).
    pub fn mark(&mut self, at: [f64; 2], class: &str, data: &str) {
        let [x, y] = [share(at[0]), share(1.0 - at[1])];
        self.text += &format!(
            "<svg x=\"{x}\" y=\"{y}\" overflow=\"visible\"><path class=\"{class}\" d=\"{data}\"/></svg>\n"
        );
    }

    /// The frame of the whole drawing.
    pub fn border(&mut self, class: &str) {
        self.text += &format!("<rect class=\"{class}\" width=\"100%\" height=\"100%\"/>\n");
    }

    /// A rectangle.
    pub fn rect(&mut self, class: &str, at: [f64; 2], size: [f64; 2]) {
        let ([x, y], [w, h]) = (at.map(pixel), size.map(pixel));
        self.text += &format!(
            "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>\n"
        );
    }

    /// A straight line.
    pub fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let ([x1, y1], [x2, y2]) = (from.map(pixel), to.map(pixel));
        self.text +=
            &format!("<line class=\"{class}\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"/>\n");
    }

    /// A circle.
    pub fn circle(&mut self, class: &str, at: [f64; 2], radius: f64) {
        let ([x, y], r) = (at.map(pixel), pixel(radius));
        self.text += &format!("<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>\n");
    }

    /// A closed polygon through these places; a single line for two.
    pub fn polygon(&mut self, class: &str, places: &[[f64; 2]]) {
        let mut data = String::new();
        for (index, place) in places.iter().enumerate() {
            let [x, y] = place.map(pixel);
            data += &format!("{}{x} {y}", if index == 0 { "M" } else { " " });
        }
        if places.len() > 2 {
            data.push('Z');
        }
        self.path(class, &data);
    }

    /// Everything until [`Svg::unfade`] is seen through: 1 not at all, 0 invisible.
    pub fn fade(&mut self, opacity: f64) {
        self.text += &format!("<g opacity=\"{opacity:.2}\">\n");
    }

    /// Ends [`Svg::fade`].
    pub fn unfade(&mut self) {
        self.text += "</g>\n";
    }

    /// A path, its data already written.
    pub fn path(&mut self, class: &str, data: &str) {
        if !data.is_empty() {
            self.text += &format!("<path class=\"{class}\" d=\"{data}\"/>\n");
        }
    }

    /// A line of text; `rotated` reads upwards.
    pub fn text(
        &mut self,
        class: &str,
        at: [f64; 2],
        size: f64,
        anchor: TextAnchor,
        rotated: bool,
        words: &str,
    ) {
        let [x, y] = at.map(pixel);
        let anchor = anchored(anchor);
        let place = if rotated {
            format!("transform=\"translate({x} {y}) rotate(-90)\"")
        } else {
            format!("x=\"{x}\" y=\"{y}\"")
        };
        self.text += &format!(
            "<text class=\"mbd-text{class}\" {place} font-size=\"{}\"{anchor}>{}</text>\n",
            pixel(size),
            escape(words)
        );
    }

    /// The finished document.
    pub fn close(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }
}

/// A share as SVG writes it.
fn share(part: f64) -> String {
    format!("{:.2}%", 100.0 * part)
}

fn anchored(anchor: TextAnchor) -> &'static str {
    match anchor {
        TextAnchor::Start => "",
        TextAnchor::Middle => " text-anchor=\"middle\"",
        TextAnchor::End => " text-anchor=\"end\"",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_a_text_stays_text() {
        assert_eq!(
            escape("a<b & \"c\"\u{1}"),
            "a&lt;b &amp; &quot;c&quot;\u{fffd}"
        );
    }

    #[test]
    fn names_in_backticks_are_code_and_no_override_of_the_direction_passes() {
        assert_eq!(words("ask `a<b` or `c"), "ask <code>a&lt;b</code> or `c");
        assert_eq!(words("plain"), "plain");
        assert_eq!(escape("a\u{202e}b\u{2066}c"), "a\u{fffd}b\u{fffd}c");
    }

    #[test]
    fn a_long_text_is_broken_between_words() {
        let lines = wrap("one two three four", 10.0, 60.0);
        assert_eq!(lines, ["one two", "three four"]);
    }
}
