//! What is driven: in loops, by states, with parts, from rest; generated and interpreted equations are compared elsewhere, here it is what a run says.

use mbd_compiler::Interpreted;
use mbd_runtime::{Generic, Model, Options, Quantity, Scalar, Simulation, StepError, linearise};
use tests::declared::read;

/// A declaration in either family of coordinates.
const FAMILIES: [&str; 2] = ["absolute", "relative"];

/// What ends a run, if anything does.
fn cause(text: &str, options: Options, until: f64) -> Option<StepError> {
    let generic = Generic::<f64>::with_defaults(read(text)).expect("defaults");
    let interpreted = Interpreted::<f64>::new(read(text), generic.params()).expect("defaults");
    let [a, b] = [&generic as &dyn Model<f64>, &interpreted].map(|model| {
        let mut run = Simulation::new(model, options).expect("options");
        run.run(until).err().map(|error| error.cause)
    });
    assert_eq!(
        a.as_ref().map(StepError::status),
        b.as_ref().map(StepError::status),
        "{text}"
    );
    a
}

/// A run that ends well.
fn run_of<T: Scalar>(text: &str, options: Options, until: f64) -> Simulation<T> {
    let model = Generic::<T>::with_defaults(read(text)).expect("defaults");
    let mut run = Simulation::new(&model, options).expect("options");
    run.run(until)
        .unwrap_or_else(|error| panic!("{text}\n{error}"));
    run
}

fn outputs<T: Scalar>(run: &mut Simulation<T>) -> Vec<f64> {
    let count = run.model().layout().len(Quantity::Outputs);
    let mut out = vec![T::zero(); count];
    run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
    out.iter().map(|x| x.to_f64()).collect()
}

#[test]
fn points_alone_fall_alike_in_every_family() {
    let text = |family: &str| {
        format!(
            "model Points {{ coordinates: {family}; gravity: [0, 0, -9.81] m/s^2;
             point a {{ mass: 1 kg }} point b {{ mass: 1 kg, start at [0, 0, 1.2] m }}
             line l from a to b {{ free_length: 1 m, stiffness: 1 kN/m }}
             output h = b.position.z; output low = a.position.z; }}"
        )
    };
    let heights = ["absolute", "relative", "auto"].map(|family| {
        let mut run = run_of::<f64>(&text(family), Options::tsit5(1e-10), 0.3);
        outputs(&mut run)
    });
    for own in &heights {
        assert!((own[0] - heights[0][0]).abs() < 1e-9, "{heights:?}");
        // What pulls between them moves their centre nowhere.
        assert!((own[0] + own[1] - 1.2 + 9.81 * 0.09).abs() < 1e-9);
    }
    let single = run_of::<f32>(&text("relative"), Options::tsit5(1e-5), 0.3);
    assert!(single.state().iter().all(|x| x.is_finite()));
}

/// A four-bar linkage in space with a motor at its crank.
fn four(family: &str) -> String {
    format!(
        "model Four {{ gravity: [0, 0, -9.81] m/s^2; coordinates: {family};
         world {{ frame d at [1, 0, 0] m }}
         body a {{ mass: 1 kg, inertia: diag(0.01, 0.1, 0.1) kg*m^2, frame l at [-0.15, 0, 0] m, frame r at [0.15, 0, 0] m }}
         body b {{ mass: 1 kg, inertia: diag(0.01, 0.1, 0.1) kg*m^2, frame l at [-0.5, 0, 0] m, frame r at [0.5, 0, 0] m }}
         body c {{ mass: 1 kg, inertia: diag(0.01, 0.1, 0.1) kg*m^2, frame l at [-0.4, 0, 0] m, frame r at [0.4, 0, 0] m }}
         joint ja: hinge from world to a.l {{ axis: y, motor: 30 deg + 2 rad/s * time }}
         joint jb: hinge from a.r to b.l {{ axis: y }}
         joint jd: hinge from world.d to c.l {{ axis: y }}
         loop joint jc: hinge from b.r to c.r {{ axis: y }}
         output q = ja.angle; output effort = ja.motor_torque; output p = b.position; }}"
    )
}

