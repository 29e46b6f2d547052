//! What an experiment file may contain, beside the overrides (`set`) and the values of the grid.

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::kind::Kind;
use super::metrics::Metric;

/// Most cells (combinations of case and parameters) of one experiment.
pub const MAX_CELLS: usize = 10_000;
/// Most missions (cells times seeds) of one experiment.
pub const MAX_MISSIONS: usize = 1_000_000;

/// The top level of an experiment file.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct TopLevel {
    pub kind: Kind,
    pub name: Option<String>,
    pub title: Option<String>,
    pub description: Option<String>,
    pub scenario: Option<String>,
    // Read piece by piece, each with its own path.
    #[serde(rename = "task")]
    pub _task: Option<IgnoredAny>,
    #[serde(rename = "seeds")]
    pub _seeds: Option<IgnoredAny>,
    #[serde(rename = "cases")]
    pub _cases: Option<IgnoredAny>,
    #[serde(rename = "parameters")]
    pub _parameters: Option<IgnoredAny>,
    #[serde(rename = "grid")]
    pub _grid: Option<IgnoredAny>,
    #[serde(rename = "run")]
    pub _run: Option<IgnoredAny>,
    #[serde(rename = "figures")]
    pub _figures: Option<IgnoredAny>,
}

/// `[[cases]]`: one method that is compared with the others.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CaseSpec {
    pub name: String,
    #[serde(default)]
    pub title: Option<String>,
    #[serde(default, rename = "scenario")]
    pub _scenario: Option<String>,
    #[serde(default, rename = "set")]
    pub _set: Option<IgnoredAny>,
}

/// `[parameters.NAME]`: a column of the results and what it changes.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ParameterSpec {
    pub title: Option<String>,
    #[serde(rename = "set")]
    pub _set: Option<IgnoredAny>,
    #[serde(rename = "scale")]
    pub _scale: Option<IgnoredAny>,
    #[serde(rename = "levels")]
    pub _levels: Option<IgnoredAny>,
}

/// `seeds = { first = 1, count = 200 }`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SeedsSpec {
    #[serde(default = "one")]
    pub first: u64,
    pub count: u64,
}

fn one() -> u64 {
    1
}

/// `[run]`: how the missions are carried out; none of it changes what they result in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RunSpec {
    /// Real time after which a mission is given up and counts as failed (s), 1 to 10⁶.
    pub timeout_s: f64,
}

impl Default for RunSpec {
    fn default() -> Self {
        Self { timeout_s: 3600.0 }
    }
}

/// Which missions keep their log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LogPolicy {
    /// None, and none is written: the fastest.
    #[default]
    None,
    /// Those that failed. All are written, and removed when the mission went well.
    Failed,
    /// All of them.
    All,
}

/// `[[figures]]`: a figure to be drawn from the results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FigureSpec {
    /// Name of its files.
    pub name: String,
    /// Its heading.
    #[serde(default)]
    pub title: String,
    /// Parameter along the horizontal axis.
    pub x: String,
    /// What stands on the vertical axis.
    #[serde(default)]
    pub metric: Metric,
    /// CSV file with the columns `series`, `x`, `y` and optionally `low`, `high`: published points to
    /// be shown beside ours. A path beside the experiment file.
    #[serde(default)]
    pub compare: Option<String>,
}
