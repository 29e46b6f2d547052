//! Driving through waypoints in order, around obstacles.
//!
//! The `Move towards waypoint (P)` of the cat-map patrol paper (§3). A waypoint inside a known
//! obstacle is skipped at once. A waypoint that the robot does not reach in twice the time without
//! obstacles is given up. With a range sensor, [`TangentBug`] leads around obstacles. A robot that does
//! not move plans a path among the obstacles that it has seen, and if that does not help either it is
//! stuck; a waypoint is unreachable only if obstacles enclose it or the robot. The outcome of each
//! waypoint is reported.

mod guard;
mod pace;
mod params;
mod time_model;
mod turning;

use geometry::pose::{Pose2, Twist2};
use nalgebra::{Point2, Vector2};
use parameters::{ParamsError, check, positive};

use guard::Guard;
pub use params::{DriverParams, MIN_TIME_S};
pub use time_model::{lap_time, time_without_obstacles};

use crate::tangent_bug::{Advice, Mode, TangentBug, echoes};
use control::go_to::{GoToParams, distance_to_segment, go_to};
use planner_view::free_space::FreeSpace;
use planner_view::limits::Limits;
use planner_view::view::ScanView;
use planner_view::waypoint::{Waypoint, WaypointKind, WaypointOutcome, WaypointReport};

/// Maximum number of waypoints taken in a tick: a source whose points are all skipped must not block
/// the robot.
const MAX_PER_TICK: usize = 64;
/// Share of the time after which a robot that does not move is stuck, after which it plans a detour.
const DETOUR_AFTER: f64 = 0.5;

/// Inputs of one tick.
#[derive(Debug, Clone, Copy)]
pub struct Situation<'a> {
    /// Pose of the robot.
    pub pose: Pose2,
    /// Twist of the robot, own frame.
    pub twist: Twist2,
    /// Its range scan, made at this pose; without one it drives straight.
    pub scan: Option<ScanView<'a>>,
    /// Known obstacles.
    pub known: Option<&'a FreeSpace>,
    /// Simulated time (s).
    pub time_s: f64,
    /// Length of a tick (s).
    pub dt: f64,
}

/// Outputs of one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriverOutput {
    /// The command; finite and within the limits. A stop if there is no waypoint.
    pub command: Twist2,
    /// The current target point (m): the waypoint or a point on the path around an obstacle.
    pub towards: Option<Point2<f64>>,
    /// Mode of motion; `None` without a waypoint or a scan.
    pub mode: Option<Mode>,
}

impl DriverOutput {
    const STOP: Self = Self {
        command: Twist2::STOP,
        towards: None,
        mode: None,
    };
}

/// The current waypoint.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    waypoint: Waypoint,
    started_s: f64,
    /// Due time (s), if it has one.
    due_s: Option<f64>,
    /// Time for which it is tried after that (s).
    spare_s: f64,
    /// Time at which it is given up (s); infinite for a waypoint of the route.
    until_s: f64,
    closest: f64,
    /// Position and time at which the robot last had moved away from a place.
    last_moved: (Point2<f64>, f64),
}

/// Drives a robot through waypoints.
#[derive(Debug, Clone)]
pub struct WaypointDriver {
    params: DriverParams,
    limits: Limits,
    radius: f64,
    bug: TangentBug,
    leg: Option<Leg>,
    /// Taken early, to decide whether the robot can pass the current one at speed.
    onward: Option<Waypoint>,
    /// Position in the last tick.
    before: Option<Point2<f64>>,
    echoes: Vec<Vector2<f64>>,
}

impl WaypointDriver {
    /// Creates a driver for a robot of this radius (m), > 0.
    ///
    /// # Errors
    /// [`ParamsError`] naming the parameter that is out of range.
    pub fn new(params: DriverParams, limits: Limits, radius: f64) -> Result<Self, ParamsError> {
        check(&params)?;
        positive("radius", radius)?;
        Ok(Self {
            params,
            limits,
            radius,
            bug: TangentBug::new(radius)?,
            leg: None,
            onward: None,
            before: None,
            echoes: Vec::new(),
        })
    }

    /// The current waypoint.
    pub fn current(&self) -> Option<&Waypoint> {
        self.leg.as_ref().map(|leg| &leg.waypoint)
    }

    /// Ends the current waypoint as one that is not reached in time (s), because the robot has something else to do.
    /// Returns the one that it had taken ahead.
    pub fn abandon(&mut self, time_s: f64, reports: &mut Vec<WaypointReport>) -> Option<Waypoint> {
        self.end(WaypointOutcome::TimedOut, time_s, reports);
        self.before = None;
        self.onward.take()
    }

