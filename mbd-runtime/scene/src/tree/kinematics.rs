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

use crate::laws::body::{Attitude, BodyMotion};
use crate::laws::numbers::{BodyNumbers, FrameNumbers, Numbers};
use crate::scalar::Few;
use crate::scalar::algebra::labelled;
use crate::{At, FrameMotion, Layout, Link, Place, Pose, Real, Relative, Scene, Twist};

/// A link in motion, its own axes unless said otherwise.
#[derive(Clone, Debug)]
pub(crate) struct LinkMotion<S: Real> {
    /// E: its axes → those of the link that carries it.
    pub turn: Matrix3<S>,
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
}

impl<S: Real> LinkMotion<S> {
    /// Nothing known yet.
    pub fn unknown() -> Self {
        LinkMotion {
            turn: Matrix3::identity(),
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
        }
    }

    /// A body that floats: its axes, its centre of mass, six unit columns.
    fn floating(motion: &BodyMotion<S>) -> Self {
        let axes = motion.rotation.map(|x| x * motion.unit);
        let mut columns = Few::new(Twist::zero());
        columns.extend(units().map(Twist::slide));
        columns.extend(units().map(Twist::spin));
        LinkMotion {
            turn: axes,
            offset: motion.position,
            columns,
            omega: motion.omega_body,
            velocity: axes.transpose() * motion.velocity,
            axes,
            origin: motion.position,
            ..LinkMotion::unknown()
        }
    }

    /// The body of the link.
    fn body_motion(&self) -> BodyMotion<S> {
        let rotation = self.axes * self.body;
        let moving = self.velocity + self.omega.cross(&self.centre);
        BodyMotion {
            position: labelled(self.origin + self.axes * self.centre, ["x", "y", "z"]),
            rotation,
            unit: S::one(),
            attitude: Attitude::Axes,
            velocity: labelled(self.axes * moving, ["vx", "vy", "vz"]),
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
struct Instant<'a, S: Real> {
    scene: &'a Scene,
    layout: &'a Layout,
    numbers: &'a Numbers<S>,
    at: &'a At<'a, S>,
    ground: &'a [Option<FrameMotion<S>>],
}

/// Reads every link, and the bodies on them, at an instant.
pub(crate) fn read<'a, S: Real>(
    (scene, layout, numbers): (&'a Scene, &'a Layout, &'a Numbers<S>),
    at: &'a At<'a, S>,
    ground: &'a [Option<FrameMotion<S>>],
    links: &mut [LinkMotion<S>],
    motions: &mut [BodyMotion<S>],
) {
    let instant = Instant {
        scene,
        layout,
        numbers,
        at,
        ground,
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
                Some(LinkMotion::floating(&motions[link.body]))
            }
            Some(joint) => instant.carried(link, joint, links),
        };
        let Some(motion) = motion else { continue };
        if link.joint.is_some() {
            motions[link.body] = motion.body_motion();
        }
        links[index] = motion;
    }
}

impl<S: Real> Instant<'_, S> {
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
        let aligned = declared.law.aligned();
        let (law, alignment) = match &aligned {
            Some((law, alignment)) => (law, Some(alignment.map(S::from_f64))),
            None => (&declared.law, None),
        };
        let along = |frame: Matrix3<S>| alignment.map_or(frame, |alignment| frame * alignment);
        let mut pose = law.motion(&at);
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
        let (near, far) = match link.reversed {
            false => (declared.parent, declared.child),
            true => (declared.child, declared.parent),
        };
        let inboard = self.inboard(near, link.inboard.and_then(|link| links.get(link)))?;
        let (_, outboard) = frame_of(self.numbers, far)?;
        let (turn, offset, moved) = match link.reversed {
            false => forward(&pose, columns, law.attitude().is_some(), &bias),
            true => backward(&pose, columns, at.u, &bias),
        };
        let frame = along(inboard.frame);
        let mut motion = LinkMotion {
            turn: labelled_matrix(frame * turn),
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
        let brought = motion.turn.transpose() * inboard.omega;
        motion.omega = labelled(brought + spin, ["link_w_x", "link_w_y", "link_w_z"]);
        motion.velocity = motion.turn.transpose()
            * (inboard.velocity + inboard.omega.cross(&motion.offset))
            + slide;
        let two = S::from_f64(2.0);
        motion.bias = Twist {
            linear: moved.linear + brought.cross(&slide).map(|x| two * x),
            angular: moved.angular + brought.cross(&spin),
        };
        motion.axes = inboard.axes * motion.turn;
        motion.origin = inboard.origin + inboard.axes * motion.offset;
        Some(motion)
    }

    /// What carries a link at a place.
    fn inboard(&self, near: Place, link: Option<&LinkMotion<S>>) -> Option<Inboard<S>> {
        match near {
            Place::World(frame) => Some(match self.ground.get(frame)?.as_ref() {
                Some(motion) => {
                    let axes = motion.rotation.unwrap_or_else(Matrix3::identity);
                    Inboard {
                        axes,
                        origin: motion.position,
                        omega: axes.transpose() * motion.omega,
                        velocity: axes.transpose() * motion.velocity,
                        place: Vector3::zeros(),
                        frame: Matrix3::identity(),
                    }
                }
                None => {
                    let frame = self.numbers.world_frames.get(frame)?;
                    Inboard {
                        axes: Matrix3::identity(),
                        origin: Vector3::zeros(),
                        omega: Vector3::zeros(),
                        velocity: Vector3::zeros(),
                        place: frame.position,
                        frame: axes_of(frame),
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
                })
            }
            Place::Point(_) => None,
        }
    }
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

/// The elements of E.
fn labelled_matrix<S: Real>(turn: Matrix3<S>) -> Matrix3<S> {
    const NAMES: [[&str; 3]; 3] = [
        ["e11", "e12", "e13"],
        ["e21", "e22", "e23"],
        ["e31", "e32", "e33"],
    ];
    Matrix3::from_fn(|row, column| turn[(row, column)].label(NAMES[row][column]))
}
