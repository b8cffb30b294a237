//! What stands beside the model, mistyped: settings of the run, params and inputs of the command line, windows of metrics, starts that close no loop.

use super::*;

const PENDULUM: &str = "pub model Pendulum {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    param k = 2 N*m in 1 N*m ..= 3 N*m;
    param spin = 18 rad/s;
    input push: force = 0 N;
    input wind: [speed; 3];
    body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
    joint pin: hinge from world to rod.top { axis: y, start: 30 deg, stiffness: k }
    load blow on rod = [push, 0 N, 0 N] + 1 kg/s * wind + [k * 0 * spin * (1 s/m), 0 N, 0 N];
    metric late = max pin.angle { from: 5 s }
    metric long = max pin.angle { from: 0.5 s, to: 20 s }
    metric whole = max pin.angle { to: 1 s }
}
";

#[test]
fn params_and_inputs_of_the_command_line_are_answered_with_where_they_belong() {
    let folder = Folder::new("slips");
    let out = folder.0.join("out").display().to_string();
    let file = folder.file(
        "pendulum.mbd",
        &format!("{PENDULUM}\n[run]\nuntil = \"1 s\"\n"),
    );
    for (set, said) in [
        ("push=", "write it as NAME=VALUE"),
        ("=3", "write it as NAME=VALUE"),
        ("push=3 N", "stands under [run.inputs], `push = \"1 N\"`"),
        (
            "wind=[1, 0, 0] m/s",
            "stands under [run.inputs], `wind = \"[1, 0, 0] m/s\"`",
        ),
        ("spin=3 Hz", "`Hz` counts turns"),
        ("k=", "write it as NAME=VALUE"),
    ] {
        let told = run(&["run", &file, "--out", &out, "--set", set]).unwrap_err();
        assert!(told.to_string().contains(said), "{set}: {told}");
    }
    let told = run(&["run", &file, "--out", &out, "--input", "k=1 N*m"]).unwrap_err();
    let said = "is a param and no input: its value stands under [run.params], `k = \"2 N*m\"`";
    assert!(told.to_string().contains(said), "{told}");
}

#[test]
fn an_input_of_the_command_line_is_that_of_the_file() {
    let folder = Folder::new("given_inputs");
    let out = folder.0.join("out").display().to_string();
    let flown = |table: &str, flags: &[&str]| {
        let text = format!("{PENDULUM}\n[run]\nuntil = \"0.1 s\"\n{table}");
        let file = folder.file("pendulum.mbd", &text);
        let mut all = vec!["run", &file, "--out", &out, "--json", "--no-estimate"];
        all.extend(flags);
        run(&all).map(|_| std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap())
    };
    let want = flown("[run.inputs]\npush = \"3 N\"\n", &[]).unwrap();
    assert_eq!(flown("", &["--input", "push=3 N"]).unwrap(), want);
    assert_ne!(flown("", &[]).unwrap(), want);
    // The command line counts before the file.
    let other = "[run.inputs]\npush = \"7 N\"\n";
    assert_eq!(flown(other, &["--input", "push=3N"]).unwrap(), want);
    let wind = flown("[run.inputs]\nwind = \"[9, 0, 0] m/s\"\n", &[]).unwrap();
    assert_eq!(flown("", &["--input", "wind=[9, 0, 0] m/s"]).unwrap(), wind);
    for (flags, said) in [
        (
            vec!["--input", "push"],
            "write it as NAME=VALUE, such as push=5N",
        ),
        (vec!["--input", "psuh=1 N"], "did you mean `push`?"),
        (
            vec!["--input", "push=1 N", "--input", "push=2 N"],
            "gives `push` twice",
        ),
        (
            vec!["--set", "k=2 N*m", "--set", "k=1 N*m"],
            "gives `k` twice",
        ),
    ] {
        let told = flown("", &flags).unwrap_err().to_string();
        assert!(told.contains(said), "{flags:?}: {told}");
    }
}

