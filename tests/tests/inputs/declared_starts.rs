//! Starts that a declaration says: where a run begins without being told, in every form of a scene.

use mbd_compiler::{Interpreted, read_toml, write_toml};
use mbd_runtime::{Generic, Options, Simulation, StartNumber, StepError, model};
use mbd_scene::{Coordinates, Layout, Quantity, Scene, StartFrom, declared_parts, place_declared};
use tests::assert_close;
use tests::declared::read;

model! {
    /// A pendulum that starts tilted.
    pub model Pendulum<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param tilt = 30 deg in -90 deg ..= 90 deg;
        body bob {
            mass: 2 kg,
            inertia: diag(0.1, 0.1, 0.01) kg*m^2,
            frame top at [0.0, 0.0, 1.0] m,
        }
        joint pin: hinge from world to bob.top { axis: y, start: tilt, start_rate: 0.5 rad/s }
        output swing = pin.angle;
        output rate = pin.angle_rate;
    }
}

const PENDULUM: &str = "model Pendulum {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    param tilt = 30 deg in -90 deg ..= 90 deg;
    body bob { mass: 2 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 1.0] m }
    joint pin: hinge from world to bob.top { axis: y, start: tilt, start_rate: 0.5 rad/s }
    output swing = pin.angle;
    output rate = pin.angle_rate;
}";

/// The outputs at the start of a run, and how far the start moved anything [m].
pub(crate) fn begun(mut simulation: Simulation<f64>) -> (Vec<f64>, f64) {
    simulation.start().expect("a consistent start");
    let mut outputs = vec![0.0; simulation.model().layout().columns];
    let outputs_of = Quantity::Outputs;
    simulation
        .evaluate(outputs_of, &mut outputs)
        .expect("outputs");
    let moved = simulation.start_moved().iter().map(|moved| moved.distance);
    (outputs, moved.fold(0.0, f64::max))
}

pub(crate) fn begun_as_declared(scene: &Scene) -> (Vec<f64>, f64) {
    let params: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let model = Generic::new(scene.clone(), &params).expect("declared params");
    begun(Simulation::new(&model, Options::rk4(1e-3)).expect("a start"))
}

#[test]
fn a_pendulum_asked_for_thirty_degrees_starts_at_thirty_degrees_in_every_form() {
    let wanted = [30f64.to_radians(), 0.5];
    let model = Pendulum::<f64>::new(PendulumParams::default()).expect("declared params");
    let (found, moved) = begun(Simulation::new(&model, Options::rk4(1e-3)).expect("a start"));
    assert_close(&found, &wanted, 1e-15, 0.0, "generated");
    assert!(moved < 1e-15, "{moved}");
    let scene = read(PENDULUM);
    let again = read_toml(&write_toml(&scene)).scene.expect("written by us");
    assert_eq!(scene, again);
    for scene in [&scene, &again] {
        assert_close(&begun_as_declared(scene).0, &wanted, 1e-15, 0.0, "read");
    }
    let interpreted = Interpreted::new(scene, &[wanted[0]]).expect("declared params");
    let simulation = Simulation::new(&interpreted, Options::rk4(1e-3)).expect("a start");
    assert_close(&begun(simulation).0, &wanted, 1e-15, 0.0, "interpreted");
    let single = Pendulum::<f32>::new(PendulumParams::default()).expect("declared params");
    let mut simulation = Simulation::new(&single, Options::rk4(1e-3)).expect("a start");
    let mut found = [0f32; 2];
    let outputs = mbd_scene::Quantity::Outputs;
    simulation.evaluate(outputs, &mut found).expect("outputs");
    assert_close(&found.map(f64::from), &wanted, 1e-6, 0.0, "f32");
}

#[test]
fn a_generated_model_has_a_start_with_its_joint_coordinates() {
    let model = Pendulum::<f64>::new(PendulumParams::default()).expect("declared params");
    let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
    let start = PendulumStart {
        pin_angle: Some(0.25),
        ..PendulumStart::default()
    };
    assert_eq!(start.joints(), [("pin.angle", 0.25)]);
    simulation.set_joints(&start.joints()).expect("a pendulum");
    simulation.set_pin_angle(0.125).expect("a pendulum");
    simulation.set_pin_angle(0.25).expect("the last word");
    assert_close(&begun(simulation).0, &[0.25, 0.5], 1e-15, 0.0, "set");
}

