//! Cases beside each other in lanes against cases one after the other, on one thread: derivatives, trajectories of RK4, and whole flights of the
//! parachute as a batch flies them: watched, located, recorded every half second.
//!
//!     cargo bench -p benches --bench lanes
//!     RUSTFLAGS="-C target-cpu=native" cargo bench -p benches --bench lanes

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mbd_runtime::{
    Batch, Beside, Case, Content, InLanes, Lanes, Lanes4, Lanes8, LockStep, Model, Options, Real,
    Sampling, model,
};
use models::parachute::scene::{
    ParachuteMass, ParachuteMassParams, ParachuteRate, ParachuteRateParams, ParachuteStepwise,
    ParachuteStepwiseParams, SceneInstant, TestCase,
};
use models::parachute::variant::state;

model! {
    /// Eight slender rods on hinges, axes y and x in turn.
    pub model Chain<T> {
        units: si;
        gravity: [0.0, 0.0, -9.81];
        coordinates: relative;
        emit: [derivative];
        param length = 1.0 in 0.5 ..= 2.0;
        body link[i in 0..8] {
            mass: 1.0,
            inertia: diag(0.0833, 0.0833, 0.001),
            frame top at [0.0, 0.0, 0.5 * length],
            frame end at [0.0, 0.0, -0.5 * length],
        }
        joint base: hinge from world to link[0].top { axis: y }
        joint odd[i in 0..4]: hinge from link[2 * i].end to link[2 * i + 1].top { axis: x }
        joint even[i in 0..3]: hinge from link[2 * i + 1].end to link[2 * i + 2].top { axis: y }
    }
}

const STEP: f64 = 1e-3;
const STEPS: usize = 100;

fn start<L: Real>() -> Vec<L> {
    (0..16)
        .map(|at| L::from_f64(0.1 * f64::from(at) - 0.5))
        .collect()
}

fn rates<L: Real>(chain: &Chain<L>, x: &[L], out: &mut [L]) {
    if let Some(state) = ChainState::from_slice(x) {
        let rates = chain.derivative(&state);
        let (q, v) = out.split_at_mut(8);
        q.copy_from_slice(rates.q.as_slice());
        v.copy_from_slice(rates.v.as_slice());
    }
}

fn derivative<L: Real>(criterion: &mut Criterion, name: &str, width: u64) {
    let chain = Chain::unchecked(ChainParams { length: L::one() });
    let (x, mut out) = (start::<L>(), vec![L::zero(); 16]);
    let mut group = criterion.benchmark_group("derivative of a chain of eight");
    group.throughput(Throughput::Elements(width));
    group.bench_function(name, |b| b.iter(|| rates(&chain, black_box(&x), &mut out)));
}

fn trajectories<L: Lanes>(criterion: &mut Criterion, name: &str) {
    let chain = Chain::unchecked(ChainParams {
        length: L::each(|lane| 1.0 + 0.01 * lane as f64),
    });
    let layout = Chain::<f64>::new(ChainParams::default())
        .expect("params")
        .layout()
        .clone();
    let mut group = criterion.benchmark_group("100 steps of RK4 of a chain of eight");
    group.throughput(Throughput::Elements(L::WIDTH as u64));
    group.bench_function(name, |b| {
        b.iter(|| {
            let mut run =
                LockStep::of_model(chain.clone(), &layout, STEP, start()).expect("an open tree");
            (0..STEPS).for_each(|_| run.step());
            run.state()[0]
        });
    });
}

/// The same by a batch of whole runs: watched, recorded at the end.
fn batch(criterion: &mut Criterion, lanes: usize) {
    let chain = Chain::new(ChainParams::default())
        .expect("params")
        .in_lanes();
    let until = STEP * STEPS as f64;
    let mut group = criterion.benchmark_group("100 steps of RK4 of a chain of eight");
    group.throughput(Throughput::Elements(8));
    group.bench_function(format!("batch, {lanes} lanes"), |b| {
        b.iter(|| {
            let cases = (0..8).map(|k| {
                let length = 1.0 + 0.01 * f64::from(k);
                Case::new().params([length]).state(0.0, start::<f64>())
            });
            Batch::new(&chain, Options::rk4(STEP), until)
                .cases(cases)
                .threads(1)
                .lanes(lanes)
                .record(Sampling::At(vec![until]), Content::RESULTS)
                .run(|_, history| history.len())
        });
    });
}

/// Flights of 70 s with other masses, stiffnesses and starts, on one thread.
fn flights(criterion: &mut Criterion, name: &str, model: &Beside, options: Options) {
    const COUNT: u32 = 16;
    let at = SceneInstant::start(TestCase::Three);
    let start = state(model, &at);
    let cases = |k: u32| {
        let part = 1.0 + 0.02 * (f64::from(k) / f64::from(COUNT) - 0.5);
        let mut params = model.params().to_vec();
        for param in params.iter_mut().take(5) {
            *param *= part;
        }
        let case = Case::new().params(params).state(0.0, start.clone());
        match model.layout().nz {
            0 => case.nodes(at.point),
            _ => case,
        }
    };
    let mut group = criterion.benchmark_group(format!("70 s of the parachute, {name}"));
    group.throughput(Throughput::Elements(u64::from(COUNT)));
    group.sample_size(10);
    for lanes in [1, 4, 8] {
        group.bench_function(format!("{lanes} lanes"), |b| {
            b.iter(|| {
                let finished = Batch::new(model, options, 70.0)
                    .cases((0..COUNT).map(cases))
                    .threads(1)
                    .lanes(lanes)
                    .record(Sampling::Every(0.5), Content::RESULTS)
                    .run(|_, history| history.len());
                assert!(finished.iter().all(|it| it.result.is_ok()));
            });
        });
    }
}

fn parachutes(criterion: &mut Criterion) {
    let stepwise = ParachuteStepwise::new(ParachuteStepwiseParams::default());
    let stepwise = stepwise.expect("params").in_lanes();
    let options = Options::rk4(0.02);
    flights(criterion, "stepwise node, RK4 0.02 s", &stepwise, options);
    let rate = ParachuteRate::new(ParachuteRateParams::default());
    let rate = rate.expect("params").in_lanes();
    let options = Options::tsit5(1e-6);
    flights(criterion, "rate node, Tsit5 1e-6", &rate, options);
    let mass = ParachuteMass::new(ParachuteMassParams::default());
    let mass = mass.expect("params").in_lanes();
    let options = Options::rodas5p(1e-4);
    flights(criterion, "point of 0.1 kg, Rodas5P 1e-4", &mass, options);
}

fn all(criterion: &mut Criterion) {
    derivative::<f64>(criterion, "f64", 1);
    derivative::<Lanes4>(criterion, "4 lanes", 4);
    derivative::<Lanes8>(criterion, "8 lanes", 8);
    for lanes in [1, 4, 8] {
        batch(criterion, lanes);
    }
    trajectories::<Lanes4>(criterion, "4 lanes");
    trajectories::<Lanes8>(criterion, "8 lanes");
    parachutes(criterion);
}

criterion_group!(benches, all);
criterion_main!(benches);
