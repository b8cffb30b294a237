//! A mechanism as a function of minimal coordinates, their rates, its own states and inputs: the joints are closed step by step, no
//! derivative of the library is used but Φ_v.
//!
//! ```text
//! s = [ξ | η | z], u  ↦  x = [q | v | z]:   Φ(q, z, u) = 0,  ξ(q) given,   Φ̇(q, v, z, u) = 0,  η(q, v) given                      (1)
//!                     ↦  [ξ̇ | η̇ | ż], o                                                                                         (2)
//! ```
//!
//! Where the coordinates stand among joints and speeds is read from their names.

use dense::pseudo_inverse;
use mbd_scene::{AngularVelocity, Coordinates, Layout, Quantity, Scene};
use nalgebra::{DMatrix, DVector, Vector3};
use std::rc::Rc;

use crate::mechanism::evaluate;
use crate::oracle::Oracle;

/// What a minimal coordinate is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinate {
    /// A coordinate of a joint, by its number among all.
    Joint(usize),
    /// A position whose rate is this speed.
    Place(usize),
    /// A small turn: the first speed of the angular velocity, which of the three it is, and the axes of both.
    Turn(usize, usize, AngularVelocity),
}

/// A mechanism about one state, its coordinates by name.
pub struct Minimal<'s> {
    scene: &'s Scene,
    layout: Rc<Layout>,
    coordinates: Vec<Coordinate>,
    /// The state about which it moves.
    state: Vec<f64>,
    /// The inputs there.
    inputs: Vec<f64>,
    /// ∂q̇/∂v there.
    turns: DMatrix<f64>,
    /// Its pseudoinverse.
    moves: DMatrix<f64>,
    /// That of the rows of Φ_v and of η by the speeds there.
    rows: DMatrix<f64>,
}

/// A unit of one number of s, or of u behind them.
pub struct Direction {
    number: usize,
    /// What it is in x.
    state: Vec<f64>,
    /// What it is in u.
    inputs: Vec<f64>,
}

/// Steps at most with the rows of the state about which it moves, each of which leaves a part of the change; what is left of closed rows.
const STEPS: usize = 8;
const CLOSED: f64 = 1e-15;

fn accelerations<S: mbd_scene::Real>(scene: &Scene, state: &[S], inputs: &[S]) -> [Vec<S>; 3] {
    let rates = evaluate(scene, Quantity::Derivative, state, inputs, &[]);
    let layout = crate::mechanism::layout(scene);
    let speeds = &rates[layout.nq..layout.nq + layout.nv];
    let measured = evaluate(scene, Quantity::JointCoordinates, state, inputs, speeds);
    let outputs = match layout.len(Quantity::Outputs) {
        0 => Vec::new(),
        _ => evaluate(scene, Quantity::Outputs, state, inputs, &[]),
    };
    [rates, measured, outputs]
}

/// Numbers and their slopes by the one variable.
fn dual(values: &[f64], slopes: &[f64]) -> Vec<Oracle> {
    let both = values.iter().zip(slopes);
    both.map(|(value, slope)| {
        Oracle::constant(*value) + Oracle::variable(0.0) * Oracle::constant(*slope)
    })
    .collect()
}

