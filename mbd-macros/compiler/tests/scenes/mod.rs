//! Scenes of the tests, built in code, and random places to evaluate them.
#![allow(dead_code, reason = "each test file uses a part of it")]

use mbd_scene::{
    Actions, AngularVelocity, Arguments, Body, Constant, Direction, Event, Formula, Frame,
    Function, Gravity, Inertia, Input, Layout, Line, LineKind, Load, LoadKind, NodeModel, Output,
    Parameter, Place, Point, PointKind, Quantity, Scene, Unit,
};

pub fn numbers(values: [f64; 3]) -> [Formula; 3] {
    values.map(Formula::Number)
}

pub fn frame(name: &str, position: [f64; 3]) -> Frame {
    Frame {
        name: name.into(),
        position: numbers(position),
        rotation: None,
    }
}

pub fn body(name: &str, mass: Formula, inertia: [f64; 6], frames: Vec<Frame>) -> Body {
    let [xx, yy, zz, xy, xz, yz] = inertia.map(Formula::Number);
    let mut all = vec![frame("com", [0.0; 3])];
    all.extend(frames);
    Body {
        name: name.into(),
        doc: String::new(),
        mass,
        inertia: Inertia {
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
        },
        frames: all,
    }
}

pub fn line(name: &str, from: Place, to: Place, law: [Formula; 3]) -> Line {
    let [stiffness, damping, free_length] = law;
    Line {
        name: name.into(),
        doc: String::new(),
        kind: LineKind::Line,
        from,
        to,
        free_length,
        stiffness,
        damping,
    }
}

pub fn param(
    name: &str,
    doc: &str,
    default: f64,
    unit: &str,
    range: Option<[f64; 2]>,
) -> Parameter {
    Parameter {
        name: name.into(),
        doc: doc.into(),
        default,
        range,
        unit: Unit {
            text: unit.into(),
            factor: 1.0,
            ..Unit::default()
        },
    }
}

fn world() -> Vec<Frame> {
    vec![frame("world", [0.0; 3])]
}

