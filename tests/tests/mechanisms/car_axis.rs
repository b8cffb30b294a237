//! The car axis of the Test Set for IVP Solvers: points with mass, springs, a rod and a ground that moves, declared and run to the published
//! end values. Index 3 as it is usually written; here its rows are joined as second-order equations and projected.

use mbd_runtime::{Options, Simulation, model};
use mbd_scene::{AngularVelocity, Model, Quantity};
use serde_json::Value;
use tests::agreement::agrees;
use tests::reference::{field, load, numbers};
use tests::{assert_close, largest_difference};

model! {
    /// Two wheels on springs, joined by an axle; the right spring stands on a bumpy road. The left wheel stays above the left end of the
    /// chassis: in the plane through the origin normal to the line to the road.
    pub model CarAxis<T> {
        gravity: [0.0, -1.0, 0.0] m/s^2;
        const L = 1.0 m;
        const L0 = 0.5 m;
        const R = 0.1 m;
        const OMEGA = 10.0 rad/s;
        const K = 5e-4 kg;
        world {
            frame road at [sqrt(L^2 - (R * sin(OMEGA * time))^2), R * sin(OMEGA * time), 0.0],
            frame chassis at [0.0, 0.0, 0.0] m
                rotated matrix(
                    [sqrt(L^2 - (R * sin(OMEGA * time))^2) / L, -R * sin(OMEGA * time) / L, 0.0],
                    [R * sin(OMEGA * time) / L, sqrt(L^2 - (R * sin(OMEGA * time))^2) / L, 0.0],
                    [0.0, 0.0, 1.0]
                ),
        }
        point left { mass: K }
        point right { mass: K }
        spring left_leg from world to left { free_length: L0, stiffness: 1.0 N/m }
        spring right_leg from world.road to right { free_length: L0, stiffness: 1.0 N/m }
        joint upright: point_on_plane from world.chassis to left { axis: x }
        joint axle: distance from left to right { length: L }
    }
}

/// Positions or velocities of the two wheels in the plane.
fn planar(list: &[f64]) -> [f64; 4] {
    [list[0], list[1], list[3], list[4]]
}

fn start(file: &Value) -> Vec<f64> {
    let y = numbers(&file["initial"]["y0"]);
    vec![
        y[0], y[1], 0.0, y[2], y[3], 0.0, y[4], y[5], 0.0, y[6], y[7], 0.0,
    ]
}

/// The multipliers of the file's rows from ours: a·d with a = b/L, and (d·d − L²)/(2 L) for d·d − L²; L = 1 m.
fn of_the_file(multipliers: &[f64]) -> [f64; 2] {
    [multipliers[0], multipliers[1] / 2.0]
}

#[test]
fn the_car_axis_ends_where_the_test_set_says() {
    let file = load("ivp/ivp_car_axis.json");
    let model = CarAxis::<f64>::new(Default::default()).expect("no params");
    assert_eq!((model.layout().nv, model.layout().nc), (6, 2));
    for options in [
        Options::tsit5(1e-13),
        Options::vern7(1e-13),
        Options::rodas5p(1e-11),
    ] {
        ends_as_published(&file, &model, options);
    }
}

fn ends_as_published(file: &Value, model: &CarAxis<f64>, options: Options) {
    let mut run = Simulation::new(model, options).expect("options");
    run.set_state(0.0, &start(file)).expect("a state");
    run.run(3.0).expect("a run to the end");
    let got = run.state().to_vec();
    let mut multipliers = [0.0; 2];
    run.evaluate(Quantity::Multipliers, &mut multipliers)
        .expect("rows that can be solved");
    for source in ["source_a", "source_b"] {
        let want = numbers(&file["published_end"][source]);
        let position = largest_difference(&planar(&got), &want[..4]);
        let velocity = largest_difference(&planar(&got[6..]), &want[4..8]);
        let force = largest_difference(&of_the_file(&multipliers), &want[8..]);
        println!(
            "{:?} {source}: positions {position:e} m, velocities {velocity:e} m/s, multipliers {force:e}",
            options.method
        );
        assert!(position < 1e-9, "{source}: {position:e}");
        assert!(velocity < 1e-9, "{source}: {velocity:e}");
        assert!(force < 1e-9, "{source}: {force:e}");
    }
    for at in [2, 5, 8, 11] {
        assert_eq!(got[at], 0.0, "nothing pushes out of the plane");
    }
}

