//! Linkages pinned together as they stand: bodies with their axes along those of the world, joints where two of them meet.

use mbd_scene::joints::{Hinge, JointLaw};
use mbd_scene::{AngularVelocity, Place, Scene};
use nalgebra::{Matrix3, Vector3};

use crate::mechanism::{Instance, add_body, add_frame, add_joint, empty, frame, state};

/// A scene and where its bodies stand.
#[derive(Clone, Debug)]
pub struct Linkage {
    /// The scene.
    pub scene: Scene,
    /// Where the bodies stand.
    pub bodies: Vec<Instance>,
}

impl Linkage {
    /// Nothing yet.
    #[must_use]
    pub fn new(gravity: [f64; 3], components: AngularVelocity) -> Self {
        Linkage {
            scene: empty(gravity, components),
            bodies: Vec::new(),
        }
    }

    /// Adds a body at rest with its centre of mass at a place.
    pub fn body(&mut self, mass: f64, moments: [f64; 3], at: Vector3<f64>) -> usize {
        let inertia = Matrix3::from_diagonal(&Vector3::from(moments));
        self.bodies.push(Instance {
            position: at,
            ..Instance::rest()
        });
        add_body(&mut self.scene, mass, &inertia)
    }

    fn seat(&mut self, body: Option<usize>, at: Vector3<f64>, axes: Matrix3<f64>) -> Place {
        let centre = body.map_or_else(Vector3::zeros, |body| self.bodies[body].position);
        let place = frame("seat", (at - centre).into(), Some(axes));
        add_frame(&mut self.scene, body, place)
    }

    /// Joins two bodies (`None`: the world) where they stand, frames with z along `axis`.
    pub fn join(
        &mut self,
        law: JointLaw,
        [parent, child]: [Option<usize>; 2],
        at: Vector3<f64>,
        axis: Vector3<f64>,
    ) {
        let z = axis.normalize();
        let x = z.cross(&Vector3::new(0.31, -0.77, 0.55)).normalize();
        let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
        let (a, b) = (self.seat(parent, at, axes), self.seat(child, at, axes));
        add_joint(&mut self.scene, law, a, b);
    }

    /// Joins two bodies by a hinge.
    pub fn pin(&mut self, ends: [Option<usize>; 2], at: Vector3<f64>, axis: Vector3<f64>) {
        self.join(JointLaw::Hinge(Hinge::default()), ends, at, axis);
    }

    /// The state.
    #[must_use]
    pub fn state(&self) -> Vec<f64> {
        state(&self.scene, &self.bodies, &[])
    }
}

/// Axes of a plane: along, up, normal.
#[must_use]
pub fn plane(tilted: bool) -> [Vector3<f64>; 3] {
    if tilted {
        let normal = Vector3::new(0.48, -0.6, 0.64);
        let along = normal.cross(&Vector3::new(0.1, 0.9, 0.3)).normalize();
        return [along, normal.cross(&along), normal];
    }
    [Vector3::x(), Vector3::z(), -Vector3::y()]
}

/// Bars between points of a plane, pinned by hinges along its normal: `bars` lists the points of each bar, bar 0 the ground unless it floats.
#[must_use]
pub fn planar(
    points: &[[f64; 2]],
    bars: &[&[usize]],
    floats: bool,
    [along, up, normal]: [Vector3<f64>; 3],
    gravity: [f64; 3],
    components: AngularVelocity,
) -> Linkage {
    let weigh = |bar: usize| {
        let part = bar as f64;
        (1.0 + 0.2 * part, [0.02 + 0.01 * part, 0.05, 0.06])
    };
    let plane = [along, up, normal];
    weighed(points, bars, floats, plane, gravity, components, weigh)
}

