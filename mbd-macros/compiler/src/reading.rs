//! Reading a declaration: from tokens, from text, from TOML, to a [`Scene`] or to messages.

use std::path::Path;

use mbd_scene::{Coordinates, Plane, Scene};
use proc_macro2::{Span, TokenStream};

use crate::attitude::WithPoints;
use crate::check::{check, without_inertia};
use crate::families::Families;
use crate::lexeme::{self, Lexeme, LexemeIndex, LexemeKind, Places, Region};
use crate::messages::check::{as_points, in_no_plane, in_plane};
use crate::messages::{Location, Message, Messages, syntax as say};
use crate::plane::plane_of_motion;
use crate::resolve::{Emitted, Named, Resolver, resolve};
use crate::syntax::{self, Item, ModelSyntax};
use crate::urdf;

/// What reading a declaration gives.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The scene; `None` after errors.
    pub scene: Option<Scene>,
    /// The scene as far as it was understood, always well-formed: names for the interface that is emitted in spite of errors.
    pub skeleton: Scene,
    /// What is wrong, in the order of the source.
    pub errors: Vec<Message>,
    /// What is probably not meant.
    pub warnings: Vec<Message>,
    /// Choices that were made.
    pub notes: Vec<String>,
    /// Items that are declared as bodies and read as points with mass.
    pub as_points: Vec<String>,
    /// Where the names are.
    pub spans: Spans,
    /// Where the model's name is, for a message.
    pub head: Location,
    /// Where the names of the joints are, for a message.
    pub joints: Vec<Location>,
    /// Where the motors of the joints are, for a message: per joint its first one, or its name where it has none.
    pub motors: Vec<Location>,
    /// Where events name scenes that go on, for a message.
    pub going: Vec<NextScene>,
    /// What is asked for besides the scene.
    pub options: DeclarationOptions,
    /// The file that it takes in.
    pub file: Option<NamedFile>,
}

/// A file that a declaration takes in.
#[derive(Clone, Debug)]
pub struct NamedFile {
    /// Its path as it is named.
    pub path: String,
    /// Whether it could be read.
    pub found: bool,
}

/// Where an event names a scene that goes on.
#[derive(Clone, Debug)]
pub struct NextScene {
    /// The event, by index.
    pub event: usize,
    /// Where the file stands.
    pub file: Location,
    /// Per entry of the map where its name stands, and its value.
    pub map: Vec<[Location; 2]>,
}

/// What a declaration asks for besides the scene.
#[derive(Clone, Debug, Default)]
pub struct DeclarationOptions {
    /// `verify;`: emit checks of this model.
    pub verify: bool,
    /// `emit: […]`: only these quantities.
    pub emit: Option<Vec<Emitted>>,
    /// `<T>` is written: generic over the scalar.
    pub generic: bool,
    /// `pub`, `pub(crate)` or nothing.
    pub visibility: TokenStream,
}

/// The spans of the names of a declaration; the call site where the source is a text.
#[derive(Clone, Debug)]
pub struct Spans {
    /// The model's name.
    pub model: Span,
    /// Per param.
    pub params: Vec<Span>,
    /// Per input.
    pub inputs: Vec<Span>,
    /// Per load.
    pub loads: Vec<Span>,
    /// Per output.
    pub outputs: Vec<Span>,
    /// Where a name is used: what it refers to, and the span of the use.
    pub references: Vec<(Named, Span)>,
}

/// Reads the tokens of `model! { … }`. A file that it names lies relative to the folder of the manifest that is being built.
#[must_use]
pub fn read_tokens(tokens: TokenStream) -> Reading {
    let folder = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default();
    let (lexemes, places, messages) = lexeme::from_tokens(tokens);
    read(&lexemes, places, messages, Path::new(&folder))
}

/// Reads the same language from a text. A file that it names lies relative to the working directory.
#[must_use]
pub fn read_text(text: &str) -> Reading {
    read_text_in(text, Path::new(""))
}

