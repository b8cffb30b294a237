//! Events are found where they happen: inside a step whether they act or not, at the end of a run, and not at a start that is at their value.

use mbd_compiler::{Interpreted, read_text, read_toml, write_toml};
use mbd_runtime::{Generic, Happening, Mode, Model, Options, Simulation, Stop};

/// A stone along z with this start, 10 m/s² of gravity, and these items.
fn stone(start: &str, items: &str) -> String {
    format!(
        "model Stone {{
            gravity: [0, 0, -10] m/s^2;
            point a {{ mass: 1 kg, start at {start} }}
            {items}
        }}"
    )
}

/// The declared events of a run of every form of a declaration: when and which, the same of all.
fn happened(text: &str, options: Options, until: f64) -> (Vec<(f64, usize)>, Stop) {
    let read = read_text(text);
    let scene = read.scene.unwrap_or_else(|| panic!("{:?}", read.errors));
    let again = read_toml(&write_toml(&scene)).scene.expect("a document");
    let models = [
        Interpreted::<f64>::new(scene.clone(), &[])
            .expect("no params")
            .share(),
        Interpreted::<f64>::new(again, &[])
            .expect("no params")
            .share(),
        Generic::<f64>::with_defaults(scene)
            .expect("no params")
            .share(),
    ];
    let all = models.map(|model| {
        let mut run = Simulation::new(&*model, options).expect("a model that runs");
        let stop = run.run(until).expect("a run that ends");
        let declared = run.events().iter().filter_map(|it| match it.what {
            Happening::Declared(event) => Some((it.time, event)),
            Happening::Switch(..) => None,
        });
        (declared.collect::<Vec<_>>(), stop)
    });
    for other in &all[1..] {
        assert_eq!(other.1, all[0].1);
        assert_eq!(other.0.len(), all[0].0.len(), "{all:?}");
    }
    let [first, ..] = all;
    first
}

fn methods() -> [Options; 5] {
    [
        Options::tsit5(1e-8),
        Options::vern7(1e-8),
        Options::rodas5p(1e-8),
        Options::auto(1e-8),
        Options::rk4(0.4),
    ]
}

#[test]
fn what_is_passed_and_left_again_inside_a_step_is_found_whether_it_acts_or_not() {
    // An apex of 5 m at 1 s; a level d below it is passed √(d/5) s before and behind.
    for level in [4.9, 4.99, 4.9999] {
        let half = ((5.0_f64 - level) / 5.0).sqrt();
        for acts in [";", "{ set: n = n + 1 }"] {
            let items = format!(
                "state n = 0 {{ rate: 0 Hz }}
                 event up = a.position.z rises {level} m {acts}
                 event down = a.position.z falls {level} m;"
            );
            let text = stone("[0, 0, 0] m velocity [0, 0, 10] m/s", &items);
            for options in methods() {
                let (events, _) = happened(&text, options, 1.9);
                let exact = [(1.0 - half, 0), (1.0 + half, 1)];
                assert_eq!(events.len(), 2, "{level} {acts} {options:?} {events:?}");
                for (found, exact) in events.iter().zip(exact) {
                    let close = (found.0 - exact.0).abs() < 1e-9 && found.1 == exact.1;
                    assert!(close, "{level} {options:?}: {events:?}");
                }
            }
        }
    }
}

#[test]
fn a_level_just_above_the_apex_is_not_passed() {
    let items = "event over = a.position.z rises 5.000001 m;";
    let text = stone("[0, 0, 0] m velocity [0, 0, 10] m/s", items);
    for options in methods() {
        assert_eq!(happened(&text, options, 1.9).0, []);
    }
}

