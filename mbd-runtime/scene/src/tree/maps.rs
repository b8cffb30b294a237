//! From absolute coordinates to relative ones, and back.
//!
//! ```text
//! R12 = R1ᵀ R2,  s = R1ᵀ (o2 − o1)               q: what the joint measures of them; an attitude is R12 as a quaternion        (1)
//! [x; k] = R1ᵀ [v2 − v1 − ω1 × R1 s; ω2 − ω1]   u: least squares of H u = [x; k]                                             (2)
//! M Δu = Jᵀ M_b (V − V(u))                      bodies whose velocities V are not those V(u) = J u + … of any u meet      (3)
//! ```
//!
//! (3) is the plastic impact that the joints of the tree hand on: the least change of the velocities, weighted by mass, as rows make it in absolute
//! coordinates. Rejected: (2) alone, by which a child takes the velocity of its parent, and what it had is lost.
//!
//! The way back is [`Quantity::Bodies`](crate::Quantity::Bodies), from which [`set_bodies`] comes here.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::evaluate::{Scratch, evaluate};
use crate::laws::kinematics::Kinematics;
use crate::laws::numbers::Numbers;
use crate::{
    AngularVelocity, Arguments, Coordinates, Layout, PointSlots, Quantity, Relative, Scene,
    StartFrom, Twist,
};

/// Velocities that differ by less, over the largest, are those that the joints of a tree leave.
const SAME: f64 = 1e-12;

/// The same scene in absolute coordinates, as far as states need it: nothing is planned.
pub(crate) struct Absolute {
    pub scene: Scene,
    pub layout: Layout,
}

impl Absolute {
    pub fn of(scene: &Scene) -> Self {
        let scene = scene.in_coordinates(Coordinates::Absolute);
        let layout = Layout::unplanned(&scene);
        Absolute { scene, layout }
    }

    /// The state in absolute coordinates.
    pub fn state(
        &self,
        (scene, layout): (&Scene, &Layout),
        from: StartFrom<'_>,
        state: &[f64],
    ) -> Vec<f64> {
        let numbers = Numbers::new(scene, from.params);
        let arguments = Arguments::before_a_run(scene, layout, from, state);
        let mut bodies = vec![0.0; layout.len(Quantity::Bodies)];
        let scratch = &mut Scratch::new(layout);
        evaluate(
            Quantity::Bodies,
            scene,
            layout,
            &numbers,
            &arguments.at(),
            scratch,
            &mut bodies,
        );
        self.state_of((layout, state), &bodies)
    }

    /// The state in absolute coordinates with these bodies, one after another as [`Quantity::Bodies`] has them, and all else from a state in relative ones.
    fn state_of(&self, (layout, state): (&Layout, &[f64]), bodies: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.layout.nx()];
        let directions = layout.directions;
        let motions = bodies.chunks_exact(directions.motion());
        for ((_, slots), numbers) in self.layout.own_bodies().zip(motions) {
            let (q, v) = numbers.split_at(directions.coordinates());
            out[slots.q..slots.q + q.len()].copy_from_slice(q);
            let at = self.layout.nq + slots.v;
            out[at..at + v.len()].copy_from_slice(v);
        }
        copy_others((layout, state), (&self.layout, &mut out));
        out
    }

    /// Changes the speeds of a state in relative coordinates by (3), where bodies of which velocities are said in `placed`, a state in absolute ones,
    /// have others.
    pub fn meet(
        &self,
        (scene, layout): (&Scene, &Layout),
        (placed, said): (&[f64], &dyn Fn(usize) -> bool),
        from: StartFrom<'_>,
        state: &mut [f64],
    ) {
        let bodies = |state: &[f64]| self.state((scene, layout), from, state);
        let speeds =
            |state: &[f64]| DVector::from_column_slice(&state[self.layout.nq..][..self.layout.nv]);
        let here = bodies(state);
        let had = speeds(&here);
        let mut change = DVector::zeros(self.layout.nv);
        let per_body = layout.directions.speeds();
        for (_, slots) in self.layout.own_bodies().filter(|(body, _)| said(*body)) {
            for at in slots.v..slots.v + per_body {
                change[at] = placed[self.layout.nq + at] - had[at];
            }
        }
        let largest = had.amax().max((&had + &change).amax());
        if change.amax() <= SAME * largest {
            return;
        }
        let mass = |scene: &Scene, layout: &Layout, state: &[f64]| {
            let arguments = Arguments::before_a_run(scene, layout, from, state);
            let mut mass = vec![0.0; layout.len(Quantity::MassMatrix)];
            let scratch = &mut Scratch::new(layout);
            let numbers = Numbers::new(scene, from.params);
            let what = Quantity::MassMatrix;
            evaluate(
                what,
                scene,
                layout,
                &numbers,
                &arguments.at(),
                scratch,
                &mut mass,
            );
            DMatrix::from_row_slice(layout.nv, layout.nv, &mass)
        };
        let impulse = mass(&self.scene, &self.layout, &here) * change;
        let own = layout.nq..layout.nq + layout.nv;
        let mut trial = state.to_vec();
        trial[own.clone()].fill(0.0);
        let at_rest = speeds(&bodies(&trial));
        let along = own.clone().map(|unit| {
            trial[unit] = 1.0;
            let column = speeds(&bodies(&trial)) - &at_rest;
            trial[unit] = 0.0;
            column.dot(&impulse)
        });
        let along = DVector::from_iterator(layout.nv, along);
        let factor = mass(scene, layout, state).cholesky();
        if let Some(found) = factor.map(|factor| factor.solve(&along)) {
            let speeds = state[own].iter_mut().zip(found.iter());
            speeds.for_each(|(speed, change)| *speed += change);
        }
    }

    /// Writes the state in relative coordinates.
    pub fn relative(
        &self,
        scene: (&Scene, &Layout),
        from: &[f64],
        at: StartFrom<'_>,
        out: &mut [f64],
    ) {
        to_relative(scene, (&self.layout, from), at, out);
    }
}

