//! One axis: its range, its ticks and the place of a value on it.

/// Linear or logarithmic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Scale {
    #[default]
    Linear,
    Log,
}

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    /// Place along the axis, 0 … 1.
    pub place: f64,
    /// Its label; empty for a minor tick.
    pub label: String,
}

/// An axis from `low` to `high` (their decimal logarithms if logarithmic).
#[derive(Clone, Debug)]
pub(super) struct PlotAxis {
    low: f64,
    high: f64,
    scale: Scale,
    /// The marks, in ascending order.
    pub ticks: Vec<Tick>,
    /// Labels are multiples of ten to this power.
    pub exponent: i32,
}

/// How a range is chosen.
#[derive(Clone, Copy, Debug)]
pub(super) enum RangeChoice {
    /// Exactly these ends.
    Fixed(f64, f64),
    /// These data; an end that almost reaches a whole tick is moved to it.
    JointForces(f64, f64),
    /// These data, rounded outwards to whole ticks; zero is included when it is near.
    Around(f64, f64),
}

/// Numbers beyond this are not drawn: their differences would overflow.
pub(super) const HUGE: f64 = 1e300;

impl PlotAxis {
    /// An axis with about `count` ticks.
    pub fn new(range: RangeChoice, scale: Scale, count: usize) -> PlotAxis {
        match scale {
            Scale::Linear => linear(range, count.max(2)),
            Scale::Log => logarithmic(range, count.max(2)),
        }
    }

    /// Its low and its high end; decimal logarithms if logarithmic.
    pub fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// The place of a value: 0 at the low end, 1 at the high end; `None` if it cannot be drawn (not finite, or ≤ 0 on a logarithmic axis).
    pub fn place(&self, value: f64) -> Option<f64> {
        let value = match self.scale {
            Scale::Linear => value,
            Scale::Log if value > 0.0 => value.log10(),
            Scale::Log => return None,
        };
        (value.abs() <= HUGE).then(|| (value - self.low) / (self.high - self.low))
    }
}

/// Ends that differ visibly, in order.
fn opened(low: f64, high: f64) -> (f64, f64) {
    let (low, high) = (low.min(high), low.max(high));
    let size = low.abs().max(high.abs());
    if !(high - low).is_finite() || size > HUGE {
        return (0.0, 1.0);
    }
    if high - low > (1e-12 * size).max(1e-290) {
        return (low, high);
    }
    let pad = if size < 1e-290 { 1.0 } else { 0.1 * size };
    (low - pad, high + pad)
}

fn linear(range: RangeChoice, count: usize) -> PlotAxis {
    let (mut low, mut high) = match range {
        RangeChoice::Fixed(low, high) | RangeChoice::JointForces(low, high) => opened(low, high),
        RangeChoice::Around(low, high) => {
            let (low, high) = opened(low, high);
            let near = 0.3 * (high - low);
            if low > 0.0 && low < near {
                (0.0, high)
            } else if high < 0.0 && high > -near {
                (low, 0.0)
            } else {
                (low, high)
            }
        }
    };
    let step = nice_step((high - low) / count as f64);
    // How much of a step may be added at an end.
    let reach = match range {
        RangeChoice::Fixed(..) => 0.0,
        RangeChoice::JointForces(..) => 0.1,
        RangeChoice::Around(..) => 1.0,
    };
    let (floor, ceiling) = (
        (low / step + 1e-9).floor() * step,
        (high / step - 1e-9).ceil() * step,
    );
    if low - floor < reach * step {
        low = floor;
    }
    if ceiling - high < reach * step {
        high = ceiling;
    }
    let exponent = common_exponent(low.abs().max(high.abs()));
    let scaled = step / 10f64.powi(exponent);
    let decimals = (-(scaled.log10() + 1e-9).floor()).clamp(0.0, 17.0) as usize;
    let first = (low / step - 1e-6).ceil();
    let last = (high / step + 1e-6).floor();
    let ticks = (0..=(last - first).clamp(0.0, 100.0) as usize)
        .map(|index| {
            let multiple = first + index as f64;
            Tick {
                place: (multiple * step - low) / (high - low),
                label: minus(format!("{:.decimals$}", multiple * scaled + 0.0)),
            }
        })
        .collect();
    PlotAxis {
        low,
        high,
        scale: Scale::Linear,
        ticks,
        exponent,
    }
}

/// 1, 2 or 5 times a power of ten, not below `raw`.
fn nice_step(raw: f64) -> f64 {
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|&step| step >= raw * (1.0 - 1e-9));
    step.unwrap_or(10.0 * power).max(f64::MIN_POSITIVE)
}

/// The power of ten taken out of the labels of large and of small numbers, a multiple of three.
fn common_exponent(size: f64) -> i32 {
    if size == 0.0 || (1e-2..1e5).contains(&size) {
        return 0;
    }
    let exponent = ((size.log10() + 1e-9) / 3.0).floor() * 3.0;
    exponent.clamp(-300.0, 300.0) as i32
}

