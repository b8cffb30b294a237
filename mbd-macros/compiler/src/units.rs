//! Units and dimensions: what a suffix such as `kN/m` means in SI.
//!
//! Exponents of mass, length, time and current are doubled so that √ stays whole. An angle has no dimension; `deg` is π/180.

use mbd_scene::similar::slips;
use mbd_scene::{Dimension, Unit};

/// A dimension from (not doubled) exponents of mass, length and time.
pub const fn dimension(mass: i8, length: i8, time: i8) -> Dimension {
    Dimension {
        mass: 2 * mass,
        length: 2 * length,
        time: 2 * time,
        current: 0,
    }
}

/// A dimension with an (not doubled) exponent of current.
const fn electric(of: Dimension, current: i8) -> Dimension {
    Dimension {
        current: 2 * current,
        ..of
    }
}

/// No dimension.
pub const NONE: Dimension = dimension(0, 0, 0);
/// kg
pub const MASS: Dimension = dimension(1, 0, 0);
/// m
pub const LENGTH: Dimension = dimension(0, 1, 0);
/// s
pub const TIME: Dimension = dimension(0, 0, 1);
/// m/s
pub const SPEED: Dimension = dimension(0, 1, -1);
/// m/s²
pub const ACCELERATION: Dimension = dimension(0, 1, -2);
/// N
pub const FORCE: Dimension = dimension(1, 1, -2);
/// N m
pub const TORQUE: Dimension = dimension(1, 2, -2);
/// kg m²
pub const INERTIA: Dimension = dimension(1, 2, 0);
/// N/m
pub const STIFFNESS: Dimension = dimension(1, 0, -2);
/// N s/m
pub const DAMPING: Dimension = dimension(1, 0, -1);
/// 1/s
pub const RATE: Dimension = dimension(0, 0, -1);
/// m³/s²
pub const GRAVITATIONAL: Dimension = dimension(0, 3, -2);
const PRESSURE: Dimension = dimension(1, -1, -2);
const POWER: Dimension = dimension(1, 2, -3);
/// kg/m³
pub const DENSITY: Dimension = dimension(1, -3, 0);
const AREA: Dimension = dimension(0, 2, 0);
const VOLUME: Dimension = dimension(0, 3, 0);
/// 1/s²
pub const ANGULAR_ACCELERATION: Dimension = dimension(0, 0, -2);
const CURRENT: Dimension = electric(NONE, 1);
const CHARGE: Dimension = electric(TIME, 1);
const VOLTAGE: Dimension = electric(POWER, -1);
const RESISTANCE: Dimension = electric(POWER, -2);
const INDUCTANCE: Dimension = electric(TORQUE, -2);
const CAPACITANCE: Dimension = electric(dimension(-1, -2, 4), 2);

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const POUND: f64 = 0.453_592_37;

/// The units, with their SI values.
const UNITS: &[(&str, f64, Dimension)] = &[
    ("kg", 1.0, MASS),
    ("g", 1e-3, MASS),
    ("mg", 1e-6, MASS),
    // Not `t`: behind a number it is the time of those who write `2 rad/s * t`.
    ("tonne", 1e3, MASS),
    ("m", 1.0, LENGTH),
    ("mm", 1e-3, LENGTH),
    ("cm", 1e-2, LENGTH),
    ("um", 1e-6, LENGTH),
    ("km", 1e3, LENGTH),
    ("ft", 0.3048, LENGTH),
    ("inch", 0.0254, LENGTH),
    ("s", 1.0, TIME),
    ("ms", 1e-3, TIME),
    ("us", 1e-6, TIME),
    ("min", 60.0, TIME),
    ("h", 3600.0, TIME),
    ("kph", 1000.0 / 3600.0, SPEED),
    ("mph", 0.447_04, SPEED),
    ("knot", 1852.0 / 3600.0, SPEED),
    ("Hz", 1.0, RATE),
    ("kHz", 1e3, RATE),
    ("rpm", std::f64::consts::TAU / 60.0, RATE),
    ("rad", 1.0, NONE),
    ("mrad", 1e-3, NONE),
    ("deg", DEGREE, NONE),
    ("rev", std::f64::consts::TAU, NONE),
    ("N", 1.0, FORCE),
    ("mN", 1e-3, FORCE),
    ("kN", 1e3, FORCE),
    ("MN", 1e6, FORCE),
    ("lbf", POUND * 9.806_65, FORCE),
    ("J", 1.0, TORQUE),
    ("mJ", 1e-3, TORQUE),
    ("kJ", 1e3, TORQUE),
    ("MJ", 1e6, TORQUE),
    ("W", 1.0, POWER),
    ("mW", 1e-3, POWER),
    ("kW", 1e3, POWER),
    ("MW", 1e6, POWER),
    ("Pa", 1.0, PRESSURE),
    ("kPa", 1e3, PRESSURE),
    ("MPa", 1e6, PRESSURE),
    ("GPa", 1e9, PRESSURE),
    ("bar", 1e5, PRESSURE),
    ("l", 1e-3, VOLUME),
    ("A", 1.0, CURRENT),
    ("mA", 1e-3, CURRENT),
    ("V", 1.0, VOLTAGE),
    ("mV", 1e-3, VOLTAGE),
    ("kV", 1e3, VOLTAGE),
    ("ohm", 1.0, RESISTANCE),
    ("kohm", 1e3, RESISTANCE),
    ("H", 1.0, INDUCTANCE),
    ("mH", 1e-3, INDUCTANCE),
    ("uH", 1e-6, INDUCTANCE),
    ("F", 1.0, CAPACITANCE),
    ("uF", 1e-6, CAPACITANCE),
    ("nF", 1e-9, CAPACITANCE),
];

