//! The error of runs and campaigns is told where nothing else shows it: against closed forms.

use super::{Folder, run};

/// An oscillator of 0.1 nm at 1e5 rad/s, and one that may take no more steps than it does: both are told their error.
#[test]
fn the_error_of_a_run_is_told_whatever_its_size_and_its_budget() {
    let folder = Folder::new("always");
    let out = folder.0.join("out").display().to_string();
    let text = "model Tip { gravity: none; point p { mass: 1e-12 kg, start at [1.1e-9, 0, 0] m }
        spring s from world to p { free_length: 1e-9 m, stiffness: 0.01 N/m, damping: 0 N*s/m }
        output x = p.position.x - 1e-9 m; }
        [run]\nuntil = \"1 ms\"\nevery = \"10 us\"\n";
    let file = folder.file("tip.mbd", text);
    // RK4 lags by (h ω)⁵/120 a step: at h ω = 0.1 by 8.3e-5 rad after 1000 steps.
    for budget in ["2000000", "1000"] {
        let arguments = [
            "run",
            &file,
            "--out",
            &out,
            "--dt",
            "1 us",
            "--max-steps",
            budget,
            "--json",
        ];
        let told = run(&arguments).unwrap_or_else(|error| panic!("{error}"));
        let summary: serde_json::Value = serde_json::from_str(&told).unwrap();
        let error = &summary["error_estimate"]["relative"];
        let error = error
            .as_f64()
            .unwrap_or_else(|| panic!("{budget}: {error}"));
        // The root of the mean of (φ sin)² with φ rising to 8.3e-5: /√6.
        assert!((error / 3.4e-5 - 1.0).abs() < 0.2, "{budget}: {error}");
    }
}

/// An orbit of e = 0.9: a² at a tolerance that keeps nothing of it. A run said so, and a campaign of twenty of them did not.
#[test]
fn a_campaign_tells_the_error_of_its_cases() {
    let folder = Folder::new("campaign_error");
    let text = "model Orbit { gravity: point_mass { mu: 4e14 m^3/s^2, center: [0, 0, 0] m };
          param v = 1450 m/s in 1 km/s ..= 5 km/s;
          point p { mass: 1 kg, start at [-1.9e7, 0, 0] m velocity [0, -v, 0] m/s }
          metric furthest = max norm(p.position); metric fastest = max norm(p.velocity); }
        [run]\nuntil = \"10 h\"\nmethod = \"tsit5\"\ntolerance = 1e-2
        [run.scales]\nlength = \"1e7 m\"\nspeed = \"6.3 km/s\"\n";
    let cases = "cases = 20\n[params]\nv = { dist = \"normal\", sigma = \"1 m/s\" }\n";
    let file = folder.file("orbit.mbd", text);
    let given = folder.file("cases.toml", cases);
    let out = |name: &str| folder.0.join(name).display().to_string();
    let error = run(&["campaign", &file, &given, "--out", &out("loose")]).unwrap_err();
    let told = error.to_string();
    assert_eq!(error.code(), 3, "{told}");
    assert!(
        told.contains("warning: case 0 flown again with finer steps: `f"),
        "{told}"
    );
    assert!(told.contains("take a tighter tolerance"), "{told}");
    // Where it is right the error is told without a warning, and the furthest place is where it starts: r = a (1 + e).
    let tight = folder.file("tight.toml", &format!("{cases}[run]\ntolerance = 1e-9\n"));
    let told = run(&["campaign", &file, &tight, "--out", &out("tight")]).unwrap();
    assert!(
        !told.contains("warning") && told.contains("case 0 flown again"),
        "{told}"
    );
    assert!(told.contains("nominal 1.9000e7"), "{told}");
    // Who asks for no estimate has none; what the steps made of the energy is told all the same.
    let none = folder.file("none.toml", &format!("{cases}[run]\nestimate = false\n"));
    let error = run(&["campaign", &file, &none, "--out", &out("none")]).unwrap_err();
    let told = error.to_string();
    assert_eq!(error.code(), 3, "{told}");
    assert!(!told.contains("flown again"), "{told}");
    assert!(
        told.contains("21 × energy_unbalanced: case 0: its steps made or lost 60"),
        "{told}"
    );
}

