//! The manifest of a directory of results: experiment and program.

use serde::{Deserialize, Serialize};

use super::cell::{Value, describe};
use super::kind::Kind;
use super::mission_id::MissionId;
use super::seeds::Seeds;

/// Version of the files in a directory of results; other versions are refused.
pub const FORMAT: u32 = 3;

/// Experiment and program of a directory of results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of the files.
    pub format: u32,
    /// Version of the program.
    pub program: String,
    /// Kind of its missions.
    #[serde(default, skip_serializing_if = "Kind::is_default")]
    pub kind: Kind,
    /// Name of the experiment.
    pub experiment: String,
    /// Its title.
    pub title: String,
    /// Hash of everything on which the results depend, without the seeds.
    pub blake3: String,
    /// The columns of its parameters.
    pub parameters: Vec<String>,
    /// Its cells, in the order of the results.
    pub cells: Vec<ManifestCell>,
    /// All seeds requested so far.
    pub seeds: Seeds,
}

/// A cell of a [`Manifest`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ManifestCell {
    /// Name of its case.
    pub case: String,
    /// Values of the parameters.
    pub values: Vec<Value>,
    /// Hash of its scenario without the seed.
    pub blake3: String,
    /// The scenario, as `protean run` takes it.
    pub scenario: String,
    /// The overrides, as `--set` takes them.
    pub set: Vec<String>,
    /// `true` if it starts external programs.
    pub external: bool,
}

impl Manifest {
    /// Returns the hash of format, program, name, columns and cells.
    pub(super) fn fingerprint(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        let mut add = |text: &str| {
            // The length before every part keeps different parts from having the same hash.
            hasher.update(&(text.len() as u64).to_le_bytes());
            hasher.update(text.as_bytes());
        };
        add(&self.format.to_string());
        add(&self.program);
        if self.kind == Kind::Planning {
            add("planning");
        }
        add(&self.experiment);
        add(&self.parameters.len().to_string());
        self.parameters.iter().for_each(|name| add(name));
        for cell in &self.cells {
            add(&cell.case);
            cell.values.iter().for_each(|value| add(&value.to_string()));
            add(&cell.blake3);
        }
        hasher.finalize().to_hex().to_string()
    }

    /// Describes a cell.
    pub fn describe(&self, cell: usize) -> String {
        let names: Vec<&str> = self.parameters.iter().map(String::as_str).collect();
        match self.cells.get(cell) {
            Some(cell) => describe(&cell.case, &names, &cell.values),
            None => format!("cell {cell}"),
        }
    }

    /// Returns the name of the log of a mission: `1-potential-relative_speed=1.5-seed=7.mcap`.
    pub(super) fn log_name(&self, mission: MissionId) -> String {
        let label = self.describe(mission.cell);
        let label = label
            .trim_start_matches("case ")
            .replace(" = ", "=")
            .replace(", ", "-");
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() || "_-=.+".contains(c) {
                c
            } else {
                '_'
            }
        };
        let label: String = label.chars().take(180).map(plain).collect();
        // The index of the cell distinguishes long labels that were cut.
        format!("{}-{label}-seed={}.mcap", mission.cell, mission.seed)
    }

    /// Describes how the program of `theirs` differs from this one; `None` if it does not.
    pub fn other_program(&self, theirs: &Self) -> Option<String> {
        if self.format != theirs.format {
            return Some(format!(
                "its files have format {}, this program writes format {}",
                theirs.format, self.format
            ));
        }
        (self.program != theirs.program).then(|| {
            format!(
                "it was made by version {} of Protean, this is version {}",
                theirs.program, self.program
            )
        })
    }

    /// Describes why `theirs` is of another experiment; `None` if it is of the same.
    pub fn difference(&self, theirs: &Self) -> Option<String> {
        if self.blake3 == theirs.blake3 {
            return None;
        }
        let other = || "compare its experiment.toml and its scenarios with yours".to_owned();
        Some(self.other_program(theirs).unwrap_or_else(other))
    }
}
