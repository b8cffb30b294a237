//! Batches of scenes with rows of joints in lanes: a case gives the same bits whatever is beside it, however many lanes and threads there are.

use super::same_bits::{assert_same_bits, bits};
use mbd_runtime::{
    Batch, Beside, Case, Content, InLanes, Model, Options, PointState, Sampling, model,
};

model! {
    /// A chain of links on hinges about crossed axes, each with coordinates of its own; noticed where its end passes a height, braked where it
    /// passes another.
    pub model Chain<T> {
        units: si;
        gravity: [0.0, 0.0, -9.81];
        param length = 1.0 in 0.5 ..= 2.0;
        param brake = 0.05 in 0.0 ..= 10.0;
        body link[i in 0..3] {
            mass: 1.0,
            inertia: diag(0.083, 0.083, 0.02),
            frame top at [0.0, 0.0, 0.5 * length],
            frame end at [0.0, 0.0, -0.5 * length],
        }
        joint first: hinge from world to link[0].top { axis: y, damping: brake }
        joint bend[i in 0..2]: hinge from link[i].end to link[i + 1].top { axis: x, damping: brake }
        event low = link[2].position.z falls -1.6;
        event lower = link[2].position.z falls -2.0 { set: brake = 0.5 }
        output height = link[2].position.z;
        metric fastest = max norm(link[2].velocity);
        metric aside = value link[2].position.x { at: lower };
    }
}