/// Reads the same language from a text. A file that it names lies relative to `folder`.
#[must_use]
pub fn read_text_in(text: &str, folder: &Path) -> Reading {
    let (lexemes, places, messages) = lexeme::from_text(text);
    read(&lexemes, places, messages, folder)
}

/// Reads lexemes. What could not be lexed is told alone: everything after it may be its consequence.
fn read(lexemes: &[Lexeme], places: Places, mut messages: Messages, folder: &Path) -> Reading {
    let lexed = messages.is_empty();
    let mut syntax = Messages::default();
    let model = syntax::model(lexemes, &mut syntax);
    if syntax::begins_with_item(lexemes) {
        // The brace that closes the model has no partner either.
        messages = Messages::default();
        messages.push(say::no_model(Region::START));
    } else if lexed {
        messages = syntax;
        if model.is_none() {
            messages.push(say::no_model(Region::START));
        }
    }
    complete(model.unwrap_or_default(), places, messages, lexed, folder)
}

/// Takes in the file that a model names, and finishes it.
pub(crate) fn complete(
    mut model: ModelSyntax<'_>,
    mut places: Places,
    mut messages: Messages,
    lexed: bool,
    folder: &Path,
) -> Reading {
    let named = model.items.iter().any(|item| item.word.text == "urdf");
    let file = match lexed {
        true => urdf::take(&model, folder, &mut places, &mut messages),
        false => None,
    };
    let Some(file) = file else {
        if !named {
            urdf::nothing_to_extend(&mut model, &mut messages);
        }
        // Without the file that it names, a declaration is not to be blamed.
        return finish(&model, &places, messages, lexed && !named);
    };
    let model = file.joined(model, &mut messages);
    let mut reading = finish(&model, &places, messages, file.whole);
    reading.notes.extend(file.notes.iter().cloned());
    reading.file = Some(NamedFile {
        path: file.path,
        found: file.found,
    });
    reading
}

/// Resolves and checks a model and gathers what came of it.
pub(crate) fn finish(
    model: &ModelSyntax<'_>,
    places: &Places,
    messages: Messages,
    lexed: bool,
) -> Reading {
    let whole = messages.is_empty();
    let mut resolver = resolved(model, whole, None);
    if whole && resolver.asked.plane && resolver.messages.is_empty() {
        resolver = in_its_plane(resolver, model);
    }
    let chooses = whole && resolver.asked.family && resolver.messages.is_empty();
    let with_points = chooses.then(|| WithPoints::of(model, &resolver)).flatten();
    let (mut resolver, as_points) = match &with_points {
        Some(with_points) => without_attitude(resolver, with_points),
        None => (resolver, Vec::new()),
    };
    let mut errors = messages;
    if lexed && (errors.is_empty() || !model.items.is_empty()) {
        errors.extend(std::mem::take(&mut resolver.messages));
    }
    let good = errors.is_empty();
    if good && resolver.asked.family {
        choose_family(&mut resolver);
    }
    let spans = spans(&resolver, places);
    let head = places.location(resolver.head);
    let declared = |joint| resolver.declared.get(&Named::Joint(joint));
    let joints: Vec<Location> = (0..resolver.scene.joints.len())
        .map(|joint| declared(joint).map_or(head, |at| places.location(*at)))
        .collect();
    let mut motors = joints.clone();
    for instance in resolver.of("joint") {
        if let (Some(at), Some(place)) = (motor(instance.item), motors.get_mut(instance.slot)) {
            *place = places.location(at.into());
        }
    }
    let going = resolver.going.iter().map(|going| NextScene {
        event: going.event,
        file: places.location(going.file),
        map: (going.map.iter())
            .map(|entry| entry.map(|at| places.location(at)))
            .collect(),
    });
    Reading {
        head,
        joints,
        motors,
        going: going.collect(),
        scene: good.then(|| resolver.scene.clone()),
        skeleton: resolver.scene,
        errors: errors.located(places),
        warnings: resolver.warnings.located(places),
        notes: resolver.notes,
        as_points,
        spans,
        options: DeclarationOptions {
            verify: resolver.asked.verify,
            emit: resolver.asked.emit,
            generic: model.generic,
            visibility: model.visibility.parse().unwrap_or_default(),
        },
        file: None,
    }
}

