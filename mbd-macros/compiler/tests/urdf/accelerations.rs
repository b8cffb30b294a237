//! Robots accelerate as Pinocchio says, and joints that mimic others follow them.

use std::path::{Path, PathBuf};

use mbd_compiler::{Interpreted, Reading, read_text_in};
use mbd_scene::{Arguments, Layout, Model, Quantity, Scene, StartFrom, place_declared};
use serde_json::Value;

use super::{ARM, scene, told};

/// A folder of one test, taken away at its end.
pub struct Folder(PathBuf);

impl Folder {
    pub fn with(name: &str, robot: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mbd_{name}_{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("arm.urdf"), robot).unwrap();
        Folder(path)
    }

    fn reading(&self, text: &str) -> Reading {
        read_text_in(text, &self.0)
    }

    pub fn read(&self, text: &str) -> Scene {
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
    accelerates_as_pinocchio_says("robot", &plain(), "coordinates: relative;");
}

#[test]
fn links_without_mass_move_with_what_they_carry() {
    let hip = include_str!("hip.urdf");
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
    for family in ["absolute", "relative"] {
        let settings = format!("coordinates: {family};");
        accelerates_as_pinocchio_says("reversed", &robot, &settings);
    }
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