/// A linkage of four parallel hinges, its crank driven by a torque, in a family of coordinates.
macro_rules! four_bar {
    ($(#[$doc:meta])* $name:ident { $($option:tt)* }) => {
        model! {
            $(#[$doc])*
            pub model $name<T> {
                $($option)*
                gravity: [0.0, 0.0, -9.81] m/s^2;
                param speed = -6 rad/s in -20 rad/s ..= 20 rad/s;
                param density = 1.6 kg/m in 0.1 kg/m ..= 10 kg/m;
                world { frame pivot at [1.0, 0.0, 0.0] m }
                body crank {
                    mass: density * 0.3 m,
                    inertia: diag(1e-3, 3.6e-3, 3.6e-3) kg*m^2,
                    frame left at [-0.15, 0.0, 0.0] m,
                    frame right at [0.15, 0.0, 0.0] m,
                }
                body coupler {
                    mass: density * 0.9 m,
                    inertia: diag(1e-3, 0.0972, 0.0972) kg*m^2,
                    frame left at [-0.45, 0.0, 0.0] m,
                    frame right at [0.45, 0.0, 0.0] m,
                }
                body rocker {
                    mass: density * 0.8 m,
                    inertia: diag(1e-3, 0.0683, 0.0683) kg*m^2,
                    frame left at [-0.4, 0.0, 0.0] m,
                    frame right at [0.4, 0.0, 0.0] m,
                }
                joint crank_pin: hinge from world to crank.left {
                    axis: y,
                    force: 2 N*m*s * (speed - crank_pin.angle_rate),
                }
                joint coupler_pin: hinge from crank.right to coupler.left { axis: y }
                joint rocker_pin: hinge from coupler.right to rocker.right { axis: y }
                joint ground_pin: hinge from world.pivot to rocker.left { axis: y }
                output rocker_angle = ground_pin.angle;
            }
        }
    };
}

four_bar! {
    /// In absolute coordinates three of its twenty rows repeat others.
    FourBar { coordinates: absolute; }
}
four_bar! {
    /// On a spanning tree, its loop closed by rows.
    RelativeFourBar { coordinates: relative; }
}
four_bar! {
    /// Three coordinates a body.
    PlanarFourBar { planar: xz; }
}
four_bar! {
    /// Two rows.
    PlanarRelativeFourBar { planar: xz; coordinates: relative; }
}

model! {
    /// A parallelogram: where all its bars are in one line rows repeat each other that do nowhere else.
    pub model Parallelogram<T> {
        planar: xz;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 1 kg in 0.1 kg ..= 10 kg;
        world { frame other at [1.0, 0.0, 0.0] m }
        body left {
            mass: mass,
            inertia: 0.083 kg*m^2,
            frame root at [-0.5, 0.0, 0.0] m,
            frame tip at [0.5, 0.0, 0.0] m,
        }
        body right {
            mass: mass,
            inertia: 0.083 kg*m^2,
            frame root at [-0.5, 0.0, 0.0] m,
            frame tip at [0.5, 0.0, 0.0] m,
        }
        body bar {
            mass: mass,
            inertia: 0.083 kg*m^2,
            frame near at [-0.5, 0.0, 0.0] m,
            frame far at [0.5, 0.0, 0.0] m,
        }
        joint a: hinge from world to left.root { axis: y }
        joint b: hinge from world.other to right.root { axis: y }
        joint c: hinge from left.tip to bar.near { axis: y }
        joint d: hinge from right.tip to bar.far { axis: y }
    }
}

model! {
    /// A flap on a hinge with a spring, on which one of three damped lines is that meet in a point without mass; from it a lamp hangs.
    pub model Flap<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 10 kg in 1 kg ..= 50 kg;
        param stiffness = 5 kN/m in 1 kN/m ..= 20 kN/m;
        world {
            frame left at [-1.0, -0.6, 2.0] m,
            frame right at [1.1, -0.5, 2.1] m,
            frame back at [0.1, 1.7, 2.0] m,
        }
        body flap {
            mass: mass,
            inertia: diag(0.3, 0.4, 0.2) kg*m^2,
            frame edge at [0.0, 0.25, 0.0] m,
            frame handle at [0.0, -0.25, 0.0] m,
        }
        joint pin: hinge from world.back to flap.edge {
            axis: x,
            force: -400 N*m * pin.angle - 5 N*m*s * pin.angle_rate,
        }
        point lamp { mass: 2 kg, start at [0.1, 0.1, 0.8] m }
        point knot;
        line a from world.left to knot {
            free_length: 1.3 m,
            stiffness: stiffness,
            damping: 20 N*s/m,
        }
        line b from world.right to knot {
            free_length: 1.35 m,
            stiffness: stiffness,
            damping: 20 N*s/m,
        }
        line c from flap.handle to knot {
            free_length: 1.3 m,
            stiffness: stiffness,
            damping: 20 N*s/m,
        }
        line cord from knot to lamp { free_length: 0.5 m, stiffness: stiffness, damping: 20 N*s/m }
        output pull = cord.tension;
    }
}

model! {
    /// A winch turns at a prescribed rate and lets its load swing from an arm; the load is dropped, and then the arm is braked.
    pub model Winch<T> {
        units: si;
        gravity: [0.0, 0.0, -9.81];
        param rate = 2.0 in 0.0 ..= 10.0;
        param mass = 1.0 in 0.1 ..= 10.0;
        param brake = 0.0 in 0.0 ..= 10.0;
        body arm {
            mass: 2.0,
            inertia: diag(0.02, 0.2, 0.2),
            frame root at [-0.5, 0.0, 0.0],
            frame tip at [0.5, 0.0, 0.0],
        }
        body load { mass: mass, inertia: diag(0.1, 0.1, 0.1), frame eye at [0.0, 0.0, 0.6] }
        body rod {
            mass: 0.5,
            inertia: diag(0.02, 0.02, 0.005),
            frame top at [0.0, 0.0, 0.3],
            frame end at [0.0, 0.0, -0.3],
        }
        joint drum: hinge from world to arm.root {
            axis: z,
            motor: rate * time + 0.1 * sin(3.0 * time),
        }
        joint swing: spherical from arm.tip to rod.top
        joint hold: hinge from rod.end to load.eye { axis: x, damping: brake }
        event out = load.position.z rises -0.9 { detach: hold }
        event later = time rises 1.2 { set: brake = 1.0 }
        output height = load.position.z;
        output torque = drum.motor_torque;
    }
}

model! {
    /// A wheel on a spiral spring, which it winds up by several turns and back.
    pub model Wheel<T> {
        units: si;
        gravity: none;
        param inertia = 0.02 in 0.01 ..= 0.1;
        body wheel { mass: 1.0, inertia: diag(0.05, inertia, 0.05) }
        joint axle: hinge from world to wheel { axis: y, stiffness: 0.2 }
        output angle = axle.angle;
        metric most = max axle.angle;
        metric last = final axle.angle;
        metric back = min axle.angle_rate;
    }
}

fn chain_case(k: u32) -> Case {
    let k = f64::from(k);
    Case::new()
        .params([0.8 + 0.05 * k, 0.02 * k])
        .joint("first.angle", 0.4 + 0.1 * k)
        .joint("bend[0].angle", 1.2 - 0.1 * k)
        .joint("bend[1].angle_rate", 0.5 * k)
}

#[test]
fn chains_of_hinges_in_absolute_coordinates_are_what_they_are_alone() {
    let chain = Chain::new(ChainParams::default())
        .expect("params")
        .in_lanes();
    let options = [
        Options::rk4(4e-3),
        Options::tsit5(1e-6),
        Options::vern7(1e-7),
        Options::auto(1e-6),
    ];
    assert_same_bits(&chain, &options, 0.8, || (0..9).map(chain_case));
}

fn four_bar_case(k: u32) -> Case {
    let k = f64::from(k);
    Case::new()
        .params([-6.0 + 0.7 * k, 1.0 + 0.2 * k])
        .joint("crank_pin.angle", -1.0 - 0.3 * k)
        .joint("crank_pin.angle_rate", 0.5 * k)
}

fn assert_same_four_bars(linkage: &Beside) {
    // Of fixed steps whose ends nobody reads the state stays in the lane.
    let options = [Options::rk4(2.3e-3), Options::tsit5(1e-6)];
    assert_same_bits(linkage, &options, 0.9, || (0..7).map(four_bar_case));
    // The stiff method differentiates through the rows, which each run does alone.
    let stiff = [Options::rodas5p(1e-6)];
    assert_same_bits(linkage, &stiff, -1.0, || (0..3).map(four_bar_case));
}

#[test]
fn four_bars_in_absolute_coordinates_are_what_they_are_alone() {
    let linkage = FourBar::new(FourBarParams::default()).expect("params");
    assert_same_four_bars(&linkage.in_lanes());
}

#[test]
fn four_bars_in_relative_coordinates_are_what_they_are_alone() {
    let linkage = RelativeFourBar::new(RelativeFourBarParams::default()).expect("params");
    assert_same_four_bars(&linkage.in_lanes());
}

#[test]
fn four_bars_in_a_plane_are_what_they_are_alone() {
    let linkage = PlanarFourBar::new(PlanarFourBarParams::default()).expect("params");
    assert_same_four_bars(&linkage.in_lanes());
}

#[test]
fn four_bars_in_a_plane_and_in_relative_coordinates_are_what_they_are_alone() {
    let linkage = PlanarRelativeFourBar::new(PlanarRelativeFourBarParams::default());
    assert_same_four_bars(&linkage.expect("params").in_lanes());
}

#[test]
fn linkages_that_pass_positions_where_rows_repeat_each_other_are_what_they_are_alone() {
    let linkage = Parallelogram::new(ParallelogramParams::default())
        .expect("params")
        .in_lanes();
    let cases = || {
        (0..9_u32).map(|k| {
            // One begins where all its bars are in one line.
            let angle = if k == 4 {
                0.0
            } else {
                -1.0 - 0.2 * f64::from(k)
            };
            let k = f64::from(k);
            let case = Case::new().params([0.5 + 0.1 * k]);
            let case = case.joint("a.angle", angle).joint("b.angle", angle);
            // The first swing below; the last go over the flat position again and again.
            case.joint("a.angle_rate", -0.8 * k)
        })
    };
    let options = [Options::rk4(2e-3), Options::tsit5(1e-7)];
    assert_same_bits(&linkage, &options, 0.3, cases);
    for options in options {
        let finished = Batch::new(&linkage, options, 2.0)
            .cases(cases())
            .lanes(4)
            .run(|_, history| history.len());
        let chosen = finished.iter().map(|it| it.statistics.rows_strategy > 1);
        let chosen: Vec<bool> = chosen.collect();
        println!("{options:?}: rows chosen {chosen:?}");
        assert!(
            chosen.contains(&true) && chosen.contains(&false),
            "{options:?}"
        );
    }
}

#[test]
fn a_hinge_beside_an_equilibrium_point_is_what_it_is_alone() {
    let flap = Flap::new(FlapParams::default()).expect("params").in_lanes();
    let cases = || {
        (0..9_u32).map(|k| {
            let k = f64::from(k);
            let mut start = FlapState::at_origin();
            start.set_lamp(PointState {
                position: [0.1 + 0.01 * k, 0.1, 0.85],
                velocity: [0.0, 0.1 * k, 0.1 * k],
            });
            let case = Case::new().params([5.0 + k, 2000.0 + 300.0 * k]);
            case.state(0.0, start.to_vec()).joint("pin.angle", 0.02 * k)
        })
    };
    let options = [Options::rk4(2e-3), Options::tsit5(1e-6)];
    assert_same_bits(&flap, &options, 0.2, cases);
}

#[test]
fn motors_and_joints_that_let_go_are_what_they_are_alone() {
    let winch = Winch::new(WinchParams::default())
        .expect("params")
        .in_lanes();
    let cases = || {
        (0..9_u32).map(|k| {
            let k = f64::from(k);
            Case::new().params([1.0 + 0.6 * k, 0.5 + 0.2 * k, 0.01 * k])
        })
    };
    let options = [Options::rk4(4e-3), Options::tsit5(1e-6)];
    assert_same_bits(&winch, &options, 0.7, cases);
}

#[test]
fn an_angle_counts_turns_in_lanes_as_alone() {
    let wheel = Wheel::new(WheelParams::default())
        .expect("params")
        .in_lanes();
    let rate = |k: u32| 5.0 + 8.0 * f64::from(k);
    let cases = || {
        (0..9_u32).map(|k| {
            let inertia = 0.02 + 0.002 * f64::from(k);
            let case = Case::new().params([inertia]);
            case.joint("axle.angle_rate", rate(k))
        })
    };
    let options = [Options::rk4(1e-3), Options::tsit5(1e-8)];
    // The last of nine is flown alone.
    assert_same_bits(&wheel, &options, 0.8, cases);
    // θ = ω₀ √(I/k) sin(t √(k/I)): the largest is of many turns.
    let most = Batch::new(&wheel, options[1], 2.0)
        .cases(cases())
        .lanes(4)
        .run(|_, history| history.metrics(wheel.scene())[0].value);
    for (k, found) in (0..9_u32).zip(&most) {
        let inertia = 0.02 + 0.002 * f64::from(k);
        let expected = rate(k) * (inertia / 0.2_f64).sqrt();
        let found = found.result.as_ref().expect("a run").as_ref();
        let off = (found.expect("a value") / expected - 1.0).abs();
        assert!(off < 1e-6, "{k}: {found:?} and {expected}");
    }
    assert!(rate(8) * 0.3 > 20.0, "three turns");
}

#[test]
fn joints_that_come_apart_or_end_their_run_disturb_none_beside_them() {
    let chain = Chain::new(ChainParams::default())
        .expect("params")
        .in_lanes();
    for options in [Options::rk4(4e-3), Options::tsit5(1e-6)] {
        let fly = |lanes: usize| {
            let cases = (0..12_u32).map(|k| match k {
                // Out of range; so fast that fixed steps tear it apart; faster than anything can be followed.
                2 => chain_case(k).params([5.0, 0.1]),
                5 => chain_case(k).joint("first.angle_rate", 700.0),
                7 => chain_case(k).joint("first.angle_rate", 1e160),
                _ => chain_case(k % 5),
            });
            Batch::new(&chain, options, 0.5)
                .cases(cases)
                .threads(1)
                .lanes(lanes)
                .record(Sampling::Steps, Content::ALL)
                .run(|_, history| history.column("height").unwrap_or_default().to_vec())
        };
        let alone = fly(1);
        for lanes in [4, 8] {
            assert_eq!(bits(&fly(lanes)), bits(&alone), "{options:?} {lanes}");
        }
        let failed: Vec<(usize, &str)> = alone
            .iter()
            .filter_map(|it| Some((it.case, it.result.as_ref().err()?.why.status())))
            .collect();
        println!("{options:?}: {failed:?}");
        let numbers: Vec<usize> = failed.iter().map(|(case, _)| *case).collect();
        assert!(
            numbers.starts_with(&[2]) && numbers.ends_with(&[7]),
            "{failed:?}"
        );
    }
}
