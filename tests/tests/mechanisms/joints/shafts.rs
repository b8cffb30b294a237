//! Two shafts at an angle: what a joint between them does to their speeds.

use mbd_runtime::{Generic, Options, Simulation};
use mbd_scene::{Layout, Quantity, Scene};
use nalgebra::{UnitQuaternion, Vector3};
use tests::assert_close;
use tests::declared::read;
use tests::mechanism::{Instance, state};

/// A shaft along z and one that is tilted from it by a bend [deg] about y, joined where they cross.
fn shafts(joint: &str, bend: f64, components: &str) -> Scene {
    read(&format!(
        "model Shafts {{
            gravity: none;
            angular_velocity: {components};
            world {{ frame tilted at [0, 0, 0] m rotated rpy(0, {bend} deg, 0) }}
            body one {{ mass: 1 kg, inertia: diag(0.02, 0.02, 0.03) kg*m^2 }}
            body two {{ mass: 1 kg, inertia: diag(0.03, 0.03, 0.05) kg*m^2 }}
            joint first: hinge from world to one.com {{ axis: z }}
            joint second: hinge from world.tilted to two.com {{ axis: z }}
            loop joint bend: {joint} from one.com to two.com;
            output turned = first.angle;
            output speed = first.angle_rate;
            output driven = second.angle_rate;
        }}"
    ))
}

/// Angle and speed of the first shaft and speed of the second over two seconds of a run, and the kinetic energy.
fn spun(scene: &Scene, bend: f64, mut look: impl FnMut([f64; 3], f64)) {
    let tilt = UnitQuaternion::from_scaled_axis(Vector3::y() * bend.to_radians());
    let one = Instance {
        omega: Vector3::z() * 9.0,
        ..Instance::rest()
    };
    let two = Instance {
        attitude: tilt,
        omega: tilt * Vector3::z() * 9.0,
        ..Instance::rest()
    };
    let model = Generic::<f64>::with_defaults(scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options");
    run.set_state(0.0, &state(scene, &[one, two], &[]))
        .expect("a state");
    run.start().unwrap_or_else(|error| panic!("{error}"));
    for k in 1..=100 {
        run.run(f64::from(k) * 0.02)
            .unwrap_or_else(|error| panic!("{error}"));
        let (mut out, mut energy) = ([0.0; 3], [0.0; 6]);
        run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
        run.evaluate(Quantity::Energy, &mut energy).expect("energy");
        look(out, energy[0]);
    }
}

#[test]
fn a_constant_velocity_joint_turns_both_shafts_alike_at_any_bend() {
    for components in ["body", "world"] {
        for bend in [0.0, 20.0, 45.0, 60.0] {
            let scene = shafts("constant_velocity", bend, components);
            let layout = Layout::new(&scene);
            assert_eq!((layout.freedoms(), layout.redundancy.closed), (1, true));
            spun(&scene, bend, |[_, speed, driven], energy| {
                assert_close(&[driven], &[speed], 1e-11, 0.0, &format!("{bend} deg"));
                // Nothing accelerates two shafts that turn alike.
                let alone = 0.5 * (0.03 + 0.05) * speed * speed;
                assert_close(&[energy], &[alone], 1e-10, 0.0, "energy");
                assert_close(&[speed], &[9.0], 1e-10, 0.0, "speed");
            });
        }
    }
}

#[test]
fn a_universal_joint_turns_the_second_shaft_by_hookes_formula() {
    for bend in [20.0f64, 45.0, 60.0] {
        let scene = shafts("universal", bend, "body");
        let (sin, cos) = bend.to_radians().sin_cos();
        let mut extremes = [f64::INFINITY, 0.0f64];
        spun(&scene, bend, |[angle, speed, driven], _| {
            let ratio = cos / (1.0 - (sin * angle.cos()).powi(2));
            assert_close(
                &[driven / speed],
                &[ratio],
                1e-9,
                0.0,
                &format!("{bend} deg"),
            );
            extremes = [extremes[0].min(ratio), extremes[1].max(ratio)];
        });
        // Both ends of the range are passed.
        assert!(
            extremes[0] < 1.02 * cos && extremes[1] > 0.98 / cos,
            "{extremes:?}"
        );
    }
}
