//! Histories of models that went on from each other, put together as one.

use super::{Content, Sampling, Trajectory};
use crate::columns::Name;
use crate::dropped_here::DroppedHere;
use crate::error::Statistics;
use crate::measure::Measures;
use crate::metric::MetricReader;
use crate::row::RowMaker;

/// The columns of runs that come to several models: `time`, a column `phase` that counts the parts of a run from 1, and the columns of all models, also of those
/// that a run does not come to. Columns of the same name and unit are one. A column whose name has another unit in a model before is told by the number of its own
/// model, `load (2)`.
///
/// ```
/// use mbd_runtime::{Content, Joined, Options, Sampling, Simulation, Trajectory, model};
///
/// model! {
///     /// A capsule under its parachute, until a time.
///     model Chute {
///         gravity: [0.0, 0.0, -10.0] m/s^2;
///         point capsule { mass: 80 kg, start at [0.0, 0.0, 100.0] m }
///         load drag on capsule = -200 N*s/m * capsule.velocity;
///         event released = time rises 1 s { then: stop }
///         output height = capsule.position.z;
///     }
/// }
///
/// model! {
///     /// The capsule alone.
///     model Fall {
///         gravity: [0.0, 0.0, -10.0] m/s^2;
///         point capsule { mass: 80 kg }
///         output height = capsule.position.z;
///         output speed = -capsule.velocity.z;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (chute, fall) = (Chute::new(ChuteParams::default())?, Fall::new(FallParams::default())?);
/// let mut first = Trajectory::new(&chute, Sampling::Steps, Content::RESULTS);
/// let mut second = Trajectory::new(&fall, Sampling::Steps, Content::RESULTS);
/// let columns = Joined::new(&[&first, &second]);
///
/// let mut under_chute = Simulation::new(&chute, Options::rk4(0.1))?;
/// under_chute.record(2.0, &mut first)?;
/// let mut falling = Simulation::new(&fall, Options::rk4(0.1))?;
/// falling.take_over(&mut under_chute, &[])?;
/// falling.record(2.0, &mut second)?;
///
/// let history = columns.join(&[(0, &first), (1, &second)]);
/// assert_eq!(history.len(), first.len() + second.len());
/// assert!(history.column("height").is_some_and(|height| height.is_sorted_by(|a, b| a >= b)));
/// assert!(history.column("speed").is_some_and(|speed| speed[0].is_nan()));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    names: Vec<Name>,
    /// Per model, where each of its columns goes.
    places: Vec<Vec<usize>>,
}

impl Joined {
    /// Those of models with such histories.
    #[must_use]
    pub fn new(models: &[&Trajectory]) -> Self {
        let mut names = vec![Name::new("time", "", "s"), Name::new("phase", "", "")];
        let mut places: Vec<Vec<usize>> = Vec::with_capacity(models.len());
        for (number, model) in (1..).zip(models) {
            let place = |name: &Name| {
                let alike = |known: &Name| known.name == name.name && known.unit == name.unit;
                if let Some(known) = names.iter().position(alike) {
                    return known;
                }
                let mut own = name.clone();
                if names.iter().any(|known| known.name == name.name) {
                    own.name = format!("{} ({number})", name.name);
                }
                names.push(own);
                names.len() - 1
            };
            places.push(model.names.iter().map(place).collect());
        }
        Joined { names, places }
    }

    /// Names and units of the columns, in order.
    #[must_use]
    pub fn names(&self) -> &[Name] {
        &self.names
    }

    /// Whether the history of a model, by its index, has a column here.
    #[must_use]
    pub fn has(&self, model: usize, column: usize) -> bool {
        let places = self.places.get(model);
        places.is_some_and(|places| places.contains(&column))
    }

    /// What the history of a model, by its index, measures for these metrics of the columns here: those whose quantity it has, and instants of events.
    #[must_use]
    pub fn readers(&self, model: usize, readers: &[MetricReader]) -> Vec<MetricReader> {
        let places = self.places.get(model).map_or(&[][..], Vec::as_slice);
        let own = readers.iter().filter_map(|reader| {
            let column = places.iter().position(|place| *place == reader.column);
            Some(MetricReader {
                column: column?,
                ..reader.clone()
            })
        });
        own.collect()
    }

    /// How histories with the columns here tell what the history of a model, by its index, measures by this reader; the reverse of [`Joined::readers`].
    #[must_use]
    pub fn reader(&self, model: usize, reader: &MetricReader) -> MetricReader {
        let places = self.places.get(model).map_or(&[][..], Vec::as_slice);
        MetricReader {
            column: places.get(reader.column).copied().unwrap_or(0),
            ..reader.clone()
        }
    }

    /// The parts of a run, each the history of a model by its index, as one; what a model has not is not a number in its rows. Metrics
    /// that they measure ([`Joined::readers`]) are those of all parts, or of the parts of some models ([`Trajectory::measured_in`]).
    #[must_use]
    pub fn join(&self, parts: &[(usize, &Trajectory)]) -> Trajectory {
        let first = parts.first();
        let content = first.map_or(Content::RESULTS, |(_, part)| part.maker.content);
        let mut joined = Trajectory {
            // No model has all of them.
            model: 0,
            maker: DroppedHere::new(RowMaker::new(content, self.names.len())),
            beside: false,
            end: parts.last().map_or(f64::NAN, |(_, part)| part.end),
            declared: Vec::new(),
            measures: DroppedHere::new(Measures::default()),
            parts: Vec::with_capacity(parts.len()),
            measured: DroppedHere::new(RowMaker::new(content, 0)),
            inside: DroppedHere::new(RowMaker::new(content, 0)),
            sampling: Sampling::Steps,
            first: f64::NAN,
            next: 0,
            undetermined: parts.iter().map(|(_, part)| part.undetermined).sum(),
            locates: parts.iter().all(|(_, part)| part.locates),
            events: Vec::new(),
            statistics: Statistics::default(),
            columns: vec![Vec::new(); self.names.len()],
            names: self.names.clone(),
            outputs: Vec::new(),
            efforts: Vec::new(),
        };
        for ((model, part), phase) in parts.iter().zip(1_u32..) {
            let (before, rows) = (joined.len(), part.len());
            let places = self.places.get(*model).map_or(&[][..], Vec::as_slice);
            for (place, column) in places.iter().zip(&part.columns) {
                joined.columns[*place].extend_from_slice(column);
            }
            // What a model has not is no number by design.
            let own = part.outputs.iter().filter_map(|(column, _)| {
                let place = places.get(*column)?;
                Some((*place, before..before + rows))
            });
            joined.outputs.extend(own);
            let efforts = part.efforts.iter();
            let efforts = efforts.filter_map(|column| places.get(*column).copied());
            joined.efforts.extend(efforts);
            joined.columns[1].extend(std::iter::repeat_n(f64::from(phase), rows));
            let all = joined.columns.iter_mut();
            all.for_each(|column| column.resize(before + rows, f64::NAN));
            let whole = |reader: &MetricReader| self.reader(*model, reader);
            let measured = part.measures.as_part((*model, part.end), &whole);
            joined.parts.push(measured);
            joined.events.extend(part.events.iter().cloned());
            joined.statistics = joined.statistics.and(part.statistics);
            if part.sampling != Sampling::Steps {
                joined.sampling = part.sampling.clone();
            }
        }
        joined.first = joined.times().first().copied().unwrap_or(f64::NAN);
        joined
    }
}
