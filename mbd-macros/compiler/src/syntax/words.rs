//! The vocabulary: every item with its clauses and fields, once. The text reader, the TOML reader and writer, and all messages use it.

use mbd_scene::similar::nearest;

use super::quantities;

/// An item of the language, or a setting.
#[derive(Debug, PartialEq, Eq)]
pub struct ItemWord {
    /// The keyword.
    pub word: &'static str,
    /// Whether a name follows.
    pub named: bool,
    /// Whether the name may be repeated: `leg[i in 0..3]`.
    pub repeats: bool,
    /// The word that may stand before the keyword; in TOML a key that is `true` or `false`.
    pub mark: Option<&'static str>,
    /// What stands outside the braces, in order: the sign or word before each value.
    pub clauses: &'static [Clause],
    /// The fields between the braces; `None`: no braces.
    pub fields: Option<&'static [&'static str]>,
    /// How it is written.
    pub form: &'static str,
}

/// A value outside the braces of an item.
#[derive(Debug, PartialEq, Eq)]
pub struct Clause {
    /// The sign or word before the value.
    pub sign: &'static str,
    /// Its key in TOML.
    pub key: &'static str,
    /// Whether it must be there.
    pub needed: bool,
}

impl ItemWord {
    /// The first clause that must be there and is not, of those that are given by their signs. A frame that is only rotated is where its thing is.
    pub fn lacks(&self, given: impl Fn(&str) -> bool) -> Option<&'static Clause> {
        let rotated = self.word == FRAME.word && given("rotated");
        let mut clauses = self.clauses.iter();
        clauses.find(|clause| clause.needed && !rotated && !given(clause.sign))
    }

    /// The clause whose value may be all of an item in TOML, `let.speed = "…"`: the only one it needs. An input needs its kind or a value, which a
    /// number begins.
    #[cfg(feature = "toml")]
    pub fn alone(&self, value: &str) -> Option<&'static Clause> {
        if self.word == INPUT {
            let sign = if begins_with_number(value) { "=" } else { ":" };
            return self.clauses.iter().find(|clause| clause.sign == sign);
        }
        let mut needed = self.clauses.iter().filter(|clause| clause.needed);
        needed.next().filter(|_| needed.next().is_none())
    }
}

/// Whether a value of TOML begins with a number, of a vector its first: `"6 V"`, `["8 m/s", 0, 0]`. A unit may begin with one, too: `"1/s"`.
#[cfg(feature = "toml")]
fn begins_with_number(value: &str) -> bool {
    let opening = |c: char| c.is_whitespace() || "[\"'-+.".contains(c);
    let number = value.trim_start_matches(opening);
    let per = number
        .strip_prefix('1')
        .and_then(|rest| rest.trim_start().strip_prefix('/'))
        .is_some_and(|unit| !unit.trim_start().starts_with(|c: char| c.is_ascii_digit()));
    number.starts_with(|c: char| c.is_ascii_digit()) && !per
}

/// The keyword of an input.
pub const INPUT: &str = "input";

const fn needs(sign: &'static str, key: &'static str) -> Clause {
    Clause {
        sign,
        key,
        needed: true,
    }
}

const fn may(sign: &'static str, key: &'static str) -> Clause {
    Clause {
        sign,
        key,
        needed: false,
    }
}

/// The key of the clause that holds the path of a file, a string.
pub const FILE: &str = "file";

const VALUE: &[Clause] = &[needs(":", "value")];

const fn setting(word: &'static str, form: &'static str) -> ItemWord {
    ItemWord {
        word,
        named: false,
        repeats: false,
        mark: None,
        clauses: VALUE,
        fields: None,
        form,
    }
}

const fn item(
    word: &'static str,
    clauses: &'static [Clause],
    fields: Option<&'static [&'static str]>,
    form: &'static str,
) -> ItemWord {
    ItemWord {
        word,
        named: true,
        repeats: false,
        mark: None,
        clauses,
        fields,
        form,
    }
}

const fn repeated(item: ItemWord) -> ItemWord {
    ItemWord {
        repeats: true,
        ..item
    }
}