/// Units that are angles, and those that count them in a time.
pub const ANGLES: &[&str] = &["rad", "mrad", "deg", "rev", "rpm"];

/// Other spellings that are read, and the words they stand for.
const SPELLINGS: &[(&str, &str)] = &[
    ("meter", "m"),
    ("meters", "m"),
    ("metre", "m"),
    ("metres", "m"),
    ("tonnes", "tonne"),
    ("sec", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("newton", "N"),
    ("newtons", "N"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("turn", "rev"),
    ("turns", "rev"),
    ("revs", "rev"),
    ("revolution", "rev"),
    ("revolutions", "rev"),
    ("kilogram", "kg"),
    ("kilograms", "kg"),
    ("gram", "g"),
    ("grams", "g"),
    ("feet", "ft"),
    ("foot", "ft"),
    ("inches", "inch"),
    ("knots", "knot"),
    ("hertz", "Hz"),
    ("kgs", "kg"),
    ("kilometer", "km"),
    ("kilometers", "km"),
    ("kilometre", "km"),
    ("kilometres", "km"),
    ("centimeter", "cm"),
    ("centimeters", "cm"),
    ("centimetre", "cm"),
    ("centimetres", "cm"),
    ("millimeter", "mm"),
    ("millimeters", "mm"),
    ("millimetre", "mm"),
    ("millimetres", "mm"),
    ("micron", "um"),
    ("microns", "um"),
    ("millisecond", "ms"),
    ("milliseconds", "ms"),
    ("minute", "min"),
    ("minutes", "min"),
    ("hour", "h"),
    ("hours", "h"),
    ("hr", "h"),
    ("joule", "J"),
    ("joules", "J"),
    ("watt", "W"),
    ("watts", "W"),
    ("pascal", "Pa"),
    ("liter", "l"),
    ("liters", "l"),
    ("litre", "l"),
    ("litres", "l"),
    ("ampere", "A"),
    ("amperes", "A"),
    ("amp", "A"),
    ("amps", "A"),
    ("volt", "V"),
    ("volts", "V"),
    ("ohms", "ohm"),
    ("henry", "H"),
    ("farad", "F"),
];

/// Names people write for them that are not read, because they are other units to others, or none.
const FOREIGN: &[(&str, &str)] = &[
    ("ton", "tonne"),
    ("tons", "tonne"),
    ("t", "tonne"),
    ("ms2", "m/s^2"),
    ("mps", "m/s"),
    ("kmh", "kph"),
    ("kts", "knot"),
    ("gm", "g"),
    ("gms", "g"),
    ("hrs", "h"),
    ("msec", "ms"),
    ("usec", "us"),
    ("lpm", "l/min"),
    ("sqm", "m^2"),
    ("cc", "cm^3"),
    // The sign of micro, and the Greek letter.
    ("\u{b5}m", "um"),
    ("\u{3bc}m", "um"),
    ("\u{b5}s", "us"),
    ("\u{3bc}s", "us"),
    ("\u{3c9}", "ohm"),
];

/// Units that are not here, and what one of them is.
const INSTEAD: &[(&str, &str)] = &[
    ("mpa", "`MPa` for a megapascal, `1e-3 Pa` for a millipascal"),
    ("kn", "`knot` for a knot, `kN` for a kilonewton"),
    ("kt", "`knot` for a knot, `1e6 kg` for a kilotonne"),
    ("mms", "`mm` for millimetres, `mm/s` for a speed"),
    ("cms", "`cm` for centimetres, `cm/s` for a speed"),
    ("kms", "`km` for kilometres, `km/s` for a speed"),
    ("mil", MIL_TEXT),
    ("mils", MIL_TEXT),
    ("thou", MIL_TEXT),
    ("grad", GON_TEXT),
    ("grads", GON_TEXT),
    ("gon", GON_TEXT),
    ("lbft", FOOT_POUND_TEXT),
    ("ftlb", FOOT_POUND_TEXT),
    ("ftlbs", FOOT_POUND_TEXT),
    ("lbfft", FOOT_POUND_TEXT),
    ("ftlbf", FOOT_POUND_TEXT),
    ("lbin", "`lbf*inch` for an inch-pound"),
    ("inlb", "`lbf*inch` for an inch-pound"),
    ("gpm", "`231 inch^3/min` for a US gallon a minute"),
    ("gal", "`231 inch^3` for a US one"),
    ("gallon", "`231 inch^3` for a US one"),
    ("gallons", "`231 inch^3` for a US one"),
    ("mohm", "`1e-3 ohm` for a milliohm, `1e6 ohm` for a megohm"),
    ("lb", POUND_TEXT),
    ("lbs", POUND_TEXT),
    ("pound", POUND_TEXT),
    ("pounds", POUND_TEXT),
    ("oz", "`0.028349523125 kg` for one"),
    ("lbm", POUND_TEXT),
    ("slug", "`1 lbf*s^2/ft` for one"),
    ("kgf", "`9.80665 N` for one"),
    ("mile", "`1609.344 m` for one"),
    ("miles", "`1609.344 m` for one"),
    ("dm", "`0.1 m` for one"),
    ("rps", "`1 rev/s` for one"),
    ("psi", "`1 lbf/(25.4 mm)^2` for one"),
    ("atm", "`101325 Pa` for one"),
    ("hpa", "`100 Pa` for one"),
    ("mbar", "`100 Pa` for one"),
    ("hp", "`745.7 W` for one, `735.5 W` for a metric one"),
    ("wh", "`3600 J` for one"),
    ("kwh", "`3.6 MJ` for one"),
    ("ml", "`1 cm^3` for one"),
    ("cl", "`10 cm^3` for one"),
    ("dl", "`100 cm^3` for one"),
    ("mmhg", "`133.322 Pa` for one"),
    ("torr", "`133.322 Pa` for one"),
    ("inhg", "`3386.39 Pa` for one"),
    ("day", "`24 h` for one"),
    ("days", "`24 h` for one"),
];

const FOOT_POUND_TEXT: &str = "`lbf*ft` for a foot-pound";
const MIL_TEXT: &str = "`25.4 um` for a thousandth of an inch";
const GON_TEXT: &str = "`0.9 deg` for a gon";
const POUND_TEXT: &str = "`0.45359237 kg` for one of mass, `lbf` for a force";

/// The word of a unit that is spelled otherwise, if that is read.
pub fn spelled(word: &str) -> Option<&'static str> {
    let found = SPELLINGS.iter().find(|(theirs, _)| *theirs == word);
    found.map(|(_, ours)| *ours)
}

/// What to write instead of a unit that is not here. `kn` may be a knot, and `KN` is none.
pub fn instead(word: &str) -> Option<&'static str> {
    let lower = match same_but_for_case(word) {
        Some(_) => word.to_owned(),
        None => word.to_lowercase(),
    };
    let found = INSTEAD.iter().find(|(theirs, _)| *theirs == lower);
    found.map(|(_, text)| *text)
}

