//! Campaigns: the same bytes however they are run, and errors that name what is wrong.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use mbd_campaign::progress::ProgressLine;
use mbd_campaign::run::Settings;
use mbd_campaign::{Campaign, CampaignSummary, Failure, Resources, Results, Shard, blocks};
use mbd_runtime::{Generic, InLanes, Model, model};

mod support;

use support::Folder;

model! {
    /// A lamp on a cord from a knot without mass, in wind.
    pub model Lamp<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 2.0 kg in 0.5 kg ..= 5.0 kg;
        param stiffness = 5 kN/m in 1 kN/m ..= 20 kN/m;
        input wind: [speed; 3];
        world { frame left at [-1.0, 0.0, 2.0] m, frame right at [1.5, 0.0, 2.2] m }
        point lamp { mass: mass, start at [0.4, 0.3, 0.8] m }
        point knot;
        line a from world.left to knot { free_length: 1.2 m, stiffness: stiffness }
        line b from world.right to knot { free_length: 1.6 m, stiffness: stiffness }
        line cord from knot to lamp { free_length: 0.5 m, stiffness: stiffness }
        load air on lamp = 0.05 kg/m * (wind - lamp.velocity) * norm(wind - lamp.velocity);
        event low = lamp.position.z falls 0.75 m;
        output pull = cord.tension in kN;
    }
}

const FILE: &str = r#"
seed = 7
cases = 40
block = 6

[params]
mass = { dist = "normal", sigma = "5 %" }
stiffness = { dist = "uniform", low = "4 kN/m", high = "6 kN/m" }

[start]
lamp.vx = { dist = "normal", mean = "0.5 m/s", three_sigma = "0.6 m/s" }

[inputs]
wind.y = { dist = "triangular", low = "-2 m/s", mode = "0 m/s", high = "3 m/s" }

[metrics]
peak = { max = "pull", require = { below = "1 kN", share = 0.9, confidence = 0.9 } }
height = { final = "lamp.z" }
swung = { value = "lamp.vz", at = "low" }

[run]
until = "0.5 s"
tolerance = 1e-6
"#;

fn lamp() -> Arc<dyn Model<f64>> {
    let lamp = Lamp::<f64>::new(LampParams::default()).expect("defaults");
    lamp.share()
}

fn read(file: &Path) -> Result<Campaign, Failure> {
    Campaign::read(file, lamp(), Settings::default())
}

fn campaign(folder: &Folder, text: &str) -> Campaign {
    read(&folder.file("dispersions.toml", text)).expect("a campaign")
}

fn run(
    campaign: &Campaign,
    out: &Path,
    shard: &str,
    threads: usize,
) -> Result<blocks::Done, Failure> {
    let lanes = Some(1);
    run_on(campaign, out, shard, Resources { threads, lanes })
}

fn run_on(
    campaign: &Campaign,
    out: &Path,
    shard: &str,
    resources: Resources,
) -> Result<blocks::Done, Failure> {
    let shard: Shard = shard.parse().expect("a shard");
    blocks::run(
        campaign,
        out,
        (shard, true),
        resources,
        &mut ProgressLine::silent(),
    )
}

fn gathered(out: &Path) -> String {
    blocks::gather(out, None).expect("all blocks");
    fs::read_to_string(out.join("cases.csv")).expect("cases")
}

/// One process, one thread.
fn whole(campaign: &Campaign, folder: &Folder) -> String {
    let out = folder.0.join("whole");
    run(campaign, &out, "1/1", 1).expect("it runs");
    gathered(&out)
}

#[test]
fn threads_lanes_and_shards_change_no_byte() {
    let folder = Folder::new("shards");
    let campaign = campaign(
        &folder,
        &FILE.replace("until = \"0.5 s\"", "until = \"0.1 s\""),
    );
    let expected = whole(&campaign, &folder);
    assert_eq!(expected.lines().count(), 1 + 41);
    let lamp = Lamp::<f64>::new(LampParams::default()).expect("defaults");
    let file = folder.0.join("dispersions.toml");
    let in_lanes = Campaign::read(&file, lamp.in_lanes().share(), Settings::default());
    let in_lanes = in_lanes.expect("the same campaign");
    // Every number of threads with every number of lanes and every number of shards, and more shards than there are blocks.
    let mut all = vec![(20, 8, 2)];
    for shards in [1, 3, 7] {
        for lanes in [1, 4, 8] {
            all.extend([1, 2, 5].map(|threads| (shards, lanes, threads)));
        }
    }
    for (shards, lanes, threads) in all {
        let out = folder.0.join(format!("of_{shards}_{lanes}_{threads}"));
        for shard in (1..=shards).rev() {
            let resources = Resources {
                threads,
                lanes: Some(lanes),
            };
            let shard = format!("{shard}/{shards}");
            let done = run_on(&in_lanes, &out, &shard, resources).expect("it runs");
            // What the air takes is not integrated along: nobody asks for energy.
            assert!(done.beside <= done.steps);
            // Of several threads each may take one case, which is alone then.
            let may = lanes > 1 && done.cases > 1;
            let is_certain = !may || threads == 1;
            assert!((done.beside > 0) == may || !is_certain);
        }
        assert!(gathered(&out) == expected, "{shards} {lanes} {threads}");
    }
}

#[test]
fn a_campaign_goes_on_after_it_was_broken_off_anywhere() {
    let folder = Folder::new("resume");
    let campaign = campaign(&folder, FILE);
    let expected = whole(&campaign, &folder);
    let out = folder.0.join("broken");
    run(&campaign, &out, "2/3", 2).expect("it runs");
    // What a process that was killed leaves: parts that nobody renamed.
    fs::write(out.join("blocks/00000000.csv.0123.part"), "0,ok,").expect("room");
    let missing = blocks::gather(&out, Some(3)).expect_err("two shards are missing");
    let told = missing.to_string();
    assert!(
        told.contains("5 of 7 blocks") && told.contains("--array=1,3"),
        "{told}"
    );
    // Who does not know of shards is told what to do as well.
    let missing = blocks::gather(&out, None).expect_err("they are missing still");
    assert!(missing.to_string().contains("--resume"), "{missing}");
    let done = run(&campaign, &out, "1/1", 2).expect("it goes on");
    assert_eq!((done.skipped, done.cases), (12, 29));
    assert!(gathered(&out) == expected);
    // Everything is there: nothing is run.
    assert_eq!(run(&campaign, &out, "1/1", 2).expect("it is done").cases, 0);
}

