//! Arrival times of disc robots over the whole arena.
//!
//! The arrival time `T` of a wave that starts at some robots and travels at their speed `v` solves
//! the eikonal equation |∇T| = 1/v on the free space. [`Lattice`] is the free space of a robot of
//! one radius, sampled at a pitch. [`Medium`] adds the corners at which paths bend. [`Wave`] solves
//! the equation on it by fast marching (J. A. Sethian, *A fast marching level set method for
//! monotonically advancing fronts*, PNAS 93(4), 1996), with upwind differences of second order
//! (*Level Set Methods and Fast Marching Methods*, 1999, §8.3) and exact times near the sources and
//! the corners, where differences are worst.
//!
//! Robots are points that move freely at their top speed here: turning takes no time. Distances in
//! the open are exact up to 1 m; the errors beyond it and in the city are
//! asserted in `tests/wavefront.rs`.

/// Maximum error of an arrival time, relative to the exact shortest path (asserted in the tests).
pub const MAX_ERROR: f64 = 0.02;

mod bends;
mod lattice;
mod march;
mod medium;
mod path;
mod queue;
mod seed;

pub use lattice::Lattice;
pub use march::Wave;
pub use medium::Medium;
pub use seed::{SIGHT, Source};
