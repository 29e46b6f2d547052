//! The remembered boundary: echoes of earlier scans.

use core::f64::consts::TAU;
use std::collections::BTreeMap;

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};

use planner_view::view::ScanView;

use super::surroundings::hits;

/// Distance between two recorded scans, in grown radii.
const APART: f64 = 0.25;
/// Distance by which a scan must see past a remembered echo to refute it, in grown radii.
const PAST: f64 = 0.25;
/// Side of the squares that hold one echo each, in grown radii.
const SQUARE: f64 = 0.125;

/// Echoes of earlier scans.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EchoMemory {
    /// At most one echo (m) per square of a fine lattice.
    echoes: BTreeMap<(i64, i64), Point2<f64>>,
    /// Position of the last recorded scan (m).
    recorded_at: Option<Point2<f64>>,
}

impl EchoMemory {
    /// Clears all echoes.
    pub(super) fn clear(&mut self) {
        self.echoes.clear();
        self.recorded_at = None;
    }

    /// The echoes (m), in a fixed order.
    pub(super) fn echoes(&self) -> impl Iterator<Item = Point2<f64>> {
        self.echoes.values().copied()
    }

    /// Returns `true` if the robot has left the place of the last recorded scan. `grown` is the radius by which
    /// obstacles are grown (m).
    pub(super) fn is_due(&self, here: Point2<f64>, grown: f64) -> bool {
        let beside = |at: Point2<f64>| (at - here).norm() < APART * grown;
        !self.recorded_at.is_some_and(beside)
    }

    /// Records a scan. Removes the echoes that it refutes: a body has left, or a fictive obstacle has
    /// disappeared. `grown` is the radius by which obstacles are grown (m).
    pub(super) fn record(&mut self, pose: &Pose2, scan: &ScanView<'_>, grown: f64) {
        let here = pose.position();
        self.recorded_at = Some(here);
        let pitch = SQUARE * grown;
        let row = |x: f64| (x / pitch).floor() as i64;
        let refuted = |at: Point2<f64>| {
            let distance = (at - here).norm();
            // Farther away an edge may lie between two beams.
            distance * scan.angle_increment.abs() <= PAST * grown
                && free_past(pose, scan, at - here) > distance + PAST * grown
        };
        let rows =
            (row(here.x - scan.range_max), i64::MIN)..=(row(here.x + scan.range_max), i64::MAX);
        let gone: Vec<_> = self
            .echoes
            .range(rows)
            .filter(|&(_, &at)| refuted(at))
            .map(|(&square, _)| square)
            .collect();
        for square in gone {
            self.echoes.remove(&square);
        }
        for echo in hits(pose, scan).flatten() {
            let at = here + echo;
            self.echoes.entry((row(at.x), row(at.y))).or_insert(at);
        }
    }
}

/// The smaller range of the two beams beside a direction (m); 0 where a beam is missing.
fn free_past(pose: &Pose2, scan: &ScanView<'_>, direction: Vector2<f64>) -> f64 {
    let circle = TAU / scan.angle_increment.abs();
    let bearing = math::atan2(direction.y, direction.x) - pose.theta - scan.angle_min;
    let at = (bearing / scan.angle_increment).rem_euclid(circle);
    if !at.is_finite() {
        return 0.0;
    }
    let beam = at as usize;
    // Behind the last beam of a full circle comes the first one.
    let next = if (beam + 1) as f64 > circle - 0.5 {
        0
    } else {
        beam + 1
    };
    let range = |beam: usize| {
        let range = scan.ranges.get(beam).map_or(0.0, |&range| f64::from(range));
        // Without an echo, and for NaN.
        if range <= scan.range_max {
            range
        } else {
            scan.range_max
        }
    };
    range(beam).min(range(next))
}
