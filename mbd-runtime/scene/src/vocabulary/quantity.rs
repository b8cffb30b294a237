//! What a model can be asked for, and where it is asked: the one interface that generic, interpreted and generated code share.

use std::fmt;

use crate::Real;

/// How many numbers [`Quantity::Lines`] has of a line.
pub const LINE_NUMBERS: usize = 10;

/// A quantity of a scene. Its value is a flat list of numbers whose length is [`Layout::len`](crate::Layout::len).
///
/// Frames: world axes unless said otherwise. Signs: tension is positive in tension; forces act *on* the named thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Anchors of the node lines and loads of the nodes: per anchor position and velocity [m, m/s] (6 numbers, in the order of
    /// `Layout::anchors`), then per node its load W (3 numbers) [N]. Reads time, state, inputs.
    AnchorStates,
    /// Balance of one network (index) at trial node positions: the gradient g = −Σ T u − W of the line energy (3 per node) [N], the
    /// blocks of H = ∂g/∂p (6 numbers each: xx xy xz yy yz zz, in the order of `Network::blocks`) [N/m], then three sums: ΣT [N], Σ K_e (d + |p|₁)
    /// over taut lines [N], and the number of lines with positive stretch. Reads `ends`, `nodes` (positions), `effective`.
    Equilibrium(usize),
    /// ẋ of the state x = [q | v | z | s]. Reads everything but `ends`.
    Derivative,
    /// ẋ and what it needs of `rate` nodes at once, for scenes whose nodes are all of that kind ([`Layout::solves_rates`](crate::Layout::solves_rates)): ẋ
    /// with the velocities that balance the lines which [`At::hold`] says carry (> 0); the value of [`Quantity::AnchorStates`]; per node the margin
    /// det D − 1e-5 (tr D)³ of its damping D [N³ s³/m³], without which all of this means nothing, the largest term of a pull and the largest pull
    /// K s + C ṡ of a line that carries [N], and the smallest of ± min(s, K s + C ṡ) over its lines, + of those which carry: negative where one of them
    /// does something else than was said of it; per line, network by network, stretch s [m]. Reads everything but `ends`, of `nodes` nothing.
    Rates,
    /// Balance of all nodes as a function of the state and the node unknowns: Σ T u + W (3 per node) [N]; the residual whose derivatives
    /// carry the node into the linearisation. Reads what `Derivative` reads.
    Balance,
    /// Per line stretch s [m] and pull K s + C ṡ [N] (K_e (d − L_e) for lines of static and stepwise nodes), per stop depth e [m or rad] and
    /// K_s e + C_s ė [N or N m], then one value an event.
    Guards,
    /// The declared outputs, component by component.
    Outputs,
    /// Every measurable joint coordinate and its rate, in pairs: joint by joint, in the order of
    /// [`Scene::joint_coordinates`](crate::Scene::joint_coordinates) [m, m/s or rad, rad/s].
    Coordinates,
    /// The angles whose turns are counted, [`Layout::turns`](crate::Layout::turns), next to their last values in [`At::hold`], each with its rate
    /// [rad, rad/s].
    CountedAngles,
    /// Kinetic, gravitational and elastic energy [J], power of the loads and power of dampers and friction on the bodies and points
    /// [W] (≤ 0 for a damper), power that prescribed motions put in [W].
    Energy,
    /// Linear momentum [kg m/s] and angular momentum about the world origin [kg m²/s]; of bodies and points with mass.
    Momentum,
    /// In relative coordinates the state of every body as absolute coordinates have it: position of the centre of mass [m], attitude as a unit
    /// quaternion w x y z, velocity [m/s], angular velocity in the components of the model [rad/s] (13 numbers; in a plane 6: two of the position, the angle about the normal,
    /// two of the velocity, the angular velocity).
    Bodies,
    /// The mass matrix M, dense, row by row (n_v × n_v); only structural non-zeros are written.
    MassMatrix,
    /// The bias force h (n_v): velocity terms and gravity, M v̇ + h = f.
    BiasForce,
    /// The applied forces f (n_v): lines, loads, and what acts along joint coordinates.
    Forces,
    /// Inverse dynamics: M v̇ + h − f − Φ_vᵀ λ (n_v) at the v̇ and λ of [`At::rows`] [N, N m]: what must act along the speeds besides everything that
    /// acts already.
    InverseDynamics,
    /// What gravity alone asks of h (n_v): h at rest [N, N m]. Held by these forces a scene without lines and loads stands still.
    GravityForce,
    /// Position [m] and velocity [m/s] of the centre of mass of all bodies and points with mass, world axes (6 numbers).
    CentreOfMass,
    /// Its Jacobian, dense, row by row (3 × n_v): velocity = J v; only structural non-zeros are written.
    CentreOfMassJacobian,
    /// The Jacobian of frame (second index) of a body (first), dense, row by row (6 × n_v): velocity of its origin [m/s] and angular velocity [rad/s],
    /// world axes, = J v but for what moves by itself in time; only structural non-zeros are written.
    FrameJacobian(usize, usize),
    /// Per line [`LINE_NUMBERS`] of them: tension [N], length [m], stretch [m], stretch rate [m/s] and the stiffness ∂(force on the `to` end)/∂(position of the `from`
    /// end) = K u uᵀ + (T/d)(I − u uᵀ) (6 numbers: xx xy xz yy yz zz) [N/m].
    Lines,
    /// ∂p/∂(anchor positions) of one network, dense, row by row: (3 nodes) × (3 anchors). Σ over anchors of one node row = I.
    NodeByAnchor(usize),
    /// The stiffness the anchors of one network see through the nodes: −∂(force on anchor i)/∂(position of anchor j), dense, row by row,
    /// (3 anchors) × (3 anchors), symmetric and positive semidefinite [N/m].
    CondensedStiffness(usize),
    /// The constraints Φ (n_c), rows in the order of `Layout::joints` [m or 1]: zero where the joints hold.
    Constraint,
    /// Φ_v, dense, row by row (n_c × n_v); only structural non-zeros are written. Φ̇ = Φ_v v + Φ_t.
    ConstraintJacobian,
    /// Φ̇ = Φ_v v + Φ_t (n_c) [m/s or 1/s]; Φ_t is zero unless a motion is prescribed.
    ConstraintRate,
    /// γ = −(dΦ_v/dt) v − dΦ_t/dt (n_c): Φ_v v̇ = γ holds along every motion of the joints [m/s² or 1/s²].
    ConstraintBias,
    /// The multipliers λ (n_c) of M v̇ + h = f + Φ_vᵀ λ, Φ_v v̇ = γ [N for a row in metres, N m for a row without unit].
    Multipliers,
    /// Per joint, in declaration order: force [N] and torque about the origin of frame 2 [N m] of the joint **on the child**, world axes
    /// (6 numbers); the parent receives the opposite at the same point. What its rows hold, motors among them, and what acts along its coordinates:
    /// springs, dampers, friction, stops, forces; a gear or a lock on its coordinate is a joint of its own. Not unique for a joint that takes part in a
    /// redundancy ([`Redundancy::is_unique`](crate::Redundancy::is_unique)): rows that repeat others carry nothing.
    Reactions,
    /// The mass-weighted smallest move δ (n_v) with Φ_v δ = −r for the rows r of [`At::rows`]: M δ = Φ_vᵀ μ. The projection step; of positions,
    /// with r = Φ, the angular parts of δ are small turns in the components of the state. One more number: how near
    /// the rows are to depending on each other, as the smallest part that other rows leave to a row's pivot [1]; 1 for rows at right angles,
    /// sin² of the angle between two rows, rounding for dependent ones.
    ProjectionStep,
    /// The equations of motion before they are solved, at the accelerations v̇ and multipliers λ of [`At::rows`]: ẋ = [q̇ | v̇ | ż | ṡ] with
    /// M v̇ + h − f − Φ_vᵀ λ [N, N m] in the place of v̇, then Φ_v v̇ − γ (n_c) [m/s² or 1/s²]. What is left out of the system because it
    /// repeats others has no row here: of each joint the rows that are in the system come first, and zeros fill up. What
    /// derivatives through rows are made of.
    Residual,
    /// What the elimination of the system of bodies and joints leaves for [`Quantity::Solve`]; structural zeros are not written. The last number is
    /// the smallest part that other rows leave to the pivot of a row, as in [`Quantity::ProjectionStep`] [1].
    Factor,
    /// The x and y of M x = b + Φ_vᵀ y, Φ_v x = c (n_v, then n_c in the order of [`Quantity::Residual`]), by the factor, b and c in [`At::rows`];
    /// or of k such right-hand sides, the columns of a matrix there and in the result, both row by row: the one list that may be longer than
    /// [`Layout::len`](crate::Layout::len) says.
    Solve,
    /// Per measured coordinate of every joint, in the order of [`Scene::joint_coordinates`](crate::Scene::joint_coordinates): value [m or rad], rate
    /// and acceleration, the latter for the v̇ that [`At::rows`] begins with, or for none.
    JointCoordinates,
    /// The partial derivative of one quantity, dense, row by row; only structural non-zeros are written.
    Partial(Differentiated, Variable),
}

