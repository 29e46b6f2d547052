//! Sliding along walls and around bodies, and invalid maps.

use std::sync::LazyLock;

use avoidance::potential_field::{Body, slide_along_obstacles, slide_around_bodies};
use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use nalgebra::{Point2, Vector2};
use planner_view::map::{MapError, PlannerMap};
use proptest::prelude::*;
use testing::{Arena, RADIUS};

static CITY: LazyLock<PlannerMap> = LazyLock::new(|| Arena::city().map());

#[test]
fn next_to_a_wall_only_the_inward_part_of_the_field_is_taken() {
    // The block with corner (1, 1) has its face at x = 1; the robot touches it from the street.
    let at = Point2::new(1.0 + RADIUS, 0.0);
    let inward = Vector2::new(-1.0, 0.5);
    let got = slide_along_obstacles(&CITY, at, RADIUS, inward, 0.1);
    assert!(got.x.abs() < 0.35 && (got.y - 0.5).abs() < 0.05, "{got:?}");
    let outward = Vector2::new(1.0, 0.5);
    assert_eq!(
        slide_along_obstacles(&CITY, at, RADIUS, outward, 0.1),
        outward
    );
    let middle = Point2::new(1.5, 0.0);
    assert_eq!(
        slide_along_obstacles(&CITY, middle, RADIUS, inward, 0.1),
        inward
    );
    assert_eq!(
        slide_along_obstacles(&CITY, at, RADIUS, inward, 0.0),
        inward
    );
}

#[test]
fn a_body_ahead_is_passed_on_the_side_with_more_room() {
    // In the street along x with its middle at y = 1.5.
    let field = Vector2::new(1.0, 0.0);
    let here = Point2::new(-0.22, 1.5);
    let pass = |y: f64| {
        let body = Body {
            at: Point2::new(0.0, y),
            radius: RADIUS,
        };
        slide_around_bodies(&CITY, here, RADIUS, field, [body], 0.15)
    };
    assert!(pass(1.6).y < -0.5, "{:?}", pass(1.6));
    assert!(pass(1.4).y > 0.5, "{:?}", pass(1.4));
    assert!(pass(1.6).x < 0.8);
}

#[test]
fn bodies_that_are_far_behind_or_unusable_do_not_turn_the_field() {
    let field = Vector2::new(1.0, 0.2);
    let here = Point2::new(0.0, 1.5);
    for (x, y, radius) in [
        (1.0, 1.5, RADIUS),
        (-0.21, 1.5, RADIUS),
        (f64::NAN, 1.5, RADIUS),
        (0.2, 1.5, f64::NAN),
        (0.0, 1.5, RADIUS),
        (0.2, 1.5, f64::NEG_INFINITY),
    ] {
        let body = Body {
            at: Point2::new(x, y),
            radius,
        };
        assert_eq!(
            slide_around_bodies(&CITY, here, RADIUS, field, [body], 0.15),
            field
        );
    }
}

#[test]
fn interpolated_clearance_is_that_of_the_city() {
    let arena = Arena::city();
    for (x, y) in [(1.5, 0.0), (1.3, 0.3), (4.5, 1.5), (8.5, 0.9), (-7.3, 7.1)] {
        let at = Point2::new(x, y);
        assert!(
            (CITY.clearance(at) - arena.clearance(at)).abs() < 0.05,
            "{at}"
        );
    }
    assert_eq!(CITY.clearance(Point2::new(20.0, 0.0)), 0.0);
    assert_eq!(CITY.clearance(Point2::new(f64::NAN, 0.0)), 0.0);
    let away = CITY.away_from_obstacles(Point2::new(1.15, 0.0)).unwrap();
    assert!((away - Vector2::new(1.0, 0.0)).norm() < 0.05);
}

#[test]
fn maps_whose_layers_do_not_fit_are_refused() {
    let frame = GridFrame {
        width: 4,
        height: 3,
        resolution: 0.1,
        origin: Point2::origin(),
    };
    let blurred = BlurredMap::new(&Grid::filled(frame, true), 0.2).unwrap();
    let short = Grid {
        frame,
        cells: vec![1.0; 11],
    };
    let error = PlannerMap::new(blurred.clone(), short, 0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the clearance layer has 11 values for 4 x 3 cells"
    );
    let mut broken = Grid::filled(frame, 1.0);
    broken.frame.resolution = f64::NAN;
    assert!(matches!(
        PlannerMap::new(blurred.clone(), broken, 0),
        Err(MapError::Frame {
            layer: "clearance",
            ..
        })
    ));
    // Without obstacles: infinite clearance must not corrupt the interpolation.
    let open = PlannerMap::new(blurred, Grid::filled(frame, f32::INFINITY), 0).unwrap();
    assert!(open.clearance(Point2::new(0.2, 0.15)) > 1e5);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn sliding_keeps_a_field_finite_and_little_longer(
        at in prop::array::uniform2(-10.0_f64..10.0),
        field in prop::array::uniform2(-5.0_f64..5.0),
        others in prop::collection::vec(prop::array::uniform3(prop::num::f64::ANY), 0..4),
        near in prop::collection::vec(prop::array::uniform2(-0.3_f64..0.3), 0..3),
    ) {
        let here = Point2::new(at[0], at[1]);
        let field = Vector2::new(field[0], field[1]);
        let bodies = others
            .iter()
            .map(|b| Body { at: Point2::new(b[0], b[1]), radius: b[2] })
            .chain(near.iter().map(|d| Body { at: here + Vector2::new(d[0], d[1]), radius: 0.1 }));
        let count = others.len() + near.len();
        let got = slide_around_bodies(&CITY, here, RADIUS, field, bodies, 0.15);
        // Each body turns at most the inward part aside.
        let longest = field.norm() * 1.5_f64.powi(count as i32) + 1e-9;
        prop_assert!(got.norm() <= longest, "{got:?}");
        let got = slide_along_obstacles(&CITY, here, RADIUS, field, 0.1);
        prop_assert!(got.norm() <= field.norm() + 1e-9);
    }
}
