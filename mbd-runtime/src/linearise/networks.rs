//! ∂y/∂x of one network of nodes, whatever the rank of its balance.
//!
//! ```text
//! static, stepwise   (H + r 1) ∂p = G_x + r ∂p̄                p̄: mean of the anchors; all slack: H = 0, ∂p = ∂p̄
//! rate               ∂w = D⁺ G_x + (1 − P)(∂V + ∂D D⁺ (w − V))       P = D⁺ D;  V = Σ ω v, ω = 1/n (nothing pulls) or ∝ T/d
//! ```
//!
//! G_x is the partial derivative of the balance Σ T u + W at fixed y; H or D is −G_y. For D of full rank the second term vanishes.

use mbd_scene::{At, Float, LineEnd, Model, Network, NodeModel, Quantity, TINY, Variable};
use nalgebra::{Cholesky, DMatrix, Dyn, Matrix3, Vector3};

use super::matrix::Matrix;
use crate::node::{RateNode, inverse, own_anchors, projection, spanned, triple};
use crate::slopes::{By, Effective, Slopes};

/// The balance of one network, ready to solve.
pub(super) struct Elimination<'a, T: Float> {
    network: &'a Network,
    factor: Factor<T>,
}

/// −G_y of a network.
enum Factor<T: Float> {
    /// H + r 1 of a static or stepwise network, factored in `f64` (`None` where it is not a number), r, and whether some node hangs on r alone.
    Stiffness(Option<Cholesky<f64, Dyn>>, f64, bool),
    /// The directions of D of a rate node, and how many of them its lines span.
    Damping([(T, Vector3<T>); 3], usize),
}

impl<'a, T: Float> Elimination<'a, T> {
    /// Reads the block of G_y that belongs to a network.
    pub fn new(model: &'a dyn Model<T>, network: usize, by_node: &Matrix<T>) -> Option<Self> {
        let network = model.layout().networks.get(network)?;
        let size = 3 * network.nodes.len();
        let element = |row, column| -by_node.at(slot(network, row), slot(network, column));
        let factor = if network.model == NodeModel::Rate && size == 3 {
            let (directions, rank) = spanned(&Matrix3::from_fn(element));
            Factor::Damping(directions, rank)
        } else {
            let mut h = DMatrix::from_fn(size, size, |row, column| element(row, column).to_f64());
            let regular = 4.5 * T::EPSILON.to_f64() * h.trace() + 1e-30;
            let hangs = (0..size).step_by(3).any(|first| {
                let own: f64 = (first..first + 3).map(|k| h[(k, k)]).sum();
                own <= 1e3 * regular
            });
            (0..size).for_each(|k| h[(k, k)] += regular);
            Factor::Stiffness(h.cholesky(), regular, hangs)
        };
        Some(Elimination { network, factor })
    }

    /// Writes the rows of ∂y that belong to the network.
    pub fn solve(
        &self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        by: impl Into<By>,
        balance: &Matrix<T>,
        out: &mut Matrix<T>,
    ) {
        let by = by.into();
        let (size, columns) = (3 * self.network.nodes.len(), out.columns());
        let mut right = DMatrix::from_fn(size, columns, |row, column| {
            balance.at(slot(self.network, row), column)
        });
        match &self.factor {
            Factor::Stiffness(factor, regular, hangs) => {
                let mut wide = right.map(|x| x.to_f64());
                if *hangs {
                    let ends = ends(model, at, by, columns);
                    self.add_means(model, &ends, *regular, &mut wide);
                }
                match factor {
                    Some(factor) => {
                        factor.solve_mut(&mut wide);
                        if !hangs {
                            // Nothing hangs on r: one refinement takes it out again, (H + r 1) δ = b − H ∂p = r ∂p.
                            wide += factor.solve(&(&wide * *regular));
                        }
                    }
                    None => wide.fill(f64::NAN),
                }
                right = wide.map(T::from_f64);
            }
            Factor::Damping(directions, rank) => {
                let (spanned, missing) = directions.split_at(*rank);
                let free = (!missing.is_empty())
                    .then(|| FreeMotion::new(model, at, by, self.network, spanned))
                    .flatten()
                    .map(|free| (free, ends(model, at, by, columns)));
                for mut column in right.column_iter_mut().enumerate() {
                    let given = Vector3::from_fn(|k, _| column.1[k]);
                    let mut found = inverse(spanned, &given);
                    if let Some((free, ends)) = &free {
                        found += projection(missing, &free.motion(ends, column.0));
                    }
                    column.1.copy_from(&found);
                }
            }
        }
        for (row, values) in right.row_iter().enumerate() {
            let target = out.row_mut(slot(self.network, row)).iter_mut();
            target.zip(values.iter()).for_each(|(to, from)| *to = *from);
        }
    }

