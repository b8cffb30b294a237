//! Minimal coordinates: as many joint coordinates, or components of positions and rotations, as there are freedoms, and what a small change of them
//! is in the state.
//!
//! ```text
//! K δπ = [0; δξ],   K = [Φ_v; c]                     δπ: small moves in the components of the speeds, δq = N δπ                (1)
//! K δv = [−∂Φ̇/∂q δq; δη − ∂η/∂q δq]                  η: rates of ξ, η = c v + c_t                                              (2)
//! ```
//!
//! Rows c are chosen one after the other, in the metric of the mass matrix: those that users name, then joint coordinates in the order of their
//! declaration, then bodies and points; one that the rows and those before it hold by more than a part is passed over, until nothing else is left.

use mbd_scene::{AngularVelocity, Plane, PointSlots, Quantity, Scene};
use nalgebra::{DMatrix, DVector};

use super::LinearisationError;
use super::moment::SceneMoment;
use crate::basis::Basis;
use crate::columns::{Name, state_names};

/// Parts of what the joints leave of a candidate that must be new, one round after the other.
const NEW: [f64; 3] = [0.1, 0.01, 1e-3];
/// The least of it that counts as independent.
const LEAST: f64 = 1e-6;

/// What a minimal coordinate is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MinimalCoordinate {
    /// A measured joint coordinate, by number.
    Joint(usize),
    /// A position, or the angle of a body in a plane, whose rate is this speed.
    Place {
        /// Its place in q.
        coordinate: usize,
        /// The speed.
        speed: usize,
    },
    /// A small turn of a body, or of what a joint of a tree carries, about an axis along a component of its angular velocity.
    Turn {
        /// The speed that is the first component of this angular velocity.
        first: usize,
        /// The component.
        axis: usize,
        /// Whether the axes are those of what turns, or those of the world.
        axes: AngularVelocity,
        /// The speed.
        speed: usize,
    },
}

/// A minimal coordinate with its names.
#[derive(Clone, Debug)]
pub(crate) struct Minimal {
    pub source: MinimalCoordinate,
    /// Name and unit of the coordinate.
    pub coordinate: Name,
    /// Name and unit of its rate.
    pub rate: Name,
}

/// Minimal coordinates at a state.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    /// The coordinates.
    pub minimal: Vec<Minimal>,
    /// K.
    pub rows: DMatrix<f64>,
    /// K⁻¹.
    pub inverse: DMatrix<f64>,
    /// The rows of the joints that are in K, by number.
    pub kept: Vec<usize>,
}

/// Which coordinates of bodies come first, and are chosen where they are independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChartOrder {
    /// The places of all bodies and points, then turns.
    Places,
    /// Place and turn of one body, then of the next: places of what hangs on a body do not stand for its attitude, which they tell badly far from
    /// where they are chosen.
    Bodies,
}

/// Every coordinate that a scene has a name for.
pub(crate) fn candidates(moment: &SceneMoment, order: ChartOrder) -> Vec<Minimal> {
    let (scene, layout) = (moment.scene(), moment.layout());
    let mut all = Vec::new();
    let mut number = 0;
    for joint in &scene.joints {
        for measured in joint.law.measured() {
            let unit = measured.unit();
            all.push(Minimal {
                source: MinimalCoordinate::Joint(number),
                coordinate: Name::new(&joint.name, measured.name, unit),
                rate: Name::new(&joint.name, measured.rate, &format!("{unit}/s")),
            });
            number += 1;
        }
    }
    let names = state_names(scene, layout);
    let name = |index: usize| names.get(index).cloned();
    let place = |coordinate: usize, speed: usize| {
        Some(Minimal {
            source: MinimalCoordinate::Place { coordinate, speed },
            coordinate: name(coordinate)?,
            rate: name(layout.nq + speed)?,
        })
    };
    let turns = |owner: &str, first: usize, axes: AngularVelocity| {
        let words = ["turn_x", "turn_y", "turn_z"].into_iter().enumerate();
        let all = words.filter_map(|(axis, word)| {
            let speed = first + axis;
            Some(Minimal {
                source: MinimalCoordinate::Turn {
                    first,
                    axis,
                    axes,
                    speed,
                },
                coordinate: Name::new(owner, word, "rad"),
                rate: name(layout.nq + speed)?,
            })
        });
        all.collect::<Vec<Minimal>>()
    };
    let (moves, axes) = (
        layout.directions.translations().len(),
        scene.angular_velocity,
    );
    let in_space = layout.directions.plane.map(Plane::normal).is_none();
    for (body, slots) in layout.own_bodies() {
        let places = match layout.directions.plane {
            Some(_) => moves + 1,
            None => moves,
        };
        all.extend((0..places).filter_map(|k| place(slots.q + k, slots.v + k)));
        if in_space && order == ChartOrder::Bodies {
            all.extend(turns(&scene.bodies[body].name, slots.v + moves, axes));
        }
    }
    for slots in &layout.points {
        if let PointSlots::Mass(slots) = slots {
            all.extend((0..moves).filter_map(|k| place(slots.q + k, slots.v + k)));
        }
    }
    if in_space {
        if order == ChartOrder::Places {
            for (body, slots) in layout.own_bodies() {
                all.extend(turns(&scene.bodies[body].name, slots.v + moves, axes));
            }
        }
        // A joint of a tree that carries an attitude measures nothing of it: its angular velocity is that in frame 2.
        for (joint, link) in layout.joint_links() {
            let joint = &scene.joints[joint];
            if joint.law.attitude().is_some() {
                let first = link.slots.v + link.speeds - 3;
                all.extend(turns(&joint.name, first, AngularVelocity::Body));
            }
        }
    }
    all
}

