//! Numbers of drawings.

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
    fn pixels_have_one_decimal_and_no_negative_zero() {
        assert_eq!(pixel(-0.01), "0");
        assert_eq!(pixel(12.0), "12");
        assert_eq!(pixel(12.46), "12.5");
    }
}
