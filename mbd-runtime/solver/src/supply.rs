//! What the caller of a run supplies: inputs, external loads and external gravity, held, as functions of time and state, or by controllers at
//! samples.
//!
//! The numbers of a stage are those that are held ([`Simulation::set_inputs`](crate::Simulation::set_inputs), controllers at samples), changed by
//! every function of time and state in the order in which they were given.

use std::cell::RefCell;
use std::marker::PhantomData;

use mbd_scene::{At, Float, Layout, Model, ParamError, Quantity, Scene, Work};

use crate::columns::input_name;
use crate::error::{Source, StepError};
use crate::list::all_finite;
use crate::system::External;

/// Every number that the caller of a model supplies: inputs, external loads and external gravity.
///
/// A model `Cart` with inputs comes with `CartInputs`, which has a field for each of them. Scenes that are not compiled take their numbers in the
/// order of [`Layout::inputs`]: `Vec<T>` or `[T; N]`.
pub trait Inputs<T>: Sized {
    /// The model that they belong to, and how long its state and its list of inputs are; `None` where that is not known.
    const MODEL: Option<(&'static str, [usize; 2])>;
    /// The state of the model, typed.
    type State;
    /// Its joint coordinates and their rates, typed.
    type Coordinates;
    /// Its outputs, typed.
    type Outputs;

    /// They from their numbers; `None` for a list of another length.
    fn from_numbers(numbers: &[T]) -> Option<Self>;

    /// Their numbers.
    fn numbers(&self) -> impl AsRef<[T]>;

    /// A state from its numbers [q | v | z].
    fn state(numbers: &[T]) -> Self::State;

    /// Joint coordinates and their rates from their numbers, in the order of [`Quantity::Coordinates`].
    fn coordinates(numbers: &[T]) -> Self::Coordinates;

    /// Outputs from their columns, in the order of [`Quantity::Outputs`].
    fn outputs(columns: &[T]) -> Self::Outputs;
}

impl<T: Copy> Inputs<T> for Vec<T> {
    const MODEL: Option<(&'static str, [usize; 2])> = None;
    type State = Vec<T>;
    type Coordinates = Vec<T>;
    type Outputs = Vec<T>;

    fn from_numbers(numbers: &[T]) -> Option<Self> {
        Some(numbers.to_vec())
    }

    fn numbers(&self) -> impl AsRef<[T]> {
        self.as_slice()
    }

    fn state(numbers: &[T]) -> Vec<T> {
        numbers.to_vec()
    }

    fn coordinates(numbers: &[T]) -> Vec<T> {
        numbers.to_vec()
    }

    fn outputs(columns: &[T]) -> Vec<T> {
        columns.to_vec()
    }
}

impl<T: Copy, const N: usize> Inputs<T> for [T; N] {
    const MODEL: Option<(&'static str, [usize; 2])> = None;
    type State = Vec<T>;
    type Coordinates = Vec<T>;
    type Outputs = Vec<T>;

    fn from_numbers(numbers: &[T]) -> Option<Self> {
        numbers.try_into().ok()
    }

    fn numbers(&self) -> impl AsRef<[T]> {
        self.as_slice()
    }

    fn state(numbers: &[T]) -> Vec<T> {
        numbers.to_vec()
    }

    fn coordinates(numbers: &[T]) -> Vec<T> {
        numbers.to_vec()
    }

    fn outputs(columns: &[T]) -> Vec<T> {
        columns.to_vec()
    }
}

/// Numbers for the inputs of a model: typed [`Inputs`], or a list of them in the order of [`Layout::inputs`].
pub trait InputNumbers<T> {
    /// The model that they belong to, as [`Inputs::MODEL`].
    const MODEL: Option<(&'static str, [usize; 2])>;

    /// The numbers.
    fn list(&self) -> impl AsRef<[T]>;
}

impl<T, I: Inputs<T>> InputNumbers<T> for I {
    const MODEL: Option<(&'static str, [usize; 2])> = I::MODEL;

    fn list(&self) -> impl AsRef<[T]> {
        self.numbers()
    }
}

impl<T> InputNumbers<T> for [T] {
    const MODEL: Option<(&'static str, [usize; 2])> = None;

    fn list(&self) -> impl AsRef<[T]> {
        self
    }
}

/// Values for the params of a model: the struct that comes with it, `CartParams`, or a list of them in the order of the declaration [SI].
pub trait Params<T> {
    /// The model that they belong to; `None` where that is not known.
    const MODEL: Option<&'static str>;

    /// Their values in the order of the declaration.
    fn values(&self) -> impl AsRef<[T]>;

    /// An error where they are known to be those of another model.
    ///
    /// # Errors
    /// [`ParamError::OtherModel`].
    fn check_model(scene: &Scene) -> Result<(), ParamError> {
        match Self::MODEL {
            Some(given) if given != scene.name => Err(ParamError::OtherModel {
                model: scene.name.clone(),
                given: given.to_owned(),
            }),
            _ => Ok(()),
        }
    }
}

impl<T> Params<T> for [T] {
    const MODEL: Option<&'static str> = None;

