//! Starts of which little is said, in both families of coordinates: where bodies hang then, how loops close, and what gives way.

use mbd_runtime::{Generic, Options, Simulation};
use mbd_scene::{Model, Quantity, Scene};
use tests::assert_close;
use tests::declared::read;

use crate::declared_starts::{begun, begun_as_declared};

const UNTOLD: &str = "model Untold { COORDINATES
    gravity: [0.0, 0.0, -9.81] m/s^2;
    world { frame hook at [0.7, 0.0, 2.0] m, frame rail at [0.0, 0.0, 5.0] m }
    body upper { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m }
    body lower { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
    body cabin { mass: 1 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2, frame door at [1.0, 0.0, 0.0] m }
    body bird { mass: 1 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
    joint pin: hinge from world.hook to upper.top { axis: y }
    joint elbow: hinge from upper.tip to lower.top { axis: y }
    joint guide: prismatic from world.rail to cabin.com { axis: z }
    joint wings: free from cabin.door to bird.com;
    output lean = pin.angle; output bend = elbow.angle; output height = guide.slide;
    output x = bird.position.x; output z = bird.position.z;
}";

#[test]
fn coordinates_that_nobody_mentions_start_at_zero_and_what_flies_from_a_body_where_that_is() {
    for family in ["coordinates: absolute;", "coordinates: relative;"] {
        let scene = read(&UNTOLD.replace("COORDINATES", family));
        let (found, moved) = begun_as_declared(&scene);
        assert_close(&found, &[0.0, 0.0, 0.0, 1.0, 5.0], 1e-14, 1e-14, family);
        assert!(moved < 1e-14, "{family}: {moved}");
    }
}

#[test]
fn a_loop_that_nobody_places_is_closed_and_what_hangs_beside_it_starts_at_zero() {
    let scene = read(
        "model Linkage { gravity: [0.0, 0.0, -9.81] m/s^2;
            world { frame left at [0.0, 0.0, 0.0] m, frame right at [1.5, 0.0, 0.0] m, frame hook at [4.0, 0.0, 0.0] m }
            body crank { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [0.0, 0.0, -0.5] m, frame b at [0.0, 0.0, 0.5] m }
            body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [0.0, 0.0, -1.0] m, frame b at [0.0, 0.0, 1.0] m }
            body rocker { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [0.0, 0.0, -0.75] m, frame b at [0.0, 0.0, 0.75] m }
            body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0.0, 0.0, 0.3] m }
            joint one: hinge from world.left to crank.a { axis: y }
            joint two: hinge from crank.b to rod.a { axis: y }
            joint three: hinge from rod.b to rocker.b { axis: y }
            joint four: hinge from world.right to rocker.a { axis: y }
            joint hang: hinge from world.hook to bob.top { axis: y }
            output gap = norm(rod.b.position - rocker.b.position);
            output swing = hang.angle;
        }",
    );
    let (found, _) = begun_as_declared(&scene);
    assert_close(
        &found,
        &[0.0, 0.0],
        1e-9,
        1e-9,
        "closed, and hanging straight",
    );
}

/// The outputs at the start of a declaration, which has the word for its family of coordinates filled in, in both of them.
fn starts_at(declaration: &str, expected: &[f64]) {
    for family in ["absolute", "relative"] {
        let scene = read(&declaration.replace("FAMILY", family));
        let (found, _) = begun_as_declared(&scene);
        assert_close(&found, expected, 1e-9, 1e-9, family);
    }
}

#[test]
fn a_loop_of_which_nothing_is_said_closes_from_zero_in_both_families() {
    // A sled on a rail that is turned over; its tip stands on a table: from a body that is not turned the rail would be held turned around.
    let fall = (170_f64.to_radians()).cos();
    starts_at(
        "model Sled { coordinates: FAMILY;
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world { frame rail at [0.0, 0.0, 0.0] m rotated rpy(170 deg, 0.0, 0.0), frame table at [0.0, 0.0, -0.5] m }
            body sled { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame tip at [0.1, 0.0, -0.3] m }
            joint guide: prismatic from world.rail to sled.com { axis: z }
            joint stand: point_on_plane from world.table to sled.tip { axis: z }
            output slide = guide.slide;
        }",
        &[0.3 - 0.5 / fall],
    );
}

