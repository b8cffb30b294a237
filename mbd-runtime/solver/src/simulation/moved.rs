//! What the start of a run moved: a state at which the joints do not hold is corrected, and this says by how much.

use std::ops::Range;

use mbd_scene::{Directions, Float, Layout, Scene};
use nalgebra::{Quaternion, UnitQuaternion};

use crate::columns::part_name;
use crate::moving::moving;

/// Changes of a body that joints of a tree carry that are rounding, over one SI unit and its size.
const ROUNDED: f64 = 1e-9;

/// How far the start moved a body or a point with mass so that the joints hold: see [`Simulation::start_moved`](crate::Simulation::start_moved).
#[derive(Clone, Debug, PartialEq)]
pub struct Moved {
    /// Its name.
    pub name: String,
    /// Distance of its centre of mass from where it was set [m].
    pub distance: f64,
    /// Angle between its attitude and the one that was set [rad]; zero for a point.
    pub angle: f64,
    /// Change of the velocity of its centre of mass [m/s].
    pub velocity: f64,
    /// Change of its angular velocity [rad/s]; zero for a point.
    pub angular_velocity: f64,
    /// Speed of its centre of mass as it was set [m/s].
    pub speed: f64,
    /// Its angular speed as it was set [rad/s]; zero for a point.
    pub angular_speed: f64,
}

/// √Σ x².
fn size(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.map(|x| x * x).sum::<f64>().sqrt()
}

impl Moved {
    /// From one list to another, of what has its position, attitude, velocity and angular velocity at these places; changes up to a part of one SI unit and of
    /// what was set are `rounding`. `None` where nothing else is left.
    fn between<T: Float>(
        name: String,
        [position, attitude, velocity, spin]: [Range<usize>; 4],
        [before, after]: [&[T]; 2],
        rounding: f64,
    ) -> Option<Self> {
        let numbers = |list: &[T], own: &Range<usize>| -> Vec<f64> {
            let own = list.get(own.clone()).unwrap_or_default();
            own.iter().map(|x| x.to_f64()).collect()
        };
        let set = |own: &Range<usize>| size(numbers(before, own).into_iter());
        let beyond = |change: f64, set: f64| match change <= rounding * (1.0 + set) {
            true => 0.0,
            false => change,
        };
        let difference = |own: &Range<usize>| {
            let pairs = numbers(after, own).into_iter().zip(numbers(before, own));
            beyond(size(pairs.map(|(after, before)| after - before)), set(own))
        };
        let moved = Moved {
            name,
            distance: difference(&position),
            angle: match attitude.len() {
                4 => {
                    let [before, after] = [before, after].map(|x| quaternion(x, attitude.start));
                    beyond(turn(before, after), 0.0)
                }
                _ => difference(&attitude),
            },
            speed: set(&velocity),
            angular_speed: set(&spin),
            velocity: difference(&velocity),
            angular_velocity: difference(&spin),
        };
        let changes = moved.distance + moved.angle + moved.velocity + moved.angular_velocity;
        (changes != 0.0).then_some(moved)
    }
}

/// Everything that is elsewhere after the start, or moves otherwise, the largest distance first.
pub(super) fn moved<T: Float>(
    (scene, layout): (&Scene, &Layout),
    before: &[T],
    after: &[T],
) -> Vec<Moved> {
    let all = moving(layout).filter_map(|part| {
        let name = part_name(scene, part.part).to_owned();
        let places = [part.position, part.attitude, part.velocity, part.spin];
        Moved::between(name, places, [before, after], 0.0)
    });
    let mut all: Vec<Moved> = all.collect();
    let order = |moved: &Moved| (moved.distance, moved.angle, moved.velocity);
    all.sort_by(|a, b| {
        order(b)
            .partial_cmp(&order(a))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    all
}

/// How far a body is moved, of its numbers as [`Quantity::Bodies`](mbd_scene::Quantity::Bodies) has them; `None` where that is rounding.
pub(super) fn moved_body(name: String, directions: Directions, ends: [&[f64]; 2]) -> Option<Moved> {
    let (coordinates, lengths) = (directions.coordinates(), directions.translations().len());
    let places = [
        0..lengths,
        lengths..coordinates,
        coordinates..coordinates + lengths,
        coordinates + lengths..directions.motion(),
    ];
    Moved::between(name, places, ends, ROUNDED)
}

/// The body that is furthest from where it was, by number, with its distance [m] and the angle between its attitudes [rad], of two lists as
/// [`Quantity::Bodies`](mbd_scene::Quantity::Bodies) has them; that which turned most where none is elsewhere.
pub(super) fn furthest(
    directions: Directions,
    before: &[f64],
    after: &[f64],
) -> Option<(usize, [f64; 2])> {
    let (count, lengths) = (directions.motion(), directions.translations().len());
    let bodies = before.chunks_exact(count).zip(after.chunks_exact(count));
    let moves = bodies.map(|(before, after)| {
        let pairs = after.iter().zip(before).take(lengths);
        let distance = size(pairs.map(|(after, before)| after - before));
        let angle = match directions.plane {
            None => turn(quaternion(before, lengths), quaternion(after, lengths)),
            Some(_) => (after[lengths] - before[lengths]).abs(),
        };
        [distance, angle]
    });
    moves.enumerate().max_by(|(_, a), (_, b)| {
        let by_angle = a[1].total_cmp(&b[1]);
        a[0].total_cmp(&b[0]).then(by_angle)
    })
}

/// The quaternion w, x, y, z at a place of a state.
fn quaternion<T: Float>(state: &[T], at: usize) -> [f64; 4] {
    std::array::from_fn(|k| state.get(at + k).map_or(f64::NAN, |x| x.to_f64()))
}

/// The angle between two attitudes [rad].
fn turn(before: [f64; 4], after: [f64; 4]) -> f64 {
    let [before, after] = [before, after]
        .map(|[w, x, y, z]| UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)));
    before.angle_to(&after)
}

#[cfg(test)]
mod tests {
    use super::turn;

    #[test]
    fn an_angle_between_attitudes_is_that_of_the_rotation_between_them() {
        let about_x = |angle: f64| [(0.5 * angle).cos(), (0.5 * angle).sin(), 0.0, 0.0];
        for angle in [1e-9, 1e-3, 0.7, 3.0] {
            let found = turn(about_x(0.4), about_x(0.4 + angle));
            assert!((found - angle).abs() < 1e-15 * (1.0 + 1.0 / angle).min(10.0));
        }
        let far = about_x(0.4).map(|x| -x);
        assert!(turn(far, about_x(0.4)) < 1e-15, "−q is the same attitude");
    }
}
