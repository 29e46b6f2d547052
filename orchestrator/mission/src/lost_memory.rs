//! Shared memory of ended runs whose directory cannot be found: it was removed by a logout, or the run had another
//! `XDG_RUNTIME_DIR`.

use std::collections::BTreeMap;
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use platform::proc;
use rustix::process::geteuid;

/// Directory of all shared memory of the machine.
const MEMORY: &str = "/dev/shm";
/// First characters of the names of a run: those of its directory follow.
const NAMES: &str = "protean_";
/// Age from which a file that no process has mapped is lost: a starting run maps its files at once.
const SETTLED: Duration = Duration::from_secs(60);

/// Removes the shared memory of lost runs; returns the common beginning of the names of each of them. `has_directory`
/// tells whether the directory of a run, by its name, exists: then the run is not lost.
///
/// # Errors
/// The error of the operating system. If the maps of a process of this user are unreadable, nothing is removed.
pub(super) fn remove(has_directory: impl Fn(&str) -> bool) -> io::Result<Vec<PathBuf>> {
    remove_in(Path::new(MEMORY), SETTLED, has_directory)
}

fn remove_in(
    memory: &Path,
    settled: Duration,
    has_directory: impl Fn(&str) -> bool,
) -> io::Result<Vec<PathBuf>> {
    let mut lost = own_files(memory, settled)?;
    lost.retain(|name, files| !files.is_empty() && !has_directory(name));
    if lost.is_empty() {
        return Ok(Vec::new());
    }
    for mapped in proc::files_mapped_by(geteuid().as_raw())? {
        if let Some(run) = run_of(memory, &mapped) {
            lost.remove(run);
        }
    }
    let mut removed = Vec::new();
    for (run, files) in lost {
        for file in files {
            match std::fs::remove_file(&file) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        removed.push(memory.join(format!("{NAMES}{run}_")));
    }
    Ok(removed)
}

/// Returns the files of this user by run; none for a run with a file that is younger than `settled`.
fn own_files(memory: &Path, settled: Duration) -> io::Result<BTreeMap<String, Vec<PathBuf>>> {
    let mut files: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    let mut young = Vec::new();
    for entry in std::fs::read_dir(memory)? {
        let path = entry?.path();
        let Some(run) = run_of(memory, &path) else {
            continue;
        };
        let facts = match path.symlink_metadata() {
            Ok(facts) => facts,
            // It was removed meanwhile.
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => return Err(error),
        };
        if !facts.is_file() || facts.uid() != geteuid().as_raw() {
            continue;
        }
        let age = SystemTime::now().duration_since(facts.modified()?);
        if age.is_err() || age.is_ok_and(|age| age < settled) {
            young.push(run.to_owned());
        }
        files.entry(run.to_owned()).or_default().push(path);
    }
    files.retain(|run, _| !young.contains(run));
    Ok(files)
}

/// Returns the name of the run that a file of shared memory belongs to.
fn run_of<'a>(memory: &Path, path: &'a Path) -> Option<&'a str> {
    let name = path.strip_prefix(memory).ok()?.to_str()?;
    Some(name.strip_prefix(NAMES)?.split_once('_')?.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_without_directory_and_process_is_removed_and_young_memory_kept() {
        let memory = tempfile::tempdir().unwrap();
        let file = |name: &str| {
            let path = memory.path().join(name);
            std::fs::write(&path, "text").unwrap();
            path
        };
        let lost = [file("protean_rLost_turn"), file("protean_rLost_abc.data")];
        let kept = [
            file("protean_rHere_turn"),
            file("other_rLost_turn"),
            file("protean_lock"),
        ];
        let remove = |settled| remove_in(memory.path(), settled, |run| run == "rHere").unwrap();
        assert_eq!(remove(SETTLED), Vec::<PathBuf>::new());
        assert_eq!(
            remove(Duration::ZERO),
            [memory.path().join("protean_rLost_")]
        );
        assert!(lost.iter().all(|path| !path.exists()));
        assert!(kept.iter().all(|path| path.exists()));
    }

    #[test]
    fn memory_that_a_process_has_mapped_is_kept() {
        // The program of this test is mapped.
        let program = std::env::current_exe().unwrap();
        let mapped = proc::files_mapped_by(geteuid().as_raw()).unwrap();
        assert!(mapped.contains(&program), "{mapped:?}");
    }
}
