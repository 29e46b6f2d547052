//! One robot: body, limits, imperfections, sensors.

use geometry::extent::{MAX_COORDINATE, not_negative, positive};
use geometry::pose::Pose2;
use geometry::region::Region;
use parameters::{Parameters, ParamsError, at_least, require, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{OdometrySpec, ScanSpec};
use crate::team::Team;

/// A robot of the scenario: a preset body, with optional overrides.
///
/// ```toml
/// [[robots]]
/// name = "police_1"
/// team = "police"
/// start = { x = 7.5, y = 4.5, theta = 3.14159 }
/// preset = "turtlebot3_burger"
/// limits = { v_max = 0.3 }
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// Unique name, used in messages, logs and the summary.
    pub name: String,
    /// Team.
    pub team: Team,
    /// Pose at time 0.
    pub start: Pose2,
    /// The robot whose body and limits are the defaults.
    #[serde(default)]
    pub preset: Preset,
    /// Radius of the disc that the robot occupies; the preset's if absent.
    #[serde(default)]
    #[schemars(transform = positive("m"))]
    pub radius: Option<f64>,
    /// Distance between the wheels' contact points; the preset's if absent.
    #[serde(default)]
    #[schemars(transform = positive("m"))]
    pub wheel_separation: Option<f64>,
    /// Limits that differ from the preset's.
    #[serde(default)]
    pub limits: LimitsSpec,
    /// Imperfections of the drive; perfect by default.
    #[serde(default)]
    pub actuator: ActuatorSpec,
    /// Range scanner; none if absent.
    #[serde(default)]
    pub scan: Option<ScanSpec>,
    /// Noise of the wheel odometry; exact if absent.
    #[serde(default)]
    pub odometry: Option<OdometrySpec>,
    /// Goal of the robot; it is done when its centre is inside. (Evaders are also done in an exit,
    /// which need not be repeated here.)
    #[serde(default)]
    pub goal: Option<Region>,
}

impl RobotSpec {
    /// A robot with the default preset, perfect drive and no sensors.
    pub fn new(name: &str, team: Team, start: Pose2) -> Self {
        Self {
            name: name.to_owned(),
            team,
            start,
            preset: Preset::default(),
            radius: None,
            wheel_separation: None,
            limits: LimitsSpec::default(),
            actuator: ActuatorSpec::default(),
            scan: None,
            odometry: None,
            goal: None,
        }
    }

    /// The preset with this robot's overrides applied.
    pub fn model(&self) -> RobotModel {
        let preset = self.preset.model();
        RobotModel {
            radius: self.radius.unwrap_or(preset.radius),
            wheel_separation: self.wheel_separation.unwrap_or(preset.wheel_separation),
            v_max: self.limits.v_max.unwrap_or(preset.v_max),
            v_reverse_max: self.limits.v_reverse_max.unwrap_or(preset.v_reverse_max),
            omega_max: self.limits.omega_max.unwrap_or(preset.omega_max),
            acceleration: self.limits.acceleration.or(preset.acceleration),
            angular_acceleration: self
                .limits
                .angular_acceleration
                .or(preset.angular_acceleration),
            wheel_speed_max: self.limits.wheel_speed_max.or(preset.wheel_speed_max),
        }
    }
}

impl Parameters for RobotSpec {
    fn check_relations(&self) -> Result<(), ParamsError> {
        require(
            !self.name.is_empty(),
            "name",
            "\"\"",
            "a name of at least one character",
        )?;
        let scan = self.scan.as_ref();
        scan.map_or(Ok(()), Parameters::check_relations)
            .map_err(within("scan"))
    }
}

/// Available robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// ROBOTIS `TurtleBot3` Burger.
    #[default]
    Turtlebot3Burger,
    /// LEGO Mindstorms NXT two-wheeler.
    LegoNxt,
}

impl Preset {
    /// Body and limits of the preset.
    pub const fn model(self) -> RobotModel {
        match self {
            Self::Turtlebot3Burger => RobotModel::turtlebot3_burger(),
            Self::LegoNxt => RobotModel::lego_nxt(),
        }
    }
}

/// Limits that differ from the preset's; absent values are the preset's.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsSpec {
    /// Maximum forward speed.
    #[schemars(transform = positive("m/s"))]
    pub v_max: Option<f64>,
    /// Maximum backward speed.
    #[schemars(transform = not_negative("m/s"))]
    pub v_reverse_max: Option<f64>,
    /// Maximum turning rate either way.
    #[schemars(transform = not_negative("rad/s"))]
    pub omega_max: Option<f64>,
    /// Maximum change of forward speed; unlimited if absent here and in the preset.
    #[schemars(transform = positive("m/s²"))]
    pub acceleration: Option<f64>,
    /// Maximum change of turning rate; unlimited if absent here and in the preset.
    #[schemars(transform = positive("rad/s²"))]
    pub angular_acceleration: Option<f64>,
    /// Maximum speed of a wheel's rim, |v| + |ω|·separation/2; unlimited if absent here and in the
    /// preset.
    #[schemars(transform = positive("m/s"))]
    pub wheel_speed_max: Option<f64>,
}

