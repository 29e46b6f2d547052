//! Tables of a scenario file as written, except those of robots (`robot::spec`) and of the world
//! (`sim_backend::spec`).

use core::f64::consts::PI;

use geometry::extent::positive;
use geometry::pose::Pose2;
use geometry::region::Region;
use parameters::{Bounds, Parameters, at_least, between};
use robot::spec::{ActuatorSpec, LimitsSpec, OdometrySpec, Preset, ScanSpec};
use robot::team::Role;
use schemars::JsonSchema;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

/// Maximum number of robots in a scenario.
pub const MAX_ROBOTS: usize = 64;
/// Maximum length of the name of a robot or process (bytes).
pub const MAX_NAME: usize = 48;
/// Maximum number of processes in a scenario, without the simulator; each has a slot at the tick barrier.
pub const MAX_PROCESSES: usize = 63;
/// Maximum number of cells of the map's grid.
pub const MAX_CELLS: usize = 25_000_000;
/// Maximum number of ticks up to the time limit of a run.
pub const MAX_TICKS: f64 = 1e8;
/// Maximum number of events in a scenario.
pub const MAX_EVENTS: usize = 10_000;
/// Maximum delay of a link (s).
const MAX_DELAY: f64 = 60.0;
/// Sender or receiver of a link without one.
pub(super) const ANY: &str = "any";
/// Maximum period of a process (ticks).
pub(super) const MAX_PERIOD: u64 = 10_000;

parameters::table! {
    /// Time, randomness, and synchronisation of the processes.
    pub struct RunSpec {
        /// Simulated duration of one tick.
        pub dt: f64 [between(1e-4, 1.0).unit("s")] = 0.05,
        /// Seed of all randomness: noise, start jitter and planners. `--seed` overrides it.
        pub seed: u64 = 1,
        /// Pace of the run; `--real-time` sets it.
        pub mode: Mode = Mode::LockStep,
        /// Ratio of simulated time to real time, in real-time mode.
        pub real_time_factor: f64 [between(1e-3, 1e3)] = 1.0,
        /// Cores on which the processes may run.
        pub pin: Pin = Pin::None,
        /// Real time without an answer after which a process counts as hung. The time for which it waits for a core
        /// does not count.
        pub hang_timeout_s: f64 [between(0.1, 3600.0).unit("s")] = 10.0,
        /// Wall-clock time within which the simulator, and every process without its own value, must become
        /// ready.
        pub ready_timeout_s: f64 [ready_timeout()] = 60.0,
        /// In real-time mode: maximum age of a robot's command, in simulated time. The robot stops without a
        /// younger command.
        pub command_deadline_s: f64 [between(1e-3, 60.0).unit("s")] = 0.25,
    }
}

/// Returns the range of the time within which a process must become ready.
pub(super) fn ready_timeout() -> Bounds {
    between(0.1, 3600.0).unit("s")
}

impl Parameters for RunSpec {}

parameters::choice! {
    /// Pace of a run.
    pub enum Mode {
        /// Every process answers every tick; the run is as fast as the processes, and reproducible.
        #[default]
        LockStep,
        /// Ticks follow the clock; late answers are dropped and counted.
        RealTime,
    }
}

parameters::choice! {
    /// Cores on which the processes of a run execute.
    pub enum Pin {
        /// Any core.
        #[default]
        None,
        /// One core for all processes, which makes switching between them cheapest.
        OneCore,
    }
}

parameters::table! {
    /// Contents and format of the log.
    pub struct LogSpec {
        /// Compression of the chunks.
        pub compression: Compression = Compression::Zstd,
        /// Frames per simulated second for viewers, at 10 a quarter of the log of `chase`; 0 omits the viewer topics.
        pub viewer_rate_hz: f64 [between(0, 1000).unit("Hz")] = 10.0,
    }
}

impl Parameters for LogSpec {}

parameters::choice! {
    /// Compression of a log's chunks.
    pub enum Compression {
        /// Zstandard.
        #[default]
        Zstd,
        /// No compression: larger, and readable by every program.
        None,
    }
}

