//! Slots of the trees in a pursuer's route finder.
//!
//! A tree is rebuilt when another root comes to its slot. A slot with two uses would cost time; its
//! results would still be right.

/// Paths of this robot, with their first legs.
pub const OWN: usize = 0;

/// Path lengths of this robot, up to the range of predictions.
pub const ARRIVAL: usize = 1;

/// First of [`MAX_EXITS`] slots for the paths to the exits.
pub const EXITS: usize = 2;

/// Maximum number of exits for predicted paths and guards; further ones are ignored.
pub const MAX_EXITS: usize = 8;

/// First slot of the assignment, which has one for every pursuer and evader.
pub const ASSIGNMENT: usize = EXITS + MAX_EXITS;
