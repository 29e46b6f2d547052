//! The journal of a sweep: one line of JSON for every finished mission, in order of completion.
//!
//! A line is appended by a single write, so that a killed sweep leaves complete lines and at most
//! one torn last line. A line begins with a checksum. Opening the journal removes lines that are incomplete or
//! changed, and their missions run again.

use std::fs::{File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use platform::own_file;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::directory::replace;
use super::error::SweepError;
use super::row::Row;

/// Name of the file.
pub const FILE: &str = "journal.jsonl";

/// First key of a line, up to its value.
const CHECK: &str = "\"check\":\"";
/// Number of hexadecimal digits of a checksum (BLAKE3).
const CHECK_DIGITS: usize = 16;

/// A line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry<R = Row> {
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
pub struct Journal {
    file: File,
    path: PathBuf,
}

/// Content of a journal at opening.
pub struct JournalContent<R = Row> {
    pub journal: Journal,
    pub entries: Vec<Entry<R>>,
    /// Numbers of the lines that were incomplete or changed, and have been removed.
    pub damaged: Vec<usize>,
    /// `true` if the last of them has no end.
    pub is_torn: bool,
}

impl Journal {
    /// Opens the journal of a directory to continue it: creates it if necessary, reads it, and removes damaged lines.
    ///
    /// # Errors
    /// It cannot be read or written.
    pub fn open<R: DeserializeOwned>(directory: &Path) -> Result<JournalContent<R>, SweepError> {
        let (mut opened, kept) = load(directory)?;
        if !opened.damaged.is_empty() {
            let path = &opened.journal.path;
            replace(path, &kept)?;
            opened.journal.file = open_file(path)?;
        }
        Ok(opened)
    }

    /// Opens the journal of a directory to read it. A last line that a killed sweep left incomplete is ignored.
    ///
    /// # Errors
    /// It cannot be read, or a line was changed.
    pub fn read<R: DeserializeOwned>(directory: &Path) -> Result<JournalContent<R>, SweepError> {
        let (mut opened, _) = load(directory)?;
        if opened.is_torn {
            opened.damaged.pop();
        }
        match opened.damaged.first() {
            None => Ok(opened),
            Some(&line) => Err(SweepError::Damaged {
                path: opened.journal.path,
                line,
                what: "the line was changed".to_owned(),
                found: "another checksum".to_owned(),
                expected: "the line as written; the sweep itself removes it and runs its mission again",
            }),
        }
    }

    /// Appends a line. After an error the journal cannot be used until it is opened again.
    ///
    /// # Errors
    /// [`SweepError::Io`]; earlier lines are kept.
    pub fn append<R: Serialize>(&mut self, entry: &Entry<R>) -> Result<(), SweepError> {
        let written = serde_json::to_vec(entry)
            .map_err(io::Error::from)
            .and_then(|json| self.file.write_all(&checked(&json)));
        written.map_err(SweepError::io(&self.path, "cannot be written"))
    }

    /// Waits until everything is on the disk.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub fn sync(&self) -> Result<(), SweepError> {
        let synced = self.file.sync_all();
        synced.map_err(SweepError::io(&self.path, "cannot be written"))
    }
}

/// Reads a journal; returns also its lines without the damaged ones.
fn load<R: DeserializeOwned>(directory: &Path) -> Result<(JournalContent<R>, Vec<u8>), SweepError> {
    let path = directory.join(FILE);
    let mut file = open_file(&path)?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)
        .map_err(SweepError::io(&path, "cannot be read"))?;
    let mut entries = Vec::new();
    let (mut kept, mut damaged) = (Vec::new(), Vec::new());
    for (number, line) in bytes.split_inclusive(|&b| b == b'\n').enumerate() {
        match parse(line) {
            Some(entry) => {
                entries.push(entry);
                kept.extend_from_slice(line);
            }
            None => damaged.push(number + 1),
        }
    }
    let journal = Journal { file, path };
    let opened = JournalContent {
        journal,
        entries,
        damaged,
        is_torn: !bytes.is_empty() && !bytes.ends_with(b"\n"),
    };
    Ok((opened, kept))
}

