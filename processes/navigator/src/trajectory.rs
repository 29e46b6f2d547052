//! Trajectory from an answer of the optimiser.

use control::go_to::coast;
use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use planner_view::free_space::FreeSpace;
use thiserror::Error;

/// Maximum length of a piece of the path that counts as straight (m), and its maximum bend (rad).
const PIECE: (f64, f64) = (0.01, 0.1);
/// Maximum distance of such a piece from the path (m).
pub const SAGITTA: f64 = PIECE.0 * PIECE.1 / 8.0;
/// Maximum number of pieces of one path, far beyond real paths.
const MAX_PIECES: usize = 1 << 20;
/// Number of bisections of the search for the end of the free part.
const HALVINGS: u32 = 24;

/// Point of a trajectory. Between two points both speeds change linearly in time; two points of the
/// same time are a step of the speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the start (s).
    pub t: f64,
    /// Pose; the heading is continuous along the trajectory, not wrapped.
    pub pose: Pose2,
    /// Speeds.
    pub twist: Twist2,
}

/// Faults of samples that make no trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum TrajectoryError {
    /// The list of samples is empty.
    #[error("no samples")]
    Empty,
    /// A number is not finite, or the times decrease.
    #[error("sample {0} is not finite or has an earlier time than the one before")]
    Sample(usize),
    /// The path exceeds the maximum length.
    #[error("the path has more than {MAX_PIECES} pieces")]
    Long,
}

/// Planned motion of a robot: poses and speeds over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The received samples, and one wherever the speed changes its sign: between two samples the
    /// robot drives in one direction.
    samples: Vec<Sample>,
    /// Length of the path up to each sample (m).
    along: Vec<f64>,
    /// Distance up to each sample (m), counted negative where the robot drives backwards.
    ahead: Vec<f64>,
    /// Times (s) and places (m) at intervals short enough for straight pieces.
    pieces: Vec<(f64, Point2<f64>)>,
}

