//! Refinement of trajectories of robots with inertia.
//!
//! Where speeds cannot step, the shortest path is no longer the fastest, and the best path depends on
//! the speeds along it. From a first trajectory this search continues in the controls: at N + 1
//! nodes, evenly spaced in time, poses and speeds are free, and so is the duration. Between nodes
//! both speeds change linearly (as between samples of a trajectory), so that all limits of speeds,
//! wheels and accelerations are linear in the variables, exactly, between nodes as well. Only the
//! motion from node to node and the obstacles are linearised, around the last trajectory (direct
//! multiple shooting by sequential convex programming).

mod convex_step;
mod step_dynamics;

use nalgebra::Point2;

use crate::convex::effort::Effort;
use crate::convex::obstacle_planes::{NO_DEPTH, grow_margins};
use crate::obstacle_field::ObstacleField;
use crate::path_points::{self, SPACING};
use crate::plan::Sample;
use crate::problem::Problem;
use step_dynamics::Node;

/// Minimum and maximum number of steps, and their target duration (s).
const STEPS: [f64; 2] = [24.0, 120.0];
const STEP_TIME: f64 = 0.15;
/// Maximum number of programs of a search.
const MAX_PROGRAMS: u32 = 40;
/// Initial trust region: maximum change of a heading (rad) and (relative) of the duration in one
/// program.
const TRUST: f64 = 0.4;
/// Minimum of the trust region.
const MIN_TRUST: f64 = 1e-3;
/// Relative change of the duration that ends the search.
const CONVERGED: f64 = 1e-4;
/// Gap (m) of poses from node to node that counts as closed.
const CLOSED: f64 = 2e-8;
/// Cost (s) per metre of penetration of an obstacle, or of a gap between poses, in units of the time
/// in which the robot covers it.
const PENALTY: f64 = 20.0;
/// Cost of a step's square, initially and at least: it keeps programs with many solutions (in open
/// space a robot can oscillate at no cost) from jumping between them.
const PROXIMAL: [f64; 2] = [1e-2, 1e-4];
/// Distance (m) from an obstacle, in addition to the length of a step, within which it is considered.
const REACH: f64 = 0.15;
/// Cost of the turning rate's square, relative to its limit's, per second: it selects the smoothest
/// of the fastest trajectories. It costs less than this share of the duration.
const TURNING_COST: f64 = 1e-4;
/// Shares of the predicted improvement: below the first, the trust region shrinks; above the second,
/// it grows.
const KEPT: [f64; 2] = [0.3, 0.8];
/// Maximum number of samples of a trajectory: with more, its steps are too long to detect obstacles
/// between nodes.
const MAX_SAMPLES: f64 = 2e5;
/// Maximum turn (rad) between two samples.
const TURN_SPACING: f64 = 0.05;

/// A search for a faster trajectory.
pub struct Refinement<'a> {
    problem: &'a Problem,
    obstacle_field: &'a ObstacleField,
    nodes: Vec<Node>,
    /// Duration (s).
    time: f64,
    /// Additional margin of the nodes per obstacle (m).
    margins: Vec<f64>,
    effort: &'a Effort,
    proximal: f64,
}

impl<'a> Refinement<'a> {
    /// Begins with a trajectory that need not keep the limits; `None` for one without duration.
    pub fn new(
        problem: &'a Problem,
        obstacle_field: &'a ObstacleField,
        samples: &[Sample],
        effort: &'a Effort,
    ) -> Option<Self> {
        let time = samples.last()?.t;
        if !(time > 0.0 && time.is_finite()) {
            return None;
        }
        let steps = (time / STEP_TIME).clamp(STEPS[0], STEPS[1]).round() as usize;
        let nodes = (0..=steps)
            .map(|k| sample_at(samples, time * k as f64 / steps as f64))
            .collect();
        Some(Self {
            problem,
            obstacle_field,
            nodes,
            time,
            margins: vec![0.0; obstacle_field.obstacles.len()],
            effort,
            proximal: PROXIMAL[0],
        })
    }

