//! Scenes in TOML: the same scene, the same mistakes, each at its line and column.

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
    let text = include_str!("pass/actions.mbd");
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
        "/// A link on a line.\npub model Link<T> {",
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
        "[body.\"link[i in 0..3]\"]\nmass = \"500 g\"",
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

#[test]
fn mistakes_in_toml_are_told_with_line_and_column() {
    let cases: &[(&str, &str, &[&str])] = &[
        (
            "link.top\"\nfree",
            "link.tpo\"\nfree",
            &[
                "scene.toml:34:12: body `link` has no frame `tpo`; did you mean `top`? its frames: top, tip, com",
            ],
        ),
        (
            "world.anchor",
            "world.anchro",
            &[
                "scene.toml:33:15: the world has no frame `anchro`; did you mean `anchor`? its frames: anchor",
            ],
        ),
        (
            "\"1 kN/m\"",
            "\"1 kN\"",
            &["scene.toml:36:14: `stiffness` must be in N/m, this is a force (N)"],
        ),
        (
            "\"2.0 kg\"",
            "2.0",
            &[
                "scene.toml:11:9: `mass` needs a unit: mass (kg). write it as `2.0 kg`, or put `units: si;` at the top of the model",
            ],
        ),
        (
            "stiffness",
            "stifness",
            &[
                "scene.toml:36:1: unknown field `stifness`; did you mean `stiffness`? fields here: free_length, stiffness, force, damping, at_start",
            ],
        ),
        (
            "kind = \"free\"",
            "kind = \"revolute\"",
            &["scene.toml:28:9: unknown joint `revolute`; here it is called `hinge`"],
        ),
        (
            "diag(0.17, 0.17, 0.02)",
            "diag(0.17, 0.017, 0.002)",
            &[
                "scene.toml:23:12: no rigid body has these principal moments: the largest (0.17) exceeds the sum of the other two (0.019). check the unit, and that it is about the centre of mass",
            ],
        ),
        (
            "1 kg ..= 3 kg",
            "3 kg ..= 4 kg",
            &[
                "scene.toml:11:10: the default of `mass` lies outside its own range\nscene.toml:12:7: its range",
            ],
        ),
        (
            "from = \"world.anchor\"\n",
            "",
            &[
                "scene.toml:32:8: this line has no `from`; its keys: from, to, free_length, stiffness, force, damping, at_start",
            ],
        ),
        (
            "* (link.tip.velocity",
            "* (link.tip.velocty",
            &[
                "scene.toml:43:13: `link.tip` has no quantity `velocty`; did you mean `velocity`? known: position, velocity, acceleration, x, y, z",
            ],
        ),
        (
            "[body.link]",
            "[bdy.link]",
            &[
                "scene.toml:21:2: unknown item `bdy`; did you mean `body`? items here: coordinates, angular_velocity, planar, origin, units, gravity, emit, urdf, extend, verify, const, param, input, state, table, let, world, body, point, joint, line, spring, load, output, metric, event",
            ],
        ),
        (
            "mass = \"mass\"",
            "mass = [\"mass\"",
            &[
                "scene.toml:23:1: this is no TOML: missing comma between array elements, expected `,`",
            ],
        ),
        (
            "model = \"Link<T>\"",
            "",
            &["scene.toml:1:1: the scene has no name: add `model = \"Name\"` at its top"],
        ),
        (
            "verify = true",
            "verify = 1",
            &["scene.toml:5:1: `verify` is `true` or `false`"],
        ),
        (
            "[load.drag]\non",
            "[load.drag]\nunit = \"N\"\non",
            &[
                "scene.toml:39:1: unknown field `unit`; here it is called `in`. fields here: on, at, kind, value, in",
            ],
        ),
        (
            "value = \"side[0].tension\"",
            "value = true",
            &[
                "scene.toml:49:9: write this as a string in the language of `model!`, such as `\"2.0 kg\"`",
            ],
        ),
        (
            "pull = \"side[1].tension\"",
            "pull = \"side[1].tension + (1.0 N\"",
            &["scene.toml:46:27: this `(` is never closed: add `)`"],
        ),
        (
            "\"link.com\"",
            "\"link\\u002ecmo\"",
            &[
                "scene.toml:30:6: body `link` has no frame `cmo`; did you mean `com`? its frames: top, tip, com",
            ],
        ),
    ];
    for (old, new, wanted) in cases {
        assert_eq!(with(old, new), *wanted, "{new}");
    }
}

