//! A directory of results.
//!
//! | file | holds |
//! |---|---|
//! | `manifest.json` | which experiment and program it belongs to |
//! | `experiment.toml` | the experiment file |
//! | `journal.jsonl` | every mission that is over, as they came |
//! | `results.csv`, `results.parquet` | the same as a table, in the order of the experiment |
//! | `logs/` | logs that were kept |

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use tables::Format;

use super::directory::{
    Lock, MANIFEST, lock, read_manifest, replace, replace_with, write_manifest,
};
use super::error::SweepError;
use super::journal::{self, Entry, Journal};
use super::manifest::Manifest;
use super::mission_id::{MissionId, missions};
use super::row::{Record, Row};
use super::table;

/// Name of the copy of the experiment file.
const EXPERIMENT: &str = "experiment.toml";
/// Name of the table as text.
const TABLE: &str = "results.csv";
/// Name of the table with a type for every column.
const TYPED_TABLE: &str = "results.parquet";

/// A directory of results, locked while it is open.
pub struct Results<R = Row> {
    directory: PathBuf,
    manifest: Manifest,
    journal: Journal,
    rows: BTreeMap<MissionId, R>,
    /// CPU times of the missions that have one (ms).
    cpu_ms: BTreeMap<MissionId, f64>,
    /// What was found odd at opening.
    notes: Vec<String>,
    _lock: Lock,
}

impl<R: Record> Results<R> {
    /// Opens the results of an experiment in a directory, which is made if it is not there. Seeds
    /// that the directory has already are kept; those of `manifest` are added.
    ///
    /// # Errors
    /// [`SweepError`] if the directory cannot be used, is in use, or belongs to something else.
    pub fn open(
        directory: &Path,
        manifest: &Manifest,
        experiment: &str,
    ) -> Result<Self, SweepError> {
        std::fs::create_dir_all(directory)
            .map_err(SweepError::io(directory, "cannot make the directory"))?;
        let lock = lock(directory)?;
        let mut manifest = manifest.clone();
        match read_manifest(directory)? {
            Some(theirs) => {
                if let Some(difference) = manifest.difference(&theirs) {
                    return Err(SweepError::Other {
                        path: directory.to_owned(),
                        difference,
                    });
                }
                manifest.seeds = manifest.seeds.union(&theirs.seeds);
            }
            None if directory.join(journal::FILE).exists() || directory.join(TABLE).exists() => {
                return Err(SweepError::NotResults {
                    path: directory.to_owned(),
                    file: MANIFEST,
                    expected: "choose another --out, or an empty directory",
                });
            }
            None => {}
        }
        write_manifest(directory, &manifest)?;
        replace(&directory.join(EXPERIMENT), experiment.as_bytes())?;
        Self::with(directory, manifest, lock)
    }

    /// Opens results that are there, whatever experiment they are of.
    ///
    /// # Errors
    /// [`SweepError`] if the directory holds no results, or they are in use or damaged.
    pub fn read(directory: &Path) -> Result<Self, SweepError> {
        let no_results = || SweepError::NotResults {
            path: directory.to_owned(),
            file: MANIFEST,
            expected: "name the --out of a sweep",
        };
        if !directory.is_dir() {
            return Err(no_results());
        }
        let manifest = read_manifest(directory)?.ok_or_else(no_results)?;
        if manifest.kind != R::KIND {
            return Err(SweepError::Other {
                path: directory.to_owned(),
                difference: format!(
                    "its kind is {:?}, here results of the kind {:?} are wanted",
                    manifest.kind,
                    R::KIND
                ),
            });
        }
        let lock = lock(directory)?;
        Self::with(directory, manifest, lock)
    }

