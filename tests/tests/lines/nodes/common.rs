//! Scenes for the node tests, written as data: the parachute of AAS 03-163 and what its references were made with.

use mbd_runtime::node::{NodeError, NodeMemory, Nodes, Stage};
use mbd_runtime::{Generic, Model, Quantity, Work};
use mbd_scene::{
    Body, Formula, Frame, Function, Gravity, Inertia, Line, LineKind, Load, LoadKind, NodeModel,
    Place, Point, PointKind, Scene,
};

/// What the histories of the reference parachute hold of a state, in their order.
pub const COLUMNS: [&str; 8] = [
    "chute_x",
    "chute_v",
    "chute_q",
    "chute_w",
    "capsule_x",
    "capsule_v",
    "capsule_q",
    "capsule_w",
];

pub fn frame(name: &str, position: [f64; 3]) -> Frame {
    Frame {
        name: name.into(),
        position: position.map(Formula::from),
        rotation: None,
    }
}

pub fn line(name: &str, from: Place, to: Place, numbers: [f64; 3]) -> Line {
    Line {
        name: name.into(),
        doc: String::new(),
        kind: LineKind::Line,
        from,
        to,
        stiffness: numbers[0].into(),
        damping: numbers[1].into(),
        free_length: numbers[2].into(),
    }
}

pub fn node(name: &str, model: NodeModel) -> Point {
    Point {
        name: name.into(),
        doc: String::new(),
        kind: PointKind::Node(model),
    }
}

pub fn body(name: &str, mass: f64, inertia: [f64; 3], frames: &[[f64; 3]]) -> Body {
    let zero = || Formula::from(0.0);
    let mut all = vec![frame("com", [0.0; 3])];
    all.extend(frames.iter().map(|&at| frame("", at)));
    Body {
        name: name.into(),
        doc: String::new(),
        mass: mass.into(),
        inertia: Inertia {
            xx: inertia[0].into(),
            yy: inertia[1].into(),
            zz: inertia[2].into(),
            xy: zero(),
            xz: zero(),
            yz: zero(),
        },
        frames: all,
    }
}

/// The parachute scene; `damping` scales C.
pub fn parachute(kind: PointKind, damping: f64) -> Scene {
    let (chute, capsule, point) = (0, 1, Place::Point(0));
    let bridle = |i: usize| {
        let azimuth = (20.0 + 120.0 * i as f64).to_radians();
        [0.6 * azimuth.cos(), 0.6 * azimuth.sin(), 1.23]
    };
    let velocity = || Formula::Velocity(Place::Body(chute, 0));
    let speed = Formula::Apply(Function::Norm, vec![velocity()]);
    let factor = Formula::Apply(
        Function::Mul,
        vec![(-0.5 * 0.014 * 0.46 * 178.8).into(), speed],
    );
    let mut lines = vec![line(
        "riser",
        Place::Body(chute, 1),
        point,
        [60e3, 600.0 * damping, 4.0],
    )];
    for i in 0..3 {
        let leg = [47e3, 470.0 * damping, 1.5];
        lines.push(line("leg", Place::Body(capsule, 1 + i), point, leg));
    }
    Scene {
        name: "Parachute".into(),
        gravity: Gravity::PointMass {
            mu: 4.2828e13.into(),
            center: [0.0.into(), 0.0.into(), (-3_404_590.0).into()],
        },
        world_frames: vec![frame("world", [0.0; 3])],
        bodies: vec![
            body(
                "chute",
                16.0,
                [700.0, 700.0, 220.0],
                &[[0.0, 0.0, -22.0], [0.0, 0.0, 1.57]],
            ),
            body(
                "capsule",
                761.0,
                [235.0, 225.0, 290.0],
                &[bridle(0), bridle(1), bridle(2)],
            ),
        ],
        points: vec![Point {
            name: "confluence".into(),
            doc: String::new(),
            kind,
        }],
        lines,
        loads: vec![Load {
            name: "drag".into(),
            doc: String::new(),
            at: Place::Body(chute, 2),
            kind: LoadKind::Force(Formula::Apply(Function::Mul, vec![factor, velocity()])),
        }],
        ..Scene::default()
    }
}

