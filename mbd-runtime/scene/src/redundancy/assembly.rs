//! Consistent random states of a group of parts, and what the speeds of its tree do to the rows that close its loops.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

use crate::joints::JointLaw;
use crate::random::SplitMix64;
use crate::redundancy::choice::SpanRow;
use crate::redundancy::configuration::Configuration;
use crate::redundancy::length;
use crate::redundancy::local::{Hold, PartMotion, columns, speeds};
use crate::redundancy::tree::{LoopGroup, WalkedJoint};
use crate::rows::{Rows, WholeRow};
use crate::scalar::orthogonal::dot;
use crate::{Detachable, Layout, Part, Pose, Relative, Scene, Twist};

/// States looked for in a group.
const STATES: usize = 5;
/// States looked for with other params.
const STATES_ELSEWHERE: usize = 2;
/// Attempts at them.
const ATTEMPTS: usize = 24;
/// Iterations that close the loops of one.
const ITERATIONS: usize = 60;
/// Iterations that must at least halve what is left.
const STALL: usize = 8;
/// The largest turn of one iteration [rad].
const TURN: f64 = 0.5;
/// How far a state beside the declared start is from it, in parts of the length.
const BESIDE: f64 = 0.1;
/// A loop is closed when its rows are below this part of the length.
const CLOSED: f64 = 1e-11;

/// A row of a joint at a state: its size, and its columns on the parts that move.
pub struct JointRow {
    /// √ of the sum of squares of its columns.
    pub size: f64,
    /// Each part with its columns.
    pub parts: Vec<(Part, PartMotion)>,
    /// What a unit multiplier adds to the reaction: a force on the child, a torque about the origin of frame 2, world axes.
    pub on_child: [Vector3<f64>; 2],
}

impl JointRow {
    /// Its columns on a part: zero where it is on none.
    pub fn on(&self, part: Option<Part>) -> PartMotion {
        let found = self.parts.iter().find(|(own, _)| Some(*own) == part);
        found.map_or([0.0; 6], |(_, columns)| *columns)
    }
}

/// The row of a motor at a state.
pub struct MotorRow {
    /// Its joint.
    pub joint: usize,
    /// The coordinate it drives.
    pub coordinate: usize,
    /// The row over the speeds of the tree, divided by its size.
    pub line: DVector<f64>,
    /// The row on its parts.
    pub row: JointRow,
}

/// A consistent state, linearised.
pub struct LinearisedState {
    /// Per closing joint, the rows in the form of the system over the speeds of the tree, each divided by its size.
    pub closing: Vec<Vec<DVector<f64>>>,
    /// Per closing joint, the rows on their parts.
    pub closing_rows: Vec<Vec<JointRow>>,
    /// The rows of all motors of the group, by joint.
    pub motors: Vec<MotorRow>,
    /// Per link, the rows of its joint and how they hold the part it places.
    pub links: Vec<(Vec<JointRow>, Hold)>,
    /// Speeds that the rows of the closing joints leave that always hold, less those of a group that moves freely as a whole.
    pub freedoms: usize,
    /// Rank of the rows of the closing joints.
    pub rank: usize,
    /// The length that angles are weighed with.
    pub length: f64,
}

impl LinearisedState {
    /// A row over the speeds of the tree, divided by its size.
    pub fn line(&self, row: SpanRow) -> Option<&DVector<f64>> {
        match row {
            SpanRow::Closing(place, row) => self.closing.get(place)?.get(row),
            SpanRow::Motor(index) => Some(&self.motors.get(index)?.line),
        }
    }
}

/// A group in a configuration.
struct Assembly<'a> {
    scene: &'a Scene,
    layout: &'a Layout,
    group: &'a LoopGroup,
    configuration: Configuration<'a>,
    /// How parts that move freely are turned.
    turn: Matrix3<f64>,
    length: f64,
    rows: Rows<f64>,
    spare: Rows<f64>,
    random: SplitMix64,
}

/// Looks for consistent states of a group, the first beside a state of the scene, where one is given. Fewer than asked for where its loops do not close.
pub fn states(
    (scene, layout): (&Scene, &Layout),
    group: &LoopGroup,
    begun: Option<&[f64]>,
) -> Vec<LinearisedState> {
    let mut assembly = Assembly::new(Configuration::new(scene, layout), group);
    let mut found = Vec::new();
    if let Some(begun) = begun {
        let closed = assembly.place_beside(begun);
        found.extend(closed.and_then(|()| assembly.linearise()));
    }
    assembly.look(STATES, &mut found);
    found
}

