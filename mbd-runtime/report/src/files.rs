//! Files that are whole: a reader finds the new one complete, or what was there before.

use std::collections::hash_map::RandomState;
use std::fs::{self, File};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// The most bytes of a file's name without its ending: no file system takes more than 255, with what tells files of the same name apart, and those that are being
/// written.
const LONGEST: usize = 120;

/// The name of a file, or of a folder, for what has a title: letters and digits stay, every other sign becomes `_`, and what is too long is cut.
#[must_use]
pub fn file_name(title: &str) -> String {
    let mut name = String::new();
    for sign in title.chars() {
        let sign = if sign.is_alphanumeric() { sign } else { '_' };
        if name.len() + sign.len_utf8() > LONGEST {
            break;
        }
        name.push(sign);
    }
    name
}

/// Names of files in one folder: each is given once, whatever a file system makes of large and small letters.
#[derive(Debug, Default)]
pub struct FileNames {
    given: Vec<String>,
}

impl FileNames {
    /// The next one, for what has a title, with an ending such as `svg`.
    pub fn next(&mut self, title: &str, ending: &str) -> String {
        let name = file_name(title);
        let numbered = (1..).map(|number| format!("{name}_{number}.{ending}"));
        let all = std::iter::once(format!("{name}.{ending}")).chain(numbered);
        let is_new = |file: &String| !self.given.contains(&file.to_lowercase());
        let file = all.into_iter().find(is_new).unwrap_or_default();
        self.given.push(file.to_lowercase());
        file
    }
}

/// Makes a folder with those above it, if they are not there.
///
/// # Errors
/// It cannot be made; the error names it.
pub fn make_folder(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder).map_err(|error| named(folder, &error))
}

/// Writes a file whole or not at all: beside its place first, renamed when everything is written.
///
/// # Errors
/// It cannot be written, or `write` fails; the error names the file. Nothing is left of it then, and a file that was there before stays.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    write_beside(path, ".part", write, |part| fs::rename(part, path))
}

/// [`write_whole`] of a text, or of bytes, that other processes may be writing to the same place, on this machine or another: each has a part of its own, the last
/// to be ready stays.
///
/// # Errors
/// As there.
pub fn write_shared(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    let write = |to: &mut dyn Write| to.write_all(content.as_ref());
    write_beside(path, &own_ending(), write, |part| fs::rename(part, path))
}

/// [`write_shared`] where the first to be ready stays. On a file system that cannot tell, one without hard links, it is the last.
///
/// # Errors
/// As there.
pub fn write_first(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    let write = |to: &mut dyn Write| to.write_all(content.as_ref());
    write_beside(path, &own_ending(), write, |part| {
        match fs::hard_link(part, path) {
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => fs::rename(part, path),
            _ => fs::remove_file(part),
        }
    })
}

/// That of a part which nobody else writes.
fn own_ending() -> String {
    let own = RandomState::new().build_hasher().finish();
    format!(".{own:016x}.part")
}

fn write_beside(
    path: &Path,
    ending: &str,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    publish: impl FnOnce(&Path) -> io::Result<()>,
) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(ending);
    let part = path.with_file_name(name);
    let written = write_part(&part, write)
        .and_then(|()| keep_permissions(&part, path))
        .and_then(|()| publish(&part));
    written.map_err(|error| {
        // What matters is told below; a part that cannot even be removed is no other news.
        let _ = fs::remove_file(&part);
        named(path, &error)
    })
}

/// [`write_whole`] of a text.
///
/// # Errors
/// As there.
pub fn write_text(path: &Path, text: &str) -> io::Result<()> {
    write_whole(path, |to| to.write_all(text.as_bytes()))
}

/// Takes a file away, so that it does not stand beside newer ones if these cannot all be written.
///
/// # Errors
/// It is there and cannot be removed; the error names it.
pub fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(named(path, &error)),
        _ => Ok(()),
    }
}

/// Who may read and write a file stays when a new one takes its place.
fn keep_permissions(part: &Path, path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(found) if found.is_file() => fs::set_permissions(part, found.permissions()),
        _ => Ok(()),
    }
}

fn write_part(part: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut to = BufWriter::new(File::create(part)?);
    write(&mut to)?;
    to.into_inner()?.flush()
}

fn named(path: &Path, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_a_title_has_a_file_of_its_own_with_a_name_that_every_system_takes() {
        let mut names = FileNames::default();
        let mut svg = |title: &str| names.next(title, "svg");
        assert_eq!(svg("Joint angles (1 of 2)"), "Joint_angles__1_of_2_.svg");
        assert_eq!(svg("a.b"), "a_b.svg");
        assert_eq!(svg("a b"), "a_b_1.svg");
        assert_eq!(svg("A-B"), "A_B_2.svg");
        assert_eq!(svg("größe"), "größe.svg");
        let long = "ß".repeat(3000);
        let (one, other) = (svg(&long), svg(&long));
        assert!(one != other && one.len() < 130 && other.len() < 130);
    }

    #[test]
    fn a_file_is_written_whole_or_stays_as_it_was() {
        let folder = std::env::temp_dir().join(format!("mbd_files_{}", std::process::id()));
        make_folder(&folder).expect("a folder");
        let path = folder.join("report.html");
        write_text(&path, "first").expect("room");
        let full = |to: &mut dyn Write| {
            to.write_all(&[b'x'; 100_000])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        };
        let error = write_whole(&path, full).expect_err("the disk is full");
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(error.to_string().contains("report.html"), "{error}");
        assert_eq!(fs::read_to_string(&path).expect("still there"), "first");
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);
        let other = folder.join("summary.json");
        write_whole(&other, full).expect_err("the disk is full");
        assert!(!other.exists());
        remove(&other).expect("it is not there");
        fs::remove_dir_all(&folder).expect("ours");
    }
}
