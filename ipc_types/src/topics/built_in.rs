//! The topics of Protean's own processes.

use super::topic_id::TopicId;
use super::{EXTERNAL_SUBSCRIBERS, Topic, TopicFacts, TopicVisitor};
use crate::messages::attacker::{AttackHeader, Guard};
use crate::messages::observer::Prediction;
use crate::messages::perception::{BeliefHeader, Particle, Sighting};
use crate::messages::process::{LogHeader, ProcessEvent, ProcessStatus, RunControl};
use crate::messages::referee::{DominanceCell, DominanceHeader, Verdict};
use crate::messages::robot::{
    Command, MeasuredPose, PlanHeader, PlanPoint, ScanHeader, TreeEdge, TreeHeader, WaypointEnd,
};
use crate::messages::world::{
    CoverageState, MapCell, MapHeader, ObstacleEvent, RobotState, ShapePoint, ShapesHeader,
    WorldEvent, WorldHeader,
};
use crate::stamp::PlainHeader;

/// Declares Protean's topics from their table: the type of each, its identifier, and the visit of all.
macro_rules! built_in {
    ($(
        $(#[doc = $doc:literal])+
        $topic:ident = $name:literal : $arity:ident, $elements:literal, $header:ty, $element:ty,
        simulated $simulated:literal, latched $latched:literal, timed $timed:literal,
        may_be_infinite $infinite:expr,
        qos |$size:ident| per_tick $per_tick:expr, publishers $publishers:expr,
        subscribers $subscribers:expr;
    )+) => {
        $(
            $crate::topic! {@ TopicId::$topic;
                $(#[doc = $doc])+
                $topic = $name: $arity, $elements, $header, $element,
                simulated $simulated, latched $latched, timed $timed,
                may_be_infinite $infinite,
                qos |$size| per_tick $per_tick, publishers $publishers, subscribers $subscribers;
            }
        )+

        /// Places of the topics in their table.
        enum Place {
            $($topic,)+
        }

        /// Identifiers, with the names of their types.
        #[allow(non_upper_case_globals)]
        impl TopicId {
            $($(#[doc = $doc])+ pub const $topic: Self = Self::from_index(Place::$topic as usize);)+
        }

        /// The facts of the built-in topics, in the order of their table.
        pub(super) const FACTS: &[&TopicFacts] = &[$(<$topic as Topic>::FACTS),+];

        /// The names of the built-in topics, in the order of their table.
        pub const NAMES: &[&str] = &[$($name),+];

        /// Visits every built-in topic in the order of their table.
        ///
        /// # Errors
        /// The first error of the visitor.
        pub fn for_each_topic<V: TopicVisitor>(visitor: &mut V) -> Result<(), V::Error> {
            $(visitor.visit::<$topic>()?;)+
            Ok(())
        }
    };
}

built_in! {
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
    /// Events of robots: a guard sights, loses, returns: planners → all.
    RobotEvents = "robot/event": Many, "events", PlainHeader, WorldEvent,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick s.robots, publishers s.processes, subscribers s.readers();
    /// Poses of robots outside of the simulation, which were measured since the last tick: bridges → simulator.
    MeasuredPoses = "robot/pose": Many, "poses", PlainHeader, MeasuredPose,
        simulated true, latched false, timed true,
        may_be_infinite [],
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
    /// Attacks that begin, with the robots that may detect each: attackers → all.
    Attacks = "attacker/attack": Many, "guards", AttackHeader, Guard,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick 4, publishers s.processes, subscribers s.readers();
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
