//! Joints in expressions: `elbow.angle`, `elbow.angle_rate`, `elbow.angle_acceleration`, `elbow.motor_torque`, `elbow.force`.

use mbd_scene::Formula;
use mbd_scene::joints::Measured;

use super::{MayDependOn, Named, ResolvedSoFar, Resolver, Scope, Typed};
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::syntax::expression::{self, PathStep};
use crate::syntax::{ValueSyntax, quantities};
use crate::units;

impl Resolver<'_> {
    /// The coordinate that a joint of this kind couples: joint and number of the coordinate.
    pub fn coupled_coordinate(
        &mut self,
        value: ValueSyntax<'_>,
        keyword: &str,
        scope: Scope<'_>,
    ) -> Option<(usize, usize)> {
        let steps = match expression::path(value) {
            Ok(steps) => steps,
            Err(report) => return self.fail(report),
        };
        let (first, rest) = steps.split_first()?;
        let word = first.word.text.as_str();
        if word == "world" {
            return self.fail(say::coordinate_wanted(value.at, keyword, word, "place"));
        }
        let Some(entry) = self.names.get(word).cloned() else {
            let known = self.names.words_of(|n| matches!(n, Named::Joint(_)));
            let report = say::no_joint_to_couple(value.at, keyword, word, &known);
            return self.fail_unless_broken(word, report);
        };
        if self.broken.contains(word) {
            return None;
        }
        let named = self.member(&entry, first, scope)?;
        self.mention(named, first.word.at);
        let Named::Joint(joint) = named else {
            return self.fail(say::coordinate_wanted(
                value.at,
                keyword,
                word,
                named.kind(),
            ));
        };
        let law = &self.scene.joints.get(joint)?.law;
        if law.measured().next().is_none() && !self.bad.contains(&named) {
            let report = say::nothing_to_couple(value.at, word, law.keyword());
            return self.fail(report);
        }
        // A joint alone is its only coordinate.
        if rest.is_empty() && law.measured().count() == 1 && !self.bad.contains(&named) {
            return Some((joint, 0));
        }
        let scope = Scope {
            stage: MayDependOn::Live,
            ..scope
        };
        let typed = self.joint_quantity(joint, word, rest, value.at, scope)?;
        match typed.formula {
            Formula::Coordinate(joint, index) => Some((joint, index)),
            _ => self.fail(say::coordinate_not_rate(value.at, keyword)),
        }
    }

    /// What the lock of a coordinate puts on the child, `pin.angle.lock.torque`: nothing while it is free. The lock is made where it is named first, and
    /// an event has to close it.
    fn lock_quantity(
        &mut self,
        (joint, index): (usize, usize),
        rest: &[PathStep],
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        let (owner, coordinate) = self.scene.coordinate(joint, index)?;
        let owner = format!("{}.{}.lock", owner.name, coordinate.name);
        let known = quantities::JOINT_QUANTITIES;
        let Some((step, after)) = rest.split_first() else {
            return self.fail(say::without_quantity(at, &owner, "lock", known));
        };
        let reaction: (fn(usize) -> Formula, _) = match step.word.text.as_str() {
            "force" => (Formula::ReactionForce, units::FORCE),
            "torque" => (Formula::ReactionTorque, units::TORQUE),
            word => {
                let report = say::unknown_quantity(step.word.at.into(), &owner, word, known);
                return self.fail(report);
            }
        };
        self.follows(scope, step, &owner)?;
        let lock = self.lock_of(joint, index, at);
        self.asked_of_locks.push((lock, at));
        let (formula, dimension) = reaction;
        self.tail(Typed::of(formula(lock), true, dimension, at), after)
    }

    /// A coordinate of a joint, its rates, or what the joint and its motor do.
    pub fn joint_quantity(
        &mut self,
        joint: usize,
        owner: &str,
        rest: &[PathStep],
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        if self.bad.contains(&Named::Joint(joint)) {
            return None;
        }
        if self.in_let() && self.known < ResolvedSoFar::Joints {
            return self.not_yet(owner);
        }
        let declared = self.scene.joints.get(joint)?;
        let law = declared.law.clone();
        let driven: Vec<usize> = declared.motors().map(|(index, _)| index).collect();
        let measured: Vec<_> = law.measured().collect();
        let motors: Vec<String> = measured.iter().map(|c| law.motor_word(c)).collect();
        let driving = driven.iter().filter_map(|&index| motors.get(index));
        let filters = declared.forces.iter().filter_map(|forces| {
            let (filter, coordinate) = (forces.filter.as_ref()?, measured.get(forces.coordinate)?);
            Some((filter.state, law.command_word(coordinate)))
        });
        let commands: Vec<(usize, String)> = filters
            .flat_map(|(state, word)| [(state + 1, format!("{word}_rate")), (state, word)])
            .collect();
        let second = |name: &str| format!("{name}_acceleration");
        let seconds: Vec<String> = measured.iter().map(|c| second(c.name)).collect();
        let known: Vec<&str> = measured
            .iter()
            .flat_map(|c| [c.name, c.rate])
            .chain(seconds.iter().map(String::as_str))
            .chain(driving.map(String::as_str))
            .chain(commands.iter().map(|(_, word)| word.as_str()))
            .chain(quantities::JOINT_QUANTITIES.iter().copied())
            .collect();
        let Some((step, after)) = rest.split_first() else {
            return self.fail(say::without_quantity(at, owner, "joint", &known));
        };
        if measured.is_empty() && !quantities::JOINT_QUANTITIES.contains(&step.word.text.as_str()) {
            return self.fail(say::no_coordinates(at, owner, law.keyword()));
        }
        let word = step.word.text.as_str();
        if word == "lock" {
            let (Some(coordinate), Some(declared)) =
                (measured.first(), self.scene.joints.get(joint))
            else {
                return None;
            };
            let asked = after
                .first()
                .map_or("torque", |step| step.word.text.as_str());
            let report =
                say::lock_of_a_joint(step.word.at.into(), &declared.name, coordinate.name, asked);
            return self.fail(report);
        }
        let held = measured.iter().position(|c| c.name == word);
        if let (Some(index), Some(("lock", what))) = (
            held,
            after
                .split_first()
                .map(|(step, what)| (step.word.text.as_str(), what)),
        ) {
            return self.lock_quantity((joint, index), what, at, scope);
        }
        let reaction = match word {
            "force" => Some((Formula::ReactionForce(joint), units::FORCE)),
            "torque" => Some((Formula::ReactionTorque(joint), units::TORQUE)),
            _ => None,
        };
        if let Some((formula, dimension)) = reaction {
            self.follows(scope, step, owner)?;
            return self.tail(Typed::of(formula, true, dimension, at), after);
        }
        if let Some(index) = seconds.iter().position(|second| second == word) {
            self.follows(scope, step, owner)?;
            let is_angle = measured.get(index)?.is_angle();
            let dimension = match is_angle {
                true => units::ANGULAR_ACCELERATION,
                false => units::ACCELERATION,
            };
            let formula = Formula::CoordinateAcceleration(joint, index);
            let second = Typed {
                angle: i8::from(is_angle),
                ..Typed::of(formula, false, dimension, at)
            };
            return self.tail(second, after);
        }
        if self.in_let() && self.known < ResolvedSoFar::Motors && word.contains("command") {
            return self.not_yet(&format!("{owner}.{word}"));
        }
        if let Some((state, _)) = commands.iter().find(|(_, command)| command == word) {
            let dimension = self.scene.states.get(*state)?.unit.dimension;
            let angle = i8::from(self.scene.states.get(*state)?.unit.text.starts_with("rad"));
            let command = Typed {
                angle,
                ..Typed::of(Formula::State(*state), false, dimension, at)
            };
            return self.tail(command, after);
        }
        if let Some(index) = motors.iter().position(|motor| motor == word) {
            let here = step.word.at.into();
            let coordinate = measured.get(index)?;
            if self.in_let() && self.known < ResolvedSoFar::Motors {
                return self.not_yet(&format!("{owner}.{word}"));
            }
            if !driven.contains(&index) {
                return self.fail(say::no_motor(here, owner, coordinate));
            }
            if scope.stage != MayDependOn::Result {
                return self.fail(say::motor_as_cause(here, owner, word));
            }
            let formula = Formula::MotorEffort(joint, index);
            let dimension = Measured::Force.of(coordinate);
            return self.tail(Typed::of(formula, false, dimension, at), after);
        }
        let found = measured.iter().zip(0..).find_map(|(c, index)| {
            let value = (Formula::Coordinate(joint, index), c.dimension());
            let rate = (Formula::CoordinateRate(joint, index), c.rate_dimension());
            let pair = match word {
                _ if word == c.name => value,
                _ if word == c.rate => rate,
                _ => return None,
            };
            Some((pair, i8::from(c.is_angle())))
        });
        let Some(((formula, dimension), angle)) = found else {
            let report = say::unknown_quantity(step.word.at.into(), owner, word, &known);
            return self.fail(report);
        };
        let typed = Typed {
            angle,
            ..Typed::of(formula, false, dimension, at)
        };
        self.tail(typed, after)
    }
}
