//! The interface between this program and a library, declared once; a test writes it in C, as `protean_planner.h`.

use core::ffi::{c_char, c_void};

use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};

use crate::c_types::{c_functions, c_structures};

/// Version of the interface. A changed structure or function needs another one.
pub const VERSION: u32 = 2;

/// Number that stands for no robot.
pub const NO_ROBOT: u32 = u32::MAX;

/// Bit of [`PlannerTable::inputs`]: beliefs about opponents.
pub const BELIEFS: u32 = 1;
/// Bit of [`PlannerTable::inputs`]: range scans.
pub const SCANS: u32 = 2;
/// Bit of [`PlannerTable::inputs`]: exact shapes of the map, for shortest ways.
pub const WAYS: u32 = 4;

/// Bit of [`Topic::flags`]: messages count in the next tick.
pub const LATER: u32 = 1;
/// Bit of [`Topic::flags`]: one writer.
pub const SOLE: u32 = 2;

/// Inputs by their names in the header and their bits.
pub const INPUTS: [(&str, u32, &str); 3] = [
    ("PROTEAN_BELIEFS", BELIEFS, "beliefs about the opponents"),
    ("PROTEAN_SCANS", SCANS, "range scans of the own robot"),
    ("PROTEAN_WAYS", WAYS, "shortest ways: protean_way"),
];

/// Values of [`Robot::side`] by their names in the header.
pub const SIDES: [(&str, u8, &str); 3] = [
    ("PROTEAN_OTHER", 0, "neither team-mate nor opponent"),
    ("PROTEAN_TEAM", 1, "of the own team: the own robot, too"),
    ("PROTEAN_OPPONENT", 2, "of a hostile team"),
];

