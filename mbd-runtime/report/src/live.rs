//! What moves on a page: the player, its script, and the numbers that both need.

use serde::Serialize;

use super::drawn::Drawn;
use super::playback::Playback;
use super::svg::words;

/// The script of the page, one idea a file.
const SCRIPT: [&str; 7] = [
    include_str!("page/numbers.js"),
    include_str!("page/camera.js"),
    include_str!("page/solids.js"),
    include_str!("page/stage.js"),
    include_str!("page/draw.js"),
    include_str!("page/plots.js"),
    include_str!("page/player.js"),
];
/// The drawing, and what can be chosen beside it.
const PLAYER: &str = include_str!("page/player.html");
/// What stays at the bottom of the window: play, time.
const DOCK: &str = include_str!("page/dock.html");

/// The numbers of a figure over time.
#[derive(Clone, Debug, Serialize)]
pub(super) struct PlotNumbers {
    /// The window of times that is drawn.
    pub x: [f64; 2],
    /// Whether the vertical axis is logarithmic.
    pub log: bool,
    pub series: Vec<SeriesNumbers>,
}

/// The numbers of a curve: times, and values less `base`.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SeriesNumbers {
    pub t: super::packing::PackedArray,
    pub base: f64,
    pub v: super::packing::PackedArray,
    /// What its values are periodic by.
    pub wrap: Option<f64>,
}

#[derive(Serialize)]
struct LiveNumbers<'a> {
    #[serde(flatten)]
    drawn: &'a Drawn,
    plots: &'a [PlotNumbers],
}

/// The player, hidden until the script runs.
pub(super) fn player(playback: &Playback) -> String {
    let says = playback.says.iter();
    let says: String = says
        .map(|text| format!("<p class=\"note\">{}</p>\n", words(text)))
        .collect();
    format!("{}\n{says}", PLAYER.trim_end())
}

/// What stands in the head of a page with a player: where a script runs, the drawings that stand still are never laid out (a third of the time to the first frame of
/// 500 bodies).
pub(super) const EARLY: &str = "<script>document.documentElement.classList.add('live')</script>\n";

/// What stands at the end of a page with a player.
pub(super) fn at_the_end(playback: &Playback, plots: &[PlotNumbers]) -> String {
    let drawn = &playback.drawn;
    let numbers = serde_json::to_string(&LiveNumbers { drawn, plots });
    // No name can end the script that holds it. Numbers and names are all there is: it can be written.
    let numbers = numbers.unwrap_or_default().replace('<', "\\u003c");
    format!(
        "{DOCK}<script type=\"application/json\" id=\"mbd-data\">{numbers}</script>\n<script>(() => {{\n'use strict';\n{}}})();</script>\n",
        script()
    )
}

/// The script without the comments that explain it.
fn script() -> String {
    let lines = SCRIPT.into_iter().flat_map(str::lines).map(str::trim);
    let code = lines
        .filter(|line| !line.is_empty() && !line.starts_with("//") && !line.starts_with("/**"));
    code.flat_map(|line| [line, "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_is_small_and_fetches_nothing() {
        let script = script();
        assert!(script.len() <= 40_000, "{}", script.len());
        for word in [
            "fetch(",
            "XMLHttpRequest",
            "import(",
            "eval(",
            "http://",
            "https://",
        ] {
            assert!(
                !script
                    .replace("http://www.w3.org/2000/svg", "")
                    .contains(word),
                "{word}"
            );
        }
        // It stands inside an element of its own.
        assert!(!script.contains("</script"));
        // Comments stand on lines of their own, in one line each.
        assert!(!script.contains("/*"));
    }
}