/// An oscillator, x = 0.1 m cos(ω t), whose steps end on events every 20 ms, ω h = 0.6: a tighter tolerance alone makes the same steps again, and their error
/// is in both runs.
#[test]
fn a_case_of_a_campaign_is_flown_again_with_finer_steps_where_events_end_them() {
    let folder = Folder::new("campaign_ticks");
    let text = "model Ticks { gravity: none; param k = 900 N/m in 1 N/m ..= 1 kN/m;
          point bob { mass: 1 kg, start at [0.1, 0, 0] m }
          load pull on bob = -k * bob.position;
          event tick = sin(100 rad/s * pi * time) rises 0;
          metric last = final bob.position.x; }
        [run]\nuntil = \"4 s\"\nmethod = \"tsit5\"\ntolerance = 1e-3\n";
    let cases =
        "cases = 3\n[params]\nk = { dist = \"uniform\", low = \"890 N/m\", high = \"900 N/m\" }\n";
    let file = folder.file("ticks.mbd", text);
    let given = folder.file("cases.toml", cases);
    let out = folder.0.join("out");
    let place = out.display().to_string();
    let told = run(&["campaign", &file, &given, "--out", &place]).unwrap();
    let row = std::fs::read_to_string(out.join("cases.csv")).unwrap();
    let row = row.lines().nth(1).unwrap();
    let last: f64 = row.split(',').nth(4).unwrap().parse().unwrap();
    let error = (last - 0.1 * (120.0_f64).cos()).abs();
    let off = told
        .split("is off by about ")
        .nth(1)
        .unwrap_or_else(|| panic!("{told}"));
    let off: f64 = off.split(' ').next().unwrap().parse().unwrap();
    assert!(
        error > 1e-7 && off < 3.0 * error && error < 3.0 * off,
        "{off} {error} {row}"
    );
    // What a shard or `gather` does not know they say.
    let part = folder.0.join("part").display().to_string();
    let told = run(&["campaign", &file, &given, "--out", &part, "--shard", "1/2"]).unwrap();
    assert!(
        told.contains("the error of the cases is not estimated: a shard has"),
        "{told}"
    );
    let told = run(&["gather", &place]).unwrap();
    assert!(
        told.contains("the error of the cases is not estimated: `campaign` with"),
        "{told}"
    );
}

/// A mass that comes to rest on a damped stop: forces cancel there, and what rounding leaves of them is no instability of a step of h ω = 0.01.
#[test]
fn what_has_come_to_rest_under_rattle_is_not_called_unstable() {
    let folder = Folder::new("rest");
    let out = folder.0.join("out").display().to_string();
    let text = "model Rest { gravity: [0, 0, -9.81] m/s^2;
        body block { mass: 1000 kg, inertia: diag(1, 1, 1) kg*m^2 }
        joint rail: prismatic from world to block.com { axis: z, start: 0 m, stops: [0 m, none], stop_stiffness: 1e9 N/m, stop_damping: 1e5 N*s/m }
        metric depth = final rail.slide in um; }
        [run]\nuntil = \"0.6 s\"\nmethod = \"rattle\"\nstep = \"10 us\"\nestimate = false\n";
    let file = folder.file("rest.mbd", text);
    let told = run(&["run", &file, "--out", &out]).unwrap_or_else(|error| panic!("{error}"));
    // m g / K = 9.81 µm.
    assert!(told.contains("-9.81"), "{told}");
}

/// A rotor whose angle a force along a rail follows: v = sin(ω t)/ω, and the rail knows no more of the rotor.
fn rotor(turns_a_second: u32) -> String {
    format!(
        "model Rotor {{ gravity: none; coordinates: relative;
           body wheel {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
           body sled {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
           joint pin: hinge from world to wheel.com {{ axis: z, start_rate: 2 * pi * {turns_a_second} rad/s }}
           joint rail: prismatic from world to sled.com {{ axis: x }}
           load push on sled = [1 N * cos(pin.angle), 0, 0];
           output speed = rail.slide_rate; }}
         [run]\nuntil = \"0.2 s\"\nevery = \"10 ms\"\n"
    )
}

