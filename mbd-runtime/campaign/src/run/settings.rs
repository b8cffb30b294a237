//! The part of a scene file that says how to run the scene: the table `[run]`.
//!
//! ```toml
//! [run]
//! until = "70 s"
//! method = "vern7"       # rk4 (fixed steps), rattle (fixed steps, long runs), tsit5, vern7 (tight), rodas5p (stiff), auto; left out: rk4 with a step, else tsit5
//! tolerance = 1e-10      # of adaptive methods; of rk4 and rattle: step = "0.01 s"
//! every = "0.02 s"       # rows of the history
//! max_steps = 1000000    # accepted and rejected; then the run is given up
//! locate = true          # steps end on slack/taut switches and on events
//! estimate = false       # without a second, finer run that tells the error of the first
//! instants = ["0 s", "1 s"] # when the mechanism is drawn; by itself five times, evenly
//!
//! [run.figures]          # columns that share a figure; every output and line not named here has its own
//! Height = ["capsule.z", "chute.z"]
//!
//! [run.start]            # what is not given is zero; attitudes are upright
//! capsule.z = "2.6 m"
//! capsule.vx = "1 m/s"
//!
//! [run.inputs]           # held constant; an input that is left out keeps its declared default
//! wind = ["3 m/s", 0.0, 0.0]
//! ```

use std::fmt;

use mbd_compiler::{nearest, read_number};
use mbd_runtime::scene::similar::near_and_all;
use serde::Deserialize;
use toml::{Table, Value};

use super::mistakes::CampaignMistakes;
use super::names::wrong;
use super::words;

/// How to run a scene, as written; every field may be left out.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// End of the run, with unit or in seconds.
    pub until: Option<Value>,
    /// The integrator: `rk4`, `rattle`, `tsit5`, `vern7`, `rodas5p`, `auto`; left out, `rk4` with a step, else `tsit5`.
    pub method: Option<String>,
    /// Fixed step of RK4 or Rattle, with unit or in seconds.
    pub step: Option<Value>,
    /// Relative tolerance of adaptive steps.
    pub tolerance: Option<Value>,
    /// Distance of the rows of the history, with unit or in seconds; without it every step is a row.
    pub every: Option<Value>,
    /// The most steps, accepted and rejected, before the run is given up.
    pub max_steps: Option<u64>,
    /// Whether steps end on slack/taut switches and on declared events.
    pub locate: Option<bool>,
    /// Whether a second, finer run tells the error of the first; it does unless this says no.
    pub estimate: Option<bool>,
    /// When the mechanism is drawn, with units or in seconds.
    pub instants: Option<Vec<Value>>,
    /// Figures: a title, and the columns of the history it shows.
    #[serde(default)]
    pub figures: Table,
    /// What the tolerance is relative to: `length`, `speed`, `angle`, `rate`, with units.
    #[serde(default)]
    pub scales: Table,
    /// Coordinates and speeds at the start, positions of equilibrium points to search from: `capsule.z = "2.6 m"`.
    #[serde(default)]
    pub start: Table,
    /// What the caller of the model would supply, held constant: inputs, external loads, gravity of a field.
    #[serde(default)]
    pub inputs: Table,
    /// Values of params, with units: `riser_k = "50 kN/m"`.
    #[serde(default)]
    pub params: Table,
}

/// What is wrong with the settings of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingsError {
    /// The line of the file where it stands, from 1, if it stands there.
    pub line: Option<usize>,
    /// What is wrong, and what to write.
    pub text: String,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "line {line}: {}", self.text),
            None => f.write_str(&self.text),
        }
    }
}

/// Parts a scene file into the scene and the settings of its run. Each part keeps its lines where they are, so that places in messages stay true.
#[must_use]
pub fn split(text: &str) -> (String, String) {
    let (mut scene, mut run) = (String::new(), String::new());
    let mut in_run = false;
    for line in text.lines() {
        if let Some(header) = line.trim_start().strip_prefix('[') {
            let name = header.trim_start_matches('[').trim_start();
            in_run = name
                .strip_prefix("run")
                .is_some_and(|rest| rest.trim_start().starts_with([']', '.']));
        }
        let (here, there) = if in_run {
            (&mut run, &mut scene)
        } else {
            (&mut scene, &mut run)
        };
        here.push_str(line);
        here.push('\n');
        there.push('\n');
    }
    (scene, run)
}

