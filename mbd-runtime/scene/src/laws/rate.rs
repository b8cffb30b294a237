//! The velocity of a `rate` node where its carrying lines span space: one 3 × 3 system.
//!
//! ```text
//! D w = Σ (K s + C u·v) u + W,   D = Σ C u uᵀ,   over the lines that carry                                       (1)
//! ```
//!
//! u points from the node to the anchor, v is the anchor's velocity, world axes. With v̄ the mean of the anchors' velocities it is solved for
//! w − v̄ with v − v̄ in place of v, which costs no digits when everything falls together. By cofactors, with one division, where
//! D certainly has full rank; elsewhere nothing is taken from it.
//! Source: derived from B. Raiszadeh, AAS 03-163; what else a rate node may need is `node::RateNode` of the runtime.

use nalgebra::Vector3;

use crate::laws::evaluation::Evaluation;
use crate::laws::line::{self, Element};
use crate::scalar::algebra::{solve_regular, write};
use crate::{Layout, LineEnd, Real};

/// (1), line by line.
#[derive(Clone, Copy, Debug)]
pub struct Dashpots<S: Real> {
    /// D: xx xy xz yy yz zz [N s/m].
    pub damping: [S; 6],
    /// The right-hand side [N].
    pub force: Vector3<S>,
}

/// The solution of (1).
#[derive(Clone, Copy, Debug)]
pub struct Slip<S: Real> {
    /// w − v̄ [m/s]; means nothing where D is not certainly regular.
    pub velocity: Vector3<S>,
    /// det D − 1e-5 (tr D)³ [N³ s³/m³]: positive where D certainly has full rank.
    pub margin: S,
}

impl<S: Real> Dashpots<S> {
    /// A node under a load W [N].
    pub fn under(load: Vector3<S>) -> Self {
        Dashpots {
            damping: [S::zero(); 6],
            force: load,
        }
    }

    /// Adds a line that carries: its direction u, its damping C [N s/m], and K s + C u·(v − v̄) [N]; or −u, and that negated.
    pub fn add(&mut self, direction: &Vector3<S>, damping: S, push: S) {
        let u = direction;
        let along = u.map(|x| damping * x);
        let [xx, xy, xz, yy, yz, zz] = &mut self.damping;
        *xx += along.x * u.x;
        *xy += along.x * u.y;
        *xz += along.x * u.z;
        *yy += along.y * u.y;
        *yz += along.y * u.z;
        *zz += along.z * u.z;
        self.force += u.map(|x| push * x);
    }

    /// Solves (1).
    pub fn solve(&self) -> Slip<S> {
        let (velocity, margin) = solve_regular(self.damping, &self.force);
        Slip { velocity, margin }
    }
}

/// The mean of vectors; zero of none.
pub fn mean<S: Real>(vectors: impl Iterator<Item = Vector3<S>>) -> Vector3<S> {
    let (count, sum) = vectors.fold((0_u32, Vector3::zeros()), |(count, sum), vector| {
        (count + 1, sum + vector)
    });
    let share = S::from_f64(1.0 / f64::from(count.max(1)));
    sum.map(|x| share * x)
}

/// How many numbers [`Quantity::Rates`](crate::Quantity::Rates) says of a node beside its velocity.
pub const NODE_CERTIFICATE: usize = 4;

