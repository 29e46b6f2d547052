//! Moves that bring robots to their goals on a graph of places.
//!
//! One robot at a time has the way. The others make room: a state of the search is the place of that robot
//! and the *number* of others in each part into which it cuts the graph. Within a part they can reach any
//! arrangement, since it does not matter which of them stands where. The search therefore finds a way
//! if there is one, however many robots have to go aside, ahead or back past the place where the first waits.
//! A robot that has arrived stays there for good. The robot that needs the fewest moves is next.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap, VecDeque};
use std::rc::Rc;

/// Maximum number of states of a search, far beyond those of lanes and doors.
const MAX_STATES: usize = 20_000;
/// Part of a place where no robot can stand.
const NO_PART: usize = usize::MAX;

/// Move of a robot to the next place, which is empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Move {
    /// Index of the robot.
    pub robot: usize,
    /// The place.
    pub to: usize,
}

/// Returns moves, one after another, that bring as many robots as it can from their places to their goals.
/// A robot without a goal makes room only. `next` has the places next to each.
pub fn moves(next: &[Vec<usize>], starts: &[usize], goals: &[Option<usize>]) -> Vec<Move> {
    let mut search = Search {
        next,
        goals,
        is_taken: vec![false; next.len()],
        parts: BTreeMap::new(),
        left: Vec::new(),
    };
    let mut at = starts.to_vec();
    let mut left: BTreeSet<usize> = (0..at.len()).collect();
    let mut all = Vec::new();
    loop {
        let ways = left.iter().filter_map(|&who| {
            let way = search.bring(&at, &left, who)?;
            Some((way.len(), who, way))
        });
        // Of equally long ones the first: the robots' order in the scenario.
        let Some((_, who, way)) = ways.collect::<Vec<_>>().into_iter().min_by_key(|way| way.0)
        else {
            return all;
        };
        for step in &way {
            at[step.robot] = step.to;
        }
        all.extend(way);
        left.remove(&who);
        search.is_taken[at[who]] = true;
        search.parts.clear();
    }
}

struct Search<'a> {
    next: &'a [Vec<usize>],
    goals: &'a [Option<usize>],
    /// `true` for the places of robots that have arrived.
    is_taken: Vec<bool>,
    /// Part of each place, by the place that is taken away.
    parts: BTreeMap<usize, Rc<[usize]>>,
    /// Number of moves from each place to the goal of the robot that has the way.
    left: Vec<usize>,
}

