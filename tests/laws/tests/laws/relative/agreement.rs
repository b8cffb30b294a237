//! The same mechanism in both families: places, accelerations, energy, reactions; loops, springs, loads among them.

use laws::assert_close;
use laws::looped::mechanism;
use laws::mechanism::{add_body, add_joint, all_joints, empty, inertia, layout, random_seat};
use laws::obeying::obeying;
use laws::random::Random;
use laws::relative::Both;
use mbd_scene::joints::JointLaw;
use mbd_scene::{AngularVelocity, Quantity};
use nalgebra::{DMatrix, DVector};

/// Mechanisms compared.
const MECHANISMS: u64 = 60;

/// A mechanism in both families, with random loads.
fn both(seed: u64) -> (Both, Vec<f64>) {
    let (scene, state) = mechanism(seed);
    let mut random = Random::new(seed);
    let inputs = (0..layout(&scene).ni)
        .map(|_| random.uniform(-2.0, 2.0))
        .collect();
    (Both::new(&scene, &state), inputs)
}

#[test]
fn bodies_are_and_accelerate_where_absolute_coordinates_have_them() {
    for seed in 0..MECHANISMS {
        let (both, inputs) = both(seed);
        let (places, rates) = both.bodies_moving(&inputs);
        let absolute = layout(&both.absolute);
        let want = both.want(Quantity::Derivative, &inputs);
        for (body, slots) in absolute.own_bodies() {
            let own = 13 * body;
            let name = |what: &str| format!("mechanism {seed}, body {body}: {what}");
            let sign = if (0..4)
                .map(|k| places[own + 3 + k] * both.from[slots.q + 3 + k])
                .sum::<f64>()
                < 0.0
            {
                -1.0
            } else {
                1.0
            };
            let attitude: Vec<f64> = places[own + 3..own + 7].iter().map(|x| sign * x).collect();
            assert_close(
                &places[own..own + 3],
                &both.from[slots.q..slots.q + 3],
                1e-11,
                1e-11,
                &name("position"),
            );
            assert_close(
                &attitude,
                &both.from[slots.q + 3..slots.q + 7],
                1e-11,
                1e-11,
                &name("attitude"),
            );
            let v = absolute.nq + slots.v;
            assert_close(
                &places[own + 7..own + 13],
                &both.from[v..v + 6],
                1e-10,
                1e-10,
                &name("velocity"),
            );
            assert_close(
                &rates[own..own + 3],
                &want[slots.q..slots.q + 3],
                1e-10,
                1e-10,
                &name("rate of position"),
            );
            assert_close(
                &rates[own + 7..own + 13],
                &want[v..v + 6],
                1e-9,
                1e-9,
                &name("acceleration"),
            );
        }
    }
}

/// A chain of many bodies on joints of all kinds, on the world or afloat.
fn long_chain(seed: u64) -> Both {
    let mut random = Random::new(seed + 400);
    let components = [AngularVelocity::Body, AngularVelocity::World][seed as usize % 2];
    let laws: Vec<JointLaw> = all_joints().into_iter().map(|(law, _)| law).collect();
    let mut scene = empty([0.4, -0.3, -9.81], components);
    for body in 0..16 {
        let (mass, inertia) = (random.uniform(0.5, 2.0), inertia(&mut random));
        let own = add_body(&mut scene, mass, &inertia);
        let near = random_seat(&mut scene, own.checked_sub(1), &mut random);
        let far = random_seat(&mut scene, Some(own), &mut random);
        let law = laws[random.below(laws.len())].clone();
        let afloat = body == 0 && seed >= 4;
        let attitude = law.attitude().unwrap_or_default();
        let measured =
            (0..law.coordinates()).all(|k| attitude.contains(&k) || law.coordinate(k).is_some());
        let carries = law.freedoms() < 6 && law.couples().is_empty() && measured;
        let law = match (afloat, carries && body % 5 != 3) {
            (true, _) => JointLaw::Free(Default::default()),
            (_, true) => law,
            (_, false) => JointLaw::Hinge(Default::default()),
        };
        add_joint(&mut scene, law, near, far);
    }
    let state = obeying(&scene, &mut random);
    // Some are walked from the child: a hinge forbids the same either way.
    for joint in scene.joints.iter_mut().skip(3).step_by(5) {
        std::mem::swap(&mut joint.parent, &mut joint.child);
    }
    Both::new(&scene, &state)
}

#[test]
fn long_chains_accelerate_by_articulated_bodies_as_in_absolute_coordinates() {
    let mut articulated = 0;
    for seed in 0..8 {
        let both = long_chain(seed);
        articulated += usize::from(both.layout.elimination.order.articulated);
        let (_, rates) = both.bodies_moving(&[]);
        let absolute = layout(&both.absolute);
        let want = both.want(Quantity::Derivative, &[]);
        for (body, slots) in absolute.own_bodies() {
            let v = absolute.nq + slots.v;
            assert_close(
                &rates[13 * body + 7..13 * body + 13],
                &want[v..v + 6],
                1e-8,
                1e-8,
                &format!("chain {seed}, body {body}"),
            );
        }
    }
    assert!(
        articulated >= 4,
        "{articulated} chains by articulated bodies"
    );
}