#[test]
fn a_place_that_its_joint_does_not_allow_moves_as_little_in_both_families() {
    // A table on a rail that is turned over, and a ball in its middle that is said to lie 40 cm above it. The nearest by mass: the table takes the part
    // of the ball's mass.
    let along = 0.4 * 170_f64.to_radians().cos() / 4.0;
    starts_at(
        "model Table { coordinates: FAMILY;
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world { frame floor at [0.3, 0.2, 0.5] m rotated rpy(170 deg, 0.0, 0.0) }
            body table { mass: 3 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
            joint slides: prismatic from world.floor to table.com { axis: z }
            point ball { mass: 1 kg, start at [0.3, 0.2, 0.9] m }
            joint lies: spherical from table.com to ball;
            output slide = slides.slide;
        }",
        &[along],
    );
}

#[test]
fn a_declared_place_that_joints_do_not_allow_is_told_in_both_families() {
    for family in ["absolute", "relative"] {
        let scene = read(&format!(
            "model Tilted {{ coordinates: {family};
                gravity: [0.0, 0.0, -9.81] m/s^2;
                body rod {{ mass: 1 kg, inertia: diag(0.08, 0.08, 0.001) kg*m^2, frame top at [0.0, 0.0, 0.5] m, start at [-0.25, 0.0, -0.433] m }}
                joint pin: hinge from world to rod.top {{ axis: y }}
            }}"
        ));
        let model = Generic::with_defaults(scene).expect("declared params");
        let mut run = Simulation::<f64>::new(&model, Options::rk4(1e-3)).expect("a start");
        run.start().expect("a consistent start");
        let rod = run.start_moved().iter().find(|moved| moved.name == "rod");
        let rod = rod.unwrap_or_else(|| panic!("{family}: nothing is said to be moved"));
        assert!(rod.distance > 0.05, "{family}: {rod:?}");
    }
}

#[test]
fn what_hangs_on_bodies_that_are_put_a_little_apart_hangs_at_zero() {
    // The rods are declared to the digits that a person writes; their hinge is open by a millimetre until the start closes it.
    let scene = read(
        "model Apart { gravity: none;
            body upper { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame tip at [0.0, 0.0, -0.5] m, start at [3.0, 0.0, -0.5] m }
            body lower { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m,
                start at [3.0, 0.0, -1.501] m }
            body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0.0, 0.0, 0.2] m }
            joint afloat: free from world to upper.com;
            joint elbow: spherical from upper.tip to lower.top;
            joint hang: hinge from lower.tip to bob.top { axis: y }
            output swing = hang.angle;
            output x = bob.position.x;
        }",
    );
    let (found, moved) = begun_as_declared(&scene);
    assert_close(&found, &[0.0, 3.0], 0.0, 1e-3, "below the others");
    assert!(moved < 2e-3, "{moved}");
}

#[test]
fn a_stewart_platform_is_assembled_from_all_bodies_at_the_origin_and_every_body_that_moved_is_told()
{
    let scene = read(
        "model Stewart {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world { frame foot[i in 0..6] at polar(0.7 m, (60 * i + 10 * (-1)^i) * 1 deg, 0 m) }
            body platform {
                mass: 40 kg,
                inertia: diag(2, 2, 4) kg*m^2,
                frame corner[i in 0..6] at polar(0.4 m, (60 * i + 30 * (-1)^i) * 1 deg, 0 m),
            }
            body cylinder[i in 0..6] { mass: 5 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame foot at [0.0, 0.0, -0.25] m }
            body rod[i in 0..6] { mass: 3 kg, inertia: diag(0.06, 0.06, 0.003) kg*m^2, frame head at [0.0, 0.0, 0.25] m }
            joint foot[i in 0..6]: universal from world.foot[i] to cylinder[i].foot { axes: [x, y] }
            joint leg[i in 0..6]: prismatic from cylinder[i].foot to rod[i].head { axis: z, motor: 1.1 m }
            joint ball[i in 0..6]: spherical from rod[i].head to platform.corner[i];
        }",
    );
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    let mut origin = vec![0.0; model.layout().nx()];
    let upright: Vec<usize> = model.layout().quaternions().collect();
    upright.iter().for_each(|&at| origin[at] = 1.0);
    run.set_state(0.0, &origin).expect("numbers");
    run.start().expect("it can be assembled");
    let mut gaps = vec![0.0; model.layout().len(Quantity::Constraint)];
    run.evaluate(Quantity::Constraint, &mut gaps).expect("rows");
    let open = gaps.iter().fold(0.0_f64, |most, gap| most.max(gap.abs()));
    assert!(open < 1e-9, "open by {open:.1e}");
    // Legs of one length: level, and as high as they reach.
    let apart = 0.4_f64.powi(2) + 0.7_f64.powi(2) - 0.56 * 20_f64.to_radians().cos();
    let height = (1.1_f64.powi(2) - apart).sqrt();
    let level = [0.0, 0.0, height, 1.0, 0.0, 0.0, 0.0];
    assert_close(&run.state()[..7], &level, 0.0, 1e-9, "the platform");
    let moved = run.start_moved();
    assert_eq!(moved.len(), 13, "{moved:?}");
    let names: Vec<&str> = moved.iter().map(|one| one.name.as_str()).collect();
    for name in ["platform", "cylinder[0]", "rod[5]"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(moved.iter().all(|one| one.distance > 0.3), "{moved:?}");
    run.run(0.05).expect("it stands");
}