/// At 1000 turns a second a step of 1 ms sees the angles 0, π and 2π: a force of −1/3 N that pushes for ever, where there is none; one of a quarter sees none. At
/// 8000 both see a force of 1 N.
#[test]
fn a_fixed_step_that_turns_a_rotor_from_stage_to_stage_is_told() {
    let folder = Folder::new("rotor");
    let out = folder.0.join("out").display().to_string();
    for turns in [1000, 8000] {
        let file = folder.file("rotor.mbd", &rotor(turns));
        let error = run(&["run", &file, "--out", &out, "--dt", "1 ms"]).unwrap_err();
        let told = error.to_string();
        assert_eq!(error.code(), 3, "{told}");
        let what = match turns {
            1000 => "`speed` is off by about",
            _ => "no stage of a step sees it",
        };
        assert!(told.contains(what), "{turns}: {told}");
    }
    // A wheel in balance turns by any angle in a step.
    let balanced = rotor(8000).replace("1 N * cos(pin.angle)", "1 N");
    let file = folder.file("balanced.mbd", &balanced);
    let told = run(&["run", &file, "--out", &out, "--dt", "1 ms"]);
    assert!(
        told.as_ref().is_ok_and(|told| !told.contains("warning")),
        "{told:?}"
    );
}

/// The same rotor at rest, with a torque that makes it turn by half a turn a step after 1047 of them: it is told at the next fiftieth step, not at the 2048th.
#[test]
fn a_rotor_that_spins_up_is_told_soon_after_steps_overlook_it() {
    let folder = Folder::new("spin_up");
    let out = folder.0.join("out").display().to_string();
    let text = rotor(0).replace(
        "axis: z, start_rate: 2 * pi * 0 rad/s",
        "axis: z, force: 3000 N*m",
    );
    let file = folder.file("spin_up.mbd", &text.replace("0.2 s", "1.3 s"));
    let error = run(&["run", &file, "--out", &out, "--dt", "1 ms", "--no-estimate"]).unwrap_err();
    let told = error.to_string();
    assert_eq!(error.code(), 3, "{told}");
    let at = told
        .split("what acts changes at ")
        .nth(1)
        .unwrap_or_else(|| panic!("{told}"));
    let at: f64 = at.split(' ').next().unwrap().parse().unwrap();
    assert!((1.04..1.2).contains(&at), "{at}");
}

/// A phase that is a declared state, on what the ground holds, where no momentum tells: the same.
#[test]
fn a_fixed_step_that_turns_a_declared_phase_from_stage_to_stage_is_told() {
    let folder = Folder::new("phase");
    let out = folder.0.join("out").display().to_string();
    let text = "model Phase { gravity: none;
        body sled { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
        joint rail: prismatic from world to sled.com { axis: x, force: 1 N * cos(phase) }
        state phase: angle = 0 { rate: 2 * pi * 8000 rad/s }
        output speed = rail.slide_rate; }
        [run]\nuntil = \"0.2 s\"\n";
    let file = folder.file("phase.mbd", text);
    let error = run(&["run", &file, "--out", &out, "--dt", "1 ms"]).unwrap_err();
    let told = error.to_string();
    assert!(
        error.code() == 3 && told.contains("no stage of a step sees it"),
        "{told}"
    );
    // Steps that see it are not warned of it: 40 of them a turn.
    let slow = text.replace("8000", "25");
    let file = folder.file("slow.mbd", &slow);
    let told = run(&["run", &file, "--out", &out, "--dt", "1 ms"]);
    assert!(
        told.as_ref().is_ok_and(|told| !told.contains("warning")),
        "{told:?}"
    );
}

