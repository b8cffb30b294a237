//! Work shared by threads: handed out in order, given back in order, with a bounded number under way.
//!
//! A worker that is far ahead of the oldest piece of work under way waits: what is done and not yet given back never grows with the number of cases.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

/// How many cases a thread may be ahead of the oldest one under way, for each that it has under way at once.
const AHEAD: usize = 16;

/// Work for several threads.
struct Queue<I, D> {
    inner: Mutex<Inner<I, D>>,
    /// Something was given back, or is over: who waits for room looks again.
    room: Condvar,
    /// Something is done, or a worker left: who collects looks again.
    done: Condvar,
    /// Whether nothing more is begun.
    stop: AtomicBool,
    /// The most that may be under way or wait to be given back.
    window: usize,
}

struct Inner<I, D> {
    source: I,
    taken: usize,
    given: usize,
    /// What is under way (`None`) or done, from `given` on; inside, `None` for work that was given up.
    results: VecDeque<Option<Option<D>>>,
    workers: usize,
}

/// Where a worker takes its work from and gives its results to.
pub(super) trait Desk<C, D> {
    /// The next piece of work with its number; where others are far behind and the caller has nothing else to do (`idle`), once there is room for it.
    fn take(&self, idle: bool) -> Option<(usize, C)>;
    /// Gives a result back; `None`: the work was given up.
    fn give(&self, number: usize, result: Option<D>);
    /// Whether to give up.
    fn stops(&self) -> bool;
}

/// A worker that is at work; at its end, also at a panic, the others hear of it.
struct Worker<'q, I, D>(&'q Queue<I, D>);

impl<I, D> Drop for Worker<'_, I, D> {
    fn drop(&mut self) {
        let mut inner = self.0.lock();
        inner.workers -= 1;
        if thread::panicking() {
            self.0.stop.store(true, Ordering::Relaxed);
        }
        drop(inner);
        self.0.room.notify_all();
        self.0.done.notify_all();
    }
}

/// Who collects the results; at the end, also at a panic of who is given them, nothing more is begun: workers that wait for room would wait for ever.
struct Collector<'q, I, D>(&'q Queue<I, D>);

impl<I, D> Drop for Collector<'_, I, D> {
    fn drop(&mut self) {
        self.0.stop();
    }
}

impl<I: Iterator, D> Desk<I::Item, D> for Queue<I, D> {
    fn take(&self, idle: bool) -> Option<(usize, I::Item)> {
        let mut inner = self.lock();
        while inner.taken - inner.given >= self.window && !self.stops() {
            if !idle {
                return None;
            }
            let waited = self.room.wait(inner);
            inner = waited.unwrap_or_else(PoisonError::into_inner);
        }
        if self.stops() {
            return None;
        }
        let next = inner.source.next()?;
        let number = inner.taken;
        inner.taken += 1;
        inner.results.push_back(None);
        Some((number, next))
    }

    fn give(&self, number: usize, result: Option<D>) {
        let mut inner = self.lock();
        let place = number - inner.given;
        if let Some(slot) = inner.results.get_mut(place) {
            *slot = Some(result);
        }
        drop(inner);
        self.done.notify_one();
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl<I, D> Queue<I, D> {
    fn lock(&self) -> MutexGuard<'_, Inner<I, D>> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next result in order, once it is there; `None` when there is none to come, or when it was given up.
    fn collect(&self) -> Option<D> {
        let mut inner = self.lock();
        loop {
            match inner.results.front_mut().map(Option::take) {
                Some(Some(result)) => {
                    inner.results.pop_front();
                    inner.given += 1;
                    self.room.notify_all();
                    return result;
                }
                _ if inner.workers == 0 => return None,
                _ => {
                    let waited = self.done.wait(inner);
                    inner = waited.unwrap_or_else(PoisonError::into_inner);
                }
            }
        }
    }

    fn stop(&self) {
        // Under the lock: a worker that has just looked and not yet begun to wait would not hear of it.
        let inner = self.lock();
        self.stop.store(true, Ordering::Relaxed);
        drop(inner);
        self.room.notify_all();
    }
}

/// Does the work of a source on so many threads, each with at most `beside` pieces under way at once, and hands the results to `deliver` in the order of the
/// source, on the calling thread, until one is given up (`None`) or `deliver` breaks off. `work` takes what there is from its desk.
pub(super) fn share_out<C: Send, D: Send>(
    source: impl Iterator<Item = C> + Send,
    (threads, beside): (usize, usize),
    work: impl Fn(&dyn Desk<C, D>) + Sync,
    mut deliver: impl FnMut(D) -> ControlFlow<()>,
) {
    let window = AHEAD * threads * beside;
    let queue = Queue {
        inner: Mutex::new(Inner {
            source,
            taken: 0,
            given: 0,
            results: VecDeque::with_capacity(window),
            workers: 0,
        }),
        room: Condvar::new(),
        done: Condvar::new(),
        stop: AtomicBool::new(false),
        window,
    };
    let labour = || {
        let _worker = Worker(&queue);
        work(&queue);
    };
    let is_done = thread::scope(|scope| {
        let mut workers = Vec::with_capacity(threads);
        for _ in 0..threads {
            // Counted before it begins, so that nobody takes the first for the last.
            queue.lock().workers += 1;
            match thread::Builder::new().spawn_scoped(scope, labour) {
                Ok(worker) => workers.push(worker),
                Err(_) => queue.lock().workers -= 1,
            }
        }
        if workers.is_empty() {
            return false;
        }
        {
            let collector = Collector(&queue);
            while let Some(result) = collector.0.collect() {
                if deliver(result).is_break() {
                    break;
                }
            }
        }
        for worker in workers {
            if let Err(words) = worker.join() {
                // The source is the caller's: what it said at its end goes on to the caller.
                resume_unwind(words);
            }
        }
        true
    });
    if !is_done {
        // Where the system gives no thread, the calling one does the work.
        work(&Alone {
            queue: &queue,
            deliver: RefCell::new(&mut deliver),
        });
    }
}

/// The desk of the calling thread: what is done is delivered at once.
struct Alone<'q, I, D> {
    queue: &'q Queue<I, D>,
    deliver: RefCell<&'q mut dyn FnMut(D) -> ControlFlow<()>>,
}

impl<I: Iterator, D> Desk<I::Item, D> for Alone<'_, I, D> {
    fn take(&self, idle: bool) -> Option<(usize, I::Item)> {
        self.queue.take(idle)
    }

    fn give(&self, number: usize, result: Option<D>) {
        self.queue.give(number, result);
        let is_done = || {
            let inner = self.queue.lock();
            inner.results.front().is_some_and(Option::is_some)
        };
        while !self.stops() && is_done() {
            let result = self.queue.collect();
            let delivered = result.map(|result| (self.deliver.borrow_mut())(result));
            if delivered.is_none_or(|flow| flow.is_break()) {
                self.queue.stop();
            }
        }
    }

    fn stops(&self) -> bool {
        self.queue.stops()
    }
}
