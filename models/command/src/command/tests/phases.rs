//! Runs through several scene files.

use serde_json::Value;

use super::{Folder, run};

/// A capsule on a parachute with linear drag, until a time.
const CHUTE: &str = r#"model Chute {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    point capsule { mass: 80 kg, start at [0.0, 0.0, 1000.0] m velocity [5.0, 0.0, 0.0] m/s }
    load drag on capsule = -200 kg/s * capsule.velocity;
    event released = time rises 3 s { then: scene "fall.mbd" }
}
[run]
until = "5 s"
tolerance = 1e-11
"#;

const FALL: &str = r#"model Fall {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    point capsule { mass: 80 kg }
    output height = capsule.position.z;
}
"#;

fn flown(folder: &Folder, file: &str, more: &[&str]) -> Value {
    let out = folder.0.join("out").display().to_string();
    let arguments = [&["run", file, "--json", "--out", &out], more].concat();
    let text = run(&arguments).unwrap_or_else(|failure| panic!("{failure}"));
    serde_json::from_str(&text).expect("JSON")
}

fn last(summary: &Value, phase: usize, column: &str) -> f64 {
    let value = &summary["phases"][phase]["run"]["last"][column];
    value.as_f64().unwrap_or(f64::NAN)
}

#[test]
fn a_setting_of_a_later_scene_that_nothing_can_be_run_with_is_told_by_check() {
    let folder = Folder::new("phases_settings");
    let chute = folder.file("chute.mbd", CHUTE);
    for (table, said) in [
        ("[run.params]\nmass = \"2 kg\"\n", "`params.mass`"),
        ("[run]\nmethod = \"vern8\"\n", "there is no method `vern8`"),
    ] {
        folder.file("fall.mbd", &format!("{FALL}{table}"));
        for more in [&[][..], &["--json"]] {
            let error = run(&[&["check", &chute], more].concat()).unwrap_err();
            let told = error.to_string();
            assert_eq!(error.code(), 2);
            assert!(told.contains(said) && told.contains("fall.mbd"), "{told}");
        }
    }
}

#[test]
fn a_capsule_falls_by_the_closed_forms_of_both_phases() {
    let folder = Folder::new("phases_fall");
    let chute = folder.file("chute.mbd", CHUTE);
    folder.file("fall.mbd", FALL);
    let summary = flown(&folder, &chute, &[]);
    assert_eq!(summary["phases"].as_array().map(Vec::len), Some(2));
    assert_eq!(summary["phases"][0]["ended_by"], "released");
    // v = vt (1 - exp(-c t/m)), z = z0 + vt (t - (1 - exp(-c t/m)) m/c), vt = -m g/c.
    let (k, t, g): (f64, f64, f64) = (200.0 / 80.0, 3.0, 10.0);
    let (end, e) = (-g / k, (-k * t).exp());
    let (v, z) = (end * (1.0 - e), 1000.0 + end * (t - (1.0 - e) / k));
    let (vx, x) = (5.0 * e, 5.0 * (1.0 - e) / k);
    for (column, exact) in [
        ("capsule.vz", v),
        ("capsule.z", z),
        ("capsule.vx", vx),
        ("capsule.x", x),
    ] {
        let found = last(&summary, 0, column);
        assert!((found - exact).abs() < 1e-9, "{column}: {found} {exact}");
    }
    let s = 2.0;
    for (column, exact) in [
        ("capsule.vz", v - g * s),
        ("capsule.z", z + v * s - 0.5 * g * s * s),
        ("capsule.vx", vx),
        ("capsule.x", x + vx * s),
        ("height", z + v * s - 0.5 * g * s * s),
    ] {
        let found = last(&summary, 1, column);
        assert!((found - exact).abs() < 1e-9, "{column}: {found} {exact}");
    }
    assert_eq!(summary["reached_s"], 5.0);
    // Both play on the page of the whole.
    let page = std::fs::read_to_string(folder.0.join("out/report.html")).unwrap();
    for words in ["1: capsule", "2: capsule", "is drawn from 0 s to"] {
        assert!(page.contains(words), "{words}");
    }
    // One history: both phases, a column that the first has not is empty in its rows.
    let csv = std::fs::read_to_string(folder.0.join("out/history.csv")).expect("a history");
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    assert_eq!(head[..2], ["time [s]", "phase"]);
    let height = head.iter().position(|name| *name == "height [m]");
    let height = height.expect("an output of the second scene");
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().any(|row| row[1] == "1") && rows.iter().any(|row| row[1] == "2"));
    for row in &rows {
        assert_eq!(row[height].is_empty(), row[1] == "1", "{row:?}");
    }
    let page = std::fs::read_to_string(folder.0.join("out/report.html")).expect("a page");
    assert!(page.contains("Chute") && page.contains("released") && page.contains("1_Chute"));
    // The curve of what the first scene has not begins with the second.
    assert!(page.contains("height [m]") && !page.contains("cannot be drawn"));
    assert!(folder.0.join("out/2_Fall/report.html").is_file());
}

