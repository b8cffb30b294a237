//! ∂y/∂x of one network of nodes, whatever the rank of its balance.
//!
//! ```text
//! static, stepwise   (H + r 1) ∂p = G_x + r ∂p̄                p̄: mean of the anchors; all slack: H = 0, ∂p = ∂p̄
//! rate               ∂w = D⁺ G_x + (1 − P)(∂V + ∂D D⁺ (w − V))       P = D⁺ D;  V = Σ ω v, ω = 1/n (nothing pulls) or
//!                    V = Σ ω v + Ẇ/Σ(T/d),  ω ∝ T/d,    ∂V = Σ ω ∂v + (Σ (v − V) ∂(T/d) + ∂Ẇ)/Σ(T/d),   ∂T = ∂T at fixed w − C u·D⁺ G_x
//! ```
//!
//! G_x is the partial derivative of the balance Σ T u + W at fixed y; H or D is −G_y. For D of full rank the second term vanishes. u lies in the span of D.

use mbd_scene::{
    At, Float, LINE_NUMBERS, LineEnd, Model, Network, NodeModel, Quantity, TINY, Variable,
};
use nalgebra::{Cholesky, DMatrix, DMatrixViewMut, Dyn, Matrix3, Vector3};

use super::matrix::Matrix;
use crate::node::{RateNode, inverse, own_anchors, projection, spanned, triple};
use crate::slopes::{DerivativeBy, Effective, Slopes};

/// The balance of one network, with room to solve it again and again.
#[derive(Debug)]
pub(super) struct NetworkElimination<T: Float> {
    /// The network, by number.
    index: usize,
    factor: Factor<T>,
    /// Per node the anchors of its own.
    own: Vec<Vec<usize>>,
    /// ∂(anchors and loads of the nodes).
    ends: Matrix<T>,
    /// ∂(lines) at fixed velocities of the nodes, where a rate node may move across its lines.
    lines: Matrix<T>,
    right: DMatrix<f64>,
    change: DMatrix<f64>,
    free: UnspannedMotion<T>,
}

/// −G_y of a network.
#[derive(Debug)]
enum Factor<T: Float> {
    /// H + r 1 of a static or stepwise network, factored in `f64` (`None` where it is not a number), r, and whether some node hangs on r alone.
    Stiffness(Option<Cholesky<f64, Dyn>>, f64, bool),
    /// The directions of D of a rate node, and how many of them its lines span.
    Damping([(T, Vector3<T>); 3], usize),
}

impl<T: Float> NetworkElimination<T> {
    /// Room for a network of a model.
    pub fn new(model: &dyn Model<T>, index: usize) -> Option<Self> {
        let layout = model.layout();
        let network = layout.networks.get(index)?;
        let own = network.nodes.iter();
        let own = own.map(|&node| own_anchors(layout, &network.anchors, node));
        let free = UnspannedMotion {
            rate: RateNode::new(network.lines.len()),
            legs: Vec::with_capacity(network.lines.len()),
            mean: Vector3::zeros(),
            total: T::zero(),
            load_rate: None,
            z: usize::MAX,
        };
        let damped = network.model == NodeModel::Rate && network.nodes.len() == 1;
        let factor = match damped {
            true => Factor::Damping([(T::zero(), Vector3::zeros()); 3], 3),
            false => Factor::Stiffness(None, 0.0, false),
        };
        let lines = match damped {
            true => layout.len(Quantity::Lines),
            false => 0,
        };
        Some(NetworkElimination {
            index,
            factor,
            own: own.collect(),
            ends: Matrix::new(layout.len(Quantity::AnchorStates), layout.nx()),
            lines: Matrix::new(lines, layout.nx()),
            right: DMatrix::zeros(3 * network.nodes.len(), layout.nx()),
            change: DMatrix::zeros(3 * network.nodes.len(), layout.nx()),
            free,
        })
    }

    /// Reads the block of G_y that belongs to the network.
    pub fn read(&mut self, model: &dyn Model<T>, by_node: &Matrix<T>) {
        let Some(network) = model.layout().networks.get(self.index) else {
            return;
        };
        let element = |row, column| -by_node.at(slot(network, row), slot(network, column));
        let size = 3 * network.nodes.len();
        match &mut self.factor {
            Factor::Damping(directions, rank) => {
                (*directions, *rank) = spanned(&Matrix3::from_fn(element));
            }
            Factor::Stiffness(factor, regular, hangs) => {
                let room = factor.take().map(Cholesky::unpack_dirty);
                let mut h = room.unwrap_or_else(|| DMatrix::zeros(size, size));
                for column in 0..size {
                    for row in 0..size {
                        h[(row, column)] = element(row, column).to_f64();
                    }
                }
                *regular = 4.5 * T::EPSILON.to_f64() * h.trace() + 1e-30;
                *hangs = (0..size).step_by(3).any(|first| {
                    let own: f64 = (first..first + 3).map(|k| h[(k, k)]).sum();
                    own <= 1e3 * *regular
                });
                (0..size).for_each(|k| h[(k, k)] += *regular);
                *factor = Cholesky::new(h);
            }
        }
    }

