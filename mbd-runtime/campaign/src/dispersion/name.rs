//! What can be dispersed: params, what the start is said in, inputs. Each by the name that its column of the results has.

use mbd_compiler::ABOUT;
use mbd_runtime::scene::laws::constant;
use mbd_runtime::scene::{InputSource, Parameter, Quantity, Scene, Unit};
use mbd_runtime::{Generic, Layout, Simulation, state_names};
use toml::Value;

use crate::run::names::{PlanError, flat, unknown, wrong};
use crate::run::plan::{about, coordinate_unit, whole_name};
use crate::run::{RunPlan, Settings};

/// Where a dispersed number goes.
#[derive(Clone, Debug, PartialEq)]
pub enum DispersionTarget {
    /// A param, by index; scenes that go on and have one of its name have the same.
    Param(usize),
    /// A param of scenes that go on, alone.
    LaterParam,
    /// What the start is said in: a coordinate of the state or of a joint, by name.
    Start(String),
    /// A number of the inputs, by its place.
    Input(usize),
}

/// Something that can be dispersed: where it goes, its unit, and its nominal value [SI].
#[derive(Clone, Debug, PartialEq)]
pub struct Dispersible {
    /// Its name, as the results have it.
    pub name: String,
    /// Where it goes.
    pub target: DispersionTarget,
    /// Its unit.
    pub unit: String,
    /// SI value of one such unit.
    pub factor: f64,
    /// Its value in the nominal case [SI]; not a number of a joint coordinate of which nothing is said, where the nominal case cannot begin.
    pub nominal: f64,
}

/// A scene that goes on from another one.
#[derive(Debug)]
pub struct LaterScene<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How it is run.
    pub plan: &'a RunPlan,
    /// The names that are always mapped when it goes on.
    pub mapped: Vec<&'a str>,
}

impl<'a> LaterScene<'a> {
    /// The params that begin as planned, with their values: those of the others are what a `map` hands on.
    fn params(&self) -> impl Iterator<Item = (&'a Parameter, &'a f64)> {
        let all = self.scene.params.iter().zip(&self.plan.params);
        all.filter(|(param, _)| !self.mapped.contains(&param.name.as_str()))
    }
}

/// Everything that can be dispersed in a scene that is run as planned, and the params of those that go on from it.
pub fn known(
    (scene, layout): (&Scene, &Layout),
    (plan, settings): (&RunPlan, &Settings),
    later: &[LaterScene<'_>],
) -> Vec<Dispersible> {
    let known = |param: &Parameter, target: DispersionTarget, nominal: f64| Dispersible {
        name: param.name.clone(),
        target,
        unit: param.unit.text.clone(),
        factor: param.unit.factor,
        nominal,
    };
    let params = scene.params.iter().zip(&plan.params).enumerate();
    let mut all: Vec<Dispersible> = params
        .map(|(index, (param, nominal))| known(param, DispersionTarget::Param(index), *nominal))
        .collect();
    for later in later {
        for (param, nominal) in later.params() {
            if !all.iter().any(|known| known.name == param.name) {
                all.push(known(param, DispersionTarget::LaterParam, *nominal));
            }
        }
    }
    let states = state_names(scene, layout).into_iter().zip(&plan.state);
    all.extend(states.map(|(name, nominal)| start(name.name, &name.unit, *nominal)));
    let at_start = coordinates_at_start(scene, layout, plan);
    for (number, name) in scene.joint_coordinates().into_iter().enumerate() {
        if let Some(unit) = coordinate_unit(scene, &name) {
            let said =
                written(scene, settings, &name).or_else(|| declared(scene, &plan.params, &name));
            let measured = || at_start.as_ref()?.get(number).copied();
            let nominal = said.or_else(measured).unwrap_or(f64::NAN);
            all.push(start(name, unit, nominal));
        }
    }
    for slots in &layout.inputs {
        let InputSource::Input(index) = slots.source else {
            continue;
        };
        let Some(input) = scene.inputs.get(index) else {
            continue;
        };
        for component in 0..slots.len {
            let place = slots.at + component;
            let axis = ["x", "y", "z"].get(component).filter(|_| slots.len > 1);
            let axis = axis.map_or(String::new(), |axis| format!(".{axis}"));
            all.push(Dispersible {
                name: format!("inputs.{}{axis}", input.name),
                target: DispersionTarget::Input(place),
                unit: input.unit.text.clone(),
                factor: input.unit.factor,
                nominal: plan.inputs.get(place).copied().unwrap_or(0.0),
            });
        }
    }
    all
}

fn start(name: String, unit: &str, nominal: f64) -> Dispersible {
    Dispersible {
        name: format!("start.{name}"),
        unit: unit.to_owned(),
        factor: 1.0,
        nominal,
        target: DispersionTarget::Start(name),
    }
}

/// The coordinates of all joints with their rates, in the order of their names, where the nominal case begins [m or rad, and per second]; `None` where it
/// cannot begin.
fn coordinates_at_start(scene: &Scene, layout: &Layout, plan: &RunPlan) -> Option<Vec<f64>> {
    let model = Generic::<f64>::new(scene.clone(), &plan.params).ok()?;
    let mut run = Simulation::new(&model, plan.options).ok()?;
    plan.begin(&mut run).ok()?;
    let mut numbers = vec![0.0; layout.len(Quantity::Coordinates)];
    run.evaluate(Quantity::Coordinates, &mut numbers).ok()?;
    Some(numbers)
}

/// Where the declaration starts a joint coordinate, or its rate; `None` where it says nothing.
fn declared(scene: &Scene, params: &[f64], name: &str) -> Option<f64> {
    let (joint, number, is_rate) = scene.joint_coordinate(name)?;
    let mut starts = scene.starts.coordinates.iter();
    let start = starts.find(|start| (start.joint, start.coordinate) == (joint, number))?;
    let formula = match is_rate {
        true => start.rate.as_ref(),
        false => start.value.as_ref(),
    };
    Some(constant(scene, params, formula?))
}

/// What the settings give a joint coordinate; `None` where they say nothing. Numbers were checked when the run was planned.
fn written(scene: &Scene, settings: &Settings, name: &str) -> Option<f64> {
    match setting(scene, settings, name)? {
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        Value::String(text) => {
            let number = mbd_compiler::read_number(about(text).unwrap_or(text));
            number.ok().map(|(number, _)| number)
        }
        _ => None,
    }
}

/// What the settings write of a coordinate.
fn setting<'a>(scene: &Scene, settings: &'a Settings, name: &str) -> Option<&'a Value> {
    let mut given = flat(&settings.start).into_iter();
    let found = given.find(|(given, _)| whole_name(scene, given.clone()) == name);
    found.map(|(_, value)| value)
}

