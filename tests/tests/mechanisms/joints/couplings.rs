//! Couplings: one row over the coordinates of two joints, whatever these are; trains of gears against closed forms, over many turns.

use mbd_runtime::{Generic, Options, Simulation};
use mbd_scene::joints::JointLaw;
use mbd_scene::{AngularVelocity, Formula, Layout, Model, Quantity, Scene};
use nalgebra::{DMatrix, UnitQuaternion, Vector3};
use tests::assert_close;
use tests::declared::read;
use tests::mechanism::{
    Coordinates, Instance, Seat, accelerations, add_body, add_external_loads, add_frame, add_gear,
    add_joint, all_joints, carried, empty, evaluate, inertia, jets, state,
};
use tests::random::Random;

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];
const RATIOS: [f64; 5] = [3.0, -0.5, 2.15, 20.0 / 43.0, -1.0];
const OFFSET: f64 = 0.4;

/// Two joints, each on a body of its own, and a gear from a coordinate of the first to one of the second.
struct Train {
    scene: Scene,
    laws: [JointLaw; 2],
    seats: [[Seat; 2]; 2],
    coordinates: [usize; 2],
    ratio: f64,
    /// Whether the second joint sits on the child of the first, not on its parent.
    in_series: bool,
}

impl Train {
    fn random(components: AngularVelocity, random: &mut Random) -> (Self, [Vec<f64>; 2]) {
        let measuring: Vec<_> = all_joints()
            .into_iter()
            .filter(|(law, _)| law.measured().next().is_some())
            .collect();
        let mut pick = || measuring[random.below(measuring.len())].clone();
        let [one, two] = [pick(), pick()];
        let laws = [one.0, two.0];
        let coordinates = laws
            .each_ref()
            .map(|law| random.below(law.measured().count()));
        let ratio = RATIOS[random.below(RATIOS.len())];
        let in_series = random.below(2) == 0;
        let mut seats = || [Seat::random(random), Seat::random(random)];
        let seats = [seats(), seats()];
        let mut scene = empty([0.3, -0.2, -9.81], components);
        for mass in [1.7, 0.9, 0.6] {
            add_body(&mut scene, mass, &inertia(random));
        }
        for (joint, law) in laws.iter().enumerate() {
            let parent = if joint == 1 && in_series { 1 } else { 0 };
            let [from, to] = seats[joint].map(|seat| seat.declared("seat"));
            let from = add_frame(&mut scene, Some(parent), from);
            let to = add_frame(&mut scene, Some(1 + joint), to);
            add_joint(&mut scene, law.clone(), from, to);
        }
        let couples = [(1, coordinates[1]), (0, coordinates[0])];
        add_gear(&mut scene, couples, ratio.into(), OFFSET);
        add_external_loads(&mut scene);
        let train = Train {
            scene,
            laws,
            seats,
            coordinates,
            ratio,
            in_series,
        };
        (train, [one.1, two.1])
    }

    /// A motion that both joints and the gear allow.
    fn allowed(&self, numbers: [Vec<f64>; 2], random: &mut Random) -> Vec<Instance> {
        let [leader, follower] = self.coordinates;
        let [numbers, others] = numbers;
        let first = Coordinates::random(&self.laws[0], numbers, random);
        let mut second = Coordinates::random(&self.laws[1], others, random);
        second.q[follower] = self.ratio * first.q[leader] + OFFSET;
        second.u[follower] = self.ratio * first.u[leader];
        second.rate[follower] = self.ratio * first.rate[leader];
        let base = Instance::random(random);
        let one = carried(&self.laws[0], self.seats[0], &base, &first);
        let on = if self.in_series { one } else { base };
        let two = carried(&self.laws[1], self.seats[1], &on, &second);
        vec![base, one, two]
    }

    fn quantity(&self, what: Quantity, bodies: &[Instance]) -> Vec<f64> {
        evaluate(
            &self.scene,
            what,
            &state(&self.scene, bodies, &[]),
            &[],
            &[],
        )
    }

    fn jacobian(&self, bodies: &[Instance]) -> DMatrix<f64> {
        let layout = Layout::new(&self.scene);
        let dense = self.quantity(Quantity::ConstraintJacobian, bodies);
        DMatrix::from_row_slice(layout.nc, layout.nv, &dense)
    }
}

