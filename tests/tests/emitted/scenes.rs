//! The ready scenes: each runs, stays on its joints and keeps its energy; where the motion is known, it is that.

use mbd_command::run::{Quality, RunOutcome, RunPlan, Settings, fly_model};
use mbd_compiler::{read_toml, write_toml};
use mbd_report::drawings;
use mbd_scene::Layout;
use models::progress::ProgressLine;
use models::scenes::{READY, Ready};
use tests::assert_close;
use tests::reference::{load, numbers};

fn ready(name: &str) -> &'static Ready {
    READY
        .iter()
        .find(|ready| ready.name == name)
        .expect("a ready scene")
}

fn plan(ready: &Ready) -> RunPlan {
    let settings = Settings::read(&(ready.run)()).expect("settings that read");
    RunPlan::new(&(ready.scene)(), &settings).expect("settings that fit the scene")
}

/// Runs a scene as it comes, at most until a time [s].
fn flown(name: &str, until: f64) -> RunOutcome {
    let mut plan = plan(ready(name));
    plan.until = plan.until.min(until);
    let model = (ready(name).model)(&plan.params).expect("default params");
    let outcome = fly_model(&*model, &plan, &mut ProgressLine::silent());
    assert_eq!(outcome.error, None, "{name}");
    outcome
}

fn column<'o>(outcome: &'o RunOutcome, name: &str) -> &'o [f64] {
    outcome
        .trajectory
        .column(name)
        .unwrap_or_else(|| panic!("no column {name}"))
}

fn largest_gap(outcome: &RunOutcome, one: &str, other: &str) -> f64 {
    let pairs = column(outcome, one).iter().zip(column(outcome, other));
    pairs.fold(0.0, |most, (a, b)| (a - b).abs().max(most))
}

#[test]
fn every_scene_stays_on_its_joints_and_keeps_its_energy() {
    for ready in READY {
        let outcome = flown(ready.name, 1.0);
        let scene = (ready.scene)();
        let quality = Quality::of(&outcome.trajectory);
        println!("{}: {quality:?}", ready.name);
        let jointed = Layout::new(&scene).nc > 0;
        assert_eq!(quality.drift.is_some(), jointed, "{}", ready.name);
        assert!(
            quality.drift.is_none_or(|drift| drift <= 1e-12),
            "{}",
            ready.name
        );
        assert!(
            quality.drift_rate.is_none_or(|rate| rate <= 1e-10),
            "{}",
            ready.name
        );
        let balance = outcome.imbalance.expect("energy moves").relative();
        assert!(balance <= 1e-7, "{}: {balance}", ready.name);
        assert!(!drawings(&scene, &plan(ready).params, &[], &outcome.trajectory).is_empty());
        let doc = scene.doc.lines().next().unwrap_or_default();
        assert!(
            doc.len() > 20 && doc.ends_with('.'),
            "{}: a line for the list",
            ready.name
        );
    }
}

#[test]
fn a_scene_written_as_toml_is_the_compiled_scene() {
    for ready in READY {
        let scene = (ready.scene)();
        let read = read_toml(&write_toml(&scene));
        assert!(read.errors.is_empty(), "{}: {:?}", ready.name, read.errors);
        assert_eq!(read.scene.as_ref(), Some(&scene), "{}", ready.name);
    }
}

#[test]
fn the_heavy_top_precesses_at_the_rate_of_the_closed_form() {
    let scene = (ready("heavy_top").scene)();
    let of_reference = &load("closed_form/closed_heavy_top_steady.json")["time_history"]["slow"];
    let rate = scene.consts.iter().find(|known| known.name == "PRECESSION");
    let rate = rate.expect("a const").value.scalar();
    let rate = rate.expect("one number");
    assert_close(
        &[rate],
        &numbers(&of_reference["precession_rate"]),
        1e-13,
        0.0,
        "Ω",
    );
    let outcome = flown("heavy_top", 4.0);
    let nutation = column(&outcome, "nutation");
    assert_close(
        nutation,
        &vec![35.0; nutation.len()],
        0.0,
        1e-7,
        "inclination",
    );
    for (found, closed) in [("axis_x", "closed_form_x"), ("axis_y", "closed_form_y")] {
        let gap = largest_gap(&outcome, found, closed);
        println!("{found}: {gap:e}");
        assert!(gap <= 1e-8, "{found}: {gap}");
    }
    // Every fourth row is an instant of the reference.
    for (k, axis) in of_reference["axis"]
        .as_array()
        .expect("axes")
        .iter()
        .enumerate()
    {
        let found = ["axis_x", "axis_y"].map(|name| column(&outcome, name)[4 * k]);
        assert_close(&found, &numbers(axis)[..2], 0.0, 1e-8, "axis");
    }
}

