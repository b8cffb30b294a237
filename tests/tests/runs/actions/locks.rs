//! Coordinates that events lock where they are, and free again.

use mbd_compiler::{Interpreted, read_text, read_toml, write_toml};
use mbd_runtime::{Generic, Model, Options, Quantity, Simulation, StepError, model, trim};
use mbd_scene::Detachable;
use tests::agreement::agrees;
use tests::declared::read;
use tests::largest_difference;

use super::methods_in;

/// A hub that floats with a panel on a hinge through both centres of mass: it turns against the hub until it meets a latch at 90 deg. A torque on
/// the panel then turns both, and from 3 s on, when the latch opens, the panel alone.
macro_rules! latched {
    ($name:ident $family:ident) => {
        model! {
            /// A panel that swings out, is caught by a latch, and let go.
            pub model $name<T> {
                coordinates: $family;
                gravity: none;
                body hub { mass: 5 kg, inertia: diag(2, 3, 2) kg*m^2, start angular_velocity [0, 0.5, 0] rad/s }
                body panel { mass: 1 kg, inertia: diag(0.5, 1, 0.5) kg*m^2 }
                joint afloat: free from world to hub.com;
                joint pin: hinge from hub.com to panel.com { axis: y, start_rate: 2 rad/s }
                param moment = 0 N*m;
                load push on panel = [0 N*m, moment, 0 N*m];
                event pushed = time rises 2 s { set: moment = 1 N*m }
                event caught = pin.angle rises 90 deg { lock: pin.angle, acts: once }
                event opened = time rises 3 s { free: pin }
                output swung = pin.angle;
                output spun = hub.omega_world;
                output swings = pin.angle_rate;
            }
        }
    };
}
latched!(Absolute absolute);
latched!(Relative relative);

