//! A run in one thread that its caller steps, without recorder and log.

use std::collections::BTreeMap;

use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::topics::{Belief, ObstacleEvents};
use runtime::inputs::{BeliefInput, Latest};
use scenario::ResolvedScenario;
use scenario::kind::ConfiguredKind;
use scenario::spec::Mode;
use sim_backend::world::World;

use super::super::error::{InProcessError, MissionError};
use super::super::plan::Plan;
use super::Cache;
use super::direct::DirectRun;
use super::local_run::LocalRun;

/// A run in one thread, tick by tick. Its history is that of [`run`](super::run) with the same scenario and kinds.
///
/// A tick has two parts: [`Self::sense`] publishes the state, on which all processes step but those of the caller and
/// those that wait for them; [`Self::act`] steps these, and then the world.
pub struct SteppedRun {
    processes: LocalRun,
    beliefs: Option<BeliefInput>,
    // Obstacle changes that are still to come wait in its memory.
    _obstacles: Publisher<ObstacleEvents>,
}

impl SteppedRun {
    /// Opens all processes of a run. `own` are the kinds of the caller's processes, by the name of the process; they run
    /// in the place of the scenario's. `beliefs` is `true` if [`Self::beliefs`] is used.
    ///
    /// # Errors
    /// As [`run`](super::run).
    pub fn open(
        scenario: &ResolvedScenario,
        own: &BTreeMap<String, ConfiguredKind>,
        beliefs: bool,
        cache: &Cache,
    ) -> Result<Self, MissionError> {
        if scenario.run.mode == Mode::RealTime {
            return Err(InProcessError::RealTime.into());
        }
        let plan = Plan::new(scenario, "warn")?;
        let bus = Bus::local(plan.run.bus_options());
        let obstacles = bus.publisher(PublisherOptions::new(plan.orchestrator_index(), 1))?;
        let robots = scenario.world.robots.len();
        let beliefs = beliefs.then(|| BeliefInput::open(&bus, robots));
        let beliefs = beliefs.transpose()?;
        let mut processes = LocalRun::open_with(&plan, own, &bus, &cache.maps, None)?;
        if let Some(beliefs) = &beliefs {
            beliefs.connect()?;
        }
        processes.connect()?;
        plan.send_obstacle_changes(&obstacles)?;
        processes.prepare()?;
        Ok(Self {
            processes,
            beliefs,
            _obstacles: obstacles,
        })
    }

    /// Publishes the state of the current tick, and steps the processes that wait for none of the caller's. Returns
    /// `true` if the game is over; this last tick has no steps of processes.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails.
    pub fn sense(&mut self) -> Result<bool, MissionError> {
        if self.processes.sense()? {
            return Ok(true);
        }
        if let Some(beliefs) = &mut self.beliefs {
            beliefs.update()?;
        }
        Ok(false)
    }

    /// Steps the caller's processes and those that wait for them, and then the world.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails.
    pub fn act(&mut self) -> Result<(), MissionError> {
        self.processes.act()?;
        self.processes.advance();
        Ok(())
    }

    /// Returns the same run without messages, if all processes but the caller's need none. Links and events of the scenario,
    /// and observed beliefs, are the caller's to exclude.
    ///
    /// # Errors
    /// Itself, if a process needs messages.
    pub fn into_direct(self) -> Result<DirectRun, Box<Self>> {
        self.processes.into_direct().map_err(|processes| {
            Box::new(Self {
                processes: *processes,
                ..self
            })
        })
    }

    /// Returns the world.
    pub fn world(&self) -> &World {
        self.processes.world()
    }

    /// Returns the newest belief about every opponent.
    pub fn beliefs(&self) -> &[Latest<Belief>] {
        self.beliefs.as_ref().map_or(&[], |beliefs| &beliefs.latest)
    }
}
