//! Footprints: two metrics of every case as a place in a plane, with the ellipses that hold a part of normal ones, and what they do hold.

use mbd_runtime::scene::similar::did_you_mean;
use serde::{Deserialize, Serialize};

use crate::dispersion::WrittenFootprint;
use crate::metric::CampaignMetric;
use crate::results::Results;
use crate::run::PlanError;
use crate::run::names::wrong;
use crate::statistics::{Ellipse, Spot};

/// Two metrics that are told together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Footprint {
    /// The metric across.
    pub x: String,
    /// The metric upwards.
    pub y: String,
    /// The parts that the ellipses hold of normal numbers, 0 … 1.
    pub shares: Vec<f64>,
}

/// What the cases say of a footprint.
#[derive(Clone, Debug, PartialEq)]
pub struct FootprintStatistics {
    /// Names and units, across and upwards.
    pub axes: [[String; 2]; 2],
    /// The nominal case; NaN where it has no value.
    pub nominal: [f64; 2],
    /// The places of the cases that have both values, in order.
    pub places: Vec<[f64; 2]>,
    /// Cases that have not.
    pub without: u64,
    /// Mean and covariance; `None` of fewer than three cases and where all lie on a line.
    pub spot: Option<Spot>,
    /// The ellipses.
    pub ellipses: Vec<Ellipse>,
}

impl Footprint {
    /// As it is written, of a campaign with these metrics.
    ///
    /// # Errors
    /// The first setting that cannot be used.
    pub fn new(
        written: &WrittenFootprint,
        metrics: &[CampaignMetric],
        setting: &str,
    ) -> Result<Self, PlanError> {
        for (axis, name) in [("x", &written.x), ("y", &written.y)] {
            let mut names = metrics.iter().map(|metric| metric.name.as_str());
            if !names.clone().any(|known| known == name) {
                let near = did_you_mean(name, names.by_ref());
                let text = format!("there is no metric `{name}`{near}");
                return Err(wrong(format!("{setting}.{axis}"), text));
            }
        }
        if written.x == written.y {
            return Err(wrong(
                setting,
                format!("`{}` is both of its metrics", written.x),
            ));
        }
        // One, two and three standard deviations.
        let sigmas = [1.0_f64, 2.0, 3.0].map(|k| -(-0.5 * k * k).exp_m1());
        let shares = written.shares.clone().unwrap_or_else(|| sigmas.to_vec());
        match shares
            .iter()
            .find(|share| !(**share > 0.0 && **share < 1.0))
        {
            Some(share) => Err(wrong(
                format!("{setting}.shares"),
                format!("{share} does not lie between 0 and 1: shares = [0.5, 0.99]"),
            )),
            None => Ok(Footprint {
                x: written.x.clone(),
                y: written.y.clone(),
                shares,
            }),
        }
    }

    /// What the cases say; `None` where these results do not have its metrics.
    #[must_use]
    pub fn of(&self, results: &Results) -> Option<FootprintStatistics> {
        let columns = &results.manifest.metrics;
        let find = |name: &String| columns.iter().position(|column| column.name == *name);
        let at = [find(&self.x)?, find(&self.y)?];
        let place = |row: &crate::CaseRow| at.map(|at| row.metrics[at]);
        let all = results.rows.iter().skip(1).map(place);
        let places: Vec<[f64; 2]> = all
            .filter(|place| place.iter().all(|x| x.is_finite()))
            .collect();
        let spot = Spot::of(&places);
        let ellipses = spot.iter().flat_map(|spot| {
            let shares = self.shares.iter();
            shares.map(|share| spot.ellipse(*share, &places))
        });
        Some(FootprintStatistics {
            axes: at.map(|at| [columns[at].name.clone(), columns[at].unit.clone()]),
            nominal: results.rows.first().map_or([f64::NAN; 2], place),
            without: (results.rows.len() - 1 - places.len()) as u64,
            ellipses: ellipses.collect(),
            spot,
            places,
        })
    }
}
