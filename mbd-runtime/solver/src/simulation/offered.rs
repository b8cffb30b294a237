//! Which runs are offered: what a method cannot do with a model, and a model without what its caller supplies, is refused before anything runs.

use mbd_scene::{
    Coordinate, Differentiated, Float, Formula, InputSlots, InputSource, Joint, Layout, Model,
    NodeModel, Quantity, Scene,
};

use crate::columns::{input_name, node_name};
use crate::error::StepError;
use crate::options::{Method, Options, Stabilise};

/// Whether a quantity has a value in a model.
pub(super) fn emitted<T: Float>(model: &dyn Model<T>, what: Quantity) -> Result<(), StepError> {
    match model.emits(what) {
        true => Ok(()),
        false => Err(StepError::Unsupported {
            what: format!("{what} of a model that does not emit them"),
            instead: instead_of(what, model.layout()).into(),
        }),
    }
}

/// Whether a quantity follows from where a run stands: not one that is asked with numbers of its own.
pub(super) fn told_by_state(what: Quantity) -> Result<(), StepError> {
    match what {
        Quantity::InverseDynamics
        | Quantity::Residual
        | Quantity::ProjectionStep
        | Quantity::Solve
        | Quantity::Partial(Differentiated::Residual, _) => Err(StepError::Unsupported {
            what: format!(
                "{what} of a run, without the accelerations or right-hand sides that it is asked with (`At::rows`),"
            ),
            instead:
                "give them: `Model::evaluate`, the method of a generated model, `inverse_dynamics`"
                    .into(),
        }),
        _ => Ok(()),
    }
}

/// What gives a quantity that a compiled model does not emit.
fn instead_of(what: Quantity, layout: &Layout) -> &'static str {
    match what {
        Quantity::Partial(..) | Quantity::Residual | Quantity::Factor | Quantity::Solve => {
            "take a `Linearisation`, or `linearise`, which finds the derivatives of every model"
        }
        Quantity::Coordinates | Quantity::JointCoordinates | Quantity::Bodies => {
            "declare an output of them, or ask `Generic` of its scene"
        }
        what if layout.quantities().contains(&what) => {
            "add them to the `emit` of its declaration, or leave `emit` out"
        }
        _ => "add them to the `emit` of its declaration, or ask `Generic` of its scene",
    }
}

/// Whether this combination of model and method is offered.
pub(super) fn offered<T: Float>(model: &dyn Model<T>, options: &Options) -> Result<(), StepError> {
    if let (Some(point), Some(_)) = (stepwise(model), options.method.tolerance()) {
        return Err(StepError::Unsupported {
            what: format!(
                "{} with the `stepwise` node `{}`",
                options.method.name(),
                node_name(model.scene(), point)
            ),
            instead: "take Method::Rk4 with a fixed step, or declare the node `rate` or `static`"
                .into(),
        });
    }
    if options.work && !model.emits(Quantity::Energy) {
        return Err(StepError::Unsupported {
            what: "a run with `work`, of a model that does not emit the `energy` whose powers it integrates,"
                .into(),
            instead: "add `energy` to the `emit` of its declaration, leave `emit` out, or run without `work`"
                .into(),
        });
    }
    if let Some((_, held)) = model.layout().redundancy.idle_lock(model.scene()) {
        return Err(StepError::Unsupported {
            what: format!("a lock where {held}"),
            instead: "lock another coordinate, or take away what holds this one".into(),
        });
    }
    let mut events = model.scene().events.iter();
    if let (false, Some(event)) = (
        options.locate,
        events.find(|event| !event.actions.is_empty()),
    ) {
        return Err(StepError::Unsupported {
            what: format!(
                "a run that locates nothing, of the event `{}`, which acts,",
                event.name
            ),
            instead: "leave `locate` on".into(),
        });
    }
    if let Method::Rattle { .. } = options.method {
        return reversible(model, options);
    }
    let implicit = options.method.needs_derivatives();
    if implicit && matches!(options.stabilise, Stabilise::Baumgarte { .. }) {
        return Err(StepError::Unsupported {
            what: format!("{} with Stabilise::Baumgarte", options.method.name()),
            instead: "take Stabilise::Projection, or an explicit method".into(),
        });
    }
    Ok(())
}

