//! A path against its reference: deviation, sharpness of turns, required speed (cat-map patrol
//! paper, §5.1).
//!
//! A *reference* is the polyline of a patrol without protection, a *lap* the path that it follows
//! instead, from the reference's first point to its last, with the time of each point. For a
//! reference that is driven there and back, measure every other lap against its reverse. Every
//! function accepts any number of points and returns `None` without data to measure.
//!
//! The paper leaves three readings open, which give different numbers: whether points of both paths
//! correspond by length or by time (MAE), and whether a turn by 170° counts as 170° or as 10° (MAA).
//! All are here under their own names; report [`mae_time`] and [`Turns::maa`].

mod polyline;
mod turns;

use nalgebra::Point2;

use crate::track::Track;

pub use polyline::Polyline;
pub use turns::{Turns, headings};

/// Points per lap at which a path is compared with its reference, as in the paper's figures.
pub const POINTS_PER_LAP: usize = 120;

/// Mean distance (m) between points that divide the *lengths* of reference and lap in the same
/// ratio, at `n` points per lap; mean over the laps (`MAE_lap`; paper, Eq. 11).
///
/// `None` without laps, with `n` = 0 or with a path without points.
pub fn mae_lap(reference: &[Point2<f64>], laps: &[Track], n: usize) -> Option<f64> {
    let reference = Polyline::new(reference);
    mean_over(laps, |lap| {
        let lap = Polyline::new(lap.points());
        mean_distance(n, |share| Some((reference.at(share)?, lap.at(share)?)))
    })
}

/// [`mae_lap`] on all laps joined to one path, with `n` points per lap, against as many laps of the
/// reference (`MAE_joint`).
///
/// For comparison only: a lap that is slightly longer than the mean shifts all later ones, so that
/// the value depends on the key more than on the method.
pub fn mae_joint(reference: &[Point2<f64>], laps: &[Track], n: usize) -> Option<f64> {
    let reference = Polyline::new(reference);
    let joined = joined(laps);
    let path = Polyline::new(&joined);
    let points = n.checked_mul(laps.len())?;
    mean_distance(points, |share| {
        let laps_done = share * laps.len() as f64;
        // The end of a lap is its last point, not the first of the next one.
        let within = if share >= 1.0 {
            1.0
        } else {
            laps_done - laps_done.floor()
        };
        Some((reference.at(within)?, path.at(share)?))
    })
}

/// Mean distance (m) between an unprotected robot, which drives the reference at constant speed, and
/// this one, at `n` equal steps of *time* per lap; mean over the laps (`MAE_time`). Planned laps have
/// the times of the patrol's clock ([`seconds_per_waypoint`]), so that a lap along the reference has
/// an error of 0.
///
/// Report this one: it is linear in the width of the zig-zag, through the origin, as the paper's own
/// values are.
pub fn mae_time(reference: &[Point2<f64>], laps: &[Track], n: usize) -> Option<f64> {
    let reference = Polyline::new(reference);
    mean_over(laps, |lap| {
        let [begin_s, end_s] = lap.span()?;
        mae_between(&reference, lap, begin_s, end_s, n)
    })
}

/// [`mae_time`] of the lap that a track contains from `begin_s` to `end_s` (s).
pub fn mae_between(
    reference: &Polyline<'_>,
    track: &Track,
    begin_s: f64,
    end_s: f64,
    n: usize,
) -> Option<f64> {
    mean_distance(n, |share| {
        let at = track.at(begin_s + (end_s - begin_s) * share)?;
        Some((reference.at(share)?, at))
    })
}

/// Time between two waypoints of a leg in the time of a patrol (s): one second where waypoints are
/// inserted (τ = 1; paper, Eq. 10), otherwise the whole leg of this `length` (m) at the speed `v`
/// (m/s) of an unprotected patrol.
pub fn seconds_per_waypoint(length: f64, inserted: u64, v: f64) -> f64 {
    if inserted > 0 { 1.0 } else { length / v }
}

