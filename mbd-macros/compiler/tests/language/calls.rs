//! A macro call and a text are one language, with places and names.

use mbd_compiler::{Named, read_text, read_tokens};

use super::{expected, files, parachute};

#[test]
fn tokens_and_text_are_the_same_language() {
    for (name, text) in files("pass") {
        let tokens = text.parse().unwrap();
        let (tokens, text) = (read_tokens(tokens), read_text(&text));
        assert!(tokens.scene.is_some(), "{name}: {:?}", tokens.errors);
        assert_eq!(tokens.scene, text.scene, "{name}");
        assert_eq!(tokens.notes, text.notes, "{name}");
    }
    for (name, text) in files("fail") {
        let (_, declaration) = expected(&text);
        // What is no Rust token, or no balanced text, never reaches a macro; a number beyond f64 is refused by rustc as well.
        let Ok(tokens) = declaration.parse() else {
            continue;
        };
        let (tokens, text) = (read_tokens(tokens), read_text(&declaration));
        let (tokens, text): (Vec<_>, Vec<_>) = (
            tokens.errors.iter().map(|m| &m.text).collect(),
            text.errors.iter().map(|m| &m.text).collect(),
        );
        assert_eq!(tokens, text, "{name}");
    }
}

#[test]
fn a_comment_of_another_language_is_told_once_in_a_macro_call() {
    let tokens = "model S { gravity: none; # the bob\n point bob { mass: 1 kg } }".parse();
    let reading = read_tokens(tokens.unwrap());
    let texts: Vec<&str> = reading.errors.iter().map(|m| m.text.as_str()).collect();
    assert_eq!(texts, ["a comment begins with `//`"]);
}

#[test]
fn every_place_of_a_message_is_a_compile_error_of_its_own() {
    let twice = "model S { gravity: none; const a = 1.0 m; const a = 2.0 m; }";
    let reading = read_tokens(twice.parse().unwrap());
    let told = reading.errors[0].to_compile_error().to_string();
    assert_eq!(told.matches("compile_error").count(), 2, "{told}");
    assert!(told.contains("is used twice in this model") && told.contains("first used here"));
}

#[test]
fn after_an_error_the_names_of_the_interface_are_still_there() {
    let broken = parachute().replace("stiffness: riser_k", "stifness: riser_k");
    let reading = read_text(&broken);
    assert!(reading.scene.is_none());
    let names = |list: Vec<&String>| -> Vec<String> { list.into_iter().cloned().collect() };
    let skeleton = &reading.skeleton;
    assert_eq!(skeleton.name, "Parachute");
    assert_eq!(
        names(skeleton.params.iter().map(|p| &p.name).collect()),
        ["riser_k", "m_cap", "cd_s"]
    );
    assert_eq!(
        names(skeleton.outputs.iter().map(|o| &o.name).collect()),
        ["riser_force", "tilt", "imu_speed"]
    );
    assert_eq!(skeleton.loads.len(), 2);
    assert_eq!(reading.spans.params.len(), 3);
    assert!(reading.options.generic && reading.options.verify);
    assert_eq!(reading.options.visibility.to_string(), "pub");
}

#[test]
fn uses_of_names_are_known_with_their_places() {
    let reading = read_text(&parachute());
    let uses = |named: Named| {
        let references = &reading.spans.references;
        references.iter().filter(|(used, _)| *used == named).count()
    };
    assert_eq!(uses(Named::Param(1)), 1);
    assert_eq!(uses(Named::Input(0)), 2);
    assert_eq!(uses(Named::Frame(0, 2)), 3);
}
