//! What an expansion looks like: golden files, rewritten by `UPDATE_GOLDEN=1 cargo test -p mbd-compiler`.

mod scenes;

use std::collections::BTreeMap;

use mbd_compiler::{
    EmitSettings, NameSpans, SceneEquations, compile, emit, emit_model, immovable, read_text,
};
use mbd_scene::{Layout, Packed, Plan, Scene};
use proc_macro2::TokenStream;

fn formatted(tokens: TokenStream) -> String {
    let file: syn::File =
        syn::parse2(tokens.clone()).unwrap_or_else(|error| panic!("not Rust: {error}\n{tokens}"));
    prettyplease::unparse(&file)
}

/// Expands `tests/golden/<name>.mbd` and compares with `tests/golden/<name>.rs`.
fn compare(name: &str) {
    let path = |extension: &str| {
        format!(
            "{}/tests/golden/{name}.{extension}",
            env!("CARGO_MANIFEST_DIR")
        )
    };
    let declaration =
        std::fs::read_to_string(path("mbd")).expect("the declaration is part of the repository");
    let reading = read_text(&declaration);
    assert!(reading.errors.is_empty(), "{}", reading.errors[0]);
    let text = formatted(emit(&reading));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(path("rs"), &text).expect("the golden folder can be written");
    }
    let golden = std::fs::read_to_string(path("rs")).unwrap_or_default();
    let differs = golden.lines().zip(text.lines()).position(|(a, b)| a != b);
    assert!(
        golden == text,
        "{name} differs from its golden file in line {:?}; if that is meant, run with UPDATE_GOLDEN=1",
        differs.map(|line| line + 1)
    );
}

#[test]
fn a_scene_of_three_points_and_four_lines_reads_as_expected() {
    compare("knot");
}

#[test]
fn the_parachute_reads_as_expected() {
    compare("parachute");
}

/// The names of the terms of an expansion, known numbers apart.
fn terms(text: &str) -> Vec<&str> {
    let lets = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("let "));
    let lets = lets.filter(|rest| !rest.starts_with('[') && !rest.contains("= T::from_f64("));
    lets.filter_map(|rest| rest.split_once(" = "))
        .flat_map(|(names, _)| names.trim_matches(['(', ')']).split(", "))
        .collect()
}

/// Whether a term is called by a number: `elbow_t`, `elbow_t_31`, or the name of another term with a number.
fn is_numbered(name: &str) -> bool {
    let last = name.rsplit('_').next().unwrap_or_default();
    last == "t" || last.bytes().all(|byte| byte.is_ascii_digit())
}

#[test]
fn most_terms_of_a_double_pendulum_have_a_name_and_every_part_a_heading() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/pass/double_pendulum.mbd"
    );
    let declaration = std::fs::read_to_string(path).expect("part of the repository");
    let text = formatted(emit(&read_text(&declaration)));
    let (_, functions) = text.split_once("fn derivative<").expect("emitted");
    let terms = terms(functions);
    let numbered = terms.iter().filter(|name| is_numbered(name)).count();
    assert!(terms.len() > 800);
    assert!(
        10 * numbered <= 3 * terms.len(),
        "{numbered} of {} terms are numbered",
        terms.len()
    );
    for heading in [
        "/// `upper`: where it is, how it moves.",
        "/// `elbow`: rows.",
        "/// `lower`: backward, taken out of the system.",
        "/// `upper`: forward, what it does.",
    ] {
        assert!(text.contains(heading), "{heading}");
    }
    // The elimination stands there once; multipliers and reactions take it from there.
    let (_, multipliers) = text.split_once("fn multipliers<").expect("emitted");
    let (multipliers, _) = multipliers.split_once("/// Reactions").expect("emitted");
    assert!(multipliers.contains("solution(") && multipliers.lines().count() < 30);
    let place = |what: &str| {
        text.find(what)
            .unwrap_or_else(|| panic!("{what} is missing"))
    };
    let order = [
        "pub fn new",
        "pub fn derivative",
        "pub fn outputs",
        "pub const NQ",
        "fn derivative<",
    ];
    assert!(
        order.map(place).is_sorted(),
        "what a user needs comes first"
    );
}

