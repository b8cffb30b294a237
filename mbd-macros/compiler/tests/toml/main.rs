//! Scenes in TOML: the same scene, the same mistakes, each at its line and column.

mod mistakes;

use mbd_compiler::{
    Reading, read_text, read_toml, text_to_toml, toml_to_text, write_text, write_toml,
};
use mbd_scene::Scene;

fn told(reading: &Reading) -> Vec<String> {
    reading
        .errors
        .iter()
        .map(|message| message.in_file("scene.toml"))
        .collect()
}

#[test]
fn text_to_scene_to_toml_to_scene_is_the_identity() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pass");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let scene = read_text(&text).scene.unwrap();
        let written = write_toml(&scene);
        let again = read_toml(&written);
        let read = again.scene.clone().unwrap_or_else(|| {
            panic!("{}\n{written}\n{}", path.display(), told(&again).join("\n"))
        });
        assert_eq!(scene, read, "{}\n{written}", path.display());
    }
}

#[test]
fn scene_to_text_to_scene_is_the_identity() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pass");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let scene = read_text(&text).scene.unwrap();
        let written = write_text(&scene);
        let again = read_text(&written);
        let read = again.scene.clone().unwrap_or_else(|| {
            panic!("{}\n{written}\n{}", path.display(), told(&again).join("\n"))
        });
        assert_eq!(scene, read, "{}\n{written}", path.display());
    }
}

#[test]
fn pure_numbers_whose_unit_stands_behind_brackets_are_read_again_in_si() {
    let text = "model Pure {
        gravity: none;
        param ratio = 0.3;
        body b { mass: 1 kg, inertia: diag(ratio, ratio, 0.4) kg*m^2 }
        joint afloat: free from world to b.com;
        point p { mass: 1 kg }
        load whirl on p = [sin(time / 1 s), cos(time / 1 s), sqrt(time / 1 s)] N;
        load twist on b at com = [0.1, sin(time / 1 s), 0.3] N*m - cross(b.x, [0, 0, 2] N*m);
    }";
    let scene = read_text(text).scene.expect("a scene");
    for read in [
        read_toml(&write_toml(&scene)),
        read_text(&write_text(&scene)),
    ] {
        assert_eq!(told(&read), Vec::<String>::new());
        assert_eq!(read.scene.as_ref(), Some(&scene));
    }
    // Where units are wanted, they still are.
    let without = text.replace("sqrt(time / 1 s)] N", "sqrt(time / 1 s)]");
    assert!(read_text(&without).scene.is_none());
}

#[test]
fn an_angle_without_its_unit_still_makes_radians_of_turns_where_numbers_are_in_si() {
    let courses = [
        "360 deg * f * time",
        "f * 30 deg * time",
        "30 deg * sin(2 * pi) * f * time",
        "30 deg / 2 * (f * time)",
    ];
    for course in courses {
        let text = format!(
            "model Crank {{
                gravity: none;
                param f = 2 Hz;
                body rod {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
                joint pin: hinge from world to rod.com {{ axis: y, motor: {course} }}
            }}"
        );
        let read = read_text(&text);
        let scene = read
            .scene
            .clone()
            .unwrap_or_else(|| panic!("{course}: {:?}", told(&read)));
        let written = write_toml(&scene);
        let again = read_toml(&written);
        assert_eq!(again.scene, Some(scene), "{written}\n{:?}", told(&again));
    }
    // Turns alone are told there, too.
    let alone = "model = \"Crank\"\nunits = \"si\"\nparam.f = \"2 Hz\"\n\
        [body.rod]\nmass = \"1\"\ninertia = \"diag(1, 1, 1)\"\n\
        [joint.pin]\nkind = \"hinge\"\nfrom = \"world\"\nto = \"rod.com\"\naxis = \"y\"\nmotor = \"f * time\"\n";
    let messages = told(&read_toml(alone)).join("\n");
    assert!(messages.contains("counts turns"), "{messages}");
}

/// An angle told as a number stays one: without a word SI would tell it in radians.
#[test]
fn an_angle_that_is_told_as_a_number_is_one_after_it_was_written_in_si() {
    let text = "model Pend {
        gravity: none;
        body rod { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
        joint pin: hinge from world to rod.com { axis: y }
        state count = 0.5 { rate: 1 Hz }
        let lean = pin.angle;
        output turned = pin.angle in 1;
        output also = lean;
        output tilt = angle(rod.z, world.z) in 1;
        output free = angle(rod.z, world.z);
        output counted = count;
        metric most = max pin.angle in 1;
    }";
    let read = read_text(text);
    let scene = read.scene.clone();
    let scene = scene.unwrap_or_else(|| panic!("{:?}", told(&read)));
    for again in [
        read_toml(&write_toml(&scene)),
        read_text(&write_text(&scene)),
    ] {
        assert_eq!(told(&again), Vec::<String>::new());
        assert_eq!(again.scene.as_ref(), Some(&scene));
    }
}

