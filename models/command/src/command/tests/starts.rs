//! Where a run starts: bodies in their places, joint coordinates.

use super::*;

/// A pendulum of 1 m whose start says where its bob is, and nothing of its attitude.
const PENDULUM: &str = "pub model Pendulum {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame pivot at [0, 0, 1] m }
    joint pin: hinge from world to rod.pivot { axis: y }
}";

#[test]
fn a_start_that_the_joints_do_not_allow_is_told() {
    let folder = Folder::new("start");
    let out = folder.0.join("out").display().to_string();
    let flown = |start: &str| {
        let run_table = format!("[run]\nuntil = \"0.1 s\"\n[run.start]\n{start}");
        let file = folder.file("pendulum.mbd", &format!("{PENDULUM}\n{run_table}\n"));
        run(&["run", &file, "--out", &out]).unwrap()
    };
    // 30°, of the position alone: the nearest that the hinge allows is another angle.
    let told = flown("rod.x = \"-0.5 m\"\nrod.z = \"-0.8660254 m\"");
    let first = told.lines().next().unwrap();
    assert!(
        first.starts_with("warning: `rod` does not start where"),
        "{told}"
    );
    // The attitude with it, to the digits that a person writes: 30° about y.
    let fits = flown("rod.x = \"-0.5 m\"\nrod.z = \"-0.866 m\"\nrod.qw = 0.9659\nrod.qy = 0.2588");
    assert!(!fits.contains("warning"), "{fits}");
    let json = std::fs::read_to_string(folder.0.join("out/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
    let moved = &summary["start_moved"];
    assert_eq!(moved["name"], "rod");
    assert!(moved["distance_m"].as_f64().unwrap() < 1e-3, "{moved}");
}

#[test]
fn what_rounding_moves_at_the_start_is_not_told() {
    let folder = Folder::new("start_rounding");
    let out = folder.0.join("out").display().to_string();
    let boom = "pub model Boom {
        gravity: none;
        coordinates: relative;
        body bus {
            mass: 450 kg,
            inertia: diag(110, 130, 90) kg*m^2,
            frame root at [0.6, 0, 0] m,
            start at [0, 0, 0] m rotated rpy(20 deg, -10 deg, 30 deg),
        }
        body rod { mass: 2 kg, inertia: diag(0.01, 0.7, 0.7) kg*m^2, frame root at [-1, 0, 0] m, frame tip at [1, 0, 0] m }
        point tip { mass: 1.5 kg }
        joint fly: free from world to bus.com;
        joint root: universal from bus.root to rod.root { axes: [y, z] }
        joint mount: spherical from rod.tip to tip;
    }
    [run]
    until = \"0.1 s\"
    ";
    let file = folder.file("boom.mbd", boom);
    let told = run(&["run", &file, "--out", &out]).unwrap();
    assert!(!told.contains("moved at the start"), "{told}");
}

#[test]
fn a_start_is_said_in_joint_coordinates() {
    let folder = Folder::new("joint_start");
    let out = folder.0.join("out").display().to_string();
    let flown = |start: &str| {
        let run_table = format!("[run]\nuntil = \"0.1 s\"\n[run.start]\n{start}");
        let file = folder.file("pendulum.mbd", &format!("{PENDULUM}\n{run_table}\n"));
        run(&["run", &file, "--out", &out])
    };
    let told = flown("pin.angle = \"30 deg\"\npin.angle_rate = \"1 rad/s\"").unwrap();
    assert!(!told.contains("warning"), "{told}");
    let history = std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap();
    let mut lines = history.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let first: Vec<f64> = lines
        .next()
        .unwrap()
        .split(',')
        .map(|x| x.parse().unwrap_or(f64::NAN))
        .collect();
    let column = |name: &str| {
        first[header
            .iter()
            .position(|known| known.starts_with(name))
            .unwrap()]
    };
    let (sin, cos) = 30f64.to_radians().sin_cos();
    assert!((column("rod.x") + sin).abs() < 1e-12 && (column("rod.z") + cos).abs() < 1e-12);
    assert!((column("rod.vx") + cos).abs() < 1e-12, "1 m at 1 rad/s");
    for (start, said) in [
        ("pin.angel = \"30 deg\"", "did you mean `pin.angle`"),
        ("pin.angle = \"30 m\"", "wrong unit"),
        (
            "pin.angle = \"30 deg\"\nrod.x = \"0.1 m\"",
            "placed already",
        ),
    ] {
        let error = flown(start).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn a_declared_start_that_the_joints_do_not_allow_is_told_in_both_families() {
    let folder = Folder::new("declared_start");
    let out = folder.0.join("out").display().to_string();
    for family in ["absolute", "relative"] {
        let flown = |place: &str| {
            let text = PENDULUM
                .replace("gravity:", &format!("coordinates: {family}; gravity:"))
                .replace("frame pivot", &format!("start {place}, frame pivot"));
            let file = folder.file(
                "pendulum.mbd",
                &format!("{text}\n[run]\nuntil = \"0.1 s\"\n"),
            );
            run(&["run", &file, "--out", &out]).unwrap()
        };
        let told = flown("at [-0.5, 0, -0.866] m");
        let warned = told.starts_with("warning: `rod` does not start where `start at`");
        assert!(warned, "{family}: {told}");
        let nowhere = flown("rotated rpy(0, 30 deg, 0)");
        let warned = nowhere
            .contains("from the origin of the world, where a `start` that says no place puts it");
        // In relative coordinates it hangs from its hinge, as it is rotated.
        assert_eq!(warned, family == "absolute", "{nowhere}");
        let fits = flown("at [-0.5, 0, -0.8660254] m rotated rpy(0, 30 deg, 0)");
        assert!(!fits.contains("warning"), "{family}: {fits}");
    }
}

#[test]
fn a_declared_velocity_that_the_joints_do_not_allow_is_told_in_both_families() {
    let folder = Folder::new("declared_velocity");
    let out = folder.0.join("out").display().to_string();
    // The bob is 1 m from the hinge about y: its velocity of 1 m/s belongs to −1 rad/s, and no rotation at all to no velocity.
    for family in ["absolute", "relative"] {
        let flown = |motion: &str| {
            let text = PENDULUM
                .replace("gravity:", &format!("coordinates: {family}; gravity:"))
                .replace(
                    "frame pivot",
                    &format!("start at [0, 0, -1] m {motion}, frame pivot"),
                );
            let file = folder.file(
                "pendulum.mbd",
                &format!("{text}\n[run]\nuntil = \"0.1 s\"\n"),
            );
            run(&["run", &file, "--out", &out]).unwrap()
        };
        let told = flown("velocity [1, 0, 0] m/s");
        let warned =
            told.starts_with("warning: `rod` does not start with the velocity that is said");
        assert!(warned && told.contains("start_rate"), "{family}: {told}");
        let json = std::fs::read_to_string(folder.0.join("out/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
        let changed = summary["start_moved"]["velocity_m_s"].as_f64().unwrap();
        assert!(changed > 0.05, "{family}: {json}");
        let told = flown("angular_velocity [0, 0, 1] rad/s");
        let warned = told.starts_with("warning: `rod` does not start with the angular velocity");
        assert!(warned, "{family}: {told}");
        let fits = flown("velocity [1, 0, 0] m/s angular_velocity [0, -1, 0] rad/s");
        assert!(!fits.contains("warning"), "{family}: {fits}");
    }
}

/// Three bars of 1 m, 2 m and 2 m between pivots 2 m apart.
const LOOP: &str = "model Loop { gravity: none;
    world { frame far at [2, 0, 0] m }
    body crank { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-0.5, 0, 0] m, frame b at [0.5, 0, 0] m }
    body bar { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-1, 0, 0] m, frame b at [1, 0, 0] m }
    body rocker { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-1, 0, 0] m, frame b at [1, 0, 0] m }
    joint p: hinge from world to crank.a { axis: z, start: about 90 deg, start_rate: 1 rad/s }
    joint q: hinge from crank.b to bar.a { axis: z }
    joint r: hinge from world.far to rocker.a { axis: z }
    joint s: hinge from bar.b to rocker.b { axis: z } }";

#[test]
fn a_start_about_a_value_tells_how_far_it_moved_in_text_and_toml() {
    let folder = Folder::new("about");
    let out = folder.0.join("out");
    let text =
        format!("{LOOP}\n[run]\nuntil = \"10 ms\"\n[run.start]\n\"r.angle\" = \"about 90 deg\"\n");
    let file = folder.file("loop.mbd", &text);
    let toml = folder.0.join("loop.toml");
    let written = run(&["convert", &file, "--to", "toml"]).unwrap();
    assert!(written.contains("start = \"about 90 deg\""), "{written}");
    std::fs::write(&toml, written).unwrap();
    for file in [file, toml.display().to_string()] {
        let told = run(&["run", &file, "--out", &out.to_string_lossy()]).unwrap();
        assert!(
            told.contains("`p.angle` at ") && told.contains(" from 90.000000 deg"),
            "{told}"
        );
        let json = std::fs::read_to_string(out.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
        let about = summary["start_about"].as_array().unwrap();
        assert_eq!(about.len(), 2);
        // The tips of crank and rocker are a bar apart.
        let of = |name: &str| {
            let found = about.iter().find(|one| one["name"] == name).unwrap();
            found["taken"].as_f64().unwrap()
        };
        let ([y, x], [v, u]) = (
            of("p.angle").sin_cos().into(),
            of("r.angle").sin_cos().into(),
        );
        let apart = f64::hypot(2.0 + 2.0 * u - x, 2.0 * v - y);
        assert!((apart - 2.0).abs() < 1e-9, "{apart}");
    }
    for (start, said) in [
        ("\"p.angle_rate\" = \"about 1 rad/s\"", "is a rate"),
        ("\"p.angle\" = \"about 1\"", "needs a unit"),
        ("\"crank.x\" = \"about 1 m\"", "about"),
    ] {
        let file = folder.file(
            "loop.mbd",
            &format!("{LOOP}\n[run]\nuntil = 1\n[run.start]\n{start}\n"),
        );
        let error = run(&["run", &file, "--out", &out.to_string_lossy()])
            .unwrap_err()
            .to_string();
        assert!(error.contains(said), "{error}");
    }
}

/// A four-bar with all bars in one line, or with its crank turned.
fn flat_linkage(start: &str, coordinates: &str) -> String {
    format!(
        "model Flat {{ gravity: [0, 0, -9.81] m/s^2; coordinates: {coordinates};
           world {{ frame o at [0, 0, 0] m, frame c at [1, 0, 0] m }}
           body crank {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-0.5, 0, 0] m, frame b at [0.5, 0, 0] m }}
           body bar {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-0.5, 0, 0] m, frame b at [0.5, 0, 0] m }}
           body rocker {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-0.5, 0, 0] m, frame b at [0.5, 0, 0] m }}
           joint p: hinge from world.o to crank.a {{ axis: y{start} }}
           joint q: hinge from crank.b to bar.a {{ axis: y }}
           joint r: hinge from world.c to rocker.a {{ axis: y }}
           joint s: hinge from bar.b to rocker.b {{ axis: y }} }}
         [run]
         until = \"10 ms\"\n"
    )
}

