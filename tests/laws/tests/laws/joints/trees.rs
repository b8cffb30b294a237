//! Trees of mixed joints and robots in absolute coordinates, against Pinocchio's recursions in joint coordinates.

use laws::assert_close;
use laws::mechanism::{Instance, evaluate, state};
use laws::reference::{field, load};
use laws::system::{instances, list, scene, three};
use mbd_scene::{AngularVelocity, Layout, Quantity};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];

#[test]
fn trees_of_mixed_joints_accelerate_and_react_as_in_joint_coordinates() {
    for tree in ["tree_a_05", "tree_a_07", "tree_a_09"] {
        let file = load(&format!("trees/{tree}.json"));
        for components in COMPONENTS {
            let scene = scene(&file["system"], components);
            let layout = Layout::new(&scene);
            for (index, stored) in list(&file["states"]).iter().enumerate() {
                let name = format!("{tree} state {index} {components:?}");
                let bodies = instances(&stored["bodies"]);
                let x = state(&scene, &bodies, &[]);
                let get = |what| evaluate(&scene, what, &x, &[], &[]);
                let loose = &stored["tau0"];
                let want: Vec<f64> = (0..bodies.len())
                    .flat_map(|body| {
                        let alpha = Vector3::from(three(&loose["alpha_world"][body]));
                        let alpha = bodies[body].in_components(alpha, components);
                        let linear = three(&loose["rddot"][body]);
                        [linear, alpha.into()].concat()
                    })
                    .collect();
                let got = get(Quantity::Derivative);
                assert_close(&got[layout.nq..], &want, 1e-12, 0.0, &name);
                let want = field(loose, "lam");
                let got = get(Quantity::Multipliers);
                assert_close(&got, &want, 1e-12, 0.0, &format!("{name}: λ"));
                let reaction = &loose["reaction_on_child_at_frame2"];
                let want: Vec<f64> = (0..scene.joints.len())
                    .flat_map(|joint| {
                        let force = three(&reaction["force_world"][joint]);
                        [force, three(&reaction["torque_world"][joint])].concat()
                    })
                    .collect();
                let got = get(Quantity::Reactions);
                assert_close(&got, &want, 1e-12, 0.0, &format!("{name}: reactions"));
                let kinetic = stored["kinetic_energy"].as_f64().expect("an energy");
                let got = get(Quantity::Energy);
                assert_close(&got[..1], &[kinetic], 1e-12, 0.0, &format!("{name}: T"));
            }
        }
    }
}

#[test]
fn robots_fall_as_in_joint_coordinates() {
    for robot in ["robot_panda", "robot_ur5", "robot_solo12"] {
        let file = load(&format!("robots/{robot}.json"));
        let joints = list(&file["system"]["joints"]);
        for components in COMPONENTS {
            let scene = scene(&file["system"], components);
            let layout = Layout::new(&scene);
            // Some of the states have their bodies in absolute coordinates.
            let states = list(&file["states"]).iter().enumerate();
            let placed = states.filter(|(_, stored)| stored["bodies"].get("quat").is_some());
            for (index, stored) in placed {
                let bodies = instances(&stored["bodies"]);
                let x = state(&scene, &bodies, &[]);
                let rates = evaluate(&scene, Quantity::Derivative, &x, &[], &[]);
                let accelerations = &rates[layout.nq..];
                let (mut got, mut want) = (Vec::new(), Vec::new());
                let all = field(stored, "vdot_tau0");
                for (joint, place) in joints.iter().zip(list(&file["layout"])) {
                    if joint["type"] != "free" {
                        got.push(joint_acceleration(
                            joint,
                            &bodies,
                            accelerations,
                            components,
                        ));
                        let at = place["v0"].as_u64().expect("an index") as usize;
                        want.push(all[at]);
                    }
                }
                let name = format!("{robot} state {index} {components:?}");
                assert_close(&got, &want, 1e-12, 0.0, &name);
            }
        }
    }
}

/// A point of a body with the axis z of a joint frame there.
struct Mark {
    axis: Vector3<f64>,
    omega: Vector3<f64>,
    position: Vector3<f64>,
    acceleration: Vector3<f64>,
    alpha: Vector3<f64>,
}

/// The acceleration of a hinge's angle, or of a slide along its axis.
fn joint_acceleration(
    joint: &Value,
    bodies: &[Instance],
    accelerations: &[f64],
    components: AngularVelocity,
) -> f64 {
    let mark = |body: &str, point: &str, axes: &str| {
        let body = usize::try_from(joint[body].as_i64().expect("an index")).ok();
        let (still, rest) = (Instance::rest(), [0.0; 6]);
        let (body, moves) = body.map_or((&still, &rest[..]), |body| {
            (&bodies[body], &accelerations[6 * body..6 * body + 6])
        });
        let rotation = body.rotation();
        let arm = rotation * Vector3::from(three(&joint[point]));
        let spin = Vector3::from_column_slice(&moves[3..]);
        let alpha = match components {
            AngularVelocity::Body => rotation * spin,
            AngularVelocity::World => spin,
        };
        let omega = body.omega;
        Mark {
            axis: rotation * Matrix3::from_row_slice(&field(joint, axes)).column(2),
            omega,
            position: body.position + arm,
            acceleration: Vector3::from_column_slice(&moves[..3])
                + alpha.cross(&arm)
                + omega.cross(&omega.cross(&arm)),
            alpha,
        }
    };
    let (parent, child) = (mark("parent", "p1", "R1"), mark("child", "p2", "R2"));
    if joint["type"] == "hinge" {
        return (child.alpha - parent.alpha).dot(&parent.axis);
    }
    let way = (child.position - parent.position).dot(&parent.axis);
    (child.acceleration - parent.acceleration).dot(&parent.axis)
        + way * parent.omega.cross(&parent.axis).norm_squared()
}
