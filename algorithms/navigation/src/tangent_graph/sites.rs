//! The arcs of the grown pieces that a robot can reach; shortest paths bend around them.

use core::f64::consts::TAU;

use geometry::math;
use geometry::shape::Convex;
use nalgebra::{Point2, Vector2};

use planner_view::free_space::FreeSpace;

/// Arcs narrower than this (rad) are dropped: they result from rounding at the seam between two
/// pieces. A path that would bend by so little passes straight (and penetrates by far less than
/// [`geometry::map::TOUCHING`]).
const MIN_WIDTH: f64 = 1e-6;
/// Angle (rad) by which a tangent point may lie outside its arc and count as the arc's end. It only
/// covers rounding: the segment itself is tested exactly.
const END: f64 = 1e-7;

/// An arc of the border of a grown piece along which the robot's centre can move freely: about a
/// corner (radius: the robot's) or about a disc (radius: both together).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    pub center: Point2<f64>,
    pub radius: f64,
    /// Unit vector from the centre to the arc's clockwise end.
    start: Vector2<f64>,
    /// Unit vector to the counter-clockwise end.
    end: Vector2<f64>,
    /// Direction of `start` (rad).
    pub start_angle: f64,
    /// Angle from `start` to `end` (rad), in (0, 2π].
    pub width: f64,
    /// `true` for a whole circle: `start` is arbitrary, and a path may pass it.
    pub full: bool,
    /// Radius (m) of the piece itself about the centre; 0 for a corner.
    pub core: f64,
}

impl Site {
    fn new(circle: &Circle, from: f64, width: f64, full: bool) -> Self {
        let unit = |angle: f64| {
            let (sin, cos) = math::sincos(angle);
            Vector2::new(cos, sin)
        };
        Self {
            center: circle.center,
            radius: circle.radius,
            start: unit(from),
            end: unit(from + width),
            start_angle: from,
            width,
            full,
            core: circle.core,
        }
    }

    /// Returns `true` if the direction `n` (a unit vector) meets the arc, except for rounding.
    #[inline]
    fn meets(&self, n: Vector2<f64>) -> bool {
        let (after, before) = (self.start.perp(&n) >= -END, n.perp(&self.end) >= -END);
        // Both half-planes for less than a half turn (on the arc's side), one of them for more.
        if self.width <= core::f64::consts::PI {
            after && before && (self.width > 1.0 || n.dot(&self.start) > 0.0)
        } else {
            self.full || after || before
        }
    }

    /// Position at which the direction `n` (a unit vector) meets the arc, as the angle from its
    /// start (rad); `None` if it does not.
    #[inline]
    pub fn angle_of(&self, n: Vector2<f64>) -> Option<f64> {
        if !self.meets(n) {
            return None;
        }
        let angle = math::atan2(self.start.perp(&n), self.start.dot(&n));
        if self.full {
            return Some(if angle < 0.0 { angle + TAU } else { angle });
        }
        // Just before the start counts as the start; a wide arc goes on past a half turn.
        let angle = if angle < -2.0 * END {
            angle + TAU
        } else {
            angle
        };
        (angle <= self.width + 2.0 * END).then(|| angle.clamp(0.0, self.width))
    }

    /// Largest and smallest value of `offset · n` over the directions `n` of the arc.
    pub fn span_along(&self, offset: Vector2<f64>) -> (f64, f64) {
        let norm = offset.norm();
        if self.full || norm == 0.0 {
            return (norm, -norm);
        }
        let (a, b) = (offset.dot(&self.start), offset.dot(&self.end));
        let high = if self.meets(offset / norm) {
            norm
        } else {
            a.max(b)
        };
        let low = if self.meets(-offset / norm) {
            -norm
        } else {
            a.min(b)
        };
        (high, low)
    }
}

/// A circle and the index of its piece.
struct Circle {
    center: Point2<f64>,
    radius: f64,
    core: f64,
    /// Index of the piece that it belongs to.
    part: usize,
}

/// All arcs around the pieces of a space grown by `radius` (m), at most `limit` of them and one.
pub fn find(space: &FreeSpace, radius: f64, limit: usize) -> Vec<Site> {
    let mut sites = Vec::new();
    for (part, piece) in space.shapes().parts().iter().enumerate() {
        if let Convex::Disc { center, radius: r } = piece {
            let circle = Circle {
                center: *center,
                radius: r + radius,
                core: *r,
                part,
            };
            arcs(space, radius, &circle, None, &mut sites);
        } else {
            let corners = piece.corners();
            let n = corners.len();
            for i in 0..n {
                let (before, at) = (corners[(i + n - 1) % n], corners[i]);
                let after = corners[(i + 1) % n];
                let normal = |d: Vector2<f64>| math::atan2(-d.x, d.y);
                let (from, to) = (normal(at - before), normal(after - at));
                let width = math::angle_difference(to, from);
                if width > MIN_WIDTH {
                    let circle = Circle {
                        center: at,
                        radius,
                        core: 0.0,
                        part,
                    };
                    arcs(space, radius, &circle, Some((from, width)), &mut sites);
                }
            }
        }
        if sites.len() > limit {
            break;
        }
    }
    without_twins(sites)
}