/// Whether there is an answer to a word for a unit that is none.
pub fn is_answered(word: &str) -> bool {
    let known = [foreign(word), instead(word), same_but_for_case(word)];
    known.iter().any(Option::is_some) || run_together(word).is_some()
}

/// Named dimensions: the word of an input, and its SI unit.
const QUANTITIES: &[(&str, &str, Dimension)] = &[
    ("mass", "kg", MASS),
    ("length", "m", LENGTH),
    ("time", "s", TIME),
    ("number", "", NONE),
    ("angle", "rad", NONE),
    ("speed", "m/s", SPEED),
    ("velocity", "m/s", SPEED),
    ("acceleration", "m/s^2", ACCELERATION),
    ("force", "N", FORCE),
    ("torque", "N*m", TORQUE),
    ("inertia", "kg*m^2", INERTIA),
    ("stiffness", "N/m", STIFFNESS),
    ("damping", "N*s/m", DAMPING),
    ("angular_velocity", "rad/s", RATE),
    ("angular_acceleration", "rad/s^2", ANGULAR_ACCELERATION),
    ("gravitational_parameter", "m^3/s^2", GRAVITATIONAL),
    ("pressure", "Pa", PRESSURE),
    ("power", "W", POWER),
    ("density", "kg/m^3", DENSITY),
    ("area", "m^2", AREA),
    ("volume", "m^3", VOLUME),
    ("current", "A", CURRENT),
    ("charge", "A*s", CHARGE),
    ("voltage", "V", VOLTAGE),
    ("resistance", "ohm", RESISTANCE),
    ("inductance", "H", INDUCTANCE),
    ("capacitance", "F", CAPACITANCE),
];

