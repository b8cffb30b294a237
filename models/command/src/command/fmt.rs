//! `mbd fmt`: declarations with their blanks in order, in scene files and in Rust.

use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use mbd_compiler::{Message, format_rust, format_text};
use mbd_report::files::write_text;

use super::failure::CommandFailure;
use super::mistakes::Mistakes;
use super::scene_file::read_file;
use crate::run::split;

/// What to format.
#[derive(Args, Debug)]
pub struct FmtArgs {
    /// Scene files (`.mbd`) and files of Rust (`.rs`), whose `model! { … }`, in any brackets, are formatted; `-` is the standard input, written to the standard output.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Write nothing: name the files that would change, and exit with 1 if there are any.
    #[arg(long)]
    check: bool,
    /// The standard input is Rust, not a scene.
    #[arg(long)]
    rust: bool,
}

/// How a text is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TextForm {
    /// A scene file.
    Scene,
    /// Rust with declarations in it.
    Rust,
}

/// Formats files in place, or tells which of them would change.
pub fn fmt(args: &FmtArgs) -> Result<String, CommandFailure> {
    if args.files.iter().any(|file| file == Path::new("-")) {
        if args.files.len() > 1 {
            return Err(CommandFailure::Usage(
                "`-` is the standard input, which is formatted alone: leave out the files, or the `-`".into(),
            ));
        }
        return of_input(args, std::io::stdin());
    }
    let (mut changing, mut left) = (Vec::new(), Vec::new());
    let mut failures = Vec::new();
    for file in &args.files {
        match of_file(file, args.check) {
            Ok((changed, kept)) => {
                changing.extend(changed);
                left.extend(kept);
            }
            Err(failure) => failures.push(failure),
        }
    }
    if let Some(failure) = together(failures) {
        return Err(failure);
    }
    told(args, &changing, &left)
}

/// What is said at the end: which declarations stay as they are, and with `--check` which files would change.
fn told(args: &FmtArgs, changing: &[String], left: &[String]) -> Result<String, CommandFailure> {
    let left: String = left.iter().map(|line| format!("{line}\n")).collect();
    match args.check && !changing.is_empty() {
        true => Err(CommandFailure::Usage(format!(
            "{left}{}\n`mbd fmt` without `--check` formats {}",
            changing.join("\n"),
            if changing.len() == 1 { "it" } else { "them" }
        ))),
        false => Ok(left),
    }
}

/// Formats the standard input.
fn of_input(args: &FmtArgs, mut input: impl Read) -> Result<String, CommandFailure> {
    let mut text = String::new();
    input.read_to_string(&mut text).map_err(|error| {
        CommandFailure::Usage(format!("cannot read the standard input: {error}"))
    })?;
    let form = if args.rust {
        TextForm::Rust
    } else {
        TextForm::Scene
    };
    let (formatted, left) = formatted(&text, form, "<stdin>")?;
    if args.check {
        let changing: Vec<String> = changed("<stdin>", &text, &formatted).into_iter().collect();
        return told(args, &changing, &left);
    }
    // The standard output holds the text alone.
    left.iter().for_each(|line| eprintln!("{line}"));
    Ok(formatted)
}

/// Formats one file; told is where it would change, or did, and what stays in it.
fn of_file(file: &Path, check: bool) -> Result<(Option<String>, Vec<String>), CommandFailure> {
    let form = match file.extension().and_then(|end| end.to_str()) {
        Some("rs") => TextForm::Rust,
        Some("mbd") => TextForm::Scene,
        _ => {
            return Err(CommandFailure::Usage(format!(
                "{}: `mbd fmt` formats scene files (`.mbd`) and the `model! {{ … }}` in files of Rust (`.rs`)",
                file.display()
            )));
        }
    };
    let name = file.display().to_string();
    let text = read_file(file)?;
    let (formatted, left) = formatted(&text, form, &name)?;
    let changed = changed(&name, &text, &formatted);
    if !check && changed.is_some() {
        overwrite(file, &formatted)?;
    }
    Ok((changed, left))
}

/// Writes a file that is there, whole or not at all. A link stays one, and who may not write the file cannot replace it.
fn overwrite(file: &Path, text: &str) -> Result<(), CommandFailure> {
    let cannot =
        |why: String| CommandFailure::Usage(format!("cannot write {}: {why}", file.display()));
    let place = file
        .canonicalize()
        .map_err(|error| cannot(error.to_string()))?;
    let found = place
        .metadata()
        .map_err(|error| cannot(error.to_string()))?;
    if found.permissions().readonly() {
        return Err(cannot("it is read-only; it stays as it is".into()));
    }
    write_text(&place, text).map_err(|error| CommandFailure::Usage(format!("cannot write {error}")))
}

