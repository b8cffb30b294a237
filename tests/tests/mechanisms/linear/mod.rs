//! Linear systems, trim and inverse dynamics of jointed scenes against closed forms, independent tools, and the runs themselves.

mod closed_forms;
mod detached;
mod efforts;
mod emitted;
mod kinks;
mod mechanisms;
mod names;
mod nodes;
mod parameters;
mod trim;

use mbd_runtime::{External, Generic, Options, Simulation, StateSpace, linearise};
use mbd_scene::joints::JointForces;
use mbd_scene::{AngularVelocity, Scene};
use nalgebra::DMatrix;
use serde_json::Value;
use tests::reference::{field, numbers};
use tests::system::{list, scene};

/// Inputs that stay.
struct Held(Vec<f64>);

impl External<f64> for Held {
    fn evaluate(&self, _: f64, _: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&self.0);
    }
}

fn generic(scene: Scene) -> Generic<f64> {
    Generic::with_defaults(scene).expect("defaults")
}

/// The state of a scene at joint coordinates.
fn placed(model: &Generic<f64>, inputs: &[f64], joints: &[(&str, f64)]) -> Vec<f64> {
    let held = Held(inputs.to_vec());
    let mut run = Simulation::with_loads(model, Options::rk4(1e-3), held).expect("options");
    run.set_joints(joints).expect("it can be placed");
    run.state().to_vec()
}

fn assert_matrix(got: &DMatrix<f64>, want: &Value, relative: f64, what: &str) {
    let want = DMatrix::from_row_slice(got.nrows(), got.ncols(), &numbers(want));
    let error = (got - &want).amax() / want.amax();
    assert!(error < relative, "{what}: {error:.1e}\n{got}{want}");
}

/// Real and imaginary parts of all eigenvalues, sorted.
fn eigenvalues(space: &StateSpace) -> Vec<[f64; 2]> {
    let mut all: Vec<[f64; 2]> = Vec::new();
    for one in space.vibrations() {
        all.push([one.real, one.imaginary]);
        if one.imaginary > 0.0 {
            all.push([one.real, -one.imaginary]);
        }
    }
    sorted(all)
}

fn sorted(mut all: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    // Rounding must not decide the order.
    let key = |x: &[f64; 2]| [(x[0] * 1e6).round(), (x[1] * 1e6).round()];
    all.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    all
}

fn assert_eigenvalues(space: &StateSpace, want: &Value, tolerance: f64, what: &str) {
    let want = list(want).iter().map(|pair| {
        let pair = numbers(pair);
        [pair[0], pair[1]]
    });
    let (got, want) = (eigenvalues(space), sorted(want.collect()));
    assert_eq!(got.len(), want.len(), "{what}");
    for (got, want) in got.iter().zip(&want) {
        let apart = (got[0] - want[0]).hypot(got[1] - want[1]);
        assert!(apart < tolerance, "{what}: {got:?} is not {want:?}");
    }
}

/// The four-bar of a reference with the spring and damper on its crank.
fn sprung_four_bar(file: &Value) -> Scene {
    let mut scene = scene(&file["system"], AngularVelocity::Body);
    scene.joints[0].forces.push(JointForces {
        stiffness: Some(5.0.into()),
        rest: Some(std::f64::consts::FRAC_PI_3.into()),
        damping: Some(0.1.into()),
        ..JointForces::default()
    });
    scene
}

/// The linear system at a point of a reference, whose x0 are these coordinates: A, B and eigenvalues are those of the reference.
fn assert_point(
    model: &Generic<f64>,
    point: &Value,
    coordinates: [&str; 4],
    tolerance: f64,
) -> StateSpace {
    let name = point["name"].as_str().expect("a name");
    let (x, u) = (field(point, "x0"), field(point, "u0"));
    let place: Vec<(&str, f64)> = coordinates.into_iter().zip(x).collect();
    let at = placed(model, &u, &place);
    let space = linearise(model, 0.0, &at, &u).expect("linear");
    assert_system(&space, point, tolerance, name);
    space
}

fn assert_system(space: &StateSpace, point: &Value, tolerance: f64, name: &str) {
    assert_matrix(&space.a, &point["A"], 1e-10, name);
    assert_matrix(&space.b, &point["B"], 1e-10, name);
    assert_eigenvalues(space, &point["eigenvalues"], tolerance, name);
}

const DOUBLE_PENDULUM: &str = "model DoublePendulum {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    input first: torque; input second: torque;
    body upper { mass: 1.0 kg, inertia: diag(0.053333333333333344, 0.053333333333333344, 0.001) kg*m^2,
        frame top at [0.0, 0.0, 0.4] m, frame tip at [0.0, 0.0, -0.4] m }
    body lower { mass: 0.7 kg, inertia: diag(0.014583333333333332, 0.014583333333333332, 0.001) kg*m^2,
        frame top at [0.0, 0.0, 0.25] m }
    joint shoulder: hinge from world to upper.top { axis: y, force: first }
    joint elbow: hinge from upper.tip to lower.top { axis: y, force: second }
}";
