//! The linear system of a scene at a state, in minimal coordinates.
//!
//! ```text
//! ṡ = A s + B u,   o = C s + D u            s = [δξ | δη | δz]: coordinates, their rates, what stands behind the speeds in the state     (1)
//! δx = T s,   Jx = ∂ẋ/∂x:   A = ∂(ξ̇, η̇, ż)/∂x T,   C = ∂o/∂x T                                                                      (2)
//! η̇ = c v̇ − γ_c of a joint coordinate, v̇ of a position or a turn;   δθ̇ = δω − ω × δθ of a turn in body axes, δω + ω × δθ in world axes    (3)
//! ```
//!
//! Small deviations from the motion through that state, which need not be at rest. Every derivative is exact: (2) uses those of
//! [`super`], through joints and nodes. Source: Kane and Levinson, Dynamics, on linearised equations; [derived] for loops.

use mbd_scene::{Float, Formula, Joint, Layout, Model, Quantity, Scene};
use nalgebra::{Complex, DMatrix, DVector};

use super::LinearisationError;
use super::chart::{Chart, ChartOrder, MinimalCoordinate, input_names};
use super::kinks::{Kink, kinks};
use super::moment::{SceneMoment, dense};
use crate::columns::{Name, remark, state_names};
use crate::system::Remembered;

/// A, B, C, D of a scene at a state in minimal coordinates, with names.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// A, n_s × n_s.
    pub a: DMatrix<f64>,
    /// B, n_s × n_u.
    pub b: DMatrix<f64>,
    /// C, n_o × n_s, in the units of the output columns.
    pub c: DMatrix<f64>,
    /// D, n_o × n_u.
    pub d: DMatrix<f64>,
    /// Names and units of s: minimal coordinates, their rates, node positions, declared states.
    pub states: Vec<Name>,
    /// Names and units of u, in the order of [`Layout::inputs`](mbd_scene::Layout::inputs).
    pub inputs: Vec<Name>,
    /// Names and units of the output columns.
    pub outputs: Vec<Name>,
    /// What a unit of each s is in the state x = [q | v | z | s], n_x × n_s.
    pub tangent: DMatrix<f64>,
    /// Accelerations of the coordinates at the state [m/s² or rad/s²], then ż: zero where the motion is steady.
    pub accelerations: DVector<f64>,
    /// `stepwise` nodes with damped lines, and damped springs with both ends at the same place, which are in this system without their damping; only that
    /// of a rest has such.
    pub undamped: Vec<String>,
    /// Where it stands at a place that has another linear system on the other side: what changes there. Empty elsewhere.
    pub kinks: Vec<Kink>,
}

impl StateSpace {
    /// The frequency response C (iω − A)⁻¹ B + D at ω [rad/s], n_o × n_u: what each output does, in amplitude and phase, per unit of a
    /// harmonic input. `None` where iω is an eigenvalue, or ω is no number.
    #[must_use]
    pub fn response(&self, omega: f64) -> Option<DMatrix<Complex<f64>>> {
        let whole = |matrix: &DMatrix<f64>| matrix.map(|x| Complex::new(x, 0.0));
        let n = self.a.nrows();
        let shifted =
            DMatrix::from_diagonal_element(n, n, Complex::new(0.0, omega)) - whole(&self.a);
        let states = shifted.lu().solve(&whole(&self.b))?;
        let response = whole(&self.c) * states + whole(&self.d);
        let finite = response
            .iter()
            .all(|x| x.re.is_finite() && x.im.is_finite());
        finite.then_some(response)
    }

    /// The system sampled with a period T [s] at inputs that are held between samples: s(k + 1) = A_d s(k) + B_d u(k), from
    /// exp([A B; 0 0] T) = [A_d B_d; 0 1]; o = C s + D u stays. `None` for a period that is not above zero, or so long that the
    /// exponential is no number.
    #[must_use]
    pub fn sampled(&self, period: f64) -> Option<[DMatrix<f64>; 2]> {
        let (n, m) = self.b.shape();
        let mut both = DMatrix::zeros(n + m, n + m);
        both.view_mut((0, 0), (n, n)).copy_from(&self.a);
        both.view_mut((0, n), (n, m)).copy_from(&self.b);
        both *= period;
        if !(period > 0.0 && both.iter().all(|x| x.is_finite())) {
            return None;
        }
        let both = both.exp();
        let parts =
            [(0, n), (n, m)].map(|(at, columns)| both.view((0, at), (n, columns)).into_owned());
        parts
            .iter()
            .all(|part| part.iter().all(|x| x.is_finite()))
            .then_some(parts)
    }

    /// About a state of a model, as it is at the start of a run.
    pub(crate) fn of_model<T: Float>(
        model: &dyn Model<T>,
        at: (f64, &[f64], &[f64]),
        coordinates: &[&str],
    ) -> Result<Self, LinearisationError> {
        Self::make(model, at, None, coordinates)
    }

