//! The trajectory of a sequence of motions.

use core::f64::consts::PI;

use free_motion::Motion;
use geometry::pose::Pose2;

use crate::drive::speed_profile;
use crate::drive::trajectory_builder::Trajectory;
use crate::path_points::{self, PathPoint};
use crate::plan::Sample;
use trajectory_problem::{Problem, RobotLimits};

/// The trajectory of motions from the start of a problem. Speeds are those of the limits, except
/// that the turning rate may step.
pub fn samples(problem: &Problem, motions: &[Motion]) -> Vec<Sample> {
    let mut trajectory = Trajectory::from_start(&problem.start);
    let mut pose = problem.start;
    let mut rest = motions;
    while let Some(first) = rest.first() {
        if let Motion::Turn(angle) = first {
            trajectory.turn(&problem.limits, *angle);
            pose = first.end(&pose);
            rest = &rest[1..];
            continue;
        }
        let backwards = is_backwards(first);
        let count = rest
            .iter()
            .take_while(|motion| {
                matches!(motion, Motion::Drive { .. }) && is_backwards(motion) == backwards
            })
            .count();
        let is_first = rest.len() == motions.len();
        let is_last = rest.len() == count;
        let (run, after) = rest.split_at(count);
        let points;
        (points, pose) = points_of(run, pose, backwards);
        let sign = if backwards { -1.0 } else { 1.0 };
        let limits = limits_of(&problem.limits, backwards);
        let end = |is_end: bool, asked: Option<f64>| match asked {
            _ if limits.acceleration.is_none() => None,
            Some(v) if is_end => Some((sign * v).max(0.0)),
            None if is_end => None,
            _ => Some(0.0),
        };
        let [from, to] = [
            end(is_first, problem.start_speed),
            end(is_last, problem.goal_speed),
        ];
        let speeds = speed_profile::speeds(&points, &limits, from, to)
            .or_else(|| speed_profile::speeds(&points, &limits.without_inertia(), None, None))
            .unwrap_or_default();
        if backwards {
            trajectory.drive_backwards(&points, &speeds);
        } else {
            trajectory.drive(&points, &speeds);
        }
        rest = after;
    }
    trajectory.keep_ends(problem);
    trajectory.into_samples()
}

fn is_backwards(motion: &Motion) -> bool {
    matches!(motion, Motion::Drive { length, .. } if *length < 0.0)
}

/// The limits along a path in one direction, on which the turning rate may step.
fn limits_of(limits: &RobotLimits, backwards: bool) -> RobotLimits {
    RobotLimits {
        v_max: if backwards {
            -limits.v_min
        } else {
            limits.v_max
        },
        angular_acceleration: None,
        ..*limits
    }
}

/// The points of motions in one direction, with the directions of travel, and the pose at the end.
fn points_of(run: &[Motion], start: Pose2, backwards: bool) -> (Vec<PathPoint>, Pose2) {
    let (sign, turned) = if backwards { (-1.0, PI) } else { (1.0, 0.0) };
    let mut pose = start;
    let mut points: Vec<PathPoint> = Vec::new();
    let mut s = 0.0;
    for motion in run {
        let Motion::Drive { length, kappa } = *motion else {
            continue;
        };
        let count = (length.abs() / path_points::spacing(kappa)).ceil().max(4.0);
        for i in 0..=count as u32 {
            let part = f64::from(i) / count;
            let at = Motion::Drive {
                length: part * length,
                kappa,
            }
            .end(&pose);
            points.push(PathPoint {
                s: s + part * length.abs(),
                at: at.position(),
                theta: at.theta + turned,
                kappa: sign * kappa,
            });
        }
        s += length.abs();
        pose = motion.end(&pose);
    }
    (points, pose)
}
