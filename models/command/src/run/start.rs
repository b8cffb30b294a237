//! Whether a run started where it was asked to.

use mbd_campaign::run::RunPlan;
use mbd_runtime::scene::laws::Numbers;
use mbd_runtime::scene::{Scene, plain};
use mbd_runtime::{Generic, Layout, Moved, PassedStop, Simulation};

use super::outcome::{RunOutcome, begun};
use super::phases::Segment;

/// A start that is moved by more than this part of the size of the scene is not the one that was asked for.
const FAR: f64 = 1e-3;
/// Nor is one that is rotated by more [rad].
const ROTATED: f64 = 1e-3;
/// A start beyond a stop by more than this part of the way between the stops of a coordinate, or of a metre or a radian where it has one, is no rest on it.
const BEYOND: f64 = 0.02;
/// What the start changes by less, in SI units, is rounding.
const ROUNDING: f64 = 1e-12;

/// What the start moved most of what the declaration or the settings place, if that is more than rounding.
#[must_use]
pub fn moved<'a>(plan: &RunPlan, outcome: &'a RunOutcome) -> Option<&'a Moved> {
    let told = |moved: &&Moved| {
        let changes = [
            moved.distance,
            moved.angle,
            moved.velocity,
            moved.angular_velocity,
        ];
        plan.placed.contains(&moved.name) && changes.iter().any(|&change| change > ROUNDING)
    };
    outcome.moved.iter().find(told)
}

/// By how much a body or a point was moved, and which.
#[must_use]
pub fn moved_text(moved: &Moved) -> String {
    let changes = [
        (moved.distance, "m"),
        (moved.angle, "rad"),
        (moved.velocity, "m/s"),
        (moved.angular_velocity, "rad/s"),
    ];
    let told = changes.iter().filter(|(change, _)| *change > ROUNDING);
    let told: Vec<String> = told
        .map(|(change, unit)| format!("{} {unit}", plain(*change, 4)))
        .collect();
    format!("{}, `{}`", told.join(", "), moved.name)
}

/// The same as [`warning_of`] for a run that has been made.
#[must_use]
pub fn warning(scene: &Scene, plan: &RunPlan, outcome: &RunOutcome) -> Option<String> {
    let found = (&outcome.moved[..], &outcome.passed_stops[..]);
    told(scene, plan, found, outcome.singular_start)
}

/// One sentence where a body or a point does not go on from where the scene before left it, because joints of its scene hold it elsewhere.
#[must_use]
pub fn warning_of_handover(scene: &Scene, segment: &Segment) -> Option<String> {
    let handover = segment.handover.as_ref()?;
    let least = FAR * size(scene, &segment.plan).max(FAR);
    let far = |moved: &&Moved| {
        let elsewhere = moved.distance > least || moved.angle > ROTATED;
        handover.carried.contains(&moved.name) && elsewhere
    };
    let all: Vec<&Moved> = segment.outcome.moved.iter().filter(far).collect();
    let worst = all.first()?;
    let others = match all.len() {
        1 => String::new(),
        2 => " (and another)".to_owned(),
        n => format!(" (and {} others)", n - 1),
    };
    Some(format!(
        "warning: `{}` does not go on in `{}` where it was: the joints there do not hold at that place, and it jumps by {} m and {:.2}°{others}; \
         let the event happen where they hold, or say in its `map` from what it goes on",
        worst.name,
        scene.name,
        plain(worst.distance, 4),
        worst.angle.to_degrees(),
    ))
}

/// A sentence for each line, spring and joint that was detached and holds in the scene that goes on, and for each coordinate that was locked and moves there,
/// because no event of that scene says otherwise.
#[must_use]
pub fn warnings_of_unkept(scene: &Scene, segment: &Segment) -> Vec<String> {
    let Some(handover) = &segment.handover else {
        return Vec::new();
    };
    let attached = handover.attached.iter().map(|name| {
        format!(
            "warning: `{name}` was detached, and holds in `{}`, where no event detaches or attaches it: if it is to stay detached, leave it out there or give it \
             `at_start: detached`",
            scene.name
        )
    });
    let freed = handover.freed.iter().map(|name| {
        format!(
            "warning: `{name}` was locked, and moves in `{}`, where no event locks or frees it: if it is to stay where it is, give it `at_start: locked` there",
            scene.name
        )
    });
    attached.chain(freed).collect()
}

/// The same as [`warning`] before any run of a plan; `None` also where it cannot start, which is told where it is run.
#[must_use]
pub fn warning_before(scene: &Scene, plan: &RunPlan) -> Option<String> {
    let model = Generic::<f64>::new(scene.clone(), &plan.params).ok()?;
    let mut run = begun(&model, plan).ok()?;
    run.start().ok()?;
    warning_of(&run, plan)
}

/// One sentence where a body that the declaration or the settings place starts somewhere else, and one where the start is singular; `None` where all
/// start where they were asked to, and one motion follows.
#[must_use]
pub fn warning_of(run: &Simulation<f64>, plan: &RunPlan) -> Option<String> {
    let found = (run.start_moved(), run.starts_beyond_stops());
    told(run.model().scene(), plan, found, run.starts_singular())
}

