//! What a campaign keeps over time: histories and pages of chosen cases, envelopes, footprints. The same bytes however it is run.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use mbd_campaign::progress::ProgressLine;
use mbd_campaign::run::Settings;
use mbd_campaign::{
    Campaign, Failure, GatherArgs, Resources, ResultSource, Results, Shard, blocks, envelopes,
    report,
};
use mbd_runtime::{InLanes, Model, model};

mod support;

use support::{Folder, files};

model! {
    /// A stone that is thrown over level ground, without air.
    pub model Throw<T> {
        gravity: [0.0, 0.0, -10.0] m/s^2;
        param mass = 1 kg in 0.9 kg ..= 1.1 kg;
        point stone { mass: mass, start at [0.0, 0.0, 2.0] m velocity [3.0, 0.0, 10.0] m/s }
        event landed = stone.position.z falls 0 m { then: stop }
        output height = stone.position.z;
        metric top = max stone.position.z;
        metric east = final stone.position.x;
        metric north = final stone.position.y;
        metric flight = time_of landed;
    }
}

const FILE: &str = r#"
seed = 11
cases = 60
block = 7

[params]
mass = { dist = "normal", sigma = "0.06 kg" }

[start]
stone.vx = { dist = "normal", sigma = "0.5 m/s" }
stone.vy = { dist = "normal", sigma = "0.2 m/s" }
stone.vz = { dist = "normal", sigma = "1 m/s" }

[metrics]
top = { require = { below = "8 m", share = 0.5, confidence = 0.5 } }
east = { require = { below = "8 m", above = "5 m", share = 0.5, confidence = 0.5 } }

[histories]
worst = { top = 3, east = 2 }
smallest = { flight = 2 }
random = 4
failed = "all"
cases = [0, 17]

[envelopes]
columns = ["height", "stone.vx"]
every = "0.25 s"

[[footprint]]
x = "east"
y = "north"

[run]
until = "3 s"
step = "0.05 s"
"#;

fn throw() -> Arc<dyn Model<f64>> {
    let throw = Throw::<f64>::new(ThrowParams::default()).expect("defaults");
    throw.in_lanes().share()
}

fn read(folder: &Folder, text: &str) -> Result<Campaign, Failure> {
    let file = folder.file("dispersions.toml", text);
    Campaign::read(&file, throw(), Settings::default())
}

fn source(folder: &Folder) -> ResultSource {
    ResultSource {
        command: "program run dispersions.toml".to_owned(),
        scene: None,
        campaign: folder.0.join("dispersions.toml"),
    }
}

/// Runs it in shards, on so many threads and lanes.
fn run(folder: &Folder, campaign: &Campaign, out: &Path, shards: u64, resources: Resources) {
    for index in 1..=shards {
        let shard = Shard { index, of: shards };
        let done = blocks::run(
            campaign,
            out,
            (shard, true),
            resources,
            &mut ProgressLine::silent(),
        );
        done.expect("it runs");
    }
    source(folder).write(out).expect("room");
}

fn reported(out: &Path) -> Result<String, Failure> {
    let args = GatherArgs {
        folder: out.to_owned(),
        shards: None,
    };
    report(&args, &|source| {
        Campaign::read(&source.campaign, throw(), Settings::default())
    })
}

const ALONE: Resources = Resources {
    threads: 1,
    lanes: Some(1),
};

/// A campaign that was run and reported, with its results.
fn whole(folder: &Folder, text: &str) -> (Campaign, Results) {
    let campaign = read(folder, text).expect("a campaign");
    let out = folder.0.join("whole");
    run(folder, &campaign, &out, 1, ALONE);
    let told = reported(&out).expect("a page");
    assert!(told.contains("report.html"), "{told}");
    let results = Results::read(&out).expect("results");
    (campaign, results)
}