/// The same with other params, at another time, and with the parts that move freely turned: what is zero at these states, too, is no accident of where
/// things are. `None` where nothing of this changes a group.
pub fn states_elsewhere(
    (scene, layout): (&Scene, &Layout),
    group: &LoopGroup,
) -> Option<Vec<LinearisedState>> {
    let moves = scene.world_frames.iter().any(|frame| frame.moves(scene));
    if scene.params.is_empty() && group.roots.is_empty() && !moves {
        return None;
    }
    let mut random = SplitMix64(0x5851_f42d_4c95_7f2d);
    let turn = Vector3::from_fn(|_, _| random.number());
    let configuration = Configuration::elsewhere(scene, layout, &mut random);
    let mut assembly = Assembly::new(configuration, group);
    assembly.turn = Rotation3::new(turn).into_inner();
    let mut found = Vec::new();
    assembly.look(STATES_ELSEWHERE, &mut found);
    Some(found)
}

impl<'a> Assembly<'a> {
    fn new(configuration: Configuration<'a>, group: &'a LoopGroup) -> Self {
        let (scene, layout) = (configuration.scene, configuration.layout);
        let joints = group.links.iter().map(|link| link.joint);
        let joints = joints.chain(group.closing.iter().copied());
        let arms = joints.flat_map(|joint| {
            let joint = scene.joints.get(joint);
            let numbers = joint.map_or([0.0; 2], |joint| {
                [joint.parent, joint.child].map(|place| match place {
                    crate::Place::World(_) => 0.0,
                    _ => configuration.frame(place).0.norm(),
                })
            });
            numbers.into_iter()
        });
        Assembly {
            length: length(arms),
            scene,
            layout,
            group,
            configuration,
            turn: Matrix3::identity(),
            rows: Rows::default(),
            spare: Rows::default(),
            random: SplitMix64(0x9e37_79b9_7f4a_7c15),
        }
    }

    /// Adds states at random joint coordinates until there are as many as `wanted`.
    fn look(&mut self, wanted: usize, found: &mut Vec<LinearisedState>) {
        for attempt in 0..ATTEMPTS {
            if found.len() == wanted {
                break;
            }
            let reach = [1.0, 3.1, 0.3][attempt % 3];
            let closed = self.place_tree(reach).and_then(|()| self.close());
            found.extend(closed.and_then(|()| self.linearise()));
        }
    }
}

