//! States and inputs where nothing accelerates, against closed forms.

use mbd_runtime::{Model, TrimError, trim};
use tests::assert_close;
use tests::declared::read;
use tests::mechanism::state;
use tests::reference::{field, load};
use tests::system::{bodies, list};

use super::{generic, sprung_four_bar};

#[test]
fn a_kite_stands_where_wind_weight_and_line_balance() {
    let scene = read(
        "model Kite {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input lift: force; input drag: force;
            point kite { mass: 3.0 kg }
            line tether from world to kite { free_length: 100 m, stiffness: 5 kN/m }
            load wind on kite = [drag, 0 N, lift];
        }",
    );
    let model = generic(scene);
    let found = trim(&model)
        .input("lift", 900.0)
        .input("drag", 300.0)
        .guess("kite.x", 50.0)
        .guess("kite.y", 10.0)
        .guess("kite.z", 90.0)
        .solve()
        .expect("it stands");
    // The line points along the force, and is longer by what it pulls over its stiffness.
    let force = [300.0, 0.0, 900.0 - 3.0 * 9.81];
    let pull = f64::hypot(force[0], force[2]);
    let length = 100.0 + pull / 5000.0;
    for (name, force) in ["kite.x", "kite.y", "kite.z"].iter().zip(force) {
        let got = found.value(name).expect("a coordinate");
        assert!((got - length * force / pull).abs() < 1e-8, "{name}: {got}");
    }
    // And the lift that holds it at a height.
    let found = trim(&model)
        .input("drag", 300.0)
        .input("lift", 500.0)
        .free_input("lift")
        .guess("kite.x", 62.0)
        .fix("kite.z", 80.0)
        .solve()
        .expect("it stands");
    let (z, x) = (80.0, found.value("kite.x").expect("a coordinate"));
    let up = found.inputs[0] - 3.0 * 9.81;
    assert!((up / 300.0 - z / x).abs() < 1e-9, "{up} {x}");
}

const DRONE: &str = "model Drone {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    input f0: force; input f1: force; input f2: force; input f3: force;
    input wind: [speed; 3];
    body drone { mass: 1.5 kg, inertia: diag(0.02, 0.02, 0.04) kg*m^2,
        frame front at [0.2, 0.0, 0.0] m, frame left at [0.0, 0.2, 0.0] m,
        frame back at [-0.2, 0.0, 0.0] m, frame right at [0.0, -0.2, 0.0] m }
    joint fly: free from world to drone.com;
    load front on drone at front = f0 * drone.z;
    load left on drone at left = f1 * drone.z;
    load back on drone at back = f2 * drone.z;
    load right on drone at right = f3 * drone.z;
    load drag on drone at com = -0.3 N*s/m * (drone.com.velocity - wind);
}";

#[test]
fn a_quadrotor_hovers_with_a_quarter_of_its_weight_a_rotor_and_leans_into_the_wind() {
    let model = generic(read(DRONE));
    let hover = || {
        let all = (0..4).fold(trim(&model), |trim, k| trim.free_input(&format!("f{k}")));
        (0..4).fold(all, |trim, k| trim.input(&format!("f{k}"), 2.0))
    };
    let still = hover().solve().expect("it hovers");
    let quarter = 1.5 * 9.81 / 4.0;
    assert_close(&still.inputs[..4], &[quarter; 4], 1e-9, 0.0, "rotors");
    assert!(
        still.undecided.iter().any(|name| name.contains("drone.x")),
        "{:?}",
        still.undecided
    );
    assert_eq!(still.space.states.len(), 12);

    // Against a wind of 10 m/s along x: thrust = √((m g)² + (c w)²), leaning by atan(c w/m g).
    let windy = hover()
        .input("wind.x", 10.0)
        .hold("drone.turn_z")
        .solve()
        .expect("it hovers");
    let (weight, drag) = (1.5 * 9.81, 0.3 * 10.0);
    let thrust: f64 = windy.inputs[..4].iter().sum();
    assert!((thrust - f64::hypot(weight, drag)).abs() < 1e-8, "{thrust}");
    let q = &windy.state[3..7];
    let (z_x, z_z) = (
        2.0 * (q[1] * q[3] + q[0] * q[2]),
        1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]),
    );
    assert!((-z_x / z_z - drag / weight).abs() < 1e-8, "{z_x} {z_z}");
}

