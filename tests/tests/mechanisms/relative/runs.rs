//! Runs in relative coordinates: the motion of absolute ones, with every method; what is measured, located and linearised on the way.

use mbd_compiler::Interpreted;
use mbd_runtime::{Content, Method, Options, Sampling, Simulation, Trajectory, linearise};
use mbd_scene::{Layout, Model};
use tests::assert_close;
use tests::declared::read;

/// A pendulum on a turntable that pulls a hanging mass: a universal joint, a ball, a spring, a damper, an event.
const RIG: &str = "
    gravity: [0.0, 0.0, -9.81] m/s^2;
    world { frame mast at [0.0, 0.0, 2.0] m, frame hook at [0.5, 0.2, 2.2] m }
    body arm { mass: 2 kg, inertia: diag(0.05, 0.06, 0.02) kg*m^2, frame root at [0, 0, 0.3] m, frame tip at [0, 0, -0.3] m }
    body bob { mass: 1 kg, inertia: diag(0.01, 0.02, 0.015) kg*m^2, frame top at [0.05, 0, 0.25] m }
    point weight { mass: 0.4 kg, start at [0.4, 0.1, 0.6] m }
    joint neck: universal from world.mast to arm.root { axes: [x, y], angle1: { start: 40 deg, damping: 0.05 N*m*s } }
    joint ball: spherical from arm.tip to bob.top;
    spring tie from bob.com to weight { free_length: 0.5 m, stiffness: 40 N/m, damping: 0.3 N*s/m }
    spring sling from weight to world.hook { free_length: 1.0 m, stiffness: 60 N/m }
    output place = bob.position;
    output pull = ball.force;
    output push = bob.acceleration;
    event low = bob.position.z falls 1.25 m;
";

fn model(family: &str, body: &str) -> Interpreted<f64> {
    let scene = read(&format!("model Rig {{ coordinates: {family}; {body} }}"));
    Interpreted::new(scene, &[]).expect("a model")
}

/// The outputs at the end of a run, its events and how far its energy is out of balance.
fn ends(model: &Interpreted<f64>, options: Options, until: f64) -> (Vec<f64>, Vec<f64>) {
    let mut run = Simulation::new(model, options).expect("options");
    run.start().expect("a start");
    let mut history = Trajectory::new(model, Sampling::At(vec![until]), Content::ALL);
    run.record(until, &mut history).expect("a smooth motion");
    let columns = [
        "place.x",
        "place.y",
        "place.z",
        "pull.x",
        "pull.y",
        "pull.z",
        "push.x",
        "push.y",
        "push.z",
        "energy.total",
    ];
    let row = columns.map(|name| {
        *history
            .column(name)
            .and_then(|column| column.last())
            .unwrap_or_else(|| panic!("{name}"))
    });
    (
        row.to_vec(),
        run.events().iter().map(|event| event.time).collect(),
    )
}

#[test]
fn both_families_move_alike_and_locate_the_same_events() {
    let (relative, absolute) = (model("relative", RIG), model("absolute", RIG));
    assert!(relative.layout().nc == 0 && absolute.layout().nc > 0);
    for options in [
        Options::vern7(1e-11),
        Options::tsit5(1e-10),
        Options::of(Method::Rodas5P {
            rtol: 1e-9,
            max_step: f64::INFINITY,
        }),
    ] {
        let [(got, events), (want, others)] =
            [&relative, &absolute].map(|model| ends(model, options, 2.0));
        assert_close(
            &got,
            &want,
            0.0,
            2e-6,
            "outputs, reactions, accelerations, energy",
        );
        assert_close(&events, &others, 0.0, 1e-8, "times of events");
        assert!(!events.is_empty());
    }
}

#[test]
fn a_tree_without_friction_keeps_its_energy() {
    let body = RIG
        .replace(", damping: 0.05 N*m*s", "")
        .replace(", damping: 0.3 N*s/m", "");
    let relative = model("relative", &body);
    let start = ends(&relative, Options::vern7(1e-12), 1e-3).0;
    let end = ends(&relative, Options::vern7(1e-12), 10.0).0;
    assert!(
        (start[9] - end[9]).abs() < 1e-9 * start[9].abs().max(1.0),
        "{} {}",
        start[9],
        end[9]
    );
}

