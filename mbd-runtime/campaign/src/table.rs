//! Comma-separated values: a header, then rows. Texts with a comma, a quotation mark or a line break stand in quotation marks (RFC 4180).

use std::fs;
use std::path::Path;

/// A double has not more digits behind 99 %.
const MOST_PLACES: usize = 14;

/// The cells of a line.
pub fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let (mut quoted, mut signs) = (false, line.chars().peekable());
    while let Some(sign) = signs.next() {
        let last = cells.last_mut().expect("there is one from the start");
        match sign {
            '"' if quoted && signs.peek() == Some(&'"') => {
                signs.next();
                last.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            sign => last.push(sign),
        }
    }
    cells
}

/// A text as a cell; line breaks become spaces.
pub fn cell(text: &str) -> String {
    let text = text.replace(['\n', '\r'], " ");
    match text.contains([',', '"']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text,
    }
}

/// A number as a cell, from which the same number is read; empty where there is none.
pub fn number(value: f64) -> String {
    match value.is_nan() {
        true => String::new(),
        false => format!("{value:?}"),
    }
}

/// A part in percent, with at most so many digits behind the point and no zeros at the end; with more where it would be told as nothing or as all.
pub fn percent(part: f64, places: usize) -> String {
    let told = |places: usize| {
        let text = format!("{:.places$}", 100.0 * part);
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        }
    };
    let is_inside = 0.0 < part && part < 1.0;
    let mut all = (places..=MOST_PLACES).map(told);
    let found = all.find(|text| !(is_inside && ["0", "100"].contains(&text.as_str())));
    found.unwrap_or_else(|| told(places))
}

/// `1 case`, `2 cases`: so many of what is called so.
pub fn counted(count: u64, one: &str) -> String {
    match count {
        1 => format!("1 {one}"),
        _ => format!("{count} {one}s"),
    }
}

/// `name [unit]`, or the name alone.
pub fn heading(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

/// Name and unit of a heading.
pub fn name_and_unit(heading: &str) -> (&str, &str) {
    let parts = heading
        .strip_suffix(']')
        .and_then(|text| text.rsplit_once(" ["));
    parts.unwrap_or((heading, ""))
}

/// A column of numbers of a file, and its unit.
///
/// # Errors
/// What is wrong, with file and line.
pub fn column(path: &Path, name: &str) -> Result<(Vec<f64>, String), String> {
    let file = path.display();
    let text = fs::read_to_string(path).map_err(|error| format!("cannot read {file}: {error}"))?;
    // Spreadsheets begin a file in UTF-8 with this sign.
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let header = lines.next().map_or_else(Vec::new, |(_, line)| cells(line));
    let headings: Vec<(&str, &str)> = header.iter().map(|it| name_and_unit(it.trim())).collect();
    // As the file spells it, or without the unit.
    let spelt = header.iter().position(|own| own.trim() == name);
    let mut named = (0..headings.len()).filter(|at| headings[*at].0 == name);
    let found = spelt.or_else(|| named.next());
    if spelt.is_none() && named.next().is_some() {
        return Err(format!(
            "{file} has several columns `{name}`: write the one that is meant with its unit, as its header does"
        ));
    }
    let Some(at) = found else {
        let names: Vec<&str> = headings.iter().map(|(name, _)| *name).collect();
        let near = mbd_runtime::scene::similar::did_you_mean(name, names.iter().copied());
        let stop = if near.is_empty() { "." } else { "" };
        // As spreadsheets write where a comma is a decimal point.
        let parted = match names.as_slice() {
            [all] if all.contains([';', '\t']) => {
                "; cells are parted by commas, and numbers have decimal points"
            }
            _ => "",
        };
        return Err(format!(
            "{file} has no column `{name}`{near}{stop} It has: {}{parted}",
            names.join(", ")
        ));
    };
    let values: Result<Vec<f64>, String> = lines
        .map(|(line, text)| {
            let cells = cells(text);
            let value = cells.get(at).map_or("", |cell| cell.trim());
            match value.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(number),
                _ => Err(format!(
                    "{file}, line {}: `{value}` in column `{name}` is not a finite number",
                    line + 1
                )),
            }
        })
        .collect();
    match values? {
        values if values.is_empty() => Err(format!("{file} has no rows")),
        values => Ok((values, headings[at].1.to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_come_back_as_they_were() {
        for text in ["plain", "a, b", "say \"no\"", "", ",\","] {
            assert_eq!(cells(&format!("1,{},2", cell(text))), ["1", text, "2"]);
        }
        assert_eq!(name_and_unit("riser.tension [N]"), ("riser.tension", "N"));
        assert_eq!(name_and_unit("leg[0].tension [N]"), ("leg[0].tension", "N"));
        assert_eq!(name_and_unit("tilt"), ("tilt", ""));
    }

    #[test]
    fn numbers_come_back_to_the_bit() {
        for value in [
            0.1,
            -1.0 / 3.0,
            1e-310,
            f64::MAX,
            -0.0,
            123_456_789.123_456_7,
        ] {
            assert_eq!(
                number(value).parse::<f64>().map(f64::to_bits),
                Ok(value.to_bits())
            );
        }
        assert_eq!(number(f64::NAN), "");
    }
}
