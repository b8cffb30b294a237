//! The surfaces of solids: what the player, the drawings that stand still and glTF files show is made of these.

use mbd_runtime::nalgebra::{Matrix3, Vector3};
use mbd_runtime::scene::laws::constant;
use mbd_runtime::scene::solids::{Shape, Solid};
use mbd_runtime::scene::{Formula, Scene, Triple};

/// Corners around what is round.
const RIM: usize = 32;
/// Rings of a half ball.
const RINGS: usize = 8;

/// The surface of a solid, in its own axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Surface {
    /// Corners [m].
    pub places: Vec<Vector3<f64>>,
    /// Its parts, with edges between them; each may hide those before it.
    pub parts: Vec<Patch>,
    /// Radius, and the length between the middles of its two halves [m], where all of it is the skin of a ball that is parted along z.
    pub ball: Option<[f64; 2]>,
}

/// A part without edges inside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Patch {
    /// Flat faces by their corners, counter-clockwise seen from outside.
    pub faces: Vec<Vec<usize>>,
    /// Where a flat part ends, by corners all around; of a bent part nothing.
    pub rims: Vec<Vec<usize>>,
    bend: Bend,
}

/// Where the outside of a part is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bend {
    Flat(Vector3<f64>),
    /// About z: away from it, or towards it.
    Round(f64),
    /// About the nearest place on z that is not farther than this from the middle [m].
    Ball(f64),
}

impl Patch {
    /// The unit vector outwards at one of its corners.
    pub fn normal(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let normal = match self.bend {
            Bend::Flat(normal) => normal,
            Bend::Round(sign) => sign * Vector3::new(place.x, place.y, 0.0),
            Bend::Ball(half) => place - place.z.clamp(-half, half) * Vector3::z(),
        };
        normal.try_normalize(0.0).unwrap_or_else(Vector3::z)
    }

    /// The unit vector outwards of a part that is flat.
    pub fn flat(&self) -> Option<Vector3<f64>> {
        match self.bend {
            Bend::Flat(normal) => Some(normal),
            Bend::Round(_) | Bend::Ball(_) => None,
        }
    }
}

impl Surface {
    /// That of a solid of these sizes [m].
    pub fn of(solid: Solid, sizes: &[f64]) -> Surface {
        let size = |k: usize| sizes.get(k).copied().unwrap_or(0.0);
        match solid {
            Solid::Box => Surface::cuboid([size(0), size(1), size(2)]),
            Solid::Cylinder => Surface::cylinder(size(0), size(1)),
            Solid::Tube => Surface::tube(size(0), size(1), size(2)),
            Solid::Sphere => Surface::ball(size(0), 0.0),
            Solid::Capsule => Surface::ball(size(0), size(1)),
        }
    }

    fn cuboid(edges: [f64; 3]) -> Surface {
        let mut surface = Surface::default();
        for k in 0..8_usize {
            let side = |axis: usize| f64::from(u8::from(k >> axis & 1 == 1)) - 0.5;
            let place = Vector3::from_fn(|axis, _| side(axis) * edges[axis]);
            surface.places.push(place);
        }
        for axis in 0..3 {
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            let (low, high) = (0, 1 << axis);
            let mut outwards = Vector3::zeros();
            outwards[axis] = 1.0;
            surface.flat(vec![vec![low, low + v, low + u + v, low + u]], -outwards);
            surface.flat(vec![vec![high, high + u, high + u + v, high + v]], outwards);
        }
        surface
    }

    fn cylinder(radius: f64, length: f64) -> Surface {
        let mut surface = Surface::default();
        let [low, high] = [-0.5, 0.5].map(|side| surface.ring(radius, side * length));
        surface.wall(&low, &high, Bend::Round(1.0));
        surface.flat(vec![low.into_iter().rev().collect()], -Vector3::z());
        surface.flat(vec![high], Vector3::z());
        surface
    }

