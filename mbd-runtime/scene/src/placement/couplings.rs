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

use super::{JointStart, Placement};
use crate::laws::Coupling;
use crate::{Layout, Scene};

/// A coordinate of a joint, by its number.
type CoupledCoordinate = (usize, usize);

/// A coordinate that follows.
pub(crate) struct Follower<'a> {
    /// The coupling.
    joint: usize,
    all: &'a [CoupledCoordinate],
    /// Which of its coordinates.
    number: usize,
}

/// The coordinates that follow those that are `named`, in the order in which they do; of couplings that only take coordinates that are `placed`.
pub(crate) fn followers<'a>(
    (scene, layout): (&'a Scene, &Layout),
    mut named: Vec<CoupledCoordinate>,
    placed: &dyn Fn(usize) -> bool,
) -> Vec<Follower<'a>> {
    let joints = scene.joints.iter().enumerate();
    let couplings = joints.filter(|(joint, declared)| {
        let couples = declared.law.couples();
        let placed = |&(of, _): &CoupledCoordinate| placed(of);
        !couples.is_empty() && couples.iter().all(placed) && layout.starts_joined(*joint)
    });
    let couplings = couplings.map(|(joint, declared)| (joint, declared.law.couples()));
    let mut couplings: Vec<(usize, &[CoupledCoordinate])> = couplings.collect();
    let mut found = Vec::new();
    while !couplings.is_empty() {
        let follows = |(_, all): &(usize, &[CoupledCoordinate])| {
            all.iter().any(|coordinate| named.contains(coordinate))
        };
        let leads = |(own, all): &(usize, &[CoupledCoordinate])| {
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
        found.extend(follower.map(|number| Follower { joint, all, number }));
    }
    found
}

impl Follower<'_> {
    /// The coordinate.
    pub(crate) fn coordinate(&self) -> Option<CoupledCoordinate> {
        self.all.get(self.number).copied()
    }

    /// What is taken off its value, and off its rate, by (1).
    pub(crate) fn off(
        &self,
        couplings: &[Option<Coupling<f64>>],
        [value, rate]: [&dyn Fn(CoupledCoordinate) -> f64; 2],
    ) -> Option<[f64; 2]> {
        let coupling = couplings.get(self.joint)?.as_ref()?;
        let sum = |of: &dyn Fn(CoupledCoordinate) -> f64| -> f64 {
            let terms = self.all.iter().enumerate();
            terms
                .map(|(at, coordinate)| coupling.factor(at) * of(*coordinate))
                .sum()
        };
        let factor = coupling.factor(self.number);
        Some([coupling.off(sum(value)) / factor, sum(rate) / factor])
    }
}

impl Placement<'_> {
    /// Sets the coordinates that follow those of which the value is said, by (1), and their rates where nothing is said of these.
    pub(super) fn follow_couplings(&mut self, said: &[JointStart]) {
        let of = |start: &JointStart| (start.joint, start.coordinate);
        let values = said.iter().filter(|start| start.value.is_some());
        let rates = said.iter().filter(|start| start.rate.is_some());
        let rates: Vec<CoupledCoordinate> = rates.map(of).collect();
        let scene = (self.scene, self.layout);
        let placed = |of: usize| self.links.iter().any(|own| own.joint == of);
        for follower in followers(scene, values.map(of).collect(), &placed) {
            let number = |lists: &[Vec<f64>], (of, index): CoupledCoordinate| {
                let number = lists.get(of).and_then(|list| list.get(index));
                number.copied().unwrap_or_default()
            };
            let value = |coordinate: CoupledCoordinate| number(&self.q, coordinate);
            let rate = |coordinate: CoupledCoordinate| number(&self.u, coordinate);
            let off = follower.off(&self.numbers.couplings, [&value, &rate]);
            let (Some([by_value, by_rate]), Some((of, index))) = (off, follower.coordinate())
            else {
                continue;
            };
            if let Some(value) = self.q.get_mut(of).and_then(|list| list.get_mut(index))
                && by_value.is_finite()
            {
                *value -= by_value;
            }
            if let Some(rate) = self.u.get_mut(of).and_then(|list| list.get_mut(index))
                && by_rate.is_finite()
                && !rates.contains(&(of, index))
            {
                *rate -= by_rate;
            }
        }
    }
}
