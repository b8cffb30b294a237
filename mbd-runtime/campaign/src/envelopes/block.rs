//! The numbers of a block of cases as a file of numpy: `numpy.load` reads it as columns × instants × cases.
//!
//! Format: numpy.lib.format, version 1.0: magic, length of the header, header padded to a multiple of 64 bytes, numbers of 8 bytes, the least
//! significant first, the last index fastest.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::Envelopes;

/// Bytes of a number.
const SIZE: usize = 8;

/// The file of a block in a folder of results.
pub fn path(folder: &Path, block: u64) -> PathBuf {
    folder.join("envelopes").join(format!("{block:08}.npy"))
}

fn header(envelopes: &Envelopes, cases: usize) -> Vec<u8> {
    let [columns, instants] = [envelopes.columns.len(), envelopes.count];
    let shape = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({columns}, {instants}, {cases}), }}"
    );
    let before = 10;
    let length = (before + shape.len() + 1).next_multiple_of(64) - before;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{shape:<width$}\n", width = length - 1).bytes());
    bytes
}

/// The numbers of the cases of a block, while they come in.
#[derive(Clone, Debug, Default)]
pub struct CaseBlock {
    /// Case after case.
    numbers: Vec<f64>,
    cases: usize,
}

impl CaseBlock {
    /// Adds a case; one that has no history has no numbers.
    pub fn push(&mut self, envelopes: &Envelopes, numbers: Option<&[f64]>) {
        match numbers {
            Some(numbers) => self.numbers.extend(numbers),
            None => {
                let length = self.numbers.len() + envelopes.numbers();
                self.numbers.resize(length, f64::NAN);
            }
        }
        self.cases += 1;
    }

    /// The file, and an empty block.
    pub fn take(&mut self, envelopes: &Envelopes) -> Vec<u8> {
        let (cases, size) = (self.cases, envelopes.numbers());
        let mut bytes = header(envelopes, cases);
        bytes.reserve(SIZE * self.numbers.len());
        for number in 0..size {
            let of_cases = self.numbers.iter().skip(number).step_by(size);
            bytes.extend(of_cases.flat_map(|x| x.to_le_bytes()));
        }
        self.numbers.clear();
        self.cases = 0;
        bytes
    }
}

/// Some of the numbers of a block, `count` from `first` on, each of all its cases: number after number.
///
/// # Errors
/// The file cannot be read, or is not that of these envelopes.
pub fn read(
    path: &Path,
    (envelopes, cases): (&Envelopes, usize),
    (first, count): (usize, usize),
) -> io::Result<Vec<f64>> {
    let named =
        |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
    let all = || -> io::Result<Vec<f64>> {
        let mut file = File::open(path)?;
        let expected = header(envelopes, cases);
        let mut found = vec![0; expected.len()];
        file.read_exact(&mut found)?;
        if found != expected {
            let text = "it is not what this campaign writes";
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        }
        let before = expected.len() + SIZE * cases * first;
        file.seek(SeekFrom::Start(before as u64))?;
        let mut bytes = vec![0; SIZE * cases * count];
        file.read_exact(&mut bytes)?;
        let numbers = bytes.chunks_exact(SIZE).map(|bytes| {
            let mut own = [0; SIZE];
            own.copy_from_slice(bytes);
            f64::from_le_bytes(own)
        });
        Ok(numbers.collect())
    };
    all().map_err(named)
}
