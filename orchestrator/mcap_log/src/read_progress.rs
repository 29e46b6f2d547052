//! What a long command shows, and how it is interrupted.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use platform::progress::Progress;

use crate::LogReadError;

/// Files below this size are read before anybody looks (bytes).
const LONG: u64 = 32 << 20;
const MEGABYTE: u64 = 1_000_000;

/// Told how far a file has been read.
#[derive(Default)]
pub struct ReadProgress {
    /// Set from outside (Ctrl-C) to give up.
    pub interrupted: Arc<AtomicBool>,
    /// Whether nothing is shown.
    pub quiet: bool,
    shown: Option<(Progress, u64)>,
}

impl ReadProgress {
    /// Shows progress unless `quiet`, and gives up when `interrupted` is set.
    pub fn new(interrupted: Arc<AtomicBool>, quiet: bool) -> Self {
        Self {
            interrupted,
            quiet,
            shown: None,
        }
    }

    /// A file of this size is about to be read.
    pub fn begin(&mut self, bytes: u64) {
        self.end();
        if bytes >= LONG && !self.quiet {
            let total = (bytes / MEGABYTE) as usize;
            self.shown = Some((Progress::new(total, 0, false, "MB"), 0));
        }
    }

    /// It has been read up to here.
    ///
    /// # Errors
    /// The command was interrupted: [`LogReadError::Interrupted`].
    pub fn at(&mut self, bytes: u64) -> Result<(), LogReadError> {
        if let Some((progress, done)) = &mut self.shown {
            while (*done + 1) * MEGABYTE <= bytes {
                *done += 1;
                progress.done(false, String::new);
            }
        }
        if self.interrupted.load(Ordering::Relaxed) {
            self.end();
            return Err(LogReadError::Interrupted);
        }
        Ok(())
    }

    /// Shows nothing any more.
    pub fn end(&mut self) {
        if let Some((progress, _)) = self.shown.take() {
            progress.finish();
        }
    }
}
