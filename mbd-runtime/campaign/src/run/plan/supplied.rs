//! The numbers that a scene takes from its user: params, and what its caller supplies.

use mbd_runtime::Layout;
use mbd_runtime::scene::{Input, InputSource, Parameter, Scene};
use toml::{Table, Value};

use crate::run::mistakes::CampaignMistakes;
use crate::run::names::{PlanError, unknown, wrong};
use crate::run::number::{numbers as numbers_of, supplied, zeros};

/// The params, in declaration order.
pub(super) fn params(scene: &Scene, given: &Table) -> Result<Vec<f64>, CampaignMistakes> {
    let mut mistakes = CampaignMistakes::default();
    let mut params: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let names = || scene.params.iter().map(|param| param.name.as_str());
    for (name, value) in given {
        let setting = format!("params.{name}");
        let Some((param, slot)) = scene
            .params
            .iter()
            .zip(&mut params)
            .find(|(param, _)| param.name == *name)
        else {
            let mut inputs = scene.inputs.iter();
            mistakes.note::<()>(Err(match inputs.find(|input| input.name == *name) {
                Some(input) => wrong(setting, held(input)),
                None => unknown(&setting, name, names()),
            }));
            continue;
        };
        if let Some(number) = mistakes.note(supplied(&setting, value, &param.unit.text)) {
            *slot = number;
        }
    }
    mistakes.unless(Some(params))
}

/// What is said where an input is given as a param.
fn held(input: &Input) -> String {
    let (name, unit) = (&input.name, &input.unit.text);
    let value = match input.components {
        3 => format!("[1, 0, 0] {unit}"),
        _ => format!("1 {unit}"),
    };
    format!(
        "`{name}` is an input and no param: what it is held at stands under [run.inputs], `{name} = \"{}\"`, or behind `--input` of `mbd run`",
        value.trim_end()
    )
}

/// What is said where a param is given as an input.
fn set_as(param: &Parameter) -> String {
    let name = &param.name;
    let value = param.unit.told(param.default);
    format!(
        "`{name}` is a param and no input: its value stands under [run.params], `{name} = \"{value}\"`, or behind `--set` of `mbd run`"
    )
}

/// What the caller supplies, in the order of the layout.
pub(super) fn inputs(
    scene: &Scene,
    layout: &Layout,
    given: &Table,
) -> Result<Vec<f64>, CampaignMistakes> {
    let mut mistakes = CampaignMistakes::default();
    let mut numbers = layout.default_inputs(scene);
    let (mut known, mut told): (Vec<&str>, Vec<String>) = Default::default();
    for slots in &layout.inputs {
        let (name, units): (Option<&str>, Vec<&str>) = match slots.source {
            InputSource::Input(index) => {
                let input = scene.inputs.get(index);
                let unit = input.map_or("", |input| input.unit.text.as_str());
                (
                    input.map(|input| input.name.as_str()),
                    vec![unit; slots.len],
                )
            }
            InputSource::Load(index) => {
                let units = ["N", "N", "N", "N*m", "N*m", "N*m"];
                (
                    scene.loads.get(index).map(|load| load.name.as_str()),
                    units.to_vec(),
                )
            }
            InputSource::BodyGravity(index) => (
                scene.bodies.get(index).map(|body| body.name.as_str()),
                vec!["m/s^2"; 3],
            ),
            InputSource::PointGravity(index) => (
                scene.points.get(index).map(|point| point.name.as_str()),
                vec!["m/s^2"; 3],
            ),
        };
        let name = name.unwrap_or_default();
        known.push(name);
        let setting = format!("inputs.{name}");
        let shared = match given.contains_key(name) {
            true => None,
            false => match of_repeated(scene, name, given) {
                Ok(shared) => shared,
                // The first of them tells it.
                Err(wrong) => {
                    if !told.contains(&wrong.setting) {
                        told.push(wrong.setting.clone());
                        mistakes.note::<()>(Err(wrong));
                    }
                    continue;
                }
            },
        };
        let Some(value) = given.get(name).or(shared) else {
            if matches!(slots.source, InputSource::Input(_)) {
                continue;
            }
            let units = units.get(..slots.len).unwrap_or(&units);
            let text = format!(
                "this scene takes `{name}` from its caller: give {} number(s) under [run.inputs], such as `{name} = {}`",
                slots.len,
                zeros(units)
            );
            mistakes.note::<()>(Err(wrong(setting, text)));
            continue;
        };
        // A load on a point with mass has a force alone.
        let units = units.get(..slots.len).unwrap_or(&units);
        let given = match (units, value) {
            ([unit], Value::String(_)) => supplied(&setting, value, unit).map(|x| vec![x]),
            _ => numbers_of(&setting, value, units),
        };
        let own = numbers.iter_mut().skip(slots.at);
        let given = mistakes.note(given).unwrap_or_default();
        own.zip(given).for_each(|(to, value)| *to = value);
    }
    let is_known = |name: &str| known.contains(&name) || !repeated(scene, name).is_empty();
    for name in given.keys().filter(|name| !is_known(name)) {
        let setting = format!("inputs.{name}");
        let mut params = scene.params.iter();
        mistakes.note::<()>(Err(match params.find(|param| param.name == *name) {
            Some(param) => wrong(setting, set_as(param)),
            None => unknown(&setting, name, known.iter().copied()),
        }));
    }
    mistakes.unless(Some(numbers))
}

/// The inputs that are declared together: those that `c[i in 0..3]` stands for, by `c`.
pub(crate) fn repeated<'s>(scene: &'s Scene, name: &str) -> Vec<&'s Input> {
    let inputs = scene.inputs.iter();
    inputs
        .filter(|input| together(&input.name) == Some(name))
        .collect()
}

/// The inputs of which these settings say where they are held, each by itself or all that were declared together.
pub(super) fn said_to_be_held(scene: &Scene, given: &Table) -> Vec<String> {
    let said = |name: &str| {
        given.contains_key(name) || together(name).is_some_and(|all| given.contains_key(all))
    };
    let names = scene.inputs.iter().map(|input| &input.name);
    names.filter(|name| said(name)).cloned().collect()
}

/// The name that an input was repeated from.
pub(super) fn together(name: &str) -> Option<&str> {
    name.split_once('[').map(|(all, _)| all)
}

/// What an input has of the value for all that were declared together: its own of a list that has one for each, else the same.
fn of_repeated<'a>(
    scene: &Scene,
    name: &str,
    given: &'a Table,
) -> Result<Option<&'a Value>, PlanError> {
    let Some((all, value)) = together(name).and_then(|all| given.get_key_value(all)) else {
        return Ok(None);
    };
    let inputs = repeated(scene, all);
    let Some(place) = inputs.iter().position(|input| input.name == name) else {
        return Ok(None);
    };
    let is_vector = |value: &Value| match value {
        Value::Array(_) => true,
        Value::String(text) => text.trim_start().starts_with('['),
        _ => false,
    };
    match value {
        Value::Array(list) if inputs[place].components == 1 || list.iter().all(is_vector) => {
            match list.get(place) {
                Some(own) if list.len() == inputs.len() => Ok(Some(own)),
                _ => Err(wrong(
                    format!("inputs.{all}"),
                    format!(
                        "expected one value for all, or {} in brackets, one for each input from `{}` on; found {}",
                        inputs.len(),
                        inputs[0].name,
                        list.len()
                    ),
                )),
            }
        }
        shared => Ok(Some(shared)),
    }
}