/// Finds the velocities of all nodes of a scene that [solves them with its derivative](Layout::solves_rates), on the lines whose hold is positive,
/// and writes them into `nodes`, 3 a node; into `certificates` what [`Quantity::Rates`](crate::Quantity::Rates) says of nodes and lines; into `balanced`, a line
/// each, its pull and its tension by which the node balances there: what lines do to bodies need not be found anew. Where all lines do what was held of them
/// a line that does not carry has no tension by its own law, either.
pub fn velocities<S: Real>(
    evaluation: &Evaluation<'_, S>,
    nodes: &mut [S],
    certificates: &mut [S],
    balanced: &mut [Option<[S; 2]>],
) {
    let layout = evaluation.layout;
    let (of_nodes, of_lines) = certificates.split_at_mut(NODE_CERTIFICATE * layout.nodes.len());
    let mut written = of_lines.iter_mut();
    let zero = S::zero();
    for (index, network) in layout.networks.iter().enumerate() {
        let anchors = || legs(layout, index).filter_map(|(_, anchor)| layout.anchors.get(anchor));
        let velocity = |place| evaluation.velocity_of(place).unwrap_or_else(Vector3::zeros);
        let mean = mean(anchors().map(|anchor| velocity(anchor.place)));
        let mut dashpots = Dashpots::under(Vector3::zeros());
        let Some(&node) = network.nodes.first() else {
            continue;
        };
        let leg =
            |(line, anchor): (usize, usize)| LineAtState::read(evaluation, line, anchor, &mean);
        for leg in legs(layout, index).filter_map(leg) {
            let numbers = [leg.damping, leg.toward(leg.push)];
            let [damping, push] = numbers.map(|x| S::select(leg.carries, x, zero));
            dashpots.add(&leg.geometry.direction, damping, push);
        }
        let slip = dashpots.solve();
        let (mut largest, mut most, mut agreed) = (None, None, None);
        for leg in legs(layout, index).filter_map(leg) {
            let along = leg.geometry.direction.dot(&slip.velocity);
            let opening = leg.toward(leg.damping * along);
            let size = leg.push.abs() + opening.abs();
            larger(&mut largest, S::select(leg.carries, size, zero));
            let found = (leg.push - opening).label("pull");
            let tension = S::select(leg.carries, found, zero).label("tension");
            larger(&mut most, tension);
            let stretch = leg.geometry.stretch;
            // Of a line that carries both are positive; of another one of them is not.
            let both = stretch.min(found);
            let agrees = both * (leg.hold - S::from_f64(0.5));
            agreed = Some(agreed.map_or(agrees, |least: S| least.min(agrees)));
            if let Some(written) = written.next() {
                *written = stretch;
            }
            if let Some(balanced) = balanced.get_mut(leg.line) {
                *balanced = Some([found, tension]);
            }
        }
        write(nodes, 3 * node, &(mean + slip.velocity));
        let [largest, most] = [largest, most].map(|found| found.unwrap_or(zero));
        let agreed = agreed.unwrap_or(zero).label("agreed");
        let own = of_nodes.get_mut(NODE_CERTIFICATE * node..);
        if let Some(own) = own.and_then(<[S]>::first_chunk_mut) {
            *own = [slip.margin, largest, most, agreed];
        }
    }
}

/// Takes a number that is larger than those before it.
fn larger<S: Real>(most: &mut Option<S>, number: S) {
    *most = Some(most.map_or(number, |most| most.max(number)));
}

/// A line of a `rate` node at a state.
struct LineAtState<S: Real> {
    line: usize,
    /// From its `from` end to its `to` end, as its tension is found.
    geometry: line::Geometry<S>,
    /// Whether that is from the node to the anchor: its direction is u, else −u.
    outward: bool,
    damping: S,
    /// K s + C u·(v − v̄) [N].
    push: S,
    /// Positive where it carries.
    hold: S,
    carries: S::Mask,
}

impl<S: Real> LineAtState<S> {
    /// `mean`: v̄.
    fn read(
        evaluation: &Evaluation<'_, S>,
        line: usize,
        anchor: usize,
        mean: &Vector3<S>,
    ) -> Option<Self> {
        S::section(evaluation.scene.line_name(line));
        let declared = evaluation.scene.lines.get(line)?;
        let slots = evaluation.layout.lines.get(line)?;
        let place = evaluation.layout.anchors.get(anchor)?.place;
        let element = Element::linear(*evaluation.numbers.lines.get(line)?);
        let vector =
            evaluation.position_of(declared.to)? - evaluation.position_of(declared.from)?;
        let geometry = line::geometry(&vector, element.numbers.free_length);
        let outward = matches!(slots.ends, [LineEnd::Node(_), _]);
        let velocity = evaluation.velocity_of(place)?;
        let opening = geometry.direction.dot(&match outward {
            true => velocity - mean,
            false => mean - velocity,
        });
        let hold = evaluation.at.hold.get(line).copied()?;
        Some(LineAtState {
            line,
            outward,
            damping: element.numbers.damping,
            push: element.pull(geometry.stretch, opening),
            hold,
            carries: S::zero().lt(hold),
            geometry,
        })
    }

    /// A number along u as one along the direction of its geometry, and back.
    fn toward(&self, number: S) -> S {
        match self.outward {
            true => number,
            false => -number,
        }
    }
}

/// The lines of a network of one `rate` node, each with its anchor.
pub fn legs(layout: &Layout, network: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
    let lines = layout.networks.get(network).into_iter();
    let lines = lines.flat_map(|network| network.lines.iter().copied());
    lines.filter_map(|line| match layout.lines.get(line)?.ends {
        [LineEnd::Anchor(anchor), LineEnd::Node(_)]
        | [LineEnd::Node(_), LineEnd::Anchor(anchor)] => Some((line, anchor)),
        _ => None,
    })
}
