//! Masses that differ by many decades: accelerations of a chain of six links against an answer of thirty digits.

use mbd_runtime::{Generic, Options, Simulation};
use mbd_scene::joints::{Hinge, JointLaw};
use mbd_scene::{AngularVelocity, Layout};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use tests::double::{Double, solve};
use tests::mechanism::{Instance, add_body, add_frame, add_joint, empty, evaluate, frame, state};

/// The mass of a link at a ratio.
type Pattern = fn(usize, f64) -> f64;

const LINKS: usize = 6;
const ANGLES: [f64; LINKS] = [0.3, -0.8, 1.1, 2.0, -0.4, 0.9];
const RATES: [f64; LINKS] = [0.7, -1.1, 0.4, 1.3, -0.6, 0.2];
const G: f64 = 9.81;

/// Accelerations (x, y, α) of every link from the equations in angles: M_ij = Σ m b_i b_j cos(θ_i − θ_j) + I δ_ij.
fn exact(masses: &[f64], quaternions: &[[f64; 2]]) -> Vec<f64> {
    let d = Double::from;
    // Direction of a link from its root to its tip: x′ of the attitude, at any length of the quaternion.
    let directions: Vec<[Double; 2]> = quaternions
        .iter()
        .map(|&[w, z]| {
            let (ww, zz, wz) = (d(w) * d(w), d(z) * d(z), d(w) * d(z));
            let square = ww + zz;
            [(ww - zz) / square, (wz + wz) / square]
        })
        .collect();
    // How far link i carries the centre of link p.
    let reach = |p: usize, i: usize| {
        d(if i < p {
            1.0
        } else if i == p {
            0.5
        } else {
            0.0
        })
    };
    let mut matrix = vec![vec![Double::default(); LINKS]; LINKS];
    let mut right = vec![Double::default(); LINKS];
    for i in 0..LINKS {
        let [ci, si] = directions[i];
        for j in 0..LINKS {
            let [cj, sj] = directions[j];
            let (cos, sin) = (ci * cj + si * sj, si * cj - ci * sj);
            let mass = (0..LINKS).fold(Double::default(), |sum, p| {
                sum + d(masses[p]) * reach(p, i) * reach(p, j)
            });
            matrix[i][j] = mass * cos;
            right[i] = right[i] - mass * sin * d(RATES[j]) * d(RATES[j]);
        }
        matrix[i][i] = matrix[i][i] + d(masses[i]) / d(12.0);
        let weight = (0..LINKS).fold(Double::default(), |sum, p| sum + d(masses[p]) * reach(p, i));
        right[i] = right[i] - weight * d(G) * ci;
    }
    let alpha = solve(matrix, right);
    (0..LINKS)
        .flat_map(|p| {
            let mut sum = [Double::default(); 2];
            for i in 0..=p {
                let ([c, s], square) = (directions[i], d(RATES[i]) * d(RATES[i]));
                sum[0] = sum[0] + reach(p, i) * (-(s * alpha[i]) - c * square);
                sum[1] = sum[1] + reach(p, i) * (c * alpha[i] - s * square);
            }
            [sum[0].0, sum[1].0, alpha[p].0]
        })
        .collect()
}

/// Worst error of the accelerations at a start, relative to the largest: emitted elimination alone, and the run with its ladder.
fn errors(masses: &[f64]) -> ([f64; 2], u64) {
    let mut scene = empty([0.0, -G, 0.0], AngularVelocity::Body);
    let (mut bodies, mut quaternions) = (Vec::new(), Vec::new());
    let (mut tip, mut drift) = (Vector3::zeros(), Vector3::zeros());
    let mut end = mbd_scene::Place::World(0);
    for (k, &mass) in masses.iter().enumerate() {
        let body = add_body(&mut scene, mass, &(Matrix3::identity() * (mass / 12.0)));
        let root = add_frame(
            &mut scene,
            Some(body),
            frame("root", [-0.5, 0.0, 0.0], None),
        );
        add_joint(&mut scene, JointLaw::Hinge(Hinge::default()), end, root);
        end = add_frame(&mut scene, Some(body), frame("tip", [0.5, 0.0, 0.0], None));
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), ANGLES[k]);
        let (arm, omega) = (attitude * Vector3::x(), Vector3::new(0.0, 0.0, RATES[k]));
        let swing = omega.cross(&arm);
        bodies.push(Instance {
            position: tip + arm * 0.5,
            attitude,
            velocity: drift + swing * 0.5,
            omega,
            ..Instance::rest()
        });
        quaternions.push([attitude.w, attitude.k]);
        tip += arm;
        drift += swing;
    }
    let want = exact(masses, &quaternions);
    let x = state(&scene, &bodies, &[]);
    let nq = Layout::new(&scene).nq;
    let scale = want.iter().fold(0.0f64, |m, a| m.max(a.abs()));
    let worst = |rates: &[f64]| {
        let own = rates[nq..].chunks_exact(6).flat_map(|v| [v[0], v[1], v[5]]);
        let pairs = own.zip(&want);
        pairs.fold(0.0f64, |most, (a, b)| {
            let off = (a - b).abs() / scale;
            if off <= most { most } else { off }
        })
    };
    let emitted = evaluate(&scene, mbd_scene::Quantity::Derivative, &x, &[], &[]);
    let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
    run.set_state(0.0, &x).expect("a valid state");
    run.start().unwrap_or_else(|error| panic!("{error}"));
    (
        [worst(&emitted), worst(run.rates())],
        run.statistics().rows_rung,
    )
}

#[test]
fn accelerations_keep_their_digits_whatever_the_masses() {
    let patterns: [(&str, Pattern); 4] = [
        (
            "light tip",
            |k, r| if k == LINKS - 1 { 1.0 / r } else { 1.0 },
        ),
        ("heavy tip", |k, r| if k == LINKS - 1 { r } else { 1.0 }),
        ("alternating", |k, r| if k % 2 == 1 { r } else { 1.0 }),
        (
            "light middle",
            |k, r| if k == LINKS / 2 { 1.0 / r } else { 1.0 },
        ),
    ];
    let mut missed = Vec::new();
    for (name, mass) in patterns {
        for decade in [0, 2, 4, 6, 9] {
            let ratio = 10f64.powi(decade);
            let masses: Vec<f64> = (0..LINKS).map(|k| mass(k, ratio)).collect();
            let ([emitted, climbed], rung) = errors(&masses);
            println!("{name} 1e{decade}: emitted {emitted:.1e}, ladder {climbed:.1e}, rung {rung}");
            let bound = 1e-12 * (ratio * 1e-5).max(1.0);
            if climbed.is_nan() || climbed > bound {
                missed.push(format!("{name} 1e{decade}: {climbed:e} > {bound:e}"));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}
