//! Linear systems, trim and inverse dynamics of jointed scenes against closed forms, independent tools, and the runs themselves.

use mbd_compiler::{Equations, Interpreted};
use mbd_runtime::{
    Efforts, External, Generic, Linearisation, LinearisationError, Options, Simulation, StateSpace,
    TrimError, inverse_dynamics, linearise, linearise_along, trim,
};
use mbd_scene::joints::JointForces;
use mbd_scene::{AngularVelocity, Formula, Input, Model, Quantity, Scene, Unit};
use nalgebra::{DMatrix, DVector};
use serde_json::Value;
use tests::assert_close;
use tests::declared::read;
use tests::flights::Course;
use tests::implicit::Implicit;
use tests::looped::mechanism;
use tests::mechanism::{evaluate, state};
use tests::random::Random;
use tests::reference::{field, load, numbers};
use tests::system::{bodies, list, scene};

/// Inputs that stay.
struct Held(Vec<f64>);

impl External<f64> for Held {
    fn evaluate(&self, _: f64, _: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&self.0);
    }
}

fn generic(scene: Scene) -> Generic<f64> {
    Generic::with_defaults(scene).expect("defaults")
}

/// The state of a scene at joint coordinates.
fn placed(model: &Generic<f64>, inputs: &[f64], joints: &[(&str, f64)]) -> Vec<f64> {
    let held = Held(inputs.to_vec());
    let mut run = Simulation::with_loads(model, Options::rk4(1e-3), held).expect("options");
    run.set_joints(joints).expect("it can be placed");
    run.state().to_vec()
}

fn assert_matrix(got: &DMatrix<f64>, want: &Value, relative: f64, what: &str) {
    let want = DMatrix::from_row_slice(got.nrows(), got.ncols(), &numbers(want));
    let error = (got - &want).amax() / want.amax();
    assert!(error < relative, "{what}: {error:.1e}\n{got}{want}");
}

/// Real and imaginary parts of all eigenvalues, sorted.
fn eigenvalues(space: &StateSpace) -> Vec<[f64; 2]> {
    let mut all: Vec<[f64; 2]> = Vec::new();
    for one in space.vibrations() {
        all.push([one.real, one.imaginary]);
        if one.imaginary > 0.0 {
            all.push([one.real, -one.imaginary]);
        }
    }
    sorted(all)
}

fn sorted(mut all: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    // Rounding must not decide the order.
    let key = |x: &[f64; 2]| [(x[0] * 1e6).round(), (x[1] * 1e6).round()];
    all.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    all
}

fn assert_eigenvalues(space: &StateSpace, want: &Value, tolerance: f64, what: &str) {
    let want = list(want).iter().map(|pair| {
        let pair = numbers(pair);
        [pair[0], pair[1]]
    });
    let (got, want) = (eigenvalues(space), sorted(want.collect()));
    assert_eq!(got.len(), want.len(), "{what}");
    for (got, want) in got.iter().zip(&want) {
        let apart = (got[0] - want[0]).hypot(got[1] - want[1]);
        assert!(apart < tolerance, "{what}: {got:?} is not {want:?}");
    }
}

/// The linear system at a point of a reference, whose x0 are these coordinates: A, B and eigenvalues are those of the reference.
fn assert_point(
    model: &Generic<f64>,
    point: &Value,
    coordinates: [&str; 4],
    tolerance: f64,
) -> StateSpace {
    let name = point["name"].as_str().expect("a name");
    let (x, u) = (field(point, "x0"), field(point, "u0"));
    let place: Vec<(&str, f64)> = coordinates.into_iter().zip(x).collect();
    let at = placed(model, &u, &place);
    let space = linearise(model, 0.0, &at, &u).expect("linear");
    assert_system(&space, point, tolerance, name);
    space
}

fn assert_system(space: &StateSpace, point: &Value, tolerance: f64, name: &str) {
    assert_matrix(&space.a, &point["A"], 1e-10, name);
    assert_matrix(&space.b, &point["B"], 1e-10, name);
    assert_eigenvalues(space, &point["eigenvalues"], tolerance, name);
}

const DOUBLE_PENDULUM: &str = "model DoublePendulum {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    input first: torque; input second: torque;
    body upper { mass: 1.0 kg, inertia: diag(0.053333333333333344, 0.053333333333333344, 0.001) kg*m^2,
        frame top at [0.0, 0.0, 0.4] m, frame tip at [0.0, 0.0, -0.4] m }
    body lower { mass: 0.7 kg, inertia: diag(0.014583333333333332, 0.014583333333333332, 0.001) kg*m^2,
        frame top at [0.0, 0.0, 0.25] m }
    joint shoulder: hinge from world to upper.top { axis: y, force: first }
    joint elbow: hinge from upper.tip to lower.top { axis: y, force: second }
}";

