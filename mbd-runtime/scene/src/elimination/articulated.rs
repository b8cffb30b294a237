//! A body and its parent joint, taken out of the system together: the articulated-body recursion, on the constraints and off them.
//!
//! ```text
//! a_c = Σ X_o a_o + ν + H u            o: the parent of the body, and others that it is coupled to            (1)
//! U = I_a h,  D = hᵀ U,  u = (hᵀ p − Uᵀ a − …)/D;   I_a −= U Uᵀ/D,  p −= U hᵀ p/D     for each column h of H   (2)
//! K_oo′ += X_oᵀ P_o′ + C_o X_o′,  P_o = I_a X_o + C_oᵀ                                                         (3)
//! p_o += X_oᵀ (p − I_a ν) − C_o ν                                                                              (4)
//! push = p − I_a a_c − Σ C_oᵀ a_o      what the joint pushes the body with                                     (5)
//! ```
//!
//! a is the acceleration of a node, I_a the block of the body, p its right-hand side, C_o its coupling to another node (zero on a tree),
//! ν = N γ what the rows ask for. X is that of the parent alone: a body that a joint lets turn is rigidly attached at the joint's point, up to H. After (2) I_a is the
//! inertia that the joint hands inboard, and I_a h is zero; where h is a unit vector its row and column are left out. All of this is in the
//! axes of the joint where it states some: the columns of T, ω = T ω_T.
//! Source: Featherstone, Rigid Body Dynamics Algorithms, articulated-body algorithm.

use nalgebra::Matrix3;

use crate::elimination::system::BlockSystem;
use crate::{Below, Elimination, EliminationStep, Part, Real};

/// Most speeds of a body.
const MOST: usize = 6;

/// A node of the system that leaves: a body with its parent joint, or any node by itself.
#[derive(Clone, Copy)]
struct LeavingNode<'a> {
    step: &'a EliminationStep,
    /// The parent joint of a body that leaves with it.
    joint: Option<&'a EliminationStep>,
    /// Number of free columns: all unknowns of a node by itself.
    free: usize,
    /// Number of unknowns.
    size: usize,
    /// Whether the parent joint states axes.
    axes: bool,
}

impl<'a> LeavingNode<'a> {
    fn new(plan: &'a Elimination, index: usize) -> Option<Self> {
        let step = plan.steps.get(index).filter(|step| !step.paired)?;
        let size = step.size;
        Some(match step.carrying {
            Some(carrying) => LeavingNode {
                step,
                joint: plan.steps.get(index + 1),
                free: carrying.free,
                size,
                axes: carrying.axes && size == MOST,
            },
            None => LeavingNode {
                step,
                joint: None,
                free: size,
                size,
                axes: false,
            },
        })
    }

    /// A body and its parent joint.
    fn pair(plan: &'a Elimination, body: usize) -> Option<(Self, &'a EliminationStep)> {
        let node = LeavingNode::new(plan, body)?;
        Some((node, node.joint?))
    }

    /// Couplings to others than the parent joint, which is the next step and so the first of all.
    fn others(&self) -> &'a [Below] {
        let own = usize::from(self.joint.is_some());
        self.step.below.get(own..).unwrap_or_default()
    }

    /// Where the products of a coupling with the others up to itself go.
    fn targets(&self, below: &'a Below) -> &'a [usize] {
        let own = usize::from(self.joint.is_some());
        below.targets.get(own..).unwrap_or_default()
    }

    /// The coupling to a node, if there is one.
    fn coupling(&self, step: usize) -> Option<&'a Below> {
        self.others().iter().find(|below| below.step == step)
    }

    /// The beginnings of the rows of a coupling.
    fn rows(&self, plan: &Elimination, below: &Below) -> impl Iterator<Item = usize> + use<> {
        let (at, size) = (below.at, self.size);
        (0..plan.steps[below.step].size).map(move |row| at + size * row)
    }

    /// Where U/D of a column is in the scaled store.
    fn row(&self, column: usize) -> usize {
        self.step.diagonal + self.size * column
    }

    /// Whether nothing else is multiplied by the inverse of a column's pivot: it is not needed then.
    fn is_alone(&self, k: usize) -> bool {
        self.joint.is_none() && self.others().is_empty() && k + 1 == self.free
    }

    /// Where T is in the store.
    fn axes_at(&self) -> Option<usize> {
        let joint = self.joint.filter(|_| self.axes)?;
        Some(joint.diagonal + (self.size + 1) * self.free)
    }
}

