//! Searches from guesses: on few stages, and from there on all.

use optimal_control::{COARSE, KeepOutDisc, MAX_STAGES, Node, Search};

use super::{Optimum, samples};
use crate::convex::effort::Effort;
use crate::convex::obstacle_planes::{NO_DEPTH, grow_margins};
use crate::course::Course;
use crate::lower_bound::lower_bound;
use crate::obstacle_field::ObstacleField;
use crate::path_points;
use crate::plan::Sample;
use trajectory_problem::Problem;

/// Maximum number of times that obstacles grow.
const MAX_REPAIRS: u32 = 8;
/// Duration of a guess for a robot with inertia, relative to that without.
const SLOWER: f64 = 1.05;
/// Least duration of a search's result, relative to its guess, without and with inertia (which guesses
/// lack): guesses from which no result could be the best are not tried.
const SHORTER: [f64; 2] = [0.8, 0.9];
/// Residual above which a coarse solution is none.
const MAX_RESIDUAL: f64 = 1e-3;
/// Multiples of the number of coarse stages: of the first search from a guess, and of those after it fails.
pub const FINER: [f64; 3] = [1.0, 2.0, 4.0];

/// Maximum work of all searches.
const MAX_WORK: f64 = 1.2e6;
/// Maximum work of one search on few stages, and of one on all stages, per stage of a guess: more than nearly all need
/// that succeed.
const MAX_COARSE: f64 = 5e3;
const MAX_FINE: f64 = 2e4;
/// Depth of a coarse solution in an obstacle, relative to the smallest obstacle's radius, from which on it
/// passes over it between two nodes.
const CROSSED: f64 = 0.2;

/// Maximum number of steps of a search on all stages, between two growths of obstacles.
const MAX_STEPS: u32 = 150;

/// Result of a search on few stages.
pub enum Coarse<'a> {
    /// A local optimum.
    Solved(Box<Search<'a>>),
    /// A motion over an obstacle, with its duration (s).
    Crossing(f64),
    /// None.
    Failed,
    /// The work or the time is spent.
    Stopped,
}

/// Common values of the searches of a problem.
pub struct Starts<'a> {
    formulated: &'a optimal_control::Problem<'a>,
    obstacle_field: &'a ObstacleField,
    effort: &'a Effort,
    /// Work before the first search.
    begun: u64,
    /// Lower bound (s).
    pub bound: f64,
    /// Least duration of a search's result, relative to its guess.
    pub shorter: f64,
    /// `true` if speeds may step.
    pub steps: bool,
    /// Maximum speed (m/s).
    pub top_speed: f64,
}

impl<'a> Starts<'a> {
    /// The searches of a problem, also as the method states it.
    pub fn new(
        problem: &Problem,
        course: &'a Course,
        formulated: &'a optimal_control::Problem<'a>,
        effort: &'a Effort,
    ) -> Self {
        let steps = problem.limits.is_without_inertia();
        Self {
            formulated,
            obstacle_field: &course.obstacle_field,
            effort,
            begun: effort.work(),
            bound: lower_bound(problem, course.shortest),
            shorter: SHORTER[usize::from(!steps)],
            steps,
            top_speed: problem.limits.top_speed(),
        }
    }

    /// Returns `true` if this share of the work of all searches is spent.
    pub fn is_over(&self, share: f64) -> bool {
        (self.effort.work() - self.begun) as f64 > share * MAX_WORK
    }