fn everywhere(mut check: impl FnMut(&str, &Train, [Vec<f64>; 2], &mut Random)) {
    let mut random = Random::new(41);
    for components in COMPONENTS {
        for trial in 0..60 {
            let (train, numbers) = Train::random(components, &mut random);
            let words = train.laws.each_ref().map(JointLaw::keyword);
            let (at, ratio) = (train.coordinates, train.ratio);
            let name = format!("{words:?} {at:?} by {ratio}, {components:?}, {trial}");
            check(&name, &train, numbers, &mut random);
        }
    }
}

#[test]
fn a_coupling_is_one_row_that_holds_along_every_motion_it_allows() {
    everywhere(|name, train, numbers, random| {
        let layout = Layout::new(&train.scene);
        let own: usize = train.laws.iter().map(JointLaw::rows).sum();
        assert_eq!((layout.nc, layout.rank()), (own + 1, own + 1), "{name}");
        let bodies = train.allowed(numbers, random);
        let jacobian = train.jacobian(&bodies);
        assert!(jacobian.singular_values().min() > 1e-3, "{name}");
        let zero = vec![0.0; layout.nc];
        for what in [Quantity::Constraint, Quantity::ConstraintRate] {
            let value = train.quantity(what, &bodies);
            assert_close(&value, &zero, 0.0, 1e-12, &format!("{name}: {what:?}"));
        }
        let moved =
            jacobian * DMatrix::from_vec(layout.nv, 1, accelerations(&train.scene, &bodies, &[]));
        let bias = train.quantity(Quantity::ConstraintBias, &bodies);
        assert_close(moved.as_slice(), &bias, 1e-12, 1e-12, &format!("{name}: γ"));
    });
}

#[test]
fn the_row_of_a_coupling_agrees_with_jets_along_motions_that_violate_it() {
    everywhere(|name, train, _, random| {
        let bodies: Vec<Instance> = (0..3).map(|_| Instance::random(random)).collect();
        let jets = jets(&train.scene, &bodies, &[]);
        let jet = evaluate(&train.scene, Quantity::Constraint, &jets, &[], &[]);
        let level = |k: usize| jet.last().expect("a row").0[k];
        let last = |list: Vec<f64>| *list.last().expect("a row");
        // Near a quarter turn off the joint an angle turns arbitrarily fast.
        let size = 1.0 + level(1).abs() + level(2).abs();
        let rate = last(train.quantity(Quantity::ConstraintRate, &bodies));
        assert!((rate - level(1)).abs() < 1e-11 * size, "{name}: {rate}");
        let layout = Layout::new(&train.scene);
        let moved = train.jacobian(&bodies)
            * DMatrix::from_vec(layout.nv, 1, accelerations(&train.scene, &bodies, &[]));
        let bias = last(train.quantity(Quantity::ConstraintBias, &bodies));
        let second = moved[layout.nc - 1] - bias;
        assert!((second - level(2)).abs() < 1e-11 * size, "{name}: {second}");
    });
}

/// A run of a scene from a state.
fn run(scene: &Scene, options: Options, start: &[f64]) -> Simulation<f64> {
    let model = Generic::<f64>::with_defaults(scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, options).expect("options");
    run.set_state(0.0, start).expect("a state");
    run.start().unwrap_or_else(|error| panic!("{error}"));
    run
}

/// Every body at the origin, its axes along those of the world, turning about them.
fn still(scene: &Scene, spins: &[[f64; 3]]) -> Vec<f64> {
    let spins = spins.iter().map(|&omega| Instance {
        omega: Vector3::from(omega),
        ..Instance::rest()
    });
    let mut bodies: Vec<Instance> = spins.collect();
    bodies.resize(scene.bodies.len(), Instance::rest());
    state(scene, &bodies, &[])
}

fn ask(run: &mut Simulation<f64>, what: Quantity, length: usize) -> Vec<f64> {
    let mut out = vec![0.0; length];
    run.evaluate(what, &mut out).expect("a quantity");
    out
}

