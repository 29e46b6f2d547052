//! Results of the checker on valid trajectories, on every kind of violation, and on invalid input.

mod drive;
mod forgeries;
mod hostile;
mod lies;
mod valid;
