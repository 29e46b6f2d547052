//! Navigator of one robot: its requests, plans and commands.

mod asking;
mod right_of_way;

use geometry::pose::Twist2;
use nalgebra::Point2;
use navigation::routes::RouteFinder;
use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use planner_view::view::View;
use right_of_way::RightOfWay;
use robot::spec::RobotModel;
use runtime::config::RobotInfo;
use trajectory_problem::Problem;

use crate::drive::Drive;
use crate::follow::{Follow, Motion, STANDING, Stops};
use crate::params::{AtPopup, NavigatorParams};
use crate::plan_failure::PlanFailure;
use crate::traffic::Traffic;
use crate::trajectory::Trajectory;

/// Distance below which a goal counts as reached (m).
const GOAL_TOLERANCE: f64 = 0.03;
/// Time between two requests while there is no path (s).
const RETRY_S: f64 = 1.0;
/// Minimum gain of an optional plan that is used (s).
const GAIN: f64 = 1e-3;
/// Maximum number of ticks computed ahead: a start in the far future is the end of the plan.
const MAX_AHEAD: f64 = 10_000.0;

/// Reason for a new plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ReplanReason {
    /// There is no plan, or none that continues.
    Need,
    /// The world has changed: a better plan may exist.
    Better,
}

/// Pending request.
#[derive(Debug, Clone)]
struct OpenRequest {
    want: ReplanReason,
    /// Time at which the answer takes effect (s).
    due: f64,
    /// Index of the goal.
    goal: usize,
    /// Distance of the planned trajectory from obstacles (m).
    clearance: f64,
    /// Length by which the start is nearer to an obstacle than the margin allows (m).
    depth: f64,
    /// `true` if the robot stands at the start.
    stands: bool,
    /// `true` if other robots count as obstacles.
    around_robots: bool,
    /// `true` if the plan ends before its goal, on the route to it.
    is_stretch: bool,
}

/// Result of a tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// Command to the robot.
    pub command: Twist2,
    /// Request to the optimiser; it replaces any earlier request.
    pub ask: Option<Problem>,
}

/// Drives one robot to its goals.
#[derive(Debug, Clone)]
pub struct Navigator {
    params: NavigatorParams,
    drive: Drive,
    models: Vec<RobotModel>,
    goals: Vec<Point2<f64>>,
    /// Index of the current goal; beyond the last when all are reached.
    goal: usize,
    follow: Option<Follow>,
    /// Rate of the reference in the last tick, and the time of that tick (s).
    pace: (f64, f64),
    traffic: Traffic,
    /// Time since which another robot blocks the path (s), and its index.
    held_up: Option<(f64, usize)>,
    right_of_way: RightOfWay,
    /// Place (m) to which the robot drives first to let others pass.
    detour: Option<Point2<f64>>,
    /// Routes on a map that is too large for one request.
    routes: RouteFinder,
    asked: Option<OpenRequest>,
    want: Option<ReplanReason>,
    /// Earliest time of the next request (s).
    not_before: f64,
    /// `true` if the robot stops before the request.
    halt: bool,
    ignore_robots: bool,
    revision: Option<u64>,
    /// Last reported reason for the lack of a plan.
    known: Option<PlanFailure>,
}

/// Reason why a robot cannot navigate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NavigatorError {
    /// It has nowhere to go.
    #[error("no goals: neither the process's `goals` nor the robot's `goal`")]
    NoGoals,
    /// It drives straight only.
    #[error("a robot that cannot turn (limits.omega_max = 0) cannot navigate")]
    CannotTurn,
}

impl Navigator {
    /// Returns a navigator for a robot with these goals (m).
    ///
    /// # Errors
    /// [`NavigatorError`].
    pub fn new(
        params: NavigatorParams,
        model: RobotModel,
        goals: Vec<Point2<f64>>,
    ) -> Result<Self, NavigatorError> {
        if goals.is_empty() {
            return Err(NavigatorError::NoGoals);
        }
        if model.omega_max <= 0.0 {
            return Err(NavigatorError::CannotTurn);
        }
        Ok(Self {
            params,
            drive: Drive::new(model),
            models: Vec::new(),
            goals,
            goal: 0,
            follow: None,
            pace: (0.0, 0.0),
            traffic: Traffic::default(),
            held_up: None,
            right_of_way: RightOfWay::default(),
            detour: None,
            routes: RouteFinder::default(),
            asked: None,
            want: Some(ReplanReason::Need),
            not_before: 0.0,
            halt: false,
            ignore_robots: false,
            revision: None,
            known: None,
        })
    }

    /// Stores the properties of the robots of the run, by their index.
    pub fn meet(&mut self, robots: &[RobotInfo]) {
        self.models = robots.iter().map(|robot| robot.model).collect();
        self.right_of_way = RightOfWay::new(robots, self.params.margin);
    }

