//! Finding the first event inside a step, to the last digits of time: a bracket from the interpolant, then false position on **redone steps**, so that
//! the accepted state is a step of the method and keeps its order.

use mbd_scene::{Float, Quantity};

use crate::chatter::MOST_SWITCHES;
use crate::error::{Collapse, StepError};
use crate::event::Happening;
use crate::integrate::Rates;
use crate::simulation::ModelRun;
use crate::unilateral::{Mode, name};

/// Interior looks at a step while a watched line does not carry.
const LOOKS: u32 = 16;
/// Interior looks at a step where events are told that do not act, of adaptive and of fixed steps: what lies between is found by `dip`.
const FEW_LOOKS: u32 = 4;
const FEWEST_LOOKS: u32 = 2;
/// The part of a step behind which a guard that has just passed passes again, if it does.
const BEHIND: f64 = 1e-9;
/// Looks for an excursion of a margin that starts a step at zero.
const FINE_LOOKS: u32 = 16;
/// Where a guard at its value goes from rest is seen after this [s].
pub(crate) const AT_REST: f64 = 1e-6;
/// An event that would pass within this part of another step is close to the end of one.
const CLOSE: f64 = 0.1;
/// Events closer than this happen together [s].
pub(crate) const TOGETHER: f64 = 1e-12;
/// A bracket below this is a point [s].
pub(crate) const POINT: f64 = 1e-14;
/// Most redone steps for one event.
const MOST_TRIALS: u32 = 100;

/// A located event: the step that ends on it. Which margins are passed stands in `Simulation::chosen`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocatedEvent {
    /// Its size [s]; zero: it happens at the start.
    pub step: f64,
}

/// Steps between which the chosen margins change sign, and the smallest of them there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EventBracket {
    pub low: f64,
    pub above: f64,
    pub high: f64,
    pub below: f64,
}

impl<T: Float> ModelRun<T> {
    /// Looks into the attempted step. With an event, the attempt is redone so that it ends there.
    pub(crate) fn find_event(&mut self, step: f64) -> Result<Option<LocatedEvent>, StepError> {
        if self.margins.is_empty() {
            return Ok(None);
        }
        self.margins.acts_behind = false;
        if self.noisy {
            let (error, _) = self.method.estimate(step);
            self.margins.resolve(error);
        }
        let restless = self.margins.restless(self.system.modes());
        // Adaptive steps of a smooth motion can be so long that a guard passes and comes back inside one.
        let long = self.is_adaptive() && self.margins.acts();
        let declares = self.margins.declares();
        let looks = match long || restless && !self.keeps_away(step)? {
            true => LOOKS,
            false if declares && self.is_adaptive() => FEW_LOOKS,
            false if declares => FEWEST_LOOKS,
            false => 1,
        };
        let looks = if declares {
            looks.max(self.looks)
        } else {
            looks
        };
        let looks = match declares && self.is_adaptive() {
            true => self.resolving_looks(looks, step)?,
            false => looks,
        };
        let mut clock = self.next_clock(step);
        let (mut earlier, mut low) = (0.0, 0.0);
        let start = &self.margins.start;
        self.margins.before.copy_from_slice(start);
        for look in 1..=looks {
            let high = f64::from(look) / f64::from(looks);
            if let Some(theta) = clock.take_if(|theta| *theta < high) {
                self.look_inside(theta, step)?;
                if self.choose_passed() {
                    return self.narrow(low, theta, step);
                }
            }
            match looks >= LOOKS {
                true => self.look_inside(high, step)?,
                false => self.look_first(high, step)?,
            }
            if self.choose_passed() {
                return self.narrow(low, high, step);
            }
            if look > 1
                && declares
                && let Some([low, high]) = self.find_dip([earlier, low, high], step)?
            {
                return self.narrow(low, high, step);
            }
            self.margins.earlier.copy_from_slice(&self.margins.before);
            self.margins.before.copy_from_slice(&self.margins.now);
            (earlier, low) = (low, high);
        }
        if self.is_adaptive() && self.choose_pushing(step) {
            let start = &self.margins.start;
            self.margins.before.copy_from_slice(start);
            return self.narrow(0.0, 1.0, step);
        }
        let close = if self.system.may_jump() { CLOSE } else { 0.0 };
        if declares && self.margins.are_close(close) {
            // What passes right behind this step is not to be seen by its last stages.
            self.make_step_before(step)?;
            self.look_at_end(step)?;
            if self.choose_passed() {
                let start = &self.margins.start;
                self.margins.before.copy_from_slice(start);
                return self.narrow(0.0, 1.0, step);
            }
        }
        let instant = self.one_instant(step);
        self.margins.acts_behind = self.margins.act_close(instant / step);
        self.margins.start.copy_from_slice(&self.margins.now);
        Ok(None)
    }

