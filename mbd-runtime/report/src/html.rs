//! One HTML file that needs nothing but itself: readable on a screen, in the dark and on paper.

use std::io;
use std::path::Path;

use super::drawing::Drawing;
use super::figure::Figure;
use super::files;
use super::live::{EARLY, PlotNumbers, at_the_end, player};
use super::look;
use super::playback::Playback;
use super::svg::{escape, link, words};
use super::table::{self, ReportTable};

/// A report, written from top to bottom. No dates, no paths, no machine names: the same input gives the same bytes.
///
/// ```
/// use mbd_report::{Report, ReportTable};
/// let page = Report::new("Parachute").section("Result").paragraph("All taut.").command("cargo run --release").html();
/// assert!(page.starts_with("<!DOCTYPE html>"));
/// ```
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    sections: Vec<String>,
    body: String,
    playback: Option<Playback>,
    /// Of every figure over time, so that a player can move along it.
    plots: Vec<PlotNumbers>,
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
            playback: None,
            plots: Vec::new(),
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

    /// Adds a sentence that tells what became of something that is required: whether it holds, or `None` where that is open. It stands out, and says so in words.
    #[must_use]
    pub fn verdict(mut self, text: &str, holds: Option<bool>) -> Self {
        let class = match holds {
            Some(true) => "holds",
            Some(false) => "fails",
            None => "open",
        };
        self.body += &format!("<p class=\"verdict {class}\">{}</p>\n", words(text));
        self
    }

    /// Adds a paragraph that is a link to a file beside the page.
    #[must_use]
    pub fn link(mut self, text: &str, to: &str) -> Self {
        self.body += &format!("<p>{}</p>\n", link(text, to));
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
    pub fn table(mut self, table: &ReportTable) -> Self {
        self.body += &table.html();
        self
    }

    /// Adds a figure; its caption stands under it as text.
    #[must_use]
    pub fn figure(mut self, figure: &Figure<'_>) -> Self {
        let numbers = figure.numbers();
        self.body += &figure.part(numbers.is_some().then_some(self.plots.len()));
        self.plots.extend(numbers);
        self
    }

    /// Adds the drawing of a mechanism; its caption stands under it as text.
    #[must_use]
    pub fn drawing(mut self, drawing: &Drawing) -> Self {
        let class = if self.playback.is_some() {
            " class=\"still\""
        } else {
            ""
        };
        self.body += &format!("<div{class}>\n{}</div>\n", drawing.part());
        self
    }

    /// Adds a run as a moving drawing, whose time is that of all figures over time. Drawings that are added behind it stand for it on paper and
    /// where no script runs. A page has one: a later one takes the place of an earlier one.
    #[must_use]
    pub fn playback(mut self, playback: Playback) -> Self {
        if self.playback.is_none() {
            self.body += &player(&playback);
        }
        self.playback = Some(playback);
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
        let (early, live) = self
            .playback
            .as_ref()
            .map_or_else(Default::default, |playback| {
                (EARLY, at_the_end(playback, &self.plots))
            });
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n<title>{title}</title>\n\
             <style>\n{STYLE}{}{}</style>\n{early}</head>\n<body>\n<main>\n<h1>{title}</h1>\n{contents}{}{live}</main>\n</body>\n</html>\n",
            table::style_sheet(),
            look::style_sheet(),
            self.body
        )
    }

    /// Writes the page into a file that ends in `.html`, or as `report.html` into a folder of any other name, which is made if it is not there.
    ///
    /// # Errors
    /// The file cannot be written whole; the error names it.
    pub fn write(&self, path: impl AsRef<Path>) -> io::Result<()> {
        let path = path.as_ref();
        if path
            .extension()
            .is_some_and(|extension| extension == "html")
        {
            return files::write_text(path, &self.html());
        }
        files::make_folder(path)?;
        files::write_text(&path.join("report.html"), &self.html())
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
