//! Metrics that a model declares: of a fall without air they have closed forms, whoever runs the model.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use mbd_campaign::progress::ProgressLine;
use mbd_campaign::run::Settings;
use mbd_campaign::{Campaign, CampaignSummary, CaseRow, Failure, Resources, Results, Told, blocks};
use mbd_compiler::{Interpreted, read_text, read_toml, write_toml};
use mbd_runtime::{Generic, Model, model};

mod support;

use support::Folder;

macro_rules! stone {
    ($($items:tt)*) => {
        model! { $($items)* }
        const TEXT: &str = stringify!($($items)*);
    };
}

stone! {
    pub model Stone {
        gravity: [0.0, 0.0, -10.0] m/s^2;
        param height = 20 m in 1 m ..= 100 m;
        point stone { mass: 1 kg, start at [0.0, 0.0, height] }
        event half = stone.position.z falls 15 m;
        event landed = stone.position.z falls 0 m { then: stop }
        metric fastest = max norm(stone.velocity) in kph;
        metric lowest = min stone.velocity.z;
        metric sideways = final stone.position.x;
        metric mean_speed = mean norm(stone.velocity);
        metric rms_speed = rms norm(stone.velocity);
        metric path = integral norm(stone.velocity);
        metric part = integral norm(stone.velocity) in km { from: 0.5 s, to: 1 s }
        metric fast = time_above norm(stone.velocity) in kph { level: 10 m/s }
        metric since = first_above norm(stone.velocity) { level: 36 kph }
        metric passing = value norm(stone.velocity) { at: half };
        metric fall = time_of landed;
        metric never = first_above norm(stone.velocity) { level: 1 km/s };
    }
}

/// For a fall of 20 m under 10 m/s²: 2 s, 20 m/s. [unit of the metric]
const FALL: [(&str, &str, f64); 11] = [
    ("fastest", "kph", 72.0),
    ("lowest", "m/s", -20.0),
    ("sideways", "m", 0.0),
    ("mean_speed", "m/s", 10.0),
    ("rms_speed", "m/s", 11.547_005_383_792_515),
    ("path", "m", 20.0),
    ("part", "km", 0.00375),
    ("fast", "s", 1.0),
    ("since", "s", 1.0),
    ("passing", "m/s", 10.0),
    ("fall", "s", 2.0),
];

fn campaign_of(
    folder: &Folder,
    model: Arc<dyn Model<f64>>,
    text: &str,
) -> Result<Campaign, Failure> {
    let path = folder.file("dispersions.toml", text);
    Campaign::read(&path, model, Settings::default())
}

const RUN: &str = "cases = 3\n[run]\nuntil = \"3 s\"\ntolerance = 1e-10\n";

#[test]
fn a_fall_has_its_closed_form_in_generated_interpreted_and_generic_models_from_text_and_toml() {
    let stone = Stone::new(StoneParams::default()).expect("defaults");
    let scene = stone.scene().clone();
    let read = read_text(TEXT);
    assert_eq!(read.scene.as_ref(), Some(&scene), "{:?}", read.errors);
    let document = write_toml(&scene);
    assert_eq!(
        read_toml(&document).scene.as_ref(),
        Some(&scene),
        "{document}"
    );
    let defaults: Vec<f64> = stone.params().to_vec();
    let models: [Arc<dyn Model<f64>>; 3] = [
        stone.share(),
        Interpreted::<f64>::new(scene.clone(), &defaults)
            .expect("defaults")
            .share(),
        Generic::<f64>::new(scene, &defaults)
            .expect("defaults")
            .share(),
    ];
    let folder = Folder::new("metrics_forms");
    for model in models {
        let campaign = campaign_of(&folder, model, RUN).expect("a campaign");
        let manifest = campaign.manifest();
        let (row, _) = campaign.replay(0).expect("the nominal");
        assert_eq!(row.status, "ok", "{}", row.why);
        for (name, unit, expected) in FALL {
            let at = manifest
                .metrics
                .iter()
                .position(|metric| metric.name == name);
            let at = at.expect(name);
            assert_eq!(manifest.metrics[at].unit, unit, "{name}");
            let found = row.metrics[at];
            let close = (found - expected).abs() <= 1e-8 * expected.abs().max(1.0);
            assert!(close, "{name}: {found} instead of {expected}");
        }
        let never = manifest.metrics.len() - 1;
        assert!(
            row.metrics[never].is_nan(),
            "what did not happen is no number"
        );
    }
}

