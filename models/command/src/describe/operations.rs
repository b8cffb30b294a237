//! What the equations of a scene cost.

use mbd_compiler::SceneEquations;
use mbd_runtime::scene::Cost;

use mbd_report::{Cell, ReportTable};

/// Operations of every quantity of the scene.
#[must_use]
pub fn operations(equations: &SceneEquations) -> ReportTable {
    let mut table = ReportTable::new("Operations of one evaluation")
        .column("quantity", "")
        .column("all", "")
        .column("+ −", "")
        .column("×", "")
        .column("÷", "")
        .column("√", "")
        .column("sin cos exp", "")
        .column("select", "");
    let mut add = |name: String, cost: Cost| {
        let kinds = [
            cost.total(),
            cost.adds,
            cost.muls,
            cost.divs,
            cost.sqrts,
            cost.trigs,
            cost.selects,
        ];
        table.push([Cell::from(name)].into_iter().chain(kinds.map(Cell::from)));
    };
    add(
        "terms of the params alone, once".to_string(),
        equations.derived.cost(),
    );
    for (what, _) in &equations.programs {
        if let Some(cost) = equations.cost_of(*what) {
            add(what.to_string(), cost);
        }
    }
    table
}
