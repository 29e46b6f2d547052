//! Search in the controls: the fastest motion near a guess.
//!
//! The shortest path is not the fastest for a robot that turns slowly or whose speeds cannot step, and
//! the best path depends on the speeds along it. From rough guesses, [`optimal_control`] searches for
//! local optima in poses, speeds and the duration: first on a few stages from every guess, then on more
//! from the best. The path between the nodes is tested at every point; an obstacle that it touches
//! grows, and the search continues.

mod samples;
mod starts;

use optimal_control::Search;

use crate::convex::effort::Effort;
use crate::course::Course;
use crate::plan::Sample;
use starts::{Coarse, FINER, Starts, formulated};
use trajectory_problem::Problem;

/// Excess of a coarse solution's duration over the best, relative to it, up to which it is searched
/// on more stages: few stages make errors of this size.
const CONTENDER: f64 = 2e-3;
/// Distance of two trajectories, relative to the length that the robot can drive in their duration,
/// below which they are the same optimum.
const SAME: f64 = 0.01;
/// Excess of the coarse solutions over the lower bound, relative to it, above which there may be better ones of
/// another kind (without inertia: otherwise the bound is too low to tell).
const FAR: f64 = 5e-3;

/// Share of the work after which only what is begun is finished.
const COARSE_SHARE: f64 = 0.5;
/// Excess of a duration over that of a failed search, relative to it, up to which another start goes before the
/// repetition.
const RIVAL: f64 = 1e-2;
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
pub struct SearchResult {
    /// The fastest local optimum.
    pub optimum: Option<Optimum>,
    /// Number of guesses from which the search failed.
    pub failed: u32,
}

/// Returns the fastest of the local optima that the guesses lead to. `stop` ends the search with the best
/// so far by `true`. A guess is a trajectory that need not satisfy any condition. Where all that have been found may be
/// of the wrong kind, further searches begin at `more` guesses, which could take less than a time (s). A search that fails
/// is repeated with more stages, with those.
pub fn search(
    problem: &Problem,
    course: &Course,
    mut guesses: Vec<Vec<Sample>>,
    more: impl FnOnce(f64) -> Vec<Vec<Sample>>,
    effort: &Effort,
    stop: &mut dyn FnMut() -> bool,
) -> SearchResult {
    let formulated = formulated(problem, &course.obstacle_field);
    let starts = Starts::new(problem, course, &formulated, effort);
    let mut each = |size: usize| {
        let is_spent = effort.is_spent() || starts.is_over(1.0);
        if !is_spent {
            effort.add(1, size);
        }
        is_spent || stop()
    };
    let mut more = Some(more);
    let mut found = SearchResult::default();
    for level in 0..FINER.len() {
        guesses.sort_by(|a, b| duration(a).total_cmp(&duration(b)));
        guesses.dedup();
        let mut round = Round {
            level,
            least: found.duration(),
            ..Round::default()
        };
        round.explore(&starts, guesses, &mut found, &mut each);
        if let Some(more) = more.take_if(|_| round.is_far(&starts)) {
            let guesses = more(round.least);
            round.explore(&starts, guesses, &mut found, &mut each);
        }
        round.finish(&starts, &mut found, &mut each);
        if starts.is_over(COARSE_SHARE) {
            break;
        }
        // A motion over an obstacle takes less time than those around it.
        let least = found.duration() * (1.0 - CONTENDER);
        round.crossing.retain(|(duration, _)| *duration < least);
        found.failed += round.crossing.len() as u32;
        guesses = round.crossing.into_iter().map(|(_, guess)| guess).collect();
        if found.optimum.is_none() || (level == 0 && found.failed > 0) {
            guesses.append(&mut round.failed);
            let more = more.take().map(|more| more(found.duration()));
            guesses.extend(more.into_iter().flatten());
        }
        if guesses.is_empty() {
            break;
        }
    }
    found
}

/// Searches that begin with the same number of stages.
#[derive(Default)]
struct Round<'a> {
    /// Index in [`FINER`].
    level: usize,
    /// Duration (s) of the best solution so far.
    least: f64,
    /// Solutions on few stages, with their guesses and levels.
    coarse: Vec<(Search<'a>, Vec<Sample>, usize)>,
    /// Guesses whose search failed or was left out.
    failed: Vec<Vec<Sample>>,
    /// Guesses that lead over an obstacle, with the duration (s) of the motion.
    crossing: Vec<(f64, Vec<Sample>)>,
}

impl<'a> Round<'a> {
    /// Searches on few stages from all guesses, in their order, as long as they could lead to the best.
    fn explore(
        &mut self,
        starts: &Starts<'a>,
        guesses: Vec<Vec<Sample>>,
        found: &mut SearchResult,
        each: &mut dyn FnMut(usize) -> bool,
    ) {
        let mut guesses = guesses.into_iter();
        for guess in guesses.by_ref() {
            let least = duration(&guess) * starts.shorter;
            if least > self.least || starts.is_over(COARSE_SHARE) {
                self.failed.push(guess);
                break;
            }
            match starts.run(&guess, self.level, each) {
                Some(Coarse::Solved(search)) => {
                    self.least = self.least.min(search.duration());
                    self.coarse.push((*search, guess, self.level));
                }
                Some(Coarse::Crossing(duration)) => self.crossing.push((duration, guess)),
                Some(Coarse::Failed) => {
                    found.failed += 1;
                    self.failed.push(guess);
                }
                Some(Coarse::Stopped) => break,
                None => {}
            }
        }
        self.failed.extend(guesses);
    }

    /// Returns `true` if there may be better solutions of another kind than those that have been found.
    fn is_far(&self, starts: &Starts<'_>) -> bool {
        starts.steps && !self.coarse.is_empty() && self.least > starts.bound * (1.0 + FAR)
    }

    /// Searches on all stages from the best solutions on few; where that fails, on more stages from its guess.
    fn finish(
        &mut self,
        starts: &Starts<'a>,
        found: &mut SearchResult,
        each: &mut dyn FnMut(usize) -> bool,
    ) {
        let same = SAME * starts.top_speed * self.least;
        let mut tried: Vec<(Search<'_>, usize)> = Vec::new();
        let mut least = found.duration();
        loop {
            let rank = |(search, _, level): &(Search<'_>, Vec<Sample>, usize)| {
                search.duration() * (1.0 + RIVAL * (level - self.level) as f64)
            };
            self.coarse.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
            let Some((search, guess, level)) = self.coarse.pop() else {
                break;
            };
            // Of the searches that have found the same optimum, the first.
            let known = tried
                .iter()
                .any(|(other, at)| level == *at && search.distance(other) < same);
            if known || search.duration() > least * (1.0 + CONTENDER) {
                continue;
            }
            if let Some(optimum) = starts.finish(search.clone(), level, each) {
                least = least.min(search.duration());
                if duration(&optimum.samples) < found.duration() {
                    found.optimum = Some(optimum);
                }
                tried.push((search, level));
                continue;
            }
            tried.push((search, level));
            found.failed += 1;
            let next = level + 1;
            if next < FINER.len()
                && let Some(Coarse::Solved(search)) = starts.run(&guess, next, each)
            {
                self.coarse.push((*search, guess, next));
            } else {
                self.failed.push(guess);
            }
        }
    }
}

impl SearchResult {
    /// Duration (s) of the optimum; infinite without one.
    pub fn duration(&self) -> f64 {
        let optimum = self.optimum.as_ref();
        optimum.map_or(f64::INFINITY, |optimum| duration(&optimum.samples))
    }
}

fn duration(samples: &[Sample]) -> f64 {
    samples.last().map_or(0.0, |last| last.t)
}
