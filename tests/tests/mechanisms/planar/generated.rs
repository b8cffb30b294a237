//! Planar scenes in every execution: generated code, interpreter, laws on numbers; in both precisions.

use mbd_compiler::Interpreted;
use mbd_runtime::{Generic, Options, Simulation, model, state_names};
use mbd_scene::{Layout, Model, Quantity};
use tests::agreement::{agrees, agrees_along, agrees_at};
use tests::instant::{Instant, random_instant};
use tests::random::Random;

macro_rules! linkage {
    ($name:ident $components:ident) => {
        model! {
            /// A driven four-bar with a spring, a weight on a line, a stop, and a slide beside it.
            pub model $name<T> {
                planar: xz;
                angular_velocity: $components;
                gravity: [0.0, 0.3, -9.81] m/s^2;
                verify;
                param torque = 2 N*m in -5 N*m ..= 5 N*m;
                param pull_stiffness = 30 N/m in 1 N/m ..= 100 N/m;
                world { frame pivot at [1.0, 0.0, 0.0] m, frame rail at [-1.0, 0.0, 0.0] m }
                body crank { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2,
                    frame left at [-0.15, 0.0, 0.0] m, frame right at [0.15, 0.0, 0.0] m }
                body coupler { mass: 2 kg, inertia: full { xx: 0.13, yy: 0.12, zz: 0.11, xy: 0.02 } kg*m^2 (matrix elements),
                    frame left at [-0.45, 0.0, 0.05] m, frame right at [0.45, 0.0, 0.05] m }
                body rocker { mass: 1.5 kg, inertia: diag(0.08, 0.09, 0.1) kg*m^2,
                    frame left at [-0.4, 0.0, 0.0] m, frame right at [0.4, 0.0, 0.0] m }
                body shuttle { mass: 0.5 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }
                body plate { mass: 0.4 kg, inertia: diag(0.02, 0.02, 0.02) kg*m^2, frame rim at [0.2, 0.0, 0.1] m }
                point weight { mass: 0.3 kg }
                joint crank_pin: hinge from world to crank.left { axis: y, damping: 0.1 N*m*s, force: torque }
                joint coupler_pin: hinge from crank.right to coupler.left { axis: y }
                joint rocker_pin: hinge from coupler.right to rocker.right { axis: y, stiffness: 3 N*m/rad }
                joint ground_pin: hinge from world.pivot to rocker.left {
                    axis: y, stops: [-100 deg, none], stop_stiffness: 200 N*m/rad, stop_damping: 2 N*m*s }
                joint guide: prismatic from world.rail to shuttle.com { axis: x, stiffness: 20 N/m, friction: 0.2 N, friction_rate: 1 cm/s }
                joint bolt: rigid from shuttle.com to plate.rim;
                line cord from rocker.right to weight { free_length: 0.4 m, stiffness: 200 N/m, damping: 1 N*s/m }
                spring pull from plate.com to coupler.com { free_length: 0.2 m, stiffness: pull_stiffness }
                load wind on plate = 0.2 * [1.0, 0.5, 0.0] * 1 N;
                load push on coupler: external;
                event level = coupler.right.position.z crosses 0.5 m;
                output tip = rocker.right.position;
                output turn = crank_pin.angle in deg;
                output fall = weight.velocity;
                output way = guide.slide;
            }
        }
    };
}

linkage!(LinkageBody body);
linkage!(LinkageWorld world);

model! {
    /// Three parallel cranks below a beam, turned by a motor: one row repeats others.
    pub model Cranks<T> {
        planar: xy;
        gravity: [0.0, -9.81, 0.0] m/s^2;
        verify;
        world { frame b at [1.0, 0.0, 0.0] m, frame c at [1.7, 0.0, 0.0] m }
        body one {
            mass: 1 kg,
            inertia: diag(0.03, 0.04, 0.05) kg*m^2,
            frame root at [0.0, -0.25, 0.0] m,
            frame tip at [0.0, 0.25, 0.0] m,
        }
        body two {
            mass: 1 kg,
            inertia: diag(0.03, 0.04, 0.05) kg*m^2,
            frame root at [0.0, -0.25, 0.0] m,
            frame tip at [0.0, 0.25, 0.0] m,
        }
        body three {
            mass: 1 kg,
            inertia: diag(0.03, 0.04, 0.05) kg*m^2,
            frame root at [0.0, -0.25, 0.0] m,
            frame tip at [0.0, 0.25, 0.0] m,
        }
        body beam {
            mass: 2 kg,
            inertia: diag(0.3, 0.4, 0.5) kg*m^2,
            frame a at [-0.85, 0.0, 0.0] m,
            frame b at [0.15, 0.0, 0.0] m,
            frame c at [0.85, 0.0, 0.0] m,
        }
        joint root_one: hinge from world to one.root {
            motor: 0.5 rad + 0.4 rad * sin(2 rad/s * time),
        }
        joint root_two: hinge from world.b to two.root;
        joint root_three: hinge from world.c to three.root;
        joint tip_one: hinge from one.tip to beam.a;
        joint tip_two: hinge from two.tip to beam.b;
        joint tip_three: hinge from three.tip to beam.c;
        output torque = root_one.motor_torque;
    }
}

