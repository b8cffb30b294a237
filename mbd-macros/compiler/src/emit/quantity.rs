//! What each quantity is called in generated code, and what its documentation says.

use mbd_scene::{Differentiated, Layout, Quantity, Scene, Variable};

use crate::names::identifier;

/// The name of the function of a quantity.
#[must_use]
pub fn name(scene: &Scene, layout: &Layout, what: Quantity) -> String {
    let network = |k: usize| {
        let nodes = layout.networks.get(k).and_then(|n| n.nodes.first());
        let point = nodes
            .and_then(|&node| layout.nodes.get(node))
            .map(|node| node.point);
        let found = point.and_then(|point| scene.points.get(point));
        found.map_or_else(|| k.to_string(), |point| identifier(&point.name))
    };
    match what {
        Quantity::Equilibrium(k) | Quantity::NodeByAnchor(k) | Quantity::CondensedStiffness(k) => {
            format!("{}_{}", kind(what), network(k))
        }
        Quantity::Partial(of, by) => format!("{}_by_{}", differentiated(of), variable(by)),
        Quantity::FrameJacobian(body, frame) => {
            let owner = scene.bodies.get(body);
            let own = owner.and_then(|body| body.frames.get(frame));
            let [body, frame] = [owner.map(|body| &body.name), own.map(|frame| &frame.name)]
                .map(|name| name.map_or_else(String::new, |name| identifier(name)));
            format!("{}_{body}_{frame}", kind(what))
        }
        _ => kind(what).to_owned(),
    }
}

/// What `emit: […]` calls a kind of quantity.
#[must_use]
pub fn kind(what: Quantity) -> &'static str {
    match what {
        Quantity::AnchorStates => "anchor_states",
        Quantity::Equilibrium(_) => "equilibrium",
        Quantity::Derivative => "derivative",
        Quantity::Rates => "rates",
        Quantity::Balance => "balance",
        Quantity::Guards => "guards",
        Quantity::Outputs => "outputs",
        Quantity::Coordinates => "coordinates",
        Quantity::CountedAngles => "counted_angles",
        Quantity::Energy => "energy",
        Quantity::Momentum => "momentum",
        Quantity::Bodies => "bodies",
        Quantity::MassMatrix => "mass_matrix",
        Quantity::BiasForce => "bias_force",
        Quantity::Forces => "forces",
        Quantity::InverseDynamics => "inverse_dynamics",
        Quantity::GravityForce => "gravity_force",
        Quantity::CentreOfMass => "centre_of_mass",
        Quantity::CentreOfMassJacobian => "centre_of_mass_jacobian",
        Quantity::FrameJacobian(..) => "frame_jacobian",
        Quantity::Lines => "lines",
        Quantity::Constraint => "constraint",
        Quantity::ConstraintJacobian => "constraint_jacobian",
        Quantity::ConstraintRate => "constraint_rate",
        Quantity::ConstraintBias => "constraint_bias",
        Quantity::Multipliers => "multipliers",
        Quantity::Reactions => "reactions",
        Quantity::ProjectionStep => "projection_step",
        Quantity::Residual => "residual",
        Quantity::Factor => "factor",
        Quantity::Solve => "solve",
        Quantity::JointCoordinates => "joint_coordinates",
        Quantity::NodeByAnchor(_) => "node_by_anchor",
        Quantity::CondensedStiffness(_) => "condensed_stiffness",
        Quantity::Partial(..) => "partial",
    }
}

fn differentiated(of: Differentiated) -> &'static str {
    match of {
        Differentiated::Derivative => "derivative",
        Differentiated::Balance => "balance",
        Differentiated::Outputs => "outputs",
        Differentiated::Residual => "residual",
    }
}

fn variable(by: Variable) -> &'static str {
    match by {
        Variable::State => "state",
        Variable::Node => "nodes",
        Variable::Parameter => "params",
        Variable::Input => "inputs",
    }
}