#[test]
fn a_column_is_known_by_the_name_that_expressions_give_it() {
    let stone = Stone::new(StoneParams::default())
        .expect("defaults")
        .share();
    let folder = Folder::new("metrics_names");
    let columns = "[metrics]\nhigh = { max = \"stone.position.z\" }\nslow = { min = \"stone.velocity.z\" }\n[envelopes]\ncolumns = [\"stone.position.z\"]\n";
    let campaign = campaign_of(&folder, stone.clone(), &format!("{RUN}{columns}")).expect("valid");
    let metrics = campaign.manifest().metrics;
    let units: Vec<&str> = metrics.iter().rev().take(2).map(|it| &*it.unit).collect();
    assert_eq!(units, ["m/s", "m"]);
    let (row, _) = campaign.replay(0).expect("the nominal");
    let [.., high, slow] = row.metrics[..] else {
        panic!("two metrics");
    };
    assert!((high - 20.0).abs() < 1e-9 && (slow + 20.0).abs() < 1e-9);
    let lost = format!("{RUN}[metrics]\nhigh = {{ max = \"ball.position.z\" }}\n");
    let error = campaign_of(&folder, stone, &lost).err().expect("no ball");
    assert!(
        error.to_string().contains("no column `ball.position.z`"),
        "{error}"
    );
}

#[test]
fn a_campaign_file_adds_metrics_and_says_what_declared_ones_have_to_be() {
    let stone = || {
        Stone::new(StoneParams::default())
            .expect("defaults")
            .share()
    };
    let folder = Folder::new("metrics_require");
    let text = format!(
        "{RUN}[metrics]\nhigh = {{ max = \"stone.z\" }}\nfastest = {{ require = {{ below = \"90 kph\", share = 0.5, confidence = 0.5 }} }}\n"
    );
    let campaign = campaign_of(&folder, stone(), &text).expect("a campaign");
    let metrics = campaign.manifest().metrics;
    assert_eq!(metrics[0].name, "fastest");
    assert_eq!(metrics[0].require.and_then(|it| it.below), Some(90.0));
    assert_eq!(metrics.last().map(|it| it.name.as_str()), Some("high"));
    let told = |metric: &str| {
        let text = format!("{RUN}[metrics]\n{metric}\n");
        campaign_of(&folder, stone(), &text)
            .err()
            .expect("wrong")
            .to_string()
    };
    let twice = told("fastest = { max = \"stone.z\" }");
    assert!(
        twice.contains("metrics.fastest") && twice.contains("only `require`"),
        "{twice}"
    );
    let nothing =
        told("fastst = { require = { below = \"90 kph\", share = 0.5, confidence = 0.5 } }");
    assert!(nothing.contains("metrics.fastst"), "{nothing}");
}

#[test]
fn a_metric_waits_for_what_a_line_can_become_and_for_nothing_else() {
    let text = "model Hung {
        gravity: [0.0, 0.0, -10.0] m/s^2;
        point bob { mass: 1 kg, start at [0.0, 0.0, -1.0] m }
        line cord from world to bob { free_length: 2.25 m, stiffness: 2 kN/m }
        spring coil from world to bob { free_length: 1 m, stiffness: 0.001 N/m }
    }";
    let model = || {
        let scene = read_text(text).scene.expect("a scene");
        Interpreted::<f64>::new(scene, &[]).expect("no params")
    };
    let folder = Folder::new("metrics_switch");
    let waits = |event: &str| {
        let metric = format!("[metrics]\nspeed = {{ value = \"bob.vz\", at = \"{event}\" }}\n");
        campaign_of(&folder, model().share(), &format!("{RUN}{metric}"))
    };
    // It falls 1.25 m in half a second.
    let (row, _) = waits("cord: taut")
        .expect("a campaign")
        .replay(0)
        .expect("flown");
    assert!((row.metrics[0] + 5.0).abs() < 1e-3, "{}", row.metrics[0]);
    for event in ["cord: taught", "cord: tight", "coil: taut", "bob: taut"] {
        let error = waits(event).err().expect("it never happens").to_string();
        assert!(error.contains(&format!("no event `{event}`")), "{error}");
        assert!(error.contains("told as `cord: taut`"), "{error}");
    }
}

