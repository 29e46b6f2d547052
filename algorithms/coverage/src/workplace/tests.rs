use core::f64::consts::PI;

use proptest::prelude::*;
use testing::circle;

use super::*;

fn square() -> Aabb {
    Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(10.0, 10.0),
    }
}

fn rectangle(center: [f64; 2], half_extents: [f64; 2], angle: f64) -> Shape {
    Shape::Rectangle {
        center,
        half_extents,
        angle,
    }
}

fn polygon(vertices: &[[f64; 2]]) -> Shape {
    Shape::Polygon {
        vertices: vertices.to_vec(),
    }
}

fn refusal(radius: f64, obstacles: &[Shape]) -> String {
    Workplace::new(square(), radius, obstacles, 0.1)
        .unwrap_err()
        .to_string()
}

#[test]
fn obstacles_grow_by_the_radius_and_are_clipped_to_the_shrunken_workplace() {
    let obstacles = [
        rectangle([5.0, 5.0], [2.5, 2.5], 0.0),
        rectangle([0.5, 9.0], [1.0, 2.0], 0.0),
    ];
    let workplace = Workplace::new(square(), 0.1, &obstacles, 0.1).unwrap();
    let corners: Vec<[f64; 4]> = workplace
        .inflated()
        .iter()
        .map(|r| [r.min.x, r.min.y, r.max.x, r.max.y])
        .collect();
    assert_eq!(corners, [[2.4, 2.4, 7.6, 7.6], [0.1, 6.9, 1.6, 9.9]]);
    assert_eq!(workplace.loss(), ConversionLoss::default());
}

#[test]
fn a_rectangle_written_as_a_polygon_stays_one_rectangle() {
    let corners = [[2.0, 3.0], [4.0, 3.0], [4.0, 6.0], [2.0, 6.0]];
    let workplace = Workplace::new(square(), 0.1, &[polygon(&corners)], 0.01).unwrap();
    assert_eq!(workplace.rectangles().len(), 1);
    let r = workplace.rectangles()[0];
    assert_eq!([r.min.x, r.min.y, r.max.x, r.max.y], [2.0, 3.0, 4.0, 6.0]);
    assert_eq!(workplace.loss().area, 0.0);
}

#[test]
fn the_loss_of_a_disc_is_the_area_of_its_slabs_beyond_it() {
    let disc = circle([5.0, 5.0], 2.0);
    // A robot of radius 0: the lost area is the area of the slabs less that of the disc.
    let workplace = Workplace::new(square(), 0.0, core::slice::from_ref(&disc), 0.2).unwrap();
    let slabs: f64 = workplace
        .rectangles()
        .iter()
        .map(|r| (r.max.x - r.min.x) * (r.max.y - r.min.y))
        .sum();
    let loss = workplace.loss();
    let expected = slabs - 4.0 * PI;
    assert!((loss.area - expected).abs() < 1e-3, "{loss:?} {expected}");
    assert!((loss.share - expected / (100.0 - 4.0 * PI)).abs() < 1e-5);
    let finer = Workplace::new(square(), 0.0, &[disc], 0.02).unwrap();
    assert!(finer.loss().area < 0.15 * loss.area);
}

#[test]
fn pieces_of_a_map_beyond_the_workplace_do_not_matter() {
    let parts = [
        Convex::disc(Point2::new(20.0, 5.0), 1.0),
        Convex::rectangle(Point2::new(5.0, 5.0), [1.0, 1.0], 0.0),
    ];
    let workplace = Workplace::from_parts(square(), 0.1, &parts, 0.1).unwrap();
    assert_eq!(workplace.rectangles().len(), 1);
}

#[test]
fn unusable_workplaces_are_refused_with_what_to_change() {
    let text = refusal(0.1, &[rectangle([12.0, 5.0], [1.0, 1.0], 0.0)]);
    assert!(text.starts_with("obstacles[0] lies outside"), "{text}");
    assert!(text.ends_with("move it inside or leave it out"), "{text}");
    let text = refusal(0.1, &[rectangle([5.0, 5.0], [4.95, 4.95], 0.0)]);
    assert!(text.contains("obstacles[0] covers the whole"), "{text}");
    let bow_tie = [[1.0, 1.0], [3.0, 3.0], [3.0, 1.0], [1.0, 3.0]];
    let text = refusal(0.1, &[polygon(&bow_tie)]);
    assert!(
        text.starts_with("obstacles[0]: polygon.vertices: edge 0"),
        "{text}"
    );
    let text = refusal(0.1, &[rectangle([f64::NAN, 5.0], [1.0, 1.0], 0.0)]);
    assert!(
        text.contains("obstacles[0]: `rectangle.center[0]` is NaN"),
        "{text}"
    );
    let text = refusal(5.0, &[]);
    assert!(
        text.starts_with("radius = 5") && text.contains("smaller robot"),
        "{text}"
    );
    assert!(refusal(f64::NAN, &[]).starts_with("radius = NaN"));
    let reversed = Aabb {
        min: square().max,
        max: square().min,
    };
    let error = Workplace::new(reversed, 0.1, &[], 0.1).unwrap_err();
    assert_eq!(error, WorkplaceError::Bounds(reversed));
    for tolerance in [0.0, 1e-9, f64::NAN, f64::INFINITY] {
        let error = Workplace::new(square(), 0.1, &[], tolerance).unwrap_err();
        assert!(matches!(error, WorkplaceError::Tolerance { .. }), "{error}");
    }
    let tilted = rectangle([5.0, 5.0], [3.0, 0.5], 0.7);
    let error = Workplace::new(square(), 0.1, &[tilted], 1e-5).unwrap_err();
    assert!(
        matches!(error, WorkplaceError::TooManyRectangles { .. }),
        "{error}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn rectangles_contain_their_piece_and_stick_out_by_the_tolerance_at_most(
        center in (2.0..8.0, 2.0..8.0),
        half in (0.05..2.0, 0.05..2.0),
        angle in -4.0..4.0,
        round in prop::bool::ANY,
        tolerance in 0.02..0.5,
    ) {
        let center = Point2::new(center.0, center.1);
        let piece = if round {
            Convex::disc(center, half.0)
        } else {
            Convex::rectangle(center, [half.0, half.1], angle)
        };
        let mut slabs = Vec::new();
        slabs::cover(&piece, tolerance, MAX_RECTANGLES, &mut slabs);
        let whole = piece.aabb();
        for i in 0..=60 {
            for j in 0..=60 {
                let size = whole.max - whole.min;
                let p = whole.min
                    + Vector2::new(size.x * f64::from(i) / 60.0, size.y * f64::from(j) / 60.0);
                let covered = slabs.iter().any(|s| s.distance(p) <= 1e-9);
                if piece.distance(p) == 0.0 {
                    prop_assert!(covered, "{p} of the piece is not covered");
                }
                if slabs.iter().any(|s| s.contains(p)) {
                    prop_assert!(piece.distance(p) <= tolerance + 1e-9, "{p} sticks out");
                }
            }
        }
    }
}
