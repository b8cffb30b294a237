//! Tables: their rows, and what they are applied to.

use mbd_scene::{Dimension, Formula, SecondArgument, Unit};

use super::numbers::written_unit;
use super::turns::Turns;
use super::value::angle_of;
use super::{Instance, MayDependOn, Resolver, Scope, Typed};
use crate::lexeme::{Bracket, Region};
use crate::messages::resolve as say;
use crate::syntax::expression::{self, Expression};
use crate::syntax::{Cursor, ValueSyntax};
use crate::units;

/// Numbers this close to each other, relative to the larger, are the same argument: `7 cm` and `0.07 m`.
const SAME: f64 = 1e-12;

/// A row as written.
struct TableRow {
    /// One argument or two [SI].
    arguments: Vec<f64>,
    value: f64,
    at: Region,
}

/// The units of the columns, known once a row has one.
#[derive(Default)]
struct ColumnUnits {
    arguments: [Option<Unit>; 2],
    value: Option<Unit>,
}

impl Resolver<'_> {
    /// `{ 0 km: 0.0145 kg/m^3, 10 km: 0.006 kg/m^3 }`, or `{ (0 m, 0 s): 1 N, … }` with two arguments.
    pub fn fill_table(&mut self, instance: &Instance<'_>) -> Option<()> {
        let value = instance.item.clause("=")?;
        let mut cursor = Cursor::new(value);
        let Some(group) = cursor.group(Bracket::Brace) else {
            return self.fail(cursor.expected("`{ argument: value, … }`"));
        };
        if let Err(report) = cursor.finish("`;`") {
            return self.fail(report);
        }
        let mut columns = ColumnUnits::default();
        let written = Cursor::new(group).comma_separated();
        let count = written.len();
        let mut rows: Vec<TableRow> = Vec::with_capacity(count);
        for row in written {
            let wanted = rows.first().map(|row| row.arguments.len());
            rows.extend(self.table_row(row, wanted, instance, &mut columns));
        }
        if rows.len() < count {
            return None;
        }
        let two = rows.first().is_some_and(|row| row.arguments.len() == 2);
        if rows.len() < 2 && !two {
            return self.fail(say::short_table(group.at));
        }
        let pure = || units::si("", units::NONE);
        let [x_unit, z_unit] = columns.arguments.map(|unit| unit.unwrap_or_else(pure));
        let (x, y, second) = match two {
            false => {
                let (x, y) = self.increasing(&rows)?;
                (x, y, None)
            }
            true => {
                let table = self.scene.tables.get(instance.slot)?.name.clone();
                let grid = self.grid(&rows, group.at, &table, [&x_unit, &z_unit])?;
                let [x, z, y] = grid;
                let second = SecondArgument { z, unit: z_unit };
                (x, y, Some(second))
            }
        };
        let entry = self.scene.tables.get_mut(instance.slot)?;
        entry.x = x;
        entry.y = y;
        entry.x_unit = x_unit;
        entry.y_unit = columns.value.unwrap_or_else(pure);
        entry.second = second;
        entry.smooth = instance.item.marked.is_some();
        Some(())
    }

    /// The columns of a table of one argument, which stands in order.
    fn increasing(&mut self, rows: &[TableRow]) -> Option<(Vec<f64>, Vec<f64>)> {
        let first = |row: &TableRow| row.arguments.first().copied();
        for pair in rows.windows(2) {
            if let [before, after] = pair
                && first(after) <= first(before)
            {
                return self.fail(say::table_order(after.at));
            }
        }
        let x = rows.iter().filter_map(first).collect();
        Some((x, rows.iter().map(|row| row.value).collect()))
    }

    /// Both arguments and the values of a table of two, whose rows stand in any order: the values at the first x, then those at the next.
    fn grid(
        &mut self,
        rows: &[TableRow],
        at: Region,
        table: &str,
        units: [&Unit; 2],
    ) -> Option<[Vec<f64>; 3]> {
        let [x, z] = [0, 1].map(|column| {
            let found = rows
                .iter()
                .filter_map(|row| row.arguments.get(column).copied());
            let mut numbers: Vec<f64> = found.collect();
            numbers.sort_by(f64::total_cmp);
            numbers.dedup_by(|a, b| same(*a, *b));
            numbers
        });
        for (numbers, argument) in [(&x, "first"), (&z, "second")] {
            if numbers.len() < 2 {
                return self.fail(say::narrow_table(at, table, argument));
            }
        }
        let mut cells: Vec<Option<&TableRow>> = vec![None; x.len() * z.len()];
        for row in rows {
            let &[a, b] = row.arguments.as_slice() else {
                continue;
            };
            let cell = cells.get_mut(place(&x, a) * z.len() + place(&z, b))?;
            if let Some(first) = cell.replace(row) {
                return self.fail(say::table_repeats(row.at, first.at));
            }
        }
        let values: Vec<f64> = cells.iter().flatten().map(|row| row.value).collect();
        let gap = cells.iter().position(Option::is_none);
        if let Some(gap) = gap {
            let (i, j) = (gap / z.len(), gap % z.len());
            let place = [(*x.get(i)?, units[0]), (*z.get(j)?, units[1])];
            let count = cells.len() - values.len();
            return self.fail(say::table_gap(at, table, place, count));
        }
        Some([x, z, values])
    }

    /// One row: its arguments in brackets if there are two.
    fn table_row(
        &mut self,
        row: ValueSyntax<'_>,
        wanted: Option<usize>,
        instance: &Instance<'_>,
        columns: &mut ColumnUnits,
    ) -> Option<TableRow> {
        let mut cursor = Cursor::new(row);
        let mut ahead = cursor;
        let group = ahead.group(Bracket::Round);
        let several = group.map(|group| Cursor::new(group).comma_separated());
        // `(1 + 2) m: …` is one argument.
        let several = several.filter(|parts| parts.len() != 1);
        let (parsed, at) = match several {
            Some(parts) => {
                cursor = ahead;
                let parsed: Result<Vec<Expression>, _> =
                    parts.into_iter().map(expression::whole).collect();
                (parsed, cursor.before())
            }
            None => {
                let parsed = expression::prefix(&mut cursor).map(|parsed| vec![parsed]);
                let at = row.at;
                (parsed, at)
            }
        };
        let parsed = match parsed {
            Ok(parsed) => parsed,
            Err(report) => return self.fail(report),
        };
        let (found, wanted) = (parsed.len(), wanted.unwrap_or(parsed.len().clamp(1, 2)));
        if found != wanted {
            let at = group.map_or(at, |group| group.at);
            return self.fail(say::table_arguments(at, wanted, found));
        }
        let at = parsed.first().map_or(at, Expression::at);
        if cursor.sign(':').is_none() {
            return self.fail(cursor.expected("`:` and the value at this argument"));
        }
        let value = match expression::prefix(&mut cursor) {
            Ok(value) => value,
            Err(report) => return self.fail(report),
        };
        if let Err(report) = cursor.finish("`,`") {
            return self.fail(report);
        }
        let mut arguments = Vec::with_capacity(found);
        for (parsed, unit) in parsed.iter().zip(&mut columns.arguments) {
            arguments.push(self.table_number(parsed, instance, unit)?);
        }
        let value = self.table_number(&value, instance, &mut columns.value)?;
        Some(TableRow {
            arguments,
            value,
            at,
        })
    }

    /// A number of the column with this unit.
    fn table_number(
        &mut self,
        parsed: &Expression,
        instance: &Instance<'_>,
        unit: &mut Option<Unit>,
    ) -> Option<f64> {
        let typed = self.typed(parsed, instance.scope(MayDependOn::Constant))?;
        let (at, dimension) = (typed.at, typed.dimension);
        let this = written_unit(parsed).unwrap_or_else(|| typed.unit());
        let value = self.constant_value(typed)?;
        match (unit.as_ref(), dimension) {
            (Some(known), Some(found)) if known.dimension != found => {
                let wanted = known.dimension;
                return self.fail(say::table_dimension(at, wanted, found));
            }
            (None, Some(_)) => *unit = Some(this),
            _ => {}
        }
        Some(value)
    }

    /// A table of its arguments.
    pub fn lookup(
        &mut self,
        table: usize,
        arguments: Vec<Option<Typed>>,
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        if scope.stage == MayDependOn::Constant {
            return self.fail(say::not_constant(at, "a table"));
        }
        let declared = self.scene.tables.get(table)?.clone();
        let (wanted, found) = (declared.arguments(), arguments.len());
        if found != wanted {
            let report = say::argument_count(at, &declared.name, wanted, found);
            return self.fail(report);
        }
        let arguments: Vec<Typed> = arguments.into_iter().collect::<Option<_>>()?;
        let any = |unit: &Unit, si: bool| si && unit.text.is_empty();
        let largest = |list: &[f64]| list.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let knots = std::iter::once(&declared.x).chain(declared.second.iter().map(|it| &it.z));
        for ((argument, unit), knots) in arguments.iter().zip(declared.argument_units()).zip(knots)
        {
            if argument.vector {
                return self.fail_as_vector(argument, "the argument of a table");
            }
            let wanted: Dimension = unit.dimension;
            if let Some(found) = argument.dimension
                && found != wanted
                && !any(unit, self.si)
            {
                let name = &declared.name;
                return self.fail(say::argument_dimension(
                    argument.at,
                    name,
                    wanted,
                    found,
                    argument.angle == 1 && found == units::NONE,
                ));
            }
            let what = format!("the argument of `{}`", declared.name);
            self.turns_as_in(argument, unit, &what)?;
            let last = largest(knots);
            let bare = unit.text.is_empty() && !self.si;
            if bare && argument.is_in_radians() && last > std::f64::consts::TAU {
                return self.fail(say::knots_without_unit(argument.at, &declared.name, last));
            }
        }
        let any_value = any(&declared.y_unit, self.si);
        let formulas = arguments.into_iter().map(|argument| argument.formula);
        Some(Typed {
            formula: Formula::Lookup(table, formulas.collect()),
            vector: false,
            dimension: (!any_value).then_some(declared.y_unit.dimension),
            angle: angle_of(&declared.y_unit),
            turns: Turns::of_unit(&format!("{}(…)", declared.name), &declared.y_unit),
            bare: None,
            without_unit: declared
                .y_unit
                .text
                .is_empty()
                .then(|| largest(&declared.y)),
            at,
        })
    }
}

/// Whether two numbers are the same argument.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// Which of these increasing numbers is the same argument as this one.
fn place(numbers: &[f64], number: f64) -> usize {
    numbers.partition_point(|&other| other < number && !same(other, number))
}
