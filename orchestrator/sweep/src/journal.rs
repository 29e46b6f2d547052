//! The journal of a sweep: one line of JSON for every finished mission, in order of completion.
//!
//! A line is appended by a single write, so that a killed sweep leaves complete lines and at most
//! one torn last line. Opening the journal cuts it off, and its mission runs again.

use std::fs::{File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::error::SweepError;
use super::row::Row;

/// Name of the file.
pub(super) const FILE: &str = "journal.jsonl";

/// A line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Entry<R = Row> {
    /// Index of the cell.
    pub cell: usize,
    /// Seed.
    pub seed: u64,
    /// Real time of the mission (s).
    pub wall_s: f64,
    /// CPU time that experiments of plans compare (ms).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_ms: Option<f64>,
    /// Result.
    pub row: R,
}

/// Writer that appends to the journal.
pub(super) struct Journal {
    file: File,
    path: PathBuf,
}

/// Content of a journal at opening.
pub(super) struct Opened<R = Row> {
    pub journal: Journal,
    pub entries: Vec<Entry<R>>,
    /// `true` if the last line was torn, and has been cut off.
    pub torn: bool,
}

impl Journal {
    /// Opens the journal of a directory, creates it if necessary, and reads it.
    ///
    /// # Errors
    /// It cannot be read or written, or a line before the last is damaged.
    pub fn open<R: DeserializeOwned>(directory: &Path) -> Result<Opened<R>, SweepError> {
        let path = directory.join(FILE);
        let mut file = OpenOptions::new()
            .create(true)
            .read(true)
            .append(true)
            .open(&path)
            .map_err(SweepError::io(&path, "cannot open the journal"))?;
        let is_file = file
            .metadata()
            .map_err(SweepError::io(&path, "cannot open the journal"))?
            .is_file();
        if !is_file {
            let source = io::Error::from(io::ErrorKind::InvalidInput);
            return Err(SweepError::io(&path, "the journal is not a regular file")(
                source,
            ));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)
            .map_err(SweepError::io(&path, "cannot read the journal"))?;
        let (entries, whole) = parse(&path, &bytes)?;
        let torn = whole < bytes.len();
        if torn {
            file.set_len(whole as u64).map_err(SweepError::io(
                &path,
                "cannot remove the incomplete last line",
            ))?;
        }
        Ok(Opened {
            journal: Self { file, path },
            entries,
            torn,
        })
    }

    /// Appends a line. After an error the journal cannot be used until it is opened again.
    ///
    /// # Errors
    /// [`SweepError::Io`]; earlier lines are kept.
    pub fn append<R: Serialize>(&mut self, entry: &Entry<R>) -> Result<(), SweepError> {
        let written = serde_json::to_vec(entry)
            .map_err(io::Error::from)
            .and_then(|mut line| {
                line.push(b'\n');
                self.file.write_all(&line)
            });
        written.map_err(SweepError::io(&self.path, "cannot write the journal"))
    }

    /// Waits until everything is on the disk.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub fn sync(&self) -> Result<(), SweepError> {
        let synced = self.file.sync_all();
        synced.map_err(SweepError::io(&self.path, "cannot write the journal"))
    }
}

/// Parses the entries; returns them and the length of the complete lines (bytes).
fn parse<R: DeserializeOwned>(
    path: &Path,
    bytes: &[u8],
) -> Result<(Vec<Entry<R>>, usize), SweepError> {
    let mut entries = Vec::new();
    let mut whole = 0;
    for (number, line) in bytes.split_inclusive(|&b| b == b'\n').enumerate() {
        let end = whole + line.len();
        let last = end == bytes.len();
        let read = line
            .strip_suffix(b"\n")
            .map(serde_json::from_slice::<Entry<R>>);
        match read {
            Some(Ok(entry)) => entries.push(entry),
            // The line was cut short, or the machine failed before all of it was on the disk.
            None => break,
            Some(Err(_)) if last => break,
            Some(Err(error)) => {
                let found =
                    String::from_utf8_lossy(line.get(..line.len().min(60)).unwrap_or_default());
                return Err(SweepError::Damaged {
                    path: path.to_owned(),
                    line: number + 1,
                    what: format!("not a line of a journal ({error})"),
                    found: format!("{:?}", found.trim_end()),
                    expected: "one JSON object per mission; remove the line to run its mission again",
                });
            }
        }
        whole = end;
    }
    Ok((entries, whole))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn entry(seed: u64) -> Entry {
        Entry {
            cell: 1,
            seed,
            wall_s: 0.25,
            cpu_ms: None,
            row: Row::failed(format!("because of {seed}\n\"é\"")),
        }
    }

    fn written(count: u64) -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let mut journal = Journal::open::<Row>(directory.path()).unwrap().journal;
        for seed in 0..count {
            journal.append(&entry(seed)).unwrap();
        }
        journal.sync().unwrap();
        std::fs::read(directory.path().join(FILE)).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn complete_lines_of_a_truncated_journal_are_read_and_continued(cut in 0_usize..600) {
            let bytes = written(3);
            let kept = &bytes[..bytes.len().saturating_sub(cut)];
            let lines = kept.split_inclusive(|&b| b == b'\n').filter(|line| line.ends_with(b"\n")).count();
            let directory = tempfile::tempdir().unwrap();
            std::fs::write(directory.path().join(FILE), kept).unwrap();
            let opened = Journal::open::<Row>(directory.path()).unwrap();
            prop_assert_eq!(opened.entries.len(), lines);
            prop_assert_eq!(opened.torn, !kept.is_empty() && !kept.ends_with(b"\n"));
            let mut journal = opened.journal;
            journal.append(&entry(9)).unwrap();
            drop(journal);
            let again = Journal::open::<Row>(directory.path()).unwrap();
            prop_assert!(!again.torn);
            prop_assert_eq!(again.entries.len(), lines + 1);
            prop_assert_eq!(again.entries.last().unwrap(), &entry(9));
        }
    }

    #[test]
    fn a_damaged_line_in_the_middle_is_named() {
        let directory = tempfile::tempdir().unwrap();
        let mut bytes = written(3);
        bytes[0] = b'#';
        std::fs::write(directory.path().join(FILE), &bytes).unwrap();
        let error = Journal::open::<Row>(directory.path())
            .err()
            .unwrap()
            .to_string();
        for word in ["journal.jsonl:1", "not a line", "remove the line"] {
            assert!(error.contains(word), "{error}");
        }
        // A damaged last line is accepted: the machine may have failed while it was written.
        let mut bytes = written(2);
        let start = bytes.iter().position(|&b| b == b'\n').unwrap() + 1;
        bytes[start..start + 4].fill(0);
        std::fs::write(directory.path().join(FILE), &bytes).unwrap();
        let opened = Journal::open::<Row>(directory.path()).unwrap();
        assert!(opened.torn);
        assert_eq!(opened.entries, [entry(0)]);
    }
}
