//! What acts along joint coordinates: the law against loads written out by hand, closed forms, energy, derivatives, and what it costs.

use mbd_compiler::Interpreted;
use mbd_runtime::{Generic, Happening, Mode, Options, ParamError, Quantity, Simulation, StepError};
use mbd_scene::{Differentiated, Layout, Model, Scene, Variable};
use tests::assert_close;
use tests::declared::{cost, derived_cost, read};
use tests::instant::{partial_by_oracle, random_instant, value};
use tests::random::Random;

const COMPONENTS: [&str; 2] = ["body", "world"];

/// Two links on a hinge about a skew axis and a sleeve, with fields in their braces, and more items.
fn arm(components: &str, hinge: &str, sleeve: &str, more: &str) -> Scene {
    read(
        &format!(
            "model Arm {{
            gravity: [0.3, -0.2, -9.81] m/s^2;
            angular_velocity: {components};
            param k = 3.0 N*m/rad in 0.1 N*m ..= 9.0 N*m;
            param k2 = k;
            param c = 0.4 N*m*s in 0.0 N*m*s ..= 9.0 N*m*s;
            world {{ frame wall at [0.1, 0.2, 0.3] m rotated rpy(0.3, -0.2, 0.5) }}
            body upper {{
                mass: 2.0 kg,
                inertia: full {{ xx: 0.17, yy: 0.2, zz: 0.11, xy: 0.01 }} kg*m^2 (matrix elements),
                frame top at [0.0, 0.1, 0.5] m rotated rpy(0.1, 0.2, -0.4),
                frame tip at [0.1, 0.0, -0.5] m rotated rpy(0.0, 0.5, 0.1),
            }}
            body lower {{
                mass: 1.5 kg,
                inertia: diag(0.05, 0.06, 0.04) kg*m^2,
                frame top at [0.0, 0.1, 0.25] m rotated rpy(0.7, 0.1, 0.0),
            }}
            joint shoulder: hinge from world.wall to upper.top {{ axis: [1, 2, 2], {hinge} }}
            joint elbow: cylindrical from upper.tip to lower.top {{ axis: y, {sleeve} }}
            {more}
        }}"
        )
        .replace("param k2 = k;", ""),
    )
}

const HINGE: &str =
    "stiffness: k, rest: 0.3 rad, damping: c, friction: 0.5 N*m, friction_rate: 0.2 rad/s,
    stops: [-0.4 rad, none], stop_stiffness: 20 N*m, stop_damping: 0.3 N*m*s,
    force: 0.7 N*m * sin(time / 1 s) + 0.2 N*m * elbow.angle,";
const SLEEVE: &str = "slide: { stiffness: 40 N/m, rest: -0.1 m, damping: 2 N*s/m,
        stops: [-0.2, 0.2] m, stop_stiffness: 300 N/m, force: -3 N*s^2/m^2 * elbow.slide_rate * abs(elbow.slide_rate) },
    angle: { damping: 0.1 N*m*s, stiffness: k },";