/// Body and limits of a robot, with preset and overrides applied.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotModel {
    /// Radius of the disc that the robot occupies (m).
    pub radius: f64,
    /// Distance between the wheels' contact points (m).
    pub wheel_separation: f64,
    /// Maximum forward speed (m/s).
    pub v_max: f64,
    /// Maximum backward speed (m/s).
    pub v_reverse_max: f64,
    /// Maximum turning rate (rad/s).
    pub omega_max: f64,
    /// Maximum change of forward speed (m/s²); `None` is unlimited.
    pub acceleration: Option<f64>,
    /// Maximum change of turning rate (rad/s²); `None` is unlimited.
    pub angular_acceleration: Option<f64>,
    /// Maximum |v| + |ω|·separation/2 (m/s); `None` is unlimited.
    pub wheel_speed_max: Option<f64>,
}

impl RobotModel {
    /// `TurtleBot3` Burger: 0.22 m/s and 2.84 rad/s, wheels 0.160 m apart (ROBOTIS e-manual); a
    /// disc of 0.105 m covers body and wheels. It has no published acceleration limit: none is
    /// set.
    pub const fn turtlebot3_burger() -> Self {
        Self {
            radius: 0.105,
            wheel_separation: 0.160,
            v_max: 0.22,
            v_reverse_max: 0.22,
            omega_max: 2.84,
            acceleration: None,
            angular_acceleration: None,
            wheel_speed_max: None,
        }
    }

    /// LEGO Mindstorms NXT two-wheeler as in the local-pursuit experiments: 0.15 m/s measured top
    /// speed, wheels of the standard base 0.112 m apart, hence 2·0.15/0.112 rad/s when turning on
    /// the spot (the wheel speed binds, so speed and turning rate share it); a disc of 0.09 m
    /// covers brick and wheels.
    pub const fn lego_nxt() -> Self {
        Self {
            radius: 0.09,
            wheel_separation: 0.112,
            v_max: 0.15,
            v_reverse_max: 0.15,
            omega_max: 2.0 * 0.15 / 0.112,
            acceleration: None,
            angular_acceleration: None,
            wheel_speed_max: Some(0.15),
        }
    }

    /// The same robot without limits on its accelerations.
    #[must_use]
    pub const fn without_inertia(&self) -> Self {
        Self {
            acceleration: None,
            angular_acceleration: None,
            ..*self
        }
    }
}

/// Imperfections of the drive.
///
/// Executed speed = commanded · (1 − slip) · (1 + noise·N), with N standard normal, clipped at ±3
/// and drawn once per step from the robot's own stream. The result is clamped to the robot's
/// limits, so that noise never makes a robot faster than its limits.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ActuatorSpec {
    /// Share of the forward speed lost to slipping wheels.
    #[schemars(transform = at_least(0).below(1))]
    pub slip: f64,
    /// Share of the turning rate lost to slipping wheels.
    #[schemars(transform = at_least(0).below(1))]
    pub angular_slip: f64,
    /// Standard deviation of the forward speed, as a share of it.
    #[schemars(transform = at_least(0).at_most(MAX_COORDINATE))]
    pub noise: f64,
    /// Standard deviation of the turning rate, as a share of it.
    #[schemars(transform = at_least(0).at_most(MAX_COORDINATE))]
    pub angular_noise: f64,
    /// Standard deviation of the turning rate per forward speed (a robot commanded straight veers).
    #[schemars(transform = not_negative("rad/m"))]
    pub veer: f64,
}

impl ActuatorSpec {
    /// Returns `true` if the drive executes commands exactly.
    pub fn is_perfect(&self) -> bool {
        *self == Self::default()
    }
}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn a_robot_is_its_preset_with_its_own_values_on_top() {
        let spec: RobotSpec = toml::from_str(
            r#"
            name = "police_1"
            team = "police"
            start = { x = 7.5, y = 4.5, theta = 3.14159 }
            preset = "lego_nxt"
            radius = 0.2
            limits = { v_max = 0.3 }
            "#,
        )
        .unwrap();
        let model = spec.model();
        assert_eq!(model.radius, 0.2);
        assert_eq!(model.v_max, 0.3);
        assert_eq!(
            model.wheel_separation,
            RobotModel::lego_nxt().wheel_separation
        );
        assert!(check(&spec).is_ok());
        let again: RobotSpec = toml::from_str(&toml::to_string(&spec).unwrap()).unwrap();
        assert_eq!(again, spec);
    }

    #[test]
    fn unknown_keys_and_bad_values_are_named() {
        let error = toml::from_str::<RobotSpec>(
            "name = 'a'\nteam = 'police'\nstart = { x = 0, y = 0, theta = 0 }\nlimits = { vmax = 1 }",
        )
        .unwrap_err();
        assert!(error.to_string().contains("vmax"), "{error}");
        let mut spec = RobotSpec::new("a", Team::Police, Pose2::default());
        spec.limits.v_max = Some(-1.0);
        assert!(
            check(&spec)
                .unwrap_err()
                .to_string()
                .starts_with("`limits.v_max` is -1")
        );
        spec.limits.v_max = None;
        spec.actuator.slip = 1.0;
        assert!(
            check(&spec)
                .unwrap_err()
                .to_string()
                .starts_with("`actuator.slip` is 1")
        );
    }
}
