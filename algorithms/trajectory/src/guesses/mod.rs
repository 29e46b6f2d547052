//! Start guesses for a search in the controls, one for each way to drive.
//!
//! A search in the controls finds the local optimum near its start, and the optima of slow turning
//! differ in kind: ahead, backwards, with cusps, with turns on the spot. [`guesses`] gives a
//! trajectory of each kind, of the fastest motions in free space ([`free_motion`]) and the path. They keep the limits of the speeds and, where the robot drives, of the
//! acceleration, and begin and end at the poses of the problem. They need not be free of obstacles,
//! and the turning rate may step.
//!
//! - `motion`: the trajectory of turns, arcs and straight lines.
//! - `along_path`: a path driven ahead or backwards, with a turn on the spot or a word at either end.
//!
//! For a second try, [`eased()`] gives rougher ones.

mod along_path;
mod eased;
mod motion;

pub use eased::eased;

use free_motion::Motion;
use free_motion::words::{self, Word};
use geometry::pose::Pose2;
use navigation::tangent_graph::PathLeg;

use crate::path_points::MAX_LENGTH;
use crate::plan::Sample;
use along_path::{Along, Join};
use trajectory_problem::Problem;

/// Number of words straight to the goal, of each kind.
const DIRECT: usize = 3;

/// The start guesses of a problem along paths from its start to its goal, in a fixed order and each
/// computed on demand: along each path with a turn on the spot at its ends, with words that only drive
/// on, and with Reeds–Shepp words, ahead and (if the robot may reverse) backwards; then the fastest words from start
/// to goal regardless of the paths, of those that take at least `direct` (s), if any. Equal ones are left out.
pub fn guesses<'a>(
    problem: &'a Problem,
    paths: &'a [Vec<PathLeg>],
    direct: Option<f64>,
) -> impl Iterator<Item = Vec<Sample>> {
    let mut known: Vec<Vec<Motion>> = Vec::new();
    let along = paths.iter().flat_map(|path| along(problem, path));
    let words = direct
        .into_iter()
        .flat_map(move |least| self::direct(problem, least));
    along.chain(words).filter_map(move |motions| {
        if motions.is_empty() || is_too_long(&motions) || known.contains(&motions) {
            return None;
        }
        let samples = motion::samples(problem, &motions);
        known.push(motions);
        Some(samples)
    })
}

/// The time (s) of the fastest guess of a robot without inertia along a path, with no cusps.
pub fn time_along(problem: &Problem, path: &[PathLeg]) -> f64 {
    let limits = &problem.limits;
    let time = |motion: &Motion| match *motion {
        Motion::Drive { length, kappa } => length.abs() / limits.speed_at(kappa),
        Motion::Turn(angle) => angle.abs() / limits.top_turn_rate(),
    };
    let directions = [false, true]
        .into_iter()
        .take(if limits.may_reverse() { 2 } else { 1 });
    directions
        .filter_map(|backwards| Along::new(problem, path, backwards))
        .flat_map(|along| [Join::Spot, Join::Forwards].map(|join| along.motions(join)))
        .map(|motions| motions.iter().map(time).sum())
        .fold(f64::INFINITY, f64::min)
}

/// Returns `true` for motions longer than any plan: arcs of a robot that hardly turns.
fn is_too_long(motions: &[Motion]) -> bool {
    let length = |motion: &Motion| match motion {
        Motion::Drive { length, .. } => length.abs(),
        Motion::Turn(_) => 0.0,
    };
    let sum: f64 = motions.iter().map(length).sum();
    sum.is_nan() || sum > MAX_LENGTH
}

/// A path, driven in every way.
fn along(problem: &Problem, path: &[PathLeg]) -> impl Iterator<Item = Vec<Motion>> {
    let reverses = problem.limits.may_reverse();
    let joins = move |backwards: bool| {
        [Join::Spot, Join::Forwards, Join::ReedsShepp]
            .into_iter()
            .filter(move |join| reverses || *join != Join::ReedsShepp)
            .map(move |join| (backwards, join))
    };
    joins(false)
        .chain(joins(true))
        .filter(move |(backwards, _)| reverses || !backwards)
        .filter_map(move |(backwards, join)| {
            Along::new(problem, path, backwards).map(|along| along.motions(join))
        })
}

/// The fastest words from start to goal, of those that take at least this time (s).
fn direct(problem: &Problem, least: f64) -> impl Iterator<Item = Vec<Motion>> {
    let radius = turning_radius(problem);
    let (start, goal) = (problem.start, problem.goal);
    let to = move |word: fn(&Pose2, &Pose2, f64) -> Vec<Word>| {
        let mut words = match problem.goal_heading {
            Some(theta) => word(&start, &Pose2::new(goal.x, goal.y, theta), radius),
            None => words::to_place(&start, goal, radius, word),
        };
        words.retain(|word| word.cost() >= least * problem.limits.top_speed());
        words.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        words.truncate(DIRECT);
        words.into_iter().map(|word| word.motions())
    };
    let reverses = problem.limits.may_reverse();
    let back = reverses.then(move || to(words::reeds_shepp));
    to(words::forwards)
        .chain(to(words::dubins))
        .chain(back.into_iter().flatten())
}

/// Radius (m) of the curve that the robot drives at full speed and full turning rate.
fn turning_radius(problem: &Problem) -> f64 {
    let limits = &problem.limits;
    limits.top_speed() / limits.top_turn_rate()
}

#[cfg(test)]
mod tests;
