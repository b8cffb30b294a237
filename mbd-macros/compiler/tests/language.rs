//! The language: declarations in `pass/` are read, declarations in `fail/` give the message their first line names.

use mbd_compiler::{Message, Named, Reading, immovable, read_text, read_tokens};
use mbd_scene::{Formula, Layout, NodeModel, PointKind};

/// Messages as text, one a line.
fn told(reading: &Reading) -> String {
    let lines: Vec<String> = reading
        .errors
        .iter()
        .map(|message| message.in_file("scene.mbd"))
        .collect();
    lines.join("\n")
}

fn files(folder: &str) -> Vec<(String, String)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files
        .into_iter()
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read_to_string(path).unwrap())
        })
        .collect()
}

#[test]
fn declarations_without_a_mistake_are_read() {
    for (name, text) in files("pass") {
        let reading = read_text(&text);
        assert!(reading.scene.is_some(), "{name}:\n{}", told(&reading));
        assert!(
            reading.warnings.is_empty(),
            "{name}: {:?}",
            reading.warnings
        );
    }
}

/// The lines `//~ line:column: message` that say what is wrong with a declaration, places counted from the line after them.
fn expected(text: &str) -> (Vec<&str>, String) {
    let head: Vec<&str> = text
        .lines()
        .take_while(|line| line.starts_with("//~ "))
        .map(|line| line.trim_start_matches("//~ "))
        .collect();
    let rest: Vec<&str> = text.lines().skip(head.len()).collect();
    (head, rest.join("\n"))
}

/// All messages with all their places.
fn lines(messages: &[Message]) -> Vec<String> {
    let told = |message: &Message| -> Vec<String> {
        let lines = message.in_file("");
        lines.lines().map(|line| line[1..].to_string()).collect()
    };
    messages.iter().flat_map(told).collect()
}

#[test]
fn what_is_probably_not_meant_is_a_warning() {
    for (name, text) in files("warn") {
        let (wanted, declaration) = expected(&text);
        let reading = read_text(&declaration);
        assert!(reading.scene.is_some(), "{name}:\n{}", told(&reading));
        assert_eq!(lines(&reading.warnings), wanted, "{name}");
    }
}

/// A pendulum with a mass called like a unit, and these items.
fn pendulum(items: &str) -> Reading {
    let text = format!(
        "model Pendulum {{
            gravity: [0, 0, -9.81] m/s^2;
            param m = 2 kg;
            body rod {{ mass: m, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 1] m }}
            {items}
        }}"
    );
    read_text(&text)
}

#[test]
fn a_word_that_is_a_unit_and_a_name_is_what_gives_the_dimension_that_is_wanted() {
    let pin = |force: &str| {
        format!("joint pin: hinge from world to rod.top {{ axis: y, force: {force} }}")
    };
    let pairs = [
        (
            pin("-20 N*m * sin(pin.angle)"),
            pin("-20 (N*m) * sin(pin.angle)"),
        ),
        (
            pin("-20 N*m*s * pin.angle_rate"),
            pin("-20 (N*m*s) * pin.angle_rate"),
        ),
        (
            pin("0 N*m") + "load w on rod = [0, 0, -1] * (9.81 m/s^2 * m);",
            pin("0 N*m") + "load w on rod = [0, 0, -1] * ((9.81 m/s^2) * m);",
        ),
        (
            pin("0 N*m") + "output x = 9.81 m/s^2 * m + 1 N in kN;",
            pin("0 N*m") + "output x = (9.81 m/s^2) * m + 1 N in kN;",
        ),
    ];
    for (written, meant) in pairs {
        let read = pendulum(&written);
        assert!(read.scene.is_some(), "{}", told(&read));
        assert_eq!(read.scene, pendulum(&meant).scene, "{written}");
        assert!(
            read.notes.iter().any(|note| note.starts_with("`m`")),
            "{written}"
        );
    }
    let frame = |at: &str| {
        let pin = pin("0 N*m");
        format!(
            "const N = 3; world {{ frame a at [{at}, 0, 0] }} {pin} joint b: spherical from world.a to rod.top;"
        )
    };
    let read = pendulum(&frame("2 m * N"));
    assert_eq!(
        read.scene,
        pendulum(&frame("N * 2 m")).scene,
        "{}",
        told(&read)
    );
    // A const, and where only one way fits together at all.
    let side = |side: &str| {
        let pin = pin("0 N*m");
        format!("const N = 6; const side = 2 m * sin({side}); {pin} output x = side * pin.angle;")
    };
    let read = pendulum(&side("180 deg / N"));
    assert_eq!(
        read.scene,
        pendulum(&side("30 deg")).scene,
        "{}",
        told(&read)
    );
    // Where no dimension is wanted a quantity is meant: a torque, not a force times a mass.
    for (written, meant) in [
        (
            "let x = 2 N*m * sin(pin.angle); output y = x;",
            "let x = 2 (N*m) * sin(pin.angle); output y = x;",
        ),
        ("param k = 5 MN*m/rad;", "param k = 5 (MN*m/rad);"),
    ] {
        let read = pendulum(&(pin("0 N*m") + written));
        assert!(read.scene.is_some(), "{}", told(&read));
        assert!(
            read.notes.iter().any(|note| note.starts_with("`m` in")),
            "{written}"
        );
        let [read, meant] = [read, pendulum(&(pin("0 N*m") + meant))].map(|it| it.scene.unwrap());
        assert_eq!(read.lets, meant.lets, "{written}");
        let defaults = [read, meant].map(|it| it.params.last().map(|it| it.default));
        assert_eq!(defaults[0], defaults[1]);
    }
    // Of two that have no name, or both have one, both might be meant.
    for output in [
        "output x = 2 kg*m * sin(pin.angle);",
        "let x = 3 m/s^2 * m; output y = x;",
    ] {
        let read = pendulum(&(pin("0 N*m") + output));
        assert!(
            told(&read).contains("`m` is also a param"),
            "{}",
            told(&read)
        );
    }
    // `2 m * m` behind a stroke would be divided by the first alone.
    let read = pendulum(&(pin("0 N*m") + "output x = 4 kg*m / 2 m * m in kg^2;"));
    assert!(read.scene.is_none());
}