#[test]
fn a_scene_without_a_line_goes_on_as_the_same_scene_with_the_line_detached() {
    let folder = Folder::new("phases_detach");
    let items = "gravity: [0.0, 0.0, -9.81] m/s^2;
        point a { mass: 3 kg, start at [0.0, 0.0, 10.0] m velocity [1.0, 0.0, 2.0] m/s }
        point b { mass: 1 kg, start at [1.2, 0.1, 10.0] m }";
    let line = "line tie from a to b { free_length: 1 m, stiffness: 50 N/m, damping: 1 N*s/m }";
    let settings = "[run]\nuntil = \"2 s\"\nstep = \"1 ms\"\n";
    let one = folder.file(
        "one.mbd",
        &format!("model One {{ {items} {line} event cut = time rises 0.7 s {{ detach: tie }} }}\n{settings}"),
    );
    let two = folder.file(
        "two.mbd",
        &format!("model Two {{ {items} {line} event cut = time rises 0.7 s {{ then: scene \"free.mbd\" }} }}\n{settings}"),
    );
    folder.file("free.mbd", &format!("model Free {{ {items} }}\n"));
    let out = folder.0.join("one").display().to_string();
    let text = run(&["run", &one, "--json", "--no-estimate", "--out", &out]).expect("a run");
    let alone: Value = serde_json::from_str(&text).expect("JSON");
    let both = flown(&folder, &two, &[]);
    for column in ["a.x", "a.z", "b.x", "b.y", "b.z", "a.vx", "b.vz"] {
        let exact = alone["last"][column].as_f64().expect("a number");
        let found = last(&both, 1, column);
        assert!((found - exact).abs() < 1e-12, "{column}: {found} {exact}");
    }
}

/// A rope of weight m g in its spring at rest, and a bar that stands out at 50 degrees. What the next scene cannot detach or lock is as it declares it: the rope that
/// was cut pulls again, and the bar falls. With an event for each in the next scene, whenever that happens, both stay as they were.
#[test]
fn what_was_detached_or_locked_and_does_not_stay_so_is_told_by_name() {
    let folder = Folder::new("phases_unkept");
    let items = "gravity: [0.0, 0.0, -9.81] m/s^2;
        point bob { mass: 1 kg, start at [0.0, 2.0, -2.0] m }
        body bar { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [0.0, 0.0, 0.5] m }
        line rope from world to bob { free_length: 1 m, stiffness: 1 N/m }
        joint pin: hinge from world to bar.root { axis: y, start: 50 deg }
        output swing = pin.angle in deg;
        output pull = rope.tension;";
    let settings = "[run]\nuntil = \"1 s\"\n";
    let first = |actions: &str| {
        format!(
            "model First {{ {items} event done = time rises 0 s {{ {actions} }}
                event over = time rises 0.5 s {{ then: scene \"second.mbd\" }} }}\n{settings}"
        )
    };
    let rope = "warning: `rope` was detached, and holds in `Second`";
    let pin = "warning: `pin.angle` was locked, and moves in `Second`";
    let flown = |actions: &str, later: &str| {
        let file = folder.file("first.mbd", &first(actions));
        folder.file(
            "second.mbd",
            &format!("model Second {{ {items} {later} }}\n{settings}"),
        );
        let out = folder.0.join("out").display().to_string();
        let text = run(&["run", &file, "--no-estimate", "--out", &out]).expect("a run");
        let summary = std::fs::read_to_string(folder.0.join("out/summary.json"));
        let summary: Value = serde_json::from_str(&summary.expect("a summary")).expect("JSON");
        let [swing, pull] = ["swing", "pull"].map(|name| last(&summary, 1, name));
        ([text.contains(rope), text.contains(pin)], swing, pull)
    };
    let both = "detach: rope, lock: pin";
    let (told, swing, pull) = flown(both, "");
    assert_eq!(told, [true, true]);
    assert!(swing < 40.0 && pull > 1.0, "{swing} {pull}");
    let changes = "event late = time rises 9 s { attach: rope, lock: pin }";
    let (told, swing, pull) = flown(both, changes);
    assert_eq!(told, [false, false]);
    assert!((swing - 50.0).abs() < 1e-9 && pull == 0.0, "{swing} {pull}");
    // What was attached again, and freed again, goes on as it was.
    let events =
        "attach: rope, free: pin } event before = time rises -1 s { detach: rope, lock: pin";
    assert_eq!(flown(events, "").0, [false, false]);
}

/// An arm that was locked, or that the next scene locks, stays where it is, whatever the angle is measured from there: the frame of its joint is turned by 30 degrees.
#[test]
fn a_lock_holds_the_arm_where_it_is_though_the_next_scene_measures_its_angle_from_elsewhere() {
    let folder = Folder::new("phases_lock");
    for (coordinates, before, at_start, after) in [
        (
            "absolute",
            "event held = time rises 0.3 s { lock: pin }",
            "",
            "event late = time rises 9 s { lock: pin }",
        ),
        (
            "relative",
            "event held = time rises 0.3 s { lock: pin }",
            "",
            "event late = time rises 9 s { lock: pin }",
        ),
        (
            "absolute",
            "",
            ", at_start: locked",
            "event late = time rises 9 s { free: pin }",
        ),
        (
            "relative",
            "",
            ", at_start: locked",
            "event late = time rises 9 s { free: pin }",
        ),
    ] {
        let scene = |name: &str, turned: &str, start: &str, events: &str| {
            format!(
                "model {name} {{ gravity: [0.0, 0.0, -9.81] m/s^2; coordinates: {coordinates};
                    body arm {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [0.0, 0.0, 0.5] m {turned} }}
                    joint pin: hinge from world to arm.root {{ axis: y{start} }}
                    {events}
                    output x = arm.position.x;
                    output swing = pin.angle in deg; }}
                [run]\nuntil = \"1 s\"\n"
            )
        };
        let events =
            format!("{before} event over = time rises 0.6 s {{ then: scene \"second.mbd\" }}");
        // Beyond a turn: the lock holds the turn, too.
        let first = folder.file(
            "first.mbd",
            &scene("First", "", ", start: 410 deg", &events),
        );
        let turned = "rotated about(y, 30 deg)";
        folder.file("second.mbd", &scene("Second", turned, at_start, after));
        let summary = flown(&folder, &first, &[]);
        let [before, after] = [0, 1].map(|phase| last(&summary, phase, "x"));
        assert!(
            (after - before).abs() < 1e-9,
            "{coordinates}: {before} {after}"
        );
        let [before, after] = [0, 1].map(|phase| last(&summary, phase, "swing"));
        assert!(
            (after - before - 30.0).abs() < 1e-6,
            "{coordinates}: {before} {after}"
        );
    }
}