#[test]
fn a_double_pendulum_has_the_matrices_and_frequencies_of_its_closed_form() {
    let file = load("derivatives/linear_double_pendulum.json");
    for components in ["body", "world"] {
        let text = DOUBLE_PENDULUM.replace(
            "gravity",
            &format!("angular_velocity: {components}; gravity"),
        );
        let model = generic(read(&text));
        for point in list(&file["points"]) {
            let want = [
                "shoulder.angle",
                "elbow.angle",
                "shoulder.angle_rate",
                "elbow.angle_rate",
            ];
            let space = assert_point(&model, point, want, 1e-9);
            let names: Vec<&str> = space.states.iter().map(|s| s.name.as_str()).collect();
            assert_eq!(names, want);
            let name = point["name"].as_str().expect("a name");
            assert_close(
                space.accelerations.as_slice(),
                &field(point, "vdot"),
                1e-11,
                1e-11,
                name,
            );
        }
    }
    // Shapes: at the lower frequency both swing the same way, at the higher against each other.
    let model = generic(read(DOUBLE_PENDULUM));
    let at = placed(&model, &[0.0; 2], &[]);
    let space = linearise(&model, 0.0, &at, &[0.0; 2]).expect("linear");
    let found = space.vibrations();
    let want = field(&list(&file["points"])[0], "eigenfrequencies_hz");
    for (vibration, (want, same)) in found.iter().zip(want.iter().zip([true, false])) {
        assert!((vibration.hertz() - want).abs() < 1e-10);
        assert!(vibration.damping().abs() < 1e-10);
        // Lower bar against the world.
        let [upper, lower] =
            [0, 1].map(|k| nalgebra::Complex::new(vibration.shape[k][0], vibration.shape[k][1]));
        let ratio = (upper + lower) / upper;
        assert!(ratio.im.abs() < 1e-6 && (ratio.re > 0.0) == same, "{ratio}");
    }
}

#[test]
fn a_cart_with_a_pole_has_the_matrices_of_its_closed_form_upright_hanging_and_moving() {
    let model = generic(read(
        "model CartPole {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input push: force;
            body cart { mass: 1.2 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame axle at [0.0, 0.0, 0.0] m }
            body pole { mass: 0.4 kg, inertia: diag(0.012, 0.012, 0.001) kg*m^2, frame foot at [0.0, 0.0, -0.3] m }
            joint track: prismatic from world to cart.com { axis: x, force: push }
            joint pin: hinge from cart.axle to pole.foot { axis: y }
        }",
    ));
    let file = load("derivatives/linear_cartpole.json");
    for point in list(&file["points"]) {
        // A double eigenvalue of zero is known to the root of rounding only.
        let coordinates = [
            "track.slide",
            "pin.angle",
            "track.slide_rate",
            "pin.angle_rate",
        ];
        assert_point(&model, point, coordinates, 1e-6);
    }
}

#[test]
fn a_four_bar_with_spring_has_the_matrices_and_frequency_of_its_closed_form() {
    let file = load("derivatives/linear_four_bar.json");
    for components in [AngularVelocity::Body, AngularVelocity::World] {
        let mut scene = scene(&file["system"], components);
        scene.inputs.push(Input {
            default: [0.0; 3],
            name: "torque".into(),
            doc: String::new(),
            components: 1,
            unit: Unit::default(),
        });
        scene.joints[0].forces.push(JointForces {
            stiffness: Some(5.0.into()),
            rest: Some(std::f64::consts::FRAC_PI_3.into()),
            damping: Some(0.1.into()),
            force: Some(Formula::Input(0)),
            ..JointForces::default()
        });
        let model = generic(scene.clone());
        for point in list(&file["points"]) {
            let name = point["name"].as_str().expect("a name");
            let own = &point["bodies"];
            let bodies = bodies(&own["r"], &own["quat"], &own["rdot"], &own["omega_world"]);
            let at = state(&scene, &bodies, &[]);
            let space = linearise(&model, 0.0, &at, &field(point, "u0")).expect("linear");
            assert_eq!(space.states[0].name, "hinge0.angle", "the crank");
            assert_system(&space, point, 1e-9, name);
            // The same motion in the angle of the rocker: the same eigenvalues.
            let space = linearise_along(&model, 0.0, &at, &field(point, "u0"), &["hinge2.angle"]);
            let space = space.expect("linear");
            assert_eq!(space.states[0].name, "hinge2.angle");
            if name == "equilibrium" {
                assert_eigenvalues(&space, &point["eigenvalues"], 1e-9, name);
            }
        }
    }
}

