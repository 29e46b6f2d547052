//! Studies from the results of sweeps.

use std::path::PathBuf;

use super::evidence::{Cell, Evidence, Method, Study};
use crate::sweep::{EvidenceError, Results, SweepError, empty_place, figures};

/// The parameter that the chase's experiments vary.
const RATIO: &str = "relative_speed";

/// Why results are of no use for the page.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The directory cannot be read.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// Not an experiment of the page, or one that it has.
    #[error(transparent)]
    Evidence(#[from] EvidenceError),
    /// Other parameters than the page knows.
    #[error(
        "{}: the experiment varies {found:?}; expected `relative_speed` alone, a number",
        path.display()
    )]
    Parameters {
        /// The directory.
        path: PathBuf,
        /// Its parameters.
        found: Vec<String>,
    },
}

impl Evidence {
    /// Adds the results of one of the page's experiments.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn add(&mut self, results: &Results) -> Result<(), StudyError> {
        let places = [
            ("escape_vs_speed", &mut self.speed),
            ("escape_vs_speed_paper", &mut self.speed_paper),
            ("knowledge", &mut self.knowledge),
            ("knowledge_paper", &mut self.knowledge_paper),
        ];
        let name = &results.manifest().experiment;
        let place = empty_place(places, results.directory(), name)?;
        *place = Some(Study::of(results)?);
        Ok(())
    }
}

impl Study {
    /// The study of an experiment that varies the speed and nothing else.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn of(results: &Results) -> Result<Self, StudyError> {
        let manifest = results.manifest();
        let refused = || StudyError::Parameters {
            path: results.directory().to_owned(),
            found: manifest.parameters.clone(),
        };
        if manifest.parameters != [RATIO] {
            return Err(refused());
        }
        let mut cells = Vec::new();
        for cell in &manifest.cells {
            let ratio = cell.values.first().and_then(crate::sweep::Value::number);
            cells.push(Cell {
                method: cell.case.clone(),
                ratio: ratio.ok_or_else(refused)?,
                ..Cell::default()
            });
        }
        for (mission, row) in results.rows() {
            let Some(cell) = cells.get_mut(mission.cell) else {
                continue;
            };
            if row.is_failed() {
                cell.failed += 1;
                continue;
            }
            cell.escapes.add(row.escaped, row.evaders);
            cell.caught += u64::from(row.caught);
            cell.held_out += u64::from(row.held_out);
        }
        let titles = figures::case_titles(results)?.into_iter();
        Ok(Self {
            name: manifest.experiment.clone(),
            program: manifest.program.clone(),
            seeds: manifest.seeds.to_string(),
            methods: titles.map(|(name, title)| Method { name, title }).collect(),
            cells,
        })
    }
}