    fn values(&self) -> impl AsRef<[T]> {
        self
    }
}

impl<T> Params<T> for Vec<T> {
    const MODEL: Option<&'static str> = None;

    fn values(&self) -> impl AsRef<[T]> {
        self.as_slice()
    }
}

impl<T, const N: usize> Params<T> for [T; N] {
    const MODEL: Option<&'static str> = None;

    fn values(&self) -> impl AsRef<[T]> {
        self.as_slice()
    }
}

impl<T, P: Params<T> + ?Sized> Params<T> for &P {
    const MODEL: Option<&'static str> = P::MODEL;

    fn values(&self) -> impl AsRef<[T]> {
        (**self).values()
    }
}

/// When and where inputs are asked for, in numbers.
pub struct Moment<'a, T: Float> {
    /// Time [s].
    pub(crate) time: f64,
    /// State x = [q | v | z].
    pub(crate) state: &'a [T],
    pub(crate) gauge: RefCell<Gauge<'a, T>>,
}

/// What measures joint coordinates and outputs, when somebody asks for them.
pub(crate) struct Gauge<'a, T: Float> {
    pub model: &'a dyn Model<T>,
    pub at: At<'a, T>,
    /// The state in the world.
    pub state: &'a [T],
    pub work: &'a mut Work<T>,
    /// Room for the numbers of either.
    pub room: &'a mut [T],
    /// Whether inputs and nodes at this state are known, on which outputs depend.
    pub settled: bool,
}

impl<'a, T: Float> Moment<'a, T> {
    /// A time [s] and a state, with what measures there; `settled`: inputs and nodes of `at` are those of this state.
    #[inline]
    pub(crate) fn new(
        (time, state): (f64, &'a [T]),
        (model, at): (&'a dyn Model<T>, At<'a, T>),
        (work, room): (&'a mut Work<T>, &'a mut [T]),
        settled: bool,
    ) -> Self {
        Moment {
            time,
            state,
            gauge: RefCell::new(Gauge {
                model,
                at,
                state,
                work,
                room,
                settled,
            }),
        }
    }
}

/// Measures where a sample is taken.
trait SampleMeasure<T> {
    /// Hands the numbers of a quantity to `read`; of outputs only where inputs and nodes are known.
    fn measure(&self, what: Quantity, read: &mut dyn FnMut(&[T]));

    /// The centre of mass of a body, world axes [m].
    fn position(&self, body: &str) -> Option<[T; 3]>;
}

impl<T: Float> SampleMeasure<T> for RefCell<Gauge<'_, T>> {
    fn measure(&self, what: Quantity, read: &mut dyn FnMut(&[T])) {
        if let Ok(mut gauge) = self.try_borrow_mut() {
            let Gauge {
                model,
                at,
                work,
                room,
                settled,
                ..
            } = &mut *gauge;
            let Some(room) = room.get_mut(..model.layout().len(what)) else {
                return;
            };
            if *settled || what == Quantity::Coordinates {
                model.evaluate(what, at, work, room);
                read(room);
            }
        }
    }

    fn position(&self, body: &str) -> Option<[T; 3]> {
        let mut gauge = self.try_borrow_mut().ok()?;
        let Gauge {
            model,
            at,
            state,
            work,
            room,
            ..
        } = &mut *gauge;
        let (layout, directions) = (model.layout(), model.layout().directions);
        let mut bodies = model.scene().bodies.iter();
        let index = bodies.position(|known| known.name == body)?;
        let position = match layout.bodies.get(index)? {
            Some(slots) => directions.linear(state, slots.q),
            None => {
                let room = room.get_mut(..layout.len(Quantity::Bodies))?;
                model.evaluate(Quantity::Bodies, at, work, room);
                directions.linear(room, directions.motion() * index)
            }
        };
        Some(position.into())
    }
}

/// A function of time and state that changes numbers of inputs.
pub(crate) type Law<T> = Box<dyn FnMut(&Moment<'_, T>, &mut [T]) + Send>;

/// What a controller sees: a time, and the state there.
///
/// `I` are the inputs of the model, `CartInputs`; the sample of a model `Cart` has the name `CartSample`.
pub struct Sample<'a, I, T: Float = f64> {
    /// Time [s].
    pub time: f64,
    state: &'a [T],
    gauge: &'a dyn SampleMeasure<T>,
    of: PhantomData<fn() -> I>,
}

impl<'a, I: Inputs<T>, T: Float> Sample<'a, I, T> {
    fn new(moment: &'a Moment<'_, T>) -> Self {
        Sample {
            time: moment.time,
            state: moment.state,
            gauge: &moment.gauge,
            of: PhantomData,
        }
    }

    /// The state, typed.
    #[must_use]
    pub fn state(&self) -> I::State {
        I::state(self.state)
    }

    /// The joint coordinates and their rates, as the joints measure them: `sample.coordinates().pin_angle`. Computed when asked for.
    #[must_use]
    pub fn coordinates(&self) -> I::Coordinates {
        let mut found = None;
        self.gauge.measure(Quantity::Coordinates, &mut |numbers| {
            found = Some(I::coordinates(numbers));
        });
        found.unwrap_or_else(|| I::coordinates(&[]))
    }