impl<'s> Minimal<'s> {
    /// A mechanism at a state that obeys its joints, in the coordinates of these names.
    ///
    /// # Panics
    /// If a name is none of a joint, a body or a point.
    #[must_use]
    pub fn new(scene: &'s Scene, names: &[&str], state: &[f64], inputs: &[f64]) -> Self {
        let layout = crate::mechanism::layout(scene);
        let joints = scene.joint_coordinates();
        let find = |name: &str| {
            if let Some(at) = joints.iter().position(|known| known == name) {
                return Coordinate::Joint(at / 2);
            }
            let (owner, word) = name.rsplit_once('.').expect("of a body or a point");
            let axis = "xyz".find(&word[word.len() - 1..]).expect("an axis");
            let joint = layout.joint_links();
            let mut joint = joint.filter(|(joint, _)| scene.joints[*joint].name == owner);
            if let Some((_, link)) = joint.next() {
                // What a joint carries turns in its own axes.
                let first = link.slots.v + link.speeds - 3;
                return Coordinate::Turn(first, axis, AngularVelocity::Body);
            }
            let body = scene.bodies.iter().position(|body| body.name == owner);
            let point = scene.points.iter().position(|point| point.name == owner);
            let first = match (body, point) {
                (Some(body), _) => layout.bodies[body].expect("a body that moves").v,
                (_, Some(point)) => match layout.points[point] {
                    mbd_scene::PointSlots::Mass(slots) => slots.v,
                    mbd_scene::PointSlots::Node(_) => panic!("{name} has no speeds"),
                },
                _ => panic!("{name} is nothing of the scene"),
            };
            match word.starts_with("turn") {
                true => Coordinate::Turn(first + 3, axis, scene.angular_velocity),
                false => Coordinate::Place(first + axis),
            }
        };
        let none = DMatrix::zeros(0, 0);
        let mut own = Minimal {
            coordinates: names.iter().map(|name| find(name)).collect(),
            scene,
            state: state.to_vec(),
            inputs: inputs.to_vec(),
            turns: DMatrix::zeros(layout.nq, layout.nv),
            moves: none.clone(),
            rows: none,
            layout,
        };
        own.prepare();
        own
    }

    /// What stands still: the state about which it moves.
    fn prepare(&mut self) {
        let (nq, nv) = (self.layout.nq, self.layout.nv);
        let mut unit = vec![0.0; nv];
        for column in 0..nv {
            unit[column] = 1.0;
            let state = self.with_speeds(&self.state, &unit);
            unit[column] = 0.0;
            let rates = evaluate(self.scene, Quantity::Derivative, &state, &self.inputs, &[]);
            self.turns.column_mut(column).copy_from_slice(&rates[..nq]);
        }
        self.moves = pseudo_inverse(self.turns.clone());
        self.rows = pseudo_inverse(self.rows_there());
    }

