//! What an error of a step lies in: what is not finite, what is stiff, what is uneven, why a step collapsed.

use std::fmt;

use mbd_scene::plain;

/// What is not finite.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Source {
    /// A value that the caller's loads supplied: the name of the input, load or gravity slot.
    Load(String),
    /// A formula of the declaration: the load, joint or state that it belongs to, in words.
    Declared(String),
    /// The rate of a coordinate of the state, by its column name.
    State(String),
    /// The position or velocity of an equilibrium point, by name.
    Node(String),
    /// The rows of a joint, by name: what prescribes its motion has no value.
    Joint(String),
    /// A derivative that a stiff method asks for.
    Jacobian {
        /// Of the rate of this coordinate of the state, by its column name.
        rate: String,
        /// By this coordinate, or by `time`.
        by: String,
    },
}

/// Why a step shrank below what time can resolve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Collapse {
    /// The error test never passed.
    ErrorTest,
    /// An event could not be located.
    Event,
    /// The first trial was as short already: time has not the digits for it.
    Resolution,
}

/// Stiffness met by an explicit method: its stability bounds the steps, not their error.
#[derive(Clone, Debug, PartialEq)]
pub struct Stiff {
    /// The method.
    pub method: &'static str,
    /// Step times the largest rate.
    pub rho: f64,
    /// Up to where the method is stable.
    pub limit: f64,
    /// What changes fastest: `velocity of bob`, or a declared state.
    pub block: String,
    /// The line with the largest rate that holds it.
    pub line: Option<String>,
}

impl fmt::Display for Stiff {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Stiff {
            method,
            rho,
            limit,
            block,
            line,
        } = self;
        write!(
            f,
            "stiff: step times rate hρ is {rho:.2}, and {method} is stable up to {limit:.2} (`{block}`"
        )?;
        if let Some(line) = line {
            write!(f, ", held by `{line}`")?;
        }
        write!(f, ")")
    }
}

/// The softest and the stiffest taut line of a network whose balance was not found.
#[derive(Clone, Debug, PartialEq)]
pub struct UnevenLines {
    /// The softest taut line.
    pub softest: String,
    /// The stiffest taut line.
    pub stiffest: String,
    /// Stiffness of the second over that of the first. With damped stepwise lines: as a step sees it, K and what C adds.
    pub ratio: f64,
}

impl fmt::Display for UnevenLines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let UnevenLines {
            softest,
            stiffest,
            ratio,
        } = self;
        write!(
            f,
            "`{stiffest}` is {} times as stiff as `{softest}`",
            plain(*ratio, 2)
        )
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Source::Load(name) => write!(f, "`{name}` is not a finite number"),
            Source::Declared(what) => write!(f, "{what} is not a finite number"),
            Source::State(name) => write!(f, "the rate of `{name}` is not a finite number"),
            Source::Node(name) => write!(f, "the point `{name}` is not at a finite place"),
            Source::Joint(name) => write!(f, "the rows of joint `{name}` are not finite numbers"),
            Source::Jacobian { rate, by } => write!(
                f,
                "the derivative of the rate of `{rate}` by `{by}` is not a finite number"
            ),
        }
    }
}

impl Source {
    /// Where to look.
    pub(super) fn advice(&self) -> String {
        match self {
            Source::Load(name) => format!("look at what `{name}` returns at this time and state"),
            Source::Declared(_) => "look there for a division by zero, such as a direction `v / norm(v)` of what is at rest, or a root of a negative number; if it has a value there, take a smaller step".into(),
            Source::Joint(_) => "look for a time at which its motor, or a frame of the world that moves it, has no value".into(),
            Source::Jacobian { .. } => "look for a root or a norm that is zero here, or take a method without derivatives: `vern7`, `tsit5`".into(),
            Source::State(_) | Source::Node(_) => "take a smaller step; if it stays, look for a division by zero or a root of a negative number in a load".into(),
        }
    }
}

impl fmt::Display for Collapse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Collapse::ErrorTest => "the error test did not pass",
            Collapse::Event => "an event could not be located",
            Collapse::Resolution => "time does not resolve it",
        })
    }
}
