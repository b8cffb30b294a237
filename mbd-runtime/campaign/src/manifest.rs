//! What a folder of results belongs to: `manifest.json`. Whoever adds to the folder must have the same; what differs is told with both values.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::envelopes::Envelopes;
use crate::failure::Failure;
use crate::footprint::Footprint;
use crate::histories::Choice;
use crate::metric::Requirement;
use crate::sampling::CaseSampling;
use mbd_report::files;
use mbd_runtime::scene::FUSES;

/// The name of its file.
const NAME: &str = "manifest.json";
/// The version of this program.
pub const OWN_VERSION: &str = env!("CARGO_PKG_VERSION");
/// What to do about the folder of another campaign.
const REMEDY: &str = "take another folder (`--out`), delete this one, or go on with the files and the version that it was begun with";

/// A column of the results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResultColumn {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// What it has to be, of a metric.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub require: Option<Requirement>,
    /// Why a run that reached its end may have no value of it, of a metric: `` `landed` did not happen ``.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub waits_for: String,
    /// What to know of the quantity of a metric: `not unique`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub remark: String,
    /// From when on a run counts [s], of a metric.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// Up to when a run counts [s], of a metric that a longer run may change.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
}

/// What a folder of results belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// The name of the model.
    pub model: String,
    /// What tells its declaration from others.
    pub declaration: String,
    /// What tells distributions, constraints and metrics from others, numbers of tables included.
    pub dispersions: String,
    /// What tells the settings of the runs from others.
    pub settings: String,
    /// The version of this program.
    pub version: String,
    /// What tells this build of it from others: controllers are code, and a mended law draws or flies otherwise.
    #[serde(default)]
    pub build: String,
    /// The kind of machine that the program is for, and whether it fuses products and sums: sines and sums may differ in the last bit on another.
    pub target: String,
    /// How the cases are spread: a grid is no random sample.
    #[serde(default)]
    pub sampling: CaseSampling,
    /// What all random numbers come from.
    pub seed: u64,
    /// All cases, with the nominal.
    pub cases: u64,
    /// So many of them share a file.
    pub block: u64,
    /// The dispersed numbers, in the order of the columns.
    pub dispersed: Vec<ResultColumn>,
    /// The metrics, in the order of the columns.
    pub metrics: Vec<ResultColumn>,
    /// Dispersed numbers that were asked to vary together: two of them by their places among these, and their correlation; of those that come from the rows of
    /// one file none is asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub correlated: Vec<([usize; 2], Option<f64>)>,
    /// What is kept of all cases over time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub envelopes: Option<Envelopes>,
    /// What is told besides.
    #[serde(default)]
    pub told: ResultOptions,
}

/// What is told of results beside the metrics. It changes no number of any case: who goes on with a folder may ask for something else.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResultOptions {
    /// Which cases keep their histories.
    pub histories: Choice,
    /// Pairs of metrics.
    pub footprints: Vec<Footprint>,
}

/// The kind of machine that this program is for: `x86_64-linux`, `x86_64-linux-fma` where products and sums are rounded once.
pub(crate) fn target() -> String {
    let fuses = if FUSES { "-fma" } else { "" };
    format!("{}-{}{fuses}", std::env::consts::ARCH, std::env::consts::OS)
}

/// What tells the program that runs from other builds of it: a hash of its file. Empty where that cannot be read.
pub(crate) fn build() -> String {
    static BUILD: OnceLock<String> = OnceLock::new();
    let read = || {
        let bytes = std::env::current_exe().and_then(fs::read);
        bytes.map_or_else(
            |_| String::new(),
            |bytes| format!("{:016x}", hash_of_file(&bytes)),
        )
    };
    BUILD.get_or_init(read).clone()
}

/// A hash of many bytes, eight at once: a program has tens of millions.
fn hash_of_file(bytes: &[u8]) -> u64 {
    // Both halves of the product: a difference in a high bit alone would move into a low one, where the next word may have the same.
    let mix = |hash: u64, word: u64| {
        let product = u128::from(hash ^ word) * 0x9e37_79b9_7f4a_7c15;
        product as u64 ^ (product >> 64) as u64
    };
    let (words, rest) = bytes.as_chunks::<8>();
    let mut hash = bytes.len() as u64;
    for word in words {
        hash = mix(hash, u64::from_le_bytes(*word));
    }
    for byte in rest {
        hash = mix(hash, u64::from(*byte));
    }
    mix(hash, 0)
}

