//! Functions that a library calls in a tick: the map, driving to a point, random numbers.

#![expect(unsafe_code, reason = "called by the library, with its pointers")]

use core::ffi::{c_char, c_void};
use std::cell::RefCell;

use control::go_to::GoToParams;
use geometry::math;
use nalgebra::Point2;
use navigation::tangent_graph::{PathLeg, TangentGraph};
use planner::RawOutput;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::abi::{Messages, Point, Robot, Steering, Tick, TickFunctions};
use crate::error::{CallError, Unexpected};
use crate::records::{Records, unknown};
use crate::start_functions::text;

/// The functions of all ticks.
pub static FUNCTIONS: TickFunctions = TickFunctions {
    clearance,
    free_run,
    line_is_clear,
    away_from_obstacles,
    way,
    go_to,
    direction,
    angle,
    read,
    write,
    random,
    fail,
};

/// Maximum angle between two corners of a way around an arc (rad).
const MAX_BEND: f64 = 0.25;

/// The private part of a [`Tick`].
#[derive(Debug)]
pub struct TickContext<'a> {
    /// The task of a planner; none in a process.
    pub task: Option<RobotTask<'a>>,
    /// Length of a tick (s).
    pub dt: f64,
    /// Random stream of the planner.
    pub random: &'a RefCell<ChaCha8Rng>,
    /// Messages of the topics that it reads.
    pub records: &'a Records,
    /// Topics that a process writes.
    pub outputs: RefCell<&'a mut [RawOutput]>,
    /// First failure that the library reports.
    pub failure: RefCell<Option<CallError>>,
}

/// The robot of a planner in a tick, and its map.
#[derive(Debug)]
pub struct RobotTask<'a> {
    /// The map.
    pub map: &'a PlannerMap,
    /// The own robot.
    pub own: &'a Robot,
    /// Limits of its drive.
    pub limits: Limits,
}

impl TickContext<'_> {
    fn fail(&self, reason: impl Into<CallError>) {
        self.failure.borrow_mut().get_or_insert(reason.into());
    }

    /// Takes the elements of a message; NULL for none.
    ///
    /// # Errors
    /// [`Unexpected`] names the topic.
    unsafe fn write(
        &self,
        topic: &str,
        elements: *const c_void,
        count: usize,
    ) -> Result<(), Unexpected> {
        let mut outputs = self.outputs.borrow_mut();
        let names = outputs.iter().map(|output| output.topic().name());
        let names: Vec<&'static str> = names.collect();
        let Some(at) = names.iter().position(|name| *name == topic) else {
            return Err(unknown("protean_write", topic, names.into_iter()));
        };
        let output = &mut outputs[at];
        let capacity = output.capacity();
        if count > capacity || (count > 0 && elements.is_null()) {
            let found = if elements.is_null() {
                "NULL"
            } else {
                "an array"
            };
            return Err(Unexpected::new(
                format!("protean_write: {topic}: {count} elements at {found}"),
                format!("at most {capacity} in an array"),
            ));
        }
        let bytes = if count == 0 {
            Vec::new()
        } else {
            let length = count * output.topic().facts().element.size;
            // SAFETY: duty of the library, stated in the header: the array has this many elements of the size that was
            // compared at the start.
            unsafe { std::slice::from_raw_parts(elements.cast::<u8>(), length) }.to_vec()
        };
        if !output.fill(bytes) {
            return Err(Unexpected::new(
                format!("protean_write: {topic}"),
                "one message in a tick",
            ));
        }
        Ok(())
    }
}

impl RobotTask<'_> {
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
unsafe fn context<'a>(tick: *const Tick) -> Option<&'a TickContext<'a>> {
    // SAFETY: the caller's; the context was made for the same call.
    unsafe { tick.as_ref()?.context.cast::<TickContext<'a>>().as_ref() }
}

/// Returns the task of a planner in a tick; a process fails.
///
/// # Safety
/// As [`context`].
unsafe fn task<'a>(tick: *const Tick) -> Option<&'a RobotTask<'a>> {
    // SAFETY: the caller's.
    let context = unsafe { context(tick) }?;
    if context.task.is_none() {
        let text = "a function of planners: a process has no robot and no map";
        context.fail(CallError::Reported(text.to_owned()));
    }
    context.task.as_ref()
}