/// A model, resolved and checked, in a plane where one is given.
fn resolved<'a>(model: &'a ModelSyntax<'a>, whole: bool, plane: Option<Plane>) -> Resolver<'a> {
    let mut resolver = resolve(model, whole, plane);
    check(&mut resolver, model, whole);
    resolver
}

/// The same model in the plane in which it moves, or in space, and a note of which.
fn in_its_plane<'a>(resolver: Resolver<'a>, model: &'a ModelSyntax<'a>) -> Resolver<'a> {
    let (mut resolver, note) = match plane_of_motion(&resolver.scene) {
        Ok(plane) => {
            let flat = resolved(model, true, Some(plane));
            match flat.messages.is_empty() {
                true => (flat, in_plane(plane.word())),
                false => (
                    resolver,
                    in_no_plane("its declaration needs three coordinates"),
                ),
            }
        }
        Err(why) => (resolver, in_no_plane(&why)),
    };
    resolver.notes.push(note);
    resolver
}

/// The same model with some of its bodies as points, where it can be read so, and a note of them; and which.
fn without_attitude<'a>(
    resolver: Resolver<'a>,
    points: &'a WithPoints<'a>,
) -> (Resolver<'a>, Vec<String>) {
    let mut other = resolved(&points.model, true, resolver.scene.planar);
    if !other.messages.is_empty() {
        return (resolver, Vec::new());
    }
    // Of the declaration as it is written; what bodies have and points have not is no less used.
    other.warnings = resolver.warnings;
    other.notes = resolver.notes;
    other.notes.push(as_points(&points.names));
    (other, points.names.clone())
}

/// Where the first `motor` of a joint stands, of a coordinate in braces, too.
fn motor(item: &Item<'_>) -> Option<LexemeIndex> {
    let is_motor = |lexeme: &&Lexeme| lexeme.kind == LexemeKind::Word("motor".into());
    item.block.iter().find_map(|field| {
        let mut values = field.clauses.iter().flat_map(|given| given.value.lexemes);
        let inside = values.find(is_motor).map(|lexeme| lexeme.at);
        (field.word.text == "motor")
            .then_some(field.word.at)
            .or(inside)
    })
}

/// Takes the cheaper family of coordinates, and notes the choice.
fn choose_family(resolver: &mut Resolver<'_>) {
    let (chosen, why) = match without_inertia(&resolver.scene)[..] {
        [] => {
            let families = Families::count(&resolver.scene);
            (families.cheaper(), families.to_string())
        }
        [..] => {
            let why = "a body without mass or moments of its own has no accelerations in absolute coordinates";
            (Coordinates::Relative, why.to_owned())
        }
    };
    resolver
        .notes
        .push(format!("coordinates: {}: {why}", chosen.word()));
    resolver.scene.coordinates = chosen;
}

fn spans(resolver: &Resolver<'_>, places: &Places) -> Spans {
    let of = |named: Named| {
        resolver
            .declared
            .get(&named)
            .map_or_else(Span::call_site, |region| places.span(region.first))
    };
    let scene = &resolver.scene;
    Spans {
        model: places.span(resolver.head.first),
        params: (0..scene.params.len())
            .map(|i| of(Named::Param(i)))
            .collect(),
        inputs: (0..scene.inputs.len())
            .map(|i| of(Named::Input(i)))
            .collect(),
        loads: (0..scene.loads.len()).map(|i| of(Named::Load(i))).collect(),
        outputs: (0..scene.outputs.len())
            .map(|i| of(Named::Output(i)))
            .collect(),
        references: resolver
            .used
            .iter()
            .filter(|(_, at)| !places.is_taken(*at))
            .map(|(named, at)| (*named, places.span(*at)))
            .collect(),
    }
}