#[test]
fn a_driven_loop_runs_and_is_linearised_by_methods_with_derivatives() {
    let mut found = Vec::new();
    for family in FAMILIES {
        for options in [
            Options::rodas5p(1e-8),
            Options::auto(1e-8),
            Options::tsit5(1e-9),
        ] {
            let mut run = run_of::<f64>(&four(family), options, 0.7);
            let out = outputs(&mut run);
            let turned = 30_f64.to_radians() + 1.4;
            assert!((out[0] - turned).abs() < 1e-7, "{family}: {out:?}");
            found.push(out);
        }
        let model = Generic::<f64>::with_defaults(read(&four(family))).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
        run.start().expect("a start");
        let system = linearise(&model, 0.0, run.state(), &[]);
        assert!(system.is_ok(), "{family}: {system:?}");
    }
    for own in &found {
        for (a, b) in own.iter().zip(&found[0]) {
            assert!((a - b).abs() < 1e-5 * (1.0 + b.abs()), "{found:?}");
        }
    }
}

/// A hinge whose motor is told this, with a state φ that moves at 2 rad/s.
fn told(family: &str, motor: &str) -> String {
    format!(
        "model Told {{ coordinates: {family}; gravity: none;
         body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
         state phi = 0 {{ rate: 2 rad/s }}
         state omega = 0 rad/s {{ rate: 3 rad/s^2 - omega / (1 s) }}
         state theta = 0 {{ rate: omega }}
         joint j: hinge from world to a.com {{ axis: z, motor: {motor} }}
         output w = j.angle_rate; output q = j.angle; }}"
    )
}

#[test]
fn rates_that_are_not_those_of_the_value_end_the_run() {
    for family in FAMILIES {
        for motor in [
            "[phi, 0, 0]",
            "[phi, 2 rad/s, 1 rad/s^2]",
            "[1 + 2 rad/s * time, 3 rad/s, 0]",
            "[sin(2 rad/s * time), 2.01 rad/s * cos(2 rad/s * time), -4 rad/s^2 * sin(2 rad/s * time)]",
            "[theta, omega, 3 rad/s^2]",
        ] {
            for options in [Options::tsit5(1e-8), Options::rk4(0.01)] {
                let cause = cause(&told(family, motor), options, 1.0);
                assert!(
                    matches!(&cause, Some(StepError::Command { motor, .. }) if motor == "j.angle"),
                    "{family} {motor}: {cause:?}"
                );
            }
        }
    }
}

#[test]
fn rates_that_are_those_of_the_value_are_followed_at_any_step() {
    for family in FAMILIES {
        for (motor, end) in [
            ("[phi, 2 rad/s, 0]", 2.0),
            (
                "[theta, omega, 3 rad/s^2 - omega / (1 s)]",
                3.0 * (-1_f64).exp(),
            ),
            (
                "[sin(6 rad/s * time), 6 rad/s * cos(6 rad/s * time), -36 rad/s^2 * sin(6 rad/s * time)]",
                6_f64.sin(),
            ),
        ] {
            for options in [
                Options::vern7(1e-4),
                Options::rk4(0.1),
                Options::tsit5(1e-9),
            ] {
                let loose = options.method.fixed_step().is_some();
                let mut run = run_of::<f64>(&told(family, motor), options, 1.0);
                let [_, q] = outputs(&mut run)[..] else {
                    panic!("two outputs");
                };
                let allowed = if loose { 1e-2 } else { 1e-3 };
                assert!((q - end).abs() < allowed, "{family} {motor}: {q} {end}");
            }
        }
    }
}

