//! Logs that cannot be written: the run reports it at once, ends in order, and keeps the written part.

use std::collections::BTreeSet;
use std::process::Command;

use crate::support::{PROTEAN, Sandbox, skipped, wait_for_tick};

/// A chase that goes on until its log ends it.
pub(super) const ENDLESS: [&str; 6] =
    ["run", "chase", "--set", "run.dt=0.0005", "--quiet", "--out"];

#[test]
fn a_log_whose_directory_vanishes_ends_the_run() {
    let sandbox = Sandbox::new();
    sandbox.file("gone/here", "");
    let words = ENDLESS.iter().copied().chain(["gone/run.mcap"]);
    let running = sandbox.protean(words).start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 50);
    std::fs::remove_dir_all(sandbox.path().join("gone")).unwrap();
    let words = ["error: gone/run.mcap: cannot be written: the file or its directory was removed"];
    running.finish().refused(1, &words);
    sandbox.assert_nothing_left();
}

/// Runs a script of the shell where mounting is allowed, in the sandbox's directory; `None`, and a
/// note on stderr, if this machine does not allow it.
pub(super) fn where_one_can_mount(sandbox: &Sandbox, script: &str) -> Option<std::process::Output> {
    let outcome = Command::new("unshare")
        .args(["--map-root-user", "--mount", "sh", "-c", script])
        .current_dir(sandbox.path())
        .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
        .output();
    let why = match outcome {
        Err(error) => format!("unshare: {error}"),
        Ok(outcome) => {
            let stderr = String::from_utf8_lossy(&outcome.stderr).into_owned();
            if !stderr.contains("unshare") && !stderr.contains("mount:") {
                return Some(outcome);
            }
            stderr
        }
    };
    skipped("disks and shared memory that are full or read-only", &why);
    None
}

#[test]
fn a_directory_that_cannot_be_written_to_is_reported_at_once() {
    let sandbox = Sandbox::new();
    // No user can create files there, not even root.
    let words = ["run", "hello", "--out", "/proc/run.mcap"];
    let outcome = sandbox.protean(words).run();
    outcome.refused(
        2,
        &["error: /proc/run.mcap: cannot be created: No such file"],
    );
    sandbox.assert_nothing_left();
    // The directory that logs go to by themselves, too.
    for (words, path) in [
        ("--out run.mcap", "run.mcap: cannot be created"),
        ("--out older.mcap --force", "older.mcap: cannot be created"),
        ("", "logs: cannot be created"),
    ] {
        let script = format!(
            "mkdir -p disk && mount -t tmpfs none disk && echo precious > disk/older.mcap \
             && mount -o remount,ro disk && cd disk && {PROTEAN} run hello {words}; code=$?; \
             ls -a; cat older.mcap; exit $code"
        );
        let Some(outcome) = where_one_can_mount(&sandbox, &script) else {
            return;
        };
        let stderr = String::from_utf8_lossy(&outcome.stderr);
        assert_eq!(outcome.status.code(), Some(2), "{stderr}");
        let ended_by_disk = stderr.lines().any(|line| {
            line.starts_with("error: ")
                && line.contains(path)
                && line.contains("Read-only file system")
        });
        assert!(ended_by_disk, "{words}: {stderr}");
        let left = String::from_utf8_lossy(&outcome.stdout);
        assert_eq!(left, ".\n..\nolder.mcap\nprecious\n");
        assert_eq!(sandbox.processes(), [], "processes");
        assert_eq!(sandbox.runtime_files(), [] as [std::path::PathBuf; 0]);
    }
}

#[test]
fn a_full_disk_ends_the_run_and_what_is_in_the_log_can_be_read() {
    // A disk of a megabyte, in a namespace where mounting is allowed.
    let sandbox = Sandbox::new();
    let script = format!(
        "mkdir -p disk && mount -t tmpfs -o size=1m none disk && {PROTEAN} {} disk/run.mcap; \
         code=$?; cp disk/run.mcap kept.mcap; exit $code",
        ENDLESS.join(" ")
    );
    let Some(outcome) = where_one_can_mount(&sandbox, &script) else {
        return;
    };
    let stderr = String::from_utf8_lossy(&outcome.stderr);
    assert_eq!(outcome.status.code(), Some(1), "{stderr}");
    let words = "disk/run.mcap: cannot be written: No space left on device";
    assert!(stderr.contains(words), "{stderr}");
    assert_eq!(sandbox.processes(), [], "processes");
    assert_eq!(sandbox.runtime_files(), [] as [std::path::PathBuf; 0]);
    let words = ["recover", "kept.mcap", "--out", "saved.mcap", "--json"];
    let saved = sandbox.protean(words).run();
    assert!(matches!(saved.code, Some(0 | 3)), "{saved}");
    let kept = crate::support::history::History::read(&sandbox.path().join("saved.mcap"));
    for (tick, state) in (0..).zip(&kept.states) {
        assert_eq!(state.tick, tick);
    }
    assert!(!kept.states.is_empty());
}
