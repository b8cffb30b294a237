//! Repeated items.

use mbd_compiler::read_text;

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
