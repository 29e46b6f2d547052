//! Sources of a wave.

use nalgebra::Point2;

use super::medium::Medium;
use planner_view::map::PlannerMap;

/// Maximum distance (m) from a source at which a free cell is searched for, if none is visible from it.
const SEARCH_RADIUS: f64 = 1.0;

/// A robot from which a wave starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Position (m).
    pub at: Point2<f64>,
    /// Speed (m/s), ≥ 0; 0 for a source that cannot leave its place.
    pub speed: f64,
    /// Time at which it starts (s), ≥ 0.
    pub delay: f64,
    /// Radius (m), ≥ 0, within which it reaches all places at once.
    pub reach: f64,
    /// Value of [`Wave::label`](super::Wave::label) for the places that it reaches first.
    pub label: u32,
}

impl Source {
    /// A source that starts at time 0, without reach.
    pub fn new(at: Point2<f64>, speed: f64, label: u32) -> Self {
        Self {
            at,
            speed,
            delay: 0.0,
            reach: 0.0,
            label,
        }
    }

    /// Returns `true` if all its numbers are finite and in their range.
    pub fn is_sane(&self) -> bool {
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        self.at.x.is_finite()
            && self.at.y.is_finite()
            && not_negative(self.speed)
            && not_negative(self.delay)
            && not_negative(self.reach)
    }

    fn time_to(&self, distance: f64) -> f64 {
        let distance_left = distance - self.reach;
        if distance_left <= 0.0 {
            self.delay
        } else {
            // Infinite for a source without speed.
            self.delay + distance_left / self.speed
        }
    }
}

/// Distance from a source (m) within which times are computed along straight lines instead of by
/// differences.
const EXACT_RADIUS: f64 = 1.0;

/// The same distance around corners (m): longer than the edges of usual obstacles, so that the next
/// corner is visible from each corner.
pub const SIGHT: f64 = 3.0;

/// A node or bend with a time known without a wave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seed {
    pub(super) time: f32,
    pub(super) node: u32,
    pub(super) label: u32,
    /// The next node on the straight line back, unless that is the source's own.
    pub(super) back: Option<u32>,
}

/// Collects the nodes and bends visible near a source; if there is none, the nearest free cell.
pub fn collect(medium: &Medium, map: &PlannerMap, source: &Source, seeds: &mut Vec<Seed>) {
    let lattice = medium.lattice();
    let pitch = lattice.pitch();
    // A robot that touches a wall may be in a cell whose centre is too near to the wall. A robot inside
    // a wall sees no cell.
    let radius = lattice
        .sight_radius(map)
        .min(map.cell_clearance(source.at))
        .max(1e-6);
    let before = seeds.len();
    let mut add = |node: usize, distance: f64, back: Option<usize>| {
        let time = source.time_to(distance);
        if time.is_finite() {
            seeds.push(Seed {
                time: time as f32,
                node: node as u32,
                label: source.label,
                back: back.map(|back| back as u32),
            });
        }
    };
    let mut see = |node: usize, point: Point2<f64>, distance: f64| {
        // Neighbours of the source's cell need no test: the wave would reach them anyway.
        if distance <= pitch {
            add(node, distance, None);
        } else if map.line_is_clear(source.at, point, radius) {
            let nearer = point + (source.at - point) * (pitch / distance);
            let back = lattice.node_at(nearer).filter(|&back| back != node);
            add(node, distance, back.filter(|_| distance > 1.5 * pitch));
        }
    };
    lattice.for_each_within(source.at, source.reach + EXACT_RADIUS, |node, distance| {
        if let Some(point) = lattice.point(node) {
            see(node, point, distance);
        }
    });
    for (bend, &point) in medium.bends().points().iter().enumerate() {
        let distance = (point - source.at).norm();
        if distance <= source.reach + SIGHT {
            see(lattice.len() + bend, point, distance);
        }
    }
    if seeds.len() == before
        && let Some(node) = lattice.nearest(source.at, source.reach + SEARCH_RADIUS)
        && let Some(point) = lattice.point(node)
    {
        let time = source.time_to((point - source.at).norm());
        if time.is_finite() {
            seeds.push(Seed {
                time: time as f32,
                node: node as u32,
                label: source.label,
                back: None,
            });
        }
    }
}
