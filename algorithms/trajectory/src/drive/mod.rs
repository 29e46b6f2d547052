//! Conversion of paths to trajectories.
//!
//! [`sample_curve`] samples a curve densely, [`speed_profile`] drives along it as fast as the
//! limits allow, [`turn_in_place`] turns on the spot; [`trajectory_builder`] joins these.
//! [`shortest_path_plan`] drives the shortest path itself.

pub mod sample_curve;
pub mod shortest_path_plan;
pub mod speed_profile;
pub mod trajectory_builder;
pub mod turn_in_place;