/// Two discs of 0.2 and 0.05 kg m² about y, the first under a torque of 3 N m, coupled by a ratio and an offset.
fn discs(ratio: &str, components: &str) -> Scene {
    read(&format!(
        "model Discs {{
            gravity: none;
            angular_velocity: {components};
            body driver {{ mass: 2 kg, inertia: diag(0.3, 0.2, 0.3) kg*m^2 }}
            body wheel {{ mass: 1 kg, inertia: diag(0.03, 0.05, 0.03) kg*m^2 }}
            joint teeth: gear from motor.angle to axle.angle {{ ratio: {ratio}, offset: 20 deg }}
            joint motor: hinge from world to driver.com {{ axis: y }}
            joint axle: hinge from world to wheel.com {{ axis: -y }}
            load push on driver = [0, 3, 0] N*m;
            output driver_angle = motor.angle;
            output wheel_angle = axle.angle;
        }}"
    ))
}

#[test]
fn two_discs_under_a_torque_accelerate_as_their_inertia_seen_through_the_gear() {
    for components in ["body", "world"] {
        for (ratio, r) in [("3", 3.0), ("-0.5", -0.5), ("43 / 20", 2.15)] {
            let scene = discs(ratio, components);
            let mut run = run(&scene, Options::rk4(1e-2), &still(&scene, &[]));
            let alpha = 3.0 / (0.2 + 0.05 * r * r);
            let rate = ask(&mut run, Quantity::Derivative, 26);
            let v = &rate[14..];
            assert_close(&[v[4], v[10]], &[alpha, -r * alpha], 1e-13, 0.0, ratio);
            // The torque along `axle.angle`, and the couple on the wheel: its axis is −y.
            let torque = 0.05 * r * alpha;
            let reactions = ask(&mut run, Quantity::Reactions, 18);
            assert_close(&reactions[..3], &[0.0; 3], 0.0, 1e-13, "no force");
            assert_close(&reactions[3..6], &[0.0, -torque, 0.0], 1e-12, 1e-13, ratio);
            let multipliers = ask(&mut run, Quantity::Multipliers, 11);
            assert_close(&multipliers[..1], &[torque], 1e-12, 0.0, ratio);
        }
    }
}

#[test]
fn a_gear_holds_its_phase_over_many_turns() {
    for (ratio, r, teeth) in [
        ("3", 3.0, 1.0),
        ("-20 / 43", -20.0 / 43.0, 43.0),
        ("2.15", 2.15, 20.0),
    ] {
        let scene = discs(ratio, "body");
        let mut run = run(&scene, Options::tsit5(1e-10), &still(&scene, &[]));
        let alpha = 3.0 / (0.2 + 0.05 * r * r);
        // At rest the start has turned both discs against their inertia; the driver then makes 25 turns.
        let mut first = ask(&mut run, Quantity::Outputs, 2);
        // The offset holds as far as a gear can tell: shifted by whole teeth it is the same gear.
        let off = teeth * (first[1] - r * first[0] - 20f64.to_radians());
        assert!(off.sin().abs() < 1e-12 && off.cos() > 0.0, "{off:e}");
        let turned = 50.0 * std::f64::consts::PI;
        let steps = 200;
        let mut turns = [0.0; 2];
        for k in 1..=steps {
            let angle = turned * f64::from(k) / f64::from(steps);
            run.run((2.0 * angle / alpha).sqrt()).expect("it turns");
            let now = ask(&mut run, Quantity::Outputs, 2);
            for (turn, part) in turns.iter_mut().zip([0, 1]) {
                // The increment nearest to what the torque makes of it.
                let made = [1.0, r][part] * turned / f64::from(steps);
                let off = now[part] - first[part] - made;
                *turn += made + off.sin().atan2(off.cos());
            }
            first = now;
        }
        assert_close(&turns, &[turned, r * turned], 1e-8, 0.0, ratio);
        let relation = turns[1] - r * turns[0];
        assert!(relation.abs() < 1e-10, "{ratio}: {relation:e}");
    }
}

