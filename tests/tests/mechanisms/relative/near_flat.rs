//! Accelerations close to where rows that are kept lose rank while rows that repeat them elsewhere hold: a Bennett linkage, on both sides of flat.

use mbd_runtime::{Content, Generic, Options, Sampling, Simulation, Trajectory};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use tests::declared::read;

use super::vanishing_row::BENNETT;

const LENGTHS: [f64; 2] = [0.6, 0.9];
/// The twist of the shorter links [deg].
const TWIST: f64 = 35.0;
/// The angle between the fixed link and the first body at the start [rad].
const START: f64 = 0.9;

/// Where the three links of the linkage are when the first one is at this angle of the fixed one: one end, and axes along it and along its hinge there.
/// Closed form: tan(θ₁/2) tan(θ₂/2) = sin((β + α)/2)/sin((β − α)/2).
fn links(angle: f64) -> [(Vector3<f64>, Matrix3<f64>); 3] {
    let [short, long] = LENGTHS;
    let alpha = TWIST.to_radians();
    let beta = (alpha.sin() * long / short).asin();
    let ratio = (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin();
    let half = 0.5 * angle;
    let next = 2.0 * (ratio * half.cos()).atan2(half.sin());
    let turned = |axis: Vector3<f64>, angle: f64, what: Vector3<f64>| {
        Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle) * what
    };
    let triad = |along: Vector3<f64>, hinge: Vector3<f64>| {
        Matrix3::from_columns(&[along, hinge, along.cross(&hinge)])
    };
    let first = Vector3::new(angle.cos(), angle.sin(), 0.0);
    let second_hinge = turned(first, alpha, Vector3::z());
    let tip = short * first;
    let second = turned(second_hinge, next, first);
    let third_hinge = turned(second, beta, second_hinge);
    let far = tip + long * second;
    let third = (Vector3::new(-long, 0.0, 0.0) - far) / short;
    assert!((third.norm() - 1.0).abs() < 1e-14 && third.dot(&third_hinge).abs() < 1e-14);
    [
        (Vector3::zeros(), triad(first, Vector3::z())),
        (tip, triad(second, second_hinge)),
        (far, triad(third, third_hinge)),
    ]
}

/// The angular acceleration of the first body by Lagrange: M θ̈ = −V′ − ½ M′ θ̇², with derivatives by differences of the closed form.
fn acceleration(angle: f64, rate: f64) -> f64 {
    let masses = [1.0, 1.2, 1.4];
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.02, 0.025, 0.03));
    let centres = [
        Vector3::new(0.19648299048119933, 0.254998072888245, -0.01),
        Vector3::new(
            0.03512037822875918,
            0.21331499914505295,
            0.060363198886807044,
        ),
        Vector3::new(
            -0.6013626122524403,
            -0.0216830737431921,
            0.06036319888680707,
        ),
    ];
    let start = links(START);
    // Centres and attitudes.
    let places = |angle: f64| {
        let now = links(angle);
        [0, 1, 2].map(|body| {
            let (at, axes) = now[body];
            let (first, begin) = start[body];
            let turn = axes * begin.transpose();
            (at + turn * (centres[body] - first), turn)
        })
    };
    let step = 2e-3;
    // Sixth order.
    let weights = [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)];
    let mass = |angle: f64| {
        let here = places(angle);
        let mut speeds = [(Vector3::zeros(), Matrix3::zeros()); 3];
        for (far, weight) in weights {
            let [ahead, behind] = [far, -far].map(|far| places(angle + far * step));
            for (body, speed) in speeds.iter_mut().enumerate() {
                speed.0 += (ahead[body].0 - behind[body].0) * (weight / step);
                speed.1 += (ahead[body].1 - behind[body].1) * (weight / step);
            }
        }
        (0..3)
            .map(|body| {
                let (speed, turning) = speeds[body];
                let cross = here[body].1.transpose() * turning;
                let omega = Vector3::new(cross[(2, 1)], cross[(0, 2)], cross[(1, 0)]);
                masses[body] * speed.dot(&speed) + omega.dot(&(inertia * omega))
            })
            .sum::<f64>()
    };
    let height = |angle: f64| {
        let here = places(angle);
        let weight = |body: usize| 9.81 * masses[body] * here[body].0.z;
        (0..3).map(weight).sum::<f64>()
    };
    let slope = |of: &dyn Fn(f64) -> f64| {
        let parts =
            weights.map(|(far, w)| w / step * (of(angle + far * step) - of(angle - far * step)));
        parts.iter().sum::<f64>()
    };
    (-slope(&height) - 0.5 * slope(&mass) * rate * rate) / mass(angle)
}

/// Events on both sides of an angle of joint `j0`, from 1e-3 to 1e-9 rad away, and at it: steps end there.
fn watched(angle: f64) -> String {
    let off = (3..10).flat_map(|k| [10.0f64.powi(-k), -10.0f64.powi(-k)]);
    let events = off.chain([0.0]).enumerate();
    let events =
        events.map(|(k, off)| format!("event e{k} = j0.angle crosses {:?} rad; ", angle + off));
    events.collect()
}

fn methods() -> impl Iterator<Item = Options> {
    let seventh = [1e-6, 1e-8, 1e-9, 1e-11].map(Options::vern7);
    let stiff = [1e-5, 1e-7, 1e-9].map(Options::rodas5p);
    let others = [Options::tsit5(1e-6), Options::rk4(1e-3)];
    seventh.into_iter().chain(stiff).chain(others)
}

