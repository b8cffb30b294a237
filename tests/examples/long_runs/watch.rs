//! Ends a run that hangs, and says where.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

/// An input on which nothing happens for so long never ends.
const ENDLESS: Duration = Duration::from_secs(300);

/// Looks after a run, which tells it what comes next.
pub struct Watch(Arc<AtomicU64>);

impl Watch {
    /// Begins to look.
    pub fn begin() -> Self {
        let now = Arc::new(AtomicU64::new(0));
        let seen = Arc::clone(&now);
        thread::spawn(move || {
            let mut last = u64::MAX;
            loop {
                let number = seen.load(Ordering::Relaxed);
                if number == last {
                    println!("number {number} does not end");
                    std::process::exit(1);
                }
                last = number;
                thread::sleep(ENDLESS);
            }
        });
        Watch(now)
    }

    /// The number of the input that comes now.
    pub fn at(&self, number: u64) {
        self.0.store(number, Ordering::Relaxed);
    }
}
