//! The pictures that pages of this repository show: of the scenes as they are, drawn as they are drawn today, and each shown somewhere.
//!
//! `UPDATE_GOLDEN=1 cargo test -p mbd-command pictures` writes those of the ready scenes and of the main job, and the style of the others: the two of
//! flights are written by the commands of `docs/campaigns.md`.

use std::collections::BTreeSet;

use mbd_report::Figure;
use models::parachute::comparison::{grid, options};
use models::parachute::figures::figures;
use models::parachute::scene::TestCase;
use models::parachute::stability::StabilityLimit;
use models::parachute::study::{MIDWAY, Study, StudyRun};
use models::parachute::variant::{Confluence, Damping, FlightPlan, fly};

use super::*;

/// Ready scenes whose `mechanism.svg` is shown.
const SCENES: [&str; 8] = [
    "double_pendulum",
    "four_bar",
    "heavy_top",
    "hinged_capsule",
    "n_four_bar",
    "porch_swing",
    "slider_crank",
    "spatial_loop",
];

/// Pixels by which numbers of a picture may differ, since other machines round sines otherwise.
const NEAR: f64 = 0.5;

fn root() -> PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn pictures() -> Vec<PathBuf> {
    let folder = root().join("models/pictures");
    let files = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    files
}

fn is_updated() -> bool {
    std::env::var_os("UPDATE_GOLDEN").is_some()
}

/// The style of a picture, between its tags.
fn style(svg: &str) -> &str {
    let (_, rest) = svg.split_once("<style>").unwrap();
    rest.split_once("</style>").unwrap().0
}

/// The words of a picture and its numbers.
fn parts(svg: &str) -> (Vec<&str>, Vec<f64>) {
    let is_number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let numbers = svg.split(|c| !is_number(c));
    let numbers = numbers.filter_map(|number| number.parse().ok());
    (
        svg.split(is_number)
            .filter(|word| !word.is_empty())
            .collect(),
        numbers.collect(),
    )
}

/// Compares a picture with what is drawn today.
fn compare(name: &str, drawn: &str) {
    let file = root().join(format!("models/pictures/{name}.svg"));
    if is_updated() {
        std::fs::write(&file, drawn).unwrap();
        return;
    }
    let shown = std::fs::read_to_string(&file).unwrap();
    let ((drawn, now), (shown, then)) = (parts(drawn), parts(&shown));
    assert!(drawn == shown && now.len() == then.len(), "{name} is old");
    let apart = now.iter().zip(&then).map(|(now, then)| (now - then).abs());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart <= NEAR, "{name} is old: {apart} px");
}

#[test]
fn the_pictures_of_ready_scenes_are_those_of_their_runs() {
    for name in SCENES {
        let folder = Folder::new(&format!("picture_{name}"));
        let out = folder.0.display().to_string();
        run(&["run", name, "--no-estimate", "--out", &out]).unwrap();
        let drawn = std::fs::read_to_string(folder.0.join("mechanism.svg")).unwrap();
        compare(name, &drawn);
    }
}

/// Figure 4c of the main job, of the two flights that it shows, as far as it shows them.
#[test]
fn the_picture_of_the_extra_mode_is_that_of_the_main_job() {
    // Up to the first row beyond the window, where its curves lead.
    let inside = grid().iter().take_while(|t| **t <= MIDWAY[1]).count();
    let times = &grid()[..=inside];
    let until = times[inside];
    let flown = |confluence: Confluence, step: f64| {
        let plan = FlightPlan::new(TestCase::Two, confluence, options(step, false), until);
        let flight = fly(&plan.sampled(times)).unwrap();
        StudyRun {
            case: TestCase::Two,
            confluence,
            step,
            located: false,
            flight,
            error: [f64::NAN; 2],
            steady: f64::NAN,
            tone: None,
            limit: StabilityLimit {
                taut: f64::NAN,
                whole: None,
            },
        }
    };
    let study = Study {
        runs: vec![
            flown(Confluence::Mass(0.1, Damping::Off), 1e-4),
            flown(Confluence::Static, 0.01),
        ],
        races: Vec::new(),
        moving: Vec::new(),
        weight: f64::NAN,
    };
    let figures = figures(&study);
    let figure = figures.iter().find(|named| named.name == "figure_4c");
    compare("extra_mode", &figure.unwrap().figure.svg());
}

#[test]
fn every_picture_has_the_style_of_today() {
    let today = Figure::new("").svg();
    for file in pictures() {
        let picture = std::fs::read_to_string(&file).unwrap();
        let name = file.file_stem().unwrap().to_string_lossy();
        if is_updated() {
            if SCENES.contains(&&*name) || name == "extra_mode" {
                continue;
            }
            let picture = picture.replace(style(&picture), style(&today));
            std::fs::write(&file, picture).unwrap();
            continue;
        }
        assert_eq!(style(&picture), style(&today), "{name}");
    }
}

#[test]
fn every_picture_is_shown_by_a_page() {
    let docs = std::fs::read_dir(root().join("docs")).unwrap();
    let mut pages: Vec<PathBuf> = docs.map(|page| page.unwrap().path()).collect();
    pages.extend(["README.md", "models/README.md"].map(|page| root().join(page)));
    let texts = pages
        .iter()
        .map(|page| std::fs::read_to_string(page).unwrap());
    let texts = texts.collect::<String>();
    let names = pictures().into_iter().map(|file| {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        format!("pictures/{name})")
    });
    let unseen: BTreeSet<String> = names.filter(|name| !texts.contains(name)).collect();
    assert!(unseen.is_empty(), "{unseen:?}");
}
