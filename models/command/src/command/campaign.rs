//! `mbd campaign`, `mbd gather`, `mbd report`: many cases of a scene, dispersed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use mbd_campaign::run::Phase;
use mbd_campaign::{Campaign, CampaignArgs, GatherArgs, ResultSource};
use mbd_runtime::Model;

use super::failure::CommandFailure;
use super::phases::Phases;
use super::run::above;
use super::scene_file::SceneFile;
use crate::describe::warnings_of_reactions;
use crate::run::{RunPlan, warning_before};

/// The scene of a campaign, and the campaign.
#[derive(Args, Debug)]
pub struct SceneCampaignArgs {
    /// A ready scene (`mbd list`) or a scene file.
    scene: PathBuf,
    #[command(flatten)]
    campaign: CampaignArgs,
}

/// Runs a campaign of a scene, or a shard of it.
pub fn campaign(args: &SceneCampaignArgs) -> Result<String, CommandFailure> {
    let campaign = args.campaign.file();
    if campaign.extension().is_some_and(|end| end == "mbd") {
        return Err(CommandFailure::Usage(format!(
            "{} is a scene: the scene comes first, then the campaign file, `mbd campaign {0} {}`",
            campaign.display(),
            args.scene.display()
        )));
    }
    let phases = phases(&args.scene)?;
    let first = phases.0.model.scene();
    // The campaign tells what it cannot run.
    let nominal = RunPlan::new(first, &phases.0.settings).ok();
    let moved = above(nominal.and_then(|plan| warning_before(first, &plan)));
    let many = warnings_of_reactions(first).into_iter();
    let many = many.map(|text| format!("{text}; what is required of it shows nothing\n"));
    let moved: String = std::iter::once(moved).chain(many).collect();
    let source = |campaign: &Path| ResultSource {
        command: format!(
            "mbd run {} --campaign {}",
            args.scene.display(),
            campaign.display()
        ),
        scene: Some(args.scene.clone()),
        campaign: campaign.to_owned(),
    };
    Ok(moved + &mbd_campaign::campaign(&args.campaign, phases, &source)?)
}

/// Writes the page of a campaign, with the histories it chooses.
pub fn report(args: &GatherArgs) -> Result<String, CommandFailure> {
    Ok(mbd_campaign::report(args, &reopen)?)
}

/// The campaign of a folder, by the files it is from.
fn reopen(source: &ResultSource) -> Result<Campaign, mbd_campaign::Failure> {
    let Some(scene) = &source.scene else {
        let text = format!(
            "its model is that of a program of its own: `{}`",
            source.command
        );
        return Err(mbd_campaign::Failure::Usage(text));
    };
    let told = |failure: CommandFailure| mbd_campaign::Failure::Invalid(failure.to_string());
    let (first, later) = phases(scene).map_err(told)?;
    Campaign::read_phases(&source.campaign, first, later)
}

/// The scenes that the runs of a campaign come to: the one that begins, and those that go on.
fn phases(scene: &Path) -> Result<(Phase, Vec<Phase>), CommandFailure> {
    Phases::of(SceneFile::find(scene)?, scene)?.of_many()
}

/// Puts the results of all shards together.
pub fn gather(args: &GatherArgs) -> Result<String, CommandFailure> {
    Ok(mbd_campaign::gather(args)?)
}

/// The model of a scene as it is declared.
pub fn nominal(file: &SceneFile) -> Result<Arc<dyn Model<f64>>, CommandFailure> {
    let declared = file.scene.params.iter().map(|param| param.default);
    let declared: Vec<f64> = declared.collect();
    let made = file.model_of_many(&declared);
    made.map_err(|error| CommandFailure::Invalid(format!("{}: {error}", file.name)))
}
