//! From a curve to a path that can be driven: points dense enough, and how deep they are in what.

use nalgebra::Vector2;
use sim_backend::math;

use crate::curve::{Curve, Trace};
use crate::ground::Ground;
use crate::path::{self, PathPoint};
use crate::shape::Frame;

/// Places in a span at which its curvature is looked at.
const LOOKS: usize = 6;
/// Turn [rad] between two points beyond which a curve is not driven but jerks.
const JERK: f64 = 1.0;

/// The points of a curve, its first heading the representative nearest to `theta` [rad]; `None` if
/// the curve has a cusp.
pub fn path(curve: &dyn Curve, z: &[f64], frame: &Frame, theta: f64) -> Option<Vec<PathPoint>> {
    let trace = curve.trace(z);
    let places = places(&trace, curve.breaks(), frame);
    let mut points: Vec<PathPoint> = Vec::with_capacity(places.len());
    for at in places {
        let [r, velocity, acceleration] = trace(at);
        let speed = velocity.norm();
        if speed.is_nan() || speed <= 1e-9 {
            return None;
        }
        let heading = math::atan2(velocity.y, velocity.x);
        let at = frame.outward(r);
        let kappa = velocity.perp(&acceleration) / (speed * speed * speed) / frame.unit();
        let point = match points.last() {
            None => PathPoint {
                s: 0.0,
                at,
                theta: theta + math::angle_difference(heading, theta),
                kappa,
            },
            Some(last) => {
                let turn = math::angle_difference(heading, last.theta);
                if turn.abs() > JERK {
                    return None;
                }
                // The arc over the chord.
                let chord = (at - last.at).norm();
                PathPoint {
                    s: last.s + chord * (1.0 + turn * turn / 24.0),
                    at,
                    theta: last.theta + turn,
                    kappa,
                }
            }
        };
        points.push(point);
    }
    Some(points)
}

/// Where to look at a curve so that its points are dense enough for its curvature.
fn places(trace: &Trace<'_>, breaks: &[f64], frame: &Frame) -> Vec<f64> {
    let mut places = vec![0.0];
    for pair in breaks.windows(2) {
        let width = pair[1] - pair[0];
        let looked: Vec<(Vector2<f64>, f64)> = (0..=LOOKS)
            .map(|i| {
                let [r, velocity, acceleration] = trace(pair[0] + width * i as f64 / LOOKS as f64);
                let speed = velocity.norm().max(1e-9);
                (r, velocity.perp(&acceleration).abs() / (speed * speed * speed) / frame.unit())
            })
            .collect();
        // Each part as dense as the more curved of its ends wants it.
        for (i, ends) in looked.windows(2).enumerate() {
            let length = (ends[1].0 - ends[0].0).norm() * frame.unit();
            let spacing = path::spacing(ends[0].1.max(ends[1].1));
            let count = (1.05 * length / spacing).ceil().clamp(1.0, 4000.0);
            let begin = pair[0] + width * i as f64 / LOOKS as f64;
            let part = width / LOOKS as f64;
            places.extend((1..=count as usize).map(|k| begin + part * k as f64 / count));
        }
    }
    if let Some(last) = places.last_mut() {
        *last = 1.0;
    }
    places
}

/// How deep [m] a path is at most in each grown obstacle that it is in, by index; and how far it
/// is from the nearest one at least (infinite without obstacles, negative inside).
pub fn depths(ground: &Ground, points: &[PathPoint]) -> (Vec<(usize, f64)>, f64) {
    let mut found = Vec::new();
    let mut nearest = f64::INFINITY;
    for (index, obstacle) in ground.obstacles.iter().enumerate() {
        let mut least = f64::INFINITY;
        let mut i = 0;
        while i < points.len() {
            let distance = obstacle.contact(points[i].at).distance - ground.clearance;
            least = least.min(distance);
            // Distances change by no more than the way: before that, none is less than `least`.
            let reach = points[i].s + (distance - least);
            i += 1;
            i += points[i..].partition_point(|p| p.s < reach);
        }
        nearest = nearest.min(least);
        if least < 0.0 {
            found.push((index, -least));
        }
    }
    (found, nearest)
}
