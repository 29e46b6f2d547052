//! All topics with their facts; `topics!` states each fact once. No code opens a service by a literal
//! name.
//!
//! * [`Topic`]: a topic as a type, with the types of its messages; [`TopicId`]: a topic as a value, over
//!   which a `match` is exhaustive; [`TopicFacts`]: the facts;
//! * [`Service`]: request–response; the constants at the end: events.

use crate::message::{Descriptor, Message};
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
use crate::transport::{ExchangePorts, Ports};

/// Number of elements of the messages of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arity {
    /// Always exactly one element.
    One,
    /// Any number of elements up to the publisher's capacity.
    Many,
}

/// The facts of a topic that do not depend on the size of the run.
#[derive(Debug, Clone, Copy)]
pub struct TopicFacts {
    /// Name of the service and of the log's channel.
    pub name: &'static str,
    /// One element or many.
    pub arity: Arity,
    /// Name of the sequence in schemas of [`Arity::Many`] topics.
    pub elements: &'static str,
    /// The user header.
    pub header: Descriptor,
    /// The element of the payload slice.
    pub element: Descriptor,
    /// `true` if the topic is part of the simulated history (its payloads are in the digest).
    pub simulated: bool,
    /// `true` if late joiners get the last message, because it describes a lasting state.
    pub latched: bool,
    /// `true` if a message is sent in answer to the input of its tick, so that its stamp contains the
    /// duration of its sender's step.
    pub timed: bool,
    /// Fields in which infinity is valid (see their documentation); in all others, a message with a
    /// number that is not finite is rejected. For elements that are plain numbers: the name of the
    /// sequence.
    pub may_be_infinite: &'static [&'static str],
}

/// Quality of service of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Qos {
    /// Number of samples that a publisher keeps for late joiners.
    pub history: usize,
    /// Maximum number of messages that one publisher sends per tick; buffers are multiples of it.
    pub per_tick: usize,
    /// Maximum number of publishers.
    pub publishers: usize,
    /// Maximum number of subscribers, including the recorder and four external ones.
    pub subscribers: usize,
}

/// Inputs of a topic's quality of service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunSize {
    /// Number of robots in the run, ≥ 1.
    pub robots: usize,
    /// Number of processes of the run without the orchestrator, ≥ 1.
    pub processes: usize,
    /// Number of obstacle events of the scenario.
    pub events: usize,
}

/// Number of subscribers reserved on every topic for external programs (viewers, the command-line tool).
pub const EXTERNAL_SUBSCRIBERS: usize = 4;

impl RunSize {
    fn readers(&self) -> usize {
        // Every process, the recorder, and external subscribers.
        self.processes + 1 + EXTERNAL_SUBSCRIBERS
    }
}

/// A publish–subscribe topic as a type.
pub trait Topic: Send + Sync + 'static {
    /// The topic as a value.
    const ID: TopicId;
    /// Name of the service and of the log's channel.
    const NAME: &'static str = Self::ID.facts().name;
    /// One element or many.
    const ARITY: Arity = Self::ID.facts().arity;
    /// The user header.
    type Header: Header;
    /// The element of the payload slice.
    type Element: Message;

    /// Its ports between processes.
    fn ports() -> &'static Ports<Self::Header, Self::Element>;
}

impl TopicId {
    /// Name of the service and of the log's channel.
    pub const fn name(self) -> &'static str {
        self.facts().name
    }

    /// The topic with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        let rank = NAMES.iter().position(|known| *known == name)?;
        Self::ALL.get(rank).copied()
    }

    /// Index of the topic in [`TopicId::ALL`] and in [`NAMES`].
    pub const fn rank(self) -> usize {
        self as usize
    }

    /// Returns `true` if only one process of a run publishes it.
    pub fn has_one_publisher(self) -> bool {
        let size = RunSize {
            robots: 1,
            processes: 2,
            events: 1,
        };
        self.qos(&size).publishers == 1
    }
}

