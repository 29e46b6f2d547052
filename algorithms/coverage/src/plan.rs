//! Sub-goals from a source of points, rectangle after rectangle.
//!
//! The affine mapping of the Chebyshev coverage paper (Eq. 10): a point (u, w) of the source in [−1,
//! 1]² becomes the rectangle's centre + (u · half its width, w · half its height). The source is
//! never reset by the robot's position, so that one key makes one sequence.

use geometry::shape::Aabb;
use nalgebra::Point2;
use planner_view::waypoint::{Waypoint, WaypointKind};
use thiserror::Error;

use crate::decomposition::Decomposition;
use crate::goal::{Goal, GoalSource};
use crate::tour::{Iterations, Route, Stop, Tour, TourError};
use crate::transit::{Dwell, Transit};

/// Reason why there is no plan.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlanError {
    /// The start is not a free position of the robot's centre.
    #[error(
        "start = ({}, {}): not in free space; the nearest is {distance} m away", .start.x, .start.y
    )]
    Start {
        /// The start (m).
        start: Point2<f64>,
        /// Distance from the nearest free rectangle (m).
        distance: f64,
    },
    /// The tour does not fit the workplace.
    #[error(transparent)]
    Tour(#[from] TourError),
    /// The cap of a wait is 0.
    #[error("transit.wait.cap = 0: expected at least 1 sub-goal")]
    NoWait,
}

/// Specification of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSpec {
    /// Order of the rectangles.
    pub route: Route,
    /// Sub-goals per large loop.
    pub iterations: Iterations,
    /// Method of transit from one rectangle to the next.
    pub transit: Transit,
    /// Number of large loops, each ending in the rectangle where it began; 0 for endless loops.
    pub loops: u32,
}

impl Default for PlanSpec {
    fn default() -> Self {
        Self {
            route: Route::default(),
            iterations: Iterations::InAll(200),
            transit: Transit::default(),
            loops: 0,
        }
    }
}

/// State of a plan within the tour.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Number of sub-goals left in the current stop.
    Cover(u32),
    /// In transit to the next stop, still in this one; sub-goals so far.
    Leave(u32),
    /// In the bridge to the next stop; sub-goals so far in this transit, and those in the bridge.
    Cross(u32, u32),
    Done,
}

/// A stream of sub-goals for a workplace.
#[derive(Debug, Clone)]
pub struct CoveragePlan<S> {
    decomposition: Decomposition,
    tour: Tour,
    transit: Transit,
    loops: u32,
    source: S,
    /// Position of the last sub-goal, or the start (m).
    position: Point2<f64>,
    stop: usize,
    phase: Phase,
    lap: u32,
    number: u64,
    dwell: Dwell,
}

impl<S: chaotic_maps::Source> CoveragePlan<S> {
    /// Creates a plan for a robot that starts at `start` (m) in free space.
    ///
    /// # Errors
    /// [`PlanError`] names the error and the remedy.
    pub fn new(
        decomposition: Decomposition,
        start: Point2<f64>,
        spec: &PlanSpec,
        source: S,
    ) -> Result<Self, PlanError> {
        let Some(first) = decomposition.rectangle_at(start) else {
            let nearest = decomposition.nearest_rectangle(start);
            let distance = nearest.map_or(f64::NAN, |(_, distance)| distance);
            return Err(PlanError::Start { start, distance });
        };
        if spec.transit == (Transit::Wait { cap: 0 }) {
            return Err(PlanError::NoWait);
        }
        let tour = Tour::new(&decomposition, first, &spec.route, &spec.iterations)?;
        let iterations = tour.stop(0).map_or(0, |stop| stop.iterations);
        Ok(Self {
            decomposition,
            tour,
            transit: spec.transit,
            loops: spec.loops,
            source,
            position: start,
            stop: 0,
            phase: Phase::Cover(iterations),
            lap: 0,
            number: 0,
            dwell: Dwell::default(),
        })
    }

    /// Continues in another workplace (the map has changed) from `start` (m): a new tour, but the
    /// same source, numbers of sub-goals and count of loops.
    ///
    /// # Errors
    /// As [`CoveragePlan::new`].
    pub fn moved(
        self,
        decomposition: Decomposition,
        start: Point2<f64>,
        spec: &PlanSpec,
    ) -> Result<Self, PlanError> {
        let done = self.phase == Phase::Done;
        let mut plan = Self::new(decomposition, start, spec, self.source)?;
        (plan.number, plan.lap, plan.dwell) = (self.number, self.lap, self.dwell);
        if done {
            plan.phase = Phase::Done;
        }
        Ok(plan)
    }

    /// The free rectangles.
    pub fn decomposition(&self) -> &Decomposition {
        &self.decomposition
    }

    /// The tour of a large loop.
    pub fn tour(&self) -> &Tour {
        &self.tour
    }

    /// Numbers of sub-goals of the transits so far.
    pub fn dwell(&self) -> &Dwell {
        &self.dwell
    }

    /// Number of completed large loops.
    pub fn lap(&self) -> u32 {
        self.lap
    }

