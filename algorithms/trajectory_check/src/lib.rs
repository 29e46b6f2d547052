//! Independent check of trajectories: decides whether samples that claim to solve a minimum-time
//! planning problem of a differential-drive robot really do. The conditions: from start to goal,
//! within the drive's limits, clear of every obstacle, and driven by the stated controls.
//!
//! The checker shares no code with any planner, optimiser or simulator of this workspace, so that
//! it cannot share their errors. It accepts untrusted input: every input gives a [`Report`]. Units
//! are SI, angles in radians.
//!
//! Samples: the robot is at the pose of each [`Sample`]; between two samples its forward speed and
//! its turning rate change linearly in time from the values of the first to those of the second.
//! Two samples of the same time are a step of the controls: the pose must be the same, and a
//! control may step only if the [`Contract`] does not limit its rate of change.
//!
//! ```
//! use trajectory_check::{Contract, Obstacle, Sample, check};
//! use nalgebra::Point2;
//!
//! // One metre straight ahead at 0.2 m/s, past a disc.
//! let contract = Contract {
//!     obstacles: vec![Obstacle::Disc { center: Point2::new(0.5, 0.3), radius: 0.1 }],
//!     clearance: 0.1,
//!     ..Contract::new([0.0, 0.0, 0.0], [1.0, 0.0], 0.2, 2.0)
//! };
//! let samples: Vec<Sample> = (0..=100)
//!     .map(|k| {
//!         let t = 0.05 * f64::from(k);
//!         Sample { t, x: 0.2 * t, y: 0.0, theta: 0.0, v: 0.2, omega: 0.0 }
//!     })
//!     .collect();
//! let report = check(&contract, &samples);
//! assert!(report.is_valid(), "{report}");
//! assert!((report.min_clearance - 0.1).abs() < 1e-9);
//! ```

mod boundary;
mod clearance;
mod contract;
mod findings;
mod limits;
mod motion;
mod piece;
mod polygon;
mod region;
mod report;
mod sample;
mod tolerances;
mod validity;
mod violation;

pub use contract::{Contract, Obstacle, WheelLimit};
pub use report::{Report, check, check_with};
pub use sample::Sample;
pub use tolerances::Tolerances;
pub use violation::{Excess, Violation};
