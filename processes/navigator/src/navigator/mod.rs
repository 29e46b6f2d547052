//! The navigator of one robot: what it asks, what it takes, what it commands.

mod asking;

use geometry::pose::Twist2;
use nalgebra::Point2;
use planner_view::free_space::FreeSpace;
use planner_view::view::View;
use sim_backend::spec::RobotModel;

use crate::drive::Drive;
use crate::follow::{Follow, Motion, STANDING, Stops};
use crate::params::{AtPopup, NavigatorParams};
use crate::traffic::Traffic;
use crate::trajectory::Trajectory;
use crate::trajectory_request::{PlanFailure, TrajectoryRequest};

/// Distance from a goal at which it is reached (m).
const GOAL_TOLERANCE: f64 = 0.03;
/// Time between two tries while there is no way (s).
const RETRY_S: f64 = 1.0;
/// What a plan that is not needed must gain to be taken (s).
const GAIN: f64 = 1e-3;
/// Ticks that are computed ahead at most: a start in the far future is the end of the plan.
const MAX_AHEAD: f64 = 10_000.0;

/// Why a plan is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ReplanReason {
    /// There is none, or none that leads on.
    Need,
    /// The world has changed: there may be a better one.
    Better,
}

/// A question that is open.
#[derive(Debug, Clone)]
struct OpenRequest {
    want: ReplanReason,
    /// When the answer takes effect (s).
    due: f64,
    /// Index of the goal.
    goal: usize,
    /// Distance that the answer keeps from obstacles (m).
    clearance: f64,
    /// Whether it begins nearer to one than it should.
    is_tight: bool,
    /// Whether the robot stands where it begins.
    stands: bool,
    /// Whether other robots were planned around.
    around_robots: bool,
}

/// What a tick comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// What the robot does.
    pub command: Twist2,
    /// What to ask of the optimiser; whatever was asked before is of no interest any more.
    pub ask: Option<TrajectoryRequest>,
}

/// Drives one robot to its goals.
#[derive(Debug, Clone)]
pub struct Navigator {
    params: NavigatorParams,
    drive: Drive,
    models: Vec<RobotModel>,
    goals: Vec<Point2<f64>>,
    /// Index of the goal that is driven to; beyond the last when all are reached.
    goal: usize,
    follow: Option<Follow>,
    /// The reference's rate in the last tick, and when that was (s).
    pace: (f64, f64),
    traffic: Traffic,
    /// Since when another robot is in the way (s), and which.
    held_up: Option<(f64, usize)>,
    asked: Option<OpenRequest>,
    want: Option<ReplanReason>,
    /// Not asked again before this time (s).
    not_before: f64,
    /// Whether it stops before it asks.
    halt: bool,
    ignore_robots: bool,
    revision: Option<u64>,
    /// What it was last told about there being no plan.
    known: Option<PlanFailure>,
}

