//! Scenes as a newcomer writes them from the pages alone: they run, and what was mistaken at first is answered with what to write.

use super::*;

/// A scene, and of its lines what stood there first, with what was said of it.
type Scene = (&'static str, &'static str, &'static [Mistake]);
/// What to write, what was written, what is said.
type Mistake = (&'static str, &'static str, &'static str);

const SCENES: [Scene; 5] = [
    (
        "door_closer",
        include_str!("../../../../tests/newcomers/door_closer.mbd"),
        &[
            (
                "] m, frame bracket",
                "] m; frame bracket",
                "separated by `,`",
            ),
            (
                "free_length: 0.1 m",
                "length: 0.1 m",
                "here it is called `free_length`",
            ),
            (
                "        friction_rate: 0.1 rad/s,\n",
                "",
                "add `friction_rate: 1.0 rad/s`",
            ),
            (
                "output turned",
                "output angle",
                "`angle` is a word of the language",
            ),
            ("in deg;", "in degrees;", "here it is called `deg`"),
            (
                "\"10 s\"",
                "10 s",
                "write a value with its unit in quotes: `until = \"10 s\"`",
            ),
        ],
    ),
    (
        "crane",
        include_str!("../../../../tests/newcomers/crane.mbd"),
        &[
            ("100 kg ..= 2000 kg", "100..2000 kg", "write `..=`"),
            (
                "100 kg ..= 2000 kg",
                "100 ..= 2000 kg",
                "write it as `100 kg`",
            ),
            ("[JIB, 0, 9.75 m]", "[JIB, 0, 9.75] m", "write one of them"),
            (
                "point hook_load",
                "point load",
                "`load` is a word of the language",
            ),
        ],
    ),
    (
        "kite",
        include_str!("../../../../tests/newcomers/kite.mbd"),
        &[
            (
                "    joint kite_free: free from world to kite.com;\n",
                "",
                "add `joint kite_free: free from world to kite.com;`",
            ),
            ("omega_world", "omega", "here it is called `omega_body`"),
        ],
    ),
    (
        "trailer",
        include_str!("../../../../tests/newcomers/trailer.mbd"),
        &[
            ("radius: 0.05 m", "radius: 0.05", "write it as `0.05 m`"),
            ("prismatic", "slider", "here it is called `prismatic`"),
        ],
    ),
    (
        "clock",
        include_str!("../../../../tests/newcomers/clock.mbd"),
        &[],
    ),
];

#[test]
fn scenes_of_newcomers_run_and_are_formatted() {
    let folder = Folder::new("newcomers");
    let out = folder.0.join("out").display().to_string();
    for (name, text, _) in SCENES {
        let file = folder.file(&format!("{name}.mbd"), text);
        let told = run(&["run", &file, "--out", &out]);
        let told = told.unwrap_or_else(|failure| panic!("{name}: {failure}"));
        assert!(!told.contains("warning"), "{name}: {told}");
        let told = run(&["fmt", "--check", &file]).map_err(|failure| failure.to_string());
        assert_eq!(told, Ok(String::new()));
    }
}

#[test]
fn what_newcomers_mistook_is_answered_with_what_to_write() {
    let folder = Folder::new("newcomers_mistakes");
    for (name, text, mistakes) in SCENES {
        for (right, wrong, said) in mistakes {
            assert!(text.contains(right), "{name}: {right}");
            let file = folder.file(&format!("{name}.mbd"), &text.replace(right, wrong));
            let error = run(&["check", &file]).unwrap_err();
            let told = error.to_string();
            assert_eq!(error.code(), 2);
            assert!(
                told.contains(said) && told.contains(&format!("{name}.mbd:")),
                "{name}: {wrong}: {told}"
            );
        }
    }
}