/// A bar hangs at rest on the hinge `tie` of the second scene. That a rope called `tie` was cut in the first is nothing to it.
#[test]
fn a_joint_is_not_detached_because_a_line_of_its_name_was() {
    let folder = Folder::new("phases_kinds");
    let bar = "gravity: [0.0, 0.0, -9.81] m/s^2;
        body bar { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [0.0, 0.0, 0.5] m, start at [0.0, 0.0, -0.5] m }
        output height = bar.position.z;";
    let first = folder.file(
        "first.mbd",
        &format!(
            "model First {{ {bar} joint loose: free from world to bar.com;
                load hand on bar = [0 N, 0 N, 9.81 N];
                line tie from world to bar.com {{ free_length: 1 m, stiffness: 1 N/m }}
                event cut = time rises 0.1 s {{ detach: tie }}
                event over = time rises 0.2 s {{ then: scene \"second.mbd\" }} }}
            [run]\nuntil = \"1 s\"\n"
        ),
    );
    folder.file(
        "second.mbd",
        &format!(
            "model Second {{ {bar} joint tie: hinge from world to bar.root {{ axis: y }}
                event late = time rises 9 s {{ detach: tie }} }}"
        ),
    );
    let height = last(&flown(&folder, &first, &[]), 1, "height");
    assert!((height + 0.5).abs() < 1e-9, "{height}");
}

/// A kilogram that an input pushes for a second each: by how much its speed grows in the second scene says which force that was.
#[test]
fn an_input_is_held_at_what_the_scene_that_flies_says_of_it_and_else_goes_on() {
    let folder = Folder::new("phases_inputs");
    let items = "gravity: none;
        input push[i in 0..2]: force = 1 N;
        point sled[i in 0..2] { mass: 1 kg, start at [0, 0, 0] m }
        load thrust[i in 0..2] on sled[i] = [push[i], 0 N, 0 N];
        output speed[i in 0..2] = sled[i].velocity.x;";
    let first = folder.file(
        "first.mbd",
        &format!(
            "model First {{ {items} event over = time rises 1 s {{ then: scene \"second.mbd\" }} }}
            [run]\nuntil = \"2 s\"\n[run.inputs]\npush = \"3 N\"\n"
        ),
    );
    let gained = |said: &str, more: &[&str]| {
        let settings = format!("[run]\nuntil = \"2 s\"\n[run.inputs]\n{said}\n");
        let second = format!("model Second {{ {items} }}\n{settings}");
        folder.file("second.mbd", &second);
        let summary = flown(&folder, &first, more);
        ["speed[0]", "speed[1]"].map(|name| last(&summary, 1, name) - last(&summary, 0, name))
    };
    let near = |found: [f64; 2], wanted: [f64; 2]| {
        let off = [0, 1].map(|k| (found[k] - wanted[k]).abs());
        assert!(off.iter().all(|off| *off < 1e-9), "{found:?} {wanted:?}");
    };
    near(gained("", &[]), [3.0, 3.0]);
    near(gained("push = \"5 N\"", &[]), [5.0, 5.0]);
    near(gained("\"push[1]\" = \"7 N\"", &[]), [3.0, 7.0]);
    near(
        gained("push = \"5 N\"", &["--input", "push=9 N"]),
        [9.0, 9.0],
    );
}

