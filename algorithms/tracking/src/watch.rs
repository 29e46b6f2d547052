//! Observers of a tick, with the limits of their sensors.

use geometry::math;
use geometry::pose::Pose2;
use geometry::visibility::{RayEnd, VisibilityField};
use nalgebra::{Point2, Vector2};

use crate::params::SensorParams;

/// One observer: a place in free space and the coverage of its sensor.
#[derive(Debug, Clone)]
struct Viewpoint {
    index: usize,
    end: RayEnd,
    position: Point2<f64>,
    forward: Vector2<f64>,
}

/// The observers of one tick. They share their views: the visibility of a point is the best one
/// over all of them (chasing-game paper, section III.C).
#[derive(Debug, Clone)]
pub struct Watch {
    viewpoints: Vec<Viewpoint>,
    range_squared: f64,
    /// Cosine of half the field of view.
    cone: f64,
    limited: bool,
}

impl Watch {
    /// Creates an empty set of observers with the limits of a sensor.
    pub fn new(sensor: &SensorParams) -> Self {
        let range = sensor.range.unwrap_or(f64::INFINITY);
        let cone = sensor
            .field_of_view
            .map_or(-1.0, |angle| math::cos(0.5 * angle));
        Self {
            viewpoints: Vec::new(),
            range_squared: range * range,
            cone,
            limited: sensor.range.is_some() || cone > -1.0,
        }
    }

    /// Sets the observers' poses. An observer outside free space sees nothing.
    pub fn set(&mut self, field: &VisibilityField, observers: &[Pose2]) {
        self.viewpoints.clear();
        for (index, pose) in observers.iter().enumerate() {
            if let Some(end) = field.end(pose.position()) {
                let (position, forward) = (pose.position(), pose.forward());
                self.viewpoints.push(Viewpoint {
                    index,
                    end,
                    position,
                    forward,
                });
            }
        }
    }

    /// The largest visibility of a point (m) over all observers, 0…1, and the index of that
    /// observer (the first of equals); `None` if no observer sees the point.
    pub fn best(&self, field: &VisibilityField, p: Point2<f64>) -> Option<(f64, usize)> {
        let mut best: Option<(f64, usize)> = None;
        for viewpoint in self
            .viewpoints
            .iter()
            .filter(|viewpoint| self.covers(viewpoint, p))
        {
            let v = field.visibility(viewpoint.position, p);
            if v > best.map_or(0.0, |(v, _)| v) {
                best = Some((v, viewpoint.index));
            }
        }
        best
    }

    /// The largest visibility of a prepared ray end, 0…1, in single precision.
    #[inline]
    pub(crate) fn visibility(&self, field: &VisibilityField, p: Point2<f64>, end: RayEnd) -> f32 {
        let mut best = 0.0_f32;
        for viewpoint in &self.viewpoints {
            if !self.limited || self.covers(viewpoint, p) {
                best = best.max(field.between(viewpoint.end, end));
            }
        }
        best
    }

    /// Returns `true` if a point lies within an observer's range and field of view.
    fn covers(&self, viewpoint: &Viewpoint, p: Point2<f64>) -> bool {
        let offset = p - viewpoint.position;
        let distance_squared = offset.norm_squared();
        distance_squared <= self.range_squared
            && (self.cone <= -1.0
                || viewpoint.forward.dot(&offset) >= self.cone * distance_squared.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Space;
    use crate::space::tests::room;

    #[test]
    fn the_best_observer_counts_and_is_named() {
        let space = Space::new(&room());
        let mut watch = Watch::new(&SensorParams::default());
        // Behind the block, in a wall, in view, in view but farther.
        let observers = [
            Pose2::new(-2.0, 0.0, 0.0),
            Pose2::new(3.9, 2.9, 0.0),
            Pose2::new(2.0, 1.5, 0.0),
            Pose2::new(2.0, 2.5, 0.0),
        ];
        watch.set(space.field(), &observers);
        let target = Point2::new(2.0, 0.0);
        let (v, who) = watch.best(space.field(), target).unwrap();
        assert_eq!(who, 2);
        assert_eq!(v, space.field().visibility(observers[2].position(), target));
        watch.set(space.field(), &observers[..2]);
        assert_eq!(watch.best(space.field(), target), None);
    }

    #[test]
    fn range_and_field_of_view_limit_what_is_seen() {
        let space = Space::new(&room());
        let seen = |sensor: &SensorParams, observer: Pose2, p: Point2<f64>| {
            let mut watch = Watch::new(sensor);
            watch.set(space.field(), &[observer]);
            let end = space.field().end(p).unwrap();
            let (single, double) = (
                watch.visibility(space.field(), p, end),
                watch.best(space.field(), p),
            );
            assert_eq!(single > 0.0, double.is_some());
            double.is_some()
        };
        let viewpoint = Pose2::new(-3.0, 2.0, 0.0);
        let near = SensorParams {
            range: Some(2.0),
            ..SensorParams::default()
        };
        assert!(seen(&near, viewpoint, Point2::new(-1.1, 2.0)));
        assert!(!seen(&near, viewpoint, Point2::new(-0.9, 2.0)));
        let cone = SensorParams {
            field_of_view: Some(1.0),
            ..SensorParams::default()
        };
        assert!(seen(&cone, viewpoint, Point2::new(0.0, 2.0 + 3.0 * 0.25)));
        assert!(seen(&cone, viewpoint, Point2::new(0.0, 2.0 - 3.0 * 0.25)));
        assert!(!seen(&cone, viewpoint, Point2::new(-3.2, 2.0)));
        assert!(!seen(&cone, viewpoint, Point2::new(-2.5, 1.0)));
        let wide = SensorParams {
            field_of_view: Some(6.0),
            ..SensorParams::default()
        };
        assert!(seen(&wide, viewpoint, Point2::new(-3.2, 2.05)));
        assert!(!seen(&wide, viewpoint, Point2::new(-3.2, 2.0)));
    }
}
