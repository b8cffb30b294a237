//! The generic solver: the laws run on numbers, no compilation. The baseline of the benchmark and the witness that generated code is right.

use mbd_scene::laws::{self, LineNumbers, Numbers, Scratch};
use mbd_scene::{
    Arguments, At, Differentiated, Dual, Float, Layout, Model, ParamError, Quantity, Scene,
    Variable, check_params,
};

/// How many variables one pass of dual numbers carries.
const PASS: usize = 8;
type Slope<T> = Dual<T, PASS>;

/// A scene run by its laws.
#[derive(Clone, Debug)]
pub struct Generic<T: Float> {
    scene: Scene,
    layout: Layout,
    params: Vec<T>,
    numbers: Numbers<T>,
    slopes: Numbers<Slope<T>>,
}

/// Scratch of a [`Generic`].
#[derive(Clone, Debug)]
pub struct GenericWork<T: Float> {
    scratch: Scratch<T>,
    slopes: Scratch<Slope<T>>,
    arguments: Arguments<Slope<T>>,
    out: Vec<Slope<T>>,
}

impl<T: Float> Generic<T> {
    /// A model of `scene` with `params` (SI, declaration order).
    ///
    /// # Errors
    /// The first parameter that cannot be run.
    pub fn new(scene: Scene, params: &[T]) -> Result<Self, ParamError> {
        check_params(&scene, params)?;
        let constants: Vec<Slope<T>> = params.iter().copied().map(Dual::constant).collect();
        Ok(Generic {
            layout: Layout::new(&scene),
            numbers: Numbers::new(&scene, params),
            slopes: Numbers::new(&scene, &constants),
            params: params.to_vec(),
            scene,
        })
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

    /// Writes ∂(quantity)/∂(variable), [`PASS`] columns at a time.
    fn partial(
        &self,
        of: Differentiated,
        by: Variable,
        at: &At<'_, T>,
        work: &mut GenericWork<T>,
        out: &mut [T],
    ) {
        let columns = self.layout.variables(by);
        let rows = self.layout.len(of.quantity());
        if out.len() != rows * columns {
            return;
        }
        work.arguments.read(at, Dual::constant);
        work.out.clear();
        work.out.resize(rows, Dual::constant(T::zero()));
        let mut first = 0;
        while first < columns {
            let last = columns.min(first + PASS);
            let mut seeded = None;
            match by {
                Variable::State => seed(&mut work.arguments.state, first..last),
                Variable::Node => seed(&mut work.arguments.nodes, first..last),
                Variable::Parameter => {
                    let mut params = self.slopes.params.clone();
                    seed(&mut params, first..last);
                    seeded = Some(Numbers::new(&self.scene, &params));
                }
            }
            let numbers = seeded.as_ref().unwrap_or(&self.slopes);
            laws::evaluate(
                of.quantity(),
                &self.scene,
                &self.layout,
                numbers,
                &work.arguments.at(),
                &mut work.slopes,
                &mut work.out,
            );
            for (row, value) in work.out.iter().enumerate() {
                out[row * columns + first..row * columns + last]
                    .copy_from_slice(&value.slopes[..last - first]);
            }
            first = last;
        }
    }
}

/// Makes the numbers in `range` variables 0, 1, …, all others constants.
fn seed<T: Float>(list: &mut [Slope<T>], range: std::ops::Range<usize>) {
    for (index, number) in list.iter_mut().enumerate() {
        *number = if range.contains(&index) {
            Dual::variable(number.value, index - range.start)
        } else {
            Dual::constant(number.value)
        };
    }
}

impl<T: Float> Model<T> for Generic<T> {
    type Work = GenericWork<T>;

    fn work(&self) -> GenericWork<T> {
        GenericWork {
            scratch: Scratch::new(&self.layout),
            slopes: Scratch::new(&self.layout),
            arguments: Arguments::default(),
            out: Vec::new(),
        }
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

    fn evaluate(&self, what: Quantity, at: &At<'_, T>, work: &mut GenericWork<T>, out: &mut [T]) {
        match what {
            Quantity::Partial(of, by) => self.partial(of, by, at, work, out),
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
}
