//! Inputs: random declarations, and the declarations, documents and robots of this repository, mutated by words or by bytes.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use mbd_compiler::{read_text, write_toml};

use crate::random_scene::random_scene;
use laws::random::Random;

/// How an input is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The text of a declaration.
    Text,
    /// A declaration in TOML.
    Toml,
    /// A robot.
    Urdf,
}

/// What a reader is given.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its form.
    pub form: Form,
    /// All of it.
    pub text: String,
    /// Whether it is a declaration as it should be: it must be read as a scene.
    pub meant: bool,
}

/// What inputs are made of.
#[derive(Clone, Debug)]
pub struct Corpus {
    sources: Vec<(Form, String)>,
    /// Words, numbers, signs and spaces of each.
    pieces: Vec<Pieces>,
}

/// What nobody expects in the middle of a declaration.
const STRANGE: &[&str] = &[
    "0",
    "-1",
    "1e308",
    "1e-308",
    "1e999",
    "NaN",
    "0.5",
    "2.0kg",
    "3",
    "..",
    "..=",
    ".",
    ":",
    ";",
    ",",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    "=",
    "^",
    "^9",
    "*",
    "/",
    "kg",
    "N/m",
    "m^-9",
    "deg",
    "world",
    "body",
    "point",
    "line",
    "spring",
    "const",
    "param",
    "frame",
    "at",
    "in",
    "from",
    "to",
    "com",
    "time",
    "i",
    "[i in 0..3]",
    "[i in 0..999999999999]",
    "static",
    "rate",
    "external",
    "norm",
    "cross",
    "full",
    "diag",
    "none",
    "é",
    "\"x\"",
    "#[doc]",
    "///",
    "x",
    "min",
    "'a",
    "\n",
    "\"",
    "\u{0}",
    "origin: follows ",
    "lock: ",
    "coordinates: relative;",
];

/// Bytes that mean something in one of the forms.
pub(super) const BYTES: &[u8] = b"{}[]()<>/\\\"'=;:,.#&*^0123456789-+eE \n\t\0";

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files of a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries =
        std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

/// A robot of `links` links in a row.
pub(super) fn robot(links: usize) -> String {
    let mut text = String::from("<robot name=\"row\">\n  <link name=\"base\"/>\n");
    for link in 0..links {
        let from = match link {
            0 => "base".to_owned(),
            _ => format!("l{}", link - 1),
        };
        let _ = write!(
            text,
            "  <link name=\"l{link}\"><inertial><origin xyz=\"0 0 -0.1\"/><mass value=\"1.5\"/>\
             <inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.005\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n  \
             <joint name=\"j{link}\" type=\"revolute\"><parent link=\"{from}\"/><child link=\"l{link}\"/>\
             <origin xyz=\"0 0 -0.2\" rpy=\"0 0.1 0\"/><axis xyz=\"0 1 0\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"2\"/></joint>\n"
        );
    }
    text + "</robot>\n"
}

/// Words, numbers, signs and spaces of a text: put together they are the text again, but for the lines of its comments.
#[derive(Clone, Debug)]
struct Pieces {
    text: String,
    /// Where each ends and the next one begins.
    ends: Vec<usize>,
}

impl Pieces {
    fn of(text: &str) -> Self {
        let mut pieces = Pieces {
            text: String::with_capacity(text.len() + 1),
            ends: Vec::new(),
        };
        for line in text.lines().filter(|line| !line.trim().starts_with("//")) {
            pieces.text.push_str(line);
            pieces.text.push('\n');
        }
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let mut in_word = false;
        for (at, c) in pieces.text.char_indices() {
            if in_word && !is_part(c) {
                pieces.ends.push(at);
            }
            in_word = is_part(c);
            if !in_word {
                pieces.ends.push(at + c.len_utf8());
            }
        }
        pieces
    }

    fn get(&self, index: usize) -> &str {
        let from = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.text[from..self.ends[index]]
    }

    fn all(&self) -> Vec<&str> {
        (0..self.ends.len()).map(|index| self.get(index)).collect()
    }
}

