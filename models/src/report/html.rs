//! One HTML file that needs nothing but itself: readable on a screen, in the dark and on paper.

use std::io;
use std::path::Path;

use super::drawing::Drawing;
use super::figure::Figure;
use super::look::style_sheet;
use super::svg::escape;
use super::table::Table;
use crate::files;

/// A report, written from top to bottom. No dates, no paths, no machine names: the same input gives the same bytes.
///
/// ```
/// use models::report::{Report, Table};
/// let page = Report::new("Parachute").section("Result").paragraph("All taut.").command("cargo run --release").html();
/// assert!(page.starts_with("<!DOCTYPE html>"));
/// ```
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    sections: Vec<String>,
    body: String,
}

const STYLE: &str = "\
:root{--ink:#1a1a1a;--ground:#fff;--soft:#666;--line:#d5d5d5;--tint:#f5f6f8;--link:#0a58a8;color-scheme:light dark}
@media screen and (prefers-color-scheme:dark){:root{--ink:#e8e8e8;--ground:#16181c;--soft:#a5a5a5;--line:#3a3e45;--tint:#1f2228;--link:#7ab8e8}}
*{box-sizing:border-box}
body{margin:0 auto;padding:1.5rem 1.2rem 4rem;max-width:64rem;color:var(--ink);background:var(--ground);font:16px/1.5 Helvetica,Arial,\"DejaVu Sans\",sans-serif}
h1{font-size:1.7rem;line-height:1.25;margin:.5rem 0 1rem}
h2{font-size:1.25rem;margin:2.2rem 0 .6rem;padding-bottom:.2rem;border-bottom:1px solid var(--line)}
p{max-width:46rem}
a{color:var(--link)}
nav{color:var(--soft);font-size:.9rem}
figure{margin:1.4rem 0 2rem;break-inside:avoid}
figure svg{width:100%;height:auto;max-width:60rem}
figcaption,.note{color:var(--soft);font-size:.9rem;max-width:46rem;margin:.3rem 0}
.table{margin:1.2rem 0;overflow-x:auto;break-inside:avoid}
table{border-collapse:collapse;font-size:.9rem;font-variant-numeric:tabular-nums}
caption{text-align:left;font-weight:bold;padding:.3rem 0}
th,td{padding:.28rem .8rem .28rem 0;text-align:left;vertical-align:top;border-bottom:1px solid var(--line)}
th{vertical-align:bottom;border-bottom:2px solid var(--soft)}
th small{font-weight:normal;color:var(--soft)}
.right{text-align:right;white-space:nowrap}
pre{background:var(--tint);border:1px solid var(--line);padding:.6rem .8rem;overflow-x:auto;font-size:.88rem}
@media print{body{max-width:none;padding:0;font-size:10pt}nav{display:none}.table{overflow:visible}h2{break-after:avoid}}
";

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

    /// Adds a paragraph of plain words.
    #[must_use]
    pub fn paragraph(mut self, words: &str) -> Self {
        self.body += &format!("<p>{}</p>\n", escape(words));
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
    pub fn figure(self, figure: &Figure<'_>) -> Self {
        self.picture(&figure.inline(), figure.caption_text())
    }

    /// Adds the drawing of a mechanism; its caption stands under it as text.
    #[must_use]
    pub fn drawing(self, drawing: &Drawing) -> Self {
        self.picture(&drawing.inline(), drawing.caption_text())
    }

    fn picture(mut self, svg: &str, caption: &str) -> Self {
        let caption = match caption {
            "" => String::new(),
            caption => format!("<figcaption>{}</figcaption>\n", escape(caption)),
        };
        self.body += &format!("<figure>\n{svg}{caption}</figure>\n");
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
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
             <style>\n{STYLE}{}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{contents}{}</body>\n</html>\n",
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
        for word in ["http", "src=", "<script", "url(", "@import"] {
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
