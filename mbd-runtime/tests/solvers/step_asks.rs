//! What a step of RK4 asks of a model: counted, so that nothing is asked twice, and nothing of what a scene does not have.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use mbd_runtime::scene::laws::LineNumbers;
use mbd_runtime::scene::{ParamError, Scene};
use mbd_runtime::{At, Layout, Model, Options, Quantity, Simulation, StepStages, Work, model};

/// A model that counts what it is asked.
#[derive(Clone)]
struct Asked {
    model: Arc<dyn Model<f64>>,
    /// Whether it makes the stages of a step in one call, as the model does.
    at_once: bool,
    counts: Arc<Mutex<BTreeMap<String, usize>>>,
}

impl Asked {
    fn count(&self, what: &str) {
        *self.counts.lock().unwrap().entry(what.into()).or_default() += 1;
    }
}

impl Model<f64> for Asked {
    fn share(&self) -> Arc<dyn Model<f64>> {
        Arc::new(self.clone())
    }
    fn with_params(&self, params: &[f64]) -> Result<Arc<dyn Model<f64>>, ParamError> {
        self.model.with_params(params)
    }
    fn work(&self) -> Work<f64> {
        self.model.work()
    }
    fn scene(&self) -> &Scene {
        self.model.scene()
    }
    fn layout(&self) -> &Layout {
        self.count("layout");
        self.model.layout()
    }
    fn params(&self) -> &[f64] {
        self.model.params()
    }
    fn lines(&self) -> &[LineNumbers<f64>] {
        self.count("lines");
        self.model.lines()
    }
    fn evaluate(&self, what: Quantity, at: &At<'_, f64>, work: &mut Work<f64>, out: &mut [f64]) {
        self.count(&format!("{what:?}"));
        self.model.evaluate(what, at, work, out);
    }
    fn inner_stages(&self, step: StepStages<'_, f64>, work: &mut Work<f64>) -> bool {
        if !self.at_once {
            return false;
        }
        self.count("stages");
        self.model.inner_stages(step, work)
    }
}

/// What nine steps ask, the first of them after the first look back, at which a run looks at where bodies are.
fn asked(model: &impl Model<f64>, options: Options) -> Vec<(String, usize)> {
    asked_by(model, options, false)
}

fn asked_by(model: &impl Model<f64>, options: Options, at_once: bool) -> Vec<(String, usize)> {
    let model = Asked {
        model: model.share(),
        at_once,
        counts: Arc::default(),
    };
    let mut run = Simulation::new(&model, options).unwrap();
    run.start().unwrap();
    for _ in 0..10 {
        run.step().unwrap();
    }
    model.counts.lock().unwrap().clear();
    for _ in 0..9 {
        run.step().unwrap();
    }
    let counts = model.counts.lock().unwrap();
    counts.iter().map(|(what, n)| (what.clone(), *n)).collect()
}

fn expected(counts: &[(&str, usize)]) -> Vec<(String, usize)> {
    counts
        .iter()
        .map(|(what, n)| ((*what).into(), *n))
        .collect()
}

fn without_locating(step: f64) -> Options {
    Options {
        locate: false,
        ..Options::rk4(step)
    }
}

model! {
    /// A pendulum with a torque, and an input that an output alone reads.
    model Driven {
        coordinates: relative;
        emit: [derivative, outputs];
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input push: torque;
        input gain = 1;
        body rod {
            mass: 1 kg,
            inertia: diag(0.01, 0.01, 0.001) kg*m^2,
            frame top at [0, 0, 0.15] m,
        }
        joint hold: hinge from world to rod.top { axis: y, start: 0.3 rad, force: push }
        output shown = gain * hold.angle;
    }
}

model! {
    /// Two rods on hinges.
    model Rods {
        coordinates: relative;
        emit: [derivative];
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body upper {
            mass: 1 kg,
            inertia: diag(0.01, 0.01, 0.001) kg*m^2,
            frame top at [0, 0, 0.15] m,
            frame end at [0, 0, -0.15] m,
        }
        body lower {
            mass: 1 kg,
            inertia: diag(0.01, 0.01, 0.001) kg*m^2,
            frame top at [0, 0, 0.15] m,
        }
        joint hold: hinge from world to upper.top { axis: y, start: 0.3 rad }
        joint pin: hinge from upper.end to lower.top { axis: x, start: 0.3 rad }
    }
}

