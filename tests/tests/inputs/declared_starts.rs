//! Starts that a declaration says: where a run begins without being told, in every form of a scene.

use mbd_compiler::{Interpreted, read_toml, write_toml};
use mbd_runtime::{Generic, Options, Simulation, StartNumber, StepError, model};
use mbd_scene::{Model, Quantity, Scene};
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
fn begun(mut simulation: Simulation<f64>) -> (Vec<f64>, f64) {
    simulation.start().expect("a consistent start");
    let mut outputs = vec![0.0; simulation.model().layout().columns];
    let outputs_of = Quantity::Outputs;
    simulation
        .evaluate(outputs_of, &mut outputs)
        .expect("outputs");
    let moved = simulation.start_moved().iter().map(|moved| moved.distance);
    (outputs, moved.fold(0.0, f64::max))
}

fn begun_as_declared(scene: &Scene) -> (Vec<f64>, f64) {
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
    for side in [1.0, -1.0] {
        let tip = [1.0 + side * reach, 0.5 + 2.0 * side * reach];
        let rocker = (tip[1]).atan2(tip[0] - 2.0);
        let scene = four_bar("force: 0 N*m", &format!(", start: {rocker:?} rad"));
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
fn a_planar_scene_starts_at_its_angle() {
    let planar = PENDULUM.replace("gravity:", "planar: xz; gravity:");
    let (found, moved) = begun_as_declared(&read(&planar));
    assert_close(&found, &[30f64.to_radians(), 0.5], 1e-15, 0.0, "planar");
    assert!(moved < 1e-15);
}

const UNTOLD: &str = "model Untold { COORDINATES
    gravity: [0.0, 0.0, -9.81] m/s^2;
    world { frame hook at [0.7, 0.0, 2.0] m, frame rail at [0.0, 0.0, 5.0] m }
    body upper { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m }
    body lower { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
    body cabin { mass: 1 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2, frame door at [1.0, 0.0, 0.0] m }
    body bird { mass: 1 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
    joint pin: hinge from world.hook to upper.top { axis: y }
    joint elbow: hinge from upper.tip to lower.top { axis: y }
    joint guide: prismatic from world.rail to cabin.com { axis: z }
    joint wings: free from cabin.door to bird.com;
    output lean = pin.angle; output bend = elbow.angle; output height = guide.slide;
    output x = bird.position.x; output z = bird.position.z;
}";

#[test]
fn coordinates_that_nobody_mentions_start_at_zero_and_what_flies_from_a_body_where_that_is() {
    for family in ["coordinates: absolute;", "coordinates: relative;"] {
        let scene = read(&UNTOLD.replace("COORDINATES", family));
        let (found, moved) = begun_as_declared(&scene);
        assert_close(&found, &[0.0, 0.0, 0.0, 1.0, 5.0], 1e-14, 1e-14, family);
        assert!(moved < 1e-14, "{family}: {moved}");
    }
}

#[test]
fn a_loop_that_nobody_places_is_closed_and_what_hangs_beside_it_starts_at_zero() {
    let scene = read(
        "model Linkage { gravity: [0.0, 0.0, -9.81] m/s^2;
            world { frame left at [0.0, 0.0, 0.0] m, frame right at [1.5, 0.0, 0.0] m, frame hook at [4.0, 0.0, 0.0] m }
            body crank { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [0.0, 0.0, -0.5] m, frame b at [0.0, 0.0, 0.5] m }
            body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [0.0, 0.0, -1.0] m, frame b at [0.0, 0.0, 1.0] m }
            body rocker { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [0.0, 0.0, -0.75] m, frame b at [0.0, 0.0, 0.75] m }
            body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0.0, 0.0, 0.3] m }
            joint one: hinge from world.left to crank.a { axis: y }
            joint two: hinge from crank.b to rod.a { axis: y }
            joint three: hinge from rod.b to rocker.b { axis: y }
            joint four: hinge from world.right to rocker.a { axis: y }
            joint hang: hinge from world.hook to bob.top { axis: y }
            output gap = norm(rod.b.position - rocker.b.position);
            output swing = hang.angle;
        }",
    );
    let (found, _) = begun_as_declared(&scene);
    assert_close(
        &found,
        &[0.0, 0.0],
        1e-9,
        1e-9,
        "closed, and hanging straight",
    );
}