    /// Runs the search; returns the trajectory found, even if it is not better than the first; `None`
    /// if none is found that is free and without gaps.
    pub fn run(&mut self, stop: &mut dyn FnMut() -> bool) -> Option<Vec<Sample>> {
        let mut trust = TRUST;
        // The first trajectory need not keep ends and limits; every trajectory that does is better.
        let mut merit = f64::INFINITY;
        for _ in 0..MAX_PROGRAMS {
            if stop() {
                return None;
            }
            let Some(next) = self.improved(trust) else {
                // No step within the trust region closes the gaps.
                trust *= 3.0;
                if trust > 10.0 {
                    return None;
                }
                continue;
            };
            let (nodes, time) = (core::mem::replace(&mut self.nodes, next.nodes), self.time);
            self.time = next.time;
            let found = self.merit();
            let kept = if merit.is_finite() {
                (merit - found) / (merit - next.predicted).max(1e-12)
            } else {
                1.0
            };
            if found > merit + 1e-9 * time {
                (self.nodes, self.time) = (nodes, time);
                trust *= 0.4;
                self.proximal *= 10.0;
                if trust < MIN_TRUST {
                    break;
                }
                continue;
            }
            if kept > KEPT[1] {
                trust = (2.0 * trust).min(TRUST);
                self.proximal = (self.proximal / 4.0).max(PROXIMAL[1]);
            } else if kept < KEPT[0] {
                trust *= 0.5;
                self.proximal *= 2.0;
            }
            let settled = (merit - found) <= CONVERGED * time;
            merit = found;
            if settled && self.gap() <= CLOSED {
                let depth = self.repair()?;
                if depth <= NO_DEPTH {
                    break;
                }
                merit = self.merit();
            }
        }
        if self.gap() > 100.0 * CLOSED {
            return None;
        }
        self.samples()
    }

    /// Cost of turning (s).
    fn turning_cost(&self) -> f64 {
        let weight = TURNING_COST * self.step_time() / self.problem.limits.omega_max.powi(2);
        self.nodes
            .iter()
            .map(|node| weight * node.omega * node.omega)
            .sum()
    }

    /// Duration (s), plus the costs of turning, gaps and penetrations.
    fn merit(&self) -> f64 {
        let price = PENALTY / self.problem.limits.top_speed();
        let turn_price = PENALTY / self.problem.limits.top_turn_rate();
        let mut sum = self.time + self.turning_cost();
        let step_time = self.step_time();
        for pair in self.nodes.windows(2) {
            let step = step_dynamics::step(&pair[0], &pair[1], step_time);
            let gap = pair[1].at - pair[0].at - step.displacement;
            let turn = pair[1].theta - pair[0].theta - step.turn;
            sum += price * (gap.x.abs() + gap.y.abs()) + turn_price * turn.abs();
        }
        for (index, obstacle) in self.obstacle_field.obstacles.iter().enumerate() {
            let keep = self.obstacle_field.clearance + self.margins[index];
            for node in self.inner() {
                let near = obstacle.distance(node.at);
                if near < keep {
                    let depth = keep - obstacle.contact(node.at).distance;
                    sum += price * (depth - NO_DEPTH).max(0.0);
                }
            }
        }
        sum
    }

    /// Maximum gap (m) between the end of a step and the next node.
    fn gap(&self) -> f64 {
        let step_time = self.step_time();
        self.nodes.windows(2).fold(0.0, |most: f64, pair| {
            let step = step_dynamics::step(&pair[0], &pair[1], step_time);
            most.max((pair[1].at - pair[0].at - step.displacement).norm())
        })
    }

    fn step_time(&self) -> f64 {
        self.time / (self.nodes.len() - 1) as f64
    }

    fn inner(&self) -> &[Node] {
        &self.nodes[1..self.nodes.len() - 1]
    }

    /// Grows the obstacles that the path between nodes penetrates; returns the maximum depth (m).
    fn repair(&mut self) -> Option<f64> {
        let points = path_points::of_samples(&self.samples()?);
        let depths = self.obstacle_field.depths(&points);
        Some(grow_margins(&depths, &mut self.margins))
    }

    /// The sampled trajectory; `None` if it needs too many samples.
    fn samples(&self) -> Option<Vec<Sample>> {
        let step_time = self.step_time();
        let parts = |a: &Node, b: &Node| {
            let distance = a.v.max(b.v) * step_time;
            let turn = a.omega.abs().max(b.omega.abs()) * step_time;
            (distance / SPACING)
                .max(turn / TURN_SPACING)
                .ceil()
                .max(1.0)
        };
        let all: f64 = self
            .nodes
            .windows(2)
            .map(|pair| parts(&pair[0], &pair[1]))
            .sum();
        if all > MAX_SAMPLES {
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
        let mut samples = vec![sample(0.0, &self.nodes[0])];
        for (k, pair) in self.nodes.windows(2).enumerate() {
            let (a, b) = (&pair[0], &pair[1]);
            let parts = parts(a, b);
            for i in 1..parts as usize {
                let part = i as f64 / parts;
                let node = step_dynamics::within(a, b, step_time, part);
                samples.push(sample((k as f64 + part) * step_time, &node));
            }
            samples.push(sample((k + 1) as f64 * step_time, b));
        }
        Some(samples)
    }
}

/// Pose and speeds at a time, by linear interpolation.
fn sample_at(samples: &[Sample], t: f64) -> Node {
    let after = samples
        .partition_point(|s| s.t < t)
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
