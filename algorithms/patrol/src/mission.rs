//! A patrol as a scenario specifies it: contour, time and key; the key and the width may be left open.

mod simulated_drive;

use avoidance::waypoint_driver::DriverParams;
use chaotic_maps::{Key, KeyError, KeyKind};
use control::go_to::GoToParams;
use geometry::pose::Pose2;
use nalgebra::Point2;
use parameters::{Parameters, ParamsError, above, at_least, check, each, unit};
use planner_view::limits::Limits;
use robot::spec::RobotModel;
use thiserror::Error;

use crate::alpha::{AlphaError, LAPS, alpha_max_driven, check_driven};
use crate::awg::{Awg, AwgError, AwgParams, MAX_T_MAX, Preset};
use crate::contour::{Contour, ContourError};
use crate::danger::DangerZones;
use crate::room::Room;
use crate::team::{Start, Team};

pub use simulated_drive::SimulatedDrive;

/// Preliminary width of a zig-zag before the choice (m); without effect.
const LAYOUT_ALPHA: f64 = 1.0;

/// Time (s) by which a lap on the waypoint clock is shorter than `t_max`, at most half of the
/// margin. With waypoints about a second apart, the ends of laps are late or early by up to 1.5 s.
const CLOCK_RESERVE_S: f64 = 2.0;

/// Largest width of the zig-zag of a team, as a share of the distance between two of its robots: zig-zags change
/// this distance, and the time between two visits of a place, by at most as much.
const TEAM_ALPHA: f64 = 0.05;

parameters::table! {
    /// Parameters of a patrol.
    pub struct MissionParams {
        /// The waypoints of the contour, x and y; at least 2.
        #[schemars(transform = each(each(unit("m"))), length(min = 2))]
        pub contour: Vec<[f64; 2]>,
        /// `true` if the last waypoint leads back to the first; otherwise the contour is driven there and
        /// back.
        pub closed: bool = true,
        /// Place at which the robot begins: its part of the contour in a team (`spread`), where the contour is nearest, or
        /// the waypoint with this index.
        pub start: Start,
        /// Time limit of each lap.
        pub t_max: f64 [above(0).at_most(MAX_T_MAX).unit("s")] = 120.0,
        /// Width of the zig-zag; if absent, as large as the robot can drive in the time and as there is
        /// room along the contour.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub alpha: Option<f64> [above(0).unit("m")],
        /// Share of the time kept in reserve when the width is chosen, with which a late robot catches up.
        /// The smaller, the wider the zig-zag and the later the robot.
        pub margin: f64 [at_least(0).below(1)] = 0.15,
        /// Key of the generator, such as `catp:0.4,0.644`, from which the robots of a team derive their own, the first one its
        /// own itself; if absent, a `keyed` one for each robot from the run's seed.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub key: Option<Key>,
        /// Interpretation of the paper's formulas.
        pub preset: Preset = Preset::Default,
        /// Areas in which the patrol is under threat; everywhere if empty.
        pub danger_zones: DangerZones,
    }
}

/// Reason why a patrol is impossible.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MissionError {
    /// An invalid contour.
    #[error(transparent)]
    Contour(#[from] ContourError),
    /// A time, a width or a zone out of its range.
    #[error(transparent)]
    Awg(#[from] AwgError),
    /// No width can be chosen.
    #[error(transparent)]
    Alpha(#[from] AlphaError),
    /// An invalid key.
    #[error("`key`: {0}")]
    Key(#[from] KeyError),
    /// A start that the contour does not have.
    #[error("`start` is {index}: expected the index of one of the {count} waypoints of `contour`")]
    Start {
        /// The given index.
        index: usize,
        /// Number of waypoints.
        count: usize,
    },
    /// An invalid parameter.
    #[error(transparent)]
    Params(#[from] ParamsError),
}

/// Origin of the width of a zig-zag.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AlphaChoice {
    /// The scenario gives it.
    Given,
    /// As wide as the robot can drive in the time.
    Time,
    /// As wide as there is room along the contour; the time would allow more.
    Room,
    /// As wide as the distance between the robots of the team allows.
    Team,
    /// Without effect: there are no additional waypoints.
    Unused,
}

impl AlphaChoice {
    /// Its name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Time => "time",
            Self::Room => "room",
            Self::Team => "team",
            Self::Unused => "unused",
        }
    }

    /// Its description.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Given => "as given",
            Self::Time => "as wide as the robot can drive in the time",
            Self::Room => "as wide as there is room along the contour",
            Self::Team => "as wide as the distance between the robots of the team allows",
            Self::Unused => "without effect, since there are no additional waypoints",
        }
    }
}