const fn marked(mark: &'static str, item: ItemWord) -> ItemWord {
    ItemWord {
        mark: Some(mark),
        ..item
    }
}

const ENDS: &[Clause] = &[needs("from", "from"), needs("to", "to")];
const LINE_FIELDS: Option<&[&str]> =
    Some(&["free_length", "stiffness", "force", "damping", "at_start"]);
const SPRING_FIELDS: Option<&[&str]> = Some(&["free_length", "stiffness", "damping", "at_start"]);

/// A frame on a body or in the world; the only item inside another.
pub const FRAME: ItemWord = repeated(item(
    "frame",
    &[needs("at", "at"), may("rotated", "rotated")],
    None,
    "frame NAME at [x, y, z] m rotated rpy(a, b, c)",
));

/// The start of a body or a point, and of a joint coordinate, whose value follows a colon.
pub const START: ItemWord = ItemWord {
    word: "start",
    named: false,
    repeats: false,
    mark: None,
    clauses: &[
        may(":", "value"),
        may("at", "at"),
        may("rotated", "rotated"),
        may("velocity", "velocity"),
        may("angular_velocity", "angular_velocity"),
    ],
    fields: None,
    form: "start at [x, y, z] m rotated rpy(a, b, c) velocity [x, y, z] m/s angular_velocity [x, y, z] rad/s",
};

/// The word before a value that another one is a slip of: `velocity` of `velocty`.
pub fn near_clause(word: &str) -> Option<&'static str> {
    // What is shorter is near to too much.
    const SHORTEST: usize = 4;
    let inner = [&FRAME, &START].into_iter();
    let clauses = inner.chain(ITEMS).flat_map(|item| item.clauses);
    let long = clauses
        .map(|clause| clause.sign)
        .filter(|sign| sign.len() >= SHORTEST);
    nearest(word, long.filter(|_| word.len() >= SHORTEST))
}

/// Every item and setting of a model.
pub const ITEMS: &[ItemWord] = &[
    setting("coordinates", "coordinates: absolute;"),
    setting("angular_velocity", "angular_velocity: body;"),
    setting("planar", "planar: xz;"),
    setting("origin", "origin: follows NAME;"),
    setting("units", "units: si;"),
    setting("gravity", "gravity: [0.0, 0.0, -9.81] m/s^2;"),
    setting("emit", "emit: [derivative, outputs];"),
    ItemWord {
        word: "urdf",
        named: false,
        repeats: false,
        mark: None,
        clauses: &[needs(":", FILE)],
        fields: Some(&["base", "inertias", "angle", "slide"]),
        form: "urdf: \"robot.urdf\" { base: free }",
    },
    item(
        "extend",
        &[],
        Some(&["frame", "start"]),
        "extend NAME { fields of the body or joint NAME of the URDF }",
    ),
    ItemWord {
        word: "verify",
        named: false,
        repeats: false,
        mark: None,
        clauses: &[],
        fields: None,
        form: "verify;",
    },
    item("const", &[needs("=", "value")], None, "const NAME = 2.1 m;"),
    item(
        "param",
        &[needs("=", "value"), may("in", "in")],
        None,
        "param NAME = 761 kg in 600 kg ..= 900 kg;",
    ),
    repeated(item(
        INPUT,
        &[may(":", "kind"), may("=", "value")],
        None,
        "input NAME: force = 0 N;",
    )),
    repeated(item(
        "state",
        &[may(":", "kind"), needs("=", "start")],
        Some(&["rate"]),
        "state NAME = 0 A { rate: expression }",
    )),
    marked(
        "smooth",
        item(
            "table",
            &[needs("=", "value")],
            None,
            "table NAME = { 0 km: 0.0145 kg/m^3, 10 km: 0.006 kg/m^3 };",
        ),
    ),
    repeated(item(
        "let",
        &[needs("=", "value"), may("in", "in")],
        None,
        "let NAME = expression;",
    )),
    ItemWord {
        word: "world",
        named: false,
        repeats: false,
        mark: None,
        clauses: &[],
        fields: Some(&["frame"]),
        form: "world { frame NAME at [x, y, z] m }",
    },
    repeated(item(
        "body",
        &[],
        Some(&[
            "mass",
            "density",
            "center_of_mass",
            "inertia",
            "shape",
            "frame",
            "start",
        ]),
        "body NAME { mass: 2.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }",
    )),
    repeated(item(
        "point",
        &[],
        Some(&["mass", "equilibrium", "start"]),
        "point NAME;",
    )),
    marked(
        "loop",
        repeated(item(
            "joint",
            &[needs(":", "kind"), needs("from", "from"), needs("to", "to")],
            // The joint's own law says which: see `resolve/joints.rs`.
            Some(&[]),
            "joint NAME: hinge from world to body.frame { axis: y }",
        )),
    ),
    repeated(item(
        "line",
        ENDS,
        LINE_FIELDS,
        "line NAME from body.frame to point { free_length: 1.0 m, stiffness: 1.0 kN/m }",
    )),
    repeated(item(
        "spring",
        ENDS,
        SPRING_FIELDS,
        "spring NAME from body.frame to body.frame { free_length: 1.0 m, stiffness: 1.0 kN/m }",
    )),
    repeated(item(
        "load",
        &[
            needs("on", "on"),
            may("at", "at"),
            may(":", "kind"),
            may("=", "value"),
            may("in", "in"),
        ],
        None,
        "load NAME on body at frame = expression;",
    )),
    repeated(item(
        "output",
        &[needs("=", "value"), may("in", "in")],
        None,
        "output NAME = expression;",
    )),
    repeated(item(
        "metric",
        &[needs("=", "value"), may("in", "in")],
        Some(&["level", "at", "from", "to"]),
        "metric NAME = max expression;",
    )),
    repeated(item(
        "event",
        &[
            needs("=", "value"),
            may("crosses", "crosses"),
            may("rises", "rises"),
            may("falls", "falls"),
        ],
        Some(&[
            "set", "detach", "attach", "lock", "free", "then", "map", "acts",
        ]),
        "event NAME = expression crosses value;",
    )),
];