    /// The next sub-goal; `None` after the last loop.
    pub fn step(&mut self) -> Option<Goal> {
        loop {
            let here = self.tour.stop(self.stop)?;
            let rectangle = self.rectangle(here)?;
            match self.phase {
                Phase::Done => return None,
                Phase::Cover(0) => self.phase = self.depart(here),
                Phase::Cover(left) => {
                    self.phase = Phase::Cover(left - 1);
                    return Some(self.goal(rectangle, rectangle, WaypointKind::SubGoal));
                }
                Phase::Leave(waited) => {
                    let bridge = self.bridge(here)?;
                    match self.transit {
                        Transit::Wait { .. } if bridge.contains(self.position) => {
                            self.phase = Phase::Cross(waited, 0);
                        }
                        Transit::Wait { cap } if waited < cap => {
                            self.phase = Phase::Leave(waited + 1);
                            self.dwell.leaving += 1;
                            return Some(self.goal(rectangle, rectangle, WaypointKind::Transit));
                        }
                        Transit::Direct | Transit::Wait { .. } => {
                            self.dwell.capped += u64::from(self.transit != Transit::Direct);
                            self.phase = Phase::Cross(waited + 1, 0);
                            self.dwell.leaving += 1;
                            let gate = overlap(&rectangle, &bridge);
                            return Some(self.goal(gate, rectangle, WaypointKind::Transit));
                        }
                    }
                }
                Phase::Cross(goals, crossed) => {
                    let bridge = self.bridge(here)?;
                    let next = self.next_stop();
                    let there = self.tour.stop(next)?;
                    let other = self.rectangle(there)?;
                    let waits = match self.transit {
                        Transit::Wait { cap } if crossed < cap => true,
                        Transit::Wait { .. } => {
                            self.dwell.capped += 1;
                            false
                        }
                        Transit::Direct => false,
                    };
                    let gate = if waits {
                        bridge
                    } else {
                        overlap(&other, &bridge)
                    };
                    let goal = self.goal(gate, bridge, WaypointKind::Transit);
                    self.dwell.crossing += 1;
                    self.phase = Phase::Cross(goals + 1, crossed + 1);
                    if other.contains(self.position) {
                        self.dwell.longest = self.dwell.longest.max(goals + 1);
                        self.arrive(next, there);
                    }
                    return Some(goal);
                }
            }
        }
    }

    /// The phase after a stop has had its sub-goals.
    fn depart(&mut self, here: Stop) -> Phase {
        let next = self.next_stop();
        match self.tour.stop(next) {
            // The only rectangle, or one that occurs twice in a row on the route.
            Some(there) if there.rectangle == here.rectangle => {
                self.arrive(next, there);
                self.phase
            }
            Some(_) => {
                self.dwell.transits += 1;
                Phase::Leave(0)
            }
            None => Phase::Done,
        }
    }

    fn arrive(&mut self, next: usize, there: Stop) {
        let is_end = next <= self.stop;
        self.stop = next;
        self.phase = Phase::Cover(there.iterations);
        if is_end {
            // Endless loops may exceed the range of the counter.
            self.lap = self.lap.saturating_add(1);
            if self.lap == self.loops {
                self.phase = Phase::Done;
            }
        }
    }

    fn next_stop(&self) -> usize {
        self.tour.after(self.stop)
    }

    fn rectangle(&self, stop: Stop) -> Option<Aabb> {
        self.decomposition.rectangles().get(stop.rectangle).copied()
    }

    /// The bridge from a stop to the one after the current one.
    fn bridge(&self, here: Stop) -> Option<Aabb> {
        let there = self.tour.stop(self.next_stop())?;
        let bridge = self.decomposition.bridge(here.rectangle, there.rectangle)?;
        Some(bridge.rectangle)
    }

    /// Takes a step of the source and maps it into a rectangle; the leg runs in `within`.
    fn goal(&mut self, into: Aabb, within: Aabb, kind: WaypointKind) -> Goal {
        let point = map(self.source.next_symmetric(), &into);
        let waypoint = Waypoint {
            number: self.number,
            lap: self.lap,
            kind,
            point,
        };
        self.number += 1;
        self.position = point;
        Goal {
            waypoint,
            within: Some(within),
        }
    }
}

impl<S: chaotic_maps::Source> GoalSource for CoveragePlan<S> {
    fn next_goal(&mut self, _from: Point2<f64>) -> Option<Goal> {
        self.step()
    }
}

/// Returns the rectangles into which a large loop with direct transits maps its points, in order; loops
/// repeat them.
pub fn frames(decomposition: &Decomposition, tour: &Tour) -> Vec<Aabb> {
    let stops = tour.stops();
    let mut frames = Vec::new();
    for (here, there) in stops.iter().zip(stops.iter().cycle().skip(1)) {
        let rectangle = |stop: &Stop| decomposition.rectangles().get(stop.rectangle).copied();
        let (Some(from), Some(to)) = (rectangle(here), rectangle(there)) else {
            continue;
        };
        frames.extend((0..here.iterations).map(|_| from));
        if let Some(bridge) = decomposition.bridge(here.rectangle, there.rectangle) {
            let gates = [from, to].map(|rectangle| overlap(&rectangle, &bridge.rectangle));
            frames.extend(gates);
        }
    }
    frames
}

/// Maps a point of [−1, 1]² onto a rectangle (Chebyshev coverage paper, Eq. 10).
pub fn map(symmetric: [f64; 2], rectangle: &Aabb) -> Point2<f64> {
    let (center, half) = (rectangle.center(), rectangle.half_extents());
    let [u, w] = symmetric;
    let p = Point2::new(center.x + half.x * u, center.y + half.y * w);
    // Rounding must not move a point of the border outside.
    p.sup(&rectangle.min).inf(&rectangle.max)
}

/// The overlap of two rectangles.
fn overlap(a: &Aabb, b: &Aabb) -> Aabb {
    Aabb {
        min: a.min.sup(&b.min),
        max: a.max.inf(&b.max),
    }
}
