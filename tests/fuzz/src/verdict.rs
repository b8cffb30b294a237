//! What is promised of every input, and what came of many.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::LazyLock;
use std::time::Instant;

use mbd_compiler::{Location, Reading, read_text, read_toml, read_urdf, write_toml};
use mbd_scene::{Layout, Redundancy};

use crate::items::{Counts, declared_in_text, declared_in_toml, resolved};
use crate::mutate::{Form, Input};

/// The longest that one input may take [s]: reading it, and laying out its scene; of more than a megabyte, each megabyte.
pub const SLOWEST: f64 = 2.0;

/// What came of one input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A scene.
    Scene,
    /// Messages.
    Told,
}

/// The time that has passed [s].
fn clock_time() -> f64 {
    static BEGAN: LazyLock<Instant> = LazyLock::new(Instant::now);
    BEGAN.elapsed().as_secs_f64()
}

/// What this thread has computed [s], whatever else the machine does; where the system does not tell, the time that has passed.
fn thread_time() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(clock_time, |time| time * 1e-9)
}

/// Reads an input. What came of it, and how long that took [s], the least of three times where it is too long once.
///
/// # Errors
/// The promise that is broken, in words.
pub fn judge(input: &Input) -> Result<(Verdict, f64), String> {
    judged(input, true)
}

/// The same; the scene is written and read again only if asked for.
fn judged(input: &Input, again: bool) -> Result<(Verdict, f64), String> {
    let slowest = SLOWEST * (input.text.len() as f64 / 1e6).max(1.0);
    let mut least = f64::INFINITY;
    // The clock is never less than what the thread has computed, which takes a system call: that is asked for where the clock is too much.
    let times: [fn() -> f64; 3] = [clock_time, thread_time, thread_time];
    for time in times {
        let began = time();
        let kept = catch_unwind(AssertUnwindSafe(|| laid_out(input)));
        least = least.min(time() - began);
        let reading = kept.map_err(|_| "a panic".to_owned())??;
        if least > slowest {
            continue;
        }
        let checked = catch_unwind(AssertUnwindSafe(|| check(input, &reading, again)));
        checked.map_err(|_| "a panic where it is written again".to_owned())??;
        let verdict = match reading.scene {
            Some(_) => Verdict::Scene,
            None => Verdict::Told,
        };
        return Ok((verdict, least));
    }
    Err(format!("{least:.1} s"))
}

/// What reading gives; its scene is laid out for its equations, which looks for rows that repeat others, after errors the skeleton for its interface.
fn laid_out(input: &Input) -> Result<Reading, String> {
    let reading = match input.form {
        Form::Text => read_text(&input.text),
        Form::Toml => read_toml(&input.text),
        Form::Urdf => read_urdf(&input.text),
    };
    let layout = match &reading.scene {
        Some(scene) => Layout::new(scene),
        None => Layout::keeping(&reading.skeleton, Redundancy::default()),
    };
    // Repetitions are bounded; what is written out has its bytes.
    match layout.nx() > 200_000 + input.text.len() {
        false => Ok(reading),
        true => Err(format!("a state of {} numbers", layout.nx())),
    }
}

fn check(input: &Input, reading: &Reading, again: bool) -> Result<(), String> {
    for message in reading.errors.iter().chain(&reading.warnings) {
        let first = message.places.first();
        let placed = first.is_some_and(|place| match place.location {
            Location::Text { line, column } => line >= 1 && column >= 1,
            Location::Tokens(..) => true,
        });
        if !placed {
            return Err(format!("a message without a place: {}", message.text));
        }
        if message.text.is_empty() {
            return Err("an empty message".to_owned());
        }
    }
    let Some(scene) = &reading.scene else {
        return match (reading.errors.first(), input.meant) {
            (None, _) => Err("neither a scene nor a message".to_owned()),
            (Some(message), true) => Err(format!("a scene is refused: {}", message.text)),
            (Some(_), false) => Ok(()),
        };
    };
    let declared = match input.form {
        Form::Text => Some(declared_in_text(&input.text)),
        Form::Toml => Some(declared_in_toml(&input.text).ok_or("no TOML is read as a scene")?),
        Form::Urdf => None,
    };
    if let Some(declared) = declared {
        let counts = [declared, resolved(scene)];
        let [declared, found] = match reading.as_points.is_empty() {
            true => counts,
            false => counts.map(with_points_for_bodies),
        };
        same(&declared, &found)?;
    }
    if !again {
        return Ok(());
    }
    let written = write_toml(scene);
    let again = read_toml(&written);
    match &again.scene {
        Some(again) if again == scene => Ok(()),
        Some(_) => Err(format!(
            "written and read again it is another scene:\n{written}"
        )),
        None => {
            let told = again.errors.first();
            let told = told.map_or_else(String::new, |message| message.in_file("toml"));
            Err(format!(
                "written, it cannot be read again: {told}\n{written}"
            ))
        }
    }
}

/// Counts in which bodies may be points, whose joints only said that they float.
fn with_points_for_bodies(mut counts: Counts) -> Counts {
    let [bodies, points] = ["body", "point"].map(|kind| counts.remove(kind).flatten());
    counts.remove("joint");
    let both = bodies.zip(points).map(|(bodies, points)| bodies + points);
    counts.insert("body", both);
    counts
}

/// Whether as many things are there as are declared.
fn same(declared: &Counts, found: &Counts) -> Result<(), String> {
    for (kind, wanted) in declared {
        let found = found.get(kind).copied().flatten();
        if wanted.is_some() && found != *wanted {
            return Err(format!(
                "{kind}: {wanted:?} declared, {found:?} in the scene"
            ));
        }
    }
    Ok(())
}

/// What came of many inputs.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// How many.
    pub inputs: u64,
    /// Their bytes.
    pub bytes: usize,
    /// How many are scenes.
    pub scenes: u64,
    /// The longest time of one [s], and which.
    pub slowest: (f64, u64),
    /// Which broke a promise, and which promise.
    pub broken: Vec<(u64, String)>,
    /// How many inputs are passed over between two whose scenes are written and read again.
    pub skipped: u64,
}

impl Tally {
    /// This one and another.
    #[must_use]
    pub fn with(mut self, other: Self) -> Self {
        self.inputs += other.inputs;
        self.bytes += other.bytes;
        self.scenes += other.scenes;
        if other.slowest.0 > self.slowest.0 {
            self.slowest = other.slowest;
        }
        self.broken.extend(other.broken);
        self
    }

    /// Reads an input and counts what came of it.
    pub fn count(&mut self, number: u64, input: &Input) {
        self.inputs += 1;
        self.bytes += input.text.len();
        match judged(input, number.is_multiple_of(self.skipped + 1)) {
            Ok((verdict, seconds)) => {
                self.scenes += u64::from(verdict == Verdict::Scene);
                if seconds > self.slowest.0 {
                    self.slowest = (seconds, number);
                }
            }
            Err(why) => self.broken.push((number, why)),
        }
    }
}

/// The most memory that this process had so far [bytes]; `None` where the system does not tell.
#[must_use]
pub fn memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
