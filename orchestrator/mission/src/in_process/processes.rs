//! The processes of a run in one thread.

use std::collections::BTreeMap;

use ipc_types::bus::Bus;
use runtime::declaration;
use runtime::{Process, ProcessConfig, ProcessError};
use scenario::kind::ConfiguredKind;

use super::super::error::InProcessError;
use super::super::plan::Launch;
use super::hosted::{Host, Hosted};

/// One process.
pub(super) struct LocalProcess {
    pub(super) name: String,
    pub(super) process: Box<dyn Process>,
}

/// Processes other than the simulator, in the order in which they step.
pub struct LocalProcesses {
    pub(super) processes: Vec<LocalProcess>,
    /// Number of processes that come before the first one with its own kind.
    early: usize,
}

impl LocalProcesses {
    /// Opens the ports of these processes.
    ///
    /// # Errors
    /// [`InProcessError`] names the process that cannot be opened.
    pub fn open(followers: &[Launch], bus: &Bus) -> Result<Self, InProcessError> {
        Self::open_with(followers, &BTreeMap::new(), bus, None)
    }

    /// Opens the ports of these processes; `programs` run in the place of those with their names, as late as possible, and
    /// external programs in that of a host.
    pub(super) fn open_with(
        followers: &[Launch],
        programs: &BTreeMap<String, ConfiguredKind>,
        bus: &Bus,
        host: Option<&Host>,
    ) -> Result<Self, InProcessError> {
        let is_late = |launch: &Launch| programs.contains_key(&launch.config.name);
        let ordered = order(followers, is_late)?;
        let first_late = ordered.iter().position(|launch| is_late(launch));
        let early = first_late.unwrap_or(ordered.len());
        let processes = ordered
            .into_iter()
            .map(|launch| {
                let program = programs.get(&launch.config.name);
                open_process(launch, followers, program, bus, host)
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { processes, early })
    }

    /// Takes processes in their order, none of them late.
    pub(super) fn from_list(processes: Vec<LocalProcess>) -> Self {
        let early = processes.len();
        Self { processes, early }
    }

    /// Drops the processes whose names `keep` refuses.
    pub(super) fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        self.early = self.early().filter(|process| keep(&process.name)).count();
        self.processes.retain(|process| keep(&process.name));
    }

    /// Connects all processes.
    ///
    /// # Errors
    /// [`InProcessError`] names the process that fails.
    pub fn connect(&mut self) -> Result<(), InProcessError> {
        each(&mut self.processes, None, |process| process.connect())
    }

    /// Lets all processes build their data of the map.
    ///
    /// # Errors
    /// [`InProcessError`] names the process that fails.
    pub fn prepare(&mut self) -> Result<(), InProcessError> {
        each(&mut self.processes, None, |process| process.prepare())
    }

    /// Steps all processes in a tick.
    ///
    /// # Errors
    /// [`InProcessError`] names the process that fails.
    pub fn step(&mut self, tick: u64) -> Result<(), InProcessError> {
        self.step_early(tick)?;
        self.step_late(tick)
    }

    /// Returns the processes that come before the first one with its own kind.
    pub(super) fn early(&self) -> impl Iterator<Item = &LocalProcess> {
        self.processes.iter().take(self.early)
    }

    /// Returns the same processes alone.
    pub(super) fn into_early(self) -> impl Iterator<Item = LocalProcess> {
        self.processes.into_iter().take(self.early)
    }

    /// Steps the processes that come before the first one with its own kind.
    pub(super) fn step_early(&mut self, tick: u64) -> Result<(), InProcessError> {
        let (early, _) = self.processes.split_at_mut(self.early);
        each(early, Some(tick), |process| process.step(tick))
    }

    /// Steps the other processes.
    pub(super) fn step_late(&mut self, tick: u64) -> Result<(), InProcessError> {
        let (_, late) = self.processes.split_at_mut(self.early);
        each(late, Some(tick), |process| process.step(tick))
    }
}

fn each(
    processes: &mut [LocalProcess],
    tick: Option<u64>,
    act: impl Fn(&mut dyn Process) -> Result<(), ProcessError>,
) -> Result<(), InProcessError> {
    processes.iter_mut().try_for_each(|it| {
        act(it.process.as_mut()).map_err(|source| failed(&it.name, tick, source))
    })
}

