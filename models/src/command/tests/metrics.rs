//! Metrics that a scene declares, as commands tell them.

use serde_json::Value;

use super::*;

const FALL: &str = "model Stone {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    point stone { mass: 1 kg, start at [0.0, 0.0, 20.0] m }
    event landed = stone.position.z falls 0 m { then: stop }
    event never = stone.position.z rises 100 m;
    /// How fast it gets.
    metric fastest = max norm(stone.velocity) in kph;
    metric impulse = integral norm(stone.velocity);
    metric fall = time_of landed;
    metric risen = time_of never;
}

[run]
until = \"3 s\"
tolerance = 1e-9
";

#[test]
fn a_run_tells_its_metrics_in_its_summary_and_on_its_page_and_none_where_there_is_none() {
    let folder = Folder::new("metrics");
    let scene = folder.file("stone.mbd", FALL);
    let out = folder.0.join("out");
    run(&["run", &scene, "--out", &out.display().to_string()]).unwrap();
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let metrics = &summary["metrics"];
    for (name, expected) in [("fastest", 72.0), ("impulse", 20.0), ("fall", 2.0)] {
        let found = metrics[name].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-6, "{name}: {found}");
    }
    assert!(metrics["risen"].is_null(), "{metrics}");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    for part in ["Metrics", "fastest", "time_of", "m/s s"] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn a_scene_with_metrics_is_converted_and_back() {
    let folder = Folder::new("metrics_convert");
    let scene = folder.file("stone.mbd", FALL);
    let toml = run(&["convert", &scene]).unwrap();
    assert!(
        toml.contains("[metric.fastest]") && toml.contains("in = \"kph\""),
        "{toml}"
    );
    let document = folder.file("stone.toml", &toml);
    let text = run(&["convert", &document, "--to", "mbd"]).unwrap();
    assert!(text.contains("metric fall = time_of landed;"), "{text}");
    let back = folder.file("back.mbd", &text);
    assert_eq!(run(&["convert", &back]).unwrap(), toml);
    let told = run(&["check", &scene, "--json"]).unwrap();
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(told["metrics"][0]["take"], "max");
}
