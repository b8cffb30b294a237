//! What can be asked of a scene in outputs and events, by name: for `mbd list quantities`.

use mbd_compiler::quantities::Reach::{self, Everywhere, Results};
use mbd_compiler::quantities::{
    AXES, BODY, ENERGY, ENERGY_WORD, JOINT, LINE, PLACE, PLANAR_BODY, ThingQuantity,
};
use mbd_runtime::scene::joints::Measured;
use mbd_runtime::scene::{Body, Gravity, Joint, PointKind, Scene};
use serde_json::{Value, json};

use mbd_report::ReportTable;

/// Something that can be asked.
#[derive(Clone, Debug)]
pub struct RequestedQuantity {
    /// How it is written.
    pub name: String,
    /// Its SI unit; empty for a pure number.
    pub unit: String,
    /// 1, or 3 for a vector.
    pub components: usize,
    /// What it is.
    pub what: &'static str,
    /// Where it may stand.
    pub reach: Reach,
}

impl RequestedQuantity {
    /// Where it may stand.
    fn stands_in(&self) -> &'static str {
        match self.reach {
            Everywhere => "everything",
            Results => "outputs, metrics, events",
        }
    }

    /// For a program.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "name": self.name, "unit": self.unit, "components": self.components, "what": self.what, "stands_in": self.stands_in(),
        })
    }
}

/// Everything that can be asked of a scene, thing by thing in the order of the declaration.
#[must_use]
pub fn asked(scene: &Scene) -> Vec<RequestedQuantity> {
    let mut all = vec![RequestedQuantity {
        unit: "s".to_owned(),
        ..number("time", 1, "time", Everywhere)
    }];
    for input in &scene.inputs {
        all.push(RequestedQuantity {
            unit: input.unit.text.clone(),
            ..number(&input.name, input.components, "input", Everywhere)
        });
    }
    for state in &scene.states {
        all.push(RequestedQuantity {
            unit: state.unit.text.clone(),
            ..number(&state.name, 1, "state", Everywhere)
        });
    }
    // A field that the caller supplies has no potential.
    let stored = match scene.gravity {
        Gravity::Field => 1,
        _ => ENERGY.len(),
    };
    of_thing(&mut all, ENERGY_WORD, &ENERGY[..stored]);
    for body in &scene.bodies {
        of_body(&mut all, body);
        if scene.planar.is_some() {
            of_thing(&mut all, &body.name, &PLANAR_BODY);
        }
    }
    for point in &scene.points {
        let count = match point.kind {
            PointKind::Mass(_) => 3,
            PointKind::Node(_) => 2,
        };
        of_thing(&mut all, &point.name, &PLACE[..count]);
    }
    scene
        .lines
        .iter()
        .for_each(|line| of_thing(&mut all, &line.name, &LINE));
    scene
        .joints
        .iter()
        .for_each(|joint| of_joint(&mut all, joint));
    all
}

/// A quantity of a thing.
fn of(thing: &str, known: &ThingQuantity) -> RequestedQuantity {
    let name = format!("{thing}.{}", known.word);
    RequestedQuantity {
        unit: known.unit.to_owned(),
        ..number(&name, known.components, known.what, known.reach)
    }
}

/// A quantity without a unit.
fn number(name: &str, components: usize, what: &'static str, reach: Reach) -> RequestedQuantity {
    RequestedQuantity {
        name: name.to_owned(),
        unit: String::new(),
        components,
        what,
        reach,
    }
}

fn of_thing(all: &mut Vec<RequestedQuantity>, name: &str, known: &[ThingQuantity]) {
    all.extend(known.iter().map(|known| of(name, known)));
}

fn of_body(all: &mut Vec<RequestedQuantity>, body: &Body) {
    of_thing(all, &body.name, &PLACE);
    of_thing(all, &body.name, &AXES);
    of_thing(all, &body.name, &BODY);
    for frame in body.frames.iter().skip(1) {
        let name = format!("{}.{}", body.name, frame.name);
        of_thing(all, &name, &PLACE);
        of_thing(all, &name, &AXES);
    }
}