/// The first table behind the `}` of a declaration, the first part of [`split`], with its line, counted from 1, and what is said of it: none but `[run]`
/// and its tables stand there.
#[must_use]
pub fn misnamed_table(scene: &str) -> Option<(usize, String)> {
    let (mut depth, mut closed) = (0_i64, false);
    for (index, line) in scene.lines().enumerate() {
        let header = line.trim_start().strip_prefix('[');
        let name = header.map(|header| header.trim_start_matches('[').trim_start());
        let word = name.map(|name| {
            let end = name.find(|c: char| !(c.is_alphanumeric() || c == '_'));
            name.split_at(end.unwrap_or(name.len()))
        });
        if let Some((word, rest)) = word
            && closed
            && depth == 0
            && !word.is_empty()
            && rest.trim_start().starts_with([']', '.'])
        {
            let near = nearest(word, ["run"]).map_or(".", |_| "; did you mean `[run]`?");
            let told = format!(
                "there is no table `[{word}]` behind a declaration{near} there stand `[run]` and its tables `[run.start]`, `[run.inputs]`, `[run.params]`, `[run.figures]`, `[run.scales]`"
            );
            return Some((index + 1, told));
        }
        for sign in line.chars() {
            depth += i64::from(sign == '{') - i64::from(sign == '}');
            closed |= sign == '}';
        }
    }
    None
}

/// The line, counted from 1, where a setting of a table `[run]` stands, `start.capsule.z`, or what it is a part of.
#[must_use]
pub fn line_of(run: &str, setting: &str) -> Option<usize> {
    let mut table = String::new();
    let mut found: Option<(usize, usize)> = None;
    for (index, line) in run.lines().enumerate() {
        let bare: String = line.chars().filter(|c| !c.is_whitespace()).collect();
        let bare = bare.replace(['"', '\''], "");
        let key = match bare.strip_prefix("[run") {
            Some(header) => {
                let name = header.trim_start_matches('.');
                table = name.split(']').next().unwrap_or_default().to_owned();
                table.clone()
            }
            None => match (bare.split_once('='), table.as_str()) {
                (Some((key, _)), "") => key.to_owned(),
                (Some((key, _)), table) => format!("{table}.{key}"),
                (None, _) => continue,
            },
        };
        let rest = setting.strip_prefix(key.as_str());
        let is_part = rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        if is_part && !key.is_empty() && found.is_none_or(|(_, length)| key.len() > length) {
            found = Some((index + 1, key.len()));
        }
    }
    found.map(|(line, _)| line)
}

impl Settings {
    /// Reads the second part of [`split`].
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn read(text: &str) -> Result<Settings, SettingsError> {
        #[derive(Deserialize)]
        struct Whole {
            #[serde(default)]
            run: Settings,
        }
        toml::from_str::<Whole>(text)
            .map(|whole| whole.run)
            .map_err(|error| SettingsError {
                line: line_of_error(text, &error),
                text: in_quotes(text, &error)
                    .or_else(|| of_another_kind(text, &error))
                    .unwrap_or_else(|| told(&error)),
            })
    }

    /// Reads the table `run` of a campaign file; what cannot be read is noted and left out.
    pub(crate) fn of_table(table: &Table, mistakes: &mut CampaignMistakes) -> Settings {
        let read =
            |table: Table| -> Result<Settings, toml::de::Error> { Value::Table(table).try_into() };
        let mut good = table.clone();
        good.retain(|key, value| {
            let alone = read(Table::from_iter([(key.to_owned(), value.clone())]));
            let checked = alone.map_err(|error| match unknown_field(error.message()) {
                Some(_) => wrong("run", told(&error)),
                None => {
                    let kind = of_kind(key, &value.to_string(), &error);
                    wrong(format!("run.{key}"), kind.unwrap_or_else(|| told(&error)))
                }
            });
            mistakes.note(checked).is_some()
        });
        // Of settings that can be read one by one, all can.
        read(good).unwrap_or_default()
    }
}

/// What is wrong; of a setting that other tools or the command line call otherwise what it is called here, in place of all that there are.
fn told(error: &toml::de::Error) -> String {
    let message = error.message();
    let Some(word) = unknown_field(message) else {
        return message.to_owned();
    };
    if let Some(ours) = words::of_setting(word) {
        return format!("unknown field `{word}`: {ours}");
    }
    // "unknown field `a`, expected one of `b`, `c`"
    let known = message.split('`').skip(3).step_by(2);
    format!("unknown field `{word}`{}", near_and_all(word, known))
}

