//! Shortest paths on a planner's map, as legs or as corners of a polyline.

use core::f64::consts::FRAC_PI_6;
use std::sync::Arc;

use geometry::math;
use nalgebra::Point2;
use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use thiserror::Error;

use crate::tangent_graph::{
    GraphError, MIN_RADIUS, PathLeg, ShortestPath, TangentGraph, shortest_once,
};

/// Maximum distance by which an end of a path may be moved to a free place (m): the centre of an exit may lie so
/// near to a wall that no robot fits there.
pub const END_TOLERANCE: f64 = 0.3;
/// Maximum turn at a corner of a polyline around an arc (rad).
const MAX_TURN: f64 = FRAC_PI_6;
/// Maximum distance of such a corner from the arc (m).
const MAX_OFFSET: f64 = 0.005;

/// Reason why a path cannot be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ShortestPathError {
    /// Only the grids of the map are known.
    #[error("the map has no exact pieces to find paths among")]
    NoPieces,
    /// The radius is not usable, or the map has too many corners.
    #[error(transparent)]
    Graph(#[from] GraphError),
}

/// Shortest paths of a disc on a map. The graph of a radius is built once for all planners of the map.
#[derive(Debug, Clone)]
pub struct ShortestPaths {
    space: FreeSpace,
    radius: f64,
    /// Error if the map has too many corners for a graph; each path is then found by itself.
    graph: Arc<Result<TangentGraph, GraphError>>,
}

impl ShortestPaths {
    /// The paths of a disc of this radius (m).
    ///
    /// # Errors
    /// [`ShortestPathError`] for a radius that is not usable and for a map without pieces.
    pub fn new(map: &PlannerMap, radius: f64) -> Result<Self, ShortestPathError> {
        let space = map.space().ok_or(ShortestPathError::NoPieces)?;
        if !(radius >= MIN_RADIUS && radius.is_finite()) {
            return Err(GraphError::Radius(radius).into());
        }
        let graph = map
            .derived()
            .get(radius, || TangentGraph::new(space, radius));
        Ok(Self {
            space: FreeSpace::clone(space),
            radius,
            graph,
        })
    }

    /// The shortest path between two points (m); `None` if there is none. A point that is not free begins or
    /// ends the path at the nearest free place, at most [`END_TOLERANCE`] away.
    ///
    /// # Errors
    /// [`ShortestPathError`] if the map has too many corners.
    pub fn path(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
    ) -> Result<Option<ShortestPath>, ShortestPathError> {
        let (Some(from), Some(to)) = (self.place(from), self.place(to)) else {
            return Ok(None);
        };
        Ok(match &*self.graph {
            Ok(graph) => graph.shortest(from, to),
            Err(_) => shortest_once(&self.space, self.radius, from, to)?,
        })
    }

    /// The corners of [`ShortestPaths::path`] (m), the two ends included; empty if there is no path.
    ///
    /// # Errors
    /// As [`ShortestPaths::path`].
    pub fn corners(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
    ) -> Result<Vec<Point2<f64>>, ShortestPathError> {
        let (Some(start), Some(path)) = (self.place(from), self.path(from, to)?) else {
            return Ok(Vec::new());
        };
        Ok(if path.legs.is_empty() {
            vec![start]
        } else {
            corners(&path)
        })
    }

    /// Lengths (m) of the paths from each start to one goal (m); infinite where there is none.
    ///
    /// # Errors
    /// As [`ShortestPaths::path`].
    pub fn lengths(
        &self,
        from: &[Point2<f64>],
        to: Point2<f64>,
    ) -> Result<Vec<f64>, ShortestPathError> {
        let length = |path: Option<ShortestPath>| path.map_or(f64::INFINITY, |path| path.length);
        let (Ok(graph), Some(goal), [_, _, ..]) = (&*self.graph, self.place(to), from) else {
            return from
                .iter()
                .map(|&from| self.path(from, to).map(length))
                .collect();
        };
        // One search to the goal for all starts.
        let towards = graph.towards(goal);
        let distance = |&from: &Point2<f64>| towards.distance(self.place(from)?);
        Ok(from
            .iter()
            .map(|from| distance(from).unwrap_or(f64::INFINITY))
            .collect())
    }

    fn place(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        free_end(&self.space, self.radius, p)
    }
}

/// The place at which a path of a disc of this radius (m) begins or ends instead of at a point (m): the nearest
/// free one, at most [`END_TOLERANCE`] away.
pub fn free_end(space: &FreeSpace, radius: f64, p: Point2<f64>) -> Option<Point2<f64>> {
    space.free_place(p, radius, END_TOLERANCE)
}

