//! What acts along a joint coordinate x with rate u: a generalised force Q, which the bodies feel as Φ_vᵀ Q (see [`crate::rows::coordinate`]).
//!
//! ```text
//! Q = −K (x − x0) − C u − F u/√(u² + w²) + P_low − P_high + f                  [N], for an angle [N m]                  (1)
//! P = max(0, K_s e + C_s ė) if e > 0, else 0;   low: e = x_low − x, ė = −u;   high: e = x − x_high, ė = u                (2)
//! elastic energy ½ K (x − x0)² + Σ ½ K_s e₊²;  power of the dampers −C u² − F u²/√(u² + w²) − Σ (P − K_s e₊) ė           (3)
//! ```
//!
//! Springs and dampers restrict a joint by loads and take no freedom away (Kamman, Connecting Joints I); the same holds for stops and for a
//! prescribed force. A stop is a line of [`crate::laws::line`] whose stretch is the depth e: same law (2), same care (it never pulls back, and its
//! damping begins with the touch), same located switches. Friction is Coulomb's level F, led through zero over the rate w: it creeps under
//! load at about w Q/F instead of sticking, and its slope F/w bounds the step. Singular case: none, w > 0.
//! An angle counts full turns ([`Evaluation::with_turns`]), so that a spring winds up. Rejected: F sign(u), which is no function at u = 0.

use std::cell::OnceCell;

use nalgebra::Vector3;

use crate::joints::{JointForces, Side};
use crate::laws::JointForceNumbers;
use crate::laws::evaluation::Evaluation;
use crate::laws::formula;
use crate::laws::line;
use crate::rows::{Ends, Row};
use crate::{AngularVelocity, Coordinate, Place, Real};

/// A coordinate that something acts along, at a state.
pub struct JointForcesAt<'a, S: Real> {
    evaluation: &'a Evaluation<'a, S>,
    /// The joint.
    pub joint: usize,
    ends: Ends<'a, S>,
    coordinate: Coordinate,
    declared: &'a JointForces,
    numbers: &'a JointForceNumbers<S>,
    /// The number of its first stop among all stops.
    first_stop: usize,
    value: OnceCell<S>,
    rate: OnceCell<S>,
}

/// A stop at a state.
#[derive(Clone, Copy, Debug)]
pub struct StopMotion<'a, S> {
    /// The number of the stop.
    pub stop: usize,
    /// Depth e [m or rad].
    pub depth: S,
    /// Its rate ė [m/s or rad/s].
    pub closing: S,
    /// K_s e + C_s ė [N or N m].
    pub pull: S,
    /// P of (2) [N or N m].
    pub push: S,
    element: line::Element<'a, S>,
    side: Side,
}

