//! Parallelograms of more cranks than they need, through their flat positions: one motion goes on from there, that of the momenta.

use mbd_runtime::{Content, Generic, Options, Sampling, Simulation, Trajectory};
use tests::declared::read;

/// Weight at the tips and at the centres of the cranks, over g, and the inertia about the angle: cranks of a metre and 1 kg, a beam of 2 kg.
fn acceleration(cranks: usize, angle: f64) -> f64 {
    let count = cranks as f64;
    let (weight, inertia) = (0.5 * count + 2.0, 0.35 * count + 2.0);
    -9.81 * weight * angle.cos() / inertia
}

/// Cranks with their roots at these places of a line, all at an angle from it; flat at 0 and at 180 degrees.
fn cranks(roots: &[f64], words: &str, [angle, rate]: [f64; 2], events: &str) -> String {
    let mean = roots.iter().sum::<f64>() / roots.len() as f64;
    let numbered = || roots.iter().enumerate();
    let world: Vec<String> = numbered()
        .map(|(k, x)| format!("frame w{k} at [{x:?}, 0, 0] m"))
        .collect();
    let beam: Vec<String> = numbered()
        .map(|(k, x)| format!("frame t{k} at [{:?}, 0, 0] m", x - mean))
        .collect();
    let each: String = numbered()
        .map(|(k, _)| {
            let start = match k {
                0 => format!(", start_rate: {:?} rad/s", -rate),
                _ => String::new(),
            };
            format!(
                "body k{k} {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [-0.5, 0, 0] m, frame two at [0.5, 0, 0] m }}
                 joint r{k}: hinge from world.w{k} to k{k}.one {{ axis: y, start: {:?} rad{start} }}
                 joint t{k}: hinge from k{k}.two to beam.t{k} {{ axis: y, start: {angle:?} rad }}\n",
                -angle
            )
        })
        .collect();
    format!(
        "model Cranks {{ {words} gravity: [0, 0, -9.81] m/s^2;
           world {{ {} }}
           body beam {{ mass: 2 kg, inertia: diag(0.3, 0.3, 0.3) kg*m^2, {} }}
           {each} {events}
           output angle = r0.angle; output rate = r0.angle_rate; output curve = r0.angle_acceleration; }}",
        world.join(", "),
        beam.join(", ")
    )
}

/// What a run shows.
struct Shown {
    /// The largest difference of the acceleration from that of the angle told [rad/s²].
    curve: f64,
    /// The largest change of ½ θ̇² + ∫ of the acceleration by the angle [rad²/s²].
    energy: f64,
    rejected: u64,
    starts_singular: bool,
}

fn run(text: &str, count: usize, options: Options, until: f64) -> Shown {
    let model = Generic::<f64>::with_defaults(read(text)).expect("a valid scene");
    let mut run = Simulation::new(&model, options).expect("options that fit");
    let mut history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
    run.record(until, &mut history)
        .unwrap_or_else(|error| panic!("{:?}: {error}", options.method));
    let column = |name: &str| history.column(name).unwrap_or_else(|| panic!("{name}"));
    let [angle, rate, curve] = ["angle", "rate", "curve"].map(column);
    let scale = acceleration(count, 0.0);
    let energy = |k: usize| 0.5 * rate[k] * rate[k] - scale * (-angle[k]).sin();
    let (mut most, mut changed) = (0.0_f64, 0.0_f64);
    for k in 0..history.len() {
        most = most.max((curve[k] + acceleration(count, angle[k])).abs());
        changed = changed.max((energy(k) - energy(0)).abs());
    }
    let shown = Shown {
        curve: most,
        energy: changed,
        rejected: history.statistics.rejected,
        starts_singular: run.starts_singular(),
    };
    println!(
        "{:?}: curve {most:e}, energy {changed:e}, rejected {}, rows chosen {}, regularised {}",
        options.method,
        shown.rejected,
        history.statistics.rows_chosen,
        history.statistics.rows_regularised
    );
    shown
}

#[test]
fn cranks_beyond_need_keep_rows_that_hold_wherever_they_start_in_their_plane() {
    for coordinates in ["absolute", "relative"] {
        for components in ["body", "world"] {
            for roots in [&[0.0, 2.0, 4.0, 6.0][..], &[0.0, 2.0, 4.0, 7.0]] {
                for angle in [0.3, 0.7, 2.0] {
                    let words = format!(
                        "coordinates: {coordinates}; angular_velocity: {components}; planar: xz;"
                    );
                    let text = cranks(roots, &words, [angle, -1.0], "");
                    let shown = run(&text, roots.len(), Options::vern7(1e-9), 0.02);
                    assert!(!shown.starts_singular, "{words} {roots:?} {angle}");
                    assert!(shown.curve < 1e-11, "{words} {roots:?} {angle}");
                }
            }
        }
    }
}

#[test]
fn a_parallelogram_that_may_lose_a_joint_passes_its_flat_positions_as_lagrange_says() {
    // The event never comes; that it may makes runs choose rows at every state.
    let event = "event part = r0.angle rises 100 rad { detach: t1 }";
    for coordinates in ["absolute", "relative"] {
        for planar in ["", "planar: xz;"] {
            let words = format!("coordinates: {coordinates}; {planar}");
            for tolerance in [1e-8, 1e-11] {
                let text = cranks(&[0.0, 2.0, 4.0], &words, [0.7, -1.0], event);
                let shown = run(&text, 3, Options::vern7(tolerance), 1.0);
                assert!(!shown.starts_singular, "{words}");
                // ε over the cube of the angle of rows where limits begin, and what was measured without the event, times ten.
                assert!(
                    shown.curve < 1e-3,
                    "{words} {tolerance:e}: {:e}",
                    shown.curve
                );
                assert!(
                    shown.energy < 1e-6,
                    "{words} {tolerance:e}: {:e}",
                    shown.energy
                );
            }
        }
    }
}