/// The words of all units.
pub fn known() -> Vec<&'static str> {
    UNITS.iter().map(|(word, ..)| *word).collect()
}

/// Our word for a unit that people call otherwise.
pub fn foreign(word: &str) -> Option<&'static str> {
    let lower = word.to_lowercase();
    let mut all = SPELLINGS.iter().chain(FOREIGN);
    all.find(|(theirs, _)| *theirs == lower)
        .map(|(_, ours)| *ours)
}

/// The unit that differs from a word in capitals only, if there is one: another letter is another unit, and mega is not milli.
pub fn same_but_for_case(word: &str) -> Option<&'static str> {
    let is_unit = |word: &str| UNITS.iter().any(|(known, ..)| *known == word);
    let prefixed = |known: &str| {
        known.strip_prefix(['m', 'M']).is_some_and(is_unit)
            && known.chars().next() != word.chars().next()
    };
    let mut near = UNITS
        .iter()
        .filter(|(known, ..)| known.eq_ignore_ascii_case(word) && !prefixed(known));
    match (near.next(), near.next()) {
        (Some((only, ..)), None) => Some(only),
        _ => None,
    }
}

/// The units that a word may be a slip of: of three letters or more, and their first letter is that of the word, since another one is another power of ten.
pub fn near(word: &str) -> Vec<&'static str> {
    let long = |known: &&str| known.len() >= 3 && known.chars().next() == word.chars().next();
    let all = UNITS.iter().map(|(word, ..)| *word);
    let all = all.chain(SPELLINGS.iter().map(|(theirs, _)| *theirs));
    let mut found: Vec<&str> = Vec::new();
    for near in slips(word, all.filter(long)) {
        let ours = spelled(near).unwrap_or(near);
        if !found.contains(&ours) {
            found.push(ours);
        }
    }
    found
}

/// Units written as one word, as a product: `N*m` of `Nm`, `N*m*s` of `Nms`, `kg*m^2` of `kgm2`. `kgs` is a plural.
///
/// Where a word can be cut in several places, units without a factor go before milliseconds and millimetres.
pub fn run_together(word: &str) -> Option<String> {
    let digits = word.trim_start_matches(|c: char| !c.is_ascii_digit());
    let exponent = match digits {
        "" => String::new(),
        "2" | "3" => format!("^{digits}"),
        _ => return None,
    };
    let letters = word.strip_suffix(digits)?;
    let plural = |all: &[&str]| matches!(all, [one, "s"] if one.len() > 1);
    let products = cuts(letters, LONGEST_PRODUCT).into_iter();
    let single = |all: &[&str]| all.len() > 1 || !exponent.is_empty();
    let scaled = |all: &[&str]| -> usize {
        let scaled = |unit: &&&str| find(unit).is_some_and(|(factor, _)| factor != 1.0);
        all.iter().filter(scaled).count()
    };
    // Nobody glues a litre to another unit, and a mass comes first: `mmHg` is no `m*mH*g`.
    let apart = |all: &[&str]| {
        let mass = |unit: &&str| find(unit).is_some_and(|(_, dimension)| dimension == MASS);
        all.contains(&"l") || all.iter().skip(1).any(mass)
    };
    let products: Vec<_> = products.filter(|all| single(all) && !apart(all)).collect();
    if products.iter().any(|all| plural(all)) {
        return None;
    }
    let found = (products.into_iter()).min_by_key(|all| (scaled(all), all.len()));
    found.map(|all| format!("{}{exponent}", all.join("*")))
}