#[test]
fn energy_momentum_and_reactions_do_not_depend_on_coordinates() {
    for seed in 0..MECHANISMS {
        let (both, inputs) = both(seed);
        for what in [Quantity::Energy, Quantity::Momentum] {
            let name = format!("mechanism {seed}: {what:?}");
            assert_close(
                &both.get(what, &inputs, &[]),
                &both.want(what, &inputs),
                1e-10,
                1e-10,
                &name,
            );
        }
        let unique = layout(&both.absolute).redundancy.repeats.is_empty();
        if unique {
            let got = both.get(Quantity::Reactions, &inputs, &[]);
            let want = both.want(Quantity::Reactions, &inputs);
            assert_close(
                &got,
                &want,
                1e-8,
                1e-8,
                &format!("mechanism {seed}: reactions"),
            );
        }
    }
}

#[test]
fn the_mass_matrix_is_that_of_the_kinetic_energy_and_the_equations_of_motion_hold() {
    for seed in 0..MECHANISMS {
        let (both, inputs) = both(seed);
        let name = |what: &str| format!("mechanism {seed}: {what}");
        let layout = &both.layout;
        let (nq, nv, nc) = (layout.nq, layout.nv, layout.nc);
        let mass = DMatrix::from_row_slice(nv, nv, &both.get(Quantity::MassMatrix, &inputs, &[]));
        assert!(
            (&mass - mass.transpose()).amax() <= 1e-13 * mass.amax(),
            "{}",
            name("symmetric")
        );
        assert!(
            mass.clone().cholesky().is_some(),
            "{}",
            name("positive definite")
        );
        let speeds = DVector::from_column_slice(&both.state[nq..nq + nv]);
        let kinetic = 0.5 * speeds.dot(&(&mass * &speeds));
        assert_close(
            &[kinetic],
            &both.want(Quantity::Energy, &inputs)[..1],
            1e-11,
            1e-11,
            &name("kinetic energy"),
        );
        let rates = both.get(Quantity::Derivative, &inputs, &[]);
        let accelerations = DVector::from_column_slice(&rates[nq..nq + nv]);
        let h = DVector::from_vec(both.get(Quantity::BiasForce, &inputs, &[]));
        let f = DVector::from_vec(both.get(Quantity::Forces, &inputs, &[]));
        let multipliers = DVector::from_vec(both.get(Quantity::Multipliers, &inputs, &[]));
        let jacobian = DMatrix::from_row_slice(
            nc,
            nv,
            &both.get(Quantity::ConstraintJacobian, &inputs, &[]),
        );
        let left = &mass * &accelerations + &h - &f - jacobian.transpose() * &multipliers;
        let size = f.amax().max(h.amax()).max(1.0);
        assert!(
            left.amax() < 1e-9 * size,
            "{} {left}",
            name("M v̇ + h = f + Φᵀλ")
        );
        let gamma = DVector::from_vec(both.get(Quantity::ConstraintBias, &inputs, &[]));
        let rows = &jacobian * &accelerations - &gamma;
        assert!(
            nc == 0 || rows.amax() < 1e-8 * gamma.amax().max(1.0),
            "{} {rows}",
            name("Φ_v v̇ = γ")
        );
        let rate = both.get(Quantity::ConstraintRate, &inputs, &[]);
        let own = &jacobian * &speeds;
        assert_close(
            &rate,
            own.as_slice(),
            0.0,
            1e-10 * speeds.amax().max(1.0),
            &name("Φ̇"),
        );
    }
}

#[test]
fn the_residual_vanishes_at_the_solution_and_the_factor_solves_its_system() {
    for seed in 0..MECHANISMS {
        let (both, inputs) = both(seed);
        let layout = &both.layout;
        let (nq, nv, nc) = (layout.nq, layout.nv, layout.nc);
        let mut random = Random::new(seed + 31);
        let rates = both.get(Quantity::Derivative, &inputs, &[]);
        // Multipliers in the order of the rows that are kept.
        if layout.redundancy.repeats.is_empty() {
            let multipliers = both.get(Quantity::Multipliers, &inputs, &[]);
            let motion = [&rates[nq..nq + nv], &multipliers].concat();
            let left = both.get(Quantity::Residual, &inputs, &motion);
            let size = both
                .get(Quantity::BiasForce, &inputs, &[])
                .iter()
                .fold(10.0_f64, |m, x| m.max(x.abs()));
            let most = left[nq..nq + nv]
                .iter()
                .chain(&left[layout.nx()..])
                .fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(most < 1e-9 * size, "mechanism {seed}: {most:e} of {size:e}");
        }
        let factor = both.get(Quantity::Factor, &inputs, &[]);
        let right: Vec<f64> = (0..nv + nc).map(|_| random.uniform(-1.0, 1.0)).collect();
        let list = [&factor[..], &right].concat();
        let solved = both.get(Quantity::Solve, &inputs, &list);
        let mass = DMatrix::from_row_slice(nv, nv, &both.get(Quantity::MassMatrix, &inputs, &[]));
        if layout.redundancy.repeats.is_empty() {
            let jacobian = DMatrix::from_row_slice(
                nc,
                nv,
                &both.get(Quantity::ConstraintJacobian, &inputs, &[]),
            );
            let x = DVector::from_column_slice(&solved[..nv]);
            let y = DVector::from_column_slice(&solved[nv..]);
            let left =
                &mass * &x - jacobian.transpose() * &y - DVector::from_column_slice(&right[..nv]);
            assert!(
                left.amax() < 1e-9 * (1.0 + y.amax() * jacobian.amax().max(0.0)),
                "mechanism {seed}: {left}"
            );
            let rows = &jacobian * &x - DVector::from_column_slice(&right[nv..]);
            assert!(nc == 0 || rows.amax() < 1e-9, "mechanism {seed}: {rows}");
        }
    }
}