    fn tube(outer: f64, inner: f64, length: f64) -> Surface {
        let mut surface = Surface::default();
        let ends = [-0.5, 0.5].map(|side| side * length);
        let [low, high] = ends.map(|z| surface.ring(outer, z));
        let [low_in, high_in] = ends.map(|z| surface.ring(inner, z));
        // What is inside comes first: it is painted over by what is in front of it.
        surface.wall(&high_in, &low_in, Bend::Round(-1.0));
        surface.wall(&low, &high, Bend::Round(1.0));
        surface.wall(&low_in, &low, Bend::Flat(-Vector3::z()));
        surface.wall(&high, &high_in, Bend::Flat(Vector3::z()));
        surface
    }

    /// A ball, parted along z by a length.
    fn ball(radius: f64, length: f64) -> Surface {
        let mut surface = Surface {
            ball: Some([radius, length]),
            ..Surface::default()
        };
        let half = 0.5 * length;
        let mut rings = vec![surface.pole(-half - radius)];
        for (middle, quarter) in [(-half, -1.0), (half, 0.0)] {
            // The two halves of a ball share their rim.
            let shared = usize::from(length == 0.0 && quarter == 0.0);
            let (first, last) = match quarter < 0.0 {
                true => (1, RINGS),
                false => (shared, RINGS - 1),
            };
            for k in first..=last {
                let angle = (quarter + k as f64 / RINGS as f64) * std::f64::consts::FRAC_PI_2;
                rings.push(surface.ring(radius * angle.cos(), middle + radius * angle.sin()));
            }
        }
        rings.push(surface.pole(half + radius));
        let mut faces = Vec::new();
        for pair in rings.windows(2) {
            faces.extend(between(&pair[0], &pair[1]));
        }
        surface.parts.push(Patch {
            faces,
            rims: Vec::new(),
            bend: Bend::Ball(half),
        });
        surface
    }

    /// Corners around z.
    fn ring(&mut self, radius: f64, height: f64) -> Vec<usize> {
        let first = self.places.len();
        self.places.extend((0..RIM).map(|corner| {
            let angle = corner as f64 / RIM as f64 * std::f64::consts::TAU;
            Vector3::new(radius * angle.cos(), radius * angle.sin(), height)
        }));
        (first..first + RIM).collect()
    }

    /// A corner on z, as a ring.
    fn pole(&mut self, height: f64) -> Vec<usize> {
        self.places.push(Vector3::new(0.0, 0.0, height));
        vec![self.places.len() - 1]
    }

    /// What is between two rings; the outside is on the right as it goes from the first to the second.
    fn wall(&mut self, first: &[usize], second: &[usize], bend: Bend) {
        let rims = match bend {
            Bend::Flat(_) => vec![first.to_vec(), second.to_vec()],
            Bend::Round(_) | Bend::Ball(_) => Vec::new(),
        };
        self.parts.push(Patch {
            faces: between(first, second),
            rims,
            bend,
        });
    }

    fn flat(&mut self, faces: Vec<Vec<usize>>, outwards: Vector3<f64>) {
        self.parts.push(Patch {
            rims: faces.clone(),
            faces,
            bend: Bend::Flat(outwards),
        });
    }
}

/// The faces between two rings, of which one may be a single corner.
fn between(first: &[usize], second: &[usize]) -> Vec<Vec<usize>> {
    let count = first.len().max(second.len());
    let at = |ring: &[usize], corner: usize| ring.get(corner % ring.len().max(1)).copied();
    let face = |corner: usize| {
        let mut face: Vec<usize> = [
            at(first, corner),
            at(first, corner + 1),
            at(second, corner + 1),
            at(second, corner),
        ]
        .into_iter()
        .flatten()
        .collect();
        face.dedup();
        face
    };
    (0..count).map(face).collect()
}

/// A solid of a body with its numbers.
#[derive(Clone, Debug)]
pub(super) struct SurfaceSolid {
    pub solid: Solid,
    /// Its sizes [m].
    pub sizes: Vec<f64>,
    /// Its middle from the centre of mass, body axes [m].
    pub at: Vector3<f64>,
    /// Its axes → body axes.
    pub turn: Matrix3<f64>,
}

