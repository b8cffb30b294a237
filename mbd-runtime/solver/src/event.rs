//! Slack/taut switches and declared events: which quantity must keep its sign inside a step, and where it loses it.
//!
//! With all modes frozen a step is smooth. Every unilateral element and every declared event has one **margin** that is not negative while nothing
//! happens: of an element that of its mode (`unilateral`), in metres or radians; of a declared event its guard times the sign it has now.
//!
//! Rejected: taking the start of a step as a sign change (just after a switch a margin is ±0 there, and the search would stand still), and looking at
//! the end of a step only (a margin can leave and return inside it).

use mbd_scene::laws::LineNumbers;
use mbd_scene::{Direction, Float, Formula, Layout, Model, Place, Scene};

use crate::approach::FEW_LOOKS;
use crate::moving::moving;
use crate::rearm::Rearmed;
use crate::system::GuardSide;
use crate::unilateral::{Mode, is_node_line, switches};

/// What can happen inside a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Happening {
    /// An element switches: a line, by index, goes taut (`Active`), slack, or idle (taut without force); a stop, by its number in `Layout::stops` behind
    /// all lines, is touched (`Active`) or left: it pushes no more (`Slack`, or `Idle` where its damping ends the push before the depth is zero).
    Switch(usize, Mode),
    /// A declared event, by index.
    Declared(usize),
}

/// A located event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occurrence {
    /// When [s].
    pub time: f64,
    /// What.
    pub what: Happening,
}

/// What is looked at inside a step.
#[derive(Clone, Copy, Debug)]
enum WatchedGuard {
    /// A unilateral element; 1/K [m/N, for an angle 1/(N m)], whether it ends at a `rate` node, and what of its margin counts.
    Element {
        element: usize,
        softness: f64,
        at_node: bool,
        counts: Passing,
    },
    /// A declared event: its index and its place in the guards.
    Declared {
        event: usize,
        at: usize,
        direction: Direction,
        acts: bool,
        /// Whether its guard is of time alone.
        of_time: bool,
        /// Whether nothing but time moves its guard between events: a clock, whose alarm a state may be that events set.
        is_clock: bool,
    },
}

/// The part of what a guard changes between four looks that a parabola may be off by, and of its size that is rounding: in double precision, and in that of
/// the run over its digits. A guard that goes up and down by so little of its size does not pass.
const UNRESOLVED: f64 = 0.03;
const ROUNDED: f64 = 1e-9;
const ROUNDED_DIGITS: f64 = 1e3;
/// Where one of four looks is between two others that are a part apart: no simple fraction of it, so that nothing repeats as they do.
pub(crate) const BETWEEN: f64 = 0.414;

/// The margins of one scene.
#[derive(Clone, Debug)]
pub(crate) struct Margins {
    watched: Vec<WatchedGuard>,
    /// Whether each declared event's guard is positive now.
    pub sides: Vec<bool>,
    /// The same where they were kept.
    kept_sides: Vec<bool>,
    /// Per watched margin, of an event whose guard the joints hold at its value, what of it is rounding there (`held_guards`).
    pub held: Vec<Option<f64>>,
    /// Per watched margin, of an event that its own action armed again, when and where.
    pub rearmed: Vec<Rearmed>,
    /// How far a line's margin must be passed to count in this step, whatever its own tolerance [m].
    resolved: f64,
    /// The longest C/K of a watched line [s].
    pub delay: f64,
    /// Where the state holds places and velocities along which elements stretch.
    places: Vec<usize>,
    speeds: Vec<usize>,
    /// Margins at the start of the step, at the last two looks.
    pub start: Vec<f64>,
    pub before: Vec<f64>,
    pub now: Vec<f64>,
    /// At the look before these, and room for those of another look.
    pub earlier: Vec<f64>,
    latest: Vec<f64>,
    /// Room for those of several looks.
    pub looks: Vec<f64>,
    /// Whether an event that acts passes so close behind the last step that its end is of the same instant.
    pub acts_behind: bool,
}

