//! Masses that differ by many decades: accelerations of chains of six links and of six sliders against an answer of thirty digits, in many
//! configurations.

use mbd_runtime::{Generic, Options, Scalar, Simulation, StepError};
use mbd_scene::joints::{Axis, Hinge, JointForces, JointLaw, Prismatic};
use mbd_scene::{AngularVelocity, Scene};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use tests::double::{Double, solve};
use tests::mechanism::{Instance, add_body, add_frame, add_joint, empty, evaluate, frame, state};
use tests::random::Random;

/// The mass of a link at a ratio.
type Pattern = fn(usize, f64) -> f64;

const LINKS: usize = 6;
const CONFIGURATIONS: usize = 20;
const G: f64 = 9.81;

/// Accelerations (x, y, α) of every link from the equations in angles: M_ij = Σ m b_i b_j cos(θ_i − θ_j) + I δ_ij.
fn exact(masses: &[f64], inertias: &[f64], quaternions: &[[f64; 2]], rates: &[f64]) -> Vec<f64> {
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
            right[i] = right[i] - mass * sin * d(rates[j]) * d(rates[j]);
        }
        matrix[i][i] = matrix[i][i] + d(inertias[i]);
        let weight = (0..LINKS).fold(Double::default(), |sum, p| sum + d(masses[p]) * reach(p, i));
        right[i] = right[i] - weight * d(G) * ci;
    }
    let alpha = solve(matrix, right);
    (0..LINKS)
        .flat_map(|p| {
            let mut sum = [Double::default(); 2];
            for i in 0..=p {
                let ([c, s], square) = (directions[i], d(rates[i]) * d(rates[i]));
                sum[0] = sum[0] + reach(p, i) * (-(s * alpha[i]) - c * square);
                sum[1] = sum[1] + reach(p, i) * (c * alpha[i] - s * square);
            }
            [sum[0].0, sum[1].0, alpha[p].0]
        })
        .collect()
}

/// A chain of links in a configuration: the scene, its state, and the accelerations (x, y, α) of every link.
fn chain(masses: &[f64], random: &mut Random) -> (Scene, Vec<f64>, Vec<f64>) {
    let inertias: Vec<f64> = masses.iter().map(|mass| mass / 12.0).collect();
    chain_of(masses, &inertias, random)
}

/// The same with these moments of inertia about every axis.
fn chain_of(masses: &[f64], inertias: &[f64], random: &mut Random) -> (Scene, Vec<f64>, Vec<f64>) {
    let mut scene = empty([0.0, -G, 0.0], AngularVelocity::Body);
    let (mut bodies, mut quaternions, mut rates) = (Vec::new(), Vec::new(), Vec::new());
    let (mut tip, mut drift) = (Vector3::zeros(), Vector3::zeros());
    let mut end = mbd_scene::Place::World(0);
    for (&mass, &inertia) in masses.iter().zip(inertias) {
        let body = add_body(&mut scene, mass, &(Matrix3::identity() * inertia));
        let root = add_frame(
            &mut scene,
            Some(body),
            frame("root", [-0.5, 0.0, 0.0], None),
        );
        add_joint(&mut scene, JointLaw::Hinge(Hinge::default()), end, root);
        end = add_frame(&mut scene, Some(body), frame("tip", [0.5, 0.0, 0.0], None));
        let angle = random.uniform(-3.0, 3.0);
        let rate = random.uniform(-1.5, 1.5);
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let (arm, omega) = (attitude * Vector3::x(), Vector3::new(0.0, 0.0, rate));
        let swing = omega.cross(&arm);
        bodies.push(Instance {
            position: tip + arm * 0.5,
            attitude,
            velocity: drift + swing * 0.5,
            omega,
            ..Instance::rest()
        });
        quaternions.push([attitude.w, attitude.k]);
        rates.push(rate);
        tip += arm;
        drift += swing;
    }
    let x = state(&scene, &bodies, &[]);
    let want = exact(masses, inertias, &quaternions, &rates);
    (scene, x, want)
}

