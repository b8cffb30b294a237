//! Gravity: the acceleration it gives and the energy it stores.
//!
//! ```text
//! uniform      a = g                                          U = −m g·r                                             (1)
//! point mass   a = −μ d/|d|³,  d = r − c                      U = μ m r·(r − 2c) / (|d| |c| (|d| + |c|))              (2)
//! oblate       a = −(μ/|d|³) { d [1 + k (1 − 5 σ²)] + 2 k |d| σ ẑ },  k = 3/2 J2 (R/|d|)²,  σ = ẑ·d/|d|               (3)
//!              U = (2) + μ m J2 R²/(2 |d|³) (3 σ² − 1)
//! ```
//!
//! U of (2) is measured from the world origin, −μ m (1/|d| − 1/|c|) without its cancellation: 1 ulp of μ m/|c| is 1e-6 J for a capsule on Mars. Where
//! the centre is at the origin, or near it beside what moves about it, as of an orbit, U = −μ m/|d|, which is zero far away.
//! The centre is an offset in local coordinates because planet-centred positions cost digits in every line (`2.8e-5 N` in a 60 kN/m riser).
//! At the centre itself (2) is singular and the result is not finite. μ is multiplied by 1/|d| time after time: in single precision |d|³ is no number from
//! 7e12 m on, and μ m none for a planet about the Sun; more divisions than one take a tenth of a step.

use nalgebra::Vector3;

use crate::laws::evaluation::Evaluation;
use crate::laws::formula::norm;
use crate::laws::numbers::GravityNumbers;
use crate::scalar::algebra::labelled;
use crate::{InputSource, Place, PointSlots, Real};

/// Acceleration at `r` [m/s²], world axes. A field supplied by the caller is `given`.
pub fn acceleration<S: Real>(
    gravity: &GravityNumbers<S>,
    r: &Vector3<S>,
    given: &Vector3<S>,
) -> Vector3<S> {
    match gravity {
        GravityNumbers::None => Vector3::zeros(),
        GravityNumbers::Uniform(g) => *g,
        GravityNumbers::Field => *given,
        GravityNumbers::Central {
            mu, center, oblate, ..
        } => {
            let d = labelled(r - center, ["d_x", "d_y", "d_z"]);
            let squared = d.dot(&d).label("d_squared");
            let distance = squared.sqrt().label("distance");
            let inverse = (S::one() / distance).label("inverse");
            let pull = (*mu * inverse * inverse * inverse).label("gravity");
            match oblate {
                None => d.map(|x| -(pull * x)),
                Some(planet) => {
                    let ratio = planet.radius / distance;
                    let k = S::from_f64(1.5) * planet.j2 * (ratio * ratio);
                    let height = planet.axis.dot(&d);
                    let sine = height / distance;
                    let along = S::one() + k * (S::one() - S::from_f64(5.0) * (sine * sine));
                    let polar = S::from_f64(2.0) * k * height;
                    (d.map(|x| along * x) + planet.axis.map(|x| polar * x)).map(|x| -(pull * x))
                }
            }
        }
    }
}

/// Potential energy of a mass at `r` [J]: zero at the world origin, about a centre that is near it zero far away; zero for a field supplied by the caller.
pub fn energy<S: Real>(gravity: &GravityNumbers<S>, mass: S, r: &Vector3<S>) -> S {
    match gravity {
        GravityNumbers::None | GravityNumbers::Field => S::zero(),
        GravityNumbers::Uniform(g) => -(mass * g.dot(r)),
        GravityNumbers::Central {
            mu,
            center,
            from_far,
            oblate,
        } => {
            let d = r - center;
            let distance = norm(&d);
            let depth = mass * (*mu / distance);
            let sphere = if *from_far {
                -depth
            } else {
                let offset = norm(center);
                let rise = r.dot(&(r - center.map(|x| S::from_f64(2.0) * x)));
                depth * (rise / (offset * (distance + offset)))
            };
            match oblate {
                None => sphere,
                Some(planet) => {
                    let sine = planet.axis.dot(&d) / distance;
                    let ratio = planet.radius / distance;
                    let bulge = planet.j2
                        * (ratio * ratio)
                        * S::from_f64(0.5)
                        * (S::from_f64(3.0) * (sine * sine) - S::one());
                    sphere + depth * bulge
                }
            }
        }
    }
}

/// Gravity at a body [m/s²].
pub fn body_gravity<S: Real>(evaluation: &Evaluation<'_, S>, body: usize) -> Vector3<S> {
    let given = evaluation.input(InputSource::BodyGravity(body), 0);
    let position = evaluation.in_world(evaluation.motions[body].position);
    acceleration(&evaluation.numbers.gravity, &position, &given)
}

/// Gravity at a body or a point with mass [m/s²]; zero elsewhere.
pub fn at<S: Real>(evaluation: &Evaluation<'_, S>, place: Place) -> Vector3<S> {
    match place {
        Place::Body(body, _) => body_gravity(evaluation, body),
        Place::Point(point) => match evaluation.layout.points.get(point) {
            Some(PointSlots::Mass(slots)) => point_gravity(evaluation, point, slots.q),
            _ => Vector3::zeros(),
        },
        Place::World(_) => Vector3::zeros(),
    }
}

/// Gravity at a point with mass [m/s²].
pub fn point_gravity<S: Real>(
    evaluation: &Evaluation<'_, S>,
    point: usize,
    q: usize,
) -> Vector3<S> {
    let given = evaluation.input(InputSource::PointGravity(point), 0);
    let position = evaluation.layout.directions.linear(evaluation.at.state, q);
    let position = evaluation.in_world(position);
    acceleration(&evaluation.numbers.gravity, &position, &given)
}