#[test]
fn the_rows_of_a_grid_change_no_metric_and_the_end_of_a_case_is_where_it_lands() {
    let stone = Stone::new(StoneParams::default())
        .expect("defaults")
        .share();
    let folder = Folder::new("metrics_every");
    let file = "[metrics]\nlanding = { final = \"stone.vz\" }\nat_half = { value = \"stone.vz\", at = \"half\" }\n";
    let every = RUN.replace("until", "every = \"0.3 s\"\nuntil");
    let campaign = campaign_of(&folder, stone, &format!("{every}{file}")).expect("a campaign");
    let (row, history) = campaign.replay(0).expect("the nominal");
    assert!((row.time - 2.0).abs() < 1e-9, "{}", row.time);
    assert!((history.times().last().expect("a row") - 2.0).abs() < 1e-9);
    let metrics = campaign.manifest().metrics;
    let own = [("landing", "m/s", -20.0), ("at_half", "m/s", -10.0)];
    for (name, _, expected) in FALL.into_iter().chain(own) {
        let at = metrics.iter().position(|metric| metric.name == name);
        let found = row.metrics[at.expect(name)];
        let close = (found - expected).abs() <= 1e-8 * expected.abs().max(1.0);
        assert!(close, "{name}: {found} instead of {expected}");
    }
}

/// Of h m under 10 m/s² a stone falls √(h/5) s: those from below 20 m land before 2 s.
const SHORT: &str = "model Stone {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    param height = 20 m in 1 m ..= 100 m;
    point stone { mass: 1 kg, start at [0.0, 0.0, height] }
    event landed = stone.position.z falls 0 m { then: stop }
    metric fastest = max norm(stone.velocity) { from: 0.2 s, to: 2 s };
    metric since = first_above norm(stone.velocity) { level: 5 m/s, to: 2 s };
}";

#[test]
fn a_case_that_ends_inside_the_window_of_a_metric_says_so_and_is_no_silent_hit() {
    let scene = read_text(SHORT).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[20.0]).expect("defaults");
    let folder = Folder::new("metrics_partial");
    let text = "cases = 40\n[params]\nheight = { dist = \"uniform\", low = \"10 m\", high = \"30 m\" }\n[metrics]\nfastest = { require = { below = \"25 m/s\", share = 0.5, confidence = 0.5 } }\n[run]\nuntil = \"3 s\"\ntolerance = 1e-10\n[histories]\nfailed = \"all\"\n";
    let campaign = campaign_of(&folder, model.share(), text).expect("valid");
    let out = folder.0.join("out");
    let (done, results) = flown(&campaign, &out);
    let is_short = |row: &CaseRow| row.case > 0 && row.values[0] < 20.0;
    let short: Vec<u64> = results
        .rows
        .iter()
        .filter(|row| is_short(row))
        .map(|row| row.case)
        .collect();
    let count = short.len();
    assert!(count > 0 && count < 40);
    assert_eq!((done.failed, done.partial), (0, count as u64));
    let kept = results.manifest.told.histories.of(&results);
    assert!(kept.is_empty(), "none of them failed");
    for row in &results.rows {
        let [fastest, since] = row.metrics[..] else {
            panic!("two metrics");
        };
        let height = if row.case == 0 { 20.0 } else { row.values[0] };
        let speed = 10.0 * (height / 5.0_f64).sqrt().min(2.0);
        assert!(
            (fastest - speed).abs() < 1e-7,
            "{fastest} instead of {speed}"
        );
        assert!(
            (since - 0.5).abs() < 1e-8,
            "a level that was passed is settled"
        );
        if is_short(row) {
            assert_eq!(row.status, "metric_partial");
            let told = "`fastest` counts up to 2 s, and the run ends at ";
            assert!(
                row.why.starts_with(told) && !row.why.contains("since"),
                "{}",
                row.why
            );
        } else {
            assert_eq!((row.status.as_str(), row.why.as_str()), ("ok", ""));
        }
    }
    let summary = CampaignSummary::of(&results);
    let told = mbd_campaign::text(&results, &summary);
    let first = short[0];
    for part in [
        format!(
            "{count} cases count a part of the window only, the first is case {first}: their runs end before 2 s"
        ),
        format!(
            "0 of 40 cases miss it; of {count} that keep it only a part of the window was flown"
        ),
        format!("{count} × metric_partial: case {first}: `fastest` counts up to 2 s"),
    ] {
        assert!(told.contains(&part), "{part}\n{told}");
    }
    assert_eq!(summary.metrics[1].cut, None);
}

