//! Staying on the joints: projection of positions, then of velocities, and a start that obeys them.
//!
//! ```text
//! Φ_v δ = −Φ,    M δ = Φ_vᵀ μ,   x ← x moved by δ         repeated with fresh rows                (1)
//! Φ_v δ = −(Φ_v v + Φ_t), M δ = Φ_vᵀ μ,  v ← v + δ                                                (2)
//! ```
//!
//! The move is the smallest one weighted by mass. Rotations move by the exponential: q ← q ∘ exp(δ/2) in body components,
//! exp(δ/2) ∘ q in world components; in a plane the angle moves by δ. A trial step is projected before its last stage, so that the rates at its end are those of the
//! projected state; the error estimate is made of the stages alone and does not see the move. What is repeated, and when it ends, is the same for a
//! run and for several in lanes (`rounds`).

use mbd_scene::laws::{self, Numbers};
use mbd_scene::{Arguments, At, Float, Quantity};

use crate::columns::joint_name;
use crate::error::{Source, StepError};
use crate::fallback::{Dependence, NEW, dependent};
use crate::laws::numbers_of;
use crate::list::{all_finite, largest};
use crate::options::Stabilise;
use crate::system::System;

mod free_step;
mod rounds;
mod step;

use rounds::{Effort, ROUNDED, START};
pub(crate) use rounds::{
    JointMeasures, OnJoints, STEP, displace_shortened, project_positions, project_velocities,
};
pub(crate) use step::Projection;

/// Rows that a step leaves this far from zero, in scene lengths, have come apart.
pub(crate) const APART: f64 = 1e-6;
/// What a solve may leave of the rows, relative: beyond it rows that are not in the system ask for more than those that are.
const UNSOLVED: f64 = 1e-3;
/// How many joints an error names.
const NAMED: usize = 3;

impl<T: Float> System<T> {
    /// Puts the state of a trial step back on the joints by (1) and (2).
    pub(crate) fn stay(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        if !self.projection.any() || self.projection.stabilise != Stabilise::Projection {
            return Ok(());
        }
        let state = state.get_mut(..self.nx).unwrap_or_default();
        let mut norm = self.project_positions(time, state, STEP)?;
        let allowed = self.measures().apart(state).to_f64();
        if norm > allowed && self.takes_more_rows() {
            norm = self.project_positions(time, state, STEP)?;
        }
        if norm > allowed {
            return Err(StepError::JointsApart {
                time,
                norm,
                rows: self.worst_joints((time, state), ["m", "rad"]),
            });
        }
        self.project_velocities(time, state)
    }

    /// The same for a state beside a step, whatever keeps the run on its joints; also where they are far apart.
    pub(crate) fn put_on_joints(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        self.project_positions(time, state, START)?;
        self.project_velocities(time, state)
    }

    /// Makes a start consistent: independent rows, positions by (1), the branch every joint means, velocities by (2).
    pub(crate) fn assemble(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        let state = state.get_mut(..self.nx).unwrap_or_default();
        self.check_inertia(time, state)?;
        if !self.projection.any() {
            return self.check_plane(time, state);
        }
        if self.may_need_repeated_rows() {
            self.choose_always();
        }
        let mut norm = self.project_positions(time, state, START)?;
        if !self.holds(norm, state) && self.model.layout().redundancy.lost() > 0 {
            // With these parameters the rows that were left out may ask for more than the others.
            self.choose_always();
            norm = self.project_positions(time, state, START)?;
        }
        if !self.holds(norm, state) {
            return Err(StepError::InconsistentStart {
                norm,
                rows: self.worst_joints((time, state), ["m", "rad"]),
            });
        }
        self.check_plane(time, state)?;
        self.check_branches(time, state)?;
        match self.follows(time, state) {
            // With these parameters, or assembled this way, the joints hold more than was found in the declaration.
            Some(false) => self.choose_always(),
            // Kept for the sake of an assembly that does not move, rows are too many for good, and not for an instant.
            None if self.has_fewer_rows(time, state) => self.choose_always(),
            _ => {}
        }
        self.project_velocities(time, state)?;
        // Rows that repeat others may hold in position and contradict each other in what they prescribe.
        let mut joints = self.model.layout().joints.iter();
        if joints.any(|slots| slots.driven) {
            let norm = self.read_rows(Quantity::ConstraintRate, time, state);
            let rounding = ROUNDED * T::EPSILON.to_f64() * self.fastest(state);
            if norm > (APART * self.size(state)).max(rounding) {
                return Err(StepError::InconsistentStart {
                    norm,
                    rows: self.worst_joints((time, state), ["m/s", "rad/s"]),
                });
            }
        }
        self.begin_rows(time, state)
    }