impl Trajectory {
    /// Returns a trajectory through received samples.
    ///
    /// # Errors
    /// [`TrajectoryError`] names the invalid sample.
    pub fn new(samples: Vec<Sample>) -> Result<Self, TrajectoryError> {
        let mut before = 0.0;
        for (i, sample) in samples.iter().enumerate() {
            let finite = sample.pose.is_finite() && sample.twist.is_finite();
            // Time begins at 0; NaN has no order.
            let in_order = sample.t >= before && (i > 0 || sample.t == 0.0);
            if !(finite && in_order && sample.t.is_finite()) {
                return Err(TrajectoryError::Sample(i));
            }
            before = sample.t;
        }
        let samples = with_cusps(samples);
        let first = samples.first().ok_or(TrajectoryError::Empty)?;
        let mut pieces = vec![(0.0, first.pose.position())];
        let mut along = Vec::with_capacity(samples.len());
        along.push(0.0);
        let mut ahead = along.clone();
        let (mut length, mut advance) = (0.0, 0.0);
        for pair in samples.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            let way = 0.5 * (a.twist.v + b.twist.v) * (b.t - a.t);
            let backwards = way < 0.0;
            // The speeds are taken as given, but the positions determine the robot's path.
            let way = way
                .abs()
                .max((b.pose.position() - a.pose.position()).norm());
            length += way;
            along.push(length);
            advance += if backwards { -way } else { way };
            ahead.push(advance);
            let bend = (b.pose.theta - a.pose.theta).abs();
            let count = (way / PIECE.0).max(bend / PIECE.1).ceil().max(1.0);
            let left = (MAX_PIECES - pieces.len()) as f64;
            if count.is_nan() || count >= left {
                return Err(TrajectoryError::Long);
            }
            if way > 0.0 {
                pieces.extend((1..=count as usize).map(|i| {
                    let part = i as f64 / count;
                    let (pose, _) = between(a, b, part);
                    (a.t + (b.t - a.t) * part, pose.position())
                }));
            }
        }
        Ok(Self {
            samples,
            along,
            ahead,
            pieces,
        })
    }

    /// Duration (s).
    pub fn duration(&self) -> f64 {
        self.samples.last().map_or(0.0, |last| last.t)
    }

    /// Length of the path (m).
    pub fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// Returns pose and speeds after `t` (s). Before the start and after the end the robot stands
    /// there.
    pub fn at(&self, t: f64) -> (Pose2, Twist2) {
        match self.find(t) {
            TimeIndex::Between(i, part) => between(&self.samples[i], &self.samples[i + 1], part),
            TimeIndex::At(i) => self
                .samples
                .get(i)
                .map_or_else(Default::default, |sample| (sample.pose, Twist2::STOP)),
        }
    }

    /// Returns the length of the path up to the time `t` (m).
    pub fn along(&self, t: f64) -> f64 {
        self.sum(&self.along, t)
    }

    /// Returns the distance up to the time `t` (m), counted negative where the robot drives backwards.
    pub fn ahead(&self, t: f64) -> f64 {
        self.sum(&self.ahead, t)
    }

    /// Returns `true` if the next motion after the time `t` (s) that is no turn on the spot is
    /// backwards.
    pub fn is_backwards(&self, t: f64) -> bool {
        let next = self.samples.partition_point(|sample| sample.t <= t);
        let ahead = self.ahead.get(next.saturating_sub(1)..).unwrap_or_default();
        let moves = ahead.windows(2).find(|pair| pair[0] != pair[1]);
        moves.is_some_and(|pair| pair[1] < pair[0])
    }

    /// Returns a sum over the path up to the time `t` (s), from its values at the samples.
    fn sum(&self, sums: &[f64], t: f64) -> f64 {
        match self.find(t) {
            TimeIndex::At(i) => sums.get(i).copied().unwrap_or(0.0),
            TimeIndex::Between(i, part) => {
                let (a, b) = (&self.samples[i], &self.samples[i + 1]);
                let total = a.twist.v + b.twist.v;
                // The share of the path that lies within the share of the time.
                let share = if total == 0.0 {
                    part
                } else {
                    part * (2.0 * a.twist.v + (b.twist.v - a.twist.v) * part) / total
                };
                sums[i] + (sums[i + 1] - sums[i]) * share.clamp(0.0, 1.0)
            }
        }
    }

    /// Returns the time (s) of the next step of the speeds after the time `after` (s).
    pub fn next_step(&self, after: f64) -> Option<f64> {
        let first = self.samples.partition_point(|sample| sample.t <= after);
        let ahead = self.samples.get(first..).unwrap_or_default();
        let mut steps = ahead.windows(2).filter(|pair| pair[0].t == pair[1].t);
        steps.next().map(|pair| pair[0].t)
    }

    /// Returns the pieces of the path from a time (s) on: time and place of each end.
    pub fn pieces(&self, from: f64) -> impl Iterator<Item = (f64, Point2<f64>)> {
        let first = self.pieces.partition_point(|(t, _)| *t <= from);
        let start = (from, self.at(from).0.position());
        core::iter::once(start).chain(self.pieces.get(first..).unwrap_or_default().iter().copied())
    }

    /// Returns the free distance (m) along the path for a disc of this radius (m) from the time
    /// `from` (s) on; `None` if it is free to its end.
    pub fn blocked(&self, space: &FreeSpace, from: f64, radius: f64) -> Option<f64> {
        let mut pieces = self.pieces(from);
        let (mut at, mut place) = pieces.next()?;
        if !space.is_free(place, radius) {
            return Some(self.along(from));
        }
        for (t, next) in pieces {
            if !space.segment_is_free(place, next, radius) {
                let (mut free, mut not) = (0.0, 1.0);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (free + not);
                    let up_to = place + (next - place) * middle;
                    if space.segment_is_free(place, up_to, radius) {
                        free = middle;
                    } else {
                        not = middle;
                    }
                }
                let (a, b) = (self.along(at), self.along(t));
                return Some(a + (b - a) * free);
            }
            (at, place) = (t, next);
        }
        None
    }

    fn find(&self, t: f64) -> TimeIndex {
        let after = self.samples.partition_point(|sample| sample.t <= t);
        let Some(before) = after.checked_sub(1) else {
            return TimeIndex::At(0);
        };
        match self.samples.get(after) {
            None => TimeIndex::At(before),
            Some(b) => {
                let a = &self.samples[before];
                TimeIndex::Between(before, (t - a.t) / (b.t - a.t))
            }
        }
    }
}