#[test]
fn threads_lanes_shards_and_resumes_change_no_byte_of_what_is_kept() {
    let folder = Folder::new("kept");
    let (campaign, _) = whole(&folder, FILE);
    let expected = folder.0.join("whole");
    for (shards, lanes) in [(3, 4), (7, 8)] {
        let out = folder.0.join(format!("of_{shards}"));
        let resources = Resources {
            threads: 2,
            lanes: Some(lanes),
        };
        run(&folder, &campaign, &out, shards, resources);
        reported(&out).expect("a page");
        // Broken off among the histories: what is missing is flown again.
        for name in [
            "case_000017.html",
            "case_000000.csv",
            "case_000000.parquet",
            "case_000000.html",
        ] {
            fs::remove_file(out.join("histories").join(name)).expect("it is there");
        }
        reported(&out).expect("a page");
        for part in ["histories", "envelopes", "blocks"] {
            assert!(
                files(&out.join(part)) == files(&expected.join(part)),
                "{part}"
            );
        }
        for name in [
            "envelopes.csv",
            "report.html",
            "cases.parquet",
            "footprint_east_north.svg",
            "envelope_height.svg",
        ] {
            let [here, there] = [&out, &expected].map(|out| fs::read(out.join(name)).expect(name));
            assert!(here == there, "{name}");
        }
    }
}

