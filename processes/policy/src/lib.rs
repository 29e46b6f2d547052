//! Robots steered by a learned policy in an ONNX file.
//!
//! The policy is a [`network::Network`] from an observation ([`observation::layout::Layout`]) to an action
//! ([`observation::action`]), both as in the environments that it learned in. Its history is the same on every machine.

pub mod params;
pub mod policy;
pub mod process;

pub use params::PolicyParams;
pub use policy::Policy;