#[test]
fn what_is_no_angle_is_none_after_it_was_written_in_si() {
    let values = [
        "wish + 0.1 rad * -(2 rad/s * time)",
        "0.1 rad * wish",
        "wish * 30 deg",
        "wish / 0.5 rad",
        "wish / 2",
        "2 * wish",
    ];
    for value in values {
        let text = format!(
            "model Aim {{
                gravity: none;
                input wish: angle = 10 deg;
                point p {{ mass: 1 kg }}
                let aim = {value};
                output told = aim;
                output also = {value};
                metric most = max {value};
            }}"
        );
        let read = read_text(&text);
        let scene = read
            .scene
            .clone()
            .unwrap_or_else(|| panic!("{value}: {:?}", told(&read)));
        let written = write_toml(&scene);
        let again = read_toml(&written);
        assert_eq!(again.scene, Some(scene), "{written}\n{:?}", told(&again));
    }
}

#[test]
fn what_events_do_is_the_same_in_text_and_toml() {
    let text = include_str!("../pass/actions.mbd");
    let scene = read_text(text).scene.unwrap();
    let document = write_toml(&scene);
    for kept in [
        "set = \"cd_s = 82.0\"",
        "detach = \"reef[0]\"",
        "attach = \"[tie, reef[0]]\"",
        "acts = \"once\"",
        "then = \"stop\"",
        "at_start = \"detached\"",
    ] {
        assert!(document.contains(kept), "{kept}\n{document}");
    }
    let again = read_toml(&document);
    assert_eq!(
        again.scene.as_ref(),
        Some(&scene),
        "{}",
        told(&again).join("\n")
    );
    let misspelt = document
        .replace("cd_s = 82", "cds = 82")
        .replace("[tie, ", "[ties, ");
    let told = told(&read_toml(&misspelt)).join("\n");
    assert!(
        told.contains("no param or state named `cds` to set; did you mean `cd_s`?"),
        "{told}"
    );
    assert!(
        told.contains("no line, spring or joint named `ties` to attach; did you mean `tie`?"),
        "{told}"
    );
}

#[test]
fn a_document_as_text_keeps_its_consts_repetitions_and_units() {
    let text = toml_to_text(LINK).unwrap();
    for kept in [
        "/// A link on a line.\nmodel Link<T> {",
        "const L = 1.6 m;",
        "/// Mass of the link.\n    param mass = 2.0 kg in 1 kg ..= 3 kg;",
        "body bead[i in 0..2] {",
        "frame ear[j in 0..2] at [0.0, i * 1 cm, j * 1 cm]",
        "free_length: L + i * 10 cm",
        "event slack = side[0].tension falls 0 N;",
        "verify;",
    ] {
        assert!(text.contains(kept), "{kept}\n{text}");
    }
    let (read, document) = (read_text(&text), read_toml(LINK));
    assert!(read.scene.is_some(), "{:?}\n{text}", read.errors);
    assert_eq!(read.scene, document.scene);
}

#[test]
fn a_text_as_a_document_and_back_is_the_same_scene_with_what_was_written() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pass");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let whole = read_text(&text);
        let document = text_to_toml(&text).unwrap();
        let read = read_toml(&document);
        assert_eq!(
            read.scene,
            whole.scene,
            "{}\n{document}\n{:?}",
            path.display(),
            told(&read)
        );
        assert_eq!(read.options.verify, whole.options.verify);
        assert_eq!(read.options.generic, whole.options.generic);
        let again = toml_to_text(&document).unwrap();
        assert_eq!(read_text(&again).scene, whole.scene, "{again}");
    }
    let text = "/// A swing.
        model Swing {
            gravity: [0.0, 0.0, -9.81] m/s^2; // downwards
            const L = 80 cm;
            param tilt = 30 deg in 0 deg ..= 60 deg;
            body link[i in 0..3] {
                mass: 500 g, // light
                inertia: diag(55, 55, 1) g*m^2,
                frame root at [0.0, 0.0, L / 2] rotated rpy(0, 0, 45 deg),
            }
            joint pin[i in 0..3]: universal from world to link[i].root { axes: [x, y], angle1: { damping: 3 N*mm*s, start: tilt } }
            output bend = pin[0].angle1 in deg;
        }";
    let document = text_to_toml(text).unwrap();
    for kept in [
        "doc = \"A swing.\"",
        "L = \"80 cm\"",
        "tilt = { value = \"30 deg\", in = \"0 deg ..= 60 deg\" }",
        "[body.\"link[i in 0..3]\"]\n# light\nmass = \"500 g\"",
        "frame.root = { at = \"[0.0, 0.0, L / 2]\", rotated = \"rpy(0, 0, 45 deg)\" }",
        "angle1 = { damping = \"3 N*mm*s\", start = \"tilt\" }",
        "bend = { value = \"pin[0].angle1\", in = \"deg\" }",
    ] {
        assert!(document.contains(kept), "{kept}\n{document}");
    }
    assert_eq!(read_toml(&document).scene, read_text(text).scene);
    assert!(read_text(text).scene.is_some());
    assert_eq!(text_to_toml("model Swing { body }"), None);
}

