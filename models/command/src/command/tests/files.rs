//! What is read and written: folders, full disks, special files.

use super::*;

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

#[test]
fn a_file_in_another_encoding_is_answered_with_its_line() {
    let folder = Folder::new("encoding");
    let path = folder.0.join("latin.mbd");
    std::fs::write(
        &path,
        b"model A {\n    // 30\xb0 at the start\n    gravity: none;\n}\n",
    )
    .unwrap();
    let error = run(&["check", &path.display().to_string()]).unwrap_err();
    let told = error.to_string();
    assert!(
        told.contains("line 2 is no text in UTF-8; save the file as UTF-8"),
        "{told}"
    );
}

/// A run of no time shows where the scene begins, and says that it does.
#[test]
fn a_run_of_no_time_shows_the_start_alone() {
    let folder = Folder::new("no_time");
    let out = folder.0.display().to_string();
    for method in ["tsit5", "rk4", "rodas5p", "rattle"] {
        let told = run(&[
            "run", "swing", "--until", "0", "--method", method, "--out", &out,
        ])
        .unwrap();
        assert!(!told.contains("NaN") && !told.contains("inf"), "{told}");
        assert!(!told.contains("simulated seconds a second"), "{told}");
        let rows = std::fs::read_to_string(folder.0.join("history.csv")).unwrap();
        assert_eq!(rows.lines().count(), 2, "{rows}");
        let page = std::fs::read_to_string(folder.0.join("report.html")).unwrap();
        assert!(page.contains("The history is one instant, 0 s: it does not move."));
    }
    let error = run(&["run", "swing", "--until=-1 s", "--out", &out]).unwrap_err();
    assert!(
        error.to_string().contains("must not be negative"),
        "{error}"
    );
}