/// The line of a mistake of TOML.
fn line_of_error(text: &str, error: &toml::de::Error) -> Option<usize> {
    let before = text.get(..error.span()?.start)?;
    Some(before.matches('\n').count() + 1)
}

/// The field of which a message of TOML says that there is none.
pub(crate) fn unknown_field(message: &str) -> Option<&str> {
    message.strip_prefix("unknown field `")?.split('`').next()
}

/// Whether a word is the name of a setting.
pub(super) fn is_setting(word: &str) -> bool {
    let own = Table::from_iter([(word.to_owned(), Value::Boolean(true))]);
    let read: Result<Settings, toml::de::Error> = Value::Table(own).try_into();
    read.map_or_else(|error| unknown_field(error.message()).is_none(), |_| true)
}

/// What to say of a key that stands at the top of a campaign file and belongs into its table of the run; nothing after another mistake.
pub(crate) fn belongs_to_the_run(error: &toml::de::Error) -> String {
    match unknown_field(error.message()) {
        // A table of the file itself but for a letter, `param`.
        Some(word) if error.message().contains(&format!("`{word}s`")) => String::new(),
        Some(word) if let Some(ours) = words::of_setting(word) => {
            format!("how the cases are run stands in the table `[run]`: {ours}\n")
        }
        Some(word) if is_setting(word) => {
            format!("`{word}` stands in the table `[run]` of the file\n")
        }
        _ => String::new(),
    }
}

/// What to write instead of a value with a unit that stands without quotes; nothing after another mistake.
fn in_quotes(text: &str, error: &toml::de::Error) -> Option<String> {
    let line = text.lines().nth(line_of_error(text, error)? - 1)?;
    let (key, value) = line.split_once('=')?;
    let value = value.split('#').next().unwrap_or_default().trim();
    let (_, unit) = read_number(value).ok()?;
    let key = key.trim();
    let told = format!("write a value with its unit in quotes: `{key} = \"{value}\"`");
    (!unit.text.is_empty()).then_some(told)
}

/// What kind of value a setting takes that was given another; nothing after another mistake.
fn of_another_kind(text: &str, error: &toml::de::Error) -> Option<String> {
    let line = text.lines().nth(line_of_error(text, error)? - 1)?;
    let (key, value) = line.split_once('=')?;
    of_kind(key.trim(), value.split('#').next()?.trim(), error)
}