    /// Returns the followed trajectory.
    pub fn following(&self) -> Option<&Follow> {
        self.follow.as_ref()
    }

    /// Returns the current goal (m); `None` when all are reached.
    pub fn goal(&self) -> Option<Point2<f64>> {
        self.goals.get(self.goal).copied()
    }

    /// Returns `true` if an answer would take effect now.
    pub fn is_due(&self, time_s: f64) -> bool {
        self.asked
            .as_ref()
            .is_some_and(|asked| time_s >= asked.due - 1e-9)
    }

    /// Returns `true` unless the last reported failure is of the same kind.
    pub fn is_news(&self, reason: &PlanFailure) -> bool {
        let kind = core::mem::discriminant::<PlanFailure>;
        self.known.as_ref().map(kind) != Some(kind(reason))
    }

    /// Accepts the answer to a request.
    pub fn take(
        &mut self,
        planned: Result<Trajectory, PlanFailure>,
        space: &FreeSpace,
        time_s: f64,
    ) {
        let Some(asked) = self.asked.take() else {
            return;
        };
        self.move_on(time_s);
        let trajectory = match planned {
            Ok(trajectory) => trajectory,
            Err(reason) => return self.do_without(&asked, reason, time_s),
        };
        self.known = None;
        self.ignore_robots = false;
        let left = self.follow.as_ref().map(Follow::left);
        let better = left.is_some_and(|left| trajectory.duration() < left - GAIN);
        if asked.want == ReplanReason::Better && !better {
            return;
        }
        // In real time the answer may be late: a moving robot is already on the new path.
        let tau = if asked.stands {
            0.0
        } else {
            (time_s - asked.due).max(0.0)
        };
        let blocked = trajectory.blocked(space, tau, asked.clearance);
        if blocked.is_some() {
            // The world has changed since the request.
            self.want = Some(ReplanReason::Need);
        }
        self.halt = self.halt && blocked.is_some();
        self.held_up = None;
        self.goal = asked.goal;
        self.pace = (0.0, time_s);
        self.follow = Some(Follow {
            trajectory,
            tau,
            clearance: asked.clearance,
            blocked,
            careful: asked.depth > 0.0,
            is_stretch: asked.is_stretch,
        });
    }

    fn do_without(&mut self, asked: &OpenRequest, reason: PlanFailure, time_s: f64) {
        if asked.want == ReplanReason::Better {
            return;
        }
        self.want = Some(ReplanReason::Need);
        if matches!(reason, PlanFailure::NoAnswer(_)) {
            // Requests again at once, while the robot drives.
        } else if asked.stands {
            self.not_before = time_s + RETRY_S;
            // Other robots may stand on the goal or all around; they may also leave.
            self.ignore_robots = asked.around_robots && !self.ignore_robots;
        } else {
            // More paths are possible from a standstill.
            self.halt = true;
        }
        self.known = Some(reason);
    }

    /// Returns the command and the request of this tick, in the exact `space` of the map.
    pub fn step(&mut self, map: &PlannerMap, space: &FreeSpace, view: &View<'_>) -> Decision {
        let standstill = Decision {
            command: Twist2::STOP,
            ask: None,
        };
        let Some(own) = view.own().filter(|own| own.active) else {
            self.follow = None;
            return standstill;
        };
        let model = *self.drive.model();
        self.traffic.update(view, &model, &self.models);
        self.move_on(view.time_s);
        let motion = Motion {
            pose: own.pose,
            twist: own.twist,
        };
        let stands = own.twist.v.abs() < STANDING;
        self.look_at_map(space, map.revision());
        self.look_at_error(&motion, stands);
        self.look_at_stretch(view.dt);
        self.look_at_right_of_way(space, view, &motion);
        self.look_at_goal(&motion, view.dt);
        let stops = self.look_at_others(&motion, view);
        let (command, pace) = match &self.follow {
            Some(follow) => {
                let pace = follow.pace(&self.drive, &motion, &stops, view.dt);
                (pace.command, Some(pace))
            }
            None => (Twist2::STOP, None),
        };
        self.pace = (pace.map_or(0.0, |pace| pace.rate), view.time_s);
        let ask = self.ask(map, space, view, own, &stops);
        Decision { command, ask }
    }

    /// Moves the reference to its pose at this time.
    fn move_on(&mut self, time_s: f64) {
        let (rate, since) = self.pace;
        self.pace.1 = time_s;
        if let Some(follow) = &mut self.follow {
            follow.tau += rate * (time_s - since).max(0.0);
        }
    }

