//! Rows: the scalar equations every joint is built from, at the three levels Φ = 0, Φ_v v = 0, Φ_v v̇ = γ.
//!
//! Parent p, child c; joint points at the arms p1, p2 from the centres of mass; d the gap from the parent's joint point to the child's,
//! e the child's joint point from the parent's centre of mass; a fixed in the parent, b in the child; γ = −(dΦ_v/dt) v.
//!
//! ```text
//! row                  Φ                  columns ṙ_p, ω_p, ṙ_c, ω_c            γ                                                        world components
//! coincide (3) [m]     d                  −I, s̃1, I, −s̃2                        ω_p×(ω_p×s1) − ω_c×(ω_c×s2)                              (1)
//! perpendicular [1]    a·b                0, nᵀ, 0, −nᵀ;  n = a×b               |w|²(a·b) − (a·w)(b·w) − n·(ω_p×ω_c),  w = ω_p − ω_c    (2)
//! in-plane [m]         a·d                −aᵀ, (a×e)ᵀ, aᵀ, (s2×a)ᵀ              a·[2 ω_p×u − ω_p×(ω_p×e) − ω_c×(ω_c×s2)]                 (3)
//! distance [m]         (d·d − L²)/(2L)    (dᵀ/L) · coincide                     (d·γ_coincide − ḋ·ḋ)/L                                   (4)
//! helix [m]            h sin(φ − θ)       from (2) and (3), see [`Rows::helix`]                                                          (5)
//! ```
//!
//! An end on a frame of the world that moves has a velocity and an acceleration prescribed by time. Its columns times these go to the
//! right-hand sides, so that the rows of the others are Φ_v v = −Φ_t and Φ_v v̇ = γ with
//!
//! ```text
//! Φ_t = Φ_v v of the prescribed end,   γ = −(dΦ_v/dt) v − Φ_v v̇ of the prescribed end                            (6)
//! ```
//!
//! A coupling is a sum of rows of several joints: its columns stand at all their ends, see [`super::coupling`].
//!
//! What the motion of the parent brings along, as an acceleration of the child's joint point: the rows (1) and (3) times it are their γ,
//!
//! ```text
//! coincide  ω_p×(ω_p×s1) − ω_c×(ω_c×s2)         in-plane  2 ω_p×u − ω_p×(ω_p×e) − ω_c×(ω_c×s2)         angular  ω_p×ω_c              (7)
//! ```
//!
//! with s = R p and u = ṙ_c + ω_c×s2 − ṙ_p. In body components the same rows are written from p1, p2, ω′ and A = R_pᵀ R_c alone:
//!
//! ```text
//! coincide             −I, R_p p̃1, I, −R_c p̃2                                   R_p(ω′_p×(ω′_p×p1)) − R_c(ω′_c×(ω′_c×p2))                 (1′)
//! perpendicular        0, n′ᵀ, 0, −(a″×b″)ᵀ;  n′ = a′×Ab″, a″ = Aᵀa′            as (2) with ω_c → Aω′_c, in parent components             (2′)
//! in-plane             −(R_p a′)ᵀ, (a′×e′)ᵀ, (R_p a′)ᵀ, (p2×a″)ᵀ                a′·[2 ω′_p×u′ − ω′_p×(ω′_p×e′) − A(ω′_c×(ω′_c×p2))]       (3′)
//! ```
//!
//! One text serves both: see [`Ends`]. γ is the same number in both. The columns of the world end are never asked for, so they fold away.
//! The a·b term of (2) vanishes on the manifold and is kept, because stages are slightly off it. In (3) the parent's arm is e, not s1.
//! Source: Kamman, Connecting Joints I, differentiated twice.

use std::ops::Deref;

use nalgebra::Vector3;

use super::ends::{End, Ends, Rotation};
use crate::scalar::Few;
use crate::scalar::algebra::labelled;
use crate::vocabulary::MOST_COUPLED;
use crate::{Axis, Coordinate, Directions, Jet, Part, Real, RowSet};

/// Most ends of a joint: a parent and a child of each coordinate that it couples.
pub const MOST_ENDS: usize = 2 * MOST_COUPLED;
/// Coordinates of a coupling besides its first.
const MOST_OTHERS: usize = MOST_COUPLED - 1;