    /// The same in a run after an action of an event, which may change speeds, but moves nothing.
    ///
    /// # Errors
    /// Rows that the action leaves further from zero than a step may.
    pub(crate) fn hold_again(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        let own = state.get_mut(..self.nx).unwrap_or_default();
        if self.projection.any() {
            self.supply(time, own)?;
            let norm = self.read_rows(Quantity::Constraint, time, own);
            if norm > self.measures().apart(own).to_f64() {
                return Err(StepError::JointsApart {
                    time,
                    norm,
                    rows: self.worst_joints((time, state), ["m", "rad"]),
                });
            }
        }
        self.assemble(time, state)
    }

    /// Whether rows were left out because a joint repeats them that may be detached.
    fn may_need_repeated_rows(&self) -> bool {
        let layout = self.model.layout();
        let detachable = |joint: &usize| {
            let slots = layout.joints.get(*joint);
            slots.is_some_and(|slots| slots.switch.is_some())
        };
        let mut repeats = layout.redundancy.repeats.iter();
        repeats.any(|repeat| repeat.of.iter().any(detachable))
    }

    /// Decides how the rows of the first step are solved.
    fn begin_rows(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        self.fallback.margin = f64::NAN;
        self.count_rows_anew(time, state);
        self.measure(time, state);
        self.forget_rows();
        if self.changes_rows(time, state) {
            self.put_on_joints(time, state)?;
            self.measure(time, state);
        }
        self.pick(time, state);
        self.fallback.commit();
        Ok(())
    }

    /// Adds Baumgarte's −2α Φ̇ − α² Φ to the right-hand side of the acceleration rows, where the run asks for it. The move of (1) with these as
    /// rows is exactly what they add to the accelerations.
    pub(crate) fn pull_back(
        &mut self,
        time: f64,
        state: &[T],
        rates: &mut [T],
    ) -> Result<(), StepError> {
        let Stabilise::Baumgarte { alpha } = self.projection.stabilise else {
            return Ok(());
        };
        if !self.projection.any() {
            return Ok(());
        }
        let alpha = T::from_f64(alpha);
        self.read_rows(Quantity::Constraint, time, state);
        let (kept, rows) = (&mut self.projection.trial, &self.projection.rows);
        for (to, row) in kept.iter_mut().zip(rows) {
            *to = alpha * alpha * *row;
        }
        self.read_rows(Quantity::ConstraintRate, time, state);
        let (kept, rows) = (&self.projection.trial, &mut self.projection.rows);
        for (row, position) in rows.iter_mut().zip(kept) {
            *row = (alpha + alpha) * *row + *position;
        }
        self.correct(time, state)?;
        let nq = self.model.layout().nq;
        for (rate, more) in rates.iter_mut().skip(nq).zip(self.projection.moves()) {
            *rate += *more;
        }
        Ok(())
    }

    /// The typed error of a state where the rows cannot be solved; `None` if they can.
    #[cold]
    pub(crate) fn unsolvable(&mut self, time: f64, state: &[T]) -> Option<StepError> {
        if !self.projection.any() || state.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let bias = self.read_rows(Quantity::ConstraintBias, time, state);
        if !bias.is_finite() {
            return Some(self.rows_not_finite(time));
        }
        match self.follows(time, state) {
            Some(_) => None,
            None => Some(self.singular(time, state)),
        }
    }

