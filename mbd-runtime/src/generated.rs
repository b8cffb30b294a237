//! The plain values that generated models hand out.

/// A force at a place and a couple, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench<T> {
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
    /// Σ ½ K s₊² [J].
    pub elastic: T,
    /// Power of the loads on bodies and points [W].
    pub load_power: T,
    /// Power of the dampers [W], ≤ 0.
    pub damper_power: T,
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

/// A coordinate or a speed.
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
