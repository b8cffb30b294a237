//! What can be asked of a scene: energies, orientations, angles of a plane; names that Rust keeps for itself.

use mbd_runtime::{Generic, Options, Quantity, Simulation, linearise, model};
use mbd_scene::{Model, Scene};
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use tests::agreement::{agrees, agrees_along};
use tests::declared::read;

model! {
    /// Names that Rust keeps for itself, a body that is free of another, energies and orientations.
    pub model Kept<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        verify;
        input move: angle = 0.1 rad;
        param gen = 2 kg in 1 kg ..= 3 kg;
        state yield = 0 m { rate: 1 m/s * move }
        world { frame ref at [0.0, 0.0, 2.0] m }
        body box { mass: gen, inertia: diag(0.9, 0.8, 0.7) kg*m^2, frame type at [0.0, 0.0, 1.0] m }
        body dyn { mass: 10 kg, inertia: diag(1, 2, 1.5) kg*m^2 }
        point do { mass: 1 kg, start at [2, 0, 0] m }
        joint match: hinge from world to box.type {
            axis: y,
            motor: move,
            filter: 20 ms,
            start: 0.3 rad,
            start_rate: 2 rad/s,
        }
        joint loose: free from box.type to dyn.com;
        spring try from world.ref to dyn.com {
            free_length: 1.5 m,
            stiffness: 40 N/m,
            damping: 1 N*s/m,
        }
        load break on do = [0, 0, 1 N];
        output turned = dyn.orientation;
        output for = box.orientation.y;
        output energy = energy.total;
        output parts = [energy.kinetic, energy.potential, 0 N*m];
        event while = energy.kinetic rises 1 kJ;
    }
}

#[test]
fn names_of_rust_end_in_an_underscore_there() {
    let model = Kept::<f64>::new(KeptParams { gen_: 1.5 }).expect("a param in its range");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    run.set_inputs(&KeptInputs { move_: 0.2 })
        .expect("a number");
    run.run(0.5).expect("a smooth motion");
    let state = KeptState::from_slice(run.state()).expect("a state");
    assert!((state.yield_() - 0.1).abs() < 1e-12);
    assert!((state.do_().position[0] - 2.0).abs() < 1e-12);
    let _ = (state.box_(), state.dyn_());
}

#[test]
fn energies_and_orientations_are_the_same_in_every_execution() {
    let model = Kept::<f64>::new(KeptParams::default()).expect("defaults");
    agrees(&model);
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    run.start().expect("a start");
    agrees_along(&model, run.state(), (20, 1e-3), 1e-12);
}

