//! Rows that repeat others, found once: joints that close a loop can forbid what the loop forbids anyway. Four parallel hinges of a planar
//! four-bar have 20 rows of rank 17.
//!
//! The rank is found at random consistent states: parts are hung on a spanning tree of the joints at random joint coordinates, the loops
//! are closed by damped least squares, which does not mind a lost rank, and joints on a wrong branch are thrown away. In the speeds u that
//! the tree leaves (v = B u), every row of a closing joint is one row of
//!
//! ```text
//! G = Φ_v B                                                                       (1)
//! ```
//!
//! and what repeats the tree and earlier joints is what adds nothing to its rank. Rows are kept greedily: joints in the order of declaration,
//! so that the last one of a loop loses rows; inside a joint the row with most that is new, at its worst over the states. The joints of the
//! tree never lose any. A joint that loses rows and those whose rows they repeat carry a self-stress: forces in balance that move nothing,
//! so their reactions are not unique.
//!
//! Assemblies of one scene can differ in rank (a parallelogram with a third bar moves; crossed, it is a truss): those that move count.
//! Parameters are taken at their defaults; a start elsewhere is checked by the run.

mod assembly;
mod choice;
mod local;
mod planar;
mod tree;

pub use planar::{Apart, in_plane};

use serde::{Deserialize, Serialize};

use crate::{Layout, Scene};

/// A choice of a joint's rows: bit k stands for row k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RowSet(
    /// The bits.
    pub u8,
);

impl RowSet {
    /// The first `count` rows.
    #[must_use]
    pub fn all(count: usize) -> Self {
        RowSet(u8::MAX.checked_shr(8 - count.min(8) as u32).unwrap_or(0))
    }

    /// Those of the first `count` rows.
    #[must_use]
    pub fn within(self, count: usize) -> Self {
        RowSet(self.0 & Self::all(count).0)
    }

    /// How many.
    #[must_use]
    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether row `row` is one of them.
    #[must_use]
    pub fn contains(self, row: usize) -> bool {
        row < 8 && self.0 & (1 << row) != 0
    }

    /// The rows, in order.
    pub fn rows(self) -> impl Iterator<Item = usize> {
        (0..8).filter(move |&row| self.contains(row))
    }
}

/// A joint some of whose rows repeat those of others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Repeat {
    /// The joint, by index.
    pub joint: usize,
    /// Number of its rows.
    pub rows: usize,
    /// Those that stay.
    pub kept: RowSet,
    /// The joints whose rows the others repeat, by index.
    pub of: Vec<usize>,
}

/// A motor that drives a coordinate which joints, or other motors, hold already.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HeldMotor {
    /// Its joint, by index.
    pub joint: usize,
    /// The coordinate, by number.
    pub coordinate: usize,
    /// The joints that hold it, by index.
    pub of: Vec<usize>,
}

/// What repeats what in a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Redundancy {
    /// The joints that lose rows, in order of declaration.
    pub repeats: Vec<Repeat>,
    /// The motors on loops that have nothing to drive. Only by parameters at their defaults.
    pub held: Vec<HeldMotor>,
    /// Independent loops of the joints, the world being one of the parts.
    pub loops: usize,
    /// Whether every loop was closed at some state. Where not, nothing is known of its rows, and all are kept.
    pub closed: bool,
}

impl Redundancy {
    /// Finds the repeated rows of a scene. Without a loop there are none, and nothing is searched.
    #[must_use]
    pub(crate) fn find(scene: &Scene, layout: &Layout) -> Self {
        let groups = tree::groups(layout);
        let mut found = Redundancy {
            loops: groups.iter().map(|group| group.closing.len()).sum(),
            closed: true,
            ..Redundancy::default()
        };
        for group in &groups {
            let states = assembly::states(scene, layout, group);
            found.closed &= !states.is_empty();
            let (repeats, held) = choice::repeats(group, &states);
            found.repeats.extend(repeats);
            found.held.extend(held);
        }
        found.repeats.sort_by_key(|repeat| repeat.joint);
        found.held.sort_by_key(|held| (held.joint, held.coordinate));
        found
    }

    /// Whether the reaction of a joint is determined by the motion: it takes part in no redundancy.
    #[must_use]
    pub fn is_unique(&self, joint: usize) -> bool {
        let mut repeats = self.repeats.iter();
        !repeats.any(|repeat| repeat.joint == joint || repeat.of.contains(&joint))
    }

    /// Number of rows that are left out.
    #[must_use]
    pub fn lost(&self) -> usize {
        let lost = |repeat: &Repeat| repeat.rows - repeat.kept.within(repeat.rows).len();
        self.repeats.iter().map(lost).sum()
    }

    /// One sentence for every motor that has nothing to drive: "`spin` cannot drive its `angle`: `a`, `b` hold it".
    #[must_use]
    pub fn idle_motors(&self, scene: &Scene) -> Vec<String> {
        let sentence = |held: &HeldMotor| {
            let (joint, coordinate) = scene.coordinate(held.joint, held.coordinate)?;
            let verb = if held.of.len() == 1 { "holds" } else { "hold" };
            Some(format!(
                "`{}` cannot drive its `{}`: {} {verb} it",
                joint.name,
                coordinate.name,
                named(scene, &held.of)
            ))
        };
        self.held.iter().filter_map(sentence).collect()
    }

    /// One sentence for every joint that loses rows: "`close` repeats rows of `a`, `b`, `c`: 3 of 5".
    #[must_use]
    pub fn sentences(&self, scene: &Scene) -> Vec<String> {
        let sentence = |repeat: &Repeat| {
            let lost = repeat.rows - repeat.kept.within(repeat.rows).len();
            format!(
                "{} repeats rows of {}: {lost} of {}",
                named(scene, &[repeat.joint]),
                named(scene, &repeat.of),
                repeat.rows
            )
        };
        self.repeats.iter().map(sentence).collect()
    }
}

/// `a`, `b`, `c`.
fn named(scene: &Scene, joints: &[usize]) -> String {
    let name = |joint: &usize| {
        let joint = scene.joints.get(*joint);
        format!("`{}`", joint.map_or("?", |joint| &joint.name))
    };
    let names: Vec<String> = joints.iter().map(name).collect();
    names.join(", ")
}

/// The length that angles are weighed with: how far joints sit from the centres of mass.
fn length(lengths: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = lengths
        .filter(|x| x.is_finite() && *x > 0.0)
        .fold((0.0, 0), |(sum, count), x| (sum + x, count + 1));
    if count > 0 {
        sum / f64::from(count)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::RowSet;

    #[test]
    fn a_set_of_rows_counts_and_lists_them() {
        let set = RowSet(0b10_1101);
        assert_eq!((set.len(), set.contains(1)), (4, false));
        assert_eq!(set.rows().collect::<Vec<_>>(), [0, 2, 3, 5]);
        assert_eq!(set.within(3), RowSet(0b101));
        assert_eq!(
            [0, 1, 6].map(RowSet::all),
            [RowSet(0), RowSet(1), RowSet(63)]
        );
    }
}
