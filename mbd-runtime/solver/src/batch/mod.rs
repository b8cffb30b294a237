//! Many runs of one model, on several threads: other params, inputs and starts.
//!
//! Every case is a run of its own, begun fresh: its numbers depend on what it starts with and on nothing else, whatever the threads and the cases
//! beside it. Cases come from an iterator and results go out in its order; what is held in memory depends on the number of threads, not on that of
//! the cases.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::available_parallelism;

use mbd_scene::Model;

use crate::compiled::Scalar;
use crate::content::Content;
use crate::error::RunError;
use crate::metric::MetricReader;
use crate::options::Options;
use crate::simulation::Simulation;
use crate::trajectory::{Joined, Sampling, Trajectory};

mod case;
mod flight;
mod queue;

pub use case::{Case, Failed, Finished, Why};
pub use flight::{Ended, Onward};
use flight::{Flights, Then};

/// Many runs of one model.
///
/// ```
/// use mbd_runtime::{Batch, Case, Options, model};
///
/// model! {
///     /// A stone that falls in air.
///     model Stone {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         param mass = 1.0 kg in 0.1 kg ..= 10.0 kg;
///         point stone { mass: mass, start at [0.0, 0.0, 100.0] m }
///         load air on stone = -0.02 kg/m * norm(stone.velocity) * stone.velocity;
///         output speed = norm(stone.velocity);
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let stone = Stone::new(StoneParams::default())?;
/// let masses = [0.5, 1.0, 20.0, 2.0];
/// let speeds = Batch::new(&stone, Options::tsit5(1e-8), 4.0)
///     .cases(masses.map(|mass| Case::new().params([mass])))
///     .threads(2)
///     .run(|_case, history| history.column("speed").and_then(|speed| speed.last().copied()));
///
/// // In the order of the cases; one that cannot be run is a result, too.
/// assert_eq!(speeds.len(), 4);
/// let failed = speeds[2].result.as_ref().expect_err("20 kg is out of range");
/// assert_eq!(failed.why.status(), "params");
/// let speed = |case: usize| speeds[case].result.as_ref().ok().copied().flatten();
/// assert!(speed(0) < speed(1) && speed(1) < speed(3));
/// # Ok(())
/// # }
/// ```
pub struct Batch<'b, T: Scalar = f64, I = std::iter::Empty<Case<T>>> {
    cases: I,
    flights: Flights<'b, T>,
    threads: usize,
    progress: Option<Watcher<'b>>,
    cancel: Option<&'b AtomicBool>,
}

/// How many numbers of `f64` a register has that the program is compiled for; 1 where lanes gain next to nothing.
const WIDTH: usize = if cfg!(target_feature = "avx512f") {
    8
} else if cfg!(target_feature = "avx") {
    4
} else {
    1
};

/// What is told of every case that is done.
type Watcher<'b> = Box<dyn FnMut(Tally) + 'b>;

/// How far a batch is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Cases that are done.
    pub done: usize,
    /// Those of them that did not reach their end.
    pub failed: usize,
    /// All cases, where the iterator knows how many it has.
    pub expected: Option<usize>,
}

impl<'b, T: Scalar> Batch<'b, T> {
    /// Runs of a model with these options from the start of each case until a time [s]; without cases, on all cores, every step recorded with
    /// [`Content::RESULTS`].
    #[must_use]
    pub fn new(model: &(impl Model<T> + ?Sized), options: Options, until: f64) -> Self {
        Batch {
            cases: std::iter::empty(),
            flights: Flights {
                model: model.share(),
                options,
                until,
                prepare: None,
                then: None,
                record: (Sampling::Steps, Content::RESULTS),
                measured: None,
                first: 0,
                beside: WIDTH,
            },
            threads: available_parallelism().map_or(1, usize::from),
            progress: None,
            cancel: None,
        }
    }
}

