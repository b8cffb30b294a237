//! Motions that time prescribes: frames of the world that move, under joints, lines and points, against jets, closed forms and energy.

use mbd_runtime::{Content, Generic, Options, Sampling, Simulation, StepError, Trajectory, model};
use mbd_scene::joints::JointLaw;
use mbd_scene::{AngularVelocity, Formula, Frame, Function, Layout, Model, Place, Quantity, Scene};
use nalgebra::{DMatrix, DVector};
use tests::agreement::agrees;
use tests::assert_close;
use tests::jet::Jet;
use tests::mechanism::{
    Instance, Seat, accelerations, add_body, add_external_loads, add_frame, add_joint, all_joints,
    empty, evaluate_in_time, inertia, jets, state,
};
use tests::random::Random;

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];

fn apply(function: Function, parts: Vec<Formula>) -> Formula {
    Formula::Apply(function, parts)
}

/// a + b sin(c t).
fn swing(a: f64, b: f64, c: f64) -> Formula {
    let angle = apply(Function::Mul, vec![c.into(), Formula::Time]);
    let wave = apply(
        Function::Mul,
        vec![b.into(), apply(Function::Sin, vec![angle])],
    );
    apply(Function::Add, vec![a.into(), wave])
}

/// A frame that goes round and turns about two axes.
fn carousel() -> Frame {
    let angle = |rate: f64| apply(Function::Mul, vec![rate.into(), Formula::Time]);
    let (yaw, roll) = (angle(1.3), swing(0.2, 0.7, 2.1));
    let of = |function: Function, angle: &Formula| apply(function, vec![angle.clone()]);
    let (sy, cy) = (of(Function::Sin, &yaw), of(Function::Cos, &yaw));
    let (sr, cr) = (of(Function::Sin, &roll), of(Function::Cos, &roll));
    let times = |a: &Formula, b: &Formula| apply(Function::Mul, vec![a.clone(), b.clone()]);
    let minus = |a: &Formula| apply(Function::Neg, vec![a.clone()]);
    let zero = Formula::Number(0.0);
    Frame {
        name: "carousel".to_owned(),
        position: [
            swing(0.3, 0.8, 1.7),
            swing(-0.1, 0.5, 2.9),
            apply(Function::Exp, vec![angle(-0.4)]),
        ],
        // Rz(yaw) Rx(roll)
        rotation: Some([
            [cy.clone(), minus(&times(&sy, &cr)), times(&sy, &sr)],
            [sy, times(&cy, &cr), minus(&times(&cy, &sr))],
            [zero, sr, cr],
        ]),
    }
}

/// Every joint between the carousel and a body, in either order, in both components.
fn everywhere(mut check: impl FnMut(&str, &Scene, &mut Random)) {
    let mut random = Random::new(71);
    for (law, _) in all_joints().into_iter().filter(|(law, _)| law.rows() > 0) {
        for components in COMPONENTS {
            for carousel_first in [true, false] {
                let mut scene = empty([0.3, -0.2, -9.81], components);
                let body = add_body(&mut scene, 1.7, &inertia(&mut random));
                let moving = add_frame(&mut scene, None, carousel());
                let seat = Seat::random(&mut random).declared("seat");
                let seat = add_frame(&mut scene, Some(body), seat);
                let [from, to] = match carousel_first {
                    true => [moving, seat],
                    false => [seat, moving],
                };
                add_joint(&mut scene, law.clone(), from, to);
                let name = format!("{law:?}, {components:?}, carousel first {carousel_first}");
                check(&name, &scene, &mut random);
            }
        }
    }
}

#[test]
fn rows_on_a_moving_frame_are_the_jets_of_their_positions() {
    everywhere(|name, scene, random| {
        for time in [0.0, 0.7, -2.3] {
            let body = Instance::random(random);
            let x = state(scene, &[body], &[]);
            let jets = jets(scene, &[body], &[]);
            let rows = evaluate_in_time(scene, Quantity::Constraint, Jet([time, 1.0, 0.0]), &jets);
            let part = |k: usize| rows.iter().map(|row| row.0[k]).collect::<Vec<f64>>();
            let rate = evaluate_in_time(scene, Quantity::ConstraintRate, time, &x);
            assert_close(&rate, &part(1), 1e-13, 1e-13, &format!("{name}: Φ̇"));
            let layout = Layout::new(scene);
            let dense = evaluate_in_time(scene, Quantity::ConstraintJacobian, time, &x);
            let columns = DMatrix::from_row_slice(layout.nc, layout.nv, &dense);
            let moved = columns * DVector::from_vec(accelerations(scene, &[body], &[]));
            let bias = evaluate_in_time(scene, Quantity::ConstraintBias, time, &x);
            let curve: Vec<f64> = moved.iter().zip(&bias).map(|(a, b)| a - b).collect();
            assert_close(&curve, &part(2), 1e-12, 1e-12, &format!("{name}: Φ̈"));
        }
    });
}

