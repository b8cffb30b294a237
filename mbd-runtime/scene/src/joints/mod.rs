//! Joints: what each forbids, as rows, and what it allows, as joint coordinates. One file a joint, and the one list of them.
//!
//! A new joint is one file and one word in `joints!` below: its keyword, its fields, the serialised form, its rows at the three levels,
//! its motion and its place in the list of joints follow. Both tellings check each other in one contract test for all joints.
//!
//! Frame 1 is the joint's place on the parent, frame 2 its place on the child. An axis has the same components in both.
//! Source of the rows: J. W. Kamman, ME 6590, Connecting Joints, Part I; derivatives of every row in [`crate::rows`].

mod carried;
mod joint_forces;

pub use carried::{Carried, HeldDirection};
pub use joint_forces::{
    CommandFilter, FILTER, FORCE, JointForceField, JointForces, MOTOR, MOTOR_ACCELERATION,
    MOTOR_RATE, Measured, NUMBERS, START, START_RATE, STOP_ORDER, STOPS, Side, in_order,
};

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::rows::{Ends, Rows};
pub use crate::vocabulary::{Coupled, MOST_COUPLED, Relation};
use crate::vocabulary::{dimension, motion};
pub use crate::{Axis, Coordinate, Field, Fields, Measure, Pose, Relative, Rule, Twist};
use crate::{Formula, Real};

/// Where the branch that a joint means meets another one: there its rows have no rank, and beyond it there is no knowing which of them it is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// What the first number of [`JointDefinition::branch`] is at least while a run goes on.
    pub least: f64,
    /// What is said of a joint that came there, behind its name.
    pub told: &'static str,
    /// How a run keeps away from there.
    pub remedy: &'static str,
}

/// What a joint must say about itself.
pub trait JointDefinition: Sized {
    /// Freedoms: the number of speeds u.
    const FREEDOMS: usize;
    /// The number of joint coordinates q: one more than speeds for an attitude, which is a quaternion.
    const COORDINATES: usize = Self::FREEDOMS;
    /// One line for the list of joints.
    const SUMMARY: &'static str;
    /// Whether its rows use the axes of frame 1 and of frame 2. A point with mass has none, and can be the end of a joint that asks for none.
    const AXES: [bool; 2] = [true; 2];

    /// Where motion may take it to another branch; `None` where no motion does.
    const FOLD: Option<Fold> = None;

    /// Reads its fields: the only place that says which there are.
    fn read(fields: &mut dyn Fields) -> Self;

    /// Its numbers, in the order in which [`Ends::number`] and [`Relative::number`] hand them back.
    fn numbers(&self) -> Vec<(&'static Field, &Formula)> {
        Vec::new()
    }

    /// The same numbers in the same order, to be changed.
    fn numbers_mut(&mut self) -> Vec<&mut Formula> {
        Vec::new()
    }

