//! One table for the terminal, the report and a file.

use super::significant;
use super::svg::{escape, link, words};

/// One entry of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words, left-aligned.
    Text(String),
    /// A number, shown with the digits of its column.
    Number(f64),
    /// A whole number, shown whole.
    Count(u64),
    /// Not known or not applicable: `–`.
    Missing,
    /// Words that lead to a file beside the page.
    Link {
        /// The words.
        text: String,
        /// The file, as it is reached from the folder of the page.
        to: String,
    },
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.to_string())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Cell::Number(number)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Cell::Count(count as u64)
    }
}

impl<C: Into<Cell>> From<Option<C>> for Cell {
    fn from(cell: Option<C>) -> Self {
        cell.map_or(Cell::Missing, Into::into)
    }
}

/// What lies between two columns, in letters.
const GAP: usize = 1;
/// Tables that need more letters than this beside each other, the style of each, and the width of a page up to which it has no room for them [rem].
const CARDS: [(usize, &str, u32); 2] = [(84, "broad", 54), (40, "wide", 34)];

/// The style of tables that have no room: every row is a card, every cell has the head of its column beside it, and what is missing is left out.
pub(super) fn style_sheet() -> String {
    let narrow = |(_, class, width): (usize, &str, u32)| {
        format!(
            "@media screen{{@container (max-width:{width}rem){{\
             .{class},.{class} :is(caption,tbody,tr,td){{display:block}}.{class} :is(thead,.none,td:empty){{display:none}}\
             .{class} tr{{padding:.4rem 0;border-bottom:1px solid var(--line)}}\
             .{class} td{{border:0;padding:.1rem 0;max-width:none;text-align:right;white-space:normal;overflow-wrap:anywhere;overflow:hidden}}\
             .{class} td::before{{content:attr(data-head);float:left;padding-right:1rem;color:var(--soft);font-weight:normal}}\
             .{class} td:first-child{{font-weight:bold}}}}}}\n"
        )
    };
    CARDS.into_iter().map(narrow).collect()
}

#[derive(Clone, Debug)]
struct TableColumn {
    name: String,
    unit: String,
    digits: usize,
}

/// A table: columns with units, rows of cells.
///
/// ```
/// use mbd_report::ReportTable;
/// let table = ReportTable::new("Largest stable step").column("node", "").number("step", "s", 3).row(["mass".into(), 1.565e-4.into()]);
/// assert!(table.text().contains("1.57e-4"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct ReportTable {
    title: String,
    columns: Vec<TableColumn>,
    rows: Vec<Vec<Cell>>,
    notes: Vec<String>,
}

