//! A line: a massless, tension-only spring-damper between two places; a spring: the same, both ways.
//!
//! ```text
//! e = p_to − p_from,  d = |e|,  u = e/d,  s = d − L0,  ṡ = u·(v_to − v_from)                                     (1)
//! line      T = max(0, f(s) + C ṡ)  if s > 0, else 0                                                            (2)
//! spring    T = f(s) + C ṡ                                                                                      (3)
//! node line T = K_e max(0, d − L_e)         statics, Euler and BDF2 alike (equilibrium point, AAS 03-163)         (4)
//! stiffness J = K u uᵀ + (T/d)(I − u uᵀ) = τ I + (K − τ) u uᵀ,  K = f′(s),  τ = T/d  (f(s)/s if L = 0)            (5)
//! ```
//!
//! f is the elastic force of the line's law, K s where it is linear: [`LineKind`].
//!
//! The force on the `from` end is +T u, on the `to` end −T u. Row units N, N/m.
//! Singular case d = 0: only an L = 0 line is taut there; it is linear, T u = K e, J = K I. d is guarded by ε = [`TINY`] where it divides and in s
//! alike, so that below ε T u = (K ε)(e/ε) has the derivative K I, too; in (5) τ is selected. The kink s = 0 counts as taut in (5): a Newton step with one taut line lands exactly on that line's kink,
//! and would cycle otherwise (`equilibrium.md` §8, 3).
//! Rejected: damping that acts on the length while slack (it lets slack lines pull), and damping that jumps at L0 (no root in 2–3.5 % of scenes).

use nalgebra::{Matrix3, Vector3};

use crate::laws::numbers::LineNumbers;
use crate::scalar::algebra::{elements, labelled, symmetric};
use crate::{LineKind, Real, TINY, Table};

/// Length, direction and stretch of a line, equation (1).
#[derive(Clone, Copy, Debug)]
pub struct Geometry<S: Real> {
    /// Length d [m].
    pub length: S,
    /// 1/d, guarded at zero length [1/m].
    pub inverse_length: S,
    /// Unit vector u from the `from` end to the `to` end; zero at zero length.
    pub direction: Vector3<S>,
    /// Stretch s = d − L0, d guarded at zero length [m].
    pub stretch: S,
    /// d, guarded at zero length [m].
    guarded: S,
}

impl<S: Real> Geometry<S> {
    /// The stretch over another free length [m].
    pub fn stretch_over(&self, free_length: S) -> S {
        self.guarded - free_length
    }
}

/// Geometry of a line whose ends are `vector` = p_to − p_from apart.
#[inline]
pub fn geometry<S: Real>(vector: &Vector3<S>, free_length: S) -> Geometry<S> {
    let vector = labelled(*vector, ["e_x", "e_y", "e_z"]);
    let length = vector.dot(&vector).sqrt().label("length");
    let guarded = length.max(S::from_f64(TINY));
    let inverse_length = (S::one() / guarded).label("inverse_length");
    let direction = Vector3::new(
        (vector.x * inverse_length).label("u_x"),
        (vector.y * inverse_length).label("u_y"),
        (vector.z * inverse_length).label("u_z"),
    );
    Geometry {
        length,
        inverse_length,
        direction,
        stretch: (guarded - free_length).label("stretch"),
        guarded,
    }
}

/// What [`At::hold`](crate::At::hold) says of a line or a spring that is detached.
pub const DETACHED: f64 = -2.0;

/// An element that pulls along one direction: a line, a spring, or a stop, whose stretch is its depth. One law, one list of constants, one
/// guard, one hold mode for all of them.
#[derive(Clone, Copy, Debug)]
pub struct Element<'a, S> {
    /// Its elastic force, and whether it pulls only.
    pub kind: LineKind,
    /// The tables of the scene.
    pub tables: &'a [Table],
    /// Its constants.
    pub numbers: LineNumbers<S>,
    /// Whether it has damping by declaration; without it the rate is not used.
    pub damped: bool,
}