#[test]
fn the_same_four_bar_declared_in_a_plane_has_the_same_matrices() {
    let model = generic(read(
        "model FourBar {
            planar: xz;
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input torque: torque;
            world { frame pivot at [1.0, 0.0, 0.0] m }
            body crank { mass: 0.6 kg, inertia: diag(0.0001, 0.0045, 0.0045) kg*m^2,
                frame left at [-0.15, 0.0, 0.0] m, frame right at [0.15, 0.0, 0.0] m }
            body coupler { mass: 1.8 kg, inertia: diag(0.0001, 0.1215, 0.1215) kg*m^2,
                frame left at [-0.45, 0.0, 0.0] m, frame right at [0.45, 0.0, 0.0] m }
            body rocker { mass: 1.4 kg, inertia: diag(0.0001, 0.057166666666666664, 0.057166666666666664) kg*m^2,
                frame left at [-0.35, 0.0, 0.0] m, frame right at [0.35, 0.0, 0.0] m }
            joint a: hinge from world to crank.left { axis: y,
                stiffness: 5 N*m/rad, rest: -1.0471975511965979 rad, damping: 0.1 N*m*s, force: torque }
            joint b: hinge from crank.right to coupler.left { axis: y }
            joint c: hinge from world.pivot to rocker.left { axis: y }
            joint d: hinge from coupler.right to rocker.right { axis: y }
        }",
    ));
    let file = load("derivatives/linear_four_bar.json");
    for point in list(&file["points"]) {
        // Angles about y: against those of the reference.
        let angles = ["coupler_angle", "rocker_angle"].map(|name| -numbers(&point[name])[0]);
        let angles = [-field(point, "x0")[0], angles[0], angles[1]];
        let own = &point["bodies"];
        let (mut q, mut v) = (Vec::new(), Vec::new());
        for body in 0..3 {
            let [r, rdot, omega] =
                ["r", "rdot", "omega_world"].map(|name| numbers(&own[name][body]));
            q.extend([r[0], r[2], angles[body]]);
            v.extend([rdot[0], rdot[2], omega[1]]);
        }
        q.extend(v);
        let torque: Vec<f64> = field(point, "u0").iter().map(|torque| -torque).collect();
        let space = linearise(&model, 0.0, &q, &torque).expect("linear");
        assert_eq!(space.states[0].name, "a.angle");
        let name = point["name"].as_str().expect("a name");
        assert_matrix(&space.a, &point["A"], 1e-10, name);
        assert_matrix(&space.b, &point["B"], 1e-10, name);
    }
}