/// The same of a setting and its value as written.
fn of_kind(key: &str, value: &str, error: &toml::de::Error) -> Option<String> {
    let (_, wanted) = error.message().rsplit_once(", expected ")?;
    Some(match wanted {
        "a sequence" => format!("`{key}` is a list: write `{key} = [{value}]`"),
        "a boolean" => format!("`{key}` is `true` or `false`, without quotes"),
        "u64" => format!("`{key}` is a whole number: write `{key} = 100000`"),
        "a map" => format!("`{key}` is a table: write `[run.{key}]`, and its entries below"),
        "a string" => format!("`{key}` is a word in quotes: write `{key} = \"{value}\"`"),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "model = \"A\"\n[run]\nuntil = \"2 s\"\n[body.a]\nmass = \"1 kg\"\n[ run.start ]\na.z = \"3 m\"\n";

    #[test]
    fn both_parts_keep_their_lines() {
        let (scene, run) = split(FILE);
        assert_eq!(scene, "model = \"A\"\n\n\n[body.a]\nmass = \"1 kg\"\n\n\n");
        assert_eq!(
            run,
            "\n[run]\nuntil = \"2 s\"\n\n\n[ run.start ]\na.z = \"3 m\"\n"
        );
    }

    #[test]
    fn a_setting_has_the_line_where_it_or_what_holds_it_stands() {
        let run = split(FILE).1;
        let line = |setting: &str| line_of(&run, setting);
        assert_eq!(line("until"), Some(3));
        assert_eq!(line("start.a.z"), Some(7));
        assert_eq!(line("start.a.vx"), Some(6));
        assert_eq!(line("step"), None);
        let inline = "[run]\nuntil = 1\nstart = { a = { z = 3 } }\n'start'.b.z = 4\n";
        assert_eq!(line_of(inline, "start.a.z"), Some(3));
        assert_eq!(line_of(inline, "start.b.z"), Some(4));
    }

    #[test]
    fn settings_are_read_and_a_mistake_in_them_has_its_line() {
        let settings = Settings::read(&split(FILE).1).unwrap();
        assert_eq!(settings.until, Some(Value::String("2 s".into())));
        assert!(settings.start.contains_key("a"));
        let error = Settings::read(&split("x = 1\n[run]\nuntl = 3\n").1).unwrap_err();
        assert_eq!(error.line, Some(3));
        assert!(
            error.text.starts_with(
                "unknown field `untl`; did you mean `until`? There are: until, method, step"
            ),
            "{error}"
        );
        assert_eq!(Settings::read(""), Ok(Settings::default()));
    }

    #[test]
    fn a_value_with_a_unit_without_quotes_is_told_how_to_be_written() {
        let told = |line: &str| Settings::read(&format!("[run]\n{line}\n"));
        let told = |line: &str| told(line).unwrap_err().to_string();
        for (line, remedy) in [
            ("until = 10 s", "`until = \"10 s\"`"),
            ("every=20 ms # often", "`every = \"20 ms\"`"),
            ("step = 1e-3 min", "`step = \"1e-3 min\"`"),
        ] {
            let told = told(line);
            assert!(told.contains("line 2") && told.contains(remedy), "{told}");
        }
        assert!(!told("until = ten").contains("in quotes"));
        assert!(!told("untl = 3").contains("in quotes"));
        // Neither the line before the mistake, nor a number that needs no quotes.
        for lines in [
            "until = 0.1\nsave = \"x\"",
            "save = \"x\"\nuntil = 0.1",
            "step = 1\nmax_steps = true",
        ] {
            assert!(!told(lines).contains("in quotes"), "{}", told(lines));
        }
    }

    #[test]
    fn a_value_of_another_kind_is_told_which_kind_it_takes() {
        for (line, told) in [
            (
                "instants = \"0.1 s\"",
                "`instants` is a list: write `instants = [\"0.1 s\"]`",
            ),
            (
                "locate = \"no\"",
                "`locate` is `true` or `false`, without quotes",
            ),
            (
                "max_steps = \"many\"",
                "`max_steps` is a whole number: write `max_steps = 100000`",
            ),
            (
                "start = 3",
                "`start` is a table: write `[run.start]`, and its entries below",
            ),
            (
                "method = 4",
                "`method` is a word in quotes: write `method = \"4\"`",
            ),
        ] {
            let error = Settings::read(&format!("[run]\n{line}\n")).unwrap_err();
            assert_eq!((error.line, error.text.as_str()), (Some(2), told));
        }
    }

    #[test]
    fn options_of_the_command_line_are_told_by_the_names_of_their_settings() {
        for (line, word, ours) in [
            (
                "tol = 1e-8",
                "tol",
                "it is called `tolerance`: `tolerance = 1e-8`",
            ),
            (
                "dt = \"1 ms\"",
                "dt",
                "a fixed step is called `step`, `step = \"1 ms\"`",
            ),
        ] {
            let wanted = format!("unknown field `{word}`: {ours}");
            let told = Settings::read(&format!("[run]\n{line}\n"));
            let told = told.unwrap_err().to_string();
            assert!(told.contains("line 2") && told.contains(&wanted), "{told}");
            assert!(!told.contains("expected one of"), "{told}");
            let mut mistakes = CampaignMistakes::default();
            Settings::of_table(&line.parse().unwrap(), &mut mistakes);
            let told = mistakes.first().text;
            assert!(told.starts_with(&wanted), "{told}");
        }
    }

    #[test]
    fn a_table_behind_a_declaration_is_one_of_the_run() {
        let told =
            |header: &str| misnamed_table(&format!("model A {{\n  a: {{}}\n}}\n\n{header}\n"));
        let (line, said) = told("[rnu]").unwrap();
        assert_eq!(line, 5);
        assert!(said.contains("did you mean `[run]`?"), "{said}");
        let (_, said) = told("[ settings.start ]").unwrap();
        assert!(
            said.contains("no table `[settings]`") && !said.contains("mean"),
            "{said}"
        );
        assert_eq!(told("[0, 1]"), None);
        assert_eq!(misnamed_table("model A { a: {}\n[rnu]\n"), None);
        assert_eq!(misnamed_table("a = 1\n[rnu]\n"), None);
    }

    #[test]
    fn a_table_whose_name_only_begins_like_run_belongs_to_the_scene() {
        let (scene, run) = split("[runner]\na = 1\n");
        assert_eq!(
            (scene.as_str(), run.as_str()),
            ("[runner]\na = 1\n", "\n\n")
        );
    }
}
