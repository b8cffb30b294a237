//! A hanging chain of 20 links and its small swings.
//!
//! With θ_i the angle of link i from the vertical, `M θ̈ + K θ = 0`: `M_ij = m l² (n − j − 1/2)` for i < j, `M_ii = J + m l² (n − i − 3/4)`,
//! `K_ii = m g l (n − i − 1/2)`, counted from 0. Many short links swing as a rope of length L does: `ω_k = j_k √(g/L)/2`, j_k the zeros of the
//! Bessel function J₀.

use mbd_runtime::{TrimError, Vibration, model, trim};

use crate::Outcome;

model! {
    /// Twenty links of 10 cm, one below the other.
    model Chain {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: xz;
        const N = 20;
        body link[i in 0..N] {
            mass: 0.2 kg,
            inertia: diag(0.0002, 0.0002, 0.00002) kg*m^2,
            frame top at [0.0, 0.0, 5 cm],
            frame tip at [0.0, 0.0, -5 cm],
        }
        joint hook: hinge from world to link[0].top { axis: y }
        joint pin[i in 1..N]: hinge from link[i - 1].tip to link[i].top { axis: y }
    }
}

/// The swings of the hanging chain, slowest first.
fn swings(model: &Chain) -> Result<Vec<Vibration>, TrimError> {
    Ok(trim(model).solve()?.space.vibrations())
}

/// Zeros of J₀: those of a rope.
const BESSEL: [f64; 3] = [
    2.404_825_557_695_773,
    5.520_078_110_286_311,
    8.653_727_912_911_013,
];

/// Prints the slowest swings beside those of a rope of two metres.
pub fn run() -> Outcome {
    let model = Chain::new(ChainParams::default())?;
    println!("swing  chain [rad/s]  rope [rad/s]");
    for (index, (one, zero)) in swings(&model)?.iter().zip(BESSEL).enumerate() {
        let rope = 0.5 * zero * (9.81_f64 / 2.0).sqrt();
        println!("{:5}  {:13.5}  {rope:12.5}", index + 1, one.frequency());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn it_swings_as_its_linear_equations_say_and_nearly_as_a_rope() {
        let (n, m, l, g, j) = (20, 0.2, 0.1, 9.81, 0.0002);
        let below = |i: usize| (n - i) as f64;
        let mass = DMatrix::from_fn(n, n, |i, k| match i == k {
            true => j + m * l * l * (below(i) - 0.75),
            false => m * l * l * (below(i.max(k)) - 0.5),
        });
        // ω² of K^(-1/2) M K^(-1/2) = 1/ω².
        let root = |i: usize| (m * g * l * (below(i) - 0.5)).sqrt();
        let slow = DMatrix::from_fn(n, n, |i, k| mass[(i, k)] / (root(i) * root(k)));
        let mut want: Vec<f64> = slow
            .symmetric_eigenvalues()
            .iter()
            .map(|x| 1.0 / x.sqrt())
            .collect();
        want.sort_by(f64::total_cmp);

        let model = Chain::new(ChainParams::default()).unwrap();
        let found = swings(&model).unwrap();
        assert_eq!(found.len(), n);
        for (one, want) in found.iter().zip(&want) {
            assert!(
                (one.frequency() / want - 1.0).abs() < 1e-8,
                "{one:?} is not {want}"
            );
            assert!(one.damping().abs() < 1e-8, "{one:?}");
        }
        for (one, zero) in found.iter().zip(BESSEL) {
            let rope = 0.5 * zero * (g / 2.0_f64).sqrt();
            assert!(
                (one.frequency() / rope - 1.0).abs() < 1e-2,
                "{one:?} is far from {rope}"
            );
        }
    }
}
