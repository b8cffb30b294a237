//! Collecting: every item gets its name, its index, and a placeholder in the scene; repeated ones are expanded.

use mbd_scene::Free;
use mbd_scene::{
    Body, Formula, Frame, Inertia, Joint, JointLaw, Line, LineKind, Load, LoadKind, Place, Point,
    PointKind, Unit,
};

use super::repeat::Labelled;
use super::{Instance, Named, PART, Resolver, forces};
use crate::lexeme::Region;
use crate::messages::{resolve as say, syntax as say_syntax};
use crate::syntax::expression::Expression;
use crate::syntax::words::{self, Reserved};
use crate::syntax::{Item, ModelSyntax, NameSyntax};

/// At most this many things in one scene: no declaration may make the compiler slow by its repetitions.
pub(super) const MOST: usize = 10_000;
/// The most bytes of a name: columns and files are called by it, and no file system takes more than 255, with an index, an axis and what kind of file it is.
const LONGEST_NAME: usize = 200;

impl<'a> Resolver<'a> {
    /// Names consts, params and tables.
    pub fn collect_numbers(&mut self, model: &'a ModelSyntax<'a>) {
        for item in &model.items {
            let Some(name) = &item.name else {
                continue;
            };
            let spec = words::find(&item.word.text, false);
            if spec.is_none_or(|spec| name.refused_index(spec).is_some()) {
                self.broken.insert(name.word.text.clone());
            }
            self.later.insert(name.word.text.clone());
        }
        self.collect(model, &["const", "param", "table"]);
    }

    /// Names inputs and states, whose repetitions may be consts.
    pub fn collect_repeated_numbers(&mut self, model: &'a ModelSyntax<'a>) {
        self.collect(model, &["input", "state"]);
    }

    /// Names everything else.
    pub fn collect_things(&mut self, model: &'a ModelSyntax<'a>) {
        self.later.clear();
        self.scene.world_frames.push(Frame {
            name: "world".to_string(),
            position: [0.0; 3].map(Formula::Number),
            rotation: None,
        });
        self.collect(
            model,
            &[
                "let", "world", "body", "point", "joint", "line", "spring", "load", "output",
                "event", "metric",
            ],
        );
    }

    fn collect(&mut self, model: &'a ModelSyntax<'a>, wanted: &[&str]) {
        for item in &model.items {
            if wanted.contains(&item.word.text.as_str()) {
                self.collect_item(item);
            }
        }
    }

    fn collect_item(&mut self, item: &'a Item<'a>) {
        let Some(spec) = words::find(&item.word.text, false) else {
            return;
        };
        if spec.word == "world" {
            for frame in item.block.iter().filter(|frame| frame.word.text == "frame") {
                self.collect_frame(None, frame, &[]);
            }
            self.add_instance("world", item, 0, None);
            return;
        }
        let given = item.name.as_ref();
        let Some(name) = given.filter(|name| name.refused_index(spec).is_none()) else {
            return;
        };
        let is_reserved = self.reserved(name);
        if spec.word == "table" && words::reserved_table(&name.word.text) {
            let (at, word) = (name.word.at.into(), &name.word.text);
            self.messages.push(say_syntax::reserved_name(at, word));
        }
        let Some(mut instances) = self.expand(name, &[]) else {
            return;
        };
        if let (None, Some((parts, _))) = (name.index, listed_output(item)) {
            instances = numbered(&name.word.text, parts.len());
        }
        if instances.is_empty() {
            self.idle.push(item);
            if let Err(first) = self.names.reserve(&name.word.text, name.word.at.into()) {
                let (at, word) = (name.word.at.into(), &name.word.text);
                self.messages.push(say::twice(at, word, first));
            }
        }
        for (index, label, value) in instances {
            let slot = self.slots(spec.word);
            let named = named(spec.word, slot);
            let at = Region::from(name.word.at);
            if let Err(first) = self.names.add(&name.word.text, index, named, at) {
                let (first, second) = if first.first < at.first {
                    (first, at)
                } else {
                    (at, first)
                };
                if !is_reserved {
                    self.messages.push(say::twice(second, &label, first));
                }
                self.broken.insert(name.word.text.clone());
                self.dropped.insert(named.kind());
                continue;
            }
            self.declared.insert(named, at);
            self.placeholder(spec.word, item, label);
            let outer: Vec<(String, i64)> = value.clone().into_iter().collect();
            self.add_instance(spec.word, item, slot, value);
            if item.broken {
                self.bad.insert(named);
            }
            if spec.word == "body" && !self.collect_frames(slot, item, &outer) {
                return;
            }
        }
    }

