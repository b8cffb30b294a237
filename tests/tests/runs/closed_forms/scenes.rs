//! Scenes whose motion has a closed form.

use std::f64::consts::PI;

/// What is declared, the column that counts and what it is [SI, s], the end [s], a step of RK4 that suits it [s].
pub struct Known {
    pub text: &'static str,
    pub column: &'static str,
    pub value: fn(f64) -> f64,
    pub until: f64,
    pub step: f64,
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

pub const SCENES: &[Known] = &[
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
    // A stone in linear drag: v = −g/k (1 − exp(−k t)).
    known(
        ("model Linear { gravity: [0, 0, -9.81] m/s^2; point p { mass: 1 kg, start at [0, 0, 0] m }
          load d on p = -2 kg/s * p.velocity; }", "p.z"),
        |t| -9.81 / 2.0 * (t - (-(-2.0 * t).exp_m1()) / 2.0),
        3.0,
        0.05,
    ),
    // A stone in quadratic drag: z = −v²/g ln cosh(g t/v), v² = m g/c.
    known(
        ("model Falls { gravity: [0, 0, -9.81] m/s^2; point p { mass: 1 kg, start at [0, 0, 0] m }
          load d on p = -0.1 kg/m * norm(p.velocity) * p.velocity; }", "p.z"),
        |t| -10.0 * ((0.981_f64).sqrt() * t).cosh().ln(),
        3.0,
        0.05,
    ),
    // A wheel that a damper stops: φ = ω I/c (1 − exp(−c t/I)).
    known(
        ("model Wheel { gravity: none; body w { mass: 1 kg, inertia: diag(1, 1, 2) kg*m^2 }
          joint pin: hinge from world to w.com { axis: z, damping: 3 N*m*s, start_rate: 5 rad/s } output x = pin.angle; }", "x"),
        |t| 5.0 * 2.0 / 3.0 * -(-1.5 * t).exp_m1(),
        3.0,
        0.05,
    ),
    // A wheel on a spring.
    known(
        ("model Balance { gravity: none; coordinates: relative; body w { mass: 1 kg, inertia: diag(1, 1, 2) kg*m^2 }
          joint pin: hinge from world to w.com { axis: z, stiffness: 50 N*m, start: 1 rad } output x = pin.angle; }", "x"),
        |t| (5.0 * t).cos(),
        5.0,
        0.03,
    ),
    // Two masses on a spring in free space: about their centre at √(K/µ).
    known(
        ("model Pair { gravity: none; point a { mass: 1 kg, start at [0, 0, 0] m } point b { mass: 3 kg, start at [1.2, 0, 0] m }
          spring s from a to b { free_length: 1 m, stiffness: 75 N/m, damping: 0 N*s/m }
          output x = b.position.x - a.position.x - 1 m; }", "x"),
        |t| 0.2 * (10.0 * t).cos(),
        3.0,
        0.01,
    ),
    // Two masses between three springs: both modes at once.
    known(
        ("model Modes { gravity: none; world { frame far at [3, 0, 0] m }
          point a { mass: 1 kg, start at [1.1, 0, 0] m } point b { mass: 1 kg, start at [2, 0, 0] m }
          spring l from world to a { free_length: 1 m, stiffness: 100 N/m, damping: 0 N*s/m }
          spring c from a to b { free_length: 1 m, stiffness: 40 N/m, damping: 0 N*s/m }
          spring r from b to world.far { free_length: 1 m, stiffness: 100 N/m, damping: 0 N*s/m }
          output x = a.position.x - 1 m; }", "x"),
        |t| 0.05 * ((10.0 * t).cos() + (180f64.sqrt() * t).cos()),
        3.0,
        0.01,
    ),
    // A charge in a magnetic field goes round.
    known(
        ("model Charge { gravity: none; point p { mass: 1 kg, start at [0, 0, 0] m velocity [2, 0, 0] m/s }
          load m on p = [4 kg/s * p.velocity.y, -4 kg/s * p.velocity.x, 0 N]; }", "p.x"),
        |t| 0.5 * (4.0 * t).sin(),
        5.0,
        0.03,
    ),
    // The same from rest in an electric field: a cycloid.
    known(
        ("model Cycloid { gravity: none; point p { mass: 1 kg, start at [0, 0, 0] m }
          load m on p = [4 kg/s * p.velocity.y, 8 N - 4 kg/s * p.velocity.x, 0 N]; }", "p.x"),
        |t| 2.0 * t - 0.5 * (4.0 * t).sin(),
        5.0,
        0.03,
    ),
    // A logistic state.
    known(
        ("model Logistic { gravity: none; point p { mass: 1 kg } state s: number = 0.01 { rate: 3 (1/s) * s * (1 - s) } output y = s; }", "y"),
        |t| 1.0 / (1.0 + 99.0 * (-3.0 * t).exp()),
        4.0,
        0.05,
    ),
    // A state that grows and fades with time.
    known(
        ("model Season { gravity: none; point p { mass: 1 kg } state s: number = 1 { rate: 2 (1/s) * cos(2 rad/s * time) * s } output y = s; }", "y"),
        |t| (2.0 * t).sin().exp(),
        6.0,
        0.03,
    ),
    // A state that would have no bound after a second.
    known(
        ("model Runaway { gravity: none; point p { mass: 1 kg } state s: number = 1 { rate: 1 (1/s) * s * s } output y = s; }", "y"),
        |t| 1.0 / (1.0 - t),
        0.8,
        0.01,
    ),
    // Kepler, e = 0.3.
    known(
        ("model Round { gravity: point_mass { mu: 1 m^3/s^2, center: [0, 0, 0] m };
          point p { mass: 1 kg, start at [-1.3, 0, 0] m velocity [0, -sqrt(0.7 / 1.3) * 1 m/s, 0 m/s] } }", "p.x"),
        |t| kepler(0.3, t),
        12.0,
        0.05,
    ),
    // A body about its largest axis.
    known(
        ("model Spins { gravity: none; body b { mass: 1 kg, inertia: diag(1, 2, 2.5) kg*m^2, frame eye at [1, 0, 0] m,
          start at [0, 0, 0] m angular_velocity [0, 0, 2] rad/s }
          joint loose: free from world to b.com; output x = b.eye.position.x; }", "x"),
        |t| (2.0 * t).cos(),
        6.0,
        0.05,
    ),
    // A sled on an incline of 30 deg in oil.
    known(
        ("model Incline { gravity: [4.905, 0, -8.495709211125343] m/s^2; body b { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2 }
          joint rail: prismatic from world to b.com { axis: x, damping: 4 N*s/m } output x = rail.slide; }", "x"),
        |t| 4.905 / 2.0 * (t - (-(-2.0 * t).exp_m1()) / 2.0),
        3.0,
        0.05,
    ),
    // A sled on a spring and a damper, in relative coordinates.
    known(
        ("model Sled { gravity: none; coordinates: relative; body b { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
          joint rail: prismatic from world to b.com { axis: x, stiffness: 100 N/m, damping: 2 N*s/m, start: 0.5 m } output x = rail.slide; }", "x"),
        |t| damped(100.0, 2.0, 0.5, t),
        3.0,
        0.02,
    ),
    // A sled that meets a stop: even, half a swing on it, and back.
    known(
        ("model Stop { gravity: none; body b { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
          joint rail: prismatic from world to b.com { axis: x, start_rate: 1 m/s, stops: [none, 1 m], stop_stiffness: 400 N/m, stop_damping: 0 N*s/m } output x = rail.slide; }", "x"),
        |t| {
            let contact = PI / 20.0;
            match t - 1.0 {
                before if before < 0.0 => t,
                on if on < contact => 1.0 + (20.0 * on).sin() / 20.0,
                off => 1.0 - (off - contact),
            }
        },
        2.0,
        0.01,
    ),
    // A mass that bounces on a line from above the place where it is taut.
    known(
        ("model Cord { gravity: [0, 0, -9.81] m/s^2; point p { mass: 1 kg, start at [0, 0, -0.9] m }
          line l from world to p { free_length: 1 m, stiffness: 1 kN/m, damping: 0 N*s/m } }", "p.z"),
        bounce,
        1.5,
        0.005,
    ),
    // A push that fades: x = t − 1 + exp(−t).
    known(
        ("model Fades { gravity: none; point p { mass: 1 kg, start at [0, 0, 0] m } load f on p = [1 N * exp(-time / (1 s)), 0 N, 0 N]; }", "p.x"),
        |t| t + (-t).exp_m1(),
        5.0,
        0.1,
    ),
    // A bead on a spring on a rod that turns: √(K/m − Ω²).
    known(
        ("model Governor { gravity: none; body rod { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
          body bead { mass: 1 kg, inertia: diag(1e-3, 1e-3, 1e-3) kg*m^2 }
          joint m: hinge from world to rod.com { axis: z, motor: 6 rad/s * time }
          joint s: prismatic from rod.com to bead.com { axis: x, start: 10 cm, stiffness: 100 N/m } output x = s.slide; }", "x"),
        |t| 0.1 * (8.0 * t).cos(),
        3.0,
        0.02,
    ),
    // Two lines without damping behind each other, the node between them in balance.
    known(
        ("model Still { gravity: [0, 0, -9.81] m/s^2; point n { equilibrium: static } point p { mass: 1 kg, start at [0, 0, -2.01] m }
          line a from world to n { free_length: 1 m, stiffness: 2 kN/m, damping: 0 N*s/m }
          line b from n to p { free_length: 1 m, stiffness: 2 kN/m, damping: 0 N*s/m } }", "p.z"),
        |t| -2.0 - 9.81e-3 - 1.9e-4 * (1e3f64.sqrt() * t).cos(),
        1.0,
        0.004,
    ),
    // A pendulum from 120 deg, on a rod without mass and on a hinge: sin(φ/2) = k sn(K − ω t).
    known(
        ("model Rod { gravity: [0, 0, -9.81] m/s^2; point b { mass: 1 kg, start at [sqrt(3) / 2 * 1 m, 0 m, 0.5 m] }
          joint d: distance from world to b { length: 1 m } output x = b.position.z; }", "x"),
        |t| 2.0 * pendulum(9.81, t).powi(2) - 1.0,
        3.0,
        0.02,
    ),
    known(
        ("model Arm { gravity: [0, 0, -9.81] m/s^2; coordinates: relative;
          body arm { mass: 1 kg, inertia: diag(0.25, 0.25, 0.25) kg*m^2, frame top at [0, 0, 0.5] m }
          joint pin: hinge from world to arm.top { axis: y, start: 120 deg } output x = sin(pin.angle / 2); }", "x"),
        |t| pendulum(9.81, t),
        3.0,
        0.02,
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

/// Height of a mass of 1 kg dropped from 0.1 m above where a cord of 1 m and 1 kN/m is taut.
fn bounce(t: f64) -> f64 {
    let (g, w, drop) = (9.81_f64, 1e3f64.sqrt(), 0.1_f64);
    let fall = (2.0 * drop / g).sqrt();
    let (speed, sag) = (g * fall, g / 1e3);
    let phase = (speed / w).atan2(sag);
    let contact = (2.0 * PI - 2.0 * phase) / w;
    // Time since the last time that it was highest.
    let since = t.rem_euclid(2.0 * fall + contact);
    let up = since.min(2.0 * fall + contact - since);
    match since < fall || since >= fall + contact {
        true => -1.0 + drop - 0.5 * g * up * up,
        false => -1.0 - sag + sag.hypot(speed / w) * (w * (since - fall) + phase).cos(),
    }
}

/// sin(φ/2) of a pendulum from 120 deg, φ̈ = −w² sin φ with w² = `square`: k sn(K + w t, k) by the arithmetic-geometric mean (Abramowitz and Stegun 16.4).
fn pendulum(square: f64, t: f64) -> f64 {
    let k = (PI / 3.0).sin();
    let (mut a, mut b, mut c) = (vec![1.0], (1.0 - k * k).sqrt(), vec![k]);
    while c.last().is_some_and(|c| *c > 1e-16) && a.len() < 12 {
        let last = a[a.len() - 1];
        a.push(0.5 * (last + b));
        c.push(0.5 * (last - b));
        b = (last * b).sqrt();
    }
    let last = a.len() - 1;
    let u = 0.5 * PI / a[last] + square.sqrt() * t;
    let mut phi = a[last] * u * f64::from(1 << last);
    for n in (1..=last).rev() {
        phi = 0.5 * (phi + (c[n] / a[n] * phi.sin()).asin());
    }
    k * phi.sin()
}
