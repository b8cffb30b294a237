//! Every joint in a plane: which of its rows count there, and that they are the rows of space.
//!
//! The frames of a joint sit anyhow (its axis along the normal, in the plane, or at an angle to both), so that it can be closed in the plane:
//! the oracle is the joint in space with both bodies held to the plane by rows of their own, solved by singular values.

use mbd_scene::joints::JointLaw;
use mbd_scene::laws::{Numbers, out_of_plane};
use mbd_scene::{AngularVelocity, Layout, Plane, Quantity, Scene};
use nalgebra::{DMatrix, DVector, Matrix3, UnitQuaternion, Vector3};
use tests::assert_close;
use tests::mechanism::{
    Coordinates, Instance, Seat, accelerations, add_body, add_external_loads, add_frame, add_joint,
    all_joints, at, attitude, empty, evaluate, inertia, jets, state,
};
use tests::planar::{PLANES, flattened, in_space};
use tests::random::Random;

/// Two bodies of a planar scene, or one and the world, and the joint between them, closed at a state.
struct Pair {
    scene: Scene,
    bodies: Vec<Instance>,
}

fn moving(plane: Plane, random: &mut Random) -> Instance {
    let n = plane.normal();
    let flat = |mut v: Vector3<f64>| {
        v[n] = 0.0;
        v
    };
    let normal = Vector3::from_fn(|i, _| f64::from(u8::from(i == n)));
    let along = |x: f64| normal * x;
    Instance {
        position: flat(random.vector(1.0).into()),
        attitude: UnitQuaternion::from_scaled_axis(along(random.uniform(-3.0, 3.0))),
        velocity: flat(random.vector(2.0).into()),
        omega: along(random.uniform(-2.0, 2.0)),
        acceleration: flat(random.vector(3.0).into()),
        alpha: along(random.uniform(-3.0, 3.0)),
    }
}

/// Axes of the first frame: those of the world in another order, or tilted.
fn tilt(kind: usize, random: &mut Random) -> Matrix3<f64> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    match kind {
        0..3 => Matrix3::from_columns(&[0, 1, 2].map(|k| axes[(k + kind) % 3])),
        _ => attitude(random).to_rotation_matrix().into_inner(),
    }
}

fn pair(
    (law, numbers): &(JointLaw, Vec<f64>),
    plane: Plane,
    kind: usize,
    to_world: bool,
    random: &mut Random,
) -> Pair {
    let n = plane.normal();
    let coordinates = match kind {
        // Untilted joints at zero coordinates. There a distance may stand along the normal, and a given angle only be touched: singular.
        0..3 if !matches!(law, JointLaw::Distance(_) | JointLaw::ConstantAngle(_)) => {
            let mut at = Coordinates::random(law, numbers.clone(), random);
            at.q.fill(0.0);
            if law.coordinates() > law.freedoms() {
                let w = law.coordinates() - 4;
                at.q[w] = 1.0;
            }
            at
        }
        _ => Coordinates::random(law, numbers.clone(), random),
    };
    let pose = law.motion(&coordinates.relative());
    let mut child = moving(plane, random);
    let parent = match to_world {
        true => Instance::rest(),
        false => moving(plane, random),
    };
    let mut first = Seat {
        point: Vector3::from(random.vector(0.5)),
        frame: tilt(kind, random),
    };
    first.point[n] = 0.0;
    // The second frame where the joint is closed.
    let between = parent.rotation().transpose() * child.rotation();
    let mut point = Vector3::from(random.vector(0.5));
    point[n] = (first.point + first.frame * pose.position)[n];
    let second = Seat {
        point,
        frame: between.transpose() * first.frame * pose.rotation,
    };
    let reach = parent.rotation() * (first.point + first.frame * pose.position);
    child.position = parent.position + reach - child.rotation() * second.point;
    let mut scene = empty([0.3, -0.2, -9.81], AngularVelocity::World);
    scene.planar = Some(plane);
    let base = (!to_world).then(|| add_body(&mut scene, 1.7, &inertia(random)));
    let own = add_body(&mut scene, 0.9, &inertia(random));
    let from = add_frame(&mut scene, base, first.declared("one"));
    let to = add_frame(&mut scene, Some(own), second.declared("two"));
    add_joint(&mut scene, law.clone(), from, to);
    add_external_loads(&mut scene);
    let bodies = match to_world {
        true => vec![child],
        false => vec![parent, child],
    };
    Pair { scene, bodies }
}

