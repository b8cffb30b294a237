//! The rounds of (1) and (2) of [`super`], for one run or for several beside each other: written once, so that a run goes through the same operations, and
//! as many rounds, wherever it is made. A run that is done, or whose move cannot be trusted, is left out of a mask, and its state stays.

use mbd_scene::{AngularVelocity, Quantity, Real};

use super::APART;
use crate::displace::{displace, square};
use crate::list::largest_size;
use crate::moving::Moving;

/// How hard (1) is tried.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// Iterations.
    pub most: u32,
    /// Whether rows are looked at again even where theory says that nothing is left of them.
    pub careful: bool,
}

/// In a step; one iteration or two are usual.
pub(crate) const STEP: Effort = Effort {
    most: 8,
    careful: false,
};
/// At the start, where rows may contradict each other.
pub(super) const START: Effort = Effort {
    most: 20,
    careful: true,
};
/// The largest turn of one iteration [rad]: beyond it the rows are nothing like their linear part.
const LARGEST_TURN: f64 = 0.7;
/// What rounding may leave of rows, in units of the scalar's last place at the largest number they are made of.
pub(super) const ROUNDED: f64 = 64.0;
/// The part of the length of the scene below which rows hold.
const HOLDS: f64 = 1e-12;

/// What stands on joints: one run, or several beside each other.
pub(crate) trait OnJoints<S: Real> {
    /// Why a move cannot be found.
    type Error;
    /// What rows and speeds are judged by.
    fn measures(&self) -> JointMeasures<S>;
    /// Reads rows at a state; their largest size, infinite where one is not finite.
    fn read(&mut self, what: Quantity, state: &[S]) -> S;
    /// Solves for the move that takes the rows out that were read last; where, of a mask, it can be trusted.
    ///
    /// # Errors
    /// Nothing can be found.
    fn solve(&mut self, state: &[S], open: S::Mask) -> Result<S::Mask, Self::Error>;
    /// The move that was solved for last.
    fn moves(&self) -> &[S];
    /// Whether it was solved with all independent rows: those left out of it may ask for more.
    fn moves_all(&self) -> bool;
    /// Moves positions by it where a mask says so.
    fn displace(&mut self, state: &mut [S], open: S::Mask);
    /// Adds it to the speeds where a mask says so.
    fn hasten(&mut self, state: &mut [S], open: S::Mask);
    /// Whether a mask holds anywhere.
    fn is_any(mask: S::Mask) -> bool;
    /// A mask where another one does not hold.
    fn but(mask: S::Mask, other: S::Mask) -> S::Mask;
}

/// What rows and speeds are judged by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointMeasures<S> {
    /// The distance from 1 to the next larger number.
    pub epsilon: f64,
    /// Length of the scene [m], and how far from the origin places of a tree may be.
    pub length: S,
    pub extent: S,
    /// How many coordinates a state has, and how many speeds stand behind them.
    pub coordinates: usize,
    pub speeds: usize,
}

impl<S: Real> JointMeasures<S> {
    /// The largest coordinate, or the length of the scene; that also where a coordinate is not finite.
    pub fn size(&self, state: &[S]) -> S {
        let coordinates = state.get(..self.coordinates);
        let largest = extent(coordinates.unwrap_or_default());
        largest.max(self.length).max(self.extent)
    }

    /// The largest speed; zero where one is not finite.
    pub fn fastest(&self, state: &[S]) -> S {
        let speeds = state.get(self.coordinates..self.coordinates + self.speeds);
        extent(speeds.unwrap_or_default())
    }

    /// What rounding may leave of rows at coordinates of a size.
    pub fn rounding(&self, size: S) -> S {
        S::from_f64(ROUNDED * self.epsilon) * size
    }

    /// The size up to which rows hold at coordinates of a size.
    pub fn held(&self, size: S) -> S {
        let part = S::from_f64(HOLDS) * self.length;
        part.max(self.rounding(size))
    }

    /// The size beyond which rows have come apart at a state.
    pub fn apart(&self, state: &[S]) -> S {
        let part = S::from_f64(APART) * self.length;
        part.max(self.rounding(self.size(state)))
    }

    /// What is no more than rounding of numbers of a size.
    fn least(&self, size: S) -> S {
        S::from_f64(4.0 * self.epsilon) * size
    }