impl ReportTable {
    /// A table without columns.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        ReportTable {
            title: title.into(),
            ..ReportTable::default()
        }
    }

    /// Adds a column; numbers in it are shown with four significant digits. The unit may be empty.
    #[must_use]
    pub fn column(self, name: &str, unit: &str) -> Self {
        self.number(name, unit, 4)
    }

    /// Adds a column of numbers with this many significant digits.
    #[must_use]
    pub fn number(mut self, name: &str, unit: &str, digits: usize) -> Self {
        self.columns.push(TableColumn {
            name: name.to_string(),
            unit: unit.to_string(),
            digits,
        });
        self
    }

    /// Adds a row. Missing cells are shown as `–`, cells beyond the last column are left out.
    #[must_use]
    pub fn row(mut self, cells: impl IntoIterator<Item = Cell>) -> Self {
        self.push(cells);
        self
    }

    /// [`ReportTable::row`] in a loop.
    pub fn push(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let mut row: Vec<Cell> = cells.into_iter().collect();
        row.resize(self.columns.len(), Cell::Missing);
        self.rows.push(row);
    }

    /// Adds a note under the table.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The title.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Aligned text for a terminal: title, names, units, a rule, the rows, the notes.
    #[must_use]
    pub fn text(&self) -> String {
        let heads = self.columns.iter().map(|column| {
            let unit = match column.unit.as_str() {
                "" => String::new(),
                unit => format!("[{unit}]"),
            };
            [column.name.clone(), unit]
        });
        let [names, units]: [Vec<String>; 2] = {
            let (names, units) = heads.map(|[name, unit]| (name, unit)).unzip();
            [names, units]
        };
        let body: Vec<Vec<String>> = self.rows.iter().map(|row| self.shown(row)).collect();
        let mut lines = vec![names];
        if units.iter().any(|unit| !unit.is_empty()) {
            lines.push(units);
        }
        let heads = lines.len();
        lines.extend(body);
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|k| lines.iter().map(|line| length(&line[k])).max().unwrap_or(0))
            .collect();
        let mut text = format!("{}\n", self.title);
        for (row, line) in lines.iter().enumerate() {
            if row == heads {
                text += &rule(&widths);
            }
            let padded: Vec<String> = (0..self.columns.len())
                .map(|k| pad(&line[k], widths[k], self.is_right(k)))
                .collect();
            text += &format!("  {}\n", padded.join("  ").trim_end());
        }
        if lines.len() == heads {
            text += &rule(&widths);
        }
        for note in &self.notes {
            text += &format!("  {note}\n");
        }
        text
    }

    /// The table as HTML, title and notes included.
    #[must_use]
    pub fn html(&self) -> String {
        let room = self.room();
        let cards = CARDS.into_iter().find(|(least, ..)| room > *least);
        let class = cards.map_or(String::new(), |(_, class, _)| format!(" class=\"{class}\""));
        let mut html = format!(
            "<div class=\"table\"><div class=\"scroll\"><table{class}>\n<caption>{}</caption>\n<thead><tr>",
            words(&self.title)
        );
        for (k, column) in self.columns.iter().enumerate() {
            let unit = match column.unit.as_str() {
                "" => String::new(),
                unit => format!("<br><small>{}</small>", escape(unit)),
            };
            let name = escape(&column.name);
            html += &format!("<th{}>{name}{unit}</th>", self.class(k, None));
        }
        html += "</tr></thead>\n<tbody>\n";
        for row in &self.rows {
            html += "<tr>";
            for (k, (shown, cell)) in self.shown(row).iter().zip(row).enumerate() {
                let content = match cell {
                    Cell::Link { text, to } => link(text, to),
                    _ => words(shown),
                };
                let column = &self.columns[k];
                let head = match (cards, column.unit.as_str()) {
                    (None, _) => String::new(),
                    (_, "") => format!(" data-head=\"{}\"", escape(&column.name)),
                    (_, unit) => {
                        format!(" data-head=\"{} [{}]\"", escape(&column.name), escape(unit))
                    }
                };
                html += &format!("<td{}{head}>{content}</td>", self.class(k, Some(cell)));
            }
            html += "</tr>\n";
        }
        html += "</tbody></table></div>\n";
        for note in &self.notes {
            html += &format!("<p class=\"note\">{}</p>\n", words(note));
        }
        html + "</div>\n"
    }

    /// The table as CSV: a header with units in brackets, numbers with all their digits.
    #[must_use]
    pub fn csv(&self) -> String {
        let heads = self
            .columns
            .iter()
            .map(|column| match column.unit.as_str() {
                "" => quoted(&column.name),
                unit => quoted(&format!("{} [{unit}]", column.name)),
            });
        let mut text = heads.collect::<Vec<_>>().join(",") + "\n";
        for row in &self.rows {
            let cells = row.iter().map(|cell| match cell {
                Cell::Text(words) | Cell::Link { text: words, .. } => quoted(words),
                Cell::Number(number) => format!("{number:?}"),
                Cell::Count(count) => count.to_string(),
                Cell::Missing => String::new(),
            });
            text += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
        text
    }

    fn shown(&self, row: &[Cell]) -> Vec<String> {
        let cells = row.iter().zip(&self.columns);
        cells
            .map(|(cell, column)| match cell {
                Cell::Text(words) | Cell::Link { text: words, .. } => words.clone(),
                Cell::Number(number) => significant(*number, column.digits),
                Cell::Count(count) => count.to_string(),
                Cell::Missing => "\u{2013}".to_string(),
            })
            .collect()
    }

    /// A column of words is left-aligned, every other right-aligned.
    fn is_right(&self, column: usize) -> bool {
        !self
            .rows
            .iter()
            .any(|row| matches!(row[column], Cell::Text(_) | Cell::Link { .. }))
    }

    /// The style of a head, or of a cell.
    fn class(&self, column: usize, cell: Option<&Cell>) -> &'static str {
        match (self.is_right(column), cell) {
            (true, Some(Cell::Missing)) => " class=\"right none\"",
            (false, Some(Cell::Missing)) => " class=\"none\"",
            (true, _) => " class=\"right\"",
            (false, _) => "",
        }
    }

    /// How many letters stand beside each other where only words are kept whole: what a narrow window must have room for.
    fn room(&self) -> usize {
        let shown: Vec<Vec<String>> = self.rows.iter().map(|row| self.shown(row)).collect();
        let longest = |text: &str| text.split_whitespace().map(length).max().unwrap_or(0);
        let column = |k: usize| {
            let cells = shown.iter().map(|row| match self.is_right(k) {
                true => length(&row[k]),
                false => longest(&row[k]),
            });
            cells.max().unwrap_or(0).max(longest(&self.columns[k].name)) + GAP
        };
        (0..self.columns.len()).map(column).sum()
    }
}

