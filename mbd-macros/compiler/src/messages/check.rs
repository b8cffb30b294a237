//! Messages of checking: what is wrong with the scene as a whole.

use mbd_scene::Plane;

use super::LexemeMessage;
use crate::lexeme::Region;
use crate::syntax::words::ItemWord;

pub fn lost(at: Region, item: &ItemWord) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "this `{}` was not understood and would be left out; the form is `{}`",
            item.word, item.form
        ),
    )
}

pub fn empty(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("model `{name}` has nothing that moves: declare a `body` or a `point`"),
    )
}

pub fn floating(at: Region, body: &str) -> LexemeMessage {
    let free = free(body);
    LexemeMessage::new(
        at,
        format!("body `{body}` is attached to nothing: add `{free}`"),
    )
}

pub fn on_points(at: Region, body: &str) -> LexemeMessage {
    let free = free(body);
    LexemeMessage::new(
        at,
        format!(
            "body `{body}` is held by points alone, which fly: say that it does, too, by `{free}`"
        ),
    )
}

pub fn no_inertia_in_absolute(at: Region, body: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "body `{body}` has no mass, or a moment of inertia that is not positive: absolute coordinates give every body six speeds of its own, which need both. declare `coordinates: relative;`, where what it carries gives its joints an inertia"
        ),
    )
}

pub fn carries_nothing(at: Region, body: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "body `{body}` has no mass and carries nothing that has any, so that its acceleration is not determined: give it a `mass`, or make its joint `rigid`"
        ),
    )
}

pub fn lone_index(at: Region, kind: &str, word: &str, count: i64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "this is one {kind}, called `{word}[{count}]`: {count} of them are `{kind} {word}[i in 0..{count}]`"
        ),
    )
    .about(word, None)
}

