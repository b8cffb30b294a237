//! Campaigns as they are typed.

use std::path::Path;

use super::{Folder, run};

const DISPERSED: &str = r#"
seed = 3
cases = 30
block = 8

[params]
m_bob = { dist = "normal", sigma = "5 %" }
k = { dist = "uniform", low = "4 kN/m", high = "120 kN/m" }

[start]
bob.vx = { dist = "normal", mean = "0.5 m/s", sigma = "0.2 m/s" }

[metrics]
peak = { max = "rope_left.tension", require = { below = "1 kN", share = 0.5, confidence = 0.5 } }

[run]
until = "0.5 s"
"#;

#[test]
fn a_campaign_of_a_scene_is_run_in_shards_gathered_and_told_on_one_page() {
    let folder = Folder::new("campaign");
    let file = folder.file("dispersed.toml", DISPERSED);
    let [whole, parts] = ["whole", "parts"].map(|name| folder.0.join(name).display().to_string());
    let told = run(&[
        "campaign",
        "swing",
        &file,
        "--out",
        &whole,
        "--threads",
        "2",
    ])
    .unwrap();
    assert!(
        told.contains("31 cases run") && told.contains("shown: peak"),
        "{told}"
    );
    for shard in ["2/2", "1/2"] {
        run(&[
            "campaign", "swing", &file, "--out", &parts, "--shard", shard,
        ])
        .unwrap();
    }
    run(&["gather", &parts]).unwrap();
    let cases =
        [&whole, &parts].map(|out| std::fs::read(Path::new(out).join("cases.csv")).unwrap());
    assert_eq!(cases[0], cases[1]);
    let told = run(&["report", &whole]).unwrap();
    assert!(told.contains("report.html"), "{told}");
    let page = std::fs::read_to_string(Path::new(&whole).join("report.html")).unwrap();
    // Stiffnesses above 100 kN/m are out of their range: told with the command that repeats the first.
    for part in [
        "Campaign of Swing",
        "shown: peak below",
        "What drives peak",
        "params: ",
        "by deciles of k",
        "--case ",
        // It moves.
        "The nominal: case 0.",
        "mbd-data",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let error = run(&["campaign", "swing", &file, "--out", &whole]).unwrap_err();
    assert!(error.to_string().contains("--resume"), "{error}");
    let error = run(&["gather", &folder.0.display().to_string()]).unwrap_err();
    assert!(error.to_string().contains("holds no campaign"), "{error}");
}

#[test]
fn a_requirement_that_is_not_shown_has_its_exit_code() {
    let folder = Folder::new("not_shown");
    let strict = DISPERSED.replace(
        "share = 0.5, confidence = 0.5",
        "share = 0.99, confidence = 0.9",
    );
    let file = folder.file("dispersed.toml", &strict);
    let out = folder.0.join("out").display().to_string();
    let error = run(&["campaign", "swing", &file, "--out", &out]).unwrap_err();
    assert_eq!(error.code(), 3);
    assert!(
        error.to_string().contains("NOT ENOUGH CASES") || error.to_string().contains("NOT MET"),
        "{error}"
    );
}

#[test]
fn a_sweep_over_a_grid_keeps_its_exit_codes_and_claims_no_confidence() {
    let folder = Folder::new("sweep");
    let scene = folder.file("throw.mbd", OVER_A_WALL);
    for (share, word, code) in [("0.5", "met", 0), ("1.0", "NOT MET", 3)] {
        let file = folder.file(
            "dispersed.toml",
            &format!(
                "sampling = \"grid\"\n[params]\nspeed = {{ dist = \"grid\", values = [\"8 m/s\", \"12 m/s\"] }}\n\
                 [metrics]\nway = {{ require = {{ above = \"0.3 m\", share = {share}, confidence = 0.9 }} }}\n"
            ),
        );
        let out = folder.0.join(word).display().to_string();
        let flown = run(&["campaign", &scene, &file, "--out", &out]);
        let (told, ended) =
            flown.map_or_else(|error| (error.to_string(), error.code()), |told| (told, 0));
        assert_eq!(ended, code, "{told}");
        let verdict = "of the 2 points of the grid 1 keeps it, 1 of the others without a value; a grid has no confidence";
        assert!(
            told.contains(verdict) && told.contains(&format!("{word}: way")),
            "{told}"
        );
        assert_eq!(
            run(&["report", &out]).map_or_else(|error| error.code(), |_| 0),
            code
        );
        let page = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
        assert!(page.contains(verdict) && page.contains("shares of the points of the grid"));
        for claim in ["% confidence", "not enough cases", "drive nothing"] {
            assert!(!page.contains(claim), "{claim}");
        }
    }
}

#[test]
fn a_case_that_is_run_alone_is_that_of_the_campaign_to_the_bit() {
    let folder = Folder::new("case");
    let fine = format!("{DISPERSED}every = \"0.05 ms\"\n");
    let file = folder.file("dispersed.toml", &fine);
    let [out, alone] = ["out", "alone"].map(|name| folder.0.join(name).display().to_string());
    run(&["campaign", "swing", &file, "--out", &out]).unwrap();
    let cases = std::fs::read_to_string(Path::new(&out).join("cases.csv")).unwrap();
    let mut names = cases.lines().next().unwrap().split(',');
    let peak_at = names.position(|name| name.starts_with("peak")).unwrap();
    let mut compared = 0;
    for case in [0, 3, 14, 30] {
        let row: Vec<&str> = cases.lines().nth(case + 1).unwrap().split(',').collect();
        let number = case.to_string();
        let flown = run(&[
            "run",
            "swing",
            "--campaign",
            &file,
            "--case",
            &number,
            "--out",
            &alone,
            "--no-estimate",
        ]);
        if row[1] != "ok" {
            assert_eq!(flown.unwrap_err().code(), 2);
            continue;
        }
        flown.unwrap();
        let history = std::fs::read_to_string(Path::new(&alone).join("history.csv")).unwrap();
        let mut lines = history
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let at = lines
            .next()
            .unwrap()
            .iter()
            .position(|it| it.starts_with("rope_left.tension"));
        let tensions = lines.map(|line| line[at.unwrap()].parse::<f64>().unwrap());
        // The metric sees what is between two rows, too; these are fine.
        let highest = tensions.reduce(f64::max).unwrap();
        let peak = row[peak_at].parse::<f64>().unwrap();
        assert!(
            peak >= highest && peak < 1.001 * highest,
            "{row:?} {highest}"
        );
        let summary = std::fs::read_to_string(Path::new(&alone).join("summary.json")).unwrap();
        // Those of the scene, and that of the campaign file.
        for name in ["hardest_pull", "deepest", "first_lowest", "peak"] {
            let mut names = cases.lines().next().unwrap().split(',');
            let at = names.position(|known| known.split(' ').next() == Some(name));
            let told = summary.split(&format!("\"{name}\":")).nth(1).unwrap();
            let told = told.split([',', '}']).next().unwrap().trim();
            let [cell, told] = [row[at.unwrap()], told].map(|it| it.parse::<f64>().ok());
            assert_eq!(
                cell.map(f64::to_bits),
                told.map(f64::to_bits),
                "{name}: {row:?}"
            );
        }
        compared += 1;
    }
    assert!(compared > 1);
    let error = run(&["run", "swing", "--campaign", &file, "--case", "31"]).unwrap_err();
    assert!(error.to_string().contains("the last is 30"), "{error}");
}

/// The columns and the bytes of `mbd run`, compiled and interpreted, whoever flies the case again.
#[test]
fn the_history_that_a_campaign_keeps_is_that_of_the_case_run_alone() {
    let folder = Folder::new("kept");
    let swing =
        format!("{DISPERSED}\n[histories]\nlargest = {{ peak = 1 }}\nfailed = 1\ncases = [5]\n");
    let top = "seed = 3\ncases = 4\n[start]\ntop.omega_body_z = { dist = \"normal\", sigma = \"0.2 rad/s\" }\n[metrics]\nfar = { max = \"quaternion_drift\" }\n\
               [histories]\ncases = [0, 3]\n[run]\nuntil = \"0.2 s\"\n";
    for (scene, text, last) in [("swing", swing, 5), ("heavy_top", top.to_owned(), 3)] {
        let file = folder.file(&format!("{scene}.toml"), &text);
        let [out, alone] = ["out", "alone"].map(|name| {
            folder
                .0
                .join(format!("{scene}_{name}"))
                .display()
                .to_string()
        });
        run(&["campaign", scene, &file, "--out", &out]).unwrap();
        run(&["report", &out]).unwrap();
        for case in [0, last] {
            let kept = Path::new(&out).join(format!("histories/case_{case:06}.csv"));
            if scene == "swing" && case == 0 {
                assert!(!kept.exists());
                continue;
            }
            let number = case.to_string();
            run(&[
                "run",
                scene,
                "--campaign",
                &file,
                "--case",
                &number,
                "--out",
                &alone,
                "--no-estimate",
            ])
            .unwrap();
            let history = std::fs::read(Path::new(&alone).join("history.csv")).unwrap();
            assert!(history == std::fs::read(kept).unwrap(), "{scene} {case}");
        }
    }
}

/// What the page shows is run as it is written, with fewer cases.
#[test]
fn the_campaign_file_of_the_page_about_campaigns_runs() {
    let page = include_str!("../../../../../docs/campaigns.md");
    let from = page.find("seed = 7").unwrap();
    let file = page[from..].split("```").next().unwrap();
    let folder = Folder::new("campaign_page");
    let file = folder.file(
        "dispersions.toml",
        &file.replace("cases = 1000 ", "cases = 4 "),
    );
    let out = folder.0.join("out").display().to_string();
    let error = run(&["campaign", "swing", &file, "--out", &out]).unwrap_err();
    assert_eq!(error.code(), 3, "{error}");
    let told = error.to_string();
    assert!(
        told.contains("5 cases run, 0 of them did not") && told.contains("turned [s]"),
        "{told}"
    );
    let error = run(&["run", "swing", "--campaign", &file, "--dt", "1 ms"]).unwrap_err();
    assert_eq!(error.code(), 1, "{error}");
}

#[test]
fn a_scene_file_is_run_in_lanes_with_the_same_bytes() {
    let folder = Folder::new("in_lanes");
    let scene = folder.file(
        "pendulum.mbd",
        "pub model Pendulum {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            coordinates: relative;
            param m_bob = 1.0 kg in 0.5 kg ..= 2.0 kg;
            param k = 5 N*m/rad in 1 N*m/rad ..= 500 kN*m/rad;
            body bob { mass: m_bob, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame top at [0.0, 0.0, 1.0] m }
            joint pin: hinge from world to bob.top { axis: y, damping: 0.1 N*m*s/rad, stiffness: k, start: 0.4 rad }
            output swing = pin.angle;
        }",
    );
    let file = folder.file(
        "dispersed.toml",
        "seed = 3\ncases = 30\nblock = 8\n[params]\nm_bob = { dist = \"normal\", sigma = \"5 %\" }\n[metrics]\nlargest = { max = \"swing\" }\n[run]\nuntil = \"0.5 s\"\nstep = \"1 ms\"\n",
    );
    let cases = |lanes: &str| {
        let out = folder.0.join(lanes).display().to_string();
        // On one thread: of two, one may be left with a single case, which it flies alone.
        let asked = ["--out", &out, "--lanes", lanes, "--threads", "1"];
        let told = run(&[&["campaign", &scene, &file][..], &asked].concat()).unwrap();
        let said = format!("100 % of all steps were made in {lanes} lanes");
        assert_eq!(told.contains(&said), lanes != "1", "{told}");
        std::fs::read(Path::new(&out).join("cases.csv")).unwrap()
    };
    let alone = cases("1");
    assert!(String::from_utf8_lossy(&alone).contains(",ok,"));
    assert_eq!(alone, cases("4"));
    assert_eq!(alone, cases("8"));
    let error = run(&["campaign", &scene, &file, "--lanes", "5"]).unwrap_err();
    assert!(
        error.to_string().contains("[possible values: 1, 4, 8]"),
        "{error}"
    );
}