#[test]
fn the_energy_of_an_output_is_that_of_the_balance() {
    let model = Kept::<f64>::new(KeptParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    run.run(0.3).expect("a smooth motion");
    let (mut outputs, mut energy) = ([0.0; 8], [0.0; 6]);
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("no node");
    run.evaluate(Quantity::Energy, &mut energy)
        .expect("no node");
    let [kinetic, gravity, elastic, ..] = energy;
    assert!(kinetic > 1.0 && elastic > 0.1, "{energy:?}");
    assert_eq!(outputs[5..7], [kinetic, gravity + elastic]);
    assert_eq!(outputs[4], kinetic + (gravity + elastic));
}

#[test]
fn a_filtered_motor_starts_where_its_start_says() {
    let model = Kept::<f64>::new(KeptParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options");
    run.start().expect("a start");
    let mut outputs = [0.0; 8];
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("no node");
    assert!((outputs[3] - 0.3).abs() < 1e-12, "{outputs:?}");
    run.run(0.01).expect("a smooth motion");
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("no node");
    // x − c = (x₀ − c + (ẋ₀ + (x₀ − c)/τ) t) exp(−t/τ) with c = 0.1, τ = 20 ms.
    let want = 0.1 + (0.2 + (2.0 + 0.2 / 0.02) * 0.01) * (-0.5_f64).exp();
    assert!((outputs[3] - want).abs() < 1e-9, "{} {want}", outputs[3]);
}

/// A tumbling body with its orientation as an output.
fn tumbling() -> Scene {
    read(
        "model Tumbling {
            gravity: none;
            body block { mass: 1 kg, inertia: diag(1, 2, 3) kg*m^2 }
            joint loose: free from world to block.com;
            output turn = block.orientation;
        }",
    )
}

fn orientation(model: &dyn Model<f64>, q: Quaternion<f64>) -> Vector3<f64> {
    let mut run = Simulation::<f64>::new(model, Options::rk4(0.01)).expect("options");
    let mut state = vec![0.0; 13];
    state[3..7].copy_from_slice(&[q.w, q.i, q.j, q.k]);
    run.set_state(0.0, &state).expect("a state");
    let mut out = [0.0; 3];
    run.evaluate(Quantity::Outputs, &mut out).expect("no node");
    out.into()
}

#[test]
fn an_orientation_is_the_axis_times_the_angle_up_to_half_a_turn_and_near_none() {
    let model = Generic::<f64>::with_defaults(tumbling()).expect("no params");
    let axis = Vector3::new(0.6, -0.48, 0.64);
    for angle in [0.0, 1e-9, 1e-4, 1.9e-3, 2.1e-3, 0.5, 3.0, 3.13, 4.0, 6.2] {
        let q = UnitQuaternion::from_scaled_axis(axis * angle).into_inner();
        let turned = match angle {
            0.0..3.2 => angle,
            _ => angle - std::f64::consts::TAU,
        };
        for q in [q, -q] {
            let found = orientation(&model, q);
            assert!(
                (found - axis * turned).norm() < 1e-14 + 1e-14 * angle,
                "{angle}: {found}"
            );
            let back = Rotation3::from_scaled_axis(found);
            let same = UnitQuaternion::from_quaternion(q).to_rotation_matrix();
            assert!((back.matrix() - same.matrix()).norm() < 1e-13);
        }
    }
}

#[test]
fn the_slope_of_an_orientation_is_the_turn_itself_where_nothing_is_turned() {
    let model = Generic::<f64>::with_defaults(tumbling()).expect("no params");
    let mut state = vec![0.0; 13];
    state[3] = 1.0;
    let space = linearise(&model, 0.0, &state, &[]).expect("a linear system");
    let turns: Vec<usize> = (0..space.states.len())
        .filter(|&i| space.states[i].name.contains("turn_"))
        .collect();
    for row in 0..3 {
        for (axis, &column) in turns.iter().enumerate() {
            let want = if row == axis { 1.0 } else { 0.0 };
            assert!((space.c[(row, column)] - want).abs() < 1e-12, "{}", space.c);
        }
    }
}

#[test]
fn an_angle_in_a_plane_counts_turns() {
    let scene = read(
        "model Wheel {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            planar: xz;
            body wheel { mass: 2 tonne, inertia: diag(1, 1, 1) kg*m^2, start at [0, 0, 0] m angular_velocity [0, 3, 0] rad/s }
            joint loose: free from world to wheel.com;
            output turned_by = wheel.angle;
            output turn = wheel.orientation;
            event turned = wheel.angle rises 7 rad;
        }",
    );
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::<f64>::new(&model, Options::rk4(0.01)).expect("options");
    run.run(4.0).expect("free fall");
    let mut out = [0.0; 4];
    run.evaluate(Quantity::Outputs, &mut out).expect("no node");
    for (found, want) in out.into_iter().zip([12.0, 0.0, 12.0, 0.0]) {
        assert!((found - want).abs() < 1e-12, "{out:?}");
    }
    let turned = run.events().first().expect("an event").time;
    assert!((turned - 7.0 / 3.0).abs() < 1e-9, "{turned}");
}

#[test]
fn the_energy_of_a_pendulum_in_a_plane_stays() {
    let scene = read(
        "model Swing {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            planar: xz;
            body bar { mass: 2 kg, inertia: diag(1, 0.2, 1) kg*m^2, frame top at [0, 0, 0.5] m }
            joint pin: hinge from world to bar.top { axis: y, start: 60 deg, stiffness: 3 N*m/rad }
            output energy = energy.total;
        }",
    );
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::<f64>::new(&model, Options::tsit5(1e-10)).expect("options");
    let mut total = [0.0];
    run.start().expect("a start");
    run.evaluate(Quantity::Outputs, &mut total)
        .expect("no node");
    let turn = std::f64::consts::FRAC_PI_3;
    let want = -2.0 * 9.81 * 0.5 * 0.5 + 1.5 * turn * turn;
    assert!((total[0] - want).abs() < 1e-12, "{total:?} {want}");
    run.run(3.0).expect("a swing");
    run.evaluate(Quantity::Outputs, &mut total)
        .expect("no node");
    assert!((total[0] - want).abs() < 1e-7, "{total:?} {want}");
}

#[test]
fn misspelt_coordinates_are_answered_with_the_nearest() {
    let model = Kept::<f64>::new(KeptParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    let refused = run.set_joints(&[("match.angel", 0.1)]).expect_err("a slip");
    assert!(
        refused.to_string().contains("did you mean `match.angle`?"),
        "{refused}"
    );
    let trim = mbd_runtime::trim(&model).free_input("mov").solve();
    let Err(refused) = trim else {
        panic!("a slip");
    };
    let refused = refused.to_string();
    assert!(refused.contains("did you mean `move`?"), "{refused}");
}