fn of_joint(all: &mut Vec<RequestedQuantity>, joint: &Joint) {
    for (index, coordinate) in joint.law.measured().enumerate() {
        let mut add = |word: &str, measured: Measured, what: &'static str, reach: Reach| {
            all.push(RequestedQuantity {
                unit: measured.unit(&coordinate).to_owned(),
                ..number(&format!("{}.{word}", joint.name), 1, what, reach)
            });
        };
        add(
            coordinate.name,
            Measured::Value,
            "joint coordinate",
            Everywhere,
        );
        add(coordinate.rate, Measured::Rate, "its rate", Everywhere);
        let second = format!("{}_acceleration", coordinate.name);
        add(&second, Measured::Acceleration, "its second rate", Results);
        if joint.motors().any(|(driven, _)| driven == index) {
            let word = joint.law.motor_word(&coordinate);
            let what = "effort of the motor along the coordinate";
            add(&word, Measured::Force, what, Results);
        }
    }
    of_thing(all, &joint.name, &JOINT);
}

/// The table of `mbd list quantities`.
#[must_use]
pub fn table(scene: &Scene) -> ReportTable {
    let title = format!("Quantities of {}", scene.name);
    let mut table = ReportTable::new(title)
        .column("name", "")
        .column("unit", "")
        .column("components", "")
        .column("what", "")
        .column("stands in", "");
    for one in asked(scene) {
        let unit = if one.unit.is_empty() { "1" } else { &one.unit };
        table.push([
            one.name.as_str().into(),
            unit.into(),
            one.components.into(),
            one.what.into(),
            one.stands_in().into(),
        ]);
    }
    table.note(
        "components of a vector: `.x`, `.y`, `.z`; `output NAME = expression;` makes a column"
            .to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::{Reach, asked};

    const DECLARATION: &str = "model All {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input wish: angle;
        input wind: [speed; 3];
        state paid = 2 m { rate: 0.1 m/s }
        body hub[i in 0..2] { mass: 2.0 kg, inertia: diag(0.2, 0.2, 0.2) kg*m^2, frame rim[k in 0..2] at [0.1 * k, 0, 0.1] m }
        point bob { mass: 1.0 kg }
        point knot { equilibrium: static }
        joint pin[i in 0..2]: hinge from world to hub[i].com { axis: z, motor: wish, filter: 20 ms }
        body sleeve { mass: 2.0 kg, inertia: diag(0.2, 0.2, 0.2) kg*m^2 }
        joint tube: cylindrical from world to sleeve.com { axis: z, slide: { motor: 1 m/s * time }, angle: { motor: wish, filter: 10 ms } }
        line rope from world to bob { free_length: paid, stiffness: 1 kN/m }
        line upper from world to knot { free_length: 1 m, stiffness: 1 kN/m }
        line lower from knot to bob { free_length: 1 m, stiffness: 1 kN/m }
        load blow on bob = wind * 1 kg/s;
        body gate { mass: 2.0 kg, inertia: diag(0.2, 0.2, 0.2) kg*m^2 }
        joint latch: hinge from world to gate.com { axis: y }
        event shut = latch.angle rises 1 rad { lock: latch }
    ";

    #[test]
    fn every_quantity_that_is_listed_can_be_asked_and_has_the_unit_that_is_listed() {
        let read = |outputs: &str| mbd_compiler::read_text(&format!("{DECLARATION}{outputs}}}"));
        let scene = read("").scene.expect("a scene");
        let all = asked(&scene);
        assert!(all.len() > 60, "{}", all.len());
        assert!(all.iter().any(|one| one.name == "latch.angle.lock.torque"));
        let outputs: Vec<String> = all
            .iter()
            .enumerate()
            .map(|(k, one)| format!("output asked{k} = {};\n", one.name))
            .collect();
        let reading = read(&outputs.concat());
        let Some(scene) = reading.scene else {
            panic!("{:?}", reading.errors)
        };
        for (output, one) in scene.outputs.iter().zip(&all) {
            assert_eq!(output.components, one.components, "{}", one.name);
            assert_eq!(output.unit.text, one.unit, "{}", one.name);
        }
        // What follows from the accelerations is refused where they depend on it.
        let result = all.iter().find(|one| one.reach == Reach::Results);
        let result = result.map(|one| one.name.clone()).expect("accelerations");
        let load = format!("load wrong on bob = 1 kg * {result};\n");
        assert!(read(&load).scene.is_none(), "{result}");
    }
}
