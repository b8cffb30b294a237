//! Poses and velocities of the links, from the world outwards.
//!
//! ```text
//! E = F1 R12(q),  r = p1 + F1 s(q)            axes and origin of a link in those of the link that carries it              (1)
//! ω = Eᵀ ω_p + k,   v = Eᵀ (v_p + ω_p × r) + x,        [x; k] = R12ᵀ H u                                                (2)
//! α = Eᵀ α_p + k̇ + Eᵀω_p × k,   a = Eᵀ (a_p + α_p × r + ω_p × (ω_p × r)) + ẋ + 2 Eᵀω_p × x,   [ẋ; k̇] = R12ᵀ (H u̇ + b)   (3)
//! ```
//!
//! p1, F1: frame 1 of the joint in the link that carries. A joint that is walked from its child has the inverse motion:
//!
//! ```text
//! E = F2 R12ᵀ,  r = p2 − F2 R12ᵀ s,   x = −H_v u + H_ω u × s,  k = −H_ω u,   ẋ = −b_v + b_ω × s + 2 k′ × x′ − k′ × (k′ × s),  k̇ = −b_ω    (4)
//! ```
//!
//! with x′ = H_v u, k′ = H_ω u, in frame-1 axes, which are those of the link. Source: Featherstone, Rigid Body Dynamics Algorithms; (4) derived.

use nalgebra::{Matrix3, Vector3};

use super::link_axes::as_seen;
use super::turn::Turn;
use crate::laws::body::{Attitude, BodyMotion};
use crate::laws::numbers::{BodyNumbers, FrameNumbers, Numbers};
use crate::laws::origin::Origin;
use crate::scalar::Few;
use crate::scalar::algebra::labelled;
use crate::{
    At, Directions, FrameMotion, Layout, Link, LinkAxes, Place, Pose, Real, Relative, Scene, Twist,
};

/// A link in motion, its own axes unless said otherwise.
#[derive(Clone, Debug)]
pub(crate) struct LinkMotion<S: Real> {
    /// E: its axes → those of the link that carries it.
    pub turn: Turn<S>,
    /// r: its origin from that of the link that carries it, axes of that [m].
    pub offset: Vector3<S>,
    /// Axes and origin of the frame of its joint on the link that carries it, in those of that link.
    pub joint: (Matrix3<S>, Vector3<S>),
    /// The columns of H at its origin.
    pub columns: Few<Twist<S>, 6>,
    /// What velocities add to its acceleration by (3), besides the centripetal part of r.
    pub bias: Twist<S>,
    /// ω of the link that carries it, axes of that [rad/s].
    pub inboard_omega: Vector3<S>,
    /// Angular velocity [rad/s].
    pub omega: Vector3<S>,
    /// Velocity of its origin [m/s].
    pub velocity: Vector3<S>,
    /// Its axes → world axes.
    pub axes: Matrix3<S>,
    /// Its origin, world axes [m].
    pub origin: Vector3<S>,
    /// Centre of mass from its origin [m].
    pub centre: Vector3<S>,
    /// Components of the body → its axes.
    pub body: Matrix3<S>,
    /// The angle of the body about the normal of a planar scene, turns counted [rad].
    pub angle: S,
}

/// What carries a link: another link, the world, or a frame of the world that moves.
struct Inboard<S: Real> {
    axes: Matrix3<S>,
    origin: Vector3<S>,
    omega: Vector3<S>,
    velocity: Vector3<S>,
    /// The frame of the joint on it.
    place: Vector3<S>,
    frame: Matrix3<S>,
    /// Its axes → components of its body, or of the world.
    body: Matrix3<S>,
    /// The angle of its body about the normal of a planar scene.
    angle: S,
}

impl<S: Real> LinkMotion<S> {
    /// Nothing known yet.
    pub fn unknown() -> Self {
        LinkMotion {
            turn: Turn::by(Matrix3::identity()),
            offset: Vector3::zeros(),
            joint: (Matrix3::identity(), Vector3::zeros()),
            columns: Few::new(Twist::zero()),
            bias: Twist::zero(),
            inboard_omega: Vector3::zeros(),
            omega: Vector3::zeros(),
            velocity: Vector3::zeros(),
            axes: Matrix3::identity(),
            origin: Vector3::zeros(),
            centre: Vector3::zeros(),
            body: Matrix3::identity(),
            angle: S::zero(),
        }
    }

