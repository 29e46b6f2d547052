//! A run without messages that its caller steps.

use core::time::Duration;

use geometry::pose::Twist2;
use planner_view::view::View;
use runtime::kind::DirectProcess;
use sim_backend::world::World;

use super::super::error::MissionError;
use super::processes::failed;

/// World and processes of a [`SteppedRun`](super::SteppedRun) whose processes need no messages.
pub struct DirectRun {
    pub(super) world: World,
    pub(super) processes: Vec<(String, Box<dyn DirectProcess>)>,
}

impl DirectRun {
    /// Does a whole tick of `dt`. `commands` are those of the caller's robots, by robot; those of the others are added.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails.
    pub fn step(
        &mut self,
        view: &View<'_>,
        commands: &mut [Option<Twist2>],
        dt: Duration,
    ) -> Result<(), MissionError> {
        let mut beliefs = Vec::new();
        for (name, process) in &mut self.processes {
            let beliefs_of_tick = View {
                beliefs: &beliefs,
                ..*view
            };
            let steered = process.steer(&beliefs_of_tick, commands);
            steered.map_err(|source| failed(name, Some(self.world.tick()), source))?;
            process.beliefs(&mut beliefs);
        }
        self.world.step(commands, dt);
        Ok(())
    }

    /// Returns the world.
    pub fn world(&self) -> &World {
        &self.world
    }
}
