//! Robots from URDF: what becomes of them, and what a file says wrongly, told at its place.

mod dice;

use dice::Dice;
use std::path::{Path, PathBuf};

use mbd_compiler::{Interpreted, Reading, read_text_in, read_urdf};
use mbd_scene::solids::Solid;
use mbd_scene::{
    Arguments, Formula, Layout, Model, Quantity, Scene, StartFrom, declared_parts, place_declared,
};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;

const ARM: &str = include_str!("urdf/arm.urdf");

fn told(reading: &Reading) -> String {
    let lines: Vec<String> = reading
        .errors
        .iter()
        .map(|m| m.in_file("arm.urdf"))
        .collect();
    lines.join("\n")
}

fn scene(reading: Reading) -> Scene {
    reading
        .scene
        .clone()
        .unwrap_or_else(|| panic!("{}", told(&reading)))
}

/// A declaration beside the robots of these tests.
fn declared(text: &str) -> Reading {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/urdf");
    read_text_in(text, &folder)
}

fn number(formula: &Formula) -> f64 {
    match formula {
        Formula::Number(value) => *value,
        other => panic!("{other:?} is no number"),
    }
}

#[test]
fn links_become_bodies_and_joints_joints() {
    let reading = read_urdf(ARM);
    assert!(reading.warnings.is_empty(), "{:?}", reading.warnings);
    let scene = scene(reading);
    assert_eq!(scene.name, "SmallArm");
    let bodies: Vec<&str> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(
        bodies,
        ["upper", "fore", "wrist", "finger_left", "finger_right"]
    );
    let joints: Vec<(&str, &str)> = scene
        .joints
        .iter()
        .map(|joint| (joint.name.as_str(), joint.law.keyword()))
        .collect();
    assert_eq!(
        joints,
        [
            ("shoulder", "hinge"),
            ("elbow", "hinge"),
            ("wrist_roll", "hinge"),
            ("grip", "prismatic"),
            ("grip_mirror", "prismatic"),
            ("grip_mirror_mimic", "gear"),
        ]
    );
    let layout = Layout::new(&scene);
    assert_eq!(layout.freedoms(), 4);
}

#[test]
fn links_that_are_fixed_to_each_other_are_one_body_with_their_mass_and_inertia() {
    let scene = scene(read_urdf(ARM));
    let wrist = scene
        .bodies
        .iter()
        .find(|body| body.name == "wrist")
        .unwrap();
    let names: Vec<&str> = wrist
        .frames
        .iter()
        .map(|frame| frame.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "com",
            "origin",
            "tool_mount",
            "camera",
            "grip",
            "grip_mirror"
        ]
    );
    assert!((number(&wrist.mass) - 0.6).abs() < 1e-15);
    // The origin lies at minus the common centre of mass, by hand.
    let turn = |axis: Vector3<f64>, angle: f64| nalgebra::Rotation3::new(axis * angle).into_inner();
    let rpy = |roll, pitch, yaw| {
        turn(Vector3::z(), yaw) * turn(Vector3::y(), pitch) * turn(Vector3::x(), roll)
    };
    let mount = (Vector3::new(0.0, 0.0, 0.05), rpy(0.0, 0.3, 0.0));
    let camera = (
        mount.0 + mount.1 * Vector3::new(0.03, 0.0, 0.01),
        mount.1 * rpy(0.2, 0.0, -0.4),
    );
    let parts = [
        (
            0.4,
            Vector3::new(0.01, 0.0, 0.02),
            rpy(0.0, std::f64::consts::FRAC_PI_2, 0.0),
            Matrix3::new(0.0006, 0.0, 0.00005, 0.0, 0.0005, 0.0, 0.00005, 0.0, 0.0004),
        ),
        (
            0.2,
            camera.0 + camera.1 * Vector3::new(0.0, 0.01, 0.03),
            camera.1 * rpy(0.1, 0.2, 0.3),
            Matrix3::from_diagonal(&Vector3::new(0.0001, 0.00012, 0.00009)),
        ),
    ];
    let center = (parts[0].1 * 0.4 + parts[1].1 * 0.2) / 0.6;
    let origin = &wrist.frames[1].position;
    for (have, want) in origin.iter().zip(center.iter()) {
        assert!((number(have) + want).abs() < 1e-15);
    }
    let mut inertia = Matrix3::zeros();
    for (mass, at, rotation, own) in parts {
        let arm: Vector3<f64> = at - center;
        let steiner = Matrix3::identity() * arm.norm_squared() - arm * arm.transpose();
        inertia += rotation * own * rotation.transpose() + steiner * mass;
    }
    let have = &wrist.inertia;
    let have = [&have.xx, &have.yy, &have.zz, &have.xy, &have.xz, &have.yz].map(number);
    let want = [
        inertia.m11,
        inertia.m22,
        inertia.m33,
        inertia.m12,
        inertia.m13,
        inertia.m23,
    ];
    for (have, want) in have.iter().zip(want) {
        assert!((have - want).abs() < 1e-17, "{have} {want}");
    }
}

