//! `mbd extremes`.

use super::*;

#[test]
fn every_promise_at_the_extremes_is_kept() {
    let folder = Folder::new("extremes");
    let out = folder.0.join("out").display().to_string();
    let told =
        run(&["extremes", "--reduced", "--out", &out]).unwrap_or_else(|error| panic!("{error}"));
    assert!(told.contains("79 of 79 promises kept"), "{told}");
    assert!(folder.0.join("out/report.html").is_file());
}