/// From 5, 20, 45 and 80 m the stone falls 1, 2, 3 and 4 s.
const HEIGHTS: &str = "sampling = \"grid\"\n[params]\nheight = { dist = \"grid\", values = [\"5 m\", \"20 m\", \"45 m\", \"80 m\"] }\n[run]\nuntil = \"5 s\"\ntolerance = 1e-10\n";

#[test]
fn a_grid_has_no_confidence_and_its_requirements_are_judged_by_the_share_of_its_points() {
    let stone = || {
        Stone::new(StoneParams::default())
            .expect("defaults")
            .share()
    };
    let folder = Folder::new("metrics_grid");
    let cases = [
        ("share = 0.75, confidence = 0.9", "met", true),
        ("share = 0.75", "met", true),
        ("share = 0.8", "NOT MET", false),
        ("share = 1.0", "NOT MET", false),
    ];
    for (at, (share, word, passes)) in cases.into_iter().enumerate() {
        let require =
            format!("[metrics]\nfall = {{ require = {{ below = \"3.5 s\", {share} }} }}\n");
        let campaign =
            campaign_of(&folder, stone(), &format!("{HEIGHTS}{require}")).expect("valid");
        let (_, results) = flown(&campaign, &folder.0.join(format!("out_{at}")));
        let summary = CampaignSummary::of(&results);
        assert_eq!(summary.passes(), passes, "{share}");
        let percentiles = summary.metrics.iter().flat_map(|told| &told.percentiles);
        assert!(percentiles.clone().count() > 0);
        assert!(
            percentiles
                .clone()
                .all(|own| own.low.is_none() && own.high.is_none())
        );
        let told = mbd_campaign::text(&results, &summary);
        let parts = [
            "4 points of a grid beside the nominal; percentiles are shares of these points"
                .to_owned(),
            format!("  {word}: fall below 3.5000 s in "),
            "of the 4 points of the grid 3 keep it; a grid has no confidence".to_owned(),
        ];
        for part in parts {
            assert!(told.contains(&part), "{part}\n{told}");
        }
        for claim in ["% confidence", "not enough cases", " from "] {
            assert!(!told.contains(claim), "{claim}\n{told}");
        }
    }
    let sampled =
        format!("{RUN}[metrics]\nfall = {{ require = {{ below = \"3.5 s\", share = 0.8 }} }}\n");
    let error = campaign_of(&folder, stone(), &sampled)
        .err()
        .expect("no confidence");
    assert!(error.to_string().contains("confidence = 0.9"), "{error}");
}

/// Stones that fall √(h/5) s; from below 15 m none passes that height, from below 12 m a root is no number, and above 100 m there are none.
const REASONS: &str = "model Stone {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    param height = 20 m in 1 m ..= 100 m;
    point stone { mass: 1 kg, start at [0.0, 0.0, height] }
    event landed = stone.position.z falls 0 m { then: stop }
    event passed = stone.position.z falls 15 m;
    output root = sqrt((height - 12 m) * (1 m));
    metric late = max norm(stone.velocity) { from: 2 s };
    metric passing = value norm(stone.velocity) { at: passed };
    metric least = min root;
    metric fast = first_above norm(stone.velocity) { level: 1 km/s };
}";

#[test]
fn cases_without_a_value_are_counted_by_their_own_reasons() {
    let scene = read_text(REASONS).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[20.0]).expect("defaults");
    let folder = Folder::new("metrics_reasons");
    let text = HEIGHTS.replace(
        "\"20 m\", \"45 m\", \"80 m\"",
        "\"11 m\", \"13 m\", \"18 m\", \"45 m\", \"200 m\"",
    );
    let campaign = campaign_of(&folder, model.share(), &text).expect("valid");
    let (done, results) = flown(&campaign, &folder.0.join("out"));
    assert_eq!((done.failed, done.not_finite), (1, 2));
    let summary = CampaignSummary::of(&results);
    let reasons = summary
        .metrics
        .iter()
        .map(|told| (told.name.as_str(), told.without, told.reason()));
    let expected = [
        (
            "late",
            5,
            "the run ended before 2 s, where its window begins, in 4 runs and 1 run failed",
        ),
        (
            "passing",
            4,
            "`passed` did not happen in 3 runs and 1 run failed",
        ),
        (
            "least",
            3,
            "it or its quantity is no finite number in 2 runs and 1 run failed",
        ),
        (
            "fast",
            6,
            "the level was not passed in 5 runs and 1 run failed",
        ),
    ];
    let expected = expected.map(|(name, cases, why)| (name, cases, Some(why.to_owned())));
    assert_eq!(reasons.collect::<Vec<_>>(), expected);
}

