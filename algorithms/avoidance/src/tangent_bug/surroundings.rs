//! Free space around the centre of a disc robot, from a scan.
//!
//! Every echo of the scan becomes a disc of the robot's radius plus a margin. The distance that the
//! centre can move in each direction before it enters a disc equals the scan of a point robot among
//! obstacles grown by that radius.

use core::f64::consts::TAU;
use std::sync::LazyLock;

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};

use planner_view::view::ScanView;

/// Number of directions, fixed in the world frame for every heading.
pub const DIRECTIONS: usize = 360;

/// Maximum lean away from an obstacle that is too near (sine of the angle).
const MAX_LEAN: f64 = 0.3;

/// Fractions of the margin that are tried where there is too little room.
const MARGINS: [f64; 3] = [1.0, 0.5, 0.1];

static UNITS: LazyLock<Vec<Vector2<f64>>> = LazyLock::new(|| {
    (0..DIRECTIONS)
        .map(|k| {
            let (sin, cos) = math::sincos(k as f64 * (TAU / DIRECTIONS as f64));
            Vector2::new(cos, sin)
        })
        .collect()
});

/// The echo of each beam of a scan, relative to the robot's centre in world axes (m); `None` for a beam
/// without one. Ranges below the minimum count as the minimum (REP-117: −∞); NaN counts as no echo.
pub fn hits(pose: &Pose2, scan: &ScanView<'_>) -> impl Iterator<Item = Option<Vector2<f64>>> {
    let ScanView {
        angle_min,
        angle_increment,
        range_min,
        range_max,
        ranges,
    } = *scan;
    let theta = pose.theta;
    ranges.iter().enumerate().map(move |(beam, &range)| {
        let range = f64::from(range);
        // In this form, NaN is no echo.
        let echo = range <= range_max;
        echo.then(|| {
            let (sin, cos) = math::sincos(theta + angle_min + beam as f64 * angle_increment);
            Vector2::new(cos, sin) * range.max(range_min).max(0.0)
        })
    })
}

/// Appends the echoes of a scan, relative to the robot's centre in world axes (m).
///
/// Where two neighbouring echoes are so close that the robot (of this radius (m)) could not pass
/// between them, points are inserted between them.
pub fn echoes(pose: &Pose2, scan: &ScanView<'_>, radius: f64, into: &mut Vec<Vector2<f64>>) {
    into.clear();
    let mut before: Option<Vector2<f64>> = None;
    let mut first: Option<Vector2<f64>> = None;
    for (beam, hit) in hits(pose, scan).enumerate() {
        if let Some(at) = hit {
            if let Some(before) = before {
                fill(before, at, radius, into);
            }
            into.push(at);
            if beam == 0 {
                first = Some(at);
            }
        }
        before = hit;
    }
    if let (Some(last), Some(first)) = (before, first) {
        fill(last, first, radius, into);
    }
}

fn fill(a: Vector2<f64>, b: Vector2<f64>, radius: f64, into: &mut Vec<Vector2<f64>>) {
    let gap = (b - a).norm();
    let pitch = radius / 4.0;
    if gap < radius && gap > pitch {
        // At most four points: the gap is below the radius.
        let pieces = (gap / pitch).ceil();
        let mut i = 1.0;
        while i < pieces {
            into.push(a + (b - a) * (i / pieces));
            i += 1.0;
        }
    }
}

/// The space around a robot's centre.
#[derive(Debug, Clone, Default)]
pub struct Surroundings {
    pub(super) here: Point2<f64>,
    /// Visible distance in the grown space (m).
    pub(super) reach: f64,
    /// Radius by which echoes are grown (m).
    radius: f64,
    /// Distance below which the robot leans away (m).
    lean_below: f64,
    echoes: Vec<Vector2<f64>>,
    /// Free distance per direction (m), at most `reach`.
    free: Vec<f64>,
    /// The echo that ends each direction.
    owner: Vec<usize>,
}

