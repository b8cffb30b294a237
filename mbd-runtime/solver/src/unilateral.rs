//! Unilateral elements: lines that slacken and stops of joints, one list (`Layout::unilateral`): lines first, then stops.
//!
//! Between located events an element keeps its mode; a guard ends it:
//!
//! ```text
//! slack     s = 0 upwards        → active        (the force jumps up by C ṡ)
//! active    pull = 0 downwards   → idle,         s = 0 downwards → slack
//! idle      pull = 0 upwards     → active,       s = 0 downwards → slack           pull = f(s) + C ṡ
//! detached  until an event attaches it; the element is not there, whatever its stretch
//! ```
//!
//! s is the stretch, of a stop its depth; without damping stretch and pull vanish together and nothing is idle. Springs and the lines of static
//! and stepwise nodes have no modes but the last, and no guards.

use mbd_scene::laws::line::DETACHED;
use mbd_scene::{Float, Layout, LineEnd, Model, Scene};
use serde::{Deserialize, Serialize};

use crate::columns::{line_name, stop_name};

/// What a line or a stop does between two located events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Decides by itself at every evaluation: undamped lines of `rate` nodes, springs, lines of static and stepwise nodes.
    #[default]
    Free,
    /// Shorter than its free length, or not touched: nothing.
    Slack,
    /// Taut or touched, carries K s + C ṡ ≥ 0.
    Active,
    /// Taut or touched, but K s + C ṡ would push: carries nothing.
    Idle,
    /// Not there: a line or a spring that an event has detached, or that starts so.
    Detached,
}

impl Mode {
    /// That of an element which is taut or not, and would pull or not.
    pub(crate) fn of(taut: bool, pulls: bool) -> Self {
        match (taut, pulls) {
            (false, _) => Mode::Slack,
            (true, true) => Mode::Active,
            (true, false) => Mode::Idle,
        }
    }

    /// The mode as a number, for `At::hold`.
    #[must_use]
    pub fn hold<T: Float>(self) -> T {
        match self {
            Mode::Free => T::zero(),
            Mode::Active => T::one(),
            Mode::Slack | Mode::Idle => -T::one(),
            Mode::Detached => T::from_f64(DETACHED),
        }
    }

    /// What is not negative while the mode holds, from stretch s and pull e = (f(s) + C ṡ)/K [m]. At a `rate` node an idle line is a mode of
    /// its own; elsewhere a line that is not active waits for both to rise.
    pub(crate) fn margin(self, stretch: f64, pull: f64, at_node: bool) -> f64 {
        match (self, at_node) {
            (Mode::Detached, _) => f64::INFINITY,
            (Mode::Active, _) => stretch.min(pull),
            (_, false) => -stretch.min(pull),
            (Mode::Idle, true) => stretch.min(-pull),
            (Mode::Slack | Mode::Free, true) => -stretch,
        }
    }

    /// The mode that follows when the margin is passed, from stretch and pull there [m].
    pub(crate) fn next(self, stretch: f64, pull: f64, tolerance: f64) -> Self {
        match self {
            Mode::Detached => Mode::Detached,
            Mode::Slack | Mode::Free => Mode::Active,
            // Stretch and pull of an undamped line are the same but for rounding: what is not stretched is slack.
            Mode::Active if stretch <= tolerance => Mode::Slack,
            Mode::Active => Mode::Idle,
            Mode::Idle if pull >= -tolerance && stretch > 0.0 => Mode::Active,
            Mode::Idle => Mode::Slack,
        }
    }
}

/// Whether an element switches between modes at located instants: one-way, and not of a static or stepwise node, whose lines switch inside
/// the solve of the node.
pub(crate) fn switches<T: Float>(model: &dyn Model<T>, element: usize) -> bool {
    let (scene, layout) = (model.scene(), model.layout());
    match (scene.lines.get(element), layout.lines.get(element)) {
        (Some(declared), Some(slots)) => declared.kind.is_unilateral() && slots.effective.is_none(),
        _ => element < layout.one_way(),
    }
}

/// Whether an element has a mode of its own, held beside those of `rate` nodes.
pub(crate) fn has_mode<T: Float>(model: &dyn Model<T>, element: usize) -> bool {
    switches(model, element) && !is_node_line(model.layout(), element)
}

/// Whether an element is a line that ends at a node.
pub(crate) fn is_node_line(layout: &Layout, element: usize) -> bool {
    let slots = layout.lines.get(element);
    slots.is_some_and(|slots| slots.ends.iter().any(|end| matches!(end, LineEnd::Node(_))))
}

/// The name of an element.
pub(crate) fn name(scene: &Scene, layout: &Layout, element: usize) -> String {
    match element.checked_sub(layout.lines.len()) {
        Some(stop) => stop_name(scene, layout, stop),
        None => line_name(scene, element).to_owned(),
    }
}

