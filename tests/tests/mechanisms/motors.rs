//! Motors: coordinates of joints that time prescribes, against jets, closed forms and the balance of power.

use mbd_runtime::{Generic, Options, Simulation, StepError, model};
use mbd_scene::joints::{JointForces, JointLaw};
use mbd_scene::laws::Numbers;
use mbd_scene::{AngularVelocity, Formula, Function, Layout, Model, Place, Quantity, Scene};
use nalgebra::{DMatrix, DVector};
use tests::agreement::agrees;
use tests::assert_close;
use tests::jet::Jet;
use tests::mechanism::{
    Instance, Seat, accelerations, add_body, add_frame, add_joint, all_joints, empty,
    evaluate_in_time, inertia, jets, state,
};
use tests::random::Random;

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];

fn apply(function: Function, parts: Vec<Formula>) -> Formula {
    Formula::Apply(function, parts)
}

/// 0.3 + 1.7 t + 0.4 sin(2.3 t).
fn course() -> Formula {
    let times = |a: f64| apply(Function::Mul, vec![a.into(), Formula::Time]);
    let wave = apply(
        Function::Mul,
        vec![0.4.into(), apply(Function::Sin, vec![times(2.3)])],
    );
    let sum = |a: Formula, b: Formula| apply(Function::Add, vec![a, b]);
    sum(sum(0.3.into(), times(1.7)), wave)
}

fn motor(coordinate: usize, motor: Formula) -> JointForces {
    JointForces {
        coordinate,
        motor: Some(motor),
        ..JointForces::default()
    }
}

/// Every coordinate of every joint driven, between two bodies and to the world, in both components.
fn everywhere(mut check: impl FnMut(&str, &Scene, &mut Random)) {
    let mut random = Random::new(83);
    for (law, _) in all_joints() {
        for components in COMPONENTS {
            for to_world in [false, true] {
                for coordinate in 0..law.measured().count() {
                    let mut scene = empty([0.3, -0.2, -9.81], components);
                    let parent =
                        (!to_world).then(|| add_body(&mut scene, 1.7, &inertia(&mut random)));
                    let child = add_body(&mut scene, 0.9, &inertia(&mut random));
                    let seat = Seat::random(&mut random).declared("one");
                    let from = add_frame(&mut scene, parent, seat);
                    let seat = Seat::random(&mut random).declared("two");
                    let to = add_frame(&mut scene, Some(child), seat);
                    add_joint(&mut scene, law.clone(), from, to);
                    scene.joints[0].forces = vec![motor(coordinate, course())];
                    let name = format!("{law:?} {coordinate}, {components:?}, to world {to_world}");
                    check(&name, &scene, &mut random);
                }
            }
        }
    }
}

#[test]
fn a_motor_adds_one_row_whose_rates_are_the_jets_of_its_position() {
    everywhere(|name, scene, random| {
        let layout = Layout::new(scene);
        assert_eq!(layout.nc, scene.joints[0].law.rows() + 1, "{name}");
        for time in [0.0, 0.9, -3.1] {
            let bodies: Vec<Instance> = scene
                .bodies
                .iter()
                .map(|_| Instance::random(random))
                .collect();
            let x = state(scene, &bodies, &[]);
            let jets = jets(scene, &bodies, &[]);
            let rows = evaluate_in_time(scene, Quantity::Constraint, Jet([time, 1.0, 0.0]), &jets);
            let part = |k: usize| rows.iter().map(|row| row.0[k]).collect::<Vec<f64>>();
            let rate = evaluate_in_time(scene, Quantity::ConstraintRate, time, &x);
            assert_close(&rate, &part(1), 1e-13, 1e-13, &format!("{name}: Φ̇"));
            let dense = evaluate_in_time(scene, Quantity::ConstraintJacobian, time, &x);
            let columns = DMatrix::from_row_slice(layout.nc, layout.nv, &dense);
            let moved = columns * DVector::from_vec(accelerations(scene, &bodies, &[]));
            let bias = evaluate_in_time(scene, Quantity::ConstraintBias, time, &x);
            let curve: Vec<f64> = moved.iter().zip(&bias).map(|(a, b)| a - b).collect();
            assert_close(&curve, &part(2), 1e-12, 1e-12, &format!("{name}: Φ̈"));
        }
    });
}

