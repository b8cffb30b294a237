//! What the shipped crates stand on: one `syn`, no unsafe code, light run-time crates.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The crates a user's build compiles, and their manifests.
const SHIPPED: [(&str, &str); 5] = [
    ("mbd-scene", "mbd-runtime/scene"),
    ("mbd-solver", "mbd-runtime/solver"),
    ("mbd-runtime", "mbd-runtime"),
    ("mbd-compiler", "mbd-macros/compiler"),
    ("mbd-macros", "mbd-macros"),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The lines of one section of a manifest.
fn section<'a>(manifest: &'a str, name: &str) -> Vec<&'a str> {
    let header = format!("[{name}]");
    let body = manifest
        .lines()
        .skip_while(|line| line.trim() != header)
        .skip(1);
    body.take_while(|line| !line.starts_with('['))
        .filter(|line| !line.trim().is_empty())
        .collect()
}

/// The members of the workspace, as folders.
fn members() -> Vec<String> {
    let manifest = read("Cargo.toml");
    let line = manifest
        .lines()
        .find(|line| line.starts_with("members"))
        .expect("a workspace has members");
    line.split('"')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

/// The names of `[dependencies]` of a manifest: what is compiled for users, without dev-dependencies.
fn declared(folder: &str) -> Vec<String> {
    let manifest = read(&format!("{folder}/Cargo.toml"));
    section(&manifest, "dependencies")
        .iter()
        .filter_map(|line| line.split(['.', ' ', '=']).next())
        .map(str::to_owned)
        .collect()
}

/// `Cargo.lock`: package (name and version) to the packages it depends on, as written.
fn lock() -> BTreeMap<String, Vec<String>> {
    let text = read("Cargo.lock");
    let value = |block: &str, key: &str| {
        let line = block.lines().find(|line| line.starts_with(key))?;
        line.split('"').nth(1).map(str::to_owned)
    };
    let blocks = text.split("[[package]]").skip(1);
    blocks
        .filter_map(|block| {
            let package = format!("{} {}", value(block, "name =")?, value(block, "version =")?);
            let list = block.split("dependencies = [").nth(1).unwrap_or_default();
            let list = list.split(']').next().unwrap_or_default();
            let needs = list.split('"').skip(1).step_by(2).map(str::to_owned);
            Some((package, needs.collect()))
        })
        .collect()
}

/// Everything the shipped crates compile, themselves included: name and version.
fn compiled_for_users() -> BTreeSet<String> {
    let lock = lock();
    // The lock writes a bare name where only one version exists.
    let packages = |wanted: &str| -> Vec<String> {
        let fits = |known: &&String| *known == wanted || known.split(' ').next() == Some(wanted);
        lock.keys().filter(fits).cloned().collect()
    };
    let mut found = BTreeSet::new();
    let mut open: Vec<String> = SHIPPED
        .iter()
        .flat_map(|(name, _)| packages(name))
        .collect();
    assert_eq!(open.len(), SHIPPED.len(), "every shipped crate is locked");
    while let Some(package) = open.pop() {
        if !found.insert(package.clone()) {
            continue;
        }
        let name = package.split(' ').next().unwrap_or_default();
        let needs = &lock[&package];
        let folder = SHIPPED.iter().find(|(shipped, _)| *shipped == name);
        // Of our own crates the lock also lists dev-dependencies; the manifest tells them apart.
        let wanted = folder.map(|(_, folder)| declared(folder));
        for need in needs {
            let bare = need.split(' ').next().unwrap_or_default();
            if wanted.as_ref().is_none_or(|w| w.iter().any(|x| x == bare)) {
                open.extend(packages(need));
            }
        }
    }
    found
}

fn versions_of(name: &str, of: &BTreeSet<String>) -> Vec<String> {
    let is = |package: &&String| package.split(' ').next() == Some(name);
    of.iter().filter(is).cloned().collect()
}

#[test]
fn there_is_exactly_one_syn_among_the_shipped_dependencies() {
    let compiled = compiled_for_users();
    assert_eq!(versions_of("syn", &compiled).len(), 1, "{compiled:#?}");
    for name in ["quote", "proc-macro2", "nalgebra", "serde", "num-traits"] {
        assert_eq!(
            versions_of(name, &compiled).len(),
            1,
            "{name}: {compiled:#?}"
        );
    }
}

#[test]
fn run_time_crates_depend_on_numbers_and_serde_only() {
    assert_eq!(
        declared("mbd-runtime/scene"),
        ["nalgebra", "num-traits", "serde"]
    );
    // Registers of numbers come along with nalgebra: nothing more is compiled for them.
    assert_eq!(
        declared("mbd-runtime/solver"),
        ["mbd-scene", "nalgebra", "num-traits", "serde", "wide"]
    );
    // The solver does not wait for the compiler behind the macro.
    assert_eq!(declared("mbd-runtime"), ["mbd-macros", "mbd-solver"]);
    let lock = lock();
    let brought = lock
        .iter()
        .filter(|(_, needs)| needs.iter().any(|need| need == "wide"));
    let brought: Vec<&String> = brought.map(|(package, _)| package).collect();
    assert!(
        brought.iter().any(|package| package.starts_with("simba ")),
        "{brought:?}"
    );
}

#[test]
fn dependencies_between_our_crates_form_no_circle() {
    let rank = |name: &str| {
        let order = [
            "mbd-scene",
            "mbd-solver",
            "mbd-compiler",
            "mbd-macros",
            "mbd-runtime",
        ];
        order.iter().position(|known| *known == name)
    };
    for (name, folder) in SHIPPED {
        for need in declared(folder) {
            if let Some(below) = rank(&need) {
                assert!(Some(below) < rank(name), "{name} must not need {need}");
            }
        }
    }
}

#[test]
fn every_crate_forbids_unsafe_code() {
    let workspace = read("Cargo.toml");
    let lints = section(&workspace, "workspace.lints.rust");
    assert!(lints.contains(&"unsafe_code = \"forbid\""), "{lints:?}");
    let members = members();
    assert!(members.len() >= 6, "{members:?}");
    // An allocator that counts cannot be written without it: a package of its own, which nobody depends on.
    for folder in members
        .iter()
        .filter(|folder| *folder != "tests/allocation")
    {
        let manifest = read(&format!("{folder}/Cargo.toml"));
        assert_eq!(
            section(&manifest, "lints"),
            ["workspace = true"],
            "{folder} inherits the lints of the workspace"
        );
    }
}
