//! A scene laid out and planned.

use crate::plan::{Topology, relative};
use crate::redundancy;
use crate::starts::{StartFrom, declared_parts, place_declared};
use crate::tree::lay_axes;
use crate::{Carrying, Coordinates, Layout, Order, Place, Plan, Redundancy, RowSet, Scene};

/// The state at which a scene in absolute coordinates is declared to start, its params at their defaults; `None` where it says nothing of it.
fn begun(scene: &Scene) -> Option<Vec<f64>> {
    if scene.starts.parts.is_empty() && scene.starts.coordinates.is_empty() {
        return None;
    }
    let layout = places(scene);
    let params: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let mut state = vec![0.0; layout.nx()];
    layout.quaternions().for_each(|qw| state[qw] = 1.0);
    let from = StartFrom::new(&params, 0.0);
    declared_parts(scene, &layout, from, &mut state);
    place_declared(scene, &layout, from, &[], &[], &mut state).ok()?;
    Some(state)
}

impl Layout {
    /// Lays out a scene and plans its solution: finds the rows of its joints that repeat others ([`Redundancy`]: a search at random states
    /// wherever joints close a loop) and the cheapest order of elimination. Where that has been done before, [`Layout::planned`] takes the result.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let layout = places(scene);
        let redundancy = match &layout.tree {
            None => redundancy::find(scene, &layout, None, || begun(scene)),
            Some(tree) => {
                // Rows repeat each other whatever the coordinates.
                let absolute = scene.in_coordinates(Coordinates::Absolute);
                let begun = || begun(&absolute);
                redundancy::find(&absolute, &places(&absolute), Some(tree), begun)
            }
        };
        layout.with(scene, redundancy, None)
    }

    /// Lays out a scene without planning how it is solved: where everything lives, and every row.
    pub(crate) fn unplanned(scene: &Scene) -> Self {
        places(scene)
    }

    /// Lays out a scene whose redundancy is known, and finds the order. The default redundancy keeps every row.
    #[must_use]
    pub fn keeping(scene: &Scene, redundancy: Redundancy) -> Self {
        places(scene).with(scene, redundancy, None)
    }

    /// Lays out a scene whose plan is known: nothing is searched for.
    #[must_use]
    pub fn planned(scene: &Scene, plan: Plan) -> Self {
        places(scene).with(scene, plan.redundancy, Some(plan.order))
    }

    /// Leaves repeated rows out of the system and lays out its elimination, in this order or in the cheapest.
    fn with(mut self, scene: &Scene, redundancy: Redundancy, order: Option<Order>) -> Self {
        for repeat in &redundancy.repeats {
            if let Some(slots) = self.joints.get_mut(repeat.joint) {
                // Motors follow the rows of the law: what they prescribe is never left out.
                let motors = RowSet::all(slots.len).0 & !RowSet::all(repeat.rows).0;
                slots.kept = RowSet(repeat.kept.within(repeat.rows).0 | motors);
            }
        }
        self.redundancy = redundancy;
        if self.tree.is_some() {
            self.elimination = relative(scene, &self, order.as_ref());
            // Counted once: whoever solves with a factor asks for it every time.
            self.factor = crate::tree::factored_len(&self);
            return self;
        }
        let joints = scene.joints.iter().zip(&self.joints);
        let carrying: Vec<Option<Carrying>> = joints
            .map(|(joint, slots)| {
                // A joint that may be detached stays in the system, where its rows can be taken out.
                if slots.switch.is_some() {
                    return None;
                }
                let driven = joint.motors();
                let driven = driven.map(|(index, _)| Some((index, joint.law.coordinate(index)?)));
                let motors: Vec<_> = driven.collect::<Option<_>>()?;
                let aligned = match joint.child {
                    Place::Body(body, frame) => {
                        let body = scene.bodies.get(body)?;
                        body.frames.get(frame)?.rotation.is_none()
                    }
                    _ => false,
                };
                let directions = (self.directions, aligned);
                Carrying::of(&joint.law, slots.law, &motors, directions)
            })
            .collect();
        let system = Topology {
            directions: self.directions,
            bodies: self.bodies.len(),
            points: &self.points,
            joints: &self.joints,
            carrying: &carrying,
            closed: self.redundancy.closed,
        };
        let order = order.unwrap_or_else(|| system.choose());
        self.elimination = system.lay_out(order);
        if self.nc > 0 {
            self.factor = crate::elimination::factored_len(&self);
        }
        self
    }
}

/// Where everything lives but the system, with the axes of the links; of the rows of a joint's law in a plane those that say something there.
fn places(scene: &Scene) -> Layout {
    let mut layout = Layout::places(scene, |layout| match layout.directions.plane {
        None => every_row(scene),
        Some(_) if layout.tree.is_none() => redundancy::in_plane(scene, layout),
        Some(_) => {
            // Rows say as much, whatever the coordinates.
            let scene = scene.in_coordinates(Coordinates::Absolute);
            redundancy::in_plane(&scene, &Layout::places(&scene, |_| every_row(&scene)))
        }
    });
    if let Some(tree) = &mut layout.tree {
        lay_axes(scene, tree);
    }
    layout
}

/// All rows of the laws.
fn every_row(scene: &Scene) -> Vec<RowSet> {
    let laws = scene.joints.iter();
    laws.map(|joint| RowSet::all(joint.law.rows())).collect()
}