impl Assembly<'_> {
    /// Hangs every part of the tree at random joint coordinates.
    fn place_tree(&mut self, reach: f64) -> Option<()> {
        for &root in &self.group.roots {
            self.configuration.place(root, Vector3::zeros(), &self.turn);
        }
        for link in &self.group.links {
            let joint = self.scene.joints.get(link.joint)?;
            let numbers = self.configuration.numbers.joints.get(link.joint)?;
            let q = random_coordinates(&mut self.random, &joint.law, numbers, reach, self.length);
            let at = Relative {
                q: &q,
                u: &[],
                numbers,
            };
            let pose = joint.law.motion(&at);
            let (near, far) = match link.to_parent {
                true => (joint.child, joint.parent),
                false => (joint.parent, joint.child),
            };
            let origin = Pose::identity();
            let from = link.from.map_or(origin, |part| self.pose(part));
            let [near, far] = [near, far].map(|place| {
                let (position, rotation) = self.configuration.frame(place);
                Pose { position, rotation }
            });
            let pose = if link.to_parent { pose.inverse() } else { pose };
            let placed = from.then(&near).then(&pose).then(&far.inverse());
            let position = placed.position;
            let axes = match link.to {
                Part::Body(_) => placed.rotation,
                _ => Matrix3::identity(),
            };
            if !(position.iter().chain(axes.iter()).all(|x| x.is_finite())) {
                return None;
            }
            self.configuration.place(link.to, position, &axes);
        }
        self.correct()
    }

    /// Puts every part where a state has it, and moves on a little: at a start rows may stand as they nowhere else do.
    fn place_beside(&mut self, state: &[f64]) -> Option<()> {
        self.configuration.take(state);
        self.correct()?;
        self.close()?;
        let (matrix, _) = self.gaps()?;
        let length = self.length;
        let step = DVector::from_fn(matrix.ncols(), |_, _| {
            BESIDE * length * self.random.number()
        });
        self.advance(&step)?;
        self.close()
    }

    fn pose(&self, part: Part) -> Pose<f64> {
        let (position, rotation) = self.configuration.pose(part);
        Pose { position, rotation }
    }

    /// Puts the joints of the tree right, from the root outwards.
    fn correct(&mut self) -> Option<()> {
        for link in &self.group.links {
            let mut left = f64::INFINITY;
            for _ in 0..12 {
                self.configuration.rows(link.joint, &mut self.rows);
                let (to, directions) = ((link.to, link.to_parent), self.layout.directions);
                let hold = Hold::new(&self.rows, to, directions, self.length)?;
                let mut rates = [0.0; 6];
                for (rate, row) in rates.iter_mut().zip(self.rows.rows()) {
                    *rate = -row.value;
                }
                let motion = hold.motion(&rates);
                left = dot(&motion, &motion).sqrt();
                if left <= 1e-14 * self.length {
                    break;
                }
                self.shift(link.to, &motion);
            }
            if left.is_nan() || left > self.tolerance() {
                return None;
            }
        }
        Some(())
    }

    fn tolerance(&self) -> f64 {
        CLOSED * self.length + 64.0 * f64::EPSILON * self.configuration.reach()
    }

    fn shift(&mut self, part: Part, motion: &PartMotion) {
        let [x, y, z, a, b, c] = *motion;
        let turn = Vector3::new(a, b, c) / self.length;
        let scale = (TURN / turn.norm()).min(1.0);
        self.configuration
            .shift(part, Vector3::new(x, y, z) * scale, turn * scale);
    }

    /// Closes the loops by damped least squares in the speeds of the tree.
    fn close(&mut self) -> Option<()> {
        let mut damping = 1e-3;
        let (mut matrix, mut gap) = self.gaps()?;
        let mut before = f64::INFINITY;
        for iteration in 0..ITERATIONS {
            if iteration % STALL == 0
                && gap.norm() > 0.5 * std::mem::replace(&mut before, gap.norm())
            {
                return None;
            }
            if gap.amax() <= self.tolerance() {
                return self.is_meant().then_some(());
            }
            if matrix.ncols() == 0 {
                return None;
            }
            let normal = matrix.transpose() * &matrix;
            let right = matrix.transpose() * &gap;
            let scale = normal.diagonal().max();
            let damped = |damping: f64| {
                let mut normal = normal.clone();
                for k in 0..normal.nrows() {
                    normal[(k, k)] += damping * scale;
                }
                Some(normal.cholesky()?.solve(&right))
            };
            let Some(step) = damped(damping) else {
                damping *= 100.0;
                continue;
            };
            let placed = self.placed();
            self.advance(&step)?;
            let tried = self.gaps();
            match tried {
                Some((m, g)) if g.norm() < gap.norm() => {
                    (matrix, gap) = (m, g);
                    damping = (damping * 0.1).max(1e-14);
                }
                _ => {
                    self.restore(&placed);
                    damping *= 10.0;
                    if damping > 1e8 {
                        return None;
                    }
                }
            }
        }
        None
    }

    fn placed(&self) -> Vec<(Part, Vector3<f64>, Matrix3<f64>)> {
        let links = self.group.links.iter().map(|link| link.to);
        let parts = self.group.roots.iter().copied().chain(links);
        parts
            .map(|part| {
                let (position, axes) = self.configuration.pose(part);
                (part, position, axes)
            })
            .collect()
    }

    fn restore(&mut self, placed: &[(Part, Vector3<f64>, Matrix3<f64>)]) {
        for (part, position, axes) in placed {
            self.configuration.place(*part, *position, axes);
        }
    }

    /// Moves every part by the speeds of the tree, taken back, and puts the tree right.
    fn advance(&mut self, step: &DVector<f64>) -> Option<()> {
        let motions = self.sensitivities()?;
        for (part, of) in self.parts().into_iter().zip(&motions) {
            let motion = of * step;
            let motion: PartMotion = std::array::from_fn(|k| -motion[k]);
            self.shift(part, &motion);
        }
        self.correct()
    }

    /// The motions of the roots.
    fn root_speeds(&self) -> usize {
        let speeds = |&root: &Part| speeds(root, self.layout.directions).count();
        self.group.roots.iter().map(speeds).sum()
    }

    /// The roots and the part of every link.
    fn parts(&self) -> Vec<Part> {
        let links = self.group.links.iter().map(|link| link.to);
        self.group.roots.iter().copied().chain(links).collect()
    }

    /// B: the motion of every part by the speeds of the tree.
    fn sensitivities(&mut self) -> Option<Vec<DMatrix<f64>>> {
        let group = self.group;
        let holds = self.holds()?;
        let own = |hold: &Hold| hold.free.len();
        let linked = holds.iter().map(|(_, hold)| own(hold)).sum::<usize>();
        let count = self.root_speeds() + linked;
        let mut motions: Vec<DMatrix<f64>> = Vec::new();
        let mut first = 0;
        for &root in &group.roots {
            let mut motion = DMatrix::zeros(6, count);
            for k in speeds(root, self.layout.directions) {
                motion[(k, first)] = 1.0;
                first += 1;
            }
            motions.push(motion);
        }
        for (link, (rows, hold)) in group.links.iter().zip(&holds) {
            let mut motion = DMatrix::zeros(6, count);
            if let Some(from) = self.place_of(link.from) {
                let inboard = motions.get(from)?;
                for column in 0..first {
                    let of: PartMotion = std::array::from_fn(|k| inboard[(k, column)]);
                    let mut rates = [0.0; 6];
                    for (rate, row) in rates.iter_mut().zip(rows) {
                        *rate = -dot(&row.on(link.from), &of);
                    }
                    let carried = hold.motion(&rates);
                    (0..6).for_each(|k| motion[(k, column)] = carried[k]);
                }
            }
            for (free, column) in hold.free.iter().zip(first..) {
                (0..6).for_each(|k| motion[(k, column)] = free[k]);
            }
            first += own(hold);
            motions.push(motion);
        }
        Some(motions)
    }

    /// The place of a part in [`Assembly::parts`].
    fn place_of(&self, part: Option<Part>) -> Option<usize> {
        let part = part?;
        let root = self.group.roots.iter().position(|&root| root == part);
        let linked = || {
            let found = self.group.links.iter().position(|link| link.to == part)?;
            Some(found + self.group.roots.len())
        };
        root.or_else(linked)
    }

    /// Rows and hold of every link.
    fn holds(&mut self) -> Option<Vec<(Vec<JointRow>, Hold)>> {
        let group = self.group;
        let hold = |link: &WalkedJoint| {
            self.configuration.rows(link.joint, &mut self.rows);
            let (to, directions) = ((link.to, link.to_parent), self.layout.directions);
            let hold = Hold::new(&self.rows, to, directions, self.length)?;
            Some((
                joint_rows(&self.rows, self.layout, link.joint, self.length),
                hold,
            ))
        };
        group.links.iter().map(hold).collect()
    }

    /// The rows of the closing joints over the speeds of the tree, and their values; each row divided by its size.
    fn gaps(&mut self) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let motions = self.sensitivities()?;
        let group = self.group;
        let (mut lines, mut values) = (Vec::new(), Vec::new());
        // A lock holds its coordinate wherever it is: it closes nothing, and would only resist.
        let scene = self.scene;
        let locked = |joint: usize| scene.locked(Detachable::Joint(joint)).is_some();
        for &joint in group.closing.iter().filter(|joint| !locked(**joint)) {
            self.configuration.rows(joint, &mut self.rows);
            let rows = joint_rows(&self.rows, self.layout, joint, self.length);
            lines.extend(self.over_tree(&rows, &motions));
            let sizes = rows.iter().map(|row| row.size);
            values.extend(
                self.rows
                    .rows()
                    .iter()
                    .zip(sizes)
                    .map(|(row, size)| row.value / size),
            );
        }
        let count = motions.first().map_or(0, DMatrix::ncols);
        let matrix = DMatrix::from_fn(lines.len(), count, |i, k| lines[i][k]);
        let finite = matrix.iter().chain(&values).all(|x| x.is_finite());
        finite.then(|| (matrix, DVector::from_vec(values)))
    }

    fn over_tree(&self, rows: &[JointRow], motions: &[DMatrix<f64>]) -> Vec<DVector<f64>> {
        let count = motions.first().map_or(0, DMatrix::ncols);
        let line = |row: &JointRow| {
            let mut line = DVector::zeros(count);
            for (part, columns) in &row.parts {
                if let Some(motion) = self.place_of(Some(*part)).and_then(|at| motions.get(at)) {
                    for k in 0..count {
                        let own: f64 = (0..6).map(|i| columns[i] * motion[(i, k)]).sum();
                        line[k] += own / row.size;
                    }
                }
            }
            line
        };
        rows.iter().map(line).collect()
    }

    /// Whether every joint of the group is on the branch it means.
    fn is_meant(&self) -> bool {
        let joints = self.group.links.iter().map(|link| link.joint);
        let mut joints = joints.chain(self.group.closing.iter().copied());
        joints.all(|joint| self.configuration.on_branch(joint))
    }

    fn linearise(&mut self) -> Option<LinearisedState> {
        let motions = self.sensitivities()?;
        let links = self.holds()?;
        let group = self.group;
        let (mut closing, mut closing_rows) = (Vec::new(), Vec::new());
        for &joint in &group.closing {
            self.configuration
                .system_rows(joint, &mut self.spare, &mut self.rows);
            let rows = joint_rows(&self.rows, self.layout, joint, self.length);
            closing.push(self.over_tree(&rows, &motions));
            closing_rows.push(rows);
        }
        let mut joints: Vec<usize> = group.links.iter().map(|link| link.joint).collect();
        joints.extend(&group.closing);
        joints.sort_unstable();
        let mut motors = Vec::new();
        for joint in joints {
            let driven = self.configuration.motor_rows(joint, &mut self.rows);
            let rows = joint_rows(&self.rows, self.layout, joint, self.length);
            let lines = self.over_tree(&rows, &motions);
            for ((coordinate, row), line) in driven.into_iter().zip(rows).zip(lines) {
                motors.push(MotorRow {
                    joint,
                    coordinate,
                    line,
                    row,
                });
            }
        }
        let count = motions.first().map_or(0, DMatrix::ncols);
        let as_a_whole = self.root_speeds();
        let rank = crate::redundancy::choice::rank(closing.iter().flatten());
        // What events lock or detach holds for a while only.
        let always = group.closing.iter().zip(&closing).filter(|(joint, _)| {
            let slots = self.layout.joints.get(**joint);
            slots.is_none_or(|slots| slots.switch.is_none())
        });
        let always = crate::redundancy::choice::rank(always.flat_map(|(_, rows)| rows));
        Some(LinearisedState {
            closing,
            closing_rows,
            motors,
            links,
            freedoms: count.saturating_sub(always + as_a_whole),
            rank,
            length: self.length,
        })
    }
}

