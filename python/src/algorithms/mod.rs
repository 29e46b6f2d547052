//! The algorithms as functions on arrays.

pub mod coverage;
pub mod fields;
pub mod followers;
pub mod navigation;
pub mod patrol;
pub mod rrt_star;
pub mod steering;
pub mod tracking;
pub mod trajectory;
