//! Functions that a library calls in a tick: the map, driving to a point, random numbers.

use core::ffi::c_char;
use std::cell::RefCell;

use control::go_to::GoToParams;
use geometry::math;
use nalgebra::Point2;
use navigation::tangent_graph::{PathLeg, TangentGraph};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::abi::{Point, Robot, Steering, Tick, TickFunctions};
use crate::start_functions::text;

/// The functions of all ticks.
pub(crate) static FUNCTIONS: TickFunctions = TickFunctions {
    clearance,
    free_run,
    line_is_clear,
    away_from_obstacles,
    way,
    go_to,
    direction,
    angle,
    random,
    fail,
};

/// Maximum angle between two corners of a way around an arc (rad).
const MAX_BEND: f64 = 0.25;

/// The private part of a [`Tick`].
#[derive(Debug)]
pub(crate) struct TickContext<'a> {
    /// The map.
    pub map: &'a PlannerMap,
    /// The own robot.
    pub own: &'a Robot,
    /// Limits of its drive.
    pub limits: Limits,
    /// Length of a tick (s).
    pub dt: f64,
    /// Random stream of the planner.
    pub random: &'a RefCell<ChaCha8Rng>,
    /// First failure that the library reports.
    pub failure: RefCell<Option<String>>,
}

impl TickContext<'_> {
    /// Returns the corners of the shortest way of the own robot to a point; empty without one.
    fn way(&self, to: Point2<f64>, margin: f64) -> Vec<Point> {
        let radius = self.own.radius + margin;
        let Some(space) = self.map.space() else {
            return Vec::new();
        };
        let graph = self.map.derived().get(("graph of ways", radius), || {
            TangentGraph::new(space, radius).ok()
        });
        let from = self.own.pose().position();
        let path = graph.as_ref().as_ref().and_then(|g| g.shortest(from, to));
        let mut corners = Vec::new();
        for leg in path.iter().flat_map(|path| &path.legs) {
            let parts = match leg {
                PathLeg::Segment { .. } => 1.0,
                PathLeg::Arc(arc) => (arc.sweep.abs() / MAX_BEND).ceil().max(1.0),
            };
            let parts = parts as u32;
            let corner = |part: u32| Point::from(leg.at(f64::from(part) / f64::from(parts)));
            corners.extend((1..=parts).map(corner));
        }
        corners
    }
}

/// Returns the context of a tick.
///
/// # Safety
/// `tick` is NULL or the pointer that `steer` received, during that call.
#[expect(unsafe_code, reason = "the pointer comes back from the library")]
unsafe fn context<'a>(tick: *const Tick) -> Option<&'a TickContext<'a>> {
    // SAFETY: the caller's; the context was made for the same call.
    unsafe { tick.as_ref()?.context.cast::<TickContext<'a>>().as_ref() }
}

#[expect(unsafe_code, reason = "called by the library")]
unsafe extern "C" fn clearance(tick: *const Tick, at: Point) -> f64 {
    // SAFETY: duty of the library, stated in the header.
    let context = unsafe { context(tick) };
    context.map_or(0.0, |context| context.map.clearance(at.into()))
}

#[expect(unsafe_code, reason = "called by the library")]
unsafe extern "C" fn free_run(tick: *const Tick, from: Point, to: Point, radius: f64) -> f64 {
    // SAFETY: duty of the library, stated in the header.
    let context = unsafe { context(tick) };
    context.map_or(0.0, |context| {
        context.map.free_run(from.into(), to.into(), radius)
    })
}

#[expect(unsafe_code, reason = "called by the library")]
unsafe extern "C" fn line_is_clear(tick: *const Tick, from: Point, to: Point, radius: f64) -> bool {
    // SAFETY: duty of the library, stated in the header.
    let context = unsafe { context(tick) };
    context.is_some_and(|context| context.map.line_is_clear(from.into(), to.into(), radius))
}

#[expect(unsafe_code, reason = "called by the library")]
unsafe extern "C" fn away_from_obstacles(tick: *const Tick, at: Point) -> Point {
    // SAFETY: duty of the library, stated in the header.
    let context = unsafe { context(tick) };
    let away = context.and_then(|context| context.map.away_from_obstacles(at.into()));
    away.unwrap_or_default().into()
}

#[expect(unsafe_code, reason = "called by the library")]
unsafe extern "C" fn way(
    tick: *const Tick,
    to: Point,
    margin: f64,
    points: *mut Point,
    capacity: usize,
) -> usize {
    // SAFETY: duty of the library, stated in the header.
    let context = unsafe { context(tick) };
    let (Some(context), Some(to)) = (context, to.finite()) else {
        return 0;
    };
    let corners = context.way(to, margin);
    let count = corners
        .len()
        .min(if points.is_null() { 0 } else { capacity });
    // SAFETY: the library has room for `capacity` points there, as the header demands.
    unsafe { std::ptr::copy_nonoverlapping(corners.as_ptr(), points, count) };
    corners.len()
}

#[expect(unsafe_code, reason = "called by the library")]
unsafe extern "C" fn go_to(tick: *const Tick, target: Point, steering: *mut Steering) {
    // SAFETY: duties of the library, stated in the header.
    let (context, steering) = unsafe { (context(tick), steering.as_mut()) };
    let (Some(context), Some(steering)) = (context, steering) else {
        return;
    };
    let pose = context.own.pose();
    let params = GoToParams::default();
    let command = control::go_to::go_to(
        &pose,
        target.into(),
        None,
        &context.limits,
        &params,
        context.dt,
    );
    (steering.v, steering.omega) = (command.v, command.omega);
    steering.waypoint = target;
}

extern "C" fn direction(_: *const Tick, angle: f64) -> Point {
    let (y, x) = math::sincos(angle);
    Point { x, y }
}

extern "C" fn angle(_: *const Tick, vector: Point) -> f64 {
    math::atan2(vector.y, vector.x)
}

#[expect(unsafe_code, reason = "called by the library")]
unsafe extern "C" fn random(tick: *const Tick) -> f64 {
    // SAFETY: duty of the library, stated in the header.
    let context = unsafe { context(tick) };
    context.map_or(0.0, |context| context.random.borrow_mut().random())
}

#[expect(unsafe_code, reason = "called by the library")]
unsafe extern "C" fn fail(tick: *const Tick, reason: *const c_char) {
    // SAFETY: duties of the library, stated in the header.
    let (context, reason) = unsafe { (context(tick), text(reason)) };
    if let Some(context) = context {
        context.failure.borrow_mut().get_or_insert(reason);
    }
}
