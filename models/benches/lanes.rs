//! Cases beside each other in lanes against cases one after the other, on one thread: derivatives, and trajectories of RK4.
//!
//!     cargo bench -p benches --bench lanes
//!     RUSTFLAGS="-C target-cpu=native" cargo bench -p benches --bench lanes

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mbd_runtime::{
    Batch, Case, Content, Lanes, Lanes4, Lanes8, LockStep, Model, Options, Real, Sampling, model,
};

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
            let rates = |_: f64, x: &[L], out: &mut [L]| rates(&chain, x, out);
            let mut run = LockStep::new(&layout, STEP, start(), rates).expect("an open tree");
            (0..STEPS).for_each(|_| run.step());
            run.state()[0]
        });
    });
}

/// The same by a batch of whole runs: watched, projected where there is something, recorded at the end.
fn batch(criterion: &mut Criterion) {
    let chain = Chain::<f64>::new(ChainParams::default()).expect("params");
    let until = STEP * STEPS as f64;
    let mut group = criterion.benchmark_group("100 steps of RK4 of a chain of eight");
    group.throughput(Throughput::Elements(8));
    group.bench_function("batch, one thread", |b| {
        b.iter(|| {
            let cases = (0..8).map(|k| {
                let length = 1.0 + 0.01 * f64::from(k);
                Case::new().params([length]).state(0.0, start::<f64>())
            });
            Batch::new(&chain, Options::rk4(STEP), until)
                .cases(cases)
                .threads(1)
                .record(Sampling::At(vec![until]), Content::RESULTS)
                .run(|_, history| history.len())
        });
    });
}

fn all(criterion: &mut Criterion) {
    derivative::<f64>(criterion, "f64", 1);
    derivative::<Lanes4>(criterion, "4 lanes", 4);
    derivative::<Lanes8>(criterion, "8 lanes", 8);
    batch(criterion);
    trajectories::<Lanes4>(criterion, "4 lanes");
    trajectories::<Lanes8>(criterion, "8 lanes");
}

criterion_group!(benches, all);
criterion_main!(benches);
