//! Parameters of the waypoint driver.

use parameters::{Parameters, above};

use control::go_to::GoToParams;
use planner_view::limits::Limits;

/// Minimum time limit of a waypoint (s).
pub const MIN_TIME_S: f64 = 1.0;

parameters::table! {
    /// Parameters of a [`WaypointDriver`](super::WaypointDriver).
    #[derive(Copy)]
    pub struct DriverParams {
        /// Driving to points; `go_to.arrived` is the tolerance of a waypoint.
        pub go_to: GoToParams,
        /// Time limit of a waypoint, as a multiple of the time without obstacles. The cat-map patrol paper
        /// (§3) suggests 2.
        pub time_limit_factor: f64 [above(0)] = 2.0,
        /// Time from a scan to the moment when its command can stop the robot. With a scan, the robot limits
        /// its speed so that it stays clear of obstacles for this time.
        pub reaction_s: f64 [above(0).unit("s")] = 0.15,
        /// Deceleration of the drive; absent: the robot stops at once, unless its model gives a value
        /// ([`Self::for_drive`]). With a scan, the robot limits its speed so that it can brake before the
        /// obstacles that it sees.
        pub braking: Option<f64> [above(0).unit("m/s²")],
        /// Angular acceleration of the drive; absent: the robot turns at once, unless its model gives a
        /// value. The robot limits its turning rate so that it can stop turning in time.
        pub angular_acceleration: Option<f64> [above(0).unit("rad/s²")],
        /// Time within which the robot must move by its radius; otherwise it is stuck, and the waypoint is given
        /// up. With a scan it plans a path among the obstacles that it has seen after half of this time.
        pub stuck_s: f64 [above(0).unit("s")] = 15.0,
    }
}

impl Parameters for DriverParams {}

impl DriverParams {
    /// These parameters for a robot whose drive has these accelerations (m/s², rad/s²); values of the
    /// parameters take precedence.
    #[must_use]
    pub fn for_drive(self, acceleration: Option<f64>, angular_acceleration: Option<f64>) -> Self {
        Self {
            braking: self.braking.or(acceleration),
            angular_acceleration: self.angular_acceleration.or(angular_acceleration),
            ..self
        }
    }

    /// Maximum time that ramps add to a path, beyond
    /// [`time_without_obstacles`](super::time_without_obstacles) (s).
    pub(super) fn ramps_s(&self, limits: &Limits) -> f64 {
        let time = |speed: f64, rate: Option<f64>| rate.map_or(0.0, |rate| speed / rate);
        time(limits.v_max() * self.go_to.speed_fraction, self.braking)
            + time(limits.omega_max(), self.angular_acceleration)
    }
}