    /// When the guard of an event that was located at a time was at its value, as close as times are, if it is of time alone; else that time [s].
    pub(crate) fn passed_at(&self, event: usize, time: f64) -> f64 {
        let came_from = self.margins.sides.get(event) == Some(&false);
        let zero = self.margins.zero_of(event);
        let span = [time - self.one_instant(0.0), time];
        let (scene, of_time) = (self.system.model.scene(), &self.system.of_time);
        let passes = of_time.passes(scene, event, (zero, came_from), span);
        passes.unwrap_or(time)
    }

    /// Where the first guard of time alone passes inside the attempted step, in parts of it: however often such a guard passes, none is leapt over.
    fn next_clock(&self, step: f64) -> Option<f64> {
        let scene = self.system.model.scene();
        let span = [self.time + BEHIND * step, self.time + step];
        let sides = self.margins.declared().filter_map(|(index, _)| {
            let event = self.margins.event_of(index)?;
            let value = self.margins.rearmed.get(index)?.value;
            Some((event, (value, *self.margins.sides.get(event)?)))
        });
        let functions = &self.system.of_time;
        let passings =
            sides.filter_map(|(event, side)| functions.first_passing(scene, event, side, span));
        let first = passings.fold(f64::INFINITY, f64::min);
        first.is_finite().then(|| (first - self.time) / step)
    }

    /// Reads the margins at `theta` of the attempted step.
    pub(crate) fn look_inside(&mut self, theta: f64, step: f64) -> Result<(), StepError> {
        if theta >= 1.0 {
            return self.look_at_end(step);
        }
        self.inside_state(theta, step)?;
        self.read_margins(self.time + theta * step, theta * step)
    }

    /// The same for a first look, which need not be better than the ends of the step tell: what it finds passed is looked at again.
    pub(crate) fn look_first(&mut self, theta: f64, step: f64) -> Result<(), StepError> {
        if self.inside_by_ends(theta, step) {
            self.read_margins(self.time + theta * step, theta * step)?;
            if !self.choose_passed() {
                return Ok(());
            }
        }
        self.look_inside(theta, step)
    }

    /// Reads the margins at the end of the attempted step, whose nodes are solved already.
    fn look_at_end(&mut self, step: f64) -> Result<(), StepError> {
        let guards = self.scratch.get_mut(..self.guards).unwrap_or_default();
        let end = self.method.next();
        self.system
            .at_end(Quantity::Guards, self.time + step, end, guards)?;
        self.margins.read(guards, self.system.modes());
        Ok(())
    }

    /// Reads the margins at the state in `inside`.
    pub(crate) fn read_margins(&mut self, time: f64, span: f64) -> Result<(), StepError> {
        self.system.look(time, span, &self.inside)?;
        let guards = self.scratch.get_mut(..self.guards).unwrap_or_default();
        self.system
            .seen(Quantity::Guards, time, &self.inside, guards);
        self.margins.read(guards, self.system.modes());
        Ok(())
    }

    /// Marks the margins that are passed now.
    pub(crate) fn choose_passed(&mut self) -> bool {
        for (index, (chosen, margin)) in self.chosen.iter_mut().zip(&self.margins.now).enumerate() {
            *chosen = self.margins.passed(index, *margin);
        }
        self.chosen.contains(&true)
    }

    /// Marks the elements that carry and push at the end of the step, by less than counts at an instant, but for so long that it changes a velocity by its tolerance.
    fn choose_pushing(&mut self, step: f64) -> bool {
        let modes = self.system.modes();
        for (index, chosen) in self.chosen.iter_mut().enumerate() {
            *chosen = self.margins.pushes(index, modes, step);
        }
        self.chosen.contains(&true)
    }

