//! The axes of the links: each rotated about the axis of its joint so that few numbers tell how the next joint is mounted.
//!
//! ```text
//! E = R_z(a) R_x(b) R_z(c) R_z(q)                      how a hinge is mounted on the link that carries it, then its angle      (1)
//! E = R_x(b) R_z(q + c + ψ),   ψ = a of the next       axes of the links rotated by ψ about their joints                      (2)
//! ```
//!
//! Only frames that depend on no parameter are rotated: the angles are numbers. Of several joints that a link carries the first decides.
//! Source: Denavit and Hartenberg, A kinematic notation for lower-pair mechanisms based on matrices, 1955; here the origins stay where they are.

use nalgebra::{Matrix3, Vector3};

use crate::joints::{Axis, JointLaw};
use crate::laws::constant;
use crate::{Grouped, Link, LinkAxes, Place, Scene, Tree, Triple};

/// The most elements that may differ from zero where a joint is mounted simply: a rotation about one of three axes.
const SIMPLE: usize = 5;

/// Below this an element is zero: what rounding leaves of frames that lie along each other.
const NOTHING: f64 = 1e-15;

/// A link while its axes are chosen.
struct Mounting {
    /// The axes of its joint in those of the link that carries it, both before the rotation by ψ.
    mounted: Matrix3<f64>,
    /// The axes of the link in the frame of its joint on it, before that rotation.
    own: Matrix3<f64>,
    /// The three angles of (1) of one that is not mounted simply.
    angles: Option<[f64; 3]>,
    /// Which coordinate of the joint is its angle.
    angle: usize,
    /// ψ.
    psi: f64,
}

/// Lays the axes of the links of a tree, and finds what of their inertias nothing tells apart there.
pub(crate) fn lay_axes(scene: &Scene, tree: &mut Tree) {
    // In a planar scene all axes are one.
    let axes = match scene.planar {
        Some(_) => vec![None; tree.links.len()],
        None => {
            let mountings = mount(scene, &tree.links);
            find_parallel(&mut tree.links, &mountings);
            choose(&tree.links, mountings)
        }
    };
    for (link, axes) in tree.links.iter_mut().zip(axes) {
        link.axes = axes;
        if let Some(joint) = link.joint {
            link.grouped = Grouped::of(&scene.joints[joint].law, axes.as_ref());
        }
    }
}

/// How each link is mounted.
fn mount(scene: &Scene, links: &[Link]) -> Vec<Option<Mounting>> {
    let mut mountings: Vec<Option<Mounting>> = Vec::with_capacity(links.len());
    let mut bodies: Vec<Option<Matrix3<f64>>> = Vec::with_capacity(links.len());
    for link in links {
        let own = Mounting::of(scene, link, &bodies);
        bodies.push(in_body(scene, link, own.as_ref()));
        mountings.push(own);
    }
    mountings
}

/// Finds the links that turn about one axis of the world, whatever the angles of their joints are.
fn find_parallel(links: &mut [Link], mountings: &[Option<Mounting>]) {
    for (index, own) in mountings.iter().enumerate() {
        let Some(own) = own else { continue };
        let only = |axis: usize| (0..3).all(|k| k == axis || own.mounted[(k, 2)].abs() <= NOTHING);
        links[index].parallel = match links[index].inboard {
            Some(inboard) => links[inboard].parallel && only(2),
            None => (0..3).any(only),
        };
    }
}

/// The axes of all links; `None` for those that the frames of the declaration serve as well.
fn choose(links: &[Link], mut mountings: Vec<Option<Mounting>>) -> Vec<Option<LinkAxes>> {
    if mountings.iter().flatten().all(|own| own.is_simple()) {
        return vec![None; links.len()];
    }
    for index in 0..links.len() {
        let carried = links.iter().zip(&mountings);
        let mut wanted = carried.filter_map(|(link, own)| {
            let own = own.as_ref().filter(|_| link.inboard == Some(index));
            own?.angles
        });
        if let Some([a, ..]) = wanted.next()
            && let Some(own) = &mut mountings[index]
        {
            own.psi = a;
        }
    }
    let all = links.iter().zip(&mountings);
    let axes = all.map(|(link, own)| {
        let own = own.as_ref()?;
        let inboard = link.inboard.and_then(|link| mountings[link].as_ref());
        let psi = inboard.map_or(0.0, |inboard| inboard.psi);
        let (fixed, rest) = match own.angles {
            Some([a, b, c]) => (about_z(a - psi) * about_x(b), c),
            None => (about_z(-psi) * own.mounted, 0.0),
        };
        let shift = rest + own.psi;
        Some(LinkAxes {
            fixed: fixed.map(|x| if x.abs() < NOTHING { 0.0 } else { x }),
            angle: own.angle,
            shift: if link.reversed { -shift } else { shift },
            own: own.own * about_z(own.psi),
        })
    });
    axes.collect()
}

