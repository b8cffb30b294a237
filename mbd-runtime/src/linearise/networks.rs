//! ∂y/∂x of one network of nodes, whatever the rank of its balance.
//!
//! ```text
//! static, stepwise   (H + r 1) ∂p = G_x + r ∂p̄                p̄: mean of the anchors; all slack: H = 0, ∂p = ∂p̄
//! rate               ∂w = D⁺ G_x + (1 − P)(∂V + ∂D D⁺ (w − V))       P = D⁺ D;  V = Σ ω v, ω = 1/n (nothing pulls) or ∝ T/d
//! ```
//!
//! G_x is the partial derivative of the balance Σ T u + W at fixed y; H or D is −G_y. For D of full rank the second term vanishes.

use mbd_scene::laws::line;
use mbd_scene::{At, Float, LineEnd, Model, Network, NodeModel, Quantity, Variable};
use nalgebra::{Matrix3, Vector3};

use super::Matrix;
use crate::node::eigen;
use crate::slopes::{Effective, Slopes};

/// λ_min over λ_max below which a direction of D is missing, as in the rate node.
const RANK: f64 = 1e-6;

/// The balance of one network, ready to solve.
pub(super) struct Elimination<'a, T: Float> {
    network: &'a Network,
    /// −G_y of the network, dense, 3m × 3m, factored for static and stepwise networks.
    dense: Dense<T>,
    /// r of a static or stepwise network; zero for a rate node.
    regular: T,
    /// Whether some node of the network hangs on r alone.
    hangs: bool,
    rate: Option<RateDirections<T>>,
}

/// The eigenvectors of D.
struct RateDirections<T: Float> {
    spanned: Vec<(T, Vector3<T>)>,
    missing: Vec<Vector3<T>>,
}

impl<'a, T: Float> Elimination<'a, T> {
    /// Reads the block of G_y that belongs to a network.
    pub fn new(model: &'a dyn Model<T>, network: usize, by_node: &Matrix<T>) -> Option<Self> {
        let network = model.layout().networks.get(network)?;
        let size = 3 * network.nodes.len();
        let mut dense = Dense::new(size);
        for row in 0..size {
            for column in 0..size {
                let value = by_node.at(slot(network, row), slot(network, column));
                dense.rows[row][column] = -value;
            }
        }
        if network.model == NodeModel::Rate && size == 3 {
            let rate = Some(RateDirections::new(&dense));
            return Some(Elimination {
                network,
                dense,
                regular: T::zero(),
                hangs: false,
                rate,
            });
        }
        let mut trace = T::zero();
        for k in 0..size {
            trace += dense.rows[k][k];
        }
        let regular = T::EPSILON * T::from_f64(4.5) * trace + T::from_f64(1e-30);
        let hangs = (0..size / 3).any(|node| {
            let own = (3 * node..3 * node + 3).fold(T::zero(), |sum, k| sum + dense.rows[k][k]);
            own <= regular * T::from_f64(1e3)
        });
        for k in 0..size {
            dense.rows[k][k] += regular;
        }
        dense.factor();
        Some(Elimination {
            network,
            dense,
            regular,
            hangs,
            rate: None,
        })
    }

    /// Writes the rows of ∂y that belong to the network.
    pub fn solve(
        &self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        by: Variable,
        balance: &Matrix<T>,
        out: &mut Matrix<T>,
    ) {
        let size = 3 * self.network.nodes.len();
        let mut right: Vec<T> = vec![T::zero(); size];
        let deficient = self.hangs
            || self
                .rate
                .as_ref()
                .is_some_and(|rate| !rate.missing.is_empty());
        let ends = deficient.then(|| {
            let rows = model.layout().len(Quantity::AnchorStates);
            let mut ends = Matrix::new(rows, out.columns());
            let scene = (model.scene(), model.layout());
            let mut slopes = Slopes::new(scene.0, scene.1, model.params());
            let of = (Quantity::AnchorStates, by);
            slopes.differentiate(scene, of, Effective::Fixed, at, &mut ends.values);
            ends
        });
        let free = match (&self.rate, &ends) {
            (Some(rate), Some(_)) => FreeMotion::new(model, at, by, self.network, rate),
            _ => None,
        };
        for column in 0..out.columns() {
            for (row, value) in right.iter_mut().enumerate() {
                *value = balance.at(slot(self.network, row), column);
            }
            if let (true, Some(ends)) = (self.hangs, &ends) {
                for (local, &node) in self.network.nodes.iter().enumerate() {
                    let mean = mean_anchor(model, self.network, node, ends, column);
                    for (k, value) in right[3 * local..3 * local + 3].iter_mut().enumerate() {
                        *value += self.regular * mean[k];
                    }
                }
            }
            match &self.rate {
                None => self.balanced(&mut right),
                Some(rate) => {
                    let given = Vector3::new(right[0], right[1], right[2]);
                    let mut found = rate.inverse(&given);
                    if let (Some(free), Some(ends)) = (&free, &ends) {
                        found += rate.complement(&free.motion(ends, column));
                    }
                    right.copy_from_slice(found.as_slice());
                }
            }
            for (row, &value) in right.iter().enumerate() {
                if let Some(target) = out.row_mut(slot(self.network, row)).get_mut(column) {
                    *target = value;
                }
            }
        }
    }
}