#[test]
fn frequencies_do_not_depend_on_coordinates() {
    let body = "
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input push: torque = 0 N*m;
        body upper { mass: 1 kg, inertia: diag(0.02, 0.03, 0.01) kg*m^2, frame top at [0, 0, 0.25] m, frame end at [0, 0, -0.25] m }
        body lower { mass: 2 kg, inertia: diag(0.04, 0.03, 0.02) kg*m^2, frame top at [0, 0, 0.25] m }
        joint pin: hinge from world to upper.top { axis: y, force: push }
        joint elbow: universal from upper.end to lower.top { axes: [x, y] }
    ";
    let [relative, absolute] = ["relative", "absolute"].map(|family| {
        let model = model(family, body);
        let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
        if family == "absolute" {
            run.set_joints(&[
                ("pin.angle", 0.0),
                ("elbow.angle1", 0.0),
                ("elbow.angle2", 0.0),
            ])
            .expect("a start");
        }
        run.start().expect("hanging");
        let space = linearise(&model, 0.0, run.state(), &[0.0]).expect("a linear system");
        let mut all: Vec<f64> = space
            .vibrations()
            .iter()
            .map(|one| one.frequency())
            .collect();
        all.sort_by(f64::total_cmp);
        (all, space.b.norm())
    });
    assert_eq!(relative.0.len(), 3);
    assert_close(&relative.0, &absolute.0, 1e-10, 0.0, "frequencies");
    assert_close(
        &[relative.1],
        &[absolute.1],
        1e-9,
        0.0,
        "what the input does",
    );
}

#[test]
fn turns_are_counted_and_starts_are_taken_in_joint_coordinates() {
    let model = model(
        "relative",
        "gravity: none;
         body wheel { mass: 1 kg, inertia: diag(0.1, 0.1, 0.2) kg*m^2 }
         joint axle: hinge from world to wheel.com { axis: z, start: 3 rad, start_rate: 10 rad/s }
         output turned = axle.angle;",
    );
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    run.run(2.0).expect("a smooth motion");
    assert_close(run.state(), &[23.0, 10.0], 1e-12, 0.0, "angle and rate");
    run.set_joints(&[("axle.angle", -40.0)]).expect("a start");
    assert_close(run.state(), &[-40.0, 10.0], 1e-12, 0.0, "angle and rate");
}

#[test]
fn the_tree_takes_the_joints_of_least_freedom() {
    let scene = read(
        "model Bars {
            coordinates: relative;
            gravity: none;
            body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame l at [-0.5, 0, 0] m, frame r at [0.5, 0, 0] m }
            body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame l at [-0.5, 0, 0] m, frame r at [0.5, 0, 0] m }
            joint ball: spherical from world to a.l;
            joint pin: hinge from a.r to b.l { axis: y }
            joint slide: prismatic from world to b.r { axis: x }
        }",
    );
    let layout = Layout::new(&scene);
    // The slide and the hinge carry both bodies, so that the ball closes the loop: two speeds in place of four.
    let carried: Vec<bool> = (0..3)
        .map(|joint| layout.carried(joint).is_some())
        .collect();
    assert_eq!(carried, [false, true, true]);
    assert_eq!((layout.nv, layout.nc), (2, 3));
    let pin = layout.carried(1).expect("a link");
    assert!(pin.reversed && pin.body == 0, "{pin:?}");
}

#[test]
fn a_loop_is_cut_at_the_last_of_equal_joints_unless_a_joint_is_marked() {
    let carried = |marked: usize| {
        let [one, two, three] = [0, 1, 2].map(|joint| if joint == marked { "loop " } else { "" });
        let scene = read(&format!(
            "model Bars {{
                coordinates: relative;
                gravity: none;
                world {{ frame right at [1, 0, 0] m }}
                body a {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame l at [-0.5, 0, 0] m, frame r at [0.5, 0, 0] m }}
                body b {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame l at [-0.5, 0, 0] m, frame r at [0.5, 0, 0] m }}
                {one}joint first: hinge from world to a.l {{ axis: y }}
                {two}joint second: hinge from a.r to b.l {{ axis: y }}
                {three}joint third: hinge from b.r to world.right {{ axis: y }}
            }}"
        ));
        let layout = Layout::new(&scene);
        // Five rows close what two hinges leave.
        assert_eq!((layout.nv, layout.nc), (2, 5));
        [0, 1, 2].map(|joint| layout.carried(joint).is_some())
    };
    assert_eq!(carried(3), [true, true, false]);
    assert_eq!(carried(2), [true, true, false]);
    assert_eq!(carried(1), [true, false, true]);
    assert_eq!(carried(0), [false, true, true]);
}