    /// What it forbids between its two ends: adds 6 − freedoms rows. A coupling has none of its own: see [`JointDefinition::couples`].
    fn constrain<S: Real>(&self, _ends: &Ends<'_, S>, _rows: &mut Rows<S>) {}

    /// Of a coupling the coordinates of other joints that it relates by its one row: joint and number of the coordinate, first the one that
    /// follows; the joint sits where that one's joint does. Empty for a joint between two places.
    fn couples(&self) -> &[(usize, usize)] {
        &[]
    }

    /// The relation of these coordinates, from its numbers; no factor is zero.
    fn relation<S: Real>(&self, _numbers: &[S]) -> Option<Relation<S>> {
        None
    }

    /// H and N of its child's velocity: see [`Carried`]. `None` where its rows do not split the velocity in closed form: they then stay rows of
    /// the system. `own`: the ends are written in the child's own components, and the solver is free in the axes of the angular parts.
    fn carried<S: Real>(&self, _ends: &Ends<'_, S>, _own: bool) -> Option<Carried<S>> {
        None
    }

    /// The same joint about z, and its axis, where this is all that its motion knows of the directions of the joint frames: between frames rotated
    /// so that the axis is z it is the same, and z leaves zeros in relative coordinates.
    fn about_z(&self) -> Option<(Self, Axis)> {
        None
    }

    /// What it allows: frame 2 in frame 1. A coupling places nothing.
    fn motion<S: Real>(&self, _at: &Relative<'_, S>) -> Pose<S> {
        Pose::identity()
    }

    /// The columns of H: velocity of frame 2 in frame 1 = H u, in frame-1 axes. Writes one column a freedom.
    fn subspace<S: Real>(&self, _at: &Relative<'_, S>, _columns: &mut [Twist<S>]) {}

    /// b: acceleration of frame 2 in frame 1 = H u̇ + b, in frame-1 axes.
    fn bias<S: Real>(&self, _at: &Relative<'_, S>) -> Twist<S> {
        Twist::zero()
    }

    /// q̇ of the speeds.
    fn rates<S: Real>(&self, at: &Relative<'_, S>, rates: &mut [S]) {
        for (index, rate) in rates.iter_mut().enumerate() {
            *rate = at.u(index);
        }
    }

    /// Its measurable coordinate number `index`, which is q(index); `None` where there is no scalar that measures it.
    fn coordinate(&self, _index: usize) -> Option<Coordinate> {
        None
    }

    /// Three numbers that are positive on the branch the joint means: its rows have other roots. 1 where nothing needs a test.
    fn branch<S: Real>(&self, _ends: &Ends<'_, S>) -> [S; 3] {
        [S::one(); 3]
    }
}

/// The one list: keyword (and file) and type of every joint, last that of what events make.
macro_rules! joints {
    ($($keyword:ident $name:ident),* $(,)?) => {
        $(
            mod $keyword;
            pub use $keyword::$name;
        )*

        /// What a joint allows.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        pub enum JointLaw {
            $(
                #[doc = concat!("Keyword `", stringify!($keyword), "`.")]
                $name($name),
            )*
        }

        impl JointLaw {
            /// The keywords, in the order of the list; that of what events make is none.
            pub const KEYWORDS: &'static [&'static str] =
                all_but_last(&[$(stringify!($keyword)),*]);
            /// One line a joint: keyword, freedoms, what it is.
            pub const CATALOGUE: &'static [(&'static str, usize, &'static str)] = all_but_last(&[
                $((stringify!($keyword), <$name as JointDefinition>::FREEDOMS, <$name as JointDefinition>::SUMMARY)),*
            ]);

            /// Whether the rows of a joint use the axes of its parent end and of its child end: see [`JointDefinition::AXES`].
            pub const AXES: &'static [(&'static str, [bool; 2])] = all_but_last(&[
                $((stringify!($keyword), <$name as JointDefinition>::AXES)),*
            ]);

            /// Reads the joint of a keyword; `None` if there is none of that name.
            pub fn read(keyword: &str, fields: &mut dyn Fields) -> Option<Self> {
                match keyword {
                    $(stringify!($keyword) => Some(JointLaw::$name($name::read(fields))),)*
                    _ => None,
                }
            }

            /// Its keyword.
            #[must_use]
            pub fn keyword(&self) -> &'static str {
                match self {
                    $(JointLaw::$name(_) => stringify!($keyword),)*
                }
            }

            /// Its freedoms: the number of its speeds.
            #[must_use]
            pub fn freedoms(&self) -> usize {
                match self {
                    $(JointLaw::$name(_) => <$name as JointDefinition>::FREEDOMS,)*
                }
            }

            /// The number of its coordinates.
            #[must_use]
            pub fn coordinates(&self) -> usize {
                match self {
                    $(JointLaw::$name(_) => <$name as JointDefinition>::COORDINATES,)*
                }
            }

            /// Its numbers: see [`JointDefinition::numbers`].
            #[must_use]
            pub fn numbers(&self) -> Vec<(&'static Field, &Formula)> {
                match self {
                    $(JointLaw::$name(joint) => joint.numbers(),)*
                }
            }

            /// Its numbers, to be changed: see [`JointDefinition::numbers_mut`].
            pub fn numbers_mut(&mut self) -> Vec<&mut Formula> {
                match self {
                    $(JointLaw::$name(joint) => joint.numbers_mut(),)*
                }
            }

            /// Adds its rows: see [`JointDefinition::constrain`].
            pub fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
                match self {
                    $(JointLaw::$name(joint) => joint.constrain(ends, rows),)*
                }
            }

            /// The coordinates that it relates: see [`JointDefinition::couples`].
            #[must_use]
            pub fn couples(&self) -> &[(usize, usize)] {
                match self {
                    $(JointLaw::$name(joint) => joint.couples(),)*
                }
            }

            /// Their relation: see [`JointDefinition::relation`].
            #[must_use]
            pub fn relation<S: Real>(&self, numbers: &[S]) -> Option<Relation<S>> {
                match self {
                    $(JointLaw::$name(joint) => joint.relation(numbers),)*
                }
            }

            /// H and N of its child's velocity: see [`JointDefinition::carried`].
            pub fn carried<S: Real>(&self, ends: &Ends<'_, S>, own: bool) -> Option<Carried<S>> {
                match self {
                    $(JointLaw::$name(joint) => joint.carried(ends, own),)*
                }
            }

            /// The same joint about z, and its axis: see [`JointDefinition::about_z`].
            #[must_use]
            pub fn about_z(&self) -> Option<(Self, Axis)> {
                match self {
                    $(JointLaw::$name(joint) => {
                        joint.about_z().map(|(joint, axis)| (JointLaw::$name(joint), axis))
                    })*
                }
            }

            /// Frame 2 in frame 1: see [`JointDefinition::motion`].
            pub fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
                match self {
                    $(JointLaw::$name(joint) => joint.motion(at),)*
                }
            }

            /// The columns of H: see [`JointDefinition::subspace`].
            pub fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
                match self {
                    $(JointLaw::$name(joint) => joint.subspace(at, columns),)*
                }
            }

            /// b: see [`JointDefinition::bias`].
            pub fn bias<S: Real>(&self, at: &Relative<'_, S>) -> Twist<S> {
                match self {
                    $(JointLaw::$name(joint) => joint.bias(at),)*
                }
            }

            /// q̇ of the speeds: see [`JointDefinition::rates`].
            pub fn rates<S: Real>(&self, at: &Relative<'_, S>, rates: &mut [S]) {
                match self {
                    $(JointLaw::$name(joint) => joint.rates(at, rates),)*
                }
            }

            /// Its measurable coordinate number `index`: see [`JointDefinition::coordinate`].
            #[must_use]
            pub fn coordinate(&self, index: usize) -> Option<Coordinate> {
                match self {
                    $(JointLaw::$name(joint) => joint.coordinate(index),)*
                }
            }

            /// Where motion may take it to another branch.
            #[must_use]
            pub fn fold(&self) -> Option<Fold> {
                match self {
                    $(JointLaw::$name(_) => <$name as JointDefinition>::FOLD,)*
                }
            }

            /// Whether its rows are on the branch it means: see [`JointDefinition::branch`].
            pub fn branch<S: Real>(&self, ends: &Ends<'_, S>) -> [S; 3] {
                match self {
                    $(JointLaw::$name(joint) => joint.branch(ends),)*
                }
            }
        }
    };
}