#[test]
fn an_event_that_no_run_locates_is_not_told_as_one_that_did_not_happen() {
    let scene = read_text(REACH).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[9.0]).expect("defaults");
    let folder = Folder::new("metrics_not_located");
    let text = "cases = 2\n[params]\nreach = { dist = \"uniform\", low = \"7 m\", high = \"9 m\" }\n[run]\nuntil = \"6 s\"\nlocate = false\n";
    let campaign = campaign_of(&folder, model.share(), text).expect("valid");
    let (_, results) = flown(&campaign, &folder.0.join("out"));
    let summary = CampaignSummary::of(&results);
    let passed = summary.metrics.iter().find(|told| told.name == "passed");
    let reason = passed.and_then(Told::reason);
    let expected = "`far` is not located (`locate = false`) in 2 runs";
    assert_eq!(reason.as_deref(), Some(expected));
}

/// A bob that is thrown up from where a cord just carries it, and falls into the cord again.
const THROWN: &str = "model Thrown {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    param damping = 0 N*s/m in 0 N*s/m ..= 100 N*s/m;
    point bob { mass: 1 kg, start at [0.0, 0.0, -1.01] m velocity [0.0, 0.0, 2.0] m/s }
    line cord from world to bob { free_length: 1 m, stiffness: 1 kN/m, damping: damping }
    event loose = cord.stretch falls 0 m;
}";

#[test]
fn a_switch_that_a_line_does_not_tell_is_named_with_what_tells_it() {
    let scene = read_text(THROWN).scene.expect("a scene");
    let metrics = "[metrics]\nslack = { time_of = \"cord: slack\" }\nidle = { time_of = \"cord: idle\" }\nloose = { time_of = \"loose\" }\n";
    let told = |damping: &str| {
        let model = Interpreted::<f64>::new(scene.clone(), &[0.0]).expect("defaults");
        let folder = Folder::new(&format!("metrics_untold_{}", damping.len()));
        let text = format!(
            "cases = 2\n{metrics}[run]\nuntil = \"1 s\"\ntolerance = 1e-8\nparams = {{ damping = \"{damping}\" }}\n"
        );
        let campaign = campaign_of(&folder, model.share(), &text).expect("valid");
        let (_, results) = flown(&campaign, &folder.0.join("out"));
        let summary = CampaignSummary::of(&results);
        let reasons = summary.metrics.iter();
        let reasons = reasons.filter_map(|told| Some((told.name.clone(), told.reason()?)));
        reasons.collect::<Vec<_>>()
    };
    // The damping is that of the nominal case, not that of the declaration.
    let untold = [
        (
            "0 N*s/m",
            "idle",
            "`cord: idle` is not told (a line without damping pulls until it is `cord: slack`) in 2 runs",
        ),
        (
            "20 N*s/m",
            "slack",
            "`cord: slack` is not told (a damped line between bodies is `cord: idle` before; when it gets shorter than its free length is told by `event loose = cord.stretch falls 0 m`) in 2 runs",
        ),
    ];
    for (damping, name, why) in untold {
        assert_eq!(told(damping), [(name.to_owned(), why.to_owned())]);
    }
}

/// √h √h/h is one up to its last bits, whatever the height.
const ROUNDED: &str = "model Stone {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    param height = 20 m in 1 m ..= 100 m;
    point stone { mass: 1 kg, start at [0.0, 0.0, height] }
    output same = sqrt(height) * sqrt(height) / height * 7;
    output off = sqrt(height) * sqrt(height) - height;
    metric always = final same;
    metric nothing = final off;
    metric way = final stone.position.z;
}";

