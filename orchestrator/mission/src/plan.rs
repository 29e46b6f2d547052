//! Conversion of a resolved scenario into the configuration of every process of the run.

use std::collections::BTreeMap;
use std::path::PathBuf;

use geometry::map::{ObstacleChange, WorldMap};
use ipc_types::bus::{Publisher, RunSpace, SendError};
use ipc_types::messages::world::ObstacleEvent;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Belief, ObstacleEvents, OptimiserPlan, Service as _, TopicId, Waypoints};
use robot::spec::RobotSpec;
use runtime::config::{Clock, RobotInfo, RunConfig};
use runtime::declaration::{Flow, Input, When, WrittenTopic};
use runtime::obstacle::{self, ObstacleMessageError};
use runtime::shapes;
use serde_json::Value as Json;
use simulator::SimulatorParams;

pub use super::launch::{Launch, Role, answering};
pub use super::obstacle_schedule::ScheduledChange;

use super::{launch, obstacle_schedule};
use scenario::spec::{self, Mode};
use scenario::{EventSpec, Program, ResolvedScenario};

/// Maximum size of the beliefs that wait for the recorder in shared memory (bytes).
const MAX_RECORDER_MEMORY: usize = 256 << 20;
/// Maximum lag of the recorder for small messages (ticks).
const MAX_RECORDER_TICKS: usize = 256;
/// Maximum lag of the recorder in real-time mode (s of real time).
const MAX_RECORDER_SECONDS: f64 = 2.0;

/// Error of planning a run.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The map cannot be built. The scenario was checked, so that only a changed file can be the cause.
    #[error(transparent)]
    Map(#[from] geometry::map::MapError),
    /// An obstacle event has an invalid shape.
    #[error(transparent)]
    Shape(#[from] geometry::shape::ShapeError),
    /// An external program has not been asked for its declaration.
    #[error(
        "process {0}: its declaration is not known: expected a command that asks for it, as `protean run`, or --allow-external"
    )]
    NotAsked(String),
    /// An obstacle event does not fit its message.
    #[error(transparent)]
    Obstacle(#[from] ObstacleMessageError),
}

/// Complete input of a run's start.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Configuration that all processes share.
    pub run: RunConfig,
    /// The processes; the index in this list is the process's index in the run. The simulator is first.
    pub launches: Vec<Launch>,
    /// Obstacle changes at known ticks, by tick; the others are on the simulator's event schedule.
    pub obstacle_changes: Vec<ScheduledChange>,
    /// Obstacles at the start of the run, for viewers.
    pub standing: Vec<ObstacleEvent>,
}

impl Plan {
    /// Plans a run of the scenario, without its place.
    ///
    /// # Errors
    /// [`PlanError`] if the map is invalid or an event does not fit its message.
    pub fn new(scenario: &ResolvedScenario, log_level: &str) -> Result<Self, PlanError> {
        if let Some(process) = scenario.processes.iter().find(|p| p.is_to_be_asked()) {
            return Err(PlanError::NotAsked(process.name.clone()));
        }
        let map = WorldMap::recent(&scenario.world.map)?;
        let run = RunConfig {
            log_level: log_level.to_owned(),
            ..run_config(scenario, &map)?
        };
        let obstacle_changes = obstacle_schedule::scheduled(&scenario.events, run.tick_period_ns)?;
        // A polygon with more corners than a message can contain is drawn by the map alone.
        let standing = map
            .obstacles()
            .iter()
            .filter_map(|o| {
                let appear = ObstacleChange::Appear {
                    id: o.id,
                    shape: o.shape.clone(),
                };
                obstacle::to_message(&appear).ok()
            })
            .collect();
        let launches = launch::launches(scenario, &run)?;
        Ok(Self {
            run,
            launches,
            obstacle_changes,
            standing,
        })
    }

    /// Gives the run its directory, its names in shared memory, and the number of ticks that a recorder may lag.
    pub fn place(&mut self, space: &RunSpace, recorder_ticks: usize) {
        let processes = self.launches.iter_mut();
        let configs = processes.map(|launch| &mut launch.config.run);
        for run in configs.chain([&mut self.run]) {
            space.root().clone_into(&mut run.root);
            space.prefix().clone_into(&mut run.prefix);
            run.recorder_ticks = recorder_ticks as u32;
        }
    }

