//! The error that a run tells, and what is advised, against closed forms: whatever moves, no run of ours says what is right.

use std::f64::consts::PI;

use mbd_runtime::{
    Content, Generic, Options, Question, Sampling, Simulation, Trajectory, Variant, trade,
};
use tests::declared::read;

/// What is declared, the column that counts and what it is [SI, s], the end [s], a step of RK4 that suits it [s].
struct Known {
    text: &'static str,
    column: &'static str,
    value: fn(f64) -> f64,
    until: f64,
    step: f64,
}

const fn known(
    (text, column): (&'static str, &'static str),
    value: fn(f64) -> f64,
    until: f64,
    step: f64,
) -> Known {
    Known {
        text,
        column,
        value,
        until,
        step,
    }
}

const SCENES: &[Known] = &[
    // A spring without length, through its hook: x = cos ω t.
    known(
        ("model Through { gravity: none; point p { mass: 1 kg, start at [1, 0, 0] m }
          spring s from world to p { free_length: 0 m, stiffness: 100 N/m, damping: 0 N*s/m } }", "p.x"),
        |t| (10.0 * t).cos(),
        5.0,
        0.02,
    ),
    // Kepler, e = 0.6, from the furthest place on.
    known(
        ("model Orbit { gravity: point_mass { mu: 1 m^3/s^2, center: [0, 0, 0] m };
          point p { mass: 1 kg, start at [-1.6, 0, 0] m velocity [0, -0.5, 0] m/s } }", "p.x"),
        |t| kepler(0.6, t),
        12.0,
        0.02,
    ),
    // A symmetric top without torque: turning about its angular momentum at L/A, and in itself at (1 − C/A) ω₃.
    known(
        ("model Top { gravity: none; body b { mass: 1 kg, inertia: diag(1, 1, 1.8) kg*m^2, frame eye at [1, 0, 0] m,
          start at [0, 0, 0] m angular_velocity [0.5, 0, 1] rad/s }
          joint loose: free from world to b.com; output x = b.eye.position.x; }", "x"),
        top,
        10.0,
        0.1,
    ),
    // A line that stays taut, damped.
    known(
        ("model Taut { gravity: [0, 0, -9.81] m/s^2; point p { mass: 1 kg, start at [0, 0, -1.02] m }
          line l from world to p { free_length: 1 m, stiffness: 1 kN/m, damping: 4 N*s/m } }", "p.z"),
        |t| -1.0 - 9.81e-3 - damped(1e3, 4.0, 0.02 - 9.81e-3, t),
        2.0,
        0.01,
    ),
    // Two lines of 2 kN/m and 8 N s/m, one behind the other, are the same.
    known(
        ("model Series { gravity: [0, 0, -9.81] m/s^2; point n { equilibrium: rate } point p { mass: 1 kg, start at [0, 0, -2.02] m }
          line a from world to n { free_length: 1 m, stiffness: 2 kN/m, damping: 8 N*s/m }
          line b from n to p { free_length: 1 m, stiffness: 2 kN/m, damping: 8 N*s/m } }", "p.z"),
        |t| -2.0 - 9.81e-3 - damped(1e3, 4.0, 0.02 - 9.81e-3, t),
        2.0,
        0.004,
    ),
    // A conical pendulum on a massless rod.
    known(
        ("model Cone { gravity: [0, 0, -9.81] m/s^2; point b { mass: 1 kg, start at [sin(1 rad) * 1 m, 0, -cos(1 rad) * 1 m] velocity [0, sqrt(9.81 / cos(1 rad)) * sin(1 rad) * 1 m/s, 0] }
          joint d: distance from world to b { length: 1 m } }", "b.x"),
        |t| 1f64.sin() * ((9.81 / 1f64.cos()).sqrt() * t).cos(),
        4.0,
        0.02,
    ),
    // A bead on a rod that turns: x = a cosh ω t.
    known(
        ("model Bead { gravity: none; body rod { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
          body bead { mass: 1 g, inertia: diag(1e-9, 1e-9, 1e-9) kg*m^2 }
          joint m: hinge from world to rod.com { axis: z, motor: 5 rad/s * time }
          joint s: prismatic from rod.com to bead.com { axis: x, start: 1 cm } output x = s.slide; }", "x"),
        |t| 0.01 * (5.0 * t).cosh(),
        1.5,
        0.02,
    ),
    // Resonance.
    known(
        ("model Resonance { gravity: none; point p { mass: 1 kg, start at [1, 0, 0] m }
          spring s from world to p { free_length: 1 m, stiffness: 100 N/m, damping: 0 N*s/m }
          load f on p = [0.1 N * cos(10 rad/s * time), 0 N, 0 N]; output x = p.position.x - 1 m; }", "x"),
        |t| 0.005 * t * (10.0 * t).sin(),
        10.0,
        0.02,
    ),
    // Drag.
    known(
        ("model Drag { gravity: none; point p { mass: 1 kg, start at [0, 0, 0] m velocity [10, 0, 0] m/s }
          load d on p = -1 kg/m * norm(p.velocity) * p.velocity; }", "p.x"),
        |t| (10.0 * t).ln_1p(),
        2.0,
        0.02,
    ),
    // A rotor whose angle a force follows.
    known(
        ("model Rotor { gravity: none; coordinates: relative; body wheel { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
          body sled { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
          joint pin: hinge from world to wheel.com { axis: z, start_rate: 20 rad/s }
          joint rail: prismatic from world to sled.com { axis: x }
          load push on sled = [1 N * cos(pin.angle), 0, 0]; output v = rail.slide_rate; }", "v"),
        |t| (20.0 * t).sin() / 20.0,
        3.0,
        0.02,
    ),
    // A winch lifts a mass from rest.
    known(
        ("model Winch { gravity: [0, 0, -9.81] m/s^2; point p { mass: 1 kg, start at [0, 0, -5.00981] m }
          line r from world to p { free_length: 5 m - 0.05 m/s * time, stiffness: 1 kN/m, damping: 0 N*s/m } }", "p.z"),
        |t| -5.00981 + 0.05 * t - 0.05 / 1e3f64.sqrt() * (1e3f64.sqrt() * t).sin(),
        3.0,
        0.01,
    ),
    // What follows cos t a millisecond late, and would at once.
    known(
        ("model Filter { gravity: none; point p { mass: 1 kg }
          state x: number = 1 { rate: -1000 (1/s) * (x - cos(1 rad/s * time)) - 1 (1/s) * sin(1 rad/s * time) }
          output y = x; }", "y"),
        f64::cos,
        3.0,
        0.001,
    ),
];

