//! What a process is told at its start: one JSON file, written by the orchestrator.

use std::path::{Path, PathBuf};
use std::time::Duration;

use geometry::pose::Pose2;
use geometry::region::Region;
use ipc_types::bus::{BusError, BusOptions, RunSpace};
use ipc_types::topics::RunSize;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sim_backend::spec::RobotModel;
use sim_backend::team::Team;

/// Everything a process needs to know, but for the parameters of its kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProcessConfig {
    /// What all processes of the run share.
    pub run: RunConfig,
    /// Name of the process in the scenario.
    pub name: String,
    /// Kind of the process.
    pub kind: String,
    /// Index of the process: its slot of the tick barrier, and the source in its stamps.
    pub index: u32,
    /// Indices of the robots it drives or observes for.
    pub robots: Vec<u32>,
    /// Indices of the processes whose output of a tick it needs.
    pub upstream: Vec<u32>,
}

/// The file: a configuration, and beside it the parameters of the kind, checked before the start.
#[derive(Debug, Serialize, Deserialize)]
struct Document<C, P> {
    #[serde(flatten)]
    config: C,
    params: P,
}

/// What all processes of a run share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunConfig {
    /// Root directory of the run.
    pub root: PathBuf,
    /// Prefix of the run in shared memory.
    pub prefix: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Simulated time between two ticks (ns), > 0.
    pub tick_period_ns: u64,
    /// How time passes.
    pub clock: Clock,
    /// In lock-step: simulated seconds per second that the simulator keeps to; `None`: as fast as it
    /// can.
    pub pace: Option<f64>,
    /// Real time without an answer after which a process counts as hung (s).
    pub hang_timeout_s: f64,
    /// Processor to pin to; `None`: wherever the system likes.
    pub processor: Option<u32>,
    /// Number of processes of the run.
    pub processes: u32,
    /// Number of obstacle events that will be replayed.
    pub events: u32,
    /// Ticks that the recorder may lag behind.
    pub recorder_ticks: u32,
    /// Cells of the map, the capacity of `world/map`.
    pub map_cells: u32,
    /// Particles of the largest belief, the capacity of `perception/belief`.
    pub particles: u32,
    /// Every robot of the run, in the order of its index.
    pub robots: Vec<RobotInfo>,
    /// Where evaders get away.
    pub exits: Vec<Region>,
    /// Distance below which a police robot catches an evader (m); 0 if nobody is caught.
    pub capture_radius: f64,
    /// Least severe level of the log on stderr: `error`, `warn`, `info`, `debug`, `trace`.
    pub log_level: String,
}

/// What planners may know of a robot from the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotInfo {
    /// Name in the scenario.
    pub name: String,
    /// Its side.
    pub team: Team,
    /// Its body and limits.
    pub model: RobotModel,
    /// Beams of its range scan; 0 without one.
    pub beams: u32,
    /// Pose at the start.
    pub start: Pose2,
    /// Where it shall arrive, if it shall arrive anywhere.
    pub goal: Option<Region>,
}

/// How time passes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Clock {
    /// The next tick comes when everybody has done the last one.
    LockStep,
    /// The next tick comes by the monotonic clock.
    RealTime {
        /// Simulated seconds per second.
        factor: f64,
        /// Age at which a command no longer holds and its robot stops (simulated ns).
        deadline_ns: u64,
    },
}

/// Ticks after its own for which a command is good: those at which it is younger than the deadline
/// (simulated ns).
pub fn ticks_within(deadline_ns: u64, tick_period: Duration) -> u64 {
    let period_ns = u64::try_from(tick_period.as_nanos()).unwrap_or(u64::MAX);
    deadline_ns.div_ceil(period_ns.max(1)).saturating_sub(1)
}

/// Why a configuration cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("process configuration {path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not a process configuration.
    #[error("process configuration {path}: {source}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Where and what.
        source: serde_json::Error,
    },
}

/// Reads the file that the orchestrator wrote: the configuration, and the parameters of the kind.
///
/// # Errors
/// [`ConfigError`] names the file and the place in it.
pub fn load<P: DeserializeOwned>(path: &Path) -> Result<(ProcessConfig, P), ConfigError> {
    let (config, params) = load_untyped(path)?;
    let params = serde_json::from_value(params).map_err(|source| ConfigError::Syntax {
        path: path.to_owned(),
        source,
    })?;
    Ok((config, params))
}

/// Apart from [`load`], so that it is compiled once and not for every type of parameters.
fn load_untyped(path: &Path) -> Result<(ProcessConfig, serde_json::Value), ConfigError> {
    let text = std::fs::read_to_string(path).map_err(|source| ConfigError::File {
        path: path.to_owned(),
        source,
    })?;
    let document: Document<ProcessConfig, serde_json::Value> = serde_json::from_str(&text)
        .map_err(|source| ConfigError::Syntax {
            path: path.to_owned(),
            source,
        })?;
    Ok((document.config, document.params))
}

/// What the file that [`load`] reads says.
pub fn document<P: Serialize>(config: &ProcessConfig, params: P) -> impl Serialize {
    Document { config, params }
}

impl ProcessConfig {
    /// Reads the file that the orchestrator wrote, without the parameters of the kind.
    ///
    /// # Errors
    /// [`ConfigError`] names the file and the place in it.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        Ok(load_untyped(path)?.0)
    }

    /// The robots this process drives, with their indices; an index without a robot is left out.
    pub fn own_robots(&self) -> impl Iterator<Item = (u32, &RobotInfo)> {
        self.robots
            .iter()
            .filter_map(|&i| Some((i, self.run.robots.get(i as usize)?)))
    }
}

impl RunConfig {
    /// Where the run lives.
    ///
    /// # Errors
    /// [`BusError::Space`] if root or prefix cannot be used.
    pub fn space(&self) -> Result<RunSpace, BusError> {
        RunSpace::new(&self.root, &self.prefix)
    }

    /// How the buffers of the run are laid out.
    pub fn bus_options(&self) -> BusOptions {
        BusOptions {
            size: RunSize {
                robots: self.robots.len().max(1),
                processes: self.processes as usize,
                events: self.events as usize,
            },
            recorder_ticks: self.recorder_ticks as usize,
            overflow: self.clock != Clock::LockStep,
        }
    }

    /// Seconds of simulated time between two ticks.
    pub fn tick_period(&self) -> f64 {
        self.tick_period_ns as f64 * 1e-9
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_good_while_it_is_younger_than_the_deadline() {
        let ticks =
            |deadline_ms: u64| ticks_within(deadline_ms * 1_000_000, Duration::from_millis(50));
        // Its own tick, and those 50, 100, 150 and 200 ms later.
        assert_eq!(ticks(250), 4);
        assert_eq!(ticks(251), 5);
        assert_eq!(ticks(120), 2);
        // Always for its own.
        assert_eq!((ticks(50), ticks(1), ticks(0)), (0, 0, 0));
        assert_eq!(ticks_within(u64::MAX, Duration::ZERO), u64::MAX - 1);
    }
}
