//! The equilibrium point: where the forces of its lines balance (B. Raiszadeh, AAS 03-163).
//!
//! ```text
//! E(p) = Σ ½ K_e (d − L_e)₊² − W·p,   g = ∂E/∂p = −Σ T u − W,   H = Σ J                                          (1)
//! ∂p/∂p_i = H⁻¹ J_i,   Σ ∂p/∂p_i = I                                                                            (2)
//! B_ij = J_i δ_ij − J_i H⁻¹ J_j                                                                                 (3)
//! w = H⁻¹ (Σ J_i v_i + Ẇ)                                                                                      (4)
//! ```
//!
//! E is convex, so every minimiser is global; tensions are unique, the node is unique unless every line is slack and W = 0. Nodes joined by
//! lines share one H, a block Laplacian. Units N, N/m.
//! Singular case: all slack, H = 0. Then (2)–(4) use H + r I and J_i + (r/n) I with r = 1e-15 tr H + 1e-30 N/m: the node follows the mean
//! of its anchors (the slack rule), and taut results change by 1e-15.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::laws::evaluation::Evaluation;
use crate::laws::forces::node_load_rate;
use crate::laws::line;
use crate::scalar::algebra::{elements, fill, labelled, solve_coupled, vector, write};
use crate::{At, Layout, LineEnd, Network, Real};

/// A line of a network in its trial configuration, by the law of a node line.
#[derive(Clone, Copy, Debug)]
pub struct Pulled<S: Real> {
    /// The nodes that it ends at, by their place in the network.
    nodes: [Option<usize>; 2],
    geometry: line::Geometry<S>,
    stiffness: S,
    /// Tension [N].
    pub tension: S,
    /// J, zero when slack.
    block: Matrix3<S>,
    /// Σ over the line's nodes of |p|₁.
    reach: S,
}

impl<S: Real> Pulled<S> {
    /// Between two places [m], each with the node that is there, with K_e [N/m] and L_e [m].
    #[inline]
    pub fn new(ends: [(Option<usize>, Vector3<S>); 2], [stiffness, free_length]: [S; 2]) -> Self {
        let mut reach = S::zero();
        for (_, p) in ends.iter().filter(|(node, _)| node.is_some()) {
            reach += p.x.abs() + p.y.abs() + p.z.abs();
        }
        let [(from, p_from), (to, p_to)] = ends;
        let geometry = line::geometry(&(p_to - p_from), free_length);
        let tension = line::effective_tension(stiffness, geometry.stretch);
        let tangent = line::Tangent::linear(stiffness, free_length);
        let block = line::stiffness(&geometry, &tangent, tension);
        Pulled {
            nodes: [from, to],
            geometry,
            stiffness,
            tension,
            block,
            reach,
        }
    }
}

/// The nodes at the ends of a line, by their place in its network.
fn locals(layout: &Layout, ends: &[LineEnd; 2]) -> [Option<usize>; 2] {
    ends.map(|end| match end {
        LineEnd::Node(node) => layout.nodes.get(node).map(|node| node.local),
        _ => None,
    })
}

fn pulled<S: Real>(layout: &Layout, at: &At<'_, S>, index: usize) -> Option<Pulled<S>> {
    let slots = layout.lines.get(index)?;
    let effective = slots.effective?;
    let numbers = [0, 1].map(|k| at.effective.get(2 * effective + k).copied());
    let [from, to] = slots.ends.map(|end| match end {
        LineEnd::Anchor(anchor) => vector(at.ends, 6 * anchor),
        LineEnd::Node(node) => vector(at.nodes, 3 * node),
        LineEnd::Plain => Vector3::zeros(),
    });
    let [at_from, at_to] = locals(layout, &slots.ends);
    let ends = [(at_from, from), (at_to, to)];
    Some(Pulled::new(ends, [numbers[0]?, numbers[1]?]))
}

/// Writes [`Quantity::Equilibrium`](crate::Quantity::Equilibrium) of one network by (1).
///
/// `name` gives each line's name to the reader of generated code.
pub fn equilibrium<'s, S: Real>(
    layout: &Layout,
    at: &At<'_, S>,
    network: usize,
    name: impl Fn(usize) -> &'s str,
    out: &mut [S],
) {
    let Some(network) = layout.networks.get(network) else {
        return;
    };
    let loads = network
        .nodes
        .iter()
        .map(|node| vector(at.ends, 6 * layout.anchors.len() + 3 * node));
    let lines = network.lines.iter().filter_map(|&index| {
        S::section(name(index));
        pulled(layout, at, index)
    });
    balance(&network.blocks, loads, lines, out);
}

