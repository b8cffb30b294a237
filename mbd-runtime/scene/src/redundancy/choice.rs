//! Which rows stay, which joints the others repeat, and which motors drive a coordinate that is held already.

use nalgebra::DVector;

use crate::redundancy::assembly::{JointRow, LinearisedState, MotorRow};
use crate::redundancy::local::PartMotion;
use crate::redundancy::tree::LoopGroup;
use crate::scalar::orthogonal::{dot, subtract, take_out};
use crate::{HeldMotor, Part, Repeat, RowSet};

/// What is left of a row below this part of it is rounding: repeated rows leave 1e-12, others rarely less than 1e-3.
const NEW: f64 = 1e-8;
/// Rows whose new parts differ by less than this factor are equally good; the first is taken.
const AS_GOOD: f64 = 0.8;
/// Part of a self-stress from which on a joint takes part in it.
const INVOLVED: f64 = 1e-6;

/// Directions of the rows so far, each with the kept rows it is made of.
#[derive(Clone, Default)]
struct Span {
    units: Vec<(DVector<f64>, Vec<f64>)>,
}

impl Span {
    /// What is new in a row of size 1 or less, and what of the kept rows was taken out of it.
    fn rest(&self, row: &DVector<f64>) -> (DVector<f64>, Vec<f64>) {
        let (mut rest, mut made) = (row.clone(), vec![0.0; self.units.len()]);
        let units = self.units.iter().map(|(unit, _)| unit.as_slice());
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
enum SpanRow {
    /// A row of a closing joint, by place and number.
    Closing(usize, usize),
    /// The row of a motor.
    Motor(usize),
}

/// The joints of a group that lose rows, and its motors that have nothing to drive.
pub fn repeats(group: &LoopGroup, states: &[LinearisedState]) -> (Vec<Repeat>, Vec<HeldMotor>) {
    // Assemblies that move count before those that do not, then those that hold most.
    let best = states.iter().map(|s| (s.freedoms > 0, s.rank)).max();
    let states: Vec<&LinearisedState> = states
        .iter()
        .filter(|s| Some((s.freedoms > 0, s.rank)) == best)
        .collect();
    let mut spans = vec![Span::default(); states.len()];
    // The kept rows, in the order of the spans.
    let mut kept: Vec<SpanRow> = Vec::new();
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
        if let (Some(state), Some(span)) = (states.first(), spans.first())
            && set.len() < rows
        {
            repeats.push(Repeat {
                joint,
                rows,
                kept: set,
                of: partners(group, state, span, &kept, place, set),
            });
        }
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
            held.extend(held_motor(group, &states, &spans, &kept, motor));
        } else if news.iter().all(|new| *new > NEW) {
            kept.push(SpanRow::Motor(index));
            for (row, span) in rows.iter().zip(&mut spans) {
                span.add(row);
            }
        }
    }
    (repeats, held)
}

/// A motor whose row is made of others, and the joints that hold its coordinate.
fn held_motor(
    group: &LoopGroup,
    states: &[&LinearisedState],
    spans: &[Span],
    kept: &[SpanRow],
    motor: &MotorRow,
) -> Option<HeldMotor> {
    let (state, span) = (states.first()?, spans.first()?);
    let (_, made) = span.rest(&motor.line);
    let mut forces = Forces::new(group);
    forces.put(&motor.row, 1.0, None);
    let mut of = forces.balance(group, state, kept, &made);
    of.retain(|&joint| joint != motor.joint);
    Some(HeldMotor {
        joint: motor.joint,
        coordinate: motor.coordinate,
        of,
    })
}

