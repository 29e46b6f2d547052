//! Point-to-point search: A* over departures; a tangent is tested only when the search reaches it.

use core::cell::RefCell;

use nalgebra::Point2;

use super::graph::NONE;
use super::heap::Heap;
use super::near::Join;
use super::{Inner, PUSH_OUT, PathLeg, legs};

/// Entries of the queue are numbers: a departure, or above these marks a tangent from the start, or
/// one to the goal.
const START: u32 = 1 << 30;
const GOAL: u32 = 1 << 31;

/// Predecessor of a vertex or the goal.
#[derive(Debug, Clone, Copy)]
enum Parent {
    /// A tangent from the start.
    Start(u32),
    /// The tangent of a vertex.
    Took(u32),
    /// The track from a vertex.
    Stayed(u32),
}

/// State of a vertex; valid if `search` is the current search.
#[derive(Debug, Clone, Copy)]
struct Mark {
    search: u32,
    cost: f64,
    least: f64,
    parent: Parent,
}

/// A connection to the goal.
#[derive(Debug, Clone, Copy)]
struct Finish {
    total: f64,
    goal: u32,
    parent: Parent,
}

/// Memory of a search, reused by the next.
#[derive(Debug, Default)]
pub struct Scratch {
    search: u32,
    marks: Vec<Mark>,
    heap: Heap,
    starts: Vec<Join>,
    goals: Vec<Join>,
    /// By track: the last search in which it has a tangent to the goal, and the index of that
    /// tangent.
    goal_of: Vec<(u32, u32)>,
    finishes: Vec<Finish>,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// Runs `f` with this thread's memory.
pub fn with_scratch<R>(f: impl FnOnce(&mut Scratch) -> R) -> R {
    SCRATCH.with(|scratch| match scratch.try_borrow_mut() {
        Ok(mut scratch) => f(&mut scratch),
        // A search does not start another; if one did, it would get its own memory.
        Err(_) => f(&mut Scratch::default()),
    })
}

/// Runs `f` with this thread's list of tangents.
pub fn with_joins<R>(f: impl FnOnce(&mut Vec<Join>) -> R) -> R {
    with_scratch(|scratch| f(&mut scratch.starts))
}

impl Inner {
    /// Returns the length (m) of the shortest path and writes its legs to `path`; `None` if there is
    /// no path.
    pub(super) fn search(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
        path: Option<&mut Vec<PathLeg>>,
        scratch: &mut Scratch,
    ) -> Option<f64> {
        let (p, q) = (self.settle(from)?, self.settle(to)?);
        let aside = (p - from).norm() + (q - to).norm();
        if self.space.segment_is_free(p, q, self.radius) {
            if let Some(path) = path {
                legs::straight(&[from, p, q, to], path);
            }
            return Some(aside + (q - p).norm());
        }
        let finish = self.find(p, q, scratch)?;
        if let Some(path) = path {
            self.trace([from, p, q, to], &finish, scratch, path);
        }
        Some(aside + finish.total)
    }

    fn find(&self, p: Point2<f64>, q: Point2<f64>, scratch: &mut Scratch) -> Option<Finish> {
        let (space, graph) = (&self.space, &self.graph);
        self.near.joins(space, graph, p, &mut scratch.starts);
        self.near.joins(space, graph, q, &mut scratch.goals);
        self.begin(scratch);
        for i in 0..scratch.starts.len() {
            let start = scratch.starts[i];
            let (next, arc) = graph.departure(start.track, start.at);
            let mut least = f64::INFINITY;
            if next != NONE {
                least = start.length + arc + self.least(next, q, scratch);
            }
            if let Some((goal, arc)) = self.goal_on(start.track, start.at, scratch) {
                least = least.min(start.length + arc + scratch.goals[goal as usize].length);
            }
            if least.is_finite() {
                scratch.heap.push(least, START | i as u32);
            }
        }
        while let Some((bound, number)) = scratch.heap.pop() {
            if number >= GOAL {
                let finish = scratch.finishes[(number - GOAL) as usize];
                let touch = scratch.goals[finish.goal as usize].touch;
                if space.segment_is_free(touch, q, self.radius) {
                    return Some(finish);
                }
                // Neither reaches the goal by this tangent.
                let track = scratch.goals[finish.goal as usize].track;
                scratch.goal_of[track as usize ^ 1].0 = 0;
            } else if number >= START {
                let i = number - START;
                let start = scratch.starts[i as usize];
                if !space.segment_is_free(p, start.touch, self.radius) {
                    continue;
                }
                self.land(
                    start.track,
                    start.at,
                    start.length,
                    Parent::Start(i),
                    scratch,
                );
                let (next, arc) = graph.departure(start.track, start.at);
                let cost = start.length + arc;
                self.reach(next, cost, Parent::Start(i), q, scratch);
            } else {
                let mark = scratch.marks[number as usize];
                // Reached at a lower cost in the meantime.
                if mark.cost + mark.least < bound {
                    continue;
                }
                let vertex = graph.vertices[number as usize];
                let landed = mark.cost + vertex.length;
                self.land(
                    vertex.to_track,
                    vertex.to_at,
                    landed,
                    Parent::Took(number),
                    scratch,
                );
                let took = mark.cost + vertex.next_cost;
                self.reach(vertex.next, took, Parent::Took(number), q, scratch);
                let stayed = mark.cost + vertex.stay_cost;
                self.reach(vertex.stay, stayed, Parent::Stayed(number), q, scratch);
            }
        }
        None
    }