#[test]
fn a_rack_runs_away_from_its_pinion_at_a_radius_that_may_be_a_parameter() {
    let scene = read(
        "model Rack {
            gravity: [0, 0, -9.81] m/s^2;
            param radius = 40 mm in 10 mm ..= 90 mm;
            body pinion { mass: 1 kg, inertia: diag(0.01, 0.02, 0.01) kg*m^2 }
            body bar { mass: 3 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
            joint axle: hinge from world to pinion.com { axis: y }
            joint rail: prismatic from world to bar.com { axis: x }
            joint teeth: gear from axle.angle to rail.slide { ratio: radius, offset: 100 mm }
            load push on pinion = [0, 3, 0] N*m;
            output way = rail.slide;
        }",
    );
    let mut run = run(&scene, Options::tsit5(1e-10), &still(&scene, &[]));
    let start = ask(&mut run, Quantity::Outputs, 1)[0];
    let (torque, radius) = (3.0, 0.04);
    let a = torque * radius / (0.02 + 3.0 * radius * radius);
    // The rack is pushed by the part of the torque that accelerates it.
    let reactions = ask(&mut run, Quantity::Reactions, 18);
    let push = [3.0 * a, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_close(&reactions[12..], &push, 1e-12, 1e-12, "push");
    // Twelve turns of the pinion.
    let way = 12.0 * std::f64::consts::TAU * radius;
    run.run((2.0 * way / a).sqrt()).expect("it runs");
    let end = ask(&mut run, Quantity::Outputs, 1)[0];
    assert_close(&[end - start], &[way], 1e-9, 0.0, "way");
    // 1/2 a t² and v² = 2 a s.
    let speed = (2.0 * a * way).sqrt();
    assert_close(&run.state()[14 + 6..14 + 7], &[speed], 1e-9, 0.0, "speed");
}

#[test]
fn a_planetary_gear_divides_speeds_by_willis_formula() {
    // Sun 20 teeth, planet 16, ring 52, fixed: the carrier turns 20/72 as fast as the sun.
    let scene = read(
        "model Planetary {
            gravity: none;
            body sun { mass: 1 kg, inertia: diag(0.01, 0.01, 0.02) kg*m^2 }
            body carrier { mass: 1 kg, inertia: diag(0.04, 0.04, 0.07) kg*m^2, frame pin at [0.09, 0, 0] m }
            body planet { mass: 0.4 kg, inertia: diag(0.002, 0.002, 0.003) kg*m^2 }
            joint arm: hinge from world to carrier.com { axis: z }
            joint shaft: hinge from carrier.com to sun.com { axis: z }
            joint pin: hinge from carrier.pin to planet.com { axis: z }
            joint inner: gear from shaft.angle to pin.angle { ratio: -20 / 16 }
            joint outer: gear from pin.angle to arm.angle { ratio: -16 / 52 }
            load push on sun = [0, 0, 5] N*m;
        }",
    );
    let layout = Layout::new(&scene);
    assert_eq!((layout.freedoms(), layout.redundancy.repeats.len()), (1, 0));
    let mut bodies = [Instance::rest(); 3];
    bodies[2].position.x = 0.09;
    let mut run = run(&scene, Options::tsit5(1e-10), &state(&scene, &bodies, &[]));
    let k = 20.0 / 72.0;
    let planet = k - 20.0 / 16.0 * (1.0 - k);
    let seen = 0.02 + (0.07 + 0.4 * 0.09f64.powi(2)) * k * k + 0.003 * planet * planet;
    let alpha = 5.0 / seen;
    let time = (2.0 * 40.0 * std::f64::consts::TAU / alpha).sqrt();
    run.run(time).expect("forty turns of the sun");
    let v = &run.state()[21..];
    let speeds = [v[5], v[11], v[17]];
    let want = [alpha * time, k * alpha * time, planet * alpha * time];
    assert_close(&speeds, &want, 1e-8, 0.0, "sun, carrier, planet");
}

/// Wheels on parallel axles, each geared to the one before; the first and the last also, `closing` times as fast.
fn ring(closing: &str) -> Scene {
    read(&format!(
        "model Ring {{
            gravity: [0, 0, -9.81] m/s^2;
            body wheel[i in 0..3] {{ mass: 1 kg, inertia: diag(0.02, 0.02, 0.02) kg*m^2, frame hub at [0.03, 0, 0] m }}
            joint axle[i in 0..3]: hinge from world to wheel[i].hub {{ axis: y }}
            joint mesh[i in 1..3]: gear from axle[i - 1].angle to axle[i].angle {{ ratio: -i / 2 }}
            joint {closing};
        }}"
    ))
}

