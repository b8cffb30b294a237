//! The error of runs and campaigns is told where nothing else shows it: against closed forms.

use super::{Folder, run};

/// An oscillator of 0.1 nm at 1e5 rad/s, and one that may take no more steps than it does: both are told their error.
#[test]
fn the_error_of_a_run_is_told_whatever_its_size_and_its_budget() {
    let folder = Folder::new("always");
    let out = folder.0.join("out").display().to_string();
    let text = "model Tip { gravity: none; point p { mass: 1e-12 kg, start at [1.1e-9, 0, 0] m }
        spring s from world to p { free_length: 1e-9 m, stiffness: 0.01 N/m, damping: 0 N*s/m }
        output x = p.position.x - 1e-9 m; }
        [run]\nuntil = \"1 ms\"\nevery = \"10 us\"\n";
    let file = folder.file("tip.mbd", text);
    // RK4 lags by (h ω)⁵/120 a step: at h ω = 0.1 by 8.3e-5 rad after 1000 steps.
    for budget in ["2000000", "1000"] {
        let arguments = [
            "run",
            &file,
            "--out",
            &out,
            "--dt",
            "1 us",
            "--max-steps",
            budget,
            "--json",
        ];
        let told = run(&arguments).unwrap_or_else(|error| panic!("{error}"));
        let summary: serde_json::Value = serde_json::from_str(&told).unwrap();
        let error = &summary["error_estimate"]["relative"];
        let error = error
            .as_f64()
            .unwrap_or_else(|| panic!("{budget}: {error}"));
        // The root of the mean of (φ sin)² with φ rising to 8.3e-5: /√6.
        assert!((error / 3.4e-5 - 1.0).abs() < 0.2, "{budget}: {error}");
    }
}
