//! `mbd check`: what a scene contains, for people and for programs; mistakes with their places.

use super::*;

#[test]
fn check_tells_bodies_nodes_and_operations() {
    let folder = Folder::new("check");
    let told = run(&[
        "check",
        &folder.file("drop.toml", include_str!("../../../../scenes/drop.toml")),
    ])
    .unwrap();
    for word in [
        "Scene Drop",
        "capsule",
        "stepwise (bdf2)",
        "leg[2]",
        "derivative of the state",
        "riser_k",
    ] {
        assert!(told.contains(word), "{word}:\n{told}");
    }
    let expanded = run(&[
        "expand",
        &folder.file("again.toml", include_str!("../../../../scenes/drop.toml")),
    ])
    .unwrap();
    assert!(expanded.contains("struct DropParams"));
}

#[test]
fn what_no_run_can_be_made_with_is_told_by_check_with_its_line() {
    let folder = Folder::new("check_settings");
    let drop = include_str!("../../../../scenes/drop.toml");
    for (setting, said) in [
        ("[run.params]\nriser_k = \"3 MN/m\"\n", "riser_k"),
        (
            "[run]\nmethod = \"tsit5\"\ntolerance = 1\n",
            "`tolerance`: must be at most 0.01",
        ),
    ] {
        let (scene, _) = drop.split_once("[run]").unwrap();
        let path = folder.file("scene.toml", &format!("{scene}{setting}"));
        let error = run(&["check", &path]).unwrap_err();
        assert_eq!(error.code(), 2);
        assert!(error.to_string().contains(said), "{error}");
    }
    let coil = "model Coil { gravity: none; point bob { mass: 1 kg } spring coil from world to bob { free_length: 1 m, stiffness: 1 kN/m } }";
    let error = run(&["check", &folder.file("coil.mbd", coil)]).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("both ends of `coil` are at the same place"),
        "{error}"
    );
}

#[test]
fn every_mistake_of_a_file_is_told_with_its_place() {
    let folder = Folder::new("mistakes");
    let drop = include_str!("../../../../scenes/drop.toml");
    let text = drop
        .replace("\"16 kg\"", "\"16 kgz\"")
        .replace("\"chute.riser_end\"", "\"chute.riser\"")
        .replace("until =", "untl =");
    let path = folder.file("scene.toml", &text);
    for command in ["check", "run", "expand", "convert"] {
        let error = run(&[command, &path]).unwrap_err();
        assert_eq!(error.code(), 2);
        let told = error.to_string();
        let place = |what: &str| text.lines().position(|line| line.contains(what)).unwrap() + 1;
        for (what, word) in [("16 kgz", "`kgz`"), ("\"chute.riser\"", "`riser`")] {
            let line = told
                .lines()
                .find(|line| line.contains(word))
                .unwrap_or_else(|| panic!("{told}"));
            assert!(
                line.starts_with(&format!("{path}:{}:", place(what))),
                "{told}"
            );
        }
        // The line itself, and a caret under the word.
        let shown = format!(" {} | mass = \"16 kgz\"", place("16 kgz"));
        let (_, after) = told.split_once(&shown).unwrap_or_else(|| panic!("{told}"));
        assert_eq!(
            after.lines().nth(1).map(str::trim_end),
            Some("    |            ^^^")
        );
        assert!(!told.contains('\x1b'), "{told}");
        assert!(
            told.contains(&format!(
                "{path}:{}:1: unknown field `untl`; did you mean `until`? There are: until, method",
                place("untl")
            )) && told.contains("| untl = "),
            "{told}"
        );
        assert!(told.ends_with("3 errors"), "{told}");
    }
}

#[test]
fn mistakes_are_coloured_for_a_terminal_only() {
    let folder = Folder::new("coloured");
    let file = folder.file("m.mbd", "model M {\n\tgravity: nome;\n}\n");
    let Err(CommandFailure::Mistakes(mistakes)) = run(&["check", &file]) else {
        panic!("accepted");
    };
    let (plain, coloured) = (mistakes.text(Paint::Plain), mistakes.text(Paint::Coloured));
    // A tab stays a tab, so that the caret stands under its word.
    assert!(
        plain.contains(" 2 | \tgravity: nome;\n   | \t         ^^^^"),
        "{plain}"
    );
    assert!(
        !plain.contains('\x1b') && coloured.contains("\x1b[1;31m^^^^\x1b[0m"),
        "{coloured}"
    );
    let mut bare = coloured.clone();
    for code in ["\x1b[1m", "\x1b[1;31m", "\x1b[1;34m", "\x1b[0m"] {
        bare = bare.replace(code, "");
    }
    assert_eq!(bare, plain);
}

