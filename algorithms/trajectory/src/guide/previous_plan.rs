//! Start from the plan that the robot has been following.

use nalgebra::Point2;

use crate::guide::Guide;
use crate::obstacle_field::ObstacleField;
use crate::path_points;
use crate::plan::{Plan, Sample};
use trajectory_problem::Problem;

/// Maximum distance (m) of start and goal from the old plan.
const NEAR: f64 = 0.05;
/// Maximum penetration (m) of obstacles by the old plan: with more, it may pass on the wrong side.
/// By as much it may be shorter than the shortest path: a shorter one leads through a gap that has
/// closed.
const MAX_PENETRATION: f64 = 0.03;
/// Maximum length of the rest, relative to the shortest path: a longer one takes another route.
const DETOUR: f64 = 1.03;

/// The rest of a plan, from the point where it passes the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Rest {
    /// The trajectory; its time begins at 0.
    pub samples: Vec<Sample>,
    /// Its path.
    pub guide: Guide,
}

/// The rest of a plan, if it still leads from the problem's start to its goal past the current
/// obstacles, and hardly farther than the shortest path of this length (m).
pub fn rest(
    problem: &Problem,
    obstacle_field: &ObstacleField,
    plan: &Plan,
    shortest: f64,
) -> Option<Rest> {
    let start = problem.start.position();
    let distance = |s: &Sample| (Point2::new(s.x, s.y) - start).norm();
    let (first, _) = plan
        .samples
        .iter()
        .enumerate()
        .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
    let begin = plan.samples.get(first)?.t;
    let samples: Vec<Sample> = plan.samples[first..]
        .iter()
        .map(|s| Sample {
            t: s.t - begin,
            ..*s
        })
        .collect();
    let end = samples.last()?;
    let misses = (Point2::new(end.x, end.y) - problem.goal).norm();
    let off = distance(samples.first()?);
    if off > NEAR || misses > NEAR {
        return None;
    }
    let points = path_points::of_samples(&samples);
    let depths = obstacle_field.depths(&points);
    if depths.iter().any(|(_, depth)| *depth > MAX_PENETRATION) {
        return None;
    }
    let corners: Vec<Point2<f64>> = points.iter().map(|p| p.at).collect();
    let guide = Guide::through(&corners)?;
    let is_blocked = off + guide.length() + misses < shortest - MAX_PENETRATION;
    if is_blocked || guide.length() > DETOUR * shortest {
        return None;
    }
    Some(Rest { samples, guide })
}