/// A body with one thing of every kind that may be repeated, `[?]` in the place of the repetition.
const REPEATED: &[(&str, &str)] = &[
    (
        "world frame",
        "[world.frame]\n\"hook[?]\" = \"[0, 0, 1] m\"",
    ),
    ("frame", "[body.base.frame]\n\"eye[?]\" = \"[0, 0, 1] m\""),
    (
        "body",
        "[body.\"link[?]\"]\nmass = \"1 kg\"\ninertia = \"diag(1, 1, 1) kg*m^2\"",
    ),
    ("point", "[point.\"knot[?]\"]\nmass = \"1 kg\""),
    (
        "joint",
        "[joint.\"hold[?]\"]\nkind = \"spherical\"\nfrom = \"world\"\nto = \"base.top\"",
    ),
    (
        "line",
        "[line.\"side[?]\"]\nfrom = \"world\"\nto = \"base.top\"\nfree_length = \"1 m\"\nstiffness = \"1 kN/m\"",
    ),
    (
        "spring",
        "[spring.\"coil[?]\"]\nfrom = \"world\"\nto = \"base.top\"\nfree_length = \"1 m\"\nstiffness = \"1 kN/m\"",
    ),
    (
        "load",
        "[load.\"push[?]\"]\non = \"base\"\nat = \"com\"\nvalue = \"[1, 0, 0] N\"",
    ),
    ("output", "[output]\n\"height[?]\" = \"base.position.z\""),
    (
        "event",
        "[event.\"low[?]\"]\nvalue = \"base.position.z\"\nfalls = \"0 m\"",
    ),
];

fn repeated(item: &str, repetition: &str) -> Reading {
    let base = r#"
model = "Base"
gravity = "none"
[joint.base_free]
kind = "free"
from = "world"
to = "base.com"
[body.base]
mass = "1 kg"
inertia = "diag(1, 1, 1) kg*m^2"
frame.top = "[0, 0, 1] m"
"#;
    let item = item.replace("?", repetition);
    match item.strip_prefix("[body.base.frame]\n") {
        Some(frame) => read_toml(&format!("{base}frame.{frame}\n")),
        None => read_toml(&format!("{base}{item}\n")),
    }
}

/// How many things of a kind the scene above has beside its base.
fn count(scene: &Scene, kind: &str) -> usize {
    match kind {
        "world frame" => scene.world_frames.len() - 1,
        "frame" => scene.bodies[0].frames.len() - 2,
        "body" => scene.bodies.len() - 1,
        "point" => scene.points.len(),
        "joint" => scene.joints.len() - 1,
        "load" => scene.loads.len(),
        "output" => scene.outputs.len(),
        "event" => scene.events.len(),
        _ => scene.lines.len(),
    }
}

