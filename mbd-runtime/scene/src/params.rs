//! What is demanded of parameter values: said once, asked by every way to run a scene.

use std::fmt;

use crate::joints::{FILTER, JointForceField, NUMBERS, STOP_ORDER, STOPS, in_order};
use crate::laws::{Numbers, constant, start_of};
use crate::{Float, Formula, PointKind, Scene, Unit};

/// A parameter value that cannot be run.
#[derive(Clone, Debug, PartialEq)]
pub enum ParamError {
    /// The number of values is not the number of declared params.
    Count {
        /// Declared.
        expected: usize,
        /// Given.
        found: usize,
    },
    /// They are those of another model.
    OtherModel {
        /// The model.
        model: String,
        /// Whose they are.
        given: String,
    },
    /// A value is infinite or NaN.
    NotFinite {
        /// The param.
        param: String,
        /// The value [SI].
        value: f64,
    },
    /// A value lies outside the declared range.
    OutOfRange {
        /// The param.
        param: String,
        /// The value [SI].
        value: f64,
        /// The declared range [SI].
        range: [f64; 2],
        /// The unit in which it is declared, and told.
        unit: Unit,
    },
    /// A number that the params give is not physical.
    NotPhysical {
        /// The body, point or line and its field, `capsule.mass`.
        what: String,
        /// The value [SI].
        value: f64,
        /// What it must be.
        rule: &'static str,
    },
    /// A table of a scene that was made or changed by a program is none.
    Table {
        /// The table and its number, `wind.x[2]`.
        what: String,
        /// What it must be.
        rule: &'static str,
    },
}

impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ParamError::Count { expected, found } => {
                write!(f, "this model has {expected} params, found {found} values")
            }
            ParamError::OtherModel { model, given } => {
                write!(
                    f,
                    "these are params of `{given}`: `{model}` takes its own, `{model}Params`"
                )
            }
            ParamError::NotFinite { param, value } => {
                write!(f, "param `{param}` is {value}: give it a finite value")
            }
            ParamError::OutOfRange {
                param,
                value,
                range: [low, high],
                unit,
            } => {
                let [value, low, high] = [value, low, high].map(|x| unit.told(*x));
                write!(
                    f,
                    "param `{param}` is {value}, outside its declared range {low} ..= {high}: change the value or widen the range in the declaration"
                )
            }
            ParamError::NotPhysical { what, value, rule } => write!(
                f,
                "`{what}` is {value} with these params; it must be {rule}"
            ),
            ParamError::Table { what, rule } => {
                write!(f, "`{what}` of a table of this scene must be {rule}")
            }
        }
    }
}

impl std::error::Error for ParamError {}

/// Checks values for the params of a scene (declaration order, SI): number, finiteness, range, and that masses, inertias, stiffnesses,
/// dampings and free lengths which depend on them are physical.
///
/// # Errors
/// The first value that cannot be run, by name.
pub fn check_params<T: Float>(scene: &Scene, params: &[T]) -> Result<(), ParamError> {
    checked_numbers(scene, params).map(drop)
}

/// The constants of a scene after these checks.
///
/// # Errors
/// As [`check_params`].
pub fn checked_numbers<T: Float>(scene: &Scene, params: &[T]) -> Result<Numbers<T>, ParamError> {
    if params.len() != scene.params.len() {
        return Err(ParamError::Count {
            expected: scene.params.len(),
            found: params.len(),
        });
    }
    for (declared, value) in scene.params.iter().zip(params) {
        let (param, value) = (declared.name.clone(), value.to_f64());
        if !value.is_finite() {
            return Err(ParamError::NotFinite { param, value });
        }
        // A range is given in f64; in f32 its ends themselves are accepted.
        let inside = |[low, high]: &[f64; 2]| {
            T::from_f64(*low).to_f64().min(*low) <= value
                && value <= T::from_f64(*high).to_f64().max(*high)
        };
        if let Some(range) = declared.range.filter(|range| !inside(range)) {
            return Err(ParamError::OutOfRange {
                param,
                value,
                range,
                unit: declared.unit.clone(),
            });
        }
    }
    let numbers = Numbers::new(scene, params);
    check_numbers(scene, &numbers)?;
    Ok(numbers)
}

/// Checks the tables of a scene: of one that was compiled from a declaration they are tables.
///
/// # Errors
/// [`ParamError::Table`] of the first that is none.
pub fn check_tables(scene: &Scene) -> Result<(), ParamError> {
    for table in &scene.tables {
        table.check().map_err(|(number, rule)| ParamError::Table {
            what: format!("{}.{number}", table.name),
            rule,
        })?;
    }
    Ok(())
}