    /// About a state, for what a run knows of it: the positions of the nodes, and what it remembers.
    pub(crate) fn make<T: Float>(
        model: &dyn Model<T>,
        at: (f64, &[f64], &[f64]),
        known: Option<(&[f64], &Remembered)>,
        coordinates: &[&str],
    ) -> Result<Self, LinearisationError> {
        let mut moment = SceneMoment::new(model, at)?;
        if let Some((_, remembered)) = known {
            moment.recall(remembered);
        }
        if let Some(node) = moment.damped_by_steps.first().cloned() {
            return Err(LinearisationError::Stepwise { node });
        }
        moment.balance_nodes(known.map(|(nodes, _)| nodes))?;
        if let Some(spring) = moment.without_direction()?.pop() {
            return Err(LinearisationError::NoDirection { spring });
        }
        let chart = Chart::choose(&mut moment, coordinates, ChartOrder::Places)?;
        Self::in_chart(&mut moment, &chart)?.with_kinks(&mut moment, &chart)
    }

    /// It, with the kinks of the place that it stands at.
    ///
    /// # Errors
    /// A derivative that there is not.
    pub(crate) fn with_kinks(
        mut self,
        moment: &mut SceneMoment,
        chart: &Chart,
    ) -> Result<Self, LinearisationError> {
        self.kinks = kinks(moment, chart, &self)?;
        Ok(self)
    }

    pub(crate) fn in_chart(
        moment: &mut SceneMoment,
        chart: &Chart,
    ) -> Result<Self, LinearisationError> {
        let Along {
            tangent,
            rates,
            by_input,
            outputs: [c, d],
            followed,
        } = Along::new(moment, chart)?;
        let (nq, nv, nx) = {
            let layout = moment.layout();
            (layout.nq, layout.nv, layout.nx())
        };
        let (n, rest) = (chart.len(), nx - nq - nv);
        let speeds = moment.rates()?;
        let speeds = &speeds[nq..];
        let measured = moment.by_state(Quantity::JointCoordinates, &speeds[..nv]);
        let (ns, nu) = (2 * n + rest, by_input.ncols());
        let (mut a, mut b) = (DMatrix::zeros(ns, ns), DMatrix::zeros(ns, nu));
        // Small moves of a unit of each s: none of the rates.
        let mut moves = DMatrix::zeros(nv, ns);
        moves.view_mut((0, 0), (nv, n)).copy_from(&chart.moves());
        if let Some(followed) = &followed {
            moves
                .view_mut((0, 2 * n), (nv, rest))
                .copy_from(&followed.moves);
        }
        for (line, one) in chart.minimal.iter().enumerate() {
            a[(line, n + line)] = 1.0;
            let swept = chart.swept(moment, one, &moves);
            let mut own = a.row_mut(line);
            own += swept;
            if let Some(followed) = &followed {
                let swept = chart.swept(moment, one, &followed.held);
                b.row_mut(line).copy_from(&swept);
            }
            match one.source {
                MinimalCoordinate::Joint(number) => {
                    let along = chart.rows.row(chart.kept.len() + line);
                    let here = measured.row(3 * number + 2) * &tangent;
                    let through = along * rates.view((nq, 0), (nv, ns));
                    a.row_mut(n + line).copy_from(&(here + through));
                    let through = along * by_input.view((nq, 0), (nv, nu));
                    b.row_mut(n + line).copy_from(&through);
                    if let Some(followed) = &followed {
                        let mut own = b.row_mut(n + line);
                        own += measured.row(3 * number + 2) * &followed.state;
                    }
                }
                MinimalCoordinate::Place { speed, .. } | MinimalCoordinate::Turn { speed, .. } => {
                    a.row_mut(n + line).copy_from(&rates.row(nq + speed));
                    b.row_mut(n + line).copy_from(&by_input.row(nq + speed));
                }
            }
        }
        let behind = (nq + nv, rest);
        a.rows_mut(2 * n, rest)
            .copy_from(&rates.rows(behind.0, behind.1));
        b.rows_mut(2 * n, rest)
            .copy_from(&by_input.rows(behind.0, behind.1));
        let own = chart.accelerations(moment, &speeds[..nv]);
        let accelerations = own.iter().chain(&speeds[nv..]).copied();
        let accelerations = DVector::from_iterator(n + rest, accelerations);
        let (scene, layout) = (moment.scene(), moment.layout());
        let coordinates = chart.minimal.iter().map(|one| one.coordinate.clone());
        let their_rates = chart.minimal.iter().map(|one| one.rate.clone());
        let behind = state_names(scene, layout).into_iter().skip(nq + nv);
        Ok(StateSpace {
            c,
            d,
            states: coordinates.chain(their_rates).chain(behind).collect(),
            inputs: input_names(scene, layout),
            outputs: output_names(scene, layout),
            tangent,
            accelerations,
            undamped: moment.damped_by_steps.clone(),
            kinks: Vec::new(),
            a,
            b,
        })
    }

