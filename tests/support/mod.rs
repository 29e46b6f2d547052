//! Support of the end-to-end tests: the real program in its own sandbox.

// Every test binary uses a part of this.
#![allow(dead_code)]

pub mod browser;
pub mod call;
pub mod geometry;
pub mod history;
pub mod invariants;
pub mod programs;
pub mod python;
pub mod rig;
pub mod sandbox;
pub mod terminal;
pub mod ways;

use std::time::{Duration, Instant};

use runtime::lockstep::TickBarrier;

pub use sandbox::Sandbox;

/// The path of the program under test.
pub const PROTEAN: &str = env!("CARGO_BIN_EXE_protean_under_test");

/// Timeout of everything but whole runs.
pub const SOON: Duration = Duration::from_secs(300);

/// Looks every millisecond until `done` has a value.
///
/// # Panics
/// If it has none within `time`.
pub fn until<T>(what: &str, time: Duration, mut done: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + time;
    loop {
        if let Some(value) = done() {
            return value;
        }
        assert!(Instant::now() < deadline, "{what}: not within {time:?}");
        std::thread::park_timeout(Duration::from_millis(1));
    }
}

/// Waits until a run in a sandbox has posted this many ticks.
#[track_caller]
pub fn wait_for_tick(run: &str, ticks: u64) {
    let prefix = Sandbox::prefix(run);
    let page = until("the tick barrier", SOON, || TickBarrier::open(&prefix).ok());
    until("the first ticks", SOON, || {
        (page.ticks_posted() >= ticks).then_some(())
    });
}

/// Says that a part of a test was left out, past the test harness, which swallows what tests print.
pub fn skipped(what: &str, why: &str) {
    use std::io::Write as _;
    let note = format!("\nSKIPPED: {what}: {why}\n");
    std::io::stderr().write_all(note.as_bytes()).unwrap();
}
