//! Search in the controls: the fastest motion near a guess.
//!
//! The shortest path is not the fastest for a robot that turns slowly or whose speeds cannot step, and
//! the best path depends on the speeds along it. From rough guesses, [`optimal_control`] searches for
//! local optima in poses, speeds and the duration: first on a few stages from every guess, then on more
//! from the best. The path between the nodes is tested at every point; an obstacle that it touches
//! grows, and the search continues.

mod samples;

use optimal_control::{COARSE, Keep, Limits, MAX_STAGES, Node, Search};

use crate::convex::effort::Effort;
use crate::convex::obstacle_planes::{NO_DEPTH, grow_margins};
use crate::course::Course;
use crate::lower_bound::lower_bound;
use crate::obstacle_field::ObstacleField;
use crate::path_points;
use crate::plan::Sample;
use crate::problem::Problem;

/// Maximum number of times that obstacles grow.
const MAX_REPAIRS: u32 = 8;
/// Duration of a guess for a robot with inertia, relative to that without.
const SLOWER: f64 = 1.05;
/// Least duration of a search's result, relative to its guess, without and with inertia (which guesses
/// lack): guesses from which no result could be the best are not tried.
const SHORTER: [f64; 2] = [0.8, 0.9];
/// Excess of a coarse solution's duration over the best, relative to it, up to which it is searched
/// on more stages: few stages make errors of this size.
const CONTENDER: f64 = 2e-3;
/// Distance of two trajectories, relative to the length that the robot can drive in their duration,
/// below which they are the same optimum.
const SAME: f64 = 0.01;
/// Residual above which a coarse solution is none.
const MAX_RESIDUAL: f64 = 1e-3;

/// Multiples of the number of coarse stages: of the first search from a guess, and of those after it fails.
const FINER: [f64; 3] = [1.0, 2.0, 4.0];

/// Maximum work of all searches, and the share of it after which only what is begun is finished.
const MAX_WORK: f64 = 1.5e6;
const COARSE_SHARE: f64 = 0.5;
/// Depth of a coarse solution in an obstacle, relative to the smallest obstacle's radius, from which on it
/// passes over it between two nodes.
const CROSSED: f64 = 0.2;

/// Maximum number of steps of a search on all stages, between two growths of obstacles.
const MAX_STEPS: u32 = 150;

/// A local optimum.
#[derive(Debug)]
pub struct Optimum {
    /// The trajectory.
    pub samples: Vec<Sample>,
    /// Largest error of the first-order conditions.
    pub residual: f64,
}

/// Result of the searches from all guesses.
#[derive(Debug, Default)]
pub struct Found {
    /// The fastest local optimum.
    pub optimum: Option<Optimum>,
    /// Number of guesses from which the search failed.
    pub failed: u32,
}

