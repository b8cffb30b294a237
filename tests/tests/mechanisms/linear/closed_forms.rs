//! A, B, C, D, frequencies and damping against closed forms, and small deviations of a run against its linear system.

use mbd_runtime::{Options, Simulation, linearise, linearise_along, trim};
use mbd_scene::joints::JointForces;
use mbd_scene::{AngularVelocity, Formula, Input, Model, Quantity, Unit};
use nalgebra::{DMatrix, DVector};
use serde_json::Value;
use tests::assert_close;
use tests::declared::read;
use tests::mechanism::state;
use tests::reference::{field, load, numbers};
use tests::system::{bodies, list, scene};

use super::{
    DOUBLE_PENDULUM, assert_eigenvalues, assert_matrix, assert_point, assert_system, generic,
    placed, sprung_four_bar,
};

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
fn small_deviations_of_a_run_follow_the_linear_system() {
    // Both sides of the static equilibrium of the four-bar: what is even in the deviation drops out.
    let file = load("derivatives/linear_four_bar.json");
    let scene = sprung_four_bar(&file);
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
fn eigenvalues_that_lie_symmetrically_about_zero_are_found() {
    // m ẍ = k x + c ẏ, m ÿ = k y − c ẋ with k = 50, c = 10: λ² ± i c λ = k has λ = ±5 ± 5 i, where shifts of the plain iteration stand still.
    let model = generic(read(
        "model Whirl { gravity: none;
           point a { mass: 1 kg }
           load f on a = [50 N/m * a.position.x + 10 kg/s * a.velocity.y,
                          50 N/m * a.position.y - 10 kg/s * a.velocity.x, 0 N]; }",
    ));
    let space = linearise(&model, 0.0, &[0.0; 6], &[]).expect("a linear system");
    let found = space.vibrations();
    // √ of rounding: z moves freely.
    let mut whirl: Vec<[f64; 2]> = found
        .iter()
        .filter(|one| one.frequency() > 1e-3)
        .map(|one| [one.real, one.imaginary])
        .collect();
    assert_eq!(found.len(), 4, "{found:?}");
    whirl.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert_close(&whirl.concat(), &[-5.0, 5.0, 5.0, 5.0], 1e-12, 0.0, "whirl");
}

#[test]
fn every_eigenvalue_is_listed_where_several_are_zero() {
    // Three rods that swing, and a point whose drag depends on its velocity alone: its places are three zeros.
    let rods: String = (0..3)
        .map(|k| {
            let from = match k {
                0 => "world".to_owned(),
                _ => format!("b{}.t", k - 1),
            };
            format!(
                "body b{k} {{ mass: 1.9 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame r at [0, 0, 0.3] m, frame t at [0, 0, -0.3] m }}
                 joint j{k}: hinge from {from} to b{k}.r {{ axis: y, damping: 0.{}8 N*m*s }}\n",
                k + 1
            )
        })
        .collect();
    for speed in [0.64, 1.9, 3.3, 5.1] {
        let model = generic(read(&format!(
            "model Zeros {{ gravity: [0, 0, -9.81] m/s^2; {rods}
             point p {{ mass: 1.06 kg, start at [0, 5, 0] m velocity [6.04, 0, {speed}] m/s }}
             load drag on p = -0.2 kg/m * norm(p.velocity) * p.velocity; }}"
        )));
        let run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
        let space = linearise(&model, 0.0, run.state(), &[]).expect("a linear system");
        let found = space.vibrations();
        let counted: usize = found
            .iter()
            .map(|one| 1 + usize::from(one.imaginary > 0.0))
            .sum();
        assert_eq!(counted, space.a.nrows(), "{found:?}");
        let zeros = found.iter().filter(|one| one.frequency() < 1e-6).count();
        assert_eq!(zeros, 3, "{found:?}");
    }
}

#[test]
fn states_that_nothing_else_feels_take_part_in_their_own_eigenvalues_alone() {
    let model = generic(read(
        "model Lag { gravity: none;
           point a { mass: 1 kg }
           joint p: point_on_line from world to a { axis: x, stiffness: 100 N/m, damping: 1 N*s/m }
           state seen = 0 m/s { rate: 1 m/s^2 * sin(7 rad/s * time) }
           state lag = 0 m { rate: (a.position.x - lag) / (10 s) } }",
    ));
    let space = linearise(&model, 0.0, &[0.0; 8], &[]).expect("a linear system");
    let found = space.vibrations();
    let rates: Vec<f64> = found.iter().map(|one| one.frequency()).collect();
    assert_close(&rates, &[0.0, 0.1, 10.0], 1e-12, 0.0, "|λ|");
    for (one, name) in found.iter().zip(["seen", "lag"]) {
        let own = space.state(name).expect("a state");
        assert_close(&one.participation[own..=own], &[1.0], 1e-9, 0.0, name);
    }
    // The slide and its rate take part alike.
    assert_close(
        &found[2].participation[..2],
        &[0.5, 0.5],
        1e-9,
        0.0,
        "slide",
    );
}

#[test]
fn a_spring_of_zero_free_length_is_as_stiff_in_every_direction_where_its_ends_meet() {
    let text = "model Bushing {
        gravity: none;
        body mount { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2 }
        joint loose: free from world to mount.com;
        spring rubber from world to mount.com { free_length: 0 m, stiffness: 50 N/m }
        output pull = rubber.tension;
    }";
    for family in ["absolute", "relative"] {
        let text = text.replace("gravity", &format!("coordinates: {family}; gravity"));
        let model = generic(read(&text));
        let at = placed(&model, &[], &[]);
        let space = linearise(&model, 0.0, &at, &[]).expect("linear");
        // ω² = k/m = 25 along each axis; nothing holds the turns.
        let below = space.a.view((6, 0), (6, 6));
        let diagonal = [-25.0, -25.0, -25.0, 0.0, 0.0, 0.0];
        let want = DMatrix::from_diagonal(&DVector::from_row_slice(&diagonal));
        assert!((below - want).amax() < 1e-12, "{family}: {below}");
        // The tension itself, k |x|, has a kink there; the motion has none.
        assert!(space.kinks.iter().all(|kink| kink.of.name == "pull"));
    }
}

#[test]
fn what_has_no_direction_where_both_ends_of_a_spring_meet_is_told() {
    let told = |fields: &str| {
        let model = generic(read(&format!(
            "model Bushing {{
                gravity: none;
                point mount {{ mass: 2 kg }}
                spring rubber from world to mount {{ {fields} }}
            }}"
        )));
        let refused = linearise(&model, 0.0, &[0.0; 6], &[]).expect_err("no direction");
        assert!(refused.to_string().contains("`rubber`"), "{refused}");
        trim(&model).solve().map(|rest| rest.space.undamped)
    };
    // Damping is along the spring: at one place it damps no direction, and any. A rest it does not move.
    let undamped = told("free_length: 0 m, stiffness: 50 N/m, damping: 2 N*s/m");
    assert_eq!(undamped.expect("a rest"), ["rubber"]);
    assert_eq!(told("damping: 2 N*s/m").expect("a rest"), ["rubber"]);
    // The force of a free length pushes in any direction.
    told("free_length: 0.1 m, stiffness: 50 N/m").expect_err("no rest");
}
