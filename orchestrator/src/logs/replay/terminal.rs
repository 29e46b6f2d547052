//! A terminal that hands over keys as they are pressed, and is given back however this ends.

use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rustix::termios::{self, LocalModes, OptionalActions, SpecialCodeIndex, Termios};
use signal_hook::SigId;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::low_level;

/// Signals that end a command: the first two in order, and at once when they come again; the others
/// at once.
const ENDINGS: [i32; 4] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT];

/// See the module's text; the terminal is given back when this is dropped, also by a panic, and when
/// a signal comes that ends the program.
pub(super) struct RawTerminal {
    before: Arc<Before>,
    hooks: Vec<SigId>,
}

/// What the terminal was like.
struct Before {
    terminal: OwnedFd,
    modes: Termios,
    given_back: AtomicBool,
}

impl Before {
    /// Gives the terminal back. Calls nothing but what a signal handler may: no memory is allocated,
    /// no lock is taken.
    fn give_back(&self) {
        self.given_back.store(true, Ordering::SeqCst);
        // Whose foreground it is now set it as they want it; and to set it would stop us.
        if is_ours(&self.terminal) {
            // A terminal that is gone needs nothing.
            let _ = termios::tcsetattr(&self.terminal, OptionalActions::Now, &self.modes);
        }
    }
}

/// Whether we are in the foreground of a terminal.
fn is_ours(terminal: impl AsFd) -> bool {
    termios::tcgetpgrp(terminal) == Ok(rustix::process::getpgrp())
}

impl RawTerminal {
    /// Lets a terminal hand over keys as they are pressed. Ctrl-C and its kin stay what they are.
    /// `None` of a terminal whose foreground is somebody else's.
    pub(super) fn new(terminal: impl AsFd) -> io::Result<Option<Self>> {
        if !is_ours(&terminal) {
            return Ok(None);
        }
        let modes = termios::tcgetattr(&terminal)?;
        let mut raw = modes.clone();
        raw.local_modes
            .remove(LocalModes::ICANON | LocalModes::ECHO);
        // A read returns what is there.
        raw.special_codes[SpecialCodeIndex::VMIN] = 0;
        raw.special_codes[SpecialCodeIndex::VTIME] = 0;
        let before = Arc::new(Before {
            terminal: rustix::io::fcntl_dupfd_cloexec(&terminal, 0)?,
            modes,
            given_back: AtomicBool::new(false),
        });
        let mut this = Self {
            before,
            hooks: Vec::new(),
        };
        // Before anything changes: no signal finds it changed and nobody to change it back.
        for signal in ENDINGS {
            let before = Arc::clone(&this.before);
            let action = move || {
                before.give_back();
                if signal == SIGHUP || signal == SIGQUIT {
                    let _ = low_level::emulate_default_handler(signal);
                }
            };
            // SAFETY: the action calls ioctl(2), getpgrp(2) and `emulate_default_handler`, which are
            // safe in signal handlers, and stores an atomic; it does not allocate, lock or panic.
            // It is removed before its own share of `before` could be the last.
            this.hooks
                .push(unsafe { low_level::register(signal, action) }?);
        }
        termios::tcsetattr(&terminal, OptionalActions::Now, &raw)?;
        if this.before.given_back.load(Ordering::SeqCst) {
            // A signal came in between, and the end is near.
            this.before.give_back();
        }
        Ok(Some(this))
    }
}

impl Drop for RawTerminal {
    fn drop(&mut self) {
        self.before.give_back();
        for hook in self.hooks.drain(..) {
            low_level::unregister(hook);
        }
    }
}
