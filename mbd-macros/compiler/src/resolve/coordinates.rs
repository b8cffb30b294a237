//! Joint coordinates in expressions: `elbow.angle`, `elbow.angle_rate`.

use mbd_scene::Formula;

use super::{Named, Resolver, Typed};
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::syntax::expression::Step;

impl Resolver<'_> {
    /// A coordinate of a joint, or its rate.
    pub fn joint_quantity(
        &mut self,
        joint: usize,
        owner: &str,
        rest: &[Step],
        at: Region,
    ) -> Option<Typed> {
        if self.bad.contains(&Named::Joint(joint)) {
            return None;
        }
        let law = self.scene.joints.get(joint)?.law.clone();
        let measured: Vec<_> = law.measured().collect();
        let known: Vec<&str> = measured.iter().flat_map(|c| [c.name, c.rate]).collect();
        if known.is_empty() {
            return self.fail(say::no_coordinates(at, owner, law.keyword()));
        }
        let Some((step, after)) = rest.split_first() else {
            return self.fail(say::without_quantity(at, owner, "joint", &known));
        };
        let word = step.word.text.as_str();
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
