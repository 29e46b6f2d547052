//! Messages of the simulator to all processes, and changes of obstacles.

use crate::message::ZeroCopySend;

use crate::headers;
use crate::message;
use crate::stamp::Stamp;

message! {
    /// Header of `world/state`.
    pub struct WorldHeader = "protean/WorldHeader" {
        stamp: Stamp = "tick and time of this state; its origin clock is its own sending",
        tick_period_ns: u64 = "simulated time between two ticks [ns]",
        map_revision: u32 = "revision of the map that holds at this tick",
        phase: u32 = "0 running, 1 the game is over: nothing moves after this state",
    }
}

impl WorldHeader {
    /// `phase` while the game runs.
    pub const RUNNING: u32 = 0;
    /// `phase` of the last state.
    pub const OVER: u32 = 1;
}

message! {
    /// One robot in `world/state`: ground truth.
    pub struct RobotState = "protean/RobotState" {
        x: f64 = "position along the world's x axis [m]",
        y: f64 = "position along the world's y axis [m]",
        theta: f64 = "heading [rad], counter-clockwise from +x, in (-pi, pi]",
        v: f64 = "forward speed [m/s]",
        omega: f64 = "turning rate [rad/s]",
        distance: f64 = "path length driven so far [m]",
        robot: u32 = "index of the robot in the scenario",
        contacts: u32 = "contact episodes with obstacles and robots so far",
        team: u8 = "0 neutral, 1 police, 2 evader",
        status: u8 = "0 active, 1 caught, 2 escaped, 3 timed out, 4 goal reached, 5 disabled",
        in_contact: u8 = "1 while touching an obstacle or another robot",
        fail_safe: u8 = "1 while the robot is stopped for want of a valid command",
        present: u8 = "1 while its body stands in the world, in play or not",
        reserved: [u8; 3] = "always 0",
    }
}

message! {
    /// Header of `world/map`.
    pub struct MapHeader = "protean/MapHeader" {
        stamp: Stamp = "since when the map holds",
        resolution: f64 = "side of a cell [m]",
        origin_x: f64 = "outer corner of cell (0, 0), x [m]",
        origin_y: f64 = "outer corner of cell (0, 0), y [m]",
        blur_sigma: f64 = "standard deviation of the Gaussian blur [m]",
        width: u32 = "columns (cells along x)",
        height: u32 = "rows (cells along y)",
        revision: u32 = "counts from 1, +1 with every change",
        reserved: u32 = "always 0",
    }
}

message! {
    /// One cell of `world/map`, row by row from the smallest y, columns along +x.
    pub struct MapCell = "protean/MapCell" {
        clearance: f32 = "distance from the cell's centre to the nearest obstacle [m]; 0 or less inside one",
        blurred: f32 = "Gaussian blur of the free map (1 free), 0..1, not masked by occupancy",
        occupied: u8 = "1 if the cell's centre lies in an obstacle",
        reserved_a: u8 = "always 0",
        reserved_b: u16 = "always 0",
    }
}

message! {
    /// Header of `world/shapes`.
    pub struct ShapesHeader = "protean/ShapesHeader" {
        stamp: Stamp = "since when the shapes stand",
        min_x: f64 = "smallest x of the world [m]; everything beyond the bounds is solid",
        min_y: f64 = "smallest y of the world [m]",
        max_x: f64 = "largest x of the world [m]",
        max_y: f64 = "largest y of the world [m]",
        revision: u32 = "revision of the map that the shapes make up",
        shapes: u32 = "number of shapes",
        complete: u32 = "1; or 0 with no shapes at all if the map has more than fit into a message",
        reserved: u32 = "always 0",
    }
}

message! {
    /// One point of a shape in `world/shapes`. A shape is the convex hull of its points, grown by
    /// their radius: a disc is one point, a polygon its corners, consecutive and counter-clockwise.
    pub struct ShapePoint = "protean/ShapePoint" {
        x: f64 = "x of the point [m]",
        y: f64 = "y of the point [m]",
        radius: f64 = "how far the shape reaches beyond the hull of its points [m], the same for all of them",
        shape: u32 = "index of the shape that the point belongs to, from 0, ascending",
        reserved: u32 = "always 0",
    }
}