/// A patrol with all parameters chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Mission {
    /// The contour.
    pub contour: Contour,
    /// The zig-zag about it.
    pub awg: Awg,
    /// The key; with it and the above, an ally forecasts the patrol ([`crate::forecast`]).
    pub key: Key,
    /// `true` if the key is that of a team.
    pub has_team_key: bool,
    /// Place at which it begins.
    pub start: Start,
    /// Areas in which the patrol is under threat; everywhere if empty.
    pub danger_zones: DangerZones,
    /// Origin of the width.
    pub alpha_choice: AlphaChoice,
    /// Minimum width that the room may leave (m).
    least_alpha: f64,
}

impl Mission {
    /// Reduces a width that the time alone has determined to what there is room for
    /// ([`Room::widest`]), but not below the width at which the robot reaches every waypoint from the
    /// contour. A narrower zig-zag needs less time.
    #[must_use]
    pub fn within(self, room: &Room<'_>) -> Self {
        let widest = |awg: &Awg, least, alpha| room.widest(awg, least, alpha);
        self.narrowed(widest, AlphaChoice::Room)
    }

    /// Reduces such a width to what the distance between the robots of a team of this size allows, with the same
    /// lower bound.
    #[must_use]
    pub fn of_team(self, robots: usize) -> Self {
        if !self.start.spreads(robots) {
            return self;
        }
        let between_m = self.awg.contour_length() / robots as f64;
        let widest = |_: &Awg, least: f64, _| least.max(TEAM_ALPHA * between_m);
        self.narrowed(widest, AlphaChoice::Team)
    }

    /// Reduces a width that the scenario leaves open to the widest for a zig-zag, the least and the present width (m).
    fn narrowed(mut self, widest: impl Fn(&Awg, f64, f64) -> f64, choice: AlphaChoice) -> Self {
        let alpha = self.awg.params().alpha;
        if matches!(self.alpha_choice, AlphaChoice::Time | AlphaChoice::Team) {
            let widest = widest(&self.awg, self.least_alpha, alpha);
            if widest < alpha
                && let Ok(awg) = self.awg.clone().with_alpha(widest)
            {
                self.awg = awg;
                self.alpha_choice = choice;
            }
        }
        self
    }

    /// The team of the robots with these indices; `None` if they do not spread.
    pub fn team(&self, robots: &[u32]) -> Option<Team> {
        let is_given = self.alpha_choice == AlphaChoice::Given;
        let alpha = is_given.then(|| self.awg.params().alpha);
        Team::new(robots, self.start, alpha)
    }

    /// Derives its key from that of its team, if it has one, for the robot with this number in the team, from 0.
    #[must_use]
    pub fn of_robot(mut self, number: usize) -> Self {
        if core::mem::take(&mut self.has_team_key) {
            self.key = self.key.of_robot(number as u64);
        }
        self
    }

    /// Time of a round at which a robot that is alone begins (s); `seen` is its position, and its heading (rad).
    pub fn start_s(&self, seen: &Pose2) -> f64 {
        match self.start {
            Start::Spread => 0.0,
            Start::Nearest => self.awg.nearest_s(seen.position(), seen.theta),
            Start::Waypoint(index) => self.awg.corner_s(&self.contour, index),
        }
    }
}

/// Limits of a robot's drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Speed limits.
    pub limits: Limits,
    /// Acceleration (m/s²), > 0; absent: speeds step.
    pub acceleration: Option<f64>,
    /// Angular acceleration (rad/s²), > 0; absent: turning rates step.
    pub angular_acceleration: Option<f64>,
}

impl Drive {
    /// The drive of a robot's body: no faster than its wheels.
    ///
    /// # Errors
    /// [`ParamsError`] naming the limit that is out of range.
    pub fn from_model(model: &RobotModel) -> Result<Self, ParamsError> {
        let rim = model.wheel_speed_max.unwrap_or(f64::INFINITY);
        let turning = 2.0 * rim / model.wheel_separation;
        Ok(Self {
            limits: Limits::new(
                model.v_max.min(rim),
                model.v_reverse_max.min(rim),
                model.omega_max.min(turning),
            )?,
            acceleration: model.acceleration,
            angular_acceleration: model.angular_acceleration,
        })
    }