    /// Moves or speeds by least squares of the rows.
    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        &self.rows * right
    }

    /// How many coordinates there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.coordinates.len()
    }

    /// Whether nothing can move.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// How many numbers s has.
    fn numbers(&self) -> usize {
        2 * self.len() + self.rest()
    }

    /// How many numbers stand behind the speeds.
    fn rest(&self) -> usize {
        self.layout.nx() - self.layout.nq - self.layout.nv
    }

    /// A state with other speeds.
    fn with_speeds(&self, state: &[f64], speeds: &[f64]) -> Vec<f64> {
        let mut state = state.to_vec();
        state[self.layout.nq..self.layout.nq + self.layout.nv].copy_from_slice(speeds);
        state
    }

    /// η at a state.
    fn rates(&self, state: &[f64], inputs: &[f64]) -> Vec<f64> {
        let measured = evaluate(self.scene, Quantity::JointCoordinates, state, inputs, &[]);
        let of = |one: &Coordinate| match *one {
            Coordinate::Joint(number) => measured[3 * number + 1],
            Coordinate::Place(speed) => state[self.layout.nq + speed],
            Coordinate::Turn(first, axis, _) => state[self.layout.nq + first + axis],
        };
        self.coordinates.iter().map(of).collect()
    }

    /// The rows of Φ_v, then those of η by the speeds.
    fn rows_there(&self) -> DMatrix<f64> {
        let (state, inputs) = (&self.state[..], &self.inputs[..]);
        let (nv, nc) = (self.layout.nv, self.layout.nc);
        let joints = match nc {
            0 => Vec::new(),
            _ => evaluate(self.scene, Quantity::ConstraintJacobian, state, inputs, &[]),
        };
        let mut rows = DMatrix::zeros(nc + self.len(), nv);
        rows.rows_mut(0, nc)
            .copy_from(&DMatrix::from_row_slice(nc, nv, &joints));
        let mut unit = vec![0.0; nv];
        let none = self.rates(&self.with_speeds(state, &unit), inputs);
        for column in 0..nv {
            unit[column] = 1.0;
            let own = self.rates(&self.with_speeds(state, &unit), inputs);
            unit[column] = 0.0;
            for (row, (own, none)) in own.iter().zip(&none).enumerate() {
                rows[(nc + row, column)] = own - none;
            }
        }
        rows
    }

    fn constraint(&self, what: Quantity, state: &[f64], inputs: &[f64]) -> Vec<f64> {
        match self.layout.nc {
            0 => Vec::new(),
            _ => evaluate(self.scene, what, state, inputs, &[]),
        }
    }

    /// A unit of a number of s, or of u behind them, as a change of x and u along the joints: dual numbers through Φ̇ and η.
    #[must_use]
    pub fn direction(&self, number: usize) -> Direction {
        let (nq, nv, nc, n) = (self.layout.nq, self.layout.nv, self.layout.nc, self.len());
        let mut state = vec![0.0; self.layout.nx()];
        let mut inputs = vec![0.0; self.layout.ni];
        if let Some(input) = number.checked_sub(self.numbers()) {
            inputs[input] = 1.0;
        } else if let Some(own) = number.checked_sub(2 * n) {
            state[nq + nv + own] = 1.0;
        }
        let slopes = |what: Quantity, state: &[f64], inputs: &[f64]| -> Vec<f64> {
            if nc == 0 {
                return Vec::new();
            }
            let (state, inputs) = (dual(&self.state, state), dual(&self.inputs, inputs));
            let all = evaluate(self.scene, what, &state, &inputs, &[]);
            all.iter().map(|x| x.0.eps).collect()
        };
        let mut right = DVector::zeros(nc + n);
        let held = slopes(Quantity::Constraint, &state, &inputs);
        (0..nc).for_each(|row| right[row] = -held[row]);
        if number < n {
            right[nc + number] = 1.0;
        }
        let moved = &self.turns * self.solve(&right);
        state[..nq].copy_from_slice(moved.as_slice());
        let mut right = DVector::zeros(nc + n);
        let held = slopes(Quantity::ConstraintRate, &state, &inputs);
        (0..nc).for_each(|row| right[row] = -held[row]);
        let (seeds, given) = (dual(&self.state, &state), dual(&self.inputs, &inputs));
        let measured = evaluate(self.scene, Quantity::JointCoordinates, &seeds, &given, &[]);
        for (row, one) in self.coordinates.iter().enumerate() {
            if let Coordinate::Joint(number) = *one {
                right[nc + row] = -measured[3 * number + 1].0.eps;
            }
        }
        if let Some(rate) = number.checked_sub(n).filter(|&rate| rate < n) {
            right[nc + rate] += 1.0;
        }
        state[nq..nq + nv].copy_from_slice(self.solve(&right).as_slice());
        Direction {
            number,
            state,
            inputs,
        }
    }

    /// x(s, u) with one number of s, or of u behind them, changed by `by`, and u: the joints closed, the other numbers as they are.
    #[must_use]
    pub fn at(&self, along: &Direction, by: f64) -> (Vec<f64>, Vec<f64>) {
        let (nq, nv, nc, n) = (self.layout.nq, self.layout.nv, self.layout.nc, self.len());
        let number = along.number;
        let moved = |list: &[f64], by_one: &[f64]| -> Vec<f64> {
            list.iter().zip(by_one).map(|(a, b)| a + by * b).collect()
        };
        let inputs = moved(&self.inputs, &along.inputs);
        let mut state = moved(&self.state, &along.state);
        self.normalise(&mut state);
        let start = self.rates(&self.state, &self.inputs);
        let before = evaluate(
            self.scene,
            Quantity::JointCoordinates,
            &self.state,
            &self.inputs,
            &[],
        );
        let added = |row: usize| if row == number { by } else { 0.0 };
        for _ in 0..STEPS {
            let mut right = DVector::zeros(nc + n);
            let open = self.constraint(Quantity::Constraint, &state, &inputs);
            (0..nc).for_each(|row| right[row] = -open[row]);
            let now = evaluate(self.scene, Quantity::JointCoordinates, &state, &inputs, &[]);
            for (row, one) in self.coordinates.iter().enumerate() {
                if let Coordinate::Joint(own) = *one {
                    let missing = before[3 * own] + added(row) - now[3 * own];
                    // Angles beside half a turn.
                    right[nc + row] =
                        match self.scene.joint_coordinates()[2 * own].contains("angle") {
                            true => missing.sin(),
                            false => missing,
                        };
                }
            }
            if right.amax() < CLOSED {
                break;
            }
            let moved = &self.turns * self.solve(&right);
            (0..nq).for_each(|k| state[k] += moved[k]);
            self.normalise(&mut state);
        }
        for _ in 0..STEPS {
            let mut right = DVector::zeros(nc + n);
            let open = self.constraint(Quantity::ConstraintRate, &state, &inputs);
            (0..nc).for_each(|row| right[row] = -open[row]);
            let now = self.rates(&state, &inputs);
            (0..n).for_each(|row| right[nc + row] = start[row] + added(n + row) - now[row]);
            if right.amax() < CLOSED {
                break;
            }
            let change = self.solve(&right);
            (0..nv).for_each(|k| state[nq + k] += change[k]);
        }
        (state, inputs)
    }

    fn normalise(&self, state: &mut [f64]) {
        for at in self.layout.quaternions() {
            let length = state[at..at + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
            state[at..at + 4].iter_mut().for_each(|x| *x /= length);
        }
    }

    /// η̇ and ż, then the outputs.
    fn picked<S: mbd_scene::Real>(&self, state: &[S], inputs: &[S]) -> Vec<S> {
        let [rates, measured, outputs] = accelerations(self.scene, state, inputs);
        let nq = self.layout.nq;
        let of = |one: &Coordinate| match *one {
            Coordinate::Joint(number) => measured[3 * number + 2],
            Coordinate::Place(speed) => rates[nq + speed],
            Coordinate::Turn(first, axis, _) => rates[nq + first + axis],
        };
        let mut all: Vec<S> = self.coordinates.iter().map(of).collect();
        all.extend_from_slice(&rates[nq + self.layout.nv..]);
        all.extend_from_slice(&outputs);
        all
    }

    /// η̇ and ż, then the outputs, after a change by [`Minimal::at`].
    #[must_use]
    pub fn value(&self, along: &Direction, by: f64) -> Vec<f64> {
        let (state, inputs) = self.at(along, by);
        self.picked(&state, &inputs)
    }

    /// The derivative of η̇ and ż, then the outputs, by a number of s or of u: dual numbers through the whole elimination.
    #[must_use]
    pub fn slope(&self, along: &Direction) -> Vec<f64> {
        let state = dual(&self.state, &along.state);
        let inputs = dual(&self.inputs, &along.inputs);
        let all = self.picked(&state, &inputs);
        all.iter().map(|x| x.0.eps).collect()
    }

    /// The derivative of ξ̇ by the same: η, and of a turn δθ̇ = δω − ω × δθ (body axes), δω + ω × δθ (world axes).
    #[must_use]
    pub fn swept(&self, along: &Direction) -> Vec<f64> {
        let nq = self.layout.nq;
        let moves = self.moves(&along.state);
        let of = |(row, one): (usize, &Coordinate)| {
            let own = f64::from(u8::from(along.number == self.len() + row));
            let Coordinate::Turn(first, axis, axes) = *one else {
                return own;
            };
            let three = |list: &[f64], at: usize| Vector3::from_column_slice(&list[at..at + 3]);
            let (omega, turn) = (three(&self.state, nq + first), three(&moves, first));
            let side = match axes {
                AngularVelocity::Body => -1.0,
                AngularVelocity::World => 1.0,
            };
            own + side * omega.cross(&turn)[axis]
        };
        self.coordinates.iter().enumerate().map(of).collect()
    }

    /// The moves behind a change of q, by least squares.
    fn moves(&self, along: &[f64]) -> Vec<f64> {
        let change = DVector::from_column_slice(&along[..self.layout.nq]);
        (&self.moves * change).as_slice().to_vec()
    }
}

/// The same scene in one of the families, at the same motion.
#[must_use]
pub fn in_family(scene: &Scene, state: &[f64], family: Coordinates) -> (Scene, Vec<f64>) {
    match family {
        Coordinates::Relative => {
            let both = crate::relative::Both::new(scene, state);
            (both.relative, both.state)
        }
        _ => (scene.clone(), state.to_vec()),
    }
}
