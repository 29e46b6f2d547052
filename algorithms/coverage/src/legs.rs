//! Paths between sub-goals.
//!
//! After the Chebyshev coverage paper, §4 and Fig. 9. *Linear*: points at equal distances along the
//! straight legs; the robot stops at a sub-goal and turns. *Arc*: at each inflection point B an arc
//! replaces the corner, from E on the leg to it to F on the leg from it. The arc is tangent to both
//! legs, so that the robot need not stop.
//!
//! The radius of an arc is that of the robot's speed and turning rate (v/ω), less where a leg is
//! short: an arc takes at most half of either leg. The arc lies in the triangle EBF. It is allowed
//! only if one free rectangle contains the triangle: E, B and F in the rectangle of one of the two
//! legs, since rectangles are convex. Without room for an arc the robot turns on the spot.

use geometry::math;
use geometry::pose::Pose2;
use geometry::shape::Aabb;
use nalgebra::{Point2, Vector2};
use planner_view::free_space::Arc;
use thiserror::Error;

use crate::goal::Goal;

/// Subtracted from a number of parts before rounding up, so that integers stay unchanged.
const WHOLE_PARTS: f64 = 1e-12;

/// Legs shorter than this (m) have no direction, and turns by less than this (rad) are ignored.
const NOTHING: f64 = 1e-9;

/// Reason why corners cannot be rounded.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{field} = {value}: expected {expected}")]
pub struct RoundingError {
    /// Name of the invalid value.
    pub field: &'static str,
    /// Actual value.
    pub value: f64,
    /// Expected value.
    pub expected: &'static str,
}

/// Speed and turning rate of the robot, and limits of its arcs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    v: f64,
    omega: f64,
    max_miss: f64,
    least_radius: f64,
}

impl Rounding {
    /// Creates arcs for a robot that drives at `v` (m/s) and turns at `omega` (rad/s): of radius v/ω
    /// where there is room and the arc passes the corner by no more than `max_miss` (m) (at a sharp
    /// corner a wide arc passes far from it). Arcs smaller than `least_radius` (m) are omitted: the
    /// robot turns on the spot.
    ///
    /// # Errors
    /// [`RoundingError`] if a value is not finite or not positive (the least radius may be 0).
    pub fn new(
        v: f64,
        omega: f64,
        max_miss: f64,
        least_radius: f64,
    ) -> Result<Self, RoundingError> {
        let refuse = |field, value, expected| {
            Err(RoundingError {
                field,
                value,
                expected,
            })
        };
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !positive(v) {
            return refuse("v", v, "a finite number > 0 (m/s)");
        }
        if !positive(omega) {
            return refuse("omega", omega, "a finite number > 0 (rad/s)");
        }
        if !positive(max_miss) {
            return refuse("max_miss", max_miss, "a finite number > 0 (m)");
        }
        if !(positive(least_radius) || least_radius == 0.0) {
            return refuse("least_radius", least_radius, "a finite number ≥ 0 (m)");
        }
        Ok(Self {
            v,
            omega,
            max_miss,
            least_radius,
        })
    }

    /// Radius of the arcs that have room (m).
    pub fn radius(&self) -> f64 {
        self.v / self.omega
    }

    /// Maximum speed on a circle of this radius (m/s).
    pub fn speed_on(&self, radius: f64) -> f64 {
        self.v.min(self.omega * radius)
    }
}

/// An arc that replaces a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fillet {
    /// Point where it leaves the first leg, E (m).
    pub enter: Point2<f64>,
    /// Point where it joins the second leg, F (m).
    pub leave: Point2<f64>,
    /// The arc between them.
    pub arc: Arc,
}

/// The arc of at most `radius` (m), passing the corner by at most `max_miss` (m), that replaces
/// the corner at `b` on the path from `a` over `b` to `c` (m). The legs run in the rectangles
/// `first` and `second`. `None` if there is no corner or no room.
pub fn fillet(
    [a, b, c]: [Point2<f64>; 3],
    first: &Aabb,
    second: &Aabb,
    radius: f64,
    max_miss: f64,
) -> Option<Fillet> {
    let (arriving, leaving) = (b - a, c - b);
    let (before, after) = (arriving.norm(), leaving.norm());
    let legs = before > NOTHING && after > NOTHING;
    let (u, w) = (arriving / before, leaving / after);
    let turn = math::atan2(u.perp(&w), u.dot(&w));
    if !legs || !turn.is_finite() || turn.abs() < NOTHING {
        return None;
    }
    // Room for the triangle: F in the first leg's rectangle or E in the second one's.
    let room = run_within(first, b, w).max(run_within(second, b, -u));
    let half_turn = math::tan(0.5 * turn.abs());
    // The arc passes B by radius · (1/cos(turn/2) − 1).
    let miss = 1.0 / math::cos(0.5 * turn.abs()) - 1.0;
    let radius = radius.min(max_miss / miss.max(0.0));
    let tangent = (radius * half_turn).min(0.5 * before.min(after)).min(room);
    let radius = tangent / half_turn;
    let usable = tangent > 0.0 && radius > 0.0;
    if !usable {
        return None;
    }
    let enter = b - u * tangent;
    let leave = b + w * tangent;
    let left = Vector2::new(-u.y, u.x) * turn.signum();
    let center = enter + left * radius;
    let arc = Arc {
        center,
        radius,
        start: math::atan2(-left.y, -left.x),
        sweep: turn,
    };
    Some(Fillet { enter, leave, arc })
}

