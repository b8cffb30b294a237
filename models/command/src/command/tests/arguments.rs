//! What is typed: help, flags, names of scenes and params.

use super::*;

#[test]
fn help_is_no_error_and_a_typing_mistake_is_one() {
    assert!(run(&["--help"]).unwrap().contains("Exit codes"));
    assert!(run(&["run", "--help"]).unwrap().contains("--dt"));
    assert_eq!(run(&["chek"]).unwrap_err().code(), 1);
    assert_eq!(run(&["check"]).unwrap_err().code(), 1);
    assert_eq!(
        run(&["run", "swing", "--dt", "1", "--tol", "1"])
            .unwrap_err()
            .code(),
        1
    );
}

#[test]
fn the_words_of_a_file_are_flags_too() {
    let folder = Folder::new("words");
    let out = folder.0.join("out").display().to_string();
    let told = run(&[
        "run",
        "swing",
        "--tolerance",
        "1e-6",
        "--end",
        "0.1 s",
        "--out",
        &out,
    ]);
    assert!(told.expect("a run").contains("Tsit5"));
    let told = run(&[
        "run", "swing", "--step", "2 ms", "--end", "0.1 s", "--out", &out,
    ]);
    assert!(told.expect("a run").contains("RK4"));
}

#[test]
fn an_unknown_scene_is_a_usage_error_with_a_suggestion() {
    let error = run(&["run", "swnig"]).unwrap_err();
    assert_eq!(error.code(), 1);
    assert!(
        error.to_string().contains("did you mean `swing`"),
        "{error}"
    );
    assert_eq!(run(&["check", "not_here.toml"]).unwrap_err().code(), 1);
}

#[test]
fn flags_go_before_the_file() {
    let folder = Folder::new("flags");
    let out = folder.0.join("out").display().to_string();
    let flags = [
        "--dt",
        "2 ms",
        "--until",
        "0.1",
        "--every",
        "10ms",
        "--set",
        "k=20 kN/m",
        "--json",
    ];
    let told = run(&[&["run", "swing", "--out", &out][..], &flags].concat()).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert_eq!(summary["method"], "rk4");
    assert_eq!(summary["step_s"], 0.002);
    assert_eq!(summary["reached_s"], 0.1);
    assert_eq!(summary["params"]["k"], 20e3);
    let history = std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap();
    assert_eq!(history.lines().count(), 1 + 11);
}

#[test]
fn a_param_that_does_not_exist_or_leaves_its_range_is_invalid() {
    let folder = Folder::new("params");
    let out = folder.0.join("out").display().to_string();
    for (set, what) in [
        ("kk=1", "no `kk`"),
        ("k=1 kg", "wrong unit"),
        ("k=5000", "`5000` needs a unit, such as kN/m"),
        ("m_bob=20 kg", "range"),
        ("k", "NAME=VALUE"),
    ] {
        let error = run(&["run", "swing", "--out", &out, "--set", set]).unwrap_err();
        assert_eq!(error.code(), if set == "k" { 1 } else { 2 }, "{set}");
        assert!(error.to_string().contains(what), "{set}: {error}");
    }
    assert!(!folder.0.join("out").exists());
}

#[test]
fn mbd_alone_says_what_it_does_how_long_it_takes_and_where_the_help_is() {
    let told = parachute::announced(&ParachuteArgs::default());
    assert_eq!(told.lines().count(), 1);
    for part in [
        "flying the parachute",
        "minute",
        "out/parachute",
        "`mbd --help`",
    ] {
        assert!(told.contains(part), "{told}");
    }
}
