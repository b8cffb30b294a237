//! Which rows stay, which joints the others repeat, and which motors drive a coordinate that is held already.

use nalgebra::DVector;

use crate::redundancy::assembly::LinearisedState;
use crate::redundancy::stress::SelfStress;
use crate::redundancy::tree::LoopGroup;
use crate::scalar::orthogonal::{subtract, take_out};
use crate::{HeldMotor, Repeat, RowSet};

/// What is left of a row below this part of it is rounding: repeated rows leave 1e-12, others rarely less than 1e-3.
const NEW: f64 = 1e-8;
/// Rows whose new parts differ by less than this factor are equally good; the first is taken.
const AS_GOOD: f64 = 0.8;

/// Directions of the rows so far, each with the kept rows it is made of.
#[derive(Clone, Default)]
struct Span {
    units: Vec<(DVector<f64>, Vec<f64>)>,
}

impl Span {
    /// What is new in a row of size 1 or less, and what of the kept rows was taken out of it.
    fn rest(&self, row: &DVector<f64>) -> (DVector<f64>, Vec<f64>) {
        let (mut rest, mut made) = (row.clone(), vec![0.0; self.units.len()]);
        let units = self.units.iter().map(|(unit, _)| (0, unit.as_slice()));
        take_out(rest.as_mut_slice(), units, |index, along| {
            subtract(&mut made, along, &self.units[index].1);
        });
        (rest, made)
    }

    fn add(&mut self, row: &DVector<f64>) {
        let (rest, mut made) = self.rest(row);
        made.push(1.0);
        let size = rest.norm();
        made.iter_mut().for_each(|m| *m /= size);
        self.units.push((rest / size, made));
    }
}

/// Number of independent rows.
pub fn rank<'a>(rows: impl Iterator<Item = &'a DVector<f64>>) -> usize {
    let mut span = Span::default();
    for row in rows {
        if span.rest(row).0.norm() > NEW {
            span.add(row);
        }
    }
    span.units.len()
}

/// What a row of a span is.
#[derive(Clone, Copy)]
pub enum SpanRow {
    /// A row of a closing joint, by place and number.
    Closing(usize, usize),
    /// The row of a motor.
    Motor(usize),
}

/// What of the rows of a group stays, and what does not.
#[derive(Default)]
pub struct RowChoice {
    /// The joints that lose rows.
    pub repeats: Vec<Repeat>,
    /// The motors that have nothing to drive.
    pub held: Vec<HeldMotor>,
    /// The kept rows, in the order in which they were taken.
    kept: Vec<SpanRow>,
    /// The rows that are left out.
    lost: Vec<SpanRow>,
}

/// The states that count: assemblies that move before those that do not, then those that hold most.
pub fn that_count(states: &[LinearisedState]) -> Vec<&LinearisedState> {
    let sort = |state: &LinearisedState| (state.freedoms > 0, state.rank);
    let best = states.iter().map(sort).max();
    let states = states.iter();
    states.filter(|state| Some(sort(state)) == best).collect()
}

/// The joints of a group that lose rows, and its motors that have nothing to drive.
pub fn choose(group: &LoopGroup, states: &[&LinearisedState]) -> RowChoice {
    let mut spans = vec![Span::default(); states.len()];
    let (mut kept, mut all_lost): (Vec<SpanRow>, Vec<SpanRow>) = Default::default();
    let mut repeats = Vec::new();
    for (place, &joint) in group.closing.iter().enumerate() {
        let rows = states
            .first()
            .map_or(0, |s| s.closing.get(place).map_or(0, Vec::len));
        let mut set = RowSet::default();
        let worst = |row: usize, spans: &[Span]| {
            let news = states.iter().zip(spans).map(|(state, span)| {
                let row = state.closing.get(place).and_then(|rows| rows.get(row));
                row.map_or(0.0, |row| span.rest(row).0.norm())
            });
            news.fold(f64::INFINITY, f64::min)
        };
        loop {
            let left = (0..rows).filter(|&row| !set.contains(row));
            let news: Vec<(usize, f64)> = left.map(|row| (row, worst(row, &spans))).collect();
            let most = news.iter().fold(0.0, |most: f64, (_, new)| most.max(*new));
            let next = news
                .iter()
                .find(|(_, new)| *new >= AS_GOOD * most && *new > NEW);
            let Some(&(row, _)) = next else { break };
            set.0 |= 1 << row;
            kept.push(SpanRow::Closing(place, row));
            for (state, span) in states.iter().zip(&mut spans) {
                span.add(&state.closing[place][row]);
            }
        }
        let lost = (0..rows).filter(|&row| !set.contains(row));
        let lost: Vec<SpanRow> = lost.map(|row| SpanRow::Closing(place, row)).collect();
        if let (Some(state), Some(span)) = (states.first(), spans.first())
            && !lost.is_empty()
        {
            let stresses = lost.iter().filter_map(|&row| {
                let (_, made) = span.rest(state.line(row)?);
                Some(SelfStress::new(group, state, row, kept.iter().zip(&made)).joints)
            });
            let mut of: Vec<usize> = stresses.flatten().collect();
            of.sort_unstable();
            of.dedup();
            of.retain(|&partner| partner != joint);
            let kept = set;
            repeats.push(Repeat {
                joint,
                rows,
                kept,
                of,
            });
        }
        all_lost.extend(lost);
    }
    let mut held = Vec::new();
    for (index, motor) in states
        .first()
        .iter()
        .flat_map(|s| s.motors.iter().enumerate())
    {
        let row = |state: &LinearisedState| state.motors.get(index).map(|motor| motor.line.clone());
        let rows: Vec<DVector<f64>> = states.iter().filter_map(|state| row(state)).collect();
        let news = rows.iter().zip(&spans);
        let news: Vec<f64> = news.map(|(row, span)| span.rest(row).0.norm()).collect();
        // At some states a coordinate can stand still for an instant: it is held where it is at all of them.
        if news.iter().all(|new| *new <= NEW) {
            if let (Some(state), Some(span)) = (states.first(), spans.first()) {
                let (row, (_, made)) = (SpanRow::Motor(index), span.rest(&motor.line));
                let mut of = SelfStress::new(group, state, row, kept.iter().zip(&made)).joints;
                of.retain(|&joint| joint != motor.joint);
                held.push(HeldMotor {
                    joint: motor.joint,
                    coordinate: motor.coordinate,
                    of,
                });
                all_lost.push(row);
            }
        } else if news.iter().all(|new| *new > NEW) {
            kept.push(SpanRow::Motor(index));
            for (row, span) in rows.iter().zip(&mut spans) {
                span.add(row);
            }
        }
    }
    RowChoice {
        repeats,
        held,
        kept,
        lost: all_lost,
    }
}

/// The self-stresses of a group at a state, one a row that is left out: all others are sums of these. `None` where such a row repeats none there.
pub fn self_stresses(
    group: &LoopGroup,
    state: &LinearisedState,
    choice: &RowChoice,
) -> Option<Vec<SelfStress>> {
    let mut span = Span::default();
    for &row in &choice.kept {
        span.add(state.line(row)?);
    }
    let stress = |&row: &SpanRow| {
        let (rest, made) = span.rest(state.line(row)?);
        let parts = choice.kept.iter().zip(&made);
        (rest.norm() <= NEW).then(|| SelfStress::new(group, state, row, parts))
    };
    choice.lost.iter().map(stress).collect()
}
