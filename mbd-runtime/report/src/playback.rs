//! What a page needs to show a run as a moving drawing: the things of the scene, and where they are at the rows of the history.

use super::drawn::Drawn;
use super::film::Film;
use super::loads::loads;
use super::stage::{RecordedScene, Track};
use super::thin::motion_rows;
use super::views::Run;

/// The motions of a page are thinned to about this many bytes, before they become text.
const BYTES: usize = 1_500_000;
/// No history needs more rows than this to be watched.
const ROWS: usize = 20_000;

/// A run as a moving drawing, for [`Report::playback`](crate::Report::playback).
#[derive(Clone, Debug)]
pub struct Playback {
    pub(super) drawn: Drawn,
    pub(super) says: Vec<String>,
}

impl Playback {
    /// A run of a scene. What the history does not hold is not shown, and the page says so.
    #[must_use]
    pub fn new(run: &Run<'_>) -> Self {
        let stage = RecordedScene::new(run.scene, run.params, run.trajectory);
        let rows = rows(&stage);
        let acting = loads((run.scene, run.params), run.inputs, (run.trajectory, &rows));
        let film = Film::of_rows(&stage, &rows);
        let mut drawn = film.drawn();
        drawn
            .arrows
            .extend(acting.shown.iter().filter_map(|shown| film.load(shown)));
        let mut says = says(&stage, &rows);
        says.extend(acting.says);
        Playback { says, drawn }
    }

    /// Several runs in one drawing, each with its label before its names and drawn while it lasts; at the times of the one that lasts longest, and
    /// where that does not run at those of the others. Loads are not shown.
    #[must_use]
    pub fn of_several(runs: &[(&str, Run<'_>)]) -> Self {
        let stages: Vec<(&str, RecordedScene<'_>)> = runs
            .iter()
            .map(|(label, run)| {
                (
                    *label,
                    RecordedScene::new(run.scene, run.params, run.trajectory),
                )
            })
            .collect();
        let ends = |stage: &RecordedScene<'_>| {
            let times = stage.trajectory.times();
            Some([*times.first()?, *times.last()?])
        };
        let times = common_times(&stages, ends);
        let mut says = Vec::new();
        let mut drawn: Option<Drawn> = None;
        for (label, stage) in &stages {
            let film = Film::at_times(stage, &times).drawn().labelled(label);
            match &mut drawn {
                Some(drawn) => drawn.append(film),
                none => *none = Some(film),
            }
            if let (Some([first, last]), [begin, .., end]) = (ends(stage), times.as_slice())
                && (first > *begin || last < *end)
            {
                // Ends that were located have more digits than a reader needs.
                let [first, last] = [first, last].map(|time| (time * 1e6).round() / 1e6);
                says.push(format!(
                    "{label} is drawn from {first} s to {last} s, while it runs."
                ));
            }
        }
        Playback {
            says,
            drawn: drawn.unwrap_or_default(),
        }
    }
}

/// The times at which several runs are drawn.
fn common_times(
    stages: &[(&str, RecordedScene<'_>)],
    ends: impl Fn(&RecordedScene<'_>) -> Option<[f64; 2]>,
) -> Vec<f64> {
    let mut runs: Vec<(&RecordedScene<'_>, [f64; 2])> = stages
        .iter()
        .filter_map(|(_, stage)| Some((stage, ends(stage)?)))
        .collect();
    // The first of those that last longest.
    runs.sort_by(|(_, a), (_, b)| (b[1] - b[0]).total_cmp(&(a[1] - a[0])));
    let mut times: Vec<f64> = Vec::new();
    let mut drawn: Vec<[f64; 2]> = Vec::new();
    for (stage, span) in runs {
        let own = stage.trajectory.times();
        let own = rows(stage).into_iter().filter_map(|row| own.get(row));
        let free = |time: &&f64| !drawn.iter().any(|[low, high]| (low..=high).contains(time));
        times.extend(own.filter(free));
        drawn.push(span);
    }
    times.sort_by(f64::total_cmp);
    times
}

/// The rows that are shown.
pub(super) fn rows(stage: &RecordedScene<'_>) -> Vec<usize> {
    let scene = stage.scene;
    let tracks = stage.bodies.iter().chain(&stage.points).flatten();
    let lines = scene.lines.iter();
    let tensions = lines.filter_map(|line| stage.column(&line.name, "tension"));
    let signals: Vec<&[f64]> = tracks.flat_map(Track::columns).chain(tensions).collect();
    let moving = scene.world_frames.iter().filter(|frame| frame.moves(scene));
    let a_row = 4
        + 20 * scene.bodies.len()
        + 12 * (scene.points.len() + moving.count())
        + 5 * scene.lines.len()
        + 24 * scene.joints.len();
    motion_rows(
        stage.trajectory.times(),
        &signals,
        (BYTES / a_row).clamp(2, ROWS),
    )
}

/// What is shown of the run, and what is not.
fn says(stage: &RecordedScene<'_>, rows: &[usize]) -> Vec<String> {
    let times = stage.trajectory.times();
    let mut says = Vec::new();
    match (times, rows.len()) {
        ([], _) => says.push("The history has no rows: nothing is shown.".to_string()),
        ([first, .., last], shown) if last > first && shown < times.len() => says.push(format!(
            "{shown} of {} rows are shown, those among them where the motion bends most; the motion between two rows is drawn straight.",
            times.len()
        )),
        ([first, .., last], _) if last > first => {}
        ([first, ..], _) => says.push(format!(
            "The history is one instant, {first} s: it does not move."
        )),
    }
    let lost = |names: Vec<&str>| match names.as_slice() {
        [] => None,
        [one] => Some(format!("`{one}`")),
        [one, others @ ..] => Some(format!("`{one}` and {} others", others.len())),
    };
    let scene = stage.scene;
    let bodies = scene.bodies.iter().zip(&stage.bodies);
    let bodies = bodies.filter(|(_, track)| track.is_none());
    let points = scene.points.iter().zip(&stage.points);
    let points = points.filter(|(_, track)| track.is_none());
    let absent = bodies.map(|(body, _)| body.name.as_str());
    let absent = absent.chain(points.map(|(point, _)| point.name.as_str()));
    if let (Some(names), false) = (lost(absent.collect()), times.is_empty()) {
        says.push(format!(
            "Not shown: {names}, whose motion the history does not hold; record it with `Content::ALL`."
        ));
    }
    let tracks = stage.bodies.iter().chain(&stage.points).flatten();
    let gaps = |track: &Track<'_>| {
        let mut columns = track.columns();
        columns.any(|column| column.iter().any(|x| !x.is_finite()))
    };
    if tracks.into_iter().any(gaps) {
        says.push(
            "The history has gaps: where a number is missing, what hangs on it is not drawn."
                .to_string(),
        );
    }
    says
}
