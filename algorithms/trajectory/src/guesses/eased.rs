//! A path driven at full speed, with the headings of its ends eased in: the robot swerves into it.

use core::f64::consts::TAU;

use geometry::math;
use navigation::tangent_graph::PathLeg;

use super::along_path::Along;
use crate::path_points::MAX_LENGTH;
use crate::plan::Sample;
use crate::problem::Problem;

/// Number of stages.
const STAGES: usize = 256;

/// Guesses along each path, ahead and (if the robot may reverse) backwards, that turn into the path the
/// shorter and the longer way round. Positions and headings do not fit each other.
pub fn eased<'a>(
    problem: &'a Problem,
    paths: &'a [Vec<PathLeg>],
) -> impl Iterator<Item = Vec<Sample>> {
    let ways = if problem.limits.may_reverse() { 4 } else { 2 };
    paths.iter().flat_map(move |path| {
        (0..ways).filter_map(move |way| {
            let along = Along::new(problem, path, way >= 2)?;
            (along.length() <= MAX_LENGTH).then(|| samples(problem, &along, way % 2 == 1))
        })
    })
}

fn samples(problem: &Problem, along: &Along<'_>, long_way: bool) -> Vec<Sample> {
    let limits = &problem.limits;
    let length = along.length();
    let speed = if along.is_backwards() {
        limits.top_speed().min(-limits.v_min)
    } else {
        limits.top_speed()
    };
    let mut into = math::angle_difference(along.pose(0.0).theta, problem.start.theta);
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
