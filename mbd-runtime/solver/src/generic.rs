//! The generic solver: the laws run on numbers, no compilation. The baseline of the benchmark and the witness that generated code is right.

use std::sync::Arc;

use mbd_scene::laws::Numbers;
use mbd_scene::{At, Float, Layout, ParamError, Quantity, Scene, Scratch, Work, checked_numbers};

use crate::slopes::{Effective, Slopes};

/// A scene run by its laws.
#[derive(Clone, Debug)]
pub struct Generic<T: Float> {
    pub(crate) scene: Arc<Scene>,
    pub(crate) layout: Arc<Layout>,
    pub(crate) params: Vec<T>,
    pub(crate) numbers: Numbers<T>,
}

/// Scratch of a [`Generic`].
#[derive(Debug)]
struct Scratches<T: Float> {
    scratch: Scratch<T>,
    slopes: Option<Slopes>,
}

impl<T: Float> Generic<T> {
    /// What [`Generic::new`] does.
    pub(crate) fn make(scene: Scene, params: &[T]) -> Result<Self, ParamError> {
        let numbers = checked_numbers(&scene, params)?;
        Ok(Generic {
            layout: Arc::new(Layout::new(&scene)),
            numbers,
            params: params.to_vec(),
            scene: Arc::new(scene),
        })
    }

    /// The same scene with other parameters.
    pub(crate) fn change(&self, params: &[T]) -> Result<Self, ParamError> {
        Ok(Generic {
            numbers: checked_numbers(&self.scene, params)?,
            params: params.to_vec(),
            scene: self.scene.clone(),
            layout: self.layout.clone(),
        })
    }

    /// Fresh scratch; what [`Model::work`] does.
    pub(crate) fn scratch(&self) -> Work<T> {
        Work::of(Scratches {
            scratch: Scratch::<T>::new(&self.layout),
            slopes: None,
        })
    }

    /// Writes a quantity; what [`Model::evaluate`] does.
    pub(crate) fn run(&self, what: Quantity, at: &At<'_, T>, work: &mut Work<T>, out: &mut [T]) {
        let Some(work) = work.get::<Scratches<T>>() else {
            return;
        };
        match what {
            Quantity::Partial(of, by) => {
                let slopes = work
                    .slopes
                    .get_or_insert_with(|| Slopes::new(&self.scene, &self.layout, &self.params));
                let of = (of.quantity(), by);
                slopes.differentiate((&self.scene, &self.layout), of, Effective::Fixed, at, out);
            }
            _ => mbd_scene::evaluate(
                what,
                &self.scene,
                &self.layout,
                &self.numbers,
                at,
                &mut work.scratch,
                out,
            ),
        }
    }
}
