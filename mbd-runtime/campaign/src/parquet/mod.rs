//! Tables as Apache Parquet files: plain values, not compressed, nothing that a reader could do without.
//!
//! A file is `PAR1`, the columns of some rows after each other (a row group), those of the next, the description of all of it, its length [4 bytes], `PAR1`. A column of a row group is one page: its
//! header, which rows have a value (runs of equal levels 0 or 1), and the values that there are. Source: the specification of the format, `parquet.thrift` and `Encodings.md` of
//! apache/parquet-format. `tests/scripts/campaign_faults.py` reads the files with pandas, polars and pyarrow.

mod thrift;

use std::io::{self, Write};

use mbd_runtime::Trajectory;
use thrift::{ThriftStruct, unsigned};

/// Rows of a group: what is held in memory of a column.
const GROUP: usize = 65_536;
const MARK: &[u8] = b"PAR1";

/// A column of a table.
pub struct ParquetColumn<'c> {
    /// Its name.
    pub name: String,
    /// Its cells, by row.
    pub cells: ParquetCells<'c>,
}

/// The cells of a column.
pub enum ParquetCells<'c> {
    /// Whole numbers, one in every row.
    Whole(Box<dyn Fn(usize) -> u64 + 'c>),
    /// Numbers; none where it is NaN.
    Numbers(Box<dyn Fn(usize) -> f64 + 'c>),
    /// Texts; none where it is empty.
    Texts(Box<dyn Fn(usize) -> &'c str + 'c>),
}

impl ParquetCells<'_> {
    /// The number of its type: INT64, DOUBLE, BYTE_ARRAY.
    fn kind(&self) -> i32 {
        match self {
            ParquetCells::Whole(_) => 2,
            ParquetCells::Numbers(_) => 5,
            ParquetCells::Texts(_) => 6,
        }
    }

    /// 1 where a row may have no value, else 0.
    fn optional(&self) -> i32 {
        i32::from(!matches!(self, ParquetCells::Whole(_)))
    }

    /// The bytes of a cell; whether it has a value.
    fn push(&self, row: usize, bytes: &mut Vec<u8>) -> bool {
        match self {
            ParquetCells::Whole(value) => bytes.extend(value(row).to_le_bytes()),
            ParquetCells::Numbers(value) => match value(row) {
                none if none.is_nan() => return false,
                value => bytes.extend(value.to_le_bytes()),
            },
            ParquetCells::Texts(value) => match value(row) {
                "" => return false,
                text => {
                    bytes.extend((text.len() as u32).to_le_bytes());
                    bytes.extend(text.as_bytes());
                }
            },
        }
        true
    }

    /// The page of some rows: its header, and what it heads.
    fn page(&self, rows: std::ops::Range<usize>) -> [Vec<u8>; 2] {
        let (count, mut values, mut levels) = (rows.len(), Vec::new(), Vec::new());
        let mut run = (true, 0);
        let mut close = |(level, length): (bool, u64)| {
            if length > 0 {
                unsigned(&mut levels, length << 1);
                levels.push(u8::from(level));
            }
        };
        for row in rows {
            let is_there = self.push(row, &mut values);
            if run.0 != is_there {
                close(run);
                run = (is_there, 0);
            }
            run.1 += 1;
        }
        close(run);
        let mut body = Vec::with_capacity(values.len() + levels.len() + 4);
        if self.optional() == 1 {
            body.extend((levels.len() as u32).to_le_bytes());
            body.extend(levels);
        }
        body.extend(values);
        let data = ThriftStruct::new()
            .small(1, count as i32)
            .small(2, PLAIN)
            .small(3, RUNS)
            .small(4, RUNS);
        let size = body.len() as i32;
        let header = ThriftStruct::new()
            .small(1, 0)
            .small(2, size)
            .small(3, size);
        [header.inner(5, data).end(), body]
    }
}

/// Encodings: values as they are; runs of equal ones.
const PLAIN: i32 = 0;
const RUNS: i32 = 3;

