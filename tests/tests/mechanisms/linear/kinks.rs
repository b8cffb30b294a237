//! Places with another linear system on the other side, against what the law is on either.

use mbd_compiler::read_text;
use mbd_runtime::{Generic, Kink, LinearisationError, Options, Simulation, StateSpace};

use super::generic;

fn model(text: &str) -> Generic<f64> {
    let read = read_text(text);
    generic(read.scene.unwrap_or_else(|| panic!("{:?}", read.errors)))
}

fn space(text: &str) -> StateSpace {
    let model = model(text);
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    run.start().expect("a start");
    run.linearise(&[]).expect("a linear system")
}

/// What changes at a kink, by what, and the derivatives on the two sides from the lesser on.
fn told(kink: &Kink) -> (&str, &str, [f64; 2]) {
    let [a, b] = kink.sides;
    (&kink.of.name, &kink.by.name, [a.min(b), a.max(b)])
}

/// A mass of 2 kg that hangs below a hook.
fn hung(depth: f64) -> String {
    format!(
        "model hung {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world {{ frame hook at [0.0, 0.0, 0.0] m }}
            point bob {{ mass: 2 kg, start at [0.0, 0.0, -{depth}] m }}
            line string from world.hook to bob {{ free_length: 1 m, stiffness: 100 N/m }}
        }}"
    )
}

#[test]
fn a_line_that_is_just_straight_pulls_on_one_side() {
    let kinks = space(&hung(1.0)).kinks;
    let [kink] = kinks.as_slice() else {
        panic!("{kinks:?}");
    };
    let (of, by, [taut, slack]) = told(kink);
    assert_eq!((of, by, kink.is_rate), ("bob.vz", "bob.z", true));
    // −K/m.
    assert!((taut + 50.0).abs() < 1e-4 && slack == 0.0, "{kink:?}");
    for depth in [0.999, 1.001] {
        assert_eq!(space(&hung(depth)).kinks, [], "{depth}");
    }
}

#[test]
fn choices_of_inputs_states_and_outputs_have_two_sides() {
    let kinks = space(
        "model choices {
            gravity: none;
            input push: force = 0 N;
            point bob { mass: 4 kg }
            load pushed on bob = [max(0 N, push), 0 N, 0 N];
            state tank = 2 m { rate: if(tank < 2 m, 3 (1/s), 5 (1/s)) * (tank - 2 m) }
            output off = abs(bob.position.y);
        }",
    )
    .kinks;
    let all: Vec<_> = kinks.iter().map(told).collect();
    let [pushed, tank, off] = all.as_slice() else {
        panic!("{kinks:?}");
    };
    for (got, (of, by, sides)) in [
        (pushed, ("bob.vx", "push", [0.0, 0.25])),
        (tank, ("tank", "tank", [3.0, 5.0])),
        (off, ("off", "bob.y", [-1.0, 1.0])),
    ] {
        assert_eq!((got.0, got.1), (of, by));
        let error = |k: usize| (got.2[k] - sides[k]).abs();
        assert!(error(0) < 1e-12 && error(1) < 1e-12, "{got:?}");
    }
}

#[test]
fn what_is_smooth_has_no_kink_however_it_bends() {
    // Drag by the square of a speed that is zero, by a choice and by a length; a root that is only steep; a force from afar; a body that is turned.
    let smooth = "model smooth {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        point slow { mass: 1 kg }
        point far { mass: 1 kg, start at [3e7, 0.0, 0.0] m }
        body rod { mass: 1 kg, inertia: diag(0.2, 0.3, 0.4) kg*m^2, frame end at [0.1, 0.2, 1.0] m }
        joint ball: spherical from world to rod.end
        const C = 3 N*s^2/m^2;
        load choice on slow = [-C * abs(slow.velocity.x) * slow.velocity.x, 0 N, 9.81 N];
        load size on slow = -C * norm(slow.velocity) * slow.velocity;
        load pull on far = -1e-3 N/m * far.position;
        load steep on far = [2 N * sqrt(1 + (far.velocity.x / 0.001 m/s)^2), 0 N, 0 N];
    }";
    let found = space(smooth);
    assert_eq!(found.kinks, []);
    assert!(found.a.amax() > 0.0);
}

