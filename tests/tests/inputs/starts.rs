//! Starts in joint coordinates: bodies stand where closed forms say, loops are closed by what nobody gave, and what is decided twice is told.

use mbd_compiler::read_text;
use mbd_runtime::{Generic, Model, Options, Quantity, Simulation, StartNumber};
use mbd_scene::{JointStart, Layout, Part, PlacementError, Scene, StartFrom, place};
use tests::assert_close;

fn read(text: &str) -> Scene {
    let reading = read_text(text);
    assert!(reading.errors.is_empty(), "{:?}", reading.errors);
    reading.scene.expect("a scene")
}

fn upright(layout: &Layout) -> Vec<f64> {
    let mut state = vec![0.0; layout.nx()];
    layout.quaternions().for_each(|qw| state[qw] = 1.0);
    state
}

/// Coordinate and rate of a joint by name.
fn start(scene: &Scene, joint: &str, value: f64, rate: f64) -> JointStart {
    let joint = scene.joints.iter().position(|known| known.name == joint);
    JointStart {
        joint: joint.expect("a joint"),
        coordinate: 0,
        value: Some(value),
        rate: Some(rate),
        about: false,
    }
}

fn placed(scene: &Scene, given: &[JointStart], fixed: &[Part]) -> Result<Vec<f64>, PlacementError> {
    let layout = Layout::new(scene);
    let mut state = upright(&layout);
    let params: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    place(
        scene,
        &layout,
        StartFrom::new(&params, 0.0),
        given,
        fixed,
        &mut state,
    )
    .map(|_| state)
}

/// The start of a run from a state: how far it was moved, and coordinate and rate of every joint as formulas see them.
fn run(scene: &Scene, state: &[f64]) -> (f64, Vec<f64>) {
    let model = Generic::with_defaults(scene.clone()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    run.set_state(0.0, state).expect("a state");
    run.start().expect("a start");
    let moved = run.start_moved();
    let largest = moved.iter().fold(0.0, |most: f64, moved| {
        most.max(moved.distance + moved.angle + moved.velocity + moved.angular_velocity)
    });
    let columns = Model::<f64>::layout(&model).columns;
    let mut outputs = vec![0.0; columns];
    run.evaluate(mbd_runtime::Quantity::Outputs, &mut outputs)
        .expect("outputs");
    (largest, outputs)
}

const PENDULUM: &str = "model Double { gravity: [0.0, 0.0, -9.81] m/s^2; COMPONENTS
    body upper { mass: 1 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2, frame top at [0, 0, 1] m, frame end at [0, 0, -1] m }
    body lower { mass: 1 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2, frame top at [0, 0, 0.5] m }
    joint elbow: hinge from upper.end to lower.top { axis: y }
    joint shoulder: hinge from world to upper.top { axis: y }
    output shoulder_angle = shoulder.angle;
    output shoulder_rate = shoulder.angle_rate;
    output elbow_angle = elbow.angle;
    output elbow_rate = elbow.angle_rate;
}";

#[test]
fn a_double_pendulum_starts_at_its_angles_and_rates() {
    for components in [
        "angular_velocity: body;",
        "angular_velocity: world;",
        "planar: xz;",
    ] {
        let scene = read(&PENDULUM.replace("COMPONENTS", components));
        // About y from z to x: the rod hangs along −z, so a positive angle swings its end to −x.
        let (a, b, da, db) = (0.5136, -0.3, 0.7, -1.1);
        let given = [
            start(&scene, "elbow", b, db),
            start(&scene, "shoulder", a, da),
        ];
        let state = placed(&scene, &given, &[]).expect("a tree");
        let layout = Layout::new(&scene);
        let linear = |at: usize| layout.directions.linear(&state, at);
        let [upper, lower] = [0, 1].map(|body| layout.bodies[body].expect("slots"));
        let x = |angle: f64| -angle.sin();
        let z = |angle: f64| -angle.cos();
        assert_close(
            linear(upper.q).as_slice(),
            &[x(a), 0.0, z(a)],
            1e-15,
            1e-15,
            "upper",
        );
        let below = [
            2.0 * x(a) + 0.5 * x(a + b),
            0.0,
            2.0 * z(a) + 0.5 * z(a + b),
        ];
        assert_close(linear(lower.q).as_slice(), &below, 1e-15, 1e-15, "lower");
        let speed = [
            2.0 * da * z(a) + 0.5 * (da + db) * z(a + b),
            0.0,
            -2.0 * da * x(a) - 0.5 * (da + db) * x(a + b),
        ];
        assert_close(
            linear(layout.nq + lower.v).as_slice(),
            &speed,
            1e-14,
            1e-14,
            "speed",
        );
        let (moved, outputs) = run(&scene, &state);
        assert!(moved < 1e-14, "{components}: moved by {moved}");
        assert_close(&outputs, &[a, da, b, db], 1e-14, 1e-14, components);
    }
}