/// The list of a system that a number is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bank {
    Store,
    Scaled,
    Pivot,
    Inverse,
}

/// Tells every number that [`BlockSystem::solve`] reads of a factor.
pub(crate) fn factored(plan: &Elimination, each: &mut dyn FnMut(Bank, usize)) {
    for index in 0..plan.steps.len() {
        let Some(node) = LeavingNode::new(plan, index) else {
            continue;
        };
        if let Some(at) = node.axes_at() {
            (at..at + 9).for_each(|at| each(Bank::Store, at));
        }
        let (n, others) = (node.size, node.others());
        for k in 0..node.free {
            let bank = match node.is_alone(k) {
                true => Bank::Pivot,
                false => Bank::Inverse,
            };
            each(bank, node.step.first + k);
            (0..n).for_each(|i| each(Bank::Scaled, node.row(k) + i));
            let rows = others.iter().flat_map(|below| node.rows(plan, below));
            rows.for_each(|at| each(Bank::Scaled, at + k));
        }
        let Some(joint) = node.joint else {
            continue;
        };
        (0..n * node.free).for_each(|i| each(Bank::Store, joint.diagonal + i));
        (0..n * n).for_each(|i| each(Bank::Store, node.row(0) + i));
        for at in joint.below.iter().flat_map(|below| node.rows(plan, below)) {
            (at..at + n).for_each(|at| each(Bank::Scaled, at));
        }
        for at in others.iter().flat_map(|below| node.rows(plan, below)) {
            (at..at + n).for_each(|at| each(Bank::Store, at));
        }
    }
}

impl<S: Real> BlockSystem<S> {
    /// A number of the factor.
    pub(crate) fn factored(&self, bank: Bank, at: usize) -> S {
        match bank {
            Bank::Store => self.store[at],
            Bank::Scaled => self.scaled[at],
            Bank::Pivot => self.pivot[at],
            Bank::Inverse => self.inverse[at],
        }
    }

    /// Sets a number of the factor.
    pub(crate) fn set_factored(&mut self, bank: Bank, at: usize, value: S) {
        match bank {
            Bank::Store => self.store[at] = value,
            Bank::Scaled => self.scaled[at] = value,
            Bank::Pivot => self.pivot[at] = value,
            Bank::Inverse => self.inverse[at] = value,
        }
    }

    /// Sets element (i, j) of X of the body whose joint has this step, for the speeds j of its parent.
    pub fn set_transport(
        &mut self,
        plan: &Elimination,
        (joint, parent): (usize, usize),
        (i, j): (usize, usize),
        value: S,
    ) {
        let speeds = joint.checked_sub(1).and_then(|body| plan.steps.get(body));
        if let (Some(at), Some(body)) = (plan.block(parent, joint), speeds)
            && let Some(slot) = self.scaled.get_mut(at + body.size * j + i)
        {
            *slot = value;
        }
    }

    /// Sets a column of H of the body of a step, and what its pivot D is at least.
    pub fn set_free(
        &mut self,
        plan: &Elimination,
        body: usize,
        column: usize,
        values: impl Iterator<Item = S>,
        least: Option<S>,
    ) {
        let pair = LeavingNode::pair(plan, body).filter(|(node, _)| column < node.free);
        if let Some((node, joint)) = pair {
            let at = joint.diagonal + node.size * column;
            for (slot, value) in self.store[at..at + node.size].iter_mut().zip(values) {
                *slot = value;
            }
            let at = joint.diagonal + node.size * node.free + column;
            self.store[at] = least.unwrap_or_else(S::zero);
        }
    }

    /// Sets T, the axes of the parent joint of the body of a step.
    pub fn set_axes(&mut self, plan: &Elimination, body: usize, axes: &Matrix3<S>) {
        if let Some(at) = LeavingNode::new(plan, body).and_then(|node| node.axes_at()) {
            self.store[at..at + 9].copy_from_slice(axes.as_slice());
        }
    }