impl Navigator {
    /// A navigator for a robot with these goals (m).
    ///
    /// # Errors
    /// A text that says why this cannot be done.
    pub fn new(
        params: NavigatorParams,
        model: RobotModel,
        goals: Vec<Point2<f64>>,
    ) -> Result<Self, String> {
        if goals.is_empty() {
            return Err("no goals: neither the process's `goals` nor the robot's `goal`".into());
        }
        if model.omega_max <= 0.0 {
            return Err("a robot that cannot turn (limits.omega_max = 0) cannot navigate".into());
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
            asked: None,
            want: Some(ReplanReason::Need),
            not_before: 0.0,
            halt: false,
            ignore_robots: false,
            revision: None,
            known: None,
        })
    }

    /// Takes note of what the robots of the run can do, by their index.
    pub fn meet(&mut self, models: Vec<RobotModel>) {
        self.models = models;
    }

    /// The trajectory that is being followed.
    pub fn following(&self) -> Option<&Follow> {
        self.follow.as_ref()
    }

    /// The goal that is driven to (m); `None` when all are reached.
    pub fn goal(&self) -> Option<Point2<f64>> {
        self.goals.get(self.goal).copied()
    }

    /// Whether an answer would take effect now.
    pub fn is_due(&self, time_s: f64) -> bool {
        self.asked
            .as_ref()
            .is_some_and(|asked| time_s >= asked.due - 1e-9)
    }

    /// Whether there has been a plan since one was last missing for such a reason.
    pub fn is_news(&self, reason: &PlanFailure) -> bool {
        let kind = core::mem::discriminant::<PlanFailure>;
        self.known.as_ref().map(kind) != Some(kind(reason))
    }

    /// Takes the answer to what was asked.
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
        // In real time it may be late: who moves is on his way already.
        let tau = if asked.stands {
            0.0
        } else {
            (time_s - asked.due).max(0.0)
        };
        let blocked = trajectory.blocked(space, tau, asked.clearance);
        if blocked.is_some() {
            // The world has changed since it was asked for.
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
            careful: asked.is_tight,
        });
    }

    fn do_without(&mut self, asked: &OpenRequest, reason: PlanFailure, time_s: f64) {
        if asked.want == ReplanReason::Better {
            return;
        }
        self.want = Some(ReplanReason::Need);
        if matches!(reason, PlanFailure::NoAnswer(_)) {
            // OpenRequest again at once, on the way.
        } else if asked.stands {
            self.not_before = time_s + RETRY_S;
            // Others may stand on the goal, or all around; they may also go.
            self.ignore_robots = asked.around_robots && !self.ignore_robots;
        } else {
            // From a standstill more is possible.
            self.halt = true;
        }
        self.known = Some(reason);
    }

    /// What the robot does in this tick, and what is asked.
    pub fn step(&mut self, space: &FreeSpace, revision: u64, view: &View<'_>) -> Decision {
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
        self.look_at_map(space, revision);
        self.look_at_error(&motion, stands);
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
        let ask = self.ask(space, view, own, &stops);
        Decision { command, ask }
    }

    /// Moves the reference to where it is at this time.
    fn move_on(&mut self, time_s: f64) {
        let (rate, since) = self.pace;
        self.pace.1 = time_s;
        if let Some(follow) = &mut self.follow {
            follow.tau += rate * (time_s - since).max(0.0);
        }
    }

    /// Looks whether the way is still free when the map has changed.
    fn look_at_map(&mut self, space: &FreeSpace, revision: u64) {
        if self.revision == Some(revision) {
            return;
        }
        let first = self.revision.is_none();
        self.revision = Some(revision);
        // What was impossible may be possible now.
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

    /// Gives the plan up when the robot is too far from where it should be.
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

    /// Turns to the next goal when this one is reached, or will be before a plan could be there.
    fn look_at_goal(&mut self, motion: &Motion, dt: f64) {
        let Some(goal) = self.goal() else { return };
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

    /// Where other robots are in the way, and whether it has been for long.
    fn look_at_others(&mut self, motion: &Motion, view: &View<'_>) -> Stops {
        let mut stops = Stops {
            halt: self.halt,
            traffic: None,
        };
        let Some(follow) = &self.follow else {
            return stops;
        };
        let ahead = self.drive.reach(motion.twist.v, view.dt) + self.params.margin;
        let Some((along, who)) = self.traffic.stop(&follow.trajectory, follow.tau, ahead) else {
            self.held_up = None;
            return stops;
        };
        stops.traffic = Some(along);
        let stands = motion.twist.v.abs() < STANDING;
        match self.held_up {
            Some((since, _)) if stands => {
                // Who has the right of way looks for another one first.
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

    /// Time from asking to the tick at which the answer takes effect (s).
    fn ahead(&self, dt: f64) -> f64 {
        (self.params.planning_time_s / dt - 1e-9)
            .ceil()
            .clamp(1.0, MAX_AHEAD)
            * dt
    }
}