/// A capsule with its heat shield as one body of 100 kg, 0.8 m of which lie between the centres of its parts.
const STACK: &str = r#"model Stack {
    gravity: none;
    body stack {
        mass: 100 kg,
        inertia: diag(50.8, 50.8, 30.0) kg*m^2,
        frame rim at [0.0, 0.0, -0.64] m,
        frame cabin at [0.0, 0.0, 0.16] m,
        start at [1.0, 2.0, 3.0] m rotated rpy(0.3, 0.2, 0.1) velocity [4.0, 5.0, 6.0] m/s angular_velocity [0.1, 0.2, 0.3] rad/s
    }
    joint loose: free from world to stack.com;
    state burnt = 1 s { rate: 1 }
    event separated = time rises 1 s { then: scene "parts.mbd", map: [shield = stack.rim, capsule = stack.cabin, since = 2 * burnt, k = 3 * burnt * 1 N/(m*s)] }
}
[run]
until = "2 s"
"#;

const PARTS: &str = r#"model Parts {
    gravity: none;
    param k = 1 N/m;
    body shield { mass: 20 kg, inertia: diag(10.0, 10.0, 10.0) kg*m^2 }
    body capsule { mass: 80 kg, inertia: diag(30.56, 30.56, 20.0) kg*m^2 }
    joint a: free from world to shield.com;
    joint b: free from world to capsule.com;
    state since = 0 s { rate: 1 }
    output stiffness = k;
}
"#;

#[test]
fn parts_that_separate_where_frames_were_keep_momentum_and_energy() {
    let folder = Folder::new("phases_parts");
    let stack = folder.file("stack.mbd", STACK);
    folder.file("parts.mbd", PARTS);
    let summary = flown(&folder, &stack, &[]);
    let part = &summary["phases"][1];
    // 50.8 = 10 + 20 · 0.64² + 30.56 + 80 · 0.16², to the rounding of these numbers.
    let exact = 10.0 + 20.0 * 0.64 * 0.64 + 30.56 + 80.0 * 0.16 * 0.16;
    assert!((exact - 50.8_f64).abs() < 1e-12, "{exact}");
    for k in 0..6 {
        let [before, after] =
            [0, 1].map(|side| part["momentum"][side][k].as_f64().expect("a number"));
        assert!((before - after).abs() < 1e-9, "{k}: {before} {after}");
    }
    let [before, after] =
        [0, 1].map(|side| part["energies_j"][side][0].as_f64().expect("a number"));
    assert!((before - after).abs() < 1e-9 * before, "{before} {after}");
    assert_eq!(part["dropped"], serde_json::json!(["burnt"]));
    // 1 s + 1 s, doubled; then one second more.
    assert!((last(&summary, 1, "since") - 5.0).abs() < 1e-9);
    assert!((last(&summary, 1, "stiffness") - 6.0).abs() < 1e-9);
}