    /// The frames of a body, `outer` the index of its repetition; false when there are too many.
    fn collect_frames(&mut self, body: usize, item: &'a Item<'a>, outer: &[(String, i64)]) -> bool {
        let frames = || item.block.iter().filter(|field| field.word.text == "frame");
        let found = self.size() + frames().count();
        if !outer.is_empty() && found > MOST {
            self.messages
                .push(say::too_many(item.name_at(), MOST, found));
            self.whole = false;
            return false;
        }
        for frame in frames() {
            self.collect_frame(Some(body), frame, outer);
        }
        true
    }

    fn add_instance(
        &mut self,
        word: &'static str,
        item: &'a Item<'a>,
        slot: usize,
        index: Option<(String, i64)>,
    ) {
        let indices = index.into_iter().collect();
        self.instances.entry(word).or_default().push(Instance {
            item,
            slot,
            owner: 0,
            indices,
        });
    }

    fn collect_frame(&mut self, body: Option<usize>, item: &'a Item<'a>, outer: &[(String, i64)]) {
        let Some(name) = &item.name else {
            return;
        };
        let at = Region::from(name.word.at);
        if words::reserved_frame(&name.word.text) {
            self.messages
                .push(say_syntax::reserved_name(at, &name.word.text));
        }
        let Some(instances) = self.expand(name, outer) else {
            if let Some(owner) = body.and_then(|body| self.scene.bodies.get(body)) {
                let lost = format!("{}.{}", owner.name, name.word.text);
                self.broken.insert(lost);
            }
            return;
        };
        if instances.is_empty() {
            self.idle.push(item);
            let space = match body {
                Some(body) => self.frames.get_mut(body),
                None => Some(&mut self.world),
            };
            if let Some(Err(first)) = space.map(|space| space.reserve(&name.word.text, at)) {
                self.messages.push(say::twice(at, &name.word.text, first));
            }
        }
        for (index, label, value) in instances {
            let (space, list) = match body {
                Some(body) => match (self.frames.get_mut(body), self.scene.bodies.get_mut(body)) {
                    (Some(space), Some(owner)) => (space, &mut owner.frames),
                    _ => return,
                },
                None => (&mut self.world, &mut self.scene.world_frames),
            };
            let slot = list.len();
            let named = body.map_or(Named::WorldFrame(slot), |body| Named::Frame(body, slot));
            if let Err(first) = space.add(&name.word.text, index, named, at) {
                self.messages.push(say::twice(at, &label, first));
                continue;
            }
            list.push(frame(label));
            self.declared.insert(named, at);
            let word = if body.is_some() {
                "frame"
            } else {
                "world frame"
            };
            self.instances.entry(word).or_default().push(Instance {
                item,
                slot,
                owner: body.unwrap_or(0),
                indices: outer.iter().cloned().chain(value).collect(),
            });
            if item.broken {
                self.bad.insert(named);
            }
        }
    }

    /// Tells of a name that cannot be one, and whether it is that.
    fn reserved(&mut self, name: &NameSyntax<'_>) -> bool {
        let at = name.word.at.into();
        let report = match words::reserved(&name.word.text) {
            None if name.word.text.len() > LONGEST_NAME => {
                say_syntax::long_name(at, &name.word.text, LONGEST_NAME)
            }
            None => return false,
            Some(Reserved::Language) => say_syntax::reserved_name(at, &name.word.text),
            Some(Reserved::Rust) => say::rust_as_name(at, &name.word.text),
        };
        self.messages.push(report);
        true
    }

    /// How many things there are so far.
    pub(super) fn size(&self) -> usize {
        let frames: usize = self.scene.bodies.iter().map(|body| body.frames.len()).sum();
        frames
            + self.scene.world_frames.len()
            + self.scene.points.len()
            + self.scene.lines.len()
            + self.scene.joints.len()
            + self.scene.lets.len()
            + self.scene.states.len()
    }

