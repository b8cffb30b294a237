//! Formulas of many terms are read; brackets in brackets without end are refused.

use mbd_compiler::{Reading, read_text};
use mbd_scene::{Formula, Function};

/// A scene with one output, as text and as TOML.
fn with_output(formula: &str) -> Vec<Reading> {
    let text = format!(
        "model Long {{ gravity: [0.0, 0.0, -9.81] m/s^2; param b = 1 m; point bob {{ mass: 1 kg }} output long = {formula}; }}"
    );
    vec![
        read_text(&text),
        #[cfg(feature = "toml")]
        mbd_compiler::read_toml(&format!(
            "model = \"Long\"\ngravity = \"[0.0, 0.0, -9.81] m/s^2\"\n[param.b]\nvalue = \"1 m\"\n[point.bob]\nmass = \"1 kg\"\n[output.long]\nvalue = \"{formula}\"\n"
        )),
    ]
}

/// What the output is.
fn output(reading: &Reading) -> Formula {
    let messages: Vec<String> = reading.errors.iter().map(|e| e.in_file("long")).collect();
    let scene = reading.scene.as_ref().expect("a scene");
    assert!(messages.is_empty(), "{messages:?}");
    scene.outputs[0].value.clone()
}

#[test]
fn a_sum_of_a_hundred_thousand_terms_has_the_value_of_its_terms() {
    let mut formula = String::from("0.5");
    let mut sum = 0.5;
    for k in 1..=100_000_u32 {
        let minus = k % 3 == 0;
        formula += &format!(" {} {k}", if minus { '-' } else { '+' });
        sum += if minus { -f64::from(k) } else { f64::from(k) };
    }
    for reading in with_output(&formula) {
        assert_eq!(output(&reading), Formula::Number(sum));
    }
}

/// The value with the param `b` at 1, the operations inside each other, and how often `b` is named.
fn worked_out(formula: &Formula) -> (f64, usize, usize) {
    match formula {
        Formula::Number(value) => (*value, 1, 0),
        Formula::Param(0) => (1.0, 1, 1),
        Formula::Apply(function, parts) => {
            let parts: Vec<_> = parts.iter().map(worked_out).collect();
            let [(a, deep, many), (b, deeper, more)] = parts[..] else {
                panic!("two operands")
            };
            let value = match function {
                Function::Add => a + b,
                Function::Sub => a - b,
                Function::Mul => a * b,
                other => panic!("{other:?}"),
            };
            (value, deep.max(deeper) + 1, many + more)
        }
        other => panic!("{other:?}"),
    }
}

/// `2 * b + 3 * b - 4 * b …` of so many terms, and its value with `b` at 1.
fn live_sum(terms: usize) -> (String, f64) {
    let (mut text, mut sum) = (String::from("2 * b"), 2.0);
    for k in 3..terms + 2 {
        let minus = k % 5 < 2;
        text += &format!(" {} {k} * b", if minus { '-' } else { '+' });
        sum += if minus { -(k as f64) } else { k as f64 };
    }
    (text, sum)
}

#[test]
fn a_sum_of_a_hundred_thousand_live_terms_keeps_each_and_its_sign() {
    let (formula, sum) = live_sum(100_000);
    for reading in with_output(&formula) {
        let (value, depth, many) = worked_out(&output(&reading));
        assert_eq!((value, many), (sum, 100_000));
        assert!(depth < 35, "{depth}");
    }
}

#[test]
fn a_short_sum_is_grouped_from_the_left() {
    let (formula, sum) = live_sum(100);
    for reading in with_output(&formula) {
        assert_eq!(worked_out(&output(&reading)), (sum, 101, 100));
    }
}

#[test]
fn a_product_of_a_hundred_thousand_factors_has_the_value_of_its_factors() {
    // Powers of two, so that no order of the factors rounds; every group of five is one.
    let formula = format!("3{}", " * 2 / 4 / 2 * 8 / 2".repeat(20_000));
    for reading in with_output(&formula) {
        assert_eq!(output(&reading), Formula::Number(3.0));
    }
}

#[test]
fn a_long_product_may_have_a_vector_behind_a_division() {
    let formula = format!(
        "3 / 2{} * [1.0, 2.0, 4.0]{}",
        " / 2 * 2".repeat(100),
        " * 4 / 2".repeat(3)
    );
    for reading in with_output(&formula) {
        let Formula::Vector(parts) = output(&reading) else {
            panic!("a vector")
        };
        assert_eq!(parts, [12.0, 24.0, 48.0].map(Formula::Number));
    }
}

#[test]
fn ten_thousand_brackets_in_each_other_are_refused() {
    let formula = format!("{}b{}", "(".repeat(10_000), ")".repeat(10_000));
    for reading in with_output(&formula) {
        let messages: Vec<String> = reading.errors.iter().map(|e| e.in_file("long")).collect();
        assert!(
            messages
                .iter()
                .any(|text| text.contains("nests too deeply")),
            "{messages:?}"
        );
    }
}
