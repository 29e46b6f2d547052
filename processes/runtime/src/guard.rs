//! Ends the process when its orchestrator has gone.
//!
//! The orchestrator holds the writing end of a pipe to every process's standard input. When the
//! orchestrator ends, for any reason, the pipe ends. The kernel also sends the parent-death signal,
//! with which the orchestrator starts every process; it ends a stopped process, too.

use std::io::Read as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time for a regular end of a process whose orchestrator has gone.
const GRACE: Duration = Duration::from_secs(5);

/// Exit code of a process whose orchestrator disappeared.
pub const EXIT_ORPHANED: u8 = 4;

/// Watches standard input; at its end sets `stop` and, after five seconds, ends the process.
///
/// # Errors
/// If the watching thread cannot be started.
pub fn watch_parent(stop: Arc<AtomicBool>) -> std::io::Result<()> {
    std::thread::Builder::new()
        .name("parent-guard".into())
        .spawn(move || {
            let mut sink = [0_u8; 64];
            let mut stdin = std::io::stdin().lock();
            loop {
                match stdin.read(&mut sink) {
                    Ok(0) => break,
                    Err(e) if e.kind() != std::io::ErrorKind::Interrupted => break,
                    _ => {}
                }
            }
            stop.store(true, Ordering::SeqCst);
            std::thread::park_timeout(GRACE);
            std::process::exit(i32::from(EXIT_ORPHANED));
        })?;
    Ok(())
}
