//! The columns that joints state for the solver: H free, N held, on the constraints and off them.

use laws::assert_close;
use laws::mechanism::{Coordinates, Instance, Seat, all_joints, carried, subspace};
use laws::random::Random;
use mbd_scene::joints::{Carried, JointLaw, Twist};
use mbd_scene::rows::{End, Ends, Row, Rows};
use mbd_scene::{AngularVelocity, Jet};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::coordinates::end;

/// The two bodies of a joint, where it sits on them, and its numbers.
struct Pair {
    bodies: [Instance; 2],
    seats: [Seat; 2],
    numbers: Vec<f64>,
}

impl Pair {
    /// The ends of the joint, the columns on the child at its joint point.
    fn ends(&self, components: AngularVelocity) -> Ends<'_, f64> {
        let [parent, child] =
            [0, 1].map(|side| end(&self.bodies[side], &self.seats[side], components));
        let reference = child.arm;
        Ends::new(
            parent,
            End { reference, ..child },
            &self.numbers,
            components,
        )
    }
}

fn rows(law: &JointLaw, ends: &Ends<'_, f64>) -> Vec<Row<f64>> {
    let mut rows = Rows::default();
    law.constrain(ends, &mut rows);
    rows.rows().to_vec()
}

/// The columns of a row on the child, in the axes of what the joint states.
fn on_child(row: &Row<f64>, carried: &Carried<f64>) -> Twist<f64> {
    let axes = carried.axes.unwrap_or_else(Matrix3::identity);
    Twist {
        linear: row.child().linear,
        angular: axes.transpose() * row.child().angular,
    }
}

/// Calls `check` for every joint that states columns, in every form, at random states that violate it.
fn everywhere(mut check: impl FnMut(&str, &JointLaw, &Pair, AngularVelocity, &Carried<f64>)) {
    let mut random = Random::new(77);
    let mut seen = 0;
    for (law, numbers) in all_joints() {
        for trial in 0..20 {
            let pair = Pair {
                bodies: [Instance::random(&mut random), Instance::random(&mut random)],
                seats: [Seat::random(&mut random), Seat::random(&mut random)],
                numbers: numbers.clone(),
            };
            for (components, own) in [
                (AngularVelocity::World, false),
                (AngularVelocity::Body, false),
                (AngularVelocity::Body, true),
            ] {
                let ends = pair.ends(components);
                if let Some(carried) = law.carried(&ends, own) {
                    seen += 1;
                    let name = format!("{law:?}, {components:?}, {own}, {trial}");
                    check(&name, &law, &pair, components, &carried);
                }
            }
        }
    }
    assert!(seen >= 8 * 60, "{seen}");
}

#[test]
fn the_rows_leave_the_free_columns_and_tell_the_held_ones_apart() {
    everywhere(|name, law, pair, components, carried| {
        let ends = pair.ends(components);
        let rows = rows(law, &ends);
        assert_eq!(carried.held.len(), rows.len(), "{name}: a column a row");
        assert_eq!(carried.free.len(), law.freedoms(), "{name}");
        for (i, row) in rows.iter().enumerate() {
            let row = on_child(row, carried);
            for column in carried.free.iter() {
                let size = row.dot(&row).sqrt() * column.dot(column).sqrt();
                assert!(
                    row.dot(column).abs() < 1e-12 * size,
                    "{name}: row {i} sees H"
                );
            }
            for (j, held) in carried.held.iter().enumerate() {
                if i > j && carried.held[i].after {
                    continue;
                }
                let told = row.dot(&held.column) * held.inverse;
                let want = f64::from(u8::from(i == j));
                let size = held.inverse.abs() * held.column.dot(&held.column).sqrt();
                assert!(
                    (told - want).abs() < 1e-12 * (1.0 + size),
                    "{name}: row {i} tells {told} of column {j}"
                );
            }
        }
    });
}

#[test]
fn the_rows_take_the_parent_along_as_a_rigid_body() {
    everywhere(|name, law, pair, components, carried| {
        if components == AngularVelocity::Body {
            return;
        }
        let ends = pair.ends(components);
        let point = match carried.meets {
            true => ends.parent.arm,
            false => ends.reach(),
        };
        for row in rows(law, &ends) {
            let moved = row.child().linear + row.parent().linear;
            let rotated =
                row.child().angular + point.cross(&row.child().linear) + row.parent().angular;
            assert!(moved.amax() < 1e-13 && rotated.amax() < 1e-12, "{name}");
        }
    });
}