#[test]
fn a_wind_turbine_turns_at_a_constant_speed_under_the_torque_of_its_generator() {
    let model = generic(read(
        "model Turbine {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input generator: torque;
            input wind: speed;
            body rotor { mass: 2000.0 kg, inertia: diag(40000.0, 20000.0, 20000.0) kg*m^2 }
            joint shaft: hinge from world to rotor.com { axis: x,
                force: 400 N*s^2/m * (wind - 3.0 m * shaft.angle_rate) * wind - generator }
        }",
    ));
    let found = trim(&model)
        .input("wind", 12.0)
        .rate("shaft.angle", 2.0)
        .free_input("generator")
        .solve()
        .expect("it turns");
    let at = found
        .space
        .inputs
        .iter()
        .position(|name| name.name == "generator");
    let generator = found.inputs[at.expect("an input")];
    assert!(
        (generator - 400.0 * (12.0 - 6.0) * 12.0).abs() < 1e-6,
        "{generator}"
    );
    assert_eq!(found.value("shaft.angle_rate"), Some(2.0));
}

#[test]
fn a_linkage_is_trimmed_on_its_loop_and_what_cannot_balance_is_named() {
    let file = load("derivatives/linear_four_bar.json");
    let scene = sprung_four_bar(&file);
    let own = &list(&file["points"])[1]["bodies"];
    let start = state(
        &scene,
        &bodies(&own["r"], &own["quat"], &own["rdot"], &own["omega_world"]),
        &[],
    );
    let model = generic(scene);
    let near = trim(&model).state(&start).guess("hinge0.angle", 0.8);
    let found = near.solve().expect("it rests");
    let want = field(&list(&file["points"])[0], "x0")[0];
    assert!((found.value("hinge0.angle").expect("the crank") - want).abs() < 1e-9);

    let held = trim(&model).state(&start).hold("hinge0.angle").solve();
    let Err(TrimError::Unbalanced {
        worst,
        residual,
        counts,
        ..
    }) = held
    else {
        panic!("{held:?}");
    };
    assert_eq!((worst.as_str(), counts), ("hinge0.angle", [0, 1]));
    assert!(residual.abs() > 1.0);
}

#[test]
fn a_trim_begins_at_the_declared_start_with_the_declared_inputs_and_settles_what_is_integrated() {
    // A pendulum under a controller that integrates its error: at rest it carries the load and the integral holds the torque.
    let text = "model Held {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input aim: angle = 2.4 rad;
        body arm { mass: 2.0 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
        joint pin: hinge from world to arm.top { axis: y, start: 2.3 rad,
            force: 30 N*m * (aim - pin.angle) - 6 N*m*s * pin.angle_rate + 20 N*m/s * missed }
        state missed = 0 rad*s { rate: aim - pin.angle }
    }";
    let model = generic(read(text));
    let found = trim(&model).solve().expect("it rests");
    let torque = 2.0 * 9.81 * 0.5 * 2.4_f64.sin();
    let got = ["pin.angle", "missed"].map(|name| found.value(name).expect("a name"));
    assert_close(&got, &[2.4, torque / 20.0], 1e-10, 0.0, "rest");
    assert!(found.space.vibrations().iter().all(|one| one.real < 0.0));
}

/// The places of the wheels tell the attitude of the satellite as well, but not twenty degrees away from where they are chosen.
#[test]
fn a_satellite_is_trimmed_by_its_own_attitude_and_not_by_the_places_of_its_wheels() {
    let wheels = ["x", "y", "z"].map(|axis| {
        format!(
            "body wheel_{axis} {{ mass: 2 kg, inertia: diag(0.006, 0.006, 0.01) kg*m^2 }}
             joint spin_{axis}: hinge from bus.mount_{axis} to wheel_{axis}.com {{ axis: z, force: u_{axis} }}
             state missed_{axis} = 0 rad*s {{ rate: bus.orientation.{axis} }}
             let u_{axis} = 0.6 N*m * bus.orientation.{axis} + 4 N*m*s * bus.omega_body.{axis} + 0.02 N*m/s * missed_{axis};"
        )
    });
    let text = format!(
        "model Satellite {{
            gravity: none;
            body bus {{
                mass: 100 kg,
                inertia: diag(12, 10, 8) kg*m^2,
                frame mount_x at [0.2, 0, 0] m rotated about(y, 90 deg),
                frame mount_y at [0, 0.2, 0] m rotated about(x, -90 deg),
                frame mount_z at [0, 0, 0.2] m,
                start at [0, 0, 0] m rotated rpy(20 deg, -10 deg, 5 deg),
            }}
            joint flight: free from world to bus.com
            {}
        }}",
        wheels.concat()
    );
    let model = generic(read(&text));
    let found = trim(&model).solve().expect("it rests");
    let turned = &found.state[4..7];
    assert!(turned.iter().all(|part| part.abs() < 1e-8), "{turned:?}");
    let names = found.space.states.iter();
    let names: Vec<&str> = names.map(|name| name.name.as_str()).collect();
    assert!(
        names.contains(&"bus.turn_x") && !names.contains(&"wheel_x.x"),
        "{names:?}"
    );
}

