//! Random mechanisms: trees, loops, points, springs of every joint type. What must hold for any of them holds in every execution.

use dense::symmetric_condition;
use mbd_compiler::Interpreted;
use mbd_runtime::Generic;
use mbd_scene::joints::{Distance, JointLaw};
use mbd_scene::{AngularVelocity, Layout, Model, Place, Quantity, Redundancy, Scene};
use nalgebra::{DMatrix, DVector};
use tests::assert_close;
use tests::cores::on_all_cores;
use tests::mechanism::{
    Instance, add_external_loads, add_joint, add_point, all_joints, at, empty, evaluate, hang,
    layout, random_seat, state, with_components,
};
use tests::random::Random;

/// Bodies hung on each other and on the world by random joints, two of them closing loops where that leaves freedoms, a point on a rod.
fn mechanism(seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let laws: Vec<JointLaw> = all_joints().into_iter().map(|(law, _)| law).collect();
    let mut scene = empty([0.4, -0.3, -9.81], AngularVelocity::Body);
    let count = 2 + random.below(5);
    for _ in 0..count {
        let (law, [a, b]) = hang(&mut scene, &laws, &mut random);
        if random.below(4) == 0 {
            add_joint(&mut scene, law, b, a);
        } else {
            add_joint(&mut scene, law, a, b);
        }
    }
    let point = add_point(&mut scene, 0.7);
    let hook = random_seat(&mut scene, Some(count - 1), &mut random);
    let rod = JointLaw::Distance(Distance { length: 0.9.into() });
    add_joint(&mut scene, rod.clone(), hook, point);
    for _ in 0..2 {
        let layout = Layout::keeping(&scene, Redundancy::default());
        let freedoms = layout.nv - layout.nc;
        let (one, two) = (random.below(count), random.below(count));
        let law = &laws[random.below(laws.len())];
        if one != two && law.rows() < 3.min(freedoms) {
            let (a, b) = (
                random_seat(&mut scene, Some(one), &mut random),
                random_seat(&mut scene, Some(two), &mut random),
            );
            add_joint(&mut scene, law.clone(), a, b);
        }
    }
    add_external_loads(&mut scene);
    scene
}

/// A random state: rows need not hold for the equations of motion to be well posed.
struct Moment {
    bodies: Vec<Instance>,
    point: Instance,
    inputs: Vec<f64>,
    rows: Vec<f64>,
}

fn moment(scene: &Scene, random: &mut Random) -> Moment {
    let layout = layout(scene);
    let mut list = |n: usize| {
        (0..n)
            .map(|_| random.uniform(-3.0, 3.0))
            .collect::<Vec<f64>>()
    };
    Moment {
        inputs: list(layout.ni),
        rows: list(layout.nc),
        bodies: scene
            .bodies
            .iter()
            .map(|_| Instance::random(random))
            .collect(),
        point: Instance::random(random),
    }
}

impl Moment {
    fn ask(&self, scene: &Scene, what: Quantity) -> Vec<f64> {
        let x = state(scene, &self.bodies, &[self.point]);
        evaluate(scene, what, &x, &self.inputs, &self.rows)
    }

    fn matrix(&self, scene: &Scene, what: Quantity, rows: usize) -> DMatrix<f64> {
        DMatrix::from_row_slice(rows, layout(scene).nv, &self.ask(scene, what))
    }

    /// cond([M Φᵀ; Φ 0]).
    fn condition(&self, scene: &Scene) -> f64 {
        let layout = layout(scene);
        let (n, m) = (layout.nv, layout.nc);
        let mut system = DMatrix::zeros(n + m, n + m);
        let phi = self.matrix(scene, Quantity::ConstraintJacobian, m);
        system
            .view_mut((0, 0), (n, n))
            .copy_from(&self.matrix(scene, Quantity::MassMatrix, n));
        system.view_mut((n, 0), (m, n)).copy_from(&phi);
        system.view_mut((0, n), (n, m)).copy_from(&phi.transpose());
        symmetric_condition(system)
    }
}

/// Calls `check` at regular states of 40 mechanisms.
fn everywhere(mut check: impl FnMut(&str, &Scene, &Moment)) {
    let mut seen = 0;
    for seed in 0..40 {
        let scene = mechanism(seed);
        let mut random = Random::new(seed + 500);
        for trial in 0..10 {
            let moment = moment(&scene, &mut random);
            if moment.condition(&scene) < 1e4 {
                seen += 1;
                check(&format!("mechanism {seed}, state {trial}"), &scene, &moment);
            }
        }
    }
    assert!(seen > 200, "only {seen} regular states");
}

