//! Surfaces as triangles.

use std::collections::BTreeMap;

use super::super::surface::Surface;

/// Triangles with a normal at each corner.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    /// Corners [m].
    pub places: Vec<[f32; 3]>,
    /// Unit vectors outwards.
    pub normals: Vec<[f32; 3]>,
    /// Three corners a triangle, counter-clockwise seen from outside.
    pub corners: Vec<u16>,
}

impl Mesh {
    /// A surface, smooth where it is bent; corners are shared within its parts.
    pub fn of(surface: &Surface) -> Mesh {
        let mut mesh = Mesh::default();
        for part in &surface.parts {
            let mut known = BTreeMap::new();
            for face in &part.faces {
                let corners: Vec<u16> = (face.iter())
                    .filter_map(|corner| {
                        let place = surface.places.get(*corner)?;
                        let new = *known.entry(*corner).or_insert_with(|| {
                            let single = |x: f64| x as f32;
                            mesh.places.push(<[f64; 3]>::from(*place).map(single));
                            mesh.normals
                                .push(<[f64; 3]>::from(part.normal(place)).map(single));
                            mesh.places.len() - 1
                        });
                        u16::try_from(new).ok()
                    })
                    .collect();
                let [first, others @ ..] = corners.as_slice() else {
                    continue;
                };
                for pair in others.windows(2) {
                    mesh.corners.extend([*first, pair[0], pair[1]]);
                }
            }
        }
        mesh
    }
}

#[cfg(test)]
mod tests {
    use mbd_runtime::scene::solids::Solid;

    use super::*;

    #[test]
    fn triangles_turn_outwards_with_unit_normals() {
        let sizes: [(Solid, &[f64]); 5] = [
            (Solid::Box, &[1.0, 2.0, 3.0]),
            (Solid::Cylinder, &[0.3, 1.0]),
            (Solid::Tube, &[0.5, 0.4, 1.0]),
            (Solid::Sphere, &[0.4]),
            (Solid::Capsule, &[0.5, 1.0]),
        ];
        for (solid, sizes) in sizes {
            let mesh = Mesh::of(&Surface::of(solid, sizes));
            assert_eq!(mesh.places.len(), mesh.normals.len());
            for corners in mesh.corners.chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| mesh.places[usize::from(corners[k])]);
                let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
                let face = [
                    u[1] * v[2] - u[2] * v[1],
                    u[2] * v[0] - u[0] * v[2],
                    u[0] * v[1] - u[1] * v[0],
                ];
                for corner in corners {
                    let normal = mesh.normals[usize::from(*corner)];
                    let length: f32 = normal.iter().map(|x| x * x).sum();
                    assert!((length - 1.0).abs() < 1e-5, "{solid:?}");
                    let along: f32 = normal.iter().zip(face).map(|(n, f)| n * f).sum();
                    assert!(along > 0.0, "{solid:?}");
                }
            }
        }
    }

    #[test]
    fn flat_parts_meet_at_edges_and_bent_ones_are_smooth() {
        let corners = |solid, sizes: &[f64]| Mesh::of(&Surface::of(solid, sizes)).places.len();
        assert_eq!(corners(Solid::Box, &[1.0, 1.0, 1.0]), 6 * 4);
        let sphere = Surface::of(Solid::Sphere, &[1.0]);
        assert_eq!(corners(Solid::Sphere, &[1.0]), sphere.places.len());
    }
}