model! {
    /// A four-bar: bars of 1, 2 and 2 m, pivots 2 m apart.
    pub model Linkage {
        gravity: [0.0, -9.81, 0.0] m/s^2;
        world { frame far at [2.0, 0.0, 0.0] m }
        body crank {
            mass: 1 kg,
            inertia: diag(0.1, 0.1, 0.1) kg*m^2,
            frame root at [-0.5, 0.0, 0.0] m,
            frame tip at [0.5, 0.0, 0.0] m,
        }
        body coupler {
            mass: 1 kg,
            inertia: diag(0.1, 0.1, 0.1) kg*m^2,
            frame root at [-1.0, 0.0, 0.0] m,
            frame tip at [1.0, 0.0, 0.0] m,
        }
        body rocker {
            mass: 1 kg,
            inertia: diag(0.1, 0.1, 0.1) kg*m^2,
            frame root at [-1.0, 0.0, 0.0] m,
            frame tip at [1.0, 0.0, 0.0] m,
        }
        joint motor: hinge from world to crank.root { axis: z }
        joint knee: hinge from crank.tip to coupler.root { axis: z }
        joint hip: hinge from world.far to rocker.root { axis: z }
        joint close: hinge from coupler.tip to rocker.tip { axis: z }
        output crank_angle = motor.angle;
        output crank_rate = motor.angle_rate;
        output rocker_angle = hip.angle;
    }
}

model! {
    /// The same in relative coordinates.
    pub model Tree {
        coordinates: relative;
        gravity: [0.0, -9.81, 0.0] m/s^2;
        world { frame far at [2.0, 0.0, 0.0] m }
        body crank {
            mass: 1 kg,
            inertia: diag(0.1, 0.1, 0.1) kg*m^2,
            frame root at [-0.5, 0.0, 0.0] m,
            frame tip at [0.5, 0.0, 0.0] m,
        }
        body coupler {
            mass: 1 kg,
            inertia: diag(0.1, 0.1, 0.1) kg*m^2,
            frame root at [-1.0, 0.0, 0.0] m,
            frame tip at [1.0, 0.0, 0.0] m,
        }
        body rocker {
            mass: 1 kg,
            inertia: diag(0.1, 0.1, 0.1) kg*m^2,
            frame root at [-1.0, 0.0, 0.0] m,
            frame tip at [1.0, 0.0, 0.0] m,
        }
        joint motor: hinge from world to crank.root { axis: z }
        joint knee: hinge from crank.tip to coupler.root { axis: z }
        joint hip: hinge from world.far to rocker.root { axis: z }
        joint close: hinge from coupler.tip to rocker.tip { axis: z }
        output crank_angle = motor.angle;
        output crank_rate = motor.angle_rate;
        output rocker_angle = hip.angle;
    }
}

/// The tips meet where circles of 2 m about (0, 1) and (2, 0) cross, below: (1, 1/2) − √(4 − 5/4) (1, 2)/√5.
fn rocker_below() -> f64 {
    let reach = (4.0f64 - 1.25).sqrt() / 5f64.sqrt();
    (0.5 - 2.0 * reach).atan2(-1.0 - reach)
}