#[test]
fn the_piston_of_the_slider_crank_goes_where_its_crank_sends_it() {
    let outcome = flown("slider_crank", 2.0);
    let gap = largest_gap(&outcome, "slide", "closed_form");
    println!("{gap:e}");
    assert!(gap <= 1e-13, "{gap}");
    // The drive brings the crank near its own speed: the piston has gone up and down.
    let speed = *column(&outcome, "crank_speed").last().expect("a row");
    assert!((-31.0..-25.0).contains(&speed), "{speed}");
}

#[test]
fn the_four_bar_turns_round_and_its_coupler_keeps_its_length() {
    let outcome = flown("four_bar", 5.0);
    let scene = (ready("four_bar").scene)();
    let length = |name: &str| {
        let known = scene.consts.iter().find(|known| known.name == name);
        known.expect("a const").value.scalar().expect("one number")
    };
    let (crank, rocker) = (length("CRANK"), length("ROCKER"));
    let angles = |name: &str| {
        column(&outcome, name)
            .iter()
            .map(|angle| angle.to_radians())
    };
    for (turn, swing) in angles("crank_angle").zip(angles("rocker_angle")) {
        let across = length("GROUND") + rocker * swing.cos() - crank * turn.cos();
        let coupler = across.hypot(rocker * swing.sin() - crank * turn.sin());
        assert!((coupler - length("COUPLER")).abs() <= 1e-13, "{coupler}");
    }
    // Grashof: the crank passes both sides of its pin, the rocker swings on one.
    let signs = |name: &str| {
        let column = column(&outcome, name);
        let late = &column[column.len() / 2..];
        let sides = late.iter().map(|angle| angle.to_radians().sin());
        let mut sides = [sides.clone(), sides];
        (
            sides[0].any(|side| side > 0.0),
            sides[1].any(|side| side < 0.0),
        )
    };
    assert_eq!(signs("crank_angle"), (true, true));
    assert_eq!(signs("rocker_angle"), (false, true));
}

#[test]
fn two_windows_follow_the_reference_through_every_flat_position() {
    let outcome = flown("n_four_bar", 10.0);
    let history = &load("benchmark/iftomm_A02_n_four_bar_N2.json")["time_history"];
    let mut most: f64 = 0.0;
    for (name, reference) in [("tip.x", "xB0"), ("tip.y", "yB0")] {
        let found: Vec<f64> = column(&outcome, name).iter().step_by(10).copied().collect();
        let want = numbers(&history[reference]);
        most = most.max(tests::largest_difference(&found, &want));
        assert_close(&found, &want, 0.0, 1e-8, name);
    }
    println!("{most:e}");
    for window in 0..2 {
        let inclination = column(&outcome, &format!("inclination[{window}]"));
        assert!(
            inclination.iter().all(|angle| *angle < 1e-6),
            "left its branch"
        );
    }
}

#[test]
fn the_spatial_loop_follows_its_reference_history() {
    let outcome = flown("spatial_loop", 1.5);
    let history = &load("loops/loop_RUSP.json")["time_history"];
    let mut most: f64 = 0.0;
    for (body, name) in ["crank", "coupler", "slider"].into_iter().enumerate() {
        for (component, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let found = column(&outcome, &format!("{name}.{axis}"));
            let rows = history["r"].as_array().expect("positions");
            let want: Vec<f64> = rows
                .iter()
                .map(|row| numbers(&row[body])[component])
                .collect();
            most = most.max(tests::largest_difference(found, &want));
            assert_close(found, &want, 0.0, 1e-9, name);
        }
    }
    println!("{most:e}");
}

#[test]
fn nothing_takes_energy_from_the_double_pendulum() {
    let outcome = flown("double_pendulum", 6.0);
    let made = outcome.imbalance.map(|it| it.relative());
    assert!(made.is_some_and(|share| share <= 1e-9), "{made:?}");
}

#[test]
fn both_legs_of_the_rider_swing_alike() {
    let outcome = flown("porch_swing", 3.0);
    let gap = largest_gap(&outcome, "leg_angle[0]", "leg_angle[1]");
    let swing = column(&outcome, "leg_angle[0]")
        .iter()
        .fold(0.0f64, |most, a| most.max(a.abs()));
    println!("{gap:e} of {swing}");
    assert!(swing > 10.0 && gap <= 1e-6 * swing, "{gap}");
}
