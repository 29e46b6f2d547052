//! A look at the running episode of an instance.

use scenario::ResolvedScenario;
use sim_backend::world::World;

use crate::episode::Episode;
use crate::error::EnvironmentError;

/// The running episode of an instance, for as long as the look lasts.
#[derive(Debug)]
pub struct RunningEpisode<'a> {
    /// Seed of the scenario.
    pub seed: u64,
    /// The world.
    pub world: &'a World,
    pub(crate) episode: &'a Episode,
    pub(crate) last: Option<&'a Episode>,
}

/// Function that sees the running episode.
pub type Look = Box<dyn FnOnce(&RunningEpisode<'_>) + Send>;

impl RunningEpisode<'_> {
    /// Returns the scenario.
    ///
    /// # Errors
    /// [`EnvironmentError`] as when the episode began.
    pub fn scenario(&self) -> Result<ResolvedScenario, EnvironmentError> {
        self.episode.shared.scenario(self.seed)
    }
}
