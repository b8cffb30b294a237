//! A scene in both forms says the same and runs the same.

use super::*;

#[test]
fn a_compiled_scene_and_its_toml_run_to_the_same_history() {
    let folder = Folder::new("compiled");
    let toml = folder.file(
        "pendulum.toml",
        &run(&["convert", "double_pendulum"]).unwrap(),
    );
    let histories = ["double_pendulum", &toml].map(|scene| {
        let out = folder.0.join("out").display().to_string();
        run(&["run", scene, "--out", &out, "--until", "0.5 s"]).unwrap();
        assert!(folder.0.join("out/mechanism.svg").is_file());
        std::fs::read(folder.0.join("out/history.csv")).unwrap()
    });
    assert_eq!(histories[0], histories[1]);
}

#[test]
fn a_scene_survives_conversion_to_toml_and_runs_to_the_same_history() {
    let folder = Folder::new("convert");
    let text = folder.file("swing.mbd", include_str!("../../../../scenes/swing.mbd"));
    let toml = folder.file("swing.toml", &run(&["convert", &text]).unwrap());
    let histories = [&text, &toml].map(|path| {
        let out = folder.0.join("out").display().to_string();
        run(&["run", path, "--out", &out, "--until", "0.5 s"]).unwrap();
        std::fs::read(folder.0.join("out/history.csv")).unwrap()
    });
    assert_eq!(histories[0], histories[1]);
}

#[test]
fn every_ready_scene_is_the_same_in_both_forms() {
    for name in list::names() {
        let folder = Folder::new(&format!("forms_{name}"));
        let (toml, text) = (
            run(&["convert", name]).unwrap(),
            run(&["convert", name, "--to", "mbd"]).unwrap(),
        );
        let read = |file: &str| SceneFile::find(file.as_ref()).unwrap();
        let toml = read(&folder.file("scene.toml", &toml));
        let text = read(&folder.file("scene.mbd", &text));
        assert_eq!(toml.scene, text.scene, "{name}");
        assert_eq!(toml.settings, text.settings, "{name}");
    }
    // A document keeps its repetitions and units; any other form is an error that names both.
    let text = run(&["convert", "drop", "--to", "mbd"]).unwrap();
    for kept in [
        "model Drop<T> {",
        "line leg[i in 0..3] from capsule.bridle[i]",
        "const RHO = 0.014 kg/m^3;",
    ] {
        assert!(text.contains(kept), "{kept}\n{text}");
    }
    let error = run(&["convert", "drop", "--to", "json"])
        .unwrap_err()
        .to_string();
    assert!(error.contains("toml, mbd"), "{error}");
}

#[test]
fn what_a_person_wrote_keeps_its_units_repetitions_and_expressions_in_both_forms() {
    const CHAIN: &str = "pub model Chain {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    const N = 3;
    // Light ones.
    body link[i in 0..N] {
        mass: 500 g,
        inertia: diag(55, 55, 1) g*m^2,
        frame top at [0.0, 0.0, 40 cm] rotated rpy(0, 0, 45 deg),
        frame tip at [0.0, 0.0, -40 cm],
    }
    joint first: hinge from world to link[0].top { axis: y, start: 30 deg }
    joint pin[i in 1..N]: hinge from link[i - 1].tip to link[i].top { axis: y, stops: [-80, 80] deg, stop_stiffness: 1 kN*m }
    output bend = first.angle in deg;
}

[run]
until = \"1 s\"
";
    let folder = Folder::new("kept");
    let text = folder.file("chain.mbd", CHAIN);
    let written = run(&["convert", &text]).unwrap();
    for kept in [
        "mass = \"500 g\"",
        "inertia = \"diag(55, 55, 1) g*m^2\"",
        "\"link[i in 0..N]\"",
        "rotated = \"rpy(0, 0, 45 deg)\"",
        "start = \"30 deg\"",
        "stops = \"[-80, 80] deg\"",
        "[run]\nuntil = \"1 s\"",
    ] {
        assert!(written.contains(kept), "{kept}\n{written}");
    }
    let toml = folder.file("chain.toml", &written);
    let back = folder.file(
        "back.mbd",
        &run(&["convert", &toml, "--to", "mbd"]).unwrap(),
    );
    let same = run(&["convert", &text, "--to", "mbd"]).unwrap();
    assert!(same.contains("// Light ones."), "{same}");
    let scene = |file: &str| SceneFile::find(file.as_ref()).unwrap().scene;
    assert_eq!(scene(&toml), scene(&text));
    assert_eq!(scene(&back), scene(&text));
}

#[test]
fn comments_stay_with_what_they_stood_above_or_beside_in_both_forms() {
    const TEXT: &str = "// A pendulum from the lab.
model Pend {
  gravity: [0.0, 0.0, -9.81] m/s^2; // as measured
  // Numbers.
  const A = 3 m; // of A
  /* A block
   * of text. */
  /// The bob.
  body bob {
    mass: 2 kg, // weighed
    // Guessed.
    inertia: diag(0.1, 0.2, 0.15) kg*m^2,
    frame top at [0.0, 0.0, 0.5] m, /* \"top\" # of it */
    frame low at [0.0, 0.0, -0.5] m,
    start at [0, 0, -0.5 m], // put
  }
  // The pin.
  joint pin: hinge from world to bob.top { axis: y } // oiled
  output o = A + bob.low.position.z; // out
  // The end.
}
[run]
# Of the run.
until = \"1 s\"
";
    let folder = Folder::new("comments");
    let text = folder.file("pend.mbd", TEXT);
    let toml = folder.file("pend.toml", &run(&["convert", &text]).unwrap());
    let written = std::fs::read_to_string(&toml).unwrap();
    for kept in [
        "# A pendulum from the lab.\nmodel",
        "# as measured\ngravity",
        "# Numbers.\n# of A\nA = ",
        "# A block\n# of text.\n[body.bob]\ndoc = \"The bob.\"\n# weighed\nmass",
        "# Guessed.\ninertia",
        "# \"top\" # of it\nframe.top",
        "# put\nstart",
        "# The pin.\n[joint.pin]",
        "# oiled\naxis",
        "# out\no = ",
        "# The end.\n",
        "[run]\n# Of the run.",
    ] {
        assert!(written.contains(kept), "{kept}\n{written}");
    }
    let back = run(&["convert", &toml, "--to", "mbd"]).unwrap();
    let back = folder.file("back.mbd", &back);
    assert_eq!(run(&["convert", &back]).unwrap(), written, "and back again");
}
