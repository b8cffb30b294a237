//! The plain values that generated models hand out.

use mbd_scene::Cost;
use serde::{Deserialize, Serialize};

/// The operations of every quantity of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs(
    /// By the name of its function.
    pub &'static [(&'static str, Cost)],
);

impl Costs {
    /// The operations of one quantity, also at compile time: `const { assert!(Model::COST.of("derivative").unwrap().total() < 500) }`.
    #[must_use]
    pub const fn of(&self, name: &str) -> Option<Cost> {
        let mut index = 0;
        while index < self.0.len() {
            if same(self.0[index].0.as_bytes(), name.as_bytes()) {
                return Some(self.0[index].1);
            }
            index += 1;
        }
        None
    }
}

/// Equality of texts that also works at compile time.
const fn same(a: &[u8], b: &[u8]) -> bool {
    if a.len() != b.len() {
        return false;
    }
    let mut index = 0;
    while index < a.len() {
        if a[index] != b[index] {
            return false;
        }
        index += 1;
    }
    true
}

/// A force at a place and a couple, world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wrench<T = f64> {
    /// Force [N].
    pub force: [T; 3],
    /// Couple [N m].
    pub couple: [T; 3],
}

/// Energy and power of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy<T> {
    /// ½ v·M v [J].
    pub kinetic: T,
    /// Energy of gravity [J]; zero at the world origin, or at infinity for a point mass.
    pub gravitational: T,
    /// Σ ½ K s₊² of lines, of springs and stops of joints [J].
    pub elastic: T,
    /// Power of the loads on bodies and points [W].
    pub load_power: T,
    /// Power of dampers and friction [W], ≤ 0.
    pub damper_power: T,
    /// Power that prescribed motions put in [W].
    pub drive_power: T,
}

/// Momentum of bodies and points with mass, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum<T> {
    /// Σ m v [kg m/s].
    pub linear: [T; 3],
    /// Σ r × m v + R I ω about the world origin [kg m²/s].
    pub angular: [T; 3],
}

/// A line at a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineState<T> {
    /// Tension [N], ≥ 0 for a line.
    pub tension: T,
    /// Distance of its ends [m].
    pub length: T,
    /// Length minus free length [m].
    pub stretch: T,
    /// Rate of the length [m/s].
    pub rate: T,
    /// K u uᵀ + (T/d)(1 − u uᵀ), elements xx xy xz yy yz zz [N/m].
    pub stiffness: [T; 6],
}

/// What a joint does to its child at the origin of frame 2, world axes; its parent receives the opposite at the same point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction<T> {
    /// Force [N].
    pub force: [T; 3],
    /// Torque about the origin of frame 2 [N m].
    pub torque: [T; 3],
}

/// A coordinate, a speed or a constraint row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordInfo {
    /// Its name, `capsule.qw`.
    pub name: &'static str,
    /// Its SI unit.
    pub unit: &'static str,
}

/// A live parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamInfo {
    /// Its name.
    pub name: &'static str,
    /// Its documentation.
    pub doc: &'static str,
    /// Its unit as declared.
    pub unit: &'static str,
    /// SI value of one such unit.
    pub factor: f64,
    /// Its default [SI].
    pub default: f64,
    /// Smallest and largest accepted value [SI].
    pub range: Option<[f64; 2]>,
}
