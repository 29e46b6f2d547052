//! Branches of recorded runs. The run of a log is executed again to a moment, in one thread, and goes on with a change.
//!
//! * [`Parent`] is the run in the log, with the branches that it is itself; [`Parent::branch`] records a branch and compares
//!   what precedes it with the log;
//! * [`fn@continuations`] repeats a branch with other random streams, and counts the outcomes;
//! * [`decided()`] does so at many moments, and finds the one from which on an outcome was settled; [`curve_svg`] draws it.

mod continuations;
mod curve;
mod decided;
mod error;
mod parent;
mod walks;

#[cfg(test)]
mod tests;

pub use continuations::{OutcomeShare, RobotShares, continuations};
pub use curve::curve_svg;
pub use decided::{DecidedOptions, DecidedReport, Decision, Moment, decided};
pub use error::BranchError;
pub use parent::{BranchReport, Parent};
pub use walks::ContinuationOptions;