    /// The place of a state, an input or an output by its name: `state("pin.angle_rate")`.
    #[must_use]
    pub fn state(&self, name: &str) -> Option<usize> {
        self.states.iter().position(|known| known.name == name)
    }

    /// The place of an input by its name.
    #[must_use]
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|known| known.name == name)
    }

    /// The place of an output column by its name.
    #[must_use]
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|known| known.name == name)
    }
}

/// What motors that follow inputs or states move.
struct Followed {
    /// Small moves of a unit of each number behind the speeds.
    moves: DMatrix<f64>,
    /// What a unit of each input is in the state.
    state: DMatrix<f64>,
    /// Small moves of a unit of each input.
    held: DMatrix<f64>,
}

/// Derivatives of ẋ and of the outputs along the minimal coordinates, their rates and the rest of s, and by the inputs.
pub(super) struct Along {
    /// T, n_x × n_s.
    pub tangent: DMatrix<f64>,
    /// J T, n_x × n_s.
    pub rates: DMatrix<f64>,
    /// ∂ẋ/∂u, n_x × n_u.
    pub by_input: DMatrix<f64>,
    /// C and D.
    pub outputs: [DMatrix<f64>; 2],
    followed: Option<Followed>,
}

impl Along {
    pub(super) fn new(moment: &mut SceneMoment, chart: &Chart) -> Result<Self, LinearisationError> {
        let linear = moment.linearise()?;
        let (nq, nv, nx) = {
            let layout = moment.layout();
            (layout.nq, layout.nv, layout.nx())
        };
        let whole = dense(linear.state());
        let mut by_input = dense(linear.input());
        let turns = whole.view((0, nq), (nq, nv)).into_owned();
        let mut tangent = chart.tangent(moment, &turns);
        let outputs = dense(linear.outputs_by_state());
        let mut outputs_by_input = dense(linear.outputs_by_input());
        let (n, rest) = (chart.len(), nx - nq - nv);
        let mut followed = None;
        if motors_follow(moment.scene()) {
            let rows = [Quantity::Constraint, Quantity::ConstraintRate];
            let by_state = rows.map(|what| moment.by_state(what, &[]));
            let behind = by_state
                .each_ref()
                .map(|by| by.columns(nq + nv, rest).into_owned());
            let [state, moves] = chart.followed(moment, &turns, behind.each_ref());
            let mut own = tangent.columns_mut(2 * n, rest);
            own += state;
            let held = rows.map(|what| moment.by_input(what));
            let [state, held] = chart.followed(moment, &turns, held.each_ref());
            by_input += &whole * &state;
            outputs_by_input += &outputs * &state;
            followed = Some(Followed { moves, state, held });
        }
        Ok(Along {
            rates: &whole * &tangent,
            outputs: [outputs * &tangent, outputs_by_input],
            by_input,
            tangent,
            followed,
        })
    }

    /// All of them: rows of ẋ, then of the outputs; columns of s, then of the inputs.
    pub(super) fn all(&self) -> DMatrix<f64> {
        let (rates, [c, d]) = (&self.rates, &self.outputs);
        let [states, outputs] = [rates.shape(), c.shape()];
        let mut all = DMatrix::zeros(states.0 + outputs.0, states.1 + d.ncols());
        for (first, by_state, by_input) in [(0, rates, &self.by_input), (states.0, c, d)] {
            let count = by_state.nrows();
            all.view_mut((first, 0), (count, states.1))
                .copy_from(by_state);
            all.view_mut((first, states.1), (count, d.ncols()))
                .copy_from(by_input);
        }
        all
    }
}

/// Whether motors follow inputs or states.
pub(crate) fn motors_follow(scene: &Scene) -> bool {
    let mut motors = scene.joints.iter().flat_map(Joint::motors);
    motors.any(|(_, course)| matches!(course, Formula::Vector(_)))
}

/// Names and units of the output columns.
pub(crate) fn output_names(scene: &Scene, layout: &Layout) -> Vec<Name> {
    let outputs = scene.outputs.iter();
    let each = outputs.flat_map(|output| {
        let axes: &[(&str, Option<usize>)] = match output.components {
            1 => &[("", None)],
            _ => &[("x", Some(0)), ("y", Some(1)), ("z", Some(2))],
        };
        let column = scene.output_column(output);
        axes.iter().map(move |&(axis, component)| {
            let ambiguous = scene.ambiguous_reactions(layout, &output.value, component);
            Name {
                remark: remark(!ambiguous.is_empty()),
                ..Name::new(&column, axis, &output.unit.text)
            }
        })
    });
    each.collect()
}
