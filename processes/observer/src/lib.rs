//! Adversary that observes robots and predicts their positions.
//!
//! It measures poses with noise, along lines of sight, and predicts positions some seconds ahead by
//! several methods at once ([`predictors`]). They range from inertia alone to full knowledge of the
//! method by which a robot's goals are made, except the key; the key is recovered where the method
//! allows it. Each prediction is stored until it is due and then scored against the truth
//! ([`score`]): a measure of unpredictability.

pub mod knowledge;
pub mod layout;
pub mod legs;
pub mod moment;
pub mod params;
pub mod pose_sensor;
pub mod predictors;
pub mod process;
mod recovery;
pub mod score;
pub mod travel;
pub mod watched;

pub use params::ObserverParams;
