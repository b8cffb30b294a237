//! Sine and cosine by the same operations for one number and for several in a register, so that a case has the same bits in a lane as alone, and on every
//! machine.
//!
//! ```text
//! k = round(2 x/π),  y = x − k π/2 as a sum y + e                                 (1)  Cody and Waite
//! sin y = y + y³ S(y²),  cos y = 1 − y²/2 + y⁴ C(y²),  |y| ≤ π/4, both with e     (2)  minimax, Sun Microsystems' fdlibm
//! k mod 4 says which of ±sin y, ±cos y is which                                  (3)
//! ```
//!
//! π/2 has 86 bits in (1), and 151 near a whole quarter turn, where most digits of x go: rare, and so not in the way of the others. Off by less than 1.5
//! units of the last place for |x| ≤ 1e5 [rad]; beyond that, where no mechanism counts its turns, the system's library is asked, number by number.

use super::Real;

/// Up to where (1) holds its digits [rad].
pub const LARGEST_ANGLE: f64 = 1e5;
/// Below this k is zero [rad].
const SMALL: f64 = 0.785;
/// Nearer to a whole quarter turn than this 86 bits are too few: what they leave out, k 2⁻⁸⁶ at most, would be seen in the digits of y [rad].
const NEAR: f64 = 1.3e-4;
/// 1.5 · 2⁵²: what is added to it is rounded to a whole number.
const ROUNDS: f64 = 6_755_399_441_055_744.0;
/// π/2: three parts of 33 bits, and what is left.
const QUARTER: [f64; 4] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_711_166_5e-21,
    8.478_427_660_368_9e-32,
];
/// What the first of these leaves, in one number.
const LEFT: f64 = 6.077_100_506_506_192e-11;
/// The coefficients of S, and of C from y⁴ on.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// (2) of y + e, in short chains: what is added waits for nothing but itself.
#[inline(always)]
fn inside<S: Real>([y, e]: [S; 2]) -> [S; 2] {
    let (half, one) = (S::from_f64(0.5), S::one());
    let [s1, s2, s3, s4, s5, s6] = SINE.map(S::from_f64);
    let [c1, c2, c3, c4, c5, c6] = COSINE.map(S::from_f64);
    let z = y * y;
    let zz = z * z;
    let cube = z * y;
    let last = zz.fmadd(s6, z.fmadd(s5, s4));
    let rest = zz.fmadd(last, z.fmadd(s3, s2));
    let end = z.fmadd(cube * rest - half * e, e);
    let sine = y + cube.fmadd(s1, end);
    let last = zz.fmadd(z.fmadd(c6, c5), z.fmadd(c4, c3));
    let rest = zz.fmadd(last, z.fmadd(c2, c1));
    let off = half * z;
    let near = one - off;
    let cosine = near + (((one - near) - off) + zz.fmsub(rest, y * e));
    [sine, cosine]
}

/// y and e of (1) by k, with 86 bits.
#[inline(always)]
fn reduce<S: Real>(x: S, k: S) -> [S; 2] {
    let left = S::from_f64(LEFT);
    let above = k.fnmadd(S::from_f64(QUARTER[0]), x);
    let y = k.fnmadd(left, above);
    [y, k.fnmadd(left, above - y)]
}

/// The same with 151.
#[inline(always)]
fn reduce_near<S: Real>(x: S, k: S) -> [S; 2] {
    let [first, second, third, fourth] = QUARTER.map(S::from_f64);
    let above = k.fnmadd(first, x);
    let upper = k.fnmadd(second, above);
    let lost = k.fnmadd(second, above - upper);
    let lower = k.fnmadd(third, upper);
    let tail = lost + k.fnmadd(fourth, k.fnmadd(third, upper - lower));
    let y = lower + tail;
    [y, (lower - y) + tail]
}

/// Sine and cosine of angles of size 1e5 at most [rad]; `any` says whether something holds for any of the numbers, and `quarters` does (3): of [k + 1.5 · 2⁵²,
/// sin y, cos y], the first of which has k in its last bits.
#[inline(always)]
pub fn sin_cos_within<S: Real>(
    x: S,
    any: impl FnOnce(S::Mask) -> bool,
    quarters: impl FnOnce([S; 3]) -> (S, S),
) -> (S, S) {
    let rounds = S::from_f64(ROUNDS);
    let rounded = x.fmadd(S::from_f64(std::f64::consts::FRAC_2_PI), rounds);
    let k = rounded - rounds;
    let mut reduced = reduce(x, k);
    let is_near = || reduced[0].abs().lt(S::from_f64(NEAR));
    if any(is_near()) {
        let better = reduce_near(x, k);
        reduced = std::array::from_fn(|i| S::select(is_near(), better[i], reduced[i]));
    }
    let [sine, cosine] = inside(reduced);
    quarters([rounded, sine, cosine])
}

/// Sine and cosine of an angle [rad].
pub(super) fn sin_cos(x: f64) -> (f64, f64) {
    let size = x.abs();
    if size <= SMALL {
        let [sine, cosine] = inside([x, 0.0]);
        return (sine, cosine);
    }
    if size <= LARGEST_ANGLE {
        // Without a branch: nothing says beforehand which quarter comes next.
        return sin_cos_within(
            x,
            |near| near,
            |numbers| {
                let [quarters, sine, cosine] = numbers.map(f64::to_bits);
                let exchanged = (sine ^ cosine) & (quarters & 1).wrapping_neg();
                let signed =
                    |bits: u64, turns: u64| f64::from_bits(bits ^ exchanged ^ (turns & 2) << 62);
                (signed(sine, quarters), signed(cosine, quarters + 1))
            },
        );
    }
    x.sin_cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distance of two numbers in units of the last place of the second.
    fn units(a: f64, b: f64) -> f64 {
        let size = b.abs();
        ((a - b) / (size.next_up() - size)).abs()
    }

    #[test]
    fn sine_and_cosine_are_those_of_the_library_but_for_the_last_digit() {
        let mut worst = 0.0_f64;
        let mut look = |x: f64| {
            let (sine, cosine) = sin_cos(x);
            let (other_sine, other_cosine) = x.sin_cos();
            worst = worst
                .max(units(sine, other_sine))
                .max(units(cosine, other_cosine));
        };
        for k in -63_000..63_000_i32 {
            // Next to whole quarters, where one of them is nearly zero and has all its digits nevertheless.
            let near = f64::from(k) * std::f64::consts::FRAC_PI_2;
            [near.next_down(), near, near.next_up()]
                .into_iter()
                .for_each(&mut look);
            // On both sides of where more bits are taken.
            [near - 0.99 * NEAR, near + 1.01 * NEAR]
                .into_iter()
                .for_each(&mut look);
            look(near + 0.618 * f64::from(k % 7));
            look(1e-4 * f64::from(k));
        }
        // A unit of this one, and what the library is off by.
        assert!(worst <= 2.0, "{worst}");
    }

    #[test]
    fn what_is_not_in_the_range_is_told() {
        assert!([f64::NAN, f64::INFINITY].into_iter().all(|x| {
            let (sine, cosine) = sin_cos(x);
            sine.is_nan() && cosine.is_nan()
        }));
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }
}