    /// Searches on few stages, with the multiple of their number of a level; `None` if the guess is none.
    pub fn run(
        &self,
        guess: &[Sample],
        level: usize,
        each: &mut dyn FnMut(usize) -> bool,
    ) -> Option<Coarse<'a>> {
        let mut search = begin(self.formulated, self.obstacle_field, guess, FINER[level])?;
        let last = self.effort.work() + most_work(&search, level, MAX_COARSE);
        let outcome = search.run_coarse(&mut |size| self.effort.work() > last || each(size));
        Some(if outcome.stopped && self.effort.work() <= last {
            Coarse::Stopped
        } else if outcome.residual > MAX_RESIDUAL {
            Coarse::Failed
        } else if search.duration() < self.bound || self.crosses(&search) {
            Coarse::Crossing(search.duration())
        } else {
            Coarse::Solved(Box::new(search))
        })
    }

    /// Searches on all stages, from a solution on few.
    pub fn finish(
        &self,
        search: Search<'a>,
        level: usize,
        each: &mut dyn FnMut(usize) -> bool,
    ) -> Option<Optimum> {
        let last = self.effort.work() + most_work(&search, level, MAX_FINE);
        finished(search, self.obstacle_field, &mut |size| {
            self.effort.work() > last || each(size)
        })
    }

    fn crosses(&self, search: &Search<'_>) -> bool {
        let most = CROSSED * self.obstacle_field.smallest();
        samples::from_solution(&search.solution()).is_none_or(|samples| {
            let depths = self
                .obstacle_field
                .depths(&path_points::of_samples(&samples));
            depths.iter().any(|(_, depth)| *depth > most)
        })
    }
}

/// Maximum work of a search with this much per stage that it had at the first level.
fn most_work(search: &Search<'_>, level: usize, per_stage: f64) -> u64 {
    (per_stage * search.stages() as f64 / FINER[level]) as u64
}

/// The problem for the method.
pub fn formulated<'a>(
    problem: &Problem,
    obstacle_field: &'a ObstacleField,
) -> optimal_control::Problem<'a> {
    optimal_control::Problem {
        start: problem.start.position(),
        start_heading: problem.start.theta,
        start_speeds: [problem.start_speed, problem.start_turn_rate],
        goal: problem.goal,
        goal_heading: problem.goal_heading,
        goal_speed: problem.goal_speed,
        limits: problem.limits,
        bounds: obstacle_field.bounds,
        obstacles: obstacle_field
            .obstacles
            .iter()
            .map(|shape| KeepOutDisc {
                shape,
                distance: obstacle_field.clearance,
            })
            .collect(),
    }
}

/// A search from a guess on a multiple of the usual number of stages; `None` if the guess has no duration, or is so long that steps between
/// nodes would pass over obstacles.
fn begin<'a>(
    formulated: &'a optimal_control::Problem<'a>,
    obstacle_field: &ObstacleField,
    samples: &[Sample],
    finer: f64,
) -> Option<Search<'a>> {
    let time = samples.last()?.t;
    if !(time > 0.0 && time.is_finite()) {
        return None;
    }
    let length: f64 = samples
        .windows(2)
        .map(|pair| geometry::math::hypot(pair[1].x - pair[0].x, pair[1].y - pair[0].y))
        .sum();
    let smallest = obstacle_field.smallest();
    let stages = finer * (length / smallest).ceil().max(COARSE as f64);
    if stages > MAX_STAGES as f64 {
        return None;
    }
    let limits = &formulated.limits;
    let inertia = limits.acceleration.is_some() || limits.angular_acceleration.is_some();
    let slower = if inertia { SLOWER } else { 1.0 };
    let count = stages as usize;
    let nodes: Vec<Node> = (0..=count)
        .map(|k| {
            let node = samples::at(samples, time * k as f64 / stages);
            Node {
                v: node.v / slower,
                omega: node.omega / slower,
                ..node
            }
        })
        .collect();
    Search::new(formulated, &nodes, time * slower)
}

/// Searches on all stages and lets obstacles grow until the path between nodes is free.
fn finished(
    mut search: Search<'_>,
    obstacle_field: &ObstacleField,
    each: &mut dyn FnMut(usize) -> bool,
) -> Option<Optimum> {
    let mut margins = vec![0.0; obstacle_field.obstacles.len()];
    for _ in 0..=MAX_REPAIRS {
        let mut steps = 0;
        let outcome = search.run(&mut |size| {
            steps += 1;
            steps > MAX_STEPS || each(size)
        });
        if !outcome.is_optimal() {
            return None;
        }
        let samples = samples::from_solution(&search.solution())?;
        let depths = obstacle_field.depths(&path_points::of_samples(&samples));
        let old = margins.clone();
        if grow_margins(&depths, &mut margins) <= NO_DEPTH {
            return Some(Optimum {
                samples,
                residual: outcome.residual,
            });
        }
        for (i, (new, old)) in margins.iter().zip(&old).enumerate() {
            if new > old {
                search.grow(i, new - old);
            }
        }
    }
    None
}
