//! Frames of the world that move as declared: pose, velocity and acceleration from their formulas of time.
//!
//! ```text
//! p(t), ṗ, p̈;   ω = ½ Σ c_i × ċ_i,   α = ½ Σ c_i × c̈_i          c_i the columns of R(t)                          (1)
//! ```
//!
//! With Ṙ = ω̃ R and R̈ = (α̃ + ω̃²) R, (1) takes the skew parts of Ṙ Rᵀ and R̈ Rᵀ. Derived.

use nalgebra::{Matrix3, Vector3};

use crate::laws::formula::{Context, Value, of_let, scalar, triple};
use crate::laws::numbers::Numbers;
use crate::scalar::{OfTime, split};
use crate::{Formula, Frame, FrameMotion, Jet, Real, Scene};

/// What a prescribed motion may depend on: time, consts and params.
struct GroundMotion<'a, S: Real> {
    scene: &'a Scene,
    params: &'a [S],
    time: S,
}

/// The leaves of a formula of time, at a time.
pub fn at_time<'a>(
    scene: &'a Scene,
    numbers: &'a Numbers<f64>,
    time: f64,
) -> impl Context<f64> + 'a {
    with_params(scene, &numbers.params, time)
}

/// The same for params, at a time of any scalar: a number, or all times of a span.
pub fn with_params<'a, S: Real>(
    scene: &'a Scene,
    params: &'a [f64],
    time: S,
) -> impl Context<S> + 'a {
    with_states(scene, params, time, |_| None)
}

/// The same where declared states are known, by number.
pub fn with_states<'a, S: Real>(
    scene: &'a Scene,
    params: &'a [f64],
    time: S,
    states: impl Fn(usize) -> Option<S> + 'a,
) -> impl Context<S> + 'a {
    AtTime {
        scene,
        params,
        time,
        states,
    }
}

/// The same without the derivatives of a motion.
struct AtTime<'a, S, F> {
    scene: &'a Scene,
    params: &'a [f64],
    time: S,
    states: F,
}

impl<S: Real, F: Fn(usize) -> Option<S>> Context<S> for AtTime<'_, S, F> {
    fn scene(&self) -> &Scene {
        self.scene
    }

    fn param(&self, index: usize) -> Option<S> {
        self.params.get(index).copied().map(S::from_f64)
    }

    fn named(&self, index: usize) -> Option<Value<S>> {
        of_let(index, self)
    }

    fn state(&self, index: usize) -> Option<S> {
        (self.states)(index)
    }

    fn time(&self) -> Option<S> {
        Some(self.time)
    }
}

impl<S: Real> Context<OfTime<S>> for GroundMotion<'_, S> {
    fn scene(&self) -> &Scene {
        self.scene
    }

    fn param(&self, index: usize) -> Option<OfTime<S>> {
        self.params.get(index).copied().map(OfTime::still)
    }

    fn named(&self, index: usize) -> Option<Value<OfTime<S>>> {
        of_let(index, self)
    }

    fn time(&self) -> Option<OfTime<S>> {
        Some(OfTime::time(self.time))
    }
}

/// A formula of time with its two derivatives.
pub fn course<S: Real>(formula: &Formula, scene: &Scene, numbers: &Numbers<S>, time: S) -> Jet<S> {
    let params = &numbers.params;
    let course = GroundMotion {
        scene,
        params,
        time,
    };
    scalar(formula, &course).into()
}

/// The frames of the world that move, at a time; `None` where one does not.
pub fn ground<S: Real>(
    scene: &Scene,
    numbers: &Numbers<S>,
    time: S,
    out: &mut Vec<Option<FrameMotion<S>>>,
) {
    let params = &numbers.params;
    let course = GroundMotion {
        scene,
        params,
        time,
    };
    out.clear();
    let moves = |frame: &Frame| frame.moves(scene).then(|| motion(frame, &course));
    out.extend(scene.world_frames.iter().map(moves));
}

fn motion<S: Real>(frame: &Frame, course: &GroundMotion<'_, S>) -> FrameMotion<S> {
    S::section(&frame.name);
    let [position, velocity, acceleration] = split(&triple(&frame.position, course));
    let mut motion = FrameMotion {
        position,
        rotation: None,
        velocity,
        omega: Vector3::zeros(),
        acceleration,
        alpha: Vector3::zeros(),
    };
    if let Some(rows) = &frame.rotation {
        let rows = rows
            .each_ref()
            .map(|row| split(&triple(row, course)).map(|part| part.transpose()));
        let [pose, rate, curve] =
            [0, 1, 2].map(|part| Matrix3::from_rows(&rows.each_ref().map(|row| row[part])));
        motion.rotation = Some(pose);
        motion.omega = skew(&pose, &rate);
        motion.alpha = skew(&pose, &curve);
    }
    motion
}

/// ½ Σ c_i × ċ_i.
fn skew<S: Real>(pose: &Matrix3<S>, rate: &Matrix3<S>) -> Vector3<S> {
    let half = S::from_f64(0.5);
    let columns = pose.column_iter().zip(rate.column_iter());
    columns
        .fold(Vector3::zeros(), |sum: Vector3<S>, (c, d)| {
            sum + c.cross(&d)
        })
        .map(|x| half * x)
}