#[test]
fn as_many_things_are_resolved_as_are_declared_or_the_repetition_is_an_error() {
    let floating = "is attached to nothing";
    for (kind, item) in REPEATED {
        for (repetition, number) in [
            ("i in 0..3", 3),
            ("i in 2..=3", 2),
            ("i in 1..1", 0),
            ("4", 1),
        ] {
            let reading = repeated(item, repetition);
            let told = told(&reading);
            let serious: Vec<&String> = told.iter().filter(|t| !t.contains(floating)).collect();
            assert!(serious.is_empty(), "{kind} [{repetition}]: {serious:?}");
            assert_eq!(
                count(&reading.skeleton, kind),
                number,
                "{kind} [{repetition}]"
            );
        }
        for repetition in [
            "1 in 0..3",
            "< in 0..3",
            "* in 0..3",
            "1.5 in 0..3",
            "{} in 0..3",
            "in 0..3",
            "i in",
            "i in 0",
            "i in 0..",
            "i in ..3",
            "i on 0..3",
            "i, in 0..3",
            "i in 0..3, 4",
            "i",
            "*",
            "",
        ] {
            let reading = repeated(item, repetition);
            let told = told(&reading);
            assert!(reading.scene.is_none(), "{kind} [{repetition}] was read");
            assert!(
                told.iter().all(|told| told.contains("[i in 0..3]")
                    || told.contains("index")
                    || told.contains("parameter")
                    || told.contains("expected")),
                "{kind} [{repetition}]: {told:?}"
            );
            assert_eq!(told.len(), 1, "{kind} [{repetition}]: {told:?}");
        }
    }
    assert_eq!(
        told(&repeated(REPEATED[1].1, "1 in 0..3")),
        [
            "scene.toml:12:12: expected the name of an index before `in`, found `1`: write a word, such as `eye[i in 0..3]`"
        ]
    );
}

#[test]
fn no_toml_makes_the_reader_panic() {
    let mut seed = 0x5EED_u64;
    let mut below = |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize % n
    };
    let signs: Vec<char> = "\"'[]{}=.,\n#\\ 0azé²^*".chars().collect();
    for _ in 0..5_000 {
        let mut text: Vec<char> = LINK.chars().collect();
        for _ in 0..=below(4) {
            let at = below(text.len());
            match below(3) {
                0 => drop(text.remove(at)),
                1 => text[at] = signs[below(signs.len())],
                _ => text.insert(at, signs[below(signs.len())]),
            }
        }
        let text: String = text.into_iter().collect();
        let reading = read_toml(&text);
        assert!(reading.scene.is_some() != reading.errors.iter().any(|e| !e.places.is_empty()));
    }
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
fn words_of_a_document_that_are_not_ours_are_answered() {
    let answers = [
        (
            "[body.rod]\nmass = \"1 kg\"\nframe.m[0] = \"[0, 0, 1] m\"",
            "scene.toml:5:8: a name with an index stands in quotes as a key of TOML: `\"m[0]\"`",
        ),
        (
            "[body.link[0]]\nmass = \"1 kg\"",
            "a name with an index stands in quotes as a key of TOML: `\"link[0]\"`",
        ),
        (
            "[bodies.rod]\nmass = \"1 kg\"",
            "unknown item `bodies`; here it is called `body`",
        ),
        (
            "name = \"A\"",
            "unknown item `name`; the name of a scene is that of its model: `model Name { … }`, in TOML `model = \"Name\"`",
        ),
        ("mass == \"1 kg\"", "this is no TOML"),
    ];
    for (lines, answer) in answers {
        let told = told(&read_toml(&format!(
            "model = \"A\"\ngravity = \"none\"\n{lines}\n"
        )));
        assert!(told.join("\n").contains(answer), "{told:?}");
    }
}

