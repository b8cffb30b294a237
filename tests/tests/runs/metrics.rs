//! Metrics of a run are as accurate as the run: closed forms, whatever rows a history has, which other events there are, and whoever runs the model.

use std::f64::consts::{PI, TAU};

use mbd_compiler::{Interpreted, read_text, read_toml, write_toml};
use mbd_runtime::scene::Scene;
use mbd_runtime::{
    Content, Method, MissingMetric, Options, Sampling, Simulation, Stop, Trajectory,
};

const OSCILLATOR: &str = "model Osc {
    gravity: none;
    point a { mass: 1 kg, start at [1 m, 0 m, 0 m] }
    load k on a = -1 N/m * a.position;
    metric top = max a.velocity.x;
    metric low = min a.position.x { from: 1 s };
    metric r = rms a.position.x;
    metric m = mean a.position.x { from: 0 s, to: 1.5 s };
    metric i = integral a.position.x { to: 1.5 s };
    metric over = time_above a.position.x { level: 0.5 m };
    metric first = first_above a.velocity.x { level: 0.5 m/s };
    metric corner = integral abs(a.position.x);
    metric last = final a.position.x { to: 1 s };
    metric held = max abs(a.velocity.y);
}";

/// x = cos t over one turn. [unit of the metric]
fn exact() -> [(&'static str, f64); 10] {
    [
        ("top", 1.0),
        ("low", -1.0),
        ("r", 0.5_f64.sqrt()),
        ("m", 1.5_f64.sin() / 1.5),
        ("i", 1.5_f64.sin()),
        ("over", 2.0 * PI / 3.0),
        ("first", PI + 0.5_f64.asin()),
        ("corner", 4.0),
        ("last", 1.0_f64.cos()),
        ("held", 0.0),
    ]
}

fn scene(text: &str) -> Scene {
    let read = read_text(text);
    let scene = read.scene.unwrap_or_else(|| panic!("{:?}", read.errors));
    let document = write_toml(&scene);
    assert_eq!(
        read_toml(&document).scene.as_ref(),
        Some(&scene),
        "{document}"
    );
    scene
}

fn recorded(
    scene: &Scene,
    options: Options,
    (until, sampling): (f64, Sampling),
) -> (Trajectory, Stop) {
    let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let model = Interpreted::<f64>::new(scene.clone(), &defaults).expect("defaults");
    let mut history = Trajectory::new(&model, sampling, Content::ALL);
    let mut run = Simulation::new(&model, options).expect("a model that runs");
    let stop = run.record(until, &mut history).expect("a run that ends");
    (history, stop)
}

fn told(history: &Trajectory, scene: &Scene) -> Vec<(String, f64)> {
    let metrics = history.metrics(scene).into_iter();
    metrics
        .map(|metric| {
            assert_eq!(metric.unresolved, 0.0, "{}", metric.name);
            (metric.name, metric.value.unwrap_or(f64::NAN))
        })
        .collect()
}

fn value(history: &Trajectory, scene: &Scene, name: &str) -> f64 {
    let all = told(history, scene);
    let found = all.iter().find(|(known, _)| known == name);
    found.map_or(f64::NAN, |(_, value)| *value)
}

#[test]
fn every_kind_of_metric_of_an_oscillation_has_its_closed_form_to_the_accuracy_of_the_run() {
    let scene = scene(OSCILLATOR);
    // The errors of the runs themselves at their ends, times a margin.
    let runs = [
        (Options::vern7(1e-10), 1e-8),
        (Options::vern7(1e-6), 2e-5),
        (Options::tsit5(1e-8), 1e-6),
        (Options::rodas5p(1e-8), 1e-6),
        (Options::auto(1e-8), 1e-6),
        (Options::rk4(0.01), 1e-8),
        (Options::rattle(1e-3), 1e-6),
    ];
    for (options, bound) in runs {
        for sampling in [Sampling::Steps, Sampling::Every(0.7)] {
            let (history, _) = recorded(&scene, options, (TAU, sampling.clone()));
            for ((name, found), (expected, exact)) in told(&history, &scene).iter().zip(exact()) {
                assert_eq!(name, expected);
                assert!(
                    (found - exact).abs() <= bound,
                    "{name}: {found} instead of {exact}, {options:?}, {sampling:?}"
                );
            }
        }
    }
}

fn stone(events: &str) -> Scene {
    scene(&format!(
        "model Stone {{
            gravity: [0, 0, -10] m/s^2;
            point a {{ mass: 1 kg, start at [0, 0, 0] m velocity [0, 0, 10] m/s }}
            {events}
            metric high = time_above a.position.z {{ level: 4.9 m }};
            metric passed = first_above a.position.z {{ level: 4.9 m }};
            metric just = first_above a.position.z {{ level: 4.9999 m }};
            metric apex = max a.position.z;
        }}"
    ))
}

