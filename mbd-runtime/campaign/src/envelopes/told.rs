//! What the cases say at each instant: the smallest value, percentiles, the largest, with the nominal beside them.

use std::io::{self, Write};
use std::path::Path;

use super::block;
use crate::blocks::fly_again;
use crate::manifest::Manifest;
use crate::statistics::quantile;
use crate::table::{cell, heading, number};

/// The lines of an envelope: their names, and the part of the cases that lies at or below each; 0 the smallest, 1 the largest.
pub const LINES: [(&str, f64); 7] = [
    ("min", 0.0),
    ("p1", 0.01),
    ("p5", 0.05),
    ("p50", 0.5),
    ("p95", 0.95),
    ("p99", 0.99),
    ("max", 1.0),
];

/// The most memory for numbers of all cases [bytes].
const MEMORY: u64 = 64 << 20;

/// The envelope of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Envelope {
    /// The column.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The instants [s].
    pub times: Vec<f64>,
    /// The nominal case at the instants; NaN where it has no value.
    pub nominal: Vec<f64>,
    /// How many cases have a value; the nominal is not counted.
    pub cases: Vec<u64>,
    /// Those of [`LINES`] at the instants; NaN where no case has a value.
    pub lines: [Vec<f64>; 7],
}

/// The envelopes of a folder, by its blocks.
///
/// # Errors
/// A block cannot be read.
pub fn told(folder: &Path, manifest: &Manifest) -> io::Result<Vec<Envelope>> {
    let Some(envelopes) = &manifest.envelopes else {
        return Ok(Vec::new());
    };
    let empty = |(name, unit): (&String, &String)| Envelope {
        name: name.clone(),
        unit: unit.clone(),
        times: envelopes.instants().collect(),
        nominal: Vec::new(),
        cases: Vec::new(),
        lines: Default::default(),
    };
    let mut told: Vec<Envelope> = envelopes
        .columns
        .iter()
        .zip(&envelopes.units)
        .map(empty)
        .collect();
    // As many numbers at once as there is room for, each of all cases.
    let at_once = usize::try_from(MEMORY / (8 * manifest.cases.max(1)))
        .unwrap_or(1)
        .max(1);
    for first in (0..envelopes.numbers()).step_by(at_once) {
        let count = at_once.min(envelopes.numbers() - first);
        let mut all: Vec<Vec<f64>> = vec![Vec::with_capacity(manifest.cases as usize); count];
        for block in 0..manifest.blocks() {
            let cases = manifest.cases_of(block).count();
            let path = block::path(folder, block);
            let numbers = block::read(&path, (envelopes, cases), (first, count));
            let numbers = numbers.map_err(|error| {
                let again = fly_again(folder, block);
                io::Error::new(error.kind(), format!("{error}: {again}"))
            })?;
            for (all, own) in all.iter_mut().zip(numbers.chunks_exact(cases)) {
                all.extend(own);
            }
        }
        for (place, values) in (first..).zip(all) {
            told[place / envelopes.count].add(values);
        }
    }
    Ok(told)
}

impl Envelope {
    /// The next instant: the values of all cases, the nominal first.
    fn add(&mut self, mut values: Vec<f64>) {
        let nominal = values.first().copied();
        self.nominal.push(nominal.unwrap_or(f64::NAN));
        values.drain(..nominal.iter().len());
        values.retain(|value| !value.is_nan());
        values.sort_unstable_by(f64::total_cmp);
        self.cases.push(values.len() as u64);
        for (line, (_, part)) in self.lines.iter_mut().zip(LINES) {
            line.push(quantile(&values, part).unwrap_or(f64::NAN));
        }
    }
}

/// Writes envelopes as comma-separated values: a row an instant, of each column the nominal, [`LINES`], and how many cases have a value.
///
/// # Errors
/// Those of the writer.
pub fn table(told: &[Envelope], to: &mut dyn Write) -> io::Result<()> {
    let mut head = vec!["time [s]".to_owned()];
    for envelope in told {
        let of =
            |name: &str, unit: &str| cell(&heading(&format!("{}.{name}", envelope.name), unit));
        head.push(of("nominal", &envelope.unit));
        head.extend(LINES.map(|(name, _)| of(name, &envelope.unit)));
        head.push(of("cases", ""));
    }
    writeln!(to, "{}", head.join(","))?;
    let times = told.first().map_or(&[][..], |envelope| &envelope.times);
    for (row, time) in times.iter().enumerate() {
        write!(to, "{}", number(*time))?;
        for envelope in told {
            write!(to, ",{}", number(envelope.nominal[row]))?;
            for line in &envelope.lines {
                write!(to, ",{}", number(line[row]))?;
            }
            write!(to, ",{}", envelope.cases[row])?;
        }
        writeln!(to)?;
    }
    Ok(())
}