impl Manifest {
    /// That of a folder.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(NAME);
        let text = fs::read_to_string(&path).map_err(|error| {
            Failure::Usage(format!(
                "{} holds no campaign: cannot read {}: {error}",
                folder.display(),
                path.display()
            ))
        })?;
        serde_json::from_str(&text).map_err(|error| {
            // One of another version may say more, or less.
            let there: Option<Value> = serde_json::from_str(&text).ok();
            let version = there.as_ref().and_then(|it| it.get("version")?.as_str());
            let by = version.map_or_else(String::new, |it| format!(" by mbd {it}"));
            Failure::Usage(format!(
                "{} cannot be read by mbd {OWN_VERSION}, it was written{by}: {error}; {REMEDY}",
                path.display()
            ))
        })
    }

    /// How many files of results there are in the end.
    #[must_use]
    pub fn blocks(&self) -> u64 {
        self.cases.div_ceil(self.block.max(1))
    }

    /// The cases of a block.
    #[must_use]
    pub fn cases_of(&self, block: u64) -> Range<u64> {
        block * self.block..((block + 1) * self.block).min(self.cases)
    }

    /// The block of a case, beyond the last case the last one.
    pub(crate) fn block_of(&self, case: u64) -> u64 {
        case.min(self.cases.saturating_sub(1)) / self.block.max(1)
    }

    /// Puts it into a folder, or finds the same there, where what is [`ResultOptions`] takes the place of what was.
    ///
    /// # Errors
    /// Another one is there; it cannot be written.
    pub fn claim(&self, folder: &Path) -> Result<(), Failure> {
        let there = folder.join(NAME);
        let text = serde_json::to_string_pretty(self)
            .map_err(|error| Failure::Usage(error.to_string()))?
            + "\n";
        let is_new = fs::metadata(&there).is_err_and(|it| it.kind() == io::ErrorKind::NotFound);
        if is_new {
            files::write_first(&there, &text).map_err(|error| Failure::unwritten(&error))?;
        }
        // Whoever was there before, if only by a moment, is found here.
        if self.find(folder)?.told != self.told {
            files::write_shared(&there, text).map_err(|error| Failure::unwritten(&error))?;
        }
        Ok(())
    }

    /// That of a folder, which belongs to the same campaign.
    ///
    /// # Errors
    /// Another one is there, or none.
    pub fn find(&self, folder: &Path) -> Result<Manifest, Failure> {
        let there = Manifest::read(folder)?;
        self.compare(&there, folder)?;
        Ok(there)
    }

    fn compare(&self, there: &Manifest, folder: &Path) -> Result<(), Failure> {
        let there = Manifest {
            told: self.told.clone(),
            ..there.clone()
        };
        if *self == there {
            return Ok(());
        }
        let [own, there] = [self, &there].map(|it| serde_json::to_value(it).unwrap_or_default());
        let (Value::Object(own), Value::Object(there)) = (own, there) else {
            return Ok(());
        };
        // What one of them does not have at all differs, too.
        let names: BTreeSet<&String> = own.keys().chain(there.keys()).collect();
        let both = names
            .into_iter()
            .map(|name| (name, there.get(name), own.get(name)));
        let told = both
            .filter(|(_, there, here)| there != here)
            .map(|(name, there, here)| {
                let [there, here] = [there, here].map(|it| it.unwrap_or(&Value::Null));
                format!("  {}", difference(name, there, here))
            });
        let told: Vec<String> = told.collect();
        Err(Failure::Invalid(format!(
            "{} holds another campaign: {REMEDY}\n{}",
            folder.display(),
            told.join("\n")
        )))
    }
}

/// What differs in an entry of a manifest, there and here: of columns by their names.
fn difference(name: &str, there: &Value, here: &Value) -> String {
    let (Some(old), Some(new)) = (there.as_array(), here.as_array()) else {
        let what = match name {
            "declaration" => " (the text of the scene)",
            "dispersions" => " (distributions, constraints, metrics, numbers of tables)",
            "settings" => " (how runs are set)",
            "build" => " (the program was built anew)",
            _ => "",
        };
        return format!("{name}: {there} there, {here} here{what}");
    };
    let called = |column: &Value| column.get("name").cloned().unwrap_or_default();
    let of = |list: &[Value], name: &Value| list.iter().find(|it| called(it) == *name).cloned();
    let alone = |list: &[Value], other: &[Value], place: &str| -> Vec<String> {
        let own = list.iter().filter(|it| of(other, &called(it)).is_none());
        own.map(|it| format!("{} {place} alone", called(it)))
            .collect()
    };
    let both = new.iter().filter_map(|it| {
        let other = of(old, &called(it)).filter(|other| other != it)?;
        Some(format!("{} is {other} there, {it} here", called(it)))
    });
    let mut told = alone(old, new, "there");
    told.extend(alone(new, old, "here"));
    told.extend(both);
    if told.is_empty() {
        told.push("in another order".to_owned());
    }
    format!("{name}: {}", told.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_differ_in_a_bit_or_in_their_length_have_other_hashes() {
        let file: Vec<u8> = (0..83).map(|at| at * 3).collect();
        let mut seen = BTreeSet::from([hash_of_file(&file), hash_of_file(&file[..82])]);
        for bit in 0..8 * file.len() {
            let mut other = file.clone();
            other[bit / 8] ^= 1 << (bit % 8);
            assert!(seen.insert(hash_of_file(&other)), "{bit}");
            // Two high bits of words next to each other do not cancel.
            other[(bit / 8 + 8) % 83] ^= 1 << (bit % 8);
            assert!(seen.insert(hash_of_file(&other)), "{bit}");
        }
    }

    #[test]
    fn columns_that_differ_are_told_by_their_names() {
        let list = |text: &str| serde_json::from_str::<Value>(text).expect("a list");
        let there = list(r#"[{"name": "peak", "unit": "N"}, {"name": "old", "unit": "m"}]"#);
        let here = list(r#"[{"name": "peak", "unit": "kN"}, {"name": "new", "unit": "m"}]"#);
        let told = difference("metrics", &there, &here);
        for words in ["\"old\" there alone", "\"new\" here alone", "\"peak\" is {"] {
            assert!(told.contains(words), "{told}");
        }
        let told = difference("version", &"0.0.9".into(), &"0.1.0".into());
        assert_eq!(told, r#"version: "0.0.9" there, "0.1.0" here"#);
    }
}
