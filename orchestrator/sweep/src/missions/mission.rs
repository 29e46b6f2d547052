//! What a cell of an experiment of missions is about: a scenario.

use config::Diagnostics;

use crate::cell::Cell;
use scenario::{ResolvedScenario, Template};

/// The scenario of a cell.
#[derive(Clone)]
pub struct Mission {
    /// Whether the processes of its missions keep to one core.
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
    /// The scenario with a seed.
    ///
    /// # Errors
    /// Those that depend on the seed: a start that finds no room.
    pub fn scenario(&self, seed: u64) -> Result<ResolvedScenario, Diagnostics> {
        self.subject.template.with_seed(seed)
    }
}
