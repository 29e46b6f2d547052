//! A recorder that is killed leaves everything up to its last flush.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use mcap_log::LogOptions;

use super::made_up::{recording, run};

/// Names the log for the process that dies.
const VICTIM: &str = "PROTEAN_TEST_RECORDER_VICTIM";

/// Ticks that are flushed before the process dies.
const FLUSHED: u64 = 30;

/// Not a test by itself: the process that dies, started by the test below.
#[test]
fn victim() {
    let Some(path) = std::env::var_os(VICTIM) else {
        return;
    };
    let options = LogOptions {
        flush_every: Duration::ZERO,
        ..LogOptions::default()
    };
    let mut recording = recording(Path::new(&path), &options, None);
    for sent in run(FLUSHED + 5, 1) {
        sent.push(&mut recording);
    }
    recording.advance(FLUSHED - 1, &mut ()).unwrap();
    recording.flush_if_due().unwrap();
    // Written, but neither flushed nor finished.
    recording.advance(FLUSHED + 3, &mut ()).unwrap();
    std::process::abort();
}

#[test]
fn what_was_flushed_survives_the_process() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let status = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "tests::kill::victim"])
        .env(VICTIM, &path)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert!(!status.success(), "the victim died");
    let bytes = std::fs::read(&path).unwrap();
    let options = mcap::read::Options::IgnoreEndMagic | mcap::read::Options::ValidateChunkCrcs;
    let stream = mcap::MessageStream::new_with_options(&bytes, options).unwrap();
    let read = stream.map_while(Result::ok).count();
    let sent = run(FLUSHED + 5, 1)
        .iter()
        .filter(|sent| sent.stamp().tick < FLUSHED)
        .count();
    assert_eq!(read, sent);
    // The dead process's lock died with it.
    let again = LogOptions {
        force: true,
        ..LogOptions::default()
    };
    recording(&path, &again, None);
}
