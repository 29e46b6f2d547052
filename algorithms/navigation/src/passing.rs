//! Ways past another robot in a lane that is too narrow for both.
//!
//! Two robots that meet in such a lane can continue only if one of them leaves it. The way by which
//! a robot came, its [`Trail`], is free for the other one, too. So a place beside the trail, far
//! enough from all of it, lets the other pass, and the robot reaches that place: back on its trail,
//! then straight aside ([`retreat`]).

use core::f64::consts::TAU;

use geometry::math;
use nalgebra::{Point2, Vector2};
use planner_view::free_space::FreeSpace;

/// Maximum number of points of a trail; of a longer one the newest.
const MAX_POINTS: usize = 400;
/// Number of directions in which a place is searched.
const DIRECTIONS: u32 = 64;
/// Distances from the trail at which a place is searched, in units of the least one.
const RINGS: [f64; 4] = [1.0 + 1e-9, 1.2, 1.5, 2.0];
/// Number of starts of the search per least distance along the trail.
const STARTS: f64 = 12.0;

/// The way by which a robot came, without loops.
#[derive(Debug, Clone, PartialEq)]
pub struct Trail {
    /// From the oldest to the newest (m).
    points: Vec<Point2<f64>>,
    spacing: f64,
}

impl Trail {
    /// Creates the empty trail of a robot of this radius (m).
    pub fn new(radius: f64) -> Self {
        Self {
            points: Vec::new(),
            // Two places of the robot that are nearer overlap: there is no wall between them.
            spacing: radius,
        }
    }

    /// Adds the robot's place (m). Where it has been before, the trail ends there.
    pub fn add(&mut self, at: Point2<f64>) {
        let near = |p: &Point2<f64>| (at - p).norm() < self.spacing;
        if let Some(first) = self.points.iter().position(near) {
            self.points.truncate(first + 1);
            return;
        }
        if self.points.len() == MAX_POINTS {
            self.points.remove(0);
        }
        self.points.push(at);
    }

    /// The points from the newest to the oldest (m).
    pub fn back(&self) -> impl Iterator<Item = Point2<f64>> {
        self.points.iter().rev().copied()
    }
}

/// Two robots that meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Place of the robot that looks for a retreat (m).
    pub at: Point2<f64>,
    /// Place of the other robot (m).
    pub other: Point2<f64>,
    /// Distance that the robot's centre keeps from obstacles (m).
    pub clearance: f64,
    /// Minimum distance of the two centres while the other passes (m).
    pub apart: f64,
}

/// Place to which a robot leaves for the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Retreat {
    /// At this place (m) beside the lane it lets the other pass.
    Aside(Point2<f64>),
    /// The only place beside the lane is between the two. If the robot goes back to this place (m)
    /// and the other follows, the other has it behind itself.
    Back(Point2<f64>),
}

/// The nearest retreat along the trail; `None` if there is none.
pub fn retreat(space: &FreeSpace, trail: &Trail, meeting: &Meeting) -> Option<Retreat> {
    let behind: Vec<Point2<f64>> = core::iter::once(meeting.at).chain(trail.back()).collect();
    let lane = Lane {
        space,
        meeting,
        points: core::iter::once(meeting.other)
            .chain(behind.iter().copied())
            .collect(),
    };
    let step = meeting.apart / STARTS;
    if let Some(place) = along(&behind, step).find_map(|from| lane.aside(from)) {
        return Some(Retreat::Aside(place));
    }
    along(&[meeting.at, meeting.other], step)
        .filter(|from| (from - meeting.other).norm() >= step)
        .find_map(|from| lane.aside(from))?;
    along(&behind, step)
        .take_while(|p| (p - meeting.at).norm() <= 2.0 * meeting.apart)
        .last()
        .filter(|p| (p - meeting.at).norm() > 0.5 * meeting.apart)
        .map(Retreat::Back)
}

/// The lane that the other robot needs: from its place to that of the robot, and back along the trail.
struct Lane<'a> {
    space: &'a FreeSpace,
    meeting: &'a Meeting,
    points: Vec<Point2<f64>>,
}

impl Lane<'_> {
    /// A place straight aside of a point of the lane from which the other can pass.
    fn aside(&self, from: Point2<f64>) -> Option<Point2<f64>> {
        let Meeting {
            clearance, apart, ..
        } = *self.meeting;
        let places = RINGS.into_iter().flat_map(|ring| {
            (0..DIRECTIONS).map(move |i| {
                let (sin, cos) = math::sincos(TAU * f64::from(i) / f64::from(DIRECTIONS));
                from + Vector2::new(cos, sin) * (ring * apart)
            })
        });
        let other = self.meeting.other;
        // The way to the place leads away from the other robot, and is free when that has come to the
        // end of the trail.
        let near = (from - other).norm().min(apart) - 1e-9;
        let end = self.points.last().copied().unwrap_or(other);
        places
            .filter(|&place| self.space.is_free(place, clearance))
            .filter(|&place| to_segment(other, from, place) >= near)
            .filter(|&place| to_segment(end, from, place) >= apart)
            .filter(|&place| self.distance(place) >= apart)
            .find(|&place| self.space.segment_is_free(from, place, clearance))
    }

    /// Distance (m) of a point from the lane.
    fn distance(&self, p: Point2<f64>) -> f64 {
        let pieces = self.points.windows(2);
        pieces
            .map(|pair| to_segment(p, pair[0], pair[1]))
            .fold(f64::INFINITY, f64::min)
    }
}

/// Distance (m) of a point from the segment from `a` to `b`.
fn to_segment(p: Point2<f64>, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let (way, off) = (b - a, p - a);
    let length = way.norm_squared();
    let part = if length > 0.0 {
        (off.dot(&way) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (off - way * part).norm()
}

/// Points of a polyline at most `step` (m) apart.
fn along(points: &[Point2<f64>], step: f64) -> impl Iterator<Item = Point2<f64>> {
    points.windows(2).flat_map(move |pair| {
        let (a, way) = (pair[0], pair[1] - pair[0]);
        let count = (way.norm() / step).ceil().max(1.0);
        (0..=count as usize).map(move |i| a + way * (i as f64 / count))
    })
}
