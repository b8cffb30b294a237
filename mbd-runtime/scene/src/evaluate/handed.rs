//! What an event hands to the scene that goes on from it.

use nalgebra::{Matrix3, Vector3};

use super::Scratch;
use crate::laws::body::{Attitude, attitude_of};
use crate::laws::evaluation::Evaluation;
use crate::laws::formula::{self, Context};
use crate::laws::numbers::Numbers;
use crate::laws::turns::next_to;
use crate::{AngularVelocity, At, Directions, Layout, MapSource, Place, Scene};

/// How something of the next scene begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Handed {
    /// At a place and moving with it.
    Motion {
        /// Its position from the origin of positions, world axes [m].
        position: Vector3<f64>,
        /// The axes of its frame as columns, world components; `None` of a point.
        axes: Option<Matrix3<f64>>,
        /// Its velocity against that origin, world axes [m/s].
        velocity: Vector3<f64>,
        /// Angular velocity of the body it is on, world axes [rad/s]; zero of a point.
        omega: Vector3<f64>,
        /// In a plane the angle of its axes, turns counted [rad]; `None` where nothing counts them.
        angle: Option<f64>,
    },
    /// With a number [SI].
    Number(f64),
}

/// Appends what the map of an event hands on, in its order, from what was just before the instant. A place that is nowhere is not a number.
pub fn handed(
    event: usize,
    (scene, layout): (&Scene, &Layout),
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    out: &mut Vec<Handed>,
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    let next = scene
        .events
        .get(event)
        .and_then(|it| it.actions.next.as_ref());
    let unknown = || Vector3::repeat(f64::NAN);
    let map = next.into_iter().flat_map(|next| &next.map);
    out.extend(map.map(|mapped| match &mapped.from {
        MapSource::Value { value, .. } => Handed::Number(formula::scalar(value, &evaluation)),
        MapSource::Place(place) => {
            let column = |axis| evaluation.axis(*place, axis);
            let columns = [column(0), column(1), column(2)];
            let omega = match place {
                Place::Body(body, _) => evaluation.omega_world(*body),
                _ => Some(Vector3::zeros()),
            };
            Handed::Motion {
                angle: counted(&evaluation, *place),
                position: evaluation.position_of(*place).unwrap_or_else(unknown),
                velocity: evaluation.velocity_of(*place).unwrap_or_else(unknown),
                omega: omega.unwrap_or_else(unknown),
                axes: match columns {
                    [Some(x), Some(y), Some(z)] => Some(Matrix3::from_columns(&[x, y, z])),
                    _ => None,
                },
            }
        }
    }));
}

/// The angle of a frame of a body in a plane, with the turns of the body.
fn counted(evaluation: &Evaluation<'_, f64>, place: Place) -> Option<f64> {
    let (Place::Body(body, frame), Some(plane)) = (place, evaluation.layout.directions.plane)
    else {
        return None;
    };
    let Attitude::Angle(angle) = evaluation.motions.get(body)?.attitude else {
        return None;
    };
    let frame = evaluation.numbers.bodies.get(body)?.frames.get(frame)?;
    let own = frame
        .rotation
        .map_or(0.0, |rotation| plane.angle(&rotation));
    Some(angle + own)
}

impl Handed {
    /// The numbers of a body that moves so, as in the state of absolute coordinates: position, attitude, velocity, angular velocity. `None` where it
    /// has no axes.
    #[must_use]
    pub fn of_body(&self, directions: Directions, components: AngularVelocity) -> Option<Vec<f64>> {
        let Handed::Motion {
            position,
            axes: Some(axes),
            velocity,
            omega,
            angle,
        } = self
        else {
            return None;
        };
        let omega = match (directions.plane, components) {
            (None, AngularVelocity::Body) => axes.transpose() * omega,
            _ => *omega,
        };
        let mut list = vec![0.0; directions.motion()];
        directions.write_linear(&mut list, 0, position);
        let attitude = list.iter_mut().skip(directions.translations().len());
        let numbers = attitude_of(axes, directions);
        for (slot, number) in attitude.zip(numbers) {
            *slot = angle.map_or(number, |angle| next_to(number, angle));
        }
        directions.write_linear(&mut list, directions.coordinates(), velocity);
        directions.write_angular(&mut list, directions.coordinates(), &omega);
        Some(list)
    }

    /// The numbers of a point that moves so: position and velocity. `None` of a number.
    #[must_use]
    pub fn of_point(&self, directions: Directions) -> Option<Vec<f64>> {
        let Handed::Motion {
            position, velocity, ..
        } = self
        else {
            return None;
        };
        let moves = directions.translations().len();
        let mut list = vec![0.0; 2 * moves];
        directions.write_linear(&mut list, 0, position);
        directions.write_linear(&mut list, moves, velocity);
        Some(list)
    }
}
