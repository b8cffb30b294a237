//! The README and the pages under `docs/`, followed literally by a new user.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use proc_macro2::{TokenStream, TokenTree};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A text of the repository.
fn text(path: &str) -> String {
    fs::read_to_string(repository().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The fenced blocks of a language, in order.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let fence = format!("```{language}\n");
    let open = page.split(&fence).skip(1);
    open.map(|rest| rest.split("```").next().unwrap_or_default())
        .collect()
}

/// What is compiled of this repository is compiled as for a user who sets nothing, but for what debuggers want. The crates of others are set as in
/// this workspace, whose tests have compiled them: cargo finds them where nothing about them differs.
fn settings_of_a_user() -> String {
    let workspace: toml::Table = text("Cargo.toml").parse().expect("a manifest");
    let mut dev = workspace["profile"]["dev"].clone();
    let packages = dev["package"].as_table_mut().expect("packages");
    let unset = toml::Table::from_iter([
        ("opt-level".to_owned(), 0.into()),
        ("debug-assertions".to_owned(), true.into()),
    ]);
    for name in ["compiler", "macros", "runtime", "scene", "solver"] {
        packages.insert(format!("mbd-{name}"), unset.clone().into());
    }
    packages.insert("lamp".to_owned(), unset.into());
    let profile = toml::Table::from_iter([("dev".to_owned(), dev)]);
    toml::Table::from_iter([("profile".to_owned(), profile.into())]).to_string()
}

#[test]
fn a_new_crate_made_by_following_the_readme_compiles_and_runs() {
    let repository = repository().canonicalize().expect("the repository exists");
    let readme = text("README.md");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readme/lamp");
    fs::create_dir_all(folder.join("src")).expect("a temporary folder");
    let runtime = repository.join("mbd-runtime");
    let dependencies = blocks(&readme, "toml")[0].replace(
        "../mbd/mbd-runtime",
        runtime.to_str().expect("a path in UTF-8"),
    );
    let manifest = format!(
        "[package]\nname = \"lamp\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n{dependencies}\n[workspace]\n"
    );
    fs::write(folder.join("Cargo.toml"), manifest).expect("written");
    fs::write(folder.join("src/main.rs"), blocks(&readme, "rust")[0]).expect("written");
    // The versions this repository was tested with, so that nothing has to be looked up.
    fs::copy(repository.join("Cargo.lock"), folder.join("Cargo.lock")).expect("copied");
    fs::create_dir_all(folder.join(".cargo")).expect("a folder");
    fs::write(folder.join(".cargo/config.toml"), settings_of_a_user()).expect("written");
    // Beside what this test was compiled from; nobody builds this crate twice.
    let built = Path::new(env!("CARGO_TARGET_TMPDIR")).parent();
    let run = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--offline"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", built.expect("a folder"))
        .env("CARGO_INCREMENTAL", "0")
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

/// What runs a model is compiled in the profile that the README gives to users as it is in that which this workspace is tested with.
#[test]
fn the_profile_of_the_readme_compiles_the_solvers_as_the_workspace_does() {
    let readme = text("README.md");
    let workspace = text("Cargo.toml");
    let profile = blocks(&readme, "toml")[1];
    for entry in [
        "[profile.dev]\nopt-level = 1\n",
        "[profile.dev.build-override]\nopt-level = 1\n",
    ] {
        assert!(
            profile.contains(entry) && workspace.contains(entry),
            "{entry}"
        );
    }
    assert!(workspace.contains("[profile.dev.package.\"*\"]\nopt-level = 2\n"));
    for name in ["mbd-scene", "mbd-solver"] {
        let own = format!("{name} = {{ opt-level = 2, codegen-units = 4,");
        assert!(profile.contains(&own), "{own}");
        let units = format!("{name}.codegen-units = 1\n");
        assert!(workspace.contains(&units), "{units}");
    }
}

#[test]
fn pages_link_to_files_that_exist() {
    let folder = repository().join("docs");
    let pages = fs::read_dir(folder).expect("there are pages");
    let mut pages: Vec<String> = pages
        .map(|page| page.expect("a page").file_name())
        .map(|name| format!("docs/{}", name.to_str().expect("a name in UTF-8")))
        .collect();
    let readme = text("README.md");
    for page in &pages {
        let link = format!("]({page})");
        assert!(readme.contains(&link), "the README does not list {page}");
    }
    pages.push("README.md".to_owned());
    for page in pages {
        let (folder, _) = page.rsplit_once('/').unwrap_or((".", ""));
        for link in text(&page).split("](").skip(1) {
            let target = link.split([')', '#']).next().unwrap_or_default();
            let path = repository().join(folder).join(target);
            assert!(path.exists(), "{page} links to {target}");
        }
    }
}

/// The walk through a joint quotes the joint itself, the list and the contract.
#[test]
fn the_page_about_a_new_joint_quotes_what_is_there() {
    let page = text("docs/adding_a_joint.md");
    let joints = "mbd-runtime/scene/src/joints";
    let sources = ["hinge", "mod"].map(|file| text(&format!("{joints}/{file}.rs")));
    for quoted in blocks(&page, "rust") {
        assert!(
            sources.iter().any(|source| source.contains(quoted)),
            "neither hinge.rs nor mod.rs has these lines:\n{quoted}"
        );
    }
    let folder = "tests/laws/tests/laws/joints";
    let contract = ["contract", "split"].map(|file| text(&format!("{folder}/{file}.rs")));
    let rows = page.lines().filter_map(|line| line.strip_prefix("| `"));
    for test in rows.filter_map(|row| row.split('`').next()) {
        let signature = format!("fn {test}()");
        assert!(
            contract.iter().any(|file| file.contains(&signature)),
            "no test is called {test}"
        );
    }
}

/// Names of the public items of emitted code, those of the trait's functions aside.
fn public_items(code: TokenStream, names: &mut BTreeSet<String>) {
    let mut is_public = false;
    for token in code {
        match token {
            TokenTree::Group(group) => public_items(group.stream(), names),
            TokenTree::Ident(word) => match word.to_string().as_str() {
                "pub" => is_public = true,
                "fn" | "const" | "struct" | "trait" | "type" => {}
                name if is_public => {
                    names.insert(name.to_owned());
                    is_public = false;
                }
                _ => {}
            },
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
    }
}

#[test]
fn the_page_about_generated_code_names_every_public_item() {
    let page = text("docs/generated_code.md");
    let declaration = blocks(&page, "text")[0].trim();
    let declaration = declaration.parse().expect("a declaration is tokens");
    let mut emitted = BTreeSet::new();
    public_items(mbd_compiler::compile(declaration), &mut emitted);
    let rows = page.lines().filter_map(|line| line.strip_prefix("| `"));
    let named = rows.filter_map(|row| row.split('`').next());
    let named: BTreeSet<String> = named.map(str::to_owned).collect();
    let missing: Vec<_> = emitted.difference(&named).collect();
    let gone: Vec<_> = named.difference(&emitted).collect();
    assert!(
        missing.is_empty() && gone.is_empty(),
        "not on the page: {missing:?}; not in the code: {gone:?}"
    );
}
