//! Bodies and points with mass, and the joints of a tree: where in the state each of them is and moves.

use std::ops::Range;

use mbd_scene::{Layout, Part, Place, PointSlots, Slots};

/// A body or a point with mass; or a joint of the tree, whose displacements are its position and whose angles, or quaternion, are its attitude.
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
    /// The body that a joint of the tree carries.
    pub carried: Option<usize>,
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

    /// The body that it is, or carries.
    pub fn body(&self) -> Option<usize> {
        match self.part {
            Part::Body(body) => Some(body),
            _ => self.carried,
        }
    }

    /// Whether its attitude is a quaternion.
    pub fn has_quaternion(&self) -> bool {
        self.attitude.len() > self.spin.len()
    }

    /// Whether a place is on it.
    pub fn holds(&self, place: Place) -> bool {
        match place {
            Place::Body(body, _) => self.body() == Some(body),
            Place::Point(point) => self.part == Part::Point(point),
            Place::World(_) => false,
        }
    }
}

/// All of them, in the order of the state.
pub(crate) fn moving(layout: &Layout) -> impl Iterator<Item = Moving> + '_ {
    let directions = layout.directions;
    let moves = directions.translations().len();
    let bodies = layout.own_bodies().map(move |(body, slots)| {
        let turns = [directions.attitude(), directions.rotations().len()];
        place(layout, Part::Body(body), slots, moves, turns)
    });
    let joints = layout.joint_links().map(|(joint, link)| {
        let slides = link.speeds - link.turns;
        let turns = [link.coordinates - slides, link.turns];
        Moving {
            carried: Some(link.body),
            ..place(layout, Part::Coordinates(joint), link.slots, slides, turns)
        }
    });
    let points = layout.points.iter().enumerate();
    let points = points.filter_map(move |(point, slots)| match slots {
        PointSlots::Mass(slots) => Some(place(layout, Part::Point(point), *slots, moves, [0, 0])),
        PointSlots::Node(_) => None,
    });
    bodies.chain(joints).chain(points)
}

/// Which of [`moving`] a place is on, without looking at all of them.
#[derive(Debug)]
pub(crate) struct Owners {
    bodies: Vec<Option<usize>>,
    points: Vec<Option<usize>>,
}

impl Owners {
    /// Those of a layout.
    pub fn of(layout: &Layout) -> Self {
        let mut owners = Owners {
            bodies: vec![None; layout.bodies.len()],
            points: vec![None; layout.points.len()],
        };
        for (number, part) in moving(layout).enumerate() {
            let slot = match (part.body(), part.part) {
                (Some(body), _) => owners.bodies.get_mut(body),
                (None, Part::Point(point)) => owners.points.get_mut(point),
                (None, _) => None,
            };
            if let Some(slot) = slot {
                *slot = Some(number);
            }
        }
        owners
    }

    /// The number of one of them.
    pub fn place_of(&self, part: &Moving) -> Option<usize> {
        match (part.body(), part.part) {
            (Some(body), _) => self.at(Place::Body(body, 0)),
            (None, Part::Point(point)) => self.at(Place::Point(point)),
            (None, _) => None,
        }
    }

    /// The number of what a place is on; `None` of the world, and of points without mass.
    pub fn at(&self, place: Place) -> Option<usize> {
        let own = match place {
            Place::Body(body, _) => self.bodies.get(body),
            Place::Point(point) => self.points.get(point),
            Place::World(_) => None,
        };
        own.copied().flatten()
    }
}

/// One of them: first what moves along, `moves` numbers, then what turns, so many coordinates and speeds.
fn place(
    layout: &Layout,
    part: Part,
    slots: Slots,
    moves: usize,
    [attitude, spin]: [usize; 2],
) -> Moving {
    let (q, v) = (slots.q, layout.nq + slots.v);
    Moving {
        part,
        speed: slots.v,
        position: q..q + moves,
        attitude: q + moves..q + moves + attitude,
        velocity: v..v + moves,
        spin: v + moves..v + moves + spin,
        carried: None,
    }
}
