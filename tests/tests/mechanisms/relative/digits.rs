//! Both families and every execution at ten thousand states: accelerations of all bodies to twelve digits.
//!
//! A state need not close the loops: rows that are open, and speeds that open them, accelerate bodies alike in both families. They are
//! left closed where rows repeat others, which is true only there.

use mbd_compiler::Interpreted;
use mbd_scene::{Dual, Layout, Model, Quantity};
use tests::looped::mechanism;
use tests::mechanism::{at, evaluate, layout};
use tests::random::Random;
use tests::relative::Both;

const MECHANISMS: u64 = 20;
const STATES: usize = 500;
/// Relative to the largest acceleration of the mechanism.
const BOUND: f64 = 1e-12;

/// The motions of all bodies at a state of relative coordinates, 13 numbers each, and their rates.
fn moving(both: &Both, state: &[f64], rates: &[f64], inputs: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let state: Vec<Dual<f64, 1>> = state
        .iter()
        .zip(rates)
        .map(|(&value, &rate)| Dual {
            value,
            slopes: [rate],
        })
        .collect();
    let inputs: Vec<Dual<f64, 1>> = inputs.iter().map(|&x| Dual::constant(x)).collect();
    let moved = evaluate(&both.relative, Quantity::Bodies, &state, &inputs, &[]);
    moved.iter().map(|x| (x.value, x.slopes[0])).unzip()
}

/// Another state of the same mechanism.
fn elsewhere(layout: &Layout, state: &[f64], random: &mut Random) -> Vec<f64> {
    let mut state = state.to_vec();
    let (places, speeds) = state.split_at_mut(layout.nq);
    if layout.redundancy.repeats.is_empty() {
        places
            .iter_mut()
            .for_each(|q| *q += random.uniform(-0.3, 0.3));
    }
    speeds
        .iter_mut()
        .for_each(|v| *v = random.uniform(-2.0, 2.0));
    for first in layout.quaternions() {
        let size = state[first..first + 4].iter().map(|x| x * x).sum::<f64>();
        state[first..first + 4]
            .iter_mut()
            .for_each(|x| *x /= size.sqrt());
    }
    state
}

fn interpreted(model: &Interpreted<f64>, state: &[f64], inputs: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; model.layout().nx()];
    let at = at(state, inputs, &[]);
    model.evaluate(Quantity::Derivative, &at, &mut model.work(), &mut out);
    out
}

#[test]
fn families_and_executions_accelerate_bodies_alike_to_twelve_digits() {
    let mut worst = Vec::new();
    for seed in 0..MECHANISMS {
        let (scene, state) = mechanism(seed);
        let both = Both::new(&scene, &state);
        let absolute = layout(&both.absolute);
        let models = [&both.absolute, &both.relative]
            .map(|scene| Interpreted::<f64>::new(scene.clone(), &[]).expect("no params"));
        let mut random = Random::new(seed + 90);
        let mut most = 0.0_f64;
        for _ in 0..STATES {
            let inputs: Vec<f64> = (0..absolute.ni)
                .map(|_| random.uniform(-2.0, 2.0))
                .collect();
            let state = elsewhere(&both.layout, &both.state, &mut random);
            let rates = evaluate(&both.relative, Quantity::Derivative, &state, &inputs, &[]);
            let (bodies, own) = moving(&both, &state, &rates, &inputs);
            let mut from = both.from.clone();
            for ((_, slots), motion) in absolute.own_bodies().zip(bodies.chunks_exact(13)) {
                from[slots.q..slots.q + 7].copy_from_slice(&motion[..7]);
                let v = absolute.nq + slots.v;
                from[v..v + 6].copy_from_slice(&motion[7..]);
            }
            let of_state = |derivative: &[f64]| -> Vec<f64> {
                let each = absolute.own_bodies().flat_map(|(_, slots)| {
                    let v = absolute.nq + slots.v;
                    derivative[v..v + 6].to_vec()
                });
                each.collect()
            };
            let of_bodies = |rates: &[f64]| -> Vec<f64> {
                let each = rates.chunks_exact(13).flat_map(|rates| &rates[7..]);
                each.copied().collect()
            };
            let want = of_bodies(&own);
            let size = want.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            let by_program = interpreted(&models[1], &state, &inputs);
            let others = [
                of_state(&evaluate(
                    &both.absolute,
                    Quantity::Derivative,
                    &from,
                    &inputs,
                    &[],
                )),
                of_state(&interpreted(&models[0], &from, &inputs)),
                of_bodies(&moving(&both, &state, &by_program, &inputs).1),
            ];
            for (found, want) in others.iter().flat_map(|other| other.iter().zip(&want)) {
                most = most.max((found - want).abs() / size);
            }
        }
        worst.push((seed, most));
    }
    assert!(worst.iter().all(|(_, most)| *most <= BOUND), "{worst:?}");
}
