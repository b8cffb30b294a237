//! What is told of a motion, differentiated along it: velocities are rates of places, accelerations rates of velocities, rows stay obeyed,
//! momentum changes by the forces. In both families, in space and in planes, with frames that move, motors and gears.

use laws::assert_close;
use laws::instant::Instant;
use laws::mechanism::{
    Seat, add_body, add_external_loads, add_frame, add_gear, add_joint, add_point, all_joints,
    empty, evaluate_at, frame, inertia, layout,
};
use laws::oracle::Oracle;
use laws::random::Random;
use mbd_scene::joints::JointLaw;
use mbd_scene::{
    AngularVelocity, Coordinates, Formula, Function, JointForces, LineKind, Output, Place, Plane,
    Quantity, Scene,
};
use nalgebra::{DMatrix, Matrix3, UnitQuaternion, Vector3};

use crate::things::{line, vector_output};

fn scalar_output(value: Formula) -> Output {
    Output {
        components: 1,
        ..vector_output(value)
    }
}

/// A sum, product … of two formulas.
fn of(function: Function, a: impl Into<Formula>, b: impl Into<Formula>) -> Formula {
    Formula::Apply(function, vec![a.into(), b.into()])
}

/// 0.3 + 0.4 t − 0.7 t².
fn course() -> Formula {
    let squared = of(Function::Mul, Formula::Time, Formula::Time);
    let straight = of(Function::Add, 0.3, of(Function::Mul, 0.4, Formula::Time));
    of(Function::Sub, straight, of(Function::Mul, 0.7, squared))
}

const AT: f64 = 0.6;

/// A random state: unit quaternions, everything else below one.
fn anywhere(scene: &Scene, random: &mut Random) -> Instant<f64> {
    let layout = layout(scene);
    let mut x: Vec<f64> = (0..layout.nx())
        .map(|_| random.uniform(-0.9, 0.9))
        .collect();
    for at in layout.quaternions() {
        x[at..at + 4].copy_from_slice(&random.attitude());
    }
    Instant {
        time: AT,
        state: x,
        hold: vec![0.0; layout.holds()],
        inputs: (0..layout.ni).map(|_| random.uniform(-3.0, 3.0)).collect(),
        ..Instant::default()
    }
}

/// A random state in which all joints hold, in the coordinates of the scene; `None` where a joint is a row in relative coordinates, too.
fn holding(scene: &Scene, random: &mut Random) -> Option<Instant<f64>> {
    let relative = scene.in_coordinates(Coordinates::Relative);
    let (of_links, of_bodies) = (layout(&relative), layout(scene));
    if of_links.nc > 0 {
        return None;
    }
    let mut at = anywhere(&relative, random);
    if scene.coordinates == Coordinates::Relative {
        return Some(at);
    }
    let per_q = of_bodies.directions.coordinates();
    let bodies = evaluate_at(&relative, Quantity::Bodies, &at.at());
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for body in bodies.chunks(of_bodies.directions.motion()) {
        let (place, speed) = body.split_at(per_q);
        q.extend_from_slice(place);
        v.extend_from_slice(speed);
    }
    // Points come behind the bodies in both.
    let (own_q, own_v) = (of_bodies.nq - q.len(), of_bodies.nv - v.len());
    q.extend_from_slice(&at.state[of_links.nq - own_q..of_links.nq]);
    let end = of_links.nq + of_links.nv;
    v.extend_from_slice(&at.state[end - own_v..end]);
    q.extend(v);
    at.state = q;
    at.hold = vec![0.0; of_bodies.holds()];
    Some(at)
}

/// A quantity with its rate along the motion that the laws give.
fn along(scene: &Scene, what: Quantity, at: &Instant<f64>) -> (Vec<f64>, Vec<f64>) {
    let slope = evaluate_at(scene, Quantity::Derivative, &at.at());
    let mut moving = at.map(Oracle::constant);
    for (number, rate) in moving.state.iter_mut().zip(slope) {
        number.0.eps = rate;
    }
    moving.time.0.eps = 1.0;
    let told = evaluate_at(scene, what, &moving.at());
    told.iter()
        .map(|number| (number.0.re, number.0.eps))
        .unzip()
}

