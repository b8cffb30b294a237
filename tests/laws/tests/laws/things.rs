//! What the scenes of these tests are made of, and where they are asked.

use laws::instant::Instant;
use laws::mechanism::Instance;
use laws::random::Random;
use mbd_scene::{Body, Formula, Line, LineKind, Place, Point, PointKind, Scene};
use nalgebra::Vector3;

/// A line or a spring of this law: free length [m], stiffness [N/m], damping [N s/m].
pub fn line(kind: LineKind, [from, to]: [Place; 2], [l0, k, c]: [f64; 3]) -> Line {
    Line {
        name: "tie".to_owned(),
        doc: String::new(),
        kind,
        from,
        to,
        free_length: l0.into(),
        stiffness: k.into(),
        damping: c.into(),
    }
}

/// Adds an equilibrium point.
pub fn node(scene: &mut Scene, model: mbd_scene::NodeModel) -> Place {
    let index = scene.points.len();
    scene.points.push(Point {
        name: format!("node{index}"),
        doc: String::new(),
        kind: PointKind::Node(model),
    });
    Place::Point(index)
}

/// An output of three components.
pub fn vector_output(value: Formula) -> mbd_scene::Output {
    mbd_scene::Output {
        name: "told".to_owned(),
        doc: String::new(),
        value,
        components: 3,
        unit: mbd_scene::Unit::default(),
    }
}

/// The mass of a body of numbers [kg].
pub fn mass(body: &Body) -> f64 {
    match body.mass {
        Formula::Number(mass) => mass,
        _ => f64::NAN,
    }
}

/// A state where each line and stop decides by itself.
pub fn at_state(state: Vec<f64>, one_way: usize) -> Instant<f64> {
    Instant {
        state,
        hold: vec![0.0; one_way],
        ..Instant::default()
    }
}

/// A point somewhere, moving.
pub fn moving(position: Vector3<f64>, velocity: Vector3<f64>) -> Instance {
    Instance {
        position,
        velocity,
        ..Instance::rest()
    }
}

/// A random unit vector.
pub fn direction(random: &mut Random) -> Vector3<f64> {
    loop {
        let v = Vector3::from(random.vector(1.0));
        if (0.1..1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}
