//! What a URDF says: links and joints, with their places in the file.

use mbd_scene::solids::Solid;
use nalgebra::{Matrix3, Vector3};

use crate::lexeme::LexemeIndex;
use crate::resolve::fold::sin_cos;

/// A robot.
#[derive(Debug, Default)]
pub struct Robot {
    /// Its name; empty where the file gives none.
    pub name: String,
    /// Its links, in the order of the file.
    pub links: Vec<UrdfLink>,
    /// Its joints, in the order of the file.
    pub joints: Vec<UrdfJoint>,
    /// The link that carries all others.
    pub root: usize,
    /// What the file holds beside links and joints, by the name of its elements, and how many.
    pub unread: Vec<(String, usize)>,
}

/// A rigid link.
#[derive(Debug)]
pub struct UrdfLink {
    /// Its name in the file.
    pub name: String,
    /// Its element.
    pub at: LexemeIndex,
    /// Mass and inertia, if any.
    pub inertial: Option<Inertial>,
    /// What it looks like, as far as that is put together of simple solids.
    pub shapes: Vec<UrdfGeometry>,
}

/// The `<geometry>` of a `<visual>`, or of a `<collision>` where no `<visual>` is simple.
#[derive(Clone, Debug)]
pub struct UrdfGeometry {
    /// What it is.
    pub solid: Solid,
    /// Its sizes [m], positive.
    pub sizes: Vec<f64>,
    /// Its place and axes in those of the link.
    pub origin: UrdfOrigin,
}

/// `<inertial>`.
#[derive(Clone, Debug)]
pub struct Inertial {
    /// The centre of mass, and the axes of the inertia, in those of the link.
    pub origin: UrdfOrigin,
    /// Mass [kg], not negative.
    pub mass: f64,
    /// About the centre of mass in the axes of `origin` [kg·m²].
    pub inertia: Matrix3<f64>,
    /// Its element `<inertia>`.
    pub at: LexemeIndex,
}

/// A joint between two links.
#[derive(Debug)]
pub struct UrdfJoint {
    /// Its name in the file.
    pub name: String,
    /// Its element.
    pub at: LexemeIndex,
    /// What it allows.
    pub kind: UrdfJointKind,
    /// The link it hangs on.
    pub parent: usize,
    /// The link it carries; its frame is that of the joint where all coordinates are zero.
    pub child: usize,
    /// The joint's frame in that of the parent.
    pub origin: UrdfOrigin,
    /// The axis in the joint's frame, of any length but zero.
    pub axis: [f64; 3],
    /// The range of its coordinate and what drives it.
    pub limit: UrdfLimit,
    /// Damping [N·s/m or N·m·s/rad] and friction [N or N·m], not negative.
    pub dynamics: [f64; 2],
    /// The joint whose coordinate it follows.
    pub mimic: Option<Mimic>,
}

/// What a joint allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UrdfJointKind {
    /// `revolute`, `continuous`
    Hinge,
    /// `prismatic`
    Prismatic,
    /// `fixed`
    Fixed,
    /// `floating`
    Free,
    /// `planar`
    Planar,
    /// `spherical`, `ball`: an extension that some writers use.
    Spherical,
}

impl UrdfJointKind {
    /// The types of a URDF.
    pub const TYPES: [(&str, UrdfJointKind); 8] = [
        ("revolute", UrdfJointKind::Hinge),
        ("continuous", UrdfJointKind::Hinge),
        ("prismatic", UrdfJointKind::Prismatic),
        ("fixed", UrdfJointKind::Fixed),
        ("floating", UrdfJointKind::Free),
        ("planar", UrdfJointKind::Planar),
        ("spherical", UrdfJointKind::Spherical),
        ("ball", UrdfJointKind::Spherical),
    ];

    /// The keyword of the joint in a declaration.
    pub fn keyword(self) -> &'static str {
        match self {
            UrdfJointKind::Hinge => "hinge",
            UrdfJointKind::Prismatic => "prismatic",
            UrdfJointKind::Fixed => "rigid",
            UrdfJointKind::Free => "free",
            UrdfJointKind::Planar => "planar",
            UrdfJointKind::Spherical => "spherical",
        }
    }

    /// The name of its only coordinate, its unit, and the unit of the effort along it.
    pub fn coordinate(self) -> Option<(&'static str, &'static str, &'static str)> {
        match self {
            UrdfJointKind::Hinge => Some(("angle", "rad", "N*m")),
            UrdfJointKind::Prismatic => Some(("slide", "m", "N")),
            _ => None,
        }
    }
}

/// `<limit>`: what is not said is `None`.
#[derive(Clone, Copy, Debug, Default)]
pub struct UrdfLimit {
    /// Lower and upper end of the coordinate [rad or m].
    pub range: Option<[f64; 2]>,
    /// The largest effort of its drive [N·m or N].
    pub effort: Option<f64>,
    /// The largest rate of its drive [rad/s or m/s].
    pub velocity: Option<f64>,
}

/// `<mimic>`: coordinate = multiplier · that of the other joint + offset.
#[derive(Clone, Copy, Debug)]
pub struct Mimic {
    /// The other joint.
    pub joint: usize,
    /// Of the other coordinate.
    pub multiplier: f64,
    /// [rad or m]
    pub offset: f64,
    /// Its element.
    pub at: LexemeIndex,
}

/// `<origin>`: a place with axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UrdfOrigin {
    /// Where it is [m].
    pub xyz: [f64; 3],
    /// Roll, pitch, yaw about the fixed axes x, y, z [rad].
    pub rpy: [f64; 3],
}

impl UrdfOrigin {
    /// R = Rz(yaw) Ry(pitch) Rx(roll), with true zeros at quarter turns.
    pub fn rotation(&self) -> Matrix3<f64> {
        let [(sr, cr), (sp, cp), (sy, cy)] = self.rpy.map(sin_cos);
        let x = Matrix3::new(1.0, 0.0, 0.0, 0.0, cr, -sr, 0.0, sr, cr);
        let y = Matrix3::new(cp, 0.0, sp, 0.0, 1.0, 0.0, -sp, 0.0, cp);
        let z = Matrix3::new(cy, -sy, 0.0, sy, cy, 0.0, 0.0, 0.0, 1.0);
        z * y * x
    }

    /// Where it is.
    pub fn position(&self) -> Vector3<f64> {
        self.xyz.into()
    }
}
