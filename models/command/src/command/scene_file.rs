//! Scenes by name or file: reading them, and telling every mistake of a file with its place.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use mbd_campaign::run::check_units;
use mbd_compiler::{
    Emitted, Interpreted, Message, Reading, immovable, read_text_in, read_toml_in, read_urdf,
    write_toml,
};
use mbd_runtime::scene::{Scene, check_params};
use mbd_runtime::{Generic, Layout, Model, ParamError, Simulation, StepError};
use models::in_lanes::in_lanes;
use models::scenes::{self, Make};

use super::failure::CommandFailure;
use super::list::{self, ReadyEntry};
use super::mistakes::Mistakes;
use crate::run::{
    PlanError, RunPlan, Settings, SettingsError, line_of, misnamed_table, split, warning_of,
    windows,
};

/// A scene that was read without errors.
#[derive(Debug)]
pub struct SceneFile {
    /// The name of the file, or of the ready scene.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// Everything that was read.
    pub reading: Reading,
    /// The whole text of the file.
    pub source: String,
    /// The scene as it was written, if in TOML.
    pub document: Option<String>,
    /// The declaration as it was written, if as text.
    pub text: Option<String>,
    /// How its run is set: the table `[run]`.
    pub settings: Settings,
    /// That table as written.
    pub run: String,
    /// Warnings, and choices that were made, one line each.
    pub remarks: Vec<String>,
    /// Its compiled model; `None` for a file.
    pub compiled: Option<Make>,
}

/// How a scene is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SceneFormat {
    /// The text of a declaration.
    Text,
    /// A declaration in TOML.
    Toml,
    /// A robot.
    Urdf,
}

impl SceneFormat {
    /// By the end of the file's name.
    fn of(path: &Path) -> SceneFormat {
        let is = |word: &str| {
            path.extension()
                .is_some_and(|end| end.eq_ignore_ascii_case(word))
        };
        match (is("toml"), is("urdf")) {
            (true, _) => SceneFormat::Toml,
            (_, true) => SceneFormat::Urdf,
            _ => SceneFormat::Text,
        }
    }

    /// What is read of a scene without the settings of its run; files that it names lie relative to `folder`.
    fn reading(self, scene: &str, folder: &Path) -> Reading {
        match self {
            SceneFormat::Toml => read_toml_in(scene, folder),
            SceneFormat::Text => read_text_in(scene, folder),
            SceneFormat::Urdf => read_urdf(scene),
        }
    }
}

/// Files above this size are no scenes [bytes].
const LARGEST: u64 = 10_000_000;

impl SceneFile {
    /// A ready scene by name, else a file.
    pub fn find(scene: &Path) -> Result<SceneFile, CommandFailure> {
        match scene.to_str().and_then(list::ready) {
            Some(ReadyEntry::Compiled(ready)) if !scene.is_file() => SceneFile::of_compiled(ready),
            Some(ReadyEntry::Written(ready)) if !scene.is_file() => {
                let form = if ready.is_toml {
                    SceneFormat::Toml
                } else {
                    SceneFormat::Text
                };
                SceneFile::of_text(ready.text, Path::new(ready.name), form)
            }
            _ if scene.exists() || scene.extension().is_some() => SceneFile::read(scene),
            _ => Err(CommandFailure::Usage(list::unknown(
                &scene.display().to_string(),
            ))),
        }
    }

    /// The same, of a command that flies one scene alone.
    ///
    /// # Errors
    /// A scene that lets another one go on.
    pub fn find_alone(scene: &Path, command: &str) -> Result<SceneFile, CommandFailure> {
        let file = SceneFile::find(scene)?;
        let mut events = file.scene.events.iter();
        let going = events.find(|event| event.actions.next.is_some());
        let Some(event) = going else {
            return Ok(file);
        };
        Err(CommandFailure::Invalid(format!(
            "{}: event `{}` lets another scene go on, and `mbd {command}` takes one scene: fly all of it with `mbd run`, or write `then: stop` there and give each scene by itself",
            file.name, event.name
        )))
    }

    /// What is run: the compiled model, or the compiled equations of a file, interpreted; with these params.
    ///
    /// # Errors
    /// Params that it cannot be run with.
    pub fn model(&self, params: &[f64]) -> Result<Arc<dyn Model<f64>>, ParamError> {
        match self.compiled {
            Some(make) => make(params),
            None => Interpreted::<f64>::shared(self.scene.clone(), params),
        }
    }

    /// The same for many runs: what is interpreted has its equations over lanes at hand.
    ///
    /// # Errors
    /// Params that it cannot be run with.
    pub fn model_of_many(&self, params: &[f64]) -> Result<Arc<dyn Model<f64>>, ParamError> {
        match self.compiled {
            Some(make) => make(params),
            None => Ok(in_lanes(&Interpreted::new(self.scene.clone(), params)?).share()),
        }
    }

