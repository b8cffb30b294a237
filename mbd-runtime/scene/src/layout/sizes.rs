//! How long the list of every quantity is, and which quantities a scene has a use for.

use crate::laws::rate::NODE_CERTIFICATE;
use crate::layout::{FromSolution, Layout, LineEnd, Network, Node};
use crate::scene::NodeModel;
use crate::{Differentiated, LINE_NUMBERS, Quantity, Scene, Variable};

/// Nodes of the largest network whose sensitivities are spelt out.
const MOST_SPELT_OUT: usize = 8;

impl Layout {
    /// Length of a quantity.
    #[must_use]
    pub fn len(&self, what: Quantity) -> usize {
        match what {
            Quantity::AnchorStates => {
                let moving = self.nodes.iter().filter(|node| node.load_rate.is_some());
                6 * self.anchors.len() + 3 * self.nodes.len() + 3 * moving.count()
            }
            Quantity::Equilibrium(k) => self
                .placed(k)
                .map_or(0, |n| 3 * n.nodes.len() + 6 * n.blocks.len() + 3),
            Quantity::Derivative => self.nx(),
            Quantity::Rates if self.solves_rates() => {
                let lines: usize = self.networks.iter().map(|n| n.lines.len()).sum();
                let ends = self.len(Quantity::AnchorStates);
                self.nx() + ends + NODE_CERTIFICATE * self.nodes.len() + lines
            }
            Quantity::Rates => 0,
            Quantity::Balance => 3 * self.nodes.len(),
            Quantity::Guards => 2 * self.one_way() + self.events,
            Quantity::Outputs => self.columns,
            Quantity::Coordinates => 2 * self.measured,
            Quantity::CountedAngles => 2 * self.turns.len(),
            Quantity::Energy => 6,
            Quantity::Momentum => 6,
            Quantity::Bodies if self.tree.is_some() => self.directions.motion() * self.bodies.len(),
            Quantity::Bodies => 0,
            Quantity::MassMatrix => self.nv * self.nv,
            Quantity::BiasForce
            | Quantity::Forces
            | Quantity::InverseDynamics
            | Quantity::GravityForce => self.nv,
            Quantity::CentreOfMass => 6,
            Quantity::CentreOfMassJacobian => 3 * self.nv,
            Quantity::FrameJacobian(..) => 6 * self.nv,
            Quantity::Lines => LINE_NUMBERS * self.lines.len(),
            Quantity::NodeByAnchor(k) => self
                .placed(k)
                .map_or(0, |n| 9 * n.nodes.len() * n.anchors.len()),
            Quantity::CondensedStiffness(k) => self
                .placed(k)
                .map_or(0, |n| 9 * n.anchors.len() * n.anchors.len()),
            Quantity::Constraint
            | Quantity::ConstraintRate
            | Quantity::ConstraintBias
            | Quantity::Multipliers => self.nc,
            Quantity::ConstraintJacobian => self.nc * self.nv,
            Quantity::Reactions if self.solves() => 6 * self.joints.len(),
            Quantity::ProjectionStep if self.nc > 0 => self.nv + 1,
            Quantity::JointCoordinates => 3 * self.measured,
            Quantity::Residual => self.nx() + self.nc,
            Quantity::Factor => self.factor,
            Quantity::Solve if self.solves() => self.nv + self.nc,
            Quantity::Reactions | Quantity::ProjectionStep | Quantity::Solve => 0,
            Quantity::Partial(of, by) => self.len(of.quantity()) * self.variables(by),
        }
    }

    /// Columns of a quantity that is a matrix; 1 for a list.
    #[must_use]
    pub fn columns_of(&self, what: Quantity) -> usize {
        match what {
            Quantity::MassMatrix
            | Quantity::ConstraintJacobian
            | Quantity::CentreOfMassJacobian
            | Quantity::FrameJacobian(..) => self.nv,
            Quantity::NodeByAnchor(k) | Quantity::CondensedStiffness(k) => {
                self.placed(k).map_or(1, |n| 3 * n.anchors.len())
            }
            Quantity::Partial(_, by) => self.variables(by),
            _ => 1,
        }
    }

    /// What of the solved system a quantity asks for: multipliers, reactions, accelerations.
    #[must_use]
    pub fn asked(&self, what: Quantity) -> FromSolution {
        match what {
            Quantity::Outputs => self.asked[0],
            Quantity::Guards => self.asked[1],
            _ => FromSolution::default(),
        }
    }

    /// Whether a quantity asks for anything of the solved system, such as the effort of a motor.
    #[must_use]
    pub fn asks_efforts(&self, what: Quantity) -> bool {
        self.asked(what).any()
    }

    /// A network whose nodes are placed by the balance of forces at a position. A `rate` node is not: its balance is one of velocities.
    fn placed(&self, network: usize) -> Option<&Network> {
        let found = self.networks.get(network);
        found.filter(|network| network.model != NodeModel::Rate)
    }

