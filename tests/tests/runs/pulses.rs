//! Pulses that lie between the stages of an adaptive step, and obstacles between its places: from rest and from even motion the error of a step is zero
//! whatever lies inside it.

use mbd_runtime::{Model, Options, Scalar, Simulation, StepError, model};

model! {
    /// A mass that is pushed by a short pulse, and one beside it that a fast force shakes too little to matter.
    pub model Struck<T> {
        gravity: none;
        param width = 0.1 s in 1e-4 s ..= 2 s;
        param instant = 10.2 s in 1 s ..= 1000 s;
        point mass { mass: 1 kg }
        point other { mass: 1 kg }
        load pulse on mass = [1 N * exp(-((time - instant) / width)^2), 0 N, 0 N];
        load hum on other = [0 N, 1e-9 N * sin(1000 rad/s * time), 0 N];
    }
}

model! {
    /// A mass that flies past a soft ball of 0.2 m.
    pub model Ball<T> {
        gravity: none;
        param off = 0.05 m in 0 m ..= 0.19 m;
        const k = 20 kN/m;
        let apart = mass.position - [25 m, 0 m, off];
        point mass { mass: 1 kg, start at [0, 0, 0] m velocity [10, 0, 0] m/s }
        load push on mass = k * max(0 m, 0.2 m - norm(apart)) * apart / norm(apart);
        event near = norm(apart) falls 0.25 m;
    }
}

model! {
    /// Nothing moves but time.
    pub model Ticks {
        gravity: none;
        state count = 0 { rate: 0 }
        point mass { mass: 1 kg, start at [0, 0, 0] m velocity [1, 0, 0] m/s }
        event tick = sin(2 * pi * time / (20 ms)) rises 0 { set: count = count + 1 }
        event shut = abs(time - 3.00001 s) falls 1e-6 s;
    }
}

model! {
    /// A mass that passes a force at one place.
    pub model Hill {
        gravity: none;
        param top = 50 m in 0 m ..= 100 m;
        param width = 1 m in 0.1 m ..= 10 m;
        point mass { mass: 1 kg, start at [0, 0, 0] m velocity [1, 0, 0] m/s }
        load push on mass = [0 N, 1 N * exp(-((mass.position.x - top) / width)^2), 0 N];
    }
}

model! {
    /// Nothing moves but declared states, until one of them lets something act.
    pub model Discharge {
        gravity: none;
        param width = 1 s in 1e-3 s ..= 10 s;
        table gear = { 0 s: 0 N, 49 s: 0 N, 50 s: 100 N, 51 s: 0 N };
        state charge = 1 { rate: -0.01 (1/s) }
        state clock = 0 s { rate: 1 + 0.002 (1/s) * clock }
        point motor { mass: 1 kg }
        load drive on motor = [
            if(charge < 0.5, if(charge > 0.45, 10 N, 0 N), 0 N),
            gear(clock),
            10 N * exp(-((clock - 50 s) / width)^2) * (1 + 0.002 (1/s) * clock),
        ];
    }
}

fn methods(tolerance: f64) -> [Options; 4] {
    [
        Options::tsit5(tolerance),
        Options::vern7(tolerance),
        Options::rodas5p(tolerance),
        Options::auto(tolerance),
    ]
}

fn flown<T: Scalar>(model: &dyn Model<T>, options: Options, until: f64) -> Simulation<T> {
    let mut run = Simulation::new(model, options).expect("a model that runs");
    run.run(until).expect("a run that ends");
    run
}

#[test]
fn no_pulse_is_leapt_over_however_short_it_is() {
    for (width, instant, until) in [
        (1.0, 10.2, 20.0),
        (0.03, 10.2, 20.0),
        (1e-3, 10.2, 20.0),
        (1e-4, 617.3, 1000.0),
    ] {
        let model = Struck::<f64>::new(StruckParams { width, instant }).expect("params in range");
        // ∫ exp(−t²/w²) dt.
        let exact = width * std::f64::consts::PI.sqrt();
        for options in methods(1e-8) {
            let run = flown(&model, options, until);
            let speed = run.state()[6];
            let steps = run.statistics().steps;
            println!(
                "{width} {}: {steps}, {:.1e}",
                options.method.name(),
                speed - exact
            );
            assert!(
                (speed - exact).abs() < 1e-6,
                "{width} {options:?}: {speed} {exact}"
            );
            // What shakes too little, 160,000 times in the longest run, is stepped over.
            assert!(steps < 3000, "{width} {options:?}: {steps}");
        }
    }
}