#[test]
fn held_columns_solve_the_rows_and_their_multipliers() {
    let mut random = Random::new(78);
    everywhere(|name, law, pair, components, carried| {
        let ends = pair.ends(components);
        let rows = rows(law, &ends);
        let columns: Vec<Twist<f64>> = rows.iter().map(|row| on_child(row, carried)).collect();
        let solved = |first: Twist<f64>, right: &[f64]| {
            let motion = carried.solve(first, &columns, |row| right[row]);
            let told: Vec<f64> = columns.iter().map(|row| row.dot(&motion)).collect();
            let size = motion.dot(&motion).sqrt();
            assert_close(&told, right, 1e-12, 1e-12 * size, name);
        };
        let right: Vec<f64> = rows.iter().map(|_| random.uniform(-1.0, 1.0)).collect();
        solved(carried.first(|row| right[row]), &right);
        // What a joint says in short agrees with its rows.
        let own: Vec<f64> = rows.iter().map(|row| row.relative).collect();
        solved(
            carried
                .bias
                .unwrap_or_else(|| carried.first(|row| own[row])),
            &own,
        );
        let mut push = Twist::zero();
        for (row, &x) in columns.iter().zip(&right) {
            push = push.plus(row, x);
        }
        let size = 1.0 + push.dot(&push).sqrt();
        let multipliers = carried.multipliers(push, &columns);
        let largest = carried.held.iter().fold(1.0f64, |most, held| {
            most.max(held.inverse.abs() * held.column.dot(&held.column).sqrt())
        });
        let absolute = 1e-12 * size * largest;
        assert_close(&multipliers[..rows.len()], &right, 1e-12, absolute, name);
    });
}

#[test]
fn a_motor_sees_the_column_of_its_coordinate_alone() {
    everywhere(|name, law, pair, components, carried| {
        if carried.axes.is_some() {
            return;
        }
        let ends = pair.ends(components);
        for (index, coordinate) in law.measured().enumerate() {
            let mut rows = Rows::default();
            rows.motor(&ends, &coordinate, &Jet::constant(0.4));
            let row = on_child(&rows.rows()[0], carried);
            for (column, free) in carried.free.iter().enumerate() {
                let told = row.dot(free).abs();
                let size = row.dot(&row).sqrt() * free.dot(free).sqrt();
                assert_eq!(told > 1e-12 * size, column == index, "{name}: {column}");
            }
        }
    });
}

#[test]
fn on_the_constraints_the_free_columns_span_what_the_joint_allows() {
    let mut random = Random::new(79);
    for (law, numbers) in all_joints() {
        for trial in 0..10 {
            let at = Coordinates::random(&law, numbers.clone(), &mut random);
            let seats = [Seat::random(&mut random), Seat::random(&mut random)];
            let parent = Instance::random(&mut random);
            let child = carried(&law, seats, &parent, &at);
            let pair = Pair {
                bodies: [parent, child],
                seats,
                numbers: numbers.clone(),
            };
            let ends = pair.ends(AngularVelocity::World);
            let Some(stated) = law.carried(&ends, false) else {
                continue;
            };
            // Velocities of frame 2 in frame 1, frame-1 axes, are those of the child at Q in world axes.
            let axes = pair.bodies[0].rotation() * seats[0].frame;
            let list = |linear: Vector3<f64>, angular: Vector3<f64>| {
                DVector::from_iterator(6, linear.iter().chain(angular.iter()).copied())
            };
            let allowed = subspace(&law, &at);
            let allowed: Vec<DVector<f64>> = allowed
                .iter()
                .map(|twist| list(axes * twist.linear, axes * twist.angular))
                .collect();
            if allowed.is_empty() {
                continue;
            }
            let h = DMatrix::from_columns(&allowed);
            let inverse = h.clone().pseudo_inverse(1e-12).expect("full rank");
            for column in stated.free.iter() {
                let column = list(column.linear, column.angular);
                let off = &column - &h * (&inverse * &column);
                assert!(off.amax() < 1e-12, "{law:?}, {trial}: {off}");
            }
        }
    }
}
