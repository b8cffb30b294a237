//! What the tests of campaigns share.
#![allow(dead_code, reason = "each test file uses a part of it")]

use std::fs;
use std::path::{Path, PathBuf};

/// A folder of one test, taken away at its end.
pub struct Folder(pub PathBuf);

impl Folder {
    /// An empty one; no other test has one of this name.
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mbd_campaign_{name}_{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("a folder");
        Folder(path)
    }

    /// Writes a file into it.
    pub fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, text).expect("room");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The names and the bytes of the files of a folder, in order.
pub fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("a folder");
    let files = entries.map(|entry| {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default();
        let bytes = fs::read(&path).expect("a file");
        (name.to_string_lossy().into_owned(), bytes)
    });
    let mut files: Vec<(String, Vec<u8>)> = files.collect();
    files.sort();
    files
}
