//! A trajectory along the exact shortest path: it exists whenever a path exists, and is the
//! fallback.
//!
//! The robot turns on the spot into the path, follows its straight legs and arcs, and turns on the
//! spot into the prescribed heading. Where ω cannot step (limited angular acceleration) it stops
//! between a straight leg and an arc: slow, but within every limit. A robot that arrives with a
//! speed that cannot step to 0 first brakes, along its current arc.

use core::f64::consts::{PI, TAU};

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};
use navigation::tangent_graph::PathLeg;
use planner_view::free_space::Arc;

use crate::drive::speed_profile;
use crate::drive::trajectory_builder::Trajectory;
use crate::guide::Guide;
use crate::obstacle_field::ExactObstacleField;
use crate::path_points::{self, PathPoint};
use crate::plan::PlanError;
use trajectory_problem::{Problem, RobotLimits};

/// Maximum turn of a robot while its turning rate fades (rad); above it there is no plan.
const MAX_SPIN: f64 = 100.0;
/// Speeds (m/s, rad/s) below which the robot stands.
const STANDING: f64 = 1e-9;

/// The trajectory along the shortest path; `guide` is that path, if the robot does not brake first
/// (`None`: start and goal are the same point).
///
/// # Errors
/// [`PlanError::Infeasible`] if the prescribed speeds cannot be kept, [`PlanError::NoPath`] if the
/// robot can only stop where no path leads on.
pub fn trajectory(
    problem: &Problem,
    obstacle_field: &ExactObstacleField,
    guide: Option<&Guide>,
) -> Result<Trajectory, PlanError> {
    let mut trajectory = Trajectory::from_start(&problem.start);
    let braked;
    let guide = match brake(problem, obstacle_field, &mut trajectory)? {
        None => guide,
        Some(stop) => {
            let path = obstacle_field.shortest(stop.position(), problem.goal)?;
            braked = Guide::new(path.legs);
            braked.as_ref()
        }
    };
    if let Some(guide) = guide {
        let angle = math::angle_difference(guide.start_heading(), trajectory.heading());
        trajectory.turn(&problem.limits, angle);
        follow(problem, guide, &mut trajectory)?;
    }
    arrive(problem, &mut trajectory)?;
    trajectory.keep_ends(problem);
    Ok(trajectory)
}

/// Brakes from the prescribed speeds that cannot step; returns the stop pose, if there was any
/// speed.
fn brake(
    problem: &Problem,
    obstacle_field: &ExactObstacleField,
    trajectory: &mut Trajectory,
) -> Result<Option<Pose2>, PlanError> {
    let limits = &problem.limits;
    let v = problem.start_speed.unwrap_or(0.0);
    let omega = problem.start_turn_rate.unwrap_or(0.0);
    let linear = limits.acceleration.map_or(0.0, |a| v.abs() / a);
    let angular = limits.angular_acceleration.map_or(0.0, |a| omega.abs() / a);
    let rolls = limits.acceleration.is_some() && v.abs() > STANDING;
    let turns = limits.angular_acceleration.is_some() && omega.abs() > STANDING;
    if !rolls && !turns {
        return Ok(None);
    }
    let start = problem.start;
    let duration = if rolls { linear.max(angular) } else { angular };
    let too_long = 0.5 * v.abs() * duration > path_points::MAX_LENGTH
        || 0.5 * omega.abs() * duration > MAX_SPIN;
    if too_long && (rolls || turns) {
        return Err(PlanError::Infeasible(
            "the robot takes too long to stop or to stop turning",
        ));
    }
    if !rolls {
        // V steps to 0, ω fades on the spot.
        trajectory.fade(omega, duration);
        return Ok(Some(Pose2::new(
            start.x,
            start.y,
            start.theta + 0.5 * omega * duration,
        )));
    }
    // Both fade together, so that the path is an arc (straight, if ω can step). An unlimited V
    // would step to 0 and does not occur here.
    let omega = if turns { omega } else { 0.0 };
    let length = 0.5 * v.abs() * duration;
    let kappa = omega / v.abs();
    // A robot that rolls backwards drives ahead as one that is turned around.
    let reverse = if v < 0.0 { PI } else { 0.0 };
    let travel = Pose2::new(start.x, start.y, start.theta + reverse);
    let leg = leg_ahead(&travel, length, kappa);
    let free = match &leg {
        PathLeg::Segment { from, to } => {
            obstacle_field
                .space
                .segment_is_free(*from, *to, obstacle_field.clearance)
        }
        PathLeg::Arc(arc) => obstacle_field
            .space
            .arc_is_free(arc, obstacle_field.clearance),
    };
    if !free {
        return Err(PlanError::Infeasible(
            "the robot is too fast to stop before an obstacle",
        ));
    }
    let points = path_points::of_leg(&leg, 0.0, travel.theta);
    let fade = |p: &PathPoint| v.abs() * (1.0 - p.s / length).max(0.0).sqrt();
    let mut speeds: Vec<f64> = points.iter().map(fade).collect();
    if let Some(last) = speeds.last_mut() {
        *last = 0.0;
    }
    if v < 0.0 {
        trajectory.drive_backwards(&points, &speeds);
    } else {
        trajectory.drive(&points, &speeds);
    }
    let end = points.last().map_or(start.position(), |p| p.at);
    Ok(Some(Pose2::new(end.x, end.y, start.theta + kappa * length)))
}

