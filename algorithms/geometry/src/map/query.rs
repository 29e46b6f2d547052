//! Exact queries of the map.

use nalgebra::{Point2, Vector2};

use super::ShapeMap;
use super::index::edge_distance;
use crate::shape::Contact;

/// Distance beyond the border of a bucket (m) at which a hit still counts as inside: above the rounding
/// of the border crossings, below the tolerance with which pieces are listed.
const BORDER: f64 = 1e-10;

/// First hit of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray (m).
    pub distance: f64,
    /// Index of the piece; `None` for the edge of the map.
    pub part: Option<u32>,
}

impl ShapeMap {
    /// Distance (m) from a point to the nearest obstacle or the edge of the map; 0 in an obstacle,
    /// beyond the edge, and for a point that is not finite.
    pub fn distance(&self, p: Point2<f64>) -> f64 {
        let mut distance = edge_distance(&self.bounds, p);
        if distance > 0.0 {
            for &i in self.index.nearest(p) {
                distance = distance.min(self.parts[i as usize].distance(p));
            }
            distance
        } else {
            0.0
        }
    }

    /// A lower bound (m) on [`Self::distance`] from the clearance field alone: one look-up, at most √2
    /// cells (plus rounding) below the true distance. A negative value gives no information.
    #[inline]
    pub fn clearance_at_least(&self, p: Point2<f64>) -> f64 {
        let frame = &self.clearance.frame;
        let col = (p.x - frame.origin.x) * self.inverse_resolution;
        let row = (p.y - frame.origin.y) * self.inverse_resolution;
        // False for NaN, too.
        let inside =
            col >= 0.0 && row >= 0.0 && col < frame.width as f64 && row < frame.height as f64;
        if inside {
            let cell = row as usize * frame.width + col as usize;
            f64::from(self.clearance.cells[cell]) - self.clearance_error
        } else {
            f64::NEG_INFINITY
        }
    }

    /// Returns `true` if a disc of this radius (m) about a point touches no obstacle, by the field where
    /// it decides, by exact geometry elsewhere.
    pub fn is_clear(&self, p: Point2<f64>, radius: f64) -> bool {
        self.clearance_at_least(p) >= radius || self.distance(p) >= radius
    }

    /// The nearest surface of a point inside or outside obstacles; the edge of the map counts as one.
    pub fn nearest_contact(&self, p: Point2<f64>) -> Contact {
        let mut best = Contact {
            distance: f64::INFINITY,
            normal: Vector2::x(),
        };
        let mut consider = |contact: Contact| {
            if contact.distance < best.distance {
                best = contact;
            }
        };
        self.edge_contacts(p).into_iter().for_each(&mut consider);
        for &i in self.index.nearest(p) {
            consider(self.parts[i as usize].contact(p));
        }
        best
    }

    /// The four sides of the map's edge as surfaces.
    pub(crate) fn edge_contacts(&self, p: Point2<f64>) -> [Contact; 4] {
        let (low, high) = (p - self.bounds.min, self.bounds.max - p);
        [
            Contact {
                distance: low.x,
                normal: Vector2::x(),
            },
            Contact {
                distance: high.x,
                normal: -Vector2::x(),
            },
            Contact {
                distance: low.y,
                normal: Vector2::y(),
            },
            Contact {
                distance: high.y,
                normal: -Vector2::y(),
            },
        ]
    }