impl Search<'_> {
    /// Returns moves that bring a robot to its goal, and leave the other robots that are `left` a way to theirs.
    fn bring(&mut self, at: &[usize], left: &BTreeSet<usize>, who: usize) -> Option<Vec<Move>> {
        let goal = self.goals[who]?;
        self.left = self.distances(goal);
        let others: Vec<usize> = left.iter().copied().filter(|&robot| robot != who).collect();
        // Places of all robots, and the moves that lead there.
        let mut states = vec![(at.to_vec(), Vec::new())];
        let mut queue = BinaryHeap::from([Reverse((0, 0))]);
        let mut known = BTreeSet::new();
        while let Some(Reverse((_, i))) = queue.pop().filter(|_| states.len() < MAX_STATES) {
            let (at, way) = states[i].clone();
            if at[who] == goal {
                if self.leaves_ways(&at, &others, goal) {
                    return Some(way);
                }
                continue;
            }
            let here = self.parts(at[who]);
            let places = self.next;
            for &u in &places[at[who]] {
                if self.is_taken[u] {
                    continue;
                }
                let beyond = self.parts(u);
                let (inside, outside): (Vec<usize>, Vec<usize>) = others
                    .iter()
                    .partition(|&&robot| here[at[robot]] == here[u]);
                for wanted in fillings(&here, &beyond, u, inside.len()) {
                    let outside = outside.iter().map(|&robot| beyond[at[robot]]);
                    let mut parts: Vec<usize> = outside.chain(wanted.iter().copied()).collect();
                    parts.sort_unstable();
                    if !known.insert((u, parts)) {
                        continue;
                    }
                    let mut next = (at.clone(), way.clone());
                    if self.make_room(&mut next, &inside, [&here, &beyond], u, &wanted) {
                        next.0[who] = u;
                        next.1.push(Move { robot: who, to: u });
                        queue.push(Reverse((next.1.len(), states.len())));
                        states.push(next);
                    }
                }
            }
        }
        None
    }

    /// Returns `true` if the other robots are still connected with their goals when one stays at `goal`.
    fn leaves_ways(&mut self, at: &[usize], others: &[usize], goal: usize) -> bool {
        let goals = self.goals;
        let parts = self.parts(goal);
        others.iter().all(|&robot| {
            goals[robot].is_none_or(|own| parts[own] != NO_PART && parts[at[robot]] == parts[own])
        })
    }

    /// Moves the robots in the part of `u` away from there, to places in the `wanted` parts beyond; `false` if one would
    /// pass its own goal and stay there.
    fn make_room(
        &self,
        (at, way): &mut (Vec<usize>, Vec<Move>),
        robots: &[usize],
        [here, beyond]: [&[usize]; 2],
        u: usize,
        wanted: &[usize],
    ) -> bool {
        loop {
            let robot_at = |place: usize| robots.iter().copied().find(|&robot| at[robot] == place);
            // Robots that the part of a place has, and those that it shall have.
            let counts = |place: usize| {
                let part = beyond[place];
                let has = robots
                    .iter()
                    .filter(|&&robot| beyond[at[robot]] == part)
                    .count();
                (has, wanted.iter().filter(|&&other| other == part).count())
            };
            let leaves = |place: usize| place == u || counts(place).0 > counts(place).1;
            let is_source = |place: usize| robot_at(place).is_some() && leaves(place);
            let Some(path) = self.path(here, u, is_source) else {
                return true;
            };
            let enters = |place: usize| place != u && counts(place).0 < counts(place).1;
            let is_hole = |place: usize| robot_at(place).is_none() && enters(place);
            let source = path[path.len() - 1];
            let Some(path) = self.path(here, source, is_hole) else {
                return false;
            };
            // From the hole back: each robot on the path goes to where the next one was.
            let mut to = path.len() - 1;
            for from in (0..path.len() - 1).rev() {
                let Some(robot) = robots
                    .iter()
                    .copied()
                    .find(|&robot| at[robot] == path[from])
                else {
                    continue;
                };
                let places = &path[from + 1..=to];
                if places.iter().any(|&place| self.goals[robot] == Some(place)) {
                    return false;
                }
                way.extend(places.iter().map(|&to| Move { robot, to }));
                at[robot] = path[to];
                to = from;
            }
        }
    }

    /// Returns the shortest path within a part from a place to the nearest one of some, both included.
    fn path(
        &self,
        parts: &[usize],
        from: usize,
        is_end: impl Fn(usize) -> bool,
    ) -> Option<Vec<usize>> {
        let mut before = BTreeMap::from([(from, from)]);
        let mut queue = VecDeque::from([from]);
        while let Some(place) = queue.pop_front() {
            if is_end(place) {
                let mut path = vec![place];
                while path[path.len() - 1] != from {
                    path.push(before[&path[path.len() - 1]]);
                }
                path.reverse();
                return Some(path);
            }
            // Of holes equally near one that is not ahead: there the robot would be in the way again.
            let mut near = self.next[place].clone();
            near.sort_by_key(|&next| Reverse(self.left[next]));
            for next in near {
                if parts[next] == parts[from] && !before.contains_key(&next) {
                    before.insert(next, place);
                    queue.push_back(next);
                }
            }
        }
        None
    }

    /// Returns the number of moves from each place to a goal past no other robot; 0 where there is no way.
    fn distances(&self, goal: usize) -> Vec<usize> {
        let mut left = vec![0; self.next.len()];
        let mut queue = VecDeque::from([goal]);
        while let Some(place) = queue.pop_front() {
            for &next in &self.next[place] {
                if left[next] == 0 && next != goal {
                    left[next] = left[place] + 1;
                    queue.push_back(next);
                }
            }
        }
        left
    }

    /// Returns the part of each place when a robot stands at `v`, besides those that have arrived.
    fn parts(&mut self, v: usize) -> Rc<[usize]> {
        let (places, is_taken) = (self.next, &self.is_taken);
        let parts = self.parts.entry(v).or_insert_with(|| {
            let mut parts = vec![NO_PART; is_taken.len()];
            for first in 0..parts.len() {
                if parts[first] != NO_PART || first == v || is_taken[first] {
                    continue;
                }
                parts[first] = first;
                let mut open = vec![first];
                while let Some(place) = open.pop() {
                    for &next in &places[place] {
                        if parts[next] == NO_PART && next != v && !is_taken[next] {
                            parts[next] = first;
                            open.push(next);
                        }
                    }
                }
            }
            parts.into()
        });
        Rc::clone(parts)
    }
}

/// Returns all ways to spread this number of robots over the parts beyond `u`, as the parts of the robots.
fn fillings(here: &[usize], beyond: &[usize], u: usize, count: usize) -> Vec<Vec<usize>> {
    let mut room = BTreeMap::new();
    for place in (0..here.len()).filter(|&place| here[place] == here[u] && place != u) {
        *room.entry(beyond[place]).or_insert(0) += 1;
    }
    let mut all = vec![Vec::new()];
    for (part, room) in room {
        let more = |filling: Vec<usize>| {
            let most = count.min(filling.len() + room);
            (filling.len()..=most).map(move |len| {
                let mut filling = filling.clone();
                filling.resize(len, part);
                filling
            })
        };
        all = all.into_iter().flat_map(more).collect();
    }
    all.retain(|filling| filling.len() == count);
    all
}
