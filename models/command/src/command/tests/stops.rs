//! Runs that stop early, and runs that are less accurate than they look.

use super::*;

#[test]
fn a_run_that_stops_early_says_why_and_keeps_its_files() {
    let folder = Folder::new("early");
    let out = folder.0.join("out").display().to_string();
    let error = run(&[
        "run",
        "swing",
        "--out",
        &out,
        "--set",
        "k=100 kN/m",
        "--set",
        "m_bob=0.1 kg",
        "--dt",
        "0.05",
        "--until",
        "50",
    ])
    .unwrap_err();
    assert_eq!(error.code(), 4);
    assert!(folder.0.join("out/history.csv").is_file());
}

#[test]
fn a_motor_without_a_value_is_named_as_the_cause() {
    let folder = Folder::new("nan_motor");
    let text = "model M { planar: xz; gravity: none;
          body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [0, 0, 0.5] m }
          joint pin: hinge from world to a.one { axis: y, motor: sqrt(0.5 - time * 1 rad/s) } }
        [run]\nuntil = \"2 s\"\nstep = \"10 ms\"\n";
    let out = folder.0.join("out").display().to_string();
    for (text, time) in [
        (text.to_owned(), "at 0.5"),
        (text.replace("0.5 - time", "-0.5 - time"), "at 0 s"),
    ] {
        let error = run(&["run", &folder.file("m.mbd", &text), "--out", &out]).unwrap_err();
        let told = error.to_string();
        println!("{told}");
        assert_eq!(error.code(), 4);
        assert!(
            told.contains("`pin`") && told.contains("motor") && told.contains(time),
            "{told}"
        );
    }
}

/// A load that is no number behind 1e-9 s, and one behind 1e9 s.
#[test]
fn the_time_of_a_failure_is_told_by_its_digits_whatever_its_size() {
    let folder = Folder::new("nan_when");
    let out = folder.0.join("out").display().to_string();
    for (when, until, told) in [("1e-9 s", "2e-9 s", "e-9 s"), ("1e9 s", "2e9 s", "e9 s")] {
        let text = format!(
            "model M {{ gravity: none; point p {{ mass: 1 kg }}
                load pull on p = [1 N * sqrt(1 - time / ({when})), 0, 0]; }}
            [run]\nuntil = \"{until}\"\nstep = \"{when}\"\n"
        );
        let error = run(&["run", &folder.file("m.mbd", &text), "--out", &out]).unwrap_err();
        assert_eq!(error.code(), 4);
        let text = error.to_string();
        let time = text
            .split("M: at ")
            .nth(1)
            .and_then(|at| at.split(' ').next());
        let time = time.unwrap_or_default();
        assert!(
            format!("{time} s").ends_with(told) && time.len() < 16,
            "{text}"
        );
    }
}

#[test]
fn a_run_is_given_up_after_the_steps_it_may_take() {
    let folder = Folder::new("max_steps");
    let out = folder.0.join("out").display().to_string();
    let error = run(&[
        "run",
        "swing",
        "--out",
        &out,
        "--dt",
        "1 ms",
        "--max-steps",
        "20",
    ])
    .unwrap_err();
    assert_eq!(error.code(), 4);
    assert!(error.to_string().contains("20 steps"), "{error}");
    let none = run(&["run", "swing", "--out", &out, "--max-steps", "0"]).unwrap_err();
    assert_eq!(none.code(), 2);
}

#[test]
fn a_run_that_is_less_accurate_than_one_percent_says_what_to_change() {
    let folder = Folder::new("inaccurate");
    let out = folder.0.join("out").display().to_string();
    // A double pendulum at a loose tolerance for half a minute: chaos.
    let text = "model Wild { gravity: [0, 0, -9.81] m/s^2;
          body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
          body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
          joint p: hinge from world to a.top { axis: y, start: 3.0 rad }
          joint q: hinge from a.end to b.top { axis: y, start: 0.1 rad }
          output swing = b.position.x; }
        [run]\nuntil = \"30 s\"\ntolerance = 1e-4\n";
    let file = folder.file("wild.mbd", text);
    let error = run(&["run", &file, "--out", &out]).unwrap_err();
    assert_eq!(error.code(), 3, "{error}");
    let told = error.to_string();
    for part in [
        "warning: Wild: `swing` is off by about",
        "tighter tolerance",
        "written to",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    // Without the second run there is only the energy, which is kept well enough.
    let told = run(&["run", &file, "--out", &out, "--no-estimate"]);
    assert!(told.is_ok_and(|told| !told.contains("off most")));
}

