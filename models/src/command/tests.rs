//! What is typed, and what comes of it.

use super::scene_file::SceneFile;
use super::*;

mod campaign;
mod fmt;
mod metrics;
mod phases;

fn run(arguments: &[&str]) -> Result<String, Failure> {
    answer(["mbd"].iter().chain(arguments).map(OsString::from))
}

/// A folder of one test, taken away at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mbd_{name}_{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

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

/// A buffer before a full disk: it takes everything and fails where it has to give it on.
struct Full;

impl Write for Full {
    fn write(&mut self, text: &[u8]) -> std::io::Result<usize> {
        Ok(text.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Err(ErrorKind::StorageFull.into())
    }
}

#[test]
fn output_that_cannot_be_written_is_an_error_and_a_reader_who_left_is_none() {
    let folder = Folder::new("full");
    let out = folder.0.join("out").display().to_string();
    for arguments in [
        &["list"][..],
        &["check", "swing"],
        &["convert", "swing"],
        &["run", "swing", "--json", "--until", "0.01 s", "--out", &out],
    ] {
        let text = run(arguments).unwrap();
        let mut streams: Vec<Box<dyn Write>> = vec![Box::new(Full)];
        let device = std::fs::OpenOptions::new().write(true).open("/dev/full");
        streams.extend(device.map(|device| Box::new(device) as Box<dyn Write>));
        for stream in &mut streams {
            let error = print(&text, stream).unwrap_err();
            assert_eq!(error.code(), 1, "{arguments:?}");
            assert!(error.to_string().contains("cannot write"), "{error}");
        }
        let (reader, mut writer) = std::io::pipe().unwrap();
        drop(reader);
        assert!(print(&text, &mut writer).is_ok(), "{arguments:?}");
    }
}

/// A name of a device that takes nothing, put where the file is written before it gets its name.
#[cfg(target_os = "linux")]
#[test]
fn a_run_that_finds_the_disk_full_names_the_file_and_leaves_no_summary() {
    let folder = Folder::new("full_disk");
    let out = folder.0.display().to_string();
    let arguments = ["run", "swing", "--until", "0.01 s", "--out", &out];
    run(&arguments).unwrap();
    let before = std::fs::read(folder.0.join("history.csv")).unwrap();
    for name in ["history.csv", "report.html", "summary.json"] {
        let part = folder.0.join(format!("{name}.part"));
        std::os::unix::fs::symlink("/dev/full", &part).unwrap();
        let error = run(&arguments).unwrap_err();
        assert_eq!(error.code(), 1, "{error}");
        assert!(error.to_string().contains(name), "{error}");
        assert!(!folder.0.join("summary.json").exists(), "{name}");
        let kept = std::fs::read(folder.0.join("history.csv")).unwrap();
        assert_eq!(kept.len(), before.len(), "{name}");
        assert!(!part.exists(), "{name}");
    }
    run(&arguments).unwrap();
    assert!(folder.0.join("summary.json").exists());
}

#[test]
fn what_is_no_file_is_refused_before_it_is_read() {
    let folder = Folder::new("special");
    let name = folder.0.display().to_string();
    for path in [name.as_str(), "/dev/zero"] {
        if !std::path::Path::new(path).exists() {
            continue;
        }
        for command in ["check", "run", "convert"] {
            let error = run(&[command, path]).unwrap_err();
            assert_eq!(error.code(), 1);
            assert!(error.to_string().contains("no ordinary file"), "{error}");
        }
    }
}

#[test]
fn the_quantities_of_a_scene_are_listed_with_units() {
    let text = run(&["list", "quantities", "four_bar"]).unwrap();
    for part in [
        "rad/s^2",
        "outputs, metrics, events",
        ".force",
        "_acceleration",
        "m/s",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert_eq!(run(&["list", "quantities", "swnig"]).unwrap_err().code(), 1);
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
fn a_ready_scene_expands_to_the_functions_it_was_compiled_with() {
    // `emit: [outputs, energy, lines, reactions, mass_matrix];`
    let text = run(&["expand", "four_bar"]).unwrap();
    for emitted in [
        "fn derivative",
        "fn reactions",
        "fn mass_matrix",
        "fn projection_step",
    ] {
        assert!(text.contains(emitted), "{emitted}");
    }
    for absent in ["fn multipliers", "fn momentum", "fn constraint_bias"] {
        assert!(!text.contains(absent), "{absent}");
    }
}

#[test]
fn a_ready_scene_is_checked_expanded_and_converted_by_its_name() {
    for (name, word) in [
        ("heavy_top", "HeavyTop"),
        ("drop", "Drop"),
        ("parachute", "ParachuteRate"),
    ] {
        let told = run(&["check", name]).unwrap();
        assert!(
            told.contains(&format!("Scene {word}")) && !told.contains("warning"),
            "{told}"
        );
        assert!(
            run(&["expand", name])
                .unwrap()
                .contains(&format!("struct {word}Params"))
        );
        let toml = run(&["convert", name]).unwrap();
        assert!(toml.contains(&format!("model = \"{word}")) && toml.contains("[run.start]"));
    }
    for command in ["check", "expand", "convert", "run"] {
        let error = run(&[command, "heavytop"]).unwrap_err();
        assert_eq!(error.code(), 1);
        assert!(
            error.to_string().contains("did you mean `heavy_top`"),
            "{error}"
        );
    }
}

#[test]
fn scene_files_of_one_model_name_have_folders_of_their_own() {
    let folder = Folder::new("folders");
    let text = run(&["convert", "swing"]).unwrap();
    let one = folder.file("one.toml", &text);
    let other = folder.file("other.toml", &text);
    let as_text = folder.file("other.mbd", "");
    let ready = folder.file("drop.toml", &text);
    let names = [&one, &other, &as_text, &ready].map(|file| run::folder_name(file.as_ref()));
    let ready = run::folder_name("drop".as_ref());
    for (index, name) in names.iter().enumerate() {
        assert!(
            !names[..index].contains(name) && *name != ready,
            "{names:?}"
        );
    }
    assert!(names[0].ends_with("one"), "{names:?}");
    assert_ne!(
        run::folder_name("parachute".as_ref()),
        PathBuf::from("parachute")
    );
}

/// A pendulum of 1 m whose start says where its bob is, and nothing of its attitude.
const PENDULUM: &str = "pub model Pendulum {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame pivot at [0, 0, 1] m }
    joint pin: hinge from world to rod.pivot { axis: y }
}";

#[test]
fn a_start_that_the_joints_do_not_allow_is_told() {
    let folder = Folder::new("start");
    let out = folder.0.join("out").display().to_string();
    let flown = |start: &str| {
        let run_table = format!("[run]\nuntil = \"0.1 s\"\n[run.start]\n{start}");
        let file = folder.file("pendulum.mbd", &format!("{PENDULUM}\n{run_table}\n"));
        run(&["run", &file, "--out", &out]).unwrap()
    };
    // 30°, of the position alone: the nearest that the hinge allows is another angle.
    let told = flown("rod.x = \"-0.5 m\"\nrod.z = \"-0.8660254 m\"");
    let first = told.lines().next().unwrap();
    assert!(
        first.starts_with("warning: `rod` does not start where"),
        "{told}"
    );
    // The attitude with it, to the digits that a person writes: 30° about y.
    let fits = flown("rod.x = \"-0.5 m\"\nrod.z = \"-0.866 m\"\nrod.qw = 0.9659\nrod.qy = 0.2588");
    assert!(!fits.contains("warning"), "{fits}");
    let json = std::fs::read_to_string(folder.0.join("out/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
    let moved = &summary["start_moved"];
    assert_eq!(moved["name"], "rod");
    assert!(moved["distance_m"].as_f64().unwrap() < 1e-3, "{moved}");
}

#[test]
fn a_start_is_said_in_joint_coordinates() {
    let folder = Folder::new("joint_start");
    let out = folder.0.join("out").display().to_string();
    let flown = |start: &str| {
        let run_table = format!("[run]\nuntil = \"0.1 s\"\n[run.start]\n{start}");
        let file = folder.file("pendulum.mbd", &format!("{PENDULUM}\n{run_table}\n"));
        run(&["run", &file, "--out", &out])
    };
    let told = flown("pin.angle = \"30 deg\"\npin.angle_rate = \"1 rad/s\"").unwrap();
    assert!(!told.contains("warning"), "{told}");
    let history = std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap();
    let mut lines = history.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let first: Vec<f64> = lines
        .next()
        .unwrap()
        .split(',')
        .map(|x| x.parse().unwrap_or(f64::NAN))
        .collect();
    let column = |name: &str| {
        first[header
            .iter()
            .position(|known| known.starts_with(name))
            .unwrap()]
    };
    let (sin, cos) = 30f64.to_radians().sin_cos();
    assert!((column("rod.x") + sin).abs() < 1e-12 && (column("rod.z") + cos).abs() < 1e-12);
    assert!((column("rod.vx") + cos).abs() < 1e-12, "1 m at 1 rad/s");
    for (start, said) in [
        ("pin.angel = \"30 deg\"", "did you mean `pin.angle`"),
        ("pin.angle = \"30 m\"", "wrong unit"),
        (
            "pin.angle = \"30 deg\"\nrod.x = \"0.1 m\"",
            "placed already",
        ),
    ] {
        let error = flown(start).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn a_compiled_scene_and_its_toml_run_to_the_same_history() {
    let folder = Folder::new("compiled");
    let toml = folder.file(
        "pendulum.toml",
        &run(&["convert", "double_pendulum"]).unwrap(),
    );
    let histories = ["double_pendulum", &toml].map(|scene| {
        let out = folder.0.join("out").display().to_string();
        run(&["run", scene, "--out", &out, "--until", "0.5 s"]).unwrap();
        assert!(folder.0.join("out/mechanism.svg").is_file());
        std::fs::read(folder.0.join("out/history.csv")).unwrap()
    });
    assert_eq!(histories[0], histories[1]);
}

#[test]
fn every_listed_scene_runs() {
    for name in list::names() {
        let folder = Folder::new(&format!("list_{name}"));
        let out = folder.0.join("out").display().to_string();
        let told = run(&["run", name, "--out", &out, "--until", "0.3"]).unwrap();
        assert!(told.contains("report.html"), "{told}");
        assert!(folder.0.join("out/summary.json").is_file());
    }
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
fn a_run_that_stops_early_says_why_and_keeps_its_files() {
    let folder = Folder::new("early");
    let out = folder.0.join("out").display().to_string();
    let error = run(&[
        "run",
        "swing",
        "--out",
        &out,
        "--set",
        "k=100 kN/m",
        "--set",
        "m_bob=0.1 kg",
        "--dt",
        "0.05",
        "--until",
        "50",
    ])
    .unwrap_err();
    assert_eq!(error.code(), 4);
    assert!(folder.0.join("out/history.csv").is_file());
}

#[test]
fn every_mistake_of_a_file_is_told_with_its_place() {
    let folder = Folder::new("mistakes");
    let drop = include_str!("../../scenes/drop.toml");
    let text = drop
        .replace("\"16 kg\"", "\"16 kgs\"")
        .replace("\"chute.riser_end\"", "\"chute.riser\"")
        .replace("until =", "untl =");
    let path = folder.file("scene.toml", &text);
    for command in ["check", "run", "expand", "convert"] {
        let error = run(&[command, &path]).unwrap_err();
        assert_eq!(error.code(), 2);
        let told = error.to_string();
        let place = |what: &str| text.lines().position(|line| line.contains(what)).unwrap() + 1;
        for (what, word) in [("16 kgs", "`kgs`"), ("\"chute.riser\"", "`riser`")] {
            let line = told
                .lines()
                .find(|line| line.contains(word))
                .unwrap_or_else(|| panic!("{told}"));
            assert!(
                line.starts_with(&format!("{path}:{}:", place(what))),
                "{told}"
            );
        }
        // The line itself, and a caret under the word.
        let shown = format!(" {} | mass = \"16 kgs\"", place("16 kgs"));
        let (_, after) = told.split_once(&shown).unwrap_or_else(|| panic!("{told}"));
        assert_eq!(
            after.lines().nth(1).map(str::trim_end),
            Some("    |            ^^^")
        );
        assert!(!told.contains('\x1b'), "{told}");
        assert!(
            told.contains(&format!("line {}", place("untl")))
                && told.contains("unknown field `untl`"),
            "{told}"
        );
        assert!(told.ends_with("3 errors"), "{told}");
    }
}

#[test]
fn a_scene_survives_conversion_to_toml_and_runs_to_the_same_history() {
    let folder = Folder::new("convert");
    let text = folder.file("swing.mbd", include_str!("../../scenes/swing.mbd"));
    let toml = folder.file("swing.toml", &run(&["convert", &text]).unwrap());
    let histories = [&text, &toml].map(|path| {
        let out = folder.0.join("out").display().to_string();
        run(&["run", path, "--out", &out, "--until", "0.5 s"]).unwrap();
        std::fs::read(folder.0.join("out/history.csv")).unwrap()
    });
    assert_eq!(histories[0], histories[1]);
}

#[test]
fn check_tells_bodies_nodes_and_operations() {
    let folder = Folder::new("check");
    let told = run(&[
        "check",
        &folder.file("drop.toml", include_str!("../../scenes/drop.toml")),
    ])
    .unwrap();
    for word in [
        "Scene Drop",
        "capsule",
        "stepwise (bdf2)",
        "leg[2]",
        "derivative of the state",
        "riser_k",
    ] {
        assert!(told.contains(word), "{word}:\n{told}");
    }
    let expanded = run(&[
        "expand",
        &folder.file("again.toml", include_str!("../../scenes/drop.toml")),
    ])
    .unwrap();
    assert!(expanded.contains("struct DropParams"));
}

/// A four-bar with a fifth hinge across it, in space or in a plane, as a declaration.
const LOCKED: &str = "model Locked { planar: xz; gravity: none; world { frame far at [2, 0, 0] m }
    body left { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame root at [0, 0, -0.5] m, frame tip at [0, 0, 0.5] m }
    body right { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame root at [0, 0, -0.7] m, frame tip at [0, 0, 0.7] m }
    joint a: hinge from world to left.root { axis: y }
    joint b: hinge from left.tip to right.tip { axis: y }
    joint close: hinge from world.far to right.root { axis: y } }
[run]
until = \"1 s\"
";

#[test]
fn a_scene_that_cannot_move_is_refused_by_every_command_in_the_words_of_the_macro() {
    let folder = Folder::new("locked");
    let (scene, settings) = LOCKED.split_once("[run]").unwrap();
    let read = mbd_compiler::read_text(scene).scene.unwrap();
    let toml = format!("{}\n[run]{settings}", mbd_compiler::write_toml(&read));
    let out = folder.0.join("out").display().to_string();
    for file in [
        folder.file("locked.mbd", LOCKED),
        folder.file("locked.toml", &toml),
    ] {
        for command in ["check", "expand", "convert", "run"] {
            let flags: &[&str] = if command == "run" {
                &["--out", &out]
            } else {
                &[]
            };
            let error = run(&[&[command, &file][..], flags].concat()).unwrap_err();
            assert_eq!(error.code(), 2);
            assert!(
                error.to_string().contains("model `Locked` cannot move: the 6 rows of its joints hold all 6 speeds; take a joint away"),
                "{command} {file}: {error}"
            );
        }
    }
    assert!(!folder.0.join("out").exists());
}

#[test]
fn a_motor_that_has_nothing_to_drive_is_refused_by_every_command() {
    let folder = Folder::new("idle");
    let driven = |axis: &str| format!("{{ axis: {axis}, motor: 1 rad/s * time }}");
    let text = format!(
        "model Idle {{ planar: xy; gravity: none; body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
           joint one: hinge from world to a.com {}
           joint two: hinge from world to a.com {} }}",
        driven("z"),
        driven("z")
    );
    let file = folder.file("idle.mbd", &text);
    for command in ["check", "expand", "convert", "run"] {
        let error = run(&[command, &file]).unwrap_err();
        assert_eq!(error.code(), 2);
        assert!(
            error.to_string().contains("`two` cannot drive its `angle`"),
            "{command}: {error}"
        );
    }
}

/// A planar four-bar as text and how it is run.
const PLANAR: &str = include_str!("../../scenes/linkage.mbd");

#[test]
fn a_planar_scene_is_checked_expanded_converted_and_run_and_its_drawing_looks_along_the_normal() {
    let folder = Folder::new("planar");
    let text = folder.file("linkage.mbd", PLANAR);
    let toml = folder.file("linkage.toml", &run(&["convert", &text]).unwrap());
    let histories = [&text, &toml].map(|file| {
        let told = run(&["check", file]).unwrap();
        for word in ["freedoms (Grübler): 3·3 + 2·1 − 8 = 3", "Scene Linkage"] {
            assert!(told.contains(word), "{word}\n{told}");
        }
        assert!(
            run(&["expand", file])
                .unwrap()
                .contains("struct LinkageState")
        );
        let out = folder.0.join("out").display().to_string();
        run(&["run", file, "--out", &out, "--until", "0.5 s"]).unwrap();
        let drawing = std::fs::read_to_string(folder.0.join("out/mechanism.svg")).unwrap();
        assert!(drawing.contains("the mechanism, xz plane"));
        assert!(!folder.0.join("out/mechanism_2.svg").exists());
        std::fs::read_to_string(folder.0.join("out/history.csv")).unwrap()
    });
    assert_eq!(histories[0], histories[1]);
    let head = histories[0].lines().next().unwrap();
    for column in ["crank.x", "crank.z", "crank.angle", "weight.z"] {
        assert!(head.contains(column), "{column}: {head}");
    }
    for absent in ["crank.y", "crank.qw", "weight.y", "crank.omega_body_x"] {
        assert!(!head.contains(absent), "{absent}: {head}");
    }
}

#[test]
fn settings_that_no_run_can_hold_are_refused_before_it() {
    let folder = Folder::new("settings");
    for (setting, what) in [
        ("every = \"1e-300 s\"", "`every`: asks for"),
        ("every = \"0 s\"", "`every`: must be positive"),
        ("until = \"-1 s\"", "`until`: must be positive"),
        ("until = nan", "`until`: give it a finite value"),
        (
            "tolerance = \"1 s\"",
            "`tolerance`: `1 s` has the wrong unit",
        ),
    ] {
        let key = setting.split(' ').next().unwrap();
        let lines = PLANAR.lines().filter(|line| !line.starts_with(key));
        let text = lines.collect::<Vec<_>>().join("\n");
        let text = text.replace("[run]", &format!("[run]\n{setting}"));
        let error = run(&["run", &folder.file("linkage.mbd", &text)]).unwrap_err();
        assert_eq!(error.code(), 2, "{error}");
        assert!(error.to_string().contains(what), "{setting}: {error}");
    }
}

#[test]
fn a_motor_without_a_value_is_named_as_the_cause() {
    let folder = Folder::new("nan_motor");
    let text = "model M { planar: xz; gravity: none;
          body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [0, 0, 0.5] m }
          joint pin: hinge from world to a.one { axis: y, motor: sqrt(0.5 - time * 1 rad/s) } }
        [run]\nuntil = \"2 s\"\nstep = \"10 ms\"\n";
    let out = folder.0.join("out").display().to_string();
    for (text, time) in [
        (text.to_owned(), "at 0.5"),
        (text.replace("0.5 - time", "-0.5 - time"), "at 0.0"),
    ] {
        let error = run(&["run", &folder.file("m.mbd", &text), "--out", &out]).unwrap_err();
        let told = error.to_string();
        println!("{told}");
        assert_eq!(error.code(), 4);
        assert!(
            told.contains("`pin`") && told.contains("motor") && told.contains(time),
            "{told}"
        );
    }
}

#[test]
fn a_coordinate_that_a_plane_does_not_have_is_told_with_those_it_has() {
    let folder = Folder::new("plane_start");
    for (wrong, right) in [
        ("crank.y = \"1 m\"", "crank.x"),
        ("crank.qw = 1.0", "crank.angle"),
        ("crank.omega_body_y = \"1 rad/s\"", "omega"),
        ("weight.y = \"1 m\"", "weight.x"),
    ] {
        let text = PLANAR.replace("[run.start]", &format!("[run.start]\n{wrong}"));
        let file = folder.file("linkage.mbd", &text);
        let error = run(&["run", &file]).unwrap_err();
        let told = error.to_string();
        assert_eq!(error.code(), 2, "{told}");
        let name = wrong.split(" =").next().unwrap();
        println!("{told}");
        assert!(told.contains(name) && told.contains(right), "{told}");
    }
}

#[test]
fn linearise_tells_coordinates_and_frequencies_of_a_ready_scene() {
    let text = run(&["linearise", "double_pendulum"]).unwrap();
    assert!(
        text.contains("Eigenvalues") && text.contains("damping"),
        "{text}"
    );
    let error = run(&["linearise", "linkage", "--along", "crank.angel"]).unwrap_err();
    assert_eq!(error.code(), 2);
    assert!(
        error.to_string().contains("`crank.angel` is no coordinate"),
        "{error}"
    );
    let text = run(&["linearise", "linkage", "--trim"]).unwrap();
    assert!(text.contains("about the rest"), "{text}");
}

#[test]
fn mistakes_are_coloured_for_a_terminal_only() {
    let folder = Folder::new("coloured");
    let file = folder.file("m.mbd", "model M {\n\tgravity: nome;\n}\n");
    let Err(Failure::Mistakes(mistakes)) = run(&["check", &file]) else {
        panic!("accepted");
    };
    let (plain, coloured) = (mistakes.text(Paint::Plain), mistakes.text(Paint::Coloured));
    // A tab stays a tab, so that the caret stands under its word.
    assert!(
        plain.contains(" 2 | \tgravity: nome;\n   | \t         ^^^^"),
        "{plain}"
    );
    assert!(
        !plain.contains('\x1b') && coloured.contains("\x1b[1;31m^^^^\x1b[0m"),
        "{coloured}"
    );
    let mut bare = coloured.clone();
    for code in ["\x1b[1m", "\x1b[1;31m", "\x1b[1;34m", "\x1b[0m"] {
        bare = bare.replace(code, "");
    }
    assert_eq!(bare, plain);
}

#[test]
fn check_tells_programs_what_a_scene_contains_and_where_it_is_wrong() {
    let told: serde_json::Value =
        serde_json::from_str(&run(&["check", "swing", "--json"]).unwrap()).unwrap();
    assert_eq!(told["valid"], true);
    assert_eq!(told["scene"], "Swing");
    assert_eq!(told["lines"][2], "fall");
    assert_eq!(told["params"][0]["name"], "k");
    assert_eq!(told["params"][0]["range"][1], 100e3);
    assert_eq!(told["outputs"][0]["unit"], "m");
    let folder = Folder::new("json");
    let file = folder.file(
        "m.mbd",
        "model M {\n  gravity: nome;\n  body a { mass: 1 }\n}\n",
    );
    let failure = run(&["check", &file, "--json"]).unwrap_err();
    assert_eq!(failure.code(), 2);
    let told: serde_json::Value = serde_json::from_str(&failure.to_string()).unwrap();
    assert_eq!(told["valid"], false);
    let places: Vec<_> = told["errors"].as_array().unwrap().iter().collect();
    assert_eq!(places[0]["line"], 2);
    assert_eq!(places[0]["column"], 12);
    assert!(
        places[0]["text"]
            .as_str()
            .unwrap()
            .contains("did you mean `none`"),
        "{told}"
    );
    assert_eq!(places[1]["line"], 3);
}

#[test]
fn a_ready_scene_expands_without_warnings_about_what_its_data_no_longer_uses() {
    for name in list::names() {
        let text = run(&["expand", name]).unwrap();
        // What an unused name becomes: see `unused` of the compiler.
        for warned in [
            "struct Declaration",
            "deprecated",
            "#[allow(non_snake_case, non_upper_case_globals)]",
        ] {
            assert!(!text.contains(warned), "{name}: {warned}");
        }
    }
}

#[test]
fn every_ready_scene_is_the_same_in_both_forms() {
    for name in list::names() {
        let folder = Folder::new(&format!("forms_{name}"));
        let (toml, text) = (
            run(&["convert", name]).unwrap(),
            run(&["convert", name, "--to", "mbd"]).unwrap(),
        );
        let read = |file: &str| SceneFile::find(file.as_ref()).unwrap();
        let toml = read(&folder.file("scene.toml", &toml));
        let text = read(&folder.file("scene.mbd", &text));
        assert_eq!(toml.scene, text.scene, "{name}");
        assert_eq!(toml.settings, text.settings, "{name}");
    }
    // A document keeps its repetitions and units; any other form is an error that names both.
    let text = run(&["convert", "drop", "--to", "mbd"]).unwrap();
    for kept in [
        "pub model Drop<T> {",
        "line leg[i in 0..3] from capsule.bridle[i]",
        "const RHO = 0.014 kg/m^3;",
    ] {
        assert!(text.contains(kept), "{kept}\n{text}");
    }
    let error = run(&["convert", "drop", "--to", "json"])
        .unwrap_err()
        .to_string();
    assert!(error.contains("toml, mbd"), "{error}");
}

#[test]
fn a_run_is_given_up_after_the_steps_it_may_take() {
    let folder = Folder::new("max_steps");
    let out = folder.0.join("out").display().to_string();
    let error = run(&[
        "run",
        "swing",
        "--out",
        &out,
        "--dt",
        "1 ms",
        "--max-steps",
        "20",
    ])
    .unwrap_err();
    assert_eq!(error.code(), 4);
    assert!(error.to_string().contains("20 steps"), "{error}");
    let none = run(&["run", "swing", "--out", &out, "--max-steps", "0"]).unwrap_err();
    assert_eq!(none.code(), 2);
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

/// A pendulum on a soft rope, declared as a file.
const ROPE: &str = "model Rope { gravity: [0, 0, -9.81] m/s^2;
      point bob { mass: 1 kg, start at [0.9, 0, -0.6] m }
      spring rope from world to bob { free_length: 1 m, stiffness: 200 N/m, damping: 1 N*s/m }
      output height = bob.position.z; }
    [run]\nuntil = \"2 s\"\n";

#[test]
fn a_trade_says_what_meets_the_error_that_is_wanted() {
    let folder = Folder::new("trade");
    let file = folder.file("rope.mbd", ROPE);
    let out = folder.0.join("out").display().to_string();
    let asked = ["--output", "height", "--within", "1e-6", "--out", &out];
    let told = run(&[&["trade", file.as_str()], &asked[..]].concat()).unwrap();
    assert!(told.contains("for height within 1.0e-6: take "), "{told}");
    for method in [
        "RK4",
        "Rattle",
        "Tsit5",
        "Vern7",
        "Rodas5P",
        "single precision",
    ] {
        assert!(told.contains(method), "{method}: {told}");
    }
    for name in ["trade.csv", "trade.svg", "trade.html"] {
        assert!(folder.0.join("out").join(name).is_file(), "{name}");
    }
    // What is advised is as good as it was asked to be, and so is its repetition by itself.
    let alone = run(&[&["advise", file.as_str()], &asked[..4]].concat()).unwrap();
    let error = alone.split("error ").nth(1);
    let error = error.and_then(|rest| rest.split(' ').next()?.parse().ok());
    assert!(
        error.is_some_and(|error: f64| error <= 1e-6 / 3.0),
        "{alone}"
    );
}

#[test]
fn a_trade_races_both_families_of_coordinates() {
    let folder = Folder::new("families");
    let text = "model Arms { coordinates: auto; gravity: [0, 0, -9.81] m/s^2;
          body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
          body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
          joint p: hinge from world to a.top { axis: y, start: 0.7 rad }
          joint q: hinge from a.end to b.top { axis: x, start: 0.4 rad }
          output swing = b.position.x; }
        [run]\nuntil = \"1 s\"\n";
    for (declared, other) in [("auto", "absolute"), ("absolute", "relative")] {
        let text = text.replace("auto", declared);
        let file = folder.file("arms.mbd", &text);
        let out = folder.0.join("out").display().to_string();
        let told = run(&["trade", &file, "--output", "swing", "--out", &out]).unwrap();
        let other = format!("{other} coordinates");
        let row = told
            .lines()
            .find(|line| line.contains(&other) && line.contains("Vern7"));
        let row = row.unwrap_or_else(|| panic!("{other}: {told}"));
        // The motion is the same: the finest setting is as near to the reference as that of the declared family.
        assert!(told.contains("single precision"), "{row}");
        let errors = told.lines().filter(|line| line.contains(&other));
        let errors = errors.filter_map(|line| line.split_whitespace().rev().nth(2)?.parse().ok());
        let best = errors.fold(f64::INFINITY, f64::min);
        assert!(best < 1e-9, "{other}: {best}");
    }
    let told = run(&["check", &folder.file("arms.mbd", text)]).unwrap();
    for part in [
        "note: coordinates: relative: a step of RK4 takes ",
        "relative coordinates of the joints p, q",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn a_trade_that_cannot_be_measured_says_why() {
    let folder = Folder::new("no_trade");
    let file = folder.file("rope.mbd", ROPE);
    for (flags, what) in [
        (&["--output", "hight"][..], "no column `hight`"),
        (&["--output", "height", "--window", "3"], "--window `3`"),
        (
            &["--output", "height", "--window", "2..1"],
            "--window `2..1`",
        ),
        (&["--output", "height", "--within", "-1"], "--within -1"),
    ] {
        let error = run(&[&["advise", file.as_str()], flags].concat()).unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    }
    // References agree to rounding only: nothing is advised for less.
    let told = run(&["advise", &file, "--output", "height", "--within", "1e-20"]).unwrap();
    assert!(told.contains("no advice"), "{told}");
}

#[test]
fn every_promise_at_the_extremes_is_kept() {
    let folder = Folder::new("extremes");
    let out = folder.0.join("out").display().to_string();
    let told =
        run(&["extremes", "--reduced", "--out", &out]).unwrap_or_else(|error| panic!("{error}"));
    assert!(told.contains("67 of 67 promises kept"), "{told}");
    assert!(folder.0.join("out/report.html").is_file());
}

#[test]
fn a_run_that_is_less_accurate_than_one_percent_says_what_to_change() {
    let folder = Folder::new("inaccurate");
    let out = folder.0.join("out").display().to_string();
    // A double pendulum at a loose tolerance for half a minute: chaos.
    let text = "model Wild { gravity: [0, 0, -9.81] m/s^2;
          body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
          body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
          joint p: hinge from world to a.top { axis: y, start: 3.0 rad }
          joint q: hinge from a.end to b.top { axis: y, start: 0.1 rad }
          output swing = b.position.x; }
        [run]\nuntil = \"30 s\"\ntolerance = 1e-4\n";
    let file = folder.file("wild.mbd", text);
    let error = run(&["run", &file, "--out", &out]).unwrap_err();
    assert_eq!(error.code(), 3, "{error}");
    let told = error.to_string();
    for part in [
        "warning: Wild: `swing` is off by about",
        "tighter tolerance",
        "written to",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    // Without the second run there is only the energy, which is kept well enough.
    let told = run(&["run", &file, "--out", &out, "--no-estimate"]);
    assert!(told.is_ok_and(|told| !told.contains("off most")));
}

#[test]
fn the_advice_for_a_stiff_scene_is_the_stiff_method() {
    let folder = Folder::new("stiff_advice");
    let text = "model Stiff { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg, start at [0, 0, -1.5] m }
          spring rope from world to bob { free_length: 1 m, stiffness: 1e3 N/m, damping: 1e9 N*s/m }
          output height = bob.position.z; }
        [run]\nuntil = \"2 s\"\n";
    let file = folder.file("stiff.mbd", text);
    let told = run(&["advise", &file, "--output", "height"]).unwrap();
    assert!(told.contains("Rodas5P"), "{told}");
}

#[test]
fn a_robot_is_checked_converted_and_run_like_any_scene() {
    let folder = Folder::new("urdf");
    let arm = include_str!("../../../mbd-macros/compiler/tests/urdf/arm.urdf");
    let urdf = folder.file("arm.urdf", arm);
    let told = run(&["check", &urdf]).unwrap();
    assert!(told.contains("grip_mirror_mimic"), "{told}");
    let toml = folder.file("arm.toml", &run(&["convert", &urdf]).unwrap());
    assert_eq!(
        run(&["convert", &toml]).unwrap(),
        run(&["convert", &urdf]).unwrap()
    );
    let out = folder.0.join("out").display().to_string();
    let told = run(&["run", &urdf, "--until", "0.02", "--out", &out]).unwrap();
    assert!(told.contains("1 material, 1 visual"), "{told}");
    // A declaration names the file that lies beside it.
    let text = folder.file("arm.mbd", "model Arm { urdf: \"arm.urdf\" { base: free } }");
    assert!(run(&["check", &text]).unwrap().contains("base_link"));
    let broken = folder.file("arm.urdf", &arm.replace("\"2.5\"", "\"nan\""));
    for file in [&broken, &text] {
        let error = run(&["check", file]).unwrap_err();
        assert_eq!(error.code(), 2);
    }
}

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
        other.contains("param k") && other.contains("scene"),
        "{other}"
    );
    let page = std::fs::read_to_string(folder.0.join("compare.html")).unwrap();
    assert!(page.contains("The runs share no output and no tension."));
    assert!(page.contains("A ends at") || page.contains("B ends at"));
    for wrong in [
        &["compare", "swing"][..],
        &["compare", "swing", "nothing"],
        &["compare", "swing", "swing --dt"],
    ] {
        assert_eq!(run(wrong).unwrap_err().code(), 1);
    }
}
