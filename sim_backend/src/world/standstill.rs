//! Robots that stand although they have not arrived at their goals.

use core::time::Duration;

use nalgebra::Point2;

use super::{EventKind, World};

/// Time without progress after which a robot with a goal counts as standing.
pub const STANDSTILL: Duration = Duration::from_secs(10);
/// Distance (m) from a place within which a robot makes no progress.
const PLACE: f64 = 0.05;

/// Last place at which a robot made progress.
#[derive(Debug, Clone, Copy)]
pub struct Rest {
    at: Point2<f64>,
    since: Duration,
    is_reported: bool,
}

impl Rest {
    /// A robot that begins at this place (m).
    pub(super) fn new(at: Point2<f64>) -> Self {
        Self {
            at,
            since: Duration::ZERO,
            is_reported: false,
        }
    }
}

impl World {
    /// Reports the robots that have stood for [`STANDSTILL`].
    pub(super) fn report_standstills(&mut self) {
        for i in 0..self.robots.len() {
            let robot = &self.robots[i];
            if !robot.is_active() || robot.goal.is_none() {
                continue;
            }
            let at = robot.pose.position();
            let rest = &mut self.extras[i].rest;
            let stood = self.time.saturating_sub(rest.since);
            if (at - rest.at).norm() > PLACE {
                *rest = Rest {
                    since: self.time,
                    ..Rest::new(at)
                };
            } else if !rest.is_reported && stood >= STANDSTILL {
                rest.is_reported = true;
                self.emit(EventKind::Stands {
                    robot: i,
                    seconds: stood.as_secs_f64(),
                });
            }
        }
    }
}
