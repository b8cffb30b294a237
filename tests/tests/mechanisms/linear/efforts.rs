//! Efforts for given accelerations, and derivatives of robots against an independent tool.

use mbd_runtime::{Efforts, inverse_dynamics, linearise};
use mbd_scene::joints::JointForces;
use mbd_scene::{AngularVelocity, Coordinates, Formula, Input, Model, Quantity, Scene, Unit};
use tests::assert_close;
use tests::looped::mechanism;
use tests::mechanism::evaluate;
use tests::minimal::in_family;
use tests::random::Random;
use tests::reference::{field, load};
use tests::system::{list, scene};

use super::{assert_matrix, generic, placed};

#[test]
fn robots_have_the_derivatives_of_an_independent_tool() {
    for robot in ["panda", "ur5"] {
        let file = load(&format!("derivatives/fd_{robot}.json"));
        let source = load(&format!("robots/robot_{robot}.json"));
        let mut scene = scene(&source["system"], AngularVelocity::Body);
        let count = scene.joints.len();
        for (index, joint) in scene.joints.iter_mut().enumerate() {
            scene.inputs.push(Input {
                default: [0.0; 3],
                name: format!("torque{index}"),
                doc: String::new(),
                components: 1,
                unit: Unit::default(),
            });
            joint.forces.push(JointForces {
                force: Some(Formula::Input(index)),
                ..JointForces::default()
            });
        }
        let coordinates = scene.joint_coordinates();
        let model = generic(scene);
        for (index, stored) in list(&file["states"]).iter().enumerate() {
            let (q, v, tau) = (field(stored, "q"), field(stored, "v"), field(stored, "tau"));
            let values = q.iter().zip(&v).flat_map(|(q, v)| [*q, *v]);
            let names = coordinates.iter().map(String::as_str);
            let place: Vec<(&str, f64)> = names.zip(values).collect();
            let at = placed(&model, &tau, &place);
            let space = linearise(&model, 0.0, &at, &tau).expect("linear");
            let block = |first: usize| space.a.view((count, first), (count, count)).into_owned();
            let name = format!("{robot}, state {index}");
            assert_matrix(&block(0), &stored["dvdot_dq"], 1e-10, &name);
            assert_matrix(&block(count), &stored["dvdot_dv"], 1e-10, &name);
            let b = space.b.rows(count, count).into_owned();
            assert_matrix(&b, &stored["dvdot_dtau"], 1e-10, &name);
            // And back: the torques from the accelerations.
            let wanted: Vec<(&str, f64)> = coordinates
                .iter()
                .step_by(2)
                .map(String::as_str)
                .zip(field(stored, "vdot"))
                .collect();
            let none = vec![0.0; count];
            let found = inverse_dynamics(&model, 0.0, &at, &none, &wanted).expect("efforts");
            assert_close(&found.efforts, &tau, 1e-11, 1e-11, &name);
        }
    }
}

/// A mechanism with an input along every joint coordinate.
fn with_efforts(seed: u64) -> (Scene, Vec<f64>, Vec<String>) {
    let (mut scene, state) = mechanism(seed);
    scene.loads.clear();
    let mut names = Vec::new();
    for joint in &mut scene.joints {
        let measured: Vec<_> = joint.law.measured().collect();
        for (coordinate, found) in measured.into_iter().enumerate() {
            scene.inputs.push(Input {
                default: [0.0; 3],
                name: format!("effort{}", names.len()),
                doc: String::new(),
                components: 1,
                unit: Unit::default(),
            });
            let force = Some(Formula::Input(names.len()));
            names.push(format!("{}.{}", joint.name, found.name));
            let mut known = joint.forces.iter_mut();
            match known.find(|forces| forces.coordinate == coordinate) {
                Some(forces) => forces.force = force,
                None => joint.forces.push(JointForces {
                    coordinate,
                    force,
                    ..JointForces::default()
                }),
            }
        }
    }
    (scene, state, names)
}

#[test]
fn efforts_found_for_accelerations_give_these_accelerations() {
    let (mut all, mut some) = (0, 0);
    for case in 0..100 {
        let seed = case / 2;
        let (scene, state, names) = with_efforts(seed);
        let family = match case % 2 {
            0 => Coordinates::Absolute,
            _ => Coordinates::Relative,
        };
        let (scene, state) = in_family(&scene, &state, family);
        let model = generic(scene.clone());
        let none = vec![0.0; names.len()];
        let Ok(space) = linearise(&model, 0.0, &state, &none) else {
            panic!("mechanism {seed}");
        };
        let n = space.accelerations.len();
        let mut random = Random::new(seed);
        // All coordinates of joints among the minimal ones; then one of them alone, the others free.
        let own = |name: &&str| names.iter().any(|known| known == name);
        let chosen: Vec<&str> = space.states[..n].iter().map(|s| s.name.as_str()).collect();
        let chosen: Vec<&str> = chosen.iter().copied().filter(own).collect();
        let mut sets = vec![chosen.clone()];
        sets.extend(chosen.last().map(|last| vec![*last]));
        for set in sets.into_iter().filter(|set| !set.is_empty()) {
            match set.len() == n {
                true => all += 1,
                false => some += 1,
            }
            let wanted: Vec<(&str, f64)> = set
                .iter()
                .map(|name| (*name, random.uniform(-3.0, 3.0)))
                .collect();
            let Efforts {
                efforts,
                accelerations,
            } = inverse_dynamics(&model, 0.0, &state, &none, &wanted).expect("efforts");
            let mut inputs = none.clone();
            for ((name, _), effort) in wanted.iter().zip(&efforts) {
                let at = names
                    .iter()
                    .position(|known| known == name)
                    .expect("an input");
                inputs[at] = *effort;
            }
            let rates = evaluate(&scene, Quantity::Derivative, &state, &inputs, &[]);
            let speeds = &rates[model.layout().nq..];
            let size = speeds.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            let what = format!("{family:?}, mechanism {seed}, {set:?}");
            assert_close(speeds, &accelerations, 0.0, 1e-11 * size, &what);
            let measured = evaluate(&scene, Quantity::JointCoordinates, &state, &inputs, speeds);
            for (name, value) in &wanted {
                let at = names
                    .iter()
                    .position(|known| known == name)
                    .expect("measured");
                let got = measured[3 * at + 2];
                assert!(
                    (got - value).abs() < 1e-11 * size.max(10.0),
                    "{what}: {got} is not {value}"
                );
            }
        }
    }
    assert!(all >= 20 && some >= 60, "{all} whole, {some} in part");
}
