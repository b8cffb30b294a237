//! The origin that positions of a run are measured from, where it follows a body or a point: [`mbd_scene::laws::origin`] has the equations.
//!
//! What the outside gives and gets is in the world: states that are set and read, rows of histories, what controllers see. Inside, the state, the
//! nodes and their memory are measured from the origin, and snapshots hold both. The origin is moved on after a step at whose end what it follows is
//! further from it than the length of the scene ([`Scales`](crate::Scales)): positions then have the digits of the scene, and a run pays one evaluation for it.

use mbd_scene::laws::origin::NUMBERS;
use mbd_scene::{Float, Layout, NodeModel, Part, PointSlots, Scene, Slots};
use serde::{Deserialize, Serialize};

use crate::node::NodeMemory;
use crate::system::System;

/// A number and what rounding left of it: twice the digits.
type Twice = [f64; 2];

/// The sum of a number with twice the digits and another one (Knuth's two-sum).
fn plus([high, low]: Twice, more: f64) -> Twice {
    let sum = high + more;
    let back = sum - high;
    let lost = (high - (sum - back)) + (more - back);
    let rest = low + lost;
    let whole = sum + rest;
    [whole, rest - (whole - sum)]
}

/// The product of a number with twice the digits and another one, as two numbers to be added.
fn times([high, low]: Twice, by: f64) -> [f64; 2] {
    let product = high * by;
    [product, high.mul_add(by, -product) + low * by]
}

/// How the origin moves: uniformly, from where it was set down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MovingOrigin {
    /// Where it was [m].
    position: [Twice; 3],
    /// Its velocity [m/s].
    velocity: [Twice; 3],
    /// When that was [s].
    since: f64,
}

impl MovingOrigin {
    /// Where it is at a time [m], and its velocity [m/s].
    pub(crate) fn at(&self, time: f64) -> [[f64; 3]; 2] {
        let passed = time - self.since;
        let position = [0, 1, 2].map(|axis| {
            let [moved, rest] = times(self.velocity[axis], passed);
            let [high, low] = plus(plus(self.position[axis], moved), rest);
            high + low
        });
        [position, self.velocity.map(|[high, low]| high + low)]
    }

    /// Moved on to where something is, by how far that is from it and how fast it moves against it.
    fn moved_on(&self, time: f64, [away, faster]: [[f64; 3]; 2]) -> Self {
        let passed = time - self.since;
        let axes = [0, 1, 2];
        MovingOrigin {
            position: axes.map(|axis| {
                let [moved, rest] = times(self.velocity[axis], passed);
                plus(plus(plus(self.position[axis], moved), rest), away[axis])
            }),
            velocity: axes.map(|axis| plus(self.velocity[axis], faster[axis])),
            since: time,
        }
    }

    /// The numbers behind the others of [`At::hold`](mbd_scene::At::hold).
    fn numbers<T: Float>(&self) -> [T; NUMBERS] {
        let [x, y, z] = self.position.map(|[high, _]| T::from_f64(high));
        let [vx, vy, vz] = self.velocity.map(|[high, _]| T::from_f64(high));
        [x, y, z, vx, vy, vz, T::from_f64(self.since)]
    }
}

/// What a number of the state, or of the nodes, is measured from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum From {
    /// Nothing.
    Nothing,
    /// A component of the position of the origin.
    Position(usize),
    /// A component of its velocity.
    Velocity(usize),
}

impl From {
    fn of(self, [position, velocity]: &[[f64; 3]; 2]) -> f64 {
        match self {
            From::Nothing => 0.0,
            From::Position(axis) => position[axis],
            From::Velocity(axis) => velocity[axis],
        }
    }
}

/// What the numbers of a scene are measured from.
#[derive(Clone, Debug)]
pub(crate) struct MeasuredFrom {
    /// Per number of the state.
    state: Vec<From>,
    /// Per node unknown.
    nodes: Vec<From>,
    /// Where in the state the positions of `rate` nodes are: all zero they say nothing.
    rate_nodes: std::ops::Range<usize>,
}

impl MeasuredFrom {
    pub(crate) fn new(layout: &Layout) -> Self {
        let axes = layout.directions.translations();
        let mut state = vec![From::Nothing; layout.nx()];
        let points = layout.points.iter().filter_map(|slots| match slots {
            PointSlots::Mass(slots) => Some(*slots),
            PointSlots::Node(_) => None,
        });
        let bodies = layout.own_bodies().map(|(_, slots)| slots);
        for slots in bodies.chain(points) {
            for (k, &axis) in axes.iter().enumerate() {
                state[slots.q + k] = From::Position(axis);
                state[layout.nq + slots.v + k] = From::Velocity(axis);
            }
        }
        let first = layout.nq + layout.nv;
        let rate_nodes = first..first + layout.nz;
        for (k, number) in state[rate_nodes.clone()].iter_mut().enumerate() {
            *number = From::Position(k % 3);
        }
        let nodes = layout.nodes.iter().flat_map(|node| {
            [0, 1, 2].map(|axis| match node.model {
                NodeModel::Rate => From::Velocity(axis),
                _ => From::Position(axis),
            })
        });
        MeasuredFrom {
            nodes: nodes.collect(),
            state,
            rate_nodes,
        }
    }

