//! What the page about events says to write, run as it stands there.

use super::*;

/// The text of the page under a heading, up to the end of its first block.
fn block(heading: &str) -> &'static str {
    let page = include_str!("../../../../../docs/events.md");
    let section = page.split(heading).nth(1).unwrap();
    let block = section.split("```text\n").nth(1).unwrap();
    block.split("```").next().unwrap()
}

/// When the events of a run happened, as its summary tells them.
fn times(text: &str, event: &str) -> Vec<f64> {
    let folder = Folder::new(event);
    let out = folder.0.join("out").display().to_string();
    run(&[
        "run",
        &folder.file("recipe.mbd", text),
        "--out",
        &out,
        "--no-estimate",
    ])
    .unwrap();
    let summary = std::fs::read_to_string(folder.0.join("out/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let events = summary["events"].as_array().unwrap().iter();
    let own = events.filter(|told| told[1] == event);
    own.map(|told| told[0].as_f64().unwrap()).collect()
}

#[test]
fn what_happens_so_long_after_an_event_does() {
    let text = format!(
        "model Drop {{
            gravity: [0, 0, -9.81] m/s^2;
            point probe {{ mass: 1 kg, start at [0, 0, 1000] m }}
            spring reef from world to probe {{ free_length: 1 km, stiffness: 1e-3 N/m }}
            {}
        }}\n[run]\nuntil = \"14 s\"\n",
        block("## So long after an event")
    );
    let [opened, cut] = ["opened", "cut"].map(|event| times(&text, event));
    assert_eq!([opened.len(), cut.len()], [1, 1]);
    assert!(
        (cut[0] - opened[0] - 2.0).abs() < 1e-9,
        "{opened:?} {cut:?}"
    );
}

#[test]
fn what_happens_again_and_again_does_at_every_multiple_of_its_period() {
    let text = format!(
        "model Clock {{ gravity: none; point bob {{ mass: 1 kg }} {} }}\n[run]\nuntil = \"0.1 s\"\n",
        block("## Again and again")
    );
    let ticks = times(&text, "tick");
    assert_eq!(ticks.len(), 5, "{ticks:?}");
    for (k, tick) in ticks.iter().enumerate() {
        assert!((tick - 0.02 * (k + 1) as f64).abs() < 1e-9, "{ticks:?}");
    }
}

/// The value of a sine of time alone comes from below zero at the start, as time does from before it.
#[test]
fn a_guard_of_time_alone_passes_at_the_start() {
    let clock = "model Clock { gravity: none; point bob { mass: 1 kg }
        event beat = sin(2 * pi * time / (20 ms)) rises 0; }\n[run]\nuntil = \"0.09 s\"\n";
    let beats = times(clock, "beat");
    assert!(beats.len() == 5 && beats[0] < 1e-12, "{beats:?}");
}
