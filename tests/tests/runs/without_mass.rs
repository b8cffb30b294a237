//! Bodies without mass in relative coordinates: what they carry gives their joints an inertia, and where it does not, that is told.

use mbd_compiler::{Interpreted, read_text};
use mbd_runtime::scene::Scene;
use mbd_runtime::{
    Content, Float, Generic, LinearisationError, Model, Options, Sampling, Scalar, Simulation,
    StepError, Trajectory, inverse_dynamics, linearise,
};

/// A rod on a cross: two hinges with a body of this mass and inertia between them, or the joint that stands for both.
fn rod(coordinates: &str, joints: &str) -> Scene {
    let text = format!(
        "model Rod {{
            coordinates: {coordinates};
            gravity: [0, 0, -9.81] m/s^2;
            param m_cross = 0 kg in 0 kg ..= 1 kg;
            body rod {{ mass: 2 kg, inertia: diag(0.3, 0.2, 0.1) kg*m^2, frame top at [0, 0.1, 0.6] m }}
            {joints}
        }}"
    );
    let read = read_text(&text);
    read.scene
        .unwrap_or_else(|| panic!("{joints}: {:?}", read.errors))
}

const CROSS: &str = "body cross { mass: m_cross, inertia: diag(0, 0, 0) kg*m^2 (unchecked) }
    joint first: hinge from world to cross.com { axis: x, start: 0.4 rad, start_rate: 0.5 rad/s }
    joint second: hinge from cross.com to rod.top { axis: y, start: -0.7 rad, start_rate: 1.5 rad/s }
    output one = first.angle; output other = second.angle;";
const UNIVERSAL: &str = "joint both: universal from world to rod.top {
        axes: [x, y], angle1: { start: 0.4 rad, start_rate: 0.5 rad/s }, angle2: { start: -0.7 rad, start_rate: 1.5 rad/s } }
    output one = both.angle1; output other = both.angle2;";

/// Both angles every tenth of a second, and how much of the energy was lost or won [J].
fn swung<T: Scalar>(model: &dyn Model<T>, tolerance: f64) -> (Vec<f64>, f64) {
    let mut history = Trajectory::new(model, Sampling::Every(0.1), Content::ALL);
    let mut run = Simulation::new(model, Options::tsit5(tolerance)).expect("a model that runs");
    run.record(3.0, &mut history).expect("it swings");
    let column = |name| history.column(name).expect("a column").iter();
    let angles = column("one").chain(column("other"));
    let energy: Vec<f64> = column("energy.total").map(|x| x.to_f64()).collect();
    let lost = energy.iter().map(|now| (now - energy[0]).abs());
    (
        angles.map(|x| x.to_f64()).collect(),
        lost.fold(0.0, f64::max),
    )
}

fn close(one: &[f64], other: &[f64], bound: f64) {
    assert_eq!(one.len(), other.len());
    for (one, other) in one.iter().zip(other) {
        assert!((one - other).abs() < bound, "{one} {other}");
    }
}

#[test]
fn two_hinges_about_a_cross_without_mass_are_a_universal_joint() {
    let universal = Generic::<f64>::with_defaults(rod("absolute", UNIVERSAL)).expect("a joint");
    let (wanted, _) = swung(&universal, 1e-11);
    let cross = rod("relative", CROSS);
    let compiled = Interpreted::<f64>::new(cross.clone(), &[0.0]).expect("a cross");
    let generic = Generic::<f64>::with_defaults(cross.clone()).expect("a cross");
    for model in [&compiled as &dyn Model<f64>, &generic] {
        let (found, lost) = swung(model, 1e-11);
        close(&found, &wanted, 1e-8);
        assert!(lost < 1e-8, "{lost}");
    }
    let short = Generic::<f32>::with_defaults(cross).expect("a cross");
    close(&swung(&short, 1e-5).0, &wanted, 1e-3);
    // `auto` takes the family in which it can be computed.
    let auto = rod("auto", CROSS);
    assert_eq!(auto, rod("relative", CROSS));
}

#[test]
fn a_mass_that_goes_to_zero_is_the_limit() {
    let angles = |mass: f64| {
        let model = Interpreted::<f64>::new(rod("relative", CROSS), &[mass]).expect("a cross");
        swung(&model, 1e-11).0
    };
    // Its centre of mass does not move: only its moments would count, and it has none.
    close(&angles(0.5), &angles(0.0), 1e-12);
}

/// What is declared; panics with the messages where it is refused.
fn scene(text: &str) -> Scene {
    let read = read_text(text);
    read.scene
        .unwrap_or_else(|| panic!("{text}: {:?}", read.errors))
}