    /// The same state measured from a place that moves.
    pub(crate) fn measure_from(&self, state: &mut [f64], place: &[[f64; 3]; 2]) {
        let says: Vec<bool> = (0..state.len())
            .map(|index| !self.says_nothing(index, state))
            .collect();
        for (index, (number, says)) in state.iter_mut().zip(says).enumerate() {
            if says {
                *number -= self.of(index, place);
            }
        }
    }

    /// What a number of the state is measured from, of a place that moves.
    pub(crate) fn of(&self, index: usize, place: &[[f64; 3]; 2]) -> f64 {
        let from = self.state.get(index).copied();
        from.unwrap_or(From::Nothing).of(place)
    }

    /// Whether a number says nothing: the position of a `rate` node that nobody gave.
    fn says_nothing(&self, index: usize, state: &[f64]) -> bool {
        let first = self.rate_nodes.start;
        self.rate_nodes.contains(&index) && {
            let node = first + (index - first) / 3 * 3;
            let own = state.get(node..node + 3).unwrap_or_default();
            own.iter().all(|x| *x == 0.0)
        }
    }
}

/// An origin that follows something, and what is measured from it.
#[derive(Clone, Debug)]
pub(crate) struct Following {
    pub(crate) origin: MovingOrigin,
    measured: MeasuredFrom,
    /// What is followed.
    followed: Slots,
}

impl Following {
    /// That of a scene; `None` where its origin stays in the world.
    pub(crate) fn new(scene: &Scene, layout: &Layout) -> Option<Self> {
        Some(Following {
            origin: MovingOrigin::default(),
            measured: MeasuredFrom::new(layout),
            followed: followed(layout, scene.runs.origin?)?,
        })
    }

    /// How far what is followed is from the origin [m] and how fast it moves against it [m/s].
    fn away(&self, layout: &Layout, state: impl Fn(usize) -> f64) -> [[f64; 3]; 2] {
        let mut away = [[0.0; 3]; 2];
        for (k, &axis) in layout.directions.translations().iter().enumerate() {
            away[0][axis] = state(self.followed.q + k);
            away[1][axis] = state(layout.nq + self.followed.v + k);
        }
        away
    }
}

/// The coordinates and speeds of what is followed: its own, or of what carries it.
fn followed(layout: &Layout, part: Part) -> Option<Slots> {
    if let Some(slots) = layout.own_slots(part) {
        return Some(slots);
    }
    let Part::Body(body) = part else {
        return None;
    };
    let root = layout.root_link(body)?;
    root.joint.is_none().then_some(root.slots)
}