impl Mounting {
    /// Whether the frames of the declaration say it with as few numbers.
    fn is_simple(&self) -> bool {
        let elements = || self.mounted.iter().filter(|x| **x != 0.0);
        elements().count() <= SIMPLE && elements().all(|x| x.abs() > NOTHING)
    }

    /// That of a joint with an angle about its one axis; `None` for others, and where frames depend on parameters.
    fn of(scene: &Scene, link: &Link, bodies: &[Option<Matrix3<f64>>]) -> Option<Self> {
        let joint = scene.joints.get(link.joint?)?;
        let (law, axis) = joint.law.about_z()?;
        let angle = law
            .measured()
            .position(|coordinate| coordinate.is_angle())?;
        let [near, far] = link.ends(joint);
        let carrying = match link.inboard {
            Some(inboard) => bodies.get(inboard).copied().flatten()?,
            None => Matrix3::identity(),
        };
        rotation(scene, far)?;
        let own: Matrix3<f64> = axis.frame();
        let mounted = carrying.transpose() * rotation(scene, near)? * own;
        let elements = mounted.iter().filter(|x| x.abs() > NOTHING).count();
        Some(Mounting {
            angles: (elements > SIMPLE).then(|| angles(&mounted)),
            mounted,
            own,
            angle,
            psi: 0.0,
        })
    }
}

/// The axes of a link in its body before the rotation by ψ; `None` where they depend on parameters.
fn in_body(scene: &Scene, link: &Link, mounting: Option<&Mounting>) -> Option<Matrix3<f64>> {
    let Some(joint) = link.joint else {
        return Some(Matrix3::identity());
    };
    let joint = scene.joints.get(joint)?;
    let [_, far] = link.ends(joint);
    let own = match mounting {
        Some(mounting) => Some(mounting.own),
        None => as_seen(&joint.law, None).1,
    };
    Some(rotation(scene, far)? * own.unwrap_or_else(Matrix3::identity))
}

/// A joint as its link sees it, and the axes of that in the frame of the joint: about z where that leaves zeros.
pub(super) fn as_seen(
    law: &JointLaw,
    axes: Option<&LinkAxes>,
) -> (Option<JointLaw>, Option<Matrix3<f64>>) {
    let Some((about_z, axis)) = law.about_z() else {
        return (None, None);
    };
    match axes.map(|axes| axes.own).or_else(|| axis.to_z()) {
        Some(own) => (Some(about_z), Some(own)),
        None => (None, None),
    }
}

/// The axes of a place in its body; `None` where they depend on parameters.
fn rotation(scene: &Scene, place: Place) -> Option<Matrix3<f64>> {
    let frame = match place {
        Place::World(frame) => scene.world_frames.get(frame)?,
        Place::Body(body, frame) => scene.bodies.get(body)?.frames.get(frame)?,
        Place::Point(_) => return None,
    };
    let Some(rows) = frame.rotation.as_ref().filter(|_| !frame.moves(scene)) else {
        return Some(Matrix3::identity());
    };
    // What depends on a parameter is no number without it.
    let unknown = vec![f64::NAN; scene.params.len()];
    let of = |row: &Triple| Vector3::from(row.each_ref().map(|x| constant(scene, &unknown, x)));
    let rows = rows.each_ref().map(|row| of(row).transpose());
    let rotation = Matrix3::from_rows(&rows);
    rotation.iter().all(|x| x.is_finite()).then_some(rotation)
}

/// The angles of (1).
fn angles(mounted: &Matrix3<f64>) -> [f64; 3] {
    let (x, y) = (mounted[(0, 2)], -mounted[(1, 2)]);
    let c = mounted[(2, 0)].atan2(mounted[(2, 1)]);
    [x.atan2(y), x.hypot(y).atan2(mounted[(2, 2)]), c]
}

fn about_z(angle: f64) -> Matrix3<f64> {
    Axis::Z.turn(angle)
}

fn about_x(angle: f64) -> Matrix3<f64> {
    Axis::X.turn(angle)
}