/// What one end contributes to a row: the coefficients of its velocity.
#[derive(Clone, Copy, Debug)]
pub struct Columns<S: Real> {
    /// Of the velocity of the centre of mass, world axes.
    pub linear: Vector3<S>,
    /// Of the angular velocity, own components.
    pub angular: Vector3<S>,
}

/// One scalar equation at its three levels.
#[derive(Clone, Copy, Debug)]
pub struct Row<S: Real> {
    /// Φ.
    pub value: S,
    /// Columns of the parent and of the child.
    pub columns: [Columns<S>; 2],
    /// Φ_t: ∂Φ/∂t of the row itself, which is zero but for a motor, and once it is [prescribed](Row::prescribe) that of its ends by (6).
    pub time: S,
    /// The couple on the child about the origin of frame 2 for a unit multiplier, own components: zero for a row that only pushes.
    pub couple: Vector3<S>,
    /// γ.
    pub bias: S,
    /// γ less what the parent's motion brings along: less (7) times the columns of the child.
    pub relative: S,
}

impl<S: Real> Columns<S> {
    fn zero() -> Self {
        Columns {
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
        }
    }

    fn scaled(&self, factor: S) -> Self {
        Columns {
            linear: self.linear.map(|x| factor * x),
            angular: self.angular.map(|x| factor * x),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Columns {
            linear: self.linear + other.linear,
            angular: self.angular + other.angular,
        }
    }

    /// Those of the speeds of a part, in their order.
    pub fn of(&self, part: Part, directions: Directions) -> impl Iterator<Item = S> + '_ {
        let speeds = match part {
            Part::Body(_) => directions.speeds(),
            _ => directions.translations().len(),
        };
        let all = directions.components(&self.linear, &self.angular);
        all.take(speeds)
    }

    /// What a velocity and an angular velocity of an end, or their rates, give to the row.
    pub fn rate(&self, [linear, angular]: &[Vector3<S>; 2]) -> S {
        self.linear.dot(linear) + self.angular.dot(angular)
    }
}

impl<S: Real> Row<S> {
    /// A row between two ends, of this value.
    fn between(value: S, parent: Columns<S>, child: Columns<S>) -> Self {
        Row {
            value,
            columns: [parent, child],
            time: S::zero(),
            couple: Vector3::zeros(),
            bias: S::zero(),
            relative: S::zero(),
        }
    }

    /// Columns of the parent.
    pub fn parent(&self) -> &Columns<S> {
        &self.columns[0]
    }

    /// Columns of the child.
    pub fn child(&self) -> &Columns<S> {
        &self.columns[1]
    }

    /// The row of a joint between two ends, which has no others.
    pub fn whole(&self) -> WholeRow<'_, S> {
        WholeRow {
            row: self,
            others: &[],
        }
    }

    /// Columns, couple and γ of `factor` × row; Φ likewise.
    pub fn scaled(&self, factor: S) -> Self {
        let [parent, child] = &self.columns;
        let columns = [parent.scaled(factor), child.scaled(factor)];
        Row {
            value: factor * self.value,
            columns,
            time: factor * self.time,
            couple: self.couple.map(|x| factor * x),
            bias: factor * self.bias,
            relative: factor * self.relative,
        }
    }

    /// The sum of two rows between the same ends.
    pub fn plus(&self, other: &Self) -> Self {
        let ([parent, child], [of_parent, of_child]) = (&self.columns, &other.columns);
        let columns = [parent.plus(of_parent), child.plus(of_child)];
        Row {
            value: self.value + other.value,
            columns,
            time: self.time + other.time,
            couple: self.couple + other.couple,
            bias: self.bias + other.bias,
            relative: self.relative + other.relative,
        }
    }

    /// Takes what is prescribed to the right-hand sides by (6). Once.
    pub fn prescribe(&mut self, ends: &Ends<'_, S>) {
        let both = [&ends.parent, &ends.child];
        for (columns, end) in self.columns.iter().zip(both) {
            if let Some(accelerations) = &end.prescribed {
                self.time += columns.rate(&end.velocities());
                self.bias -= columns.rate(accelerations);
            }
        }
    }
}

/// A row of a joint with the columns of all its ends: a coupling has more than a parent and a child.
#[derive(Clone, Copy, Debug)]
pub struct WholeRow<'r, S: Real> {
    row: &'r Row<S>,
    others: &'r [[Columns<S>; 2]],
}

