//! Units, and numbers without one.

use mbd_compiler::{Reading, read_text};

use super::{pendulum, told};

#[test]
fn a_word_that_is_a_unit_and_a_name_is_what_gives_the_dimension_that_is_wanted() {
    let pin = |force: &str| {
        format!("joint pin: hinge from world to rod.top {{ axis: y, force: {force} }}")
    };
    let pairs = [
        (
            pin("-20 N*m * sin(pin.angle)"),
            pin("-20 (N*m) * sin(pin.angle)"),
        ),
        (
            pin("-20 N*m*s * pin.angle_rate"),
            pin("-20 (N*m*s) * pin.angle_rate"),
        ),
        (
            pin("0 N*m") + "load w on rod = [0, 0, -1] * (9.81 m/s^2 * m);",
            pin("0 N*m") + "load w on rod = [0, 0, -1] * ((9.81 m/s^2) * m);",
        ),
        (
            pin("0 N*m") + "output x = 9.81 m/s^2 * m + 1 N in kN;",
            pin("0 N*m") + "output x = (9.81 m/s^2) * m + 1 N in kN;",
        ),
    ];
    for (written, meant) in pairs {
        let read = pendulum(&written);
        assert!(read.scene.is_some(), "{}", told(&read));
        assert_eq!(read.scene, pendulum(&meant).scene, "{written}");
        assert!(
            read.notes.iter().any(|note| note.starts_with("`m`")),
            "{written}"
        );
    }
    let frame = |at: &str| {
        let pin = pin("0 N*m");
        format!(
            "const N = 3; world {{ frame a at [{at}, 0, 0] }} {pin} joint b: spherical from world.a to rod.top;"
        )
    };
    let read = pendulum(&frame("2 m * N"));
    assert_eq!(
        read.scene,
        pendulum(&frame("N * 2 m")).scene,
        "{}",
        told(&read)
    );
    // A const, and where only one way fits together at all.
    let side = |side: &str| {
        let pin = pin("0 N*m");
        format!("const N = 6; const side = 2 m * sin({side}); {pin} output x = side * pin.angle;")
    };
    let read = pendulum(&side("180 deg / N"));
    assert_eq!(
        read.scene,
        pendulum(&side("30 deg")).scene,
        "{}",
        told(&read)
    );
    // Where no dimension is wanted a quantity is meant: a torque, not a force times a mass.
    for (written, meant) in [
        (
            "let x = 2 N*m * sin(pin.angle); output y = x;",
            "let x = 2 (N*m) * sin(pin.angle); output y = x;",
        ),
        ("param k = 5 MN*m/rad;", "param k = 5 (MN*m/rad);"),
    ] {
        let read = pendulum(&(pin("0 N*m") + written));
        assert!(read.scene.is_some(), "{}", told(&read));
        assert!(
            read.notes.iter().any(|note| note.starts_with("`m` in")),
            "{written}"
        );
        let [read, meant] = [read, pendulum(&(pin("0 N*m") + meant))].map(|it| it.scene.unwrap());
        assert_eq!(read.lets, meant.lets, "{written}");
        let defaults = [read, meant].map(|it| it.params.last().map(|it| it.default));
        assert_eq!(defaults[0], defaults[1]);
    }
    // Of two that have no name, or both have one, both might be meant.
    for output in [
        "output x = 2 kg*m * sin(pin.angle);",
        "let x = 3 m/s^2 * m; output y = x;",
    ] {
        let read = pendulum(&(pin("0 N*m") + output));
        assert!(
            told(&read).contains("`m` is also a param"),
            "{}",
            told(&read)
        );
    }
    // `2 m * m` behind a stroke would be divided by the first alone.
    let read = pendulum(&(pin("0 N*m") + "output x = 4 kg*m / 2 m * m in kg^2;"));
    assert!(read.scene.is_none());
}

#[test]
fn an_angle_that_is_computed_needs_no_unit_and_may_be_so_many_radians() {
    let of = |start: &str| {
        let pin = format!("joint pin: hinge from world to rod.top {{ axis: y, start: {start} }}");
        let read = pendulum(&pin);
        assert!(read.scene.is_some(), "{}", told(&read));
        read.scene
    };
    assert_eq!(of("pi / 6"), of("(pi / 6) * 1 rad"));
}

#[test]
fn a_second_in_brackets_is_the_unit_beside_a_spring_of_that_name() {
    let decay = |spring: &str, rate: &str| {
        let pin = "joint pin: hinge from world to rod.top { axis: y }";
        let ends = "{ free_length: 1 m, stiffness: 1 kN/m }";
        let spring = format!("spring {spring} from world to rod.com {ends}");
        pendulum(&format!(
            "{pin} {spring} state a = 1 m {{ rate: {rate} * a }}"
        ))
    };
    let read = decay("s", "-0.1 (1/s)");
    let states = |reading: &Reading| reading.scene.as_ref().map(|scene| scene.states.clone());
    assert!(read.scene.is_some(), "{}", told(&read));
    assert_eq!(states(&read), states(&decay("s_1", "-0.1/s")));
}

#[test]
fn an_exponent_behind_a_unit_in_brackets_is_of_the_unit_alone() {
    let of = |value: &str| {
        let read = pendulum(&format!(
            "joint pin: hinge from world to rod.top {{ axis: y }} param p = {value};"
        ));
        let scene = read.scene.as_ref();
        let scene = scene.unwrap_or_else(|| panic!("{value}: {}", told(&read)));
        scene.params.last().map_or(f64::NAN, |param| param.default)
    };
    for (value, si) in [
        ("100 (1/s)^2", 100.0),
        ("3 (m)^2", 3.0),
        ("3 (km)^2", 3e6),
        ("3 (m)^-1", 3.0),
        ("4 (kN/m)^2", 4e6),
        ("3 (km/h)^2", 3.0 / 12.96),
    ] {
        assert!(
            (of(value) / si - 1.0).abs() < 1e-14,
            "{value}: {}",
            of(value)
        );
    }
    let read = pendulum("joint pin: hinge from world to rod.top { axis: y } param p = 2 m^2^2;");
    assert!(
        told(&read).contains("the power of a power"),
        "{}",
        told(&read)
    );
}

/// A run holds what a param in radians is set to, to the rule of declarations: 90 without a unit is refused.
#[test]
fn a_param_of_which_a_multiple_is_an_angle_is_one() {
    let formulas = [
        ("sin(a)", "rad"),
        ("sin(2 * a)", "rad"),
        ("cos(-a / 2)", "rad"),
        ("tan(named)", "rad"),
        ("sin(a * 1 deg)", ""),
        ("sin(a * pi / 180)", ""),
        ("sin(0.0174 * a)", ""),
        ("sin(a * time / (1 s))", ""),
    ];
    for (formula, unit) in formulas {
        let text = format!(
            "model Angle {{
                gravity: none;
                point p {{ mass: 1 kg }}
                param a = 0.5;
                let named = 2 * a;
                output s = {formula};
                output used = named;
            }}"
        );
        let reading = read_text(&text);
        let scene = reading.scene.as_ref();
        let scene = scene.unwrap_or_else(|| panic!("{formula}: {}", told(&reading)));
        assert_eq!(scene.params[0].unit.text, unit, "{formula}");
    }
}