#[test]
fn every_motorised_joint_runs_where_its_course_says_and_its_power_closes_the_balance() {
    everywhere(|name, scene, _| {
        // From the course's value at the start, the other coordinates free, three seconds: turns go round more than once.
        let model = Generic::<f64>::with_defaults(scene.clone()).expect("a valid scene");
        let options = Options {
            work: true,
            ..Options::tsit5(1e-9)
        };
        let mut run = Simulation::new(&model, options).expect("options");
        let bodies: Vec<Instance> = scene.bodies.iter().map(|_| Instance::rest()).collect();
        let mut x = state(scene, &bodies, &[]);
        // The frames together, apart from the course: the start moves them to it.
        if !assemble(scene, &mut x) {
            return;
        }
        run.set_state(0.0, &x).expect("a state");
        if let Err(error) = run.start() {
            panic!("{name}: {error}");
        }
        let energy = |run: &mut Simulation<f64>| {
            let mut out = [0.0; 6];
            run.evaluate(Quantity::Energy, &mut out).expect("energy");
            out[..3].iter().sum::<f64>()
        };
        let before = energy(&mut run);
        run.run(1.5)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut rows = vec![0.0; model.layout().nc];
        for what in [Quantity::Constraint, Quantity::ConstraintRate] {
            run.evaluate(what, &mut rows).expect("rows");
            let zero = vec![0.0; rows.len()];
            assert_close(&rows, &zero, 0.0, 1e-12, &format!("{name}: {what:?}"));
        }
        let gained = energy(&mut run) - before;
        let works = run.work().expect("asked for");
        let error = (gained - works.iter().sum::<f64>()).abs();
        assert!(
            error < 1e-5 * (1.0 + gained.abs()),
            "{name}: {error:e} of {gained:e} J"
        );
    });
}

/// Puts the child's frame on the parent's frame, unturned; says whether the joint is defined there.
fn assemble(scene: &Scene, x: &mut [f64]) -> bool {
    let joint = &scene.joints[0];
    let frame = |place: Place| -> (nalgebra::Matrix3<f64>, nalgebra::Vector3<f64>) {
        let numbers = Numbers::<f64>::new(scene, &[]);
        let frame = match place {
            Place::World(frame) => &numbers.world_frames[frame],
            Place::Body(body, frame) => &numbers.bodies[body].frames[frame],
            Place::Point(_) => unreachable!("bodies alone"),
        };
        (
            frame.rotation.unwrap_or_else(nalgebra::Matrix3::identity),
            frame.position,
        )
    };
    let (one, two) = (frame(joint.parent), frame(joint.child));
    let Place::Body(child, _) = joint.child else {
        return false;
    };
    let rotation = one.0 * two.0.transpose();
    let position = one.1 - rotation * two.1;
    let turn = nalgebra::UnitQuaternion::from_matrix(&rotation);
    let at = Layout::new(scene).bodies[child].expect("slots").q;
    x[at..at + 3].copy_from_slice(position.as_slice());
    x[at + 3..at + 7].copy_from_slice(&[turn.w, turn.i, turn.j, turn.k]);
    true
}

