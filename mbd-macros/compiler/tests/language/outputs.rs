//! Outputs, their columns, and what may name them.

use super::{pendulum, told};
use mbd_compiler::Reading;

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
