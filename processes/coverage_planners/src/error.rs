//! Reasons why a planner cannot cover a site.

use chaotic_maps::KeyError;
use coverage::boustrophedon::BoustrophedonError;
use coverage::decomposition::BridgeError;
use coverage::keyed::KeyedError;
use coverage::legs::RoundingError;
use coverage::plan::PlanError;
use coverage::sub_goals::site::SiteError;
use coverage::tour::TourError;
use parameters::ParamsError;
use thiserror::Error;

/// Reason why a planner cannot cover a site.
#[derive(Debug, Error)]
pub enum DesignError {
    /// There is no site.
    #[error(transparent)]
    Site(#[from] SiteError),
    /// The process knows no pieces of the map.
    #[error(
        "the map has more pieces than world/shapes holds: use a map with fewer obstacles or corners"
    )]
    Shapes,
    /// A bridge does not fit the site.
    #[error(transparent)]
    Bridge(#[from] BridgeError),
    /// Route, iterations or transit do not fit the site.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The key makes no generator.
    #[error(transparent)]
    Key(#[from] KeyError),
    /// Cells or choices do not fit the site.
    #[error(transparent)]
    Keyed(#[from] KeyedError),
    /// The lanes do not fit the site.
    #[error(transparent)]
    Lanes(#[from] BoustrophedonError),
    /// The robot cannot drive from waypoint to waypoint.
    #[error(transparent)]
    Driver(#[from] ParamsError),
    /// The robot cannot drive arcs.
    #[error(transparent)]
    Arcs(#[from] RoundingError),
}

impl DesignError {
    /// Returns the parameter to change, by its dotted path; empty if none can help.
    pub fn field(&self) -> &str {
        match self {
            Self::Site(error) => error.field(),
            Self::Bridge(_) => "bridges",
            Self::Plan(PlanError::Tour(
                TourError::IterationsMissing { .. } | TourError::NothingToDo,
            )) => "iterations",
            Self::Plan(PlanError::Tour(_)) => "route",
            Self::Plan(PlanError::NoWait) => "transit",
            Self::Key(_) => "key",
            Self::Keyed(KeyedError::Cell { .. }) => "goals.cell",
            Self::Driver(error) | Self::Keyed(KeyedError::Params(error)) => &error.field,
            _ => "",
        }
    }
}