/// Nearest to 120 deg a pendulum rests upside down; what its damping leads to is the rest below.
#[test]
fn a_rest_after_a_run_is_the_one_that_the_motion_comes_to() {
    let folder = Folder::new("after");
    let text = "model Swing { gravity: [0.0, 0.0, -9.81] m/s^2;
        body rod { mass: 2 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
        joint pin: hinge from world to rod.top { axis: y, damping: 2 N*m*s, start: 120 deg } }";
    let file = folder.file("swing.mbd", text);
    let rest = |more: &[&str]| {
        let told = run(&[&["linearise", &file, "--trim", "--json"], more].concat()).unwrap();
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        let values = told["rest"]["coordinates"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        let angle = values.iter().find(|it| it["name"] == "pin.angle");
        angle
            .and_then(|it| it["value"].as_f64())
            .unwrap_or_else(|| panic!("{told}"))
    };
    assert!((rest(&[]).abs() - std::f64::consts::PI).abs() < 1e-9);
    assert!(rest(&["--after", "20s"]).abs() < 1e-9);
    let unstable = "note: this rest is unstable: what leaves it grows by a factor of e in 0.369 s";
    assert!(
        run(&["linearise", &file, "--trim"])
            .unwrap()
            .contains(unstable)
    );
    let stable = run(&["linearise", &file, "--trim", "--after", "20s"]).unwrap();
    assert!(!stable.contains("unstable"), "{stable}");
    let moving = run(&["linearise", &file, "--after", "0.3s"]).unwrap();
    assert!(moving.contains("about the motion after 0.3s"), "{moving}");
    let wrong = run(&["linearise", &file, "--after", "3 m"]).unwrap_err();
    assert!(wrong.to_string().contains("`--after`"), "{wrong}");
}

#[test]
fn a_rest_is_told_with_its_coordinates_and_begins_where_it_is_guessed() {
    let folder = Folder::new("rests");
    let file = folder.file("pendulum.mbd", PENDULUM);
    let told = run(&["linearise", &file, "--trim"]).unwrap();
    let value = |told: &str| -> f64 {
        let line = told
            .lines()
            .find(|line| line.trim_start().starts_with("pin.angle "));
        let last = line.and_then(|line| line.split_whitespace().last());
        last.and_then(|last| last.parse().ok()).expect(told)
    };
    assert!(value(&told).abs() < 1e-9, "{told}");
    // Wound up beyond half a turn: k θ + m g l sin θ = 0 at 4.149 rad.
    let set = [
        "linearise",
        &file,
        "--trim",
        "--set",
        "k=1 N*m",
        "--guess",
        "pin.angle=230 deg",
    ];
    let told = run(&set).unwrap();
    let angle = value(&told);
    assert!(
        (angle + 4.905 * angle.sin()).abs() < 1e-3 && angle > 4.0,
        "{told}"
    );
    for guess in ["pin.angle=150", "pin.angle=2 m", "pin.angle_rate=1 rad"] {
        let wrong = run(&["linearise", &file, "--trim", "--guess", guess]).unwrap_err();
        let said = "give it in the unit of its coordinate";
        assert!(wrong.to_string().contains(said), "{guess}: {wrong}");
    }
    for name in ["--guess", "--fix", "--rate"] {
        let wrong = run(&["linearise", &file, "--trim", name, "pin.agle=1 rad"]).unwrap_err();
        let said = "did you mean `pin.angle`?";
        assert!(wrong.to_string().contains(said), "{name}: {wrong}");
    }
    // The name of the joint is that of its one coordinate; 2 N at 0.5 m against the spring and the weight.
    let pushed = [
        "linearise",
        &file,
        "--trim",
        "--guess",
        "pin=10 deg",
        "--input",
        "push=2 N",
    ];
    let angle = value(&run(&pushed).unwrap());
    let moment = angle * 2.0 + 4.905 * angle.sin() + angle.cos();
    assert!(moment.abs() < 1e-3 && angle.abs() > 0.1, "{angle}");
    let wrong = run(&["linearise", &file, "--trim", "--guess", "pin.angle"]).unwrap_err();
    assert!(
        wrong.to_string().contains("write it as NAME=VALUE"),
        "{wrong}"
    );
}

#[test]
fn three_numbers_of_an_input_are_one_vector_or_three_texts() {
    let folder = Folder::new("vectors");
    let out = folder.0.join("out").display().to_string();
    let flown = |wind: &str| {
        let text = format!("{PENDULUM}\n[run]\nuntil = \"0.1 s\"\n[run.inputs]\nwind = {wind}\n");
        let file = folder.file("pendulum.mbd", &text);
        run(&["run", &file, "--out", &out, "--json", "--no-estimate"])
    };
    let state = |wind: &str| {
        flown(wind).unwrap();
        std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap()
    };
    let vector = state("\"[36, 0, 0] km/h\"");
    assert_eq!(vector, state("[\"10 m/s\", 0, 0]"));
    assert_eq!(vector, state("\"[10 m/s, 0, 0]\""));
    assert_ne!(vector, state("\"[9, 0, 0] m/s\""));
    for (wind, said) in [
        (
            "\"10 m/s\"",
            "write them in brackets, such as `\"[1, 0, 0] m/s\"`",
        ),
        ("\"[10, 0] m/s\"", "expected 3 numbers, found 2"),
        ("\"[10, 0, 0] N\"", "wrong unit"),
    ] {
        let told = flown(wind).unwrap_err().to_string();
        assert!(told.contains(said), "{wind}: {told}");
    }
}

/// The same of a run that an event ends.
#[test]
fn metrics_that_count_beyond_the_event_that_ends_the_run_are_told() {
    let folder = Folder::new("window_and_event");
    let out = folder.0.join("out").display().to_string();
    let file = folder.file(
        "stone.mbd",
        "model Stone { gravity: [0, 0, -10] m/s^2; point stone { mass: 1 kg, start at [0, 0, 5] m }
            event down = stone.position.z falls 0 m { then: stop }
            metric fallen = integral stone.velocity.z { to: 3 s };
            metric early = integral stone.velocity.z { to: 0.5 s }; }
         [run]\nuntil = \"4 s\"\n",
    );
    let told = run(&["run", &file, "--out", &out]).unwrap();
    let warning = "metric `fallen` counts up to 3 s, and the run ends at 1";
    assert!(
        told.contains(warning) && !told.contains("metric `early`"),
        "{told}"
    );
    let page = std::fs::read_to_string(format!("{out}/report.html")).unwrap();
    assert!(page.contains("counts up to 3 s, and the run ends at 1"));
}

