//! Corners at which shortest paths bend.

use nalgebra::{Point2, Vector2};

use super::lattice::{Lattice, NONE};
use planner_view::map::PlannerMap;

/// Maximum number of bends of a lattice; above it (a map of rubble) differences handle the rest.
const MAX_BENDS: usize = 1 << 13;

/// The four diagonal steps.
const DIAGONALS: [(i64, i64); 4] = [(1, 1), (-1, 1), (-1, -1), (1, -1)];

/// Cosine of the angle (37°) from the outward line of a corner within which targets are left out:
/// straight ahead of a corner no shortest path bends.
const AHEAD: f64 = 0.8;

/// A place visible from a bend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Node or bend.
    pub(super) to: u32,
    /// The node next to it on the straight line back; [`NONE`] next to the bend.
    pub(super) back: u32,
    /// Distance (m).
    pub(super) distance: f32,
}

/// The convex corners of obstacles, grown by the robot's radius, with the places visible from them.
///
/// Differences are worst where a wave turns around a corner: its curvature there is that of a new
/// source. So each corner is a source that starts when the wave reaches it.
#[derive(Debug, Clone, Default)]
pub struct Bends {
    points: Vec<Point2<f64>>,
    /// Per node, the bend that it belongs to, or [`NONE`].
    of_node: Vec<u32>,
    /// Per bend, the index of its first target; one more for the end of the last.
    first: Vec<u32>,
    targets: Vec<Target>,
}

impl Bends {
    /// Finds the bends of a lattice, with targets up to `sight` (m).
    pub(super) fn new(map: &PlannerMap, lattice: &Lattice, sight: f64) -> Self {
        let mut bends = Self {
            of_node: vec![NONE; lattice.len()],
            ..Self::default()
        };
        let outwards = bends.find(map, lattice);
        let radius = lattice.sight_radius(map);
        for (bend, (&from, outward)) in bends.points.iter().zip(&outwards).enumerate() {
            bends.first.push(bends.targets.len() as u32);
            let begin = bends.targets.len();
            let mut add = |to: usize, point: Point2<f64>, distance: f64| {
                let ahead = (point - from).dot(outward) > AHEAD * distance;
                let step = lattice.pitch();
                // The nearest nodes count as visible: the wave would reach them anyway.
                if distance > step && (ahead || !map.line_is_clear(from, point, radius)) {
                    return;
                }
                let back = if distance > 1.5 * step {
                    let nearer = point + (from - point) * (step / distance);
                    lattice.node_at(nearer).filter(|&back| back != to)
                } else {
                    None
                };
                bends.targets.push(Target {
                    to: to as u32,
                    back: back.map_or(NONE, |back| back as u32),
                    distance: distance as f32,
                });
            };
            lattice.for_each_within(from, sight, |node, distance| {
                if let Some(point) = lattice.point(node) {
                    add(node, point, distance);
                }
            });
            for (other, &point) in bends.points.iter().enumerate() {
                let distance = (point - from).norm();
                if other != bend && distance <= sight {
                    add(lattice.len() + other, point, distance);
                }
            }
            // The nearest first: the `back` of a target must be known before the target.
            bends.targets[begin..].sort_by(|a, b| a.distance.total_cmp(&b.distance));
        }
        bends.first.push(bends.targets.len() as u32);
        bends
    }

    /// Finds the corners; returns the outward direction of each.
    fn find(&mut self, map: &PlannerMap, lattice: &Lattice) -> Vec<Vector2<f64>> {
        let mut tips: Vec<Point2<f64>> = Vec::new();
        let mut outwards: Vec<Vector2<f64>> = Vec::new();
        for node in 0..lattice.len() {
            let is_corner = DIAGONALS.iter().any(|&(dx, dy)| {
                lattice.beside(node, dx, dy).is_none()
                    && lattice.beside(node, dx, 0).is_some()
                    && lattice.beside(node, 0, dy).is_some()
            });
            let found = lattice.point(node).filter(|_| is_corner);
            let Some((center, away)) = found.and_then(|p| Some((p, map.away_from_obstacles(p)?)))
            else {
                continue;
            };
            let tip = center - away * map.clearance(center);
            let near = 0.5 * lattice.pitch();
            let known = tips.iter().position(|other| (other - tip).norm() < near);
            if let Some(bend) = known {
                // A corner that several nodes see points to their middle.
                outwards[bend] += away;
                self.of_node[node] = bend as u32;
            } else if tips.len() < MAX_BENDS {
                self.of_node[node] = tips.len() as u32;
                tips.push(tip);
                outwards.push(away);
            }
        }
        for (tip, outward) in tips.iter().zip(&mut outwards) {
            let norm = outward.norm();
            if norm > 0.0 {
                *outward /= norm;
            }
            self.points.push(tip + *outward * lattice.radius());
        }
        outwards
    }

    /// Number of bends.
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// Positions of the bends (m).
    pub(super) fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The bend beside a node.
    pub(super) fn beside(&self, node: usize) -> Option<usize> {
        let bend = *self.of_node.get(node)?;
        (bend != NONE).then_some(bend as usize)
    }

    /// The places visible from a bend, the nearest first.
    pub(super) fn targets(&self, bend: usize) -> &[Target] {
        match (self.first.get(bend), self.first.get(bend + 1)) {
            (Some(&first), Some(&end)) => self
                .targets
                .get(first as usize..end as usize)
                .unwrap_or_default(),
            _ => &[],
        }
    }
}