/// Changes of direction per second in a lap of `legs` straight legs with a duration of `t_max` (s)
/// (`ANDC`); the paper also counts the one at the end of the last leg.
///
/// `None` unless `t_max` > 0.
pub fn andc(legs: usize, t_max: f64) -> Option<f64> {
    (t_max > 0.0 && t_max.is_finite()).then(|| legs as f64 / t_max)
}

/// Speed (m/s) at which a lap is driven in `t_max` (s).
///
/// `None` without points or unless `t_max` > 0.
pub fn speed(lap: &Track, t_max: f64) -> Option<f64> {
    let timed = t_max > 0.0 && t_max.is_finite();
    (timed && !lap.points().is_empty()).then(|| Polyline::new(lap.points()).length() / t_max)
}

/// Laps joined end to end, as one path.
pub fn joined(laps: &[Track]) -> Vec<Point2<f64>> {
    let points = laps.iter().map(|lap| lap.points().len()).sum();
    let mut path: Vec<Point2<f64>> = Vec::with_capacity(points);
    for lap in laps.iter().map(Track::points) {
        // A lap begins at the end of the previous one.
        let repeated = usize::from(path.last().is_some() && path.last() == lap.first());
        path.extend(lap.iter().skip(repeated));
    }
    path
}

/// All metrics of a patrol.
#[derive(Debug, Clone, PartialEq)]
pub struct PathMetrics {
    /// Number of laps.
    pub laps: usize,
    /// Length of the first lap (m).
    pub length_first: f64,
    /// Mean length of a lap (m).
    pub length_mean: f64,
    /// Required speed of the first lap (m/s).
    pub speed_first: f64,
    /// Mean speed over all laps (m/s).
    pub speed_mean: f64,
    /// See [`mae_lap`] (m).
    pub mae_lap: f64,
    /// See [`mae_joint`] (m).
    pub mae_joint: f64,
    /// See [`mae_time`] (m).
    pub mae_time: f64,
    /// See [`andc`], mean over the laps (1/s).
    pub andc: f64,
    /// Turns within the first lap.
    pub turns_first: Turns,
    /// Turns on all laps, including those from one lap to the next.
    pub turns: Turns,
}

impl PathMetrics {
    /// Measures laps with a duration of `t_max` (s) each, at [`POINTS_PER_LAP`].
    ///
    /// `None` without laps, with a lap or a reference without points, or unless `t_max` > 0.
    pub fn from_laps(reference: &[Point2<f64>], laps: &[Track], t_max: f64) -> Option<Self> {
        let first = laps.first()?;
        Some(Self {
            laps: laps.len(),
            length_first: Polyline::new(first.points()).length(),
            length_mean: mean_over(laps, |lap| Some(Polyline::new(lap.points()).length()))?,
            speed_first: speed(first, t_max)?,
            speed_mean: mean_over(laps, |lap| speed(lap, t_max))?,
            mae_lap: mae_lap(reference, laps, POINTS_PER_LAP)?,
            mae_joint: mae_joint(reference, laps, POINTS_PER_LAP)?,
            mae_time: mae_time(reference, laps, POINTS_PER_LAP)?,
            andc: mean_over(laps, |lap| {
                andc(lap.points().len().saturating_sub(1), t_max)
            })?,
            turns_first: Turns::from_path(first.points()),
            turns: Turns::from_path(&joined(laps)),
        })
    }
}

/// Mean of a metric over laps; `None` if there are none or if one of them has no value.
fn mean_over(laps: &[Track], measure: impl Fn(&Track) -> Option<f64>) -> Option<f64> {
    let mut sum = 0.0;
    for lap in laps {
        sum += measure(lap)?;
    }
    (!laps.is_empty()).then(|| sum / laps.len() as f64)
}

/// Mean distance of the pairs of points at the shares 1/n, 2/n … 1.
fn mean_distance(
    n: usize,
    pair: impl Fn(f64) -> Option<(Point2<f64>, Point2<f64>)>,
) -> Option<f64> {
    let mut sum = 0.0;
    for l in 1..=n {
        let (reference, altered) = pair(l as f64 / n as f64)?;
        sum += (altered - reference).norm();
    }
    (n > 0).then(|| sum / n as f64)
}

#[cfg(test)]
mod tests;
