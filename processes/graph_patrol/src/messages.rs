//! The topic by which robots of a team tell each other where they head for.

use ipc_types::message;
use ipc_types::message::ZeroCopySend;
use ipc_types::stamp::PlainHeader;

message! {
    /// Next place of one robot of a patrol.
    pub struct Intention = "protean/Intention" {
        robot: u32 = "index of the robot",
        node: u32 = "node of the graph that it heads for; 4294967295: none",
        team: u32 = "number of robots that it counts in its team",
        ready: u32 = "1 if the others need not wait for it, else 0",
    }
}

impl Intention {
    /// The node of a robot that heads for none.
    pub const NONE: u32 = u32::MAX;
}

ipc_types::topic! {
    /// Nodes that robots of a patrol head for: planners → their teams.
    Intentions = "patrol/intention": Many, "intentions", PlainHeader, Intention,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick 1, publishers s.processes, subscribers s.readers();
}
