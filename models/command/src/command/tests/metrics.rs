//! Metrics that a scene declares, as commands tell them.

use serde_json::Value;

use super::*;

const FALL: &str = "model Stone {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    point stone { mass: 1 kg, start at [0.0, 0.0, 20.0] m }
    event landed = stone.position.z falls 0 m { then: stop }
    event never = stone.position.z rises 100 m;
    /// How fast it gets.
    metric fastest = max norm(stone.velocity) in kph;
    metric impulse = integral norm(stone.velocity);
    metric fall = time_of landed;
    metric risen = time_of never;
}

[run]
until = \"3 s\"
tolerance = 1e-9
";

#[test]
fn a_run_tells_its_metrics_in_its_summary_and_on_its_page_and_none_where_there_is_none() {
    let folder = Folder::new("metrics");
    let scene = folder.file("stone.mbd", FALL);
    let out = folder.0.join("out");
    run(&["run", &scene, "--out", &out.display().to_string()]).unwrap();
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let metrics = &summary["metrics"];
    for (name, expected) in [("fastest", 72.0), ("impulse", 20.0), ("fall", 2.0)] {
        let found = metrics[name].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-6, "{name}: {found}");
    }
    assert!(metrics["risen"].is_null(), "{metrics}");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    for part in ["Metrics", "fastest", "time_of", "impulse"] {
        assert!(page.contains(part), "{part}");
    }
    // A row has what a metric is taken of, in its unit, and says so: the number of the metric is that of the run.
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let header = history.lines().find(|line| line.starts_with("time"));
    let header: Vec<&str> = header.unwrap().split(',').collect();
    let held = |name: &&&str| name.contains("fastest") || name.contains("impulse");
    let held: Vec<&&str> = header.iter().filter(held).collect();
    assert_eq!(held, [&"fastest.quantity [kph]", &"impulse.quantity [m/s]"]);
    let told: Value = serde_json::from_str(&run(&["check", "--json", &scene]).unwrap()).unwrap();
    let names = told["outputs"].as_array().unwrap().iter();
    let names: Vec<&str> = names.map(|it| it["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["fastest.quantity", "impulse.quantity"]);
}

#[test]
fn a_run_on_a_coarse_grid_tells_where_it_ended() {
    let folder = Folder::new("metrics_every");
    let text = FALL.replace("until =", "every = \"0.3 s\"\nuntil =");
    let text = text.replace(
        "metric fall",
        "metric impact = final stone.velocity.z;\n    metric deepest = min stone.position.z;\n    metric fall",
    );
    let scene = folder.file("stone.mbd", &text);
    let out = folder.0.join("out");
    run(&["run", &scene, "--out", &out.display().to_string()]).unwrap();
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let exact = [
        ("fastest", 72.0),
        ("impulse", 20.0),
        ("fall", 2.0),
        ("impact", -20.0),
        ("deepest", 0.0),
    ];
    for (name, expected) in exact {
        let found = summary["metrics"][name].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-7, "{name}: {found}");
    }
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let last = history.lines().last().unwrap();
    let time: f64 = last.split(',').next().unwrap().parse().unwrap();
    assert!((time - 2.0).abs() < 1e-9, "{last}");
}

#[test]
fn a_scene_with_metrics_is_converted_and_back() {
    let folder = Folder::new("metrics_convert");
    let scene = folder.file("stone.mbd", FALL);
    let toml = run(&["convert", &scene]).unwrap();
    assert!(
        toml.contains("[metric.fastest]") && toml.contains("in = \"kph\""),
        "{toml}"
    );
    let document = folder.file("stone.toml", &toml);
    let text = run(&["convert", &document, "--to", "mbd"]).unwrap();
    assert!(text.contains("metric fall = time_of landed;"), "{text}");
    let back = folder.file("back.mbd", &text);
    assert_eq!(run(&["convert", &back]).unwrap(), toml);
    let told = run(&["check", &scene, "--json"]).unwrap();
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(told["metrics"][0]["take"], "max");
}