#[test]
fn fields_act_as_the_same_forces_written_as_loads() {
    // The axis of the hinge in frame 1 and in world axes; couples along it, opposite on the two bodies.
    let couples = "const A = 1.0 / 3.0;
        load spin on upper at com = (A * world.wall.x + 2.0 * A * world.wall.y + 2.0 * A * world.wall.z)
            * (-k * (shoulder.angle - 0.3) - c * shoulder.angle_rate
               - 0.5 N*m * shoulder.angle_rate / sqrt(shoulder.angle_rate^2 + 0.04 1/s^2)
               + 0.7 N*m * sin(time / 1 s) + 0.2 N*m * elbow.angle);
        load twist on lower at com = upper.tip.y * (-k * elbow.angle - 0.1 N*m*s * elbow.angle_rate);
        load back on upper at com = -upper.tip.y * (-k * elbow.angle - 0.1 N*m*s * elbow.angle_rate);
        load along on lower at top = upper.tip.y * (-40 N/m * (elbow.slide + 0.1 m) - 2 N*s/m * elbow.slide_rate
            - 3 N*s^2/m^2 * elbow.slide_rate * abs(elbow.slide_rate));
        load along_back on upper at tip = -upper.tip.y * (-40 N/m * (elbow.slide + 0.1 m) - 2 N*s/m * elbow.slide_rate
            - 3 N*s^2/m^2 * elbow.slide_rate * abs(elbow.slide_rate));";
    for components in COMPONENTS {
        let mut random = Random::new(2);
        let no_stops = |text: &str| {
            text.replace(
                "stops: [-0.4 rad, none], stop_stiffness: 20 N*m, stop_damping: 0.3 N*m*s,",
                "",
            )
            .replace("stops: [-0.2, 0.2] m, stop_stiffness: 300 N/m,", "")
        };
        let fields = arm(components, &no_stops(HINGE), &no_stops(SLEEVE), "");
        let loads = arm(components, "", "", couples);
        let [fields, loads] =
            [fields, loads].map(|scene| Generic::with_defaults(scene).expect("defaults"));
        let mut simulation = Simulation::new(&fields, Options::tsit5(1e-9)).expect("options");
        // The two agree where the joints hold: along a run.
        simulation
            .set_state(0.0, &start(&mut random))
            .expect("a state");
        for tenth in 1..=10 {
            let time = 0.1 * f64::from(tenth);
            simulation.run(time).expect("a run");
            let state = simulation.state().to_vec();
            let derivative = |model: &Generic<f64>| {
                let mut simulation = Simulation::new(model, Options::tsit5(1e-9)).expect("options");
                simulation.set_state(time, &state).expect("a state");
                let mut out = vec![0.0; model.layout().nx()];
                simulation
                    .evaluate(Quantity::Derivative, &mut out)
                    .expect("no nodes");
                out
            };
            let (got, want) = (derivative(&fields), derivative(&loads));
            assert_close(&got, &want, 1e-11, 1e-11, components);
        }
    }
}

/// Bodies near the places where their joints hold, moving anyhow.
fn start(random: &mut Random) -> Vec<f64> {
    let mut state = vec![0.0; 26];
    for body in 0..2 {
        for (slot, x) in state[7 * body..].iter_mut().zip(random.vector(0.3)) {
            *slot = x - 0.5 * (body as f64 + 0.5);
        }
        state[7 * body + 3] = 1.0;
        let turn = random.vector(0.3);
        state[7 * body + 4..7 * body + 7].copy_from_slice(&turn);
        let norm = state[7 * body + 3..7 * body + 7]
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt();
        state[7 * body + 3..7 * body + 7]
            .iter_mut()
            .for_each(|x| *x /= norm);
    }
    for slot in &mut state[14..] {
        *slot = random.uniform(-1.0, 1.0);
    }
    state
}

/// A body of 2 kg and 0.5 kg m² about z on one joint to the world, without gravity.
fn alone(components: &str, joint: &str) -> Scene {
    read(&format!(
        "model Alone {{
            gravity: none;
            angular_velocity: {components};
            body bob {{ mass: 2.0 kg, inertia: diag(0.4, 0.3, 0.5) kg*m^2 }}
            joint j: {joint}
        }}"
    ))
}

/// A state with the bob at `x` along z, or turned by `x` about z, and its rate.
fn placed(hinge: bool, x: f64, rate: f64) -> [f64; 13] {
    let mut state = [0.0; 13];
    state[3] = 1.0;
    if hinge {
        (state[6], state[3]) = (0.5 * x).sin_cos();
        state[12] = rate;
    } else {
        state[2] = x;
        state[9] = rate;
    }
    state
}

/// Coordinate and rate of a run of the bob.
fn coordinate(hinge: bool, state: &[f64]) -> [f64; 2] {
    if hinge {
        [2.0 * state[6].atan2(state[3]), state[12]]
    } else {
        [state[2], state[9]]
    }
}

fn both(mut check: impl FnMut(&str, bool, &str)) {
    for components in COMPONENTS {
        check(components, true, "hinge from world to bob.com { axis: z, ");
        check(
            components,
            false,
            "prismatic from world to bob.com { axis: z, ",
        );
    }
}

/// The unit of a stiffness, and the inertia along the coordinate.
fn measures(hinge: bool) -> (&'static str, &'static str, f64) {
    if hinge {
        ("N*m", "rad", 0.5)
    } else {
        ("N/m", "m", 2.0)
    }
}