#[test]
fn a_quarter_car_has_the_matrices_frequencies_and_damping_of_its_closed_form() {
    let model = generic(read(
        "model QuarterCar {
            gravity: none;
            input road: length;
            body sprung { mass: 300.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
            body unsprung { mass: 40.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
            joint hub: prismatic from world to unsprung.com { axis: z, force: 180 kN/m * (road - hub.slide) }
            joint ride: prismatic from unsprung.com to sprung.com { axis: z, stiffness: 20 kN/m, damping: 1500 N*s/m }
            output travel = ride.slide;
            output tyre = hub.slide - road;
        }",
    ));
    let file = load("derivatives/linear_quarter_car.json");
    let point = &list(&file["points"])[0];
    let at = placed(&model, &[0.0], &[]);
    let along = ["sprung.z", "unsprung.z"];
    let space = linearise_along(&model, 0.0, &at, &[0.0], &along).expect("linear");
    assert_matrix(&space.a, &point["A"], 1e-12, "A");
    assert_matrix(&space.b, &point["B"], 1e-12, "B");
    let two = |name: &str| Value::from(list(&file["outputs"][name])[..2].to_vec());
    assert_matrix(&space.c, &two("C"), 1e-12, "C");
    assert_matrix(&space.d, &two("D"), 1e-12, "D");
    let found = space.vibrations();
    let (moduli, ratios) = (
        field(point, "eigenvalue_modulus_rad_s"),
        field(point, "damping_ratio"),
    );
    for (own, stored) in [(0, 2), (1, 0)] {
        assert!((found[own].frequency() - moduli[stored]).abs() < 1e-10);
        assert!((found[own].damping() - ratios[stored]).abs() < 1e-12);
    }
}

#[test]
fn robots_have_the_derivatives_of_an_independent_tool() {
    for robot in ["panda", "ur5"] {
        let file = load(&format!("derivatives/fd_{robot}.json"));
        let source = load(&format!("robots/robot_{robot}.json"));
        let mut scene = scene(&source["system"], AngularVelocity::Body);
        let count = scene.joints.len();
        for (index, joint) in scene.joints.iter_mut().enumerate() {
            scene.inputs.push(Input {
                default: [0.0; 3],
                name: format!("torque{index}"),
                doc: String::new(),
                components: 1,
                unit: Unit::default(),
            });
            joint.forces.push(JointForces {
                force: Some(Formula::Input(index)),
                ..JointForces::default()
            });
        }
        let coordinates = scene.joint_coordinates();
        let model = generic(scene);
        for (index, stored) in list(&file["states"]).iter().enumerate() {
            let (q, v, tau) = (field(stored, "q"), field(stored, "v"), field(stored, "tau"));
            let values = q.iter().zip(&v).flat_map(|(q, v)| [*q, *v]);
            let names = coordinates.iter().map(String::as_str);
            let place: Vec<(&str, f64)> = names.zip(values).collect();
            let at = placed(&model, &tau, &place);
            let space = linearise(&model, 0.0, &at, &tau).expect("linear");
            let block = |first: usize| space.a.view((count, first), (count, count)).into_owned();
            let name = format!("{robot}, state {index}");
            assert_matrix(&block(0), &stored["dvdot_dq"], 1e-10, &name);
            assert_matrix(&block(count), &stored["dvdot_dv"], 1e-10, &name);
            let b = space.b.rows(count, count).into_owned();
            assert_matrix(&b, &stored["dvdot_dtau"], 1e-10, &name);
            // And back: the torques from the accelerations.
            let wanted: Vec<(&str, f64)> = coordinates
                .iter()
                .step_by(2)
                .map(String::as_str)
                .zip(field(stored, "vdot"))
                .collect();
            let none = vec![0.0; count];
            let found = inverse_dynamics(&model, 0.0, &at, &none, &wanted).expect("efforts");
            assert_close(&found.efforts, &tau, 1e-11, 1e-11, &name);
        }
    }
}

/// A mechanism with an input along every joint coordinate.
fn with_efforts(seed: u64) -> (Scene, Vec<f64>, Vec<String>) {
    let (mut scene, state) = mechanism(seed);
    scene.loads.clear();
    let mut names = Vec::new();
    for joint in &mut scene.joints {
        let measured: Vec<_> = joint.law.measured().collect();
        for (coordinate, found) in measured.into_iter().enumerate() {
            scene.inputs.push(Input {
                default: [0.0; 3],
                name: format!("effort{}", names.len()),
                doc: String::new(),
                components: 1,
                unit: Unit::default(),
            });
            let force = Some(Formula::Input(names.len()));
            names.push(format!("{}.{}", joint.name, found.name));
            let mut known = joint.forces.iter_mut();
            match known.find(|forces| forces.coordinate == coordinate) {
                Some(forces) => forces.force = force,
                None => joint.forces.push(JointForces {
                    coordinate,
                    force,
                    ..JointForces::default()
                }),
            }
        }
    }
    (scene, state, names)
}

#[test]
fn efforts_found_for_accelerations_give_these_accelerations() {
    let (mut all, mut some) = (0, 0);
    for seed in 0..50 {
        let (scene, state, names) = with_efforts(seed);
        let model = generic(scene.clone());
        let none = vec![0.0; names.len()];
        let Ok(space) = linearise(&model, 0.0, &state, &none) else {
            panic!("mechanism {seed}");
        };
        let n = space.accelerations.len();
        let mut random = Random::new(seed);
        // All coordinates of joints among the minimal ones; then one of them alone, the others free.
        let own = |name: &&str| names.iter().any(|known| known == name);
        let chosen: Vec<&str> = space.states[..n].iter().map(|s| s.name.as_str()).collect();
        let chosen: Vec<&str> = chosen.iter().copied().filter(own).collect();
        let mut sets = vec![chosen.clone()];
        sets.extend(chosen.last().map(|last| vec![*last]));
        for set in sets.into_iter().filter(|set| !set.is_empty()) {
            match set.len() == n {
                true => all += 1,
                false => some += 1,
            }
            let wanted: Vec<(&str, f64)> = set
                .iter()
                .map(|name| (*name, random.uniform(-3.0, 3.0)))
                .collect();
            let Efforts {
                efforts,
                accelerations,
            } = inverse_dynamics(&model, 0.0, &state, &none, &wanted).expect("efforts");
            let mut inputs = none.clone();
            for ((name, _), effort) in wanted.iter().zip(&efforts) {
                let at = names
                    .iter()
                    .position(|known| known == name)
                    .expect("an input");
                inputs[at] = *effort;
            }
            let rates = evaluate(&scene, Quantity::Derivative, &state, &inputs, &[]);
            let speeds = &rates[model.layout().nq..];
            let size = speeds.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            let what = format!("mechanism {seed}, {set:?}");
            assert_close(speeds, &accelerations, 0.0, 1e-11 * size, &what);
            let measured = evaluate(&scene, Quantity::JointCoordinates, &state, &inputs, speeds);
            for (name, value) in &wanted {
                let at = names
                    .iter()
                    .position(|known| known == name)
                    .expect("measured");
                let got = measured[3 * at + 2];
                assert!(
                    (got - value).abs() < 1e-11 * size.max(10.0),
                    "{what}: {got} is not {value}"
                );
            }
        }
    }
    assert!(all >= 10 && some >= 30, "{all} whole, {some} in part");
}

#[test]
fn small_deviations_of_a_run_follow_the_linear_system() {
    // Both sides of the static equilibrium of the four-bar: what is even in the deviation drops out.
    let file = load("derivatives/linear_four_bar.json");
    let mut scene = scene(&file["system"], AngularVelocity::Body);
    scene.joints[0].forces.push(JointForces {
        stiffness: Some(5.0.into()),
        rest: Some(std::f64::consts::FRAC_PI_3.into()),
        damping: Some(0.1.into()),
        ..JointForces::default()
    });
    let model = generic(scene.clone());
    let point = &list(&file["points"])[0];
    let own = &point["bodies"];
    let at = state(
        &scene,
        &bodies(&own["r"], &own["quat"], &own["rdot"], &own["omega_world"]),
        &[],
    );
    let space = linearise(&model, 0.0, &at, &[]).expect("linear");
    let (time, small) = (0.4, 1e-4);
    let end = |side: f64| {
        let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options");
        let moved = DVector::from_column_slice(&at) + space.tangent.column(0) * (side * small);
        let mut moved = moved.as_slice().to_vec();
        for q in model.layout().quaternions() {
            let length = moved[q..q + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
            moved[q..q + 4].iter_mut().for_each(|x| *x /= length);
        }
        run.set_state(0.0, &moved).expect("a state");
        run.run(time).expect("it runs");
        let mut out = vec![0.0; model.layout().len(Quantity::JointCoordinates)];
        run.evaluate(Quantity::JointCoordinates, &mut out)
            .expect("coordinates");
        [out[0], out[1]]
    };
    let [plus, minus] = [end(1.0), end(-1.0)];
    let want = (space.a.clone() * time).exp().column(0).into_owned();
    for k in 0..2 {
        let got = (plus[k] - minus[k]) / (2.0 * small);
        assert!(
            (got - want[k]).abs() < 1e-6 * want.amax(),
            "{got} is not {}",
            want[k]
        );
    }
}

#[test]
fn a_kite_stands_where_wind_weight_and_line_balance() {
    let scene = read(
        "model Kite {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input lift: force; input drag: force;
            point kite { mass: 3.0 kg }
            line tether from world to kite { free_length: 100 m, stiffness: 5 kN/m }
            load wind on kite = [drag, 0 N, lift];
        }",
    );
    let model = generic(scene);
    let found = trim(&model)
        .input("lift", 900.0)
        .input("drag", 300.0)
        .guess("kite.x", 50.0)
        .guess("kite.y", 10.0)
        .guess("kite.z", 90.0)
        .solve()
        .expect("it stands");
    // The line points along the force, and is longer by what it pulls over its stiffness.
    let force = [300.0, 0.0, 900.0 - 3.0 * 9.81];
    let pull = f64::hypot(force[0], force[2]);
    let length = 100.0 + pull / 5000.0;
    for (name, force) in ["kite.x", "kite.y", "kite.z"].iter().zip(force) {
        let got = found.value(name).expect("a coordinate");
        assert!((got - length * force / pull).abs() < 1e-8, "{name}: {got}");
    }
    // And the lift that holds it at a height.
    let found = trim(&model)
        .input("drag", 300.0)
        .input("lift", 500.0)
        .free_input("lift")
        .guess("kite.x", 62.0)
        .fix("kite.z", 80.0)
        .solve()
        .expect("it stands");
    let (z, x) = (80.0, found.value("kite.x").expect("a coordinate"));
    let up = found.inputs[0] - 3.0 * 9.81;
    assert!((up / 300.0 - z / x).abs() < 1e-9, "{up} {x}");
}

const DRONE: &str = "model Drone {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    input f0: force; input f1: force; input f2: force; input f3: force;
    input wind: [speed; 3];
    body drone { mass: 1.5 kg, inertia: diag(0.02, 0.02, 0.04) kg*m^2,
        frame front at [0.2, 0.0, 0.0] m, frame left at [0.0, 0.2, 0.0] m,
        frame back at [-0.2, 0.0, 0.0] m, frame right at [0.0, -0.2, 0.0] m }
    joint fly: free from world to drone.com;
    load front on drone at front = f0 * drone.z;
    load left on drone at left = f1 * drone.z;
    load back on drone at back = f2 * drone.z;
    load right on drone at right = f3 * drone.z;
    load drag on drone at com = -0.3 N*s/m * (drone.com.velocity - wind);
}";