parameters::table! {
    /// Random displacement of a robot's start, drawn from the run's seed.
    #[derive(Copy)]
    pub struct StartJitter {
        /// Displacement along x: its maximum, or its standard deviation.
        pub x: f64 [between(0, 100).unit("m")] = 0.0,
        /// Displacement along y, as for x.
        pub y: f64 [between(0, 100).unit("m")] = 0.0,
        /// Displacement of the heading, as for x.
        pub theta: f64 [between(0.0, PI).unit("rad")] = 0.0,
        /// Distribution, which defines the meaning of the three values.
        pub distribution: Distribution = Distribution::Uniform,
    }
}

impl Parameters for StartJitter {}

parameters::choice! {
    /// Distribution of a [`StartJitter`].
    pub enum Distribution {
        /// Uniform from −value to +value.
        #[default]
        Uniform,
        /// Normal with the value as standard deviation, cut off at three standard deviations.
        Normal,
    }
}

parameters::table! {
    /// Random start: a pose drawn from the run's seed, uniformly over the allowed places, with any heading.
    ///
    /// A place is allowed if it is free, an evader reaches an exit from it, and a robot reaches its goal.
    #[derive(Copy)]
    pub struct RandomStart {
        /// Region of the places; the whole map if absent.
        pub region: Option<Region>,
        /// Minimum distance of centres from every other robot.
        pub robot_distance: f64 [between(0, 1000).unit("m")] = 0.5,
        /// Minimum distance of centres from robots of hostile teams.
        pub opponent_distance: f64 [between(0, 1000).unit("m")] = 3.0,
        /// Minimum distance of an evader from the centre of every exit.
        pub exit_distance: f64 [between(0, 1000).unit("m")] = 3.0,
    }
}

impl Parameters for RandomStart {}

parameters::choice! {
    /// Reaction to a process that exits, is killed, violates the protocol or does not answer.
    pub enum OnFailure {
        /// The run ends and fails.
        #[default]
        Abort,
        /// In real-time mode: the process is started again and rejoins the run; its robots stop meanwhile.
        Restart,
        /// The run continues without the process; its robots stop.
        Continue,
    }
}

parameters::choice! {
    /// Distribution of the robots of one `[[processes]]` block over processes.
    pub(super) enum Grouping {
        /// One process for each robot.
        #[default]
        OnePerRobot,
        /// One process for all robots.
        Together,
    }
}

/// Some equal robots, the values that a team's robots share (`[teams.…]`), or the values that all robots share
/// (`[defaults.robot]`). All keys are optional, since each of the three may contain them.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RobotBlock {
    /// Unique name, 1 to 48 of a–z, A–Z, 0–9, `_`, `-`. Required; not inherited.
    #[schemars(length(min = 1, max = MAX_NAME))]
    pub name: Option<String>,
    /// Number of equal robots, named `name_1`, `name_2` and so on, at random starts; if absent, one robot
    /// named `name`. In a team's table: that of the team's only block without a `count`.
    #[schemars(transform = between(1, MAX_ROBOTS))]
    pub count: Option<usize>,
    /// Name of the robot's team, characters as for `name`. Required.
    pub team: Option<String>,
    /// Role of the team; in its `[teams.TEAM]`. Required, except for teams called `police` (pursuers), `evader` and
    /// `neutral`.
    pub role: Option<Role>,
    /// Names of the teams to which the team is hostile, of the opposite role; in its `[teams.TEAM]`. Two teams are
    /// hostile if one of them names the other, or if both lack this key and one has pursuers, the other evaders.
    pub hostile_to: Option<Vec<String>>,
    /// Pose at time 0, free of walls and other robots. Required without `random_start`; not inherited.
    pub start: Option<Pose2>,
    /// Random displacement of the start; none if absent.
    pub start_jitter: Option<StartJitter>,
    /// Random start in place of `start` and `start_jitter`; none if absent.
    pub random_start: Option<RandomStart>,
    /// Robot model that supplies the body and limits where no other value is given;
    /// `"turtlebot3_burger"` if absent.
    pub preset: Option<Preset>,
    /// Radius of the disc that the robot occupies; the preset's if absent.
    #[schemars(transform = positive("m"))]
    pub radius: Option<f64>,
    /// Distance between the wheels' contact points; the preset's if absent.
    #[schemars(transform = positive("m"))]
    pub wheel_separation: Option<f64>,
    /// Limits that differ from the preset's.
    pub limits: LimitsSpec,
    /// Deviation of the drive from its commands; exact by default.
    pub actuator: ActuatorSpec,
    /// Range scanner, `{}` for all defaults; none if absent.
    pub scan: Option<ScanSpec>,
    /// Noise of the wheel odometry; exact if absent.
    pub odometry: Option<OdometrySpec>,
    /// Region that the robot shall reach; its centre must be inside.
    pub goal: Option<Region>,
}

