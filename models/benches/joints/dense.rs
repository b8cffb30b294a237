//! The opponent: accelerations by a dense Cholesky of S = Φ_v M⁻¹ Φ_vᵀ, everything allocated beforehand.

use mbd_runtime::{At, Generic, Model, Quantity, Work};

/// Room and structure of one mechanism of bodies.
pub struct Dense {
    /// Φ_v, nc × nv.
    jacobian: Vec<f64>,
    bias: Vec<f64>,
    forces: Vec<f64>,
    accelerations: Vec<f64>,
    /// M⁻¹ per body, 6 × 6: constant in body components.
    inverse: Vec<[[f64; 6]; 6]>,
    /// Φ_v M⁻¹ of a joint on a body: rows of six numbers.
    weighted: Vec<[f64; 6]>,
    /// S, then its factor, row by row.
    s: Vec<f64>,
    lambda: Vec<f64>,
    /// Joints on each body: first row and number of rows.
    on: Vec<Vec<(usize, usize)>>,
    nv: usize,
    nc: usize,
}

impl Dense {
    /// Room for a model, and what of it is constant.
    pub fn new(model: &Generic<f64>, at: &At<'_, f64>) -> Self {
        let layout = model.layout();
        let (nv, nc) = (layout.nv, layout.nc);
        let mut mass = vec![0.0; nv * nv];
        model.evaluate(Quantity::MassMatrix, at, &mut model.work(), &mut mass);
        let inverse = layout.own_bodies().map(|(_, slots)| {
            let block = |i: usize, j: usize| mass[(slots.v + i) * nv + slots.v + j];
            invert(std::array::from_fn(|i| {
                std::array::from_fn(|j| block(i, j))
            }))
        });
        let mut on = vec![Vec::new(); layout.bodies.len()];
        for slots in &layout.joints {
            for end in slots.ends.iter().flatten() {
                if let mbd_runtime::scene::Part::Body(body) = *end {
                    on[body].push((slots.row, slots.len));
                }
            }
        }
        Dense {
            inverse: inverse.collect(),
            jacobian: vec![0.0; nc * nv],
            bias: vec![0.0; nv],
            forces: vec![0.0; nv],
            accelerations: vec![0.0; nv],
            weighted: vec![[0.0; 6]; nc],
            s: vec![0.0; nc * nc],
            lambda: vec![0.0; nc],
            on,
            nv,
            nc,
        }
    }

    /// v̇.
    pub fn accelerations(
        &mut self,
        model: &Generic<f64>,
        at: &At<'_, f64>,
        work: &mut Work<f64>,
    ) -> &[f64] {
        let (nv, nc) = (self.nv, self.nc);
        model.evaluate(Quantity::ConstraintJacobian, at, work, &mut self.jacobian);
        model.evaluate(Quantity::ConstraintBias, at, work, &mut self.lambda);
        model.evaluate(Quantity::BiasForce, at, work, &mut self.bias);
        model.evaluate(Quantity::Forces, at, work, &mut self.forces);
        self.s.fill(0.0);
        for (body, (inverse, joints)) in self.inverse.iter().zip(&self.on).enumerate() {
            let v = 6 * body;
            let free: [f64; 6] = std::array::from_fn(|i| self.forces[v + i] - self.bias[v + i]);
            let own = &mut self.accelerations[v..v + 6];
            for (acceleration, row) in own.iter_mut().zip(inverse) {
                *acceleration = dot(row, &free);
            }
            for &(first, len) in joints {
                for row in first..first + len {
                    let line = &self.jacobian[row * nv + v..row * nv + v + 6];
                    for (weighted, row) in self.weighted[row].iter_mut().zip(inverse) {
                        *weighted = dot(row, line);
                    }
                    self.lambda[row] -= dot(line, &self.accelerations[v..v + 6]);
                }
            }
            for &(first, len) in joints {
                for &(other, count) in joints.iter().filter(|(other, _)| *other <= first) {
                    for row in first..first + len {
                        for column in other..(other + count).min(row + 1) {
                            let line = &self.jacobian[column * nv + v..column * nv + v + 6];
                            self.s[row * nc + column] += dot(&self.weighted[row], line);
                        }
                    }
                }
            }
        }
        cholesky(&mut self.s, nc);
        solve(&self.s, &mut self.lambda);
        for (body, (inverse, joints)) in self.inverse.iter().zip(&self.on).enumerate() {
            let v = 6 * body;
            let mut push = [0.0; 6];
            for &(first, len) in joints {
                for row in first..first + len {
                    let line = &self.jacobian[row * nv + v..row * nv + v + 6];
                    for (push, x) in push.iter_mut().zip(line) {
                        *push += self.lambda[row] * x;
                    }
                }
            }
            let own = &mut self.accelerations[v..v + 6];
            for (acceleration, row) in own.iter_mut().zip(inverse) {
                *acceleration += dot(row, &push);
            }
        }
        &self.accelerations
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// S = L Lᵀ in place, row by row.
fn cholesky(s: &mut [f64], n: usize) {
    for i in 0..n {
        let (above, row) = s.split_at_mut(i * n);
        for j in 0..i {
            let other = &above[j * n..j * n + n];
            row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
        }
        row[i] = (row[i] - dot(&row[..i], &row[..i])).sqrt();
    }
}

/// L Lᵀ x = b in place.
fn solve(l: &[f64], b: &mut [f64]) {
    let n = b.len();
    for i in 0..n {
        b[i] = (b[i] - dot(&l[i * n..i * n + i], &b[..i])) / l[i * n + i];
    }
    for i in (0..n).rev() {
        b[i] /= l[i * n + i];
        let (before, value) = (&l[i * n..i * n + i], b[i]);
        for (x, factor) in b[..i].iter_mut().zip(before) {
            *x -= factor * value;
        }
    }
}

/// The inverse of a positive 6 × 6 matrix, by Gauss and Jordan.
fn invert(mut a: [[f64; 6]; 6]) -> [[f64; 6]; 6] {
    let mut inverse: [[f64; 6]; 6] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for pivot in 0..6 {
        let scale = 1.0 / a[pivot][pivot];
        a[pivot] = a[pivot].map(|x| x * scale);
        inverse[pivot] = inverse[pivot].map(|x| x * scale);
        let (line, right) = (a[pivot], inverse[pivot]);
        for row in (0..6).filter(|&row| row != pivot) {
            let factor = a[row][pivot];
            for (to, from) in [(&mut a[row], &line), (&mut inverse[row], &right)] {
                for (x, y) in to.iter_mut().zip(from) {
                    *x -= factor * y;
                }
            }
        }
    }
    inverse
}
