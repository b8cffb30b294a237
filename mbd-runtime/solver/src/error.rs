//! What can go wrong in a run: typed, in the names of the declaration, with what to do about it.
//!
//! Nothing here resets or alters a state: after an error the simulation holds its last accepted step, equal to the bit to the same run stopped
//! there, and may go on after repair.

mod cause;
mod progress;

use std::error::Error;
use std::fmt;

use mbd_scene::joints::Fold;
use mbd_scene::{ParamError, plain};

use crate::node::UNEVEN;
use crate::trajectory::Trajectory;
use crate::watch::Instability;

pub use cause::{Collapse, Source, Stiff, UnevenLines};
pub use progress::{Progress, RunError, Statistics};

/// Declares the errors of a step, each with its name in tables, its sentence and its advice.
macro_rules! step_errors {
    ($(
        $(#[$doc:meta])*
        $name:ident $({ $($(#[$field_doc:meta])* $field:ident: $type:ty,)* })?
        $status:literal, $sentence:expr, $advice:expr;
    )*) => {
        /// What went wrong in a step.
        #[derive(Clone, PartialEq)]
        #[non_exhaustive]
        pub enum StepError {
            $($(#[$doc])* $name $({ $($(#[$field_doc])* $field: $type,)* })?,)*
        }

        /// What `derive(Debug)` writes. That is compiled again in every crate that asks for it, as one with `?` in its `main` does.
        impl fmt::Debug for StepError {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    $(StepError::$name $({ $($field),* })? => f.debug_struct(stringify!($name))$($(.field(stringify!($field), $field))*)?.finish(),)*
                }
            }
        }

        #[allow(unused_variables, reason = "not every sentence names every number")]
        impl StepError {
            /// The name of this kind of failure in tables: `non_finite`, `step_underflow`, ….
            #[must_use]
            pub fn status(&self) -> &'static str {
                match self {
                    $(StepError::$name { .. } => $status,)*
                }
            }

            /// One sentence of advice.
            #[must_use]
            pub fn advice(&self) -> String {
                match self {
                    $(StepError::$name $({ $($field),* })? => $advice.into(),)*
                }
            }

            /// What happened, in one sentence.
            fn sentence(&self) -> String {
                match self {
                    $(StepError::$name $({ $($field),* })? => $sentence,)*
                }
            }
        }
    };
}

step_errors! {
    /// A number from the caller that cannot be used, refused before any step.
    InvalidInput {
        /// Its name: a coordinate, an option, a line.
        slot: String,
        /// The number.
        value: f64,
    }
    "range", format!("`{slot}` cannot be {}", plain(*value, 6)), "give a finite number in the accepted range";

    /// A list from the caller that is too long or too short, refused before any step.
    Length {
        /// What it was given as: `state`, `inputs`.
        list: String,
        /// How many numbers it has in this model.
        expected: usize,
        /// How many were given.
        found: usize,
    }
    "length", format!("{list}: {found} numbers were given, and it has {expected} in this model"), "give as many as the model has";

    /// A time before that of the run.
    Backwards {
        /// That of the run [s].
        now: f64,
        /// The one that was asked for [s].
        until: f64,
    }
    "backwards", format!("a run that is at {} s does not go back to {} s", plain(*now, 12), plain(*until, 12)), "restore a snapshot from before, or set a state with its time";

    /// Params that cannot be run; the run keeps the old ones.
    Params {
        /// The first that cannot, and why.
        error: ParamError,
    }
    "params", error.to_string(), "give values that the declaration allows";

    /// A start in joint coordinates that places no bodies.
    Unplaced {
        /// The joint, or the name that was given.
        name: String,
        /// What is wrong with it.
        why: String,
    }
    "start", format!("`{name}` {why}"), "give coordinates that do not decide each other, and at which the loops can close";

    /// A start that whoever says how the run begins cannot give it, refused before any step.
    Refused {
        /// What of it cannot be: a constraint, `start.pin.angle`.
        setting: String,
        /// Why, and what to write.
        why: String,
    }
    "start", format!("`{setting}`: {why}"), "change this setting, or leave the case out";

    /// A name from the caller that there is not.
    UnknownName {
        /// The name.
        name: String,
        /// What it is none of, and what there is.
        why: String,
    }
    "name", format!("`{name}` {why}"), "give a name that the declaration has";

    /// A body or a point of a model that takes over, which the run before does not have.
    StartsNowhere {
        /// Its name.
        name: String,
        /// The model that takes over.
        model: String,
    }
    "start", format!("`{name}` is new in `{model}` and starts nowhere"), "declare where it starts, or give its numbers to `take_over`; what had another name is mapped in the event, `map: [new = old]`";

    /// A closure of the caller, a controller or what watches the run, panicked in an earlier call: what the run remembers is that of the middle of a
    /// step, and nothing goes on from there.
    Interrupted
    "interrupted", "a run in which a closure of the caller panicked does not go on".to_owned(), "make a new simulation and restore a snapshot from before into it; a closure that may fail gives NaN, which ends the run with an error";

    /// An output that was asked for by its name, and has no number.
    NoOutput {
        /// The name that was given.
        name: String,
        /// What is wrong with it.
        why: String,
    }
    "output", format!("`{name}` {why}"), "name an output of the declaration; where it says `emit`, `outputs` stands among what is emitted";

    /// A motor or a wound line is told a motion that contradicts itself: its value does not change as its rate says, or its rate not as its
    /// acceleration says.
    Command {
        /// The coordinate of the motor, `rail.slide`, or the length of the line, `rope.free_length`.
        motor: String,
        /// When [s].
        time: f64,
        /// `value` or `rate`.
        what: &'static str,
        /// Its change [m, rad, or per second].
        change: f64,
        /// The change that its own rate tells.
        expected: f64,
    }
    "command",
    format!("the {what} that `{motor}` follows changes by {change} at {time} s where its own rate says {expected}", change = plain(*change, 4), expected = plain(*expected, 4), time = plain(*time, 10)),
    "give the derivatives of the value as rate and acceleration (inputs: as functions of time, `Simulation::control`), or let the motor follow one input through a filter, `motor: wish, filter: 20 ms`, and wind the line by a state, `state paid = 5 m { rate: winch_speed }`";

    /// A motion that is prescribed as a function of time jumps, or its rate does where joints would have to carry bodies along by an impulse.
    Jump {
        /// The coordinate of a motor, `rail.slide`, a frame, `world.road`, or the length of a line, `rope.free_length`.
        of: String,
        /// When [s].
        time: f64,
        /// `value` or `rate`.
        what: &'static str,
        /// By how much [`unit`].
        change: f64,
        /// `m`, `rad`, `m/s` or `rad/s`; empty of the rotation of a frame, which is a matrix.
        unit: &'static str,
    }
    "jump",
    format!("the {what} that `{of}` is prescribed jumps by {} at {time} s", format!("{} {unit}", plain(*change, 4)).trim_end(), time = plain(*time, 10)),
    "join its parts without corners, with `smoothstep` or powers of `time`, or let a motor follow it through a filter, `motor: …, filter: 20 ms`";

    /// A line that is wound in has nothing left: its free length would be negative.
    NegativeLength {
        /// The line.
        line: String,
        /// When [s].
        time: f64,
        /// The free length that it would have [m].
        length: f64,
    }
    "negative_length",
    format!("at {time} s `free_length` of `{line}` is {length} m, and must be zero or positive", length = plain(*length, 4), time = plain(*time, 10)),
    format!("stop the winch before: `event wound_in = {line}.length falls 0.1 m {{ then: stop }}`, a `rate` that is zero there, or `max(…, 0 m)` in the `free_length`");

    /// A spring that pushes or pulls where both its ends are at the same place, at a start: which way, nothing says.
    NoDirection {
        /// The spring.
        spring: String,
        /// When [s].
        time: f64,
        /// Its force, negative where it pushes [N].
        force: f64,
    }
    "no_direction",
    format!("at {time} s both ends of `{spring}` are at the same place, and its force of {force} N has no direction", force = plain(*force, 4), time = plain(*time, 10)),
    "let what is at one of its ends start elsewhere, `start at [0.0, 0.0, -1.0] m`, or end it at another frame";

    /// A joint came to where its rows have no rank and hold on other positions, too: which way it goes on from there they do not say.
    FoldedJoint {
        /// The joint.
        joint: String,
        /// When [s].
        time: f64,
        /// Where that is.
        fold: Fold,
    }
    "folded_joint", format!("at {time} s `{joint}` {}", fold.told, time = plain(*time, 10)), fold.remedy;

    /// A number that became infinite or NaN.
    NonFinite {
        /// When [s].
        time: f64,
        /// What.
        source: Source,
    }
    "non_finite", format!("at {time} s {source}", time = plain(*time, 10)), source.advice();

    /// The balance of an equilibrium point was not found; no force was used.
    NoEquilibrium {
        /// The point.
        point: String,
        /// When [s].
        time: f64,
        /// What is left of the balance [N].
        residual_n: f64,
        /// Iterations spent.
        iterations: u64,
        /// The lines of its network whose stiffnesses are furthest apart, where that is too far.
        uneven: Option<Box<UnevenLines>>,
    }
    "newton_not_converged",
    match uneven {
        None => format!("at {time} s no equilibrium of `{point}` was found: {residual_n} N left after {iterations} iterations", residual_n = plain(*residual_n, 4), time = plain(*time, 10)),
        Some(lines) => format!("at {time} s no equilibrium of `{point}` was found: {residual_n} N left after {iterations} iterations, and {lines}", residual_n = plain(*residual_n, 4), time = plain(*time, 10)),
    },
    match uneven {
        None => "take a smaller step, or bring the stiffnesses of the lines of this point closer together; where an event detached what held it against its load, give the point a mass, or stop the run there".into(),
        Some(lines) => format!("make `{}` softer or `{}` stiffer, until they differ by less than a factor of {UNEVEN:.0e}, or give the points between them a mass", lines.stiffest, lines.softest),
    };

    /// The step fell below what time can resolve, or ten trials in a row were rejected.
    StepCollapse {
        /// When [s].
        time: f64,
        /// The last step tried [s].
        step_size: f64,
        /// The part of the state with the largest error.
        block: String,
        /// Why.
        cause: Collapse,
    }
    "step_underflow",
    match cause {
        Collapse::Resolution => format!("at {time} s the next step is {step_size} s: {cause} (`{block}`)", step_size = plain(*step_size, 4), time = plain(*time, 10)),
        Collapse::ErrorTest | Collapse::Event => format!("at {time} s the step shrank to {step_size} s: {cause} (`{block}`)", step_size = plain(*step_size, 4), time = plain(*time, 10)),
    },
    match cause {
        Collapse::ErrorTest => "loosen the tolerance, or look for a jump in a load and declare it as an event",
        Collapse::Event => "look for a load without a limit near this time",
        Collapse::Resolution => "take a longer step, let time begin near zero, or look for a number that is far too large",
    };

    /// A line or a stop switches, or an event acts, without end.
    EventChatter {
        /// The line, the stop or the event.
        line: String,
        /// Whether it is an event, which acts, and not a line or a stop, which switches.
        is_event: bool,
        /// Switches and actions counted in the window.
        count: usize,
        /// The window [s].
        window: f64,
    }
    "event_limit",
    {
        let times = match (is_event, count) {
            (true, 2) => "acts, and happens again at once: twice".to_owned(),
            (true, _) => format!("goes on without end: with it events acted and lines switched {count} times"),
            (false, _) => format!("goes on without end: with it lines and stops switched and events acted {count} times"),
        };
        match *window > 0.0 {
            true => format!("`{line}` {times} within {} s", plain(*window, 4)),
            false => format!("`{line}` {times} at one instant"),
        }
    },
    match is_event {
        true => "where bounces get shorter without end, as those of a ball that comes to rest, say what holds then: another event that locks it or ends the run (`then: stop`), or a stop with stiffness and damping instead of the event; otherwise let it act `acts: once`, or leave more room between what it sets and what it waits for",
        false => "a line or a stop is too stiff for the mass that bounces on it: give it more damping, declare it rigid, or make the point massless; where it has much damping, take a method for stiff systems: `rodas5p`, `auto`",
    };

    /// An event cannot do what it says. The run stands at its instant, before it acted.
    Action {
        /// The event.
        event: String,
        /// When [s].
        time: f64,
        /// What is wrong.
        why: String,
    }
    "action",
    format!("at {time} s the event `{event}` cannot act: {why}", time = plain(*time, 10)),
    "change what it sets or attaches, or let the event happen elsewhere";

    /// The fixed step is too long for what it has to follow. The run stands where nothing had grown yet, and may go on from there, as from a
    /// snapshot, with a shorter step.
    UnstableStep {
        /// When it showed [s].
        time: f64,
        /// The step [s].
        step_size: f64,
        /// What shows it.
        what: Instability,
        /// A step that should do [s].
        suggestion: f64,
    }
    "unstable_step",
    format!("the fixed step {step_size} s is too long: {what}, at {time} s", step_size = plain(*step_size, 4), time = plain(*time, 10)),
    format!("take a fixed step of at most {suggestion} s, or an adaptive method", suggestion = plain(*suggestion, 4));

    /// Positions are so far from the world origin that what they differ by has no digits left.
    FarFromOrigin {
        /// The body or the point.
        part: String,
        /// Its largest coordinate [m].
        distance: f64,
        /// What rounding makes of what accelerates it, or of an arm of its joints.
        share: f64,
    }
    "lost_digits",
    format!("`{part}` is {distance} m from the world origin, where rounding of positions alone makes {:.0} % of its forces", 100.0 * share.min(1.0), distance = plain(*distance, 2)),
    "let the origin go along with what moves (`origin: follows NAME;`), put the world origin near it (`gravity: point_mass` takes the place of its planet as `center`), or run in double precision";

    /// A time that has no digits left where formulas read it: in single precision, late.
    LateTime {
        /// When [s].
        time: f64,
        /// How far apart times are there that formulas tell apart [s].
        apart: f64,
        /// What that makes of accelerations and rates of states.
        share: f64,
    }
    "late_time",
    format!("at {time} s formulas know the time to {apart} s, which alone makes {:.0} % of what follows it", 100.0 * share.min(1.0), apart = plain(*apart, 2), time = plain(*time, 10)),
    "let time begin near zero, or run in double precision";

    /// An angle or a declared state that has grown until it has no digits left of what it is read for, or a number whose steps are lost to rounding.
    LargeState {
        /// The number of the state.
        state: String,
        /// Its unit; empty for a pure number.
        unit: String,
        /// Its value.
        value: f64,
        /// How far apart numbers are there, or what rounding took from it by many steps, if that is more.
        apart: f64,
        /// What suffers by it.
        affected: String,
        /// What that makes, as a part of what suffers.
        share: f64,
    }
    "large_state",
    format!("`{state}` is {value}, known to {apart} there, which alone makes {:.0} % of {affected}", 100.0 * share.min(1.0), value = format!("{} {unit}", plain(*value, 3)).trim_end(), apart = plain(*apart, 2)),
    "let it stay small: an event may set a phase back (`set: phase = phase - 2 * pi`), or two states be its sine and cosine; take longer steps where those are lost; or run in double precision";

    /// A history has no room for the rows that are asked for; the state is the last accepted step, and the rows so far are kept.
    LongHistory {
        /// The rows that were asked for, as far as that is known: of every step, those that there are.
        rows: f64,
        /// The columns of each.
        columns: usize,
    }
    "long_history",
    format!("a history of {rows} rows with {columns} columns was asked for, and at most {:.0e} numbers fit into one", Trajectory::MOST_NUMBERS, rows = plain(*rows, 2)),
    "write rows further apart or fewer columns, or record in parts and `clear` the history between them";

    /// The step budget of one call is used up.
    TooManySteps {
        /// The budget.
        steps: u64,
        /// What made the steps small, where it was stiffness met by an explicit method.
        stiff: Option<Box<Stiff>>,
    }
    "too_many_steps",
    match stiff {
        None => format!("{steps} steps were not enough"),
        Some(stiff) => format!("{steps} steps were not enough: {stiff}"),
    },
    match stiff {
        None => "raise the budget `max_steps`, or loosen the tolerance",
        Some(_) => "take a method for stiff systems: `rodas5p`, or `auto`, which takes it where it pays (`Options::rodas5p`, `Options::auto`)",
    };

    /// The caller's `go on` said no, at a step boundary or at a row inside a step.
    Cancelled
    "cancelled", "the run was cancelled".into(), "run again: the state is the last accepted step";

    /// The joints cannot be satisfied from the given state.
    InconsistentStart {
        /// The largest row that is left [m or 1].
        norm: f64,
        /// The joints furthest from holding, and by how much in which unit, largest first.
        rows: Vec<(String, f64, &'static str)>,
    }
    "inconsistent_start",
    format!("the joints do not hold at the start: {}", open(rows)),
    "give a joint of each of their loops a start near which it closes (`start: 30 deg`, `[run.start]`, `set_joints`); where nothing closes it, change a length or a frame of the loop, or take away joints that contradict each other";

    /// The joints hold, but on a root of their rows that is not the joint: an axis points the other way, or axes are exchanged.
    WrongBranch {
        /// The joints.
        joints: Vec<String>,
    }
    "wrong_branch",
    format!("at the start {} would hold only turned around", listed(joints)),
    "turn the bodies at these joints so that the axes of both sides agree";

    /// Bodies without mass carry nothing that gives one of their joints an inertia, at a start, or where a run came to.
    NoInertia {
        /// When [s].
        time: f64,
        /// The speed whose acceleration is not determined.
        speed: String,
        /// The joints that close loops on bodies without mass, by rows of their own, with these bodies.
        loops: Vec<[String; 2]>,
    }
    "no_inertia",
    format!("at {time} s nothing gives `{speed}` an inertia: the bodies that it moves have no mass, or moments that are not positive, or other joints move them alike{}", closing(loops), time = plain(*time, 10)),
    "give one of these bodies a mass and moments of inertia, however small, or lock a joint (`rigid`) whose axis another one repeats";

    /// Rows of joints repeat each other, for good or in this configuration: the forces in them are not determined.
    SingularConstraints {
        /// When [s].
        time: f64,
        /// Number of independent rows.
        rank: usize,
        /// Number of rows.
        rows: usize,
        /// The joints that take part; empty when the rows are independent but their system is too badly conditioned.
        joints: Vec<String>,
    }
    "singular_constraints",
    match joints.is_empty() {
        true => format!("at {time} s the joint forces cannot be solved ({rank} of {rows} rows are independent)", time = plain(*time, 10)),
        false => format!("at {time} s {} repeat each other: {rank} of {rows} rows are independent", listed(joints), time = plain(*time, 10)),
    },
    match joints.is_empty() {
        true => "where the mechanism passes a position in which its rows repeat each other (bars in one line), take `tsit5` or `vern7`, which pass it; else bring the masses closer together, or measure lengths in a unit of the size of the mechanism",
        false => "replace one of these joints by one that forbids less (a hinge by a spherical joint, a weld by nothing), or start away from this configuration; where the mechanism only passes it (bars in one line), take `tsit5`, `vern7` or `auto`, which pass it: `rodas5p` follows how forces in joints change beside their motion, and there that has no bound",
    };

    /// Masses so uneven that no way of solving the rows keeps three digits of the accelerations.
    IllConditioned {
        /// When [s].
        time: f64,
        /// Decimal digits lost.
        loss_digits: u64,
        /// The strategy they were lost on, as in [`Statistics::rows_strategy`].
        strategy: u64,
        /// The largest mass over the smallest.
        ratio: f64,
    }
    "ill_conditioned",
    format!("at {time} s the accelerations lose {loss_digits} digits: masses differ by a factor of {ratio}", ratio = plain(*ratio, 2), time = plain(*time, 10)),
    "bring the masses closer together, leave out bodies that weigh nothing beside the others, or run in f64 where this is f32";

    /// A step moved the joints so far apart that the projection did not bring them together.
    JointsApart {
        /// When [s].
        time: f64,
        /// The largest row that is left [m or 1].
        norm: f64,
        /// The joints furthest from holding, and by how much in which unit, largest first.
        rows: Vec<(String, f64, &'static str)>,
    }
    "joints_apart",
    format!("at {time} s the joints came apart: {}", open(rows), time = plain(*time, 10)),
    "take a smaller step";

    /// Motors have driven a loop as far as its lengths let it go: a dead centre.
    BeyondReach {
        /// When [s].
        time: f64,
        /// The coordinates that motors drive there.
        motors: Vec<String>,
        /// The joint that would come apart beyond.
        joint: String,
    }
    "beyond_reach",
    format!("at {time} s the motor of {} has driven its loop as far as it reaches: beyond, `{joint}` comes apart, whatever the other coordinates are", listed(motors), time = plain(*time, 10)),
    "let the course of the motor turn back before, change the lengths of the loop so that it goes on, or drive it by a `force` in place of a `motor`";

    /// A combination this runtime does not offer.
    Unsupported {
        /// What was asked for.
        what: String,
        /// What to take instead.
        instead: String,
    }
    "unsupported", format!("{what} is not supported"), instead.as_str();
}

/// The largest | |q| − 1 | of a quaternion that is given.
const LARGEST_DEVIATION: f64 = 1e-3;

impl StepError {
    /// A list of a wrong length.
    pub(crate) fn length(list: &str, found: usize, expected: usize) -> Self {
        let list = list.to_owned();
        StepError::Length {
            list,
            expected,
            found,
        }
    }

    /// A quaternion that is given with this | |q| − 1 |, if that is more than rounding and a few digits.
    pub(crate) fn quaternion(deviation: f64) -> Option<Self> {
        let slot = "deviation of a quaternion from unit length".into();
        let value = deviation;
        (deviation > LARGEST_DEVIATION).then_some(StepError::InvalidInput { slot, value })
    }
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence())
    }
}

impl Error for StepError {}

impl From<ParamError> for StepError {
    fn from(error: ParamError) -> Self {
        StepError::Params { error }
    }
}

/// `a`, `b`, `c`.
fn listed(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

/// What loops have to do with a speed without inertia.
fn closing(loops: &[[String; 2]]) -> String {
    let told = loops.iter().map(|[joint, body]| {
        format!(
            "; `{joint}` closes a loop on `{body}` by rows, which give no inertia: a joint with coordinates that is neither `loop` nor detached by an event gives `{body}` that of what is joined to it, and a body between two ball joints, or in a plane two hinges, is one `distance`"
        )
    });
    told.collect()
}

/// By how much joints stay open.
fn open(rows: &[(String, f64, &'static str)]) -> String {
    let told = rows
        .iter()
        .map(|(name, size, unit)| format!("`{name}` stays open by {} {unit}", plain(*size, 4)));
    told.collect::<Vec<String>>().join(", ")
}