/// Outputs every tenth of a second until a time [s], in both executions of a scene.
fn outputs(scene: &Scene, until: f64) -> [Vec<f64>; 2] {
    let generic = Generic::<f64>::with_defaults(scene.clone()).expect("a scene");
    let params = generic.params().to_vec();
    let compiled = Interpreted::<f64>::new(scene.clone(), &params).expect("a scene");
    [&compiled as &dyn Model<f64>, &generic].map(|model| {
        let declared = Content {
            outputs: true,
            ..Content::TIME
        };
        let mut history = Trajectory::new(model, Sampling::Every(0.1), declared);
        let mut run = Simulation::new(model, Options::vern7(1e-11)).expect("a model that runs");
        run.record(until, &mut history).expect("it moves");
        let columns = 1..history.names().len();
        columns
            .flat_map(|column| history.values(column).to_vec())
            .collect()
    })
}

#[test]
fn what_acts_along_the_joints_of_a_cross_without_mass_acts_as_in_a_universal_joint() {
    let brake = "start: 0.4 rad, start_rate: 0.5 rad/s, damping: 0.2 N*m*s, friction: 0.5 N*m, friction_rate: 0.3 rad/s";
    let spring = "start: -0.7 rad, start_rate: 1.5 rad/s, stiffness: 3 N*m/rad, rest: 0.2 rad";
    let stop = "start: 0.4 rad, start_rate: 0.5 rad/s, stops: [none, 0.6 rad], stop_stiffness: 300 N*m/rad";
    let driven = "motor: 0.4 rad + 0.5 rad/s * time + 0.3 rad/s^2 * time^2";
    let free = "start: 0.2 rad";
    let gear = |one: &str, other: &str| {
        format!("joint teeth: gear from {one} to {other} {{ ratio: 2, offset: -1.5 rad }}")
    };
    let locks = |one: &str| {
        format!(
            "event held = time rises 0.5 s {{ lock: {one} }} event let_go = time rises 1 s {{ free: {one} }}"
        )
    };
    type Beside<'f> = &'f dyn Fn(&str, &str) -> String;
    let nothing: Beside<'_> = &|_, _| String::new();
    let cases: [(&str, &str, Beside<'_>); 5] = [
        (brake, spring, nothing),
        (stop, spring, nothing),
        (driven, spring, nothing),
        ("start: 0.4 rad", "start: about -0.7 rad", &|one, other| {
            gear(one, other)
        }),
        (brake, free, &|one, _| locks(one)),
    ];
    for (first, second, beside) in cases {
        let joints = format!(
            "joint both: universal from world to rod.top {{ axes: [x, y], angle1: {{ {first} }}, angle2: {{ {second} }} }}
             {} output one = both.angle1; output other = both.angle2; output holds = both.force;",
            beside("both.angle1", "both.angle2")
        );
        let [wanted, _] = outputs(&rod("relative", &joints), 2.0);
        let joints = format!(
            "body cross {{ mass: m_cross, inertia: diag(0, 0, 0) kg*m^2 (unchecked) }}
             joint first: hinge from world to cross.com {{ axis: x, {first} }}
             joint second: hinge from cross.com to rod.top {{ axis: y, {second} }}
             {} output one = first.angle; output other = second.angle; output holds = first.force;",
            beside("first.angle", "second.angle")
        );
        for found in outputs(&rod("relative", &joints), 2.0) {
            close(&found, &wanted, 1e-7);
        }
    }
}

#[test]
fn a_coupler_without_mass_keeps_two_bars_at_a_distance_wherever_its_loop_is_declared() {
    let bars = |joints: &str| {
        scene(&format!(
            "model Bars {{ coordinates: relative; planar: xz; gravity: [0, 0, -9.81] m/s^2;
                world {{ frame right at [2, 0, 0] m }}
                body crank {{ mass: 1 kg, inertia: 0.1 kg*m^2, frame root at [-0.5, 0, 0] m, frame tip at [0.5, 0, 0] m }}
                body rocker {{ mass: 2 kg, inertia: 0.3 kg*m^2, frame root at [-0.75, 0, 0] m, frame tip at [0.75, 0, 0] m }}
                {joints}
                output one = first.angle; output other = third.angle; output speed = rocker.velocity; }}"
        ))
    };
    let cranks = [
        "joint first: hinge from world to crank.root { axis: y, start: -1.2 rad, start_rate: 1 rad/s }",
        "joint third: hinge from world.right to rocker.root { axis: y, start: about -1.5 rad }",
    ];
    let rod = "joint between: distance from crank.tip to rocker.tip { length: 2 m }";
    let [wanted, _] = outputs(&bars(&format!("{rod} {} {}", cranks[0], cranks[1])), 2.0);
    let coupler = "body coupler { mass: 0 kg, inertia: 0 kg*m^2 (unchecked), frame left at [-1, 0, 0] m, frame right at [1, 0, 0] m }";
    let pins = [
        "joint second: hinge from crank.tip to coupler.left { axis: y, start: about 0.8 rad }",
        "joint fourth: hinge from coupler.right to rocker.tip { axis: y }",
    ];
    let joints = [cranks[0], pins[0], cranks[1], pins[1]];
    for order in [[0, 1, 2, 3], [0, 2, 1, 3], [2, 3, 0, 1], [2, 0, 3, 1]] {
        let joints = order.map(|joint| joints[joint]).join(" ");
        for found in outputs(&bars(&format!("{coupler} {joints}")), 2.0) {
            close(&found, &wanted, 1e-7);
        }
    }
}

