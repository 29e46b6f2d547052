//! Time-optimal speeds along a given path.
//!
//! Without inertia the robot passes every point as fast as its curvature allows. With limits on the
//! accelerations it is the time-optimal path parametrisation by reachability analysis (Pham and
//! Pham, *A New Approach to Time-Optimal Path Parameterization Based on Reachability Analysis*,
//! IEEE T-RO 2018). In terms of u = V² all limits between two neighbouring points are linear in
//! their two values. The backward pass gives the interval of u at each point from which the end can
//! be reached; the forward pass takes the largest u within it.

use crate::path_points::PathPoint;
use trajectory_problem::RobotLimits;

/// Share of the accelerations that is used: the rest covers errors of the linearisation.
const SHARE: f64 = 0.9995;
/// Speeds (m/s) below this count as standing: the time between two such points would be infinite.
const STANDING: f64 = 1e-9;

/// Speeds (m/s) at the points of a path for driving along it in the shortest time; `None` if the
/// prescribed speeds at its ends are impossible: too fast, or backwards. (For a robot without inertia the changes before
/// and after the path are steps; its speeds are those of the curvatures.)
///
/// Points of the same `s` are a step of the curvature: the robot must stand there if ω cannot step.
pub fn speeds(
    points: &[PathPoint],
    limits: &RobotLimits,
    start: Option<f64>,
    end: Option<f64>,
) -> Option<Vec<f64>> {
    let caps: Vec<f64> = points.iter().map(|p| limits.speed_at(p.kappa)).collect();
    if limits.is_without_inertia() {
        return Some(caps);
    }
    let n = points.len();
    let mut reach = vec![[0.0, 0.0]; n];
    let last = caps.last()?;
    if start.is_some_and(|v| v < 0.0) {
        return None;
    }
    reach[n - 1] = interval(end, *last)?;
    for i in (0..n - 1).rev() {
        let step = Step::new(&points[i], &points[i + 1], limits);
        reach[i] = step.before([0.0, caps[i] * caps[i]], reach[i + 1])?;
    }
    let mut speeds = Vec::with_capacity(n);
    let [low, high] = reach[0];
    let mut u = match start {
        Some(v) => {
            let u = v * v;
            // A measured speed at the limit must be accepted.
            let slack = 1e-9 * (1.0 + high);
            (low - slack..=high + slack).contains(&u).then_some(u)?
        }
        None => high,
    };
    speeds.push(u.sqrt());
    for i in 1..n {
        let step = Step::new(&points[i - 1], &points[i], limits);
        u = step.after(u, reach[i])?;
        speeds.push(u.sqrt());
    }
    let stands = |i: usize| {
        points[i].s > points[i - 1].s && speeds[i] < STANDING && speeds[i - 1] < STANDING
    };
    (1..n).all(|i| !stands(i)).then_some(speeds)
}

fn interval(speed: Option<f64>, cap: f64) -> Option<[f64; 2]> {
    match speed {
        None => Some([0.0, cap * cap]),
        Some(v) => (0.0..=cap * (1.0 + 1e-9))
            .contains(&v)
            .then_some([v * v, v * v]),
    }
}

/// The limits between two neighbouring points: half-planes p u₁ + q u₂ ≤ r.
struct Step {
    planes: [[f64; 3]; 4],
}

impl Step {
    fn new(a: &PathPoint, b: &PathPoint, limits: &RobotLimits) -> Self {
        let double = 2.0 * (b.s - a.s).max(0.0);
        let bound = |limit: Option<f64>| limit.map_or(f64::INFINITY, |l| double * l * SHARE);
        // V̇ = (u₂ − u₁) / 2Δs, and ω̇ = (κ₂V₂ − κ₁V₁)(V₁ + V₂) / 2Δs with V₁V₂ ≈ (u₁ + u₂) / 2.
        let linear = bound(limits.acceleration);
        let angular = bound(limits.angular_acceleration);
        let half = 0.5 * (b.kappa - a.kappa);
        let (p, q) = (-(a.kappa - half), b.kappa + half);
        Self {
            planes: [
                [-1.0, 1.0, linear],
                [1.0, -1.0, linear],
                [p, q, angular],
                [-p, -q, angular],
            ],
        }
    }

    /// The u₁ within an interval from which some u₂ within another can be reached.
    fn before(&self, first: [f64; 2], second: [f64; 2]) -> Option<[f64; 2]> {
        let mut corners = vec![
            [first[0], second[0]],
            [first[1], second[0]],
            [first[1], second[1]],
            [first[0], second[1]],
        ];
        for plane in &self.planes {
            corners = clip(&corners, plane);
        }
        let low = corners.iter().map(|c| c[0]).fold(f64::INFINITY, f64::min);
        let high = corners
            .iter()
            .map(|c| c[0])
            .fold(f64::NEG_INFINITY, f64::max);
        (low <= high).then_some([low.max(0.0), high.max(0.0)])
    }

    /// The largest u₂ within an interval that can be reached from u₁.
    fn after(&self, first: f64, second: [f64; 2]) -> Option<f64> {
        let [mut low, mut high] = second;
        let slack = 1e-9 * (1.0 + high);
        for &[p, q, r] in &self.planes {
            if r.is_infinite() {
                continue;
            }
            let rest = r - p * first;
            if q > 1e-12 {
                high = high.min(rest / q);
            } else if q < -1e-12 {
                low = low.max(rest / q);
            }
        }
        // Rounding may leave a small gap between the two.
        (high >= low - slack).then_some(high.max(0.0))
    }
}

/// The part of a convex polygon within a half-plane.
fn clip(corners: &[[f64; 2]], &[p, q, r]: &[f64; 3]) -> Vec<[f64; 2]> {
    if r.is_infinite() {
        return corners.to_vec();
    }
    let slack = 1e-12 * (1.0 + r.abs());
    let over = |c: &[f64; 2]| p * c[0] + q * c[1] - r;
    let mut left = Vec::with_capacity(corners.len() + 1);
    for (i, a) in corners.iter().enumerate() {
        let b = &corners[(i + 1) % corners.len()];
        let (oa, ob) = (over(a), over(b));
        if oa <= slack {
            left.push(*a);
        }
        if (oa < -slack && ob > slack) || (oa > slack && ob < -slack) {
            let part = oa / (oa - ob);
            left.push([a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]);
        }
    }
    left
}