/// Returns the samples, with another one wherever the speed changes its sign between two.
fn with_cusps(samples: Vec<Sample>) -> Vec<Sample> {
    let mut all: Vec<Sample> = Vec::with_capacity(samples.len());
    for b in samples {
        if let Some(a) = all.last()
            && a.twist.v * b.twist.v < 0.0
            && a.t < b.t
        {
            let part = a.twist.v / (a.twist.v - b.twist.v);
            let (pose, twist) = between(a, &b, part);
            all.push(Sample {
                t: a.t + (b.t - a.t) * part,
                pose,
                twist: Twist2::new(0.0, twist.omega),
            });
        }
        all.push(b);
    }
    all
}

enum TimeIndex {
    /// At a sample after which there are no others.
    At(usize),
    /// After a part of the time between a sample and the next.
    Between(usize, f64),
}

/// Returns the given part of the time between two samples.
fn between(a: &Sample, b: &Sample, part: f64) -> (Pose2, Twist2) {
    let duration = b.t - a.t;
    let lerp = |from: f64, to: f64, part: f64| from + (to - from) * part;
    // The mean of a linear change is its value half way.
    let mean = |part: f64| {
        Twist2::new(
            lerp(a.twist.v, b.twist.v, 0.5 * part),
            lerp(a.twist.omega, b.twist.omega, 0.5 * part),
        )
    };
    let reached = coast(&a.pose, mean(part), part * duration);
    // The error at the end is distributed along the piece in proportion to time.
    let end = coast(&a.pose, mean(1.0), duration);
    let turned = lerp(a.twist.omega, b.twist.omega, 0.5 * part) * part * duration;
    let end_turned = 0.5 * (a.twist.omega + b.twist.omega) * duration;
    let pose = Pose2 {
        x: reached.x + (b.pose.x - end.x) * part,
        y: reached.y + (b.pose.y - end.y) * part,
        theta: a.pose.theta + turned + (b.pose.theta - a.pose.theta - end_turned) * part,
    };
    let twist = Twist2::new(
        lerp(a.twist.v, b.twist.v, part),
        lerp(a.twist.omega, b.twist.omega, part),
    );
    (pose, twist)
}

#[cfg(test)]
mod tests {
    use geometry::shape::{Aabb, Convex};

    use super::*;

    fn sample(t: f64, x: f64, y: f64, theta: f64, v: f64, omega: f64) -> Sample {
        Sample {
            t,
            pose: Pose2 { x, y, theta },
            twist: Twist2::new(v, omega),
        }
    }

