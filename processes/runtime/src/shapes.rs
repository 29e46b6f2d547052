//! Conversion of the exact pieces of the map to a message and back.

use core::f64::consts::TAU;
use std::collections::BTreeMap;

use geometry::map::{ShapeMap, WorldMap};
use geometry::math;
use geometry::shape::{Aabb, Convex, Shape, ShapeError};
use ipc_types::messages::world::{ShapePoint, ShapesHeader};
use ipc_types::stamp::Stamp;
use nalgebra::Point2;

/// Maximum number of points of a message (8 MB; 65 536 rectangles of an occupancy grid). The header of a larger map marks
/// it as incomplete: planners then use the grids alone, and a scenario with a process that requires the pieces
/// ([`Input::SHAPES`](crate::declaration::Input::SHAPES)) is refused.
pub const MAX_POINTS: usize = 1 << 18;

/// Maximum coordinate and radius (m) that a receiver accepts.
const MAX_COORDINATE: f64 = 1e6;

/// Faults of a message that describes no pieces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ShapesMessageError {
    /// The bounds are empty, reversed or not finite.
    #[error(
        "bounds from ({min_x}, {min_y}) to ({max_x}, {max_y}): expected finite bounds with a positive area"
    )]
    Bounds {
        /// Smallest x (m).
        min_x: f64,
        /// Smallest y (m).
        min_y: f64,
        /// Largest x (m).
        max_x: f64,
        /// Largest y (m).
        max_y: f64,
    },
    /// The points do not form the announced number of shapes in order.
    #[error("point {point} is of shape {shape}: expected {announced} shapes one after the other")]
    Order {
        /// Index of the point.
        point: usize,
        /// The shape it names.
        shape: u32,
        /// Shapes that the header announces.
        announced: u32,
    },
    /// A coordinate or radius is out of its range.
    #[error(
        "shape {shape}: ({x}, {y}) with radius {radius}: expected numbers within ±{MAX_COORDINATE} \
         and a radius that is not negative"
    )]
    Number {
        /// Index of the shape.
        shape: u32,
        /// x (m).
        x: f64,
        /// y (m).
        y: f64,
        /// Radius (m).
        radius: f64,
    },
    /// The points of a shape form neither a disc nor a convex polygon.
    #[error(
        "shape {shape}: {points} points: expected one with a radius > 0, or the corners of a convex \
         polygon, counter-clockwise and with radius 0"
    )]
    Shape {
        /// Index of the shape.
        shape: u32,
        /// Its points.
        points: usize,
    },
}

/// Returns the number of points of a piece.
pub fn count(part: &Convex) -> usize {
    match part {
        Convex::Disc { .. } => 1,
        Convex::Box(_) => 4,
        Convex::Polygon(edges) => edges.len(),
    }
}

/// Returns the largest number of points that a map can have while obstacles take these shapes, given by the obstacles'
/// numbers.
///
/// # Errors
/// [`ShapeError`] of an invalid shape.
pub fn most_points<'a>(
    map: &WorldMap,
    shapes: impl Iterator<Item = (u32, &'a Shape)>,
) -> Result<usize, ShapeError> {
    let mut most: BTreeMap<u32, usize> = BTreeMap::new();
    for (id, shape) in shapes {
        let points: usize = shape.parts()?.iter().map(count).sum();
        let known = most.entry(id).or_default();
        *known = points.max(*known);
    }
    let standing: usize = map.parts().iter().map(count).sum();
    Ok(most
        .values()
        .fold(standing, |sum, points| sum.saturating_add(*points)))
}

/// Returns the points of pieces, in their order.
pub fn points(parts: &[Convex]) -> Vec<ShapePoint> {
    let mut points = Vec::new();
    for (shape, part) in parts.iter().enumerate() {
        let radius = match part {
            Convex::Disc { radius, .. } => *radius,
            _ => 0.0,
        };
        points.extend(part.corners().iter().map(|p| ShapePoint {
            x: p.x,
            y: p.y,
            radius,
            shape: shape as u32,
            reserved: 0,
        }));
    }
    points
}

/// Returns `world/shapes` for pieces; marks the message as incomplete if they exceed `capacity`
/// points.
pub fn to_message(
    shapes: &ShapeMap,
    revision: u32,
    stamp: Stamp,
    capacity: usize,
) -> (ShapesHeader, Vec<ShapePoint>) {
    let (bounds, mut points) = (shapes.bounds(), points(shapes.parts()));
    let complete = points.len() <= capacity;
    if !complete {
        points.clear();
    }
    let header = ShapesHeader {
        stamp,
        min_x: bounds.min.x,
        min_y: bounds.min.y,
        max_x: bounds.max.x,
        max_y: bounds.max.y,
        revision,
        shapes: if complete {
            shapes.parts().len() as u32
        } else {
            0
        },
        complete: u32::from(complete),
        reserved: 0,
    };
    (header, points)
}

