//! What a crate that runs its jointed model costs to build: expansion, `cargo check` and release build, beyond an empty crate.
//!
//! Every crate makes its model, a simulation of it, and records a second: what a user's crate contains at least.
//! `cargo run --release -p models --example build_time`; with `-- 8`, chains of at most 8 bodies; with `-- 8 relative`, or `auto`, in these
//! coordinates; `-- 8 relative arm.urdf` adds robots; with `-- derivatives`, scenes with and without `emit: [partial]`; with `-- first`, the first
//! build of a crate, dependencies included, in the profiles that the README shows. Chains of rods on hinges about y, x, y, x, …;
//! chains of identical bodies on spherical joints. The column expansion is the compiler as optimised as this example; in `cargo check` the macro
//! is not optimised, as in a user's crate that does not ask for it; in the release build it is at level 1. Writes a small crate under the target
//! directory and builds it again for every line of the table; nothing is downloaded.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use proc_macro2::{TokenStream, TokenTree};

type Outcome<T> = Result<T, Box<dyn Error>>;

const ROD: &str = "mass: 1.0 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2, \
    frame top at [0.0, 0.0, 0.5] m, frame end at [0.0, 0.0, -0.5] m";

/// One rod on a hinge.
fn hinge(family: &str) -> String {
    "pub model Chain {
            coordinates: FAMILY;
            gravity: [0.0, 0.0, -9.81] m/s^2;
            body rod { mass: 1.0 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
            joint hold: hinge from world to rod.top { axis: y }
        }"
    .replace("FAMILY", family)
}

/// Every function, and what a run needs alone: what the table calls it, and its item.
const ASKED: [(&str, &str); 2] = [("", ""), (", `emit: [derivative]`", "emit: [derivative];")];

fn robot(file: &str, family: &str, emit: &str) -> Outcome<String> {
    let path = Path::new(file).canonicalize()?;
    let robot = format!("urdf: {path:?} {{ inertias: unchecked }}");
    Ok(format!(
        "pub model Chain {{ coordinates: {family}; {emit} {robot} }}"
    ))
}

/// The parachute, the four-bar in space and chains of hinges in both families of coordinates, each with what a run needs alone, and with the derivatives of its equations.
fn derivatives() -> Outcome<Vec<(String, String)>> {
    let mut rows = Vec::new();
    let ready = models::scenes::READY
        .iter()
        .filter(|ready| ["parachute", "four_bar"].contains(&ready.name));
    let ready = ready.map(|ready| (ready.name, mbd_compiler::write_text(&(ready.scene)())));
    let chains = [
        ("chain of 16 hinges", hinges(16, "absolute")),
        ("chain of 16 hinges, relative", hinges(16, "relative")),
        ("chain of 32 hinges, relative", hinges(32, "relative")),
        ("chain of 64 hinges, relative", hinges(64, "relative")),
    ];
    for (name, text) in ready.chain(chains) {
        let (_, items) = text.split_once('{').ok_or("a model without items")?;
        for emit in ["derivative", "derivative, partial"] {
            rows.push((
                format!("{name}, `emit: [{emit}]`"),
                format!("pub model Chain {{ emit: [{emit}]; {items}"),
            ));
        }
    }
    Ok(rows)
}

/// A crate that runs this model so many times over, each a model of its own.
fn running(text: &str, models: usize) -> String {
    let mut source = "//! A chain.\n".to_owned();
    let mut calls = String::new();
    for number in 0..models {
        source += &format!(
            "mod chain_{number} {{
                use mbd_runtime::{{Content, Options, Sampling, Simulation, Trajectory}};
                mbd_runtime::model! {{ {text} }}
                pub fn run() -> Result<usize, Box<dyn std::error::Error>> {{
                    let chain = Chain::new(ChainParams::default())?;
                    let mut run = Simulation::new(&chain, Options::rk4(1e-3))?;
                    let mut history = Trajectory::new(&chain, Sampling::Every(0.01), Content::ALL);
                    run.record(1.0, &mut history)?;
                    Ok(history.len())
                }}
            }}\n"
        );
        calls += &format!("println!(\"{{:?}}\", chain_{number}::run());\n");
    }
    format!("{source}fn main() {{ {calls} }}\n")
}

/// `n` rods on hinges, n even.
fn hinges(n: usize, family: &str) -> String {
    format!(
        "pub model Chain {{
            coordinates: {family};
            gravity: [0.0, 0.0, -9.81] m/s^2;
            const HALF = {};
            body even[i in 0..HALF] {{ {ROD} }}
            body odd[i in 0..HALF] {{ {ROD} }}
            joint hold: hinge from world to even[0].top {{ axis: y }}
            joint pin_odd[i in 0..HALF]: hinge from even[i].end to odd[i].top {{ axis: x }}
            joint pin_even[i in 1..HALF]: hinge from odd[i - 1].end to even[i].top {{ axis: y }}
        }}",
        n / 2
    )
}

