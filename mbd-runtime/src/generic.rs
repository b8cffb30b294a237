//! The generic solver: the laws run on numbers, no compilation. The baseline of the benchmark and the witness that generated code is right.

use mbd_scene::laws::{self, LineNumbers, Numbers, Scratch};
use mbd_scene::{
    At, Differentiated, Dual, Float, Layout, Model, ParamError, Quantity, Scene, Variable,
    check_params,
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
    lists: Lists<T>,
    out: Vec<Slope<T>>,
}

/// The arguments of an evaluation as dual numbers.
#[derive(Clone, Debug, Default)]
struct Lists<T> {
    state: Vec<Slope<T>>,
    nodes: Vec<Slope<T>>,
    effective: Vec<Slope<T>>,
    hold: Vec<Slope<T>>,
    ends: Vec<Slope<T>>,
    inputs: Vec<Slope<T>>,
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
        work.lists.read(at);
        work.out.clear();
        work.out.resize(rows, Dual::constant(T::zero()));
        let mut first = 0;
        while first < columns {
            let last = columns.min(first + PASS);
            let mut seeded = None;
            match by {
                Variable::State => seed(&mut work.lists.state, first..last),
                Variable::Node => seed(&mut work.lists.nodes, first..last),
                Variable::Parameter => {
                    let mut params = self.slopes.params.clone();
                    seed(&mut params, first..last);
                    seeded = Some(Numbers::new(&self.scene, &params));
                }
            }
            let numbers = seeded.as_ref().unwrap_or(&self.slopes);
            let time = Dual::constant(at.time);
            laws::evaluate(
                of.quantity(),
                &self.scene,
                &self.layout,
                numbers,
                &work.lists.at(time),
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

impl<T: Float> Lists<T> {
    fn read(&mut self, at: &At<'_, T>) {
        let copy = |from: &[T], to: &mut Vec<Slope<T>>| {
            to.clear();
            to.extend(from.iter().copied().map(Dual::constant));
        };
        copy(at.state, &mut self.state);
        copy(at.nodes, &mut self.nodes);
        copy(at.effective, &mut self.effective);
        copy(at.hold, &mut self.hold);
        copy(at.ends, &mut self.ends);
        copy(at.inputs, &mut self.inputs);
    }

    fn at(&self, time: Slope<T>) -> At<'_, Slope<T>> {
        At {
            time,
            state: &self.state,
            nodes: &self.nodes,
            effective: &self.effective,
            hold: &self.hold,
            ends: &self.ends,
            inputs: &self.inputs,
            rows: &[],
        }
    }
}

impl<T: Float> Model<T> for Generic<T> {
    type Work = GenericWork<T>;

    fn work(&self) -> GenericWork<T> {
        GenericWork {
            scratch: Scratch::new(&self.layout),
            slopes: Scratch::new(&self.layout),
            lists: Lists::default(),
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