impl<'b, T: Scalar, I> Batch<'b, T, I> {
    /// What is run: asked for one by one, as threads are free.
    #[must_use]
    pub fn cases<C: IntoIterator<Item = Case<T>>>(self, cases: C) -> Batch<'b, T, C::IntoIter> {
        Batch {
            cases: cases.into_iter(),
            flights: self.flights,
            threads: self.threads,
            progress: self.progress,
            cancel: self.cancel,
        }
    }

    /// The number of the first case; 0 by itself.
    #[must_use]
    pub fn numbered_from(mut self, first: usize) -> Self {
        self.flights.first = first;
        self
    }

    /// On so many threads, at least one; results do not depend on it.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = threads.max(1);
        self
    }

    /// So many cases beside each other on each thread, in the lanes of one register: 8, 4 or 1, other numbers count as the next smaller one. By itself as many as
    /// the instructions that the program is compiled for have room for: 8 with AVX-512, 4 with AVX, else 1. Results do not depend on it.
    ///
    /// In lanes are the steps of explicit methods in which nothing happens, of models that have their equations over lanes at hand
    /// ([`InLanes`](crate::InLanes)), without inputs that are functions of time and state, whose rows of joints, if there are any, are solved as the compiler
    /// emitted them, and whose equilibrium points are `rate` nodes on lines that span space; and those of the stiff method of such models of bodies and
    /// points without rows in which nothing reads time and no point is one of equilibrium. Every other step is made by its case alone:
    /// [`Finished::beside`] tells how many were not.
    #[must_use]
    pub fn lanes(mut self, lanes: usize) -> Self {
        self.flights.beside = match lanes {
            8.. => 8,
            4.. => 4,
            _ => 1,
        };
        self
    }

    /// When a row of each history is written, and what it holds.
    #[must_use]
    pub fn record(mut self, sampling: Sampling, content: Content) -> Self {
        self.flights.record = (sampling, content);
        self
    }

    /// What each history measures, in place of the metrics that the model declares: see [`Trajectory::measure`].
    #[must_use]
    pub fn measure(mut self, readers: Vec<MetricReader>) -> Self {
        self.flights.measured = Some(readers);
        self
    }

    /// What is done with the run of each case before it begins: controllers, functions of time and state.
    #[must_use]
    pub fn prepare(
        mut self,
        prepare: impl Fn(&Case<T>, &mut Simulation<T>) -> Result<(), RunError> + Sync + 'b,
    ) -> Self {
        self.flights.prepare = Some(Box::new(prepare));
        self
    }

    /// What goes on with a case whose run an event ended (`then: stop`): `next` gives the run that took over, or `None`, and the case is done. The run is flown
    /// until the end of the batch, alone, and may be ended by an event, too. Histories have the columns of all models then, of which the first is that of the
    /// batch; counters are the sums of all runs.
    ///
    /// ```
    /// use mbd_runtime::{Batch, Case, Content, Joined, Onward, Options, Sampling, Simulation, Trajectory, model};
    ///
    /// model! {
    ///     /// A capsule under its parachute, until it is released.
    ///     model Chute {
    ///         gravity: [0.0, 0.0, -10.0] m/s^2;
    ///         param c = 200 N*s/m in 50 N*s/m ..= 500 N*s/m;
    ///         point capsule { mass: 80 kg, start at [0.0, 0.0, 100.0] m }
    ///         load drag on capsule = -c * capsule.velocity;
    ///         event released = capsule.position.z falls 95 m { then: stop }
    ///         output height = capsule.position.z;
    ///     }
    /// }
    ///
    /// model! {
    ///     /// The capsule alone.
    ///     model Fall {
    ///         gravity: [0.0, 0.0, -10.0] m/s^2;
    ///         point capsule { mass: 80 kg }
    ///         output height = capsule.position.z;
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let (chute, fall) = (Chute::new(ChuteParams::default())?, Fall::new(FallParams::default())?);
    /// let options = Options::tsit5(1e-8);
    /// let history = || Trajectory::new(&fall, Sampling::Steps, Content::RESULTS);
    /// let columns = Joined::new(&[&Trajectory::new(&chute, Sampling::Steps, Content::RESULTS), &history()]);
    /// let finished = Batch::new(&chute, options, 5.0)
    ///     .cases([100.0, 200.0, 400.0].map(|c| Case::new().params([c])))
    ///     .then(&columns, |_case, ended| {
    ///         if ended.model == 1 {
    ///             return Ok(None);
    ///         }
    ///         let mut run = Simulation::new(&fall, options)?;
    ///         run.take_over(ended.run, &[])?;
    ///         Ok(Some(Onward { model: 1, run, history: history() }))
    ///     })
    ///     .run(|_case, history| history.column("height").and_then(|height| height.last().copied()));
    /// let heights: Vec<f64> = finished.iter().filter_map(|case| *case.result.as_ref().ok()?).collect();
    /// // Who was slowed down more was released later, and has fallen less.
    /// assert!(heights.len() == 3 && heights.is_sorted());
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn then(
        mut self,
        columns: &'b Joined,
        next: impl Fn(&Case<T>, Ended<'_, T>) -> Result<Option<Onward<T>>, RunError> + Sync + 'b,
    ) -> Self {
        self.flights.then = Some(Then {
            columns,
            next: Box::new(next),
        });
        self
    }

    /// Who hears of every case that is done, on the calling thread.
    #[must_use]
    pub fn progress(mut self, watcher: impl FnMut(Tally) + 'b) -> Self {
        self.progress = Some(Box::new(watcher));
        self
    }

    /// A switch that ends the batch once it is true: cases under way are given up after their next step, results so far stay.
    #[must_use]
    pub fn cancel(mut self, switch: &'b AtomicBool) -> Self {
        self.cancel = Some(switch);
        self
    }
}

impl<T: Scalar, I> Batch<'_, T, I>
where
    I: Iterator<Item = Case<T>> + Send,
{
    /// Runs all cases and lists what `judge` makes of their histories, in the order of the cases. A batch that was cancelled has a shorter list.
    ///
    /// `judge` is called on the thread of the case. A panic in it, or in a controller, is a result of its case.
    pub fn run<R: Send>(
        self,
        judge: impl Fn(&Case<T>, &Trajectory) -> R + Sync,
    ) -> Vec<Finished<R, T>> {
        let mut all = Vec::new();
        self.each(judge, |finished| {
            all.push(finished);
            ControlFlow::Continue(())
        });
        all
    }

    /// The same without a list: each result is handed to `deliver` on the calling thread, in the order of the cases, until that breaks off.
    /// Memory does not grow with the number of cases. Tells how many were delivered.
    pub fn each<R: Send>(
        self,
        judge: impl Fn(&Case<T>, &Trajectory) -> R + Sync,
        mut deliver: impl FnMut(Finished<R, T>) -> ControlFlow<()>,
    ) -> Tally {
        let Batch {
            cases,
            flights,
            threads,
            mut progress,
            cancel,
        } = self;
        let mut tally = Tally {
            expected: cases.size_hint().1,
            ..Tally::default()
        };
        let cancelled = || cancel.is_some_and(|switch| switch.load(Ordering::Relaxed));
        queue::share_out(
            cases.fuse(),
            (threads, flights.beside),
            |desk| flights.work(desk, &judge, &cancelled),
            |finished| {
                tally.done += 1;
                tally.failed += usize::from(finished.result.is_err());
                if let Some(watcher) = &mut progress {
                    watcher(tally);
                }
                deliver(finished)
            },
        );
        tally
    }
}
