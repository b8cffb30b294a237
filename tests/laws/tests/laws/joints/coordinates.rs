//! Joint coordinates of all joints: what is measured is what the motion was made of, and its row is its derivative, on the joint and off it.

use laws::assert_close;
use laws::jet::Jet;
use laws::mechanism::{
    Coordinates, Instance, Seat, add_body, add_frame, add_joint, all_joints, carried, empty,
    evaluate, inertia, jets, state,
};
use laws::random::Random;
use mbd_scene::joints::JointLaw;
use mbd_scene::rows::{End, Ends, Rotation};
use mbd_scene::{AngularVelocity, Formula, Output, Quantity, Scene, Unit};
use nalgebra::Vector3;

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];

fn output(value: Formula) -> Output {
    Output {
        name: format!("{value:?}"),
        doc: String::new(),
        value,
        components: 1,
        unit: Unit::default(),
    }
}

/// Two bodies and a joint between them; its coordinates, then their rates, as outputs.
fn pair(law: &JointLaw, seats: [Seat; 2], components: AngularVelocity) -> Scene {
    let mut random = Random::new(3);
    let mut scene = empty([0.0; 3], components);
    let ends = seats.map(|seat| {
        let body = add_body(&mut scene, 1.0, &inertia(&mut random));
        add_frame(&mut scene, Some(body), seat.declared("end"))
    });
    add_joint(&mut scene, law.clone(), ends[0], ends[1]);
    let count = law.measured().count();
    let values = (0..count).map(|i| output(Formula::Coordinate(0, i)));
    let rates = (0..count).map(|i| output(Formula::CoordinateRate(0, i)));
    scene.outputs = values.chain(rates).collect();
    scene
}

fn everywhere(mut check: impl FnMut(&str, &JointLaw, &[f64], [Seat; 2], &Scene, &mut Random)) {
    let mut random = Random::new(17);
    for (law, numbers) in all_joints() {
        for components in COMPONENTS {
            for trial in 0..10 {
                let seats = [Seat::random(&mut random), Seat::random(&mut random)];
                let scene = pair(&law, seats, components);
                let name = format!("{law:?}, {components:?}, {trial}");
                check(&name, &law, &numbers, seats, &scene, &mut random);
            }
        }
    }
}

#[test]
fn joints_measure_the_coordinates_their_motion_was_made_of() {
    everywhere(|name, law, numbers, seats, scene, random| {
        let parent = Instance::random(random);
        let made = Coordinates::random(law, numbers.to_vec(), random);
        let child = carried(law, seats, &parent, &made);
        let state = state(scene, &[parent, child], &[]);
        let count = law.measured().count();
        let measured = evaluate(scene, Quantity::Outputs, &state, &[], &[]);
        assert_close(&measured[..count], &made.q[..count], 1e-13, 1e-14, name);
        assert_close(&measured[count..], &made.u[..count], 1e-13, 1e-13, name);
    });
}

#[test]
fn every_joint_with_one_to_three_scalar_freedoms_measures_them_all() {
    let unmeasured = [
        "free",
        "constant_angle",
        "constant_velocity",
        "spherical",
        "distance",
        "point_on_line",
        "point_on_plane",
    ];
    for (law, _) in all_joints() {
        let keyword = law.keyword();
        let count = law.measured().count();
        if !unmeasured.contains(&keyword) {
            assert_eq!(count, law.freedoms(), "{keyword}");
        }
        let ways = [("point_on_line", 1), ("point_on_plane", 2)];
        if let Some((_, ways)) = ways.iter().find(|(word, _)| *word == keyword) {
            assert_eq!(count, *ways, "{keyword}");
        }
    }
}

