//! What is wrong in a document is told at its place, with what to write.

use super::*;

#[test]
fn mistakes_in_toml_are_told_with_line_and_column() {
    let cases: &[(&str, &str, &[&str])] = &[
        (
            "link.top\"\nfree",
            "link.tpo\"\nfree",
            &[
                "scene.toml:34:12: body `link` has no frame `tpo`; did you mean `top`? its frames: top, tip, com",
            ],
        ),
        (
            "world.anchor",
            "world.anchro",
            &[
                "scene.toml:33:15: the world has no frame `anchro`; did you mean `anchor`? its frames: anchor",
            ],
        ),
        (
            "\"1 kN/m\"",
            "\"1 kN\"",
            &["scene.toml:36:14: `stiffness` must be in N/m, this is a force (N)"],
        ),
        (
            "\"2.0 kg\"",
            "2.0",
            &[
                "scene.toml:11:9: `mass` needs a unit: mass (kg). write it as `2.0 kg`, or put `units: si;` at the top of the model",
            ],
        ),
        (
            "stiffness",
            "stifness",
            &[
                "scene.toml:36:1: unknown field `stifness`; did you mean `stiffness`? fields here: free_length, stiffness, force, damping, at_start",
            ],
        ),
        (
            "kind = \"free\"",
            "kind = \"revolute\"",
            &["scene.toml:28:9: unknown joint `revolute`; here it is called `hinge`"],
        ),
        (
            "diag(0.17, 0.17, 0.02)",
            "diag(0.17, 0.017, 0.002)",
            &[
                "scene.toml:23:12: no rigid body has these principal moments: the largest (0.17) exceeds the sum of the other two (0.019). check the unit, and that it is about the centre of mass",
            ],
        ),
        (
            "1 kg ..= 3 kg",
            "3 kg ..= 4 kg",
            &[
                "scene.toml:11:10: the default of `mass` lies outside its own range\nscene.toml:12:7: its range",
            ],
        ),
        (
            "from = \"world.anchor\"\n",
            "",
            &[
                "scene.toml:32:8: this line has no `from`: write `line.cord = { from = \"world\", to = \"bob\", free_length = \"1 m\", stiffness = \"2 kN/m\" }`; its keys: from, to, free_length, stiffness, force, damping, at_start",
            ],
        ),
        (
            "* (link.tip.velocity",
            "* (link.tip.velocty",
            &[
                "scene.toml:43:13: `link.tip` has no quantity `velocty`; did you mean `velocity`? known: position, velocity, acceleration, x, y, z",
            ],
        ),
        (
            "[body.link]",
            "[event.low]\nvalue = \"link.position.z\"\nfall = \"-1 m\"\n[body.link]",
            &["scene.toml:23:1: unknown field `fall`; did you mean `falls`?"],
        ),
        (
            "[body.link]",
            "[bdy.link]",
            &[
                "scene.toml:21:2: unknown item `bdy`; did you mean `body`? items here: coordinates, angular_velocity, planar, origin, units, gravity, emit, urdf, extend, verify, const, param, input, state, table, let, world, body, point, joint, line, spring, load, output, metric, event",
            ],
        ),
        (
            "mass = \"mass\"",
            "mass = [\"mass\"",
            &[
                "scene.toml:23:1: this is no TOML: missing comma between array elements, expected `,`",
            ],
        ),
        (
            "model = \"Link<T>\"",
            "",
            &["scene.toml:1:1: the scene has no name: add `model = \"Name\"` at its top"],
        ),
        (
            "verify = true",
            "verify = 1",
            &["scene.toml:5:1: `verify` is `true` or `false`"],
        ),
        (
            "[load.drag]\non",
            "[load.drag]\nunit = \"N\"\non",
            &[
                "scene.toml:39:1: unknown field `unit`; here it is called `in`. fields here: on, at, kind, value, in",
            ],
        ),
        (
            "value = \"side[0].tension\"",
            "value = true",
            &[
                "scene.toml:49:9: write this as a string in the language of `model!`, such as `\"2.0 kg\"`",
            ],
        ),
        (
            "pull = \"side[1].tension\"",
            "pull = \"side[1].tension + (1.0 N\"",
            &["scene.toml:46:27: this `(` is never closed: add `)`"],
        ),
        (
            "\"link.com\"",
            "\"link\\u002ecmo\"",
            &[
                "scene.toml:30:6: body `link` has no frame `cmo`; did you mean `com`? its frames: top, tip, com",
            ],
        ),
    ];
    for (old, new, wanted) in cases {
        assert_eq!(with(old, new), *wanted, "{new}");
    }
}

