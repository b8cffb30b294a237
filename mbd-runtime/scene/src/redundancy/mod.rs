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
//! Assemblies of one scene can differ in rank (a parallelogram with a third bar moves; crossed, it is a truss): those that move count. Of these the ones
//! that hold most do (a Peaucellier linkage whose arms lie on each other has one freedom more): one is looked for beside the declared start.
//! Parameters are taken at their defaults; a start elsewhere is checked by the run.

mod assembly;
mod choice;
mod configuration;
mod local;
mod planar;
mod tree;

pub use planar::{Apart, in_plane};

use crate::{Layout, Redundancy, Scene, Tree};

/// Finds the repeated rows of a scene laid out in absolute coordinates. Without a loop there are none, and nothing is searched. The joints of a
/// tree, where one is given, lose none. `begun` is asked for a state at which the declaration starts, where there are loops.
#[must_use]
pub(crate) fn find(
    scene: &Scene,
    layout: &Layout,
    tree: Option<&Tree>,
    begun: impl FnOnce() -> Option<Vec<f64>>,
) -> Redundancy {
    let groups = tree::groups(layout, tree);
    let mut found = Redundancy {
        loops: groups.iter().map(|group| group.closing.len()).sum(),
        closed: true,
        ..Redundancy::default()
    };
    let begun = (!groups.is_empty()).then(begun).flatten();
    for group in &groups {
        let states = assembly::states((scene, layout), group, begun.as_deref());
        found.closed &= !states.is_empty();
        let (repeats, held) = choice::repeats(group, &states);
        found.repeats.extend(repeats);
        found.held.extend(held);
    }
    found.repeats.sort_by_key(|repeat| repeat.joint);
    found.held.sort_by_key(|held| (held.joint, held.coordinate));
    found
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
