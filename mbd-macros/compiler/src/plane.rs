//! `planar: auto`: the plane in which a scene moves, and why it moves in none.
//!
//! A scene moves in a plane if the joints of its tree leave nothing else, and if bodies and points that nothing carries start in it and are
//! not accelerated out of it: looked for at random states there, times, inputs and params, with what events detach and without, and then proved of the
//! equations, in which every term of such an acceleration must vanish by itself.

use mbd_scene::laws::line::DETACHED;
use mbd_scene::laws::{constant, starts};
use mbd_scene::random::SplitMix64;
use mbd_scene::{
    Arguments, Coordinates, Detachable, Formula, Layout, Part, Plane, PointSlots, Quantity, Scene,
    Slots, Triple, double, plain,
};

use crate::describe;
use crate::equations::vanishing_rates;

/// Values of the params at which a scene is looked at: the defaults first.
const VALUES: usize = 4;
/// Random states at each of them.
const STATES: usize = 4;
/// Rounding of places, and of the accelerations of a body or a point as a part of the largest of them.
const ROUNDING: f64 = 1e-9;

/// The plane in which a scene in space moves, of several the first of xy, xz, yz.
///
/// # Errors
/// Why it is none of them.
pub fn plane_of_motion(scene: &Scene) -> Result<Plane, String> {
    if let Some(why) = asks_for_space(scene) {
        return Err(why);
    }
    let mut why = Vec::new();
    for plane in [Plane::Xy, Plane::Xz, Plane::Yz] {
        match leaves(scene, plane) {
            None => return Ok(plane),
            Some(reason) => why.push(format!("{}: {reason}", plane.word())),
        }
    }
    Err(why.join("; "))
}

/// What no plane has, or tells otherwise.
fn asks_for_space(scene: &Scene) -> Option<String> {
    if !Layout::new(scene).nodes.is_empty() {
        return Some("points without mass have three coordinates".to_owned());
    }
    let mut asked = None;
    describe::rewrite(&mut scene.clone(), &mut |formula| {
        if let Formula::Orientation(body) = formula {
            asked = asked.or(Some(*body));
        }
    });
    let body = scene.bodies.get(asked?)?;
    let name = &body.name;
    Some(format!(
        "`{name}.orientation` is asked for, which counts turns in a plane"
    ))
}

/// Why a scene does not move in this plane; `None`: it does.
fn leaves(scene: &Scene, plane: Plane) -> Option<String> {
    if let Some(joint) = scene.reaction_across(plane) {
        let name = scene.joints.get(joint).map_or("", |joint| &joint.name);
        return Some(format!(
            "parts of the reaction of `{name}` across it are asked for"
        ));
    }
    if let Some(frame) = frame_that_leaves(scene, plane) {
        return Some(format!("the frame `{frame}` of the world moves out of it"));
    }
    let mut random = SplitMix64(1);
    let relative = scene.in_coordinates(Coordinates::Relative);
    let seen = (0..VALUES).find_map(|k| {
        let at = with_values(&relative, k, &mut random);
        let layout = Layout::new(&at);
        let freedom = other_freedom(&at, &layout, plane);
        let params: Vec<f64> = at.params.iter().map(|param| param.default).collect();
        let start = || starts_beside(&at, &layout, &params, plane);
        let more = || accelerated_out(&at, &layout, &params, plane, &mut random);
        let why = freedom.or_else(start).or_else(more)?;
        Some(match k {
            0 => why,
            _ => format!("{why}, with other values of the params"),
        })
    });
    seen.or_else(|| may_be_accelerated_out(&relative, plane))
}

/// A frame of the world that moves otherwise than along a plane.
fn frame_that_leaves(scene: &Scene, plane: Plane) -> Option<&str> {
    let mut frames = scene.world_frames.iter();
    let frame = frames.find(|frame| {
        let along = &frame.position[plane.normal()];
        frame.turns(scene) || scene.depends_on_time(along)
    })?;
    Some(&frame.name)
}

/// The scene with other defaults of its params, within their ranges: its own at first.
fn with_values(scene: &Scene, number: usize, random: &mut SplitMix64) -> Scene {
    let mut other = scene.clone();
    for param in other.params.iter_mut().filter(|_| number > 0) {
        let share = random.number();
        param.default = match param.range {
            Some([low, high]) => low + 0.5 * (1.0 + share) * (high - low),
            None if param.default == 0.0 => 0.3 * share,
            None => param.default * (1.0 + 0.3 * share),
        };
    }
    other
}

