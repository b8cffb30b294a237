//! What a compiled scene with joints offers by name: sizes, sparsity, typed rows and reactions.

use mbd_runtime::model;
use mbd_scene::{At, Model, Quantity};
use tests::assert_close;

model! {
    /// A pendulum on a hinge and a ball on its tip.
    model Pendulum {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body arm {
            mass: 2.0 kg,
            inertia: diag(0.17, 0.17, 0.002) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame tip at [0.0, 0.0, -0.5] m,
        }
        body ball {
            mass: 1.0 kg,
            inertia: diag(0.01, 0.01, 0.01) kg*m^2,
            frame eye at [0.0, 0.0, 0.1] m,
        }
        joint pivot: hinge from world to arm.top { axis: y }
        joint hook: spherical from arm.tip to ball.eye;
    }
}

/// Hanging at rest.
fn hanging() -> PendulumState {
    let mut state = PendulumState::at_origin();
    state.q[2] = -0.5;
    state.q[9] = -1.1;
    state
}

#[test]
fn sizes_count_the_rows() {
    assert_eq!(
        [
            Pendulum::NQ,
            Pendulum::NV,
            Pendulum::NC,
            Pendulum::MASS_MATRIX_SPARSITY.len(),
        ],
        [14, 12, 8, 12]
    );
}

#[test]
fn a_joint_at_rest_carries_what_hangs_on_it() {
    let pendulum = Pendulum::new(PendulumParams::default()).expect("params in range");
    let [pivot, hook] = pendulum.reactions(&hanging());
    for (name, reaction, mass) in [("pivot", pivot, 3.0), ("hook", hook, 1.0)] {
        let upwards = [0.0, 0.0, mass * 9.81];
        assert_close(&reaction.force, &upwards, 1e-14, 1e-13, name);
        assert_close(&reaction.torque, &[0.0; 3], 0.0, 1e-13, name);
    }
}

/// The matrix by name, the flat list of the trait and the constant of its structure are one thing.
#[test]
fn the_sparsity_of_the_jacobian_is_where_it_is_written() {
    let pendulum = Pendulum::new(PendulumParams::default()).expect("params in range");
    let mut state = hanging();
    // A state in general position: quaternions that are no half turn, everything moves.
    for (index, x) in state.q.iter_mut().enumerate() {
        *x += 0.1 * (index as f64 + 1.0).sin();
    }
    let jacobian = pendulum.constraint_jacobian(&state);
    let flat_state = state.to_vec();
    let at = At::of_state(0.0, &flat_state, &[]);
    let written = f64::MAX;
    let mut flat = vec![written; Pendulum::NC * Pendulum::NV];
    pendulum.evaluate(
        Quantity::ConstraintJacobian,
        &at,
        &mut pendulum.work(),
        &mut flat,
    );
    for row in 0..Pendulum::NC {
        for column in 0..Pendulum::NV {
            let value = flat[row * Pendulum::NV + column];
            let structural = Pendulum::CONSTRAINT_JACOBIAN_SPARSITY.contains(&(row, column));
            assert_eq!(value != written, structural, "({row}, {column})");
            let expected = if structural { value } else { 0.0 };
            assert_eq!(jacobian[(row, column)], expected, "({row}, {column})");
        }
    }
    assert!(Pendulum::CONSTRAINT_JACOBIAN_SPARSITY.is_sorted());
}
