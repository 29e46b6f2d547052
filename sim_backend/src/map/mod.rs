//! Maps: what a scenario may name as its ground, and the ground that the world computes on.

mod cells;
mod field;
mod index;
mod pgm;
mod query;
mod ros;
mod spec;
mod vector;
mod world_map;

pub use cells::CellMap;
pub use pgm::{MAX_PIXELS, Pgm, PgmError};
pub use ros::{RosMap, RosMapError};
pub use spec::{MapError, MapSpec, UnknownCells};
pub use vector::{Bounds, MAX_CELLS, ObstacleSpec, VectorMap, VectorMapError};
pub use world_map::{Obstacle, ObstacleChange, ObstacleError, ObstacleId, WorldMap};
