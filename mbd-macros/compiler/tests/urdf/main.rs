//! Robots from URDF: what becomes of them.

mod accelerations;
#[path = "../dice/mod.rs"]
mod dice;
mod mistakes;

use accelerations::Folder;
use mbd_compiler::{Reading, read_text_in, read_urdf};
use mbd_scene::solids::Solid;
use mbd_scene::{Formula, Layout, Scene, StartFrom, declared_parts};
use nalgebra::{Matrix3, Vector3};

const ARM: &str = include_str!("arm.urdf");

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
fn limits_that_leave_no_range_are_told() {
    let rotated = ARM.replacen(
        "lower=\"-2.8\" upper=\"2.8\"",
        "lower=\"2.8\" upper=\"-2.8\"",
        1,
    );
    assert_ne!(rotated, ARM);
    let reading = read_urdf(&rotated);
    let told = "limits that leave no range are left out, and never stops: joint \"shoulder\" (2.8 to -2.8)";
    assert!(
        reading.notes.iter().any(|note| note == told),
        "{:?}",
        reading.notes
    );
    assert!(
        !read_urdf(ARM)
            .notes
            .iter()
            .any(|note| note.contains("no range"))
    );
}

#[test]
fn an_angle_of_a_little_more_than_a_turn_is_what_the_file_says() {
    let attitude = |yaw: f64| {
        let rpy = format!("rpy=\"0 0 {yaw:?}\"");
        let rotated = scene(read_urdf(&ARM.replace("rpy=\"0 0 0.4\"", &rpy)));
        rotated
            .world_frames
            .iter()
            .map(|frame| frame.rotation.clone())
            .collect::<Vec<_>>()
    };
    assert_ne!(attitude(6.6832), attitude(0.4));
    assert_eq!(attitude(6.6832).len(), attitude(0.4).len());
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
