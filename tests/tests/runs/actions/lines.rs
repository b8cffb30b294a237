//! Lines and springs that are detached and attached.

use mbd_compiler::Interpreted;
use mbd_runtime::{
    Content, Generic, Model, Options, PointState, Quantity, Sampling, Simulation, Trajectory, model,
};
use tests::agreement::{agrees, agrees_along};

use super::{G, methods};

model! {
    /// A mass that hangs on a cord and on a spring beside it, both cut after a second.
    pub model Dropped<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        point mass { mass: 2.0 kg, start at [0.0, 0.0, -1.0] m }
        line cord from world to mass { free_length: 0.9 m, stiffness: 98.1 N/m, damping: 3 N*s/m }
        spring beside from world to mass { free_length: 0.9 m, stiffness: 98.1 N/m }
        event cut = time rises 1 s { detach: [cord, beside] }
        output pull = cord.tension;
        output push = beside.tension;
        output stored = energy.potential;
    }
}

model! {
    /// A load on two lines from the walls that meet in a knot, and a third that goes after half a second and comes back after one.
    model Knotted {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world {
            frame left at [-1.0, 0.0, 2.0] m,
            frame right at [1.0, 0.0, 2.0] m,
            frame aside at [-2.0, 0.0, 1.0] m,
        }
        point bulk { mass: 3.0 kg, start at [-0.4, 0.0, 0.2] m }
        point knot { equilibrium: static }
        line a from world.left to knot { free_length: 1.2 m, stiffness: 60 N/m }
        line b from world.right to knot { free_length: 1.2 m, stiffness: 60 N/m }
        line pulled from world.aside to knot { free_length: 0.5 m, stiffness: 10 N/m }
        line cord from knot to bulk { free_length: 0.5 m, stiffness: 60 N/m }
        event gone = time rises 0.5 s { detach: pulled }
        event back = time rises 1 s { attach: pulled }
    }
}

model! {
    /// The same with damped lines and a node with a velocity.
    model Damped {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world {
            frame left at [-1.0, 0.0, 2.0] m,
            frame right at [1.0, 0.0, 2.0] m,
            frame aside at [-2.0, 0.0, 1.0] m,
        }
        point bulk { mass: 3.0 kg, start at [-0.4, 0.0, 0.2] m }
        point knot { equilibrium: rate }
        line a from world.left to knot { free_length: 1.2 m, stiffness: 60 N/m, damping: 3 N*s/m }
        line b from world.right to knot { free_length: 1.2 m, stiffness: 60 N/m, damping: 3 N*s/m }
        line pulled from world.aside to knot {
            free_length: 0.5 m,
            stiffness: 10 N/m,
            damping: 3 N*s/m,
        }
        line cord from knot to bulk { free_length: 0.5 m, stiffness: 60 N/m, damping: 3 N*s/m }
        event gone = time rises 0.5 s { detach: pulled }
        event back = time rises 1 s { attach: pulled }
    }
}

model! {
    /// The same with damping by differences.
    model Stepwise {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world {
            frame left at [-1.0, 0.0, 2.0] m,
            frame right at [1.0, 0.0, 2.0] m,
            frame aside at [-2.0, 0.0, 1.0] m,
        }
        point bulk { mass: 3.0 kg, start at [-0.4, 0.0, 0.2] m }
        point knot { equilibrium: stepwise }
        line a from world.left to knot { free_length: 1.2 m, stiffness: 60 N/m, damping: 3 N*s/m }
        line b from world.right to knot { free_length: 1.2 m, stiffness: 60 N/m, damping: 3 N*s/m }
        line pulled from world.aside to knot {
            free_length: 0.5 m,
            stiffness: 10 N/m,
            damping: 3 N*s/m,
        }
        line cord from knot to bulk { free_length: 0.5 m, stiffness: 60 N/m, damping: 3 N*s/m }
        event gone = time rises 0.5 s { detach: pulled }
        event back = time rises 1 s { attach: pulled }
    }
}

model! {
    /// A mass that falls past a net, which is spread when it is at its height.
    model Caught {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        point mass { mass: 2.0 kg, start at [0.0, 0.0, 1.0] m }
        spring net from world to mass { free_length: 0 m, stiffness: 800 N/m, at_start: detached }
        event spread = mass.position.z falls 0 m { attach: net }
    }
}

