//! The part of a map that a request contains.
//!
//! The optimiser takes a limited number of pieces. On a larger map, a request leads along a stretch of the route to the
//! goal, and the next one continues from there. A rectangle about the stretch bounds the robot's centre, and the
//! request contains every piece within reach of the rectangle: a plan cannot touch any other.

use geometry::shape::{Aabb, Convex};
use ipc_types::messages::optimiser::PlanRequest;
use nalgebra::{Point2, Vector2};
use navigation::routes::{MARGIN, RouteFinder};
use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use runtime::shapes;

/// Maximum number of pieces of a stretch: the time of a plan grows with the square of their number.
const MAX_STRETCH: usize = 1024;
/// Distances of a stretch's route from the edge of its rectangle, in clearances: the first at which a stretch is long
/// enough.
const ROOMS: [f64; 5] = [8.0, 4.0, 2.0, 1.0, 0.5];
/// Minimum length of a stretch that ends before the goal, in clearances.
const MIN_LENGTH: f64 = 4.0;
/// Maximum distance between an end of the route and the place that it stands for (m).
const MAX_OFFSET: f64 = 1.0;

/// Ends of a plan, and its distances from obstacles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trip {
    /// Start (m).
    pub start: Point2<f64>,
    /// Goal (m).
    pub goal: Point2<f64>,
    /// Minimum distance of the robot's centre from pieces and from the edge of the map (m).
    pub clearance: f64,
    /// Maximum depth of the start in a grown piece or beyond the bounds (m).
    pub start_tolerance: f64,
    /// Number of obstacles in the request that are no pieces of the map.
    pub others: usize,
}

/// Part of a map for one request.
#[derive(Debug, Clone, PartialEq)]
pub struct Excerpt {
    /// Bounds of the robot's centre.
    pub bounds: Aabb,
    /// The pieces within reach of the bounds.
    pub pieces: Vec<Convex>,
    /// End of the plan (m): the goal, or a place on the route to it.
    pub end: Point2<f64>,
    /// `true` if the end is a place before the goal.
    pub is_stretch: bool,
}

impl Excerpt {
    /// Returns the whole map if a request can contain it, and else the first stretch of the route to the goal; `None`
    /// if there is no route. `routes` keeps the routes of the map between calls.
    pub fn new(
        map: &PlannerMap,
        space: &FreeSpace,
        routes: &mut RouteFinder,
        trip: &Trip,
    ) -> Option<Self> {
        let inset = Vector2::repeat(trip.clearance);
        let inside = Aabb {
            min: space.bounds().min + inset,
            max: space.bounds().max - inset,
        };
        let parts = space.shapes().parts();
        if fits(parts.iter(), trip, PlanRequest::MAX_SHAPES) {
            return Some(Self {
                bounds: inside,
                pieces: parts.to_vec(),
                end: trip.goal,
                is_stretch: false,
            });
        }
        let route = route(map, routes, trip)?;
        ROOMS.iter().find_map(|room| {
            let room = room * trip.clearance;
            Self::stretch(space, &route, &inside, room, trip)
        })
    }

    /// Returns the longest stretch of a route whose rectangle leaves this room (m) beside it; `None` if it is too short.
    fn stretch(
        space: &FreeSpace,
        route: &[Point2<f64>],
        inside: &Aabb,
        room: f64,
        trip: &Trip,
    ) -> Option<Self> {
        let reach = trip.clearance + trip.start_tolerance;
        let parts = space.shapes().parts();
        let near = |bounds: &Aabb| {
            let area = grown(bounds, reach);
            parts.iter().filter(move |part| meet(&part.aabb(), &area))
        };
        let bounds = |count: usize, room: f64| rectangle(trip.start, &route[..count], room, inside);
        let is_small = |bounds: &Aabb| fits(near(bounds), trip, MAX_STRETCH);
        let counts: Vec<usize> = (1..=route.len()).collect();
        let mut count = counts.partition_point(|&count| is_small(&bounds(count, room)));
        let is_stretch = count < route.len();
        if is_stretch {
            let is_free = |p: &Point2<f64>| space.is_free(*p, trip.clearance);
            count = route[..count].iter().rposition(is_free)? + 1;
            if (route[count - 1] - trip.start).norm() < MIN_LENGTH * trip.clearance {
                return None;
            }
        }
        // A wider rectangle has more paths around obstacles.
        let mut widest = bounds(count, room);
        for factor in [2.0, 4.0, 8.0, 16.0] {
            let wider = bounds(count, factor * room);
            if !is_small(&wider) {
                break;
            }
            widest = wider;
        }
        Some(Self {
            pieces: near(&widest).cloned().collect(),
            bounds: widest,
            end: route[count - 1],
            is_stretch,
        })
    }
}

/// Returns `true` if a request can contain these pieces beside its other obstacles, and at most `most` of them.
fn fits<'a>(pieces: impl Iterator<Item = &'a Convex>, trip: &Trip, most: usize) -> bool {
    let (mut count, mut points) = (trip.others, trip.others);
    for piece in pieces {
        count += 1;
        points += shapes::count(piece);
        if count > most || points > PlanRequest::MAX_POINTS {
            return false;
        }
    }
    true
}

/// Returns the corners of a route from the start to the goal, without the start.
///
/// The grid of the routes is coarser than the pieces: it knows a passage to about one cell of the map. If there is no
/// route by passages that are surely wide enough, one by narrower passages may still hold a plan.
fn route(map: &PlannerMap, routes: &mut RouteFinder, trip: &Trip) -> Option<Vec<Point2<f64>>> {
    let cell = map.clearance_grid().frame.resolution;
    [0.0, cell].into_iter().find_map(|narrower| {
        routes.prepare(map, trip.clearance - narrower - MARGIN);
        let found = routes.lengths(map, 0, trip.goal, [trip.start])?;
        let mut nodes = Vec::new();
        found.way_to(trip.start, &mut nodes);
        let (&(last, _), &(first, _)) = (nodes.first()?, nodes.last()?);
        let is_near = |a: Point2<f64>, b: Point2<f64>| (a - b).norm() <= MAX_OFFSET;
        let leads_there = is_near(first, trip.start) && is_near(last, trip.goal);
        let corners = nodes.iter().rev().map(|(corner, _)| *corner);
        leads_there.then(|| corners.chain([trip.goal]).collect())
    })
}

/// Returns the rectangle about points that leaves this room (m) beside them, within `inside`.
fn rectangle(start: Point2<f64>, points: &[Point2<f64>], room: f64, inside: &Aabb) -> Aabb {
    let first = Aabb {
        min: start,
        max: start,
    };
    let about = points.iter().fold(first, |about, p| Aabb {
        min: about.min.inf(p),
        max: about.max.sup(p),
    });
    let about = grown(&about, room);
    Aabb {
        min: about.min.sup(&inside.min),
        max: about.max.inf(&inside.max),
    }
}

fn grown(area: &Aabb, by: f64) -> Aabb {
    let by = Vector2::repeat(by);
    Aabb {
        min: area.min - by,
        max: area.max + by,
    }
}

fn meet(a: &Aabb, b: &Aabb) -> bool {
    a.min <= b.max && b.min <= a.max
}