#[test]
fn two_on_one_shard_leave_what_one_would() {
    let folder = Folder::new("twice");
    let campaign = campaign(&folder, FILE);
    let expected = whole(&campaign, &folder);
    let out = folder.0.join("both");
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| run(&campaign, &out, "1/1", 1).expect("it runs"));
        }
    });
    assert!(gathered(&out) == expected);
}

#[test]
fn a_case_alone_is_its_row_to_the_bit() {
    let folder = Folder::new("replay");
    let campaign = campaign(&folder, FILE);
    let expected = whole(&campaign, &folder);
    for case in [0, 1, 17, 40] {
        let (row, history) = campaign.replay(case).expect("a case");
        assert_eq!(
            Some(row.line().as_str()),
            expected.lines().nth(case as usize + 1)
        );
        assert!(history.len() > 10);
    }
    let error = campaign.replay(41).expect_err("the last is 40");
    assert!(
        error.to_string().contains("no case 41: the last is 40"),
        "{error}"
    );
}

#[test]
fn a_further_param_changes_no_column_of_the_others() {
    let folder = Folder::new("further");
    let less = FILE.replace(
        "stiffness = { dist = \"uniform\", low = \"4 kN/m\", high = \"6 kN/m\" }",
        "",
    );
    let [few, all] = [("few.toml", less.as_str()), ("all.toml", FILE)].map(|(name, text)| {
        let campaign = read(&folder.file(name, text)).expect("a campaign");
        let values = (1..=40).map(|case| campaign.dispersions().values(case).expect("values"));
        values.collect::<Vec<_>>()
    });
    for (few, all) in few.iter().zip(&all) {
        assert_eq!(few, &[all[0], all[2], all[3]]);
    }
}

#[test]
fn the_nominal_is_case_zero_and_has_no_dispersion() {
    let folder = Folder::new("nominal");
    let campaign = campaign(&folder, FILE);
    assert_eq!(
        campaign.dispersions().values(0),
        Ok(vec![2.0, 5000.0, 0.0, 0.0])
    );
    let rows = whole(&campaign, &folder);
    // In the units of the declaration.
    let nominal = rows.lines().nth(1).expect("case 0");
    assert!(
        nominal.starts_with("0,ok,0.5,2.0,5.0,0.0,0.0,"),
        "{nominal}"
    );
    let head = "case,status,end [s],mass [kg],stiffness [kN/m],start.lamp.vx [m/s],inputs.wind.y [m/s],height [m],peak [kN],swung [m/s],why";
    assert_eq!(rows.lines().next(), Some(head));
}

/// Columns of 2000 draws against the matrix: 4 standard errors, (1 − r²)/√n.
#[test]
fn correlated_numbers_have_the_correlations_of_their_matrix() {
    let folder = Folder::new("correlated");
    let text = FILE.replace("cases = 40", "cases = 2000").replace(
        "{ dist = \"uniform\", low = \"4 kN/m\", high = \"6 kN/m\" }",
        "{ dist = \"normal\", sigma = \"4 %\" }",
    );
    for sampling in ["random", "latin", "sobol"] {
        let correlated = format!(
            "sampling = \"{sampling}\"\n{text}\n[[correlated]]\nnames = [\"mass\", \"stiffness\", \"start.lamp.vx\"]\nmatrix = [[1.0, 0.7, -0.3], [0.7, 1.0, 0.2], [-0.3, 0.2, 1.0]]\n"
        );
        let campaign = campaign(&folder, &correlated);
        let rows: Vec<Vec<f64>> = (1..=2000)
            .map(|case| campaign.dispersions().values(case).expect("values"))
            .collect();
        let n = rows.len() as f64;
        let mean = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>() / n;
        let product = |i: usize, j: usize| {
            let (a, b) = (mean(i), mean(j));
            rows.iter()
                .map(|row| (row[i] - a) * (row[j] - b))
                .sum::<f64>()
                / n
        };
        for (i, j, r) in [(0, 1, 0.7_f64), (0, 2, -0.3), (1, 2, 0.2), (0, 3, 0.0)] {
            let found = product(i, j) / (product(i, i) * product(j, j)).sqrt();
            assert!(
                (found - r).abs() < 4.0 * (1.0 - r * r) / n.sqrt(),
                "{sampling} {i} {j}: {found} for {r}"
            );
        }
        // What each is by itself stays: 2 kg ± 5 %, 0.5 m/s ± 0.2 m/s.
        assert!((mean(0) - 2.0).abs() < 4.0 * 0.1 / n.sqrt());
        assert!((product(2, 2).sqrt() - 0.2).abs() < 4.0 * 0.2 / (2.0 * n).sqrt());
    }
}

/// A matrix whose first numbers decide each other says nothing of the third that they could have both: it was taken, and the third followed the first alone.
#[test]
fn a_matrix_that_no_numbers_have_is_refused_and_one_whose_numbers_decide_each_other_is_kept() {
    let folder = Folder::new("decided");
    let correlated = |of_second: f64| {
        format!(
            "{FILE}\n[[correlated]]\nnames = [\"mass\", \"stiffness\", \"start.lamp.vx\"]\nmatrix = [[1.0, 1.0, 0.5], [1.0, 1.0, {of_second}], [0.5, {of_second}, 1.0]]\n"
        )
    };
    let file = folder.file("dispersions.toml", &correlated(-0.5));
    let refused = read(&file).err().expect("no such numbers").to_string();
    assert!(refused.contains("not positive definite"), "{refused}");
    let kept = campaign(&folder, &correlated(0.5));
    for case in 1..=40 {
        let values = kept.dispersions().values(case).expect("values");
        // 2 kg ± 5 % and 4 to 6 kN/m have the same place in their distributions.
        let part = (values[1] / 1000.0 - 4.0) / 2.0;
        let below = 0.5 * libm::erfc(-(values[0] / 2.0 - 1.0) / 0.05 / 2f64.sqrt());
        assert!((part - below).abs() < 1e-12, "{values:?}");
    }
}