    /// How many things of a kind there are so far.
    fn slots(&self, word: &str) -> usize {
        let scene = &self.scene;
        match word {
            "const" => scene.consts.len(),
            "param" => scene.params.len(),
            "input" => scene.inputs.len(),
            "state" => scene.states.len(),
            "table" => scene.tables.len(),
            "let" => scene.lets.len(),
            "body" => scene.bodies.len(),
            "point" => scene.points.len(),
            "joint" => scene.joints.len(),
            "line" | "spring" => scene.lines.len(),
            "load" => scene.loads.len(),
            "output" => scene.outputs.len(),
            "metric" => scene.runs.metrics.len(),
            _ => scene.events.len(),
        }
    }

    /// Puts a well-formed entry into the list of its kind.
    fn placeholder(&mut self, word: &str, item: &Item<'_>, name: String) {
        let doc = item.doc.clone();
        let nowhere = Place::World(0);
        let scene = &mut self.scene;
        match word {
            "body" => {
                self.frames.push(super::Namespace::default());
                scene.bodies.push(Body {
                    name,
                    doc,
                    mass: Formula::Number(1.0),
                    inertia: sphere(),
                    frames: vec![frame("com".to_string())],
                });
            }
            "point" => scene.points.push(Point {
                name,
                doc,
                kind: PointKind::Mass(Formula::Number(1.0)),
            }),
            "joint" => scene.joints.push(Joint {
                name,
                doc,
                law: JointLaw::Free(Free {}),
                parent: nowhere,
                child: nowhere,
                forces: Vec::new(),
                cut: false,
            }),
            "line" | "spring" => scene.lines.push(Line {
                name,
                doc,
                kind: if word == "line" {
                    LineKind::Line
                } else {
                    LineKind::Spring
                },
                from: nowhere,
                to: nowhere,
                free_length: Formula::Number(1.0),
                stiffness: Formula::Number(1.0),
                damping: Formula::Number(0.0),
            }),
            "load" => scene.loads.push(Load {
                name,
                doc,
                at: nowhere,
                // What has a value asks the caller for none, whatever is wrong with it.
                kind: match item.clause("=") {
                    Some(_) => LoadKind::Force(Formula::Vector(vec![Formula::Number(0.0); 3])),
                    None => LoadKind::External,
                },
            }),
            _ => self.number_placeholder(word, name, doc),
        }
    }
}

/// The numbers of an output that are no vector, with their unit.
fn listed_output(item: &Item<'_>) -> Option<(Vec<Expression>, Option<Unit>)> {
    let value = item.clause("=").filter(|_| item.word.text == "output")?;
    forces::listed(value)
}

/// Instances of an output of several numbers: `NAME[0]`, `NAME[1]`.
fn numbered(word: &str, count: usize) -> Vec<Labelled> {
    let count = i64::try_from(count).unwrap_or(0);
    let label = |i| (Some(i), format!("{word}[{i}]"), Some((PART.to_owned(), i)));
    (0..count).map(label).collect()
}

fn named(word: &str, slot: usize) -> Named {
    match word {
        "const" => Named::Const(slot),
        "param" => Named::Param(slot),
        "input" => Named::Input(slot),
        "state" => Named::State(slot),
        "table" => Named::Table(slot),
        "let" => Named::Let(slot),
        "body" => Named::Body(slot),
        "point" => Named::Point(slot),
        "joint" => Named::Joint(slot),
        "line" | "spring" => Named::Line(slot),
        "load" => Named::Load(slot),
        "output" => Named::Output(slot),
        "metric" => Named::Metric(slot),
        _ => Named::Event(slot),
    }
}

fn frame(name: String) -> Frame {
    Frame {
        name,
        position: [0.0; 3].map(Formula::Number),
        rotation: None,
    }
}

fn sphere() -> Inertia {
    let number = Formula::Number;
    Inertia {
        xx: number(1.0),
        yy: number(1.0),
        zz: number(1.0),
        xy: number(0.0),
        xz: number(0.0),
        yz: number(0.0),
    }
}
