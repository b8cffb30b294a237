//! From a declaration to Rust.

use std::path::Path;

use mbd_scene::{Layout, Quantity, Scene};
use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};

use crate::emit::literal::ident;
use crate::emit::{EmitSettings, NameSpans, emit_model, emit_with, quantity, references};
use crate::equations::{SceneEquations, lay_out, lay_out_factor};
use crate::kernels::Kernels;
use crate::messages::resolve::goes_on_in_rust;
use crate::messages::{About, Location, Message, check as say};
use crate::reading::{Reading, read_tokens};
use crate::resolve::Emitted;

/// More emitted operations than this are a warning.
const MANY: usize = 20_000;
/// More emitted operations than this are an error.
const TOO_MANY: usize = 100_000;

/// What `emit: […]` calls the partial derivatives.
const PARTIAL: &str = "partial";

/// The Rust of a declaration; after errors the errors, and the interface without equations, so that an editor still knows every name.
#[must_use]
pub fn compile(declaration: TokenStream) -> TokenStream {
    emit(&read_tokens(declaration))
}

/// The Rust of what was read.
#[must_use]
pub fn emit(reading: &Reading) -> TokenStream {
    let warnings: TokenStream = reading.warnings.iter().map(warning).collect();
    let model = match &reading.scene {
        Some(scene) => model(reading, scene),
        None => {
            let errors = reading.errors.iter().map(Message::to_compile_error);
            without_equations(reading, errors.collect())
        }
    };
    let file = reading.file.as_ref().filter(|file| file.found);
    let tracked = file.map(|file| tracked(&file.path));
    quote!(#warnings #tracked #model)
}

/// Tells cargo that the model depends on a file: it is named in the code, and so compiled again when the file changes.
fn tracked(path: &str) -> TokenStream {
    let path = match Path::new(path).is_absolute() {
        true => quote!(#path),
        false => quote!(::core::concat!(::core::env!("CARGO_MANIFEST_DIR"), "/", #path)),
    };
    quote!(
        const _: &[u8] = ::core::include_bytes!(#path);
    )
}

/// The Rust of what was read as formatted text, for reading.
///
/// # Errors
/// The message of the parser, should the emitted text not be Rust.
#[cfg(feature = "pretty")]
pub fn expand(reading: &Reading) -> Result<String, String> {
    let tokens = emit(reading);
    let file: syn::File = syn::parse2(tokens).map_err(|error| error.to_string())?;
    Ok(prettyplease::unparse(&file))
}

fn model(reading: &Reading, scene: &Scene) -> TokenStream {
    let layout = lay_out(scene);
    if let Some(message) = immovable(reading, &layout) {
        return without_equations(reading, message.to_compile_error());
    }
    if let Some(message) = goes_on(reading, scene) {
        return without_equations(reading, message.to_compile_error());
    }
    let wanted = wanted(reading, scene, &layout);
    let layout = match wanted.contains(&Quantity::Factor) {
        true => lay_out_factor(scene, layout),
        false => layout,
    };
    // The laws first: differentiating too large a scene would take long before it is refused.
    let laws: Vec<Quantity> = wanted
        .iter()
        .copied()
        .filter(|what| !matches!(what, Quantity::Partial(..)))
        .collect();
    let mut equations = SceneEquations::trace_in(scene, layout.clone(), &laws);
    let mut kernels = Kernels::of(&equations);
    if size(&equations, &kernels) <= TOO_MANY && laws.len() < wanted.len() {
        equations = SceneEquations::trace_in(scene, layout, &wanted);
        kernels = Kernels::of(&equations);
    }
    let large = match judge(size(&equations, &kernels)) {
        Ok(large) => large.map(|text| deprecated(reading.spans.model, &scene.name, &text)),
        Err(text) => return without_equations(reading, error(reading.spans.model, &text)),
    };
    let (spans, settings) = settings(reading);
    let model = emit_with(&equations, &kernels, &spans, &settings);
    let references = references(&equations, &spans, &settings, &reading.spans.references);
    quote!(#large #model #references)
}

/// The interface of a declaration with errors.
fn without_equations(reading: &Reading, errors: TokenStream) -> TokenStream {
    let (spans, settings) = settings(reading);
    if !is_named(&reading.skeleton) {
        return errors;
    }
    let model = emit_model(&SceneEquations::none(&reading.skeleton), &spans, &settings);
    quote!(#errors #model)
}

/// Whether anything was understood that an interface could name.
fn is_named(skeleton: &Scene) -> bool {
    let items = [
        skeleton.consts.len(),
        skeleton.params.len(),
        skeleton.inputs.len(),
        skeleton.states.len(),
        skeleton.bodies.len(),
        skeleton.points.len(),
        skeleton.lines.len(),
        skeleton.outputs.len(),
    ];
    !skeleton.name.is_empty() && items.iter().any(|&count| count > 0)
}

fn settings(reading: &Reading) -> (NameSpans, EmitSettings) {
    let spans = &reading.spans;
    (
        NameSpans {
            model: spans.model,
            params: spans.params.clone(),
            inputs: spans.inputs.clone(),
            loads: spans.loads.clone(),
            outputs: spans.outputs.clone(),
        },
        EmitSettings {
            generic: reading.options.generic,
            verify: reading.options.verify,
            visibility: reading.options.visibility.clone(),
            notes: reading.notes.clone(),
        },
    )
}

/// What to say of a scene whose joints leave nothing to move, or a motor nothing to drive, or a lock nothing to hold, at what is the cause; `None`
/// where something moves, by itself or as prescribed.
#[must_use]
pub fn immovable(reading: &Reading, layout: &Layout) -> Option<Message> {
    let scene = reading.scene.as_ref()?;
    let of = |joint: usize| reading.joints.get(joint).copied();
    let message = |text, at: Option<Location>| Some(Message::new(text, at.unwrap_or(reading.head)));
    let redundancy = &layout.redundancy;
    if let Some((joint, text)) = redundancy.idle_motor(scene) {
        let motor = reading.motors.get(joint).copied();
        return message(say::idle_motor(&text), motor);
    }
    if let Some((lock, text)) = redundancy.idle_lock(scene) {
        return message(say::idle_lock(&text), of(lock));
    }
    let driven = layout.joints.iter().any(|slots| slots.driven);
    let any = layout.nv > 0 || !scene.bodies.is_empty();
    let held = any && layout.nodes.is_empty() && layout.freedoms() == 0;
    // What is held may be let go.
    let lasting = layout.detachable_joints.is_empty();
    if !held || !redundancy.closed || driven || layout.ns > 0 || !lasting {
        return None;
    }
    let across = scene.planar.and_then(|plane| {
        let joint = Layout::holding(scene).into_iter().next()?;
        let (name, coordinate) = scene.coordinate(joint, 0)?;
        let coordinate = format!("{}.{}", name.name, coordinate.name);
        message(
            say::across_the_plane(&scene.name, &coordinate, plane),
            of(joint),
        )
    });
    across.or_else(|| message(say::immovable(&scene.name, layout.nc, layout.nv), None))
}

/// What to say where an event lets a scene file go on: a model is alone in its code.
fn goes_on(reading: &Reading, scene: &Scene) -> Option<Message> {
    let going = reading.going.first()?;
    let event = scene.events.get(going.event)?;
    let file = &event.actions.next.as_ref()?.file;
    let text = goes_on_in_rust(&event.name, file);
    Some(Message::new(text, going.file))
}

/// The quantities to emit: all, or what a simulation needs and those that `emit: […]` names, by kind or by function.
fn wanted(reading: &Reading, scene: &Scene, layout: &Layout) -> Vec<Quantity> {
    let mut all = layout.quantities();
    let Some(names) = &reading.options.emit else {
        return all;
    };
    let needed = |what: Quantity| {
        matches!(
            what,
            Quantity::AnchorStates
                | Quantity::Equilibrium(_)
                | Quantity::Derivative
                | Quantity::Rates
                | Quantity::Balance
                | Quantity::Guards
                | Quantity::Coordinates
                | Quantity::CountedAngles
                | Quantity::Constraint
                | Quantity::ConstraintRate
                | Quantity::ProjectionStep
        )
    };
    let asked = |what: Quantity| {
        let known = [quantity::kind(what), &quantity::name(scene, layout, what)];
        names.iter().any(|emitted| match emitted {
            Emitted::Kind(name) => known.contains(&name.as_str()),
            Emitted::FrameJacobian(body, frame) => what == Quantity::FrameJacobian(*body, *frame),
        })
    };
    all.extend(
        layout
            .on_request(scene)
            .into_iter()
            .filter(|&what| asked(what)),
    );
    // Derivatives through the rows of joints: only on request, and all of them.
    let partial = |emitted: &Emitted| matches!(emitted, Emitted::Kind(name) if name == PARTIAL);
    let through_rows = match names.iter().any(partial) {
        true => layout.derivatives(),
        false => Vec::new(),
    };
    // Of a scene without inputs nobody needs them unasked.
    let coordinates = Quantity::Coordinates;
    if !all.contains(&coordinates) && layout.len(coordinates) > 0 && asked(coordinates) {
        all.push(coordinates);
    }
    all.into_iter()
        .filter(|&what| needed(what) || asked(what))
        .chain(through_rows)
        .collect()
}

/// A warning about a large model, or the refusal of one too large to compile.
fn judge(size: usize) -> Result<Option<String>, String> {
    let advice = "emit less, for example `emit: [outputs];` at the top of the model";
    if size > TOO_MANY {
        return Err(format!(
            "this model takes {size} operations, more than {TOO_MANY}: {advice}, or run the scene with `Generic`"
        ));
    }
    let slow = || format!("this model takes {size} operations and will compile slowly: {advice}");
    Ok((size > MANY).then(slow))
}

/// Operations as emitted: kernels that blocks share count once.
fn size(equations: &SceneEquations, kernels: &Kernels) -> usize {
    kernels.lengths(equations).iter().sum()
}

fn error(span: Span, text: &str) -> TokenStream {
    quote_spanned!(span=> ::core::compile_error! { #text })
}

/// A warning at the first place of a message.
fn warning(message: &Message) -> TokenStream {
    let span = match message.places.first().map(|place| place.location) {
        Some(Location::Tokens(first, _)) => first,
        _ => Span::call_site(),
    };
    match &message.about {
        Some(About {
            name,
            unused: Some(kind),
        }) => unused(span, kind, name),
        Some(About { name, unused: None }) => deprecated(span, name, &message.text),
        None => deprecated(span, "this", &message.text),
    }
}

/// Something of Rust under the same name that nothing uses either, so that rustc says so: "constant `L` is never used", "field `k` is never
/// read", "function `drag` is never used", "unused variable: `speed`". It stands where the name does: of what only a macro wrote, rustc says nothing.
fn unused(span: Span, kind: &str, name: &str) -> TokenStream {
    let name = ident(name, span);
    let item = match kind {
        "const" => quote_spanned!(span=> const #name: () = ();),
        "table" => quote_spanned!(span=> fn #name() {}),
        "let" => quote_spanned!(span=> let #name = ();),
        _ => quote_spanned! {span=>
            struct Declaration { #name: () }
            let _ = Declaration { #name: () };
        },
    };
    quote! {
        #[allow(non_snake_case, non_upper_case_globals)]
        const _: () = { #item };
    }
}

/// Stable Rust has no warnings for macros; the use of something deprecated is one. Its name begins the sentence of rustc: "use of deprecated
/// constant `knot`: point `knot` is …".
fn deprecated(span: Span, name: &str, text: &str) -> TokenStream {
    let (name, used) = (ident(name, Span::call_site()), ident(name, span));
    quote! {
        #[allow(non_upper_case_globals)]
        const _: () = {
            #[deprecated(note = #text)]
            const #name: () = ();
            let () = #used;
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_models_are_warned_about_and_too_large_ones_refused_with_advice() {
        assert_eq!(judge(MANY), Ok(None));
        assert!(judge(MANY + 1).is_ok_and(|text| text.is_some_and(|t| t.contains("emit less"))));
        assert!(judge(TOO_MANY).is_ok());
        assert!(judge(TOO_MANY + 1).is_err_and(|text| text.contains("emit less")));
    }
}
