//! What is compiled once: the doors through which a user's crate enters the solvers of this one.
//!
//! A generic function is compiled again in every crate that calls it. What stands behind these doors is compiled here, for `f64` and `f32`,
//! so that a crate with a model compiles its equations and nothing else. A method that only reads a field needs no door.

use std::sync::Arc;

use mbd_scene::{At, Float, Model, ParamError, Quantity, Scene, Work};

use crate::__private::Lines;
use crate::error::RunError;
use crate::event::Happening;
use crate::generic::Generic;
use crate::linearise::{Linearisation, LinearisationError};
use crate::options::Options;
use crate::simulation::{Simulation, Snapshot, Stop};
use crate::system::External;
use crate::trajectory::Trajectory;

/// Declares every door once: the name that the public method calls, and the function behind it.
macro_rules! doors {
    ($(fn $name:ident($($argument:ident: $given:ty),*) -> $result:ty = $path:path;)*) => {
        /// A scalar that the solvers of this crate are compiled for: `f64` or `f32`.
        pub trait Scalar: Float {
            $(
                #[doc(hidden)]
                fn $name($($argument: $given),*) -> $result;
            )*
        }

        doors!(f64, $(fn $name($($argument: $given),*) -> $result = $path;)*);
        doors!(f32, $(fn $name($($argument: $given),*) -> $result = $path;)*);
    };
    ($scalar:ty, $(fn $name:ident($($argument:ident: $given:ty),*) -> $result:ty = $path:path;)*) => {
        impl Scalar for $scalar {
            $(
                #[inline(never)]
                fn $name($($argument: $given),*) -> $result {
                    $path($($argument),*)
                }
            )*
        }
    };
}

doors! {
    fn make_simulation(model: Arc<dyn Model<Self>>, options: Options, loads: Box<dyn External<Self> + Send>) -> Result<Simulation<Self>, RunError> = Simulation::make;
    fn drive(run: &mut Simulation<Self>, until: f64, trajectory: Option<&mut Trajectory>, go_on: &mut dyn FnMut(f64) -> bool) -> Result<Stop, RunError> = Simulation::drive;
    fn take_step(run: &mut Simulation<Self>) -> Result<(), RunError> = Simulation::take_step;
    fn begin(run: &mut Simulation<Self>) -> Result<(), RunError> = Simulation::begin;
    fn look(run: &mut Simulation<Self>, what: Quantity, out: &mut [Self]) -> Result<(), RunError> = Simulation::look;
    fn give_state(run: &mut Simulation<Self>, time: f64, state: &[Self]) -> Result<(), RunError> = Simulation::give_state;
    fn give_nodes(run: &mut Simulation<Self>, guess: &[Self]) -> Result<(), RunError> = Simulation::give_nodes;
    fn give_params(run: &mut Simulation<Self>, params: &[Self]) -> Result<(), ParamError> = Simulation::give_params;
    fn continue_from(run: &mut Simulation<Self>, snapshot: &Snapshot<Self>) -> Result<(), RunError> = Simulation::continue_from;
    fn save(run: &Simulation<Self>) -> Snapshot<Self> = Simulation::save;
    fn name_event(run: &Simulation<Self>, what: Happening) -> String = Simulation::name_event;
    fn make_generic(scene: Scene, params: &[Self]) -> Result<Generic<Self>, ParamError> = Generic::make;
    fn change_generic(model: &Generic<Self>, params: &[Self]) -> Result<Generic<Self>, ParamError> = Generic::change;
    fn make_work(model: &Generic<Self>) -> Work<Self> = Generic::scratch;
    fn run_laws(model: &Generic<Self>, what: Quantity, at: &At<'_, Self>, work: &mut Work<Self>, out: &mut [Self]) -> () = Generic::run;
    fn linearise(total: &mut Linearisation<Self>, model: &dyn Model<Self>, at: &At<'_, Self>, work: &mut Work<Self>) -> Result<(), LinearisationError> = Linearisation::run;
    fn prepare(scene: &Scene, params: &[Self]) -> Result<Lines<Self>, ParamError> = crate::__private::prepare;
}