#[test]
fn check_tells_programs_what_a_scene_contains_and_where_it_is_wrong() {
    let told: serde_json::Value =
        serde_json::from_str(&run(&["check", "swing", "--json"]).unwrap()).unwrap();
    assert_eq!(told["valid"], true);
    assert_eq!(told["scene"], "Swing");
    assert_eq!(told["lines"][2], "fall");
    assert_eq!(told["params"][0]["name"], "k");
    let k = &told["params"][0];
    assert_eq!(
        (&k["range"][1], &k["unit"]),
        (&serde_json::json!(100.0), &serde_json::json!("kN/m"))
    );
    assert_eq!(told["outputs"][0]["unit"], "m");
    let folder = Folder::new("json");
    let file = folder.file(
        "lag.mbd",
        "model Lag { gravity: none; state seen = 60 mm { rate: -seen / 1 s } }",
    );
    let told: serde_json::Value =
        serde_json::from_str(&run(&["check", &file, "--json"]).unwrap()).unwrap();
    let seen = &told["states"][0];
    assert_eq!(
        (&seen["name"], &seen["unit"]),
        (&serde_json::json!("seen"), &serde_json::json!("m"))
    );
    assert_eq!(seen["start"], 0.06);
    let file = folder.file(
        "m.mbd",
        "model M {\n  gravity: nome;\n  body a { mass: 1 }\n}\n",
    );
    let failure = run(&["check", &file, "--json"]).unwrap_err();
    assert_eq!(failure.code(), 2);
    let told: serde_json::Value = serde_json::from_str(&failure.to_string()).unwrap();
    assert_eq!(told["valid"], false);
    let places: Vec<_> = told["errors"].as_array().unwrap().iter().collect();
    assert_eq!(places[0]["line"], 2);
    assert_eq!(places[0]["column"], 12);
    assert!(
        places[0]["text"]
            .as_str()
            .unwrap()
            .contains("did you mean `none`"),
        "{told}"
    );
    assert_eq!(places[1]["line"], 3);
}

#[test]
fn a_setting_that_cannot_be_used_is_told_by_check_and_run_with_its_line() {
    let folder = Folder::new("settings");
    let model = "model M {\n  gravity: none;\n  point a { mass: 1 kg }\n}\n\n[run]\n";
    let file = |line: &str| folder.file("m.mbd", &format!("{model}{line}\n"));
    for (line, what) in [
        ("until = \"1 sek\"", "`until`"),
        ("until = 1\nevery = \"1 m\"", "`every`"),
        ("until = 1\nmethod = \"rk5\"", "`method`"),
        ("[run.start]\na.q = 1", "`start.a.q`"),
    ] {
        let file = file(line);
        let wanted = 6 + line.lines().count();
        let checked = run(&["check", &file]).unwrap_err();
        assert_eq!(checked.code(), 2);
        let checked = checked.to_string();
        let place = format!("m.mbd:{wanted}:1: {what}");
        assert!(checked.contains(&place), "{place}: {checked}");
        let told = run(&["check", &file, "--json"]).unwrap_err().to_string();
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        let error = &told["errors"][0];
        assert_eq!(error["line"], wanted);
        assert!(error["text"].as_str().unwrap().contains(what), "{told}");
    }
    let flown = run(&["run", &file("until = \"1 sek\"")]).unwrap_err();
    assert!(flown.to_string().contains("m.mbd:7:1: `until`"), "{flown}");
    // What was typed stands on no line, and what is missing may be typed.
    let typed = run(&["run", &file("until = 1"), "--until", "1 sek"]).unwrap_err();
    assert!(!typed.to_string().contains("m.mbd:7"), "{typed}");
    run(&["check", &file("tolerance = 1e-6")]).unwrap();
}

#[test]
fn a_lock_that_holds_for_a_while_takes_no_freedom_at_the_start() {
    let folder = Folder::new("checks_locked");
    let scene = folder.file(
        "locked.mbd",
        "model Locked {
            gravity: none;
            body arm { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
            joint pin: hinge from world to arm.com { axis: z, start_rate: 1 rad/s }
            event held = time rises 1 s { lock: pin }
            event freed = time rises 2 s { free: pin }
        }
        [run]
        until = \"3 s\"
        ",
    );
    let out = folder.0.join("out").display().to_string();
    let flown = run(&["run", &scene, "--out", &out]).unwrap();
    let freedoms = flown.lines().find(|line| line.contains("freedoms"));
    let told = freedoms.is_some_and(|line| line.contains("1, 0 while all locks and joints hold"));
    assert!(told, "{flown}");
    for command in ["run", "check"] {
        let more: &[&str] = if command == "run" {
            &["--out", &out]
        } else {
            &[]
        };
        let text = run(&[&[command, scene.as_str(), "--json"], more].concat()).unwrap();
        let told: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(
            [&told["freedoms"], &told["freedoms_held"]],
            [1, 0],
            "{command}"
        );
    }
}
