//! Single plans of the planners in a static world.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sweep::Seeds;

/// One plan: a row of `plans.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Planner: the name of a case.
    pub case: String,
    /// Positions of the Police: `start`, as at the start of a game, or `random`.
    pub scene: String,
    /// Seed of the plan, and of the scene if it is random.
    pub seed: u64,
    /// Number of iterations.
    pub iterations: u32,
    /// `true` if a path to the exit was found.
    pub found: bool,
    /// Length of the path (m).
    pub length_m: Option<f64>,
    /// Smallest distance of the path from any pursuer (m).
    pub closest_m: Option<f64>,
    /// Length of the shortest path (m).
    pub shortest_m: Option<f64>,
    /// Smallest distance of the shortest path from any pursuer (m).
    pub shortest_closest_m: Option<f64>,
}

/// Single plans, in the order of their file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plans(pub Vec<Plan>);

/// Failure to read plans.
#[derive(Debug, thiserror::Error)]
pub enum PlansError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a table of plans.
    #[error("{}: {reason}; expected a table of plans", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Line and problem.
        reason: String,
    },
}

impl Plans {
    /// Reads `plans.csv`.
    ///
    /// # Errors
    /// [`PlansError`].
    pub fn read(path: &Path) -> Result<Self, PlansError> {
        let bytes = std::fs::read(path).map_err(|source| PlansError::Open {
            path: path.to_owned(),
            source,
        })?;
        let rows: Result<Vec<Plan>, csv::Error> = csv::Reader::from_reader(bytes.as_slice())
            .deserialize()
            .collect();
        rows.map(Self).map_err(|error| PlansError::Format {
            path: path.to_owned(),
            reason: error.to_string(),
        })
    }

    /// Reads `plans.csv` if there is one.
    ///
    /// # Errors
    /// [`PlansError`].
    pub fn read_if_any(path: &Path) -> Result<Self, PlansError> {
        match Self::read(path) {
            Err(PlansError::Open { source, .. })
                if source.kind() == std::io::ErrorKind::NotFound =>
            {
                Ok(Self::default())
            }
            plans => plans,
        }
    }

    /// Returns the seeds, ascending.
    pub fn seeds(&self) -> Seeds {
        Seeds::of(self.0.iter().map(|plan| plan.seed).collect())
    }

    /// Adds the plans of a seed, in the order of the seeds.
    pub fn add(&mut self, plans: Vec<Plan>) {
        self.0.extend(plans);
        self.0.sort_by_key(|plan| plan.seed);
    }

    /// Returns the table as CSV.
    ///
    /// # Errors
    /// The error of the writer.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut csv = csv::Writer::from_writer(Vec::new());
        for plan in &self.0 {
            csv.serialize(plan)?;
        }
        csv.into_inner().map_err(|error| error.into_error().into())
    }

    /// Returns the plans of a case in one kind of scene.
    pub fn of<'a>(&'a self, case: &'a str, scene: &'a str) -> impl Iterator<Item = &'a Plan> {
        self.0
            .iter()
            .filter(move |p| p.case == case && p.scene == scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_plans_are_read_back() {
        let found = Plan {
            case: "rrt_star_line".to_owned(),
            scene: "start".to_owned(),
            seed: 1,
            iterations: 5000,
            found: true,
            length_m: Some(17.25),
            closest_m: Some(1.5),
            shortest_m: Some(17.14),
            shortest_closest_m: Some(0.1),
        };
        let lost = Plan {
            seed: 2,
            found: false,
            length_m: None,
            closest_m: None,
            ..found.clone()
        };
        let plans = Plans(vec![found, lost]);
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), plans.to_csv().unwrap()).unwrap();
        assert_eq!(Plans::read(file.path()).unwrap(), plans);
    }

    #[test]
    fn another_table_is_refused_with_its_line() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "case,seed\na,1\n").unwrap();
        let error = Plans::read(file.path()).unwrap_err().to_string();
        assert!(error.contains("expected a table"), "{error}");
        let missing = Plans::read(Path::new("no/such.csv")).unwrap_err();
        assert!(matches!(missing, PlansError::Open { .. }), "{missing}");
    }
}
