//! Numbers as people read them.

/// A number with `digits` significant digits: plain between 1e-3 and 1e6, with an exponent beyond (`1.57e-4`).
///
/// Whole digits are never replaced by zeros: `significant(2809.94, 3)` is `2810`.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    let digits = digits.max(1);
    if !value.is_finite() {
        return value.to_string();
    }
    if value == 0.0 {
        return "0".to_string();
    }
    // The exponent after rounding: 9.996 to three digits is 10.0.
    let scientific = format!("{value:.*e}", digits - 1);
    let exponent = scientific
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse::<i32>().ok())
        .unwrap_or(0);
    if (-3..6).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        scientific
    }
}

/// A pixel coordinate with one decimal: `12.5`, `12`, never `-0`.
pub(super) fn pixel(value: f64) -> String {
    let tenths = (value * 10.0).round();
    if tenths % 10.0 == 0.0 {
        format!("{}", tenths / 10.0 + 0.0)
    } else {
        format!("{:.1}", tenths / 10.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_are_kept_and_whole_digits_never_lost() {
        assert_eq!(significant(2809.94, 3), "2810");
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(0.048, 2), "0.048");
        assert_eq!(significant(1.565e-4, 4), "1.565e-4");
        assert_eq!(significant(-4.2828e13, 5), "-4.2828e13");
        assert_eq!(significant(f64::NAN, 3), "NaN");
        assert_eq!(significant(0.0, 3), "0");
    }

    #[test]
    fn pixels_have_one_decimal_and_no_negative_zero() {
        assert_eq!(pixel(-0.01), "0");
        assert_eq!(pixel(12.0), "12");
        assert_eq!(pixel(12.46), "12.5");
    }
}