#[test]
fn nothing_drives_a_metric_whose_spread_is_rounding() {
    let scene = read_text(ROUNDED).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[20.0]).expect("defaults");
    let folder = Folder::new("metrics_rounding");
    let text = "cases = 200\n[params]\nheight = { dist = \"uniform\", low = \"10 m\", high = \"90 m\" }\n[run]\nuntil = \"1 s\"\ntolerance = 1e-10\n";
    let campaign = campaign_of(&folder, model.share(), text).expect("valid");
    let (_, results) = flown(&campaign, &folder.0.join("out"));
    let summary = CampaignSummary::of(&results);
    let [always, nothing, way] = &summary.metrics[..] else {
        panic!("three metrics");
    };
    let [mean, deviation] = always.moments;
    assert!(
        (mean - 7.0).abs() < 1e-14 && deviation > 0.0,
        "{mean} {deviation}"
    );
    assert!(always.drivers.is_empty(), "{:?}", always.drivers);
    // One that is zero has the size of what else is measured in metres.
    let [mean, deviation] = nothing.moments;
    assert!(mean.abs() < 1e-13 && deviation > 0.0, "{mean} {deviation}");
    assert!(nothing.drivers.is_empty(), "{:?}", nothing.drivers);
    assert_eq!(
        way.drivers.first().map(|driver| driver.correlation),
        Some(1.0)
    );
    let told = mbd_campaign::text(&results, &summary);
    assert_eq!(told.matches("driven by").count(), 1, "{told}");
    let rounding = "its spread is rounding: nothing drives it";
    assert_eq!(told.matches(rounding).count(), 2, "{told}");
}

/// A tool that drifts by some tenths of a millimetre beside a ship at 7000 km: its spread was called rounding, because of how far the ship is.
#[test]
fn a_small_spread_beside_a_large_metric_of_its_unit_is_none_of_rounding() {
    let text = "model Far { gravity: none;
        param pace = 1 mm/s in 0.1 mm/s ..= 10 mm/s;
        point ship { mass: 1 kg, start at [7000.0, 0.0, 0.0] km }
        point tool { mass: 1 kg }
        load push on tool = 1 kg/s * [pace, 0 m/s, 0 m/s];
        metric radius = final ship.position.x;
        metric drift = final tool.position.x; }";
    let scene = read_text(text).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[1e-3]).expect("defaults");
    let folder = Folder::new("metrics_far");
    let text = "cases = 30\n[params]\npace = { dist = \"uniform\", low = \"0.5 mm/s\", high = \"2 mm/s\" }\n[run]\nuntil = \"1 s\"\n";
    let campaign = campaign_of(&folder, model.share(), text).expect("valid");
    let (_, results) = flown(&campaign, &folder.0.join("out"));
    let summary = CampaignSummary::of(&results);
    let drift = summary.metrics.iter().find(|told| told.name == "drift");
    let drift = drift.expect("a metric");
    // x = ½ F t² / m: 0.25 to 1 mm.
    let [low, high] = [drift.sorted[0], drift.sorted[29]];
    assert!(2.5e-4 < low && low < 4e-4 && 8e-4 < high && high < 1e-3);
    assert_eq!(drift.caution(), None);
    assert_eq!(drift.drivers.first().map(|it| it.correlation), Some(1.0));
}

/// Runs all of a campaign into a folder.
fn flown(campaign: &Campaign, out: &Path) -> (blocks::Done, Results) {
    let resources = Resources {
        threads: 1,
        lanes: None,
    };
    let whole = (blocks::Shard::WHOLE, false);
    let done = blocks::run(campaign, out, whole, resources, &mut ProgressLine::silent());
    blocks::gather(out, None).expect("all blocks");
    (
        done.expect("it runs"),
        Results::read(out).expect("gathered"),
    )
}

/// A cart at 1 m/s: √(reach − x) is no number from `reach` seconds on, x/x none at the start.
const REACH: &str = "model Cart {
    gravity: none;
    param reach = 3 m in 0.1 m ..= 10 m;
    point cart { mass: 1 kg, start at [0, 0, 0] velocity [1 m/s, 0 m/s, 0 m/s] }
    event far = cart.position.x rises 5 m;
    output left = sqrt((reach - cart.position.x) * (1 m));
    metric least = min left;
    metric way = final cart.position.x;
    metric passed = time_of far;
}";

