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

/// Restores the default of SIGCHLD if this program was started with that signal ignored: the system would then forget
/// the end of every child, and a process that has ended could not be told from one that hangs.
#[expect(unsafe_code, reason = "`rustix` and `signal-hook` set no default")]
pub fn keep_ends_of_children() {
    // SAFETY: queries and sets the action of one signal, before other threads exist; no function is installed.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        if libc::sigaction(libc::SIGCHLD, std::ptr::null(), &raw mut action) == 0
            && action.sa_sigaction == libc::SIG_IGN
        {
            libc::signal(libc::SIGCHLD, libc::SIG_DFL);
        }
    }
}

/// Ignores SIGXFSZ, so that a write beyond the limit of file sizes (`ulimit -f`) is an error that names the file and
/// does not end the program.
#[expect(unsafe_code, reason = "`rustix` and `signal-hook` ignore no signal")]
pub fn refuse_large_files() {
    // SAFETY: sets the action of one signal, before other threads exist; no function is installed.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}
