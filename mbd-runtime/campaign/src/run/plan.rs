//! From settings to numbers: everything a run needs, checked against the scene.

use mbd_compiler::{ABOUT, nearest};
use mbd_runtime::scene::laws::starts;
use mbd_runtime::scene::{
    Input, InputSource, JointStart, NodeModel, Parameter, Part, PartStart, PlacementError,
    PlacementReport, Scene, StartFrom, StartNumber, declared_parts, place_declared, twelve_digits,
};
use mbd_runtime::{
    Content, Generic, Layout, Method, Name, Options, RunError, Sampling, Scalar, Simulation,
    Trajectory, state_names,
};
use toml::{Table, Value};

use super::names::{
    PlanError, VECTORS, column_name, flat, no_column, setting_in_table, state_name, unknown, wrong,
};
use super::number::{not_bare, not_negative, number, numbers as numbers_of, positive, zeros};
use super::scales::scales;
use super::settings::Settings;
use super::words;

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
    /// Whether a second, finer run tells the error of the first.
    pub estimate: bool,
    /// When the mechanism is drawn [s]; empty: evenly over the run.
    pub instants: Vec<f64>,
    /// Titles of figures, and the columns each shows.
    pub figures: Vec<(String, Vec<String>)>,
}

/// A step that is taken when neither step nor tolerance is given and the scene needs fixed steps [s].
const STEP: f64 = 1e-3;
/// The relative tolerance of adaptive steps when nothing is given.
const TOLERANCE: f64 = 1e-8;

