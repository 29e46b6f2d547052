//! Direction and distance to a point.
//!
//! Attraction and repulsion are sums over bearings. Straight bearings pass through walls, as in the
//! paper. Geodesic bearings follow the streets: "towards" is the direction to drive in, and "away"
//! leads away from the corner where a pursuer would appear.

use nalgebra::{Point2, Vector2};

use crate::routes::Routes;

parameters::choice! {
    /// Measure of directions and distances to goals and other robots.
    pub enum GoalField {
        /// Straight through obstacles, as in the chasing-game paper. Cheap, but a goal behind a block
        /// has a local minimum in front of the block, in which a robot stays forever.
        Straight,
        /// Along the shortest drivable path. The goal's field has no local minimum; the cost is one
        /// shortest-path tree whenever the robot enters another cell of a coarse grid.
        ///
        /// The default, because in a city almost every goal is behind a block. Of 60 starts spread over
        /// the streets of the paper's city, all lead to the goal with this measure. Straight, 7 starts
        /// of a pursuer and (with the paper's parameters) 14 of an evader end in front of a block. The
        /// tests `closing_in` of `pursuer` and `escape` of `steering` print these numbers.
        #[default]
        Geodesic,
    }
}

/// Direction and distance from one point to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bearing {
    /// Unit vector of the initial direction of travel.
    pub direction: Vector2<f64>,
    /// Distance to travel (m).
    pub distance: f64,
    /// The point that `direction` points at (m): the destination or the first corner before it.
    pub waypoint: Point2<f64>,
}

/// Distances below this (m) have no direction.
const NO_DISTANCE: f64 = 1.0e-3;

/// Measure of bearings from the robot to points of the world.
#[derive(Debug, Clone, Copy)]
pub enum Bearings<'a> {
    /// Straight lines.
    Straight,
    /// Along the shortest paths from the robot's position.
    Along(Routes<'a>),
}

impl Bearings<'_> {
    /// The bearing of `to` from `from` (m); `None` when they are closer than 1 mm or not finite.
    ///
    /// The bearing of a point that no path reaches is straight.
    pub fn bearing(&self, from: Point2<f64>, to: Point2<f64>) -> Option<Bearing> {
        match self {
            Self::Straight => straight(from, to),
            Self::Along(routes) => match routes.leg_to(to) {
                Some(leg) => {
                    let first = straight(from, leg.waypoint)?;
                    Some(Bearing {
                        distance: first.distance + leg.beyond,
                        ..first
                    })
                }
                None => straight(from, to),
            },
        }
    }
}

fn straight(from: Point2<f64>, to: Point2<f64>) -> Option<Bearing> {
    let line = to - from;
    let distance = line.norm();
    (distance.is_finite() && distance >= NO_DISTANCE).then(|| Bearing {
        direction: line / distance,
        distance,
        waypoint: to,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_bearings_are_unit_vectors_with_the_distance() {
        let bearing = Bearings::Straight
            .bearing(Point2::new(1.0, 1.0), Point2::new(4.0, 5.0))
            .unwrap();
        assert_eq!(bearing.distance, 5.0);
        assert_eq!(bearing.direction, Vector2::new(0.6, 0.8));
    }

    #[test]
    fn a_point_at_the_robot_or_at_infinity_has_no_bearing() {
        let here = Point2::new(1.0, 1.0);
        assert!(Bearings::Straight.bearing(here, here).is_none());
        assert!(
            Bearings::Straight
                .bearing(here, Point2::new(f64::INFINITY, 0.0))
                .is_none()
        );
        assert!(
            Bearings::Straight
                .bearing(here, Point2::new(0.0, f64::NAN))
                .is_none()
        );
    }
}
