//! Where a robot has been along a boundary, to notice that it has been all around.

use nalgebra::{Point2, Vector2};

/// Longest trail kept; at 5 cm per mark 3 km of boundary.
const MAX_MARKS: usize = 1 << 16;

#[derive(Debug, Clone, Copy, PartialEq)]
struct Mark {
    at: Point2<f64>,
    heading: Vector2<f64>,
    /// Way driven up to here (m).
    along: f64,
}

/// Marks along a followed boundary.
///
/// That a robot comes back to a single point says little: it may be the other side of a thin wall,
/// and the point where it met the boundary need not lie on its way around. The loop is closed once
/// the robot drives along its own trail, in the same direction, for a while.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Trail {
    marks: Vec<Mark>,
    /// Way driven (m).
    along: f64,
    last: Option<Point2<f64>>,
    /// Where on the way the robot began to drive along its trail (m).
    since: Option<f64>,
}

impl Trail {
    /// Takes in the next position and direction of travel (a unit vector); whether the loop is
    /// closed. `radius` is the robot's with its margin (m).
    pub(super) fn closes(&mut self, at: Point2<f64>, heading: Vector2<f64>, radius: f64) -> bool {
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
            return false;
        }
        if self.marks.len() >= MAX_MARKS {
            return true;
        }
        // The way around the smallest obstacle is 2π radii.
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
        if !again {
            self.since = None;
            return false;
        }
        self.along - *self.since.get_or_insert(self.along) >= 2.5 * radius
    }
}