impl<T: Float> Elimination<'_, T> {
    /// ∂p of a static or stepwise network from the right-hand side, in place.
    fn balanced(&self, right: &mut [T]) {
        self.dense.solve(right);
        if !self.hangs {
            // Nothing hangs on r: one refinement takes it out again, (H + r 1) δ = b − H ∂p = r ∂p.
            let mut correction: Vec<T> = right.iter().map(|&x| self.regular * x).collect();
            self.dense.solve(&mut correction);
            for (x, dx) in right.iter_mut().zip(correction) {
                *x += dx;
            }
        }
    }
}

/// Row of a network's balance among all nodes.
fn slot(network: &Network, row: usize) -> usize {
    network
        .nodes
        .get(row / 3)
        .map_or(0, |node| 3 * node + row % 3)
}

/// ∂p̄ of the anchors of a node, or of all anchors of the network if it has none.
fn mean_anchor<T: Float>(
    model: &dyn Model<T>,
    network: &Network,
    node: usize,
    ends: &Matrix<T>,
    column: usize,
) -> Vector3<T> {
    let anchors = &model.layout().anchors;
    let own = |&&anchor: &&usize| {
        anchors
            .get(anchor)
            .is_some_and(|anchor| anchor.node == node)
    };
    let has_own = network.anchors.iter().any(|anchor| own(&anchor));
    let (mut sum, mut count) = (Vector3::zeros(), T::zero());
    for &anchor in network
        .anchors
        .iter()
        .filter(|anchor| !has_own || own(anchor))
    {
        sum += column_of(ends, 6 * anchor, column);
        count += T::one();
    }
    sum.map(|x| x / count.max(T::one()))
}

fn column_of<T: Float>(matrix: &Matrix<T>, row: usize, column: usize) -> Vector3<T> {
    Vector3::new(
        matrix.at(row, column),
        matrix.at(row + 1, column),
        matrix.at(row + 2, column),
    )
}

fn triple<T: Float>(list: &[T], at: usize) -> Vector3<T> {
    match list.get(at..at + 3) {
        Some(&[x, y, z]) => Vector3::new(x, y, z),
        _ => Vector3::zeros(),
    }
}

impl<T: Float> RateDirections<T> {
    fn new(dense: &Dense<T>) -> Self {
        let d = Matrix3::from_fn(|row, column| dense.rows[row][column]);
        let all = eigen(&d);
        let limit = all[0].0 * T::from_f64(RANK);
        let spans = |value: T| value > limit && value > T::zero();
        RateDirections {
            spanned: all
                .iter()
                .copied()
                .filter(|(value, _)| spans(*value))
                .collect(),
            missing: all
                .iter()
                .filter(|(value, _)| !spans(*value))
                .map(|(_, vector)| *vector)
                .collect(),
        }
    }

    /// D⁺ b.
    fn inverse(&self, right: &Vector3<T>) -> Vector3<T> {
        let mut sum = Vector3::zeros();
        for (value, vector) in &self.spanned {
            let along = vector.dot(right) / *value;
            sum += vector.map(|x| along * x);
        }
        sum
    }

    /// (1 − P) b.
    fn complement(&self, vector: &Vector3<T>) -> Vector3<T> {
        let mut sum = Vector3::zeros();
        for direction in &self.missing {
            let along = direction.dot(vector);
            sum += direction.map(|x| along * x);
        }
        sum
    }
}

/// How a rate node moves in the directions its lines do not span.
struct FreeMotion<T: Float> {
    legs: Vec<FreeLeg<T>>,
    /// Column of the node's position, for derivatives by the state.
    z: Option<usize>,
}

struct FreeLeg<T: Float> {
    anchor: usize,
    weight: T,
    direction: Vector3<T>,
    inverse_length: T,
    /// C u·D⁺(w − V) of an active line.
    turning: T,
}

