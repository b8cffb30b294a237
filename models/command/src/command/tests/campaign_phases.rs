//! Campaigns whose runs come to several scenes.

use std::path::Path;

use super::{Folder, run};

/// A capsule on a parachute with linear drag, until a height.
const CHUTE: &str = r#"model Chute {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    param m = 80 kg in 50 kg ..= 110 kg;
    param c = 200 kg/s;
    point capsule { mass: m, start at [0.0, 0.0, 100.0] m }
    load drag on capsule = -c * capsule.velocity;
    event released = time rises 3 s { then: scene "fall.mbd", map: [told = 2 * c * 1 s/kg] }
    output height = capsule.position.z;
    metric lowest = min capsule.position.z;
}
[run]
until = "5 s"
tolerance = 1e-11
"#;

const FALL: &str = r#"model Fall {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    param m = 80 kg in 50 kg ..= 110 kg;
    param push = 0 N;
    param told = 1;
    point capsule { mass: m }
    load side on capsule = [push, 0.0, 0.0];
    output speed = -capsule.velocity.z;
    output told_c = told;
    metric lowest = min capsule.position.z;
}
"#;

const DISPERSED: &str = r#"
seed = 5
cases = 12
block = 4

[params]
m = { dist = "uniform", low = "60 kg", high = "100 kg" }
c = { dist = "uniform", low = "150 kg/s", high = "250 kg/s" }
push = { dist = "uniform", low = "-8 N", high = "8 N" }

[start]
capsule.vx = { dist = "normal", sigma = "1 m/s" }

[metrics]
slow = { max = "speed" }
height_left = { final = "height" }
mean_height = { mean = "height" }
east = { final = "capsule.x" }
told = { max = "told_c" }
freed = { time_of = "released" }

[envelopes]
columns = ["capsule.z", "speed"]
every = "1 s"

[histories]
largest = { slow = 1 }
"#;

/// The numbers of a case by the names of their columns.
fn cell(head: &str, row: &str, name: &str) -> f64 {
    let mut names = head.split(',');
    let at = names.position(|it| it == name || it.starts_with(&format!("{name} ")));
    let at = at.unwrap_or_else(|| panic!("{name}: {head}"));
    row.split(',')
        .nth(at)
        .unwrap_or_default()
        .parse()
        .unwrap_or(f64::NAN)
}

fn files(folder: &Path, names: &[&str]) -> Vec<Vec<u8>> {
    let read = |name: &&str| std::fs::read(folder.join(name)).unwrap_or_default();
    names.iter().map(read).collect()
}

/// With k = c/m the capsule sinks g/k (t − (1 − exp(−kt))/k) in t s: 60 kg 14.1 m in 5 s, 100 kg 22.5 m.
#[test]
fn a_metric_of_a_scene_that_no_run_came_to_is_told_by_that_reason() {
    let folder = Folder::new("campaign_not_reached");
    let text = CHUTE.replace("time rises 3 s", "capsule.position.z falls 80 m");
    let chute = folder.file("chute.mbd", &text);
    folder.file("fall.mbd", FALL);
    let file = folder.file(
        "dispersed.toml",
        "sampling = \"grid\"\n[params]\nm = { dist = \"grid\", values = [\"60 kg\", \"61 kg\", \"100 kg\"] }\n[metrics]\nslow = { max = \"speed\" }\n",
    );
    let out = folder.0.join("out").display().to_string();
    let told = run(&["campaign", &chute, &file, "--out", &out]).unwrap();
    let reason = "2 cases have no value and are left out of what follows, because no scene that has its quantity was reached in 2 runs\n";
    assert!(told.contains(reason), "{told}");
}

