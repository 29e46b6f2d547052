//! Words of shared memory between a measurement and its processes, without the runtime.

use std::fs::OpenOptions;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use memmap2::{MmapOptions, MmapRaw};
use rustix::thread::futex;

use super::LinkError;

/// Number of words of a cache line: words written by different processes are this far apart.
pub const LINE: usize = 16;
/// Number of words of the whole page.
const WORDS: usize = 1024;
const BYTES: usize = WORDS * size_of::<AtomicU32>();

/// A page of words, initially zero.
#[derive(Debug)]
pub struct SharedWords {
    map: MmapRaw,
}

impl SharedWords {
    /// Creates the words of a run space; removing the run space removes them.
    ///
    /// # Errors
    /// [`LinkError`] if the operating system refuses.
    pub fn create(prefix: &str) -> Result<Self, LinkError> {
        let mut options = OpenOptions::new();
        Self::map(options.create_new(true).mode(0o600), prefix)
    }

    /// Opens the words of a run space.
    ///
    /// # Errors
    /// [`LinkError`] if the operating system refuses.
    pub fn open(prefix: &str) -> Result<Self, LinkError> {
        Self::map(&mut OpenOptions::new(), prefix)
    }

    fn map(options: &mut OpenOptions, prefix: &str) -> Result<Self, LinkError> {
        let path = PathBuf::from(format!("/dev/shm/{prefix}words"));
        let failed = |e| LinkError::system(format!("{}", path.display()))(e);
        let file = options.read(true).write(true).open(&path).map_err(failed)?;
        // Allocate now, so that a full /dev/shm is an error here; allocated memory is unchanged.
        let whole = rustix::fs::FallocateFlags::empty();
        rustix::fs::fallocate(&file, whole, 0, BYTES as u64).map_err(|e| failed(e.into()))?;
        let map = MmapOptions::new()
            .len(BYTES)
            .map_raw(&file)
            .map_err(failed)?;
        Ok(Self { map })
    }

    /// Returns a word by its index; the last one for an index out of range.
    // A mapping starts at a page boundary, a multiple of the alignment of a word.
    #[allow(clippy::cast_ptr_alignment)]
    pub fn word(&self, index: usize) -> &AtomicU32 {
        // SAFETY: the mapping is page-aligned, BYTES = WORDS words long and lives as long as
        // `self`; the index is below WORDS. Every bit pattern is a valid `AtomicU32`, and
        // concurrent access from other processes is defined for atomics. The file is never
        // shortened: it goes by being unlinked.
        unsafe {
            &*self
                .map
                .as_ptr()
                .cast::<AtomicU32>()
                .add(index.min(WORDS - 1))
        }
    }
}

/// Sleeps while `word` is `seen`, at most for `timeout`.
pub fn sleep_while(word: &AtomicU32, seen: u32, timeout: Duration) {
    let timeout = rustix::thread::Timespec {
        tv_sec: i64::try_from(timeout.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: i64::from(timeout.subsec_nanos()),
    };
    // Woken, changed already, timed out or interrupted: the caller checks.
    let _ = futex::wait(word, futex::Flags::empty(), seen, Some(&timeout));
}

/// Stores a value and wakes all sleepers on the word.
pub fn store_and_wake(word: &AtomicU32, value: u32) {
    word.store(value, Ordering::SeqCst);
    wake(word);
}

/// Wakes all sleepers on a word.
pub fn wake(word: &AtomicU32) {
    let _ = futex::wake(word, futex::Flags::empty(), i32::MAX as u32);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_shared_between_mappings_and_indices_are_clamped() {
        let prefix = format!("pt_{}_shared_", std::process::id());
        let ours = SharedWords::create(&prefix).unwrap();
        let theirs = SharedWords::open(&prefix);
        std::fs::remove_file(format!("/dev/shm/{prefix}words")).unwrap();
        let theirs = theirs.unwrap();
        ours.word(3).store(7, Ordering::SeqCst);
        assert_eq!(theirs.word(3).load(Ordering::SeqCst), 7);
        theirs.word(usize::MAX).store(9, Ordering::SeqCst);
        assert_eq!(ours.word(WORDS - 1).load(Ordering::SeqCst), 9);
    }
}
