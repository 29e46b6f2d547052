//! Changes of obstacles during a run.

use geometry::map::{ObstacleChange, ObstacleError};
use geometry::math;
use nalgebra::{Point2, Vector2};

use super::{EventKind, ObstacleAction, World, has_body};

/// Maximum distance (m) by which an obstacle pushes a robot aside, beyond the robot's own diameter.
const PUSH_LIMIT: f64 = 1.0;
/// Number of directions that are searched for a free place.
const DIRECTIONS: usize = 64;
/// Distance (m) from the obstacle after a push: more than a contact needs.
const ROOM: f64 = 1e-6;

impl World {
    /// Applies an obstacle change between two steps. The map's grids and revision are updated at
    /// once; the events are delivered by the next step, or by [`Self::take_pending`].
    ///
    /// A robot below the new obstacle is pushed to the nearest free place that is reachable in a
    /// straight line past the other obstacles, at most 1 m and its diameter away. If there is none
    /// it is *trapped*: it stays in the obstacle and can only turn, until the obstacle disappears.
    ///
    /// # Errors
    /// If the obstacle's number or shape is invalid; the world is then unchanged.
    pub fn apply(&mut self, change: &ObstacleChange) -> Result<(), ObstacleError> {
        self.map.apply(change)?;
        self.motion.forget();
        let action = match change {
            ObstacleChange::Appear { .. } => ObstacleAction::Appeared,
            ObstacleChange::Disappear { .. } => ObstacleAction::Disappeared,
            ObstacleChange::Move { .. } => ObstacleAction::Moved,
        };
        let (id, revision) = (change.id(), self.map.revision());
        self.pending.push(EventKind::ObstacleApplied {
            id,
            action,
            revision,
        });
        for i in 0..self.robots.len() {
            if !has_body(&self.robots[i], &self.rules) {
                continue;
            }
            let (position, radius) = (self.robots[i].pose.position(), self.robots[i].radius());
            let was_trapped = self.robots[i].trapped;
            // A robot that only touches keeps its place: contacts leave less than this.
            if self.map.is_clear(position, radius - 1e-7) {
                if was_trapped {
                    self.robots[i].trapped = false;
                    self.pending.push(EventKind::Released { robot: i });
                }
            } else if let Some((place, distance)) = self.free_place(i) {
                let robot = &mut self.robots[i];
                robot.pose.x = place.x;
                robot.pose.y = place.y;
                robot.trapped = false;
                self.pending
                    .push(EventKind::PushedOut { robot: i, distance });
            } else if !was_trapped {
                self.robots[i].trapped = true;
                self.pending.push(EventKind::Trapped { robot: i });
            }
        }
        if let Some(coverage) = &mut self.coverage {
            coverage.follow_map(&self.map, &self.robots);
        }
        Ok(())
    }

    /// The nearest free place for a robot, and its distance (m).
    fn free_place(&self, robot: usize) -> Option<(Point2<f64>, f64)> {
        let (start, radius) = (
            self.robots[robot].pose.position(),
            self.robots[robot].radius(),
        );
        let free = |p: Point2<f64>| {
            self.map.is_clear(p, radius + ROOM)
                && self.robots.iter().enumerate().all(|(i, other)| {
                    let needed = radius + other.radius() + ROOM;
                    i == robot
                        || !has_body(other, &self.rules)
                        || (other.pose.position() - p).norm_squared() >= needed * needed
                })
        };
        // The robot must not be pushed through pieces that do not overlap it now.
        let others: Vec<_> = self
            .map
            .parts()
            .iter()
            .filter(|part| part.distance(start) >= radius - 1e-7)
            .collect();
        let step = radius / 4.0;
        let rings = ((PUSH_LIMIT + 2.0 * radius) / step).ceil() as usize;
        for ring in 1..=rings {
            let far = ring as f64 * step;
            let mut best: Option<(Point2<f64>, f64)> = None;
            for k in 0..DIRECTIONS {
                let (sin, cos) =
                    math::sincos(core::f64::consts::TAU * k as f64 / DIRECTIONS as f64);
                let dir = Vector2::new(cos, sin);
                if !free(start + dir * far) {
                    continue;
                }
                // The nearest free place in this direction lies between the last ring and this one.
                let (mut low, mut high) = (far - step, far);
                for _ in 0..30 {
                    let middle = 0.5 * (low + high);
                    if free(start + dir * middle) {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                let crosses = others
                    .iter()
                    .any(|part| part.ray(start, dir).is_some_and(|t| t < high));
                if !crosses && best.is_none_or(|(_, least)| high < least) {
                    best = Some((start + dir * high, high));
                }
            }
            if best.is_some() {
                return best;
            }
        }
        None
    }
}