    fn with(directory: &Path, manifest: Manifest, lock: Lock) -> Result<Self, SweepError> {
        let opened = Journal::open::<R>(directory)?;
        let mut results = Self {
            directory: directory.to_owned(),
            manifest,
            journal: opened.journal,
            rows: BTreeMap::new(),
            cpu_ms: BTreeMap::new(),
            notes: Vec::new(),
            _lock: lock,
        };
        if opened.torn {
            results.notes.push(format!(
                "{}: the last line was torn and has been cut off; its mission runs again",
                directory.join(journal::FILE).display()
            ));
        }
        for (number, entry) in opened.entries.into_iter().enumerate() {
            if entry.cell >= results.manifest.cells.len() {
                return Err(SweepError::Damaged {
                    path: directory.join(journal::FILE),
                    line: number + 1,
                    what: format!("no cell {}", entry.cell),
                    found: entry.cell.to_string(),
                    expected: "the index of a cell of the manifest",
                });
            }
            let mission = MissionId {
                cell: entry.cell,
                seed: entry.seed,
            };
            if results.is_new(mission, &entry.row, directory)? {
                results.rows.insert(mission, entry.row);
                results.cpu_ms.extend(entry.cpu_ms.map(|ms| (mission, ms)));
            }
        }
        Ok(results)
    }

    /// Whether a row says something new: a failure gives way to a result, a result to nothing else.
    fn is_new(&self, mission: MissionId, row: &R, from: &Path) -> Result<bool, SweepError> {
        let Some(known) = self.rows.get(&mission) else {
            return Ok(true);
        };
        if known == row || row.is_failed() && !known.is_failed() {
            return Ok(false);
        }
        if known.is_failed() {
            return Ok(true);
        }
        Err(SweepError::Contradiction {
            path: from.to_owned(),
            mission: self.describe(mission),
            difference: difference(known, row),
        })
    }

    /// Keeps the row of a mission that is over.
    ///
    /// # Errors
    /// [`SweepError::Io`]: everything before is kept. [`SweepError::Contradiction`] if another
    /// result of the mission is known.
    pub fn record(&mut self, mission: MissionId, row: R, wall_s: f64) -> Result<(), SweepError> {
        self.record_timed(mission, row, wall_s, None)
    }

    /// The same for a mission with a CPU time (ms).
    ///
    /// # Errors
    /// As [`Self::record`].
    pub fn record_timed(
        &mut self,
        mission: MissionId,
        row: R,
        wall_s: f64,
        cpu_ms: Option<f64>,
    ) -> Result<(), SweepError> {
        if self.is_new(mission, &row, &self.directory)? {
            self.keep(mission, row, wall_s, cpu_ms)?;
        }
        Ok(())
    }

    /// Writes a row down, and only then counts on it.
    fn keep(
        &mut self,
        mission: MissionId,
        row: R,
        wall_s: f64,
        cpu_ms: Option<f64>,
    ) -> Result<(), SweepError> {
        let entry = Entry {
            cell: mission.cell,
            seed: mission.seed,
            wall_s,
            cpu_ms,
            row,
        };
        self.journal.append(&entry)?;
        self.rows.insert(mission, entry.row);
        self.cpu_ms.extend(cpu_ms.map(|ms| (mission, ms)));
        Ok(())
    }

    /// Adds everything that other results hold.
    ///
    /// # Errors
    /// [`SweepError::Contradiction`], or [`SweepError::Io`].
    pub fn add(&mut self, other: &Self) -> Result<(), SweepError> {
        for (mission, row) in other.rows() {
            if self.is_new(mission, row, &other.directory)? {
                self.keep(mission, row.clone(), 0.0, other.cpu_ms(mission))?;
            }
        }
        self.journal.sync()
    }