    /// A setting of its run that cannot be used, with the line where it stands in this file.
    pub fn misset(&self, error: &PlanError) -> CommandFailure {
        // What was typed beside the file may be what is wrong.
        let own = RunPlan::new(&self.scene, &self.settings).err();
        let line = own.filter(|own| own == error);
        let line = line.and_then(|error| self.line_of(&error));
        match line {
            Some(_) => self.mistake(SettingsError {
                line,
                text: error.to_string(),
            }),
            None => CommandFailure::Invalid(format!("{}: {error}", self.name)),
        }
    }

    /// Tells what stands in the settings that it is run with and cannot be used; what is left out may be given with the command that runs it. A scene that
    /// goes on from another (`begins` is false) begins where that one is. What a run of it will say of its start, where it is not as it was asked to be.
    ///
    /// # Errors
    /// The first such setting.
    pub fn check_settings(
        &self,
        settings: &Settings,
        begins: bool,
    ) -> Result<Option<String>, CommandFailure> {
        let mut settings = settings.clone();
        settings.until.get_or_insert(1.0.into());
        let plan = match RunPlan::new(&self.scene, &settings) {
            Ok(plan) => plan,
            Err(error) => {
                let line = self.line_of(&error);
                let text = error.to_string();
                // What the declaration says of its start stands in no setting.
                return match line.is_some() || error.setting == "start" {
                    true => Err(self.mistake(SettingsError { line, text })),
                    false => Ok(None),
                };
            }
        };
        if let Err(error) = check_params(&self.scene, &plan.params) {
            return Err(self.misparam(&error, &[]));
        }
        match begins {
            true => self
                .start(&plan)
                .map_err(|text| self.mistake(SettingsError { line: None, text })),
            false => Ok(None),
        }
    }

    /// A set of params that the model cannot have, at the line that sets the one that is wrong; `given` were set otherwise.
    pub fn misparam(&self, error: &ParamError, given: &[String]) -> CommandFailure {
        let name = match error {
            ParamError::OutOfRange { param, .. } | ParamError::NotFinite { param, .. } => {
                Some(param).filter(|param| !given.contains(param))
            }
            _ => None,
        };
        self.mistake(SettingsError {
            line: name.and_then(|name| self.line_of_setting(&format!("params.{name}"))),
            text: error.to_string(),
        })
    }

    /// A mistake in the settings of its run.
    fn mistake(&self, settings: SettingsError) -> CommandFailure {
        CommandFailure::Mistakes(Box::new(Mistakes {
            file: self.name.clone(),
            source: self.source.clone(),
            errors: Vec::new(),
            settings: Some(settings),
            notes: Vec::new(),
        }))
    }

    /// What a run says of its start where it is not as it was asked to be; `None` also where something else keeps it from beginning.
    ///
    /// # Errors
    /// What it says of joints that cannot hold where it begins, and of springs without a direction there.
    fn start(&self, plan: &RunPlan) -> Result<Option<String>, String> {
        let model = Generic::<f64>::new(self.scene.clone(), &plan.params);
        let begun = model.ok().and_then(|model| {
            let mut run = Simulation::new(&model, plan.options).ok()?;
            plan.begin(&mut run).ok().map(|()| run)
        });
        let Some(mut run) = begun else {
            return Ok(None);
        };
        let Err(error) = run.start() else {
            return Ok(warning_of(&run, plan));
        };
        let cause = error.cause;
        let opens = matches!(
            cause,
            StepError::InconsistentStart { .. }
                | StepError::WrongBranch { .. }
                | StepError::NoDirection { .. }
        );
        match opens {
            true => Err(format!("{cause}; {}", cause.advice())),
            false => Ok(None),
        }
    }

    /// What is said of metrics that count, and of rows and drawings that are asked for, beyond the end of the run that the file sets.
    pub fn windows(&self) -> Vec<String> {
        let plan = RunPlan::new(&self.scene, &self.settings);
        plan.map_or(Vec::new(), |plan| {
            [windows(&self.scene, plan.until), plan.beyond(plan.until)].concat()
        })
    }

    /// The line of a setting in this file.
    fn line_of(&self, error: &PlanError) -> Option<usize> {
        self.line_of_setting(&error.setting)
    }

    fn line_of_setting(&self, setting: &str) -> Option<usize> {
        if self.compiled.is_some() {
            return None;
        }
        line_of(&split(&self.source).1, setting)
    }

    /// The declaration of a compiled scene, read back from its data.
    fn of_compiled(ready: &scenes::Ready) -> Result<SceneFile, CommandFailure> {
        let text = format!("{}\n{}", write_toml(&(ready.scene)()), (ready.run)());
        let mut file = SceneFile::of_text(&text, Path::new(ready.name), SceneFormat::Toml)?;
        file.compiled = Some(ready.model);
        // Its names were checked when it was compiled; in its data consts are folded and would seem unused.
        file.remarks.clear();
        file.reading.warnings.clear();
        // Ready scenes are declared over the scalar; data does not tell.
        file.reading.options.generic = true;
        let emitted = (ready.emitted)().into_iter();
        file.reading.options.emit =
            Some(emitted.map(|kind| Emitted::Kind(kind.to_owned())).collect());
        Ok(file)
    }