impl Corpus {
    /// The declarations and the robot of the compiler's tests, the ready scenes, and each declaration as a document.
    ///
    /// # Panics
    /// If this repository is not whole.
    #[must_use]
    pub fn new() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut sources = Vec::new();
        let written = files(&root.join("mbd-macros/compiler/tests/pass"));
        let ready = files(&root.join("models/scenes"));
        for path in written.iter().chain(&ready) {
            let text = read(path);
            if path.extension().is_some_and(|end| end == "toml") {
                sources.push((Form::Toml, text));
                continue;
            }
            if let Some(scene) = read_text(&text).scene {
                sources.push((Form::Toml, write_toml(&scene)));
            }
            sources.push((Form::Text, text));
        }
        let arm = read(&root.join("mbd-macros/compiler/tests/urdf/arm.urdf"));
        sources.push((Form::Urdf, arm));
        sources.push((Form::Urdf, robot(6)));
        Corpus {
            pieces: sources.iter().map(|(_, text)| Pieces::of(text)).collect(),
            sources,
        }
    }

    /// The sources of one form, by index.
    fn of(&self, forms: &[Form], random: &mut Random) -> usize {
        loop {
            let at = random.below(self.sources.len());
            if forms.contains(&self.sources[at].0) {
                return at;
            }
        }
    }

    /// A declaration, as text or in TOML: every fourth a random one as it should be, the others mutated by words.
    #[must_use]
    pub fn declaration(&self, number: u64) -> Input {
        let mut random = Random::new(number);
        let seed = random.bits() % 1_000_000;
        let own;
        let (form, pieces) = match number % 4 {
            0 => {
                return Input {
                    form: Form::Text,
                    text: random_scene(seed),
                    meant: true,
                };
            }
            1 => {
                own = Pieces::of(&random_scene(seed));
                (Form::Text, &own)
            }
            _ => {
                let at = self.of(&[Form::Text, Form::Toml], &mut random);
                (self.sources[at].0, &self.pieces[at])
            }
        };
        Input {
            form,
            text: self.mutated(pieces, &mut random),
            meant: false,
        }
    }

    /// The same of the text form alone, none as it should be: what a macro may be given, too.
    #[must_use]
    pub fn text(&self, number: u64) -> String {
        let mut random = Random::new(number);
        let at = self.of(&[Form::Text], &mut random);
        self.mutated(&self.pieces[at], &mut random)
    }

    /// A text with one to four mutations of its words.
    fn mutated(&self, pieces: &Pieces, random: &mut Random) -> String {
        let mut words = pieces.all();
        for _ in 0..=random.below(4) {
            self.mutate_words(&mut words, random);
        }
        words.concat()
    }

    /// A file of any form, mutated by bytes.
    #[must_use]
    pub fn file(&self, number: u64) -> Input {
        let mut random = Random::new(number);
        let at = random.below(self.sources.len());
        let (form, source) = &self.sources[at];
        let mut bytes = source.clone().into_bytes();
        for _ in 0..=random.below(8) {
            self.mutate_bytes(&mut bytes, &mut random);
        }
        Input {
            form: *form,
            text: String::from_utf8_lossy(&bytes).into_owned(),
            meant: false,
        }
    }

    fn mutate_words<'a>(&'a self, words: &mut Vec<&'a str>, random: &mut Random) {
        if words.is_empty() {
            return;
        }
        let at = random.below(words.len());
        match random.below(6) {
            0 => {
                words.remove(at);
            }
            1 => {
                words.insert(at, words[at]);
            }
            2 => {
                let other = random.below(words.len());
                words.swap(at, other);
            }
            3 => words[at] = STRANGE[random.below(STRANGE.len())],
            4 => {
                let source = &self.pieces[random.below(self.pieces.len())];
                words[at] = source.get(random.below(source.ends.len()));
            }
            _ => {
                let end = (at + random.below(24)).min(words.len());
                let part = words[at..end].to_vec();
                let place = random.below(words.len());
                words.splice(place..place, part);
            }
        }
    }

    fn mutate_bytes(&self, bytes: &mut Vec<u8>, random: &mut Random) {
        if bytes.is_empty() {
            return;
        }
        let at = random.below(bytes.len());
        let end = (at + random.below(40)).min(bytes.len());
        match random.below(7) {
            0 => bytes[at] = BYTES[random.below(BYTES.len())],
            1 => bytes[at] ^= 1 << random.below(8),
            2 => bytes.truncate(at),
            3 => {
                bytes.drain(at..end);
            }
            4 => {
                let part = bytes[at..end].to_vec();
                let place = random.below(bytes.len());
                bytes.splice(place..place, part);
            }
            5 => {
                let (_, other) = &self.sources[random.below(self.sources.len())];
                let from = random.below(other.len());
                let to = (from + random.below(200)).min(other.len());
                let part = other.as_bytes()[from..to].to_vec();
                bytes.splice(at..at, part);
            }
            _ => {
                let one = BYTES[random.below(BYTES.len())];
                let many = vec![one; random.below(300)];
                bytes.splice(at..at, many);
            }
        }
    }
}

impl Default for Corpus {
    fn default() -> Self {
        Corpus::new()
    }
}