impl<S: Real> Element<'_, S> {
    /// A damped linear line.
    #[inline]
    pub fn linear(numbers: LineNumbers<S>) -> Self {
        Element {
            kind: LineKind::Line,
            tables: &[],
            numbers,
            damped: true,
        }
    }

    /// Elastic force f(s) [N].
    #[inline]
    fn elastic(&self, stretch: S) -> S {
        self.kind
            .force(self.tables, self.numbers.stiffness, stretch)
    }

    /// The stretch over which it acts: the positive part if it pulls only [m].
    fn acting(&self, stretch: S) -> S {
        match self.kind.is_unilateral() {
            true => stretch.max(S::zero()),
            false => stretch,
        }
    }

    /// Pull P = f(s) + C ṡ [N] whatever its sign.
    #[inline]
    pub fn pull(&self, stretch: S, rate: S) -> S {
        let elastic = self.elastic(stretch);
        (if self.damped {
            elastic + self.numbers.damping * rate
        } else {
            elastic
        })
        .label("pull")
    }

    /// Tension [N] by (2) or (3). `hold`: 0 the element decides by itself, +1 it carries its pull, −1 it carries nothing, [`DETACHED`] it is not
    /// there: that of a spring is read by `where_attached`.
    ///
    /// Without damping the force is continuous at the slack edge, but its slope is not: held, a trial step across the edge stays smooth.
    pub fn tension(&self, stretch: S, rate: S, hold: S) -> S {
        self.tension_of(self.pull(stretch, rate), stretch, hold)
    }

    /// The same of a pull that is known.
    pub fn tension_of(&self, pull: S, stretch: S, hold: S) -> S {
        if !self.kind.is_unilateral() {
            return pull.label("tension");
        }
        let zero = S::zero();
        let by_itself = if self.damped {
            S::select(zero.lt(stretch), pull.max(zero), zero)
        } else {
            pull.max(zero)
        };
        let held = S::select(hold.lt(zero), zero, by_itself);
        S::select(zero.lt(hold), pull, held).label("tension")
    }

    /// Its stiffness at a stretch, for [`stiffness`].
    pub fn tangent(&self, stretch: S) -> Tangent<S> {
        let [slope, secant] = self
            .kind
            .slopes(self.tables, self.numbers.stiffness, stretch);
        Tangent {
            slope,
            secant,
            free_length: self.numbers.free_length,
        }
    }

    /// Elastic energy [J].
    pub fn energy(&self, stretch: S) -> S {
        let acting = self.acting(stretch);
        self.kind
            .energy(self.tables, self.numbers.stiffness, acting)
    }

    /// Power that its damping takes, (T − f) ṡ with f over the acting part of the stretch [W]; `None` without damping.
    pub fn damping_power(&self, stretch: S, rate: S, tension: S) -> Option<S> {
        let elastic = || self.elastic(self.acting(stretch));
        self.damped.then(|| (tension - elastic()) * rate)
    }
}

/// The stiffness of a law at one stretch.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<S> {
    /// dT/ds [N/m].
    pub slope: S,
    /// T/s [N/m]: the stiffness across a line of zero free length.
    pub secant: S,
    /// Free length L0 [m].
    pub free_length: S,
}

impl<S: Real> Tangent<S> {
    /// T = K (d − L).
    pub fn linear(stiffness: S, free_length: S) -> Self {
        Tangent {
            slope: stiffness,
            secant: stiffness,
            free_length,
        }
    }
}

/// Tension of a node line [N] by (4).
#[inline]
pub fn effective_tension<S: Real>(stiffness: S, stretch: S) -> S {
    (stiffness * stretch.max(S::zero())).label("tension")
}

/// Stiffness J of a taut line by (5), zero when slack [N/m]. `tangent` is that of the law that gave `tension`.
#[inline]
pub fn stiffness<S: Real>(geometry: &Geometry<S>, tangent: &Tangent<S>, tension: S) -> Matrix3<S> {
    let zero = S::zero();
    let taut = zero.le(geometry.stretch);
    let across = S::select(
        zero.lt(tangent.free_length),
        tension * geometry.inverse_length,
        tangent.secant,
    );
    let across = S::select(taut, across, zero).label("across");
    let along = (S::select(taut, tangent.slope, zero) - across).label("along");
    let u = &geometry.direction;
    let weighted = labelled(u.map(|x| along * x), ["along_x", "along_y", "along_z"]);
    let block = elements(&(Matrix3::from_diagonal_element(across) + weighted * u.transpose()));
    let names = ["j_xx", "j_xy", "j_xz", "j_yy", "j_yz", "j_zz"];
    symmetric(std::array::from_fn(|i| block[i].label(names[i])))
}
