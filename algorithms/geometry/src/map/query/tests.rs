use nalgebra::{Point2, Vector2};
use parry2d_f64::math::Vector;
use parry2d_f64::query::Ray;
use proptest::prelude::*;

use crate::grid::{Grid, GridFrame};
use crate::map::{CellMap, ObstacleSpec, VectorMap, WorldMap};
use crate::math;
use crate::shape::Shape;

fn any_shape() -> impl Strategy<Value = Shape> {
    let center = || (-4.0..4.0f64, -3.0..3.0f64).prop_map(|(x, y)| [x, y]);
    prop_oneof![
        (center(), 0.05..1.0f64).prop_map(|(center, radius)| Shape::Circle { center, radius }),
        (
            center(),
            0.05..1.0f64,
            0.05..1.0f64,
            prop_oneof![Just(0.0), -3.0..3.0f64]
        )
            .prop_map(|(center, a, b, angle)| Shape::Rectangle {
                center,
                half_extents: [a, b],
                angle
            }),
        // A star: concave, simple.
        (center(), proptest::collection::vec(0.2..1.2f64, 3..9)).prop_map(|(center, radii)| {
            let n = radii.len() as f64;
            let corner = |(i, r): (usize, &f64)| {
                let (sin, cos) = math::sincos(core::f64::consts::TAU * i as f64 / n);
                [center[0] + r * cos, center[1] + r * sin]
            };
            Shape::Polygon {
                vertices: radii.iter().enumerate().map(corner).collect(),
            }
        }),
    ]
}

fn any_map() -> impl Strategy<Value = WorldMap> {
    proptest::collection::vec(any_shape(), 0..12).prop_map(|shapes| {
        let mut map = VectorMap::empty([-5.0, -4.0], [5.0, 4.03], 0.1);
        map.obstacles = shapes
            .into_iter()
            .map(|shape| ObstacleSpec {
                name: String::new(),
                shape,
            })
            .collect();
        WorldMap::from_vectors(&map).unwrap()
    })
}

fn any_point() -> impl Strategy<Value = Point2<f64>> {
    (-5.2..5.2f64, -4.2..4.2f64).prop_map(|(x, y)| Point2::new(x, y))
}

/// Distance by parry over every piece, and the edge.
fn distance_by_parry(map: &WorldMap, p: Point2<f64>) -> f64 {
    let bounds = map.bounds();
    if !bounds.contains(p) {
        return 0.0;
    }
    let (low, high) = (p - bounds.min, bounds.max - p);
    map.parts()
        .iter()
        .fold(low.min().min(high.min()), |d, part| {
            let (pose, shape) = part.to_parry();
            d.min(shape.distance_to_point(&pose, Vector::new(p.x, p.y), true))
        })
}

fn ray_by_parry(map: &WorldMap, p: Point2<f64>, dir: Vector2<f64>) -> f64 {
    let (_, edge) = map.bounds().ray_interval(p, dir);
    map.parts().iter().fold(edge, |d, part| {
        let (pose, shape) = part.to_parry();
        let ray = Ray::new(Vector::new(p.x, p.y), Vector::new(dir.x, dir.y));
        shape.cast_ray(&pose, &ray, d, true).map_or(d, |t| t.min(d))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn distances_and_bounds_agree_with_parry(
        map in any_map(), points in proptest::collection::vec(any_point(), 30),
    ) {
        for p in points {
            let exact = distance_by_parry(&map, p);
            prop_assert!((map.distance(p) - exact).abs() < 1e-9);
            prop_assert!(map.clearance_at_least(p) <= exact);
            if map.bounds().contains(p) {
                let resolution = map.frame().resolution;
                prop_assert!(map.clearance_at_least(p) > exact - 1.4143 * resolution - 1e-5);
            }
            for radius in [0.01, 0.1, 0.5] {
                if (exact - radius).abs() > 1e-9 {
                    prop_assert_eq!(map.is_clear(p, radius), exact > radius);
                }
            }
            let contact = map.nearest_contact(p);
            if exact > 0.0 {
                prop_assert!((contact.distance - exact).abs() < 1e-9);
            } else {
                prop_assert!(contact.distance <= 1e-12);
            }
        }
    }

    #[test]
    fn rays_agree_with_parry(
        map in any_map(),
        rays in proptest::collection::vec((any_point(), -3.2..3.2f64), 30),
    ) {
        for (p, angle) in rays {
            if distance_by_parry(&map, p) == 0.0 {
                prop_assert_eq!(map.cast_ray(p, Vector2::x(), 3.0), Some(0.0));
                continue;
            }
            let (sin, cos) = math::sincos(angle);
            let dir = Vector2::new(cos, sin);
            let expected = ray_by_parry(&map, p, dir);
            let ours = map.cast_ray(p, dir, 100.0).unwrap();
            if (ours - expected).abs() > 1e-6 {
                // A graze: slightly to the side the two agree again.
                let beside = [-1e-4, 1e-4].map(|s| {
                    let q = p + Vector2::new(-sin, cos) * s;
                    (map.cast_ray(q, dir, 100.0).unwrap() - expected).abs() < 1e-2
                });
                prop_assert!(beside[0] || beside[1], "{} {}", ours, expected);
            }
            prop_assert_eq!(map.cast_ray(p, dir, ours + 1e-9), Some(ours));
            prop_assert_eq!(map.cast_ray(p, dir, ours - 1e-9), None);
            let there = p + dir * (ours * 0.999);
            prop_assert!(map.line_of_sight(p, there));
            prop_assert!(!map.line_of_sight(p, p + dir * (ours + 1e-6)));
        }
    }

    #[test]
    fn a_cell_map_is_its_cells(cells in proptest::collection::vec(any::<bool>(), 12 * 9)) {
        let frame =
            GridFrame { width: 12, height: 9, resolution: 0.3, origin: Point2::new(-1.0, 0.5) };
        let grid = Grid { frame, cells };
        let map = WorldMap::from_cells(&CellMap::from_grid(&grid)).unwrap();
        prop_assert_eq!(map.occupancy(), &grid);
    }

    #[test]
    fn grids_say_what_exact_geometry_says(map in any_map()) {
        for row in 0..map.frame().height {
            for col in 0..map.frame().width {
                let p = map.frame().center(col, row);
                let d = distance_by_parry(&map, p);
                let cell = map.frame().index(col, row);
                prop_assert!((f64::from(map.clearance().cells[cell]) - d).abs() < 1e-5);
                if d > 1e-9 {
                    prop_assert!(!map.occupancy().cells[cell]);
                }
            }
        }
    }
}

#[test]
fn points_that_are_not_finite_are_inside_everything() {
    let map = WorldMap::from_vectors(&VectorMap::empty([0.0; 2], [1.0; 2], 0.1)).unwrap();
    let nowhere = Point2::new(f64::NAN, 0.5);
    assert_eq!(map.distance(nowhere), 0.0);
    assert!(!map.is_clear(nowhere, 0.1));
    assert_eq!(map.cast_ray(nowhere, Vector2::x(), 1.0), Some(0.0));
    assert!(!map.line_of_sight(Point2::new(0.5, 0.5), nowhere));
    assert!(!map.line_of_sight(nowhere, nowhere));
}
