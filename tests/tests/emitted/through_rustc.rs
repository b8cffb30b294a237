//! Declarations through rustc itself: mistakes of new users at their tokens, and names that meet words of Rust.
//!
//! Each test is one call of rustc for all its models, against the crates that this test is linked with.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// The folder of compiled crates that this test lies in.
fn compiled() -> PathBuf {
    let test = std::env::current_exe().expect("a test is a file");
    test.parent().expect("in a folder").to_path_buf()
}

/// The newest build of the runtime.
fn runtime() -> PathBuf {
    let files = fs::read_dir(compiled()).expect("a folder");
    let files = files.filter_map(|file| {
        let path = file.ok()?.path();
        let name = path.file_name()?.to_str()?;
        let is_runtime = name.starts_with("libmbd_runtime-") && name.ends_with(".rlib");
        let written = path.metadata().ok()?.modified().ok()?;
        is_runtime.then_some((written, path))
    });
    files.max().expect("the runtime is built").1
}

/// What rustc tells of a source: level, line, column and text of every message that has a place.
fn told(name: &str, source: &str) -> Vec<(String, usize, usize, String)> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("through_rustc");
    fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join(format!("{name}.rs"));
    fs::write(&file, source).expect("written");
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let run = Command::new(rustc)
        .args([
            "--edition=2024",
            "--crate-type=lib",
            "--emit=metadata",
            "--error-format=json",
        ])
        .arg("--extern")
        .arg(format!("mbd_runtime={}", runtime().display()))
        .arg("-L")
        .arg(format!("dependency={}", compiled().display()))
        .arg("--out-dir")
        .arg(&folder)
        .arg(&file)
        .output()
        .expect("rustc runs");
    let text = String::from_utf8_lossy(&run.stderr).into_owned();
    let messages = text.lines().filter_map(|line| {
        let message: Value = serde_json::from_str(line).ok()?;
        let spans = message["spans"].as_array()?;
        let place = spans.iter().find(|span| span["is_primary"] == true)?;
        let number = |key: &str| place[key].as_u64().map(|n| n as usize);
        Some((
            message["level"].as_str()?.to_owned(),
            number("line_start")?,
            number("column_start")?,
            message["message"].as_str()?.to_owned(),
        ))
    });
    messages.collect()
}

/// A declaration of the compiler's tests: the messages that it awaits, and its text.
fn declaration(path: &str) -> (Vec<String>, String) {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../mbd-macros/compiler/tests");
    let text = fs::read_to_string(tests.join(path)).expect(path);
    let awaited = text.lines().filter_map(|line| line.strip_prefix("//~ "));
    let awaited: Vec<String> = awaited.map(str::to_owned).collect();
    let rest: Vec<&str> = text.lines().skip(awaited.len()).collect();
    (awaited, rest.join("\n"))
}

/// Every model in a module of its own: the source, and the line before the first of each declaration.
fn modules(declarations: &[(&str, String)]) -> (String, BTreeMap<usize, String>) {
    let mut source = String::from("#![allow(dead_code)]\n");
    let mut begins = BTreeMap::new();
    for (name, text) in declarations {
        let _ = writeln!(source, "pub mod {name} {{ mbd_runtime::model! {{");
        begins.insert(source.lines().count(), (*name).to_owned());
        let _ = writeln!(source, "{text}\n}} }}");
    }
    (source, begins)
}

const BROKEN: [&str; 10] = [
    "e01_misspelt_name",
    "e03_wrong_unit",
    "e05_unknown_joint",
    "e15_missing_semicolon",
    "e17_nested_braces",
    "e29_field_typo",
    "e34_motor_coord",
    "e37_world_missing",
    "e41_load_couple",
    "e42_motor_loop",
];

#[test]
fn rustc_tells_mistakes_where_and_as_the_compiler_does() {
    let files = BROKEN.map(|name| (name, declaration(&format!("users/broken/{name}.mbd"))));
    let texts = files
        .each_ref()
        .map(|(name, (_, text))| (*name, text.clone()));
    let (source, begins) = modules(&texts);
    let mut found: BTreeMap<String, Vec<(usize, usize, String)>> = BTreeMap::new();
    for (_, line, column, text) in told("broken", &source) {
        let (begin, name) = begins.range(..line).next_back().expect("in a module");
        let place = (line - begin, column, text);
        found.entry(name.clone()).or_default().push(place);
    }
    for (name, (awaited, _)) in files {
        let mut told = found.remove(name).unwrap_or_default();
        told.sort();
        let told: Vec<String> = told
            .into_iter()
            .map(|(line, column, text)| format!("{line}:{column}: {text}"))
            .collect();
        let mut awaited = awaited;
        awaited.sort_by_key(|line| {
            let mut parts = line.split(':').map(|part| part.parse().unwrap_or(0));
            [parts.next(), parts.next()].map(|part: Option<usize>| part.unwrap_or(0))
        });
        assert_eq!(told, awaited, "{name}");
    }
}

