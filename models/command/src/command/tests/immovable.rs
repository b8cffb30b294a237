//! Scenes that cannot move, and motors that have nothing to drive.

use super::*;

/// A four-bar with a fifth hinge across it, in space or in a plane, as a declaration.
const LOCKED: &str = "model Locked { planar: xz; gravity: none; world { frame far at [2, 0, 0] m }
    body left { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame root at [0, 0, -0.5] m, frame tip at [0, 0, 0.5] m }
    body right { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame root at [0, 0, -0.7] m, frame tip at [0, 0, 0.7] m }
    joint a: hinge from world to left.root { axis: y }
    joint b: hinge from left.tip to right.tip { axis: y }
    joint close: hinge from world.far to right.root { axis: y } }
[run]
until = \"1 s\"
";

#[test]
fn a_scene_that_cannot_move_is_refused_by_every_command_in_the_words_of_the_macro() {
    let folder = Folder::new("locked");
    let (scene, settings) = LOCKED.split_once("[run]").unwrap();
    let read = mbd_compiler::read_text(scene).scene.unwrap();
    let toml = format!("{}\n[run]{settings}", mbd_compiler::write_toml(&read));
    let out = folder.0.join("out").display().to_string();
    for file in [
        folder.file("locked.mbd", LOCKED),
        folder.file("locked.toml", &toml),
    ] {
        for command in ["check", "expand", "convert", "run"] {
            let flags: &[&str] = if command == "run" {
                &["--out", &out]
            } else {
                &[]
            };
            let error = run(&[&[command, &file][..], flags].concat()).unwrap_err();
            assert_eq!(error.code(), 2);
            assert!(
                error.to_string().contains("model `Locked` cannot move: the 6 rows of its joints hold all 6 speeds; take a joint away"),
                "{command} {file}: {error}"
            );
        }
    }
    assert!(!folder.0.join("out").exists());
}

#[test]
fn a_motor_that_has_nothing_to_drive_is_refused_by_every_command() {
    let folder = Folder::new("idle");
    let driven = |axis: &str| format!("{{ axis: {axis}, motor: 1 rad/s * time }}");
    let text = format!(
        "model Idle {{ planar: xy; gravity: none; body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
           joint one: hinge from world to a.com {}
           joint two: hinge from world to a.com {} }}",
        driven("z"),
        driven("z")
    );
    let file = folder.file("idle.mbd", &text);
    for command in ["check", "expand", "convert", "run"] {
        let error = run(&[command, &file]).unwrap_err();
        assert_eq!(error.code(), 2);
        assert!(
            error.to_string().contains("`two` cannot drive its `angle`"),
            "{command}: {error}"
        );
    }
}
