//! Tables of a scenario file as written, beside the world's own (`sim_backend::spec`).

use schemars::JsonSchema;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use sim_backend::pose::Pose2;
use sim_backend::spec::{ActuatorSpec, LimitsSpec, OdometrySpec, Preset, Region, ScanSpec};
use sim_backend::team::Team;

/// Most robots in one scenario.
pub const MAX_ROBOTS: usize = 64;
/// Most processes in one scenario, the simulator not counted: every one has a seat at the turn page.
pub const MAX_PROCESSES: usize = 63;
/// Most beams of one range scan.
pub const MAX_BEAMS: usize = 4096;
/// Most cells of the map's grid.
pub const MAX_CELLS: usize = 25_000_000;
/// Most ticks up to the time limit of a run.
pub const MAX_TICKS: f64 = 1e8;
/// Most events in one scenario.
pub const MAX_EVENTS: usize = 10_000;

/// `[run]`: time, chance, and how the processes wait for each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RunSpec {
    /// Simulated length of one tick (s), 0.0001 to 1.
    pub dt: f64,
    /// Seed of everything random: noise, start jitter, planners. `--seed` overrides it.
    pub seed: u64,
    /// Who sets the pace.
    pub mode: Mode,
    /// In real time: simulated seconds per second, 0.001 to 1000.
    pub real_time_factor: f64,
    /// On which cores the processes may run.
    pub pin: Pin,
    /// Wall-clock time (s) without an answer after which a process counts as hung, 0.1 to 3600.
    pub hang_timeout_s: f64,
    /// Wall-clock time (s) that the simulator, and every process that does not say otherwise, has to
    /// become ready, 0.1 to 3600.
    pub ready_timeout_s: f64,
    /// In real time: age (s, simulated) beyond which a robot's command is no longer obeyed and the
    /// robot stops, 0.001 to 60.
    pub command_deadline_s: f64,
}

impl Default for RunSpec {
    fn default() -> Self {
        Self {
            dt: 0.05,
            seed: 1,
            mode: Mode::LockStep,
            real_time_factor: 1.0,
            pin: Pin::None,
            hang_timeout_s: 10.0,
            ready_timeout_s: 60.0,
            command_deadline_s: 0.25,
        }
    }
}

/// Who sets the pace of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Every process answers every tick; the run is as fast as they are, and reproducible.
    #[default]
    LockStep,
    /// The clock; late answers are dropped and counted.
    RealTime,
}

/// On which cores the processes of a run may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pin {
    /// Wherever the system puts them.
    #[default]
    None,
    /// All on one core: the cheapest way to take turns.
    OneCore,
}

/// `[log]`: what is recorded and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LogSpec {
    /// Compression of the chunks.
    pub compression: Compression,
    /// Pictures per simulated second for viewers (Hz), 0 to 1000; 0 leaves viewer topics out.
    pub viewer_rate_hz: f64,
}

impl Default for LogSpec {
    fn default() -> Self {
        Self {
            compression: Compression::Zstd,
            viewer_rate_hz: 10.0,
        }
    }
}

/// Compression of a log's chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Compression {
    /// Zstandard.
    #[default]
    Zstd,
    /// None: larger, and readable by everything.
    None,
}

/// Random displacement of a robot's start, drawn from the run's seed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StartJitter {
    /// Along x: half the range, or the standard deviation (m), 0 to 100.
    pub x: f64,
    /// Along y, likewise (m), 0 to 100.
    pub y: f64,
    /// Of the heading, likewise (rad), 0 to π.
    pub theta: f64,
    /// What the three numbers mean.
    pub distribution: Distribution,
}

impl Default for StartJitter {
    fn default() -> Self {
        Self {
            x: 0.0,
            y: 0.0,
            theta: 0.0,
            distribution: Distribution::Uniform,
        }
    }
}

/// Distribution of a [`StartJitter`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// Anything from −value to +value is as likely.
    #[default]
    Uniform,
    /// Normal with the value as standard deviation, cut at three of them.
    Normal,
}

/// Reaction to a process that exits, is killed, breaks the protocol or no longer answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OnFailure {
    /// The run ends, and fails.
    #[default]
    Abort,
    /// In real time: it is started again and rejoins the run; its robots stand still meanwhile.
    Restart,
    /// The run goes on without it; the robots that it drove stand still.
    Continue,
}

/// How the robots of one `[[processes]]` block are shared out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Grouping {
    /// A process of its own for each robot.
    #[default]
    OnePerRobot,
    /// One process that drives them all.
    Together,
}

/// `[[robots]]`, `[teams.…]` and `[defaults.robot]`: all keys optional, since any of the three may
/// give them.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RobotBlock {
    pub name: Option<String>,
    pub team: Option<Team>,
    pub start: Option<Pose2>,
    pub start_jitter: Option<StartJitter>,
    pub preset: Option<Preset>,
    pub radius: Option<f64>,
    pub wheel_separation: Option<f64>,
    pub limits: LimitsSpec,
    pub actuator: ActuatorSpec,
    pub scan: Option<ScanSpec>,
    pub odometry: Option<OdometrySpec>,
    pub goal: Option<Region>,
}

/// `[[processes]]`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ProcessBlock {
    pub name: Option<String>,
    pub kind: Option<String>,
    pub command: Option<Vec<String>>,
    pub robots: Option<Vec<String>>,
    pub team: Option<Team>,
    pub grouping: Option<Grouping>,
    pub on_failure: Option<OnFailure>,
    pub ready_timeout_s: Option<f64>,
    /// Read by the kind.
    #[serde(rename = "params")]
    #[schemars(with = "Option<serde_json::Map<String, serde_json::Value>>")]
    pub _params: Option<IgnoredAny>,
}

/// `[defaults]`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Defaults {
    pub robot: Option<RobotBlock>,
}

/// `[teams]`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Teams {
    pub neutral: Option<RobotBlock>,
    pub police: Option<RobotBlock>,
    pub evader: Option<RobotBlock>,
}