#[test]
fn what_a_map_hands_on_is_from_just_before_the_instant() {
    let folder = Folder::new("phases_map_before");
    let last_of = |set: &str, other: &str| {
        let first = folder.file(
            "first.mbd",
            &format!(
                "model First {{ gravity: none; state soc = 1 {{ rate: 0 1/s }} param gain = 2;
                    point p {{ mass: 1 kg, start at [0, 0, 1] m velocity [1, 0, 0] m/s }}
                    {other}
                    event separated = time rises 1 s {{ {set} then: scene \"second.mbd\", map: [charge = soc, speed = p.velocity.x / (1 m/s), told = gain] }} }}
                [run]\nuntil = \"2 s\"\n"
            ),
        );
        folder.file(
            "second.mbd",
            "model Second { gravity: none; param told = 1; state charge = 0 { rate: 0 1/s } state speed = 0 { rate: 0 1/s } point p { mass: 1 kg }
                output said = told; output moving = p.velocity.x; }",
        );
        let summary = flown(&folder, &first, &[]);
        ["charge", "speed", "said", "moving"].map(|name| last(&summary, 1, name))
    };
    let changes = "soc = 0.5, p.velocity.x = 3 m/s, gain = 7";
    assert_eq!(last_of("", ""), [1.0, 1.0, 2.0, 1.0]);
    // What goes on by its own name goes on as the event left it.
    assert_eq!(
        last_of(&format!("set: [{changes}],"), ""),
        [1.0, 1.0, 2.0, 3.0]
    );
    let beside = format!("event also = time rises 1 s {{ set: [{changes}] }}");
    assert_eq!(last_of("", &beside), [1.0, 1.0, 2.0, 3.0]);
}

#[test]
fn a_time_at_which_a_scene_goes_on_has_passed_for_it() {
    let folder = Folder::new("phases_clock");
    let scene = |name: &str, next: &str| {
        format!(
            "model {name} {{ gravity: none; point p {{ mass: 1 kg, start at [0, 0, 1] m velocity [0, 0, 1] m/s }}
                event e = time rises 1 s {{ then: scene \"{next}\" }} }}
            [run]\nuntil = \"2 s\"\n"
        )
    };
    // One that leads back to itself, and two that lead to each other.
    let own = folder.file("own.mbd", &scene("Own", "own.mbd"));
    let one = folder.file("one.mbd", &scene("One", "two.mbd"));
    folder.file("two.mbd", &scene("Two", "one.mbd"));
    for first in [own, one] {
        let summary = flown(&folder, &first, &[]);
        let phases = summary["phases"].as_array().expect("phases");
        assert_eq!(phases.len(), 2, "{first}");
    }
}

#[test]
fn relative_coordinates_go_on_where_the_bodies_are() {
    let folder = Folder::new("phases_tree");
    let body = |name: &str| {
        format!(
            "body {name} {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m }}"
        )
    };
    let (upper, lower) = (body("upper"), body("lower"));
    let pin = "joint pin: hinge from world to upper.top { axis: y, start: 40 deg }";
    let knee = "joint knee: hinge from upper.tip to lower.top { axis: y, start: -30 deg }";
    let gravity = "gravity: [0.0, 0.0, -9.81] m/s^2;";
    let both = |name: &str, family: &str, event: &str| {
        format!(
            "model {name} {{ coordinates: {family}; {gravity} {upper} {lower} {pin} {knee} {event} output bent = knee.angle; output swings = pin.angle_rate; }}\n[run]\nuntil = \"1 s\"\n"
        )
    };
    let alone = folder.file("alone.mbd", &both("Alone", "relative", ""));
    let out = folder.0.join("alone").display().to_string();
    let text = run(&[
        "run",
        &alone,
        "--json",
        "--no-estimate",
        "--tol",
        "1e-11",
        "--out",
        &out,
    ]);
    let alone: Value = serde_json::from_str(&text.expect("a run")).expect("JSON");
    let event = "event now = time rises 0.4 s { then: scene \"next.mbd\" }";
    for (from, to) in [
        ("relative", "relative"),
        ("relative", "absolute"),
        ("absolute", "relative"),
    ] {
        let first = folder.file("first.mbd", &both("First", from, event));
        folder.file("next.mbd", &both("Next", to, ""));
        let summary = flown(&folder, &first, &["--tol", "1e-11"]);
        for column in ["bent", "swings"] {
            let exact = alone["last"][column].as_f64().expect("a number");
            let found = last(&summary, 1, column);
            assert!(
                (found - exact).abs() < 1e-8,
                "{from} {to} {column}: {found} {exact}"
            );
        }
    }
}

#[test]
fn params_are_those_of_the_file_that_flies_and_typed_ones_reach_all() {
    let folder = Folder::new("phases_params");
    let scene = |name: &str, event: &str, mass: &str| {
        format!(
            "model {name} {{ gravity: none; param mass = 1 kg; point p {{ mass: mass }} {event} }}\n[run]\nuntil = \"2 s\"\n[run.params]\nmass = \"{mass}\"\n"
        )
    };
    let event = "event handed = time rises 1 s { then: scene \"second.mbd\" }";
    let first = folder.file("first.mbd", &scene("First", event, "2 kg"));
    folder.file("second.mbd", &scene("Second", "", "3 kg"));
    for (more, masses) in [(&[][..], [2.0, 3.0]), (&["--set", "mass=5kg"], [5.0, 5.0])] {
        let summary = flown(&folder, &first, more);
        for (phase, mass) in masses.into_iter().enumerate() {
            assert_eq!(summary["phases"][phase]["run"]["params"]["mass"], mass);
        }
    }
}

#[test]
fn what_cannot_go_on_is_refused_at_its_place() {
    let folder = Folder::new("phases_wrong");
    folder.file("fall.mbd", FALL);
    folder.file(
        "other.mbd",
        "model Other { planar: xz; gravity: none; body tug { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 } joint loose: free from world to tug.com; state soc = 0 s { rate: 1 } state charge = 0 { rate: 1/s } param k = 1 N/m; }",
    );
    let scene = |action: &str| {
        format!(
            "model First {{\ngravity: none;\npoint capsule {{ mass: 1 kg }}\nstate soc = 0 m {{ rate: 1 m/s }}\nevent end = time rises 1 s {{\n{action}\n}}\n}}\n[run]\nuntil = \"2 s\"\n"
        )
    };
    for (action, place, words) in [
        (
            "then: scene \"gone.mbd\"",
            ":6:13:",
            &["gone.mbd", "relative to this one"][..],
        ),
        (
            "then: scene \"fall.mbd\", map: [prob = capsule]",
            ":6:31:",
            &["`prob`", "`Fall`", "it has capsule"],
        ),
        (
            "then: scene \"other.mbd\", map: [tug = capsule]",
            ":6:38:",
            &["no axes"],
        ),
        (
            "then: scene \"other.mbd\", map: [tug = 3 m]",
            ":6:38:",
            &["begins at a place"],
        ),
        (
            "then: scene \"other.mbd\", map: [k = capsule.position.z]",
            ":6:36:",
            &["`k` is measured in N/m"],
        ),
        (
            "then: scene \"other.mbd\", map: [charge = capsule.position.z]",
            ":6:41:",
            &["`charge` is a pure number in `Other`, this is a length (m)"],
        ),
        (
            "then: scene \"other.mbd\"",
            ":6:13:",
            &["another `planar`", "the state `soc`", "the body `tug`"],
        ),
    ] {
        let file = folder.file("first.mbd", &scene(action));
        for command in ["run", "check"] {
            let failure = run(&[command, &file]).expect_err("a mistake");
            let text = failure.to_string();
            assert_eq!(failure.code(), 2, "{text}");
            assert!(text.contains(place), "{place}: {text}");
            for word in words {
                assert!(text.contains(word), "{word}: {text}");
            }
        }
    }
    let file = folder.file("first.mbd", &scene("then: scene \"fall.mbd\""));
    let told = run(&["check", &file]).expect("a scene");
    assert!(told.contains("at `end` the scene `Fall` goes on"), "{told}");
    for command in [
        &["trade", &file, "--output", "capsule.z", "--window", "0..1"][..],
        &["expand", &file],
    ] {
        let failure = run(command).unwrap_or_else(|failure| failure.to_string());
        assert!(failure.contains("`end`"), "{failure}");
    }
}

#[test]
fn scenes_may_lead_back_to_each_other_and_never_without_end() {
    let folder = Folder::new("phases_back");
    let scene = |name: &str, other: &str, gravity: &str, period: &str| {
        format!(
            "model {name} {{ gravity: {gravity}; point p {{ mass: 1 kg, start at [0, 0, 0] m }} state clock = 0 s {{ rate: 1 }} event over = clock rises {period} {{ set: clock = 0 s, then: scene \"{other}\" }} }}\n[run]\nuntil = \"1 s\"\n"
        )
    };
    for (period, segments) in [("0.3 s", 4), ("0.1 ms", 1000)] {
        let up = folder.file(
            "up.mbd",
            &scene("Up", "down.mbd", "[0, 0, 1] m/s^2", period),
        );
        folder.file(
            "down.mbd",
            &scene("Down", "up.mbd", "[0, 0, -1] m/s^2", period),
        );
        let out = folder.0.join("out").display().to_string();
        let told = run(&["run", &up, "--out", &out]);
        match (segments, told) {
            (4, Ok(_)) => {
                let text = std::fs::read_to_string(folder.0.join("out/summary.json"));
                let summary: Value = serde_json::from_str(&text.expect("a summary")).expect("JSON");
                assert_eq!(summary["phases"].as_array().map(Vec::len), Some(4));
                // Up, down, up for 0.3 s each, down for 0.1 s: v = 0.3 - 0.3 + 0.3 - 0.1.
                assert!((last(&summary, 3, "p.vz") - 0.2).abs() < 1e-9);
            }
            (1000, Err(failure)) => {
                assert_eq!(failure.code(), 4, "{failure}");
                assert!(
                    failure.to_string().contains("`over` goes on without end"),
                    "{failure}"
                );
            }
            (_, told) => panic!("{told:?}"),
        }
    }
}

#[test]
fn both_forms_of_a_scene_name_the_same_file_and_map() {
    let folder = Folder::new("phases_forms");
    let stack = folder.file("stack.mbd", STACK);
    folder.file("parts.mbd", PARTS);
    let toml = run(&["convert", &stack]).expect("TOML");
    assert!(
        toml.contains("then = \"scene \\\"parts.mbd\\\"\""),
        "{toml}"
    );
    let other = folder.file("stack2.toml", &toml);
    let text = run(&["convert", &other, "--to", "mbd"]).expect("a text");
    assert!(text.contains("then: scene \"parts.mbd\""), "{text}");
    assert!(text.contains("shield = stack.rim"), "{text}");
    let third = folder.file("stack3.mbd", &text);
    let [a, b] = [&stack, &third].map(|file| last(&flown(&folder, file, &[]), 1, "shield.x"));
    assert!((a - b).abs() < 1e-12, "{a} {b}");
}

#[test]
fn a_param_that_a_map_decides_is_not_set_without_a_word() {
    let folder = Folder::new("phases_decided");
    let next = "{ then: scene \"next.mbd\", map: [push = 2 N] }";
    let text = |own: &str| {
        format!(
            "model First {{ gravity: none; {own} point a {{ mass: 1 kg, start at [0, 0, 0] m }}
             event cut = time rises 1 s {next} }}\n[run]\nuntil = \"2 s\"\n"
        )
    };
    folder.file(
        "next.mbd",
        "model Next { gravity: none; param push = 1 N in 0 N ..= 9 N; point a { mass: 1 kg } load f on a = [push, 0 N, 0 N]; }",
    );
    let out = folder.0.join("out").display().to_string();
    let fly = |own: &str| {
        let first = folder.file("first.mbd", &text(own));
        run(&["run", &first, "--set", "push=3 N", "--out", &out])
    };
    let told =
        "`--set push` does not count in `Next`: the `map` of the event `cut` of `First` decides it";
    let failure = fly("").unwrap_err();
    assert!(failure.to_string().contains(told), "{failure}");
    let own = "param push = 1 N in 0 N ..= 9 N; load f on a = [push, 0 N, 0 N];";
    let flown = fly(own).unwrap();
    assert!(flown.contains(told), "{flown}");
}

#[test]
fn metrics_are_told_of_the_whole_run() {
    let folder = Folder::new("phases_metrics");
    // Up by 20 m/s from the ground; the second scene begins where 1 s is over, at 15 m and 10 m/s.
    let first = folder.file(
        "up.mbd",
        "model Up {
            gravity: [0, 0, -10] m/s^2;
            point stone { mass: 1 kg, start at [0, 0, 0] m velocity [0, 0, 20] m/s }
            event on_high = time rises 1 s { then: scene \"down.mbd\" }
            metric top = max stone.position.z;
            metric way = integral norm(stone.velocity);
            metric first = time_of on_high;
            metric speed = max norm(stone.velocity);
        }
[run]
until = \"3 s\"
",
    );
    folder.file(
        "down.mbd",
        "model Down {
            gravity: [0, 0, -10] m/s^2;
            point stone { mass: 1 kg }
            metric top = max stone.position.z;
            metric way = integral norm(stone.velocity);
            metric last = final stone.position.z;
            metric speed = min norm(stone.velocity);
        }",
    );
    let summary = flown(&folder, &first, &[]);
    let exact = [
        ("top", 20.0),
        ("way", 25.0),
        ("first", 1.0),
        ("speed", 20.0),
        ("last", 15.0),
        ("speed (2)", 0.0),
    ];
    for (name, exact) in exact {
        let found = summary["metrics"][name].as_f64().unwrap_or(f64::NAN);
        assert!((found - exact).abs() < 1e-4, "{name}: {found}");
    }
    let out = folder.0.join("out").display().to_string();
    let told = run(&["run", &first, "--out", &out]).unwrap();
    let page = std::fs::read_to_string(format!("{out}/report.html")).unwrap();
    for text in [told, page] {
        assert!(
            text.contains("Metrics") && text.contains("speed (2)"),
            "{text}"
        );
    }
    // A run that ends before tells what it did not come to.
    let told = run(&["run", &first, "--until", "0.5", "--out", &out]).unwrap();
    assert!(
        told.contains("`last` has no value: the run did not come to its scene"),
        "{told}"
    );
}