#[test]
fn rates_and_rows_are_the_derivatives_of_coordinates_along_motions_that_violate_the_joint() {
    everywhere(|name, law, numbers, seats, scene, random| {
        let bodies = [Instance::random(random), Instance::random(random)];
        let count = law.measured().count();
        let outputs = evaluate(
            scene,
            Quantity::Outputs,
            &jets(scene, &bodies, &[]),
            &[],
            &[],
        );
        let level = |k: usize| -> Vec<f64> {
            let values: &[Jet] = &outputs[..count];
            values.iter().map(|jet| jet.0[k]).collect()
        };
        let state = state(scene, &bodies, &[]);
        let plain = evaluate(scene, Quantity::Outputs, &state, &[], &[]);
        assert_close(&plain[count..], &level(1), 1e-12, 1e-12, name);
        // The same from the row: Φ_v v and Φ_v v̇ − γ.
        let components = scene.angular_velocity;
        let end = |body: usize| end(&bodies[body], &seats[body], components);
        let ends = Ends::new(end(0), end(1), numbers, components);
        let rows: Vec<_> = law.measured().map(|c| ends.row(&c)).collect();
        let values: Vec<f64> = rows.iter().map(|row| row.value).collect();
        assert_close(&values, &level(0), 1e-13, 1e-13, name);
        let velocities = [ends.parent.velocities(), ends.child.velocities()];
        let rates: Vec<f64> = rows
            .iter()
            .map(|row| row.parent().rate(&velocities[0]) + row.child().rate(&velocities[1]))
            .collect();
        assert_close(&rates, &level(1), 1e-12, 1e-12, name);
        let second: Vec<f64> = rows
            .iter()
            .map(|row| {
                let sides = [(row.parent(), &bodies[0]), (row.child(), &bodies[1])];
                let moved = sides.map(|(columns, body)| {
                    let alpha = body.in_components(body.alpha, components);
                    columns.linear.dot(&body.acceleration) + columns.angular.dot(&alpha)
                });
                moved[0] + moved[1] - row.bias
            })
            .collect();
        // Near a quarter turn off the joint an angle turns arbitrarily fast.
        let size = level(2).iter().fold(1.0, |most: f64, x| most.max(x.abs()));
        assert_close(&second, &level(2), 1e-11, 1e-11 * size, name);
    });
}

/// An end in its own components.
pub fn end(body: &Instance, seat: &Seat, components: AngularVelocity) -> End<f64> {
    let rotated = |v: Vector3<f64>| match components {
        AngularVelocity::Body => v,
        AngularVelocity::World => body.rotation() * v,
    };
    let (outward, frame) = match components {
        AngularVelocity::Body => (
            Rotation::Matrix(body.rotation()),
            Rotation::Matrix(seat.frame),
        ),
        AngularVelocity::World => (
            Rotation::Identity,
            Rotation::Matrix(body.rotation() * seat.frame),
        ),
    };
    End {
        position: body.position,
        velocity: body.velocity,
        omega: body.in_components(body.omega, components),
        outward,
        ..End::fixed(rotated(seat.point), frame)
    }
}

#[test]
fn an_angle_that_nothing_counts_is_within_half_a_turn_and_a_thread_counts_turns() {
    let mut random = Random::new(23);
    for (keyword, wanted) in [("hinge", 4.0 - std::f64::consts::TAU), ("screw", 4.0)] {
        let (law, numbers) = all_joints()
            .into_iter()
            .find(|(law, _)| law.keyword() == keyword)
            .expect("in the list");
        let seats = [Seat::random(&mut random), Seat::random(&mut random)];
        let scene = pair(&law, seats, AngularVelocity::Body);
        let mut rotated = Coordinates::random(&law, numbers, &mut random);
        rotated.q[0] = 4.0;
        let parent = Instance::random(&mut random);
        let child = carried(&law, seats, &parent, &rotated);
        let state = state(&scene, &[parent, child], &[]);
        let measured = evaluate(&scene, Quantity::Outputs, &state, &[], &[]);
        assert_close(&measured[..1], &[wanted], 1e-13, 0.0, keyword);
    }
}
