//! Prescribed motions must tell one motion: motors whose value, rate and acceleration are told, lines whose free length and its rate are, and
//! whatever is a function of time with parts; and no line is wound in beyond its end.
//!
//! ```text
//! |x₁ − x₀ − h (ẋ₀ + ẋ₁)/2| ≤ 0.1 max(|x₁ − x₀|, h |ẋ|, h² |ẍ|)          over a step h; the same for ẋ and ẍ, ẍ         (1)
//! |dx/dt − ẋ| ≤ 1e-3 max(|dx/dt|, |ẋ|, h |ẍ|)                            at the end of a step; the same for ẋ and ẍ    (2)
//! x, ẋ the same on both sides of where a function of time goes over to another of its parts                            (3)
//! L0 ≥ 0                                                                 of every line that is wound and attached      (4)
//! ```
//!
//! Of what has no inputs and no tables in it dx/dt is known: (2). Of the rest (1): a smooth command of which a step sees a sixth of a period or less
//! satisfies it: the trapezoid is off by h³ x‴/12. With h = 0 it says that neither value nor rate may jump when inputs change or an event acts. What
//! breaks it would be put right by the projection, without a word: bodies would be carried where the joints allow, and the accelerations would be
//! those of another motion. Of a line it would be in no balance: a winch does the work −T L̇0 with the rate that is told. Nobody tells the
//! acceleration of a line; in (1) it is the difference of the rates over the step. A rate that is wrong by less than a tenth, or in (2) by a
//! thousandth, is not seen. (3): of a line, and of a frame at which no joint ends, the rate may jump, its force follows.

use mbd_scene::laws::Numbers;
use mbd_scene::laws::corners::{CourseInParts, PrescribedMotion, in_parts};
use mbd_scene::{Float, Line, Scene, ToldMotion};

use crate::columns::line_name;
use crate::error::StepError;

/// How far the two sides of (1) may differ [1], and those of (2).
const SHARE: f64 = 0.1;
const EXACT: f64 = 1e-3;
/// How far both sides of (3) may differ, of the change over the step, and of the number itself.
const JUMP: f64 = 1e-6;
const ROUNDED: f64 = 1e-7;
/// How many numbers away from a change of parts both sides are compared.
const NEAR: f64 = 4.0;
/// How often a step is looked at for (3), and how many changes of parts between two looks.
const LOOKS: usize = 8;
const CHANGES: usize = 16;
/// How far a free length may lie below zero [m]: an event at which a winch stops lies a little beyond it.
const USED_UP: f64 = 1e-6;

/// What is prescribed, and what was told at the last accepted step, with room for the next.
#[derive(Clone, Debug)]
pub(crate) struct Commands {
    /// Of each motor, then each line that is told its rate: whether the rates of value and rate are known.
    known: Vec<[bool; 2]>,
    in_parts: Vec<CourseInParts>,
    /// The lines that are wound.
    wound: Vec<usize>,
    pub last: Vec<ToldMotion>,
    pub now: Vec<ToldMotion>,
}

impl Commands {
    /// Room for a scene; `None` where nothing is told, nothing has parts and no line is wound.
    pub(crate) fn new(scene: &Scene) -> Option<Self> {
        let motors = scene.commanded().map(|(_, parts)| parts);
        let all = motors.chain(scene.commanded_lines().map(|(_, parts)| parts));
        let known = all.map(|parts| {
            [0, 1].map(|order| {
                let part = parts.get(order).filter(|_| order + 1 < parts.len());
                part.is_some_and(|part| scene.tells_rate(part))
            })
        });
        let known: Vec<[bool; 2]> = known.collect();
        let (in_parts, count) = (in_parts(scene), known.len());
        let lines = scene.lines.iter().enumerate();
        let wound = lines.filter(|(_, line)| line.is_wound(scene));
        let wound: Vec<usize> = wound.map(|(index, _)| index).collect();
        (count > 0 || !in_parts.is_empty() || !wound.is_empty()).then(|| Commands {
            known,
            in_parts,
            wound,
            last: Vec::with_capacity(count),
            now: Vec::with_capacity(count),
        })
    }