#[test]
fn turns_go_on_in_a_scene_in_which_things_have_other_names() {
    let folder = Folder::new("phases_turns");
    for family in ["absolute", "relative"] {
        let body = |plane: &str, name: &str, more: &str, end: &str| {
            let joint = if plane.is_empty() {
                format!(
                    "joint {name}h: hinge from world to {name}.com {{ axis: x{more} }} output an = {name}h.angle in deg;"
                )
            } else {
                format!(
                    "joint {name}f: free from world to {name}.com; output an = {name}.angle in deg;"
                )
            };
            let start = match (plane, end) {
                ("", _) | (_, "") => "",
                _ => ", start at [0, 0, 0] m angular_velocity [10, 0, 0] rad/s",
            };
            format!(
                "model {name} {{ gravity: none; coordinates: {family}; {plane}
                body {name} {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.05) kg*m^2{start} }}
                {joint} {end} }}\n[run]\nuntil = \"2 s\"\nevery = \"1 s\"\n"
            )
        };
        for plane in ["", "planar: yz;"] {
            let go = "event go = time rises 1.2 s { then: scene \"v.mbd\", map: [v = w] }";
            let first = folder.file("w.mbd", &body(plane, "w", ", start_rate: 10 rad/s", go));
            folder.file("v.mbd", &body(plane, "v", "", ""));
            let summary = flown(&folder, &first, &[]);
            let [at_end, after] = [0, 1].map(|phase| last(&summary, phase, "an"));
            assert!((at_end - 12f64.to_degrees()).abs() < 1e-6, "{at_end}");
            assert!(
                (after - 20f64.to_degrees()).abs() < 1e-6,
                "{family} {plane}: {after}"
            );
        }
    }
}

