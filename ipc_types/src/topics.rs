//! Every topic: name, type, who writes, who reads, and its quality of service. Nothing opens a
//! service by a string of its own.

use crate::message::Message;
use crate::messages::observer::Prediction;
use crate::messages::optimiser::{PlanRequest, PlanResponse, TrajectorySample};
use crate::messages::perception::{BeliefHeader, Particle, Sighting};
use crate::messages::process::{LogHeader, ProcessEvent, ProcessStatus, RunControl};
use crate::messages::referee::{DominanceCell, DominanceHeader, Verdict};
use crate::messages::robot::{
    Command, PlanHeader, PlanPoint, ScanHeader, TreeEdge, TreeHeader, WaypointEnd,
};
use crate::messages::world::{
    CoverageState, MapCell, MapHeader, ObstacleEvent, RobotState, ShapePoint, ShapesHeader,
    WorldEvent, WorldHeader,
};
use crate::stamp::{Header, PlainHeader};

/// Whether a message of a topic is one element or a sequence of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Always exactly one element.
    One,
    /// Any number of elements up to the publisher's capacity.
    Many,
}

/// Quality of service of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Qos {
    /// Samples kept by a publisher for subscribers that join late.
    pub history: usize,
    /// Messages that one publisher may send per tick; buffers are multiples of it.
    pub per_tick: usize,
    /// How many processes may publish.
    pub publishers: usize,
    /// How many processes may subscribe, the recorder and four onlookers included.
    pub subscribers: usize,
}

/// What a topic's quality of service depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunSize {
    /// Robots in the run, ≥ 1.
    pub robots: usize,
    /// Processes of the run without the orchestrator, ≥ 1.
    pub processes: usize,
    /// Obstacle events of the scenario.
    pub events: usize,
}

/// Seats kept free on every topic for people who look on (viewers, the command-line tool).
pub const ONLOOKERS: usize = 4;

impl RunSize {
    fn readers(&self) -> usize {
        // Every process, the recorder, and onlookers.
        self.processes + 1 + ONLOOKERS
    }
}

/// A publish–subscribe topic.
pub trait Topic: Send + Sync + 'static {
    /// Name of the service and of the log's channel.
    const NAME: &'static str;
    /// One element or many.
    const SHAPE: Shape;
    /// Name of the sequence in schemas of [`Shape::Many`] topics.
    const ELEMENTS: &'static str;
    /// Whether the topic is part of the simulated history (its payloads are in the digest).
    const SIMULATED: bool;
    /// The user header.
    type Header: Header;
    /// The element of the payload slice.
    type Element: Message;
    /// Quality of service in a run of this size.
    fn qos(size: &RunSize) -> Qos;
}

