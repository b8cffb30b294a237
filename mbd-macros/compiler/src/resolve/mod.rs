//! Resolving: names become indices, expressions become formulas in SI, items become the [`Scene`].
//!
//! The driver [`resolve`] reads as the list of what a declaration has. Every list of the scene gets all its entries first, with
//! placeholders, so that a name can be used before it is declared and a scene with mistakes still has its shape.

mod bodies;
mod collect;
mod coordinates;
mod events;
mod fields;
pub mod fold;
mod forces;
mod functions;
mod joint_forces;
mod joints;
mod lets;
mod lines;
mod locks;
mod metrics;
mod names;
mod next;
mod numbers;
mod origin;
mod part_quantities;
mod path;
mod places;
mod repeat;
mod settings;
mod shapes;
mod starts;
mod states;
mod tables;
mod turns;
mod unit_words;
mod value;
mod vanishing;

use std::collections::{BTreeMap, BTreeSet};

use mbd_scene::{Detachable, Formula, Plane, Scene};

pub use joints::{field_words, letter};
pub use names::{Named, Namespace};
pub use next::NextSceneRegion;
pub use turns::mixes_turns;
pub use value::{MayDependOn, Scope, Typed};

use crate::lexeme::{LexemeIndex, Region};
use crate::messages::Messages;
use crate::syntax::{Item, ModelSyntax};

/// An item, once for every value of its index.
#[derive(Clone, Debug)]
pub struct Instance<'a> {
    /// The item.
    pub item: &'a Item<'a>,
    /// Its index in the list of the scene, or of its body.
    pub slot: usize,
    /// The body of a frame.
    pub owner: usize,
    /// The repetitions it is in, that of its body first: the name of each index and its value.
    pub indices: Vec<(String, i64)>,
}

/// The index of the numbers of an output that are no vector: no name, so that nothing refers to it.
const PART: &str = "";

impl Instance<'_> {
    /// Which number of its list it is, of an output of several.
    fn part(&self) -> Option<usize> {
        let own = self.indices.last().filter(|(name, _)| name == PART);
        own.and_then(|(_, part)| usize::try_from(*part).ok())
    }

    /// The scope of its values.
    pub fn scope(&self, stage: MayDependOn) -> Scope<'_> {
        Scope {
            stage,
            indices: &self.indices,
        }
    }
}

/// What the declaration asks for besides the scene.
#[derive(Clone, Debug, Default)]
pub struct RequestedItems {
    /// `verify;`
    pub verify: bool,
    /// `emit: […]`
    pub emit: Option<Vec<Emitted>>,
    /// `coordinates: auto;`
    pub family: bool,
    /// `planar: auto;`
    pub plane: bool,
}

/// What `emit: […]` asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Emitted {
    /// Every quantity of a kind.
    Kind(String),
    /// The Jacobian of one frame of a body.
    FrameJacobian(usize, usize),
}

/// A scene in the making, and everything the later stages need to know about it.
pub struct Resolver<'a> {
    /// The scene.
    pub scene: Scene,
    /// What is asked for besides.
    pub asked: RequestedItems,
    /// All names but frames.
    pub names: Namespace,
    /// The frames of the world.
    pub world: Namespace,
    /// The frames of each body.
    pub frames: Vec<Namespace>,
    /// The items of each kind, repeated ones expanded: by keyword, in order.
    pub instances: BTreeMap<&'static str, Vec<Instance<'a>>>,
    /// Errors.
    pub messages: Messages,
    /// Warnings.
    pub warnings: Messages,
    /// Choices made.
    pub notes: Vec<String>,
    /// Where each thing is declared.
    pub declared: BTreeMap<Named, Region>,
    /// Where each thing is used.
    pub used: Vec<(Named, LexemeIndex)>,
    /// What has been used at least once.
    pub mentioned: BTreeSet<Named>,
    /// Velocities of points and stretch rates of lines that are asked for, and where.
    pub rates_asked: Vec<(Formula, Region)>,
    /// What has a mistake of its own: its users are not blamed.
    pub bad: BTreeSet<Named>,
    /// Names of items that could not be read, or are used twice: what refers to them is not blamed.
    pub broken: BTreeSet<String>,
    /// Kinds of which an item was dropped because its name is taken: what seems to be missing may be that item.
    pub dropped: BTreeSet<&'static str>,
    /// Names that are declared but not collected yet, while the numbers are made.
    pub later: BTreeSet<String>,
    /// Items whose repetition is empty: they declare nothing.
    pub idle: Vec<&'a Item<'a>>,
    /// Names that count turns, and where those of no unit stand for radians.
    turning: BTreeMap<Named, turns::Turns>,
    /// Names of what is made of numbers without a unit alone, and its size.
    without_unit: BTreeMap<Named, f64>,
    radians_of_states: Vec<turns::RadiansOfState>,
    /// Params and inputs that stand where radians are meant.
    radians_of_settables: BTreeSet<Named>,
    /// What is known of each `let`.
    lets: Vec<lets::LetProgress>,
    /// What each output shows, in SI.
    shown: BTreeMap<usize, Typed>,
    /// How many lets are being resolved because another one names them.
    nested: usize,
    /// What a `let` names that is not known yet.
    too_early: Option<String>,
    /// How far resolving has come.
    known: ResolvedSoFar,
    /// Whether reading lost no item.
    pub whole: bool,
    /// Locks that events free, and where.
    pub freed: Vec<(usize, Region)>,
    /// What events attach, each with the place where it is named.
    pub attached: Vec<(Detachable, Region)>,
    /// Locks whose force or torque is asked for, and where.
    pub asked_of_locks: Vec<(usize, Region)>,
    /// Where events name scenes that go on.
    pub going: Vec<NextSceneRegion>,
    /// Points whose model is declared.
    pub chosen: BTreeSet<usize>,
    /// Whether bare numbers are SI.
    pub si: bool,
    /// Where the model's name is.
    pub head: Region,
    /// Words of units that are names, too.
    unit_words: unit_words::UnitWords,
    /// What to write instead, where the value being read must be known before a run and is not.
    pub instead: Option<&'static str>,
}