#[test]
fn they_are_not_in_single_precision() {
    let params = StruckParams {
        width: 0.05_f32,
        instant: 10.2,
    };
    let model = Struck::<f32>::new(params).expect("params in range");
    let run = flown(&model, Options::tsit5(1e-5), 20.0);
    let exact = 0.05 * std::f64::consts::PI.sqrt();
    assert!(
        (f64::from(run.state()[6]) - exact).abs() < 1e-4,
        "{}",
        run.state()[6]
    );
}

#[test]
fn nor_in_calls_that_follow_each_other() {
    let model = Struck::<f64>::new(StruckParams {
        width: 0.02,
        instant: 10.2,
    })
    .expect("params in range");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("a model that runs");
    for end in 1..=10 {
        run.run(2.0 * f64::from(end)).expect("a run that ends");
    }
    let exact = 0.02 * std::f64::consts::PI.sqrt();
    assert!((run.state()[6] - exact).abs() < 1e-6, "{}", run.state()[6]);
}

#[test]
fn what_declared_states_let_act_is_not_leapt_over() {
    for width in [10.0, 0.1, 1e-3] {
        let model = Discharge::new(DischargeParams { width }).expect("params in range");
        for options in methods(1e-8) {
            let name = options.method.name();
            let run = flown(&model, options, 100.0);
            let [x, y, z]: [f64; 3] = run.state()[3..6].try_into().expect("a velocity");
            // 10 N for 5 s; ∫ F(c) dt with c = 500 s (exp(t/500 s) − 1), so that dt = dc/(1 + c/500 s); ∫ 10 N exp(−((c − 50 s)/w)²) dc.
            let table = {
                let s = |c: f64| (1.0 + c / 500.0).ln() * 500.0;
                let rising = 500.0 - 549.0 * (s(50.0) - s(49.0));
                let falling = 551.0 * (s(51.0) - s(50.0)) - 500.0;
                100.0 * (rising + falling)
            };
            let pulse = 10.0 * width * std::f64::consts::PI.sqrt();
            println!("{width} {name}: {} {} {}", x - 50.0, y - table, z - pulse);
            assert!((x - 50.0).abs() < 2e-4, "{name}: {x}");
            assert!((y - table).abs() < 2e-4, "{name}: {y} {table}");
            assert!((z - pulse).abs() < 2e-5, "{width} {name}: {z} {pulse}");
        }
    }
}

/// The velocity behind the ball along and across the way: nothing pushes but inside of it, where x'' = k (R − r) x/r is integrated alone, by the classical method of
/// order four, in steps of 1e-6 s from where the mass comes in.
fn behind_the_ball(off: f64) -> [f64; 2] {
    let (stiffness, radius, h) = (2e4, 0.2_f64, 1e-6);
    let rate = |[x, z, u, w]: [f64; 4]| {
        let r = x.hypot(z);
        let push = stiffness * (radius - r) / r;
        [u, w, push * x, push * z]
    };
    let mut now = [-(radius * radius - off * off).sqrt(), -off, 10.0, 0.0];
    let along =
        |now: [f64; 4], by: f64, rate: [f64; 4]| [0, 1, 2, 3].map(|k| now[k] + by * rate[k]);
    for _ in 0..100_000 {
        let a = rate(now);
        let b = rate(along(now, 0.5 * h, a));
        let c = rate(along(now, 0.5 * h, b));
        let d = rate(along(now, h, c));
        let next = [0, 1, 2, 3].map(|k| now[k] + h / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]));
        if next[0].hypot(next[1]) > radius {
            break;
        }
        now = next;
    }
    [now[2], now[3]]
}

