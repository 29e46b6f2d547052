//! Test of a killed recorder: the log is readable up to the last flush.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use mcap_log::{LogOptions, LogWriteError};

use super::made_up::{recording, run};

/// Environment variable with the path of the log, for the process that is killed.
const VICTIM: &str = "PROTEAN_TEST_RECORDER_VICTIM";

/// Number of ticks that are flushed before the process is killed.
const FLUSHED: u64 = 30;

/// Not a test itself: the process that is killed, started by the test below.
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
fn flushed_messages_survive_the_process() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let status = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "tests::kill::victim"])
        .env(VICTIM, &path)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert!(!status.success(), "the process is killed");
    let bytes = std::fs::read(&path).unwrap();
    let options = mcap::read::Options::IgnoreEndMagic | mcap::read::Options::ValidateChunkCrcs;
    let stream = mcap::MessageStream::new_with_options(&bytes, options).unwrap();
    let read = stream.map_while(Result::ok).count();
    let sent = run(FLUSHED + 5, 1)
        .iter()
        .filter(|sent| sent.stamp().tick < FLUSHED)
        .count();
    // The names of the robots come first.
    assert_eq!(read, 1 + sent);
    // The lock ended with the process.
    let again = LogOptions {
        force: true,
        ..LogOptions::default()
    };
    recording(&path, &again, None);
}

#[test]
fn an_error_of_the_thread_of_the_log_is_returned_by_the_next_flush() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let options = LogOptions {
        flush_every: Duration::ZERO,
        ..LogOptions::default()
    };
    let mut recording = recording(&path, &options, None);
    std::fs::remove_file(&path).unwrap();
    for sent in run(5, 1) {
        sent.push(&mut recording);
    }
    recording.advance(3, &mut ()).unwrap();
    let error = recording.flush_if_due().unwrap_err();
    assert!(matches!(error, LogWriteError::Write { .. }), "{error}");
}