    /// A body that floats: its axes, its centre of mass, six unit columns, in a plane three.
    fn floating(motion: &BodyMotion<S>, directions: Directions) -> Self {
        let axes = motion.rotation.map(|x| x * motion.unit);
        let mut columns = Few::new(Twist::zero());
        let units = units();
        let along = directions.translations().iter();
        columns.extend(along.map(|&axis| Twist::slide(units[axis])));
        let about = directions.rotations().iter();
        columns.extend(about.map(|&axis| Twist::spin(units[axis])));
        LinkMotion {
            turn: Turn::by(axes),
            offset: motion.position,
            columns,
            omega: motion.omega_body,
            velocity: axes.transpose() * motion.velocity,
            axes,
            origin: motion.position,
            angle: match motion.attitude {
                Attitude::Angle(angle) => angle,
                Attitude::Quaternion(_) | Attitude::Axes => S::zero(),
            },
            ..LinkMotion::unknown()
        }
    }

    /// The body of the link; nothing of it is out of the plane of a planar scene.
    fn body_motion(&self, directions: Directions) -> BodyMotion<S> {
        let rotation = self.axes * self.body;
        let moving = self.velocity + self.omega.cross(&self.centre);
        BodyMotion {
            position: labelled(
                directions.in_plane(self.origin + self.axes * self.centre),
                ["x", "y", "z"],
            ),
            rotation,
            unit: S::one(),
            attitude: match directions.plane {
                Some(_) => Attitude::Angle(self.angle),
                None => Attitude::Axes,
            },
            velocity: labelled(directions.in_plane(self.axes * moving), ["vx", "vy", "vz"]),
            omega_body: self.body.transpose() * self.omega,
            omega_world: labelled(self.axes * self.omega, ["w_x", "w_y", "w_z"]),
        }
    }
}

fn units<S: Real>() -> [Vector3<S>; 3] {
    let all = Matrix3::identity();
    [0, 1, 2].map(|axis| all.column(axis).into_owned())
}

/// The axes of a frame in its body.
fn axes_of<S: Real>(frame: &FrameNumbers<S>) -> Matrix3<S> {
    frame.rotation.unwrap_or_else(Matrix3::identity)
}

/// The frame of a place on a body.
fn frame_of<S: Real>(
    numbers: &Numbers<S>,
    place: Place,
) -> Option<(&BodyNumbers<S>, &FrameNumbers<S>)> {
    let Place::Body(body, frame) = place else {
        return None;
    };
    let body = numbers.bodies.get(body)?;
    Some((body, body.frames.get(frame)?))
}

/// The scene of one instant, as far as links need it.
struct LinkInstant<'a, S: Real> {
    scene: &'a Scene,
    layout: &'a Layout,
    numbers: &'a Numbers<S>,
    at: &'a At<'a, S>,
    ground: &'a [Option<FrameMotion<S>>],
    /// What positions and velocities are measured from; `None`: the world.
    origin: Option<Origin<S>>,
}

