//! Scenes that are not compiled, in lanes: the interpreted equations over lanes.

use std::sync::Arc;

use mbd_compiler::{Interpreted, Registers, SceneEquations};
use mbd_runtime::{At, Beside, Forms, LaneParameters, Lanes4, Lanes8, Model, Quantity, Real};

/// An interpreted model with its equations over lanes at hand.
#[must_use]
pub fn in_lanes(model: &Interpreted<f64>) -> Beside {
    Beside::new(model.share(), Arc::new(Programs(model.equations().clone())))
}

/// The equations of a scene, which any scalar can run.
struct Programs(Arc<SceneEquations>);

impl Programs {
    fn over<L: Real>(&self) -> Box<dyn LaneParameters<L>> {
        // Those of the defaults; cases bring their own.
        let params = self.0.scene.params.iter();
        let params: Vec<L> = params.map(|param| L::from_f64(param.default)).collect();
        let model = Interpreted::unchecked(self.0.clone(), &params);
        Box::new(Interpretation {
            registers: model.registers(),
            model,
        })
    }
}

impl Forms for Programs {
    fn four(&self) -> Box<dyn LaneParameters<Lanes4>> {
        self.over()
    }
    fn eight(&self) -> Box<dyn LaneParameters<Lanes8>> {
        self.over()
    }
}

/// Equations over one register, with their registers.
struct Interpretation<L: Real> {
    model: Interpreted<L>,
    registers: Registers<L>,
}

impl<L: Real> LaneParameters<L> for Interpretation<L> {
    fn take(&mut self, params: &[L]) {
        self.model = Interpreted::unchecked(self.model.equations().clone(), params);
    }

    fn evaluate(&mut self, what: Quantity, at: &At<'_, L>, out: &mut [L]) {
        self.model.run(what, at, &mut self.registers, out);
    }
}
