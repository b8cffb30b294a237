//! Bodies without mass in relative coordinates: what they carry gives their joints an inertia, and where it does not, that is told.

use mbd_compiler::{Interpreted, read_text};
use mbd_runtime::scene::Scene;
use mbd_runtime::{
    Content, Float, Generic, Model, Options, Sampling, Scalar, Simulation, StepError, Trajectory,
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