#[test]
fn a_loop_of_which_nothing_is_said_closes_from_zero_in_both_families() {
    // A sled on a rail that is turned over; its tip stands on a table: from a body that is not turned the rail would be held turned around.
    for family in ["absolute", "relative"] {
        let scene = read(&format!(
            "model Sled {{ coordinates: {family};
                gravity: [0.0, 0.0, -9.81] m/s^2;
                world {{ frame rail at [0.0, 0.0, 0.0] m rotated rpy(170 deg, 0.0, 0.0), frame table at [0.0, 0.0, -0.5] m }}
                body sled {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame tip at [0.1, 0.0, -0.3] m }}
                joint guide: prismatic from world.rail to sled.com {{ axis: z }}
                joint stand: point_on_plane from world.table to sled.tip {{ axis: z }}
                output slide = guide.slide;
            }}"
        ));
        let (found, _) = begun_as_declared(&scene);
        let fall = (170_f64.to_radians()).cos();
        let slide = 0.3 - 0.5 / fall;
        assert_close(&found, &[slide], 1e-9, 1e-9, family);
    }
}

#[test]
fn a_place_that_its_joint_does_not_allow_moves_as_little_in_both_families() {
    // A table on a rail that is turned over, and a ball in its middle that is said to lie 40 cm above it.
    for family in ["absolute", "relative"] {
        let scene = read(&format!(
            "model Table {{ coordinates: {family};
                gravity: [0.0, 0.0, -9.81] m/s^2;
                world {{ frame floor at [0.3, 0.2, 0.5] m rotated rpy(170 deg, 0.0, 0.0) }}
                body table {{ mass: 3 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
                joint slides: prismatic from world.floor to table.com {{ axis: z }}
                point ball {{ mass: 1 kg, start at [0.3, 0.2, 0.9] m }}
                joint lies: spherical from table.com to ball;
                output slide = slides.slide;
            }}"
        ));
        let (found, _) = begun_as_declared(&scene);
        // The nearest by mass: the table takes the part of the ball's mass.
        let along = 0.4 * 170_f64.to_radians().cos() / 4.0;
        assert_close(&found, &[along], 1e-9, 1e-9, family);
    }
}

#[test]
fn a_declared_place_that_joints_do_not_allow_is_told_in_both_families() {
    for family in ["absolute", "relative"] {
        let scene = read(&format!(
            "model Tilted {{ coordinates: {family};
                gravity: [0.0, 0.0, -9.81] m/s^2;
                body rod {{ mass: 1 kg, inertia: diag(0.08, 0.08, 0.001) kg*m^2, frame top at [0.0, 0.0, 0.5] m, start at [-0.25, 0.0, -0.433] m }}
                joint pin: hinge from world to rod.top {{ axis: y }}
            }}"
        ));
        let model = Generic::with_defaults(scene).expect("declared params");
        let mut run = Simulation::<f64>::new(&model, Options::rk4(1e-3)).expect("a start");
        run.start().expect("a consistent start");
        let rod = run.start_moved().iter().find(|moved| moved.name == "rod");
        let rod = rod.unwrap_or_else(|| panic!("{family}: nothing is said to be moved"));
        assert!(rod.distance > 0.05, "{family}: {rod:?}");
    }
}

#[test]
fn what_hangs_on_bodies_that_are_put_a_little_apart_hangs_at_zero() {
    // The rods are declared to the digits that a person writes; their hinge is open by a millimetre until the start closes it.
    let scene = read(
        "model Apart { gravity: none;
            body upper { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame tip at [0.0, 0.0, -0.5] m, start at [3.0, 0.0, -0.5] m }
            body lower { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m,
                start at [3.0, 0.0, -1.501] m }
            body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0.0, 0.0, 0.2] m }
            joint afloat: free from world to upper.com;
            joint elbow: spherical from upper.tip to lower.top;
            joint hang: hinge from lower.tip to bob.top { axis: y }
            output swing = hang.angle;
            output x = bob.position.x;
        }",
    );
    let (found, moved) = begun_as_declared(&scene);
    assert_close(&found, &[0.0, 3.0], 0.0, 1e-3, "below the others");
    assert!(moved < 2e-3, "{moved}");
}