#[test]
fn accelerations_and_multipliers_solve_the_equations_of_motion() {
    everywhere(|name, scene, moment| {
        let layout = layout(scene);
        let vector = |what| DVector::from_vec(moment.ask(scene, what));
        let mass = moment.matrix(scene, Quantity::MassMatrix, layout.nv);
        let phi = moment.matrix(scene, Quantity::ConstraintJacobian, layout.nc);
        let rate = moment.ask(scene, Quantity::Derivative);
        let v = DVector::from_column_slice(&rate[layout.nq..]);
        let lambda = vector(Quantity::Multipliers);
        let push = phi.transpose() * &lambda;
        let left = &mass * &v + vector(Quantity::BiasForce);
        let right = vector(Quantity::Forces) + &push;
        let scale = push.amax().max(left.amax());
        assert_close(left.as_slice(), right.as_slice(), 0.0, 1e-11 * scale, name);
        let reached = &phi * &v;
        let bias = vector(Quantity::ConstraintBias);
        let name = format!("{name}: Φ_v v̇ = γ");
        assert_close(
            reached.as_slice(),
            bias.as_slice(),
            0.0,
            1e-11 * v.amax(),
            &name,
        );
    });
}

#[test]
fn both_components_of_angular_velocity_give_the_same_motion() {
    everywhere(|name, scene, moment| {
        let layout = layout(scene);
        let world = with_components(scene, AngularVelocity::World);
        let (body, other) = (
            moment.ask(scene, Quantity::Derivative),
            moment.ask(&world, Quantity::Derivative),
        );
        let mut rotated = other.clone();
        for ((_, slots), instance) in layout.own_bodies().zip(&moment.bodies) {
            let at = layout.nq + slots.v + 3;
            let alpha = nalgebra::Vector3::from_column_slice(&other[at..at + 3]);
            rotated[at..at + 3]
                .copy_from_slice((instance.rotation().transpose() * alpha).as_slice());
        }
        assert_close(&rotated, &body, 1e-11, 0.0, name);
        for what in [Quantity::Multipliers, Quantity::Reactions] {
            let (a, b) = (moment.ask(scene, what), moment.ask(&world, what));
            assert_close(&a, &b, 1e-11, 0.0, &format!("{name}: {what:?}"));
        }
        for what in [
            Quantity::Constraint,
            Quantity::ConstraintRate,
            Quantity::ConstraintBias,
        ] {
            let (a, b) = (moment.ask(scene, what), moment.ask(&world, what));
            assert_close(&a, &b, 1e-13, 1e-13, &format!("{name}: {what:?}"));
        }
    });
}

#[test]
fn the_correction_is_the_smallest_move_weighted_by_mass() {
    everywhere(|name, scene, moment| {
        let layout = layout(scene);
        let mass = moment.matrix(scene, Quantity::MassMatrix, layout.nv);
        let phi = moment.matrix(scene, Quantity::ConstraintJacobian, layout.nc);
        let inverse = mass.clone().try_inverse().expect("a mass matrix");
        let s = &phi * &inverse * phi.transpose();
        let r = DVector::from_vec(moment.rows.clone());
        let mu = s.clone().lu().solve(&r).expect("independent rows");
        let want = -(inverse * phi.transpose() * mu);
        let mut got = moment.ask(scene, Quantity::ProjectionStep);
        let margin = got.pop().expect("the margin behind the move");
        assert!(margin > 1e-9 && margin <= 1.0, "{name}: margin {margin:e}");
        assert_close(&got, want.as_slice(), 1e-10, 0.0, name);
    });
}

#[test]
fn reactions_are_the_multipliers_at_the_joint_and_do_no_work_on_what_it_allows() {
    everywhere(|name, scene, moment| {
        let layout = layout(scene);
        let phi = moment.matrix(scene, Quantity::ConstraintJacobian, layout.nc);
        let lambda = moment.ask(scene, Quantity::Multipliers);
        let reactions = moment.ask(scene, Quantity::Reactions);
        for (index, (joint, slots)) in scene.joints.iter().zip(&layout.joints).enumerate() {
            let Place::Body(body, _) = joint.child else {
                continue;
            };
            // Φ_vᵀ λ of this joint on its child, moved to the origin of frame 2.
            let v = layout.bodies[body].expect("slots").v;
            let mut push = [0.0; 6];
            for row in slots.row..slots.row + slots.len {
                for (k, sum) in push.iter_mut().enumerate() {
                    *sum += phi[(row, v + k)] * lambda[row];
                }
            }
            let x = state(scene, &moment.bodies, &[moment.point]);
            let instance = &moment.bodies[body];
            let arm = arm_of(scene, joint.child);
            let force = nalgebra::Vector3::from_column_slice(&push[..3]);
            let torque = instance.rotation() * nalgebra::Vector3::from_column_slice(&push[3..]);
            let couple = torque - (instance.rotation() * arm).cross(&force);
            let want = [force.as_slice(), couple.as_slice()].concat();
            let got = &reactions[6 * index..6 * index + 6];
            let scale = lambda.iter().fold(1.0f64, |m, x| m.max(x.abs()));
            let name = format!("{name}: {}", joint.name);
            assert_close(got, &want, 0.0, 1e-13 * scale, &name);
            assert_eq!(x.len(), layout.nx());
        }
    });
}

fn arm_of(scene: &Scene, place: Place) -> nalgebra::Vector3<f64> {
    let numbers = mbd_scene::laws::Numbers::<f64>::new(scene, &[]);
    match place {
        Place::Body(body, frame) => numbers.bodies[body].frames[frame].position,
        Place::World(frame) => numbers.world_frames[frame].position,
        Place::Point(_) => nalgebra::Vector3::zeros(),
    }
}