#[test]
fn a_line_that_is_told_another_rate_than_its_length_has_ends_the_run() {
    let text = |length: &str| {
        format!(
            "model Wound {{ gravity: [0, 0, -9.81] m/s^2; state paid = 5 m {{ rate: 0.5 m/s }}
             point a {{ mass: 2 kg, start at [0, 0, -5.002] m }}
             line r from world to a {{ free_length: {length}, stiffness: 10 kN/m, damping: 500 N*s/m }} }}"
        )
    };
    for wrong in ["[paid, 0 m/s]", "[5 m + 0.5 m/s * time, 0.2 m/s]"] {
        let cause = cause(&text(wrong), Options::tsit5(1e-6), 0.5);
        assert!(
            matches!(&cause, Some(StepError::Command { motor, .. }) if motor == "r.free_length"),
            "{wrong}: {cause:?}"
        );
    }
    run_of::<f64>(&text("[paid, 0.5 m/s]"), Options::tsit5(1e-6), 0.5);
    run_of::<f64>(
        &text("[5 m + 0.5 m/s * time, 0.5 m/s]"),
        Options::tsit5(1e-6),
        0.5,
    );
}

#[test]
fn what_is_prescribed_may_neither_jump_nor_have_a_corner() {
    let motor = |motor: &str| {
        format!(
            "model Corner {{ gravity: none; body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
             joint j: hinge from world to a.com {{ axis: z, motor: {motor} }} }}"
        )
    };
    let jumps = [
        ("60 deg * abs(time - 0.5 s) / (1 s)", "rate"),
        ("if(time < 0.5 s, 0 deg, 10 deg)", "value"),
        ("clamp(1 rad/s * time, 0 rad, 0.3 rad)", "rate"),
        ("max(0 rad, 1 rad/s * (time - 0.4 s))", "rate"),
        ("1 rad * floor(time / (0.3 s))", "value"),
    ];
    for options in [
        Options::tsit5(1e-6),
        Options::rk4(0.01),
        Options::rodas5p(1e-6),
    ] {
        for (course, word) in jumps {
            let cause = cause(&motor(course), options, 1.0);
            assert!(
                matches!(&cause, Some(StepError::Jump { of, what, .. }) if of == "j.angle" && *what == word),
                "{course}: {cause:?}"
            );
        }
        for smooth in [
            "smoothstep(0.2 s, 0.8 s, time) * 1 rad",
            "1 rad/s^2 * max(0 s, time - 0.4 s)^2",
            "if(time < 0.5 s, 1 rad/s^2 * time^2, 0.25 rad + 1 rad/s * (time - 0.5 s))",
            "0.5 rad * abs(sin(1 rad/s * time))",
        ] {
            let cause = cause(&motor(smooth), options, 1.0);
            assert!(cause.is_none(), "{smooth}: {cause:?}");
        }
    }
    let filtered = motor("if(time < 0.5 s, 0 deg, 10 deg), filter: 50 ms");
    assert!(cause(&filtered, Options::tsit5(1e-6), 1.0).is_none());
}

#[test]
fn a_length_may_have_a_corner_and_a_frame_at_which_no_joint_ends() {
    let line = |length: &str, road: &str| {
        format!(
            "model Line {{ gravity: [0, 0, -9.81] m/s^2; world {{ frame road at [0 m, 0 m, {road}] }}
             point a {{ mass: 2 kg, start at [0, 0, -5.002] m }}
             line r from world.road to a {{ free_length: {length}, stiffness: 10 kN/m, damping: 50 N*s/m }} }}"
        )
    };
    let fine = line(
        "5 m - 0.1 m/s * max(0 s, time - 0.2 s)",
        "0.1 m/s * max(0 s, time - 0.3 s)",
    );
    assert!(cause(&fine, Options::tsit5(1e-6), 0.5).is_none());
    let jump = line("5 m - if(time < 0.2 s, 0 m, 1 m)", "0.1 m/s * time");
    let found = cause(&jump, Options::tsit5(1e-6), 0.5);
    assert!(
        matches!(&found, Some(StepError::Jump { of, what: "value", .. }) if of == "r.free_length"),
        "{found:?}"
    );
    let jump = line("5 m", "if(time < 0.2 s, 0 m, 1 m)");
    let found = cause(&jump, Options::tsit5(1e-6), 0.5);
    assert!(
        matches!(&found, Some(StepError::Jump { of, what: "value", .. }) if of == "world.road"),
        "{found:?}"
    );
}