#[test]
fn a_mass_on_a_slide_of_an_arm_without_mass_is_a_point_on_a_spring() {
    let in_plane = |rest: &str| {
        scene(&format!(
            "model Swing {{ coordinates: relative; planar: xz; gravity: [0, 0, -9.81] m/s^2; {rest} }}"
        ))
    };
    let [wanted, _] = outputs(
        &in_plane(
            "point bob { mass: 1 kg, start at [-1 m * sin(0.5 rad), 0 m, -1 m * cos(0.5 rad)] }
             spring band from world to bob { free_length: 0.9 m, stiffness: 100 N/m }
             output x = bob.position.x; output z = bob.position.z;",
        ),
        2.0,
    );
    // In a plane one number is the moment, whatever stands behind it.
    let arm = in_plane(
        "body arm { mass: 0 kg, inertia: 0 kg*m^2 (unchecked) }
         body bob { mass: 1 kg, inertia: 0 kg*m^2 (unchecked) }
         joint pin: hinge from world to arm.com { axis: y, start: 0.5 rad }
         joint slide: prismatic from arm.com to bob.com { axis: z, start: -1 m, stiffness: 100 N/m, rest: -0.9 m }
         output x = bob.position.x; output z = bob.position.z;",
    );
    for found in outputs(&arm, 2.0) {
        close(&found, &wanted, 1e-8);
    }
}

#[test]
fn what_a_run_refuses_for_its_inertia_has_no_linear_system() {
    // Below the arm the rod adds too little to its moments, which are negative.
    let bars = scene(
        "model Bars { coordinates: relative; gravity: [0, 0, -9.81] m/s^2;
            body arm { mass: 1 kg, inertia: diag(-0.2, -0.2, -0.2) kg*m^2 (unchecked), frame top at [0, 0, 0.3] m, frame tip at [0, 0, -0.3] m }
            body rod { mass: 0.3 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2, frame top at [0, 0, 0.3] m }
            joint first: hinge from world to arm.top { axis: y, start: 1 rad }
            joint second: hinge from arm.tip to rod.top { axis: y } }",
    );
    let bars = Generic::<f64>::with_defaults(bars).expect("a scene");
    let mut run = Simulation::new(&bars, Options::tsit5(1e-6)).expect("a model");
    let state = run.state().to_vec();
    let told = run.run(1.0).expect_err("a negative inertia").cause;
    assert!(matches!(told, StepError::NoInertia { .. }), "{told}");
    let wanted = LinearisationError::Inertia(Box::new(told));
    let space = linearise(&bars, 0.0, &state, &[][..]).expect_err("it has none");
    assert_eq!(space, wanted);
    let given = [("first.angle", 2.0)];
    let efforts = inverse_dynamics(&bars, 0.0, &state, &[][..], &given);
    assert_eq!(efforts.expect_err("the second moves by nothing"), wanted);
    // Where all accelerations are given, forces follow from masses of any sign.
    let given = [("first.angle", 2.0), ("second.angle", 0.0)];
    let efforts = inverse_dynamics(&bars, 0.0, &state, &[][..], &given).expect("both");
    // Both turn as one about the pin: moments −0.2 + 1·0.3² and 0.01 + 0.3·0.9², gravity at levers 0.3 and 0.9.
    let inertia = -0.2 + 0.09 + 0.01 + 0.3 * 0.81;
    let pull = 9.81 * (0.3 + 0.3 * 0.9) * 1.0_f64.sin();
    let wanted = 2.0 * inertia + pull;
    assert!((efforts.efforts[0] - wanted).abs() < 1e-12, "{efforts:?}");
}