impl RunPlan {
    /// Checks settings against a scene.
    ///
    /// # Errors
    /// The first setting that cannot be used.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<RunPlan, PlanError> {
        RunPlan::with_layout((scene, &Layout::new(scene)), settings)
    }

    /// The same where somebody has the layout of the scene already.
    pub(crate) fn with_layout(
        (scene, layout): (&Scene, &Layout),
        settings: &Settings,
    ) -> Result<RunPlan, PlanError> {
        let until = settings.until.as_ref().ok_or_else(|| {
            wrong(
                "until",
                "say when the run ends: `until = \"10 s\"` under [run], or `--until 10`",
            )
        })?;
        // A run of no time shows where the scene begins.
        let until = not_negative("until", until, "s")?;
        let every = settings.every.as_ref();
        let every = every
            .map(|value| positive("every", value, "s"))
            .transpose()?;
        let params = params(scene, &settings.params)?;
        let given = in_numbers((scene, layout), &settings.start)?;
        let placed = placed(scene, &given);
        // Inputs that are missing are told behind everything else.
        let supplied = inputs(scene, layout, &settings.inputs);
        let from = StartFrom {
            inputs: supplied.as_deref().ok(),
            ..StartFrom::new(&params, 0.0)
        };
        let start = start((scene, layout), from, &given, &placed)?;
        let placed = with_declared(scene, &given, placed);
        let [moving, turning] = in_motion(scene, &given, &placed);
        let instants = settings.instants.as_deref().unwrap_or_default();
        let instants = instants
            .iter()
            .map(|value| number("instants", value, "s"))
            .collect::<Result<_, _>>()?;
        let options = options(scene, layout, settings)?;
        if matches!(options.method, Method::Rattle { .. }) && layout.tree.is_some() {
            return Err(wrong("method", NO_RATTLE));
        }
        if let Some(rows) = every
            .or(options.method.fixed_step())
            .map(|every| until / every)
        {
            fits(scene, rows)?;
        }
        Ok(RunPlan {
            instants,
            figures: figures(scene, &settings.figures)?,
            until,
            options,
            every,
            params,
            state: start.state,
            placed,
            moving,
            turning,
            joints: start.joints,
            assembly: start.assembly,
            nodes: start.nodes,
            estimate: settings.estimate.unwrap_or(true),
            inputs: supplied?,
        })
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
        if let Some(value) = given.get(name) {
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

/// What is said of a method for absolute coordinates alone.
const NO_RATTLE: &str = "`rattle` needs a mass matrix that stays, and in relative coordinates it changes with them: declare `coordinates: absolute;`, or take `vern7`, on the command line `--method vern7`";

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
        let placed = placed(scene.0, given);
        let from = StartFrom::new(&self.params, 0.0).with_inputs(&self.inputs);
        let start = start(scene, from, given, &placed)?;
        (self.state, self.nodes) = (start.state, start.nodes);
        (self.joints, self.assembly) = (start.joints, start.assembly);
        self.placed = with_declared(scene.0, given, placed);
        [self.moving, self.turning] = in_motion(scene.0, given, &self.placed);
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

fn options(scene: &Scene, layout: &Layout, settings: &Settings) -> Result<Options, PlanError> {
    let stepwise = layout
        .nodes
        .iter()
        .any(|node| matches!(node.model, NodeModel::Stepwise { .. }));
    let (step, tolerance) = (settings.step.as_ref(), settings.tolerance.as_ref());
    if step.is_some() && tolerance.is_some() {
        return Err(wrong(
            "tolerance",
            "give either a step (fixed) or a tolerance (adaptive)",
        ));
    }
    let fixed = || step.map_or(Ok(STEP), |step| positive("step", step, "s"));
    let adaptive = || {
        let given = tolerance.map_or(Ok(TOLERANCE), |given| positive("tolerance", given, ""))?;
        match given > Method::LOOSEST {
            true => Err(wrong(
                "tolerance",
                format!(
                    "must be at most {}: above it nothing is resolved",
                    Method::LOOSEST
                ),
            )),
            false => Ok(given),
        }
    };
    // Books write RK4 and Tsit5.
    let word = settings.method.as_deref().map(|word| {
        let mut known = Method::FIXED.into_iter().chain(Method::ADAPTIVE);
        let ours = known.find(|known| known.eq_ignore_ascii_case(word));
        ours.unwrap_or(word)
    });
    let mut options = match word {
        None if step.is_some() || (stepwise && tolerance.is_none()) => Options::rk4(fixed()?),
        None => Options::tsit5(adaptive()?),
        Some(word) if Method::FIXED.contains(&word) && tolerance.is_some() => {
            let text =
                format!("`{word}` has a fixed step: give `step`, or take an adaptive method");
            return Err(wrong("tolerance", text));
        }
        Some(word) if Method::ADAPTIVE.contains(&word) && step.is_some() => {
            let text = format!("`{word}` chooses its steps: give `tolerance`, or take `rk4`");
            return Err(wrong("step", text));
        }
        Some(word) => Options::of(method(word, fixed()?, adaptive()?)?),
    };
    options.locate = settings.locate.unwrap_or(true);
    if let Some(steps) = settings.max_steps {
        if steps == 0 {
            return Err(wrong("max_steps", "must be positive"));
        }
        options.max_steps = steps;
    }
    options.scales = scales(&settings.scales)?;
    // The balance of energy needs the work of what gives and takes it.
    options.work = scene.exchanges_energy();
    Ok(options)
}

/// The method of a word, with a step [s] or a tolerance.
fn method(word: &str, step: f64, tolerance: f64) -> Result<Method, PlanError> {
    let method = Method::fixed(word, step).or_else(|| Method::adaptive(word, tolerance));
    method.ok_or_else(|| {
        let known = || Method::FIXED.into_iter().chain(Method::ADAPTIVE);
        let near = match (words::of_method(word), nearest(word, known())) {
            (Some(ours), _) => format!("; {ours}."),
            (None, Some(near)) => format!("; did you mean `{near}`?"),
            (None, None) => ".".to_owned(),
        };
        let list: Vec<&str> = known().collect();
        let text = format!(
            "there is no method `{word}`{near} There are: {}",
            list.join(", ")
        );
        wrong("method", text)
    })
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

fn params(scene: &Scene, given: &Table) -> Result<Vec<f64>, PlanError> {
    let mut params: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let names = || scene.params.iter().map(|param| param.name.as_str());
    for (name, value) in given {
        let setting = format!("params.{name}");
        let Some((param, slot)) = scene
            .params
            .iter()
            .zip(&mut params)
            .find(|(param, _)| param.name == *name)
        else {
            let mut inputs = scene.inputs.iter();
            return Err(match inputs.find(|input| input.name == *name) {
                Some(input) => wrong(setting, held(input)),
                None => unknown(&setting, name, names()),
            });
        };
        *slot = number(&setting, value, &param.unit.text)?;
    }
    Ok(params)
}

/// What is said where an input is given as a param.
fn held(input: &Input) -> String {
    let (name, unit) = (&input.name, &input.unit.text);
    let value = match input.components {
        3 => format!("[1, 0, 0] {unit}"),
        _ => format!("1 {unit}"),
    };
    format!(
        "`{name}` is an input and no param: what it is held at stands under [run.inputs], `{name} = \"{}\"`, or behind `--input` of `mbd run`",
        value.trim_end()
    )
}

/// What is said where a param is given as an input.
fn set_as(param: &Parameter) -> String {
    let name = &param.name;
    let value = param.unit.told(param.default);
    format!(
        "`{name}` is a param and no input: its value stands under [run.params], `{name} = \"{value}\"`, or behind `--set` of `mbd run`"
    )
}

/// A state, the places of the equilibrium points where any is given, and the joint coordinates that are given.
struct PlannedStart {
    state: Vec<f64>,
    nodes: Option<Vec<f64>>,
    joints: Vec<(String, f64)>,
    assembly: PlacementReport,
}

/// The state and the places of the equilibrium points, from names of coordinates.
fn start(
    (scene, layout): (&Scene, &Layout),
    from: StartFrom<'_>,
    given: &Table,
    placed: &[String],
) -> Result<PlannedStart, PlanError> {
    let mut slots: Vec<(String, &str, f64)> = Vec::new();
    let names = state_names(scene, layout);
    let mut declared = vec![0.0; names.len()];
    for upright in layout.quaternions() {
        declared[upright] = 1.0;
    }
    declared_parts(scene, layout, from, &mut declared);
    let fixed: Vec<Part> = placed
        .iter()
        .filter_map(|name| scene.part_named(name))
        .collect();
    if !fixed.is_empty() {
        // Of a body of which one number is given, the others are as declared. Loops that nothing closes yet are closed below, or told there.
        let mut alone = declared.clone();
        if place_declared(scene, layout, from, &[], &[], &mut alone).is_ok() {
            declared = alone;
        }
    }
    for (name, number) in names.iter().zip(declared) {
        slots.push((name.name.clone(), &name.unit, number));
    }
    let own = slots.iter_mut().skip(layout.states());
    own.zip(starts(scene, from.params))
        .for_each(|((.., number), start)| *number = start);
    for node in &layout.nodes {
        let owner = scene.points.get(node.point).map_or("", |point| &point.name);
        // The position of a `rate` node is part of the state already.
        let owner = if node.z.is_some() { "" } else { owner };
        slots.extend(["x", "y", "z"].map(|c| (format!("{owner}.{c}"), "m", 0.0)));
    }
    let mut places_given = false;
    let mut joints: Vec<(String, StartNumber)> = Vec::new();
    for (name, value) in flat(given) {
        let setting = format!("start.{name}");
        if let Some(unit) = coordinate_unit(scene, &name) {
            joints.push((name.clone(), start_number(scene, &setting, value, unit)?));
            continue;
        }
        let Some(index) = slots.iter().position(|(slot, ..)| *slot == name) else {
            let known = slots.iter().map(|(slot, ..)| slot.as_str());
            let known = known.filter(|slot| !slot.starts_with('.'));
            let coordinates = scene.joint_coordinates();
            let known = known.chain(coordinates.iter().map(String::as_str));
            return Err(unknown(&setting, &name, known));
        };
        slots[index].2 = number(&setting, value, slots[index].1)?;
        places_given |= index >= names.len();
    }
    let mut numbers: Vec<f64> = slots.into_iter().map(|(.., number)| number).collect();
    let nodes = numbers.split_off(names.len());
    for quaternion in layout.quaternions() {
        normalise(scene, &mut numbers, quaternion)?;
    }
    let named = joints.iter().map(|(name, number)| (name.as_str(), *number));
    let starts = JointStart::by_name(scene, named)
        .map_err(|name| wrong(format!("start.{name}"), "is no joint coordinate"))?;
    let assembly = place_declared(scene, layout, from, &starts, &fixed, &mut numbers)
        .map_err(|error| misplaced(scene, error))?;
    let joints = joints.into_iter().map(|(name, said)| (name, said.number()));
    Ok(PlannedStart {
        state: numbers,
        nodes: places_given.then_some(nodes),
        joints: joints.collect(),
        assembly,
    })
}

/// A start in the numbers of the state: `bob.velocity = "[1, 0, 0] m/s"` is `bob.vx`, `bob.vy` and `bob.vz`, and `bob.velocity.x` is `bob.vx`. A zero across
/// the plane of a scene is no number of its state.
fn in_numbers((scene, layout): (&Scene, &Layout), given: &Table) -> Result<Table, PlanError> {
    let known = state_names(scene, layout);
    let across = |name: &str, number: f64| {
        let has = known.iter().any(|known| known.name == name);
        layout.directions.plane.is_some() && number == 0.0 && !has
    };
    // A component goes before the vector that it is one of.
    let (mut vectors, mut all) = (Table::new(), Table::new());
    let mut add = |name: String, value: Value| match all.insert(name.clone(), value) {
        None => Ok(()),
        Some(_) => Err(wrong(format!("start.{name}"), "is given twice")),
    };
    for (name, value) in flat(given) {
        let (owner, last) = name.rsplit_once('.').unwrap_or(("", &name));
        let found = |word: &str| VECTORS.into_iter().find(|(quantity, ..)| *quantity == word);
        if let (Some((_, prefix, unit)), false) = (found(last), owner.is_empty()) {
            let given = numbers_of(&format!("start.{name}"), value, &[unit; 3])?;
            for (axis, number) in ["x", "y", "z"].into_iter().zip(given) {
                let name = format!("{owner}.{prefix}{axis}");
                if !across(&name, number) {
                    vectors.insert(name, Value::String(format!("{number:?} {unit}")));
                }
            }
            continue;
        }
        let name = match state_name(&name) {
            Some(name) => name,
            None => whole_name(scene, name),
        };
        add(name, value.clone())?;
    }
    for (name, value) in vectors {
        all.entry(name).or_insert(value);
    }
    Ok(all)
}

/// A joint coordinate by its whole name, `pin.angle` for `pin`; any other name as it is.
pub(crate) fn whole_name(scene: &Scene, name: String) -> String {
    match scene.joint_coordinate(&name) {
        Some((joint, number, false)) => scene.coordinate_name(joint, number),
        _ => name,
    }
}

/// What is said of a joint coordinate or its rate: a number, or `"about 30 deg"` of a coordinate.
fn start_number(
    scene: &Scene,
    setting: &str,
    value: &Value,
    unit: &str,
) -> Result<StartNumber, PlanError> {
    let Some(text) = value.as_str().and_then(about) else {
        return number(setting, value, unit).map(StartNumber::Exact);
    };
    let name = setting.strip_prefix("start.").unwrap_or(setting);
    if matches!(scene.joint_coordinate(name), Some((.., true))) {
        let text =
            "is a rate, and `about` is said of coordinates: give its number alone, or leave it out";
        return Err(wrong(setting, text));
    }
    number(setting, &Value::String(text.to_owned()), unit).map(StartNumber::About)
}

/// What stands behind `about`; `None` of a text that does not begin so.
pub(crate) fn about(text: &str) -> Option<&str> {
    let rest = text.trim_start().strip_prefix(ABOUT)?;
    rest.starts_with(char::is_whitespace).then(|| rest.trim())
}

/// The unit of a joint coordinate, `pin.angle`, or of its rate, `pin.angle_rate`; `None` of another name.
pub(crate) fn coordinate_unit(scene: &Scene, name: &str) -> Option<&'static str> {
    let (joint, number, is_rate) = scene.joint_coordinate(name)?;
    let (_, coordinate) = scene.coordinate(joint, number)?;
    Some(match (is_rate, coordinate.is_angle()) {
        (false, true) => "rad",
        (false, false) => "m",
        (true, true) => "rad/s",
        (true, false) => "m/s",
    })
}

fn misplaced(scene: &Scene, error: PlacementError) -> PlanError {
    let (name, why) = error.describe(scene);
    wrong("start", format!("joint `{name}` {why}"))
}

/// The bodies and points whose coordinates are given.
fn placed(scene: &Scene, given: &Table) -> Vec<String> {
    let names = flat(given).into_iter();
    let names = names.filter(|(name, _)| scene.joint_coordinate(name).is_none());
    let owners = names.filter_map(|(name, _)| Some(name.rsplit_once('.')?.0.to_owned()));
    let mut owners: Vec<String> = owners.collect();
    owners.dedup();
    owners
}

/// Those and the bodies and points that the declaration puts somewhere, unless joint coordinates are given, which go before.
fn with_declared(scene: &Scene, given: &Table, mut placed: Vec<String>) -> Vec<String> {
    let mut names = flat(given).into_iter();
    if names.any(|(name, _)| scene.joint_coordinate(&name).is_some()) {
        return placed;
    }
    for start in &scene.starts.parts {
        let name = match start.part {
            Part::Body(body) => scene.bodies.get(body).map(|body| &body.name),
            Part::Point(point) => scene.points.get(point).map(|point| &point.name),
            _ => None,
        };
        placed.extend(name.filter(|name| !placed.contains(name)).cloned());
    }
    placed
}

/// Of the bodies and points that are placed those whose velocity is said, and those whose angular velocity is, by the settings or by the declaration.
fn in_motion(scene: &Scene, given: &Table, placed: &[String]) -> [Vec<String>; 2] {
    let given = flat(given);
    let said = |name: &str, prefix: &str, declared: fn(&PartStart) -> bool| {
        let set = given.iter().any(|(key, _)| {
            let own = key.strip_prefix(name).and_then(|key| key.strip_prefix('.'));
            own.is_some_and(|slot| slot.starts_with(prefix))
        });
        let of = |start: &&PartStart| Some(start.part) == scene.part_named(name) && declared(start);
        set || scene.starts.parts.iter().any(|start| of(&start))
    };
    let all = |prefix: &str, declared: fn(&PartStart) -> bool| {
        let said = placed.iter().filter(|name| said(name, prefix, declared));
        said.cloned().collect()
    };
    [
        all("v", |start| start.velocity.is_some()),
        all("omega", |start| start.angular_velocity.is_some()),
    ]
}

/// Makes a quaternion a unit one; it needs a direction for that.
fn normalise(scene: &Scene, numbers: &mut [f64], at: usize) -> Result<(), PlanError> {
    let Some(quaternion) = numbers.get_mut(at..at + 4) else {
        return Ok(());
    };
    let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(length.is_finite() && length > 1e-6) {
        let layout = Layout::new(scene);
        let name = state_names(scene, &layout)
            .into_iter()
            .nth(at)
            .map_or_else(String::new, |name| name.name);
        return Err(wrong(
            format!("start.{name}"),
            "qw, qx, qy, qz of this body must not all vanish",
        ));
    }
    quaternion.iter_mut().for_each(|x| *x /= length);
    Ok(())
}

fn inputs(scene: &Scene, layout: &Layout, given: &Table) -> Result<Vec<f64>, PlanError> {
    let mut numbers = layout.default_inputs(scene);
    let mut known: Vec<&str> = Vec::new();
    for slots in &layout.inputs {
        let (name, units): (Option<&str>, Vec<&str>) = match slots.source {
            InputSource::Input(index) => {
                let input = scene.inputs.get(index);
                let unit = input.map_or("", |input| input.unit.text.as_str());
                (
                    input.map(|input| input.name.as_str()),
                    vec![unit; slots.len],
                )
            }
            InputSource::Load(index) => {
                let units = ["N", "N", "N", "N*m", "N*m", "N*m"];
                (
                    scene.loads.get(index).map(|load| load.name.as_str()),
                    units.to_vec(),
                )
            }
            InputSource::BodyGravity(index) => (
                scene.bodies.get(index).map(|body| body.name.as_str()),
                vec!["m/s^2"; 3],
            ),
            InputSource::PointGravity(index) => (
                scene.points.get(index).map(|point| point.name.as_str()),
                vec!["m/s^2"; 3],
            ),
        };
        let name = name.unwrap_or_default();
        known.push(name);
        let setting = format!("inputs.{name}");
        let Some(value) = given.get(name) else {
            if matches!(slots.source, InputSource::Input(_)) {
                continue;
            }
            let units = units.get(..slots.len).unwrap_or(&units);
            let text = format!(
                "this scene takes `{name}` from its caller: give {} number(s) under [run.inputs], such as `{name} = {}`",
                slots.len,
                zeros(units)
            );
            return Err(wrong(setting, text));
        };
        // A load on a point with mass has a force alone.
        let units = units.get(..slots.len).unwrap_or(&units);
        let given = numbers_of(&setting, value, units)?;
        let own = numbers.iter_mut().skip(slots.at);
        own.zip(given).for_each(|(to, value)| *to = value);
    }
    match given.keys().find(|name| !known.contains(&name.as_str())) {
        Some(name) => {
            let setting = format!("inputs.{name}");
            let mut params = scene.params.iter();
            Err(match params.find(|param| param.name == *name) {
                Some(param) => wrong(setting, set_as(param)),
                None => unknown(&setting, name, known.into_iter()),
            })
        }
        None => Ok(numbers),
    }
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
                point cart { mass: m + m_g }
                load drive on cart = [push * cos(aim), 0, 0];
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
        assert_eq!(si, Ok((vec![3.0, 0.05], vec![3.0, 0.0])));
        for (table, why) in [
            ("[run.params]\nm_g = 3\n", "declared in g"),
            ("[run.params]\nm = \"3\"\n", "needs a unit, such as kg"),
            ("[run.inputs]\npush = \"3\"\n", "needs a unit, such as N"),
            ("[run.inputs]\naim = 30\n", "more than a full turn"),
        ] {
            let error = numbers(table).unwrap_err();
            assert!(error.contains(why), "{table}: {error}");
        }
    }
}