#[test]
fn metrics_that_count_beyond_the_end_of_the_run_are_told() {
    let folder = Folder::new("windows");
    let out = folder.0.join("out").display().to_string();
    let file = folder.file(
        "pendulum.mbd",
        &format!("{PENDULUM}\n[run]\nuntil = \"1 s\"\n"),
    );
    for told in [
        run(&["check", &file]).unwrap(),
        run(&["run", &file, "--out", &out]).unwrap(),
    ] {
        assert!(
            told.contains("warning: metric `late` counts from 5 s on, and the run ends at 1 s"),
            "{told}"
        );
        assert!(
            told.contains("warning: metric `long` counts up to 20 s, and the run ends at 1 s"),
            "{told}"
        );
        assert!(!told.contains("metric `whole`"), "{told}");
    }
    let told = run(&["run", &file, "--out", &out, "--until", "30"]).unwrap();
    assert!(!told.contains("warning"), "{told}");
}

#[test]
fn a_misspelt_table_of_the_run_is_told_with_its_line() {
    let folder = Folder::new("tables");
    let file = folder.file(
        "pendulum.mbd",
        &format!("{PENDULUM}\n[rnu]\nuntil = \"1 s\"\n"),
    );
    let told = run(&["check", &file]).unwrap_err().to_string();
    assert!(
        told.contains(
            "pendulum.mbd:15:2: there is no table `[rnu]` behind a declaration; did you mean `[run]`?"
        ) && told.ends_with("1 error"),
        "{told}"
    );
}

/// A crank of 1 m, a rod of 3 m and a slider that is to start 9 m away.
#[test]
fn a_loop_that_nothing_closes_is_told_with_its_joint_when_it_is_checked_and_flown() {
    let folder = Folder::new("open_loop");
    let body = "mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2";
    let file = folder.file(
        "crank.mbd",
        &format!(
            "model Crank {{
    gravity: none;
    body crank {{ {body}, frame l at [-0.5, 0, 0] m, frame r at [0.5, 0, 0] m }}
    body rod {{ {body}, frame l at [-1.5, 0, 0] m, frame r at [1.5, 0, 0] m }}
    body slider {{ {body} }}
    joint bearing: hinge from world to crank.l {{ axis: y, start: 60 deg }}
    joint pin: hinge from crank.r to rod.l {{ axis: y }}
    joint end: hinge from rod.r to slider.com {{ axis: y }}
    joint guide: prismatic from world to slider.com {{ axis: x, start: 9 m }}
}}
[run]
until = \"1 s\"
"
        ),
    );
    // Bars that cannot meet, of which nobody says where they start: a run would find it, and so does the check.
    let short = folder.file(
        "short.mbd",
        &format!(
            "model Short {{ gravity: none; world {{ frame far at [2, 0, 0] m }}
    body a {{ {body}, frame l at [-0.1, 0, 0] m, frame r at [0.1, 0, 0] m }}
    body b {{ {body}, frame l at [-0.2, 0, 0] m, frame r at [0.2, 0, 0] m }}
    joint one: hinge from world to a.l {{ axis: z }}
    joint two: hinge from a.r to b.l {{ axis: z }}
    joint three: spherical from b.r to world.far;
}}"
        ),
    );
    let told = run(&["check", &short]).unwrap_err().to_string();
    assert!(
        told.contains("`two` stays open by 1.4 m; give a joint of each"),
        "{told}"
    );
    for command in ["check", "run"] {
        let told = run(&[command, &file]).unwrap_err().to_string();
        assert!(
            told.contains("joint `end` stays open by 5.5 m: ")
                && told
                    .contains("leave out a start there, say `about` before one that may give way"),
            "{told}"
        );
    }
}

