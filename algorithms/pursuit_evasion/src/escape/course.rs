//! A path to an exit and its follower.

use geometry::pose::Pose2;
use nalgebra::Point2;
use navigation::dominance::Arena;
use navigation::wavefront::Wave;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;

use super::Robot;
use control::path_tracking::{Path, PathTracker, Tracking, TrackingParams};

/// Distance that paths keep from obstacles beyond the robot's radius (m): more than the follower cuts
/// off a corner.
const MARGIN: f64 = 0.1;

/// A path to an exit, and how far it is driven.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    tracker: PathTracker,
    radius: f64,
}

impl Course {
    /// A course to a node of an exit along a wave from the robot; `None` if the wave does not reach it.
    pub(super) fn to_exit(
        map: &PlannerMap,
        arena: &Arena,
        wave: &Wave,
        exit: usize,
        node: usize,
        robot: &Robot,
    ) -> Option<Self> {
        let radius = robot.model.radius;
        let mut corners = Vec::new();
        wave.path_to(arena.medium(), node, &mut corners);
        let last = corners.pop()?;
        for corner in &mut corners {
            *corner = off_obstacles(map, *corner, radius + MARGIN);
        }
        corners.insert(0, robot.pose.position());
        corners.push(last);
        // An exit that is smaller than a cell.
        let region = arena.exit(exit)?;
        corners.extend((!region.contains(last)).then(|| region.center()));
        let mut tracker = PathTracker::default();
        tracker.set_path(Path::new(straightened(map, arena, wave, &corners, radius)));
        Some(Self { tracker, radius })
    }

    /// The corners of the path (m).
    pub fn points(&self) -> &[Point2<f64>] {
        self.tracker.path().points()
    }

    /// Length of the path that is left (m).
    pub(super) fn left(&self) -> f64 {
        self.tracker.path().length() - self.tracker.progress()
    }

    /// The command of this tick; `None` for a pose that is not finite.
    pub fn follow(&mut self, map: &PlannerMap, pose: &Pose2, limits: &Limits) -> Option<Tracking> {
        let params = TrackingParams {
            look_ahead: 0.1,
            look_ahead_time_s: 0.1,
            ..TrackingParams::default()
        };
        // A short cut may use half of the margin.
        let room = map.clearance(pose.position());
        let radius = room.min(self.radius + 0.5 * MARGIN);
        self.tracker.track(pose, limits, &params, |pose, to| {
            map.line_is_clear(pose.position(), to, radius)
        })
    }
}

/// The point, moved away from the nearest obstacle to this clearance (m) where there is room.
fn off_obstacles(map: &PlannerMap, p: Point2<f64>, clearance: f64) -> Point2<f64> {
    let short = clearance - map.clearance(p);
    let moved = map
        .away_from_obstacles(p)
        .filter(|_| short > 0.0)
        .map_or(p, |away| p + away * short);
    if map.clearance(moved) > map.clearance(p) {
        moved
    } else {
        p
    }
}

/// The corners without those that a straight line through places of the wave can leave out.
fn straightened(
    map: &PlannerMap,
    arena: &Arena,
    wave: &Wave,
    corners: &[Point2<f64>],
    radius: f64,
) -> Vec<Point2<f64>> {
    let lattice = arena.lattice();
    let is_free = |from: Point2<f64>, to: Point2<f64>| {
        let room = map.clearance(from).min(map.clearance(to));
        let line = to - from;
        let steps = (line.norm() / lattice.pitch()).ceil().max(1.0);
        let reached = |step: u32| {
            let node = lattice.node_at(from + line * (f64::from(step) / steps));
            node.is_none_or(|node| wave.time(node).is_finite())
        };
        map.line_is_clear(from, to, room.min(radius + MARGIN)) && (1..steps as u32).all(reached)
    };
    let mut kept = Vec::new();
    let mut at = 0;
    while let Some(&from) = corners.get(at) {
        kept.push(from);
        let mut next = corners.len() - 1;
        while next > at + 1 && !corners.get(next).is_some_and(|&to| is_free(from, to)) {
            next -= 1;
        }
        at = next.max(at + 1);
    }
    kept
}
