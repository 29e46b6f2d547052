//! Experiments whose missions are runs of a scenario: `kind = "missions"`, the default.

mod build;
mod experiment;
mod mission;
mod subject;

pub use build::template;
pub use experiment::Experiment;
pub use mission::Mission;
