//! Who belongs to a run, and what each holds of the machine: memory, descriptors, shared memory.
//!
//! Read from outside, as anybody could: nothing here trusts what the processes say of themselves.

use std::ffi::OsStr;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use procfs::process::{Process, all_processes};
use procfs::{ProcError, ProcResult};
use serde::Serialize;

use crate::mission::children::CONFIG_VARIABLE;

/// What processes of a run are called by `ps`, before their names.
const OURS: &str = "protean:";

/// Why the machine cannot be looked at.
#[derive(Debug, thiserror::Error)]
pub enum CensusError {
    /// `/proc` does not tell.
    #[error("/proc: {0}")]
    Proc(#[from] ProcError),
    /// Shared memory cannot be listed.
    #[error("{path}: {source}")]
    SharedMemory {
        /// The directory.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// A process and what it holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Member {
    /// Process id.
    pub pid: i32,
    /// Name in its run, or of its program.
    pub name: String,
    /// Directory of its run; `None` for an orchestrator.
    pub root: Option<PathBuf>,
    /// Its configuration, which it shares with what it has started.
    pub config: Option<PathBuf>,
    /// Resident memory of its own, shared memory and files left out [bytes].
    pub memory_bytes: u64,
    /// Open file descriptors.
    pub descriptors: u64,
    /// Whether it has been stopped (SIGSTOP).
    pub stopped: bool,
}

/// One process.
///
/// # Errors
/// [`CensusError::Proc`] if it does not exist or is another user's.
pub fn member(pid: i32) -> Result<Member, CensusError> {
    Ok(look_at(&Process::new(pid)?)?)
}

/// The living children of an orchestrator by their process ids. Those that end meanwhile are left out.
///
/// # Errors
/// [`CensusError::Proc`] if `/proc` cannot be read.
pub fn children(parent: i32) -> Result<Vec<Member>, CensusError> {
    let living = |process: &Process| {
        // Whatever cannot be read has ended, or is none of ours.
        let stat = process.stat();
        stat.is_ok_and(|stat| stat.ppid == parent && stat.state != 'Z')
    };
    let mut found: Vec<Member> = all_processes()?
        .flatten()
        .filter(living)
        .filter_map(|process| look_at(&process).ok())
        .collect();
    found.sort_by_key(|m| m.pid);
    Ok(found)
}

/// Every living process that was given its configuration in the directory of a run, whoever its
/// parent is by now.
///
/// # Errors
/// [`CensusError::Proc`] if `/proc` cannot be read.
pub fn members_of(root: &Path) -> Result<Vec<Member>, CensusError> {
    let mut found: Vec<Member> = all_processes()?
        .flatten()
        .filter(|process| root_of(process).as_deref() == Some(root))
        .filter(|process| process.stat().is_ok_and(|stat| stat.state != 'Z'))
        .filter_map(|process| look_at(&process).ok())
        .collect();
    found.sort_by_key(|m| m.pid);
    Ok(found)
}

fn look_at(process: &Process) -> ProcResult<Member> {
    let status = process.status()?;
    let arguments = process.cmdline().unwrap_or_default();
    let name = arguments
        .first()
        .and_then(|first| first.strip_prefix(OURS))
        .map_or_else(|| status.name.clone(), str::to_owned);
    Ok(Member {
        pid: process.pid,
        name,
        root: root_of(process),
        config: config_of(process),
        memory_bytes: status.rssanon.unwrap_or(0) * 1024,
        descriptors: process.fd_count()? as u64,
        stopped: process.stat()?.state == 'T',
    })
}

/// The directory that its configuration lies in, from its environment.
fn root_of(process: &Process) -> Option<PathBuf> {
    config_of(process)?.parent().map(Path::to_owned)
}

fn config_of(process: &Process) -> Option<PathBuf> {
    let environment = process.environ().ok()?;
    environment
        .get(OsStr::new(CONFIG_VARIABLE))
        .map(PathBuf::from)
}

/// Directory in which shared memory has its names.
const SHARED_MEMORY: &str = "/dev/shm";

/// Beginning of the names of every run's shared memory; the name of the run's directory follows.
const PREFIX: &str = "protean_";

/// The pieces of shared memory of a run.
///
/// # Errors
/// [`CensusError::SharedMemory`] if they cannot be listed.
pub fn segments_of(root: &Path) -> Result<Vec<String>, CensusError> {
    let prefix = prefix_of(root);
    Ok(segments()?
        .into_iter()
        .filter(|segment| segment.starts_with(&prefix))
        .collect())
}

/// Beginning of the names of a run's shared memory, by the run's directory.
pub fn prefix_of(root: &Path) -> String {
    let name = root.file_name().unwrap_or_default().to_string_lossy();
    format!("{PREFIX}{name}_")
}

/// The pieces of shared memory of all runs of this user.
fn segments() -> Result<Vec<String>, CensusError> {
    let failed = |source| CensusError::SharedMemory {
        path: SHARED_MEMORY.into(),
        source,
    };
    let user = rustix::process::getuid().as_raw();
    let mut names: Vec<String> = std::fs::read_dir(SHARED_MEMORY)
        .map_err(failed)?
        .flatten()
        .filter(|entry| entry.metadata().is_ok_and(|m| m.uid() == user))
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with(PREFIX))
        .collect();
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use std::process::{Command, Stdio};

    use super::*;

    #[test]
    fn a_child_is_found_with_its_run_and_what_it_holds() {
        let directory = tempfile::tempdir().unwrap();
        let config = directory.path().join("process-3.json");
        let mut child = Command::new("sleep")
            .arg("60")
            .env(CONFIG_VARIABLE, &config)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let pid = i32::try_from(child.id()).unwrap();
        let us = i32::try_from(std::process::id()).unwrap();
        let root = directory.path();
        // A program that has only just been started may not have its environment yet.
        let mine = loop {
            let mine = children(us).unwrap();
            let of_it = mine.iter().find(|m| m.pid == pid).unwrap();
            if of_it.root.is_some() {
                break mine;
            }
            std::thread::yield_now();
        };
        let found = members_of(root).unwrap();
        child.kill().unwrap();
        child.wait().unwrap();
        let of_it = mine.iter().find(|m| m.pid == pid).unwrap();
        assert_eq!(of_it.root.as_deref(), Some(root));
        assert!(
            of_it.memory_bytes > 0 && of_it.descriptors >= 3,
            "{of_it:?}"
        );
        assert!(!of_it.stopped);
        assert_eq!(found.iter().map(|m| m.pid).collect::<Vec<_>>(), [pid]);
        assert!(members_of(root).unwrap().is_empty());
        assert!(member(pid).is_err());
    }

    #[test]
    fn shared_memory_is_told_by_the_name_of_its_run() {
        let chance = tempfile::Builder::new()
            .prefix("rtest")
            .rand_bytes(12)
            .tempdir()
            .unwrap();
        let name = chance.path().file_name().unwrap().to_str().unwrap();
        let segment = format!("{PREFIX}{name}_turn");
        let path = Path::new(SHARED_MEMORY).join(&segment);
        std::fs::write(&path, b"x").unwrap();
        let there = segments_of(chance.path());
        std::fs::remove_file(&path).unwrap();
        assert_eq!(there.unwrap(), [segment]);
        assert!(segments_of(chance.path()).unwrap().is_empty());
    }
}
