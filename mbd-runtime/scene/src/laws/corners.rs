//! Where a prescribed motion changes from one of its parts to another: at `abs`, `min`, `max`, `clamp`, `if` and `floor` of time.
//!
//! ```text
//! side of |a|: a < 0     of min, max: a < b     of a choice: its condition     of ⌊a⌋: ⌊a⌋                         (1)
//! ```
//!
//! As long as no side changes, a formula of time is as smooth as sin, exp and powers are. Between two times at which a side differs it is bisected to
//! neighbouring numbers; whether value and rate go on there is for the caller to judge: `smoothstep` is such a formula, and has neither jump nor
//! corner. Derived.

use crate::laws::formula::{Context, scalar};
use crate::laws::ground::{self, at_time};
use crate::laws::numbers::Numbers;
use crate::{Formula, Function, Jet, Place, Scene};

/// What prescribes a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrescribedMotion {
    /// A motor: joint, number of the coordinate.
    Motor(usize, usize),
    /// A frame of the world.
    Frame(usize),
    /// The free length of a line.
    Line(usize),
}

/// A formula of time that prescribes a motion and has parts.
#[derive(Clone, Debug)]
pub struct CourseInParts {
    /// What it prescribes.
    pub of: PrescribedMotion,
    /// The formula.
    pub formula: Formula,
    /// Whether its rate may not jump: a joint would have to move bodies by an impulse.
    pub is_rigid: bool,
    /// What the formula is: `value`, or `rate` where that is told beside it.
    pub what: &'static str,
}

/// Every prescribed motion of time alone that has parts.
#[must_use]
pub fn in_parts(scene: &Scene) -> Vec<CourseInParts> {
    let mut all = Vec::new();
    let mut add = |of: PrescribedMotion, formula: &Formula, is_rigid: bool, what| {
        if scene.contains(formula, has_parts) && scene.is_of_time(formula) {
            let formula = formula.clone();
            all.push(CourseInParts {
                of,
                formula,
                is_rigid,
                what,
            });
        }
    };
    for (joint, declared) in scene.joints.iter().enumerate() {
        for (index, course) in declared.motors() {
            // Of a motor that is told its rate, too, that is what it follows.
            let told = match course {
                Formula::Vector(parts) => &parts[..parts.len().min(2)],
                course => std::slice::from_ref(course),
            };
            let has_rate = told.len() > 1;
            for (part, what) in told.iter().zip(["value", "rate"]) {
                add(PrescribedMotion::Motor(joint, index), part, !has_rate, what);
            }
        }
    }
    for (frame, declared) in scene.world_frames.iter().enumerate() {
        let place = Place::World(frame);
        let is_rigid = scene
            .joints
            .iter()
            .any(|joint| [joint.parent, joint.child].contains(&place));
        let rotation = declared.rotation.iter().flatten().flatten();
        for formula in declared.position.iter().chain(rotation) {
            add(PrescribedMotion::Frame(frame), formula, is_rigid, "value");
        }
    }
    for (line, declared) in scene.lines.iter().enumerate() {
        let (length, _) = declared.free_length_and_rate();
        add(PrescribedMotion::Line(line), length, false, "value");
    }
    all
}

fn has_parts(formula: &Formula) -> bool {
    use Function::{Abs, Floor, IfAtMost, IfLess, Max, Min};
    matches!(
        formula,
        Formula::Apply(Abs | Floor | IfAtMost | IfLess | Max | Min, _)
    )
}

impl CourseInParts {
    /// Value and rates at a time.
    #[must_use]
    pub fn at(&self, scene: &Scene, numbers: &Numbers<f64>, time: f64) -> Jet<f64> {
        ground::course(&self.formula, scene, numbers, time)
    }

    /// The first change of a side between two times: the last time before it, and the next number behind. `None` where no side differs.
    #[must_use]
    pub fn change(
        &self,
        (scene, numbers): (&Scene, &Numbers<f64>),
        [from, to]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let sides = |time: f64| {
            let mut sum = 0.0;
            let mut weight = 1.0;
            add_sides(&self.formula, &at_time(scene, numbers, time), &mut |side| {
                // Irrational weights keep sums of different sides apart.
                weight = 1.0 + weight * std::f64::consts::SQRT_2;
                sum += weight * side;
            });
            sum
        };
        let first = sides(from);
        if sides(to) == first {
            return None;
        }
        let (mut low, mut high) = (from, to);
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return Some([low, high]);
            }
            match sides(middle) == first {
                true => low = middle,
                false => high = middle,
            }
        }
    }
}

/// Hands out every side of (1).
fn add_sides(formula: &Formula, context: &impl Context<f64>, side: &mut impl FnMut(f64)) {
    match formula {
        Formula::Let(index) => {
            if let Some(named) = context.scene().lets.get(*index) {
                add_sides(&named.value, context, side);
            }
        }
        Formula::Vector(parts) | Formula::Component(parts, _) | Formula::Lookup(_, parts) => {
            parts.iter().for_each(|part| add_sides(part, context, side));
        }
        Formula::Apply(function, parts) => {
            parts.iter().for_each(|part| add_sides(part, context, side));
            let number = |index: usize| parts.get(index).map_or(0.0, |a| scalar(a, context));
            let truth = |holds: bool| f64::from(u8::from(holds));
            match function {
                Function::Abs => side(truth(number(0) < 0.0)),
                Function::Floor => side(number(0).floor()),
                Function::Min | Function::Max | Function::IfLess => {
                    side(truth(number(0) < number(1)));
                }
                Function::IfAtMost => side(truth(number(0) <= number(1))),
                _ => {}
            }
        }
        _ => {}
    }
}