/// Generates, from the table of all topics, the type of each, [`TopicId`] with its facts, and the visit
/// of all.
macro_rules! topics {
    ($(
        $(#[doc = $doc:literal])+
        $topic:ident = $name:literal : $arity:ident, $elements:literal, $header:ty, $element:ty,
        simulated $simulated:literal, latched $latched:literal, timed $timed:literal,
        may_be_infinite $infinite:expr,
        qos |$size:ident| per_tick $per_tick:expr, publishers $publishers:expr,
        subscribers $subscribers:expr;
    )+) => {
        $(
            $(#[doc = $doc])+
            #[derive(Debug, Clone, Copy)]
            pub struct $topic;
            impl Topic for $topic {
                const ID: TopicId = TopicId::$topic;
                type Header = $header;
                type Element = $element;

                fn ports() -> &'static Ports<$header, $element> {
                    static PORTS: Ports<$header, $element> = Ports::new();
                    &PORTS
                }
            }
        )+

        /// A topic as a value.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum TopicId {
            $($(#[doc = $doc])+ $topic,)+
        }

        impl TopicId {
            /// All topics, in the order of their table.
            pub const ALL: &[Self] = &[$(Self::$topic),+];

            /// The facts of the topic.
            pub const fn facts(self) -> &'static TopicFacts {
                match self {
                    $(Self::$topic => const {
                        &TopicFacts {
                            name: $name,
                            arity: Arity::$arity,
                            elements: $elements,
                            header: <$header as Message>::DESCRIPTOR,
                            element: <$element as Message>::DESCRIPTOR,
                            simulated: $simulated,
                            latched: $latched,
                            timed: $timed,
                            may_be_infinite: &$infinite,
                        }
                    },)+
                }
            }

            /// Quality of service in a run of this size.
            pub fn qos(self, size: &RunSize) -> Qos {
                let history = usize::from(self.facts().latched);
                match self {
                    $(Self::$topic => {
                        let $size = size;
                        Qos {
                            history,
                            per_tick: $per_tick,
                            publishers: $publishers,
                            subscribers: $subscribers,
                        }
                    })+
                }
            }
        }

        /// An operation for every topic, each with its own types.
        pub trait TopicVisitor {
            /// Error of the visitor.
            type Error;
            /// Called once per topic.
            ///
            /// # Errors
            /// Any error of the visitor; it ends the visit.
            fn visit<T: Topic>(&mut self) -> Result<(), Self::Error>;
        }

        /// Visits every topic in the order of their table.
        ///
        /// # Errors
        /// The first error of the visitor.
        pub fn for_each_topic<V: TopicVisitor>(visitor: &mut V) -> Result<(), V::Error> {
            $(visitor.visit::<$topic>()?;)+
            Ok(())
        }

        /// The names of all topics, in the order of their table.
        pub const NAMES: &[&str] = &[$($name),+];
    };
}

topics! {
    /// Poses, velocities and status of every robot (ground truth): simulator → all.
    WorldState = "world/state": Many, "robots", WorldHeader, RobotState,
        simulated true, latched true, timed true,
        may_be_infinite [],
        qos |s| per_tick 1, publishers 1, subscribers s.readers();
    /// The map, whole, at every revision; late joiners get the last: simulator → all.
    WorldMap = "world/map": Many, "cells", MapHeader, MapCell,
        simulated true, latched true, timed false,
        // Infinite: a map without obstacles.
        may_be_infinite ["clearance"],
        qos |s| per_tick 1, publishers 1, subscribers s.readers();
    /// The exact pieces of the map, whole, at every revision, after the map; late joiners get the
    /// last: simulator → planners that search for paths.
    WorldShapes = "world/shapes": Many, "points", ShapesHeader, ShapePoint,
        simulated true, latched true, timed false,
        may_be_infinite [],
        qos |s| per_tick 1, publishers 1, subscribers s.readers();
    /// Events of a tick: captures, escapes, contacts…: simulator → all.
    WorldEvents = "world/event": Many, "events", PlainHeader, WorldEvent,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick 1, publishers 1, subscribers s.readers();
    /// The area visited so far, now and then, if the rules account for it: simulator → all.
    Coverage = "world/coverage": One, "coverage", PlainHeader, CoverageState,
        simulated true, latched true, timed true,
        may_be_infinite [],
        qos |s| per_tick 1, publishers 1, subscribers s.readers();
    /// An obstacle appears, disappears or moves: orchestrator → simulator, recorder, ahead of time
    /// for a tick that is known; simulator → recorder, when a robot has brought it about.
    ObstacleEvents = "world/obstacle_event": One, "event", PlainHeader, ObstacleEvent,
        simulated true, latched false, timed false,
        may_be_infinite [],
        qos |s| per_tick s.events.max(1), publishers 2, subscribers 2 + EXTERNAL_SUBSCRIBERS;
    /// Range scan of one robot: simulator → planners.
    Scan = "robot/scan": Many, "ranges", ScanHeader, f32,
        simulated true, latched false, timed true,
        // Infinite: beams that hit nothing.
        may_be_infinite ["ranges"],
        qos |s| per_tick s.robots, publishers 1, subscribers s.readers();
    /// Measurements of every opponent: perception → its team.
    Sightings = "perception/sighting": Many, "sightings", PlainHeader, Sighting,
        simulated true, latched false, timed true,
        // Infinite: a robot that is not seen may be anywhere.
        may_be_infinite ["sigma"],
        qos |s| per_tick 1, publishers s.processes, subscribers s.readers();
    /// Particles and moments of the belief about one opponent: perception → pursuers.
    Belief = "perception/belief": Many, "particles", BeliefHeader, Particle,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick s.robots, publishers s.processes, subscribers s.readers();
    /// Velocity command of one robot: planners → simulator.
    Commands = "robot/command": One, "command", PlainHeader, Command,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick s.robots, publishers s.processes, subscribers 2 + EXTERNAL_SUBSCRIBERS;
    /// Waypoints or trajectory of one robot: planners → all.
    Plan = "robot/plan": Many, "points", PlanHeader, PlanPoint,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick s.robots, publishers s.processes, subscribers s.readers();
    /// Search tree of one robot: planners → viewers.
    Tree = "robot/tree": Many, "edges", TreeHeader, TreeEdge,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick s.robots, publishers s.processes, subscribers 1 + EXTERNAL_SUBSCRIBERS;
    /// Waypoints that ended at this tick: planners that visit waypoints → all.
    Waypoints = "robot/waypoint": Many, "waypoints", PlainHeader, WaypointEnd,
        simulated true, latched false, timed true,
        // Infinite: a waypoint that was left out before the robot set out for it.
        may_be_infinite ["closest"],
        qos |s| per_tick s.robots, publishers s.processes, subscribers s.readers();
    /// Verdicts on the evaders' escapes: referee → all.
    Verdicts = "world/verdict": Many, "verdicts", PlainHeader, Verdict,
        simulated true, latched true, timed true,
        // Infinite: no pursuer to be earlier than, no way out.
        may_be_infinite ["margin", "time"],
        qos |s| per_tick 1, publishers s.processes, subscribers s.readers();
    /// Dominance regions: referee → viewers.
    Dominance = "world/dominance": Many, "cells", DominanceHeader, DominanceCell,
        simulated true, latched true, timed true,
        // Infinite: no pursuer to be earlier than, no way out.
        may_be_infinite ["margin"],
        qos |s| per_tick 1, publishers s.processes, subscribers s.readers();
    /// Predicted positions of watched robots, and their errors: observer → all.
    Predictions = "observer/prediction": Many, "predictions", PlainHeader, Prediction,
        simulated true, latched true, timed true,
        // Infinite: a method that makes no prediction.
        may_be_infinite ["x", "y", "error"],
        qos |s| per_tick 1, publishers s.processes, subscribers s.readers();
    /// Heartbeats: all → orchestrator.
    Status = "process/status": One, "status", PlainHeader, ProcessStatus,
        simulated false, latched true, timed false,
        may_be_infinite [],
        qos |s| per_tick 1, publishers s.processes, subscribers 2 + EXTERNAL_SUBSCRIBERS;
    /// Commands to the processes of the run: orchestrator → all.
    Control = "run/control": One, "control", PlainHeader, RunControl,
        simulated false, latched true, timed false,
        may_be_infinite [],
        qos |s| per_tick 2, publishers 1, subscribers s.readers();
    /// Processes that left the run, and came back: orchestrator → recorder.
    ProcessEvents = "process/event": One, "event", PlainHeader, ProcessEvent,
        simulated false, latched false, timed false,
        may_be_infinite [],
        qos |s| per_tick 2 * s.processes, publishers 1, subscribers 1 + EXTERNAL_SUBSCRIBERS;
    /// Lines that the processes wrote to stderr: orchestrator → recorder.
    ProcessLog = "process/log": Many, "text", LogHeader, u8,
        simulated false, latched false, timed false,
        may_be_infinite [],
        qos |_s| per_tick 16, publishers 1, subscribers 1 + EXTERNAL_SUBSCRIBERS;
}

/// Event that starts a step of a process without the tick barrier; the id is its index.
pub const TURN_EVENT: &str = "run/turn";
/// Event by which such a process reports the end of its step; the id is its index.
pub const DONE_EVENT: &str = "run/done";
/// Added to the index in [`TURN_EVENT`]: there will be no more steps.
pub const END_OF_TURNS: usize = 64;

/// Largest id of an event.
pub const MAX_EVENT_ID: usize = 2 * END_OF_TURNS;

/// A request–response service: header and slice both ways.
pub trait Service: Send + Sync + 'static {
    /// Name of the service.
    const NAME: &'static str;
    /// Event by which a client wakes the server after a request; the id is the client's index, and ignored.
    const ASKED: &'static str;
    /// Event by which the server wakes a client after its answer; the id is the client's index (the source in the
    /// request's stamp).
    const ANSWERED: &'static str;
    /// User header of requests.
    type RequestHeader: Header;
    /// Element of requests.
    type RequestElement: Message;
    /// User header of responses.
    type ResponseHeader: Header;
    /// Element of responses.
    type ResponseElement: Message;

    /// Its ports between processes.
    fn ports() -> &'static PortsOf<Self>;
}

/// The ports of a service.
pub type PortsOf<S> = ExchangePorts<
    <S as Service>::RequestHeader,
    <S as Service>::RequestElement,
    <S as Service>::ResponseHeader,
    <S as Service>::ResponseElement,
>;

/// Minimum-time planning: navigator ↔ optimiser.
#[derive(Debug, Clone, Copy)]
pub struct OptimiserPlan;

impl Service for OptimiserPlan {
    const NAME: &'static str = "optimiser/plan";
    const ASKED: &'static str = "optimiser/asked";
    const ANSWERED: &'static str = "optimiser/answered";
    type RequestHeader = PlanRequest;
    type RequestElement = ShapePoint;
    type ResponseHeader = PlanResponse;
    type ResponseElement = TrajectorySample;

    fn ports() -> &'static PortsOf<Self> {
        static PORTS: PortsOf<OptimiserPlan> = ExchangePorts::new();
        &PORTS
    }
}