/// Reads every link, and the bodies on them, at an instant.
pub(crate) fn read<'a, S: Real>(
    (scene, layout, numbers): (&'a Scene, &'a Layout, &'a Numbers<S>),
    at: &'a At<'a, S>,
    (ground, origin): (&'a [Option<FrameMotion<S>>], Option<Origin<S>>),
    links: &mut [LinkMotion<S>],
    motions: &mut [BodyMotion<S>],
) {
    let instant = LinkInstant {
        scene,
        layout,
        numbers,
        at,
        ground,
        origin,
    };
    let declared = layout.tree.iter().flat_map(|tree| &tree.links);
    for (index, link) in declared.enumerate() {
        S::section(&scene.bodies[link.body].name);
        let motion = match link.joint {
            None => {
                motions[link.body] = BodyMotion::read(
                    at.state,
                    link.slots,
                    layout.nq,
                    layout.directions,
                    scene.angular_velocity,
                );
                Some(LinkMotion::floating(&motions[link.body], layout.directions))
            }
            Some(joint) => instant.carried(link, joint, links),
        };
        let Some(motion) = motion else { continue };
        if link.joint.is_some() {
            motions[link.body] = motion.body_motion(layout.directions);
        }
        links[index] = motion;
    }
}

impl<S: Real> LinkInstant<'_, S> {
    /// The link that a joint carries.
    fn carried(&self, link: &Link, joint: usize, links: &[LinkMotion<S>]) -> Option<LinkMotion<S>> {
        let declared = self.scene.joints.get(joint)?;
        let at = Relative {
            q: self
                .at
                .state
                .get(link.slots.q..link.slots.q + link.coordinates)?,
            u: self
                .at
                .state
                .get(self.layout.nq + link.slots.v..)?
                .get(..link.speeds)?,
            numbers: self.numbers.joints.get(joint)?,
        };
        let (seen, own) = as_seen(&declared.law, link.axes.as_ref());
        let law = seen.as_ref().unwrap_or(&declared.law);
        let own = own.map(|own| own.map(S::from_f64));
        let along = |frame: Matrix3<S>| own.map_or(frame, |own| frame * own);
        let posed = |q: &[S]| match link.axes {
            Some(axes) => law.motion(&Relative {
                q: &shifted(q, &axes),
                ..at
            }),
            None => law.motion(&Relative { q, ..at }),
        };
        let mut pose = posed(at.q);
        if let Some(attitude) = law.attitude() {
            let square = at.q[attitude].iter().fold(S::zero(), |sum, &x| sum + x * x);
            // A quaternion leaves length 1 inside a step.
            let unit = S::one() / square.label("square");
            pose.rotation = pose.rotation.map(|x| x * unit);
        }
        let mut columns = [Twist::zero(); 6];
        let columns = &mut columns[..link.speeds];
        law.subspace(&at, columns);
        let bias = law.bias(&at);
        let [near, far] = link.ends(declared);
        let inboard = self.inboard(near, link.inboard.and_then(|link| links.get(link)))?;
        let (_, outboard) = frame_of(self.numbers, far)?;
        let (turn, offset, moved) = match link.reversed {
            false => forward(&pose, columns, law.attitude().is_some(), &bias),
            true => backward(&pose, columns, at.u, &bias),
        };
        let frame = match link.axes {
            Some(axes) => axes.fixed.map(S::from_f64),
            None => along(inboard.frame),
        };
        let mut motion = LinkMotion {
            turn: Turn::of(frame, turn),
            offset: inboard.place + frame * offset,
            joint: (frame, inboard.place),
            inboard_omega: inboard.omega,
            ..LinkMotion::unknown()
        };
        motion.columns.extend(columns.iter().copied());
        let body = along(axes_of(outboard)).transpose();
        motion.body = body;
        motion.centre = -(body * outboard.position);
        let sum = |of: fn(&Twist<S>) -> Vector3<S>| {
            let parts = columns.iter().zip(at.u);
            parts.fold(Vector3::zeros(), |sum: Vector3<S>, (column, &u)| {
                sum + of(column).map(|x| x * u)
            })
        };
        let (slide, spin) = (sum(|column| column.linear), sum(|column| column.angular));
        let brought = motion.turn.back(&inboard.omega);
        motion.omega = labelled(brought + spin, ["link_w_x", "link_w_y", "link_w_z"]);
        let carried = inboard.velocity + inboard.omega.cross(&motion.offset);
        motion.velocity = motion.turn.back(&carried) + slide;
        let two = S::from_f64(2.0);
        motion.bias = Twist {
            linear: moved.linear + brought.cross(&slide).map(|x| two * x),
            angular: moved.angular + brought.cross(&spin),
        };
        motion.axes = inboard.axes * motion.turn.matrix();
        motion.origin = inboard.origin + inboard.axes * motion.offset;
        if let Some(plane) = self.layout.directions.plane {
            let start = posed(&[S::zero(); 6][..link.coordinates]).rotation;
            let start = match link.reversed {
                false => start,
                true => start.transpose(),
            };
            let start = inboard.body * frame * start * body;
            let turns = motion.columns.iter().zip(at.q).map(|(column, &q)| {
                let about = motion.axes * column.angular;
                about[plane.normal()] * q
            });
            motion.angle = turns.fold(inboard.angle + plane.angle(&start), |sum, turn| sum + turn);
        }
        Some(motion)
    }

    /// What carries a link at a place.
    fn inboard(&self, near: Place, link: Option<&LinkMotion<S>>) -> Option<Inboard<S>> {
        match near {
            Place::World(frame) => Some(match self.ground.get(frame)?.as_ref() {
                Some(motion) => {
                    let axes = motion.rotation.unwrap_or_else(Matrix3::identity);
                    let [position, velocity] = match self.origin {
                        Some(origin) => origin.sees([motion.position, motion.velocity]),
                        None => [motion.position, motion.velocity],
                    };
                    Inboard {
                        axes,
                        origin: position,
                        omega: axes.transpose() * motion.omega,
                        velocity: axes.transpose() * velocity,
                        place: Vector3::zeros(),
                        frame: Matrix3::identity(),
                        body: axes,
                        angle: S::zero(),
                    }
                }
                None => {
                    let frame = self.numbers.world_frames.get(frame)?;
                    let still = [Vector3::zeros(); 2];
                    let [position, velocity] =
                        self.origin.map_or(still, |origin| origin.sees(still));
                    Inboard {
                        axes: Matrix3::identity(),
                        origin: position,
                        omega: Vector3::zeros(),
                        velocity,
                        place: frame.position,
                        frame: axes_of(frame),
                        body: Matrix3::identity(),
                        angle: S::zero(),
                    }
                }
            }),
            Place::Body(..) => {
                let (link, (_, frame)) = (link?, frame_of(self.numbers, near)?);
                Some(Inboard {
                    axes: link.axes,
                    origin: link.origin,
                    omega: link.omega,
                    velocity: link.velocity,
                    place: link.centre + link.body * frame.position,
                    frame: link.body * axes_of(frame),
                    body: link.body.transpose(),
                    angle: link.angle,
                })
            }
            Place::Point(_) => None,
        }
    }
}

