//! A mechanism in both families of coordinates.

use mbd_scene::{Coordinates, Dual, Layout, Quantity, Scene, StartFrom, to_relative};

use crate::mechanism::evaluate;

/// A number and its rate.
type Rate = Dual<f64, 1>;

/// A scene in both families, and one state of it in both.
pub struct Both {
    /// In absolute coordinates.
    pub absolute: Scene,
    /// Its state.
    pub from: Vec<f64>,
    /// In relative coordinates.
    pub relative: Scene,
    /// How that is laid out.
    pub layout: Layout,
    /// Its state.
    pub state: Vec<f64>,
}

impl Both {
    /// A scene in absolute coordinates at a state that obeys its joints.
    #[must_use]
    pub fn new(scene: &Scene, state: &[f64]) -> Self {
        let relative = scene.in_coordinates(Coordinates::Relative);
        let layout = Layout::new(&relative);
        let absolute = crate::mechanism::layout(scene);
        let mut own = vec![0.0; layout.nx()];
        let params: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
        to_relative(
            (&relative, &layout),
            (&absolute, state),
            StartFrom::new(&params, 0.0),
            &mut own,
        );
        // What the state of the tree says, so that rounding of the given state is not compared.
        let mut from = state.to_vec();
        let bodies = evaluate(&relative, Quantity::Bodies, &own, &[], &[]);
        let directions = absolute.directions;
        let motions = bodies.chunks_exact(directions.motion());
        for ((_, slots), numbers) in absolute.own_bodies().zip(motions) {
            let (q, speeds) = numbers.split_at(directions.coordinates());
            from[slots.q..slots.q + q.len()].copy_from_slice(q);
            let v = absolute.nq + slots.v;
            from[v..v + speeds.len()].copy_from_slice(speeds);
        }
        let moved = from
            .iter()
            .zip(state)
            .take(absolute.nq)
            .map(|(a, b)| (a.abs() - b.abs()).abs());
        assert!(
            moved.fold(0.0, f64::max) < 1e-7,
            "the state does not obey the joints"
        );
        Both {
            absolute: scene.clone(),
            from,
            relative,
            layout,
            state: own,
        }
    }

    /// A quantity in relative coordinates.
    #[must_use]
    pub fn get(&self, what: Quantity, inputs: &[f64], rows: &[f64]) -> Vec<f64> {
        evaluate(&self.relative, what, &self.state, inputs, rows)
    }

    /// The states of all bodies in relative coordinates and their rates, in the order position, attitude, velocity, angular velocity.
    #[must_use]
    pub fn bodies_moving(&self, inputs: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let rates = self.get(Quantity::Derivative, inputs, &[]);
        let state: Vec<Rate> = self
            .state
            .iter()
            .zip(&rates)
            .map(|(&value, &rate)| Dual {
                value,
                slopes: [rate],
            })
            .collect();
        let inputs: Vec<Rate> = inputs.iter().map(|&x| Dual::constant(x)).collect();
        let moved = evaluate(&self.relative, Quantity::Bodies, &state, &inputs, &[]);
        moved.iter().map(|x| (x.value, x.slopes[0])).unzip()
    }

    /// The same quantity in absolute coordinates.
    #[must_use]
    pub fn want(&self, what: Quantity, inputs: &[f64]) -> Vec<f64> {
        evaluate(&self.absolute, what, &self.from, inputs, &[])
    }
}
