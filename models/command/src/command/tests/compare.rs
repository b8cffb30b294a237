//! `mbd compare`.

use super::*;

#[test]
fn runs_side_by_side_show_what_differs_and_what_does_not_is_left_out() {
    let folder = Folder::new("compare");
    let out = folder.0.display().to_string();
    let text = run(&[
        "compare",
        "swing --tol 1e-5",
        "swing --tol 1e-9",
        "--out",
        &out,
    ])
    .unwrap();
    assert!(
        text.contains("relative tolerance") && text.contains("last height"),
        "{text}"
    );
    assert!(!text.contains("param k"), "{text}");
    let page = std::fs::read_to_string(folder.0.join("compare.html")).unwrap();
    for words in [
        "height: difference",
        "B − A",
        "A: bob",
        "B: bob",
        "rope_left.tension",
    ] {
        assert!(page.contains(words), "{words}");
    }
    let other = run(&["compare", "swing --set k=8kN/m", "linkage", "--out", &out]).unwrap();
    assert!(
        ["8.0000000 kN/m", "30.000000 N/m", "last height [m]"]
            .iter()
            .all(|told| other.contains(told)),
        "{other}"
    );
    let page = std::fs::read_to_string(folder.0.join("compare.html")).unwrap();
    assert!(page.contains("The runs share no output and no tension."));
    // The shorter one is drawn while it lasts; on paper both stand still, one by one.
    for words in [
        "s, while it runs.",
        "A: Swing: the mechanism",
        "B: Linkage: the mechanism",
    ] {
        assert!(page.contains(words), "{words}");
    }
    for wrong in [
        &["compare", "swing"][..],
        &["compare", "swing", "nothing"],
        &["compare", "swing", "swing --dt"],
    ] {
        assert_eq!(run(wrong).unwrap_err().code(), 1);
    }
}