#[test]
fn a_rest_on_a_stop_that_is_just_touched_is_told() {
    let text = "model rests {
        gravity: none;
        planar: xz;
        body door { mass: 1 kg, inertia: diag(1, 2, 1) kg*m^2, frame edge at [-1.0, 0.0, 0.0] m }
        joint hinge: hinge from world to door.edge { axis: y, stops: [0, 120] deg, stop_stiffness: 300 N*m/rad }
    }";
    let model = model(text);
    let run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    let rest = run.trim().hold("hinge.angle").solve().expect("a rest");
    let kinks = rest.space.kinks;
    let spin = kinks.iter().find(|kink| kink.of.name == "door.omega_y");
    let (_, by, [touched, free]) = told(spin.expect("a stop"));
    assert_eq!(by, "hinge.angle");
    // −k/(I + m l²).
    assert!(
        (touched + 100.0).abs() < 1e-4 && free.abs() < 1e-12,
        "{kinks:?}"
    );
}

#[test]
fn an_angle_at_the_end_of_its_cosine_has_its_slopes_in_both_families() {
    for family in ["absolute", "relative"] {
        let kinks = space(&format!(
            "model lean {{
                coordinates: {family};
                gravity: none;
                body rod {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
                joint pin: hinge from world to rod.com {{ axis: y }}
                output tilt = acos(dot(rod.z, world.z));
                output lean = asin(dot(rod.z, world.z));
            }}"
        ))
        .kinks;
        let all: Vec<_> = kinks.iter().map(told).collect();
        let names: Vec<_> = all.iter().map(|told| (told.0, told.1)).collect();
        let by = "pin.angle";
        assert_eq!(names, [("tilt", by), ("lean", by)], "{family}");
        for (of, _, sides) in all {
            // A cosine is 1 − θ²/2 of sixteen digits: an ulp of it is 1.4e-3 of θ² at 4e-7.
            let errors = [sides[0] + 1.0, sides[1] - 1.0];
            assert!(
                errors.iter().all(|error| error.abs() < 5e-3),
                "{family}: {of} {sides:?}"
            );
        }
    }
}

#[test]
fn the_root_of_what_is_zero_has_no_derivative_there() {
    let linear = |what: &str, start: &str| {
        let model = model(&format!(
            "model roots {{
                gravity: none;
                point bob {{ mass: 1 kg, start at [{start}, 0.0, 0.0] m }}
                {what}
            }}"
        ));
        let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
        run.start().expect("a start");
        run.linearise(&[])
    };
    let off = |law: &str| format!("let x = bob.position.x / 1 m; output off = {law};");
    let tank = "state tank = 0 m { rate: -1 (m/s) * sqrt(max(0 m, tank) / 1 m) }".to_owned();
    for (what, of, is_rate, by) in [
        (off("sqrt(abs(x))"), "off", false, "bob.x"),
        (off("1e-9 * sqrt(abs(x))"), "off", false, "bob.x"),
        // Of one side alone, by rule or because there is no other.
        (off("sqrt(max(0, x))"), "off", false, "bob.x"),
        (off("sqrt(x)"), "off", false, "bob.x"),
        (off("acos(1 - abs(x))"), "off", false, "bob.x"),
        (tank, "tank", true, "tank"),
    ] {
        let no = linear(&what, "0.0").expect_err(&what);
        let (of, by) = (of.to_owned(), by.to_owned());
        assert_eq!(no, LinearisationError::NoDerivative { of, is_rate, by });
        linear(&what, "0.5").map_or_else(|_| assert!(is_rate), |_| ());
    }
    // Lengths, and what is steep within a hair without being a root.
    for law in [
        "sqrt(x * x)",
        "norm(bob.position) / 1 m",
        "x / sqrt(x * x + 1e-24)",
        "x / sqrt(x * x + 1e-14)",
        "tanh(1e12 * x)",
        "atan(1e10 * x)",
        "(x + 1e-6) ^ 2",
        "sqrt(abs(x)) * 0",
    ] {
        linear(&off(law), "0.0").unwrap_or_else(|no| panic!("{law}: {no}"));
    }
}
