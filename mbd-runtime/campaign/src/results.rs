//! The rows of `cases.csv`: a case each, with what was dispersed, what was read, or why there is nothing to read.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

use mbd_runtime::scene::twelve_digits;

use crate::blocks::fly_again;
use crate::failure::Failure;
use crate::manifest::{Manifest, ResultColumn};
use crate::parquet::{self, ParquetCells};
use crate::table::{cell, cells, counted, heading, number};

/// One case.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseRow {
    /// Its number; 0 is the nominal.
    pub case: u64,
    /// [`CaseRow::OK`], [`CaseRow::NOT_FINITE`], [`CaseRow::UNRESOLVED`], [`CaseRow::PARTIAL`], or the kind of failure.
    pub status: String,
    /// When its run ended [s].
    pub time: f64,
    /// The dispersed numbers, each in the unit of its column; NaN where nothing could be drawn.
    pub values: Vec<f64>,
    /// The metrics, each in its unit; NaN where there is none.
    pub metrics: Vec<f64>,
    /// Why it failed, or what of it is no finite number, not resolved, or of a part of its window only.
    pub why: String,
}

/// The columns that every table has before the numbers and behind them.
const BEFORE: [&str; 3] = ["case", "status", "end [s]"];
const BEHIND: &str = "why";

/// The columns of numbers, as they are headed.
fn numbers(manifest: &Manifest) -> impl Iterator<Item = String> + '_ {
    let columns = manifest.dispersed.iter().chain(&manifest.metrics);
    columns.map(|ResultColumn { name, unit, .. }| heading(name, unit))
}

/// The head of the table.
pub fn head(manifest: &Manifest) -> String {
    let before = BEFORE.map(str::to_owned).into_iter();
    let columns = numbers(manifest).map(|heading| cell(&heading));
    let all: Vec<String> = before.chain(columns).chain([BEHIND.to_owned()]).collect();
    all.join(",")
}

/// How `why` begins to tell why a metric has no value.
pub(crate) fn no_value(metric: &str) -> String {
    format!("`{metric}` has no value: ")
}

/// How `why` begins to tell that a metric is that of a part of its window.
pub(crate) fn counts_up_to(metric: &str) -> String {
    format!("`{metric}` counts up to ")
}

/// What ends before a window does.
pub(crate) const THE_RUN: &str = "the run";
/// The same of one of several scenes that a run comes to.
pub(crate) const ITS_SCENE: &str = "its scene";

/// Why a metric has no value whose scene ends before its window begins [s].
pub(crate) fn left_before(from: f64, end: f64) -> String {
    format!(
        "{LEFT_BEFORE}{from} s, where its window begins, at {} s",
        twelve_digits(end)
    )
}

/// How that begins.
pub(crate) const LEFT_BEFORE: &str = "its scene ended before ";

/// An error beyond this part of the size of what it is an error of is told.
pub const LARGE_ERROR: f64 = 0.01;

impl CaseRow {
    /// The status of a case that reached its end.
    pub const OK: &str = "ok";
    /// The status of one that did, where a metric or a column of the envelopes is no finite number: 0/0, a root of a negative number.
    pub const NOT_FINITE: &str = "output_not_finite";
    /// The status of one that did, where a metric measures what changes faster than it can be followed: its value is off by more than a hundredth of it.
    pub const UNRESOLVED: &str = "metric_unresolved";
    /// The status of one that did inside the window of a metric: its value is that of the part that was flown.
    pub const PARTIAL: &str = "metric_partial";

    /// The status of one that did, whose run made or lost more than a hundredth of the energy that moved: its steps are too long, or rounding decides.
    pub const UNBALANCED: &str = "energy_unbalanced";

    /// The statuses of cases that reached their end with something to say of it, the weightiest first.
    pub const DOUBTFUL: [&str; 4] = [
        CaseRow::NOT_FINITE,
        CaseRow::UNBALANCED,
        CaseRow::UNRESOLVED,
        CaseRow::PARTIAL,
    ];

    /// Whether its run came to its end.
    #[must_use]
    pub fn reached_end(&self) -> bool {
        let status = self.status.as_str();
        status == CaseRow::OK || CaseRow::DOUBTFUL.contains(&status)
    }

    /// It as a line, without its end.
    #[must_use]
    pub fn line(&self) -> String {
        let first = [self.case.to_string(), cell(&self.status), number(self.time)];
        let numbers = self.values.iter().chain(&self.metrics).map(|x| number(*x));
        let all: Vec<String> = first
            .into_iter()
            .chain(numbers)
            .chain([cell(&self.why)])
            .collect();
        all.join(",")
    }