#[test]
fn a_guard_that_starts_at_its_value_has_passed_nothing() {
    let items = "event up = a.position.z rises 1 m;
                 event down = a.position.z falls 1 m;
                 event any = a.position.z crosses 1 m;";
    for options in methods() {
        // Thrown up it comes back after 2 s; thrown down and dropped from rest it does not.
        let thrown = stone("[0, 0, 1] m velocity [0, 0, 10] m/s", items);
        let (events, _) = happened(&thrown, options, 3.0);
        let found: Vec<usize> = events.iter().map(|it| it.1).collect();
        assert_eq!(found.len(), 2, "{options:?}: {events:?}");
        assert!(found.contains(&1) && found.contains(&2), "{events:?}");
        assert!(
            events.iter().all(|it| (it.0 - 2.0).abs() < 1e-9),
            "{events:?}"
        );
        for velocity in [-10, 0] {
            let falls = stone(
                &format!("[0, 0, 1] m velocity [0, 0, {velocity}] m/s"),
                items,
            );
            assert_eq!(happened(&falls, options, 3.0).0, [], "{options:?}");
        }
    }
}

/// The limit of a delay that becomes short, which a sweep or a dispersion may reach.
#[test]
fn time_comes_from_before_the_start() {
    for delay in ["0 s", "1e-13 s", "1e-9 s", "1e-3 s"] {
        let items = format!(
            "body ball {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
             joint held: rigid from world to ball.com;
             event go = time rises {delay} {{ detach: held }}
             event down = -time falls 0 s;
             event twice = time crosses {delay};"
        );
        let text = stone("[0, 0, 0] m", &items);
        for options in methods() {
            let (events, _) = happened(&text, options, 2.0);
            let found: Vec<usize> = events.iter().map(|it| it.1).collect();
            let late = events.iter().filter(|it| it.0 > 1.1e-3);
            assert_eq!(late.count(), 0, "{delay} {options:?} {events:?}");
            assert!(
                found.contains(&0) && found.contains(&2),
                "{delay} {options:?} {events:?}"
            );
            let scene = read_text(&text).scene.expect("a scene");
            let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
            let mut run = Simulation::new(&model, options).expect("a model that runs");
            run.run(2.0).expect("a run that ends");
            // z = −g t²/2 as if it had never been held.
            let z = run.state()[2];
            assert!((z + 20.0).abs() < 0.03, "{delay} {options:?} {z}");
        }
    }
}

#[test]
fn an_event_at_the_end_of_a_run_counts_once() {
    let text = stone("[0, 0, 0] m", "event done = time rises 5 s;");
    let stops = stone("[0, 0, 0] m", "event done = time rises 5 s { then: stop }");
    for options in methods() {
        let (events, stop) = happened(&text, options, 5.0);
        assert_eq!((events.as_slice(), stop), (&[(5.0, 0)][..], Stop::Reached));
        let (events, stop) = happened(&stops, options, 5.0);
        assert_eq!((events.as_slice(), stop), (&[(5.0, 0)][..], Stop::Event(0)));
    }
    let scene = read_text(&text).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("a model that runs");
    for until in [5.0, 5.0, 5.5, 9.0] {
        run.run(until).expect("a run that ends");
        assert_eq!(run.events().len(), 1);
    }
}

/// What a line without damping does is told alike, whatever rounding makes of its pull and its stretch, which are one there.
#[test]
fn an_undamped_line_is_taut_and_slack_by_turns() {
    for k in [7.3e4, 9.1e4, 1e5, 1.23e5, 2.7e6] {
        let text = format!(
            "model Cord {{
                gravity: [0, 0, -9.81] m/s^2;
                world {{ frame up at [0, 0, 2] m }}
                point ball {{ mass: 1 kg, start at [0, 0, 1] m }}
                line cord from world.up to ball {{ free_length: 2 m, stiffness: {k} N/m }}
            }}"
        );
        let scene = read_text(&text).scene.expect("a scene");
        let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
        for options in [
            Options::tsit5(1e-8),
            Options::vern7(1e-9),
            Options::rk4(1e-4),
        ] {
            let mut run = Simulation::new(&model, options).expect("a model that runs");
            run.run(4.0).expect("a run that ends");
            let modes = run.events().iter().filter_map(|event| match event.what {
                Happening::Switch(_, mode) => Some(mode),
                Happening::Declared(_) => None,
            });
            let modes: Vec<Mode> = modes.collect();
            assert_eq!(modes.len(), 8, "{k} {options:?} {modes:?}");
            for pair in modes.chunks(2) {
                assert_eq!(pair, [Mode::Active, Mode::Slack], "{k} {options:?}");
            }
        }
    }
}