#[test]
fn rattle_refuses_motors_that_hold_to_states() {
    let text = "model Filtered { gravity: none;
        body arm { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        joint slew: hinge from world to arm.com { axis: z, motor: 1 rad * sin(1 rad/s * time), filter: 1 s } }";
    let model = Generic::<f64>::with_defaults(read(text)).expect("defaults");
    let refused = Simulation::new(&model, Options::rattle(0.01)).err();
    let refused = refused.map(|error| error.cause);
    assert!(
        matches!(&refused, Some(StepError::Unsupported { what, .. }) if what.contains("slew.angle")),
        "{refused:?}"
    );
}

/// A bob under a knot without mass, pulled by a load on the knot.
fn knot(load: &str) -> String {
    format!(
        "model Knot {{ gravity: [0, 0, -9.81] m/s^2;
         world {{ frame l at [-1, 0, 0] m, frame r at [1.5, 0, 0.2] m }}
         point knot {{ equilibrium: static }} point bob {{ mass: 3 kg, start at [0.2, 0, -2] m }}
         line a from world.l to knot {{ free_length: 1.2 m, stiffness: 5 kN/m }}
         line b from world.r to knot {{ free_length: 1.6 m, stiffness: 5 kN/m }}
         line c from knot to bob {{ free_length: 0.5 m, stiffness: 5 kN/m }}
         load chain on knot = {load};
         load drag on bob = -8 N*s/m * bob.velocity; }}"
    )
}

#[test]
fn the_work_of_loads_on_nodes_closes_the_balance_of_energy() {
    for load in [
        "[0, 0, -4 N]",
        "[1 N, 0 N, -4 N - 3 N * sin(2 rad/s * time)]",
    ] {
        let options = Options {
            work: true,
            ..Options::tsit5(1e-9)
        };
        let run = run_of::<f64>(&knot(load), options, 4.0);
        let balance = run.imbalance().expect("told");
        println!("{load}: {balance:?}");
        assert!(balance.relative() < 1e-6, "{load}: {balance:?}");
    }
}

#[test]
fn what_hovers_or_rests_has_lost_nothing() {
    let options = Options {
        momentum: true,
        work: true,
        ..Options::tsit5(1e-8)
    };
    let hovering = "model Table { gravity: [0, 0, -9.81] m/s^2; point a { mass: 1.7 kg, start at [0.3, 0.1, 1] m }
        load n on a = [0, 0, 1.7 kg * (9.81 m/s^2 - 1e-9 m/s^2 * sin(time * 10 rad/s))]; }";
    let run = run_of::<f64>(hovering, options, 2.0);
    let momentum = run.momentum_imbalance().expect("told");
    assert_eq!(momentum.relative(), 0.0, "{momentum:?}");
    let resting = "model Rest { gravity: [0, 0, -9.81] m/s^2; coordinates: relative; planar: xz;
        body boom { mass: 900 kg, inertia: diag(40, 1300, 1300) kg*m^2, frame foot at [-1.9, 0, 0] m }
        joint pin: hinge from world to boom.foot { axis: -y, motor: 0.3 rad, filter: 0.1 s } }";
    let run = run_of::<f64>(resting, options, 2.0);
    let energy = run.imbalance().expect("told");
    assert_eq!(energy.relative(), 0.0, "{energy:?}");
    // What an event changes by declaration is no loss.
    let burning = "model Burn { gravity: [0, 0, -9.81] m/s^2; param m = 2 kg in 0.1 kg ..= 5 kg;
        point a { mass: m, start at [0, 0, 0] m velocity [3, 0, 0] m/s }
        event off = time rises 0.5 s { set: m = 1 kg, acts: once } }";
    let run = run_of::<f64>(burning, options, 1.0);
    let momentum = run.momentum_imbalance().expect("told");
    assert!(momentum.relative() < 1e-6, "{momentum:?}");
}

