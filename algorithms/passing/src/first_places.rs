//! Places that robots drive to first, so that each has one.

use std::collections::BTreeMap;

use nalgebra::{Point2, Vector2};

use super::assignment::assign;
use super::lattice::ShortestPaths;
use super::places::Places;
use super::spacing::Spacing;

/// Robot that passes others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traveller {
    /// Its place (m).
    pub at: Point2<f64>,
    /// Direction that it faces.
    pub forward: Vector2<f64>,
    /// Its goal (m), if that is known.
    pub goal: Option<Point2<f64>>,
}

/// Robot, and its way (m).
type Approach = (usize, Vec<Point2<f64>>);

/// Depth (m) to which a robot may come nearer to another than it has to: the rounding of ways.
const OVERLAP: f64 = 2e-3;
/// Additional cost (m²) of a place that is not reached without a robot in the way.
const PENALTY: f64 = 0.25;
/// Maximum number of assignments of robots to first places.
const ATTEMPTS: usize = 64;

/// Returns the first place of each robot, and the robots with their ways to it (m) in an order in which none is in
/// the way of another.
pub fn first_places(
    places: &Places,
    ways: &[ShortestPaths],
    spacing: &Spacing,
    robots: &[Traveller],
) -> Option<(Vec<usize>, Vec<Approach>)> {
    let mut penalties = BTreeMap::new();
    for (i, robot) in robots.iter().enumerate() {
        // Where it has arrived, it stays: that is a later decision.
        if let Some(goal) = robot.goal.and_then(|goal| places.at(goal)) {
            penalties.insert((i, goal), PENALTY);
        }
    }
    let mut best: Option<(f64, _, _)> = None;
    for _ in 0..ATTEMPTS {
        // Squares keep the order of robots in a row.
        let cost = |robot: usize, place: usize| {
            let penalty = penalties.get(&(robot, place)).copied().unwrap_or(0.0);
            ways[robot].lengths[places.cells[place]].powi(2) + penalty
        };
        let first = assign(robots.len(), places.points.len(), cost)?;
        let way = |robot: usize| {
            let mut way = ways[robot].to(&places.lattice, places.cells[first[robot]]);
            way.insert(0, robots[robot].at);
            way
        };
        let all: Vec<_> = (0..robots.len()).map(way).collect();
        let (order, worst) = order(&all, spacing.apart);
        if best.as_ref().is_none_or(|(room, ..)| worst.1 > *room) {
            let order: Vec<_> = order
                .into_iter()
                .map(|robot| (robot, all[robot].clone()))
                .collect();
            best = Some((worst.1, first.clone(), order));
        }
        if worst.1 >= -OVERLAP {
            break;
        }
        *penalties.entry((worst.0, first[worst.0])).or_insert(0.0) += PENALTY;
    }
    best.map(|(_, first, order)| (first, order))
}

/// Returns an order in which robots drive these ways (m), and the one that has the least room then, with that room (m): 0 or
/// less if it comes nearer to another than before and than `apart` (m).
fn order(ways: &[Vec<Point2<f64>>], apart: f64) -> (Vec<usize>, (usize, f64)) {
    let mut at: Vec<Point2<f64>> = ways.iter().map(|way| way[0]).collect();
    let mut left: Vec<usize> = (0..ways.len()).collect();
    let (mut order, mut worst) = (Vec::new(), (0, 0.0));
    while !left.is_empty() {
        let room = |robot: usize| {
            let others = at.iter().enumerate().filter(|(other, _)| *other != robot);
            let room = others.map(|(_, other)| {
                let far = ways[robot].iter().map(|p| (p - other).norm());
                let least = far.fold(f64::INFINITY, f64::min);
                least - apart.min((at[robot] - other).norm())
            });
            room.fold(0.0, f64::min)
        };
        let mut rooms = left.iter().map(|&robot| (robot, room(robot)));
        let enough = rooms.clone().find(|(_, room)| *room >= -OVERLAP);
        let Some((robot, room)) = enough.or_else(|| {
            rooms
                .next()
                .map(|first| rooms.fold(first, |a, b| if b.1 > a.1 { b } else { a }))
        }) else {
            break;
        };
        if room < worst.1 {
            worst = (robot, room);
        }
        left.retain(|&other| other != robot);
        at[robot] = ways[robot][ways[robot].len() - 1];
        order.push(robot);
    }
    (order, worst)
}