#[test]
fn a_quadrotor_hovers_with_a_quarter_of_its_weight_a_rotor_and_leans_into_the_wind() {
    let model = generic(read(DRONE));
    let hover = || {
        let all = (0..4).fold(trim(&model), |trim, k| trim.free_input(&format!("f{k}")));
        (0..4).fold(all, |trim, k| trim.input(&format!("f{k}"), 2.0))
    };
    let still = hover().solve().expect("it hovers");
    let quarter = 1.5 * 9.81 / 4.0;
    assert_close(&still.inputs[..4], &[quarter; 4], 1e-9, 0.0, "rotors");
    assert!(
        still.undecided.iter().any(|name| name.contains("drone.x")),
        "{:?}",
        still.undecided
    );
    assert_eq!(still.space.states.len(), 12);

    // Against a wind of 10 m/s along x: thrust = √((m g)² + (c w)²), leaning by atan(c w/m g).
    let windy = hover()
        .input("wind.x", 10.0)
        .hold("drone.turn_z")
        .solve()
        .expect("it hovers");
    let (weight, drag) = (1.5 * 9.81, 0.3 * 10.0);
    let thrust: f64 = windy.inputs[..4].iter().sum();
    assert!((thrust - f64::hypot(weight, drag)).abs() < 1e-8, "{thrust}");
    let q = &windy.state[3..7];
    let (z_x, z_z) = (
        2.0 * (q[1] * q[3] + q[0] * q[2]),
        1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]),
    );
    assert!((-z_x / z_z - drag / weight).abs() < 1e-8, "{z_x} {z_z}");
}

