//! The cases: what is extreme, and what is promised of it.

use mbd_runtime::{Method, Options};

use super::{ExtremeCase, ExtremeMeasure, Promise};

fn case(
    group: &'static str,
    amount: impl Into<String>,
    text: impl Into<String>,
    (method, until): (Method, f64),
    promise: Promise,
) -> ExtremeCase {
    let options = Options::of(method);
    // Adaptive runs tell their energy where they integrate what gives and takes it.
    let options = Options {
        work: method.fixed_step().is_none(),
        ..options
    };
    ExtremeCase {
        group,
        amount: amount.into(),
        text: text.into(),
        start: Vec::new(),
        options,
        until,
        single: false,
        measure: ExtremeMeasure::Energy,
        promise,
    }
}

const RATTLE: fn(f64) -> Method = |step| Method::Rattle { step };
const RK4: fn(f64) -> Method = |step| Method::Rk4 { step };
const AUTO: fn(f64) -> Method = |rtol| Method::Auto {
    rtol,
    max_step: f64::INFINITY,
};

/// A chain of four rods on hinges, of these masses [kg], let go from a bend.
fn chain(masses: [f64; 4]) -> String {
    let mut text = String::from("model Chain { gravity: [0, 0, -9.81] m/s^2; ");
    for (index, mass) in masses.into_iter().enumerate() {
        let inertia = mass / 12.0;
        text += &format!(
            "body b{index} {{ mass: {mass:e} kg, inertia: diag({inertia:e}, {inertia:e}, {inertia:e}) kg*m^2,
             frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }} "
        );
        let from = match index {
            0 => "world".to_owned(),
            _ => format!("b{}.end", index - 1),
        };
        text += &format!(
            "joint j{index}: hinge from {from} to b{index}.top {{ axis: y, start: 0.4 rad }} "
        );
    }
    text + "}"
}

/// A mass of 1 kg let go above a line that catches it.
fn caught(stiffness: f64, damping: f64) -> String {
    format!(
        "model Caught {{ gravity: [0, 0, -9.81] m/s^2; point bob {{ mass: 1 kg, start at [0, 0, -0.9] m }}
         line rope from world to bob {{ free_length: 1 m, stiffness: {stiffness:e} N/m, damping: {damping:e} N*s/m }} }}"
    )
}

/// A pendulum on a spring, everything moved away from the origin.
fn away(distance: f64) -> String {
    format!(
        "model Away {{ gravity: [0, 0, -9.81] m/s^2; world {{ frame hook at [{distance:e}, 0, 0] m }}
         point bob {{ mass: 1 kg, start at [{distance:e} + 0.3, 0, -1] m }}
         spring rope from world.hook to bob {{ free_length: 1 m, stiffness: 1e4 N/m, damping: 1 N*s/m }} }}"
    )
}

const FREE: &str = "model Free { gravity: none; body b { mass: 1 kg, inertia: diag(1, 2, 3) kg*m^2 } joint loose: free from world to b.com; }";

/// An arm on a hinge with a spring, damped to a tenth of critical, in relative coordinates.
fn nods(stiffness: f64) -> String {
    let damping = 0.2 * f64::sqrt(0.5 * stiffness);
    format!(
        "model Nods {{ coordinates: relative; gravity: [0, 0, -9.81] m/s^2;
         body arm {{ mass: 1 kg, inertia: diag(0.25, 0.25, 0.25) kg*m^2, frame top at [0, 0, 0.5] m }}
         joint pin: hinge from world to arm.top {{ axis: y, start: 0.1 rad, stiffness: {stiffness:e} N*m, damping: {damping:e} N*m*s }} }}"
    )
}