#[test]
fn a_gear_that_repeats_others_is_named() {
    let scene = ring("close: gear from axle[0].angle to axle[2].angle { ratio: 0.5 }");
    let layout = Layout::new(&scene);
    assert_eq!(layout.freedoms(), 1);
    assert_eq!(
        layout.redundancy.sentences(&scene),
        ["`close` repeats rows of `mesh[1]`, `mesh[2]`: 1 of 1"]
    );
    // One that contradicts the others locks the train.
    let locked = ring("close: gear from axle[0].angle to axle[2].angle { ratio: 0.75 }");
    assert_eq!(Layout::new(&locked).freedoms(), 0);
}

#[test]
fn a_train_of_eccentric_wheels_keeps_its_energy_over_many_turns() {
    let scene = ring("close: gear from axle[0].angle to axle[2].angle { ratio: 0.5 }");
    let bodies = [14.0, -7.0, 7.0].map(|spin| {
        let (position, omega) = (Vector3::x() * -0.03, Vector3::y() * spin);
        Instance {
            position,
            velocity: omega.cross(&position),
            omega,
            ..Instance::rest()
        }
    });
    let mut run = run(&scene, Options::tsit5(1e-11), &state(&scene, &bodies, &[]));
    let mut energy = || {
        let parts = ask(&mut run, Quantity::Energy, 6);
        let now = parts[0] + parts[1];
        run.run(run.time() + 0.5).expect("it turns");
        now
    };
    let first = energy();
    for _ in 0..20 {
        let error = (energy() - first) / first;
        assert!(error.abs() < 1e-9, "{error:e}");
    }
}

#[test]
fn a_mechanism_geared_to_a_motor_takes_the_work_that_the_motor_does() {
    // A crank and rocker whose crank is geared to a driven disc; the gear is declared before the loop closes.
    let scene = read(
        "model Pump {
            gravity: [0, 0, -9.81] m/s^2;
            world { frame far at [1.9, 0, 0] m }
            body disc { mass: 1 kg, inertia: diag(0.02, 0.03, 0.02) kg*m^2 }
            body crank { mass: 1 kg, inertia: diag(0.03, 0.05, 0.06) kg*m^2, frame root at [0, 0, -0.2] m, frame tip at [0, 0, 0.2] m }
            body bar { mass: 1.2 kg, inertia: diag(0.02, 0.07, 0.06) kg*m^2, frame left at [-0.9, 0, 0] m, frame right at [0.9, 0, 0] m }
            body rocker { mass: 1.4 kg, inertia: diag(0.03, 0.05, 0.06) kg*m^2, frame root at [0, 0, -0.4] m, frame tip at [0, 0, 0.4] m }
            joint spin: hinge from world to disc.com { axis: y, motor: 4 rad/s * time }
            joint teeth: gear from spin.angle to a.angle { ratio: -2.5 }
            joint a: hinge from world to crank.root { axis: y }
            joint b: hinge from crank.tip to bar.left { axis: y }
            joint c: hinge from bar.right to rocker.tip { axis: y }
            joint close: spherical from world.far to rocker.root;
        }",
    );
    let mut bodies = [Instance::rest(); 4];
    for (body, position, turn) in [
        (1, [0.0, 0.0, 0.2], 0.0),
        (2, [0.8789, 0.0, 0.5936], -0.2169),
        (3, [1.8289, 0.0, 0.3936], -0.1787),
    ] {
        bodies[body].position = Vector3::from(position);
        bodies[body].attitude = UnitQuaternion::from_scaled_axis(Vector3::y() * turn);
    }
    let options = Options {
        work: true,
        ..Options::tsit5(1e-10)
    };
    let layout = Layout::new(&scene);
    assert_eq!(layout.freedoms(), 0);
    let mut run = run(&scene, options, &state(&scene, &bodies, &[]));
    let energy = |run: &mut Simulation<f64>| {
        let parts = ask(run, Quantity::Energy, 6);
        parts[0] + parts[1]
    };
    let before = energy(&mut run);
    run.run(4.0).expect("six turns of the crank");
    let gained = energy(&mut run) - before;
    let work: f64 = run.work().expect("asked for").iter().sum();
    assert!((gained - work).abs() < 1e-7, "{gained} J of {work} J");
    let rows = ask(&mut run, Quantity::Constraint, layout.nc);
    assert_close(&rows, &vec![0.0; layout.nc], 0.0, 1e-12, "rows");
}

