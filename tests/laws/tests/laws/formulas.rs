//! Formulas of a declaration by what they say: every function, what they may name, tables straight and smooth.

use laws::assert_close;
use laws::instant::Instant;
use laws::mechanism::{add_frame, add_point, empty, evaluate_at, frame};
use laws::random::Random;
use mbd_scene::{
    AngularVelocity, Constant, Fixed, Formula, Function, Input, Let, LineKind, Parameter, Scene,
    SecondArgument, State, Table, Unit,
};
use nalgebra::Vector3;

use crate::things::{line, vector_output};

fn apply<const N: usize>(function: Function, of: [Formula; N]) -> Formula {
    Formula::Apply(function, of.to_vec())
}

fn vector(v: Vector3<f64>) -> Formula {
    Formula::Vector(v.iter().copied().map(Formula::Number).collect())
}

fn scene() -> Scene {
    empty([0.0; 3], AngularVelocity::Body)
}

/// What outputs of a scene say at an instant.
fn told(mut scene: Scene, formulas: &[(Formula, Vec<f64>)], at: &Instant<f64>, tolerance: f64) {
    for (formula, want) in formulas {
        let output = vector_output(formula.clone());
        scene.outputs = vec![mbd_scene::Output {
            components: want.len(),
            ..output
        }];
        let got = evaluate_at(&scene, mbd_scene::Quantity::Outputs, &at.at());
        assert_close(&got, want, tolerance, tolerance, &format!("{formula:?}"));
    }
}

#[test]
fn every_function_is_the_one_of_mathematics() {
    use Function::{
        Abs, Add, Angle, Atan2, Cos, Cross, Div, Dot, Exp, Floor, IfAtMost, IfLess, Ln, Max, Min,
        Mul, Neg, Norm, Power, Sin, Sqrt, Sub, Tanh,
    };
    let mut random = Random::new(71);
    for _ in 0..20 {
        let [a, b] = [random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)];
        let [u, v] = [random.vector(2.0), random.vector(2.0)].map(Vector3::from);
        let number = Formula::Number;
        let one = |f, x: f64| apply(f, [number(x)]);
        let two = |f, x: f64, y: f64| apply(f, [number(x), number(y)]);
        let list = |v: Vector3<f64>| v.as_slice().to_vec();
        let mut all = vec![
            (two(Add, a, b), vec![a + b]),
            (two(Sub, a, b), vec![a - b]),
            (two(Mul, a, b), vec![a * b]),
            (two(Div, a, b), vec![a / b]),
            (two(Min, a, b), vec![a.min(b)]),
            (two(Max, a, b), vec![a.max(b)]),
            (two(Atan2, a, b), vec![a.atan2(b)]),
            (one(Neg, a), vec![-a]),
            (one(Abs, a), vec![a.abs()]),
            (one(Exp, a), vec![a.exp()]),
            (one(Sqrt, a.abs()), vec![a.abs().sqrt()]),
            (one(Ln, a.abs()), vec![a.abs().ln()]),
            (one(Sin, a), vec![a.sin()]),
            (one(Cos, a), vec![a.cos()]),
            (one(Tanh, a), vec![a.tanh()]),
            (one(Floor, a), vec![a.floor()]),
            (apply(Add, [vector(u), vector(v)]), list(u + v)),
            (apply(Sub, [vector(u), vector(v)]), list(u - v)),
            (apply(Mul, [number(a), vector(v)]), list(v * a)),
            (apply(Mul, [vector(v), number(a)]), list(v * a)),
            (apply(Div, [vector(v), number(a)]), list(v / a)),
            (apply(Neg, [vector(v)]), list(-v)),
            (apply(Norm, [vector(u)]), vec![u.norm()]),
            (apply(Dot, [vector(u), vector(v)]), vec![u.dot(&v)]),
            (apply(Cross, [vector(u), vector(v)]), list(u.cross(&v))),
            (apply(Angle, [vector(u), vector(v)]), vec![u.angle(&v)]),
        ];
        for n in -5..=7 {
            let raised = apply(Power, [number(a), number(f64::from(n))]);
            all.push((raised, vec![a.powi(n)]));
        }
        for axis in 0..3 {
            let component = Formula::Component(vec![vector(u)], axis);
            all.push((component, vec![u[axis]]));
        }
        for (x, y) in [(a, b), (a, a), (b, a)] {
            let of = |f| apply(f, [number(x), number(y), number(1.0), number(2.0)]);
            let pick = |first: bool| vec![if first { 1.0 } else { 2.0 }];
            all.push((of(IfLess), pick(x < y)));
            all.push((of(IfAtMost), pick(x <= y)));
            let both = apply(IfLess, [number(x), number(y), vector(u), vector(v)]);
            all.push((both, list(if x < y { u } else { v })));
        }
        told(scene(), &all, &Instant::default(), 1e-12);
    }
}