const FOUR_BAR: &str = "model FourBar { gravity: [0.0, -9.81, 0.0] m/s^2;
    world { frame pivot at [4, 0, 0] m }
    body crank { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.5, 0, 0] m, frame tip at [0.5, 0, 0] m }
    body coupler { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-2, 0, 0] m, frame tip at [2, 0, 0] m }
    body rocker { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1.5, 0, 0] m, frame tip at [1.5, 0, 0] m }
    joint base: hinge from world to crank.root { axis: z }
    joint elbow: hinge from crank.tip to coupler.root { axis: z }
    joint wrist: spherical from coupler.tip to rocker.tip;
    joint hip: hinge from world.pivot to rocker.root { axis: z }
    output crank_angle = base.angle;
    output crank_rate = base.angle_rate;
    output rocker_angle = hip.angle;
    output rocker_rate = hip.angle_rate;
}";

#[test]
fn a_four_bar_is_closed_around_the_angle_of_its_crank() {
    let scene = read(FOUR_BAR);
    let mut last: Option<(f64, f64)> = None;
    for angle in [0.6, 0.6 + 1e-6] {
        let state = placed(&scene, &[start(&scene, "base", angle, 1.0)], &[]).expect("it closes");
        let (moved, outputs) = run(&scene, &state);
        assert!(moved < 1e-9, "moved by {moved}");
        assert_close(&outputs[..2], &[angle, 1.0], 1e-11, 1e-9, "crank");
        // Freudenstein: the tips of crank and rocker are a coupler apart.
        let tip = [angle.cos(), angle.sin()];
        let end = [4.0 + 3.0 * outputs[2].cos(), 3.0 * outputs[2].sin()];
        let apart = (end[0] - tip[0]).hypot(end[1] - tip[1]);
        assert!((apart - 4.0).abs() < 1e-10, "{apart}");
        if let Some((before, rate)) = last {
            let slope = (outputs[2] - before) / 1e-6;
            assert!((slope - rate).abs() < 1e-4, "{slope} {rate}");
        }
        last = Some((outputs[2], outputs[3]));
    }
}

#[test]
fn what_is_decided_twice_is_told_and_so_is_a_loop_that_cannot_close() {
    let scene = read(FOUR_BAR);
    let all = ["base", "elbow", "hip"].map(|joint| start(&scene, joint, 0.3, 0.0));
    let open = placed(&scene, &all, &[]).expect_err("three angles of one freedom");
    assert!(
        matches!(open, PlacementError::Open { gap, unit: "m", .. } if gap > 1e-3),
        "{open:?}"
    );
    let fixed = placed(&scene, &all[..1], &[Part::Body(0)]).expect_err("the crank is placed");
    assert_eq!(fixed, PlacementError::Decided { joint: 0 });
    // The rocker swings within 2.0 rad … 3.9 rad of its links: it cannot lie along the ground towards the crank's far side.
    let far = placed(&scene, &[start(&scene, "hip", 0.0, 0.0)], &[]).expect_err("out of reach");
    assert!(matches!(far, PlacementError::Open { .. }), "{far:?}");
}

#[test]
fn a_slider_on_a_base_that_moves_starts_with_the_velocity_of_both() {
    let scene = read(
        "model Cart { gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame base at [2 m/s * time, 0 m, 1 m] }
        body cart { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
        body pole { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame foot at [0, 0, -1] m }
        joint rail: prismatic from world.base to cart.com { axis: y }
        joint pin: hinge from cart.com to pole.foot { axis: x }
        output way = rail.slide;
        output rate = rail.slide_rate;
        output lean = pin.angle;
        }",
    );
    let given = [
        start(&scene, "rail", 0.4, -0.3),
        start(&scene, "pin", 0.1, 0.0),
    ];
    let state = placed(&scene, &given, &[]).expect("a tree");
    let layout = Layout::new(&scene);
    let at = |slot: usize| layout.directions.linear(&state, slot);
    let [cart, pole] = [0, 1].map(|body| layout.bodies[body].expect("slots"));
    assert_close(
        at(cart.q).as_slice(),
        &[0.0, 0.4, 1.0],
        1e-15,
        1e-15,
        "cart",
    );
    assert_close(
        at(layout.nq + pole.v).as_slice(),
        &[2.0, -0.3, 0.0],
        1e-15,
        1e-15,
        "pole",
    );
    let (moved, outputs) = run(&scene, &state);
    assert!(moved < 1e-14, "{moved}");
    assert_close(&outputs, &[0.4, -0.3, 0.1], 1e-14, 1e-14, "coordinates");
}