/// A pendulum that is held a turn and 40 deg from where it hangs, and let go after a second.
macro_rules! held {
    ($name:ident $family:ident) => {
        model! {
            /// A pendulum that is held at the start.
            pub model $name<T> {
                coordinates: $family;
                gravity: [0.0, 0.0, -9.81] m/s^2;
                body bob { mass: 2 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
                joint pin: hinge from world to bob.top { axis: y, start: 400 deg, stiffness: 1 N*m/rad, at_start: locked }
                event let_go = time rises 1 s { free: pin }
                output turned = pin.angle;
                output turns = pin.angle_rate;
                output held = pin.angle.lock.torque.y;
            }
        }
    };
}
held!(Held absolute);
held!(HeldTree relative);

/// Angle of the pin [rad] and rates of hub and pin about y [rad/s].
fn seen(run: &mut Simulation<f64>) -> [f64; 3] {
    let mut outputs = [0.0; 5];
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("outputs");
    [outputs[0], outputs[2], outputs[4]]
}

#[test]
fn a_latch_leaves_the_angular_momentum_and_takes_what_a_plastic_impact_does() {
    let absolute = Absolute::<f64>::new(Default::default()).expect("defaults");
    let relative = Relative::<f64>::new(Default::default()).expect("defaults");
    for model in [&absolute as &dyn Model<f64>, &relative] {
        let generic = Generic::<f64>::with_defaults(model.scene().clone()).expect("defaults");
        let interpreted = Interpreted::<f64>::new(model.scene().clone(), &[0.0]).expect("defaults");
        for model in [model, &generic, &interpreted] {
            for options in methods_in(model.scene().coordinates) {
                let word = format!("{} {}", options.method.name(), model.scene().name);
                let mut run = Simulation::new(model, options).expect("options that fit");
                run.run(2.0).expect("caught");
                // 3 · 0.5 + 1 · 2.5 = 4 ω: both turn with 1 rad/s.
                let caught = std::f64::consts::FRAC_PI_2 / 2.0;
                assert!((run.events()[0].time - caught).abs() < 1e-9, "{word}");
                let lost = 0.5 * (3.0 * 1.0 / 4.0) * 4.0;
                let work = run.actions()[0].work().expect("an energy");
                assert!((work + lost).abs() < 1e-8, "{word}: {work} {lost}");
                let [angle, hub, pin] = seen(&mut run);
                let held = std::f64::consts::FRAC_PI_2;
                assert!((angle - held).abs() < 1e-9, "{word}: {angle}");
                assert!(
                    (hub - 1.0).abs() < 1e-9 && pin.abs() < 1e-9,
                    "{word}: {hub} {pin}"
                );
                // 1 N m on 4 kg m² for a second, then on the panel of 1 kg m² alone.
                run.run(3.0).expect("locked");
                let [angle, hub, pin] = seen(&mut run);
                assert!((angle - held).abs() < 1e-9, "{word}: {angle}");
                assert!(
                    (hub - 1.25).abs() < 1e-8 && pin.abs() < 1e-9,
                    "{word}: {hub} {pin}"
                );
                run.run(3.5).expect("free");
                let [angle, hub, pin] = seen(&mut run);
                assert!((angle - held - 0.125).abs() < 1e-8, "{word}: {angle}");
                assert!(
                    (hub - 1.25).abs() < 1e-8 && (pin - 0.5).abs() < 1e-8,
                    "{word}: {hub} {pin}"
                );
                assert_eq!(
                    run.actions()[2].work().map(|work| work.abs() < 1e-12),
                    Some(true)
                );
            }
        }
    }
}

#[test]
fn generated_and_interpreted_equations_are_those_of_the_laws_locked_and_free() {
    agrees(&Absolute::<f64>::new(Default::default()).expect("defaults"));
    agrees(&Relative::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn a_lock_in_single_precision_holds_as_finely_as_its_numbers() {
    let model = Relative::<f32>::new(Default::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    run.run(3.0).expect("locked");
    let mut outputs = [0.0_f32; 5];
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("outputs");
    assert!(
        (outputs[0] - std::f32::consts::FRAC_PI_2).abs() < 1e-4,
        "{outputs:?}"
    );
    // Half a last digit of 1.25 at each of a thousand steps that add to it.
    assert!((outputs[2] - 1.25).abs() < 3e-4, "{outputs:?}");
}

/// A bar that turns many times on a driven hub before it is locked, and a rod that slides and turns.
fn turning(family: &str) -> mbd_scene::Scene {
    read(&format!(
        "model Turning {{
            coordinates: {family};
            gravity: [0, 0, -9.81] m/s^2;
            body bar {{ mass: 2 kg, inertia: diag(0.3, 0.2, 0.3) kg*m^2 }}
            body rod {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame foot at [0, 0, -0.4] m }}
            joint pin: hinge from world to bar.com {{ axis: y, start_rate: 10 rad/s, damping: 0.01 N*m*s }}
            joint guide: cylindrical from world to rod.foot {{ axis: z, slide: {{ start: 1 m }}, angle: {{ start_rate: 3 rad/s }} }}
            event first = time rises 2 s {{ lock: [pin, guide] }}
            event second = time rises 4 s {{ free: guide.slide }}
            event third = time rises 5 s {{ free: [pin.angle, guide.angle] }}
            event fourth = time rises 6 s {{ lock: pin }}
            output slid = guide.slide;
            output twisted = guide.angle;
            output swung = pin.angle;
        }}"
    ))
}

#[test]
fn what_counts_turns_and_what_slides_stays_where_it_was_locked() {
    let outputs = |run: &mut Simulation<f64>| {
        let mut out = [0.0; 3];
        run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
        out
    };
    for family in ["absolute", "relative"] {
        let model = Generic::<f64>::with_defaults(turning(family)).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
        run.run(2.0).expect("free");
        let locked = outputs(&mut run);
        for time in [2.5, 3.9] {
            run.run(time).expect("locked");
            let now = outputs(&mut run);
            assert!(
                largest_difference(&now, &locked) < 1e-9,
                "{family} {now:?} {locked:?}"
            );
        }
        run.run(5.0).expect("the rod falls");
        let now = outputs(&mut run);
        // From rest, one second.
        assert!(
            (now[0] - (locked[0] - 0.5 * 9.81)).abs() < 1e-8,
            "{family} {now:?}"
        );
        assert!(
            largest_difference(&now[1..], &locked[1..]) < 1e-9,
            "{family} {now:?}"
        );
        run.run(7.0).expect("the bar rests");
        assert!((outputs(&mut run)[2] - locked[2]).abs() < 1e-9, "{family}");

        // A snapshot in between goes on to the bit; another start takes back what was locked.
        let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
        let start = run.state().to_vec();
        run.run(3.0).expect("locked");
        let kept = run.snapshot();
        let mut other = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
        other.restore(&kept).expect("a snapshot of this model");
        run.run(5.5).expect("a run");
        other.run(5.5).expect("a run");
        assert_eq!(run.state(), other.state(), "{family}");
        run.set_state(0.0, &start).expect("a state");
        run.run(1.0).expect("free");
        assert!(outputs(&mut run)[0] < 0.0, "{family}: it falls again");
        // Another run of the same scene takes over, locked as it was.
        let mut first = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
        first.run(3.0).expect("locked");
        let mut next = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
        next.take_over(&mut first, &[]).expect("a start");
        next.run(3.9).expect("locked");
        assert!(
            largest_difference(&outputs(&mut next), &locked) < 1e-9,
            "{family}"
        );
    }
}

/// A parallel crank, one freedom, driven by 1.7 N m on an inertia of 2 (0.1 + 0.25) + 1 = 1.7 kg m² about its angle; held by these joints and events.
fn crank(family: &str, more: &str) -> mbd_scene::Scene {
    read(&format!(
        "model Crank {{ gravity: none; coordinates: {family};
            body a {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame foot at [0, 0, -0.5] m, frame head at [0, 0, 0.5] m, start at [0, 0, 0.5] m }}
            body b {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame foot at [0, 0, -0.5] m, frame head at [0, 0, 0.5] m, start at [1.2, 0, 0.5] m }}
            body bar {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame left at [-0.6, 0, 0] m, frame right at [0.6, 0, 0] m, start at [0.6, 0, 1] m }}
            world {{ frame near at [0, 0, 0] m, frame far at [1.2, 0, 0] m }}
            joint p: hinge from world.near to a.foot {{ axis: y }}
            joint q: hinge from world.far to b.foot {{ axis: y }}
            joint r: hinge from a.head to bar.left {{ axis: y }}
            joint s: hinge from b.head to bar.right {{ axis: y }}
            load torque on a = [0, 1.7, 0] N*m;
            output leaning = p.angle;
            {more} }}"
    ))
}

