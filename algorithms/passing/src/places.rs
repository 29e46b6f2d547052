//! Graph of places where robots can stand.

use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

use nalgebra::{Point2, Vector2};
use planner_view::free_space::FreeSpace;

use super::lattice::Lattice;
use super::spacing::Spacing;

/// Length (m) by which two robots at rest may be nearer than others pass: they stop there before each other.
const CLOSE: f64 = 0.02;

/// Places, and the ways between them.
#[derive(Debug, Clone)]
pub struct Places {
    /// The places (m).
    pub points: Vec<Point2<f64>>,
    /// Places next to each, ascending: on the way a robot passes no other place.
    pub next: Vec<Vec<usize>>,
    /// The ways (m), by their ends, the lower one first.
    pub(super) ways: BTreeMap<(usize, usize), Vec<Point2<f64>>>,
    pub(super) lattice: Rc<Lattice>,
    /// Point of the lattice of each place.
    pub(super) cells: Vec<usize>,
}

impl Places {
    /// Returns the places in the part of the space that robots at `starts` (m) can reach past the bodies that stay at
    /// `blocked` (m); `None` if the robots are too far apart. First the goals (m) become places, then the starts, then as many
    /// others as there is room for, along the walls first: what stands there leaves the most room.
    pub fn new(
        space: &FreeSpace,
        spacing: &Spacing,
        starts: &[Point2<f64>],
        goals: &[Point2<f64>],
        blocked: &[Point2<f64>],
    ) -> Option<Self> {
        let lattice = Rc::new(Lattice::new(space, spacing, starts, goals, blocked)?);
        let mut places = Self {
            points: Vec::new(),
            next: Vec::new(),
            ways: BTreeMap::new(),
            lattice: Rc::clone(&lattice),
            cells: Vec::new(),
        };
        let all = 0..lattice.points.len();
        let layer =
            |&i: &usize| (space.distance(lattice.points[i]) / (0.1 * spacing.places)) as u64;
        let known = |p: &Point2<f64>| all.clone().find(|&i| lattice.points[i] == *p);
        let mut others: Vec<usize> = all.clone().collect();
        others.sort_by(|a, b| {
            let [p, q] = [lattice.points[*a], lattice.points[*b]];
            let by_row = p.y.total_cmp(&q.y).then(p.x.total_cmp(&q.x));
            layer(a).cmp(&layer(b)).then(by_row)
        });
        // Goals may be near each other, but not the same.
        for i in goals.iter().filter_map(known) {
            places.insert(i, f64::MIN_POSITIVE);
        }
        let goal_count = places.points.len();
        for i in starts.iter().filter_map(known) {
            places.insert(i, spacing.apart - CLOSE);
        }
        let mut covered = vec![false; lattice.points.len()];
        let cover = |at: Point2<f64>, covered: &mut [bool]| {
            for near in lattice.near(at, spacing.places) {
                covered[near] = true;
            }
        };
        for &at in &places.points {
            cover(at, &mut covered);
        }
        for i in others {
            if !covered[i] {
                places.insert(i, 0.0);
                cover(lattice.points[i], &mut covered);
            }
        }
        loop {
            let touched = places.link(space, spacing);
            let mut between = places.between(&touched);
            between.retain(|&place| place >= goal_count);
            if between.is_empty() {
                return Some(places);
            }
            for &place in between.iter().rev() {
                places.points.remove(place);
                places.cells.remove(place);
            }
        }
    }

    /// Adds a point of the lattice unless a place is nearer than this distance (m).
    fn insert(&mut self, point: usize, apart: f64) {
        let at = self.lattice.points[point];
        if self.points.iter().all(|p| (p - at).norm() >= apart) {
            self.points.push(at);
            self.cells.push(point);
        }
    }

    /// Returns the place at a point (m).
    pub(super) fn at(&self, point: Point2<f64>) -> Option<usize> {
        self.points.iter().position(|&p| p == point)
    }

    /// Returns the place farthest ahead of a robot that stands at a place and faces this direction, except those
    /// that are taken.
    pub fn ahead(&self, from: usize, direction: Vector2<f64>, taken: &[usize]) -> Option<usize> {
        let is_ahead = |&to: &usize| (self.points[to] - self.points[from]).dot(&direction) > 0.0;
        let mut seen = vec![false; self.points.len()];
        seen[from] = true;
        let mut queue: VecDeque<usize> = self.next[from].iter().copied().filter(is_ahead).collect();
        let mut last = None;
        while let Some(place) = queue.pop_front() {
            if core::mem::replace(&mut seen[place], true) {
                continue;
            }
            if !taken.contains(&place) {
                last = Some(place);
            }
            queue.extend(&self.next[place]);
        }
        last
    }
}