#[test]
fn a_start_at_one_end_of_a_train_of_gears_places_the_others() {
    let scene = read(
        "model Train { gravity: none;
        body rotor { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        body wheel { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        body rack { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        joint teeth: gear from motor.angle to axle.angle { ratio: -2, offset: 10 deg }
        joint motor: hinge from world to rotor.com { axis: y }
        joint axle: hinge from world to wheel.com { axis: y }
        joint rail: prismatic from world to rack.com { axis: x }
        joint pinion: gear from axle.angle to rail.slide { ratio: 50 mm }
        output wheel_angle = axle.angle;
        output wheel_rate = axle.angle_rate;
        output way = rail.slide;
        output speed = rail.slide_rate;
        }",
    );
    let given = [start(&scene, "motor", 0.4, 3.0)];
    let state = placed(&scene, &given, &[]).expect("a train");
    let (moved, outputs) = run(&scene, &state);
    let angle = -0.8 + 10f64.to_radians();
    let want = [angle, -6.0, 0.05 * angle, -0.3];
    assert_close(&outputs, &want, 1e-9, 1e-10, "wheel and rack");
    assert!(moved < 1e-9, "{moved:e}");
}

#[test]
fn a_simulation_is_placed_by_the_names_of_joint_coordinates() {
    let scene = read(&PENDULUM.replace("COMPONENTS", ""));
    let model = Generic::<f64>::with_defaults(scene.clone()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    run.set_joints(&[
        ("shoulder.angle", 0.4),
        ("elbow.angle", -0.9),
        ("elbow.angle_rate", 2.0),
    ])
    .expect("a tree");
    run.start().expect("a start");
    let mut outputs = vec![0.0; 4];
    run.evaluate(mbd_runtime::Quantity::Outputs, &mut outputs)
        .expect("outputs");
    assert_close(
        &outputs,
        &[0.4, 0.0, -0.9, 2.0],
        1e-14,
        1e-14,
        "coordinates",
    );
    let before = run.state().to_vec();
    for (given, said) in [
        ([("elbow.angel", 0.1)], "elbow.angle"),
        ([("elbow.angle", f64::NAN)], "elbow.angle"),
    ] {
        let error = run.set_joints(&given).expect_err("refused").to_string();
        assert!(error.contains(said), "{error}");
    }
    assert_eq!(run.state(), before, "what is refused changes nothing");
    let single = Generic::<f32>::with_defaults(scene).expect("defaults");
    let mut run = Simulation::new(&single, Options::rk4(1e-2)).expect("options");
    run.set_joints(&[("shoulder.angle", 0.4)]).expect("a tree");
    run.run(0.1).expect("a run in f32");
}

#[test]
fn a_crank_that_starts_turned_around_brings_its_slider_the_right_way_up() {
    let scene = tests::declared::read(
        "model Press {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            planar: xz;
            body flywheel { mass: 300 kg, inertia: diag(20, 40, 20) kg*m^2, frame pin at [0, 0, -80 mm] }
            body conrod { mass: 12 kg, inertia: diag(0.2, 0.2, 0.01) kg*m^2, frame big at [0, 0, 200 mm], frame small at [0, 0, -200 mm] }
            body ram { mass: 90 kg, inertia: diag(2, 2, 2) kg*m^2 }
            joint crank: hinge from world to flywheel.com { axis: y, start: 180 deg, start_rate: 7 rad/s }
            joint big: hinge from flywheel.pin to conrod.big { axis: y }
            joint small: hinge from conrod.small to ram.com { axis: y }
            loop joint slide: prismatic from world to ram.com { axis: z }
            output angle_of_crank = crank.angle;
            output height = ram.position.z;
            output upright = ram.z.z;
        }",
    );
    let (_, out) = begin(scene, &[]).expect("it can stand so");
    let [crank, height, upright] = out[..] else {
        panic!("three outputs")
    };
    assert!((crank.abs() - std::f64::consts::PI).abs() < 1e-9, "{out:?}");
    assert!((upright - 1.0).abs() < 1e-9, "{out:?}");
    // The rod hangs below its crank pin or stands on it: both hold.
    let ends = [0.08 - 0.4, 0.08 + 0.4];
    assert!(
        ends.iter().any(|end| (height - end).abs() < 1e-9),
        "{out:?}"
    );
}

/// The four-bar with what its joints say of their starts; bars of 1, 2, 2 m, pivots 2 m apart.
fn said(family: &str, [motor, knee, hip, close]: [&str; 4]) -> Scene {
    tests::declared::read(&format!(
        "model Said {{
            coordinates: {family};
            gravity: none;
            world {{ frame far at [2, 0, 0] m }}
            body crank {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.5, 0, 0] m, frame tip at [0.5, 0, 0] m }}
            body coupler {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1, 0, 0] m, frame tip at [1, 0, 0] m }}
            body rocker {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1, 0, 0] m, frame tip at [1, 0, 0] m }}
            joint motor: hinge from world to crank.root {{ axis: z{motor} }}
            joint knee: hinge from crank.tip to coupler.root {{ axis: z{knee} }}
            joint hip: hinge from world.far to rocker.root {{ axis: z{hip} }}
            joint close: hinge from coupler.tip to rocker.tip {{ axis: z{close} }}
            output motor_angle = motor.angle;
            output motor_rate = motor.angle_rate;
            output hip_angle = hip.angle;
            output hip_rate = hip.angle_rate;
        }}"
    ))
}