/// A mass that hangs on three lines, all of them taut, over a point of some kind.
macro_rules! hung {
    ($name:ident { $($point:tt)* } { $($damping:tt)* }) => {
        model! {
            /// A mass under a point on two lines.
            model $name {
                emit: [derivative];
                gravity: [0.0, 0.0, -9.81] m/s^2;
                world { frame left at [-1, 0, 0] m, frame right at [1, 0.5, 0] m, frame back at [0, -1, 0] m }
                point knot { $($point)* }
                point weight { mass: 50 kg, start at [0.0, 0.0, -2.3] m }
                line one from world.left to knot { free_length: 1.2 m, stiffness: 9 kN/m $($damping)* }
                line two from world.right to knot { free_length: 1.2 m, stiffness: 9 kN/m $($damping)* }
                line three from world.back to knot { free_length: 1.2 m, stiffness: 9 kN/m $($damping)* }
                line four from knot to weight { free_length: 1.0 m, stiffness: 9 kN/m $($damping)* }
            }
        }
    };
}

hung!(MassKnot { mass: 1 kg, start at [0.0, 0.0, -1.0] m } { , damping: 90 N*s/m });
hung!(RateKnot { equilibrium: rate } { , damping: 90 N*s/m });
hung!(StaticKnot { equilibrium: static } {});

model! {
    /// A capsule that swings and turns on a riser and three legs, which go slack and taut again.
    model Capsule {
        emit: [derivative];
        gravity: [0.0, 0.0, -3.7] m/s^2;
        body capsule {
            mass: 760 kg,
            inertia: diag(235, 225, 290) kg*m^2,
            start at [0.6, 0.0, -6.0] m,
            frame bridle[i in 0..3] at polar(0.6 m, i * 120 deg, 1.2 m),
        }
        joint capsule_free: free from world to capsule.com;
        point knot { equilibrium: rate }
        line riser from world to knot { free_length: 3 m, stiffness: 60 kN/m, damping: 500 N*s/m }
        line leg[i in 0..3] from capsule.bridle[i] to knot {
            free_length: 1.5 m,
            stiffness: 47 kN/m,
            damping: 500 N*s/m,
        }
    }
}

model! {
    /// A four-bar: a loop of hinges.
    model Bar {
        coordinates: relative;
        planar: xz;
        emit: [derivative];
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame pivot at [1.0, 0.0, 0.0] m }
        body crank {
            mass: 0.48 kg,
            inertia: diag(1e-5, 0.0036, 0.0036) kg*m^2,
            frame left at [-0.15, 0.0, 0.0] m,
            frame right at [0.15, 0.0, 0.0] m,
        }
        body coupler {
            mass: 1.44 kg,
            inertia: diag(1e-5, 0.0972, 0.0972) kg*m^2,
            frame left at [-0.45, 0.0, 0.0] m,
            frame right at [0.45, 0.0, 0.0] m,
        }
        body rocker {
            mass: 1.28 kg,
            inertia: diag(1e-5, 0.06827, 0.06827) kg*m^2,
            frame left at [-0.4, 0.0, 0.0] m,
            frame right at [0.4, 0.0, 0.0] m,
        }
        joint crank_pin: hinge from world to crank.left { axis: y, start: -60 deg }
        joint coupler_pin: hinge from crank.right to coupler.left { axis: y }
        joint rocker_pin: hinge from coupler.right to rocker.right { axis: y }
        joint ground_pin: hinge from world.pivot to rocker.left { axis: y }
    }
}

#[test]
fn a_step_without_lines_asks_for_four_derivatives_and_nothing_else() {
    let rods = Rods::new(RodsParams::default()).unwrap();
    let asked = asked(&rods, Options::rk4(1e-3));
    assert_eq!(asked, expected(&[("Derivative", 36)]));
}

#[test]
fn lines_between_masses_are_looked_at_once_a_step_where_they_are_located() {
    let knot = MassKnot::new(MassKnotParams::default()).unwrap();
    let free = asked(&knot, without_locating(1e-4));
    assert_eq!(free, expected(&[("Derivative", 36)]));
    let located = asked(&knot, Options::rk4(1e-4));
    assert_eq!(located, expected(&[("Derivative", 36), ("Guards", 9)]));
}

#[test]
fn a_rate_node_is_found_along_with_the_derivative() {
    let knot = RateKnot::new(RateKnotParams::default()).unwrap();
    let free = asked(&knot, without_locating(1e-3));
    assert_eq!(free, expected(&[("Rates", 36)]));
    let located = asked(&knot, Options::rk4(1e-3));
    assert_eq!(located, expected(&[("Guards", 9), ("Rates", 36)]));
}