    /// T, where the parent joint states axes.
    fn axes(&self, node: &LeavingNode<'_>) -> Option<Matrix3<S>> {
        let at = node.axes_at()?;
        Some(Matrix3::from_column_slice(&self.store[at..at + 9]))
    }

    /// A free column, and what its pivot is at least; the unknown along which it is the only one, and the column is of length one.
    fn column(&self, node: &LeavingNode<'_>, k: usize) -> ([S; MOST], S, Option<usize>) {
        let mut h = [S::zero(); MOST];
        let Some(joint) = node.joint else {
            h[k] = S::one();
            return (h, S::zero(), Some(k));
        };
        let at = joint.diagonal + node.size * k;
        h[..node.size].copy_from_slice(&self.store[at..at + node.size]);
        let least = self.store[joint.diagonal + node.size * node.free + k];
        let mut own = (0..node.size).filter(|&i| !h[i].is_zero());
        let one = own.next().filter(|&i| h[i].is_one());
        let unit = one.filter(|_| own.next().is_none());
        (h, least, unit)
    }

    /// Factorises K by (1) of [`crate::elimination::system`]. `enter` hears which part comes next.
    pub fn factor(&mut self, plan: &Elimination, enter: &dyn Fn(Part)) {
        for (index, step) in plan.steps.iter().enumerate() {
            let Some(node) = LeavingNode::new(plan, index) else {
                continue;
            };
            enter(step.part);
            self.leave(plan, index);
            let mut inertia = self.inertia_of(&node);
            if let Some(axes) = self.axes(&node) {
                turn_inertia(&mut inertia, &axes);
                for at in node
                    .others()
                    .iter()
                    .flat_map(|below| node.rows(plan, below))
                {
                    turn(&mut self.store[at + 3..], &axes);
                }
            }
            for k in 0..node.free {
                self.release(plan, &node, k, &mut inertia);
            }
            if let Some(joint) = node.joint {
                for (i, row) in inertia.iter().enumerate().take(node.size) {
                    self.store[node.row(i)..node.row(i + 1)].copy_from_slice(&row[..node.size]);
                }
                self.hand_on(plan, &node, joint, &inertia);
            }
        }
    }

    /// The full diagonal block.
    fn inertia_of(&self, node: &LeavingNode<'_>) -> [[S; MOST]; MOST] {
        let inside = |i: usize, j: usize| i.max(j) < node.size;
        let at = |i: usize, j: usize| self.store[node.row(i.max(j)) + i.min(j)];
        std::array::from_fn(|i| {
            std::array::from_fn(|j| if inside(i, j) { at(i, j) } else { S::zero() })
        })
    }

    /// Takes a free column out, by (2): of I_a, of the couplings to others and of what these fill.
    fn release(
        &mut self,
        plan: &Elimination,
        node: &LeavingNode<'_>,
        k: usize,
        inertia: &mut [[S; MOST]; MOST],
    ) {
        let n = node.size;
        let (h, least, unit) = self.column(node, k);
        let along = |row: &[S]| sparse_dot(row, &h);
        let u: [S; MOST] = std::array::from_fn(|i| match node.joint {
            Some(_) => along(&inertia[i]).label("U"),
            None => inertia[i][k],
        });
        let mut pivot = along(&u);
        if !least.is_zero() {
            // Where much heavier bodies move the same way, rounding of what they leave may be more than all that is there.
            pivot = pivot.max(least);
        }
        if node.joint.is_some() {
            pivot = pivot.label("D");
        }
        let inverse = S::one() / pivot;
        self.pivot[node.step.first + k] = pivot;
        self.inverse[node.step.first + k] = inverse;
        for i in 0..n {
            let gone = unit == Some(i);
            let factor = if gone {
                S::zero()
            } else {
                scale(u[i], inverse)
            };
            self.scaled[node.row(k) + i] = factor;
            for j in 0..=i {
                if gone || unit == Some(j) {
                    inertia[i][j] = S::zero();
                } else if !factor.is_zero() && !u[j].is_zero() {
                    inertia[i][j] -= factor * u[j];
                }
                inertia[j][i] = inertia[i][j];
            }
        }
        for (i, below) in node.others().iter().enumerate() {
            for at in node.rows(plan, below) {
                let shared = along(&self.store[at..at + n]);
                let factor = scale(shared, inverse);
                self.scaled[at + k] = factor;
                if factor.is_zero() {
                    continue;
                }
                for (i, &u) in u.iter().enumerate().take(n) {
                    if unit != Some(i) && !u.is_zero() {
                        self.store[at + i] -= factor * u;
                    }
                }
                // What the column did before is kept for the products.
                self.along[at] = shared;
            }
            for (other, &target) in node.others()[..=i].iter().zip(node.targets(below)) {
                let columns = plan.steps[other.step].size;
                for (row, at) in node.rows(plan, below).enumerate() {
                    let factor = self.scaled[at + k];
                    if factor.is_zero() {
                        continue;
                    }
                    let last = last(below, other, row, columns);
                    for (column, from) in node.rows(plan, other).enumerate().take(last) {
                        if !self.scaled[from + k].is_zero() {
                            let shared = self.along[from];
                            self.store[target + row * columns + column] -= factor * shared;
                        }
                    }
                }
            }
        }
        if let Some(unit) = unit {
            for at in node
                .others()
                .iter()
                .flat_map(|below| node.rows(plan, below))
            {
                self.store[at + unit] = S::zero();
            }
        }
    }

