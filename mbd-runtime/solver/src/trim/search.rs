//! The search of a trim: (2) of [`crate::trim`](super), and Newton steps that close the joints.

use mbd_scene::{JointStart, LINE_NUMBERS, Model, Quantity, Scene, StartFrom, StartNumber};
use nalgebra::{DMatrix, DVector};

use super::{TrimError, TrimProblem, Trimmed};
use crate::columns::{Name, a_second};
use crate::compiled::Scalar;
use crate::linearise::chart::{
    Chart, ChartOrder, MinimalCoordinate, input_names, known, with_unit,
};
use crate::linearise::moment::{SceneMoment, check_given, check_lists};
use crate::linearise::{Kink, LinearisationError, StateSpace, motors_follow};
use crate::simulation::start::declared_start;

/// Steps at most.
const ROUNDS: usize = 200;
/// How far coordinates go at once where they are wanted elsewhere than the state is [m or rad].
const PART: f64 = 0.2;
/// Newton steps that close the joints at most.
const CLOSING: usize = 50;
/// What is left of a row, or of a coordinate, where it is closed [m, rad or 1].
const CLOSED: f64 = 1e-12;
/// The largest acceleration that counts as none, over the largest term of one [1].
const STILL: f64 = 1e-9;
/// Part of the largest change by an unknown below which another one changes nothing.
const NOTHING: f64 = 1e-9;

/// A trim on its way.
struct Search {
    moment: SceneMoment,
    chart: Chart,
    /// Rates of the coordinates.
    rates: DVector<f64>,
    /// Coordinates that may change, then inputs, then numbers behind the speeds.
    free: Vec<usize>,
    inputs: Vec<usize>,
    rest: usize,
}

/// What [`Trim::solve`] does: a search in the coordinates of the linear system, and where that finds nothing in those that have the attitude of
/// every body among them, or, of coordinates that were asked for, in others: one of a loop turns back on the way where the loop is stretched.
pub(crate) fn find<T: Scalar>(
    model: &dyn Model<T>,
    asked: &TrimProblem,
) -> Result<Trimmed, TrimError> {
    let first = match find_along(model, asked, ChartOrder::Places) {
        Err(first @ TrimError::Unbalanced { .. }) => first,
        found => return found,
    };
    if asked.along.is_empty() {
        return find_along(model, asked, ChartOrder::Bodies).map_err(|_| first);
    }
    let along = asked.along.clone();
    let any = TrimProblem {
        along: Vec::new(),
        ..asked.clone()
    };
    let rest = find(model, &any).map_err(|_| first)?;
    let there = TrimProblem {
        along,
        state: Some(rest.state),
        nodes: Some(rest.nodes),
        given: Some(rest.inputs),
        inputs: Vec::new(),
        guesses: Vec::new(),
        remembered: Some(rest.remembered),
        ..any
    };
    find_along(model, &there, ChartOrder::Places)
}

