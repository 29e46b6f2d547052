//! Results of the checker on valid trajectories, on every kind of violation, and on invalid input.

mod drive;
mod hostile;
mod modifications;
mod valid;
mod violations;
