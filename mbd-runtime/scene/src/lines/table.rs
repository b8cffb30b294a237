//! A line whose force is a table over stretch: webbing, a bungee cord, a rope that stiffens. Tension only.
//!
//! ```text
//! rows (x_k, y_k), k = 0 … n,  x_0 = y_0 = 0,  x and y rise;   k_k = (y_{k+1} − y_k)/(x_{k+1} − x_k) > 0 [N/m]     (1)
//! o_k(s) = min(max(s, x_k), x_{k+1}) − x_k        the part of the stretch that lies in piece k [m]                (2)
//! f = Σ k_k o_k                                                                                                  (3)
//! E = Σ y_k o_k + ½ k_k o_k²                       exact: f is piecewise linear                                   (4)
//! f′(s) = k_k of the piece with x_k ≤ s < x_{k+1}                                                                (5)
//! ```
//!
//! The first piece continues below x_0 and the last one beyond x_n with their slopes (the clamps of (2) are missing there): a line pulls harder
//! the longer it is, whatever its table was measured for. A table in an expression is constant beyond its rows instead.
//! At a knot (5) takes the slope of the piece to the right, as the kink s = 0 counts as taut. One piece is the linear law to the bit.
//! Rejected: a constant force beyond the last row. Its energy grows no faster than s: a heavier load has no rest position.

use crate::lines::LineLaw;
use crate::{Real, TINY, Table};

/// The law over table number `.0` of the scene.
pub struct OverTable(pub usize);

/// One piece between two rows.
struct TableSegment {
    /// x_k, y_k.
    start: [f64; 2],
    /// k_k.
    slope: f64,
    /// Where it begins and ends; `None`: never.
    from: Option<f64>,
    to: Option<f64>,
}

impl TableSegment {
    /// o_k by (2).
    fn overlap<S: Real>(&self, stretch: S) -> S {
        let from = match self.from {
            Some(from) => stretch.max(S::from_f64(from)),
            None => stretch,
        };
        let to = match self.to {
            Some(to) => from.min(S::from_f64(to)),
            None => from,
        };
        match self.from {
            Some(from) => to - S::from_f64(from),
            None => to,
        }
    }
}

impl OverTable {
    /// The pieces of the table; none if it does not exist.
    fn pieces<'t>(&self, tables: &'t [Table]) -> impl Iterator<Item = TableSegment> + 't {
        let (x, y) = match tables.get(self.0) {
            Some(table) => (table.x.as_slice(), table.y.as_slice()),
            None => (&[][..], &[][..]),
        };
        let last = x.len().min(y.len()).saturating_sub(2);
        let pieces = x.windows(2).zip(y.windows(2)).enumerate();
        pieces.map(move |(k, (x, y))| TableSegment {
            start: [x[0], y[0]],
            slope: (y[1] - y[0]) / (x[1] - x[0]),
            from: (k > 0).then_some(x[0]),
            to: (k < last).then_some(x[1]),
        })
    }

    fn first_slope(&self, tables: &[Table]) -> f64 {
        self.pieces(tables).next().map_or(f64::NAN, |p| p.slope)
    }
}

impl LineLaw for OverTable {
    fn formula(&self) -> &'static str {
        "f(s)"
    }

    fn not_at_node(&self) -> Option<&'static str> {
        Some("whose balance takes a stiffness of each line, not a table: give it a `stiffness`")
    }

    fn table(&self) -> Option<usize> {
        Some(self.0)
    }

    fn stiffness<S: Real>(&self, tables: &[Table], _: S) -> S {
        S::from_f64(self.first_slope(tables))
    }

    fn stiffest(&self, tables: &[Table], _: f64) -> f64 {
        let slopes = self.pieces(tables).map(|piece| piece.slope);
        slopes.fold(f64::NAN, f64::max)
    }

    fn force<S: Real>(&self, tables: &[Table], _: S, stretch: S) -> S {
        let parts = self
            .pieces(tables)
            .map(|piece| S::from_f64(piece.slope) * piece.overlap(stretch));
        let sum = parts.reduce(|sum, part| sum + part);
        sum.unwrap_or_else(|| S::from_f64(f64::NAN))
    }

    fn slopes<S: Real>(&self, tables: &[Table], stiffness: S, stretch: S) -> [S; 2] {
        let first = S::from_f64(self.first_slope(tables));
        let mut slope = first;
        for piece in self.pieces(tables).skip(1) {
            let here = S::from_f64(piece.start[0]).le(stretch);
            slope = S::select(here, S::from_f64(piece.slope), slope);
        }
        if self.pieces(tables).nth(1).is_none() {
            return [first; 2];
        }
        let force = self.force(tables, stiffness, stretch);
        let secant = force / stretch.max(S::from_f64(TINY));
        [slope, S::select(S::zero().lt(stretch), secant, first)]
    }

    fn energy<S: Real>(&self, tables: &[Table], _: S, stretch: S) -> S {
        let half = S::from_f64(0.5);
        let parts = self.pieces(tables).map(|piece| {
            let overlap = piece.overlap(stretch);
            let rise = half * (S::from_f64(piece.slope) * (overlap * overlap));
            match piece.start[1] {
                0.0 => rise,
                force => rise + S::from_f64(force) * overlap,
            }
        });
        parts.reduce(|sum, part| sum + part).unwrap_or_else(S::zero)
    }
}