#[test]
fn the_power_of_the_drive_closes_the_balance_at_every_instant() {
    everywhere(|name, scene, random| {
        let mut scene = scene.clone();
        add_external_loads(&mut scene);
        let body = Instance::random(random);
        let x = state(&scene, &[body], &[]);
        let energy = evaluate_in_time(&scene, Quantity::Energy, 0.4, &x);
        let lambda = evaluate_in_time(&scene, Quantity::Multipliers, 0.4, &x);
        let slip = evaluate_in_time(&scene, Quantity::ConstraintRate, 0.4, &x);
        // dE/dt = (∂E/∂x) ẋ, with E as a function of the state alone.
        let rates = evaluate_in_time(&scene, Quantity::Derivative, 0.4, &x);
        let along: Vec<Jet> = x
            .iter()
            .zip(&rates)
            .map(|(x, rate)| Jet([*x, *rate, 0.0]))
            .collect();
        let moved = evaluate_in_time(&scene, Quantity::Energy, Jet([0.4, 1.0, 0.0]), &along);
        let change: f64 = moved[..3].iter().map(|part| part.0[1]).sum();
        let slipping: f64 = lambda.iter().zip(&slip).map(|(a, b)| a * b).sum();
        let power = energy[3] + energy[4] + energy[5] + slipping;
        let scale = energy[5].abs() + slipping.abs() + 1.0;
        assert!(
            (change - power).abs() < 1e-11 * scale,
            "{name}: {change:e} against {power:e}"
        );
    });
}

