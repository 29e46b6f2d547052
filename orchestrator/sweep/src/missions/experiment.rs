//! Experiments of missions of robots.

use std::collections::BTreeMap;

use scenario::ResolvedScenario;

use super::build::fingerprint;
use super::mission::Mission;
use crate::cell::Cell;
use crate::experiment::ExperimentOf;

/// An experiment of missions of robots.
pub type Experiment = ExperimentOf<Mission>;

impl Experiment {
    /// Changes the processes of the scenario of every cell.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn change_processes<E>(
        &mut self,
        change: impl Fn(&mut ResolvedScenario) -> Result<(), E>,
    ) -> Result<(), E> {
        for cell in &mut self.cells {
            cell.subject.template.change(&change)?;
            let scenario = cell.subject.template.scenario();
            cell.external = scenario.uses_external_commands();
            cell.blake3 = fingerprint(scenario.clone());
        }
        Ok(())
    }

    /// Returns notes on unusual but valid content: equal cells.
    pub fn notes(&self) -> Vec<String> {
        let mut first: BTreeMap<&str, &Cell<Mission>> = BTreeMap::new();
        let mut notes = Vec::new();
        for cell in &self.cells {
            let Some(earlier) = first.get(cell.blake3.as_str()) else {
                first.insert(&cell.blake3, cell);
                continue;
            };
            let values = |c: &Cell<Mission>| {
                let values = c.values.iter().map(ToString::to_string);
                std::iter::once(c.case.clone())
                    .chain(values)
                    .collect::<Vec<_>>()
                    .join(", ")
            };
            notes.push(format!(
                "the cells ({}) and ({}) have the same scenario, and therefore the same results",
                values(earlier),
                values(cell),
            ));
        }
        notes
    }
}