/// An orbit of 7000 km: a tolerance over metres asks for digits that nobody wants.
#[test]
fn a_run_says_what_its_tolerance_is_relative_to() {
    let folder = Folder::new("scales");
    let out = folder.0.join("out").display().to_string();
    let orbit = |scales: &str| {
        folder.file(
            "orbit.mbd",
            &format!(
                "model Orbit {{ gravity: point_mass {{ mu: 398600.4418 km^3/s^2, center: [0, 0, 0] m }};
                    point craft {{ mass: 1 kg, start at [7000, 0, 0] km velocity [0, 7.546053290107542, 0] km/s }} }}
                 [run]\nuntil = \"5828.516638 s\"\nmethod = \"vern7\"\ntolerance = 1e-9\n{scales}"
            ),
        )
    };
    let flown = |scales: &str| {
        let file = orbit(scales);
        let told = run(&["run", &file, "--out", &out, "--json", "--no-estimate"]).unwrap();
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        let rows = std::fs::read_to_string(format!("{out}/history.csv")).unwrap();
        let last = rows.lines().last().unwrap();
        let x: f64 = last.split(',').nth(1).unwrap().parse().unwrap();
        // A circle, whose period is 2π √(r³/μ): [km]
        (told["steps"].as_u64().unwrap(), (x - 7e6).abs() / 7e6)
    };
    let (steps, _) = flown("");
    let (few, off) = flown("[run.scales]\nlength = \"7000 km\"\nspeed = \"7.5 km/s\"\n");
    assert!(5 * few < steps && off < 1e-7, "{few} {steps} {off}");
    for (scales, said) in [
        (
            "lenght = \"1 km\"",
            "there is no scale `lenght`; did you mean `length`?",
        ),
        ("length = \"7000 km\"", "give `length` and `speed` together"),
        ("length = \"7000 s\"\nspeed = \"1 m/s\"", "wrong unit"),
        ("angle = \"0 deg\"", "must be positive"),
    ] {
        let file = orbit(&format!("[run.scales]\n{scales}\n"));
        let error = run(&["run", &file, "--out", &out]).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
}

#[test]
fn a_number_without_a_unit_in_the_settings_is_told_with_its_line_where_it_is_seldom_meant() {
    let folder = Folder::new("slips_bare");
    let model = "model M { gravity: none; param k = 2 kN*m; body rod { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
        joint pin: hinge from world to rod.com { axis: y, stiffness: k } }\n[run]\nuntil = \"1 s\"\n";
    for (table, said) in [
        (
            "[run.start]\npin.angle = 30\n",
            "m.mbd:6:1: `start.pin.angle`: 30 has no unit",
        ),
        (
            "[run.params]\nk = 3\n",
            "m.mbd:6:1: `params.k`: 3 has no unit",
        ),
    ] {
        let file = folder.file("m.mbd", &format!("{model}{table}"));
        for command in ["check", "run"] {
            let error = run(&[command, &file]).unwrap_err();
            assert_eq!(error.code(), 2);
            assert!(error.to_string().contains(said), "{error}");
            let line = table.lines().nth(1).unwrap();
            let shown = format!(" 6 | {line}\n   | ^");
            assert!(error.to_string().contains(&shown), "{error}");
        }
    }
}