#[test]
fn two_locks_of_one_freedom_hold_it_in_turn_and_together() {
    // Locked by p from 1 s to 2 s, by q from 3 s, by both from 3.2 s, by p alone from 3.4 s to 4 s; between, a second of 1 rad/s² from rest each.
    let events =
        "event first = time rises 1 s { lock: p } event second = time rises 2 s { free: p }
        event third = time rises 3 s { lock: q } event fourth = time rises 3.2 s { lock: p }
        event fifth = time rises 3.4 s { free: q } event sixth = time rises 4 s { free: p }";
    let expected = [
        (1.0, 0.5),
        (1.9, 0.5),
        (2.5, 0.625),
        (3.0, 1.0),
        (3.1, 1.0),
        (3.3, 1.0),
        (3.9, 1.0),
        (4.5, 1.125),
    ];
    for family in ["absolute", "relative"] {
        let scene = crank(family, events);
        let generic = Generic::<f64>::with_defaults(scene.clone()).expect("defaults");
        let interpreted = Interpreted::<f64>::new(scene, &[]).expect("defaults");
        for model in [&generic as &dyn Model<f64>, &interpreted] {
            for options in [
                Options::rk4(1e-2),
                Options::tsit5(1e-9),
                Options::rodas5p(1e-9),
            ] {
                let mut run = Simulation::new(model, options).expect("options");
                for (time, angle) in expected {
                    run.run(time)
                        .unwrap_or_else(|error| panic!("{family}: {error}"));
                    let mut outputs = [0.0];
                    run.evaluate(Quantity::Outputs, &mut outputs)
                        .expect("outputs");
                    assert!(
                        (outputs[0] - angle).abs() < 1e-7,
                        "{family} {} at {time} s: {} for {angle}",
                        options.method.name(),
                        outputs[0]
                    );
                }
            }
        }
    }
}

