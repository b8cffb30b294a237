//! Motions at constant rates: steady ones, and balances of an instant.

use super::*;

/// A rotor that is not balanced whirls: what holds at one angle does not at the next.
#[test]
fn a_balance_of_one_instant_is_no_steady_motion() {
    let folder = Folder::new("linearise_whirl");
    let told = |eccentric: &str, family: &str| {
        let scene = folder.file(
            "rotor.mbd",
            &format!(
                "model Rotor {{ planar: xy; coordinates: {family}; gravity: none; const e = {eccentric};
                    body disc {{ mass: 10 kg, inertia: 0.1 kg*m^2, frame shaft at [-e, 0, 0] }}
                    joint bearing: planar from world to disc.shaft {{ axis: z,
                        x: {{ stiffness: 100 kN/m, damping: 100 N*s/m }}, y: {{ stiffness: 100 kN/m, damping: 100 N*s/m }}, angle: {{ start_rate: 50 rad/s }} }} }}"
            ),
        );
        run(&[
            "linearise",
            &scene,
            "--trim",
            "--rate",
            "bearing.angle=50rad/s",
        ])
        .unwrap()
    };
    for family in ["absolute", "relative"] {
        let whirls = told("1 mm", family);
        assert!(
            whirls.contains("Balance at this instant")
                && whirls.contains("as `bearing.angle` goes on"),
            "{whirls}"
        );
        let turns = told("0 mm", family);
        assert!(
            turns.contains("Steady motion") && !turns.contains("this instant"),
            "{turns}"
        );
    }
}

/// What time moves by itself is in balance at one instant, and at no rest.
#[test]
fn a_balance_of_what_time_drives_is_one_of_an_instant() {
    let folder = Folder::new("linearise_driven");
    let told = |world: &str, joint: &str| {
        let text = format!(
            "model M {{ gravity: [0, 0, -9.81] m/s^2; {world}
                body b {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame r at [0, 0, 1] m }}
                joint a: hinge from world{joint} }}"
        );
        run(&["linearise", &folder.file("driven.mbd", &text), "--trim"]).unwrap()
    };
    let still = "world { frame w at [0.1 m, 0, 0] }";
    let shaken = "world { frame w at [0.1 m * sin(30 rad/s * time), 0, 0] }";
    for (world, joint, names) in [
        (
            shaken,
            ".w to b.r { axis: y }",
            "`world.w` changes with time",
        ),
        (
            still,
            ".w to b.r { axis: y, force: 3 N*m*sin(2 rad/s*time) }",
            "`a` changes with time",
        ),
    ] {
        let told = told(world, joint);
        assert!(
            told.contains("Balance at this instant") && told.contains(names),
            "{told}"
        );
    }
    let told = told(still, ".w to b.r { axis: y }");
    assert!(
        told.contains("Rest") && !told.contains("this instant"),
        "{told}"
    );
}

/// Orbits of any period are similar: what is said of one is said of all.
#[test]
fn a_linear_system_that_changes_along_an_orbit_is_told_however_slow_it_is() {
    let folder = Folder::new("linearise_orbit");
    let mut notes = [1.0, 0.03, 1e-3].map(|n: f64| {
        let text = format!(
            "model O {{ gravity: point_mass {{ mu: {:e} m^3/s^2, center: [0, 0, 0] m }};
                point p {{ mass: 3 kg, start at [1, 0, 0] m velocity [0, {n:e}, 0] m/s }} }}",
            n * n
        );
        let told = run(&["linearise", &folder.file("orbit.mbd", &text)]).unwrap();
        let note = told
            .lines()
            .find(|line| line.contains("this linear system changes"));
        note.unwrap_or_else(|| panic!("{n}: {told}")).to_owned()
    });
    notes.sort();
    assert_eq!(notes[0], notes[2]);
}
