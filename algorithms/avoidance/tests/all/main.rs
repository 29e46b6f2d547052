//! Steering in the city and other places; one program, because linking four takes minutes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod avoidance;
mod drive;
mod field_goldens;
mod random_world;
mod walls_and_bodies;
