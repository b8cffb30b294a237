//! `planar: auto`: the plane in which a scene moves, taken as if its word were written, and none where something leaves it.

use mbd_compiler::{emit, read_text, read_toml, write_toml};
use mbd_scene::Plane;

/// Bars between hinges about y, and a weight on a cord.
const BARS: &str = "model Bars {
    planar: auto;
    gravity: [0.0, 0.0, -9.81] m/s^2;
    param tilt = 0 rad;
    world { frame left at [0.0, 0.1, 0.0] m, frame right at [1.0, 0.0, 0.0] m, frame hook at [0.5, 0.0, 1.0] m }
    body crank { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame a at [-0.15, 0.1, 0.0] m, frame b at [0.15, 0.0, 0.0] m }
    body rod { mass: 2 kg, inertia: diag(0.13, 0.12, 0.11) kg*m^2, frame a at [-0.45, 0.0, 0.05] m, frame b at [0.45, 0.0, 0.05] m }
    body rocker { mass: 1.5 kg, inertia: diag(0.08, 0.09, 0.1) kg*m^2, frame a at [-0.4, 0.0, 0.0] m, frame b at [0.4, 0.0, 0.0] m }
    point weight { mass: 0.3 kg, start at [1.1, 0.0, 0.2] m }
    joint one: hinge from world.left to crank.a { axis: y, start: -60 deg }
    joint two: hinge from crank.b to rod.a { axis: y }
    joint three: hinge from rod.b to rocker.b { axis: y }
    joint four: hinge from world.right to rocker.a { axis: y }
    line cord from rocker.b to weight { free_length: 0.4 m, stiffness: 30 N/m }
    event late = time rises 1 s { set: tilt = 0.1 rad }
    output height = weight.position.z + 0 m * sin(tilt);
}";

/// What is taken, and the note of it.
fn taken(text: &str) -> (Option<Plane>, String) {
    let reading = read_text(text);
    assert!(reading.errors.is_empty(), "{:?}\n{text}", reading.errors);
    let mut notes = reading.notes.into_iter();
    let note = notes.find(|note| note.contains("`planar: auto`"));
    let scene = reading.scene.expect("a scene");
    (scene.planar, note.expect("a note"))
}

fn replaced(from: &str, to: &str) -> String {
    assert!(BARS.contains(from), "{from}");
    BARS.replacen(from, to, 1)
}

#[test]
fn a_plane_that_nothing_leaves_is_taken_as_if_its_word_were_written() {
    let rust = |plane: &str| {
        let mut reading = read_text(&replaced("planar: auto", &format!("planar: {plane}")));
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        reading.notes.clear();
        emit(&reading).to_string()
    };
    assert_eq!(taken(BARS).0, Some(Plane::Xz));
    assert_eq!(rust("auto"), rust("xz"));
    for family in ["absolute", "relative", "auto"] {
        let text = replaced(
            "planar: auto;",
            &format!("planar: auto; coordinates: {family};"),
        );
        assert_eq!(taken(&text).0, Some(Plane::Xz), "{family}");
    }
    // On bodies that hinges carry a load across the plane moves nothing.
    let load = "load wind on rod = [0.0, 0.1, 0.0] * 1 N; line cord";
    assert_eq!(taken(&replaced("line cord", load)).0, Some(Plane::Xz));
}

