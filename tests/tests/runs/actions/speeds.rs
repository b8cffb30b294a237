//! Speeds that events set: by an impulse along them, which joints hand on.

use mbd_runtime::{Generic, Method, Options, Simulation, StepError, Stop, model};
use mbd_scene::Coordinates;
use tests::declared::read;

use super::{G, methods, methods_in};

fn generic(text: &str) -> Generic<f64> {
    Generic::with_defaults(read(text)).expect("defaults")
}

fn scene(coordinates: Coordinates, items: &str) -> Generic<f64> {
    let family = match coordinates {
        Coordinates::Relative => "relative",
        _ => "absolute",
    };
    generic(&format!("model M {{ coordinates: {family}; {items} }}"))
}

const FAMILIES: [Coordinates; 2] = [Coordinates::Absolute, Coordinates::Relative];

fn outputs<const N: usize>(run: &mut Simulation<f64>, names: [&str; N]) -> [f64; N] {
    names.map(|name| run.output(name).expect("an output"))
}

fn assert_near(found: &[f64], expected: &[f64], bound: f64, what: &str) {
    assert_eq!(found.len(), expected.len());
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    let off = off.fold(0.0, f64::max);
    assert!(off < bound, "{what}: {found:?} {expected:?}");
}

model! {
    /// A ball that loses a part of its speed at each bounce.
    model Ball {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param e = 0.8 in 0 ..= 1;
        point ball { mass: 2 kg, start at [0.0, 0.0, 1.0] m velocity [0.5, 0.0, 0.0] m/s }
        event hit = ball.position.z falls 0 m { set: ball.vz = -e * ball.vz }
    }
}

#[test]
fn a_ball_bounces_as_often_and_as_high_as_its_restitution_says() {
    let ball = Ball::new(BallParams::default()).expect("defaults");
    let fall = f64::sqrt(2.0 / G);
    for options in methods() {
        let mut run = Simulation::new(&ball, options).expect("options");
        run.run(2.5).expect("it bounces");
        let mut time = fall;
        let mut speed = G * fall;
        for acted in run.actions() {
            assert_near(&[acted.time], &[time], 1e-9, "the bounce");
            let work = acted.work().expect("an energy");
            assert_near(
                &[work],
                &[-(1.0 - 0.64) * speed * speed],
                1e-8,
                "what the bounce takes",
            );
            speed *= 0.8;
            time += 2.0 * speed / G;
        }
        assert_eq!(run.actions().len(), 4, "{:?}", options.method);
        // Nothing along the ground.
        assert_near(&[run.state()[3], run.state()[0]], &[0.5, 1.25], 1e-9, "x");
        let above = run.state()[2];
        let since = 2.5 - run.actions()[3].time;
        assert_near(
            &[above],
            &[speed * since - 0.5 * G * since * since],
            1e-8,
            "z",
        );
    }
    // Compiled and not, to the bit.
    let generic = Generic::with_defaults(<Ball as mbd_runtime::Model<f64>>::scene(&ball).clone());
    let generic = generic.expect("defaults");
    let [one, other] = [
        Simulation::new(&ball, Options::rk4(1e-3)),
        Simulation::new(&generic, Options::rk4(1e-3)),
    ]
    .map(|run| {
        let mut run = run.expect("options");
        run.run(2.0).expect("it bounces");
        run.state().to_vec()
    });
    assert_eq!(one, other);
}

#[test]
fn bounces_without_end_are_told() {
    let ball = Ball::new(BallParams { e: 0.5 }).expect("a restitution");
    let mut run = Simulation::new(&ball, Options::tsit5(1e-9)).expect("options");
    let error = run.run(5.0).expect_err("it comes to rest");
    assert!(
        matches!(error.cause, StepError::EventChatter { .. }),
        "{error}"
    );
    // The last bounce: v₀ (1 + 2 e/(1 − e))/g.
    assert!(
        (run.time() - 3.0 * f64::sqrt(2.0 / G)).abs() < 1e-6,
        "{error}"
    );
}

#[test]
fn a_free_rod_struck_at_its_tip_turns_about_its_centre_of_percussion() {
    for coordinates in FAMILIES {
        let model = scene(
            coordinates,
            "gravity: none; body rod { mass: 3 kg, inertia: diag(0.4, 0.4, 0.1) kg*m^2, frame tip at [0, 0, 0.7] m }
             joint loose: free from world to rod.com
             event struck = time rises 0.5 s { set: rod.tip.velocity.x = 2 m/s }
             output v = rod.velocity; output w = rod.omega_world; output u = rod.tip.velocity;",
        );
        for options in methods_in(coordinates) {
            let mut run = Simulation::new(&model, options).expect("options");
            run.run(0.5).expect("a run");
            // 1/m' = 1/m + a²/I.
            let impulse = 2.0 / (1.0 / 3.0 + 0.49 / 0.4);
            let found = outputs(&mut run, ["v.x", "v.y", "v.z", "w.x", "w.y", "w.z", "u.x"]);
            let expected = [impulse / 3.0, 0.0, 0.0, 0.0, 0.7 * impulse / 0.4, 0.0, 2.0];
            assert_near(&found, &expected, 1e-12, "the rod");
        }
    }
}