/// `frames`: those of its own.
pub fn body_as_place(at: Region, body: &str, frames: &[String]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{body}` stands here for its centre of mass: write `{body}.com` if that is meant, or the frame that is: {}",
            frames.join(", ")
        ),
    )
    .about(body, None)
}

/// The joint that lets a body fly; that of `bar[0]` is `bar_free[0]`.
fn free(body: &str) -> String {
    let (word, index) = body.split_at(body.find('[').unwrap_or(body.len()));
    format!("joint {word}_free{index}: free from world to {body}.com;")
}

pub fn floating_together(at: Region, bodies: &[&str]) -> LexemeMessage {
    let list: Vec<String> = bodies.iter().map(|body| format!("`{body}`")).collect();
    let first = bodies.first().copied().unwrap_or_default();
    LexemeMessage::new(
        at,
        format!(
            "bodies {} are joined to each other, but nothing joins them to the world: add `{}`",
            list.join(", "),
            free(first)
        ),
    )
}

pub fn two_joints(at: Region, body: &str, first: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("body `{body}` has two free joints: one is enough"),
    )
    .also(first, "the first is here")
}

pub fn lonely(at: Region, point: &str, lines: usize) -> LexemeMessage {
    let lines = if lines == 1 {
        "1 line".to_string()
    } else {
        format!("{lines} lines")
    };
    LexemeMessage::new(
        at,
        format!(
            "massless point `{point}` is the end of {lines}: at least 2 are needed for its equilibrium"
        ),
    )
}

pub fn same_ends(at: Region, kind: &str, name: &str, place: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("{kind} `{name}` goes from `{place}` to itself"))
}

pub fn one_body(at: Region, kind: &str, name: &str, owner: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("both ends of {kind} `{name}` are on {owner}: it can never move anything"),
    )
}

pub fn line_at_node(at: Region, kind: &str, name: &str, point: &str, why: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "{kind} `{name}` ends at the massless point `{point}`, {why}, or give the point a mass: `point {point} {{ mass: 0.1 kg }}`"
        ),
    )
}

pub fn mixed_models(at: Region, point: &str, other: &str, first: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "points `{other}` and `{point}` are joined by lines and solved together: give them the same `equilibrium`"
        ),
    )
    .also(first, format!("`{other}` is declared here"))
}

pub fn rate_undamped(at: Region, point: &str, line: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "point `{point}` is `rate`, but line `{line}` has no damping: `rate` needs damping on every line of the point. add `damping: …`, or use `equilibrium: stepwise`"
        ),
    )
}

pub fn rate_tied(at: Region, point: &str, other: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "point `{point}` is `rate`, but a line joins it to the massless point `{other}`: use `equilibrium: stepwise` for both"
        ),
    )
}

pub fn dropped_damping(at: Region, point: &str, line: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "point `{point}` is `static`: the damping of its line `{line}` is dropped; `stepwise` or `rate` keep it"
        ),
    )
    .about(point, None)
}

pub fn untold_load_rate(at: Region, point: &str, load: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "how fast the massless point `{point}` moves follows from how fast its load `{load}` changes, which is told of loads that follow places, coordinates, states, inputs and time alone: give the point a `mass`, or damp its lines and declare `equilibrium: stepwise`"
        ),
    )
    .about(point, None)
}

pub fn undecided_point(at: Region, point: &str, place: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "nothing decides where the massless point `{point}` is: all its lines go to `{place}` and no load acts on it; lead one of them elsewhere, or let a load pull"
        ),
    )
    .about(point, None)
}

pub fn unused(at: Region, kind: &'static str, name: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("{kind} `{name}` is declared but never used"))
        .about(name, Some(kind))
}

pub fn no_loop(at: Region, name: &str, owner: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("joint `{name}` is marked `loop` but closes none: remove `loop`"),
    )
    .also(owner, "this is attached by it")
}

pub fn apart(
    at: Region,
    joint: &str,
    (plane, normal): (&str, &str),
    [parent, child]: &[String; 2],
    gap: f64,
) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "joint `{joint}` can never close in the plane `{plane}`: `{parent}` and `{child}` are {gap:.3} m apart along {normal}. give both frames the same {normal}"
        ),
    )
}

pub fn leaning(
    at: Region,
    joint: &str,
    (plane, normal): (&str, &str),
    [parent, child]: &[String; 2],
) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "joint `{joint}` can never close in the plane `{plane}`: the axes that it holds together lean differently against {normal} at `{parent}` and at `{child}`. rotate both frames alike, but for turns about {normal}"
        ),
    )
}

pub fn still(at: Region, coordinate: &str, plane: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a joint couples `{coordinate}`, which nothing in the plane `{plane}` changes: remove that joint, or choose another axis"
        ),
    )
}

/// A note: on a table top nothing falls.
pub fn gravity_across(plane: &str, normal: &str) -> String {
    format!(
        "gravity is along {normal}, across the plane `{plane}`, which carries it: nothing falls in the plane"
    )
}

/// A note: `planar: auto` took a plane.
pub fn in_plane(plane: &str) -> String {
    format!(
        "planar: {plane}: nothing leaves this plane; what it carries across is in no reaction (`planar: auto`)"
    )
}

/// A note: `planar: auto` took none.
pub fn in_no_plane(why: &str) -> String {
    format!("`planar: auto` takes no plane, everything moves in space: {why}")
}

/// A note: `coordinates: auto` took points for bodies.
pub fn as_points(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    format!(
        "compiled as points with mass, because nothing turns them and nothing asks how they are turned (`coordinates: auto`): {}",
        names.join(", ")
    )
}

/// The axis of a joint in a plane, and what moves there.
pub struct AxisInPlane {
    /// It turns about its axis; or slides along it.
    pub turns: bool,
    /// Its axis as it is declared.
    pub own: String,
    /// About what bodies turn there, or along what they slide.
    pub moves: String,
    /// The letters of the axes that fit.
    pub better: Vec<&'static str>,
    /// The plane in which bodies turn about the axis that it has.
    pub plane: Option<&'static str>,
}

impl AxisInPlane {
    /// `it turns about z, and there bodies turn about y`
    fn told(&self) -> String {
        let (own, moves) = (&self.own, &self.moves);
        match self.turns {
            true => format!("it turns about {own}, and there bodies turn about {moves}"),
            false => format!("it slides along {own}, and there bodies slide along {moves}"),
        }
    }

    /// `write `axis: y``
    fn remedy(&self) -> String {
        let better: Vec<String> = (self.better.iter())
            .map(|letter| format!("`axis: {letter}`"))
            .collect();
        match better.as_slice() {
            [] => "choose another axis".to_owned(),
            better => format!("write {}", better.join(" or ")),
        }
    }
}

pub fn apart_by_its_axis(
    at: Region,
    joint: &str,
    (plane, normal): (&str, &str),
    [parent, child]: &[String; 2],
    gap: f64,
    axis: &AxisInPlane,
) -> LexemeMessage {
    let instead = axis.plane.map_or_else(String::new, |plane| {
        format!("choose `planar: {plane};`, or ")
    });
    LexemeMessage::new(
        at,
        format!(
            "joint `{joint}` can never close in the plane `{plane}`: {}. {instead}{} and give both frames the same {normal}: `{parent}` and `{child}` are {gap:.3} m apart along it",
            axis.told(),
            axis.remedy()
        ),
    )
}

/// `fields`: what is said of the coordinate; `axis`: of a joint that has one, which does not move in the plane.
pub fn never_acts(
    at: Region,
    coordinate: &str,
    plane: &str,
    fields: &[&str],
    axis: Option<&AxisInPlane>,
) -> LexemeMessage {
    let why = axis.map_or_else(String::new, |axis| format!(": {}", axis.told()));
    let remedy = axis.map_or_else(|| "choose another axis".to_owned(), AxisInPlane::remedy);
    let out = match fields {
        [_] => "leave it out",
        _ => "leave them out",
    };
    LexemeMessage::new(
        at,
        format!(
            "nothing in the plane `{plane}` changes `{coordinate}`, so that its {} can never act{why}. {remedy}, or {out}",
            quoted(fields)
        ),
    )
}

/// A joint that allows no motion in the plane; `coordinate`: its first one.
pub fn holds_in_plane(
    at: Region,
    joint: &str,
    coordinate: &str,
    plane: &str,
    axis: Option<&AxisInPlane>,
) -> LexemeMessage {
    let why = axis.map_or_else(
        || format!("nothing there changes `{coordinate}`"),
        AxisInPlane::told,
    );
    let remedy = axis.map_or_else(|| "choose other axes".to_owned(), AxisInPlane::remedy);
    LexemeMessage::new(
        at,
        format!(
            "joint `{joint}` allows no motion in the plane `{plane}`: {why}. {remedy}, or `rigid` if it is to hold"
        ),
    )
    .about(joint, None)
}

/// `` `a`, `b` and `c` ``
fn quoted(words: &[&str]) -> String {
    let words: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
    match words.as_slice() {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        words => words.concat(),
    }
}

pub fn idle_motor(sentence: &str) -> String {
    format!("{sentence}; leave this motor out, or take away what holds it")
}

pub fn idle_lock(sentence: &str) -> String {
    format!("{sentence}: lock another coordinate, or take away what holds this one")
}

pub fn immovable(model: &str, rows: usize, speeds: usize) -> String {
    let held = match speeds {
        0 => "its joints leave its bodies no coordinate".to_owned(),
        _ => format!("the {rows} rows of its joints hold all {speeds} speeds"),
    };
    format!("model `{model}` cannot move: {held}; take a joint away, or one that forbids less")
}

pub fn across_the_plane(model: &str, coordinate: &str, plane: Plane) -> String {
    let axes = ["x", "y", "z"];
    let normal = plane.normal();
    let across = axes.get(normal).copied().unwrap_or_default();
    let within: Vec<&str> = axes.into_iter().filter(|axis| *axis != across).collect();
    format!(
        "model `{model}` cannot move: nothing in the plane `{}` changes `{coordinate}`. there bodies turn about {across} and slide along {}: choose that axis",
        plane.word(),
        within.join(" and ")
    )
}