    /// Takes over what other results hold of the same missions: those of cells whose scenario is
    /// the same to the last value, by this version of the program. Failed missions and scenarios
    /// with programs of the user's own, which may have changed, are left. Returns how many missions
    /// are new.
    ///
    /// # Errors
    /// [`SweepError::Other`] if the other results are of another version,
    /// [`SweepError::Contradiction`], or [`SweepError::Io`].
    pub fn reuse(&mut self, other: &Self) -> Result<usize, SweepError> {
        if let Some(difference) = self.manifest.other_program(&other.manifest) {
            return Err(SweepError::Other {
                path: other.directory.clone(),
                difference,
            });
        }
        let mut taken = 0;
        for (cell, wanted) in self.manifest.cells.clone().iter().enumerate() {
            let same = |theirs: &MissionId| {
                let of = other.manifest.cells.get(theirs.cell);
                of.is_some_and(|of| of.blake3 == wanted.blake3 && !of.external)
            };
            for (theirs, row) in other.rows().filter(|(theirs, _)| same(theirs)) {
                let mission = MissionId {
                    cell,
                    seed: theirs.seed,
                };
                let wanted = self.manifest.seeds.iter().any(|seed| seed == theirs.seed);
                if wanted && !row.is_failed() && self.is_new(mission, row, &other.directory)? {
                    self.keep(mission, row.clone(), 0.0, other.cpu_ms(theirs))?;
                    taken += 1;
                }
            }
        }
        self.journal.sync()?;
        Ok(taken)
    }

    /// The same results with the seeds of another part of the experiment.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub(super) fn widened(mut self, other: &Manifest) -> Result<Self, SweepError> {
        let seeds = self.manifest.seeds.union(&other.seeds);
        if seeds != self.manifest.seeds {
            self.manifest.seeds = seeds;
            write_manifest(&self.directory, &self.manifest)?;
        }
        Ok(self)
    }

    /// The row of a mission, if it is over.
    pub fn row(&self, mission: MissionId) -> Option<&R> {
        self.rows.get(&mission)
    }

    /// CPU time of a mission (ms), if it has one.
    pub fn cpu_ms(&self, mission: MissionId) -> Option<f64> {
        self.cpu_ms.get(&mission).copied()
    }

    /// All rows in the order of the results.
    pub fn rows(&self) -> impl Iterator<Item = (MissionId, &R)> {
        self.rows.iter().map(|(&mission, row)| (mission, row))
    }

    /// Missions of the experiment that are not over.
    pub fn missing(&self) -> Vec<MissionId> {
        missions(self.manifest.cells.len(), &self.manifest.seeds)
            .filter(|mission| !self.rows.contains_key(mission))
            .collect()
    }

    /// Where they are.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// What they belong to.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// What was odd when they were opened.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// A mission in words.
    pub fn describe(&self, mission: MissionId) -> String {
        format!(
            "{}, seed {}",
            self.manifest.describe(mission.cell),
            mission.seed
        )
    }

    /// The experiment file.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub fn experiment(&self) -> Result<String, SweepError> {
        let path = self.directory.join(EXPERIMENT);
        std::fs::read_to_string(&path).map_err(SweepError::io(&path, "cannot read the experiment"))
    }

    /// Writes the table, as text and as Parquet, each of which replaces an earlier one as a whole or
    /// not at all.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub fn write_tables(&self) -> Result<(), SweepError> {
        self.journal.sync()?;
        for (name, format) in [(TABLE, Format::Csv), (TYPED_TABLE, Format::Parquet)] {
            replace_with(&self.directory.join(name), |file| {
                table::write(format, file, &self.manifest, self.rows())
            })?;
        }
        Ok(())
    }
}

/// The first field in which two rows differ.
fn difference<R: Record>(known: &R, new: &R) -> String {
    let fields = |row: &R| serde_json::to_value(row).unwrap_or_default();
    let (known, new) = (fields(known), fields(new));
    let names = known.as_object().into_iter().flat_map(|map| map.keys());
    names
        .filter(|&name| known.get(name) != new.get(name))
        .map(|name| {
            let value = |row: &serde_json::Value| {
                row.get(name).map_or_else(String::new, ToString::to_string)
            };
            format!("{name} {} and {}", value(&known), value(&new))
        })
        .next()
        .unwrap_or_default()
}