#[test]
fn a_damped_oscillator_follows_its_closed_form() {
    both(|components, hinge, joint| {
        let (unit, place, inertia) = measures(hinge);
        let damping = if hinge { "N*m*s" } else { "N*s/m" };
        let text =
            format!("{joint} stiffness: 8 {unit}, rest: 0.2 {place}, damping: 0.6 {damping} }}");
        let model = Generic::<f64>::with_defaults(alone(components, &text)).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-12)).expect("options");
        run.set_state(0.0, &placed(hinge, 1.1, -0.4))
            .expect("a state");
        run.run(3.0).expect("a run");
        let (sigma, square) = (0.6 / (2.0 * inertia), 8.0 / inertia);
        let omega = (square - sigma * sigma).sqrt();
        let (x0, u0, t) = (0.9, -0.4, 3.0f64);
        let b = (u0 + sigma * x0) / omega;
        let decay = (-sigma * t).exp();
        let (sin, cos) = (omega * t).sin_cos();
        let x = decay * (x0 * cos + b * sin);
        let u = decay * ((b * omega - sigma * x0) * cos - (x0 * omega + sigma * b) * sin);
        assert_close(
            &coordinate(hinge, run.state()),
            &[0.2 + x, u],
            1e-9,
            1e-9,
            joint,
        );
    });
}

#[test]
fn regularised_friction_slows_by_its_closed_form() {
    both(|components, hinge, joint| {
        let (_, _, inertia) = measures(hinge);
        let (force, rate) = if hinge {
            ("N*m", "rad/s")
        } else {
            ("N", "m/s")
        };
        let text = format!("{joint} friction: 1.5 {force}, friction_rate: 0.1 {rate} }}");
        let model = Generic::<f64>::with_defaults(alone(components, &text)).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-12)).expect("options");
        run.set_state(0.0, &placed(hinge, 0.0, 0.5))
            .expect("a state");
        // m u̇ = −F u/√(u² + w²): √(u² + w²) − w asinh(w/u) falls by F t/m.
        let level = |u: f64| u.hypot(0.1) - 0.1 * (0.1 / u).asinh();
        for t in [0.05, 0.1, 0.2] {
            run.run(t).expect("a run");
            let [_, u] = coordinate(hinge, run.state());
            let lost = level(0.5) - level(u);
            assert_close(&[lost], &[1.5 * t / inertia], 1e-9, 0.0, joint);
        }
    });
}

/// A bounce on the high stop at 0.3 with K = 200, C, from 0 at the rate 0.7: when it touches, stops pulling and leaves, and the rate after.
fn bounce(inertia: f64, damping: f64) -> ([f64; 3], f64) {
    let (sigma, square, u0) = (damping / (2.0 * inertia), 200.0 / inertia, 0.7);
    let omega = (square - sigma * sigma).sqrt();
    // m ë = 0: K e + C ė = 0.
    let lift =
        (std::f64::consts::PI - (2.0 * sigma * omega).atan2(square - 2.0 * sigma * sigma)) / omega;
    let (sin, cos) = (omega * lift).sin_cos();
    let decay = (-sigma * lift).exp();
    let depth = u0 / omega * decay * sin;
    let rate = u0 * decay * (cos - sigma / omega * sin);
    let touch = 0.3 / u0;
    ([touch, touch + lift, touch + lift + depth / -rate], rate)
}

#[test]
fn bounces_on_stops_follow_their_closed_form_and_are_located() {
    for damping in [0.0, 4.0] {
        both(|components, hinge, joint| {
            let (unit, place, inertia) = measures(hinge);
            let per = if hinge { "N*m*s" } else { "N*s/m" };
            let text = format!(
                "{joint} stops: [none, 0.3 {place}], stop_stiffness: 200 {unit}, stop_damping: {damping:?} {per} }}"
            );
            let model = Generic::<f64>::with_defaults(alone(components, &text)).expect("defaults");
            let mut run = Simulation::new(&model, Options::tsit5(1e-12)).expect("options");
            run.set_state(0.0, &placed(hinge, 0.0, 0.7))
                .expect("a state");
            run.run(1.0).expect("a run");
            let ([touch, lift, leave], rate) = bounce(inertia, damping);
            let after = [0.3 + rate * (1.0 - leave), rate];
            assert_close(&coordinate(hinge, run.state()), &after, 1e-9, 1e-9, &text);
            let told: Vec<(String, f64)> = run
                .events()
                .iter()
                .map(|event| (run.event_name(event.what), event.time))
                .collect();
            let coordinate = if hinge { "angle" } else { "slide" };
            let name = |what: &str| format!("j.{coordinate} high stop: {what}");
            // With damping a stop stops pushing before the bob is out of it.
            let away = if damping > 0.0 { lift } else { leave };
            let wanted = [(name("touched"), touch), (name("left"), away)];
            assert_eq!(told.len(), wanted.len(), "{text}: {told:?}");
            for (got, want) in told.iter().zip(&wanted) {
                assert_eq!(got.0, want.0, "{text}");
                assert_close(&[got.1], &[want.1], 1e-9, 1e-9, &got.0);
            }
            assert!(matches!(run.events()[0].what, Happening::Switch(0, _)));
        });
    }
}