#[test]
fn a_wind_turbine_turns_at_a_constant_speed_under_the_torque_of_its_generator() {
    let model = generic(read(
        "model Turbine {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input generator: torque;
            input wind: speed;
            body rotor { mass: 2000.0 kg, inertia: diag(40000.0, 20000.0, 20000.0) kg*m^2 }
            joint shaft: hinge from world to rotor.com { axis: x,
                force: 400 N*s^2/m * (wind - 3.0 m * shaft.angle_rate) * wind - generator }
        }",
    ));
    let found = trim(&model)
        .input("wind", 12.0)
        .rate("shaft.angle", 2.0)
        .free_input("generator")
        .solve()
        .expect("it turns");
    let at = found
        .space
        .inputs
        .iter()
        .position(|name| name.name == "generator");
    let generator = found.inputs[at.expect("an input")];
    assert!(
        (generator - 400.0 * (12.0 - 6.0) * 12.0).abs() < 1e-6,
        "{generator}"
    );
    assert_eq!(found.value("shaft.angle_rate"), Some(2.0));
}

#[test]
fn a_linkage_is_trimmed_on_its_loop_and_what_cannot_balance_is_named() {
    let file = load("derivatives/linear_four_bar.json");
    let mut scene = scene(&file["system"], AngularVelocity::Body);
    scene.joints[0].forces.push(JointForces {
        stiffness: Some(5.0.into()),
        rest: Some(std::f64::consts::FRAC_PI_3.into()),
        damping: Some(0.1.into()),
        ..JointForces::default()
    });
    let own = &list(&file["points"])[1]["bodies"];
    let start = state(
        &scene,
        &bodies(&own["r"], &own["quat"], &own["rdot"], &own["omega_world"]),
        &[],
    );
    let model = generic(scene);
    let near = trim(&model).state(&start).guess("hinge0.angle", 0.8);
    let found = near.solve().expect("it rests");
    let want = field(&list(&file["points"])[0], "x0")[0];
    assert!((found.value("hinge0.angle").expect("the crank") - want).abs() < 1e-9);

    let held = trim(&model).state(&start).hold("hinge0.angle").solve();
    let Err(TrimError::Unbalanced {
        worst,
        residual,
        counts,
        ..
    }) = held
    else {
        panic!("{held:?}");
    };
    assert_eq!((worst.as_str(), counts), ("hinge0.angle", [0, 1]));
    assert!(residual.abs() > 1.0);
}

#[test]
fn names_that_are_not_there_and_coordinates_that_depend_are_told() {
    let model = generic(read(DOUBLE_PENDULUM));
    let at = placed(&model, &[0.0; 2], &[]);
    let unknown = linearise_along(&model, 0.0, &at, &[0.0; 2], &["elbow.angel"]);
    let text = unknown.expect_err("no such coordinate").to_string();
    assert!(
        text.contains("`elbow.angel`") && text.contains("elbow.angle"),
        "{text}"
    );
    let along = ["shoulder.angle", "elbow.angle", "lower.x"];
    let depends = linearise_along(&model, 0.0, &at, &[0.0; 2], &along);
    let name = "lower.x".to_owned();
    assert_eq!(
        depends.err(),
        Some(LinearisationError::DependentCoordinate { name })
    );
    let short = linearise(&model, 0.0, &at[1..], &[0.0; 2]);
    assert!(matches!(
        short,
        Err(LinearisationError::Length { expected: 26, .. })
    ));
    let unknown = trim(&model).free_input("third").solve();
    let text = unknown.expect_err("no such input").to_string();
    assert!(text.contains("first, second"), "{text}");
    // In single precision the answers are those of double precision for the rounded state.
    let single = Generic::<f32>::with_defaults(read(DOUBLE_PENDULUM)).expect("defaults");
    let rounded: Vec<f32> = at.iter().map(|x| *x as f32).collect();
    let space = linearise(&single, 0.0, &rounded, &[0.0; 2]).expect("linear");
    let want = linearise(&model, 0.0, &at, &[0.0; 2]).expect("linear");
    assert!((space.a - &want.a).amax() < 1e-5 * want.a.amax());
}

