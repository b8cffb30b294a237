//! What a scene contains, as tables: for `mbd check` and for the first page of a report.

use mbd_compiler::Equations;
use mbd_runtime::scene::laws::{Numbers, starts};
use mbd_runtime::scene::{
    Clamp, Cost, Difference, Differentiated, Formula, Gravity, Layout, NodeModel, Place, PointKind,
    Quantity, Scene, Variable,
};

use crate::report::{Cell, Table};

/// How many of each thing the scene has.
#[must_use]
pub fn counts(scene: &Scene) -> Table {
    let layout = Layout::new(scene);
    let lines = |one_way: bool| {
        let kinds = scene.lines.iter().map(|line| line.kind);
        kinds.filter(|kind| kind.is_unilateral() == one_way).count()
    };
    let rows: [(&str, usize); 19] = [
        ("bodies", scene.bodies.len()),
        ("points with mass", scene.points.len() - layout.nodes.len()),
        ("equilibrium points", layout.nodes.len()),
        (
            "networks of them, each solved together",
            layout.networks.len(),
        ),
        ("joints", scene.joints.len()),
        ("rows of the joints", layout.nc),
        ("of them independent", layout.rank()),
        ("loops of joints", layout.redundancy.loops),
        ("lines (tension only)", lines(true)),
        ("springs (both ways)", lines(false)),
        ("loads", scene.loads.len()),
        ("coordinates q", layout.nq),
        ("speeds v", layout.nv),
        ("states of equilibrium points", layout.nz),
        ("declared states", layout.ns),
        ("numbers from the caller at each evaluation", layout.ni),
        ("params (live)", scene.params.len()),
        ("consts (folded)", scene.consts.len()),
        ("columns of outputs", layout.columns),
    ];
    let mut table = Table::new(format!("Scene {}", scene.name))
        .column("what", "")
        .column("number", "");
    for (what, number) in rows {
        table.push([what.into(), number.into()]);
    }
    let told = layout.redundancy.sentences(scene);
    let told = told.into_iter().chain(ambiguous(scene, &layout));
    let tree = layout.tree.as_ref().map(|tree| tree.sentence(scene));
    let notes = [freedoms(scene, &layout)]
        .into_iter()
        .chain(tree)
        .chain(told);
    let gravity = format!("gravity: {}", gravity(&scene.gravity));
    notes.chain([gravity]).fold(table, Table::note)
}

/// Freedoms by Grübler's count, which takes rows as independent (6 a body, 3 a point with mass, in a plane 3 and 2, in relative coordinates the
/// speeds of the tree, less the rows of the joints), and by the true rank; loops.
fn freedoms(scene: &Scene, layout: &Layout) -> String {
    let (bodies, rows, rank) = (scene.bodies.len(), layout.nc, layout.rank());
    let points = scene.points.len() - layout.nodes.len();
    let (body, point) = (
        layout.directions.speeds(),
        layout.directions.translations().len(),
    );
    let count = |rows: usize| layout.nv as i64 - rows as i64;
    let speeds = match layout.tree {
        None => format!("freedoms (Grübler): {body}·{bodies} + {point}·{points}"),
        Some(_) => format!("freedoms: {} speeds of the tree and of points", layout.nv),
    };
    let mut text = format!("{speeds} − {rows} = {}", count(rows));
    if rows > 0 {
        let (left, loops) = (count(rank), layout.redundancy.loops);
        text += &format!("; by the rank {rank} of the rows: {left}; loops: {loops}");
    }
    text
}

/// Outputs and events that ask for reactions of which there are many.
#[must_use]
pub fn ambiguous(scene: &Scene, layout: &Layout) -> Vec<String> {
    let outputs = scene.outputs.iter();
    let outputs = outputs.map(|output| ("output", &output.name, &output.value));
    let events = scene.events.iter();
    let events = events.map(|event| ("event", &event.name, &event.guard));
    let mut told = Vec::new();
    for (kind, name, formula) in outputs.chain(events) {
        scene.walk(formula, &mut |part| {
            if let Formula::ReactionForce(joint) | Formula::ReactionTorque(joint) = part
                && !layout.redundancy.is_unique(*joint)
                && let Some(joint) = scene.joints.get(*joint)
            {
                told.push(format!(
                    "{kind} `{name}` asks for the reaction of `{}`, which is not unique: rows of joints repeat each other, and what it shows is one choice of many",
                    joint.name
                ));
            }
        });
    }
    told.dedup();
    told
}