/// A run of a scene that has begun, and its outputs there.
fn begin(scene: Scene, set: &[(&str, f64)]) -> Result<(Simulation<f64>, Vec<f64>), String> {
    let count = scene.outputs.iter().map(|output| output.components).sum();
    let model = Generic::<f64>::with_defaults(scene).map_err(|error| error.to_string())?;
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).map_err(|error| error.to_string())?;
    run.set_joints(set).map_err(|error| error.to_string())?;
    run.start().map_err(|error| error.to_string())?;
    let mut out = vec![0.0; count];
    run.evaluate(Quantity::Outputs, &mut out)
        .map_err(|error| error.to_string())?;
    Ok((run, out))
}

/// Outputs where a run begins, what became of the starts that are about a value, and what nothing decides.
type Begun = (Vec<f64>, Vec<(String, f64, f64)>, Vec<String>);

/// Where a run of a scene begins.
fn begun(scene: Scene) -> Result<Begun, String> {
    let (run, out) = begin(scene, &[])?;
    assert!(run.start_moved().iter().all(|moved| moved.distance < 1e-9));
    Ok((out, run.started_about(), run.start_undecided()))
}

/// The angle of the rocker, by its sign of the two at which circles of 2 m about the crank's tip and the far pivot cross.
fn rocker(crank: f64, side: f64) -> f64 {
    let (sin, cos) = crank.sin_cos();
    let (dx, dy) = (2.0 - cos, -sin);
    let apart = dx.hypot(dy);
    let height = side * (4.0 - 0.25 * apart * apart).sqrt() / apart;
    let tip = [cos + 0.5 * dx - height * dy, sin + 0.5 * dy + height * dx];
    tip[1].atan2(tip[0] - 2.0)
}

#[test]
fn a_start_about_a_value_is_the_nearest_with_which_the_loop_closes() {
    for family in ["absolute", "relative"] {
        // The crank to the digit: the rocker on the branch that it is said to be about.
        for (near, side) in [("60 deg", 1.0), ("-100 deg", -1.0)] {
            let hip = format!(", start: about {near}");
            let scene = said(family, [", start: 90 deg", "", &hip, ""]);
            let (out, about, undecided) = begun(scene).expect("it closes");
            let want = rocker(90f64.to_radians(), side);
            assert_close(
                &[out[0], out[2]],
                &[90f64.to_radians(), want],
                1e-10,
                0.0,
                near,
            );
            assert_eq!(about.len(), 1);
            let (name, asked, taken) = &about[0];
            assert_eq!(name, "hip.angle");
            assert!((taken - want).abs() < 1e-10 && (asked - want).abs() > 0.1);
            assert!(undecided.is_empty(), "{undecided:?}");
        }
        // Both about: the sum of the squares of what they miss is least, found here along the curve on which the loop closes.
        let scene = said(
            family,
            [", start: about 80 deg", "", ", start: about 60 deg", ""],
        );
        let (out, about, _) = begun(scene).expect("it closes");
        let [a0, b0] = [80f64, 60.0].map(f64::to_radians);
        let far = |crank: f64| (crank - a0).powi(2) + (rocker(crank, 1.0) - b0).powi(2);
        let (mut low, mut high) = (1.0, 1.5);
        for _ in 0..200 {
            let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            if far(a) < far(b) {
                high = b;
            } else {
                low = a;
            }
        }
        assert!((out[0] - low).abs() < 1e-6, "{out:?} {low}");
        assert!((out[2] - rocker(out[0], 1.0)).abs() < 1e-9 && about.len() == 2);
        // A digit that is lost, which to the digit is refused, with what to write.
        let exact = rocker(90f64.to_radians(), 1.0);
        let off = format!("{:?} rad", exact + 1e-7);
        let starts = |word: &str| {
            [
                ", start: 90 deg".to_owned(),
                format!(", start: {word}{off}"),
            ]
        };
        let [motor, hip] = starts("");
        let refused = begun(said(family, [&motor, "", &hip, ""])).expect_err("to the digit");
        assert!(
            refused.contains("`close` stays open by") && refused.contains(" m: "),
            "{refused}"
        );
        assert!(refused.contains("`about`"), "{refused}");
        let [motor, hip] = starts("about ");
        let (out, about, _) = begun(said(family, [&motor, "", &hip, ""])).expect("about");
        assert_close(&[out[2]], &[exact], 1e-10, 0.0, "the loop decides");
        assert!((about[0].2 - about[0].1 + 1e-7).abs() < 1e-9, "{about:?}");
    }
}

