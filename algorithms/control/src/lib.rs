//! Controllers of differential-drive robots: from a pose and an aim to a command within the limits.
//!
//! - [`go_to`]: straight to a point;
//! - [`path_tracking`]: along a path;
//! - [`feedback_linearisation`]: from the desired velocity of a point ahead of the axle.
//!
//! They know no obstacles. All functions are pure: equal inputs give equal bits on every machine.

pub mod feedback_linearisation;
pub mod go_to;
pub mod path_tracking;