fn everywhere(mut check: impl FnMut(&str, &Pair, &mut Random)) {
    let mut random = Random::new(11);
    for joint in all_joints() {
        for plane in PLANES {
            for to_world in [false, true] {
                for kind in 0..6 {
                    let pair = pair(&joint, plane, kind, to_world, &mut random);
                    let name = format!(
                        "{:?} in {plane:?}, kind {kind}, to world {to_world}",
                        joint.0
                    );
                    check(&name, &pair, &mut random);
                }
            }
        }
    }
}

/// Number of singular values that count, and the smallest of those.
fn rank(matrix: &DMatrix<f64>) -> (usize, f64) {
    if matrix.is_empty() {
        return (0, f64::INFINITY);
    }
    let values = matrix.singular_values();
    let counting: Vec<f64> = values.iter().copied().filter(|x| *x > 1e-9).collect();
    (
        counting.len(),
        counting.iter().copied().fold(f64::INFINITY, f64::min),
    )
}

#[test]
fn the_rows_that_count_are_independent_and_as_many_as_the_joint_has_in_the_plane() {
    everywhere(|name, pair, _| {
        let (flat, space) = (
            Layout::new(&pair.scene),
            Layout::new(&in_space(&pair.scene)),
        );
        let jacobian = |scene: &Scene, layout: &Layout| {
            let state = state(scene, &pair.bodies, &[]);
            let dense = evaluate(scene, Quantity::ConstraintJacobian, &state, &[], &[]);
            DMatrix::from_row_slice(layout.nc, layout.nv, &dense)
        };
        let own = jacobian(&pair.scene, &flat);
        let all = jacobian(&in_space(&pair.scene), &space);
        let rows = (0..space.nc).map(|row| {
            let row: Vec<f64> = all.row(row).iter().copied().collect();
            DVector::from_vec(flattened(&pair.scene, &row)).transpose()
        });
        let rows: Vec<_> = rows.collect();
        let count = match rows.as_slice() {
            [] => 0,
            rows => rank(&DMatrix::from_rows(rows)).0,
        };
        let (own_rank, least) = rank(&own);
        assert_eq!((flat.nc, own_rank), (count, count), "{name}");
        assert!(least > 1e-4, "{name}: {least}");
    });
}

#[test]
fn at_a_closed_state_no_row_is_left_in_or_out_of_the_plane() {
    everywhere(|name, pair, _| {
        let layout = Layout::new(&pair.scene);
        let state = state(&pair.scene, &pair.bodies, &[]);
        let rows = evaluate(&pair.scene, Quantity::Constraint, &state, &[], &[]);
        assert_close(&rows, &vec![0.0; layout.nc], 0.0, 1e-13, name);
        let numbers = Numbers::new(&pair.scene, &[]);
        let left = out_of_plane(&pair.scene, &layout, &numbers, &at(&state, &[], &[]), 0);
        assert!(left < 1e-13, "{name}: {left:e}");
    });
}

#[test]
fn rows_agree_with_jets_along_planar_motions_that_violate_the_joint() {
    everywhere(|name, pair, random| {
        let plane = pair.scene.planar.expect("planar");
        let bodies: Vec<Instance> = pair.bodies.iter().map(|_| moving(plane, random)).collect();
        let layout = Layout::new(&pair.scene);
        let own = state(&pair.scene, &bodies, &[]);
        let jet = jets(&pair.scene, &bodies, &[]);
        let jet = evaluate(&pair.scene, Quantity::Constraint, &jet, &[], &[]);
        let level = |k: usize| jet.iter().map(|jet| jet.0[k]).collect::<Vec<f64>>();
        let of = |what| evaluate(&pair.scene, what, &own, &[], &[]);
        assert_close(&of(Quantity::ConstraintRate), &level(1), 1e-14, 1e-14, name);
        let jacobian =
            DMatrix::from_row_slice(layout.nc, layout.nv, &of(Quantity::ConstraintJacobian));
        let moved = jacobian * DVector::from_vec(accelerations(&pair.scene, &bodies, &[]));
        let second = moved - DVector::from_vec(of(Quantity::ConstraintBias));
        assert_close(second.as_slice(), &level(2), 1e-13, 1e-13, name);
    });
}

