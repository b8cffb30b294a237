//! What a campaign says, as a text.

use crate::footprint::Footprint;
use crate::results::Results;
use crate::sampling::CaseSampling;
use crate::summary::{CONFIDENCE, CampaignSummary, RequirementVerdict, Told};
use crate::table::{counted, heading, percent};

/// Digits behind the point of parts in percent: 0.135 has three.
const PLACES: usize = 4;

/// A summary as a text.
#[must_use]
pub fn text(results: &Results, summary: &CampaignSummary) -> String {
    let model = &results.manifest.model;
    let cases = summary.cases;
    let mut text = match results.manifest.sampling {
        CaseSampling::Grid => format!(
            "{model}: {} of a grid beside the nominal; percentiles are shares of these points: a grid is no random sample, and has no confidence\n",
            counted(cases, "point")
        ),
        _ => format!(
            "{model}: {} beside the nominal; percentiles by order statistics, with intervals of {:.0} % confidence\n",
            counted(cases, "case"),
            100.0 * CONFIDENCE
        ),
    };
    for told in &summary.metrics {
        text += &metric(results, told);
    }
    let envelopes = results.manifest.envelopes.iter();
    for beyond in envelopes.filter_map(|envelopes| envelopes.beyond(&results.rows)) {
        text += &format!("\n{beyond}\n");
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
            "\n  {:>8} %  {inside} of {} inside",
            percent(ellipse.part, PLACES),
            counted(of as u64, "case")
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
        let cases = match told.without {
            1 => "1 case has no value and is".to_owned(),
            n => format!("{n} cases have no value and are"),
        };
        text += &format!(
            "  {cases} left out of what follows{}\n",
            why.unwrap_or_default()
        );
    }
    if let Some(caution) = told.caution() {
        text += &format!("  {caution}\n");
    }
    if let Some(cut) = &told.cut {
        text += &format!("  {}\n", cut.sentence());
    }
    for percentile in &told.percentiles {
        let interval = match results.manifest.sampling {
            CaseSampling::Grid => String::new(),
            _ => {
                let [low, high] = [percentile.low, percentile.high].map(digits);
                format!("   from {low} to {high}")
            }
        };
        text += &format!(
            "  {:>8} %  {:>12}{interval}\n",
            percent(percentile.part, PLACES),
            digits(Some(percentile.value))
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
        let company = driver.company(&results.manifest.dispersed);
        let company = company.map_or_else(String::new, |text| format!(" ({text})"));
        format!("{name} {:+.2}{share}{company}", driver.correlation)
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
            // Of few cases chance alone makes large ones, and the first is the largest of all.
            let chance = match results.manifest.sampling {
                CaseSampling::Grid => String::new(),
                _ => format!(", by chance alone within ±{:.2}", told.chance()),
            };
            text + &format!(
                "  driven by (rank correlation{chance}{share}): {}\n",
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
        match (self.shown, self.require.confidence) {
            (true, _) => Some(true),
            _ if self.withheld => None,
            (false, None) => Some(false),
            _ => (self.missed as f64 > allowed).then_some(false),
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
        let share = percent(self.require.share, PLACES);
        let what = format!("{name} {} in {share} %", bounds.join(" and "));
        match self.require.confidence {
            _ if self.withheld => {
                format!("NOT JUDGED: {what}: its reaction is one choice of many")
            }
            Some(confidence) => self.of_cases(&what, &percent(confidence, PLACES)),
            None => self.of_points(&what),
        }
    }

    /// What became of it where the cases are a sample of all.
    fn of_cases(&self, what: &str, confidence: &str) -> String {
        let without = match self.without {
            0 => String::new(),
            without => format!(", {without} of them without a value"),
        };
        let what = format!(
            "{what} of all cases with {confidence} % confidence: {} of {} {} it{without}{}",
            self.missed,
            counted(self.of, "case"),
            if self.missed == 1 { "misses" } else { "miss" },
            self.in_part()
        );
        match (self.holds(), self.needed) {
            (Some(true), _) => format!("shown: {what}"),
            (None, Some(needed)) => format!(
                "NOT ENOUGH CASES: {what}, and {} with no more misses would show it",
                counted(needed, "case")
            ),
            _ => format!("NOT MET: {what}"),
        }
    }

    /// What became of it at the points of a grid.
    fn of_points(&self, what: &str) -> String {
        let word = if self.shown { "met" } else { "NOT MET" };
        let without = match self.without {
            0 => String::new(),
            without => format!(", {without} of the others without a value"),
        };
        let kept = self.of - self.missed;
        format!(
            "{word}: {what} of the points: of the {} of the grid {kept} {} it{without}{}; a grid has no confidence",
            counted(self.of, "point"),
            if kept == 1 { "keeps" } else { "keep" },
            self.in_part()
        )
    }

    /// How many keep it in a part of the window only, where some do.
    fn in_part(&self) -> String {
        match self.partial {
            0 => String::new(),
            1 => "; of 1 that keeps it only a part of the window was flown".to_owned(),
            cases => format!("; of {cases} that keep it only a part of the window was flown"),
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
        // What is not all is not told as all.
        assert_eq!(
            [0.999_999_9, 1.0, 1e-9, 0.0].map(|part| percent(part, PLACES)),
            ["99.99999", "100", "0.0000001", "0"]
        );
        assert_eq!(digits(Some(12345.678)), "12346");
        assert_eq!(digits(Some(-0.012_345_678)), "-0.012346");
        assert_eq!(digits(Some(1.5e9)), "1.5000e9");
        assert_eq!(digits(None), "(not enough cases)");
    }
}