/// Three cranks under one bar, each on a hinge at both ends: the third repeats the others, in their plane and out of it; they pass both flat positions.
const REDUNDANT: &str = "model Redundant { coordinates: absolute; gravity: none;
    body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame low at [0, 0, -0.5] m, frame high at [0, 0, 0.5] m }
    body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame low at [0, 0, -0.5] m, frame high at [0, 0, 0.5] m }
    body c { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame low at [0, 0, -0.5] m, frame high at [0, 0, 0.5] m }
    body bar { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [-1, 0, 0] m, frame three at [1, 0, 0] m }
    world { frame one at [-1, 0, 0] m, frame three at [1, 0, 0] m }
    joint p: hinge from world.one to a.low { axis: y, start: 0.7 rad, start_rate: 3 rad/s }
    joint q: hinge from world to b.low { axis: y, start: 0.7 rad }
    joint r: hinge from world.three to c.low { axis: y, start: 0.7 rad }
    joint s: hinge from a.high to bar.one { axis: y }
    joint t: hinge from b.high to bar.com { axis: y }
    joint u: hinge from c.high to bar.three { axis: y } }";

/// Two cranks and a bar, all in one line at the start, where rows lose rank, and pushed through.
const FLAT: &str = "model Flat { gravity: none;
    body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [-0.5, 0, 0] m, frame two at [0.5, 0, 0] m, start at [0.5, 0, 0] m velocity [0, 0, -1] m/s }
    body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [-1, 0, 0] m, frame two at [1, 0, 0] m, start at [2, 0, 0] m velocity [0, 0, -2] m/s }
    body c { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [-0.5, 0, 0] m, frame two at [0.5, 0, 0] m, start at [2.5, 0, 0] m velocity [0, 0, -1] m/s }
    world { frame far at [2, 0, 0] m }
    joint p: hinge from world to a.one { axis: y }
    joint q: hinge from a.two to b.one { axis: y }
    joint r: hinge from b.two to c.two { axis: y }
    joint s: hinge from world.far to c.one { axis: y } }";