/// So many units are written as one word at most.
const LONGEST_PRODUCT: usize = 4;

/// Every way to cut a word into at most so many units, none of them twice.
fn cuts(word: &str, most: usize) -> Vec<Vec<&str>> {
    let mut all = Vec::new();
    if most == 0 {
        return all;
    }
    if find(word).is_some() {
        all.push(vec![word]);
    }
    let places = (1..word.len()).filter(|&cut| word.is_char_boundary(cut));
    for (first, rest) in places.map(|cut| word.split_at(cut)) {
        if find(first).is_none() {
            continue;
        }
        let behind = cuts(rest, most - 1).into_iter();
        let once = behind.filter(|behind| !behind.contains(&first));
        all.extend(once.map(|behind| [vec![first], behind].concat()));
    }
    all
}

/// SI value and dimension of a unit word.
pub fn find(word: &str) -> Option<(f64, Dimension)> {
    UNITS
        .iter()
        .find(|(known, ..)| *known == word)
        .map(|(_, factor, dimension)| (*factor, *dimension))
}

/// The words of all named quantities.
pub fn quantities() -> Vec<&'static str> {
    QUANTITIES.iter().map(|(word, ..)| *word).collect()
}

/// The SI unit of a named quantity.
pub fn of_quantity(word: &str) -> Option<Unit> {
    QUANTITIES
        .iter()
        .find(|(known, ..)| *known == word)
        .map(|(_, text, dimension)| si(text, *dimension))
}

/// An SI unit.
pub fn si(text: &str, dimension: Dimension) -> Unit {
    Unit {
        text: text.to_string(),
        factor: 1.0,
        dimension,
    }
}

/// The name of a dimension, if it has one: `force`.
pub fn name(dimension: Dimension) -> Option<String> {
    QUANTITIES
        .iter()
        .find(|(.., known)| *known == dimension)
        .map(|(word, ..)| word.replace('_', " "))
}

/// The SI unit of a dimension: `kg*m^2`; empty for none.
pub fn si_text(dimension: Dimension) -> String {
    if dimension == RATE {
        return "1/s".to_string();
    }
    if dimension == ANGULAR_ACCELERATION {
        return "1/s^2".to_string();
    }
    if let Some((_, text, _)) = QUANTITIES.iter().find(|(.., known)| *known == dimension) {
        return (*text).to_string();
    }
    let powers = [
        ("kg", dimension.mass),
        ("m", dimension.length),
        ("s", dimension.time),
        ("A", dimension.current),
    ];
    let factor = |(word, doubled): &(&str, i8)| match doubled.abs() {
        2 => (*word).to_string(),
        n if n % 2 == 0 => format!("{word}^{}", n / 2),
        n => format!("{word}^({n}/2)"),
    };
    let over: Vec<String> = powers.iter().filter(|p| p.1 > 0).map(factor).collect();
    let under: Vec<String> = powers.iter().filter(|p| p.1 < 0).map(factor).collect();
    let top = if over.is_empty() {
        "1".to_string()
    } else {
        over.join("*")
    };
    match under.len() {
        0 => top,
        1 => format!("{top}/{}", under[0]),
        _ => format!("{top}/({})", under.join("*")),
    }
}

/// A dimension for the reader: `a force (N)`, `in kg*m/s`, `a pure number`.
pub fn described(dimension: Dimension) -> String {
    if dimension == NONE {
        return "a pure number".to_string();
    }
    let unit = si_text(dimension);
    match name(dimension) {
        Some(name) => {
            let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) {
                "an"
            } else {
                "a"
            };
            format!("{article} {name} ({unit})")
        }
        None => format!("in {unit}"),
    }
}

