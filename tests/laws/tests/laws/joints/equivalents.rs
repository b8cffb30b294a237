//! Joints without reference data against joints that have it, and against closed forms.

use laws::assert_close;
use laws::mechanism::{
    Coordinates, Instance, Seat, add_body, add_external_loads, add_frame, add_joint, add_point,
    carried, empty, evaluate, inertia, state,
};
use laws::random::Random;
use mbd_scene::joints::{
    Axis, ConstantAngle, Cylindrical, Distance, Hinge, JointLaw, Planar, PointOnLine, PointOnPlane,
    Rigid, Screw, Spherical, Universal,
};
use mbd_scene::{AngularVelocity, Layout, Place, Quantity, Scene};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

fn square(a: Axis, b: Axis) -> JointLaw {
    JointLaw::ConstantAngle(ConstantAngle {
        axes: [a, b],
        angle: FRAC_PI_2.into(),
    })
}

/// Two bodies held by several joints between the same two frames.
fn held(seats: [Seat; 2], laws: &[JointLaw]) -> Scene {
    let mut scene = empty([0.1, 0.2, -9.81], AngularVelocity::Body);
    let mut random = Random::new(77);
    let one = add_body(&mut scene, 1.3, &inertia(&mut random));
    let two = add_body(&mut scene, 0.8, &inertia(&mut random));
    let from = add_frame(&mut scene, Some(one), seats[0].declared("one"));
    let to = add_frame(&mut scene, Some(two), seats[1].declared("two"));
    for law in laws {
        add_joint(&mut scene, law.clone(), from, to);
    }
    add_external_loads(&mut scene);
    scene
}

#[test]
fn a_joint_moves_like_the_joints_it_is_made_of() {
    use Axis as A;
    let z = A::Z;
    let plane = |axis| JointLaw::PointOnPlane(PointOnPlane { axis });
    let spherical = JointLaw::Spherical(Spherical {});
    let upright = [square(A::X, z), square(A::Y, z)];
    let line = JointLaw::PointOnLine(PointOnLine { axis: z });
    let pairs: Vec<(JointLaw, Vec<JointLaw>)> = vec![
        (
            JointLaw::Hinge(Hinge { axis: z }),
            [vec![spherical.clone()], upright.to_vec()].concat(),
        ),
        (
            JointLaw::Rigid(Rigid {}),
            vec![
                spherical.clone(),
                square(A::X, A::Y),
                square(A::Y, A::Z),
                square(A::Z, A::X),
            ],
        ),
        (
            JointLaw::Universal(Universal::default()),
            vec![spherical, square(A::X, A::Y)],
        ),
        (line.clone(), vec![plane(A::X), plane(A::Y)]),
        (
            JointLaw::Cylindrical(Cylindrical { axis: z }),
            [vec![line], upright.to_vec()].concat(),
        ),
        (
            JointLaw::Planar(Planar { axis: z }),
            [vec![plane(z)], upright.to_vec()].concat(),
        ),
    ];
    let mut random = Random::new(12);
    for (whole, parts) in pairs {
        for trial in 0..5 {
            let seats = [Seat::random(&mut random), Seat::random(&mut random)];
            let parent = Instance::random(&mut random);
            let at = Coordinates::random(&whole, Vec::new(), &mut random);
            let bodies = [parent, carried(&whole, seats, &parent, &at)];
            let rate = |laws: &[JointLaw]| {
                let scene = held(seats, laws);
                let ni = Layout::new(&scene).ni;
                let inputs: Vec<f64> = (0..ni).map(|i| (i as f64 * 1.7).sin() * 5.0).collect();
                let x = state(&scene, &bodies, &[]);
                evaluate(&scene, Quantity::Derivative, &x, &inputs, &[])
            };
            let name = format!("{}, {trial}", whole.keyword());
            assert_close(
                &rate(&parts),
                &rate(std::slice::from_ref(&whole)),
                1e-12,
                0.0,
                &name,
            );
        }
    }
}

#[test]
fn a_point_on_a_rod_is_a_pendulum() {
    let (mass, length, g) = (0.7, 1.4, 9.81);
    let mut scene = empty([0.0, 0.0, -g], AngularVelocity::Body);
    let point = add_point(&mut scene, mass);
    let rod = JointLaw::Distance(Distance {
        length: length.into(),
    });
    add_joint(&mut scene, rod, Place::World(0), point);
    let (angle, speed) = (0.6f64, 1.9);
    let (sin, cos) = angle.sin_cos();
    let bob = Instance {
        position: Vector3::new(length * sin, 0.0, -length * cos),
        velocity: Vector3::new(cos, 0.0, sin) * (length * speed),
        ..Instance::rest()
    };
    let x = state(&scene, &[], &[bob]);
    let rate = evaluate(&scene, Quantity::Derivative, &x, &[], &[]);
    let (turn, pull) = (-g / length * sin, length * speed * speed);
    let want = Vector3::new(cos, 0.0, sin) * (length * turn) + Vector3::new(-sin, 0.0, cos) * pull;
    assert_close(&rate[3..], want.as_slice(), 1e-14, 0.0, "acceleration");
    let tension = mass * (g * cos + pull);
    let multiplier = evaluate(&scene, Quantity::Multipliers, &x, &[], &[]);
    assert_close(&multiplier, &[-tension], 1e-14, 0.0, "multiplier");
}

#[test]
fn a_nut_on_a_vertical_thread_falls_as_its_inertia_lets_it() {
    let (mass, spin, pitch, g) = (1.6, 0.02, 0.3, 9.81);
    let mut scene = empty([0.0, 0.0, -g], AngularVelocity::Body);
    let moments = Vector3::new(0.03, 0.03, spin);
    let nut = add_body(&mut scene, mass, &Matrix3::from_diagonal(&moments));
    let thread = JointLaw::Screw(Screw {
        axis: Axis::Z,
        pitch: pitch.into(),
    });
    add_joint(&mut scene, thread, Place::World(0), Place::Body(nut, 0));
    let lead = pitch / TAU;
    for angle in [0.4f64, 2.9, 7.5, -40.0] {
        let half = angle / 2.0;
        let at = Instance {
            position: Vector3::new(0.0, 0.0, lead * angle),
            attitude: UnitQuaternion::from_quaternion(Quaternion::new(
                half.cos(),
                0.0,
                0.0,
                half.sin(),
            )),
            velocity: Vector3::new(0.0, 0.0, lead * 3.0),
            omega: Vector3::new(0.0, 0.0, 3.0),
            ..Instance::rest()
        };
        let x = state(&scene, &[at], &[]);
        let rate = evaluate(&scene, Quantity::Derivative, &x, &[], &[]);
        let turn = -mass * g * lead / (mass * lead * lead + spin);
        let want = [0.0, 0.0, lead * turn, 0.0, 0.0, turn];
        assert_close(&rate[7..], &want, 1e-12, 0.0, &format!("at {angle} rad"));
    }
}
