//! Names that are declared and never used: warnings.

use std::collections::BTreeSet;

use crate::messages::check as say;
use crate::resolve::{Named, Resolver};

/// Warns about consts, params, inputs, tables and frames that nothing uses; of a repetition one use is enough. After an error the use may be
/// what was not understood.
pub fn check_used(resolver: &mut Resolver<'_>) {
    if !resolver.whole || !resolver.messages.is_empty() {
        return;
    }
    let used: BTreeSet<String> = resolver
        .mentioned
        .iter()
        .filter_map(|&named| name(resolver, named))
        .map(|name| without_indices(&name))
        .collect();
    for (&named, &at) in &resolver.declared {
        let Some(name) = name(resolver, named) else {
            continue;
        };
        if used.contains(&without_indices(&name)) {
            continue;
        }
        let kind = match named {
            Named::Param(_) => "parameter",
            other => other.kind(),
        };
        resolver.warnings.push(say::unused(at, kind, &name));
    }
}

/// `bar[2].hole[0]` → `bar.hole`.
fn without_indices(name: &str) -> String {
    let mut inside = false;
    name.chars()
        .filter(|&c| {
            let keep = !inside && c != '[';
            inside = (inside || c == '[') && c != ']';
            keep
        })
        .collect()
}

/// The name of a thing that should be used.
fn name(resolver: &Resolver<'_>, named: Named) -> Option<String> {
    let scene = &resolver.scene;
    match named {
        Named::Const(i) => scene.consts.get(i).map(|c| c.name.clone()),
        Named::Param(i) => scene.params.get(i).map(|p| p.name.clone()),
        Named::Input(i) => scene.inputs.get(i).map(|input| input.name.clone()),
        Named::Table(i) => scene.tables.get(i).map(|table| table.name.clone()),
        Named::WorldFrame(i) => scene
            .world_frames
            .get(i)
            .map(|f| format!("world.{}", f.name)),
        Named::Frame(b, f) => {
            let body = scene.bodies.get(b)?;
            Some(format!("{}.{}", body.name, body.frames.get(f)?.name))
        }
        _ => None,
    }
}
