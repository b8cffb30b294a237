//! Robots from URDF.

use super::*;

#[test]
fn a_robot_is_checked_converted_and_run_like_any_scene() {
    let folder = Folder::new("urdf");
    let arm = include_str!("../../../../../mbd-macros/compiler/tests/urdf/arm.urdf");
    let urdf = folder.file("arm.urdf", arm);
    let told = run(&["check", &urdf]).unwrap();
    assert!(told.contains("grip_mirror_mimic"), "{told}");
    let toml = folder.file("arm.toml", &run(&["convert", &urdf]).unwrap());
    assert_eq!(
        run(&["convert", &toml]).unwrap(),
        run(&["convert", &urdf]).unwrap()
    );
    let out = folder.0.join("out").display().to_string();
    let told = run(&["run", &urdf, "--until", "0.02", "--out", &out]).unwrap();
    assert!(told.contains("1 material, 1 visual"), "{told}");
    // A declaration names the file that lies beside it.
    let text = folder.file("arm.mbd", "model Arm { urdf: \"arm.urdf\" { base: free } }");
    assert!(run(&["check", &text]).unwrap().contains("base_link"));
    let broken = folder.file("arm.urdf", &arm.replace("\"2.5\"", "\"nan\""));
    for file in [&broken, &text] {
        let error = run(&["check", file]).unwrap_err();
        assert_eq!(error.code(), 2);
    }
}