fn joint_rows(rows: &Rows<f64>, layout: &Layout, joint: usize, length: f64) -> Vec<JointRow> {
    let Some(slots) = layout.joints.get(joint) else {
        return Vec::new();
    };
    let row = |row: WholeRow<'_, f64>| {
        let parts = row.parts(&slots.ends);
        let on = |(part, of)| (part, columns(&of, part, layout.directions, length));
        let parts: Vec<(Part, PartMotion)> = parts.map(on).collect();
        let size = parts.iter().map(|(_, c)| dot(c, c)).sum::<f64>().sqrt();
        let (force, couple) = (row.child().linear, row.couple);
        JointRow {
            size: if size > 0.0 { size } else { 1.0 },
            parts,
            on_child: [
                layout.directions.in_plane(force),
                layout.directions.about_normal(couple),
            ],
        }
    };
    rows.whole().map(row).collect()
}

/// Joint coordinates at random: angles within `reach` [rad], translations within a length, attitudes rotated by about `reach`.
pub(super) fn random_coordinates(
    random: &mut SplitMix64,
    law: &JointLaw,
    numbers: &[f64],
    reach: f64,
    length: f64,
) -> Vec<f64> {
    let mut q: Vec<f64> = (0..law.coordinates())
        .map(|_| reach * random.number())
        .collect();
    let mut scalars = q.len();
    if let Some(attitude) = law.attitude() {
        scalars = attitude.start;
        q[scalars] = 1.0;
        let attitude = &mut q[attitude];
        let size = attitude.iter().map(|x| x * x).sum::<f64>().sqrt();
        attitude.iter_mut().for_each(|x| *x /= size);
    }
    let mut columns = vec![Twist::zero(); law.freedoms()];
    law.subspace(
        &Relative {
            q: &q,
            u: &[],
            numbers,
        },
        &mut columns,
    );
    for (x, column) in q.iter_mut().take(scalars).zip(&columns) {
        if column.angular.norm() == 0.0 {
            *x *= length;
        }
    }
    q
}
