//! The scene files that a run may come to: the one that begins, and those that its events let go on.

use std::path::{Path, PathBuf};

use mbd_campaign::phases::shared_metrics;
use mbd_campaign::run::{GivenSettings, Phase, RunPlan, settings_of_all};
use mbd_compiler::{Location, Message, misfits};
use mbd_runtime::scene::Scene;

use super::campaign::nominal;
use super::failure::CommandFailure;
use super::mistakes::Mistakes;
use super::scene_file::SceneFile;
use crate::run::{PlanError, Settings};

/// More files than this are no run.
pub const MOST: usize = 64;

/// Scene files, the one that begins first.
#[derive(Debug)]
pub struct Phases {
    /// The files.
    pub files: Vec<SceneFile>,
    /// Per file and event of its scene the file that goes on, by index.
    pub next: Vec<Vec<Option<usize>>>,
}

impl Phases {
    /// Reads what the events of a scene let go on, and what these do; each file once, so that scenes may lead back to each other.
    ///
    /// # Errors
    /// A file that cannot be read or does not fit, at the place that names it; mistakes in it, at theirs.
    pub fn of(first: SceneFile, path: &Path) -> Result<Self, CommandFailure> {
        let mut paths = vec![path.canonicalize().unwrap_or_else(|_| path.to_owned())];
        let mut names = vec![path.to_owned()];
        let mut phases = Phases {
            files: vec![first],
            next: Vec::new(),
        };
        while let Some(file) = phases.files.get(phases.next.len()) {
            let folder = names[phases.next.len()].parent().map(Path::to_owned);
            let folder = folder.unwrap_or_default();
            let mut next = vec![None; file.scene.events.len()];
            let mut found = Vec::new();
            for going in &file.reading.going {
                let event = file.scene.events.get(going.event);
                let Some(declared) = event.and_then(|event| event.actions.next.as_ref()) else {
                    continue;
                };
                let name = folder.join(&declared.file);
                let whole = name.canonicalize();
                let whole =
                    whole.map_err(|error| unread(file, going.file, &name, &error.to_string()))?;
                let known = paths.iter().position(|path| *path == whole);
                if known.is_none() && paths.len() == MOST {
                    let why = format!("a run comes to at most {MOST} scenes");
                    return Err(unread(file, going.file, &name, &why));
                }
                next[going.event] = Some(known.unwrap_or(paths.len()));
                if known.is_none() {
                    let read = SceneFile::find(&name).map_err(|failure| match failure {
                        CommandFailure::Usage(why) => unread(file, going.file, &name, &why),
                        failure => failure,
                    })?;
                    paths.push(whole);
                    names.push(name);
                    found.push(read);
                }
            }
            phases.files.extend(found);
            phases.next.push(next);
        }
        phases.fit()?;
        Ok(phases)
    }

    /// Whether a run stays in its first scene.
    pub fn is_one(&self) -> bool {
        self.files.len() == 1 && self.next.iter().flatten().all(Option::is_none)
    }

    /// Refuses scenes that cannot go on from each other.
    fn fit(&self) -> Result<(), CommandFailure> {
        for (file, next) in self.files.iter().zip(&self.next) {
            let going = file.reading.going.iter().enumerate();
            let errors: Vec<Message> = going
                .flat_map(|(place, going)| {
                    let next = next.get(going.event).copied().flatten();
                    let next = next.and_then(|next| self.files.get(next));
                    next.map_or(Vec::new(), |next| {
                        misfits(&file.reading, place, &next.scene, &placed(&next.settings))
                    })
                })
                .collect();
            if !errors.is_empty() {
                return Err(mistakes(file, errors));
            }
        }
        Ok(())
    }

    /// How each is run, where the first has these settings, with what was given in them.
    ///
    /// # Errors
    /// Settings that a scene cannot be run with.
    pub fn planned(
        &self,
        first: &Settings,
        given: &GivenSettings,
    ) -> Result<Vec<RunPlan>, CommandFailure> {
        let settings = self.settings(first, given);
        let planned = self.files.iter().zip(&settings).map(|(file, settings)| {
            let plan = RunPlan::new(&file.scene, settings);
            plan.map_err(|error: PlanError| file.misset(&error))
        });
        planned.collect()
    }

    /// The settings of each, where the first has these.
    fn settings(&self, first: &Settings, given: &GivenSettings) -> Vec<Settings> {
        let files = self.files.iter();
        let own: Vec<_> = files.map(|file| (&file.scene, &file.settings)).collect();
        settings_of_all(first, given, &own)
    }

    /// Tells what stands in the settings of any of the files and cannot be used. What a run will say of its start, where it is not as it was asked to be.
    ///
    /// # Errors
    /// The first such setting.
    pub fn check_settings(&self) -> Result<Option<String>, CommandFailure> {
        let Some(first) = self.files.first() else {
            return Ok(None);
        };
        let settings = self.settings(&first.settings, &GivenSettings::default());
        let files = self.files.iter().zip(&settings).enumerate();
        let checked =
            files.map(|(place, (file, settings))| file.check_settings(settings, place == 0));
        let warnings = checked.collect::<Result<Vec<_>, _>>()?;
        Ok(warnings.into_iter().flatten().next())
    }