    /// Writes the rows of ∂y that belong to the network.
    pub fn solve(
        &mut self,
        (model, slopes): (&dyn Model<T>, &mut Slopes),
        at: &At<'_, T>,
        by: impl Into<DerivativeBy>,
        balance: &Matrix<T>,
        out: &mut Matrix<T>,
    ) {
        let Some(network) = model.layout().networks.get(self.index) else {
            return;
        };
        let by = by.into();
        let (size, columns) = (3 * network.nodes.len(), out.columns());
        let given = |row: usize, column: usize| balance.at(slot(network, row), column);
        match &self.factor {
            Factor::Stiffness(factor, regular, hangs) => {
                let mut right = first_columns(&mut self.right, size, columns);
                for column in 0..columns {
                    for row in 0..size {
                        right[(row, column)] = given(row, column).to_f64();
                    }
                }
                if *hangs {
                    let of = (Quantity::AnchorStates, by);
                    differentiate((model, slopes), at, of, &mut self.ends, columns);
                    add_means(&self.own, &self.ends, *regular, &mut right);
                }
                match factor {
                    Some(factor) => {
                        factor.solve_mut(&mut right);
                        if !hangs {
                            // Nothing hangs on r: one refinement takes it out again, (H + r 1) δ = b − H ∂p = r ∂p.
                            let mut change = first_columns(&mut self.change, size, columns);
                            change.copy_from(&right);
                            change *= *regular;
                            factor.solve_mut(&mut change);
                            right += &change;
                        }
                    }
                    None => right.fill(f64::NAN),
                }
                for row in 0..size {
                    let target = out.row_mut(slot(network, row)).iter_mut();
                    for (to, from) in target.zip(right.row(row).iter()) {
                        *to = T::from_f64(*from);
                    }
                }
            }
            Factor::Damping(directions, rank) => {
                let (spanned, missing) = directions.split_at(*rank);
                let free = !missing.is_empty() && self.free.read(model, at, network, spanned);
                if free {
                    for (of, matrix) in [
                        (Quantity::AnchorStates, &mut self.ends),
                        (Quantity::Lines, &mut self.lines),
                    ] {
                        differentiate((model, slopes), at, (of, by), matrix, columns);
                    }
                }
                for column in 0..columns {
                    let mut found = inverse(spanned, &Vector3::from_fn(|k, _| given(k, column)));
                    if free {
                        let own = (by == DerivativeBy::Variable(Variable::State)).then_some(column);
                        let motion = self.free.motion(&self.ends, column, own)
                            + self.free.shift(&self.lines, column, &found);
                        found += projection(missing, &motion);
                    }
                    for (row, x) in found.iter().enumerate() {
                        if let Some(to) = out.row_mut(slot(network, row)).get_mut(column) {
                            *to = *x;
                        }
                    }
                }
            }
        }
    }
}

/// The first columns of a matrix that grows where it has fewer; whatever the elements are.
fn first_columns(
    matrix: &mut DMatrix<f64>,
    rows: usize,
    columns: usize,
) -> DMatrixViewMut<'_, f64> {
    if matrix.nrows() != rows || matrix.ncols() < columns {
        *matrix = DMatrix::zeros(rows, columns);
    }
    matrix.columns_mut(0, columns)
}

/// Adds r ∂p̄ of the anchors of each node.
fn add_means<T: Float>(
    own: &[Vec<usize>],
    ends: &Matrix<T>,
    r: f64,
    right: &mut DMatrixViewMut<'_, f64>,
) {
    for (local, anchors) in own.iter().enumerate() {
        let share = r / anchors.len().max(1) as f64;
        for (mut column, index) in right.column_iter_mut().zip(0..) {
            for anchor in anchors {
                let moved = column_of(ends, 6 * anchor, index);
                for k in 0..3 {
                    column[3 * local + k] += share * moved[k].to_f64();
                }
            }
        }
    }
}

