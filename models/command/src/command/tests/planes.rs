//! Scenes in a plane.

use super::*;

/// A planar four-bar as text and how it is run.
const PLANAR: &str = include_str!("../../../../scenes/linkage.mbd");

#[test]
fn a_planar_scene_is_checked_expanded_converted_and_run_and_its_drawing_looks_along_the_normal() {
    let folder = Folder::new("planar");
    let text = folder.file("linkage.mbd", PLANAR);
    let toml = folder.file("linkage.toml", &run(&["convert", &text]).unwrap());
    let histories = [&text, &toml].map(|file| {
        let told = run(&["check", file]).unwrap();
        for word in ["freedoms (Grübler): 3·3 + 2·1 − 8 = 3", "Scene Linkage"] {
            assert!(told.contains(word), "{word}\n{told}");
        }
        assert!(
            run(&["expand", file])
                .unwrap()
                .contains("struct LinkageState")
        );
        let out = folder.0.join("out").display().to_string();
        run(&["run", file, "--out", &out, "--until", "0.5 s"]).unwrap();
        let drawing = std::fs::read_to_string(folder.0.join("out/mechanism.svg")).unwrap();
        assert!(drawing.contains("the mechanism, xz plane"));
        assert!(!folder.0.join("out/mechanism_2.svg").exists());
        std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap()
    });
    assert_eq!(histories[0], histories[1]);
    let head = histories[0].lines().next().unwrap();
    for column in ["crank.x", "crank.z", "crank.angle", "weight.z"] {
        assert!(head.contains(column), "{column}: {head}");
    }
    for absent in ["crank.y", "crank.qw", "weight.y", "crank.omega_body_x"] {
        assert!(!head.contains(absent), "{absent}: {head}");
    }
}

#[test]
fn settings_that_no_run_can_hold_are_refused_before_it() {
    let folder = Folder::new("settings");
    for (setting, what) in [
        ("every = \"1e-300 s\"", "`every`: asks for"),
        ("every = \"0 s\"", "`every`: must be positive"),
        ("until = \"-1 s\"", "`until`: must not be negative"),
        ("until = nan", "`until`: give it a finite value"),
        (
            "tolerance = \"1 s\"",
            "`tolerance`: `1 s` has the wrong unit",
        ),
    ] {
        let key = setting.split(' ').next().unwrap();
        let lines = PLANAR.lines().filter(|line| !line.starts_with(key));
        let text = lines.collect::<Vec<_>>().join("\n");
        let text = text.replace("[run]", &format!("[run]\n{setting}"));
        let error = run(&["run", &folder.file("linkage.mbd", &text)]).unwrap_err();
        assert_eq!(error.code(), 2, "{error}");
        assert!(error.to_string().contains(what), "{setting}: {error}");
    }
}

#[test]
fn a_coordinate_that_a_plane_does_not_have_is_told_with_those_it_has() {
    let folder = Folder::new("plane_start");
    for (wrong, right) in [
        ("crank.y = \"1 m\"", "crank.x"),
        ("crank.qw = 1.0", "crank.angle"),
        ("crank.omega_body_y = \"1 rad/s\"", "omega"),
        ("weight.y = \"1 m\"", "weight.x"),
    ] {
        let text = PLANAR.replace("[run.start]", &format!("[run.start]\n{wrong}"));
        let file = folder.file("linkage.mbd", &text);
        let error = run(&["run", &file]).unwrap_err();
        let told = error.to_string();
        assert_eq!(error.code(), 2, "{told}");
        let name = wrong.split(" =").next().unwrap();
        println!("{told}");
        assert!(told.contains(name) && told.contains(right), "{told}");
    }
}

#[test]
fn a_plane_that_is_found_is_told_and_run_in_and_none_is_told_with_what_leaves_it() {
    let folder = Folder::new("plane_found");
    let history = |name: &str, text: &str| {
        let file = folder.file(name, text);
        let out = folder.0.join("out").display().to_string();
        run(&["run", &file, "--out", &out, "--until", "0.5 s"]).unwrap();
        let told = run(&["check", &file]).unwrap();
        let history = std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap();
        (told, history)
    };
    assert!(PLANAR.contains("planar: xz;"));
    let (_, given) = history("given.mbd", PLANAR);
    let auto = PLANAR.replace("planar: xz;", "planar: auto;");
    let (told, found) = history("found.mbd", &auto);
    assert!(
        told.contains("planar: xz: nothing leaves this plane"),
        "{told}"
    );
    assert_eq!(given, found);
    let left = |file: &str| std::fs::read_to_string(folder.0.join("out").join(file)).unwrap();
    assert!(left("report.html").contains("absolute, in the plane xz"));
    let numbers: serde_json::Value = serde_json::from_str(&left("summary.json")).unwrap();
    assert_eq!(
        [&numbers["coordinates"], &numbers["planar"]],
        ["absolute", "xz"]
    );
    let across = "load side on weight = [0 N, 1 N, 0 N]; planar: auto;";
    // Starts in a plane are no starts in space.
    let (declaration, _) = PLANAR.split_once("[run]").unwrap();
    let across = declaration.replace("planar: xz;", across);
    let told = run(&["check", &folder.file("across.mbd", &across)]).unwrap();
    let why = "xz: `weight` is accelerated out of it";
    assert!(
        told.contains("takes no plane") && told.contains(why),
        "{told}"
    );
}
