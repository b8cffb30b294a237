//! One part of a state: what a generated state hands out and takes by the name of a body or a point.

use mbd_scene::Real;

/// Where a body is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState<T = f64> {
    /// Position of the centre of mass, world axes \[m\].
    pub position: [T; 3],
    /// Attitude: unit quaternion w x y z, body to world.
    pub orientation: [T; 4],
    /// Velocity of the centre of mass, world axes \[m/s\].
    pub velocity: [T; 3],
    /// Angular velocity \[rad/s\], body axes, or world axes where the model declares `angular_velocity: world`.
    pub angular_velocity: [T; 3],
}

/// Where a body of a planar scene is and how it moves. Components in the order of the plane's name: x, z in `xz`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarBodyState<T = f64> {
    /// Position of the centre of mass \[m\].
    pub position: [T; 2],
    /// Turn about the normal of the plane \[rad\].
    pub angle: T,
    /// Velocity of the centre of mass \[m/s\].
    pub velocity: [T; 2],
    /// Rate of the angle \[rad/s\].
    pub angular_velocity: T,
}

/// Where a point with mass is and how it moves: 3 components in world axes, 2 in a planar scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState<T = f64, const D: usize = 3> {
    /// Position \[m\].
    pub position: [T; D],
    /// Velocity \[m/s\].
    pub velocity: [T; D],
}

/// Where a joint of relative coordinates stands and how it moves: its coordinates \[m or rad\], an attitude as a unit quaternion w x y z behind the others; and
/// its speeds \[m/s or rad/s\], those of an attitude the angular velocity of frame 2 against frame 1, in frame-2 axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<const Q: usize, const U: usize, T = f64> {
    /// Coordinates.
    pub coordinates: [T; Q],
    /// Speeds.
    pub speeds: [T; U],
}

impl<T: Real> BodyState<T> {
    /// At rest, along the axes of the world, with its centre of mass here \[m\].
    #[must_use]
    pub fn at(position: [T; 3]) -> Self {
        BodyState {
            position,
            orientation: [T::one(), T::zero(), T::zero(), T::zero()],
            velocity: [T::zero(); 3],
            angular_velocity: [T::zero(); 3],
        }
    }
}

impl<T: Real> PlanarBodyState<T> {
    /// At rest, along the axes of the world, with its centre of mass here \[m\].
    #[must_use]
    pub fn at(position: [T; 2]) -> Self {
        PlanarBodyState {
            position,
            angle: T::zero(),
            velocity: [T::zero(); 2],
            angular_velocity: T::zero(),
        }
    }
}

/// A part of a state as numbers among its coordinates and its speeds.
pub trait StatePart<T>: Sized {
    /// Reads it from where its coordinates and its speeds begin; numbers that are not there are zero.
    fn read(q: &[T], v: &[T]) -> Self;

    /// Writes it to where its coordinates and its speeds begin.
    fn write(self, q: &mut [T], v: &mut [T]);
}

fn first<T: Real, const N: usize>(from: &[T]) -> [T; N] {
    std::array::from_fn(|at| from.get(at).copied().unwrap_or_else(T::zero))
}

fn fill<T>(to: &mut [T], from: impl IntoIterator<Item = T>) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = from);
}

impl<T: Real> StatePart<T> for BodyState<T> {
    fn read(q: &[T], v: &[T]) -> Self {
        let [x, y, z, orientation @ ..] = first::<T, 7>(q);
        let [vx, vy, vz, angular_velocity @ ..] = first::<T, 6>(v);
        BodyState {
            position: [x, y, z],
            orientation,
            velocity: [vx, vy, vz],
            angular_velocity,
        }
    }

    fn write(self, q: &mut [T], v: &mut [T]) {
        fill(q, self.position.into_iter().chain(self.orientation));
        fill(v, self.velocity.into_iter().chain(self.angular_velocity));
    }
}

impl<T: Real> StatePart<T> for PlanarBodyState<T> {
    fn read(q: &[T], v: &[T]) -> Self {
        let ([x, y, angle], [vx, vy, angular_velocity]) = (first(q), first(v));
        PlanarBodyState {
            position: [x, y],
            angle,
            velocity: [vx, vy],
            angular_velocity,
        }
    }

    fn write(self, q: &mut [T], v: &mut [T]) {
        fill(q, self.position.into_iter().chain([self.angle]));
        fill(v, self.velocity.into_iter().chain([self.angular_velocity]));
    }
}

impl<T: Real, const D: usize> StatePart<T> for PointState<T, D> {
    fn read(q: &[T], v: &[T]) -> Self {
        let (position, velocity) = (first(q), first(v));
        PointState { position, velocity }
    }

    fn write(self, q: &mut [T], v: &mut [T]) {
        fill(q, self.position);
        fill(v, self.velocity);
    }
}

impl<T: Real, const Q: usize, const U: usize> StatePart<T> for JointState<Q, U, T> {
    fn read(q: &[T], v: &[T]) -> Self {
        JointState {
            coordinates: first(q),
            speeds: first(v),
        }
    }

    fn write(self, q: &mut [T], v: &mut [T]) {
        fill(q, self.coordinates);
        fill(v, self.speeds);
    }
}

/// Reads the part whose coordinates begin at `at[0]` and whose speeds at `at[1]`.
#[must_use]
pub fn read<T, P: StatePart<T>>(q: &[T], v: &[T], at: [usize; 2]) -> P {
    P::read(
        q.get(at[0]..).unwrap_or_default(),
        v.get(at[1]..).unwrap_or_default(),
    )
}

/// Writes the same.
pub fn write<T, P: StatePart<T>>(part: P, q: &mut [T], v: &mut [T], at: [usize; 2]) {
    part.write(
        q.get_mut(at[0]..).unwrap_or_default(),
        v.get_mut(at[1]..).unwrap_or_default(),
    );
}

/// Where member `index` of a family begins: `count` members from number `first` on, the first of them at `at`, each of this `size`.
#[must_use]
pub fn member(
    index: usize,
    [first, count]: [usize; 2],
    at: [usize; 2],
    size: [usize; 2],
) -> Option<[usize; 2]> {
    let member = index.checked_sub(first).filter(|&member| member < count)?;
    Some([at[0] + member * size[0], at[1] + member * size[1]])
}
