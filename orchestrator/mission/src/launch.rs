//! One process of a run: its program, configuration and supervision.

use runtime::config::{ProcessConfig, RunConfig, document};
use runtime::kind::{Need, Product};
use runtime::obstacle::ObstacleMessageError;
use serde::{Serialize, Serializer};
use simulator::SimulatorParams;

use super::child_process::Executable;
use super::obstacle_schedule;
use scenario::kind::ConfiguredKind;
use scenario::{Program, ResolvedScenario, Supervision};

/// Role of a process in its run, with its parameters.
#[derive(Debug, Clone)]
pub enum Role {
    /// The simulator of the world, which leads the tick barrier.
    Simulator(Box<SimulatorParams>),
    /// A process of the scenario.
    Process(Program),
}

/// One process to be started.
#[derive(Debug, Clone)]
pub struct Launch {
    /// Role of the process.
    pub role: Role,
    /// Configuration beside its parameters.
    pub config: ProcessConfig,
    /// `true` if other processes wait for it.
    pub watched: bool,
    /// Supervision of the process.
    pub supervision: Supervision,
}

impl Launch {
    /// Returns its kind, if it is a kind of scenarios.
    pub fn kind(&self) -> Option<&ConfiguredKind> {
        match &self.role {
            Role::Simulator(_) => None,
            Role::Process(program) => program.kind(),
        }
    }

    /// Returns `true` if it makes this product for others; always `false` for an external program.
    pub fn makes(&self, product: Product) -> bool {
        self.kind().is_some_and(|kind| kind.kind().makes(product))
    }

    /// Returns the program to execute.
    pub fn executable(&self) -> Executable {
        match &self.role {
            Role::Process(Program::Command { words, folder, .. }) => Executable::Command {
                words: words.clone(),
                folder: folder.clone(),
            },
            Role::Simulator(_) | Role::Process(Program::Kind(_)) => {
                Executable::Kind(self.config.kind.clone())
            }
        }
    }
}

/// Writes the configuration as the process reads it.
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

/// Returns the processes of a scenario in their order; the simulator comes first.
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
        // The inputs of an external program are unknown: it steps after all possible inputs.
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
        // A run needs its simulator.
        supervision: Supervision {
            ready_timeout_s: scenario.run.ready_timeout_s,
            ..Supervision::default()
        },
    })
}