mbd_runtime::model! {
    /// A crank that moves a block through a rod: one loop.
    model Crank {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [partial];
        param rod_mass = 0.7 kg in 0.1 kg ..= 2.0 kg;
        input torque: torque;
        body crank { mass: 0.5 kg, inertia: diag(0.001, 0.01, 0.01) kg*m^2,
            frame axle at [-0.1, 0.0, 0.0] m, frame pin at [0.1, 0.0, 0.0] m }
        body rod { mass: rod_mass, inertia: diag(0.001, 0.05, 0.05) kg*m^2,
            frame big at [-0.3, 0.0, 0.0] m, frame small at [0.3, 0.0, 0.0] m }
        body block { mass: 1.2 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }
        joint main: hinge from world to crank.axle { axis: y, damping: 0.05 N*m*s, force: torque + 0.5 * lag }
        state lag = 0 N*m { rate: (torque - lag) / (50 ms) }
        joint big_end: hinge from crank.pin to rod.big { axis: y }
        joint small_end: spherical from rod.small to block.com;
        joint guide: prismatic from world to block.com { axis: x, stiffness: 40 N/m, rest: 0.7 m }
        output pull = block.velocity * 2.0 kg / 1.0 s;
    }
}

#[test]
fn derivatives_of_emitted_code_are_those_of_the_interpreter_to_the_bit_and_of_the_laws() {
    let crank = Crank::new(CrankParams::default()).expect("defaults");
    let scene = Crank::scene();
    let params = [0.7];
    let equations = Equations::trace_with_derivatives(&scene);
    let interpreted = Interpreted::from_equations(equations, &params).expect("defaults");
    let laws = Generic::new(scene, &params).expect("defaults");
    let place = [("main.angle", 0.4), ("main.angle_rate", 2.0)];
    let state = placed(&laws, &[1.5], &place);
    let at = mbd_scene::Arguments {
        state,
        inputs: vec![1.5],
        ..mbd_scene::Arguments::default()
    };
    let found = [&crank as &dyn Model<f64>, &interpreted, &laws].map(|model| {
        let mut linear = Linearisation::new(model.layout());
        let found = linear.evaluate(model, &at.at(), &mut model.work());
        found.expect("a regular position");
        [
            linear.state().values().to_vec(),
            linear.input().values().to_vec(),
            linear.parameter().values().to_vec(),
        ]
    });
    let [emitted, interpreted, by_laws] = &found;
    for ((emitted, interpreted), by_laws) in emitted.iter().zip(interpreted).zip(by_laws) {
        let size = by_laws.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert_eq!(emitted, interpreted, "generated and interpreted");
        let what = "generated and by the laws";
        assert_close(emitted, by_laws, 0.0, 1e-12 * size, what);
        assert!(size > 0.0);
    }
}

#[test]
fn derivatives_go_through_joints_and_nodes_together() {
    for (equilibrium, damping) in [("static", 0.0), ("rate", 8.0)] {
        let scene = read(&format!(
            "model Guyed {{
                gravity: [0.0, 0.0, -9.81] m/s^2;
                world {{ frame east at [2.0, 0.1, 0.0] m, frame low at [1.8, -0.6, -1.2] m }}
                body bar {{ mass: 2.0 kg, inertia: diag(0.17, 0.17, 0.01) kg*m^2,
                    frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m }}
                joint pin: hinge from world to bar.top {{ axis: y }}
                point knot {{ equilibrium: {equilibrium} }}
                line a from world.east to knot {{ free_length: 0.6 m, stiffness: 900 N/m, damping: {damping} N*s/m }}
                line b from world.low to knot {{ free_length: 0.5 m, stiffness: 700 N/m, damping: {damping} N*s/m }}
                line c from bar.tip to knot {{ free_length: 0.4 m, stiffness: 800 N/m, damping: {damping} N*s/m }}
                output pull = c.tension;
            }}"
        ));
        let model = generic(scene.clone());
        let layout = model.layout();
        let at = placed(&model, &[], &[("pin.angle", -0.3), ("pin.angle_rate", 0.8)]);
        let course = Course::new(&model, &at, &[1.2, -0.2, -0.5]).expect("a balance");
        let state = course.state.clone();
        let mut course = course;
        course.solve(0.0, &state).expect("a balance");
        let instant = course.instant(&state);
        let mut linear = Linearisation::new(layout);
        let found = linear.evaluate(&model, &instant.at(), &mut model.work());
        found.expect("a regular position");
        let [mut want, _] = Implicit::new(&scene, &[]).by_state(&instant);
        let mut got = linear.state().values().to_vec();
        let columns = layout.nx();
        for q in layout.quaternions() {
            for rows in [&mut got, &mut want] {
                for row in rows.chunks_exact_mut(columns) {
                    let radial: f64 = (q..q + 4).map(|k| row[k] * state[k]).sum();
                    (q..q + 4).for_each(|k| row[k] -= radial * state[k]);
                }
            }
        }
        let size = want.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert_close(&got, &want, 0.0, 1e-10 * size, equilibrium);
    }
}