/// Copies what both families have alike: points with mass, equilibrium points, declared states.
fn copy_others((layout, from): (&Layout, &[f64]), (other, to): (&Layout, &mut [f64])) {
    for (own, slots) in layout.points.iter().zip(&other.points) {
        if let (PointSlots::Mass(own), PointSlots::Mass(slots)) = (own, slots) {
            let moves = layout.directions.translations().len();
            to[slots.q..slots.q + moves].copy_from_slice(&from[own.q..own.q + moves]);
            let (own, at) = (layout.nq + own.v, other.nq + slots.v);
            to[at..at + moves].copy_from_slice(&from[own..own + moves]);
        }
    }
    to[other.nq + other.nv..].copy_from_slice(&from[layout.nq + layout.nv..]);
}

/// Sets the coordinates and speeds of joints in a state in relative coordinates by where bodies are and how they move, one after another as
/// [`Quantity::Bodies`] has them: the way back. Angles lie in (−π, π]; what the joints of the tree forbid is taken out of positions and velocities.
/// A list of another length changes nothing.
pub fn set_bodies(
    (scene, layout): (&Scene, &Layout),
    from: StartFrom<'_>,
    bodies: &[f64],
    state: &mut [f64],
) {
    if bodies.len() != layout.len(Quantity::Bodies) || state.len() != layout.nx() {
        return;
    }
    let absolute = Absolute::of(scene);
    let placed = absolute.state_of((layout, state), bodies);
    to_relative((scene, layout), (&absolute.layout, &placed), from, state);
}

/// Writes a state in relative coordinates from that of the same scene in absolute ones (q, v, z and s). Angles lie in (−π, π]; what the joints of
/// the tree forbid is taken out of positions and velocities.
pub fn to_relative(
    (scene, layout): (&Scene, &Layout),
    (absolute, from): (&Layout, &[f64]),
    at: StartFrom<'_>,
    out: &mut [f64],
) {
    if from.len() != absolute.nx() || out.len() != layout.nx() {
        return;
    }
    let numbers = Numbers::new(scene, at.params);
    let arguments = Arguments::before_a_run(scene, absolute, at, from);
    let at = arguments.at();
    let mut kinematics = Kinematics::new(absolute);
    let evaluation = kinematics.read(scene, absolute, &numbers, &at);
    let floating = layout
        .own_bodies()
        .filter_map(|(body, own)| Some((own, (*absolute.bodies.get(body)?)?)));
    for (own, slots) in floating {
        let (coordinates, speeds) = (layout.directions.coordinates(), layout.directions.speeds());
        out[own.q..own.q + coordinates].copy_from_slice(&from[slots.q..slots.q + coordinates]);
        let (to, from_v) = (layout.nq + own.v, absolute.nq + slots.v);
        out[to..to + speeds].copy_from_slice(&from[from_v..from_v + speeds]);
    }
    copy_others((absolute, from), (layout, out));
    for (joint, link) in layout.joint_links() {
        let law = &scene.joints[joint].law;
        let Some(ends) = evaluation.ends(joint, AngularVelocity::World) else {
            continue;
        };
        let (parent, child) = (&ends.parent, &ends.child);
        let frame = |end: &crate::rows::End<f64>| {
            let columns = [0, 1, 2].map(|k| end.frame.column(k));
            Matrix3::from_columns(&columns)
        };
        let (r1, r2) = (frame(parent), frame(child));
        let mut q = vec![0.0; law.coordinates()];
        for (index, slot) in q.iter_mut().enumerate() {
            if let Some(coordinate) = law.coordinate(index) {
                *slot = ends.value(&coordinate);
            }
        }
        if let Some(attitude) = law.attitude() {
            let rotation = Rotation3::from_matrix_unchecked(r1.transpose() * r2);
            let unit = UnitQuaternion::from_rotation_matrix(&rotation).into_inner();
            q[attitude].copy_from_slice(&[unit.w, unit.i, unit.j, unit.k]);
        }
        let gap = ends.gap();
        let along = r1.transpose() * (ends.gap_rate() - parent.omega.cross(&gap));
        let about = r1.transpose() * (child.omega - parent.omega);
        let mut columns = vec![Twist::zero(); law.freedoms()];
        let relative = Relative {
            q: &q,
            u: &[],
            numbers: &numbers.joints[joint],
        };
        law.subspace(&relative, &mut columns);
        let speeds = speeds(&columns, &along, &about);
        out[link.slots.q..link.slots.q + link.coordinates].copy_from_slice(&q);
        let v = layout.nq + link.slots.v;
        out[v..v + link.speeds].copy_from_slice(speeds.as_slice());
    }
}

/// (2); not a number where the columns do not tell the speeds apart.
fn speeds(columns: &[Twist<f64>], along: &Vector3<f64>, about: &Vector3<f64>) -> DVector<f64> {
    let six = |twist: &Twist<f64>| {
        twist
            .linear
            .iter()
            .chain(twist.angular.iter())
            .copied()
            .collect::<Vec<f64>>()
    };
    let h = DMatrix::from_fn(6, columns.len(), |i, k| six(&columns[k])[i]);
    let motion = DVector::from_vec(six(&Twist {
        linear: *along,
        angular: *about,
    }));
    let normal = h.transpose() * &h;
    let right = h.transpose() * motion;
    normal.cholesky().map_or_else(
        || DVector::from_element(columns.len(), f64::NAN),
        |factor| factor.solve(&right),
    )
}
