//! Scenes built in code, reference files, and observed orders, for the tests of runs.

use std::path::PathBuf;

use mbd_runtime::scene::{
    Actions, Body, Direction, Event, Formula, Frame, Function, Gravity, Inertia, Line, LineKind,
    Load, LoadKind, NodeModel, Output, Place, Point, PointKind, Scene, Unit,
};
use mbd_runtime::{Content, Generic, Options, Sampling, Simulation, Trajectory};
use serde_json::Value;

pub fn numbers(values: [f64; 3]) -> [Formula; 3] {
    values.map(Formula::Number)
}

pub fn apply(function: Function, arguments: &[Formula]) -> Formula {
    Formula::Apply(function, arguments.to_vec())
}

pub fn frame(name: &str, position: [f64; 3]) -> Frame {
    Frame {
        name: name.into(),
        position: numbers(position),
        rotation: None,
    }
}

pub fn unit(text: &str) -> Unit {
    Unit {
        text: text.into(),
        factor: 1.0,
        ..Unit::default()
    }
}

pub fn body(name: &str, mass: f64, inertia: [f64; 3], frames: Vec<Frame>) -> Body {
    let [xx, yy, zz] = inertia.map(Formula::Number);
    let zero = || Formula::Number(0.0);
    let mut all = vec![frame("com", [0.0; 3])];
    all.extend(frames);
    Body {
        name: name.into(),
        doc: String::new(),
        mass: mass.into(),
        inertia: Inertia {
            xx,
            yy,
            zz,
            xy: zero(),
            xz: zero(),
            yz: zero(),
        },
        frames: all,
    }
}

/// A line: stiffness, damping, free length.
pub fn line(name: &str, from: Place, to: Place, [k, c, l]: [f64; 3]) -> Line {
    Line {
        name: name.into(),
        doc: String::new(),
        kind: LineKind::Line,
        from,
        to,
        free_length: l.into(),
        stiffness: k.into(),
        damping: c.into(),
    }
}

pub fn point(name: &str, kind: PointKind) -> Point {
    Point {
        name: name.into(),
        doc: String::new(),
        kind,
    }
}

pub fn output(name: &str, text: &str, value: Formula) -> Output {
    Output {
        name: name.into(),
        doc: String::new(),
        value,
        components: 1,
        unit: unit(text),
    }
}

pub fn event(name: &str, guard: Formula, direction: Direction) -> Event {
    Event {
        name: name.into(),
        doc: String::new(),
        guard,
        direction,
        actions: Actions::default(),
    }
}

pub fn empty(name: &str) -> Scene {
    Scene {
        name: name.into(),
        world_frames: vec![frame("world", [0.0; 3])],
        ..Scene::default()
    }
}

/// A mass of 1 kg hanging on one line from the world origin, gravity 9.81 m/s² along −z.
pub fn bouncing(stiffness: f64, damping: f64) -> Scene {
    let mut scene = empty("Bouncing");
    scene.gravity = Gravity::Uniform {
        acceleration: numbers([0.0, 0.0, -9.81]),
    };
    scene.points.push(point("bob", PointKind::Mass(1.0.into())));
    scene.lines.push(line(
        "cord",
        Place::World(0),
        Place::Point(0),
        [stiffness, damping, 1.0],
    ));
    scene
}

/// A free rigid body of 1 kg.
pub fn free_body(inertia: [f64; 3]) -> Scene {
    let mut scene = empty("Free");
    scene.bodies.push(body("top", 1.0, inertia, vec![]));
    scene
}

/// A file of the repository's reference data.
pub fn reference(name: &str) -> Value {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "..", "tests", "reference", name]
        .iter()
        .collect();
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{name}: {error}"))
}

pub fn floats(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(x) => x.as_f64().into_iter().collect(),
        Value::Array(items) => items.iter().flat_map(floats).collect(),
        _ => Vec::new(),
    }
}

