//! All that is wrong with a file: what does not depend on each other is told in one go.

use std::path::Path;

use super::names::{PlanError, wrong};

/// Settings that cannot be used, in the order in which they were found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CampaignMistakes {
    list: Vec<PlanError>,
}

impl CampaignMistakes {
    /// What was made; `None` of what was not, which is noted.
    pub(crate) fn note<T>(&mut self, made: Result<T, impl Into<CampaignMistakes>>) -> Option<T> {
        made.map_err(|wrong| self.list.extend(wrong.into().list))
            .ok()
    }

    /// The first of them, for whoever tells one.
    pub(crate) fn first(self) -> PlanError {
        let first = self.list.into_iter().next();
        first.unwrap_or_else(|| wrong("run", "cannot be planned"))
    }

    /// The same, each text behind a word on where it belongs.
    pub(crate) fn of(mut self, owner: &str) -> Self {
        for wrong in &mut self.list {
            wrong.text = format!("{owner}{}", wrong.text);
        }
        self
    }

    /// What was made where nothing was noted.
    ///
    /// # Errors
    /// All that was noted.
    pub(crate) fn unless<T>(self, made: Option<T>) -> Result<T, CampaignMistakes> {
        match made {
            Some(made) if self.list.is_empty() => Ok(made),
            _ => Err(self),
        }
    }

    /// Each on a line of its own, behind the name of the file.
    #[must_use]
    pub fn of_file(&self, file: &Path) -> String {
        let file = file.display();
        let lines = self.list.iter().map(|wrong| format!("{file}: {wrong}"));
        lines.collect::<Vec<_>>().join("\n")
    }
}

impl From<PlanError> for CampaignMistakes {
    fn from(wrong: PlanError) -> Self {
        CampaignMistakes { list: vec![wrong] }
    }
}