/// Refuses what cannot be run backwards in time, as the middle of a step of Rattle is.
fn reversible<T: Float>(model: &dyn Model<T>, options: &Options) -> Result<(), StepError> {
    let refuse = |what: String, instead: &str| {
        let instead = instead.to_owned();
        Err(StepError::Unsupported { what, instead })
    };
    let method = options.method.name();
    if model.layout().tree.is_some() {
        return refuse(
            format!("{method} in relative coordinates, whose mass matrix changes with them,"),
            "declare `coordinates: absolute`, or take Method::Vern7",
        );
    }
    if T::EPSILON.to_f64() > f64::EPSILON {
        return refuse(
            format!("{method} in f32, where its rotations round away what it keeps,"),
            "run in f64, or take Method::Rk4",
        );
    }
    if options.stabilise != Stabilise::Projection {
        return refuse(
            format!("{method} without Stabilise::Projection"),
            "leave `stabilise` as it is: this method holds the joints by itself",
        );
    }
    if let Some((joint, coordinate)) = follows_states(model.scene()) {
        return refuse(
            format!(
                "{method} with the motor of `{}.{}`, whose value is a state: the joints would be held to it half a part of a step too early,",
                joint.name, coordinate.name
            ),
            "prescribe a function of time without a filter, or take another method: `rk4`, `tsit5`, `vern7`",
        );
    }
    let mut nodes = model.layout().nodes.iter();
    let Some(node) = nodes.find(|node| node.model != NodeModel::Static) else {
        return Ok(());
    };
    refuse(
        format!(
            "{method} with the node `{}`, whose dampers cannot be run backwards in time,",
            node_name(model.scene(), node.point)
        ),
        "declare the node `static` or give the point a mass, or take another method: `rk4`, `tsit5`",
    )
}

/// The first coordinate that a motor holds to a value in which there are states, those of its filter among them.
fn follows_states(scene: &Scene) -> Option<(&Joint, Coordinate)> {
    let mut joints = scene.joints.iter().enumerate();
    joints.find_map(|(joint, declared)| {
        let mut motors = declared.motors();
        let state = |part: &Formula| matches!(part, Formula::State(_));
        let (index, _) = motors.find(|(_, course)| scene.contains(course, state))?;
        scene.coordinate(joint, index)
    })
}

/// Refuses inputs that are functions of time and state to a method that solves with derivatives of the rates.
pub(super) fn differentiable(options: &Options) -> Result<(), StepError> {
    if !options.method.needs_derivatives() {
        return Ok(());
    }
    Err(StepError::Unsupported {
        what: format!(
            "{} with inputs that are functions of time and state, which have no derivatives,",
            options.method.name()
        ),
        instead: "hold inputs (`set_inputs`), sample them (`control_every`), declare what they follow in the model, or take an explicit method".into(),
    })
}

/// A run of a scene whose external loads or gravity nobody supplies.
#[cold]
pub(super) fn unsupplied<T: Float>(model: &dyn Model<T>) -> StepError {
    let (scene, layout) = (model.scene(), model.layout());
    let without_default = |slots: &&InputSlots| !matches!(slots.source, InputSource::Input(_));
    let missing = layout.inputs.iter().filter(without_default);
    let names: Vec<String> = missing
        .map(|slots| format!("`{}`", input_name(scene, layout, slots.at)))
        .collect();
    StepError::Unsupported {
        what: format!("a run without {}", names.join(", ")),
        instead: "set_inputs holds them, control computes them from time and state".into(),
    }
}

/// The first point with a `stepwise` node.
pub(super) fn stepwise<T: Float>(model: &dyn Model<T>) -> Option<usize> {
    let nodes = &model.layout().nodes;
    nodes
        .iter()
        .find(|node| matches!(node.model, NodeModel::Stepwise { .. }))
        .map(|node| node.point)
}