c_structures! {
    /// Point or vector.
    pub struct Point = "protean_point" {
        x: f64 = "along x (m)",
        y: f64 = "along y (m)",
    }

    /// Robot of the run.
    pub struct Robot = "protean_robot" {
        name: *const c_char = "name in the scenario",
        team: *const c_char = "name of its team",
        x: f64 = "position of its centre (m)",
        y: f64 = "position of its centre (m)",
        theta: f64 = "heading (rad)",
        v: f64 = "forward speed (m/s)",
        omega: f64 = "turning rate (rad/s)",
        radius: f64 = "radius of its body (m)",
        v_max: f64 = "maximum forward speed (m/s)",
        v_reverse_max: f64 = "maximum backward speed (m/s)",
        omega_max: f64 = "maximum turning rate (rad/s)",
        goal: Point = "centre of its goal (m); NaN without one",
        index: u32 = "index in the scenario",
        role: u8 = "0 neutral, 1 pursuer, 2 evader",
        side: u8 = "PROTEAN_OTHER, PROTEAN_TEAM or PROTEAN_OPPONENT",
        active: bool = "takes part: not caught, not escaped",
        present: bool = "its body is in the world",
    }

    /// Hypothesis of an opponent's pose.
    pub struct Particle = "protean_particle" {
        x: f32 = "position (m)",
        y: f32 = "position (m)",
        theta: f32 = "heading (rad)",
        weight: f32 = "weight, at least 0, not normalised",
    }

    /// Belief of the team about an opponent.
    pub struct Belief = "protean_belief" {
        x: f64 = "mean position (m)",
        y: f64 = "mean position (m)",
        theta: f64 = "mean heading (rad)",
        position_std: f64 = "standard deviation of the position (m)",
        particles: *const Particle = "hypotheses",
        particle_count: usize = "number of particles",
        robot: u32 = "index of the opponent",
        seen: bool = "a robot of the team sees it in this tick",
    }

    /// Range scan of the own robot, as a LaserScan of ROS.
    pub struct Scan = "protean_scan" {
        angle_min: f64 = "direction of the first beam from the heading (rad)",
        angle_increment: f64 = "angle between two beams (rad)",
        range_min: f64 = "minimum range (m)",
        range_max: f64 = "maximum range (m)",
        ranges: *const f32 = "ranges (m); infinite without an echo",
        range_count: usize = "number of ranges",
    }

    /// State of the world in a tick; valid until the call that receives it returns.
    pub struct Tick = "protean_tick" {
        time: f64 = "simulated time since the start of the run (s)",
        dt: f64 = "length of a tick (s)",
        own: *const Robot = "robot to steer; NULL in a process",
        robots: *const Robot = "all robots in the order of their indices",
        robot_count: usize = "number of robots",
        exits: *const Point = "centres of the exits (m)",
        exit_count: usize = "number of exits",
        beliefs: *const Belief = "beliefs, with PROTEAN_BELIEFS",
        belief_count: usize = "number of beliefs",
        scan: *const Scan = "range scan, with PROTEAN_SCANS; NULL without one",
        map_revision: u64 = "number that changes with every obstacle",
        functions: *const TickFunctions = "called by the functions protean_NAME",
        context: *const c_void = "private",
    }

    /// Command for the own robot in a tick, and its reason for viewers. It is a stop without reasons at the call.
    pub struct Steering = "protean_steering" {
        v: f64 = "forward speed (m/s), clipped to the limits",
        omega: f64 = "turning rate (rad/s), clipped to the limits",
        aim: Point = "final target point (m); NaN without one",
        waypoint: Point = "current target point (m); NaN without one",
        target: u32 = "index of the chased robot, or PROTEAN_NO_ROBOT",
    }

    /// Facts at the start of the run; valid until the call that receives it returns.
    pub struct Start = "protean_start" {
        own: *const Robot = "robot to steer, at its start; NULL in a process",
        robots: *const Robot = "all robots in the order of their indices",
        robot_count: usize = "number of robots",
        exits: *const Point = "centres of the exits (m)",
        exit_count: usize = "number of exits",
        capture_radius: f64 = "distance of a capture (m); 0 without captures",
        dt: f64 = "length of a tick (s)",
        seed: u64 = "seed of the planner of this robot, or of the process",
        functions: *const StartFunctions = "called by the functions protean_NAME",
        context: *const c_void = "private",
    }

    /// Field of the elements of a topic: PROTEAN_FIELD.
    pub struct Field = "protean_field" {
        name: *const c_char = "name, that of the member of the structure",
        kind: *const c_char = "type in the words of ROS 2, as float64, or uint8 with the length in brackets",
        offset: u32 = "offset in the structure (bytes)",
        size: u32 = "size in the structure (bytes)",
    }

    /// Topic that a library reads or writes. To read one, name and size suffice.
    pub struct Topic = "protean_topic" {
        name: *const c_char = "name, as sonar/echo",
        size: usize = "size of the structure of an element (bytes): PROTEAN_ELEMENTS",
        fields: *const Field = "fields of the structure; NULL for a topic that is read unchecked",
        field_count: usize = "number of fields",
        capacity: usize = "maximum number of elements of a message that is written",
        may_be_infinite: *const c_char = "names of fields in which infinity is valid, or NULL",
        drawing: *const c_char = "form in pictures by names of fields, as x=x y=y angle=angle; or NULL",
        flags: u32 = "sum of PROTEAN_LATER and PROTEAN_SOLE, for a topic that is written",
    }

    /// Message of a topic that a library reads; valid as the tick.
    pub struct Message = "protean_message" {
        header: *const c_void = "its header, as docs/reference/messages.md describes it",
        elements: *const c_void = "array of the structures of its elements",
        count: usize = "number of elements",
        tick: u64 = "tick in which it was sent",
        source: u32 = "index of the process that sent it",
    }

    /// Messages of a topic in a tick, by tick and sender.
    pub struct Messages = "protean_messages" {
        all: *const Message = "the messages",
        count: usize = "number of messages",
    }

    /// Functions and topics of a library. It steers robots by `steer`, or it is a process with topics of its own by
    /// `step`; the other one is NULL. No function may throw.
    pub struct PlannerTable = "protean_planner" {
        version: u32 = "PROTEAN_PLANNER_VERSION",
        inputs: u32 = "sum of PROTEAN_BELIEFS, PROTEAN_SCANS and PROTEAN_WAYS; 0 in a process",
        create: Option<unsafe extern "C" fn(*const Start) -> *mut c_void> =
            "returns the planner of a robot, or the process; NULL after protean_refuse",
        steer: Option<unsafe extern "C" fn(*mut c_void, *const Tick, *mut Steering) -> ()> =
            "steers the robot in a tick",
        destroy: Option<unsafe extern "C" fn(*mut c_void) -> ()> = "frees what create has returned",
        step: Option<unsafe extern "C" fn(*mut c_void, *const Tick) -> ()> =
            "reads and writes the messages of a tick",
        reads: *const Topic = "topics that it reads",
        read_count: usize = "number of them",
        writes: *const Topic = "topics that a process writes",
        write_count: usize = "number of them",
    }
}

