//! Names that are declared and never used: warnings.

use crate::messages::check as say;
use crate::resolve::{Named, Resolver};

/// Warns about consts, params, inputs, tables and frames that nothing uses. After an error the use may be what was not understood.
pub fn check_used(resolver: &mut Resolver<'_>) {
    if !resolver.whole || !resolver.messages.is_empty() {
        return;
    }
    for (&named, &at) in &resolver.declared {
        if resolver.mentioned.contains(&named) {
            continue;
        }
        let Some(name) = name(resolver, named) else {
            continue;
        };
        let kind = match named {
            Named::Param(_) => "parameter",
            other => other.kind(),
        };
        resolver.warnings.push(say::unused(at, kind, &name));
    }
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