fn laws(text: &str) -> Generic<f64> {
    Generic::with_defaults(read(text)).expect("a valid scene")
}

/// The largest difference of the angular acceleration of joint `j0` from that of the motion, `want` for an angle and its rate.
fn off(model: &Generic<f64>, options: Options, until: f64, want: impl Fn(f64, f64) -> f64) -> f64 {
    let mut run = Simulation::new(model, options).expect("options that fit");
    let mut history = Trajectory::new(model, Sampling::Steps, Content::ALL);
    run.record(until, &mut history)
        .unwrap_or_else(|error| panic!("{:?}: {error}", options.method));
    assert_eq!(history.undetermined, 0, "what joints carry has a value");
    let column = |name: &str| history.column(name).unwrap_or_else(|| panic!("{name}"));
    let [angle, rate, curve] = ["angle", "rate", "curve"].map(column);
    let off = (0..history.len()).map(|k| ((curve[k] - want(angle[k], rate[k])).abs(), angle[k]));
    let (most, at) = off.fold(
        (0.0, 0.0),
        |most, off| if off.0 > most.0 { off } else { most },
    );
    println!(
        "{:?}: {most:e} at {at}, {} steps, rows chosen {}",
        options.method, history.statistics.steps, history.statistics.rows_chosen,
    );
    most
}

#[test]
fn a_bennett_linkage_is_accelerated_close_to_its_flat_position_as_lagrange_says() {
    for coordinates in ["absolute", "relative"] {
        for events in [String::new(), watched(-START)] {
            let outputs = "output rate = j0.angle_rate; output curve = j0.angle_acceleration; }";
            let text = BENNETT.replace("COORDINATES", coordinates);
            let text = text.trim_end().trim_end_matches('}').to_owned() + &events + outputs;
            let want = |angle: f64, rate: f64| acceleration(START + angle, rate);
            let model = laws(&text);
            for options in methods() {
                let most = off(&model, options, 0.6, want);
                assert!(most < 1e-6, "{coordinates} {:?}: {most:e}", options.method);
            }
        }
    }
}

/// Three cranks of a metre and a beam: two of them in line with their roots where they are upright or hang down, where the third keeps the beam from
/// turning. Of its last hinge only rows are kept that say nothing of that.
fn cranks(coordinates: &str, planar: &str, [angle, rate]: [f64; 2], events: &str) -> String {
    let crank = |name: &str| {
        format!(
            "body {name} {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [0, 0, -0.5] m, frame two at [0, 0, 0.5] m }}\n"
        )
    };
    let cranks = ["k0", "k1", "k2"].map(crank).join("");
    format!(
        "model Cranks {{ coordinates: {coordinates}; {planar}
           world {{ frame w1 at [0, 0, 2] m, frame w2 at [1.5, 0, 0.7] m }}
           {cranks}
           body beam {{ mass: 2 kg, inertia: diag(0.3, 0.3, 0.3) kg*m^2,
             frame t0 at [-0.5, 0, -0.8] m, frame t1 at [-0.5, 0, 1.2] m, frame t2 at [1.0, 0, -0.1] m }}
           joint j0: hinge from world to k0.one {{ axis: y, start: {angle} deg, start_rate: {rate} rad/s }}
           joint j1: hinge from k0.two to beam.t0 {{ axis: y, start: -{angle} deg }}
           joint j2: hinge from world.w1 to k1.one {{ axis: y, start: {angle} deg }}
           joint j3: hinge from k1.two to beam.t1 {{ axis: y, start: -{angle} deg }}
           joint j4: hinge from world.w2 to k2.one {{ axis: y, start: {angle} deg }}
           joint j5: hinge from k2.two to beam.t2 {{ axis: y, start: -{angle} deg }}
           {events}
           output angle = j0.angle; output rate = j0.angle_rate; output curve = j0.angle_acceleration; }}"
    )
}

#[test]
fn a_third_crank_keeps_a_parallelogram_on_its_branch_close_to_its_flat_position() {
    for coordinates in ["absolute", "relative"] {
        for planar in ["", "planar: xz;"] {
            for events in [String::new(), watched(std::f64::consts::PI)] {
                let planar = format!("{planar} gravity: [0, 0, -9.81] m/s^2;");
                let text = cranks(coordinates, &planar, [160.0, 4.0], &events);
                let (inertia, lifted) = (3.0 * 0.35 + 2.0, 3.0 * 0.5 + 2.0);
                let want = |angle: f64, _: f64| 9.81 * lifted / inertia * angle.sin();
                let model = laws(&text);
                for options in methods() {
                    let most = off(&model, options, 0.3, want);
                    assert!(
                        most < 1e-7,
                        "{coordinates} {planar} {:?}: {most:e}",
                        options.method
                    );
                }
            }
        }
    }
}

#[test]
fn what_rests_close_to_a_flat_position_has_reactions_of_its_own() {
    for coordinates in ["absolute", "relative"] {
        let text = cranks(coordinates, "gravity: none;", [179.9, 0.0], "");
        let most = off(&laws(&text), Options::rk4(1e-2), 0.1, |_, _| 0.0);
        assert!(most < 1e-12, "{coordinates}: {most:e}");
    }
}