/// Calls `visit` for every coordinate that something acts along, in order.
pub fn visit<S: Real>(
    evaluation: &Evaluation<'_, S>,
    visit: &mut dyn FnMut(&JointForcesAt<'_, S>),
) {
    let mut first_stop = 0;
    for (joint, declared) in evaluation.scene.joints.iter().enumerate() {
        let numbers = evaluation.numbers.forces.get(joint);
        for (forces, numbers) in declared.forces.iter().zip(numbers.into_iter().flatten()) {
            let stop = first_stop;
            first_stop += forces.stops.iter().flatten().count();
            S::section(&declared.name);
            let ends = evaluation.ends(joint, AngularVelocity::Body);
            let coordinate = declared.law.coordinate(forces.coordinate);
            let (Some(ends), Some(coordinate)) = (ends, coordinate) else {
                continue;
            };
            visit(&JointForcesAt {
                evaluation,
                joint,
                ends,
                coordinate,
                declared: forces,
                numbers,
                first_stop: stop,
                value: OnceCell::new(),
                rate: OnceCell::new(),
            });
        }
    }
}

impl<S: Real> JointForcesAt<'_, S> {
    /// The number of the coordinate.
    pub fn number(&self) -> usize {
        self.declared.coordinate
    }

    pub fn value(&self) -> S {
        let evaluation = self.evaluation;
        *self
            .value
            .get_or_init(|| match evaluation.carried(self.joint, self.number()) {
                Some([value, _]) => evaluation.at.state[value],
                None => {
                    let value = self.ends.value(&self.coordinate);
                    evaluation.with_turns(self.joint, self.number(), value)
                }
            })
    }

    fn rate(&self) -> S {
        let evaluation = self.evaluation;
        *self
            .rate
            .get_or_init(|| match evaluation.carried(self.joint, self.number()) {
                Some([_, rate]) => evaluation.at.state[rate],
                None => self.ends.rate(&self.coordinate),
            })
    }

    /// The coordinate as a row: its columns take Q to the bodies.
    pub fn row(&self) -> Row<S> {
        self.ends.row(&self.coordinate)
    }

    /// x − x0.
    fn deflection(&self) -> S {
        match self.numbers.rest {
            Some(rest) => self.value() - rest,
            None => self.value(),
        }
    }

    /// F u/√(u² + w²).
    fn friction(&self) -> Option<S> {
        let [level, width] = self.numbers.friction?;
        let rate = self.rate();
        let size = (rate * rate + width * width).sqrt();
        Some((level * rate / size).label("friction"))
    }

    /// f.
    fn force(&self) -> Option<S> {
        let formula = self.declared.force.as_ref()?;
        Some(formula::scalar(formula, self.evaluation))
    }

    /// Its stops.
    pub fn stops(&self) -> impl Iterator<Item = StopMotion<'_, S>> + '_ {
        let sides = [Side::Low, Side::High].into_iter();
        sides
            .filter_map(|side| Some((side, self.numbers.stops[side.index()]?)))
            .zip(self.first_stop..)
            .filter_map(|((side, place), stop)| self.stop(side, place, stop))
    }

    fn stop(&self, side: Side, place: S, stop: usize) -> Option<StopMotion<'_, S>> {
        let scene = self.evaluation.scene;
        let index = scene.lines.len() + stop;
        let given = self.declared.stop_damping.as_ref();
        let element = line::Element {
            damped: given.is_some_and(|damping| !scene.is_zero(damping)),
            ..line::Element::linear(*self.evaluation.numbers.lines.get(index)?)
        };
        let hold = self.evaluation.at.hold.get(index).copied()?;
        let depth = match side {
            Side::Low => place - self.value(),
            Side::High => self.value() - place,
        };
        let closing = match (element.damped, side) {
            (false, _) => S::zero(),
            (true, Side::Low) => -self.rate(),
            (true, Side::High) => self.rate(),
        };
        Some(StopMotion {
            stop,
            depth,
            closing,
            pull: element.pull(depth, closing),
            push: element.tension(depth, closing, hold),
            element,
            side,
        })
    }

    /// Q by (1).
    pub fn effort(&self) -> S {
        let mut effort = S::zero();
        if let Some(stiffness) = self.numbers.stiffness {
            effort -= stiffness * self.deflection();
        }
        if let Some(damping) = self.numbers.damping {
            effort -= damping * self.rate();
        }
        if let Some(friction) = self.friction() {
            effort -= friction;
        }
        for stop in self.stops() {
            match stop.side {
                Side::Low => effort += stop.push,
                Side::High => effort -= stop.push,
            }
        }
        if let Some(force) = self.force() {
            effort += force;
        }
        let effort = self.evaluation.where_joined(self.joint, effort);
        effort.label("effort")
    }

    /// Elastic energy [J], power of the force and power of dampers and friction [W], by (3).
    pub fn energy(&self) -> [S; 3] {
        let half = S::from_f64(0.5);
        let (mut elastic, mut load, mut damping) = (S::zero(), S::zero(), S::zero());
        if let Some(stiffness) = self.numbers.stiffness {
            let deflection = self.deflection();
            elastic += half * (stiffness * (deflection * deflection));
        }
        if let Some(coefficient) = self.numbers.damping {
            damping -= coefficient * (self.rate() * self.rate());
        }
        if let Some(friction) = self.friction() {
            damping -= friction * self.rate();
        }
        for stop in self.stops() {
            elastic += stop.element.energy(stop.depth);
            let power = stop
                .element
                .damping_power(stop.depth, stop.closing, stop.push);
            if let Some(power) = power {
                damping -= power;
            }
        }
        if let Some(force) = self.force() {
            load += force * self.rate();
        }
        [elastic, load, damping].map(|number| self.evaluation.where_joined(self.joint, number))
    }

    /// Q as a force on the child and a torque about the origin of frame 2, world axes.
    fn on_child(&self) -> [Vector3<S>; 2] {
        let (effort, row) = (self.effort(), self.row());
        let torque = self.ends.child.outward.apply(&row.couple);
        let [force, torque] = [row.child().linear, torque].map(|part| part.map(|x| x * effort));
        let directions = self.evaluation.layout.directions;
        [directions.in_plane(force), directions.about_normal(torque)]
    }

    /// Q times the share of moving frames of the world in the rate [W]; `None` where no end moves by itself.
    pub fn driven(&self) -> Option<S> {
        let (parent, child) = (&self.ends.parent, &self.ends.child);
        if parent.prescribed.is_none() && child.prescribed.is_none() {
            return None;
        }
        let mut row = self.row();
        row.prescribe(&self.ends);
        let moved = self.evaluation.prescribed_in_world(self.joint, row.whole());
        Some(self.effort() * moved)
    }

    /// The two ends: what each sits on.
    pub fn places(&self) -> Option<[Place; 2]> {
        let joint = self.evaluation.scene.joints.get(self.joint)?;
        Some([joint.parent, joint.child])
    }
}

/// What acts along the coordinates of a joint, as a force on its child and a torque about the origin of frame 2, world axes.
pub fn on_child<S: Real>(evaluation: &Evaluation<'_, S>, joint: usize) -> [Vector3<S>; 2] {
    let mut all = [Vector3::zeros(); 2];
    visit(evaluation, &mut |acting| {
        if acting.joint == joint {
            let [force, torque] = acting.on_child();
            all[0] += force;
            all[1] += torque;
        }
    });
    all
}

/// Adds what acts along coordinates to a list of the force and the torque of every joint on its child, for the joints that `of` names.
pub fn add_on_children<S: Real>(
    evaluation: &Evaluation<'_, S>,
    of: impl Fn(usize) -> bool,
    out: &mut [S],
) {
    visit(evaluation, &mut |acting| {
        let own = out.get_mut(6 * acting.joint..6 * acting.joint + 6);
        if let (Some(own), true) = (own, of(acting.joint)) {
            let [force, torque] = acting.on_child();
            let both = force.iter().chain(&torque);
            own.iter_mut().zip(both).for_each(|(sum, &x)| *sum += x);
        }
    });
}
