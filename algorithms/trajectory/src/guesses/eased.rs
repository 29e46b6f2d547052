//! A path driven at full speed, with the headings of its ends eased in: the robot swerves into it.

use core::f64::consts::TAU;

use geometry::math;
use navigation::tangent_graph::PathLeg;

use super::along_path::Along;
use crate::path_points::MAX_LENGTH;
use crate::plan::Sample;
use trajectory_problem::Problem;

/// Number of stages.
const STAGES: usize = 256;

/// Guesses along each path, ahead and (if the robot may reverse) backwards: first those that turn into the
/// path the shorter way round, then those the longer way. Those that take longer than `most` (s) are left out, by
/// the path at full speed and the longer turn. Positions and headings do not fit each other.
pub fn eased(problem: &Problem, paths: &[Vec<PathLeg>], most: f64) -> Vec<Vec<Sample>> {
    let backwards = [false, true];
    let directions = &backwards[..if problem.limits.may_reverse() { 2 } else { 1 }];
    let mut guesses = Vec::new();
    for long_way in [false, true] {
        for (path, &backwards) in paths
            .iter()
            .flat_map(|p| directions.iter().map(move |d| (p, d)))
        {
            let Some(along) = Along::new(problem, path, backwards) else {
                continue;
            };
            let turn = if long_way {
                TAU - into(problem, &along).abs()
            } else {
                0.0
            };
            let least = (along.length() / speed(problem, &along))
                .max(turn / problem.limits.top_turn_rate());
            if along.length() <= MAX_LENGTH && least < most {
                guesses.push(samples(problem, &along, long_way));
            }
        }
    }
    guesses
}

/// The turn (rad) from the heading at the start into a path, the shorter way round.
fn into(problem: &Problem, along: &Along<'_>) -> f64 {
    math::angle_difference(along.pose(0.0).theta, problem.start.theta)
}

/// Top speed (m/s) along a path.
fn speed(problem: &Problem, along: &Along<'_>) -> f64 {
    let limits = &problem.limits;
    if along.is_backwards() {
        limits.top_speed().min(-limits.v_min)
    } else {
        limits.top_speed()
    }
}

fn samples(problem: &Problem, along: &Along<'_>, long_way: bool) -> Vec<Sample> {
    let limits = &problem.limits;
    let length = along.length();
    let speed = speed(problem, along);
    let mut into = into(problem, along);
    if long_way {
        into -= TAU.copysign(into);
    }
    let out = problem.goal_heading.map_or(0.0, |theta| {
        math::angle_difference(theta, along.pose(length).theta)
    });
    // The part of a turn that is left at a distance from the end with this turn.
    let left = |turn: f64, distance: f64| {
        let reach = (turn.abs() * speed / limits.top_turn_rate()).min(0.5 * length);
        turn * (1.0 - distance / reach.max(f64::MIN_POSITIVE)).max(0.0)
    };
    let mut heading = problem.start.theta + into;
    let mut samples: Vec<Sample> = Vec::with_capacity(STAGES + 1);
    for i in 0..=STAGES {
        let s = length * i as f64 / STAGES as f64;
        let at = along.pose(s);
        heading += math::angle_difference(at.theta, heading);
        let theta = heading - left(into, s) + left(out, length - s);
        let t = s / speed;
        let omega = samples
            .last()
            .map_or(0.0, |last| (theta - last.theta) / (t - last.t));
        samples.push(Sample {
            t,
            x: at.x,
            y: at.y,
            theta,
            v: if along.is_backwards() { -speed } else { speed },
            omega: omega.clamp(-limits.top_turn_rate(), limits.top_turn_rate()),
        });
    }
    samples
}
