//! One process of a run: its program, configuration and supervision.

use std::time::Duration;

use ipc_types::topics::{OptimiserPlan, Service as _};
use runtime::config::{ProcessConfig, RunConfig, document, ticks_within};
use runtime::declaration::{self, Declaration, Flow};
use runtime::link::Link;
use runtime::obstacle::ObstacleMessageError;
use serde::{Serialize, Serializer};
use simulator::SimulatorParams;

use super::child_process::Executable;
use super::obstacle_schedule;
use scenario::kind::ConfiguredKind;
use scenario::{ProcessSpec, Program, ResolvedScenario, Supervision};

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
    /// Inputs and outputs; `None` for an external program, which alone knows them.
    pub declaration: Option<Declaration>,
    /// Supervision of the process.
    pub supervision: Supervision,
}

impl Launch {
    /// Returns its program; `None` for the simulator.
    pub(super) fn program(&self) -> Option<&Program> {
        match &self.role {
            Role::Simulator(_) => None,
            Role::Process(program) => Some(program),
        }
    }

    /// Returns its kind, if it is a kind of scenarios.
    pub fn kind(&self) -> Option<&ConfiguredKind> {
        self.program()?.kind()
    }

    /// Returns `true` if it is known to write this flow.
    pub fn writes(&self, flow: Flow) -> bool {
        let declaration = self.declaration.as_ref();
        declaration.is_some_and(|declaration| declaration.output(flow).is_some())
    }

    /// Returns `true` if it is known to read this flow.
    pub fn reads(&self, flow: Flow) -> bool {
        let declaration = self.declaration.as_ref();
        declaration.is_some_and(|declaration| declaration.input(flow).is_some())
    }

    /// Returns `true` if other processes may wait for its output of a tick, beside the tick itself.
    pub fn is_awaited(&self) -> bool {
        let declaration = self.declaration.as_ref();
        self.config.index != 0 && declaration.is_some_and(Declaration::is_within_tick)
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
    let declarations: Vec<Option<Declaration>> = scenario
        .processes
        .iter()
        .map(ProcessSpec::declaration)
        .collect();
    let upstream = declaration::upstream(&declarations);
    let mut links = scenario.links_by_receiver().into_iter();
    let to_simulator = links.next().unwrap_or_default();
    let processes = scenario.processes.iter().zip(1..);
    let mut launches = vec![simulator(scenario, run, &declarations, to_simulator)?];
    let flows = declarations.into_iter().zip(upstream).zip(links);
    launches.extend(processes.zip(flows).map(
        |((process, index), ((declaration, upstream), links))| {
            Launch {
                role: Role::Process(process.program.clone()),
                config: ProcessConfig {
                    run: run.clone(),
                    name: process.name.clone(),
                    kind: process
                        .program
                        .kind()
                        .map_or("external", |kind| kind.kind().name)
                        .into(),
                    index,
                    robots: process.robots.iter().map(|&r| r as u32).collect(),
                    // The simulator is before them.
                    upstream: upstream.into_iter().map(|at| at as u32 + 1).collect(),
                    period: process.period,
                    links,
                },
                declaration,
                supervision: process.supervision,
            }
        },
    ));
    Ok(launches)
}

/// Returns the processes of a run that may be asked by `asking`, and are none of them: no topic carries requests and answers.
pub fn answering<'a>(
    asking: &[Launch],
    all: &'a [Launch],
) -> impl Iterator<Item = &'a Launch> + use<'a> {
    let answers = Flow::Answers(OptimiserPlan::NAME);
    let asks = |launch: &Launch| launch.declaration.is_none() || launch.reads(answers);
    let indices: Vec<u32> = asking.iter().map(|launch| launch.config.index).collect();
    let found = if asking.iter().any(asks) { all } else { &[] };
    found
        .iter()
        .filter(move |launch| launch.writes(answers) && !indices.contains(&launch.config.index))
}

/// Returns the number of ticks after its own for which a command of a process counts: until the next one is due. Over a link
/// with losses it may take longer, up to the deadline of commands.
fn hold_ticks(
    scenario: &ResolvedScenario,
    run: &RunConfig,
    process: &ProcessSpec,
    link: Option<&Link>,
) -> u64 {
    let until_next = process.period - 1 + link.map_or(0, |link| link.delay);
    if link.is_none_or(|link| link.loss <= 0.0) {
        return until_next;
    }
    let tick_period = Duration::from_nanos(run.tick_period_ns);
    let deadline_ns = (scenario.run.command_deadline_s * 1e9).round() as u64;
    until_next + ticks_within(deadline_ns, tick_period)
}

fn simulator(
    scenario: &ResolvedScenario,
    run: &RunConfig,
    declarations: &[Option<Declaration>],
    links: Vec<Link>,
) -> Result<Launch, ObstacleMessageError> {
    let mut drivers: Vec<Option<u32>> = vec![None; scenario.world.robots.len()];
    let mut holds = vec![0; drivers.len()];
    for ((process, declaration), index) in scenario.processes.iter().zip(declarations).zip(1..) {
        let drives = declaration.as_ref().is_none_or(Declaration::drives_robots);
        for &robot in process.robots.iter().filter(|_| drives) {
            if let Some((driver, hold)) = drivers.get_mut(robot).zip(holds.get_mut(robot)) {
                *driver = Some(index);
                *hold = hold_ticks(
                    scenario,
                    run,
                    process,
                    links.iter().find(|l| l.source == index),
                );
            }
        }
    }
    let params = SimulatorParams {
        world: scenario.world.clone(),
        blur_sigma: scenario.blur_sigma,
        drivers,
        holds,
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
            period: 1,
            links,
        },
        declaration: Some(Declaration::of_simulator()),
        // A run needs its simulator.
        supervision: Supervision {
            ready_timeout_s: scenario.run.ready_timeout_s,
            ..Supervision::default()
        },
    })
}
