//! What is no error that a run can have, and columns that have no value in the window of a question, are told by what they are.

use mbd_runtime::{Generic, Options, Question, Simulation, TradeError, Variant, trade};
use tests::declared::read;

/// A stone that is let go: its course has a direction from then on, and the inverse of its speed a value.
const FALL: &str = "model Fall { gravity: [0, 0, -9.81] m/s^2;
    point stone { mass: 1 kg, start at [0, 0, 2] m }
    output course = stone.velocity.z / norm(stone.velocity);
    output pace = 1 / stone.velocity.z;
    output height = stone.position.z; }";

fn fall() -> Generic<f64> {
    Generic::with_defaults(read(FALL)).expect("defaults")
}

#[test]
fn an_error_that_no_run_can_have_is_refused_by_its_value() {
    let model = fall();
    let stone = Variant::new("stone", &model, |_: &mut Simulation<f64>| Ok(()));
    let question = Question::new("height", [0.0, 1.0]);
    for wanted in [f64::NAN, 0.0, -1e-6, f64::INFINITY, f64::NEG_INFINITY] {
        for options in [Options::tsit5(1e-3), Options::rk4(0.1)] {
            let refused = stone.accurate_to(&question, wanted, options);
            let error = refused.expect_err("no error is that");
            let named =
                matches!(error, TradeError::Wanted(told) if told.to_bits() == wanted.to_bits());
            assert!(named, "{wanted}: {error:?}");
            assert!(
                error
                    .to_string()
                    .contains(&format!("an error of {wanted} is wanted")),
                "{error}"
            );
        }
    }
}

#[test]
fn a_column_without_a_value_in_the_window_is_told_with_the_time() {
    let model = fall();
    let stone = Variant::new("stone", &model, |_: &mut Simulation<f64>| Ok(()));
    for column in ["course", "pace"] {
        let question = Question::new(column, [0.0, 1.0]);
        for options in [Options::tsit5(1e-3), Options::rk4(0.1)] {
            let told = [
                stone.accurate_to(&question, 1e-6, options).map(|_| ()),
                stone.error(&question, options).map(|_| ()),
                stone
                    .against(&question, options, Options::vern7(1e-9))
                    .map(|_| ()),
                trade(std::slice::from_ref(&stone), &question).map(|_| ()),
            ];
            for error in told.map(|told| told.expect_err("0/0 at the start")) {
                let at_start = matches!(&error, TradeError::NotFinite { column: of, time } if of == column && *time == 0.0);
                assert!(at_start, "{column}: {error:?}");
                let says = format!("`{column}` has no finite value at 0 s");
                assert!(error.to_string().contains(&says), "{error}");
            }
        }
        // From where it has one, it is answered: the stone falls straight down, at g t.
        let later = Question::new(column, [0.5, 1.0]);
        let found = stone.accurate_to(&later, 1e-6, Options::tsit5(1e-3));
        assert!(found.expect("a value").error.rms <= 1e-6, "{column}");
    }
}