/// Everything that may stand between the braces of a model.
pub fn top_level() -> impl Iterator<Item = &'static ItemWord> {
    ITEMS.iter()
}

/// The item of this keyword at the top (`inside` false) or inside a body or the world.
pub fn find(word: &str, inside: bool) -> Option<&'static ItemWord> {
    // Every word of a text is asked for: of most the first letter tells that they are none.
    let first = word.bytes().next();
    let is_word = |item: &&ItemWord| item.word.bytes().next() == first && item.word == word;
    if inside {
        [&FRAME, &START].into_iter().find(is_word)
    } else {
        ITEMS.iter().find(is_word)
    }
}

/// The item that this word may mark.
pub fn marked_by(word: &str) -> Option<&'static ItemWord> {
    ITEMS.iter().find(|item| item.mark == Some(word))
}

/// Whether a word begins an item that has a name and stands outside the braces of every other.
pub fn is_outside(word: &str) -> bool {
    find(word, false).is_some_and(|item| item.named)
}

/// The functions of an expression.
pub const FUNCTIONS: &[&str] = &[
    "norm",
    "dot",
    "cross",
    "min",
    "max",
    "abs",
    "exp",
    "sqrt",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "ln",
    "log10",
    "sign",
    "floor",
    "clamp",
    "smoothstep",
    "if",
    "angle",
    "polar",
];

/// The quantities that `emit` knows.
pub const EMITTED: &[&str] = &[
    "anchor_states",
    "equilibrium",
    "derivative",
    "balance",
    "guards",
    "outputs",
    "energy",
    "momentum",
    "mass_matrix",
    "bias_force",
    "forces",
    "inverse_dynamics",
    "gravity_force",
    "centre_of_mass",
    "centre_of_mass_jacobian",
    "frame_jacobian",
    "lines",
    "constraint",
    "constraint_jacobian",
    "constraint_rate",
    "constraint_bias",
    "multipliers",
    "reactions",
    "projection_step",
    "node_by_anchor",
    "condensed_stiffness",
    "partial",
];