const LINK: &str = r#"
model = "Link<T>"
doc = "A link on a line."
gravity = "[0.0, 0.0, -9.81] m/s^2"
verify = true

[const]
L = "1.6 m"

[param.mass]
value = "2.0 kg"
in = "1 kg ..= 3 kg"
doc = "Mass of the link."

[input]
wind = "[speed; 3]"

[world.frame]
anchor = "[0.6, 0.3, 0.0] m"

[body.link]
mass = "mass"
inertia = "diag(0.17, 0.17, 0.02) kg*m^2"
frame.top = "[0.0, 0.0, 0.5] m"
frame.tip = { at = "[0.0, 0.0, -0.5] m", rotated = "rpy(0.0, 0.0, 90 deg)" }

[joint.link_free]
kind = "free"
from = "world"
to = "link.com"

[line."side[i in 0..2]"]
from = "world.anchor"
to = "link.top"
free_length = "L + i * 10 cm"
stiffness = "1 kN/m"

[load.drag]
on = "link"
at = "tip"
value = """
-(0.5 kg/s)
* (link.tip.velocity - wind)"""

[output]
pull = "side[1].tension"

[event.slack]
value = "side[0].tension"
falls = "0 N"

[body."bead[i in 0..2]"]
mass = "0.1 kg"
inertia = "diag(1e-4, 1e-4, 1e-4) kg*m^2"
frame."ear[j in 0..2]" = "[0.0, i * 1 cm, j * 1 cm]"

[joint."hold[i in 0..2]"]
kind = "spherical"
from = "link.tip"
to = "bead[i].ear[1 - i]"
"#;

/// The same scene as text.
const TEXT: &str = r#"
/// A link on a line.
model Link<T> {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    verify;
    const L = 1.6 m;
    /// Mass of the link.
    param mass = 2.0 kg in 1 kg ..= 3 kg;
    input wind: [speed; 3];
    world { frame anchor at [0.6, 0.3, 0.0] m }
    body link {
        mass: mass,
        inertia: diag(0.17, 0.17, 0.02) kg*m^2,
        frame top at [0.0, 0.0, 0.5] m,
        frame tip at [0.0, 0.0, -0.5] m rotated rpy(0.0, 0.0, 90 deg),
    }
    body bead[i in 0..2] {
        mass: 0.1 kg,
        inertia: diag(1e-4, 1e-4, 1e-4) kg*m^2,
        frame ear[j in 0..2] at [0.0, i * 1 cm, j * 1 cm],
    }
    joint link_free: free from world to link.com;
    joint hold[i in 0..2]: spherical from link.tip to bead[i].ear[1 - i];
    line side[i in 0..2] from world.anchor to link.top { free_length: L + i * 10 cm, stiffness: 1 kN/m }
    load drag on link at tip = -(0.5 kg/s) * (link.tip.velocity - wind);
    output pull = side[1].tension;
    event slack = side[0].tension falls 0 N;
}
"#;

#[test]
fn a_scene_written_by_hand_in_toml_is_the_scene_of_the_text() {
    let (toml, text) = (read_toml(LINK), read_text(TEXT));
    assert_eq!(told(&toml), Vec::<String>::new());
    assert_eq!(told(&text), Vec::<String>::new());
    assert_eq!(toml.scene, text.scene);
    assert!(toml.options.generic && toml.options.verify);
}

/// What is said about the scene above with one part replaced.
fn with(old: &str, new: &str) -> Vec<String> {
    assert!(LINK.contains(old), "{old}");
    told(&read_toml(&LINK.replacen(old, new, 1)))
}

