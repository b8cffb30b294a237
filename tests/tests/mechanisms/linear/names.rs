//! What is not there is told by its name.

use mbd_runtime::{Generic, LinearisationError, linearise, linearise_along, trim};
use tests::declared::read;

use super::{DOUBLE_PENDULUM, generic, placed};

#[test]
fn names_that_are_not_there_and_coordinates_that_depend_are_told() {
    let model = generic(read(DOUBLE_PENDULUM));
    let at = placed(&model, &[0.0; 2], &[]);
    let unknown = linearise_along(&model, 0.0, &at, &[0.0; 2], &["elbow.angel"]);
    let text = unknown.expect_err("no such coordinate").to_string();
    assert!(
        text.contains("`elbow.angel`") && text.contains("elbow.angle"),
        "{text}"
    );
    let along = ["shoulder.angle", "elbow.angle", "lower.x"];
    let depends = linearise_along(&model, 0.0, &at, &[0.0; 2], &along);
    let name = "lower.x".to_owned();
    assert_eq!(
        depends.err(),
        Some(LinearisationError::DependentCoordinate { name })
    );
    let short = linearise(&model, 0.0, &at[1..], &[0.0; 2]);
    assert!(matches!(
        short,
        Err(LinearisationError::Length { expected: 26, .. })
    ));
    let unknown = trim(&model).free_input("third").solve();
    let text = unknown.expect_err("no such input").to_string();
    assert!(text.contains("first, second"), "{text}");
    // In single precision the answers are those of double precision for the rounded state.
    let single = Generic::<f32>::with_defaults(read(DOUBLE_PENDULUM)).expect("defaults");
    let rounded: Vec<f32> = at.iter().map(|x| *x as f32).collect();
    let space = linearise(&single, 0.0, &rounded, &[0.0; 2]).expect("linear");
    let want = linearise(&model, 0.0, &at, &[0.0; 2]).expect("linear");
    assert!((space.a - &want.a).amax() < 1e-5 * want.a.amax());
}