/// Returns the bounds and pieces of a message, bit for bit as sent.
///
/// # Errors
/// [`ShapesMessageError`] if the message is invalid.
pub fn from_message(
    header: &ShapesHeader,
    points: &[ShapePoint],
) -> Result<(Aabb, Vec<Convex>), ShapesMessageError> {
    let &ShapesHeader {
        min_x,
        min_y,
        max_x,
        max_y,
        shapes: announced,
        ..
    } = header;
    let in_range = |v: f64| v.abs() <= MAX_COORDINATE;
    let sound = [min_x, min_y, max_x, max_y].into_iter().all(in_range);
    if !(sound && max_x > min_x && max_y > min_y) {
        return Err(ShapesMessageError::Bounds {
            min_x,
            min_y,
            max_x,
            max_y,
        });
    }
    let parts = pieces(announced, points)?;
    let bounds = Aabb {
        min: Point2::new(min_x, min_y),
        max: Point2::new(max_x, max_y),
    };
    Ok((bounds, parts))
}

/// Returns the pieces of points, `announced` in number, bit for bit as sent.
///
/// # Errors
/// [`ShapesMessageError`] if the points are invalid.
pub fn pieces(announced: u32, points: &[ShapePoint]) -> Result<Vec<Convex>, ShapesMessageError> {
    let mut parts = Vec::new();
    let mut at = 0;
    for group in points.chunk_by(|a, b| a.shape == b.shape) {
        let shape = group.first().map_or(0, |p| p.shape);
        if shape as usize != parts.len() || shape >= announced {
            return Err(ShapesMessageError::Order {
                point: at,
                shape,
                announced,
            });
        }
        parts.push(part(shape, group)?);
        at += group.len();
    }
    if parts.len() != announced as usize {
        let shape = parts.len() as u32;
        return Err(ShapesMessageError::Order {
            point: at,
            shape,
            announced,
        });
    }
    Ok(parts)
}

fn part(shape: u32, group: &[ShapePoint]) -> Result<Convex, ShapesMessageError> {
    for &ShapePoint { x, y, radius, .. } in group {
        let sound = [x, y].iter().all(|v| v.abs() <= MAX_COORDINATE);
        if !(sound && (0.0..=MAX_COORDINATE).contains(&radius)) {
            return Err(ShapesMessageError::Number {
                shape,
                x,
                y,
                radius,
            });
        }
    }
    let refused = ShapesMessageError::Shape {
        shape,
        points: group.len(),
    };
    if let [disc] = group {
        let center = Point2::new(disc.x, disc.y);
        return if disc.radius > 0.0 {
            Ok(Convex::disc(center, disc.radius))
        } else {
            Err(refused)
        };
    }
    let corners: Vec<Point2<f64>> = group.iter().map(|p| Point2::new(p.x, p.y)).collect();
    if group.iter().any(|p| p.radius != 0.0) || !is_convex(&corners) {
        return Err(refused);
    }
    Ok(rectangle(&corners).unwrap_or_else(|| Convex::polygon(&corners)))
}

/// Returns the axis-aligned rectangle of these corners, from the lower left on.
fn rectangle(corners: &[Point2<f64>]) -> Option<Convex> {
    let &[a, b, c, d] = corners else { return None };
    let upright = a.y == b.y && b.x == c.x && c.y == d.y && d.x == a.x && a.x < c.x && a.y < c.y;
    upright.then_some(Convex::Box(Aabb { min: a, max: c }))
}

/// Returns `true` if the corners go once around a convex interior, counter-clockwise.
fn is_convex(corners: &[Point2<f64>]) -> bool {
    let n = corners.len();
    let (mut bends, mut turned) = (true, 0.0);
    for (i, &a) in corners.iter().enumerate() {
        let (b, c) = (corners[(i + 1) % n], corners[(i + 2) % n]);
        let (side, next) = (b - a, c - b);
        let turn = math::atan2(side.perp(&next), side.dot(&next));
        // Rounding may bend parts of a cut polygon inwards.
        bends &= turn >= -1e-6;
        turned += turn;
    }
    // A full round is one full turn in all.
    n >= 3 && bends && (turned - TAU).abs() < 0.1
}

#[cfg(test)]
mod tests {
    use expect_test::expect;
    use geometry::shape::Shape;
    use proptest::prelude::*;

    use super::*;

    fn map(parts: Vec<Convex>) -> ShapeMap {
        let bounds = Aabb {
            min: Point2::new(-9.0, -8.0),
            max: Point2::new(9.0, 8.03),
        };
        let frame = geometry::grid::GridFrame {
            width: 18,
            height: 17,
            resolution: 1.0,
            origin: bounds.min,
        };
        ShapeMap::new(parts, bounds, frame)
    }

