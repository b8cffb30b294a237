//! How many things a declaration declares, counted without the compiler, and how many a scene has.

use std::collections::BTreeMap;

use mbd_scene::Scene;
use mbd_scene::joints::JointLaw;
use toml::Table;

/// Per kind the number of things; `None` where a repetition has bounds that are not written as numbers.
pub type Counts = BTreeMap<&'static str, Option<usize>>;

/// The kinds that are counted.
const KINDS: &[&str] = &[
    "const", "param", "input", "table", "let", "state", "body", "point", "joint", "line", "spring",
    "load", "output", "event", "metric",
];

/// Those that may end at their name or at a place, where nothing but the next item tells it.
const WITHOUT_BRACES: &[&str] = &["table", "body", "point", "joint", "line", "spring"];

/// Words that may stand before the word of an item.
const MARKS: &[&str] = &["loop", "smooth"];

fn add(counts: &mut Counts, kind: &'static str, number: Option<usize>) {
    let slot = counts.entry(kind).or_insert(Some(0));
    *slot = slot.zip(number).map(|(sum, number)| sum + number);
}

fn none() -> Counts {
    KINDS.iter().map(|kind| (*kind, Some(0))).collect()
}

/// How often an item is there: `name` once, `name[i in 0..3]` three times.
fn times(name: &str) -> Option<usize> {
    let Some((_, rest)) = name.split_once('[') else {
        return Some(1);
    };
    let (_, range) = rest.split_once(" in ")?;
    let (range, _) = range.split_once(']')?;
    let (low, high) = range.split_once("..")?;
    let (high, more) = match high.trim().strip_prefix('=') {
        Some(high) => (high, 1),
        None => (high, 0),
    };
    let number = |text: &str| text.trim().parse::<i64>().ok();
    usize::try_from(number(high)? - number(low)? + more).ok()
}

/// The text without comments and strings: what is left of them is a space.
fn bare(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            comment(rest)
        } else if c == '"' {
            rest[1..].find('"').map_or(rest.len(), |end| end + 2)
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        out.push(' ');
        rest = &rest[skipped..];
    }
    out
}

/// The length of the comment that a text begins with; comments nest.
fn comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        let rest = &text.as_bytes()[at..];
        if rest.starts_with(b"/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest.starts_with(b"*/") {
            (depth, at) = (depth - 1, at + 2);
        } else {
            at += 1;
        }
        if depth == 0 {
            break;
        }
    }
    // A comment may end inside a letter only where it has no end.
    at.min(text.len())
}

/// What the text of a declaration declares, by the words that its items begin with.
#[must_use]
pub fn declared_in_text(text: &str) -> Counts {
    let mut counts = none();
    let text = bare(text);
    let Some((_, inside)) = text.split_once('{') else {
        return counts;
    };
    let (mut depth, mut start) = (0_i32, 0);
    let mut heads = Vec::new();
    for (at, c) in inside.char_indices() {
        match c {
            '{' | '[' | '(' => depth += 1,
            '}' | ']' | ')' => depth -= 1,
            _ => {}
        }
        if depth < 0 {
            // The last item may end with the braces of all.
            heads.push(&inside[start..at]);
            break;
        }
        if depth == 0 && matches!(c, ';' | '}') {
            heads.push(&inside[start..at]);
            start = at + 1;
        }
    }
    for head in heads.into_iter().flat_map(apart) {
        let mut words = head.trim_start();
        for mark in MARKS {
            words = words.strip_prefix(mark).unwrap_or(words).trim_start();
        }
        let end = words.find(|c| !letters(c)).unwrap_or(words.len());
        let (word, rest) = words.split_at(end);
        if let Some(kind) = KINDS.iter().find(|kind| **kind == word) {
            let rest = rest.trim_start();
            let end = rest.find(|c| !letters(c)).unwrap_or(rest.len());
            let named = rest[end..].trim_start();
            let repeated = named.starts_with('[');
            let number = match named.split_once('=') {
                _ if repeated => times(named),
                Some(("" | " ", value)) if word == "output" => Some(columns(value)),
                _ => Some(1),
            };
            add(&mut counts, kind, number);
        }
    }
    counts
}

