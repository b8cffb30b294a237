//! Ready scenes: each declared once with `model!`, one file a scene, and the one list of them.
//!
//! A scene's file holds its declaration and `run()`, the table `[run]` of how it is run, as a scene file would have it. `mbd list` shows the list.

use std::sync::Arc;

use mbd_runtime::scene::Scene;
use mbd_runtime::{Model, ParamError};

/// A ready scene.
#[derive(Clone, Copy, Debug)]
pub struct Ready {
    /// Its name for `mbd run`; its file here.
    pub name: &'static str,
    /// The declaration as data.
    pub scene: fn() -> Scene,
    /// How it is run: the table `[run]`.
    pub run: fn() -> String,
    /// The functions it was compiled with.
    pub emitted: fn() -> Vec<&'static str>,
    /// Its compiled model.
    pub model: Make,
}

/// A compiled model with params in declaration order [SI].
///
/// # Errors
/// Params that it cannot be run with.
pub type Make = fn(&[f64]) -> Result<Arc<dyn Model<f64>>, ParamError>;

/// A ready scene: its name, and where its model and `run()` are.
macro_rules! ready {
    ($name:expr, $($module:ident)::+, $model:ident, $params:ident) => {
        Ready {
            name: $name,
            scene: $($module)::+::$model::<f64>::scene,
            run: $($module)::+::run,
            emitted: || {
                let functions = $($module)::+::$model::<f64>::COST.0.iter();
                functions.map(|(name, _)| *name).collect()
            },
            model: |params| {
                let declared = $($module)::+::$params::default();
                $($module)::+::$model::new(declared)?.with_params(params)
            },
        }
    };
}

/// The one list: file, model and params of every scene, behind the scene of the main job.
macro_rules! scenes {
    ($($file:ident $model:ident $params:ident),* $(,)?) => {
        $(pub mod $file;)*

        /// The ready scenes.
        pub const READY: &[Ready] = &[
            ready!("parachute", crate::parachute::scene, ParachuteRate, ParachuteRateParams),
            $(ready!(stringify!($file), $file, $model, $params)),*
        ];
    };
}

scenes! {
    heavy_top HeavyTop HeavyTopParams,
    four_bar FourBar FourBarParams,
    slider_crank SliderCrank SliderCrankParams,
    n_four_bar NFourBar NFourBarParams,
    double_pendulum DoublePendulum DoublePendulumParams,
    spatial_loop SpatialLoop SpatialLoopParams,
    porch_swing PorchSwing PorchSwingParams,
    hinged_capsule HingedCapsule HingedCapsuleParams,
}