impl<S: Real> Deref for WholeRow<'_, S> {
    type Target = Row<S>;

    fn deref(&self) -> &Row<S> {
        self.row
    }
}

impl<'r, S: Real> WholeRow<'r, S> {
    /// The columns of the ends in pairs, a parent and a child of each coordinate.
    pub fn pairs(self) -> impl Iterator<Item = &'r [Columns<S>; 2]> {
        std::iter::once(&self.row.columns).chain(self.others)
    }

    /// The columns of all ends, pair by pair.
    pub fn all_columns(self) -> impl Iterator<Item = &'r Columns<S>> {
        self.pairs().flatten()
    }

    /// Every part that moves with its columns, those of ends on the same part added up; `ends`: what the ends sit on.
    pub fn parts(self, ends: &'r [Option<Part>]) -> impl Iterator<Item = (Part, Columns<S>)> + 'r {
        let all = move || ends.iter().zip(self.all_columns()).enumerate();
        all().filter_map(move |(first, (part, columns))| {
            let part = (*part)?;
            let on = move |end: &Option<Part>| *end == Some(part);
            if ends.iter().take(first).any(on) {
                return None;
            }
            let others = all().filter(move |(end, (other, _))| *end > first && on(other));
            let sum = others.fold(*columns, |sum, (_, (_, columns))| sum.plus(columns));
            Some((part, sum))
        })
    }
}

/// The rows of one joint, in order: those of its law that are asked for.
#[derive(Clone, Debug)]
pub struct Rows<S: Real> {
    rows: Vec<Row<S>>,
    /// Of the one row of a coupling the columns at the ends of its other coordinates.
    others: Few<[Columns<S>; 2], MOST_OTHERS>,
    /// The first of the rows along world axes, if there are such, and their axes.
    coincide: Option<(usize, RowSet)>,
    /// The rows of the law that are asked for.
    requested: RowSet,
    /// How many the law has emitted so far, asked for or not.
    emitted: usize,
}

impl<S: Real> Default for Rows<S> {
    fn default() -> Self {
        Rows {
            rows: Vec::with_capacity(6),
            others: Few::new([Columns::zero(); 2]),
            coincide: None,
            requested: RowSet::all(6),
            emitted: 0,
        }
    }
}

impl<S: Real> Rows<S> {
    /// Forgets all rows and keeps the room; of the law that tells its rows next, those of `requested` are written. A plane asks for some.
    pub fn begin(&mut self, requested: RowSet) {
        self.rows.clear();
        self.others.clear();
        self.coincide = None;
        self.requested = requested;
        self.emitted = 0;
    }

    /// Whether the next row of the law is asked for.
    fn next(&mut self) -> bool {
        self.emitted += 1;
        self.requested.contains(self.emitted - 1)
    }

    /// The rows, between the two ends of the joint.
    #[must_use]
    pub fn rows(&self) -> &[Row<S>] {
        &self.rows
    }

