//! Shapes of bodies: what is drawn, and the mass and inertia of even density inside.
//!
//! ```text
//! J = ∫ (|r|² 1 − r rᵀ) dV about the middle of a solid, along its axes; z is the axis of what is round            (1)
//! box a, b, c          V = a b c                     J_x = V (b² + c²)/12, and so on
//! cylinder r, l        V = π r² l                    J_x = V (3 r² + l²)/12            J_z = V r²/2
//! tube r, i, l         V = π (r² − i²) l             J_x = V (3 (r² + i²) + l²)/12     J_z = V (r² + i²)/2
//! sphere r             V = 4/3 π r³                  J = 2/5 V r²
//! capsule r, l         cylinder and sphere, parted:  J_x = V_c (3 r² + l²)/12 + V_s (2/5 r² + 3/8 l r + l²/4)
//! several: c = Σ V p / Σ V;  I = ρ Σ (R J Rᵀ + V (|d|² 1 − d dᵀ)), d = p − c;  m = ρ Σ V                           (2)
//! ```
//!
//! Source: any book on mechanics; half a ball: 83/320 m r² about its own centre of mass, which lies 3/8 r from its flat side. Solids that overlap count twice where they do.

use std::ops::{Add, Div, Mul, Sub};

use serde::{Deserialize, Serialize};

use crate::{Formula, Triple};

/// A shape of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// The body, by index.
    pub body: usize,
    /// What it is.
    pub solid: Solid,
    /// Its sizes [m], in the order of [`Solid::sizes`]; formulas of consts and params.
    pub sizes: Vec<Formula>,
    /// Its middle from the centre of mass, body axes [m].
    pub position: Triple,
    /// Rotation from its axes to body axes: rows of the matrix. `None`: parallel to the body.
    pub rotation: Option<[Triple; 3]>,
}

impl Shape {
    /// Every formula, to be changed.
    pub fn formulas_mut(&mut self) -> impl Iterator<Item = &mut Formula> {
        let rows = self.rotation.iter_mut().flatten().flatten();
        self.sizes.iter_mut().chain(&mut self.position).chain(rows)
    }
}

/// What a shape is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Solid {
    /// Edges along x, y, z.
    Box,
    /// About z.
    Cylinder,
    /// A cylinder with a hole along z.
    Tube,
    /// A ball.
    Sphere,
    /// A cylinder about z with half a ball at either end; `length` is that of the cylinder alone.
    Capsule,
}

/// Numbers that a law of solids is written in: `f64`, or formulas.
pub trait Size:
    Clone
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
}

impl<N> Size for N where
    N: Clone + From<f64> + Add<Output = N> + Sub<Output = N> + Mul<Output = N> + Div<Output = N>
{
}

impl Solid {
    /// All of them.
    pub const ALL: [Solid; 5] = [
        Solid::Box,
        Solid::Cylinder,
        Solid::Tube,
        Solid::Sphere,
        Solid::Capsule,
    ];