/// The dimension of a product; `None` when an exponent grows beyond all sense.
pub fn times(a: Dimension, b: Dimension) -> Option<Dimension> {
    combine(a, b, i8::checked_add)
}

/// The dimension of a quotient.
pub fn over(a: Dimension, b: Dimension) -> Option<Dimension> {
    combine(a, b, i8::checked_sub)
}

fn combine(a: Dimension, b: Dimension, with: impl Fn(i8, i8) -> Option<i8>) -> Option<Dimension> {
    Some(Dimension {
        mass: with(a.mass, b.mass)?,
        length: with(a.length, b.length)?,
        time: with(a.time, b.time)?,
        current: with(a.current, b.current)?,
    })
}

/// The dimension of a whole power.
pub fn power(a: Dimension, n: i32) -> Option<Dimension> {
    let raise = |e: i8| i8::try_from(i32::from(e).checked_mul(n)?).ok();
    Some(Dimension {
        mass: raise(a.mass)?,
        length: raise(a.length)?,
        time: raise(a.time)?,
        current: raise(a.current)?,
    })
}

/// The dimension of a square root; `None` when it would have quarter exponents.
pub fn root(a: Dimension) -> Option<Dimension> {
    let halve = |e: i8| (e % 2 == 0).then_some(e / 2);
    Some(Dimension {
        mass: halve(a.mass)?,
        length: halve(a.length)?,
        time: halve(a.time)?,
        current: halve(a.current)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newton_is_a_kilogram_metre_per_second_squared() {
        let built = over(times(MASS, LENGTH).unwrap(), power(TIME, 2).unwrap()).unwrap();
        assert_eq!(built, FORCE);
        assert_eq!(si_text(built), "N");
        assert_eq!(described(built), "a force (N)");
        assert_eq!(described(INERTIA), "an inertia (kg*m^2)");
    }

    #[test]
    fn glued_units_are_cut_where_no_unit_has_a_factor() {
        let cut = |word: &str| run_together(word).unwrap_or_default();
        assert_eq!(cut("Nm"), "N*m");
        assert_eq!(cut("kNm"), "kN*m");
        // A torque over a rate, not newton-milliseconds.
        assert_eq!(cut("Nms"), "N*m*s");
        assert_eq!(cut("Nmm"), "N*mm");
        assert_eq!(cut("kgm2"), "kg*m^2");
        assert_eq!(cut("m3"), "m^3");
        assert_eq!(run_together("kgs"), None);
        assert_eq!(run_together("mms"), None);
        assert_eq!(run_together("kilos"), None);
        assert_eq!(run_together("m"), None);
        // Other units than the letters of ours make.
        for word in ["ml", "mmHg", "dl", "mg2l"] {
            assert_eq!(run_together(word), None, "{word}");
        }
    }

    #[test]
    fn a_unit_is_not_proposed_for_one_that_is_a_thousand_million_times_as_large() {
        for word in ["MA", "MV", "Mm", "MM", "mpa"] {
            assert_eq!(same_but_for_case(word), None, "{word}");
        }
        let near = ["KN", "mv", "M", "MPH", "S"].map(same_but_for_case);
        assert_eq!(near, ["kN", "mV", "m", "mph", "s"].map(Some));
    }

    #[test]
    fn a_unit_with_a_slip_in_it_is_proposed_and_no_other_power_of_ten() {
        let near = ["rmp", "degr", "degre", "rpmm", "kNn"].map(near);
        assert_eq!(
            near,
            [vec!["rpm"], vec!["deg"], vec!["deg"], vec!["rpm"], vec![]]
        );
        for word in ["mpa", "kts", "mil", "mHz", "MHz", "mdeg", "xPa", "ab", "kN"] {
            assert_eq!(super::near(word), Vec::<&str>::new(), "{word}");
        }
    }

    #[test]
    fn the_root_of_a_root_of_an_area_has_half_exponents_and_no_quarter() {
        let half = root(root(AREA).unwrap()).unwrap();
        assert_eq!(si_text(half), "m^(1/2)");
        assert_eq!(root(half), None);
    }

    #[test]
    fn si_units_without_a_name_are_spelled_out() {
        assert_eq!(si_text(dimension(1, 3, -3)), "kg*m^3/s^3");
        assert_eq!(si_text(dimension(0, -1, -1)), "1/(m*s)");
    }
}