/// The same with the mass and the principal moments of every bar.
#[must_use]
pub fn weighed(
    points: &[[f64; 2]],
    bars: &[&[usize]],
    floats: bool,
    [along, up, normal]: [Vector3<f64>; 3],
    gravity: [f64; 3],
    components: AngularVelocity,
    weigh: impl Fn(usize) -> (f64, [f64; 3]),
) -> Linkage {
    let place = |point: usize| along * points[point][0] + up * points[point][1];
    let mut linkage = Linkage::new(gravity, components);
    let mut own: Vec<Option<usize>> = Vec::new();
    for (index, bar) in bars.iter().enumerate() {
        if index == 0 && !floats {
            own.push(None);
            continue;
        }
        let sum: Vector3<f64> = bar.iter().map(|&point| place(point)).sum();
        let (mass, moments) = weigh(index);
        let centre = sum / bar.len() as f64;
        own.push(Some(linkage.body(mass, moments, centre)));
    }
    for point in 0..points.len() {
        let mut at = (0..bars.len()).filter(|&bar| bars[bar].contains(&point));
        if let Some(first) = at.next() {
            for other in at {
                linkage.pin([own[first], own[other]], place(point), normal);
            }
        }
    }
    linkage
}

/// Cranks of equal length on the world in the plane of x and y, rotated by `angle` and turning at `rate`, and bars across their tips.
#[must_use]
pub fn cranks(count: usize, bars: &[&[usize]], angle: f64, rate: f64, gravity: f64) -> Linkage {
    let (s, c) = angle.sin_cos();
    let mut points: Vec<[f64; 2]> = (0..count).map(|k| [k as f64, 0.0]).collect();
    points.extend((0..count).map(|k| [k as f64 + c, s]));
    let ground: Vec<usize> = (0..count).collect();
    let arms: Vec<[usize; 2]> = (0..count).map(|k| [k, count + k]).collect();
    let mut all: Vec<&[usize]> = vec![&ground];
    all.extend(arms.iter().map(|arm| arm.as_slice()));
    all.extend(bars);
    let rod = |_| (1.0, [1.0 / 12.0; 3]);
    let components = AngularVelocity::Body;
    let mut linkage = weighed(
        &points,
        &all,
        false,
        [Vector3::x(), Vector3::y(), Vector3::z()],
        [0.0, -gravity, 0.0],
        components,
        rod,
    );
    let omega = Vector3::new(0.0, 0.0, rate);
    let tip = omega.cross(&Vector3::new(c, s, 0.0));
    for (index, body) in linkage.bodies.iter_mut().enumerate() {
        *body = Instance {
            velocity: if index < count { tip * 0.5 } else { tip },
            omega: if index < count {
                omega
            } else {
                Vector3::zeros()
            },
            ..*body
        };
    }
    linkage
}

/// A closed chain of six hinges that stands symmetric about a line: it moves although 6·5 − 6·5 = 0 (Bricard's line-symmetric linkage).
#[must_use]
pub fn bricard(gravity: [f64; 3], components: AngularVelocity) -> Linkage {
    let half = |v: Vector3<f64>| Vector3::new(-v.x, -v.y, v.z);
    let axes: [(Vector3<f64>, Vector3<f64>); 3] = [
        (Vector3::new(0.9, -0.3, 0.1), Vector3::new(0.2, 0.9, 0.5)),
        (Vector3::new(0.7, 0.6, -0.4), Vector3::new(-0.6, 0.1, 0.8)),
        (Vector3::new(-0.2, 0.9, 0.3), Vector3::new(0.7, -0.5, 0.2)),
    ];
    let pin = |k: usize| match axes.get(k % 6) {
        Some(&axis) => axis,
        None => {
            let (at, axis) = axes[k % 3];
            (half(at), half(axis))
        }
    };
    let mut linkage = Linkage::new(gravity, components);
    let mut own = vec![None];
    for link in 0..5 {
        let centre = (pin(link).0 + pin(link + 1).0) * 0.5;
        let moments = [0.05, 0.06 + 0.01 * link as f64, 0.07];
        own.push(Some(linkage.body(1.0 + 0.1 * link as f64, moments, centre)));
    }
    for k in 0..6 {
        let (at, axis) = pin(k);
        linkage.pin([own[k], own[(k + 1) % 6]], at, axis);
    }
    linkage
}