    /// Its word in a declaration.
    #[must_use]
    pub const fn keyword(self) -> &'static str {
        match self {
            Solid::Box => "box",
            Solid::Cylinder => "cylinder",
            Solid::Tube => "tube",
            Solid::Sphere => "sphere",
            Solid::Capsule => "capsule",
        }
    }

    /// The names of its sizes; of a box the three are written as a vector.
    #[must_use]
    pub const fn sizes(self) -> &'static [&'static str] {
        match self {
            Solid::Box => &["x", "y", "z"],
            Solid::Cylinder | Solid::Capsule => &["radius", "length"],
            Solid::Tube => &["radius", "inner", "length"],
            Solid::Sphere => &["radius"],
        }
    }

    /// Whether a place in its axes is inside of a solid of these sizes, or nearer to it than the margin, along each of its axes [m].
    #[must_use]
    pub fn contains(self, sizes: &[f64], [x, y, z]: [f64; 3], margin: f64) -> bool {
        let size = |k: usize| sizes.get(k).copied().unwrap_or(f64::NAN);
        let within = |place: f64, half: f64| place.abs() <= half + margin;
        let (across, axis) = (x.hypot(y), |length: f64| within(z, 0.5 * length));
        match self {
            Solid::Box => {
                let mut places = [x, y, z].into_iter().enumerate();
                places.all(|(k, place)| within(place, 0.5 * size(k)))
            }
            Solid::Cylinder => within(across, size(0)) && axis(size(1)),
            Solid::Tube => within(across, size(0)) && across >= size(1) - margin && axis(size(2)),
            Solid::Sphere => within(across.hypot(z), size(0)),
            Solid::Capsule => {
                let beyond = (z.abs() - 0.5 * size(1)).max(0.0);
                within(across.hypot(beyond), size(0))
            }
        }
    }

    /// Volume [m³] and J of (1) [m⁵] of these sizes [m]. Not numbers, where sizes are missing.
    #[must_use]
    pub fn volume_and_moments<N: Size>(self, sizes: &[N]) -> (N, [N; 3]) {
        let n = |x: f64| N::from(x);
        let size = |k: usize| sizes.get(k).cloned().unwrap_or_else(|| n(f64::NAN));
        let square = |x: &N| x.clone() * x.clone();
        let pi = || n(std::f64::consts::PI);
        match self {
            Solid::Box => {
                let [a, b, c] = [size(0), size(1), size(2)];
                let volume = a.clone() * b.clone() * c.clone();
                let squares = [square(&a), square(&b), square(&c)];
                let twelfth = volume.clone() / n(12.0);
                let moment = |i: usize, j: usize| {
                    twelfth.clone() * (squares[i].clone() + squares[j].clone())
                };
                (volume, [moment(1, 2), moment(0, 2), moment(0, 1)])
            }
            Solid::Cylinder => round(pi() * square(&size(0)) * size(1), square(&size(0)), size(1)),
            Solid::Tube => {
                let (outer, inner) = (square(&size(0)), square(&size(1)));
                let volume = pi() * (outer.clone() - inner.clone()) * size(2);
                round(volume, outer + inner, size(2))
            }
            Solid::Sphere => {
                let radius = size(0);
                let volume = n(4.0 / 3.0) * pi() * square(&radius) * radius.clone();
                let moment = n(0.4) * volume.clone() * square(&radius);
                (volume, [moment.clone(), moment.clone(), moment])
            }
            Solid::Capsule => {
                let (radius, length) = (size(0), size(1));
                let (middle, [x, _, z]) = Solid::Cylinder.volume_and_moments(sizes);
                let (ball, [own, ..]) = Solid::Sphere.volume_and_moments(sizes);
                let apart = n(0.375) * length.clone() * radius + n(0.25) * square(&length);
                let across = x + own.clone() + ball.clone() * apart;
                (middle + ball, [across.clone(), across, z + own])
            }
        }
    }
}

/// A body of revolution of a length whose squares of the outer and the inner radius add to `squares`.
fn round<N: Size>(volume: N, squares: N, length: N) -> (N, [N; 3]) {
    let n = |x: f64| N::from(x);
    let across = n(3.0) * squares.clone() + length.clone() * length;
    let across = volume.clone() * across / n(12.0);
    let along = volume.clone() * squares / n(2.0);
    (volume, [across.clone(), across, along])
}

/// A solid in its place.
#[derive(Clone, Debug)]
pub struct PlacedSolid<N> {
    /// What it is.
    pub solid: Solid,
    /// Its sizes [m].
    pub sizes: Vec<N>,
    /// Its middle [m].
    pub position: [N; 3],
    /// Rotation from its axes: rows of the matrix. `None`: parallel.
    pub rotation: Option<[[N; 3]; 3]>,
}

/// What solids of one density are together.
#[derive(Clone, Debug)]
pub struct Lump<N> {
    /// Mass [kg].
    pub mass: N,
    /// Centre of mass [m].
    pub center: [N; 3],
    /// Inertia about it: elements xx, yy, zz, xy, xz, yz of the matrix [kg m²].
    pub inertia: [N; 6],
}

