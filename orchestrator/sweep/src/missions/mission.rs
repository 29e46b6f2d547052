//! Subject of a cell of an experiment of missions: a scenario.

use config::Diagnostics;

use crate::cell::Cell;
use scenario::{ResolvedScenario, Template};

/// The scenario of a cell.
#[derive(Clone)]
pub struct Mission {
    /// `true` if the processes of its missions are pinned to one core.
    pub one_core: bool,
    pub(super) template: Template,
}

impl std::fmt::Debug for Mission {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Mission")
            .field("one_core", &self.one_core)
            .finish_non_exhaustive()
    }
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