/// Coordinates of a joint with the angle from which its link counts: at most a displacement and an angle.
fn shifted<S: Real>(q: &[S], axes: &LinkAxes) -> Few<S, 2> {
    let mut all = Few::new(S::zero());
    let own = q.iter().enumerate();
    all.extend(own.map(|(index, &q)| match index == axes.angle {
        true => q + S::from_f64(axes.shift),
        false => q,
    }));
    all
}

/// (1): axes and origin of frame 2 in frame 1; the columns and b are taken to frame-2 axes.
fn forward<S: Real>(
    pose: &Pose<S>,
    columns: &mut [Twist<S>],
    attitude: bool,
    bias: &Twist<S>,
) -> (Matrix3<S>, Vector3<S>, Twist<S>) {
    let back = pose.rotation.transpose();
    let rotated = |twist: &Twist<S>| Twist {
        linear: back * twist.linear,
        angular: back * twist.angular,
    };
    columns
        .iter_mut()
        .for_each(|column| *column = rotated(column));
    if attitude {
        // The speeds of an attitude are the angular velocity in frame 2.
        let own = columns.iter_mut().rev().zip(units().into_iter().rev());
        own.for_each(|(column, axis)| *column = Twist::spin(axis));
    }
    (pose.rotation, pose.position, rotated(bias))
}

/// (4): axes and origin of frame 1 in frame 2.
fn backward<S: Real>(
    pose: &Pose<S>,
    columns: &mut [Twist<S>],
    speeds: &[S],
    bias: &Twist<S>,
) -> (Matrix3<S>, Vector3<S>, Twist<S>) {
    let s = pose.position;
    let (mut x, mut k): (Vector3<S>, Vector3<S>) = (Vector3::zeros(), Vector3::zeros());
    for (column, &u) in columns.iter_mut().zip(speeds) {
        x += column.linear.map(|c| c * u);
        k += column.angular.map(|c| c * u);
        *column = Twist {
            linear: column.angular.cross(&s) - column.linear,
            angular: -column.angular,
        };
    }
    let two = S::from_f64(2.0);
    let moved = Twist {
        linear: bias.angular.cross(&s) - bias.linear + k.cross(&x).map(|c| two * c)
            - k.cross(&k.cross(&s)),
        angular: -bias.angular,
    };
    let back = pose.rotation.transpose();
    (back, -(back * s), moved)
}