/// A closed loop has rows, which are solved in lanes.
#[test]
fn a_linkage_is_run_in_lanes_with_the_same_bytes() {
    let folder = Folder::new("loop_in_lanes");
    let file = folder.file(
        "dispersed.toml",
        "seed = 3\ncases = 20\n[params]\nk = { dist = \"normal\", sigma = \"5 %\" }\n[metrics]\nlargest = { max = \"turn\" }\n[run]\nuntil = \"0.2 s\"\n",
    );
    let cases = |lanes: &str| {
        let out = folder.0.join(lanes).display().to_string();
        let asked = ["--out", &out, "--lanes", lanes, "--threads", "1"];
        let told = run(&[&["campaign", "linkage", &file][..], &asked].concat()).unwrap();
        let said = format!("of all steps were made in {lanes} lanes");
        assert_eq!(told.contains(&said), lanes != "1", "{told}");
        std::fs::read(Path::new(&out).join("cases.csv")).unwrap()
    };
    let alone = cases("1");
    assert!(String::from_utf8_lossy(&alone).contains(",ok,"));
    assert_eq!(alone, cases("4"));
    assert_eq!(alone, cases("8"));
}

/// Ready scenes are compiled for one case at a time, and Rattle is no explicit method: `--lanes` says that it has no effect.
#[test]
fn lanes_that_have_no_effect_are_told_with_the_reason() {
    let folder = Folder::new("no_lanes");
    for (scene, method, why) in [
        ("heavy_top", "", "`mbd convert` writes one"),
        (
            "linkage",
            "method = \"rattle\"\nstep = \"1 ms\"\n",
            "none of its steps is one that is made in lanes",
        ),
    ] {
        let file = folder.file(
            "few.toml",
            &format!(
                "cases = 3\n[metrics]\ndrift = {{ max = \"quaternion_drift\" }}\n[run]\nuntil = \"10 ms\"\n{method}"
            ),
        );
        let out = folder.0.join(scene).display().to_string();
        let told = run(&["campaign", scene, &file, "--out", &out, "--lanes", "4"]).unwrap();
        assert!(
            told.contains("--lanes 4 had no effect") && told.contains(why),
            "{told}"
        );
    }
}

