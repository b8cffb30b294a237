//! The things of a scene, one table a kind.

use mbd_report::{Cell, ReportTable};
use mbd_runtime::scene::laws::{Numbers, starts};
use mbd_runtime::scene::{Clamp, Difference, Layout, NodeModel, Place, PointKind, Scene, Unit};

use super::metrics::metrics;

/// The things of the scene, one table a kind; kinds the scene has none of are left out. Numbers are those of the default params.
#[must_use]
pub fn things(scene: &Scene) -> Vec<ReportTable> {
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
        metrics(scene),
    ];
    tables.retain(|table| !table.is_empty());
    tables
}

fn states(scene: &Scene, numbers: &Numbers<f64>) -> ReportTable {
    let mut table = ReportTable::new("States")
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

fn bodies(scene: &Scene, numbers: &Numbers<f64>) -> ReportTable {
    let mut table = ReportTable::new("Bodies")
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

fn points(scene: &Scene, numbers: &Numbers<f64>) -> ReportTable {
    let mut table = ReportTable::new("Points")
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

fn joints(scene: &Scene) -> ReportTable {
    let mut table = ReportTable::new("Joints")
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
        let mut ambiguous = layout.redundancy.ambiguous.iter();
        let reaction = match ambiguous.find(|of| of.joint == index) {
            Some(of) => format!("not unique: {}", of.named().join(", ")),
            None => String::new(),
        };
        let cells = counts.map(Cell::from).into_iter().chain([reaction.into()]);
        table.push(words.map(Cell::from).into_iter().chain(cells));
    }
    table
}

/// What acts along joint coordinates.
fn along(scene: &Scene, numbers: &Numbers<f64>) -> ReportTable {
    let mut table = ReportTable::new("Forces along joint coordinates")
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
                "rad, N*m"
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

fn lines(scene: &Scene, numbers: &Numbers<f64>) -> ReportTable {
    let mut table = ReportTable::new("Lines")
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
pub fn params(scene: &Scene) -> ReportTable {
    let mut table = ReportTable::new("Params")
        .column("name", "")
        .column("default", "")
        .column("from", "")
        .column("to", "")
        .column("unit", "")
        .column("what", "");
    for param in &scene.params {
        let factor = factor(&param.unit);
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

/// One of a unit in SI; numbers without a unit are as they are.
#[must_use]
pub fn factor(unit: &Unit) -> f64 {
    match unit.factor {
        factor if factor > 0.0 => factor,
        _ => 1.0,
    }
}