impl SurfaceSolid {
    /// The solids of a body, with params in declaration order.
    pub fn of_body(scene: &Scene, params: &[f64], body: usize) -> Vec<SurfaceSolid> {
        let number = |formula: &Formula| constant(scene, params, formula);
        let vector = |triple: &Triple| Vector3::from(triple.each_ref().map(number));
        let placed = |shape: &Shape| SurfaceSolid {
            solid: shape.solid,
            sizes: shape.sizes.iter().map(number).collect(),
            at: vector(&shape.position),
            turn: match &shape.rotation {
                Some(rows) => {
                    Matrix3::from_rows(&rows.each_ref().map(|row| vector(row).transpose()))
                }
                None => Matrix3::identity(),
            },
        };
        let own = scene.shapes.iter().filter(|shape| shape.body == body);
        own.map(placed).collect()
    }

    pub fn surface(&self) -> Surface {
        Surface::of(self.solid, &self.sizes)
    }

    /// Whether a place, from the centre of mass along body axes, is inside, or nearer than the margin [m].
    pub fn contains(&self, place: &Vector3<f64>, margin: f64) -> bool {
        let own = self.turn.tr_mul(&(place - self.at));
        self.solid.contains(&self.sizes, own.into(), margin)
    }

    /// A corner of its surface from the centre of mass, body axes [m].
    pub fn on_body(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.at + self.turn * place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOLIDS: [(Solid, &[f64]); 5] = [
        (Solid::Box, &[0.2, 0.3, 0.4]),
        (Solid::Cylinder, &[0.3, 1.0]),
        (Solid::Tube, &[0.3, 0.2, 1.0]),
        (Solid::Sphere, &[0.4]),
        (Solid::Capsule, &[0.2, 0.6]),
    ];

    /// Twice the area of a face, along its normal.
    fn area(surface: &Surface, face: &[usize]) -> Vector3<f64> {
        let corner = |k: usize| surface.places[face[k]];
        (1..face.len() - 1).fold(Vector3::zeros(), |sum, k| {
            sum + (corner(k) - corner(0)).cross(&(corner(k + 1) - corner(0)))
        })
    }

    #[test]
    fn faces_close_around_the_volume_of_their_solid() {
        for (solid, sizes) in SOLIDS {
            let surface = Surface::of(solid, sizes);
            let faces = surface.parts.iter().flat_map(|part| &part.faces);
            // The theorem of Gauss; what is closed has areas whose sum is zero.
            let (mut volume, mut sum) = (0.0, Vector3::zeros());
            for face in faces {
                let area = area(&surface, face);
                volume += surface.places[face[0]].dot(&area) / 6.0;
                sum += area;
            }
            let (exact, _) = solid.volume_and_moments(sizes);
            let share = volume / exact;
            // Corners lie on the surface: the faces hold a little less.
            assert!((0.94..1.000_001).contains(&share), "{solid:?}: {share}");
            assert!(sum.norm() < 1e-12, "{solid:?}: {sum}");
        }
    }

    #[test]
    fn normals_are_unit_vectors_on_the_outside_of_their_faces() {
        for (solid, sizes) in SOLIDS {
            let surface = Surface::of(solid, sizes);
            for part in &surface.parts {
                for face in &part.faces {
                    let outwards = area(&surface, face);
                    for corner in face {
                        let normal = part.normal(&surface.places[*corner]);
                        assert!((normal.norm() - 1.0).abs() < 1e-12, "{solid:?}");
                        assert!(normal.dot(&outwards) > 0.0, "{solid:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn rims_surround_the_flat_parts() {
        let rims = |solid, sizes: &[f64]| -> Vec<usize> {
            let parts = Surface::of(solid, sizes).parts;
            parts.iter().map(|part| part.rims.len()).collect()
        };
        assert_eq!(rims(Solid::Box, &[1.0, 1.0, 1.0]), [1; 6]);
        assert_eq!(rims(Solid::Cylinder, &[1.0, 1.0]), [0, 1, 1]);
        assert_eq!(rims(Solid::Tube, &[1.0, 0.5, 1.0]), [0, 0, 2, 2]);
        assert_eq!(rims(Solid::Sphere, &[1.0]), [0]);
    }
}
