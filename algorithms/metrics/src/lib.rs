//! Metrics of unpredictability and thoroughness of paths that planners, summaries, sweeps and tests
//! share, each with its definition.
//!
//! - [`sequence`]: sequences of numbers and points (Lyapunov exponent, `v(xy)`);
//! - [`path`]: a path against its reference (MAE, ANDC, MAA, RA);
//! - [`track`]: positions over time;
//! - [`driven`]: the turns of a driven path;
//! - [`idleness`]: times between visits of the places of a contour, distances of its robots;
//! - [`coverage`]: coverage of a workplace by a path: rate and evenness;
//! - [`detection`]: attacks on places, and the share of them that guards detect;
//! - [`quantile`]: quantiles of values;
//! - [`prediction`]: accuracy of predictions of a robot's position.
//!
//! ```
//! use metrics::path::mae_lap;
//! use metrics::track::Track;
//! use nalgebra::Point2;
//!
//! let line = [[0.0, 0.0], [4.0, 0.0]].map(Point2::from);
//! let mut lap = Track::default();
//! lap.push(0.0, Point2::new(0.0, 0.5));
//! lap.push(4.0, Point2::new(4.0, 0.5));
//! // The lap runs half a metre beside its reference.
//! assert_eq!(mae_lap(&line, &[lap], 10), Some(0.5));
//! ```

pub mod coverage;
pub mod detection;
pub mod driven;
pub mod idleness;
pub mod path;
pub mod prediction;
pub mod quantile;
pub mod sequence;
pub mod track;
