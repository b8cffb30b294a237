//! From settings to numbers: everything a run needs, checked against the scene.

mod method;
mod start;
mod supplied;

use mbd_runtime::scene::{PlacementReport, Scene, StartFrom, twelve_digits};
use mbd_runtime::{
    Content, Generic, Layout, Name, Options, RunError, Sampling, Scalar, Simulation, Trajectory,
};
use toml::{Table, Value};

use super::mistakes::CampaignMistakes;
use super::names::{PlanError, column_name, flat, no_column, setting_in_table, wrong};
use super::number::{not_bare, not_negative, number, positive};
use super::settings::Settings;
pub(crate) use start::{about, coordinate_unit, in_state_numbers, whole_name};

use method::options;
use start::{said, start};
pub(crate) use supplied::repeated;
use supplied::{inputs, params, said_to_be_held, together};

/// Everything a run needs, in SI numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct RunPlan {
    /// End of the run [s].
    pub until: f64,
    /// Method, step, events.
    pub options: Options,
    /// Distance of the rows of the history [s]; `None`: every step.
    pub every: Option<f64>,
    /// The params, in declaration order.
    pub params: Vec<f64>,
    /// The state at the start, x = [q | v | z].
    pub state: Vec<f64>,
    /// The bodies and points that the settings place or set in motion.
    pub placed: Vec<String>,
    /// Those of them whose velocity is said.
    pub moving: Vec<String>,
    /// Those of them whose angular velocity is said.
    pub turning: Vec<String>,
    /// The joint coordinates that the settings start, and where [m or rad, and per second]: the state does not tell full turns.
    pub joints: Vec<(String, f64)>,
    /// What placing the bodies decided: starts that are about a value, coordinates that nothing decides.
    pub assembly: PlacementReport,
    /// Where the equilibrium points are searched from [m], 3 a node; `None` if nothing was said.
    pub nodes: Option<Vec<f64>>,
    /// What the caller supplies, held constant.
    pub inputs: Vec<f64>,
    /// The inputs of which the settings say where they are held.
    pub held: Vec<String>,
    /// Whether a second, finer run tells the error of the first.
    pub estimate: bool,
    /// When the mechanism is drawn [s]; empty: evenly over the run.
    pub instants: Vec<f64>,
    /// Titles of figures, and the columns each shows.
    pub figures: Vec<(String, Vec<String>)>,
}

impl RunPlan {
    /// Checks settings against a scene.
    ///
    /// # Errors
    /// The first setting that cannot be used.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<RunPlan, PlanError> {
        let plan = RunPlan::with_layout((scene, &Layout::new(scene)), settings);
        plan.map_err(CampaignMistakes::first)
    }

    /// The same where somebody has the layout of the scene already, with all settings that cannot be used.
    pub(crate) fn with_layout(
        (scene, layout): (&Scene, &Layout),
        settings: &Settings,
    ) -> Result<RunPlan, CampaignMistakes> {
        let mut mistakes = CampaignMistakes::default();
        let until = mistakes.note(end(settings));
        let every = settings.every.as_ref();
        let every = every.map(|value| positive("every", value, "s"));
        let every = mistakes.note(every.transpose());
        let params = mistakes.note(params(scene, &settings.params));
        let said = mistakes.note(said((scene, layout), &settings.start));
        // Inputs that are missing are told behind everything else.
        let supplied = inputs(scene, layout, &settings.inputs);
        // Where things come to stand follows from all of it.
        let start = params.as_ref().zip(said).and_then(|(params, said)| {
            let from = StartFrom {
                inputs: supplied.as_deref().ok(),
                ..StartFrom::new(params, 0.0)
            };
            mistakes.note(start((scene, layout), from, said))
        });
        let instants = settings.instants.as_deref().unwrap_or_default();
        let instants = instants.iter().map(|value| number("instants", value, "s"));
        let instants: Option<Vec<f64>> = mistakes.note(instants.collect::<Result<_, _>>());
        let options = mistakes.note(options(scene, layout, settings));
        if let (Some(until), Some(every), Some(options)) = (until, every, &options)
            && let Some(rows) = every
                .or(options.method.fixed_step())
                .map(|every| until / every)
        {
            mistakes.note(fits(scene, rows));
        }
        let figures = mistakes.note(figures(scene, &settings.figures));
        let supplied = mistakes.note(supplied);
        let numbers = until.zip(every).zip(params.zip(supplied));
        let shown = instants.zip(figures);
        let plan = numbers.zip(start).zip(options.zip(shown)).map(
            |((((until, every), (params, inputs)), start), (options, (instants, figures)))| {
                RunPlan {
                    until,
                    options,
                    every,
                    params,
                    state: start.state,
                    placed: start.placed,
                    moving: start.moving,
                    turning: start.turning,
                    joints: start.joints,
                    assembly: start.assembly,
                    nodes: start.nodes,
                    inputs,
                    held: said_to_be_held(scene, &settings.inputs),
                    estimate: settings.estimate.unwrap_or(true),
                    instants,
                    figures,
                }
            },
        );
        mistakes.unless(plan)
    }

    /// One sentence on what it asks for beyond the end of its run [s], the one it plans or the one that the run came to.
    #[must_use]
    pub fn beyond(&self, end: f64) -> Vec<String> {
        // An end that an event made has rounding in its last digits.
        let end = twelve_digits(end);
        let later = "or a later end of the run (`until`)";
        // A run of no time has one row, whatever was asked for.
        let every = self.every.filter(|every| *every > end && end > 0.0);
        let every = every.map(|every| {
            let every = twelve_digits(every);
            format!("warning: `every` is {every} s, and the run ends at {end} s: its history has no rows but those of its start and its end; write a shorter distance, {later}")
        });
        let after: Vec<String> = self
            .instants
            .iter()
            .map(|instant| twelve_digits(*instant))
            .filter(|instant| *instant > end)
            .map(|instant| format!("{instant} s"))
            .collect();
        let drawn = (!after.is_empty()).then(|| {
            format!("warning: `instants` asks for {}, and the run ends at {end} s: what is drawn is its end; write earlier instants, {later}", after.join(", "))
        });
        every.into_iter().chain(drawn).collect()
    }
}

