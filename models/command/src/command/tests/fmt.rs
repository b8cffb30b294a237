//! `mbd fmt`: files are formatted in place, whole or not at all.

use super::*;

const BEFORE: &str =
    "model A{gravity:none; point a{mass:1kg}}\n\n\n[run]\nuntil  = \"1 s\" # as it is\n";
const AFTER: &str = "model A {\n    gravity: none;\n    point a { mass: 1 kg }\n}\n\n[run]\nuntil  = \"1 s\" # as it is\n";

fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn a_scene_and_a_file_of_rust_are_formatted_in_place_and_then_stay() {
    let folder = Folder::new("fmt");
    let scene = folder.file("a.mbd", BEFORE);
    let rust = folder.file("a.rs", "fn f( ) {}\nmodel! { model A { gravity:none; } }\n");
    let error = run(&["fmt", "--check", &scene, &rust]).unwrap_err();
    assert_eq!(error.code(), 1);
    let told = error.to_string();
    assert!(
        told.contains("a.mbd:1:") && told.contains("a.rs:2:"),
        "{told}"
    );
    assert_eq!(read(&scene), BEFORE);
    assert_eq!(run(&["fmt", &scene, &rust]).unwrap(), "");
    assert_eq!(read(&scene), AFTER);
    let wanted = "fn f( ) {}\nmodel! {\n    model A {\n        gravity: none;\n    }\n}\n";
    assert_eq!(read(&rust), wanted);
    assert_eq!(run(&["fmt", "--check", &scene, &rust]).unwrap(), "");
    let written = std::fs::metadata(&scene).unwrap().modified().unwrap();
    run(&["fmt", &scene]).unwrap();
    let now = std::fs::metadata(&scene).unwrap().modified().unwrap();
    assert_eq!(now, written, "what is in order is not written");
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 2);
}

#[test]
fn a_file_with_a_mistake_stays_and_the_others_are_formatted() {
    let folder = Folder::new("fmt_mistake");
    let broken = folder.file("broken.mbd", "model A {\n  gravity none;\n}\n");
    let scene = folder.file("a.mbd", BEFORE);
    let error = run(&["fmt", &broken, &scene]).unwrap_err();
    assert_eq!(error.code(), 2);
    assert!(error.to_string().contains("broken.mbd:2:11: "), "{error}");
    assert_eq!(read(&broken), "model A {\n  gravity none;\n}\n");
    assert_eq!(read(&scene), AFTER);
    let error = run(&["fmt", &broken, "not_here.mbd"]).unwrap_err();
    assert_eq!(error.code(), 2);
    assert!(error.to_string().contains("not_here.mbd"), "{error}");
}

#[test]
fn files_that_cannot_be_formatted_are_named() {
    let folder = Folder::new("fmt_files");
    let toml = folder.file("a.toml", "model = \"A\"\n");
    let empty = folder.file("empty.mbd", "");
    let bytes = folder.0.join("bytes.mbd");
    std::fs::write(&bytes, [0xff, 0xfe]).unwrap();
    let bytes = bytes.display().to_string();
    let device = folder.0.join("device.mbd");
    let mut cases = vec![
        (toml.as_str(), 1, "`.rs`"),
        (&empty, 2, "empty.mbd:1:1: "),
        (&bytes, 1, "bytes.mbd"),
        ("not_here.mbd", 1, "cannot read not_here.mbd"),
    ];
    #[cfg(unix)]
    std::os::unix::fs::symlink("/dev/zero", &device).unwrap();
    let device = device.display().to_string();
    if cfg!(unix) {
        cases.push((&device, 1, "no ordinary file"));
    }
    for (file, code, part) in cases {
        let error = run(&["fmt", file]).unwrap_err();
        assert_eq!(error.code(), code, "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
    assert_eq!(run(&["fmt"]).unwrap_err().code(), 1);
    let both = run(&["fmt", "-", &empty]).unwrap_err();
    assert!(both.to_string().contains("standard input"), "{both}");
}

#[test]
fn who_may_write_a_file_and_what_leads_to_it_stay() {
    let folder = Folder::new("fmt_kept");
    let scene = folder.file("a.mbd", BEFORE);
    let mut permissions = std::fs::metadata(&scene).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&scene, permissions.clone()).unwrap();
    let error = run(&["fmt", &scene]).unwrap_err();
    assert!(error.to_string().contains("read-only"), "{error}");
    assert_eq!(read(&scene), BEFORE);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        permissions.set_mode(0o640);
        std::fs::set_permissions(&scene, permissions).unwrap();
        let link = folder.0.join("link.mbd");
        std::os::unix::fs::symlink("a.mbd", &link).unwrap();
        run(&["fmt", &link.display().to_string()]).unwrap();
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        let mode = std::fs::metadata(&scene).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
        assert_eq!(read(&scene), AFTER);
    }
}

#[test]
fn a_template_of_a_macro_stays_and_is_told_and_is_no_reason_to_fail() {
    let folder = Folder::new("fmt_template");
    let text = "macro_rules! m {\n    ($x:tt) => { model! { model $x {} } };\n}\n";
    let rust = folder.file("a.rs", text);
    for arguments in [&["fmt", "--check", &rust][..], &["fmt", &rust]] {
        let told = run(arguments).unwrap();
        assert!(
            told.contains("a.rs:2:25: ") && told.contains("stays as it is"),
            "{told}"
        );
    }
    assert_eq!(read(&rust), text);
}

#[test]
fn what_is_converted_into_text_is_formatted() {
    for name in ["swing", "drop", "four_bar", "arm", "parachute"] {
        let folder = Folder::new(&format!("fmt_{name}"));
        let text = run(&["convert", name, "--to", "mbd"]).unwrap();
        let file = folder.file("a.mbd", &text);
        let told = run(&["fmt", "--check", &file]).map_err(|error| error.to_string());
        assert_eq!(told, Ok(String::new()), "{name}");
    }
}