    /// The rows with the columns of all ends.
    pub fn whole(&self) -> impl Iterator<Item = WholeRow<'_, S>> {
        let others = &*self.others;
        self.rows.iter().map(move |row| WholeRow { row, others })
    }

    /// Writes the rows of a set as the system takes them where some of the joint's rows repeat others: of the three rows along world axes their
    /// sums along the axes of frame 1, so that what is left out turns with the parent. The plane of a planar loop does. In a planar scene
    /// the two rows are summed along the axes of the parent.
    pub fn keep(&self, set: RowSet, ends: &Ends<'_, S>, kept: &mut Self) {
        kept.begin(RowSet::default());
        kept.others = self.others;
        for row in set.rows() {
            let parts = self.parts(row, ends).into_iter().flatten();
            let whole = parts
                .filter_map(|(row, part)| Some(self.rows.get(row)?.scaled(part)))
                .reduce(|sum, row| sum.plus(&row));
            kept.rows.extend(whole);
        }
    }

    /// Every row times a factor: 0 takes them out.
    pub fn scale(&mut self, factor: S) {
        for row in &mut self.rows {
            *row = row.scaled(factor);
        }
        for columns in self.others.as_flattened_mut() {
            *columns = columns.scaled(factor);
        }
    }

    /// The rows, and how much of each, that make up row `row` of the system.
    pub fn parts(&self, row: usize, ends: &Ends<'_, S>) -> [Option<(usize, S)>; 3] {
        let one = [Some((row, S::one())), None, None];
        let Some((first, axes)) = self.coincide else {
            return one;
        };
        let along = row.checked_sub(first).and_then(|k| axes.rows().nth(k));
        let Some(along) = along else { return one };
        let axis = match axes.len() {
            3 => ends.direction(along),
            _ => ends.parent.outward.column(along),
        };
        let mut parts = axes.rows().zip(first..);
        std::array::from_fn(|_| {
            let (k, row) = parts.next()?;
            Some((row, axis[k])).filter(|(_, x)| !x.is_zero())
        })
    }

    /// Holds a coordinate to a course of time: one row, derived in `rows/motor.rs`.
    pub fn motor(&mut self, ends: &Ends<'_, S>, coordinate: &Coordinate, course: &Jet<S>) {
        let mut row = ends.prescribed(coordinate, course);
        row.prescribe(ends);
        self.rows.push(row);
    }

    /// [`Row::prescribe`] of all rows.
    pub fn prescribe(&mut self, ends: &Ends<'_, S>) {
        self.rows.iter_mut().for_each(|row| row.prescribe(ends));
    }

    /// One row of the law: a basic one, or one that [`Row::scaled`] and [`Row::plus`] make of such.
    pub fn push(&mut self, row: impl FnOnce() -> Row<S>) {
        if self.next() {
            self.rows.push(row());
        }
    }

    /// One row, the sum of rows of several joints; its Φ is `value` of the sum of theirs. The couple is that on the child of the first.
    pub fn couple(&mut self, mut terms: impl Iterator<Item = Row<S>>, value: impl FnOnce(S) -> S) {
        if !self.next() {
            return;
        }
        let Some(mut sum) = terms.next() else {
            return;
        };
        for term in terms {
            self.others.push(term.columns);
            sum.value += term.value;
            sum.time += term.time;
            sum.bias += term.bias;
            sum.relative += term.relative;
        }
        sum.value = value(sum.value);
        self.rows.push(sum);
    }

    /// The joint points coincide: three rows [m], (1).
    pub fn coincide(&mut self, ends: &Ends<'_, S>) {
        let first = self.rows.len();
        let axes = (0..3).filter(|_| self.next());
        let axes = axes.fold(RowSet::default(), |axes, k| RowSet(axes.0 | 1 << k));
        self.coincide = Some((first, axes));
        let (parent, child) = (&ends.parent, &ends.child);
        let gap = ends.gap();
        let bias = labelled(ends.meeting(), ["gamma_x", "gamma_y", "gamma_z"]);
        for k in axes.rows() {
            let unit = Rotation::Identity.row(k);
            let columns = Columns {
                linear: -unit,
                angular: parent.outward.row(k).cross(&parent.lever()),
            };
            let on_child = Columns {
                linear: unit,
                angular: child.lever().cross(&child.outward.row(k)),
            };
            self.rows.push(Row {
                bias: bias[k],
                ..Row::between(gap[k], columns, on_child)
            });
        }
    }

    /// Axis `a` of frame 1 and axis `b` of frame 2 stay perpendicular: one row [1], (2).
    pub fn perpendicular(&mut self, ends: &Ends<'_, S>, a: &Axis, b: &Axis) {
        self.push(|| perpendicular(ends, a, b));
    }

    /// Three rows [1] that lock the attitude: (x1, y2), (y1, z2), (z1, x2) for the axes x, y, z.
    pub fn lock(&mut self, ends: &Ends<'_, S>, [x, y, z]: [Axis; 3]) {
        for (a, b) in [(x, y), (y, z), (z, x)] {
            self.perpendicular(ends, &a, &b);
        }
    }

    /// The cosine between `a` of frame 1 and `b` of frame 2 stays `cosine`: one row [1], (2) with another right-hand side.
    pub fn angle(&mut self, ends: &Ends<'_, S>, a: &Axis, b: &Axis, cosine: S) {
        self.push(|| {
            let row = perpendicular(ends, a, b);
            Row {
                value: row.value - cosine,
                ..row
            }
        });
    }

    /// The child's joint point stays in the plane through the parent's joint point normal to `a` of frame 1: one row [m], (3).
    pub fn in_plane(&mut self, ends: &Ends<'_, S>, a: &Axis) {
        self.push(|| in_plane(ends, a));
    }

    /// The joint points keep the distance `length` [m]: one row [m], (4).
    pub fn distance(&mut self, ends: &Ends<'_, S>, length: S) {
        self.push(|| distance(ends, length));
    }

    /// The child advances by `lead` [m/rad] as it turns about `axis`: one row [m], (5). With U = u1·u2, V = v1·u2, z = a1·d, φ = z/h:
    ///
    /// ```text
    /// Φ   = h (U sin φ − V cos φ)
    /// Φ_v = h sin φ Φ_v(U) − h cos φ Φ_v(V) + (U cos φ + V sin φ) Φ_v(z)
    /// γ   = h sin φ γ(U) − h cos φ γ(V) + (U cos φ + V sin φ) γ(z) − 2 (U̇ cos φ + V̇ sin φ) ż + (U sin φ − V cos φ) ż²/h
    /// ```
    pub fn helix(&mut self, ends: &Ends<'_, S>, axis: &Axis, lead: S) {
        self.push(|| helix(ends, axis, lead).0);
    }
}