/// A run with fixed steps of the classical Runge–Kutta method, modes not located: enough to watch the nodes.
pub struct Run<M: Model<f64>> {
    pub model: M,
    pub nodes: Nodes<f64>,
    pub memory: NodeMemory<f64>,
    pub work: Work<f64>,
    pub state: Vec<f64>,
    pub time: f64,
}

impl Run<Generic<f64>> {
    pub fn new(scene: Scene, state: &[f64], guess: Option<&[f64]>) -> Result<Self, NodeError> {
        let model = Generic::with_defaults(scene).expect("a scene without parameters");
        let (layout, work) = (model.layout().clone(), model.work());
        let mut run = Run {
            nodes: Nodes::new(&layout),
            memory: NodeMemory::new(&layout),
            work,
            state: state.to_vec(),
            time: 0.0,
            model,
        };
        run.state.resize(layout.nx(), 0.0);
        let stage = Stage {
            model: &run.model,
            time: 0.0,
            state: &run.state,
            inputs: &[],
        };
        run.nodes
            .start_stage(stage, guess, &mut run.memory, &mut run.work)?;
        run.nodes.place_in(&mut run.state);
        Ok(run)
    }
}

impl<M: Model<f64>> Run<M> {
    pub fn solve(&mut self, time: f64, span: f64, state: &[f64]) -> Result<(), NodeError> {
        let stage = Stage {
            model: &self.model,
            time,
            state,
            inputs: &[],
        };
        self.nodes
            .solve_stage(stage, span, &self.memory, &mut self.work)
    }

    pub fn ask(&mut self, what: Quantity, state: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.model.layout().len(what)];
        let at = self.nodes.at(self.time, state, &[]);
        self.model.evaluate(what, &at, &mut self.work, &mut out);
        out
    }

    pub fn slope(&mut self, span: f64, state: &[f64]) -> Result<Vec<f64>, NodeError> {
        self.solve(self.time + span, span, state)?;
        Ok(self.ask(Quantity::Derivative, state))
    }

    pub fn step(&mut self, h: f64) -> Result<(), NodeError> {
        let start = self.state.clone();
        let along = |k: &[f64], h: f64| -> Vec<f64> {
            start.iter().zip(k).map(|(x, k)| x + h * k).collect()
        };
        let k1 = self.slope(0.0, &start)?;
        let k2 = self.slope(h / 2.0, &along(&k1, h / 2.0))?;
        let k3 = self.slope(h / 2.0, &along(&k2, h / 2.0))?;
        let k4 = self.slope(h, &along(&k3, h))?;
        for (i, x) in self.state.iter_mut().enumerate() {
            *x += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        for (_, body) in self.model.layout().own_bodies() {
            let q = &mut self.state[body.q + 3..body.q + 7];
            let size = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            q.iter_mut().for_each(|x| *x /= size);
        }
        let mut end = self.state.clone();
        self.solve(self.time + h, h, &end)?;
        if self.nodes.project(&mut end) {
            self.state.copy_from_slice(&end);
            self.solve(self.time + h, h, &end)?;
        }
        self.time += h;
        self.nodes.commit(h, &mut self.memory);
        Ok(())
    }

    /// Tension of every line in the last accepted state.
    pub fn tensions(&mut self) -> Vec<f64> {
        let state = self.state.clone();
        let lines = self.ask(Quantity::Lines, &state);
        lines.chunks_exact(10).map(|line| line[0]).collect()
    }
}

/// A reference state (chute x v q w, capsule x v q w) in the order [q | v] of the layout.
pub fn state_of(reference: &[f64]) -> Vec<f64> {
    let body = |b: usize| &reference[13 * b..13 * b + 13];
    let mut state = Vec::new();
    for b in 0..2 {
        state.extend(&body(b)[0..3]);
        state.extend(&body(b)[6..10]);
    }
    for b in 0..2 {
        state.extend(&body(b)[3..6]);
        state.extend(&body(b)[10..13]);
    }
    state
}