#[test]
fn an_output_of_two_or_more_numbers_has_a_column_each() {
    let pin = "joint pin: hinge from world to rod.top { axis: y }";
    let listed = pendulum(&format!(
        "{pin} output both = [pin.angle, 2 * pin.angle] in deg;"
    ));
    let alone = pendulum(&format!(
        "{pin} output both[i in 1..3] = i * pin.angle in deg;"
    ));
    let names = |read: &Reading| -> Vec<String> {
        let scene = read.scene.as_ref().expect("read");
        scene
            .outputs
            .iter()
            .map(|output| output.name.clone())
            .collect()
    };
    assert_eq!(names(&listed), ["both[0]", "both[1]"]);
    assert_eq!(names(&alone), ["both[1]", "both[2]"]);
    let units = |read: &Reading| -> Vec<String> {
        let scene = read.scene.as_ref().expect("read");
        scene
            .outputs
            .iter()
            .map(|output| output.unit.text.clone())
            .collect()
    };
    assert_eq!(units(&listed), ["deg", "deg"]);
    let five = pendulum(&format!("{pin} output all = [1, 2, 3, 4, 5] m;"));
    assert_eq!(names(&five).len(), 5);
}

#[test]
fn a_metric_and_the_guard_of_an_event_may_name_an_output() {
    let items = |pull: &str| {
        format!(
            "joint pin: hinge from world to rod.top {{ axis: y }}
             output pull = norm(pin.force) in kN;
             metric most = max {pull} in N;
             event slack = {pull} falls 2 N;"
        )
    };
    let named = pendulum(&items("pull"));
    assert!(named.scene.is_some(), "{}", told(&named));
    assert_eq!(named.scene, pendulum(&items("norm(pin.force)")).scene);
    // What an event sets cannot depend on accelerations, by whatever name.
    let set = items("pull").replace("falls 2 N", "falls 2 N { set: m = pull / (10 m/s^2) }");
    assert!(told(&pendulum(&set)).contains("`pull` is the name of an output"));
}

