//! Results of the checker on valid trajectories, on every kind of violation, and on invalid input.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod drive;
mod hostile;
mod modifications;
mod valid;
mod violations;