/// Processes of one kind, and the robots that they drive.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ProcessBlock {
    /// Unique name, characters as for robots. If absent, the kind, followed by the robot's name where the
    /// block becomes several processes.
    pub name: Option<String>,
    /// Kind of process, one of `protean list`; this or `command`.
    pub kind: Option<String>,
    /// An external program and its arguments; runs only with `--allow-external`.
    pub command: Option<Vec<String>>,
    /// Working directory of the external program, to which relative paths in `command` refer; relative to the
    /// scenario's folder, which is used if absent.
    pub folder: Option<String>,
    /// Inputs and outputs of an external program that drives no robots: `"ask"` for one that states them itself, or a table
    /// with `reads` and `writes`, as the program states it.
    #[serde(rename = "declaration")]
    #[schemars(with = "Option<serde_json::Value>")]
    pub _declaration: Option<IgnoredAny>,
    /// Names of the robots that it drives; this or `team`.
    pub robots: Option<Vec<String>>,
    /// Name of the team whose robots it drives.
    pub team: Option<String>,
    /// Number of processes for the robots; `"one_per_robot"` if absent.
    pub grouping: Option<Grouping>,
    /// Reaction to a failure of the process; `"abort"` if absent.
    pub on_failure: Option<OnFailure>,
    /// Wall-clock time within which it must become ready, at the start and after a restart;
    /// `run.ready_timeout_s` if absent.
    #[schemars(transform = ready_timeout())]
    pub ready_timeout_s: Option<f64>,
    /// It steps in every n-th tick, from tick 0 on; between two steps its last commands and outputs count. 1 if absent.
    #[schemars(transform = between(1, MAX_PERIOD).unit("ticks"))]
    pub period: Option<u64>,
    /// Parameters of the kind; for a `command`, any parameters of the program.
    #[serde(rename = "params")]
    #[schemars(with = "Option<serde_json::Map<String, serde_json::Value>>")]
    pub _params: Option<IgnoredAny>,
}

/// Delay and loss of the messages of some topics between some processes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinkSpec {
    /// Name of the topic, or a pattern in which `*` stands for any characters. Required.
    pub topic: String,
    /// Senders: the name or the kind of processes, or a pattern of names; `"simulator"` for the world; `"any"` if absent.
    #[serde(default = "any")]
    pub from: String,
    /// Receivers, as for `from`.
    #[serde(default = "any")]
    pub to: String,
    /// Time after which a message arrives, rounded to the nearest number of ticks.
    #[serde(default)]
    #[schemars(transform = between(0, MAX_DELAY).unit("s"))]
    pub delay_s: f64,
    /// Probability with which a message never arrives.
    #[serde(default)]
    #[schemars(transform = at_least(0).below(1))]
    pub loss: f64,
}

impl Parameters for LinkSpec {}

fn any() -> String {
    ANY.to_owned()
}

/// Default values of robots.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Defaults {
    /// Keys of all robots.
    pub robot: Option<RobotBlock>,
}