/// L di/dt = u − R i − k ω, J dω/dt = k i − b ω: a motor on a flywheel.
const MOTOR: [f64; 5] = [2.0, 0.1, 0.5, 0.05, 0.02];

#[test]
fn a_motor_with_its_current_as_a_state_has_the_matrices_and_the_steady_speed_of_its_closed_form() {
    let [r, l, k, j, b] = MOTOR;
    // With a hinge the derivatives go through rows; a body that nothing holds turns about z by a couple.
    let hinged =
        "joint pin: hinge from world to rotor.com { axis: z, force: 0.5 * current, damping: 0.02 }";
    let loose = "joint fly: free from world to rotor.com; load turn on rotor = [0, 0, 0.5 * current - 0.02 * rotor.omega_world.z] N*m;";
    for (mechanics, speed, names) in [
        (
            hinged,
            "pin.angle_rate",
            ["pin.angle", "pin.angle_rate", "current"],
        ),
        (
            loose,
            "rotor.omega_world.z",
            ["rotor.turn_z", "rotor.omega_body_z", "current"],
        ),
    ] {
        let scene = read(&format!(
            "model Motor {{
                units: si;
                gravity: none;
                input u: number = 12;
                body rotor {{ mass: 1, inertia: diag(0.05, 0.05, 0.05) }}
                {mechanics}
                state current = 0.3 {{ rate: (u - 2 * current - 0.5 * {speed}) / 0.1 }}
                output heat = 2 * current^2;
            }}"
        ));
        let model = generic(scene.clone());
        let found = trim(&model).rate(names[0], 20.0).free_input("u").solve();
        let found = found.expect("a constant speed");
        // k i = b ω, u = R i + k ω.
        let current = b * 20.0 / k;
        let want = [current, r * current + k * 20.0];
        let got = ["current", "u"].map(|name| found.value(name).expect("a name"));
        assert_close(&got, &want, 0.0, 1e-12, "current and voltage");

        let space = &found.space;
        let at = names.map(|name| space.state(name).unwrap_or_else(|| panic!("{name}")));
        let a = DMatrix::from_fn(3, 3, |row, column| space.a[(at[row], at[column])]);
        let (resistance, drive) = (-r / l, k / j);
        let want = [0.0, 1.0, 0.0, 0.0, -b / j, drive, 0.0, -k / l, resistance];
        let want = DMatrix::from_row_slice(3, 3, &want);
        assert!((&a - &want).amax() < 1e-12 * want.amax(), "{a}");
        let by_input = at.map(|row| space.b[(row, 0)]);
        assert_close(&by_input, &[0.0, 0.0, 1.0 / l], 1e-13, 0.0, "B");
        let heat = space.c[(0, at[2])];
        assert!((heat - 2.0 * r * current).abs() < 1e-12, "{heat}");

        // At a held voltage the motor finds its speed by itself: nothing asks where it stands, only how fast.
        let bare = linearise(&model, 0.0, &found.state, &found.inputs).expect("linear");
        assert!(bare.accelerations.amax() < 1e-12, "{}", bare.accelerations);
    }
}

#[test]
fn a_trim_begins_at_the_declared_start_with_the_declared_inputs_and_settles_what_is_integrated() {
    // A pendulum under a controller that integrates its error: at rest it carries the load and the integral holds the torque.
    let text = "model Held {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input aim: angle = 2.4 rad;
        body arm { mass: 2.0 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
        joint pin: hinge from world to arm.top { axis: y, start: 2.3 rad,
            force: 30 N*m * (aim - pin.angle) - 6 N*m*s * pin.angle_rate + 20 N*m/s * missed }
        state missed = 0 rad*s { rate: aim - pin.angle }
    }";
    let model = generic(read(text));
    let found = trim(&model).solve().expect("it rests");
    let torque = 2.0 * 9.81 * 0.5 * 2.4_f64.sin();
    let got = ["pin.angle", "missed"].map(|name| found.value(name).expect("a name"));
    assert_close(&got, &[2.4, torque / 20.0], 1e-10, 0.0, "rest");
    assert!(found.space.vibrations().iter().all(|one| one.real < 0.0));
}