/// A joint that does not close in a plane, or leaves something else than what a plane has.
fn other_freedom(scene: &Scene, layout: &Layout, plane: Plane) -> Option<String> {
    let flat = Scene {
        planar: Some(plane),
        ..scene.clone()
    };
    let name = |joint: usize| scene.joints.get(joint).map_or("", |joint| &joint.name);
    if let Some(apart) = Layout::apart(&flat).first() {
        let name = name(apart.joint);
        return Some(match apart.gap {
            Some(gap) => format!(
                "the ends of `{name}` are {} m apart across it",
                plain(gap, 3)
            ),
            None => format!("the axes of `{name}` lean out of it"),
        });
    }
    let still = Layout::still(&flat).into_iter().map(|(joint, _)| joint);
    let carried = |layout: &Layout| -> Vec<(usize, usize)> {
        let links = layout.joint_links();
        links.map(|(joint, link)| (joint, link.speeds)).collect()
    };
    let (within, all) = (carried(&Layout::new(&flat)), carried(layout));
    let differs = all.iter().find(|link| !within.contains(link));
    let other = differs.or(within.iter().find(|link| !all.contains(link)));
    let other = other.map(|(joint, _)| *joint);
    let joint = { still }.next().or(other)?;
    Some(format!("`{}` leaves other motions", name(joint)))
}

/// Bodies that float and points with mass: what they are, whether they turn, and their place in q and v.
fn afloat(layout: &Layout) -> impl Iterator<Item = (Part, bool, Slots)> + '_ {
    let bodies = layout
        .own_bodies()
        .map(|(body, slots)| (Part::Body(body), true, slots));
    let points = layout.points.iter().enumerate();
    let points = points.filter_map(|(point, own)| match own {
        PointSlots::Mass(slots) => Some((Part::Point(point), false, *slots)),
        PointSlots::Node(_) => None,
    });
    bodies.chain(points)
}

/// Something that floats and does not start in a plane.
fn starts_beside(scene: &Scene, layout: &Layout, params: &[f64], plane: Plane) -> Option<String> {
    let normal = plane.normal();
    let mut afloat = afloat(layout);
    let (part, ..) = afloat.find(|(part, ..)| {
        let number = |formula: &Formula| constant(scene, params, formula);
        let starts = scene.starts.parts.iter();
        let mut own = starts.filter(|start| start.part == *part);
        own.any(|start| {
            let given = |of: &Option<Triple>| {
                let of = of.as_ref();
                of.map_or([0.0; 3], |of| of.each_ref().map(number))
            };
            let [place, velocity, rates] =
                [&start.position, &start.velocity, &start.angular_velocity].map(given);
            let rotation = start.rotation.as_ref();
            let along = rotation.map_or(1.0, |rows| number(&rows[normal][normal]));
            let off = |number: f64| number.is_nan() || number.abs() > ROUNDING;
            off(place[normal])
                || off(velocity[normal])
                || (0..3).any(|axis| axis != normal && off(rates[axis]))
                || off(along - 1.0)
        })
    })?;
    Some(format!(
        "`{}` does not start in it",
        describe::part(scene, part)
    ))
}

/// The numbers of the speeds, and of a state where `place` is given, that are zero in a plane, of one that floats.
fn across(plane: Plane, turns: bool, place: Option<usize>, motion: usize) -> Vec<usize> {
    let normal = plane.normal();
    let within = move |first: usize| {
        (0..3)
            .filter(move |&axis| axis != normal)
            .map(move |axis| first + axis)
    };
    let mut all = vec![motion + normal];
    all.extend(place.map(|place| place + normal));
    if turns {
        all.extend(within(motion + 3));
        all.extend(place.into_iter().flat_map(|place| within(place + 4)));
    }
    all
}

