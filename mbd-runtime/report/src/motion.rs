//! The motion of a run, or of several, on a page: as it plays, and in drawings that stand still for paper and where no script runs.

use super::drawing::Drawing;
use super::html::Report;
use super::mechanism::drawings;
use super::playback::Playback;
use super::views::Run;

/// What shows how a run moves, for a page.
#[derive(Clone, Debug)]
pub struct RecordedMotion {
    playback: Playback,
    pub(super) drawings: Vec<Drawing>,
}

impl RecordedMotion {
    /// That of one run.
    #[must_use]
    pub fn new(run: &Run<'_>) -> Self {
        RecordedMotion {
            playback: Playback::new(run),
            drawings: still(run).collect(),
        }
    }

    /// That of several runs in one drawing that plays, each with its label before its names; those that stand still are one by one. Loads are not shown.
    #[must_use]
    pub fn of_several(runs: &[(&str, Run<'_>)]) -> Self {
        let labelled = runs.iter().flat_map(|(label, run)| {
            let drawings = still(run);
            drawings.map(|drawing| drawing.labelled(label))
        });
        RecordedMotion {
            playback: Playback::of_several(runs),
            drawings: labelled.collect(),
        }
    }

    /// Adds it to a page as a section of its own.
    #[must_use]
    pub fn on(&self, report: Report) -> Report {
        let report = report.section("Motion").playback(self.playback.clone());
        self.drawings.iter().fold(report, Report::drawing)
    }
}

fn still(run: &Run<'_>) -> impl Iterator<Item = Drawing> {
    drawings(run.scene, run.params, run.instants, run.trajectory).into_iter()
}