/// A search in coordinates that are chosen in an order.
fn find_along<T: Scalar>(
    model: &dyn Model<T>,
    asked: &TrimProblem,
    order: ChartOrder,
) -> Result<Trimmed, TrimError> {
    check_given(asked.numbers())?;
    let (scene, layout) = (model.scene(), model.layout());
    let inputs = input_names(scene, layout);
    let place_of = |name: &str| {
        let at = inputs.iter().position(|known| known.name == name);
        at.ok_or_else(|| {
            let known: Vec<&str> = inputs.iter().map(|one| one.name.as_str()).collect();
            TrimError::UnknownInput {
                name: name.to_owned(),
                known: known.join(", "),
            }
        })
    };
    let held = || layout.default_inputs(scene);
    let mut given = asked.given.clone().unwrap_or_else(held);
    for (name, value) in &asked.inputs {
        // A list of another length is refused below.
        if let Some(slot) = given.get_mut(place_of(name)?) {
            *slot = *value;
        }
    }
    let free = asked.free.iter().map(|name| place_of(name));
    let free: Vec<usize> = free.collect::<Result<_, _>>()?;
    let state = asked.state.clone().unwrap_or_else(|| {
        // Where the declared start cannot be taken, what is asked for may place the bodies.
        if let Ok((start, _)) = declared_start(model, asked.time, None) {
            return start;
        }
        let mut state = vec![0.0; layout.nx()];
        layout.quaternions().for_each(|at| state[at] = 1.0);
        state
    });
    check_lists((scene, layout), (asked.time, &state, &given))?;
    // A declared start belongs to the declared inputs; what follows them goes on from there.
    let first = match asked.state {
        None => held(),
        _ => given.clone(),
    };
    let at = (asked.time, &state[..], &first[..]);
    let mut moment = SceneMoment::at_rest(model, at)?;
    if asked.state.is_none() {
        moment.place(&asked.starts(model.scene()));
    }
    if let Some(remembered) = &asked.remembered {
        moment.recall(remembered);
    }
    let fixed = asked.fixed.iter().map(|(name, _)| name.as_str());
    let others = asked.rates.iter().chain(&asked.guesses);
    let along = asked.along.iter().map(String::as_str);
    let mut named: Vec<&str> = Vec::new();
    for name in along
        .chain(fixed)
        .chain(others.map(|(name, _)| name.as_str()))
    {
        if !named.contains(&name) {
            named.push(name);
        }
    }
    let chart = Chart::choose(&mut moment, &named, order)?;
    let find = |name: &str| {
        let all = chart.minimal.iter();
        let mut all = all.map(|one| one.coordinate.name == name);
        all.position(|own| own)
            .ok_or_else(|| LinearisationError::UnknownCoordinate {
                name: name.to_owned(),
                known: known(&moment),
            })
    };
    let mut rates = DVector::zeros(chart.len());
    let mut fixed = vec![false; chart.len()];
    let mut wanted: Vec<(usize, f64)> = Vec::new();
    for (name, value) in &asked.fixed {
        let at = find(name)?;
        fixed[at] = true;
        wanted.extend(value.map(|value| (at, value)));
    }
    for (name, rate) in &asked.rates {
        let at = find(name)?;
        fixed[at] = true;
        rates[at] = *rate;
    }
    for (name, value) in &asked.guesses {
        wanted.push((find(name)?, *value));
    }
    for &(at, _) in &wanted {
        if let MinimalCoordinate::Turn { .. } = chart.minimal[at].source {
            let name = chart.minimal[at].coordinate.name.clone();
            return Err(TrimError::Turn { name });
        }
    }
    let rest = layout.nx() - layout.nq - layout.nv;
    let mut search = Search {
        free: (0..chart.len()).filter(|&k| !fixed[k]).collect(),
        inputs: free,
        moment,
        chart,
        rates,
        rest,
    };
    let mut steps = search.chart.values(&mut search.moment)[0].map(|_| 0.0);
    let now = search.chart.values(&mut search.moment)[0].clone();
    for (at, value) in wanted {
        steps[at] = value - now[at];
    }
    let behind = DVector::zeros(rest);
    let change = DVector::from_iterator(given.len(), given.iter().zip(&first).map(|(a, b)| a - b));
    // Loops stay on their branch, and angles count their turns.
    let far = match search.chart.kept.is_empty() && layout.turns.is_empty() {
        true => 0.0,
        false => steps.amax(),
    };
    search.advance(&steps, [&behind, &change], far)?;
    if asked.remembered.is_none() {
        search.moment.begin_turns(&asked.starts(model.scene()));
    }
    // To the bit what was given, not what the parts add up to.
    search.moment.inputs.clone_from(&given);
    search.solve(asked.nodes.as_deref())
}

impl TrimProblem {
    /// Joint coordinates whose values are given.
    fn starts(&self, scene: &Scene) -> Vec<JointStart> {
        let fixed = self.fixed.iter();
        let fixed =
            fixed.filter_map(|(name, value)| Some((name.as_str(), StartNumber::Exact((*value)?))));
        let guesses = self.guesses.iter();
        let guesses = guesses.map(|(name, value)| (name.as_str(), StartNumber::About(*value)));
        let joints = guesses.chain(fixed);
        let joints = joints.filter(|(name, _)| scene.joint_coordinate(name).is_some());
        JointStart::by_name(scene, joints).unwrap_or_default()
    }
}

impl SceneMoment {
    /// Places bodies by the joint coordinates that are given.
    fn place(&mut self, starts: &[JointStart]) {
        let (scene, layout) = (self.model.scene.clone(), self.model.layout.clone());
        let from = StartFrom::new(&self.model.params, self.time).with_inputs(&self.inputs);
        let mut placed = self.state.clone();
        // Where loops cannot be closed from these, Newton steps try from where the state is.
        if mbd_scene::place_declared(&scene, &layout, from, starts, &[], &mut placed).is_ok() {
            self.state = placed;
        }
        self.begin_turns(starts);
    }
}

