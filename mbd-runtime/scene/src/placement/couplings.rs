//! Where couplings put coordinates that nobody gives: a gear with an offset does not hold with all of them at zero.
//!
//! ```text
//! Σ f x = c      x_d = −(Σ' f x − c)/f_d,   u_d = −Σ' f u/f_d          Σ' without the coordinate d that follows                  (1)
//! ```
//!
//! What a motor drives stays where it is driven to; of a coupling that names nothing driven the coordinate that it is written for follows, `to` of a
//! gear, and the others stay at zero. Trains of couplings follow from there, in whatever order they are declared, as the speeds of the tree do
//! (`plan/relative.rs`).

use super::{JointStart, Placement};

impl Placement<'_> {
    /// Sets the coordinates that follow, by (1).
    pub(super) fn follow_couplings(&mut self, motors: &[JointStart]) {
        let driven = motors.iter().map(|motor| (motor.joint, motor.coordinate));
        let mut named: Vec<(usize, usize)> = driven.collect();
        let scene = self.scene;
        let joints = scene.joints.iter().enumerate();
        let couplings = joints.filter(|(joint, declared)| {
            let couples = declared.law.couples();
            let placed = |&(of, _): &(usize, usize)| self.links.iter().any(|own| own.joint == of);
            !couples.is_empty() && couples.iter().all(placed) && self.layout.starts_joined(*joint)
        });
        let couplings = couplings.map(|(joint, declared)| (joint, declared.law.couples()));
        let mut couplings: Vec<(usize, &[(usize, usize)])> = couplings.collect();
        while !couplings.is_empty() {
            let follows = |(_, all): &(usize, &[(usize, usize)])| {
                all.iter().any(|coordinate| named.contains(coordinate))
            };
            let next = couplings.iter().position(follows);
            let (joint, all) = couplings.remove(next.unwrap_or_default());
            let follower = all
                .iter()
                .position(|coordinate| !named.contains(coordinate));
            named.extend_from_slice(all);
            if let Some(follower) = follower {
                self.follow(joint, all, follower);
            }
        }
    }

    /// (1) for one coupling.
    fn follow(&mut self, joint: usize, all: &[(usize, usize)], follower: usize) {
        let Some(Some(coupling)) = self.numbers.couplings.get(joint) else {
            return;
        };
        let sum = |lists: &[Vec<f64>]| -> f64 {
            let number = |&(of, index): &(usize, usize)| lists.get(of)?.get(index).copied();
            let terms = all.iter().enumerate();
            terms
                .map(|(at, coordinate)| {
                    coupling.factor(at) * number(coordinate).unwrap_or_default()
                })
                .sum()
        };
        let factor = coupling.factor(follower);
        let moves = [coupling.value(sum(&self.q)) / factor, sum(&self.u) / factor];
        let Some(&(of, index)) = all.get(follower) else {
            return;
        };
        for (list, by) in [&mut self.q, &mut self.u].into_iter().zip(moves) {
            let slot = list.get_mut(of).and_then(|list| list.get_mut(index));
            if let (Some(slot), true) = (slot, by.is_finite()) {
                *slot -= by;
            }
        }
    }
}