/// Of a copula with r = 0.9: a normal number and one of two values are correlated by r √(2/π); a normal number and the quintiles v_k of a table by
/// r Σ v_k (φ(q_k) − φ(q_{k+1})) / σ_v, in whatever order they are written.
#[test]
fn correlated_values_of_lists_and_tables_rise_together_whatever_order_they_are_written_in() {
    let folder = Folder::new("order");
    folder.file(
        "winds.csv",
        "east [m/s],north [m/s]\n3,30\n1,10\n2,20\n5,50\n4,40\n",
    );
    let of_file = |names: &str, sampling: &str| {
        format!(
            "cases = 1000\nsampling = \"{sampling}\"\n[params]\nmass = {{ dist = \"normal\", sigma = \"5 %\" }}\nstiffness = {{ dist = \"discrete\", values = [\"6 kN/m\", \"4 kN/m\"] }}\n[inputs]\nwind.x = {{ dist = \"table\", file = \"winds.csv\", column = \"east\" }}\nwind.y = {{ dist = \"table\", file = \"winds.csv\", column = \"north\" }}\n[[correlated]]\nnames = [\"mass\", \"stiffness\", {names}]\nmatrix = [[1.0, 0.9, 0.9], [0.9, 1.0, 0.9], [0.9, 0.9, 1.0]]\n[run]\nuntil = \"0.1 s\""
        )
    };
    for sampling in ["random", "latin", "sobol"] {
        let campaign = campaign(&folder, &of_file("\"inputs.wind.x\"", sampling));
        let rows: Vec<Vec<f64>> = (1..=1000)
            .map(|case| campaign.dispersions().values(case).expect("values"))
            .collect();
        let n = rows.len() as f64;
        let mean = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>() / n;
        let means: Vec<f64> = (0..4).map(mean).collect();
        let product = |i: usize, j: usize| {
            let off = |row: &[f64], at: usize| row[at] - means[at];
            rows.iter()
                .map(|row| off(row, i) * off(row, j))
                .sum::<f64>()
                / n
        };
        let (r, [far, near]) = (0.9, [0.279_962_0, 0.386_342_5]);
        let quintiles = -far + 2.0 * (far - near) + 4.0 * (near - far) + 5.0 * far;
        for (j, expected) in [
            (1, r * (2.0 / std::f64::consts::PI).sqrt()),
            (2, r * quintiles / 2f64.sqrt()),
        ] {
            let found = product(0, j) / (product(0, 0) * product(j, j)).sqrt();
            assert!(
                (found - expected).abs() < 4.0 / n.sqrt(),
                "{sampling} {j}: {found} for {expected}"
            );
        }
        assert!(rows.iter().all(|row| row[3] == 10.0 * row[2]), "{sampling}");
    }
    // What comes from one row varies as the rows do.
    let file = folder.file("dispersions.toml", &of_file("\"inputs.wind.x\"", "random"));
    let both = fs::read_to_string(&file)
        .expect("a file")
        .replace("\"stiffness\", \"inputs", "\"inputs.wind.y\", \"inputs");
    let refused = read(&folder.file("both.toml", &both))
        .err()
        .expect("one row")
        .to_string();
    assert!(
        refused.contains("winds.csv come from one of its rows"),
        "{refused}"
    );
}

#[test]
fn draws_obey_their_constraints_and_a_constraint_that_nothing_obeys_is_a_failed_case() {
    let folder = Folder::new("constraint");
    let constrained =
        |bound: &str| format!("{FILE}\n[[constraint]]\nsum = {{ mass = 1 }}\n{bound}\n");
    let heavy = campaign(&folder, &constrained("at_least = \"2.05 kg\""));
    let masses: Vec<f64> = (1..=40)
        .map(|case| heavy.dispersions().values(case).expect("values")[0])
        .collect();
    assert!(masses.iter().all(|mass| *mass >= 2.05), "{masses:?}");
    let impossible = campaign(&folder, &constrained("at_most = \"0.1 kg\""));
    let rows = whole(&impossible, &folder);
    // The nominal is not drawn.
    assert!(
        rows.lines()
            .nth(1)
            .is_some_and(|row| row.starts_with("0,ok"))
    );
    let row = rows.lines().nth(2).expect("case 1");
    assert!(
        row.starts_with("1,start,") && row.contains("10000 draws of case 1"),
        "{row}"
    );
    // It is no joint whose coordinates do not fit.
    assert!(!row.contains("loops"), "{row}");
}