/// How heavy solids are.
#[derive(Clone, Debug)]
pub enum Heaviness<N> {
    /// Their mass altogether [kg].
    Mass(N),
    /// Their density [kg/m³].
    Density(N),
}

/// Rows and columns of the elements of an inertia.
const ELEMENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

impl<N: Size> Lump<N> {
    /// (2) of solids; `None` of none.
    #[must_use]
    pub fn of(solids: &[PlacedSolid<N>], heaviness: Heaviness<N>) -> Option<Self> {
        let parts: Vec<(N, [N; 3])> = solids
            .iter()
            .map(|placed| placed.solid.volume_and_moments(&placed.sizes))
            .collect();
        let volume = parts.iter().map(|(v, _)| v.clone()).reduce(Add::add)?;
        let center = match solids {
            // A quotient of products would leave rounding where there is nothing to share.
            [only] => only.position.clone(),
            _ => {
                let each = solids.iter().zip(&parts);
                [0, 1, 2].map(|k| {
                    let moments = each
                        .clone()
                        .map(|(placed, (v, _))| v.clone() * placed.position[k].clone());
                    let sum = moments.reduce(Add::add);
                    sum.unwrap_or_else(|| N::from(0.0)) / volume.clone()
                })
            }
        };
        let (mass, density) = match heaviness {
            Heaviness::Mass(mass) => (mass.clone(), mass / volume),
            Heaviness::Density(density) => (density.clone() * volume, density),
        };
        let mut inertia = ELEMENTS.map(|_| N::from(0.0));
        for (placed, (v, moments)) in solids.iter().zip(&parts) {
            let offset = match solids {
                [_] => [0, 1, 2].map(|_| N::from(0.0)),
                _ => [0, 1, 2].map(|k| placed.position[k].clone() - center[k].clone()),
            };
            for (element, (i, j)) in inertia.iter_mut().zip(ELEMENTS) {
                let own = rotated(moments, placed.rotation.as_ref(), i, j);
                *element = element.clone() + own + v.clone() * steiner(&offset, i, j);
            }
        }
        Some(Lump {
            mass,
            center,
            inertia: inertia.map(|element| density.clone() * element),
        })
    }
}

/// An element of R diag(J) Rᵀ.
fn rotated<N: Size>(moments: &[N; 3], rotation: Option<&[[N; 3]; 3]>, i: usize, j: usize) -> N {
    match rotation {
        None if i == j => moments[i].clone(),
        None => N::from(0.0),
        Some(rows) => (0..3).fold(N::from(0.0), |sum, k| {
            sum + rows[i][k].clone() * rows[j][k].clone() * moments[k].clone()
        }),
    }
}