/// Writes a history with the columns of its comma-separated values; a number that there is not has no value.
///
/// # Errors
/// Those of the writer.
pub fn write_history(to: &mut dyn Write, history: &Trajectory) -> io::Result<()> {
    let names = history.names().iter().enumerate();
    let columns = names.map(|(at, name)| {
        let values = history.values(at);
        let cell = move |row: usize| values.get(row).copied().unwrap_or(f64::NAN);
        ParquetColumn {
            name: name.heading(),
            cells: ParquetCells::Numbers(Box::new(cell)),
        }
    });
    write(to, history.len(), &columns.collect::<Vec<_>>())
}

/// Writes a table with so many rows.
///
/// # Errors
/// Those of the writer.
pub fn write(to: &mut dyn Write, rows: usize, columns: &[ParquetColumn<'_>]) -> io::Result<()> {
    to.write_all(MARK)?;
    let mut at = MARK.len() as u64;
    let mut groups = Vec::new();
    for from in (0..rows).step_by(GROUP) {
        let own = from..(from + GROUP).min(rows);
        let (begin, count) = (at, own.len() as u64);
        let mut chunks = Vec::with_capacity(columns.len());
        for column in columns {
            let [header, body] = column.cells.page(own.clone());
            to.write_all(&header)?;
            to.write_all(&body)?;
            let size = (header.len() + body.len()) as u64;
            let described = ThriftStruct::new()
                .small(1, column.cells.kind())
                .smalls(2, &[PLAIN, RUNS])
                .one_text(3, &column.name)
                .small(4, 0)
                .large(5, count)
                .large(6, size)
                .large(7, size)
                .large(9, at);
            chunks.push(ThriftStruct::new().large(2, at).inner(3, described));
            at += size;
        }
        let group = ThriftStruct::new().structs(1, chunks.into_iter());
        groups.push(group.large(2, at - begin).large(3, count));
    }
    let root = ThriftStruct::new()
        .text(4, "table")
        .small(5, columns.len() as i32);
    let leaves = columns.iter().map(|column| {
        let leaf = ThriftStruct::new()
            .small(1, column.cells.kind())
            .small(3, column.cells.optional())
            .text(4, &column.name);
        match column.cells {
            // UTF-8.
            ParquetCells::Texts(_) => leaf.small(6, 0),
            _ => leaf,
        }
    });
    let schema: Vec<ThriftStruct> = std::iter::once(root).chain(leaves).collect();
    let described = ThriftStruct::new()
        .small(1, 1)
        .structs(2, schema.into_iter())
        .large(3, rows as u64)
        .structs(4, groups.into_iter())
        .text(6, concat!("mbd version ", env!("CARGO_PKG_VERSION")))
        .end();
    to.write_all(&described)?;
    to.write_all(&(described.len() as u32).to_le_bytes())?;
    to.write_all(MARK)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// These bytes were read by pyarrow 26, polars 2.1 and pandas 3.1: case 0, 1, 2; height 1.5, nothing, −2; why nothing, nothing, `fell`.
    #[test]
    fn a_small_table_has_the_bytes_that_others_read() {
        let (heights, words) = ([1.5, f64::NAN, -2.0], ["", "", "fell"]);
        let columns = [
            ParquetColumn {
                name: "case".to_owned(),
                cells: ParquetCells::Whole(Box::new(|row| row as u64)),
            },
            ParquetColumn {
                name: "height [m]".to_owned(),
                cells: ParquetCells::Numbers(Box::new(move |row| heights[row])),
            },
            ParquetColumn {
                name: "why".to_owned(),
                cells: ParquetCells::Texts(Box::new(move |row| words[row])),
            },
        ];
        let mut bytes = Vec::new();
        write(&mut bytes, 3, &columns).expect("memory");
        let told: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(told, include_str!("small.hex").trim());
    }

    #[test]
    fn many_rows_are_several_groups_and_none_is_no_group() {
        let column = || ParquetColumn {
            name: "x".to_owned(),
            cells: ParquetCells::Numbers(Box::new(|row| row as f64)),
        };
        let size = |rows: usize| {
            let mut bytes = Vec::new();
            write(&mut bytes, rows, &[column()]).expect("memory");
            assert!(bytes.starts_with(MARK) && bytes.ends_with(MARK));
            bytes.len()
        };
        assert!(size(0) < 100);
        // Eight bytes a row, and some headers.
        let large = size(GROUP + 1) - 8 * (GROUP + 1);
        assert!((100..400).contains(&large), "{large}");
    }
}
