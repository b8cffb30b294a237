//! Rows that repeat others, found once: joints that close a loop can forbid what the loop forbids anyway. Four parallel hinges of a planar
//! four-bar have 20 rows of rank 17.
//!
//! The rank is found at random consistent states: parts are placed along a spanning tree of the joints at random joint coordinates, the loops
//! are closed by damped least squares, which does not mind a lost rank, and joints on a wrong branch are thrown away. In the speeds u that
//! the tree leaves (v = B u), every row of a closing joint is one row of
//!
//! ```text
//! G = Φ_v B                                                                       (1)
//! ```
//!
//! and what repeats the tree and earlier joints is what adds nothing to its rank. Rows are kept greedily: joints in the order of declaration,
//! so that the last one of a loop loses rows; inside a joint the row with most that is new, at its worst over the states. The joints of the
//! tree never lose any. A joint that loses rows and those whose rows they repeat carry a self-stress: forces in balance that move nothing.
//! A component of a reaction is unique where no self-stress changes it: those of a planar four-bar push across its plane only, and its
//! reactions in the plane are what they are. That is asked at several states, and where params, time or the motion of the whole may turn what is
//! zero there into something else, also with these changed; where no such state closes, all three components count as changed.
//!
//! Assemblies of one scene can differ in rank (a parallelogram with a third bar moves; crossed, it is a truss): those that move count. Of these the ones
//! that hold most do (a Peaucellier linkage whose arms lie on each other has one freedom more): one is looked for beside the declared start.
//! Parameters are taken at their defaults; a start elsewhere is checked by the run.

mod assembly;
mod choice;
mod configuration;
mod local;
mod planar;
mod stress;
mod tree;

pub use planar::{Apart, in_plane};

use crate::{Ambiguous, Layout, Redundancy, Scene, Tree};

use self::assembly::LinearisedState;
use self::choice::{RowChoice, choose, self_stresses, that_count};
use self::tree::LoopGroup;

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
        let states = that_count(&states);
        let choice = choose(group, &states);
        let ambiguous = ambiguous((scene, layout), group, &choice, &states);
        found.ambiguous.extend(ambiguous);
        found.repeats.extend(choice.repeats);
        found.held.extend(choice.held);
    }
    found.repeats.sort_by_key(|repeat| repeat.joint);
    found.ambiguous.sort_by_key(|of| of.joint);
    found.held.sort_by_key(|held| (held.joint, held.coordinate));
    found
}

/// The components of reactions that self-stresses change.
fn ambiguous(
    (scene, layout): (&Scene, &Layout),
    group: &LoopGroup,
    choice: &RowChoice,
    states: &[&LinearisedState],
) -> Vec<Ambiguous> {
    if choice.repeats.is_empty() && choice.held.is_empty() {
        return Vec::new();
    }
    let mut found: Vec<Ambiguous> = Vec::new();
    // Whether every state told: where one did not, zeros may be accidents.
    let mut sure = true;
    let mut take = |state: &LinearisedState| match self_stresses(group, state, choice) {
        Some(stresses) => {
            let changed = stresses.into_iter().flat_map(|stress| stress.changed);
            changed.for_each(|(joint, components)| Ambiguous::add(&mut found, joint, components));
        }
        None => sure = false,
    };
    states.iter().for_each(|state| take(state));
    if let Some(elsewhere) = assembly::states_elsewhere((scene, layout), group) {
        let same = |state: &&LinearisedState| {
            let first = states.first();
            first.is_some_and(|first| {
                (first.freedoms > 0, first.rank) == (state.freedoms > 0, state.rank)
            })
        };
        let elsewhere: Vec<&LinearisedState> = elsewhere.iter().filter(same).collect();
        elsewhere.iter().for_each(|state| take(state));
        sure &= !elsewhere.is_empty();
    }
    if !sure {
        found.iter_mut().for_each(Ambiguous::widen);
    }
    found.retain(|of| of.components.contains(&true));
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