    /// Sends the obstacle changes at ticks known in advance.
    ///
    /// # Errors
    /// [`SendError`] if the bus refuses a message.
    pub(crate) fn send_obstacle_changes(
        &self,
        obstacles: &Publisher<ObstacleEvents>,
    ) -> Result<(), SendError> {
        for change in &self.obstacle_changes {
            let mut header = PlainHeader::default();
            header.stamp.tick = change.tick;
            header.stamp.time_ns = change.tick * self.run.tick_period_ns;
            obstacles.send(header, &[change.event])?;
        }
        Ok(())
    }

    /// Returns the simulator with its parameters, and the other processes.
    pub fn split_simulator(&self) -> Option<(&Launch, &SimulatorParams, &[Launch])> {
        let (leader, followers) = self.launches.split_first()?;
        match &leader.role {
            Role::Simulator(params) => Some((leader, params, followers)),
            Role::Process(_) => None,
        }
    }

    /// Returns the index of the orchestrator as a sender.
    pub fn orchestrator_index(&self) -> u32 {
        self.launches.len() as u32
    }

    /// Returns `true` if a process of the run makes plans on request.
    pub fn serves_plans(&self) -> bool {
        let answers = Flow::Answers(OptimiserPlan::NAME);
        self.launches.iter().any(|launch| launch.writes(answers))
    }

    /// Returns `true` if the robot with this index may visit waypoints. The kind of its process decides; an external
    /// program may.
    pub fn visits_waypoints(&self, robot: u32) -> bool {
        let mut drivers = self
            .launches
            .iter()
            .filter(|launch| launch.config.robots.contains(&robot));
        drivers.any(|launch| {
            launch.declaration.is_none() || launch.writes(Flow::for_topic::<Waypoints>())
        })
    }

    /// Returns the time limit of the laps of the robot with this index (s); `None` without laps.
    pub fn lap_limit_s(&self, robot: u32) -> Option<f64> {
        let driver = self
            .launches
            .iter()
            .find(|launch| launch.config.robots.contains(&robot));
        driver?.declaration.as_ref()?.lap_limit_s
    }
}

/// Returns the configuration that all processes of a run of this scenario share, except its directory.
fn run_config(scenario: &ResolvedScenario, map: &WorldMap) -> Result<RunConfig, PlanError> {
    let mut capacities: BTreeMap<String, u32> = BTreeMap::new();
    let mut topics: BTreeMap<TopicId, bool> = BTreeMap::new();
    let mut write = |flow: Flow, elements: usize| {
        let most = capacities.entry(flow.to_string()).or_default();
        *most = u32::try_from(elements).unwrap_or(u32::MAX).max(*most);
    };
    let belief = Flow::for_topic::<Belief>();
    for process in &scenario.processes {
        let outputs = process.declaration().map(|declaration| declaration.outputs);
        for output in outputs.into_iter().flatten() {
            write(output.flow, output.elements);
            if let Flow::Topic(topic) = output.flow
                && !topic.is_built_in()
            {
                topics.insert(topic, output.when == When::NextTick);
            }
        }
        if let Program::Command { params, .. } = &process.program
            && let Some(particles) = particles(params)
        {
            write(belief, particles);
        }
    }
    write(Input::MAP.flow, map.frame().len());
    let map_points = shapes::most_points(map, EventSpec::shapes(&scenario.events))?;
    if map_points <= shapes::MAX_POINTS {
        write(Input::SHAPES.flow, map_points);
    }
    let particles = capacities.get(&belief.to_string()).copied().unwrap_or(0) as usize;
    let clock = match scenario.run.mode {
        Mode::LockStep => Clock::LockStep,
        Mode::RealTime => Clock::RealTime {
            factor: scenario.run.real_time_factor,
            deadline_ns: (scenario.run.command_deadline_s * 1e9) as u64,
        },
    };
    let (world, rules) = (&scenario.world, &scenario.world.rules);
    let robot = |(index, robot): (usize, &RobotSpec)| RobotInfo {
        name: robot.name.clone(),
        team: robot.team.clone(),
        role: robot.role(),
        opponents: (0..)
            .zip(&world.robots)
            .filter(|(_, other)| robot.is_hostile_to(other))
            .map(|(index, _)| index)
            .collect(),
        companions: scenario
            .companions(index)
            .into_iter()
            .map(|index| index as u32)
            .collect(),
        model: robot.model(),
        beams: robot.scan.as_ref().map_or(0, |scan| scan.beams as u32),
        start: robot.start,
        goal: robot.goal,
    };
    Ok(RunConfig {
        root: PathBuf::new(),
        prefix: String::new(),
        seed: scenario.run.seed,
        tick_period_ns: (scenario.run.dt * 1e9).round() as u64,
        clock,
        processor: (scenario.run.pin == spec::Pin::OneCore).then(first_processor),
        processes: scenario.processes.len() as u32 + 1,
        events: scenario.events.len() as u32,
        recorder_ticks: recorder_ticks(clock, scenario, particles) as u32,
        capacities,
        topics: topics
            .into_iter()
            .map(|(topic, later)| WrittenTopic::from_topic(topic, later))
            .collect(),
        robots: world.robots.iter().enumerate().map(robot).collect(),
        exits: map.exits().iter().chain(&rules.exits).copied().collect(),
        capture_radius: rules.capture.map_or(0.0, |c| c.radius),
        log_level: String::new(),
    })
}

