//! Retreats from a lane with a bay, wherever the bay lies and however the lane is turned.

use geometry::math;
use geometry::shape::{Aabb, Convex};
use nalgebra::{Point2, Vector2};
use navigation::passing::{Meeting, Retreat, Trail, retreat};
use planner_view::free_space::FreeSpace;
use proptest::prelude::*;

const LENGTH: f64 = 6.0;
const WIDTH: f64 = 0.3;
const RADIUS: f64 = 0.105;
const CLEARANCE: f64 = 0.125;
const APART: f64 = 0.26;

/// A lane along x, turned about the origin, with at most one bay: its place along the lane, its
/// width and its depth (m).
struct Lane {
    angle: f64,
    space: FreeSpace,
}

impl Lane {
    fn new(angle: f64, bay: Option<(f64, f64, f64)>) -> Self {
        let (at, width, depth) = bay.unwrap_or((LENGTH / 2.0, 0.0, 0.0));
        let (left, right, top) = (at - width / 2.0, at + width / 2.0, WIDTH + depth);
        let walls = [
            (-1.0, -1.0, LENGTH + 1.0, 0.0),
            (-1.0, 0.0, 0.0, WIDTH),
            (LENGTH, 0.0, LENGTH + 1.0, WIDTH),
            (-1.0, WIDTH, left, top + 1.0),
            (right, WIDTH, LENGTH + 1.0, top + 1.0),
            (left - 0.1, top, right + 0.1, top + 1.0),
        ];
        let bounds = Aabb {
            min: Point2::new(-10.0, -10.0),
            max: Point2::new(10.0, 10.0),
        };
        let parts = walls.map(|(x0, y0, x1, y1)| {
            let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)];
            Convex::polygon(&corners.map(|(x, y)| turned(angle, x, y)))
        });
        Self {
            angle,
            space: FreeSpace::new(parts.to_vec(), bounds, 0.05).unwrap(),
        }
    }

    /// A point on the middle of the lane.
    fn middle(&self, x: f64) -> Point2<f64> {
        turned(self.angle, x, WIDTH / 2.0)
    }

    /// The retreat of a robot that came from the far end to `x`, where it meets the other.
    fn retreat(&self, x: f64) -> Option<Retreat> {
        let mut trail = Trail::new(RADIUS);
        let mut came = LENGTH - 0.4;
        while came > x {
            trail.add(self.middle(came));
            came -= 0.011;
        }
        let meeting = Meeting {
            at: self.middle(x),
            other: self.middle(x - 0.3),
            clearance: CLEARANCE,
            apart: APART,
        };
        retreat(&self.space, &trail, &meeting)
    }

    /// Distance (m) of a point from the middle of the lane.
    fn distance_to_middle(&self, p: Point2<f64>) -> f64 {
        (turned(-self.angle, p.x, p.y).y - WIDTH / 2.0).abs()
    }

    fn along(&self, p: Point2<f64>) -> f64 {
        turned(-self.angle, p.x, p.y).x
    }
}

fn turned(angle: f64, x: f64, y: f64) -> Point2<f64> {
    let (sin, cos) = math::sincos(angle);
    Point2::from(Vector2::new(x * cos - y * sin, x * sin + y * cos))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_bay_behind_is_found_and_leaves_the_lane_to_the_other(
        angle in -3.2..3.2f64, x in 0.5..3.0f64, ahead in 0.3..2.0f64,
        width in 0.4..0.8f64, depth in 0.3..0.6f64,
    ) {
        let bay = x + ahead + width / 2.0;
        let lane = Lane::new(angle, Some((bay, width, depth)));
        let Some(Retreat::Aside(place)) = lane.retreat(x) else {
            return Err(TestCaseError::fail("no place"));
        };
        prop_assert!(lane.space.is_free(place, CLEARANCE));
        prop_assert!(lane.distance_to_middle(place) >= APART - 1e-9);
        prop_assert!((lane.along(place) - bay).abs() < width / 2.0);
        // The robot gets there: back in the lane, then aside.
        let entry = lane.middle(bay);
        prop_assert!(lane.space.segment_is_free(lane.middle(x), entry, CLEARANCE));
        prop_assert!(lane.space.segment_is_free(entry, place, RADIUS));
    }

    #[test]
    fn a_bay_between_the_two_makes_the_robot_go_back(
        angle in -3.2..3.2f64, x in 1.0..4.5f64, off in -0.05..0.05f64,
    ) {
        let lane = Lane::new(angle, Some((x - 0.15 + off, 0.3, 0.4)));
        let Some(Retreat::Back(place)) = lane.retreat(x) else {
            return Err(TestCaseError::fail("not back"));
        };
        prop_assert!(lane.distance_to_middle(place) < 1e-9);
        prop_assert!(lane.along(place) > x + APART && lane.along(place) <= x + 2.0 * APART + 1e-9);
    }

    #[test]
    fn without_a_bay_or_with_one_that_is_too_shallow_there_is_no_retreat(
        angle in -3.2..3.2f64, x in 0.5..5.5f64, depth in 0.0..0.2f64,
    ) {
        let lane = Lane::new(angle, Some((3.0, 0.6, depth)));
        prop_assert_eq!(lane.retreat(x), None);
        prop_assert_eq!(Lane::new(angle, None).retreat(x), None);
    }

    #[test]
    fn a_trail_has_no_loops_and_ends_where_the_robot_is(
        turns in proptest::collection::vec(-1.0..1.0f64, 1..400),
    ) {
        let mut trail = Trail::new(RADIUS);
        let (mut at, mut heading) = (Point2::origin(), 0.0);
        for turn in turns {
            heading += turn;
            let (sin, cos) = math::sincos(heading);
            at += Vector2::new(cos, sin) * 0.03;
            trail.add(at);
            let points: Vec<_> = trail.back().collect();
            prop_assert!((points[0] - at).norm() < RADIUS);
            for (i, a) in points.iter().enumerate() {
                prop_assert!(points[i + 1..].iter().all(|b| (a - b).norm() >= RADIUS));
            }
        }
        prop_assert!((trail.back().last().unwrap() - Point2::origin()).norm() < 2.0 * RADIUS);
    }
}