/// Three bodies in a row from a frame that moves, by these laws, and a point; outputs in pairs, a thing and its rate.
fn row(
    laws: &[JointLaw],
    components: AngularVelocity,
    plane: Option<Plane>,
    random: &mut Random,
) -> Scene {
    let mut scene = empty([0.3, -0.2, -9.81], components);
    scene.planar = plane;
    let mut cart = frame("cart", [0.0; 3], None);
    let slope = |k: f64| of(Function::Mul, k, course());
    cart.position = match plane {
        None => [0.7, -0.4, 0.3].map(slope),
        Some(plane) => [0, 1, 2].map(|axis| match axis == plane.normal() {
            true => 0.0.into(),
            false => slope(0.5),
        }),
    };
    let mut from = add_frame(&mut scene, None, cart);
    let flat = |seat: Seat| match plane {
        None => seat,
        Some(plane) => {
            let mut point = seat.point;
            point[plane.normal()] = 0.0;
            Seat {
                point,
                frame: Matrix3::identity(),
            }
        }
    };
    let principal = Matrix3::from_diagonal(&Vector3::new(0.2, 0.3, 0.4));
    for law in laws {
        let inertia = if plane.is_some() {
            principal
        } else {
            inertia(random)
        };
        let body = add_body(&mut scene, random.uniform(0.5, 2.0), &inertia);
        let near = add_frame(
            &mut scene,
            Some(body),
            flat(Seat::random(random)).declared("near"),
        );
        add_joint(&mut scene, law.clone(), from, near);
        from = add_frame(
            &mut scene,
            Some(body),
            flat(Seat::random(random)).declared("far"),
        );
    }
    let bob = add_point(&mut scene, 0.7);
    scene
        .lines
        .push(line(LineKind::Spring, [from, bob], [0.3, 40.0, 2.0]));
    add_external_loads(&mut scene);
    let places: Vec<Place> = (0..laws.len())
        .flat_map(|body| [0, 1, 2].map(|frame| Place::Body(body, frame)))
        .chain([bob, Place::World(1)])
        .collect();
    for place in places {
        for told in [Formula::Position, Formula::Velocity, Formula::Acceleration] {
            scene.outputs.push(vector_output(told(place)));
        }
    }
    for body in 0..laws.len() {
        scene
            .outputs
            .push(vector_output(Formula::AngularVelocityWorld(body)));
        scene
            .outputs
            .push(vector_output(Formula::AngularAcceleration(body)));
    }
    for (joint, law) in laws.iter().enumerate() {
        for coordinate in 0..law.measured().count() {
            for told in [
                Formula::Coordinate,
                Formula::CoordinateRate,
                Formula::CoordinateAcceleration,
            ] {
                scene.outputs.push(scalar_output(told(joint, coordinate)));
            }
        }
    }
    scene
}

/// Calls `check` for rows of every joint, in both families and components, and for those of a plane.
fn everywhere(mut check: impl FnMut(&str, &Scene, &mut Random)) {
    let mut random = Random::new(61);
    let laws = all_joints();
    for (index, (law, _)) in laws.iter().enumerate() {
        let next = &laws[(index + 3) % laws.len()].0;
        for components in [AngularVelocity::Body, AngularVelocity::World] {
            let scene = row(&[law.clone(), next.clone()], components, None, &mut random);
            for family in [Coordinates::Absolute, Coordinates::Relative] {
                let scene = scene.in_coordinates(family);
                let name = format!("{law:?}, {next:?}, {components:?}, {family:?}");
                check(&name, &scene, &mut random);
            }
        }
    }
    for plane in [Plane::Xy, Plane::Xz, Plane::Yz] {
        let axis = mbd_scene::joints::Axis::unit(plane.normal());
        let hinge = JointLaw::Hinge(mbd_scene::joints::Hinge { axis });
        let free = JointLaw::Free(mbd_scene::Free {});
        for laws in [[hinge.clone(), hinge.clone()], [free, hinge]] {
            let scene = row(&laws, AngularVelocity::Body, Some(plane), &mut random);
            for family in [Coordinates::Absolute, Coordinates::Relative] {
                let scene = scene.in_coordinates(family);
                check(
                    &format!("{plane:?}, {laws:?}, {family:?}"),
                    &scene,
                    &mut random,
                );
            }
        }
    }
}