/// A stone that is thrown as hard as it is drawn, over a wall or not.
const OVER_A_WALL: &str = "model Throw {
    gravity: [0, 0, -9.81] m/s^2;
    param speed = 10 m/s in 1 m/s ..= 30 m/s;
    point stone { mass: 1 kg, start at [0, 0, 0] m velocity [1 m/s, 0, speed] }
    event over = stone.position.z rises 5 m;
    metric height = max stone.position.z;
    metric way = value stone.position.x { at: over };
}
[run]
until = \"2 s\"
";

#[test]
fn cases_without_a_value_are_told_with_the_event_that_did_not_happen() {
    let folder = Folder::new("waited");
    let scene = folder.file("throw.mbd", OVER_A_WALL);
    let file = folder.file(
        "dispersed.toml",
        "seed = 1\ncases = 20\n[params]\nspeed = { dist = \"uniform\", low = \"8 m/s\", high = \"12 m/s\" }\n\
         [metrics]\nway = { require = { above = \"0.9 m\", share = 0.9, confidence = 0.9 } }\n",
    );
    let out = folder.0.join("out").display().to_string();
    let told = run(&["campaign", &scene, &file, "--out", &out]).unwrap_err();
    let cases = std::fs::read_to_string(Path::new(&out).join("cases.csv")).unwrap();
    let mut rows = cases.lines();
    let mut names = rows.next().unwrap().split(',');
    let way = names.position(|name| name.starts_with("way")).unwrap();
    let values = rows
        .skip(1)
        .map(|row| row.split(',').nth(way).unwrap().to_owned());
    let without = values.filter(String::is_empty).count();
    assert!(without > 0 && without < 20, "{cases}");
    let told = told.to_string();
    for part in [
        format!(
            "{without} cases have no value and are left out of what follows, because `over` did not happen in {without} runs"
        ),
        format!("miss it, {without} of them without a value"),
        // Two standard deviations of the rank correlation of numbers that have nothing to do with each other, 1/√(n − 1).
        format!(
            "driven by (rank correlation, by chance alone within ±{:.2}): speed ",
            2.0 / (19.0 - without as f64).sqrt()
        ),
    ] {
        assert!(told.contains(&part), "{part}\n{told}");
    }
    // The requirement is not met, which the page tells, too.
    assert_eq!(run(&["report", &out]).unwrap_err().code(), 3);
    let page = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    let reason = format!("did not happen in {without} runs");
    assert!(page.contains(&reason), "{page}");
}