/// Whichever coordinate the linear system is asked along: on the way from −40 degrees to where it hangs the rocker turns back.
#[test]
fn a_linkage_comes_to_one_rest_along_angles_that_turn_back_on_the_way_too() {
    for coordinates in ["absolute", "relative"] {
        let model = generic(read(&format!(
            "model FourBar {{
                planar: xz;
                coordinates: {coordinates};
                gravity: [0.0, 0.0, -9.81] m/s^2;
                world {{ frame far at [0.5, 0.0, 0.0] m }}
                input drive: torque;
                body crank {{ mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2,
                    frame p at [-0.1, 0.0, 0.0] m, frame o at [0.1, 0.0, 0.0] m }}
                body rod {{ mass: 1 kg, inertia: diag(0.03, 0.03, 0.03) kg*m^2,
                    frame p at [-0.25, 0.0, 0.0] m, frame o at [0.25, 0.0, 0.0] m }}
                body rocker {{ mass: 1 kg, inertia: diag(0.02, 0.02, 0.02) kg*m^2,
                    frame p at [-0.2, 0.0, 0.0] m, frame o at [0.2, 0.0, 0.0] m }}
                joint a: hinge from world to crank.p {{ axis: y, damping: 0.3 N*m*s, start: -40 deg, force: drive + lag }}
                joint b: hinge from crank.o to rod.p {{ axis: y, damping: 0.1 N*m*s }}
                joint c: hinge from rod.o to rocker.o {{ axis: y }}
                joint d: hinge from world.far to rocker.p {{ axis: y, damping: 0.1 N*m*s }}
                state lag = 0 N*m {{ rate: (drive - lag) / (50 ms) }}
            }}"
        )));
        let rests = ["a.angle", "b.angle", "d.angle"].map(|along| {
            let found = trim(&model).along(along).solve();
            found.unwrap_or_else(|error| panic!("{coordinates}, {along}: {error}"))
        });
        let height = |state: &[f64]| {
            let at = mbd_scene::Arguments {
                state: state.to_vec(),
                inputs: vec![0.0],
                ..mbd_scene::Arguments::default()
            };
            let mut energy = vec![0.0; model.layout().len(mbd_scene::Quantity::Energy)];
            let mut work = model.work();
            model.evaluate(
                mbd_scene::Quantity::Energy,
                &at.at(),
                &mut work,
                &mut energy,
            );
            energy[1]
        };
        for rest in &rests {
            assert_close(&rest.state, &rests[0].state, 0.0, 1e-7, coordinates);

            // Eigenvalues do not depend on coordinates.
            for (own, first) in rest
                .space
                .vibrations()
                .iter()
                .zip(rests[0].space.vibrations())
            {
                let apart = f64::hypot(own.real - first.real, own.imaginary - first.imaginary);
                assert!(apart < 1e-5, "{coordinates}: {own:?} {first:?}");
            }
        }
        // From there its weight changes with the square of a small move.
        let there = height(&rests[0].state);
        let angle = rests[0].value("a.angle").expect("the crank");
        let [one, other] = [-0.01, 0.01].map(|aside| {
            let options = mbd_runtime::Options::rk4(1e-3);
            let mut run = mbd_runtime::Simulation::new(&model, options).expect("options");
            run.set_joints(&[("a.angle", angle + aside)])
                .expect("it can be placed");
            height(run.state()) - there
        });
        assert!(
            one * other > 0.0 && (one - other).abs() < 0.05 * one.abs(),
            "{coordinates}: {one} {other}"
        );
    }
}

/// A thrust of max(0, u) holds nothing at u = 0 and any weight above: on the side of none the search has no derivative, and says so. Beside it the weight is
/// the thrust.
#[test]
fn a_search_that_stands_at_a_kink_says_so_and_where_to_begin() {
    let scene = read(
        "model Lifted {
            gravity: [0, 0, -9.81] m/s^2;
            input u: force = 0 N;
            body cart { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2 }
            joint rail: prismatic from world to cart.com { axis: z }
            load push on cart = [0 N, 0 N, max(0 N, u)];
        }",
    );
    let model = generic(scene);
    let error = trim(&model).free_input("u").solve().expect_err("no slope");
    let TrimError::Unbalanced {
        kink: Some(kink), ..
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!(kink.by.name, "u");
    let told = error.to_string();
    assert!(told.contains("with another value of `u`"), "{told}");
    let found = trim(&model).input("u", 1.0).free_input("u").solve();
    let found = found.expect("it hovers");
    let thrust = found.value("u").expect("the input");
    assert!((thrust - 2.0 * 9.81).abs() < 1e-9, "{thrust}");
}