/// The corners of a path (m), the two ends included; empty for a path without legs.
pub fn corners(path: &ShortestPath) -> Vec<Point2<f64>> {
    let first = path.legs.first().map(|leg| leg.at(0.0));
    let last = path.legs.last().map(|leg| leg.at(1.0));
    first
        .into_iter()
        .chain(path.legs.iter().flat_map(bends))
        .chain(last)
        .collect()
}

/// The corners at which a leg bends: the tangents at neighbouring points of an arc meet there, so that the polyline runs
/// outside the arc. A segment ends at a corner only if the next leg is a segment, which happens only where an end
/// was moved.
fn bends(leg: &PathLeg) -> Vec<Point2<f64>> {
    let PathLeg::Arc(arc) = leg else {
        return Vec::new();
    };
    let turn = MAX_TURN.min(2.0 * math::acos(arc.radius / (arc.radius + MAX_OFFSET)));
    let pieces = (arc.sweep.abs() / turn).ceil().max(1.0);
    let half = 0.5 * arc.sweep / pieces;
    let stretch = 1.0 / math::sincos(half).1;
    (0..pieces as usize)
        .map(|i| {
            let on_arc = arc.at((i as f64 + 0.5) / pieces);
            arc.center + (on_arc - arc.center) * stretch
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use geometry::map::{ObstacleSpec, VectorMap, WorldMap};
    use geometry::shape::Shape;

    use super::*;

    /// A room of 4 m with a square block of 1 m in its middle.
    fn map() -> PlannerMap {
        let mut room = VectorMap::empty([-2.0; 2], [2.0; 2], 0.05);
        room.obstacles.push(ObstacleSpec {
            name: String::new(),
            shape: Shape::Rectangle {
                center: [0.0, 0.0],
                half_extents: [0.5, 0.5],
                angle: 0.0,
            },
        });
        let world = WorldMap::from_vectors(&room).unwrap();
        PlannerMap::of_world(&world, 0.2, 1).unwrap()
    }

    #[test]
    fn a_polyline_bends_outside_the_corners_and_its_ends_are_moved_to_free_places() {
        let map = map();
        let paths = ShortestPaths::new(&map, 0.25).unwrap();
        // Along a side, around a corner, along the next side.
        let (from, to) = (Point2::new(-0.75, -0.5), Point2::new(0.5, 0.75));
        let length = 1.0 + 0.25 * FRAC_PI_2 + 1.0;
        assert!((paths.path(from, to).unwrap().unwrap().length - length).abs() < 1e-9);
        let corners = paths.corners(from, to).unwrap();
        assert_eq!((corners[0], *corners.last().unwrap()), (from, to));
        let space = map.space().unwrap();
        for pair in corners.windows(2) {
            assert!(space.segment_is_free(pair[0], pair[1], 0.25 - 1e-9));
        }
        let walked: f64 = corners.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        assert!(walked > length && walked < length + 0.01, "{walked}");
        // Nearer to the wall than the radius, and too deep in the block.
        let (near, deep) = (Point2::new(1.9, 0.0), Point2::new(0.0, 0.0));
        let corners = paths.corners(near, Point2::new(1.75, 1.0)).unwrap();
        assert!((corners[0] - Point2::new(1.75, 0.0)).norm() < 1e-5);
        assert!(paths.corners(near, deep).unwrap().is_empty());
        assert!(
            paths
                .corners(Point2::new(f64::NAN, 0.0), near)
                .unwrap()
                .is_empty()
        );
        assert_eq!(paths.corners(from, from).unwrap(), [from]);
    }

    #[test]
    fn lengths_from_many_starts_are_those_from_each() {
        let map = map();
        let paths = ShortestPaths::new(&map, 0.25).unwrap();
        let goal = Point2::new(0.5, 0.75);
        let starts = [[-0.75, -0.5], [0.0, 0.0], [-1.0, 1.0], [1.5, -1.5]].map(Point2::from);
        let all = paths.lengths(&starts, goal).unwrap();
        for (start, length) in starts.iter().zip(&all) {
            assert_eq!(paths.lengths(&[*start], goal).unwrap(), [*length]);
        }
        assert_eq!(all[1], f64::INFINITY);
        assert!(paths.lengths(&[], goal).unwrap().is_empty());
    }

    #[test]
    fn unusable_radii_are_refused() {
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = ShortestPaths::new(&map(), radius).unwrap_err();
            assert!(matches!(
                refused,
                ShortestPathError::Graph(GraphError::Radius(_))
            ));
        }
    }
}
