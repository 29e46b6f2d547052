//! Requests to the optimiser: their start poses, obstacles and times.

use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use robot::spec::RobotModel;
use trajectory_problem::{Problem, RobotLimits};

use super::{Navigator, OpenRequest};
use crate::excerpt::{Excerpt, Trip};
use crate::follow::{self, Motion, STANDING, Stops};
use crate::plan_failure::PlanFailure;
use crate::trajectory::SAGITTA;

/// Maximum contact depth beyond the margin at which a robot still gets a plan (m).
const CONTACT: f64 = 2e-3;
/// Depth beyond which a robot first leaves the obstacle, in margins.
const TOUCHING: f64 = 0.75;
/// Tolerance of a trajectory's distance from obstacles (m): the tolerance of the plan check and the
/// error of its straight pieces here.
const ROUNDING: f64 = 1e-3 + SAGITTA;

impl Navigator {
    /// Returns the request of this tick, if any.
    pub(super) fn ask(
        &mut self,
        map: &PlannerMap,
        space: &FreeSpace,
        view: &View<'_>,
        own: &RobotView,
        stops: &Stops,
    ) -> Option<Problem> {
        let want = self.want?;
        let goal = self.destination()?;
        let stands = own.twist.v.abs() < STANDING;
        let must_wait = view.time_s < self.not_before || self.halt && !stands;
        if self.asked.is_some() || must_wait {
            return None;
        }
        let ahead = self.ahead(view.dt);
        let start = self.predict(own, stops, ahead, view.dt);
        let clearance = self.drive.model().radius + self.params.margin;
        let start_at = start.pose.position();
        let depth = (clearance - space.distance(start_at)).max(0.0);
        // A robot that touches an obstacle leaves it along the normal first: a path along it would touch it again.
        let off = Some(depth)
            .filter(|depth| *depth > TOUCHING * self.params.margin && self.known.is_none())
            .and_then(|depth| space.free_place(start_at, clearance, 2.0 * depth));
        let trip = Trip {
            start: start_at,
            goal: off.unwrap_or(goal),
            clearance,
            start_tolerance: self.params.margin + CONTACT,
            others: self.traffic.others().len(),
        };
        let excerpt = Excerpt::new(map, space, &mut self.routes, &trip);
        let end = excerpt.as_ref().map_or(goal, |excerpt| excerpt.end);
        let robots = self.robots_in_the_way(clearance, start_at, end);
        let stands = start.twist.v.abs() < STANDING;
        self.want = None;
        let open = OpenRequest {
            want,
            due: view.time_s + ahead,
            goal: self.goal,
            clearance: clearance - depth - ROUNDING,
            depth,
            stands,
            around_robots: !robots.is_empty(),
            is_stretch: off.is_some() || excerpt.as_ref().is_some_and(|excerpt| excerpt.is_stretch),
        };
        let Some(excerpt) = excerpt else {
            let reason = PlanFailure::NoRoute;
            if self.is_news(&reason) {
                tracing::warn!("{reason}");
            }
            self.do_without(&open, reason, view.time_s);
            return None;
        };
        self.asked = Some(open);
        Some(Problem {
            start: start.pose,
            goal: excerpt.end,
            obstacles: excerpt.pieces.into_iter().chain(robots).collect(),
            clearance,
            bounds: excerpt.bounds,
            start_tolerance: trip.start_tolerance,
            ..self.speeds(&start)
        })
    }

    /// Returns a request with the speeds of its start and its end.
    fn speeds(&self, start: &Motion) -> Problem {
        let share = self.params.speed_fraction;
        let model = self.drive.model();
        let backwards = if self.params.plan.backwards {
            model.v_reverse_max.min(model.v_max)
        } else {
            0.0
        };
        let model = RobotModel {
            v_max: share * model.v_max,
            v_reverse_max: share * backwards,
            omega_max: share * model.omega_max,
            wheel_speed_max: model.wheel_speed_max.map(|max| share * max),
            ..*model
        };
        // A robot without inertia changes its speeds at once: they are free.
        let turn = start.twist.omega.clamp(-model.omega_max, model.omega_max);
        let turn = model.angular_acceleration.map(|_| turn);
        let wheels = model.wheel_speed_max.map_or(f64::INFINITY, |max| {
            let turning = 0.5 * turn.unwrap_or(0.0).abs() * model.wheel_separation;
            (max - turning).max(0.0)
        });
        let [least, most] = [-model.v_reverse_max, model.v_max].map(|v| v.clamp(-wheels, wheels));
        let speed = start.twist.v.clamp(least, most);
        Problem {
            start: start.pose,
            start_speed: model.acceleration.map(|_| speed),
            start_turn_rate: turn,
            goal: Point2::origin(),
            goal_heading: None,
            // The robot stands at its end: no further goal is known.
            goal_speed: model.acceleration.map(|_| 0.0),
            limits: RobotLimits::of_model(&model),
            obstacles: Vec::new(),
            clearance: 0.0,
            bounds: Aabb {
                min: Point2::origin(),
                max: Point2::origin(),
            },
            start_tolerance: 0.0,
        }
    }

    /// Predicts the robot's motion when the answer takes effect, with this tick's command and those
    /// that follow from it.
    fn predict(&self, own: &RobotView, stops: &Stops, ahead: f64, dt: f64) -> Motion {
        let mut motion = Motion {
            pose: own.pose,
            twist: own.twist,
        };
        let ticks = (ahead / dt).round() as u32;
        let mut follow = self.follow.clone();
        for _ in 0..ticks {
            match &mut follow {
                Some(follow) => {
                    let pace = follow.pace(&self.drive, &motion, stops, dt);
                    follow.advance(&self.drive, &mut motion, &pace, dt);
                }
                None => follow::stop(&self.drive, &mut motion, dt),
            }
        }
        motion
    }

    /// Returns discs for the robots that stay in the way.
    fn robots_in_the_way(
        &self,
        clearance: f64,
        start: Point2<f64>,
        goal: Point2<f64>,
    ) -> Vec<Convex> {
        if self.ignore_robots {
            return Vec::new();
        }
        let blocker = self.held_up.map(|(_, who)| who);
        let others = self.traffic.others().iter();
        others
            .filter(|other| other.parked || blocker == Some(other.index))
            .filter_map(|other| {
                let radius = other.planned_radius(clearance, start, goal);
                (radius > 0.0).then(|| Convex::disc(other.at, radius))
            })
            .collect()
    }
}