    fn any_part() -> impl Strategy<Value = Vec<Convex>> {
        let at = || (-5.0..5.0f64, -5.0..5.0f64).prop_map(|(x, y)| [x, y]);
        prop_oneof![
            (at(), 0.01..2.0f64).prop_map(|(center, radius)| Shape::Circle { center, radius }),
            (at(), 0.01..2.0f64, prop_oneof![Just(0.0), -3.0..3.0f64]).prop_map(
                |(center, half, angle)| Shape::Rectangle {
                    center,
                    half_extents: [half, 0.3],
                    angle
                }
            ),
            // A star: concave, so that it is cut.
            (at(), proptest::collection::vec(0.2..1.5f64, 3..16)).prop_map(|(center, radii)| {
                let turn = core::f64::consts::TAU / radii.len() as f64;
                let corner = |(i, r): (usize, &f64)| {
                    let (sin, cos) = geometry::math::sincos(turn * i as f64);
                    [center[0] + r * cos, center[1] + r * sin]
                };
                Shape::Polygon {
                    vertices: radii.iter().enumerate().map(corner).collect(),
                }
            }),
        ]
        .prop_map(|shape| shape.parts().unwrap())
    }

    proptest! {
        #[test]
        fn pieces_arrive_as_they_were_sent(
            parts in proptest::collection::vec(any_part(), 0..8),
        ) {
            for part in parts.iter().flatten() {
                prop_assert_eq!(count(part), points(core::slice::from_ref(part)).len());
            }
            let shapes = map(parts.concat());
            let (header, points) = to_message(&shapes, 3, Stamp::default(), MAX_POINTS);
            prop_assert_eq!((header.complete, header.revision), (1, 3));
            let (bounds, arrived) = from_message(&header, &points).unwrap();
            prop_assert_eq!(&bounds, shapes.bounds());
            prop_assert_eq!(&arrived[..], shapes.parts());
        }
    }

    #[test]
    fn a_map_that_does_not_fit_is_marked_as_incomplete() {
        let shapes = map(vec![
            Convex::rectangle(Point2::origin(), [1.0, 1.0], 0.0);
            3
        ]);
        let (header, points) = to_message(&shapes, 1, Stamp::default(), 11);
        assert_eq!((header.complete, header.shapes, points.len()), (0, 0, 0));
        let (header, points) = to_message(&shapes, 1, Stamp::default(), 12);
        assert_eq!((header.complete, header.shapes, points.len()), (1, 3, 12));
    }

    #[test]
    fn invalid_requests_are_rejected_with_their_fault() {
        let parts = vec![
            Convex::rectangle(Point2::origin(), [1.0, 1.0], 0.3),
            Convex::disc(Point2::new(3.0, 0.0), 0.5),
        ];
        let (header, sound) = to_message(&map(parts), 1, Stamp::default(), MAX_POINTS);
        let refused = |change: &dyn Fn(&mut ShapesHeader, &mut Vec<ShapePoint>)| {
            let (mut header, mut points) = (header, sound.clone());
            change(&mut header, &mut points);
            from_message(&header, &points).unwrap_err().to_string()
        };
        // Two rounds are not one.
        let twice = |_: &mut ShapesHeader, p: &mut Vec<ShapePoint>| {
            let square: Vec<_> = p[..4].to_vec();
            p.splice(0..0, square);
        };
        let errors = [
            refused(&|h, _| h.max_x = f64::NAN),
            refused(&|h, _| h.max_y = h.min_y),
            refused(&|h, _| h.shapes = 3),
            refused(&|h, _| h.shapes = 1),
            refused(&|_, p| p[0].shape = 7),
            refused(&|_, p| p[1].x = f64::INFINITY),
            refused(&|_, p| p[4].radius = -1.0),
            refused(&|_, p| p[4].radius = 0.0),
            refused(&|_, p| p[2].radius = 0.1),
            refused(&|_, p| p[..4].reverse()),
            refused(&|_, p| p.swap(1, 2)),
            refused(&|_, p| drop(p.drain(..2))),
            refused(&twice),
        ];
        expect![[r#"
            bounds from (-9, -8) to (NaN, 8.03): expected finite bounds with a positive area
            bounds from (-9, -8) to (9, -8): expected finite bounds with a positive area
            point 5 is of shape 2: expected 3 shapes one after the other
            point 4 is of shape 1: expected 1 shapes one after the other
            point 0 is of shape 7: expected 2 shapes one after the other
            shape 0: (inf, -0.6598162824642664) with radius 0: expected numbers within ±1000000 and a radius that is not negative
            shape 1: (3, 0) with radius -1: expected numbers within ±1000000 and a radius that is not negative
            shape 1: 1 points: expected one with a radius > 0, or the corners of a convex polygon, counter-clockwise and with radius 0
            shape 0: 4 points: expected one with a radius > 0, or the corners of a convex polygon, counter-clockwise and with radius 0
            shape 0: 4 points: expected one with a radius > 0, or the corners of a convex polygon, counter-clockwise and with radius 0
            shape 0: 4 points: expected one with a radius > 0, or the corners of a convex polygon, counter-clockwise and with radius 0
            shape 0: 2 points: expected one with a radius > 0, or the corners of a convex polygon, counter-clockwise and with radius 0
            shape 0: 8 points: expected one with a radius > 0, or the corners of a convex polygon, counter-clockwise and with radius 0"#]].assert_eq(&errors.join("\n"));
    }
}
