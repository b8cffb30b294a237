//! Joints and loops against numbers of independent tools: rows, Jacobians, γ, accelerations, multipliers, reactions.

use laws::mechanism::{Instance, add_external_loads, evaluate, state};
use laws::reference::{JOINTS, field, load, numbers};
use laws::system::{bodies, instances, three};
use laws::{assert_close, system};
use mbd_scene::{AngularVelocity, Layout, Quantity, Scene};
use nalgebra::Vector3;
use serde_json::Value;

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];
/// A scene with a force and a couple on every body.
fn scene(file: &Value, components: AngularVelocity) -> Scene {
    let mut scene = system::scene(&file["system"], components);
    add_external_loads(&mut scene);
    scene
}

/// v̇ of a derivative, in the layout of [rddot, alpha] a body.
fn accelerations(scene: &Scene, bodies: &[Instance], inputs: &[f64]) -> Vec<f64> {
    let layout = Layout::new(scene);
    let x = state(scene, bodies, &[]);
    evaluate(scene, Quantity::Derivative, &x, inputs, &[])[layout.nq..].to_vec()
}

#[test]
fn rows_jacobians_and_bias_are_the_canonical_ones_on_and_off_the_manifold() {
    for joint in JOINTS {
        let file = load(&format!("joints/joint_{joint}_a.json"));
        for components in COMPONENTS {
            let scene = scene(&file, components);
            for list in ["states", "off_manifold_states"] {
                for (index, stored) in file[list].as_array().expect("states").iter().enumerate() {
                    let x = state(&scene, &instances(stored), &[]);
                    let name = format!("{joint} {list} {index} {components:?}");
                    let check = |what: Quantity, want: &str| {
                        let got = evaluate(&scene, what, &x, &[], &[]);
                        let want = field(stored, want);
                        assert_close(&got, &want, 1e-12, 1e-13, &format!("{name}: {what:?}"));
                    };
                    check(Quantity::Constraint, "phi");
                    check(Quantity::ConstraintBias, "gamma");
                    check(
                        Quantity::ConstraintJacobian,
                        match components {
                            AngularVelocity::Body => "jac_body",
                            AngularVelocity::World => "jac_world",
                        },
                    );
                    if list == "off_manifold_states" {
                        check(Quantity::ConstraintRate, "phidot");
                    }
                }
            }
        }
    }
}

#[test]
fn accelerations_multipliers_and_reactions_are_those_of_minimal_coordinates() {
    for joint in JOINTS {
        let file = load(&format!("joints/joint_{joint}_a.json"));
        for components in COMPONENTS {
            let scene = scene(&file, components);
            for (index, stored) in file["states"]
                .as_array()
                .expect("states")
                .iter()
                .enumerate()
            {
                let bodies = instances(stored);
                let x = state(&scene, &bodies, &[]);
                let applied = &stored["applied"];
                let inputs: Vec<f64> = (0..2)
                    .flat_map(|body| {
                        let force = numbers(&applied["force_world"][body]);
                        let couple = numbers(&applied["torque_com_world"][body]);
                        [force, couple].concat()
                    })
                    .collect();
                let name = format!("{joint} {index} {components:?}");
                let spin = match components {
                    AngularVelocity::Body => "alpha_body",
                    AngularVelocity::World => "alpha_world",
                };
                let want: Vec<f64> = (0..2)
                    .flat_map(|body| {
                        let linear = numbers(&stored["rddot"][body]);
                        [linear, numbers(&stored[spin][body])].concat()
                    })
                    .collect();
                let got = accelerations(&scene, &bodies, &inputs);
                assert_close(&got, &want, 1e-12, 0.0, &name);
                if joint == "free" {
                    continue;
                }
                let multipliers = evaluate(&scene, Quantity::Multipliers, &x, &inputs, &[]);
                let want = field(stored, "lam");
                assert_close(&multipliers, &want, 1e-12, 0.0, &format!("{name}: λ"));
                let reactions = evaluate(&scene, Quantity::Reactions, &x, &inputs, &[]);
                let reaction = &stored["reaction_on_child_at_frame2"];
                let want = [
                    field(reaction, "force_world"),
                    field(reaction, "torque_world"),
                ]
                .concat();
                let own = reactions.len() - 6;
                let name = format!("{name}: reaction");
                assert_close(&reactions[own..], &want, 1e-12, 0.0, &name);
            }
        }
    }
}

#[test]
fn a_closed_spatial_loop_accelerates_as_the_reference_does() {
    let file = load("loops/loop_RUSP.json");
    let history = &file["time_history"];
    let instants = history["t"].as_array().expect("times").len();
    for components in COMPONENTS {
        let scene = scene(&file, components);
        assert_eq!(Layout::new(&scene).nc, 17);
        for k in 0..instants {
            let of = |name: &str| &history[name][k];
            let bodies = bodies(of("r"), of("quat"), of("rdot"), of("omega_world"));
            let want: Vec<f64> = (0..3)
                .flat_map(|body| {
                    let alpha = Vector3::from(three(&history["alpha_world"][k][body]));
                    let alpha = bodies[body].in_components(alpha, components);
                    let linear = numbers(&history["rddot"][k][body]);
                    [linear, alpha.as_slice().to_vec()].concat()
                })
                .collect();
            let got = accelerations(&scene, &bodies, &[]);
            let name = format!("instant {k} {components:?}");
            assert_close(&got, &want, 2e-11, 0.0, &name);
            let x = state(&scene, &bodies, &[]);
            let multipliers = evaluate(&scene, Quantity::Multipliers, &x, &[], &[]);
            let want = numbers(&history["lam"][k]);
            assert_close(&multipliers, &want, 2e-11, 0.0, &format!("{name}: λ"));
            let rows = evaluate(&scene, Quantity::Constraint, &x, &[], &[]);
            assert_close(&rows, &[0.0; 17], 0.0, 1e-13, &format!("{name}: Φ"));
        }
    }
}
