//! How stiffly lines, springs and stops hold a body or a point with mass: what the rates of a scene and the resolution of its forces follow from.

use std::sync::Arc;

use mbd_scene::laws::{GravityNumbers, Numbers};
use mbd_scene::{Float, Joint, Model, Part, Place, StopSlots};

use crate::moving::Moving;
use crate::unilateral::is_node_line;

/// Everything that acts between two places with a stiffness.
pub(crate) struct Stiffness {
    numbers: Arc<Numbers<f64>>,
    lines: Vec<ElasticElement>,
    /// Per body, then per point, the lines that end on it, each once.
    lines_of: Vec<Vec<usize>>,
    coordinates: Vec<SprungCoordinate>,
}

/// A line or a spring.
struct ElasticElement {
    ends: [Place; 2],
    /// Whether it pulls only, and ends at no equilibrium point: what such a point passes on is softer than each of its lines.
    unilateral: bool,
    /// The largest slope of its force [N/m].
    stiffness: f64,
}

/// A joint coordinate with a spring or stops.
struct SprungCoordinate {
    ends: [Place; 2],
    angle: bool,
    /// Of the spring, and of one stop: only one is touched at a time [N/m or N m].
    stiffness: [f64; 2],
}

impl Stiffness {
    /// That of a model, for its parameters; `numbers`: those of its scene with them.
    pub(crate) fn new<T: Float>(model: &dyn Model<T>, numbers: Arc<Numbers<f64>>) -> Self {
        let scene = model.scene();
        let lines = scene.lines.iter().zip(model.lines());
        let lines = lines
            .enumerate()
            .map(|(index, (line, numbers))| ElasticElement {
                ends: [line.from, line.to],
                unilateral: line.kind.is_unilateral() && !is_node_line(model.layout(), index),
                stiffness: line
                    .kind
                    .stiffest(&scene.tables, numbers.stiffness.to_f64()),
            });
        let lines: Vec<ElasticElement> = lines.collect();
        let mut lines_of = vec![Vec::new(); numbers.bodies.len() + numbers.points.len()];
        for (index, line) in lines.iter().enumerate() {
            for place in line.ends {
                let own = number(&numbers, place).and_then(|at| lines_of.get_mut(at));
                if let Some(own) = own.filter(|own| own.last() != Some(&index)) {
                    own.push(index);
                }
            }
        }
        Stiffness {
            lines,
            lines_of,
            coordinates: coordinates(model, &numbers),
            numbers,
        }
    }

    /// The stiffness against a translation: the sum over what holds it [N/m]. `unilateral`: of stops alone, and of lines that pull only and
    /// end at no equilibrium point.
    pub(crate) fn moving(&self, owner: &Moving, unilateral: bool) -> f64 {
        let lines = self.lines_on(owner);
        let lines = lines.filter(|line| line.unilateral || !unilateral);
        lines.map(|line| line.stiffness).sum::<f64>() + self.along(owner, false, unilateral)
    }

    /// The sum over all lines and springs between places [N/m].
    pub(crate) fn of_lines(&self) -> f64 {
        self.lines.iter().map(|line| line.stiffness).sum()
    }

    /// The same of lines and springs whose other end is in the world.
    pub(crate) fn to_world(&self, owner: &Moving) -> f64 {
        let world = |end: &Place| matches!(end, Place::World(_));
        let lines = self.lines_on(owner);
        let lines = lines.filter(|line| line.ends.iter().any(world));
        lines.map(|line| line.stiffness).sum()
    }

    /// The lines that end on it.
    fn lines_on(&self, owner: &Moving) -> impl Iterator<Item = &ElasticElement> {
        let place = match (owner.body(), owner.part) {
            (Some(body), _) => Some(Place::Body(body, 0)),
            (None, Part::Point(point)) => Some(Place::Point(point)),
            (None, _) => None,
        };
        let at = place.and_then(|place| number(&self.numbers, place));
        let own = at.and_then(|at| self.lines_of.get(at));
        let own = own.into_iter().flatten();
        own.filter_map(|index| self.lines.get(*index))
    }

    /// The stiffness against a rotation, of joint coordinates [N m].
    pub(crate) fn turning(&self, owner: &Moving, unilateral: bool) -> f64 {
        self.along(owner, true, unilateral)
    }

    /// Of the joint coordinates that are angles, or are not.
    fn along(&self, owner: &Moving, angle: bool, unilateral: bool) -> f64 {
        let own = self.coordinates.iter().filter(|acting| {
            acting.angle == angle && acting.ends.iter().any(|end| owner.holds(*end))
        });
        let skipped = usize::from(unilateral);
        own.map(|acting| acting.stiffness.iter().skip(skipped).sum::<f64>())
            .sum()
    }

    /// The fastest rates ω at which lines and stops that push or pull one way swing it [rad/s]: √(ΣK/m) along, and of a body √(ΣK/I) about its
    /// centre of mass, where a line at a lever r counts as K r².
    pub(crate) fn rates(&self, owner: &Moving) -> [f64; 2] {
        // A body without mass swings with what it carries: what that takes shows in the stages of a run.
        let root = |stiffness: f64, inertia: f64| match stiffness > 0.0 && inertia > 0.0 {
            true => (stiffness / inertia).sqrt(),
            false => 0.0,
        };
        let moving = self.moving(owner, true);
        match owner.body() {
            Some(body) => self.numbers.bodies.get(body).map_or([0.0; 2], |body| {
                let turning = self.turning(owner, true) + self.levers(owner);
                let inertia = body.inertia.trace() / 3.0;
                [root(moving, body.mass), root(turning, inertia)]
            }),
            None => [root(moving, self.mass(owner)), 0.0],
        }
    }