#[test]
fn what_is_about_a_value_and_closes_with_it_is_that_value_and_counts_its_turns() {
    for family in ["absolute", "relative"] {
        let scene = said(
            family,
            [", start: about 450 deg, start_rate: 2 rad/s", "", "", ""],
        );
        let (out, about, _) = begun(scene).expect("one freedom");
        assert_close(&out[..2], &[450f64.to_radians(), 2.0], 1e-10, 1e-10, family);
        assert_eq!(
            about,
            [("motor.angle".to_owned(), 450f64.to_radians(), about[0].2)]
        );
        assert!((about[0].2 - about[0].1).abs() < 1e-10);
        let all = [
            ", start: about 80 deg",
            ", start: about -40 deg",
            ", start: about 60 deg",
            ", start: about 30 deg",
        ];
        let (_, about, _) = begun(said(family, all)).expect("all four of them");
        assert_eq!(about.len(), 4, "the one that closes the loop counts, too");
        let gaps: f64 = about
            .iter()
            .map(|(_, said, taken)| (taken - said).powi(2))
            .sum();
        assert!(gaps.sqrt() < 0.8, "{about:?}");
    }
}

/// The rocker swings between where crank and coupler are in one line, stretched and folded: 8 + 8 cos h = 3² and 1².
#[test]
fn a_start_about_a_value_beyond_the_reach_of_its_loop_is_at_the_edge() {
    for family in ["absolute", "relative"] {
        for (asked, across) in [("60 deg", 3.0f64), ("170 deg", 1.0)] {
            let hip = format!(", start: about {asked}");
            let (out, about, _) = begun(said(family, ["", "", &hip, ""])).expect("it closes");
            let edge = (across * across / 8.0 - 1.0).acos();
            println!("{family} {asked}: {:.1e}", out[2] - edge);
            assert!((out[2] - edge).abs() < 1e-9, "{asked} {} {edge}", out[2]);
            assert!((about[0].2 - edge).abs() < 1e-9, "{about:?}");
        }
    }
}

/// The search for where two loops close may go around: what it tells, and takes for near, is the angle next to what was said.
#[test]
fn a_start_about_a_value_is_told_by_the_angle_next_to_it() {
    for family in ["absolute", "relative"] {
        let scene = tests::declared::read(&format!(
            "model Six {{
                coordinates: {family};
                gravity: none;
                world {{ frame rocks at [0.4, 0, 0] m, frame swings at [0.75, 0, 0.1] m }}
                body crank {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame a at [-0.05, 0, 0] m, frame b at [0.05, 0, 0] m }}
                body coupler {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame a at [-0.18, 0, -0.03] m, frame b at [0.18, 0, -0.03] m, frame c at [0.05, 0, 0.12] m }}
                body rocker {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame a at [-0.13, 0, 0] m, frame b at [0.13, 0, 0] m }}
                body bar {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame a at [-0.16, 0, 0] m, frame b at [0.16, 0, 0] m }}
                body swing {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame a at [-0.14, 0, 0] m, frame b at [0.14, 0, 0] m }}
                joint j1: hinge from world to crank.a {{ axis: -y, start: 40 deg }}
                joint j2: hinge from crank.b to coupler.a {{ axis: -y, start: about -10 deg }}
                joint j4: hinge from world.rocks to rocker.a {{ axis: -y, start: about 70 deg }}
                joint j3: hinge from rocker.b to coupler.b {{ axis: -y }}
                joint j5: hinge from coupler.c to bar.a {{ axis: -y, start: about 0 deg }}
                joint j6: hinge from world.swings to swing.a {{ axis: -y, start: about 110 deg }}
                joint j7: hinge from swing.b to bar.b {{ axis: -y }}
                output a = j2.angle;
                output b = j4.angle;
                output c = j5.angle;
                output d = j6.angle;
            }}"
        ));
        let (out, about, _) = begun(scene).expect("it closes");
        let taken: Vec<f64> = about.iter().map(|(.., taken)| *taken).collect();
        assert_close(&taken, &out, 1e-10, 0.0, family);
        // Circles about the pivots cross twice each: with the rocker up the second loop does not close, of the two others the nearer one counts.
        let by_hand = [-95.260677f64, 242.946981, 112.843928, 152.130898];
        assert_close(&out, &by_hand.map(f64::to_radians), 1e-7, 0.0, family);
    }
}

