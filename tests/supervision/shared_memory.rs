//! Full shared memory, which is small in containers, and other scarce resources: no process is killed without
//! an error message, and nothing is left behind.

use std::fs::File;
use std::io::Write as _;
use std::os::fd::AsRawFd as _;
use std::path::PathBuf;

use crate::support::call::{Call, Running};
use crate::support::history::History;
use crate::support::{SOON, Sandbox, until};

use super::disk::{ENDLESS, where_one_can_mount};

/// Beginning of the error message.
const FULL: &str = "error: shared memory is full: ";

/// Runs with separate shared memory of this size; `None` where this machine does not allow that.
fn with_shared_memory<'a>(sandbox: &Sandbox, call: Call<'a>, size: &str) -> Option<Call<'a>> {
    where_one_can_mount(sandbox, "mount -t tmpfs none /dev/shm")?;
    let script = "mount -t tmpfs -o size=\"$0\" none /dev/shm && exec \"$@\"";
    let words = ["--map-root-user", "--mount", "sh", "-c", script, size];
    Some(call.through("unshare", &words))
}

/// The separate shared memory of such a run.
struct Inside(File);

impl Inside {
    /// Of a run that has written some of its log.
    fn from_run(sandbox: &Sandbox, running: &Running<'_>) -> Self {
        let log = sandbox.path().join("run.mcap");
        until("a log of some length", SOON, || {
            let length = std::fs::metadata(&log).ok()?.len();
            (length > 100_000).then_some(())
        });
        // Once it is open it lasts, also when the last process that sees it has ended.
        Self(File::open(format!("/proc/{}/root/dev/shm", running.pid())).unwrap())
    }

    fn path(&self) -> PathBuf {
        format!("/proc/self/fd/{}", self.0.as_raw_fd()).into()
    }

    /// Takes up all that is left.
    fn fill(&self) {
        let mut filler = File::create_new(self.path().join("filler")).unwrap();
        for size in [1 << 16, 1 << 12] {
            while filler.write_all(&vec![0; size]).is_ok() {}
        }
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).unwrap();
        entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }
}

#[test]
fn a_run_with_too_little_shared_memory_does_not_begin() {
    let sandbox = Sandbox::new();
    let recorded = ["run", "hello", "--set", "rules.time_limit=1", "--out"];
    let recorded = sandbox.protean(recorded).arg("recorded.mcap").run();
    assert_eq!(recorded.code, Some(0), "{recorded}");
    let run = ["run", "hello", "--out", "run.mcap"];
    let test = ["replay", "recorded.mcap", "--test", "patroller"];
    for words in [&run[..], &test[..]] {
        let call = sandbox.protean(words.iter().copied());
        let Some(call) = with_shared_memory(&sandbox, call, "2m") else {
            return;
        };
        let words = "2.1 of 2.1 MB are free in /dev/shm: expected at least 4.2 MB; free some";
        call.run().refused(1, &[&format!("{FULL}{words}")]);
    }
    assert!(!sandbox.path().join("run.mcap").exists());
    assert_eq!(sandbox.processes(), [], "processes");
    assert_eq!(sandbox.runtime_files(), [] as [PathBuf; 0]);
}

#[test]
fn a_run_whose_shared_memory_is_used_up_ends_in_order() {
    let sandbox = Sandbox::new();
    let call = sandbox.protean(ENDLESS.into_iter().chain(["run.mcap"]));
    let Some(call) = with_shared_memory(&sandbox, call, "64m") else {
        return;
    };
    let running = call.start();
    let inside = Inside::from_run(&sandbox, &running);
    inside.fill();
    let words = "MB are free in /dev/shm: expected at least 1.0 MB; free some";
    running.finish().refused(1, &[FULL, words]);
    assert_eq!(inside.names(), ["filler"]);
    assert_eq!(sandbox.processes(), [], "processes");
    assert_eq!(sandbox.runtime_files(), [] as [PathBuf; 0]);
    // It was closed as logs are that went to their end.
    let info = sandbox.protean(["info", "run.mcap"]).json();
    assert_eq!(info["condition"]["complete"], true, "{info}");
    let kept = History::read(&sandbox.path().join("run.mcap"));
    assert!(kept.states.len() > 10, "{}", kept.states.len());
}

#[test]
fn a_run_opens_as_many_files_as_it_may_and_fails_in_order_when_that_is_too_few() {
    let sandbox = Sandbox::new();
    let words = ["run", "chase", "--quiet", "--set", "rules.time_limit=0.5"];
    let run = |kind| {
        let call = sandbox.protean(words).arg("--force");
        call.arg("--out")
            .arg("run.mcap")
            .with_open_files(kind, "100")
            .run()
    };
    run("-H").refused(1, &["error: "]);
    sandbox.assert_nothing_left();
    let outcome = run("-S");
    assert_eq!(outcome.code, Some(0), "{outcome}");
    sandbox.assert_nothing_left();
}