impl Search {
    /// Moves the coordinates, the numbers behind the speeds and the inputs, in parts that keep loops, and what motors carry, on their branch:
    /// none takes a joint further than [`PART`], nor a coordinate that goes by `far` in all.
    fn advance(
        &mut self,
        moves: &DVector<f64>,
        [behind, inputs]: [&DVector<f64>; 2],
        far: f64,
    ) -> Result<(), TrimError> {
        let carried = match motors_follow(self.moment.scene()) {
            true => self.carried(moves, [behind, inputs])?,
            false => 0.0,
        };
        let parts = (carried.max(far) / PART).ceil().clamp(1.0, 1e3);
        let first = self.moment.state.len() - self.rest;
        for _ in 0..parts as usize {
            let behind = self.moment.state[first..].iter_mut().zip(behind);
            behind.for_each(|(number, step)| *number += step / parts);
            let inputs = self.moment.inputs.iter_mut().zip(inputs);
            inputs.for_each(|(number, step)| *number += step / parts);
            self.go(&(moves / parts))?;
        }
        Ok(())
    }

    /// How far joints carry bodies for such steps, by the slopes here: K δπ = [−∂Φ/∂(z, s, u) δ(z, s, u); δξ] [m or rad].
    fn carried(
        &mut self,
        moves: &DVector<f64>,
        [behind, inputs]: [&DVector<f64>; 2],
    ) -> Result<f64, TrimError> {
        self.chart.refresh(&mut self.moment)?;
        let by_state = self.moment.by_state(Quantity::Constraint, &[]);
        let by_input = self.moment.by_input(Quantity::Constraint);
        let first = by_state.ncols() - self.rest;
        let change = by_state.columns(first, self.rest) * behind + by_input * inputs;
        let mut right = DVector::zeros(self.chart.rows.nrows());
        for (slot, &row) in right.iter_mut().zip(&self.chart.kept) {
            *slot = -change[row];
        }
        let kept = self.chart.kept.len();
        right.rows_mut(kept, moves.len()).copy_from(moves);
        Ok((&self.chart.inverse * right).amax())
    }

    /// Moves the coordinates by steps, closes the joints there, and gives the coordinates their rates.
    fn go(&mut self, steps: &DVector<f64>) -> Result<(), TrimError> {
        let kept = self.chart.kept.len();
        let before = self.chart.values(&mut self.moment)[0].clone();
        let targets = before + steps;
        let mut rotated = false;
        let mut gap = f64::INFINITY;
        for _ in 0..CLOSING {
            self.chart.refresh(&mut self.moment)?;
            let rows = self.moment.evaluate(Quantity::Constraint, &[]);
            let now = self.chart.values(&mut self.moment)[0].clone();
            let mut right = DVector::zeros(self.chart.rows.nrows());
            for (slot, &row) in right.iter_mut().zip(&self.chart.kept) {
                *slot = -rows[row];
            }
            for (k, one) in self.chart.minimal.iter().enumerate() {
                right[kept + k] = match one.source {
                    MinimalCoordinate::Turn { .. } if rotated => 0.0,
                    MinimalCoordinate::Turn { .. } => steps[k],
                    MinimalCoordinate::Joint(number) => {
                        let periodic = self.moment.is_periodic(number);
                        nearest(targets[k] - now[k], periodic)
                    }
                    MinimalCoordinate::Place { .. } => targets[k] - now[k],
                };
            }
            rotated = true;
            gap = right.amax();
            if gap < CLOSED || !gap.is_finite() {
                break;
            }
            let moved = &self.chart.inverse * right;
            self.moment.displace(moved.as_slice());
        }
        // Rounding of large positions may leave more than a millionth of a micrometre.
        if gap.is_nan() || gap >= 1e3 * CLOSED {
            return Err(TrimError::Open { gap });
        }
        self.chart.refresh(&mut self.moment)?;
        let (nq, nv) = (self.moment.layout().nq, self.moment.layout().nv);
        self.moment.state[nq..nq + nv].fill(0.0);
        let by_time = self.moment.evaluate(Quantity::ConstraintRate, &[]);
        let own = self.chart.values(&mut self.moment)[1].clone();
        let mut right = DVector::zeros(nv);
        for (slot, &row) in right.iter_mut().zip(&self.chart.kept) {
            *slot = -by_time[row];
        }
        for k in 0..self.chart.len() {
            right[kept + k] = self.rates[k] - own[k];
        }
        let speeds = &self.chart.inverse * right;
        self.moment.state[nq..nq + nv].copy_from_slice(speeds.as_slice());
        Ok(())
    }