#[test]
fn a_metric_of_an_output_is_told_in_its_unit() {
    let unit = |items: &str| {
        let reading = pendulum(&format!(
            "joint pin: hinge from world to rod.top {{ axis: y }} {items}"
        ));
        let scene = reading.scene.unwrap_or_else(|| panic!("{items}"));
        scene.runs.metrics[0].unit(&scene)
    };
    let bend = "output bend = pin.angle in deg;";
    assert_eq!(unit(&format!("{bend} metric most = max bend;")), "deg");
    assert_eq!(
        unit(&format!("{bend} metric most = max bend in mrad;")),
        "mrad"
    );
    let list = "output both = [pin.angle, 2 * pin.angle] in deg;";
    assert_eq!(unit(&format!("{list} metric most = max both[1];")), "deg");
    for of in ["abs(bend)", "-bend", "bend - 0.1 rad", "max(bend, 1 deg)"] {
        assert_eq!(
            unit(&format!("{bend} metric most = max {of};")),
            "deg",
            "{of}"
        );
    }
    // What has another unit than its parts is told in SI.
    assert_eq!(unit(&format!("{bend} metric most = max 2 * bend;")), "rad");
    let power = "output power = 2 N*m * pin.angle_rate in kW;";
    assert_eq!(
        unit(&format!("{power} metric work = integral power;")),
        "kJ"
    );
    assert_eq!(
        unit(&format!("{power} metric work = integral power in kJ;")),
        "kJ"
    );
}

#[test]
fn a_component_has_the_name_that_histories_give_it() {
    let items = |word: &str| {
        format!(
            "joint pin: hinge from world to rod.top {{ axis: y }} point bob {{ mass: 1 kg, start at [0, 0, 0] m }}
             output fast = {word};"
        )
    };
    for (short, whole) in [
        ("bob.vx", "bob.velocity.x"),
        ("bob.z", "bob.position.z"),
        ("rod.vz", "rod.velocity.z"),
        ("rod.top.vy", "rod.top.velocity.y"),
    ] {
        let [short, whole] = [short, whole].map(|word| pendulum(&items(word)));
        assert!(short.scene.is_some(), "{}", told(&short));
        assert_eq!(short.scene, whole.scene);
    }
}

#[test]
fn a_body_without_frames_is_a_place_by_its_name() {
    let items = |end: &str| {
        format!(
            "body ball {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
             joint pin: hinge from world to rod.top {{ axis: y }}
             joint loose: free from world to {end};
             line cord from rod.top to {end} {{ free_length: 1 m, stiffness: 1 kN/m }}"
        )
    };
    let named = pendulum(&items("ball"));
    assert!(named.scene.is_some(), "{}", told(&named));
    assert_eq!(named.scene, pendulum(&items("ball.com")).scene);
}

#[test]
fn conditions_hold_together_or_one_of_them() {
    // What is an operand's truth is written as a comparison of numbers.
    let truth = |holds: bool| if holds { "1 < 2" } else { "2 <= 1" };
    let value = |condition: &str| {
        let text = format!(
            "model M {{ gravity: none; state s = 0 {{ rate: 0 /s }}
                const short = if({condition}, 1, 0); const long = if {condition} {{ 1 }} else {{ 0 }}; }}"
        );
        let scene = read_text(&text)
            .scene
            .unwrap_or_else(|| panic!("{condition}"));
        let [short, long] = [0, 1].map(|k| scene.consts[k].value.scalar().expect("a number"));
        assert_eq!(short, long, "{condition}");
        short == 1.0
    };
    for bits in 0..8 {
        let [p, q, r] = [1, 2, 4].map(|bit| bits & bit != 0);
        let [a, b, c] = [p, q, r].map(truth);
        assert_eq!(value(&format!("{a} && {b}")), p && q);
        assert_eq!(value(&format!("{a} || {b}")), p || q);
        assert_eq!(value(&format!("{a} || {b} && {c}")), p || q && r);
        assert_eq!(value(&format!("({a} || {b}) && {c}")), (p || q) && r);
        assert_eq!(value(&format!("(0 + 1) * 2 > 1 && ({a} || {b})")), p || q);
        let half = format!("(if {a} && {b} {{ 2 }} else {{ 0 }} + 0) / 2 >= 1");
        assert_eq!(value(&half), p && q);
    }
}

#[test]
fn the_remainder_lies_between_zero_and_the_divisor() {
    let path = format!("{}/tests/pass/remainder.mbd", env!("CARGO_MANIFEST_DIR"));
    let scene = read_text(&std::fs::read_to_string(path).unwrap())
        .scene
        .unwrap();
    let ends: Vec<_> = scene.lines.iter().map(|line| line.to).collect();
    let point = mbd_scene::Place::Point;
    assert_eq!(ends, [1, 2, 0, 2, 0, 1].map(point));
    let left = scene.consts.iter().find(|it| it.name == "left").unwrap();
    assert_eq!(left.value.scalar(), Some(2.0));
    assert_eq!(scene.outputs[1].value, mbd_scene::Formula::Number(4.0));
}

