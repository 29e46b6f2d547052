//! Maps: the specifications in scenarios, and the maps for computations.

mod cells;
mod decode;
mod field;
mod image;
mod index;
mod passage;
mod pgm;
mod png_image;
mod query;
mod recent;
mod ros;
mod segment;
mod shape_map;
mod spec;
mod vector;
mod world_map;
mod world_queries;

pub use cells::{CellMap, MAX_RUNS, Occupancy, UnknownCells, rectangles};
pub use image::{Image, ImageError, MAX_PIXELS, Pixel};
pub use passage::{Passages, Reach};
pub use query::Hit;
pub use ros::{RosMap, RosMapError, RosMode};
pub use segment::TOUCHING;
pub use shape_map::ShapeMap;
pub use spec::{MapError, MapSpec};
pub use vector::{
    Bounds, MAX_CELLS, MAX_EXITS, MAX_OBSTACLES, ObstacleSpec, VectorMap, VectorMapError,
};
pub use world_map::{Obstacle, ObstacleChange, ObstacleError, ObstacleId, WorldMap};
