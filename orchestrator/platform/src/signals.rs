//! Signals that end the program in an orderly way.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::flag;

/// Sets the flag at the first Ctrl-C (SIGINT), SIGTERM or Ctrl-\ (SIGQUIT), and ends the program at the
/// second. A terminal that is closed (SIGHUP, which often comes twice) only sets the flag.
///
/// # Errors
/// The error of the operating system.
pub fn interrupt(interrupted: &Arc<AtomicBool>) -> std::io::Result<()> {
    for signal in [SIGINT, SIGTERM, SIGQUIT] {
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(interrupted))?;
        flag::register(signal, Arc::clone(interrupted))?;
    }
    flag::register(SIGHUP, Arc::clone(interrupted)).map(drop)
}