#[test]
fn an_angle_that_is_computed_needs_no_unit_and_may_be_so_many_radians() {
    let of = |start: &str| {
        let pin = format!("joint pin: hinge from world to rod.top {{ axis: y, start: {start} }}");
        let read = pendulum(&pin);
        assert!(read.scene.is_some(), "{}", told(&read));
        read.scene
    };
    assert_eq!(of("pi / 6"), of("(pi / 6) * 1 rad"));
}

#[test]
fn a_second_in_brackets_is_the_unit_beside_a_spring_of_that_name() {
    let decay = |spring: &str, rate: &str| {
        let pin = "joint pin: hinge from world to rod.top { axis: y }";
        let ends = "{ free_length: 1 m, stiffness: 1 kN/m }";
        let spring = format!("spring {spring} from world to rod.com {ends}");
        pendulum(&format!(
            "{pin} {spring} state a = 1 m {{ rate: {rate} * a }}"
        ))
    };
    let read = decay("s", "-0.1 (1/s)");
    let states = |reading: &Reading| reading.scene.as_ref().map(|scene| scene.states.clone());
    assert!(read.scene.is_some(), "{}", told(&read));
    assert_eq!(states(&read), states(&decay("s_1", "-0.1/s")));
}

#[test]
fn an_exponent_behind_a_unit_in_brackets_is_of_the_unit_alone() {
    let of = |value: &str| {
        let read = pendulum(&format!(
            "joint pin: hinge from world to rod.top {{ axis: y }} param p = {value};"
        ));
        let scene = read.scene.as_ref();
        let scene = scene.unwrap_or_else(|| panic!("{value}: {}", told(&read)));
        scene.params.last().map_or(f64::NAN, |param| param.default)
    };
    for (value, si) in [
        ("100 (1/s)^2", 100.0),
        ("3 (m)^2", 3.0),
        ("3 (km)^2", 3e6),
        ("3 (m)^-1", 3.0),
        ("4 (kN/m)^2", 4e6),
        ("3 (km/h)^2", 3.0 / 12.96),
    ] {
        assert!(
            (of(value) / si - 1.0).abs() < 1e-14,
            "{value}: {}",
            of(value)
        );
    }
    let read = pendulum("joint pin: hinge from world to rod.top { axis: y } param p = 2 m^2^2;");
    assert!(
        told(&read).contains("the power of a power"),
        "{}",
        told(&read)
    );
}

#[test]
fn an_output_of_an_axis_is_noted_and_one_of_a_place_is_not() {
    let noted = |output: &str| {
        let pin = "joint pin: hinge from world to rod.top { axis: y }";
        let read = pendulum(&format!("{pin} output up = {output};"));
        assert!(read.scene.is_some(), "{}", told(&read));
        assert!(read.warnings.is_empty(), "{:?}", read.warnings);
        read.notes.join("; ")
    };
    assert_eq!(
        noted("rod.z"),
        "output `up` has three numbers: `rod.z` is its z axis; its place along z is `rod.position.z`"
    );
    assert_eq!(
        noted("rod.top.x"),
        "output `up` has three numbers: `rod.top.x` is its x axis; its place along x is `rod.top.position.x`"
    );
    for place in ["rod.position.z", "rod.z.x", "dot(rod.z, rod.position)"] {
        assert_eq!(noted(place), "", "{place}");
    }
}

#[test]
fn gravity_across_the_plane_of_a_scene_is_noted() {
    let noted = |gravity: &str| {
        let text = format!(
            "model Disc {{ planar: xy; gravity: {gravity}; body disc {{ mass: 1 kg, inertia: 1 kg*m^2 }} joint loose: free from world to disc.com; }}"
        );
        let read = read_text(&text);
        assert!(read.scene.is_some(), "{}", told(&read));
        read.notes.join("; ")
    };
    assert_eq!(
        noted("[0, 0, -9.81] m/s^2"),
        "gravity is along z, across the plane `xy`, which carries it: nothing falls in the plane"
    );
    for gravity in ["none", "[0, -9.81, 0] m/s^2", "[0, -5, -5] m/s^2"] {
        assert_eq!(noted(gravity), "", "{gravity}");
    }
}

