//! Drawings that stand still, for paper and for pages whose script does not run: bodies are seen as their shapes.

use std::f64::consts::PI;

use mbd_report::{Drawing, drawings};
use mbd_runtime::{Content, Options, Sampling, Simulation, Trajectory, model};

model! {
    /// Every solid, in a plane, flown for an instant.
    model Solids {
        planar: xz;
        gravity: none;
        body plank {
            mass: 1 kg,
            shape: box [0.8, 0.2, 0.4] m,
            start at [0.0, 0.0, 0.0] m rotated rpy(0.0, 30 deg, 0.0),
        }
        body roller {
            mass: 1 kg,
            shape: cylinder { radius: 0.2 m, length: 0.6 m },
            start at [2.0, 0.0, 0.0] m,
        }
        body wheel {
            mass: 1 kg,
            shape: tube {
                radius: 0.4 m,
                inner: 0.3 m,
                length: 0.1 m,
            } at [0.0, 0.0, 0.0] m rotated rpy(90 deg, 0.0, 0.0),
            start at [4.0, 0.0, 0.0] m,
        }
        body ball { mass: 1 kg, shape: sphere { radius: 0.3 m }, start at [6.0, 0.0, 0.0] m }
        body pill {
            mass: 1 kg,
            shape: capsule { radius: 0.1 m, length: 0.5 m },
            start at [8.0, 0.0, 0.0] m,
        }
        joint a: free from world to plank.com;
        joint b: free from world to roller.com;
        joint c: free from world to wheel.com;
        joint d: free from world to ball.com;
        joint e: free from world to pill.com;
    }
}

fn drawn(content: Content) -> Vec<Drawing> {
    let model = Solids::new(SolidsParams::default()).expect("no params");
    let mut history = Trajectory::new(&model, Sampling::Steps, content);
    let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("a model that runs");
    run.record(0.01, &mut history).expect("a run that ends");
    drawings(&Solids::scene(), &[], &[0.0], &history)
}

/// The places of every closed line of a class [px].
fn polygons(svg: &str, class: &str) -> Vec<Vec<[f64; 2]>> {
    let begin = format!("<path class=\"{class}\" d=\"M");
    let lines = svg.split(&begin).skip(1);
    lines
        .filter_map(|rest| {
            let (data, _) = rest.split_once("Z\"")?;
            let numbers: Vec<f64> = (data.split_whitespace())
                .map(|number| number.parse().expect("a number"))
                .collect();
            Some(numbers.chunks_exact(2).map(|p| [p[0], p[1]]).collect())
        })
        .collect()
}

fn area(polygon: &[[f64; 2]]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let sum: f64 = (polygon.iter().zip(next))
        .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
        .sum();
    0.5 * sum.abs()
}

#[test]
fn silhouettes_have_the_areas_of_the_solids_seen_from_the_side() {
    let drawings = drawn(Content::ALL);
    assert_eq!(drawings.len(), 1, "a plane is seen along its normal");
    let svg = drawings[0].svg();
    let silhouettes = polygons(&svg, "mbd-solid");
    let wanted = [
        0.8 * 0.4,
        2.0 * 0.2 * 0.6,
        PI * 0.16,
        PI * 0.09,
        2.0 * 0.1 * 0.5 + PI * 0.01,
    ];
    assert_eq!(silhouettes.len(), wanted.len());
    let scale = area(&silhouettes[0]) / wanted[0];
    for (silhouette, wanted) in silhouettes.iter().zip(wanted) {
        let share = area(silhouette) / (scale * wanted);
        // Corners lie on what is round, and pixels have tenths.
        assert!((0.97..1.02).contains(&share), "{share}");
    }
}

#[test]
fn what_is_flat_and_looks_at_the_reader_has_its_rims() {
    let svg = drawn(Content::ALL)[0].svg();
    let rims = polygons(&svg, "mbd-rim");
    // The face of the plank, and the two rims of the wheel; roller, ball and pill show what is round.
    assert_eq!(rims.len(), 3);
    let silhouettes = polygons(&svg, "mbd-solid");
    let shares = [
        (&rims[0], &silhouettes[0], 1.0),
        (&rims[1], &silhouettes[2], 1.0),
        (&rims[2], &silhouettes[2], 0.75 * 0.75),
    ];
    for (k, (rim, silhouette, wanted)) in shares.into_iter().enumerate() {
        let shares = [area(rim) / area(silhouette), wanted];
        assert!((shares[0] - shares[1]).abs() < 0.02, "{k}: {shares:?}");
    }
}

model! {
    /// A trailer whose hitch stands before its box, and whose wheel is in it.
    model Towed {
        planar: xz;
        gravity: none;
        world { frame hitch at [2.0, 0.0, 0.0] m, frame ground at [0.0, 0.0, -1.0] m }
        body trailer {
            mass: 1 kg,
            shape: box [2.0, 1.0, 0.6] m,
            frame hitch at [2.0, 0.0, 0.0] m,
            frame wheel at [0.0, 0.0, -0.3] m,
            frame nothing at [0.0, 0.0, 5.0] m,
        }
        joint pin: hinge from world.hitch to trailer.hitch { axis: y }
        spring tyre from world.ground to trailer.wheel { free_length: 0.7 m, stiffness: 1 kN/m }
        output seen = trailer.nothing.position.z;
    }
}

#[test]
fn what_holds_a_body_outside_of_its_shapes_is_joined_to_it() {
    let model = Towed::new(TowedParams::default()).expect("no params");
    let mut history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
    let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("a model that runs");
    run.record(0.01, &mut history).expect("a run that ends");
    let drawing = &drawings(&Towed::scene(), &[], &[0.0], &history)[0];
    // One line, to the hitch: the wheel is at the box, and nothing is held by the third frame.
    assert_eq!(drawing.svg().matches("class=\"mbd-body\" d=").count(), 2);
}

#[test]
fn a_history_without_motion_draws_no_solids() {
    assert!(drawn(Content::RESULTS).iter().all(|drawing| {
        let svg = drawing.svg();
        !svg.contains("class=\"mbd-solid\"")
    }));
}

model! {
    /// A stone that falls.
    model Falling {
        gravity: [0.0, 0.0, -10.0] m/s^2;
        point stone { mass: 1 kg, start at [0.0, 0.0, 5.0] m }
    }
}

#[test]
fn a_single_point_that_falls_is_drawn_on_its_way() {
    let model = Falling::new(FallingParams::default()).expect("no params");
    let mut history = Trajectory::new(&model, Sampling::Every(0.1), Content::ALL);
    let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("a model that runs");
    run.record(1.0, &mut history).expect("a run that ends");
    let drawings = drawings(&Falling::scene(), &[], &[], &history);
    // 5 m, upwards, in the plane with z.
    assert_eq!(drawings.len(), 1);
    assert!(drawings[0].svg().contains(">z [m]<"));
}
