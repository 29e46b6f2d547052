//! Signals as this program needs them, whatever whoever started it has made of them.

use signal_hook::consts::{SIGCHLD, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXFSZ};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Has children reported when they end, and a file that may not grow any more told by the write that would
/// have had it grow. A launcher that ignores SIGCHLD hands that on: the system then forgets how children
/// ended, and their numbers are somebody else's at once. And a limit for the size of files (`ulimit -f`)
/// would end the program in the middle of a run. Call before there are threads and children.
///
/// # Errors
/// What the system says.
pub fn as_needed() -> std::io::Result<()> {
    hear_of_children()?;
    // Caught, not ignored: programs that are started from here get what is usual.
    flag::register(SIGXFSZ, Arc::default()).map(drop)
}

#[expect(
    unsafe_code,
    reason = "a call of the C library that has no other wrapper"
)]
fn hear_of_children() -> std::io::Result<()> {
    // SAFETY: no handler is given, only what the system does by itself.
    let before = unsafe { libc::signal(SIGCHLD, libc::SIG_DFL) };
    if before == libc::SIG_ERR {
        return Err(std::io::Error::last_os_error());
    }
    Ok(())
}

/// Whether a signal is ignored here: `nohup` has that of a terminal that is closed ignored, and means it.
#[expect(
    unsafe_code,
    reason = "a call of the C library that has no other wrapper"
)]
fn is_ignored(signal: libc::c_int) -> bool {
    let mut now = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: nothing is set without a new action, and there is room for the present one.
    let asked = unsafe { libc::sigaction(signal, std::ptr::null(), now.as_mut_ptr()) };
    // SAFETY: zeros are a valid action (by default), which a call that fails leaves.
    let now = unsafe { now.assume_init() };
    asked == 0 && now.sa_sigaction == libc::SIG_IGN
}

/// The first Ctrl-C or SIGTERM sets the flag, the second ends the program; so does a terminal that is closed
/// (SIGHUP, which often comes twice and only ever sets the flag) or Ctrl-\ (SIGQUIT).
///
/// # Errors
/// What the system says.
pub fn interrupt(interrupted: &Arc<AtomicBool>) -> std::io::Result<()> {
    for signal in [SIGINT, SIGTERM, SIGQUIT] {
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(interrupted))?;
        flag::register(signal, Arc::clone(interrupted))?;
    }
    if !is_ignored(SIGHUP) {
        flag::register(SIGHUP, Arc::clone(interrupted))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(unsafe_code, reason = "as above")]
    fn what_is_ignored_is_known_and_can_be_undone_for_children() {
        // SAFETY: no handler is given, only that the signal is ignored.
        unsafe { libc::signal(libc::SIGURG, libc::SIG_IGN) };
        assert!(is_ignored(libc::SIGURG));
        assert!(!is_ignored(libc::SIGWINCH));
        hear_of_children().unwrap();
        assert!(!is_ignored(SIGCHLD));
    }
}
