//! Bodies, points and declared states of a state by their names.

use std::collections::HashSet;

use mbd_scene::{PointSlots, Slots};
use proc_macro2::{Span, TokenStream};
use quote::quote;

use super::context::{EmitContext, docs, unit_text};
use super::literal::{ident, whole};

/// Functions that every state has.
const TAKEN: [&str; 3] = ["at_origin", "from_slice", "to_vec"];

/// Things of one kind that share a name: one, or those of a repetition.
struct RepeatedPart<'a> {
    name: &'a str,
    /// The first index and how many there are; `None` for one that is not repeated.
    members: Option<[usize; 2]>,
    /// A declared state has its place in s as a coordinate, and no speed.
    slots: Slots,
    of: Of,
}

/// For every body, every point with mass and every declared state, a function that reads it and one that puts it somewhere. One whose name is
/// taken has none.
pub fn parts(context: &EmitContext) -> TokenStream {
    let mut taken: HashSet<String> = TAKEN.iter().map(ToString::to_string).collect();
    let mut functions = TokenStream::new();
    for family in families(context) {
        // `r#type` is refused as a name; the skeleton of its model is Rust all the same.
        let setter = format!("set_{}", family.name.trim_start_matches("r#"));
        let free = !taken.contains(family.name) && !taken.contains(&setter);
        if free {
            functions.extend(accessors(context, &family, &setter));
            taken.extend([family.name.to_owned(), setter]);
        }
    }
    functions
}

/// What a family is made of.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Of {
    Body,
    Point,
    State,
    /// A joint of the tree, with the number of its coordinates and of its speeds.
    Joint([usize; 2]),
}

fn families<'a>(context: &'a EmitContext<'_>) -> Vec<RepeatedPart<'a>> {
    let (scene, layout) = (context.scene(), &context.equations.layout);
    let bodies = layout.own_bodies();
    let bodies = bodies.map(|(body, slots)| (scene.bodies[body].name.as_str(), (slots, Of::Body)));
    let joints = layout
        .joint_links()
        .filter(|(_, link)| link.coordinates > 0);
    let joints = joints.map(|(joint, link)| {
        let size = [link.coordinates, link.speeds];
        (
            scene.joints[joint].name.as_str(),
            (link.slots, Of::Joint(size)),
        )
    });
    let points = scene.points.iter().map(|point| point.name.as_str());
    let points = points.zip(&layout.points);
    let points = points.filter_map(|(name, slots)| match slots {
        PointSlots::Mass(slots) => Some((name, (*slots, Of::Point))),
        PointSlots::Node(_) => None,
    });
    let states = scene.states.iter().enumerate();
    let states = states.map(|(q, state)| (state.name.as_str(), (Slots { q, v: 0 }, Of::State)));
    let mut all: Vec<RepeatedPart<'a>> = Vec::new();
    for (name, (slots, of)) in bodies.chain(joints).chain(points).chain(states) {
        let Some((family, index)) = name.split_once('[') else {
            all.push(RepeatedPart {
                name,
                members: None,
                slots,
                of,
            });
            continue;
        };
        match (all.last_mut(), index.trim_end_matches(']').parse()) {
            (
                Some(RepeatedPart {
                    name,
                    members: Some([_, count]),
                    ..
                }),
                _,
            ) if *name == family => *count += 1,
            (_, Ok(first)) => all.push(RepeatedPart {
                name: family,
                members: Some([first, 1]),
                slots,
                of,
            }),
            // Counted from below zero: no index of Rust.
            (_, Err(_)) => {}
        }
    }
    all
}