#[test]
fn what_a_stone_does_between_two_steps_does_not_depend_on_its_events() {
    // z = 10 t − 5 t²: above 4.9 m within √0.02 s of the apex at 1 s.
    let half = 0.02_f64.sqrt();
    let exact = [
        ("high", 2.0 * half),
        ("passed", 1.0 - half),
        ("just", 1.0 - 2e-5_f64.sqrt()),
        ("apex", 5.0),
    ];
    for events in [
        "",
        "event e = a.position.z falls 1 m;",
        "event e = a.position.z rises 3 m; event f = a.velocity.z falls 2 m/s;",
    ] {
        let scene = stone(events);
        for (options, bound) in [
            (Options::tsit5(1e-8), 1e-9),
            (Options::vern7(1e-8), 1e-9),
            (Options::rk4(0.3), 1e-9),
        ] {
            let (history, _) = recorded(&scene, options, (2.0, Sampling::Every(0.9)));
            for (name, exact) in exact {
                let found = value(&history, &scene, name);
                assert!(
                    (found - exact).abs() <= bound,
                    "{name}: {found} instead of {exact}, {options:?}, {events}"
                );
            }
        }
    }
}

#[test]
fn a_history_that_is_refused_stays_as_it_is() {
    let (own, other) = (stone(""), scene(OSCILLATOR));
    let model = Interpreted::<f64>::new(own.clone(), &[]).expect("no params");
    let osc = Interpreted::<f64>::new(other.clone(), &[]).expect("no params");
    let begun = || Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
    // Of another model: nothing ran, and no metric has a value.
    let mut history = Trajectory::new(&osc, Sampling::Steps, Content::RESULTS);
    begun()
        .record(1.0, &mut history)
        .expect_err("another model");
    for metric in history.metrics(&other) {
        assert!(metric.value.is_err(), "{metric:?}");
    }
    // Of a run that was longer: what that one measured.
    let (mut history, _) = recorded(&own, Options::tsit5(1e-9), (0.75, Sampling::Steps));
    let before = history.clone();
    begun()
        .record(0.5, &mut history)
        .expect_err("a history of a later run");
    assert_eq!(history.metrics(&own), before.metrics(&own));
    assert_eq!(history.column("a.z"), before.column("a.z"));
}

#[test]
fn what_happens_at_time_zero_happens_at_zero() {
    let scene = scene(
        "model Clock {
            gravity: none;
            point a { mass: 1 kg }
            event begins = time rises 0 s;
            event wave = sin(2 * pi * time / (1 s)) crosses 0;
            event later = time rises 0.3 s;
            metric begun = time_of begins;
            metric waved = time_of wave;
            metric waited = time_of later;
        }",
    );
    for options in [
        Options::tsit5(1e-9),
        Options::vern7(1e-9),
        Options::rk4(0.1),
    ] {
        let (history, _) = recorded(&scene, options, (0.4, Sampling::Steps));
        for (name, wanted) in [("begun", 0.0), ("waved", 0.0), ("waited", 0.3)] {
            assert_eq!(value(&history, &scene, name), wanted, "{name}, {options:?}");
        }
    }
}

