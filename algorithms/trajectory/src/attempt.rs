//! One attempt of a method: a family of curves, a search in it, and the resulting trajectory.

use geometry::math;
use nalgebra::{Point2, Vector2};

use crate::convex::curve_search::CurveSearch;
use crate::convex::effort::Effort;
use crate::convex::obstacle_planes::{NO_DEPTH, grow_margins};
use crate::convex::scaling::Scaling;
use crate::drive::sample_curve;
use crate::drive::speed_profile;
use crate::drive::trajectory_builder::Trajectory;
use crate::guide::Guide;
use crate::guide::knot_placement::{self, Headings};
use crate::guide::previous_plan::Rest;
use crate::obstacle_field::ObstacleField;
use crate::path_points::PathPoint;
use curves::bspline_basis::Basis;
use curves::lgl_nodes::Lgl;
use curves::{Camouflage, Curve, Ends, Pursuit, Spline};
use trajectory_problem::Method;
use trajectory_problem::Problem;
use trajectory_problem::{Constraints, Options};

/// Maximum number of times that a curve is recomputed because it is too near to an obstacle between
/// its samples.
const MAX_REPAIRS: u32 = 8;
/// Relative excess over the shortest path below which a curve is accepted.
const ENOUGH: f64 = 1e-5;
/// Default distance of the reference point from the bounds' corner, in diagonals of the bounds.
const REFERENCE: f64 = 2.25;

/// Turns on the spot and resolution of the curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variant {
    /// `true` if the robot turns on the spot before it starts.
    pub turn_at_start: bool,
    /// `true` if the robot turns on the spot after it has arrived.
    pub turn_at_goal: bool,
    /// Number of times that the spline's breaks are halved.
    pub level: u32,
}

/// A trajectory of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The trajectory.
    pub trajectory: Trajectory,
    /// Number of control points of the curve.
    pub control_points: usize,
}

/// State common to all attempts.
pub struct Attempts<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// The obstacle field.
    pub obstacle_field: &'a ObstacleField,
    /// Guide path.
    pub guide: &'a Guide,
    /// Length of the shortest path (m).
    pub shortest: f64,
    /// The options.
    pub options: &'a Options,
    /// Remaining part of the robot's last plan.
    pub rest: Option<Rest>,
    /// Work so far.
    pub effort: &'a Effort,
}