/// The names of all coordinates, as a message lists them.
pub(crate) fn known(moment: &SceneMoment) -> String {
    let all = candidates(moment, ChartOrder::Places);
    let names: Vec<&str> = all.iter().map(|one| one.coordinate.name.as_str()).collect();
    names.join(", ")
}

impl Chart {
    /// Chooses the coordinates at a state, those of `wanted` before all others.
    ///
    /// # Errors
    /// A name that there is not; one that depends on others; rows that lose rank here.
    pub(crate) fn choose(
        moment: &mut SceneMoment,
        wanted: &[&str],
        order: ChartOrder,
    ) -> Result<Self, LinearisationError> {
        let mut all = candidates(moment, order);
        let mut first = Vec::new();
        for name in wanted {
            let Some(at) = all.iter().position(|one| one.coordinate.name == *name) else {
                let (name, known) = ((*name).to_owned(), known(moment));
                return Err(LinearisationError::UnknownCoordinate { name, known });
            };
            first.push(all.remove(at));
        }
        let (nv, nc) = (moment.layout().nv, moment.layout().nc);
        let slopes = moment.by_state(Quantity::JointCoordinates, &[]);
        let nq = moment.layout().nq;
        let row = |one: &Minimal| match one.source {
            MinimalCoordinate::Joint(number) => {
                slopes.view((3 * number + 1, nq), (1, nv)).into_owned()
            }
            MinimalCoordinate::Place { speed, .. } | MinimalCoordinate::Turn { speed, .. } => {
                DMatrix::from_fn(1, nv, |_, k| f64::from(u8::from(k == speed)))
            }
        };
        let mut basis = Basis::new(&moment.evaluate(Quantity::MassMatrix, &[]), nv);
        let joints = moment.evaluate(Quantity::ConstraintJacobian, &[]);
        let joints = DMatrix::from_row_slice(nc, nv, &joints);
        let kept = basis.take_rows(&joints);
        if kept.len() < moment.rank() {
            return Err(LinearisationError::DependentRows {
                margin: basis.passed,
            });
        }
        let mut chosen: Vec<(usize, Minimal, DMatrix<f64>)> = Vec::new();
        for one in first {
            let own = row(&one);
            if !basis.take(own.as_slice(), LEAST) {
                let name = one.coordinate.name;
                return Err(LinearisationError::DependentCoordinate { name });
            }
            chosen.push((0, one, own));
        }
        // Joint coordinates before others, whatever they leave; in the end anything.
        let joints_first = [true, false].map(|joints| NEW.map(|new| (joints, new)));
        let rounds = joints_first.as_flattened().iter().copied();
        let mut all: Vec<(usize, Minimal)> = (1..).zip(all).collect();
        for (joints, new) in rounds.chain([(true, LEAST), (false, LEAST)]) {
            let mut left = Vec::new();
            for (place, one) in all {
                let own = row(&one);
                let asked = matches!(one.source, MinimalCoordinate::Joint(_)) == joints;
                if asked && own.iter().all(|x| x.is_finite()) && basis.take(own.as_slice(), new) {
                    chosen.push((place, one, own));
                } else {
                    left.push((place, one));
                }
            }
            all = left;
        }
        chosen.sort_by_key(|(place, ..)| *place);
        let mut rows = DMatrix::zeros(nv, nv);
        for (line, &row) in kept.iter().enumerate() {
            rows.row_mut(line).copy_from(&joints.row(row));
        }
        for (line, (_, _, row)) in chosen.iter().enumerate() {
            rows.row_mut((kept.len() + line).min(nv - 1))
                .copy_from(&row.row(0));
        }
        let inverse = rows.clone().try_inverse();
        let inverse = inverse.filter(|_| kept.len() + chosen.len() == nv);
        let inverse = inverse.ok_or(LinearisationError::DependentRows { margin: 0.0 })?;
        Ok(Chart {
            minimal: chosen.into_iter().map(|(_, one, _)| one).collect(),
            rows,
            inverse,
            kept,
        })
    }

