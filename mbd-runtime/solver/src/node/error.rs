//! What can go wrong at a node: typed, with the place and the numbers.

use std::error::Error;
use std::fmt;

use mbd_scene::Float;

use crate::list::all_finite;

/// Stiffnesses of one network further apart than this are named where its balance is not found: its sum cancels so many digits.
pub const UNEVEN: f64 = 1e5;

/// The softest and the stiffest taut line of a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uneven {
    /// Index of the softest taut line.
    pub softest: usize,
    /// Index of the stiffest taut line.
    pub stiffest: usize,
    /// Stiffness of the second over that of the first, above [`UNEVEN`].
    pub ratio: f64,
}

/// Why a node could not be placed. No force may be taken from the solver after one of these.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeError {
    /// A constant of a line is not one: K ≤ 0, L < 0, C < 0, or not finite; or its ends are no ends.
    InvalidLine {
        /// Index of the line.
        line: usize,
        /// The constant.
        what: &'static str,
        /// Its value [SI].
        value: f64,
    },
    /// The law of a line cannot hold a node.
    LineAtNode {
        /// Index of the line.
        line: usize,
        /// Why.
        why: &'static str,
    },
    /// A number is infinite or NaN.
    NotFinite {
        /// The list it stands in.
        what: &'static str,
        /// Its index there.
        index: usize,
    },
    /// A list has a wrong length.
    Shape {
        /// The list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// The node model cannot hold this scene.
    Unsupported {
        /// Index of the node.
        node: usize,
        /// Why, and what to declare instead.
        why: &'static str,
    },
    /// No balance was found within the cap of iterations.
    NotConverged {
        /// Index of the (first) node.
        node: usize,
        /// Smallest residual seen [N].
        residual_n: f64,
        /// Newton steps in all strategies.
        iterations: usize,
        /// Lines too unlike each other, where there are such.
        uneven: Option<Uneven>,
    },
}

impl NodeError {
    /// Checks the constants of one line.
    ///
    /// # Errors
    /// [`NodeError::InvalidLine`].
    pub fn check_line<T: Float>(
        line: usize,
        stiffness: T,
        damping: T,
        free_length: T,
    ) -> Result<(), NodeError> {
        for (what, value, above) in [
            ("stiffness", stiffness, stiffness > T::zero()),
            ("damping", damping, damping >= T::zero()),
            ("free length", free_length, free_length >= T::zero()),
        ] {
            if !above || !value.is_finite() {
                let value = value.to_f64();
                return Err(NodeError::InvalidLine { line, what, value });
            }
        }
        Ok(())
    }

    /// Checks that every number of a list is finite.
    ///
    /// # Errors
    /// [`NodeError::NotFinite`].
    pub fn check_finite<T: Float>(what: &'static str, list: &[T]) -> Result<(), NodeError> {
        match all_finite(list) {
            true => Ok(()),
            false => {
                let index = list.iter().position(|x| !x.is_finite());
                let index = index.unwrap_or_default();
                Err(NodeError::NotFinite { what, index })
            }
        }
    }

    /// Checks a length.
    ///
    /// # Errors
    /// [`NodeError::Shape`].
    pub fn same_length(what: &'static str, found: usize, expected: usize) -> Result<(), NodeError> {
        match found == expected {
            true => Ok(()),
            false => Err(NodeError::Shape {
                what,
                found,
                expected,
            }),
        }
    }
}

impl fmt::Display for NodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NodeError::InvalidLine { line, what, value } => {
                write!(f, "line {line}: {what} is {value}")
            }
            NodeError::LineAtNode { line, why } => {
                write!(f, "line {line} cannot end at a node: {why}")
            }
            NodeError::NotFinite { what, index } => {
                write!(f, "{what}: number {index} is not finite")
            }
            NodeError::Shape {
                what,
                found,
                expected,
            } => write!(f, "{what}: {found} numbers, expected {expected}"),
            NodeError::Unsupported { node, why } => write!(f, "node {node}: {why}"),
            NodeError::NotConverged {
                node,
                residual_n,
                iterations,
                uneven,
            } => {
                write!(
                    f,
                    "node {node}: no balance after {iterations} iterations, residual {residual_n} N"
                )?;
                match uneven {
                    Some(it) => write!(
                        f,
                        "; line {} is {:.1e} times as stiff as line {}",
                        it.stiffest, it.ratio, it.softest
                    ),
                    None => Ok(()),
                }
            }
        }
    }
}

impl Error for NodeError {}