#[test]
fn joints_of_a_compiled_model_are_set_one_by_one_and_hold_together() {
    let quarter = 90f64.to_radians();
    // Both families have the same setters, each a trait of its model.
    macro_rules! holds {
        ($model:ident, $params:ident, $joints:ident) => {
            let model = $model::new($params::default()).expect("no params");
            let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
            $joints::set_motor_angle(&mut run, quarter).expect("one freedom");
            $joints::set_motor_angle_rate(&mut run, 2.0).expect("its rate");
            $joints::set_hip_angle(&mut run, StartNumber::About(-2.0)).expect("a branch");
            let said = run.state().to_vec();
            let refused =
                $joints::set_knee_angle(&mut run, 1.0).expect_err("decided by the others");
            let StepError::Unplaced { name, why } = &refused.cause else {
                panic!("{refused}");
            };
            assert!(
                name == "close" && why.contains("stays open by"),
                "{refused}"
            );
            assert_eq!(run.state(), said, "what is refused changes nothing");
            let (found, moved) = begun(run);
            let want = [quarter, 2.0, rocker_below()];
            assert_close(&found, &want, 1e-9, 0.0, stringify!($model));
            assert!(moved < 1e-9);
        };
    }
    holds!(Linkage, LinkageParams, LinkageJoints);
    holds!(Tree, TreeParams, TreeJoints);
}

#[test]
fn other_params_start_elsewhere_until_a_state_is_set_or_run() {
    let model = Pendulum::<f64>::new(PendulumParams::default()).expect("declared params");
    let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
    simulation.set_params(&[0.25]).expect("within its range");
    let mut found = [0.0; 2];
    simulation
        .evaluate(mbd_scene::Quantity::Outputs, &mut found)
        .expect("outputs");
    assert_close(&found, &[0.25, 0.5], 1e-15, 0.0, "a new start");
    simulation.set_params(&[0.75]).expect("within its range");
    simulation
        .evaluate(mbd_scene::Quantity::Outputs, &mut found)
        .expect("outputs");
    assert_close(&found, &[0.25, 0.5], 1e-15, 0.0, "the same run");
}

#[test]
fn other_params_leave_a_restored_state_where_it_is() {
    let model = Pendulum::<f64>::new(PendulumParams::default()).expect("declared params");
    let new = || Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
    let mut first = new();
    first.run(0.25).expect("a swing");
    let mut second = new();
    second
        .restore(&first.snapshot())
        .expect("of the same model");
    second.set_params(&[0.25]).expect("within its range");
    assert_eq!(second.state(), first.state());
}

#[test]
fn joints_that_are_set_go_before_those_declared_and_the_others_hold() {
    let scene = read(
        "model Double {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            body link[i in 0..2] { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m }
            joint pin: hinge from world to link[0].top { axis: y, start: 30 deg, start_rate: 2 rad/s }
            joint elbow: universal from link[0].tip to link[1].top { axes: [x, y], angle1: { start: -0.25 rad }, angle2: { start: 0.5 rad } }
            output pin_angle = pin.angle;
            output pin_rate = pin.angle_rate;
            output bend = elbow.angle1;
            output turn = elbow.angle2;
        }",
    );
    let model = Generic::<f64>::new(scene, &[]).expect("a scene");
    let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
    simulation
        .set_joints(&[("pin.angle", 0.125), ("elbow.angle2_rate", 1.0)])
        .expect("joint coordinates");
    let (found, moved) = begun(simulation);
    assert_close(&found, &[0.125, 2.0, -0.25, 0.5], 1e-14, 0.0, "coordinates");
    assert!(moved < 1e-14);
}

/// Crank 1 m, coupler 2 m, rocker 2 m, ground 2 m: at a crank angle of 90° the rocker stands on one of two sides.
fn four_bar(start: &str, rocker: &str) -> Scene {
    read(&format!(
        "model FourBar {{
            gravity: none;
            world {{ frame far at [2.0, 0.0, 0.0] m }}
            body crank {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.5, 0.0, 0.0] m, frame tip at [0.5, 0.0, 0.0] m }}
            body coupler {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1.0, 0.0, 0.0] m, frame tip at [1.0, 0.0, 0.0] m }}
            body rocker {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1.0, 0.0, 0.0] m, frame tip at [1.0, 0.0, 0.0] m }}
            joint motor: hinge from world to crank.root {{ axis: z, {start} }}
            joint knee: hinge from crank.tip to coupler.root {{ axis: z }}
            joint hip: hinge from world.far to rocker.root {{ axis: z{rocker} }}
            joint close: hinge from coupler.tip to rocker.tip {{ axis: z }}
            output crank_angle = motor.angle;
            output rocker_angle = hip.angle;
            output gap = norm(coupler.tip.position - rocker.tip.position);
        }}"
    ))
}

