//! Animated glTF files of runs: whole, consistent, and where the history says.

use mbd_report::{Run, gltf};
use mbd_runtime::{Content, Options, Sampling, Simulation, Trajectory, model};
use serde_json::Value;

model! {
    /// A brick that flies, a stone on a line.
    model Flight {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame hook at [0.0, 0.0, 2.0] m }
        body brick {
            mass: 2 kg,
            shape: [box [0.2, 0.3, 0.4] m, sphere { radius: 5 cm } at [0.0, 0.0, 0.3] m],
            start at [0.0, 1.0, 0.0] m velocity [1.0, 0.0, 3.0] m/s
                angular_velocity [1.0, 2.0, 3.0] rad/s,
        }
        body plain { mass: 1 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2 }
        point stone { mass: 1 kg, start at [0.5, 0.0, 1.0] m }
        joint one: free from world to brick.com;
        joint two: free from world to plain.com;
        line cord from world.hook to stone { free_length: 1 m, stiffness: 2 kN/m }
        event over = brick.velocity.z falls 0 m/s;
    }
}

fn flown(content: Content) -> Trajectory {
    let model = Flight::new(FlightParams::default()).expect("no params");
    let mut history = Trajectory::new(&model, Sampling::Steps, content);
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("a model that runs");
    run.record(1.0, &mut history).expect("a run that ends");
    history
}

/// The document and the numbers of a binary file.
fn parts(bytes: &[u8]) -> (Value, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four")) as usize;
    assert_eq!(
        (&bytes[..4], word(4), word(8)),
        (&b"glTF"[..], 2, bytes.len())
    );
    let json = word(12);
    assert_eq!((&bytes[16..20], json % 4), (&b"JSON"[..], 0));
    let numbers = &bytes[28 + json..];
    assert_eq!((word(20 + json), numbers.len() % 4), (numbers.len(), 0));
    (
        serde_json::from_slice(&bytes[20..20 + json]).expect("JSON"),
        numbers,
    )
}

fn floats(document: &Value, numbers: &[u8], accessor: &Value) -> Vec<f32> {
    let accessor = &document["accessors"][accessor.as_u64().expect("a number") as usize];
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
    let [from, length] =
        ["byteOffset", "byteLength"].map(|key| view[key].as_u64().expect("bytes") as usize);
    let bytes = &numbers[from..from + length];
    bytes
        .chunks_exact(4)
        .map(|four| f32::from_le_bytes(four.try_into().expect("four")))
        .collect()
}

#[test]
fn bodies_are_where_the_history_has_them_and_turn_by_unit_quaternions() {
    let history = flown(Content::ALL);
    let scene = Flight::scene();
    let bytes = gltf(&Run::new(&scene, &[], &history)).expect("a motion");
    let (document, numbers) = parts(&bytes);
    let animation = &document["animations"][0];
    let course = |name: &str, path: &str| {
        let nodes = document["nodes"].as_array().expect("nodes");
        let node = nodes
            .iter()
            .position(|node| node["name"] == name)
            .expect("a node");
        let channels = animation["channels"].as_array().expect("channels");
        let channel = channels
            .iter()
            .find(|channel| channel["target"]["node"] == node && channel["target"]["path"] == path);
        let sampler = channel.expect("a channel")["sampler"]
            .as_u64()
            .expect("a number");
        let sampler = &animation["samplers"][sampler as usize];
        ["input", "output"].map(|end| floats(&document, numbers, &sampler[end]))
    };
    let [times, places] = course("brick", "translation");
    assert!(times.is_sorted_by(|a, b| a < b) && times[0] == 0.0);
    assert_eq!(times.last(), Some(&1.0));
    for (time, place) in times.iter().zip(places.chunks_exact(3)) {
        let t = f64::from(*time);
        // The middle of the box and the ball is above the origin; the flight is that of a stone.
        let wanted = 3.0 * t - 0.5 * 9.81 * t * t;
        assert!((f64::from(place[2]) - wanted).abs() < 1e-5, "{t}");
        assert!((f64::from(place[0]) - t).abs() < 1e-5, "{t}");
    }
    let [_, turns] = course("brick", "rotation");
    for turn in turns.chunks_exact(4) {
        let length: f32 = turn.iter().map(|x| x * x).sum();
        assert!((length - 1.0).abs() < 1e-5);
    }
    let [_, scales] = course("cord", "scale");
    let stone = ["x", "y", "z"].map(|axis| {
        let column = history.column(&format!("stone.{axis}"));
        column
            .and_then(|column| column.last().copied())
            .expect("a place")
    });
    let length = (stone[0].powi(2) + stone[1].powi(2) + (stone[2] - 2.0).powi(2)).sqrt();
    let last = scales.last().copied().expect("a scale");
    assert!((f64::from(last) - length).abs() < 1e-5, "{last} {length}");
    // Up is y there.
    let root = document["nodes"]
        .as_array()
        .and_then(|nodes| nodes.last())
        .expect("a root");
    let turn: Vec<f64> = root["rotation"]
        .as_array()
        .expect("a turn")
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    assert!(
        (turn[0] + std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-6
            && (turn[3] + turn[0]).abs() < 1e-6
    );
}

#[test]
fn a_history_without_motion_makes_no_file() {
    let scene = Flight::scene();
    assert!(gltf(&Run::new(&scene, &[], &flown(Content::RESULTS))).is_none());
}
