//! The start that a declaration says: bodies and points where they are put, the rest by joint coordinates.

use nalgebra::{Matrix3, Vector3};

use crate::evaluate::{Scratch, driven_coordinates, evaluate};
use crate::laws::body::attitude_of;
use crate::laws::line::DETACHED;
use crate::laws::turns::next_to;
use crate::laws::{Numbers, constant};
use crate::placement::{
    FREE, by_bodies, flies_from_world, followers, place_flying, place_near, touched,
};
use crate::tree::Absolute;
use crate::{
    Arguments, At, Formula, Joint, JointStart, Layout, Part, Place, PlacementError,
    PlacementReport, Quantity, Scene, Triple,
};

/// A start that is said to these digits says the same as a motor [m or rad, and per second].
const SAID: f64 = 1e-5;

/// What a start is placed from.
#[derive(Clone, Copy, Debug)]
pub struct StartFrom<'a> {
    /// The live parameters [SI].
    pub params: &'a [f64],
    /// When [s].
    pub time: f64,
    /// Inputs, in the order of [`Layout::inputs`] [SI]; `None`: their defaults.
    pub inputs: Option<&'a [f64]>,
}

impl<'a> StartFrom<'a> {
    /// Params at a time, with the defaults of the inputs.
    #[must_use]
    pub fn new(params: &'a [f64], time: f64) -> Self {
        StartFrom {
            params,
            time,
            inputs: None,
        }
    }

    /// The same with inputs.
    #[must_use]
    pub fn with_inputs(self, inputs: &'a [f64]) -> Self {
        StartFrom {
            inputs: Some(inputs),
            ..self
        }
    }
}

impl Arguments<f64> {
    /// A state before anything has run: what is detached at the start, nodes and their lines not solved.
    pub(crate) fn before_a_run(
        scene: &Scene,
        layout: &Layout,
        from: StartFrom<'_>,
        state: &[f64],
    ) -> Self {
        let hold = |detached| if detached { DETACHED } else { 0.0 };
        Arguments {
            time: from.time,
            state: state.to_vec(),
            nodes: vec![0.0; 3 * layout.nodes.len()],
            effective: vec![0.0; layout.effective_numbers],
            // What locks hold is not said: that is where their coordinates are.
            hold: (layout.start_detached().map(hold))
                .take(layout.holds() - layout.locks)
                .collect(),
            inputs: (from.inputs.filter(|inputs| inputs.len() == layout.ni))
                .map_or_else(|| layout.default_inputs(scene), <[f64]>::to_vec),
            ..Arguments::default()
        }
    }
}

/// Writes the declared starts of bodies and points into a state, behind the places of bodies that fly from frames of the world; returns which have a
/// declared start. In relative coordinates the others hang from them with joint coordinates of zero, or as their motors have them.
pub fn declared_parts(
    scene: &Scene,
    layout: &Layout,
    from: StartFrom<'_>,
    state: &mut [f64],
) -> Vec<Part> {
    let parts: Vec<Part> = scene.starts.parts.iter().map(|start| start.part).collect();
    if layout.tree.is_some() {
        let flies = |joint: &Joint| flies_from_world(joint).is_some();
        let said = !parts.is_empty() || scene.joints.iter().any(flies);
        if said && state.len() == layout.nx() {
            let absolute = Absolute::of(scene);
            let (declared, own) = (&absolute.scene, &absolute.layout);
            let mut placed = absolute.state((scene, layout), from, state);
            declared_parts(declared, own, from, &mut placed);
            let mut tried = placed.clone();
            // What does not fit is told where the coordinates that are given, too, are placed.
            if place_near(declared, own, from, (&[], &[]), &parts, &mut tried).is_ok() {
                placed = tried;
            }
            absolute.relative((scene, layout), &placed, from, state);
        }
        return parts;
    }
    place_flying(scene, layout, from, state);
    write_starts(scene, layout, from, state);
    parts
}

/// Writes what the declaration says itself of where bodies and points start, in absolute coordinates.
fn write_starts(scene: &Scene, layout: &Layout, from: StartFrom<'_>, state: &mut [f64]) {
    let directions = layout.directions;
    let of = |formula: &Formula| constant(scene, from.params, formula);
    let vector = |triple: &Triple| Vector3::from(triple.each_ref().map(of));
    for start in &scene.starts.parts {
        let slots = layout.own_slots(start.part);
        let Some(slots) = slots else { continue };
        let v = layout.nq + slots.v;
        if let Some(position) = &start.position {
            directions.write_linear(state, slots.q, &vector(position));
        }
        if let Some(velocity) = &start.velocity {
            directions.write_linear(state, v, &vector(velocity));
        }
        if let Some(rows) = &start.rotation {
            let rows = rows.each_ref().map(|row| vector(row).transpose());
            let at = slots.q + directions.translations().len();
            let axes = Matrix3::from_rows(&rows);
            let attitude = attitude_of(&axes, directions);
            for (slot, value) in state.iter_mut().skip(at).zip(attitude) {
                *slot = value;
            }
        }
        if let Some(omega) = &start.angular_velocity {
            directions.write_angular(state, v, &vector(omega));
        }
    }
}

