//! Generated code against the interpreter, to the bit, and against the laws on numbers, to rounding.

#[allow(
    dead_code,
    deprecated,
    reason = "random scenes declare frames and points they do not use"
)]
mod dozen;

use fuzz::random_scene::random_scene;
use models::parachute::scene::{
    ParachuteEuler, ParachuteLiteral, ParachuteMass, ParachuteRate, ParachuteStatic,
    ParachuteStepwise,
};
use tests::agreement::agrees;

/// The seeds of the scenes that are compiled; all others of the property tests are interpreted.
const DOZEN: std::ops::Range<u64> = 0..12;

#[test]
fn generated_parachutes_are_the_interpreter_to_the_bit_and_the_laws_to_rounding() {
    agrees(&ParachuteMass::<f64>::new(Default::default()).expect("defaults"));
    agrees(&ParachuteStatic::<f64>::new(Default::default()).expect("defaults"));
    agrees(&ParachuteStepwise::<f64>::new(Default::default()).expect("defaults"));
    agrees(&ParachuteEuler::<f64>::new(Default::default()).expect("defaults"));
    agrees(&ParachuteLiteral::<f64>::new(Default::default()).expect("defaults"));
    agrees(&ParachuteRate::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn a_dozen_random_scenes_compile_and_agree() {
    macro_rules! dozen {
        ($($name:ident)*) => { $( agrees(&dozen::$name::<f64>::new(Default::default()).expect("defaults")); )* };
    }
    dozen!(Random0 Random1 Random2 Random3 Random4 Random5 Random6 Random7 Random8 Random9 Random10 Random11);
}

#[test]
fn the_compiled_dozen_is_what_the_generator_of_random_scenes_writes() {
    let mut text = String::from(
        "//! A dozen random scenes, compiled. Written by the test beside it with `UPDATE_GOLDEN=1`; do not edit.\n",
    );
    for seed in DOZEN {
        text += "\nmbd_runtime::model! {\n";
        for line in random_scene(seed).lines() {
            text += &format!("    {line}\n");
        }
        text += "}\n";
    }
    let text = mbd_compiler::format_rust(&text).expect("declarations").text;
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/emitted/generated/dozen.rs"
    );
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(path, &text).expect("the repository can be written");
    }
    let written = std::fs::read_to_string(path).expect("the file is part of the repository");
    assert!(
        written == text,
        "tests/emitted/generated/dozen.rs is out of date: run with UPDATE_GOLDEN=1"
    );
}