    /// Where rows of a size and the move that took them out are so small that what it leaves, its square over the length of the scene, is lost in
    /// rounding.
    fn nothing_left(&self, norm: S, moves: &[S]) -> S::Mask {
        let part = self.length.min(S::one()) * S::from_f64(self.epsilon.sqrt());
        norm.max(largest_size(moves)).le(part)
    }
}

/// Repeats (1) where a mask says so; hands back what is left of Φ there.
pub(crate) fn project_positions<S: Real, J: OnJoints<S>>(
    joints: &mut J,
    state: &mut [S],
    effort: Effort,
    mut open: S::Mask,
) -> Result<S, J::Error> {
    let measures = joints.measures();
    let (mut before, mut left) = (S::from_f64(f64::INFINITY), S::zero());
    for _ in 0..effort.most {
        let norm = joints.read(Quantity::Constraint, state);
        left = S::select(open, norm, left);
        let size = measures.size(state);
        let unsettled = measures.least(size).lt(norm);
        // At the level of rounding another move gains nothing.
        let stalls = S::both(
            norm.le(measures.held(size)),
            (S::from_f64(0.5) * before).lt(norm),
        );
        open = J::but(S::both(open, unsettled), stalls);
        if !J::is_any(open) {
            return Ok(left);
        }
        before = norm;
        open = joints.solve(state, open)?;
        joints.displace(state, open);
        if !effort.careful && joints.moves_all() {
            let nothing = measures.nothing_left(norm, joints.moves());
            let rest = norm * S::from_f64(measures.epsilon.sqrt());
            left = S::select(S::both(open, nothing), rest, left);
            open = J::but(open, nothing);
            if !J::is_any(open) {
                return Ok(left);
            }
        }
    }
    let norm = joints.read(Quantity::Constraint, state);
    Ok(S::select(open, norm, left))
}

/// Applies (2) where a mask says so, twice where the first leaves something.
pub(crate) fn project_velocities<S: Real, J: OnJoints<S>>(
    joints: &mut J,
    state: &mut [S],
    mut open: S::Mask,
) -> Result<(), J::Error> {
    let measures = joints.measures();
    for _ in 0..2 {
        let norm = joints.read(Quantity::ConstraintRate, state);
        let fastest = measures.fastest(state);
        open = S::both(open, measures.least(fastest).lt(norm));
        if !J::is_any(open) {
            break;
        }
        open = joints.solve(state, open)?;
        joints.hasten(state, open);
        // (2) is linear: only what the solve itself lost is left.
        if joints.moves_all() {
            let lost = S::from_f64(measures.epsilon.sqrt()) * fastest;
            open = S::both(open, lost.lt(norm));
            if !J::is_any(open) {
                break;
            }
        }
    }
    Ok(())
}

/// Moves the positions of these parts by δ, shortened where it turns one of them too far.
pub(crate) fn displace_shortened<S: Real>(
    (parts, components): (&[Moving], AngularVelocity),
    state: &mut [S],
    moves: &[S],
) {
    let turns = parts.iter().map(|part| {
        let turn = moves.get(part.turns());
        square(turn.unwrap_or_default())
    });
    let most = turns.fold(S::zero(), |a, b| a.max(b)).sqrt();
    let limit = S::from_f64(LARGEST_TURN);
    let share = S::select(limit.lt(most), limit / most, S::one());
    displace((parts.iter(), components), state, moves, share);
}

