use geometry::shape::Shape;
use proptest::prelude::*;
use testing::{circle, rectangle};

use super::*;
use crate::awg::tests::octagon;

fn cut(shapes: Vec<Shape>) -> Vec<Stretch> {
    DangerZones(shapes).cut(&octagon()).unwrap()
}

#[test]
fn without_zones_everything_is_threatened() {
    let stretches = cut(vec![]);
    assert!(stretches.iter().all(|s| s.threatened));
    let segments: Vec<Segment> = stretches.iter().map(|s| s.segment).collect();
    assert_eq!(segments, octagon().segments());
}

#[test]
fn entry_and_exit_become_waypoints() {
    // Across the left side, x = 0 from y = 5 to 10.
    let stretches = cut(vec![rectangle([0.0, 7.0], [1.0, 1.0])]);
    assert_eq!(stretches.len(), 10);
    let left: Vec<&Stretch> = stretches.iter().filter(|s| s.part_of == 1).collect();
    let ends: Vec<f64> = left.iter().map(|s| s.segment.to.y).collect();
    assert_eq!(ends, [6.0, 8.0, 10.0]);
    let threatened: Vec<bool> = left.iter().map(|s| s.threatened).collect();
    assert_eq!(threatened, [false, true, false]);
}

#[test]
fn a_zone_over_a_corner_threatens_both_its_segments() {
    let stretches = cut(vec![circle([0.0, 10.0], 2.0)]);
    let threatened: Vec<&Stretch> = stretches.iter().filter(|s| s.threatened).collect();
    assert_eq!(threatened.len(), 2);
    assert_eq!(threatened[0].segment.to, threatened[1].segment.from);
    assert!(
        threatened
            .iter()
            .all(|s| (s.segment.length - 2.0).abs() < 1e-12)
    );
}

#[test]
fn zones_that_overlap_or_touch_are_one() {
    let stretches = cut(vec![
        rectangle([0.0, 6.5], [1.0, 0.5]),
        rectangle([0.0, 7.5], [1.0, 0.5]),
        rectangle([0.0, 7.2], [0.5, 0.7]),
    ]);
    let threatened: Vec<&Stretch> = stretches.iter().filter(|s| s.threatened).collect();
    assert_eq!(threatened.len(), 1);
    assert!((threatened[0].segment.length - 2.0).abs() < 1e-12);
}

#[test]
fn a_zone_beside_the_contour_threatens_nothing() {
    let stretches = cut(vec![rectangle([7.5, 7.5], [2.0, 2.0])]);
    assert_eq!(stretches.len(), 8);
    assert!(stretches.iter().all(|s| !s.threatened));
}

#[test]
fn a_polygon_that_is_not_convex_counts_with_its_notch_left_out() {
    // A U open to the left, its arms across the left side of the octagon.
    let u = Shape::Polygon {
        vertices: vec![
            [-1.0, 6.0],
            [2.0, 6.0],
            [2.0, 9.0],
            [-1.0, 9.0],
            [-1.0, 8.0],
            [1.0, 8.0],
            [1.0, 7.0],
            [-1.0, 7.0],
        ],
    };
    let stretches = cut(vec![u]);
    let ends: Vec<(f64, bool)> = stretches
        .iter()
        .filter(|s| s.part_of == 1)
        .map(|s| ((s.segment.to.y * 1e9).round() / 1e9, s.threatened))
        .collect();
    assert_eq!(
        ends,
        [
            (6.0, false),
            (7.0, true),
            (8.0, false),
            (9.0, true),
            (10.0, false)
        ]
    );
}

#[test]
fn a_zone_without_an_area_is_named() {
    let zones = DangerZones(vec![
        rectangle([0.0, 0.0], [1.0, 1.0]),
        rectangle([0.0, 0.0], [1.0, -1.0]),
    ]);
    let error = zones.cut(&octagon()).unwrap_err().to_string();
    assert!(
        error.starts_with("`danger_zones[1]`: `rectangle.half_extents[1]` is -1"),
        "{error}"
    );
}

#[test]
fn zones_read_as_a_list_of_shapes() {
    #[derive(Deserialize)]
    struct File {
        danger_zones: DangerZones,
    }
    let text = "danger_zones = [{ circle = { center = [5, 5], radius = 2 } }]";
    let file: File = toml::from_str(text).unwrap();
    assert!(file.danger_zones.contains(Point2::new(6.0, 6.0)).unwrap());
    assert!(!file.danger_zones.contains(Point2::new(7.0, 7.0)).unwrap());
}

fn shape() -> impl Strategy<Value = Shape> {
    let center = || prop::array::uniform2(-2.0..17.0);
    prop_oneof![
        (center(), 0.05..4.0).prop_map(|(center, radius)| Shape::Circle { center, radius }),
        (center(), prop::array::uniform2(0.05..4.0), -3.0..3.0_f64).prop_map(
            |(center, half_extents, angle)| Shape::Rectangle {
                center,
                half_extents,
                angle,
            }
        ),
    ]
}

proptest! {
    #[test]
    fn the_cut_contour_is_the_contour_and_threatened_exactly_inside(
        shapes in prop::collection::vec(shape(), 1..5),
    ) {
        let zones = DangerZones(shapes);
        let contour = octagon();
        let stretches = zones.cut(&contour).unwrap();
        // The same path: end to end, of the same length, through the same waypoints.
        let total: f64 = stretches.iter().map(|s| s.segment.length).sum();
        prop_assert!((total - contour.length()).abs() < 1e-9);
        for pair in stretches.windows(2) {
            prop_assert_eq!(pair[0].segment.to, pair[1].segment.from);
        }
        for (i, segment) in contour.segments().iter().enumerate() {
            let own: Vec<&Stretch> = stretches.iter().filter(|s| s.part_of == i).collect();
            prop_assert_eq!(own[0].segment.from, segment.from);
            prop_assert_eq!(own[own.len() - 1].segment.to, segment.to);
        }
        let parts = zones.parts().unwrap();
        let depth = |p: Point2<f64>| {
            parts.iter().map(|z| z.contact(p).distance).fold(f64::INFINITY, f64::min)
        };
        for stretch in &stretches {
            let Segment { from, to, along, length } = stretch.segment;
            prop_assert!(length > 0.0);
            prop_assert!((to - from - along * length).norm() < 1e-9);
            // Threatened stretches are inside everywhere, the rest outside, except for slivers.
            for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
                let p = from + along * (length * share);
                if stretch.threatened {
                    prop_assert!(depth(p) <= MIN_STRETCH, "{}", depth(p));
                } else {
                    prop_assert!(depth(p) >= -MIN_STRETCH, "{}", depth(p));
                }
            }
            // A start or end of the threat within a segment lies on the border of a zone.
            for end in [from, to] {
                if !contour.points().contains(&end) {
                    let off = parts.iter().map(|z| z.contact(end).distance.abs());
                    prop_assert!(off.fold(f64::INFINITY, f64::min) < 2.0 * MIN_STRETCH);
                }
            }
        }
    }
}