    /// Adds r ∂p̄ of the anchors of each node.
    fn add_means(&self, model: &dyn Model<T>, ends: &Matrix<T>, r: f64, right: &mut DMatrix<f64>) {
        for (local, &node) in self.network.nodes.iter().enumerate() {
            let anchors = own_anchors(model.layout(), &self.network.anchors, node);
            let share = r / anchors.len().max(1) as f64;
            for (mut column, index) in right.column_iter_mut().zip(0..) {
                for anchor in &anchors {
                    let moved = column_of(ends, 6 * anchor, index);
                    for k in 0..3 {
                        column[3 * local + k] += share * moved[k].to_f64();
                    }
                }
            }
        }
    }
}

/// ∂(anchors and loads of the nodes).
fn ends<T: Float>(model: &dyn Model<T>, at: &At<'_, T>, by: By, columns: usize) -> Matrix<T> {
    let scene = (model.scene(), model.layout());
    let mut ends = Matrix::new(scene.1.len(Quantity::AnchorStates), columns);
    let mut slopes = Slopes::new(scene.0, scene.1, model.params());
    let of = (Quantity::AnchorStates, by);
    slopes.differentiate(scene, of, Effective::Fixed, at, &mut ends.values);
    ends
}

/// Row of a network's balance among all nodes.
fn slot(network: &Network, row: usize) -> usize {
    let node = network.nodes.get(row / 3);
    node.map_or(0, |node| 3 * node + row % 3)
}

fn column_of<T: Float>(matrix: &Matrix<T>, row: usize, column: usize) -> Vector3<T> {
    Vector3::from_fn(|k, _| matrix.at(row + k, column))
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
    /// C u·D⁺(w − V) / d of an active line.
    turning: T,
}

impl<T: Float> FreeMotion<T> {
    fn new(
        model: &dyn Model<T>,
        at: &At<'_, T>,
        by: By,
        network: &Network,
        spanned: &[(T, Vector3<T>)],
    ) -> Option<Self> {
        let layout = model.layout();
        let &node = network.nodes.first()?;
        let z = layout.nq + layout.nv + layout.nodes.get(node)?.z?;
        let mut anchors = Vec::new();
        let mut rate = RateNode::new(network.lines.len());
        for (index, &line) in network.lines.iter().enumerate() {
            let ends = layout.lines.get(line)?.ends;
            let ([LineEnd::Anchor(anchor), _] | [_, LineEnd::Anchor(anchor)]) = ends else {
                return None;
            };
            let [place, velocity] = [0, 3].map(|k| triple(at.ends, 6 * anchor + k));
            rate.set_leg(index, place, velocity, *model.lines().get(line)?);
            let active = at.hold.get(line).is_some_and(|hold| *hold > T::zero());
            rate.set_mode(index, active, active);
            anchors.push(anchor);
        }
        rate.place(triple(at.state, z), Vector3::zeros());
        let velocity = triple(at.nodes, 3 * node);
        rate.set_velocity(velocity);
        let weights = rate.weights();
        let carried = rate.legs().iter().zip(&weights);
        let carried = carried.map(|(leg, weight)| leg.velocity.map(|x| *weight * x));
        let rotated = inverse(
            spanned,
            &carried.fold(velocity, |rest, carried| rest - carried),
        );
        let legs = anchors.into_iter().zip(rate.legs().iter().zip(weights));
        let legs = legs.map(|(anchor, (leg, weight))| FreeLeg {
            anchor,
            weight,
            direction: leg.direction,
            turning: match leg.active {
                true => {
                    let length = leg.length.max(T::from_f64(TINY));
                    leg.numbers.damping * leg.direction.dot(&rotated) / length
                }
                false => T::zero(),
            },
        });
        Some(FreeMotion {
            legs: legs.collect(),
            z: (by == By::Variable(Variable::State)).then_some(z),
        })
    }

    /// ∂V + ∂D D⁺ (w − V), to be projected on the missing directions.
    fn motion(&self, ends: &Matrix<T>, column: usize) -> Vector3<T> {
        let own = self.z.and_then(|z| column.checked_sub(z));
        let mut sum = Vector3::zeros();
        for leg in &self.legs {
            sum += column_of(ends, 6 * leg.anchor + 3, column).map(|x| leg.weight * x);
            let mut arm = column_of(ends, 6 * leg.anchor, column);
            if let Some(k) = own.filter(|k| *k < 3) {
                arm[k] -= T::one();
            }
            let along = leg.direction.dot(&arm);
            let across = arm - leg.direction.map(|u| along * u);
            sum += across.map(|x| leg.turning * x);
        }
        sum
    }
}
