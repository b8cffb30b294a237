//! Everything that shows a run: the moving drawing, the drawings that stand still, the figures.

use std::io;
use std::path::Path;

use mbd_runtime::Trajectory;
use mbd_runtime::scene::Scene;

use super::files::{self, FileNames};
use super::html::Report;
use super::motion::RecordedMotion;
use super::plots::{PlotGroup, groups};

/// A run that is shown.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// What was run.
    pub scene: &'a Scene,
    /// Its params, in declaration order [SI].
    pub params: &'a [f64],
    /// What the caller held all the time, if that is known: [`Layout::ni`](mbd_runtime::Layout) numbers.
    pub inputs: Option<&'a [f64]>,
    /// What came out.
    pub trajectory: &'a Trajectory,
    /// When the mechanism is drawn [s]; empty: evenly over the run.
    pub instants: &'a [f64],
    /// Titles of figures, and the columns of the history each shows; what is in none of them has its own.
    pub figures: &'a [(String, Vec<String>)],
}

impl<'a> Run<'a> {
    /// A run of a scene with these params, of which nothing more is said.
    #[must_use]
    pub fn new(scene: &'a Scene, params: &'a [f64], trajectory: &'a Trajectory) -> Self {
        Run {
            scene,
            params,
            inputs: None,
            trajectory,
            instants: &[],
            figures: &[],
        }
    }
}

/// What shows a run, for a page and as files.
#[derive(Clone, Debug)]
pub struct Views<'a> {
    motion: RecordedMotion,
    groups: Vec<PlotGroup<'a>>,
    times: &'a [f64],
}

impl<'a> Views<'a> {
    /// Those of a run.
    #[must_use]
    pub fn new(run: &Run<'a>) -> Self {
        Views {
            motion: RecordedMotion::new(run),
            groups: groups(run.scene, run.figures, run.trajectory),
            times: run.trajectory.times(),
        }
    }

    /// A page with the mechanism as it moves.
    #[must_use]
    pub fn with_motion(&self, report: Report) -> Report {
        self.motion.on(report)
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
        let mut names = FileNames::default();
        let mut file = |title: &str| folder.join(names.next(title, "svg"));
        for (index, drawing) in self.motion.drawings.iter().enumerate() {
            let view = if index == 0 { "" } else { "_side" };
            let file = file(&format!("mechanism{view}"));
            files::write_text(&file, &drawing.svg())?;
        }
        for group in &self.groups {
            let figure = group.figure(self.times);
            files::write_text(&file(&group.name), &figure.svg())?;
        }
        Ok(())
    }
}
