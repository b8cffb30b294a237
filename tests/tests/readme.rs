//! The README, followed literally by a new user.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The first fenced block of a language.
fn block(readme: &str, language: &str) -> String {
    let fence = format!("```{language}\n");
    let (_, rest) = readme
        .split_once(&fence)
        .expect("the README has such a block");
    let (code, _) = rest.split_once("```").expect("a fence is closed");
    code.to_owned()
}

#[test]
fn a_new_crate_made_by_following_the_readme_compiles_and_runs() {
    let repository = repository().canonicalize().expect("the repository exists");
    let readme = fs::read_to_string(repository.join("README.md")).expect("there is a README");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readme/lamp");
    fs::create_dir_all(folder.join("src")).expect("a temporary folder");
    let runtime = repository.join("mbd-runtime");
    let dependencies = block(&readme, "toml").replace(
        "../mbd/mbd-runtime",
        runtime.to_str().expect("a path in UTF-8"),
    );
    let manifest = format!(
        "[package]\nname = \"lamp\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n{dependencies}\n[workspace]\n"
    );
    fs::write(folder.join("Cargo.toml"), manifest).expect("written");
    fs::write(folder.join("src/main.rs"), block(&readme, "rust")).expect("written");
    // The versions this repository was tested with, so that nothing has to be looked up.
    fs::copy(repository.join("Cargo.lock"), folder.join("Cargo.lock")).expect("copied");
    let run = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--offline"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .output()
        .expect("cargo runs");
    let (out, err) = (
        String::from_utf8_lossy(&run.stdout),
        String::from_utf8_lossy(&run.stderr),
    );
    assert!(run.status.success(), "{err}");
    let mut rows = out.lines();
    let header = rows.next().expect("a header");
    assert!(header.starts_with("time"), "{header}");
    assert!(
        header.contains("pull [N]") && header.contains("cord.tension [N]"),
        "{header}"
    );
    assert_eq!(rows.count(), 9, "{out}");
}