    /// Whether any motion is told with its rates, or a function of time with parts.
    pub(crate) fn are_prescribed(&self) -> bool {
        !self.known.is_empty() || !self.in_parts.is_empty()
    }

    /// Looks at every line that is wound, by (4); `is_attached` of the number of a line, `length` its free length [m].
    pub(crate) fn check_lengths(
        &self,
        (scene, time): (&Scene, f64),
        is_attached: impl Fn(usize) -> bool,
        length: impl Fn(&Line) -> f64,
    ) -> Result<(), StepError> {
        let wound = self.wound.iter().filter(|line| is_attached(**line));
        for line in wound.filter_map(|line| scene.lines.get(*line)) {
            let length = length(line);
            if length < -USED_UP {
                return Err(StepError::NegativeLength {
                    line: line.name.clone(),
                    time,
                    length,
                });
            }
        }
        Ok(())
    }

    /// Whether what is commanded now goes on from the last step, `span` before [s].
    pub(crate) fn check<T: Float>(
        &self,
        (scene, numbers): (&Scene, &Numbers<f64>),
        (time, span): (f64, f64),
    ) -> Result<(), StepError> {
        self.check_parts((scene, numbers), (time, span))?;
        let pairs = self.last.iter().zip(&self.now);
        let mut pairs = pairs.zip(&self.known);
        let told = |what, [change, expected]: [f64; 2], motor: String| StepError::Command {
            motor,
            time,
            what,
            change,
            expected,
        };
        for (([joint, index], _), ((last, now), known)) in scene.commanded().zip(pairs.by_ref()) {
            let motor = || motor_name(scene, [joint, index]);
            for (order, word) in ["value", "rate"].into_iter().enumerate() {
                let found = match known[order] && span > 0.0 {
                    true => untrue::<T>(now, order, span),
                    false => contradiction::<T>(&last.told[order..], &now.told[order..], span),
                };
                if let Some(changes) = found {
                    return Err(told(word, changes, motor()));
                }
            }
        }
        for ((line, _), ((last, now), known)) in scene.commanded_lines().zip(pairs) {
            let curve = match span > 0.0 {
                true => (now.told[1] - last.told[1]) / span,
                false => 0.0,
            };
            let [last, now] = [last, now].map(|own| ToldMotion {
                told: [own.told[0], own.told[1], curve],
                ..*own
            });
            let found = match known[0] && span > 0.0 {
                true => untrue::<T>(&now, 0, span),
                false => contradiction::<T>(&last.told, &now.told, span),
            };
            if let Some(changes) = found {
                let name = format!("{}.free_length", line_name(scene, line));
                return Err(told("value", changes, name));
            }
        }
        Ok(())
    }

    /// Whether functions of time go on where they go over from one part to another, by (3).
    pub(crate) fn check_parts(
        &self,
        (scene, numbers): (&Scene, &Numbers<f64>),
        (time, span): (f64, f64),
    ) -> Result<(), StepError> {
        if span.is_nan() || span <= 0.0 {
            return Ok(());
        }
        for course in &self.in_parts {
            let ends = [time - span, time].map(|at| course.at(scene, numbers, at));
            let look = |number: usize| time - span * (1.0 - number as f64 / LOOKS as f64);
            for number in 0..LOOKS {
                let [mut from, to] = [look(number), look(number + 1)];
                for _ in 0..CHANGES {
                    let Some(sides) = course.change((scene, numbers), [from, to]) else {
                        break;
                    };
                    // Where both sides are equal the rate may be that of either.
                    let off = NEAR * (sides[1] - sides[0]);
                    let around = [sides[0] - off, sides[1] + off];
                    let gap = around[1] - around[0];
                    let around = around.map(|at| course.at(scene, numbers, at));
                    let sizes = |of: &dyn Fn(&mbd_scene::Jet<f64>) -> f64| {
                        let all = ends.iter().chain(&around).map(|jet| of(jet).abs());
                        all.fold(0.0, f64::max)
                    };
                    let [value, rate, curve] = [
                        sizes(&|jet| jet.value),
                        sizes(&|jet| jet.rate),
                        sizes(&|jet| jet.curve),
                    ];
                    let moved = (ends[1].value - ends[0].value).abs();
                    let [before, after] = around;
                    let jump = after.value - before.value;
                    let what = |what, change| StepError::Jump {
                        of: prescribed_name(scene, course.of),
                        what,
                        change,
                        unit: prescribed_unit(scene, course.of, what == "rate"),
                        time: sides[1],
                    };
                    if jump.abs() > JUMP * moved + ROUNDED * value + 8.0 * gap * rate {
                        return Err(what(course.what, jump));
                    }
                    let jump = after.rate - before.rate;
                    if course.is_rigid && jump.abs() > ROUNDED * rate + 8.0 * gap * curve {
                        return Err(what("rate", jump));
                    }
                    from = sides[1];
                }
            }
        }
        Ok(())
    }
}