    /// Hands what is left of a body on to its parent and the others, by (3). Leaves P_oᵀ in `store`.
    fn hand_on(
        &mut self,
        plan: &Elimination,
        node: &LeavingNode<'_>,
        joint: &EliminationStep,
        inertia: &[[S; MOST]; MOST],
    ) {
        let n = node.size;
        for below in &joint.below {
            let coupling = node.coupling(below.step);
            for (row, at) in node.rows(plan, below).enumerate() {
                let mut p = [S::zero(); MOST];
                for e in 0..n {
                    let factor = self.scaled[at + e];
                    for (p, row) in p.iter_mut().zip(inertia).take(n) {
                        if !factor.is_zero() && !row[e].is_zero() {
                            *p += row[e] * factor;
                        }
                    }
                }
                if let Some(coupling) = coupling {
                    for (i, p) in p.iter_mut().enumerate().take(n) {
                        *p += self.store[coupling.at + n * row + i];
                    }
                }
                self.store[at..at + n].copy_from_slice(&p[..n]);
            }
        }
        for (i, below) in joint.below.iter().enumerate() {
            let coupling = node.coupling(below.step);
            for (other, &target) in joint.below[..=i].iter().zip(&below.targets) {
                let columns = plan.steps[other.step].size;
                for (row, at) in node.rows(plan, below).enumerate() {
                    let last = last(below, other, row, columns);
                    for (column, from) in node.rows(plan, other).enumerate().take(last) {
                        let (x, p) = (&self.scaled[at..at + n], &self.store[from..from + n]);
                        let own = x.get(row).filter(|x| at == from && x.is_one());
                        let mut total = match own.filter(|_| coupling.is_none()) {
                            Some(_) => unit_square(x, row, &inertia[row], p),
                            None => sparse_dot(x, p),
                        };
                        if let Some(coupling) = coupling {
                            let own = coupling.at + n * row;
                            total +=
                                sparse_dot(&self.scaled[from..from + n], &self.store[own..own + n]);
                        }
                        let slot = &mut self.store[target + row * columns + column];
                        *slot = (*slot + total).label("I_a");
                    }
                }
            }
        }
    }

    /// Solves for the right-hand side; the factor stays. `enter` hears which part comes next.
    pub fn solve(&mut self, plan: &Elimination, enter: &dyn Fn(Part)) {
        for (index, step) in plan.steps.iter().enumerate() {
            if let Some(node) = LeavingNode::new(plan, index) {
                enter(step.part);
                self.carry(plan, &node);
            }
        }
        for (index, step) in plan.steps.iter().enumerate().rev() {
            if let Some(node) = LeavingNode::new(plan, index) {
                enter(step.part);
                self.find(plan, &node);
            }
        }
    }

