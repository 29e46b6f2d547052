//! One robot of a scenario: team, start, body, limits, imperfections, sensors.

use geometry::extent::{MAX_COORDINATE, not_negative, positive};
use geometry::pose::Pose2;
use geometry::region::Region;
use parameters::{Parameters, ParamsError, at_least, require, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{OdometrySpec, Preset, RobotModel, ScanSpec};
use crate::team::{Role, Team};

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
    /// Name of its team.
    pub team: String,
    /// Role of its team. A team called `police`, `evader` or `neutral` need not state it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub role: Option<Role>,
    /// Names of the teams to which its team is hostile, of the opposite role. Two teams are hostile if one of them
    /// names the other, or if both lack this key and have opposite roles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hostile_to: Option<Vec<String>>,
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
    /// A robot of this role's standard team, with the default preset, perfect drive and no sensors.
    pub fn new(name: &str, role: Role, start: Pose2) -> Self {
        Self {
            name: name.to_owned(),
            team: role.team().to_owned(),
            role: None,
            hostile_to: None,
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

    /// The role of its team.
    pub fn role(&self) -> Role {
        let standard = || Role::of_team(&self.team).unwrap_or(Role::Neutral);
        self.role.unwrap_or_else(standard)
    }

    /// Returns `true` if its team and that of another robot are hostile.
    pub fn is_hostile_to(&self, other: &Self) -> bool {
        let names = |a: &Self, b: &Self| {
            a.hostile_to
                .as_ref()
                .is_some_and(|names| names.contains(&b.team))
        };
        let neither_states = self.hostile_to.is_none() && other.hostile_to.is_none();
        self.role().opposite() == Some(other.role())
            && (neither_states || names(self, other) || names(other, self))
    }

    /// Returns the teams of robots, at most 64 teams, by robot.
    pub fn teams(robots: &[Self]) -> Vec<Team> {
        Team::of_robots(
            robots.len(),
            |i| robots[i].role(),
            |i, j| robots[i].team == robots[j].team,
            |i, j| robots[i].is_hostile_to(&robots[j]),
        )
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
        let standard = Role::of_team(&self.team);
        let given = || self.role.map_or("nothing", Role::name);
        require(
            self.role.is_some() || standard.is_some(),
            "role",
            given(),
            format!(
                "the role of team `{}`: pursuer, evader or neutral",
                self.team
            ),
        )?;
        require(
            self.role.is_none() || standard.is_none() || self.role == standard,
            "role",
            given(),
            format!(
                "{}, the role of `{}`",
                standard.map_or("", Role::name),
                self.team
            ),
        )?;
        let scan = self.scan.as_ref();
        scan.map_or(Ok(()), Parameters::check_relations)
            .map_err(within("scan"))
    }
}

parameters::table! {
    /// Limits that differ from the preset's; absent values are the preset's.
    #[derive(Copy)]
    pub struct LimitsSpec {
        /// Maximum forward speed.
        pub v_max: Option<f64> [positive("m/s")],
        /// Maximum backward speed.
        pub v_reverse_max: Option<f64> [not_negative("m/s")],
        /// Maximum turning rate either way.
        pub omega_max: Option<f64> [not_negative("rad/s")],
        /// Maximum change of forward speed; unlimited if absent here and in the preset.
        pub acceleration: Option<f64> [positive("m/s²")],
        /// Maximum change of turning rate; unlimited if absent here and in the preset.
        pub angular_acceleration: Option<f64> [positive("rad/s²")],
        /// Maximum speed of a wheel's rim, |v| + |ω|·separation/2; unlimited if absent here and in the
        /// preset.
        pub wheel_speed_max: Option<f64> [positive("m/s")],
    }
}

parameters::table! {
    /// Imperfections of the drive.
    ///
    /// Executed speed = commanded · (1 − slip) · (1 + noise·N), with N standard normal, clipped at ±3
    /// and drawn once per step from the robot's own stream. The result is clamped to the robot's
    /// limits, so that noise never makes a robot faster than its limits.
    #[derive(Copy)]
    pub struct ActuatorSpec {
        /// Share of the forward speed lost to slipping wheels.
        pub slip: f64 [at_least(0).below(1)],
        /// Share of the turning rate lost to slipping wheels.
        pub angular_slip: f64 [at_least(0).below(1)],
        /// Standard deviation of the forward speed, as a share of it.
        pub noise: f64 [at_least(0).at_most(MAX_COORDINATE)],
        /// Standard deviation of the turning rate, as a share of it.
        pub angular_noise: f64 [at_least(0).at_most(MAX_COORDINATE)],
        /// Standard deviation of the turning rate per forward speed (a robot commanded straight veers).
        pub veer: f64 [not_negative("rad/m")],
    }
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
        let mut spec = RobotSpec::new("a", Role::Pursuer, Pose2::default());
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

    #[test]
    fn opposite_roles_are_hostile_unless_a_team_states_its_opponents() {
        use Role::{Evader, Neutral, Pursuer};

        let robot = |(team, role, hostile_to): (&str, Role, Option<&[&str]>)| RobotSpec {
            team: team.to_owned(),
            role: Some(role),
            hostile_to: hostile_to.map(|names| names.iter().map(|&name| name.into()).collect()),
            ..RobotSpec::new("r", role, Pose2::default())
        };
        let default = [
            ("police", Pursuer, None),
            ("guards", Pursuer, None),
            ("thieves", Evader, None),
            ("thieves", Evader, None),
            ("van", Neutral, None),
        ];
        let stated: [(&str, Role, Option<&[&str]>); 5] = [
            ("north", Pursuer, Some(&["red"])),
            ("south", Pursuer, None),
            ("red", Evader, None),
            ("blue", Evader, Some(&["south", "van"])),
            ("van", Neutral, None),
        ];
        // South and red both lack the key; north and blue have it and do not name each other.
        for (robots, hostile) in [
            (default, [(0, 2), (0, 3), (1, 2), (1, 3)].as_slice()),
            (stated, &[(0, 2), (1, 2), (1, 3)]),
        ] {
            let robots = robots.map(robot);
            let teams = RobotSpec::teams(&robots);
            for (i, a) in robots.iter().enumerate() {
                assert!(check(a).is_ok());
                for (j, b) in robots.iter().enumerate() {
                    let expected = hostile.contains(&(i.min(j), i.max(j)));
                    assert_eq!(a.is_hostile_to(b), expected, "{i} {j}");
                    assert_eq!(teams[i].is_hostile_to(teams[j]), expected, "{i} {j}");
                    assert_eq!(teams[i].is_same(teams[j]), a.team == b.team, "{i} {j}");
                }
            }
        }
    }

    #[test]
    fn the_role_of_a_team_is_stated_or_known_by_its_name() {
        let mut spec = RobotSpec::new("a", Role::Pursuer, Pose2::default());
        assert!(check(&spec).is_ok());
        let text = toml::to_string(&spec).unwrap();
        assert!(
            !text.contains("role") && !text.contains("hostile_to"),
            "{text}"
        );
        spec.role = Some(Role::Evader);
        let error = check(&spec).unwrap_err().to_string();
        assert!(error.contains("`role` is evader"), "{error}");
        assert!(error.contains("pursuer, the role of `police`"), "{error}");
        (spec.team, spec.role) = ("guards".to_owned(), None);
        let error = check(&spec).unwrap_err().to_string();
        assert!(error.contains("the role of team `guards`"), "{error}");
        spec.role = Some(Role::Pursuer);
        assert!(check(&spec).is_ok());
    }
}