/// Compares what every file of a folder is told with its first lines; `UPDATE_GOLDEN` writes them.
fn compare(folder: &str, told: impl Fn(&str, &Reading) -> Vec<String>) {
    let mut wrong = Vec::new();
    for (name, text) in files(folder) {
        let (wanted, declaration) = expected(&text);
        let found = told(&name, &read_text(&declaration));
        if found != wanted {
            wrong.push(format!("{name}:\n{}", found.join("\n")));
        }
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            let head: Vec<String> = found.iter().map(|line| format!("//~ {line}\n")).collect();
            let path = format!("{}/tests/{folder}/{name}", env!("CARGO_MANIFEST_DIR"));
            let text = format!("{}{}\n", head.concat(), declaration.trim_end());
            std::fs::write(path, text).unwrap();
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_mistake_is_told_at_its_place_with_its_remedy() {
    compare("fail", |name, reading| {
        assert!(reading.scene.is_none(), "{name} was read");
        lines(&reading.errors)
    });
}

/// Everything that a declaration is told before it runs: errors, what cannot move, warnings.
fn everything_told(reading: &Reading) -> Vec<String> {
    let mut errors = reading.errors.clone();
    if let Some(scene) = &reading.scene {
        errors.extend(immovable(reading, &Layout::new(scene)));
    }
    let warnings = lines(&reading.warnings).into_iter();
    let warnings = warnings.map(|line| format!("warning: {line}"));
    lines(&errors).into_iter().chain(warnings).collect()
}

/// What new users write by mistake, and what they guess: declarations written by people who had not seen the language, one mistake or wish
/// each. A file without `//~` lines is accepted as it stands.
#[test]
fn what_new_users_write_is_accepted_or_answered() {
    compare("users/broken", |_, reading| everything_told(reading));
    compare("users/wished", |_, reading| everything_told(reading));
}

fn parachute() -> String {
    let path = format!("{}/tests/pass/parachute.mbd", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn tokens_and_text_are_the_same_language() {
    for (name, text) in files("pass") {
        let tokens = text.parse().unwrap();
        let (tokens, text) = (read_tokens(tokens), read_text(&text));
        assert!(tokens.scene.is_some(), "{name}: {:?}", tokens.errors);
        assert_eq!(tokens.scene, text.scene, "{name}");
        assert_eq!(tokens.notes, text.notes, "{name}");
    }
    for (name, text) in files("fail") {
        let (_, declaration) = expected(&text);
        // What is no Rust token, or no balanced text, never reaches a macro; a number beyond f64 is refused by rustc as well.
        let Ok(tokens) = declaration.parse() else {
            continue;
        };
        let (tokens, text) = (read_tokens(tokens), read_text(&declaration));
        let (tokens, text): (Vec<_>, Vec<_>) = (
            tokens.errors.iter().map(|m| &m.text).collect(),
            text.errors.iter().map(|m| &m.text).collect(),
        );
        assert_eq!(tokens, text, "{name}");
    }
}

#[test]
fn a_comment_of_another_language_is_told_once_in_a_macro_call() {
    let tokens = "model S { gravity: none; # the bob\n point bob { mass: 1 kg } }".parse();
    let reading = read_tokens(tokens.unwrap());
    let texts: Vec<&str> = reading.errors.iter().map(|m| m.text.as_str()).collect();
    assert_eq!(texts, ["a comment begins with `//`"]);
}

#[test]
fn every_place_of_a_message_is_a_compile_error_of_its_own() {
    let twice = "model S { gravity: none; const a = 1.0 m; const a = 2.0 m; }";
    let reading = read_tokens(twice.parse().unwrap());
    let told = reading.errors[0].to_compile_error().to_string();
    assert_eq!(told.matches("compile_error").count(), 2, "{told}");
    assert!(told.contains("is used twice in this model") && told.contains("first used here"));
}

#[test]
fn after_an_error_the_names_of_the_interface_are_still_there() {
    let broken = parachute().replace("stiffness: riser_k", "stifness: riser_k");
    let reading = read_text(&broken);
    assert!(reading.scene.is_none());
    let names = |list: Vec<&String>| -> Vec<String> { list.into_iter().cloned().collect() };
    let skeleton = &reading.skeleton;
    assert_eq!(skeleton.name, "Parachute");
    assert_eq!(
        names(skeleton.params.iter().map(|p| &p.name).collect()),
        ["riser_k", "m_cap", "cd_s"]
    );
    assert_eq!(
        names(skeleton.outputs.iter().map(|o| &o.name).collect()),
        ["riser_force", "tilt", "imu_speed"]
    );
    assert_eq!(skeleton.loads.len(), 2);
    assert_eq!(reading.spans.params.len(), 3);
    assert!(reading.options.generic && reading.options.verify);
    assert_eq!(reading.options.visibility.to_string(), "pub");
}

#[test]
fn uses_of_names_are_known_with_their_places() {
    let reading = read_text(&parachute());
    let uses = |named: Named| {
        let references = &reading.spans.references;
        references.iter().filter(|(used, _)| *used == named).count()
    };
    assert_eq!(uses(Named::Param(1)), 1);
    assert_eq!(uses(Named::Input(0)), 2);
    assert_eq!(uses(Named::Frame(0, 2)), 3);
}

/// The model of the point `p` where three legs and one riser meet, by the damping of the lines.
fn chosen(riser: &str, leg: &str, legs: usize) -> (NodeModel, String) {
    let text = format!(
        "model S {{ gravity: none; point p; point end {{ mass: 1.0 kg }}
         line riser from world to p {{ free_length: 1.0 m, stiffness: 1.0 kN/m{riser} }}
         line leg[i in 0..{legs}] from end to p {{ free_length: 1.0 m, stiffness: 1.0 kN/m{leg} }} }}"
    );
    let reading = read_text(&text);
    let scene = reading.scene.unwrap();
    match scene.points[0].kind {
        PointKind::Node(model) => (model, reading.notes.join("; ")),
        PointKind::Mass(_) => unreachable!(),
    }
}

#[test]
fn a_node_without_a_declared_model_gets_the_default_of_its_lines() {
    let damping = ", damping: 1.0 N*s/m";
    let (model, note) = chosen("", "", 3);
    assert_eq!(model, NodeModel::Static);
    assert_eq!(note, "point `p`: static (no damped line)");
    let (model, note) = chosen(damping, damping, 3);
    assert_eq!(model, NodeModel::Rate);
    assert_eq!(
        note,
        "point `p`: rate (4 lines, all damped, none to another massless point)"
    );
    let (model, note) = chosen(damping, damping, 2);
    assert!(matches!(model, NodeModel::Stepwise { .. }));
    assert_eq!(note, "point `p`: stepwise (3 of 3 lines damped)");
    let (model, _) = chosen(damping, "", 3);
    assert!(matches!(model, NodeModel::Stepwise { .. }));
}

#[test]
fn numbers_and_consts_fold_and_params_stay_live() {
    let scene = read_text(&parachute()).scene.unwrap();
    let leg = &scene.lines[1];
    assert_eq!(leg.free_length, Formula::Const(0));
    assert_eq!(leg.stiffness, Formula::Number(47e3));
    assert_eq!(scene.lines[0].stiffness, Formula::Param(0));
    // Three frames on a circle, 120° apart: the second at (r cos 120°, r sin 120°, h).
    let [x, y, z] = &scene.bodies[1].frames[2].position;
    let angle: f64 = 120.0 * std::f64::consts::PI / 180.0;
    assert_eq!(*x, Formula::Number(0.55 * angle.cos()));
    assert_eq!(*y, Formula::Number(0.55 * angle.sin()));
    assert_eq!(*z, Formula::Number(1.23));
    // A quarter turn about z has true zeros: x to y, y to −x.
    let rows = scene.bodies[1].frames[4].rotation.clone().unwrap();
    let expected = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(rows, expected.map(|row| row.map(Formula::Number)));
}

#[test]
fn a_frame_is_rotated_about_one_axis() {
    let rows = |rotated: &str| {
        let text = format!(
            "model S {{ gravity: none; const AXIS = [1, 1, 1]; param tilt = 30 deg in 0 deg ..= 90 deg;
             body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame f at [0, 0, 0] m rotated {rotated} }}
             joint f: free from world to a.com; }}"
        );
        let reading = read_text(&text);
        let scene = reading
            .scene
            .unwrap_or_else(|| panic!("{:?}", reading.errors));
        scene.bodies[0].frames[1].rotation.clone().expect("rotated")
    };
    // A third of a turn about the diagonal carries x to y, y to z and z to x.
    let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for written in [
        "about([2, 2, 2], 120 deg)",
        "about(AXIS, 120 deg)",
        "about([-1, -1, -1], -120 deg)",
    ] {
        let found = rows(written).map(|row| {
            row.map(|formula| match formula {
                Formula::Number(number) => number,
                other => panic!("{other:?}"),
            })
        });
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!(
                (found - expected).abs() < 1e-15,
                "{written}: {found} for {expected}"
            );
        }
    }
    // About an axis of the frame it is the rotation that was there before, zeros and all; angles may be params.
    assert_eq!(rows("about(x, 30 deg)"), rows("rpy(30 deg, 0, 0)"));
    assert_eq!(rows("about([0, 0, 2], 90 deg)"), rows("rpy(0, 0, 90 deg)"));
    assert_eq!(rows("about(-y, 90 deg)"), rows("rpy(0, -90 deg, 0)"));
    assert_eq!(rows("about(z, tilt)"), rows("rpy(0, 0, tilt)"));
}

