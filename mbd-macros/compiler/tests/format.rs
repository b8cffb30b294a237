//! Formatting: the same lexemes and comments, other blanks.

mod dice;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use dice::Dice;
use mbd_compiler::{format_rust, format_text, read_text};

/// Every file below a folder whose name ends so.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|end| end == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The declaration of a scene file, without the settings of its run.
fn declaration(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let end = text.find("\n[run").map_or(text.len(), |end| end + 1);
    text[..end].to_owned()
}

fn formatted(text: &str) -> String {
    format_text(text).unwrap_or_else(|errors| panic!("{text}\n{errors:?}"))
}

#[test]
fn every_declaration_that_is_read_says_the_same_and_formatting_ends() {
    let mut count = 0;
    for path in files(&repository(), "mbd") {
        let text = declaration(&path);
        let name = path.display();
        let Ok(once) = format_text(&text) else {
            assert!(read_text(&text).scene.is_none(), "{name}");
            continue;
        };
        assert_eq!(formatted(&once), once, "{name}");
        assert_eq!(read_text(&once).scene, read_text(&text).scene, "{name}");
        let told = |text: &str| -> Vec<String> {
            let errors = read_text(text).errors.into_iter();
            errors.map(|error| error.text).collect()
        };
        let sorted = |mut texts: Vec<String>| {
            texts.sort();
            texts
        };
        assert_eq!(sorted(told(&once)), sorted(told(&text)), "{name}");
        count += 1;
    }
    assert!(count > 200, "{count}");
}

/// Compares a file with its formatted text; `UPDATE_GOLDEN` writes it.
fn compare(path: &Path, text: &str, written: &str) {
    if std::env::var_os("UPDATE_GOLDEN").is_some() && text != written {
        std::fs::write(path, written).unwrap();
    } else {
        assert!(text == written, "{}: not formatted", path.display());
    }
}

#[test]
fn the_scenes_of_this_repository_are_formatted() {
    let models = repository().join("models");
    for path in files(&models, "mbd") {
        let text = std::fs::read_to_string(&path).unwrap();
        let scene = declaration(&path);
        let run = text[scene.len()..].trim_start();
        compare(&path, &text, &format!("{}\n{run}", formatted(&scene)));
    }
}

/// Every file of Rust of this repository but what is built, and what is an expected answer of the compiler.
fn sources() -> Vec<PathBuf> {
    let root = repository();
    let folders = ["mbd-macros", "mbd-runtime", "models", "tests"];
    let all = folders
        .iter()
        .flat_map(|folder| files(&root.join(folder), "rs"));
    let own = |path: &PathBuf| {
        let mut parts = path.components();
        !parts.any(|part| {
            ["golden", "target"]
                .map(OsStr::new)
                .contains(&part.as_os_str())
        })
    };
    all.filter(own).collect()
}

#[test]
fn every_declaration_in_the_sources_of_this_repository_is_formatted() {
    let (mut count, mut templates) = (0, 0);
    for path in sources() {
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.display();
        let written = format_rust(&text).unwrap_or_else(|errors| panic!("{name}: {errors:?}"));
        compare(&path, &text, &written.text);
        count += usize::from(text.contains("model! {"));
        templates += written.left.len();
    }
    assert!(count > 100 && templates > 0, "{count} {templates}");
}

/// The examples in the documentation of items, as they stand between the signs of comments.
#[test]
fn the_declarations_in_examples_of_the_documentation_are_formatted() {
    let mut count = 0;
    for path in sources() {
        let text = std::fs::read_to_string(&path).unwrap();
        if !text.contains("```") {
            continue;
        }
        let mut written = String::new();
        let mut lines = text.split_inclusive('\n').peekable();
        let margin = |line: &str| {
            let sign = line.trim_start();
            let found = ["///", "//!"]
                .into_iter()
                .find(|doc| sign.starts_with(doc))?;
            Some(line[..line.len() - sign.len() + found.len()].to_owned())
        };
        while let Some(line) = lines.next() {
            written.push_str(line);
            let Some(margin) = margin(line).filter(|margin| line[margin.len()..].trim() == "```")
            else {
                continue;
            };
            let mut block = String::new();
            while let Some(line) = lines
                .next_if(|line| line.starts_with(&margin) && line[margin.len()..].trim() != "```")
            {
                let code = &line[margin.len()..];
                block.push_str(code.strip_prefix(' ').unwrap_or(code));
            }
            let formatted = format_rust(&block).map_or_else(|_| block.clone(), |file| file.text);
            count += usize::from(block.contains("model! {"));
            for line in formatted.split_inclusive('\n') {
                let blank = if line.trim().is_empty() { "" } else { " " };
                written.push_str(&format!("{margin}{blank}{line}"));
            }
            // The end of the block begins no other.
            written.extend(lines.next());
        }
        compare(&path, &text, &written);
    }
    assert!(count > 10, "{count}");
}