/// Names that mean something in Rust, in its prelude or in generated code.
const NAMES: &str = "pub model Names<T> {
    gravity: [0, 0, -9.81] m/s^2;
    const Self_ = 1 m;
    const Vec = 2 m;
    const E = 2;
    param new = 1 m;
    param default = 2 kg in 1 kg ..= 3 kg;
    param t1 = 2 N*m;
    param clone = 1;
    param time_ = 1;
    param len = 1;
    input derivative: force;
    input f64: force;
    input status: force;
    input params: force;
    input out: [force; 3];
    input self_: force;
    table ln2 = { 0 m: 1 N, 1 m: 2 N };
    body result { mass: default, inertia: diag(1, 1, 1) kg*m^2, frame new at [Self_, Vec, new * clone * time_ * len * E], frame q at [1, 0, 0] m }
    body v { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame None at [0, 0, 1] m }
    body body1 { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
    body t { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
    body Option { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
    point Some { mass: 1 kg }
    joint main: hinge from world to result.new { axis: y, force: t1 }
    joint model1: free from world to v.com;
    joint std: hinge from result.q to body1.com { axis: z }
    joint core: universal from body1.com to t.com { axes: [x, y] }
    joint Ok: free from world to Option.com;
    line mbd_runtime from world to Some { free_length: 1 m, stiffness: 1 N/m }
    load energy on v at None = [derivative, f64, status] + [params, 0 N, self_] + out;
    load mass_matrix on v = [ln2(v.position.x), 0 N, 0 N];
    load bool on t: external;
    output usize = main.angle;
    output outputs = v.position;
    output str = mbd_runtime.tension;
    event Err = Some.position.z falls 0 m;
}";

/// A load on a joint is a mistake; that its program names the inputs that there are is none.
#[test]
fn a_load_that_failed_is_no_input_of_the_caller() {
    let source = r#"#![allow(dead_code)]
mbd_runtime::model! {
    pub model Rig {
        gravity: none;
        input push: force;
        body leaf { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2 }
        joint pin: hinge from world to leaf.com { axis: y };
        load coil on pin.angle = -10 N*m * pin.angle;
        load by_hand on leaf = [push, 0 N, 0 N];
    }
}
pub fn inputs() -> RigInputs {
    RigInputs { push: 1.0 }
}
"#;
    let told: Vec<String> = told("load", source)
        .into_iter()
        .map(|(level, line, _, text)| format!("{level} {line}: {text}"))
        .collect();
    let [only] = &told[..] else {
        panic!("one message: {told:#?}");
    };
    assert!(
        only.starts_with("error 8: a load acts on a body or a point, and `pin` is a joint"),
        "{only}"
    );
}

#[test]
fn names_that_meet_words_of_rust_compile_and_what_is_unused_is_told_by_its_name() {
    let (_, unused) = declaration("users/broken/e20_unused.mbd");
    // A field of Rust begins with a small letter, or rustc has one more thing to say.
    let unused = unused.replace("P1", "p1");
    let (source, begins) = modules(&[("names", NAMES.to_owned()), ("unused", unused)]);
    let source = source.replace("#![allow(dead_code)]\n", "#![warn(dead_code)]\n");
    let (mut warnings, mut others) = (Vec::new(), Vec::new());
    for (level, line, column, text) in told("names", &source) {
        let (begin, name) = begins.range(..line).next_back().expect("in a module");
        match level == "warning" && name == "unused" {
            true => warnings.push((line - begin, column, text)),
            false => others.push(format!("{name}:{}:{column}: {text}", line - begin)),
        }
    }
    assert!(others.is_empty(), "{}", others.join("\n"));
    warnings.sort();
    let awaited = [
        (3, 7, "constant `U1` is never used"),
        (3, 23, "field `p1` is never read"),
        (3, 54, "function `tt` is never used"),
        (4, 15, "field `nowhere` is never read"),
    ];
    let awaited = awaited.map(|(line, column, text)| (line, column, text.to_owned()));
    assert_eq!(warnings, awaited);
}