/// All cases; `reduced` leaves out those that run for long.
#[must_use]
pub fn cases(reduced: bool) -> Vec<ExtremeCase> {
    let mut all = Vec::new();
    for ratio in [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9] {
        for (place, masses) in [
            ("tip", [1.0, 1.0, 1.0, ratio]),
            ("alternating", [1.0, ratio, 1.0, ratio]),
        ] {
            all.push(case(
                "mass ratio",
                format!("{ratio:.0e}, {place}"),
                chain(masses),
                (RK4(1e-3), 0.5),
                Promise::KeepsOrStops(0.02),
            ));
        }
    }
    for stiffness in [1e-2, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12] {
        // Damped to a tenth of critical.
        let damping = 0.2 * f64::sqrt(stiffness);
        let text = caught(stiffness, damping);
        let amount = format!("K = {stiffness:.0e} N/m, adaptive");
        let promise = Promise::Keeps(1e-3);
        all.push(case(
            "stiffness",
            amount,
            text.clone(),
            (AUTO(1e-6), 0.5),
            promise,
        ));
        let amount = format!("K = {stiffness:.0e} N/m, steps of 1 ms");
        let promise = Promise::KeepsOrStops(0.02);
        all.push(case("stiffness", amount, text, (RK4(1e-3), 0.5), promise));
    }
    for stiffness in [1e-2, 1e2, 1e6, 1e10] {
        let text = nods(stiffness);
        for (how, method, promise) in [
            ("adaptive", AUTO(1e-6), Promise::Keeps(1e-3)),
            ("steps of 1 ms", RK4(1e-3), Promise::KeepsOrStops(0.02)),
        ] {
            let amount = format!("K = {stiffness:.0e} N m in relative coordinates, {how}");
            let run = (method, 0.5);
            all.push(case("stiffness", amount, text.clone(), run, promise));
        }
    }
    for damping in [1e3, 1e6, 1e9] {
        let text = caught(1e3, damping);
        let amount = format!("C = {damping:.0e} N s/m, adaptive");
        all.push(case(
            "damping",
            amount,
            text.clone(),
            (AUTO(1e-6), 2.0),
            Promise::Keeps(1e-3),
        ));
        let amount = format!("C = {damping:.0e} N s/m, steps of 1 ms");
        all.push(case(
            "damping",
            amount,
            text,
            (RK4(1e-3), 2.0),
            Promise::KeepsOrStops(0.02),
        ));
    }
    for (spin, step) in [(1e2, 1e-4), (1e4, 1e-6), (1e4, 1e-4)] {
        let promise = match spin * step {
            turn if turn < 0.1 => Promise::Keeps(1e-6),
            _ => Promise::Stops("unstable_step"),
        };
        all.push(ExtremeCase {
            start: vec![(7 + 3, 1e-3 * spin), (7 + 4, spin)],
            ..case(
                "spin",
                format!("{spin:.0e} rad/s, h = {step:.0e} s"),
                FREE,
                (RK4(step), 1e3 * step),
                promise,
            )
        });
    }
    for step in [0.05, 0.2, 1.0] {
        let promise = Promise::KeepsOrStops(0.02);
        all.push(case(
            "step too long",
            format!("a chain, h = {step} s"),
            chain([1.0; 4]),
            (RK4(step), 10.0),
            promise,
        ));
        all.push(case(
            "step too long",
            format!("a line of 1e4 N/m, h = {step} s"),
            caught(1e4, 10.0),
            (RK4(step), 10.0),
            promise,
        ));
    }
    for method in [RK4(1e-3), AUTO(1e-8)] {
        all.push(case(
            "flat linkage",
            method.to_string(),
            FLAT,
            (method, 2.0),
            Promise::Keeps(1e-6),
        ));
    }
    for method in [RK4(1e-3), AUTO(1e-8)] {
        all.push(case(
            "redundant linkage",
            method.to_string(),
            REDUNDANT,
            (method, 2.0),
            Promise::Keeps(1e-9),
        ));
    }
    let slack =
        "model Slack { gravity: none; point bob { mass: 1 kg, start at [0.1, 0, 0] m } point knot;
         world { frame left at [-1, 0, 0] m, frame right at [1, 0, 0] m }
         line a from world.left to knot { free_length: 2 m, stiffness: 1 kN/m }
         line b from world.right to knot { free_length: 2 m, stiffness: 1 kN/m }
         line c from knot to bob { free_length: 2 m, stiffness: 1 kN/m } }";
    all.push(case(
        "all lines slack",
        "a knot of three",
        slack,
        (AUTO(1e-6), 1.0),
        Promise::Keeps(1e-9),
    ));
    let zero = "model Zero { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg }
         spring s from world to bob { free_length: 0 m, stiffness: 100 N/m, damping: 1 N*s/m } }";
    all.push(case(
        "zero length",
        "a spring from where it hangs",
        zero,
        (AUTO(1e-8), 1.0),
        Promise::Keeps(1e-6),
    ));
    for (distance, promise) in [
        (1e3, Promise::Keeps(1e-6)),
        (1e6, Promise::Keeps(1e-6)),
        (1e9, Promise::Keeps(1e-3)),
        (1e12, Promise::Stops("lost_digits")),
    ] {
        all.push(case(
            "far from the origin",
            format!("{distance:.0e} m"),
            away(distance),
            (AUTO(1e-8), 1.0),
            promise,
        ));
    }
    for (distance, promise) in [
        (1.0, Promise::Keeps(1e-3)),
        (1e3, Promise::KeepsOrStops(0.05)),
        (1e6, Promise::Stops("lost_digits")),
    ] {
        all.push(ExtremeCase {
            single: true,
            ..case(
                "single precision",
                format!("{distance:.0e} m away"),
                away(distance),
                (RK4(1e-3), 1.0),
                promise,
            )
        });
    }
    all.push(ExtremeCase {
        single: true,
        ..case(
            "single precision",
            "a chain",
            chain([1.0; 4]),
            (RK4(1e-3), 2.0),
            Promise::Keeps(1e-4),
        )
    });
    for (stiffness, promise) in [
        (1e3, Promise::Keeps(1e-3)),
        (1e6, Promise::KeepsOrStops(0.02)),
    ] {
        all.push(ExtremeCase {
            single: true,
            ..case(
                "single precision",
                format!("a line of {stiffness:.0e} N/m"),
                caught(stiffness, 10.0),
                (RK4(1e-4), 0.5),
                promise,
            )
        });
    }
    // One oscillator of hω = 1.5 in metres and seconds, in micrometres and in days: found too long for its step in all of them.
    for (unit, length, mass, time) in [
        ("m, kg, s", 1.0, 1.0, 1.0),
        ("µm, mg", 1e-6, 1e-6, 1.0),
        ("km, t, hours", 1e3, 1e3, 3600.0),
    ] {
        let stiffness = mass * f64::powi(1.5 / time, 2);
        let text = format!(
            "model Units {{ gravity: none; point bob {{ mass: {mass:e} kg, start at [{:e}, 0, 0] m }}
             spring s from world to bob {{ free_length: {length:e} m, stiffness: {stiffness:e} N/m, damping: 0 N*s/m }} }}",
            1.1 * length
        );
        all.push(case(
            "units",
            unit,
            text,
            (RK4(time), 100.0 * time),
            Promise::Stops("unstable_step"),
        ));
    }
    let steps = if reduced { 1e4 } else { 1e6 };
    all.push(case(
        "drift",
        format!("a chain, {steps:.0e} steps"),
        chain([1.0; 4]),
        (RK4(1e-3), 1e-3 * steps),
        Promise::Keeps(1e-3),
    ));
    all.extend(long_runs(steps));
    all
}