    /// What accelerates: of every coordinate, then the rates behind the speeds; and the largest term of one, to compare with.
    fn residual(&mut self, guess: Option<&[f64]>) -> Result<DVector<f64>, TrimError> {
        self.moment.balance_nodes(guess)?;
        let rates = self.moment.rates()?;
        let (nq, nv) = (self.moment.layout().nq, self.moment.layout().nv);
        let own = self
            .chart
            .accelerations(&mut self.moment, &rates[nq..nq + nv]);
        let all = own.iter().chain(&rates[nq + nv..]).copied();
        Ok(DVector::from_iterator(self.chart.len() + self.rest, all))
    }

    fn solve(mut self, guess: Option<&[f64]>) -> Result<Trimmed, TrimError> {
        let mut residual = self.residual(guess)?;
        let (n, rest) = (self.chart.len(), self.rest);
        let (mut damping, mut iterations) = (1e-6, 0);
        let space = StateSpace::in_chart(&mut self.moment, &self.chart)?;
        let mut slopes = self.slopes(&space);
        while iterations < ROUNDS && residual.amax() > 1e-14 * size(&slopes) {
            let normal = slopes.transpose() * &slopes;
            let right = slopes.transpose() * &residual;
            let before = self.moment.state.clone();
            let (inputs, turns) = (self.moment.inputs.clone(), self.moment.turns());
            let mut better = None;
            while damping < 1e12 && better.is_none() && slopes.ncols() > 0 {
                let least = 1e-12 * size(&slopes).powi(2);
                let mut damped = normal.clone();
                for k in 0..damped.nrows() {
                    damped[(k, k)] += damping * normal[(k, k)].max(least);
                }
                let step = damped.cholesky().map(|factor| -factor.solve(&right));
                if let Some(step) = step
                    && let Ok(tried) = self.try_step(&step, n, rest)
                    && tried.norm() < residual.norm()
                    && let Ok(space) = StateSpace::in_chart(&mut self.moment, &self.chart)
                {
                    // Where lines go slack nothing leads back; where everything is still, nothing has to.
                    let there = self.slopes(&space);
                    let still = tried.amax() <= STILL * size(&there).min(1e3);
                    if still || decisive(&there) >= decisive(&slopes) {
                        better = Some((tried, there));
                        continue;
                    }
                }
                self.moment.state.clone_from(&before);
                self.moment.inputs.clone_from(&inputs);
                self.moment.count_turns_from(turns.iter().copied());
                damping *= 10.0;
            }
            let Some((tried, there)) = better else { break };
            (residual, slopes) = (tried, there);
            damping = (damping * 0.1).max(1e-15);
            iterations += 1;
        }
        let scale = size(&slopes);
        self.chart.refresh(&mut self.moment)?;
        let residual = self.residual(None)?;
        let undamped = self.moment.without_direction()?;
        let mut space = StateSpace::in_chart(&mut self.moment, &self.chart)?
            .with_kinks(&mut self.moment, &self.chart)?;
        space.undamped.extend(undamped);
        let sizes = residual.iter().map(|x| x.abs()).enumerate();
        let worst = sizes.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((worst, left)) = worst
            && (left.is_nan() || left > STILL * scale.min(1e3))
        {
            let (name, unit) = match self.chart.minimal.get(worst) {
                Some(one) => (&one.coordinate.name, format!("{}^2", one.rate.unit)),
                None => {
                    let state = &space.states[n + worst];
                    (&state.name, a_second(&state.unit))
                }
            };
            return Err(TrimError::Unbalanced {
                worst: name.clone(),
                residual: residual[worst],
                unit,
                is_state: worst >= n,
                counts: [self.free.len() + self.inputs.len() + rest, n + rest],
                iterations,
                slack: self.slack(),
                kink: self.kink(&space),
            });
        }
        let undecided = self.undecided(&space);
        let [values, rates] = self.chart.values(&mut self.moment);
        let (nq, nv) = (self.moment.layout().nq, self.moment.layout().nv);
        let behind = &self.moment.state[nq + nv..];
        let values = self.chart.minimal.iter().zip(values.iter());
        let values = values.map(|(own, value)| match own.source {
            MinimalCoordinate::Turn { .. } => None,
            _ => Some(*value),
        });
        let others = rates.iter().chain(behind).chain(&self.moment.inputs);
        let names = space.states.iter().chain(&space.inputs).cloned();
        Ok(Trimmed {
            names: names.collect(),
            values: values.chain(others.copied().map(Some)).collect(),
            nodes: self.moment.node_positions(),
            remembered: self.moment.remembered(),
            state: self.moment.state,
            inputs: self.moment.inputs,
            space,
            undecided,
            iterations,
        })
    }

