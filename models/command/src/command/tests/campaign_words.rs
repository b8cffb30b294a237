//! What a campaign says of its inputs, of a folder that is another one's, and of what is asked for beyond the end of its runs.

use std::path::PathBuf;

use clap::Parser;

use super::{Cli, Folder, run};

/// A stone without forces: where it is at the end is its speed times 1 s, and the output adds what two params say.
const GLIDE: &str = r#"model Glide {
    gravity: none;
    param wind = 0 m;
    param gust = 0 m;
    param push = 0 m;
    point stone { mass: 1 kg, start at [0, 0, 0] m velocity [1, 0, 0] m/s }
    output place = stone.position.x + wind + push;
    metric far = final place;
}
[run]
until = "1 s"
every = "0.5 s"
"#;

fn flown(folder: &Folder, campaign: &str) -> (String, PathBuf) {
    let scene = folder.file("glide.mbd", GLIDE);
    let file = folder.file("dispersed.toml", campaign);
    let out = folder.0.join("out");
    let typed = out.display().to_string();
    let told = run(&["campaign", &scene, &file, "--out", &typed]).unwrap();
    run(&["report", &typed]).unwrap();
    (told, out)
}

#[test]
fn a_scene_in_the_place_of_the_campaign_file_is_told() {
    let folder = Folder::new("campaign_swapped");
    let scene = folder.file("glide.mbd", GLIDE);
    let file = folder.file("dispersed.toml", NORMAL);
    let error = run(&["campaign", &file, &scene]).unwrap_err();
    assert_eq!(error.code(), 1);
    let remedy = format!("`mbd campaign {scene} {file}`");
    assert!(error.to_string().ends_with(&remedy), "{error}");
}

const NORMAL: &str = r#"
seed = 3
cases = 400
sampling = "latin"
[params]
wind = { dist = "normal", sigma = "1 m" }
gust = { dist = "normal", sigma = "1 m" }
push = { dist = "normal", sigma = "1 m" }
"#;

