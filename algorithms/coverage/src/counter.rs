//! Numbers of sub-goals.

use geometry::shape::Aabb;
use nalgebra::Point2;
use planner_view::waypoint::{Waypoint, WaypointKind};

use crate::goal::Goal;

/// Numbers sub-goals through a run, and counts rounds.
#[derive(Debug, Clone, Default)]
pub struct Counter {
    next: u64,
    round: u32,
}

impl Counter {
    pub(crate) fn begin_round(&mut self) {
        self.round = self.round.saturating_add(1);
    }

    pub(crate) fn round(&self) -> u32 {
        self.round
    }

    pub(crate) fn goal(
        &mut self,
        kind: WaypointKind,
        point: Point2<f64>,
        within: Option<Aabb>,
    ) -> Goal {
        let number = self.next;
        self.next += 1;
        let waypoint = Waypoint {
            number,
            lap: self.round,
            kind,
            point,
        };
        Goal { waypoint, within }
    }
}