#[test]
fn frames_are_measured_from_the_centre_of_mass() {
    let path = format!("{}/tests/pass/knots.mbd", env!("CARGO_MANIFEST_DIR"));
    let scene = read_text(&std::fs::read_to_string(path).unwrap())
        .scene
        .unwrap();
    let tip = &scene.bodies[0].frames[2];
    assert_eq!(tip.name, "tip");
    assert_eq!(tip.position, [0.0, 0.0, -0.25].map(Formula::Number));
    assert_eq!(
        scene.bodies[0].frames[0].position,
        [0.0; 3].map(Formula::Number)
    );
}

#[test]
fn products_of_inertia_change_their_sign_and_matrix_elements_do_not() {
    let with = |note: &str| {
        let text = format!(
            "model S {{ gravity: none; body a {{ mass: 1 kg, inertia: full {{ xx: 1.0, yy: 1.0, zz: 1.5, xy: 0.1 }} kg*m^2 ({note}) }}
             joint f: free from world to a.com; }}"
        );
        read_text(&text).scene.unwrap().bodies[0].inertia.xy.clone()
    };
    assert_eq!(with("matrix elements"), Formula::Number(0.1));
    assert_eq!(with("products of inertia"), Formula::Number(-0.1));
}

#[test]
fn a_repetition_of_any_size_is_read_or_refused_at_once() {
    let begin = std::time::Instant::now();
    for count in ["9000", "10001", "9223372036854775807", "1e300"] {
        let text = format!(
            "model S {{ gravity: none; point p[i in 0..{count}] {{ mass: 1 kg }} output x = p[1].position; }}"
        );
        let reading = read_text(&text);
        assert_eq!(reading.scene.is_some(), count == "9000", "{count}");
    }
    assert!(begin.elapsed().as_secs_f64() < 5.0);
}

