//! What a planar scene must obey: joints that close in the plane, and coordinates that something there changes, where anything acts along them.

use mbd_scene::joints::{FORCE, MOTOR, NUMBERS, START, START_RATE, STOPS};
use mbd_scene::{Gravity, Layout, Plane, Scene};

use crate::describe;
use crate::messages::check as say;
use crate::resolve::{Named, Resolver, fold, letter as axis_text};

/// Tells joints whose frames disagree out of the plane, what couples coordinates that the plane holds or acts along them, and joints that hold
/// everything there.
pub fn check_planar(resolver: &mut Resolver<'_>) {
    let Some(plane) = resolver.scene.planar else {
        return;
    };
    if !resolver.whole || !resolver.messages.is_empty() {
        return;
    }
    if let Some(across) = gravity_across(&resolver.scene, plane) {
        resolver.notes.push(across);
    }
    let scene = &resolver.scene;
    let unchanged = Layout::unchanged(scene);
    let holds = |joint: usize| {
        scene.joints.get(joint).is_some_and(|own| {
            let still = unchanged.iter().filter(|(of, _)| *of == joint).count();
            still > 0 && still == own.law.freedoms()
        })
    };
    let (mut errors, mut warnings) = (Vec::new(), Vec::new());
    let apart = Layout::apart(scene);
    for apart in &apart {
        let joint = scene.joints.get(apart.joint);
        let at = resolver.declared.get(&Named::Joint(apart.joint));
        if let (Some(joint), Some(&at)) = (joint, at) {
            let places = [joint.parent, joint.child].map(|place| describe::place(scene, place));
            let axes = (plane.word(), letter(plane.normal()));
            errors.push(match apart.gap {
                Some(gap)
                    if let Some(axis) = axis(scene, apart.joint, plane)
                        && holds(apart.joint) =>
                {
                    say::apart_by_its_axis(at, &joint.name, axes, &places, gap, &axis)
                }
                Some(gap) => say::apart(at, &joint.name, axes, &places, gap),
                None => say::leaning(at, &joint.name, axes, &places),
            });
        }
    }
    let coupled = Layout::still(scene);
    for &(number, index) in &unchanged {
        let found = scene.coordinate(number, index);
        let at = resolver.declared.get(&Named::Joint(number));
        let (Some((joint, coordinate)), Some(&at)) = (found, at) else {
            continue;
        };
        if apart.iter().any(|apart| apart.joint == number) {
            continue;
        }
        let name = format!("{}.{}", joint.name, coordinate.name);
        let axis = axis(scene, number, plane).filter(|_| holds(number));
        let acting = acting(scene, number, index);
        if !acting.is_empty() {
            errors.push(say::never_acts(
                at,
                &name,
                plane.word(),
                &acting,
                axis.as_ref(),
            ));
        } else if coupled.contains(&(number, index)) {
            errors.push(say::still(at, &name, plane.word()));
        } else if index == 0 && holds(number) {
            warnings.push(say::holds_in_plane(
                at,
                &joint.name,
                &name,
                plane.word(),
                axis.as_ref(),
            ));
        }
    }
    errors
        .into_iter()
        .for_each(|error| resolver.messages.push(error));
    warnings
        .into_iter()
        .for_each(|warning| resolver.warnings.push(warning));
}

/// A note where gravity is known and has nothing in the plane.
fn gravity_across(scene: &Scene, plane: Plane) -> Option<String> {
    let Gravity::Uniform { acceleration } = &scene.gravity else {
        return None;
    };
    let parts = acceleration
        .each_ref()
        .map(|part| fold::at_defaults(part, scene));
    let normal = plane.normal();
    let is_across = |k: usize| parts[k].is_some_and(|part| (part != 0.0) == (k == normal));
    let across = (0..3).all(is_across);
    across.then(|| say::gravity_across(plane.word(), letter(normal)))
}

/// Numbers of a coordinate that act along it; the others belong to these, or to its stops.
const ACTS: [&str; 3] = ["stiffness", "damping", "friction"];

/// The fields of a coordinate that act along it, or say where it starts.
fn acting(scene: &Scene, number: usize, index: usize) -> Vec<&'static str> {
    let forces = scene
        .joints
        .get(number)
        .into_iter()
        .flat_map(|joint| &joint.forces);
    let forces = forces.filter(|forces| forces.coordinate == index);
    let mut fields: Vec<&str> = Vec::new();
    for forces in forces {
        let given = NUMBERS.iter().zip(forces.numbers());
        let given = given.filter(|(field, given)| given.is_some() && ACTS.contains(&field.name));
        fields.extend(given.map(|(field, _)| field.name));
        let more = [
            (STOPS.name, forces.stops.iter().any(Option::is_some)),
            (FORCE.name, forces.force.is_some()),
            (MOTOR.name, forces.motor.is_some()),
        ];
        fields.extend(
            more.iter()
                .filter(|(_, given)| *given)
                .map(|(name, _)| *name),
        );
    }
    let starts = scene.starts.coordinates.iter();
    for start in starts.filter(|start| (start.joint, start.coordinate) == (number, index)) {
        let given = [(START.name, &start.value), (START_RATE.name, &start.rate)];
        fields.extend(
            given
                .iter()
                .filter(|(_, given)| given.is_some())
                .map(|(name, _)| *name),
        );
    }
    fields
}

/// What is wrong with the axis of a joint in a plane, of one that turns about it or slides along it alone.
fn axis(scene: &Scene, number: usize, plane: Plane) -> Option<say::AxisInPlane> {
    let joint = scene.joints.get(number)?;
    let (_, own) = joint.law.about_z()?;
    let turns = scene.coordinate(number, 0)?.1.is_angle();
    let axes = Layout::axes_of_joint(scene, number);
    let normal = plane.normal();
    // Of one that slides the component along the normal is nothing, of one that turns it is all.
    let wanted = if turns { 1.0 } else { 0.0 };
    let fits = |axis: &[f64; 3]| (axis[normal].abs() - wanted).abs() < NEAR;
    let better = axes.iter().zip(LETTERS).filter(|(axis, _)| fits(axis));
    let in_part = |k: usize| (0..3).map(|i| own.0[i] * axes[i][k]).sum::<f64>();
    let turned_about = (0..3).find(|&k| (in_part(k).abs() - 1.0).abs() < NEAR);
    let within: Vec<&str> = LETTERS
        .into_iter()
        .filter(|it| *it != letter(normal))
        .collect();
    Some(say::AxisInPlane {
        turns,
        own: axis_text(own),
        moves: if turns {
            letter(normal).to_owned()
        } else {
            within.join(" and ")
        },
        better: better.map(|(_, letter)| letter).collect(),
        plane: turned_about.filter(|_| turns).and_then(about),
    })
}

/// Unit vectors that differ by less are the same.
const NEAR: f64 = 1e-9;

const LETTERS: [&str; 3] = ["x", "y", "z"];

fn letter(k: usize) -> &'static str {
    LETTERS.get(k).copied().unwrap_or_default()
}

/// The plane with this normal.
fn about(normal: usize) -> Option<&'static str> {
    let all = [Plane::Xy, Plane::Yz, Plane::Xz].into_iter();
    let mut all = all.filter(|plane| plane.normal() == normal);
    all.next().map(Plane::word)
}
