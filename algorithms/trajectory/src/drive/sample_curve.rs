//! Conversion of a curve to a drivable path of dense points.

use geometry::math;
use nalgebra::Vector2;

use crate::convex::scaling::Scaling;
use crate::path_points::{self, PathPoint};
use curves::{Curve, Trace};
use trajectory_problem::RobotLimits;

/// Number of points per span at which its curvature is evaluated.
const CURVATURE_POINTS: usize = 6;
/// Maximum difference between the turn of a curve from point to point and the turn by the
/// curvatures at both, relative to the maximum possible turn.
const MISMATCH: f64 = 3e-4;
/// Maximum number of times that the interval between two points is halved.
const MAX_HALVES: usize = 16;
/// Maximum number of points of a path before halving: a curve that needs more oscillates.
const MAX_POINTS: usize = 20_000;

/// The points of a curve, with the representative of its first heading nearest to `theta` (rad);
/// `None` if the curve has a cusp.
pub fn path(
    curve: &dyn Curve,
    z: &[f64],
    frame: &Scaling,
    theta: f64,
    limits: &RobotLimits,
) -> Option<Vec<PathPoint>> {
    let trace = curve.trace(z);
    let point = |at: f64| {
        let [r, velocity, acceleration] = trace(at);
        let speed = velocity.norm();
        (speed > 1e-9).then(|| PathPoint {
            s: 0.0,
            at: frame.outward(r),
            theta: math::atan2(velocity.y, velocity.x),
            kappa: velocity.perp(&acceleration) / (speed * speed * speed) / frame.unit(),
        })
    };
    let turning = limits.top_speed() / limits.top_turn_rate();
    let mut points: Vec<PathPoint> = Vec::new();
    let mut first = point(0.0)?;
    first.theta = theta + math::angle_difference(first.theta, theta);
    points.push(first);
    let mut last = (0.0, first);
    let mut ahead = Vec::new();
    for at in places(&trace, curve.breaks(), frame) {
        ahead.clear();
        ahead.push((at, point(at)?));
        while let Some((at, mut next)) = ahead.pop() {
            let (before, a) = &last;
            let turn = math::angle_difference(next.theta, a.theta);
            // The arc over the chord.
            let distance = (next.at - a.at).norm() * (1.0 + turn * turn / 24.0);
            // A robot that drives by the curvatures must turn as the curve does. Between two points
            // both speeds change linearly in time, so that the faster one has more weight.
            let [v, w] = [a.kappa, next.kappa].map(|kappa| limits.speed_at(kappa));
            let expected = (a.kappa * v + next.kappa * w) / (v + w) * distance;
            if (expected - turn).abs() > MISMATCH * distance / turning + 1e-8 {
                if ahead.len() >= MAX_HALVES || points.len() >= MAX_POINTS {
                    return None;
                }
                ahead.push((at, next));
                let middle = 0.5 * (before + at);
                ahead.push((middle, point(middle)?));
                continue;
            }
            next.s = a.s + distance;
            next.theta = a.theta + turn;
            points.push(next);
            last = (at, next);
        }
    }
    Some(points)
}

/// Parameters at which the points of a curve are dense enough for its curvature.
fn places(trace: &Trace<'_>, breaks: &[f64], frame: &Scaling) -> Vec<f64> {
    let mut places = Vec::new();
    for pair in breaks.windows(2) {
        let width = pair[1] - pair[0];
        let looked: Vec<(Vector2<f64>, f64)> = (0..=CURVATURE_POINTS)
            .map(|i| {
                let [r, velocity, acceleration] =
                    trace(pair[0] + width * i as f64 / CURVATURE_POINTS as f64);
                let speed = velocity.norm().max(1e-9);
                (
                    r,
                    velocity.perp(&acceleration).abs() / (speed * speed * speed) / frame.unit(),
                )
            })
            .collect();
        // The density of each part follows from the more curved of its ends.
        for (i, ends) in looked.windows(2).enumerate() {
            let length = (ends[1].0 - ends[0].0).norm() * frame.unit();
            let spacing = path_points::spacing(ends[0].1.max(ends[1].1));
            let count = (1.05 * length / spacing).ceil().clamp(1.0, 4000.0);
            let begin = pair[0] + width * i as f64 / CURVATURE_POINTS as f64;
            let part = width / CURVATURE_POINTS as f64;
            places.extend((1..=count as usize).map(|k| begin + part * k as f64 / count));
        }
    }
    if let Some(last) = places.last_mut() {
        *last = 1.0;
    }
    places
}