/// What a quantity is: its equation, and its shape with units.
#[must_use]
pub fn documentation(layout: &Layout, what: Quantity) -> [String; 2] {
    let (nx, nv, n) = (layout.nx(), layout.nv, layout.len(what));
    let (text, shape) = match what {
        Quantity::AnchorStates => {
            let (anchors, nodes) = (layout.anchors.len(), layout.nodes.len());
            let moving = layout.nodes.iter().filter(|node| node.load_rate.is_some());
            match moving.count() {
                0 => (
                    "Anchors of the node lines and loads of the nodes: `p`, `v` of each anchor, then `W` of each node.",
                    format!("{anchors} anchors × 6 [m, m/s], {nodes} nodes × 3 [N]; world axes."),
                ),
                moving => (
                    "Anchors of the node lines and loads of the nodes: `p`, `v` of each anchor, then `W` of each node, then `Ẇ` of those whose loads move.",
                    format!(
                        "{anchors} anchors × 6 [m, m/s], {nodes} nodes × 3 [N], {moving} × 3 [N/s]; world axes."
                    ),
                ),
            }
        }
        Quantity::Equilibrium(k) => {
            let (nodes, blocks) = layout
                .networks
                .get(k)
                .map_or((0, 0), |n| (n.nodes.len(), n.blocks.len()));
            (
                "Balance of a network at trial positions: `g = −Σ T u − W`, `H = ∂g/∂p = Σ J`, then `ΣT`, `Σ K (d + |p|₁)`, lines with stretch.",
                format!(
                    "{nodes} × 3 [N], {blocks} blocks xx xy xz yy yz zz [N/m], 3 sums. Source: B. Raiszadeh, AAS 03-163."
                ),
            )
        }
        Quantity::Derivative => (
            if layout.nc == 0 {
                "State derivative: `q̇ = N(q) v`, `v̇ = M⁻¹ (f − h)`, `ż = w`."
            } else {
                "State derivative: `q̇ = N(q) v`, `v̇` of `M v̇ + h = f + Φ_vᵀ λ`, `Φ_v v̇ = γ`, `ż = w`."
            },
            match layout.ns {
                0 => format!(
                    "{nx} = [{} q̇ | {nv} v̇ | {} ż]; SI units.",
                    layout.nq, layout.nz
                ),
                own => format!(
                    "{nx} = [{} q̇ | {nv} v̇ | {} ż | {own} ṡ as declared]; SI units.",
                    layout.nq, layout.nz
                ),
            },
        ),
        Quantity::Rates => (
            "State derivative with the velocities of the nodes found along with it, `D w = Σ (K s + C u·v) u` over the lines that carry.",
            format!(
                "{nx} ẋ, then {} anchors × 6 [m, m/s], {} nodes × 3 loads [N], per node `det D − 1e-5 (tr D)³` [N³ s³/m³], the largest term of a pull and the largest pull [N], whether its lines do what was held of them (> 0), per line stretch [m].",
                layout.anchors.len(),
                layout.nodes.len(),
            ),
        ),
        Quantity::Balance => (
            "Balance of the nodes: `r = Σ T u + W`, the forces on each node.",
            format!("{n} [N], world axes; zero where the nodes are in equilibrium."),
        ),
        Quantity::Guards => (
            "Guards: stretch `s = d − L0` and pull `K s + C ṡ` of each line, depth and pull of each stop, then the declared events.",
            format!(
                "{} lines × 2 [m, N], {} stops × 2 [m, N or rad, N m], {} events.",
                layout.lines.len(),
                layout.stops.len(),
                layout.events
            ),
        ),
        Quantity::Outputs => (
            "The declared outputs.",
            format!("{n} columns, each in its unit."),
        ),
        Quantity::Coordinates => (
            "The joint coordinates and their rates, as joints measure them.",
            format!("{n} [m, m/s or rad, rad/s].",),
        ),
        Quantity::CountedAngles => (
            "The angles whose turns a run counts, next to their last values, and their rates.",
            format!("{n} [rad, rad/s]."),
        ),
        Quantity::Energy => (
            "Energy and power: `½ v·M v`, gravity, `Σ ½ K s₊²`, power of the loads, of the dampers, of prescribed motions.",
            "6 [J, J, J, W, W, W].".to_owned(),
        ),
        Quantity::Bodies => (
            "Every body as absolute coordinates have it: position of the centre of mass, attitude, velocity, angular velocity.",
            match layout.directions.plane {
                None => format!(
                    "{} bodies × 13: x y z [m], qw qx qy qz, vx vy vz [m/s], ω [rad/s]; world axes, ω in the components of the model.",
                    n / layout.directions.motion()
                ),
                Some(_) => format!(
                    "{} bodies × 6: two of the position [m], the angle about the normal [rad], two of the velocity [m/s], ω [rad/s].",
                    n / layout.directions.motion()
                ),
            },
        ),
        Quantity::Momentum => (
            "Momentum of bodies and points with mass: `Σ m v`, `Σ r × m v + R I ω`.",
            "6 [3 kg m/s, 3 kg m²/s], world axes, about the world origin.".to_owned(),
        ),
        Quantity::MassMatrix => (
            "Mass matrix `M` in `M v̇ + h = f`.",
            format!("{nv}×{nv} [kg, kg m²], row by row, structural non-zeros only."),
        ),
        Quantity::BiasForce => (
            "Bias force `h` in `M v̇ + h = f`: velocity terms and gravity.",
            format!("{nv} [N, N m]."),
        ),
        Quantity::Forces => (
            "Applied forces `f` in `M v̇ + h = f`: lines and loads.",
            format!("{nv} [N, N m], about the centres of mass."),
        ),
        Quantity::InverseDynamics => (
            if layout.nc == 0 {
                "Inverse dynamics: `M v̇ + h − f` at the `v̇` of `motion`, what must act along the speeds besides everything that acts already."
            } else {
                "Inverse dynamics: `M v̇ + h − f − Φ_vᵀ λ` at the `v̇` and `λ` of `motion`, what must act along the speeds besides everything that acts already."
            },
            format!("{nv} [N, N m]."),
        ),
        Quantity::GravityForce => (
            "What holds a scene at rest against gravity: `h` at zero speeds.",
            format!("{nv} [N, N m]."),
        ),
        Quantity::CentreOfMass => (
            "Centre of mass of all bodies and points with mass: position, then velocity.",
            "6 [3 m, 3 m/s], world axes.".to_owned(),
        ),
        Quantity::CentreOfMassJacobian => (
            "Jacobian of the centre of mass: its velocity is `J v`.",
            format!("3×{nv}, world axes."),
        ),
        Quantity::FrameJacobian(..) => (
            "Jacobian of a frame: velocity of its origin, then angular velocity, are `J v`.",
            format!("6×{nv}, world axes."),
        ),
        Quantity::Lines => (
            "Lines: tension `T`, length `d`, stretch `s`, rate `ṡ`, stiffness `K u uᵀ + (T/d)(1 − u uᵀ)`.",
            format!("{} × 10 [N, m, m, m/s, 6 N/m].", layout.lines.len()),
        ),
        Quantity::Constraint => (
            "Constraints of the joints: `Φ(q, t) = 0`, rows in declaration order.",
            format!("{n} [m for a row of points, 1 for a row of directions]."),
        ),
        Quantity::ConstraintJacobian => (
            "Constraint Jacobian `Φ_v`: `Φ̇ = Φ_v v + Φ_t`.",
            format!("{}×{nv}, row by row, structural non-zeros only.", layout.nc),
        ),
        Quantity::ConstraintRate => (
            "Rate of the constraints: `Φ̇ = Φ_v v + Φ_t`.",
            format!("{n} [m/s or 1/s]."),
        ),
        Quantity::ConstraintBias => (
            "Bias of the constraints: `γ = −(dΦ_v/dt) v − dΦ_t/dt`, so that `Φ_v v̇ = γ`.",
            format!("{n} [m/s² or 1/s²]."),
        ),
        Quantity::Multipliers => (
            "Multipliers `λ`: `M v̇ + h = f + Φ_vᵀ λ`, `Φ_v v̇ = γ`.",
            format!("{n} [N or N m]."),
        ),
        Quantity::Reactions => (
            "Reactions: force and torque of each joint on its child at the origin of frame 2, what acts along its coordinates among them.",
            format!("{} × 6 [N, N m], world axes.", layout.joints.len()),
        ),
        Quantity::ProjectionStep => (
            "Projection step: the smallest `δ`, weighted by mass, with `Φ_v δ = −r`; `M δ = Φ_vᵀ μ`.",
            format!(
                "{nv}, in the components of the speeds; then the smallest part that other rows leave to a row's pivot."
            ),
        ),
        Quantity::Residual => (
            "Equations of motion before they are solved, at given `v̇` and `λ`: `q̇`, `M v̇ + h − f − Φ_vᵀ λ`, `ż`, `ṡ`, `Φ_v v̇ − γ`.",
            format!(
                "{n} = [{} q̇ | {nv} [N, N m] | {} ż | {} ṡ | {} [m/s² or 1/s²]].",
                layout.nq,
                layout.nz,
                layout.nx() - layout.states(),
                layout.nc
            ),
        ),
        Quantity::JointCoordinates => (
            "Joint coordinates: value, rate and acceleration of each.",
            format!("{} × 3 [m or rad, and per second].", layout.measured),
        ),
        Quantity::Factor => (
            "Factor of `K = [M −Φ_vᵀ; Φ_v 0]`, for `solve`.",
            format!(
                "{n}, structural non-zeros only; the last is the smallest part that other rows leave to a row's pivot."
            ),
        ),
        Quantity::Solve => (
            "Solution by the factor: `M x = b + Φ_vᵀ y`, `Φ_v x = c`.",
            format!("{nv} x, then {} y.", layout.nc),
        ),
        Quantity::NodeByAnchor(k) => (
            "How the nodes follow their anchors: `∂p/∂p_i = H⁻¹ J_i`, the sum over the anchors is 1.",
            network_shape(layout, k, false, "[1]"),
        ),
        Quantity::CondensedStiffness(k) => (
            "Stiffness the anchors see: `B_ij = J_i δ_ij − J_i H⁻¹ J_j`, symmetric, ≥ 0.",
            network_shape(layout, k, true, "[N/m]"),
        ),
        Quantity::Partial(of, by) => (
            "Partial derivative by symbolic differentiation.",
            format!(
                "∂({})/∂({}): {}×{}, row by row, structural non-zeros only.",
                differentiated(of),
                variable(by),
                layout.len(of.quantity()),
                layout.variables(by)
            ),
        ),
    };
    [text.to_owned(), shape]
}

fn network_shape(layout: &Layout, k: usize, square: bool, unit: &str) -> String {
    let (nodes, anchors) = layout
        .networks
        .get(k)
        .map_or((0, 0), |n| (n.nodes.len(), n.anchors.len()));
    let rows = if square { anchors } else { nodes };
    format!("{}×{} {unit}, row by row.", 3 * rows, 3 * anchors)
}