#[test]
fn a_case_run_alone_warns_of_a_window_of_the_campaign_file_that_it_leaves_open() {
    let folder = Folder::new("open_window");
    let scene = folder.file("throw.mbd", OVER_A_WALL);
    let file = folder.file(
        "dispersed.toml",
        "cases = 2\n[params]\nspeed = { dist = \"uniform\", low = \"8 m/s\", high = \"12 m/s\" }\n\
         [metrics]\ntop = { max = \"stone.z\", to = \"5 s\" }\n",
    );
    let [out, alone] = ["out", "alone"].map(|name| folder.0.join(name).display().to_string());
    let told = run(&["campaign", &scene, &file, "--out", &out]).unwrap();
    let says = "`top` counts up to 5 s, and the run ends at 2 s: it is told of what lies before";
    assert!(
        told.contains(says) && told.contains("metric_partial: case 0"),
        "{told}"
    );
    let told = run(&[
        "run",
        &scene,
        "--campaign",
        &file,
        "--case",
        "1",
        "--out",
        &alone,
    ])
    .unwrap();
    assert!(told.contains(&format!("warning: metric {says}")), "{told}");
}

#[test]
fn a_setting_of_the_runs_is_told_its_name_and_its_place_in_the_campaign_file() {
    let folder = Folder::new("campaign_settings");
    let answer = |lines: &str| {
        let file = folder.file("c.toml", &format!("{lines}\n"));
        run(&["campaign", "swing", &file]).unwrap_err().to_string()
    };
    for (lines, told) in [
        (
            "[run]\ntol = 1e-8",
            "`run`: unknown field `tol`: it is called `tolerance`: `tolerance = 1e-8`",
        ),
        (
            "[run]\ndt = 1e-3",
            "`run`: unknown field `dt`: a fixed step is called `step`",
        ),
        (
            "tol = 1e-8",
            "stands in the table `[run]`: it is called `tolerance`",
        ),
        (
            "until = 3",
            "`until` stands in the table `[run]` of the file",
        ),
    ] {
        let answer = answer(lines);
        assert!(answer.contains(told), "{lines}: {answer}");
    }
    assert!(!answer("casse = 3").contains("[run]"));
}
