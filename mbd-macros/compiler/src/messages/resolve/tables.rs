//! Messages about tables.

use mbd_scene::{Dimension, Unit};

use crate::lexeme::Region;
use crate::messages::LexemeMessage;
use crate::units::described;

pub fn short_table(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a table has at least 2 rows `argument: value`")
}

/// A table of two arguments with fewer than two numbers of the first or the second.
pub fn narrow_table(at: Region, table: &str, argument: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "table `{table}` has one number of its {argument} argument: a table of two arguments has at least 2 of each, `{{ (0 m, 0 s): 1 N, (0 m, 5 s): 2 N, (3 m, 0 s): 4 N, (3 m, 5 s): 6 N }}`"
        ),
    )
}

pub fn table_arguments(at: Region, wanted: usize, found: usize) -> LexemeMessage {
    let told = match (wanted, found) {
        (_, 0) => "a row of a table begins with its argument, `argument: value`".to_owned(),
        (_, 3..) => format!("a table has one argument or two, this row has {found}"),
        (1, _) => {
            "the rows above have one argument, this one has two: write `argument: value`".to_owned()
        }
        _ => "the rows above have two arguments, this one has one: write `(first, second): value`"
            .to_owned(),
    };
    LexemeMessage::new(at, told)
}

/// A pair of arguments without a value; `count` are missing in all.
pub fn table_gap(
    at: Region,
    table: &str,
    [x, z]: [(f64, &Unit); 2],
    count: usize,
) -> LexemeMessage {
    let more = match count {
        1 => String::new(),
        _ => format!(" ({count} are missing)"),
    };
    LexemeMessage::new(
        at,
        format!(
            "table `{table}` has no value at `({}, {})`: it has one for every pair of its numbers{more}",
            x.1.told(x.0),
            z.1.told(z.0)
        ),
    )
}

pub fn table_repeats(at: Region, first: Region) -> LexemeMessage {
    LexemeMessage::new(at, "this row has the arguments of one above")
        .also(first, "the first of them")
}

pub fn table_order(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "the arguments of a table must increase from row to row")
}

pub fn table_dimension(at: Region, wanted: Dimension, found: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a column of a table holds one kind of quantity: above it is {}, this is {}",
            described(wanted),
            described(found)
        ),
    )
}

pub fn table_as_stiffness(at: Region, table: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{table}` is a table; a line takes one of its force over its stretch: `force: {table}` in place of `stiffness`"
        ),
    )
}

pub fn force_table_dimensions(
    at: Region,
    line: &str,
    table: &str,
    [x, y]: [Dimension; 2],
) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the force of line `{line}` is a table of forces over stretch, `table {table} = {{ 0 m: 0 N, 0.5 m: 200 N }}`; `{table}` holds {} over {}",
            described(y),
            described(x)
        ),
    )
}

pub fn force_table_rows(at: Region, line: &str, table: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the table `{table}` gives the force of line `{line}`: it begins with `0 m: 0 N`, and its forces rise from row to row"
        ),
    )
}

/// The force of a line is a table of two arguments, or a smooth one.
pub fn force_table_kind(at: Region, line: &str, table: &str, smooth: bool) -> LexemeMessage {
    let why = match smooth {
        true => {
            "is smooth, and the force of a line is straight between its rows: leave out `smooth`"
        }
        false => {
            "has two arguments, and the force of a line has one, its stretch: what depends on more is a `load`"
        }
    };
    LexemeMessage::new(
        at,
        format!("the force of line `{line}`: the table `{table}` {why}"),
    )
}

pub fn table_of_time(at: Region, table: &str, smooth: bool, of_frame: bool) -> LexemeMessage {
    let jumps = match smooth {
        true => "the second rate of the smooth table `",
        false => "the table `",
    };
    let has = match smooth {
        true => "jumps",
        false => "has corners",
    };
    let corners = match of_frame {
        true => {
            "; a frame at which lines end alone may have corners, `max(0 m, 0.5 m/s * (time - 1 s))`"
        }
        false => "",
    };
    LexemeMessage::new(
        at,
        format!(
            "a prescribed motion has a velocity and an acceleration, and {jumps}{table}` {has}: write it with functions such as sin, exp or powers of `time`{corners}"
        ),
    )
}

pub fn table_without_argument(at: Region, word: &str, arguments: usize) -> LexemeMessage {
    let remedy = match arguments {
        1 => format!("its argument, `{word}(…)`"),
        _ => format!("its arguments, `{word}(…, …)`"),
    };
    LexemeMessage::new(at, format!("`{word}` is a table: give it {remedy}"))
}

pub fn argument_dimension(
    at: Region,
    table: &str,
    wanted: Dimension,
    found: Dimension,
    is_angle: bool,
) -> LexemeMessage {
    let found = match is_angle {
        true => "an angle".to_owned(),
        false => described(found),
    };
    LexemeMessage::new(
        at,
        format!(
            "table `{table}` is over {}, this is {found}",
            described(wanted)
        ),
    )
}
