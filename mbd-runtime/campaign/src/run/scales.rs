//! What a tolerance is relative to, where a scene file says so: `[run.scales]`.

use mbd_runtime::Scales;
use mbd_runtime::scene::similar::near_and_all;
use toml::Table;

use super::names::{PlanError, wrong};
use super::number::positive;

/// Their names, with the units they are in.
const SCALES: [(&str, &str); 4] = [
    ("length", "m"),
    ("speed", "m/s"),
    ("angle", "rad"),
    ("rate", "rad/s"),
];

/// The scales of a run; `None` where nothing is said. A length says nothing of speeds, nor they of it: who gives one gives both.
pub fn scales(given: &Table) -> Result<Option<Scales>, PlanError> {
    if given.is_empty() {
        return Ok(None);
    }
    let mut scales = Scales::default();
    for (name, value) in given {
        let setting = format!("scales.{name}");
        let known = SCALES.iter().find(|(known, _)| known == name);
        let Some((_, unit)) = known else {
            let all = near_and_all(name, SCALES.iter().map(|(known, _)| *known));
            return Err(wrong(setting, format!("there is no scale `{name}`{all}")));
        };
        let value = positive(&setting, value, unit)?;
        *match name.as_str() {
            "length" => &mut scales.length,
            "speed" => &mut scales.speed,
            "angle" => &mut scales.angle,
            _ => &mut scales.rate,
        } = value;
    }
    if given.contains_key("length") != given.contains_key("speed") {
        let text = "give `length` and `speed` together, such as `length = \"7000 km\"`, `speed = \"7.5 km/s\"`";
        return Err(wrong("scales", text));
    }
    Ok(Some(scales))
}