joints! {
    free Free,
    rigid Rigid,
    hinge Hinge,
    spherical Spherical,
    universal Universal,
    prismatic Prismatic,
    cylindrical Cylindrical,
    planar Planar,
    screw Screw,
    distance Distance,
    point_on_line PointOnLine,
    point_on_plane PointOnPlane,
    constant_angle ConstantAngle,
    constant_velocity ConstantVelocity,
    gear Gear,
    lock Lock,
}

/// The joints that a declaration names: the last of the list, a lock, is made by events.
const fn all_but_last<T>(list: &'static [T]) -> &'static [T] {
    match list {
        [declared @ .., _] => declared,
        [] => list,
    }
}

impl JointLaw {
    /// Its rows: 6 − freedoms.
    #[must_use]
    pub fn rows(&self) -> usize {
        6 - self.freedoms()
    }

    /// The coordinates that are an attitude, a quaternion w x y z: the last four where there are more coordinates than speeds.
    #[must_use]
    pub fn attitude(&self) -> Option<Range<usize>> {
        let count = self.coordinates();
        (count > self.freedoms()).then(|| count - 4..count)
    }

    /// How the language calls what the filter of a motor makes of its command: `command`; `angle_command` among several coordinates.
    #[must_use]
    pub fn command_word(&self, coordinate: &Coordinate) -> String {
        match self.measured().count() {
            1 => "command".to_owned(),
            _ => format!("{}_command", coordinate.name),
        }
    }

    /// How the language calls the force or torque of a motor along a coordinate: `motor_torque`; `angle_motor_torque` among several.
    #[must_use]
    pub fn motor_word(&self, coordinate: &Coordinate) -> String {
        let effort = if coordinate.is_angle() {
            "motor_torque"
        } else {
            "motor_force"
        };
        match self.measured().count() {
            1 => effort.to_owned(),
            _ => format!("{}_{effort}", coordinate.name),
        }
    }

    /// Its measurable coordinates, in order.
    pub fn measured(&self) -> impl Iterator<Item = Coordinate> + '_ {
        (0..self.coordinates()).map_while(|index| self.coordinate(index))
    }
}