#[test]
fn an_obstacle_that_is_passed_in_even_motion_pushes() {
    let off = 0.05;
    let model = Ball::<f64>::new(BallParams { off }).expect("params in range");
    let exact = behind_the_ball(off);
    assert!(exact[1].abs() > 0.1, "{exact:?}");
    for options in methods(1e-8) {
        let run = flown(&model, options, 5.0);
        let off = (run.state()[3] - exact[0]).hypot(run.state()[5] - exact[1]);
        println!(
            "{}: {off:.1e}, {}",
            options.method.name(),
            run.statistics().steps
        );
        assert!(off < 2e-5, "{options:?}: {:?} {exact:?}", run.state());
        assert_eq!(run.events().len(), 1, "{options:?}: {:?}", run.events());
        // Energy: an elastic push gives and takes the same.
        let speed = run.state()[3].hypot(run.state()[5]);
        assert!((speed - 10.0).abs() < 1e-5, "{options:?}: {speed}");
    }
}

#[test]
fn a_hill_whose_foot_a_stage_has_touched_is_not_leapt_over() {
    for (top, width) in [(50.0, 0.3), (41.0, 0.3), (67.0, 1.0), (50.0, 0.5)] {
        let model = Hill::new(HillParams { top, width }).expect("params in range");
        for options in methods(1e-8).into_iter().chain(methods(1e-6)) {
            let run = flown(&model, options, 100.0);
            let speed = run.state()[4];
            // ∫ exp(−((t − top)/w)²) dt at 1 m/s.
            let exact = width * std::f64::consts::PI.sqrt();
            println!(
                "{top} {width} {}: {:.1e}",
                options.method.name(),
                speed - exact
            );
            assert!(
                (speed - exact).abs() < 2e-4,
                "{top} {width} {options:?}: {speed} {exact}"
            );
        }
    }
}

#[test]
fn every_passing_of_a_guard_of_time_is_an_event() {
    let model = Ticks::new(TicksParams::default()).expect("params in range");
    let mut all = methods(1e-6).to_vec();
    all.extend([Options::rk4(0.17), Options::rattle(0.17)]);
    for options in all {
        let run = flown(&model, options, 4.99);
        let count = run.state()[6];
        // At the start, and every 20 ms.
        assert_eq!(count, 250.0, "{options:?}");
        let shut = run
            .events()
            .iter()
            .filter(|event| (event.time - 3.000_009).abs() < 1e-12);
        assert_eq!(shut.count(), 1, "{options:?}");
    }
}

