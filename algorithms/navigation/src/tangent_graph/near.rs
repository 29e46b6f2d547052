//! The sites that a point may see, by position.

use std::sync::OnceLock;

use geometry::map::TOUCHING;
use geometry::shape::{Aabb, Convex};
use nalgebra::{Point2, Vector2};

use super::graph::{self, Graph};
use super::sites::Site;
use super::tangent;
use planner_view::free_space::FreeSpace;

/// Cells along the longer side of the map. Smaller cells have shorter lists, and more of them.
const CELLS: usize = 64;
/// Depth (m) to which a line must enter a piece to count as hidden behind it.
const DEPTH: f64 = 1e-5;
/// Depth (m) inside a circle at which a point counts as on it; free points may be this deep.
const ON: f64 = 2.0 * TOUCHING;

/// A tangent from a point that joins a track; not yet tested for collisions.
#[derive(Debug, Clone, Copy)]
pub struct Join {
    /// The track.
    pub track: u32,
    /// Position of landing on the track (rad).
    pub at: f64,
    /// Length of the tangent (m).
    pub length: f64,
    /// Touching point (m).
    pub touch: Point2<f64>,
}

/// Lists of sites for the cells of a coarse grid. The first query from a cell makes its list; the
/// list depends on the cell only.
#[derive(Debug)]
pub struct Near {
    origin: Point2<f64>,
    side: f64,
    width: usize,
    height: usize,
    lists: Vec<OnceLock<Box<[u32]>>>,
}

impl Near {
    pub fn new(bounds: &Aabb) -> Self {
        let size = bounds.max - bounds.min;
        let side = size.x.max(size.y) / CELLS as f64;
        let count = |length: f64| ((length / side).ceil() as usize).clamp(1, CELLS);
        let (width, height) = (count(size.x), count(size.y));
        Self {
            origin: bounds.min,
            side,
            width,
            height,
            lists: core::iter::repeat_with(OnceLock::new)
                .take(width * height)
                .collect(),
        }
    }

    /// The sites that a robot at `p` might have a free tangent to.
    fn sites(&self, space: &FreeSpace, graph: &Graph, p: Point2<f64>) -> &[u32] {
        let col = (((p.x - self.origin.x) / self.side) as usize).min(self.width - 1);
        let row = (((p.y - self.origin.y) / self.side) as usize).min(self.height - 1);
        self.lists[row * self.width + col].get_or_init(|| {
            let corner = Vector2::new(col as f64, row as f64) * self.side;
            let min = self.origin + corner;
            let max = min + Vector2::new(self.side, self.side);
            let cell = Cell::new(min, max);
            let sites = graph.sites.iter().enumerate();
            sites
                .filter(|(_, site)| cell.may_see(space, site))
                .map(|(i, _)| i as u32)
                .collect()
        })
    }

    /// The tangents from a point to tracks: all free ones, and possibly others.
    pub fn joins(&self, space: &FreeSpace, graph: &Graph, p: Point2<f64>, found: &mut Vec<Join>) {
        found.clear();
        for &i in self.sites(space, graph, p) {
            let site = &graph.sites[i as usize];
            let tangents = tangent::from_point(p, site.center, site.radius, ON);
            let Some((length, touches)) = tangents else {
                continue;
            };
            for (normal, turn) in touches.into_iter().zip([1.0, -1.0]) {
                let Some(angle) = site.angle_of(normal) else {
                    continue;
                };
                let track = graph::track(i, turn);
                found.push(Join {
                    track,
                    at: graph.place(track, angle),
                    length,
                    touch: if length > 0.0 {
                        site.center + normal * site.radius
                    } else {
                        p
                    },
                });
            }
        }
    }
}

/// A cell of the grid.
struct Cell {
    corners: [Point2<f64>; 4],
    middle: Point2<f64>,
    half_diagonal: f64,
}

impl Cell {
    fn new(min: Point2<f64>, max: Point2<f64>) -> Self {
        // Slightly larger, for points that rounding puts into the wrong cell.
        let hair = Vector2::new(1e-9, 1e-9);
        let (min, max) = (min - hair, max + hair);
        Self {
            corners: [
                min,
                Point2::new(max.x, min.y),
                max,
                Point2::new(min.x, max.y),
            ],
            middle: nalgebra::center(&min, &max),
            half_diagonal: 0.5 * (max - min).norm(),
        }
    }

    /// Returns `true` if some point of the cell might have a free tangent to the site.
    fn may_see(&self, space: &FreeSpace, site: &Site) -> bool {
        // A tangent from p touches in a direction n with (p − c)·n = r. Over the arc, the left side
        // takes all values between its extremes, and within the cell it changes by no more than
        // the half diagonal.
        let (high, low) = site.span_along(self.middle - site.center);
        let slack = self.half_diagonal + super::PUSH_OUT;
        if low > site.radius + slack || high < site.radius - slack {
            return false;
        }
        !self.is_hidden(space, site)
    }

    /// Returns `true` if one piece hides the site from the whole cell.
    ///
    /// Let p see the touching point t of a corner v: all of p t is at least the robot's radius r
    /// from any piece. The point of p v at the same part λ of the way is λ r nearer at most, hence
    /// outside of the piece. So p cannot see t if p v goes through a piece. The points that a
    /// convex piece hides from v are a convex set: a point behind it stays behind it when moved
    /// away from v, and between two such points the lines to v sweep over chords of the piece. So
    /// it hides the whole cell if it hides its corners. For a disc, v is any point of the disc
    /// itself, and the same holds with the roles exchanged: the corners of a square around it stand
    /// for all.
    fn is_hidden(&self, space: &FreeSpace, site: &Site) -> bool {
        let half = site.core;
        let targets: &[Vector2<f64>] = if half > 0.0 {
            &[
                Vector2::new(-half, -half),
                Vector2::new(half, -half),
                Vector2::new(half, half),
                Vector2::new(-half, half),
            ]
        } else {
            &[Vector2::new(0.0, 0.0)]
        };
        let Some(part) = first_between(space, self.middle, site.center) else {
            return false;
        };
        let piece = match space.shapes().parts().get(part as usize) {
            // A disc does not hide its own border.
            Some(Convex::Disc { center, .. }) if half > 0.0 && *center == site.center => {
                return false;
            }
            Some(piece) => piece,
            None => return false,
        };
        // Touching the line does not hide: the line must enter the piece to some depth.
        targets.iter().all(|&target| {
            let v = site.center + target;
            self.corners
                .iter()
                .all(|&corner| !piece.segment_is_clear(corner, v, -DEPTH))
        })
    }
}

/// The first piece between one point and another.
fn first_between(space: &FreeSpace, from: Point2<f64>, to: Point2<f64>) -> Option<u32> {
    let line = to - from;
    let length = line.norm();
    if length == 0.0 {
        return None;
    }
    space.shapes().first_hit(from, line / length, length)?.part
}