#[test]
fn a_fixed_step_from_rest_is_judged_by_more_than_its_first_energy() {
    // A torque that rises like t² makes energy like t⁶.
    let text = "model Start { gravity: none; coordinates: relative;
        state current = 0 A { rate: (24 V - 0.5 ohm * current - 0.05 N*m/A * shaft.angle_rate) / (1 mH) }
        body rotor { mass: 0.5 kg, inertia: diag(2e-4, 2e-4, 2e-4) kg*m^2 }
        joint shaft: hinge from world to rotor.com { axis: z, force: 0.05 N*m/A * current, friction: 20 mN*m, friction_rate: 0.5 rad/s }
        output turned = shaft.angle; }";
    let [coarse, fine] = [5e-4, 5e-5].map(|step| {
        let mut run = run_of::<f64>(text, Options::rk4(step), 0.2);
        outputs(&mut run)[0]
    });
    assert!((coarse - fine).abs() < 1e-4 * fine.abs(), "{coarse} {fine}");
}

#[test]
fn a_gear_with_an_offset_starts_with_its_first_coordinate_at_zero() {
    for family in FAMILIES {
        for (first, second, numbers, slide, angle) in [
            (
                "shaft.angle",
                "rod.slide",
                "ratio: 50 mm, offset: 100 mm",
                0.1,
                0.0,
            ),
            (
                "rod.slide",
                "shaft.angle",
                "ratio: 20 / (1 m), offset: 2 rad",
                0.0,
                2.0,
            ),
        ] {
            let text = format!(
                "model Rack {{ gravity: none; coordinates: {family};
                 body pinion {{ mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }}
                 body rack {{ mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }}
                 joint shaft: hinge from world to pinion.com {{ axis: z }}
                 joint rod: prismatic from world to rack.com {{ axis: x }}
                 joint mesh: gear from {first} to {second} {{ {numbers} }}
                 output s = rod.slide; output a = shaft.angle; }}"
            );
            let mut run = run_of::<f64>(&text, Options::tsit5(1e-9), 0.01);
            let out = outputs(&mut run);
            println!("{family} {first}: {out:?}");
            assert!(
                (out[0].abs() - slide).abs() < 1e-9 && (out[1].abs() - angle).abs() < 1e-9,
                "{family} {first}: {out:?}"
            );
        }
    }
}

#[test]
fn what_a_gear_puts_at_the_start_is_what_it_says_and_not_the_nearest_tooth() {
    // A turn of the axle is 50.27 mm of the rack, and a twentieth of a turn of the shaft 18° of the axle.
    let rack = "joint mesh: gear from axle.angle to rod.slide { ratio: 8 mm, offset: -60 mm }";
    let wheel = "joint mesh: gear from shaft.angle to axle.angle { ratio: 1 / 20, offset: 90 deg }";
    let back = "joint mesh: gear from rod.slide to axle.angle { ratio: 20 / (1 m), offset: 2 rad }";
    let both = &format!(
        "{rack} joint train: gear from shaft.angle to axle.angle {{ ratio: 1 / 20, offset: 90 deg }}"
    );
    let turn = std::f64::consts::TAU;
    for (mesh, axle, rod, [slide, angle]) in [
        (rack, "", "", [-0.06, 0.0]),
        (rack, "start: 0 deg", "", [-0.06, 0.0]),
        (
            rack,
            "start: 90 deg",
            "",
            [0.008 * turn / 4.0 - 0.06, turn / 4.0],
        ),
        (
            rack,
            "start: about 90 deg",
            "",
            [0.008 * turn / 4.0 - 0.06, turn / 4.0],
        ),
        (
            rack,
            "start: 720 deg",
            "",
            [0.016 * turn - 0.06, 2.0 * turn],
        ),
        (
            rack,
            "motor: 30 deg",
            "",
            [0.008 * turn / 12.0 - 0.06, turn / 12.0],
        ),
        (rack, "start_rate: 1 rad/s", "", [-0.06, 0.0]),
        // The slide is said, and the axle follows; where both are, the nearest tooth.
        (rack, "", "start: -60 mm", [-0.06, 0.0]),
        (rack, "", "start: -62 mm", [-0.062, -0.25]),
        (
            rack,
            "start: 0 deg",
            "start: about -9.7 mm",
            [-0.06 + 0.008 * turn, 0.0],
        ),
        (wheel, "", "", [0.0, turn / 4.0]),
        (wheel, "start: 90 deg", "", [0.0, turn / 4.0]),
        (back, "", "start: 100 mm", [0.1, 4.0]),
        (both, "", "", [0.008 * turn / 4.0 - 0.06, turn / 4.0]),
    ] {
        for family in FAMILIES {
            let text = format!(
                "model Rack {{ gravity: none; coordinates: {family};
                 body pinion {{ mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }}
                 body rotor {{ mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }}
                 body rack {{ mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }}
                 joint shaft: hinge from world to rotor.com {{ axis: y }}
                 joint axle: hinge from world to pinion.com {{ axis: y{}{axle} }}
                 joint rod: prismatic from world to rack.com {{ axis: x{}{rod} }}
                 {mesh}
                 output s = rod.slide; output a = axle.angle; }}",
                if axle.is_empty() { "" } else { ", " },
                if rod.is_empty() { "" } else { ", " },
            );
            let mut run = run_of::<f64>(&text, Options::tsit5(1e-9), 0.0);
            let out = outputs(&mut run);
            let gaps = [out[0] - slide, out[1] - angle];
            assert!(
                gaps.iter().all(|gap| gap.abs() < 1e-9),
                "{family} {mesh} {axle} {rod}: {out:?}"
            );
        }
    }
}