/// A slider-crank: crank of 0.2 m about z, massless rod of 0.7 m, slider of 1.5 kg along x.
macro_rules! slider_crank {
    ($name:ident $components:ident) => {
        model! {
            /// A crank that turns at a constant rate and drives a slider through a massless rod.
            pub model $name<T> {
                verify;
                gravity: none;
                angular_velocity: $components;
                param rate = 9 rad/s in 1 rad/s ..= 20 rad/s;
                body crank {
                    mass: 0.8 kg,
                    inertia: diag(0.01, 0.01, 0.015) kg*m^2,
                    frame pin at [0.2, 0.0, 0.0] m,
                }
                body slider { mass: 1.5 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
                joint bearing: hinge from world to crank.com { axis: z, motor: rate * time }
                joint rod: distance from crank.pin to slider.com { length: 0.7 m }
                joint rail: prismatic from world to slider.com { axis: x }
                output torque = bearing.motor_torque;
                output way = rail.slide;
                event hard = bearing.motor_torque rises 1.0 N*m;
            }
        }
    };
}

slider_crank!(SliderCrank body);
slider_crank!(SliderCrankWorld world);

/// Way, speed and acceleration of the slider: x = r cos θ + √(l² − r² sin² θ).
fn slider(angle: f64, rate: f64) -> [f64; 3] {
    let (r, l) = (0.2, 0.7_f64);
    let (s, c) = angle.sin_cos();
    let root = (l * l - r * r * s * s).sqrt();
    let slope = -r * s - r * r * s * c / root;
    let bend = -r * c - r * r * (c * c - s * s) / root - (r * r * s * c).powi(2) / root.powi(3);
    [r * c + root, slope * rate, bend * rate * rate]
}

fn crank_state(angle: f64) -> Vec<f64> {
    let (s, c) = (angle / 2.0).sin_cos();
    let mut x = vec![0.0; 26];
    (x[3], x[6]) = (c, s);
    (x[7], x[10]) = (slider(angle, 0.0)[0], 1.0);
    x
}

#[test]
fn a_driven_slider_crank_moves_and_pulls_as_its_closed_form_says() {
    fn follow(model: &dyn Model<f64>) {
        let mut run = Simulation::new(model, Options::rk4(1e-3)).expect("options");
        run.set_state(0.25, &crank_state(9.0 * 0.25))
            .expect("a state");
        let mut most: f64 = 0.0;
        for tick in 0..60 {
            let time = 0.25 + 0.05 * f64::from(tick);
            run.run(time).expect("a run of several turns");
            let [x, v, a] = slider(9.0 * time, 9.0);
            let state = run.state().to_vec();
            assert!((state[7] - x).abs() < 1e-12, "way at {time}");
            assert!((state[14 + 6] - v).abs() < 1e-11, "speed at {time}");
            let mut rates = vec![0.0; 26];
            run.evaluate(Quantity::Derivative, &mut rates)
                .expect("rates");
            assert!((rates[14 + 6] - a).abs() < 1e-9, "acceleration at {time}");
            let mut outputs = [0.0; 2];
            run.evaluate(Quantity::Outputs, &mut outputs)
                .expect("outputs");
            // The motor alone does work: M ω = m ẋ ẍ.
            let torque = 1.5 * v * a / 9.0;
            most = most.max((outputs[0] - torque).abs());
            assert!((outputs[0] - torque).abs() < 1e-9, "torque at {time}");
            assert!((outputs[1] - x).abs() < 1e-12, "slide at {time}");
            let mut energy = [0.0; 6];
            run.evaluate(Quantity::Energy, &mut energy).expect("energy");
            assert!((energy[5] - torque * 9.0).abs() < 1e-8, "power at {time}");
        }
        assert!(!run.events().is_empty(), "the torque passes 1 N m");
        println!("torque within {most:e} N m");
    }
    follow(&SliderCrank::<f64>::new(Default::default()).expect("defaults"));
    follow(&SliderCrankWorld::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn a_driven_slider_crank_agrees_in_every_execution() {
    agrees(&SliderCrank::<f64>::new(Default::default()).expect("defaults"));
    agrees(&SliderCrankWorld::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn a_driven_slider_crank_runs_in_single_precision() {
    let single = SliderCrank::<f32>::new(Default::default()).expect("defaults");
    let mut run = Simulation::new(&single, Options::rk4(2e-3)).expect("options");
    let x: Vec<f32> = crank_state(0.0).iter().map(|x| *x as f32).collect();
    run.set_state(0.0, &x).expect("a state");
    run.run(1.0).expect("a run");
    let want = slider(9.0, 9.0)[0];
    assert!((f64::from(run.state()[7]) - want).abs() < 1e-5);
}

#[test]
fn a_driven_slider_crank_takes_up_its_speed_in_single_precision() {
    for rate in 9..=20 {
        let rate = rate as f32;
        let single = SliderCrank::<f32>::new(SliderCrankParams { rate }).expect("in range");
        let mut run = Simulation::new(&single, Options::rk4(2e-3)).expect("options");
        let mut x: Vec<f32> = crank_state(0.0).iter().map(|x| *x as f32).collect();
        x[14..].fill(0.0);
        run.set_state(0.0, &x).expect("a state");
        run.start().expect("a start");
        assert!((run.state()[14 + 5] - rate).abs() <= 4.0 * f32::EPSILON * rate);
    }
}

model! {
    /// An arm held and swung by a motor, a carriage driven along and about its rail, a nut driven on its thread.
    pub model Machine {
        verify;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body arm {
            mass: 2.0 kg,
            inertia: diag(0.2, 0.2, 0.02) kg*m^2,
            frame top at [0.0, 0.0, 0.6] m,
        }
        body carriage { mass: 3.0 kg, inertia: diag(0.1, 0.2, 0.25) kg*m^2 }
        body nut { mass: 0.5 kg, inertia: diag(0.01, 0.01, 0.02) kg*m^2 }
        joint shoulder: hinge from world to arm.top { axis: y, motor: 30 deg }
        joint sleeve: cylindrical from world to carriage.com {
            axis: z,
            slide: { motor: 0.3 m * sin(2 rad/s * time) },
            angle: { motor: 4 rad/s * time },
        }
        joint thread: screw from world to nut.com { axis: z, pitch: 10 mm, motor: 20 rad/s * time }
        output hold = shoulder.motor_torque;
        output lift = sleeve.slide_motor_force;
        output spin = sleeve.angle_motor_torque;
        output drive = thread.motor_torque;
    }
}

#[test]
fn efforts_of_motors_are_the_forces_and_torques_along_their_coordinates() {
    let model = Machine::new(Default::default()).expect("no params");
    agrees(&model);
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    let mut x = vec![0.0; 39];
    let (s, c) = (15.0_f64.to_radians()).sin_cos();
    // About y by 30°: the arm's centre goes to −x.
    let half: f64 = 0.5;
    x[..3].copy_from_slice(&[-0.6 * half, 0.0, -0.6 * 0.75_f64.sqrt()]);
    (x[3], x[5]) = (c, s);
    (x[7 + 3], x[14 + 3]) = (1.0, 1.0);
    run.set_state(0.0, &x).expect("a state");
    run.run(2.0).expect("a run of several turns");
    let mut efforts = [0.0; 4];
    run.evaluate(Quantity::Outputs, &mut efforts)
        .expect("outputs");
    let g = 9.81;
    // The weight of the arm turns it back about −y: the motor holds against it.
    let hold = 2.0 * g * 0.6 * half;
    let lift = 3.0 * (g - 0.3 * 4.0 * (2.0_f64 * 2.0).sin());
    // At a constant rate the thread carries the weight at pitch/2π a radian.
    let drive = 0.5 * g * 0.01 / std::f64::consts::TAU;
    assert_close(&efforts, &[hold, lift, 0.0, drive], 0.0, 1e-9, "efforts");
    let mut reactions = [0.0; 18];
    run.evaluate(Quantity::Reactions, &mut reactions)
        .expect("reactions");
    assert_close(
        &reactions[..6],
        &[0.0, 0.0, 2.0 * g, 0.0, hold, 0.0],
        0.0,
        1e-9,
        "shoulder",
    );
    let nut = run.state()[14 + 2];
    assert!(
        (nut - 40.0 * 0.01 / std::f64::consts::TAU).abs() < 1e-12,
        "{nut}"
    );
}

#[test]
fn what_drives_a_coordinate_is_explained() {
    let told = Machine::explain();
    for course in [
        "sleeve.slide: motor = 0.3 * sin(2 * time) m",
        "sleeve.angle: motor = 4 * time rad",
        "thread.angle: motor = 20 * time rad",
    ] {
        assert!(told.contains(course), "{course} in\n{told}");
    }
}

fn law(keyword: &str) -> JointLaw {
    match keyword {
        "hinge" => JointLaw::Hinge(Default::default()),
        "prismatic" => JointLaw::Prismatic(Default::default()),
        other => panic!("no joint {other}"),
    }
}

model! {
    /// A parallelogram whose last joint closes the loop, repeats three rows and is driven.
    pub model Parallelogram {
        gravity: [0.0, -9.81, 0.0] m/s^2;
        world { frame right at [2.0, 0.0, 0.0] m }
        body crank {
            mass: 1.0 kg,
            inertia: diag(0.01, 0.08, 0.08) kg*m^2,
            frame base at [-0.5, 0.0, 0.0] m,
            frame tip at [0.5, 0.0, 0.0] m,
        }
        body coupler {
            mass: 2.0 kg,
            inertia: diag(0.02, 0.6, 0.6) kg*m^2,
            frame left at [-1.0, 0.0, 0.0] m,
            frame right at [1.0, 0.0, 0.0] m,
        }
        body follower {
            mass: 1.0 kg,
            inertia: diag(0.01, 0.08, 0.08) kg*m^2,
            frame base at [-0.5, 0.0, 0.0] m,
            frame tip at [0.5, 0.0, 0.0] m,
        }
        joint pivot: hinge from world to crank.base { axis: z }
        joint left: hinge from crank.tip to coupler.left { axis: z }
        joint right: hinge from coupler.right to follower.tip { axis: z }
        joint drive: hinge from world.right to follower.base {
            axis: z,
            motor: 60 deg + 1 rad/s * time,
        }
        output torque = drive.motor_torque;
    }
}

#[test]
fn a_motor_stays_in_the_joint_that_closes_a_loop_and_loses_rows() {
    let model = Parallelogram::new(Default::default()).expect("no params");
    let layout = model.layout();
    assert_eq!(
        (layout.nc, layout.rank()),
        (21, 18),
        "three of the rows repeat others"
    );
    agrees(&model);
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    let (s, c) = 60.0_f64.to_radians().sin_cos();
    let (half_s, half_c) = 30.0_f64.to_radians().sin_cos();
    let mut x = vec![0.0; 39];
    x[..7].copy_from_slice(&[0.5 * c, 0.5 * s, 0.0, half_c, 0.0, 0.0, half_s]);
    x[7..14].copy_from_slice(&[c + 1.0, s, 0.0, 1.0, 0.0, 0.0, 0.0]);
    x[14..21].copy_from_slice(&[2.0 + 0.5 * c, 0.5 * s, 0.0, half_c, 0.0, 0.0, half_s]);
    run.set_state(0.0, &x).expect("a state");
    run.run(0.8).expect("a run");
    let x = run.state().to_vec();
    let want = 60.0_f64.to_radians() + 0.8;
    assert!(
        (2.0 * x[6].atan2(x[3]) - want).abs() < 1e-11,
        "the crank follows"
    );
    let mut torque = [0.0];
    run.evaluate(Quantity::Outputs, &mut torque)
        .expect("outputs");
    // At a constant rate the torque carries the weights alone: (½ 1 + ½ 1 + 2) kg at 1 m.
    assert!(
        (torque[0] - 3.0 * 9.81 * want.cos()).abs() < 1e-9,
        "{torque:?}"
    );
}

#[test]
fn a_motor_half_a_turn_from_its_start_is_reported_as_the_wrong_branch() {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let body = add_body(&mut scene, 1.0, &nalgebra::Matrix3::identity());
    add_joint(
        &mut scene,
        law("hinge"),
        Place::World(0),
        Place::Body(body, 0),
    );
    scene.joints[0].forces = vec![motor(0, 3.0.into())];
    let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("options");
    let mut x = vec![0.0; 13];
    x[3] = 1.0;
    run.set_state(0.0, &x).expect("a state");
    let error = run.start().expect_err("the hinge is 172° from its motor");
    assert!(
        matches!(error.cause, StepError::WrongBranch { .. }),
        "{error:?}"
    );
    assert!(error.to_string().contains("hinge0"), "{error}");
}

#[test]
fn a_motor_where_no_freedom_is_left_is_refused_by_name() {
    // A plane holds the slide that the motor drives: away from the motor's start, or there.
    for height in [Formula::Number(0.0), 0.3.into()] {
        let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
        let body = add_body(&mut scene, 1.0, &nalgebra::Matrix3::identity());
        let child = Place::Body(body, 0);
        add_joint(&mut scene, law("prismatic"), Place::World(0), child);
        let rod = JointLaw::PointOnPlane(Default::default());
        add_joint(&mut scene, rod, Place::World(0), child);
        scene.joints[0].forces = vec![motor(0, course())];
        let wall = add_frame(
            &mut scene,
            None,
            tests::mechanism::frame("wall", [0.0; 3], None),
        );
        scene.joints[1].parent = wall;
        scene.world_frames[1].position[2] = height;
        let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
        let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("options");
        let mut x = vec![0.0; 13];
        (x[2], x[3]) = (0.3, 1.0);
        run.set_state(0.0, &x).expect("a state");
        let error = run.start().expect_err("nothing is left to drive");
        println!("{error}");
        assert!(
            matches!(
                error.cause,
                StepError::SingularConstraints { .. } | StepError::InconsistentStart { .. }
            ),
            "{error:?}"
        );
        let text = error.to_string();
        let named = ["prismatic0", "point_on_plane1"];
        assert!(named.iter().any(|name| text.contains(name)), "{text}");
    }
}
