//! A directory of results.
//!
//! | file | content |
//! |---|---|
//! | `manifest.json` | experiment and program of the results |
//! | `experiment.toml` | the experiment file |
//! | `journal.jsonl` | every finished mission, in order of completion |
//! | `results.csv`, `results.parquet` | the same as a table, in the order of the experiment |
//! | `robots.csv`, `predictions.csv`, … | the robots and predictions of missions, in the same order |
//! | `logs/` | logs of missions, if they are kept |

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use platform::presence;
use tables::Format;

use super::directory::{
    Lock, MANIFEST, lock, read_manifest, replace, replace_with, write_manifest,
};
use super::error::SweepError;
use super::journal::{self, Entry, Journal, JournalContent};
use super::manifest::Manifest;
use super::mission_id::{MissionId, missions};
use super::row::{RESULTS, Record, Row};
use super::table;

/// Name of the copy of the experiment file.
const EXPERIMENT: &str = "experiment.toml";
/// Formats of the tables, and the extensions of their files.
const FORMATS: [(&str, Format); 2] = [("csv", Format::Csv), ("parquet", Format::Parquet)];

/// A directory of results, locked while it is open.
pub struct Results<R = Row> {
    directory: PathBuf,
    manifest: Manifest,
    journal: Journal,
    rows: BTreeMap<MissionId, R>,
    /// CPU times of the missions that have one (ms).
    cpu_ms: BTreeMap<MissionId, f64>,
    /// Notes from opening.
    notes: Vec<String>,
    _lock: Lock,
}

impl<R: Record> Results<R> {
    /// Opens the results of an experiment in a directory, and creates the directory if necessary.
    /// Seeds already in the directory are kept; those of `manifest` are added.
    ///
    /// # Errors
    /// [`SweepError`] if the directory cannot be used, is in use, or belongs to another experiment.
    pub fn open(
        directory: &Path,
        manifest: &Manifest,
        experiment: &str,
    ) -> Result<Self, SweepError> {
        // Before anything is written: a directory that is refused stays as it is.
        continued(directory, manifest)?;
        std::fs::create_dir_all(directory)
            .map_err(SweepError::io(directory, "cannot be created"))?;
        let lock = lock(directory)?;
        // Again: another sweep may have begun meanwhile.
        let manifest = continued(directory, manifest)?;
        write_manifest(directory, &manifest)?;
        replace(&directory.join(EXPERIMENT), experiment.as_bytes())?;
        Self::with(directory, manifest, lock, Journal::open(directory)?)
    }

    /// Opens existing results of any experiment.
    ///
    /// # Errors
    /// [`SweepError`] if the directory contains no results, or they are in use or damaged.
    pub fn read(directory: &Path) -> Result<Self, SweepError> {
        let no_results = || SweepError::NotResults {
            path: directory.to_owned(),
            file: MANIFEST,
            expected: "name the --out of a sweep",
        };
        let manifest = read_manifest(directory)?.ok_or_else(no_results)?;
        if manifest.kind != R::KIND {
            return Err(SweepError::Other {
                path: directory.to_owned(),
                difference: format!("its kind is {:?}: expected {:?}", manifest.kind, R::KIND),
            });
        }
        let lock = lock(directory)?;
        Self::with(directory, manifest, lock, Journal::read(directory)?)
    }

    /// Opens the results of an experiment in a directory; `None` if it has none.
    ///
    /// # Errors
    /// [`SweepError::Other`] if they belong to another experiment; others as for [`Self::read`].
    pub fn existing(directory: &Path, manifest: &Manifest) -> Result<Option<Self>, SweepError> {
        let results = match Self::read(directory) {
            Err(SweepError::NotResults { .. }) => return Ok(None),
            read => read?,
        };
        match manifest.difference(results.manifest()) {
            None => Ok(Some(results)),
            Some(difference) => Err(SweepError::Other {
                path: directory.to_owned(),
                difference,
            }),
        }
    }

