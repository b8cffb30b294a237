//! Bodies that leave the system together with the joint that carries them: accelerations and multipliers satisfy the equations of motion,
//! on the joints and off them, with motors and loops, in space and in a plane.

use laws::mechanism::{
    Instance, add_external_loads, add_gear, add_joint, all_joints, empty, evaluate, hang, layout,
    random_seat, state,
};
use laws::random::Random;
use mbd_scene::joints::{Distance, JointForces, JointLaw};
use mbd_scene::{AngularVelocity, Formula, Function, Layout, Plane, Quantity, Redundancy, Scene};
use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

/// A tree of random joints, some of their coordinates driven or coupled by a gear, and a rod across it where freedoms are left.
fn net(seed: u64, components: AngularVelocity, plane: Option<Plane>) -> Scene {
    let mut random = Random::new(seed);
    let laws = all_joints().into_iter().map(|(law, _)| law);
    // Joints whose rows hold the attitude, more often than others.
    let locking = |law: &JointLaw| matches!(law, JointLaw::Rigid(_) | JointLaw::Prismatic(_));
    let laws: Vec<JointLaw> = laws
        .flat_map(|law| vec![law.clone(); if locking(&law) { 3 } else { 1 }])
        .collect();
    let mut scene = empty([0.4, -0.3, -9.81], components);
    scene.planar = plane;
    let count = 3 + random.below(4);
    for joint in 0..count {
        let (law, [a, b]) = hang(&mut scene, &laws, &mut random);
        add_joint(&mut scene, law.clone(), a, b);
        for coordinate in 0..law.measured().count() {
            // In a plane most joints that are driven hold more than there is.
            if random.below(if plane.is_none() { 2 } else { 6 }) == 0 {
                let wave = Formula::Apply(Function::Sin, vec![Formula::Time]);
                scene.joints[joint].forces.push(JointForces {
                    coordinate,
                    motor: Some(wave),
                    ..JointForces::default()
                });
            }
        }
    }
    for (joint, coordinate) in Layout::still(&scene) {
        // Nothing in the plane changes it.
        let forces = &mut scene.joints[joint].forces;
        forces.retain(|forces| forces.coordinate != coordinate);
    }
    let still = Layout::still(&scene);
    let measured = scene.joints.iter().zip(0..).flat_map(|(joint, index)| {
        let coordinates = 0..joint.law.measured().count();
        coordinates.map(move |coordinate| (index, coordinate))
    });
    let mut couples = measured.filter(|coordinate| !still.contains(coordinate));
    if random.below(3) == 0
        && let (Some(from), Some(to)) = (couples.next(), couples.last())
    {
        add_gear(&mut scene, [to, from], (-1.25).into(), 0.3);
    }
    let layout = Layout::keeping(&scene, Redundancy::default());
    if layout.nv > layout.nc {
        // A loop over all that carries the last body.
        let rod = JointLaw::Distance(Distance { length: 0.9.into() });
        let a = random_seat(&mut scene, Some(count - 1), &mut random);
        let b = random_seat(&mut scene, None, &mut random);
        add_joint(&mut scene, rod, a, b);
    }
    add_external_loads(&mut scene);
    scene
}

fn anywhere(plane: Option<Plane>, random: &mut Random) -> Instance {
    let mut one = Instance::random(random);
    if let Some(plane) = plane {
        let n = plane.normal();
        let forces = |x: f64| Vector3::from_fn(|i, _| if i == n { x } else { 0.0 });
        (one.position[n], one.velocity[n]) = (0.0, 0.0);
        one.omega = forces(random.uniform(-2.0, 2.0));
        one.attitude = UnitQuaternion::from_scaled_axis(forces(random.uniform(-3.0, 3.0)));
    }
    one
}

/// The largest number left of the equations of motion, relative to the largest in them and the condition of the rows.
fn left(scene: &Scene, random: &mut Random) -> Option<f64> {
    let layout = layout(scene);
    if layout.nc > layout.nv || layout.rank() < layout.nc {
        // Motors of joints that hold as much already: rows that depend on others.
        return None;
    }
    let bodies: Vec<Instance> = scene
        .bodies
        .iter()
        .map(|_| anywhere(scene.planar, random))
        .collect();
    let x = state(scene, &bodies, &[]);
    let inputs: Vec<f64> = (0..layout.ni).map(|_| random.uniform(-3.0, 3.0)).collect();
    let ask = |what| evaluate(scene, what, &x, &inputs, &[]);
    let phi = DMatrix::from_row_slice(layout.nc, layout.nv, &ask(Quantity::ConstraintJacobian));
    let singular = phi.singular_values();
    let condition = singular.max() / singular.min();
    if condition.is_nan() || condition > 1e4 {
        return None;
    }
    let list = |what| DVector::from_vec(ask(what));
    let mass = DMatrix::from_row_slice(layout.nv, layout.nv, &ask(Quantity::MassMatrix));
    let rates = ask(Quantity::Derivative);
    let v = DVector::from_column_slice(&rates[layout.nq..]);
    let (force, bias) = (list(Quantity::Forces), list(Quantity::BiasForce));
    let pushed = phi.transpose() * list(Quantity::Multipliers);
    let moved = &phi * &v - list(Quantity::ConstraintBias);
    let scale = v.amax().max(pushed.amax());
    let balance = &mass * v + bias - force - pushed;
    let worst = moved.amax().max(balance.amax()) / (scale * condition);
    Some(if worst.is_nan() { f64::INFINITY } else { worst })
}

#[test]
fn accelerations_and_multipliers_satisfy_the_equations_of_motion() {
    for plane in [None, Some(Plane::Xz), Some(Plane::Xy)] {
        for components in [AngularVelocity::Body, AngularVelocity::World] {
            let (mut seen, mut carried, mut worst) = (0, 0, 0.0f64);
            for seed in 0..200 {
                let scene = net(seed, components, plane);
                let plan = &layout(&scene).elimination;
                let locked = plan.steps.iter().filter_map(|step| step.carrying);
                let locked = locked.count();
                let mut random = Random::new(seed + 900);
                for _ in 0..3 {
                    if let Some(left) = left(&scene, &mut random) {
                        seen += 1;
                        carried += locked;
                        assert!(
                            left < 1e-12,
                            "net {seed} {plane:?} {components:?}: {left:e}"
                        );
                        worst = worst.max(left);
                    }
                }
            }
            println!("{plane:?} {components:?}: {seen} states, {carried} locked, {worst:e}");
            assert!(
                seen > 100 && carried > 100,
                "{seen} states, {carried} locked"
            );
        }
    }
}