#[test]
fn pieces_that_only_a_gear_ties_conserve_energy_and_angular_momentum() {
    let scene = read(
        "model Satellites {
            gravity: none;
            body hub[i in 0..2] { mass: 3 kg, inertia: diag(0.3, 0.4, 0.5) kg*m^2 }
            body wheel[i in 0..2] { mass: 1 kg, inertia: diag(0.02, 0.02, 0.03) kg*m^2 }
            joint loose[i in 0..2]: free from world to hub[i].com;
            joint axle[i in 0..2]: hinge from hub[i].com to wheel[i].com { axis: z }
            joint teeth: gear from axle[0].angle to axle[1].angle { ratio: 1.5 }
        }",
    );
    let layout = Layout::new(&scene);
    assert_eq!((layout.freedoms(), layout.redundancy.closed), (13, true));
    let spins = [
        [0.3, 0.2, 0.1],
        [0.1, 0.5, 0.4],
        [0.3, 0.2, 5.1],
        [0.1, 0.5, 7.9],
    ];
    let mut run = run(&scene, Options::tsit5(1e-11), &still(&scene, &spins));
    let keep = |run: &mut Simulation<f64>| {
        let energy = ask(run, Quantity::Energy, 6)[0];
        // The gear is a couple along each axle in balance inside its own piece.
        let momentum = ask(run, Quantity::Momentum, 6);
        [&[energy], &momentum[..]].concat()
    };
    let first = keep(&mut run);
    run.run(10.0).expect("eight turns");
    assert_close(&keep(&mut run), &first, 1e-9, 1e-9, "energy and momentum");
}

#[test]
fn a_gear_in_a_plane_moves_as_in_space() {
    let space = discs("-2.5", "body");
    let flat = Scene {
        planar: Some(mbd_scene::Plane::Xz),
        ..space.clone()
    };
    let layout = Layout::new(&flat);
    assert_eq!((layout.nv, layout.nc, layout.freedoms()), (6, 5, 1));
    let mut flat = run(&flat, Options::tsit5(1e-10), &[0.0; 12]);
    let mut space = run(&space, Options::tsit5(1e-10), &still(&space, &[]));
    for run in [&mut flat, &mut space] {
        run.run(2.0).expect("it turns");
    }
    let [flat, space] = [&mut flat, &mut space].map(|run| ask(run, Quantity::Outputs, 2));
    assert_close(&flat, &space, 1e-8, 1e-8, "angles");
}

#[test]
fn single_precision_holds_a_gear_over_many_turns() {
    let scene = discs("3", "body");
    let model = Generic::<f32>::with_defaults(scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::rk4(2e-3)).expect("options");
    let start: Vec<f32> = still(&scene, &[]).iter().map(|&x| x as f32).collect();
    run.set_state(0.0, &start).expect("a state");
    run.run(5.0).expect("ten turns of the driver");
    let mut rows = vec![0.0; model.layout().nc];
    run.evaluate(Quantity::Constraint, &mut rows).expect("rows");
    assert!(rows[0].abs() < 1e-4, "{}", rows[0]);
    let v = &run.state()[14..];
    assert!((v[10] / v[4] + 3.0).abs() < 1e-4, "{} and {}", v[4], v[10]);
}

#[test]
fn a_relation_of_angles_without_a_common_measure_is_no_number() {
    // The language refuses it; a scene made by hand tells by its first value.
    let mut scene = discs("3", "body");
    if let JointLaw::Gear(gear) = &mut scene.joints[0].law {
        gear.ratio = Formula::Number(2f64.sqrt());
    }
    let x = still(&scene, &[]);
    let rows = evaluate(&scene, Quantity::Constraint, &x, &[], &[]);
    assert!(rows[0].is_nan());
}