/// The quantities that are differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Differentiated {
    /// [`Quantity::Derivative`].
    Derivative,
    /// [`Quantity::Balance`].
    Balance,
    /// [`Quantity::Outputs`].
    Outputs,
    /// [`Quantity::Residual`], at fixed accelerations and multipliers.
    Residual,
}

/// What they are differentiated by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variable {
    /// The state [q | v | z | s], at fixed node unknowns.
    State,
    /// The node unknowns ([`At::nodes`]).
    Node,
    /// The live parameters.
    Parameter,
    /// The inputs: everything of [`At::inputs`].
    Input,
}

impl Variable {
    /// All of them.
    pub const ALL: [Variable; 4] = [
        Variable::State,
        Variable::Node,
        Variable::Parameter,
        Variable::Input,
    ];
}

impl Differentiated {
    /// The quantity itself.
    #[must_use]
    pub fn quantity(self) -> Quantity {
        match self {
            Differentiated::Derivative => Quantity::Derivative,
            Differentiated::Balance => Quantity::Balance,
            Differentiated::Outputs => Quantity::Outputs,
            Differentiated::Residual => Quantity::Residual,
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Quantity::AnchorStates => "ends of the node lines",
            Quantity::Equilibrium(network) => {
                return write!(f, "equilibrium of network {network}, one iteration");
            }
            Quantity::Derivative => "derivative of the state",
            Quantity::Rates => "derivative of the state with the velocities of its nodes",
            Quantity::Balance => "balance of the equilibrium points",
            Quantity::Guards => "guards of the events",
            Quantity::Outputs => "outputs",
            Quantity::Coordinates => "joint coordinates",
            Quantity::CountedAngles => "angles whose turns are counted",
            Quantity::Energy => "energy",
            Quantity::Momentum => "momentum",
            Quantity::Bodies => "bodies as absolute coordinates have them",
            Quantity::MassMatrix => "mass matrix",
            Quantity::BiasForce => "bias force",
            Quantity::Forces => "applied forces",
            Quantity::InverseDynamics => "inverse dynamics",
            Quantity::GravityForce => "gravity force",
            Quantity::CentreOfMass => "centre of mass",
            Quantity::CentreOfMassJacobian => "Jacobian of the centre of mass",
            Quantity::FrameJacobian(..) => "Jacobian of a frame",
            Quantity::Lines => "lines and their stiffness",
            Quantity::Constraint => "constraints Φ of the joints",
            Quantity::ConstraintJacobian => "Jacobian Φ_v of the constraints",
            Quantity::ConstraintRate => "rate Φ_v v of the constraints",
            Quantity::ConstraintBias => "bias γ of the constraints",
            Quantity::Multipliers => "multipliers of the joints",
            Quantity::Reactions => "reactions of the joints",
            Quantity::ProjectionStep => "correction of the joints (projection)",
            Quantity::Residual => "equations of motion before their solution",
            Quantity::Factor => "factor of the system of bodies and joints",
            Quantity::Solve => "solution by the factor",
            Quantity::JointCoordinates => "joint coordinates",
            Quantity::NodeByAnchor(network) => {
                return write!(f, "∂node/∂anchor of network {network}");
            }
            Quantity::CondensedStiffness(network) => {
                return write!(f, "condensed stiffness of network {network}");
            }
            Quantity::Partial(of, by) => {
                let by = match by {
                    Variable::State => "state",
                    Variable::Node => "node unknowns",
                    Variable::Parameter => "params",
                    Variable::Input => "inputs",
                };
                return write!(f, "∂({})/∂({by})", of.quantity());
            }
        })
    }
}