#[test]
fn interpreted_and_generic_agree_on_every_quantity_of_the_joints() {
    for seed in [1, 4, 9, 16] {
        for components in [AngularVelocity::Body, AngularVelocity::World] {
            let scene = with_components(&mechanism(seed), components);
            let layout = layout(&scene);
            let wanted: Vec<Quantity> = layout
                .quantities()
                .into_iter()
                .filter(|what| !matches!(what, Quantity::Partial(..)))
                .collect();
            let equations = mbd_compiler::SceneEquations::trace_only(&scene, &wanted);
            let generic = Generic::<f64>::with_defaults(scene.clone()).expect("defaults are valid");
            let interpreted =
                Interpreted::from_equations(equations, generic.params()).expect("valid");
            let mut random = Random::new(seed + 90);
            for _ in 0..3 {
                let moment = moment(&scene, &mut random);
                if moment.condition(&scene) > 1e4 {
                    continue;
                }
                let x = state(&scene, &moment.bodies, &[moment.point]);
                let mut work = (generic.work(), interpreted.work());
                for &what in &wanted {
                    let at = at(&x, &moment.inputs, &moment.rows);
                    let mut out = vec![vec![0.0; layout.len(what)]; 2];
                    generic.evaluate(what, &at, &mut work.0, &mut out[0]);
                    interpreted.evaluate(what, &at, &mut work.1, &mut out[1]);
                    let name = format!("mechanism {seed}, {what:?}");
                    assert_close(&out[1], &out[0], 1e-12, 1e-12, &name);
                    // Nothing is carried from call to call.
                    let first = out[0].clone();
                    out[0].fill(0.0);
                    generic.evaluate(what, &at, &mut work.0, &mut out[0]);
                    assert_eq!(out[0], first, "{name}");
                }
            }
        }
    }
}

/// World = body = generic = interpreted accelerations at random states of 20 mechanisms; equal digits in all.
fn agree(states: usize) -> usize {
    let seen = on_all_cores(20, |number| {
        let seed = 100 + number;
        let body = mechanism(seed);
        let world = with_components(&body, AngularVelocity::World);
        let layout = layout(&body);
        let programs: Vec<_> = [&body, &world]
            .into_iter()
            .map(|scene| {
                let wanted = [Quantity::Derivative];
                let equations = mbd_compiler::SceneEquations::trace_only(scene, &wanted);
                Interpreted::<f64>::from_equations(equations, &[]).expect("no parameters")
            })
            .collect();
        let mut random = Random::new(seed + 4000);
        let mut own = 0;
        for _ in 0..4 * states {
            if own == states {
                break;
            }
            let moment = moment(&body, &mut random);
            let condition = moment.condition(&body);
            if condition > 1e3 {
                continue;
            }
            own += 1;
            let want = moment.ask(&body, Quantity::Derivative);
            let scale = want[layout.nq..].iter().fold(0.0f64, |m, a| m.max(a.abs()));
            let rotated = |rates: &[f64]| {
                let mut rates = rates.to_vec();
                for ((_, slots), instance) in layout.own_bodies().zip(&moment.bodies) {
                    let at = layout.nq + slots.v + 3;
                    let alpha = nalgebra::Vector3::from_column_slice(&rates[at..at + 3]);
                    let own = instance.rotation().transpose() * alpha;
                    rates[at..at + 3].copy_from_slice(own.as_slice());
                }
                rates
            };
            let other = rotated(&moment.ask(&world, Quantity::Derivative));
            let mut ways = vec![other];
            for (program, scene) in programs.iter().zip([&body, &world]) {
                let x = state(scene, &moment.bodies, &[moment.point]);
                let mut out = vec![0.0; layout.nx()];
                let at = at(&x, &moment.inputs, &moment.rows);
                program.evaluate(Quantity::Derivative, &at, &mut program.work(), &mut out);
                let in_world = scene.angular_velocity == AngularVelocity::World;
                ways.push(if in_world { rotated(&out) } else { out });
            }
            for got in ways {
                let pairs = got[layout.nq..].iter().zip(&want[layout.nq..]);
                let off = pairs.fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
                assert!(
                    off <= 1e-12 * scale,
                    "mechanism {seed}: {:e}, condition {condition:e}",
                    off / scale
                );
            }
        }
        own
    });
    seen.into_iter().sum()
}

#[test]
fn world_body_generic_and_interpreted_accelerations_agree_at_ten_thousand_states() {
    assert!(agree(600) >= 10_000);
}

#[test]
fn a_scene_without_rows_has_no_quantity_of_rows() {
    let mut scene = mechanism(3);
    scene.joints.clear();
    let layout = layout(&scene);
    assert_eq!(layout.nc, 0);
    for what in layout.quantities() {
        let name = format!("{what:?}");
        assert!(
            !name.contains("Constraint") && !name.contains("Reactions"),
            "{name}"
        );
    }
}