/// A declaration of an arm with these fields behind its file and these items.
fn arm(fields: &str, items: &str) -> Reading {
    declared(&format!(
        "pub model Arm {{ urdf: \"arm.urdf\" {fields} {items} }}"
    ))
}

#[test]
fn a_declaration_adds_to_a_robot() {
    let reading = arm(
        "{ angle: { stop_stiffness: 1 kN*m/rad } }",
        "world { frame peg at [1.0, 0.0, 1.0] m }
         input drive: torque;
         extend shoulder { force: drive, damping: 2.0 N*m*s, start: 20 deg }
         extend fore { frame hook at [0.0, 0.0, 0.1] m }
         spring cord from world.peg to fore.hook { free_length: 0.5 m, stiffness: 100 N/m }
         output reach = wrist.camera.position;",
    );
    assert!(reading.warnings.is_empty(), "{:?}", reading.warnings);
    let scene = scene(reading);
    let forces = |name: &str| {
        let joint = scene.joints.iter().find(|joint| joint.name == name);
        joint.unwrap().forces.clone()
    };
    let [shoulder] = &forces("shoulder")[..] else {
        panic!("one coordinate");
    };
    // The declaration stands in for the file: 2.0, not 0.5.
    assert!(
        format!("{shoulder:?}").contains("damping: Some(Number(2.0))"),
        "{shoulder:?}"
    );
    assert!(format!("{shoulder:?}").contains("2.8"), "{shoulder:?}");
    // Without stiffness the limits of a URDF are no stops.
    assert!(!format!("{:?}", forces("grip")).contains("0.04"));
}

#[test]
fn a_base_may_fly() {
    let scene = scene(arm("{ base: free }", ""));
    let free = scene
        .joints
        .iter()
        .find(|joint| joint.law.keyword() == "free")
        .unwrap();
    assert_eq!(free.name, "base");
    assert_eq!(scene.bodies[0].name, "base_link");
    assert_eq!(Layout::new(&scene).freedoms(), 10);
}

#[test]
fn a_base_that_flies_starts_with_the_origin_of_its_link_at_the_origin_of_the_world() {
    let robot = "<robot name='drone'><link name='hull'><inertial>\
        <origin xyz='0.1 0.2 0.3' rpy='0.4 0.5 0.6'/><mass value='2'/>\
        <inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";
    let folder = Folder::with("flying_base", robot);
    let scene = folder.read("model Drone { urdf: \"arm.urdf\" { base: free } }");
    let layout = Layout::new(&scene);
    let mut state = vec![0.0; layout.nx()];
    declared_parts(&scene, &layout, StartFrom::new(&[], 0.0), &mut state);
    assert_eq!(state[..7], [0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0]);
}