#[test]
fn kernels_are_named_after_what_they_do() {
    let chain = "pub model Chain {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [energy];
        body rod[i in 0..8] { mass: 1 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2,
            frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
        joint hold: hinge from world to rod[0].top { axis: y }
        joint pin[i in 1..8]: hinge from rod[i - 1].end to rod[i].top { axis: y }
    }";
    let text = formatted(emit(&read_text(chain)));
    for name in [
        "rod_motion",
        "pin_rows",
        "rod_backward",
        "rod_forward",
        "rod_projection_step",
    ] {
        assert!(text.contains(&format!("fn {name}(")), "{name}");
    }
    // Over any scalar they say so, and nothing else differs but how known numbers are written.
    let over_any = chain.replace("model Chain", "model Chain<T>");
    let over_any = formatted(emit(&read_text(&over_any)));
    assert!(over_any.contains("fn rod_motion<T: ::mbd_runtime::Real>("));
    assert!(text.contains("type T = f64;") && !over_any.contains("type T"));
}

#[test]
fn the_same_scene_gives_the_same_tokens() {
    for scene in scenes::all() {
        let settings = EmitSettings {
            verify: true,
            ..EmitSettings::default()
        };
        let text = || {
            formatted(emit_model(
                &SceneEquations::trace(&scene),
                &NameSpans::default(),
                &settings,
            ))
        };
        assert_eq!(text(), text());
    }
}

#[test]
fn a_packed_scene_is_the_scene() {
    let mut all = scenes::all();
    for entry in
        std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/pass")).expect("there")
    {
        let text = std::fs::read_to_string(entry.expect("readable").path()).expect("readable");
        all.extend(read_text(&text).scene);
    }
    assert!(all.len() > 12);
    for scene in all {
        let text = scene.packed();
        assert_eq!(Scene::unpacked(&text).as_ref(), Some(&scene), "{text}");
        assert_eq!(Scene::unpacked(&text[..text.len() - 1]), None);
        assert_eq!(Scene::unpacked(&format!("{text}0 ")), None);
        let layout = Layout::new(&scene);
        let plan = layout.plan();
        assert_eq!(Plan::unpacked(&plan.packed()).as_ref(), Some(&plan));
        assert_eq!(Layout::planned(&scene, plan), layout);
    }
    assert_eq!(Scene::unpacked("9999999999999999999 "), None);
}

#[test]
fn after_an_error_every_name_is_still_there() {
    let tokens: TokenStream = "pub model Kite<T> {
        gravity: none;
        param area = 2.0 m^2;
        input wind: [speed; 3];
        body kite { mass: 2.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
        line tether from world to kite.brdle { free_length: 1 m, stiffness: 1 kN/m }
        load rudder on kite at com: external;
        output pull = area * 1 N/m^2;
    }"
    .parse()
    .expect("tokens");
    let text = formatted(compile(tokens));
    for name in [
        "compile_error",
        "pub struct KiteParams",
        "pub area: T",
        "pub struct KiteOutputs",
        "pub pull: T",
        "pub struct KiteInputs",
        "pub wind: [T; 3]",
        "pub rudder: ::mbd_runtime::Wrench<T>",
        "pub fn derivative",
        "for Kite<T>",
    ] {
        assert!(text.contains(name), "{name} is missing");
    }
}

#[test]
fn a_refused_name_of_rust_breaks_nothing_else() {
    let tokens: TokenStream = "model Weight { gravity: none; point r#type { mass: 1 kg } }"
        .parse()
        .expect("tokens");
    // Formatting reads it as Rust.
    let text = formatted(compile(tokens));
    assert!(text.contains("`r#type` cannot be a name"), "{text}");
    assert!(text.contains("pub fn set_type"), "{text}");
}

#[test]
fn the_documentation_of_an_input_says_its_unit_and_its_default() {
    let tokens: TokenStream = "pub model Kite {
        gravity: none;
        /// Air over ground.
        input wind: [speed; 3];
        input push: torque = 2000 N*m;
        body kite { mass: 2.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
        joint pin: hinge from world to kite.com { axis: y, force: push }
        load drag on kite at com = 1 kg/s * wind;
        load rudder on kite at com: external;
    }"
    .parse()
    .expect("tokens");
    let text = formatted(compile(tokens));
    for doc in [
        r"Air over ground. \[m/s\]",
        r"\[N*m\], 2000 by default",
        r"Force \[N\] and couple \[N m\], world axes.",
    ] {
        assert!(text.contains(doc), "{doc} is missing");
    }
}