/// `n` identical rods on spherical joints.
fn spherical(n: usize, family: &str) -> String {
    format!(
        "pub model Chain {{
            coordinates: {family};
            gravity: [0.0, 0.0, -9.81] m/s^2;
            body rod[i in 0..{n}] {{ {ROD} }}
            joint hold: spherical from world to rod[0].top;
            joint pin[i in 1..{n}]: spherical from rod[i - 1].end to rod[i].top;
        }}"
    )
}

fn tokens(stream: TokenStream) -> usize {
    stream
        .into_iter()
        .map(|tree| match tree {
            TokenTree::Group(group) => 2 + tokens(group.stream()),
            _ => 1,
        })
        .sum()
}

/// Time [s] and tokens of an expansion in this process.
fn expansion(text: &str) -> Outcome<(f64, usize)> {
    let declaration: TokenStream = text.parse().map_err(|error| format!("{error}"))?;
    let start = Instant::now();
    let expanded = mbd_compiler::compile(declaration);
    Ok((start.elapsed().as_secs_f64(), tokens(expanded)))
}

/// A crate that is built again and again.
struct Crate {
    folder: PathBuf,
    target: PathBuf,
}

impl Crate {
    /// An empty one below the target directory, built into `target`, or beside what is built there already.
    fn new(workspace: &Path, target: Option<&str>, profiles: &str) -> Outcome<Self> {
        let built = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
        let built = built.unwrap_or_else(|| workspace.join("target"));
        let folder = built.join("build_time");
        std::fs::create_dir_all(folder.join("src"))?;
        std::fs::copy(workspace.join("Cargo.lock"), folder.join("Cargo.lock"))?;
        let runtime = workspace.join("mbd-runtime");
        let manifest = format!(
            "[package]\nname = \"build_time\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[dependencies]\n\
             mbd-runtime = {{ path = {runtime:?} }}\n\n[workspace]\n\n{profiles}\n"
        );
        std::fs::write(folder.join("Cargo.toml"), manifest)?;
        let target = target.map_or(built, |name| folder.join(name));
        Ok(Crate { folder, target })
    }

    /// Wall time of a build with this source [s].
    fn build(&self, source: &str, arguments: &[&str]) -> Outcome<f64> {
        std::fs::write(self.folder.join("src/main.rs"), source)?;
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let start = Instant::now();
        let status = Command::new(cargo)
            .args(arguments)
            .args(["--offline", "--quiet"])
            .current_dir(&self.folder)
            .env("CARGO_TARGET_DIR", &self.target)
            // The whole crate each time, whatever of it changed.
            .env("CARGO_INCREMENTAL", "0")
            .status()?;
        let spent = start.elapsed().as_secs_f64();
        if status.success() {
            Ok(spent)
        } else {
            Err(format!("cargo {arguments:?} failed").into())
        }
    }

    /// The least wall time of a few builds with this source, or of one that takes long [s]: other programs only add to it.
    fn least(&self, source: &str, arguments: &[&str]) -> Outcome<f64> {
        let mut least = f64::INFINITY;
        for again in 0..5 {
            least = least.min(self.build(&format!("{source}// {again}\n"), arguments)?);
            if least > 5.0 {
                break;
            }
        }
        Ok(least)
    }
}

/// Prints what builds of models cost beyond an empty crate, line by line: expansion [s], tokens, `cargo check` [s], release [s].
struct Table {
    place: Crate,
    floor: [f64; 2],
}

impl Table {
    const BUILDS: [&[&str]; 2] = [&["check"], &["build", "--release"]];

    fn begin(workspace: &Path) -> Outcome<Self> {
        let profiles = "[profile.release.build-override]\nopt-level = 1\n";
        let place = Crate::new(workspace, None, profiles)?;
        let empty = "//! Nothing.\nuse mbd_runtime as _;\nfn main() {}\n";
        let mut floor = [0.0; 2];
        for (floor, arguments) in floor.iter_mut().zip(Self::BUILDS) {
            place.build(empty, arguments)?;
            *floor = place.least(empty, arguments)?;
        }
        let [check, release] = floor;
        println!("empty crate: check {check:.2} s, release {release:.2} s");
        println!(
            "\n| model | expansion | tokens | `cargo check` beyond empty | release beyond empty |"
        );
        println!("|---|---|---|---|---|");
        Ok(Table { place, floor })
    }