    /// Ends the current waypoint at time (s) if a body that stands there covers it.
    pub fn leave_out(
        &mut self,
        is_covered: impl Fn(Point2<f64>) -> bool,
        time_s: f64,
        reports: &mut Vec<WaypointReport>,
    ) {
        if (self.current()).is_some_and(|waypoint| is_covered(waypoint.point)) {
            self.end(WaypointOutcome::InsideObstacle, time_s, reports);
        }
    }

    /// Executes one tick: ends waypoints that are reached, late or given up, takes the `next`
    /// ones, and drives. Appends the outcomes of waypoints to `reports`.
    ///
    /// With `go_to.deceleration` set, one more waypoint is taken ahead. A pose, time or tick that is
    /// not finite stops the robot and changes nothing else. A waypoint that is not finite is
    /// reported unreachable.
    pub fn drive(
        &mut self,
        next: &mut dyn FnMut() -> Option<Waypoint>,
        situation: &Situation<'_>,
        reports: &mut Vec<WaypointReport>,
    ) -> DriverOutput {
        self.drive_on_time(next, &mut |_| None, situation, reports)
    }

    /// As [`Self::drive`], with waypoints that are due at a time (s): `due` is called each tick for
    /// the current waypoint; `None` means as soon as possible.
    ///
    /// The robot limits its speed so that it arrives when the waypoint is due, and does not stand
    /// still to wait. If it is late, and around obstacles, it drives as fast as it can. The time
    /// limit of a waypoint does not end before it is due; it is extended by as much as the due time
    /// exceeds the earliest arrival.
    pub fn drive_on_time(
        &mut self,
        next: &mut dyn FnMut() -> Option<Waypoint>,
        due: &mut dyn FnMut(&Waypoint) -> Option<f64>,
        situation: &Situation<'_>,
        reports: &mut Vec<WaypointReport>,
    ) -> DriverOutput {
        let Situation {
            pose, time_s, dt, ..
        } = *situation;
        let usable = pose.is_finite() && time_s.is_finite() && dt.is_finite() && dt > 0.0;
        if !usable {
            return DriverOutput::STOP;
        }
        let here = pose.position();
        let before = self.before.replace(here).unwrap_or(here);
        // Only the first waypoint of a tick was current when the robot drove the last segment.
        let mut from = before;
        for _ in 0..MAX_PER_TICK {
            let Some(leg) = self.leg.as_mut() else {
                match self.take_up(next, situation) {
                    None => return DriverOutput::STOP,
                    Some(Ok(leg)) => self.leg = Some(leg),
                    Some(Err(left_out)) => reports.push(left_out),
                }
                from = here;
                continue;
            };
            leg.take_due(due(&leg.waypoint));
            if let Some(outcome) = leg.passed(from, here, time_s, &self.params, self.radius) {
                self.end(outcome, time_s, reports);
                continue;
            }
            if leg.stands_s(time_s) >= DETOUR_AFTER * self.params.stuck_s {
                self.bug.begin_detour();
            }
            match self.head(situation) {
                Ok(driving) => return driving,
                Err(outcome) => self.end(outcome, time_s, reports),
            }
        }
        DriverOutput::STOP
    }

    /// Ends the current waypoint.
    fn end(&mut self, outcome: WaypointOutcome, time_s: f64, reports: &mut Vec<WaypointReport>) {
        if let Some(leg) = self.leg.take() {
            reports.push(leg.report(outcome, time_s));
        }
        self.bug.reset();
    }

    /// Takes the next waypoint, or reports why it is skipped; `None` if there is none.
    fn take_up(
        &mut self,
        next: &mut dyn FnMut() -> Option<Waypoint>,
        situation: &Situation<'_>,
    ) -> Option<Result<Leg, WaypointReport>> {
        let waypoint = self.onward.take().or_else(&mut *next)?;
        if self.params.go_to.deceleration.is_some() {
            self.onward = next();
        }
        let (point, time_s) = (waypoint.point, situation.time_s);
        let go_to = &self.params.go_to;
        let expected = time_without_obstacles(&situation.pose, point, &self.limits, go_to)
            + self.params.ramps_s(&self.limits);
        let allowed = (self.params.time_limit_factor * expected).max(MIN_TIME_S);
        let leg = Leg {
            waypoint,
            started_s: time_s,
            due_s: None,
            spare_s: ((self.params.time_limit_factor - 1.0) * expected).max(0.0),
            until_s: match waypoint.kind {
                WaypointKind::Route => f64::INFINITY,
                _ => time_s + allowed,
            },
            closest: f64::INFINITY,
            last_moved: (situation.pose.position(), time_s),
        };
        let finite = point.x.is_finite() && point.y.is_finite();
        let inside = situation
            .known
            .is_some_and(|known| !known.is_free(point, self.radius));
        Some(match (finite, inside, waypoint.kind) {
            (true, false, _) => Ok(leg),
            // A waypoint that must be visited is never skipped.
            (false, _, _) | (_, _, WaypointKind::Route) => {
                Err(leg.report(WaypointOutcome::Unreachable, time_s))
            }
            _ => Err(leg.report(WaypointOutcome::InsideObstacle, time_s)),
        })
    }

