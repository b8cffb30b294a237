//! The generic solver: the laws run on numbers, no compilation. The baseline of the benchmark and the witness that generated code is right.

use std::sync::Arc;

use mbd_scene::laws::{self, LineNumbers, Numbers, Scratch};
use mbd_scene::{
    Arguments, At, Differentiated, Dual, Float, Layout, Model, ParamError, Quantity, Scene,
    Variable, Work, checked_numbers,
};

use crate::compiled::Scalar;

/// How many variables one pass of dual numbers carries.
const PASS: usize = 8;
/// Derivatives are computed in `f64` whatever the scalar of the model: exact enough for both, and compiled once.
type Slope = Dual<f64, PASS>;

/// A scene run by its laws.
#[derive(Clone, Debug)]
pub struct Generic<T: Float> {
    scene: Arc<Scene>,
    layout: Arc<Layout>,
    params: Vec<T>,
    numbers: Numbers<T>,
}

/// Scratch of a [`Generic`].
#[derive(Debug)]
struct Scratches<T: Float> {
    scratch: Scratch<T>,
    slopes: Option<Slopes>,
}

/// What derivatives need.
#[derive(Debug)]
struct Slopes {
    numbers: Numbers<Slope>,
    scratch: Scratch<Slope>,
    arguments: Arguments<Slope>,
    out: Vec<Slope>,
}

impl<T: Scalar> Generic<T> {
    /// A model of `scene` with `params` (SI, declaration order).
    ///
    /// # Errors
    /// The first parameter that cannot be run.
    pub fn new(scene: Scene, params: &[T]) -> Result<Self, ParamError> {
        T::make_generic(scene, params)
    }

    /// A model of `scene` with the declared defaults.
    ///
    /// # Errors
    /// The first parameter that cannot be run.
    pub fn with_defaults(scene: Scene) -> Result<Self, ParamError> {
        let params: Vec<T> = scene
            .params
            .iter()
            .map(|param| T::from_f64(param.default))
            .collect();
        Self::new(scene, &params)
    }
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
                let slopes = work.slopes.get_or_insert_with(|| self.slopes());
                self.partial(of, by, at, slopes, out);
            }
            _ => laws::evaluate(
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

    fn slopes(&self) -> Slopes {
        let constants: Vec<Slope> = self.params.iter().map(|&x| constant(x)).collect();
        Slopes {
            numbers: Numbers::new(&self.scene, &constants),
            scratch: Scratch::new(&self.layout),
            arguments: Arguments::default(),
            out: Vec::new(),
        }
    }

    /// Writes ∂(quantity)/∂(variable), [`PASS`] columns at a time.
    fn partial(
        &self,
        of: Differentiated,
        by: Variable,
        at: &At<'_, T>,
        work: &mut Slopes,
        out: &mut [T],
    ) {
        let columns = self.layout.variables(by);
        let rows = self.layout.len(of.quantity());
        if out.len() != rows * columns {
            return;
        }
        work.arguments.read(at, constant);
        work.out.clear();
        work.out.resize(rows, Dual::constant(0.0));
        let mut first = 0;
        while first < columns {
            let last = columns.min(first + PASS);
            let mut seeded = None;
            match by {
                Variable::State => seed(&mut work.arguments.state, first..last),
                Variable::Node => seed(&mut work.arguments.nodes, first..last),
                Variable::Parameter => {
                    let mut params = work.numbers.params.clone();
                    seed(&mut params, first..last);
                    seeded = Some(Numbers::new(&self.scene, &params));
                }
            }
            let numbers = seeded.as_ref().unwrap_or(&work.numbers);
            laws::evaluate(
                of.quantity(),
                &self.scene,
                &self.layout,
                numbers,
                &work.arguments.at(),
                &mut work.scratch,
                &mut work.out,
            );
            for (row, value) in work.out.iter().enumerate() {
                let to = &mut out[row * columns + first..row * columns + last];
                for (to, slope) in to.iter_mut().zip(value.slopes) {
                    *to = T::from_f64(slope);
                }
            }
            first = last;
        }
    }
}

/// A number that does not vary.
fn constant<T: Float>(x: T) -> Slope {
    Dual::constant(x.to_f64())
}

/// Makes the numbers in `range` variables 0, 1, …, all others constants.
fn seed(list: &mut [Slope], range: std::ops::Range<usize>) {
    for (index, number) in list.iter_mut().enumerate() {
        *number = if range.contains(&index) {
            Dual::variable(number.value, index - range.start)
        } else {
            Dual::constant(number.value)
        };
    }
}

impl<T: Scalar> Model<T> for Generic<T> {
    fn share(&self) -> Arc<dyn Model<T>> {
        Arc::new(self.clone())
    }

    fn with_params(&self, params: &[T]) -> Result<Arc<dyn Model<T>>, ParamError> {
        Ok(Arc::new(T::change_generic(self, params)?))
    }

    fn work(&self) -> Work<T> {
        T::make_work(self)
    }

    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn params(&self) -> &[T] {
        &self.params
    }

    fn lines(&self) -> &[LineNumbers<T>] {
        &self.numbers.lines
    }

    fn evaluate(&self, what: Quantity, at: &At<'_, T>, work: &mut Work<T>, out: &mut [T]) {
        T::run_laws(self, what, at, work, out);
    }
}