const DOOR: &str = r#"
model = "Door"
gravity = "[0.0, 0.0, -9.81] m/s^2"

[param.closing]
value = "2.0 N*m/rad"

[body.door]
mass = "20 kg"
inertia = "diag(2.0, 1.0, 1.0) kg*m^2"

[body.bolt]
mass = "0.1 kg"
inertia = "diag(1e-4, 1e-4, 1e-4) kg*m^2"

[joint.hinges]
kind = "hinge"
from = "world"
to = "door.com"
axis = "z"
stiffness = "closing"
stops = "[-5 deg, 110 deg]"
stop_stiffness = "1 kN*m/rad"

[joint.bolting]
kind = "cylindrical"
from = "door.com"
to = "bolt.com"
slide = { friction = "0.2 N", friction_rate = "1 mm/s" }
angle.damping = "0.1 N*m*s"

[joint.lock]
kind = "spherical"
from = "bolt.com"
to = "world"
loop = true

[output.opening]
value = "hinges.angle"
in = "deg"
"#;

#[test]
fn joint_coordinates_have_tables_of_their_own() {
    let read = read_toml(DOOR);
    let scene = read
        .scene
        .clone()
        .unwrap_or_else(|| panic!("{}", told(&read).join("\n")));
    let [hinges, bolting, lock] = &scene.joints[..] else {
        panic!("three joints");
    };
    assert!(lock.cut && !hinges.cut);
    assert_eq!((hinges.forces.len(), bolting.forces.len()), (1, 2));
    assert_eq!(bolting.forces[1].damping, Some(0.1.into()));
    let text = r#"model Door {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param closing = 2.0 N*m/rad;
        body door { mass: 20 kg, inertia: diag(2.0, 1.0, 1.0) kg*m^2 }
        body bolt { mass: 0.1 kg, inertia: diag(1e-4, 1e-4, 1e-4) kg*m^2 }
        joint hinges: hinge from world to door.com { axis: z, stiffness: closing, stops: [-5, 110] deg, stop_stiffness: 1 kN*m/rad }
        joint bolting: cylindrical from door.com to bolt.com {
            slide: { friction: 0.2 N, friction_rate: 1 mm/s },
            angle: { damping: 0.1 N*m*s },
        }
        loop joint lock: spherical from bolt.com to world;
        output opening = hinges.angle in deg;
    }"#;
    assert_eq!(read_text(text).scene, Some(scene));
    let wrong = DOOR
        .replace("angle.damping", "angle.dampin")
        .replace("loop = true", "loop = 1");
    let messages = told(&read_toml(&wrong));
    assert!(
        messages[0].contains("unknown field `dampin`; did you mean `damping`?"),
        "{messages:?}"
    );
}

#[test]
fn a_byte_order_mark_in_front_changes_nothing() {
    let text = "model A { gravity: none; point a { mas: 1 kg } }";
    let marked = format!("\u{feff}{text}");
    let plain = |text: &str| told(&read_text(text));
    assert_eq!(plain(&marked), plain(text));
    assert_eq!(plain(&marked.replace("mas:", "mass:")), [""; 0]);
    let document = "model = \"A\"\ngravity = \"none\"\n[point.a]\nmass = \"1 kg\"\n";
    let marked = format!("\u{feff}{document}");
    assert_eq!(read_toml(&marked).scene, read_toml(document).scene);
    assert!(read_toml(&marked).scene.is_some());
}

#[test]
fn other_forms_of_values_are_the_scene_of_the_usual_ones() {
    let usual = r#"
model = "Forms"
gravity = "[0, 0, -9.81] m/s^2"
[param.m_tip]
value = "1 kg"
in = "0.5 kg ..= 3 kg"
[point.bob]
mass = "m_tip"
[event.later]
value = "time"
rises = "1 s"
set = "[m_tip = 2 kg]"
[event.last]
value = "time"
rises = "2 s"
set = "m_tip = 3 kg"
[load.air]
on = "bob"
value = "[0.1 N, 0, m_tip * 9.81 m/s^2]"
[output]
height = { value = "bob.position.z", in = "mm" }
[metric]
peak = { value = "max bob.position.z", in = "km", from = "0.1 s" }
lowest = { value = "min bob.position.z" }
"#;
    let forms = [
        ("\"[m_tip = 2 kg]\"", "{ m_tip = \"2 kg\" }"),
        ("set = \"m_tip = 3 kg\"", "set.m_tip = \"3 kg\""),
        (
            "\"[0.1 N, 0, m_tip * 9.81 m/s^2]\"",
            "[\"0.1 N\", 0, \"m_tip * 9.81 m/s^2\"]",
        ),
        (
            "{ value = \"bob.position.z\", in = \"mm\" }",
            "\"bob.position.z in mm\"",
        ),
        (
            "value = \"max bob.position.z\", in = \"km\"",
            "max = \"bob.position.z in km\"",
        ),
        ("{ value = \"min bob", "{ min = \"bob"),
    ];
    let wanted = read_toml(usual).scene.unwrap();
    let mut all = usual.to_owned();
    for (old, new) in forms {
        assert!(usual.contains(old), "{old}");
        let text = usual.replace(old, new);
        assert_eq!(read_toml(&text).scene.as_ref(), Some(&wanted), "{new}");
        all = all.replace(old, new);
    }
    let scene = read_toml(&all).scene;
    assert_eq!(scene.as_ref(), Some(&wanted));
    // The text form says the same.
    let text = mbd_compiler::toml_to_text(&all).unwrap();
    let scene = mbd_compiler::read_text(&text).scene;
    assert_eq!(scene.as_ref(), Some(&wanted), "{text}");
}