#[test]
fn every_case_falls_by_the_closed_forms_of_both_scenes() {
    let folder = Folder::new("campaign_phases");
    let chute = folder.file("chute.mbd", CHUTE);
    folder.file("fall.mbd", FALL);
    let file = folder.file("dispersed.toml", DISPERSED);
    let out = folder.0.join("whole");
    let typed = out.display().to_string();
    let told = run(&["campaign", &chute, &file, "--out", &typed, "--lanes", "8"]).unwrap();
    assert!(
        told.contains("13 cases run, 0 of them did not") && told.contains("Chute → Fall"),
        "{told}"
    );
    // The first scene is made in lanes, what goes on is not.
    assert!(told.contains("of all steps were made in 8 lanes"), "{told}");
    let cases = std::fs::read_to_string(out.join("cases.csv")).unwrap();
    let mut lines = cases.lines();
    let head = lines.next().unwrap();
    let close = |a: f64, b: f64| (a - b).abs() < 1e-7 * (1.0 + b.abs());
    for (case, row) in lines.enumerate() {
        let of = |name: &str| cell(head, row, name);
        let [m, c, push] = ["m", "c", "push"].map(of);
        let vx = of("start.capsule.vx");
        let (k, t, g, s) = (c / m, 3.0, 10.0, 2.0);
        let (end, e) = (-g / k, (-k * t).exp());
        let (v, z) = (end * (1.0 - e), 100.0 + end * (t - (1.0 - e) / k));
        let lowest = z + v * s - 0.5 * g * s * s;
        let east = vx * (1.0 - e) / k + vx * e * s + 0.5 * push / m * s * s;
        // ∫ z from 0 to t, over t: only the first scene has a height.
        let mean = 100.0 + end * (0.5 * t * t - (t - (1.0 - e) / k) / k) / t;
        assert!(close(of("lowest"), lowest), "{case}: {row}\n{lowest}");
        assert!(close(of("height_left"), z), "{case}: {row}\n{z}");
        assert!(close(of("slow"), g * s - v), "{case}: {row}");
        assert!(close(of("east"), east), "{case}: {row}\n{east}");
        assert!(close(of("told"), 2.0 * c), "{case}: {row}");
        assert!(close(of("freed"), 3.0) && of("end") == 5.0, "{case}: {row}");
        // Straight between rows, which lie close.
        assert!(
            (of("mean_height") - mean).abs() < 1e-3,
            "{case}: {row}\n{mean}"
        );
        if case == 0 {
            assert_eq!([m, c, push], [80.0, 200.0, 0.0]);
        }
    }
    assert_eq!(cases.lines().count(), 14);
    let over_time = std::fs::read_to_string(out.join("envelopes.csv")).unwrap();
    let head = over_time.lines().next().unwrap();
    let counts = |name: &str| -> Vec<f64> {
        let rows = over_time.lines().skip(1);
        rows.map(|row| cell(head, row, name)).collect()
    };
    assert_eq!(counts("capsule.z.cases"), [12.0; 6]);
    // From the release on.
    assert_eq!(counts("speed.cases"), [0.0, 0.0, 0.0, 12.0, 12.0, 12.0]);
}