model! {
    /// A rod hung from a support that shakes sideways.
    pub model Shaken<T> {
        verify;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param reach = 0.2 m in 0 m ..= 1 m;
        param rate = 7.0 rad/s in 1 rad/s ..= 20 rad/s;
        world { frame support at [reach * sin(rate * time), 0.0, 0.1 * reach * cos(rate * time)] }
        body rod {
            mass: 1.3 kg,
            inertia: diag(0.118, 0.12, 0.004) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint pin: hinge from world.support to rod.top { axis: y }
        output lateral = world.support.velocity.x;
    }
}

model! {
    /// The same with the state in world components.
    pub model ShakenWorld {
        verify;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        angular_velocity: world;
        world { frame support at [0.2 m * sin(7 rad/s * time), 0.0, 0.02 m * cos(7 rad/s * time)] }
        body rod {
            mass: 1.3 kg,
            inertia: diag(0.118, 0.12, 0.004) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint pin: hinge from world.support to rod.top { axis: y }
    }
}

/// The angle of the rod from hanging and its rate, at `until`, by RK4 of the pendulum on a support at (u, w):
/// (I + m l²) θ̈ = −m l ((g + ẅ) sin θ + ü cos θ).
fn pendulum(time: f64, until: f64, start: [f64; 2]) -> [f64; 2] {
    let (m, l, i, g, a, b, c) = (1.3, 0.5, 0.12, 9.81, 0.2, 0.02, 7.0_f64);
    let rates = |t: f64, [angle, rate]: [f64; 2]| {
        let (u, w) = (-a * c * c * (c * t).sin(), -b * c * c * (c * t).cos());
        let (sin, cos) = angle.sin_cos();
        [rate, -m * l * ((g + w) * sin + u * cos) / (i + m * l * l)]
    };
    let steps = 40_000;
    let h = (until - time) / f64::from(steps);
    let along = |x: [f64; 2], k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
    let mut x = start;
    for n in 0..steps {
        let t = time + f64::from(n) * h;
        let k1 = rates(t, x);
        let k2 = rates(t + 0.5 * h, along(x, k1, 0.5 * h));
        let k3 = rates(t + 0.5 * h, along(x, k2, 0.5 * h));
        let k4 = rates(t + h, along(x, k3, h));
        for j in 0..2 {
            x[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
        }
    }
    x
}

/// The state of the rod for an angle from hanging (about −y, so that θ > 0 swings to +x); speeds are left to the consistent start.
fn hanging(time: f64, angle: f64, rate: f64) -> Vec<f64> {
    let (u, w) = (0.2 * (7.0 * time).sin(), 0.02 * (7.0 * time).cos());
    let (sin, cos) = angle.sin_cos();
    let (s, c) = (angle / 2.0).sin_cos();
    vec![
        u + 0.5 * sin,
        0.0,
        w - 0.5 * cos,
        c,
        0.0,
        -s,
        0.0,
        0.5 * cos * rate + 1.4 * (7.0 * time).cos(),
        0.0,
        0.5 * sin * rate - 0.14 * (7.0 * time).sin(),
        0.0,
        -rate,
        0.0,
    ]
}

fn angle_of(x: &[f64]) -> f64 {
    -2.0 * x[5].atan2(x[3])
}

#[test]
fn a_pendulum_on_a_shaken_support_follows_its_one_equation() {
    let shaken = Shaken::<f64>::new(Default::default()).expect("defaults");
    let world = ShakenWorld::new(Default::default()).expect("no params");
    let (time, until) = (0.37, 2.6);
    let want = pendulum(time, until, [0.8, -0.4]);
    let check = |x: &[f64], name: &str| {
        let (angle, rate) = (angle_of(x), -x[11]);
        println!(
            "{name}: {:e} rad, {:e} rad/s",
            angle - want[0],
            rate - want[1]
        );
        assert!((angle - want[0]).abs() < 1e-9, "{name}: {angle} {want:?}");
        assert!((rate - want[1]).abs() < 1e-8, "{name}: {rate} {want:?}");
    };
    let mut run = Simulation::new(&shaken, Options::tsit5(1e-12)).expect("options");
    run.set_state(time, &hanging(time, 0.8, -0.4))
        .expect("a state");
    run.run(until).expect("a run");
    check(run.state(), "body components");
    let mut run = Simulation::new(&world, Options::tsit5(1e-12)).expect("options");
    run.set_state(time, &hanging(time, 0.8, -0.4))
        .expect("a state");
    run.run(until).expect("a run");
    check(run.state(), "world components");
    let mut run = Simulation::new(&shaken, Options::rk4(5e-4)).expect("options");
    run.set_state(time, &hanging(time, 0.8, -0.4))
        .expect("a state");
    run.run(until).expect("a run");
    check(run.state(), "RK4");
    // Baumgarte's terms contain Φ̇ = Φ_v v + Φ_t: without Φ_t the rod would lag behind its support.
    let baumgarte = Options {
        stabilise: mbd_runtime::Stabilise::Baumgarte { alpha: 10.0 },
        ..Options::tsit5(1e-12)
    };
    let mut run = Simulation::new(&shaken, baumgarte).expect("options");
    run.set_state(time, &hanging(time, 0.8, -0.4))
        .expect("a state");
    run.run(until).expect("a run");
    check(run.state(), "Baumgarte");
}

#[test]
fn a_start_at_rest_takes_the_speed_of_its_support() {
    let shaken = Shaken::<f64>::new(Default::default()).expect("defaults");
    let mut x = hanging(0.9, 0.3, 0.0);
    x[7..].fill(0.0);
    let mut run = Simulation::new(&shaken, Options::tsit5(1e-8)).expect("options");
    run.set_state(0.9, &x).expect("a state");
    run.start().expect("a consistent start");
    let mut rate = [0.0; 5];
    run.evaluate(Quantity::ConstraintRate, &mut rate)
        .expect("rows");
    assert_close(&rate, &[0.0; 5], 0.0, 1e-15, "Φ̇ at the start");
    let mut outputs = [0.0];
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("outputs");
    assert!((outputs[0] - 1.4 * (7.0_f64 * 0.9).cos()).abs() < 1e-15);
}

#[test]
fn driven_scenes_agree_in_every_execution() {
    let shaken = Shaken::<f64>::new(Default::default()).expect("defaults");
    agrees(&shaken);
    let world = ShakenWorld::new(Default::default()).expect("no params");
    agrees(&world);
    let bead = Bead::<f64>::new(Default::default()).expect("no params");
    agrees(&bead);
    agrees(&Hammock::new(Default::default()).expect("no params"));
}

model! {
    /// A bead on a straight wire that turns in a horizontal plane, and a slider on the next one.
    pub model Bead<T> {
        verify;
        gravity: none;
        const SPEED = 3.0 rad/s;
        world {
            frame wire at [0.0, 0.0, 0.0] m rotated rpy(0.0, 0.0, SPEED * time),
            frame rail at [0.0, 0.0, 1.0] m rotated rpy(0.0, 0.0, SPEED * time),
        }
        point bead { mass: 0.4 kg }
        body slider { mass: 2.0 kg, inertia: diag(0.1, 0.2, 0.25) kg*m^2 }
        joint thread: point_on_line from world.wire to bead { axis: x }
        joint guide: prismatic from world.rail to slider.com { axis: x }
    }
}

#[test]
fn a_bead_on_a_turning_wire_flies_out_as_a_hyperbolic_cosine() {
    let model = Bead::<f64>::new(Default::default()).expect("no params");
    assert_eq!(model.layout().nc, 7);
    let options = Options {
        work: true,
        ..Options::tsit5(1e-12)
    };
    let mut run = Simulation::new(&model, options).expect("options");
    let (w, r) = (3.0, 0.5);
    let mut x = vec![0.0; 19];
    x[0] = r; // slider
    x[2] = 1.0;
    x[3] = 1.0;
    x[7] = r; // bead
    let nq = model.layout().nq;
    run.set_state(0.0, &x).expect("a state");
    run.start().expect("the wire gives the speeds");
    let start = run.state().to_vec();
    assert_close(&start[nq..nq + 3], &[0.0, w * r, 0.0], 0.0, 1e-14, "slider");
    assert_close(&start[nq + 5..nq + 6], &[w], 0.0, 1e-14, "turning slider");
    assert_close(&start[nq + 6..], &[0.0, w * r, 0.0], 0.0, 1e-14, "bead");
    let until = 1.1;
    run.run(until).expect("a run");
    let out = r * (w * until).cosh();
    let (s, c) = (w * until).sin_cos();
    let x = run.state().to_vec();
    assert_close(&x[..3], &[out * c, out * s, 1.0], 0.0, 1e-9, "slider");
    assert_close(&x[7..10], &[out * c, out * s, 0.0], 0.0, 1e-9, "bead");
    // The turning motion does all the work: ½ m (ṙ² + ω² r²) grows by m ω² r₀² sinh².
    let gain = 2.4 * (w * r * (w * until).sinh()).powi(2);
    let [loads, dampers, drives] = run.work().expect("asked for");
    assert_eq!((loads, dampers), (0.0, 0.0));
    assert!(
        (drives - gain).abs() < 1e-8 * gain,
        "{drives} against {gain}"
    );
}

model! {
    /// A point on a spring whose other end shakes along it, and one hung between a wall and a moving hook through a massless point.
    pub model Hammock {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world {
            frame hook at [1.0 m + 0.3 m * sin(4 rad/s * time), 0.2 m * sin(3 rad/s * time), 1.0 m],
            frame wall at [-1.0, 0.0, 1.2] m,
        }
        point knot { equilibrium: static }
        point lamp { mass: 2.0 kg }
        line left from world.wall to knot { free_length: 1.0 m, stiffness: 900 N/m }
        line right from knot to world.hook { free_length: 1.0 m, stiffness: 900 N/m }
        line cord from knot to lamp { free_length: 0.5 m, stiffness: 2 kN/m }
        line stay from world.hook to lamp {
            free_length: 0.9 m,
            stiffness: 50 N/m,
            damping: 3 N*s/m,
        }
        load air on lamp = -0.3 kg/s * lamp.velocity;
    }
}

#[test]
fn the_energy_balance_of_lines_on_moving_hooks_closes_with_the_work_of_the_drives() {
    let model = Hammock::new(Default::default()).expect("no params");
    let options = Options {
        work: true,
        ..Options::tsit5(1e-10)
    };
    let mut run = Simulation::new(&model, options).expect("options");
    run.set_state(0.2, &[0.1, 0.2, 0.3, 0.0, 0.5, 0.0])
        .expect("a state");
    run.set_nodes(&[0.0, 0.0, 0.8]).expect("a guess");
    let mut history = Trajectory::new(&model, Sampling::Every(0.05), Content::ALL);
    run.record(5.0, &mut history).expect("a run");
    let column = |name: &str| history.column(name).expect("a column");
    let drift = (0..history.len()).map(|i| {
        let works = ["loads", "dampers", "drives"].map(|kind| column(&format!("work.{kind}"))[i]);
        column("energy.total")[i] - works.iter().sum::<f64>() - column("energy.total")[0]
    });
    let drift = drift.fold(0.0_f64, |most, x| most.max(x.abs()));
    let [_, _, drives] = run.work().expect("asked for");
    println!("drift {drift:e} J of {drives} J");
    assert!(drives.abs() > 0.5, "{drives}");
    assert!(drift < 1e-6, "{drift:e}");
}

model! {
    /// A mass on a spring along x whose other end shakes.
    pub model Forced<T> {
        gravity: none;
        world { frame shaker at [0.1 m * sin(5 rad/s * time), 0.0, 0.0] }
        point mass { mass: 1.0 kg }
        spring coil from world.shaker to mass { free_length: 1.0 m, stiffness: 64 N/m }
    }
}

#[test]
fn a_spring_on_a_shaker_is_the_forced_oscillator() {
    let model = Forced::<f64>::new(Default::default()).expect("no params");
    let mut run = Simulation::new(&model, Options::tsit5(1e-12)).expect("options");
    run.set_state(0.0, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        .expect("a state");
    let (w0, w) = (8.0_f64, 5.0_f64);
    let b = 0.1 * w0 * w0 / (w0 * w0 - w * w);
    for time in [0.5, 1.7, 4.0] {
        run.run(time).expect("a run");
        let want = 1.0 + b * (w * time).sin() - b * w / w0 * (w0 * time).sin();
        assert!((run.state()[0] - want).abs() < 1e-9, "at {time}");
    }
    let single = Forced::<f32>::new(Default::default()).expect("no params");
    let mut run = Simulation::new(&single, Options::rk4(1e-3)).expect("options");
    run.set_state(0.0, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        .expect("a state");
    run.run(1.7).expect("a run");
    let want = 1.0 + b * (w * 1.7).sin() - b * w / w0 * (w0 * 1.7).sin();
    assert!((f64::from(run.state()[0]) - want).abs() < 1e-4);
}

#[test]
fn a_motion_that_ends_is_a_typed_error_not_a_panic() {
    // √(1 − t) has no value after one second.
    let gone = apply(
        Function::Sqrt,
        vec![apply(Function::Sub, vec![1.0.into(), Formula::Time])],
    );
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let body = add_body(&mut scene, 1.0, &nalgebra::Matrix3::identity());
    let frame = Frame {
        name: "gone".to_owned(),
        position: [gone, 0.0.into(), 0.0.into()],
        rotation: None,
    };
    let support = add_frame(&mut scene, None, frame);
    let law = JointLaw::Spherical(Default::default());
    add_joint(&mut scene, law, support, Place::Body(body, 0));
    let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("options");
    let mut x = vec![0.0; 13];
    (x[0], x[3]) = (1.0, 1.0);
    run.set_state(0.0, &x).expect("a state");
    let error = run.run(2.0).expect_err("the motion ends");
    println!("{error}");
    assert!(
        matches!(error.cause, StepError::NonFinite { .. }),
        "{error:?}"
    );
}

#[test]
fn a_frame_that_carries_a_rack_works_against_its_gear() {
    // x = r θ from a frame at s(t): m (r θ̈ + s̈) r + I θ̈ = 0, the rack pushes the block with F = m (r θ̈ + s̈), and the frame works with F ṡ.
    let declared = |family: &str| {
        format!(
            "model rack {{
                coordinates: {family};
                gravity: none;
                world {{ frame cart at [0.2 m * sin(3 rad/s * time), 0 m, 0 m] }}
                body wheel {{ mass: 1 kg, inertia: diag(0.3, 0.3, 0.3) kg*m^2 }}
                body block {{ mass: 2 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
                joint axle: hinge from world to wheel.com {{ axis: y }}
                joint rail: prismatic from world.cart to block.com {{ axis: x }}
                joint mesh: gear from axle.angle to rail.slide {{ ratio: 0.5 m }}
            }}"
        )
    };
    for family in ["absolute", "relative"] {
        let read = mbd_compiler::read_text(&declared(family));
        let scene = read.scene.unwrap_or_else(|| panic!("{:?}", read.errors));
        let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
        let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options");
        let mut history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
        run.record(2.0, &mut history).expect("a run");
        let power = history.column("power.drives").expect("a column");
        for (time, power) in history.times().iter().zip(power) {
            let (speed, curve) = (0.6 * (3.0 * time).cos(), -1.8 * (3.0 * time).sin());
            let spin = -2.0 * 0.5 * curve / (2.0 * 0.25 + 0.3);
            let force = 2.0 * (0.5 * spin + curve);
            assert!(
                (power - force * speed).abs() < 1e-9,
                "{family} at {time}: {power}"
            );
        }
    }
}