/// The end of the run [s]. One of no time shows where the scene begins.
fn end(settings: &Settings) -> Result<f64, PlanError> {
    let until = settings.until.as_ref().ok_or_else(|| {
        wrong(
            "until",
            "say when the run ends: `until = \"10 s\"` under [run], or `--until 10`",
        )
    })?;
    not_negative("until", until, "s")
}

/// Refuses numbers without a unit in settings that somebody wrote, where SI is seldom meant. What a campaign gives its cases is in SI.
///
/// # Errors
/// The first such number.
pub fn check_units(scene: &Scene, settings: &Settings) -> Result<(), PlanError> {
    let params = scene.params.iter().map(|it| ("params", &it.name, &it.unit));
    let inputs = scene.inputs.iter().map(|it| ("inputs", &it.name, &it.unit));
    for (table, name, unit) in params.chain(inputs) {
        let given = match table {
            "params" => &settings.params,
            _ => &settings.inputs,
        };
        let shared = || given.get(together(name)?);
        if let Some(value) = given.get(name).or_else(shared) {
            not_bare(&format!("{table}.{name}"), value, &unit.text)?;
        }
    }
    for (name, value) in flat(&settings.start) {
        if let Some(unit) = coordinate_unit(scene, &name) {
            not_bare(&format!("start.{name}"), value, unit)?;
        }
    }
    Ok(())
}

/// Refuses a history that memory or disk have no room for.
fn fits(scene: &Scene, rows: f64) -> Result<(), PlanError> {
    let model = Generic::<f64>::with_defaults(scene.clone());
    let history = model.map(|model| Trajectory::new(&model, Sampling::Steps, Content::ALL));
    let columns = history.map_or(1, |history| history.names().len());
    let numbers = rows * columns as f64;
    let most = Trajectory::MOST_NUMBERS;
    if numbers <= most {
        return Ok(());
    }
    let text = format!(
        "asks for {rows:.1e} rows of history with {columns} columns, {numbers:.1e} numbers; at most {most:.0e} fit: write a longer distance of the rows, or an earlier end"
    );
    Err(wrong("every", text))
}

impl RunPlan {
    /// Another start, for the params and the inputs that are planned now.
    pub(crate) fn place(
        &mut self,
        scene: (&Scene, &Layout),
        given: &Table,
    ) -> Result<(), PlanError> {
        let said = said(scene, given).map_err(CampaignMistakes::first)?;
        let from = StartFrom::new(&self.params, 0.0).with_inputs(&self.inputs);
        let start = start(scene, from, said)?;
        (self.state, self.nodes) = (start.state, start.nodes);
        (self.joints, self.assembly) = (start.joints, start.assembly);
        self.placed = start.placed;
        [self.moving, self.turning] = [start.moving, start.turning];
        Ok(())
    }