fn open_file(path: &Path) -> Result<File, SweepError> {
    let mut options = OpenOptions::new();
    options.create(true).read(true).append(true);
    own_file::open(path, &options).map_err(SweepError::io(path, "cannot be opened"))
}

/// Returns the line of an object of JSON: the object, with its checksum as first key.
fn checked(json: &[u8]) -> Vec<u8> {
    let rest = json.strip_prefix(b"{").unwrap_or(json);
    [
        format!("{{{CHECK}{}\",", checksum(rest)).as_bytes(),
        rest,
        b"\n",
    ]
    .concat()
}

/// Parses a line; returns `None` if it is incomplete or changed.
fn parse<R: DeserializeOwned>(line: &[u8]) -> Option<Entry<R>> {
    let line = line.strip_suffix(b"\n")?;
    let line = line.strip_prefix(b"{")?.strip_prefix(CHECK.as_bytes())?;
    let (check, rest) = line.split_at_checked(CHECK_DIGITS)?;
    let rest = rest.strip_prefix(b"\",")?;
    if check != checksum(rest).as_bytes() {
        return None;
    }
    serde_json::from_slice(&[b"{", rest].concat()).ok()
}

fn checksum(bytes: &[u8]) -> String {
    let mut hash = blake3::hash(bytes).to_hex().to_string();
    hash.truncate(CHECK_DIGITS);
    hash
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
            prop_assert_eq!(!opened.damaged.is_empty(), !kept.is_empty() && !kept.ends_with(b"\n"));
            let mut journal = opened.journal;
            journal.append(&entry(9)).unwrap();
            drop(journal);
            let again = Journal::open::<Row>(directory.path()).unwrap();
            prop_assert!(again.damaged.is_empty());
            prop_assert_eq!(again.entries.len(), lines + 1);
            prop_assert_eq!(again.entries.last().unwrap(), &entry(9));
        }
    }

    #[test]
    fn a_changed_journal_is_not_believed() {
        let bytes = written(3);
        let lines: Vec<&[u8]> = bytes.split_inclusive(|&b| b == b'\n').collect();
        let second = lines[0].len()..lines[0].len() + lines[1].len();
        for at in second.clone() {
            let mut changed = bytes.clone();
            changed[at] ^= 1;
            let directory = tempfile::tempdir().unwrap();
            std::fs::write(directory.path().join(FILE), &changed).unwrap();
            let refused = Journal::read::<Row>(directory.path()).err().unwrap();
            assert!(refused.to_string().contains("journal.jsonl:"), "{refused}");
            let opened = Journal::open::<Row>(directory.path()).unwrap();
            // The line feed joins or splits lines.
            assert!(opened.damaged.contains(&2), "{at}: {:?}", opened.damaged);
            assert!(
                opened
                    .entries
                    .iter()
                    .all(|found| *found == entry(found.seed)),
                "{at}"
            );
            assert!(opened.entries.iter().all(|found| found.seed != 1), "{at}");
            let again = Journal::open::<Row>(directory.path()).unwrap();
            assert_eq!(
                (again.damaged.len(), again.entries),
                (0, opened.entries),
                "{at}"
            );
        }
    }

    #[test]
    fn a_link_in_the_place_of_the_journal_is_not_followed() {
        let directory = tempfile::tempdir().unwrap();
        let other = directory.path().join("precious");
        std::fs::write(&other, "text").unwrap();
        std::os::unix::fs::symlink(&other, directory.path().join(FILE)).unwrap();
        let refused = Journal::open::<Row>(directory.path()).err().unwrap();
        assert!(refused.to_string().contains("symbolic link"), "{refused}");
        assert_eq!(std::fs::read(&other).unwrap(), b"text");
    }
}
