//! A small writer of SVG: elements, escaped text, nothing else.

use super::number::pixel;

/// Where a text is anchored.
#[derive(Clone, Copy, Debug)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// An SVG document being written.
pub(super) struct Svg {
    text: String,
}

/// Text made safe for XML and HTML: markup characters become entities, characters XML forbids become `�`.
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
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
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
    pub fn open(size: [f64; 2], title: &str, description: &str, style: Option<&str>) -> Self {
        let [width, height] = size.map(pixel);
        let mut svg = Svg {
            text: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n"
            ),
        };
        svg.text += &format!("<title>{}</title>\n", escape(title));
        if !description.is_empty() {
            svg.text += &format!("<desc>{}</desc>\n", escape(description));
        }
        if let Some(style) = style {
            svg.text += &format!("<style>{style}</style>\n");
        }
        svg.rect("mbd-ground", [0.0, 0.0], size);
        svg
    }

    /// Everything until [`Svg::unclip`] is cut at this rectangle.
    pub fn clip(&mut self, at: [f64; 2], size: [f64; 2]) {
        let ([x, y], [w, h]) = (at.map(pixel), size.map(pixel));
        self.text += &format!(
            "<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\" overflow=\"hidden\">\n"
        );
    }

    /// Ends [`Svg::clip`].
    pub fn unclip(&mut self) {
        self.text += "</svg>\n";
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

    /// A closed outline through these places; a single line for two.
    pub fn outline(&mut self, class: &str, places: &[[f64; 2]]) {
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
        anchor: Anchor,
        rotated: bool,
        words: &str,
    ) {
        let [x, y] = at.map(pixel);
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
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
    fn a_long_text_is_broken_between_words() {
        let lines = wrap("one two three four", 10.0, 60.0);
        assert_eq!(lines, ["one two", "three four"]);
    }
}
