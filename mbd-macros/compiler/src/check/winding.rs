//! Lines that are wound: nothing that gives the rate of a free length may depend on that rate.

use mbd_scene::{Formula, Scene};

/// The lines whose rate of winding depends on itself, each with a state through which it does.
///
/// The rate follows from the rates of the states in the free length. Where such a rate reads the stretch rate of a line, or the tension of one
/// that is damped, it needs how that line is wound.
pub fn wound_by_themselves(scene: &Scene) -> Vec<(usize, String)> {
    let needs: Vec<Vec<(usize, usize)>> = (0..scene.lines.len())
        .map(|line| needed(scene, line))
        .collect();
    let mut found = Vec::new();
    for line in 0..needs.len() {
        let mut reached: Vec<(usize, usize)> = needs[line].clone();
        let mut next = 0;
        while let Some(&(other, state)) = reached.get(next) {
            next += 1;
            if other == line {
                let name = scene.states.get(state).map(|state| state.name.clone());
                found.push((line, name.unwrap_or_default()));
                break;
            }
            for &(further, _) in needs.get(other).into_iter().flatten() {
                if reached.iter().all(|(known, _)| *known != further) {
                    reached.push((further, state));
                }
            }
        }
    }
    found
}

/// The lines that the rate of winding of a line depends on, each with the state through which it does.
fn needed(scene: &Scene, line: usize) -> Vec<(usize, usize)> {
    let mut lines = Vec::new();
    let Some(declared) = scene.lines.get(line) else {
        return lines;
    };
    let (length, rate) = declared.free_length_and_rate();
    if rate.is_some() {
        return lines;
    }
    let mut states = Vec::new();
    scene.walk(length, &mut |part| {
        if let Formula::State(state) = part {
            states.push(*state);
        }
    });
    for state in states {
        let Some(declared) = scene.states.get(state) else {
            continue;
        };
        scene.walk(&declared.rate, &mut |part| {
            let other = match part {
                Formula::StretchRate(other) => *other,
                Formula::Tension(other) => {
                    let other_line = scene.lines.get(*other);
                    if other_line.is_none_or(|line| scene.is_zero(&line.damping)) {
                        return;
                    }
                    *other
                }
                _ => return,
            };
            lines.push((other, state));
        });
    }
    lines
}
