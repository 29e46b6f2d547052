//! Order in which robots visit places.

use nalgebra::Point2;
use planner_view::free_space::FreeSpace;

use super::first_places::{Traveller, first_places};
use super::lattice::ShortestPaths;
use super::places::Places;
use super::spacing::{Spacing, to_segment};
use super::{Move, moves};

/// Distance (m) from a place within which a robot has arrived there.
const THERE: f64 = 0.05;

/// Visit of a place.
#[derive(Debug, Clone, PartialEq)]
struct Visit {
    at: Point2<f64>,
    /// Way to it from the place of the visit before (m).
    way: Vec<Point2<f64>>,
    /// Visits that begin before the robot drives to the place: a robot and the index of its visit.
    after: Vec<(usize, usize)>,
}

/// Visits of all robots, and how far they have come.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    points: Vec<Point2<f64>>,
    spacing: Spacing,
    /// Visits of each robot, from its start.
    paths: Vec<Vec<Visit>>,
    /// Index of the visit that each robot is at.
    progress: Vec<usize>,
    /// Index of the last visit that each robot may drive to without waiting.
    open: Vec<usize>,
    /// Place of each robot (m).
    at: Vec<Point2<f64>>,
}

impl Schedule {
    /// Returns the schedule that brings robots to their goals, past the bodies that stay at `blocked` (m); `None` if it
    /// brings none.
    pub fn new(
        space: &FreeSpace,
        spacing: Spacing,
        robots: &[Traveller],
        blocked: &[Point2<f64>],
    ) -> Option<Self> {
        let starts: Vec<_> = robots.iter().map(|robot| robot.at).collect();
        let known: Vec<_> = robots.iter().filter_map(|robot| robot.goal).collect();
        let places = Places::new(space, &spacing, &starts, &known, blocked)?;
        let ways: Vec<ShortestPaths> = starts
            .iter()
            .map(|&at| places.lattice.ways(space, at))
            .collect();
        let (first, order) = first_places(&places, &ways, &spacing, robots)?;
        let goals = goals(&places, robots, &first);
        let all = moves(&places.next, &first, &goals);
        if all.is_empty() {
            return None;
        }
        let start = |&at: &Point2<f64>| Visit {
            at,
            way: vec![at],
            after: Vec::new(),
        };
        let mut schedule = Self {
            points: places.points.clone(),
            spacing,
            progress: vec![0; robots.len()],
            open: vec![0; robots.len()],
            at: starts.clone(),
            paths: starts.iter().map(|at| vec![start(at)]).collect(),
        };
        for (robot, way) in order {
            let place = places.points[first[robot]];
            if place != starts[robot] {
                schedule.add(robot, way, place);
            }
        }
        let mut at = first;
        for &Move { robot, to } in &all {
            let from = core::mem::replace(&mut at[robot], to);
            schedule.add(robot, places.way(from, to), places.points[to]);
        }
        Some(schedule)
    }

    /// Adds a visit.
    fn add(&mut self, robot: usize, way: Vec<Point2<f64>>, at: Point2<f64>) {
        let others = self.paths.iter().enumerate();
        let after = others
            .filter(|(other, _)| *other != robot)
            .filter_map(|(other, path)| {
                let meets = |visit: &Visit| are_near(&visit.way, &way, self.spacing.apart);
                let last = path.iter().rposition(meets)?;
                // It is where it has been from the beginning.
                (last > 0).then_some((other, last))
            })
            .collect();
        self.paths[robot].push(Visit { at, way, after });
    }

    /// Notes the positions of the robots (m); `None`: it has arrived.
    pub fn update(&mut self, positions: &[Option<Point2<f64>>]) {
        for (robot, position) in positions.iter().enumerate() {
            let path = &self.paths[robot];
            let now = self.progress[robot];
            self.progress[robot] = match position {
                None => path.len() - 1,
                Some(at) => {
                    self.at[robot] = *at;
                    let far = |i: usize| (path[i].at - at).norm();
                    let open = now..=self.open[robot].max(now);
                    let nearest = open.min_by(|&a, &b| far(a).total_cmp(&far(b)));
                    let nearest = nearest.unwrap_or(now);
                    // It has left those before, whether it comes to this one or has been there.
                    let is_there = far(nearest) <= THERE;
                    now.max(nearest.saturating_sub(usize::from(!is_there)))
                }
            };
        }
        for robot in 0..positions.len() {
            self.open[robot] = self.open[robot].max(self.last_open(robot));
        }
    }

    /// Returns `true` if the robot has nothing left to visit.
    pub fn is_done(&self, robot: usize) -> bool {
        self.progress[robot] + 1 == self.paths[robot].len()
    }

