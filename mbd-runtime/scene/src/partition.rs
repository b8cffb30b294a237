//! Coordinate partitioning: which speeds of its child a joint determines, and which it leaves free.
//!
//! ```text
//! speeds of the child at the joint's point: y = [v (3, world axes) ; η],  ω′ = E η         (1)
//! dependent: v and the first `turns` of η;  free: the rest of η                            (2)
//! ```
//!
//! E is chosen so that the free speeds do not enter the rows at all: an attitude row turns the child about n = b × a only, which is
//! perpendicular to the axis b fixed in the child, on the constraints and off them. So (2) is exact, and the dependent speeds follow
//! from the parent's by a matrix that is singular only where the rows themselves are dependent.
//! Source: Wehage and Haug, coordinate partitioning; with (2) block elimination is the articulated-body recursion (Featherstone).

use crate::joints::{Axis, JointLaw};
use crate::laws::rows::{End, Ends, RowKind, Rows, Turn};
use crate::{AngularVelocity, Directions, RowSet};

/// What a joint of three coincide rows and `turns` attitude rows determines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partition {
    /// Number of attitude rows, 0 to 3.
    pub turns: usize,
    /// The axis of the child's joint frame about which its attitude rows do not turn; any where there are none or three.
    pub axis: Axis,
}

impl Partition {
    /// The partition of a joint of which these rows count; `None` where they are not of this kind. In a plane two rows hold the point, and
    /// at most one the angle: the speeds are the velocity of the joint's point, and ω.
    #[must_use]
    pub fn of(law: &JointLaw, counted: RowSet, directions: Directions) -> Option<Self> {
        let at_rest = || End::<f64>::fixed(nalgebra::Vector3::zeros(), Turn::None);
        let mut rows = Rows::default();
        rows.begin(counted);
        let ends = Ends::new(at_rest(), at_rest(), &[], AngularVelocity::Body);
        law.constrain(&ends, &mut rows);
        let (point, turns) = rows.rows().split_at_checked(directions.moves().len())?;
        if point.iter().any(|row| row.kind != RowKind::Coincide) {
            return None;
        }
        let mut axes = Vec::new();
        for row in turns {
            let RowKind::Perpendicular(axis) = row.kind else {
                return None;
            };
            axes.push(axis);
        }
        let shared = axes.windows(2).all(|pair| pair[0] == pair[1]);
        let all = directions.turns().len();
        (turns.len() == all || shared && turns.len() < all).then(|| Partition {
            turns: turns.len(),
            axis: axes.first().copied().unwrap_or_default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cylindrical, Distance, Hinge, Prismatic, Rigid, Spherical, Universal};

    fn turns(law: &JointLaw) -> Option<usize> {
        Partition::of(law, RowSet::all(law.rows()), Directions::default())
            .map(|partition| partition.turns)
    }

    #[test]
    fn joints_at_a_point_part_the_speeds_of_their_child() {
        assert_eq!(turns(&JointLaw::Spherical(Spherical::default())), Some(0));
        assert_eq!(turns(&JointLaw::Universal(Universal::default())), Some(1));
        assert_eq!(turns(&JointLaw::Hinge(Hinge::default())), Some(2));
        assert_eq!(turns(&JointLaw::Rigid(Rigid::default())), Some(3));
    }

    #[test]
    fn the_free_direction_of_a_hinge_is_its_axis() {
        let axis = Axis([0.6, 0.0, 0.8]);
        let law = JointLaw::Hinge(Hinge { axis });
        let partition = Partition::of(&law, RowSet::all(5), Directions::default());
        assert_eq!(partition.map(|partition| partition.axis), Some(axis));
    }

    #[test]
    fn joints_whose_points_part_leave_the_speeds_as_they_are() {
        let rod = Distance { length: 1.0.into() };
        assert_eq!(turns(&JointLaw::Distance(rod)), None);
        assert_eq!(turns(&JointLaw::Prismatic(Prismatic::default())), None);
        assert_eq!(turns(&JointLaw::Cylindrical(Cylindrical::default())), None);
    }
}