/// A body with one thing of every kind that may be repeated, `[?]` in the place of the repetition.
const REPEATED: &[(&str, &str)] = &[
    (
        "world frame",
        "[world.frame]\n\"hook[?]\" = \"[0, 0, 1] m\"",
    ),
    ("frame", "[body.base.frame]\n\"eye[?]\" = \"[0, 0, 1] m\""),
    (
        "body",
        "[body.\"link[?]\"]\nmass = \"1 kg\"\ninertia = \"diag(1, 1, 1) kg*m^2\"",
    ),
    ("point", "[point.\"knot[?]\"]\nmass = \"1 kg\""),
    (
        "joint",
        "[joint.\"hold[?]\"]\nkind = \"spherical\"\nfrom = \"world\"\nto = \"base.top\"",
    ),
    (
        "line",
        "[line.\"side[?]\"]\nfrom = \"world\"\nto = \"base.top\"\nfree_length = \"1 m\"\nstiffness = \"1 kN/m\"",
    ),
    (
        "spring",
        "[spring.\"coil[?]\"]\nfrom = \"world\"\nto = \"base.top\"\nfree_length = \"1 m\"\nstiffness = \"1 kN/m\"",
    ),
    (
        "load",
        "[load.\"push[?]\"]\non = \"base\"\nat = \"com\"\nvalue = \"[1, 0, 0] N\"",
    ),
    ("output", "[output]\n\"height[?]\" = \"base.position.z\""),
    (
        "event",
        "[event.\"low[?]\"]\nvalue = \"base.position.z\"\nfalls = \"0 m\"",
    ),
];

fn repeated(item: &str, repetition: &str) -> Reading {
    let base = r#"
model = "Base"
gravity = "none"
[joint.base_free]
kind = "free"
from = "world"
to = "base.com"
[body.base]
mass = "1 kg"
inertia = "diag(1, 1, 1) kg*m^2"
frame.top = "[0, 0, 1] m"
"#;
    let item = item.replace("?", repetition);
    match item.strip_prefix("[body.base.frame]\n") {
        Some(frame) => read_toml(&format!("{base}frame.{frame}\n")),
        None => read_toml(&format!("{base}{item}\n")),
    }
}

/// How many things of a kind the scene above has beside its base.
fn count(scene: &Scene, kind: &str) -> usize {
    match kind {
        "world frame" => scene.world_frames.len() - 1,
        "frame" => scene.bodies[0].frames.len() - 2,
        "body" => scene.bodies.len() - 1,
        "point" => scene.points.len(),
        "joint" => scene.joints.len() - 1,
        "load" => scene.loads.len(),
        "output" => scene.outputs.len(),
        "event" => scene.events.len(),
        _ => scene.lines.len(),
    }
}

