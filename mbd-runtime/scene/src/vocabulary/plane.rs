//! Where things move: in space, or in a plane with three coordinates a body.
//!
//! ```text
//! in space      q = r (3), quaternion (4)          v = ṙ (3), ω (3)
//! in a plane    q = r (2), angle φ                 v = ṙ (2), ω = φ̇                 R = turn about the normal by φ
//! ```
//!
//! A plane goes through the origin of the world, and centres of mass and points with mass stay in it. Out of it nothing is unknown: the
//! plane carries what forces and joints ask for there, and that is not part of any reaction. The laws stay those of space: positions,
//! velocities and rotations are read with exact zeros out of the plane, and what they ask of the bodies is taken in the plane alone.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use crate::{Axis, Real};

/// The plane of a planar scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Plane {
    /// x and y; the angle turns about z, from x to y.
    Xy,
    /// y and z; the angle turns about x, from y to z.
    Yz,
    /// x and z; the angle turns about y, from z to x.
    Xz,
}

impl Plane {
    /// Every plane by its words: the axes in either order.
    pub const WORDS: [(&'static str, Plane); 6] = [
        ("xy", Plane::Xy),
        ("yz", Plane::Yz),
        ("xz", Plane::Xz),
        ("yx", Plane::Xy),
        ("zy", Plane::Yz),
        ("zx", Plane::Xz),
    ];

    /// Its word, `xz`.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Plane::Xy => "xy",
            Plane::Yz => "yz",
            Plane::Xz => "xz",
        }
    }

    /// The number of its normal among x, y, z. Angles turn about it, right-handed.
    #[must_use]
    pub const fn normal(self) -> usize {
        match self {
            Plane::Xy => 2,
            Plane::Yz => 0,
            Plane::Xz => 1,
        }
    }

    /// The angle of a turn about the normal, in (−π, π] [rad].
    pub fn angle<S: Real>(self, turn: &Matrix3<S>) -> S {
        let [from, to] = [1, 2].map(|k| (self.normal() + k) % 3);
        turn[(to, from)].atan2(turn[(from, from)])
    }

    /// The normal as an axis.
    #[must_use]
    pub fn axis(self) -> Axis {
        match self {
            Plane::Xy => Axis::Z,
            Plane::Yz => Axis::X,
            Plane::Xz => Axis::Y,
        }
    }
}

/// The world axes along which things move, and those about which bodies turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Directions {
    /// The plane of a planar scene.
    pub plane: Option<Plane>,
}