/// What the pages show as Rust.
#[test]
fn the_declarations_on_the_pages_are_formatted() {
    let root = repository();
    let mut pages = files(&root.join("docs"), "md");
    pages.extend(
        ["README.md", "mbd-macros/LANGUAGE.md", "models/README.md"].map(|name| root.join(name)),
    );
    let mut count = 0;
    for path in pages {
        let text = std::fs::read_to_string(&path).unwrap();
        let mut all = text.clone();
        for block in text.split("```rust\n").skip(1) {
            let block = block.split("```").next().unwrap();
            if let Ok(written) = format_rust(block) {
                all = all.replace(block, &written.text);
                count += usize::from(block.contains("model! {"));
            }
        }
        compare(&path, &text, &all);
    }
    assert!(count > 0);
}

#[test]
fn a_byte_order_mark_is_left_out() {
    let text = "model A {\n    gravity: none;\n}\n";
    assert_eq!(format_text(&format!("\u{feff}{text}")).unwrap(), text);
}

#[test]
fn a_unit_in_brackets_is_written_as_one_behind_a_number() {
    let text = |rate: &str, mass: &str| {
        format!(
            "model A {{\n    gravity: none;\n    state a = 1 m {{ rate: -0.1 ({rate}) * a }}\n    let b = {mass} * ([1, 2, 3] ({rate}) / 2).x;\n}}\n"
        )
    };
    let found = format_text(&text("1 / s", "2 (kN / m)")).unwrap();
    assert_eq!(found, text("1/s", "2 (kN/m)"));
}

#[test]
fn fields_stay_on_one_line_while_they_fit_and_were_not_written_one_a_line() {
    let before = "model A{gravity:none;point   a{mass:1kg,}
      point b {
      mass:2 kg }
      point a_very_long_name_of_a_point {mass: 1 kg, start at [0.0, 0.0, 0.0] m velocity [1.0, 0.0, 0.0] m/s}}";
    let after = "model A {
    gravity: none;
    point a { mass: 1 kg }
    point b {
        mass: 2 kg,
    }
    point a_very_long_name_of_a_point {
        mass: 1 kg,
        start at [0.0, 0.0, 0.0] m velocity [1.0, 0.0, 0.0] m/s,
    }
}
";
    assert_eq!(formatted(before), after);
}

#[test]
fn comments_and_groups_stay() {
    let before = "// Head.


/* Above. */
/// A model.
model A { // behind the brace

    // Settings.
    gravity: none; // no weight


    /* in front */ verify;
    body b { mass: /* heavy */ 1 kg, // one
        // the next
        inertia: diag(1, 1, 1) kg*m^2 // two
        // at the end
    }
    const long = 1 // the first
        + 2; /* after */
    // last

} // behind
// the end";
    let after = "// Head.

/* Above. */
/// A model.
model A { // behind the brace
    // Settings.
    gravity: none; // no weight

    /* in front */ verify;
    body b {
        mass: /* heavy */ 1 kg, // one
        // the next
        inertia: diag(1, 1, 1) kg*m^2, // two
        // at the end
    }
    const long = 1 // the first
        + 2; /* after */
    // last
} // behind
// the end
";
    assert_eq!(formatted(before), after);
    assert_eq!(formatted(after), after);
}

#[test]
fn signs_of_units_touch_and_operators_stand_apart() {
    let before = "model A { gravity: none; const a = 2.0kg*m ^ 2/s*-3; const b=2*a - -a ^2; param c=1 m in 0m..=2 m;
        state x:m/s=0 {rate:a*b/(1 s)} input w : [ m / s ;3]; input v[i in 0 .. = 2]:force; input u=6   V; }";
    let after = "model A {
    gravity: none;
    const a = 2.0 kg*m^2/s * -3;
    const b = 2 * a - -a^2;
    param c = 1 m in 0 m ..= 2 m;
    state x: m/s = 0 { rate: a * b / (1 s) }
    input w: [m/s; 3];
    input v[i in 0..=2]: force;
    input u = 6 V;
}
";
    assert_eq!(formatted(before), after);
}

#[test]
fn signs_between_conditions_stand_between_blanks() {
    let before = "model A { gravity: none; let a = if(time<1 s&&time>0 s||time > 3 s, 1, 2); let b = if (time<1 s)  &&  time>0 s {1} else {2}; }";
    let after = "model A {
    gravity: none;
    let a = if(time < 1 s && time > 0 s || time > 3 s, 1, 2);
    let b = if (time < 1 s) && time > 0 s { 1 } else { 2 };
}
";
    assert_eq!(formatted(before), after);
    assert_eq!(formatted(after), after);
}