#[test]
fn something_unused_is_a_warning_at_its_place() {
    let tokens: TokenStream = "pub model Bob {
        gravity: none;
        const LONG = 3.0 m;
        param unused = 2.0 m;
        table drag = { 0 m: 1 N, 1 m: 2 N };
        point bob { mass: 1.0 kg }
        line string from world to bob { free_length: 1 m, stiffness: 1 kN/m }
    }"
    .parse()
    .expect("tokens");
    let text = formatted(compile(tokens));
    // What rustc tells as "constant `LONG` is never used", "field `unused` is never read", "function `drag` is never used".
    for unused in ["const LONG: () = ();", "unused: ()", "fn drag() {}"] {
        assert!(text.contains(unused), "{unused} is missing");
    }
    assert!(!text.contains("compile_error"));
}

#[test]
fn a_list_of_quantities_limits_what_is_emitted() {
    let model = |emit: &str| {
        let text = format!(
            "pub model Bob {{
                gravity: none;
                {emit}
                point bob {{ mass: 1.0 kg }}
                line string from world to bob {{ free_length: 1 m, stiffness: 1 kN/m }}
                output force = string.tension;
            }}"
        );
        formatted(compile(text.parse().expect("tokens")))
    };
    let (all, few) = (model(""), model("emit: [outputs];"));
    assert!(all.contains("fn momentum") && !few.contains("fn momentum"));
    assert!(few.contains("fn derivative") && few.contains("fn outputs"));
    assert!(few.len() < all.len());
    assert!(model("emit: [partial];").contains("fn derivative_by_state"));
}

#[test]
fn two_functions_of_an_arm_that_are_asked_for_are_all_that_is_emitted_beside_what_moves_it() {
    let arm = |emit: &str| {
        let text = format!(
            "model Arm {{
                coordinates: relative;
                gravity: [0, 0, -9.81] m/s^2;
                {emit}
                body upper {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }}
                body lower {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }}
                joint shoulder: hinge from world to upper.top {{ axis: y }}
                joint elbow: hinge from upper.end to lower.top {{ axis: x }}
                output reach = lower.position;
            }}"
        );
        let text = formatted(compile(text.parse().expect("tokens")));
        let functions = text
            .lines()
            .filter_map(|line| line.trim().strip_prefix("fn "));
        let names = functions.filter_map(|rest| rest.split(['(', '<']).next());
        let names: std::collections::BTreeSet<String> = names.map(str::to_owned).collect();
        names
    };
    let [plain, asked] = ["emit: [];", "emit: [mass_matrix, inverse_dynamics];"].map(arm);
    let more: Vec<&String> = asked.difference(&plain).collect();
    assert_eq!(more, ["inverse_dynamics", "mass_matrix"]);
    for other in [
        "outputs",
        "energy",
        "momentum",
        "bias_force",
        "reactions",
        "bodies",
    ] {
        assert!(!asked.contains(other) && arm("").contains(other), "{other}");
    }
    assert!(asked.contains("derivative"));
}

#[test]
fn a_scene_that_cannot_move_is_told_so() {
    let weld = |joints: &str| {
        let text = format!(
            "model Truss {{ gravity: none; world {{ frame far at [1, 0, 0] m }}
             body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame end at [1, 0, 0] m }} {joints} }}"
        );
        emit(&read_text(&text)).to_string()
    };
    let hinge = "joint hold: hinge from world.far to a.end { axis: y }";
    assert!(!weld(hinge).contains("cannot move"));
    let both = format!("joint weld: rigid from world to a.com; {hinge}");
    assert!(weld(&both).contains("the 11 rows of its joints hold all 6 speeds"));
    let tree = "coordinates: relative; joint weld: rigid from world to a.com;";
    assert!(weld(tree).contains("its joints leave its bodies no coordinate"));
    let driven = "coordinates: relative; joint crank: hinge from world to a.com { axis: z, motor: 1 rad/s * time }";
    assert!(!weld(driven).contains("cannot move"));
}

