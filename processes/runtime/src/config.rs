//! Configuration of a process at its start: one JSON file, written by the orchestrator.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use geometry::pose::Pose2;
use geometry::region::Region;
use ipc_types::bus::{BusError, BusOptions, RunSpace};
use ipc_types::layout::LayoutError;
use ipc_types::topics::RunSize;
use robot::spec::RobotModel;
pub use robot::team::Role;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::declaration::{Flow, WrittenTopic};
use crate::link::Link;

/// Environment variable with the path of a process's configuration.
pub const CONFIG_VARIABLE: &str = "PROTEAN_CONFIG";

/// Environment variable of a program that shall print its declaration as JSON and end.
pub const DECLARE_VARIABLE: &str = "PROTEAN_DECLARE";

/// Configuration of a process, except for the parameters of its kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProcessConfig {
    /// Part that all processes of the run share.
    pub run: RunConfig,
    /// Name of the process in the scenario.
    pub name: String,
    /// Kind of the process.
    pub kind: String,
    /// Index of the process: its slot of the tick barrier, and the source in its stamps.
    pub index: u32,
    /// Indices of the robots that it drives or observes for.
    pub robots: Vec<u32>,
    /// Indices of the processes whose output of a tick it waits for.
    pub upstream: Vec<u32>,
    /// It steps in the ticks that are multiples of this number, ≥ 1.
    pub period: u64,
    /// Links to it; the messages of other senders and topics arrive in their tick.
    pub links: Vec<Link>,
}

/// File of a process: its configuration and the parameters of its kind, checked before the start.
#[derive(Debug, Serialize, Deserialize)]
struct Document<C, P> {
    #[serde(flatten)]
    config: C,
    params: P,
}

/// Configuration that all processes of a run share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunConfig {
    /// Root directory of the run.
    pub root: PathBuf,
    /// Prefix of the run in shared memory.
    pub prefix: String,
    /// Seed of all random streams.
    pub seed: u64,
    /// Simulated time between two ticks (ns), > 0.
    pub tick_period_ns: u64,
    /// Clock mode.
    pub clock: Clock,
    /// Processor to pin to; `None`: chosen by the system.
    pub processor: Option<u32>,
    /// Number of processes of the run.
    pub processes: u32,
    /// Number of obstacle events that will be replayed.
    pub events: u32,
    /// Maximum lag of the recorder (ticks).
    pub recorder_ticks: u32,
    /// Maximum number of elements of a message, for each flow that a process of the run writes, by its text.
    pub capacities: BTreeMap<String, u32>,
    /// The topics that processes of the run write and that are not built in.
    pub topics: Vec<WrittenTopic>,
    /// Every robot of the run, in the order of its index.
    pub robots: Vec<RobotInfo>,
    /// Regions through which evaders escape.
    pub exits: Vec<Region>,
    /// Distance below which a pursuer catches a hostile evader (m); 0 if there is no capture.
    pub capture_radius: f64,
    /// Lowest severity in the log on stderr: `error`, `warn`, `info`, `debug`, `trace`.
    pub log_level: String,
}

/// Properties of a robot that planners may use from the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotInfo {
    /// Name in the scenario.
    pub name: String,
    /// Name of its team.
    pub team: String,
    /// Role of its team.
    pub role: Role,
    /// Indices of the robots of the teams that are hostile to its own.
    pub opponents: Vec<u32>,
    /// Indices of the robots of its team whose processes give them the same task, itself included, in order; empty
    /// for a task without contour, graph and rectangles.
    #[serde(default)]
    pub companions: Vec<u32>,
    /// Its body and limits.
    pub model: RobotModel,
    /// Number of beams of its range scan; 0 without one.
    pub beams: u32,
    /// Pose at the start.
    pub start: Pose2,
    /// Region that it shall reach, if any.
    pub goal: Option<Region>,
}

/// Source of simulated time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Clock {
    /// The next tick begins when all processes have done the last one.
    LockStep,
    /// The next tick begins by the monotonic clock.
    RealTime {
        /// Simulated seconds per second.
        factor: f64,
        /// Age at which a command expires and its robot stops (simulated ns).
        deadline_ns: u64,
    },
}

/// Returns the number of ticks after its own for which a command is valid: those at which it is
/// younger than the deadline (simulated ns).
pub fn ticks_within(deadline_ns: u64, tick_period: Duration) -> u64 {
    let period_ns = u64::try_from(tick_period.as_nanos()).unwrap_or(u64::MAX);
    deadline_ns.div_ceil(period_ns.max(1)).saturating_sub(1)
}

/// Faults that make a configuration unusable.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// A topic of the run is not the one of this program.
    #[error(transparent)]
    Topic(#[from] LayoutError),
    /// The file cannot be read.
    #[error("process configuration {path}: cannot be read: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a process configuration of this version.
    #[error(
        "process configuration {path}: {source}: expected a program built from the version of `protean` that runs it"
    )]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Position and kind of the fault.
        source: serde_json::Error,
    },
    /// The kind has no such preset of parameters.
    #[error("parameters of {process}: no preset {preset}: expected one of {}", names.join(", "))]
    Preset {
        /// Name of the process.
        process: String,
        /// Its value of `preset`.
        preset: String,
        /// Names of the presets of its kind.
        names: Box<[&'static str]>,
    },
    /// The kind cannot read its parameters.
    #[error("parameters of {process}: {source}")]
    Params {
        /// Name of the process.
        process: String,
        /// Fault and expectation.
        source: serde_json::Error,
    },
}

