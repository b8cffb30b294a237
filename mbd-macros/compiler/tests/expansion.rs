//! What an expansion looks like: golden files, rewritten by `UPDATE_GOLDEN=1 cargo test -p mbd-compiler`.

mod scenes;

use mbd_compiler::{Equations, NameSpans, Settings, emit_model};
use mbd_scene::{AngularVelocity, NodeModel, Scene};

fn formatted(scene: &Scene, settings: &Settings) -> String {
    let tokens = emit_model(&Equations::trace(scene), &NameSpans::default(), settings);
    let file: syn::File = syn::parse2(tokens.clone()).unwrap_or_else(|error| {
        panic!("not Rust: {error}\n{tokens}");
    });
    prettyplease::unparse(&file)
}

fn compare(name: &str, text: &str) {
    let path = format!("{}/tests/golden/{name}.rs", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, text).expect("the golden folder can be written");
    }
    let golden = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = golden.lines().zip(text.lines()).position(|(a, b)| a != b);
    assert!(
        golden == text,
        "{name} differs from its golden file in line {:?}; if that is meant, run with UPDATE_GOLDEN=1",
        differs.map(|line| line + 1)
    );
}

#[test]
fn a_scene_of_three_points_and_four_lines() {
    compare("knot", &formatted(&scenes::knot(), &Settings::default()));
}

#[test]
fn the_parachute() {
    let scene = scenes::parachute(NodeModel::Static, AngularVelocity::Body);
    compare("parachute", &formatted(&scene, &Settings::default()));
}

#[test]
fn the_same_scene_gives_the_same_tokens() {
    for scene in scenes::all() {
        let settings = Settings {
            verify: true,
            ..Settings::default()
        };
        assert_eq!(formatted(&scene, &settings), formatted(&scene, &settings));
    }
}