impl Directions {
    /// The axes along which things move, in the order of the state: 3, in a plane 2.
    #[must_use]
    pub const fn translations(self) -> &'static [usize] {
        match self.plane {
            None => &[0, 1, 2],
            Some(Plane::Xy) => &[0, 1],
            Some(Plane::Yz) => &[1, 2],
            Some(Plane::Xz) => &[0, 2],
        }
    }

    /// The axes about which bodies turn: 3, in a plane its normal.
    #[must_use]
    pub const fn rotations(self) -> &'static [usize] {
        match self.plane {
            None => &[0, 1, 2],
            Some(Plane::Xy) => &[2],
            Some(Plane::Yz) => &[0],
            Some(Plane::Xz) => &[1],
        }
    }

    /// Speeds of a body: 6, in a plane 3.
    #[must_use]
    pub const fn speeds(self) -> usize {
        self.translations().len() + self.rotations().len()
    }

    /// Numbers of an attitude: the 4 of a quaternion, in a plane the angle.
    #[must_use]
    pub const fn attitude(self) -> usize {
        match self.plane {
            None => 4,
            Some(_) => 1,
        }
    }

    /// Coordinates of a body: 7, in a plane 3.
    #[must_use]
    pub const fn coordinates(self) -> usize {
        self.translations().len() + self.attitude()
    }

    /// Numbers of a body's motion: its coordinates, then its speeds.
    #[must_use]
    pub const fn motion(self) -> usize {
        self.coordinates() + self.speeds()
    }

    /// A vector without what is out of the plane.
    #[must_use]
    pub fn in_plane<S: Real>(self, mut vector: Vector3<S>) -> Vector3<S> {
        if let Some(plane) = self.plane {
            vector[plane.normal()] = S::zero();
        }
        vector
    }

    /// A vector without what is not about an axis about which bodies turn.
    #[must_use]
    pub fn about_normal<S: Real>(self, vector: Vector3<S>) -> Vector3<S> {
        Vector3::from_fn(|axis, _| match self.rotations().contains(&axis) {
            true => vector[axis],
            false => S::zero(),
        })
    }

    /// A position or a velocity, world axes, from the numbers of `list` from `at` on; zero out of the plane, NaN where the list is too short.
    pub fn linear<S: Real>(self, list: &[S], at: usize) -> Vector3<S> {
        spread(self.translations(), list, at)
    }

    /// An angular velocity from the numbers that follow those of [`Directions::linear`] from `at` on; in a plane along its normal.
    pub fn angular<S: Real>(self, list: &[S], at: usize) -> Vector3<S> {
        spread(self.rotations(), list, at + self.translations().len())
    }

    /// Writes the components in which things move from `at` on, as far as `out` is long enough.
    pub fn write_linear<S: Real>(self, out: &mut [S], at: usize, vector: &Vector3<S>) {
        for (slot, &axis) in out.iter_mut().skip(at).zip(self.translations()) {
            *slot = vector[axis];
        }
    }

    /// Writes the components about which bodies turn behind those of [`Directions::write_linear`] from `at` on.
    pub fn write_angular<S: Real>(self, out: &mut [S], at: usize, vector: &Vector3<S>) {
        let slots = out.iter_mut().skip(at + self.translations().len());
        for (slot, &axis) in slots.zip(self.rotations()) {
            *slot = vector[axis];
        }
    }

    /// The components of a linear and of an angular vector in the order of a body's speeds.
    pub fn components<'a, S: Real>(
        self,
        linear: &'a Vector3<S>,
        angular: &'a Vector3<S>,
    ) -> impl Iterator<Item = S> + 'a {
        let moves = self.translations().iter().map(|&axis| linear[axis]);
        moves.chain(self.rotations().iter().map(|&axis| angular[axis]))
    }
}

fn spread<S: Real>(axes: &[usize], list: &[S], at: usize) -> Vector3<S> {
    let mut vector = Vector3::zeros();
    for (offset, &axis) in axes.iter().enumerate() {
        let number = list.get(at + offset).copied();
        vector[axis] = number.unwrap_or_else(|| S::from_f64(f64::NAN));
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_turns_from_the_first_axis_after_the_normal_to_the_second() {
        for (_, plane) in Plane::WORDS {
            let turn = plane.axis().turn(0.1_f64);
            let [from, to] = [1, 2].map(|k| (plane.normal() + k) % 3);
            assert_eq!(
                (turn[(to, from)], turn[(from, to)]),
                (0.1_f64.sin(), -(0.1_f64.sin()))
            );
            assert_eq!(turn[(plane.normal(), plane.normal())], 1.0);
        }
    }

    #[test]
    fn numbers_written_in_a_plane_are_read_back_with_zeros_out_of_it() {
        for (word, plane) in Plane::WORDS {
            let directions = Directions { plane: Some(plane) };
            let (linear, angular) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(4.0, 5.0, 6.0));
            let mut list = [0.0; 3];
            directions.write_linear(&mut list, 0, &linear);
            directions.write_angular(&mut list, 0, &angular);
            let components: Vec<f64> = directions.components(&linear, &angular).collect();
            assert_eq!(components, list, "{word}");
            let read = directions.linear(&list, 0);
            assert_eq!(read[plane.normal()], 0.0);
            assert_eq!(read.sum() + plane.normal() as f64 + 1.0, 6.0);
            assert_eq!(
                directions.angular(&list, 0)[plane.normal()],
                4.0 + plane.normal() as f64
            );
        }
    }
}
