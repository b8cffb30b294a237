//! What happens without end: a line or a stop too stiff for the mass that bounces on it, an event whose action lets it happen again.

/// Switches and actions allowed in one thousandth of a run.
pub(crate) const MOST_SWITCHES: usize = 200;

/// The times of the last switches and actions, to tell chatter.
#[derive(Clone, Debug)]
pub(crate) struct Chatter {
    /// One thousandth of the run [s].
    pub window: f64,
    times: [f64; MOST_SWITCHES],
    next: usize,
}

impl Chatter {
    pub(crate) fn new() -> Self {
        Chatter {
            window: f64::INFINITY,
            times: [f64::NEG_INFINITY; MOST_SWITCHES],
            next: 0,
        }
    }

    /// Forgets all of them: a run that goes back to an earlier time comes to them again.
    pub(crate) fn forget(&mut self) {
        self.times.fill(f64::NEG_INFINITY);
    }

    /// Records a switch or an action; true when [`MOST_SWITCHES`] fell into one window.
    pub(crate) fn sees(&mut self, time: f64) -> bool {
        let Some(slot) = self.times.get_mut(self.next) else {
            return false;
        };
        let oldest = std::mem::replace(slot, time);
        self.next = (self.next + 1) % MOST_SWITCHES;
        // Two hundred of them at one instant are chatter in a run of any length.
        time <= oldest || self.window.is_finite() && time - oldest < self.window
    }
}