fn told(
    scene: &Scene,
    plan: &RunPlan,
    (moved, passed): (&[Moved], &[PassedStop]),
    singular: bool,
) -> Option<String> {
    let singular = singular.then(|| {
        "warning: the start is a singular position of the joints (bars in one line, say): more than one motion is possible from there, and rounding decides \
         which; begin beside it, `start: 1 deg` of a coordinate, or with a rate"
            .to_owned()
    });
    let all = [
        displaced(scene, plan, moved),
        redirected(plan, moved),
        beyond_stop(passed),
        singular,
    ];
    let all: Vec<String> = all.into_iter().flatten().collect();
    (!all.is_empty()).then(|| all.join("\n"))
}

/// One sentence where a coordinate starts beyond a stop, the one that pushes hardest.
fn beyond_stop(passed: &[PassedStop]) -> Option<String> {
    let far = passed
        .iter()
        .filter(|stop| stop.depth > BEYOND * stop.travel.unwrap_or(1.0));
    let worst = far.max_by(|a, b| a.push.total_cmp(&b.push))?;
    let (coordinate, side) = worst.name.split_once(' ')?;
    let (depth, push) = match worst.is_angle {
        true => (format!("{} deg", plain(worst.depth.to_degrees(), 3)), "N*m"),
        false => (format!("{} m", plain(worst.depth, 3)), "N"),
    };
    Some(format!(
        "warning: `{coordinate}` starts {depth} beyond its {side}, which pushes it back with {} {push} from the first instant on: start it between its stops, \
         or say other `stops`",
        plain(worst.push, 3),
    ))
}

/// One sentence where a body starts somewhere else than it is put.
fn displaced(scene: &Scene, plan: &RunPlan, moved: &[Moved]) -> Option<String> {
    let far = |moved: &&Moved| {
        let distance = moved.distance > FAR * size(scene, plan);
        plan.placed.contains(&moved.name) && (distance || moved.angle > ROTATED)
    };
    let all: Vec<&Moved> = moved.iter().filter(far).collect();
    let worst = all.first()?;
    let others = match all.len() {
        1 => String::new(),
        2 => " (and another body)".to_owned(),
        n => format!(" (and {} others)", n - 1),
    };
    // A point has no attitude, and less than half a hundredth of a degree is none to speak of.
    let rotated = match worst.angle.to_degrees() {
        angle if angle.abs() < 0.005 => String::new(),
        angle => format!(", rotated by {angle:.2}°"),
    };
    let part = scene.part_named(&worst.name);
    let mut starts = scene.starts.parts.iter();
    if starts.any(|start| start.position.is_none() && Some(start.part) == part) {
        return Some(format!(
            "warning: `{}` starts {} m away{rotated}{others} from the origin of the world, where a `start` that says no place puts it: say `start at` with it, or \
             `start` and `start_rate` of its joints instead",
            worst.name,
            plain(worst.distance, 4),
        ));
    }
    Some(format!(
        "warning: `{}` does not start where `start at` or [run.start] puts it: its joints do not hold there, and it starts {} m away{rotated}{others}; \
         give positions and attitudes that fit each other",
        worst.name,
        plain(worst.distance, 4),
    ))
}

/// One sentence where a body or a point starts with another velocity, or angular velocity, than is said.
fn redirected(plan: &RunPlan, moved: &[Moved]) -> Option<String> {
    let fastest = |of: fn(&Moved) -> f64| moved.iter().map(of).fold(0.0, f64::max);
    let another = |said: &[String], change: fn(&Moved) -> f64, set: fn(&Moved) -> f64| {
        let negligible = ROUNDING + FAR * fastest(set);
        let told = moved.iter();
        let told = told.filter(|moved| said.contains(&moved.name) && change(moved) > negligible);
        let worst = told.max_by(|a, b| change(a).total_cmp(&change(b)))?;
        Some((&worst.name, change(worst)))
    };
    let velocity = another(&plan.moving, |it| it.velocity, |it| it.speed);
    let spin = another(
        &plan.turning,
        |it| it.angular_velocity,
        |it| it.angular_speed,
    );
    let (name, what, change, unit) = match (velocity, spin) {
        (Some((name, change)), _) => (name, "velocity", change, "m/s"),
        (None, Some((name, change))) => (name, "angular velocity", change, "rad/s"),
        (None, None) => return None,
    };
    let change = plain(change, 4);
    Some(format!(
        "warning: `{name}` does not start with the {what} that is said of it: its joints do not allow it, and its {what} differs by {change} {unit}; \
         say the rates of its joints instead, such as `start_rate: 1 rad/s`, or velocities and angular velocities that fit each other",
    ))
}

/// The size of a scene [m]: how far its bodies are apart, or a frame from the centre of mass, whichever is more.
fn size(scene: &Scene, plan: &RunPlan) -> f64 {
    let layout = Layout::new(scene);
    let extent = |axis: usize| {
        let places = layout
            .own_bodies()
            .map(|(_, slots)| plan.state.get(slots.q + axis));
        let places: Vec<f64> = places.flatten().copied().collect();
        let high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let low = places.iter().copied().fold(f64::INFINITY, f64::min);
        high - low
    };
    let between = (0..layout.directions.translations().len()).map(extent);
    let numbers = Numbers::<f64>::new(scene, &plan.params);
    let frames = numbers.bodies.iter().flat_map(|body| &body.frames);
    let arms = frames.map(|frame| frame.position.norm());
    between.chain(arms).fold(0.0, f64::max)
}