    /// The same coordinates where the state is now.
    ///
    /// # Errors
    /// Rows or coordinates that lose rank there.
    pub(crate) fn refresh(&mut self, moment: &mut SceneMoment) -> Result<(), LinearisationError> {
        let (nq, nv) = (moment.layout().nq, moment.layout().nv);
        let joints = moment.evaluate(Quantity::ConstraintJacobian, &[]);
        for (line, &row) in self.kept.iter().enumerate() {
            let own = &joints[row * nv..(row + 1) * nv];
            self.rows
                .row_mut(line)
                .iter_mut()
                .zip(own)
                .for_each(|(to, x)| *to = *x);
        }
        let slopes = moment.by_state(Quantity::JointCoordinates, &[]);
        for (line, one) in self.minimal.iter().enumerate() {
            if let MinimalCoordinate::Joint(number) = one.source {
                let own = slopes.view((3 * number + 1, nq), (1, nv));
                self.rows.row_mut(self.kept.len() + line).copy_from(&own);
            }
        }
        let inverse = self.rows.clone().try_inverse();
        self.inverse = inverse.ok_or(LinearisationError::DependentRows { margin: 0.0 })?;
        Ok(())
    }

    /// How many coordinates there are.
    pub(crate) fn len(&self) -> usize {
        self.minimal.len()
    }

    /// δπ for a unit of each coordinate, by (1).
    pub(crate) fn moves(&self) -> DMatrix<f64> {
        self.inverse
            .columns(self.kept.len(), self.len())
            .into_owned()
    }

    /// What a unit of each coordinate, then of each rate, then of every number behind the speeds is in the state: n_x × n_s, by (1) and (2).
    pub(crate) fn tangent(&self, moment: &mut SceneMoment, turns: &DMatrix<f64>) -> DMatrix<f64> {
        let (nq, nv, nx) = {
            let layout = moment.layout();
            (layout.nq, layout.nv, layout.nx())
        };
        let (n, held) = (self.len(), self.kept.len());
        let rest = nx - nq - nv;
        let mut tangent = DMatrix::zeros(nx, 2 * n + rest);
        let moved = turns * self.moves();
        tangent.view_mut((0, 0), (nq, n)).copy_from(&moved);
        let of_rows = moment.by_state(Quantity::ConstraintRate, &[]);
        let of_rates = moment.by_state(Quantity::JointCoordinates, &[]);
        let mut right = DMatrix::zeros(nv, 2 * n);
        for (line, &row) in self.kept.iter().enumerate() {
            let change = of_rows.view((row, 0), (1, nq)) * &moved;
            right.view_mut((line, 0), (1, n)).copy_from(&-change);
        }
        for (line, one) in self.minimal.iter().enumerate() {
            right[(held + line, n + line)] = 1.0;
            if let MinimalCoordinate::Joint(number) = one.source {
                let change = of_rates.view((3 * number + 1, 0), (1, nq)) * &moved;
                right.view_mut((held + line, 0), (1, n)).copy_from(&-change);
            }
        }
        tangent
            .view_mut((nq, 0), (nv, 2 * n))
            .copy_from(&(&self.inverse * right));
        (0..rest).for_each(|k| tangent[(nq + nv + k, 2 * n + k)] = 1.0);
        tangent
    }

    /// What a unit of each of some numbers that motors follow is in the state at fixed coordinates and rates, n_x × their number, and in the moves
    /// δπ: K δπ = [−∂Φ/∂s; 0], and (2) with −∂Φ̇/∂s beside −∂Φ̇/∂q δq. `by` are the derivatives of Φ and Φ̇ by these numbers.
    pub(crate) fn followed(
        &self,
        moment: &mut SceneMoment,
        turns: &DMatrix<f64>,
        by: [&DMatrix<f64>; 2],
    ) -> [DMatrix<f64>; 2] {
        let (nq, nv, nx) = {
            let layout = moment.layout();
            (layout.nq, layout.nv, layout.nx())
        };
        let [positions, rates] = by;
        let count = positions.ncols();
        let mut right = DMatrix::zeros(nv, count);
        for (line, &row) in self.kept.iter().enumerate() {
            right.row_mut(line).copy_from(&-positions.row(row));
        }
        let moves = &self.inverse * right;
        let moved = turns * &moves;
        let of_rows = moment.by_state(Quantity::ConstraintRate, &[]);
        let of_rates = moment.by_state(Quantity::JointCoordinates, &[]);
        let mut right = DMatrix::zeros(nv, count);
        for (line, &row) in self.kept.iter().enumerate() {
            let change = of_rows.view((row, 0), (1, nq)) * &moved + rates.row(row);
            right.row_mut(line).copy_from(&-change);
        }
        for (line, one) in self.minimal.iter().enumerate() {
            if let MinimalCoordinate::Joint(number) = one.source {
                let change = of_rates.view((3 * number + 1, 0), (1, nq)) * &moved;
                right.row_mut(self.kept.len() + line).copy_from(&-change);
            }
        }
        let mut state = DMatrix::zeros(nx, count);
        state.view_mut((0, 0), (nq, count)).copy_from(&moved);
        let speeds = &self.inverse * right;
        state.view_mut((nq, 0), (nv, count)).copy_from(&speeds);
        [state, moves]
    }