/// Three fixed points, a node between them, a point with mass hanging from it: no rotation anywhere.
pub fn knot() -> Scene {
    let mut scene = Scene {
        name: "Knot".into(),
        doc: "A knot of four lines.".into(),
        gravity: Gravity::Uniform {
            acceleration: numbers([0.0, 0.0, -9.81]),
        },
        world_frames: world(),
        ..Scene::default()
    };
    for (index, at) in [[-1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [0.0, -1.0, 0.2]]
        .into_iter()
        .enumerate()
    {
        scene
            .world_frames
            .push(frame(&format!("anchor[{index}]"), at));
        scene.lines.push(line(
            &format!("stay[{index}]"),
            Place::World(index + 1),
            Place::Point(0),
            [1000.0.into(), 0.0.into(), 0.6.into()],
        ));
    }
    scene.points.push(Point {
        name: "knot".into(),
        doc: String::new(),
        kind: PointKind::Node(NodeModel::Static),
    });
    scene.points.push(Point {
        name: "bob".into(),
        doc: String::new(),
        kind: PointKind::Mass(2.0.into()),
    });
    scene.lines.push(line(
        "hanger",
        Place::Point(0),
        Place::Point(1),
        [2000.0.into(), 0.0.into(), 0.5.into()],
    ));
    scene
}

/// Canopy and capsule, a riser and three bridle legs that meet in a massless point; drag, wind, an external thruster.
pub fn parachute(model: NodeModel, angular_velocity: AngularVelocity) -> Scene {
    let apply = |function, arguments: &[Formula]| Formula::Apply(function, arguments.to_vec());
    let speed = apply(
        Function::Sub,
        &[Formula::Velocity(Place::Body(0, 2)), Formula::Input(0)],
    );
    let pressure = apply(
        Function::Mul,
        &[
            Formula::Number(-0.5),
            apply(Function::Mul, &[Formula::Const(0), Formula::Param(2)]),
        ],
    );
    let drag = apply(
        Function::Mul,
        &[
            apply(
                Function::Mul,
                &[
                    pressure,
                    apply(Function::Norm, std::slice::from_ref(&speed)),
                ],
            ),
            speed,
        ],
    );
    let bridles = (0..3)
        .map(|i| {
            let angle = f64::from(i) * 2.0 * std::f64::consts::FRAC_PI_3;
            frame(
                &format!("bridle[{i}]"),
                [0.55 * angle.cos(), 0.55 * angle.sin(), 1.23],
            )
        })
        .collect();
    let mut lines = vec![line(
        "riser",
        Place::Body(0, 1),
        Place::Point(0),
        [Formula::Param(0), 600.0.into(), 10.0.into()],
    )];
    for i in 0..3 {
        lines.push(line(
            &format!("leg[{i}]"),
            Place::Body(1, i + 1),
            Place::Point(0),
            [47000.0.into(), 470.0.into(), 2.1.into()],
        ));
    }
    Scene {
        name: "Parachute".into(),
        doc: "Capsule under a canopy.".into(),
        angular_velocity,
        gravity: Gravity::PointMass {
            mu: 4.282e13.into(),
            center: numbers([0.0, 0.0, -3.4e6]),
        },
        consts: vec![Constant {
            name: "RHO".into(),
            doc: String::new(),
            value: mbd_scene::Fixed::Scalar(0.014),
            unit: Unit {
                text: "kg/m^3".into(),
                factor: 1.0,
                ..Unit::default()
            },
        }],
        params: vec![
            param(
                "riser_k",
                "Stiffness of the riser.",
                6.0e4,
                "N/m",
                Some([1.0e4, 2.0e5]),
            ),
            param("m_cap", "Capsule mass.", 761.0, "kg", Some([600.0, 900.0])),
            param(
                "cd_s",
                "Drag coefficient times area.",
                82.0,
                "m^2",
                Some([60.0, 100.0]),
            ),
        ],
        inputs: vec![Input {
            name: "wind".into(),
            doc: "Wind, world axes.".into(),
            components: 3,
            unit: Unit {
                text: "m/s".into(),
                factor: 1.0,
                ..Unit::default()
            },
            default: [0.0; 3],
        }],
        world_frames: world(),
        bodies: vec![
            body(
                "canopy",
                16.0.into(),
                [60.0, 60.0, 90.0, 0.0, 0.0, 0.0],
                vec![
                    frame("riser_end", [0.0, 0.0, -9.5]),
                    frame("cp", [0.0, 0.0, 1.57]),
                ],
            ),
            body(
                "capsule",
                Formula::Param(1),
                [300.0, 310.0, 420.0, -1.5, 0.0, 2.0],
                bridles,
            ),
        ],
        points: vec![Point {
            name: "confluence".into(),
            doc: "Where riser and bridle meet.".into(),
            kind: PointKind::Node(model),
        }],
        lines,
        loads: vec![
            Load {
                name: "drag".into(),
                doc: String::new(),
                at: Place::Body(0, 2),
                kind: LoadKind::Force(drag),
            },
            Load {
                name: "thruster".into(),
                doc: "Thrust of the capsule.".into(),
                at: Place::Body(1, 0),
                kind: LoadKind::External,
            },
        ],
        outputs: vec![
            Output {
                name: "riser_force".into(),
                doc: "Tension of the riser.".into(),
                value: Formula::Tension(0),
                components: 1,
                unit: Unit {
                    text: "N".into(),
                    factor: 1.0,
                    ..Unit::default()
                },
            },
            Output {
                name: "tilt".into(),
                doc: String::new(),
                value: apply(
                    Function::Angle,
                    &[
                        Formula::Axis(Place::Body(1, 0), 2),
                        Formula::Axis(Place::World(0), 2),
                    ],
                ),
                components: 1,
                unit: Unit {
                    text: "rad".into(),
                    factor: 1.0,
                    ..Unit::default()
                },
            },
        ],
        events: vec![Event {
            name: "slack".into(),
            doc: String::new(),
            guard: Formula::Stretch(0),
            direction: Direction::Falls,
            actions: Actions::default(),
        }],
        ..Scene::default()
    }
}

/// Every scene of the tests.
pub fn all() -> Vec<Scene> {
    let stepwise = NodeModel::Stepwise {
        formula: mbd_scene::Difference::Bdf2,
        clamp: mbd_scene::Clamp::Positive,
    };
    let mut all = vec![knot()];
    for model in [NodeModel::Static, stepwise, NodeModel::Rate] {
        for components in [AngularVelocity::Body, AngularVelocity::World] {
            all.push(parachute(model, components));
        }
    }
    all
}

/// Numbers in (−1, 1), the same in every run.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn list(&mut self, length: usize, center: impl Fn(usize) -> f64, width: f64) -> Vec<f64> {
        (0..length)
            .map(|i| center(i) + width * self.next())
            .collect()
    }
}

/// A random place near the one where bodies hang below each other, lines about taut.
pub fn somewhere(scene: &Scene, random: &mut Random) -> Arguments<f64> {
    let layout = Layout::new(scene);
    let mut state = random.list(layout.nx(), |_| 0.0, 0.3);
    for (index, slots) in layout.own_bodies() {
        state[slots.q + 2] += 15.0 - 13.0 * index as f64;
        let norm = {
            state[slots.q + 3] += 1.0;
            state[slots.q + 3..slots.q + 7]
                .iter()
                .map(|x| x * x)
                .sum::<f64>()
                .sqrt()
        };
        state[slots.q + 3..slots.q + 7]
            .iter_mut()
            .for_each(|x| *x /= norm);
    }
    let taut = |i: usize| if i.is_multiple_of(2) { 5e4 } else { 2.0 };
    Arguments {
        time: 0.7,
        nodes: random.list(3 * layout.nodes.len(), |_| 0.0, 0.5),
        effective: random.list(layout.effective_numbers, taut, 1.0),
        hold: random
            .list(layout.one_way(), |_| 0.0, 1.2)
            .iter()
            .map(|x| x.round())
            .collect(),
        ends: random.list(layout.len(Quantity::AnchorStates), |_| 0.0, 4.0),
        inputs: random.list(layout.ni, |_| 0.0, 3.0),
        rows: random.list(layout.nc, |_| 0.0, 1.0),
        state,
    }
}