#[test]
fn an_impulse_along_a_joint_changes_no_angular_momentum_about_the_pin_that_carries_both_links() {
    let rod = "mass: 2 kg, inertia: diag(0.3, 0.2, 0.1) kg*m^2, frame top at [0, 0, 0.5] m, frame tip at [0, 0, -0.5] m";
    let items = format!(
        "gravity: [0, 0, -9.81] m/s^2; body upper {{ {rod} }} body lower {{ {rod} }}
         joint pin: hinge from world to upper.top {{ axis: y, start: 40 deg }}
         joint elbow: hinge from upper.tip to lower.top {{ axis: y, start: -70 deg }}
         event kick = time rises 0.3 s {{ set: elbow.angle_rate = -3 rad/s - elbow.angle_rate }}
         let up = cross(upper.position, upper.velocity * 2 kg) + upper.omega_world * 0.2 kg*m^2;
         let low = cross(lower.position, lower.velocity * 2 kg) + lower.omega_world * 0.2 kg*m^2;
         output spin = up + low; output bend = elbow.angle_rate; output swing = pin.angle_rate;"
    );
    let mut all = Vec::new();
    for coordinates in FAMILIES {
        let model = scene(coordinates, &items);
        let mut before = Simulation::new(&model, Options::vern7(1e-12)).expect("options");
        before.run(0.3 - 1e-9).expect("a run");
        let [spin, bend, swing] = outputs(&mut before, ["spin.y", "bend", "swing"]);
        let mut run = Simulation::new(&model, Options::vern7(1e-12)).expect("options");
        run.run(0.3).expect("a run");
        let after = outputs(&mut run, ["spin.y", "bend", "swing"]);
        assert_near(&after[..2], &[spin, -3.0 - bend], 1e-6, "the kick");
        assert!((after[2] - swing).abs() > 0.1);
        run.run(0.8).expect("a run");
        all.push(outputs(&mut run, ["spin.y", "bend", "swing"]));
    }
    assert_near(&all[0], &all[1], 1e-8, "both families");
}

#[test]
fn the_speeds_of_a_loop_follow_the_one_that_is_set() {
    let link = |length: f64| {
        format!(
            "mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-{0}, 0, 0] m, frame b at [{0}, 0, 0] m",
            0.5 * length
        )
    };
    let items = format!(
        "gravity: none; world {{ frame ground at [3, 0, 0] m }}
         body crank {{ {} }} body coupler {{ {} }} body rocker {{ {} }}
         joint pin: hinge from world to crank.a {{ axis: y, start: -50 deg, start_rate: 1 rad/s }}
         joint knee: hinge from crank.b to coupler.a {{ axis: y }}
         joint end: hinge from coupler.b to rocker.a {{ axis: y, start: about 60 deg }}
         joint other: hinge from world.ground to rocker.b {{ axis: y }}
         event faster = time rises 0.2 s {{ set: pin.angle_rate = 3 * pin.angle_rate }}
         output one = pin.angle_rate; output two = knee.angle_rate; output three = other.angle_rate; output e = energy.kinetic;",
        link(1.0),
        link(2.5),
        link(2.0)
    );
    for coordinates in FAMILIES {
        let model = scene(coordinates, &items);
        let mut before = Simulation::new(&model, Options::vern7(1e-12)).expect("options");
        before.run(0.2 - 1e-10).expect("a run");
        let [one, two, three, energy] = outputs(&mut before, ["one", "two", "three", "e"]);
        let mut run = Simulation::new(&model, Options::vern7(1e-12)).expect("options");
        run.run(0.2).expect("a run");
        let found = outputs(&mut run, ["one", "two", "three", "e"]);
        let expected = [3.0 * one, 3.0 * two, 3.0 * three, 9.0 * energy];
        assert_near(&found, &expected, 1e-6, "the loop");
        let work = run.actions()[0].work().expect("an energy");
        assert_near(&[work], &[8.0 * energy], 1e-6, "the work");
    }
}

