//! `coordinates: auto`: bodies that nothing turns, and whose attitude nothing asks for, are points with mass.

use mbd_compiler::read_text;

/// Two stones on cords, one behind the other, and a stone that is thrown.
const STONES: &str = "model Stones {
    coordinates: auto;
    gravity: [0.0, 0.0, -9.81] m/s^2;
    param moment = 0.1 kg*m^2;
    body upper { mass: 1 kg, inertia: [moment, moment, moment], start at [0, 0, -1] m }
    body lower { mass: 2 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, frame _side at [0.1, 0, 0] m, start at [0.1, 0, -2] m }
    body thrown[i in 0..2] { mass: 0.5 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, start at [i * 1 m, 5 m, 0 m] velocity [1, 0, 3] m/s }
    joint afloat: free from world to upper.com;
    joint swims: free from world to lower.com;
    joint flies[i in 0..2]: free from world to thrown[i].com;
    spring cord from world to upper.com { free_length: 1 m, stiffness: 20 N/m }
    spring below from upper.com to lower.com { free_length: 1 m, stiffness: 20 N/m }
    load air on thrown[0] = -0.1 N*s/m * thrown[0].velocity;
    output height = thrown[1].com.position.z;
    output energy = energy.total;
}";

/// The same, as its author would declare it with points.
const POINTS: &str = "model Stones {
    coordinates: auto;
    gravity: [0.0, 0.0, -9.81] m/s^2;
    param moment = 0.1 kg*m^2;
    point upper { mass: 1 kg, start at [0, 0, -1] m }
    point lower { mass: 2 kg, start at [0.1, 0, -2] m }
    point thrown[i in 0..2] { mass: 0.5 kg, start at [i * 1 m, 5 m, 0 m] velocity [1, 0, 3] m/s }
    spring cord from world to upper { free_length: 1 m, stiffness: 20 N/m }
    spring below from upper to lower { free_length: 1 m, stiffness: 20 N/m }
    load air on thrown[0] = -0.1 N*s/m * thrown[0].velocity;
    output height = thrown[1].position.z;
    output energy = energy.total;
}";

#[test]
fn bodies_that_nothing_turns_are_the_points_that_their_author_could_have_declared() {
    let found = read_text(STONES);
    assert!(found.errors.is_empty(), "{:?}", found.errors);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let note = found
        .notes
        .iter()
        .find(|note| note.contains("points with mass"));
    let note = note.expect("a note");
    assert!(note.ends_with(": `lower`, `thrown`, `upper`"), "{note}");
    let scene = found.scene.as_ref().expect("a scene");
    assert!(scene.bodies.is_empty() && scene.joints.is_empty() && scene.points.len() == 4);
    let declared = read_text(POINTS);
    assert!(declared.errors.is_empty(), "{:?}", declared.errors);
    let own = declared.scene.as_ref().expect("a scene");
    assert_eq!(own, scene);
}

#[test]
fn bodies_stay_bodies_where_something_turns_them_or_asks_how_they_are_turned() {
    for (from, to) in [
        ("to lower.com {", "to lower._side {"),
        ("load air", "load twist on lower = [0, 0, 1] N*m; load air"),
        (
            "output energy",
            "output spin = lower.omega_body; output energy",
        ),
        (
            "output energy",
            "output turned = lower.orientation; output energy",
        ),
        ("output energy", "output aim = lower.com.x; output energy"),
        (
            "output energy",
            "output edge = lower._side.position; output energy",
        ),
        (
            "start at [0.1, 0, -2] m",
            "start at [0.1, 0, -2] m rotated rpy(0.1 rad, 0 rad, 0 rad)",
        ),
        (
            "start at [0.1, 0, -2] m",
            "start at [0.1, 0, -2] m angular_velocity [0, 0, 1] rad/s",
        ),
        (
            "frame _side",
            "shape: sphere { radius: 0.1 m }, frame _side",
        ),
        (
            "joint swims: free from world to lower.com",
            "joint swims: spherical from world to lower._side",
        ),
        ("load air", "load wind on lower: external; load air"),
    ] {
        assert!(STONES.contains(from), "{from}");
        let reading = read_text(&STONES.replacen(from, to, 1));
        assert!(reading.errors.is_empty(), "{to}: {:?}", reading.errors);
        let bodies = reading.scene.expect("a scene").bodies;
        let kept: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
        assert!(kept.contains(&"lower"), "{to}: {kept:?}");
        println!("{to}: {kept:?}");
    }
    for family in ["absolute", "relative"] {
        let text = STONES.replace("coordinates: auto", &format!("coordinates: {family}"));
        assert_eq!(read_text(&text).scene.expect("a scene").bodies.len(), 4);
    }
}

#[test]
fn the_centre_of_mass_of_a_point_is_the_point() {
    let text = "model Bob { gravity: none; point bob { mass: 1 kg }
        spring cord from world to bob.com { free_length: 1 m, stiffness: 1 N/m }
        output away = bob.com.position.x; }";
    let reading = read_text(text);
    assert!(reading.errors.is_empty(), "{:?}", reading.errors);
}