#[test]
fn a_field_of_gravity_is_a_function_of_where_the_bodies_of_a_tree_are() {
    const MU: f64 = 40.0;
    let body = |gravity: &str| {
        format!(
            "gravity: {gravity};
             body upper {{ mass: 1 kg, inertia: diag(0.02, 0.03, 0.01) kg*m^2, frame top at [0, 0, 0.25] m, frame end at [0, 0, -0.25] m }}
             body lower {{ mass: 2 kg, inertia: diag(0.04, 0.03, 0.02) kg*m^2, frame top at [0, 0, 0.25] m }}
             point weight {{ mass: 0.5 kg, start at [0.3, 0.1, -0.8] m }}
             joint pin: universal from world to upper.top {{ axes: [x, y], angle1: {{ start: 40 deg }} }}
             joint elbow: hinge from upper.end to lower.top {{ axis: y, start: 20 deg }}
             spring tie from lower.com to weight {{ free_length: 0.3 m, stiffness: 30 N/m }}
             output place = lower.position;"
        )
    };
    let ends = |family: &str, field: bool| {
        let law = "point_mass { mu: 40 m^3/s^2, center: [0.1, 0.2, -3.0] m }";
        let model = model(family, &body(if field { "field" } else { law }));
        let mut run = Simulation::new(&model, Options::vern7(1e-11)).expect("options");
        if field {
            run.control(|sample, inputs: &mut Vec<f64>| {
                assert!(sample.position("nobody").is_none());
                let x = sample.x();
                let weight = match x.len() {
                    12 => [x[3], x[4], x[5]],
                    _ => [x[14], x[15], x[16]],
                };
                let bodies = ["upper", "lower"].map(|name| sample.position(name).expect("a body"));
                let places = bodies.into_iter().chain([weight]);
                for (place, pull) in places.zip(inputs.chunks_exact_mut(3)) {
                    let d = [place[0] - 0.1, place[1] - 0.2, place[2] + 3.0];
                    let cube = d.iter().map(|x| x * x).sum::<f64>().powf(1.5);
                    (0..3).for_each(|k| pull[k] = -MU * d[k] / cube);
                }
            })
            .expect("inputs");
        }
        run.run(2.0).expect("a smooth motion");
        let mut history = Trajectory::new(&model, Sampling::At(vec![2.0]), Content::ALL);
        run.record(2.0 + 1e-9, &mut history).expect("a row");
        ["place.x", "place.y", "place.z"].map(|name| history.column(name).expect("a column")[0])
    };
    let want = ends("absolute", false);
    for family in ["absolute", "relative"] {
        assert_close(&ends(family, true), &want, 0.0, 1e-8, family);
    }
}

#[test]
fn a_loop_from_a_frame_that_moves_to_the_ground_moves_as_in_absolute_coordinates() {
    // A crank on a shaken support, whose rod is guided by the ground: the loop is driven from one side alone.
    let body = "
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame support at [0.15 m * sin(3 rad/s * time), 0 m, 0.1 m * sin(2 rad/s * time)] }
        body crank { mass: 1 kg, inertia: diag(0.02, 0.02, 0.01) kg*m^2, frame near at [-0.3, 0, 0] m, frame far at [0.3, 0, 0] m }
        body rod { mass: 2 kg, inertia: diag(0.05, 0.06, 0.02) kg*m^2, frame near at [-0.5, 0, 0] m, frame far at [0.5, 0, 0] m }
        joint shaft: hinge from world.support to crank.near { axis: y, angle: { start: 20 deg } }
        joint pin: hinge from crank.far to rod.near { axis: y }
        loop joint guide: point_on_plane from world to rod.far { axis: z }
        output place = rod.position;
        output speed = rod.velocity;
    ";
    let [got, want] = [model("relative", body), model("absolute", body)].map(|model| {
        let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options");
        run.start().expect("a start");
        let mut history = Trajectory::new(&model, Sampling::At(vec![1.0]), Content::ALL);
        run.record(1.0, &mut history).expect("a smooth motion");
        let columns = ["place.x", "place.z", "speed.x", "speed.z"];
        columns.map(|name| {
            let column = history.column(name);
            *column.and_then(|column| column.last()).expect("a column")
        })
    });
    assert_close(&got, &want, 1e-6, 1e-7, "place and speed of the rod");
}