#[test]
fn locks_of_what_joints_hold_for_ever_are_refused_by_name() {
    let strut = "joint strut: distance from world.far to a.head { length: sqrt(2.44) * 1 m }";
    for family in ["absolute", "relative"] {
        let scene = crank(
            family,
            &format!("{strut} event one = time rises 1 s {{ lock: q.angle }}"),
        );
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let refused = Simulation::new(&model, Options::rk4(1e-3)).map(|_| ());
        let error = refused.expect_err("it holds nothing");
        assert!(
            matches!(error.cause, StepError::Unsupported { .. }),
            "{error}"
        );
        assert!(
            error.to_string().contains("`strut` hold `q.angle` already"),
            "{error}"
        );
        // One that may be detached leaves it something to hold.
        let scene = crank(
            family,
            &format!(
                "{strut} event one = time rises 1 s {{ lock: q.angle }} event two = time rises 2 s {{ detach: strut }}"
            ),
        );
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
        run.run(3.0)
            .unwrap_or_else(|error| panic!("{family}: {error}"));
        let mut outputs = [1.0];
        run.evaluate(Quantity::Outputs, &mut outputs)
            .expect("outputs");
        assert!(outputs[0].abs() < 1e-9, "{family}: {outputs:?}");
    }
}

#[test]
fn what_rounding_leaves_of_a_locked_coordinate_is_no_event() {
    let scene = read(
        "model Clutch {
            gravity: none;
            body a { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
            body b { mass: 1 kg, inertia: diag(2, 2, 3) kg*m^2 }
            joint drive: hinge from world to a.com { axis: z, start_rate: 10 rad/s, force: 1 N*m }
            joint driven: hinge from world to b.com { axis: z }
            loop joint slip: hinge from a.com to b.com { axis: z, force: -2 N*m * sign(slip.angle_rate) * slips }
            param slips = 1;
            event gripped = slip.angle_rate rises 0 rad/s { lock: slip, set: slips = 0, acts: once }
            event turned = slip.angle_rate crosses 0 rad/s;
        }",
    );
    let model = Generic::<f64>::with_defaults(scene).expect("defaults");
    for options in [Options::rk4(1e-3), Options::tsit5(1e-8)] {
        let mut run = Simulation::new(&model, options).expect("a start");
        run.run(8.0).expect("a run");
        // J_b ω̇_b = 2 N m, J_a ω̇_a = −1 N m from −10 rad/s on: 10/(1 + 2/3) = 6 s.
        let times: Vec<f64> = run.events().iter().map(|event| event.time).collect();
        assert_eq!(times.len(), 2, "{times:?}");
        assert!(
            times.iter().all(|time| (time - 6.0).abs() < 1e-8),
            "{times:?}"
        );
    }
}

#[test]
fn a_coordinate_that_is_locked_at_the_start_stays_there_until_an_event_frees_it() {
    let absolute = Held::<f64>::new(Default::default()).expect("defaults");
    let relative = HeldTree::<f64>::new(Default::default()).expect("defaults");
    let seen = |run: &mut Simulation<f64>| {
        let mut outputs = [0.0; 3];
        run.evaluate(Quantity::Outputs, &mut outputs)
            .expect("outputs");
        outputs
    };
    for model in [&absolute as &dyn Model<f64>, &relative] {
        let again = read_toml(&write_toml(model.scene()))
            .scene
            .expect("written by us");
        assert_eq!(&again, model.scene());
        assert_eq!(model.layout().freedoms_at_start(), 0);
        let generic = Generic::<f64>::with_defaults(again).expect("defaults");
        let interpreted = Interpreted::<f64>::new(model.scene().clone(), &[]).expect("defaults");
        // The same without the lock, for what comes after.
        let mut free = model.scene().clone();
        let lock = free.lock_of(0, 0).map(Detachable::Joint);
        free.starts.detached.extend(lock);
        let free = Generic::<f64>::with_defaults(free).expect("defaults");
        for model in [model, &generic, &interpreted] {
            for options in methods_in(model.scene().coordinates) {
                let word = format!("{} {}", options.method.name(), model.scene().name);
                let mut run = Simulation::new(model, options).expect("options that fit");
                for held in [400f64.to_radians(), 0.5] {
                    run.set_joints(&[("pin.angle", held)]).expect("one freedom");
                    run.run(run.time() + 0.9).expect("held");
                    let [angle, rate, torque] = seen(&mut run);
                    // What the spring and the weight ask of the lock, about y.
                    let want = 2.0 * 9.81 * 0.5 * held.sin() + held;
                    assert!(
                        (angle - held).abs() < 1e-9 && rate.abs() < 1e-9,
                        "{word}: {angle}"
                    );
                    assert!((torque - want).abs() < 1e-7, "{word}: {torque} {want}");
                    if run.time() < 1.0 {
                        run.run(1.5).expect("free");
                        let mut other = Simulation::new(&free, options).expect("options that fit");
                        other.run(0.5).expect("free from the start");
                        let mut want = [0.0; 3];
                        other
                            .evaluate(Quantity::Outputs, &mut want)
                            .expect("outputs");
                        let [angle, rate, _] = seen(&mut run);
                        let off = (angle - want[0]).abs().max((rate - want[1]).abs());
                        assert!(off < 1e-6, "{word}: {angle} {rate} {want:?}");
                    }
                }
            }
        }
    }
    agrees(&absolute);
    agrees(&relative);
}

