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

/// A number with at most so many significant digits and no zeros behind the last of them: `0.02`, `-9.808`, `3`.
#[must_use]
pub fn plain(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    let (number, exponent) = match text.split_once('e') {
        Some((number, exponent)) => (number, format!("e{exponent}")),
        None => (text.as_str(), String::new()),
    };
    let number = match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.'),
        false => number,
    };
    format!("{number}{exponent}")
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
    fn a_number_of_a_message_has_no_exponent_where_it_can_do_without() {
        let told = [3.0, -9.808, 0.5, 0.02, 1e5, 1.5e-7, 2e9].map(|value| plain(value, 4));
        assert_eq!(
            told,
            ["3", "-9.808", "0.5", "0.02", "100000", "1.5e-7", "2e9"]
        );
        assert_eq!(plain(0.0, 3), "0");
        assert_eq!(plain(f64::NAN, 3), "NaN");
    }
}
