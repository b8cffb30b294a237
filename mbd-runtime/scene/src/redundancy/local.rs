//! One joint seen from one of its parts: which motions of the part its rows fix, and which they leave.
//!
//! Motions are (v, ℓ ω): six numbers in metres a second, world axes, ℓ a length of the scene. A point has the first three.

use crate::rows::{Columns, Rows};
use crate::scalar::orthogonal::{dot, subtract, take_out};
use crate::{Directions, Part};

/// A motion of a part.
pub type PartMotion = [f64; 6];

/// Less than this part of a row left by others is nothing.
const NOTHING: f64 = 1e-9;

/// The motions that a part is capable of, by their numbers.
pub fn speeds(part: Part, directions: Directions) -> impl Iterator<Item = usize> + Clone {
    let turns = match part {
        Part::Body(_) => directions.rotations(),
        _ => &[],
    };
    let turns = turns.iter().map(|&axis| 3 + axis);
    directions.translations().iter().copied().chain(turns)
}

/// The columns of a row at one end.
pub fn columns(
    columns: &Columns<f64>,
    part: Part,
    directions: Directions,
    length: f64,
) -> PartMotion {
    let (v, w) = (columns.linear, columns.angular / length);
    let all = [v.x, v.y, v.z, w.x, w.y, w.z];
    let mut own = [0.0; 6];
    for k in speeds(part, directions) {
        own[k] = all[k];
    }
    own
}

/// The rows of a joint on the part it places, made orthonormal: e_i = Σ mix_ij φ_j.
#[derive(Clone, Debug, Default)]
pub struct Hold {
    fixed: Vec<PartMotion>,
    mix: Vec<[f64; 6]>,
    /// What the rows leave: orthonormal motions.
    pub free: Vec<PartMotion>,
}

impl Hold {
    /// Of rows on the parent or the child; `None` where they depend on each other.
    pub fn new(
        rows: &Rows<f64>,
        (part, parent): (Part, bool),
        directions: Directions,
        length: f64,
    ) -> Option<Self> {
        let mut hold = Hold::default();
        for (index, row) in rows.rows().iter().enumerate() {
            let own = if parent { row.parent() } else { row.child() };
            let mut rest = columns(own, part, directions, length);
            let whole = dot(&rest, &rest).sqrt();
            let mut mix = [0.0; 6];
            *mix.get_mut(index)? = 1.0;
            let fixed = hold.fixed.iter().map(|fixed| (0, &fixed[..]));
            take_out(&mut rest, fixed, |index, along| {
                subtract(&mut mix, along, &hold.mix[index]);
            });
            let new = dot(&rest, &rest).sqrt();
            if new.is_nan() || new <= NOTHING * whole {
                return None;
            }
            hold.fixed.push(rest.map(|x| x / new));
            hold.mix.push(mix.map(|x| x / new));
        }
        let speeds = speeds(part, directions);
        while hold.fixed.len() + hold.free.len() < speeds.clone().count() {
            let rest = |k: usize| {
                let mut rest: PartMotion = std::array::from_fn(|i| f64::from(u8::from(i == k)));
                let known = hold.fixed.iter().chain(&hold.free);
                take_out(&mut rest, known.map(|known| (0, &known[..])), |_, _| ());
                rest
            };
            let longest = speeds
                .clone()
                .map(rest)
                .max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)))?;
            let size = dot(&longest, &longest).sqrt();
            hold.free.push(longest.map(|x| x / size));
        }
        Some(hold)
    }

    /// The smallest motion with these rates of the rows.
    pub fn motion(&self, rates: &[f64; 6]) -> PartMotion {
        let mut motion = [0.0; 6];
        for (fixed, mix) in self.fixed.iter().zip(&self.mix) {
            subtract(&mut motion, -dot(mix, rates), fixed);
        }
        motion
    }

    /// The multipliers whose rows add up to a force that the joint can carry.
    pub fn multipliers(&self, force: &PartMotion) -> [f64; 6] {
        let mut multipliers = [0.0; 6];
        for (fixed, mix) in self.fixed.iter().zip(&self.mix) {
            subtract(&mut multipliers, -dot(fixed, force), mix);
        }
        multipliers
    }
}
