//! Bodies of the next scene that joints hold to the others, in absolute coordinates: they begin where the coordinates of these joints do, as those
//! that a joint of a tree carries.

use mbd_scene::laws::constant;
use mbd_scene::{Formula, Joint, JointStart, Layout, Part, Place, Scene, StartFrom, place};

use super::super::start::misplaced;
use crate::error::StepError;

/// Whether the coordinates of a joint say where its child is, and the declaration says them.
fn says_all(scene: &Scene, layout: &Layout, joint: usize) -> bool {
    let Some(declared) = scene.joints.get(joint) else {
        return false;
    };
    let mut starts = scene.starts.coordinates.iter();
    let said = starts.any(|start| start.joint == joint) || declared.motors().next().is_some();
    let count = declared.law.measured().count();
    let whole = count == declared.law.freedoms() && declared.law.couples().is_empty();
    whole && (said || count == 0) && layout.starts_joined(joint)
}

/// Of bodies that nothing else places those that joints hold to what is placed, or to each other; and these joints.
fn held(scene: &Scene, layout: &Layout, mut nowhere: Vec<usize>) -> (Vec<usize>, Vec<usize>) {
    let (mut found, mut by) = (Vec::new(), Vec::new());
    loop {
        let body_at = |place: Place| match place {
            Place::Body(body, _) => nowhere.iter().position(|own| *own == body),
            _ => None,
        };
        let held_by = |joint: &Joint| match [joint.parent, joint.child].map(body_at) {
            [Some(at), None] | [None, Some(at)] => Some(at),
            _ => None,
        };
        let mut joints = scene.joints.iter().enumerate();
        let next = joints.find_map(|(joint, declared)| {
            let at = held_by(declared)?;
            says_all(scene, layout, joint).then_some((joint, at))
        });
        let Some((joint, at)) = next else {
            return (found, by);
        };
        found.push(nowhere.remove(at));
        by.push(joint);
    }
}

/// Puts the bodies that nothing else places where joints hold them, in a state in the world; which of them these are.
///
/// # Errors
/// [`StepError::Unplaced`] where the joints do not fit to what is placed.
pub fn place_held(
    scene: &Scene,
    layout: &Layout,
    from: StartFrom<'_>,
    nowhere: &[usize],
    state: &mut [f64],
) -> Result<Vec<usize>, StepError> {
    let (bodies, by) = held(scene, layout, nowhere.to_vec());
    if bodies.is_empty() {
        return Ok(bodies);
    }
    let number = |formula: &Option<Formula>| {
        let formula = formula.as_ref();
        formula.map_or(0.0, |formula| constant(scene, from.params, formula))
    };
    let mut given = Vec::new();
    for joint in by {
        let declared = &scene.joints[joint];
        for coordinate in 0..declared.law.measured().count() {
            // A motor says itself where it holds its coordinate.
            if declared.motors().any(|(driven, _)| driven == coordinate) {
                continue;
            }
            let mut starts = scene.starts.coordinates.iter();
            let start = starts.find(|it| (it.joint, it.coordinate) == (joint, coordinate));
            given.push(JointStart {
                joint,
                coordinate,
                value: Some(start.map_or(0.0, |start| number(&start.value))),
                rate: Some(start.map_or(0.0, |start| number(&start.rate))),
                about: start.is_some_and(|start| start.about),
            });
        }
    }
    let is_placed = |part: &Part| bodies.iter().any(|body| *part == Part::Body(*body));
    let own = layout.own_bodies().map(|(body, _)| Part::Body(body));
    let points = (0..layout.points.len()).map(Part::Point);
    let stay: Vec<Part> = own.chain(points).filter(|it| !is_placed(it)).collect();
    let placed = place(scene, layout, from, &given, &stay, state);
    placed.map_err(|error| misplaced(scene, error))?;
    Ok(bodies)
}
