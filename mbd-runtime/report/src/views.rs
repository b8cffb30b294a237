//! Everything that shows a run: the moving drawing, the drawings that stand still, the figures.

use std::io;
use std::path::Path;

use mbd_runtime::Trajectory;
use mbd_runtime::scene::Scene;

use super::drawing::Drawing;
use super::files;
use super::html::Report;
use super::mechanism::drawings;
use super::playback::Playback;
use super::plots::{Group, groups};

/// What shows a run, for a page and as files.
#[derive(Clone, Debug)]
pub struct Views<'a> {
    playback: Playback,
    drawings: Vec<Drawing>,
    groups: Vec<Group<'a>>,
    times: &'a [f64],
}

impl<'a> Views<'a> {
    /// Those of a run of a scene with these params (declaration order, SI). `instants`: when the mechanism is drawn [s], evenly over the run if there
    /// are none; `figures`: titles, and the columns of the history each shows.
    #[must_use]
    pub fn new(
        scene: &Scene,
        params: &[f64],
        trajectory: &'a Trajectory,
        instants: &[f64],
        figures: &[(String, Vec<String>)],
    ) -> Self {
        Views {
            playback: Playback::new(scene, params, trajectory),
            drawings: drawings(scene, params, instants, trajectory),
            groups: groups(scene, figures, trajectory),
            times: trajectory.times(),
        }
    }

    /// A page with the mechanism as it moves.
    #[must_use]
    pub fn with_motion(&self, report: Report) -> Report {
        let report = report.section("Motion").playback(self.playback.clone());
        self.drawings.iter().fold(report, Report::drawing)
    }

    /// A page with the figures.
    #[must_use]
    pub fn with_histories(&self, report: Report) -> Report {
        let report = report.section("Histories");
        let figures = self.groups.iter().map(|group| group.figure(self.times));
        figures.fold(report, |report, figure| report.figure(&figure))
    }

    /// Writes every picture as a file of its own.
    ///
    /// # Errors
    /// A file cannot be written whole; the error names it.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        for (index, drawing) in self.drawings.iter().enumerate() {
            let view = if index == 0 { "" } else { "_side" };
            let file = folder.join(format!("mechanism{view}.svg"));
            files::write_text(&file, &drawing.svg())?;
        }
        for group in &self.groups {
            let figure = group.figure(self.times);
            files::write_text(&folder.join(group.file()), &figure.svg())?;
        }
        Ok(())
    }
}
