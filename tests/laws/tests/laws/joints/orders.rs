//! Orders of elimination: every state at which the rows are independent is solved, whatever order was counted as the cheapest.

use laws::mechanism::{
    Instance, add_external_loads, add_joint, add_point, all_joints, empty, evaluate, hang, layout,
    random_seat, state,
};
use laws::random::Random;
use mbd_scene::joints::{Distance, JointLaw};
use mbd_scene::{AngularVelocity, Layout, Quantity, Redundancy, Scene};
use nalgebra::DMatrix;

/// A net of bodies: a random tree of random joints, and single-row joints across it as long as freedoms are left.
fn net(seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let laws: Vec<JointLaw> = all_joints().into_iter().map(|(law, _)| law).collect();
    let mut scene = empty([0.4, -0.3, -9.81], AngularVelocity::Body);
    let count = 3 + random.below(4);
    for _ in 0..count {
        let (law, [a, b]) = hang(&mut scene, &laws, &mut random);
        add_joint(&mut scene, law, a, b);
    }
    let point = add_point(&mut scene, 0.7);
    for body in 0..2 {
        let hook = random_seat(&mut scene, Some(body), &mut random);
        let rod = JointLaw::Distance(Distance { length: 0.9.into() });
        add_joint(&mut scene, rod, hook, point);
    }
    for _ in 0..4 {
        let layout = Layout::keeping(&scene, Redundancy::default());
        let (one, two) = (random.below(count), random.below(count + 1));
        let law = &laws[random.below(laws.len())];
        let left = layout.nv.saturating_sub(layout.nc);
        if one != two && law.rows() <= left && law.rows() < 5 {
            let a = random_seat(&mut scene, Some(one), &mut random);
            let b = random_seat(&mut scene, (two < count).then_some(two), &mut random);
            add_joint(&mut scene, law.clone(), a, b);
        }
    }
    add_external_loads(&mut scene);
    scene
}

/// What the factor leaves to its smallest pivot.
fn margin(scene: &Scene, x: &[f64]) -> f64 {
    let layout = layout(scene);
    let nothing = vec![0.0; layout.nc];
    let correction = evaluate(scene, Quantity::ProjectionStep, x, &[], &nothing);
    correction.last().copied().unwrap_or(f64::NAN)
}

#[test]
fn accelerations_obey_the_joints_wherever_the_rows_are_independent() {
    let (mut seen, mut worst) = (0, 0.0f64);
    for seed in 0..120 {
        let scene = net(seed);
        let layout = layout(&scene);
        let mut random = Random::new(seed + 7000);
        for trial in 0..6 {
            let bodies: Vec<Instance> = scene
                .bodies
                .iter()
                .map(|_| Instance::random(&mut random))
                .collect();
            let point = Instance::random(&mut random);
            let x = state(&scene, &bodies, &[point]);
            let inputs: Vec<f64> = (0..layout.ni).map(|_| random.uniform(-3.0, 3.0)).collect();
            let ask = |what| evaluate(&scene, what, &x, &inputs, &[]);
            let phi =
                DMatrix::from_row_slice(layout.nc, layout.nv, &ask(Quantity::ConstraintJacobian));
            let singular = phi.singular_values();
            let condition = singular.max() / singular.min();
            if condition > 1e4 {
                continue;
            }
            seen += 1;
            let rates = ask(Quantity::Derivative);
            let v = nalgebra::DVector::from_column_slice(&rates[layout.nq..]);
            let gamma = nalgebra::DVector::from_vec(ask(Quantity::ConstraintBias));
            let left = (&phi * &v - gamma).amax() / v.amax() / condition;
            let margin = margin(&scene, &x);
            assert!(
                margin > 1e-12,
                "net {seed}, state {trial}: margin {margin:e}"
            );
            worst = if left <= worst { worst } else { left };
        }
    }
    println!("{seen} states, worst {worst:e}");
    assert!(
        seen > 200 && worst < 1e-13,
        "{seen} states, worst {worst:e}"
    );
}