/// How far resolving has come: what a `let` that is named now can be made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ResolvedSoFar {
    /// Consts, params, inputs and tables.
    Numbers,
    /// Also the names of all things.
    Names,
    /// Also the kinds of the joints, and so their coordinates.
    Joints,
    /// Also which coordinates have motors.
    Motors,
    /// Also what outputs show, which events and metrics may name.
    Outputs,
}

/// Resolves a model as far as it goes, in a plane where one is given and the model says no other. Where items were lost in reading (not `whole`), what seems missing may be one of them.
pub fn resolve<'a>(model: &'a ModelSyntax<'a>, whole: bool, plane: Option<Plane>) -> Resolver<'a> {
    let mut resolver = Resolver::new(model);
    resolver.whole = whole;
    resolver.scene.planar = plane;
    resolver.settings(model);
    resolver.collect_numbers(model);
    resolver.consts();
    resolver.collect_repeated_numbers(model);
    resolver.numbers();
    resolver.collect_things(model);
    resolver.known = ResolvedSoFar::Names;
    resolver.world_frames();
    resolver.bodies();
    resolver.points();
    resolver.lines();
    resolver.joints();
    resolver.known = ResolvedSoFar::Joints;
    resolver.along_joints();
    resolver.known = ResolvedSoFar::Motors;
    resolver.lets();
    resolver.part_starts();
    resolver.gravity(model);
    resolver.states();
    resolver.windings();
    resolver.loads();
    resolver.outputs();
    resolver.known = ResolvedSoFar::Outputs;
    resolver.events();
    resolver.metrics();
    resolver.unlocked();
    resolver.states_in_radians();
    resolver.settables_in_radians();
    resolver.detached_starts();
    resolver.never_detached();
    resolver.origin(model);
    resolver.emitted(model);
    resolver.open_unit_words();
    resolver
}

impl<'a> Resolver<'a> {
    fn new(model: &'a ModelSyntax<'a>) -> Self {
        let name = model.name.as_ref();
        Resolver {
            scene: Scene {
                name: name.map_or_else(|| "Model".to_string(), |word| word.text.clone()),
                doc: model.doc.clone(),
                ..Scene::default()
            },
            asked: RequestedItems::default(),
            names: Namespace::default(),
            world: Namespace::default(),
            frames: Vec::new(),
            instances: BTreeMap::new(),
            messages: Messages::default(),
            warnings: Messages::default(),
            notes: Vec::new(),
            declared: BTreeMap::new(),
            used: Vec::new(),
            mentioned: BTreeSet::new(),
            rates_asked: Vec::new(),
            bad: BTreeSet::new(),
            broken: BTreeSet::new(),
            dropped: BTreeSet::new(),
            later: BTreeSet::new(),
            idle: Vec::new(),
            turning: BTreeMap::new(),
            without_unit: BTreeMap::new(),
            radians_of_states: Vec::new(),
            radians_of_settables: BTreeSet::new(),
            lets: Vec::new(),
            shown: BTreeMap::new(),
            nested: 0,
            too_early: None,
            known: ResolvedSoFar::Numbers,
            whole: true,
            freed: Vec::new(),
            attached: Vec::new(),
            asked_of_locks: Vec::new(),
            going: Vec::new(),
            chosen: BTreeSet::new(),
            si: false,
            head: name.map_or(Region::START, |word| word.at.into()),
            unit_words: unit_words::UnitWords::default(),
            instead: None,
        }
    }

    /// Remembers that something is used here.
    pub fn mention(&mut self, named: Named, at: LexemeIndex) {
        self.mentioned.insert(named);
        if !self.used.contains(&(named, at)) && self.used.len() < 2000 {
            self.used.push((named, at));
        }
    }

    /// Whether anything of this kind has a mistake, or was dropped: then what it would supply is not known to be missing.
    pub fn any_bad(&self, kind: &str) -> bool {
        !self.whole
            || self.dropped.contains(kind)
            || self.bad.iter().any(|named| named.kind() == kind)
    }

    /// The instances of a kind.
    pub fn of(&self, word: &str) -> Vec<Instance<'a>> {
        self.instances.get(word).cloned().unwrap_or_default()
    }

    /// The table of this name.
    pub fn table(&self, word: &str) -> Option<usize> {
        match self.names.get(word).map(|entry| &entry.members) {
            Some(names::Members::One(Named::Table(index))) => Some(*index),
            _ => None,
        }
    }
}