    /// Columns of (2).
    fn slopes(&self, space: &StateSpace) -> DMatrix<f64> {
        let n = self.chart.len();
        let below = |matrix: &DMatrix<f64>, column: usize| {
            matrix.view((n, column), (n + self.rest, 1)).into_owned()
        };
        let coordinates = self.free.iter().map(|&k| below(&space.a, k));
        let inputs = self.inputs.iter().map(|&k| below(&space.b, k));
        let behind = (0..self.rest).map(|k| below(&space.a, 2 * n + k));
        let columns: Vec<DMatrix<f64>> = coordinates.chain(inputs).chain(behind).collect();
        DMatrix::from_fn(n + self.rest, columns.len(), |row, column| {
            columns[column][(row, 0)]
        })
    }

    fn try_step(
        &mut self,
        step: &DVector<f64>,
        n: usize,
        rest: usize,
    ) -> Result<DVector<f64>, TrimError> {
        let mut moves = DVector::zeros(n);
        for (number, &k) in self.free.iter().enumerate() {
            moves[k] = step[number];
        }
        let first = self.free.len();
        let mut inputs = DVector::zeros(self.moment.inputs.len());
        for (number, &k) in self.inputs.iter().enumerate() {
            inputs[k] = step[first + number];
        }
        let behind = step.rows(first + self.inputs.len(), rest).into_owned();
        self.advance(&moves, [&behind, &inputs], 0.0)?;
        let nodes = self.moment.node_positions();
        self.residual(Some(&nodes))
    }

    /// A kink of a rate here, by an unknown.
    fn kink(&self, space: &StateSpace) -> Option<Box<Kink>> {
        let coordinates = self.free.iter().filter_map(|at| space.states.get(*at));
        let inputs = self.inputs.iter().filter_map(|at| space.inputs.get(*at));
        let unknowns: Vec<&Name> = coordinates.chain(inputs).collect();
        let mut kinks = space.kinks.iter();
        let own = kinks.find(|kink| kink.is_rate && unknowns.contains(&&kink.by));
        own.map(|kink| Box::new(kink.clone()))
    }

    /// The lines that are slack here, by name.
    fn slack(&mut self) -> Vec<String> {
        let lines = self.moment.evaluate(Quantity::Lines, &[]);
        let all = self
            .moment
            .scene()
            .lines
            .iter()
            .zip(lines.chunks(LINE_NUMBERS));
        let slack = all.filter(|(line, numbers)| line.kind.is_unilateral() && numbers[0] <= 0.0);
        slack.map(|(line, _)| line.name.clone()).collect()
    }

    /// The unknowns along which nothing changes what accelerates.
    fn undecided(&self, space: &StateSpace) -> Vec<String> {
        let slopes = self.slopes(space);
        let (n, least) = (self.chart.len(), NOTHING * size(&slopes));
        let coordinates = self.free.iter().copied();
        let inputs = self.inputs.iter().map(|&k| &space.inputs[k]);
        let behind = (0..self.rest).map(|k| &space.states[2 * n + k]);
        let names = coordinates
            .map(|k| &space.states[k])
            .chain(inputs)
            .chain(behind);
        let columns = slopes.column_iter();
        let still = names
            .zip(columns)
            .filter(|(_, column)| column.amax() <= least);
        still.map(|(name, _)| with_unit(name)).collect()
    }
}

/// The largest change of an acceleration by a unit of an unknown, at least 1.
fn size(slopes: &DMatrix<f64>) -> f64 {
    slopes.iter().fold(1.0, |most, x| x.abs().max(most))
}

/// How many unknowns change anything.
fn decisive(slopes: &DMatrix<f64>) -> usize {
    let least = NOTHING * size(slopes);
    let columns = slopes.column_iter();
    columns.filter(|column| column.amax() > least).count()
}

/// A difference of angles within half a turn.
fn nearest(difference: f64, periodic: bool) -> f64 {
    let turn = std::f64::consts::TAU;
    match periodic {
        true => difference - turn * (difference / turn).round(),
        false => difference,
    }
}

impl SceneMoment {
    /// Whether a joint coordinate jumps by a turn.
    fn is_periodic(&self, number: usize) -> bool {
        let joints = self.scene().joints.iter();
        let mut all = joints.flat_map(|joint| joint.law.measured());
        all.nth(number)
            .is_some_and(|measured| measured.is_periodic())
    }
}