#[test]
fn rk4_keeps_its_order_through_bounces_between_two_stops() {
    // Gravity, both stops and a spring, so that no phase is linear in time.
    for damping in ["0.0", "3.0"] {
        let scene = read(&format!(
            "model Bob {{
                gravity: [1.0, 0.0, -3.0] m/s^2;
                body bob {{ mass: 2.0 kg, inertia: diag(0.4, 0.3, 0.5) kg*m^2, frame top at [0.0, 0.0, 1.0] m }}
                joint j: hinge from world to bob.top {{
                    axis: y, stiffness: 5 N*m, stops: [-0.3, 0.5] rad, stop_stiffness: 400 N*m, stop_damping: {damping} N*m*s,
                }}
            }}"
        ));
        let model = Interpreted::new(scene, &[]).expect("no params");
        let end = |options: Options| -> [f64; 3] {
            let mut run = Simulation::new(&model, options).expect("options");
            let mut state = [0.0; 13];
            (state[2], state[3]) = (-1.0, 1.0);
            (state[7], state[11]) = (-2.0, 2.0);
            run.set_state(0.0, &state).expect("a state");
            run.run(1.5).expect("a run");
            assert!(run.events().len() >= 4, "{:?}", run.events());
            [run.state()[4], run.state()[5], run.state()[11]]
        };
        let exact = end(Options::tsit5(1e-13));
        let errors = [0.003, 0.0015, 0.00075].map(|step| {
            let got = end(Options::rk4(step));
            got.iter()
                .zip(exact)
                .fold(0.0f64, |most, (a, b)| most.max((a - b).abs()))
        });
        let orders = [
            (errors[0] / errors[1]).log2(),
            (errors[1] / errors[2]).log2(),
        ];
        println!("damping {damping}: {errors:?} {orders:?}");
        assert!(
            orders.iter().all(|order| *order >= 3.8),
            "{errors:?} {orders:?}"
        );
    }
}

/// Runs for three seconds and balances energy with the work of loads, dampers and drives; hands the works back, and the switches of stops.
fn balance(scene: Scene, params: &[f64], start: &[f64]) -> ([f64; 3], usize) {
    let model = Interpreted::new(scene, params).expect("valid params");
    let options = Options {
        work: true,
        ..Options::tsit5(1e-12)
    };
    let mut run = Simulation::new(&model, options).expect("options");
    run.set_state(0.0, start).expect("a state");
    let energy = |run: &mut Simulation<f64>| {
        let mut out = [0.0; 6];
        run.evaluate(Quantity::Energy, &mut out).expect("no nodes");
        out[..3].iter().sum::<f64>()
    };
    let before = energy(&mut run);
    for tenth in 1..=30 {
        run.run(0.1 * f64::from(tenth)).expect("a run");
        let works = run.work().expect("asked for");
        let change = energy(&mut run) - before;
        assert_close(&[change], &[works.iter().sum()], 0.0, 1e-9, "energy");
    }
    let stops = run.events().iter();
    let stops = stops.filter(|event| matches!(event.what, Happening::Switch(..)));
    (run.work().expect("asked for"), stops.count())
}

#[test]
fn the_energy_of_a_run_balances_with_springs_dampers_friction_stops_and_forces() {
    for components in COMPONENTS {
        let scene = arm(components, HINGE, SLEEVE, "");
        let start = start(&mut Random::new(2));
        let ([loads, dampers, drives], stops) = balance(scene, &[3.0, 0.4], &start);
        assert!(stops >= 4, "{stops} switches of stops");
        assert!(dampers < -0.1 && loads.abs() > 1e-3, "{loads} {dampers}");
        assert_eq!(drives, 0.0);
    }
}

