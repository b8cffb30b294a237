//! Which part of the declaration has no number where the rates have none: a load, a force along a joint, the rate of a state.

use mbd_scene::{
    Arguments, Float, Formula, Layout, LoadKind, Output, Quantity, Scene, Starts, Unit, double,
};

use super::System;
use crate::error::Source;

/// A formula of the declaration, how it is told, and how many numbers it has.
struct Asked<'a> {
    told: String,
    formula: &'a Formula,
    components: usize,
}

impl<T: Float> System<T> {
    /// The first formula of the declaration that is no finite number at a state that is; `None` where all are, or the state is not.
    #[cold]
    pub(super) fn without_number(&self, time: f64, state: &[T]) -> Option<Source> {
        if state.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let scene = self.model.scene();
        let asked = formulas(scene);
        let output = |asked: &Asked<'_>| Output {
            name: asked.told.clone(),
            doc: String::new(),
            value: asked.formula.clone(),
            components: asked.components,
            unit: Unit::default(),
        };
        // The scene, asked for nothing else.
        let shown = Scene {
            outputs: asked.iter().map(output).collect(),
            events: Vec::new(),
            starts: Starts::default(),
            ..scene.clone()
        };
        let layout = Layout::new(&shown);
        let params: Vec<f64> = self.model.params().iter().map(|x| x.to_f64()).collect();
        let mut arguments = Arguments::default();
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        arguments.read(&at, T::to_f64);
        let mut out = vec![0.0; layout.len(Quantity::Outputs)];
        double::evaluate(
            Quantity::Outputs,
            &shown,
            &layout,
            &double::numbers(&shown, &params),
            &arguments.at(),
            &mut double::scratch(&layout),
            &mut out,
        );
        let mut rest = out.as_slice();
        let fault = asked.into_iter().find(|asked| {
            let (own, behind) = rest.split_at(asked.components.min(rest.len()));
            rest = behind;
            own.iter().any(|x| !x.is_finite())
        });
        fault.map(|asked| Source::Declared(asked.told))
    }
}

/// The formulas that rates are made of, in the order of declaration.
fn formulas(scene: &Scene) -> Vec<Asked<'_>> {
    let loads = scene.loads.iter().filter_map(|load| match &load.kind {
        LoadKind::Force(formula) | LoadKind::Torque(formula) => Some(Asked {
            told: format!("the load `{}`", load.name),
            formula,
            components: 3,
        }),
        LoadKind::External => None,
    });
    let along = scene.joints.iter().flat_map(|joint| {
        let forces = joint.forces.iter().filter_map(|along| along.force.as_ref());
        forces.map(|formula| Asked {
            told: format!("the `force` of the joint `{}`", joint.name),
            formula,
            components: 1,
        })
    });
    let states = scene.states.iter().map(|state| Asked {
        told: format!("the `rate` of the state `{}`", state.name),
        formula: &state.rate,
        components: 1,
    });
    loads.chain(along).chain(states).collect()
}