#[test]
fn a_large_angle_hides_no_small_one_and_a_turn_more_of_an_atan2_is_no_error() {
    let folder = Folder::new("directions");
    let out = folder.0.join("out").display().to_string();
    // A damped wheel spins up for hundreds of turns; its direction jumps by a turn each time it comes round.
    let text = |tolerance: &str| {
        format!(
            "model Wheel {{ gravity: [0, 0, -9.81] m/s^2;
          body wheel {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
          joint spin: hinge from world to wheel.com {{ axis: z, force: 1 N*m, damping: 0.001 N*m*s }}
          output rotation = spin.angle;
          output direction = atan2(sin(spin.angle), cos(spin.angle)); }}
        [run]\nuntil = \"20 s\"\ntolerance = {tolerance}\n"
        )
    };
    let coarse = folder.file("coarse.mbd", &text("1e-3"));
    let error = run(&["run", &coarse, "--out", &out]).expect_err("a loose tolerance");
    let told = error.to_string();
    assert!(told.contains("`direction` is off by about"), "{told}");
    let fine = folder.file("fine.mbd", &text("1e-9"));
    let told = run(&["run", &fine, "--out", &out]).expect("accurate enough");
    assert!(told.contains("the same over its largest value"), "{told}");
}

#[test]
fn a_step_that_is_too_long_sends_the_run_back_to_where_nothing_had_grown() {
    let folder = Folder::new("too_long");
    let text = "model Stiff { gravity: none; point bob { mass: 1 kg, start at [1, 0, 0] m velocity [0.1, 0, 0] m/s }
          spring s from world to bob { free_length: 1 m, stiffness: 10 kN/m } }
        [run]\nuntil = \"5 s\"\nstep = \"40 ms\"\n";
    let out = folder.0.join("out").display().to_string();
    let told = run(&["run", &folder.file("s.mbd", text), "--out", &out])
        .unwrap_err()
        .to_string();
    assert!(
        told.contains("the fixed step 0.04 s is too long")
            && told.contains("(the run went back to 0 s, where nothing had grown yet)"),
        "{told}"
    );
    assert!(!told.contains("last accepted"), "{told}");
}

#[test]
fn the_error_of_a_small_angle_is_told_over_the_angle() {
    let folder = Folder::new("small_angle");
    let out = folder.0.join("out").display().to_string();
    let text = "model P { gravity: none;
          body w { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
          joint pin: hinge from world to w.com { axis: y, stiffness: 1000 N*m, start: 1e-5 rad }
          output a = pin.angle in deg; }
        [run]\nuntil = \"10 s\"\ntolerance = 1e-6\n";
    let error = run(&["run", &folder.file("small.mbd", text), "--out", &out]);
    let told = error.expect_err("a tenth of it").to_string();
    assert!(
        told.contains("`a` is off by about") && told.contains("of its largest value"),
        "{told}"
    );
}

#[test]
fn a_start_beyond_a_stop_is_told_with_what_the_stop_pushes() {
    let folder = Folder::new("beyond_stop");
    let out = folder.0.join("out").display().to_string();
    let text = |start: &str| {
        format!(
            "model Leg {{ gravity: none;
          body piston {{ mass: 10 kg, inertia: diag(1, 1, 1) kg*m^2 }}
          joint oleo: prismatic from world to piston.com {{ axis: z, start: {start}, stops: [0, 0.35] m, stop_stiffness: 1 MN/m }}
          output stroke = oleo.slide; }}
        [run]\nuntil = \"10 ms\"\n"
        )
    };
    let told = |start: &str| {
        let file = folder.file("leg.mbd", &text(start));
        let told = run(&["run", &file, "--out", &out]);
        told.unwrap_or_else(|failure| failure.to_string())
    };
    let beyond = told("0.5 m");
    for part in [
        "`oleo.slide` starts 0.15 m beyond its high stop",
        "with 150000 N",
    ] {
        assert!(beyond.contains(part), "{part}: {beyond}");
    }
    // What a run says of its start stands beside what a scene contains, too.
    let checked = run(&["check", &folder.file("leg.mbd", &text("0.5 m"))]).expect("a scene");
    assert!(
        checked.contains("warning: `oleo.slide` starts 0.15 m beyond its high stop"),
        "{checked}"
    );
    let checked = run(&["check", &folder.file("leg.mbd", &text("0.2 m"))]).expect("a scene");
    assert!(!checked.contains("warning"), "{checked}");
    // What rests on a stop is a little beyond it.
    for start in ["0.2 m", "0.351 m"] {
        let resting = told(start);
        assert!(!resting.contains("beyond its"), "{resting}");
    }
}

#[test]
fn a_run_whose_steps_pass_over_a_pulse_says_when_and_what_to_take() {
    let folder = Folder::new("hidden_pulse");
    let out = folder.0.join("out").display().to_string();
    let text = "model Vane { gravity: [0, 0, -9.81] m/s^2; point p { mass: 1 kg, start at [0, 0, 0] m velocity [1, 0, 0] m/s }
          load gust on p = [8 N * exp(-((time - 5.0042 s) / (0.1 ms))^2), 0 N, 0 N];
          output speed = p.velocity.x; }
        [run]\nuntil = \"10 s\"\n";
    let file = folder.file("vane.mbd", text);
    let error = run(&["run", &file, "--out", &out, "--dt", "10 ms"]).unwrap_err();
    let told = error.to_string();
    assert_eq!(error.code(), 3, "{told}");
    assert!(
        told.contains("at 5.004") && told.contains("no stage of a step sees it"),
        "{told}"
    );
    let told = run(&["run", &file, "--out", &out, "--tol", "1e-8"]);
    assert!(told.is_ok_and(|told| !told.contains("warning")));
}