#[test]
fn a_word_that_was_read_as_a_unit_is_told_beside_the_mistake_that_comes_of_it() {
    let folder = Folder::new("slips_hour");
    let text = "model M { gravity: none; const J = 1 kg*m^2; point p { mass: 1 kg }
        let h = 3 mm; let turn = 2 kg * 9.81 m/s^2 * h / (J + J); output err = 1 - turn * time^2; }";
    let file = folder.file("m.mbd", text);
    for command in ["check", "run"] {
        let error = run(&[command, &file]).unwrap_err().to_string();
        assert!(error.contains("only like quantities"), "{error}");
        let note = "\nnote: `h` in `m/s^2*h` is the unit, not the let `h`\n1 error";
        assert!(error.ends_with(note), "{error}");
    }
}

#[test]
fn an_output_that_is_no_number_is_told_and_the_run_goes_on() {
    let folder = Folder::new("no_number");
    let out = folder.0.join("out").display().to_string();
    let file = folder.file(
        "stone.mbd",
        "model Stone { gravity: [0, 0, -10] m/s^2; point stone { mass: 1 kg }
            output ratio = stone.velocity.z / stone.position.x;
            output way = stone.velocity / norm(stone.velocity);
            output speed = norm(stone.velocity); }
         [run]\nuntil = \"1 s\"\nevery = \"0.1 s\"\n",
    );
    let told = run(&["run", &file, "--out", &out]).unwrap();
    for said in [
        "warning: `ratio` is no finite number in 11 of 11 rows, from 0 s on, `way.x` is no finite number at 0 s",
        "and one column more",
    ] {
        assert!(told.contains(said), "{told}");
    }
    assert!(!told.contains("`speed` is no"), "{told}");
    let read = |name: &str| std::fs::read_to_string(format!("{out}/{name}")).unwrap();
    assert!(read("report.html").contains("is no finite number in 11 of 11 rows"));
    assert!(read("summary.json").contains("\"column\": \"ratio\""));
}

#[test]
fn a_setting_behind_the_header_of_a_table_is_told_to_stand_before_it() {
    let folder = Folder::new("settings_in_tables");
    let text = "model A { gravity: none; param m = 1 kg; input push: force = 0 N;
          point p { mass: m, start at [0, 0, 0] m } load f on p = [push, 0 N, 0 N]; }
        [run]\nuntil = \"1 s\"\n";
    for (table, setting) in [
        ("start", "every = \"10 ms\""),
        ("params", "max_steps = 100"),
        ("inputs", "until = \"2 s\""),
        ("figures", "instants = [\"0 s\"]"),
    ] {
        let file = folder.file("a.mbd", &format!("{text}[run.{table}]\n{setting}\n"));
        let told = run(&["check", &file]).unwrap_err().to_string();
        let name = setting.split(' ').next().unwrap();
        let said = format!(
            "`{name}` is a setting of `[run]`, and here it belongs to `[run.{table}]`: write it in front of that line"
        );
        assert!(told.contains(&said), "{told}");
    }
}

#[test]
fn a_param_outside_its_range_is_told_at_the_line_that_sets_it() {
    let folder = Folder::new("range");
    let file = folder.file(
        "drop.mbd",
        "model Drop {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    param mass = 1 kg in 0.5 kg ..= 2 kg;
    point stone { mass: mass, start at [0.0, 0.0, 1.0] m }
}

[run]
until = \"1 s\"

[run.params]
mass = \"5 kg\"
",
    );
    let out = folder.0.join("out").display().to_string();
    for command in [&["check", &file][..], &["run", &file, "--out", &out]] {
        let told = run(command).unwrap_err().to_string();
        assert!(
            told.contains("drop.mbd:11:1: param `mass` is 5 kg, outside its declared range"),
            "{told}"
        );
        assert!(told.contains("mass = \"5 kg\""), "the line itself: {told}");
    }
    // What is typed beside the file stands in no line of it.
    let told = run(&["run", &file, "--set", "mass=7 kg", "--out", &out]);
    let told = told.unwrap_err().to_string();
    assert!(
        told.contains("param `mass` is 7 kg") && !told.contains(":11:"),
        "{told}"
    );
}