    /// Checks that the path is still free when the map has changed.
    fn look_at_map(&mut self, space: &FreeSpace, revision: u64) {
        if self.revision == Some(revision) {
            return;
        }
        let first = self.revision.is_none();
        self.revision = Some(revision);
        // A request that failed before may succeed now.
        self.not_before = 0.0;
        let Some(follow) = &mut self.follow else {
            return;
        };
        follow.blocked = follow
            .trajectory
            .blocked(space, follow.tau, follow.clearance);
        if follow.blocked.is_some() {
            self.want = Some(ReplanReason::Need);
            self.halt |= self.params.at_popup == AtPopup::Stop;
        } else if self.want.is_none() && !first {
            self.want = Some(ReplanReason::Better);
        }
    }

    /// Drops the plan if the robot is too far from its reference.
    fn look_at_error(&mut self, motion: &Motion, stands: bool) {
        let Some(follow) = &self.follow else { return };
        if follow.error(&motion.pose) > self.params.max_error {
            self.want = Some(ReplanReason::Need);
            self.halt = true;
            if stands {
                self.follow = None;
            }
        }
    }

    /// Requests the next stretch of the route when half of this one is left, so that the robot does not slow down
    /// between them.
    fn look_at_stretch(&mut self, dt: f64) {
        let Some(follow) = self.follow.as_ref().filter(|follow| follow.is_stretch) else {
            return;
        };
        // At half of a way out of an obstacle the robot may still turn towards it.
        let share = if follow.careful { 0.0 } else { 0.5 };
        let half = share * follow.trajectory.duration();
        if self.asked.is_none() && follow.left() <= half.max(self.ahead(dt)) {
            self.want = Some(ReplanReason::Need);
        }
    }

    /// Selects the next goal when the robot has reached this one, or will reach it before a plan
    /// could be ready.
    fn look_at_goal(&mut self, motion: &Motion, dt: f64) {
        let Some(goal) = self.goal().filter(|_| self.detour.is_none()) else {
            return;
        };
        let Some(follow) = &self.follow else { return };
        let is_last = self.goal + 1 == self.goals.len() && !self.params.repeat;
        let ahead = if is_last { 0.0 } else { self.ahead(dt) };
        let end = follow.trajectory.at(f64::INFINITY).0.position();
        let leads_there = (end - goal).norm() <= GOAL_TOLERANCE;
        if !leads_there || follow.left() > ahead || follow.blocked.is_some() {
            return;
        }
        if is_last {
            let near = (motion.pose.position() - goal).norm() <= GOAL_TOLERANCE;
            let stands = motion.twist.v.abs() < STANDING;
            if near && stands {
                (self.goal, self.want, self.asked) = (self.goals.len(), None, None);
            } else if stands {
                self.want = Some(ReplanReason::Need);
            }
        } else {
            self.goal = (self.goal + 1) % self.goals.len();
            self.want = Some(ReplanReason::Need);
            self.not_before = 0.0;
        }
    }

    /// Returns the place that the next plan leads to (m).
    fn destination(&self) -> Option<Point2<f64>> {
        self.detour.or_else(|| self.goal())
    }

    /// Requests a plan when the robots that pass each other leave another place to this one.
    fn look_at_right_of_way(&mut self, space: &FreeSpace, view: &View<'_>, motion: &Motion) {
        self.right_of_way.update(space, view, &self.traffic);
        let at = motion.pose.position();
        let detour = self.right_of_way.destination(view.me, at, space);
        if detour != self.detour {
            self.detour = detour;
            self.want = Some(ReplanReason::Need);
            self.ignore_robots = false;
            self.not_before = 0.0;
        }
    }

    /// Finds where other robots block the path, and whether they have blocked it for long.
    fn look_at_others(&mut self, motion: &Motion, view: &View<'_>) -> Stops {
        let mut stops = Stops {
            halt: self.halt,
            traffic: None,
        };
        let Some(follow) = &self.follow else {
            return stops;
        };
        let ahead = self.drive.reach(motion.twist.v, view.dt) + self.params.margin;
        let stop = self.traffic.stop(&follow.trajectory, follow.tau, ahead);
        let stands = motion.twist.v.abs() < STANDING;
        let Some((along, who)) = stop else {
            self.held_up = None;
            return stops;
        };
        stops.traffic = Some(along);
        match self.held_up {
            Some((since, _)) if stands => {
                // The robot with the right of way replans first.
                let others = if who < view.me { 3.0 } else { 1.0 };
                if view.time_s - since >= others * self.params.patience_s {
                    self.want = Some(ReplanReason::Need);
                    self.held_up = Some((view.time_s, who));
                }
            }
            _ => self.held_up = Some((view.time_s, who)),
        }
        stops
    }

    /// Returns the time from a request to the tick at which its answer takes effect (s).
    fn ahead(&self, dt: f64) -> f64 {
        (self.params.planning_time_s / dt - 1e-9)
            .ceil()
            .clamp(1.0, MAX_AHEAD)
            * dt
    }
}
