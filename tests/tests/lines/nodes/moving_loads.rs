//! Rate nodes that one line or two hold under a load that changes: they move with the load.

use mbd_compiler::Interpreted;
use mbd_runtime::{Options, Quantity, Simulation, linearise};
use tests::declared::read;

/// A node on lines from two fixed places, as far apart as the second says, under 100 N that turn about y at 0.5 rad/s; what the second line is made of.
fn turning(second: &str) -> mbd_scene::Scene {
    read(&format!(
        "model Turning {{ gravity: none;
            world {{ frame left at [0, -0.6, 0] m, frame right at [0, 0.6, 0] m }}
            point k {{ equilibrium: rate }}
            line a from world.left to k {{ free_length: 1 m, stiffness: 10 kN/m, damping: 50 N*s/m }}
            line b from world.right to k {{ {second} }}
            load w on k = [100 N * sin(0.5 rad/s * time), 0 N, -100 N * cos(0.5 rad/s * time)];
            output place = k.position;
            output speed = k.velocity;
        }}"
    ))
}

/// Two equal lines carry the load on a circle about the line through their anchors, and one line that is taut alone on a circle about its anchor: the tension
/// stays, and the node turns with the load. Closed form: p = c + r W/|W|, w = r ω (cos ωt, 0, sin ωt). The velocity was zero there, and a tolerance of 1e-8
/// led to steps of 4e-9 s.
#[test]
fn a_node_on_one_or_two_lines_turns_with_its_load() {
    let same = "free_length: 1 m, stiffness: 10 kN/m, damping: 50 N*s/m";
    let slack = "free_length: 9 m, stiffness: 10 kN/m, damping: 50 N*s/m";
    // 2 K (d − 1) h/d = 100 N with d² = h² + 0.36: by Newton.
    let mut h: f64 = 0.8;
    for _ in 0..50 {
        let d = h.hypot(0.6);
        let force = 2e4 * h * (1.0 - 1.0 / d) - 100.0;
        h -= force / (2e4 * (1.0 - 1.0 / d + h * h / d.powi(3)));
    }
    for (second, y, radius) in [(same, 0.0, h), (slack, -0.6, 1.01)] {
        let model = Interpreted::<f64>::new(turning(second), &[]).expect("no params");
        for (options, allowed) in [
            (Options::tsit5(1e-8), 1e-5),
            (Options::vern7(1e-10), 1e-8),
            (Options::rodas5p(1e-7), 1e-6),
            (Options::rk4(0.001), 1e-7),
        ] {
            let adaptive = !matches!(options.method, mbd_runtime::Method::Rk4 { .. });
            let method = format!("{:?}", options.method);
            let mut run = Simulation::new(&model, options).expect("a method");
            let reached = run.run(2.0);
            reached.unwrap_or_else(|error| panic!("{method}: {error}"));
            let mut told = [0.0; 6];
            run.evaluate(Quantity::Outputs, &mut told).expect("a state");
            let (sine, cosine) = 1.0_f64.sin_cos();
            let exact = [
                radius * sine,
                y,
                -radius * cosine,
                0.5 * radius * cosine,
                0.0,
                0.5 * radius * sine,
            ];
            for (found, exact) in told.iter().zip(exact) {
                assert!(
                    (found - exact).abs() < allowed,
                    "{method}: {:e}",
                    found - exact
                );
            }
            let steps = run.statistics().steps;
            assert!(!adaptive || steps < 3000, "{method}: {steps} steps");
        }
    }
}

/// A load that follows a body: W = c p, |p| the distance of the body from the anchor. The node is on the ray to the body, and w = d v_⊥/|p|, so that its
/// derivative by the velocity of the body across the ray is d/|p|.
#[test]
fn the_derivative_of_a_node_that_a_load_turns_is_that_of_the_load() {
    let scene = read(
        "model Follows { gravity: none;
            world { frame top at [0, 0, 0] m, frame far at [0, 0, 3] m }
            body lead { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2, start at [0, 0, -4] m velocity [0.3, -0.2, 0] m/s }
            joint freely: free from world to lead.com;
            point k { equilibrium: rate }
            line a from world.top to k { free_length: 1 m, stiffness: 10 kN/m, damping: 50 N*s/m }
            line b from world.far to k { free_length: 9 m, stiffness: 10 kN/m, damping: 50 N*s/m }
            load w on k = 25 N/m * (lead.position - world.top.position);
            output speed = k.velocity;
        }",
    );
    let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("a method");
    run.start().expect("a start");
    let mut speed = [0.0; 3];
    run.evaluate(Quantity::Outputs, &mut speed)
        .expect("a state");
    let share = 1.01 / 4.0;
    for (found, exact) in speed.iter().zip([0.3 * share, -0.2 * share, 0.0]) {
        assert!((found - exact).abs() < 1e-12, "{speed:?}");
    }
    let state = run.state().to_vec();
    let linear = linearise(&model, 0.0, &state, &[] as &[f64]).expect("derivatives");
    let at = |name: String| {
        let found = linear.states.iter().position(|state| state.name == name);
        found.unwrap_or_else(|| panic!("{name} among {:?}", linear.states))
    };
    for row in ["x", "y", "z"] {
        for column in ["x", "y"] {
            let exact = if row == column { share } else { 0.0 };
            let found = linear.a[(at(format!("k.{row}")), at(format!("lead.v{column}")))];
            assert!((found - exact).abs() < 1e-12, "{row} {column}: {found}");
        }
    }
}
