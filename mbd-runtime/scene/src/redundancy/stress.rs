//! Forces in balance that move nothing: which joints carry them, and in which components of their reactions.

use nalgebra::Vector3;

use crate::Part;
use crate::redundancy::assembly::{JointRow, LinearisedState};
use crate::redundancy::choice::SpanRow;
use crate::redundancy::local::PartMotion;
use crate::redundancy::tree::LoopGroup;
use crate::scalar::orthogonal::dot;

/// Part of a self-stress from which on a joint, or a component of its reaction, takes part in it.
const INVOLVED: f64 = 1e-6;

/// A self-stress: one unit of a row that repeats others, and what of these balances it.
pub struct SelfStress {
    /// The joints that carry it, those of motors among them, in order.
    pub joints: Vec<usize>,
    /// The components of reactions that it changes, by joint: the force on the child, then the torque about the origin of frame 2, world axes.
    pub changed: Vec<(usize, [bool; 6])>,
}

impl SelfStress {
    /// Of a row and the kept rows, each with the part of it that is made of that row.
    pub fn new<'a>(
        group: &LoopGroup,
        state: &LinearisedState,
        row: SpanRow,
        kept: impl Iterator<Item = (&'a SpanRow, &'a f64)>,
    ) -> Self {
        let mut forces = Forces::new(group);
        forces.put(group, state, row, 1.0);
        for (&row, &part) in kept {
            forces.put(group, state, row, part);
        }
        forces.carry(group, state);
        forces.stress(state.length)
    }
}

/// What a joint carries.
struct JointStress {
    joint: usize,
    /// The largest force of a row, or the force that its rows add up to.
    size: f64,
    /// On its child: a force and a torque.
    on_child: [Vector3<f64>; 2],
}

/// Forces on the parts of a group, and in the joints.
struct Forces {
    parts: Vec<(Part, PartMotion)>,
    carried: Vec<JointStress>,
}

impl Forces {
    fn new(group: &LoopGroup) -> Self {
        let links = group.links.iter().map(|link| link.to);
        let parts = group.roots.iter().copied().chain(links);
        Forces {
            parts: parts.map(|part| (part, [0.0; 6])).collect(),
            carried: Vec::new(),
        }
    }

    fn push(&mut self, part: Part, times: f64, columns: &PartMotion) {
        let own = self.parts.iter_mut().find(|(own, _)| *own == part);
        if let Some((_, force)) = own {
            force
                .iter_mut()
                .zip(columns)
                .for_each(|(f, c)| *f += times * c);
        }
    }

    fn of(&mut self, joint: usize) -> &mut JointStress {
        let found = self.carried.iter().position(|of| of.joint == joint);
        let at = found.unwrap_or(self.carried.len());
        if found.is_none() {
            self.carried.push(JointStress {
                joint,
                size: 0.0,
                on_child: [Vector3::zeros(); 2],
            });
        }
        &mut self.carried[at]
    }

    /// Lets a row, divided by its size, push with a multiplier.
    fn put(&mut self, group: &LoopGroup, state: &LinearisedState, which: SpanRow, times: f64) {
        let (joint, row) = match which {
            SpanRow::Closing(place, row) => {
                let rows = state.closing_rows.get(place);
                let row = rows.and_then(|rows| rows.get(row));
                (group.closing.get(place).copied(), row)
            }
            SpanRow::Motor(index) => {
                let motor = state.motors.get(index);
                (
                    motor.map(|motor| motor.joint),
                    motor.map(|motor| &motor.row),
                )
            }
        };
        let (Some(joint), Some(row)) = (joint, row) else {
            return;
        };
        let each = times / row.size;
        for (part, columns) in &row.parts {
            self.push(*part, each, columns);
        }
        let carried = self.of(joint);
        carried.size = carried.size.max(times.abs());
        carried.add(row, each);
    }

    /// Lets the joints of the tree carry the forces, from the outermost inwards.
    fn carry(&mut self, group: &LoopGroup, state: &LinearisedState) {
        for (link, (rows, hold)) in group.links.iter().zip(&state.links).rev() {
            let on = self.parts.iter().find(|(part, _)| *part == link.to);
            let force = on.map_or([0.0; 6], |(_, force)| *force);
            let multipliers = hold.multipliers(&force);
            let carried = self.of(link.joint);
            carried.size = carried.size.max(dot(&force, &force).sqrt());
            for (row, times) in rows.iter().zip(multipliers) {
                carried.add(row, -times);
            }
            let Some(from) = link.from else { continue };
            for (row, times) in rows.iter().zip(multipliers) {
                self.push(from, -times, &row.on(link.from));
            }
        }
    }

    /// What is in balance now; `length` weighs torques.
    fn stress(self, length: f64) -> SelfStress {
        let most = self
            .carried
            .iter()
            .fold(0.0, |most: f64, of| most.max(of.size));
        let involved = self.carried.iter().filter(|of| of.size > INVOLVED * most);
        let mut joints: Vec<usize> = involved.map(|of| of.joint).collect();
        joints.sort_unstable();
        let components = |of: &JointStress| -> [f64; 6] {
            let [force, torque] = [of.on_child[0], of.on_child[1] / length];
            std::array::from_fn(|k| if k < 3 { force[k] } else { torque[k - 3] }.abs())
        };
        let all = self.carried.iter().flat_map(components);
        let most = all.fold(0.0, f64::max);
        let changed = self.carried.iter().map(|of| {
            let changed = components(of).map(|component| component > INVOLVED * most);
            (of.joint, changed)
        });
        SelfStress {
            joints,
            changed: changed.collect(),
        }
    }
}

impl JointStress {
    fn add(&mut self, row: &JointRow, times: f64) {
        for (sum, part) in self.on_child.iter_mut().zip(&row.on_child) {
            *sum += times * part;
        }
    }
}