#[test]
fn a_param_that_the_map_always_hands_on_has_no_nominal_value_of_its_own() {
    let folder = Folder::new("campaign_phases_mapped");
    let first = |map: &str| {
        format!(
            "model One {{ gravity: none; param c = 2 kg/s; point p {{ mass: 1 kg }} output one = c;
                event e = time rises 1 s {{ then: scene \"two.mbd\"{map} }} }}
            [run]\nuntil = \"2 s\"\n"
        )
    };
    folder.file(
        "two.mbd",
        "model Two { gravity: none; param c = 7 kg/s; param d = 1; point p { mass: 1 kg } output two = c; output ratio = d; }",
    );
    let dispersed = |name: &str, spread: &str| {
        let text = format!(
            "seed = 1\ncases = 4\n[params]\n{name} = {spread}\n[metrics]\ntwo = {{ final = \"two\" }}\n"
        );
        folder.file("dispersed.toml", &text)
    };
    let out = folder.0.join("out").display().to_string();
    let fly = |map: &str, name: &str, spread: &str| {
        let scene = folder.file("one.mbd", &first(map));
        run(&["campaign", &scene, &dispersed(name, spread), "--out", &out])
    };
    let spread = "{ dist = \"uniform\", low = \"1 kg/s\", high = \"3 kg/s\" }";
    fly(", map: [c = 0.5 * c, d = 2]", "c", spread).expect("a campaign");
    let cases = std::fs::read_to_string(folder.0.join("out/cases.csv")).unwrap();
    let (head, rows) = cases.split_once('\n').unwrap();
    for row in rows.lines() {
        assert_eq!(cell(head, row, "two"), 0.5 * cell(head, row, "c"), "{row}");
    }
    // Without a map the two nominal values contradict each other.
    let told = fly("", "c", spread).unwrap_err().to_string();
    assert!(told.contains("give both one nominal value"), "{told}");
    // What the map always decides cannot be dispersed.
    let numbers = "{ dist = \"uniform\", low = 1, high = 3 }";
    let told = fly(", map: [c = c, d = 2]", "d", numbers).unwrap_err();
    assert!(told.to_string().contains("`d`"), "{told}");
}

#[test]
fn threads_lanes_and_shards_change_no_byte_and_a_history_is_that_of_the_case_run_alone() {
    let folder = Folder::new("campaign_phases_bytes");
    let chute = folder.file("chute.mbd", CHUTE);
    folder.file("fall.mbd", FALL);
    let file = folder.file("dispersed.toml", DISPERSED);
    let [whole, parts, alone] = ["whole", "parts", "alone"].map(|name| folder.0.join(name));
    let typed = |path: &Path| path.display().to_string();
    let begun = ["campaign", &chute, &file, "--out"];
    let with = |out: &str, more: &[&str]| run(&[&begun, &[out][..], more].concat()).unwrap();
    with(&typed(&whole), &["--threads", "1", "--lanes", "1"]);
    with(
        &typed(&parts),
        &["--shard", "2/2", "--threads", "3", "--lanes", "8"],
    );
    with(&typed(&parts), &["--shard", "1/2", "--lanes", "4"]);
    run(&["gather", &typed(&parts)]).unwrap();
    let names = [
        "cases.csv",
        "cases.parquet",
        "envelopes.csv",
        "manifest.json",
    ];
    assert_eq!(files(&whole, &names), files(&parts, &names));

    run(&["report", &typed(&whole)]).unwrap();
    let kept = std::fs::read_dir(whole.join("histories")).unwrap();
    let mut kept: Vec<String> = kept
        .map(|it| it.unwrap().file_name().into_string().unwrap())
        .collect();
    kept.sort();
    let number = kept[0]
        .trim_start_matches("case_")
        .trim_end_matches(".csv")
        .to_owned();
    let page = |end: &str| format!("case_{number}{end}");
    assert_eq!(
        kept,
        [
            page(".csv"),
            page(".html"),
            page(".parquet"),
            page("_1.html"),
            page("_2.html")
        ]
    );
    let case = number.parse::<u64>().unwrap().to_string();
    run(&[
        "run",
        &chute,
        "--campaign",
        &file,
        "--case",
        &case,
        "--out",
        &typed(&alone),
    ])
    .unwrap();
    let [history, own] = [
        whole.join("histories").join(page(".csv")),
        alone.join("history.csv"),
    ];
    let bytes = std::fs::read(history).unwrap();
    assert!(!bytes.is_empty() && bytes == std::fs::read(own).unwrap());
    let text = std::fs::read_to_string(whole.join("histories").join(page(".html"))).unwrap();
    for words in ["Chute → Fall", "released", &page("_2.html"), "speed [m/s]"] {
        assert!(text.contains(words), "{words}");
    }
}

#[test]
fn what_two_scenes_say_differently_is_refused_by_name() {
    let folder = Folder::new("campaign_phases_wrong");
    let chute = folder.file("chute.mbd", CHUTE);
    let file = |more: &str| format!("cases = 2\n{more}\n");
    let m = "[params]\nm = { dist = \"uniform\", low = \"60 kg\", high = \"100 kg\" }";
    for (fall, campaign, words) in [
        (
            FALL.replace("m = 80 kg", "m = 70 kg"),
            file(m),
            &["`params.m`", "`Chute` has 80 kg", "70 kg", "[run.params]"][..],
        ),
        (
            FALL.replace("min capsule", "max capsule"),
            file(""),
            &[
                "metric lowest",
                "`Chute` declares `min capsule.position.z in m`",
                "`Fall` declares `max capsule.position.z in m`",
            ],
        ),
        (
            FALL.replace("min capsule.position.z", "min capsule.position.x"),
            file(""),
            &[
                "metric lowest",
                "`Chute` declares `min capsule.position.z in m`",
                "`Fall` declares `min capsule.position.x in m`",
            ],
        ),
        (
            FALL.to_owned(),
            file("[params]\npusch = { dist = \"uniform\", low = \"0 N\", high = \"1 N\" }"),
            &["pusch", "did you mean `push`"],
        ),
        (
            FALL.to_owned(),
            file("[metrics]\nfast = { max = \"sped\" }"),
            &["`sped`", "did you mean `speed`"],
        ),
    ] {
        folder.file("fall.mbd", &fall);
        let file = folder.file("dispersed.toml", &campaign);
        let out = folder.0.join("out").display().to_string();
        let failure = run(&["campaign", &chute, &file, "--out", &out]).unwrap_err();
        assert_eq!(failure.code(), 2, "{failure}");
        for word in words {
            assert!(failure.to_string().contains(word), "{word}: {failure}");
        }
    }
    // One value for both, in the campaign file.
    folder.file("fall.mbd", &FALL.replace("m = 80 kg", "m = 70 kg"));
    let one = folder.file(
        "dispersed.toml",
        &file(&format!("{m}\n[run.params]\nm = \"75 kg\"")),
    );
    let out = folder.0.join("one").display().to_string();
    run(&["campaign", &chute, &one, "--out", &out]).unwrap();
}

/// Params that the next scene refuses fail the case by the name of the event; the others are flown.
#[test]
fn a_case_that_cannot_go_on_fails_by_name() {
    let folder = Folder::new("campaign_phases_failed");
    let chute = folder.file("chute.mbd", CHUTE);
    folder.file(
        "fall.mbd",
        &FALL.replace("50 kg ..= 110 kg", "75 kg ..= 110 kg"),
    );
    let file = folder.file(
        "dispersed.toml",
        "cases = 6\nsampling = \"latin\"\n[params]\nm = { dist = \"uniform\", low = \"60 kg\", high = \"100 kg\" }\n[metrics]\nslow = { max = \"speed\" }\n",
    );
    let out = folder.0.join("out");
    let told = run(&[
        "campaign",
        &chute,
        &file,
        "--out",
        &out.display().to_string(),
    ])
    .unwrap();
    let cases = std::fs::read_to_string(out.join("cases.csv")).unwrap();
    let head = cases.lines().next().unwrap();
    for row in cases.lines().skip(1) {
        let refused = cell(head, row, "m") < 75.0;
        assert_eq!(row.contains(",action,3.0"), refused, "{row}");
        assert_eq!(
            row.contains("`released`") && row.contains("`Fall` cannot go on"),
            refused,
            "{row}"
        );
    }
    assert!(
        told.contains("2 of them did not") || told.contains("3 of them did not"),
        "{told}"
    );
}

/// A stone falls by 10 m/s² from 100 m and is caught at 80 m, at 2 s; from there it goes on at 3 m/s, and at 5 s it is let go once more. One metric of every kind in
/// the first scene, one of every kind in the second, and a third scene that no run comes to.
const FALLING: &str = r#"model Falling {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    param g0 = 1 in 0.5 ..= 2;
    point stone { mass: 1 kg, start at [0.0, 0.0, 100.0] m }
    event caught = stone.position.z falls 80 m { then: scene "carried.mbd" }
    event tick = time rises 1 s { }
    metric f_max = max stone.position.z;
    metric f_min = min stone.position.z;
    metric f_final = final stone.position.z;
    metric f_mean = mean stone.position.z;
    metric f_rms = rms stone.velocity.z;
    metric f_integral = integral stone.velocity.z;
    metric f_above = time_above stone.position.z { level: 95 m };
    metric f_first = first_above -stone.velocity.z { level: 5 m/s };
    metric f_value = value stone.position.z { at: tick };
    metric f_tick = time_of tick;
    metric f_caught = time_of caught;
    metric f_cut = integral stone.velocity.z { from: 1 s, to: 3 s };
    metric f_late = max stone.position.z { from: 2.5 s };
    metric f_inside = final stone.position.z { to: 1 s };
}
[run]
until = "6 s"
tolerance = 1e-10
"#;

const CARRIED: &str = r#"model Carried {
    gravity: none;
    point stone { mass: 1 kg }
    event tick = time rises 4 s { }
    event thrown = stone.position.z rises 1000 m { then: scene "never.mbd" }
    metric c_max = max stone.position.z;
    metric c_min = min stone.position.z;
    metric c_final = final stone.position.z;
    metric c_mean = mean stone.position.z;
    metric c_rms = rms stone.velocity.z;
    metric c_integral = integral stone.velocity.z;
    metric c_above = time_above stone.position.z { level: 60 m };
    metric c_value = value stone.position.z { at: tick };
    metric c_tick = time_of tick;
    metric c_early = time_of tick { to: 3 s };
    metric c_cut = mean stone.position.z { to: 9 s };
}
"#;