#[test]
fn a_start_from_which_several_motions_are_possible_is_told() {
    let folder = Folder::new("flat");
    for coordinates in ["absolute", "relative"] {
        for (start, singular) in [("", true), (", start: 40 deg", false)] {
            let file = folder.file("flat.mbd", &flat_linkage(start, coordinates));
            let out = folder.0.join("out");
            let told = run(&["run", &file, "--out", &out.to_string_lossy()]);
            let told = told.unwrap_or_else(|error| error.to_string());
            // In space three rows of the loop repeat others, and where two more do nothing is left to go by.
            let said = ["singular position", "start away from this configuration"];
            let says = said.iter().any(|said| told.contains(said));
            assert_eq!(says, singular, "{told}");
        }
    }
}

#[test]
fn every_command_that_starts_a_run_tells_what_the_start_moved() {
    let folder = Folder::new("starts_everywhere");
    let scene = folder.file(
        "bob.mbd",
        "model Bob { gravity: [0, 0, -9.81] m/s^2;
            body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 1] m, start at [0.5, 0, -0.8] m }
            joint pin: hinge from world to bob.top { axis: y }
            output bend = pin.angle;
            metric widest = max pin.angle; }
        [run]\nuntil = \"0.5 s\"\n",
    );
    let campaign = folder.file("few.toml", "seed = 1\ncases = 2\n[start]\npin.angle_rate = { dist = \"normal\", sigma = \"0.1 rad/s\" }\n");
    let out = folder.0.join("out").display().to_string();
    let commands: [&[&str]; 5] = [
        &["linearise", &scene],
        &["trade", &scene, "--output", "bend", "--out", &out],
        &["advise", &scene, "--output", "bend"],
        &["campaign", &scene, &campaign, "--out", &out],
        &[
            "compare",
            &scene,
            &format!("{scene} --tol 1e-6"),
            "--out",
            &out,
        ],
    ];
    for command in commands {
        let told = run(command).unwrap_or_else(|error| panic!("{command:?}: {error}"));
        assert!(
            told.contains("warning: `bob` does not start where"),
            "{command:?}: {told}"
        );
    }
}