#[test]
fn a_run_that_comes_to_where_an_inertia_vanishes_ends_there_by_name() {
    // The moment of the arm is −0.05 about its pin, what the rod adds 0.3·0.6² where it stands across, and 0.03 in line.
    let bars = scene(
        "model Bars { coordinates: relative; gravity: [0, 0, -9.81] m/s^2;
            body arm { mass: 1 kg, inertia: diag(-0.14, -0.14, -0.14) kg*m^2 (unchecked), frame top at [0, 0, 0.3] m, frame tip at [0, 0, -0.3] m }
            body rod { mass: 0.3 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2, frame top at [0, 0, 0.3] m }
            joint first: hinge from world to arm.top { axis: y, start: 0.2 rad }
            joint second: hinge from arm.tip to rod.top { axis: y, start: 1.5 rad } }",
    );
    // Of its inertia D = 0.108 (1 − 0.027/0.037 cos² α) − 0.05 nothing is left at this angle between the two.
    let lost = ((1.0 - 0.05 / 0.108) * 0.037 / 0.027_f64).sqrt().acos();
    let bars = Generic::<f64>::with_defaults(bars).expect("a scene");
    for options in [
        Options::tsit5(1e-8),
        Options::vern7(1e-9),
        Options::rodas5p(1e-6),
    ] {
        let mut run = Simulation::new(&bars, options).expect("a model");
        let told = run.run(3.0).expect_err("an inertia vanishes").cause;
        assert!(matches!(told, StepError::NoInertia { .. }), "{told}");
        assert!(run.time() > 0.2, "{}", run.time());
        let angle = run.state()[1].abs();
        assert!((angle - lost).abs() < 1e-6, "{angle} {lost}");
    }
}

#[test]
fn where_nothing_gives_an_inertia_the_speed_is_named() {
    let alike = CROSS.replace("axis: x", "axis: y");
    let model = Generic::<f64>::with_defaults(rod("relative", &alike)).expect("a scene");
    let mut run = Simulation::new(&model, Options::tsit5(1e-6)).expect("a model");
    let told = run.run(1.0).expect_err("two hinges about one axis");
    match told.cause {
        StepError::NoInertia { speed, .. } => assert_eq!(speed, "second.angle_rate"),
        other => panic!("{other:?}"),
    }
    // In absolute coordinates the cross would have six speeds of its own.
    let read = read_text(
        "model Rod { gravity: none;
            body a { mass: 0 kg, inertia: diag(1, 1, 1) kg*m^2 (unchecked) }
            body b { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
            joint first: hinge from world to a.com { axis: x }
            joint second: hinge from a.com to b.com { axis: y } }",
    );
    let told = format!("{:?}", read.errors);
    assert!(told.contains("body `a` has no mass"), "{told}");
    let checked = read_text(
        "model Rod { coordinates: relative; gravity: none; body a { mass: 0 kg, inertia: diag(1, 1, 1) kg*m^2 }
            joint first: hinge from world to a.com { axis: x } }",
    );
    assert!(checked.scene.is_none());
}

#[test]
fn a_loop_that_is_closed_by_rows_on_a_body_without_mass_is_told_with_the_joint_and_the_body() {
    let cause = |joints: &str| {
        let scene = scene(&format!(
            "model Bars {{ coordinates: relative; planar: xz; gravity: [0, 0, -9.81] m/s^2;
                world {{ frame right at [2, 0, 0] m }}
                body crank {{ mass: 1 kg, inertia: 0.1 kg*m^2, frame root at [-0.5, 0, 0] m, frame tip at [0.5, 0, 0] m }}
                body rocker {{ mass: 2 kg, inertia: 0.3 kg*m^2, frame root at [-0.75, 0, 0] m, frame tip at [0.75, 0, 0] m }}
                body coupler {{ mass: 0 kg, inertia: 0 kg*m^2 (unchecked), frame left at [-1, 0, 0] m, frame right at [1, 0, 0] m }}
                joint first: hinge from world to crank.root {{ axis: y, start: -1.2 rad }}
                joint second: hinge from crank.tip to coupler.left {{ axis: y, start: about 0.8 rad }}
                joint third: hinge from world.right to rocker.root {{ axis: y, start: about -1.5 rad }}
                {joints} }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("a scene");
        let mut run = Simulation::new(&model, Options::tsit5(1e-6)).expect("a model");
        run.run(1.0).expect_err("no inertia").cause
    };
    for joints in [
        "loop joint fourth: hinge from coupler.right to rocker.tip { axis: y }",
        "joint fourth: distance from coupler.right to rocker.tip { length: 0.2 m }",
        "joint fourth: hinge from coupler.right to rocker.tip { axis: y }
         event off = time rises 3 s { detach: fourth }",
    ] {
        let cause = cause(joints);
        let StepError::NoInertia { speed, loops, .. } = &cause else {
            panic!("{cause:?}");
        };
        assert_eq!(speed, "second.angle_rate");
        assert_eq!(loops, &[["fourth".to_owned(), "coupler".to_owned()]]);
        let told = cause.to_string();
        assert!(
            told.contains("`fourth` closes a loop on `coupler` by rows"),
            "{told}"
        );
    }
}