    /// Starts a new search in reused memory.
    fn begin(&self, scratch: &mut Scratch) {
        scratch.search = scratch.search.wrapping_add(1);
        if scratch.search == 0 {
            // Search numbers restart: old marks must not count as new.
            scratch.marks.clear();
            scratch.goal_of.clear();
            scratch.search = 1;
        }
        let blank = Mark {
            search: 0,
            cost: f64::INFINITY,
            least: 0.0,
            parent: Parent::Start(0),
        };
        // Marks of another graph belong to another search, too; the memory only grows.
        let (vertices, tracks) = (self.graph.vertices.len(), self.graph.tracks());
        scratch
            .marks
            .resize(vertices.max(scratch.marks.len()), blank);
        scratch
            .goal_of
            .resize(tracks.max(scratch.goal_of.len()), (0, 0));
        scratch.heap.clear();
        scratch.finishes.clear();
        for (i, goal) in scratch.goals.iter_mut().enumerate() {
            // A tangent from the goal is a tangent to it on the opposite track.
            let opposite = goal.track ^ 1;
            scratch.goal_of[opposite as usize] = (scratch.search, i as u32);
            goal.at = self.graph.opposite(goal.track, goal.at);
        }
    }

    /// The tangent to the goal from a track, and the arc (m) to its departure.
    #[inline]
    fn goal_on(&self, track: u32, at: f64, scratch: &Scratch) -> Option<(u32, f64)> {
        let (search, goal) = scratch.goal_of[track as usize];
        if search != scratch.search {
            return None;
        }
        let arc = self.graph.arc(track, at, scratch.goals[goal as usize].at)?;
        Some((goal, self.graph.site(track).radius * arc))
    }

    /// Continues to the goal from the landing position of a path, if a tangent leads there.
    #[inline]
    fn land(&self, track: u32, at: f64, cost: f64, parent: Parent, scratch: &mut Scratch) {
        if let Some((goal, arc)) = self.goal_on(track, at, scratch) {
            let total = cost + arc + scratch.goals[goal as usize].length;
            scratch
                .heap
                .push(total, GOAL | scratch.finishes.len() as u32);
            scratch.finishes.push(Finish {
                total,
                goal,
                parent,
            });
        }
    }

    #[inline]
    fn reach(&self, vertex: u32, cost: f64, parent: Parent, q: Point2<f64>, scratch: &mut Scratch) {
        if vertex == NONE {
            return;
        }
        let least = self.least(vertex, q, scratch);
        let mark = &mut scratch.marks[vertex as usize];
        if least.is_finite() && cost < mark.cost {
            (mark.cost, mark.parent) = (cost, parent);
            scratch.heap.push(cost + least, vertex);
        }
    }

    /// A lower bound on the cost (m) from a vertex to the goal, computed once per search.
    #[inline]
    fn least(&self, vertex: u32, q: Point2<f64>, scratch: &mut Scratch) -> f64 {
        let mark = &mut scratch.marks[vertex as usize];
        if mark.search != scratch.search {
            let least = (q - self.graph.vertices[vertex as usize].ends[0]).norm();
            *mark = Mark {
                search: scratch.search,
                cost: f64::INFINITY,
                least,
                parent: Parent::Start(0),
            };
        }
        mark.least
    }

    /// Writes the legs of a found path.
    fn trace(
        &self,
        [from, p, q, to]: [Point2<f64>; 4],
        finish: &Finish,
        scratch: &Scratch,
        path: &mut Vec<PathLeg>,
    ) {
        // The tangents of the path from its end: a vertex each.
        let mut taken = Vec::new();
        let mut parent = finish.parent;
        let start = loop {
            match parent {
                Parent::Start(i) => break scratch.starts[i as usize],
                Parent::Took(vertex) => {
                    taken.push(vertex);
                    parent = scratch.marks[vertex as usize].parent;
                }
                Parent::Stayed(vertex) => parent = scratch.marks[vertex as usize].parent,
            }
        };
        legs::straight(&[from, p, start.touch], path);
        let mut at = (start.track, start.at);
        for &vertex in taken.iter().rev() {
            let vertex = &self.graph.vertices[vertex as usize];
            legs::arc(&self.graph, at, vertex.at, path);
            legs::straight(&vertex.ends, path);
            at = (vertex.to_track, vertex.to_at);
        }
        let goal = scratch.goals[finish.goal as usize];
        legs::arc(&self.graph, at, goal.at, path);
        legs::straight(&[goal.touch, q, to], path);
    }

    /// The point itself, or the nearest one on the border if it is inside a grown piece by no more
    /// than [`PUSH_OUT`].
    pub(super) fn settle(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        if self.space.is_free(p, self.radius) {
            return Some(p);
        }
        let distance = self.space.distance(p);
        if distance.is_nan() || distance < self.radius - PUSH_OUT {
            return None;
        }
        let mut at = p;
        // In a corner between two pieces, the point leaves one piece after the other.
        for _ in 0..32 {
            let contact = self.space.shapes().nearest_contact(at);
            at += contact.normal * (self.radius - contact.distance).max(0.0);
            if self.space.is_free(at, self.radius) {
                break;
            }
        }
        let near = (at - p).norm() <= 4.0 * PUSH_OUT;
        (near && self.space.is_free(at, self.radius)).then_some(at)
    }
}
