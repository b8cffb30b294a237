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