/// Reads the file that the orchestrator wrote: the configuration, and the parameters of the kind. Parameters with
/// `preset` are the values of that preset, changed by the other keys: an external program alone knows its presets.
///
/// # Errors
/// [`ConfigError`] names the file and the place in it.
pub fn load<P: DeserializeOwned + Serialize>(
    path: &Path,
    presets: Vec<(&'static str, P)>,
) -> Result<(ProcessConfig, P), ConfigError> {
    let (config, params) = load_untyped(path)?;
    let refused = |source| ConfigError::Params {
        process: config.name.clone(),
        source,
    };
    let presets = presets.into_iter();
    let presets = presets.map(|(name, values)| Ok((name, serde_json::to_value(values)?)));
    let presets: Vec<(&str, Json)> = presets.collect::<Result<_, _>>().map_err(refused)?;
    let params = with_preset(&config.name, params, presets)?;
    let params = typed(params).map_err(refused)?;
    Ok((config, params))
}

/// Reads parameters. A process without any has an empty table in the scenario, which `()` does not read.
fn typed<P: DeserializeOwned>(params: Json) -> Result<P, serde_json::Error> {
    let is_empty = params.as_object().is_some_and(serde_json::Map::is_empty);
    let read = serde_json::from_value(params);
    read.or_else(|error| {
        let absent = is_empty.then(|| serde_json::from_value(Json::Null).ok());
        absent.flatten().ok_or(error)
    })
}

/// Returns parameters with `preset` replaced by its values; the other keys take precedence. A kind without presets has
/// no such key.
fn with_preset(
    process: &str,
    mut params: Json,
    presets: Vec<(&'static str, Json)>,
) -> Result<Json, ConfigError> {
    if presets.is_empty() {
        return Ok(params);
    }
    let Some(preset) = params.as_object_mut().and_then(|own| own.remove("preset")) else {
        return Ok(params);
    };
    let names = presets.iter().map(|(name, _)| *name).collect();
    let mut found = presets.into_iter();
    match found.find(|(name, _)| preset.as_str() == Some(*name)) {
        Some((_, mut values)) => {
            overlay(&mut values, params);
            Ok(values)
        }
        None => Err(ConfigError::Preset {
            process: process.to_owned(),
            preset: preset.to_string(),
            names,
        }),
    }
}

/// Replaces values by others, key by key in tables.
fn overlay(values: &mut Json, others: Json) {
    match (values, others) {
        (Json::Object(values), Json::Object(others)) => {
            for (key, other) in others {
                overlay(values.entry(key).or_insert(Json::Null), other);
            }
        }
        (values, other) => *values = other,
    }
}

/// Untyped part of [`load`], compiled once and not for every type of parameters.
fn load_untyped(path: &Path) -> Result<(ProcessConfig, Json), ConfigError> {
    let text = std::fs::read_to_string(path).map_err(|source| ConfigError::File {
        path: path.to_owned(),
        source,
    })?;
    let document: Document<ProcessConfig, Json> =
        serde_json::from_str(&text).map_err(|source| ConfigError::Syntax {
            path: path.to_owned(),
            source,
        })?;
    for topic in &document.config.run.topics {
        topic.register()?;
    }
    Ok((document.config, document.params))
}

/// Returns the document that [`load`] reads.
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

    /// Returns the simulated time between two steps (s).
    pub fn step_period(&self) -> f64 {
        self.run.tick_period() * self.period as f64
    }

    /// Returns the robots that this process drives, with their indices; an index without a robot is
    /// left out.
    pub fn own_robots(&self) -> impl Iterator<Item = (u32, &RobotInfo)> {
        self.robots
            .iter()
            .filter_map(|&i| Some((i, self.run.robots.get(i as usize)?)))
    }
}

impl RunConfig {
    /// Returns the maximum number of elements of a flow's messages; `None` if no process writes it.
    pub fn capacity(&self, flow: Flow) -> Option<usize> {
        let elements = self.capacities.get(&flow.to_string())?;
        Some(*elements as usize)
    }

    /// Returns the shared-memory space of the run.
    ///
    /// # Errors
    /// [`BusError::Space`] if root or prefix cannot be used.
    pub fn space(&self) -> Result<RunSpace, BusError> {
        RunSpace::new(&self.root, &self.prefix)
    }

    /// Returns the buffer layout of the run.
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

    /// Returns the simulated time between two ticks (s).
    pub fn tick_period(&self) -> f64 {
        self.tick_period_ns as f64 * 1e-9
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_is_filled_in_under_single_values() {
        let presets = || {
            let values = serde_json::json!({ "gain": 2.0, "filter": { "size": 7, "noise": 0.1 } });
            vec![("paper", values)]
        };
        let own = serde_json::json!({ "preset": "paper", "filter": { "size": 9 } });
        let merged = with_preset("own", own, presets()).unwrap();
        let expected = serde_json::json!({ "gain": 2.0, "filter": { "size": 9, "noise": 0.1 } });
        assert_eq!(merged, expected);
        for unknown in [serde_json::json!("none"), serde_json::json!(3)] {
            let own = serde_json::json!({ "preset": unknown });
            let error = with_preset("own", own, presets()).unwrap_err().to_string();
            let expected = format!("parameters of own: no preset {unknown}: expected one of paper");
            assert_eq!(error, expected);
        }
        // A kind without presets may have a parameter of this name.
        let own = serde_json::json!({ "preset": "paper" });
        assert_eq!(with_preset("own", own.clone(), Vec::new()).unwrap(), own);
    }

    #[test]
    fn an_external_planner_without_parameters_starts() {
        let empty = || serde_json::json!({});
        typed::<()>(empty()).unwrap();
        assert_eq!(typed::<Json>(empty()).unwrap(), empty());
        assert!(typed::<()>(serde_json::json!({ "gain": 1.0 })).is_err());
        assert!(typed::<f64>(empty()).is_err());
    }

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
