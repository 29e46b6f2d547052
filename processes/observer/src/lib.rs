//! An adversary that watches robots and predicts where they will be.
//!
//! It sees poses with noise, along lines of sight, and predicts positions some seconds ahead by
//! several methods at once ([`predictors`]): from knowing nothing but physics to knowing everything
//! about how a robot's goals are made except the key, which is recovered where the method allows. Each prediction is kept until its time has come
//! and is then scored against the truth ([`score`]): "unpredictable" becomes a measured number.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

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
