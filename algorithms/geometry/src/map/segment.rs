//! Distance of a moving disc from the pieces, along segments and arcs.

use nalgebra::Point2;

use super::ShapeMap;
use super::index::edge_distance;
use crate::shape::ShortArc;

/// Depth (m) to which a disc may penetrate and still only touch: far above the rounding of tangents at map
/// coordinates, far below the world's own contact distance (10⁻⁷ m).
pub const TOUCHING: f64 = 1e-9;

/// Maximum number of halvings of a stretch; far more than any map needs before the exact test applies.
const MAX_DEPTH: u32 = 40;

/// Result of a look-up in the clearance field for a stretch.
enum Verdict {
    Clear,
    Blocked,
    /// Pieces are near: the exact test is needed.
    Near,
    /// The stretch is too long for one look-up.
    TooLong,
}

impl ShapeMap {
    /// Returns `true` if a disc of this radius (m) can travel straight from `a` to `b`: every point of the
    /// segment is at least `radius` from all pieces and the edge of the map, except for [`TOUCHING`].
    /// `false` for points that are not finite.
    ///
    /// # Performance
    /// The clearance field decides wherever it can, by halving; the exact geometry of the few near pieces
    /// is needed only along walls and at corners.
    pub fn segment_is_clear(&self, a: Point2<f64>, b: Point2<f64>, radius: f64) -> bool {
        let radius = radius - TOUCHING;
        let inside = edge_distance(&self.bounds, a) >= radius
            && edge_distance(&self.bounds, b) >= radius
            && radius.is_finite();
        inside && self.stretch_is_clear([a, b], 0.5 * (b - a).norm(), radius, 0)
    }

    /// The same for a part of a segment, whose half length (m) is given.
    fn stretch_is_clear(
        &self,
        [a, b]: [Point2<f64>; 2],
        half: f64,
        radius: f64,
        depth: u32,
    ) -> bool {
        let middle = nalgebra::center(&a, &b);
        match self.judge(middle, half, radius, depth) {
            Verdict::Clear => true,
            Verdict::Blocked => false,
            Verdict::TooLong => {
                let half = 0.5 * half;
                self.stretch_is_clear([a, middle], half, radius, depth + 1)
                    && self.stretch_is_clear([middle, b], half, radius, depth + 1)
            }
            Verdict::Near => self.near_are_clear(middle, half + radius, |part| {
                part.segment_is_clear(a, b, radius)
            }),
        }
    }

    /// Returns `true` if a disc of this radius (m) can travel along an arc of at most a half turn, as
    /// [`Self::segment_is_clear`].
    pub fn arc_is_clear(&self, arc: &ShortArc, radius: f64) -> bool {
        let radius = radius - TOUCHING;
        let ends = [arc.start, arc.end].map(|direction| arc.at(direction));
        let finite = ends.iter().all(|p| p.x.is_finite() && p.y.is_finite());
        finite && radius.is_finite() && self.arc_stretch_is_clear(arc, radius, 0)
    }

    fn arc_stretch_is_clear(&self, arc: &ShortArc, radius: f64, depth: u32) -> bool {
        let direction = arc.middle();
        let middle = arc.at(direction);
        // No point of half an arc is farther from the middle than the chord to the end, as long as
        // the half is at most a half turn.
        let half = (middle - arc.at(arc.end))
            .norm()
            .max((middle - arc.at(arc.start)).norm());
        let verdict = self.judge(middle, half, radius, depth);
        let short = arc.start.dot(&arc.end) >= 0.0;
        match verdict {
            Verdict::Clear => true,
            Verdict::Blocked => false,
            Verdict::Near if short => {
                self.is_within_bounds(arc, radius)
                    && self.near_are_clear(middle, half + radius, |part| {
                        part.arc_is_clear(arc, radius)
                    })
            }
            Verdict::Near | Verdict::TooLong => {
                let halves = [(arc.start, direction), (direction, arc.end)];
                halves.iter().all(|&(start, end)| {
                    let half = ShortArc { start, end, ..*arc };
                    self.arc_stretch_is_clear(&half, radius, depth + 1)
                })
            }
        }
    }

    /// Returns `true` if an arc of at most a quarter turn keeps `radius` from the edge of the map.
    fn is_within_bounds(&self, arc: &ShortArc, radius: f64) -> bool {
        let ends = [arc.start, arc.end];
        let axes = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let extremes = axes
            .iter()
            .map(|&[x, y]| nalgebra::Vector2::new(x, y))
            .filter(|&axis| arc.spans(axis));
        ends.into_iter()
            .chain(extremes)
            .all(|direction| edge_distance(&self.bounds, arc.at(direction)) >= radius)
    }

    /// The verdict of the clearance field on a stretch that lies within `half` (m) of its `middle`.
    fn judge(&self, middle: Point2<f64>, half: f64, radius: f64, depth: u32) -> Verdict {
        let least = self.clearance_at_least(middle);
        if least >= radius + half {
            Verdict::Clear
        } else if least + 2.0 * self.clearance_error < radius && least > f64::NEG_INFINITY {
            Verdict::Blocked
        } else if half + radius <= self.index.reach || depth >= MAX_DEPTH {
            Verdict::Near
        } else if radius >= 0.75 * self.index.reach && half <= 0.25 * radius {
            // A disc that is large for the index: further halving would not help.
            Verdict::Near
        } else {
            Verdict::TooLong
        }
    }

    /// Returns `true` if all pieces within `reach` (m) of a point satisfy a test.
    fn near_are_clear(
        &self,
        middle: Point2<f64>,
        reach: f64,
        test: impl Fn(&crate::shape::Convex) -> bool,
    ) -> bool {
        let clear = |&i: &u32| self.parts.get(i as usize).is_none_or(&test);
        if reach <= self.index.reach {
            self.index.within_reach(middle).iter().all(clear)
        } else {
            let mut near = Vec::new();
            self.parts_in(middle, middle, reach, &mut near);
            near.iter().all(clear)
        }
    }
}
