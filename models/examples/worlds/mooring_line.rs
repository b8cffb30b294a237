//! A chain that hangs from the fairlead of a platform to an anchor, in 24 elastic pieces with their weight at the knots between them.
//!
//! For the horizontal pull H and the vertical one V at the fairlead, an elastic catenary of length S, weight w a metre and stiffness EA spans
//! `x = H/w (asinh(V/H) − asinh((V − w S)/H)) + H S/EA`, `z = (√(H² + V²) − √(H² + (V − w S)²))/w + (V S − w S²/2)/EA`.

use mbd_runtime::{TrimError, Trimmed, model, trim};

use crate::Outcome;

model! {
    /// A platform that is held in surge by one line of 400 m.
    model MooringLine {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input push: force;
        const PIECES = 24;
        const piece = 400 m / PIECES;
        const weight = 800 N/m;
        const stiffness = 200 MN;
        world { frame anchor at [-350.0, 0.0, -150.0] m }
        body platform {
            mass: 5e6 kg,
            inertia: diag(1e9, 1e9, 1e9) kg*m^2,
            frame fairlead at [-20.0, 0.0, 0.0] m,
        }
        joint surge: prismatic from world to platform.com { axis: x, force: push }
        point knot[i in 0..PIECES - 1] { equilibrium: static }
        load own[i in 0..PIECES - 1] on knot[i] = [0 N, 0 N, -weight * piece];
        line low from world.anchor to knot[0] { free_length: piece, stiffness: stiffness / piece }
        line chain[i in 1..PIECES - 1] from knot[i - 1] to knot[i] {
            free_length: piece,
            stiffness: stiffness / piece,
        }
        line top from knot[PIECES - 2] to platform.fairlead {
            free_length: piece,
            stiffness: stiffness / piece,
        }
        output tension = top.tension in kN;
    }
}

/// The force that holds the platform at an offset [m], found from knots on a straight line.
fn held(model: &MooringLine, offset: f64) -> Result<Trimmed, TrimError> {
    let straight = (1..24).flat_map(|knot| {
        let part = f64::from(knot) / 24.0;
        [-350.0 + part * (330.0 + offset), 0.0, -150.0 * (1.0 - part)]
    });
    let straight: Vec<f64> = straight.collect();
    trim(model)
        .fix("surge.slide", offset)
        .free_input("push")
        .nodes(&straight)
        .solve()
}

/// H and V at the fairlead of the catenary to an offset [m], by Newton steps.
fn catenary(offset: f64) -> [f64; 2] {
    let (length, w, stiffness) = (400.0, 800.0, 200e6);
    let span = |[h, v]: [f64; 2]| {
        let low = v - w * length;
        let x = h / w * ((v / h).asinh() - (low / h).asinh()) + h * length / stiffness;
        let z = (h.hypot(v) - h.hypot(low)) / w + (v - 0.5 * w * length) * length / stiffness;
        [x - 330.0 - offset, z - 150.0]
    };
    let mut at = [2e5, 3e5];
    for _ in 0..50 {
        let here = span(at);
        let by = [0, 1].map(|k| {
            let mut beside = at;
            beside[k] += 1.0;
            let there = span(beside);
            [there[0] - here[0], there[1] - here[1]]
        });
        let whole = by[0][0] * by[1][1] - by[0][1] * by[1][0];
        at[0] -= (here[0] * by[1][1] - here[1] * by[1][0]) / whole;
        at[1] -= (here[1] * by[0][0] - here[0] * by[0][1]) / whole;
    }
    at
}

/// Prints what holds the platform at some offsets beside the catenary.
pub fn run() -> Outcome {
    let model = MooringLine::new(MooringLineParams::default())?;
    println!("offset [m]  pull [kN]  catenary [kN]");
    for offset in [0.0, 5.0, 10.0, 15.0, 20.0] {
        let push = 1e-3 * held(&model, offset)?.inputs[0];
        println!(
            "{offset:10.1}  {push:9.2}  {:13.2}",
            1e-3 * catenary(offset)[0]
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where pieces with weights between them end for the pull at the lower end, from the anchor.
    fn polygon([h, v]: [f64; 2]) -> [f64; 2] {
        let piece = 400.0 / 24.0;
        let mut end = [0.0; 2];
        for k in 0..24 {
            let pull = [h, v + 800.0 * piece * f64::from(k)];
            let tension = pull[0].hypot(pull[1]);
            let length = piece * (1.0 + tension / 200e6);
            end = [0, 1].map(|i| end[i] + length * pull[i] / tension);
        }
        end
    }

    #[test]
    fn the_line_holds_the_platform_as_its_polygon_and_nearly_as_a_catenary() {
        let model = MooringLine::new(MooringLineParams::default()).unwrap();
        for offset in [0.0, 10.0, 20.0] {
            let found = held(&model, offset).unwrap();
            let piece = 400.0 / 24.0;
            // The pull of the lowest piece, from the place of its upper end.
            let arm = [found.nodes[0] + 350.0, found.nodes[2] + 150.0];
            let length = arm[0].hypot(arm[1]);
            let tension = 200e6 * (length / piece - 1.0);
            let pull = arm.map(|x| tension * x / length);
            assert!((pull[0] / found.inputs[0] - 1.0).abs() < 1e-7, "{pull:?}");
            let end = polygon(pull);
            assert!((end[0] - 330.0 - offset).abs() < 1e-5, "{end:?}");
            assert!((end[1] - 150.0).abs() < 1e-5, "{end:?}");
            // Half a piece of the weight at each end is missing: an error of the square of their number.
            let [h, v] = catenary(offset);
            assert!((pull[0] / h - 1.0).abs() < 5e-3, "{} {h}", pull[0]);
            let top = pull[1] + 23.0 * 800.0 * piece + 0.5 * 800.0 * piece;
            assert!((top / v - 1.0).abs() < 5e-3, "{top} {v}");
        }
    }
}