#[test]
fn a_case_whose_metric_is_no_finite_number_says_so_by_its_status_whoever_flies_it() {
    let scene = read_text(REACH).scene.expect("a scene");
    let model = || {
        Interpreted::<f64>::new(scene.clone(), &[3.0])
            .expect("defaults")
            .share()
    };
    let folder = Folder::new("metrics_not_finite");
    let text = "sampling = \"grid\"\nblock = 2\n[params]\nreach = { dist = \"grid\", values = [\"1 m\", \"4 m\", \"1.5 m\", \"2.5 m\", \"0.5 m\"] }\n[run]\nuntil = \"2 s\"\ntolerance = 1e-8\n";
    let envelopes = "[envelopes]\ncolumns = [\"left\"]\nevery = \"0.25 s\"\n";
    for envelopes in ["", envelopes] {
        let campaign = campaign_of(&folder, model(), &format!("{text}{envelopes}")).expect("valid");
        let mut tables = Vec::new();
        for (index, (threads, lanes, shards)) in
            [(1, 1, 1), (3, 4, 1), (2, 8, 3)].iter().enumerate()
        {
            let out = folder.0.join(format!("out_{index}_{}", envelopes.len()));
            let resources = Resources {
                threads: *threads,
                lanes: Some(*lanes),
            };
            let mut not_finite = 0;
            for shard in 1..=*shards {
                let shard = format!("{shard}/{shards}").parse().expect("a shard");
                let done = blocks::run(
                    &campaign,
                    &out,
                    (shard, true),
                    resources,
                    &mut ProgressLine::silent(),
                );
                let done = done.expect("it runs");
                assert_eq!(done.failed, 0, "all of them come to their end");
                not_finite += done.not_finite;
            }
            assert_eq!(not_finite, 3);
            blocks::gather(&out, None).expect("all blocks");
            tables.push(fs::read_to_string(out.join("cases.csv")).expect("cases"));
        }
        assert!(tables.iter().all(|table| *table == tables[0]));
        let out = folder.0.join(format!("out_0_{}", envelopes.len()));
        let results = Results::read(&out).expect("gathered");
        for row in &results.rows {
            let reach = if row.case == 0 { 3.0 } else { row.values[0] };
            let [least, way, passed] = row.metrics[..] else {
                panic!("three metrics");
            };
            assert!((way - 2.0).abs() < 1e-12, "the others keep their values");
            assert!(passed.is_nan(), "an event that did not happen is no fault");
            assert_eq!(row.time, 2.0);
            if reach > 2.0 {
                assert_eq!((row.status.as_str(), row.why.as_str()), ("ok", ""));
                assert!((least - (reach - 2.0).sqrt()).abs() < 1e-8, "{least}");
            } else {
                assert_eq!(row.status, "output_not_finite");
                assert!(least.is_nan());
                let told = "`least` has no value: its quantity is not a number at ";
                assert!(row.why.starts_with(told), "{}", row.why);
                let row_of_envelope = row.why.contains("`left` is no finite number at ");
                assert_eq!(row_of_envelope, !envelopes.is_empty(), "{}", row.why);
            }
            let (again, _) = campaign.replay(row.case).expect("a case");
            assert_eq!(again.line(), row.line(), "flown again to the bit");
        }
        let summary = CampaignSummary::of(&results);
        assert_eq!(summary.failures.len(), 1);
        assert_eq!(summary.failures[0].cases, [1, 3, 5]);
        let told = mbd_campaign::text(&results, &summary);
        assert!(
            told.contains("3 × output_not_finite: case 1: `least`"),
            "{told}"
        );
    }
}

/// A point that coasts, and something that hums at `pitch`: its mean square is ½ however fast it does.
const HUM: &str = "model Hum {
    gravity: none;
    param pitch = 1 Hz in 0.1 Hz ..= 1e9 Hz;
    point stone { mass: 1 kg, start at [0, 0, 0] velocity [1 m/s, 0 m/s, 0 m/s] }
    output hum = sin(2 * pi * pitch * time) * sin(2 * pi * pitch * time);
    metric loudness = mean hum;
    metric way = final stone.position.x;
}";