#[test]
fn a_stewart_platform_is_assembled_from_all_bodies_at_the_origin_and_every_body_that_moved_is_told()
{
    let scene = read(
        "model Stewart {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world { frame foot[i in 0..6] at polar(0.7 m, (60 * i + 10 * (-1)^i) * 1 deg, 0 m) }
            body platform {
                mass: 40 kg,
                inertia: diag(2, 2, 4) kg*m^2,
                frame corner[i in 0..6] at polar(0.4 m, (60 * i + 30 * (-1)^i) * 1 deg, 0 m),
            }
            body cylinder[i in 0..6] { mass: 5 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame foot at [0.0, 0.0, -0.25] m }
            body rod[i in 0..6] { mass: 3 kg, inertia: diag(0.06, 0.06, 0.003) kg*m^2, frame head at [0.0, 0.0, 0.25] m }
            joint foot[i in 0..6]: universal from world.foot[i] to cylinder[i].foot { axes: [x, y] }
            joint leg[i in 0..6]: prismatic from cylinder[i].foot to rod[i].head { axis: z, motor: 1.1 m }
            joint ball[i in 0..6]: spherical from rod[i].head to platform.corner[i];
        }",
    );
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    let mut origin = vec![0.0; model.layout().nx()];
    let upright: Vec<usize> = model.layout().quaternions().collect();
    upright.iter().for_each(|&at| origin[at] = 1.0);
    run.set_state(0.0, &origin).expect("numbers");
    run.start().expect("it can be assembled");
    let mut gaps = vec![0.0; model.layout().len(Quantity::Constraint)];
    run.evaluate(Quantity::Constraint, &mut gaps).expect("rows");
    let open = gaps.iter().fold(0.0_f64, |most, gap| most.max(gap.abs()));
    assert!(open < 1e-9, "open by {open:.1e}");
    // Legs of one length: level, and as high as they reach.
    let apart = 0.4_f64.powi(2) + 0.7_f64.powi(2) - 0.56 * 20_f64.to_radians().cos();
    let height = (1.1_f64.powi(2) - apart).sqrt();
    let level = [0.0, 0.0, height, 1.0, 0.0, 0.0, 0.0];
    assert_close(&run.state()[..7], &level, 0.0, 1e-9, "the platform");
    let moved = run.start_moved();
    assert_eq!(moved.len(), 13, "{moved:?}");
    let names: Vec<&str> = moved.iter().map(|one| one.name.as_str()).collect();
    for name in ["platform", "cylinder[0]", "rod[5]"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(moved.iter().all(|one| one.distance > 0.3), "{moved:?}");
    run.run(0.05).expect("it stands");
}

/// Two bodies on a joint, of which the declaration says where one flies.
fn pair(joint: &str, starts: [&str; 2], coordinates: &str) -> Scene {
    let [a, b] = starts;
    read(&format!(
        "model Pair {{
            gravity: none; coordinates: {coordinates};
            body a {{ mass: 3 kg, inertia: diag(0.3, 0.2, 0.25) kg*m^2, frame p at [0.3, 0.1, -0.2] m rotated rpy(20 deg, -30 deg, 50 deg) {a} }}
            body b {{ mass: 2 kg, inertia: diag(0.12, 0.1, 0.15) kg*m^2, frame q at [-0.2, 0.1, 0.1] m rotated rpy(-10 deg, 40 deg, 5 deg) {b} }}
            joint fly: free from world to a.com;
            joint j: {joint}
            output pa = a.position; output pb = b.position;
            output va = a.velocity; output vb = b.velocity;
            output wa = a.omega_world; output wb = b.omega_world;
        }}"
    ))
}

#[test]
fn what_hangs_on_a_body_that_is_put_somewhere_goes_along_in_both_families() {
    let at = "start at [1, 2, 3] m rotated rpy(10 deg, 20 deg, 30 deg) velocity [0.1, 0.2, -0.3] m/s angular_velocity [0.3, -0.2, 0.5] rad/s";
    for (joint, zero) in [
        ("hinge from a.p to b.q { axis: [1, 2, 2] }", "j.angle"),
        ("prismatic from a.p to b.q { axis: z }", "j.slide"),
        ("cylindrical from a.p to b.q { axis: z }", "j.slide"),
        ("screw from a.p to b.q { axis: z, pitch: 20 mm }", "j.angle"),
        ("universal from a.p to b.q;", "j.angle1"),
        ("spherical from a.p to b.q;", "0 m"),
        ("planar from a.p to b.q;", "j.x"),
        ("rigid from a.p to b.q;", "0 m"),
    ] {
        let said = format!(", {at}");
        let scenes = ["absolute", "relative"].map(|of| pair(joint, [&said, ""], of));
        let [absolute, relative] = scenes.map(|scene| begun_as_declared(&scene));
        assert_close(&relative.0, &absolute.0, 1e-14, 1e-14, joint);
        assert!(absolute.1.max(relative.1) < 1e-14, "{joint}");
        if zero != "0 m" {
            let text = format!("{joint} output q = {zero};");
            let (found, _) = begun_as_declared(&pair(&text, [&said, ""], "relative"));
            assert!(found[0].abs() < 1e-14, "{joint}: {found:?}");
        }
        // The same where the last of the chain is put: what carries it flies to it.
        let said = format!(", {at}");
        let scenes = ["absolute", "relative"].map(|of| pair(joint, ["", &said], of));
        let [absolute, relative] = scenes.map(|scene| begun_as_declared(&scene));
        assert_close(&relative.0, &absolute.0, 1e-14, 1e-14, joint);
        assert_close(&relative.0[3..6], &[1.0, 2.0, 3.0], 1e-14, 0.0, joint);
        assert!(absolute.1.max(relative.1) < 1e-14, "{joint}");
    }
}