impl Attempts<'_> {
    /// Makes one attempt; `None` if it fails.
    pub fn attempt(&self, variant: Variant, stop: &mut dyn FnMut() -> bool) -> Option<Candidate> {
        let headings = Headings {
            start: (!variant.turn_at_start).then_some(self.problem.start.theta),
            goal: self.problem.goal_heading.filter(|_| !variant.turn_at_goal),
        };
        let frame = Scaling::new(self.guide.at(0.0), self.guide.length());
        let unit = |angle: f64| {
            let (sin, cos) = math::sincos(angle);
            Vector2::new(cos, sin)
        };
        let ends = Ends {
            start: frame.inward(self.problem.start.position()),
            goal: frame.inward(self.problem.goal),
            start_heading: headings.start.map(unit),
            goal_heading: headings.goal.map(unit),
        };
        match self.options.method {
            Method::Lp => {
                let curve = Pursuit::new(self.basis(2, headings, variant.level), ends)?;
                let (_, points) = self.search(&curve, &frame, None, stop)?;
                self.drive(&curve, &points, variant)
            }
            Method::Bspline | Method::Vmc | Method::Tangent => {
                let basis = self.basis(3, headings, variant.level);
                let curve = Spline::new(basis.clone(), ends, None)?;
                let (z, points) = self.search(&curve, &frame, None, stop)?;
                if self.options.method != Method::Vmc || stop() {
                    return self.drive(&curve, &points, variant);
                }
                let reference = frame.inward(self.reference());
                let camouflage = Camouflage::new(self.options.node_count(), reference, ends.start)?;
                let hidden = Spline::new(basis, ends, Some(camouflage))?;
                let start = hidden.hidden(&z);
                let polished = self
                    .search(&hidden, &frame, Some(start), stop)
                    .and_then(|(_, points)| self.drive(&hidden, &points, variant));
                // If polishing fails, ν = 1 everywhere and the prey's path is the robot's.
                polished.or_else(|| self.drive(&curve, &points, variant))
            }
        }
    }

    fn basis(&self, degree: usize, headings: Headings, level: u32) -> Basis {
        let degree = self.options.degree.unwrap_or(degree);
        if let Some(count) = self.options.control_points {
            return Basis::even(degree, count);
        }
        let limits = &self.problem.limits;
        let turning = limits.top_speed() / limits.top_turn_rate();
        Basis::new(
            degree,
            &knot_placement::breaks(self.guide, headings, turning, level),
        )
    }

    fn reference(&self) -> Point2<f64> {
        if let Some([x, y]) = self.options.reference_point {
            return Point2::new(x, y);
        }
        let bounds = &self.problem.bounds;
        let diagonal = (bounds.max - bounds.min).norm();
        bounds.min - Vector2::repeat(REFERENCE * diagonal)
    }

    /// A free curve of the family, with its points.
    fn search(
        &self,
        curve: &dyn Curve,
        frame: &Scaling,
        mut from: Option<Vec<f64>>,
        stop: &mut dyn FnMut() -> bool,
    ) -> Option<(Vec<f64>, Vec<PathPoint>)> {
        let mut search =
            CurveSearch::new(self.obstacle_field, self.guide, *frame, curve, self.effort);
        search.shortest = self.shortest;
        search.near = self.rest.as_ref().map(|rest| &rest.guide);
        let theta = self.problem.start.theta;
        let nodes_only = self.options.constraints == Constraints::Nodes;
        if nodes_only {
            let nodes = Lgl::new(self.options.node_count()).nodes;
            search.only_at = Some(nodes.iter().map(|x| 0.5 * (x + 1.0)).collect());
        }
        let mut result = None;
        for _ in 0..=MAX_REPAIRS {
            let z = search.run(from.take(), ENOUGH, stop);
            let Some(z) = z else { break };
            let Some(points) = sample_curve::path(curve, &z, frame, theta, &self.problem.limits)
            else {
                break;
            };
            let deepest = grow_margins(&self.obstacle_field.depths(&points), &mut search.margins);
            if deepest <= NO_DEPTH || nodes_only {
                result = Some((z, points));
                break;
            }
            if stop() {
                break;
            }
            from = Some(z);
        }
        result
    }

    /// Builds the trajectory over the points: turns, speeds, arrival.
    fn drive(
        &self,
        curve: &dyn Curve,
        points: &[PathPoint],
        variant: Variant,
    ) -> Option<Candidate> {
        let problem = self.problem;
        let limits = &problem.limits;
        let turns = limits.angular_acceleration.is_some();
        // During a turn on the spot V = 0. V begins and ends as prescribed unless it can step, and
        // with 0 where ω cannot step from a turn on the spot into a bend.
        let end = |on_the_spot: bool, asked: Option<f64>| match limits.acceleration {
            Some(_) if on_the_spot => Some(0.0),
            Some(_) => asked,
            None => (on_the_spot && turns).then_some(0.0),
        };
        let start = end(variant.turn_at_start, problem.start_speed);
        let end = end(variant.turn_at_goal, problem.goal_speed);
        let speeds = speed_profile::speeds(points, limits, start, end)?;
        let mut trajectory = Trajectory::from_start(&problem.start);
        if variant.turn_at_start {
            let first = points.first()?.theta;
            trajectory.turn(limits, math::angle_difference(first, problem.start.theta));
        }
        trajectory.drive(points, &speeds);
        trajectory.settle(problem.goal);
        if variant.turn_at_goal
            && let Some(heading) = problem.goal_heading
        {
            let angle = math::angle_difference(heading, trajectory.heading());
            trajectory.turn(limits, angle);
        }
        trajectory.keep_ends(problem);
        Some(Candidate {
            trajectory,
            control_points: curve.control_points(),
        })
    }
}