    /// The centre of mass of a body by its name, world axes [m], whatever the coordinates: what a field of gravity is a function of. `None` for a name
    /// that is no body. Computed when asked for.
    #[must_use]
    pub fn position(&self, body: &str) -> Option<[T; 3]> {
        self.gauge.position(body)
    }

    /// The outputs: `sample.outputs()?.pull`, with the inputs as they were up to this sample. Computed when asked for. `None` in a function of
    /// time and state, whose inputs they would depend on.
    #[must_use]
    pub fn outputs(&self) -> Option<I::Outputs> {
        let mut found = None;
        self.gauge.measure(Quantity::Outputs, &mut |columns| {
            found = Some(I::outputs(columns));
        });
        found
    }

    /// The state as the list x = [q | v | z].
    #[must_use]
    pub fn x(&self) -> &'a [T] {
        self.state
    }
}

/// A typed function as one of numbers.
pub(crate) fn law<T: Float, I: Inputs<T> + 'static>(
    mut typed: impl FnMut(&Sample<'_, I, T>, &mut I) + Send + 'static,
) -> Law<T> {
    Box::new(move |moment, numbers| {
        let Some(mut inputs) = I::from_numbers(numbers) else {
            return;
        };
        typed(&Sample::new(moment), &mut inputs);
        write(&inputs, numbers);
    })
}

/// What [`External`] supplies as a function.
pub(crate) fn external<T: Float>(loads: impl External<T> + Send + 'static) -> Law<T> {
    Box::new(move |moment, numbers| {
        loads.evaluate(T::from_f64(moment.time), moment.state, numbers);
    })
}

/// Writes the numbers of inputs; NaN where there are not as many as are asked for.
fn write<T: Float, I: Inputs<T>>(inputs: &I, out: &mut [T]) {
    let given = inputs.numbers();
    let given = given.as_ref();
    if given.len() == out.len() {
        out.copy_from_slice(given);
    } else {
        out.fill(T::from_f64(f64::NAN));
    }
}

/// Refuses the inputs of another model: another name, or other sizes.
pub(crate) fn check_model<T: Float>(
    model: &dyn Model<T>,
    inputs: Option<(&'static str, [usize; 2])>,
) -> Result<(), StepError> {
    let (name, layout) = (&model.scene().name, model.layout());
    match inputs {
        Some((other, sizes)) if other != name || sizes != [layout.nx(), layout.ni] => {
            Err(StepError::Unsupported {
                what: format!("a run of `{name}` with the inputs of `{other}`"),
                instead: match layout.ni {
                    0 => format!("`{name}` has no inputs"),
                    _ => format!("give `{name}Inputs`"),
                },
            })
        }
        _ => Ok(()),
    }
}

/// Refuses a list of inputs that is too long or too short, or has a number that is not finite.
pub(crate) fn check_numbers<T: Float>(
    model: &dyn Model<T>,
    numbers: &[T],
) -> Result<(), StepError> {
    let (scene, layout) = (model.scene(), model.layout());
    if numbers.len() != layout.ni {
        return Err(StepError::length("inputs", numbers.len(), layout.ni));
    }
    let (slot, value) = if let Some(at) = numbers.iter().position(|x| !x.is_finite()) {
        let value = numbers.get(at).map_or(f64::NAN, |x| x.to_f64());
        (input_name(scene, layout, at), value)
    } else {
        return Ok(());
    };
    Err(StepError::InvalidInput { slot, value })
}

/// Refuses numbers of a function or a controller that are not finite.
pub(crate) fn check_supplied<T: Float>(
    model: &dyn Model<T>,
    time: f64,
    numbers: &[T],
) -> Result<(), StepError> {
    match all_finite(numbers) {
        true => Ok(()),
        false => Err(first_fault(model, time, numbers)),
    }
}

/// The first of some numbers that is not finite.
#[cold]
fn first_fault<T: Float>(model: &dyn Model<T>, time: f64, numbers: &[T]) -> StepError {
    let index = numbers.iter().position(|x| !x.is_finite());
    let (scene, layout) = (model.scene(), model.layout());
    not_finite(scene, layout, time, index.unwrap_or_default())
}

#[cold]
fn not_finite(scene: &Scene, layout: &Layout, time: f64, index: usize) -> StepError {
    StepError::NonFinite {
        time,
        source: Source::Load(input_name(scene, layout, index)),
    }
}

/// A controller that is called at even intervals.
pub(crate) struct Sampler<T: Float> {
    /// The interval [s].
    pub period: f64,
    /// When the first sample is [s].
    pub from: f64,
    /// The number of the next sample.
    pub next: u64,
    pub law: Law<T>,
}

impl<T: Float> Sampler<T> {
    /// When the next sample is [s]: a product, so that rounding does not accumulate.
    pub fn instant(&self) -> f64 {
        self.from + self.next as f64 * self.period
    }
}