/// A chain of sliders on springs, K = 40 m, along these axes: the scene, a state, and the accelerations of every slider from the equations
/// in ways: M_ij = a_i·a_j Σ m, the sum over the sliders that both carry.
fn sliders(masses: &[f64], axes: &[Axis], random: &mut Random) -> (Scene, Vec<f64>, Vec<f64>) {
    let gravity = [1.3, -G, 0.7];
    let mut scene = empty(gravity, AngularVelocity::Body);
    let (mut bodies, mut place) = (Vec::new(), Vector3::zeros());
    let (mut right, mut end) = (Vec::new(), mbd_scene::Place::World(0));
    let d = Double::from;
    let dot = |a: &Axis, b: [f64; 3]| {
        let products = a.0.into_iter().zip(b).map(|(a, b)| d(a) * d(b));
        products.fold(Double::default(), |sum, x| sum + x)
    };
    for (index, (&mass, &axis)) in masses.iter().zip(axes).enumerate() {
        let body = add_body(&mut scene, mass, &(Matrix3::identity() * (mass / 12.0)));
        let own = frame("own", [0.0; 3], None);
        let own = add_frame(&mut scene, Some(body), own);
        add_joint(
            &mut scene,
            JointLaw::Prismatic(Prismatic { axis }),
            end,
            own,
        );
        scene.joints[index].forces.push(JointForces {
            stiffness: Some((40.0 * mass).into()),
            ..JointForces::default()
        });
        end = own;
        let way = random.uniform(-1.0, 1.0);
        place += Vector3::from(axis.0) * way;
        bodies.push(Instance {
            position: place,
            ..Instance::rest()
        });
        let carried = masses[index..]
            .iter()
            .fold(Double::default(), |sum, &m| sum + d(m));
        right.push(carried * dot(&axis, gravity) - d(40.0 * mass) * d(way));
    }
    let matrix = (0..LINKS).map(|i| {
        let row = (0..LINKS).map(|j| {
            let both = masses[i.max(j)..].iter();
            dot(&axes[i], axes[j].0) * both.fold(Double::default(), |sum, &m| sum + d(m))
        });
        row.collect()
    });
    let ways = solve(matrix.collect(), right);
    let mut want = Vec::new();
    for p in 0..LINKS {
        for k in 0..3 {
            let moved = (0..=p).map(|i| d(axes[i].0[k]) * ways[i]);
            want.push(moved.fold(Double::default(), |sum, x| sum + x).0);
        }
    }
    let x = state(&scene, &bodies, &[]);
    (scene, x, want)
}

/// Linear accelerations of every body.
fn linear(rates: &[f64]) -> Vec<f64> {
    let own = rates[7 * LINKS..].chunks_exact(6);
    own.flat_map(|v| [v[0], v[1], v[2]]).collect()
}

/// The worst error of accelerations, relative to the largest.
fn worst(rates: &[f64], want: &[f64]) -> f64 {
    let nq = 7 * LINKS;
    let own = rates[nq..].chunks_exact(6).flat_map(|v| [v[0], v[1], v[5]]);
    error(own, want)
}

fn error(got: impl IntoIterator<Item = f64>, want: &[f64]) -> f64 {
    let scale = want.iter().fold(0.0f64, |m, a| m.max(a.abs()));
    got.into_iter().zip(want).fold(0.0f64, |most, (a, b)| {
        let off = (a - b).abs() / scale;
        if off <= most { most } else { off }
    })
}

