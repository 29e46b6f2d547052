//! Initial paths of the methods.
//!
//! A [`Guide`] is a path among the obstacles: the exact shortest one, that of a grid ([`grid_guide`]),
//! or the rest of the last plan ([`previous_plan`]).

pub mod grid_guide;
mod guide_path;
pub mod knot_placement;
pub mod previous_plan;

pub use guide_path::Guide;
