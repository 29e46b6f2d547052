//! The border of the visible region under construction.

use core::f64::consts::PI;

use nalgebra::{Point2, Vector2};

use super::span::{Span, direction, from_begin};
use crate::math;

/// Maximum angle between two corners where the range limits the view (rad).
const ARC_STEP: f64 = 5.0 * PI / 180.0;
/// Square of the distance (m²) below which points are equal.
const SAME_PLACE: f64 = 1e-18;
/// Expected number of corners of a border.
const CORNERS: usize = 128;

/// The border of the visible region under construction.
pub struct View {
    place: Point2<f64>,
    begin: f64,
    range: f64,
    border: Vec<Point2<f64>>,
}

impl View {
    /// Creates an empty border at a position, with angles relative to `begin` (rad) and a range of
    /// `range` (m).
    pub(super) fn new(place: Point2<f64>, begin: f64, range: f64) -> Self {
        Self {
            place,
            begin,
            range,
            border: Vec::with_capacity(CORNERS),
        }
    }

    /// Returns the border; of a view all round, it ends before its start.
    pub(super) fn finish(self, all_round: bool) -> Vec<Point2<f64>> {
        let mut border = self.border;
        if all_round
            && let [first, .., last] = border.as_slice()
            && (first - last).norm_squared() < SAME_PLACE
        {
            border.pop();
        }
        border
    }

    /// Adds the visible part of a wall between two directions, or of the range before it.
    pub(super) fn add(&mut self, span: &Span, from: f64, to: f64) {
        let (first, last) = (
            span.part(direction(self.begin + from)),
            span.part(direction(self.begin + to)),
        );
        let point = |part: f64| span.from + span.along * part;
        if self.range == f64::INFINITY {
            self.put(point(first));
            self.put(point(last));
            return;
        }
        // The part of the wall's line within the range: |from + part × along| ≤ range.
        let (a, b) = (span.along.norm_squared(), span.from.dot(&span.along));
        let c = span.from.norm_squared() - self.range * self.range;
        let root = b * b - a * c;
        let half = root.max(0.0).sqrt();
        let (near, far) = (
            first.max((-b - half) / a).min(last),
            last.min((-b + half) / a).max(first),
        );
        if root <= 0.0 || near >= far {
            self.arc(from, to);
            return;
        }
        let angle = |part: f64| {
            let v = point(part);
            let relative = from_begin(math::atan2(v.y, v.x) - self.begin);
            // Rounding may move its ends to the other side of the start.
            if (from..=to).contains(&relative) {
                relative
            } else if part > f64::midpoint(first, last) {
                to
            } else {
                from
            }
        };
        let (in_range_from, in_range_to) = (angle(near), angle(far));
        if near > first {
            self.arc(from, in_range_from);
        }
        self.put(point(near));
        self.put(point(far));
        if far < last {
            self.arc(in_range_to, to);
        }
    }

    /// Adds an arc at the range.
    fn arc(&mut self, from: f64, to: f64) {
        let steps = ((to - from) / ARC_STEP).ceil().max(1.0) as u32;
        for step in 0..=steps {
            let angle = from + (to - from) * f64::from(step) / f64::from(steps);
            self.put(direction(self.begin + angle) * self.range);
        }
    }

    fn put(&mut self, offset: Vector2<f64>) {
        let point = self.place + offset;
        if self
            .border
            .last()
            .is_none_or(|last| (point - last).norm_squared() > SAME_PLACE)
        {
            self.border.push(point);
        }
    }
}
