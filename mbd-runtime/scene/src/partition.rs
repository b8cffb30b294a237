//! Coordinate partitioning: which speeds of its child a joint determines, and which it leaves free. Read off the rows, whatever the joint.
//!
//! A joint whose rows turn the child in some directions only and hold its point:
//!
//! ```text
//! speeds of the child at the joint's point: y = [v (3, world axes) ; η],  ω′ = E η         (1)
//! dependent: v and the first `turns` of η;  free: the rest of η                            (2)
//! ```
//!
//! E is chosen so that the free speeds do not enter the rows at all: an attitude row turns the child about n = b × a only, which is
//! perpendicular to the axis b fixed in the child, on the constraints and off them. So (2) is exact, and the dependent speeds follow
//! from the parent's by a matrix that is singular only where the rows themselves are dependent.
//!
//! A joint that locks the child to the parent, up to ways s along axes of the parent:
//!
//! ```text
//! speeds of the child, of the parent's own point and in the parent's components: y = y_p + H u + ρ,  H = [axes ; 0]        (3)
//! ```
//!
//! No row tells whether parent and child move together, and none of such a joint tells ways along H: so (3) is exact too, and child and
//! parent are one body but for what slides. ρ is what the right-hand sides of the rows ask for.
//! Source: Wehage and Haug, coordinate partitioning; with (2) and (3) block elimination is the articulated-body recursion (Featherstone).

use crate::joints::{Axis, Coordinate, JointLaw};
use crate::laws::rows::{End, Ends, Row, RowKind, Rows, Turn};
use crate::{AngularVelocity, Directions, Jet, RowSet};

/// Numbers of its own that a joint has in the store where it locks its child: the free ways (3 × 3), the lever (3 × 3) and
/// what the masses along the ways are at least (3).
const LOCKED_ROOM: usize = 21;
/// How far the axes along which rows hold a point may be from right angles.
const SQUARE: f64 = 1e-12;

/// What a joint that holds a point of its child, or ways of it, and `turns` of its angles determines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partition {
    /// Number of attitude rows, 0 to 3.
    pub turns: usize,
    /// The axis of the child's joint frame about which its attitude rows do not turn; any where there are none or three.
    pub axis: Axis,
    /// The rows that hold the joint's point.
    pub points: RowSet,
    /// Where parent and child turn as one: what of the point is free.
    pub locked: Option<Ways>,
}

/// The ways along which the joint's point is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ways {
    /// How many.
    pub free: usize,
    /// The axes of frame 1 along which it is; in a plane what is across the rows.
    pub axes: [Axis; 3],
    /// Whether the rows are along axes of the parent; along those of the world else.
    pub sliding: bool,
}

impl Partition {
    /// The partition of a joint of which these rows count, with the coordinates that motors drive; `None` where its rows are not of this
    /// kind. In a plane two rows hold the point, and at most one the angle: the speeds are the velocity of the joint's point, and ω.
    #[must_use]
    pub fn of(
        law: &JointLaw,
        counted: RowSet,
        motors: impl Iterator<Item = Coordinate>,
        directions: Directions,
    ) -> Option<Self> {
        let at_rest = || End::<f64>::fixed(nalgebra::Vector3::zeros(), Turn::None);
        let mut rows = Rows::default();
        rows.begin(counted);
        let ends = Ends::new(at_rest(), at_rest(), &[], AngularVelocity::Body);
        law.constrain(&ends, &mut rows);
        for coordinate in motors {
            rows.motor(&ends, &coordinate, &Jet::constant(0.0));
        }
        Self::of_rows(rows.rows(), directions)
    }

    fn of_rows(rows: &[Row<f64>], directions: Directions) -> Option<Self> {
        let (mut points, mut pinned) = (RowSet::default(), 0);
        let (mut held, mut about) = (Vec::new(), Vec::new());
        for (index, row) in rows.iter().enumerate() {
            match row.kind {
                RowKind::Coincide => pinned += 1,
                RowKind::Along(axis) => held.push(axis),
                RowKind::Perpendicular(axis) => about.push(Some(axis)),
                RowKind::Turned => about.push(None),
                RowKind::Other => return None,
            }
            if matches!(row.kind, RowKind::Coincide | RowKind::Along(_)) {
                points.0 |= 1 << index;
            }
        }
        let (moves, all) = (directions.moves().len(), directions.turns().len());
        let whole = pinned == moves && held.is_empty();
        let turns = about.len();
        let partition = Partition {
            turns,
            axis: about.first().copied().flatten().unwrap_or_default(),
            points,
            locked: None,
        };
        if turns < all {
            let shared = about.windows(2).all(|pair| pair[0] == pair[1]);
            let known = about.iter().all(Option::is_some);
            return (whole && shared && known).then_some(partition);
        }
        let sliding = pinned == 0;
        if turns > all || !sliding && !whole {
            return None;
        }
        let free = if sliding {
            moves.checked_sub(held.len())?
        } else {
            0
        };
        let axes = free_axes(&held)?;
        Some(Partition {
            locked: Some(Ways {
                free,
                axes,
                sliding,
            }),
            ..partition
        })
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.points.len() + self.turns
    }

