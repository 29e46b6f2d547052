//! The exact free space compared with parry, and with points along the path.

use crate::scenes::{
    RADIUS, any_point, any_space, arc_distance, bounds, city, parry_distance,
    parry_segment_distance, space,
};
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use planner_view::free_space::{Arc, FreeSpace, FreeSpaceError};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn points_agree_with_parry(
        space in any_space(0..9), points in proptest::collection::vec(any_point(), 20),
    ) {
        for p in points {
            let exact = parry_distance(&space, p);
            let ours = space.distance(p);
            prop_assert!((ours.max(0.0) - exact).abs() < 1e-9, "{ours} {exact}");
            if exact == 0.0 {
                prop_assert!(ours <= 0.0);
            }
            for radius in [0.01, 0.1, 0.5] {
                if (exact - radius).abs() > 1e-8 {
                    prop_assert_eq!(space.is_free(p, radius), exact > radius);
                }
            }
        }
    }

    #[test]
    fn segments_agree_with_parry(
        space in any_space(0..9),
        segments in proptest::collection::vec((any_point(), any_point()), 20),
        radius in 0.01..1.0f64,
    ) {
        for (a, b) in segments {
            let exact = parry_segment_distance(&space, a, b);
            for radius in [radius, exact + 1e-7, exact - 1e-7] {
                // The results of parry are no better than this.
                if radius > 1e-6 && (exact - radius).abs() > 5e-8 {
                    let free = space.segment_is_free(a, b, radius);
                    prop_assert_eq!(free, exact > radius, "{} {}", exact, radius);
                    prop_assert_eq!(free, space.segment_is_free(b, a, radius));
                }
            }
        }
    }

    #[test]
    fn arcs_agree_with_points_along_them(
        space in any_space(0..9),
        arcs in proptest::collection::vec(
            (any_point(), 0.0..4.0f64, -7.0..7.0f64, -6.3..6.3f64), 10,
        ),
        radius in 0.01..0.6f64,
    ) {
        for (center, r, start, sweep) in arcs {
            let arc = Arc { center, radius: r, start, sweep };
            let (least, slack) = arc_distance(&space, &arc, 400);
            if least < radius - 1e-8 {
                prop_assert!(!space.arc_is_free(&arc, radius), "{least} {radius}");
            } else if least > radius + slack {
                prop_assert!(space.arc_is_free(&arc, radius), "{least} {radius}");
            }
            let back = Arc { start: start + sweep, sweep: -sweep, ..arc };
            if (least - radius).abs() > slack + 1e-8 {
                prop_assert_eq!(space.arc_is_free(&arc, radius), space.arc_is_free(&back, radius));
            }
        }
    }

    #[test]
    fn the_resolution_changes_no_answer(
        space in any_space(1..9), a in any_point(), b in any_point(), radius in 0.01..0.8f64,
    ) {
        let exact = parry_segment_distance(&space, a, b);
        for resolution in [0.02, 0.07, 0.5, 20.0] {
            let parts = space.shapes().parts().to_vec();
            let other = FreeSpace::new(parts, bounds(), resolution).unwrap();
            if (exact - radius).abs() > 1e-6 {
                let free = space.segment_is_free(a, b, radius);
                prop_assert_eq!(other.segment_is_free(a, b, radius), free);
            }
        }
    }
}

#[test]
fn a_robot_that_touches_is_free_along_and_around() {
    let block = Convex::rectangle(Point2::new(0.0, 0.0), [1.0, 1.0], 0.0);
    let space = space(vec![block, Convex::disc(Point2::new(3.0, 0.0), 0.5)]);
    let p = Point2::new;
    let r = RADIUS;
    let above = (p(-1.0, 1.0 + r), p(1.0, 1.0 + r));
    assert!(space.segment_is_free(above.0, above.1, r));
    assert!(!space.segment_is_free(above.0, above.1, r + 1e-6));
    let corner = Arc {
        center: p(1.0, 1.0),
        radius: r,
        start: 0.0,
        sweep: 1.5,
    };
    assert!(space.arc_is_free(&corner, r));
    assert!(!space.arc_is_free(&corner, r + 1e-6));
    let around = Arc {
        center: p(3.0, 0.0),
        radius: 0.5 + r,
        start: 1.0,
        sweep: -6.2,
    };
    assert!(space.arc_is_free(&around, r));
    // Along the edge of the world, which is a wall.
    assert!(space.segment_is_free(p(-4.0, -4.0 + r), p(4.0, -4.0 + r), r));
    assert!(!space.segment_is_free(p(-4.0, -4.0 + r), p(4.0, -4.0 + 0.9 * r), r));
}

#[test]
fn points_that_are_not_finite_are_not_free() {
    let space = space(vec![]);
    let (nowhere, here) = (Point2::new(f64::NAN, 0.0), Point2::origin());
    assert!(space.distance(nowhere).is_nan());
    assert!(!space.is_free(nowhere, 0.1) && !space.is_free(nowhere, 0.0));
    assert!(!space.segment_is_free(nowhere, here, 0.1));
    assert!(!space.segment_is_free(here, Point2::new(0.0, f64::INFINITY), 0.1));
    assert!(!space.segment_is_free(here, here, f64::NAN));
    for bad in [f64::NAN, f64::INFINITY] {
        let arc = Arc {
            center: here,
            radius: 1.0,
            start: 0.0,
            sweep: 1.0,
        };
        assert!(!space.arc_is_free(&Arc { sweep: bad, ..arc }, 0.1));
        assert!(!space.arc_is_free(&Arc { radius: bad, ..arc }, 0.1));
        assert!(!space.arc_is_free(
            &Arc {
                center: Point2::new(bad, 0.0),
                ..arc
            },
            0.1
        ));
    }
}

#[test]
fn impossible_spaces_are_named() {
    let empty = Aabb {
        min: Point2::origin(),
        max: Point2::new(1.0, 0.0),
    };
    let error = FreeSpace::new(vec![], empty, 0.1).unwrap_err();
    assert_eq!(error, FreeSpaceError::Bounds(empty));
    for resolution in [0.0, -1.0, f64::NAN, 1e-9] {
        let error = FreeSpace::new(vec![], bounds(), resolution).unwrap_err();
        assert!(error.to_string().starts_with("resolution ="), "{error}");
    }
}

#[test]
fn random_points_are_free_and_uniform() {
    let space = city();
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut quadrants = [0usize; 4];
    let count = 20_000;
    for _ in 0..count {
        let p = space.random_free(&mut rng, RADIUS).unwrap();
        assert!(space.is_free(p, RADIUS));
        quadrants[usize::from(p.x > 0.0) + 2 * usize::from(p.y > 0.0)] += 1;
    }
    // The exit's gap on the right is halved, too; its area is 2.5 of 178 m².
    for n in quadrants {
        assert!(n.abs_diff(count / 4) < count / 40, "{quadrants:?}");
    }
    assert_eq!(space.random_free(&mut rng, 3.0), None);
    let filled = crate::scenes::space(vec![Convex::rectangle(Point2::origin(), [9.0, 9.0], 0.0)]);
    assert_eq!(filled.random_free(&mut rng, 0.0), None);
}
