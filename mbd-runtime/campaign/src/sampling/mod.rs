//! Where in (0, 1) every dispersed number of every case lies: a function of seed, name and case.

mod distribution;
mod latin;
pub mod normal;
mod philox;
mod sobol;

pub use distribution::Distribution;
pub use philox::Draws;
use serde::{Deserialize, Serialize};
use sobol::{DIMENSIONS, Sobol};

/// How the cases of a campaign are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseSampling {
    /// Every number by itself.
    #[default]
    Random,
    /// Every parameter has one case in each of as many strata as there are cases.
    Latin,
    /// Scrambled Sobol points, in the order of the names.
    Sobol,
    /// All combinations of listed values, the last name fastest.
    Grid,
}

impl CaseSampling {
    /// The words in a file.
    pub const WORDS: [(&'static str, CaseSampling); 4] = [
        ("random", CaseSampling::Random),
        ("latin", CaseSampling::Latin),
        ("sobol", CaseSampling::Sobol),
        ("grid", CaseSampling::Grid),
    ];

    /// The most numbers that can be dispersed, where there is such a limit.
    #[must_use]
    pub fn most(self) -> Option<usize> {
        (self == CaseSampling::Sobol).then_some(DIMENSIONS)
    }
}

/// The numbers in (0, 1) of one name.
#[derive(Clone, Debug)]
pub struct UnitSamples {
    draws: Draws,
    sobol: Option<Sobol>,
    strata: Option<u64>,
}

impl UnitSamples {
    /// Those of a name, the `dimension`-th of all (from 0), over so many cases.
    #[must_use]
    pub fn new(
        sampling: CaseSampling,
        seed: u64,
        name: &str,
        (dimension, cases): (usize, u64),
    ) -> Self {
        let draws = Draws::new(seed, name);
        UnitSamples {
            draws,
            sobol: (sampling == CaseSampling::Sobol).then(|| Sobol::new(dimension, draws)),
            strata: (sampling == CaseSampling::Latin).then_some(cases),
        }
    }

    /// The number of a case (from 1); further attempts are plain random numbers.
    #[must_use]
    pub fn at(&self, case: u64, attempt: u32) -> f64 {
        let index = case.saturating_sub(1);
        match (&self.sobol, self.strata) {
            (Some(sobol), _) if attempt == 0 => sobol.at(index as u32),
            (_, Some(strata)) if attempt == 0 => latin::latin(self.draws, index, strata),
            _ => self.draws.uniform(case, attempt),
        }
    }
}
