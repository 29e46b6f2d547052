//! The trail of a robot along a boundary, to detect a closed loop.

use nalgebra::{Point2, Vector2};

/// Maximum number of marks of a trail; at 5 cm per mark 3 km of boundary.
const MAX_MARKS: usize = 1 << 16;

#[derive(Debug, Clone, Copy, PartialEq)]
struct Mark {
    at: Point2<f64>,
    heading: Vector2<f64>,
    /// Distance driven up to here (m).
    along: f64,
}

/// Marks along a followed boundary.
///
/// A return to a single point proves little: it may be the other side of a thin wall, and the point
/// of first contact need not lie on the loop. The loop is closed once the robot drives along its
/// own trail, in the same direction, for some distance.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trail {
    marks: Vec<Mark>,
    /// Distance driven (m).
    along: f64,
    last: Option<Point2<f64>>,
    /// Distance at which the robot began to drive along its trail (m).
    since: Option<f64>,
    /// Distance driven along the trail, in all (m).
    again: f64,
}

impl Trail {
    /// Adds the next position and direction of travel (a unit vector); `radius` is the robot's with its margin
    /// (m).
    pub(super) fn add(&mut self, at: Point2<f64>, heading: Vector2<f64>, radius: f64) {
        let pitch = 0.05_f64.min(0.4 * radius);
        if let Some(last) = self.last {
            self.along += (at - last).norm();
        }
        self.last = Some(at);
        let since_mark = self
            .marks
            .last()
            .map_or(f64::INFINITY, |mark| self.along - mark.along);
        if since_mark < pitch {
            return;
        }
        if self.marks.len() >= MAX_MARKS {
            self.again = f64::INFINITY;
            self.since.get_or_insert(self.along);
            return;
        }
        // The path around the smallest obstacle is 2π radii long.
        let old = self.along - 3.0 * radius;
        let again = self
            .marks
            .iter()
            .take_while(|mark| mark.along <= old)
            .any(|mark| (mark.at - at).norm() < 0.5 * radius && mark.heading.dot(&heading) > 0.5);
        self.marks.push(Mark {
            at,
            heading,
            along: self.along,
        });
        if again {
            self.again += if self.since.is_some() {
                since_mark
            } else {
                0.0
            };
            self.since.get_or_insert(self.along);
        } else {
            self.since = None;
        }
    }

    /// Distance driven along the own trail, in all (m).
    pub(super) fn again(&self) -> f64 {
        self.again
    }

    /// Returns `true` if the loop is closed. `radius` is the robot's with its margin (m).
    pub(super) fn is_closed(&self, radius: f64) -> bool {
        let (Some(since), Some(last)) = (self.since, self.marks.last()) else {
            return false;
        };
        self.marks.len() >= MAX_MARKS || last.along - since >= 2.5 * radius
    }
}
