//! Which joints carry their child out of the system, and in which unknowns: read off the columns that the joint states ([`Carried`]).
//!
//! ```text
//! H turns about two axes or more      the child's own components, its joint point Q                               (1)
//! H turns about one axis              world axes, Q                                                               (2)
//!   of the child that is x, y or z,     its own components, as long as all that the child carries is so             (1)
//!   any, and the child carries nothing  its own components                                                        (1)
//! H does not turn                     the unknowns of the parent: V_c = V_p + H u + N ν without any matrix        (3)
//! ```
//!
//! The more a joint turns, the less of the child's inertia is handed on, and the cheaper it is to rotate that. (2) and (3) rotate the
//! inertia of the body instead, which is cheaper than rotating what all bodies behind it add up to.
//! In a plane H and N follow from the rows: each holds either the point Q or the angle.

use crate::{AngularVelocity, Axis, Carrying, Coordinate, Directions, Jet, RowSet, Twist};
use nalgebra::{Rotation3, Vector3};

use crate::joints::{Carried, JointLaw};
use crate::rows::{Columns, End, Ends, Rotation, Row, Rows};
use crate::scalar::Few;

/// Most columns of H that are cheaper to take out than the rows are to keep, where they are not unit vectors.
const MOST_FREE: usize = 2;
/// Two numbers of a row are the same below this difference.
const SAME: f64 = 1e-12;

impl Carrying {
    /// How a joint of which these rows count carries its child, with the coordinates that motors drive; `None` where it does not. `aligned`:
    /// the joint's frame on the child has the axes of the child.
    #[must_use]
    pub fn of(
        law: &JointLaw,
        counted: RowSet,
        motors: &[(usize, Coordinate)],
        (directions, aligned): (Directions, bool),
    ) -> Option<Self> {
        let (parent, child) = somewhere(directions);
        // Numbers of the joint do not change its pattern.
        let ends = Ends::new(parent, child, &[0.7, 0.6], AngularVelocity::World);
        let carried = law.carried(&ends, true)?;
        if directions.plane.is_some() {
            let mut rows = Rows::default();
            rows.begin(counted);
            law.constrain(&ends, &mut rows);
            for (_, coordinate) in motors {
                rows.motor(&ends, coordinate, &Jet::constant(0.1));
            }
            return Self::in_plane(rows.rows(), &ends, directions);
        }
        let free = carried.free.iter().enumerate();
        let free = free.filter(|(column, _)| motors.iter().all(|(driven, _)| driven != column));
        let free: Vec<&Twist<f64>> = free.map(|(_, twist)| twist).collect();
        let turns = free
            .iter()
            .filter(|twist| twist.angular != Vector3::zeros());
        let turns = turns.count();
        let many = turns > 1 && motors.is_empty();
        let unit = |twist: &Twist<f64>| twist.angular.iter().filter(|x| **x != 0.0).count() == 1;
        let child = End::fixed(ends.child.arm, Rotation::Identity);
        let ends = Ends::new(ends.parent, child, &[0.7, 0.6], AngularVelocity::World);
        let level = law.carried(&ends, false)?;
        let aligned = aligned && carried.meets && turns == 1 && level.free.last().is_some_and(unit);
        let cheap = many || free.len() <= MOST_FREE;
        (cheap && counted == RowSet::all(law.rows())).then_some(Carrying {
            free: free.len(),
            turns,
            own: many || aligned,
            axes: many && carried.axes.is_some(),
            shared: turns == 0,
            meets: carried.meets,
            points: RowSet::default(),
        })
    }