#[test]
fn what_leaves_a_plane_is_named_and_the_scene_stays_in_space() {
    for (from, to, why) in [
        ("start at [1.1, 0.0, 0.2]", "start at [1.1, 0.01, 0.2]", "`weight` does not start in it"),
        (
            "two: hinge from crank.b to rod.a { axis: y }",
            "two: hinge from crank.b to rod.a { axis: [0.0, 1.0, 0.1] }",
            "`weight` is accelerated out of it",
        ),
        (
            "frame b at [0.15, 0.0, 0.0] m",
            "frame b at [0.15, 0.2, 0.0] m",
            "0.2 m apart across it",
        ),
        (
            "line cord",
            "load wind on weight = [0.0, 0.1, 0.0] * 1 N; line cord",
            "`weight` is accelerated out of it",
        ),
        (
            "line cord",
            "load wind on weight = [0.0, 1e-4, 0.0] * 1 N; line cord",
            "`weight` is accelerated out of it",
        ),
        (
            "line cord",
            "input push: force; load wind on weight = [0.0, push, 0.0]; line cord",
            "`weight` is accelerated out of it",
        ),
        // Nothing of this is seen at the times and places that are looked at.
        (
            "line cord",
            "load gust on weight = [0.0, if(time > 40 s, 5 N, 0 N), 0.0]; line cord",
            "`weight` may be accelerated out of it, as far as its equations tell",
        ),
        (
            "line cord",
            "load wall on weight = [0.0, max(weight.position.x - 90 m, 0 m) * 1 N/m, 0.0]; line cord",
            "`weight` may be accelerated out of it, as far as its equations tell",
        ),
        (
            "line cord",
            "load wind on weight = [0.0, 1 N * sin(tilt), 0.0]; line cord",
            "`weight` is accelerated out of it, with other values of the params",
        ),
        (
            "start at [1.1, 0.0, 0.2] m",
            "start at [1.1 m, 1 m * sin(tilt), 0.2 m]",
            "`weight` does not start in it, with other values of the params",
        ),
        (
            "output height",
            "output shear = two.force.y; output height",
            "parts of the reaction of `two` across it are asked for",
        ),
        (
            "output height",
            "output turned = rod.orientation.y; output height",
            "`rod.orientation` is asked for",
        ),
        (
            "frame hook at [0.5, 0.0, 1.0] m",
            "frame hook at [0.5 m, 0.1 m * sin(time * 1 rad/s), 1.0 m]",
            "the frame `hook` of the world moves out of it",
        ),
        (
            "output height",
            "load wind on rod = [0.0, 0.1, 0.0] * 1 N; event torn = time rises 2 s { detach: two } event ripped = time rises 2 s { detach: three } output height",
            "`rod` is accelerated out of it",
        ),
        (
            "line cord",
            "point knot; line first from world.hook to knot { free_length: 0.4 m, stiffness: 30 N/m }
             line second from knot to rocker.b { free_length: 0.4 m, stiffness: 30 N/m } line cord",
            "points without mass",
        ),
    ] {
        let text = replaced(from, to);
        let (plane, note) = taken(&text);
        println!("{note}");
        assert_eq!(plane, None, "{to}: {note}");
        assert!(note.contains(why), "{to}: {note}");
    }
}

#[test]
fn what_lies_in_the_plane_is_no_reason_to_leave_it() {
    for (from, to) in [
        ("output height", "output shear = two.force.z; output height"),
        ("output height", "output bend = two.torque.y; output height"),
        (
            "frame hook at [0.5, 0.0, 1.0] m",
            "frame hook at [0.5 m + 0.1 m * sin(time * 1 rad/s), 0 m, 1.0 m]",
        ),
        (
            "output height",
            "event torn = time rises 2 s { detach: two } output height",
        ),
    ] {
        let (plane, note) = taken(&replaced(from, to));
        assert_eq!(plane, Some(Plane::Xz), "{to}: {note}");
    }
}

#[test]
fn what_is_written_back_names_the_plane() {
    let scene = read_text(BARS).scene.expect("a scene");
    let document = write_toml(&scene);
    assert!(document.contains("planar = \"xz\""), "{document}");
    let auto = read_toml(&document.replace("planar = \"xz\"", "planar = \"auto\""));
    assert_eq!(auto.scene.expect("a scene"), scene);
}

#[test]
fn a_word_that_is_no_plane_is_told_with_those_there_are() {
    let reading = read_text(&replaced("planar: auto", "planar: aut"));
    let told = format!("{:?}", reading.errors);
    assert!(told.contains("auto") && told.contains("xz"), "{told}");
}
