//! Keys of an experiment file, except the overrides (`set`) and the values of the grid.

use std::collections::BTreeMap;

use parameters::{Parameters, ParamsError, at_least, between, require};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::kind::Kind;
use super::metrics::Metric;
pub use super::seeds::MAX_MISSIONS;
use super::seeds::{MAX_SEED, Seeds};
use super::task::Task;

/// Maximum length of a name (characters).
pub const MAX_NAME: usize = 64;
/// Maximum number of cells (combinations of case and parameters) of one experiment.
pub const MAX_CELLS: usize = 10_000;

/// An experiment: its missions, the varied parameters, and the seeds.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct TopLevel {
    /// Short name, 1 to 64 of a–z, A–Z, 0–9, `_`, `-`: of the directory of its results; the file's
    /// name if absent.
    #[schemars(length(min = 1, max = MAX_NAME))]
    pub name: Option<String>,
    /// Kind of its missions.
    pub kind: Kind,
    /// Title, one line; the name if absent.
    pub title: Option<String>,
    /// Description, some lines.
    pub description: Option<String>,
    /// Scenario of the cases that do not name one: `"builtin:NAME"`, or a path in the folder of the
    /// file or below. Not with `kind = "planning"`.
    pub scenario: Option<String>,
    // Read piece by piece, each with its own path.
    /// Task of all cells, with `kind = "planning"` only.
    #[serde(rename = "task")]
    #[schemars(with = "Option<Task>")]
    pub _task: Option<IgnoredAny>,
    /// Seeds, the same in every cell. Required, unless `--seeds` gives them.
    #[serde(rename = "seeds")]
    #[schemars(with = "Option<SeedsSpec>")]
    pub _seeds: Option<IgnoredAny>,
    /// Methods that are compared; one, named by the scenario, if absent.
    #[serde(rename = "cases")]
    #[schemars(with = "Option<Vec<CaseSpec>>")]
    pub _cases: Option<IgnoredAny>,
    /// Parameters that are varied, by the name of their column in the results.
    #[serde(rename = "parameters")]
    #[schemars(with = "Option<BTreeMap<String, ParameterSpec>>")]
    pub _parameters: Option<IgnoredAny>,
    /// List of values for each parameter; all their combinations are run. Required if there are
    /// parameters.
    #[serde(rename = "grid")]
    #[schemars(with = "Option<BTreeMap<String, Vec<Value>>>")]
    pub _grid: Option<IgnoredAny>,
    /// Options of the execution of missions, without effect on results.
    #[serde(rename = "run")]
    #[schemars(with = "Option<RunSpec>")]
    pub _run: Option<IgnoredAny>,
    /// Figures that are drawn from the results.
    #[serde(rename = "figures")]
    #[schemars(with = "Option<Vec<FigureSpec>>")]
    pub _figures: Option<IgnoredAny>,
}

/// One method that is compared with the others.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CaseSpec {
    /// Name in the column `case`; characters as for the experiment's.
    pub name: String,
    /// Title; `name` if absent.
    #[serde(default)]
    pub title: Option<String>,
    /// Scenario instead of the experiment's.
    #[serde(default, rename = "scenario")]
    pub _scenario: Option<String>,
    /// Overrides of the scenario, or of the task.
    #[serde(default, rename = "set")]
    #[schemars(with = "Option<Map<String, Value>>")]
    pub _set: Option<IgnoredAny>,
}

/// One parameter: a column of the results, and the effect of its values.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ParameterSpec {
    /// Title, with the unit; the name of the column if absent.
    pub title: Option<String>,
    /// Key of the scenario that is set to the value. This or `levels`.
    #[serde(rename = "set")]
    #[schemars(with = "Option<String>")]
    pub _set: Option<IgnoredAny>,
    /// Factor of the value: a number, or a key of the scenario that contains one after the case's
    /// overrides; 1 if absent.
    #[serde(rename = "scale")]
    #[schemars(schema_with = "number_or_text")]
    pub _scale: Option<IgnoredAny>,
    /// Table of overrides for each value; the values are the names of these tables.
    #[serde(rename = "levels")]
    #[schemars(with = "Option<BTreeMap<String, Map<String, Value>>>")]
    pub _levels: Option<IgnoredAny>,
}

fn number_or_text(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": ["number", "string"] })
}

/// Range of seeds.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SeedsSpec {
    /// First seed.
    #[serde(default = "one")]
    #[schemars(transform = at_least(0).at_most(MAX_SEED))]
    pub first: u64,
    /// Number of seeds.
    #[schemars(transform = at_least(0).at_most(MAX_MISSIONS))]
    pub count: u64,
}

fn one() -> u64 {
    1
}

impl Parameters for SeedsSpec {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let is_known = Seeds::range(self.first, self.count).is_some();
        require(is_known, "count", &self.count, "seeds below 2^63")
    }
}

parameters::table! {
    /// Options of the execution of missions, without effect on results.
    pub struct RunSpec {
        /// Wall-clock time after which a mission is aborted and counts as failed.
        pub timeout_s: f64 [between(1.0, 1e6).unit("s")] = 3600.0,
    }
}

impl Parameters for RunSpec {}

/// Missions whose logs are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LogPolicy {
    /// None; no log is written, which is fastest.
    #[default]
    None,
    /// Failed missions. All logs are written; those of other missions are removed.
    Failed,
    /// All missions.
    All,
}

impl LogPolicy {
    /// Returns `true` if a mission keeps its log.
    pub fn keeps(self, is_failed: bool) -> bool {
        self == Self::All || self == Self::Failed && is_failed
    }
}

/// A figure of the results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FigureSpec {
    /// Name of its files.
    pub name: String,
    /// Heading of the figure.
    #[serde(default)]
    pub title: String,
    /// Parameter along the horizontal axis.
    pub x: String,
    /// Quantity on the vertical axis.
    #[serde(default)]
    pub metric: Metric,
    /// Path, below the folder of the experiment file, of a CSV file with the columns `series`, `x`, `y`
    /// and optionally `low`, `high`: points to compare with. None if absent.
    #[serde(default)]
    pub compare: Option<String>,
}