#[test]
fn rates_of_a_loop_that_contradict_each_other_are_told() {
    for family in ["absolute", "relative"] {
        let motor = ", start: 90 deg, start_rate: 1 rad/s";
        let (out, ..) = begun(said(family, [motor, "", "", ""])).expect("one rate");
        let rate = out[3];
        let fits = format!(", start_rate: {rate:.4} rad/s");
        begun(said(family, [motor, "", &fits, ""])).expect("to the digits that are written");
        let other = format!(", start_rate: {:.4} rad/s", rate + 0.1);
        let refused = begun(said(family, [motor, "", &other, ""])).expect_err("two rates");
        assert!(refused.contains("`close` comes apart"), "{refused}");
    }
}

/// A scene of two links that a rod ties to the world, in a plane and in both families, begun: its outputs.
fn tied(settings: &str, start: &str) -> Vec<f64> {
    let scene = read(&format!(
        "model Tied {{ gravity: none; {settings}
            world {{ frame base at [-0.109, 0, -0.013] m, frame far at [-0.363, 0, 0.079] m }}
            body upper {{ mass: 2 kg, inertia: diag(0.03, 0.03, 0.03) kg*m^2, frame top at [0.2, 0, 0.087] m, frame end at [-0.004, 0, 0.016] m }}
            body lower {{ mass: 2 kg, inertia: diag(0.03, 0.03, 0.03) kg*m^2, frame top at [-0.215, 0, -0.296] m, frame end at [0.16, 0, 0.262] m }}
            joint shoulder: hinge from world.base to upper.top {{ axis: -y, start: {start} }}
            joint elbow: hinge from upper.end to lower.top {{ axis: y, stiffness: 2 N*m/rad }}
            joint rod: distance from world.far to lower.end {{ length: 0.922 m }}
            output bend = elbow.angle; output wound = energy.potential;
            output between = angle(upper.x, lower.x);
        }}"
    ));
    begin(scene, &[]).expect("a start").1
}

/// What closes a loop may turn on the way there: a spring would be wound up by what nobody said.
#[test]
fn full_turns_of_the_search_for_a_start_wind_up_no_spring() {
    for settings in ["planar: xz;", "planar: xz; coordinates: relative;", ""] {
        for start in [
            "about -0.5 rad",
            "about 0.343 rad",
            "0.5 rad",
            "1 rad",
            "2 rad",
        ] {
            let out = tied(settings, start);
            let [bend, wound, between] = out[..] else {
                panic!("three outputs")
            };
            // The angle is that between the bodies, within half a turn, and ½ c θ² the energy of the spring.
            let what = format!("{settings} {start}");
            assert!((bend.abs() - between).abs() < 1e-9, "{what}: {out:?}");
            assert!((wound - between * between).abs() < 1e-9, "{what}: {out:?}");
        }
    }
}

/// Where nothing is said and coordinates of zero do not close a loop, it is closed by them, and which ones could be otherwise is told; a ball by its name.
/// How angular velocities are written decides nothing of it.
#[test]
fn what_nothing_decides_is_told_where_nothing_is_said_and_is_that_of_either_angular_velocity() {
    let begun = |settings: &str| {
        let scene = read(&format!(
            "model Held {{ gravity: none; {settings}
                world {{ frame base at [-0.257, 0.326, 0.224] m rotated about([-0.549, 0.941, 0.528], -35.862 deg) }}
                body one {{ mass: 2.6 kg, inertia: diag(0.037, 0.03, 0.031) kg*m^2, frame top at [0.061, -0.295, -0.078] m, frame end at [-0.048, -0.162, 0.256] m }}
                body two {{ mass: 2.4 kg, inertia: diag(0.03, 0.027, 0.046) kg*m^2, frame top at [0.224, 0.169, 0.257] m, frame end at [-0.031, 0.099, -0.026] m }}
                joint ball: spherical from world.base to one.top
                joint table: planar from one.end to two.top {{ axis: y }}
                joint rod: distance from world to two.end {{ length: 1.069 m }}
                output place = two.position;
            }}"
        ));
        let (run, out) = begin(scene, &[]).expect("a start");
        (out, run.start_undecided())
    };
    let (body, told) = begun("angular_velocity: body;");
    assert_eq!(told, ["ball", "table.x", "table.y", "table.angle"]);
    for settings in [
        "angular_velocity: world;",
        "angular_velocity: body; coordinates: relative;",
        "angular_velocity: world; coordinates: relative;",
    ] {
        let (out, told) = begun(settings);
        assert_eq!(told, ["ball", "table.x", "table.y", "table.angle"]);
        assert_close(&out, &body, 1e-9, 0.0, settings);
    }
}

