//! Frames and inertias as they are written and as they are kept.

use mbd_compiler::read_text;
use mbd_scene::Formula;

#[test]
fn a_frame_is_rotated_about_one_axis() {
    let rows = |rotated: &str| {
        let text = format!(
            "model S {{ gravity: none; const AXIS = [1, 1, 1]; param tilt = 30 deg in 0 deg ..= 90 deg;
             body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame f at [0, 0, 0] m rotated {rotated} }}
             joint f: free from world to a.com; }}"
        );
        let reading = read_text(&text);
        let scene = reading
            .scene
            .unwrap_or_else(|| panic!("{:?}", reading.errors));
        scene.bodies[0].frames[1].rotation.clone().expect("rotated")
    };
    // A third of a turn about the diagonal carries x to y, y to z and z to x.
    let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for written in [
        "about([2, 2, 2], 120 deg)",
        "about(AXIS, 120 deg)",
        "about([-1, -1, -1], -120 deg)",
    ] {
        let found = rows(written).map(|row| {
            row.map(|formula| match formula {
                Formula::Number(number) => number,
                other => panic!("{other:?}"),
            })
        });
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!(
                (found - expected).abs() < 1e-15,
                "{written}: {found} for {expected}"
            );
        }
    }
    // About an axis of the frame it is the rotation that was there before, zeros and all; angles may be params.
    assert_eq!(rows("about(x, 30 deg)"), rows("rpy(30 deg, 0, 0)"));
    assert_eq!(rows("about([0, 0, 2], 90 deg)"), rows("rpy(0, 0, 90 deg)"));
    assert_eq!(rows("about(-y, 90 deg)"), rows("rpy(0, -90 deg, 0)"));
    assert_eq!(rows("about(z, tilt)"), rows("rpy(0, 0, tilt)"));
}

#[test]
fn frames_are_measured_from_the_centre_of_mass() {
    let path = format!("{}/tests/pass/knots.mbd", env!("CARGO_MANIFEST_DIR"));
    let scene = read_text(&std::fs::read_to_string(path).unwrap())
        .scene
        .unwrap();
    let tip = &scene.bodies[0].frames[2];
    assert_eq!(tip.name, "tip");
    assert_eq!(tip.position, [0.0, 0.0, -0.25].map(Formula::Number));
    assert_eq!(
        scene.bodies[0].frames[0].position,
        [0.0; 3].map(Formula::Number)
    );
}

#[test]
fn products_of_inertia_change_their_sign_and_matrix_elements_do_not() {
    let with = |note: &str| {
        let text = format!(
            "model S {{ gravity: none; body a {{ mass: 1 kg, inertia: full {{ xx: 1.0, yy: 1.0, zz: 1.5, xy: 0.1 }} kg*m^2 ({note}) }}
             joint f: free from world to a.com; }}"
        );
        read_text(&text).scene.unwrap().bodies[0].inertia.xy.clone()
    };
    assert_eq!(with("matrix elements"), Formula::Number(0.1));
    assert_eq!(with("products of inertia"), Formula::Number(-0.1));
}
