//! Collecting: every item gets its name, its index, and a placeholder in the scene; repeated ones are expanded.

use mbd_scene::Free;
use mbd_scene::{
    Body, Formula, Frame, Inertia, Joint, JointLaw, Line, LineKind, Load, LoadKind, Place, Point,
    PointKind,
};

use super::{Instance, Named, Resolver, Scope, Stage};
use crate::lexeme::{Kind, Region};
use crate::messages::{resolve as say, syntax as say_syntax};
use crate::syntax::words::{self, Reserved};
use crate::syntax::{Cursor, Item, Model, Name, Value, expression};

/// At most this many things in one scene: no declaration may make the compiler slow by its repetitions.
const MOST: usize = 10_000;

/// One instance of a name: its index, its label, and the index of the repetition with its value.
type Labelled = (Option<i64>, String, Option<(String, i64)>);

/// What the index in the brackets of a name says.
enum Index {
    /// No brackets.
    None,
    /// `[0]`
    One(i64),
    /// `[i in 0..3]`
    Range(String, i64, i64),
}

impl<'a> Resolver<'a> {
    /// Names consts, params, inputs and tables.
    pub fn collect_numbers(&mut self, model: &'a Model<'a>) {
        for item in &model.items {
            let Some(name) = &item.name else {
                continue;
            };
            if words::find(&item.word.text, false).is_none() {
                self.broken.insert(name.word.text.clone());
            }
            self.later.insert(name.word.text.clone());
        }
        self.collect(model, &["const", "param", "input", "table"]);
    }

    /// Names everything else.
    pub fn collect_things(&mut self, model: &'a Model<'a>) {
        self.later.clear();
        self.scene.world_frames.push(Frame {
            name: "world".to_string(),
            position: [0.0; 3].map(Formula::Number),
            rotation: None,
        });
        self.collect(
            model,
            &[
                "world", "body", "point", "joint", "line", "spring", "load", "output", "event",
            ],
        );
    }