#[test]
fn what_nothing_decides_in_a_loop_is_told_by_name() {
    let scene = read(
        "model FiveBar { gravity: none;
            world { frame far at [2, 0, 0] m }
            body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.5, 0, 0] m, frame tip at [0.5, 0, 0] m }
            body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.8, 0, 0] m, frame tip at [0.8, 0, 0] m }
            body c { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.8, 0, 0] m, frame tip at [0.8, 0, 0] m }
            body d { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.5, 0, 0] m, frame tip at [0.5, 0, 0] m }
            body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0.5, 0] m }
            joint left: hinge from world to a.root { axis: z, start: 100 deg }
            joint elbow: hinge from a.tip to b.root { axis: z }
            joint right: hinge from world.far to d.root { axis: z }
            joint knee: hinge from d.tip to c.root { axis: z }
            joint top: hinge from b.tip to c.tip { axis: z }
            joint hang: hinge from a.tip to bob.top { axis: z }
            output one = left.angle; output two = right.angle; output three = hang.angle; output four = elbow.angle;
        }",
    );
    let model = Generic::<f64>::new(scene, &[]).expect("a scene");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
    assert_eq!(
        run.start_undecided(),
        ["elbow.angle", "right.angle", "knee.angle"]
    );
    run.set_joints(&[("left.angle", 1.7), ("right.angle", 1.2)])
        .expect("both cranks");
    assert!(
        run.start_undecided().is_empty(),
        "{:?}",
        run.start_undecided()
    );
    let given = [
        ("left.angle", StartNumber::Exact(1.7)),
        ("right.angle", StartNumber::About(1.2)),
    ];
    run.set_joints(&given).expect("as far as they reach");
    assert_eq!(run.started_about(), [("right.angle".to_owned(), 1.2, 1.2)]);
}

/// What the outputs of a scene are where it begins, its `joints` in a family of coordinates.
fn outputs_at_start(family: &str, plane: &str, joints: &str, set: &[(&str, f64)]) -> Vec<f64> {
    let scene = tests::declared::read(&format!(
        "model Begins {{
            coordinates: {family};
            {plane}
            gravity: none;
            body a {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
            body b {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
            body c {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
            {joints}
        }}"
    ));
    begin(scene, set).expect("a start").1
}

#[test]
fn what_follows_a_gear_begins_where_the_gear_says_turns_among_them() {
    let train = |s: &str, h: &str, k: &str, [g, f]: [&str; 2]| {
        format!(
            "joint s: hinge from world to a.com {{ axis: z{s} }}
            joint h: hinge from world to b.com {{ axis: x{h} }}
            joint k: hinge from world to c.com {{ axis: y{k} }}
            joint g: gear from s.angle to h.angle {{ {g} }}
            joint f: gear from h.angle to k.angle {{ {f} }}
            output h_angle = h.angle;
            output k_angle = k.angle;"
        )
    };
    let two = ["ratio: 2, offset: 0", "ratio: -3, offset: 20 deg"];
    let far = ["ratio: 1, offset: 1000 deg", "ratio: 1, offset: 0"];
    for family in ["absolute", "relative"] {
        for (joints, set, want) in [
            (
                train(", start: 100 deg", "", "", two),
                &[][..],
                [200.0, -580.0],
            ),
            (
                train("", "", "", two),
                &[("s.angle", 500_f64.to_radians())],
                [1000.0, -2980.0],
            ),
            (train("", "", "", far), &[], [1000.0, 1000.0]),
            (
                train(", motor: 500 deg", "", "", far),
                &[],
                [1500.0, 1500.0],
            ),
            // What is driven stands at the other end.
            (
                train("", "", ", start: -580 deg", two),
                &[],
                [200.0, -580.0],
            ),
        ] {
            let got = outputs_at_start(family, "", &joints, set);
            let want = want.map(f64::to_radians);
            assert_close(&got, &want, 1e-9, 1e-11, &format!("{family}: {joints}"));
        }
        let rack = "joint s: prismatic from world to a.com { axis: z, start: 1 m }
            joint h: hinge from world to b.com { axis: x }
            joint held: rigid from world to c.com;
            joint g: gear from s.slide to h.angle { ratio: 20 rad/m }
            output h_angle = h.angle;";
        let got = outputs_at_start(family, "", rack, &[]);
        assert_close(&got, &[20.0], 1e-9, 0.0, family);
    }
}

#[test]
fn what_closes_a_loop_in_a_plane_begins_within_half_a_turn_of_it_in_both_families() {
    // The angles of the bodies add up to a full turn, and to 300 degrees, of which the joint that closes the loop knows nothing.
    for (start, want) in [(120, 0.0), (100, 60.0)] {
        let joints = format!(
            "joint ha: hinge from world to a.com {{ axis: y, start: {start} deg }}
            joint hb: hinge from a.com to b.com {{ axis: y, start: {start} deg }}
            joint hc: hinge from b.com to c.com {{ axis: y, start: {start} deg }}
            loop joint k: hinge from c.com to world {{ axis: y, stiffness: 1 N*m/rad }}
            output closing = k.angle;
            output stored = energy.potential;"
        );
        let want = f64::to_radians(want);
        for family in ["absolute", "relative"] {
            for plane in ["", "planar: xz;"] {
                let got = outputs_at_start(family, plane, &joints, &[]);
                let what = format!("{family}: {plane} {joints}");
                assert_close(&got, &[want, 0.5 * want * want], 0.0, 1e-9, &what);
            }
        }
    }
}

#[test]
fn a_rod_to_a_point_closes_its_loop_wherever_it_is_declared() {
    // A point that stands where it is said, and a rod from it: what else holds the bodies places them first.
    let rod = "joint rod: distance from b.tip to peg { length: 0.5 m }";
    let others = "joint ball: spherical from world to a.root
        joint pin: hinge from a.tip to b.root { axis: y, start: 0.4 rad }";
    for family in ["absolute", "relative"] {
        let at_start = |joints: [&str; 2]| {
            let [first, then] = joints;
            let scene = tests::declared::read(&format!(
                "model Hung {{ coordinates: {family}; gravity: none;
                    body a {{ mass: 1 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, frame root at [0.1, 0, 0.5] m,
                        frame tip at [0, 0.2, -0.5] m rotated about([1, 1, 0], 50 deg) }}
                    body b {{ mass: 1 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, frame root at [0, 0.1, 0.5] m, frame tip at [0.1, 0.1, -0.5] m }}
                    point peg {{ mass: 1 kg, start at [1.2, 0.3, -0.9] m }}
                    {first}
                    {then}
                    output at_a = a.position;
                    output at_b = b.position; }}"
            ));
            begin(scene, &[]).expect("a start").1
        };
        let (before, behind) = (at_start([rod, others]), at_start([others, rod]));
        assert_close(&before, &behind, 0.0, 1e-9, family);
    }
}

