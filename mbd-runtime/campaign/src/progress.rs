//! How far a long job is: one line on a terminal, redrawn; otherwise a plain line every ten seconds.

use std::io::{IsTerminal, Write, stderr};
use std::time::{Duration, Instant};

/// Shows on the standard error stream how far a job is. Nothing else of this crate writes to a stream by itself.
#[derive(Debug)]
pub struct ProgressLine {
    mode: ProgressMode,
    started: Instant,
    shown: Option<Instant>,
    drawn: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ProgressMode {
    Silent,
    Terminal,
    Plain,
}

impl ProgressLine {
    /// A line on a terminal, plain lines elsewhere.
    #[must_use]
    pub fn new() -> Self {
        ProgressLine::with(if stderr().is_terminal() {
            ProgressMode::Terminal
        } else {
            ProgressMode::Plain
        })
    }

    /// Shows nothing.
    #[must_use]
    pub fn silent() -> Self {
        ProgressLine::with(ProgressMode::Silent)
    }

    fn with(mode: ProgressMode) -> Self {
        ProgressLine {
            mode,
            started: Instant::now(),
            shown: None,
            drawn: false,
        }
    }

    /// Says that `share` (0 … 1) of the job is done and what is being worked on. Cheap: may be called at every step of a run.
    pub fn show(&mut self, share: f64, what: &str) {
        let pause = match self.mode {
            ProgressMode::Silent => return,
            ProgressMode::Terminal => Duration::from_millis(100),
            ProgressMode::Plain => Duration::from_secs(10),
        };
        let since = self.shown.unwrap_or(self.started).elapsed();
        // On a terminal the first line appears at once, elsewhere only long jobs speak.
        let first = self.shown.is_none() && self.mode == ProgressMode::Terminal;
        if since < pause && !first {
            return;
        }
        self.shown = Some(Instant::now());
        let line = line(share, what, self.started.elapsed());
        let mut stream = stderr();
        // A stream that cannot be written to is no reason to stop the job.
        let _ = if self.mode == ProgressMode::Terminal {
            self.drawn = true;
            write!(stream, "\r\x1b[2K{line}").and_then(|()| stream.flush())
        } else {
            writeln!(stream, "{line}")
        };
    }

    /// Says a sentence on a line of its own.
    pub fn note(&mut self, text: &str) {
        if self.mode != ProgressMode::Silent {
            self.clear();
            let _ = writeln!(stderr(), "{text}");
        }
    }

    /// Clears the line, so that other text can follow.
    pub fn clear(&mut self) {
        if self.drawn {
            let mut stream = stderr();
            let _ = write!(stream, "\r\x1b[2K").and_then(|()| stream.flush());
            self.drawn = false;
        }
    }
}

impl Default for ProgressLine {
    fn default() -> Self {
        ProgressLine::new()
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.clear();
    }
}

/// `[######····]  60 %  case 2, rate  4 s left`
fn line(share: f64, what: &str, elapsed: Duration) -> String {
    const CELLS: usize = 20;
    let share = if share.is_finite() {
        share.clamp(0.0, 1.0)
    } else {
        0.0
    };
    let full = (share * CELLS as f64).floor() as usize;
    let bar = "#".repeat(full) + &"·".repeat(CELLS - full);
    let left = if share > 0.02 {
        let seconds = elapsed.as_secs_f64() * (1.0 - share) / share;
        format!("  {seconds:.0} s left")
    } else {
        String::new()
    };
    format!("[{bar}] {:3.0} %  {what}{left}", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_tells_the_share_and_the_time_left() {
        let half = line(0.5, "case 2", Duration::from_secs(4));
        assert_eq!(half, "[##########··········]  50 %  case 2  4 s left");
        assert!(line(f64::NAN, "x", Duration::ZERO).contains("  0 %"));
        assert!(line(7.0, "x", Duration::ZERO).contains("100 %"));
    }
}
