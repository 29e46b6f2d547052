//! The path of a wave.

use super::lattice::Lattice;
use super::march::Wave;

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
    /// The nodes on the path from a source of the wave to a node, the node included, cell by cell.
    /// `path` is cleared first, and stays empty if the wave does not reach the node.
    ///
    /// From every cell the path goes back to the neighbour with the earliest time relative to the
    /// distance between them (of equal ones, the lowest number): steepest descent of the arrival
    /// times, whose only minima are the sources.
    pub fn way_to(&self, lattice: &Lattice, node: usize, path: &mut Vec<usize>) {
        path.clear();
        let mut at = node;
        let mut time = self.time(at);
        while time.is_finite() {
            path.push(at);
            let mut best: Option<(f32, usize, f32)> = None;
            for (dx, dy) in STEPS {
                let reached = |dx: i64, dy: i64| {
                    let beside = lattice.beside(at, dx, dy)?;
                    let time = self.time(beside);
                    time.is_finite().then_some((beside, time))
                };
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
                let steeper = best.is_none_or(|(steepest, other, _)| {
                    slope > steepest || (slope == steepest && next < other)
                });
                if steeper {
                    best = Some((slope, next, earlier));
                }
            }
            let Some((_, next, earlier)) = best else {
                break;
            };
            at = next;
            time = earlier;
        }
        path.reverse();
    }
}
