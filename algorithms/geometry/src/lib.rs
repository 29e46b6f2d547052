//! Geometry of the plane: shapes, maps, and the queries that planners and the world make of them.
//!
//! - [`pose`], [`region`], [`extent`]: places, velocities, areas of the rules, and how large a coordinate may be;
//! - [`shape`]: shapes as written, and their convex parts with exact contacts, rays and sweeps;
//! - [`map`]: map files, the ground they describe, distances, rays and passages on it;
//! - [`grid`], [`blur`], [`visibility`]: grids of cells, the blurred map, and lines of sight;
//! - [`math`]: elementary functions that compute the same bits on every machine.
//!
//! Everything here is pure, but for the loaders of map files: values in, values out, the same bits on every machine.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod blur;
pub mod extent;
pub mod grid;
pub mod map;
pub mod math;
pub mod pose;
pub mod region;
pub mod shape;
pub mod visibility;