impl Surroundings {
    /// Updates with a scan made by a robot of this radius (m).
    ///
    /// Between walls that are too near on both sides (inside the margin) the margin (m) is reduced
    /// until a direction is free.
    pub(super) fn look(&mut self, pose: &Pose2, scan: &ScanView<'_>, radius: f64, margin: f64) {
        self.here = pose.position();
        echoes(pose, scan, radius + margin, &mut self.echoes);
        let nearest = self
            .echoes
            .iter()
            .map(Vector2::norm)
            .fold(f64::INFINITY, f64::min);
        for share in MARGINS {
            let grown = radius + share * margin;
            self.grow(scan.range_max, grown, share * margin);
            let squeezed = nearest < grown && self.free.iter().all(|&free| free < margin);
            if !squeezed {
                break;
            }
        }
    }

    /// Computes the free distance of each direction with echoes grown to this radius (m).
    fn grow(&mut self, range: f64, radius: f64, margin: f64) {
        self.radius = radius;
        self.lean_below = radius - 0.25 * margin;
        // An obstacle just beyond the sensor's range stops the centre that much earlier.
        self.reach = (range - radius).max(0.25 * radius);
        self.free.clear();
        self.free.resize(DIRECTIONS, self.reach);
        self.owner.clear();
        self.owner.resize(DIRECTIONS, usize::MAX);
        for (index, &echo) in self.echoes.iter().enumerate() {
            let distance = echo.norm();
            // Directions that the grown echo can block.
            let half = if distance <= radius {
                DIRECTIONS / 4 + DIRECTIONS / 16
            } else {
                let share = math::asin((radius / distance).min(1.0)) / TAU;
                (share * DIRECTIONS as f64) as usize + 2
            };
            let middle = nearest_direction(echo) + DIRECTIONS;
            for k in middle - half..=middle + half {
                let k = k % DIRECTIONS;
                let run = self.entry(echo, distance, UNITS[k]);
                if run < self.free[k] {
                    self.free[k] = run;
                    self.owner[k] = index;
                }
            }
        }
    }

    /// The distance that the centre can move along `unit` before it enters the grown echo (m).
    fn entry(&self, echo: Vector2<f64>, distance: f64, unit: Vector2<f64>) -> f64 {
        let along = echo.dot(&unit);
        if distance <= self.radius {
            // Too near already: do not approach, and lean away if clearly too near.
            let lean = ((self.lean_below - distance) / (0.5 * self.radius)).clamp(0.0, MAX_LEAN);
            return if along > (1e-9 - lean) * distance {
                0.0
            } else {
                f64::INFINITY
            };
        }
        let beside_squared = distance * distance - along * along;
        let inside = self.radius * self.radius - beside_squared;
        if along <= 0.0 || inside <= 0.0 {
            return f64::INFINITY;
        }
        (along - inside.sqrt()).max(0.0)
    }

    /// The distance that the centre can move along a direction (a unit vector) (m), at most the
    /// reach.
    pub(super) fn free_towards(&self, unit: Vector2<f64>) -> f64 {
        let entry = |echo: &Vector2<f64>| self.entry(*echo, echo.norm(), unit);
        self.echoes.iter().map(entry).fold(self.reach, f64::min)
    }

    /// Unit vector of a direction.
    pub(super) fn unit(k: usize) -> Vector2<f64> {
        UNITS[k % DIRECTIONS]
    }

    /// Free distance in a direction (m).
    pub(super) fn free(&self, k: usize) -> f64 {
        self.free.get(k % DIRECTIONS).copied().unwrap_or(self.reach)
    }

    /// Returns `true` if an obstacle within reach ends a direction.
    pub(super) fn is_blocked(&self, k: usize) -> bool {
        self.free(k) < self.reach
    }

    /// End point of a direction (m), world frame.
    pub(super) fn end(&self, k: usize) -> Point2<f64> {
        self.here + Self::unit(k) * self.free(k)
    }

    /// The echo that ends a direction (m), world frame.
    pub(super) fn obstacle(&self, k: usize) -> Option<Point2<f64>> {
        let owner = *self.owner.get(k % DIRECTIONS)?;
        Some(self.here + self.echoes.get(owner)?)
    }
}

/// The direction nearest to a vector's.
pub fn nearest_direction(vector: Vector2<f64>) -> usize {
    let turn = math::atan2(vector.y, vector.x) / TAU;
    // Adding a half before truncation rounds; adding a turn makes the value positive.
    ((turn + 1.0) * DIRECTIONS as f64 + 0.5) as usize % DIRECTIONS
}