impl<T: Float> FreeMotion<T> {
    fn new(
        model: &dyn Model<T>,
        at: &At<'_, T>,
        by: Variable,
        network: &Network,
        rate: &RateDirections<T>,
    ) -> Option<Self> {
        let layout = model.layout();
        let &node = network.nodes.first()?;
        let z = layout.nq + layout.nv + layout.nodes.get(node)?.z?;
        let (position, velocity) = (triple(at.state, z), triple(at.nodes, 3 * node));
        let mut legs = Vec::new();
        let (mut pulls, mut scale) = (T::zero(), T::zero());
        let mut tensions = Vec::new();
        for &index in &network.lines {
            let ends = layout.lines.get(index)?.ends;
            let ([LineEnd::Anchor(anchor), _] | [_, LineEnd::Anchor(anchor)]) = ends else {
                continue;
            };
            let numbers = model.lines().get(index)?;
            let vector = triple(at.ends, 6 * anchor) - position;
            let geometry = line::geometry(&vector, numbers.free_length);
            let slip = triple(at.ends, 6 * anchor + 3) - velocity;
            let active = at.hold.get(index).is_some_and(|hold| *hold > T::zero());
            let law = line::Element::linear(*numbers);
            let pull = law.pull(geometry.stretch, geometry.direction.dot(&slip));
            let tension = if active {
                pull.max(T::zero())
            } else {
                T::zero()
            };
            pulls += tension;
            scale = scale.max(numbers.stiffness * geometry.stretch.abs());
            tensions.push(tension * geometry.inverse_length);
            legs.push(FreeLeg {
                anchor,
                weight: T::zero(),
                direction: geometry.direction,
                inverse_length: geometry.inverse_length,
                turning: if active { numbers.damping } else { T::zero() },
            });
        }
        let carries = pulls > scale * T::EPSILON * T::from_f64(1e4) && pulls > T::zero();
        let mut total = T::zero();
        for (leg, tension) in legs.iter_mut().zip(tensions) {
            leg.weight = if carries { tension } else { T::one() };
            total += leg.weight;
        }
        let mut carried = Vector3::zeros();
        for leg in &mut legs {
            leg.weight /= total;
            carried += triple(at.ends, 6 * leg.anchor + 3).map(|x| leg.weight * x);
        }
        let rotated = rate.inverse(&(velocity - carried));
        for leg in &mut legs {
            leg.turning *= leg.direction.dot(&rotated);
        }
        Some(FreeMotion {
            legs,
            z: (by == Variable::State).then_some(z),
        })
    }

    /// ∂V + ∂D D⁺ (w − V), to be projected on the missing directions.
    fn motion(&self, ends: &Matrix<T>, column: usize) -> Vector3<T> {
        let mut sum = Vector3::zeros();
        for leg in &self.legs {
            sum += column_of(ends, 6 * leg.anchor + 3, column).map(|x| leg.weight * x);
            let mut arm = column_of(ends, 6 * leg.anchor, column);
            if let Some(k) = self
                .z
                .and_then(|z| column.checked_sub(z))
                .filter(|k| *k < 3)
            {
                arm[k] -= T::one();
            }
            let along = leg.direction.dot(&arm);
            let across = arm - leg.direction.map(|u| along * u);
            sum += across.map(|x| leg.turning * leg.inverse_length * x);
        }
        sum
    }
}

/// A small dense matrix with its LU factor by partial pivoting.
struct Dense<T> {
    rows: Vec<Vec<T>>,
    pivots: Vec<usize>,
}

impl<T: Float> Dense<T> {
    fn new(size: usize) -> Self {
        Dense {
            rows: vec![vec![T::zero(); size]; size],
            pivots: (0..size).collect(),
        }
    }

    fn factor(&mut self) {
        let size = self.rows.len();
        for j in 0..size {
            let mut best = j;
            for i in j + 1..size {
                if self.rows[i][j].abs() > self.rows[best][j].abs() {
                    best = i;
                }
            }
            self.rows.swap(j, best);
            self.pivots[j] = best;
            let pivot = self.rows[j].clone();
            if pivot[j] == T::zero() {
                continue;
            }
            for row in self.rows.iter_mut().skip(j + 1) {
                let factor = row[j] / pivot[j];
                row[j] = factor;
                for (x, &p) in row.iter_mut().zip(&pivot).skip(j + 1) {
                    *x -= factor * p;
                }
            }
        }
    }

    /// Solves in place; a direction without a pivot stays zero.
    fn solve(&self, x: &mut [T]) {
        let size = self.rows.len();
        for (j, &pivot) in self.pivots.iter().enumerate() {
            x.swap(j, pivot);
        }
        for j in 0..size {
            for i in j + 1..size {
                let known = x[j];
                x[i] -= self.rows[i][j] * known;
            }
        }
        for i in (0..size).rev() {
            let mut sum = x[i];
            for (&factor, &known) in self.rows[i].iter().zip(x.iter()).skip(i + 1) {
                sum -= factor * known;
            }
            let pivot = self.rows[i][i];
            x[i] = if pivot == T::zero() {
                T::zero()
            } else {
                sum / pivot
            };
        }
    }
}
