//! Rows that vanish along the speeds of a tree while no other row is near them: a rod in line with its cranks, a Bennett linkage folded flat.

use mbd_runtime::{Content, Generic, Options, Sampling, Simulation, Trajectory};
use mbd_scene::Scene;
use tests::declared::read;

fn record(scene: Scene, options: Options, until: f64) -> Trajectory {
    let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
    let mut run = Simulation::new(&model, options).expect("options that fit");
    let mut history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
    run.record(until, &mut history)
        .unwrap_or_else(|error| panic!("{error}"));
    history
}

fn column<'h>(history: &'h Trajectory, name: &str) -> &'h [f64] {
    history.column(name).unwrap_or_else(|| panic!("{name}"))
}

/// Two cranks of a metre, and a rod between their tips as long as their roots are apart: a parallelogram that turns over, flat twice a turn. There the
/// only row of the loop is zero along both speeds. Together the cranks are a pendulum.
#[test]
fn a_rod_passes_the_line_of_its_cranks() {
    // Where `flat` is watched, steps end there.
    let flat = "event flat = a.angle crosses 90 deg; event back = a.angle crosses 270 deg;";
    let cranks = |coordinates: &str, watched: &str| {
        read(&format!(
            "model Cranks {{ coordinates: {coordinates}; gravity: [0, 0, -9.81] m/s^2;
               world {{ frame far at [2, 0, 0] m }}
               body left {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [0, 0, -0.5] m, frame two at [0, 0, 0.5] m }}
               body right {{ mass: 1.3 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [0, 0, -0.5] m, frame two at [0, 0, 0.5] m }}
               joint a: hinge from world to left.one {{ axis: y, start: 10 deg, start_rate: 5 rad/s }}
               joint d: hinge from world.far to right.one {{ axis: y, start: 10 deg }}
               joint rod: distance from left.two to right.two {{ length: 2 m }}
               {watched}
               output angle = a.angle; output other = d.angle; output rate = a.angle_rate; output curve = a.angle_acceleration; }}"
        ))
    };
    let (inertia, weight) = (0.2 + 2.3 * 0.25, 2.3 * 9.81 * 0.5);
    for coordinates in ["absolute", "relative"] {
        for (tolerance, watched) in [(1e-6, ""), (1e-8, ""), (1e-10, ""), (1e-10, flat)] {
            let history = record(cranks(coordinates, watched), Options::vern7(tolerance), 1.5);
            let [angle, other, rate, curve] =
                ["angle", "other", "rate", "curve"].map(|name| column(&history, name));
            let begin = 10_f64.to_radians();
            let mut most = [0.0f64; 3];
            for k in 0..history.len() {
                let square = 25.0 + 2.0 * weight / inertia * (begin.cos() - angle[k].cos());
                most[0] = most[0].max((angle[k] - other[k]).abs());
                most[1] = most[1].max((rate[k] - square.sqrt()).abs());
                most[2] = most[2].max((curve[k] - weight / inertia * angle[k].sin()).abs());
            }
            println!("{coordinates} {tolerance:e}: {most:?}");
            assert!(angle[history.len() - 1] > 7.0, "{angle:?}");
            assert_eq!(
                history.events.len() >= 2,
                !watched.is_empty(),
                "{:?}",
                history.events
            );
            assert!(
                most[0] < 1e-4 && most[1] < 2e-3 && most[2] < 2e-2,
                "{coordinates} {tolerance:e}: {most:?}"
            );
        }
    }
}

/// A Bennett linkage: four hinges in space, one freedom, three rows of five repeated. Where it is flat one of the two that are kept is zero along the tree.
#[test]
fn a_bennett_linkage_passes_its_flat_position() {
    let bennett = |coordinates: &str| {
        // Lengths 0.6 m and 0.9 m, twists of 35° and of that with the same ratio of its sine to the length.
        let text = BENNETT.replace("COORDINATES", coordinates);
        read(&text)
    };
    let mut ends = Vec::new();
    for coordinates in ["absolute", "relative"] {
        for tolerance in [1e-8, 1e-11] {
            let history = record(bennett(coordinates), Options::vern7(tolerance), 0.6);
            let energy = column(&history, "energy.total");
            let kinetic = column(&history, "energy.kinetic");
            let most = kinetic.iter().fold(0.0, |most: f64, x| most.max(*x));
            let off = energy.iter().map(|e| (e - energy[0]).abs() / most);
            let off = off.fold(0.0, f64::max);
            let angle = column(&history, "angle");
            let end = angle[history.len() - 1];
            println!("{coordinates} {tolerance:e}: energy {off:e}, end {end}");
            assert!(off < 1e-6, "{coordinates} {tolerance:e}: {off:e}");
            assert!(end < -1.2, "{end}");
            ends.push(end);
        }
    }
    assert!(
        ends.iter().all(|end| (end - ends[1]).abs() < 1e-5),
        "{ends:?}"
    );
}

pub(super) const BENNETT: &str = "model Bennett { coordinates: COORDINATES; gravity: [0.0, 0.0, -9.81] m/s^2;
    world { frame o0 at [0.0, 0.0, 0.0] m, frame o3 at [-0.9000000000000001, -9.71445146547012e-17, 5.551115123125783e-17] m }
    body l0 { mass: 1.0 kg, inertia: diag(0.02, 0.025, 0.03) kg*m^2, frame a at [-0.19648299048119933, -0.254998072888245, 0.01] m, frame b at [0.1764829904811993, 0.21499807288824502, 0.01] m, start at [0.19648299048119933, 0.254998072888245, -0.01] m }
    body l1 { mass: 1.2 kg, inertia: diag(0.02, 0.025, 0.03) kg*m^2, frame a at [0.33784560273363945, 0.25668114663143704, -0.060363198886807044] m, frame b at [-0.35784560273363947, -0.2966811466314371, 0.08036319888680704] m, start at [0.03512037822875918, 0.21331499914505295, 0.060363198886807044] m }
    body l2 { mass: 1.4 kg, inertia: diag(0.02, 0.025, 0.03) kg*m^2, frame a at [0.27863738774756, -0.061683073743192, 0.08036319888680701] m, frame b at [-0.2986373877475599, 0.021683073743192, -0.06036319888680702] m, start at [-0.6013626122524403, -0.0216830737431921, 0.06036319888680707] m }
    joint j0: hinge from world.o0 to l0.a { axis: [0.0, 0.0, 1.0] }
    joint j1: hinge from l0.b to l1.a { axis: [0.44929785732200983, -0.3565408304009745, 0.8191520442889918] }
    joint j2: hinge from l1.b to l2.a { axis: [-0.15636266419290454, 0.42350209464243527, 0.8922985448155606] }
    joint j3: hinge from world.o3 to l2.b { axis: [6.555145918815815e-18, 0.8603646545265692, 0.5096789786143601] }
    output angle = j0.angle; }";
