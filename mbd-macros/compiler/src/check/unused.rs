//! Names that are declared and never used: warnings.

use std::collections::BTreeSet;

use crate::lexeme::LexemeKind;
use crate::messages::check as say;
use crate::resolve::{Named, Resolver};
use crate::syntax::{Item, ModelSyntax};

/// Warns about consts, params, inputs, tables, lets and frames that nothing uses; of a repetition one use is enough, and what an empty one would
/// use with more members counts. A name that begins with `_` is meant to be unused, what a file declares
/// that is taken in is another's. After an error the use may be what was not understood.
pub fn check_used(resolver: &mut Resolver<'_>, model: &ModelSyntax<'_>) {
    if !resolver.whole || !resolver.messages.is_empty() {
        return;
    }
    let used: BTreeSet<String> = resolver
        .mentioned
        .iter()
        .filter_map(|&named| name(resolver, named))
        .map(|name| without_indices(&name))
        .collect();
    let mut idle = BTreeSet::new();
    resolver.idle.iter().for_each(|item| words(item, &mut idle));
    for (&named, &at) in &resolver.declared {
        let Some(name) = name(resolver, named) else {
            continue;
        };
        if model.taken.is_some_and(|first| at.first >= first) {
            continue;
        }
        let plain = without_indices(&name);
        let meant = plain
            .rsplit('.')
            .next()
            .unwrap_or_default()
            .starts_with('_');
        if meant
            || used.contains(&plain)
            || idle.contains(plain.rsplit('.').next().unwrap_or_default())
        {
            continue;
        }
        let kind = match named {
            Named::Param(_) => "parameter",
            other => other.kind(),
        };
        resolver.warnings.push(say::unused(at, kind, &name));
    }
}

/// The words in the values of an item.
fn words<'a>(item: &Item<'a>, found: &mut BTreeSet<&'a str>) {
    let values = item.clauses.iter().map(|given| given.value);
    let index = item.name.as_ref().and_then(|name| name.index);
    for lexeme in values.chain(index).flat_map(|value| value.lexemes) {
        if let LexemeKind::Word(word) = &lexeme.kind {
            found.insert(word);
        }
    }
    item.block.iter().for_each(|field| words(field, found));
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
        Named::Let(i) => scene.lets.get(i).map(|named| named.name.clone()),
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
