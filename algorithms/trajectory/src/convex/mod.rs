//! Sequential convex programming on curves.
//!
//! [`curve_search`] finds a curve among the obstacles by a few programs; [`quadratic_program`] states
//! and solves one; [`obstacle_planes`] are its half-planes; [`scaling`] defines their coordinates.

pub mod curve_search;
pub mod effort;
pub mod obstacle_planes;
pub mod quadratic_program;
pub mod scaling;