pub(super) fn failed(name: &str, tick: Option<u64>, source: ProcessError) -> InProcessError {
    if let ProcessError::Outside(error) = source {
        return InProcessError::Hosted(error);
    }
    let name = name.to_owned();
    let when = tick.map_or_else(
        || "before the first tick".to_owned(),
        |tick| format!("at tick {tick}"),
    );
    let source = Box::new(source);
    InProcessError::Process { name, when, source }
}

pub(super) fn open_process(
    launch: &Launch,
    all: &[Launch],
    program: Option<&ConfiguredKind>,
    bus: &Bus,
    host: Option<&Host>,
) -> Result<LocalProcess, InProcessError> {
    let name = launch.config.name.clone();
    let Some(kind) = program.or(launch.kind()) else {
        let (Some(host), Some(bus)) = (host, bus.handle()) else {
            return Err(InProcessError::External { name });
        };
        let hosted = Hosted::start(launch, all, bus, host);
        let process = Box::new(hosted.map_err(|e| InProcessError::Hosted(Box::new(e)))?);
        return Ok(LocalProcess { name, process });
    };
    // As an external program, which alone knows its kind.
    let config = ProcessConfig {
        kind: kind.kind().name.to_owned(),
        ..launch.config.clone()
    };
    let opened = kind.open(&config, bus);
    let process = opened.map_err(|source| failed(&name, None, source))?;
    Ok(LocalProcess { name, process })
}

/// Sorts the followers so that every process comes after those whose messages of the same tick it needs, and those that
/// are late after all that do not wait for them; otherwise keeps the order of the plan.
pub(super) fn order(
    followers: &[Launch],
    is_late: impl Fn(&Launch) -> bool,
) -> Result<Vec<&Launch>, InProcessError> {
    let place = |index: &u32| followers.iter().position(|l| l.config.index == *index);
    let places = |launch: &Launch| launch.config.upstream.iter().filter_map(place).collect();
    let upstream: Vec<Vec<usize>> = followers.iter().map(places).collect();
    let order = declaration::order(&upstream, |at| is_late(&followers[at]));
    match order {
        Ok(order) => Ok(order.into_iter().map(|at| &followers[at]).collect()),
        Err(circle) => {
            let names = circle
                .into_iter()
                .map(|at| followers[at].config.name.clone());
            Err(InProcessError::Circular {
                names: names.collect(),
            })
        }
    }
}

#[cfg(test)]
mod tests {

    use super::super::super::plan::Plan;
    use super::*;
    use kinds::load;

    fn followers(name: &str) -> Vec<Launch> {
        let scenario = load(name, &[], None).unwrap();
        let plan = Plan::new(&scenario, "warn").unwrap();
        plan.launches.into_iter().skip(1).collect()
    }

    #[test]
    fn late_processes_come_after_all_that_do_not_wait_for_them() {
        let launches = followers("chase");
        let is_late = |launch: &Launch| launch.config.name.starts_with("perception");
        let ordered = order(&launches, is_late).unwrap();
        let kinds: Vec<&str> = ordered.iter().map(|l| &*l.config.kind).collect();
        let at = |kind| kinds.iter().position(|known| *known == kind).unwrap();
        // The evaders do not wait for beliefs, the pursuers do.
        assert!(at("evader_potential") < at("perception"), "{kinds:?}");
        assert!(at("perception") < at("pursuer"), "{kinds:?}");
    }

    #[test]
    fn every_process_comes_after_those_it_waits_for() {
        let mut launches = followers("chase");
        // The worst order: providers come last.
        launches.sort_by_key(Launch::is_awaited);
        let ordered = order(&launches, |_| false).unwrap();
        assert_eq!(ordered.len(), launches.len());
        for (at, launch) in ordered.iter().enumerate() {
            for upstream in &launch.config.upstream {
                assert!(ordered[..at].iter().any(|l| l.config.index == *upstream));
            }
        }
    }

    #[test]
    fn a_process_that_waits_for_itself_is_reported() {
        let mut launches = followers("chase");
        let index = launches[0].config.index;
        launches[0].config.upstream = vec![index];
        let error = order(&launches, |_| false).unwrap_err().to_string();
        assert!(error.contains(&launches[0].config.name), "{error}");
    }
}
