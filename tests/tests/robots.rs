//! Robots from URDF move as Pinocchio says of the same file; what generated code makes of them is what the laws say.

use std::path::PathBuf;

use mbd_compiler::read_text_in;
use mbd_runtime::{Generic, Options, Quantity, Simulation, model};
use mbd_scene::{Model, Scene};
use serde_json::Value;
use tests::agreement::agrees;
use tests::assert_close;
use tests::reference::{load, numbers};
use tests::system::list;

model! {
    /// The arm with a drive in its shoulder and a cord at its forearm.
    pub model Arm<T> {
        urdf: "../mbd-macros/compiler/tests/urdf/arm.urdf" { slide: { stop_stiffness: 5 kN/m } }
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame peg at [1.0, 0.0, 1.0] m }
        input drive: torque;
        extend shoulder { force: drive, start: 20 deg }
        extend fore { frame hook at [0.0, 0.0, 0.1] m }
        spring cord from world.peg to fore.hook { free_length: 0.5 m, stiffness: 100 N/m }
        output reach = wrist.camera.position;
    }
}

const ARM: &str = include_str!("../../mbd-macros/compiler/tests/urdf/arm.urdf");

/// A folder of one test, taken away at its end.
struct Folder(PathBuf);

impl Folder {
    fn with(name: &str, robot: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mbd_{name}_{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        std::fs::write(path.join("arm.urdf"), robot).expect("a file");
        Folder(path)
    }

    fn read(&self, text: &str) -> Scene {
        let reading = read_text_in(text, &self.0);
        let told: Vec<String> = reading.errors.iter().map(ToString::to_string).collect();
        reading
            .scene
            .unwrap_or_else(|| panic!("{}", told.join("\n")))
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

/// A declaration that starts the joints of the arm in a stored state; its outputs are their accelerations.
fn declaration(stored: &Value, settings: &str) -> String {
    let base = if stored["free"] == true {
        "free"
    } else {
        "fixed"
    };
    let mut text = format!("model Arm {{ urdf: \"arm.urdf\" {{ base: {base} }} {settings}\n");
    for (joint, state) in stored["state"].as_object().expect("joints") {
        let (coordinate, unit) = match joint.starts_with("grip") {
            true => ("slide", "m"),
            false => ("angle", "rad"),
        };
        let [at, rate] = numbers(state)[..] else {
            panic!("{state}");
        };
        text += &format!(
            "extend {joint} {{ start: {at:?} {unit}, start_rate: {rate:?} {unit}/s }}\n\
             output {joint}_acceleration = {joint}.{coordinate}_acceleration;\n"
        );
    }
    text + "}"
}

/// The outputs of a scene at its declared start.
fn at_start(scene: Scene) -> Vec<f64> {
    let model = Generic::new(scene, &[]).expect("no params");
    let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
    simulation.start().expect("a consistent start");
    let mut outputs = vec![0.0; model.layout().columns];
    simulation
        .evaluate(Quantity::Outputs, &mut outputs)
        .expect("outputs");
    outputs
}

fn wanted(stored: &Value) -> Vec<f64> {
    let accelerations = stored["acceleration"].as_object().expect("joints");
    accelerations.values().flat_map(numbers).collect()
}

#[test]
fn an_arm_with_its_base_at_rest_or_flying_accelerates_as_in_joint_coordinates() {
    let file = load("robots/urdf_arm.json");
    let folder = Folder::with("robots", &plain());
    for stored in list(&file["states"]) {
        for settings in ["angular_velocity: body;", "angular_velocity: world;"] {
            let text = declaration(stored, settings);
            assert_close(
                &at_start(folder.read(&text)),
                &wanted(stored),
                1e-11,
                0.0,
                &text,
            );
        }
    }
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
                let last = elements.last_mut().expect("an element");
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
    let file = load("robots/urdf_arm.json");
    let robot = reversed(&plain());
    assert!(
        robot.find("finger_right") < robot.find("base_link"),
        "{robot}"
    );
    let folder = Folder::with("reversed", &robot);
    for stored in list(&file["states"]) {
        let text = declaration(stored, "");
        assert_close(
            &at_start(folder.read(&text)),
            &wanted(stored),
            1e-11,
            0.0,
            &text,
        );
    }
}

#[test]
fn the_generated_model_of_a_robot_is_that_of_the_laws() {
    let arm = Arm::<f64>::new(ArmParams::default()).expect("no params");
    assert_eq!(arm.layout().freedoms(), 4);
    agrees(&arm);
    let single = Arm::<f32>::new(ArmParams::default()).expect("no params");
    assert_eq!(single.layout().nv, arm.layout().nv);
}