/// The rates of a run at its start, its strategy and the digits it says are lost.
fn start<T: Scalar>(scene: &Scene, x: &[f64]) -> Result<(Vec<f64>, [u64; 2]), StepError> {
    let model = Generic::<T>::with_defaults(scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
    let x: Vec<T> = x.iter().map(|&x| T::from_f64(x)).collect();
    run.set_state(0.0, &x).expect("a valid state");
    run.start().map_err(|error| error.cause)?;
    let rates = run.rates().iter().map(|x| x.to_f64()).collect();
    let statistics = run.statistics();
    Ok((rates, [statistics.rows_strategy, statistics.lost_digits]))
}

const PATTERNS: [(&str, Pattern); 4] = [
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

#[test]
fn accelerations_keep_their_digits_whatever_the_masses() {
    let mut missed = Vec::new();
    for (name, mass) in PATTERNS {
        for decade in [0.0, 2.0, 3.0, 4.0, 4.5, 5.0, 5.5, 6.0, 7.0, 8.0, 9.0] {
            let ratio = 10f64.powf(decade);
            let masses: Vec<f64> = (0..LINKS).map(|k| mass(k, ratio)).collect();
            let (mut random, mut most) = (Random::new(7), [0.0f64; 2]);
            let (mut strategies, mut digits) = ([0; 5], 0);
            for _ in 0..CONFIGURATIONS {
                let (scene, x, want) = chain(&masses, &mut random);
                let emitted = evaluate(&scene, mbd_scene::Quantity::Derivative, &x, &[], &[]);
                let (rates, [strategy, lost]) =
                    start::<f64>(&scene, &x).unwrap_or_else(|error| panic!("{error}"));
                most[0] = most[0].max(worst(&emitted, &want));
                most[1] = most[1].max(worst(&rates, &want));
                strategies[strategy as usize] += 1;
                digits = digits.max(lost);
            }
            let [emitted, chained] = most;
            println!(
                "{name} 1e{decade}: emitted {emitted:.1e}, chain {chained:.1e}, strategies {strategies:?}, digits {digits}"
            );
            let bound = 1e-12 * (ratio * 1e-5).max(1.0);
            if chained.is_nan() || chained > bound {
                missed.push(format!("{name} 1e{decade}: {chained:e} > {bound:e}"));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

#[test]
fn accelerations_keep_their_digits_whatever_the_inertias_of_equal_masses() {
    let masses = [1.0; LINKS];
    let mut missed = Vec::new();
    for (name, inertia) in PATTERNS {
        for decade in [0.0, 2.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0] {
            let ratio = 10f64.powf(decade);
            let inertias: Vec<f64> = (0..LINKS).map(|k| inertia(k, ratio) / 12.0).collect();
            let (mut random, mut most) = (Random::new(7), [0.0f64; 2]);
            let mut strategies = [0; 5];
            for _ in 0..CONFIGURATIONS {
                let (scene, x, want) = chain_of(&masses, &inertias, &mut random);
                let emitted = evaluate(&scene, mbd_scene::Quantity::Derivative, &x, &[], &[]);
                let (rates, [strategy, _]) =
                    start::<f64>(&scene, &x).unwrap_or_else(|error| panic!("{error}"));
                most[0] = most[0].max(worst(&emitted, &want));
                most[1] = most[1].max(worst(&rates, &want));
                strategies[strategy as usize] += 1;
            }
            let [emitted, chained] = most;
            println!(
                "{name} 1e{decade}: emitted {emitted:.1e}, chain {chained:.1e}, strategies {strategies:?}"
            );
            let bound = 1e-12 * (ratio * 1e-5).max(1.0);
            if chained.is_nan() || chained > bound {
                missed.push(format!("{name} 1e{decade}: {chained:e} > {bound:e}"));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

#[test]
fn sliders_keep_their_digits_whatever_the_masses() {
    let odd = |a: [f64; 3]| Axis::new(a).expect("not zero");
    let slant = odd([0.2, 0.5, -0.7]);
    let square = [Axis::X, Axis::Y, Axis::Z, Axis::X, Axis::Y, Axis::Z];
    let tilts = [0.0, 0.3, -0.4, 0.9, -1.2, 0.5].map(|t| odd([1.0, t, 0.3 - t]));
    let ways = [
        ("parallel", [slant; LINKS]),
        ("square", square),
        ("tilted", tilts),
    ];
    let mut missed = Vec::new();
    for (pattern, mass) in PATTERNS {
        for (kind, axes) in &ways {
            for decade in [0.0, 3.0, 5.0, 7.0, 9.0] {
                let ratio = 10f64.powf(decade);
                let masses: Vec<f64> = (0..LINKS).map(|k| mass(k, ratio)).collect();
                let (mut random, mut most, mut strategies) = (Random::new(5), [0.0f64; 3], [0; 5]);
                for _ in 0..CONFIGURATIONS {
                    let (scene, x, want) = sliders(&masses, axes, &mut random);
                    let emitted = evaluate(&scene, mbd_scene::Quantity::Derivative, &x, &[], &[]);
                    let (rates, [strategy, _]) =
                        start::<f64>(&scene, &x).unwrap_or_else(|error| panic!("{error}"));
                    most[0] = most[0].max(error(linear(&emitted), &want));
                    most[1] = most[1].max(error(linear(&rates), &want));
                    strategies[strategy as usize] += 1;
                    let (rates, _) =
                        start::<f32>(&scene, &x).unwrap_or_else(|error| panic!("{error}"));
                    most[2] = most[2].max(error(linear(&rates), &want));
                }
                let [emitted, chained, single] = most;
                let name = format!("{kind} sliders, {pattern} 1e{decade}");
                println!(
                    "{name}: emitted {emitted:.1e}, chain {chained:.1e}, f32 {single:.1e}, strategies {strategies:?}"
                );
                let bound = 1e-12 * (ratio * 1e-5).max(1.0);
                // Single precision: twice what was measured. Up to 1e3 masses are not weighed at the start of a run; above, rounding of the
                // axes remains.
                let unchecked = if decade == 3.0 { 3e-4 } else { 3e-5 };
                if chained.is_nan() || chained > bound || single.is_nan() || single > unchecked {
                    missed.push(format!("{name}: {chained:e} > {bound:e}, f32 {single:e}"));
                }
            }
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

#[test]
fn in_single_precision_and_beyond_nine_decades_accelerations_hold_or_are_refused() {
    for (name, mass) in PATTERNS {
        for decade in [0, 2, 4, 6, 9, 12, 15, 18, 21] {
            let ratio = 10f64.powi(decade);
            let masses: Vec<f64> = (0..LINKS).map(|k| mass(k, ratio)).collect();
            let mut random = Random::new(11);
            let (mut most, mut refused) = ([0.0f64; 2], [0; 2]);
            for _ in 0..CONFIGURATIONS {
                let (scene, x, want) = chain(&masses, &mut random);
                let both = [start::<f32>(&scene, &x), start::<f64>(&scene, &x)];
                for (k, got) in both.into_iter().enumerate() {
                    match got {
                        Ok((rates, _)) => most[k] = most[k].max(worst(&rates, &want)),
                        Err(StepError::IllConditioned { loss_digits, .. }) => {
                            // Three digits are not left.
                            assert!(loss_digits >= [4, 12][k], "{loss_digits}");
                            assert!(decade > [9, 12][k], "{name} 1e{decade}");
                            refused[k] += 1;
                        }
                        Err(error) => panic!("{name} 1e{decade}: {error}"),
                    }
                }
            }
            let [single, double] = most;
            println!(
                "{name} 1e{decade}: f32 {single:.1e}, f64 {double:.1e}, refused {refused:?} of {CONFIGURATIONS}"
            );
            let bound = 1e-12 * (ratio * 1e-5).clamp(1.0, 1e4);
            assert!(single < 1e-5 && double < bound, "{name} 1e{decade}");
        }
    }
}

#[test]
fn a_third_three_times_is_one_to_thirty_digits() {
    let third = Double::from(1.0) / Double::from(3.0);
    let left = third + third + third - Double::from(1.0);
    assert!(left.0.abs() < 1e-31);
}
