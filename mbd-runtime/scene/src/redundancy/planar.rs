//! Rows that say something in the plane of a planar scene: two of the five of a hinge about its normal.
//!
//! A row counts if its columns in the plane are new against those of rows of the same joint that count already: one that acts out of the
//! plane has none, and of those that turn a body about the normal one is enough. Rows that do not count are no less true: they hold of
//! themselves where the frames of the joint agree out of the plane, and nowhere else, which the start of a run checks.

use nalgebra::{Matrix3, Rotation3, SVector, Vector3};

use crate::random::SplitMix64;
use crate::redundancy::assembly::random_coordinates;
use crate::redundancy::configuration::Configuration;
use crate::rows::{Columns, Row, Rows};
use crate::scalar::orthogonal::take_out;
use crate::{
    Coordinates, Directions, Joint, Layout, Part, Place, Redundancy, Relative, RowSet, Scene,
};

/// A row is new when more than this part of it is.
const NEW: f64 = 1e-9;
/// Rows whose new parts differ by less than this factor are equally good; the first is taken.
const AS_GOOD: f64 = 0.8;

/// Columns of a row on parent and child.
type Pair = SVector<f64, 12>;

/// The rows of every joint that count in the plane.
pub fn in_plane(scene: &Scene, layout: &Layout) -> Vec<RowSet> {
    let mut configuration = Configuration::new(scene, layout);
    let joints = scene.joints.iter().enumerate();
    joints
        .map(|(index, joint)| {
            if !joint.law.couples().is_empty() {
                // What the plane holds cannot be coupled: see [`Layout::still`].
                return RowSet::all(joint.law.rows());
            }
            let mut set = RowSet::default();
            for rotated in [0.0, 0.7] {
                align(&mut configuration, index, joint, rotated);
                let mut rows = Rows::default();
                configuration.rows_of_law(index, RowSet::all(joint.law.rows()), &mut rows);
                set = counting(rows.rows(), joint, layout.directions, set);
            }
            set
        })
        .collect()
}

/// Turns the frames of a joint as it holds them at zero coordinates, as far as the plane lets it, and then the child by `rotated` [rad] about
/// the normal. Without that, attitude rows have the rank that they have where the joint holds; with it, also a row counts that only touches
/// zero there, so that the start of a run finds it singular. The places of the parts are unlike.
fn align(configuration: &mut Configuration<'_>, index: usize, joint: &Joint, rotated: f64) {
    let numbers = configuration.numbers.joints.get(index).cloned();
    let numbers = numbers.unwrap_or_default();
    let q = random_coordinates(&mut SplitMix64(0), &joint.law, &numbers, 0.0, 1.0);
    let at = Relative {
        q: &q,
        u: &[],
        numbers: &numbers,
    };
    let turn = joint.law.motion(&at).rotation;
    let [near, far] = [joint.parent, joint.child].map(|place| configuration.frame(place).1);
    let some = Rotation3::new(Vector3::new(0.4, 0.5, 0.6)).into_inner();
    let (parent, child) = match joint.child {
        Place::World(_) => (
            far * turn.transpose() * near.transpose(),
            Matrix3::identity(),
        ),
        _ => {
            let parent = match joint.parent {
                Place::Body(..) => some,
                _ => Matrix3::identity(),
            };
            let more = configuration.turn(rotated);
            (parent, more * parent * near * turn * far.transpose())
        }
    };
    let places = [Vector3::new(0.3, -0.7, 0.5), Vector3::new(-0.6, 0.2, 1.1)];
    for (place, axes, position) in [
        (joint.parent, parent, places[0]),
        (joint.child, child, places[1]),
    ] {
        match place {
            Place::World(_) => {}
            Place::Body(body, _) => configuration.place(Part::Body(body), position, &axes),
            Place::Point(point) => configuration.place(Part::Point(point), position, &axes),
        }
    }
}

/// A joint of a planar scene that no motion in the plane closes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// The joint, by index.
    pub joint: usize,
    /// By how much its places are apart along the normal [m]; `None`: its frames lean out of the plane differently.
    pub gap: Option<f64>,
}

impl Layout {
    /// The joints of a planar scene whose frames disagree out of the plane, parameters at their defaults: each with the largest of its rows
    /// that no motion in the plane changes. Ends on frames of the world that move are left to the start of a run.
    #[must_use]
    pub fn apart(scene: &Scene) -> Vec<Apart> {
        // Frames agree or not, whatever the coordinates.
        let scene = &scene.in_coordinates(Coordinates::Absolute);
        let layout = Layout::keeping(scene, Redundancy::default());
        let mut configuration = Configuration::new(scene, &layout);
        let mut apart = Vec::new();
        let held = scene.joints.iter().zip(&layout.joints).enumerate();
        let held = held.filter(|(_, (joint, _))| joint.law.couples().is_empty());
        for (index, (joint, _)) in held.filter(|(_, (_, slots))| slots.holds && !slots.driven) {
            align(&mut configuration, index, joint, 0.0);
            let mut rows = Rows::default();
            configuration.rows_of_law(index, RowSet::all(joint.law.rows()), &mut rows);
            let fixed = rows.rows().iter().filter(|row| {
                let whole = pair(row, joint, Directions::default()).norm();
                pair(row, joint, layout.directions).norm() <= NEW * whole && row.value.abs() > NEW
            });
            let largest = fixed.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
            apart.extend(largest.map(|row| Apart {
                joint: index,
                gap: (row.child().linear != Vector3::zeros()).then(|| row.value.abs()),
            }));
        }
        apart
    }