/// What Rattle keeps over many steps, and back again.
fn long_runs(steps: f64) -> Vec<ExtremeCase> {
    let mut all = Vec::new();
    // Energy is off by (h |ω|)⁴ and stays there; momentum only by rounding.
    for (spin, step, measure, bound) in [
        (1.0, 0.01, ExtremeMeasure::Energy, 1e-10),
        (1.0, 0.1, ExtremeMeasure::Energy, 1e-7),
        (1.0, 0.1, ExtremeMeasure::Momentum, 1e-11),
        (1.0, 0.1, ExtremeMeasure::Quaternion, 1e-14),
        (1e4, 1e-4, ExtremeMeasure::Energy, 1e-3),
        (1e4, 1e-4, ExtremeMeasure::Momentum, 1e-11),
    ] {
        let amount = format!("spin of {spin:.0e} rad/s, h = {step:.0e} s, {steps:.0e} steps");
        let run = (RATTLE(step), step * steps);
        all.push(ExtremeCase {
            start: vec![(7 + 3, 1e-3 * spin), (7 + 4, spin), (7 + 5, 1e-3 * spin)],
            measure,
            ..case("long run", amount, FREE, run, Promise::Keeps(bound))
        });
    }
    // The faster a rod whips round, the more is off for that moment, as (h ω)⁴; nothing of it stays.
    let steps = 0.3 * steps;
    for (step, measure) in [
        (1e-3, ExtremeMeasure::LostForGood),
        (5e-4, ExtremeMeasure::Energy),
    ] {
        let amount = format!("a chain, h = {step:.0e} s, {steps:.0e} steps of Rattle");
        let run = (RATTLE(step), step * steps);
        all.push(ExtremeCase {
            measure,
            ..case(
                "long run",
                amount,
                chain([1.0; 4]),
                run,
                Promise::Keeps(1e-8),
            )
        });
    }
    for (what, text) in [
        ("a chain", chain([1.0; 4])),
        ("a tumbling body", FREE.to_owned()),
    ] {
        all.push(ExtremeCase {
            start: match what {
                "a chain" => Vec::new(),
                _ => vec![(7 + 3, 0.5), (7 + 4, 1.0), (7 + 5, -0.3)],
            },
            measure: ExtremeMeasure::Return,
            ..case(
                "time reversal",
                format!("{what}, 2000 steps of Rattle and back"),
                text,
                (RATTLE(1e-3), 2.0),
                Promise::Keeps(1e-12),
            )
        });
    }
    all
}