#[test]
fn what_a_run_draws_has_files_of_its_own_whatever_it_is_called() {
    let folder = Folder::new("phases_names");
    // Models with names that no file system takes; titles that differ by a sign alone, one without end, and an output called as the drawing is.
    let (first, second, title) = ("C".repeat(300), "F".repeat(300), "t".repeat(3000));
    let drawn = format!(
        "[run.figures]\n\"a b\" = [\"capsule.x\"]\n\"a-b\" = [\"capsule.z\"]\n{title} = [\"capsule.y\"]\n"
    );
    let chute = CHUTE.replace(
        "model Chute {",
        &format!("model {first} {{ output mechanism = capsule.position.z;"),
    );
    let file = folder.file("chute.mbd", &format!("{chute}{drawn}"));
    folder.file(
        "fall.mbd",
        &FALL.replace("model Fall", &format!("model {second}")),
    );
    let told = flown(&folder, &file, &[]);
    assert_eq!(told["phases"].as_array().map(Vec::len), Some(2));
    let out = folder.0.join("out");
    let list = |folder: &std::path::Path| -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        let mut names: Vec<String> = names
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    };
    let phases: Vec<String> = list(&out)
        .into_iter()
        .filter(|name| name.contains("CC") || name.contains("FF"))
        .collect();
    let [one, two] = phases.as_slice() else {
        panic!("{phases:?}");
    };
    assert!(one.starts_with("1_C") && two.starts_with("2_F"));
    let pictures = list(&out.join(one));
    let has = |name: &str| pictures.iter().any(|file| file == name);
    for name in ["a_b.svg", "a_b_1.svg", "mechanism.svg", "mechanism_1.svg"] {
        assert!(has(name), "{name}: {pictures:?}");
    }
    assert!(pictures.iter().any(|file| file.starts_with("tttt")));
}

