//! One process of a run: what it is, what it is told, and how it is supervised.

use runtime::config::{ProcessConfig, RunConfig, document};
use runtime::kind::{Need, Product};
use runtime::obstacle::ObstacleMessageError;
use serde::{Serialize, Serializer};
use simulator::SimulatorParams;

use super::child_process::Executable;
use super::obstacle_schedule;
use scenario::kind::ConfiguredKind;
use scenario::{Program, ResolvedScenario, Supervision};

/// What a process is in its run, with its parameters.
#[derive(Debug, Clone)]
pub enum Role {
    /// The world, which leads the loop of the others.
    Simulator(Box<SimulatorParams>),
    /// A process of the scenario.
    Process(Program),
}

/// One process to be started.
#[derive(Debug, Clone)]
pub struct Launch {
    /// What it is.
    pub role: Role,
    /// What it is told beside its parameters.
    pub config: ProcessConfig,
    /// Whether other processes wait for it.
    pub watched: bool,
    /// How it is looked after.
    pub supervision: Supervision,
}

impl Launch {
    /// Its kind, if it is one that scenarios name.
    pub fn kind(&self) -> Option<&ConfiguredKind> {
        match &self.role {
            Role::Simulator(_) => None,
            Role::Process(program) => program.kind(),
        }
    }

    /// Whether it makes something for others; of a program of the user's that is not known.
    pub fn makes(&self, product: Product) -> bool {
        self.kind().is_some_and(|kind| kind.kind().makes(product))
    }

    /// What is executed.
    pub fn executable(&self) -> Executable {
        match &self.role {
            Role::Process(Program::Command { words, .. }) => Executable::Command(words.clone()),
            Role::Simulator(_) | Role::Process(Program::Kind(_)) => {
                Executable::Kind(self.config.kind.clone())
            }
        }
    }
}

/// As the process reads it from its configuration.
impl Serialize for Launch {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.role {
            Role::Simulator(params) => document(&self.config, params).serialize(serializer),
            Role::Process(program) => {
                document(&self.config, program.params()).serialize(serializer)
            }
        }
    }
}

/// The processes of a scenario in their order, the simulator first.
///
/// # Errors
/// [`ObstacleMessageError`] if a change of an obstacle does not fit its message.
pub(super) fn launches(
    scenario: &ResolvedScenario,
    run: &RunConfig,
) -> Result<Vec<Launch>, ObstacleMessageError> {
    let processes = || scenario.processes.iter().zip(1..);
    let providers: Vec<u32> = processes()
        .filter(|(process, _)| process.makes(Product::Beliefs))
        .map(|(_, index)| index)
        .collect();
    let mut launches = vec![simulator(scenario, run)?];
    launches.extend(processes().map(|(process, index)| {
        let kind = process.program.kind();
        // What a program of the user's reads is not known: it gets its turn when everything is there.
        let needs_belief = kind.is_none_or(|kind| kind.needs(Need::Belief));
        Launch {
            role: Role::Process(process.program.clone()),
            config: ProcessConfig {
                run: run.clone(),
                name: process.name.clone(),
                kind: kind.map_or("external", |kind| kind.kind().name).into(),
                index,
                robots: process.robots.iter().map(|&r| r as u32).collect(),
                upstream: if needs_belief {
                    providers.clone()
                } else {
                    Vec::new()
                },
            },
            watched: providers.contains(&index),
            supervision: process.supervision,
        }
    }));
    Ok(launches)
}

fn simulator(scenario: &ResolvedScenario, run: &RunConfig) -> Result<Launch, ObstacleMessageError> {
    let mut drivers: Vec<Option<u32>> = vec![None; scenario.world.robots.len()];
    for (process, index) in scenario.processes.iter().zip(1..) {
        let kind = process.program.kind();
        let drives = kind.is_none_or(|kind| kind.kind().drives_robots);
        for &robot in process.robots.iter().filter(|_| drives) {
            if let Some(driver) = drivers.get_mut(robot) {
                *driver = Some(index);
            }
        }
    }
    let params = SimulatorParams {
        world: scenario.world.clone(),
        blur_sigma: scenario.blur_sigma,
        drivers,
        event_schedule: obstacle_schedule::event_schedule(&scenario.events, run.tick_period_ns)?,
    };
    Ok(Launch {
        role: Role::Simulator(Box::new(params)),
        config: ProcessConfig {
            run: run.clone(),
            name: simulator::NAME.into(),
            kind: simulator::NAME.into(),
            index: 0,
            robots: Vec::new(),
            upstream: Vec::new(),
        },
        watched: false,
        // Without the world there is no run.
        supervision: Supervision {
            ready_timeout_s: scenario.run.ready_timeout_s,
            ..Supervision::default()
        },
    })
}