#[test]
fn a_mean_over_a_window_as_narrow_as_rounding_is_one_of_the_values_in_it() {
    let scene = scene(
        "model Drift {
            gravity: none;
            point a { mass: 1 kg, start at [1, 0, 0] m velocity [1, 0, 0] m/s }
            metric mean = mean a.position.x { from: 1.999999999999 s, to: 2 s }
            metric rms = rms a.position.x { from: 1.999999999999 s, to: 2 s }
            metric inside = mean a.position.x { from: 1.23456789 s, to: 1.234567890001 s }
        }",
    );
    for options in [Options::tsit5(1e-8), Options::rk4(0.3)] {
        let (history, _) = recorded(&scene, options, (2.0, Sampling::Steps));
        let exact = [3.0, 3.0, 2.234_567_89];
        for ((name, found), exact) in told(&history, &scene).iter().zip(exact) {
            assert!((found - exact).abs() < 1e-10, "{name}: {found}");
        }
    }
}

#[test]
fn the_last_instant_is_a_row_and_counts_though_the_grid_has_none_there() {
    let scene = scene(
        "model Fall {
            gravity: [0, 0, -10] m/s^2;
            point a { mass: 1 kg, start at [0, 0, 20] m }
            event down = a.position.z falls 0 m { then: stop }
            metric impact = final a.velocity.z;
            metric deepest = min a.position.z;
            metric speed = value a.velocity.z { at: down };
            metric way = integral a.velocity.z;
            metric t = time_of down;
        }",
    );
    for options in [Options::tsit5(1e-8), Options::rk4(0.07)] {
        let (history, stop) = recorded(&scene, options, (10.0, Sampling::Every(0.3)));
        assert_eq!(stop, Stop::Event(0));
        let exact = [-20.0, 0.0, -20.0, -20.0, 2.0];
        for ((name, found), exact) in told(&history, &scene).iter().zip(exact) {
            assert!((found - exact).abs() < 1e-9, "{name}: {found}");
        }
        let last = history.times().last().expect("a row");
        assert!((last - 2.0).abs() < 1e-9, "{last}");
        assert_eq!(history.len(), 8);
    }
}

#[test]
fn a_run_that_goes_on_has_the_rows_of_its_grid_and_one_end() {
    let scene = stone("");
    let model = Interpreted::<f64>::new(scene.clone(), &[]).expect("no params");
    let mut history = Trajectory::new(&model, Sampling::Every(0.25), Content::RESULTS);
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("a model that runs");
    for until in [0.1, 0.6, 0.75, 1.9] {
        run.record(until, &mut history).expect("a run that ends");
        assert_eq!(history.times().last(), Some(&until));
    }
    let grid = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 1.9];
    assert_eq!(history.times(), grid);
    assert!((value(&history, &scene, "apex") - 5.0).abs() < 1e-9);
    let half = 0.02_f64.sqrt();
    assert!((value(&history, &scene, "high") - 2.0 * half).abs() < 1e-9);
}

#[test]
fn a_jump_of_what_is_measured_is_enclosed_and_noise_costs_no_run() {
    let scene = scene(
        "model Step {
            gravity: none;
            point a { mass: 1 kg, start at [0, 0, 0] m velocity [1, 0, 0] m/s }
            metric stage = max if(a.position.x > 0.3 m, 2 m, 1 m);
            metric area = integral if(a.position.x > 0.3 m, 2 m, 1 m);
            metric since = first_above (if(a.position.x > 0.3 m, 2 m, 1 m)) { level: 1.5 m };
            metric fast = rms sin(200 rad/s * time);
        }",
    );
    let (history, _) = recorded(&scene, Options::vern7(1e-8), (1.0, Sampling::Steps));
    // ∫ sin² 200 t over 1 s.
    let rms = (0.5 - (400.0_f64).sin() / 800.0).sqrt();
    for (name, exact) in [("stage", 2.0), ("area", 1.7), ("since", 0.3), ("fast", rms)] {
        let found = value(&history, &scene, name);
        assert!(
            (found - exact).abs() < 1e-7,
            "{name}: {found} instead of {exact}"
        );
    }
}