#[cfg(feature = "toml")]
#[test]
fn a_document_takes_in_the_same_robot_as_a_text() {
    let document = "model = \"Arm\"\n[urdf]\nfile = \"arm.urdf\"\nbase = \"free\"\nangle = \"{ damping: 1 N*m*s }\"\n\
                    [extend.fore.frame.hook]\nat = \"[0, 0, 0.1] m\"\n[extend.grip]\nforce = \"2 N\"\n";
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/urdf");
    let from_document = scene(mbd_compiler::read_toml_in(document, &folder));
    let text = mbd_compiler::toml_to_text(document).unwrap();
    assert_eq!(from_document, scene(declared(&text)), "{text}");
    assert!(
        from_document.bodies[2]
            .frames
            .iter()
            .any(|frame| frame.name == "hook")
    );
    // Converted, the robot stands in the text itself.
    let written = mbd_compiler::write_toml(&from_document);
    assert_eq!(scene(mbd_compiler::read_toml(&written)), from_document);
    let one_line = scene(mbd_compiler::read_toml_in(
        "model = \"Arm\"\nurdf = \"arm.urdf\"",
        &folder,
    ));
    assert_eq!(one_line, scene(arm(";", "")));
}

#[test]
fn the_spelling_of_a_call_names_the_model_after_the_robot() {
    let scene = scene(declared(
        "urdf = \"arm.urdf\", output reach = wrist.camera.position;",
    ));
    assert_eq!(scene.name, "SmallArm");
    assert_eq!(scene.outputs.len(), 1);
}

/// What is wrong, and the arm with that mistake.
fn mistakes() -> Vec<(&'static str, String)> {
    let with = |from: &str, to: &str| {
        assert!(ARM.contains(from), "{from}");
        ARM.replacen(from, to, 1)
    };
    let joints = |joints: &str| ARM.replace("</robot>", &format!("{joints}</robot>"));
    let bomb =
        "<!DOCTYPE a [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]>\n<robot name=\"&b;\"/>";
    vec![
        ("nothing at all", String::new()),
        ("truncated", ARM[..ARM.len() / 2].to_owned()),
        ("entities", bomb.to_owned()),
        (
            "another language",
            "<mujoco><worldbody/></mujoco>".to_owned(),
        ),
        (
            "xacro",
            with(
                "<link name=\"camera\">",
                "<xacro:arm xmlns:xacro=\"http://www.ros.org/wiki/xacro\"/><link name=\"camera\">",
            ),
        ),
        ("no links", "<robot name=\"a\"/>".to_owned()),
        (
            "unknown joint type",
            with("type=\"continuous\"", "type=\"continous\""),
        ),
        ("no joint type", with(" type=\"continuous\"", "")),
        (
            "missing link",
            with("<parent link=\"fore\"/>", "<parent link=\"for\"/>"),
        ),
        ("missing parent", with("<parent link=\"fore\"/>", "")),
        (
            "missing mimicked joint",
            with("<mimic joint=\"grip\"/>", "<mimic joint=\"gripper\"/>"),
        ),
        (
            "mimics itself",
            with("<mimic joint=\"grip\"/>", "<mimic joint=\"grip_mirror\"/>"),
        ),
        (
            "link twice",
            with("<link name=\"camera\">", "<link name=\"fore\">"),
        ),
        ("joint twice", with("name=\"wrist_roll\"", "name=\"elbow\"")),
        ("no name", with("<link name=\"camera\">", "<link>")),
        (
            "carried twice",
            joints(
                "<joint name=\"loop\" type=\"revolute\"><parent link=\"base_link\"/><child link=\"wrist\"/></joint>",
            ),
        ),
        (
            "circle",
            with("<parent link=\"upper\"/>", "<parent link=\"wrist\"/>"),
        ),
        ("two roots", joints("<link name=\"stray\"/>")),
        ("NaN", with("mass value=\"2.5\"", "mass value=\"nan\"")),
        ("infinite", with("xyz=\"0 0 0.2\"", "xyz=\"0 0 inf\"")),
        ("two numbers", with("xyz=\"0 0 0.2\"", "xyz=\"0 0.2\"")),
        ("a comma", with("xyz=\"0 0 0.2\"", "xyz=\"0, 0, 0.2\"")),
        (
            "negative mass",
            with("mass value=\"2.5\"", "mass value=\"-2.5\""),
        ),
        (
            "negative damping",
            with("damping=\"0.5\"", "damping=\"-0.5\""),
        ),
        ("no mass", with("<mass value=\"2.5\"/>", "")),
        (
            "massless link that moves",
            with(
                "<mass value=\"0.05\"/>\n      <inertia ixx=\"0.00002\" iyy=\"0.00002\" izz=\"0.00001\"",
                "<mass value=\"0\"/>\n      <inertia ixx=\"0\" iyy=\"0\" izz=\"0\"",
            ),
        ),
        ("impossible inertia", with("ixx=\"0.030\"", "ixx=\"0.30\"")),
        ("negative inertia", with("ixx=\"0.030\"", "ixx=\"-0.30\"")),
        (
            "inertia of a point",
            with(
                "ixx=\"0.00002\" iyy=\"0.00002\" izz=\"0.00001\"",
                "ixx=\"0\" iyy=\"0\" izz=\"0\"",
            ),
        ),
        ("zero axis", with("xyz=\"0.6 0 0.8\"", "xyz=\"0 0 0\"")),
        (
            "misspelt element",
            with("<inertial>", "<inertail>").replacen("</inertial>", "</inertail>", 1),
        ),
        (
            "misspelt attribute",
            with("rpy=\"0 0 0.4\"", "rpz=\"0 0 0.4\""),
        ),
        (
            "quaternion",
            with("rpy=\"0 0 0.4\"", "quat_xyzw=\"0 0 0 1\""),
        ),
        (
            "second axis",
            with(
                "<axis xyz=\"0 0 1\"/>",
                "<axis xyz=\"0 0 1\"/><axis xyz=\"1 0 0\"/>",
            ),
        ),
        (
            "nothing moves",
            "<robot name=\"a\"><link name=\"b\"/></robot>".to_owned(),
        ),
        (
            "mimic of a planar joint",
            with(
                "name=\"grip\" type=\"prismatic\"",
                "name=\"grip\" type=\"planar\"",
            ),
        ),
    ]
}

