//! Ways between places, on which a robot passes no other place.

use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

use nalgebra::Point2;
use planner_view::free_space::FreeSpace;

use super::places::Places;
use super::spacing::{Spacing, to_segment};

/// Maximum length of a straight way, in distances of two places.
const MAX_STRAIGHT: f64 = 2.1;
/// Part of a place that has not been reached.
const NONE: usize = usize::MAX;

/// Point of the lattice, and a place that a robot there touches.
type State = (usize, Option<usize>);

impl Places {
    /// Finds the ways between the places. Returns the places that a robot at each point of the lattice touches.
    pub(super) fn link(&mut self, space: &FreeSpace, spacing: &Spacing) -> Vec<Vec<usize>> {
        let lattice = Rc::clone(&self.lattice);
        let mut touched = vec![Vec::new(); lattice.points.len()];
        for (place, &at) in self.points.iter().enumerate() {
            for near in lattice.near(at, spacing.apart) {
                touched[near].push(place);
            }
        }
        self.next = vec![Vec::new(); self.points.len()];
        self.ways.clear();
        for a in 0..self.points.len() {
            self.link_one(space, spacing, &touched, a);
        }
        for next in &mut self.next {
            next.sort_unstable();
        }
        touched
    }

    /// Returns the places, ascending, that close the shortest way between two parts of the graph.
    pub(super) fn between(&self, touched: &[Vec<usize>]) -> Vec<usize> {
        let mut part = vec![NONE; self.points.len()];
        for first in 0..part.len() {
            let mut open = vec![first];
            while let Some(place) = open.pop() {
                if part[place] == NONE {
                    part[place] = first;
                    open.extend(&self.next[place]);
                }
            }
        }
        let place_at: BTreeMap<usize, usize> = self.cells.iter().copied().zip(0..).collect();
        for first in (0..part.len()).filter(|&place| part[place] == place) {
            let starts = (0..part.len()).filter(|&place| part[place] == first);
            let mut queue: VecDeque<usize> = starts.map(|place| self.cells[place]).collect();
            let mut before: BTreeMap<usize, Option<usize>> =
                queue.iter().map(|&at| (at, None)).collect();
            while let Some(point) = queue.pop_front() {
                let end = place_at
                    .get(&point)
                    .copied()
                    .filter(|&place| part[place] != first);
                if let Some(end) = end {
                    let (mut way, mut at) = (vec![point], before[&point]);
                    while let Some(point) = at {
                        way.push(point);
                        at = before[&point];
                    }
                    let ends = [Some(&end), place_at.get(&way[way.len() - 1])];
                    let mut between: Vec<usize> = way
                        .iter()
                        .flat_map(|&point| &touched[point])
                        .copied()
                        .collect();
                    between.retain(|place| !ends.contains(&Some(place)));
                    between.sort_unstable();
                    between.dedup();
                    return between;
                }
                for &next in &self.lattice.next[point] {
                    before.entry(next).or_insert_with(|| {
                        queue.push_back(next);
                        Some(point)
                    });
                }
            }
        }
        Vec::new()
    }

    /// Adds the ways from a place to later ones.
    fn link_one(&mut self, space: &FreeSpace, spacing: &Spacing, touched: &[Vec<usize>], a: usize) {
        let lattice = Rc::clone(&self.lattice);
        let from = self.points[a];
        for b in a + 1..self.points.len() {
            let to = self.points[b];
            let passes = |(c, &p): (usize, &Point2<f64>)| {
                c == a || c == b || to_segment(p, from, to) >= spacing.apart - 1e-9
            };
            if (to - from).norm() <= MAX_STRAIGHT * spacing.places
                && space.segment_is_free(from, to, spacing.clearance)
                && self.points.iter().enumerate().all(passes)
            {
                self.add(a, b, vec![from, to]);
            }
        }
        // Points of the lattice that are reached, and the other place that the robot touches there.
        let start: State = (self.cells[a], None);
        let mut before = BTreeMap::from([(start, None::<State>)]);
        let mut queue = VecDeque::from([start]);
        while let Some((point, other)) = queue.pop_front() {
            if let Some(b) = other
                && point == self.cells[b]
                && b > a
            {
                if self.ways.contains_key(&(a, b)) {
                    continue;
                }
                let mut way = vec![self.points[b]];
                let mut at = before[&(point, other)];
                while let Some(state) = at {
                    way.push(lattice.points[state.0]);
                    at = before[&state];
                }
                way.reverse();
                self.add(a, b, way);
                continue;
            }
            for &next in &lattice.next[point] {
                let mut others = touched[next].iter().copied().filter(|&place| place != a);
                let (first, second) = (others.next(), others.next());
                let is_same = other.is_none() || first.is_none() || first == other;
                let state = (next, other.or(first));
                if second.is_none() && is_same && !before.contains_key(&state) {
                    before.insert(state, Some((point, other)));
                    queue.push_back(state);
                }
            }
        }
    }

    fn add(&mut self, a: usize, b: usize, way: Vec<Point2<f64>>) {
        self.ways.insert((a, b), way);
        self.next[a].push(b);
        self.next[b].push(a);
    }

    /// Returns the way from a place to one next to it (m).
    pub(super) fn way(&self, a: usize, b: usize) -> Vec<Point2<f64>> {
        let known = self.ways.get(&(a.min(b), a.max(b)));
        let mut way = known
            .cloned()
            .unwrap_or_else(|| vec![self.points[a], self.points[b]]);
        if a > b {
            way.reverse();
        }
        way
    }
}