    /// Repeats (1); hands back what is left of Φ.
    fn project_positions(
        &mut self,
        time: f64,
        state: &mut [T],
        effort: Effort,
    ) -> Result<f64, StepError> {
        let mut own = RunOnJoints { system: self, time };
        project_positions(&mut own, state, effort, true).map(T::to_f64)
    }

    /// Applies (2), twice where the first leaves something.
    fn project_velocities(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        project_velocities(&mut RunOnJoints { system: self, time }, state, true)
    }

    /// What rows and speeds are judged by.
    pub(crate) fn measures(&self) -> JointMeasures<T> {
        let layout = self.model.layout();
        JointMeasures {
            epsilon: T::EPSILON.to_f64(),
            length: T::from_f64(self.projection.length),
            extent: T::from_f64(self.projection.extent),
            coordinates: layout.nq,
            speeds: layout.nv,
        }
    }

    /// Reads rows; their largest size, infinite where one is not finite.
    fn read_rows(&mut self, what: Quantity, time: f64, state: &[T]) -> f64 {
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        self.model
            .evaluate(what, &at, &mut self.work, &mut self.projection.rows);
        largest(&self.projection.rows)
    }

    /// Solves for the move that takes the rows out; with rows chosen at this state where those kept cannot be solved.
    fn correct(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        self.solve_rows(time, state);
        let solved = all_finite(self.projection.moves()) && self.is_regular();
        if !solved || self.solves_chosen() {
            self.correct_by(|system, rows, moves| system.correct_anew(time, state, rows, moves));
        }
        if self.solves_chosen() {
            // That of the emitted elimination says nothing of rows that it leaves out.
            self.fallback.margin = f64::NAN;
        }
        if all_finite(self.projection.moves()) {
            return Ok(());
        }
        Err(self.singular(time, state))
    }

    /// Solves for the move without the emitted elimination.
    #[cold]
    fn correct_by(&mut self, solve: impl FnOnce(&mut Self, &[T], &mut [T])) {
        let rows = std::mem::take(&mut self.projection.rows);
        let mut shift = std::mem::take(&mut self.projection.shift);
        let moves = shift
            .split_last_mut()
            .map_or(&mut [][..], |(_, moves)| moves);
        solve(self, &rows, moves);
        (self.projection.rows, self.projection.shift) = (rows, shift);
    }

    /// Factorises the rows at a state where no move had to be solved for, to know their margin.
    pub(crate) fn measure(&mut self, time: f64, state: &[T]) {
        if self.fallback.margin.is_nan() {
            self.projection.rows.fill(T::zero());
            self.solve_rows(time, state);
            if self.solves_chosen() {
                self.measure_chosen(time, state);
            }
        }
    }

    fn solve_rows(&mut self, time: f64, state: &[T]) {
        let Projection { rows, shift, .. } = &mut self.projection;
        let at = At {
            rows,
            ..self.nodes.at(T::from_f64(time), state, &self.inputs)
        };
        self.model
            .evaluate(Quantity::ProjectionStep, &at, &mut self.work, shift);
        self.fallback.margin = self.projection.margin();
    }

    /// The largest coordinate, or the length of the scene; that also where a coordinate is not finite.
    fn size(&self, state: &[T]) -> f64 {
        self.measures().size(state).to_f64()
    }

    /// Finds how far the places of a tree are from the origin, of the params of now: its arms and what it hangs on.
    pub(crate) fn take_extent_of_tree(&mut self) {
        self.projection.extent = match self.model.layout().tree.is_some() && self.projection.any() {
            true => {
                let numbers = numbers_of(&*self.model);
                let far = numbers.world_frames.iter();
                let far = far.map(|frame| frame.position.norm());
                far.fold(self.reach(), f64::max)
            }
            false => 0.0,
        };
    }

    /// The largest speed; zero where one is not finite.
    fn fastest(&self, state: &[T]) -> f64 {
        self.measures().fastest(state).to_f64()
    }

    /// Whether rows of this size hold.
    fn holds(&self, norm: f64, state: &[T]) -> bool {
        let measures = self.measures();
        norm <= measures.held(measures.size(state)).to_f64()
    }

