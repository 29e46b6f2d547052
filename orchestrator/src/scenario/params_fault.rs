//! Why the parameters of a process were refused.

use config::ReadError;
use patrol::mission::MissionError;
use patrol_planners::PatrolError;
use sim_backend::params::ParamsError;

/// Why the parameters of a process were refused.
#[derive(Debug, Clone, PartialEq)]
pub enum ParamsFault {
    /// They do not fit their type.
    Read(ReadError),
    /// A value is out of its range.
    Field(ParamsError),
    /// Values that do not go together, or a table that makes no sense, in words that say what to
    /// change.
    Refused {
        /// Dotted path of the parameter inside `params` at which it shows.
        field: String,
        /// What is wrong with it.
        message: String,
    },
    /// They cannot be written as JSON (a number that is not finite, say).
    Write(String),
}

impl From<ParamsError> for ParamsFault {
    fn from(error: ParamsError) -> Self {
        Self::Field(error)
    }
}

/// A patrol that cannot be.
pub(super) fn patrol_fault(error: PatrolError) -> ParamsFault {
    match error {
        PatrolError::Params(error) => error.into(),
        PatrolError::Mission(MissionError::Params(error)) => error.within("mission").into(),
        PatrolError::Mission(error) => named_fault("mission", &error),
        PatrolError::Fto(error) => named_fault("fto", &error),
    }
}

/// A refusal at the parameter of a table that its text names first.
fn named_fault(table: &str, error: &dyn core::fmt::Display) -> ParamsFault {
    let message = error.to_string();
    let field = match message.split('`').nth(1) {
        Some(named) => format!("{table}.{named}"),
        None => table.to_owned(),
    };
    ParamsFault::Refused { field, message }
}
