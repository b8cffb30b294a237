//! The laws of lines: each the elastic force f(s) of a line over its stretch s, and whether the line can push.
//!
//! ```text
//! pull      P = f(s) + C ṡ                                                                                      (1)
//! one-way   T = max(0, P)  if s > 0, else 0;      both ways   T = P                                             (2)
//! energy    E = ∫₀ˢ f,   of a one-way line over the positive part of s                                          (3)
//! ```
//!
//! A law is one file here and one entry of the list `laws!`: what it says differently from f = K s, whether it is one-way, and the words that
//! readers of a declaration and of generated code see. f rises with s (f′ > 0) and f(0) = 0, so that slack and taut are told by s alone and the
//! energy of a line is convex in the places of its ends. f is defined for every s: a line held taut in a trial step across s = 0 has a smooth
//! force. Damping, guards, hold modes and the stiffness matrix are the same for every law: [`laws::line`](crate::laws::line).

mod line;
mod spring;
mod table;

use serde::{Deserialize, Serialize};

use crate::{Real, Table};

/// What a law says for itself; forces in N, stretches in m, slopes in N/m. `stiffness` is f′(0), `tables` are those of the scene.
trait LineLaw {
    /// The word that declares such a line.
    fn word(&self) -> &'static str {
        "line"
    }

    /// Whether it pulls only: then it slackens, has a guard and a hold mode, and its switches are located.
    fn is_unilateral(&self) -> bool {
        true
    }

    /// f in a formula of the documentation.
    fn formula(&self) -> &'static str {
        "K s"
    }

    /// Why such a line cannot end at an equilibrium point, and what to do, as it follows the name of the point; `None`: it can.
    fn not_at_node(&self) -> Option<&'static str> {
        None
    }

    /// The table f follows; `None`: f has a declared stiffness.
    fn table(&self) -> Option<usize> {
        None
    }

    /// f′(0), where `declared` is the declared stiffness.
    fn stiffness<S: Real>(&self, _tables: &[Table], declared: S) -> S {
        declared
    }

    /// The largest f′.
    fn stiffest(&self, _tables: &[Table], stiffness: f64) -> f64 {
        stiffness
    }

    /// f(s).
    fn force<S: Real>(&self, _tables: &[Table], stiffness: S, stretch: S) -> S {
        stiffness * stretch
    }

    /// f′(s), at a knot from the right, and f(s)/s, which is f′(0) where s ≤ 0.
    fn slopes<S: Real>(&self, _tables: &[Table], stiffness: S, _stretch: S) -> [S; 2] {
        [stiffness; 2]
    }

    /// ∫₀ˢ f [J]; asked for s ≥ 0 if the law is one-way.
    fn energy<S: Real>(&self, _tables: &[Table], stiffness: S, stretch: S) -> S {
        S::from_f64(0.5) * (stiffness * (stretch * stretch))
    }
}

macro_rules! laws {
    ($($(#[doc = $doc:literal])+ $name:ident $(($index:ident: $of:ty))? = $law:expr;)+) => {
        /// The law of a line.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        pub enum LineKind {
            $($(#[doc = $doc])+ $name $(($of))?,)+
        }

        macro_rules! with {
            ($kind:expr, $it:ident => $body:expr) => {
                match $kind {
                    $(LineKind::$name $(($index))? => {
                        let $it = $law;
                        $body
                    })+
                }
            };
        }
    };
}

laws! {
    /// Tension only, f = K s: zero when slack.
    Line = line::LinearLine;
    /// Tension and compression, f = K s.
    Spring = spring::Spring;
    /// Tension only, f a table of forces over stretch: index into [`Scene::tables`](crate::Scene::tables).
    Table(index: usize) = table::OverTable(index);
}

impl LineKind {
    /// The word that declares such a line.
    #[must_use]
    pub fn word(self) -> &'static str {
        with!(self, law => law.word())
    }

    /// Whether it pulls only: then it slackens, has a guard and a hold mode, and its switches are located.
    #[must_use]
    pub fn is_unilateral(self) -> bool {
        with!(self, law => law.is_unilateral())
    }

    /// Its elastic force in a formula of the documentation: `K s`.
    #[must_use]
    pub fn formula(self) -> &'static str {
        with!(self, law => law.formula())
    }

    /// Why such a line cannot end at an equilibrium point, and what to do, as it follows the name of the point; `None`: it can.
    #[must_use]
    pub fn not_at_node(self) -> Option<&'static str> {
        with!(self, law => law.not_at_node())
    }

    /// The table its force follows: index into [`Scene::tables`](crate::Scene::tables); `None`: it has a declared stiffness.
    #[must_use]
    pub fn table(self) -> Option<usize> {
        with!(self, law => law.table())
    }

    /// The largest slope of its force [N/m]; `stiffness` is that at zero stretch.
    #[must_use]
    pub fn stiffest(self, tables: &[Table], stiffness: f64) -> f64 {
        with!(self, law => law.stiffest(tables, stiffness))
    }

    /// f′(0) [N/m] of a line with this declared stiffness.
    pub(crate) fn stiffness<S: Real>(self, tables: &[Table], declared: S) -> S {
        with!(self, law => law.stiffness(tables, declared))
    }

    /// f(s) [N].
    pub(crate) fn force<S: Real>(self, tables: &[Table], stiffness: S, stretch: S) -> S {
        with!(self, law => law.force(tables, stiffness, stretch))
    }

    /// f′(s) and f(s)/s [N/m].
    pub(crate) fn slopes<S: Real>(self, tables: &[Table], stiffness: S, stretch: S) -> [S; 2] {
        with!(self, law => law.slopes(tables, stiffness, stretch))
    }

    /// Elastic energy (3) [J].
    pub(crate) fn energy<S: Real>(self, tables: &[Table], stiffness: S, acting: S) -> S {
        with!(self, law => law.energy(tables, stiffness, acting))
    }
}