fn named(name: &str) -> (String, String, Unit) {
    (name.to_owned(), String::new(), Unit::default())
}

#[test]
fn names_stand_for_what_was_declared_or_given() {
    let mut scene = scene();
    let (name, doc, unit) = named("k");
    scene.consts = vec![
        Constant {
            name: name.clone(),
            doc: doc.clone(),
            value: Fixed::Scalar(1.25),
            unit: unit.clone(),
        },
        Constant {
            name: name.clone(),
            doc: doc.clone(),
            value: Fixed::Vector([1.0, 2.0, 3.0]),
            unit: unit.clone(),
        },
    ];
    scene.params = vec![Parameter {
        name: name.clone(),
        doc: doc.clone(),
        default: 4.5,
        range: None,
        unit: unit.clone(),
    }];
    for components in [3, 1] {
        scene.inputs.push(Input {
            name: name.clone(),
            doc: doc.clone(),
            components,
            unit: unit.clone(),
            default: [0.0; 3],
        });
    }
    scene.states = vec![State {
        name: name.clone(),
        doc: doc.clone(),
        start: 0.0.into(),
        unit: unit.clone(),
        rate: apply(Function::Mul, [(-2.0).into(), Formula::State(0)]),
    }];
    scene.lets = vec![
        Let {
            name: name.clone(),
            doc: doc.clone(),
            value: apply(Function::Add, [Formula::Let(1), 1.0.into()]),
            components: 1,
            unit: unit.clone(),
        },
        Let {
            name,
            doc,
            value: apply(Function::Mul, [Formula::Time, Formula::Param(0)]),
            components: 1,
            unit,
        },
    ];
    // A line whose length follows the state, an input, a param and a let: all that a winch may.
    let post = add_frame(&mut scene, None, frame("post", [0.0; 3], None));
    let bob = add_point(&mut scene, 2.0);
    let sum = |a: Formula, b: Formula| apply(Function::Add, [a, b]);
    let length = sum(
        sum(Formula::State(0), Formula::Input(1)),
        sum(Formula::Param(0), Formula::Let(0)),
    );
    scene
        .lines
        .push(line(LineKind::Spring, [post, bob], [0.0, 10.0, 3.0]));
    scene.lines[0].free_length = length;
    let (time, s, push) = (0.7, 0.9, 6.0);
    let at = Instant {
        time,
        state: vec![2.0, 0.0, 0.0, 1.0, 0.0, 0.0, s],
        inputs: vec![7.0, 8.0, 9.0, push],
        hold: vec![0.0],
        ..Instant::default()
    };
    let said = 4.5 * time + 1.0;
    let free = s + push + 4.5 + said;
    let rate = 1.0 - (-2.0 * s + 4.5);
    let all = [
        (Formula::Const(0), vec![1.25]),
        (Formula::Const(1), vec![1.0, 2.0, 3.0]),
        (Formula::Param(0), vec![4.5]),
        (Formula::Input(0), vec![7.0, 8.0, 9.0]),
        (Formula::Input(1), vec![push]),
        (Formula::State(0), vec![s]),
        (Formula::Let(0), vec![said]),
        (Formula::Time, vec![time]),
        (Formula::Length(0), vec![2.0]),
        (Formula::Stretch(0), vec![2.0 - free]),
        (Formula::StretchRate(0), vec![rate]),
        (Formula::Tension(0), vec![10.0 * (2.0 - free) + 3.0 * rate]),
        (Formula::Energy(mbd_scene::EnergyKind::Kinetic), vec![1.0]),
        (
            Formula::Energy(mbd_scene::EnergyKind::Potential),
            vec![5.0 * (2.0 - free) * (2.0 - free)],
        ),
        (
            Formula::Energy(mbd_scene::EnergyKind::Total),
            vec![1.0 + 5.0 * (2.0 - free) * (2.0 - free)],
        ),
    ];
    let slope = evaluate_at(&scene, mbd_scene::Quantity::Derivative, &at.at());
    assert_close(&slope[6..], &[-2.0 * s], 1e-15, 0.0, "ṡ");
    told(scene, &all, &at, 1e-13);
}

fn table(x: &[f64], y: &[f64], second: Option<&[f64]>, smooth: bool) -> Table {
    Table {
        name: "look".to_owned(),
        doc: String::new(),
        x: x.to_vec(),
        y: y.to_vec(),
        x_unit: Unit::default(),
        y_unit: Unit::default(),
        second: second.map(|z| SecondArgument {
            z: z.to_vec(),
            unit: Unit::default(),
        }),
        smooth,
    }
}