#[test]
fn a_mass_whose_lines_are_cut_flies_a_parabola() {
    let model = Dropped::<f64>::new(DroppedParams::default()).expect("defaults");
    // Rattle takes the rounding of an exact rest for an instability.
    for options in methods().into_iter().skip(1) {
        let word = options.method.name();
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.run(2.0).expect("a smooth motion");
        let at = run.events().last().expect("the cut").time;
        assert!((at - 1.0).abs() < 1e-13, "{word}: {at}");
        let state = DroppedState::from_slice(run.state()).expect("a state");
        // 196.2 N/m over 0.1 m carry 2 kg: at rest until then.
        let (fall, speed) = (0.5 * G, -G);
        let mass = state.mass();
        assert!(
            (mass.position[2] + 1.0 + fall).abs() < 1e-12,
            "{word}: {mass:?}"
        );
        assert!((mass.velocity[2] - speed).abs() < 1e-12, "{word}: {mass:?}");
        // Both stored ½ K s² = 0.4905 J, which went with them.
        let [acted] = run.actions() else {
            panic!("one action")
        };
        assert_eq!(acted.events, [0]);
        assert!(
            (acted.work().expect("an energy") + 0.981).abs() < 1e-12,
            "{word}: {acted:?}"
        );
        let imbalance = run.imbalance();
        assert!(
            imbalance.is_none_or(|it| it.relative() < 1e-8),
            "{word}: {imbalance:?}"
        );
    }
}

#[test]
fn a_cut_line_pulls_with_nothing_and_stores_nothing_on_both_sides_of_the_instant() {
    let model = Dropped::<f64>::new(DroppedParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-2)).expect("options that fit");
    let mut history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
    run.record(1.5, &mut history).expect("a smooth motion");
    let column = |name| history.column(name).expect("a column");
    let cut = run.events().last().expect("the cut").time;
    let rows: Vec<usize> = (0..history.len())
        .filter(|&row| history.times()[row] == cut)
        .collect();
    let [before, after] = rows[..] else {
        panic!("two sides: {rows:?}")
    };
    for (name, pull) in [("pull", 9.81), ("push", 9.81), ("energy.elastic", 0.981)] {
        assert!((column(name)[before] - pull).abs() < 1e-10, "{name}");
        assert!(column(name)[after..].iter().all(|x| *x == 0.0), "{name}");
    }
    let (total, actions) = (column("energy.total"), column("work.actions"));
    assert_eq!(actions[before], 0.0);
    let balance = |row: usize| total[row] - actions[row];
    assert!((0..history.len()).all(|row| (balance(row) - balance(0)).abs() < 1e-11));
    assert_eq!(history.events.len(), 1);
    assert_eq!(history.events[0].1, "cut");
}

#[test]
fn generated_interpreted_and_generic_models_act_alike() {
    let model = Dropped::<f64>::new(DroppedParams::default()).expect("defaults");
    agrees(&model);
    let start = [0.05, 0.0, -0.95, 0.0, 0.3, 0.0];
    agrees_along(&model, &start, (200, 0.01), 1e-12);
    let model = Knotted::new(KnottedParams::default()).expect("defaults");
    agrees(&model);
    agrees_along(&model, &[-0.4, 0.0, 0.1, 0.0, 0.0, 0.0], (200, 0.01), 1e-9);
    let model = Damped::new(DampedParams::default()).expect("defaults");
    agrees(&model);
}

#[test]
fn single_precision_acts_like_double_precision() {
    let model = Dropped::<f32>::new(DroppedParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-2)).expect("options that fit");
    run.run(2.0).expect("a smooth motion");
    let state = DroppedState::from_slice(run.state()).expect("a state");
    assert!((state.mass().position[2] + 1.0 + 0.5 * 9.81).abs() < 1e-4);
}

/// Tensions of the lines of a run.
fn tensions(run: &mut Simulation<f64>) -> Vec<f64> {
    let mut lines = vec![0.0; run.model().layout().len(Quantity::Lines)];
    run.evaluate(Quantity::Lines, &mut lines).expect("lines");
    lines.chunks_exact(10).map(|line| line[0]).collect()
}

/// A load on a knot: before, while the line is gone, and with it back; the same scene without the line from the state in between.
fn on_a_knot(model: &dyn Model<f64>, options: Options) -> [Vec<f64>; 3] {
    let mut run = Simulation::new(model, options).expect("options that fit");
    [0.4, 0.9, 1.5].map(|until| {
        run.run(until).expect("a run");
        tensions(&mut run)
    })
}