#[test]
fn a_body_that_joints_of_the_next_scene_hold_elsewhere_is_told_in_both_families() {
    let folder = Folder::new("phases_elsewhere");
    let bodies = "body a { mass: 5 kg, inertia: diag(1, 2, 3) kg*m^2, frame tip at [0.5, 0, 0] m, start at [0, 0, 0] m }
        joint a_free: free from world to a.com;";
    let first = |b: &str| {
        format!(
            "model First {{ gravity: none; {bodies}
                body b {{ mass: 1 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2, start at {b} m }}
                joint b_free: free from world to b.com;
                event docked = time rises 1 s {{ then: scene \"second.mbd\" }} }}
            [run]\nuntil = \"2 s\"\n"
        )
    };
    for family in ["absolute", "relative"] {
        folder.file(
            "second.mbd",
            &format!(
                "model Second {{ gravity: none; coordinates: {family}; {bodies}
                    body b {{ mass: 1 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2, frame root at [-0.3, 0, 0] m }}
                    joint pin: hinge from a.tip to b.root {{ axis: z }} }}"
            ),
        );
        let warned = |b: &str| {
            let file = folder.file("first.mbd", &first(b));
            let out = folder.0.join("out").display().to_string();
            let told = run(&["run", &file, "--out", &out]).expect("a run");
            told.contains("`b` does not go on in `Second` where it was")
        };
        assert!(!warned("[0.8, 0, 0]"), "{family}: the hinge holds there");
        assert!(warned("[0.8, 0, 0.1]"), "{family}: 0.1 m beside it");
    }
}

/// An oscillator whose spring becomes four times as stiff where it passes zero: x = x₀ cos(ω t), then a quarter of a period on -x₀ ω/(2 ω) sin(2 ω t').
/// RK4 is late by (h ω)⁵/120 a step and loses (h ω)⁶/144 of it. The error is told of the whole run, within three times of what it is.
#[test]
fn the_error_of_a_run_through_several_scenes_is_told_of_all_of_it() {
    let folder = Folder::new("phases_error");
    let scene = |name: &str, k: f64, more: &str| {
        format!(
            "model {name} {{ gravity: none;
               point bob {{ mass: 1 kg, start at [0.1, 0, 0] m }}
               load pull on bob = -{k} N/m * bob.position; {more}
               metric last = final bob.position.x; }}
             [run]\nuntil = \"30 s\"\n"
        )
    };
    let passes = "event passes = bob.position.x falls 0 m { then: scene \"stiff.mbd\" }";
    let soft = folder.file("soft.mbd", &scene("Soft", 1.0, passes));
    folder.file("stiff.mbd", &scene("Stiff", 4.0, ""));
    let quarter = std::f64::consts::FRAC_PI_2;
    let exact = -0.05 * (2.0 * (30.0 - quarter)).sin();
    for given in [["--dt", "0.1"], ["--tol", "1e-6"], ["--tol", "1e-9"]] {
        let summary = flown(&folder, &soft, &given);
        let error = (last(&summary, 1, "bob.x") - exact).abs();
        let told = &summary["error_estimate"];
        assert_eq!(told["column"], "last", "{told}");
        let told = told["rms"].as_f64().unwrap_or(f64::NAN);
        assert!(
            told < 3.0 * error && error < 3.0 * told && error < 1e-2,
            "{given:?}: {told} {error}"
        );
        assert_eq!(summary["error_not_estimated"], Value::Null);
        // Its parts say where it stands.
        let part = &summary["phases"][0]["run"];
        assert_eq!(part["error_estimate"], Value::Null);
        assert!(
            part["error_not_estimated"]
                .as_str()
                .is_some_and(|why| why.contains("whole run"))
        );
    }
    // Where it is large it is an exit code.
    let out = folder.0.join("out").display().to_string();
    let error = run(&["run", &soft, "--out", &out, "--dt", "0.25"]).unwrap_err();
    let text = error.to_string();
    assert_eq!(error.code(), 3, "{text}");
    assert!(
        text.contains("warning: Soft → Stiff: `last` is off by")
            && text.contains("take a shorter step"),
        "{text}"
    );
    // Who asks for none is told so, in words and in numbers.
    let none = flown(&folder, &soft, &["--no-estimate"]);
    assert_eq!(none["error_estimate"], Value::Null);
    assert!(
        none["error_not_estimated"]
            .as_str()
            .is_some_and(|why| why.contains("ask for no"))
    );
    let text = run(&["run", &soft, "--out", &out, "--no-estimate"]).unwrap();
    assert!(
        text.contains("not estimated: the settings ask for no"),
        "{text}"
    );
}
