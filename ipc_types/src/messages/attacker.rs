//! Attacks on the places that robots guard.

use crate::headers;
use crate::message;
use crate::message::ZeroCopySend;
use crate::stamp::Stamp;

message! {
    /// Header of an attack that begins now, in `attacker/attack`; the elements are the robots that may detect it.
    pub struct AttackHeader = "protean/AttackHeader" {
        stamp: Stamp = "when it begins",
        x: f64 = "place, x [m]",
        y: f64 = "place, y [m]",
        duration_s: f64 = "how long it lasts [s]",
        distance: f64 = "a robot this near to the place detects it [m]",
        sight: f64 = "a robot this near with a free line of sight detects it, too [m]; 0 for robots that do not see",
        method: u32 = "how place and time were chosen: an index of the method names",
        reserved: u32 = "always 0",
    }
}

message! {
    /// Robot that may detect an attack.
    pub struct Guard = "protean/Guard" {
        robot: u32 = "index of the robot",
    }
}

impl AttackHeader {
    /// The methods by their code.
    pub const METHODS: [&'static str; 4] = ["random", "history", "statistical", "best_response"];

    /// The name of its method; `unknown` for an unknown code.
    pub fn method_name(&self) -> &'static str {
        Self::METHODS
            .get(self.method as usize)
            .copied()
            .unwrap_or("unknown")
    }
}

headers!(AttackHeader);