    /// The coordinates of a planar scene that motors drive, or joints couple, although nothing in the plane changes them: joint and coordinate,
    /// by index.
    #[must_use]
    pub fn still(scene: &Scene) -> Vec<(usize, usize)> {
        let couples = scene.joints.iter().flat_map(|joint| joint.law.couples());
        unchanged(scene, |index, joint| {
            let coupled = couples.clone().filter(|(of, _)| *of == index);
            let motors = joint.motors().map(|(coordinate, _)| coordinate);
            motors
                .chain(coupled.map(|&(_, coordinate)| coordinate))
                .collect()
        })
    }

    /// The coordinates of the joints of a planar scene that nothing in the plane changes: joint and coordinate, by index.
    #[must_use]
    pub fn unchanged(scene: &Scene) -> Vec<(usize, usize)> {
        unchanged(scene, |_, joint| {
            (0..joint.law.coordinates())
                .filter(|&index| joint.law.coordinate(index).is_some())
                .collect()
        })
    }

    /// The axes of frame 1 of a joint in the axes of the part that it sits on, parameters at their defaults. In a plane both have the same normal.
    #[must_use]
    pub fn axes_of_joint(scene: &Scene, joint: usize) -> [[f64; 3]; 3] {
        let layout = Layout::keeping(scene, Redundancy::default());
        let configuration = Configuration::new(scene, &layout);
        let place = scene.joints.get(joint).map(|joint| joint.parent);
        let axes = place.map_or_else(Matrix3::identity, |place| configuration.frame(place).1);
        axes.data.0
    }

    /// The joints of a planar scene that have one coordinate, and nothing in the plane changes it: their axis is the wrong one.
    #[must_use]
    pub fn holding(scene: &Scene) -> Vec<usize> {
        let single = |joint: &Joint| match joint.law.measured().count() {
            1 => vec![0],
            _ => Vec::new(),
        };
        let still = unchanged(scene, |_, joint| single(joint));
        still.into_iter().map(|(joint, _)| joint).collect()
    }
}

/// The coordinates, of those asked for of each joint, that nothing in the plane changes: joint and coordinate, by index.
fn unchanged(scene: &Scene, asked: impl Fn(usize, &Joint) -> Vec<usize>) -> Vec<(usize, usize)> {
    let scene = &scene.in_coordinates(Coordinates::Absolute);
    let layout = Layout::keeping(scene, Redundancy::default());
    let mut configuration = Configuration::new(scene, &layout);
    let mut still = Vec::new();
    for (index, joint) in scene.joints.iter().enumerate() {
        align(&mut configuration, index, joint, 0.0);
        for coordinate in asked(index, joint) {
            let row = configuration.coordinate_row(index, coordinate);
            let moves = row.is_none_or(|row| {
                let whole = pair(&row, joint, Directions::default()).norm();
                pair(&row, joint, layout.directions).norm() > NEW * whole
            });
            still.extend((!moves).then_some((index, coordinate)));
        }
    }
    still
}

/// Of rows of one joint those that count, besides those that do already: always the one with most that is new.
fn counting(
    rows: &[Row<f64>],
    joint: &Joint,
    directions: Directions,
    mut counting: RowSet,
) -> RowSet {
    let all: Vec<(Pair, f64)> = rows
        .iter()
        .map(|row| {
            let whole = pair(row, joint, Directions::default()).norm();
            (pair(row, joint, directions), whole)
        })
        .collect();
    let mut span: Vec<Pair> = Vec::new();
    for (own, _) in counting.rows().filter_map(|row| all.get(row)) {
        let rest = beyond(&span, own);
        span.extend(rest.try_normalize(NEW));
    }
    loop {
        let news = all
            .iter()
            .enumerate()
            .filter(|(row, _)| !counting.contains(*row));
        let news: Vec<(usize, Pair, f64)> = news
            .map(|(row, (own, whole))| {
                let rest = beyond(&span, own);
                (row, rest, rest.norm() / whole.max(f64::MIN_POSITIVE))
            })
            .collect();
        let most = news.iter().fold(0.0, |most: f64, (.., new)| most.max(*new));
        let best = news
            .iter()
            .find(|(.., new)| *new > NEW && *new >= AS_GOOD * most);
        let Some((row, rest, _)) = best else {
            return counting;
        };
        counting.0 |= 1 << row;
        span.push(rest.normalize());
    }
}

/// What of a row is new against orthonormal ones.
fn beyond(span: &[Pair], row: &Pair) -> Pair {
    let mut rest = *row;
    let units = span.iter().map(|unit| (0, unit.as_slice()));
    take_out(rest.as_mut_slice(), units, |_, _| ());
    rest
}

/// The columns of a row on its two ends, as far as these move.
fn pair(row: &Row<f64>, joint: &Joint, directions: Directions) -> Pair {
    let mut pair = Pair::zeros();
    let ends = [
        (joint.parent, row.parent(), 0),
        (joint.child, row.child(), 6),
    ];
    for (place, columns, first) in ends {
        let Columns { linear, angular } = &columns;
        let speeds = match place {
            Place::World(_) => 0,
            Place::Body(..) => directions.speeds(),
            Place::Point(_) => directions.translations().len(),
        };
        let own = directions.components(linear, angular).take(speeds);
        for (k, value) in own.enumerate() {
            pair[first + k] = value;
        }
    }
    pair
}