#[test]
fn velocities_are_the_rates_of_places_and_accelerations_those_of_velocities() {
    let mut held = 0;
    everywhere(|name, scene, random| {
        let Some(at) = holding(scene, random) else {
            return;
        };
        held += 1;
        let (values, rates) = along(scene, Quantity::Outputs, &at);
        let mut column = 0;
        let columns: Vec<usize> = scene
            .outputs
            .iter()
            .map(|output| {
                column += output.components;
                column - output.components
            })
            .collect();
        let told = |index: usize, list: &[f64]| {
            list[columns[index]..columns[index] + scene.outputs[index].components].to_vec()
        };
        for index in 1..scene.outputs.len() {
            let pair = (&scene.outputs[index - 1].value, &scene.outputs[index].value);
            let follows = matches!(
                pair,
                (Formula::Position(_), Formula::Velocity(_))
                    | (Formula::Velocity(_), Formula::Acceleration(_))
                    | (
                        Formula::AngularVelocityWorld(_),
                        Formula::AngularAcceleration(_)
                    )
                    | (Formula::Coordinate(..), Formula::CoordinateRate(..))
                    | (
                        Formula::CoordinateRate(..),
                        Formula::CoordinateAcceleration(..)
                    )
            );
            if follows {
                let (got, want) = (told(index, &values), told(index - 1, &rates));
                assert_close(&got, &want, 1e-8, 1e-8, &format!("{name}: {pair:?}"));
            }
        }
        // The same coordinates where they are asked for alone, with given accelerations.
        let layout = layout(scene);
        let slope = evaluate_at(scene, Quantity::Derivative, &at.at());
        let mut asked = at.clone();
        asked.rows = slope[layout.nq..layout.nq + layout.nv].to_vec();
        let got = evaluate_at(scene, Quantity::JointCoordinates, &asked.at());
        let pairs = evaluate_at(scene, Quantity::Coordinates, &at.at());
        let first = scene
            .outputs
            .iter()
            .position(|o| matches!(o.value, Formula::Coordinate(..)));
        let want = first.map_or(&[][..], |first| &values[columns[first]..]);
        assert_close(&got, want, 1e-9, 1e-9, name);
        for (got, pair) in got.chunks(3).zip(pairs.chunks(2)) {
            assert_close(&got[..2], pair, 1e-14, 1e-14, name);
        }
    });
    assert!(held > 40, "{held}");
}

/// Asserts Φ_v v̇ = γ.
fn obeyed(name: &str, scene: &Scene, at: &Instant<f64>) {
    let layout = layout(scene);
    let jacobian = evaluate_at(scene, Quantity::ConstraintJacobian, &at.at());
    let jacobian = DMatrix::from_row_slice(layout.nc, layout.nv, &jacobian);
    let slope = evaluate_at(scene, Quantity::Derivative, &at.at());
    let rate = DMatrix::from_column_slice(layout.nv, 1, &slope[layout.nq..layout.nq + layout.nv]);
    let bias = evaluate_at(scene, Quantity::ConstraintBias, &at.at());
    assert_close((jacobian * rate).as_slice(), &bias, 1e-7, 1e-7, name);
}

#[test]
fn rows_change_as_their_rates_say_and_accelerations_keep_those() {
    everywhere(|name, scene, random| {
        let at = anywhere(scene, random);
        let layout = layout(scene);
        if layout.nc == 0 {
            return;
        }
        let (_, rates) = along(scene, Quantity::Constraint, &at);
        let told = evaluate_at(scene, Quantity::ConstraintRate, &at.at());
        assert_close(&rates, &told, 1e-10, 1e-10, name);
        let (_, change) = along(scene, Quantity::ConstraintRate, &at);
        assert_close(&change, &vec![0.0; layout.nc], 0.0, 1e-6, name);
        obeyed(name, scene, &at);
    });
}