    fn read(line: &str, [values, metrics]: [usize; 2]) -> Option<CaseRow> {
        let mut cells = cells(line).into_iter();
        let real = |text: String| match text.as_str() {
            "" => Some(f64::NAN),
            text => text.parse().ok(),
        };
        let case = cells.next()?.parse().ok()?;
        let status = cells.next()?;
        let time = real(cells.next()?)?;
        let mut list = |count: usize| -> Option<Vec<f64>> {
            (0..count).map(|_| real(cells.next()?)).collect()
        };
        let (values, metrics) = (list(values)?, list(metrics)?);
        let why = cells.next()?;
        Some(CaseRow {
            case,
            status,
            time,
            values,
            metrics,
            why,
        })
    }
}

/// Writes the head and the rows of some files of rows.
///
/// # Errors
/// One cannot be read; those of the writer.
pub fn join<'f>(
    head: &str,
    files: impl Iterator<Item = &'f Path>,
    to: &mut dyn Write,
) -> io::Result<()> {
    writeln!(to, "{head}")?;
    for path in files {
        let named = |error: io::Error| {
            io::Error::new(error.kind(), format!("from {}: {error}", path.display()))
        };
        let mut from = File::open(path).map_err(named)?;
        io::copy(&mut from, to)?;
    }
    Ok(())
}

/// All cases of a folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    /// What they belong to.
    pub manifest: Manifest,
    /// They, in order.
    pub rows: Vec<CaseRow>,
}

impl Results {
    /// Reads what was gathered in a folder.
    ///
    /// # Errors
    /// The folder holds no campaign, or what is there cannot be read.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let manifest = Manifest::read(folder)?;
        let path = folder.join("cases.csv");
        let wrong = |text: String| Failure::Usage(format!("{}: {text}", path.display()));
        let file =
            File::open(&path).map_err(|error| wrong(format!("{error}; `gather` writes it")))?;
        let mut lines = BufReader::new(file).lines();
        let first = lines
            .next()
            .transpose()
            .map_err(|error| wrong(error.to_string()))?;
        if first.as_deref() != Some(&head(&manifest)) {
            return Err(wrong(
                "its columns are not those of manifest.json: gather it anew".into(),
            ));
        }
        let counts = [manifest.dispersed.len(), manifest.metrics.len()];
        let mut rows = Vec::new();
        for (at, line) in lines.enumerate() {
            let line = line.map_err(|error| wrong(error.to_string()))?;
            let row = CaseRow::read(&line, counts).filter(|row| row.case == at as u64);
            rows.push(row.ok_or_else(|| {
                let again = fly_again(folder, manifest.block_of(at as u64));
                wrong(format!("line {} is no row of case {at}: {again}", at + 2))
            })?);
        }
        let found = rows.len() as u64;
        if found != manifest.cases {
            let again = fly_again(folder, manifest.block_of(found));
            let all = counted(manifest.cases, "case");
            return Err(wrong(format!("{found} of {all}: {again}")));
        }
        Ok(Results { manifest, rows })
    }

    /// Writes them as a Parquet file with the columns of `cases.csv`.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn to_parquet(&self, to: &mut dyn Write) -> io::Result<()> {
        let [case, status, end] = BEFORE;
        let rows = &self.rows;
        let column = |name: &str, cells| parquet::ParquetColumn {
            name: name.to_owned(),
            cells,
        };
        let mut columns = vec![
            column(case, ParquetCells::Whole(Box::new(|row| rows[row].case))),
            column(
                status,
                ParquetCells::Texts(Box::new(|row| &rows[row].status)),
            ),
            column(end, ParquetCells::Numbers(Box::new(|row| rows[row].time))),
        ];
        let dispersed = self.manifest.dispersed.len();
        for (at, name) in numbers(&self.manifest).enumerate() {
            let cells: Box<dyn Fn(usize) -> f64 + '_> = match at.checked_sub(dispersed) {
                None => Box::new(move |row: usize| rows[row].values[at]),
                Some(at) => Box::new(move |row: usize| rows[row].metrics[at]),
            };
            columns.push(column(&name, ParquetCells::Numbers(cells)));
        }
        columns.push(column(
            BEHIND,
            ParquetCells::Texts(Box::new(|row| &rows[row].why)),
        ));
        parquet::write(to, rows.len(), &columns)
    }

    /// A dispersed number of every case after the nominal.
    #[must_use]
    pub fn dispersed(&self, at: usize) -> Vec<f64> {
        self.rows.iter().skip(1).map(|row| row.values[at]).collect()
    }

    /// A metric of every case after the nominal.
    #[must_use]
    pub fn metric(&self, at: usize) -> Vec<f64> {
        self.rows
            .iter()
            .skip(1)
            .map(|row| row.metrics[at])
            .collect()
    }
}