/// The linkage as it stands: every body in its place, at rest.
fn standing(scene: &mbd_scene::Scene) -> Vec<f64> {
    let layout = Layout::new(scene);
    let poses = [
        [0.075, 0.1299, -60.0_f64.to_radians()],
        [0.4832, 0.5, -0.6306],
        [0.9384, 0.3952, -1.726],
        [-0.8, 0.0, 0.0],
        [-1.0, -0.1, 0.0],
    ];
    let mut state = vec![0.0; layout.nx()];
    for ((_, slots), pose) in layout.own_bodies().zip(poses) {
        state[slots.q..slots.q + 3].copy_from_slice(&pose);
    }
    state[layout.nq - 2..layout.nq].copy_from_slice(&[1.1, 0.2]);
    state
}

fn cranks_standing() -> Vec<f64> {
    let mut state = vec![0.0; 24];
    for (body, pose) in [
        [-0.12, 0.22, 0.5],
        [0.88, 0.22, 0.5],
        [1.58, 0.22, 0.5],
        [0.61, 0.44, 0.0],
    ]
    .iter()
    .enumerate()
    {
        state[3 * body..3 * body + 3].copy_from_slice(pose);
    }
    state
}

#[test]
fn a_planar_linkage_agrees_in_every_execution() {
    fn check(model: &dyn Model<f64>) {
        agrees(model);
        let generic = Generic::new(model.scene().clone(), model.params()).expect("defaults");
        let mut random = Random::new(5);
        let instants: Vec<_> = (0..5)
            .map(|_| {
                let mut state = standing(model.scene());
                let nq = model.layout().nq;
                state[nq..]
                    .iter_mut()
                    .for_each(|v| *v = random.uniform(-1.0, 1.0));
                let instant = random_instant(model.scene(), &mut random);
                let generic_start = &generic;
                Instant {
                    state: swollen(generic_start, &state),
                    ..instant
                }
            })
            .collect();
        agrees_at(model, &instants);
        agrees_along(model, &standing(model.scene()), (100, 2e-3), 1e-10);
    }
    check(&LinkageBody::<f64>::new(Default::default()).expect("defaults"));
    check(&LinkageWorld::<f64>::new(Default::default()).expect("defaults"));
}

/// The consistent state of a scene with inputs.
fn swollen(generic: &Generic<f64>, state: &[f64]) -> Vec<f64> {
    struct Nothing;
    impl mbd_runtime::External<f64> for Nothing {
        fn evaluate(&self, _: f64, _: &[f64], out: &mut [f64]) {
            out.fill(0.0);
        }
    }
    let mut run = Simulation::with_loads(generic, Options::rk4(1e-3), Nothing).expect("options");
    run.set_state(0.0, state).expect("a state");
    run.start().expect("a consistent start");
    run.state()[..state.len()].to_vec()
}

#[test]
fn planar_cranks_with_a_row_that_repeats_others_agree_in_every_execution() {
    let model = Cranks::<f64>::new(Default::default()).expect("defaults");
    assert_eq!((model.layout().nc, model.layout().rank()), (13, 12));
    agrees(&model);
    agrees_along(&model, &cranks_standing(), (100, 2e-3), 1e-10);
}

#[test]
fn planar_scenes_in_single_precision_have_the_bits_of_the_interpreter() {
    let linkage = LinkageBody::<f32>::new(Default::default()).expect("defaults");
    agrees_along(&linkage, &standing(linkage.scene()), (50, 2e-3), 1e-4);
    let cranks = Cranks::<f32>::new(Default::default()).expect("defaults");
    agrees_along(&cranks, &cranks_standing(), (50, 2e-3), 1e-4);
}

#[test]
fn in_a_plane_both_components_of_angular_velocity_are_one() {
    let body = LinkageBody::<f64>::new(Default::default()).expect("defaults");
    let world = LinkageWorld::<f64>::new(Default::default()).expect("defaults");
    let mut random = Random::new(9);
    let instant = random_instant(body.scene(), &mut random);
    for what in body.layout().quantities() {
        let [a, b]: [Vec<f64>; 2] = [
            tests::instant::value(&body, what, &instant),
            tests::instant::value(&world, what, &instant),
        ];
        let bound = if what == Quantity::Derivative {
            1e-10
        } else {
            1e-12
        };
        tests::assert_close(&a, &b, bound, bound, &format!("{what:?}"));
    }
}

#[test]
fn the_state_of_a_plane_is_named_by_its_axes() {
    let model = LinkageBody::<f64>::new(Default::default()).expect("defaults");
    let names = state_names(model.scene(), model.layout());
    let list = |from: usize, to: usize| -> Vec<(&str, &str)> {
        let names = names[from..to].iter();
        names
            .map(|name| (name.name.as_str(), name.unit.as_str()))
            .collect()
    };
    assert_eq!(
        list(0, 3),
        [("crank.x", "m"), ("crank.z", "m"), ("crank.angle", "rad")]
    );
    let nq = model.layout().nq;
    assert_eq!(list(nq - 2, nq), [("weight.x", "m"), ("weight.z", "m")]);
    assert_eq!(
        list(nq, nq + 3),
        [
            ("crank.vx", "m/s"),
            ("crank.vz", "m/s"),
            ("crank.omega_y", "rad/s")
        ]
    );
    assert!(LinkageBody::<f64>::explain().contains("in the plane xz, angles about y"));
    assert_eq!(
        LinkageBodyState::<f64>::at_origin().to_vec(),
        vec![0.0; model.layout().nx()]
    );
    let interpreted = Interpreted::new(model.scene().clone(), model.params()).expect("defaults");
    assert_eq!(interpreted.layout(), model.layout());
}