/// Where a text changes first: `file:line`.
fn changed(name: &str, before: &str, after: &str) -> Option<String> {
    if before == after {
        return None;
    }
    // Ends of lines count: a missing last one changes the last line.
    let lines = before
        .split_inclusive('\n')
        .zip(after.split_inclusive('\n'));
    let same = lines.take_while(|(before, after)| before == after).count();
    Some(format!("{name}:{}: is not formatted", same + 1))
}

/// A text with its blanks in order, and what of it stays as it is. The settings of a run behind a scene do, without a word.
fn formatted(
    text: &str,
    form: TextForm,
    name: &str,
) -> Result<(String, Vec<String>), CommandFailure> {
    let result = match form {
        TextForm::Rust => format_rust(text).map(|file| (file.text, file.left)),
        TextForm::Scene => scene(text).map(|text| (text, Vec::new())),
    };
    let told = |(text, left): (String, Vec<Message>)| {
        let left = left.iter().map(|message| message.in_file(name));
        (text, left.collect())
    };
    result.map(told).map_err(|errors| {
        CommandFailure::Mistakes(Box::new(Mistakes {
            file: name.to_owned(),
            source: text.to_owned(),
            errors,
            settings: None,
            notes: Vec::new(),
        }))
    })
}

fn scene(text: &str) -> Result<String, Vec<Message>> {
    let (declaration, run) = split(text);
    let declaration = format_text(&declaration)?;
    let whole = match run.trim() {
        "" => declaration,
        run => format!("{declaration}\n{run}\n"),
    };
    // The parts lost the ends of lines that the file has.
    let end = text.find('\n').map_or("", |end| &text[..end]);
    Ok(match end.ends_with('\r') {
        true => whole.replace('\n', "\r\n"),
        false => whole,
    })
}

/// What is wrong with several files, as one failure; mistakes of scenes say more than files that cannot be read.
fn together(mut failures: Vec<CommandFailure>) -> Option<CommandFailure> {
    if failures.len() < 2 {
        return failures.pop();
    }
    let texts: Vec<String> = failures.iter().map(ToString::to_string).collect();
    let text = texts.join("\n");
    Some(match failures.iter().any(|failure| failure.code() == 2) {
        true => CommandFailure::Invalid(text),
        false => CommandFailure::Usage(text),
    })
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Typed {
        #[command(flatten)]
        args: FmtArgs,
    }

    fn input(arguments: &[&str], text: &str) -> Result<String, CommandFailure> {
        let typed = ["fmt"].iter().chain(arguments);
        of_input(&Typed::parse_from(typed).args, text.as_bytes())
    }

    #[test]
    fn the_standard_input_comes_out_formatted() {
        let scene = "model A {\n    gravity: none;\n}\n";
        assert_eq!(input(&["-"], "model A { gravity:none; }").unwrap(), scene);
        assert_eq!(input(&["-", "--check"], scene).unwrap(), "");
        let error = input(&["-", "--check"], &scene[..scene.len() - 1]).unwrap_err();
        assert!(error.to_string().starts_with("<stdin>:3: "), "{error}");
        let rust = "model! {\n    model A {\n        gravity: none;\n    }\n}\n";
        let before = "model! { model A { gravity: none; } }\n";
        assert_eq!(input(&["-", "--rust"], before).unwrap(), rust);
        let error = input(&["-"], "model A { gravity none; }").unwrap_err();
        assert!(error.to_string().starts_with("<stdin>:1:19: "), "{error}");
    }

    #[test]
    fn the_settings_of_a_run_keep_their_lines_and_a_file_its_ends_of_lines() {
        let text = "model A { gravity:none; }\r\n[run]\r\n  a=1\r\n\r\n[run.start]\r\n";
        let wanted =
            "model A {\r\n    gravity: none;\r\n}\r\n\r\n[run]\r\n  a=1\r\n\r\n[run.start]\r\n";
        assert_eq!(input(&["-"], text).unwrap(), wanted);
        assert_eq!(input(&["-"], wanted).unwrap(), wanted);
    }
}
