//! Functions of a declaration: their values against those of the standard library, their slopes against closed forms, generated terms against laws.

use mbd_compiler::{Interpreted, read_text};
use mbd_scene::{Arguments, Differentiated, Model, Quantity, Scene, Variable};

/// A point on a line through x, and outputs of x: what is written, what it is, its slope.
type Case = (&'static str, fn(f64) -> f64, fn(f64) -> f64);

const CASES: &[Case] = &[
    ("tan(x)", f64::tan, |x| 1.0 + x.tan().powi(2)),
    ("asin(x)", f64::asin, |x| 1.0 / (1.0 - x * x).sqrt()),
    ("acos(x)", f64::acos, |x| -1.0 / (1.0 - x * x).sqrt()),
    ("atan(x)", f64::atan, |x| 1.0 / (1.0 + x * x)),
    (
        "atan2(x, -2.0)",
        |x| x.atan2(-2.0),
        |x| -2.0 / (4.0 + x * x),
    ),
    ("sinh(x)", f64::sinh, f64::cosh),
    ("cosh(x)", f64::cosh, f64::sinh),
    ("tanh(x)", f64::tanh, |x| 1.0 - x.tanh().powi(2)),
    ("ln(2.0 + x)", |x| (2.0 + x).ln(), |x| 1.0 / (2.0 + x)),
    (
        "log10(2.0 + x)",
        |x| (2.0 + x).log10(),
        |x| std::f64::consts::LOG10_E / (2.0 + x),
    ),
    (
        "sign(x)",
        |x| if x == 0.0 { 0.0 } else { x.signum() },
        |_| 0.0,
    ),
    ("floor(4.0 * x)", |x| (4.0 * x).floor(), |_| 0.0),
    (
        "clamp(x, -0.3, 0.4)",
        |x| x.clamp(-0.3, 0.4),
        |x| f64::from(u8::from(x > -0.3 && x < 0.4)),
    ),
    ("smoothstep(-0.5, 0.5, x)", smooth, |x| {
        let t = (x + 0.5).clamp(0.0, 1.0);
        6.0 * t * (1.0 - t)
    }),
    (
        "if(x < 0.1, x * x, 3.0 * x)",
        |x| if x < 0.1 { x * x } else { 3.0 * x },
        |x| {
            if x < 0.1 { 2.0 * x } else { 3.0 }
        },
    ),
    (
        "if x < 0.1 { 2.0 } else if x < 0.3 { x } else { x * x }",
        |x| match x {
            _ if x < 0.1 => 2.0,
            _ if x < 0.3 => x,
            _ => x * x,
        },
        |x| match x {
            _ if x < 0.1 => 0.0,
            _ if x < 0.3 => 1.0,
            _ => 2.0 * x,
        },
    ),
    (
        "if(x >= 0.1, 1.0, 2.0)",
        |x| if x >= 0.1 { 1.0 } else { 2.0 },
        |_| 0.0,
    ),
    (
        "sin(pi * x)",
        |x| (std::f64::consts::PI * x).sin(),
        |x| std::f64::consts::PI * (std::f64::consts::PI * x).cos(),
    ),
];

fn smooth(x: f64) -> f64 {
    let t = (x + 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn scene() -> Scene {
    let outputs = CASES.iter().enumerate().map(|(index, (text, ..))| {
        let text = text
            .replace("x", "X")
            .replace("eXp", "exp")
            .replace("maX", "max");
        let text = text.replace("X", "(p.position.x / (1.0 m))");
        format!("output f{index} = {text};\n")
    });
    let outputs: String = outputs.collect();
    let text = format!("model Functions {{ gravity: none; point p {{ mass: 1 kg }} {outputs} }}");
    let reading = read_text(&text);
    assert!(reading.errors.is_empty(), "{:?}", reading.errors);
    reading.scene.expect("a scene")
}

#[test]
fn functions_have_the_values_and_the_slopes_of_their_closed_forms() {
    let model = Interpreted::<f64>::new(scene(), &[]).expect("no params");
    let mut work = model.work();
    for x in [-0.9, -0.31, -1e-9, 0.0, 1e-7, 0.1, 0.25, 0.4321, 0.8] {
        let place = Arguments {
            state: vec![x, 0.0, 0.0, 0.0, 0.0, 0.0],
            ..Arguments::default()
        };
        let mut values = vec![0.0; CASES.len()];
        model.evaluate(Quantity::Outputs, &place.at(), &mut work, &mut values);
        let slopes = Quantity::Partial(Differentiated::Outputs, Variable::State);
        let mut jacobian = vec![0.0; 6 * CASES.len()];
        model.evaluate(slopes, &place.at(), &mut work, &mut jacobian);
        for (index, (text, value, slope)) in CASES.iter().enumerate() {
            let close = |got: f64, want: f64| {
                (got - want).abs() <= 4e-15 * (want.abs() + 1e-16).max(want.abs())
            };
            let (got, want) = (values[index], value(x));
            assert!(
                close(got, want) || (got - want).abs() < 2e-16,
                "{text} at {x}: {got}, not {want}"
            );
            let (got, want) = (jacobian[6 * index], slope(x));
            assert!(
                (got - want).abs() <= 1e-14 * want.abs().max(1.0),
                "slope of {text} at {x}: {got}, not {want}"
            );
        }
    }
}

#[test]
fn a_product_with_a_number_of_open_unit_has_no_unit_instead_of_a_wrong_one() {
    let text = "model Open { units: si; gravity: none;
        const RAD = 57.29577951308232;
        param wind = 12.0;
        body b { mass: 1, inertia: diag(1, 1, 1) }
        joint pin: hinge from world to b.com { axis: z }
        output share = pin.angle_rate * RAD / wind;
        output rate = pin.angle_rate; }";
    let scene = read_text(text).scene.expect("a scene");
    let units = scene.outputs.iter().map(|output| output.unit.text.as_str());
    assert_eq!(units.collect::<Vec<_>>(), ["", "rad/s"]);
}

#[test]
fn a_radius_takes_the_radians_out_of_what_turns() {
    let text = "model Rotor { gravity: none;
        const R = 4 m;
        param wind = 8 m/s;
        param twist = 3 deg/m;
        body b { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
        joint pin: hinge from world to b.com { axis: z }
        output tip_speed_ratio = pin.angle_rate * R / wind;
        output tip_speed = R * pin.angle_rate;
        output at_tip = twist * R + pin.angle;
        output rotation = pin.angle_rate * 2 s; }";
    let scene = read_text(text).scene.expect("a scene");
    let units = scene.outputs.iter().map(|output| output.unit.text.as_str());
    assert_eq!(units.collect::<Vec<_>>(), ["", "m/s", "rad", "rad"]);
}

#[test]
fn the_unit_of_an_integral_decides_what_the_names_in_it_are() {
    let text = "model Drop {
        gravity: none;
        const m = 2 kg;
        point bob { mass: m, start at [0, 0, 0] m velocity [1, 0, 0] m/s }
        metric work = integral 9.81 m/s^2 * m * norm(bob.velocity) in J; }";
    let read = read_text(text);
    assert!(read.errors.is_empty(), "{:?}", read.errors);
    let outputs = read.scene.expect("a scene").outputs;
    assert_eq!(outputs[0].unit.text, "W");
}

#[test]
fn a_unit_of_everyday_is_what_it_is_in_si() {
    let known = [
        ("1 rpm", std::f64::consts::TAU / 60.0),
        ("36 kph", 10.0),
        ("2 h", 7200.0),
        ("3 MN", 3e6),
        ("3 mN", 3e-3),
        ("2 kW", 2e3),
        ("1.5 bar", 1.5e5),
        ("2 l", 2e-3),
    ];
    for (text, value) in known {
        let (found, unit) = mbd_compiler::read_number(text).expect(text);
        assert!(
            (found - value).abs() <= 1e-15 * value,
            "{text}: {found} {}",
            unit.text
        );
    }
}
