//! Shared resources of the processes of a run: directory, bus, topics and tick barrier.

use std::path::Path;
use std::sync::Arc;

use ipc_types::bus::{AnyTopic, Bus, BusError, BusOptions, TopicHolder};
use ipc_types::topics::{OptimiserPlan, TopicId};
use runtime::lockstep::TickBarrier;

use super::error::MissionError;
use super::plan::Plan;
use super::run_directory::{self, RunDirectory};
use super::shm_usage;
use scenario::ResolvedScenario;

/// Shared resources of a run. Dropping them removes them.
pub struct RunResources {
    /// Plan of the run.
    pub plan: Plan,
    /// Tick barrier of the processes.
    pub barrier: Arc<TickBarrier>,
    topics: Vec<TopicHolder>,
    /// Connection of the orchestrator to the topics. It holds the lock of the shared memory: dropped after all else in it.
    pub bus: Bus,
    // Must be last: all resources of the run must be closed before it is removed.
    directory: RunDirectory,
}

impl RunResources {
    /// Creates the resources of a run of this scenario; `bus` may change the options of its bus.
    ///
    /// # Errors
    /// [`MissionError`] if shared memory is full, or the system refuses.
    pub fn create(
        scenario: &ResolvedScenario,
        log_level: &str,
        bus: impl FnOnce(BusOptions) -> BusOptions,
    ) -> Result<Self, MissionError> {
        Self::of_plan(Plan::new(scenario, log_level)?, bus)
    }

    /// Creates the resources of a planned run, and gives it its place; `bus` may change the options of its bus.
    ///
    /// # Errors
    /// As [`Self::create`].
    pub(super) fn of_plan(
        mut plan: Plan,
        bus: impl FnOnce(BusOptions) -> BusOptions,
    ) -> Result<Self, MissionError> {
        // Removes the remains of killed orchestrators. A failure matters only if this run gets no directory, which
        // `create` reports.
        let _ = run_directory::clean();
        shm_usage::check_start()?;
        let directory = RunDirectory::create()?;
        let space = directory.space();
        let options = bus(plan.run.bus_options());
        plan.place(space, options.recorder_ticks);
        let bus = Bus::join(space, options, "orchestrator")?;
        let topics = create_topics(&bus, &plan)?;
        let barrier = Arc::new(TickBarrier::create(
            space.prefix(),
            plan.run.processes as usize,
        )?);
        Ok(Self {
            plan,
            barrier,
            topics,
            bus,
            directory,
        })
    }

    /// Returns the directory of the run.
    pub fn root(&self) -> &Path {
        self.directory.space().root()
    }

    /// Returns `true` if a process subscribes to a topic.
    pub(super) fn is_heard(&self, topic: TopicId) -> bool {
        let mut topics = self.topics.iter();
        topics.any(|held| held.topic() == topic.name() && held.listeners() > 0)
    }

    /// Returns `true` if a process outside the run subscribes to a topic of the run.
    pub fn has_listeners(&self) -> bool {
        self.topics.iter().any(|topic| topic.listeners() > 0)
    }
}

/// Creates the services of all topics, and those for plans if a process makes them.
fn create_topics(bus: &Bus, plan: &Plan) -> Result<Vec<TopicHolder>, BusError> {
    let topics = AnyTopic::all().into_iter();
    let mut held: Vec<TopicHolder> = topics
        .map(|topic| topic.create(bus))
        .collect::<Result<_, _>>()?;
    if plan.serves_plans() {
        held.extend(bus.create_service::<OptimiserPlan>()?);
    }
    Ok(held)
}