    /// The values of the coordinates, of a turn zero, and their rates.
    pub(crate) fn values(&self, moment: &mut SceneMoment) -> [DVector<f64>; 2] {
        let measured = moment.evaluate(Quantity::JointCoordinates, &[]);
        let speeds = &moment.state[moment.layout().nq..];
        let each = |of: &dyn Fn(MinimalCoordinate) -> f64| {
            DVector::from_iterator(self.len(), self.minimal.iter().map(|one| of(one.source)))
        };
        [
            each(&|source| match source {
                MinimalCoordinate::Joint(number) => measured[3 * number],
                MinimalCoordinate::Place { coordinate, .. } => moment.state[coordinate],
                MinimalCoordinate::Turn { .. } => 0.0,
            }),
            each(&|source| match source {
                MinimalCoordinate::Joint(number) => measured[3 * number + 1],
                MinimalCoordinate::Place { speed, .. } | MinimalCoordinate::Turn { speed, .. } => {
                    speeds[speed]
                }
            }),
        ]
    }

    /// The accelerations of the coordinates for given v̇.
    pub(crate) fn accelerations(&self, moment: &mut SceneMoment, speeds: &[f64]) -> DVector<f64> {
        let measured = moment.evaluate(Quantity::JointCoordinates, speeds);
        let each = self.minimal.iter().map(|one| match one.source {
            MinimalCoordinate::Joint(number) => measured[3 * number + 2],
            MinimalCoordinate::Place { speed, .. } | MinimalCoordinate::Turn { speed, .. } => {
                speeds[speed]
            }
        });
        DVector::from_iterator(self.len(), each)
    }

    /// How a small turn changes by the turning of the body itself: ∓ω × δθ, for small moves δπ.
    pub(crate) fn swept(
        &self,
        moment: &SceneMoment,
        one: &Minimal,
        moves: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let mut swept = DMatrix::zeros(1, moves.ncols());
        let MinimalCoordinate::Turn {
            first, axis, axes, ..
        } = one.source
        else {
            return swept;
        };
        let layout = moment.layout();
        let sign = match axes {
            AngularVelocity::Body => -1.0,
            AngularVelocity::World => 1.0,
        };
        let [j, k] = [(axis + 1) % 3, (axis + 2) % 3];
        let omega = |axis: usize| moment.state[layout.nq + first + axis];
        for (slot, column) in swept.iter_mut().zip(moves.column_iter()) {
            *slot = sign * (omega(j) * column[first + k] - omega(k) * column[first + j]);
        }
        swept
    }
}

/// A name of a scene's coordinate for a message, with the unit.
pub(crate) fn with_unit(name: &Name) -> String {
    match name.unit.is_empty() {
        true => name.name.clone(),
        false => format!("{} [{}]", name.name, name.unit),
    }
}

/// Name and unit of every number of the inputs.
pub(crate) fn input_names(scene: &Scene, layout: &mbd_scene::Layout) -> Vec<Name> {
    use mbd_scene::InputSource;
    let mut names = Vec::with_capacity(layout.ni);
    for slots in &layout.inputs {
        let owner = crate::columns::input_name(scene, layout, slots.at);
        let unit = match slots.source {
            InputSource::Input(index) => match scene.inputs.get(index) {
                Some(input) => input.unit.text.clone(),
                None => String::new(),
            },
            InputSource::Load(_) => "N".to_owned(),
            InputSource::BodyGravity(_) | InputSource::PointGravity(_) => "m/s^2".to_owned(),
        };
        for k in 0..slots.len {
            let axis = ["x", "y", "z"][k % 3];
            names.push(match (slots.len, k) {
                (1, _) => Name::new(&owner, "", &unit),
                (6, 0..3) => Name::new(&owner, &format!("force_{axis}"), "N"),
                (6, _) => Name::new(&owner, &format!("couple_{axis}"), "N*m"),
                _ => Name::new(&owner, axis, &unit),
            });
        }
    }
    names
}
