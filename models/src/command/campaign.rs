//! `mbd campaign`, `mbd gather`, `mbd report`: many cases of a scene, dispersed.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use mbd_campaign::{CampaignArgs, GatherArgs};
use mbd_runtime::Model;

use super::failure::Failure;
use super::scene_file::SceneFile;

/// The scene of a campaign, and the campaign.
#[derive(Args, Debug)]
pub struct SceneCampaignArgs {
    /// A ready scene (`mbd list`) or a scene file.
    scene: PathBuf,
    #[command(flatten)]
    campaign: CampaignArgs,
}

/// Runs a campaign of a scene, or a shard of it.
pub fn campaign(args: &SceneCampaignArgs) -> Result<String, Failure> {
    let file = SceneFile::find(&args.scene)?;
    let model = nominal(&file)?;
    let replay = format!("mbd run {}", args.scene.display());
    Ok(mbd_campaign::campaign(
        &args.campaign,
        model,
        file.settings,
        &|campaign| format!("{replay} --campaign {}", campaign.display()),
    )?)
}

/// Writes the page of a campaign.
pub fn report(args: &GatherArgs) -> Result<String, Failure> {
    Ok(mbd_campaign::report(args)?)
}

/// Puts the results of all shards together.
pub fn gather(args: &GatherArgs) -> Result<String, Failure> {
    Ok(mbd_campaign::gather(args)?)
}

/// The model of a scene as it is declared.
pub fn nominal(file: &SceneFile) -> Result<Arc<dyn Model<f64>>, Failure> {
    let declared = file.scene.params.iter().map(|param| param.default);
    let declared: Vec<f64> = declared.collect();
    let made = file.model_of_many(&declared);
    made.map_err(|error| Failure::Invalid(format!("{}: {error}", file.name)))
}
