//! Singular positions on the way: linkages whose rows lose rank for an instant go through on their branch.

use mbd_runtime::{Generic, Options, Simulation, Statistics};
use mbd_scene::joints::{Distance, JointLaw};
use mbd_scene::{AngularVelocity, Model, Place, Plane, Quantity, Scene};
use nalgebra::Vector3;
use serde_json::Value;
use tests::linkage::{Linkage, cranks};
use tests::mechanism::{Instance, add_joint, add_point, at, empty, evaluate, state};
use tests::reference::{field, load};

fn energy(scene: &Scene, x: &[f64]) -> f64 {
    let parts = evaluate(scene, Quantity::Energy, x, &[], &[]);
    parts[0] + parts[1]
}

/// Runs to a time and calls `look` with time and state after every step.
fn watch(
    linkage: &Linkage,
    options: Options,
    until: f64,
    mut look: impl FnMut(f64, &[f64]),
) -> Statistics {
    let model = Generic::<f64>::with_defaults(linkage.scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, options).expect("options that fit");
    run.set_state(0.0, &linkage.state()).expect("a valid state");
    run.start().unwrap_or_else(|error| panic!("{error}"));
    while run.time() < until {
        run.step().unwrap_or_else(|error| panic!("{error}"));
        look(run.time(), run.state());
    }
    run.statistics()
}

#[test]
fn a_parallelogram_turns_evenly_through_both_flat_positions_with_and_without_a_third_crank() {
    // From near a flat position, and from the flat position itself.
    for (count, bar) in [(2, &[2, 3][..]), (3, &[3, 4, 5][..])] {
        for start in [0.7, 0.0] {
            let linkage = cranks(count, &[bar], start, 1.0, 0.0);
            let first = energy(&linkage.scene, &linkage.state());
            let (mut angle, mut most, mut tilt) = (0.0f64, 0.0f64, 0.0f64);
            let statistics = watch(&linkage, Options::rk4(2e-3), 7.0, |time, x| {
                let crank = 2.0 * x[6].atan2(x[3]);
                let off = (crank - time).rem_euclid(std::f64::consts::TAU);
                angle = angle.max(off.min(std::f64::consts::TAU - off));
                most = most.max((energy(&linkage.scene, x) - first).abs() / first);
                tilt = tilt.max(x[7 * count + 6].abs());
            });
            println!(
                "{count} cranks from {start}: angle {angle:e}, energy {most:e}, tilt {tilt:e}, strategy {}, chosen {}",
                statistics.rows_strategy, statistics.rows_chosen
            );
            // On the other branch the bar turns with the cranks.
            assert!(most < 1e-12 && angle < 1e-11 && tilt < 1e-9);
        }
    }
}

/// N four-bars side by side, in space or in their plane, against their elliptic functions.
fn four_bars(
    n: usize,
    plane: Option<Plane>,
    file: &Value,
    options: Options,
    until: f64,
) -> [f64; 2] {
    let joined: Vec<[usize; 2]> = (0..n).map(|k| [n + 1 + k, n + 2 + k]).collect();
    let bars: Vec<&[usize]> = joined.iter().map(|bar| bar.as_slice()).collect();
    let phi = std::f64::consts::FRAC_PI_2;
    let mut linkage = cranks(n + 1, &bars, phi, -1.0, 9.81);
    linkage.scene.planar = plane;
    let (times, x, y) = (
        field(&file["time_history"], "t"),
        field(&file["time_history"], "xB0"),
        field(&file["time_history"], "yB0"),
    );
    let model = Generic::<f64>::with_defaults(linkage.scene.clone()).expect("a valid scene");
    // To lay out eighty bodies takes as long as a second of their motion.
    let layout = model.layout();
    assert_eq!((layout.freedoms(), layout.redundancy.closed), (1, true));
    let energy = |x: &[f64]| {
        let mut parts = vec![0.0; layout.len(Quantity::Energy)];
        model.evaluate(
            Quantity::Energy,
            &at(x, &[], &[]),
            &mut model.work(),
            &mut parts,
        );
        parts[0] + parts[1]
    };
    let first = energy(&linkage.state());
    let mut run = Simulation::new(&model, options).expect("options that fit");
    run.set_state(0.0, &linkage.state()).expect("a valid state");
    let (mut place, mut most) = (0.0f64, 0.0f64);
    for (k, &time) in times.iter().enumerate().filter(|(_, t)| **t <= until) {
        run.run(time).unwrap_or_else(|error| panic!("{error}"));
        let now = run.state();
        // The tip of the first crank is as far from its centre as its root.
        let off = [2.0 * now[0] - x[k], 2.0 * now[1] - y[k]];
        place = place.max(off[0].abs()).max(off[1].abs());
        most = most.max((energy(now) - first).abs());
    }
    let statistics = run.statistics();
    println!(
        "{n} four-bars, {plane:?}, to {until} s: place {place:e} m, energy {most:e} J, {} steps, strategy {}, chosen {}",
        statistics.steps, statistics.rows_strategy, statistics.rows_chosen
    );
    [place, most]
}

