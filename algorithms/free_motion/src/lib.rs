//! The fastest motions of a differential-drive robot in free space.
//!
//! The robot has a maximum speed, forwards and backwards or forwards only, and a maximum turning rate;
//! both may step. Their quotient is the radius of the arcs that it drives at full speed and full
//! turning rate.
//!
//! - [`words`]: the fastest motions from pose to pose, as sequences of arcs, straight lines and turns on
//!   the spot.
//! - [`least_time()`]: a lower bound on the time from a pose to a place or a pose, with obstacles or
//!   without.
//!
//! ```
//! use free_motion::{Heading, Speeds, least_time, words};
//! use geometry::pose::Pose2;
//!
//! // To the side: a turn on the spot, a quarter circle, and a line.
//! let (from, to) = (Pose2::new(0.0, 0.0, 0.0), Pose2::new(-4.0, 2.0, 2.5));
//! let fastest = words::forwards(&from, &to, 1.0).into_iter().map(|word| word.cost());
//! let fastest = fastest.fold(f64::INFINITY, f64::min);
//! let speeds = Speeds { v: 1.0, omega: 1.0, reverse: false };
//! let bound = least_time(&speeds, &from, to.position(), Heading::At(to.theta));
//! assert!(bound <= fastest);
//! ```

mod least_time;
mod motion;
pub mod words;

pub use least_time::{Heading, Speeds, least_time};
pub use motion::Motion;

#[cfg(test)]
mod tests;