/// In relative coordinates the same scene in absolute ones, with a state in these: as it is, and as the declared starts of bodies and points would
/// have it; `None` where bodies have slots of their own or none has a declared start.
#[must_use]
pub fn declared_beside(
    scene: &Scene,
    layout: &Layout,
    from: StartFrom<'_>,
    state: &[f64],
) -> Option<(Scene, Layout, [Vec<f64>; 2])> {
    if layout.tree.is_none() || scene.starts.parts.is_empty() || state.len() != layout.nx() {
        return None;
    }
    let absolute = Absolute::of(scene);
    let here = absolute.state((scene, layout), from, state);
    let mut declared = here.clone();
    write_starts(&absolute.scene, &absolute.layout, from, &mut declared);
    Some((absolute.scene, absolute.layout, [here, declared]))
}

/// Puts bodies of a scene in relative coordinates where they are known: per body its numbers as in absolute coordinates (position, attitude, velocity,
/// angular velocity), in the world, or `None`. A joint of the tree whose child is not known keeps the coordinates it has in the state. What the
/// joints of the tree forbid is taken out: of velocities by the impulses of these joints. In absolute coordinates the bodies have slots of their own, and this does nothing.
pub fn place_bodies(
    scene: &Scene,
    layout: &Layout,
    from: StartFrom<'_>,
    known: &[Option<Vec<f64>>],
    state: &mut [f64],
) {
    if layout.tree.is_none() || state.len() != layout.nx() {
        return;
    }
    let before = state.to_vec();
    let absolute = Absolute::of(scene);
    let mut placed = absolute.state((scene, layout), from, state);
    let coordinates = layout.directions.coordinates();
    for (body, slots) in absolute.layout.own_bodies() {
        let Some(numbers) = known.get(body).and_then(Option::as_ref) else {
            continue;
        };
        let (q, v) = numbers.split_at(coordinates.min(numbers.len()));
        for (at, part) in [(slots.q, q), (absolute.layout.nq + slots.v, v)] {
            let places = placed.iter_mut().skip(at);
            places.zip(part).for_each(|(slot, number)| *slot = *number);
        }
    }
    absolute.relative((scene, layout), &placed, from, state);
    for (_, link) in layout.joint_links() {
        if known.get(link.body).is_none_or(Option::is_none) {
            let v = layout.nq + link.slots.v;
            let own = [
                link.slots.q..link.slots.q + link.coordinates,
                v..v + link.speeds,
            ];
            for place in own.into_iter().flatten() {
                state[place] = before[place];
            }
        }
    }
    let said = |body: usize| known.get(body).is_some_and(Option::is_some);
    absolute.meet((scene, layout), (&placed, &said), from, state);
}

/// [`place`](crate::place) with the starts that the scene declares for the coordinates that are not given. Where these do not fit together, the given
/// ones hold, and those declared of the same mechanism are where the search for the others begins; which of them gave way is told with those that are
/// about a value. `fixed` stay where the state has them, as do the bodies and points with
/// a declared start that `state` has already ([`declared_parts`]), unless a given coordinate says otherwise.
///
/// # Errors
/// As [`place`](crate::place).
pub fn place_declared(
    scene: &Scene,
    layout: &Layout,
    from: StartFrom<'_>,
    given: &[JointStart],
    fixed: &[Part],
    state: &mut [f64],
) -> Result<PlacementReport, PlacementError> {
    if layout.tree.is_some() {
        return place_along_tree((scene, layout), from, given, fixed, state);
    }
    agree_with_motors((scene, layout), from, given, state)?;
    let mut all = given.to_vec();
    let mut others = Vec::new();
    for start in declared_coordinates(scene, from.params) {
        let same = |known: &&mut JointStart| {
            (known.joint, known.coordinate) == (start.joint, start.coordinate)
        };
        match all.iter_mut().find(same) {
            Some(known) => {
                if known.value.is_none() {
                    (known.value, known.about) = (start.value, start.about);
                }
                known.rate = known.rate.or(start.rate);
            }
            None => others.push(start),
        }
    }
    let overridden = !given.is_empty() || !fixed.is_empty();
    let own: Vec<JointStart> = all.clone();
    all.extend(others.iter().copied());
    let parts = scene.starts.parts.iter().map(|start| start.part);
    let mut stay = fixed.to_vec();
    stay.extend(parts.filter(|part| !fixed.contains(part)));
    let before = state.to_vec();
    match place_near(scene, layout, from, (&all, &[]), &stay, state) {
        Err(_) if overridden => {
            state.copy_from_slice(&before);
            // What is declared of mechanisms that nothing is given of holds as ever.
            let touched = touched(layout, given, fixed);
            let gives_way = |start: &JointStart| {
                let mut ends = layout.joints[start.joint].ends.iter().flatten();
                ends.any(|end| touched.contains(end))
            };
            let (near, hold): (Vec<JointStart>, Vec<JointStart>) =
                others.into_iter().partition(gives_way);
            let said = [own, hold].concat();
            stay.retain(|part| fixed.contains(part) || !touched.contains(part));
            place_near(scene, layout, from, (&said, &near), &stay, state)
        }
        result => result,
    }
}