    /// Returns the place (m) that a robot at `at` (m) may drive to now, as far as the way is straight; `None` if it
    /// is free to drive to its goal.
    pub fn destination(
        &self,
        robot: usize,
        at: Point2<f64>,
        space: &FreeSpace,
    ) -> Option<Point2<f64>> {
        let path = &self.paths[robot];
        let last = self.open[robot];
        if last + 1 == path.len() {
            return None;
        }
        let now = self.progress[robot];
        let is_straight = |&to: &usize| {
            let end = path[to].at;
            let is_own = |place: Point2<f64>| path[now..=to].iter().any(|visit| visit.at == place);
            let passes =
                |&other: &Point2<f64>| is_own(other) || self.spacing.passes(other, at, end);
            space.segment_is_free(at, end, self.spacing.clearance) && self.points.iter().all(passes)
        };
        let next = (now + 1).min(last);
        Some(path[(next..=last).rev().find(is_straight).unwrap_or(next)].at)
    }

    /// Returns the last visit that the robot may drive to without waiting.
    fn last_open(&self, robot: usize) -> usize {
        let path = &self.paths[robot];
        let is_open = |visit: &&Visit| {
            visit
                .after
                .iter()
                .all(|&(other, i)| self.is_past(other, i, &visit.way))
        };
        let now = self.progress[robot];
        now + path[now + 1..].iter().take_while(is_open).count()
    }

    /// Returns `true` if a robot is at this visit, or on the way to it and drives only away from the way of another.
    fn is_past(&self, robot: usize, visit: usize, way: &[Point2<f64>]) -> bool {
        let (now, path, at) = (self.progress[robot], &self.paths[robot], self.at[robot]);
        let own = &path[visit].way;
        if now >= visit {
            return true;
        }
        if now + 1 < visit || (path[now].at - at).norm() <= THERE {
            return false;
        }
        let off = |i: &usize| to_segment(at, own[*i], own[*i + 1]);
        let nearest = (0..own.len() - 1).min_by(|a, b| off(a).total_cmp(&off(b)));
        let next = nearest.map_or(0, |i| i + 1);
        let rest: Vec<_> = core::iter::once(at)
            .chain(own[next..].iter().copied())
            .collect();
        let rest = points(&rest);
        points(way).into_iter().all(|p| {
            let far: Vec<f64> = rest.iter().map(|q| (q - p).norm()).collect();
            let leaves = |pair: &[f64]| pair[1] >= pair[0].min(self.spacing.apart) - 1e-9;
            far.windows(2).all(leaves) && far[far.len() - 1] >= self.spacing.apart - 1e-9
        })
    }
}

/// Returns the place that each robot drives to. Where its goal is unknown or far away, it goes on in its direction.
fn goals(places: &Places, robots: &[Traveller], first: &[usize]) -> Vec<Option<usize>> {
    let known = robots
        .iter()
        .map(|robot| robot.goal.and_then(|goal| places.at(goal)));
    let mut goals: Vec<Option<usize>> = known.collect();
    for (i, robot) in robots.iter().enumerate() {
        if goals[i].is_none() {
            let taken: Vec<usize> = goals.iter().flatten().copied().collect();
            goals[i] = places.ahead(first[i], robot.forward, &taken);
        }
    }
    goals
}

/// Returns points of a way (m), the corners and three between each two.
fn points(way: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let pieces = way
        .windows(2)
        .flat_map(|pair| (1..=4).map(|i| pair[0] + (pair[1] - pair[0]) * (0.25 * f64::from(i))));
    way.iter().copied().take(1).chain(pieces).collect()
}

/// Returns `true` if two ways come nearer than this distance (m).
fn are_near(a: &[Point2<f64>], b: &[Point2<f64>], least: f64) -> bool {
    let ends = |way: &[Point2<f64>]| {
        let pair = |i: usize| [way[i], way[(i + 1).min(way.len() - 1)]];
        (0..(way.len() - 1).max(1)).map(pair).collect::<Vec<_>>()
    };
    let length = |way: &[Point2<f64>]| way.windows(2).map(|p| (p[1] - p[0]).norm()).sum::<f64>();
    if (a[0] - b[0]).norm() - length(a) - length(b) >= least {
        return false;
    }
    let others = ends(b);
    ends(a)
        .into_iter()
        .any(|a| others.iter().any(|&b| distance(a, b) < least))
}

/// Distance (m) between two segments.
fn distance([a, b]: [Point2<f64>; 2], [c, d]: [Point2<f64>; 2]) -> f64 {
    let side = |a: Point2<f64>, b: Point2<f64>, p: Point2<f64>| (b - a).perp(&(p - a));
    if side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0 {
        return 0.0;
    }
    let ends = [(a, c, d), (b, c, d), (c, a, b), (d, a, b)];
    let far = |(p, a, b)| to_segment(p, a, b);
    ends.into_iter().map(far).fold(f64::INFINITY, f64::min)
}