    /// 1 m ahead from rest to 1 m/s in 2 s, a quarter turn at π/4 rad/s, 1 m up.
    fn corner() -> Trajectory {
        let quarter = core::f64::consts::FRAC_PI_2;
        Trajectory::new(vec![
            sample(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
            sample(2.0, 1.0, 0.0, 0.0, 1.0, 0.0),
            sample(2.0, 1.0, 0.0, 0.0, 0.0, quarter / 2.0),
            sample(4.0, 1.0, 0.0, quarter, 0.0, quarter / 2.0),
            sample(4.0, 1.0, 0.0, quarter, 1.0, 0.0),
            sample(5.0, 1.0, 1.0, quarter, 1.0, 0.0),
        ])
        .unwrap()
    }

    #[test]
    fn places_and_lengths_follow_from_the_speeds() {
        let corner = corner();
        assert_eq!((corner.duration(), corner.length()), (5.0, 2.0));
        let (pose, twist) = corner.at(1.0);
        assert!((pose.x - 0.25).abs() < 1e-12 && (twist.v - 0.5).abs() < 1e-12);
        assert!((corner.along(1.0) - 0.25).abs() < 1e-12);
        let (pose, _) = corner.at(3.0);
        assert!((pose.theta - core::f64::consts::FRAC_PI_4).abs() < 1e-12);
        assert_eq!(corner.along(3.0), 1.0);
        assert_eq!(corner.next_step(0.0), Some(2.0));
        assert_eq!(corner.next_step(2.0), Some(4.0));
        assert_eq!(corner.next_step(4.0), None);
        // Before and after it the robot stands.
        assert_eq!(corner.at(-1.0).1, Twist2::STOP);
        assert_eq!(corner.at(9.0).0.y, 1.0);
    }

    /// From 1 m/s ahead to 1 m/s back in 2 s; and the same with a step of the speed.
    fn cusps() -> [Trajectory; 2] {
        let smooth = vec![
            sample(0.0, 0.0, 0.0, 0.0, 1.0, 0.0),
            sample(2.0, 0.0, 0.0, 0.0, -1.0, 0.0),
        ];
        let step = vec![
            sample(0.0, 0.0, 0.0, 0.0, 0.5, 0.0),
            sample(1.0, 0.5, 0.0, 0.0, 0.5, 0.0),
            sample(1.0, 0.5, 0.0, 0.0, -0.5, 0.0),
            sample(2.0, 0.0, 0.0, 0.0, -0.5, 0.0),
        ];
        [smooth, step].map(|samples| Trajectory::new(samples).unwrap())
    }

    #[test]
    fn both_directions_count_for_the_length_of_a_path_with_a_cusp() {
        for cusp in cusps() {
            assert!((cusp.length() - 1.0).abs() < 1e-12);
            let (tip, twist) = cusp.at(1.0 - 1e-9);
            assert!((tip.x - 0.5).abs() < 1e-8 && twist.v >= 0.0);
            assert!((cusp.along(1.0) - 0.5).abs() < 1e-12);
            assert!((cusp.ahead(1.0) - 0.5).abs() < 1e-12);
            // A quarter of a second later both are as far from the tip as before it.
            for t in [0.25, 0.5] {
                let back = cusp.ahead(1.0) - cusp.ahead(1.0 + t);
                assert!((back - (cusp.along(1.0 + t) - cusp.along(1.0))).abs() < 1e-12);
                assert!((cusp.at(1.0 - t).0.x - cusp.at(1.0 + t).0.x).abs() < 1e-12);
            }
            assert!(cusp.ahead(2.0).abs() < 1e-12);
            assert!(!cusp.is_backwards(0.9) && cusp.is_backwards(1.0));
        }
    }

    #[test]
    fn the_blocking_point_is_exact() {
        let bounds = Aabb {
            min: Point2::new(-5.0, -5.0),
            max: Point2::new(5.0, 5.0),
        };
        let corner = corner();
        let disc = Convex::disc(Point2::new(1.0, 0.8), 0.1);
        let space = FreeSpace::new(vec![disc], bounds, 0.1).unwrap();
        // 0.3 m before the disc's centre, on the way up from (1, 0).
        let blocked = corner.blocked(&space, 0.0, 0.2).unwrap();
        assert!((blocked - 1.5).abs() < 1e-6, "{blocked}");
        assert!((corner.blocked(&space, 4.2, 0.2).unwrap() - 1.5).abs() < 1e-6);
        // From inside a disc, the robot is blocked at once.
        assert!((corner.blocked(&space, 4.8, 0.2).unwrap() - 1.8).abs() < 1e-9);
        let free = FreeSpace::new(Vec::new(), bounds, 0.1).unwrap();
        assert_eq!(corner.blocked(&free, 0.0, 0.2), None);
    }

    #[test]
    fn invalid_samples_are_rejected() {
        let of = |samples: &[Sample]| Trajectory::new(samples.to_vec()).unwrap_err();
        let good = sample(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        assert_eq!(of(&[]), TrajectoryError::Empty);
        let late = Sample { t: 1.0, ..good };
        assert_eq!(of(&[late]), TrajectoryError::Sample(0));
        assert_eq!(of(&[good, late, good]), TrajectoryError::Sample(2));
        let nowhere = sample(1.0, f64::NAN, 0.0, 0.0, 0.0, 0.0);
        assert_eq!(of(&[good, nowhere]), TrajectoryError::Sample(1));
        let far = sample(1.0, 1e9, 0.0, 0.0, 0.0, 0.0);
        assert_eq!(of(&[good, far]), TrajectoryError::Long);
    }
}
