//! Task of a mission of plans: the problem that is generated from its seed, and the options of its
//! planner.

use parameters::{Parameters, ParamsError, within};

use plan::{Options, Recipe};

parameters::table! {
    /// Task of a mission: one random problem, planned once.
    pub struct Task {
        /// Random problems.
        pub instances: Recipe,
        /// Options of the optimiser.
        pub options: Options,
    }
}

/// Fault of a key of a task.
#[derive(Debug, thiserror::Error)]
pub enum DraftError {
    /// Form of a setting.
    #[error("expected {0}")]
    Form(&'static str),
    /// A key before a dot.
    #[error("`{0}` is not a table")]
    NoTable(String),
    /// Text, key or type of a value.
    #[error("{}", .0.message().trim())]
    Toml(#[from] toml::de::Error),
}

/// A task during the setting of its keys.
#[derive(Debug, Clone, Default)]
pub struct Draft(toml::Table);

impl Draft {
    /// Applies `key.key=value`.
    ///
    /// # Errors
    /// [`DraftError`] if it has another form.
    pub fn apply(&mut self, argument: &str) -> Result<(), DraftError> {
        let (path, value) = argument
            .split_once('=')
            .ok_or(DraftError::Form("KEY=VALUE"))?;
        let document: toml::Table = toml::from_str(&format!("value = {value}"))?;
        let value = document
            .get("value")
            .cloned()
            .ok_or(DraftError::Form("a value"))?;
        let mut keys: Vec<&str> = path.split('.').map(str::trim).collect();
        let last = keys.pop().unwrap_or_default();
        let mut table = &mut self.0;
        for key in keys {
            let below = table
                .entry(key)
                .or_insert_with(|| toml::Value::Table(toml::Table::new()));
            table = below
                .as_table_mut()
                .ok_or_else(|| DraftError::NoTable(key.to_owned()))?;
        }
        table.insert(last.to_owned(), value);
        Ok(())
    }

    /// Returns the task, with keys and types checked.
    ///
    /// # Errors
    /// [`DraftError::Toml`]: key, value and expected value.
    pub fn task(&self) -> Result<Task, DraftError> {
        Ok(self.0.clone().try_into()?)
    }
}

impl Parameters for Task {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let instances = self.instances.check_relations();
        instances.map_err(within("instances"))?;
        self.options.check_relations().map_err(within("options"))
    }
}
