//! The convex program around a trajectory.

use geometry::math;
use nalgebra::Point2;

use super::step_dynamics::{self, Node};
use super::{PENALTY, REACH, Refinement, TURNING_COST};
use crate::convex::obstacle_planes::{HalfPlane, surface};
use crate::convex::quadratic_program::QuadraticProgram;
use crate::convex::scaling::Scaling;

/// Indices of a node's variables.
const X: usize = 0;
const Y: usize = 1;
const THETA: usize = 2;
const V: usize = 3;
const OMEGA: usize = 4;
const EACH: usize = 5;

/// Result of a program.
pub(super) struct Next {
    pub nodes: Vec<Node>,
    /// Duration (s).
    pub time: f64,
    /// Predicted merit, if the linearisation were exact.
    pub predicted: f64,
}

impl Refinement<'_> {
    /// Solves the program around the last nodes.
    pub(super) fn improved(&self, trust: f64) -> Option<Next> {
        let count = self.nodes.len();
        let duration = EACH * count;
        let holds = self.holds();
        let mut program = QuadraticProgram::new(duration + 1 + holds.len());
        program.add_linear(duration, 1.0);
        self.add_proximal(&mut program);
        self.add_motion(&mut program);
        self.add_limits(&mut program);
        self.add_ends(&mut program);
        // Trust region.
        for (k, node) in self.nodes.iter().enumerate() {
            let var = EACH * k + THETA;
            program.at_most([(var, 1.0)], node.theta + trust);
            program.at_most([(var, -1.0)], trust - node.theta);
        }
        program.at_most([(duration, 1.0)], self.time * (1.0 + trust));
        program.at_most([(duration, -1.0)], -self.time * (1.0 - trust.min(0.9)));
        let price = PENALTY / self.problem.limits.top_speed();
        for (i, (node, plane)) in holds.iter().enumerate() {
            let slack = duration + 1 + i;
            let var = EACH * node;
            program.add_linear(slack, price);
            program.at_most([(slack, -1.0)], 0.0);
            let terms = [
                (var + X, -plane.normal.x),
                (var + Y, -plane.normal.y),
                (slack, -1.0),
            ];
            program.at_most(terms, -plane.line);
        }
        let z = program.solve(self.effort)?;
        let node = |k: usize| {
            let at = &z[EACH * k..EACH * (k + 1)];
            Node {
                at: Point2::new(at[X], at[Y]),
                theta: at[THETA],
                // Errors of the solver beyond the limit would be a robot that reverses.
                v: at[V].max(0.0),
                omega: at[OMEGA],
            }
        };
        let nodes: Vec<Node> = (0..count).map(node).collect();
        let depths: f64 = z[duration + 1..].iter().map(|slack| slack.max(0.0)).sum();
        let calm = TURNING_COST * self.step_time() / self.problem.limits.omega_max.powi(2);
        let turning_cost: f64 = nodes
            .iter()
            .map(|node| calm * node.omega * node.omega)
            .sum();
        let time = z[duration];
        (time > 0.0).then_some(Next {
            nodes,
            time,
            predicted: time + turning_cost + price * depths,
        })
    }

    fn add_proximal(&self, program: &mut QuadraticProgram) {
        let limits = &self.problem.limits;
        let weights = [
            0.0,
            0.0,
            self.proximal,
            self.proximal / (limits.v_max * limits.v_max),
            self.proximal / (limits.omega_max * limits.omega_max),
        ];
        for (k, node) in self.nodes.iter().enumerate() {
            let values = [node.at.x, node.at.y, node.theta, node.v, node.omega];
            for (i, (weight, value)) in weights.iter().zip(values).enumerate() {
                let weight = weight * self.step_time();
                program.add_quadratic(EACH * k + i, EACH * k + i, weight);
                program.add_linear(EACH * k + i, -weight * value);
            }
            let calm = TURNING_COST * self.step_time() / (limits.omega_max * limits.omega_max);
            program.add_quadratic(EACH * k + OMEGA, EACH * k + OMEGA, 2.0 * calm);
        }
    }

    /// Adds the motion: each node is the end of the step from the last one.
    fn add_motion(&self, program: &mut QuadraticProgram) {
        let steps = self.nodes.len() - 1;
        let duration = EACH * self.nodes.len();
        let (step_time, per_step) = (self.step_time(), 1.0 / steps as f64);
        for (k, pair) in self.nodes.windows(2).enumerate() {
            let (a, b) = (&pair[0], &pair[1]);
            let step = step_dynamics::step(a, b, step_time);
            let (i, j) = (EACH * k, EACH * (k + 1));
            for axis in [X, Y] {
                let by = [
                    (i + THETA, step.by_theta[axis], a.theta),
                    (i + V, step.by_v[0][axis], a.v),
                    (j + V, step.by_v[1][axis], b.v),
                    (i + OMEGA, step.by_omega[0][axis], a.omega),
                    (j + OMEGA, step.by_omega[1][axis], b.omega),
                    (duration, step.by_time[axis] * per_step, self.time),
                ];
                let known: f64 = by.iter().map(|(_, slope, at)| slope * at).sum();
                let terms = [(j + axis, 1.0), (i + axis, -1.0)];
                let slopes = by.iter().map(|&(var, slope, _)| (var, -slope));
                program.equal(
                    terms.into_iter().chain(slopes),
                    step.displacement[axis] - known,
                );
            }
            // θ₁ − θ₀ = (ω₀ + ω₁) h / 2.
            let (rate, half) = (0.5 * (a.omega + b.omega) * per_step, 0.5 * step_time);
            let terms = [
                (j + THETA, 1.0),
                (i + THETA, -1.0),
                (i + OMEGA, -half),
                (j + OMEGA, -half),
                (duration, -rate),
            ];
            program.equal(terms, -rate * self.time);
        }
    }

    /// Adds the limits of speeds, wheels and accelerations.
    fn add_limits(&self, program: &mut QuadraticProgram) {
        let limits = &self.problem.limits;
        let count = self.nodes.len();
        let duration = EACH * count;
        let per_step = 1.0 / (count - 1) as f64;
        for k in 0..count {
            let (v, omega) = (EACH * k + V, EACH * k + OMEGA);
            program.at_most([(v, -1.0)], 0.0);
            program.at_most([(v, 1.0)], limits.v_max);
            program.at_most([(omega, 1.0)], limits.omega_max);
            program.at_most([(omega, -1.0)], limits.omega_max);
            if let Some(wheels) = &limits.wheels {
                let half = 0.5 * wheels.separation;
                program.at_most([(v, 1.0), (omega, half)], wheels.speed);
                program.at_most([(v, 1.0), (omega, -half)], wheels.speed);
            }
            if k == 0 {
                continue;
            }
            for (offset, limit) in [
                (V, limits.acceleration),
                (OMEGA, limits.angular_acceleration),
            ] {
                let Some(limit) = limit else { continue };
                let (now, before) = (EACH * k + offset, EACH * (k - 1) + offset);
                let most = (duration, -limit * per_step);
                program.at_most([(now, 1.0), (before, -1.0), most], 0.0);
                program.at_most([(now, -1.0), (before, 1.0), most], 0.0);
            }
        }
    }

    fn add_ends(&self, program: &mut QuadraticProgram) {
        let problem = self.problem;
        let last = EACH * (self.nodes.len() - 1);
        // A heading may be any of its representatives: the one nearest to the last node is used.
        let near = self.nodes.last().map_or(0.0, |node| node.theta);
        let heading = problem
            .goal_heading
            .map(|heading| near + math::angle_difference(heading, near));
        let ends = [
            (X, Some(problem.start.x)),
            (Y, Some(problem.start.y)),
            (THETA, Some(problem.start.theta)),
            (V, problem.start_speed),
            (OMEGA, problem.start_turn_rate),
            (last + X, Some(problem.goal.x)),
            (last + Y, Some(problem.goal.y)),
            (last + THETA, heading),
            (last + V, problem.goal_speed),
        ];
        for (var, value) in ends {
            if let Some(value) = value {
                program.equal([(var, 1.0)], value);
            }
        }
        let bounds = &self.obstacle_field.bounds;
        for k in 1..self.nodes.len() - 1 {
            for (offset, low, high) in [
                (X, bounds.min.x, bounds.max.x),
                (Y, bounds.min.y, bounds.max.y),
            ] {
                program.at_most([(EACH * k + offset, 1.0)], high);
                program.at_most([(EACH * k + offset, -1.0)], -low);
            }
        }
    }

    /// Nodes and the half-planes that keep them away from near obstacles.
    fn holds(&self) -> Vec<(usize, HalfPlane)> {
        let clearance = self.obstacle_field.clearance;
        let step = self.problem.limits.top_speed() * self.step_time();
        let mut holds = Vec::new();
        for (index, obstacle) in self.obstacle_field.obstacles.iter().enumerate() {
            let keep = clearance + self.margins[index];
            for (i, node) in self.inner().iter().enumerate() {
                if obstacle.distance(node.at) > keep + REACH + step {
                    continue;
                }
                let contact = obstacle.contact(node.at);
                let surface = surface(node.at, &contact);
                let plane = HalfPlane::ahead_of(surface, contact.normal, keep, &Scaling::WORLD);
                holds.push((i + 1, plane));
            }
        }
        holds
    }
}
