//! Progress and interruption of long commands.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use platform::progress::Progress;

use crate::LogReadError;

/// Size from which progress is shown (bytes); smaller files are read at once.
const PROGRESS_BYTES: u64 = 32 << 20;
const MEGABYTE: u64 = 1_000_000;

/// Progress of reading a file.
#[derive(Debug, Default)]
pub struct ReadProgress {
    /// Set by a signal handler (Ctrl-C) to stop reading.
    pub interrupted: Arc<AtomicBool>,
    /// `true` to show nothing.
    pub quiet: bool,
    shown: Option<(Progress, u64)>,
}

impl ReadProgress {
    /// Shows progress unless `quiet`, and stops when `interrupted` is set.
    pub fn new(interrupted: Arc<AtomicBool>, quiet: bool) -> Self {
        Self {
            interrupted,
            quiet,
            shown: None,
        }
    }

    /// Begins a file of this size (bytes).
    pub fn begin(&mut self, bytes: u64) {
        self.end();
        if bytes >= PROGRESS_BYTES && !self.quiet {
            let total = (bytes / MEGABYTE) as usize;
            self.shown = Some((Progress::new(total, 0, false, "MB"), 0));
        }
    }

    /// Reports the offset up to which the file has been read (bytes).
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

    /// Removes the progress bar.
    pub fn end(&mut self) {
        if let Some((progress, _)) = self.shown.take() {
            progress.finish();
        }
    }
}
