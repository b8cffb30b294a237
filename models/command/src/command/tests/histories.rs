//! What stands in the history of a run, and what is told of its error.

use super::*;

#[test]
fn a_history_has_a_name_for_every_number_also_where_reactions_are_not_unique() {
    let folder = Folder::new("header");
    let out = folder.0.join("out").display().to_string();
    run(&["run", "four_bar", "--until", "0.1", "--out", &out]).unwrap();
    let history = std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap();
    let mut lines = history.lines().filter(|line| !line.starts_with('#'));
    let header = lines.next().unwrap();
    assert!(header.contains("not unique"), "{header}");
    let names = header.split(',').count();
    assert!(
        lines.all(|line| line.split(',').count() == names),
        "{names} names"
    );
}

#[test]
fn a_force_that_jumps_at_a_switch_is_no_error_of_the_run() {
    let folder = Folder::new("switch");
    let out = folder.0.join("out").display().to_string();
    let rope = folder.file(
        "rope.mbd",
        "model Rope {
            gravity: [0, 0, -9.81] m/s^2;
            point ball { mass: 1 kg, start at [0, 0, 1] m }
            line cord from world to ball { free_length: 1.2 m, stiffness: 500 N/m, damping: 20 N*s/m }
            output pull = norm(ball.acceleration);
        }",
    );
    let told = run(&["run", &rope, "--until", "2", "--out", &out]).unwrap();
    assert!(!told.contains("warning"), "{told}");
}