/// A filter of 0.1 ms under steps of 1 ms: the factor of a step is 1 − 10 + 50 − 167 + 417, and no energy tells.
#[test]
fn a_fixed_step_that_is_too_long_for_a_declared_state_is_found_before_the_damage() {
    let folder = Folder::new("filter");
    let out = folder.0.join("out").display().to_string();
    let text = "model Filter { gravity: none; point p { mass: 1 kg, start at [0, 0, 0] m velocity [1, 0, 0] m/s }
        state seen = 0 m { rate: (p.position.x - seen) / (0.1 ms) }
        output late = seen in mm; }
        [run]\nuntil = \"20 ms\"\nestimate = false\n";
    let file = folder.file("filter.mbd", text);
    let error = run(&["run", &file, "--out", &out, "--dt", "1 ms"]).unwrap_err();
    let told = error.to_string();
    assert_eq!(error.code(), 4, "{told}");
    for part in ["too long: step times rate is 10.0", "went back to 0 s"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    // It lags by its time, 0.1 ms at 1 m/s.
    let told = run(&["run", &file, "--out", &out, "--dt", "0.1 ms", "--json"]).unwrap();
    assert!(told.contains("\"late\": 19.9"), "{told}");
    // The integral of what swings has turning points, and nothing that grows: 20 steps a period.
    let swing = "model Swing { gravity: none; point p { mass: 1 kg, start at [1.1, 0, 0] m }
        spring s from world to p { free_length: 1 m, stiffness: 100 N/m, damping: 0 N*s/m }
        state missed: m*s = 0 { rate: p.position.x - 1 m }
        output sum = 1e3 * missed; }
        [run]\nuntil = \"10 s\"\nestimate = false\n";
    let file = folder.file("swing.mbd", swing);
    run(&["run", &file, "--out", &out, "--dt", "30 ms"]).unwrap_or_else(|error| panic!("{error}"));
}

/// A state that settles slowly, s = exp(−t), until step 17 makes it decay at 50 /s or far faster under steps of 0.1 s: by h λ = 5 it grows by 14 a step, by 1e40 at
/// once. What is kept is from before: the state after ten steps.
#[test]
fn a_declared_state_that_becomes_stiff_on_the_way_is_found_with_a_state_from_before_it() {
    let folder = Folder::new("late_stiff");
    for fast in ["50", "1e6", "1e40"] {
        let text = format!(
            "model Late {{ gravity: none; point p {{ mass: 1 kg, start at [0, 0, 0] m velocity [1, 0, 0] m/s }}
               state s = 1 {{ rate: -(if time > 1.65 s {{ {fast} }} else {{ 1 }}) * s / (1 s) }}
               output kept = s; }}
             [run]\nuntil = \"20 s\"\nestimate = false\n"
        );
        let file = folder.file("late.mbd", &text);
        let out = folder.0.join("out");
        let place = out.display().to_string();
        let error = run(&["run", &file, "--out", &place, "--dt", "0.1 s"]).unwrap_err();
        let told = error.to_string();
        assert_eq!(error.code(), 4, "{fast}: {told}");
        assert!(
            told.contains("too long") && told.contains("went back to 1 s"),
            "{fast}: {told}"
        );
        let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
        let place = |name: &str| {
            history
                .lines()
                .next()
                .unwrap()
                .split(',')
                .position(|it| it.starts_with(name))
        };
        let last: Vec<&str> = history.lines().last().unwrap().split(',').collect();
        let kept: f64 = last[place("kept").unwrap()].parse().unwrap();
        assert!((kept - (-1.0_f64).exp()).abs() < 1e-6, "{fast}: {kept}");
    }
}

/// A parallelogram turns evenly through its flat position, φ = 0.3 + 3 t, where its rows lose rank. How the forces in its joints change off their motion grows like
/// 1/cos² φ there: a stiff method at a tight tolerance ends before it, and says what passes.
#[test]
fn what_the_stiff_method_cannot_pass_it_says_others_do() {
    let folder = Folder::new("flat");
    let out = folder.0.join("out").display().to_string();
    let text = "model Flat { coordinates: absolute; gravity: none; world { frame right at [2, 0, 0] m }
        body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame low at [0, 0, -0.5] m, frame high at [0, 0, 0.5] m }
        body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame low at [0, 0, -0.5] m, frame high at [0, 0, 0.5] m }
        body c { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame left at [-1, 0, 0] m, frame right at [1, 0, 0] m }
        joint p: hinge from world to a.low { axis: y, start: 0.3 rad, start_rate: 3 rad/s }
        joint q: hinge from world.right to b.low { axis: y, start: 0.3 rad }
        joint r: hinge from a.high to c.left { axis: y } joint s: hinge from b.high to c.right { axis: y }
        metric off = max abs(c.com.position.x - 1 m - sin(0.3 rad + 3 rad/s * time) * 1 m); }
        [run]\nuntil = \"1 s\"\nestimate = false\n";
    let file = folder.file("flat.mbd", text);
    let flown = |method: &str| {
        run(&[
            "run", &file, "--out", &out, "--method", method, "--tol", "1e-9", "--json",
        ])
    };
    let told = flown("rodas5p").unwrap_err().to_string();
    assert!(
        told.contains("take `tsit5`, `vern7` or `auto`, which pass it"),
        "{told}"
    );
    for method in ["tsit5", "vern7", "auto"] {
        let told = flown(method).unwrap_or_else(|error| panic!("{method}: {error}"));
        let off = told
            .split("\"off\": ")
            .nth(1)
            .and_then(|rest| rest.split([',', '\n']).next());
        let off: f64 = off
            .and_then(|off| off.trim().parse().ok())
            .unwrap_or(f64::NAN);
        assert!(off < 1e-7, "{method}: {off} {told}");
    }
}