/// The free arcs of a circle within a cone (first direction and width (rad)), or all around.
fn arcs(
    space: &FreeSpace,
    radius: f64,
    circle: &Circle,
    cone: Option<(f64, f64)>,
    found: &mut Vec<Site>,
) {
    let borders = borders(space, radius, circle);
    let point = |angle: f64| {
        let (sin, cos) = math::sincos(angle);
        circle.center + Vector2::new(cos, sin) * circle.radius
    };
    let is_free = |angle: f64| space.is_free(point(angle), radius);
    let Some((from, width)) = cone.or_else(|| seam(&borders, is_free)) else {
        // Nothing crosses the circle: all or none of it is free.
        if is_free(0.0) && borders.iter().all(|&border| is_free(border)) {
            found.push(Site::new(circle, 0.0, TAU, true));
        }
        return;
    };
    let mut stops: Vec<f64> = borders
        .iter()
        .map(|&border| (border - from).rem_euclid(TAU))
        .filter(|&stop| stop < width)
        .collect();
    stops.extend([0.0, width]);
    stops.sort_by(f64::total_cmp);
    let mut open: Option<f64> = None;
    for pair in stops.windows(2) {
        let &[a, b] = pair else { continue };
        // A gap without width belongs to its surroundings.
        if b - a <= MIN_WIDTH {
            continue;
        }
        match (is_free(from + 0.5 * (a + b)), open) {
            (true, None) => open = Some(a),
            (false, Some(begun)) => {
                push(circle, from, begun, a, found);
                open = None;
            }
            _ => {}
        }
    }
    if let Some(begun) = open {
        push(circle, from, begun, width, found);
    }
}

fn push(circle: &Circle, from: f64, begun: f64, ended: f64, found: &mut Vec<Site>) {
    if ended - begun > MIN_WIDTH {
        found.push(Site::new(circle, from + begun, ended - begun, false));
    }
}

/// The angle at which to cut a circle open: the end of a stretch that is not free, so that no free
/// arc is cut; `None` if there is no such stretch.
fn seam(borders: &[f64], is_free: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let mut sorted: Vec<f64> = borders.iter().map(|b| b.rem_euclid(TAU)).collect();
    sorted.sort_by(f64::total_cmp);
    let first = *sorted.first()?;
    let next = sorted.iter().copied().skip(1).chain([first + TAU]);
    sorted
        .iter()
        .copied()
        .zip(next)
        .find(|&(a, b)| b - a > MIN_WIDTH && !is_free(0.5 * (a + b)))
        .map(|(_, end)| (end, TAU))
}

/// Directions (rad) in which a point of the circle is `radius` from a piece or the edge: between
/// two neighbouring ones, an arc is free as a whole or not at all. More than needed does no harm.
fn borders(space: &FreeSpace, radius: f64, circle: &Circle) -> Vec<f64> {
    let mut borders = Vec::new();
    let Circle {
        center,
        radius: own,
        ..
    } = *circle;
    let mut add = |toward: Vector2<f64>, cos: f64| {
        if (-1.0..=1.0).contains(&cos) {
            let (middle, half) = (math::atan2(toward.y, toward.x), math::acos(cos));
            borders.extend([middle - half, middle + half]);
        }
    };
    // A line with this unit normal, at this height below the centre, that is to stay `radius` away.
    let mut facing = |normal: Vector2<f64>, height: f64| add(normal, (radius - height) / own);
    let bounds = space.bounds();
    let (low, high) = (center - bounds.min, bounds.max - center);
    facing(Vector2::x(), low.x);
    facing(-Vector2::x(), high.x);
    facing(Vector2::y(), low.y);
    facing(-Vector2::y(), high.y);
    let mut buffer = Vec::new();
    let near = space
        .shapes()
        .parts_within(center, own + radius, &mut buffer);
    for part in near.iter().map(|&i| i as usize) {
        let piece = match space.shapes().parts().get(part) {
            Some(piece) if part != circle.part => piece,
            _ => continue,
        };
        let core = match piece {
            Convex::Disc { radius, .. } => *radius,
            _ => 0.0,
        };
        let corners = piece.corners();
        for (i, &corner) in corners.iter().enumerate() {
            let offset = corner - center;
            let (d, reach) = (offset.norm(), core + radius);
            if d > 0.0 {
                add(
                    offset,
                    (d * d + own * own - reach * reach) / (2.0 * d * own),
                );
            }
            let side = corners[(i + 1) % corners.len()] - corner;
            let length = side.norm();
            if length > 0.0 {
                let normal = Vector2::new(side.y, -side.x) / length;
                add(normal, (radius + offset.dot(&normal)) / own);
            }
        }
    }
    borders
}

/// Drops duplicate arcs: corners that two pieces share.
fn without_twins(mut sites: Vec<Site>) -> Vec<Site> {
    // To a tenth of a micrometre, so that rounding does not separate duplicates.
    let key = |s: &Site| {
        [s.center.x, s.center.y, s.radius, s.start_angle].map(|value| (value * 1e7).round())
    };
    sites.sort_by(|a, b| {
        let pairs = key(a).into_iter().zip(key(b));
        pairs.fold(core::cmp::Ordering::Equal, |order, (a, b)| {
            order.then(a.total_cmp(&b))
        })
    });
    sites.dedup_by(|b, a| {
        (a.center - b.center).norm() < 1e-9
            && (a.radius - b.radius).abs() < 1e-9
            && a.full == b.full
            && (a.start - b.start).norm() < 1e-9
            && (a.width - b.width).abs() < 1e-9
    });
    sites
}