#[test]
fn ranges_of_consts_repeat_everything_as_ranges_of_numbers_do() {
    let read = |from: &str, to: &str| {
        let range = format!("[i in {from}..{to}]");
        let text = format!(
            "model S {{ gravity: none; const N = 2;
               world {{ frame hook{range} at [i, 0, 0] m }}
               input push{range}: force = 0 N;
               state level{range} = 1 m {{ rate: 0.1 m/s }}
               let twice{range} = 2*level[i];
               body rod{range} {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame end[j in {from}..{to}] at [j, 0, 0] m }}
               joint pin{range}: hinge from world.hook[i] to rod[i].com {{ axis: z }}
               point bob{range} {{ mass: 1 kg }}
               line rope{range} from rod[i].end[i] to bob[i] {{ stiffness: 1 N/m, free_length: level[i] }}
               spring coil{range} from world.hook[i] to rod[i].end[i] {{ stiffness: 1 N/m, free_length: 1 m }}
               load wind{range} on bob[i] = [push[i], 0 N, 0 N];
               output length{range} = twice[i];
               event high{range} = bob[i].position.z rises 1 m {{ then: stop }}
               metric most{range} = max twice[i]; }}"
        );
        let reading = read_text(&text);
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        let mut scene = reading.scene.unwrap_or_default();
        scene.consts.clear();
        scene
    };
    let scene = read("0", "N + 1");
    assert_eq!(
        [scene.states.len(), scene.inputs.len(), scene.bodies.len()],
        [3; 3]
    );
    assert_eq!(scene, read("0", "3"));
    assert_eq!(read("N", "2*N"), read("2", "4"));
}

