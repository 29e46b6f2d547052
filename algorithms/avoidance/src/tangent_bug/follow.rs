//! Boundary following on one side, and the conditions for leaving the boundary.

use nalgebra::{Point2, Vector2};

use super::run::{Run, Side};
use super::surroundings::{DIRECTIONS, Surroundings};
use super::trail::Trail;
use super::{JUMP, LEAVE_MARGIN, Sight};

/// Fractions of the jump that are tried where only boundary is visible.
const FINER: [f64; 2] = [0.5, 0.25];

/// A stretch along one boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct Follow {
    side: Side,
    /// `d_followed` (m).
    least: f64,
    /// The nearest point of the obstacle in the last scan (m).
    wall: Point2<f64>,
    trail: Trail,
    /// Position at which an obstacle appeared on the path away from the boundary (m).
    returned_at: Option<Point2<f64>>,
}

/// Next step of following.
pub enum FollowStep {
    /// Continue towards a point along the boundary.
    Along(Point2<f64>),
    /// Leave, towards a point nearer to the goal.
    Leave(Point2<f64>),
    /// The robot has circled the boundary without leaving it.
    Closed,
    /// Only this boundary is visible: continue towards its farthest point.
    Enclosed(Point2<f64>),
    /// The boundary is no longer there.
    Lost,
}

impl Follow {
    /// Begins at a distance from the goal (m), at the obstacle with a point `wall` (m).
    pub(super) fn begin(side: Side, distance: f64, wall: Point2<f64>) -> Self {
        Self {
            side,
            least: distance,
            wall,
            trail: Trail::default(),
            returned_at: None,
        }
    }

    /// Continues along the boundary at a position where the path away from it turned out to be closed (m). The
    /// next scan from there may show it open again: beams miss edges.
    pub(super) fn return_at(&mut self, here: Point2<f64>) {
        self.returned_at = Some(here);
    }

    /// The side on which the robot goes around.
    pub(super) fn side(&self) -> Side {
        self.side
    }

    /// `d_followed`: the minimum distance of this boundary from the goal so far (m).
    pub(super) fn least(&self) -> f64 {
        self.least
    }

    /// Updates with a scan. `grown` is the radius by which obstacles are grown (m); `may_trust` is `true` if a
    /// visible goal is sufficient reason to leave.
    pub(super) fn step(
        &mut self,
        view: &Surroundings,
        sight: &Sight,
        grown: f64,
        may_trust: bool,
    ) -> FollowStep {
        let Some(at) = self.boundary(view, grown) else {
            return FollowStep::Lost;
        };
        // Where only boundary is visible, a smaller jump may hide the continuation.
        let Some(run) = Run::around(view, at, JUMP) else {
            return FollowStep::Lost;
        };
        let finer = || {
            FINER
                .iter()
                .find_map(|part| Run::around(view, at, part * JUMP)?.end(view, self.side))
        };
        let gap = run.end(view, self.side).or_else(finer);
        let run = match gap {
            Some(_) => run,
            None => run.parted_where_farthest(view),
        };
        if let Some(wall) = view.obstacle(run.nearest_beside(view, self.side)) {
            self.wall = wall;
        }
        for k in run.directions() {
            self.least = self.least.min((sight.goal - view.end(k)).norm());
        }
        if may_trust && sight.is_reachable {
            return FollowStep::Leave(sight.goal);
        }
        let (reach, point) = Self::reach(view, sight, &run);
        let has_just_returned = self
            .returned_at
            .is_some_and(|at| (at - view.here).norm() < grown);
        if reach < self.least - LEAVE_MARGIN && !has_just_returned {
            return FollowStep::Leave(point);
        }
        let Some(end) = gap else {
            let step = run
                .end(view, self.side)
                .map(|end| end.unit * view.free_towards(end.unit));
            return FollowStep::Enclosed(view.here + step.unwrap_or_default());
        };
        self.trail.add(view.here, end.unit, grown);
        if self.trail.is_closed(grown) {
            return FollowStep::Closed;
        }
        FollowStep::Along(view.here + end.unit * end.free)
    }

    /// A direction that ends at the followed boundary.
    fn boundary(&self, view: &Surroundings, grown: f64) -> Option<usize> {
        let mut best: Option<(usize, f64)> = None;
        for k in (0..DIRECTIONS).filter(|&k| view.is_blocked(k)) {
            let Some(obstacle) = view.obstacle(k) else {
                continue;
            };
            let off = (obstacle - self.wall).norm();
            if best.is_none_or(|(_, least)| off < least) {
                best = Some((k, off));
            }
        }
        let (k, off) = best?;
        (off <= grown.max(view.reach)).then_some(k)
    }

    /// `d_reach` and its point: of the visible free points beside the followed boundary, the one nearest to the
    /// goal (m).
    fn reach(view: &Surroundings, sight: &Sight, run: &Run) -> (f64, Point2<f64>) {
        let mut best = (f64::INFINITY, view.here);
        let mut consider = |unit: Vector2<f64>, free: f64| {
            let along = (sight.goal - view.here).dot(&unit).clamp(0.0, free);
            let point = view.here + unit * along;
            let distance = (sight.goal - point).norm();
            if distance < best.0 {
                best = (distance, point);
            }
        };
        for k in (0..DIRECTIONS).filter(|&k| !run.contains(k)) {
            consider(Surroundings::unit(k), view.free(k));
        }
        if sight.is_open {
            consider(sight.towards, sight.free);
        }
        best
    }
}