    /// Whether ẋ and the velocities of the nodes can be found in one evaluation, [`Quantity::Rates`]: all nodes are `rate` nodes without loads, which
    /// may depend on that velocity, and none is joined to another.
    #[must_use]
    pub fn solves_rates(&self) -> bool {
        let alone = |network: &Network| {
            let anchored = |&line: &usize| {
                let ends = self.lines.get(line).map(|line| line.ends);
                let is_anchor = |end: &LineEnd| matches!(end, LineEnd::Anchor(_));
                ends.is_some_and(|ends| ends.iter().filter(|end| is_anchor(end)).count() == 1)
            };
            network.nodes.len() == 1 && network.lines.iter().all(anchored)
        };
        let rate = |node: &Node| node.model == NodeModel::Rate && !node.loaded;
        !self.nodes.is_empty() && self.nodes.iter().all(rate) && self.networks.iter().all(alone)
    }

    /// How many numbers a variable has.
    #[must_use]
    pub fn variables(&self, by: Variable) -> usize {
        match by {
            Variable::State => self.nx(),
            Variable::Node => 3 * self.nodes.len(),
            Variable::Parameter => self.np,
            Variable::Input => self.ni,
        }
    }

    /// Whether a compiled model spells out the terms of a quantity. ∂node/∂anchor and the condensed stiffness of a large network do not pay:
    /// every node depends on every anchor, so their terms grow with the square of the nodes (463,697 operations for 40 nodes of a chain). A model
    /// evaluates them by solving the network on numbers.
    #[must_use]
    pub fn spells_out(&self, what: Quantity) -> bool {
        match what {
            Quantity::NodeByAnchor(k) | Quantity::CondensedStiffness(k) => {
                let network = self.networks.get(k);
                network.is_some_and(|network| network.nodes.len() <= MOST_SPELT_OUT)
            }
            _ => true,
        }
    }

    /// The quantities that derivatives through rows of joints are made of, in a fixed order; none where joints have no rows. Emitted when asked for
    /// only: a run has no use for them.
    #[must_use]
    pub fn derivatives(&self) -> Vec<Quantity> {
        let mut all = vec![Quantity::Residual, Quantity::Factor, Quantity::Solve];
        let partials = Variable::ALL.map(|by| Quantity::Partial(Differentiated::Residual, by));
        all.extend(partials);
        all.retain(|&what| self.solves() && self.len(what) > 0);
        all
    }

    /// The quantities that no run has a use for, in a fixed order: emitted when asked for only.
    #[must_use]
    pub fn on_request(&self, scene: &Scene) -> Vec<Quantity> {
        let mut all = vec![
            Quantity::InverseDynamics,
            Quantity::GravityForce,
            Quantity::CentreOfMass,
            Quantity::CentreOfMassJacobian,
        ];
        for (body, declared) in scene.bodies.iter().enumerate() {
            let frames = 0..declared.frames.len();
            all.extend(frames.map(|frame| Quantity::FrameJacobian(body, frame)));
        }
        all.retain(|&what| self.nv > 0 && self.len(what) > 0);
        all
    }

    /// Every quantity this scene has a use for, in a fixed order. Joint coordinates are for controllers: of a scene with inputs. Not the derivatives of ẋ where joints have rows: through the factor of the
    /// rows they would take 187,000 operations for eight hinges. They are found from [`Layout::derivatives`] with the factor at hand.
    #[must_use]
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut all = vec![Quantity::AnchorStates];
        all.extend((0..self.networks.len()).map(Quantity::Equilibrium));
        all.extend([
            Quantity::Derivative,
            Quantity::Rates,
            Quantity::Balance,
            Quantity::Guards,
            Quantity::Outputs,
            Quantity::Coordinates,
            Quantity::CountedAngles,
            Quantity::Energy,
            Quantity::Momentum,
            Quantity::Bodies,
            Quantity::MassMatrix,
            Quantity::BiasForce,
            Quantity::Forces,
            Quantity::Lines,
            Quantity::Constraint,
            Quantity::ConstraintJacobian,
            Quantity::ConstraintRate,
            Quantity::ConstraintBias,
            Quantity::Multipliers,
            Quantity::Reactions,
            Quantity::ProjectionStep,
        ]);
        for k in 0..self.networks.len() {
            all.extend([Quantity::NodeByAnchor(k), Quantity::CondensedStiffness(k)]);
        }
        for of in [
            Differentiated::Derivative,
            Differentiated::Balance,
            Differentiated::Outputs,
        ] {
            for by in Variable::ALL {
                all.push(Quantity::Partial(of, by));
            }
        }
        let through_factor = |what| matches!(what, Quantity::Partial(of, _) if self.solves() && (of == Differentiated::Derivative || self.asks_efforts(of.quantity())));
        let undriven = |what| what == Quantity::Coordinates && self.ni == 0;
        all.retain(|&what| self.len(what) > 0 && !through_factor(what) && !undriven(what));
        all
    }
}
