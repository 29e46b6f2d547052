//! Slots of the trees in a pursuer's route finder.
//!
//! A tree is rebuilt when another root comes to its slot. A slot with two uses would cost time; its
//! results would still be right. All trees have first legs, although only those of [`OWN`] are used: the tree of a
//! colleague in an assignment is then the one by which the colleague drives, if they share a map.

/// Paths of this robot.
pub const OWN: usize = 0;

/// First slot of the assignment, which has one for every pursuer.
pub const ASSIGNMENT: usize = 1;
