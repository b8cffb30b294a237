//! The pictures that answer the paper's figures 3, 4 and 5: riser force over time, point with mass and equilibrium point in one plot.

use super::scene::TestCase;
use super::study::{MIDWAY, Study, StudyRun};
use super::variant::{Confluence, Damping};
use crate::report::{Figure, Series};

/// A figure and the name of its file.
pub struct NamedFigure<'a> {
    /// `figure_3a`, ….
    pub name: &'static str,
    /// The picture.
    pub figure: Figure<'a>,
}

/// All figures of the study.
#[must_use]
pub fn figures(study: &Study) -> Vec<NamedFigure<'_>> {
    use TestCase::{Three, Two};
    let early = [0.0, 2.0];
    let whole = [0.0, 70.0];
    let plots: [(&str, TestCase, Damping, [f64; 2], &str); 7] = [
        (
            "figure_3a",
            Two,
            Damping::On,
            whole,
            "whole run: the curves cannot be told apart",
        ),
        (
            "figure_3b",
            Two,
            Damping::On,
            early,
            "first two seconds: slack is used up after 0.7 s; the point with mass lags a little",
        ),
        (
            "figure_4a",
            Two,
            Damping::Off,
            whole,
            "without damping, whole run",
        ),
        (
            "figure_4b",
            Two,
            Damping::Off,
            early,
            "without damping, first two seconds: the point with mass vibrates between its lines",
        ),
        (
            "figure_4c",
            Two,
            Damping::Off,
            MIDWAY,
            "without damping, midway: the point with mass still vibrates, the equilibrium point does not; undamped bouncing is chaotic, so the slow modes part",
        ),
        (
            "figure_5a",
            Three,
            Damping::On,
            whole,
            "capsule with 1 m/s of horizontal speed, whole run",
        ),
        (
            "figure_5b",
            Three,
            Damping::On,
            MIDWAY,
            "capsule with 1 m/s of horizontal speed, midway",
        ),
    ];
    plots
        .into_iter()
        .map(|(name, case, damping, window, what)| NamedFigure {
            name,
            figure: riser_force(study, case, damping, window, what),
        })
        .collect()
}

fn riser_force<'a>(
    study: &'a Study,
    case: TestCase,
    damping: Damping,
    window: [f64; 2],
    what: &str,
) -> Figure<'a> {
    let node = if damping == Damping::On {
        Confluence::Stepwise
    } else {
        Confluence::Static
    };
    let mut shown = vec![Confluence::Mass(0.1, damping), node];
    if damping == Damping::On && window[1] <= 10.0 {
        shown.push(Confluence::Rate);
    }
    let lines = if damping == Damping::On {
        "damped lines"
    } else {
        "undamped lines"
    };
    let title = format!("Riser force, test case {}, {lines}", case.number());
    let mut figure = Figure::new(title)
        .x("time", "s")
        .y("riser force", "N")
        .window(window[0], window[1]);
    for confluence in shown {
        if let Some(run) = find(study, case, confluence) {
            let name = format!("{confluence}, step {} s", run.step);
            figure = figure.series(Series::new(name, run.flight.times(), run.flight.riser()));
        }
    }
    let caption = format!(
        "Test case {}, {what}. Our scene, with assumed numbers where the paper's are lost.",
        case.number()
    );
    figure.caption(caption)
}

fn find(study: &Study, case: TestCase, confluence: Confluence) -> Option<&StudyRun> {
    study
        .runs
        .iter()
        .find(|run| run.case == case && run.confluence == confluence)
}
