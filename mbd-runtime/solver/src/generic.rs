//! The generic solver: the laws run on numbers, no compilation. The baseline of the benchmark and the witness that generated code is right.
//!
//! The laws run in `f64` whatever the scalar: a witness has more digits than what it is compared with, and they are compiled once.

use std::sync::Arc;

#[cfg(feature = "f32")]
use mbd_scene::Arguments;
use mbd_scene::laws::{LineNumbers, Numbers};
use mbd_scene::{
    At, Float, Layout, ParamError, Quantity, Scene, Scratch, Work, check_tables, checked_numbers,
    double,
};

use crate::laws::params_of;
use crate::slopes::{Effective, Slopes};

/// A scene run by its laws, in `f64` whatever `T`: of an `f32` model arguments are widened and results are rounded.
#[derive(Clone, Debug)]
pub struct Generic<T: Float> {
    pub(crate) scene: Arc<Scene>,
    pub(crate) layout: Arc<Layout>,
    pub(crate) params: Vec<T>,
    pub(crate) numbers: Numbers<f64>,
    pub(crate) lines: Vec<LineNumbers<T>>,
}

/// Room of the laws.
#[derive(Debug)]
struct LawRoom {
    scratch: Scratch<f64>,
    slopes: Option<Slopes>,
}

impl LawRoom {
    fn new(layout: &Layout) -> Self {
        LawRoom {
            scratch: double::scratch(layout),
            slopes: None,
        }
    }
}

impl<T: Float> Generic<T> {
    /// What [`Generic::new`] does.
    pub(crate) fn make(scene: Scene, params: &[T]) -> Result<Self, ParamError> {
        check_tables(&scene)?;
        let layout = Arc::new(Layout::new(&scene));
        Self::with(Arc::new(scene), layout, params)
    }

    /// The same scene with other parameters.
    pub(crate) fn change(&self, params: &[T]) -> Result<Self, ParamError> {
        Self::with(self.scene.clone(), self.layout.clone(), params)
    }

    fn with(scene: Arc<Scene>, layout: Arc<Layout>, params: &[T]) -> Result<Self, ParamError> {
        let lines = checked_numbers(&scene, params)?.lines;
        Ok(Generic {
            numbers: double::numbers(&scene, &params_of(params)),
            params: params.to_vec(),
            lines,
            layout,
            scene,
        })
    }

    /// Writes a quantity.
    fn write(&self, what: Quantity, at: &At<'_, f64>, room: &mut LawRoom, out: &mut [f64]) {
        let (scene, layout) = (&*self.scene, &*self.layout);
        match what {
            Quantity::Partial(of, by) => {
                // Scratch outlives the params that an event or a program changes.
                room.slopes = room
                    .slopes
                    .take()
                    .filter(|slopes| slopes.are_at(&self.params));
                let new = || Slopes::new(scene, layout, &self.params);
                let slopes = room.slopes.get_or_insert_with(new);
                let of = (of.quantity(), by);
                slopes.differentiate((scene, layout), of, Effective::Fixed, at, out);
            }
            _ => double::evaluate(
                what,
                scene,
                layout,
                &self.numbers,
                at,
                &mut room.scratch,
                out,
            ),
        }
    }
}

impl Generic<f64> {
    /// Fresh scratch; what [`Model::work`](crate::Model::work) does.
    pub(crate) fn scratch(&self) -> Work<f64> {
        Work::of(LawRoom::new(&self.layout))
    }

    /// Writes a quantity; what [`Model::evaluate`](crate::Model::evaluate) does.
    pub(crate) fn run(
        &self,
        what: Quantity,
        at: &At<'_, f64>,
        work: &mut Work<f64>,
        out: &mut [f64],
    ) {
        if let Some(room) = work.get::<LawRoom>() {
            self.write(what, at, room, out);
        }
    }
}

/// Room of the laws, and arguments and results in `f64`.
#[cfg(feature = "f32")]
#[derive(Debug)]
struct DoubleRoom {
    laws: LawRoom,
    arguments: Arguments<f64>,
    out: Vec<f64>,
}

#[cfg(feature = "f32")]
impl Generic<f32> {
    /// Fresh scratch; what [`Model::work`](crate::Model::work) does.
    pub(crate) fn scratch(&self) -> Work<f32> {
        Work::of(DoubleRoom {
            laws: LawRoom::new(&self.layout),
            arguments: Arguments::default(),
            out: Vec::new(),
        })
    }

    /// Writes a quantity; what [`Model::evaluate`](crate::Model::evaluate) does. Entries of `out` that the laws leave stay as they are.
    pub(crate) fn run(
        &self,
        what: Quantity,
        at: &At<'_, f32>,
        work: &mut Work<f32>,
        out: &mut [f32],
    ) {
        let Some(room) = work.get::<DoubleRoom>() else {
            return;
        };
        room.arguments.read(at, f64::from);
        room.out.clear();
        room.out.extend(out.iter().map(|&x| f64::from(x)));
        self.write(what, &room.arguments.at(), &mut room.laws, &mut room.out);
        for (to, from) in out.iter_mut().zip(&room.out) {
            *to = *from as f32;
        }
    }
}