/// Returns the number of particles per belief that the parameters of an external program request.
fn particles(params: &Json) -> Option<usize> {
    let key = params.pointer("/filter/particles");
    let particles = key.or_else(|| params.get("particles"))?.as_u64()?;
    Some(particles as usize).filter(|particles| *particles > 0)
}

fn recorder_ticks(clock: Clock, scenario: &ResolvedScenario, particles: usize) -> usize {
    let per_tick = scenario.world.robots.len().max(1) * particles * 16;
    let fitting = MAX_RECORDER_MEMORY
        .checked_div(per_tick)
        .unwrap_or(MAX_RECORDER_TICKS);
    match clock {
        Clock::LockStep => fitting.clamp(8, MAX_RECORDER_TICKS),
        Clock::RealTime { factor, .. } => {
            let ticks = MAX_RECORDER_SECONDS * factor / scenario.run.dt;
            fitting.clamp(8, (ticks as usize).clamp(64, 4096))
        }
    }
}

/// Returns the first processor that this process may use.
fn first_processor() -> u32 {
    rustix::thread::sched_getaffinity(None).map_or(0, |set| {
        (0..rustix::thread::CpuSet::MAX_CPU)
            .find(|&cpu| set.is_set(cpu))
            .unwrap_or(0) as u32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinds::load;

    fn plan(name: &str, overrides: &[&str]) -> Plan {
        let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        let scenario = load(name, &overrides, None).unwrap();
        Plan::new(&scenario, "warn").unwrap()
    }

    #[test]
    fn the_simulator_comes_first_with_the_driver_of_each_robot() {
        let plan = plan("chase", &[]);
        assert_eq!(plan.launches[0].config.kind, "simulator");
        let Role::Simulator(params) = &plan.launches[0].role else {
            panic!("{:?}", plan.launches[0]);
        };
        assert_eq!(params.drivers.len(), 6);
        for (robot, driver) in params.drivers.iter().enumerate() {
            let launch = &plan.launches[driver.unwrap() as usize];
            assert_eq!(launch.config.robots, [robot as u32]);
        }
        for (index, launch) in plan.launches.iter().enumerate() {
            assert_eq!(launch.config.index as usize, index);
        }
    }

    #[test]
    fn every_process_that_a_scenario_may_have_gets_a_slot() {
        use runtime::lockstep::TickBarrier;
        let prefix = format!("protean_slots{}_", std::process::id());
        let barrier = TickBarrier::create(&prefix, spec::MAX_PROCESSES + 1);
        let path = TickBarrier::path_for(&prefix);
        let found = barrier.map(|barrier| barrier.processes());
        let _ = std::fs::remove_file(path);
        assert_eq!(found.unwrap(), spec::MAX_PROCESSES + 1);
    }

    #[test]
    fn only_pursuers_that_use_beliefs_wait_for_perception() {
        let by_belief = plan("chase", &[]);
        for launch in &by_belief.launches {
            let waits = launch.config.kind == "pursuer";
            assert_eq!(
                !launch.config.upstream.is_empty(),
                waits,
                "{}",
                launch.config.name
            );
            assert_eq!(launch.is_awaited(), launch.config.kind == "perception");
            for &up in &launch.config.upstream {
                assert_eq!(by_belief.launches[up as usize].config.kind, "perception");
            }
        }
        let exact = plan("chase_exact", &[]);
        assert!(exact.launches.iter().all(|l| l.config.upstream.is_empty()));
    }

    #[test]
    fn many_particles_shorten_the_recorders_lag_instead_of_filling_memory() {
        let ticks = |n: u32| {
            let set = format!("processes.perception.params.filter.particles={n}");
            plan("chase", &[&set]).run.recorder_ticks
        };
        assert_eq!(ticks(400), MAX_RECORDER_TICKS as u32);
        assert_eq!(ticks(1_000_000), 8);
    }
}
