//! Trees and robots in joint coordinates: mass matrix, bias, accelerations, torques of Pinocchio.

use laws::assert_close;
use laws::mechanism::{evaluate, layout, state};
use laws::reference::{field, load};
use laws::relative::Both;
use laws::system::{instances, list, scene};
use mbd_scene::joints::JointForces;
use mbd_scene::{
    AngularVelocity, Coordinates, Formula, Input, Layout, Part, Quantity, Scene, Unit,
};
use nalgebra::{DMatrix, DVector, Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;

/// Where the speeds of a joint stand in the data.
fn stored(place: &Value) -> std::ops::Range<usize> {
    let number = |name: &str| place[name].as_u64().expect("an index") as usize;
    number("v0")..number("v0") + number("nv")
}

#[test]
fn trees_have_the_mass_matrix_bias_and_accelerations_of_joint_coordinates() {
    for case in ["tree_a_05", "tree_a_07", "tree_a_09"] {
        let file = load(&format!("trees/{case}.json"));
        let scene = scene(&file["system"], AngularVelocity::Body);
        let places = list(&file["layout"]);
        for (index, moment) in list(&file["states"]).iter().enumerate() {
            let name = |what: &str| format!("{case} state {index}: {what}");
            let both = Both::new(&scene, &state(&scene, &instances(&moment["bodies"]), &[]));
            let layout = &both.layout;
            let (nq, nv) = (layout.nq, layout.nv);
            assert_eq!(
                nv,
                file["nv"].as_u64().expect("a number") as usize,
                "{}",
                name("speeds")
            );
            // Every joint of the data but a free one is a joint of the tree, its speeds in the same order.
            let joints: Vec<(usize, usize)> = places
                .iter()
                .enumerate()
                .filter_map(|(joint, place)| {
                    let link = layout.carried(joint)?;
                    Some((link.slots.v, stored(place).start))
                })
                .flat_map(|(own, from)| {
                    let place = places
                        .iter()
                        .find(|place| stored(place).start == from)
                        .expect("a joint");
                    (0..stored(place).len()).map(move |k| (own + k, from + k))
                })
                .collect();
            let mass = both.get(Quantity::MassMatrix, &[], &[]);
            let lower = list(&moment["mass_matrix_lower"]);
            let want = |i: usize, j: usize| lower[i.max(j)][i.min(j)].as_f64().expect("a number");
            for &(i, a) in &joints {
                for &(j, b) in &joints {
                    assert_close(&[mass[i * nv + j]], &[want(a, b)], 1e-12, 1e-12, &name("M"));
                }
            }
            let accelerations = field(&moment["tau0"], "vdot");
            let rates = both.get(Quantity::Derivative, &[], &[]);
            let got: Vec<f64> = joints.iter().map(|&(own, _)| rates[nq + own]).collect();
            let want: Vec<f64> = joints
                .iter()
                .map(|&(_, from)| accelerations[from])
                .collect();
            assert_close(&got, &want, 1e-12, 0.0, &name("v̇"));
            // With a fixed base the bias is that of the data; a free one has other speeds.
            if joints.len() == nv {
                let bias = both.get(Quantity::BiasForce, &[], &[]);
                let got: Vec<f64> = joints.iter().map(|&(own, _)| bias[own]).collect();
                let all = field(moment, "bias");
                let want: Vec<f64> = joints.iter().map(|&(_, from)| all[from]).collect();
                assert_close(&got, &want, 1e-12, 1e-12, &name("h"));
            }
        }
    }
}

/// A robot of the data at one of its states, an input along every joint.
struct Robot {
    scene: Scene,
    layout: std::rc::Rc<Layout>,
    state: Vec<f64>,
    /// The speeds of the state from those of the data, v = T u: the velocity of a base that floats is in its own axes there.
    speeds: DMatrix<f64>,
    /// Ṫ u.
    moving: DVector<f64>,
}

impl Robot {
    fn get(&self, what: Quantity, inputs: &[f64], rows: &[f64]) -> DVector<f64> {
        DVector::from_vec(evaluate(&self.scene, what, &self.state, inputs, rows))
    }

    /// Accelerations v̇ = T u̇ + Ṫ u.
    fn accelerations(&self, of_data: Vec<f64>) -> Vec<f64> {
        let found = &self.speeds * DVector::from_vec(of_data) + &self.moving;
        found.as_slice().to_vec()
    }

    /// Accelerations of the data.
    fn of_data(&self, accelerations: &DVector<f64>) -> DVector<f64> {
        self.speeds.transpose() * (accelerations - &self.moving)
    }
}

/// The scene of a robot, an input along the coordinate of every joint that has one.
fn driven(file: &Value) -> Scene {
    let mut scene = scene(&file["system"], AngularVelocity::Body);
    for joint in &mut scene.joints {
        if joint.law.coordinates() == 1 {
            joint.forces.push(JointForces {
                force: Some(Formula::Input(scene.inputs.len())),
                ..JointForces::default()
            });
            scene.inputs.push(Input {
                default: [0.0; 3],
                name: format!("torque{}", scene.inputs.len()),
                doc: String::new(),
                components: 1,
                unit: Unit::default(),
            });
        }
    }
    scene.in_coordinates(Coordinates::Relative)
}

fn robot(scene: &Scene, places: &[Value], [q, u]: [&[f64]; 2]) -> Robot {
    let layout = layout(scene);
    let (nq, nv) = (layout.nq, layout.nv);
    let mut state = vec![0.0; layout.nx()];
    let (mut speeds, mut moving) = (DMatrix::zeros(nv, nv), DVector::zeros(nv));
    for (joint, place) in places.iter().enumerate() {
        let (from, at) = (
            stored(place).start,
            place["q0"].as_u64().expect("an index") as usize,
        );
        if let Some(link) = layout.carried(joint) {
            state[link.slots.q] = q[at];
            state[nq + link.slots.v] = u[from];
            speeds[(link.slots.v, from)] = 1.0;
            continue;
        }
        let own = layout.own_slots(Part::Body(0)).expect("a base that floats");
        state[own.q..own.q + 7].copy_from_slice(&q[at..at + 7]);
        let attitude = Quaternion::new(q[at + 3], q[at + 4], q[at + 5], q[at + 6]);
        let turn = UnitQuaternion::from_quaternion(attitude).to_rotation_matrix();
        let [velocity, spin] =
            [0, 3].map(|k| Vector3::from_column_slice(&u[from + k..from + k + 3]));
        let three = nalgebra::Const::<3>;
        speeds
            .generic_view_mut((own.v, from), (three, three))
            .copy_from(turn.matrix());
        speeds
            .generic_view_mut((own.v + 3, from + 3), (three, three))
            .fill_with_identity();
        moving
            .rows_mut(own.v, 3)
            .copy_from(&(turn * spin.cross(&velocity)));
        let v = nq + own.v;
        state[v..v + 3].copy_from_slice((turn * velocity).as_slice());
        state[v + 3..v + 6].copy_from_slice(spin.as_slice());
    }
    Robot {
        scene: scene.clone(),
        layout,
        state,
        speeds,
        moving,
    }
}

#[test]
fn robots_have_the_masses_accelerations_and_torques_of_pinocchio_at_every_stored_state() {
    for case in ["panda", "ur5", "solo12"] {
        let file = load(&format!("robots/robot_{case}.json"));
        let scene = driven(&file);
        let places = list(&file["layout"]);
        let states = list(&file["states"]);
        assert_eq!(states.len(), 20);
        for (index, moment) in states.iter().enumerate() {
            let field = |name: &str| field(moment, name);
            let robot = robot(&scene, places, [&field("q"), &field("v")]);
            let close = |got: &DVector<f64>, want: &[f64], what: &str| {
                let name = format!("{case} state {index}: {what}");
                assert_close(got.as_slice(), want, 1e-12, 0.0, &name);
            };
            let (nq, nv) = (robot.layout.nq, robot.layout.nv);
            let back = robot.speeds.transpose();
            let none = vec![0.0; scene.inputs.len()];

            let mass = robot.get(Quantity::MassMatrix, &none, &[]);
            let mass = DMatrix::from_row_slice(nv, nv, mass.as_slice());
            let own = &back * &mass * &robot.speeds;
            let lower = list(&moment["mass_matrix_lower"]);
            let want = DMatrix::from_fn(nv, nv, |i, j| {
                lower[i.max(j)][i.min(j)].as_f64().expect("a number")
            });
            close(
                &DVector::from_column_slice(own.as_slice()),
                want.as_slice(),
                "M",
            );

            let bias = robot.get(Quantity::BiasForce, &none, &[]);
            let bias = &back * (bias + &mass * &robot.moving);
            close(&bias, &field("bias"), "h");
            let weight = &back * robot.get(Quantity::GravityForce, &none, &[]);
            close(&weight, &field("gravity_term"), "torques of gravity");

            let rates = |inputs: &[f64]| {
                let rates = robot.get(Quantity::Derivative, inputs, &[]);
                robot.of_data(&rates.rows(nq, nv).into_owned())
            };
            close(&rates(&none), &field("vdot_tau0"), "accelerations");
            let torques = field("tau");
            // What acts on a base has no joint to act along.
            if torques.len() == none.len() {
                close(&rates(&torques), &field("vdot"), "accelerations by torques");
            }

            for (motion, torques) in [("a_in", "rnea"), ("vdot", "tau")] {
                let rates = robot.accelerations(field(motion));
                let found = robot.get(Quantity::InverseDynamics, &none, &rates);
                close(&(&back * found), &field(torques), torques);
            }
        }
    }
}
