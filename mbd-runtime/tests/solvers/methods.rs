//! Every adaptive method on every kind of scene: the same calls, the same answers, what it costs, and what is refused.

use super::support::*;
use mbd_runtime::scene::{Clamp, Difference, NodeModel, PointKind};
use mbd_runtime::{
    Content, Generic, Method, Model, Options, Sampling, Simulation, Stop, Trajectory, model,
};

model! {
    /// Four links on ball joints, thrown sideways.
    model Chain<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body link[i in 0..4] {
            mass: 1 kg,
            inertia: diag(0.084, 0.084, 0.01) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame tip at [0.0, 0.0, -0.5] m,
        }
        joint first: spherical from world to link[0].top;
        joint next[i in 0..3]: spherical from link[i].tip to link[i + 1].top;
        load push on link[0] = [20 N * sin(5 rad/s * time), 6 N, 0 N];
        output tip = link[3].tip.position;
        event swings = link[3].tip.position.x rises 0.1 m;
    }
}

/// The options of an adaptive method.
fn adaptive(word: &str, rtol: f64) -> Options {
    Options {
        method: Method::adaptive(word, rtol).expect("an adaptive method"),
        ..Options::tsit5(rtol)
    }
}

#[test]
fn every_method_follows_a_chain_of_ball_joints_to_its_tolerance() {
    let chain = Chain::<f64>::new(ChainParams::default()).unwrap();
    let generic = Generic::<f64>::with_defaults(chain.scene().clone()).unwrap();
    let end = |model: &dyn Model<f64>, options: Options| {
        let mut run = Simulation::new(model, options).unwrap();
        run.run(2.0).unwrap_or_else(|error| panic!("{error}"));
        (run.state().to_vec(), run.statistics(), run.events()[0].time)
    };
    let (exact, _, swung) = end(&chain, Options::vern7(1e-13));
    let mut cost = Vec::new();
    for word in Method::ADAPTIVE {
        for rtol in [1e-5, 1e-7, 1e-9] {
            let (state, work, event) = end(&chain, adaptive(word, rtol));
            let tip = 3 * 7;
            let error = largest_difference(&state[tip..tip + 3], &exact[tip..tip + 3]);
            println!(
                "{word} {rtol:e}: {error:.1e} m, {} f, {} factors",
                work.rhs, work.factors
            );
            assert!(error < 10.0 * rtol, "{word} {rtol:e}: {error:e}");
            assert!(
                (event - swung).abs() < 10.0 * rtol,
                "{word}: {event} {swung}"
            );
            cost.push((word, rtol, work.rhs));
        }
        let (a, _, _) = end(&chain, adaptive(word, 1e-6));
        let (b, _, _) = end(&generic, adaptive(word, 1e-6));
        assert!(largest_difference(&a, &b) < 1e-10, "{word}");
    }
    // Tight tolerances are cheaper with the higher order.
    let of = |name: &str| {
        cost.iter()
            .find(|(word, rtol, _)| *word == name && *rtol == 1e-9)
    };
    assert!(
        of("vern7").unwrap().2 * 4 < of("tsit5").unwrap().2 * 3,
        "{cost:?}"
    );
}

#[test]
fn rows_between_steps_are_as_good_as_the_steps() {
    let chain = Chain::<f64>::new(ChainParams::default()).unwrap();
    let rows = |options: Options| {
        let mut history = Trajectory::new(&chain, Sampling::Every(0.01), Content::ALL);
        let mut run = Simulation::new(&chain, options).unwrap();
        assert_eq!(run.record(2.0, &mut history).unwrap(), Stop::Reached);
        assert_eq!(history.len(), 201);
        ["tip.x", "tip.y", "tip.z"].map(|name| history.column(name).unwrap().to_vec())
    };
    let exact = rows(Options {
        method: Method::adaptive("vern7", 1e-12)
            .unwrap()
            .with_largest_step(5e-3),
        ..Options::vern7(1e-12)
    });
    for word in Method::ADAPTIVE {
        for rtol in [1e-5, 1e-8] {
            let got = rows(adaptive(word, rtol));
            let error = (0..3)
                .map(|k| largest_difference(&got[k], &exact[k]))
                .fold(0.0, f64::max);
            println!("{word} {rtol:e}: {error:.1e} m");
            assert!(error < 30.0 * rtol, "{word} {rtol:e}: {error:e}");
        }
    }
}

#[test]
fn nodes_without_mass_are_followed_by_every_method() {
    let file = reference("parachute/case2_damped.json");
    let rate = PointKind::Node(NodeModel::Rate);
    for (word, rtol) in [("vern7", 1e-9), ("rodas5p", 1e-9), ("auto", 1e-9)] {
        let (worst, history) = compare(
            "case2_damped",
            &rate,
            adaptive(word, rtol),
            5.0,
            &[2.0, 5.0],
        );
        assert!(worst.iter().all(|error| *error < 3e-5), "{word}: {worst:?}");
        assert!(history.events.len() <= 12, "{word}: {:?}", history.events);
    }
    let fixed = PointKind::Node(NodeModel::Static);
    for (word, rtol) in [("vern7", 1e-10), ("rodas5p", 1e-9)] {
        let (worst, _) = compare("case2_eq_C0", &fixed, adaptive(word, rtol), 1.0, &[1.0]);
        assert!(worst[0] < 1e-3, "{word}: {worst:?}");
    }
    let stepwise = PointKind::Node(NodeModel::Stepwise {
        formula: Difference::Euler,
        clamp: Clamp::Positive,
    });
    let model = generic(parachute(&file, stepwise));
    for word in Method::ADAPTIVE {
        let error = Simulation::new(&model, adaptive(word, 1e-6)).err();
        let told = error.expect("refused").to_string();
        let method = Method::adaptive(word, 1e-6).unwrap();
        assert!(
            told.contains(method.name()) && told.contains("Rk4"),
            "{told}"
        );
    }
}

#[test]
fn single_precision_runs_to_what_it_holds_and_refuses_more() {
    let wide = Chain::<f64>::new(ChainParams::default()).unwrap();
    let narrow = Chain::<f32>::new(ChainParams::default()).unwrap();
    let mut exact = Simulation::new(&wide, Options::vern7(1e-10)).unwrap();
    exact.run(0.5).unwrap();
    for word in Method::ADAPTIVE {
        let mut run = Simulation::new(&narrow, adaptive(word, 1e-4)).unwrap();
        run.run(0.5)
            .unwrap_or_else(|error| panic!("{word}: {error}"));
        let got: Vec<f64> = run.state().iter().map(|x| f64::from(*x)).collect();
        let error = largest_difference(&got[21..24], &exact.state()[21..24]);
        println!("{word}: {error:e} m {:?}", run.statistics());
        assert!(error < 1e-3, "{word}: {error:e}");
        let told = Simulation::new(&narrow, adaptive(word, 1e-8)).err();
        let told = told.expect("refused").to_string();
        assert!(told.contains("rtol") && told.contains("f32"), "{told}");
    }
}

#[test]
fn options_of_every_method_survive_a_text() {
    let all = Method::ADAPTIVE.map(|word| (word, adaptive(word, 1e-7)));
    let fixed = Method::FIXED.map(|word| (word, Method::fixed(word, 0.1).map(Options::of)));
    let fixed = fixed.map(|(word, options)| (word, options.expect("a fixed step")));
    for (word, options) in all.into_iter().chain(fixed) {
        let text = serde_json::to_string(&options).unwrap();
        assert_eq!(
            serde_json::from_str::<Options>(&text).unwrap_or(options),
            options
        );
        assert_eq!(options.method.word(), word);
    }
}
