//! Solids as triangles.

use mbd_runtime::scene::solids::Solid;

/// Corners around what is round.
const RIM: usize = 24;
/// Rings of a half ball.
const RINGS: usize = 6;

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
    /// A solid of these sizes [m].
    pub fn of(solid: Solid, sizes: &[f64]) -> Mesh {
        let size = |k: usize| sizes.get(k).copied().unwrap_or(0.0);
        match solid {
            Solid::Box => Mesh::cuboid([size(0), size(1), size(2)]),
            Solid::Cylinder => Mesh::cylinder(size(0), size(1)),
            Solid::Tube => {
                let (outer, inner, half) = (size(0), size(1), 0.5 * size(2));
                let wall = [[outer, -half], [outer, half], [inner, half], [inner, -half]];
                let mut mesh = Mesh::default();
                for k in 0..4 {
                    mesh.turn(&[wall[k], wall[(k + 1) % 4]], None);
                }
                mesh
            }
            Solid::Sphere => Mesh::ball(size(0), 0.0),
            Solid::Capsule => Mesh::ball(size(0), 0.5 * size(1)),
        }
    }

    /// A cylinder about z.
    pub fn cylinder(radius: f64, length: f64) -> Mesh {
        let half = 0.5 * length;
        let mut mesh = Mesh::default();
        for part in [
            [[0.0, -half], [radius, -half]],
            [[radius, -half], [radius, half]],
            [[radius, half], [0.0, half]],
        ] {
            mesh.turn(&part, None);
        }
        mesh
    }

    /// A ball, parted along z by twice `half`.
    fn ball(radius: f64, half: f64) -> Mesh {
        let mut profile = Vec::new();
        for (middle, quarter) in [(-half, -1.0), (half, 0.0)] {
            // The two halves of a ball share their rim.
            let shared = usize::from(half == 0.0 && quarter == 0.0);
            for k in shared..=RINGS {
                let angle = (quarter + k as f64 / RINGS as f64) * std::f64::consts::FRAC_PI_2;
                let across = angle.cos();
                // At the poles rounding would leave slivers.
                let across = if across < 1e-12 { 0.0 } else { across };
                profile.push([radius * across, middle + radius * angle.sin()]);
            }
        }
        let mut mesh = Mesh::default();
        mesh.turn(&profile, Some(half));
        mesh
    }

    fn cuboid(edges: [f64; 3]) -> Mesh {
        let mut mesh = Mesh::default();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let first = mesh.places.len() as u16;
                for [a, b] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                    let mut place = [0.0; 3];
                    (place[axis], place[u], place[v]) = (side, a * side, b);
                    let mut normal = [0.0; 3];
                    normal[axis] = side as f32;
                    mesh.places
                        .push([0, 1, 2].map(|k| (0.5 * place[k] * edges[k]) as f32));
                    mesh.normals.push(normal);
                }
                let quad = [0, 1, 2, 0, 2, 3].map(|k| first + k);
                mesh.corners.extend(quad);
            }
        }
        mesh
    }

    /// Adds what a line through these pairs of radius and height makes, revolved about z; the outside is on its right as it goes up. Smooth across the line where
    /// it bounds a ball, parted by twice `ball`; flat otherwise.
    fn turn(&mut self, profile: &[[f64; 2]], ball: Option<f64>) {
        let first = self.places.len();
        for (k, [radius, height]) in profile.iter().enumerate() {
            let [across, up] = match ball {
                Some(half) => {
                    let middle = if 2 * k < profile.len() { -half } else { half };
                    [*radius, height - middle]
                }
                None => {
                    let [[r0, z0], [r1, z1]] = [profile[0], profile[profile.len() - 1]];
                    [z1 - z0, r0 - r1]
                }
            };
            let length = across.hypot(up).max(f64::MIN_POSITIVE);
            for corner in 0..=RIM {
                let angle = corner as f64 / RIM as f64 * std::f64::consts::TAU;
                let (sin, cos) = angle.sin_cos();
                self.places
                    .push([radius * cos, radius * sin, *height].map(|x| x as f32));
                let normal = [across * cos, across * sin, up];
                self.normals.push(normal.map(|x| (x / length) as f32));
            }
        }
        let row = RIM + 1;
        for k in 0..profile.len() - 1 {
            for corner in 0..RIM {
                let at =
                    |ring: usize, side: usize| (first + (k + ring) * row + corner + side) as u16;
                let [a, b, c, d] = [at(0, 0), at(0, 1), at(1, 1), at(1, 0)];
                // Where the line meets the axis one of the two triangles is none.
                if profile[k][0] > 0.0 {
                    self.corners.extend([a, b, c]);
                }
                if profile[k + 1][0] > 0.0 {
                    self.corners.extend([a, c, d]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The volume inside, by the theorem of Gauss.
    fn volume(mesh: &Mesh) -> f64 {
        let place = |corner: &u16| mesh.places[usize::from(*corner)].map(f64::from);
        let triangles = mesh.corners.chunks_exact(3);
        triangles
            .map(|corners| {
                let [a, b, c] = [place(&corners[0]), place(&corners[1]), place(&corners[2])];
                let cross = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
                (a[0] * cross(1, 2) + a[1] * cross(2, 0) + a[2] * cross(0, 1)) / 6.0
            })
            .sum()
    }

    #[test]
    fn triangles_close_around_the_volume_of_their_solid() {
        let sizes: [(Solid, &[f64]); 5] = [
            (Solid::Box, &[0.2, 0.3, 0.4]),
            (Solid::Cylinder, &[0.3, 1.0]),
            (Solid::Tube, &[0.3, 0.2, 1.0]),
            (Solid::Sphere, &[0.4]),
            (Solid::Capsule, &[0.2, 0.6]),
        ];
        for (solid, sizes) in sizes {
            let mesh = Mesh::of(solid, sizes);
            let (exact, _) = solid.volume_and_moments(sizes);
            let share = volume(&mesh) / exact;
            // Corners lie on the surface: the triangles hold a little less.
            assert!((0.94..1.000_001).contains(&share), "{solid:?}: {share}");
        }
    }

    #[test]
    fn normals_are_unit_vectors_that_look_outwards() {
        for (solid, sizes) in [
            (Solid::Box, vec![1.0, 2.0, 3.0]),
            (Solid::Tube, vec![0.5, 0.4, 1.0]),
            (Solid::Capsule, vec![0.5, 1.0]),
        ] {
            let mesh = Mesh::of(solid, &sizes);
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
}