/// Writes (1) in the order of [`Quantity::Equilibrium`](crate::Quantity::Equilibrium): g of nodes under `loads` [N], the `blocks` of H, three sums.
#[inline]
pub fn balance<S: Real>(
    blocks: &[(usize, usize)],
    loads: impl Iterator<Item = Vector3<S>>,
    lines: impl Iterator<Item = Pulled<S>>,
    out: &mut [S],
) {
    out.fill(S::zero());
    let mut first = 0;
    for load in loads {
        write(out, first, &-load);
        first += 3;
    }
    let (nodes, zero) = (first / 3, S::zero());
    let (gradient, rest) = out.split_at_mut(first);
    let (stiffness, sums) = rest.split_at_mut(6 * blocks.len());
    let (gradient, stiffness) = (
        gradient.as_chunks_mut::<3>().0,
        stiffness.as_chunks_mut::<6>().0,
    );
    for line in lines {
        let force = labelled(
            line.geometry.direction.map(|u| line.tension * u),
            ["force_x", "force_y", "force_z"],
        );
        for (node, force) in line.nodes.iter().zip([-force, force]) {
            if let Some(own) = node.and_then(|node| gradient.get_mut(node)) {
                for (sum, &force) in own.iter_mut().zip(&force) {
                    *sum += force;
                }
            }
        }
        for (place, sign) in shares(blocks, nodes, line.nodes) {
            for (slot, element) in stiffness[place].iter_mut().zip(elements(&line.block)) {
                *slot = if sign {
                    *slot + element
                } else {
                    *slot - element
                };
            }
        }
        let taut = zero.le(line.geometry.stretch);
        sums[0] += line.tension;
        sums[1] += S::select(
            taut,
            line.stiffness * (line.geometry.length + line.reach),
            zero,
        );
        sums[2] += S::select(zero.lt(line.geometry.stretch), S::one(), zero);
    }
}

/// The blocks of H that a line at these nodes enters, by their place in `blocks`, each with whether it is added there or subtracted: found and not
/// looked for one by one, so that what a network costs grows with its lines and not with their square.
#[inline]
fn shares(
    blocks: &[(usize, usize)],
    diagonals: usize,
    nodes: [Option<usize>; 2],
) -> impl Iterator<Item = (usize, bool)> {
    // The diagonal comes first, and the pairs follow in order.
    let pairs = blocks.get(diagonals..).unwrap_or_default();
    let pair = match nodes {
        [Some(from), Some(to)] => pairs
            .binary_search(&(from.max(to), from.min(to)))
            .ok()
            .map(|place| (diagonals + place, false)),
        _ => None,
    };
    let own = nodes
        .into_iter()
        .flatten()
        .filter(move |&node| node < diagonals);
    own.map(|node| (node, true)).chain(pair)
}

/// A line by index, the nodes at its ends and its J.
type StiffnessBlock<S> = (usize, [Option<usize>; 2], Matrix3<S>);

/// H + r I of a network and r.
fn regularised<S: Real>(network: &Network, lines: &[StiffnessBlock<S>]) -> (DMatrix<S>, S) {
    let n = network.nodes.len();
    let mut h = DMatrix::from_element(3 * n, 3 * n, S::zero());
    for (_, nodes, block) in lines {
        for (place, sign) in shares(&network.blocks, n, *nodes) {
            let (row, column) = network.blocks[place];
            for i in 0..3 {
                for j in 0..3 {
                    let element = block[(i.min(j), i.max(j))];
                    let slot = &mut h[(3 * row + i, 3 * column + j)];
                    *slot = if sign {
                        *slot + element
                    } else {
                        *slot - element
                    };
                }
            }
        }
    }
    let trace = (0..3 * n).fold(S::zero(), |sum, i| sum + h[(i, i)]);
    let r = S::from_f64(1e-15) * trace + S::from_f64(1e-30);
    for i in 0..3 * n {
        h[(i, i)] += r;
    }
    (h, r)
}

/// The lines of a network with their stiffness at the trial positions in `at`.
fn stiffnesses<S: Real>(
    layout: &Layout,
    at: &At<'_, S>,
    network: &Network,
) -> Vec<StiffnessBlock<S>> {
    let of = |&index: &usize| pulled(layout, at, index).map(|line| (index, line.nodes, line.block));
    network.lines.iter().filter_map(of).collect()
}

/// Right-hand sides J_i + (r/n) I, one an anchor of the network, each with the node whose rows it is in; n counts the anchors of that node.
fn anchor_blocks<'a, S: Real>(
    layout: &'a Layout,
    network: &'a Network,
    lines: &'a [StiffnessBlock<S>],
    r: S,
) -> impl Iterator<Item = (usize, Matrix3<S>)> + 'a {
    let owners = network
        .anchors
        .iter()
        .map(|&anchor| &layout.anchors[anchor]);
    let mut siblings = vec![0_usize; layout.nodes.len()];
    for anchor in owners.clone() {
        siblings[anchor.node] += 1;
    }
    owners.map(move |anchor| {
        let follow = r * S::from_f64(1.0 / siblings[anchor.node] as f64);
        let local = layout.nodes[anchor.node].local;
        let own = lines.iter().find(|(line, ..)| *line == anchor.line);
        let block = own.map_or_else(Matrix3::zeros, |(_, _, block)| {
            Matrix3::from_fn(|i, j| {
                let element = block[(i.min(j), i.max(j))];
                if i == j { element + follow } else { element }
            })
        });
        (local, block)
    })
}

