//! Teams of robots.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The team of a robot; it determines captures and shared perception.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum Team {
    /// Takes no part in capture or escape (patrol, coverage, a single robot).
    Neutral = 0,
    /// Catches evaders.
    Police = 1,
    /// Tries to reach an exit uncaught (the chasing-game paper's "Baddie").
    Evader = 2,
}

impl Team {
    /// The team with this wire code, as sent in messages; `None` for an unknown code.
    pub fn from_code(code: u8) -> Option<Self> {
        match code {
            0 => Some(Self::Neutral),
            1 => Some(Self::Police),
            2 => Some(Self::Evader),
            _ => None,
        }
    }

    /// The wire code of the team.
    pub const fn code(self) -> u8 {
        self as u8
    }
}