#[test]
fn what_is_too_long_is_broken_where_it_binds_least() {
    let before = "model A { gravity: none; let drag = -0.5 * density * area_of_the_canopy * drag_coefficient * norm(velocity_of_air) * velocity_of_air + buoyancy_of_the_canopy * up;
        output far = if distance_to_the_target < 100 m { distance_to_the_target } else { 100 m + distance_to_the_target / 2 };
        table t = { 0 m: 0 N, 1 m: 10 N, 2 m: 20 N, 3 m: 30 N, 4 m: 40 N, 5 m: 50 N, 6 m: 60 N, 7 m: 70 N, 8 m: 80 N };
        table u = {
            0 m: 0 N, 1 m: 10 N,
            2 m: 20 N };
    }";
    let after = "model A {
    gravity: none;
    let drag = -0.5 * density * area_of_the_canopy * drag_coefficient * norm(velocity_of_air)
        * velocity_of_air
        + buoyancy_of_the_canopy * up;
    output far = if distance_to_the_target < 100 m {
        distance_to_the_target
    } else {
        100 m + distance_to_the_target / 2
    };
    table t = {
        0 m: 0 N, 1 m: 10 N, 2 m: 20 N, 3 m: 30 N, 4 m: 40 N, 5 m: 50 N, 6 m: 60 N, 7 m: 70 N,
        8 m: 80 N,
    };
    table u = {
        0 m: 0 N, 1 m: 10 N,
        2 m: 20 N,
    };
}
";
    assert_eq!(formatted(before), after);
    assert_eq!(formatted(after), after);
}

#[test]
fn a_long_start_is_broken_before_the_words_of_its_values() {
    let before = "model A { gravity: none; body a { start at [1.0, 2.0, 3.0] m rotated rpy(0.1, 0.2, 0.3) velocity [1.0, 0.0, 3.0] m/s angular_velocity [1.0, 2.0, 3.0] rad/s } }";
    let after = "model A {
    gravity: none;
    body a {
        start at [1.0, 2.0, 3.0] m rotated rpy(0.1, 0.2, 0.3) velocity [1.0, 0.0, 3.0] m/s
            angular_velocity [1.0, 2.0, 3.0] rad/s,
    }
}
";
    assert_eq!(formatted(before), after);
    assert_eq!(formatted(after), after);
}

#[test]
fn ends_of_lines_stay_what_they_are() {
    let unix = "model A {\n    // Größe\n    gravity: none;\n}\n";
    let other = unix.replace('\n', "\r\n");
    for written in ["model A {\n\t// Größe\n\tgravity: none; }", unix] {
        assert_eq!(formatted(written), unix);
        assert_eq!(formatted(&written.replace('\n', "\r\n")), other);
    }
}

#[test]
fn what_cannot_be_read_is_told_with_its_place() {
    let told = |text: &str| {
        let errors = format_text(text).unwrap_err();
        errors[0].in_file("a.mbd")
    };
    assert!(told("").starts_with("a.mbd:1:1: "), "{}", told(""));
    assert!(told("model A {\n  gravity none;\n}").starts_with("a.mbd:2:11: "));
    assert!(told("model A {\n  gravity: none;\n").contains("never closed"));
    assert!(told("model A { /* open").contains("never closed"));
    assert!(told("model A { gravity: none; #[doc = \"x\"] verify; }").contains("strings"));
    // Names and units are not looked at: a scene in the making can be formatted.
    assert!(format_text("model A { line a from b to c { length: 1 quux } }").is_ok());
}

fn rust(text: &str) -> String {
    let file = format_rust(text).unwrap_or_else(|errors| panic!("{text}\n{errors:?}"));
    file.text
}

#[test]
fn every_model_of_a_file_of_rust_is_formatted_and_nothing_else() {
    let before = "//! Größe: ü\nfn  f( ) { let model = \"model! { no }\"; }\nmod a {\n    mbd_runtime::model! {\n    /// First.\n pub model A { gravity: none; }  }\n}\nmodel!{ model B { gravity: none; } }\nmacro_rules! m { ($x:tt) => { model! {  pub model $x { gravity: none; } } } }\n";
    let after = "//! Größe: ü\nfn  f( ) { let model = \"model! { no }\"; }\nmod a {\n    mbd_runtime::model! {\n        /// First.\n        pub model A {\n            gravity: none;\n        }\n    }\n}\nmodel!{\n    model B {\n        gravity: none;\n    }\n}\nmacro_rules! m { ($x:tt) => { model! {  pub model $x { gravity: none; } } } }\n";
    assert_eq!(rust(before), after);
    assert_eq!(rust(after), after);
    let marked = format!("\u{feff}{before}");
    assert_eq!(rust(&marked), format!("\u{feff}{after}"));
    let other = |text: &str| text.replace('\n', "\r\n");
    assert_eq!(rust(&other(before)), other(after));
    let errors = format_rust("fn a() {}\nmodel! {\n  model A { gravity none; } }").unwrap_err();
    assert!(
        errors[0].in_file("a.rs").starts_with("a.rs:3:21: "),
        "{errors:?}"
    );
    let errors = format_rust("fn a() {\n  (").unwrap_err();
    assert!(errors[0].in_file("a.rs").contains("no Rust"), "{errors:?}");
    assert_eq!(rust(""), "");
}

