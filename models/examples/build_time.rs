//! What a crate that runs its jointed model costs to build: expansion, `cargo check` and release build, beyond an empty crate.
//!
//! Every crate makes its model, a simulation of it, and records a second: what a user's crate contains at least.
//! `cargo run --release -p models --example build_time`; with `-- 8`, chains of at most 8 bodies; with `-- 8 relative`, or `auto`, in these
//! coordinates; `-- 8 relative arm.urdf` adds robots. Chains of rods on hinges about y, x, y, x, …;
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

/// A robot with every function.
fn robot(file: &str, family: &str) -> Outcome<String> {
    let path = Path::new(file).canonicalize()?;
    Ok(format!(
        "pub model Chain {{ coordinates: {family}; urdf: {path:?} {{ inertias: unchecked }} }}"
    ))
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
    fn new(workspace: &Path) -> Outcome<Self> {
        let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
        let target = target.unwrap_or_else(|| workspace.join("target"));
        let folder = target.join("build_time");
        std::fs::create_dir_all(folder.join("src"))?;
        std::fs::copy(workspace.join("Cargo.lock"), folder.join("Cargo.lock"))?;
        let runtime = workspace.join("mbd-runtime");
        let manifest = format!(
            "[package]\nname = \"build_time\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[dependencies]\n\
             mbd-runtime = {{ path = {runtime:?} }}\n\n[workspace]\n\n\
             [profile.release.build-override]\nopt-level = 1\n"
        );
        std::fs::write(folder.join("Cargo.toml"), manifest)?;
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
            .status()?;
        let spent = start.elapsed().as_secs_f64();
        if status.success() {
            Ok(spent)
        } else {
            Err(format!("cargo {arguments:?} failed").into())
        }
    }
}

fn main() -> Outcome<()> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .canonicalize()?;
    let place = Crate::new(&workspace)?;
    let empty = "//! Nothing.\nuse mbd_runtime as _;\nfn main() {}\n";
    let (check, release) = (["check"], ["build", "--release"]);
    let mut floor = [0.0; 2];
    for (floor, arguments) in floor.iter_mut().zip([&check[..], &release[..]]) {
        place.build(empty, arguments)?;
        *floor = place.build(&format!("{empty}// Again.\n"), arguments)?;
    }
    println!(
        "empty crate: check {:.2} s, release {:.2} s",
        floor[0], floor[1]
    );
    println!(
        "\n| model | expansion | tokens | `cargo check` beyond empty | release beyond empty |"
    );
    println!("|---|---|---|---|---|");
    let mut lines: Vec<[f64; 4]> = Vec::new();
    let most: usize = match std::env::args().nth(1) {
        Some(most) => most.parse()?,
        None => 64,
    };
    let family = std::env::args().nth(2);
    let family = family.as_deref().unwrap_or("absolute");
    let few = |n: &usize| *n <= most;
    let chains = [2, 4, 8, 16, 32, 64, 128, 256].into_iter().filter(few);
    let chains = chains.map(|n| (format!("chain of {n} hinges"), hinges(n, family)));
    let balls = [8, 16, 64].into_iter().filter(few);
    let balls = balls.map(|n| {
        (
            format!("chain of {n} spherical joints"),
            spherical(n, family),
        )
    });
    let robots: Outcome<Vec<(String, String)>> = std::env::args()
        .skip(3)
        .map(|file| Ok((file.clone(), robot(&file, family)?)))
        .collect();
    for (name, models) in [("one hinge", 1), ("two models of one hinge", 2)] {
        let text = hinge(family);
        let (time, tokens) = expansion(&text)?;
        let source = running(&text, models);
        let checked = place.build(&source, &check)? - floor[0];
        let released = place.build(&source, &release)? - floor[1];
        println!("| {name} | {time:.3} s | {tokens} | {checked:.2} s | {released:.2} s |");
    }
    for (name, text) in chains.chain(balls).chain(robots?) {
        let (time, tokens) = expansion(&text)?;
        let source = running(&text, 1);
        let checked = place.build(&source, &check)? - floor[0];
        let released = place.build(&source, &release)? - floor[1];
        println!("| {name} | {time:.3} s | {tokens} | {checked:.2} s | {released:.2} s |");
        lines.push([time, tokens as f64, checked, released]);
    }
    let [_, _, eight, _, _, sixty_four, ..] = lines.as_slice() else {
        return Ok(());
    };
    let exponents =
        [0, 1, 2, 3].map(|column| (sixty_four[column] / eight[column]).ln() / 8f64.ln());
    println!(
        "\nexponents in n, hinges 8 to 64: expansion {:.2}, tokens {:.2}, check {:.2}, release {:.2}",
        exponents[0], exponents[1], exponents[2], exponents[3]
    );
    Ok(())
}