    /// One sentence a param that was given by `--set` and that the map of an event decides.
    ///
    /// # Errors
    /// Such a param that nothing but maps reaches: what was given does nothing.
    pub fn decided(&self, given: &[String]) -> Result<Vec<String>, CommandFailure> {
        let has = |file: &SceneFile, name: &str| {
            let mut params = file.scene.params.iter();
            params.any(|param| param.name == name)
        };
        let mut told = Vec::new();
        for name in given {
            let mut reached = self.files.first().is_some_and(|first| has(first, name));
            let mut decided = Vec::new();
            for (file, next) in self.files.iter().zip(&self.next) {
                for (event, next) in file.scene.events.iter().zip(next) {
                    let next = next.and_then(|next| self.files.get(next));
                    let Some(next) = next.filter(|next| has(next, name)) else {
                        continue;
                    };
                    let declared = event.actions.next.iter();
                    let mut map = declared.flat_map(|declared| &declared.map);
                    if map.any(|mapped| mapped.name == *name) {
                        decided.push(format!(
                            "`--set {name}` does not count in `{}`: the `map` of the event `{}` of `{}` decides it",
                            next.scene.name, event.name, file.scene.name
                        ));
                    } else {
                        reached = true;
                    }
                }
            }
            if !reached && let Some(first) = decided.first() {
                return Err(CommandFailure::Usage(format!(
                    "{first}; change it there, or leave it out of the `map`"
                )));
            }
            told.extend(decided.iter().map(|text| format!("warning: {text}")));
        }
        Ok(told)
    }

    /// They for many runs: the one that begins, and those that go on.
    ///
    /// # Errors
    /// A scene that cannot be run as it is declared.
    pub fn of_many(&self) -> Result<(Phase, Vec<Phase>), CommandFailure> {
        let mut all = Vec::with_capacity(self.files.len());
        for (file, next) in self.files.iter().zip(&self.next) {
            all.push(Phase {
                model: nominal(file)?,
                settings: file.settings.clone(),
                next: next.clone(),
            });
        }
        let mut all = all.into_iter();
        match all.next() {
            Some(first) => Ok((first, all.collect())),
            None => Err(CommandFailure::Usage("there is no scene to run".to_owned())),
        }
    }

    /// What is said of them: which scene goes on from which, and where.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        for (file, next) in self.files.iter().zip(&self.next) {
            for (event, next) in file.scene.events.iter().zip(next) {
                let Some(other) = next.and_then(|next| self.files.get(next)) else {
                    continue;
                };
                let names = |file: &SceneFile| -> Vec<String> {
                    let bodies = file.scene.bodies.iter().map(|body| body.name.clone());
                    let points = file.scene.points.iter().map(|point| point.name.clone());
                    bodies.chain(points).collect()
                };
                let (olds, news) = (names(file), names(other));
                let only = |some: &[String], others: &[String]| -> String {
                    let own = some.iter().filter(|name| !others.contains(name));
                    let own: Vec<String> = own.map(|name| format!("`{name}`")).collect();
                    own.join(", ")
                };
                let mut remark = format!(
                    "note: {}: at `{}` the scene `{}` goes on ({})",
                    file.scene.name, event.name, other.scene.name, other.name
                );
                for (what, list) in [
                    ("without", only(&olds, &news)),
                    ("with the new", only(&news, &olds)),
                ] {
                    if !list.is_empty() {
                        remark += &format!(", {what} {list}");
                    }
                }
                remarks.push(remark);
            }
        }
        remarks.extend(self.metrics_of_one_name());
        remarks
    }

    /// One sentence a name that scenes declare several metrics by.
    fn metrics_of_one_name(&self) -> Vec<String> {
        let scenes: Vec<&Scene> = self.files.iter().map(|file| &file.scene).collect();
        let all = shared_metrics(&scenes);
        let told = all.iter().enumerate().filter_map(|(at, own)| {
            let name = &own.metric.name;
            let other = all[..at].iter().find(|other| other.metric.name == *name)?;
            let number = own.scenes.first()? + 1;
            Some(format!(
                "note: the metric `{name}` is `{}` in `{}` and `{}` in `{}`: `mbd run` tells the second as `{name} ({number})`, and a campaign takes one of a name: give one of them another",
                other.text(), other.scene.name, own.text(), own.scene.name
            ))
        });
        told.collect()
    }
}

/// The bodies and points that settings place.
fn placed(settings: &Settings) -> Vec<String> {
    settings.start.keys().cloned().collect()
}

fn unread(file: &SceneFile, at: Location, name: &Path, why: &str) -> CommandFailure {
    let why = why.trim_start_matches("cannot read ");
    let name: PathBuf = name.to_owned();
    let text = format!(
        "the scene that goes on cannot be read: {}: {why}; its file is named relative to this one",
        name.display()
    );
    mistakes(file, vec![Message::new(text, at)])
}

fn mistakes(file: &SceneFile, errors: Vec<Message>) -> CommandFailure {
    CommandFailure::Mistakes(Box::new(Mistakes {
        file: file.name.clone(),
        source: file.source.clone(),
        errors,
        settings: None,
        notes: Vec::new(),
    }))
}