#[test]
fn the_energy_of_springs_on_a_moving_frame_balances_with_the_work_of_the_drive() {
    for components in COMPONENTS {
        let scene = read(&format!(
            "model Shaker {{
                gravity: [0.0, 0.0, -9.81] m/s^2;
                angular_velocity: {components};
                world {{ frame deck at [0.0, 0.0, 0.1 m * sin(7 rad/s * time)] rotated rpy(0.0, 0.0, 0.2 * sin(3 rad/s * time)) }}
                body cart {{ mass: 2.0 kg, inertia: diag(0.17, 0.2, 0.1) kg*m^2, frame pin at [0.0, 0.3, 0.0] m }}
                body flag {{ mass: 0.4 kg, inertia: diag(0.02, 0.02, 0.01) kg*m^2, frame pin at [0.3, 0.0, 0.0] m }}
                point bead {{ mass: 0.2 kg }}
                joint shaft: cylindrical from world.deck to cart.com {{
                    slide: {{ stiffness: 300 N/m, damping: 3 N*s/m, stops: [-0.1, 0.05] m, stop_stiffness: 2 kN/m, stop_damping: 4 N*s/m }},
                    angle: {{ stiffness: 4 N*m/rad, damping: 0.2 N*m*s, friction: 0.1 N*m, friction_rate: 0.1 rad/s, force: 0.3 N*m }},
                }}
                joint hinge: hinge from cart.pin to flag.pin {{ axis: z, damping: 0.02 N*m*s }}
                joint wire: point_on_line from world.deck to bead {{ axis: x, stiffness: 20 N/m, damping: 0.1 N*s/m }}
            }}"
        ));
        let mut start = vec![0.0; 32];
        (start[3], start[10]) = (1.0, 1.0);
        start[7..9].copy_from_slice(&[-0.3, 0.3]);
        start[14] = 0.2;
        let ([loads, dampers, drives], stops) = balance(scene, &[], &start);
        assert!(
            dampers < -0.1 && drives.abs() > 0.1 && loads != 0.0,
            "{loads} {dampers} {drives}"
        );
        assert!(stops >= 2, "{stops} switches of stops");
    }
}