#[test]
fn as_many_things_are_resolved_as_are_declared_or_the_repetition_is_an_error() {
    let floating = "is attached to nothing";
    for (kind, item) in REPEATED {
        for (repetition, number) in [
            ("i in 0..3", 3),
            ("i in 2..=3", 2),
            ("i in 1..1", 0),
            ("4", 1),
        ] {
            let reading = repeated(item, repetition);
            let told = told(&reading);
            let serious: Vec<&String> = told.iter().filter(|t| !t.contains(floating)).collect();
            assert!(serious.is_empty(), "{kind} [{repetition}]: {serious:?}");
            assert_eq!(
                count(&reading.skeleton, kind),
                number,
                "{kind} [{repetition}]"
            );
        }
        for repetition in [
            "1 in 0..3",
            "< in 0..3",
            "* in 0..3",
            "1.5 in 0..3",
            "{} in 0..3",
            "in 0..3",
            "i in",
            "i in 0",
            "i in 0..",
            "i in ..3",
            "i on 0..3",
            "i, in 0..3",
            "i in 0..3, 4",
            "i",
            "*",
            "",
        ] {
            let reading = repeated(item, repetition);
            let told = told(&reading);
            assert!(reading.scene.is_none(), "{kind} [{repetition}] was read");
            assert!(
                told.iter().all(|told| told.contains("[i in 0..3]")
                    || told.contains("index")
                    || told.contains("is named")
                    || told.contains("expected")),
                "{kind} [{repetition}]: {told:?}"
            );
            assert_eq!(told.len(), 1, "{kind} [{repetition}]: {told:?}");
        }
    }
    assert_eq!(
        told(&repeated(REPEATED[1].1, "1 in 0..3")),
        [
            "scene.toml:12:12: expected the name of an index before `in`, found `1`: write a word, such as `eye[i in 0..3]`"
        ]
    );
}

#[test]
fn no_toml_makes_the_reader_panic() {
    let mut seed = 0x5EED_u64;
    let mut below = |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize % n
    };
    let signs: Vec<char> = "\"'[]{}=.,\n#\\ 0azé²^*".chars().collect();
    for _ in 0..5_000 {
        let mut text: Vec<char> = LINK.chars().collect();
        for _ in 0..=below(4) {
            let at = below(text.len());
            match below(3) {
                0 => drop(text.remove(at)),
                1 => text[at] = signs[below(signs.len())],
                _ => text.insert(at, signs[below(signs.len())]),
            }
        }
        let text: String = text.into_iter().collect();
        let reading = read_toml(&text);
        assert!(reading.scene.is_some() != reading.errors.iter().any(|e| !e.places.is_empty()));
    }
}

#[test]
fn words_of_a_document_that_are_not_ours_are_answered() {
    let answers = [
        (
            "[body.rod]\nmass = \"1 kg\"\nframe.m[0] = \"[0, 0, 1] m\"",
            "scene.toml:5:8: a name with an index stands in quotes as a key of TOML: `\"m[0]\"`",
        ),
        (
            "[body.link[0]]\nmass = \"1 kg\"",
            "a name with an index stands in quotes as a key of TOML: `\"link[0]\"`",
        ),
        (
            "[bodies.rod]\nmass = \"1 kg\"",
            "unknown item `bodies`; here it is called `body`",
        ),
        (
            "name = \"A\"",
            "unknown item `name`; the name of a scene is that of its model: `model Name { … }`, in TOML `model = \"Name\"`",
        ),
        ("mass == \"1 kg\"", "this is no TOML"),
    ];
    for (lines, answer) in answers {
        let told = told(&read_toml(&format!(
            "model = \"A\"\ngravity = \"none\"\n{lines}\n"
        )));
        assert!(told.join("\n").contains(answer), "{told:?}");
    }
}