c_functions! {
    /// Functions of a tick.
    pub struct TickFunctions = "protean_tick_functions" of Tick as tick {
        /// Distance from a point to the nearest obstacle (m); at most 0 inside one and outside the map.
        fn clearance(at: Point) -> f64;
        /// Distance that a disc of this radius (m) covers on the line before it touches an obstacle (m).
        fn free_run(from: Point, to: Point, radius: f64) -> f64;
        /// True if a disc of this radius (m) can travel straight from point to point.
        fn line_is_clear(from: Point, to: Point, radius: f64) -> bool;
        /// Unit vector away from the nearest obstacle; (0, 0) where there is none.
        fn away_from_obstacles(at: Point) -> Point;
        /// Writes the corners of the shortest way of the own robot to a point, without its start and with its end,
        /// for a body that is larger by the margin (m); no more than the capacity. Returns the number of corners, 0
        /// without a way. Needs PROTEAN_WAYS.
        fn way(to: Point, margin: f64, points: *mut Point, capacity: usize) -> usize;
        /// Sets command and waypoint: the own robot turns to a point and drives there at its maximum speed; a stop at
        /// the point.
        fn go_to(target: Point, steering: *mut Steering) -> ();
        /// Unit vector of an angle (rad): (cos, sin), with the same bits on every machine.
        fn direction(angle: f64) -> Point;
        /// Angle of a vector (rad), in (-pi, pi]: atan2, with the same bits on every machine.
        fn angle(vector: Point) -> f64;
        /// Messages of a topic in `reads`: those of this tick, and of the tick before if the sender writes it
        /// with PROTEAN_LATER. Another name ends the run.
        fn read(topic: *const c_char) -> Messages;
        /// Writes the message of this tick to a topic in `writes` of a process: an array of its structures, which is
        /// copied. Without a call there is none.
        fn write(topic: *const c_char, elements: *const c_void, count: usize) -> ();
        /// Random number in [0, 1), from the stream of this planner.
        fn random() -> f64;
        /// Ends the run with this text after the call.
        fn fail(text: *const c_char) -> ();
    }
}

c_functions! {
    /// Functions of the start.
    pub struct StartFunctions = "protean_start_functions" of Start as start {
        /// Value of a parameter in `params` of the scenario, 1 or 0 for true or false; the other value if it is
        /// absent. A parameter of the scenario that no call names is an error.
        fn number(key: *const c_char, absent: f64) -> f64;
        /// All parameters as a JSON object; checks are then the planner's.
        fn params() -> *const c_char;
        /// Refuses to start, with this text; create then returns NULL.
        fn refuse(text: *const c_char) -> ();
    }
}

impl Point {
    /// A point that stands for none.
    pub(crate) const NONE: Self = Self {
        x: f64::NAN,
        y: f64::NAN,
    };
}

impl Steering {
    /// A stop without reasons.
    pub(crate) const STOP: Self = Self {
        v: 0.0,
        omega: 0.0,
        aim: Point::NONE,
        waypoint: Point::NONE,
        target: NO_ROBOT,
    };
}

impl From<Point2<f64>> for Point {
    fn from(p: Point2<f64>) -> Self {
        Self { x: p.x, y: p.y }
    }
}

impl From<Vector2<f64>> for Point {
    fn from(v: Vector2<f64>) -> Self {
        Self { x: v.x, y: v.y }
    }
}

impl From<Point> for Point2<f64> {
    fn from(p: Point) -> Self {
        Self::new(p.x, p.y)
    }
}

impl Point {
    /// Returns the point unless a coordinate is not finite.
    pub(crate) fn finite(self) -> Option<Point2<f64>> {
        (self.x.is_finite() && self.y.is_finite()).then(|| self.into())
    }
}

impl Robot {
    /// Returns its pose.
    pub(crate) fn pose(&self) -> Pose2 {
        Pose2::new(self.x, self.y, self.theta)
    }
}
