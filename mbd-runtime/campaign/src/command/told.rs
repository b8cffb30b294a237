//! What a campaign says, as a text.

use crate::footprint::Footprint;
use crate::results::Results;
use crate::summary::{CONFIDENCE, CampaignSummary, RequirementVerdict, Told};
use crate::table::{heading, percent};

/// Digits behind the point of parts in percent: 0.135 has three.
const PLACES: usize = 4;

/// A summary as a text.
#[must_use]
pub fn text(results: &Results, summary: &CampaignSummary) -> String {
    let mut text = format!(
        "{}: {} cases beside the nominal; percentiles by order statistics, with intervals of {:.0} % confidence\n",
        results.manifest.model,
        summary.cases,
        100.0 * CONFIDENCE
    );
    for told in &summary.metrics {
        text += &metric(results, told);
    }
    for footprint in &results.manifest.told.footprints {
        text += &inside(results, footprint);
    }
    for failures in &summary.failures {
        let first = failures.cases.first().copied().unwrap_or(0);
        text += &format!(
            "\n{} × {}: case {first}: {}\n",
            failures.cases.len(),
            failures.status,
            failures.why
        );
    }
    text
}

/// How many cases the ellipses of a footprint hold.
fn inside(results: &Results, footprint: &Footprint) -> String {
    let Some(spread) = footprint.of(results) else {
        return String::new();
    };
    let of = spread.places.len();
    let held = spread.ellipses.iter().map(|ellipse| {
        let inside = ellipse.inside;
        format!(
            "\n  {:>8} %  {inside} of {of} cases inside",
            percent(ellipse.part, PLACES)
        )
    });
    let held: String = held.collect();
    let held = match held.is_empty() {
        true => "\n  no ellipse: fewer than three cases, or all on a line".to_owned(),
        false => held,
    };
    format!(
        "\n{} over {}, ellipses of normal cases{held}\n",
        footprint.y, footprint.x
    )
}

fn metric(results: &Results, told: &Told) -> String {
    let [mean, deviation] = told.moments;
    let mut text = format!(
        "\n{}\n  nominal {}, mean {}, standard deviation {}\n",
        heading(&told.name, &told.unit),
        digits(Some(told.nominal)),
        digits(Some(mean)),
        digits(Some(deviation))
    );
    if told.without > 0 {
        let why = told.reason().map(|why| format!(", because {why}"));
        text += &format!(
            "  {} cases have no value and are left out of what follows{}\n",
            told.without,
            why.unwrap_or_default()
        );
    }
    if let Some(cut) = &told.cut {
        text += &format!("  {}\n", cut.sentence());
    }
    for percentile in &told.percentiles {
        text += &format!(
            "  {:>8} %  {:>12}   from {} to {}\n",
            percent(percentile.part, PLACES),
            digits(Some(percentile.value)),
            digits(percentile.low),
            digits(percentile.high)
        );
    }
    if let Some([low, high]) = told.ends
        && let (Some(smallest), Some(largest)) = (told.sorted.first(), told.sorted.last())
    {
        text += &format!(
            "  smallest {} (case {low}), largest {} (case {high})\n",
            digits(Some(*smallest)),
            digits(Some(*largest))
        );
    }
    if let Some(verdict) = &told.verdict {
        text += &format!("  {}\n", verdict.sentence(&told.name, &told.unit));
    }
    let drivers = told.drivers.iter().take(5).map(|driver| {
        let name = results
            .manifest
            .dispersed
            .get(driver.number)
            .map_or("", |column| &column.name);
        let share = driver.index.map(|index| format!(" {:.0} %", 100.0 * index));
        let share = share.unwrap_or_default();
        format!("{name} {:+.2}{share}", driver.correlation)
    });
    let drivers: Vec<String> = drivers.collect();
    match drivers.is_empty() {
        true => text,
        false => {
            let shares = told.drivers.iter().take(5).any(|it| it.index.is_some());
            let share = if shares {
                ", share of the variance"
            } else {
                ""
            };
            text + &format!(
                "  driven by (rank correlation{share}): {}\n",
                drivers.join(", ")
            )
        }
    }
}

impl RequirementVerdict {
    /// Whether it is shown, or shown not to be so among the cases that there are; `None` where more cases may decide it.
    #[must_use]
    pub fn holds(&self) -> Option<bool> {
        let allowed = (1.0 - self.require.share) * self.of as f64;
        match (self.shown, self.missed as f64 > allowed) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        }
    }

    /// The requirement and what became of it, in one sentence.
    #[must_use]
    pub fn sentence(&self, name: &str, unit: &str) -> String {
        let bounds = [(self.require.below, "below"), (self.require.above, "above")];
        let bounds = bounds
            .into_iter()
            .filter_map(|(bound, word)| Some(format!("{word} {} {unit}", digits(Some(bound?)))));
        let bounds: Vec<String> = bounds.map(|text| text.trim_end().to_owned()).collect();
        let without = match self.without {
            0 => String::new(),
            without => format!(", {without} of them without a value"),
        };
        let partial = match self.partial {
            0 => String::new(),
            cases => format!("; of {cases} that keep it only a part of the window was flown"),
        };
        let what = format!(
            "{name} {} in {} % of all cases with {} % confidence: {} of {} cases miss it{without}{partial}",
            bounds.join(" and "),
            percent(self.require.share, PLACES),
            percent(self.require.confidence, PLACES),
            self.missed,
            self.of
        );
        match self.holds() {
            Some(true) => format!("shown: {what}"),
            Some(false) => format!("NOT MET: {what}"),
            None => format!(
                "NOT ENOUGH CASES: {what}, and {} cases with no more misses would show it",
                self.needed
            ),
        }
    }
}

/// Five digits; `not enough cases` where there is no number.
fn digits(value: Option<f64>) -> String {
    match value {
        None => "(not enough cases)".to_owned(),
        Some(value) if value.is_nan() => "–".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(value) => {
            let places = (4 - value.abs().log10().floor() as i32).clamp(0, 12) as usize;
            match (1e-4..1e7).contains(&value.abs()) {
                true => format!("{value:.places$}"),
                false => format!("{value:.4e}"),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_numbers_are_told_with_the_digits_they_have() {
        assert_eq!(
            [0.99865, 0.5, 0.00135].map(|part| percent(part, PLACES)),
            ["99.865", "50", "0.135"]
        );
        assert_eq!(digits(Some(12345.678)), "12346");
        assert_eq!(digits(Some(-0.012_345_678)), "-0.012346");
        assert_eq!(digits(Some(1.5e9)), "1.5000e9");
        assert_eq!(digits(None), "(not enough cases)");
    }
}
