//! Footprints.

use mbd_report::{Cell, Figure, Look, Report, ReportTable, Series};

use crate::footprint::FootprintStatistics;
use crate::table::percent;

/// Places on an ellipse.
const PLACES: usize = 120;
/// How the ellipses are drawn, the first one first.
const LOOKS: [Look; 4] = [Look::Dashed, Look::DashDot, Look::LongDash, Look::Dotted];

/// The curves of a footprint, each its x and its y.
pub struct FootprintCurves {
    title: String,
    axes: [[String; 2]; 2],
    cases: [Vec<f64>; 2],
    nominal: [f64; 2],
    ellipses: Vec<(String, [Vec<f64>; 2])>,
}

/// Across and upwards apart.
fn apart(places: &[[f64; 2]]) -> [Vec<f64>; 2] {
    [0, 1].map(|k| places.iter().map(|place| place[k]).collect())
}

impl FootprintCurves {
    /// Those of a footprint.
    pub fn of(spread: &FootprintStatistics) -> Self {
        let ellipses = spread.spot.iter().flat_map(|spot| {
            let ellipses = spread.ellipses.iter();
            ellipses.map(|ellipse| {
                let name = format!("ellipse of {} %", percent(ellipse.part, 2));
                (name, apart(&ellipse.places(spot.mean, PLACES)))
            })
        });
        let [[x, _], [y, _]] = &spread.axes;
        FootprintCurves {
            title: format!("{y} over {x}"),
            axes: spread.axes.clone(),
            cases: apart(&spread.places),
            nominal: spread.nominal,
            ellipses: ellipses.collect(),
        }
    }

    /// Their figure; of one unit with one scale.
    pub fn figure(&self) -> Figure<'_> {
        let [[x, x_unit], [y, y_unit]] = &self.axes;
        let [across, upwards] = &self.cases;
        let mut figure = Figure::new(&self.title).x(x, x_unit).y(y, y_unit).series(
            Series::new("cases", across, upwards)
                .look(Look::ShortDash)
                .dots(),
        );
        for ((name, [x, y]), look) in self.ellipses.iter().zip(LOOKS.into_iter().cycle()) {
            figure = figure.series(Series::new(name, x, y).look(look));
        }
        let [x, y] = &self.nominal;
        if x.is_finite() && y.is_finite() {
            let nominal = Series::new(
                "nominal case",
                std::slice::from_ref(x),
                std::slice::from_ref(y),
            );
            figure = figure.series(nominal.look(Look::Thin));
        }
        match x_unit == y_unit {
            true => figure.equal(),
            false => figure,
        }
    }
}

/// Adds what is told of a footprint in words.
pub fn spread(report: Report, spread: &FootprintStatistics) -> Report {
    let report = match spread.without {
        0 => report,
        1 => report.paragraph("1 case does not have both values and is left out."),
        n => report.paragraph(&format!(
            "{n} cases do not have both values and are left out."
        )),
    };
    match spread.spot {
        Some(_) => report.table(&ellipses(spread)),
        None => report.paragraph("There is no ellipse: fewer than three cases, or all on a line."),
    }
}

fn ellipses(spread: &FootprintStatistics) -> ReportTable {
    let [[x, x_unit], [y, y_unit]] = &spread.axes;
    let one_unit = x_unit == y_unit;
    let unit = if one_unit { x_unit.as_str() } else { "" };
    let mut table = ReportTable::new(format!("Ellipses of {y} over {x}"))
        .column("of normal cases", "")
        .column("inside", "cases")
        .column("of", "cases")
        .number("inside", "%", 4)
        .number("half axes", unit, 5)
        .number("", unit, 5)
        .number("direction", "deg", 4);
    let all = spread.places.len();
    for ellipse in &spread.ellipses {
        // Lengths and angles across two units mean nothing.
        let told = |x: f64| match one_unit {
            true => Cell::Number(x),
            false => Cell::Missing,
        };
        let [long, short] = ellipse.half_axes;
        table.push([
            format!("{} %", percent(ellipse.part, 2)).into(),
            Cell::Count(ellipse.inside),
            all.into(),
            (100.0 * ellipse.inside as f64 / all as f64).into(),
            told(long),
            told(short),
            told(ellipse.direction.to_degrees()),
        ]);
    }
    let spot = spread.spot.as_ref();
    let mean = spot.map_or([f64::NAN; 2], |spot| spot.mean);
    let correlation = spot.map_or(f64::NAN, |spot| {
        let [xx, yy, xy] = spot.covariance;
        xy / (xx * yy).sqrt()
    });
    let told = |value: f64, unit: &str| {
        format!("{} {unit}", mbd_report::significant(value, 5))
            .trim_end()
            .to_owned()
    };
    table.note(format!(
        "Mean {x} {}, {y} {}; correlation {correlation:.3}. An ellipse about the mean with half axes k √λ, λ the eigenvalues of the covariance, holds 1 − exp(−k²/2) of \
         normal cases; how many it does hold is counted. Direction: of the longer half axis, from {x} towards {y}.",
        told(mean[0], x_unit),
        told(mean[1], y_unit)
    ))
}
