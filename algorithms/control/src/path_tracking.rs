//! Path tracking: pure pursuit, with the speed limited where the robot could not follow otherwise.
//!
//! Pure pursuit (Coulter, *Implementation of the Pure Pursuit Path Tracking Algorithm*, CMU-RI-TR-92-01,
//! 1992) drives along the circle that leaves the robot's pose along its heading and passes through a
//! point of the path some distance ahead. With that point at distance ℓ under the bearing α, the
//! circle's curvature is κ = 2 sin α / ℓ. As in regulated pure pursuit (Macenski et al., *Autonomous
//! Robots* 2023), the speed depends on the curvature and on the remaining path.

use core::f64::consts::PI;

use geometry::math;
use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use parameters::{Parameters, ParamsError, above, at_least, between, require};

use planner_view::limits::Limits;

/// Points of a path closer to each other than this (m) are one point.
const SAME_PLACE: f64 = 1e-9;

/// Factor by which the look-ahead shrinks when the path to the target point is not clear.
const SHORTER: f64 = 0.7;

parameters::table! {
    /// Parameters of a [`PathTracker`].
    #[derive(Copy)]
    pub struct TrackingParams {
        /// Distance along the path to the target point, at standstill.
        pub look_ahead: f64 [above(0).unit("m")] = 0.2,
        /// Increase of `look_ahead` per speed.
        pub look_ahead_time_s: f64 [at_least(0).unit("s")] = 0.5,
        /// Minimum look-ahead, at most `look_ahead`; used where the path to a farther point is not clear.
        pub min_look_ahead: f64 [above(0).unit("m")] = 0.05,
        /// Bearing of the target point above which the robot turns on the spot.
        pub turn_on_spot: f64 [above(0).at_most(PI).unit("rad")] = 1.2,
        /// Turning rate per bearing while the robot turns on the spot.
        pub turn_gain: f64 [above(0).unit("1/s")] = 8.0,
        /// Maximum speed, as a fraction of the maximum forward speed.
        pub speed_fraction: f64 [between(0, 1)] = 1.0,
        /// Deceleration before the end of the path; absent: the robot passes the end at full speed.
        pub arrival_deceleration: Option<f64> [above(0).unit("m/s²")],
        /// Maximum turning rate, when lower than the robot's own limit; absent: the robot's.
        pub omega_cap: Option<f64> [above(0).unit("rad/s")],
        /// Distance to the path's end at which the robot has arrived.
        pub arrived: f64 [above(0).unit("m")] = 0.05,
    }
}

impl Parameters for TrackingParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        require(
            self.min_look_ahead <= self.look_ahead,
            "min_look_ahead",
            &self.min_look_ahead,
            "at most `look_ahead`",
        )
    }
}

/// A path of straight pieces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Path {
    points: Vec<Point2<f64>>,
    /// Length of the path up to each point (m).
    along: Vec<f64>,
}

impl Path {
    /// Builds a path through these points (m); repeated points and points that are not finite are left
    /// out.
    pub fn new(points: impl IntoIterator<Item = Point2<f64>>) -> Self {
        let mut path = Self::default();
        for p in points {
            if !(p.x.is_finite() && p.y.is_finite()) {
                continue;
            }
            let along = match (path.points.last(), path.along.last()) {
                (Some(last), Some(along)) => {
                    let step = (p - last).norm();
                    if step < SAME_PLACE {
                        continue;
                    }
                    along + step
                }
                _ => 0.0,
            };
            path.points.push(p);
            path.along.push(along);
        }
        path
    }

    /// Its points (m).
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// Length up to each point (m).
    pub fn along(&self) -> &[f64] {
        &self.along
    }

    /// Returns `true` if the path has no point.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Its length (m).
    pub fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// The point at a distance along the path (m), clamped to the ends; `None` for an empty path.
    pub fn at(&self, along: f64) -> Option<Point2<f64>> {
        let (piece, part) = self.piece_at(along)?;
        let (a, b) = (self.points.get(piece)?, self.points.get(piece + 1));
        Some(b.map_or(*a, |b| a + (b - a) * part))
    }

    /// Direction of travel at a distance along the path (rad); `None` for fewer than two points.
    pub fn direction(&self, along: f64) -> Option<f64> {
        let (piece, _) = self.piece_at(along)?;
        let piece = piece.min(self.points.len().checked_sub(2)?);
        let d = self.points.get(piece + 1)? - self.points.get(piece)?;
        Some(math::atan2(d.y, d.x))
    }

    /// The segment at a distance along the path, and the fraction of that segment, 0 … 1.
    fn piece_at(&self, along: f64) -> Option<(usize, f64)> {
        let last = self.points.len().checked_sub(1)?;
        let next = self.along.partition_point(|&a| a <= along);
        if next == 0 || last == 0 {
            return Some((0, 0.0));
        }
        let piece = (next - 1).min(last - 1);
        let (from, to) = (self.along.get(piece)?, self.along.get(piece + 1)?);
        Some((piece, ((along - from) / (to - from)).clamp(0.0, 1.0)))
    }