#[test]
fn the_metrics_of_a_scene_are_listed_with_units_and_meaning() {
    let text = run(&["list", "metrics", "swing"]).unwrap();
    for part in [
        "hardest_pull",
        "max",
        "The largest pull in the fall line.",
        "lowest",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let unit = |name: &str| {
        let line = text.lines().find(|line| line.contains(name)).unwrap();
        line.split_whitespace().nth(2).unwrap().to_owned()
    };
    assert_eq!(
        [unit("hardest_pull"), unit("deepest"), unit("first_lowest")],
        ["N", "m", "s"]
    );
    let none = run(&["list", "metrics", "linkage"]).unwrap();
    assert!(none.contains("Linkage declares no metrics"), "{none}");
    assert_eq!(run(&["list", "metrics", "swnig"]).unwrap_err().code(), 1);
}

#[test]
fn programs_read_every_list() {
    let read = |what: &[&str]| -> Vec<Value> {
        let text = run(&[&["list"], what, &["--json"]].concat()).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let scenes = read(&[]);
    let named: Vec<_> = scenes
        .iter()
        .filter_map(|one| one["name"].as_str())
        .collect();
    assert_eq!(named, list::names().collect::<Vec<_>>());
    let quantities = read(&["quantities", "swing"]);
    let tension = quantities.iter().find(|one| one["name"] == "fall.tension");
    let tension = tension.unwrap();
    assert_eq!(tension["unit"], "N");
    assert_eq!(tension["components"], 1);
    let folder = Folder::new("metrics_list");
    let scene = folder.file("stone.mbd", FALL);
    let metrics = read(&["metrics", &scene]);
    let told = |name: &str| metrics.iter().find(|one| one["name"] == name).unwrap();
    assert_eq!(metrics.len(), 4);
    assert_eq!(told("fastest")["take"], "max");
    assert_eq!(told("fastest")["unit"], "kph");
    assert_eq!(told("fastest")["doc"], "How fast it gets.");
    assert_eq!(told("impulse")["unit"], "m");
    assert_eq!(told("fall")["at"], "landed");
    assert!(read(&["metrics", "linkage"]).is_empty());
}

#[test]
fn a_metric_without_a_value_says_why_on_the_page() {
    let folder = Folder::new("metrics_missing");
    let scene = folder.file("stone.mbd", FALL);
    let out = folder.0.join("out");
    let page = |flags: &[&str]| {
        let out = out.display().to_string();
        let _ = run(&[&["run", &scene, "--out", &out], flags].concat());
        std::fs::read_to_string(format!("{out}/report.html")).unwrap()
    };
    let whole = page(&[]);
    assert!(whole.contains("has no value: its event did not happen"));
    // A largest value up to where a run was given up is not that of the run.
    let given_up = page(&["--max-steps", "2"]);
    assert_eq!(
        given_up
            .matches("has no value: the run stopped before its end")
            .count(),
        4
    );
}

#[test]
fn runs_side_by_side_are_compared_by_their_metrics() {
    let folder = Folder::new("metrics_compared");
    let scene = folder.file("stone.mbd", FALL);
    let other = format!("{scene} --until 1s");
    let out = folder.0.join("out").display().to_string();
    let told = run(&["compare", &scene, &other, "--out", &out]).unwrap();
    let fall = told.lines().find(|line| line.contains("metric fall"));
    assert!(fall.is_some_and(|line| line.contains('2')), "{told}");
    assert!(!told.contains("metric risen"), "{told}");
}

#[test]
fn a_run_tells_its_metrics_on_the_terminal() {
    let folder = Folder::new("told_metrics");
    let out = folder.0.join("out").display().to_string();
    let told = run(&["run", "swing", "--until", "1", "--out", &out]).unwrap();
    for name in ["hardest_pull", "deepest", "first_lowest"] {
        assert!(told.contains(name), "{name}: {told}");
    }
}

#[test]
fn the_torque_of_a_latch_is_a_metric_a_guard_and_a_name() {
    let folder = Folder::new("metrics_latch");
    // Gravity pulls by m g r = 9.81 N m about the pin where the arm is level, held by the lock.
    let text = "model Latch {
        gravity: [0, 0, -9.81] m/s^2;
        let effort = norm(pin.angle.lock.torque);
        body arm { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1, 0, 0] m }
        joint pin: hinge from world to arm.root { axis: y }
        event caught = time rises 1 ms { lock: pin, acts: once }
        event loaded = norm(pin.angle.lock.torque) rises 5 N*m;
        metric held = final effort;
        metric most = max abs(pin.angle.lock.torque.y);
        output side = pin.angle.lock.force;
    }
    [run]
    until = \"1 s\"
    ";
    for family in ["absolute", "relative"] {
        let own = format!("gravity: [0, 0, -9.81] m/s^2; coordinates: {family};");
        let text = text.replace("gravity: [0, 0, -9.81] m/s^2;", &own);
        let text = text.replace("    [run]", "[run]");
        let scene = folder.file("latch.mbd", &text);
        let out = folder.0.join("out").display().to_string();
        let told = run(&["run", &scene, "--json", "--out", &out]).unwrap();
        let told: Value = serde_json::from_str(&told).unwrap();
        for name in ["held", "most"] {
            let found = told["metrics"][name].as_f64().unwrap();
            assert!((found - 9.81).abs() < 1e-4, "{family} {name}: {found}");
        }
        let toml = run(&["convert", &scene]).unwrap();
        let document = folder.file("latch.toml", &toml);
        let text = run(&["convert", &document, "--to", "mbd"]).unwrap();
        let back = folder.file("back.mbd", &text);
        assert_eq!(run(&["convert", &back]).unwrap(), toml);
    }
}

/// What hangs on a root of a quantity may be off by far more than the quantity: x = sin t is above 0.99999 m for 2 acos(0.99999) s a turn.
#[test]
fn the_error_of_a_metric_is_told_as_that_of_an_output() {
    let folder = Folder::new("metric_error");
    let scene = folder.file(
        "graze.mbd",
        "model Graze { gravity: none; point p { mass: 1 kg, start velocity [1, 0, 0] m/s }
            load k on p = -1 N/m * p.position; let x = p.position.x; output px = x;
            metric dwell = time_above x { level: 0.99999 m, to: 6 s }; }
         [run]\nuntil = \"7 s\"\n",
    );
    let out = folder.0.join("out").display().to_string();
    let exact = 2.0 * 0.99999_f64.acos();
    let dwell = || {
        let summary = std::fs::read_to_string(format!("{out}/summary.json")).unwrap();
        let summary: Value = serde_json::from_str(&summary).unwrap();
        let told = &summary["error_estimate"];
        let off = (summary["metrics"]["dwell"].as_f64().unwrap() - exact).abs();
        (off, told["column"].clone(), told["rms"].as_f64().unwrap())
    };
    let error = run(&["run", &scene, "--tol", "1e-4", "--out", &out]).unwrap_err();
    assert_eq!(error.code(), 3, "{error}");
    assert!(
        error.to_string().contains("`dwell` is off by about"),
        "{error}"
    );
    let (off, column, told) = dwell();
    assert_eq!(column, "dwell");
    assert!(off < 3.0 * told && told < 3.0 * off, "{off} {told}");
    let text = run(&["run", &scene, "--tol", "1e-10", "--out", &out]).unwrap();
    assert!(!text.contains("warning"), "{text}");
    assert!(dwell().0 < 1e-6);
}