#[test]
fn histories_are_those_of_the_worst_the_failed_the_named_and_some_at_random() {
    let folder = Folder::new("chosen");
    let (campaign, results) = whole(&folder, FILE);
    let out = folder.0.join("whole");
    let metric = |name: &str| {
        let columns = &results.manifest.metrics;
        let at = columns.iter().position(|column| column.name == name);
        let values = (1..).zip(results.metric(at.expect("a metric")));
        let all: Vec<(u64, f64)> = values.filter(|(_, x)| !x.is_nan()).collect();
        all
    };
    let first = |mut all: Vec<(u64, f64)>, count: usize| {
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        all.truncate(count);
        all.into_iter().map(|(case, _)| case).collect::<Vec<u64>>()
    };
    let measured = |all: Vec<(u64, f64)>, of: &dyn Fn(f64) -> f64| {
        all.into_iter()
            .map(|(case, x)| (case, of(x)))
            .collect::<Vec<_>>()
    };
    // A bound above: the largest. Bounds on both sides: the least room to the nearer one.
    let tops = first(measured(metric("top"), &|x| -x), 3);
    let easts = first(measured(metric("east"), &|x| (8.0 - x).min(x - 5.0)), 2);
    let times = first(metric("flight"), 2);
    let failed: Vec<u64> = results
        .rows
        .iter()
        .filter(|row| row.status != "ok")
        .map(|row| row.case)
        .collect();
    assert!(failed.len() > 2, "{failed:?}");
    let chosen = results.manifest.told.histories.of(&results);
    let with = |word: &str| {
        let own = chosen
            .iter()
            .filter(|it| it.why.iter().any(|why| why.starts_with(word)));
        let mut cases: Vec<u64> = own.map(|it| it.case).collect();
        cases.sort_unstable();
        cases
    };
    for (word, mut expected) in [
        ("worst top", tops),
        ("worst east", easts),
        ("smallest flight", times),
        ("failed: params", failed),
        ("by its number", vec![0, 17]),
    ] {
        expected.sort_unstable();
        assert_eq!(with(word), expected, "{word}");
    }
    let random = with("random");
    assert_eq!(random.len(), 4);
    assert!(!random.contains(&0));
    // One more leaves these.
    let more = read(&folder, &FILE.replace("random = 4", "random = 5")).expect("a campaign");
    let more = more.manifest().told.histories.of(&results);
    for case in &random {
        assert!(
            more.iter()
                .any(|it| it.case == *case && it.why.contains(&"random".to_owned()))
        );
    }
    // Files are there of all whose run could begin, and the page leads to them.
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    for it in &chosen {
        let [csv, html] = ["csv", "html"].map(|end| format!("histories/case_{:06}.{end}", it.case));
        let begun = !results.rows[it.case as usize].time.is_nan();
        assert_eq!(out.join(&csv).is_file(), begun, "{csv}");
        assert_eq!(page.contains(&format!("href=\"./{csv}\"")), begun);
        assert_eq!(page.contains(&format!("href=\"./{html}\"")), begun);
        if begun {
            let (_, history) = campaign.replay(it.case).expect("a case");
            let mut expected = Vec::new();
            history.to_csv(&mut expected).expect("memory");
            assert!(
                fs::read(out.join(&csv)).expect("a history") == expected,
                "{csv}"
            );
        }
    }
    let page = fs::read_to_string(out.join("histories/case_000017.html")).expect("a page");
    for part in [
        "Case 17 of a campaign of Throw",
        "href=\"./../report.html\"",
        "dispersions.toml --case 17",
        "start.stone.vz",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

/// A case whose run stops keeps what it was up to there.
#[test]
fn a_failed_case_keeps_its_rows_up_to_its_last_accepted_step() {
    let folder = Folder::new("stopped");
    let text = FILE.replace("step = \"0.05 s\"", "step = \"0.05 s\"\nmax_steps = 45");
    let campaign = read(&folder, &text).expect("a campaign");
    let out = folder.0.join("whole");
    run(&folder, &campaign, &out, 1, ALONE);
    reported(&out).expect("a page");
    let results = Results::read(&out).expect("results");
    let failed = results
        .rows
        .iter()
        .filter(|row| row.status == "too_many_steps");
    let stopped: Vec<_> = failed.filter(|row| !row.time.is_nan()).collect();
    assert!(stopped.len() > 2, "{}", stopped.len());
    for row in stopped {
        let path = folder
            .0
            .join(format!("whole/histories/case_{:06}.csv", row.case));
        let history = fs::read_to_string(path).expect("a history");
        let last = history
            .lines()
            .last()
            .and_then(|line| line.split(',').next());
        assert_eq!(last.and_then(|time| time.parse().ok()), Some(row.time));
        assert!(row.time > 2.0, "{row:?}");
    }
}

/// Without air h = 2 m + v t − 5 m/s² t², which rises with v: its percentiles are those of v, exactly so for RK4. Cases are in it until they land, at
/// (v + √(v² + 40))/10.
#[test]
fn an_envelope_of_heights_is_that_of_the_closed_form() {
    let folder = Folder::new("envelope");
    let (_, results) = whole(&folder, FILE);
    let told = envelopes::told(&folder.0.join("whole"), &results.manifest).expect("blocks");
    let [height, speed] = told.as_slice() else {
        panic!("two columns");
    };
    assert_eq!(
        (height.name.as_str(), height.unit.as_str()),
        ("height", "m")
    );
    assert_eq!((speed.name.as_str(), speed.times.len()), ("stone.vx", 13));
    let at = results
        .manifest
        .dispersed
        .iter()
        .position(|it| it.name == "start.stone.vz");
    let at = at.expect("dispersed");
    let ok = results.rows.iter().skip(1).filter(|row| row.status == "ok");
    let speeds: Vec<f64> = ok.map(|row| row.values[at]).collect();
    for (row, t) in height.times.iter().copied().enumerate() {
        assert_eq!(t, 0.25 * row as f64);
        let flying = speeds
            .iter()
            .filter(|v| (*v + (*v * *v + 40.0).sqrt()) / 10.0 >= t);
        let mut flying: Vec<f64> = flying.copied().collect();
        flying.sort_by(f64::total_cmp);
        assert_eq!(height.cases[row], flying.len() as u64, "{t}");
        for (line, (name, part)) in height.lines.iter().zip(envelopes::LINES) {
            let rank = ((part * flying.len() as f64).ceil() as usize).max(1);
            let Some(v) = flying.get(rank - 1) else {
                assert!(line[row].is_nan(), "{name} {t}");
                continue;
            };
            let expected = 2.0 + v * t - 5.0 * t * t;
            assert!(
                (line[row] - expected).abs() < 1e-12,
                "{name} {t}: {} {expected}",
                line[row]
            );
        }
        let nominal = 2.0 + 10.0 * t - 5.0 * t * t;
        let landed = nominal < 0.0;
        assert!(height.nominal[row].is_nan() == landed);
        assert!(landed || (height.nominal[row] - nominal).abs() < 1e-12);
    }
}

/// Thrown with one vertical speed all land after T = 1 + √1.4 s: places are normal with the deviations of the speeds times T, and an ellipse of k
/// deviations holds 1 − exp(−k²/2) of them. Four standard errors.
#[test]
fn a_footprint_of_normal_throws_is_that_of_the_closed_form() {
    let folder = Folder::new("footprint");
    let text = FILE
        .replace("cases = 60", "cases = 2000")
        .replace("mass = { dist = \"normal\", sigma = \"0.06 kg\" }", "")
        .replace("stone.vz = { dist = \"normal\", sigma = \"1 m/s\" }", "")
        .replace("failed = \"all\"", "");
    let (_, results) = whole(&folder, &text);
    let footprint = &results.manifest.told.footprints[0];
    let spread = footprint.of(&results).expect("its metrics");
    assert_eq!((spread.places.len(), spread.without), (2000, 0));
    let (n, time) = (2000.0_f64, 1.0 + 1.4_f64.sqrt());
    let spot = spread.spot.expect("a spread");
    assert!((spot.mean[0] - 3.0 * time).abs() < 4.0 * 0.5 * time / n.sqrt());
    assert!(spot.mean[1].abs() < 4.0 * 0.2 * time / n.sqrt());
    for (k, ellipse) in [1.0_f64, 2.0, 3.0].into_iter().zip(&spread.ellipses) {
        for (axis, sigma) in ellipse.half_axes.into_iter().zip([0.5, 0.2]) {
            let expected = k * sigma * time;
            assert!(
                (axis - expected).abs() < 4.0 * expected / (2.0 * n).sqrt(),
                "{axis} {expected}"
            );
        }
        let part = 1.0 - (-0.5 * k * k).exp();
        assert!((ellipse.part - part).abs() < 1e-15);
        let counted = ellipse.inside as f64 / n;
        assert!(
            (counted - part).abs() < 4.0 * (part * (1.0 - part) / n).sqrt(),
            "{counted} {part}"
        );
    }
}

#[test]
fn what_is_asked_for_can_be_changed_and_what_was_flown_stays() {
    let folder = Folder::new("asked");
    whole(&folder, FILE);
    let out = folder.0.join("whole");
    let before = fs::read(out.join("cases.csv")).expect("cases");
    let other = FILE
        .replace("cases = [0, 17]", "cases = [0, 17, 29]")
        .replace("failed = \"all\"", "");
    let campaign = read(&folder, &other).expect("a campaign");
    run(&folder, &campaign, &out, 1, ALONE);
    reported(&out).expect("a page");
    assert!(out.join("histories/case_000029.csv").is_file());
    assert!(fs::read(out.join("cases.csv")).expect("cases") == before);
    // Other instants are other results.
    let other = FILE.replace("every = \"0.25 s\"", "every = \"0.5 s\"");
    let campaign = read(&folder, &other).expect("a campaign");
    let shard = (Shard::WHOLE, true);
    let error = blocks::run(&campaign, &out, shard, ALONE, &mut ProgressLine::silent());
    let error = error.expect_err("another campaign");
    assert!(error.to_string().contains("envelopes: "), "{error}");
}

#[test]
fn a_page_is_written_without_histories_that_cannot_be_flown_again_and_that_is_told() {
    let folder = Folder::new("elsewhere");
    let campaign = read(&folder, FILE).expect("a campaign");
    let out = folder.0.join("out");
    run(&folder, &campaign, &out, 1, ALONE);
    fs::remove_file(folder.0.join("dispersions.toml")).expect("ours");
    let error = reported(&out).expect_err("no histories");
    assert_eq!(error.code(), 4);
    let told = error.to_string();
    assert!(
        told.contains("histories are missing") && told.contains("dispersions.toml"),
        "{told}"
    );
    assert!(
        fs::read_to_string(out.join("report.html"))
            .expect("a page")
            .contains(">missing<")
    );
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("The nominal is not shown as it moves, because"));
    // Of another campaign no history is flown.
    folder.file("dispersions.toml", &FILE.replace("seed = 11", "seed = 12"));
    let error = reported(&out).expect_err("another campaign");
    assert!(
        error.to_string().contains("seed: 11 there, 12 here"),
        "{error}"
    );
}

/// As after a disk that failed: whoever puts the folder together says which file is to be flown again, and that is enough.
#[test]
fn a_damaged_file_is_named_and_what_is_said_of_it_mends_the_folder() {
    let folder = Folder::new("damaged");
    let campaign = read(&folder, FILE).expect("a campaign");
    let out = folder.0.join("out");
    run(&folder, &campaign, &out, 1, ALONE);
    reported(&out).expect("a page");
    let all = || ["cases.csv", "envelopes.csv"].map(|name| fs::read(out.join(name)).expect(name));
    let whole = all();
    let last = campaign.manifest().blocks() - 1;
    for block in [3, last] {
        let rows = out.join(format!("blocks/{block:08}.csv"));
        for damaged in [rows.clone(), out.join(format!("envelopes/{block:08}.npy"))] {
            let found = fs::read(&damaged).expect("a file");
            for kept in [0, found.len() / 2] {
                fs::write(&damaged, &found[..kept]).expect("room");
                let error = reported(&out).expect_err("damaged").to_string();
                let again = format!("take {} away, and go on with --resume", rows.display());
                assert!(error.contains(&again), "{error}");
                fs::remove_file(&rows).expect("ours");
                run(&folder, &campaign, &out, 1, ALONE);
                reported(&out).expect("a page");
                assert!(all() == whole, "{}", damaged.display());
            }
        }
    }
}

/// Percentiles of nothing are nothing, not zero.
#[test]
fn the_nominal_alone_has_empty_envelopes_and_no_ellipse() {
    let folder = Folder::new("alone");
    let text = FILE
        .replace("cases = 60", "cases = 0")
        .replace("[0, 17]", "[0]");
    let campaign = read(&folder, &text).expect("a campaign");
    let out = folder.0.join("out");
    run(&folder, &campaign, &out, 1, ALONE);
    // Nothing is shown by no cases.
    let error = reported(&out).expect_err("no cases");
    assert_eq!(error.code(), 3);
    assert!(error.to_string().contains("no ellipse"), "{error}");
    assert!(out.join("report.html").is_file() && out.join("histories/case_000000.html").is_file());
    let table = fs::read_to_string(out.join("envelopes.csv")).expect("a table");
    let first = table.lines().nth(1).expect("a row");
    assert_eq!(first, "0.0,2.0,,,,,,,,0,3.0,,,,,,,,0");
}

#[test]
fn mistakes_in_what_is_kept_are_told_by_name() {
    let folder = Folder::new("kept_mistakes");
    for (from, to, said) in [
        (
            "worst = { top = 3",
            "worst = { topp = 3",
            "`histories.worst.topp`: there is no metric `topp`; did you mean `top`?",
        ),
        (
            "worst = { top = 3",
            "worst = { flight = 3",
            "nothing is required of `flight`",
        ),
        (
            "failed = \"all\"",
            "failed = \"some\"",
            "`histories.failed`: say how many, or `\"all\"`",
        ),
        (
            "cases = [0, 17]",
            "cases = [0, 61]",
            "`histories.cases`: there is no case 61: the last is 60",
        ),
        ("random = 4", "randm = 4", "unknown field `randm`"),
        (
            "columns = [\"height\", ",
            "columns = [\"heigth\", ",
            "`envelopes.columns`: histories have no column `heigth`; did you mean `height`?",
        ),
        (
            "columns = [\"height\", ",
            "columns = [\"stone.vx\", ",
            "`stone.vx` stands here twice",
        ),
        (
            "columns = [\"height\", \"stone.vx\"]",
            "columns = []",
            "names no column",
        ),
        (
            "every = \"0.25 s\"",
            "every = \"0.01 ms\"",
            "numbers of each case; at most 100000 are kept",
        ),
        ("every = \"0.25 s\"", "every = \"0 s\"", "must be positive"),
        (
            "y = \"north\"",
            "y = \"nroth\"",
            "`footprint[0].y`: there is no metric `nroth`; did you mean `north`?",
        ),
        (
            "y = \"north\"",
            "y = \"east\"",
            "`east` is both of its metrics",
        ),
        (
            "y = \"north\"",
            "y = \"north\"\nshares = [0.5, 1.0]",
            "1 does not lie between 0 and 1",
        ),
    ] {
        let text = FILE.replace(from, to);
        assert_ne!(text, FILE, "{from}");
        let error = read(&folder, &text).map(drop).expect_err(to);
        assert!(error.to_string().contains(said), "{to}: {error}");
    }
}
