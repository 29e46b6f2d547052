//! The verdicts of the checker on trajectories driven honestly, on every kind of lie, and on junk.

mod drive;
mod forgeries;
mod hostile;
mod lies;
mod valid;