#[test]
fn a_mistake_is_told_with_its_place_and_its_remedy() {
    let mut found = String::new();
    for (name, text) in mistakes() {
        let reading = read_urdf(&text);
        assert!(reading.scene.is_none(), "{name} was read");
        found.push_str(&format!("# {name}\n{}\n", told(&reading)));
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/urdf.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(path, &found).unwrap();
    }
    assert_eq!(found, std::fs::read_to_string(path).unwrap());
}

#[test]
fn a_declaration_is_told_where_in_the_file_a_mistake_is_and_where_it_names_the_file() {
    let lines = |fields: &str, items: &str| -> Vec<String> {
        let errors = arm(fields, items).errors;
        errors.iter().map(|message| message.to_string()).collect()
    };
    assert_eq!(
        lines(";", "extend shoulde { force: 2 N*m }"),
        ["1:43: the URDF declares nothing that is called `shoulde`; did you mean `shoulder`?"]
    );
    assert_eq!(
        lines("{ base: loose }", ""),
        ["1:42: this is `fixed` or `free`"]
    );
    assert_eq!(
        lines("{ bas: free }", ""),
        [
            "1:36: unknown field `bas`; did you mean `base`? fields here: base, inertias, angle, slide"
        ]
    );
    let told = |text: &str| -> Vec<String> {
        let errors = declared(text).errors;
        errors.iter().map(|message| message.to_string()).collect()
    };
    assert_eq!(
        told("model A { urdf: \"broken.urdf\"; extend a { force: 1 N } output b = c.position; }"),
        ["1:17: broken.urdf:4:12: `value` of `<mass>` is one finite number, not \"nan\""]
    );
    assert_eq!(
        told("model A { gravity: none; extend a { force: 1 N } }"),
        [
            "1:33: `extend` adds to what a `urdf` declares, and this declaration has none: write the fields where the thing is declared"
        ]
    );
    assert!(
        told("model A { urdf: \"missing.urdf\"; }")[0]
            .starts_with("1:17: cannot read missing.urdf: ")
    );
    assert_eq!(
        told("model A { urdf: arm; }"),
        ["1:17: expected the path of a URDF in quotes, such as `urdf: \"robots/arm.urdf\";`"]
    );
}