/// Whether a coordinate is about a value, and gives way where a loop decides it.
pub fn gives_way(scene: &Scene, settings: &Settings, name: &str) -> bool {
    let found = scene.joint_coordinate(name);
    let declared = |(joint, number, is_rate): (usize, usize, bool)| {
        let mut starts = scene.starts.coordinates.iter();
        let own = starts.find(|start| (start.joint, start.coordinate) == (joint, number));
        !is_rate && own.is_some_and(|start| start.about)
    };
    match setting(scene, settings, name) {
        Some(given) => given.as_str().and_then(about).is_some(),
        None => found.is_some_and(declared),
    }
}

/// How a dispersed start is written: a coordinate that is about a value stays about the value of the case.
pub fn dispersed(scene: &Scene, settings: &Settings, name: &str, value: f64) -> Value {
    let gives_way = gives_way(scene, settings, name);
    match coordinate_unit(scene, name).filter(|_| gives_way) {
        Some(unit) => Value::String(format!("{ABOUT} {value:?} {unit}")),
        None => Value::Float(value),
    }
}

/// Refuses to disperse a param that scenes have with different nominal values, or in different units: which of them is meant?
pub fn is_one(
    known: &Dispersible,
    setting: &str,
    first: (&Scene, &RunPlan),
    later: &[LaterScene<'_>],
) -> Result<(), PlanError> {
    if !matches!(
        known.target,
        DispersionTarget::Param(_) | DispersionTarget::LaterParam
    ) {
        return Ok(());
    }
    let (scene, plan) = first;
    let own = scene.params.iter().zip(&plan.params);
    let own = own.map(|it| (scene, it));
    let others = later.iter();
    let others = others.flat_map(|later| later.params().map(|it| (later.scene, it)));
    let of = own.chain(others).filter_map(|(scene, (param, value))| {
        (param.name == known.name).then_some((&scene.name, &param.unit, *value))
    });
    let all: Vec<(&String, &Unit, f64)> = of.collect();
    let Some((one, unit, value)) = all.first() else {
        return Ok(());
    };
    let differs = |(_, other, x): &&(&String, &Unit, f64)| {
        other.dimension != unit.dimension || x.to_bits() != value.to_bits()
    };
    match all.iter().find(differs) {
        None => Ok(()),
        Some((two, other, x)) => {
            let text = format!(
                "`{one}` has {} {}, and `{two}`, which goes on from it, {} {}: give both one nominal value (here under [run.params]), or one of them another name",
                value / unit.factor,
                unit.text,
                x / other.factor,
                other.text
            );
            Err(wrong(setting, text))
        }
    }
}

/// Something by its name.
pub fn find<'k>(
    known: &'k [Dispersible],
    setting: &str,
    name: &str,
) -> Result<&'k Dispersible, PlanError> {
    let found = known.iter().find(|known| known.name == name);
    if found.is_some_and(|known| known.nominal.is_nan()) {
        let text = "nothing says where it starts, and the nominal case, which would tell, cannot begin: give it a start under [run.start], or let the nominal case begin";
        return Err(wrong(setting, text));
    }
    found.ok_or_else(|| {
        let part = |of: &&Dispersible| match name.split_once('.') {
            Some((part @ ("start" | "inputs"), _)) => of.name.starts_with(&format!("{part}.")),
            _ => matches!(
                of.target,
                DispersionTarget::Param(_) | DispersionTarget::LaterParam
            ),
        };
        let alike = known.iter().filter(part);
        unknown(setting, name, alike.map(|known| known.name.as_str()))
    })
}
