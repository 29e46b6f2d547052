//! The messages and topics of the example.

use ipc_types::message;
use ipc_types::message::ZeroCopySend;
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::Drawing;

message! {
    /// Header of the bearings that one robot measures in a tick.
    pub struct BearingHeader = "bearings/BearingHeader" {
        stamp: Stamp = "when, in which order, by whom",
        x: f64 = "position of the sensor [m]",
        y: f64 = "position of the sensor [m]",
        sigma: f64 = "standard deviation of the angles [rad]",
        robot: u32 = "index of the robot with the sensor",
        reserved: u32 = "always 0",
    }
}
ipc_types::headers!(BearingHeader);

message! {
    /// Bearing of one robot.
    pub struct Bearing = "bearings/Bearing" {
        angle: f64 = "direction in the world [rad]",
        robot: u32 = "index of the robot that is seen",
        reserved: u32 = "always 0",
    }
}

message! {
    /// Position of one robot, from bearings.
    pub struct Track = "bearings/Track" {
        x: f64 = "position [m]",
        y: f64 = "position [m]",
        sigma: f64 = "standard deviation of the position [m]",
        robot: u32 = "index of the robot",
        reserved: u32 = "always 0",
    }
}

ipc_types::topic! {
    /// Bearings of all opponents, one message per sensor: sensor → tracker.
    Bearings = "sonar/bearing": Many, "bearings", BearingHeader, Bearing,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick s.robots, publishers s.processes, subscribers s.readers(),
        drawing Drawing::points("x", "y").towards("angle");
    /// Positions of all robots of which bearings cross: tracker → planners.
    Tracks = "sonar/track": Many, "tracks", PlainHeader, Track,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick 1, publishers s.processes, subscribers s.readers(),
        drawing Drawing::points("x", "y").with_radius("sigma");
}