/// Returns the fastest of the local optima that the guesses lead to. `stop` ends the search with the best
/// so far by `true`. A guess is a trajectory that need not satisfy any condition. Where a search fails that
/// could have found the best, it is repeated with more stages, beside those from `more` guesses.
pub fn search(
    problem: &Problem,
    course: &Course,
    mut guesses: Vec<Vec<Sample>>,
    more: impl FnOnce() -> Vec<Vec<Sample>>,
    effort: &Effort,
    stop: &mut dyn FnMut() -> bool,
) -> Found {
    let obstacle_field = &course.obstacle_field;
    let bound = lower_bound(problem, course.shortest);
    let formulated = formulated(problem, obstacle_field);
    let inertia = !problem.limits.is_without_inertia();
    let shorter = SHORTER[usize::from(inertia)];
    let begun = effort.work();
    let is_over = |share: f64| (effort.work() - begun) as f64 > share * MAX_WORK;
    let mut each = |size: usize| {
        let is_spent = effort.is_spent() || is_over(1.0);
        if !is_spent {
            effort.add(1, size);
        }
        is_spent || stop()
    };
    let most = CROSSED * obstacle_field.smallest();
    let crosses = |search: &Search<'_>| {
        samples::of(&search.solution()).is_none_or(|samples| {
            let depths = obstacle_field.depths(&path_points::of_samples(&samples));
            depths.iter().any(|(_, depth)| *depth > most)
        })
    };
    let mut more = Some(more);
    let mut found = Found::default();
    for finer in FINER {
        guesses.sort_by(|a, b| duration(a).total_cmp(&duration(b)));
        guesses.dedup();
        let mut least = found.duration();
        let mut coarse: Vec<(Search<'_>, Vec<Sample>)> = Vec::new();
        let (mut failed, mut crossing) = (Vec::new(), Vec::<(Search<'_>, _)>::new());
        let mut untried = guesses.into_iter();
        for samples in untried.by_ref() {
            if duration(&samples) * shorter > least || is_over(COARSE_SHARE) {
                failed.push(samples);
                break;
            }
            let Some(mut search) = begin(&formulated, obstacle_field, &samples, finer) else {
                continue;
            };
            let outcome = search.run_coarse(&mut each);
            if outcome.stopped {
                break;
            }
            if outcome.residual > MAX_RESIDUAL {
                found.failed += 1;
                failed.push(samples);
            } else if search.duration() < bound || crosses(&search) {
                crossing.push((search, samples));
            } else {
                least = least.min(search.duration());
                coarse.push((search, samples));
            }
        }
        coarse.sort_by(|a, b| a.0.duration().total_cmp(&b.0.duration()));
        let same = SAME * problem.limits.top_speed() * least;
        let mut tried: Vec<Search<'_>> = Vec::new();
        let mut least = found.duration();
        for (search, guess) in coarse {
            // Of the searches that have found the same optimum, the first.
            let known = tried.iter().any(|other| search.distance(other) < same);
            if known || search.duration() > least * (1.0 + CONTENDER) {
                continue;
            }
            if let Some(optimum) = finish(search.clone(), obstacle_field, &mut each) {
                least = least.min(search.duration());
                if duration(&optimum.samples) < found.duration() {
                    found.optimum = Some(optimum);
                }
            } else {
                found.failed += 1;
                failed.push(guess);
            }
            tried.push(search);
        }
        if is_over(COARSE_SHARE) {
            break;
        }
        // A motion over an obstacle takes less time than those around it.
        let least = found.duration() * (1.0 - CONTENDER);
        crossing.retain(|(search, _)| search.duration() < least);
        found.failed += crossing.len() as u32;
        guesses = crossing.into_iter().map(|(_, samples)| samples).collect();
        if found.optimum.is_none() || (finer == FINER[0] && found.failed > 0) {
            guesses.append(&mut failed);
            guesses.extend(untried);
            guesses.extend(more.take().map(|more| more()).into_iter().flatten());
        }
        if guesses.is_empty() {
            break;
        }
    }
    found
}

impl Found {
    /// Duration (s) of the optimum; infinite without one.
    pub fn duration(&self) -> f64 {
        let optimum = self.optimum.as_ref();
        optimum.map_or(f64::INFINITY, |optimum| duration(&optimum.samples))
    }
}

fn duration(samples: &[Sample]) -> f64 {
    samples.last().map_or(0.0, |last| last.t)
}

/// The problem for the method.
fn formulated<'a>(
    problem: &Problem,
    obstacle_field: &'a ObstacleField,
) -> optimal_control::Problem<'a> {
    let limits = &problem.limits;
    optimal_control::Problem {
        start: problem.start.position(),
        start_heading: problem.start.theta,
        start_speeds: [problem.start_speed, problem.start_turn_rate],
        goal: problem.goal,
        goal_heading: problem.goal_heading,
        goal_speed: problem.goal_speed,
        limits: Limits {
            v: [limits.v_min, limits.v_max],
            omega: limits.omega_max,
            wheels: limits
                .wheels
                .map(|wheels| [wheels.speed, wheels.separation]),
            acceleration: limits.acceleration,
            angular_acceleration: limits.angular_acceleration,
        },
        bounds: obstacle_field.bounds,
        obstacles: obstacle_field
            .obstacles
            .iter()
            .map(|shape| Keep {
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
fn finish(
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
        let samples = samples::of(&search.solution())?;
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