/// Two bodies on a joint, of which the declaration says where one flies.
fn pair(joint: &str, starts: [&str; 2], coordinates: &str) -> Scene {
    let [a, b] = starts;
    read(&format!(
        "model Pair {{
            gravity: none; coordinates: {coordinates};
            body a {{ mass: 3 kg, inertia: diag(0.3, 0.2, 0.25) kg*m^2, frame p at [0.3, 0.1, -0.2] m rotated rpy(20 deg, -30 deg, 50 deg) {a} }}
            body b {{ mass: 2 kg, inertia: diag(0.12, 0.1, 0.15) kg*m^2, frame q at [-0.2, 0.1, 0.1] m rotated rpy(-10 deg, 40 deg, 5 deg) {b} }}
            joint fly: free from world to a.com;
            joint j: {joint}
            output pa = a.position; output pb = b.position;
            output va = a.velocity; output vb = b.velocity;
            output wa = a.omega_world; output wb = b.omega_world;
        }}"
    ))
}

#[test]
fn what_hangs_on_a_body_that_is_put_somewhere_goes_along_in_both_families() {
    let at = "start at [1, 2, 3] m rotated rpy(10 deg, 20 deg, 30 deg) velocity [0.1, 0.2, -0.3] m/s angular_velocity [0.3, -0.2, 0.5] rad/s";
    for (joint, zero) in [
        ("hinge from a.p to b.q { axis: [1, 2, 2] }", "j.angle"),
        ("prismatic from a.p to b.q { axis: z }", "j.slide"),
        ("cylindrical from a.p to b.q { axis: z }", "j.slide"),
        ("screw from a.p to b.q { axis: z, pitch: 20 mm }", "j.angle"),
        ("universal from a.p to b.q;", "j.angle1"),
        ("spherical from a.p to b.q;", "0 m"),
        ("planar from a.p to b.q;", "j.x"),
        ("rigid from a.p to b.q;", "0 m"),
    ] {
        let said = format!(", {at}");
        let scenes = ["absolute", "relative"].map(|of| pair(joint, [&said, ""], of));
        let [absolute, relative] = scenes.map(|scene| begun_as_declared(&scene));
        assert_close(&relative.0, &absolute.0, 1e-14, 1e-14, joint);
        assert!(absolute.1.max(relative.1) < 1e-14, "{joint}");
        if zero != "0 m" {
            let text = format!("{joint} output q = {zero};");
            let (found, _) = begun_as_declared(&pair(&text, [&said, ""], "relative"));
            assert!(found[0].abs() < 1e-14, "{joint}: {found:?}");
        }
        // The same where the last of the chain is put: what carries it flies to it.
        let said = format!(", {at}");
        let scenes = ["absolute", "relative"].map(|of| pair(joint, ["", &said], of));
        let [absolute, relative] = scenes.map(|scene| begun_as_declared(&scene));
        assert_close(&relative.0, &absolute.0, 1e-14, 1e-14, joint);
        assert_close(&relative.0[3..6], &[1.0, 2.0, 3.0], 1e-14, 0.0, joint);
        assert!(absolute.1.max(relative.1) < 1e-14, "{joint}");
    }
}