    /// The point of the path between two distances along it that is nearest to `p`: its distance along
    /// the path and its distance from `p` (m). `None` for an empty path.
    pub fn project(&self, p: Point2<f64>, first: f64, last: f64) -> Option<(f64, f64)> {
        let mut best: Option<(f64, f64)> = None;
        let mut consider = |along: f64, at: Point2<f64>| {
            let distance = (p - at).norm();
            if best.is_none_or(|(_, least)| distance < least) {
                best = Some((along, distance));
            }
        };
        consider(first.clamp(0.0, self.length()), self.at(first)?);
        let pieces = self.points.windows(2).zip(self.along.windows(2));
        for (points, along) in pieces {
            let (&[a, b], &[from, to]) = (points, along) else {
                continue;
            };
            if to < first || from > last {
                continue;
            }
            let line = b - a;
            let t = (p - a).dot(&line) / line.norm_squared();
            let at = (from + t * (to - from)).clamp(from.max(first), to.min(last).max(first));
            consider(at, a + line * ((at - from) / (to - from)));
        }
        best
    }
}

/// Result of a tracker in one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    /// The command; finite and within the limits.
    pub command: Twist2,
    /// Target point (m).
    pub target: Point2<f64>,
    /// Distance from the path (m).
    pub off_path: f64,
    /// Remaining length of the path (m).
    pub remaining: f64,
    /// `true` if the robot has reached the end along the path, not past it.
    pub arrived: bool,
}

/// Tracks one path after the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathTracker {
    path: Path,
    progress: f64,
}

impl PathTracker {
    /// Sets a new path, from its start.
    pub fn set_path(&mut self, path: Path) {
        self.path = path;
        self.progress = 0.0;
    }

    /// The path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Distance along the path that the robot has covered (m).
    pub fn progress(&self) -> f64 {
        self.progress
    }

    /// The command that tracks the path from this pose; `None` without a path or with a pose that is not
    /// finite.
    ///
    /// `is_clear` reports whether the robot can drive to a point of the path along the circle that
    /// leaves along its heading. If not, the tracker aims at a nearer point, so that corners are not
    /// cut. While a robot turns on the spot, `is_clear` is not called.
    pub fn track(
        &mut self,
        pose: &Pose2,
        limits: &Limits,
        params: &TrackingParams,
        mut is_clear: impl FnMut(&Pose2, Point2<f64>) -> bool,
    ) -> Option<Tracking> {
        if !pose.is_finite() {
            return None;
        }
        let here = pose.position();
        let limits = limits.restricted(1.0, params.omega_cap);
        let v_max = limits.v_max() * params.speed_fraction;
        let ahead = params.look_ahead + params.look_ahead_time_s * v_max;
        // A window: where the path passes near itself, the robot stays on its own part of it.
        let window = (self.progress - ahead, self.progress + 2.0 * ahead);
        let (progress, off_path) = self.path.project(here, window.0.max(0.0), window.1)?;
        self.progress = progress;
        let end = *self.path.points.last()?;
        let remaining = self.path.length() - progress;
        // The end may lie beside a part of the path that is far from it.
        let arrived = remaining <= 2.0 * ahead && (here - end).norm() <= params.arrived;

        let mut look = ahead;
        let target = loop {
            let target = self.path.at(progress + look)?;
            if look <= params.min_look_ahead || is_clear(pose, target) {
                break target;
            }
            look = (look * SHORTER).max(params.min_look_ahead);
        };
        let command = if arrived && params.arrival_deceleration.is_some() {
            Twist2::STOP
        } else {
            pursue(pose, target, remaining + off_path, v_max, &limits, params)
        };
        Some(Tracking {
            command,
            target,
            off_path,
            remaining,
            arrived,
        })
    }
}

fn pursue(
    pose: &Pose2,
    target: Point2<f64>,
    remaining: f64,
    v_max: f64,
    limits: &Limits,
    params: &TrackingParams,
) -> Twist2 {
    let offset = target - pose.position();
    let distance = offset.norm();
    if distance < SAME_PLACE {
        return Twist2::STOP;
    }
    let forward = pose.forward();
    let beside = forward.perp(&offset);
    let bearing = math::atan2(beside, forward.dot(&offset));
    if bearing.abs() > params.turn_on_spot {
        return limits.clip(Twist2::new(0.0, params.turn_gain * bearing));
    }
    let curvature = 2.0 * beside / (distance * distance);
    let bend = curvature.abs();
    let mut v = v_max;
    if bend * v > limits.omega_max() {
        v = limits.omega_max() / bend;
    }
    if let Some(deceleration) = params.arrival_deceleration {
        v = v.min((2.0 * deceleration * remaining.max(0.0)).sqrt());
    }
    limits.clip(Twist2::new(v, curvature * v))
}

#[cfg(test)]
mod tests;
