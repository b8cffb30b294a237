//! One HTML file that needs nothing but itself: readable on a screen, in the dark and on paper.

use std::io;
use std::path::Path;

use super::drawing::Drawing;
use super::figure::Figure;
use super::files;
use super::look::style_sheet;
use super::svg::{escape, words};
use super::table::Table;

/// A report, written from top to bottom. No dates, no paths, no machine names: the same input gives the same bytes.
///
/// ```
/// use mbd_report::{Report, Table};
/// let page = Report::new("Parachute").section("Result").paragraph("All taut.").command("cargo run --release").html();
/// assert!(page.starts_with("<!DOCTYPE html>"));
/// ```
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    sections: Vec<String>,
    body: String,
}

/// The style of the page.
const STYLE: &str = include_str!("page/page.css");
/// Nothing is fetched from anywhere, and nothing is sent.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

impl Report {
    /// An empty report.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Report {
            title: title.into(),
            sections: Vec::new(),
            body: String::new(),
        }
    }

    /// Starts a section; the top of the page links to it.
    #[must_use]
    pub fn section(mut self, heading: &str) -> Self {
        let heading = escape(heading);
        self.body += &format!("<h2 id=\"s{}\">{heading}</h2>\n", self.sections.len());
        self.sections.push(heading);
        self
    }

    /// Adds a paragraph of plain words; names in backticks are shown as code.
    #[must_use]
    pub fn paragraph(mut self, text: &str) -> Self {
        self.body += &format!("<p>{}</p>\n", words(text));
        self
    }

    /// Adds commands or other text to be shown as typed.
    #[must_use]
    pub fn command(mut self, text: &str) -> Self {
        let lines: Vec<String> = text.trim_end().lines().map(escape).collect();
        self.body += &format!("<pre>{}</pre>\n", lines.join("\n"));
        self
    }

    /// Adds a table.
    #[must_use]
    pub fn table(mut self, table: &Table) -> Self {
        self.body += &table.html();
        self
    }

    /// Adds a figure; its caption stands under it as text.
    #[must_use]
    pub fn figure(mut self, figure: &Figure<'_>) -> Self {
        self.body += &figure.part(None);
        self
    }

    /// Adds the drawing of a mechanism; its caption stands under it as text.
    #[must_use]
    pub fn drawing(mut self, drawing: &Drawing) -> Self {
        self.body += &drawing.part();
        self
    }

    /// The page.
    #[must_use]
    pub fn html(&self) -> String {
        let title = escape(&self.title);
        let links: Vec<String> = self
            .sections
            .iter()
            .enumerate()
            .map(|(k, heading)| format!("<a href=\"#s{k}\">{heading}</a>"))
            .collect();
        let contents = if links.len() > 1 {
            format!("<nav>{}</nav>\n", links.join(" · "))
        } else {
            String::new()
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n<title>{title}</title>\n\
             <style>\n{STYLE}{}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n{contents}{}</main>\n</body>\n</html>\n",
            style_sheet(),
            self.body
        )
    }

    /// Writes the page.
    ///
    /// # Errors
    /// The file cannot be written whole; the error names it.
    pub fn write(&self, path: impl AsRef<Path>) -> io::Result<()> {
        files::write_text(path.as_ref(), &self.html())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Series;
    use super::*;

    fn page() -> String {
        let (t, f) = ([0.0, 1.0, 2.0], [1.0, f64::NAN, 3.0]);
        let figure = Figure::new("a < b")
            .x("t", "s")
            .series(Series::new("f", &t, &f))
            .caption("c & d");
        Report::new("<Title>")
            .section("One")
            .paragraph("x < y")
            .section("Two")
            .command("run\nthis\n")
            .figure(&figure)
            .html()
    }

    #[test]
    fn a_page_refers_to_nothing_outside_itself() {
        let page = page().replace("http://www.w3.org/2000/svg", "");
        for word in ["http:", "https:", " src=", "<script", "url(", "@import"] {
            assert!(!page.contains(word), "{word}");
        }
    }

    #[test]
    fn words_cannot_become_markup_and_every_section_is_linked() {
        let page = page();
        assert!(page.contains("<h1>&lt;Title&gt;</h1>") && page.contains("<p>x &lt; y</p>"));
        assert!(
            page.contains("<a href=\"#s1\">Two</a>") && page.contains("<h2 id=\"s1\">Two</h2>")
        );
        assert!(page.contains("<pre>run\nthis</pre>"));
        assert!(page.contains("<figcaption>c &amp; d</figcaption>"));
    }

    #[test]
    fn the_same_input_gives_the_same_bytes() {
        assert_eq!(page(), page());
    }
}