    /// Takes arbitrary speeds out of the rows and looks whether those that are not in the system follow. `None` where it cannot be solved.
    fn follows(&mut self, time: f64, state: &[T]) -> Option<bool> {
        let nq = self.model.layout().nq;
        let some = |speed: usize| if speed.is_multiple_of(2) { 1.0 } else { -0.5 } + 0.1 * (speed as f64 * 1.7).sin();
        let mut trial = std::mem::take(&mut self.projection.trial);
        for (to, from) in trial.iter_mut().zip(state) {
            *to = *from;
        }
        let speeds = trial.iter_mut().skip(nq).zip(self.projection.moves());
        for (index, (speed, _)) in speeds.enumerate() {
            *speed = T::from_f64(some(index));
        }
        let asked = self.read_rows(Quantity::ConstraintRate, time, &trial);
        self.solve_rows(time, &trial);
        for (speed, more) in trial.iter_mut().skip(nq).zip(self.projection.moves()) {
            *speed += *more;
        }
        let solved = all_finite(self.projection.moves()) && self.is_regular();
        let left = self.read_rows(Quantity::ConstraintRate, time, &trial);
        self.projection.trial = trial;
        solved.then_some(left <= UNSOLVED * asked)
    }

    /// Says which rows depend on each other, and whether they contradict.
    #[cold]
    pub(crate) fn singular(&mut self, time: f64, state: &[T]) -> StepError {
        let model = self.model.clone();
        let layout = model.layout();
        let mut jacobian = vec![0.0; layout.len(Quantity::ConstraintJacobian)];
        self.by_laws(Quantity::ConstraintJacobian, time, state, &mut jacobian);
        let norm = self.read_rows(Quantity::Constraint, time, state);
        if !norm.is_finite() {
            return self.rows_not_finite(time);
        }
        let new_from = NEW.max(ROUNDED * T::EPSILON.to_f64());
        let Dependence {
            rank,
            rows,
            contradiction,
        } = dependent(&jacobian, layout.nv, &self.projection.rows, new_from);
        if contradiction > 0.1 * norm && !self.holds(norm, state) {
            return StepError::InconsistentStart {
                norm,
                rows: self.worst_joints((time, state), ["m", "rad"]),
            };
        }
        let scene = self.model.scene();
        let joints = layout.joints.iter().enumerate();
        let involved = joints.filter(|(_, slots)| {
            let own = slots.row..slots.row + slots.len;
            rows.iter().any(|row| own.contains(row))
        });
        StepError::SingularConstraints {
            time,
            rank,
            rows: layout.nc,
            joints: involved
                .map(|(joint, _)| joint_name(scene, joint).to_owned())
                .collect(),
        }
    }

    /// A prescribed motion may have no value at a time: names the joint of the rows that were read last.
    #[cold]
    fn rows_not_finite(&self, time: f64) -> StepError {
        let joint = self.worst(self.open_joints()).into_iter().next();
        let name = |(joint, _)| joint_name(self.model.scene(), joint).to_owned();
        StepError::NonFinite {
            time,
            source: Source::Joint(joint.map_or_else(String::new, name)),
        }
    }

    /// What the laws need that are asked at a start or for a message, in `f64` whatever the scalar of the run.
    #[cold]
    pub(crate) fn in_double(&self, time: f64, state: &[T]) -> (Numbers<f64>, Arguments<f64>) {
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        let mut arguments = Arguments::default();
        arguments.read(&at, T::to_f64);
        (numbers_of(&*self.model), arguments)
    }