    /// The rows that turn the child.
    #[must_use]
    pub fn attitude(&self) -> RowSet {
        RowSet(RowSet::all(self.rows()).0 & !self.points.0)
    }

    /// How many of a body's speeds follow from its parent's: as many as rows, or all of them but for what slides.
    #[must_use]
    pub fn held(&self, speeds: usize) -> usize {
        self.locked.map_or(self.rows(), |_| speeds)
    }

    /// What the joint needs in the store where it leaves together with a body of so many speeds: width of a coupling, numbers of its own,
    /// unknowns.
    #[must_use]
    pub fn room(&self, speeds: usize) -> [usize; 3] {
        let (rows, held) = (self.rows(), self.held(speeds));
        match self.locked {
            None => [rows, rows * rows, rows],
            Some(ways) => [held, LOCKED_ROOM, held + ways.free],
        }
    }
}

/// The axes across those along which rows hold a point; `None` where these are not at right angles.
fn free_axes(held: &[Axis]) -> Option<[Axis; 3]> {
    let cosine = |a: &Axis, b: &Axis| a.0.iter().zip(b.0).map(|(a, b)| a * b).sum::<f64>();
    for (index, a) in held.iter().enumerate() {
        let square = held
            .iter()
            .take(index)
            .all(|b| cosine(a, b).abs() <= SQUARE);
        if !square {
            return None;
        }
    }
    Some(match *held {
        [a] => {
            let [u, v] = a.complement();
            [u, v, a]
        }
        [a, b] => [a.cross(&b), a, b],
        _ => [Axis::X, Axis::Y, Axis::Z],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Cylindrical, Distance, Hinge, Planar, Plane, Prismatic, Rigid, Screw, Spherical, Universal,
    };

    fn partition(law: &JointLaw, motors: &[usize]) -> Option<Partition> {
        let motors = motors.iter().filter_map(|&index| law.coordinate(index));
        let rows = RowSet::all(law.rows());
        Partition::of(law, rows, motors, Directions::default())
    }

    fn turns(law: &JointLaw) -> Option<usize> {
        partition(law, &[]).map(|partition| partition.turns)
    }

    fn free_ways(law: &JointLaw, motors: &[usize]) -> Option<usize> {
        Some(partition(law, motors)?.locked?.free)
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
        let partition = partition(&law, &[]);
        assert_eq!(partition.map(|partition| partition.axis), Some(axis));
    }

    #[test]
    fn joints_whose_rows_mix_turns_and_ways_leave_the_speeds_as_they_are() {
        let rod = Distance { length: 1.0.into() };
        assert_eq!(turns(&JointLaw::Distance(rod)), None);
        assert_eq!(turns(&JointLaw::Cylindrical(Cylindrical::default())), None);
        let thread = Screw {
            axis: Axis::Z,
            pitch: 0.1.into(),
        };
        assert_eq!(turns(&JointLaw::Screw(thread)), None);
    }

    #[test]
    fn a_slider_is_locked_but_for_its_way() {
        let axis = Axis([0.6, 0.0, 0.8]);
        let law = JointLaw::Prismatic(Prismatic { axis });
        let ways = partition(&law, &[]).and_then(|partition| partition.locked);
        let way = ways.map(|ways| (ways.free, ways.axes[0]));
        let Some((1, along)) = way else {
            panic!("one way is free: {way:?}");
        };
        let off = (0..3).map(|k| (along.0[k] - axis.0[k]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15, "{along:?}");
    }

    #[test]
    fn motors_lock_what_they_drive() {
        let hinge = JointLaw::Hinge(Hinge::default());
        let slider = JointLaw::Prismatic(Prismatic::default());
        let cardan = JointLaw::Universal(Universal::default());
        let table = JointLaw::Planar(Planar::default());
        assert_eq!(free_ways(&hinge, &[0]), Some(0));
        assert_eq!(free_ways(&slider, &[0]), Some(0));
        assert_eq!(free_ways(&cardan, &[0, 1]), Some(0));
        assert_eq!(free_ways(&table, &[2]), Some(2));
        assert_eq!(free_ways(&table, &[0, 2]), Some(1));
        let first = partition(&cardan, &[0]).map(|partition| partition.turns);
        assert_eq!(
            first,
            Some(2),
            "a cardan joint turned about its first axis is a hinge"
        );
    }

    #[test]
    fn in_a_plane_a_slider_has_two_rows() {
        let directions = Directions {
            plane: Some(Plane::Xy),
        };
        let law = JointLaw::Prismatic(Prismatic { axis: Axis::X });
        // y1·d and x1·y2 of the axes that complete x.
        let rows = RowSet(0b0_1001);
        let partition = Partition::of(&law, rows, std::iter::empty(), directions);
        let ways = partition.and_then(|partition| partition.locked);
        assert_eq!(ways.map(|ways| (ways.free, ways.sliding)), Some((1, true)));
    }
}
