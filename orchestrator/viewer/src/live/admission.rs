//! State of a connection: without the token, a viewer, or dismissed.

use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Values of the state.
const NEWCOMER: u8 = 0;
const VIEWER: u8 = 1;
const DISMISSED: u8 = 2;

/// State of a connection, shared by its thread and the thread that accepts connections.
#[derive(Debug)]
pub(super) struct Admission {
    state: AtomicU8,
    /// Event descriptor that wakes the thread of the connection.
    wake: Arc<OwnedFd>,
}

impl Admission {
    /// Creates the state of a connection without the token.
    pub(super) fn new(wake: OwnedFd) -> Self {
        Self {
            state: AtomicU8::new(NEWCOMER),
            wake: Arc::new(wake),
        }
    }

    /// Returns the descriptor that wakes the thread of the connection.
    pub(super) fn wake(&self) -> &Arc<OwnedFd> {
        &self.wake
    }

    /// Records that the connection presented the token; returns `false` if it was dismissed before.
    pub(super) fn admit(&self) -> bool {
        let from =
            self.state
                .compare_exchange(NEWCOMER, VIEWER, Ordering::AcqRel, Ordering::Acquire);
        from.is_ok()
    }

    /// Ends the connection; returns `false` if it has become a viewer.
    pub(super) fn dismiss(&self) -> bool {
        let from =
            self.state
                .compare_exchange(NEWCOMER, DISMISSED, Ordering::AcqRel, Ordering::Acquire);
        if from.is_ok() {
            let _ = rustix::io::write(&*self.wake, &1_u64.to_ne_bytes());
        }
        from.is_ok()
    }

    /// Returns `true` if the connection presented the token.
    pub(super) fn is_viewer(&self) -> bool {
        self.state.load(Ordering::Acquire) == VIEWER
    }

    /// Returns `true` if the connection must end.
    pub(super) fn is_dismissed(&self) -> bool {
        self.state.load(Ordering::Acquire) == DISMISSED
    }
}