/// Nothing hangs on `gust`, which goes with the wind by 0.8.
#[test]
fn a_number_that_is_correlated_with_another_explains_nothing_alone() {
    let folder = Folder::new("campaign_correlated");
    let correlated =
        "[[correlated]]\nnames = [\"gust\", \"wind\"]\nmatrix = [[1.0, 0.8], [0.8, 1.0]]\n";
    let (told, out) = flown(&folder, &format!("{NORMAL}{correlated}"));
    let driven = told
        .lines()
        .find(|line| line.contains("driven by"))
        .unwrap();
    for words in [
        "(together with gust, with which it is correlated +0.80)",
        "(together with wind, with which it is correlated +0.80)",
    ] {
        assert!(driven.contains(words), "{driven}");
    }
    // A share is told of the push alone, which varies by itself: half of the variance.
    assert_eq!(driven.matches(" %").count(), 1, "{driven}");
    let push = driven.split("push ").nth(1).unwrap();
    let share = push.split(' ').nth(1).unwrap().parse::<f64>().unwrap();
    assert!((share - 50.0).abs() < 8.0, "{driven}");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    for words in [
        "together with gust, with which it is correlated +0.80",
        "Numbers that are correlated with each other have none",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // By itself each has its share.
    let (told, _) = flown(&Folder::new("campaign_uncorrelated"), NORMAL);
    let driven = told
        .lines()
        .find(|line| line.contains("driven by"))
        .unwrap();
    assert!(
        !driven.contains("together") && driven.matches(" %").count() == 3,
        "{driven}"
    );
}

/// Rows of one file bring their numbers together, and a constraint does.
#[test]
fn numbers_that_come_to_vary_together_are_told_so() {
    let folder = Folder::new("campaign_of_rows");
    let rows = (0..50).map(|k| format!("{k},{}\n", 50 - k));
    folder.file(
        "rows.csv",
        &format!("w [m],g [m]\n{}", rows.collect::<String>()),
    );
    let table = |name: &str, column: &str| {
        format!("{name} = {{ dist = \"table\", file = \"rows.csv\", column = \"{column}\" }}\n")
    };
    let file = format!(
        "seed = 1\ncases = 200\n[params]\n{}{}",
        table("wind", "w"),
        table("gust", "g")
    );
    let (told, _) = flown(&folder, &file);
    assert!(
        told.contains("(together with gust, with which it is correlated -1.00)"),
        "{told}"
    );
    // Each tells the row, whatever their correlation: shares of both would be more than all.
    let folder = Folder::new("campaign_of_mixed_rows");
    let rows = (0..50).map(|k| format!("{k},{}\n", (17 * k) % 50));
    folder.file(
        "rows.csv",
        &format!("w [m],g [m]\n{}", rows.collect::<String>()),
    );
    let (told, _) = flown(&folder, &file);
    let same = "(together with gust, which comes from the same rows of a file)";
    assert!(told.contains(same), "{told}");
    let bound =
        "[[constraint]]\nsum = { wind = 1, push = 1 }\nat_most = \"0 m\"\nat_least = \"-0.5 m\"\n";
    let file = NORMAL.replace("sampling = \"latin\"", "") + bound;
    let (told, _) = flown(&Folder::new("campaign_constrained"), &file);
    assert!(
        told.contains("together with push, with which it is correlated -0."),
        "{told}"
    );
    assert!(
        told.contains("gust") && !told.contains("together with gust"),
        "{told}"
    );
}

#[test]
fn a_folder_of_an_older_version_is_refused_with_what_differs_and_what_to_do() {
    let folder = Folder::new("campaign_older");
    let (_, out) = flown(&folder, NORMAL);
    let scene = folder.file("glide.mbd", GLIDE);
    let file = folder.0.join("dispersed.toml").display().to_string();
    let typed = out.display().to_string();
    let resumed = || {
        let error = run(&["campaign", &scene, &file, "--out", &typed, "--resume"]).unwrap_err();
        (error.code(), error.to_string())
    };
    let manifest = out.join("manifest.json");
    let own = std::fs::read_to_string(&manifest).unwrap();
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    let with = |changes: &[(&str, &str)]| {
        let text = changes.iter().fold(own.clone(), |text, (old, new)| {
            assert!(text.contains(old), "{old}: {text}");
            text.replace(old, new)
        });
        std::fs::write(&manifest, text).unwrap();
    };
    // What differs, each with both values, and the remedies.
    with(&[
        (&version, "\"version\": \"0.0.7\""),
        ("\"name\": \"far\"", "\"name\": \"near\""),
        ("\"build\": \"", "\"build\": \"0"),
    ]);
    let (code, told) = resumed();
    assert_eq!(code, 2);
    let here = format!(
        "version: \"0.0.7\" there, \"{}\" here",
        env!("CARGO_PKG_VERSION")
    );
    for words in [
        "holds another campaign",
        "`--out`",
        "delete this one",
        &here,
        "metrics: \"near\" there alone; \"far\" here alone",
        "build: \"0",
        "(the program was built anew)",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    // An entry that this version does not know, and one that the older one did not write.
    for change in [
        ("\"seed\"", "\"old_entry\": 3,\n  \"seed\""),
        ("\"block\": 100,", ""),
    ] {
        with(&[(&version, "\"version\": \"0.0.7\""), change]);
        let (code, told) = resumed();
        assert_eq!(code, 1);
        for words in [
            "written by mbd 0.0.7",
            "`--out`",
            "delete this one",
            "field `",
        ] {
            assert!(told.contains(words), "{words}: {told}");
        }
    }
    // What only the folder has is told, too.
    with(&[(
        "\"metrics\"",
        "\"correlated\": [[[0, 1], 0.5]],\n  \"metrics\"",
    )]);
    let (_, told) = resumed();
    assert!(told.contains("correlated: "), "{told}");
    std::fs::write(&manifest, own).unwrap();
    run(&["campaign", &scene, &file, "--out", &typed, "--resume"]).unwrap();
}

#[test]
fn rows_and_drawings_beyond_the_end_of_a_run_are_told() {
    let folder = Folder::new("campaign_beyond");
    let out = folder.0.join("out").display().to_string();
    let asked = GLIDE.replace(
        "every = \"0.5 s\"",
        "every = \"4 s\"\ninstants = [\"0 s\", \"3 s\", \"5 s\"]",
    );
    let scene = folder.file("glide.mbd", &asked);
    let every = "warning: `every` is 4 s, and the run ends at 1 s: its history has no rows but those of its start and its end";
    let drawn =
        "warning: `instants` asks for 3 s, 5 s, and the run ends at 1 s: what is drawn is its end";
    let file = folder.file("none.toml", "seed = 1\ncases = 2\n");
    let told = [
        run(&["run", &scene, "--out", &out]).unwrap(),
        run(&["check", &scene]).unwrap(),
        run(&[
            "campaign",
            &scene,
            &file,
            "--out",
            &folder.0.join("many").display().to_string(),
        ])
        .unwrap(),
    ];
    for text in &told {
        assert!(text.contains(every) && text.contains(drawn), "{text}");
    }
    let history = std::fs::read_to_string(format!("{out}/history.csv")).unwrap();
    assert_eq!(history.lines().count(), 3, "{history}");
    // An event ends the runs before: envelopes hold nothing from there on.
    let event = GLIDE.replace(
        "metric far",
        "event over = time rises 0.35 s { then: stop } metric far",
    );
    let scene = folder.file("ended.mbd", &event);
    let envelopes = |every: &str| {
        let text = format!(
            "seed = 1\ncases = 2\n[envelopes]\ncolumns = [\"place\"]\nevery = \"{every}\"\n"
        );
        let file = folder.file("envelopes.toml", &text);
        let out = folder
            .0
            .join(format!("out_{}", every.replace(' ', "_")))
            .display()
            .to_string();
        run(&["campaign", &scene, &file, "--out", &out]).unwrap()
    };
    let told = envelopes("0.1 s");
    assert!(
        told.contains("envelopes hold no case from 0.4 s on: the last of the runs ends at 0.35 s"),
        "{told}"
    );
    let told = envelopes("2 s");
    assert!(
        told.contains("envelopes have no instant but the start: they are taken every 2 s"),
        "{told}"
    );
    // Nothing is said where nothing is asked for beyond.
    let scene = folder.file("glide.mbd", GLIDE);
    let told = run(&["run", &scene, "--out", &out]).unwrap();
    assert!(!told.contains("the run ends at"), "{told}");
}

/// What happened outside of a window is not said not to have happened.
#[test]
fn what_happens_outside_of_a_window_is_told_as_that() {
    let folder = Folder::new("campaign_outside");
    let windows = "event half = time rises 0.5 s { } metric early = time_of half { to: 0.2 s };
        metric late = value place { at: half, from: 0.7 s }; metric high = first_above place { level: 0.1 m, from: 0.01 s, to: 0.05 s };
        metric far";
    let scene = folder.file("glide.mbd", &GLIDE.replace("metric far", windows));
    let file = folder.file("dispersed.toml", "seed = 1\ncases = 2\n");
    let out = folder.0.join("out").display().to_string();
    let told = run(&["campaign", &scene, &file, "--out", &out]).unwrap();
    for words in [
        "because `half` did not happen, or not up to 0.2 s, in 2 runs",
        "because `half` did not happen, or not from 0.7 s on, in 2 runs",
        "because the level was not passed, or not between 0.01 s and 0.05 s, in 2 runs",
    ] {
        assert!(told.contains(words), "{words}\n{told}");
    }
}

/// The lines that the pages write for a shell and for schedulers can be typed.
#[test]
fn the_commands_of_the_page_about_campaigns_are_those_of_the_program() {
    let page = include_str!("../../../../../docs/campaigns.md");
    let mut typed = 0;
    for line in page.lines() {
        let line = line.split(" #").next().unwrap_or_default();
        let line = line.replace("\"$SLURM_CPUS_PER_TASK\"", "4");
        let begins = ["mbd ", "hq ", "srun "]
            .iter()
            .any(|word| line.starts_with(word));
        let Some(at) = line.find("mbd ").filter(|_| begins) else {
            continue;
        };
        let words = line[at..].split_whitespace();
        let words: Vec<&str> = words.collect();
        let read = Cli::try_parse_from(&words);
        assert!(
            read.is_ok(),
            "{line}: {}",
            read.err().map_or(String::new(), |error| error.to_string())
        );
        typed += 1;
    }
    assert_eq!(typed, 6, "lines of the page");
}