    /// The mass of a body or a point [kg].
    pub(crate) fn mass(&self, owner: &Moving) -> f64 {
        let numbers = &self.numbers;
        let mass = match (owner.body(), owner.part) {
            (Some(body), _) => numbers.bodies.get(body).map(|body| body.mass),
            (None, Part::Point(point)) => numbers.points.get(point).map(|(mass, _)| *mass),
            (None, _) => None,
        };
        mass.unwrap_or(0.0)
    }

    /// The largest mass of everything that hangs together with each of `parts` by lines, springs and joints; the world does not tie [kg].
    pub(crate) fn heaviest_tied(&self, joints: &[Joint], parts: &[Moving]) -> Vec<f64> {
        let lines = self.lines.iter().map(|line| line.ends);
        let ends = lines.chain(joints.iter().map(|joint| [joint.parent, joint.child]));
        // Points without mass tie what their lines lead to.
        let bodies = self.numbers.bodies.len();
        let number = |place: Place| number(&self.numbers, place);
        let mut groups = ConnectedGroups::of(bodies + self.numbers.points.len());
        for [a, b] in ends {
            if let (Some(a), Some(b)) = (number(a), number(b)) {
                groups.join(a, b);
            }
        }
        let own = |part: &Moving| match (part.body(), part.part) {
            (Some(body), _) => body,
            (None, Part::Body(at) | Part::Point(at) | Part::Joint(at) | Part::Coordinates(at)) => {
                bodies + at
            }
        };
        let mut heaviest = vec![0.0_f64; bodies + self.numbers.points.len()];
        for part in parts {
            let group = groups.root(own(part));
            if let Some(most) = heaviest.get_mut(group) {
                *most = most.max(self.mass(part));
            }
        }
        let mut of = |part: &Moving| heaviest.get(groups.root(own(part))).copied();
        parts.iter().map(|part| of(part).unwrap_or(0.0)).collect()
    }

    /// Gravity where it is the same everywhere, else zero [m/s²].
    pub(crate) fn gravity(&self) -> f64 {
        match &self.numbers.gravity {
            GravityNumbers::Uniform(g) => g.norm(),
            _ => 0.0,
        }
    }

    /// Σ K r² of the lines that pull only [N m].
    fn levers(&self, owner: &Moving) -> f64 {
        let lever = |end: Place| match end {
            Place::Body(body, frame) if owner.holds(end) => {
                let frame = self.numbers.bodies.get(body)?.frames.get(frame)?;
                Some(frame.position.norm_squared())
            }
            _ => None,
        };
        let lines = self.lines_on(owner).filter(|line| line.unilateral);
        let ends = lines.flat_map(|line| line.ends.map(|end| (end, line.stiffness)));
        ends.filter_map(|(end, stiffness)| Some(stiffness * lever(end)?))
            .sum()
    }
}

/// The number of what a place is on: bodies first, then points, those without mass among them; `None` of the world.
fn number(numbers: &Numbers<f64>, place: Place) -> Option<usize> {
    match place {
        Place::Body(body, _) => Some(body),
        Place::Point(point) => Some(numbers.bodies.len() + point),
        Place::World(_) => None,
    }
}

/// What hangs together, by the number of one of a group.
struct ConnectedGroups(Vec<usize>);

impl ConnectedGroups {
    fn of(count: usize) -> Self {
        ConnectedGroups((0..count).collect())
    }

    /// The number that stands for a group.
    fn root(&mut self, mut of: usize) -> usize {
        while let Some(&next) = self.0.get(of).filter(|next| **next != of) {
            let further = self.0.get(next).copied().unwrap_or(next);
            if let Some(slot) = self.0.get_mut(of) {
                *slot = further;
            }
            of = next;
        }
        of
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if let Some(slot) = self.0.get_mut(a) {
            *slot = b;
        }
    }
}

fn coordinates<T: Float>(model: &dyn Model<T>, numbers: &Numbers<f64>) -> Vec<SprungCoordinate> {
    let (scene, lines) = (model.scene(), model.layout().lines.len());
    let mut found = Vec::new();
    for (index, (joint, entries)) in scene.joints.iter().zip(&numbers.forces).enumerate() {
        for (forces, numbers) in joint.forces.iter().zip(entries) {
            let Some((_, coordinate)) = scene.coordinate(index, forces.coordinate) else {
                continue;
            };
            let stops = model
                .layout()
                .stops
                .iter()
                .zip(model.lines().iter().skip(lines));
            let own =
                |slots: &StopSlots| slots.joint == index && slots.coordinate == forces.coordinate;
            let stop = stops
                .filter(|(slots, _)| own(slots))
                .map(|(_, numbers)| numbers.stiffness.to_f64())
                .fold(0.0, f64::max);
            found.push(SprungCoordinate {
                ends: [joint.parent, joint.child],
                angle: coordinate.is_angle(),
                stiffness: [numbers.stiffness.unwrap_or(0.0), stop],
            });
        }
    }
    found
}
