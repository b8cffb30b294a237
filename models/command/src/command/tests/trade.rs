//! What accuracy costs: `mbd trade` and `mbd advise`.

use super::*;

/// A pendulum on a soft rope, declared as a file.
const ROPE: &str = "model Rope { gravity: [0, 0, -9.81] m/s^2;
      point bob { mass: 1 kg, start at [0.9, 0, -0.6] m }
      spring rope from world to bob { free_length: 1 m, stiffness: 200 N/m, damping: 1 N*s/m }
      output height = bob.position.z; }
    [run]\nuntil = \"2 s\"\n";

#[test]
fn a_trade_says_what_meets_the_error_that_is_wanted() {
    let folder = Folder::new("trade");
    let file = folder.file("rope.mbd", ROPE);
    let out = folder.0.join("out").display().to_string();
    let asked = ["--output", "height", "--within", "1e-6", "--out", &out];
    let told = run(&[&["trade", file.as_str()], &asked[..]].concat()).unwrap();
    assert!(told.contains("for height within 1e-6 m: take "), "{told}");
    for method in [
        "RK4",
        "Rattle",
        "Tsit5",
        "Vern7",
        "Rodas5P",
        "single precision",
    ] {
        assert!(told.contains(method), "{method}: {told}");
    }
    for name in ["trade.csv", "trade.svg", "trade.html"] {
        assert!(folder.0.join("out").join(name).is_file(), "{name}");
    }
    let page = std::fs::read_to_string(folder.0.join("out/trade.html")).unwrap();
    assert!(page.contains("mbd-data"));
    // What is advised is as good as it was asked to be, and so is its repetition by itself.
    let alone = run(&[&["advise", file.as_str()], &asked[..4]].concat()).unwrap();
    let error = alone.split("error ").nth(1);
    let error = error.and_then(|rest| rest.split(' ').next()?.parse().ok());
    assert!(
        error.is_some_and(|error: f64| error <= 1e-6 / 3.0),
        "{alone}"
    );
}

#[test]
fn a_trade_races_both_families_of_coordinates() {
    let folder = Folder::new("families");
    let text = "model Arms { coordinates: auto; gravity: [0, 0, -9.81] m/s^2;
          body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
          body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
          joint p: hinge from world to a.top { axis: y, start: 0.7 rad }
          joint q: hinge from a.end to b.top { axis: x, start: 0.4 rad }
          output swing = b.position.x; }
        [run]\nuntil = \"1 s\"\n";
    for (declared, other) in [("auto", "absolute"), ("absolute", "relative")] {
        let text = text.replace("auto", declared);
        let file = folder.file("arms.mbd", &text);
        let out = folder.0.join("out").display().to_string();
        let told = run(&["trade", &file, "--output", "swing", "--out", &out]).unwrap();
        let other = format!("{other} coordinates");
        let row = told
            .lines()
            .find(|line| line.contains(&other) && line.contains("Vern7"));
        let row = row.unwrap_or_else(|| panic!("{other}: {told}"));
        // The motion is the same: the finest setting is as near to the reference as that of the declared family.
        assert!(told.contains("single precision"), "{row}");
        let errors = told.lines().filter(|line| line.contains(&other));
        let errors = errors.filter_map(|line| line.split_whitespace().rev().nth(2)?.parse().ok());
        let best = errors.fold(f64::INFINITY, f64::min);
        assert!(best < 1e-9, "{other}: {best}");
    }
    let told = run(&["check", &folder.file("arms.mbd", text)]).unwrap();
    for part in [
        "note: coordinates: relative: a step of RK4 takes ",
        "relative coordinates of the joints p, q",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn a_trade_that_cannot_be_measured_says_why() {
    let folder = Folder::new("no_trade");
    let file = folder.file("rope.mbd", ROPE);
    for (flags, what) in [
        (&["--output", "hight"][..], "no column `hight`"),
        (&["--output", "height", "--window", "3"], "--window `3`"),
        (
            &["--output", "height", "--window", "2..1"],
            "--window `2..1`",
        ),
        (&["--output", "height", "--within", "-1"], "--within -1"),
        (
            &["--output", "height", "--within", "1 mN"],
            "--within 1 mN: the column is in m",
        ),
    ] {
        let error = run(&[&["advise", file.as_str()], flags].concat()).unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    }
    // References agree to rounding only: nothing is advised for less.
    let told = run(&["advise", &file, "--output", "height", "--within", "1e-20"]).unwrap();
    assert!(told.contains("no advice"), "{told}");
}

#[test]
fn the_advice_for_a_stiff_scene_is_the_stiff_method() {
    let folder = Folder::new("stiff_advice");
    let text = "model Stiff { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg, start at [0, 0, -1.5] m }
          spring rope from world to bob { free_length: 1 m, stiffness: 1e3 N/m, damping: 1e9 N*s/m }
          output height = bob.position.z; }
        [run]\nuntil = \"2 s\"\n";
    let file = folder.file("stiff.mbd", text);
    let told = run(&["advise", &file, "--output", "height"]).unwrap();
    assert!(told.contains("Rodas5P"), "{told}");
}

#[test]
fn a_column_that_is_not_there_is_told_before_the_unit_of_an_error_in_it() {
    let told = run(&["trade", "swing", "--output", "nosuch", "--within", "1N"])
        .unwrap_err()
        .to_string();
    assert!(
        told.contains("the history has no column `nosuch`; there are: "),
        "{told}"
    );
    let told = run(&["trade", "swing", "--output", "hieght"]).unwrap_err();
    assert!(
        told.to_string()
            .contains("no column `hieght`; did you mean `height`? There are: "),
        "{told}"
    );
}

#[test]
fn what_a_trade_measures_is_what_a_run_does_with_the_setting() {
    let folder = Folder::new("trade_as_run");
    // A load whose work is integrated along, scales of its own, and switches that are not located.
    let text = "model Orbit { gravity: none;
          point p { mass: 1 kg, start at [0.4, 0, 0] m velocity [0, 2, 0] m/s }
          load pull on p = -1 N*m^2 * p.position / norm(p.position)^3;
          output x = p.position.x; }
        [run]\nuntil = \"5 s\"\n";
    let scaled = "[run.scales]\nlength = \"1 mm\"\nspeed = \"1 mm/s\"\n";
    for (name, settings) in [("plain", ""), ("scaled", scaled)] {
        let file = folder.file(&format!("{name}.mbd"), &format!("{text}{settings}"));
        let out = folder.0.join(name);
        let to = out.display().to_string();
        run(&["trade", &file, "--output", "x", "--out", &to]).unwrap();
        let table = std::fs::read_to_string(out.join("trade.csv")).unwrap();
        let row = table
            .lines()
            .find(|row| row.starts_with("as declared,Tsit5 1e-6,"));
        let steps = row.and_then(|row| row.split(',').nth(2)?.parse::<u64>().ok());
        let flags = [
            "--method",
            "tsit5",
            "--tol",
            "1e-6",
            "--no-estimate",
            "--json",
        ];
        let told = run(&[&["run", &file, "--out", &to], &flags[..]].concat()).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!(summary["steps"].as_u64(), steps, "{name}: {row:?}");
    }
}