/// The value at x between entries: straight, or the cubic of Fritsch and Butland with slopes that are zero at both ends.
fn between(x: f64, grid: &[f64], y: &[f64], smooth: bool) -> f64 {
    let last = grid.len() - 1;
    if x <= grid[0] {
        return y[0];
    }
    if x >= grid[last] {
        return y[last];
    }
    let k = (0..last).rfind(|&k| grid[k] <= x).expect("inside");
    let secant = |k: usize| (y[k + 1] - y[k]) / (grid[k + 1] - grid[k]);
    let slope = |k: usize| {
        if k == 0 || k == last || secant(k - 1) * secant(k) <= 0.0 {
            return 0.0;
        }
        let (before, after) = (grid[k] - grid[k - 1], grid[k + 1] - grid[k]);
        let (w0, w1) = (2.0 * after + before, after + 2.0 * before);
        (w0 + w1) / (w0 / secant(k - 1) + w1 / secant(k))
    };
    let h = grid[k + 1] - grid[k];
    let t = (x - grid[k]) / h;
    if !smooth {
        return y[k] * (1.0 - t) + y[k + 1] * t;
    }
    // The basis of Hermite.
    let (t2, t3) = (t * t, t * t * t);
    y[k] * (2.0 * t3 - 3.0 * t2 + 1.0)
        + y[k + 1] * (3.0 * t2 - 2.0 * t3)
        + h * (slope(k) * (t3 - 2.0 * t2 + t) + slope(k + 1) * (t3 - t2))
}

const X: [f64; 5] = [-1.0, 0.5, 0.8, 2.0, 3.5];
const Y: [f64; 5] = [2.0, 3.0, 7.0, 6.5, 9.0];

#[test]
fn tables_are_straight_or_smooth_between_their_entries_and_constant_beyond() {
    for smooth in [false, true] {
        let mut scene = scene();
        scene.tables.push(table(&X, &Y, None, smooth));
        let mut all = Vec::new();
        for step in -8..=24 {
            let x = 0.2 * f64::from(step);
            all.push((
                Formula::Lookup(0, vec![x.into()]),
                vec![between(x, &X, &Y, smooth)],
            ));
        }
        for (x, y) in X.into_iter().zip(Y) {
            all.push((Formula::Lookup(0, vec![x.into()]), vec![y]));
        }
        told(scene, &all, &Instant::default(), 1e-13);
    }
}

#[test]
fn tables_of_two_arguments_run_along_the_first_then_along_the_second() {
    let z = [0.0, 1.0, 3.0];
    // By the first argument, then the second.
    let y: Vec<f64> = (0..5)
        .flat_map(|i| [0, 1, 2].map(|j| Y[i] * f64::from(j + 1) - 0.3 * f64::from(j * j)))
        .collect();
    let column = |j: usize| -> Vec<f64> { (0..5).map(|i| y[3 * i + j]).collect() };
    let mut scene = scene();
    scene.tables.push(table(&X, &y, Some(&z), false));
    scene.tables.push(table(&X, &y, Some(&z), true));
    let mut all = Vec::new();
    for at_x in [-2.0, -1.0, 0.1, 0.5, 0.7, 1.3, 3.0, 4.0] {
        let line: Vec<f64> = (0..3)
            .map(|j| between(at_x, &X, &column(j), false))
            .collect();
        for at_z in [-1.0, 0.0, 0.4, 1.0, 2.2, 3.0, 5.0] {
            let look = Formula::Lookup(0, vec![at_x.into(), at_z.into()]);
            all.push((look, vec![between(at_z, &z, &line, false)]));
        }
    }
    // A smooth one, along the lines of its grid: the other argument at an entry.
    for (j, at_z) in z.into_iter().enumerate() {
        for at_x in [-2.0, 0.1, 0.7, 1.3, 3.0, 4.0] {
            let look = Formula::Lookup(1, vec![at_x.into(), at_z.into()]);
            all.push((look, vec![between(at_x, &X, &column(j), true)]));
        }
    }
    for (i, at_x) in X.into_iter().enumerate() {
        for at_z in [-1.0, 0.4, 2.2, 5.0] {
            let look = Formula::Lookup(1, vec![at_x.into(), at_z.into()]);
            all.push((look, vec![between(at_z, &z, &y[3 * i..3 * i + 3], true)]));
        }
    }
    told(scene, &all, &Instant::default(), 1e-12);
}