impl<S: Real> Ends<'_, S> {
    /// cos(φ − θ) of the helix row: positive on its own thread.
    pub fn helix_cosine(&self, axis: &Axis, lead: S) -> S {
        let [u, v] = axis.complement();
        let (sin, cos) = (in_plane(self, axis).value / lead).sin_cos();
        self.cosine(&u, &u) * cos + self.cosine(&v, &u) * sin
    }
}

impl<S: Real> Ends<'_, S> {
    /// The first of (7): points that coincide, world axes [m/s²].
    pub fn meeting(&self) -> Vector3<S> {
        parent_pull(&self.parent) - child_pull(&self.child)
    }

    /// The second of (7): the child's point moves in the parent, world axes [m/s²].
    pub fn sliding(&self) -> Vector3<S> {
        let twice = self.reach_rate() + self.slide_rate();
        let coriolis = self.parent.omega.cross(&twice);
        self.parent.outward.apply(&coriolis) - child_pull(&self.child)
    }
}

/// ω × (ω × arm) of the parent's end, world axes [m/s²]: the centripetal acceleration of the joint's point.
fn parent_pull<S: Real>(end: &End<S>) -> Vector3<S> {
    labelled(
        pull(end),
        ["parent_pull_x", "parent_pull_y", "parent_pull_z"],
    )
}

/// The same of the child's end.
fn child_pull<S: Real>(end: &End<S>) -> Vector3<S> {
    labelled(pull(end), ["child_pull_x", "child_pull_y", "child_pull_z"])
}

fn pull<S: Real>(end: &End<S>) -> Vector3<S> {
    end.outward.apply(&end.omega.cross(&end.swing()))
}

/// (2).
pub fn perpendicular<S: Real>(ends: &Ends<'_, S>, a: &Axis, b: &Axis) -> Row<S> {
    across(ends, &ends.parent.axis(a), &ends.child.axis(b))
}

/// (2) for directions in the components of their ends.
fn across<S: Real>(ends: &Ends<'_, S>, a: &Vector3<S>, b: &Vector3<S>) -> Row<S> {
    let (b_parent, a_child) = (ends.relative().apply(b), ends.relative().back(a));
    let spin = ends.spin();
    let (normal, couple) = (a.cross(&b_parent), b.cross(&a_child));
    let cosine = a.dot(&b_parent);
    let along = a.dot(&spin.difference) * b_parent.dot(&spin.difference);
    let relative = spin.square * cosine - along;
    let columns = |angular: Vector3<S>| Columns {
        angular,
        ..Columns::zero()
    };
    Row {
        couple,
        bias: relative - normal.dot(&spin.cross),
        relative,
        ..Row::between(cosine, columns(normal), columns(couple))
    }
}

/// a, b → a cos − b sin and a sin + b cos.
fn rotated<S: Real>([a, b]: [Vector3<S>; 2], (sin, cos): (S, S)) -> [Vector3<S>; 2] {
    let sum = |x: S, y: S| a.map(|a| a * x) + b.map(|b| b * y);
    [sum(cos, -sin), sum(sin, cos)]
}

