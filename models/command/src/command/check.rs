//! `mbd check`: what a scene file contains.

use std::path::PathBuf;

use clap::Args;
use mbd_compiler::SceneEquations;
use mbd_report::ReportTable;
use mbd_runtime::Layout;
use mbd_runtime::scene::laws::starts;
use mbd_runtime::scene::twelve_digits;
use serde_json::{Value, json};

use super::failure::CommandFailure;
use super::mistakes::listed;
use super::phases::Phases;
use super::scene_file::SceneFile;
use crate::advice::advice;
use crate::describe;

/// What to check, and how to tell it.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// A ready scene (`mbd list`), or a file: `.toml`, `.urdf`, or the text of a `model!` declaration in a file of any other name.
    scene: PathBuf,
    /// Print what it contains, or its mistakes with their places, as JSON.
    #[arg(long)]
    json: bool,
}

/// Reads a scene and tells what is in it.
pub fn check(args: &CheckArgs) -> Result<String, CommandFailure> {
    let read = SceneFile::find(&args.scene).and_then(|file| {
        let phases = Phases::of(file, &args.scene)?;
        let start = phases.check_settings()?;
        let remarks = phases.remarks();
        let first = phases.files.into_iter().next();
        let first = first.map(|mut file| {
            let remarks = remarks.into_iter().chain(start);
            for remark in remarks {
                let note = remark.trim_start_matches("note: ");
                let note = note.trim_start_matches("warning: ");
                file.reading.notes.push(note.to_owned());
                file.remarks.push(remark);
            }
            file
        });
        first.ok_or_else(|| CommandFailure::Usage("no scene was read".into()))
    });
    match read {
        Ok(file) if args.json => pretty(&contents(&file)),
        Ok(file) => Ok(tables(&file)),
        Err(CommandFailure::Mistakes(mistakes)) if args.json => {
            let told = pretty(&json!({ "valid": false, "errors": mistakes.json() }))?;
            Err(CommandFailure::Told(told))
        }
        Err(failure) => Err(failure),
    }
}

fn tables(file: &SceneFile) -> String {
    let mut parts = vec![describe::counts(&file.scene).text()];
    parts.extend(describe::things(&file.scene).iter().map(ReportTable::text));
    parts.push(describe::operations(&SceneEquations::trace(&file.scene)).text());
    let advice = advice(&file.scene, &file.settings);
    let advice = advice.iter().map(|text| format!("advice: {text}"));
    let told = file.remarks.iter().cloned();
    let told: Vec<String> = told.chain(file.windows()).chain(advice).collect();
    if !told.is_empty() {
        parts.push(told.join("\n") + "\n");
    }
    parts.join("\n")
}

/// A value as text of several lines.
pub fn pretty(value: &Value) -> Result<String, CommandFailure> {
    let text = serde_json::to_string_pretty(value);
    text.map(|text| text + "\n")
        .map_err(|error| CommandFailure::Usage(error.to_string()))
}

/// The contents for a program; numbers in the unit beside them.
fn contents(file: &SceneFile) -> Value {
    let (scene, layout) = (&file.scene, Layout::new(&file.scene));
    let params = scene.params.iter().map(|param| {
        let told = |number: f64| twelve_digits(number / param.unit.factor);
        json!({ "name": param.name, "default": told(param.default), "range": param.range.map(|range| range.map(told)), "unit": param.unit.text, "doc": param.doc.trim() })
    });
    let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let states = scene.states.iter().zip(starts(scene, &defaults));
    let states = states.map(|(state, start)| {
        let start = twelve_digits(start / state.unit.factor);
        json!({ "name": state.name, "start": start, "unit": state.unit.text, "doc": state.doc.trim() })
    });
    let inputs = scene.inputs.iter().map(|input| {
        json!({ "name": input.name, "components": input.components, "unit": input.unit.text })
    });
    let outputs = scene.outputs.iter().map(|output| {
        json!({ "name": scene.output_column(output), "components": output.components, "unit": output.unit.text })
    });
    let metrics = scene.runs.metrics.iter();
    let metrics = metrics.map(|metric| describe::metric_json(metric, scene));
    let names = |list: &mut dyn Iterator<Item = &String>| list.cloned().collect::<Vec<String>>();
    json!({
        "valid": true,
        "scene": scene.name,
        "bodies": names(&mut scene.bodies.iter().map(|body| &body.name)),
        "points": names(&mut scene.points.iter().map(|point| &point.name)),
        "joints": names(&mut scene.joints.iter().map(|joint| &joint.name)),
        "lines": names(&mut scene.lines.iter().map(|line| &line.name)),
        "loads": names(&mut scene.loads.iter().map(|load| &load.name)),
        "events": names(&mut scene.events.iter().map(|event| &event.name)),
        "params": params.collect::<Vec<_>>(),
        "inputs": inputs.collect::<Vec<_>>(),
        "states": states.collect::<Vec<_>>(),
        "outputs": outputs.collect::<Vec<_>>(),
        "metrics": metrics.collect::<Vec<_>>(),
        "coordinates": layout.nq,
        "speeds": layout.nv,
        "rows": layout.nc,
        "independent_rows": layout.rank(),
        "freedoms": layout.freedoms_at_start(),
        "freedoms_held": layout.freedoms(),
        "loops": layout.redundancy.loops,
        "repeated_rows": layout.redundancy.sentences(scene),
        "warnings": listed(&file.reading.warnings, &file.name),
        "notes": file.reading.notes,
        "advice": advice(scene, &file.settings),
    })
}