/// Crank 0.2 m, coupler 0.3 m, rocker 0.2 m, pivots 0.4 m apart: coupler and rocker are in one line where the crank's tip is 0.5 m from the far pivot, at
/// cos α = (0.2² + 0.4² − 0.5²)/(2 · 0.2 · 0.4). A motor at 10 rad/s from −60° comes there at (α + π/3)/10 s, and no method goes further.
#[test]
fn a_motor_that_drives_a_loop_to_its_dead_centre_is_named_there_by_every_method() {
    let dead = ((0.04f64 + 0.16 - 0.25) / 0.16).acos();
    let dead = (dead + std::f64::consts::FRAC_PI_3) / 10.0;
    let late = 1e-9;
    for family in FAMILIES {
        let text = format!(
            "model Dead {{ coordinates: {family}; planar: xz; gravity: [0, 0, -9.81] m/s^2;
             world {{ frame far at [0.4, 0, 0] m }}
             body crank {{ mass: 0.5 kg, inertia: 0.002 kg*m^2, frame root at [-0.1, 0, 0] m, frame tip at [0.1, 0, 0] m }}
             body coupler {{ mass: 1.1 kg, inertia: 0.02 kg*m^2, frame root at [-0.15, 0, 0] m, frame tip at [0.15, 0, 0] m }}
             body rocker {{ mass: 0.9 kg, inertia: 0.01 kg*m^2, frame root at [-0.1, 0, 0] m, frame tip at [0.1, 0, 0] m }}
             body wheel {{ mass: 1 kg, inertia: 0.01 kg*m^2 }}
             joint motor: hinge from world to crank.root {{ axis: y, motor: 10 rad/s * time - 60 deg }}
             joint knee: hinge from crank.tip to coupler.root {{ axis: y }}
             joint hip: hinge from world.far to rocker.root {{ axis: y, start: about -110 deg }}
             joint close: hinge from coupler.tip to rocker.tip {{ axis: y }}
             joint axle: hinge from world to wheel.com {{ axis: y, motor: 3 rad/s * time }} }}"
        );
        let mut methods = vec![
            (Options::tsit5(1e-8), late),
            (Options::vern7(1e-5), late),
            (Options::rodas5p(1e-8), late),
            (Options::rk4(1e-3), 1e-3),
            (Options::rk4(1e-2), 1e-2),
        ];
        if family == "absolute" {
            methods.push((Options::rattle(1e-3), 1e-3));
        }
        for (options, step) in methods {
            let what = format!("{family}, {:?}", options.method);
            let Some(StepError::BeyondReach { time, motors, .. }) = cause(&text, options, 2.0)
            else {
                panic!("{what}: {:?}", cause(&text, options, 2.0));
            };
            assert_eq!(motors, ["motor.angle"], "{what}");
            assert!((time - dead).abs() <= step, "{what}: {time}, not {dead}");
        }
    }
}