#[test]
fn a_step_without_rows_is_made_in_one_call() {
    let rods = Rods::new(RodsParams::default()).unwrap();
    let knot = RateKnot::new(RateKnotParams::default()).unwrap();
    let only = expected(&[("stages", 9)]);
    assert_eq!(asked_by(&rods, Options::rk4(1e-3), true), only);
    assert_eq!(asked_by(&knot, without_locating(1e-3), true), only);
}

#[test]
fn a_static_node_asks_for_its_anchors_once_a_stage_and_for_its_lines_twice() {
    let knot = StaticKnot::new(StaticKnotParams::default()).unwrap();
    let asked: BTreeMap<String, usize> = asked(&knot, Options::rk4(1e-3)).into_iter().collect();
    let balances = asked["Equilibrium(0)"];
    assert_eq!(asked["AnchorStates"], 36);
    assert_eq!(asked["Derivative"], 36);
    assert_eq!(asked["lines"], 72);
    assert_eq!(asked.len(), 4, "{asked:?}");
    // Newton from the last place, carried along with the anchors: a step or two.
    assert!((36..=36 * 3).contains(&balances), "{balances}");
}

#[test]
fn stages_made_in_one_call_are_those_made_one_by_one() {
    let ends = |model: &dyn Model<f64>, options: Options| {
        let mut run = Simulation::new(model, options).unwrap();
        run.start().unwrap();
        for _ in 0..300 {
            run.step().unwrap();
        }
        let bits: Vec<u64> = run.state().iter().map(|x| x.to_bits()).collect();
        // How far quaternions were off, and where nodes are, are in the snapshot.
        (bits, run.snapshot(), run.statistics())
    };
    let rods = Rods::new(RodsParams::default()).unwrap();
    let bar = Bar::new(BarParams::default()).unwrap();
    let mass = MassKnot::new(MassKnotParams::default()).unwrap();
    let rate = RateKnot::new(RateKnotParams::default()).unwrap();
    let capsule = Capsule::new(CapsuleParams::default()).unwrap();
    let models: [(&dyn Model<f64>, f64); 5] = [
        (&rods, 1e-3),
        (&bar, 1e-3),
        (&mass, 1e-4),
        (&rate, 1e-3),
        (&capsule, 2e-3),
    ];
    for (model, step) in models {
        let one_by_one = Asked {
            model: model.share(),
            at_once: false,
            counts: Arc::default(),
        };
        for options in [Options::rk4(step), without_locating(step)] {
            let expected = ends(&one_by_one, options);
            assert_eq!(ends(model, options), expected, "{}", model.scene().name);
        }
    }
}

#[test]
fn inputs_as_functions_of_time_and_state_are_the_same_in_one_call() {
    let ends = |model: &dyn Model<f64>| {
        let mut run = Simulation::new(model, Options::rk4(1e-3)).unwrap();
        run.set_inputs(&DrivenInputs {
            push: 0.1,
            gain: 1.0,
        })
        .unwrap();
        run.control(|now, inputs: &mut DrivenInputs| {
            let turned = now.coordinates().hold_angle;
            inputs.push += (3.0 * now.time).sin() - 2.0 * turned;
        })
        .unwrap();
        run.control(|now, inputs: &mut DrivenInputs| {
            inputs.push -= 0.1 * now.state().hold().speeds[0];
        })
        .unwrap();
        run.run(0.3).unwrap();
        let bits: Vec<u64> = run.state().iter().map(|x| x.to_bits()).collect();
        (bits, run.statistics())
    };
    let driven = Driven::new(DrivenParams::default()).unwrap();
    let one_by_one = Asked {
        model: driven.share(),
        at_once: false,
        counts: Arc::default(),
    };
    assert_eq!(ends(&driven), ends(&one_by_one));
}

#[test]
fn an_input_that_is_no_number_ends_the_run_though_no_rate_reads_it() {
    let driven = Driven::new(DrivenParams::default()).unwrap();
    let mut run = Simulation::new(&driven, Options::rk4(1e-2)).unwrap();
    // Between the ends of the steps, where nothing but the stages inside them asks.
    run.control(|now, inputs: &mut DrivenInputs| {
        let inside = (now.time - 0.105).abs() < 1e-3;
        inputs.gain = if inside { f64::NAN } else { 1.0 };
    })
    .unwrap();
    let error = run.run(0.3).unwrap_err();
    assert!(error.to_string().contains("`gain`"), "{error}");
}