/// Derivatives of a quantity, at fixed node unknowns, K_e and L_e, into a matrix that takes their shape.
fn differentiate<T: Float>(
    (model, slopes): (&dyn Model<T>, &mut Slopes),
    at: &At<'_, T>,
    of: (Quantity, DerivativeBy),
    out: &mut Matrix<T>,
    columns: usize,
) {
    let scene = (model.scene(), model.layout());
    out.reshape(scene.1.len(of.0), columns);
    slopes.differentiate(scene, of, Effective::Fixed, at, &mut out.values);
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
#[derive(Debug)]
struct UnspannedMotion<T: Float> {
    rate: RateNode<T>,
    legs: Vec<FreeLeg<T>>,
    /// V [m/s].
    mean: Vector3<T>,
    /// Σ T/d over the lines that pull [N/m]; zero where none does, and ω are equal.
    total: T,
    /// Where Ẇ is among the anchors and loads, of a node that moves with it.
    load_rate: Option<usize>,
    /// Column of the node's position, for derivatives by the state.
    z: usize,
}

#[derive(Debug)]
struct FreeLeg<T: Float> {
    line: usize,
    anchor: usize,
    weight: T,
    direction: Vector3<T>,
    /// v − V [m/s].
    against: Vector3<T>,
    length: T,
    /// C [N s/m] of an active line.
    damping: T,
    /// C u·D⁺(w − V) / d of an active line.
    turning: T,
}

impl<T: Float> UnspannedMotion<T> {
    /// Reads the lines of a node; false where they are not those of a single node.
    fn read(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        network: &Network,
        spanned: &[(T, Vector3<T>)],
    ) -> bool {
        self.read_lines(model, at, network, spanned).is_some()
    }

    fn read_lines(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        network: &Network,
        spanned: &[(T, Vector3<T>)],
    ) -> Option<()> {
        let layout = model.layout();
        let &node = network.nodes.first()?;
        let slots = layout.nodes.get(node)?;
        self.z = layout.nq + layout.nv + slots.z?;
        let rate = &mut self.rate;
        let anchor = |line: usize| match layout.lines.get(line)?.ends {
            [LineEnd::Anchor(anchor), _] | [_, LineEnd::Anchor(anchor)] => Some(anchor),
            _ => None,
        };
        for (index, &line) in network.lines.iter().enumerate() {
            let anchor = anchor(line)?;
            let [place, velocity] = [0, 3].map(|k| triple(at.ends, 6 * anchor + k));
            rate.set_leg(index, place, velocity, *model.lines().get(line)?);
            let active = at.hold.get(line).is_some_and(|hold| *hold > T::zero());
            rate.set_mode(index, active, active);
        }
        rate.place(triple(at.state, self.z), [Vector3::zeros(); 2]);
        let velocity = triple(at.nodes, 3 * node);
        rate.set_velocity(velocity);
        let carried = rate.legs().iter().zip(rate.weights());
        let carried = carried.map(|(leg, weight)| leg.velocity.map(|x| weight * x));
        self.mean = carried.fold(Vector3::zeros(), |sum, carried| sum + carried);
        self.total = rate.total_weight();
        self.load_rate = slots.load_rate.filter(|_| self.total > T::zero());
        if let Some(slot) = self.load_rate {
            self.mean += triple(at.ends, slot).map(|x| x / self.total);
        }
        let rotated = inverse(spanned, &(velocity - self.mean));
        self.legs.clear();
        let lines = network.lines.iter();
        for ((leg, weight), &line) in rate.legs().iter().zip(rate.weights()).zip(lines) {
            let length = leg.length.max(T::from_f64(TINY));
            let damping = match leg.active {
                true => leg.numbers.damping,
                false => T::zero(),
            };
            self.legs.push(FreeLeg {
                line,
                anchor: anchor(line)?,
                weight,
                direction: leg.direction,
                against: leg.velocity - self.mean,
                length,
                damping,
                turning: damping * leg.direction.dot(&rotated) / length,
            });
        }
        Some(())
    }

    /// Σ (v − V) ∂(T/d)/Σ(T/d) where the node is moved along its lines by ∂w: what V changes by because other lines pull more.
    fn shift(&self, lines: &Matrix<T>, column: usize, moved: &Vector3<T>) -> Vector3<T> {
        let mut sum = Vector3::zeros();
        if self.total > T::zero() {
            // T/d = ω Σ(T/d).
            for leg in self.legs.iter().filter(|leg| leg.weight > T::zero()) {
                let [tension, length] =
                    [0, 1].map(|number| lines.at(LINE_NUMBERS * leg.line + number, column));
                let tension = tension - leg.damping * leg.direction.dot(moved);
                let change = (tension / self.total - leg.weight * length) / leg.length;
                sum += leg.against.map(|x| change * x);
            }
        }
        sum
    }

    /// Σ ω ∂v + ∂Ẇ/Σ(T/d) + ∂D D⁺ (w − V), to be projected on the missing directions; `own` is the column of the state.
    fn motion(&self, ends: &Matrix<T>, column: usize, own: Option<usize>) -> Vector3<T> {
        let own = own.and_then(|column| column.checked_sub(self.z));
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
        if let Some(slot) = self.load_rate {
            sum += column_of(ends, slot, column).map(|x| x / self.total);
        }
        sum
    }
}
