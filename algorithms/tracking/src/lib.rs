//! Line-of-sight sightings, and beliefs about observed robots.
//!
//! A simulated sensor gives sightings whose quality depends on the line of sight ([`sighting`], on
//! [`geometry::visibility`]), and a particle filter keeps one belief per observed robot
//! ([`particle_filter`]). [`tracker::Perception`] does both for a team and a tick. All results are
//! functions of the inputs and of one ChaCha8 stream per observed robot.
//!
//! ```
//! use std::sync::Arc;
//!
//! use geometry::blur::BlurredMap;
//! use geometry::grid::{Grid, GridFrame};
//! use geometry::pose::Pose2;
//! use nalgebra::Point2;
//! use rand::SeedableRng as _;
//! use rand_chacha::ChaCha8Rng;
//! use tracking::params::PerceptionParams;
//! use tracking::particle_filter::MotionLimits;
//! use tracking::space::Space;
//! use tracking::tracker::{Perception, TargetSetup, TargetTruth};
//!
//! // A free place of 4 m × 4 m.
//! let frame = GridFrame {
//!     width: 40,
//!     height: 40,
//!     resolution: 0.1,
//!     origin: Point2::origin(),
//! };
//! let map = BlurredMap::new(&Grid::filled(frame, true), 0.15)?;
//! let space = Arc::new(Space::new(&map));
//! let start = Pose2::new(3.0, 2.0, 0.0);
//! let evader = TargetSetup {
//!     robot: 1,
//!     limits: MotionLimits {
//!         v_max: 0.5,
//!         v_reverse_max: 0.05,
//!         omega_max: 1.0,
//!     },
//!     start: Some(start),
//!     rng: ChaCha8Rng::seed_from_u64(1),
//! };
//! let mut perception = Perception::new(&PerceptionParams::default(), space, vec![evader])?;
//! let observers = [Pose2::new(1.0, 2.0, 0.0)];
//! let truth = TargetTruth {
//!     robot: 1,
//!     pose: start,
//! };
//! let tracks = perception.update(&observers, &[truth], 0.05)?;
//! assert!((tracks[0].belief().mean.x - 3.0).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod belief;
pub mod fast;
mod motion_limits;
pub mod params;
pub mod particle_filter;
pub mod sighting;
pub mod space;
pub mod tracker;
pub mod watch;
