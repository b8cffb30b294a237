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
            &["metric lowest", "`Chute` and `Fall`"],
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
