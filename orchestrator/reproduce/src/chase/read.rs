//! Studies from the results of sweeps.

use std::path::PathBuf;

use serde::Deserialize;
use sweep::{Results, SweepError, Value};

use super::evidence::{Cell, Evidence, Method, Study};
use crate::place::{PlaceError, empty_place};

/// The parameter of the chase's experiments.
const RATIO: &str = "relative_speed";

/// Failure to use results for the page.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The directory cannot be read.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// Not an experiment of the page, or a duplicate.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// The experiment file beside the results cannot be read.
    #[error("{}: the experiment's cases cannot be read: {source}", path.display())]
    Cases {
        /// The directory.
        path: PathBuf,
        /// Error of the parser.
        source: toml::de::Error,
    },
    /// The parameters are not those of the page.
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
            ("escape_vs_speed_rrt_star", &mut self.speed_rrt_star),
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
    /// Returns the study of an experiment whose only parameter is the speed.
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
            let ratio = cell.values.first().and_then(Value::number);
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
            cell.games.insert(mission.seed, (row.escaped, row.evaders));
            cell.caught += u64::from(row.caught);
            cell.held_out += u64::from(row.held_out);
        }
        let titles = titles(results)?;
        Ok(Self {
            name: manifest.experiment.clone(),
            program: manifest.program.clone(),
            seeds: manifest.seeds.to_string(),
            methods: titles,
            cells,
        })
    }
}

/// Returns the cases of an experiment with their titles.
fn titles(results: &Results) -> Result<Vec<Method>, StudyError> {
    #[derive(Deserialize)]
    struct Experiment {
        #[serde(default)]
        cases: Vec<Case>,
    }
    #[derive(Deserialize)]
    struct Case {
        name: String,
        title: Option<String>,
    }
    let text = results.experiment()?;
    let experiment: Experiment = toml::from_str(&text).map_err(|source| StudyError::Cases {
        path: results.directory().to_owned(),
        source,
    })?;
    let cases = experiment.cases.into_iter();
    Ok(cases
        .map(|Case { name, title }| Method {
            title: title.unwrap_or_else(|| name.replace('_', " ")),
            name,
        })
        .collect())
}
