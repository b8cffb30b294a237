//! Stops that a run starts beyond: they push from the first instant on, as hard as what was asked for is off.

use mbd_scene::{Float, Quantity, StopSlots};

use super::ModelRun;
use crate::error::StepError;
use crate::unilateral::{Mode, name};

/// A stop that the start of a run has passed.
#[derive(Clone, Debug, PartialEq)]
pub struct PassedStop {
    /// Its name, as events tell it: `elbow.angle high stop`.
    pub name: String,
    /// Whether it stops an angle.
    pub is_angle: bool,
    /// How far the coordinate is beyond it [m or rad].
    pub depth: f64,
    /// The force or torque with which it pushes back [N or N m].
    pub push: f64,
    /// How far apart the stops of the coordinate are [m or rad]; `None` where it has one.
    pub travel: Option<f64>,
}

impl<T: Float> ModelRun<T> {
    /// Looks which stops the start is beyond.
    pub(super) fn find_passed_stops(&mut self) -> Result<(), StepError> {
        self.passed_stops.clear();
        let model = self.system.model.clone();
        let (scene, layout) = (model.scene(), model.layout());
        if layout.stops.is_empty() {
            return Ok(());
        }
        let mut guards = vec![T::zero(); layout.len(Quantity::Guards)];
        let state = self.state.clone();
        self.system.look(self.time, 0.0, &state)?;
        self.system
            .seen(Quantity::Guards, self.time, &state, &mut guards);
        let depth = |stop: usize| {
            let element = layout.lines.len() + stop;
            let own = guards.get(2 * element..2 * element + 2);
            own.map_or([0.0; 2], |own| [own[0].to_f64(), own[1].to_f64()])
        };
        for (stop, slots) in layout.stops.iter().enumerate() {
            let [beyond, push] = depth(stop);
            let mode = self.system.modes().get(layout.lines.len() + stop);
            if beyond > 0.0 && mode != Some(&Mode::Detached) {
                let own = |(_, other): &(usize, &StopSlots)| {
                    (other.joint, other.coordinate) == (slots.joint, slots.coordinate)
                };
                let both = layout.stops.iter().enumerate().filter(own);
                // Together they are as far beyond as their distance is negative.
                let depths: Vec<f64> = both.map(|(stop, _)| depth(stop)[0]).collect();
                self.passed_stops.push(PassedStop {
                    name: name(scene, layout, layout.lines.len() + stop),
                    is_angle: (scene.coordinate(slots.joint, slots.coordinate))
                        .is_some_and(|(_, coordinate)| coordinate.is_angle()),
                    depth: beyond,
                    push,
                    travel: match depths.as_slice() {
                        [a, b] => Some(-(a + b)),
                        _ => None,
                    },
                });
            }
        }
        Ok(())
    }
}
