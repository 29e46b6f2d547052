//! The path of a wave.

use nalgebra::Point2;

use super::march::Wave;
use super::medium::Medium;

/// The eight steps to the cells around one.
const STEPS: [(i64, i64); 8] = [
    (1, 0),
    (0, 1),
    (-1, 0),
    (0, -1),
    (1, 1),
    (-1, 1),
    (-1, -1),
    (1, -1),
];

impl Wave {
    /// The corners of the path (m) from a source of the wave to a node, the node's centre included and
    /// the source's position not. `path` is cleared first, and stays empty if the wave does not reach
    /// the node or has sources of several speeds.
    ///
    /// Near sources and bends the path is straight; its corners are the bends. Elsewhere it goes back
    /// cell by cell to the neighbour with the earliest time relative to the distance between them (of
    /// equal ones, the lowest number).
    pub fn path_to(&self, medium: &Medium, node: usize, path: &mut Vec<Point2<f64>>) {
        path.clear();
        if !self.has_one_speed() || !self.time(node).is_finite() {
            return;
        }
        let mut at = Some(node);
        while let Some(place) = at {
            path.extend(medium.point(place));
            let (origin, straight) = self.origin(place);
            let down = (!straight).then(|| self.steepest(medium, place)).flatten();
            // Times fall along the path, and an origin is decided before the place: it ends.
            at = down.or(origin);
        }
        path.reverse();
    }

    /// The neighbour of a node at which the times fall most steeply.
    fn steepest(&self, medium: &Medium, node: usize) -> Option<usize> {
        let lattice = medium.lattice();
        let time = self.time(node);
        let reached = |dx: i64, dy: i64| {
            let beside = lattice.beside(node, dx, dy)?;
            let time = self.time(beside);
            time.is_finite().then_some((beside, time))
        };
        let mut best: Option<(f32, usize)> = None;
        for (dx, dy) in STEPS {
            let Some((next, earlier)) = reached(dx, dy) else {
                continue;
            };
            let diagonal = dx != 0 && dy != 0;
            // Not across the corner of an obstacle.
            if earlier >= time
                || (diagonal && (reached(dx, 0).is_none() || reached(0, dy).is_none()))
            {
                continue;
            }
            let length = if diagonal {
                core::f32::consts::SQRT_2
            } else {
                1.0
            };
            let slope = (time - earlier) / length;
            if best.is_none_or(|(steepest, other)| {
                slope > steepest || (slope == steepest && next < other)
            }) {
                best = Some((slope, next));
            }
        }
        best.map(|(_, next)| next)
    }
}