/// Whether a guard follows from time, and from declared states without a rate, alone.
fn is_clock(scene: &Scene, guard: &Formula) -> bool {
    let moves = |part: &Formula| match part {
        Formula::State(state) => {
            let declared = scene.states.get(*state);
            declared.is_none_or(|state| !scene.is_zero(&state.rate))
        }
        _ => false,
    };
    scene.is_of_time_and_states(guard) && !scene.contains(guard, moves)
}

/// The longest C/K of some lines [s].
fn longest_delay<T: Float>(lines: &[LineNumbers<T>]) -> f64 {
    // A damper has none: it neither slackens nor creeps to a length.
    let elastic = lines.iter().filter(|n| n.stiffness > T::zero());
    let delays = elastic.map(|n| (n.damping / n.stiffness).to_f64());
    delays.fold(0.0, f64::max)
}

/// What of the margin of an element counts as passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passing {
    /// How far it is beyond zero at least [m or rad].
    pub floor: f64,
    /// Of one that carries also what is below that, for so long in one step [m s or rad s]: a damper that is said to push by less than its velocity is known may do so
    /// for a long time.
    pub lasting: f64,
}

/// Between what an element acts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Acting {
    /// Its places.
    pub ends: [Place; 2],
    /// Whether along a rotation.
    pub angle: bool,
    /// Whether it ends at an equilibrium point.
    pub at_node: bool,
    /// C/K [s].
    pub delay: f64,
}

impl Acting {
    fn new(scene: &Scene, layout: &Layout, element: usize, (at_node, delay): (bool, f64)) -> Self {
        let stop = |element: usize| {
            let stop = layout.stops.get(element.checked_sub(layout.lines.len())?)?;
            let (joint, coordinate) = scene.coordinate(stop.joint, stop.coordinate)?;
            Some(([joint.parent, joint.child], coordinate.is_angle()))
        };
        let line = scene.lines.get(element);
        let line = line.map(|line| ([line.from, line.to], false));
        let (ends, angle) = line
            .or_else(|| stop(element))
            .unwrap_or(([Place::World(0); 2], false));
        Acting {
            ends,
            angle,
            at_node,
            delay,
        }
    }
}

impl Margins {
    /// The margins of a model; none when nothing is to be located. `counts` says what of the margin of an element counts.
    pub(crate) fn new<T: Float>(
        model: &dyn Model<T>,
        locate: bool,
        counts: impl Fn(&Acting) -> Passing,
    ) -> Self {
        let (scene, layout) = (model.scene(), model.layout());
        let mut watched = Vec::new();
        for (element, numbers) in model.lines().iter().enumerate() {
            if locate && switches(model, element) {
                let at_node = is_node_line(layout, element);
                let delay = (numbers.damping / numbers.stiffness).to_f64();
                watched.push(WatchedGuard::Element {
                    element,
                    softness: 1.0 / numbers.stiffness.to_f64(),
                    at_node,
                    counts: counts(&Acting::new(scene, layout, element, (at_node, delay))),
                });
            }
        }
        let events = scene.events.iter().enumerate();
        watched.extend(
            events
                .filter(|_| locate)
                .map(|(event, declared)| WatchedGuard::Declared {
                    event,
                    at: 2 * layout.one_way() + event,
                    direction: declared.direction,
                    acts: declared.actions.changes(),
                    of_time: scene.is_of_time(&declared.guard),
                    is_clock: is_clock(scene, &declared.guard),
                }),
        );
        let count = watched.len();
        let turning = layout.stops.iter().any(|stop| {
            let found = scene.coordinate(stop.joint, stop.coordinate);
            found.is_some_and(|(_, coordinate)| coordinate.is_angle())
        });
        let mut places: Vec<usize> = (layout.nq + layout.nv..layout.states()).collect();
        let mut speeds = Vec::new();
        for part in moving(layout) {
            places.extend(part.position);
            speeds.extend(part.velocity);
            if turning {
                places.extend(part.attitude);
                speeds.extend(part.spin);
            }
        }
        Margins {
            watched,
            held: vec![None; count],
            rearmed: vec![Rearmed::default(); count],
            sides: vec![false; scene.events.len()],
            kept_sides: vec![false; scene.events.len()],
            resolved: 0.0,
            delay: longest_delay(model.lines()),
            places,
            speeds,
            start: vec![0.0; count],
            before: vec![0.0; count],
            now: vec![0.0; count],
            earlier: vec![0.0; count],
            latest: vec![0.0; count],
            looks: Vec::with_capacity((FEW_LOOKS + 1) * count),
            acts_behind: false,
        }
    }

