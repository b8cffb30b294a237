//! How runs are set: what the campaign file gives over what the scenes say.

use mbd_runtime::Model;
use mbd_runtime::scene::Scene;
use toml::Table;

use crate::dispersion::CampaignFile;
use crate::run::{CampaignMistakes, GivenSettings, Phase, RunPlan, Settings, settings_of_all};

/// The settings that the file gives, and which of them count in every scene; those that cannot be read are noted.
pub fn given(written: &CampaignFile, mistakes: &mut CampaignMistakes) -> (Settings, GivenSettings) {
    let own = Settings::of_table(&written.run, mistakes);
    let given = GivenSettings {
        method: own.step.is_some() || own.tolerance.is_some() || own.method.is_some(),
        every: own.every.is_some(),
        max_steps: own.max_steps.is_some(),
        params: own.params.keys().cloned().collect(),
        inputs: own.inputs.keys().cloned().collect(),
    };
    (own, given)
}

/// The settings of the runs: those of the file, else those of the scene; params that neither gives are those of the model.
pub fn settings_of(own: Settings, model: &dyn Model<f64>, mut settings: Settings) -> Settings {
    if own.step.is_some() || own.tolerance.is_some() || own.method.is_some() {
        (settings.step, settings.tolerance, settings.method) =
            (own.step, own.tolerance, own.method);
    }
    settings.until = own.until.or(settings.until);
    settings.every = own.every.or(settings.every);
    settings.max_steps = own.max_steps.or(settings.max_steps);
    settings.locate = own.locate.or(settings.locate);
    settings.estimate = own.estimate.or(settings.estimate);
    settings.instants = own.instants.or(settings.instants);
    merge(&mut settings.figures, own.figures);
    merge(&mut settings.scales, own.scales);
    merge(&mut settings.start, own.start);
    merge(&mut settings.inputs, own.inputs);
    merge(&mut settings.params, own.params);
    for (param, value) in model.scene().params.iter().zip(model.params()) {
        let given = settings.params.entry(&param.name);
        given.or_insert(toml::Value::Float(*value));
    }
    settings
}

/// Puts one table over another.
fn merge(under: &mut Table, over: Table) {
    for (name, value) in over {
        match (under.get_mut(&name), value) {
            (Some(toml::Value::Table(under)), toml::Value::Table(over)) => merge(under, over),
            (_, value) => {
                under.insert(name, value);
            }
        }
    }
}

/// Everything that a run may come to as it is run, with what the campaign file gives, and the plans of the nominal case.
pub fn planned(
    mut phases: Vec<Phase>,
    given: &GivenSettings,
) -> Result<(Vec<Phase>, Vec<RunPlan>), CampaignMistakes> {
    let of = |phase: &Phase| phase.settings.clone();
    let own: Vec<Settings> = phases.iter().map(of).collect();
    let first = own.first().cloned().unwrap_or_default();
    let scenes: Vec<_> = phases.iter().map(|phase| phase.model.clone()).collect();
    let scenes: Vec<(&Scene, &Settings)> =
        scenes.iter().map(|model| model.scene()).zip(&own).collect();
    let settled = settings_of_all(&first, given, &scenes);
    for (phase, settings) in phases.iter_mut().zip(settled) {
        phase.settings = settings;
    }
    let mut mistakes = CampaignMistakes::default();
    let mut plans = Vec::with_capacity(phases.len());
    for (index, phase) in phases.iter().enumerate() {
        let scene = (phase.model.scene(), phase.model.layout());
        let plan = RunPlan::with_layout(scene, &phase.settings);
        plans.extend(mistakes.note(plan.map_err(|wrong| match index {
            0 => wrong,
            _ => wrong.of(&format!("of `{}`: ", scene.0.name)),
        })));
    }
    mistakes.unless(Some((phases, plans)))
}
