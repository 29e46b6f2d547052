//! Route of a patrol: waypoints, open or closed.

use metrics::path::Polyline;
use nalgebra::{Point2, Vector2};
use thiserror::Error;

/// Waypoints of a patrol and the straight segments between them.
///
/// A *closed* contour ends at its start, and all laps have the same direction. An *open* one is driven there
/// and back: a lap is one direction, and every other lap is reversed, because a robot cannot jump from the end
/// of its route to the beginning.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    points: Vec<Point2<f64>>,
    segments: Vec<Segment>,
    closed: bool,
}

/// The straight line from one waypoint of a contour to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Start (m).
    pub from: Point2<f64>,
    /// End (m).
    pub to: Point2<f64>,
    /// Unit vector from start to end.
    pub along: Vector2<f64>,
    /// Length (m), > 0.
    pub length: f64,
}

impl Segment {
    /// The segment between two different points; `None` if they are the same or not finite, or so far apart
    /// that their distance is not finite.
    pub fn between(from: Point2<f64>, to: Point2<f64>) -> Option<Self> {
        let offset = to - from;
        let length = offset.norm();
        (length > 0.0 && length.is_finite()).then(|| Self {
            from,
            to,
            along: offset / length,
            length,
        })
    }

    /// The same segment, reversed.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            from: self.to,
            to: self.from,
            along: -self.along,
            length: self.length,
        }
    }
}

/// Reason why waypoints are not a valid contour.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ContourError {
    /// Too few waypoints.
    #[error(
        "`contour` has {count} waypoint(s): expected at least 2 different ones; add the points of \
         the route"
    )]
    TooFew {
        /// Number of different ones.
        count: usize,
    },
    /// A coordinate that is not a number.
    #[error("`contour[{index}]` is ({x}, {y}): expected two finite numbers (m)")]
    NotFinite {
        /// Index of the waypoint.
        index: usize,
        /// x (m).
        x: f64,
        /// y (m).
        y: f64,
    },
    /// Two consecutive waypoints at the same position.
    #[error(
        "`contour[{index}]` is ({x}, {y}), the same as the waypoint before it: \
         remove one of the two"
    )]
    Repeated {
        /// Index of the second of the two.
        index: usize,
        /// x (m).
        x: f64,
        /// y (m).
        y: f64,
    },
    /// Two consecutive waypoints whose distance is not finite.
    #[error(
        "`contour[{index}]` is ({x}, {y}), too far from the waypoint before it to compute the \
         distance: give coordinates in metres"
    )]
    TooFar {
        /// Index of the second of the two.
        index: usize,
        /// x (m).
        x: f64,
        /// y (m).
        y: f64,
    },
}

impl Contour {
    /// A contour that is driven there and back.
    ///
    /// # Errors
    /// [`ContourError`] for fewer than two waypoints, a coordinate that is not finite, or a waypoint at the
    /// position of the previous one.
    pub fn open(points: &[Point2<f64>]) -> Result<Self, ContourError> {
        Self::new(points.to_vec(), false)
    }

    /// A contour that ends at its start; the first waypoint may be repeated at the end (as in the paper, `P_N =
    /// P_1`) or not.
    ///
    /// # Errors
    /// [`ContourError`] as for [`Contour::open`].
    pub fn closed(points: &[Point2<f64>]) -> Result<Self, ContourError> {
        let mut points = points.to_vec();
        if let (Some(&first), Some(&last), true) = (points.first(), points.last(), points.len() > 1)
            && first != last
        {
            points.push(first);
        }
        Self::new(points, true)
    }