    /// Puts a run where it begins, with the inputs that are held.
    ///
    /// # Errors
    /// Numbers that do not fit the model of the run.
    pub fn begin<T: Scalar>(&self, run: &mut Simulation<T>) -> Result<(), RunError> {
        let numbers = |list: &[f64]| -> Vec<T> { list.iter().map(|x| T::from_f64(*x)).collect() };
        run.set_inputs(&numbers(&self.inputs))?;
        run.set_state(0.0, &numbers(&self.state))?;
        let joints = self.joints.iter();
        let joints: Vec<(&str, f64)> = joints.map(|(name, x)| (name.as_str(), *x)).collect();
        run.set_turns(&joints)?;
        match &self.nodes {
            Some(nodes) => run.set_nodes(&numbers(nodes)),
            None => Ok(()),
        }
    }
}

/// Figures by title; their columns exist. A figure has one unit: columns of several are one figure a unit, the second with a 2 behind its title.
fn figures(scene: &Scene, given: &Table) -> Result<Vec<(String, Vec<String>)>, PlanError> {
    let mut figures = Vec::new();
    let model = Generic::<f64>::with_defaults(scene.clone());
    let history = model.map(|model| Trajectory::new(&model, Sampling::Steps, Content::ALL));
    let names: &[Name] = history.as_ref().map_or(&[], Trajectory::names);
    for (title, value) in given {
        let setting = format!("figures.{title}");
        let Value::Array(list) = value else {
            let text = "give the columns it shows: [\"riser.tension\", \"leg[0].tension\"]";
            return Err(wrong(setting, text));
        };
        let mut of_units: Vec<(&str, Vec<String>)> = Vec::new();
        for value in list {
            let written = value.as_str().unwrap_or_default();
            let column = column_name(written);
            let Some(name) = names.iter().find(|name| name.name == column) else {
                let known = names.iter().map(|name| name.name.as_str());
                let misplaced = setting_in_table(&setting, title);
                let told = misplaced.unwrap_or_else(|| no_column(scene, written, known));
                return Err(wrong(setting, told));
            };
            let same = |(unit, _): &(&str, _)| *unit == name.unit;
            match of_units.iter().position(same) {
                Some(place) => of_units[place].1.push(column),
                None => of_units.push((&name.unit, vec![column])),
            }
        }
        let figures_of_units = of_units.into_iter().zip(1..);
        figures.extend(figures_of_units.map(|((_, columns), number)| match number {
            1 => (title.clone(), columns),
            _ => (format!("{title} {number}"), columns),
        }));
    }
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rattle_in_relative_coordinates_is_told_before_a_run() {
        let arm = |family: &str| {
            let text = format!(
                "model Arm {{ coordinates: {family}; gravity: none;
                    body arm {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
                    joint pin: hinge from world to arm.com {{ axis: y }} }}"
            );
            let scene = mbd_compiler::read_text(&text).scene.expect("an arm");
            let run = "[run]\nuntil = 1\nmethod = \"rattle\"\nstep = \"1 ms\"\n";
            RunPlan::new(&scene, &Settings::read(run).unwrap()).map(|_| ())
        };
        assert_eq!(arm("absolute"), Ok(()));
        let error = arm("relative").unwrap_err();
        assert_eq!(error.setting, "method");
        assert!(error.text.contains("`--method vern7`"), "{error}");
    }

    #[test]
    fn params_and_inputs_without_a_unit_are_in_si_as_their_declaration_is() {
        let read = mbd_compiler::read_text(
            "model Cart {
                gravity: none;
                param m = 2 kg;
                param m_g = 50 g;
                input push: force = 2 kN;
                input aim: angle;
                param slope = 0.5;
                param scale = 0.5;
                input lean = 0.1;
                point cart { mass: m + m_g }
                load drive on cart = [push * cos(aim), scale * push * sin(slope) * cos(lean), 0];
            }",
        );
        let scene = read.scene.expect("a cart");
        let told = |table: &str| {
            let settings = Settings::read(&format!("[run]\nuntil = 1\n{table}")).unwrap();
            check_units(&scene, &settings)?;
            let plan = RunPlan::new(&scene, &settings)?;
            Ok::<_, PlanError>((plan.params, plan.inputs))
        };
        let numbers = |table: &str| told(table).map_err(|error| error.to_string());
        let si = numbers("[run.params]\nm = 3\n[run.inputs]\npush = 3\n");
        assert_eq!(si, Ok((vec![3.0, 0.05, 0.5, 0.5], vec![3.0, 0.0, 0.1])));
        // Where radians are meant a number without a unit is radians, whoever gives it, and degrees need theirs.
        let turned = numbers(
            "[run.params]\nslope = \"1\"\nscale = \"90\"\n[run.inputs]\nlean = \"90 deg\"\n",
        );
        let right = 90f64.to_radians();
        assert_eq!(
            turned,
            Ok((vec![2.0, 0.05, 1.0, 90.0], vec![2e3, 0.0, right]))
        );
        for (table, why) in [
            ("[run.params]\nm_g = 3\n", "declared in g"),
            ("[run.params]\nm = \"3\"\n", "needs a unit, such as kg"),
            ("[run.inputs]\npush = \"3\"\n", "needs a unit, such as N"),
            ("[run.inputs]\naim = 30\n", "more than a full turn"),
            ("[run.params]\nslope = 90\n", "more than a full turn"),
            ("[run.params]\nslope = \"90\"\n", "more than a full turn"),
            ("[run.inputs]\nlean = \"90\"\n", "more than a full turn"),
        ] {
            let error = numbers(table).unwrap_err();
            assert!(error.contains(why), "{table}: {error}");
        }
    }

    #[test]
    fn repeated_inputs_are_held_together_or_each_at_its_own() {
        let read = mbd_compiler::read_text(
            "model Pushed {
                gravity: none;
                input c[i in 0..3]: force = 7 N;
                input w[i in 0..2]: [force; 3];
                point p[i in 0..3] { mass: 1 kg }
                load push[i in 0..3] on p[i] = [c[i], 0 N, 0 N];
                load wind[i in 0..2] on p[i] = w[i];
            }",
        );
        let scene = read.scene.expect("three points");
        let inputs = |table: &str| {
            let settings =
                Settings::read(&format!("[run]\nuntil = 1\n[run.inputs]\n{table}")).unwrap();
            check_units(&scene, &settings).map_err(|error| error.to_string())?;
            let plan = RunPlan::new(&scene, &settings).map_err(|error| error.to_string())?;
            Ok::<_, String>((plan.inputs[..3].to_vec(), plan.inputs[3..].to_vec()))
        };
        let forces = |table: &str| inputs(table).map(|(forces, _)| forces);
        let winds = |table: &str| inputs(table).map(|(_, winds)| winds);
        assert_eq!(forces(""), Ok(vec![7.0; 3]));
        assert_eq!(forces("c = \"1 kN\""), Ok(vec![1e3; 3]));
        assert_eq!(forces("c = [\"1 N\", \"2 N\", 3]"), Ok(vec![1.0, 2.0, 3.0]));
        // One by its own name before what is given for all.
        assert_eq!(forces("c = 5\n\"c[1]\" = \"6 N\""), Ok(vec![5.0, 6.0, 5.0]));
        let same = vec![1.0, 2.0, 3.0, 1.0, 2.0, 3.0];
        assert_eq!(winds("w = \"[1, 2, 3] N\""), Ok(same.clone()));
        assert_eq!(winds("w = [1, 2, 3]"), Ok(same));
        let each = vec![1.0, 0.0, 0.0, 0.0, 2.0, 0.0];
        assert_eq!(winds("w = [\"[1, 0, 0] N\", [0, 2, 0]]"), Ok(each));
        for (table, why) in [
            (
                "c = [1, 2]",
                "or 3 in brackets, one for each input from `c[0]` on; found 2",
            ),
            ("w = [[1, 0, 0]]", "or 2 in brackets"),
            ("c = \"3\"", "needs a unit, such as N"),
            ("d = 1", "this scene has no `d`"),
        ] {
            let error = inputs(table).unwrap_err();
            assert!(error.contains(why), "{table}: {error}");
        }
    }

    #[test]
    fn a_body_that_the_joints_of_a_tree_carry_starts_by_these_or_by_its_own_field() {
        let started = |coordinates: &str, start: &str| {
            let read = mbd_compiler::read_text(&format!(
                "model Carried {{
                    gravity: none;
                    coordinates: {coordinates};
                    body cart {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
                    joint rail: prismatic from world to cart.com {{ axis: x }}
                }}"
            ));
            let scene = read.scene.expect("a cart");
            let settings =
                Settings::read(&format!("[run]\nuntil = 1\n[run.start]\n{start}")).unwrap();
            let plan = RunPlan::new(&scene, &settings).map_err(|error| error.to_string())?;
            Ok::<f64, String>(plan.state[0])
        };
        let place = "cart.position = \"[2, 0, 0] m\"";
        assert_eq!(started("absolute", place), Ok(2.0));
        assert_eq!(started("relative", "rail.slide = \"2 m\""), Ok(2.0));
        let error = started("relative", place).unwrap_err();
        for part in [
            "`cart` is where its joints carry it",
            "`rail.slide`",
            "`start at`",
        ] {
            assert!(error.contains(part), "{error}");
        }
    }
}
