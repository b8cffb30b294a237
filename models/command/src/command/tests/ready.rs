//! The ready scenes by their names: checked, listed, expanded, run.

use super::*;

#[test]
fn the_quantities_of_a_scene_are_listed_with_units() {
    let text = run(&["list", "quantities", "four_bar"]).unwrap();
    for part in [
        "rad/s^2",
        "outputs, metrics, events",
        ".force",
        "_acceleration",
        "m/s",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert_eq!(run(&["list", "quantities", "swnig"]).unwrap_err().code(), 1);
}

#[test]
fn a_ready_scene_expands_to_the_functions_it_was_compiled_with() {
    // `emit: [outputs, energy, lines, reactions, mass_matrix];`
    let text = run(&["expand", "four_bar"]).unwrap();
    for emitted in [
        "fn derivative",
        "fn reactions",
        "fn mass_matrix",
        "fn projection_step",
    ] {
        assert!(text.contains(emitted), "{emitted}");
    }
    for absent in ["fn multipliers", "fn momentum", "fn constraint_bias"] {
        assert!(!text.contains(absent), "{absent}");
    }
}

#[test]
fn a_ready_scene_is_checked_expanded_and_converted_by_its_name() {
    for (name, word) in [
        ("heavy_top", "HeavyTop"),
        ("drop", "Drop"),
        ("parachute", "ParachuteRate"),
    ] {
        let told = run(&["check", name]).unwrap();
        assert!(
            told.contains(&format!("Scene {word}")) && !told.contains("warning"),
            "{told}"
        );
        assert!(
            run(&["expand", name])
                .unwrap()
                .contains(&format!("struct {word}Params"))
        );
        let toml = run(&["convert", name]).unwrap();
        assert!(toml.contains(&format!("model = \"{word}")) && toml.contains("[run.start]"));
    }
    for command in ["check", "expand", "convert", "run"] {
        let error = run(&[command, "heavytop"]).unwrap_err();
        assert_eq!(error.code(), 1);
        assert!(
            error.to_string().contains("did you mean `heavy_top`"),
            "{error}"
        );
    }
}

#[test]
fn a_ready_scene_expands_without_warnings_about_what_its_data_no_longer_uses() {
    for name in list::names() {
        let text = run(&["expand", name]).unwrap();
        // What an unused name becomes: see `unused` of the compiler.
        for warned in [
            "struct Declaration",
            "deprecated",
            "#[allow(non_snake_case, non_upper_case_globals)]",
        ] {
            assert!(!text.contains(warned), "{name}: {warned}");
        }
    }
}

#[test]
fn every_listed_scene_runs() {
    for name in list::names() {
        let folder = Folder::new(&format!("list_{name}"));
        let out = folder.0.join("out").display().to_string();
        // Where the lines of `drop` catch, at 0.28 s, its steps are off by 8 % for a while, and a run that ends there says so.
        let told = run(&["run", name, "--out", &out, "--until", "0.2"]).unwrap();
        assert!(told.contains("report.html"), "{told}");
        assert!(folder.0.join("out/summary.json").is_file());
    }
}

#[test]
fn linearise_tells_coordinates_and_frequencies_of_a_ready_scene() {
    let text = run(&["linearise", "double_pendulum"]).unwrap();
    assert!(
        text.contains("Eigenvalues") && text.contains("damping"),
        "{text}"
    );
    let error = run(&["linearise", "linkage", "--along", "crank.angel"]).unwrap_err();
    assert_eq!(error.code(), 2);
    assert!(
        error.to_string().contains("`crank.angel` is no coordinate"),
        "{error}"
    );
    let text = run(&["linearise", "linkage", "--trim"]).unwrap();
    assert!(text.contains("about the rest"), "{text}");
}

#[test]
fn a_trim_without_a_balance_tells_the_rate_of_a_state_in_its_unit_and_another_way() {
    let folder = Folder::new("linearise_unbalanced");
    let file = folder.file(
        "drifts.mbd",
        "model Drifts { gravity: [0, 0, -9.81] m/s^2;
           state missed = 0 rad*s { rate: 0.1 rad }
           body rod { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame top at [0, 0, 1] m }
           joint pin: hinge from world to rod.top { axis: y, damping: 1 N*m*s, force: 1 N*m/(rad*s) * missed } }\n[run]\nuntil = \"1 s\"\n",
    );
    let told = run(&["linearise", &file, "--trim"])
        .unwrap_err()
        .to_string();
    assert!(
        told.contains("`missed` keeps a rate of 0.1 rad after") && told.contains("`--after 60s`"),
        "{told}"
    );
}

#[test]
fn a_pendulum_held_out_level_is_linearised_though_no_mode_of_it_swings() {
    let folder = Folder::new("linearise_level");
    // Level, gravity has no stiffness: −m g d cos 90° / I is 6e-17 of what it is hanging, and a mode of rounding takes years.
    let file = folder.file(
        "level.mbd",
        "model Level { gravity: [0, 0, -9.81] m/s^2;
           body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 1] m }
           joint pin: hinge from world to bob.top { axis: y, start: 90 deg } }",
    );
    let told = run(&["linearise", &file]).unwrap();
    assert!(told.contains("is not known"), "{told}");
}

#[test]
fn linearise_gives_matrices_and_says_where_they_change_along_the_motion() {
    let told = run(&["linearise", "double_pendulum", "--json"]).unwrap();
    let told: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    let count = told["states"].as_array().expect("names").len();
    let a = told["a"].as_array().expect("rows");
    assert!(a.len() == count && a.iter().all(|row| row.as_array().unwrap().len() == count));
    assert!(told["eigenvalues"].as_array().unwrap().len() >= count / 2);
    // A disc that spins on a universal joint: angles of the fork stay, those that turn with the disc do not.
    let folder = Folder::new("linearise_spinning");
    let file = folder.file(
        "disc.mbd",
        "model Disc { gravity: none;
           body fork { mass: 0.1 kg, inertia: diag(1, 1, 1) g*m^2 }
           body disc { mass: 1 kg, inertia: diag(0.02, 0.02, 0.035) kg*m^2 }
           joint u: universal from world to fork.com { axes: [x, y], angle1: { stiffness: 50 N*m }, angle2: { stiffness: 50 N*m } }
           joint spin: hinge from fork.com to disc.com { axis: z, start_rate: 100 rad/s } }",
    );
    // A free disc on springs: about its own axes, which spin, and about those of the world, where precession and nutation are seen as they are.
    for (about, noted, frequency) in [("body", true, "57.45"), ("world", false, "107.4")] {
        let file = folder.file(
            "free_disc.mbd",
            &format!(
                "model Free {{ gravity: none; angular_velocity: {about};
                   body disc {{ mass: 1 kg, inertia: diag(0.01, 0.01, 0.02) kg*m^2, start angular_velocity [0, 0, 50] rad/s }}
                   joint free: free from world to disc.com;
                   load tilt on disc = cross(disc.z, [0, 0, 1]) * 8 N*m; }}"
            ),
        );
        let told = run(&["linearise", &file]).unwrap();
        assert_eq!(
            told.contains("turn with `disc`, at 50.00 rad/s"),
            noted,
            "{told}"
        );
        assert!(told.contains(frequency), "{told}");
    }
    let stays = run(&["linearise", &file]).unwrap();
    assert!(!stays.contains("Note:"), "{stays}");
    let turns = run(&["linearise", &file, "--along", "disc.turn_x"]).unwrap();
    assert!(
        turns.contains("are no frequencies of the motion"),
        "{turns}"
    );
}
