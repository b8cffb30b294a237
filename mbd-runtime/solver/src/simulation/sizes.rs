//! What is small in a run, and what is stiff: the scales that errors, switches and rounding are measured against. They follow from the params as the
//! equations do: a run with other params measures by theirs, as one that was made with them.

use mbd_scene::Float;
use mbd_scene::laws::starts;

use super::{ModelRun, Pace};
use crate::event::{Acting, Passing};
use crate::integrate::{ErrorNorm, Resolution, Scales};
use crate::options::Options;
use crate::rounding::Rounding;
use crate::stiffness::Stiffness;
use crate::system::System;

/// The relative tolerance of switches at fixed steps.
const FIXED: f64 = 1e-10;

/// They of one model with its params.
#[derive(Debug)]
pub(super) struct RunSizes {
    scales: Scales,
    resolution: Resolution,
    /// What rounding of positions makes of forces.
    pub rounding: Rounding,
    /// The sum of the stiffnesses of all lines and springs between places [N/m].
    pub line_stiffness: f64,
    /// The relative tolerance of switches; one in metres or radians that the options give in its place; what no switch is finer than.
    tolerance: f64,
    given: Option<f64>,
    finest: f64,
}

impl RunSizes {
    /// They of the model that a system has.
    pub(super) fn of<T: Float>(system: &mut System<T>, options: &Options) -> Self {
        let model = system.model.clone();
        let scales = options.scales.unwrap_or_else(|| Scales::of(&*model));
        system.projection.length = scales.length;
        system.take_extent_of_tree();
        let stiffness = Stiffness::new(&*model, system.numbers().clone());
        let arm = system.projection.any().then(|| system.reach());
        let joined = (model.layout(), model.scene().joints.as_slice());
        RunSizes {
            scales,
            resolution: Resolution::new(model.layout(), &stiffness, scales),
            rounding: Rounding::new(joined, &stiffness, scales, arm),
            line_stiffness: stiffness.of_lines(),
            tolerance: options.method.tolerance().map_or(FIXED, |[rtol, _]| rtol),
            given: options.guard_tolerance,
            finest: 16.0 * T::EPSILON.to_f64() * scales.length,
        }
    }

    /// The length scale: how far what the origin follows may get from it, too [m].
    pub(super) fn length(&self) -> f64 {
        self.scales.length
    }

    /// What of the margin of an element counts as passed.
    pub(super) fn passing(&self, acting: &Acting) -> Passing {
        let by_itself = || self.tolerance * self.resolution.between(acting);
        Passing {
            floor: self.given.unwrap_or_else(by_itself).max(self.finest),
            lasting: match self.given {
                Some(_) => f64::INFINITY,
                None => self.tolerance * self.resolution.lasting(acting),
            },
        }
    }

    /// What errors of steps are measured by, to a relative tolerance.
    pub(super) fn error_norm<T: Float>(&self, system: &System<T>, rtol: f64) -> ErrorNorm {
        let model = &system.model;
        let starts = starts(model.scene(), model.params());
        let wide: Vec<f64> = starts.iter().map(|start| start.to_f64()).collect();
        let (length, measure) = (system.length(), (self.scales, rtol));
        ErrorNorm::new(model.layout(), length, measure, &wide, |part| {
            self.resolution.of(part)
        })
    }
}

impl<T: Float> ModelRun<T> {
    /// Measures by the params that the system has now.
    pub(super) fn take_sizes(&mut self) {
        self.sizes = RunSizes::of(&mut self.system, &self.options);
        let sizes = &self.sizes;
        self.margins
            .read_lines(&*self.system.model, |acting| sizes.passing(acting));
        if let Pace::Adaptive(_, norm) = &mut self.pace {
            *norm = sizes.error_norm(&self.system, norm.tolerance);
        }
    }
}