    /// The chosen margins were not passed at `low` and are at `high`: makes sure that they were positive in between, and locates.
    fn narrow(
        &mut self,
        low: f64,
        high: f64,
        step: f64,
    ) -> Result<Option<LocatedEvent>, StepError> {
        let mut low = low;
        if self.chosen_before() <= 0.0 {
            // Just after a switch a margin is ±0: the excursion lies later in the step, unless no look finds it positive.
            let mut positive = None;
            for look in 1..FINE_LOOKS {
                let theta = low + (high - low) * f64::from(look) / f64::from(FINE_LOOKS);
                self.look_inside(theta, step)?;
                if self.margins.smallest(&self.chosen) > 0.0 {
                    positive = Some(theta);
                    break;
                }
            }
            match positive {
                Some(theta) => {
                    self.margins.before.copy_from_slice(&self.margins.now);
                    low = theta;
                }
                None => {
                    for (chosen, before) in self.chosen.iter_mut().zip(&self.margins.before) {
                        *chosen &= *before <= 0.0;
                    }
                    if !self.only_elements() {
                        // A guard that is zero at the end of a step passes right behind it.
                        return self.locate(low * step, f64::MIN_POSITIVE, high * step, step);
                    }
                    // A second switch at one instant would stand still: then the step goes on to where the margin is passed.
                    let theta = if low == 0.0 && self.stalled == self.time {
                        high
                    } else {
                        low
                    };
                    if theta > 0.0 {
                        self.redo(theta * step)?;
                    } else {
                        self.stalled = self.time;
                    }
                    return Ok(Some(LocatedEvent { step: theta * step }));
                }
            }
        }
        let above = self.chosen_before();
        self.locate(low * step, above, high * step, step)
    }

    /// The smallest chosen margin at the last look before.
    fn chosen_before(&self) -> f64 {
        let margins = self.margins.before.iter().zip(&self.chosen);
        margins
            .filter(|(_, chosen)| **chosen)
            .map(|(margin, _)| *margin)
            .fold(f64::INFINITY, f64::min)
    }

    /// Redoes the step with another size, unless it was the last attempt, and returns the smallest chosen margin at its end.
    pub(crate) fn redo(&mut self, size: f64) -> Result<f64, StepError> {
        let declared = !self.only_elements();
        let sees_later = declared && self.system.latest == f64::INFINITY;
        if self.attempted != size || sees_later {
            match declared {
                true => self.make_step_before(size)?,
                false if self.end_early(size)? => {}
                false => self.make_step(size)?,
            }
            let counters = &mut self.system.counters;
            counters.redone = counters.redone.saturating_add(1);
        }
        self.look_at_end(size)?;
        Ok(self.margins.smallest(&self.chosen))
    }

    /// Ends the last attempt after a size already [s], where the method can.
    fn end_early(&mut self, size: f64) -> Result<bool, StepError> {
        self.system.see_all();
        let ends = self
            .method
            .end_early(&mut self.system, self.time, size, &self.state)?;
        if ends {
            (self.attempted, self.beside) = (size, false);
        }
        Ok(ends)
    }

    /// Ends the step on the first passing of the chosen margins between `low`, where they are positive, and `high`: on its far side.
    fn locate(
        &mut self,
        low: f64,
        above: f64,
        high: f64,
        step: f64,
    ) -> Result<Option<LocatedEvent>, StepError> {
        let bracket = match self.approach(low, above, high, step)? {
            Some(bracket) => Some(bracket),
            None => self.bracket(low, above, high, step)?,
        };
        let Some(bracket) = bracket else {
            self.margins.start.copy_from_slice(&self.margins.now);
            return Ok(None);
        };
        let high = self.close_in(bracket, step)?;
        // The accepted attempt is the last one made.
        self.redo(high)?;
        let high = self.include_neighbours(high, step)?;
        for (chosen, margin) in self.chosen.iter_mut().zip(&self.margins.now) {
            *chosen &= *margin < 0.0;
        }
        Ok(Some(LocatedEvent { step: high }))
    }

    /// A bracket on redone steps. The one given comes from the interpolant, which differs from a redone step by its own error: an end on the
    /// wrong side moves outward by a sixteenth of the step. `None`: no redone step passes.
    fn bracket(
        &mut self,
        low: f64,
        above: f64,
        high: f64,
        step: f64,
    ) -> Result<Option<EventBracket>, StepError> {
        let stride = step / f64::from(LOOKS);
        let below = self.redo(high)?;
        let mut bracket = EventBracket {
            low,
            above,
            high,
            below,
        };
        while bracket.below >= 0.0 {
            if bracket.high >= step {
                return Ok(None);
            }
            (bracket.low, bracket.above) = (bracket.high, bracket.below);
            bracket.high = (bracket.high + stride).min(step);
            bracket.below = self.redo(bracket.high)?;
        }
        while bracket.low > 0.0 {
            bracket.above = self.redo(bracket.low)?;
            // Zero is not passed yet.
            if bracket.above >= 0.0 {
                bracket.above = bracket.above.max(f64::MIN_POSITIVE);
                break;
            }
            (bracket.high, bracket.below) = (bracket.low, bracket.above);
            bracket.low = (bracket.low - stride).max(0.0);
            bracket.above = f64::MIN_POSITIVE;
        }
        Ok(Some(bracket))
    }

