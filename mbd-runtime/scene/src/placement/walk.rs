//! Parts placed along the tree, by (1) and (2) of [`super`].

use nalgebra::{Matrix3, Vector3};

use super::Placement;
use super::tree::PlacingJoint;
use crate::laws::body::{Attitude, BodyMotion, attitude_of};
use crate::laws::turns::next_to;
use crate::{AngularVelocity, Part, Place, PointSlots, Relative, Twist};

/// Position, axes, velocity and angular velocity of a part or a frame, world axes.
#[derive(Clone, Copy)]
struct MovingFrame {
    position: Vector3<f64>,
    axes: Matrix3<f64>,
    velocity: Vector3<f64>,
    omega: Vector3<f64>,
    /// In a planar scene the angle of what it is of, turns counted.
    angle: f64,
}

impl Placement<'_> {
    /// Places every part of the tree by (1) and (2).
    pub(super) fn walk(&self, state: &mut [f64]) {
        for link in &self.links {
            let Some(moving) = self.placed(link, state) else {
                continue;
            };
            let directions = self.layout.directions;
            let slots = self.layout.own_slots(link.to);
            let Some(slots) = slots else { continue };
            let v = self.layout.nq + slots.v;
            directions.write_linear(state, slots.q, &moving.position);
            directions.write_linear(state, v, &moving.velocity);
            if let Part::Body(_) = link.to {
                let attitude = attitude_of(&moving.axes, directions);
                let at = slots.q + directions.translations().len();
                for (slot, value) in state.iter_mut().skip(at).zip(attitude) {
                    *slot = match directions.plane {
                        Some(_) => next_to(value, moving.angle),
                        None => value,
                    };
                }
                let omega = match self.scene.angular_velocity {
                    AngularVelocity::Body => moving.axes.transpose() * moving.omega,
                    AngularVelocity::World => moving.omega,
                };
                directions.write_angular(state, v, &omega);
            }
        }
    }

    /// Where a link puts the part it places.
    fn placed(&self, link: &PlacingJoint, state: &[f64]) -> Option<MovingFrame> {
        let joint = self.scene.joints.get(link.joint)?;
        let at = Relative {
            q: &self.q[link.joint],
            u: &self.u[link.joint],
            numbers: self.numbers.joints.get(link.joint)?,
        };
        let pose = joint.law.motion(&at);
        let mut columns = vec![Twist::zero(); joint.law.freedoms()];
        joint.law.subspace(&at, &mut columns);
        let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
        for (column, u) in columns.iter().zip(at.u) {
            linear += column.linear * *u;
            angular += column.angular * *u;
        }
        let (near, far) = match link.to_parent {
            true => (joint.child, joint.parent),
            false => (joint.parent, joint.child),
        };
        let from = self.frame(near, state)?;
        let (point, own) = self.place_of(far)?;
        let angle = self.angle(link, (&from, near), (&at, &own), &columns);
        let frame = if link.to_parent {
            let axes = from.axes * pose.rotation.transpose();
            let omega = from.omega - axes * angular;
            let arm = axes * pose.position;
            MovingFrame {
                position: from.position - arm,
                axes,
                velocity: from.velocity - omega.cross(&arm) - axes * linear,
                omega,
                angle,
            }
        } else {
            let arm = from.axes * pose.position;
            MovingFrame {
                position: from.position + arm,
                axes: from.axes * pose.rotation,
                velocity: from.velocity + from.omega.cross(&arm) + from.axes * linear,
                omega: from.omega + from.axes * angular,
                angle,
            }
        };
        let axes = match link.to {
            Part::Body(_) => frame.axes * own.transpose(),
            _ => Matrix3::identity(),
        };
        let arm = axes * point;
        Some(MovingFrame {
            position: frame.position - arm,
            axes,
            velocity: frame.velocity - frame.omega.cross(&arm),
            omega: frame.omega,
            angle,
        })
    }

    /// In a planar scene the angle of the part that a link places: that of what it hangs on, how it hangs there with all coordinates at zero, and the
    /// angles that its joint says, turns among them, as the links of a tree count it.
    fn angle(
        &self,
        link: &PlacingJoint,
        (from, near): (&MovingFrame, Place),
        (at, own): (&Relative<'_, f64>, &Matrix3<f64>),
        columns: &[Twist<f64>],
    ) -> f64 {
        let joint = self.scene.joints.get(link.joint);
        let (Some(plane), Some(joint)) = (self.layout.directions.plane, joint) else {
            return 0.0;
        };
        let zero = [0.0; 6];
        let hangs = match joint.law.attitude() {
            Some(_) => joint.law.motion(at).rotation,
            None => {
                let q = &zero[..at.q.len().min(zero.len())];
                joint.law.motion(&Relative { q, ..*at }).rotation
            }
        };
        let hangs = if link.to_parent {
            hangs.transpose()
        } else {
            hangs
        };
        let near = match near {
            Place::Body(..) => self.place_of(near).map_or(from.axes, |(_, axes)| axes),
            _ => from.axes,
        };
        let turns = columns.iter().zip(at.q).map(|(column, q)| {
            let about = (from.axes * column.angular)[plane.normal()];
            if link.to_parent {
                -about * q
            } else {
                about * q
            }
        });
        let turns: f64 = match joint.law.attitude() {
            Some(_) => 0.0,
            None => turns.sum(),
        };
        from.angle + plane.angle(&(near * hangs * own.transpose())) + turns
    }

    /// A place of a joint on what it sits on: position and axes.
    fn place_of(&self, place: Place) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        let frame = match place {
            Place::World(frame) => self.numbers.world_frames.get(frame)?,
            Place::Body(body, frame) => self.numbers.bodies.get(body)?.frames.get(frame)?,
            Place::Point(_) => return Some((Vector3::zeros(), Matrix3::identity())),
        };
        Some((
            frame.position,
            frame.rotation.unwrap_or_else(Matrix3::identity),
        ))
    }

    /// A place of a joint in the world, as the state has it.
    fn frame(&self, place: Place, state: &[f64]) -> Option<MovingFrame> {
        let (layout, directions) = (self.layout, self.layout.directions);
        match place {
            Place::World(frame) => Some(match self.ground.get(frame).copied().flatten() {
                Some(motion) => MovingFrame {
                    position: motion.position,
                    axes: motion.rotation.unwrap_or_else(Matrix3::identity),
                    velocity: motion.velocity,
                    omega: motion.omega,
                    angle: 0.0,
                },
                None => {
                    let (position, axes) = self.place_of(place)?;
                    let still = Vector3::zeros();
                    MovingFrame {
                        position,
                        axes,
                        velocity: still,
                        omega: still,
                        angle: 0.0,
                    }
                }
            }),
            Place::Body(body, _) => {
                let slots = layout.own_slots(Part::Body(body))?;
                let components = self.scene.angular_velocity;
                let motion = BodyMotion::read(state, slots, layout.nq, directions, components);
                let (point, axes) = self.place_of(place)?;
                Some(MovingFrame {
                    position: motion.position + motion.arm(&point),
                    axes: motion.rotation * axes,
                    velocity: motion.velocity_of(&point),
                    omega: motion.omega_world,
                    angle: match motion.attitude {
                        Attitude::Angle(angle) => angle,
                        Attitude::Quaternion(_) | Attitude::Axes => 0.0,
                    },
                })
            }
            Place::Point(point) => match layout.points.get(point)? {
                PointSlots::Mass(slots) => Some(MovingFrame {
                    position: directions.linear(state, slots.q),
                    axes: Matrix3::identity(),
                    velocity: directions.linear(state, layout.nq + slots.v),
                    omega: Vector3::zeros(),
                    angle: 0.0,
                }),
                PointSlots::Node(_) => None,
            },
        }
    }
}