    /// The joints whose rows are furthest from zero, largest first, from the rows that were read last, with the unit of the worst row of each: of a
    /// length, or of an angle.
    #[cold]
    fn worst_joints(
        &self,
        (time, state): (f64, &[T]),
        [length, angle]: [&'static str; 2],
    ) -> Vec<(String, f64, &'static str)> {
        let (scene, layout) = (self.model.scene(), self.model.layout());
        let own = state.get(..self.nx).unwrap_or_default();
        let (numbers, arguments) = self.in_double(time, own);
        let at = arguments.at();
        let worst = self.worst(self.open_joints()).into_iter();
        let told = worst.map(|(joint, size)| {
            let slots = layout.joints.get(joint);
            let rows = slots.and_then(|it| self.projection.rows.get(it.row..it.row + it.len));
            let row = rows.and_then(|rows| rows.iter().position(|x| x.abs().to_f64() >= size));
            let units = laws::row_units(scene, layout, &numbers, &at, joint);
            let unit = row.and_then(|row| units.get(row));
            let unit = if unit == Some(&"rad") { angle } else { length };
            (joint_name(scene, joint).to_owned(), size, unit)
        });
        told.collect()
    }

    /// Every joint with its largest row, from the rows that were read last.
    fn open_joints(&self) -> impl Iterator<Item = (usize, f64)> {
        let joints = self.model.layout().joints.iter().enumerate();
        joints.map(|(joint, slots)| {
            let rows = self.projection.rows.get(slots.row..slots.row + slots.len);
            (joint, largest(rows.unwrap_or(&[])))
        })
    }

    /// Those joints that are off by as much as the worst, largest first.
    fn worst(&self, joints: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, f64)> {
        let mut worst: Vec<(usize, f64)> = joints.collect();
        worst.sort_by(|a, b| b.1.total_cmp(&a.1));
        let most = worst.first().map_or(0.0, |first| first.1);
        worst.retain(|(_, size)| *size >= 1e-3 * most);
        worst.truncate(NAMED);
        worst
    }

    /// Rows that say nothing in the plane of a planar scene hold by the declaration of the frames, or never.
    fn check_plane(&self, time: f64, state: &[T]) -> Result<(), StepError> {
        let (scene, layout) = (self.model.scene(), self.model.layout());
        if layout.directions.plane.is_none() {
            return Ok(());
        }
        let (numbers, arguments) = self.in_double(time, state);
        let at = arguments.at();
        let held = (0..layout.joints.len()).filter(|&joint| layout.joints[joint].holds);
        let off = |joint| laws::out_of_plane(scene, layout, &numbers, &at, joint);
        let worst = self.worst(held.map(|joint| (joint, off(joint))));
        let norm = worst.first().map_or(0.0, |first| first.1);
        let named = |(joint, size)| (joint_name(scene, joint).to_owned(), size, "m or rad");
        let rows = worst.into_iter().map(named).collect();
        match self.holds(norm, state) {
            true => Ok(()),
            false => Err(StepError::InconsistentStart { norm, rows }),
        }
    }
}

/// A run at a time [s].
struct RunOnJoints<'a, T: Float> {
    system: &'a mut System<T>,
    time: f64,
}

impl<T: Float> OnJoints<T> for RunOnJoints<'_, T> {
    type Error = StepError;

    fn measures(&self) -> JointMeasures<T> {
        self.system.measures()
    }

    fn read(&mut self, what: Quantity, state: &[T]) -> T {
        T::from_f64(self.system.read_rows(what, self.time, state))
    }

    fn solve(&mut self, state: &[T], open: bool) -> Result<bool, StepError> {
        self.system.correct(self.time, state).map(|()| open)
    }

    fn moves(&self) -> &[T] {
        self.system.projection.moves()
    }

    fn moves_all(&self) -> bool {
        !self.system.solves_chosen() && self.system.is_regular()
    }

    fn displace(&mut self, state: &mut [T], _: bool) {
        let System {
            model, projection, ..
        } = &self.system;
        let parts = (&projection.parts[..], model.scene().angular_velocity);
        displace_shortened(parts, state, projection.moves());
        self.system.normalise(state);
    }

    fn hasten(&mut self, state: &mut [T], _: bool) {
        let speeds = state.iter_mut().skip(self.system.model.layout().nq);
        for (speed, more) in speeds.zip(self.system.projection.moves()) {
            *speed += *more;
        }
    }

    fn is_any(mask: bool) -> bool {
        mask
    }

    fn but(mask: bool, other: bool) -> bool {
        mask & !other
    }
}