/// A logarithmic axis always spans whole decades.
fn logarithmic(range: RangeChoice, count: usize) -> PlotAxis {
    let (RangeChoice::Fixed(low, high)
    | RangeChoice::JointForces(low, high)
    | RangeChoice::Around(low, high)) = range;
    let decade = |x: f64| x.clamp(1.0 / HUGE, HUGE).log10();
    let low = (decade(low.min(high)) + 1e-9).floor();
    let high = (decade(low.max(high)) - 1e-9).ceil();
    let (low, high) = if high > low {
        (low, high)
    } else {
        (low, low + 1.0)
    };
    let stride = ((high - low) / count as f64).ceil().max(1.0);
    let mut ticks = Vec::new();
    for index in 0..=(high - low) as usize {
        let power = low + index as f64;
        ticks.push(Tick {
            place: (power - low) / (high - low),
            label: if index as f64 % stride == 0.0 {
                format!("10{}", superscript(power as i32))
            } else {
                String::new()
            },
        });
        if stride == 1.0 && power < high {
            ticks.extend((2..10).map(|factor| Tick {
                place: (power + f64::from(factor).log10() - low) / (high - low),
                label: String::new(),
            }));
        }
    }
    PlotAxis {
        low,
        high,
        scale: Scale::Log,
        ticks,
        exponent: 0,
    }
}

fn minus(text: String) -> String {
    // A value that rounds to zero loses its sign.
    if text
        .trim_start_matches('-')
        .chars()
        .all(|c| c == '0' || c == '.')
    {
        text.trim_start_matches('-').to_string()
    } else {
        text.replace('-', "\u{2212}")
    }
}

/// A whole number in superscript: ⁻³.
pub(super) fn superscript(number: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    number
        .to_string()
        .chars()
        .map(|c| {
            c.to_digit(10)
                .map_or('⁻', |digit| DIGITS[digit as usize % 10])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &PlotAxis) -> Vec<&str> {
        axis.ticks
            .iter()
            .map(|tick| tick.label.as_str())
            .filter(|label| !label.is_empty())
            .collect()
    }

    #[test]
    fn a_build_up_to_2810_newton_is_labelled_in_steps_of_500() {
        let axis = PlotAxis::new(RangeChoice::Around(0.0, 2810.0), Scale::Linear, 6);
        assert_eq!(
            labels(&axis),
            ["0", "500", "1000", "1500", "2000", "2500", "3000"]
        );
        assert_eq!(axis.place(1500.0), Some(0.5));
    }

    #[test]
    fn a_window_keeps_its_ends_and_ticks_lie_inside() {
        let axis = PlotAxis::new(RangeChoice::Fixed(5.05, 5.95), Scale::Linear, 6);
        assert_eq!(axis.place(5.05), Some(0.0));
        assert!(
            axis.ticks
                .iter()
                .all(|tick| (-1e-6..=1.000001).contains(&tick.place))
        );
        assert_eq!(labels(&axis).first(), Some(&"5.2"));
    }

    #[test]
    fn constant_data_get_an_axis_around_them() {
        for value in [0.0, 2810.0, -3.0, 1e-200, 3.4e6] {
            let axis = PlotAxis::new(RangeChoice::Around(value, value), Scale::Linear, 6);
            let place = axis.place(value).unwrap();
            assert!(place > 0.1 && place < 0.9, "{value}: {place}");
            assert!(axis.ticks.len() >= 3);
        }
    }

    #[test]
    fn large_and_small_numbers_share_a_power_of_ten() {
        let axis = PlotAxis::new(RangeChoice::Around(3.39e6, 3.40e6), Scale::Linear, 5);
        assert_eq!(axis.exponent, 6);
        let axis = PlotAxis::new(RangeChoice::Around(0.0, 2e-5), Scale::Linear, 5);
        assert_eq!((axis.exponent, labels(&axis)[1]), (-6, "5"));
    }

    #[test]
    fn errors_over_seven_decades_have_a_tick_a_decade() {
        let axis = PlotAxis::new(RangeChoice::Around(3e-9, 15.0), Scale::Log, 12);
        assert_eq!(labels(&axis).first(), Some(&"10⁻⁹"));
        assert_eq!(labels(&axis).last(), Some(&"10²"));
        assert_eq!(axis.place(0.0), None);
        assert_eq!(axis.place(-1.0), None);
    }

    #[test]
    fn impossible_ranges_give_an_axis_all_the_same() {
        for (low, high) in [
            (f64::NAN, 1.0),
            (f64::NEG_INFINITY, f64::INFINITY),
            (1e308, -1e308),
            (5e-324, 0.0),
        ] {
            for scale in [Scale::Linear, Scale::Log] {
                for range in [
                    RangeChoice::Around(low, high),
                    RangeChoice::Fixed(low, high),
                ] {
                    let axis = PlotAxis::new(range, scale, 6);
                    assert!(axis.ticks.len() < 5000);
                    assert!(axis.ticks.iter().all(|tick| tick.place.is_finite()));
                }
            }
        }
    }
}