/// A floor of 1 MN/m that is a load, under a mass of 1 kg: it sinks in by m g/K = 9.81 µm. A thousand kilometres from the origin positions are 0.1 nm apart, and that
/// is right; at a million they are 0.1 µm apart, and further out nothing is left: told, or refused.
#[test]
fn a_contact_that_is_a_load_is_not_believed_far_from_the_origin() {
    let folder = Folder::new("far_floor");
    let out = folder.0.join("out").display().to_string();
    for (far, code) in [("1e6", 0), ("1e9", 4), ("1e12", 4)] {
        let text = format!(
            "model Floor {{ gravity: [0, 0, -9.81] m/s^2; const Z = {far} m;
               point p {{ mass: 1 kg, start at [0 m, 0 m, Z + 1 mm] }}
               load floor on p = if(p.position.z < Z, [0, 0, 1], [0, 0, 0]) * (1e6 N/m * (Z - p.position.z) - 1e3 N*s/m * p.velocity.z);
               metric last = final Z - p.position.z in um; }}
             [run]\nuntil = \"0.2 s\"\n"
        );
        let file = folder.file("floor.mbd", &text);
        let ended = run(&["run", &file, "--out", &out, "--tol", "1e-6"]);
        let (found, told) = match &ended {
            Ok(told) => (0, told.clone()),
            Err(error) => (error.code(), error.to_string()),
        };
        assert_eq!(found, code, "{far}: {told}");
        match code {
            0 => assert!(told.contains("9.8"), "{told}"),
            _ => assert!(
                told.contains("known to") || told.contains("more digits"),
                "{told}"
            ),
        }
    }
}

/// A point of 1 µg between a mass of 1 kg and the wall, on dampers: λ = 2c/m = 2e7 1/s, and steps of 3.5/λ whatever the tolerance. More steps are no remedy.
#[test]
fn a_light_point_beside_a_heavy_one_is_called_stiff_and_fast_swings_are_not() {
    let folder = Folder::new("light");
    let out = folder.0.join("out").display().to_string();
    let text = "model Light { gravity: none; point a { mass: 1 kg, start at [1, 0, 0] m } point m { mass: 1e-9 kg, start at [0.5, 0, 0] m }
        spring s from world to m { free_length: 0.45 m, stiffness: 200 N/m, damping: 0.01 N*s/m }
        spring r from m to a { free_length: 0.45 m, stiffness: 200 N/m, damping: 0.01 N*s/m }
        output x = a.position.x; }
        [run]\nuntil = \"3 s\"\nmax_steps = 5000\nestimate = false\n";
    let file = folder.file("light.mbd", text);
    for (method, tolerance) in [
        ("tsit5", "1e-3"),
        ("tsit5", "1e-6"),
        ("tsit5", "1e-9"),
        ("vern7", "1e-6"),
        ("vern7", "1e-9"),
    ] {
        let arguments = [
            "run", &file, "--out", &out, "--method", method, "--tol", tolerance,
        ];
        let told = run(&arguments).unwrap_err().to_string();
        for part in ["stiff", "velocity of m", "rodas5p"] {
            assert!(told.contains(part), "{method} {tolerance}: {part}: {told}");
        }
    }
    // 2c/m = 0: it swings at 6.3e5 rad/s, and steps follow that.
    let swings = text
        .replace("0.01 N*s/m", "0 N*s/m")
        .replace("[0.5, 0, 0]", "[0.55, 0, 0]");
    let file = folder.file("swings.mbd", &swings);
    let told = run(&[
        "run", &file, "--out", &out, "--method", "tsit5", "--tol", "1e-6",
    ]);
    let told = told.unwrap_err().to_string();
    assert!(!told.contains("stiff"), "{told}");
}