#[test]
fn a_case_whose_metric_is_not_resolved_says_so_by_its_status_and_keeps_its_value() {
    let scene = read_text(HUM).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[1.0]).expect("defaults");
    let folder = Folder::new("metrics_unresolved");
    let text = "sampling = \"grid\"\n[params]\npitch = { dist = \"grid\", values = [\"1 Hz\", \"10 kHz\", \"100 Hz\"] }\n[run]\nuntil = \"2 s\"\ntolerance = 1e-6\n";
    let campaign = campaign_of(&folder, model.share(), text).expect("valid");
    let out = folder.0.join("out");
    let done = blocks::run(
        &campaign,
        &out,
        (blocks::Shard::WHOLE, false),
        Resources {
            threads: 1,
            lanes: None,
        },
        &mut ProgressLine::silent(),
    );
    let done = done.expect("it runs");
    assert_eq!((done.failed, done.not_finite, done.unresolved), (0, 0, 1));
    blocks::gather(&out, None).expect("all blocks");
    let results = Results::read(&out).expect("gathered");
    for row in &results.rows {
        let [loudness, way] = row.metrics[..] else {
            panic!("two metrics");
        };
        assert!((way - 2.0).abs() < 1e-12);
        if row.case == 2 {
            assert_eq!(row.status, "metric_unresolved");
            assert!(
                row.why.starts_with("`loudness` is off by about "),
                "{}",
                row.why
            );
            assert!((loudness - 0.5).abs() < 0.5, "told, and kept: {loudness}");
        } else {
            assert_eq!((row.status.as_str(), row.why.as_str()), ("ok", ""));
            assert!((loudness - 0.5).abs() < 1e-9, "{loudness}");
        }
        assert!(row.reached_end());
    }
    let summary = CampaignSummary::of(&results);
    assert_eq!(
        summary.metrics[0].sorted.len(),
        3,
        "it counts with the others"
    );
    let told = mbd_campaign::text(&results, &summary);
    assert!(
        told.contains("1 × metric_unresolved: case 2: `loudness`"),
        "{told}"
    );
}

/// A mass on a spring, pulled out by half a metre.
const SWING: &str = "model Swing {
    gravity: none;
    param stiffness = 1 N/m in 0.1 N/m ..= 1e6 N/m;
    world { frame wall at [0.0, 0.0, 0.0] m }
    point bob { mass: 1 kg, start at [1.5, 0.0, 0.0] m }
    spring coil from world.wall to bob { free_length: 1 m, stiffness: stiffness }
    metric out = final bob.position.x;
}";

#[test]
fn a_case_whose_steps_make_or_lose_energy_says_so_by_its_status() {
    let scene = read_text(SWING).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[1.0]).expect("defaults");
    let folder = Folder::new("metrics_unbalanced");
    // RK4 loses (ωh)⁶/72 of the energy of an oscillation in a step, here 1.25 % of it in 300 steps of the second case.
    let text = "sampling = \"grid\"\n[params]\nstiffness = { dist = \"grid\", values = [\"4 N/m\", \"1444 N/m\"] }\n[run]\nuntil = \"3 s\"\nmethod = \"rk4\"\nstep = \"10 ms\"\n";
    let campaign = campaign_of(&folder, model.share(), text).expect("valid");
    let mut tables = Vec::new();
    for lanes in [None, Some(4)] {
        let out = folder.0.join(format!("out_{}", lanes.unwrap_or(1)));
        let done = blocks::run(
            &campaign,
            &out,
            (blocks::Shard::WHOLE, false),
            Resources { threads: 1, lanes },
            &mut ProgressLine::silent(),
        );
        let done = done.expect("it runs");
        assert_eq!((done.failed, done.unbalanced), (0, 1));
        blocks::gather(&out, None).expect("all blocks");
        tables.push(fs::read_to_string(out.join("cases.csv")).expect("cases"));
        let results = Results::read(&out).expect("gathered");
        let statuses: Vec<&str> = results.rows.iter().map(|row| row.status.as_str()).collect();
        assert_eq!(statuses, ["ok", "ok", "energy_unbalanced"]);
        assert_eq!(
            results.rows[2].why,
            "its steps made or lost 1.2 % of the energy that moved"
        );
        // x = 1 + ½ cos ωt
        assert!((results.rows[1].metrics[0] - 1.0 - 0.5 * 6.0_f64.cos()).abs() < 1e-6);
        let told = mbd_campaign::text(&results, &CampaignSummary::of(&results));
        let says = "1 × energy_unbalanced: case 2: its steps made or lost 1.2 %";
        assert!(told.contains(says), "{told}");
    }
    assert_eq!(tables[0], tables[1]);
}
