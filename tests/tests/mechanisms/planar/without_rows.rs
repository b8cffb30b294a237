//! Joints that forbid nothing in a plane: no row touches their bodies, and what acts along their coordinates does.

use mbd_runtime::{Generic, Options, Simulation};
use mbd_scene::{Model, Quantity};
use tests::declared::read;

/// A joint that forbids nothing in a plane has no row there: what acts along its coordinates acts on bodies that no row touches, and turns them.
#[test]
fn what_acts_along_a_joint_turns_bodies_that_no_row_holds() {
    let along = [
        "x: { force: 2 N }, y: { force: -1 N }, angle: { force: 1 N*m }",
        "angle: { stiffness: 3 N*m/rad, start: 0.4 rad, damping: 0.2 N*m*s }",
        "x: { stiffness: 20 N/m, start: 0.2 m }, y: { stiffness: 30 N/m, damping: 1 N*s/m }, angle: { start_rate: 1 rad/s, friction: 0.3 N*m, friction_rate: 0.2 rad/s }",
        "angle: { stops: [-0.2, 0.2] rad, stop_stiffness: 40 N*m/rad, stop_damping: 0.5 N*m*s, start_rate: 1.5 rad/s }",
    ];
    // The ground, a body that floats, a body on a hinge.
    let parents = [
        ("world.foot", ""),
        ("base.foot", "joint loose: free from world to base.com;"),
        (
            "base.foot",
            "joint pin: hinge from world to base.heel { axis: z, start: 0.3 rad }",
        ),
    ];
    let end = |along: &str, (parent, held): (&str, &str), [plane, family]: [&str; 2]| {
        let base = match held {
            "" => "",
            _ => {
                "body base { mass: 3 kg, inertia: diag(0.2, 0.3, 0.5) kg*m^2, frame foot at [0.3, 0.2, 0.0] m, frame heel at [-0.2, 0.1, 0.0] m }"
            }
        };
        let scene = read(&format!(
            "model Table {{ {plane} coordinates: {family}; gravity: none;
                world {{ frame foot at [0.4, -0.1, 0.0] m }}
                {base}
                body disc {{ mass: 2 kg, inertia: diag(0.3, 0.4, 0.5) kg*m^2, frame rim at [0.25, -0.15, 0.0] m }}
                {held}
                joint s: planar from {parent} to disc.rim {{ axis: z, {along} }}
                output place = disc.position;
                output turn = s.angle;
                output rate = disc.omega_world.z;
                output speed = disc.velocity;
                output second = disc.angular_acceleration.z; }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options that fit");
        run.run(1.0).unwrap_or_else(|error| panic!("{error}"));
        let mut out = vec![0.0; model.layout().len(Quantity::Outputs)];
        run.evaluate(Quantity::Outputs, &mut out).expect("no node");
        out
    };
    for along in along {
        for parent in parents {
            let wanted = end(along, parent, ["", "absolute"]);
            assert!(wanted[3].abs() > 0.01, "{along}: it turns");
            for variant in [
                ["", "relative"],
                ["planar: xy;", "absolute"],
                ["planar: xy;", "relative"],
            ] {
                let found = end(along, parent, variant);
                for (found, wanted) in found.iter().zip(&wanted) {
                    let apart = (found - wanted).abs();
                    assert!(
                        apart < 1e-7 * (1.0 + wanted.abs()),
                        "{along} {parent:?} {variant:?}: {found} {wanted}"
                    );
                }
            }
        }
    }
}

/// α = M/I, by what the scene says of its derivatives, too.
#[test]
fn a_torque_along_a_joint_without_rows_is_in_the_linear_system() {
    for family in ["absolute", "relative"] {
        let scene = read(&format!(
            "model Fin {{ planar: xy; coordinates: {family}; gravity: none; input push: torque = 1 N*m;
                body disc {{ mass: 2 kg, inertia: 0.5 kg*m^2 }}
                joint s: planar from world to disc {{ axis: z, angle: {{ force: push, stiffness: 8 N*m/rad }} }}
                output bend = s.angle; }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::vern7(1e-12)).expect("options that fit");
        run.run(0.5).expect("a swing");
        // θ = M/k (1 − cos ωt), ω = 4 rad/s.
        let bend = run.output("bend").expect("an output");
        assert!(
            (bend - 0.125 * (1.0 - 2.0_f64.cos())).abs() < 1e-11,
            "{family}: {bend}"
        );
        let space = run.linearise(&["s.angle"]).expect("a linear system");
        let frequencies: Vec<f64> = space.vibrations().iter().map(|it| it.frequency()).collect();
        assert!(
            frequencies.iter().any(|it| (it - 4.0).abs() < 1e-9),
            "{family}: {frequencies:?}"
        );
    }
}
