//! Speeds that motors and couplings of the tree fix: they leave the system, and nothing else is different.

use mbd_scene::joints::{Axis, Distance, Hinge, JointForces, JointLaw};
use mbd_scene::{AngularVelocity, Coordinates, Formula, Function, Quantity, Scene};
use nalgebra::{DMatrix, DVector};
use tests::assert_close;
use tests::declared::read;
use tests::mechanism::{
    add_external_loads, add_gear, add_joint, all_joints, empty, evaluate, hang, hinged_anyhow,
    layout, random_seat,
};
use tests::random::Random;

use super::counts::operations;

/// A tree of random joints, some of their coordinates driven, others coupled by trains of gears, and sometimes a rod across it.
fn net(seed: u64) -> Scene {
    let mut random = Random::new(seed + 90);
    let components = [AngularVelocity::Body, AngularVelocity::World][seed as usize % 2];
    let laws: Vec<JointLaw> = all_joints().into_iter().map(|(law, _)| law).collect();
    let mut scene = empty([0.4, -0.3, -9.81], components);
    let count = 3 + random.below(4);
    for joint in 0..count {
        let (law, [a, b]) = hang(&mut scene, &laws, &mut random);
        let carries = law.freedoms() > 0 && law.freedoms() < 6 && law.attitude().is_none();
        let carries = carries && (0..law.coordinates()).all(|k| law.coordinate(k).is_some());
        let law = match carries {
            true => law,
            false => JointLaw::Hinge(Hinge { axis: Axis::X }),
        };
        add_joint(&mut scene, law.clone(), a, b);
        for coordinate in 0..law.coordinates() {
            if random.below(3) == 0 {
                let wave = Formula::Apply(Function::Cos, vec![Formula::Time]);
                scene.joints[joint].forces.push(JointForces {
                    coordinate,
                    motor: Some(wave),
                    ..JointForces::default()
                });
            }
        }
    }
    let joints = scene.joints.iter().enumerate();
    let coordinates: Vec<(usize, usize)> = joints
        .flat_map(|(joint, own)| (0..own.law.coordinates()).map(move |k| (joint, k)))
        .collect();
    for pair in coordinates.windows(2) {
        if random.below(3) == 0 {
            let couples = match random.below(2) {
                0 => [pair[0], pair[1]],
                _ => [pair[1], pair[0]],
            };
            add_gear(&mut scene, couples, random.uniform(0.4, 2.0).into(), 0.3);
        }
    }
    if random.below(2) == 0 {
        let rod = JointLaw::Distance(Distance { length: 0.9.into() });
        let a = random_seat(&mut scene, Some(count - 1), &mut random);
        let b = random_seat(&mut scene, None, &mut random);
        add_joint(&mut scene, rod, a, b);
    }
    add_external_loads(&mut scene);
    scene.in_coordinates(Coordinates::Relative)
}

