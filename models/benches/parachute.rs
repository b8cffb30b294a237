//! Generated against interpreted against generic, in one run, on the parachute: state derivative, node solve, one step of each model.
//!
//! `cargo bench -p benches --bench parachute`. Absolute times drift from day to day; read the ratios. Operation counts are printed first.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use mbd_compiler::{Interpreted, SceneEquations};
use mbd_runtime::node::{NodeMemory, Nodes};
use mbd_runtime::{At, Generic, Model, Options, Quantity, Simulation};
use models::parachute::scene::{
    ParachuteMass, ParachuteRate, ParachuteStatic, ParachuteStepwise, SceneInstant, TestCase,
};
use models::parachute::variant::{Confluence, FlightPlan, fly, state};

/// What every execution is asked for, all lines taut.
struct Setting {
    state: Vec<f64>,
    nodes: Vec<f64>,
    step: f64,
}

impl Setting {
    fn new(model: &dyn Model<f64>, at: &SceneInstant, step: f64) -> Self {
        Setting {
            state: state(model, at),
            nodes: at.point.to_vec(),
            step,
        }
    }
}

fn simulation(model: &dyn Model<f64>, setting: &Setting) -> Simulation<f64> {
    let options = Options {
        locate: false,
        ..Options::rk4(setting.step)
    };
    let mut simulation = Simulation::new(model, options).expect("fixed steps suit every model");
    simulation
        .set_state(6.0, &setting.state)
        .expect("a state of the scene");
    if !model.layout().nodes.is_empty() && model.layout().nz == 0 {
        simulation.set_nodes(&setting.nodes).expect("one node");
    }
    simulation.start().expect("a taut start");
    simulation
}

fn execution(
    c: &mut Criterion,
    scene: &str,
    execution: &str,
    model: &dyn Model<f64>,
    setting: &Setting,
) {
    let layout = model.layout();
    let (effective, hold) = (numbers(model), vec![0.0; layout.one_way()]);
    let at = At {
        time: 6.0,
        state: &setting.state,
        nodes: &setting.nodes[..3 * layout.nodes.len()],
        effective: &effective,
        hold: &hold,
        ends: &[],
        inputs: &[],
        rows: &[],
    };
    let mut work = model.work();
    let mut out = vec![0.0; layout.len(Quantity::Derivative)];
    c.benchmark_group(format!("{scene}: state derivative"))
        .bench_function(BenchmarkId::from_parameter(execution), |b| {
            b.iter(|| {
                model.evaluate(
                    Quantity::Derivative,
                    black_box(&at),
                    &mut work,
                    black_box(&mut out),
                )
            });
        });
    let mut run = simulation(model, setting);
    let start = run.snapshot();
    c.benchmark_group(format!("{scene}: one step of RK4"))
        .bench_function(BenchmarkId::from_parameter(execution), |b| {
            b.iter(|| {
                if run.time() > 20.0 {
                    run.restore(&start).expect("the same model");
                }
                run.step().expect("a stable step");
            });
        });
    if layout.nz == 0 && !layout.nodes.is_empty() {
        solves(c, scene, execution, model, setting);
    }
}

/// A node solve after anchors moved by one step, and one from a metre away.
fn solves(
    c: &mut Criterion,
    scene: &str,
    execution: &str,
    model: &dyn Model<f64>,
    setting: &Setting,
) {
    let mut work = model.work();
    let (mut nodes, mut memory) = (Nodes::new(model.layout()), NodeMemory::new(model.layout()));
    let mut earlier = setting.state.clone();
    earlier[9] -= 1e-3;
    nodes
        .start(
            model,
            6.0,
            &mut earlier,
            &[],
            Some(&setting.nodes),
            &mut memory,
            &mut work,
        )
        .expect("a taut start");
    c.benchmark_group(format!("{scene}: node solve, warm"))
        .bench_function(BenchmarkId::from_parameter(execution), |b| {
            b.iter(|| {
                nodes
                    .solve(
                        model,
                        6.0,
                        0.005,
                        black_box(&setting.state),
                        &[],
                        &memory,
                        &mut work,
                    )
                    .expect("an equilibrium")
            });
        });
    let mut state = setting.state.clone();
    let far: Vec<f64> = setting.nodes.iter().map(|x| x + 1.0).collect();
    c.benchmark_group(format!("{scene}: start from a metre away"))
        .bench_function(BenchmarkId::from_parameter(execution), |b| {
            b.iter(|| {
                nodes
                    .start(
                        model,
                        6.0,
                        black_box(&mut state),
                        &[],
                        Some(&far),
                        &mut memory,
                        &mut work,
                    )
                    .expect("an equilibrium")
            });
        });
}

/// Effective numbers that are those of the declaration.
fn numbers(model: &dyn Model<f64>) -> Vec<f64> {
    let lines = model.layout().lines.iter().zip(model.lines());
    lines
        .filter(|(slots, _)| slots.effective.is_some())
        .flat_map(|(_, line)| [line.stiffness, line.free_length])
        .collect()
}

fn compare(
    c: &mut Criterion,
    scene: &str,
    generated: &dyn Model<f64>,
    at: &SceneInstant,
    step: f64,
) {
    let setting = Setting::new(generated, at, step);
    let equations = SceneEquations::trace(generated.scene());
    for what in [
        Quantity::AnchorStates,
        Quantity::Equilibrium(0),
        Quantity::Derivative,
    ] {
        if let Some(program) = equations.program(what) {
            println!("{scene}, {what:?}: {}", program.cost());
        }
    }
    execution(c, scene, "generated", generated, &setting);
    let interpreted =
        Interpreted::from_equations(equations, generated.params()).expect("the same parameters");
    execution(c, scene, "interpreted", &interpreted, &setting);
    let generic =
        Generic::new(generated.scene().clone(), generated.params()).expect("the same parameters");
    execution(c, scene, "generic", &generic, &setting);
}

fn parachute(c: &mut Criterion) {
    // Case 3 at 6 s: a taut swing.
    let flight = fly(&FlightPlan::new(
        TestCase::Three,
        Confluence::Rate,
        Options::tsit5(1e-9),
        6.0,
    ))
    .expect("case 3 flies");
    let at = &flight.end;
    compare(
        c,
        "point of 0.1 kg",
        &ParachuteMass::new(Default::default()).expect("defaults"),
        at,
        1e-4,
    );
    compare(
        c,
        "static",
        &ParachuteStatic::new(Default::default()).expect("defaults"),
        at,
        0.01,
    );
    compare(
        c,
        "stepwise",
        &ParachuteStepwise::new(Default::default()).expect("defaults"),
        at,
        0.01,
    );
    compare(
        c,
        "rate",
        &ParachuteRate::new(Default::default()).expect("defaults"),
        at,
        0.01,
    );
}

criterion_group!(benches, parachute);
criterion_main!(benches);
