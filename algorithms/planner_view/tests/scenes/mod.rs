//! Scenes of convex pieces, and slow exact geometry for comparison.
#![allow(dead_code, reason = "each test file uses another part of it")]

use std::path::Path;

use geometry::map::{MapSpec, UnknownCells, WorldMap};
use geometry::math;
use geometry::shape::{Aabb, Convex, Shape};
use nalgebra::{Point2, Vector2};
use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::query;
use parry2d_f64::shape::Segment;
use planner_view::free_space::{Arc, FreeSpace};
use proptest::prelude::*;

/// Radius of the TurtleBot3 Burger (m).
pub const RADIUS: f64 = 0.105;

/// The city of the scenarios.
pub fn city() -> FreeSpace {
    // The benchmarks use this file too, from another folder.
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .map(|folder| folder.join("scenarios/maps/city.toml"))
        .find(|path| path.exists())
        .unwrap();
    let spec = MapSpec::File {
        path,
        unknown: UnknownCells::default(),
    };
    let map = WorldMap::new(&spec.load(Path::new("")).unwrap()).unwrap();
    FreeSpace::from(map.shapes().clone())
}

pub fn bounds() -> Aabb {
    Aabb {
        min: Point2::new(-5.0, -4.0),
        max: Point2::new(5.0, 4.03),
    }
}

pub fn space(parts: Vec<Convex>) -> FreeSpace {
    FreeSpace::new(parts, bounds(), 0.1).unwrap()
}

/// The convex pieces of a shape; some cross the bounds.
pub fn any_parts() -> impl Strategy<Value = Vec<Convex>> {
    let center = || (-4.5..4.5f64, -4.0..4.0f64).prop_map(|(x, y)| [x, y]);
    let angle = prop_oneof![Just(0.0), -3.0..3.0f64];
    prop_oneof![
        (center(), 0.05..1.2f64).prop_map(|(center, radius)| Shape::Circle { center, radius }),
        (center(), 0.05..1.2f64, 0.05..1.2f64, angle).prop_map(|(center, a, b, angle)| {
            Shape::Rectangle {
                center,
                half_extents: [a, b],
                angle,
            }
        }),
        // A star: concave, so that it is cut into pieces that touch.
        (center(), proptest::collection::vec(0.2..1.5f64, 3..9)).prop_map(|(center, radii)| {
            let turn = core::f64::consts::TAU / radii.len() as f64;
            let corner = |(i, r): (usize, &f64)| {
                let (sin, cos) = math::sincos(turn * i as f64);
                [center[0] + r * cos, center[1] + r * sin]
            };
            Shape::Polygon {
                vertices: radii.iter().enumerate().map(corner).collect(),
            }
        }),
    ]
    .prop_map(|shape| shape.parts().unwrap())
}

pub fn any_space(shapes: core::ops::Range<usize>) -> impl Strategy<Value = FreeSpace> {
    proptest::collection::vec(any_parts(), shapes).prop_map(|parts| space(parts.concat()))
}

pub fn any_point() -> impl Strategy<Value = Point2<f64>> {
    (-5.1..5.1f64, -4.1..4.1f64).prop_map(|(x, y)| Point2::new(x, y))
}

/// Distance to the edge; negative beyond it.
pub fn edge_distance(bounds: &Aabb, p: Point2<f64>) -> f64 {
    (p - bounds.min).min().min((bounds.max - p).min())
}

/// Distance by parry over every piece, and the edge; 0 inside.
pub fn parry_distance(space: &FreeSpace, p: Point2<f64>) -> f64 {
    parry_segment_distance(space, p, p)
}

/// The same for a segment.
pub fn parry_segment_distance(space: &FreeSpace, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let edge = edge_distance(space.bounds(), a).min(edge_distance(space.bounds(), b));
    space
        .shapes()
        .parts()
        .iter()
        .fold(edge.max(0.0), |least, part| {
            let (pose, shape) = part.to_parry();
            let (a, b) = (Vector::new(a.x, a.y), Vector::new(b.x, b.y));
            let distance = if a == b {
                shape.distance_to_point(&pose, a, true)
            } else {
                let segment = Segment::new(a, b);
                query::distance(&Pose::IDENTITY, &segment, &pose, shape.as_ref())
                    .unwrap()
                    .distance
            };
            least.min(distance)
        })
}

/// The minimum distance at points along an arc, and half the distance between two of them.
pub fn arc_distance(space: &FreeSpace, arc: &Arc, count: usize) -> (f64, f64) {
    let least = (0..=count)
        .map(|i| space.distance(arc.at(i as f64 / count as f64)))
        .fold(f64::INFINITY, f64::min);
    (least, 0.5 * arc.length() / count as f64)
}

/// The unit vector in a direction (rad).
pub fn unit(angle: f64) -> Vector2<f64> {
    let (sin, cos) = math::sincos(angle);
    Vector2::new(cos, sin)
}
