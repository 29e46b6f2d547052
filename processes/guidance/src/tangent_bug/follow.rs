//! Following a boundary on one side, and when to leave it.

use nalgebra::Point2;

use super::run::{Run, Side};
use super::surroundings::{DIRECTIONS, Surroundings};
use super::trail::Trail;
use super::{Sight, TangentBugParams};

/// A stretch along one boundary.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Follow {
    side: Side,
    /// `d_followed` [m].
    least: f64,
    /// The point of the obstacle that was nearest at the last look [m].
    wall: Point2<f64>,
    trail: Trail,
}

/// How following goes on.
pub(super) enum Following {
    /// On towards a point along the boundary.
    Along(Point2<f64>),
    /// Away, to a point nearer to the goal.
    Leave(Point2<f64>),
    /// All around the boundary without leaving it.
    Closed,
    /// There is nothing but this boundary in sight.
    Enclosed,
    /// The boundary is not there any more.
    Lost,
}

impl Follow {
    /// Begins at a distance from the goal [m], at the obstacle with a point `wall` [m].
    pub(super) fn begin(side: Side, distance: f64, wall: Point2<f64>) -> Self {
        Self {
            side,
            least: distance,
            wall,
            trail: Trail::default(),
        }
    }

    /// The side on which the robot goes around.
    pub(super) fn side(&self) -> Side {
        self.side
    }

    /// `d_followed`: the least distance of this boundary from the goal so far [m].
    pub(super) fn least(&self) -> f64 {
        self.least
    }

    /// Takes in what is seen. `grown` is the radius obstacles are grown by [m].
    pub(super) fn step(
        &mut self,
        view: &Surroundings,
        sight: &Sight,
        params: &TangentBugParams,
        grown: f64,
    ) -> Following {
        let Some(run) = self.boundary(view, params, grown) else {
            return Following::Lost;
        };
        if let Some(wall) = view.obstacle(run.nearest(view)) {
            self.wall = wall;
        }
        for k in run.directions() {
            self.least = self.least.min((sight.goal - view.end(k)).norm());
        }
        if sight.is_reachable {
            return Following::Leave(sight.goal);
        }
        let (reach, point) = Self::reach(view, sight, &run);
        if reach < self.least - params.leave_margin {
            return Following::Leave(point);
        }
        let Some(end) = run.end(view, self.side) else {
            return Following::Enclosed;
        };
        if self.trail.closes(view.here, end.unit, grown) {
            return Following::Closed;
        }
        Following::Along(view.here + end.unit * end.free)
    }

    /// The piece of boundary that continues the one followed so far.
    fn boundary(&self, view: &Surroundings, params: &TangentBugParams, grown: f64) -> Option<Run> {
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
        if off > grown.max(view.reach) {
            return None;
        }
        Run::around(view, k, params.jump)
    }

    /// `d_reach` and its point: of the free points in sight beside the followed boundary, the one
    /// nearest to the goal [m].
    fn reach(view: &Surroundings, sight: &Sight, run: &Run) -> (f64, Point2<f64>) {
        let mut best = (f64::INFINITY, view.here);
        let mut consider = |unit: nalgebra::Vector2<f64>, free: f64| {
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