/// The scene of `tests/reference/parachute`, from the parameters of one of its files; `node` is the kind of the confluence.
pub fn parachute(file: &Value, node: PointKind) -> Scene {
    let p = &file["parameters"];
    let number = |name: &str| p[name].as_f64().unwrap_or_else(|| panic!("{name}"));
    let inertia =
        |name: &str| ["t1", "t2", "roll"].map(|axis| p[name][axis].as_f64().unwrap_or_default());
    let mut scene = empty("Parachute");
    scene.gravity = Gravity::PointMass {
        mu: number("mu").into(),
        center: numbers([0.0, 0.0, -(number("R_equator") + number("altitude0"))]),
    };
    scene.bodies.push(body(
        "chute",
        number("m_chute"),
        inertia("I_chute"),
        vec![
            frame("cp", [0.0, 0.0, number("chute_cp_z")]),
            frame("riser_end", [0.0, 0.0, number("chute_attach_z")]),
        ],
    ));
    let (r, h) = (number("bridle_attach_r"), number("bridle_attach_h"));
    let azimuths = floats(&p["bridle_attach_az_deg"]);
    let bridles = azimuths.iter().enumerate().map(|(i, az)| {
        let (sin, cos) = az.to_radians().sin_cos();
        frame(&format!("bridle[{i}]"), [r * cos, r * sin, h])
    });
    scene.bodies.push(body(
        "capsule",
        number("m_capsule"),
        inertia("I_capsule"),
        bridles.collect(),
    ));
    scene.points.push(point("confluence", node));
    let (k, c, l) = (floats(&p["K"]), floats(&p["C"]), floats(&p["L0"]));
    let undamped = file["node_model"]
        .as_str()
        .is_some_and(|model| model.ends_with("C0"));
    let law = |i: usize| [k[i], if undamped { 0.0 } else { c[i] }, l[i]];
    scene
        .lines
        .push(line("riser", Place::Body(0, 2), Place::Point(0), law(0)));
    for i in 0..azimuths.len() {
        scene.lines.push(line(
            &format!("leg[{i}]"),
            Place::Body(1, i + 1),
            Place::Point(0),
            law(i + 1),
        ));
    }
    let factor = -0.5 * number("rho") * number("CD") * number("S_ref");
    let velocity = Formula::Velocity(Place::Body(0, 0));
    let speed = apply(Function::Norm, std::slice::from_ref(&velocity));
    let scaled = apply(Function::Mul, &[factor.into(), speed]);
    scene.loads.push(Load {
        name: "drag".into(),
        doc: String::new(),
        at: Place::Body(0, 1),
        kind: LoadKind::Force(apply(Function::Mul, &[scaled, velocity])),
    });
    scene
        .outputs
        .push(output("riser_force", "N", Formula::Tension(0)));
    scene
}

/// State of the parachute from `initial_state` of a file: x v q w per body there, [q | v | z] here. `mass`: the node has mass.
pub fn parachute_state(file: &Value, node: PointKind) -> Vec<f64> {
    let y = floats(&file["initial_state"]);
    let mut x = Vec::new();
    for o in [0, 13] {
        x.extend(&y[o..o + 3]);
        x.extend(&y[o + 6..o + 10]);
    }
    if matches!(node, PointKind::Mass(_)) {
        x.extend(&y[26..29]);
    }
    for o in [0, 13] {
        x.extend(&y[o + 3..o + 6]);
        x.extend(&y[o + 10..o + 13]);
    }
    match node {
        PointKind::Mass(_) => x.extend(&y[29..32]),
        PointKind::Node(NodeModel::Rate) => x.extend(&y[26..29]),
        PointKind::Node(_) => {}
    }
    x
}

pub fn generic(scene: Scene) -> Generic<f64> {
    Generic::with_defaults(scene).unwrap_or_else(|error| panic!("{error:?}"))
}

/// The largest difference of the riser force to a reference file in windows of time that end at `windows`, and the located events.
pub fn compare(
    name: &str,
    node: &PointKind,
    options: Options,
    until: f64,
    windows: &[f64],
) -> (Vec<f64>, Trajectory) {
    let file = reference(&format!("parachute/{name}.json"));
    let model = generic(parachute(&file, node.clone()));
    let mut simulation = Simulation::new(&model, options).unwrap();
    simulation
        .set_state(0.0, &parachute_state(&file, node.clone()))
        .unwrap();
    if matches!(node, PointKind::Node(_)) {
        simulation.set_nodes(&floats(&file["node_x"][0])).unwrap();
    }
    let times: Vec<f64> = floats(&file["t"])
        .into_iter()
        .filter(|t| *t <= until)
        .collect();
    let mut trajectory = Trajectory::new(&model, Sampling::At(times.clone()), Content::ALL);
    simulation
        .record(until, &mut trajectory)
        .unwrap_or_else(|error| panic!("{name} {:?}: {error}", options.method));
    let force = trajectory.column("riser_force").unwrap().to_vec();
    let want = floats(&file["riser_force"]);
    let mut worst = vec![0.0_f64; windows.len()];
    for ((t, a), b) in times.iter().zip(&force).zip(&want) {
        if let Some(window) = windows.iter().position(|end| t <= end) {
            worst[window] = worst[window].max((a - b).abs());
        }
    }
    println!(
        "{name} {:?}: {worst:?} {:?}",
        options.method, trajectory.statistics
    );
    (worst, trajectory)
}

/// The state after running from `state` at t = 0 to `until`.
pub fn run(model: &Generic<f64>, options: Options, state: &[f64], until: f64) -> Vec<f64> {
    let mut simulation = Simulation::new(model, options).unwrap();
    simulation.set_state(0.0, state).unwrap();
    simulation
        .run(until)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(simulation.time(), until);
    simulation.state().to_vec()
}

pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}

/// Slopes of log error over log step, for steps that halve.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors
        .windows(2)
        .map(|pair| (pair[0] / pair[1]).log2())
        .collect()
}