#[test]
fn a_lock_that_has_nothing_to_hold_is_told_where_it_is_named_first() {
    let told = |family: &str, events: &str| {
        let text = format!(
            "model Held {{ gravity: none; coordinates: {family};
    body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame tip at [1, 0.2, 0] m }}
    world {{ frame far at [1.7, 0.3, 0.1] m }}
    joint p: hinge from world to a.com {{ axis: y }}
    joint strut: distance from world.far to a.tip {{ length: 0.9 m }}
    body b {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
    joint q: hinge from world to b.com {{ axis: y }}
    {events} }}"
        );
        let reading = read_text(&text);
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        let scene = reading.scene.clone().unwrap_or_default();
        immovable(&reading, &Layout::new(&scene)).map(|told| told.in_file(""))
    };
    for family in ["absolute", "relative"] {
        assert_eq!(
            told(family, "event one = time rises 1 s { lock: [q, p] }").as_deref(),
            Some(
                ":8:44: `p`, `strut` hold `p.angle` already: lock another coordinate, or take away what holds this one"
            )
        );
        let both =
            "event one = time rises 1 s { lock: p } event two = time rises 2 s { detach: strut }";
        assert_eq!(told(family, both), None);
        let twice = "event one = time rises 1 s { lock: q } event two = time rises 2 s { free: q }";
        assert_eq!(told(family, twice), None);
    }
}

#[test]
fn a_motor_that_has_nothing_to_drive_is_told_with_the_joints_that_hold_its_coordinate() {
    let told = |joints: &str| {
        let bar = |name: &str| {
            format!(
                "body {name} {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2,
                 frame one at [-0.5, 0, 0] m, frame two at [0.5, 0, 0] m }}"
            )
        };
        let text = format!(
            "model Driven {{ gravity: none; world {{ frame far at [1.3, 0, 0] m }} {} {} {} {joints} }}",
            bar("a"),
            bar("b"),
            bar("c")
        );
        let reading = read_text(&text);
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        let scene = reading.scene.clone().unwrap_or_default();
        immovable(&reading, &Layout::new(&scene)).map_or_else(String::new, |told| told.text)
    };
    let free = "joint b_free: free from world to b.com; joint c_free: free from world to c.com;";
    let slide = "joint slide: prismatic from world to a.com { axis: z, motor: 1 m/s * time }";
    assert_eq!(told(&format!("{slide} {free}")), "");
    let plane = "joint floor: point_on_plane from world to a.com;";
    assert_eq!(
        told(&format!("{slide} {plane} {free}")),
        "`slide` cannot drive its `slide`: `floor` holds it; leave this motor out, or take away what holds it"
    );
    // It drives until an event attaches the floor.
    let apart = plane.replace(';', " { at_start: detached }");
    assert_eq!(told(&format!("{slide} {apart} {free}")), "");
    let pins = |first: &str, second: &str| {
        format!(
            "joint p1: hinge from world to a.one {{ axis: y {first} }}
             joint p2: hinge from a.two to b.one {{ axis: y }}
             joint p3: hinge from b.two to c.two {{ axis: y }}
             joint p4: hinge from world.far to c.one {{ axis: y {second} }}"
        )
    };
    let motor = ", motor: 1 rad/s * time";
    assert_eq!(told(&pins(motor, "")), "");
    assert_eq!(told(&pins("", motor)), "");
    assert_eq!(
        told(&pins(motor, motor)),
        "`p4` cannot drive its `angle`: `p1`, `p2`, `p3` hold it; leave this motor out, or take away what holds it"
    );
}

/// Documentation that tries to end its comment, and turns the direction of writing, so that a reader sees another program than there is.
#[test]
#[cfg(feature = "pretty")]
fn no_word_of_a_scene_leaves_its_comment_in_the_code_or_turns_the_direction_of_writing() {
    let text = |doc: &str| {
        format!(
            "/// {doc}\npub model Tricks {{ gravity: none;
             /// {doc}
             param m = 1 kg;
             /// {doc}
             point stone {{ mass: m, start at [0, 0, 1] m }}
             /// {doc}
             input push: force;
             load wind on stone = [push, 0 N, 0 N];
             /// {doc}
             output height = stone.position.z; }}"
        )
    };
    let printed = |doc: &str| {
        let reading = read_text(&text(doc));
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        mbd_compiler::expand(&reading).expect("Rust")
    };
    let plain = printed("plain");
    let tricky = printed("*/ } fn evil() {} /* \"#] \u{202e}live\u{2066}\u{200f} {} \\");
    assert!(!tricky.chars().any(mbd_scene::turns_direction));
    assert!(tricky.contains('\u{fffd}'));
    let items = |code: &str| syn::parse_file(code).expect("Rust").items.len();
    assert_eq!(items(&plain), items(&tricky));
    let code = |text: &str| -> Vec<String> {
        let lines = text.lines().map(str::trim_start);
        // The documentation, texts, and the hash of both.
        let said = |line: &&str| {
            !line.starts_with("///") && !line.contains('"') && !line.contains("DECL_HASH")
        };
        lines.filter(said).map(str::to_owned).collect()
    };
    assert!(code(&plain) == code(&tricky), "{tricky}");
}