/// An element of |d|² 1 − d dᵀ.
fn steiner<N: Size>(d: &[N; 3], i: usize, j: usize) -> N {
    if i != j {
        return N::from(0.0) - d[i].clone() * d[j].clone();
    }
    let others = (0..3).filter(|k| *k != i);
    others.fold(N::from(0.0), |sum, k| sum + d[k].clone() * d[k].clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// J and the volume as sums over small cubes, of a solid inside a cube of half width `half`.
    fn summed(half: f64, solid: Solid, sizes: &[f64]) -> (f64, [f64; 3]) {
        const CELLS: i32 = 120;
        let edge = 2.0 * half / f64::from(CELLS);
        let (mut volume, mut moments) = (0.0, [0.0; 3]);
        let at = |k: i32| (f64::from(k) + 0.5) * edge - half;
        for i in 0..CELLS {
            for j in 0..CELLS {
                for k in 0..CELLS {
                    let [x, y, z] = [at(i), at(j), at(k)];
                    if solid.contains(sizes, [x, y, z], 0.0) {
                        let v = edge * edge * edge;
                        volume += v;
                        let squares = [y * y + z * z, x * x + z * z, x * x + y * y];
                        for (moment, square) in moments.iter_mut().zip(squares) {
                            *moment += v * square;
                        }
                    }
                }
            }
        }
        (volume, moments)
    }

    #[test]
    fn volumes_and_moments_are_the_integrals_they_stand_for() {
        let cases: [(Solid, &[f64]); 5] = [
            (Solid::Box, &[1.2, 0.8, 1.6]),
            (Solid::Cylinder, &[0.5, 1.4]),
            (Solid::Tube, &[0.8, 0.5, 1.4]),
            (Solid::Sphere, &[0.7]),
            (Solid::Capsule, &[0.4, 1.0]),
        ];
        for (solid, sizes) in cases {
            let (volume, moments) = solid.volume_and_moments(sizes);
            let (about, sums) = summed(0.9, solid, sizes);
            assert!(
                (volume / about - 1.0).abs() < 0.01,
                "{solid:?}: {volume} {about}"
            );
            for (moment, sum) in moments.iter().zip(sums) {
                assert!(
                    (moment / sum - 1.0).abs() < 0.015,
                    "{solid:?}: {moment} {sum}"
                );
            }
        }
    }

    #[test]
    fn a_margin_takes_in_what_touches_and_what_has_no_sizes_holds_nothing() {
        let edge = [0.6, 0.4, 0.8];
        let sizes = [1.2, 0.8, 1.6];
        assert!(Solid::Box.contains(&sizes, edge, 1e-9));
        assert!(!Solid::Box.contains(&sizes, [0.7, 0.4, 0.8], 0.05));
        assert!(!Solid::Tube.contains(&[0.4, 0.3, 1.0], [0.0; 3], 0.01));
        for solid in Solid::ALL {
            assert!(!solid.contains(&[], [0.0; 3], 1.0), "{solid:?}");
        }
    }

    fn placed(solid: Solid, sizes: &[f64], position: [f64; 3]) -> PlacedSolid<f64> {
        PlacedSolid {
            solid,
            sizes: sizes.to_vec(),
            position,
            rotation: None,
        }
    }

    #[test]
    fn two_halves_of_a_box_are_the_box() {
        let whole = [placed(Solid::Box, &[2.0, 1.0, 0.5], [0.3, 0.2, 0.1])];
        let halves = [
            placed(Solid::Box, &[1.0, 1.0, 0.5], [-0.2, 0.2, 0.1]),
            placed(Solid::Box, &[1.0, 1.0, 0.5], [0.8, 0.2, 0.1]),
        ];
        let [one, two] = [&whole[..], &halves[..]]
            .map(|solids| Lump::of(solids, Heaviness::Mass(3.0)).expect("solids"));
        for k in 0..3 {
            assert!((one.center[k] - two.center[k]).abs() < 1e-15);
        }
        for k in 0..6 {
            assert!((one.inertia[k] - two.inertia[k]).abs() < 1e-15, "{k}");
        }
    }

    #[test]
    fn a_turned_cylinder_has_its_small_moment_along_its_axis() {
        // A quarter turn about x: its z is −y of the body.
        let mut solid = placed(Solid::Cylinder, &[0.1, 2.0], [0.0; 3]);
        solid.rotation = Some([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]);
        let lump = Lump::of(&[solid], Heaviness::Density(1000.0)).expect("a solid");
        let [xx, yy, zz, xy, xz, yz] = lump.inertia;
        assert!((yy - 0.5 * lump.mass * 0.01).abs() < 1e-12 && (xx - zz).abs() < 1e-12);
        assert!((xx - lump.mass * (0.03 + 4.0) / 12.0).abs() < 1e-12);
        assert_eq!([xy, xz, yz], [0.0; 3]);
        assert!((lump.mass - 1000.0 * std::f64::consts::PI * 0.02).abs() < 1e-12);
    }

    #[test]
    fn nothing_has_no_mass() {
        assert!(Lump::<f64>::of(&[], Heaviness::Mass(1.0)).is_none());
    }
}