fn gravity(gravity: &Gravity) -> &'static str {
    match gravity {
        Gravity::None => "none",
        Gravity::Uniform { .. } => "uniform",
        Gravity::PointMass { .. } => "point mass",
        Gravity::Oblate { .. } => "oblate planet (J2)",
        Gravity::Field => "from the caller",
    }
}

/// The things of the scene, one table a kind; kinds the scene has none of are left out. Numbers are those of the default params.
#[must_use]
pub fn things(scene: &Scene) -> Vec<Table> {
    let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let numbers = Numbers::new(scene, &defaults);
    let mut tables = vec![
        bodies(scene, &numbers),
        points(scene, &numbers),
        joints(scene),
        along(scene, &numbers),
        lines(scene, &numbers),
        params(scene),
        states(scene, &numbers),
    ];
    tables.retain(|table| !table.is_empty());
    tables
}

fn states(scene: &Scene, numbers: &Numbers<f64>) -> Table {
    let mut table = Table::new("States")
        .column("name", "")
        .column("start", "")
        .column("unit", "")
        .column("what", "");
    for (state, start) in scene.states.iter().zip(starts(scene, &numbers.params)) {
        table.push([
            state.name.as_str().into(),
            start.into(),
            state.unit.text.as_str().into(),
            state.doc.trim().into(),
        ]);
    }
    table
}

fn bodies(scene: &Scene, numbers: &Numbers<f64>) -> Table {
    let mut table = Table::new("Bodies")
        .column("name", "")
        .column("mass", "kg")
        .column("frames", "");
    for (body, numbers) in scene.bodies.iter().zip(&numbers.bodies) {
        let frames: Vec<&str> = body
            .frames
            .iter()
            .map(|frame| frame.name.as_str())
            .collect();
        let cells = [body.name.as_str().into(), numbers.mass.into()];
        table.push(cells.into_iter().chain([frames.join(", ").into()]));
    }
    table
}

fn points(scene: &Scene, numbers: &Numbers<f64>) -> Table {
    let mut table = Table::new("Points")
        .column("name", "")
        .column("model", "")
        .column("mass", "kg")
        .column("lines", "");
    for (index, point) in scene.points.iter().enumerate() {
        let (model, mass) = match point.kind {
            PointKind::Mass(_) => {
                let mass = numbers.points.get(index).map(|(mass, _)| *mass);
                ("point with mass", mass)
            }
            PointKind::Node(model) => (node_model(model), None),
        };
        let here = Place::Point(index);
        let lines = scene.lines.iter();
        let ends = lines.filter(|line| line.from == here || line.to == here);
        let names: Vec<&str> = ends.map(|line| line.name.as_str()).collect();
        let cells = [point.name.as_str().into(), model.into(), mass.into()];
        table.push(cells.into_iter().chain([names.join(", ").into()]));
    }
    table
}

/// The model of an equilibrium point in the words of the declaration.
#[must_use]
pub fn node_model(model: NodeModel) -> &'static str {
    match model {
        NodeModel::Static => "static",
        NodeModel::Rate => "rate",
        NodeModel::Stepwise { formula, clamp } => match (formula, clamp) {
            (Difference::Euler, Clamp::Positive) => "stepwise (euler)",
            (Difference::Bdf2, Clamp::Positive) => "stepwise (bdf2)",
            (Difference::Euler, Clamp::Literal) => "stepwise (euler, literal clamp)",
            (Difference::Bdf2, Clamp::Literal) => "stepwise (bdf2, literal clamp)",
        },
    }
}

fn joints(scene: &Scene) -> Table {
    let mut table = Table::new("Joints")
        .column("name", "")
        .column("kind", "")
        .column("from", "")
        .column("to", "")
        .column("freedoms", "")
        .column("rows", "")
        .column("of motors", "")
        .column("kept", "")
        .column("reaction", "");
    let layout = Layout::new(scene);
    for (index, (joint, slots)) in scene.joints.iter().zip(&layout.joints).enumerate() {
        let ends = scene.coupled(joint);
        let [from, to] =
            ends.unwrap_or_else(|| [joint.parent, joint.child].map(|end| place(scene, end)));
        let words = [
            joint.name.clone(),
            joint.law.keyword().to_string(),
            from,
            to,
        ];
        let motors = if slots.len > 0 {
            joint.motors().count()
        } else {
            0
        };
        let kept = slots.kept.len();
        let counts = [joint.law.freedoms(), slots.len, motors, kept];
        let reaction = match layout.redundancy.is_unique(index) {
            true => "",
            false => "not unique",
        };
        let cells = counts.map(Cell::from).into_iter().chain([reaction.into()]);
        table.push(words.map(Cell::from).into_iter().chain(cells));
    }
    table
}