#[test]
fn a_quantity_that_is_no_number_at_the_start_counts_where_it_is_one_and_what_needs_it_says_when() {
    // x = t², v = 2 t: x/v is 0/0 at the start from rest, 1/v infinite, then t/2 and 1/(2 t).
    let scene = scene(
        "model Rest {
            gravity: none;
            point a { mass: 1 kg, start at [0, 0, 0] m }
            load f on a = [2 N, 0 N, 0 N];
            event stopped = time rises 5 s;
            event at_once = a.position.x rises 1e-6 m;
            metric last = final a.position.x / a.velocity.x;
            metric early = final a.position.x / a.velocity.x { to: 1 ms };
            metric later = max a.position.x / a.velocity.x { from: 1 s };
            metric inverse = mean 1 m/s / a.velocity.x { from: 10 ms };
            metric first = value a.position.x / a.velocity.x { at: at_once };
            metric whole = max a.position.x / a.velocity.x;
            metric never = time_of stopped;
            metric above = first_above a.position.x { level: 1 km };
            metric behind = mean a.position.x { from: 3 s };
        }",
    );
    let mean = (2.0_f64 / 0.01).ln() / 2.0 / 1.99;
    let exact = [
        ("last", Ok(1.0)),
        ("early", Ok(5e-4)),
        ("later", Ok(1.0)),
        ("inverse", Ok(mean)),
        ("first", Ok(5e-4)),
        ("whole", Err(MissingMetric::NotANumber { time: 0.0 })),
        ("never", Err(MissingMetric::NoEvent)),
        ("above", Err(MissingMetric::NotPassed)),
        ("behind", Err(MissingMetric::NothingInWindow)),
    ];
    for options in [Options::tsit5(1e-10), Options::rk4(0.5)] {
        let (history, _) = recorded(&scene, options, (2.0, Sampling::Steps));
        for (metric, (name, exact)) in history.metrics(&scene).iter().zip(exact) {
            assert_eq!(metric.name, name);
            match (metric.value, exact) {
                (Ok(found), Ok(exact)) => {
                    assert!((found - exact).abs() < 1e-8, "{name}: {found} for {exact}")
                }
                (found, exact) => assert_eq!(found, exact, "{name}"),
            }
        }
    }
    let told = MissingMetric::NotANumber { time: 0.25 }.to_string();
    assert_eq!(told, "its quantity is not a number at 0.25 s");
}

#[test]
fn the_least_of_what_is_never_negative_is_not_below_zero() {
    // A line that is slack for a while, and the power of a damper, which is zero where the stone turns.
    let scene = scene(
        "model Bob {
            gravity: [0, 0, -10] m/s^2;
            point a { mass: 1 kg, start at [0, 0, 0] m velocity [0, 0, 3] m/s }
            line rope from world to a { free_length: 0.3 m, stiffness: 700 N/m }
            metric pull = min rope.tension;
            metric power = min 3 N*s/m * dot(a.velocity, a.velocity);
            metric loss = max -3 N*s/m * a.velocity.z^2;
            metric lowest = min a.position.z;
        }",
    );
    for options in [
        Options::tsit5(1e-8),
        Options::vern7(1e-6),
        Options::rk4(0.01),
    ] {
        let (history, _) = recorded(&scene, options, (3.0, Sampling::Steps));
        let told = history.metrics(&scene);
        let value = |at: usize| told[at].value.expect("a value");
        assert_eq!(value(0), 0.0, "{options:?}");
        for at in [1, 2] {
            let size = value(at) * if at == 1 { 1.0 } else { -1.0 };
            assert!((0.0..1e-6).contains(&size), "{options:?}: {size}");
        }
        assert!(value(3) < -0.3);
    }
}