/// ∂p/∂p_i of a network, 3 nodes × 3 anchors, by (2).
fn by_anchor<S: Real>(
    layout: &Layout,
    network: &Network,
    lines: &[StiffnessBlock<S>],
) -> DMatrix<S> {
    let (mut h, r) = regularised(network, lines);
    let width = 3 * network.anchors.len();
    let mut b = DMatrix::from_element(3 * network.nodes.len(), width, S::zero());
    for (index, (local, block)) in anchor_blocks(layout, network, lines, r).enumerate() {
        b.fixed_view_mut::<3, 3>(3 * local, 3 * index)
            .copy_from(&block);
    }
    solve_coupled(&fill(network.nodes.len(), &network.blocks), &mut h, &mut b);
    b
}

/// Writes [`Quantity::NodeByAnchor`](crate::Quantity::NodeByAnchor) of one network.
pub fn node_by_anchor<S: Real>(layout: &Layout, at: &At<'_, S>, network: usize, out: &mut [S]) {
    let Some(network) = layout.networks.get(network) else {
        return;
    };
    let w = by_anchor(layout, network, &stiffnesses(layout, at, network));
    for (slot, &element) in out.iter_mut().zip(w.transpose().iter()) {
        *slot = element;
    }
}

/// Writes [`Quantity::CondensedStiffness`](crate::Quantity::CondensedStiffness) of one network by (3).
pub fn condensed_stiffness<S: Real>(
    layout: &Layout,
    at: &At<'_, S>,
    network: usize,
    out: &mut [S],
) {
    let Some(network) = layout.networks.get(network) else {
        return;
    };
    let lines = stiffnesses(layout, at, network);
    let w = by_anchor(layout, network, &lines);
    let width = 3 * network.anchors.len();
    for (i, &anchor) in network.anchors.iter().enumerate() {
        let anchor = &layout.anchors[anchor];
        let local = layout.nodes[anchor.node].local;
        let Some((_, _, block)) = lines.iter().find(|(line, ..)| *line == anchor.line) else {
            continue;
        };
        let element = |row: usize, column: usize| block[(row.min(column), row.max(column))];
        for row in 0..3 {
            for column in 0..width {
                let mut sum = if column / 3 == i {
                    element(row, column % 3)
                } else {
                    S::zero()
                };
                for k in 0..3 {
                    sum -= element(row, k) * w[(3 * local + k, column)];
                }
                if let Some(slot) = out.get_mut((3 * i + row) * width + column) {
                    *slot = sum;
                }
            }
        }
    }
}

/// Velocities of the nodes of a network without damping at a state, by (4) [m/s].
pub fn velocities<S: Real>(evaluation: &Evaluation<'_, S>, network: usize) -> Vec<Vector3<S>> {
    let layout = evaluation.layout;
    let Some(network) = layout.networks.get(network) else {
        return Vec::new();
    };
    let stiffness_of = |&index: &usize| {
        let motion = evaluation.line_motion(index)?;
        let block = line::stiffness(&motion.geometry, &motion.tangent, motion.tension);
        Some((index, locals(layout, &layout.lines.get(index)?.ends), block))
    };
    let lines: Vec<_> = network.lines.iter().filter_map(stiffness_of).collect();
    let (mut h, r) = regularised(network, &lines);
    let blocks: Vec<_> = anchor_blocks(layout, network, &lines, r).collect();
    let mut b = DMatrix::from_element(3 * network.nodes.len(), 1, S::zero());
    for (&anchor, (local, block)) in network.anchors.iter().zip(&blocks) {
        let velocity = evaluation
            .velocity_of(layout.anchors[anchor].place)
            .unwrap_or_else(Vector3::zeros);
        for row in 0..3 {
            for k in 0..3 {
                b[(3 * local + row, 0)] += block[(row, k)] * velocity[k];
            }
        }
    }
    for (local, &node) in network.nodes.iter().enumerate() {
        let rate = node_load_rate(evaluation, layout.nodes[node].point);
        for row in 0..3 {
            b[(3 * local + row, 0)] += rate[row];
        }
    }
    solve_coupled(&fill(network.nodes.len(), &network.blocks), &mut h, &mut b);
    (0..network.nodes.len())
        .map(|node| Vector3::new(b[(3 * node, 0)], b[(3 * node + 1, 0)], b[(3 * node + 2, 0)]))
        .collect()
}
