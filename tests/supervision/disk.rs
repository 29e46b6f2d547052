//! Logs that cannot go on: the run says so at once, ends in order, and keeps what is there.

use std::collections::BTreeSet;
use std::process::Command;

use crate::support::{Sandbox, wait_for_tick};

/// A chase that goes on until its log ends it.
const ENDLESS: [&str; 6] = ["run", "chase", "--set", "run.dt=0.0005", "--quiet", "--out"];

#[test]
fn a_log_whose_directory_vanishes_ends_the_run() {
    let sandbox = Sandbox::new();
    sandbox.file("gone/here", "");
    let words = ENDLESS.iter().copied().chain(["gone/run.mcap"]);
    let running = sandbox.protean(words).start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 50);
    std::fs::remove_dir_all(sandbox.path().join("gone")).unwrap();
    let words = ["error: cannot write the log gone/run.mcap: it was removed, or its directory was"];
    running.finish().refused(1, &words);
    sandbox.assert_nothing_left();
}

#[test]
fn a_full_disk_ends_the_run_and_what_is_in_the_log_can_be_read() {
    // A disk of a megabyte, in a namespace where mounting is allowed.
    let sandbox = Sandbox::new();
    let program = env!("CARGO_BIN_EXE_protean");
    let script = format!(
        "mkdir -p disk && mount -t tmpfs -o size=1m none disk && {program} {} disk/run.mcap; \
         code=$?; cp disk/run.mcap kept.mcap; exit $code",
        ENDLESS.join(" ")
    );
    let outcome = Command::new("unshare")
        .args(["--map-root-user", "--mount", "sh", "-c", &script])
        .current_dir(sandbox.path())
        .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
        .output();
    let Ok(outcome) = outcome else {
        eprintln!("skipped: there is no unshare");
        return;
    };
    let stderr = String::from_utf8_lossy(&outcome.stderr);
    if stderr.contains("unshare") || stderr.contains("mount:") {
        eprintln!("skipped: no namespace to mount in: {stderr}");
        return;
    }
    assert_eq!(outcome.status.code(), Some(1), "{stderr}");
    let words = "cannot write the log disk/run.mcap: No space left on device";
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