    /// False position (Illinois) on redone steps, until the bracket is a point in time or the margin at its far side is negligible.
    fn close_in(&mut self, bracket: EventBracket, step: f64) -> Result<f64, StepError> {
        let EventBracket {
            mut low,
            mut above,
            mut high,
            mut below,
        } = bracket;
        let resolved = self.resolved(step);
        let negligible = if self.only_elements() {
            (1e-3 * self.margins.finest()).min(1e-12)
        } else {
            0.0
        };
        let mut passed = below;
        // Which end moved last: a second move of the same end halves the weight of the other one.
        let mut moved = 0;
        let mut width = high - low;
        let mut halve = false;
        for _ in 0..MOST_TRIALS {
            if high - low <= resolved || passed < 0.0 && -passed <= negligible {
                return Ok(high);
            }
            // A little behind the straight line's zero: the far side is asked for.
            let slope = (above - below) / (high - low);
            let straight = low + above / slope + 0.5 * resolved;
            let just_before = high - 0.75 * resolved;
            let middle = if !halve && straight > low && straight < high {
                // Closer to an end than what is resolved says no more.
                straight.max(low + 0.5 * resolved)
            } else if !halve && straight >= high && just_before > low {
                // The far side is the zero already: one trial before it says so.
                just_before
            } else {
                0.5 * (low + high)
            };
            if middle <= low || middle >= high {
                return Ok(high);
            }
            let margin = self.redo(middle)?;
            if margin < 0.0 {
                (high, below, passed) = (middle, margin, margin);
                above *= if moved > 0 { 0.5 } else { 1.0 };
                moved = 1;
            } else {
                (low, above) = (middle, margin);
                below *= if moved < 0 { 0.5 } else { 1.0 };
                moved = -1;
            }
            // A margin that jumps or is flat gains nothing from its values: after a poor trial the bracket is halved.
            halve = high - low > 0.5 * width;
            width = high - low;
        }
        Err(self.collapse(high, Collapse::Event))
    }

    /// Times inside this step that are the same time [s].
    pub(crate) fn resolved(&self, step: f64) -> f64 {
        let rounding =
            (4.0 * f64::EPSILON * (self.time.abs() + step)).max(T::EPSILON.to_f64() * step);
        POINT.max(rounding)
    }

    /// An event that is located so much behind the end of a step is at that end [s].
    pub(crate) fn one_instant(&self, step: f64) -> f64 {
        2.0 * self.resolved(step)
    }

    /// Ends the step behind events that happen at the same time as those it ends on, where events act: so that they act together.
    fn include_neighbours(&mut self, high: f64, step: f64) -> Result<f64, StepError> {
        if self.only_elements() || !self.margins.may_act_together() {
            return Ok(high);
        }
        let (alone, later) = (self.margins.happened(), high + self.resolved(step));
        self.redo(later)?;
        if self.margins.happened() > alone {
            return Ok(later);
        }
        self.redo(high)?;
        Ok(high)
    }

    /// Whether none of the chosen margins is that of a declared event.
    fn only_elements(&self) -> bool {
        let mut chosen = self.chosen.iter().enumerate();
        chosen.all(|(index, chosen)| !chosen || self.margins.is_element(index))
    }

    /// Switches what was found, at the accepted state, and starts again from there.
    pub(crate) fn happen(&mut self) -> Result<(), StepError> {
        self.add_simultaneous()?;
        let mut switches = std::mem::take(&mut self.switches);
        switches.clear();
        for (index, _) in self.chosen.iter().enumerate().filter(|(_, it)| **it) {
            let modes = self.system.modes();
            let happening = self.margins.happening(index, &self.scratch, modes);
            if let Some(Happening::Switch(element, mode)) = happening {
                switches.push((element, mode));
            }
        }
        let switched = self.switch(&switches);
        self.switches = switches;
        switched?;
        self.begin_switched()
    }