/// What acts along joint coordinates.
fn along(scene: &Scene, numbers: &Numbers<f64>) -> Table {
    let mut table = Table::new("Forces along joint coordinates")
        .column("coordinate", "")
        .column("unit", "")
        .column("stiffness", "")
        .column("damping", "")
        .column("friction", "")
        .column("low stop", "")
        .column("high stop", "")
        .column("force", "");
    for (joint, numbers) in scene.joints.iter().zip(&numbers.forces) {
        for (forces, numbers) in joint.forces.iter().zip(numbers) {
            let Some(coordinate) = joint.law.coordinate(forces.coordinate) else {
                continue;
            };
            let number = |x: Option<f64>| x.map_or_else(|| Cell::from("–"), Cell::from);
            let name = format!("{}.{}", joint.name, coordinate.name);
            let unit = if coordinate.is_angle() {
                "rad, N m"
            } else {
                "m, N"
            };
            let [low, high] = numbers.stops;
            let force = if forces.force.is_some() { "yes" } else { "–" };
            table.push([
                Cell::from(name),
                Cell::from(unit),
                number(numbers.stiffness),
                number(numbers.damping),
                number(numbers.friction.map(|[level, _]| level)),
                number(low),
                number(high),
                Cell::from(force),
            ]);
        }
    }
    table
}

fn lines(scene: &Scene, numbers: &Numbers<f64>) -> Table {
    let mut table = Table::new("Lines")
        .column("name", "")
        .column("from", "")
        .column("to", "")
        .column("free length", "m")
        .column("stiffness", "N/m")
        .column("damping", "N s/m");
    for (line, numbers) in scene.lines.iter().zip(&numbers.lines) {
        let words = [
            line.name.clone(),
            place(scene, line.from),
            place(scene, line.to),
        ];
        let law = [numbers.free_length, numbers.stiffness, numbers.damping];
        table.push(words.map(Cell::from).into_iter().chain(law.map(Cell::from)));
    }
    table
}

/// A place in the words of the declaration: `capsule.bridle[0]`, `confluence`, `world.anchor`.
fn place(scene: &Scene, place: Place) -> String {
    match place {
        Place::World(0) => "world".to_string(),
        Place::World(frame) => {
            let frame = scene.world_frames.get(frame);
            format!("world.{}", frame.map_or("?", |frame| &frame.name))
        }
        Place::Body(body, frame) => {
            let body = scene.bodies.get(body);
            let frame = body.and_then(|body| body.frames.get(frame));
            let name = body.map_or("?", |body| &body.name);
            format!("{name}.{}", frame.map_or("?", |frame| &frame.name))
        }
        Place::Point(point) => scene
            .points
            .get(point)
            .map_or_else(|| "?".to_string(), |point| point.name.clone()),
    }
}

/// The live numbers in the units of their declaration.
#[must_use]
pub fn params(scene: &Scene) -> Table {
    let mut table = Table::new("Params")
        .column("name", "")
        .column("default", "")
        .column("from", "")
        .column("to", "")
        .column("unit", "")
        .column("what", "");
    for param in &scene.params {
        let factor = if param.unit.factor > 0.0 {
            param.unit.factor
        } else {
            1.0
        };
        let [low, high] = param
            .range
            .map_or([None; 2], |range| range.map(|end| Some(end / factor)));
        table.push([
            param.name.as_str().into(),
            (param.default / factor).into(),
            low.into(),
            high.into(),
            param.unit.text.as_str().into(),
            param.doc.trim().into(),
        ]);
    }
    table
}