/// The leg ahead of a pose with a length (m) and a curvature (1/m).
fn leg_ahead(pose: &Pose2, length: f64, kappa: f64) -> PathLeg {
    let from = pose.position();
    if (kappa * length).abs() < 1e-9 {
        return PathLeg::Segment {
            from,
            to: from + pose.forward() * length,
        };
    }
    let forward = pose.forward();
    let left = Vector2::new(-forward.y, forward.x);
    let center: Point2<f64> = from + left / kappa;
    let outward = from - center;
    PathLeg::Arc(Arc {
        center,
        radius: 1.0 / kappa.abs(),
        start: math::atan2(outward.y, outward.x),
        sweep: (kappa * length).clamp(-TAU, TAU),
    })
}

/// Follows the legs; passes joints as the limits allow.
fn follow(problem: &Problem, guide: &Guide, trajectory: &mut Trajectory) -> Result<(), PlanError> {
    let limits = &problem.limits;
    // Where ω cannot step, every leg is driven from rest to rest.
    let stops = limits.angular_acceleration.is_some();
    let end = end_speed(problem);
    let legs: Vec<&PathLeg> = guide.legs().map(|(_, leg)| leg).collect();
    let rest = (stops || limits.acceleration.is_some()).then_some(0.0);
    let mut points: Vec<PathPoint> = Vec::new();
    for (i, leg) in legs.iter().enumerate() {
        let (s, theta) = points
            .last()
            .map_or((0.0, trajectory.heading()), |p| (p.s, p.theta));
        let heading = path_points::leg_heading(leg, theta);
        if !stops && (heading - theta).abs() > 1e-6 {
            // A kink, where the start was pushed out of an obstacle: turn on the spot.
            drive(limits, &points, [rest, rest], trajectory)?;
            trajectory.turn(limits, heading - theta);
            points.clear();
        } else if stops {
            trajectory.turn(limits, heading - trajectory.heading());
        }
        points.extend(path_points::of_leg(leg, s, heading));
        let last = i + 1 == legs.len();
        if stops || last {
            let to = if last { end } else { rest };
            drive(limits, &points, [rest, to], trajectory)?;
            points.clear();
        }
    }
    Ok(())
}

fn drive(
    limits: &RobotLimits,
    points: &[PathPoint],
    [start, end]: [Option<f64>; 2],
    trajectory: &mut Trajectory,
) -> Result<(), PlanError> {
    if points.len() < 2 {
        return Ok(());
    }
    let speeds = speed_profile::speeds(points, limits, start, end).ok_or(PlanError::Infeasible(
        "the prescribed speed at the goal is impossible on the path to it",
    ))?;
    trajectory.drive(points, &speeds);
    Ok(())
}

/// The speed (m/s) at which the last leg must end.
fn end_speed(problem: &Problem) -> Option<f64> {
    let limits = &problem.limits;
    match problem.goal_heading {
        // The robot turns on the spot there.
        Some(_) if !limits.is_without_inertia() => Some(0.0),
        _ => problem.goal_speed.filter(|_| limits.acceleration.is_some()),
    }
}

/// Turns into the prescribed heading and ends with the prescribed speed.
fn arrive(problem: &Problem, trajectory: &mut Trajectory) -> Result<(), PlanError> {
    trajectory.settle(problem.goal);
    if let Some(heading) = problem.goal_heading {
        let angle = math::angle_difference(heading, trajectory.heading());
        trajectory.turn(&problem.limits, angle);
    }
    let arrives = trajectory.samples().last().map_or(0.0, |last| last.v);
    if problem.limits.acceleration.is_some()
        && problem
            .goal_speed
            .is_some_and(|speed| (arrives - speed).abs() > 1e-6)
    {
        return Err(PlanError::Infeasible(
            "the robot cannot arrive with the prescribed speed and heading",
        ));
    }
    Ok(())
}