#[test]
fn a_four_bar_starts_from_the_angle_of_its_crank_and_the_loop_is_closed() {
    let scene = four_bar("start: 90 deg", "");
    let (found, moved) = begun_as_declared(&scene);
    assert_close(&found[..1], &[90f64.to_radians()], 1e-10, 0.0, "crank");
    assert!(found[2] < 1e-9 && moved < 1e-9, "{found:?} {moved}");
}

/// The tips meet where circles of 2 m about (0, 1) and (2, 0) cross: (1, 1/2) ± √(4 − 5/4) (1, 2)/√5.
#[test]
fn a_four_bar_starts_on_either_branch_from_the_angle_of_its_rocker() {
    let reach = (4.0f64 - 1.25).sqrt() / 5f64.sqrt();
    let families = [Coordinates::Absolute, Coordinates::Relative];
    for (side, family) in [1.0, -1.0]
        .into_iter()
        .flat_map(|side| families.map(|own| (side, own)))
    {
        let tip = [1.0 + side * reach, 0.5 + 2.0 * side * reach];
        let rocker = (tip[1]).atan2(tip[0] - 2.0);
        let scene = four_bar("force: 0 N*m", &format!(", start: {rocker:?} rad"));
        let scene = scene.in_coordinates(family);
        let model = Generic::<f64>::new(scene, &[]).expect("a scene");
        let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
        // Both angles, as far as they fit each other: the loop closes.
        let both = [("motor.angle", 90f64.to_radians()), ("hip.angle", rocker)];
        simulation.set_joints(&both).expect("angles that fit");
        let (found, moved) = begun(simulation);
        assert_close(&found[..2], &[both[0].1, rocker], 1e-9, 0.0, "angles");
        assert!(found[2] < 1e-9 && moved < 1e-9, "{found:?} {moved}");
    }
}

#[test]
fn a_coordinate_that_others_decide_is_told_by_name() {
    let scene = four_bar("start: 90 deg", ", start: 10 deg");
    let model = Generic::<f64>::new(scene, &[]).expect("a scene");
    let Err(error) = Simulation::new(&model, Options::rk4(1e-3)) else {
        panic!("angles that do not fit each other");
    };
    assert!(
        matches!(&error.cause, StepError::Unplaced { name, why }
        if name == "close" && why.contains("stays open")),
        "{error}"
    );
    let mut simulation = {
        let scene = four_bar("start: 90 deg", "");
        let model = Generic::<f64>::new(scene, &[]).expect("a scene");
        Simulation::new(&model, Options::rk4(1e-3)).expect("a start")
    };
    // The declared angle of the crank gives way to the angle that is set.
    simulation
        .set_joints(&[("hip.angle", 1.75)])
        .expect("a branch");
    let (found, _) = begun(simulation);
    assert_close(&found[1..2], &[1.75], 1e-9, 0.0, "rocker");
    assert!((found[0] - 90f64.to_radians()).abs() > 1e-3 && found[2] < 1e-9);
}