/// Operations of every quantity of the scene.
#[must_use]
pub fn operations(equations: &Equations) -> Table {
    let mut table = Table::new("Operations of one evaluation")
        .column("quantity", "")
        .column("all", "")
        .column("+ −", "")
        .column("×", "")
        .column("÷", "")
        .column("√", "")
        .column("sin cos exp", "")
        .column("select", "");
    let mut add = |name: String, cost: Cost| {
        let kinds = [
            cost.total(),
            cost.adds,
            cost.muls,
            cost.divs,
            cost.sqrts,
            cost.trigs,
            cost.selects,
        ];
        table.push([Cell::from(name)].into_iter().chain(kinds.map(Cell::from)));
    };
    add(
        "terms of the params alone, once".to_string(),
        equations.derived.cost(),
    );
    for (what, program) in &equations.programs {
        add(quantity(*what), program.cost());
    }
    table
}

/// A quantity in words.
fn quantity(what: Quantity) -> String {
    let words = match what {
        Quantity::AnchorStates => "ends of the node lines",
        Quantity::Equilibrium(network) => {
            return format!("equilibrium of network {network}, one iteration");
        }
        Quantity::Derivative => "derivative of the state",
        Quantity::Rates => "derivative of the state with the velocities of its nodes",
        Quantity::Balance => "balance of the equilibrium points",
        Quantity::Guards => "guards of the events",
        Quantity::Outputs => "outputs",
        Quantity::Coordinates => "joint coordinates",
        Quantity::Energy => "energy",
        Quantity::Momentum => "momentum",
        Quantity::Bodies => "bodies as absolute coordinates have them",
        Quantity::MassMatrix => "mass matrix",
        Quantity::BiasForce => "bias force",
        Quantity::Forces => "applied forces",
        Quantity::InverseDynamics => "inverse dynamics",
        Quantity::GravityForce => "gravity force",
        Quantity::CentreOfMass => "centre of mass",
        Quantity::CentreOfMassJacobian => "its Jacobian",
        Quantity::FrameJacobian(..) => "Jacobian of a frame",
        Quantity::Lines => "lines and their stiffness",
        Quantity::Constraint => "constraints Φ of the joints",
        Quantity::ConstraintJacobian => "their Jacobian Φ_v",
        Quantity::ConstraintRate => "their rate Φ_v v",
        Quantity::ConstraintBias => "their bias γ",
        Quantity::Multipliers => "multipliers of the joints",
        Quantity::Reactions => "reactions of the joints",
        Quantity::ProjectionStep => "correction of the joints (projection)",
        Quantity::Residual => "equations of motion before their solution",
        Quantity::Factor => "factor of their system",
        Quantity::Solve => "solution by the factor",
        Quantity::JointCoordinates => "joint coordinates",
        Quantity::NodeByAnchor(network) => return format!("∂node/∂anchor of network {network}"),
        Quantity::CondensedStiffness(network) => {
            return format!("condensed stiffness of network {network}");
        }
        Quantity::Partial(of, by) => {
            let of = match of {
                Differentiated::Derivative => "derivative",
                Differentiated::Balance => "balance",
                Differentiated::Outputs => "outputs",
                Differentiated::Residual => "residual",
            };
            let by = match by {
                Variable::State => "state",
                Variable::Node => "node",
                Variable::Parameter => "params",
                Variable::Input => "inputs",
            };
            return format!("∂{of}/∂{by}");
        }
    };
    words.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mbd_runtime::scene::{Formula, Line, LineKind, Parameter, Point, Unit};

    /// A point of 2 kg between two lines.
    fn swing() -> Scene {
        let line = |name: &str| Line {
            name: name.into(),
            doc: String::new(),
            kind: LineKind::Line,
            from: Place::World(0),
            to: Place::Point(0),
            free_length: Formula::Number(1.5),
            stiffness: Formula::Param(0),
            damping: Formula::Number(0.0),
        };
        Scene {
            name: "Swing".into(),
            params: vec![Parameter {
                name: "k".into(),
                doc: " Stiffness of both lines.".into(),
                default: 47e3,
                range: Some([1e3, 1e6]),
                unit: Unit {
                    text: "kN/m".into(),
                    factor: 1e3,
                    ..Unit::default()
                },
            }],
            points: vec![Point {
                name: "bob".into(),
                doc: String::new(),
                kind: PointKind::Mass(Formula::Number(2.0)),
            }],
            lines: vec![line("left"), line("right")],
            world_frames: vec![mbd_runtime::scene::Frame {
                name: "world".into(),
                position: [0.0; 3].map(Formula::Number),
                rotation: None,
            }],
            ..Scene::default()
        }
    }

    #[test]
    fn a_scene_without_bodies_lists_none_and_shows_params_in_their_own_unit() {
        let text: Vec<String> = things(&swing()).iter().map(Table::text).collect();
        let text = text.join("\n");
        assert!(!text.contains("Bodies"));
        assert!(
            text.contains("bob")
                && text.contains("point with mass")
                && text.contains("left, right")
        );
        assert!(text.contains("47.00") && text.contains("kN/m"));
        assert!(text.contains("47000"));
    }

    #[test]
    fn a_point_and_two_lines_have_six_states() {
        let text = counts(&swing()).text();
        assert!(
            text.contains("coordinates q                                    3"),
            "{text}"
        );
        assert!(text.contains("gravity: none"));
    }

    #[test]
    fn joints_are_listed_with_their_rows_and_freedoms_are_counted() {
        let link = |name: &str| {
            format!(
                "body {name} {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame tip at [1, 0, 0] m }}"
            )
        };
        let text = format!(
            "model S {{ gravity: none; {} {}
             joint hip: hinge from world to a.com {{ axis: y }}
             joint knee: universal from a.tip to b.com {{ angle2: {{ damping: 0.25 N*m*s }} }} }}",
            link("a"),
            link("b")
        );
        let scene = mbd_compiler::read_text(&text).scene.unwrap_or_default();
        assert!(
            counts(&scene)
                .text()
                .contains("freedoms (Grübler): 6·2 + 3·0 − 9 = 3")
        );
        let tables: Vec<String> = things(&scene).iter().map(Table::text).collect();
        let text = tables.join("\n");
        assert!(text.contains("knee") && text.contains("universal") && text.contains("a.tip"));
        assert!(text.contains("knee.angle2") && text.contains("0.25"));
    }

    #[test]
    fn a_loop_of_parallel_hinges_counts_by_its_rank_and_names_what_repeats() {
        let link = |name: &str, x: f64, z: f64| {
            format!(
                "body {name} {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame one at [{x}, 0, {z}] m, frame two at [{}, 0, {}] m }}",
                -x, -z
            )
        };
        let text = format!(
            "model S {{ gravity: none; world {{ frame far at [2, 0, 0] m }} {} {} {}
             joint a: hinge from world to left.one {{ axis: y }}
             joint b: hinge from left.two to bar.one {{ axis: y }}
             joint c: hinge from bar.two to right.two {{ axis: y }}
             joint close: hinge from world.far to right.one {{ axis: y }}
             output pull = close.force; }}",
            link("left", 0.0, -0.5),
            link("bar", -1.0, 0.0),
            link("right", 0.0, -0.7)
        );
        let scene = mbd_compiler::read_text(&text).scene.unwrap_or_default();
        let text = counts(&scene).text();
        for part in [
            "freedoms (Grübler): 6·3 + 3·0 − 20 = -2; by the rank 17 of the rows: 1; loops: 1",
            "`close` repeats rows of `a`, `b`, `c`: 3 of 5",
            "output `pull` asks for the reaction of `close`, which is not unique",
        ] {
            assert!(text.contains(part), "{text}");
        }
        let tables: Vec<String> = things(&scene).iter().map(Table::text).collect();
        assert_eq!(tables.join("\n").matches("not unique").count(), 4);
    }

    #[test]
    fn rows_of_motors_are_counted_beside_those_of_their_joints() {
        let text = "model S { gravity: none; body a { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
             joint hip: hinge from world to a.com { axis: y, motor: 1 rad/s * time } }";
        let scene = mbd_compiler::read_text(text).scene.unwrap_or_default();
        let tables: Vec<String> = things(&scene).iter().map(Table::text).collect();
        let text = tables.join("\n");
        let row = text
            .lines()
            .find(|line| line.trim_start().starts_with("hip"));
        let cells: Vec<&str> = row.unwrap_or_default().split_whitespace().collect();
        // Freedoms, rows, of motors, kept.
        assert_eq!(
            cells.get(4..),
            Some(["1", "6", "1", "6"].as_slice()),
            "{text}"
        );
    }

    #[test]
    fn every_quantity_of_a_scene_has_its_operations() {
        let text = operations(&Equations::trace(&swing())).text();
        assert!(text.contains("derivative of the state") && text.contains("∂derivative/∂params"));
    }
}