/// Functions whose words a table may have, too: its name stands in front of a bracket, where others are functions.
const FREE_FUNCTIONS: &[&str] = &["floor", "sign", "clamp", "ln", "tan"];

/// Whether a word cannot be the name of a table: it is a function.
pub fn reserved_table(word: &str) -> bool {
    FUNCTIONS.contains(&word) && !FREE_FUNCTIONS.contains(&word)
}

/// The field that says how something begins.
pub const AT_START: &str = "at_start";

/// How a coordinate begins that stays where it is until an event frees it.
pub const LOCKED: &str = "locked";

/// The word before the start of a joint coordinate that gives way where loops do not close with it.
pub const ABOUT: &str = "about";

/// Words of the language that no name can be. Items and functions are none of them: what an item is begins it, and its name follows.
pub const OTHER_RESERVED: &[&str] = &[
    ABOUT,
    "model",
    "world",
    "from",
    "to",
    "on",
    "at",
    "in",
    "rotated",
    "crosses",
    "rises",
    "falls",
    "external",
    "time",
    "com",
    "diag",
    "full",
    "rpy",
    "euler_zyx",
    "matrix",
    "none",
    "loop",
];

/// Keywords of Rust that the language writes itself, or that name things of every module.
const OWN_KEYWORDS: &[&str] = &[
    "as", "const", "else", "false", "if", "in", "let", "loop", "mod", "pub", "self", "Self",
    "super", "true", "_",
];

/// The others, and what Rust takes for a pattern wherever a value gets a name: names here, with an underscore behind them where they become fields and
/// functions of Rust.
const KEYWORDS: &[&str] = &[
    "Some", "None", "Ok", "Err", "abstract", "async", "await", "become", "box", "break",
    "continue", "crate", "do", "dyn", "enum", "extern", "final", "fn", "for", "gen", "impl",
    "macro", "match", "move", "mut", "override", "priv", "ref", "return", "static", "struct",
    "trait", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while",
    "yield",
];

/// Whether a word is a keyword of Rust.
pub fn is_keyword(word: &str) -> bool {
    KEYWORDS.contains(&word) || OWN_KEYWORDS.contains(&word)
}

/// Whether a word is what a keyword becomes in Rust, or no name there at all.
fn is_unfit(word: &str) -> bool {
    let stem = word.strip_suffix('_').unwrap_or("");
    OWN_KEYWORDS.contains(&word)
        || KEYWORDS.contains(&stem)
        || word.starts_with("__")
        || word.starts_with("r#")
}

/// Why a word cannot be a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reserved {
    /// It has a meaning in the language.
    Language,
    /// Rust has it already, and it cannot be changed: `self`, what begins with two underscores.
    Rust,
}

/// Whether and why a word cannot be the name of an item.
pub fn reserved(word: &str) -> Option<Reserved> {
    let language = OTHER_RESERVED.contains(&word);
    if language {
        Some(Reserved::Language)
    } else if is_unfit(word) {
        Some(Reserved::Rust)
    } else {
        None
    }
}

/// Whether a word cannot be the name of a frame: it is a quantity of bodies, or a keyword.
pub fn reserved_frame(word: &str) -> bool {
    quantities::BODY_QUANTITIES.contains(&word)
        || ["com", "on", "at", "in", "from", "to", "rotated"].contains(&word)
        || is_unfit(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_described() {
        let text = include_str!("../../../LANGUAGE.md");
        let described: Vec<&str> = text
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .collect();
        let fields = ITEMS.iter().filter_map(|item| item.fields).flatten();
        let mut all: Vec<&str> = fields.copied().collect();
        all.extend(ITEMS.iter().map(|item| item.word));
        all.extend([FRAME.word, START.word]);
        all.extend([mbd_scene::joints::START_RATE.name]);
        for list in [
            FUNCTIONS,
            quantities::BODY_QUANTITIES,
            quantities::LINE_QUANTITIES,
        ] {
            all.extend(list);
        }
        all.extend(mbd_scene::joints::NUMBERS.iter().map(|field| field.name));
        all.retain(|word| !described.contains(word));
        assert!(all.is_empty(), "not described in LANGUAGE.md: {all:?}");
    }
}