impl<T: Float> System<T> {
    /// The numbers of a state as they are in the world.
    pub(crate) fn in_world<'a>(
        &'a self,
        time: f64,
        state: &'a [T],
    ) -> impl Iterator<Item = f64> + 'a {
        let following = self.following.as_ref();
        let origin = following.map(|following| following.origin.at(time));
        let own = state.iter().take(self.nx).enumerate();
        own.map(move |(index, number)| match (following, &origin) {
            (Some(following), Some(origin)) => {
                let from = following.measured.state.get(index).copied();
                number.to_f64() + from.unwrap_or(From::Nothing).of(origin)
            }
            _ => number.to_f64(),
        })
    }

    /// The same of node unknowns.
    pub(crate) fn nodes_in_world<'a>(
        &'a self,
        time: f64,
        nodes: &'a [T],
    ) -> impl Iterator<Item = f64> + 'a {
        let following = self.following.as_ref();
        let origin = following.map(|following| following.origin.at(time));
        nodes.iter().enumerate().map(move |(index, number)| {
            let from = following.and_then(|it| it.measured.nodes.get(index));
            let from = from.zip(origin.as_ref());
            number.to_f64() + from.map_or(0.0, |(from, origin)| from.of(origin))
        })
    }

    /// Positions of nodes in the world as they are from the origin.
    pub(crate) fn near_origin(&self, time: f64, nodes: &[T]) -> Vec<T> {
        let Some(following) = &self.following else {
            return nodes.to_vec();
        };
        let [position, _] = following.origin.at(time);
        let own = nodes.iter().enumerate();
        own.map(|(index, x)| T::from_f64(x.to_f64() - position[index % 3]))
            .collect()
    }

    /// Sets the origin down at what it follows in a state that is measured from another origin, and says what that state is from there.
    pub(crate) fn set_down(
        &mut self,
        time: f64,
        last: Option<MovingOrigin>,
        state: &[f64],
    ) -> Vec<T> {
        let last = last.unwrap_or_default();
        let Some(following) = &mut self.following else {
            let [position, velocity] = last.at(time);
            let back = [position, velocity].map(|vector| vector.map(|x| -x));
            let mut state = state.to_vec();
            if last != MovingOrigin::default() {
                MeasuredFrom::new(self.model.layout()).measure_from(&mut state, &back);
            }
            return state.into_iter().map(T::from_f64).collect();
        };
        let number = |index: usize| state.get(index).copied().unwrap_or(0.0);
        let away = following.away(self.model.layout(), number);
        following.origin = last.moved_on(time, away);
        let mut state = state.to_vec();
        following.measured.measure_from(&mut state, &away);
        self.measure_from_origin();
        state.into_iter().map(T::from_f64).collect()
    }

    /// Goes on from an origin that was kept.
    pub(crate) fn take_up_origin(&mut self, origin: Option<MovingOrigin>) {
        if let (Some(following), Some(origin)) = (&mut self.following, origin) {
            following.origin = origin;
        }
        self.measure_from_origin();
    }

    /// The origin as it is now; `None` where it stays in the world.
    pub(crate) fn origin(&self) -> Option<MovingOrigin> {
        self.following.as_ref().map(|following| following.origin)
    }

    /// Lets what is evaluated next be measured from the origin.
    fn measure_from_origin(&mut self) {
        if let Some(following) = &self.following {
            let numbers = following.origin.numbers();
            self.nodes.measure_from(&numbers);
            self.probe.measure_from(&numbers);
        }
    }

    /// Moves the origin on to what it follows, where that has gone further than `length` [m]: whether it did. The state, and what the nodes remember, are
    /// the same places from there.
    #[inline]
    pub(crate) fn keep_up(&mut self, time: f64, length: f64, state: &mut [T]) -> bool {
        self.following.is_some() && self.follow_on(time, length, state)
    }

    fn follow_on(&mut self, time: f64, length: f64, state: &mut [T]) -> bool {
        let Some(following) = &mut self.following else {
            return false;
        };
        let number = |index: usize| state.get(index).map_or(0.0, |x| x.to_f64());
        let away = following.away(self.model.layout(), number);
        let [position, velocity] = away;
        if position.iter().all(|x| x.abs() <= length) {
            return false;
        }
        following.origin = following.origin.moved_on(time, away);
        for (number, from) in state.iter_mut().zip(&following.measured.state) {
            *number -= T::from_f64(from.of(&away));
        }
        let by = [position, velocity].map(|vector| vector.map(T::from_f64));
        self.memory.shift(self.model.layout(), by);
        self.measure_from_origin();
        true
    }
}

impl<T: Float> NodeMemory<T> {
    /// Measures places, and velocities of nodes, from where the origin was moved on by, and from what it is faster by.
    fn shift(&mut self, layout: &Layout, [position, velocity]: [[T; 3]; 2]) {
        let shift = |vector: &mut [T], by: [T; 3]| {
            for (number, by) in vector.iter_mut().zip(by) {
                *number -= by;
            }
        };
        let (nodes, anchors) = (&mut self.nodes, &mut self.anchors);
        let places = nodes.chunks_exact_mut(3).chain(anchors.chunks_exact_mut(3));
        places.for_each(|place| shift(place, position));
        for at in layout.nodes.iter().filter_map(|node| node.velocity) {
            let own = self.effective.get_mut(at..at + 3);
            shift(own.unwrap_or_default(), velocity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_that_is_moved_on_a_million_times_loses_nothing() {
        let mut origin = MovingOrigin::default().moved_on(0.0, [[1e9, 0.0, 0.0], [1e4, 0.0, 0.0]]);
        for k in 1..=1_000_000_u32 {
            let time = 0.125 * f64::from(k);
            origin = origin.moved_on(time, [[0.001, 0.0, 0.0], [0.0; 3]]);
        }
        let [position, _] = origin.at(125_000.0);
        // 1e9 m + 1e4 m/s · 125,000 s + 1e6 · 0.001 m; 0.001 is not a binary number.
        let exact = 1e9 + 1.25e9 + 1000.0;
        assert!(
            (position[0] - exact).abs() <= 2.4e-7,
            "{}",
            position[0] - exact
        );
    }
}