/// A beam on three supports in a line: which of two carries it is one choice of many, and follows from the order in which they are declared.
#[test]
fn what_is_asked_of_a_reaction_that_is_not_unique_is_told_where_it_is_run() {
    let folder = Folder::new("supports");
    let out = folder.0.join("out").display().to_string();
    let scene = folder.file(
        "beam.mbd",
        "model Beam {
    gravity: [0, 0, -9.81] m/s^2;
    world { frame l at [-1, 0, 0] m, frame m at [0.5, 0, 0] m, frame r at [1, 0, 0] m }
    param P = 100 N in 0 N ..= 300 N;
    body beam { mass: 10 kg, inertia: diag(1, 1, 1) kg*m^2,
        frame l at [-1, 0, 0] m, frame m at [0.5, 0, 0] m, frame r at [1, 0, 0] m }
    joint jl: prismatic from world.l to beam.l { axis: x }
    joint jr: point_on_plane from world.r to beam.r { axis: z }
    joint jm: point_on_plane from world.m to beam.m { axis: z }
    load p on beam = [0 N, 0 N, -P];
    output mid = jm.force.z;
    metric reaction = max mid;
}
[run]
until = \"10 ms\"
",
    );
    let told = run(&["run", &scene, "--out", &out]);
    let told = told.unwrap_or_else(|failure| failure.to_string());
    println!("{told}");
    assert!(
        told.contains("warning: output `mid` asks for the reaction of `jm`, which is not unique"),
        "{told}"
    );
    let history = std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap();
    assert!(history.contains("mid [N; not unique]"), "{history}");
    // A requirement on it is not judged, however many cases keep it.
    let file = folder.file(
        "cases.toml",
        "cases = 30\n[params]\nP = { dist = \"uniform\", low = \"50 N\", high = \"150 N\" }\n\
         [metrics]\nreaction = { require = { below = \"1 MN\", share = 0.5, confidence = 0.5 } }\n\
         side = { max = \"jr.force.z\" }\n",
    );
    let results = folder.0.join("results").display().to_string();
    let told = run(&["campaign", &scene, &file, "--out", &results]).unwrap_err();
    assert_eq!(told.code(), 3);
    let told = told.to_string();
    for part in [
        "NOT JUDGED: reaction below",
        "its reaction is one choice of many",
    ] {
        assert!(told.contains(part), "{told}");
    }
    assert_eq!(run(&["report", &results]).unwrap_err().code(), 3);
    let page = std::fs::read_to_string(folder.0.join("results/report.html")).unwrap();
    assert_eq!(page.matches("its reaction is not unique").count(), 2);
}

/// x = x0 cos(10 t) beside something large that dilutes the balance of energy, at a tolerance that steps meet only because a clock or a table ends them.
#[test]
fn the_error_of_steps_that_events_or_tables_end_is_told() {
    let folder = Folder::new("ended");
    let out = folder.0.join("out").display().to_string();
    let tick = "state next = 0.12 s { rate: 0 } event tick = time rises next { set: next = next + 0.12 s }";
    let entries: Vec<String> = (0..=160)
        .map(|k| format!("{} s: 30 N", f64::from(k) / 8.0))
        .collect();
    let table = format!("table wind = {{ {} }}", entries.join(", "));
    for (what, force, every) in [
        (tick, "30 N", "0.05 s"),
        (tick, "30 N", "0.12 s"),
        (table.as_str(), "wind(time)", "0.05 s"),
    ] {
        let scene = folder.file(
            "ended.mbd",
            &format!(
                "model Ended {{
    gravity: none;
    {what}
    point big {{ mass: 100 kg, start at [0, 5, 0] m velocity [0, 3, 0] m/s }}
    load pull on big = [0, {force}, 0];
    body m {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
    joint s: prismatic from world to m.com {{ axis: x, stiffness: 100 N/m, start: 5 mm }}
    output x = s.slide;
}}
[run]
until = \"18 s\"
every = \"{every}\"
tolerance = 1e-3
"
            ),
        );
        let _ = run(&["run", &scene, "--out", &out]);
        let text = std::fs::read_to_string(folder.0.join("out/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        let told = summary["error_estimate"]["rms"].as_f64().unwrap();
        let history = std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap();
        let mut rows = history
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let column = rows
            .next()
            .unwrap()
            .iter()
            .position(|name| *name == "x [m]")
            .unwrap();
        let number = |text: &str| text.parse::<f64>().unwrap();
        let squares: Vec<f64> = rows
            .map(|row| (number(row[column]) - 5e-3 * (10.0 * number(row[0])).cos()).powi(2))
            .collect();
        let true_error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        println!("{every}: {told:.1e} of {true_error:.1e}");
        assert!(
            told > 0.5 * true_error && told < 3.0 * true_error,
            "{told} {true_error}"
        );
    }
}