    fn collect(&mut self, model: &'a Model<'a>, wanted: &[&str]) {
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
        let Some(name) = &item.name else {
            return;
        };
        self.reserved(name);
        for (index, label, value) in self.expand(name, &[]) {
            let slot = self.slots(spec.word);
            let named = named(spec.word, slot);
            let at = Region::from(name.word.at);
            if let Err(first) = self.names.add(&name.word.text, index, named, at) {
                let (first, second) = if first.first < at.first {
                    (first, at)
                } else {
                    (at, first)
                };
                self.messages.push(say::twice(second, &label, first));
                self.broken.insert(name.word.text.clone());
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
        if !outer.is_empty() && self.size() + frames().count() > MOST {
            self.messages.push(say::too_many(item.name_at(), MOST));
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
        let instances = self.expand(name, outer);
        if instances.is_empty()
            && let Some(owner) = body.and_then(|body| self.scene.bodies.get(body))
        {
            let lost = format!("{}.{}", owner.name, name.word.text);
            self.broken.insert(lost);
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

    fn reserved(&mut self, name: &Name<'_>) {
        let at = name.word.at.into();
        let report = match words::reserved(&name.word.text) {
            None => return,
            Some(Reserved::Language) => say_syntax::reserved_name(at, &name.word.text),
            Some(Reserved::Unit) => say::unit_as_name(at, &name.word.text),
            Some(Reserved::Rust) => say::rust_as_name(at, &name.word.text),
        };
        self.messages.push(report);
    }

    /// Index, label and the value of the repetition, for every instance of a name; `outer`: the repetition around it.
    fn expand(&mut self, name: &Name<'_>, outer: &[(String, i64)]) -> Vec<Labelled> {
        let word = &name.word.text;
        match self.index(name, outer) {
            Some(Index::None) => vec![(None, word.clone(), None)],
            Some(Index::One(i)) => vec![(Some(i), format!("{word}[{i}]"), None)],
            Some(Index::Range(variable, first, end)) => (first..end)
                .map(|i| (Some(i), format!("{word}[{i}]"), Some((variable.clone(), i))))
                .collect(),
            None => {
                self.whole = false;
                // A frame is lost on its own body only.
                if outer.is_empty() {
                    self.broken.insert(word.clone());
                }
                Vec::new()
            }
        }
    }

    fn index(&mut self, name: &Name<'_>, outer: &[(String, i64)]) -> Option<Index> {
        let Some(value) = name.index else {
            return Some(Index::None);
        };
        let mut cursor = Cursor::new(value);
        let repeated =
            matches!(cursor.ahead(1).map(|l| &l.kind), Some(Kind::Word(word)) if word == "in");
        if !repeated {
            return self.constant_index(value, outer).map(Index::One);
        }
        let variable = cursor.word()?;
        if words::reserved(&variable.text).is_some() || self.names.get(&variable.text).is_some() {
            return self.fail(say_syntax::reserved_name(
                variable.at.into(),
                &variable.text,
            ));
        }
        if outer.iter().any(|(taken, _)| *taken == variable.text) {
            return self.fail(say::index_twice(variable.at.into(), &variable.text));
        }
        cursor.keyword("in")?;
        let (first, end) = self.bounds(cursor, value, outer)?;
        let count = end.saturating_sub(first);
        if count <= 0 {
            return self.fail(say::empty_repetition(value.at));
        }
        let room = MOST.saturating_sub(self.size());
        if usize::try_from(count).map_or(true, |count| count > room) {
            return self.fail(say::too_many(value.at, MOST));
        }
        Some(Index::Range(variable.text, first, end))
    }

    /// `0..3` or `0..=2`: first and one past the last.
    fn bounds(
        &mut self,
        mut cursor: Cursor<'_>,
        whole: Value<'_>,
        outer: &[(String, i64)],
    ) -> Option<(i64, i64)> {
        let scope = Scope {
            stage: Stage::Constant,
            indices: outer,
        };
        let first = match expression::prefix(&mut cursor) {
            Ok(first) => self.whole_number(&first, scope)?,
            Err(report) => return self.fail(report),
        };
        let inclusive = cursor.signs("..=").is_some();
        if !inclusive && cursor.signs("..").is_none() {
            return self.fail(say_syntax::range(whole.at));
        }
        let last = match expression::prefix(&mut cursor) {
            Ok(last) => self.whole_number(&last, scope)?,
            Err(report) => return self.fail(report),
        };
        if let Err(report) = cursor.finish("`]`") {
            return self.fail(report);
        }
        Some((first, last.saturating_add(i64::from(inclusive))))
    }

    fn constant_index(&mut self, value: Value<'_>, outer: &[(String, i64)]) -> Option<i64> {
        if value.lexemes.is_empty() {
            return self.fail(say_syntax::range(value.at));
        }
        let scope = Scope {
            stage: Stage::Constant,
            indices: outer,
        };
        match expression::whole(value) {
            Ok(parsed) => self.whole_number(&parsed, scope),
            Err(_) => self.fail(say_syntax::range(value.at)),
        }
    }

    /// How many things there are so far.
    fn size(&self) -> usize {
        let frames: usize = self.scene.bodies.iter().map(|body| body.frames.len()).sum();
        frames
            + self.scene.world_frames.len()
            + self.scene.points.len()
            + self.scene.lines.len()
            + self.scene.joints.len()
    }

    /// How many things of a kind there are so far.
    fn slots(&self, word: &str) -> usize {
        let scene = &self.scene;
        match word {
            "const" => scene.consts.len(),
            "param" => scene.params.len(),
            "input" => scene.inputs.len(),
            "table" => scene.tables.len(),
            "body" => scene.bodies.len(),
            "point" => scene.points.len(),
            "joint" => scene.joints.len(),
            "line" | "spring" => scene.lines.len(),
            "load" => scene.loads.len(),
            "output" => scene.outputs.len(),
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
                along: Vec::new(),
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
                kind: LoadKind::External,
            }),
            _ => self.number_placeholder(word, name, doc),
        }
    }
}

fn named(word: &str, slot: usize) -> Named {
    match word {
        "const" => Named::Const(slot),
        "param" => Named::Param(slot),
        "input" => Named::Input(slot),
        "table" => Named::Table(slot),
        "body" => Named::Body(slot),
        "point" => Named::Point(slot),
        "joint" => Named::Joint(slot),
        "line" | "spring" => Named::Line(slot),
        "load" => Named::Load(slot),
        "output" => Named::Output(slot),
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