#[test]
fn two_balls_exchange_their_speeds_when_they_meet() {
    let model = generic(
        "model Billiard { gravity: none;
            point a { mass: 1 kg, start at [0, 0, 0] m velocity [2, 1, 0] m/s }
            point b { mass: 3 kg, start at [1, 0.5, 0] m velocity [0, 0, 0] m/s }
            let u = (a.velocity * 1 kg + b.velocity * 3 kg) / (4 kg);
            event met = norm(b.position - a.position) falls 0.1 m { set: [a.velocity = 2 * u - a.velocity, b.velocity = 2 * u - b.velocity] } }",
    );
    for options in methods() {
        let mut run = Simulation::new(&model, options).expect("options");
        run.run(1.0).expect("a run");
        assert_near(
            &run.state()[6..],
            &[-1.0, -0.5, 0.0, 1.0, 0.5, 0.0],
            1e-12,
            "head on",
        );
        assert_near(
            &[run.actions()[0].work().expect("an energy")],
            &[0.0],
            1e-12,
            "elastic",
        );
    }
}

#[test]
fn angular_velocities_are_set_in_their_axes() {
    for coordinates in FAMILIES {
        let model = scene(
            coordinates,
            "gravity: none; body top { mass: 1 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2 }
             joint ball: spherical from world to top.com
             event first = time rises 0.1 s { set: top.omega_body = [1, 2, 3] rad/s }
             event then_one = time rises 0.2 s { set: top.omega_world.z = 0 rad/s }
             output b = top.omega_body; output w = top.omega_world;",
        );
        let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options");
        run.run(0.1).expect("a run");
        assert_near(
            &outputs(&mut run, ["b.x", "b.y", "b.z"]),
            &[1.0, 2.0, 3.0],
            1e-12,
            "body",
        );
        run.run(0.2).expect("a run");
        assert_near(&outputs(&mut run, ["w.z"]), &[0.0], 1e-12, "world");
    }
}

#[test]
fn a_velocity_of_which_a_rail_leaves_one_component_is_set_as_a_whole() {
    for coordinates in FAMILIES {
        let model = scene(
            coordinates,
            "gravity: none; world { frame rail at [0.1, 0.2, 0.3] m rotated rpy(31 deg, -17 deg, 80 deg) }
             body cart { mass: 2 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame side at [0.3, -0.2, 0.1] m }
             body arm { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
             joint guide: prismatic from world.rail to cart.side { axis: y, start_rate: 2 m/s }
             joint weld: rigid from cart.side to arm.com
             event hit = time rises 0.5 s { set: arm.velocity = -0.5 * arm.velocity }
             output rate = guide.slide_rate;",
        );
        let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options");
        run.run(1.0).expect("it bounces back");
        assert_near(&outputs(&mut run, ["rate"]), &[-1.0], 1e-12, "the rail");
    }
}

#[test]
fn a_speed_that_something_holds_is_refused_by_name_and_the_run_stays() {
    for coordinates in FAMILIES {
        let model = scene(
            coordinates,
            "gravity: none; param wish = 1 rad/s;
             body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 0.5] m }
             joint pin: hinge from world to rod.top { axis: y, at_start: locked }
             event held = time rises 0.5 s { set: pin.angle_rate = wish }",
        );
        let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
        let error = run.run(1.0).expect_err("it is locked");
        let text = error.to_string();
        assert!(matches!(error.cause, StepError::Action { .. }), "{text}");
        assert!(
            text.contains("`held`") && text.contains("`pin.angle_rate` to 1 rad/s"),
            "{text}"
        );
        assert!((run.time() - 0.5).abs() < 1e-12);
        // What it is anyway is no contradiction.
        run.set_params(&[0.0][..].to_vec()).expect("params");
        assert_eq!(run.run(1.0).expect("it stands"), Stop::Reached);
    }
}

#[test]
fn single_precision_bounces_too() {
    let scene = read(
        "model M { gravity: [0, 0, -9.81] m/s^2;
            body box { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
            joint rail: prismatic from world to box.com { axis: z, start: 1 m }
            event hit = rail.slide falls 0 m { set: rail.slide_rate = -rail.slide_rate } }",
    );
    let model = Generic::<f32>::with_defaults(scene).expect("defaults");
    let options = Options {
        method: Method::Rk4 { step: 1e-3 },
        ..Options::rk4(1e-3)
    };
    let mut run = Simulation::new(&model, options).expect("options");
    let period = 2.0 * f64::sqrt(2.0 / G);
    run.run(5.0 * period).expect("it bounces");
    assert_eq!(run.actions().len(), 5);
    assert!((run.state()[2] - 1.0).abs() < 1e-3, "{:?}", run.state());
}