#[test]
fn keys_that_people_guess_are_answered_once_with_what_is_written() {
    let answers = [
        (
            "[param.k]\ndefault = \"3 m\"",
            "unknown field `default`; here it is called `value`",
        ),
        (
            "[let]\na = { vlaue = \"3 m\" }",
            "unknown field `vlaue`; did you mean `value`?",
        ),
        (
            "[output.o]\nexpression = \"1 m\"",
            "unknown field `expression`; here it is called `value`",
        ),
        (
            "[load.push]\non = \"bob\"\nforce = \"[0, 0, 1] N\"",
            "unknown field `force`; here it is called `value`",
        ),
        (
            "[metric.m]\nlargest = \"bob.position.z\"",
            "this metric has no `value`: write `metric.highest = { value = \"max bob.position.z\", from = \"1 s\" }`",
        ),
        (
            "[joint.j]\ntype = \"hinge\"\nfrom = \"world\"\nto = \"bob\"",
            "this joint has no `kind`; `type` is here called `kind`: write `joint.pin = {",
        ),
        (
            "[line.l]\nparent = \"world\"\nto = \"bob\"",
            "this line has no `from`; `parent` is here called `from`: write",
        ),
        (
            "[constants]\nlong = \"1 m\"",
            "unknown item `constants`; here it is called `const`",
        ),
        (
            "[const]\nlong = 3.5 m",
            "write a value with its unit in quotes: `long = \"3.5 m\"`",
        ),
        (
            "[event.e]\nwhen = \"time rises 1 s\"",
            "this event has no `value`; `when` is here called `value`: write `event.low = { value = \"bob.position.z\", falls = \"-1 m\" }`",
        ),
        (
            "[event]\ne = \"time rises 1 s\"",
            "in TOML `rises` is a key of its own: `{ value = \"bob.position.z\", rises = \"1 m\" }`",
        ),
        (
            "[table.rho]\n\"0 km\" = \"1 kg\"\n\"1 km\" = \"2 kg\"",
            "this table has no `value`: write `table.rho = \"{ 0 km: 0.0145 kg/m^3, 10 km: 0.006 kg/m^3 }\"`",
        ),
        (
            "[input.wind]\ndoc = \"from the west\"",
            "what `wind` measures is open: give its kind, `input wind: force;`, a value, `input wind = 6 V;`, or both, `input wind: force = 2 N;`; in TOML `kind` and `value`",
        ),
        ("[input]\nwind = \"west\"", "unknown quantity `west`"),
        (
            "[input]\nwind = \"speed = [8, 0, 0] m/s\"",
            "in TOML the default of an input is a key of its own: `{ kind = \"speed\", value = \"[8, 0, 0] m/s\" }`",
        ),
        (
            "[body.rod]\nmass = \"1 kg\"\ninertia = \"diag(1, 1, 1) kg*m^2\"\nfram.top = \"[0, 0, 1] m\"\n[joint.pin]\nkind = \"hinge\"\nfrom = \"world\"\nto = \"rod.com\"\naxis = \"y\"",
            "unknown field `fram`; did you mean `frame`?",
        ),
        (
            "[rnu]\nuntil = \"3 s\"",
            "unknown item `rnu`; did you mean `run`?",
        ),
    ];
    for (lines, answer) in answers {
        let document =
            format!("model = \"A\"\ngravity = \"none\"\npoint.bob.mass = \"1 kg\"\n{lines}\n");
        let told = told(&read_toml(&document));
        assert!(
            told.len() == 1 && told[0].contains(answer),
            "{lines}: {told:#?}"
        );
    }
}

/// What a message says to write.
#[test]
fn the_forms_that_messages_of_toml_propose_are_read() {
    let document = "model = \"A\"\ngravity = \"none\"\n\
        const.L = \"2.1 m\"\n\
        param.m_tip = { value = \"761 kg\", in = \"600 kg ..= 900 kg\" }\n\
        input.wind = { kind = \"speed\", value = \"[8, 0, 0] m/s\" }\n\
        state.seen = { start = \"0 m\", rate = \"(bob.position.x - seen) / (20 ms)\" }\n\
        table.rho = \"{ 0 km: 0.0145 kg/m^3, 10 km: 0.006 kg/m^3 }\"\n\
        let.speed = \"norm(bob.velocity)\"\n\
        load.push = { on = \"rod\", at = \"tip\", value = \"[0, 0, 5] N\" }\n\
        output.bend = { value = \"pin.angle\", in = \"deg\" }\n\
        metric.highest = { value = \"max bob.position.z\", from = \"1 s\" }\n\
        event.low = { value = \"bob.position.z\", falls = \"-1 m\" }\n\
        joint.pin = { kind = \"hinge\", from = \"world\", to = \"rod.tip\", axis = \"y\" }\n\
        point.bob.mass = \"1 kg\"\n\
        [body.rod]\nmass = \"1 kg\"\ninertia = \"diag(1, 1, 1) kg*m^2\"\nframe.tip = \"[0, 0, 1] m\"\n";
    let read = read_toml(document);
    assert!(read.scene.is_some(), "{:?}", told(&read));
}