fn length(text: &str) -> usize {
    text.chars().count()
}

fn pad(text: &str, width: usize, right: bool) -> String {
    let blank = " ".repeat(width.saturating_sub(length(text)));
    if right {
        blank + text
    } else {
        text.to_string() + &blank
    }
}

fn rule(widths: &[usize]) -> String {
    let dashes: Vec<String> = widths.iter().map(|&width| "─".repeat(width)).collect();
    format!("  {}\n", dashes.join("  "))
}

/// A CSV field, in quotes where it must be.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> ReportTable {
        ReportTable::new("Runs")
            .column("node", "")
            .number("step", "s", 3)
            .column("solves", "1/s")
            .row(["mass".into(), 1e-4.into(), Cell::Missing])
            .row(["stepwise, \"BDF2\"".into(), 0.0481.into(), 400_usize.into()])
            .note("measured here")
    }

    #[test]
    fn columns_of_numbers_end_at_the_same_place() {
        let expected = "Runs\n  node                 step  solves\n                        [s]   [1/s]\n  ────────────────  ───────  ──────\n  \
                        mass              1.00e-4       –\n  stepwise, \"BDF2\"   0.0481     400\n  measured here\n";
        assert_eq!(table().text(), expected);
    }

    #[test]
    fn a_file_keeps_every_digit_and_quotes_what_it_must() {
        let expected =
            "node,step [s],solves [1/s]\nmass,0.0001,\n\"stepwise, \"\"BDF2\"\"\",0.0481,400\n";
        assert_eq!(table().csv(), expected);
    }

    #[test]
    fn a_page_escapes_words_and_aligns_numbers() {
        let html = table().html();
        assert!(
            html.contains("<td>stepwise, &quot;BDF2&quot;</td><td class=\"right\">0.0481</td>")
        );
    }

    #[test]
    fn a_wide_table_has_the_head_of_its_column_at_every_cell_and_a_narrow_one_has_not() {
        assert!(!table().html().contains("data-head"));
        let wide = (0..9).fold(ReportTable::new("Wide"), |table, k| {
            table.column(&format!("column{k}"), "kN/m")
        });
        let html = wide.row([1.0.into()]).html();
        assert!(html.contains("<table class=\"wide\">"));
        assert!(html.contains("<td class=\"right\" data-head=\"column0 [kN/m]\">1.000</td>"));
        assert!(html.contains("<td class=\"right none\" data-head=\"column8 [kN/m]\">–</td>"));
    }

    #[test]
    fn rows_of_the_wrong_length_and_empty_tables_are_shown_all_the_same() {
        let table = ReportTable::new("t")
            .column("a", "")
            .column("b", "")
            .row(["x".into()]);
        assert!(table.text().contains('–'));
        assert!(
            ReportTable::new("empty")
                .column("a", "m")
                .text()
                .contains("[m]")
        );
        assert!(
            ReportTable::new("nothing")
                .row(["x".into()])
                .html()
                .contains("<table>")
        );
    }
}
