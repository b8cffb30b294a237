//! Where couplings put coordinates that nobody gives: a gear with an offset does not hold with all of them at zero.
//!
//! ```text
//! Σ f x = c      x_d = −(Σ' f x − c)/f_d,   u_d = −Σ' f u/f_d          Σ' without the coordinate d that follows                  (1)
//! ```
//!
//! What is said of a coordinate stays, and what a motor drives stays where it is driven to; of a coupling that names neither the coordinate that it is
//! written for follows, `to` of a gear, and the others stay at zero. Trains of couplings follow from there, or from the coordinate that follows none, in
//! whatever order they are declared. A row that angles are part of holds modulo their turns (`laws/coupling.rs`); here the relation holds as
//! it is written, so that a rack stands where its offset says and not at the tooth next to zero.

use std::f64::consts::TAU;

use super::{JointStart, Placement};

impl Placement<'_> {
    /// Sets the coordinates that follow those of which the value is said, by (1), and their rates where nothing is said of these.
    pub(super) fn follow_couplings(&mut self, said: &[JointStart]) {
        let of = |start: &JointStart| (start.joint, start.coordinate);
        let values = said.iter().filter(|start| start.value.is_some());
        let mut named: Vec<(usize, usize)> = values.map(of).collect();
        let rates = said.iter().filter(|start| start.rate.is_some());
        let rates: Vec<(usize, usize)> = rates.map(of).collect();
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
            let leads = |(own, all): &(usize, &[(usize, usize)])| {
                let mut others = couplings.iter().filter(|(other, _)| other != own);
                others.all(|(_, of)| !all.iter().skip(1).any(|from| of.first() == Some(from)))
            };
            let next = couplings.iter().position(follows);
            let next = next.or_else(|| couplings.iter().position(leads));
            let (joint, all) = couplings.remove(next.unwrap_or_default());
            let follower = all
                .iter()
                .position(|coordinate| !named.contains(coordinate));
            named.extend_from_slice(all);
            if let Some(follower) = follower {
                let keeps_rate = all.get(follower).is_some_and(|it| rates.contains(it));
                self.follow(joint, all, follower, keeps_rate);
            }
        }
    }

    /// (1) for one coupling.
    fn follow(&mut self, joint: usize, all: &[(usize, usize)], follower: usize, keeps_rate: bool) {
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
        let Some(&(of, index)) = all.get(follower) else {
            return;
        };
        let periodic = (self.scene.coordinate(of, index)).is_some_and(|(_, it)| it.is_periodic());
        let [by_value, by_rate] = [coupling.off(sum(&self.q)) / factor, sum(&self.u) / factor];
        if let Some(value) = self.q.get_mut(of).and_then(|list| list.get_mut(index))
            && by_value.is_finite()
        {
            *value -= by_value;
            if periodic {
                *value -= TAU * (*value / TAU).round();
            }
        }
        if let Some(rate) = self.u.get_mut(of).and_then(|list| list.get_mut(index))
            && by_rate.is_finite()
            && !keeps_rate
        {
            *rate -= by_rate;
        }
    }
}