unsafe extern "C" fn clearance(tick: *const Tick, at: Point) -> f64 {
    // SAFETY: duty of the library, stated in the header.
    let task = unsafe { task(tick) };
    task.map_or(0.0, |task| task.map.clearance(at.into()))
}

unsafe extern "C" fn free_run(tick: *const Tick, from: Point, to: Point, radius: f64) -> f64 {
    // SAFETY: duty of the library, stated in the header.
    let task = unsafe { task(tick) };
    task.map_or(0.0, |task| {
        task.map.free_run(from.into(), to.into(), radius)
    })
}

unsafe extern "C" fn line_is_clear(tick: *const Tick, from: Point, to: Point, radius: f64) -> bool {
    // SAFETY: duty of the library, stated in the header.
    let task = unsafe { task(tick) };
    task.is_some_and(|task| task.map.line_is_clear(from.into(), to.into(), radius))
}

unsafe extern "C" fn away_from_obstacles(tick: *const Tick, at: Point) -> Point {
    // SAFETY: duty of the library, stated in the header.
    let task = unsafe { task(tick) };
    let away = task.and_then(|task| task.map.away_from_obstacles(at.into()));
    away.unwrap_or_default().into()
}

unsafe extern "C" fn way(
    tick: *const Tick,
    to: Point,
    margin: f64,
    points: *mut Point,
    capacity: usize,
) -> usize {
    // SAFETY: duty of the library, stated in the header.
    let task = unsafe { task(tick) };
    let (Some(task), Some(to)) = (task, to.finite()) else {
        return 0;
    };
    let corners = task.way(to, margin);
    let count = corners
        .len()
        .min(if points.is_null() { 0 } else { capacity });
    // SAFETY: the library has room for `capacity` points there, as the header demands.
    unsafe { std::ptr::copy_nonoverlapping(corners.as_ptr(), points, count) };
    corners.len()
}

unsafe extern "C" fn go_to(tick: *const Tick, target: Point, steering: *mut Steering) {
    // SAFETY: duties of the library, stated in the header.
    let (context, task, steering) = unsafe { (context(tick), task(tick), steering.as_mut()) };
    let (Some(context), Some(task), Some(steering)) = (context, task, steering) else {
        return;
    };
    let pose = task.own.pose();
    let params = GoToParams::default();
    let command = control::go_to::go_to(
        &pose,
        target.into(),
        None,
        &task.limits,
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

unsafe extern "C" fn read(tick: *const Tick, topic: *const c_char) -> Messages {
    // SAFETY: duties of the library, stated in the header.
    let (context, topic) = unsafe { (context(tick), text(topic)) };
    let found = context.and_then(|context| {
        let found = context.records.messages(&topic);
        found.map_err(|reason| context.fail(reason)).ok()
    });
    found.unwrap_or(Messages {
        all: std::ptr::null(),
        count: 0,
    })
}

unsafe extern "C" fn write(
    tick: *const Tick,
    topic: *const c_char,
    elements: *const c_void,
    count: usize,
) {
    // SAFETY: duties of the library, stated in the header.
    let (context, topic) = unsafe { (context(tick), text(topic)) };
    if let Some(context) = context {
        // SAFETY: duty of the library, stated in the header.
        let written = unsafe { context.write(&topic, elements, count) };
        written.unwrap_or_else(|reason| context.fail(reason));
    }
}

unsafe extern "C" fn random(tick: *const Tick) -> f64 {
    // SAFETY: duty of the library, stated in the header.
    let context = unsafe { context(tick) };
    context.map_or(0.0, |context| context.random.borrow_mut().random())
}

unsafe extern "C" fn fail(tick: *const Tick, reason: *const c_char) {
    // SAFETY: duties of the library, stated in the header.
    let (context, reason) = unsafe { (context(tick), text(reason)) };
    if let Some(context) = context {
        context.fail(CallError::Reported(reason));
    }
}