#[test]
fn whatever_a_file_holds_reading_ends_and_a_mistake_has_a_line() {
    let check = |bytes: &[u8]| {
        let reading = read_urdf(&String::from_utf8_lossy(bytes));
        match &reading.scene {
            // What can be read can be laid out.
            Some(scene) => assert!(Layout::new(scene).nv > 0),
            None => {
                let first = reading.errors[0].to_string();
                let line = first
                    .split(':')
                    .next()
                    .and_then(|line| line.parse::<usize>().ok());
                assert!(line.is_some_and(|line| line > 0), "{first}");
            }
        }
    };
    let arm = ARM.as_bytes();
    (0..arm.len()).step_by(7).for_each(|end| check(&arm[..end]));
    let mut dice = Dice(7);
    for _ in 0..600 {
        let mut bytes = arm.to_vec();
        for _ in 0..=dice.below(4) {
            let (at, other) = (dice.below(bytes.len()), dice.below(bytes.len()));
            match dice.below(5) {
                0 => {
                    bytes.remove(at);
                }
                1 => bytes.insert(at, bytes[other]),
                2 => bytes.swap(at, other),
                3 => bytes[at] = b"<>/\"0-e.&\0"[dice.below(10)],
                _ => {
                    let (from, to) = (at.min(other), at.max(other).min(at.min(other) + 300));
                    let copy = bytes[from..to].to_vec();
                    bytes.splice(from..from, copy);
                }
            }
        }
        check(&bytes);
    }
}

#[test]
fn a_file_that_is_too_large_or_too_deep_is_refused_soon() {
    let large = format!("<robot name=\"a\">{}</robot>", " ".repeat(100_000_000));
    assert_eq!(
        told(&read_urdf(&large)),
        "arm.urdf:1:1: 100000024 bytes are no robot"
    );
    let deep = format!(
        "{}{}",
        "<robot>".repeat(100_000),
        "</robot>".repeat(100_000)
    );
    assert!(read_urdf(&deep).scene.is_none());
    let links: String = (0..5000)
        .map(|i| format!("<link name=\"l{i}\"/>"))
        .collect();
    assert!(
        told(&read_urdf(&format!("<robot>{links}</robot>")))
            .contains("5000 links are more than 2000")
    );
    let attributes: String = (0..5000).map(|i| format!("a{i}=\"1\" ")).collect();
    assert_eq!(
        told(&read_urdf(&format!(
            "<robot name=\"r\">\n  <link {attributes}/></robot>"
        ))),
        "arm.urdf:2:3: 5000 attributes are more than 1000, which no element of a robot has"
    );
}

#[test]
fn simple_solids_are_shapes_and_meshes_are_left_out() {
    let shaped = |link: &str, geometry: &str| {
        let begin = format!("<link name=\"{link}\">");
        ARM.replace(&begin, &format!("{begin}{geometry}"))
    };
    let visual = "<visual><origin xyz=\"0 0 0.1\" rpy=\"0 1.5 0\"/><geometry><cylinder radius=\"0.02\" length=\"0.3\"/></geometry></visual>\
                  <collision><geometry><box size=\"1 1 1\"/></geometry></collision>";
    let drawn = scene(read_urdf(&shaped("upper", visual)));
    let [shape] = drawn.shapes.as_slice() else {
        panic!("{:?}", drawn.shapes);
    };
    assert_eq!((shape.body, shape.solid), (0, Solid::Cylinder));
    let sizes: Vec<f64> = shape.sizes.iter().map(number).collect();
    assert_eq!(sizes, [0.02, 0.3]);
    // Measured from the centre of mass, as frames are; the origin of the link is one of them.
    let origin = drawn.bodies[0].frames[1].position[2].clone();
    assert!((number(&shape.position[2]) - number(&origin) - 0.1).abs() < 1e-15);
    assert!(shape.rotation.is_some());
    // What a picture lacks stops no run.
    for odd in [
        "<visual><geometry><mesh filename=\"a.stl\"/></geometry></visual>",
        "<visual><geometry><box size=\"1 1\"/></geometry></visual>",
        "<visual><geometry><sphere radius=\"-1\"/></geometry></visual>",
        "<visual/>",
    ] {
        let reading = read_urdf(&shaped("upper", odd));
        let left_out = reading.notes.iter().any(|note| note.contains(" visual"));
        assert!(left_out, "{odd}: {:?}", reading.notes);
        assert!(scene(reading).shapes.is_empty(), "{odd}");
    }
}