/// What an input of a value measures is what the value does, in both languages.
#[test]
fn an_input_takes_its_kind_from_its_value() {
    let text = "model A {
        gravity: none;
        const hold = 2 kN;
        input voltage = 6 V;
        input pull = hold;
        input aim = 90 deg;
        input spin = 60 rpm;
        input brake = 0;
        input wind = [8, 0, 0] m/s;
        input push: force = 1 kN;
        input lift: force;
        point bob { mass: 1 kg }
    }";
    let read = read_text(text);
    let scene = read
        .scene
        .clone()
        .unwrap_or_else(|| panic!("{:?}", told(&read)));
    let turn = std::f64::consts::TAU;
    let wanted = [
        ("voltage", "V", 1, 6.0),
        ("pull", "N", 1, 2000.0),
        ("aim", "rad", 1, turn / 4.0),
        ("spin", "rad/s", 1, turn),
        ("brake", "", 1, 0.0),
        ("wind", "m/s", 3, 8.0),
        ("push", "N", 1, 1000.0),
        ("lift", "N", 1, 0.0),
    ];
    for (input, (name, unit, components, default)) in scene.inputs.iter().zip(wanted) {
        assert_eq!(input.name, name);
        assert_eq!(
            (input.unit.text.as_str(), input.unit.factor),
            (unit, 1.0),
            "{name}"
        );
        assert_eq!(input.components, components, "{name}");
        assert!((input.default[0] - default).abs() < 1e-12, "{name}");
    }
    // What was left out stays left out on the way to TOML and back.
    let document = text_to_toml(text).unwrap();
    assert!(
        document.contains("voltage = \"6 V\"\n") && document.contains("lift = \"force\"\n"),
        "{document}"
    );
    assert_eq!(read_toml(&document).scene, read.scene, "{document}");
    let back = toml_to_text(&document).unwrap();
    assert!(
        back.contains("input voltage = 6 V;") && back.contains("input lift: force;"),
        "{back}"
    );
    assert_eq!(read_text(&back).scene, read.scene, "{back}");
    assert_eq!(read_toml(&write_toml(&scene)).scene, read.scene);
}

#[test]
fn an_input_of_toml_is_a_kind_a_value_or_both() {
    let document = |input: &str| {
        format!("model = \"A\"\ngravity = \"none\"\npoint.bob.mass = \"1 kg\"\n{input}\n")
    };
    let forms = [
        ("input.a = \"-6 V\"", "input a = -6 V;"),
        ("input.a = [\"8 m/s\", 0, 0]", "input a = [8 m/s, 0, 0];"),
        ("input.a = { value = \"6 V\" }", "input a = 6 V;"),
        ("input.a = 3", "input a = 3;"),
        ("input.a = \"1/s\"", "input a: 1/s;"),
        ("input.a = \"1/2\"", "input a = 1/2;"),
        ("input.a = \"[1/s; 3]\"", "input a: [1/s; 3];"),
        ("input.a = \"volume/s\"", "input a: volume/s;"),
    ];
    for (toml, text) in forms {
        let read = read_toml(&document(toml));
        let text = format!("model A {{ gravity: none; point bob {{ mass: 1 kg }} {text} }}");
        let wanted = read_text(&text).scene;
        assert!(wanted.is_some(), "{text}");
        assert_eq!(read.scene, wanted, "{toml}: {:?}", told(&read));
        let back = toml_to_text(&document(toml)).unwrap();
        assert_eq!(read_text(&back).scene, wanted, "{back}");
    }
}