/// The rows of S cos − C sin and S sin + C cos, for the products C of the first pair of axes and S of the second, one of which both share.
pub(super) fn rotated_rows<S: Real>(
    ends: &Ends<'_, S>,
    cosine: &[Axis; 2],
    sine: &[Axis; 2],
    turn: (S, S),
) -> [Row<S>; 2] {
    if cosine[1] == sine[1] {
        let both = [sine[0], cosine[0]].map(|axis| ends.parent.axis(&axis));
        let own = ends.child.axis(&cosine[1]);
        return rotated(both, turn).map(|direction| across(ends, &direction, &own));
    }
    let own = ends.parent.axis(&cosine[0]);
    let both = [sine[1], cosine[1]].map(|axis| ends.child.axis(&axis));
    rotated(both, turn).map(|direction| across(ends, &own, &direction))
}

/// (3).
pub(super) fn in_plane<S: Real>(ends: &Ends<'_, S>, a: &Axis) -> Row<S> {
    let (parent, child) = (&ends.parent, &ends.child);
    let a = parent.axis(a);
    let a_child = ends.relative().back(&a);
    let (reach, rate) = (ends.reach(), ends.reach_rate());
    let two = S::from_f64(2.0);
    let coriolis = parent.omega.cross(&rate).map(|x| two * x);
    let carried = parent.omega.cross(&parent.omega.cross(&reach));
    let own = child.omega.cross(&child.swing());
    let linear = parent.outward.apply(&a);
    let columns = Columns {
        linear: -linear,
        angular: a.cross(&(reach - parent.reference)),
    };
    let on_child = Columns {
        linear,
        angular: child.lever().cross(&a_child),
    };
    Row {
        bias: a.dot(&(coriolis - carried)) - a_child.dot(&own),
        ..Row::between(a.dot(&(reach - parent.arm)), columns, on_child)
    }
}

/// (4).
fn distance<S: Real>(ends: &Ends<'_, S>, length: S) -> Row<S> {
    let (parent, child) = (&ends.parent, &ends.child);
    let (gap, rate) = (ends.gap(), ends.gap_rate());
    let shrink = (S::one() / length).label("inverse_length");
    let direction = gap.map(|x| x * shrink);
    let half = S::from_f64(0.5);
    let columns = Columns {
        linear: -direction,
        angular: parent.outward.back(&direction).cross(&parent.lever()),
    };
    let on_child = Columns {
        linear: direction,
        angular: child.lever().cross(&child.outward.back(&direction)),
    };
    Row {
        bias: direction.dot(&ends.meeting()) - rate.dot(&rate) * shrink,
        relative: -(rate.dot(&rate) * shrink),
        ..Row::between(half * (gap.dot(&direction) - length), columns, on_child)
    }
}

/// (5), with the axes of frame 1 rotated by φ: m = u1 sin φ − v1 cos φ and n = u1 cos φ + v1 sin φ; and its slope ∂Φ/∂z.
pub(crate) fn helix<S: Real>(ends: &Ends<'_, S>, axis: &Axis, lead: S) -> (Row<S>, S) {
    let [u, v] = axis.complement();
    let displacement = in_plane(ends, axis);
    let (sin, cos) = (displacement.value / lead).sin_cos();
    let own = [u, v].map(|axis| ends.parent.axis(&axis));
    // v cos − u sin and v sin + u cos.
    let [behind, ahead] = rotated([own[1], own[0]], (sin, cos));
    let u = ends.child.axis(&u);
    let (miss, advance) = (across(ends, &-behind, &u), across(ends, &ahead, &u));
    let slope = advance.value;
    let speed = ends.parent.axis(axis).dot(&ends.slide_rate());
    let turning = advance.parent().angular.dot(&ends.spin().difference);
    let row = miss.scaled(lead).plus(&displacement.scaled(slope));
    let two = S::from_f64(2.0);
    let own = (miss.value * speed / lead - two * turning) * speed;
    let row = Row {
        bias: row.bias + own,
        relative: row.relative + own,
        value: lead * miss.value,
        ..row
    };
    (row, slope)
}

/// The couple on the child of a row (2), child components.
pub(crate) fn couple<S: Real>(ends: &Ends<'_, S>, a: &Axis, b: &Axis) -> Vector3<S> {
    ends.child.axis(b).cross(&ends.in_child(a))
}