    fn with(
        directory: &Path,
        manifest: Manifest,
        mut lock: Lock,
        opened: JournalContent<R>,
    ) -> Result<Self, SweepError> {
        let mut results = Self {
            directory: directory.to_owned(),
            manifest,
            journal: opened.journal,
            rows: BTreeMap::new(),
            cpu_ms: BTreeMap::new(),
            notes: lock.remark.take().into_iter().collect(),
            _lock: lock,
        };
        for line in opened.damaged {
            results.notes.push(format!(
                "{}:{line}: the line was incomplete or changed and has been removed; its mission runs again",
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

    /// Returns `true` if a row is new information: a result replaces a failure; nothing replaces a
    /// result.
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

    /// Records the row of a finished mission.
    ///
    /// # Errors
    /// [`SweepError::Io`]: earlier rows are kept. [`SweepError::Contradiction`] if the mission
    /// already has another result.
    pub fn record(&mut self, mission: MissionId, row: R, wall_s: f64) -> Result<(), SweepError> {
        self.record_timed(mission, row, wall_s, None)
    }

    /// Records the row of a mission with a CPU time (ms).
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

    /// Writes a row to the journal, then to memory.
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

    /// Adds all rows of other results.
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

    /// Copies rows of the same missions from other results: those of cells with an identical
    /// scenario, by the same version of the program. Failed missions, and scenarios with external
    /// programs, which may have changed, are not copied. Returns the number of new missions.
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

    /// Returns the same results with the seeds of another part of the experiment added.
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

    /// Returns the row of a mission, if it is finished.
    pub fn row(&self, mission: MissionId) -> Option<&R> {
        self.rows.get(&mission)
    }

    /// Returns the CPU time of a mission (ms), if it has one.
    pub fn cpu_ms(&self, mission: MissionId) -> Option<f64> {
        self.cpu_ms.get(&mission).copied()
    }

    /// Returns all rows in the order of the results.
    pub fn rows(&self) -> impl Iterator<Item = (MissionId, &R)> {
        self.rows.iter().map(|(&mission, row)| (mission, row))
    }

    /// Returns the missions of the experiment that are not finished.
    pub fn missing(&self) -> Vec<MissionId> {
        missions(self.manifest.cells.len(), &self.manifest.seeds)
            .filter(|mission| !self.rows.contains_key(mission))
            .collect()
    }

    /// Path of the directory.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Folder of the logs.
    pub(super) fn logs(&self) -> PathBuf {
        self.directory.join("logs")
    }

    /// Returns the path of the log of a mission, if it has been kept.
    pub(super) fn log(&self, mission: MissionId) -> Option<PathBuf> {
        let log = self.logs().join(self.manifest.log_name(mission));
        (!matches!(presence::entry(&log), Ok(None))).then_some(log)
    }

    /// The manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Notes from opening.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Describes a mission.
    pub fn describe(&self, mission: MissionId) -> String {
        format!(
            "{}, seed {}",
            self.manifest.describe(mission.cell),
            mission.seed
        )
    }

    /// Reads the experiment file.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub fn experiment(&self) -> Result<String, SweepError> {
        let path = self.directory.join(EXPERIMENT);
        std::fs::read_to_string(&path).map_err(SweepError::io(&path, "cannot be read"))
    }

    /// Writes the tables, as text and as Parquet; each file is replaced atomically.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub fn write_tables(&self) -> Result<(), SweepError> {
        self.journal.sync()?;
        for table in R::TABLES {
            for (extension, format) in FORMATS {
                let path = self.directory.join(format!("{}.{extension}", table.name));
                replace_with(&path, |file| {
                    table::write(table, format, file, &self.manifest, self.rows())
                })?;
            }
        }
        Ok(())
    }
}

/// Returns the manifest of an experiment with the seeds whose results a directory already contains.
///
/// # Errors
/// [`SweepError`] if the directory contains anything but results of this experiment.
fn continued(directory: &Path, manifest: &Manifest) -> Result<Manifest, SweepError> {
    let mut manifest = manifest.clone();
    let Some(theirs) = read_manifest(directory)? else {
        for file in [journal::FILE, &format!("{RESULTS}.csv"), EXPERIMENT] {
            let path = directory.join(file);
            let found = presence::entry(&path);
            if found
                .map_err(SweepError::io(path, "cannot be read"))?
                .is_some()
            {
                return Err(SweepError::NotResults {
                    path: directory.to_owned(),
                    file: MANIFEST,
                    expected: "choose another --out, or an empty directory",
                });
            }
        }
        return Ok(manifest);
    };
    if let Some(difference) = manifest.difference(&theirs) {
        return Err(SweepError::Other {
            path: directory.to_owned(),
            difference,
        });
    }
    manifest.seeds = manifest.seeds.union(&theirs.seeds);
    Ok(manifest)
}

/// Describes the first field in which two rows differ.
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