/// x of an orbit with a = 1 m and μ = 1 m³/s² from the furthest place on, by bisection of Kepler's equation.
fn kepler(e: f64, t: f64) -> f64 {
    let mean = t.rem_euclid(2.0 * PI) - PI;
    let mean = mean + 2.0 * PI;
    let (mut low, mut high) = (0.0, 4.0 * PI);
    for _ in 0..100 {
        let middle: f64 = 0.5 * (low + high);
        match middle - e * middle.sin() < mean {
            true => low = middle,
            false => high = middle,
        }
    }
    low.cos() - e
}

/// x of the eye of the top.
fn top(t: f64) -> f64 {
    let (a, c, w1, w3) = (1.0, 1.8, 0.5, 1.0);
    let (l1, l3) = (a * w1, c * w3);
    let l = f64::hypot(l1, l3);
    let own = -(c - a) / a * w3 * t;
    let (v1, v2) = (own.cos(), own.sin());
    let (u1, u3, turn) = (l1 / l, l3 / l, l / a * t);
    // Rodrigues: of u × v the first component is −u₃ v₂.
    v1 * turn.cos() - u3 * v2 * turn.sin() + u1 * (u1 * v1) * (1.0 - turn.cos())
}

/// What is left after t of a displacement of 1 kg on a spring and a damper.
fn damped(stiffness: f64, damping: f64, start: f64, t: f64) -> f64 {
    let decay = 0.5 * damping;
    let w = (stiffness - decay * decay).sqrt();
    start * (-decay * t).exp() * ((w * t).cos() + decay / w * (w * t).sin())
}

impl Known {
    /// The root of the mean square of what a run is beside the closed form.
    fn truth(&self, model: &Generic<f64>, question: &Question, options: Options) -> f64 {
        let last = question.samples - 1;
        let times: Vec<f64> = (0..=last)
            .map(|k| self.until * k as f64 / last as f64)
            .collect();
        let mut run = Simulation::new(model, options).expect("a method");
        let content = Content {
            energy: false,
            reactions: false,
            ..Content::ALL
        };
        let mut history = Trajectory::new(model, Sampling::At(times.clone()), content);
        run.record(self.until, &mut history).expect("a run");
        let column = history.column(self.column).expect("a column");
        assert_eq!(column.len(), times.len(), "{}", self.text);
        let squares = column
            .iter()
            .zip(&times)
            .map(|(x, t)| (x - (self.value)(*t)).powi(2));
        (squares.sum::<f64>() / times.len() as f64).sqrt()
    }

    fn each(every: usize, mut visit: impl FnMut(&Known, &Generic<f64>, &Variant<'_>, &Question)) {
        for scene in SCENES.iter().step_by(every) {
            let model = Generic::<f64>::with_defaults(read(scene.text)).expect("defaults");
            let variant = Variant::new(scene.column, &model, |_: &mut Simulation<f64>| Ok(()));
            let question = Question::new(scene.column, [0.0, scene.until]);
            visit(scene, &model, &variant, &question);
        }
    }
}

#[test]
fn the_error_that_is_told_is_that_of_the_closed_form() {
    let (mut all, mut within) = (0, 0);
    Known::each(1, |scene, model, variant, question| {
        for options in [
            Options::rk4(scene.step),
            Options::rk4(0.5 * scene.step),
            Options::tsit5(1e-4),
            Options::tsit5(1e-7),
            Options::vern7(1e-6),
            Options::rodas5p(1e-5),
        ] {
            let told = variant.error(question, options).expect("a run").rms;
            let truth = scene.truth(model, question, options);
            // Below that there is rounding alone.
            if truth < 1e-12 {
                continue;
            }
            println!(
                "{}, {}: {told:.2e} for {truth:.2e}",
                scene.text, options.method
            );
            all += 1;
            within += i32::from((1.0 / 3.0..=3.0).contains(&(told / truth)));
        }
    });
    assert!(all > 60 && within * 100 >= all * 95, "{within} of {all}");
}

/// A race takes a second: of every third scene.
#[test]
fn what_is_advised_is_as_near_to_the_closed_form_as_was_wanted() {
    Known::each(3, |scene, model, variant, question| {
        let race = trade(std::slice::from_ref(variant), question).expect("a race");
        let size = race
            .reference
            .iter()
            .fold(0.0_f64, |most, x| most.max(x.abs()));
        for part in [1e-2, 1e-4] {
            let wanted = part * size;
            let advice = race.advise(wanted).expect("that is not hard");
            let options = Options::of(advice.choice.method);
            let truth = scene.truth(model, question, options);
            assert!(
                truth <= wanted,
                "{}: {advice}: {truth:e} of {wanted:e}",
                scene.text
            );
        }
    });
}