macro_rules! topics {
    ($(
        $(#[doc = $doc:literal])+
        $topic:ident = $name:literal : $shape:ident, $elements:literal, $header:ty, $element:ty,
        simulated $simulated:literal, qos |$size:ident| $qos:expr;
    )+) => {
        $(
            $(#[doc = $doc])+
            #[derive(Debug, Clone, Copy)]
            pub struct $topic;
            impl Topic for $topic {
                const NAME: &'static str = $name;
                const SHAPE: Shape = Shape::$shape;
                const ELEMENTS: &'static str = $elements;
                const SIMULATED: bool = $simulated;
                type Header = $header;
                type Element = $element;
                fn qos($size: &RunSize) -> Qos {
                    $qos
                }
            }
        )+

        /// Something to be done for every topic, each with its own types.
        pub trait TopicVisitor {
            /// What the visitor can fail with.
            type Error;
            /// Called once per topic.
            ///
            /// # Errors
            /// As the visitor defines; ends the visit.
            fn visit<T: Topic>(&mut self) -> Result<(), Self::Error>;
        }

        /// Visits every topic in the order of this list.
        ///
        /// # Errors
        /// The first error of the visitor.
        pub fn for_each_topic<V: TopicVisitor>(visitor: &mut V) -> Result<(), V::Error> {
            $(visitor.visit::<$topic>()?;)+
            Ok(())
        }

        /// The names of all topics, in the order of this list.
        pub const NAMES: &[&str] = &[$($name),+];
    };
}

topics! {
    /// Poses, velocities and status of every robot (ground truth): simulator → all.
    WorldState = "world/state": Many, "robots", WorldHeader, RobotState, simulated true,
        qos |s| Qos { history: 1, per_tick: 1, publishers: 1, subscribers: s.readers() };
    /// The map, whole, at every revision; late joiners get the last: simulator → all.
    WorldMap = "world/map": Many, "cells", MapHeader, MapCell, simulated true,
        qos |s| Qos { history: 1, per_tick: 1, publishers: 1, subscribers: s.readers() };
    /// The exact pieces of the map, whole, at every revision, after the map; late joiners get the
    /// last: simulator → planners that search for paths.
    WorldShapes = "world/shapes": Many, "points", ShapesHeader, ShapePoint, simulated true,
        qos |s| Qos { history: 1, per_tick: 1, publishers: 1, subscribers: s.readers() };
    /// What happened at a tick: captures, escapes, contacts…: simulator → all.
    WorldEvents = "world/event": Many, "events", PlainHeader, WorldEvent, simulated true,
        qos |s| Qos { history: 0, per_tick: 1, publishers: 1, subscribers: s.readers() };
    /// The area visited so far, now and then, if the rules account for it: simulator → all.
    Coverage = "world/coverage": One, "coverage", PlainHeader, CoverageState, simulated true,
        qos |s| Qos { history: 1, per_tick: 1, publishers: 1, subscribers: s.readers() };
    /// An obstacle appears, disappears or moves: orchestrator → simulator, recorder, ahead of time
    /// for a tick that is known; simulator → recorder, when a robot has brought it about.
    ObstacleEvents = "world/obstacle_event": One, "event", PlainHeader, ObstacleEvent, simulated true,
        qos |s| Qos { history: 0, per_tick: s.events.max(1), publishers: 2, subscribers: 2 + ONLOOKERS };
    /// Range scan of one robot: simulator → planners.
    Scan = "robot/scan": Many, "ranges", ScanHeader, f32, simulated true,
        qos |s| Qos { history: 0, per_tick: s.robots, publishers: 1, subscribers: s.readers() };
    /// Measurements of every opponent: perception → its team.
    Sightings = "perception/sighting": Many, "sightings", PlainHeader, Sighting, simulated true,
        qos |s| Qos { history: 0, per_tick: 1, publishers: s.processes, subscribers: s.readers() };
    /// Particles and moments of the belief about one opponent: perception → pursuers.
    Belief = "perception/belief": Many, "particles", BeliefHeader, Particle, simulated true,
        qos |s| Qos { history: 0, per_tick: s.robots, publishers: s.processes, subscribers: s.readers() };
    /// Velocity command of one robot: planners → simulator.
    Commands = "robot/command": One, "command", PlainHeader, Command, simulated true,
        qos |s| Qos { history: 0, per_tick: s.robots, publishers: s.processes, subscribers: 2 + ONLOOKERS };
    /// Waypoints or trajectory of one robot: planners → all.
    Plan = "robot/plan": Many, "points", PlanHeader, PlanPoint, simulated true,
        qos |s| Qos { history: 0, per_tick: s.robots, publishers: s.processes, subscribers: s.readers() };
    /// Search tree of one robot: planners → viewers.
    Tree = "robot/tree": Many, "edges", TreeHeader, TreeEdge, simulated true,
        qos |s| Qos { history: 0, per_tick: s.robots, publishers: s.processes, subscribers: 1 + ONLOOKERS };
    /// Waypoints that ended at this tick: planners that visit waypoints → all.
    Waypoints = "robot/waypoint": Many, "waypoints", PlainHeader, WaypointEnd, simulated true,
        qos |s| Qos { history: 0, per_tick: s.robots, publishers: s.processes, subscribers: s.readers() };
    /// Who can still escape: referee → all.
    Verdicts = "world/verdict": Many, "verdicts", PlainHeader, Verdict, simulated true,
        qos |s| Qos { history: 1, per_tick: 1, publishers: s.processes, subscribers: s.readers() };
    /// Who reaches every place first: referee → viewers.
    Dominance = "world/dominance": Many, "cells", DominanceHeader, DominanceCell, simulated true,
        qos |s| Qos { history: 1, per_tick: 1, publishers: s.processes, subscribers: s.readers() };
    /// Where watched robots will be, and how wrong that was: observer → all.
    Predictions = "observer/prediction": Many, "predictions", PlainHeader, Prediction, simulated true,
        qos |s| Qos { history: 1, per_tick: 1, publishers: s.processes, subscribers: s.readers() };
    /// Heartbeats: all → orchestrator.
    Status = "process/status": One, "status", PlainHeader, ProcessStatus, simulated false,
        qos |s| Qos { history: 1, per_tick: 1, publishers: s.processes, subscribers: 2 + ONLOOKERS };
    /// What the run does: orchestrator → all.
    Control = "run/control": One, "control", PlainHeader, RunControl, simulated false,
        qos |s| Qos { history: 1, per_tick: 2, publishers: 1, subscribers: s.readers() };
    /// Processes that left the run, and came back: orchestrator → recorder.
    ProcessEvents = "process/event": One, "event", PlainHeader, ProcessEvent, simulated false,
        qos |s| Qos { history: 0, per_tick: 2 * s.processes, publishers: 1, subscribers: 1 + ONLOOKERS };
    /// What the processes wrote to stderr, by lines: orchestrator → recorder.
    ProcessLog = "process/log": Many, "text", LogHeader, u8, simulated false,
        qos |_s| Qos { history: 0, per_tick: 16, publishers: 1, subscribers: 1 + ONLOOKERS };
}

/// Event that tells a process without the turn page that it is its turn; the id is its index.
pub const TURN_EVENT: &str = "run/turn";
/// Event with which such a process says that it has done its turn; the id is its index.
pub const DONE_EVENT: &str = "run/done";
/// Added to the index in [`TURN_EVENT`]: there will be no more turns.
pub const END_OF_TURNS: usize = 64;

/// Event with which a client of [`OptimiserPlan`] wakes the optimiser after it has asked; the id is
/// the client's index, and of no matter.
pub const PLAN_ASKED_EVENT: &str = "optimiser/asked";
/// Event with which the optimiser wakes a client that it has answered; the id is the client's index
/// (the source in the request's stamp).
pub const PLAN_ANSWERED_EVENT: &str = "optimiser/answered";
/// Largest id of an event.
pub const MAX_EVENT_ID: usize = 2 * END_OF_TURNS;

/// A request–response service: header and slice both ways.
pub trait Service: Send + Sync + 'static {
    /// Name of the service.
    const NAME: &'static str;
    /// User header of requests.
    type RequestHeader: Header;
    /// Element of requests.
    type RequestElement: Message;
    /// User header of responses.
    type ResponseHeader: Header;
    /// Element of responses.
    type ResponseElement: Message;
}

/// Minimum-time planning: navigator ↔ optimiser.
#[derive(Debug, Clone, Copy)]
pub struct OptimiserPlan;

impl Service for OptimiserPlan {
    const NAME: &'static str = "optimiser/plan";
    type RequestHeader = PlanRequest;
    type RequestElement = ShapePoint;
    type ResponseHeader = PlanResponse;
    type ResponseElement = TrajectorySample;
}