#[test]
fn a_start_that_is_said_of_a_body_and_of_its_joint_holds_where_both_say_the_same() {
    let declared = |joint: &str, coordinates: &str| {
        read(&format!(
            "model Twice {{ coordinates: {coordinates}; gravity: [0.0, 0.0, -9.81] m/s^2;
            body bob {{
                mass: 2 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 1.0] m,
                start at [-0.6, 0.0, -0.8] m rotated rpy(0.0, 0.6435011087932844, 0.0) velocity [-0.4, 0.0, 0.3] m/s angular_velocity [0.0, 0.5, 0.0] rad/s
            }}
            joint pin: hinge from world to bob.top {{ axis: y, {joint} }}
            output swing = pin.angle;
            output rate = pin.angle_rate; }}"
        ))
    };
    let angle = 0.6_f64.atan2(0.8);
    let same = format!("start: {angle:?} rad, start_rate: 0.5 rad/s");
    for coordinates in ["absolute", "relative"] {
        let (found, moved) = begun_as_declared(&declared(&same, coordinates));
        assert_close(&found, &[angle, 0.5], 1e-12, 0.0, coordinates);
        assert!(moved < 1e-12, "{moved}");
        for other in [
            format!("start: {:?} rad", angle + 1e-4),
            format!("start: {angle:?} rad, start_rate: 0.6 rad/s"),
        ] {
            let model = Generic::<f64>::with_defaults(declared(&other, coordinates));
            let model = model.expect("defaults");
            let begun = Simulation::new(&model, Options::rk4(1e-3)).and_then(|mut it| it.start());
            let error = begun.expect_err("two starts");
            assert!(
                matches!(&error.cause, StepError::Unplaced { name, .. } if name == "pin"),
                "{error}"
            );
        }
    }
}

#[test]
fn bodies_and_points_start_where_they_are_put_and_as_they_move() {
    let scene = read(
        "model Thrown {
            gravity: none;
            param high = 10 m;
            body capsule {
                mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2,
                start at [1.0 m, 0.0, high] rotated rpy(0.0, 0.0, 90 deg) velocity [1.0, 2.0, 3.0] m/s angular_velocity [0.0, 0.1, 0.2] rad/s,
            }
            point stone { mass: 1 kg, start at [4.0, 5.0, 6.0] m velocity [7.0, 8.0, 9.0] m/s }
            joint fly: free from world to capsule.com;
            output place = capsule.position;
            output heading = capsule.x;
            output speed = capsule.velocity;
            output spin = capsule.omega_body;
            output stone_place = stone.position;
            output stone_speed = stone.velocity;
        }",
    );
    let (found, moved) = begun_as_declared(&scene);
    let wanted = [
        1.0, 0.0, 10.0, 0.0, 1.0, 0.0, 1.0, 2.0, 3.0, 0.0, 0.1, 0.2, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0,
    ];
    assert_close(&found, &wanted, 1e-15, 1e-15, "outputs");
    assert_eq!(moved, 0.0);
}

#[test]
fn what_flies_starts_where_both_frames_of_its_joint_coincide_and_moves_with_them() {
    let text = "model Berth {
            coordinates: absolute;
            gravity: none;
            world { frame berth at [1 m + 2 m/s * time, 2 m, 3 m] rotated about(z, 90 deg) }
            body arm { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame root at [0, 0, 0.25] m }
            body hull {
                mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2,
                frame top at [0, 0, 0.5] m rotated about(x, 90 deg),
            }
            joint boom: hinge from hull.com to arm.root { axis: y }
            joint fly: free from world.berth to hull.top;
            output place = hull.position;
            output keel = hull.x;
            output deck = hull.z;
            output speed = hull.velocity;
            output reach = arm.position;
        }";
    // The axes of the hull are those of the berth, turned back about x: its z is −x of the world.
    let wanted = [
        1.5, 2.0, 3.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.75, 2.0, 3.0,
    ];
    for family in ["absolute", "relative"] {
        let scene = read(&text.replace("absolute", family));
        let (found, moved) = begun_as_declared(&scene);
        assert_close(&found, &wanted, 1e-15, 1e-15, family);
        assert_eq!(moved, 0.0);
    }
    // What the body says itself goes before.
    let put = text.replace("frame top", "start at [4, 5, 6] m, frame top");
    let (found, _) = begun_as_declared(&read(&put));
    assert_close(
        &found[..6],
        &[4.0, 5.0, 6.0, 0.0, 1.0, 0.0],
        1e-15,
        1e-15,
        "put",
    );
}