#[test]
fn names_of_patterns_of_rust_end_in_an_underscore_there() {
    let reading = read_text(
        "pub model Named { gravity: none;
            const None = 2;
            param Some = 1 kg;
            input Ok: force;
            state Err = 0 m { rate: 1 m/s }
            point bob { mass: Some * None }
            load push on bob = [Ok, Err * 1 N/m, 0 N]; }",
    );
    assert!(reading.errors.is_empty(), "{}", reading.errors[0]);
    let text = formatted(emit(&reading));
    for field in ["pub Some_: f64", "pub Ok_: f64"] {
        assert!(text.contains(field), "{field}: {text}");
    }
    for pattern in [
        "let Some =",
        "pub Some:",
        "let None =",
        "pub Ok:",
        "fn Err(",
    ] {
        assert!(!text.contains(pattern), "{pattern}: {text}");
    }
}

/// The functions of an expansion, by type and name, with what they take.
fn functions(tokens: TokenStream) -> BTreeMap<String, String> {
    let file: syn::File = syn::parse2(tokens).expect("Rust");
    let mut found = BTreeMap::new();
    for item in &file.items {
        let syn::Item::Impl(own) = item else { continue };
        for item in &own.items {
            let (None, syn::ImplItem::Fn(function)) = (&own.trait_, item) else {
                continue;
            };
            let (of, name) = (&own.self_ty, &function.sig.ident);
            let taken = &function.sig.inputs;
            found.insert(
                quote::quote!(#of #name).to_string(),
                quote::quote!(#taken).to_string(),
            );
        }
    }
    found
}

/// An arm of which everything is asked for that a robot is asked for.
const ARM: &str = "model Arm {
    coordinates: relative;
    gravity: [0.0, 0.0, -9.81] m/s^2;
    emit: [derivative, mass_matrix, bias_force, inverse_dynamics, gravity_force, energy, momentum, centre_of_mass, centre_of_mass_jacobian,
        frame_jacobian];
    input push: torque;
    body upper { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m, frame end at [0.0, 0.0, -0.5] m }
    body lower { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
    joint shoulder: hinge from world to upper.top { axis: y, force: push }
    joint elbow: hinge from upper.end to lower.top { axis: x }
}";

#[test]
fn after_a_mistake_elsewhere_functions_take_what_they_take_without_it() {
    let folder = format!("{}/tests/pass", env!("CARGO_MANIFEST_DIR"));
    let files = std::fs::read_dir(folder).expect("part of the repository");
    let paths = files.map(|file| file.expect("a file").path());
    let texts = paths.map(|path| std::fs::read_to_string(path).expect("text"));
    let (mut all, mut others) = (0, Vec::new());
    for declaration in texts.chain([ARM.to_owned()]) {
        let reading = read_text(&declaration);
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        let end = declaration.rfind('}').expect("a model");
        let broken = format!(
            "{} load astray on nowhere = [1.0, 0.0, 0.0] N; }}",
            &declaration[..end]
        );
        let left = functions(compile(broken.parse().expect("tokens")));
        for (name, taken) in functions(emit(&reading)) {
            all += 1;
            let found = left.get(&name);
            if found != Some(&taken) {
                others.push(format!("{name}: {taken}, not {found:?}"));
            }
        }
    }
    // Which lists a function reads is known by its equations alone.
    assert!(
        all > 500 && others.len() < 4,
        "{} of {all}: {others:#?}",
        others.len()
    );
}