/// What a run of a model tells of its lines and stops beside the events that it declares: `riser: taut`, `elbow.angle high stop: touched`. Springs and lines of
/// `static` and `stepwise` nodes are not told.
///
/// ```
/// use mbd_runtime::{model, switch_names};
///
/// model! {
///     /// A bob on a cord and a spring.
///     model Hung {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         point bob { mass: 1 kg }
///         line cord from world to bob { free_length: 1 m, stiffness: 2 kN/m }
///         spring coil from world to bob { free_length: 1 m, stiffness: 5 N/m }
///     }
/// }
///
/// let hung = Hung::new(HungParams::default()).expect("a model without params");
/// assert_eq!(switch_names(&hung), ["cord: taut", "cord: slack", "cord: idle"]);
/// ```
#[must_use]
pub fn switch_names(model: &dyn Model<f64>) -> Vec<String> {
    let (scene, layout) = (model.scene(), model.layout());
    let told = (0..layout.one_way()).filter(|element| switches(model, *element));
    let mut names = Vec::new();
    for element in told {
        for mode in [Mode::Active, Mode::Slack, Mode::Idle] {
            let name = report(scene, layout, element, mode);
            // A stop that carries nothing is left, whether it is touched or not.
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

/// Why a run of a model with these params does not tell one of its [switches](switch_names), and what to ask for in its place; `None` where it tells it.
///
/// ```
/// use mbd_runtime::{model, untold_switch};
///
/// model! {
///     /// A bob on a damped cord.
///     model Hung {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         point bob { mass: 1 kg }
///         line cord from world to bob { free_length: 1 m, stiffness: 2 kN/m, damping: 5 N*s/m }
///     }
/// }
///
/// let hung = Hung::new(HungParams::default()).expect("a model without params");
/// let why = untold_switch(&hung, "cord: slack").expect("it is idle before");
/// assert!(why.contains("`event loose = cord.stretch falls 0 m`"));
/// assert_eq!(untold_switch(&hung, "cord: idle"), None);
/// ```
#[must_use]
pub fn untold_switch(model: &dyn Model<f64>, switch: &str) -> Option<String> {
    let (scene, layout) = (model.scene(), model.layout());
    let named = |element: usize, mode| report(scene, layout, element, mode);
    let mut lines = (0..layout.lines.len()).filter(|line| switches(model, *line));
    lines.find_map(|line| {
        let damped = model.lines().get(line)?.damping > 0.0;
        if named(line, Mode::Slack) == switch && damped && !is_node_line(layout, line) {
            let (idle, name) = (named(line, Mode::Idle), name(scene, layout, line));
            return Some(format!(
                "a damped line between bodies is `{idle}` before; when it gets shorter than its free length is told by `event loose = {name}.stretch falls 0 m`"
            ));
        }
        (named(line, Mode::Idle) == switch && !damped).then(|| {
            let slack = named(line, Mode::Slack);
            format!("a line without damping pulls until it is `{slack}`")
        })
    })
}

/// What an element became, in words: `riser: taut`, `elbow.angle high stop: touched`.
pub(crate) fn report(scene: &Scene, layout: &Layout, element: usize, mode: Mode) -> String {
    let is_stop = element >= layout.lines.len();
    let word = match mode {
        Mode::Free | Mode::Active if is_stop => "touched",
        Mode::Slack | Mode::Idle if is_stop => "left",
        Mode::Free | Mode::Active => "taut",
        Mode::Slack => "slack",
        Mode::Idle => "idle",
        Mode::Detached => "detached",
    };
    format!("{}: {word}", name(scene, layout, element))
}

#[cfg(test)]
mod tests {
    use super::Mode;

    #[test]
    fn guards_lead_where_the_table_says() {
        let (s, t) = (0.1, 1e-9);
        assert_eq!(Mode::Active.margin(s, 1e-3, true), 1e-3);
        assert_eq!(Mode::Active.next(s, -1e-8, t), Mode::Idle);
        assert_eq!(Mode::Active.next(-1e-8, 1e-3, t), Mode::Slack);
        // Without damping rounding alone is between the two.
        assert_eq!(Mode::Active.next(1e-17, -2e-17, t), Mode::Slack);
        assert_eq!(Mode::Active.next(-2e-17, -3e-17, t), Mode::Slack);
        assert_eq!(Mode::Slack.margin(-0.1, 0.0, true), 0.1);
        assert_eq!(Mode::Slack.next(1e-8, 1e-3, t), Mode::Active);
        assert_eq!(Mode::Idle.margin(0.2, -2e-3, true), 2e-3);
        assert_eq!(Mode::Idle.next(0.2, 0.0, t), Mode::Active);
        assert_eq!(Mode::Idle.next(-1e-8, -2e-3, t), Mode::Slack);
        // A line between bodies, or a stop: the force starts when both have risen.
        assert_eq!(Mode::Slack.margin(0.2, -2e-3, false), 2e-3);
    }
}