/// Beside the corner of what is clamped a polynomial swings below zero, by several times what it may be off by: the law decides.
#[test]
fn the_least_of_what_is_clamped_is_zero_however_coarse_the_run_and_of_what_dips_below_zero_it_is_the_dip()
 {
    let text = |start: f64| {
        format!(
            "model Clamp {{
                gravity: none;
                point a {{ mass: 1 kg, start at [{start} m, 0 m, 0 m] }}
                load s on a = -1 N/m * a.position;
                let pull = max(0 N, 1e5 N/m * a.position.x);
                let push = min(0 N, 1e5 N/m * a.position.x);
                metric least = min pull;
                metric most = max push;
                metric late = min pull {{ from: 1.7 s }}
                metric last = final pull {{ to: 1.6 s }}
                metric rests = final pull {{ to: 3.01 s }}
                metric dip = min (a.position.x / (1 m))^2 - 1e-6;
            }}"
        )
    };
    let runs = [
        Options::rk4(0.25),
        Options::rk4(0.013),
        Options::tsit5(1e-3),
        Options::tsit5(1e-6),
        Options::vern7(1e-8),
        Options::rodas5p(1e-5),
        Options::rattle(0.02),
    ];
    for start in [0.77, 1.0, 1.37, 2.1, 5.5] {
        let scene = scene(&text(start));
        for options in runs {
            let (history, _) = recorded(&scene, options, (10.0, Sampling::Every(0.7)));
            let found = |name: &str| value(&history, &scene, name);
            for name in ["least", "most", "late", "last", "rests"] {
                assert_eq!(found(name), 0.0, "{name} from {start}, {options:?}");
            }
            let dip = found("dip") + 1e-6;
            let fine = matches!(options.method, Method::Vern7 { .. });
            assert!(!fine || dip.abs() < 1e-9, "{dip} from {start}, {options:?}");
        }
    }
}

/// A ball that bounces on a stiff spring of the ground, with or without events at the ground: v = √(2 g h), ω = √(k/m), each contact takes (2/ω) (π − atan(v ω/g)).
#[test]
fn the_time_in_contact_does_not_depend_on_events_at_the_contact() {
    let (g, h, k) = (9.81_f64, 1.0, 1e5_f64);
    let (v, omega) = ((2.0 * g * h).sqrt(), k.sqrt());
    let exact = 4.0 * 2.0 / omega * (PI - (v * omega / g).atan());
    let text = |events: &str| {
        format!(
            "model Dwell {{
                gravity: [0, 0, -9.81] m/s^2;
                point ball {{ mass: 1 kg, start at [0, 0, 1] m }}
                let f = max(0 N, -1e5 N/m * ball.position.z);
                load ground on ball = [0 N, 0 N, f];
                {events}
                metric contact = time_above f {{ level: 0 N }};
                metric depth = time_above -ball.position.z {{ level: 0 m }};
                metric first = first_above f {{ level: 0 N }};
            }}"
        )
    };
    let alone = scene(&text(""));
    let told_of = scene(&text(
        "event hit = ball.position.z falls 0 m; event off = ball.position.z rises 0 m;",
    ));
    for scene in [&alone, &told_of] {
        for options in [
            Options::tsit5(1e-8),
            Options::vern7(1e-8),
            Options::tsit5(1e-6),
        ] {
            let (history, _) = recorded(scene, options, (4.0, Sampling::Every(0.01)));
            let within = if options == Options::tsit5(1e-6) {
                1e-5
            } else {
                1e-7
            };
            for name in ["contact", "depth"] {
                let off = value(&history, scene, name) / exact - 1.0;
                println!("{name} {off:.1e}");
                assert!(off.abs() < within, "{name} {off:e} {options:?}");
            }
            let first = value(&history, scene, "first") - (2.0 * h / g).sqrt();
            assert!(first.abs() < 1e-7, "{first:e}");
        }
    }
}

