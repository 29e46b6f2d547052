//! Geometry of the plane: shapes, maps, and the queries of planners and the world.
//!
//! - [`pose`], [`region`], [`extent`]: poses, velocities, areas of the rules, and limits of coordinates;
//! - [`shape`]: shapes of a scenario, and their convex parts with exact contacts, rays and sweeps;
//! - [`map`]: map files, the maps built from them, distances, rays and passages;
//! - [`grid`], [`blur`], [`visibility`]: grids of cells, the blurred map, and lines of sight;
//! - [`text_file`]: text files that users write;
//! - [`math`]: elementary functions that compute the same bits on every machine.
//!
//! All functions are pure, except for the loaders of map files: equal inputs give equal bits on every machine.

pub mod blur;
pub mod extent;
pub mod grid;
pub mod map;
pub mod math;
pub mod pose;
pub mod region;
pub mod shape;
pub mod text_file;
pub mod visibility;