    /// Parameters of a waypoint driver for this drive: its accelerations replace absent ones.
    pub fn driver(&self, params: &DriverParams) -> DriverParams {
        params.for_drive(self.acceleration, self.angular_acceleration)
    }
}

impl Parameters for MissionParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let naming = |error: MissionError| ParamsError::naming(error.to_string());
        self.layout().map_err(naming)?;
        if let Start::Waypoint(index) = self.start
            && index >= self.contour.len()
        {
            let count = self.contour.len();
            return Err(naming(MissionError::Start { index, count }));
        }
        if let Some(key) = &self.key {
            key.validate()?;
        }
        Ok(())
    }
}

impl MissionParams {
    /// Chooses the open parameters for a robot and the seed of its process. The clock of the waypoints
    /// is set so fast that laps driven by it end within `t_max`.
    ///
    /// The width is tested by driving the first laps on empty ground ([`SimulatedDrive`]), so that the
    /// choice depends on scenario and key alone; [`Mission::within`] adapts it to a map.
    ///
    /// # Errors
    /// [`MissionError`] for an invalid parameter, and for a robot that is too slow.
    pub fn prepare(
        &self,
        drive: &Drive,
        go_to: &GoToParams,
        seed: u64,
    ) -> Result<Mission, MissionError> {
        check(self)?;
        let (contour, mut awg) = self.layout()?;
        let key = self.key_or(seed);
        let v_max = drive.limits.v_max() * go_to.speed_fraction;
        awg.check_speed(v_max)?;
        let alpha_choice = match self.alpha {
            _ if awg.steps_per_lap() == 0 => AlphaChoice::Unused,
            Some(_) => AlphaChoice::Given,
            None => AlphaChoice::Time,
        };
        if alpha_choice == AlphaChoice::Time {
            let mut simulated_drive = SimulatedDrive::new(drive, go_to);
            let mut source = key.source()?;
            let alpha = alpha_max_driven(
                &awg,
                v_max,
                self.margin,
                LAPS,
                &mut source,
                &mut simulated_drive,
            )?;
            awg = awg.with_alpha(alpha)?;
        }
        // A lap may end some moments before or after it is due, and must end in time nevertheless.
        let reserve_s = CLOCK_RESERVE_S.min(0.5 * self.margin * self.t_max);
        let tempo = (self.t_max - reserve_s) / awg.lap_time();
        let awg = awg.with_tempo(tempo.min(1.0))?;
        Ok(Mission {
            contour,
            awg,
            key,
            has_team_key: self.key.is_some(),
            start: self.start,
            danger_zones: self.danger_zones.clone(),
            alpha_choice,
            least_alpha: 2.0 * go_to.arrived,
        })
    }

    /// Returns `true` if [`Self::prepare`] would succeed, in a fraction of its time.
    ///
    /// # Errors
    /// As for [`Self::prepare`].
    pub fn check(&self, drive: &Drive, go_to: &GoToParams, seed: u64) -> Result<(), MissionError> {
        check(self)?;
        let (_, awg) = self.layout()?;
        let v_max = drive.limits.v_max() * go_to.speed_fraction;
        awg.check_speed(v_max)?;
        if self.alpha.is_none() && awg.steps_per_lap() > 0 {
            let mut simulated_drive = SimulatedDrive::new(drive, go_to);
            let mut source = self.key_or(seed).source()?;
            check_driven(
                &awg,
                v_max,
                self.margin,
                LAPS,
                &mut source,
                &mut simulated_drive,
            )?;
        }
        Ok(())
    }

    fn key_or(&self, seed: u64) -> Key {
        self.key
            .unwrap_or_else(|| Key::from_seed(KeyKind::Keyed, seed))
    }

    /// Returns the contour.
    ///
    /// # Errors
    /// [`ContourError`] for waypoints that make none.
    pub fn contour(&self) -> Result<Contour, ContourError> {
        let points: Vec<Point2<f64>> = self.contour.iter().map(|&p| p.into()).collect();
        if self.closed {
            Contour::closed(&points)
        } else {
            Contour::open(&points)
        }
    }

    fn layout(&self) -> Result<(Contour, Awg), MissionError> {
        let contour = self.contour()?;
        let params = AwgParams {
            t_max: self.t_max,
            alpha: self.alpha.unwrap_or(LAYOUT_ALPHA),
            mode: self.preset.mode(),
        };
        let awg = Awg::new(&contour, &self.danger_zones, params)?;
        Ok((contour, awg))
    }
}

#[cfg(test)]
mod tests;