#[test]
fn the_largest_value_is_seen_where_a_quantity_is_the_same_at_both_ends_of_its_step() {
    let scene = scene(
        "model Between {
            gravity: none;
            point a { mass: 1 kg, start at [0, 0, 0] m }
            let away = (time - 0.57 s) / (0.03 s);
            output pulse = max(0, 1 - away^2);
            output wave = (1 + 0.5 * time / (1 s)) * sin(2 * pi * 10 Hz * time);
            metric peak = max pulse;
            metric highest = max wave;
            metric lowest = min wave;
        }",
    );
    // A pulse that begins behind the first look into a step and ends before the step does, and a wave with a period a step.
    let (history, _) = recorded(&scene, Options::rk4(0.1), (1.0, Sampling::Steps));
    let wave = |time: f64| (1.0 + 0.5 * time) * (TAU * 10.0 * time).sin();
    let fine = (0..=1_000_000).map(|k| wave(1e-6 * f64::from(k)));
    let [low, high] = fine.fold([0.0_f64; 2], |[low, high], x| [low.min(x), high.max(x)]);
    for (name, exact) in [("peak", 1.0), ("highest", high), ("lowest", low)] {
        let found = value(&history, &scene, name);
        assert!((found - exact).abs() < 1e-8, "{name}: {found}, {exact}");
    }
}

#[test]
fn the_braces_of_a_metric_stand_behind_an_if_with_its_values_in_brackets() {
    let scene = scene(
        "model Pulse {
            gravity: none;
            state x = 0 m { rate: 1 m/s }
            metric high = time_above if(x > 1 m && x < 3 m, 5, 0) { level: 2 };
            metric low = time_above if x > 1 m && x < 3 m { 5 } else { 0 } { level: 2, to: 2 s };
        }",
    );
    let (history, _) = recorded(&scene, Options::tsit5(1e-8), (10.0, Sampling::Steps));
    for (name, exact) in [("high", 2.0), ("low", 1.0)] {
        let found = value(&history, &scene, name);
        assert!((found - exact).abs() < 1e-7, "{name}: {found}");
    }
}

#[test]
fn a_window_that_begins_or_ends_at_a_jump_holds_its_own_side_of_it() {
    // Both quantities are 1 at 3 s itself.
    let text = |event: &str| {
        format!(
            "model Jump {{
                gravity: none;
                point a {{ mass: 1 kg, start at [1 m, 0 m, 0 m] }}
                load k on a = -1 N/m * a.position;
                {event}
                metric behind = max if(time < 3 s, 5 m, 1 m) {{ from: 3 s }};
                metric level = rms if(time < 3 s, 5 m, 1 m) {{ from: 3 s }};
                metric passed = first_above if(time < 3 s, 5 m, 1 m) {{ level: 2 m, from: 3 s }};
                metric before = max if(time > 3 s, 5 m, 1 m) {{ to: 3 s }};
                metric least = min if(time > 3 s, -5 m, 1 m) {{ to: 3 s }};
            }}"
        )
    };
    for event in ["", "event tick = time rises 3 s;"] {
        let scene = scene(&text(event));
        for options in [
            Options::tsit5(1e-6),
            Options::vern7(1e-9),
            Options::rodas5p(1e-6),
            Options::rk4(0.01),
            Options::rk4(0.07),
        ] {
            let (history, _) = recorded(&scene, options, (5.0, Sampling::Every(0.1)));
            for name in ["behind", "level", "before", "least"] {
                let value = value(&history, &scene, name);
                assert!(
                    (value - 1.0).abs() < 1e-9,
                    "{event} {:?}: {name} {value}",
                    options.method
                );
            }
            let passed = value(&history, &scene, "passed");
            assert!(passed.is_nan(), "{event} {:?}: {passed}", options.method);
        }
    }
}