#[test]
fn names_that_the_language_does_not_take_are_changed_and_told() {
    let text = ARM
        .replace("\"elbow\"", "\"at\"")
        .replace("\"upper\"", "\"2nd link\"")
        .replace("\"shoulder\"", "\"fore\"");
    let reading = read_urdf(&text);
    let note = reading
        .notes
        .iter()
        .find(|note| note.starts_with("names"))
        .unwrap()
        .clone();
    assert_eq!(
        note,
        "names of the URDF that differ here: link \"2nd link\" is `n2nd_link`, joint \"fore\" is `fore_joint`, joint \"at\" is `at_joint`, link \"tool mount\" is `tool_mount`"
    );
    scene(reading);
}

#[test]
fn an_inertia_that_no_body_has_is_let_through_on_request() {
    let unchecked =
        |fields: &str| declared(&format!("model A {{ urdf: \"impossible.urdf\" {fields} }}"));
    let refused = unchecked(";");
    assert!(
        refused.errors[0]
            .text
            .starts_with("impossible.urdf:4:81: the inertia of link \"bar\""),
        "{:?}",
        refused.errors
    );
    assert_eq!(
        scene(unchecked("{ inertias: unchecked }")).bodies[0]
            .inertia
            .zz,
        Formula::Number(3.0)
    );
}

/// The code of a declaration whose file lies beside these tests.
fn code(file: &str) -> String {
    let text = format!("pub model A {{ urdf: \"tests/urdf/{file}\"; }}");
    mbd_compiler::compile(text.parse().unwrap()).to_string()
}

#[test]
fn the_code_of_a_robot_names_its_file_so_that_a_change_is_seen() {
    for file in ["arm.urdf", "broken.urdf"] {
        let code = code(file);
        assert!(code.contains("include_bytes"), "{file}");
        assert!(
            code.contains(&format!("\"/\" , \"tests/urdf/{file}\"")),
            "{file}"
        );
    }
    // What is not there cannot be included: one error, not two.
    assert!(!code("missing.urdf").contains("include_bytes"));
}

#[test]
fn the_compiler_tells_file_line_and_element_of_a_mistake() {
    let place = "tests/urdf/broken.urdf:4:12: `value` of `<mass>` is one finite number";
    assert!(code("broken.urdf").contains(place));
}

/// A folder of one test, taken away at its end.
struct Folder(PathBuf);

impl Folder {
    fn with(name: &str, robot: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mbd_{name}_{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("arm.urdf"), robot).unwrap();
        Folder(path)
    }

    fn reading(&self, text: &str) -> Reading {
        read_text_in(text, &self.0)
    }

