//! Who keeps which trees in a pursuer's route finder.
//!
//! Trees are planted anew when another root comes to a slot, so a slot used for two things would
//! cost time; it would never be wrong.

/// Ways of this robot, with first legs.
pub const OWN: usize = 0;

/// Lengths of this robot's ways, as far as predictions reach.
pub const ARRIVAL: usize = 1;

/// The first of [`MAX_EXITS`] slots for the ways to the exits.
pub const EXITS: usize = 2;

/// Most exits that are looked at for predicted ways and guards; further ones are left out.
pub const MAX_EXITS: usize = 8;

/// The first slot of the assignment, which has one for every pursuer and evader.
pub const ASSIGNMENT: usize = EXITS + MAX_EXITS;