/// Something that floats and is accelerated out of a plane at random states in it.
fn accelerated_out(
    scene: &Scene,
    layout: &Layout,
    params: &[f64],
    plane: Plane,
    random: &mut SplitMix64,
) -> Option<String> {
    let numbers = double::numbers(scene, params);
    let (mut scratch, mut rates) = (double::scratch(layout), vec![0.0; layout.nx()]);
    (0..STATES).find_map(|k| {
        let mut arguments = random_state(scene, layout, params, plane, random);
        // What events detach may be detached, all of it or nothing.
        for what in detachables(scene).filter(|_| k % 2 == 1) {
            if let Some(place) = layout.switch_of(what) {
                arguments.hold[place] = DETACHED;
            }
        }
        double::evaluate(
            Quantity::Derivative,
            scene,
            layout,
            &numbers,
            &arguments.at(),
            &mut scratch,
            &mut rates,
        );
        if !rates.iter().all(|rate| rate.is_finite()) {
            return Some("accelerations at a state in it are no numbers".to_owned());
        }
        let (part, ..) = afloat(layout).find(|&(_, turns, slots)| {
            let first = layout.nq + slots.v;
            let own = rates.iter().skip(first).take(if turns { 6 } else { 3 });
            let none = ROUNDING * own.fold(0.0_f64, |most, rate| most.max(rate.abs()));
            let across = across(plane, turns, None, first);
            across.into_iter().any(|at| rates[at].abs() > none)
        })?;
        Some(format!(
            "`{}` is accelerated out of it",
            describe::part(scene, part)
        ))
    })
}

/// Something that floats whose acceleration out of a plane is not zero by the equations alone: beyond the states that were looked at it may leave it.
fn may_be_accelerated_out(scene: &Scene, plane: Plane) -> Option<String> {
    let layout = Layout::new(scene);
    let out = |turns, slots: Slots| across(plane, turns, Some(slots.q), layout.nq + slots.v);
    let zero: Vec<usize> = afloat(&layout)
        .flat_map(|(_, turns, slots)| out(turns, slots))
        .collect();
    let vanishes = vanishing_rates(scene, &layout, &zero);
    let mut afloat = afloat(&layout);
    let (part, ..) = afloat.find(|&(_, turns, slots)| {
        let mut out = across(plane, turns, None, layout.nq + slots.v).into_iter();
        out.any(|rate| !vanishes.get(rate).copied().unwrap_or_default())
    })?;
    Some(format!(
        "`{}` may be accelerated out of it, as far as its equations tell",
        describe::part(scene, part)
    ))
}

/// What events or the start detach.
fn detachables(scene: &Scene) -> impl Iterator<Item = Detachable> + '_ {
    let lines = (0..scene.lines.len()).map(Detachable::Line);
    let joints = (0..scene.joints.len()).map(Detachable::Joint);
    lines
        .chain(joints)
        .filter(|&what| scene.is_detachable(what))
}

/// A state in a plane: what floats near where it starts, all else near zero.
fn random_state(
    scene: &Scene,
    layout: &Layout,
    params: &[f64],
    plane: Plane,
    random: &mut SplitMix64,
) -> Arguments<f64> {
    let mut state = vec![0.0; layout.nx()];
    for (part, turns, slots) in afloat(layout) {
        let mut starts = scene.starts.parts.iter();
        let start = starts.find(|start| start.part == part);
        if let Some(position) = start.and_then(|start| start.position.as_ref()) {
            let position = position.each_ref().map(|x| constant(scene, params, x));
            state[slots.q..slots.q + 3].copy_from_slice(&position);
        }
        if turns {
            state[slots.q + 3] = 1.0;
        }
    }
    let declared = starts(scene, params);
    let first = state.len() - declared.len();
    state[first..].copy_from_slice(&declared);
    state.iter_mut().for_each(|x| *x += random.number());
    for (_, turns, slots) in afloat(layout) {
        for at in across(plane, turns, Some(slots.q), layout.nq + slots.v) {
            state[at] = 0.0;
        }
    }
    for first in layout.quaternions() {
        let quaternion = &mut state[first..first + 4];
        let square: f64 = quaternion.iter().map(|x| x * x).sum();
        quaternion.iter_mut().for_each(|x| *x /= square.sqrt());
    }
    Arguments {
        time: 1.0 + random.number(),
        state,
        hold: vec![0.0; layout.holds()],
        inputs: (0..layout.ni).map(|_| random.number()).collect(),
        ..Arguments::default()
    }
}