/// Where a quantity is evaluated: everything it may depend on besides the parameters. A function called twice with the same `At`
/// gives the same bits.
#[derive(Clone, Copy, Debug)]
pub struct At<'a, S> {
    /// Time [s].
    pub time: S,
    /// The state x = [q | v | z | s].
    pub state: &'a [S],
    /// Node unknowns, 3 a node: position [m] (`static`, `stepwise`) or velocity [m/s] (`rate`, whose position is in z).
    pub nodes: &'a [S],
    /// Per line of a static or stepwise node: effective stiffness K_e [N/m] and effective free length L_e [m]. Behind them, per stepwise node with damped
    /// lines, its velocity [m/s], by the difference formula of its lines.
    pub effective: &'a [S],
    /// Per line, then per stop: 0 it decides by its own stretch and pull, +1 it carries K s + C ṡ whatever the sign, −1 it carries nothing. Per
    /// joint that may be detached whether it is; per lock what it holds its coordinate at [m or rad]. Behind them, per angle
    /// whose turns are counted, its last value [rad]; left out: zero, the angle is in (−π, π]. Behind these, of a scene whose
    /// origin follows something, the [seven numbers](crate::laws::origin) of its motion; left out: it is that of the world.
    pub hold: &'a [S],
    /// The value of [`Quantity::AnchorStates`], for [`Quantity::Equilibrium`], [`Quantity::NodeByAnchor`], [`Quantity::CondensedStiffness`].
    pub ends: &'a [S],
    /// Inputs, external loads and external gravity, in the order of `Layout::inputs`.
    pub inputs: &'a [S],
    /// What some quantities are asked with, empty elsewhere: right-hand sides of the rows (n_c) for [`Quantity::ProjectionStep`]; v̇ and λ (n_v, then
    /// n_c, of each joint the rows in the system first) for [`Quantity::Residual`] and [`Quantity::InverseDynamics`], v̇ alone for [`Quantity::JointCoordinates`]; the value of [`Quantity::Factor`], then b (n_v) and c (n_c),
    /// for [`Quantity::Solve`], each of as many columns as are solved for.
    pub rows: &'a [S],
}