#[test]
fn accelerations_are_those_of_space_with_both_bodies_held_to_the_plane() {
    everywhere(|name, pair, random| {
        let plane = pair.scene.planar.expect("planar");
        // Speeds that the joint allows: a share of the closed state's own that its rows leave.
        let layout = Layout::new(&pair.scene);
        let mut own = state(&pair.scene, &pair.bodies, &[]);
        let dense = evaluate(&pair.scene, Quantity::ConstraintJacobian, &own, &[], &[]);
        let jacobian = DMatrix::from_row_slice(layout.nc, layout.nv, &dense);
        let speeds = DVector::from_column_slice(&own[layout.nq..]);
        if layout.nc > 0 {
            let fitted = jacobian.clone().svd(true, true);
            let off = fitted
                .solve(&(&jacobian * &speeds), 1e-10)
                .expect("both sides");
            for (speed, off) in own[layout.nq..].iter_mut().zip(off.iter()) {
                *speed -= off;
            }
        }
        let inputs: Vec<f64> = (0..layout.ni).map(|_| random.uniform(-5.0, 5.0)).collect();
        let rates = evaluate(&pair.scene, Quantity::Derivative, &own, &inputs, &[]);

        let space = in_space(&pair.scene);
        let all = Layout::new(&space);
        let full = tests::planar::lifted(&pair.scene, &own);
        let of = |what| evaluate(&space, what, &full, &inputs, &[]);
        let n = all.nv;
        let held: Vec<usize> = (0..all.bodies.len())
            .flat_map(|body| (0..6).map(move |k| (6 * body, k)))
            .filter(|(_, k)| (*k < 3) == (k % 3 == plane.normal()))
            .map(|(first, k)| first + k)
            .collect();
        let size = n + all.nc + held.len();
        let mut matrix = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        matrix
            .view_mut((0, 0), (n, n))
            .copy_from(&DMatrix::from_row_slice(n, n, &of(Quantity::MassMatrix)));
        let mut rows = DMatrix::from_row_slice(all.nc, n, &of(Quantity::ConstraintJacobian));
        let mut limits = of(Quantity::ConstraintBias);
        for (row, limit) in limits.iter_mut().enumerate() {
            // A row that hardly turns in the plane counts there like any other.
            let whole: Vec<f64> = rows.row(row).iter().copied().collect();
            let size = DVector::from_vec(flattened(&pair.scene, &whole)).norm();
            if size > 1e-9 {
                rows.row_mut(row).scale_mut(1.0 / size);
                *limit /= size;
            }
        }
        matrix.view_mut((n, 0), (all.nc, n)).copy_from(&rows);
        matrix
            .view_mut((0, n), (n, all.nc))
            .copy_from(&rows.transpose());
        for (k, &speed) in held.iter().enumerate() {
            matrix[(n + all.nc + k, speed)] = 1.0;
            matrix[(speed, n + all.nc + k)] = 1.0;
        }
        let (force, bias) = (of(Quantity::Forces), of(Quantity::BiasForce));
        for k in 0..n {
            right[k] = force[k] - bias[k];
        }
        for (k, limit) in limits.into_iter().enumerate() {
            right[n + k] = limit;
        }
        // Twice more for what the singular values leave.
        let parts = matrix.clone().svd(true, true);
        let mut solved = DVector::zeros(size);
        for _ in 0..3 {
            let rest = &right - &matrix * &solved;
            solved += parts.solve(&rest, 1e-8).expect("both sides");
        }
        let want = flattened(&pair.scene, &solved.as_slice()[..n]);
        assert_close(&rates[layout.nq..], &want, 1e-9, 1e-9, name);
    });
}
