//! Every tuned number of the fallback chain, with its reason. All are relative unless a unit is given.

/// Part left to a pivot below which its row counts as dependent on others, in `f64`; more where the scalar has fewer digits. The pivot is
/// sin² of an angle: rows within 1e-5 rad of each other.
pub(super) const MARGIN: f64 = 1e-10;
/// What rounding ε of a state may cost accelerations in passing a state where rows lose rank. It costs them ε over the margin: closer
/// than that, their limit from farther away is better. In `f32` that is good to ε^(4/7) = 1e-4; in `f64` [`MARGIN`] is wider.
pub(super) const PASSING: f64 = 2.5e-5;
/// The same where rows stay near such a state and nothing better is known.
pub(super) const LASTING: f64 = 2e-2;
/// What a solution without all rows may leave of a row, at least: rows that prescribe another motion leave more.
pub(super) const LEFT: f64 = 1e-3;
/// What a regularised stage may leave of a row: inside a step rows disagree by the step times the rate of the motion.
pub(super) const LEFT_INSIDE: f64 = 3e-2;
/// A step is measured at its stages while the root of the margin is less than this many times its change over the step before.
pub(super) const NEAR: f64 = 2.0;
/// Part of a row that must be new for it to count as independent: what rounding leaves of a row that repeats others is less.
pub(crate) const NEW: f64 = 1e-9;
/// Part of a combination from which on a row takes part in it.
pub(super) const INVOLVED: f64 = 1e-6;

/// The power of the rounding unit ε that δ is, over the time in which the fastest point crosses the scene, as it goes or from rest: what
/// rounding leaves of λ grows with ε/δ³, what the extrapolation neglects with δ⁴.
pub(super) const POWER: f64 = 1.0 / 7.0;
/// The angle of rows within which limits are taken once a step was rejected, over ε^(1/7), where what rounding leaves of v̇, ε over its cube, is
/// what a limit is off by, ε^(4/7). A parallelogram passes its flat positions at tolerances of 1e-12 and 1e-13 with any value from 0.2 to 1.5:
/// below 0.4 rounding costs rejections, above it limits find their neighbouring states within it and take wider ones, which costs a tolerance
/// of 1e-13 three times as many steps there. In `f32` [`PASSING`] is wider.
pub(super) const WIDE: f64 = 0.4;
/// The power of ε that the margin is below which other rows than those kept are looked for. At an angle δ of rows rounding moves places by ε/δ, and
/// what follows of v̇ by ε/δ³: ε^(5/8) where the margin δ² is ε^(1/4).
pub(super) const OUTDONE: f64 = 0.25;
/// How many times as far from each other as the kept ones rows chosen anew are that are taken in their place.
pub(super) const BETTER: f64 = 10.0;
/// Part of the angle at which kept rows were as good as any from which on that is asked again.
pub(super) const AGAIN: f64 = 0.25;
/// Times δ that are tried where rows lose rank also at the neighbouring states.
pub(super) const WIDER: [f64; 3] = [1.0, 2.0, 4.0];
/// Part of the largest terms of a row below which every sum is nothing: the motion is free.
pub(super) const FREE: f64 = 1e-3;

/// A ratio of masses from which on the emitted elimination is compared with the whole matrix.
pub(super) const RATIO: f64 = 1e3;
/// What accelerations may be off by, up to a ratio of masses of 1e5; above it in proportion, up to 1e9. Beyond half of it the whole matrix
/// takes over.
pub(super) const LOSS: f64 = 1e-12;
/// A loss that no run goes on with.
pub(super) const TOO_MUCH: f64 = 1e-3;

/// Corrections of a solution of the whole matrix.
pub(super) const CORRECTIONS: usize = 3;
/// σ² of a row of size 1 below which a regularised solution leaves a direction alone. Smaller ones follow the inconsistency of a stage,
/// larger ones converge slowly.
pub(super) const GIVE: f64 = 1e-6;
/// Rounds of a regularised solution at most.
pub(super) const ROUNDS: usize = 50;
/// Rounds after which it may stop: by then rows far from those that stall are solved to the last digit.
pub(super) const LEAST: usize = 3;