#[test]
fn a_line_of_a_node_goes_and_comes_back() {
    let models: [(&dyn Model<f64>, Vec<Options>); 3] = [
        (
            &Knotted::new(KnottedParams::default()).expect("defaults"),
            vec![Options::rk4(2e-3), Options::tsit5(1e-9)],
        ),
        (
            &Damped::new(DampedParams::default()).expect("defaults"),
            vec![Options::rk4(2e-3), Options::tsit5(1e-9)],
        ),
        (
            &Stepwise::new(StepwiseParams::default()).expect("defaults"),
            vec![Options::rk4(2e-3)],
        ),
    ];
    for (model, all) in models {
        for options in all {
            let word = format!("{} {}", model.scene().name, options.method.name());
            let [before, gone, back] = on_a_knot(model, options);
            assert!(
                before[2] > 1.0 && back[2] > 1.0,
                "{word}: {before:?} {back:?}"
            );
            assert_eq!(gone[2], 0.0, "{word}");
            assert!(
                gone[0] > 1.0 && gone[1] > 1.0 && gone[3] > 1.0,
                "{word}: {gone:?}"
            );
            let generic = Generic::with_defaults(model.scene().clone()).expect("defaults");
            let interpreted =
                Interpreted::new(model.scene().clone(), model.params()).expect("defaults");
            for other in [&generic as &dyn Model<f64>, &interpreted] {
                let theirs = on_a_knot(other, options);
                for (ours, theirs) in [before.clone(), gone.clone(), back.clone()]
                    .iter()
                    .zip(&theirs)
                {
                    let apart = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs());
                    assert!(
                        apart.fold(0.0, f64::max) < 1e-6,
                        "{word}: {ours:?} {theirs:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_knot_that_lost_a_line_is_in_the_balance_of_the_others() {
    let model = Knotted::new(KnottedParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(2e-3)).expect("options that fit");
    run.run(0.8).expect("a run");
    let (time, state) = (run.time(), run.state().to_vec());
    // The same scene without the line.
    let mut scene = model.scene().clone();
    scene.events.clear();
    scene.lines.remove(2);
    let without = Generic::with_defaults(scene).expect("defaults");
    let mut other = Simulation::new(&without, Options::rk4(2e-3)).expect("options that fit");
    other.set_state(time, &state).expect("a state");
    other.start().expect("a start");
    let [ours, theirs] = [tensions(&mut run), tensions(&mut other)];
    for (ours, theirs) in [
        (ours[0], theirs[0]),
        (ours[1], theirs[1]),
        (ours[3], theirs[2]),
    ] {
        assert!((ours - theirs).abs() < 1e-9 * ours, "{ours} {theirs}");
    }
    let ends = [&mut run, &mut other].map(|run| {
        run.run(0.95).expect("a run");
        run.state().to_vec()
    });
    assert!(tests::largest_difference(&ends[0], &ends[1]) < 1e-9);
}

#[test]
fn a_line_that_starts_detached_carries_from_the_event_on() {
    let model = Caught::new(CaughtParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.run(1.0).expect("a smooth motion");
        let fall = (2.0 / G).sqrt();
        let at = run.events().first().expect("the height is passed").time;
        assert!((at - fall).abs() < 1e-9, "{word}: {at}");
        // From there a spring of 20 rad/s about m g/K below, with the speed √(2 g h).
        let (t, w, sag) = (1.0 - fall, 20.0_f64, G / 400.0);
        let speed = -(2.0 * G).sqrt();
        let z = -sag + sag * (w * t).cos() + speed / w * (w * t).sin();
        let state = CaughtState::from_slice(run.state()).expect("a state");
        assert!((state.mass().position[2] - z).abs() < 1e-7, "{word}");
        assert_eq!(
            run.actions()[0].work().map(|work| work.abs() < 1e-9),
            Some(true)
        );
    }
}

#[test]
fn another_run_begins_with_what_is_declared_and_the_same_run_goes_on_with_what_was_done() {
    let model = Dropped::<f64>::new(DroppedParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-2)).expect("options that fit");
    run.run(1.2).expect("a smooth motion");
    run.start().expect("a start");
    assert_eq!(tensions(&mut run), [0.0, 0.0]);
    run.set_params(&[]).expect("no params");
    run.run(1.3).expect("a smooth motion");
    assert_eq!(tensions(&mut run), [0.0, 0.0]);
    let mut start = DroppedState::at_origin();
    start.set_mass(PointState {
        position: [0.0, 0.0, -1.0],
        velocity: [0.0; 3],
    });
    run.set_state(0.0, &start.to_vec()).expect("a state");
    run.start().expect("a start");
    assert!(
        tensions(&mut run)
            .iter()
            .all(|pull| (pull - 9.81).abs() < 1e-12)
    );
    run.run(2.0).expect("a smooth motion");
    // That of the run before is none of this one.
    assert_eq!(run.actions().len(), 1);
}