/// A coordinate that a motor drives, as a message calls it.
fn motor_name(scene: &Scene, [joint, index]: [usize; 2]) -> String {
    match scene.coordinate(joint, index) {
        Some((joint, coordinate)) => format!("{}.{}", joint.name, coordinate.name),
        None => String::new(),
    }
}

fn prescribed_name(scene: &Scene, of: PrescribedMotion) -> String {
    match of {
        PrescribedMotion::Motor(joint, index) => motor_name(scene, [joint, index]),
        PrescribedMotion::Frame(frame) => {
            let frame = scene.world_frames.get(frame);
            frame.map_or_else(String::new, |frame| format!("world.{}", frame.name))
        }
        PrescribedMotion::Line(line) => format!("{}.free_length", line_name(scene, line)),
    }
}

/// The unit of a prescribed motion, or of its rate.
fn prescribed_unit(scene: &Scene, of: PrescribedMotion, is_rate: bool) -> &'static str {
    let is_angle = match of {
        PrescribedMotion::Motor(joint, index) => {
            let found = scene.coordinate(joint, index);
            found.is_some_and(|(_, coordinate)| coordinate.is_angle())
        }
        PrescribedMotion::Line(_) => false,
        // A place or an element of a matrix.
        PrescribedMotion::Frame(_) => return "",
    };
    match (is_angle, is_rate) {
        (true, false) => "rad",
        (true, true) => "rad/s",
        (false, false) => "m",
        (false, true) => "m/s",
    }
}

/// The change of a number over the last step as it follows and as its rate tells it, where (2) does not hold.
fn untrue<T: Float>(now: &ToldMotion, order: usize, span: f64) -> Option<[f64; 2]> {
    let (told, follows) = (now.told[order + 1], now.follows[order]);
    let bend = now.told.get(order + 2).map_or(0.0, |next| next * span);
    let size = told.abs().max(follows.abs()).max(bend.abs());
    let rounding = 64.0 * T::EPSILON.to_f64() * now.told[order].abs() / span;
    let wrong = (follows - told).abs() > (EXACT * size).max(rounding);
    wrong.then_some([follows * span, told * span])
}

/// The change of a number over a step and that which its rate tells, where (1) does not hold. `last` and `now`: the number and its rates.
fn contradiction<T: Float>(last: &[f64], now: &[f64], span: f64) -> Option<[f64; 2]> {
    let ([before, rate_before, ..], [after, rate_after, ..]) = (last, now) else {
        return None;
    };
    let (change, expected) = (after - before, 0.5 * span * (rate_before + rate_after));
    let sizes = last.iter().zip(now).enumerate();
    let sizes = sizes.map(|(k, (last, now))| match k {
        0 => change.abs(),
        k => span.powi(k as i32) * last.abs().max(now.abs()),
    });
    let rounding = 64.0 * T::EPSILON.to_f64() * before.abs().max(after.abs());
    let allowed = match span > 0.0 {
        true => SHARE * sizes.fold(0.0, f64::max),
        false => 0.0,
    };
    ((change - expected).abs() > allowed.max(rounding)).then_some([change, expected])
}
