//! Task of a mission of plans: the problem that is generated from its seed, and the options of its
//! planner.

use parameters::{Parameters, ParamsError, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use plan::{Options, Recipe};

/// Task of a mission: one random problem, planned once.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Task {
    /// Random problems.
    pub instances: Recipe,
    /// Options of the optimiser.
    pub options: Options,
}

/// A task during the setting of its keys.
#[derive(Debug, Clone, Default)]
pub(crate) struct Draft(toml::Table);

impl Draft {
    /// Applies `key.key=value`.
    ///
    /// # Errors
    /// The reason, as text.
    pub fn apply(&mut self, argument: &str) -> Result<(), String> {
        let (path, value) = argument
            .split_once('=')
            .ok_or_else(|| "expected KEY=VALUE".to_owned())?;
        let document: toml::Table =
            toml::from_str(&format!("value = {value}")).map_err(|e| e.message().to_owned())?;
        let value = document
            .get("value")
            .cloned()
            .ok_or_else(|| "expected a value".to_owned())?;
        let mut keys: Vec<&str> = path.split('.').map(str::trim).collect();
        let last = keys.pop().unwrap_or_default();
        let mut table = &mut self.0;
        for key in keys {
            let below = table
                .entry(key)
                .or_insert_with(|| toml::Value::Table(toml::Table::new()));
            table = below
                .as_table_mut()
                .ok_or_else(|| format!("`{key}` is not a table"))?;
        }
        table.insert(last.to_owned(), value);
        Ok(())
    }

    /// Returns the task, with keys and types checked.
    ///
    /// # Errors
    /// The problem: key, value and expected value.
    pub fn task(&self) -> Result<Task, String> {
        let task: Result<Task, toml::de::Error> = self.0.clone().try_into();
        task.map_err(|e| e.message().trim().to_owned())
    }
}

impl Parameters for Task {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let instances = self.instances.check_relations();
        instances.map_err(within("instances"))?;
        self.options.check_relations().map_err(within("options"))
    }
}