model! {
    /// A car that passes a rail with teeth at an even speed, and one that speeds up along one.
    pub model Rail<T> {
        gravity: none;
        param pitch = 7 cm in 0.1 mm ..= 10 m;
        param push = 0 N;
        state teeth = 0 { rate: 0 }
        state back = 0 { rate: 0 }
        body car { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
        joint rail: prismatic from world to car.com { axis: x, start_rate: 3 m/s, force: push }
        event tooth = sin(2 * pi * rail.slide / pitch) rises 0.5 { set: teeth = teeth + 1 }
        event gap = sin(2 * pi * rail.slide / pitch) falls 0.5 { set: back = back + 1 }
    }
}

/// Tooth k is passed at (k + 1/12) of the pitch, and left at (k + 5/12).
#[test]
fn every_tooth_of_a_rail_is_an_event_however_far_a_step_goes() {
    for (pitch, push) in [
        (0.07, 0.0),
        (0.31, 0.0),
        (2e-3, 0.0),
        (0.07, 4.0),
        (0.011, -2.0),
    ] {
        let model = Rail::new(RailParams { pitch, push }).expect("params in range");
        let until = 1.4;
        let way = 3.0 * until + 0.5 * push * until * until;
        let passed = |part: f64| (way / pitch - part).floor() + 1.0;
        for options in methods(1e-6) {
            let run = flown(&model, options, until);
            let teeth = &run.state()[run.state().len() - 2..];
            let want = [passed(1.0 / 12.0), passed(5.0 / 12.0)];
            assert_eq!(teeth, want, "{pitch} m, {push} N, {options:?}");
        }
    }
}

model! {
    /// A push that has no number for a tenth of a second.
    pub model Broken {
        gravity: none;
        point mass { mass: 1 kg, start at [0, 0, 0] m }
        load push on mass =
            [1 N * (sqrt(0.5 - exp(-((time - 10 s) / (0.1 s))^2)) - sqrt(0.5)), 0 N, 0 N];
    }
}

#[test]
fn what_has_no_number_between_two_stages_ends_the_run_there() {
    let model = Broken::new(BrokenParams::default()).expect("params in range");
    for options in methods(1e-6) {
        let mut run = Simulation::new(&model, options).expect("a model that runs");
        let error = run.run(100.0).expect_err("the root of a negative number");
        assert!(
            matches!(error.cause, StepError::NonFinite { .. }),
            "{options:?}: {error}"
        );
        // exp(−u²) = 1/2.
        let begins = 10.0 - 0.1 * 2.0_f64.ln().sqrt();
        assert!(
            run.time() < begins && run.time() > 9.0,
            "{options:?}: {}",
            run.time()
        );
    }
}

#[test]
fn fixed_steps_that_pass_over_a_pulse_say_when() {
    let hidden = |width: f64, step: f64| {
        let params = StruckParams {
            width,
            instant: 10.2037,
        };
        let model = Struck::<f64>::new(params).expect("params in range");
        // Nothing but the hum moves anything at first, and steps as long as its radians are watched.
        let mut options = Options::rk4(step);
        options.watch = false;
        let mut run = Simulation::new(&model, options).expect("a model that runs");
        for end in [10.0, 20.0] {
            run.run(end).expect("a run that ends");
        }
        run.hidden_from_steps()
    };
    let found = hidden(1e-4, 1e-3).expect("a pulse between stages");
    assert!((found - 10.2037).abs() < 1e-4, "{found}");
    // The hum of 159 Hz is seen by steps of a millisecond, and by none of 8 ms.
    assert_eq!(hidden(0.1, 1e-3), None);
    assert!(hidden(0.1, 8e-3).is_some());
}

#[test]
fn looks_into_quiet_steps_are_few() {
    let model = Struck::<f64>::new(StruckParams::default()).expect("params in range");
    let run = flown(&model, Options::tsit5(1e-6), 1e4);
    // The pulse itself takes some 60 steps.
    assert!(run.statistics().rhs < 2000, "{:?}", run.statistics());
}

model! {
    /// A mass on a spring whose free length has a pulse: long before it the spring is straight but for rounding.
    pub model Drawn {
        gravity: none;
        point mass { mass: 1 kg, start at [1, 0, 0] m }
        spring tie from world to mass {
            free_length: 1 m + 0.05 m * exp(-((time - 50.3 s) / (0.05 s))^2),
            stiffness: 100 N/m,
        }
    }
}

#[test]
fn where_a_spring_is_straight_but_for_rounding_no_fixed_step_makes_energy() {
    let model = Drawn::new(DrawnParams::default()).expect("defaults");
    let state = |options| {
        let run = flown(&model, options, 51.0);
        let imbalance = run.imbalance();
        let is_small = imbalance.is_none_or(|it| it.relative() < 1e-6);
        assert!(is_small, "{options:?}: {imbalance:?}");
        DrawnState::from_slice(run.state()).expect("a state").mass()
    };
    // x'' = -100 (x - 0.05 e^(-u²)) / s²: 0.5 √π w e^(-(ω w / 2)²) m/s at the pulse, by its Fourier transform, and cos from there on.
    let push = 100.0 * 0.05 * 0.05 * std::f64::consts::PI.sqrt() * (-0.0625_f64).exp();
    let exact = 1.0 + push / 10.0 * (10.0_f64 * 0.7).sin();
    for options in [
        Options::rk4(1e-3),
        Options::rk4(1e-4),
        Options::tsit5(1e-10),
    ] {
        let x = state(options).position[0];
        assert!((x - exact).abs() < 1e-8, "{options:?}: {x} {exact}");
    }
}