const NEVER: &str = r#"model Never {
    gravity: none;
    point stone { mass: 1 kg }
    event tick = time rises 0.5 s { }
    metric n_max = max stone.position.z;
    metric n_tick = time_of tick;
}
"#;

#[test]
fn every_kind_of_metric_is_of_the_scenes_that_declare_it() {
    let folder = Folder::new("campaign_phases_scoped");
    let scene = folder.file("falling.mbd", FALLING);
    folder.file("carried.mbd", CARRIED);
    folder.file("never.mbd", NEVER);
    let file = folder.file(
        "dispersed.toml",
        "seed = 1\ncases = 3\n[start]\nstone.vx = { dist = \"uniform\", low = \"1 m/s\", high = \"2 m/s\" }\n[metrics]\nany = { time_of = \"tick\" }\nlowest = { min = \"stone.z\" }\nwindow = { mean = \"stone.z\", from = \"1 s\", to = \"3 s\" }\n",
    );
    let out = folder.0.join("out");
    let told = run(&[
        "campaign",
        &scene,
        &file,
        "--out",
        &out.display().to_string(),
    ])
    .unwrap();
    let cases = std::fs::read_to_string(out.join("cases.csv")).unwrap();
    let head = cases.lines().next().unwrap();
    // z = 100 − 5 t² up to 2 s; then 80 − 20 (t − 2).
    let none = f64::NAN;
    let expected = [
        ("f_max", 100.0),
        ("f_min", 80.0),
        ("f_final", 80.0),
        ("f_mean", 100.0 - 5.0 * 8.0 / 3.0 / 2.0),
        ("f_rms", (100.0_f64 * 8.0 / 3.0 / 2.0).sqrt()),
        ("f_integral", -20.0),
        ("f_above", 1.0),
        ("f_first", 0.5),
        ("f_value", 95.0),
        ("f_tick", 1.0),
        ("f_caught", 2.0),
        ("f_cut", -15.0),
        ("f_late", none),
        ("f_inside", 95.0),
        ("c_max", 80.0),
        ("c_min", 0.0),
        ("c_final", 0.0),
        ("c_mean", 40.0),
        ("c_rms", 20.0),
        ("c_integral", -80.0),
        ("c_above", 1.0),
        ("c_value", 40.0),
        ("c_tick", 4.0),
        ("c_early", none),
        ("c_cut", 40.0),
        ("n_max", none),
        ("n_tick", none),
        ("any", 1.0),
        ("lowest", 0.0),
        ("window", 0.5 * (100.0 - 5.0 * (8.0 - 1.0) / 3.0 + 70.0)),
    ];
    for row in cases.lines().skip(1) {
        for (name, exact) in expected {
            let found = cell(head, row, name);
            let close = (found - exact).abs() < 1e-6 || found.is_nan() && exact.is_nan();
            assert!(close, "{name}: {found} for {exact}\n{row}");
        }
        for words in [
            "metric_partial",
            "`f_cut` counts up to 3 s, and its scene ends at 2 s",
            "`c_cut` counts up to 9 s, and the run ends at 6 s",
            "`f_late` has no value: its scene ended before 2.5 s, where its window begins, at 2 s",
            "`n_max` has no value: the run did not come to its scene",
            "`n_tick` has no value: the run did not come to its scene",
        ] {
            assert!(row.contains(words), "{words}\n{row}");
        }
        // A window over both scenes is whole.
        assert!(!row.contains("`window`"), "{row}");
    }
    for words in [
        "its scene ended before 2.5 s, where its window begins, in 3 runs",
        "no scene that has its quantity was reached in 3 runs",
        "`tick` did not happen, or not up to 3 s, in 3 runs",
        "3 cases count a part of the window only, the first is case 1: its scene ends in them before 3 s",
        "3 cases count a part of the window only, the first is case 1: their runs end before 9 s",
    ] {
        assert!(told.contains(words), "{words}\n{told}");
    }
    // What is no quantity of a scene is refused.
    let counter = folder.file(
        "phase.toml",
        "seed = 1\ncases = 3\n[metrics]\nlast = { max = \"phase\" }\n",
    );
    let error = run(&["campaign", &scene, &counter, "--out", "unused"]).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("`metrics.last`: `phase` counts the scenes"),
        "{error}"
    );
    // A case alone tells the metrics of the campaign file, too.
    let alone = folder.0.join("case").display().to_string();
    let text = run(&[
        "run",
        &scene,
        "--campaign",
        &file,
        "--case",
        "2",
        "--out",
        &alone,
    ])
    .unwrap();
    assert!(text.contains("lowest") && text.contains("window"), "{text}");
    let case = std::fs::read_to_string(format!("{alone}/summary.json")).unwrap();
    let case: serde_json::Value = serde_json::from_str(&case).unwrap();
    let row = cases.lines().nth(3).unwrap();
    for name in ["any", "lowest", "window", "f_cut"] {
        assert_eq!(
            case["metrics"][name].as_f64(),
            Some(cell(head, row, name)),
            "{name}"
        );
    }
    // A run alone tells the same numbers, and the same windows.
    let alone = folder.0.join("alone").display().to_string();
    let text = run(&["run", &scene, "--out", &alone]).unwrap();
    for words in [
        "metric `f_cut` counts up to 3 s, and its scene ends at 2 s: it is told of what lies before; write an earlier `to`\n",
        "metric `f_late` counts from 2.5 s on, and its scene ends at 2 s: it has no value",
        "metric `c_cut` counts up to 9 s, and the run ends at 6 s",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    let summary = std::fs::read_to_string(format!("{alone}/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let declared = expected.iter().filter(|(name, _)| name.contains('_'));
    for (name, exact) in declared {
        let found = summary["metrics"][name].as_f64().unwrap_or(f64::NAN);
        let close = (found - exact).abs() < 1e-6 || found.is_nan() && exact.is_nan();
        assert!(close, "{name}: {found} for {exact}");
    }
}

/// One name, one event, and one quantity of two things: told apart, and by `check` before.
#[test]
fn metrics_of_one_name_that_mean_something_else_are_told_apart() {
    let folder = Folder::new("phases_metrics_apart");
    let scene = folder.file(
        "one.mbd",
        "model One { gravity: none; point a { mass: 1 kg, start at [0, 0, 0] m velocity [1, 2, 0] m/s }
            event go = time rises 1 s { then: scene \"two.mbd\" }
            metric far = max a.position.x; metric when = time_of go; }
        [run]\nuntil = \"3 s\"\n",
    );
    folder.file(
        "two.mbd",
        "model Two { gravity: none; point a { mass: 1 kg } event go = time rises 2 s { }
            metric far = max a.position.y; metric later = time_of go; }",
    );
    let out = folder.0.join("out").display().to_string();
    run(&["run", &scene, "--out", &out]).unwrap();
    let summary = std::fs::read_to_string(format!("{out}/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    for (name, exact) in [
        ("far", 1.0),
        ("far (2)", 6.0),
        ("when", 1.0),
        ("later", 2.0),
    ] {
        let found = summary["metrics"][name].as_f64().unwrap_or(f64::NAN);
        assert!((found - exact).abs() < 1e-9, "{name}: {found}");
    }
    let told = run(&["check", &scene]).unwrap();
    let words =
        "the metric `far` is `max a.position.x in m` in `One` and `max a.position.y in m` in `Two`";
    assert!(told.contains(words), "{told}");
}