#[test]
fn a_grid_has_every_combination_once() {
    let folder = Folder::new("grid");
    let text = "sampling = \"grid\"
        [params]
        mass = { dist = \"grid\", values = [\"1 kg\", \"2 kg\", \"3 kg\"] }
        stiffness = { dist = \"grid\", values = [\"4 kN/m\", \"5 kN/m\"] }
        [run]\nuntil = \"0.1 s\"";
    let campaign = campaign(&folder, text);
    assert_eq!(campaign.cases(), 7);
    let rows: Vec<Vec<f64>> = (1..7)
        .map(|case| campaign.dispersions().values(case).expect("values"))
        .collect();
    let expected = [
        [1.0, 4e3],
        [1.0, 5e3],
        [2.0, 4e3],
        [2.0, 5e3],
        [3.0, 4e3],
        [3.0, 5e3],
    ];
    assert_eq!(rows, expected);
}

#[test]
fn numbers_of_one_file_come_from_one_row() {
    let folder = Folder::new("table");
    folder.file("winds.csv", "east [m/s],north [m/s]\n1,10\n2,20\n3,30\n");
    let table = |column: &str| {
        format!("{{ dist = \"table\", file = \"winds.csv\", column = \"{column}\" }}")
    };
    // The number before it takes a dimension of its own.
    for sampling in ["random", "latin", "sobol"] {
        let text = format!(
            "cases = 128\nsampling = \"{sampling}\"\n[params]\nmass = {{ dist = \"uniform\", low = \"2 kg\", high = \"3 kg\" }}\n[inputs]\nwind.x = {}\nwind.y = {}\n[run]\nuntil = \"0.1 s\"",
            table("east"),
            table("north")
        );
        let campaign = campaign(&folder, &text);
        let mut seen = [0; 3];
        for case in 1..=128 {
            let values = campaign.dispersions().values(case).expect("values");
            assert_eq!(values[2], 10.0 * values[1], "{sampling}");
            seen[values[1] as usize - 1] += 1;
        }
        assert!(seen.iter().all(|count| *count > 20), "{sampling} {seen:?}");
    }
    // Rows are those of the file, whatever it is called, with the mark of a spreadsheet in front.
    folder.file(
        "winds.csv",
        "\u{feff}east [m/s],north [m/s],north [kph]\n1,10,5\n2,20,6\n3,30,7\n",
    );
    let two = |north: &str| {
        let text = format!(
            "cases = 64\n[inputs]\nwind.x = {}\nwind.y = {}\n[run]\nuntil = \"0.1 s\"",
            table("east"),
            table(north).replace("winds", "./winds")
        );
        folder.file("dispersions.toml", &text)
    };
    let spelt = read(&two("north [m/s]")).expect("a campaign");
    for case in 1..=64 {
        let values = spelt.dispersions().values(case).expect("values");
        assert_eq!(values[1], 10.0 * values[0]);
    }
    let error = read(&two("north")).err().expect("two columns");
    let several = "winds.csv has several columns `north`";
    assert!(error.to_string().contains(several), "{error}");
    two("north [m/s]");
    folder.file("winds.csv", "east [m/s],north [m/s]\n1,10\nNaN,20\n");
    let error = read(&folder.0.join("dispersions.toml"))
        .err()
        .expect("NaN is no wind");
    assert!(
        error.to_string().contains("line 3: `NaN` in column `east`"),
        "{error}"
    );
    folder.file("winds.csv", "east [m/s];north [m/s]\n1,5;10\n");
    let error = read(&folder.0.join("dispersions.toml"));
    let error = error.err().expect("semicolons part nothing");
    let parted = "cells are parted by commas, and numbers have decimal points";
    assert!(error.to_string().contains(parted), "{error}");
}

#[test]
fn params_out_of_their_range_fail_their_case_and_are_counted_as_not_meeting_what_is_required() {
    let folder = Folder::new("range");
    let wide = FILE.replace(
        "mass = { dist = \"normal\", sigma = \"5 %\" }",
        "mass = { dist = \"uniform\", low = \"1 kg\", high = \"6 kg\" }",
    );
    let campaign = campaign(&folder, &wide);
    whole(&campaign, &folder);
    let results = Results::read(&folder.0.join("whole")).expect("gathered");
    let failed: Vec<u64> = results
        .rows
        .iter()
        .filter(|row| row.status == "params")
        .map(|row| row.case)
        .collect();
    let heavy: Vec<u64> = results
        .rows
        .iter()
        .filter(|row| row.values[0] > 5.0)
        .map(|row| row.case)
        .collect();
    assert!(!heavy.is_empty() && failed == heavy, "{failed:?} {heavy:?}");
    assert!(results.rows[heavy[0] as usize].why.contains("mass"));
    let summary = CampaignSummary::of(&results);
    let peak = &summary.metrics[1];
    assert_eq!(
        (peak.name.as_str(), peak.without),
        ("peak", heavy.len() as u64)
    );
    assert!(peak.verdict.expect("required").missed >= heavy.len() as u64);
    assert_eq!(summary.failures[0].cases, heavy);
}

model! {
    /// A weight on a cord from a knot without mass that is drawn to the side. What holds the knot parts at its strength, and nothing holds the knot then.
    pub model Moored<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param strength = 100 N in 1 N ..= 1 kN;
        world { frame hook at [0.0, 0.0, 2.0] m }
        point weight { mass: 1 kg, start at [0.1, 0.0, 1.0] m }
        point knot { equilibrium: static }
        line upper from world.hook to knot { free_length: 0.5 m, stiffness: 1 kN/m }
        line lower from knot to weight { free_length: 0.5 m, stiffness: 1 kN/m }
        load side on knot = [5.0, 0.0, 0.0] N;
        event parts = upper.tension rises strength { detach: [upper, lower] }
    }
}

/// Exactly the cases whose mooring is weaker than the pull at its peak end where it parts: by name, with the last good state, and in lanes as alone.
#[test]
fn a_point_that_finds_no_balance_fails_its_case_where_nothing_holds_it() {
    let folder = Folder::new("balance");
    let text = "seed = 2\ncases = 30\n[params]\nstrength = { dist = \"uniform\", low = \"10 N\", high = \"20 N\" }
        [metrics]\npeak = { max = \"upper.tension\" }\n[run]\nuntil = \"0.5 s\"\nstep = \"1 ms\"";
    let file = folder.file("dispersions.toml", text);
    let moored = Moored::<f64>::new(MooredParams::default()).expect("defaults");
    let model = moored.in_lanes().share();
    let campaign = Campaign::read(&file, model, Settings::default()).expect("a campaign");
    let alone = whole(&campaign, &folder);
    let beside = folder.0.join("beside");
    let resources = Resources {
        threads: 1,
        lanes: Some(4),
    };
    let done = run_on(&campaign, &beside, "1/1", resources).expect("it runs");
    assert!(done.beside > 0);
    assert_eq!(gathered(&beside), alone);
    let results = Results::read(&folder.0.join("whole")).expect("gathered");
    // The nominal holds, and pulls as every case does that holds.
    let most = results.rows[0].metrics[0];
    for row in &results.rows[1..] {
        let holds = row.values[0] > most;
        let status = if holds { "ok" } else { "newton_not_converged" };
        assert_eq!(row.status, status, "{}: {most}", row.line());
        match holds {
            true => assert_eq!(row.metrics[0], most),
            false => {
                for said in ["no equilibrium of `knot`", "what held it against its load"] {
                    assert!(row.why.contains(said), "{}", row.why);
                }
            }
        }
    }
    let failed: Vec<_> = results
        .rows
        .iter()
        .filter(|row| row.status != "ok")
        .collect();
    assert!((5..26).contains(&failed.len()), "{}", failed.len());
    for row in &failed[..3] {
        let (again, history) = campaign.replay(row.case).expect("a case");
        assert_eq!(again.line(), row.line());
        // It ends where the mooring parts.
        let last = |name: &str| {
            history
                .column(name)
                .and_then(|column| column.last())
                .copied()
        };
        assert_eq!(last("time"), Some(row.time));
        let pull = last("upper.tension").expect("a column");
        let strength = row.values[0];
        assert!((pull / strength - 1.0).abs() < 1e-6, "{pull} {strength}");
    }
}

model! {
    /// A cart drawn to the middle of a rail by a force from a table over its place; both the size of the force and the place of the middle are params.
    pub model Drawn {
        gravity: none;
        param scale = 1.0 in 0.1 ..= 10.0;
        param shift = 0 m in -1 m ..= 1 m;
        table pull = { -10 m: 10 N, 10 m: -10 N };
        point cart { mass: 1 kg, start at [1.0, 0.0, 0.0] m }
        load draw on cart = [scale * pull(cart.position.x + shift), 0 N, 0 N];
    }
}

/// A table of a scene is dispersed by params in the formula that reads it: the motion is (1 m + shift) cos(√scale t) − shift.
#[test]
fn a_table_is_dispersed_by_the_params_of_its_formula() {
    let folder = Folder::new("profile");
    let text = "seed = 5\ncases = 12\n[params]\nscale = { dist = \"uniform\", low = \"0.5\", high = \"2\" }
        shift = { dist = \"normal\", sigma = \"0.2 m\" }\n[metrics]\nx = { final = \"cart.x\" }\nleast = { min = \"cart.x\" }
        [run]\nuntil = \"4 s\"\nmethod = \"tsit5\"\ntolerance = 1e-9";
    let file = folder.file("dispersions.toml", text);
    let drawn = Drawn::new(DrawnParams::default()).expect("defaults");
    let campaign = Campaign::read(&file, drawn.share(), Settings::default()).expect("a campaign");
    whole(&campaign, &folder);
    let results = Results::read(&folder.0.join("whole")).expect("gathered");
    assert_eq!(results.rows.len(), 13);
    for row in &results.rows {
        let ([scale, shift], [least, x]) = (&row.values[..], &row.metrics[..]) else {
            panic!("{}", row.line());
        };
        let turn = scale.sqrt() * 4.0;
        let expected = (1.0 + shift) * turn.cos() - shift;
        assert!((x - expected).abs() < 1e-6, "{x} {expected}");
        if turn > std::f64::consts::PI {
            let lowest = -1.0 - 2.0 * shift;
            assert!((least - lowest).abs() < 1e-6, "{least} {lowest}");
        }
    }
}

model! {
    /// A plate that spins: its inertia is given by params, or by how its mass is spread along its axes.
    pub model Plates {
        gravity: none;
        param ixx = 1.0 kg*m^2 in 0.1 kg*m^2 ..= 9 kg*m^2;
        param iyy = 1.0 kg*m^2 in 0.1 kg*m^2 ..= 9 kg*m^2;
        param izz = 1.9 kg*m^2 in 0.1 kg*m^2 ..= 9 kg*m^2;
        /// ∫x² dm and the like: whatever positive numbers these are, there is such a body.
        param sx = 1.0 kg*m^2 in 0.01 kg*m^2 ..= 9 kg*m^2;
        param sy = 0.9 kg*m^2 in 0.01 kg*m^2 ..= 9 kg*m^2;
        param sz = 0.1 kg*m^2 in 0.01 kg*m^2 ..= 9 kg*m^2;
        body plate { mass: 10 kg, inertia: diag(ixx, iyy, izz) }
        body spread { mass: 10 kg, inertia: diag(sy + sz, sx + sz, sx + sy) }
        joint plate_free: free from world to plate.com;
        joint spread_free: free from world to spread.com;
        output spin = norm(plate.omega_body);
    }
}

/// Principal moments of a body keep c ≤ a + b. Params that break it fail their case by the name of the body; draws that are bound to keep it, or params that
/// say how mass is spread, never do.
#[test]
fn an_inertia_that_no_body_has_fails_its_case_by_name_and_bounded_draws_have_none() {
    let folder = Folder::new("inertia");
    let file = |dispersed: &str, constraint: &str| {
        format!(
            "seed = 1\ncases = 60\n[params]\n{dispersed}\n[metrics]\nspin = {{ max = \"spin\" }}\n[run]\nuntil = \"10 ms\"\nstep = \"5 ms\"\n{constraint}"
        )
    };
    let normal = |names: [&str; 3]| {
        names
            .map(|name| format!("{name} = {{ dist = \"normal\", sigma = \"8 %\" }}\n"))
            .concat()
    };
    let moments = normal(["ixx", "iyy", "izz"]);
    let bounds = [
        "{ ixx = 1, iyy = 1, izz = -1 }",
        "{ ixx = 1, iyy = -1, izz = 1 }",
        "{ ixx = -1, iyy = 1, izz = 1 }",
    ];
    let bounds = bounds
        .map(|sum| format!("[[constraint]]\nsum = {sum}\nat_least = \"0 kg*m^2\"\n"))
        .concat();
    let plates = Plates::new(PlatesParams::default())
        .expect("defaults")
        .share();
    let statuses = |name: &str, text: String| {
        let file = folder.file(&format!("{name}.toml"), &text);
        let campaign =
            Campaign::read(&file, plates.clone(), Settings::default()).expect("a campaign");
        let out = folder.0.join(name);
        run(&campaign, &out, "1/1", 1).expect("it runs");
        gathered(&out);
        let results = Results::read(&out).expect("results");
        let failed = results.rows.iter().filter(|row| row.status != "ok");
        failed
            .map(|row| (row.status.clone(), row.why.clone()))
            .collect::<Vec<_>>()
    };
    let failed = statuses("moments", file(&moments, ""));
    // Of a + b − c about 0.1 with a deviation of 0.19 some 30 % are negative.
    assert!((5..40).contains(&failed.len()), "{}", failed.len());
    for (status, why) in &failed {
        assert!(
            status == "params"
                && why.contains("`plate.inertia, largest principal moment` is ")
                && why.contains("the sum of the other two"),
            "{why}"
        );
    }
    assert_eq!(statuses("bounded", file(&moments, &bounds)), []);
    assert_eq!(
        statuses("spread", file(&normal(["sx", "sy", "sz"]), "")),
        []
    );
}

#[test]
fn a_folder_of_another_campaign_is_refused_with_both_values() {
    let folder = Folder::new("other");
    let one = campaign(&folder, FILE);
    let out = folder.0.join("out");
    run(&one, &out, "1/1", 1).expect("it runs");
    let other = campaign(&folder, &FILE.replace("seed = 7", "seed = 8"));
    let error = run(&other, &out, "1/1", 1).expect_err("another seed");
    assert_eq!(error.code(), 2);
    assert!(
        error.to_string().contains("seed: 7 there, 8 here"),
        "{error}"
    );
    let longer = campaign(&folder, &FILE.replace("0.5 s\"\ntol", "0.6 s\"\ntol"));
    let error = run(&longer, &out, "1/1", 1).expect_err("another end");
    assert!(error.to_string().contains("settings: "), "{error}");
    // Without being asked to go on, results that are there are not touched.
    let error = blocks::run(
        &one,
        &out,
        (Shard::WHOLE, false),
        Resources {
            threads: 1,
            lanes: None,
        },
        &mut ProgressLine::silent(),
    );
    assert!(
        error
            .expect_err("it is done")
            .to_string()
            .contains("--resume")
    );
}

/// Both found an empty folder, each wrote its manifest over that of the other, and blocks of both lay under the last.
#[test]
fn of_two_campaigns_that_come_to_a_new_folder_at_once_one_has_it() {
    let folder = Folder::new("at_once");
    let both = [7, 8].map(|seed| {
        campaign(
            &folder,
            &FILE.replace("seed = 7", &format!("seed = {seed}")),
        )
    });
    let both = both.map(|campaign| campaign.manifest());
    for round in 0..200 {
        let out = folder.0.join(format!("out_{round}"));
        fs::create_dir_all(&out).expect("a folder");
        let start = std::sync::Barrier::new(2);
        let claimed = std::thread::scope(|scope| {
            let both = both.each_ref().map(|manifest| {
                scope.spawn(|| {
                    start.wait();
                    manifest.claim(&out).is_ok()
                })
            });
            both.map(|thread| thread.join().expect("no panic"))
        });
        assert_eq!(claimed.iter().filter(|it| **it).count(), 1, "{round}");
        // No part of the other is left.
        assert_eq!(fs::read_dir(&out).expect("a folder").count(), 1);
    }
}

#[test]
fn a_block_that_cannot_be_written_is_named_and_the_rest_is_kept() {
    let folder = Folder::new("disk");
    let campaign = campaign(&folder, FILE);
    let out = folder.0.join("out");
    // A folder where the file belongs: the rename fails as on a full disk.
    fs::create_dir_all(out.join("blocks/00000003.csv/taken")).expect("room");
    let error = run(&campaign, &out, "1/1", 2).expect_err("no room");
    assert_eq!(error.code(), 1);
    assert!(error.to_string().contains("00000003.csv"), "{error}");
    fs::remove_dir_all(out.join("blocks/00000003.csv")).expect("ours");
    assert_eq!(run(&campaign, &out, "1/1", 2).expect("room").skipped, 18);
    assert!(gathered(&out) == whole(&campaign, &folder));
}

#[test]
fn the_laws_and_the_compiled_model_give_the_same_campaign() {
    let folder = Folder::new("laws");
    let file = folder.file("dispersions.toml", FILE);
    let compiled = read(&file).expect("a campaign");
    let generic = Generic::<f64>::with_defaults(lamp().scene().clone()).expect("a scene");
    let laws = Campaign::read(&file, generic.share(), Settings::default()).expect("a campaign");
    assert_eq!(laws.manifest(), compiled.manifest());
    for case in [0, 5] {
        let [a, b] = [&laws, &compiled].map(|campaign| campaign.replay(case).expect("a case").0);
        assert_eq!(a.values, b.values);
        for (a, b) in a.metrics.iter().zip(&b.metrics) {
            let both_missing = a.is_nan() && b.is_nan();
            assert!(both_missing || (a - b).abs() < 1e-5 * b.abs(), "{a} {b}");
        }
    }
}

#[test]
fn mistakes_are_told_by_name_with_what_was_meant() {
    let folder = Folder::new("mistakes");
    for (from, to, said) in [
        (
            "mass = {",
            "mas = {",
            "`params.mas`: this scene has no `mas`; did you mean `mass`?",
        ),
        ("lamp.vx", "lamp.vvx", "did you mean `start.lamp.vx`"),
        ("wind.y", "wnid.y", "did you mean `inputs.wind.y`"),
        (
            "dist = \"normal\", sigma",
            "dist = \"norml\", sigma",
            "there is no distribution `norml`; did you mean `normal`?",
        ),
        // Words of other tools.
        (
            "dist = \"normal\", sigma",
            "dist = \"gaussian\", sigma",
            "there is no distribution `gaussian`: it is called `normal`",
        ),
        (
            "sigma = \"5 %\"",
            "std = \"5 %\"",
            "there is no `std`: the standard deviation is called `sigma`",
        ),
        (
            "high = \"6 kN/m\"",
            "max = \"6 kN/m\"",
            "there is no `max`: the largest value is called `high`",
        ),
        (
            "cases = 40",
            "cases = 40\nsampling = \"lhs\"",
            "there is no sampling `lhs`: it is called `latin`",
        ),
        ("[params]", "[param]", "`param`; did you mean `params`?"),
        (
            "sigma = \"5 %\"",
            "sgima = \"5 %\"",
            "`sgima`; did you mean `sigma`?",
        ),
        ("sigma = \"5 %\"", "sigma = \"5 m\"", "wrong unit"),
        ("sigma = \"5 %\"", "sigma = \"0 kg\"", "must be positive"),
        ("sigma = \"5 %\"", "sigma = \"-0.1 kg\"", "must be positive"),
        (
            "sigma = \"5 %\"",
            "low = \"1 kg\"",
            "`low` is no setting of `normal`",
        ),
        ("low = \"4 kN/m\"", "low = \"7 kN/m\"", "must be below"),
        (
            "low = \"4 kN/m\", high = \"6 kN/m\"",
            "low = \"-10 %\", high = \"10 %\"",
            "write `low = \"90 %\"`, `high = \"110 %\"`",
        ),
        (
            "low = \"-2 m/s\"",
            "low = \"10 %\"",
            "the nominal value, which is zero",
        ),
        ("mode = \"0 m/s\"", "mode = \"9 m/s\"", "must lie between"),
        ("max = \"pull\"", "max = \"pul\"", "did you mean `pull`"),
        (
            "peak =",
            "end =",
            "another column of the results has this name",
        ),
        (
            "peak =",
            "mass =",
            "another column of the results has this name",
        ),
        ("cases = 40", "cases = 1000000000", "at most 100000000"),
        (
            "max = \"pull\"",
            "max = \"pull\", min = \"pull\"",
            "say one thing to read",
        ),
        ("at = \"low\"", "at = \"lwo\"", "did you mean `low`"),
        (
            "at = \"low\"",
            "at = \"cord: taut\"",
            "no event `cord: taut` (it has low; it has no line and no stop whose switches are told)",
        ),
        ("below = \"1 kN\"", "below = \"1 m\"", "wrong unit"),
        (
            "below = \"1 kN\"",
            "below = \"1 kN\", above = \"1500 N\"",
            "no value is below 1 kN and above 1.5 kN",
        ),
        // Numbers without a unit are in SI, which is not meant beside kN/m: 4 N/m.
        (
            "low = \"4 kN/m\"",
            "low = 4",
            "`params.stiffness.low`: 4 has no unit, and what it is given for is declared in kN/m: write `\"4 kN/m\"`",
        ),
        (
            "below = \"1 kN\"",
            "below = 1",
            "`metrics.peak.require.below`: 1 has no unit, and what it is given for is declared in kN",
        ),
        (
            "tolerance = 1e-6",
            "params = { stiffness = 5 }",
            "`params.stiffness`: 5 has no unit",
        ),
        (
            "[run]",
            "[[constraint]]\nsum = { stiffness = 1 }\nat_least = 5\n[run]",
            "`constraint[0]`: 5 has no unit",
        ),
        (
            "[run]",
            "[[constraint]]\nsum = { mass = 1 }\nat_least = \"3 kg\"\nat_most = \"1 kg\"\n[run]",
            "no sum is at least the one and at most the other",
        ),
        (
            "[run]",
            "[[constraint]]\nsum = { mass = nan }\nat_least = \"3 kg\"\n[run]",
            "the factor of `mass` is no finite number",
        ),
        (
            "[start]",
            "[start]\n\"lamp.vx\" = { dist = \"normal\", sigma = \"1 m/s\" }",
            "`start.lamp.vx`: is given twice",
        ),
        (
            "[params]",
            "[params]\n\"start.lamp.vx\" = { dist = \"normal\", sigma = \"1 m/s\" }",
            "`start.lamp.vx`: is given twice",
        ),
        (
            "[run]",
            "[constraint]\nsum = { mass = 1 }\n[run]",
            "in double brackets, `[[constraint]]`",
        ),
        ("[metrics]", "[metric]", "`metric`; did you mean `metrics`"),
        (
            "swung = { value",
            "swung = { vlaue",
            "`vlaue`; did you mean `value`",
        ),
        (
            "height = { final = \"lamp.z\" }",
            "height = \"lamp.z\"",
            "expected a metric in braces, `{ max = \"riser.tension\" }`",
        ),
        (
            "dist = \"normal\", sigma",
            "sigma",
            "`mass`: does not say which distribution it has",
        ),
        (
            "block = 6",
            "block = 0",
            "`block`: a file of results holds from 1 to",
        ),
        ("share = 0.9,", "share = 1.9,", "between 0 and 1"),
        ("cases = 40", "", "cases = 1000"),
        ("cases = 40", "casse = 40", "unknown field `casse`"),
        (
            "seed = 7",
            "seed = 7\nsampling = \"sobl\"",
            "did you mean `sobol`",
        ),
        (
            "seed = 7",
            "seed = 7\nsampling = \"halton\"",
            "no sampling `halton`; there are: random, latin, sobol, grid",
        ),
        ("until = \"0.5 s\"", "", "say when the run ends"),
        (
            "until = \"0.5 s\"",
            "untl = \"0.5 s\"",
            "unknown field `untl`",
        ),
    ] {
        let text = FILE.replacen(from, to, 1);
        assert_ne!(text, FILE, "{from}");
        let error = read(&folder.file("wrong.toml", &text))
            .err()
            .unwrap_or_else(|| panic!("{to}: no error"));
        assert_eq!(error.code(), 2, "{error}");
        assert!(error.to_string().contains(said), "{to}: {error}");
        assert!(error.to_string().contains("wrong.toml"), "{error}");
    }
    for (more, said) in [
        (
            "[[correlated]]\nnames = [\"mass\", \"lamp\"]\nmatrix = [[1.0, 0.1], [0.1, 1.0]]",
            "this file disperses no `lamp`",
        ),
        (
            "[[correlated]]\nnames = [\"mass\", \"mass\"]\nmatrix = [[1.0, 0.1], [0.1, 1.0]]",
            "correlated twice",
        ),
        (
            "[[correlated]]\nnames = [\"mass\", \"stiffness\"]\nmatrix = [[1.0, 0.1], [0.2, 1.0]]",
            "symmetric",
        ),
        (
            "[[correlated]]\nnames = [\"mass\", \"stiffness\", \"inputs.wind.y\"]\nmatrix = [[1.0, 0.9, -0.9], [0.9, 1.0, 0.9], [-0.9, 0.9, 1.0]]",
            "not positive definite",
        ),
        (
            "[[constraint]]\nsum = { mass = 1, stiffness = 1 }\nat_most = \"3 kg\"",
            "only what has one unit adds up",
        ),
        (
            "[[constraint]]\nsum = { mass = 1 }",
            "give `at_least` or `at_most`",
        ),
    ] {
        let error = read(&folder.file("wrong.toml", &format!("{FILE}\n{more}\n"))).err();
        let error = error.unwrap_or_else(|| panic!("{more}: no error"));
        assert!(error.to_string().contains(said), "{more}: {error}");
    }
}

#[test]
fn all_mistakes_of_a_file_are_told_at_once_and_what_hangs_on_them_is_not() {
    let folder = Folder::new("all_mistakes");
    let told = |changes: &[(&str, &str)], more: &str| {
        let mut text = format!("{FILE}{more}");
        for (from, to) in changes {
            assert!(text.contains(from), "{from}");
            text = text.replacen(from, to, 1);
        }
        let file = folder.file("wrong.toml", &text);
        let error = read(&file).err().expect("mistakes");
        assert_eq!(error.code(), 2, "{error}");
        let prefix = format!("{}: ", file.display());
        let lines = error.to_string();
        let lines = lines.lines().map(|line| {
            let rest = line.strip_prefix(&prefix);
            rest.unwrap_or_else(|| panic!("{line}")).to_owned()
        });
        lines.collect::<Vec<_>>()
    };
    // One is told as it is told among others, and what names it elsewhere is no mistake of its own.
    let together =
        "\n[[correlated]]\nnames = [\"mass\", \"stiffness\"]\nmatrix = [[1.0, 0.1], [0.1, 1.0]]\n";
    let alone = told(&[("mass = {", "mas = {")], together);
    assert_eq!(alone.len(), 1, "{alone:?}");
    assert!(alone[0].starts_with("`params.mas`: this scene has no `mas`; did you mean `mass`?"));
    let changes = [
        ("mass = {", "mas = {"),
        ("low = \"4 kN/m\"", "low = \"7 kN/m\""),
        ("lamp.vx", "lamp.vvx"),
        ("mode = \"0 m/s\"", "mode = \"9 m/s\""),
        ("max = \"pull\"", "max = \"pul\""),
        ("at = \"low\"", "at = \"lwo\""),
        ("block = 6", "block = 0"),
    ];
    let envelopes = "\n[envelopes]\ncolumns = [\"pul\", \"lamp.z\", \"lamp.z\", \"lamp.zz\"]\nevery = \"-1 s\"\n\n[[footprint]]\nx = \"peak\"\ny = \"heigth\"\n";
    let all = told(&changes, envelopes);
    let begin = [
        "`params.mas`: this scene has no `mas`; did you mean `mass`?",
        "`params.stiffness`: `low` (7000) must be below `high` (6000)",
        "`start.lamp.vvx`: this scene has no `start.lamp.vvx`; did you mean `start.lamp.vx`?",
        "`inputs.wind.y`: `mode` (9) must lie between `low` (-2) and `high` (3)",
        "`envelopes.columns`: histories have no column `pul`; did you mean `pull`?",
        "`envelopes.columns`: `lamp.z` stands here twice",
        "`envelopes.columns`: histories have no column `lamp.zz`",
        "`envelopes.every`: ",
        "`metrics.peak`: histories have no column `pul`; did you mean `pull`?",
        "`metrics.swung`: this scene has no event `lwo`; did you mean `low`?",
        "`block`: a file of results holds from 1 to",
    ];
    assert_eq!(all.len(), begin.len(), "{all:#?}");
    for (line, begin) in all.iter().zip(begin) {
        assert!(line.starts_with(begin), "{line}\n{begin}");
    }
    assert_eq!(alone[0], all[0]);
    // So is what `[run]` and its tables say, and what follows from it alone is not.
    let run = "until = \"-1 s\"\nmetod = \"rk4\"\nmax_steps = \"many\"\nevery = \"-2 s\"\ntolerance = \"x\"\n[run.params]\nmas = \"3 kg\"\nmass = \"3 N\"\n[run.inputs]\nwnid = \"3 m/s\"\nwind = \"3 m/s\"\n";
    let before = "until = \"0.5 s\"\ntolerance = 1e-6\n";
    let all = told(&[(before, run)], "");
    let begin = [
        "`run.max_steps`: `max_steps` is a whole number: write `max_steps = 100000`",
        "`run`: unknown field `metod`; did you mean `method`?",
        "`until`: must not be negative",
        "`every`: must be positive",
        "`params.mas`: this scene has no `mas`; did you mean `mass`?",
        "`params.mass`: `3 N` has the wrong unit: expected kg",
        "`tolerance`: ",
        "`inputs.wind`: ",
        "`inputs.wnid`: this scene has no `wnid`; did you mean `wind`?",
    ];
    assert_eq!(all.len(), begin.len(), "{all:#?}");
    for (line, begin) in all.iter().zip(begin) {
        assert!(line.starts_with(begin), "{line}\n{begin}");
    }
    let start = "\n[run.start]\n\"lamp.zz\" = \"1 m\"\n\"lamp.vx\" = \"1 kg\"\n";
    let all = told(&[], start);
    assert_eq!(all.len(), 2, "{all:#?}");
    assert!(
        all[0].starts_with("`start.lamp.vx`: `1 kg` has the wrong unit"),
        "{all:#?}"
    );
    assert!(
        all[1].starts_with("`start.lamp.zz`: this scene has no `lamp.zz`"),
        "{all:#?}"
    );
    // Of the start what can be told without the params, too.
    let with_params =
        format!("{start}\"lamp.velocity\" = \"[1, 0] m/s\"\n[run.params]\nmas = \"3 kg\"\n");
    let all = told(&[], &with_params);
    let begin = [
        "`params.mas`: this scene has no `mas`",
        "`start.lamp.velocity`: ",
        "`start.lamp.vx`: `1 kg` has the wrong unit",
        "`start.lamp.zz`: this scene has no `lamp.zz`",
    ];
    assert_eq!(all.len(), begin.len(), "{all:#?}");
    for (line, begin) in all.iter().zip(begin) {
        assert!(line.starts_with(begin), "{line}\n{begin}");
    }
    // A sampling that there is not says nothing about grids and confidences.
    let sampling = told(
        &[
            ("seed = 7", "seed = 7\nsampling = \"gird\""),
            (
                "dist = \"uniform\", low = \"4 kN/m\", high = \"6 kN/m\"",
                "dist = \"grid\", values = [\"4 kN/m\"]",
            ),
            ("lamp.vx", "lamp.vvx"),
        ],
        "",
    );
    assert_eq!(sampling.len(), 2, "{sampling:#?}");
    assert!(
        sampling[0].contains("did you mean `grid`?"),
        "{sampling:#?}"
    );
    // Everything that is dispersed is there: what ties it together is told one by one, too, and what is told beside the metrics.
    let tied = "\n[[correlated]]\nnames = [\"mass\", \"lamp\"]\nmatrix = [[1.0, 0.1], [0.1, 1.0]]\n[[constraint]]\nsum = { mass = 1 }\n[[constraint]]\nsum = { mas = 1 }\n";
    let tied = told(&[], tied);
    assert_eq!(tied.len(), 3, "{tied:#?}");
    let beside = "\n[histories]\nlargest = { paek = 1 }\n[[footprint]]\nx = \"peak\"\ny = \"heigth\"\n[[footprint]]\nx = \"peak\"\ny = \"peak\"\n";
    let beside = told(&[("height =", "end ="), ("swung =", "mass =")], beside);
    assert_eq!(beside.len(), 5, "{beside:#?}");
}

#[test]
fn no_cases_are_the_nominal_alone() {
    let folder = Folder::new("none");
    let campaign = campaign(&folder, &FILE.replace("cases = 40", "cases = 0"));
    assert_eq!(whole(&campaign, &folder).lines().count(), 2);
    let summary = CampaignSummary::of(&Results::read(&folder.0.join("whole")).expect("gathered"));
    assert!(!summary.passes(), "nothing is shown by no cases");
}

/// What a run reads of its start every case reads again: a velocity as one vector was no name that a case with other params knew.
#[test]
fn a_start_by_a_vector_is_that_by_its_numbers_in_every_case() {
    let folder = Folder::new("start_by_a_vector");
    let ends = |start: &str| {
        let text = FILE.replace("[start]\n", "").replace(
            "lamp.vx = { dist = \"normal\", mean = \"0.5 m/s\", three_sigma = \"0.6 m/s\" }\n",
            "",
        );
        let campaign = campaign(&folder, &format!("{text}\n[run.start]\n{start}"));
        whole(&campaign, &folder)
    };
    let by_vector = ends("\"lamp.velocity\" = \"[0.5, 0, 0.1] m/s\"\n");
    assert!(!by_vector.contains("start."), "{by_vector}");
    assert_eq!(
        by_vector,
        ends("lamp.vx = \"0.5 m/s\"\nlamp.vy = 0.0\nlamp.vz = \"0.1 m/s\"\n")
    );
}