/// The joints whose rows the lost rows of a closing joint repeat: those that carry the self-stress.
fn partners(
    group: &LoopGroup,
    state: &LinearisedState,
    span: &Span,
    kept: &[SpanRow],
    place: usize,
    set: RowSet,
) -> Vec<usize> {
    let mut partners = Vec::new();
    let Some(rows) = state.closing.get(place) else {
        return partners;
    };
    for lost in (0..rows.len()).filter(|&row| !set.contains(row)) {
        // Forces of the closing joints: one unit of the lost row, and what of the kept ones balances it.
        let (_, made) = span.rest(&rows[lost]);
        let mut forces = Forces::new(group);
        let rows = state.closing_rows.get(place);
        if let Some(row) = rows.and_then(|rows| rows.get(lost)) {
            forces.put(row, 1.0, Some(place));
        }
        partners.extend(forces.balance(group, state, kept, &made));
    }
    partners.sort_unstable();
    partners.dedup();
    partners.retain(|&joint| Some(&joint) != group.closing.get(place));
    partners
}

/// Forces on the parts of a group, and on the joints.
struct Forces {
    parts: Vec<(Part, PartMotion)>,
    closing: Vec<f64>,
}

impl Forces {
    fn new(group: &LoopGroup) -> Self {
        let links = group.links.iter().map(|link| link.to);
        let parts = group.roots.iter().copied().chain(links);
        Forces {
            parts: parts.map(|part| (part, [0.0; 6])).collect(),
            closing: vec![0.0; group.closing.len()],
        }
    }

    fn push(&mut self, part: Part, times: f64, columns: &PartMotion) {
        let own = self.parts.iter_mut().find(|(own, _)| *own == part);
        if let Some((_, force)) = own {
            force
                .iter_mut()
                .zip(columns)
                .for_each(|(f, c)| *f += times * c);
        }
    }

    /// Lets a row, divided by its size, push with a multiplier; of the closing joint at `place`, if of any.
    fn put(&mut self, row: &JointRow, times: f64, place: Option<usize>) {
        let each = times / row.size;
        for (part, columns) in &row.parts {
            self.push(*part, each, columns);
        }
        if let Some(force) = place.and_then(|place| self.closing.get_mut(place)) {
            *force = force.max(times.abs());
        }
    }

    /// Adds the rows of a span in these parts; the joints that carry what is in balance then, those of motors among them, in order.
    fn balance(
        mut self,
        group: &LoopGroup,
        state: &LinearisedState,
        kept: &[SpanRow],
        made: &[f64],
    ) -> Vec<usize> {
        let mut carried = Vec::new();
        for (&source, &part) in kept.iter().zip(made) {
            match source {
                SpanRow::Closing(place, row) => {
                    let rows = state.closing_rows.get(place);
                    if let Some(row) = rows.and_then(|rows| rows.get(row)) {
                        self.put(row, part, Some(place));
                    }
                }
                SpanRow::Motor(index) => {
                    if let Some(motor) = state.motors.get(index) {
                        self.put(&motor.row, part, None);
                        carried.push((motor.joint, part.abs()));
                    }
                }
            }
        }
        carried.extend(self.carry(group, state));
        let sizes = carried.iter().map(|(_, force)| *force);
        let most = sizes.fold(0.0, f64::max);
        carried.retain(|(_, force)| *force > INVOLVED * most);
        let mut joints: Vec<usize> = carried.into_iter().map(|(joint, _)| joint).collect();
        joints.sort_unstable();
        joints.dedup();
        joints
    }

    /// Lets the joints of the tree carry the forces, from the outermost inwards. Every joint and the size of the force in it.
    fn carry(mut self, group: &LoopGroup, state: &LinearisedState) -> Vec<(usize, f64)> {
        let mut carried: Vec<(usize, f64)> = Vec::new();
        for (link, (rows, hold)) in group.links.iter().zip(&state.links).rev() {
            let on = self.parts.iter().find(|(part, _)| *part == link.to);
            let force = on.map_or([0.0; 6], |(_, force)| *force);
            carried.push((link.joint, dot(&force, &force).sqrt()));
            let multipliers = hold.multipliers(&force);
            let Some(from) = link.from else { continue };
            for (row, times) in rows.iter().zip(multipliers) {
                self.push(from, -times, &row.on(link.from));
            }
        }
        let closing = group.closing.iter().copied().zip(self.closing);
        carried.extend(closing);
        carried
    }
}