#[test]
fn a_loop_whose_crank_is_locked_at_the_start_stands_and_then_moves() {
    for family in ["absolute", "relative"] {
        let scene = read(&format!(
            "model Press {{
                coordinates: {family};
                gravity: [0.0, -9.81, 0.0] m/s^2;
                world {{ frame far at [2, 0, 0] m }}
                body crank {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.5, 0, 0] m, frame tip at [0.5, 0, 0] m }}
                body coupler {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1, 0, 0] m, frame tip at [1, 0, 0] m }}
                body rocker {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1, 0, 0] m, frame tip at [1, 0, 0] m }}
                joint motor: cylindrical from world to crank.root {{ axis: z, angle: {{ start: 90 deg, at_start: locked }} }}
                joint knee: hinge from crank.tip to coupler.root {{ axis: z }}
                joint hip: hinge from world.far to rocker.root {{ axis: z, start: about 60 deg }}
                joint close: spherical from coupler.tip to rocker.tip;
                event let_go = time rises 0.5 s {{ free: motor.angle }}
                output turned = motor.angle;
                output total = energy.kinetic + energy.potential;
            }}"
        ));
        let again = read_toml(&write_toml(&scene)).scene.expect("written by us");
        assert_eq!(again, scene);
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::vern7(1e-10)).expect("options");
        let mut out = [0.0; 2];
        run.run(0.4).expect("it stands");
        run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
        let [angle, energy] = out;
        assert!((angle - 90f64.to_radians()).abs() < 1e-9, "{angle}");
        run.run(1.0).expect("it falls");
        run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
        assert!((out[0] - angle).abs() > 0.1, "{out:?}");
        assert!((out[1] - energy).abs() < 1e-6, "{out:?} {energy}");
    }
}

