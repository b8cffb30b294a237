//! Every word of the language, for editors.

use std::collections::BTreeSet;

use mbd_scene::JointLaw;
use mbd_scene::solids::Solid;

use crate::resolve::field_words;
use crate::syntax::words::{self, FRAME, ITEMS, ItemWord, START};
use crate::units;

/// The words of the language by what they are; each in alphabetical order.
#[derive(Clone, Debug)]
pub struct Vocabulary {
    /// What begins an item or a setting, and what may stand before it.
    pub items: BTreeSet<&'static str>,
    /// Those of them behind which a name stands.
    pub naming: BTreeSet<&'static str>,
    /// What stands before a value outside the braces: `from`, `rotated`.
    pub clauses: BTreeSet<&'static str>,
    /// Fields between braces.
    pub fields: BTreeSet<&'static str>,
    /// Joints and shapes.
    pub kinds: BTreeSet<&'static str>,
    /// Functions.
    pub functions: BTreeSet<&'static str>,
    /// Words that stand elsewhere, and are no names: `rpy`, `falls`.
    pub others: BTreeSet<&'static str>,
    /// Units.
    pub units: BTreeSet<&'static str>,
}

impl Vocabulary {
    /// The vocabulary that the readers use.
    #[must_use]
    pub fn new() -> Self {
        let all = || ITEMS.iter().chain([&FRAME, &START]);
        let is_word = |sign: &&str| sign.chars().all(|c| c.is_alphabetic() || c == '_');
        let clauses = |item: &'static ItemWord| item.clauses.iter().map(|clause| clause.sign);
        let joints = JointLaw::KEYWORDS.iter().copied();
        let of_joints = joints.clone().filter_map(field_words);
        let of_joints = of_joints.flat_map(|(_, names)| names);
        let of_solids = Solid::ALL.into_iter().filter(|solid| *solid != Solid::Box);
        let of_solids = of_solids.flat_map(|solid| solid.sizes().iter().copied());
        let of_items = all()
            .flat_map(|item| item.fields.unwrap_or_default())
            .copied();
        Vocabulary {
            items: all()
                .flat_map(|item| [Some(item.word), item.mark])
                .flatten()
                .collect(),
            naming: all()
                .filter(|item| item.named)
                .map(|item| item.word)
                .collect(),
            clauses: all().flat_map(clauses).filter(is_word).collect(),
            fields: of_items.chain(of_joints).chain(of_solids).collect(),
            kinds: joints.chain(Solid::ALL.map(Solid::keyword)).collect(),
            functions: words::FUNCTIONS.iter().copied().collect(),
            others: words::OTHER_RESERVED.iter().copied().collect(),
            units: units::known().into_iter().collect(),
        }
    }
}

impl Default for Vocabulary {
    fn default() -> Self {
        Self::new()
    }
}