#[test]
fn the_axis_of_a_planet_is_a_letter_or_a_vector() {
    let read = |axis: &str| {
        let text = format!(
            "model S {{ gravity: oblate {{ mu: 4e13 m^3/s^2, center: [0, 0, 0] m, radius: 3000 km, j2: 0.002, axis: {axis} }};
               point p {{ mass: 1 kg }} }}"
        );
        let reading = read_text(&text);
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        reading.scene
    };
    assert_eq!(read("z"), read("[0, 0, 1]"));
    assert_eq!(read("-y"), read("[0, -1, 0]"));
}

#[test]
fn a_chain_of_one_rod_is_declared_like_a_chain_of_many() {
    let path = format!("{}/tests/pass/one_of_each.mbd", env!("CARGO_MANIFEST_DIR"));
    let one = std::fs::read_to_string(path).unwrap();
    let counts = |text: &str| {
        let reading = read_text(text);
        let scene = reading.scene.unwrap_or_default();
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        let frames: usize = scene.bodies.iter().map(|body| body.frames.len()).sum();
        [
            scene.bodies.len(),
            frames,
            scene.world_frames.len(),
            scene.points.len(),
            scene.joints.len(),
            scene.lines.len(),
            scene.loads.len(),
            scene.events.len(),
            scene.outputs.len(),
        ]
    };
    assert_eq!(counts(&one), [1, 3, 1, 0, 1, 0, 0, 0, 1]);
    let three = one.replace("const COUNT = 1", "const COUNT = 3");
    assert_eq!(counts(&three), [3, 15, 3, 2, 3, 2, 2, 2, 5]);
}

/// The word that a message proposes in place of the one where it stands.
fn proposed(message: &str) -> Option<&str> {
    let mut forms = ["did you mean `", "here it is called `"].into_iter();
    let behind = forms.find_map(|form| message.split_once(form))?.1;
    behind.split('`').next()
}

/// The text with the word at a line and column, both from 1, replaced.
fn with_word(text: &str, (line, column): (usize, usize), word: &str) -> Option<String> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let old = lines.get(line - 1)?;
    let (before, behind): (String, String) = (
        old.chars().take(column - 1).collect(),
        old.chars().skip(column - 1).collect(),
    );
    let rest = behind.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_');
    lines[line - 1] = format!("{before}{word}{rest}");
    Some(lines.join("\n"))
}

#[test]
fn every_word_that_a_message_proposes_takes_the_message_away() {
    let mut tried = 0;
    for folder in ["fail", "users/broken"] {
        for (name, text) in files(folder) {
            let (_, declaration) = expected(&text);
            for message in lines(&read_text(&declaration).errors) {
                let mut parts = message.splitn(3, ':');
                let mut number = || parts.next()?.trim().parse::<usize>().ok();
                let (Some(line), Some(column)) = (number(), number()) else {
                    continue;
                };
                // `run` is no item either: the message says where it stands.
                let Some(word) = proposed(&message).filter(|word| *word != "run") else {
                    continue;
                };
                let again = with_word(&declaration, (line, column), word).unwrap();
                let left = lines(&read_text(&again).errors);
                let place = format!("{line}:{column}: unknown");
                let stays = left
                    .iter()
                    .any(|left| *left == message || left.starts_with(&place));
                assert!(
                    !stays,
                    "{name}: {message}\nwith `{word}`:\n{}",
                    left.join("\n")
                );
                tried += 1;
            }
        }
    }
    assert!(tried > 50, "{tried} words were proposed");
}

/// A run holds what a param in radians is set to, to the rule of declarations: 90 without a unit is refused.
#[test]
fn a_param_of_which_a_multiple_is_an_angle_is_one() {
    let formulas = [
        ("sin(a)", "rad"),
        ("sin(2 * a)", "rad"),
        ("cos(-a / 2)", "rad"),
        ("tan(named)", "rad"),
        ("sin(a * 1 deg)", ""),
        ("sin(a * pi / 180)", ""),
        ("sin(0.0174 * a)", ""),
        ("sin(a * time / (1 s))", ""),
    ];
    for (formula, unit) in formulas {
        let text = format!(
            "model Angle {{
                gravity: none;
                point p {{ mass: 1 kg }}
                param a = 0.5;
                let named = 2 * a;
                output s = {formula};
                output used = named;
            }}"
        );
        let reading = read_text(&text);
        let scene = reading.scene.as_ref();
        let scene = scene.unwrap_or_else(|| panic!("{formula}: {}", told(&reading)));
        assert_eq!(scene.params[0].unit.text, unit, "{formula}");
    }
}
