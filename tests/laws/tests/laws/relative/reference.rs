//! Trees and robots in joint coordinates: mass matrix, bias, accelerations of Pinocchio.

use laws::assert_close;
use laws::mechanism::state;
use laws::reference::{field, load};
use laws::relative::Both;
use laws::system::{instances, list, scene};
use mbd_scene::{AngularVelocity, Quantity};
use serde_json::Value;

/// Where the speeds of a joint stand in the data.
fn stored(place: &Value) -> std::ops::Range<usize> {
    let number = |name: &str| place[name].as_u64().expect("an index") as usize;
    number("v0")..number("v0") + number("nv")
}

#[test]
fn trees_and_robots_have_the_mass_matrix_bias_and_accelerations_of_joint_coordinates() {
    let cases = [
        "trees/tree_a_05",
        "trees/tree_a_07",
        "trees/tree_a_09",
        "robots/robot_panda",
        "robots/robot_ur5",
        "robots/robot_solo12",
    ];
    for case in cases {
        let file = load(&format!("{case}.json"));
        let scene = scene(&file["system"], AngularVelocity::Body);
        let places = list(&file["layout"]);
        let states = list(&file["states"]).iter().enumerate();
        for (index, moment) in states.filter(|(_, moment)| moment["bodies"].get("quat").is_some()) {
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
            let key = if moment.get("vdot_tau0").is_some() {
                "vdot_tau0"
            } else {
                "tau0"
            };
            let accelerations = match key {
                "tau0" => field(&moment["tau0"], "vdot"),
                _ => field(moment, key),
            };
            let rates = both.get(Quantity::Derivative, &[], &[]);
            let got: Vec<f64> = joints.iter().map(|&(own, _)| rates[nq + own]).collect();
            let want: Vec<f64> = joints
                .iter()
                .map(|&(_, from)| accelerations[from])
                .collect();
            assert_close(&got, &want, 1e-11, 0.0, &name("v̇"));
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