fn check_numbers<T: Float>(scene: &Scene, numbers: &Numbers<T>) -> Result<(), ParamError> {
    let positive = |value: T| value.is_finite() && value > T::zero();
    for (index, (body, numbers)) in scene.bodies.iter().zip(&numbers.bodies).enumerate() {
        let (what, mass) = (format!("{}.mass", body.name), numbers.mass);
        let inertia = numbers.inertia.map(Float::to_f64);
        if scene.is_carried(index) {
            let holds = mass.is_finite() && mass >= T::zero();
            demand(holds, what, mass, "positive, or zero [kg]")?;
            let wrong = inertia.iter().find(|element| !element.is_finite());
            let what = format!("{}.inertia", body.name);
            let element = T::from_f64(wrong.copied().unwrap_or_default());
            demand(wrong.is_none(), what, element, "finite [kg m²]")?;
            continue;
        }
        demand(positive(mass), what, mass, "positive [kg]")?;
        let moments = inertia.symmetric_eigenvalues();
        let (smallest, largest) = (moments.min(), moments.max());
        let moment = |which: &str| format!("{}.inertia, {which} principal moment", body.name);
        demand(
            smallest > 0.0,
            moment("smallest"),
            T::from_f64(smallest),
            "positive [kg m²]",
        )?;
        let of_a_body = 2.0 * largest <= moments.sum() * (1.0 + 1e-6);
        demand(
            of_a_body || scene.unchecked.contains(&index),
            moment("largest"),
            T::from_f64(largest),
            "at most the sum of the other two [kg m²]",
        )?;
    }
    for (point, &(mass, _)) in scene.points.iter().zip(&numbers.points) {
        let holds = matches!(point.kind, PointKind::Node(_)) || positive(mass);
        demand(holds, format!("{}.mass", point.name), mass, "positive [kg]")?;
    }
    for (joint, numbers) in scene.joints.iter().zip(&numbers.joints) {
        for ((field, _), &value) in joint.law.numbers().iter().zip(numbers) {
            let what = format!("{}.{}", joint.name, field.name);
            demand(
                field.rule.holds(value.to_f64()),
                what,
                value,
                field.rule.words(),
            )?;
        }
    }
    check_along(scene, &numbers.params)?;
    for state in &scene.states {
        let start = start_of(scene, &numbers.params, &state.start);
        demand(
            start.is_finite(),
            format!("{}.start", state.name),
            start,
            "a finite number",
        )?;
    }
    for (line, numbers) in scene.lines.iter().zip(&numbers.lines) {
        let (k, c, l) = (numbers.stiffness, numbers.damping, numbers.free_length);
        let (fits, wanted) = match line.kind.is_unilateral() {
            true => (positive(k), "positive [N/m]"),
            // A spring without stiffness is a damper.
            false => (k.is_finite() && k >= T::zero(), "zero or positive [N/m]"),
        };
        demand(fits, format!("{}.stiffness", line.name), k, wanted)?;
        demand(
            c.is_finite() && c >= T::zero(),
            format!("{}.damping", line.name),
            c,
            "zero or positive [N s/m]",
        )?;
        demand(
            l.is_finite() && l >= T::zero(),
            format!("{}.free_length", line.name),
            l,
            "zero or positive [m]",
        )?;
    }
    Ok(())
}

/// What acts along joint coordinates: every number by its rule, stops with a stiffness and in order.
fn check_along<T: Float>(scene: &Scene, params: &[T]) -> Result<(), ParamError> {
    for (index, joint) in scene.joints.iter().enumerate() {
        for forces in &joint.forces {
            let Some((_, coordinate)) = scene.coordinate(index, forces.coordinate) else {
                continue;
            };
            let value = |formula: &Formula| constant(scene, params, formula);
            let check = |field: &JointForceField, value: T| {
                let rule = field.of(&coordinate).rule;
                let what = format!("{}.{}.{}", joint.name, coordinate.name, field.name);
                demand(rule.holds(value.to_f64()), what, value, rule.words())
            };
            if let Some(filter) = &forces.filter {
                let time = value(&filter.time);
                demand(
                    time.is_finite() && time > T::zero(),
                    format!("{}.{}.{FILTER}", joint.name, coordinate.name),
                    time,
                    "positive [s]",
                )?;
            }
            for (field, formula) in NUMBERS.iter().zip(forces.numbers()) {
                let needed = match field.name {
                    "friction_rate" => forces.friction.is_some(),
                    "stop_stiffness" => forces.stops.iter().any(Option::is_some),
                    _ => false,
                };
                match formula {
                    Some(formula) => check(field, value(formula))?,
                    None if needed => check(field, T::from_f64(f64::NAN))?,
                    None => {}
                }
            }
            let stops = forces.stops.each_ref().map(|stop| stop.as_ref().map(value));
            for stop in stops.into_iter().flatten() {
                check(&STOPS, stop)?;
            }
            if let [Some(low), Some(_)] = stops
                && !in_order(stops.map(|stop| stop.map(Float::to_f64)))
            {
                let what = format!("{}.{}.stops", joint.name, coordinate.name);
                return demand(false, what, low, STOP_ORDER);
            }
        }
    }
    Ok(())
}

/// An error unless a demand holds.
fn demand<T: Float>(
    holds: bool,
    what: String,
    value: T,
    rule: &'static str,
) -> Result<(), ParamError> {
    if holds {
        return Ok(());
    }
    Err(ParamError::NotPhysical {
        what,
        value: value.to_f64(),
        rule,
    })
}
