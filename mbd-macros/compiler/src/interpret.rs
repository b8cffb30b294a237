//! Running a program: the second of the three ways to execute a scene.

use mbd_scene::laws::{LineNumbers, Numbers};
use std::sync::Arc;

use mbd_scene::{
    At, Float, Layout, Model, ParamError, Quantity, Real, Scene, Work, check_params, check_tables,
    each_column,
};

use crate::equations::SceneEquations;
use crate::expression::Slot;
use crate::program::{Code, Program};

/// Registers of a run: carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct Registers<T: Real> {
    numbers: Vec<T>,
    masks: Vec<T::Mask>,
    columns: Vec<T>,
}

impl<T: Real> Registers<T> {
    /// Room for a program of so many registers.
    #[must_use]
    pub fn new(count: usize) -> Self {
        let nothing = T::zero().lt(T::zero());
        Registers {
            numbers: vec![T::zero(); count],
            masks: vec![nothing; count],
            columns: Vec::new(),
        }
    }
}

impl Program {
    /// Runs the program at `at` for given parameters and derived terms, and writes its results to `out`.
    ///
    /// If `out`, the registers or a list of `at` is shorter than the program needs, nothing is written.
    pub fn run<T: Real>(
        &self,
        at: &At<'_, T>,
        params: &[T],
        derived: &[T],
        registers: &mut Registers<T>,
        out: &mut [T],
    ) {
        let Registers { numbers, masks, .. } = registers;
        if out.len() < self.len || numbers.len() < self.registers() {
            return;
        }
        for (register, &value) in numbers.iter_mut().zip(&self.constants) {
            *register = T::from_f64(value);
        }
        let (first, zero) = (self.constants.len(), T::zero());
        let behind_direction = self.by_column.as_ref().map_or(0, |own| own.columns.len());
        for (register, &slot) in numbers.iter_mut().skip(first).zip(&self.slots) {
            let value = match slot {
                Slot::Time => Some(&at.time),
                Slot::State(i) => at.state.get(i),
                Slot::Node(i) => at.nodes.get(i),
                Slot::Effective(i) => at.effective.get(i),
                Slot::Hold(i) => at.hold.get(i),
                Slot::Ends(i) => at.ends.get(i),
                Slot::Input(i) => at.inputs.get(i),
                Slot::Row(i) | Slot::Motion(i) | Slot::Factored(i) | Slot::Right { at: i, .. } => {
                    at.rows.get(i)
                }
                Slot::Direction(i) => at.rows.get(i),
                Slot::Value(i) => at.rows.get(behind_direction + i),
                Slot::Turn { at: i, .. } | Slot::Origin { at: i, .. } => {
                    Some(at.hold.get(i).unwrap_or(&zero))
                }
                Slot::Param(i) => params.get(i),
                Slot::Derived(i) => derived.get(i),
            };
            match value {
                Some(&value) => *register = value,
                None => return,
            }
        }
        let first = first + self.slots.len();
        for (index, step) in self.steps.iter().enumerate() {
            let a = numbers[step.a as usize];
            let b = numbers[step.b as usize];
            let value = match step.code {
                Code::Add => a + b,
                Code::Sub => a - b,
                Code::Mul => a * b,
                Code::Div => a / b,
                Code::Neg => -a,
                Code::Sqrt => a.sqrt(),
                Code::Min => a.min(b),
                Code::Max => a.max(b),
                Code::Abs => a.abs(),
                Code::Sin => a.sin_cos().0,
                Code::Cos => a.sin_cos().1,
                Code::Exp => a.exp(),
                Code::Ln => a.ln(),
                Code::Tanh => a.tanh(),
                Code::Floor => a.floor(),
                Code::Atan2 => a.atan2(b),
                Code::Fmadd => a.fmadd(b, numbers[step.c as usize]),
                Code::Fmsub => a.fmsub(b, numbers[step.c as usize]),
                Code::Fnmadd => a.fnmadd(b, numbers[step.c as usize]),
                Code::Select => T::select(masks[step.c as usize], a, b),
                Code::Lt | Code::Le | Code::Both => {
                    masks[first + index] = match step.code {
                        Code::Lt => a.lt(b),
                        Code::Le => a.le(b),
                        _ => T::both(masks[step.a as usize], masks[step.b as usize]),
                    };
                    continue;
                }
            };
            numbers[first + index] = value;
        }
        for &(place, register) in &self.outputs {
            out[place] = numbers[register.index()];
        }
    }
}

/// A scene run by interpreting its programs: same operations in the same order as generated code, without a compiler.
#[derive(Clone, Debug)]
pub struct Interpreted<T> {
    equations: Arc<SceneEquations>,
    params: Vec<T>,
    derived: Vec<T>,
    lines: Vec<LineNumbers<T>>,
}

impl<T: Real> Interpreted<T> {
    /// The equations with parameters that nobody has checked: for dual numbers and lanes.
    #[must_use]
    pub fn unchecked(equations: Arc<SceneEquations>, params: &[T]) -> Self {
        let mut derived = vec![T::zero(); equations.derived.len];
        let mut registers = Registers::new(equations.derived.registers());
        let nowhere = At::of_state(T::zero(), &[], &[]);
        equations
            .derived
            .run(&nowhere, params, &[], &mut registers, &mut derived);
        Interpreted {
            lines: Numbers::new(&equations.scene, params).lines,
            params: params.to_vec(),
            derived,
            equations,
        }
    }