    /// The same in a plane: every row holds the point or the angle, and the parent's motion is taken to P or to Q.
    fn in_plane(rows: &[Row<f64>], ends: &Ends<'_, f64>, directions: Directions) -> Option<Self> {
        let normal = directions.plane?.normal();
        let mut points = RowSet::default();
        for (number, row) in rows.iter().enumerate() {
            let moves = within(directions, row.child()) > 0.0;
            let turns = row.child().angular[normal] != 0.0;
            points.0 |= u8::from(moves) << number;
            if moves == turns {
                return None;
            }
        }
        let carries = |point: Vector3<f64>| {
            rows.iter().all(|row| {
                let (own, other) = (row.child(), row.parent());
                let rotated = own.angular + point.cross(&own.linear);
                let apart = within(
                    directions,
                    &Columns {
                        linear: own.linear + other.linear,
                        ..*own
                    },
                );
                apart < SAME && (rotated + other.angular)[normal].abs() < SAME
            })
        };
        let turns = rows.len() - points.len();
        let meets = carries(ends.parent.arm);
        let slides = carries(ends.reach());
        let independent = points.len() <= directions.translations().len() && turns <= 1;
        (independent && (meets || slides)).then(|| Carrying {
            free: directions.speeds() - rows.len(),
            turns: 1 - turns,
            own: turns == 0,
            axes: false,
            shared: turns == 1,
            meets,
            points,
        })
    }
}

/// How large the linear columns of a row are along the plane.
fn within(directions: Directions, columns: &Columns<f64>) -> f64 {
    let moves = directions.translations().iter();
    moves.fold(0.0, |most: f64, &axis| most.max(columns.linear[axis].abs()))
}

/// The ends of a joint that does not hold, world components, the columns of the child at its joint point.
fn somewhere(directions: Directions) -> (End<f64>, End<f64>) {
    let end = |position: [f64; 3], turn: [f64; 3], arm: [f64; 3]| {
        let (mut position, mut arm) = (Vector3::from(position), Vector3::from(arm));
        if let Some(plane) = directions.plane {
            let normal = plane.normal();
            (position[normal], arm[normal]) = (0.0, 0.0);
        }
        // Joint frames lean out of a plane, too.
        let frame = Rotation3::new(Vector3::from(turn)).into_inner();
        End {
            position,
            ..End::fixed(arm, Rotation::Matrix(frame))
        }
    };
    let parent = end([0.3, -0.7, 0.5], [0.4, 0.5, 0.6], [0.2, 0.5, -0.4]);
    let child = end([-0.6, 0.2, 1.1], [0.9, -0.3, 0.2], [0.7, -0.1, 0.3]);
    let reference = child.arm;
    (parent, End { reference, ..child })
}

impl<S: crate::Real> Carried<S> {
    /// H and N of rows in a plane, `points` those that hold the point.
    #[must_use]
    pub fn in_plane(rows: &[Row<S>], carrying: &Carrying, directions: Directions) -> Option<Self> {
        let plane = directions.plane?;
        let normal: Vector3<S> = plane.axis().vector();
        let flat = |row: &Row<S>| {
            let mut linear = row.child().linear;
            linear[plane.normal()] = S::zero();
            linear
        };
        let mut points: Few<Vector3<S>, 3> = Few::new(Vector3::zeros());
        let at_points = carrying.points.rows();
        points.extend(at_points.filter_map(|row| rows.get(row).map(flat)));
        let mut carried = Carried::new(carrying.meets);
        let mut next = 0;
        for (number, row) in rows.iter().enumerate() {
            if !carrying.points.contains(number) {
                let inverse = S::one() / row.child().angular[plane.normal()];
                carried.hold(Twist::spin(normal), inverse);
                continue;
            }
            // The direction that the other row does not see; the row itself where there is no other.
            let own = points[next];
            next += 1;
            let across = match points.get(2 - next) {
                Some(other) if points.len() > 1 => normal.cross(other),
                _ => own,
            };
            carried.hold(Twist::slide(across), S::one() / own.dot(&across));
        }
        let axis = |axis: usize| Twist::slide(Axis::unit(axis).vector());
        match points.first() {
            None => carried
                .free
                .extend(directions.translations().iter().map(|&k| axis(k))),
            Some(only) if points.len() == 1 => {
                carried.free.push(Twist::slide(normal.cross(only)));
            }
            _ => {}
        }
        if points.len() == rows.len() {
            carried.free.push(Twist::spin(normal));
        }
        Some(carried)
    }
}
