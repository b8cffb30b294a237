//! An index that stands alone: `point p[4]` declares one point, not four.

use super::say;
use crate::lexeme::LexemeKind;
use crate::resolve::Resolver;

/// Warns about a body, a point, a joint or a line whose index is a number, where there is no other of its name and nothing names it: one was
/// hardly meant. `p[0]` and `p[1]` may be what is left of a repetition.
pub fn check_lone_indices(resolver: &mut Resolver<'_>) {
    for kind in ["body", "point", "joint", "line", "spring"] {
        for instance in resolver.of(kind) {
            let Some(name) = &instance.item.name else {
                continue;
            };
            let Some([only]) = name.index.map(|index| index.lexemes) else {
                continue;
            };
            let count = match &only.kind {
                LexemeKind::Number(text) => text.parse::<i64>().ok(),
                _ => None,
            };
            let word = &name.word.text;
            let entry = resolver.names.get(word).filter(|entry| entry.is_one());
            let named = entry.and_then(|entry| entry.first());
            let alone = named.is_some_and(|named| !resolver.mentioned.contains(&named));
            if let Some(count) = count.filter(|count| *count >= 2 && alone) {
                let at = instance.item.name_at();
                resolver
                    .warnings
                    .push(say::lone_index(at, kind, word, count));
            }
        }
    }
}
