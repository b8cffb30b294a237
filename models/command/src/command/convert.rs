//! `mbd convert`: any scene as TOML, or as the text of a declaration.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use mbd_compiler::{format_text, read_toml_in, text_to_toml, toml_to_text, write_text, write_toml};

use super::failure::CommandFailure;
use super::scene_file::SceneFile;

/// The two forms of a scene file.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum FileFormat {
    /// Tables and keys.
    Toml,
    /// The text of a `model!` declaration.
    Mbd,
}

/// What to convert, and into what.
#[derive(Args, Debug)]
pub struct ConvertArgs {
    /// A ready scene (`mbd list`), or a file: `.toml`, `.urdf`, or the text of a `model!` declaration in a file of any other name.
    scene: PathBuf,
    /// The form to write.
    #[arg(long, value_name = "FORM", default_value = "toml")]
    to: FileFormat,
}

/// The scene of a file in one of both forms, with the settings of its run.
pub fn convert(args: &ConvertArgs) -> Result<String, CommandFailure> {
    let file = SceneFile::find(&args.scene)?;
    // What was written by a person keeps its repetitions, consts, units and expressions.
    let scene = match (args.to, &file.document, &file.text) {
        (FileFormat::Toml, Some(document), _) => document.clone(),
        (FileFormat::Mbd, Some(document), _) => {
            laid_out(toml_to_text(document).unwrap_or_default())
        }
        (FileFormat::Toml, None, Some(text)) => {
            let folder = args.scene.parent().unwrap_or(Path::new(""));
            // One that would be another scene is written from what it is.
            let same = |document: &String| {
                read_toml_in(document, folder).scene.as_ref() == Some(&file.scene)
            };
            let document = text_to_toml(text).filter(same);
            document.unwrap_or_else(|| write_toml(&file.scene))
        }
        (FileFormat::Mbd, None, Some(text)) => laid_out(text.clone()),
        (FileFormat::Toml, None, None) => write_toml(&file.scene),
        (FileFormat::Mbd, None, None) => laid_out(write_text(&file.scene)),
    };
    Ok(match file.run.as_str() {
        "" => scene,
        run => format!("{}\n\n{run}\n", scene.trim_end()),
    })
}

/// A declaration as `mbd fmt` writes it.
fn laid_out(text: String) -> String {
    format_text(&text).unwrap_or(text)
}