    /// A crate that runs this model so many times over.
    fn line(&self, name: &str, text: &str, models: usize) -> Outcome<[f64; 4]> {
        let (time, tokens) = expansion(text)?;
        let source = running(text, models);
        let mut beyond = [0.0; 2];
        for (k, arguments) in Self::BUILDS.into_iter().enumerate() {
            beyond[k] = self.place.least(&source, arguments)? - self.floor[k];
        }
        let [checked, released] = beyond;
        println!("| {name} | {time:.3} s | {tokens} | {checked:.2} s | {released:.2} s |");
        Ok([time, tokens as f64, checked, released])
    }
}

/// Chains of growing length and robots, with the powers of the length that their costs grow with.
fn families(workspace: &Path, most: usize, family: &str, robots: &[String]) -> Outcome<()> {
    let table = Table::begin(workspace)?;
    let one = hinge(family);
    table.line("one hinge", &one, 1)?;
    table.line("two models of one hinge", &one, 2)?;
    let lengths = |all: &[usize]| -> Vec<usize> {
        let few = all.iter().copied().filter(|n| *n <= most);
        few.collect()
    };
    for (told, emit) in ASKED {
        let mut lines = Vec::new();
        for n in lengths(&[2, 4, 8, 16, 32, 64, 128, 256]) {
            let text = hinges(n, family).replacen('{', &format!("{{ {emit}"), 1);
            let line = table.line(&format!("chain of {n} hinges{told}"), &text, 1)?;
            lines.push((n, line));
        }
        exponents(&lines);
    }
    for n in lengths(&[8, 16, 64]) {
        let name = format!("chain of {n} spherical joints");
        table.line(&name, &spherical(n, family), 1)?;
    }
    for file in robots {
        for (told, emit) in ASKED {
            table.line(&format!("{file}{told}"), &robot(file, family, emit)?, 1)?;
        }
    }
    Ok(())
}

/// Prints with which power of the length costs grow from 8 bodies on, where there are longer chains.
fn exponents(lines: &[(usize, [f64; 4])]) {
    let eight = lines.iter().find(|(n, _)| *n == 8);
    if let (Some((_, eight)), Some((most @ 16.., longest))) = (eight, lines.last()) {
        let powers = (*most as f64 / 8.0).ln();
        let [expansion, tokens, check, release] =
            [0, 1, 2, 3].map(|column| (longest[column] / eight[column]).ln() / powers);
        println!(
            "\nexponents in n, hinges 8 to {most}: expansion {expansion:.2}, tokens {tokens:.2}, check {check:.2}, release {release:.2}\n"
        );
    }
}

/// The first build of a crate with one model, nothing compiled before, and the build after its model was changed.
fn first(workspace: &Path) -> Outcome<()> {
    let readme = std::fs::read_to_string(workspace.join("README.md"))?;
    let profiles = readme
        .split("```toml\n")
        .filter_map(|part| part.split("```").next())
        .find(|block| block.starts_with("[profile.dev]"))
        .ok_or("the README shows no [profile.dev]")?;
    let (before, after) = (
        running(&hinge("absolute"), 1),
        running(&hinges(2, "absolute"), 1),
    );
    println!("| build | nothing compiled before | after a change of the model |");
    println!("|---|---|---|");
    for (name, profiles, arguments) in [
        (
            "`cargo build`, profile of the README",
            profiles,
            &["build"][..],
        ),
        ("`cargo build`, no profile", "", &["build"]),
        ("`cargo build --release`", "", &["build", "--release"]),
    ] {
        let place = Crate::new(workspace, Some("first"), profiles)?;
        if place.target.exists() {
            std::fs::remove_dir_all(&place.target)?;
        }
        let (from_nothing, again) = (
            place.build(&before, arguments)?,
            place.build(&after, arguments)?,
        );
        println!("| {name} | {from_nothing:.0} s | {again:.2} s |");
    }
    Ok(())
}

fn main() -> Outcome<()> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .canonicalize()?;
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("first") => first(&workspace),
        Some("derivatives") => {
            let table = Table::begin(&workspace)?;
            for (name, text) in derivatives()? {
                table.line(&name, &text, 1)?;
            }
            Ok(())
        }
        most => {
            let most = most.map_or(Ok(64), str::parse)?;
            let family = arguments.get(1).map_or("absolute", String::as_str);
            families(
                &workspace,
                most,
                family,
                arguments.get(2..).unwrap_or_default(),
            )
        }
    }
}