#[test]
fn the_car_axis_follows_its_reference_history_and_multipliers() {
    let file = load("ivp/ivp_car_axis.json");
    let history = &file["time_history"];
    let model = CarAxis::<f64>::new(Default::default()).expect("no params");
    for options in [
        Options::tsit5(1e-12),
        Options::vern7(1e-12),
        Options::rodas5p(1e-10),
        Options::rk4(2.5e-4),
    ] {
        let mut run = Simulation::new(&model, options).expect("options");
        run.set_state(0.0, &start(&file)).expect("a state");
        for (k, time) in field(history, "t").into_iter().enumerate() {
            run.run(time).expect("a run to the next instant");
            let (q, v) = (numbers(&history["q"][k]), numbers(&history["qdot"][k]));
            assert_close(&planar(run.state()), &q, 0.0, 2e-9, "positions");
            assert_close(&planar(&run.state()[6..]), &v, 0.0, 4e-8, "velocities");
            let mut multipliers = [0.0; 2];
            run.evaluate(Quantity::Multipliers, &mut multipliers)
                .expect("rows that can be solved");
            let want = numbers(&history["lam"][k]);
            assert_close(&of_the_file(&multipliers), &want, 0.0, 1e-9, "multipliers");
            let mut rows = [0.0; 2];
            run.evaluate(Quantity::ConstraintRate, &mut rows)
                .expect("rows");
            assert_close(&rows, &[0.0; 2], 0.0, 1e-14, "Φ̇ after projection");
        }
    }
}

#[test]
fn a_wrong_start_is_put_on_the_moving_ground_at_its_time() {
    let model = CarAxis::<f64>::new(Default::default()).expect("no params");
    let time = 1.234;
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    run.set_state(
        time,
        &[0.05, 0.5, 0.0, 1.04, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    )
    .expect("a state");
    run.start().expect("a consistent start");
    let x = run.state().to_vec();
    let (y, rate) = (0.1 * f64::sin(10.0 * time), f64::cos(10.0 * time));
    let (b, b_rate) = ((1.0 - y * y).sqrt(), -y * rate / (1.0 - y * y).sqrt());
    let row = b * x[0] + y * x[1];
    let row_rate = b * x[6] + y * x[7] + b_rate * x[0] + rate * x[1];
    assert!(
        row.abs() < 1e-14 && row_rate.abs() < 1e-14,
        "{row:e} {row_rate:e}"
    );
    assert!(
        x[6].abs() > 0.1,
        "the ground gives the wheel a speed: {}",
        x[6]
    );
}

#[test]
fn the_car_axis_agrees_in_every_execution() {
    let model = CarAxis::<f64>::new(Default::default()).expect("no params");
    assert_eq!(model.scene().angular_velocity, AngularVelocity::Body);
    agrees(&model);
}

#[test]
fn the_car_axis_runs_in_single_precision() {
    let file = load("ivp/ivp_car_axis.json");
    let single = CarAxis::<f32>::new(Default::default()).expect("no params");
    let mut run = Simulation::new(&single, Options::rk4(1e-3)).expect("options");
    let x: Vec<f32> = start(&file).iter().map(|x| *x as f32).collect();
    run.set_state(0.0, &x).expect("a state");
    run.run(0.5).expect("half a second");
    let got: Vec<f64> = run.state().iter().map(|x| f64::from(*x)).collect();
    let want = numbers(&file["time_history"]["q"][10]);
    assert_close(&planar(&got), &want, 0.0, 2e-4, "positions");
}