    /// Reads `.toml`, `.urdf`, or the text of a `model!` declaration from a file of any other name.
    fn read(path: &Path) -> Result<SceneFile, CommandFailure> {
        SceneFile::of_text(&read_file(path)?, path, SceneFormat::of(path))
    }

    /// What a scene file is made of besides itself: a URDF that it takes in, the scenes that its events let go on; as far as it can be read. Whether all of it can.
    pub fn names(path: &Path) -> (Vec<PathBuf>, bool) {
        let Ok(text) = read_file(path) else {
            return (Vec::new(), false);
        };
        let form = SceneFormat::of(path);
        if form == SceneFormat::Urdf {
            return (Vec::new(), true);
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let reading = form.reading(&split(&text).0, folder);
        let events = reading.skeleton.events.iter();
        let next = events.filter_map(|event| Some(event.actions.next.as_ref()?.file.as_str()));
        let taken = reading.file.iter().map(|file| file.path.as_str());
        let named = taken.chain(next).map(|name| folder.join(name));
        (named.collect(), reading.errors.is_empty())
    }

    /// Reads a text; `path` is the file's name in messages, and what it names lies beside it.
    fn of_text(text: &str, path: &Path, form: SceneFormat) -> Result<SceneFile, CommandFailure> {
        let name = &path.display().to_string();
        let folder = path.parent().unwrap_or(Path::new(""));
        let (scene, run) = match form {
            SceneFormat::Urdf => (text.to_owned(), String::new()),
            SceneFormat::Toml | SceneFormat::Text => split(text),
        };
        let misnamed = match form {
            SceneFormat::Text => misnamed_table(&scene),
            SceneFormat::Toml | SceneFormat::Urdf => None,
        };
        let scene = match &misnamed {
            Some((line, _)) => first_lines(&scene, line - 1),
            None => scene,
        };
        let reading = form.reading(&scene, folder);
        let document = (form == SceneFormat::Toml).then(|| scene.clone());
        let written = (form == SceneFormat::Text).then(|| scene.clone());
        let settings = match misnamed {
            Some((line, text)) => Err(SettingsError {
                line: Some(line),
                text,
            }),
            None => Settings::read(&run),
        };
        let settings = settings.and_then(|settings| {
            let scene = reading.scene.as_ref();
            let checked = scene.map_or(Ok(()), |scene| check_units(scene, &settings));
            checked.map(|()| settings).map_err(|error| SettingsError {
                line: line_of(&run, &error.setting),
                text: error.to_string(),
            })
        });
        let mut errors = reading.errors.clone();
        let scene = reading.scene.as_ref();
        errors.extend(scene.and_then(|scene| immovable(&reading, &Layout::new(scene))));
        match (reading.scene.clone(), settings) {
            (Some(scene), Ok(settings)) if errors.is_empty() => {
                let warnings = told(&reading.warnings, name);
                let mut remarks: Vec<String> = warnings
                    .iter()
                    .map(|text| format!("warning: {text}"))
                    .collect();
                remarks.extend(reading.notes.iter().map(|note| format!("note: {note}")));
                Ok(SceneFile {
                    name: name.to_owned(),
                    source: text.to_owned(),
                    document,
                    text: written,
                    scene,
                    reading,
                    settings,
                    run: run.trim().to_string(),
                    remarks,
                    compiled: None,
                })
            }
            (_, settings) => Err(CommandFailure::Mistakes(Box::new(Mistakes {
                file: name.to_owned(),
                source: text.to_owned(),
                errors,
                settings: settings.err(),
                notes: reading.notes,
            }))),
        }
    }
}

/// The first lines of a text.
fn first_lines(text: &str, count: usize) -> String {
    let lines = text.lines().take(count);
    lines.map(|line| format!("{line}\n")).collect()
}

/// Reads an ordinary file of a sensible size.
pub fn read_file(path: &Path) -> Result<String, CommandFailure> {
    let cannot =
        |why: String| CommandFailure::Usage(format!("cannot read {}: {why}", path.display()));
    let found = std::fs::metadata(path).map_err(|error| cannot(error.to_string()))?;
    // A pipe would keep us waiting for its other end, a device may never end.
    if !found.is_file() {
        return Err(cannot(
            "it is no ordinary file; give the name of a file that holds a scene".into(),
        ));
    }
    let size = found.len();
    if size > LARGEST {
        return Err(cannot(format!("{size} bytes are no scene")));
    }
    let bytes = std::fs::read(path).map_err(|error| cannot(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| {
        let read = error.utf8_error().valid_up_to();
        let before = error.as_bytes().get(..read).unwrap_or_default();
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        cannot(format!(
            "line {line} is no text in UTF-8; save the file as UTF-8"
        ))
    })
}

fn told(messages: &[Message], name: &str) -> Vec<String> {
    messages
        .iter()
        .map(|message| message.in_file(name))
        .collect()
}
