//! Resources that the processes of a run share: directory, bus, topics and tick barrier.

use std::path::Path;
use std::sync::Arc;

use ipc_types::bus::{Bus, BusError, BusOptions, TopicHolder};
use ipc_types::topics::{
    OptimiserPlan, PLAN_ANSWERED_EVENT, PLAN_ASKED_EVENT, Topic, TopicVisitor, for_each_topic,
};
use runtime::lockstep::TickBarrier;

use super::error::MissionError;
use super::plan::Plan;
use super::run_directory::{self, RunDirectory};
use super::shm_usage;
use scenario::ResolvedScenario;

/// The shared resources of a run; they are removed when this is dropped.
pub struct RunResources {
    /// What the processes are to do.
    pub plan: Plan,
    /// The orchestrator's connection to the topics.
    pub bus: Bus,
    /// The barrier by which the processes take turns.
    pub barrier: Arc<TickBarrier>,
    topics: Vec<TopicHolder>,
    // Last: nothing of the run may be in use when it is wiped.
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
        // What a killed orchestrator left behind goes now; a failure to do so concerns this run only
        // if it cannot have a directory of its own, which is said below.
        let _ = run_directory::clean();
        shm_usage::check_start()?;
        let directory = RunDirectory::create()?;
        let space = directory.space();
        let plan = Plan::new(scenario, space.root(), space.prefix(), log_level)?;
        let bus = Bus::join(space, bus(plan.run.bus_options()), "orchestrator")?;
        let topics = create_topics(&bus, &plan)?;
        let barrier = Arc::new(TickBarrier::create(space.prefix(), plan.launches.len())?);
        Ok(Self {
            plan,
            bus,
            barrier,
            topics,
            directory,
        })
    }

    /// The directory of the run.
    pub fn root(&self) -> &Path {
        self.directory.space().root()
    }

    /// Whether any process listens to a topic of the run.
    pub fn has_listeners(&self) -> bool {
        self.topics.iter().any(|topic| topic.listeners() > 0)
    }
}

/// Creates the services of all topics, and those for plans if a process makes them.
fn create_topics(bus: &Bus, plan: &Plan) -> Result<Vec<TopicHolder>, BusError> {
    struct Create<'a>(&'a Bus, Vec<TopicHolder>);
    impl TopicVisitor for Create<'_> {
        type Error = BusError;
        fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
            self.1.push(self.0.create::<T>()?);
            Ok(())
        }
    }
    let mut create = Create(bus, Vec::new());
    for_each_topic(&mut create)?;
    if plan.serves_plans() {
        create.1.push(bus.create_service::<OptimiserPlan>()?);
        create.1.push(bus.create_event(PLAN_ASKED_EVENT)?);
        create.1.push(bus.create_event(PLAN_ANSWERED_EVENT)?);
    }
    Ok(create.1)
}