message! {
    /// One change of the obstacles in `world/obstacle_event`; applied at the start of the stamp's tick.
    pub struct ObstacleEvent = "protean/ObstacleEvent" {
        x: f64 = "reference point of the shape, x [m]",
        y: f64 = "reference point of the shape, y [m]",
        theta: f64 = "rotation of the shape [rad]",
        radius: f64 = "radius of a circle [m], else 0",
        half_x: f64 = "half extent of a rectangle along its own x [m], else 0",
        half_y: f64 = "half extent of a rectangle along its own y [m], else 0",
        vertices: [f64; 32] = "x, y pairs of a polygon in the world frame [m]",
        vertex_count: u32 = "vertices of the polygon, at most 16",
        id: u32 = "which obstacle; chosen by the sender, unique in the run",
        action: u8 = "0 appear, 1 disappear, 2 move",
        shape: u8 = "0 circle, 1 rectangle, 2 polygon",
        reserved: [u8; 6] = "always 0",
    }
}

message! {
    /// Something that happened in the world, in `world/event`, or to a robot, in `robot/event`. (Its schema name differs: the logged
    /// message of the topic is `protean/WorldEvent` already.)
    pub struct WorldEvent = "protean/Event" {
        x: f64 = "where, x [m]",
        y: f64 = "where, y [m]",
        value: f64 = "by kind: 0 when it has none",
        kind: u32 = "index into the list of names of events: 0 captured, 1 escaped, 2 timed out, 3 goal reached, 4 contact begins, 5 contact ends, 6 invalid command, 7 missing command, 8 obstacle changed, 9 game over, 10 pushed out by an obstacle, 11 trapped by one, 12 released, 13 stands before its goal, 14 sighted the other robot and pursues it, 15 lost it, 16 returned from it to the patrol",
        robot: u32 = "the robot it happened to, or 4294967295",
        other: u32 = "the other robot, the obstacle's id or the exit's index, or 4294967295",
        reserved: u32 = "always 0",
    }
}

impl WorldEvent {
    /// Value for "no robot" or "no other".
    pub const NONE: u32 = u32::MAX;
    /// Names of the kinds by their code, for display and JSON.
    pub const NAMES: [&'static str; 17] = [
        "captured",
        "escaped",
        "timed_out",
        "goal_reached",
        "contact_begin",
        "contact_end",
        "invalid_command",
        "missing_command",
        "obstacle",
        "game_over",
        "pushed_out",
        "trapped",
        "released",
        "stands",
        "sighted",
        "lost",
        "returned",
    ];
    /// Code of the first kind of `robot/event`: a guard has sighted an intruder and pursues it.
    pub const SIGHTED: u32 = 14;
    /// Code of a guard that has lost its intruder.
    pub const LOST: u32 = 15;
    /// Code of a guard that is back on its patrol.
    pub const RETURNED: u32 = 16;

    /// The name of a kind; `unknown` for an unknown code.
    pub fn name_of(kind: u32) -> &'static str {
        Self::NAMES.get(kind as usize).copied().unwrap_or("unknown")
    }
}

message! {
    /// Area visited so far, in `world/coverage`.
    pub struct CoverageState = "protean/CoverageState" {
        fraction: f64 = "visited part of the free cells, 0..1",
        coverable_fraction: f64 = "visited part of the cells that the robots can visit at all, 0..1",
        cell_area: f64 = "area of a cell [m^2]",
        mean_idleness: f64 = "mean time since the last visit over the coverable cells, since the start for cells not visited yet [s]",
        max_idleness: f64 = "largest of these times [s]",
        worst_idleness: f64 = "longest that any coverable cell has waited for a visit so far [s]",
        unevenness: f64 = "standard deviation of the visits of a coverable cell, divided by their mean; 0 before any visit",
        way: f64 = "way driven by the robots that count, together [m]",
        visits: u64 = "visits of all cells; a stay without interruption counts once",
        free: u32 = "free cells",
        visited: u32 = "free cells that have been visited",
        coverable: u32 = "free cells that the robots can visit at all",
        covered: u32 = "coverable cells that have been visited",
    }
}

headers!(WorldHeader, MapHeader, ShapesHeader);
