//! Bodies and points with mass: where in the state each of them is and moves.

use std::ops::Range;

use mbd_scene::{Layout, Part, Place, PointSlots};

/// A body or a point with mass.
#[derive(Clone, Debug)]
pub(crate) struct Moving {
    /// Which one.
    pub part: Part,
    /// The number of its first speed.
    pub speed: usize,
    /// Its position in the state.
    pub position: Range<usize>,
    /// Its quaternion or its angle in the state; empty for a point.
    pub attitude: Range<usize>,
    /// Its velocity in the state.
    pub velocity: Range<usize>,
    /// Its angular velocity in the state; empty for a point.
    pub spin: Range<usize>,
}

impl Moving {
    /// The numbers of its speeds.
    pub fn speeds(&self) -> Range<usize> {
        self.speed..self.speed + self.velocity.len() + self.spin.len()
    }

    /// The numbers of its speeds along the axes.
    pub fn moves(&self) -> Range<usize> {
        self.speed..self.speed + self.velocity.len()
    }

    /// The numbers of its angular speeds.
    pub fn turns(&self) -> Range<usize> {
        self.moves().end..self.speeds().end
    }

    /// Whether a place is on it.
    pub fn holds(&self, place: Place) -> bool {
        match place {
            Place::Body(body, _) => self.part == Part::Body(body),
            Place::Point(point) => self.part == Part::Point(point),
            Place::World(_) => false,
        }
    }
}

/// All of them, bodies first.
pub(crate) fn moving(layout: &Layout) -> impl Iterator<Item = Moving> + '_ {
    let directions = layout.directions;
    let bodies = layout.bodies.iter().enumerate();
    let bodies = bodies.map(|(body, slots)| (Part::Body(body), *slots));
    let points = layout.points.iter().enumerate();
    let points = points.filter_map(|(point, slots)| match slots {
        PointSlots::Mass(slots) => Some((Part::Point(point), *slots)),
        PointSlots::Node(_) => None,
    });
    bodies.chain(points).map(move |(part, slots)| {
        let (attitude, spin) = match part {
            Part::Body(_) => (directions.attitude(), directions.rotations().len()),
            _ => (0, 0),
        };
        let (q, v) = (slots.q, layout.nq + slots.v);
        let moves = directions.translations().len();
        Moving {
            part,
            speed: slots.v,
            position: q..q + moves,
            attitude: q + moves..q + moves + attitude,
            velocity: v..v + moves,
            spin: v + moves..v + moves + spin,
        }
    })
}