    /// Starts again from the accepted state, behind what switched there.
    pub(crate) fn begin_switched(&mut self) -> Result<(), StepError> {
        self.inside.copy_from_slice(self.method.first());
        let ahead = self.behind_jump();
        self.method
            .begin(&mut self.system, self.time + ahead, 0.0, &self.state)?;
        self.limit_stiff_pace();
        self.begin_noting()?;
        self.begin_behind()
    }

    /// Margins at the accepted state after something jumped there; declared events that jumped past their zero happen now.
    pub(crate) fn begin_noting(&mut self) -> Result<(), StepError> {
        self.margins.keep_sides();
        let mut crossed = std::mem::take(&mut self.crossed);
        let noted = self.note_crossed(&mut crossed);
        self.crossed = crossed;
        noted?;
        match self.system.following {
            Some(_) => self.settle_far_guards(),
            None => Ok(()),
        }
    }

    /// Notes what has happened and lets it act, until nothing more happens at this instant.
    fn note_crossed(&mut self, crossed: &mut Vec<usize>) -> Result<(), StepError> {
        loop {
            crossed.clear();
            self.begin_margins(&mut |event| crossed.push(event))?;
            let before = self.event_count();
            for event in crossed.iter() {
                self.note(Happening::Declared(*event));
            }
            match self.act(crossed) {
                Ok(true) => {}
                Ok(false) => return Ok(()),
                Err(cause) => {
                    self.forget_events(before);
                    return Err(cause);
                }
            }
        }
    }

    pub(crate) fn switch(&mut self, switches: &[(usize, Mode)]) -> Result<(), StepError> {
        if switches.is_empty() {
            return Ok(());
        }
        let finest = self.margins.finest();
        let within = if finest.is_finite() { finest } else { 0.0 };
        self.system
            .switch(self.time, &self.state, (switches, within))?;
        if self.system.nodes.carries_by_place() {
            // The line that goes slack may have held a node beside there by as much as its tolerance.
            self.system.project(&mut self.state);
        }
        for &(element, mode) in switches {
            self.note(Happening::Switch(element, mode));
            let counters = &mut self.system.counters;
            counters.switches = counters.switches.saturating_add(1);
            if self.chatter.sees(self.time) {
                let model = &self.system.model;
                return Err(StepError::EventChatter {
                    line: name(model.scene(), model.layout(), element),
                    is_event: false,
                    count: MOST_SWITCHES,
                    window: self.chatter.window,
                });
            }
        }
        Ok(())
    }