/// Distance (m) from `p` to the border of a rectangle along a unit vector; 0 from outside it.
fn run_within(rectangle: &Aabb, p: Point2<f64>, direction: Vector2<f64>) -> f64 {
    if !rectangle.contains(p) {
        return 0.0;
    }
    let along = |axis: usize| {
        let d = direction[axis];
        if d > 0.0 {
            (rectangle.max[axis] - p[axis]) / d
        } else if d < 0.0 {
            (rectangle.min[axis] - p[axis]) / d
        } else {
            f64::INFINITY
        }
    };
    along(0).min(along(1))
}

/// A piece of a drivable path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece {
    /// A straight line.
    Straight {
        /// Start (m).
        from: Point2<f64>,
        /// End (m).
        to: Point2<f64>,
    },
    /// An arc.
    Arc(Arc),
    /// A turn on the spot.
    Turn {
        /// Position (m).
        at: Point2<f64>,
        /// Initial heading (rad).
        from: f64,
        /// Angle (rad), counter-clockwise if positive.
        by: f64,
    },
}

impl Piece {
    /// Length (m).
    pub fn length(&self) -> f64 {
        match self {
            Self::Straight { from, to } => (to - from).norm(),
            Self::Arc(arc) => arc.length(),
            Self::Turn { .. } => 0.0,
        }
    }

    /// Duration at full speed (s).
    pub fn duration(&self, rounding: &Rounding) -> f64 {
        match self {
            Self::Straight { .. } => self.length() / rounding.v,
            Self::Arc(arc) => self.length() / rounding.speed_on(arc.radius),
            Self::Turn { by, .. } => by.abs() / rounding.omega,
        }
    }

    /// Curvature (1/m), positive to the left; 0 for a turn on the spot.
    pub fn curvature(&self) -> f64 {
        match self {
            Self::Arc(arc) => arc.sweep.signum() / arc.radius,
            Self::Straight { .. } | Self::Turn { .. } => 0.0,
        }
    }

    /// The pose at a fraction of the piece, 0 at the start and 1 at the end.
    pub fn at(&self, part: f64) -> Pose2 {
        let pose = |p: Point2<f64>, heading: f64| Pose2::new(p.x, p.y, math::wrap_angle(heading));
        match self {
            Self::Straight { from, to } => {
                let line = to - from;
                pose(from + line * part, math::atan2(line.y, line.x))
            }
            Self::Arc(arc) => {
                let heading = arc.heading(part);
                pose(arc.at(part), math::atan2(heading.y, heading.x))
            }
            Self::Turn { at, from, by } => pose(*at, from + by * part),
        }
    }

    /// Poses along the piece, without the start and with the end, at most `step` (m) apart (a turn:
    /// its end).
    pub fn poses(&self, step: f64) -> impl Iterator<Item = Pose2> + use<> {
        let parts = (self.length() / step - WHOLE_PARTS).ceil();
        let parts = if parts.is_finite() && parts > 1.0 {
            parts as u32
        } else {
            1
        };
        let piece = *self;
        (1..=parts).map(move |part| piece.at(f64::from(part) / f64::from(parts)))
    }
}

/// Joins sub-goals to a drivable path, piece by piece.
///
/// A corner can be rounded when the goal behind it is known: pieces are one goal late, up to the
/// beginning of the arc at the last but one goal; [`Rounder::finish`] gives the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Rounder {
    rounding: Rounding,
    /// End of the pieces so far (m), and the heading there (rad), once there is one.
    from: Point2<f64>,
    heading: Option<f64>,
    /// The pending leg: its start (corner, not arc), its end, and its rectangle.
    leg: Option<(Point2<f64>, Point2<f64>, Option<Aabb>)>,
}

impl Rounder {
    /// Starts a path at `start` (m); with a heading (rad) if the robot must turn towards the first
    /// goal.
    pub fn new(rounding: Rounding, start: Point2<f64>, heading: Option<f64>) -> Self {
        Self {
            rounding,
            from: start,
            heading,
            leg: None,
        }
    }

    /// Takes the next sub-goal; appends the part of the path that is certain to `out`.
    pub fn push(&mut self, goal: &Goal, out: &mut Vec<Piece>) {
        let to = goal.waypoint.point;
        let Some((a, b, within)) = self.leg else {
            self.leg = Some((self.from, to, goal.within));
            return;
        };
        let corner = within
            .zip(goal.within)
            .and_then(|(first, second)| {
                let radius = self.rounding.radius();
                fillet([a, b, to], &first, &second, radius, self.rounding.max_miss)
            })
            .filter(|fillet| fillet.arc.radius >= self.rounding.least_radius);
        if let Some(corner) = corner {
            self.straight(corner.enter, out);
            out.push(Piece::Arc(corner.arc));
            self.from = corner.leave;
            let heading = corner.arc.heading(1.0);
            self.heading = Some(math::atan2(heading.y, heading.x));
        } else {
            self.straight(b, out);
        }
        self.leg = Some((b, to, goal.within));
    }

    /// Appends the path to the last sub-goal; the next goal begins a new path there.
    pub fn finish(&mut self, out: &mut Vec<Piece>) {
        if let Some((_, to, _)) = self.leg.take() {
            self.straight(to, out);
        }
    }

    /// Appends a straight line to a point, after a turn on the spot if necessary.
    fn straight(&mut self, to: Point2<f64>, out: &mut Vec<Piece>) {
        let line = to - self.from;
        if line.norm() > NOTHING {
            let heading = math::atan2(line.y, line.x);
            let by = self
                .heading
                .map_or(0.0, |before| math::angle_difference(heading, before));
            // A difference from rounding at the end of an arc is not a turn.
            if by.abs() > 1e-6 {
                out.push(Piece::Turn {
                    at: self.from,
                    from: heading - by,
                    by,
                });
            }
            out.push(Piece::Straight {
                from: self.from,
                to,
            });
            self.heading = Some(heading);
        }
        self.from = to;
    }
}

#[cfg(test)]
mod tests;
