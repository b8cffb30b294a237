//! What is measured of a quantity that time moves much faster than anything else moves: steps are long beside it.

use mbd_compiler::{Interpreted, read_text};
use mbd_runtime::{Content, MetricValue, MissingMetric, Options, Sampling, Simulation, Trajectory};

/// A stone in flight, and a current that swings about 2 A by 1 A.
const RIPPLE: &str = "model Ripple {
    gravity: [0, 0, -9.81] m/s^2;
    point p { mass: 1 kg, start at [0, 0, 0] m velocity [1, 0, 50] m/s }
    param w = 100 rad/s;
    output ripple = 2 A + 1 A * sin(w * time);
    event never = p.position.z falls -1 km;
    metric charge = integral ripple;
    metric above = time_above ripple { level: 2.5 A };
    metric average = mean abs(ripple - 2 A);
    metric top = max ripple;
    metric low = min ripple;
    metric first = first_above ripple { level: 2.999 A };
    metric fallen = time_of never;
}";

/// Its metrics after ten seconds.
fn recorded(w: f64, options: Options) -> Vec<MetricValue> {
    let read = read_text(RIPPLE);
    let scene = read.scene.unwrap_or_else(|| panic!("{:?}", read.errors));
    let model = Interpreted::<f64>::new(scene.clone(), &[w]).expect("a param in range");
    let mut history = Trajectory::new(&model, Sampling::Every(1.0), Content::RESULTS);
    let mut run = Simulation::new(&model, options).expect("a model that runs");
    run.record(10.0, &mut history).expect("a run that ends");
    history.metrics(&scene)
}

#[test]
fn what_swings_faster_than_steps_is_measured_as_its_closed_form() {
    for w in [3.0_f64, 8.0, 47.0, 100.0, 333.0] {
        // By whole half-periods and the rest.
        let half = std::f64::consts::PI / w;
        let halves = (10.0 / half).floor();
        let rest = 10.0 - halves * half;
        let mean = (2.0 * halves / w + (1.0 - (w * rest).cos()) / w) / 10.0;
        let charge = 20.0 + (1.0 - (10.0 * w).cos()) / w;
        let [rises, falls] = [1.0, 5.0].map(|sixths: f64| sixths * half / 6.0);
        let whole = (halves / 2.0).floor();
        let into = 10.0 - 2.0 * whole * half;
        let above = whole * (falls - rises) + (into.min(falls) - rises).max(0.0);
        let exact = [charge, above, mean, 3.0, 1.0, (0.999_f64).asin() / w];
        for options in [
            Options::tsit5(1e-8),
            Options::vern7(1e-8),
            Options::rk4(0.5),
        ] {
            for (metric, exact) in recorded(w, options).iter().zip(exact) {
                let (name, found) = (&metric.name, metric.value.unwrap_or(f64::NAN));
                assert!(metric.unresolved < 1e-7, "{name}: {}", metric.unresolved);
                let off = (found - exact).abs();
                println!("{w} {} {name}: {off:.1e}", options.method.name());
                assert!(
                    off < 1e-7 * exact.max(0.1),
                    "{w} {options:?} {name}: {found} {exact}"
                );
            }
        }
    }
}

#[test]
fn an_event_that_is_not_located_is_told_as_that() {
    let fallen = |locate: bool| {
        let mut options = Options::tsit5(1e-8);
        options.locate = locate;
        let found = recorded(3.0, options);
        found.last().and_then(|metric| metric.value.err())
    };
    assert_eq!(fallen(true), Some(MissingMetric::NoEvent));
    assert_eq!(fallen(false), Some(MissingMetric::NotLocated));
}
