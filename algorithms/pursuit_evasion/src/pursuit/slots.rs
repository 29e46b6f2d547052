//! Slots of the trees in a pursuer's route finder.
//!
//! A tree is rebuilt when another root comes to its slot. A slot with two uses would cost time; its
//! results would still be right.

/// Paths of this robot, with their first legs.
pub const OWN: usize = 0;

/// First slot of the assignment, which has one for every pursuer.
pub const ASSIGNMENT: usize = 1;