impl<'a, S> At<'a, S> {
    /// A time [s], a state x = [q | v | z | s] and inputs, and nothing else: what a scene reads that has no nodes, no lines or springs, no stops, and nothing
    /// that events detach or lock. The other lists are empty; [`At::hold`] of others has [`Layout::holds`](crate::Layout::holds) numbers.
    #[must_use]
    pub fn of_state(time: S, state: &'a [S], inputs: &'a [S]) -> Self {
        At {
            time,
            state,
            nodes: &[],
            effective: &[],
            hold: &[],
            ends: &[],
            inputs,
            rows: &[],
        }
    }
}

/// What an [`At`] borrows, as lists of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Arguments<S> {
    /// See [`At::time`].
    pub time: S,
    /// See [`At::state`].
    pub state: Vec<S>,
    /// See [`At::nodes`].
    pub nodes: Vec<S>,
    /// See [`At::effective`].
    pub effective: Vec<S>,
    /// See [`At::hold`].
    pub hold: Vec<S>,
    /// See [`At::ends`].
    pub ends: Vec<S>,
    /// See [`At::inputs`].
    pub inputs: Vec<S>,
    /// See [`At::rows`].
    pub rows: Vec<S>,
}

impl<S: Real> Default for Arguments<S> {
    fn default() -> Self {
        Arguments {
            time: S::zero(),
            state: Vec::new(),
            nodes: Vec::new(),
            effective: Vec::new(),
            hold: Vec::new(),
            ends: Vec::new(),
            inputs: Vec::new(),
            rows: Vec::new(),
        }
    }
}

impl<S: Real> Arguments<S> {
    /// Takes up the arguments of an evaluation on another scalar.
    pub fn read<T: Copy>(&mut self, at: &At<'_, T>, convert: impl Fn(T) -> S) {
        let copy = |from: &[T], to: &mut Vec<S>| {
            to.clear();
            to.extend(from.iter().map(|&x| convert(x)));
        };
        self.time = convert(at.time);
        copy(at.state, &mut self.state);
        copy(at.nodes, &mut self.nodes);
        copy(at.effective, &mut self.effective);
        copy(at.hold, &mut self.hold);
        copy(at.ends, &mut self.ends);
        copy(at.inputs, &mut self.inputs);
        copy(at.rows, &mut self.rows);
    }

    /// The same on another scalar.
    #[must_use]
    pub fn map<U: Real>(&self, convert: impl Fn(S) -> U) -> Arguments<U> {
        let mut arguments = Arguments::default();
        arguments.read(&self.at(), convert);
        arguments
    }

    /// The arguments of an evaluation here.
    #[must_use]
    pub fn at(&self) -> At<'_, S> {
        At {
            time: self.time,
            state: &self.state,
            nodes: &self.nodes,
            effective: &self.effective,
            hold: &self.hold,
            ends: &self.ends,
            inputs: &self.inputs,
            rows: &self.rows,
        }
    }
}