    /// Returns the pieces within `reach` (m) of a point, and possibly some beyond; one look-up up to
    /// [`Self::cheap_reach`]. `buffer` is memory for more.
    pub fn parts_within<'a>(
        &'a self,
        p: Point2<f64>,
        reach: f64,
        buffer: &'a mut Vec<u32>,
    ) -> &'a [u32] {
        if reach <= self.index.reach {
            self.index.within_reach(p)
        } else {
            self.parts_in(p, p, reach, buffer);
            buffer
        }
    }

    /// Collects, in order, the pieces in buckets that the rectangle spanned by two points and
    /// grown by `reach` (m) overlaps.
    pub(super) fn parts_in(
        &self,
        a: Point2<f64>,
        b: Point2<f64>,
        reach: f64,
        found: &mut Vec<u32>,
    ) {
        found.clear();
        let grow = Vector2::new(reach, reach);
        let (col0, row0) = self.index.bucket_at(a.inf(&b) - grow);
        let (col1, row1) = self.index.bucket_at(a.sup(&b) + grow);
        for row in row0..=row1 {
            for col in col0..=col1 {
                found.extend_from_slice(self.index.touching(col, row));
            }
        }
        found.sort_unstable();
        found.dedup();
    }

    /// Radius (m) within which [`Self::parts_within`] needs a single look-up.
    pub fn cheap_reach(&self) -> f64 {
        self.index.reach
    }

    /// Distance (m) along a ray from `origin` in the unit direction `dir` to the first obstacle or
    /// the edge of the map; 0 if the ray starts inside one, `None` if there is none within
    /// `range` (m).
    pub fn cast_ray(&self, origin: Point2<f64>, dir: Vector2<f64>, range: f64) -> Option<f64> {
        self.first_hit(origin, dir, range).map(|hit| hit.distance)
    }

    /// As [`Self::cast_ray`], with the piece that is hit.
    pub fn first_hit(&self, origin: Point2<f64>, dir: Vector2<f64>, range: f64) -> Option<Hit> {
        let at_edge = |distance: f64| Hit {
            distance,
            part: None,
        };
        if !(edge_distance(&self.bounds, origin) > 0.0 && dir.x.is_finite() && dir.y.is_finite()) {
            return Some(at_edge(0.0));
        }
        let (_, edge) = self.bounds.ray_interval(origin, dir);
        let end = edge.min(range);
        let frame = &self.index.frame;
        let (mut col, mut row) = self.index.bucket_at(origin);
        let (mut next_x, step_x) = crossing(origin.x, frame.origin.x, frame.resolution, col, dir.x);
        let (mut next_y, step_y) = crossing(origin.y, frame.origin.y, frame.resolution, row, dir.y);
        let mut hit = at_edge(f64::INFINITY);
        // The nearer of the hit piece and the edge of the map.
        let nearest = |hit: Hit| {
            if hit.distance <= edge {
                hit
            } else {
                at_edge(edge)
            }
        };
        loop {
            for &i in self.index.touching(col, row) {
                if let Some(t) = self.parts[i as usize].ray(origin, dir)
                    && t < hit.distance
                {
                    hit = Hit {
                        distance: t,
                        part: Some(i),
                    };
                }
            }
            let leave = next_x.min(next_y);
            if hit.distance <= leave + BORDER {
                return (hit.distance <= end).then_some(hit);
            }
            if leave >= end {
                // No hit before the edge of the map or the end of the range; a piece that was hit lies
                // beyond.
                return Some(nearest(hit)).filter(|hit| hit.distance <= range);
            }
            if next_x < next_y {
                col = if dir.x > 0.0 {
                    col + 1
                } else {
                    col.wrapping_sub(1)
                };
                next_x += step_x;
            } else {
                row = if dir.y > 0.0 {
                    row + 1
                } else {
                    row.wrapping_sub(1)
                };
                next_y += step_y;
            }
            if col >= frame.width || row >= frame.height {
                return Some(nearest(hit)).filter(|hit| hit.distance <= range);
            }
        }
    }

    /// Returns `true` if no obstacle lies between two points; `false` if either is in an obstacle or not
    /// finite. Symmetric except for the rounding of a graze.
    pub fn line_of_sight(&self, from: Point2<f64>, to: Point2<f64>) -> bool {
        self.line_of_sight_near(from, to, &mut None)
    }

    /// As [`Self::line_of_sight`], with the same result, and quicker if the rectangle `hidden_by`, which it sets,
    /// still lies between the points: for points that move little between two calls.
    pub fn line_of_sight_near(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
        hidden_by: &mut Option<u32>,
    ) -> bool {
        let last = hidden_by.and_then(|part| self.parts.get(part as usize));
        if last.is_some_and(|part| part.is_surely_between(from, to)) {
            return false;
        }
        let offset = to - from;
        let length = offset.norm();
        if length == 0.0 {
            return self.distance(from) > 0.0;
        }
        let dir = offset / length;
        let hit = self.first_hit(from, dir, length);
        *hidden_by = hit.and_then(|hit| hit.part);
        hit.is_none()
    }
}

/// Distance along the ray to the first border of a bucket along one axis, and from one border to the
/// next.
fn crossing(position: f64, origin: f64, side: f64, bucket: usize, dir: f64) -> (f64, f64) {
    if dir == 0.0 {
        return (f64::INFINITY, f64::INFINITY);
    }
    let border = origin + (bucket + usize::from(dir > 0.0)) as f64 * side;
    ((border - position) / dir, side / dir.abs())
}

#[cfg(test)]
mod tests;