#[test]
fn a_joint_that_forbids_nothing_in_its_plane_starts_where_it_is_said() {
    for family in ["absolute", "relative"] {
        for plane in ["xy", "space"] {
            let (planar, inertia) = match plane {
                "xy" => ("planar: xy;", "2 kg*m^2"),
                _ => ("", "diag(2, 2, 2) kg*m^2"),
            };
            let scene = read(&format!(
                "model Puck {{
                    gravity: none;
                    {planar}
                    coordinates: {family};
                    world {{ frame table at [1, 0, 0] m }}
                    body puck {{ mass: 1 kg, inertia: {inertia} }}
                    body arm {{ mass: 1 kg, inertia: {inertia}, frame root at [-0.5, 0, 0] m }}
                    joint slides: planar from world.table to puck {{
                        axis: z,
                        y: {{ start: 4 mm, start_rate: 2 m/s }},
                        angle: {{ start: 30 deg }},
                    }}
                    joint pin: hinge from puck to arm.root {{ axis: z, start: 15 deg }}
                    output x = slides.x; output y = slides.y; output turn = slides.angle;
                    output rate = slides.y_rate; output bend = pin.angle;
                    output end_x = arm.position.x; output end_y = arm.position.y; output end_v = arm.vy;
                }}"
            ));
            let model = Generic::<f64>::with_defaults(scene).expect("defaults");
            let run = Simulation::new(&model, Options::rk4(1e-3)).expect("a start");
            let (found, moved) = begun(run);
            let (half, turned) = (0.5, 45f64.to_radians());
            let want = [
                0.0,
                4e-3,
                30f64.to_radians(),
                2.0,
                15f64.to_radians(),
                1.0 + half * turned.cos(),
                4e-3 + half * turned.sin(),
                2.0,
            ];
            assert_close(&found, &want, 1e-12, 1e-15, &format!("{family} {plane}"));
            assert!(moved < 1e-12, "{family} {plane}: {moved}");
        }
    }
}

#[test]
fn a_start_where_a_motor_does_not_hold_its_coordinate_is_told_in_both_families() {
    for family in ["absolute", "relative"] {
        let begun = |motor: &str, start: f64| {
            let scene = read(&format!(
                "model Driven {{ coordinates: {family}; gravity: none;
                    input wish: angle = 0.5 rad;
                    body rod {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 0.5] m }}
                    joint pin: hinge from world to rod.top {{ axis: y, {motor} }}
                }}"
            ));
            let model = Generic::<f64>::with_defaults(scene).expect("no params");
            let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
            let set = run.set_joints(&[("pin.angle", start)]);
            set.map_err(|error| error.to_string())
        };
        for motor in [
            "motor: 0.5 rad + 2 rad/s * time",
            "motor: wish, filter: 20 ms",
        ] {
            let told = begun(motor, 0.2).expect_err("the motor holds it elsewhere");
            assert!(told.contains("holds `pin.angle` at 0.500000 rad"), "{told}");
            begun(motor, 0.5).expect("it says the same");
            begun(motor, 0.5 - std::f64::consts::TAU).expect("and so does a turn less");
        }
        // What inputs will say is not known before they are given.
        begun("motor: [wish, 0, 0]", 0.2).expect("as far as is known");
    }
}

/// Three bodies that hang together and on nothing else, with a start of the joint between the last two.
#[test]
fn of_bodies_that_float_the_first_that_is_declared_stays_at_the_origin_in_both_families() {
    let places = ["absolute", "relative"].map(|family| {
        let scene = read(&format!(
            "model Floating {{
                coordinates: {family};
                gravity: none;
                body bus {{ mass: 9 kg, inertia: diag(1, 1, 1) kg*m^2, frame edge at [0.4, 0.0, 0.0] m }}
                body arm {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.2, 0.0, 0.0] m, frame tip at [0.2, 0.0, 0.0] m }}
                body hand {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.1, 0.0, 0.0] m }}
                joint drift: free from world to bus.com;
                joint shoulder: spherical from bus.edge to arm.root;
                joint wrist: hinge from arm.tip to hand.root {{ axis: z, start: 90 deg }}
                output bus_at = bus.position;
                output arm_at = arm.position;
                output hand_at = hand.position;
            }}"
        ));
        begun_as_declared(&scene).0
    });
    let expected = [0.0, 0.0, 0.0, 0.6, 0.0, 0.0, 0.8, 0.1, 0.0];
    for (place, family) in places.iter().zip(["absolute", "relative"]) {
        assert_close(place, &expected, 0.0, 1e-12, family);
    }
}