#[test]
fn a_joint_that_forbids_nothing_in_its_plane_starts_where_it_is_said() {
    for family in ["absolute", "relative"] {
        for plane in ["xy", "space"] {
            let (planar, inertia) = match plane {
                "xy" => ("planar: xy;", "2 kg*m^2"),
                _ => ("", "diag(2, 2, 2) kg*m^2"),
            };
            let scene = read(&format!(
                "model Puck {{
                    gravity: none;
                    {planar}
                    coordinates: {family};
                    world {{ frame table at [1, 0, 0] m }}
                    body puck {{ mass: 1 kg, inertia: {inertia} }}
                    body arm {{ mass: 1 kg, inertia: {inertia}, frame root at [-0.5, 0, 0] m }}
                    joint slides: planar from world.table to puck {{
                        axis: z,
                        y: {{ start: 4 mm, start_rate: 2 m/s }},
                        angle: {{ start: 30 deg }},
                    }}
                    joint pin: hinge from puck to arm.root {{ axis: z, start: 15 deg }}
                    output x = slides.x; output y = slides.y; output turn = slides.angle;
                    output rate = slides.y_rate; output bend = pin.angle;
                    output end_x = arm.position.x; output end_y = arm.position.y; output end_v = arm.vy;
                }}"
            ));
            let model = Generic::<f64>::with_defaults(scene).expect("defaults");
            let run = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
            let (found, moved) = begun(run);
            let (half, turned) = (0.5, 45f64.to_radians());
            let want = [
                0.0,
                4e-3,
                30f64.to_radians(),
                2.0,
                15f64.to_radians(),
                1.0 + half * turned.cos(),
                4e-3 + half * turned.sin(),
                2.0,
            ];
            assert_close(&found, &want, 1e-12, 1e-15, &format!("{family} {plane}"));
            assert!(moved < 1e-12, "{family} {plane}: {moved}");
        }
    }
}

#[test]
fn a_start_where_a_motor_does_not_hold_its_coordinate_is_told_in_both_families() {
    for family in ["absolute", "relative"] {
        let begun = |motor: &str, start: f64| {
            let scene = read(&format!(
                "model Driven {{ coordinates: {family}; gravity: none;
                    input wish: angle = 0.5 rad;
                    body rod {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 0.5] m }}
                    joint pin: hinge from world to rod.top {{ axis: y, {motor} }}
                }}"
            ));
            let model = Generic::<f64>::with_defaults(scene).expect("no params");
            let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
            let set = run.set_joints(&[("pin.angle", start)]);
            set.map_err(|error| error.to_string())
        };
        for motor in [
            "motor: 0.5 rad + 2 rad/s * time",
            "motor: wish, filter: 20 ms",
        ] {
            let told = begun(motor, 0.2).expect_err("the motor holds it elsewhere");
            assert!(told.contains("holds `pin.angle` at 0.500000 rad"), "{told}");
            begun(motor, 0.5).expect("it says the same");
            begun(motor, 0.5 - std::f64::consts::TAU).expect("and so does a turn less");
        }
        // What inputs will say is not known before they are given.
        begun("motor: [wish, 0, 0]", 0.2).expect("as far as is known");
    }
}

/// Three bodies that hang together and on nothing else, with a start of the joint between the last two.
#[test]
fn of_bodies_that_float_the_first_that_is_declared_stays_at_the_origin_in_both_families() {
    let places = ["absolute", "relative"].map(|family| {
        let scene = read(&format!(
            "model Floating {{
                coordinates: {family};
                gravity: none;
                body bus {{ mass: 9 kg, inertia: diag(1, 1, 1) kg*m^2, frame edge at [0.4, 0.0, 0.0] m }}
                body arm {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.2, 0.0, 0.0] m, frame tip at [0.2, 0.0, 0.0] m }}
                body hand {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.1, 0.0, 0.0] m }}
                joint drift: free from world to bus.com;
                joint shoulder: spherical from bus.edge to arm.root;
                joint wrist: hinge from arm.tip to hand.root {{ axis: z, start: 90 deg }}
                output bus_at = bus.position;
                output arm_at = arm.position;
                output hand_at = hand.position;
            }}"
        ));
        begun_as_declared(&scene).0
    });
    let expected = [0.0, 0.0, 0.0, 0.6, 0.0, 0.0, 0.8, 0.1, 0.0];
    for (place, family) in places.iter().zip(["absolute", "relative"]) {
        assert_close(place, &expected, 0.0, 1e-12, family);
    }
}