#[test]
fn keys_that_people_guess_are_answered_once_with_what_is_written() {
    let answers = [
        (
            "[param.k]\ndefault = \"3 m\"",
            "unknown field `default`; here it is called `value`",
        ),
        (
            "[let]\na = { vlaue = \"3 m\" }",
            "unknown field `vlaue`; did you mean `value`?",
        ),
        (
            "[output.o]\nexpression = \"1 m\"",
            "unknown field `expression`; here it is called `value`",
        ),
        (
            "[load.push]\non = \"bob\"\nforce = \"[0, 0, 1] N\"",
            "unknown field `force`; here it is called `value`",
        ),
        (
            "[metric.m]\nmax = \"bob.position.z\"",
            "this metric has no `value`: write `metric.highest = { value = \"max bob.position.z\", from = \"1 s\" }`",
        ),
        (
            "[event.e]\nwhen = \"time rises 1 s\"",
            "this event has no `value`: write `event.low = { value = \"bob.position.z\", falls = \"-1 m\" }`",
        ),
        (
            "[event]\ne = \"time rises 1 s\"",
            "in TOML `rises` is a key of its own: `{ value = \"bob.position.z\", rises = \"1 m\" }`",
        ),
        (
            "[table.rho]\n\"0 km\" = \"1 kg\"\n\"1 km\" = \"2 kg\"",
            "this table has no `value`: write `table.rho = \"{ 0 km: 0.0145 kg/m^3, 10 km: 0.006 kg/m^3 }\"`",
        ),
        (
            "[input.wind]\nvalue = \"[8, 0, 0] m/s\"",
            "this input has no `kind`: write `input.wind = { kind = \"speed\", value = \"[8, 0, 0] m/s\" }`",
        ),
        (
            "[input]\nwind = \"[8, 0, 0] m/s\"",
            "expected the kind of the input: a quantity or a unit of SI",
        ),
        (
            "[input]\nwind = \"speed = [8, 0, 0] m/s\"",
            "in TOML the default of an input is a key of its own: `{ kind = \"speed\", value = \"[8, 0, 0] m/s\" }`",
        ),
        (
            "[body.rod]\nmass = \"1 kg\"\ninertia = \"diag(1, 1, 1) kg*m^2\"\nfram.top = \"[0, 0, 1] m\"\n[joint.pin]\nkind = \"hinge\"\nfrom = \"world\"\nto = \"rod.com\"\naxis = \"y\"",
            "unknown field `fram`; did you mean `frame`?",
        ),
        (
            "[rnu]\nuntil = \"3 s\"",
            "unknown item `rnu`; did you mean `run`?",
        ),
    ];
    for (lines, answer) in answers {
        let document =
            format!("model = \"A\"\ngravity = \"none\"\npoint.bob.mass = \"1 kg\"\n{lines}\n");
        let told = told(&read_toml(&document));
        assert!(
            told.len() == 1 && told[0].contains(answer),
            "{lines}: {told:#?}"
        );
    }
}

/// What a message says to write.
#[test]
fn the_forms_that_messages_of_toml_propose_are_read() {
    let document = "model = \"A\"\ngravity = \"none\"\n\
        const.L = \"2.1 m\"\n\
        param.m_tip = { value = \"761 kg\", in = \"600 kg ..= 900 kg\" }\n\
        input.wind = { kind = \"speed\", value = \"[8, 0, 0] m/s\" }\n\
        state.seen = { start = \"0 m\", rate = \"(bob.position.x - seen) / (20 ms)\" }\n\
        table.rho = \"{ 0 km: 0.0145 kg/m^3, 10 km: 0.006 kg/m^3 }\"\n\
        let.speed = \"norm(bob.velocity)\"\n\
        load.push = { on = \"rod\", at = \"tip\", value = \"[0, 0, 5] N\" }\n\
        output.bend = { value = \"pin.angle\", in = \"deg\" }\n\
        metric.highest = { value = \"max bob.position.z\", from = \"1 s\" }\n\
        event.low = { value = \"bob.position.z\", falls = \"-1 m\" }\n\
        joint.pin = { kind = \"hinge\", from = \"world\", to = \"rod.tip\", axis = \"y\" }\n\
        point.bob.mass = \"1 kg\"\n\
        [body.rod]\nmass = \"1 kg\"\ninertia = \"diag(1, 1, 1) kg*m^2\"\nframe.tip = \"[0, 0, 1] m\"\n";
    let read = read_toml(document);
    assert!(read.scene.is_some(), "{:?}", told(&read));
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