#[test]
fn equations_of_motion_hold_with_driven_and_coupled_speeds() {
    let [mut driven, mut coupled, mut looped, mut compared] = [0; 4];
    for seed in 0..300 {
        let scene = net(seed);
        let layout = layout(&scene);
        let mut random = Random::new(seed);
        let (nq, nv, nc) = (layout.nq, layout.nv, layout.nc);
        let x: Vec<f64> = (0..layout.nx())
            .map(|_| random.uniform(-1.5, 1.5))
            .collect();
        let inputs: Vec<f64> = (0..layout.ni).map(|_| random.uniform(-3.0, 3.0)).collect();
        let ask = |what, rows: &[f64]| evaluate(&scene, what, &x, &inputs, rows);
        let phi = DMatrix::from_row_slice(nc, nv, &ask(Quantity::ConstraintJacobian, &[]));
        if nc == 0 || nc > nv {
            continue;
        }
        let singular = phi.singular_values();
        // Motors and gears that say the same twice.
        if singular.min() < 1e-3 * singular.max() {
            continue;
        }
        compared += 1;
        let dependents = &layout.elimination.dependents;
        let gears = dependents.iter().filter(|own| !own.sources.is_empty());
        coupled += gears.count();
        driven += dependents
            .iter()
            .filter(|own| own.sources.is_empty())
            .count();
        looped += nc - dependents.len();
        let name = |what: &str| format!("net {seed}: {what}");
        let list = |what| DVector::from_vec(ask(what, &[]));
        let mass = DMatrix::from_row_slice(nv, nv, &ask(Quantity::MassMatrix, &[]));
        let rates = ask(Quantity::Derivative, &[]);
        let v = DVector::from_column_slice(&rates[nq..nq + nv]);
        let multipliers = list(Quantity::Multipliers);
        let forces = list(Quantity::Forces) - list(Quantity::BiasForce);
        let balance = &mass * &v - &forces - phi.transpose() * &multipliers;
        let scale = forces.amax().max((phi.transpose() * &multipliers).amax());
        assert!(
            balance.amax() < 1e-10 * scale,
            "{} {balance}",
            name("balance")
        );
        let gamma = list(Quantity::ConstraintBias);
        let rows = &phi * &v - &gamma;
        assert!(
            rows.amax() < 1e-10 * v.amax().max(gamma.amax()),
            "{} {rows}",
            name("rows")
        );

        let right: Vec<f64> = (0..nv + nc).map(|_| random.uniform(-1.0, 1.0)).collect();
        let given = [&ask(Quantity::Factor, &[])[..], &right].concat();
        let solved = ask(Quantity::Solve, &given);
        let (a, y) = solved.split_at(nv);
        let (a, y) = (DVector::from_column_slice(a), DVector::from_column_slice(y));
        let pushed = phi.transpose() * &y;
        let balance = &mass * &a - &pushed - DVector::from_column_slice(&right[..nv]);
        assert!(
            balance.amax() < 1e-10 * pushed.amax().max(1.0),
            "{}",
            name("solution")
        );
        let rows = &phi * &a - DVector::from_column_slice(&right[nv..]);
        assert!(
            rows.amax() < 1e-10 * a.amax().max(1.0),
            "{}",
            name("its rows")
        );

        let step = ask(Quantity::ProjectionStep, &right[nv..]);
        let step = DVector::from_column_slice(&step[..nv]);
        let rows = &phi * &step + DVector::from_column_slice(&right[nv..]);
        assert!(
            rows.amax() < 1e-10 * step.amax().max(1.0),
            "{}",
            name("step")
        );
        // The shortest one in the norm of M: what is along the rows alone.
        let pushed = &mass * &step;
        let along = phi
            .transpose()
            .svd(true, true)
            .solve(&pushed, 1e-12)
            .expect("both sides");
        let off = &pushed - phi.transpose() * along;
        assert!(
            off.amax() < 1e-8 * pushed.amax().max(1.0),
            "{}",
            name("shortest")
        );
    }
    assert!(
        compared > 150 && driven > 200 && coupled > 100 && looped > 50,
        "{compared} nets, {driven} driven, {coupled} coupled, {looped} other rows"
    );
}

#[test]
fn geared_discs_accelerate_as_their_inertia_seen_through_the_gear() {
    for (ratio, r) in [("3", 3.0), ("-0.5", -0.5)] {
        let discs = read(&format!(
            "model Discs {{
                coordinates: relative;
                gravity: none;
                body driver {{ mass: 2 kg, inertia: diag(0.3, 0.2, 0.3) kg*m^2 }}
                body wheel {{ mass: 1 kg, inertia: diag(0.03, 0.05, 0.03) kg*m^2 }}
                joint teeth: gear from motor.angle to axle.angle {{ ratio: {ratio}, offset: 20 deg }}
                joint motor: hinge from world to driver.com {{ axis: y }}
                joint axle: hinge from world to wheel.com {{ axis: -y }}
                load push on driver = [0, 3, 0] N*m;
            }}"
        ));
        let alpha = 3.0 / (0.2 + 0.05 * r * r);
        let x = [0.1, 0.1 * r + 20f64.to_radians(), 0.0, 0.0];
        let rates = evaluate(&discs, Quantity::Derivative, &x, &[], &[]);
        assert_close(&rates[2..], &[alpha, r * alpha], 1e-14, 0.0, ratio);
        // The torque along `axle.angle`.
        let torque = evaluate(&discs, Quantity::Multipliers, &x, &[], &[]);
        assert_close(&torque, &[0.05 * r * alpha], 1e-14, 0.0, ratio);
        assert_eq!(layout(&discs).elimination.unknowns, 1);
    }
}

