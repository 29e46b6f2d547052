//! Convex pieces as rectangles around their slabs.

use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;

/// Halvings in the search for the maximum thickness of a slab.
const HALVINGS: usize = 50;

/// Appends rectangles that together contain a convex piece and of which no point is farther than `tolerance`
/// (m) (≥ [`MIN_TOLERANCE`](super::MIN_TOLERANCE)) from it; an axis-aligned rectangle stays unchanged. Stops
/// early beyond `most` rectangles in `out`.
///
/// The piece is cut across the axis that needs fewer cuts. Each slab is as thick as the tolerance allows: the
/// distance from a convex piece is a convex function, so that its maximum on a rectangle is at a corner, and it
/// grows with the thickness. The distance is at most the thickness, so that every slab is at least as thick as
/// the tolerance (except the last).
pub fn cover(piece: &Convex, tolerance: f64, most: usize, out: &mut Vec<Aabb>) {
    let limit = most.saturating_sub(out.len());
    let lying = slabs(piece, 1, tolerance, limit);
    let standing = slabs(piece, 0, tolerance, limit);
    out.extend(if standing.len() < lying.len() {
        standing
    } else {
        lying
    });
}

/// Slabs between planes across `axis`; at most `limit` + 1.
fn slabs(piece: &Convex, axis: usize, tolerance: f64, limit: usize) -> Vec<Aabb> {
    let whole = piece.aabb();
    let (mut low, top) = (whole.min[axis], whole.max[axis]);
    let mut slabs = Vec::new();
    while low < top && slabs.len() <= limit {
        let fits = |high: f64| {
            rectangle(piece, axis, low, high)
                .is_none_or(|r| corners(&r).iter().all(|&c| piece.distance(c) <= tolerance))
        };
        let high = if fits(top) {
            top
        } else {
            let (mut good, mut bad) = ((low + tolerance).min(top), top);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (good + bad);
                if fits(middle) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            good
        };
        slabs.extend(rectangle(piece, axis, low, high));
        low = high;
    }
    slabs
}

/// The rectangle around the part of a piece between two planes.
fn rectangle(piece: &Convex, axis: usize, low: f64, high: f64) -> Option<Aabb> {
    let (least, greatest) = piece.extent_in_band(axis, low, high)?;
    let point = |along: f64, across: f64| {
        if axis == 0 {
            Point2::new(along, across)
        } else {
            Point2::new(across, along)
        }
    };
    Some(Aabb {
        min: point(low, least),
        max: point(high, greatest),
    })
}

fn corners(r: &Aabb) -> [Point2<f64>; 4] {
    [
        r.min,
        r.max,
        Point2::new(r.min.x, r.max.y),
        Point2::new(r.max.x, r.min.y),
    ]
}
