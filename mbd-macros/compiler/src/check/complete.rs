//! Nothing that is declared disappears: the guard behind every stage that may drop an item it could not read.

use std::collections::BTreeSet;
use std::ptr;

use crate::messages::check as say;
use crate::resolve::Resolver;
use crate::syntax::{Item, ModelSyntax, words};

/// Refuses a model of which an item with a name, or a frame, is in no list of the scene and no message says why.
pub fn check_complete(resolver: &mut Resolver<'_>, model: &ModelSyntax<'_>) {
    if !resolver.messages.is_empty() {
        return;
    }
    let instances = resolver.instances.values().flatten();
    let resolved: BTreeSet<*const Item<'_>> = instances
        .map(|instance| instance.item)
        .chain(resolver.idle.iter().copied())
        .map(ptr::from_ref)
        .collect();
    let lists = [(&model.items, false)]
        .into_iter()
        .chain(model.items.iter().map(|item| (&item.block, true)));
    for (items, inside) in lists {
        for item in items {
            let spec = words::find(&item.word.text, inside).filter(|spec| spec.named);
            if let (Some(spec), false) = (spec, resolved.contains(&ptr::from_ref(item))) {
                resolver.messages.push(say::lost(item.name_at(), spec));
                resolver.whole = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lexeme::from_text;
    use crate::messages::Messages;
    use crate::resolve::resolve;
    use crate::syntax;

    #[test]
    fn an_item_that_reached_no_list_is_an_error_at_its_place() {
        let text = "model Bob { gravity: none; world { frame hook at [0, 0, 1] m }
            body bob { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame top at [0, 0, 1] m }
            joint hang: hinge from world.hook to bob.top { axis: y } }";
        let (lexemes, places, mut messages) = from_text(text);
        let model = syntax::model(&lexemes, &mut messages).unwrap_or_default();
        let lost = |kind: &str| -> Vec<String> {
            let mut resolver = resolve(&model, true, None);
            resolver.instances.remove(kind);
            check_complete(&mut resolver, &model);
            let messages = std::mem::take::<Messages>(&mut resolver.messages);
            let located = messages.located(&places);
            located.iter().map(ToString::to_string).collect()
        };
        assert_eq!(lost(""), Vec::<String>::new());
        assert_eq!(
            lost("joint"),
            [
                "3:19: this `joint` was not understood and would be left out; the form is `joint NAME: hinge from world to body.frame { axis: y }`"
            ]
        );
        assert!(lost("frame")[0].starts_with("2:73: this `frame` was not understood"));
        assert!(lost("world frame")[0].starts_with("1:42: this `frame` was not understood"));
    }
}
