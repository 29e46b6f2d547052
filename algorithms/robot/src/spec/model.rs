//! Bodies and limits of known robots.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

parameters::choice! {
    /// Available robots.
    pub enum Preset {
        /// ROBOTIS `TurtleBot3` Burger.
        #[default]
        Turtlebot3Burger,
        /// LEGO Mindstorms NXT two-wheeler.
        LegoNxt,
    }
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
