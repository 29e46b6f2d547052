//! The algorithms as functions on arrays.

pub mod arguments;
pub mod map_queries;
pub mod map_source;
pub mod steering;