#[test]
fn a_trim_keeps_what_is_locked_at_the_start_and_finds_the_rest_of_what_hangs_on_it() {
    for family in ["absolute", "relative"] {
        let scene = read(&format!(
            "model Double {{
                coordinates: {family};
                gravity: [0.0, 0.0, -9.81] m/s^2;
                body arm {{ mass: 2 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, frame top at [0, 0, 0.5] m, frame tip at [0, 0, -0.5] m }}
                body bob {{ mass: 2 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, frame top at [0, 0, 0.5] m }}
                joint pin: hinge from world to arm.top {{ axis: y, start: 30 deg, at_start: locked }}
                joint elbow: hinge from arm.tip to bob.top {{ axis: y, start: 10 deg }}
                event let_go = time rises 1 s {{ free: pin }}
            }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let rest = trim(&model).solve().expect("a rest");
        // The bob hangs straight down and swings about the tip: ω² = m g l / (J + m l²).
        let elbow = rest.value("elbow.angle").expect("free");
        assert!(
            (elbow + 30f64.to_radians()).abs() < 1e-9,
            "{family}: {elbow}"
        );
        let want = (2.0 * 9.81 * 0.5f64 / (0.2 + 2.0 * 0.25)).sqrt();
        let modes = rest.space.vibrations();
        assert_eq!(modes.len(), 1, "{family}");
        assert!((modes[0].frequency() - want).abs() < 1e-8, "{family}");
    }
}

#[test]
fn what_cannot_be_locked_at_the_start_is_told_at_its_place() {
    let joint = |fields: &str| {
        format!(
            "model A {{ gravity: none; body b {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }} joint pin: {fields} event go = time rises 1 s {{ free: pin }} }}"
        )
    };
    for (fields, said) in [
        (
            "spherical from world to b.com { at_start: locked }",
            "no coordinate that could be locked",
        ),
        (
            "hinge from world to b.com { motor: 1 rad/s * time, at_start: locked }",
            "a motor drives",
        ),
        (
            "hinge from world to b.com { at_start: lokced }",
            "did you mean `locked`",
        ),
        (
            "cylindrical from world to b.com { angle: { at_start: detached } }",
            "locked",
        ),
        (
            "hinge from world to b.com { axis: y }",
            "`at_start: locked`",
        ),
        (
            "hinge from world to b.com { at_start: locked, start_rate: 1 rad/s }",
            "what is locked has no rate",
        ),
    ] {
        let reading = read_text(&joint(fields));
        let told: Vec<String> = reading.errors.iter().map(|it| it.text.clone()).collect();
        assert!(told.join("\n").contains(said), "{fields}: {told:?}");
    }
    // A rate that a run is given of what is locked contradicts the lock.
    let scene = read(&joint("hinge from world to b.com { at_start: locked }"));
    let model = Generic::<f64>::with_defaults(scene).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
    let error = run
        .set_joints(&[("pin.angle_rate", 1.0)])
        .expect_err("a contradiction");
    assert!(
        error.to_string().contains("`pin.angle.lock` comes apart"),
        "{error}"
    );
}

/// A Geneva drive: the pin of a driver at constant speed turns a star by a quarter while it is in its slot; the star is locked while it is out.
fn geneva(family: &str, enters: &str) -> Simulation<f64> {
    let text = format!(
        "model Geneva {{ coordinates: {family}; gravity: none; planar: xz;
           world {{ frame axle at [0.1 * sqrt(2), 0, 0] m }}
           body driver {{ mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2, frame pin at [0.1, 0, 0] m }}
           body star {{ mass: 0.5 kg, inertia: diag(0.002, 0.002, 0.002) kg*m^2, frame slot at [0, 0, 0] m rotated about(y, -135 deg) }}
           joint drive: hinge from world to driver.com {{ axis: y, motor: 1 rad/s * time - 60 deg }}
           joint wheel: hinge from world.axle to star.com {{ axis: y, at_start: locked }}
           joint engage: point_on_line from star.slot to driver.pin {{ axis: x, at_start: detached }}
           event enters = drive.angle rises -45 deg {{ {enters} }}
           event leaves = drive.angle rises 45 deg {{ detach: engage, lock: wheel }}
           output turned = wheel.angle;
           output turns = wheel.angle_rate; }}"
    );
    let model = Generic::with_defaults(read(&text)).expect("defaults");
    Simulation::new(&model, Options::tsit5(1e-9)).expect("a start")
}

#[test]
fn a_motor_drives_what_only_a_lock_and_a_joint_together_would_hold() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_4, SQRT_2};
    for family in ["absolute", "relative"] {
        let mut run = geneva(family, "free: wheel, attach: engage");
        let output =
            |run: &mut Simulation<f64>, name: &str| run.output(name).expect("it is declared");
        run.run(0.2).expect("the pin is out");
        assert_eq!(output(&mut run, "turned"), 0.0);
        // The pin is nearest to the axle of the star: a / (c - a) times the speed of the driver.
        run.run(FRAC_PI_3).expect("the pin is in the slot");
        assert!((output(&mut run, "turned") + FRAC_PI_4).abs() < 1e-9);
        assert!((output(&mut run, "turns").abs() - 1.0 / (SQRT_2 - 1.0)).abs() < 1e-8);
        run.run(2.0).expect("the pin is out again");
        assert!((output(&mut run, "turned") + FRAC_PI_2).abs() < 1e-9);
        assert!(output(&mut run, "turns").abs() < 1e-9);
    }
}

#[test]
fn a_motor_whose_coordinate_is_held_in_a_run_ends_it() {
    for family in ["absolute", "relative"] {
        let mut run = geneva(family, "attach: engage");
        let error = run.run(2.0).expect_err("the star stays locked");
        let told = error.to_string();
        assert!(told.contains("`engage`, `wheel.angle.lock`"), "{told}");
    }
}