    fn read(&self, text: &str) -> Scene {
        scene(self.reading(text))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The arm without what Pinocchio leaves out of its accelerations.
fn plain() -> String {
    let kept = ARM
        .lines()
        .filter(|line| !["<dynamics", "<mimic"].iter().any(|tag| line.contains(tag)));
    kept.collect::<Vec<_>>().join("\n")
}

/// A declaration that starts the joints of a robot in a stored state; its outputs are their accelerations.
fn declaration(stored: &Value, fields: &str, settings: &str) -> String {
    let base = if stored["free"] == true {
        "free"
    } else {
        "fixed"
    };
    let mut text =
        format!("model Arm {{ urdf: \"arm.urdf\" {{ base: {base}{fields} }} {settings}\n");
    for (joint, state) in stored["state"].as_object().unwrap() {
        let (coordinate, unit) = match joint.starts_with("grip") {
            true => ("slide", "m"),
            false => ("angle", "rad"),
        };
        let [at, rate] = [0, 1].map(|k| state[k].as_f64().unwrap());
        text += &format!(
            "extend {joint} {{ start: {at:?} {unit}, start_rate: {rate:?} {unit}/s }}\n\
             output {joint}_acceleration = {joint}.{coordinate}_acceleration;\n"
        );
    }
    text + "}"
}

/// The outputs of a scene at its declared start.
fn at_start(scene: Scene) -> Vec<f64> {
    let layout = Layout::new(&scene);
    let mut state = vec![0.0; layout.nx()];
    layout
        .quaternions()
        .for_each(|upright| state[upright] = 1.0);
    place_declared(
        &scene,
        &layout,
        StartFrom::new(&[], 0.0),
        &[],
        &[],
        &mut state,
    )
    .unwrap();
    let zeros = |count: usize| vec![0.0; count];
    let instant = Arguments {
        time: 0.0,
        state,
        nodes: Vec::new(),
        effective: Vec::new(),
        hold: zeros(layout.one_way()),
        ends: zeros(layout.len(Quantity::AnchorStates)),
        inputs: Vec::new(),
        rows: zeros(layout.nc),
    };
    let model = Interpreted::new(scene, &[]).unwrap();
    let mut outputs = zeros(layout.len(Quantity::Outputs));
    model.evaluate(
        Quantity::Outputs,
        &instant.at(),
        &mut model.work(),
        &mut outputs,
    );
    outputs
}

/// The accelerations of a robot in all stored states are Pinocchio's, to rounding.
fn accelerates_as_pinocchio_says(name: &str, robot: &str, settings: &str) {
    accelerates_as_stored((name, robot), "urdf_arm.json", ["", settings]);
}

/// The same of those in a file; `fields` of the URDF, and `settings` of the model.
fn accelerates_as_stored((name, robot): (&str, &str), file: &str, [fields, settings]: [&str; 2]) {
    let stored = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/reference/robots");
    let text = std::fs::read_to_string(Path::new(stored).join(file)).unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    let folder = Folder::with(name, robot);
    for stored in file["states"].as_array().unwrap() {
        let text = declaration(stored, fields, settings);
        let found = at_start(folder.read(&text));
        let wanted = stored["acceleration"].as_object().unwrap().values();
        let wanted: Vec<f64> = wanted.map(|number| number.as_f64().unwrap()).collect();
        let scale = wanted.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
        assert_eq!(found.len(), wanted.len());
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!(
                (found - wanted).abs() < 1e-12 * scale,
                "{text}\n{found} {wanted}"
            );
        }
    }
}

#[test]
fn an_arm_with_its_base_at_rest_or_flying_accelerates_as_in_joint_coordinates() {
    accelerates_as_pinocchio_says("robot", &plain(), "angular_velocity: body;");
    accelerates_as_pinocchio_says("robot", &plain(), "angular_velocity: world;");
}

#[test]
fn links_without_mass_move_with_what_they_carry() {
    let hip = include_str!("urdf/hip.urdf");
    for family in ["relative", "auto"] {
        let settings = format!("coordinates: {family};");
        let how = [", inertias: unchecked", settings.as_str()];
        accelerates_as_stored(("leg", hip), "urdf_hip.json", how);
    }
    let folder = Folder::with("legs", hip);
    let told_of = |fields: &str, settings: &str| {
        let text = format!("model Leg {{ urdf: \"arm.urdf\" {{ {fields} }} {settings} }}");
        told(&folder.reading(&text))
    };
    let checked = told_of("base: fixed", "coordinates: relative;");
    for link in ["hip_ring", "hip_cross", "ankle_cross"] {
        let without = format!("link \"{link}\" moves and has no mass");
        assert!(checked.contains(&without), "{checked}");
    }
    let absolute = told_of("base: fixed, inertias: unchecked", "");
    let refused = "body `shank` has no mass, or a moment of inertia that is not positive";
    assert!(absolute.contains(refused), "{absolute}");
    // A foot without mass: nothing behind the ankle has any.
    let footless = hip.replace("<mass value=\"0.8\"/>", "<mass value=\"0\"/>");
    let footless = footless.replace(
        "ixx=\"0.001\" iyy=\"0.004\" izz=\"0.0045\"",
        "ixx=\"0\" iyy=\"0\" izz=\"0\"",
    );
    let folder = Folder::with("footless", &footless);
    let text = "model Leg { urdf: \"arm.urdf\" { inertias: unchecked } coordinates: relative; }";
    let footless = told(&folder.reading(text));
    for body in ["foot", "ankle_cross"] {
        let idle = format!("body `{body}` has no mass and carries nothing that has any");
        assert!(footless.contains(&idle), "{footless}");
    }
    assert!(!footless.contains("hip_ring"), "{footless}");
}

/// The elements of a robot, each with all that is inside it, in reverse order.
fn reversed(robot: &str) -> String {
    let mut elements: Vec<String> = Vec::new();
    for line in robot.lines().filter(|line| line.starts_with("  ")) {
        match line.starts_with("  <link")
            || line.starts_with("  <joint")
            || line.starts_with("  <material")
        {
            true => elements.push(line.to_owned()),
            false => {
                let last = elements.last_mut().unwrap();
                last.push('\n');
                last.push_str(line);
            }
        }
    }
    elements.reverse();
    format!(
        "<robot name=\"reversed\">\n{}\n</robot>",
        elements.join("\n")
    )
}

#[test]
fn the_order_of_links_and_joints_in_a_file_changes_nothing() {
    let robot = reversed(&plain());
    assert!(
        robot.find("finger_right") < robot.find("base_link"),
        "{robot}"
    );
    accelerates_as_pinocchio_says("reversed", &robot, "");
}

#[test]
fn a_slide_mimics_an_angle_and_an_angle_a_slide() {
    let robot = |from: &str, to: &str| {
        let joint = |name: &str, kind: &str, child: &str, mimic: &str| {
            format!(
                "<joint name='{name}' type='{kind}'><parent link='base'/><child link='{child}'/><axis xyz='0 1 0'/>\
                 <limit effort='1' velocity='1' lower='-9' upper='9'/>{mimic}</joint>"
            )
        };
        let link = |name: &str| {
            format!(
                "<link name='{name}'><inertial><mass value='1'/>\
                 <inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
            )
        };
        let mimic = "<mimic joint='leads' multiplier='0.35' offset='-0.1'/>";
        format!(
            "<robot name='r'>{}{}{}{}{}</robot>",
            link("base"),
            link("a"),
            link("b"),
            joint("leads", from, "a", ""),
            joint("follows", to, "b", mimic)
        )
    };
    for [from, to] in [
        ["revolute", "prismatic"],
        ["prismatic", "revolute"],
        ["revolute", "revolute"],
        ["prismatic", "prismatic"],
    ] {
        let folder = Folder::with("mimics", &robot(from, to));
        let [lead, follow] = [from, to].map(|kind| match kind {
            "revolute" => ("angle", "rad"),
            _ => ("slide", "m"),
        });
        let scene = folder.read(&format!(
            "model Arm {{ urdf: \"arm.urdf\" {{ base: fixed }} gravity: none;
                extend leads {{ start: 2 {} }}
                output follows_at = follows.{}; }}",
            lead.1, follow.0
        ));
        let found = at_start(scene);
        assert!((found[0] - 0.6).abs() < 1e-9, "{from} {to}: {found:?}");
    }
}