#[test]
fn the_angle_of_a_body_in_a_plane_counts_the_turns_of_its_joints_in_both_families() {
    let joints = "joint ha: hinge from world to a.com { axis: y, start: 400 deg }
        joint hb: hinge from a.com to b.com { axis: y, start: 100 deg }
        joint hc: hinge from c.com to b.com { axis: y, start: 300 deg }
        output a_angle = a.angle;
        output b_angle = b.angle;
        output c_angle = c.angle;";
    let want = [400.0, 500.0, 200.0].map(f64::to_radians);
    for family in ["absolute", "relative"] {
        let got = outputs_at_start(family, "planar: xz;", joints, &[]);
        assert_close(&got, &want, 1e-9, 0.0, family);
    }
}

#[test]
fn what_carries_a_loop_or_stands_beside_it_starts_at_zero() {
    // A four-bar of 1, 2 and 2 m on a turntable, pivots 2 m apart; beside it a cart with a pendulum. No start of these says anything.
    for family in ["absolute", "relative"] {
        for hip in [", start: about -100 deg", ", start: about 90 deg", ""] {
            let scene = tests::declared::read(&format!(
                "model Turned {{
                    coordinates: {family};
                    gravity: none;
                    body table {{ mass: 9 kg, inertia: diag(1, 1, 1) kg*m^2, frame near at [0, 0, 0] m, frame far at [2, 0, 0] m }}
                    body cart {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
                    body pole {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame foot at [0, 0, -1] m }}
                    body crank {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.5, 0, 0] m, frame tip at [0.5, 0, 0] m }}
                    body coupler {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1, 0, 0] m, frame tip at [1, 0, 0] m }}
                    body rocker {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-1, 0, 0] m, frame tip at [1, 0, 0] m }}
                    joint turn: hinge from world to table.near {{ axis: z }}
                    joint rail: prismatic from world to cart.com {{ axis: x }}
                    joint pin: hinge from cart.com to pole.foot {{ axis: y }}
                    joint motor: hinge from table.near to crank.root {{ axis: z, start: 70 deg }}
                    joint knee: hinge from crank.tip to coupler.root {{ axis: z }}
                    joint hip: hinge from table.far to rocker.root {{ axis: z{hip} }}
                    joint close: hinge from coupler.tip to rocker.tip {{ axis: z }}
                    output hip_angle = hip.angle;
                    output turn_angle = turn.angle;
                    output rail_slide = rail.slide;
                    output pin_angle = pin.angle;
                }}"
            ));
            let (out, about, undecided) = begun(scene).expect("it closes");
            let [below, above] = [-1.0, 1.0].map(|side| rocker(70f64.to_radians(), side));
            let what = format!("{family}{hip}: {about:?}");
            let nearest = match hip {
                ", start: about -100 deg" => below,
                ", start: about 90 deg" => above,
                _ => [below, above]
                    .into_iter()
                    .min_by(|a, b| (a - out[0]).abs().total_cmp(&(b - out[0]).abs()))
                    .expect("two"),
            };
            assert_close(&out, &[nearest, 0.0, 0.0, 0.0], 0.0, 1e-9, &what);
            assert!(undecided.is_empty(), "{what}: {undecided:?}");
        }
    }
}