#[test]
fn coordinates_that_are_set_leave_what_flies_where_its_state_has_it() {
    let scene = read(
        "model Flyer {
            gravity: none;
            world { frame pad at [0, 0, 1] m }
            body hull { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame keel at [0, 0, -0.5] m }
            body arm { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame root at [0, 0, 0.25] m }
            joint fly: free from world.pad to hull.keel;
            joint boom: hinge from hull.com to arm.root { axis: y }
            output place = hull.position;
        }",
    );
    let model = Generic::new(scene, &[]).expect("no params");
    let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
    let mut state = simulation.state().to_vec();
    assert_eq!(state[..3], [0.0, 0.0, 1.5]);
    state[2] = 7.0;
    simulation.set_state(0.0, &state).expect("a state");
    simulation
        .set_joints(&[("boom.angle", 0.3)])
        .expect("an angle");
    assert_close(&begun(simulation).0, &[0.0, 0.0, 7.0], 1e-15, 0.0, "place");
}

#[test]
fn a_planar_scene_starts_at_its_angle() {
    let planar = PENDULUM.replace("gravity:", "planar: xz; gravity:");
    let (found, moved) = begun_as_declared(&read(&planar));
    assert_close(&found, &[30f64.to_radians(), 0.5], 1e-15, 0.0, "planar");
    assert!(moved < 1e-15);
}

/// An arm of 4 m on a pivot 3 m high, and a rod of 3.2 m from its tip to a stone: with the stone at (1/2, 0) the arm is γ above its direction from the
/// pivot, cos γ = (4² + d² − 3.2²)/(8 d). A cart beside them has nothing to do with either.
#[test]
fn declared_starts_give_way_to_what_is_given_and_are_told_and_other_mechanisms_start_as_declared() {
    for family in ["absolute", "relative"] {
        let scene = read(&format!(
            "model Beside {{
                coordinates: {family};
                planar: xz;
                gravity: none;
                world {{ frame pivot at [0, 0, 3] m }}
                body arm {{ mass: 60 kg, inertia: 130 kg*m^2, frame axle at [0, 0, 0] m, frame tip at [4, 0, 0] m }}
                body cart {{ mass: 6 kg, inertia: 1 kg*m^2, start at [1.5, 0, 0] m velocity [2, 0, 0] m/s }}
                body pole {{ mass: 1 kg, inertia: 1 kg*m^2, frame foot at [0, 0, -1] m }}
                point stone {{ mass: 12 kg }}
                joint axle: hinge from world.pivot to arm.axle {{ axis: y, start: 45 deg }}
                joint rope: distance from arm.tip to stone {{ length: 3.2 m }}
                joint rail: prismatic from world to cart.com {{ axis: x }}
                joint pin: hinge from cart.com to pole.foot {{ axis: y, start: 20 deg }}
                output turn = axle.angle;
                output along = rail.slide;
                output speed = rail.slide_rate;
                output lean = pin.angle;
            }}"
        ));
        let layout = Layout::new(&scene);
        let from = StartFrom::new(&[], 0.0);
        let mut state = vec![0.0; layout.nx()];
        declared_parts(&scene, &layout, from, &mut state);
        let stone = scene.part_named("stone").expect("a point");
        let place = layout.own_slots(stone).expect("a point with mass").q;
        state[place..place + 2].copy_from_slice(&[0.5, 0.0]);
        let report = place_declared(&scene, &layout, from, &[], &[stone], &mut state)
            .expect("the rod reaches");

        let apart = 0.5f64.hypot(3.0);
        let above = (4.0f64.powi(2) + apart * apart - 3.2f64.powi(2)) / (8.0 * apart);
        let turn = 3f64.atan2(0.5) - above.acos();
        let [(name, said, taken)] = &report.told_about(&scene)[..] else {
            panic!("{family}: {report:?}");
        };
        assert_eq!(name, "axle.angle");
        assert_close(
            &[*said, *taken],
            &[45f64.to_radians(), turn],
            1e-9,
            0.0,
            family,
        );

        let model = Generic::<f64>::new(scene, &[]).expect("a scene");
        let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
        simulation.set_state(0.0, &state).expect("a state");
        let (found, moved) = begun(simulation);
        let want = [turn, 1.5, 2.0, 20f64.to_radians()];
        assert_close(&found, &want, 1e-9, 0.0, family);
        assert!(moved < 1e-9, "{family}: {moved}");
    }
}