    /// The stiffnesses, dampings and tolerances of other parameters.
    pub(crate) fn read_lines<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        counts: impl Fn(&Acting) -> Passing,
    ) {
        let (scene, layout) = (model.scene(), model.layout());
        for watched in &mut self.watched {
            if let WatchedGuard::Element {
                element,
                softness,
                at_node,
                counts: own,
            } = watched
                && let Some(numbers) = model.lines().get(*element)
            {
                let delay = (numbers.damping / numbers.stiffness).to_f64();
                *softness = 1.0 / numbers.stiffness.to_f64();
                *own = counts(&Acting::new(scene, layout, *element, (*at_node, delay)));
            }
        }
        self.delay = longest_delay(model.lines());
    }

    /// Raises the tolerance to what a step with this error resolves: an error of a place, and of a velocity through C ṡ/K. A smaller tolerance
    /// switches lines on the integrator's noise.
    pub(crate) fn resolve<T: Float>(&mut self, error: &[T]) {
        let largest = |list: &[usize]| {
            let sizes = list
                .iter()
                .filter_map(|at| error.get(*at))
                .map(|x| x.to_f64().abs());
            sizes.fold(0.0, f64::max)
        };
        self.resolved = largest(&self.places) + self.delay * largest(&self.speeds);
    }

    /// How far a margin must be passed to count, in this step [m or rad].
    fn tolerance(&self, index: usize) -> f64 {
        match self.watched.get(index) {
            Some(WatchedGuard::Element { counts, .. }) => counts.floor.max(self.resolved),
            _ => 0.0,
        }
    }

    /// The smallest of them among elements [m or rad].
    pub(crate) fn finest(&self) -> f64 {
        let floors = self.watched.iter().filter_map(|watched| match watched {
            WatchedGuard::Element { counts, .. } => Some(counts.floor.max(self.resolved)),
            WatchedGuard::Declared { .. } => None,
        });
        floors.fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.watched.is_empty()
    }

    /// Whether a line that is watched does not carry: then a step is looked into.
    pub(crate) fn restless(&self, modes: &[Mode]) -> bool {
        self.watched.iter().any(|watched| match watched {
            WatchedGuard::Element { element, .. } => {
                let mode = modes.get(*element);
                !matches!(mode, Some(Mode::Active | Mode::Detached))
            }
            WatchedGuard::Declared { .. } => false,
        })
    }

    /// Reads the margins from the value of `Quantity::Guards`.
    pub(crate) fn read<T: Float>(&mut self, guards: &[T], modes: &[Mode]) {
        let guard = |index: usize| guards.get(index).map_or(f64::NAN, |x| x.to_f64());
        let kept = self.held.iter().zip(&self.rearmed);
        let all = self.now.iter_mut().zip(&self.watched).zip(kept);
        for ((margin, watched), (held, rearmed)) in all {
            *margin = match *watched {
                WatchedGuard::Declared { .. } if held.is_some() => f64::INFINITY,
                WatchedGuard::Element {
                    element,
                    softness,
                    at_node,
                    ..
                } => {
                    let mode = modes.get(element).copied().unwrap_or(Mode::Slack);
                    let pull = guard(2 * element + 1) * softness;
                    mode.margin(guard(2 * element), pull, at_node)
                }
                WatchedGuard::Declared { event, at, .. } => {
                    let positive = self.sides.get(event).copied().unwrap_or(false);
                    let guard = guard(at) - rearmed.value;
                    // Where its own action armed it again, and until it moves on to the next number, it is at its value and has passed nothing.
                    match guard == 0.0 && rearmed.is_armed() {
                        true => 0.0,
                        false => side_margin(guard, positive),
                    }
                }
            };
        }
    }

    /// Whether a watched margin is passed: by more than the tolerance for a line, at all for a declared event.
    pub(crate) fn passed(&self, index: usize, margin: f64) -> bool {
        index < self.watched.len() && margin < -self.tolerance(index)
    }

    /// Whether a watched margin is that of an element which carries, and pushes at the end of a step of a size [s] for longer than counts.
    pub(crate) fn pushes(&self, index: usize, modes: &[Mode], step: f64) -> bool {
        let margin = self.now.get(index).copied().unwrap_or(0.0);
        match self.watched.get(index) {
            Some(WatchedGuard::Element {
                element, counts, ..
            }) => {
                let carries = matches!(modes.get(*element), Some(Mode::Active));
                carries && -margin * step > counts.lasting
            }
            _ => false,
        }
    }

    /// The smallest margin among those in `chosen`.
    pub(crate) fn smallest(&self, chosen: &[bool]) -> f64 {
        let margins = self.now.iter().zip(chosen).filter(|(_, chosen)| **chosen);
        margins
            .map(|(margin, _)| *margin)
            .fold(f64::INFINITY, f64::min)
    }

    /// What the passing of a margin means, given stretch and mode now.
    pub(crate) fn happening<T: Float>(
        &self,
        index: usize,
        guards: &[T],
        modes: &[Mode],
    ) -> Option<Happening> {
        match *self.watched.get(index)? {
            WatchedGuard::Declared { event, .. } => Some(Happening::Declared(event)),
            WatchedGuard::Element {
                element, softness, ..
            } => {
                let stretch = guards.get(2 * element)?.to_f64();
                let pull = guards.get(2 * element + 1)?.to_f64() * softness;
                let next = modes
                    .get(element)?
                    .next(stretch, pull, self.tolerance(index));
                Some(Happening::Switch(element, next))
            }
        }
    }

    /// Whether a margin is that of a unilateral element.
    pub(crate) fn is_element(&self, index: usize) -> bool {
        matches!(self.watched.get(index), Some(WatchedGuard::Element { .. }))
    }

    /// The margin of a declared event at the last three looks.
    pub(crate) fn declared_looks(&self, index: usize) -> Option<[f64; 3]> {
        if self.is_element(index) {
            return None;
        }
        let at = |list: &[f64]| list.get(index).copied();
        Some([at(&self.earlier)?, at(&self.before)?, at(&self.now)?])
    }

    /// Whether the margin of a declared event that moves is elsewhere at the last of four looks, a part of [`BETWEEN`] behind the first or the second of three
    /// that are a part apart, than the parabola through these says, by more than a part of what it changes: a guard that goes up and down between them.
    pub(crate) fn is_unresolved<T: Float>(&self, behind: f64) -> bool {
        let rounded = ROUNDED.max(ROUNDED_DIGITS * T::EPSILON.to_f64());
        let at = |list: &[f64], index: usize| list.get(index).copied().unwrap_or_default();
        let moving = self.watched.iter().enumerate().filter(|(index, watched)| {
            let declared = matches!(watched, WatchedGuard::Declared { of_time: false, .. });
            declared && self.held.get(*index).is_none_or(Option::is_none)
        });
        let x = behind + BETWEEN;
        moving.map(|(index, _)| index).any(|index| {
            let looks = [&self.latest, &self.earlier, &self.before, &self.now];
            let [start, one, two, between] = looks.map(|list| at(list, index));
            let all = [start, one, two, between];
            let most = all.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let least = all.into_iter().fold(f64::INFINITY, f64::min);
            let ends = (x - 1.0) * (0.5 * (x - 2.0) * start + 0.5 * x * two);
            let off = (between - ends - x * (2.0 - x) * one).abs();
            off > UNRESOLVED * (most - least) && off > rounded * most.abs().max(least.abs())
        })
    }

    /// Whether a watched margin is of a guard that nothing but time moves between events.
    pub(crate) fn is_clock(&self, index: usize) -> bool {
        let watched = self.watched.get(index);
        matches!(watched, Some(WatchedGuard::Declared { is_clock: true, .. }))
    }

    /// The margins at the start of the step as the first of four looks, or else those of the last look.
    pub(crate) fn begin_looks(&mut self, at_start: bool) {
        let first = if at_start { &self.start } else { &self.now };
        self.latest.copy_from_slice(first);
    }

    /// Keeps the margins of the last look, and takes them again.
    pub(crate) fn keep_latest(&mut self) {
        self.latest.copy_from_slice(&self.now);
    }

    pub(crate) fn take_latest(&mut self) {
        self.now.copy_from_slice(&self.latest);
    }

    /// Whether a declared event is watched.
    pub(crate) fn declares(&self) -> bool {
        let declared = |watched: &WatchedGuard| matches!(watched, WatchedGuard::Declared { .. });
        self.watched.iter().any(declared)
    }

    /// The declared events: the place of the margin, and that of the guard among the guards.
    pub(crate) fn declared(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let watched = self.watched.iter().enumerate();
        watched.filter_map(|(index, watched)| match *watched {
            WatchedGuard::Declared { at, .. } => Some((index, at)),
            WatchedGuard::Element { .. } => None,
        })
    }

    /// The sides of all declared events whose guards are not held.
    pub(crate) fn sides_of_events(&self) -> impl Iterator<Item = GuardSide> + '_ {
        self.declared().filter_map(|(index, at)| {
            let event = self.event_of(index)?;
            let is_held = self.held.get(index)?.is_some();
            (!is_held).then_some(GuardSide {
                at,
                value: self.rearmed.get(index)?.value,
                positive: *self.sides.get(event)?,
            })
        })
    }

    /// The declared event of a margin.
    pub(crate) fn event_of(&self, index: usize) -> Option<usize> {
        match *self.watched.get(index)? {
            WatchedGuard::Declared { event, .. } => Some(event),
            WatchedGuard::Element { .. } => None,
        }
    }

    /// What counts as zero of the guard of an event.
    pub(crate) fn zero_of(&self, event: usize) -> f64 {
        let mut declared = self.declared();
        let own = declared.find(|(index, _)| self.event_of(*index) == Some(event));
        let rearmed = own.and_then(|(index, _)| self.rearmed.get(index));
        rearmed.map_or(0.0, |rearmed| rearmed.value)
    }

    /// Puts a declared event back on the side that it came from.
    pub(crate) fn rearm(&mut self, index: usize, at: Rearmed) {
        let event = self.event_of(index);
        let side = event.and_then(|event| self.sides.get_mut(event));
        if let (Some(side), Some(rearmed)) = (side, self.rearmed.get_mut(index)) {
            *side = !*side;
            *rearmed = at;
        }
    }

    /// When a declared event was armed again by its own action last, and how long its guard takes to leave its value [s].
    pub(crate) fn rearmed_at(&self, event: usize) -> Option<[f64; 2]> {
        let own = (0..self.watched.len()).find(|&index| self.event_of(index) == Some(event));
        let rearmed = self.rearmed.get(own?)?;
        let armed = rearmed.time.filter(|_| rearmed.is_armed());
        armed.map(|time| [time, rearmed.instant])
    }

    /// Whether the joints hold the guard of a declared event at its value.
    pub(crate) fn is_held(&self, index: usize) -> bool {
        self.held.get(index).is_some_and(Option::is_some)
    }

    /// Says whether they do, and what of it is rounding then.
    pub(crate) fn hold(&mut self, index: usize, rounding: Option<f64>) {
        if let Some(held) = self.held.get_mut(index) {
            *held = rounding;
        }
    }

    /// Lets go of a guard that was held: it is at its value, and the noise of its evaluation is none of its motion.
    pub(crate) fn release(&mut self, index: usize, (time, guard): (f64, f64)) {
        let held = self.held.get_mut(index).and_then(Option::take);
        if let (Some(rounding), Some(rearmed)) = (held, self.rearmed.get_mut(index)) {
            *rearmed = Rearmed {
                time: Some(time),
                rounding,
                value: guard,
                instant: 0.0,
                beyond: false,
            };
        }
    }

    /// Sets those declared events that `of` names on the side that their guards go to from a start at their value: `later` are the guards a little
    /// later. Whether all of these are decided.
    pub(crate) fn settle_sides<T: Float>(
        &mut self,
        of: &dyn Fn(usize) -> bool,
        guards: &[T],
        later: &[T],
    ) -> bool {
        let mut decided = true;
        for (index, watched) in self.watched.iter().enumerate() {
            let WatchedGuard::Declared { event, at, .. } = *watched else {
                continue;
            };
            if !of(index) {
                continue;
            }
            let value = self.rearmed.get(index).map_or(0.0, |it| it.value);
            let guard = |list: &[T]| list.get(at).map_or(f64::NAN, |x| x.to_f64() - value);
            let (now, then) = (guard(guards), guard(later));
            let leaves = now == 0.0 || (now > 0.0) != (then > 0.0);
            if let Some(side) = self.sides.get_mut(event).filter(|_| leaves) {
                *side = then > 0.0;
                decided &= then != 0.0;
            }
        }
        decided
    }

    /// Keeps the sides of declared events as they are now.
    pub(crate) fn keep_sides(&mut self) {
        self.kept_sides.copy_from_slice(&self.sides);
    }

    /// Whether some are others than those that were kept.
    pub(crate) fn have_passed(&self) -> bool {
        self.kept_sides != self.sides
    }

    /// Whether a declared event that nothing holds is on another side than the one that was kept, and was not armed again.
    pub(crate) fn has_passed(&self, index: usize) -> bool {
        let event = self.event_of(index);
        let sides = event.map(|event| [&self.sides, &self.kept_sides].map(|all| all.get(event)));
        sides.is_some_and(|[now, kept]| now != kept) && !self.is_held(index)
    }

    /// Moves what counts as the value of a guard away from it by what of it is rounding: it has passed, and is back by more than that only.
    pub(crate) fn clear_rounding(&mut self, index: usize, rounding: f64) {
        let event = self.event_of(index);
        let side = event.and_then(|event| self.sides.get(event));
        if let (Some(positive), Some(rearmed)) = (side, self.rearmed.get_mut(index)) {
            rearmed.value = if *positive { -rounding } else { rounding };
        }
    }

    /// Moves what counts as the value of a guard that was let go by the noise of its evaluation, a part of what was rounding while it was held, away from
    /// the side that the motion takes it to.
    pub(crate) fn clear_noise(&mut self, index: usize, part: f64) {
        let side = self.event_of(index).and_then(|event| self.sides.get(event));
        if let (Some(&positive), Some(rearmed)) = (side, self.rearmed.get_mut(index)) {
            let noise = part * rearmed.rounding;
            rearmed.value -= if positive { noise } else { -noise };
        }
    }

    /// Whether an event is watched that acts.
    pub(crate) fn acts(&self) -> bool {
        let acts =
            |watched: &WatchedGuard| matches!(watched, WatchedGuard::Declared { acts: true, .. });
        self.watched.iter().any(acts)
    }

    /// Whether several events are watched of which some act.
    pub(crate) fn may_act_together(&self) -> bool {
        let declared = |watched: &&WatchedGuard| matches!(watched, WatchedGuard::Declared { .. });
        self.acts() && self.watched.iter().filter(declared).count() > 1
    }

    /// Whether a declared event is at its value at the last look.
    pub(crate) fn are_at_value(&self) -> bool {
        let mut declared = self.declared();
        declared.any(|(index, _)| self.now.get(index) == Some(&0.0))
    }

    /// Whether a declared event passes within a part of another step like the one that was looked at; with none of it: whether one came to its value.
    pub(crate) fn are_close(&self, part: f64) -> bool {
        let mut declared = self.declared();
        declared.any(|(index, _)| self.is_close(index, part))
    }

    /// The same of those that act.
    pub(crate) fn act_close(&self, part: f64) -> bool {
        let mut watched = self.watched.iter().enumerate();
        watched.any(|(index, watched)| {
            matches!(watched, WatchedGuard::Declared { acts: true, .. })
                && self.is_close(index, part)
        })
    }

    fn is_close(&self, index: usize, part: f64) -> bool {
        let at = |list: &[f64]| list.get(index).copied().unwrap_or(f64::INFINITY);
        let (start, end) = (at(&self.start), at(&self.now));
        start > 0.0 && start.is_finite() && end <= part * (start - end)
    }

    /// How many declared events have passed at the last look.
    pub(crate) fn happened(&self) -> usize {
        let declared = self.watched.iter().zip(&self.now);
        let passed = declared.filter(|(watched, now)| {
            matches!(watched, WatchedGuard::Declared { .. }) && **now < 0.0
        });
        passed.count()
    }

    /// Whether an event that acts has passed at the last look.
    pub(crate) fn about_to_act(&self) -> bool {
        let mut declared = self.watched.iter().zip(&self.now);
        declared.any(|(watched, now)| {
            matches!(watched, WatchedGuard::Declared { acts: true, .. }) && *now < 0.0
        })
    }

    /// Sets the side of every declared event from the guards, and reports through `crossed` those that changed in a direction that counts.
    pub(crate) fn take_sides<T: Float>(
        &mut self,
        time: f64,
        guards: &[T],
        mut crossed: impl FnMut(usize),
    ) {
        let kept = self.held.iter_mut().zip(&self.rearmed);
        for (watched, (held, rearmed)) in self.watched.iter().zip(kept) {
            let WatchedGuard::Declared {
                event,
                at,
                direction,
                ..
            } = *watched
            else {
                continue;
            };
            let guard = guards.get(at).map_or(f64::NAN, |guard| guard.to_f64());
            let guard = guard - rearmed.value;
            let just_now = rearmed.time == Some(time);
            let rounding = [just_now.then_some(rearmed.rounding), *held];
            let mut rounding = rounding.iter().flatten();
            if rounding.any(|rounding| guard.abs() <= *rounding) {
                continue;
            }
            // What jumps away from its value is held there no more.
            *held = None;
            let positive = guard > 0.0;
            let Some(side) = self.sides.get_mut(event) else {
                continue;
            };
            if *side != positive {
                *side = positive;
                let counts = match direction {
                    Direction::Crosses => true,
                    Direction::Rises => positive,
                    Direction::Falls => !positive,
                };
                if counts {
                    crossed(event);
                }
            }
        }
    }
}

/// The distance to the other side; a guard at zero is on the negative side.
fn side_margin(guard: f64, positive: bool) -> f64 {
    match positive {
        true if guard > 0.0 => guard,
        // Zero is already the other side: just passed.
        true => guard.min(-f64::MIN_POSITIVE),
        false => -guard,
    }
}