#[test]
fn jacobians_give_velocities_and_the_mass_matrix_gives_energy() {
    everywhere(|name, scene, random| {
        let mut scene = scene.clone();
        // Nothing moves by itself: all velocities are those of the speeds.
        scene.world_frames[1] = frame("still", [0.2, 0.0, 0.0], None);
        if let Some(plane) = scene.planar {
            scene.world_frames[1].position[plane.normal()] = 0.0.into();
        }
        let scene = &scene;
        let layout = layout(scene);
        let at = anywhere(scene, random);
        let v =
            DMatrix::from_column_slice(layout.nv, 1, &at.state[layout.nq..layout.nq + layout.nv]);
        let matrix = |what: Quantity, rows: usize| {
            DMatrix::from_row_slice(rows, layout.nv, &evaluate_at(scene, what, &at.at()))
        };
        let told = evaluate_at(scene, Quantity::Outputs, &at.at());
        let mut column = 0;
        for output in &scene.outputs {
            if let Formula::Velocity(Place::Body(body, frame)) = output.value {
                let got = matrix(Quantity::FrameJacobian(body, frame), 6) * &v;
                let want = &told[column..column + 3];
                assert_close(&got.as_slice()[..3], want, 1e-11, 1e-11, name);
            }
            if let Formula::AngularVelocityWorld(body) = output.value {
                let got = matrix(Quantity::FrameJacobian(body, 1), 6) * &v;
                let want = &told[column..column + 3];
                assert_close(&got.as_slice()[3..], want, 1e-11, 1e-11, name);
            }
            column += output.components;
        }
        let centre = evaluate_at(scene, Quantity::CentreOfMass, &at.at());
        let got = matrix(Quantity::CentreOfMassJacobian, 3) * &v;
        assert_close(got.as_slice(), &centre[3..], 1e-11, 1e-11, name);
        let mass = matrix(Quantity::MassMatrix, layout.nv);
        let energy = evaluate_at(scene, Quantity::Energy, &at.at());
        let kinetic = 0.5 * (v.transpose() * &mass * &v)[0];
        assert_close(&[kinetic], &energy[..1], 1e-11, 1e-12, name);
        assert_close(
            mass.as_slice(),
            mass.transpose().as_slice(),
            1e-13,
            0.0,
            name,
        );
    });
}

#[test]
fn momentum_changes_by_weight_loads_and_what_the_first_joint_carries() {
    everywhere(|name, scene, random| {
        if scene.planar.is_some() {
            return;
        }
        // One body on a still frame, beside it nothing.
        let mut scene = scene.clone();
        scene.world_frames[1] = frame("still", [0.2, -0.1, 0.3], None);
        scene.joints.truncate(1);
        scene.bodies.truncate(1);
        scene.points.clear();
        scene.lines.clear();
        scene.loads.truncate(1);
        scene.outputs = vec![
            vector_output(Formula::ReactionForce(0)),
            vector_output(Formula::ReactionTorque(0)),
            vector_output(Formula::Position(scene.joints[0].child)),
            vector_output(Formula::Position(Place::Body(0, 0))),
        ];
        let Some(at) = holding(&scene, random) else {
            return;
        };
        let (_, change) = along(&scene, Quantity::Momentum, &at);
        let told = evaluate_at(&scene, Quantity::Outputs, &at.at());
        let three = |at: usize| Vector3::from_column_slice(&told[at..at + 3]);
        let (reaction, couple, joint, centre) = (three(0), three(3), three(6), three(9));
        let mass = crate::things::mass(&scene.bodies[0]);
        let push = Vector3::from_column_slice(&at.inputs[..3]);
        let twist = Vector3::from_column_slice(&at.inputs[3..6]);
        let weight = Vector3::new(0.3, -0.2, -9.81) * mass;
        let force = weight + push + reaction;
        let torque = centre.cross(&(weight + push)) + twist + joint.cross(&reaction) + couple;
        assert_close(&change[..3], force.as_slice(), 1e-9, 1e-9, name);
        assert_close(&change[3..], torque.as_slice(), 1e-8, 1e-8, name);
    });
}