    /// Adds the margins that vanish within the next 1e-12 s to the chosen ones, and leaves the guards of the accepted state in `scratch`.
    fn add_simultaneous(&mut self) -> Result<(), StepError> {
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)?;
        self.margins.before.copy_from_slice(&self.margins.now);
        let ahead = T::from_f64(TOGETHER);
        for (x, rate) in self.inside.iter_mut().zip(self.method.first()) {
            *x += ahead * *rate;
        }
        self.read_margins(self.time + TOGETHER, TOGETHER)?;
        for (index, chosen) in self.chosen.iter_mut().enumerate() {
            let (Some(now), Some(then)) =
                (self.margins.before.get(index), self.margins.now.get(index))
            else {
                continue;
            };
            // A margin that only hovers at zero in rounding is not falling.
            let falls = now - then > 1e-3 * self.margins.finest().min(1e-10);
            *chosen |= self.margins.is_element(index) && *then < 0.0 && falls;
        }
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)
    }

    /// Margins and sides at the accepted state, in the modes of now.
    pub(crate) fn begin_margins(
        &mut self,
        crossed: &mut dyn FnMut(usize),
    ) -> Result<(), StepError> {
        if self.margins.is_empty() {
            return Ok(());
        }
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)?;
        let guards = self.scratch.get(..self.guards).unwrap_or(&[]);
        self.margins.take_sides(self.time, guards, crossed);
        // The sides are part of the margins of declared events.
        self.margins.read(guards, self.system.modes());
        self.margins.start.copy_from_slice(&self.margins.now);
        Ok(())
    }

    /// The same on the sides that are known.
    pub(crate) fn resume_margins(&mut self) -> Result<(), StepError> {
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)?;
        self.margins.start.copy_from_slice(&self.margins.now);
        Ok(())
    }

    /// Declared events, of those that `of` names, whose guards start at their value, or pass it within what is one time with the start, have passed nothing:
    /// they are on the side that the motion takes them to.
    pub(crate) fn settle_sides(&mut self, of: &dyn Fn(usize) -> bool) -> Result<(), StepError> {
        if !self.margins.declares() {
            return Ok(());
        }
        let here = self.guards_here()?;
        self.look_ahead(TOGETHER)?;
        if !self.take_sides_of_last_look(of, &here) {
            // At rest: what its acceleration makes of it.
            self.look_along(AT_REST)?;
            self.take_sides_of_last_look(of, &here);
        }
        self.begin_sides()
    }

    /// What nothing but time moves and starts at its value comes from where it was before: `time rises t0` passes in a run from t0, and so does
    /// `time rises next` where the state `next` starts at t0.
    pub(crate) fn settle_clocks(&mut self, clocks: &[usize]) -> Result<(), StepError> {
        if clocks.is_empty() {
            return Ok(());
        }
        let here = self.guards_here()?;
        self.look_ahead(-TOGETHER)?;
        self.take_sides_of_last_look(&|index| clocks.contains(&index), &here);
        self.begin_sides()
    }

    /// The guards at the accepted state.
    fn guards_here(&mut self) -> Result<Vec<T>, StepError> {
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)?;
        let guards = self.scratch.get(..self.guards);
        Ok(guards.unwrap_or(&[]).to_vec())
    }

    /// Declared events whose guards are at their value here are on the side of the last look; whether these were all decided.
    fn take_sides_of_last_look(&mut self, of: &dyn Fn(usize) -> bool, here: &[T]) -> bool {
        let there = self.scratch.get(..self.guards).unwrap_or(&[]);
        self.margins.settle_sides(of, here, there)
    }

    /// Margins of the accepted state by the sides that were taken.
    fn begin_sides(&mut self) -> Result<(), StepError> {
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)?;
        self.margins.start.copy_from_slice(&self.margins.now);
        Ok(())
    }

    /// The margins of declared events whose guards nothing but time moves.
    pub(crate) fn clocks(&self) -> Vec<usize> {
        let declared = self.margins.declared().map(|(index, _)| index);
        declared
            .filter(|index| self.margins.is_clock(*index))
            .collect()
    }

    /// Reads the margins where the rates of now lead in a time [s].
    pub(crate) fn look_ahead(&mut self, ahead: f64) -> Result<(), StepError> {
        self.inside.copy_from_slice(&self.state);
        let step = T::from_f64(ahead);
        for (x, rate) in self.inside.iter_mut().zip(self.method.first()) {
            *x += step * *rate;
        }
        self.read_margins(self.time + ahead, ahead)
    }

    /// The same by the rates midway.
    pub(crate) fn look_along(&mut self, ahead: f64) -> Result<(), StepError> {
        self.look_ahead(0.5 * ahead)?;
        let mut rates = vec![T::zero(); self.inside.len()];
        let middle = self.inside.clone();
        self.system
            .rates(self.time + 0.5 * ahead, 0.5 * ahead, &middle, &mut rates)?;
        self.inside.copy_from_slice(&self.state);
        for (x, rate) in self.inside.iter_mut().zip(&rates) {
            *x += T::from_f64(ahead) * *rate;
        }
        self.read_margins(self.time + ahead, ahead)?;
        self.method
            .begin(&mut self.system, self.time, 0.0, &self.state)
    }

    /// Declared events whose guards are at their value where a run ends, or pass it within what is one time with the end: they happen there. Whether
    /// any acted.
    pub(crate) fn happen_at_end(&mut self) -> Result<bool, StepError> {
        if !self.margins.declares() {
            return Ok(false);
        }
        self.look_ahead(TOGETHER.max(self.resolved(0.0)))?;
        let happened = self.margins.happened() > 0;
        let mut crossed = std::mem::take(&mut self.crossed);
        crossed.clear();
        if happened {
            let guards = self.scratch.get(..self.guards).unwrap_or(&[]);
            self.margins
                .take_sides(self.time, guards, |event| crossed.push(event));
        }
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)?;
        self.margins.start.copy_from_slice(&self.margins.now);
        let before = self.event_count();
        for event in &crossed {
            self.note(Happening::Declared(*event));
        }
        let acted = self.act(&crossed);
        self.crossed = crossed;
        match acted {
            Ok(true) => self.begin_noting().map(|()| true),
            Ok(false) => Ok(false),
            Err(cause) => {
                self.forget_events(before);
                Err(cause)
            }
        }
    }
}