    /// The command towards the waypoint, or the outcome with which it ends.
    fn head(&mut self, situation: &Situation<'_>) -> Result<DriverOutput, WaypointOutcome> {
        let Some(leg) = self.leg.as_mut() else {
            return Ok(DriverOutput::STOP);
        };
        let goal = leg.waypoint.point;
        let part = leg.pace(situation, &self.params, &self.limits);
        let Situation {
            pose, twist, dt, ..
        } = *situation;
        let onward = self.onward.map(|waypoint| waypoint.point);
        let go_to_params = &self.params.go_to;
        let on_time = GoToParams {
            speed_fraction: go_to_params.speed_fraction * part,
            ..*go_to_params
        };
        let steer = |towards, beyond, params: &GoToParams| {
            let command = go_to(&pose, towards, beyond, &self.limits, params, dt);
            match self.params.angular_acceleration {
                Some(rate) => turning::ease(command, &pose, towards, rate, dt),
                None => command,
            }
        };
        let Some(scan) = &situation.scan else {
            return Ok(DriverOutput {
                command: steer(goal, onward, &on_time),
                towards: Some(goal),
                mode: None,
            });
        };
        let Some(advice) = self.bug.advise(&pose, scan, goal, go_to_params.arrived) else {
            // A scan without beams gives no information: stop.
            return Ok(DriverOutput::STOP);
        };
        let (towards, mode) = match advice {
            Advice::Head { towards, mode } => (towards, mode),
            Advice::Unreachable => return Err(WaypointOutcome::Unreachable),
            Advice::Stuck => return Err(WaypointOutcome::Stuck),
        };
        // The robot does not stop at a point on the path around an obstacle.
        let command = if mode == Mode::ToGoal {
            steer(towards, onward, &on_time)
        } else {
            let beyond = towards + (towards - pose.position());
            steer(towards, Some(beyond), go_to_params)
        };
        echoes(&pose, scan, self.radius, &mut self.echoes);
        let guard = Guard {
            theta: pose.theta,
            twist: if twist.is_finite() {
                twist
            } else {
                Twist2::STOP
            },
            echoes: &self.echoes,
            range: scan.range_max,
            radius: self.radius,
            dt,
            params: &self.params,
        };
        Ok(DriverOutput {
            command: self.limits.clip(guard.slow_down(command)),
            towards: Some(towards),
            mode: Some(mode),
        })
    }
}

impl Leg {
    /// Stores the due time of the waypoint (s) and extends its time limit.
    fn take_due(&mut self, due_s: Option<f64>) {
        self.due_s = due_s;
        if let Some(due_s) = due_s {
            // NaN does not count.
            self.until_s = self.until_s.max(due_s + self.spare_s);
        }
    }

    /// Fraction of the speed with which the robot arrives when the waypoint is due.
    fn pace(&mut self, situation: &Situation<'_>, params: &DriverParams, limits: &Limits) -> f64 {
        let Some(due_s) = self.due_s else {
            return 1.0;
        };
        let (here, now) = (situation.pose.position(), situation.time_s);
        let distance = (self.waypoint.point - here).norm();
        let v_max = limits.v_max() * params.go_to.speed_fraction;
        let part = pace::part(distance, due_s - now, v_max);
        if part < 1.0 {
            // The robot is slow on purpose, not stuck.
            self.last_moved = (here, now);
        }
        part
    }

    /// Checks the driven segment; returns the outcome if the waypoint has ended.
    fn passed(
        &mut self,
        from: Point2<f64>,
        here: Point2<f64>,
        time_s: f64,
        params: &DriverParams,
        radius: f64,
    ) -> Option<WaypointOutcome> {
        self.closest = self
            .closest
            .min(distance_to_segment(self.waypoint.point, from, here));
        if self.closest <= params.go_to.arrived {
            return Some(WaypointOutcome::Reached);
        }
        if time_s >= self.until_s {
            return Some(WaypointOutcome::TimedOut);
        }
        if (here - self.last_moved.0).norm() > radius {
            self.last_moved = (here, time_s);
        }
        (self.stands_s(time_s) >= params.stuck_s).then_some(WaypointOutcome::Stuck)
    }

    /// Time since the robot last moved by its radius (s).
    fn stands_s(&self, time_s: f64) -> f64 {
        time_s - self.last_moved.1
    }

    fn report(&self, outcome: WaypointOutcome, time_s: f64) -> WaypointReport {
        WaypointReport {
            waypoint: self.waypoint,
            outcome,
            started_s: self.started_s,
            ended_s: time_s,
            closest: self.closest,
        }
    }
}