/// What is given of coordinates that motors hold says where these hold them, up to full turns. What a motor is told by inputs is not known yet.
///
/// # Errors
/// The first that says something else.
fn agree_with_motors(
    (scene, layout): (&Scene, &Layout),
    from: StartFrom<'_>,
    given: &[JointStart],
    state: &[f64],
) -> Result<(), PlacementError> {
    let follows_input = |start: &JointStart| {
        let joint = scene.joints.get(start.joint);
        let mut motors = joint.into_iter().flat_map(Joint::motors);
        motors.any(|(coordinate, course)| {
            coordinate == start.coordinate && scene.starts_by_inputs(course)
        })
    };
    if given.is_empty() || state.len() != layout.nx() {
        return Ok(());
    }
    let here = Arguments::before_a_run(scene, layout, from, state);
    let numbers = Numbers::new(scene, from.params);
    let scratch = &mut Scratch::new(layout);
    for driven in driven_coordinates(scene, layout, &numbers, &here.at(), scratch) {
        let (joint, coordinate) = (driven.joint, driven.coordinate);
        let mut given = given.iter();
        let same = |start: &&JointStart| (start.joint, start.coordinate) == (joint, coordinate);
        let Some(start) = given.find(same).filter(|_| !follows_input(&driven)) else {
            continue;
        };
        let held = [driven.value, driven.rate].map(Option::unwrap_or_default);
        let found = scene.coordinate(joint, coordinate);
        let is_angle = found.is_some_and(|(_, coordinate)| coordinate.is_angle());
        let elsewhere = start.value.filter(|_| !start.about).is_some_and(|said| {
            let said = match is_angle {
                true => next_to(said, held[0]),
                false => said,
            };
            (said - held[0]).abs() > SAID
        });
        if elsewhere || start.rate.is_some_and(|said| (said - held[1]).abs() > SAID) {
            return Err(PlacementError::Driven {
                joint,
                coordinate,
                held,
            });
        }
    }
    Ok(())
}

/// [`place_declared`] in relative coordinates: bodies are placed as in absolute ones; of joints of the tree the coordinates hold that are given or
/// declared, turns that an angle counts among them.
fn place_along_tree(
    (scene, layout): (&Scene, &Layout),
    from: StartFrom<'_>,
    given: &[JointStart],
    fixed: &[Part],
    state: &mut [f64],
) -> Result<PlacementReport, PlacementError> {
    let motors = scene
        .joints
        .iter()
        .any(|joint| joint.motors().next().is_some());
    let flies = |joint: &crate::Joint| {
        matches!(joint.parent, Place::Body(..)) && joint.law.freedoms() == FREE
    };
    let flying = scene.joints.iter().any(flies);
    // What rows hold, on a frame of the world that moves, say, has no coordinate of the tree that is zero.
    let rows = (0..scene.joints.len()).any(|joint| layout.starts_joined(joint));
    let nothing = given.is_empty() && scene.starts.coordinates.is_empty();
    let nothing = nothing && !(motors || flying || rows);
    if nothing || state.len() != layout.nx() {
        return Ok(PlacementReport::default());
    }
    let absolute = Absolute::of(scene);
    let mut placed = absolute.state((scene, layout), from, state);
    let assembly = place_declared(
        &absolute.scene,
        &absolute.layout,
        from,
        given,
        fixed,
        &mut placed,
    )?;
    absolute.relative((scene, layout), &placed, from, state);
    let here = Arguments::before_a_run(scene, layout, from, state);
    let numbers = Numbers::new(scene, from.params);
    let scratch = &mut Scratch::new(layout);
    let all = said_coordinates((scene, layout), &numbers, &here.at(), given, scratch);
    // The first that is said of a coordinate is next to it in the end.
    for start in all.iter().rev() {
        let coordinate = (start.joint, start.coordinate);
        if let Some(value) = start.value {
            begin_next_to((scene, layout), coordinate, value, state);
        }
    }
    for start in given {
        if let Some(link) = layout.carried(start.joint) {
            let places = [link.slots.q, layout.nq + link.slots.v].map(|at| at + start.coordinate);
            // What is about a value is where the loops let it be: next to it by its turns alone.
            let value = start.value.filter(|_| !start.about);
            if let (Some(near), true) = (start.value, start.about) {
                let coordinate = (start.joint, start.coordinate);
                begin_next_to((scene, layout), coordinate, near, state);
            }
            for (place, number) in places.into_iter().zip([value, start.rate]) {
                if let (Some(slot), Some(number)) = (state.get_mut(place), number) {
                    *slot = number;
                }
            }
        }
    }
    Ok(assembly)
}