/// The largest size; zero where a number is not finite, so that nothing is small beside it.
fn extent<S: Real>(list: &[S]) -> S {
    let most = largest_size(list);
    S::select(most.lt(S::from_f64(f64::INFINITY)), most, S::zero())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Lanes, Lanes4, Lanes8};

    /// Points on circles x² + y² = r² about the origin; what they are told of a point next to the origin cannot be trusted.
    struct Circles<S> {
        radius: S,
        row: S,
        /// What of the row a move takes out.
        part: f64,
        moves: [S; 2],
        /// How many moves there were.
        rounds: S,
    }

    impl<S: Real> Circles<S> {
        fn flag(mask: S::Mask) -> S {
            S::select(mask, S::one(), S::zero())
        }
    }

    impl<S: Real> OnJoints<S> for Circles<S> {
        type Error = std::convert::Infallible;

        fn measures(&self) -> JointMeasures<S> {
            JointMeasures {
                epsilon: f64::EPSILON,
                length: S::one(),
                extent: S::zero(),
                coordinates: 2,
                speeds: 2,
            }
        }

        fn read(&mut self, what: Quantity, state: &[S]) -> S {
            let is_place = what == Quantity::Constraint;
            self.part = if is_place { 0.5 } else { 1.0 };
            self.row = match is_place {
                true => state[0] * state[0] + state[1] * state[1] - self.radius * self.radius,
                false => state[0] * state[2] + state[1] * state[3],
            };
            largest_size(&[self.row])
        }

        fn solve(&mut self, state: &[S], open: S::Mask) -> Result<S::Mask, Self::Error> {
            let square = state[0] * state[0] + state[1] * state[1];
            let share = -S::from_f64(self.part) * self.row / square;
            self.moves = [share * state[0], share * state[1]];
            Ok(S::both(open, S::from_f64(1e-10).le(square)))
        }

        fn moves(&self) -> &[S] {
            &self.moves
        }

        fn moves_all(&self) -> bool {
            true
        }

        fn displace(&mut self, state: &mut [S], open: S::Mask) {
            self.rounds += Self::flag(open);
            for (x, more) in state.iter_mut().zip(self.moves) {
                *x = S::select(open, *x + more, *x);
            }
        }

        fn hasten(&mut self, state: &mut [S], open: S::Mask) {
            self.rounds += Self::flag(open);
            for (x, more) in state.iter_mut().skip(2).zip(self.moves) {
                *x = S::select(open, *x + more, *x);
            }
        }

        fn is_any(mask: S::Mask) -> bool {
            !S::select(mask, S::from_f64(f64::NAN), S::zero()).is_finite_all()
        }

        fn but(mask: S::Mask, other: S::Mask) -> S::Mask {
            S::zero().lt(S::select(other, S::zero(), Self::flag(mask)))
        }
    }

    /// State, what is left of the row, and how many moves there were.
    fn put_on<S: Real>(radius: S, mut state: [S; 4], effort: Effort) -> [S; 6] {
        let (zero, all) = (S::zero(), S::zero().le(S::zero()));
        let mut circles = Circles {
            radius,
            row: zero,
            part: 0.0,
            moves: [zero; 2],
            rounds: zero,
        };
        let Ok(left) = project_positions(&mut circles, &mut state, effort, all);
        let Ok(()) = project_velocities(&mut circles, &mut state, all);
        let [x, y, u, v] = state;
        [x, y, u, v, left, circles.rounds]
    }

    fn every_lane_makes_the_rounds_of_one<L: Lanes>() {
        // On its circle and at rest; next to it; far; at the origin, where nothing can be trusted; nowhere.
        let starts = [
            [0.6, 0.8, 0.0, 0.0],
            [0.6 + 1e-9, 0.8, 0.8, -0.6],
            [3.0, 0.4, 0.3, 1.0],
            [0.0, 0.0, 1.0, 1.0],
            [f64::NAN, 1.0, 0.0, 0.0],
            [0.5, 0.5, 2.0, 1e-9],
            [-40.0, 1.0, 7.0, 2.0],
        ];
        let radius = |number: usize| 1.0 + 0.5 * (number / 3) as f64;
        for effort in [STEP, START] {
            for shift in 0..starts.len() {
                let number = |lane| (lane + shift) % starts.len();
                let state = [0, 1, 2, 3].map(|at| L::each(|lane| starts[number(lane)][at]));
                let all = put_on(L::each(|lane| radius(number(lane))), state, effort);
                for lane in 0..L::WIDTH {
                    let number = number(lane);
                    let alone = put_on(radius(number), starts[number], effort);
                    let beside = all.map(|x| x.lane(lane));
                    // Which NaN an operation gives says nothing.
                    let same = beside.iter().zip(&alone);
                    let same =
                        same.map(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan());
                    assert!(same.min() == Some(true), "{number}: {beside:?} {alone:?}");
                }
            }
        }
    }

    #[test]
    fn every_lane_is_put_on_its_joints_in_as_many_rounds_as_alone() {
        every_lane_makes_the_rounds_of_one::<Lanes4>();
        every_lane_makes_the_rounds_of_one::<Lanes8>();
        let rounds = |state| put_on(1.0, state, STEP)[5];
        assert_eq!(rounds([0.6, 0.8, 0.0, 0.0]), 0.0);
        assert_eq!(rounds([0.6 + 1e-9, 0.8, 0.0, 0.0]), 1.0);
        let far: f64 = rounds([3.0, 0.4, 0.3, 1.0]);
        assert!(far > 4.0, "{far}");
    }
}