#[test]
fn a_driven_pendulum_asks_its_motor_for_what_gravity_and_inertia_take() {
    let pendulum = read(
        "model Pendulum {
            coordinates: relative;
            gravity: [0, 0, -9.81] m/s^2;
            body rod { mass: 2 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
            joint pin: hinge from world to rod.top { axis: y, motor: (0.3 rad) + (2 rad/s^2) * time * time }
        }",
    );
    assert_eq!(layout(&pendulum).elimination.unknowns, 0);
    let x = [0.3, 0.0];
    let rates = evaluate(&pendulum, Quantity::Derivative, &x, &[], &[]);
    assert_close(&rates[1..], &[4.0], 1e-15, 0.0, "the motor's own");
    let torque = evaluate(&pendulum, Quantity::Multipliers, &x, &[], &[]);
    let want = (0.1 + 2.0 * 0.25) * 4.0 + 2.0 * 9.81 * 0.5 * 0.3f64.sin();
    assert_close(&torque, &[want], 1e-14, 0.0, "the motor's torque");
}

#[test]
fn a_long_chain_with_driven_hinges_moves_and_pushes_as_by_its_mass_matrix() {
    for driven in [0, 1, 5, 15] {
        let chain = chain(16, driven, 0);
        let layout = layout(&chain);
        assert!(layout.elimination.order.articulated, "{driven}");
        let mut random = Random::new(driven as u64);
        let x: Vec<f64> = (0..32).map(|_| random.uniform(-1.0, 1.0)).collect();
        let ask = |what| DVector::from_vec(evaluate(&chain, what, &x, &[], &[]));
        let mass = DMatrix::from_vec(16, 16, ask(Quantity::MassMatrix).as_slice().to_vec());
        let v = DVector::from_column_slice(&ask(Quantity::Derivative).as_slice()[16..]);
        let mut pushes = &mass * &v + ask(Quantity::BiasForce);
        let scale = ask(Quantity::BiasForce).amax();
        let multipliers = ask(Quantity::Multipliers);
        for (joint, own) in multipliers.iter().enumerate() {
            pushes[joint] -= own;
            // cos t at its beginning.
            assert_close(&[v[joint]], &[-1.0], 1e-15, 0.0, "a motor's own");
        }
        assert!(pushes.amax() < 1e-11 * scale, "{driven}: {pushes}");
    }
}

/// Bodies hinged on one another anywhere; `driven` of the hinges turn as motors say, the next `geared` by the one before them.
fn chain(n: usize, driven: usize, geared: usize) -> Scene {
    let mut scene = hinged_anyhow(n);
    for joint in scene.joints.iter_mut().take(driven) {
        joint.forces.push(JointForces {
            motor: Some(Formula::Apply(Function::Cos, vec![Formula::Time])),
            ..JointForces::default()
        });
    }
    for joint in driven.max(1)..driven.max(1) + geared {
        let couples = [(joint, 0), (joint - 1, 0)];
        add_gear(&mut scene, couples, (-2.5).into(), 0.0);
    }
    scene.in_coordinates(Coordinates::Relative)
}

#[test]
fn what_is_driven_or_coupled_makes_the_system_smaller() {
    let derivative = |driven, geared| operations(&chain(8, driven, geared), Quantity::Derivative);
    let free = derivative(0, 0);
    let [half, all] = [4, 8].map(|driven| derivative(driven, 0));
    let [one, train] = [1, 7].map(|geared| derivative(0, geared));
    let torques = operations(&chain(8, 8, 0), Quantity::Multipliers);
    let inverse = operations(&chain(8, 0, 0), Quantity::BiasForce);
    println!(
        "free {free}, driven {half} {all}, geared {one} {train}; torques {torques}, bias {inverse}"
    );
    assert!(
        all <= 24,
        "{all}: rates and accelerations are those of the motors"
    );
    assert!(half < free, "{half} of {free}");
    assert!(one < free + 60, "{one}");
    assert!(train < one, "{train}");
}