#[test]
fn two_four_bars_pass_their_singular_position_ten_times_on_their_elliptic_functions() {
    let file = load("benchmark/iftomm_A02_n_four_bar_N2.json");
    for plane in [None, Some(Plane::Xy)] {
        let coarse = four_bars(2, plane, &file, Options::rk4(2e-3), 10.0);
        let fine = four_bars(2, plane, &file, Options::rk4(5e-4), 10.0);
        // Published for high precision: 1e-3 J.
        assert!(coarse[1] < 1e-3, "{coarse:?}");
        assert!(fine[0] < 1e-6 && fine[1] < 1e-6, "{fine:?}");
    }
}

fn assert_forty_four_bars_pass(plane: Option<Plane>) {
    let file = load("benchmark/iftomm_A02_n_four_bar_N40.json");
    let [place, energy] = four_bars(40, plane, &file, Options::rk4(5e-3), 10.0);
    // Published for high precision: 1e-3 m of the first tip; 1e-3 J of 620 J as for two.
    assert!(energy < 1e-3 && place < 1e-5, "{place:e} {energy:e}");
}

#[test]
fn forty_four_bars_pass_their_singular_position_ten_times_on_their_elliptic_functions() {
    assert_forty_four_bars_pass(None);
}

#[test]
fn forty_four_bars_in_a_plane_pass_their_singular_position_ten_times_too() {
    assert_forty_four_bars_pass(Some(Plane::Xy));
}

#[test]
fn a_point_on_a_massless_rod_follows_its_elliptic_functions() {
    for plane in [None, Some(Plane::Xy)] {
        let most = rod_pendulum(plane);
        println!("simple pendulum, {plane:?}: {most:e} m");
        assert!(most < 1e-9, "{most:e}");
    }
}

/// The largest error of a point on a massless rod, in space or in its plane [m].
fn rod_pendulum(plane: Option<Plane>) -> f64 {
    let file = load("benchmark/iftomm_A01_simple_pendulum.json");
    let mut scene = empty([0.0, -9.81, 0.0], AngularVelocity::Body);
    scene.planar = plane;
    let bob = add_point(&mut scene, 1.0);
    let rod = JointLaw::Distance(Distance { length: 1.0.into() });
    add_joint(&mut scene, rod, Place::World(0), bob);
    let start = Instance {
        position: Vector3::x(),
        ..Instance::rest()
    };
    let model = Generic::<f64>::with_defaults(scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::tsit5(1e-12)).expect("options that fit");
    run.set_state(0.0, &state(&scene, &[], &[start]))
        .expect("a valid state");
    let history = &file["time_history"];
    let (x, y) = (field(history, "x"), field(history, "y"));
    let mut most = 0.0f64;
    for (k, time) in field(history, "t").into_iter().enumerate() {
        run.run(time).expect("a run to the end");
        let at = run.state();
        most = most.max((at[0] - x[k]).abs()).max((at[1] - y[k]).abs());
    }
    most
}
