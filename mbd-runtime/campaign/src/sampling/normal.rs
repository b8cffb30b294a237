//! The normal distribution: how much lies below, and below where so much lies.

/// The part of the standard normal distribution below `z`.
#[must_use]
pub fn below(z: f64) -> f64 {
    0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// Where so much of the standard normal distribution lies below: relative error 1e-16. M. J. Wichura, algorithm AS 241, Appl. Statist. 37 (1988).
#[must_use]
pub fn quantile(part: f64) -> f64 {
    let q = part - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180_625 - q * q;
        return q * polynomial(&MIDDLE[0], r) / polynomial(&MIDDLE[1], r);
    }
    let tail = if q < 0.0 { part } else { 1.0 - part };
    let r = (-tail.ln()).sqrt();
    let size = if r <= 5.0 {
        polynomial(&NEAR[0], r - 1.6) / polynomial(&NEAR[1], r - 1.6)
    } else {
        polynomial(&FAR[0], r - 5.0) / polynomial(&FAR[1], r - 5.0)
    };
    size.copysign(q)
}

/// Coefficients of rising powers.
fn polynomial(coefficients: &[f64; 8], r: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * r + c)
}

#[rustfmt::skip]
const MIDDLE: [[f64; 8]; 2] = [
    [3.3871328727963665, 133.14166789178438, 1971.5909503065513, 13731.69376550946,
     45921.95393154987, 67265.7709270087, 33430.57558358813, 2509.0809287301227],
    [1.0, 42.31333070160091, 687.1870074920579, 5394.196021424751,
     21213.794301586597, 39307.89580009271, 28729.085735721943, 5226.495278852854],
];
#[rustfmt::skip]
const NEAR: [[f64; 8]; 2] = [
    [1.4234371107496835, 4.630337846156546, 5.769497221460691, 3.6478483247632045,
     1.2704582524523684, 0.2417807251774506, 0.022723844989269184, 0.0007745450142783414],
    [1.0, 2.053191626637759, 1.6763848301838038, 0.6897673349851,
     0.14810397642748008, 0.015198666563616457, 0.0005475938084995345, 1.0507500716444169e-09],
];
#[rustfmt::skip]
const FAR: [[f64; 8]; 2] = [
    [6.657904643501103, 5.463784911164114, 1.7848265399172913, 0.29656057182850487,
     0.026532189526576124, 0.0012426609473880784, 2.7115555687434876e-05, 2.0103343992922881e-07],
    [1.0, 0.599832206555888, 0.1369298809227358, 0.014875361290850615,
     0.0007868691311456133, 1.8463183175100548e-05, 1.421511758316446e-07, 2.0442631033899397e-15],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantile_and_part_below_undo_each_other() {
        for k in 1..=2000 {
            let part = f64::from(k) / 2001.0;
            assert!((below(quantile(part)) - part).abs() < 4e-16, "{part}");
        }
        for exponent in 3..300 {
            let part = 10_f64.powi(-exponent);
            assert!((below(quantile(part)) / part - 1.0).abs() < 1e-12, "{part}");
        }
    }

    /// Tables of the normal distribution: one-sided 97.5 %, 99.865 % (three sigma).
    #[test]
    fn well_known_quantiles_are_met() {
        assert!((quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-15);
        assert!((below(3.0) - 0.998_650_101_968_369_9).abs() < 1e-15);
        assert_eq!(quantile(0.5), 0.0);
    }
}