#[test]
fn calls_with_any_brackets_are_formatted() {
    for (open, close) in [("{", "}"), ("(", ");"), ("[", "];")] {
        let before = format!("    model!{open} model A {{ gravity:none; }}\n {close}\n");
        let after = format!(
            "    model!{open}\n        model A {{\n            gravity: none;\n        }}\n    {close}\n"
        );
        assert_eq!(rust(&before), after);
        assert_eq!(rust(&after), after);
    }
}

#[test]
fn a_robot_alone_stays_on_its_line_and_more_than_that_has_an_item_a_line() {
    for (before, after) in [
        ("model!( urdf=\"a.urdf\" );", "model!(urdf = \"a.urdf\");"),
        ("model!{urdf = \"a.urdf\"}", "model!{ urdf = \"a.urdf\" }"),
        (
            "model!(\n\n urdf  = \"a.urdf\"\n);",
            "model!(urdf = \"a.urdf\");",
        ),
        (
            "model!(urdf=\"a.urdf\", gravity:none;output a=pin.angle;);",
            "model!(\n    urdf = \"a.urdf\",\n    gravity: none;\n    output a = pin.angle;\n);",
        ),
        (
            "model!(urdf=\"a.urdf\" // mine\n);",
            "model!(\n    urdf = \"a.urdf\" // mine\n);",
        ),
    ] {
        assert_eq!(rust(before), after);
        assert_eq!(rust(after), after);
    }
    let long = format!("model!(urdf = \"{}.urdf\");", "a".repeat(90));
    let broken = format!("model!(\n    urdf = \"{}.urdf\"\n);", "a".repeat(90));
    assert_eq!(rust(&long), broken);
}

#[test]
fn what_stays_as_it_is_is_told_with_its_place() {
    let text = "model! { model A { gravity:none; } }\nmacro_rules! m {\n    ($x:tt) => { model!(  model $x { gravity:none; } ); };\n}\n";
    let file = format_rust(text).unwrap();
    assert!(file.text.ends_with(text.split_once('\n').unwrap().1));
    let told: Vec<String> = file.left.iter().map(|it| it.in_file("a.rs")).collect();
    assert_eq!(told.len(), 1);
    assert!(
        told[0].starts_with("a.rs:3:24: this declaration has a `$` in it"),
        "{told:?}"
    );
}

/// Blanks, ends of lines and comments thrown between the lexemes of every declaration.
#[test]
fn other_blanks_and_comments_say_the_same_and_formatting_ends() {
    let mut dice = Dice(7);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pass");
    for path in files(&folder, "mbd") {
        let text = declaration(&path);
        let scene = read_text(&text).scene.unwrap();
        for _ in 0..20 {
            let mut other = String::new();
            for line in text.lines() {
                let is_comment = line.trim_start().starts_with("//");
                for c in line.chars() {
                    other.push(c);
                    let apart = c == ' ' || "{}()[],;=+".contains(c);
                    if apart && !is_comment {
                        other.push_str(match dice.below(12) {
                            0 => "\n",
                            1 => "  ",
                            2 => "\n\n\n",
                            3 => " /* a */",
                            4 => " // b\n",
                            5 => "\n/* c\n d */",
                            6 => "\t",
                            _ => "",
                        });
                    }
                }
                other.push('\n');
            }
            // A sign may have been cut in two that only touching is one; what cannot be read is no matter here.
            if read_text(&other).scene.as_ref() != Some(&scene) {
                continue;
            }
            let once = formatted(&other);
            assert_eq!(read_text(&once).scene.as_ref(), Some(&scene), "{other}");
            let twice = formatted(&once);
            let mut lines = once.lines().zip(twice.lines());
            let differs = lines.position(|(once, twice)| once != twice);
            let part = |text: &str| {
                let lines = text
                    .lines()
                    .skip(differs.unwrap_or(0).saturating_sub(3))
                    .take(7);
                lines.collect::<Vec<_>>().join("\n")
            };
            assert!(
                twice == once,
                "{}\n--- again ---\n{}",
                part(&once),
                part(&twice)
            );
            assert!(once.lines().all(|line| line == line.trim_end()), "{once}");
        }
    }
}
