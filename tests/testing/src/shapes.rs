//! Shapes, and maps of them.

use geometry::map::{ObstacleSpec, VectorMap};
use geometry::shape::Shape;

/// A rectangle along the axes, by its centre and half its size (m).
pub fn rectangle(center: [f64; 2], half_extents: [f64; 2]) -> Shape {
    Shape::Rectangle {
        center,
        half_extents,
        angle: 0.0,
    }
}

/// A circle (m).
pub fn circle(center: [f64; 2], radius: f64) -> Shape {
    Shape::Circle { center, radius }
}

/// A map from a corner to the opposite one (m) at a resolution (m), with obstacles that are called `o0`, `o1`, ….
pub fn map(
    min: [f64; 2],
    max: [f64; 2],
    resolution: f64,
    obstacles: impl IntoIterator<Item = Shape>,
) -> VectorMap {
    let mut map = VectorMap::empty(min, max, resolution);
    let named = |(i, shape)| ObstacleSpec {
        name: format!("o{i}"),
        shape,
    };
    map.obstacles = obstacles.into_iter().enumerate().map(named).collect();
    map
}
