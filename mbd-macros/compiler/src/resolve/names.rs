//! Names: what every word of the declaration refers to.

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::lexeme::Region;

/// Something that has a name: index into its list of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Named {
    /// A const.
    Const(usize),
    /// A param.
    Param(usize),
    /// An input.
    Input(usize),
    /// A state.
    State(usize),
    /// A table.
    Table(usize),
    /// A named expression.
    Let(usize),
    /// A frame of the world.
    WorldFrame(usize),
    /// A body.
    Body(usize),
    /// A frame of a body: body, frame.
    Frame(usize, usize),
    /// A point.
    Point(usize),
    /// A joint.
    Joint(usize),
    /// A line or spring.
    Line(usize),
    /// A load.
    Load(usize),
    /// An output.
    Output(usize),
    /// An event.
    Event(usize),
    /// A metric.
    Metric(usize),
}

impl Named {
    /// Whether its name alone is a value.
    pub fn is_value(self) -> bool {
        matches!(
            self,
            Named::Const(_) | Named::Param(_) | Named::Input(_) | Named::State(_) | Named::Let(_)
        )
    }

    /// The word for its kind.
    pub fn kind(self) -> &'static str {
        match self {
            Named::Const(_) => "const",
            Named::Param(_) => "param",
            Named::Input(_) => "input",
            Named::State(_) => "state",
            Named::Table(_) => "table",
            Named::Let(_) => "let",
            Named::WorldFrame(_) | Named::Frame(..) => "frame",
            Named::Body(_) => "body",
            Named::Point(_) => "point",
            Named::Joint(_) => "joint",
            Named::Line(_) => "line",
            Named::Load(_) => "load",
            Named::Output(_) => "output",
            Named::Event(_) => "event",
            Named::Metric(_) => "metric",
        }
    }
}

/// What one word stands for.
#[derive(Clone, Debug)]
pub enum Members {
    /// One thing.
    One(Named),
    /// Several, by index: `leg[0]`, `leg[1]`. Shared, because whoever looks one of them up keeps the word.
    Many(Rc<BTreeMap<i64, Named>>),
}

/// A word with what it stands for and where it was declared.
#[derive(Clone, Debug)]
pub struct NameEntry {
    /// What it stands for.
    pub members: Members,
    /// Where it is declared first.
    pub at: Region,
}

impl NameEntry {
    /// Whether nothing else has this name, with another index.
    pub fn is_one(&self) -> bool {
        match &self.members {
            Members::One(_) => true,
            Members::Many(members) => members.len() == 1,
        }
    }

    /// The one thing, or the first of several; all of them are of its kind. `None` of a repetition without members.
    pub fn first(&self) -> Option<Named> {
        match &self.members {
            Members::One(named) => Some(*named),
            Members::Many(members) => members.values().next().copied(),
        }
    }
}

/// The words of one namespace, in alphabetical order.
#[derive(Clone, Debug, Default)]
pub struct Namespace {
    entries: BTreeMap<String, NameEntry>,
    /// The words in the order of declaration.
    pub order: Vec<String>,
}

impl Namespace {
    /// Adds a name, with an index if it is repeated. Returns the place of the first one when it is taken.
    pub fn add(
        &mut self,
        word: &str,
        index: Option<i64>,
        named: Named,
        at: Region,
    ) -> Result<(), Region> {
        if let Some(entry) = self.entries.get_mut(word) {
            return match (&mut entry.members, index) {
                (Members::Many(members), Some(index))
                    if !members.contains_key(&index)
                        // All of them are of the kind of the first.
                        && members.values().next().is_none_or(|other| other.kind() == named.kind()) =>
                {
                    Rc::make_mut(members).insert(index, named);
                    Ok(())
                }
                _ => Err(entry.at),
            };
        }
        let members = match index {
            None => Members::One(named),
            Some(index) => Members::Many(Rc::new([(index, named)].into())),
        };
        self.order.push(word.to_string());
        self.entries
            .insert(word.to_string(), NameEntry { members, at });
        Ok(())
    }

    /// Adds a name whose repetition has no member. Returns the place of the first one when it is taken by one thing.
    pub fn reserve(&mut self, word: &str, at: Region) -> Result<(), Region> {
        match self.entries.get(word) {
            Some(entry) if matches!(entry.members, Members::One(_)) => Err(entry.at),
            Some(_) => Ok(()),
            None => {
                let members = Members::Many(Rc::default());
                self.order.push(word.to_string());
                self.entries
                    .insert(word.to_string(), NameEntry { members, at });
                Ok(())
            }
        }
    }

    /// What a word stands for.
    pub fn get(&self, word: &str) -> Option<&NameEntry> {
        self.entries.get(word)
    }

    /// The words in the order of declaration.
    pub fn words(&self) -> impl Iterator<Item = &str> {
        self.order.iter().map(String::as_str)
    }

    /// Whether a word is known and its kind passes.
    pub fn is(&self, word: &str, wanted: impl Fn(Named) -> bool) -> bool {
        self.get(word).is_some_and(|entry| match &entry.members {
            Members::One(named) => wanted(*named),
            // All of them are of the kind of the first.
            Members::Many(members) => members.values().next().is_some_and(|named| wanted(*named)),
        })
    }

    /// The words whose kind passes, in the order of declaration: for a report, as it looks at every word of the declaration.
    pub fn words_of(&self, wanted: impl Fn(Named) -> bool) -> Vec<&str> {
        self.words().filter(|word| self.is(word, &wanted)).collect()
    }
}
