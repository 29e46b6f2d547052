//! Subject of a cell of an experiment of missions: a scenario.

use config::Diagnostics;

use crate::cell::Cell;
use scenario::{ResolvedScenario, Template};

/// The scenario of a cell.
#[derive(Debug, Clone)]
pub struct Mission {
    /// `true` if the processes of its missions are pinned to one core.
    pub one_core: bool,
    pub(super) template: Template,
}

impl Cell<Mission> {
    /// Returns the scenario with a seed.
    ///
    /// # Errors
    /// Those that depend on the seed: there is no room for a start pose.
    pub fn scenario(&self, seed: u64) -> Result<ResolvedScenario, Diagnostics> {
        self.subject.template.with_seed(seed)
    }
}