#[test]
fn a_motor_asks_for_its_course_and_gears_for_their_ratio() {
    let mut random = Random::new(63);
    for (law, _) in all_joints() {
        let count = law.measured().count();
        for components in [AngularVelocity::Body, AngularVelocity::World] {
            if count == 0 {
                continue;
            }
            let mut scene = row(&[law.clone(), law.clone()], components, None, &mut random);
            scene.outputs.clear();
            scene.joints[0].forces = (0..count)
                .map(|coordinate| JointForces {
                    coordinate,
                    motor: Some(course()),
                    ..JointForces::default()
                })
                .collect();
            let (ratio, offset) = (-0.8, 0.15);
            add_gear(&mut scene, [(1, count - 1), (0, 0)], ratio.into(), offset);
            let layout = layout(&scene);
            // Where the joints hold, as they do without motors and gears.
            let mut free = scene.clone();
            free.joints.truncate(2);
            free.joints[0].forces.clear();
            let Some(at) = holding(&free, &mut random) else {
                continue;
            };
            let rows = evaluate_at(&scene, Quantity::Constraint, &at.at());
            let told = evaluate_at(&scene, Quantity::Coordinates, &at.at());
            let value = |joint: usize, coordinate: usize| told[2 * (count * joint + coordinate)];
            let name = format!("{law:?}, {components:?}");
            // Up to full turns of angles: what is nearest to zero.
            let near = |x: f64, periodic: Option<f64>| match periodic {
                Some(m) => m * (x / m).sin().atan2((x / m).cos()),
                None => x,
            };
            let periodic = |k: usize| law.coordinate(k).is_some_and(|c| c.is_periodic());
            let first = layout.joints[0].row + layout.joints[0].law.len();
            let want = 0.3 + 0.4 * AT - 0.7 * AT * AT;
            for k in 0..count {
                let want = match periodic(k) {
                    true => f64::sin(value(0, k) - want),
                    false => value(0, k) - want,
                };
                assert_close(
                    &rows[first + k..first + k + 1],
                    &[want],
                    1e-12,
                    1e-12,
                    &name,
                );
            }
            let both = value(1, count - 1) - ratio * value(0, 0) - offset;
            let measure = match [periodic(count - 1), periodic(0)] {
                [true, true] => Some(0.2),
                [true, false] => Some(1.0),
                [false, true] => Some(0.8),
                [false, false] => None,
            };
            let got = rows[layout.joints[2].row];
            assert_close(&[got], &[near(both, measure)], 1e-11, 1e-11, &name);
            // And all of them along the motion.
            let (_, rates) = along(&scene, Quantity::Constraint, &at);
            let told = evaluate_at(&scene, Quantity::ConstraintRate, &at.at());
            assert_close(&rates, &told, 1e-10, 1e-10, &name);
            let independent = layout.redundancy.repeats.is_empty();
            let (_, change) = along(&scene, Quantity::ConstraintRate, &at);
            if independent {
                assert_close(&change, &vec![0.0; layout.nc], 0.0, 1e-5, &name);
                obeyed(&name, &scene, &at);
            }
        }
    }
}

#[test]
fn the_rotation_of_a_body_is_told_as_its_axis_times_its_angle() {
    let mut random = Random::new(64);
    let mut scene = empty([0.0; 3], AngularVelocity::Body);
    add_body(&mut scene, 1.0, &inertia(&mut random));
    scene.outputs.push(vector_output(Formula::Orientation(0)));
    for k in 0..3 {
        scene
            .outputs
            .push(vector_output(Formula::Axis(Place::Body(0, 0), k)));
    }
    for size in [0.0, 1e-9, 1e-4, 0.3, 2.0, 3.1] {
        for sign in [1.0, -1.0] {
            let turn = crate::things::direction(&mut random) * size;
            let q = UnitQuaternion::from_scaled_axis(turn).into_inner() * sign;
            let mut at = anywhere(&scene, &mut random);
            at.state[3..7].copy_from_slice(&[q.w, q.i, q.j, q.k]);
            let told = evaluate_at(&scene, Quantity::Outputs, &at.at());
            assert_close(&told[..3], turn.as_slice(), 1e-12, 1e-22, "turn");
            let axes = UnitQuaternion::from_scaled_axis(turn).to_rotation_matrix();
            assert_close(&told[3..], axes.matrix().as_slice(), 1e-12, 1e-13, "axes");
        }
    }
}