    fn new(points: Vec<Point2<f64>>, closed: bool) -> Result<Self, ContourError> {
        for (index, p) in points.iter().enumerate() {
            if !(p.x.is_finite() && p.y.is_finite()) {
                let (x, y) = (p.x, p.y);
                return Err(ContourError::NotFinite { index, x, y });
            }
        }
        if points.len() < 2 {
            return Err(ContourError::TooFew {
                count: points.len(),
            });
        }
        let mut segments = Vec::with_capacity(points.len() - 1);
        for (index, pair) in points.windows(2).enumerate() {
            let Some(segment) = Segment::between(pair[0], pair[1]) else {
                let (index, x, y) = (index + 1, pair[1].x, pair[1].y);
                return Err(if (pair[1] - pair[0]).norm() == 0.0 {
                    ContourError::Repeated { index, x, y }
                } else {
                    ContourError::TooFar { index, x, y }
                });
            };
            segments.push(segment);
        }
        Ok(Self {
            points,
            segments,
            closed,
        })
    }

    /// The waypoints P₁ … Pₙ (m); of a closed contour the last is the first again.
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The segments between the waypoints, in order; at least one.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Returns `true` if the contour ends at its start.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Length of a lap along it (m), > 0.
    pub fn length(&self) -> f64 {
        self.segments.iter().map(|s| s.length).sum()
    }

    /// The point S(share) that divides its length in this ratio; shares outside 0 … 1 give its ends (m); `None`
    /// for NaN.
    pub fn at(&self, share: f64) -> Option<Point2<f64>> {
        Polyline::new(&self.points).at(share)
    }

    /// Returns `true` if this lap goes from the last waypoint to the first: every other one of an open contour.
    pub fn is_reversed_in(&self, lap: u32) -> bool {
        !self.closed && lap % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(list: &[(f64, f64)]) -> Vec<Point2<f64>> {
        list.iter().map(|&(x, y)| Point2::new(x, y)).collect()
    }

    #[test]
    fn a_closed_contour_ends_where_it_began_however_it_is_written() {
        let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)];
        let short = Contour::closed(&points(&corners)).unwrap();
        let mut long = points(&corners);
        long.push(long[0]);
        assert_eq!(short, Contour::closed(&long).unwrap());
        assert_eq!(short.points().len(), 4);
        assert_eq!(short.length(), 12.0);
        assert_eq!(short.at(0.5).unwrap(), Point2::new(4.0, 2.0));
        assert_eq!(short.at(1.0).unwrap(), short.at(0.0).unwrap());
        assert!(!short.is_reversed_in(1));
    }

    #[test]
    fn an_open_contour_is_walked_back_every_other_lap() {
        let open = Contour::open(&points(&[(0.0, 0.0), (4.0, 0.0)])).unwrap();
        assert_eq!(open.length(), 4.0);
        assert!(!open.is_reversed_in(0) && open.is_reversed_in(1) && !open.is_reversed_in(2));
        let back = open.segments()[0].reversed();
        assert_eq!((back.from, back.to), (open.points()[1], open.points()[0]));
        assert_eq!(back.along, -open.segments()[0].along);
    }

    #[test]
    fn too_few_waypoints_are_refused() {
        for list in [&[][..], &[(1.0, 1.0)][..]] {
            let count = list.len();
            for made in [Contour::open(&points(list)), Contour::closed(&points(list))] {
                assert_eq!(made.unwrap_err(), ContourError::TooFew { count });
            }
        }
    }

    #[test]
    fn a_repeated_waypoint_is_named_by_its_index() {
        let error = Contour::closed(&points(&[(0.0, 0.0), (1.0, 2.0), (1.0, 2.0)])).unwrap_err();
        assert_eq!(
            error.to_string(),
            "`contour[2]` is (1, 2), the same as the waypoint before it: remove one of the two"
        );
        let twice = points(&[(1.0, 1.0), (1.0, 1.0)]);
        assert!(matches!(
            Contour::closed(&twice).unwrap_err(),
            ContourError::Repeated { index: 1, .. }
        ));
    }

    #[test]
    fn coordinates_that_are_not_finite_are_named() {
        let error = Contour::open(&points(&[(0.0, 0.0), (f64::NAN, 1.0)])).unwrap_err();
        assert!(error.to_string().starts_with("`contour[1]` is (NaN, 1)"));
        let error = Contour::open(&points(&[(-1e308, 0.0), (1e308, 1.0)])).unwrap_err();
        assert!(matches!(error, ContourError::TooFar { index: 1, .. }));
    }
}