    /// Carries the right-hand side of a node to the others, by (2) and (4). ν is that of the joint.
    fn carry(&mut self, plan: &Elimination, node: &LeavingNode<'_>) {
        let (first, n) = (node.step.first, node.size);
        if let Some(axes) = self.axes(node) {
            turn(&mut self.right[first + 3..], &axes);
        }
        for k in 0..node.free {
            let (h, _, unit) = self.column(node, k);
            let work = sparse_dot(&self.right[first..first + n], &h);
            self.work[first + k] = work;
            if let Some(unit) = unit {
                self.right[first + unit] = S::zero();
                if let Some(joint) = node.joint {
                    self.right[joint.first + unit] = S::zero();
                }
            }
            if work.is_zero() {
                continue;
            }
            let own = (0..n).map(|i| (node.row(k) + i, first + i));
            let others = node.others().iter().flat_map(|below| {
                let first = plan.steps[below.step].first;
                node.rows(plan, below)
                    .zip(first..)
                    .map(|(at, row)| (at + k, row))
            });
            for (factor, row) in own.chain(others) {
                let factor = self.scaled[factor];
                if !factor.is_zero() {
                    self.right[row] -= factor * work;
                }
            }
        }
        let Some(joint) = node.joint else {
            return;
        };
        let held = joint.first;
        for d in 0..n {
            let row = &self.store[node.row(d)..node.row(d + 1)];
            let moved = sparse_dot(&self.right[held..held + n], row);
            if !moved.is_zero() {
                self.right[first + d] -= moved;
            }
        }
        for below in &joint.below {
            for (at, row) in node.rows(plan, below).zip(plan.steps[below.step].first..) {
                let push = sparse_dot(&self.scaled[at..at + n], &self.right[first..first + n]);
                self.right[row] = (self.right[row] + push).label("p_a");
            }
        }
        for below in node.others() {
            for (at, row) in node.rows(plan, below).zip(plan.steps[below.step].first..) {
                let moved = sparse_dot(&self.right[held..held + n], &self.store[at..at + n]);
                self.right[row] -= moved;
            }
        }
    }

    /// Finds the unknowns of a node from those of the others, by (1) and (2); leaves (5) with the joint.
    fn find(&mut self, plan: &Elimination, node: &LeavingNode<'_>) {
        let (first, n) = (node.step.first, node.size);
        if let Some(joint) = node.joint {
            self.follow(plan, node, joint);
        }
        for k in (0..node.free).rev() {
            let (h, _, unit) = self.column(node, k);
            let mut u = if node.is_alone(k) {
                self.work[first + k] / self.pivot[first + k]
            } else {
                scale(self.work[first + k], self.inverse[first + k])
            };
            let own = (0..n).map(|i| (node.row(k) + i, first + i));
            let others = node.others().iter().flat_map(|below| {
                let unknowns = plan.steps[below.step].first..;
                node.rows(plan, below)
                    .zip(unknowns)
                    .map(|(at, other)| (at + k, other))
            });
            for (factor, other) in own.chain(others) {
                let factor = self.scaled[factor];
                if !factor.is_zero() {
                    u -= factor * self.right[other];
                }
            }
            if node.joint.is_some() {
                u = u.label("u");
            }
            if let Some(unit) = unit {
                self.right[first + unit] = u;
                continue;
            }
            for (i, h) in h.into_iter().enumerate().take(n) {
                if !h.is_zero() {
                    self.right[first + i] += u * h;
                }
            }
        }
        if let Some(axes) = self.axes(node) {
            turn(&mut self.right[first + 3..], &axes.transpose());
        }
    }

    /// Writes (1) without H u, and (5).
    fn follow(&mut self, plan: &Elimination, node: &LeavingNode<'_>, joint: &EliminationStep) {
        let (first, held, n) = (node.step.first, joint.first, node.size);
        let mut carried = [S::zero(); MOST];
        for below in &joint.below {
            for (at, other) in node.rows(plan, below).zip(plan.steps[below.step].first..) {
                let value = self.right[other];
                for (carried, &x) in carried.iter_mut().zip(&self.scaled[at..at + n]) {
                    if !x.is_zero() {
                        *carried += x * value;
                    }
                }
            }
        }
        for k in 0..node.free {
            if let (_, _, Some(unit)) = self.column(node, k) {
                carried[unit] = S::zero();
            }
        }
        for (d, &own) in carried.iter().enumerate().take(n) {
            let row = &self.store[node.row(d)..node.row(d + 1)];
            let mut push = self.right[first + d] - sparse_dot(&carried, row);
            for below in node.others() {
                let unknowns = plan.steps[below.step].first..;
                let rows = node.rows(plan, below).zip(unknowns);
                push -= sparse_sum(rows.map(|(at, row)| (self.store[at + d], self.right[row])));
            }
            self.push[held + d] = push;
            self.right[first + d] = (self.right[held + d] + own).label("a");
        }
    }