fn accessors(context: &EmitContext, family: &RepeatedPart<'_>, setter: &str) -> TokenStream {
    if family.of == Of::State {
        return own_state(context, family, setter);
    }
    let t = context.scalar();
    let [getter, setter] = [family.name, setter].map(|name| ident(name, Span::call_site()));
    let directions = context.equations.layout.directions;
    let moves = directions.translations().len();
    let (part, size) = match (family.of, directions.plane) {
        (Of::Joint(size), _) => {
            let [q, u] = size.map(whole);
            (quote!(::mbd_runtime::JointState<#q, #u, #t>), size)
        }
        (Of::Body, plane) => {
            let part = match plane {
                None => quote!(::mbd_runtime::BodyState<#t>),
                Some(_) => quote!(::mbd_runtime::PlanarBodyState<#t>),
            };
            (part, [directions.coordinates(), directions.speeds()])
        }
        (_, None) => (quote!(::mbd_runtime::PointState<#t>), [moves, moves]),
        (_, Some(_)) => (quote!(::mbd_runtime::PointState<#t, 2>), [moves, moves]),
    };
    let size = size.map(whole);
    let at = [family.slots.q, family.slots.v].map(whole);
    let name = family.name;
    match family.members {
        None => {
            let read = docs(&format!("Where `{name}` is and how it moves."));
            let write = docs(&format!("Puts `{name}` somewhere."));
            quote! {
                #read
                #[must_use]
                pub fn #getter(&self) -> #part {
                    ::mbd_runtime::__private::read(self.q.as_slice(), self.v.as_slice(), [#(#at),*])
                }
                #write
                pub fn #setter(&mut self, to: #part) {
                    ::mbd_runtime::__private::write(to, self.q.as_mut_slice(), self.v.as_mut_slice(), [#(#at),*]);
                }
            }
        }
        Some(members) => {
            let [first, count] = members;
            let last = first + count - 1;
            let read = docs(&format!(
                "Where `{name}[index]` is and how it moves; `None` where there is none: {first} to {last}."
            ));
            let write = docs(&format!(
                "Puts `{name}[index]` somewhere; `None` where there is none."
            ));
            let members = members.map(whole);
            let find = quote!(::mbd_runtime::__private::member(index, [#(#members),*], [#(#at),*], [#(#size),*])?);
            quote! {
                #read
                #[must_use]
                pub fn #getter(&self, index: usize) -> ::core::option::Option<#part> {
                    let at = #find;
                    ::core::option::Option::Some(::mbd_runtime::__private::read(self.q.as_slice(), self.v.as_slice(), at))
                }
                #write
                #[must_use]
                pub fn #setter(&mut self, index: usize, to: #part) -> ::core::option::Option<()> {
                    let at = #find;
                    ::mbd_runtime::__private::write(to, self.q.as_mut_slice(), self.v.as_mut_slice(), at);
                    ::core::option::Option::Some(())
                }
            }
        }
    }
}

/// Reads and sets a declared state.
fn own_state(context: &EmitContext, family: &RepeatedPart<'_>, setter: &str) -> TokenStream {
    let t = context.scalar();
    let [getter, setter] = [family.name, setter].map(|name| ident(name, Span::call_site()));
    let (name, at) = (family.name, family.slots.q);
    let declared = context.scene().states.get(at);
    let unit = declared.map_or("1", |state| unit_text(&state.unit.text));
    let doc = declared.map_or("", |state| state.doc.trim());
    match family.members {
        None => {
            let at = whole(at);
            let read = docs(format!("{doc} `{name}` \\[{unit}\\].").trim());
            let write = docs(&format!("Sets `{name}` \\[{unit}\\]."));
            quote! {
                #read
                #[must_use]
                pub fn #getter(&self) -> #t {
                    let [s] = &self.s.data.0;
                    s[#at]
                }
                #write
                pub fn #setter(&mut self, to: #t) {
                    let [s] = &mut self.s.data.0;
                    s[#at] = to;
                }
            }
        }
        Some([first, count]) => {
            let last = first + count - 1;
            let read = docs(
                format!(
                    "{doc} `{name}[index]` \\[{unit}\\]; `None` where there is none: {first} to {last}."
                )
                .trim(),
            );
            let write = docs(&format!(
                "Sets `{name}[index]` \\[{unit}\\]; `None` where there is none."
            ));
            let members = [first, count].map(whole);
            let at = whole(at);
            let find =
                quote!(::mbd_runtime::__private::member(index, [#(#members),*], [#at, 0], [1, 0])?);
            quote! {
                #read
                #[must_use]
                pub fn #getter(&self, index: usize) -> ::core::option::Option<#t> {
                    let [at, _] = #find;
                    self.s.as_slice().get(at).copied()
                }
                #write
                #[must_use]
                pub fn #setter(&mut self, index: usize, to: #t) -> ::core::option::Option<()> {
                    let [at, _] = #find;
                    *self.s.as_mut_slice().get_mut(at)? = to;
                    ::core::option::Option::Some(())
                }
            }
        }
    }
}