fn letters(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Items that follow each other without a sign between them: `joint a: free from world to b.com joint c: …`.
fn apart(head: &str) -> Vec<&str> {
    let (mut items, mut head) = (Vec::new(), head);
    while let Some(end) = end_without_braces(head) {
        items.push(&head[..end]);
        head = &head[end..];
    }
    items.push(head);
    items
}

/// Where the next item begins behind one that has no braces.
fn end_without_braces(head: &str) -> Option<usize> {
    // Words and signs outside of brackets, with their places.
    let (mut parts, mut depth, mut at) = (Vec::new(), 0_i32, 0);
    while let Some(c) = head[at..].chars().next() {
        let word = head[at..].find(|c| !letters(c)).unwrap_or(head.len() - at);
        let length = word.max(c.len_utf8());
        match c {
            '{' | '[' | '(' => depth += 1,
            '}' | ']' | ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 && !c.is_whitespace() {
            parts.push((at, &head[at..at + length]));
        }
        at += length;
    }
    let own = parts.iter().position(|(_, part)| !MARKS.contains(part))?;
    if !WITHOUT_BRACES.contains(&parts[own].1) {
        return None;
    }
    let is_name =
        |part: Option<&(usize, &str)>| part.is_some_and(|(_, part)| part.starts_with(letters));
    // Behind its own word and its name.
    let next = (own + 2..parts.len()).find(|&at| {
        let [before, part] = [at - 1, at].map(|at| parts[at].1);
        let begins = KINDS.contains(&part)
            || (MARKS.contains(&part)
                && parts
                    .get(at + 1)
                    .is_some_and(|(_, next)| KINDS.contains(next)));
        let behind_place = (before.starts_with(letters)
            && !["from", "to", "on", "at"].contains(&before))
            || before == "]";
        begins && behind_place && is_name(parts.get(at + 1))
    })?;
    Some(parts[next].0)
}

/// How many columns an output of this value has that are told apart by numbers: a list of two numbers or of more than three is no vector.
fn columns(value: &str) -> usize {
    let Some(inside) = value.trim_start().strip_prefix('[') else {
        return 1;
    };
    let (mut depth, mut parts, mut last) = (0_i32, 1, 0);
    for (at, c) in inside.char_indices() {
        match c {
            '[' | '(' | '{' => depth += 1,
            ']' if depth == 0 => {
                let behind = inside[at + 1..].trim_start();
                // A comma may end a list.
                let ended = inside[last..at].trim().is_empty();
                let listed = parts - usize::from(ended && parts > 1);
                let whole = !behind.starts_with(['*', '/', '+', '-', '.', '[', '^', '%', '<', '>']);
                return if whole && ![0, 1, 3].contains(&listed) {
                    listed
                } else {
                    1
                };
            }
            ']' | ')' | '}' => depth -= 1,
            ',' if depth == 0 => (parts, last) = (parts + 1, at + 1),
            _ => {}
        }
    }
    1
}

/// What a document declares, by its keys; `None` if it is no TOML.
#[must_use]
pub fn declared_in_toml(text: &str) -> Option<Counts> {
    let document: Table = text.parse().ok()?;
    let mut counts = none();
    for kind in KINDS {
        let named = document.get(*kind).and_then(|value| value.as_table());
        for (name, value) in named.into_iter().flatten() {
            let number = match value.as_str().filter(|_| *kind == "output") {
                Some(value) if !name.contains('[') => Some(columns(&bare(value))),
                _ => times(name),
            };
            add(&mut counts, kind, number);
        }
    }
    Some(counts)
}

/// What a scene has.
#[must_use]
pub fn resolved(scene: &Scene) -> Counts {
    let springs = scene
        .lines
        .iter()
        .filter(|line| !line.kind.is_unilateral())
        .count();
    // The value of a metric is an output of its name.
    let metrics = scene.runs.metrics.iter();
    let own = metrics.filter(|metric| {
        let output = metric.output.and_then(|output| scene.outputs.get(output));
        output.is_some_and(|output| output.name == metric.name)
    });
    let outputs = scene.outputs.len() - own.count();
    // Filters of motors bring states of their own: `pin.angle`.
    let states = scene.states.iter();
    let states = states.filter(|state| !state.name.contains('.')).count();
    let locks = scene.joints.iter();
    let locks = locks.filter(|joint| matches!(joint.law, JointLaw::Lock(_)));
    let joints = scene.joints.len() - locks.count();
    let numbers = [
        ("const", scene.consts.len()),
        ("param", scene.params.len()),
        ("input", scene.inputs.len()),
        ("table", scene.tables.len()),
        ("let", scene.lets.len()),
        ("state", states),
        ("body", scene.bodies.len()),
        ("point", scene.points.len()),
        ("joint", joints),
        ("line", scene.lines.len() - springs),
        ("spring", springs),
        ("load", scene.loads.len()),
        ("output", outputs),
        ("event", scene.events.len()),
        ("metric", scene.runs.metrics.len()),
    ];
    numbers.map(|(kind, number)| (kind, Some(number))).into()
}
