//! Samples of a solution, and nodes of samples.

use nalgebra::Point2;
use optimal_control::{Node, Solution};

use crate::path_points::SPACING;
use crate::plan::Sample;

/// Maximum number of samples of a trajectory: with more, its stages are too long to detect obstacles
/// between nodes.
const MAX_SAMPLES: f64 = 2e5;
/// Maximum turn (rad) between two samples.
const TURN_SPACING: f64 = 0.05;
/// Speeds (m/s, rad/s) that differ by less are equal.
const SAME: f64 = 1e-9;

/// The samples of a solution; `None` if there are too many.
pub fn from_solution(solution: &Solution) -> Option<Vec<Sample>> {
    let nodes = &solution.nodes;
    let time = solution.duration / nodes.len().saturating_sub(1).max(1) as f64;
    // The end of a stage, before its speeds step.
    let end = |a: &Node, b: &Node| {
        if solution.steps {
            Node {
                v: a.v,
                omega: a.omega,
                ..*b
            }
        } else {
            *b
        }
    };
    let parts = |a: &Node, b: &Node| {
        let distance = a.v.abs().max(b.v.abs()) * time;
        let turn = a.omega.abs().max(b.omega.abs()) * time;
        (distance / SPACING)
            .max(turn / TURN_SPACING)
            .ceil()
            .max(1.0)
    };
    let pairs = || {
        nodes
            .windows(2)
            .map(|pair| (pair[0], end(&pair[0], &pair[1])))
    };
    if pairs().map(|(a, b)| parts(&a, &b)).sum::<f64>() > MAX_SAMPLES {
        return None;
    }
    let sample = |t: f64, node: &Node| Sample {
        t,
        x: node.at.x,
        y: node.at.y,
        theta: node.theta,
        v: node.v,
        omega: node.omega,
    };
    let mut samples: Vec<Sample> = Vec::new();
    for (k, (a, b)) in pairs().enumerate() {
        let t = k as f64 * time;
        if samples.last().is_none_or(|last| differ(last, &a)) {
            samples.push(sample(t, &a));
        }
        let parts = parts(&a, &b);
        for i in 1..parts as usize {
            let part = i as f64 / parts;
            let node = a.within(&b, time, part);
            samples.push(sample(t + part * time, &node));
        }
        samples.push(sample((k + 1) as f64 * time, &b));
    }
    Some(samples)
}

fn differ(last: &Sample, node: &Node) -> bool {
    (last.v - node.v).abs() > SAME || (last.omega - node.omega).abs() > SAME
}

/// Pose and speeds at a time, by linear interpolation; at a step of the speeds, after it.
pub fn at(samples: &[Sample], t: f64) -> Node {
    let after = samples
        .partition_point(|s| s.t <= t)
        .clamp(1, samples.len() - 1);
    let (a, b) = (&samples[after - 1], &samples[after]);
    let part = if b.t > a.t {
        ((t - a.t) / (b.t - a.t)).clamp(0.0, 1.0)
    } else {
        1.0
    };
    let mix = |a: f64, b: f64| a + (b - a) * part;
    Node {
        at: Point2::new(mix(a.x, b.x), mix(a.y, b.y)),
        theta: mix(a.theta, b.theta),
        v: mix(a.v, b.v),
        omega: mix(a.omega, b.omega),
    }
}