    /// Registers for every quantity.
    #[must_use]
    pub fn registers(&self) -> Registers<T> {
        let programs = self.equations.every_program();
        let most = programs.map(Program::registers).max();
        Registers::new(most.unwrap_or_default())
    }

    /// Writes a quantity, as [`Model::evaluate`] does.
    pub fn run(&self, what: Quantity, at: &At<'_, T>, registers: &mut Registers<T>, out: &mut [T]) {
        match self.equations.program(what) {
            Some(program) if program.by_column.is_some() => {
                self.run_by_column(program, at, registers, out);
            }
            Some(program) if out.len() == program.len => {
                program.run(at, &self.params, &self.derived, registers, out);
            }
            Some(program) if what == Quantity::Solve => {
                let mut columns = std::mem::take(&mut registers.columns);
                each_column(program.len, (at.rows, out), &mut columns, |rows, out| {
                    let at = At { rows, ..*at };
                    program.run(&at, &self.params, &self.derived, registers, out);
                });
                registers.columns = columns;
            }
            Some(_) => {}
            None if !self.equations.layout.spells_out(what) => {
                mbd_scene::sensitivity(what, &self.equations.layout, at, out);
            }
            // Not traced: loud, not silently zero.
            None => out.fill(T::from_f64(f64::NAN)),
        }
    }

    /// Writes a matrix column by column: what does not depend on the direction first.
    fn run_by_column(
        &self,
        program: &Program,
        at: &At<'_, T>,
        registers: &mut Registers<T>,
        out: &mut [T],
    ) {
        let values = program.what.and_then(|what| self.equations.values(what));
        let (Some(values), Some(own)) = (values, &program.by_column) else {
            return;
        };
        if out.len() != program.len * own.width {
            return;
        }
        let count = own.columns.len();
        let mut numbers = std::mem::take(&mut registers.columns);
        numbers.clear();
        numbers.resize(count + own.values + program.len, T::zero());
        let (rows, column) = numbers.split_at_mut(count + own.values);
        let known = &mut rows[count..];
        values.run(at, &self.params, &self.derived, registers, known);
        for (number, to) in own.columns.iter().enumerate() {
            rows[number] = T::one();
            let at = At { rows, ..*at };
            program.run(&at, &self.params, &self.derived, registers, column);
            for &(place, _) in &program.outputs {
                out[place * own.width + to] = column[place];
            }
            rows[number] = T::zero();
        }
        registers.columns = numbers;
    }

    /// Its equations.
    #[must_use]
    pub fn equations(&self) -> &Arc<SceneEquations> {
        &self.equations
    }
}

impl<T: Float> Interpreted<T> {
    /// Traces a scene and evaluates its constants for `params` (SI, declaration order).
    ///
    /// # Errors
    /// A parameter out of its range, not finite or missing; a mass or an inertia that no body has; a table that is none.
    pub fn new(scene: Scene, params: &[T]) -> Result<Self, ParamError> {
        check_tables(&scene)?;
        Self::from_equations(Arc::new(SceneEquations::trace(&scene)), params)
    }

    /// The same for equations already traced.
    ///
    /// # Errors
    /// As [`Interpreted::new`].
    pub fn from_equations(
        equations: impl Into<Arc<SceneEquations>>,
        params: &[T],
    ) -> Result<Self, ParamError> {
        let equations = equations.into();
        check_params(&equations.scene, params)?;
        Ok(Self::unchecked(equations, params))
    }
}

impl Interpreted<f64> {
    /// A scene as a model of runs in double precision: compiled with this crate, and not again in every crate that runs scenes.
    ///
    /// # Errors
    /// As [`Interpreted::new`].
    pub fn shared(scene: Scene, params: &[f64]) -> Result<Arc<dyn Model<f64>>, ParamError> {
        Ok(Arc::new(Self::new(scene, params)?))
    }
}

impl Interpreted<f32> {
    /// The same in single precision.
    ///
    /// # Errors
    /// As [`Interpreted::new`].
    pub fn shared(scene: Scene, params: &[f32]) -> Result<Arc<dyn Model<f32>>, ParamError> {
        Ok(Arc::new(Self::new(scene, params)?))
    }
}

impl<T: Float> Model<T> for Interpreted<T> {
    fn share(&self) -> Arc<dyn Model<T>> {
        Arc::new(self.clone())
    }

    fn with_params(&self, params: &[T]) -> Result<Arc<dyn Model<T>>, ParamError> {
        Ok(Arc::new(Self::from_equations(
            self.equations.clone(),
            params,
        )?))
    }

    fn work(&self) -> Work<T> {
        Work::of(self.registers())
    }

    fn scene(&self) -> &Scene {
        &self.equations.scene
    }

    fn layout(&self) -> &Layout {
        &self.equations.layout
    }

    fn params(&self) -> &[T] {
        &self.params
    }

    fn lines(&self) -> &[LineNumbers<T>] {
        &self.lines
    }

    fn evaluate(&self, what: Quantity, at: &At<'_, T>, work: &mut Work<T>, out: &mut [T]) {
        if let Some(registers) = work.get() {
            self.run(what, at, registers, out);
        }
    }
}