/// The starts that joint coordinates are declared with, for these params.
fn declared_coordinates(scene: &Scene, params: &[f64]) -> impl Iterator<Item = JointStart> {
    let of = |formula: &Option<Formula>| {
        let formula = formula.as_ref();
        formula.map(|formula| constant(scene, params, formula))
    };
    let declared = scene.starts.coordinates.iter();
    declared.map(move |start| JointStart {
        joint: start.joint,
        coordinate: start.coordinate,
        value: of(&start.value),
        rate: of(&start.rate),
        about: start.about,
    })
}

/// Where joint coordinates are said to begin: as they are `given`, by their declared starts, by the courses of their motors, or where couplings with
/// others that are said, or at zero, have them; in a plane next to what bodies that are turns apart have between them. Of several that are of one
/// coordinate the first counts.
pub fn said_coordinates(
    (scene, layout): (&Scene, &Layout),
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    given: &[JointStart],
    scratch: &mut Scratch<f64>,
) -> Vec<JointStart> {
    let mut said = given.to_vec();
    said.extend(declared_coordinates(scene, &numbers.params));
    said.extend(driven_coordinates(scene, layout, numbers, at, scratch));
    let counts = scene
        .joints
        .iter()
        .map(|joint| joint.law.measured().count());
    let counts: Vec<usize> = counts.collect();
    let what = Quantity::JointCoordinates;
    let mut all = Vec::new();
    let mut measure = |all: &mut Vec<f64>| {
        if all.is_empty() {
            all.resize(layout.len(what), 0.0);
            evaluate(what, scene, layout, numbers, at, scratch, all);
        }
    };
    let of = |all: &[f64], (joint, coordinate): (usize, usize)| {
        let before: usize = counts.iter().take(joint).sum();
        let own = all.get(3 * (before + coordinate));
        own.copied().unwrap_or_default()
    };
    if layout.directions.plane.is_some() && !layout.turns.is_empty() {
        measure(&mut all);
        let turns = by_bodies((scene, layout), numbers, at.state, &|it| of(&all, it));
        said.extend(turns);
    }
    let values = said.iter().filter(|start| start.value.is_some());
    let named = values.map(|start| (start.joint, start.coordinate));
    let followers = followers((scene, layout), named.collect(), &|_| true);
    if followers.is_empty() {
        return said;
    }
    measure(&mut all);
    for follower in followers {
        let value = |(joint, coordinate): (usize, usize)| {
            let mut own = said.iter().filter(|start| {
                (start.joint, start.coordinate) == (joint, coordinate) && start.value.is_some()
            });
            let own = own.next().and_then(|start| start.value);
            own.unwrap_or_else(|| of(&all, (joint, coordinate)))
        };
        let off = follower.off(&numbers.couplings, [&value, &|_| 0.0]);
        let (Some([off, _]), Some((joint, coordinate))) = (off, follower.coordinate()) else {
            continue;
        };
        let value = value((joint, coordinate)) - off;
        said.push(JointStart {
            joint,
            coordinate,
            value: value.is_finite().then_some(value),
            rate: None,
            about: true,
        });
    }
    said
}

/// Has the angle of a joint of the tree, that attitudes tell up to full turns, begin next to a value [rad]; another coordinate stays.
pub fn begin_next_to(
    (scene, layout): (&Scene, &Layout),
    (joint, coordinate): (usize, usize),
    value: f64,
    state: &mut [f64],
) {
    let declared = scene.joints.get(joint);
    let told = declared.and_then(|joint| joint.law.coordinate(coordinate));
    let link = layout.carried(joint);
    let slot = link.and_then(|link| state.get_mut(link.slots.q + coordinate));
    if let (Some(slot), Some(true)) = (slot, told.map(|told| told.is_periodic())) {
        *slot = next_to(*slot, value);
    }
}