    /// The unknowns of the parent joint of the body of a step: ν.
    pub fn held_mut(&mut self, plan: &Elimination, body: usize) -> &mut [S] {
        match LeavingNode::pair(plan, body) {
            Some((node, joint)) => &mut self.right[joint.first..joint.first + node.size],
            None => &mut [],
        }
    }

    /// What the parent joint of the body of a step pushes it with, by (5), after [`BlockSystem::solve`].
    pub fn push(&self, plan: &Elimination, body: usize) -> &[S] {
        match LeavingNode::pair(plan, body) {
            Some((node, joint)) => &self.push[joint.first..joint.first + node.size],
            None => &[],
        }
    }
}

/// The first three numbers of a list, a row vector: times T.
fn turn<S: Real>(list: &mut [S], axes: &Matrix3<S>) {
    let old: [S; 3] = std::array::from_fn(|r| list[r]);
    for (j, slot) in list.iter_mut().enumerate().take(3) {
        *slot = sparse_dot(&old, &std::array::from_fn::<S, 3, _>(|r| axes[(r, j)]));
    }
}

/// Tᵀ of the angular rows and T of the angular columns of a block.
#[allow(clippy::needless_range_loop, reason = "rows and columns of one matrix")]
fn turn_inertia<S: Real>(inertia: &mut [[S; MOST]; MOST], axes: &Matrix3<S>) {
    for row in inertia.iter_mut() {
        turn(&mut row[3..], axes);
    }
    for j in 0..MOST {
        let mut column = [inertia[3][j], inertia[4][j], inertia[5][j]];
        if j < 3 {
            column = [inertia[j][3], inertia[j][4], inertia[j][5]];
        } else {
            turn(&mut column, axes);
        }
        for (row, value) in column.into_iter().enumerate() {
            // The lower triangle repeats the upper one.
            if j < 3 || row <= j - 3 {
                inertia[3 + row][j] = value;
            }
        }
    }
    for i in 3..MOST {
        for j in 3..i {
            inertia[i][j] = inertia[j][i];
        }
    }
}

/// Σ a b over the products in which neither is zero.
pub(crate) fn sparse_sum<S: Real>(products: impl Iterator<Item = (S, S)>) -> S {
    products
        .filter(|(a, b)| !a.is_zero() && !b.is_zero())
        .fold(S::zero(), |sum, (a, b)| sum + a * b)
}

/// The same of two lists, as far as both go. A loop, because this is where numbers without generated code spend most of their time.
pub(crate) fn sparse_dot<S: Real>(a: &[S], b: &[S]) -> S {
    let mut sum = S::zero();
    for (&a, &b) in a.iter().zip(b) {
        if !a.is_zero() && !b.is_zero() {
            sum += a * b;
        }
    }
    sum
}

/// x · p for p = I x, `row` the row of I of an element of x that is one: what the other elements give it in p, they give back.
///
/// ```text
/// x · I x = I_rr + Σ x_e (I_re + p_e),  e ≠ r
/// ```
fn unit_square<S: Real>(x: &[S], own: usize, row: &[S], p: &[S]) -> S {
    let others = x.iter().zip(row.iter().zip(p)).enumerate();
    let others = others.filter(|&(e, (x, _))| e != own && !x.is_zero());
    others.fold(row[own], |sum, (_, (&x, (&row, &p)))| sum + x * (row + p))
}

/// a b, where a is not zero.
fn scale<S: Real>(a: S, b: S) -> S {
    if a.is_zero() { a } else { a * b }
}

/// The columns of a row of a block: of a diagonal block those of the lower triangle.
fn last(below: &Below, other: &Below, row: usize, columns: usize) -> usize {
    if below.step == other.step {
        row + 1
    } else {
        columns
    }
}