#[test]
fn derivatives_of_coordinates_and_of_what_acts_along_them_agree_with_dual_numbers() {
    let outputs =
        "output bend = shoulder.angle; output turn = elbow.angle; output slide = elbow.slide;
        output rates = [shoulder.angle_rate, elbow.angle_rate, elbow.slide_rate * 1 1/m];
        output pull = -k * shoulder.angle - c * shoulder.angle_rate;";
    let mut random = Random::new(12);
    for components in COMPONENTS {
        let scene = arm(components, HINGE, SLEEVE, outputs);
        let params = [3.0, 0.4];
        let interpreted = Interpreted::new(scene.clone(), &params).expect("defaults");
        let generic = Generic::new(scene.clone(), &params).expect("defaults");
        for _ in 0..10 {
            let instant = random_instant(&scene, &mut random);
            for by in [Variable::State, Variable::Parameter] {
                for of in [Differentiated::Outputs, Differentiated::Derivative] {
                    let want = partial_by_oracle(&scene, &params, of, by, &instant);
                    let what = Quantity::Partial(of, by);
                    let scale = want.iter().fold(1.0f64, |most, x| most.max(x.abs()));
                    let name = format!("{components}, {what:?}");
                    let got = value(&generic, what, &instant);
                    assert_close(&got, &want, 1e-12, 1e-12 * scale, &name);
                    if of == Differentiated::Outputs {
                        let got = value(&interpreted, what, &instant);
                        assert_close(&got, &want, 1e-12, 1e-12 * scale, &name);
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_not_declared_costs_nothing() {
    let plain = arm("body", "", "", "");
    let zero = arm(
        "body",
        "stiffness: 0 N*m, rest: 0.3 rad, damping: 0 N*m*s, friction: 0 N*m, friction_rate: 1 rad/s,",
        "slide: { damping: 0 N*s/m }",
        "const NONE = 0.0 N*m*s;",
    );
    let damped = arm("body", "damping: 0.3 N*m*s,", "", "");
    let sprung = arm("body", "stiffness: 0.3 N*m, damping: 0.3 N*m*s,", "", "");
    for what in Layout::new(&plain).quantities() {
        assert_eq!(cost(&plain, what), cost(&zero, what), "{what:?}");
        let same = !matches!(
            what,
            Quantity::Derivative
                | Quantity::Forces
                | Quantity::Energy
                | Quantity::Multipliers
                | Quantity::Reactions
        );
        assert_eq!(cost(&plain, what) == cost(&sprung, what), same, "{what:?}");
    }
    assert_eq!(derived_cost(&plain), derived_cost(&zero));
    let total = |scene: &Scene| cost(scene, Quantity::Derivative).total();
    let (damper, spring) = (
        total(&damped) - total(&plain),
        total(&sprung) - total(&damped),
    );
    println!("a damper on a hinge: {damper} operations; a spring beside it: {spring}");
    assert!(
        cost(&damped, Quantity::Derivative).trigs == 0,
        "a damper needs no angle"
    );
    assert_eq!(
        cost(&sprung, Quantity::Derivative).trigs,
        1,
        "a spring needs one"
    );
    assert!(damper <= 120 && spring <= 20, "{damper} {spring}");
}

#[test]
fn numbers_that_no_coordinate_can_have_are_refused_by_name() {
    let scene = |fields: &str| {
        read(&format!(
            "model Rail {{
                gravity: none;
                param a = 0.1 m in -1 m ..= 1 m;
                param k = 1.0 N/m in -1 N/m ..= 2 N/m;
                body bob {{ mass: 2.0 kg, inertia: diag(0.4, 0.3, 0.5) kg*m^2 }}
                joint rail: prismatic from world to bob.com {{ {fields} }}
            }}"
        ))
    };
    let refused = |fields: &str, params: [f64; 2], what: &str| {
        let error = Generic::new(scene(fields), &params).err();
        let Some(ParamError::NotPhysical { what: found, .. }) = &error else {
            panic!("{fields}: {error:?}");
        };
        assert_eq!(found, what, "{fields}");
    };
    let stops = "stops: [a, 0.5 m], stop_stiffness: k * 2 + 3 N/m";
    assert!(Generic::new(scene(stops), &[0.4, 1.0]).is_ok());
    refused(stops, [0.6, 1.0], "rail.slide.stops");
    refused(
        "stops: [a, 0.5 m], stop_stiffness: k",
        [0.1, -0.5],
        "rail.slide.stop_stiffness",
    );
    refused("stiffness: k", [0.1, -0.5], "rail.slide.stiffness");
    // Scenes made by hand say everything, too.
    let mut by_hand = scene("stops: [a, 0.5 m], stop_stiffness: k");
    by_hand.joints[0].forces[0].stop_stiffness = None;
    let error = Generic::new(by_hand, &[0.1, 1.0]).err();
    assert!(
        matches!(error, Some(ParamError::NotPhysical { .. })),
        "{error:?}"
    );
}

#[test]
fn the_watch_of_fixed_steps_knows_the_springs_of_joints() {
    both(|components, hinge, joint| {
        let (unit, _, inertia) = measures(hinge);
        let stiffness = 2e4 * inertia;
        let text = format!("{joint} stiffness: {stiffness:?} {unit} }}");
        let model = Generic::<f64>::with_defaults(alone(components, &text)).expect("defaults");
        let run = |step: f64| {
            let mut run = Simulation::new(&model, Options::rk4(step)).expect("options");
            run.set_state(0.0, &placed(hinge, 0.01, 0.0))
                .expect("a state");
            run.run(2.0).map_err(|error| error.cause)
        };
        // Step times rate: 0.28 keeps the energy, 1.41 is stable but loses it, 2.97 is not stable.
        assert_eq!(run(0.002).err(), None, "{text}");
        for step in [0.01, 0.021] {
            let too_long = run(step).err();
            assert!(
                matches!(too_long, Some(StepError::UnstableStep { .. })),
                "{text}: {too_long:?}"
            );
        }
    });
}

#[test]
fn a_run_goes_on_from_a_snapshot_in_the_middle_of_a_touch_to_the_bit() {
    let text = "hinge from world to bob.com { axis: z, stops: [-0.1, 0.3] rad, stop_stiffness: 200 N*m, stop_damping: 4 N*m*s }";
    let model = Generic::<f64>::with_defaults(alone("body", text)).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("options");
    run.set_state(0.0, &placed(true, 0.0, 0.7))
        .expect("a state");
    run.run(0.5).expect("a run");
    assert!(
        matches!(run.events(), [only] if matches!(only.what, Happening::Switch(1, Mode::Active)))
    );
    let snapshot = run.snapshot();
    let mut other = Simulation::new(&model, Options::rk4(0.01)).expect("options");
    other.restore(&snapshot).expect("a snapshot of this model");
    for run in [&mut run, &mut other] {
        run.run(3.0).expect("a run");
    }
    let bits =
        |run: &Simulation<f64>| -> Vec<u64> { run.state().iter().map(|x| x.to_bits()).collect() };
    assert_eq!(bits(&run), bits(&other));
    assert!(run.events().len() > 3);
}
